/* SPDX-License-Identifier: MIT
 *
 * drive: the example of README.md, which has this text from the first #include on.
 */
#include <roburoc4_udp.h>
#include <signal.h>
#include <stdio.h>

static volatile sig_atomic_t interrupted;
static void on_signal(int number) {
    interrupted = number;
}

int main(int argc, char **argv) {
    static roburoc4_client client;
    static roburoc4_udp udp;
    roburoc4_address robot;
    if (roburoc4_udp_resolve(argc > 1 ? argv[1] : "127.0.0.1", 0, &robot) < 0 ||
        roburoc4_udp_open(&udp, sizeof udp, &robot) < 0) {
        return fprintf(stderr, "no such address\n"), 1;
    }
    signal(SIGINT, on_signal);
    roburoc4_client_init(&client, sizeof client, NULL);
    uint64_t now_us = roburoc4_udp_now_us(), begun_us = now_us;
    roburoc4_client_start(&client, now_us);

    /* Connect and ask to drive, for 5 s at most. */
    roburoc4_result result;
    while ((result = roburoc4_client_arm(&client, now_us)) < 0 && !interrupted &&
           !roburoc4_udp_fault(&udp) && now_us - begun_us < 5000000) {
        roburoc4_udp_wait(&udp, &client, 50000);
        now_us = roburoc4_udp_now_us();
    }
    /* 0.2 m/s ahead for 3 s. A command holds for 250 ms: repeat it, or the robot stops. */
    for (begun_us = now_us; result == 0 && !interrupted && now_us - begun_us < 3000000;) {
        result = roburoc4_client_drive(&client, 0.2f, 0.0f, 0, now_us);
        roburoc4_udp_wait(&udp, &client, 50000);
        now_us = roburoc4_udp_now_us();
    }
    if (result < 0) {
        uint32_t fault = roburoc4_udp_fault(&udp);
        fprintf(stderr, "gave up: %s\n",
                fault ? roburoc4_udp_fault_text(fault) : roburoc4_result_text(result));
    }
    /* Stop the robot, then go. */
    roburoc4_client_close(&client, roburoc4_udp_now_us());
    while (roburoc4_client_state(&client) != ROBUROC4_STATE_IDLE &&
           roburoc4_udp_wait(&udp, &client, 50000) >= 0) {
    }
    return result < 0 || interrupted;
}
