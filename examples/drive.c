/* SPDX-License-Identifier: MIT
 *
 * drive: the example of README.md, which shows this text from the first #include on.
 */
#include <roburoc4_pump.h>
#include <signal.h>
#include <stdio.h>

static roburoc4_pump *pump;

static void on_signal(int number) {
    (void)number;
    roburoc4_pump_request_stop(pump); /* the robot stops at once, and the move ends */
}

int main(int argc, char **argv) {
    roburoc4_address robot;
    roburoc4_move move;
    roburoc4_result result = roburoc4_udp_resolve(argc > 1 ? argv[1] : "127.0.0.1", 0, &robot);
    if (result == 0) {
        pump = roburoc4_pump_create(&robot, NULL, 0, NULL, &result);
    }
    signal(SIGINT, on_signal);
    if (pump != NULL) {
        result = roburoc4_pump_arm(pump, 10000000); /* waits until it is allowed: 10 s */
    }
    if (result < 0) {
        printf("drive: gave up: %s\n", roburoc4_result_text(result));
        return 1;
    }
    roburoc4_move_by(&move, 0.5f, 0.0f, NULL); /* metres ahead, and radians to the left */
    result = roburoc4_pump_move(pump, &move);
    printf("drive: %s\n", roburoc4_move_outcome_text(result));
    return result != ROBUROC4_MOVE_REACHED; /* here the pump stops the robot, if it still moves */
}
