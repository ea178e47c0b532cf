/* SPDX-License-Identifier: MIT
 *
 * drive_square [HOST[:PORT] [PATH.csv]]: a square of 2 m to the left, made of eight moves. Exit
 * status: 0 driven, 1 not (all the way), 3 no robot there, 130 after Ctrl-C.
 */
#include <roburoc4_move.h>
#include <roburoc4_udp.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

static roburoc4_client client;
static roburoc4_udp udp;
static volatile sig_atomic_t interrupted;

static void on_signal(int number) {
    interrupted = number;
}

/* Connect and arm, for 10 s at most; less than 0 says why that failed. */
static roburoc4_result arm(const char *host) {
    roburoc4_address address;
    roburoc4_result result = roburoc4_udp_resolve(host, 0, &address);
    if (result < 0 || (result = roburoc4_udp_open(&udp, sizeof udp, &address)) < 0) {
        return result;
    }
    const uint64_t end_us = roburoc4_udp_now_us() + 10000000;
    roburoc4_client_init(&client, sizeof client, NULL);
    roburoc4_client_start(&client, roburoc4_udp_now_us());
    do {
        roburoc4_udp_wait(&udp, &client, 50000);
        result = roburoc4_client_arm(&client, roburoc4_udp_now_us());
    } while (result < 0 && !udp.fault && roburoc4_udp_now_us() < end_us);
    return result;
}

/* Step a move to its end, and write down the path; the move's result. */
static int32_t go(roburoc4_move *move, FILE *path) {
    roburoc4_localization_status pose;
    uint64_t now_us = roburoc4_udp_now_us();
    while (!interrupted && roburoc4_move_step(move, &client, now_us) == ROBUROC4_MOVE_RUNNING) {
        roburoc4_result driven =
            roburoc4_client_drive(&client, move->linear_m_s, move->angular_rad_s, 0, now_us);
        (void)driven; /* where it is refused, the next step ends the move and says why */
        roburoc4_udp_wait(&udp, &client, 50000);
        now_us = roburoc4_udp_now_us();
        if (path != NULL && roburoc4_client_localization(&client, &pose, NULL) == 0) {
            fprintf(path, "%.3f,%.3f,%.3f\n", pose.x_m, pose.y_m, pose.theta_rad);
        }
    }
    roburoc4_move_cancel(move, &client, now_us); /* does nothing where the move has ended */
    return move->outcome;
}

int main(int argc, char **argv) {
    if (argc > 1 && argv[1][0] == '-') {
        printf("Usage: drive_square [HOST[:PORT] [PATH.csv]]\n");
        return strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "--help") == 0 ? 0 : 2;
    }
    const char *host = argc > 1 ? argv[1] : ROBUROC4_DEFAULT_HOST;
    FILE *path = argc > 2 ? fopen(argv[2], "w") : NULL;
    int32_t reached = ROBUROC4_MOVE_REACHED;
    signal(SIGINT, on_signal);
    roburoc4_result result = arm(host);
    if (result < 0) {
        fprintf(stderr, "drive_square: no robot to be driven at %s: %s (network: %s)\n", host,
                roburoc4_result_text(result), roburoc4_udp_fault_text(udp.fault));
    }
    for (int i = 0; result == 0 && i < 8 && reached == ROBUROC4_MOVE_REACHED; i++) {
        roburoc4_move move;
        i % 2 == 0 ? roburoc4_move_by(&move, 2.0f, 0, NULL)
                   : roburoc4_move_by(&move, 0, 1.5708f, NULL);
        reached = go(&move, path);
        printf("move %d: %s\n", i + 1, roburoc4_move_outcome_text(reached));
    }
    roburoc4_client_close(&client, roburoc4_udp_now_us());
    while (roburoc4_client_state(&client) != ROBUROC4_STATE_IDLE) {
        roburoc4_udp_wait(&udp, &client, 50000);
    }
    return interrupted ? 128 + interrupted : result < 0 ? 3 : reached != ROBUROC4_MOVE_REACHED;
}
