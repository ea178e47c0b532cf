/* SPDX-License-Identifier: MIT
 *
 * drive_loop [HOST[:PORT]]: a metre ahead by a move, in a loop of its own instead of the pump's
 * thread; Ctrl-C stops the robot. Exit status 0 if it arrived, else 1.
 */
#include <roburoc4_move.h>
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
    roburoc4_localization_status pose;
    roburoc4_move move;
    roburoc4_result result;
    result = roburoc4_udp_resolve(argc > 1 ? argv[1] : "127.0.0.1", 0, &robot);
    if (result >= 0) {
        result = roburoc4_udp_open(&udp, sizeof udp, &robot);
    }
    if (result < 0) {
        fprintf(stderr, "%s: %s\n", argc > 1 ? argv[1] : "", roburoc4_result_text(result));
        return 1;
    }
    signal(SIGINT, on_signal);
    signal(SIGTERM, on_signal);
    uint64_t now_us = roburoc4_udp_now_us(), begun_us = now_us;
    roburoc4_client_init(&client, sizeof client, NULL);
    roburoc4_client_start(&client, now_us);
    do { /* connect and ask for permission to drive, for 10 s at most */
        roburoc4_udp_wait(&udp, &client, 50000); /* sends and receives */
        now_us = roburoc4_udp_now_us();
        result = roburoc4_client_arm(&client, now_us);
    } while (result < 0 && !interrupted && now_us - begun_us < 10000000);
    if (result < 0) {
        puts(roburoc4_result_text(result));
    }
    roburoc4_move_by(&move, 1.0f, 0.0f, NULL); /* metres, and radians to the left */
    while (!interrupted && roburoc4_move_step(&move, &client, now_us) == ROBUROC4_MOVE_RUNNING) {
        result = roburoc4_client_drive(&client, move.linear_m_s, move.angular_rad_s, 0, now_us);
        (void)result; /* where it is refused, the next step ends the move and says why */
        roburoc4_udp_wait(&udp, &client, 50000);
        now_us = roburoc4_udp_now_us();
    }
    roburoc4_move_cancel(&move, &client, now_us); /* does nothing where the move has ended */
    puts(roburoc4_move_outcome_text(move.outcome));
    if (roburoc4_client_localization(&client, &pose, NULL) == 0) {
        printf("x %.2f m, y %.2f m\n", pose.x_m, pose.y_m);
    }
    roburoc4_client_close(&client, now_us); /* stops the robot */
    while (roburoc4_client_state(&client) != ROBUROC4_STATE_IDLE) {
        roburoc4_udp_wait(&udp, &client, 50000);
    }
    return move.outcome != ROBUROC4_MOVE_REACHED;
}
