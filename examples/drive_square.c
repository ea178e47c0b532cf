/* SPDX-License-Identifier: MIT
 *
 * drive_square [HOST[:PORT] | simulated [PATH.csv]]: a square of 2 m to the left, made of eight
 * moves; or the same with a simulator in this program, whose minute takes less than a second. A
 * line of the file is "x_m,y_m,theta_rad"; where the robot is simulated, its true pose follows.
 * Exit status: 0 driven, 1 not (all the way), 3 no robot there, 130 after Ctrl-C.
 */
#include <roburoc4_move.h>
#include <roburoc4_sim.h>
#include <roburoc4_udp.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#define PEER 1 /* how the simulator knows us */

static roburoc4_client client;
static roburoc4_udp udp;
static roburoc4_sim *sim; /* NULL: a robot, by UDP */
static uint64_t sim_now_us;
static volatile sig_atomic_t interrupted;

static void on_signal(int number) {
    interrupted = number;
}

static uint64_t now_us(void) {
    return sim != NULL ? sim_now_us : roburoc4_udp_now_us();
}

/* Receive and send what there is, and wait for it: 50 ms at most. */
static void exchange(void) {
    uint8_t datagram[ROBUROC4_SIM_MAX_TRANSMIT];
    uint64_t peer;
    int32_t size;
    if (sim == NULL) {
        roburoc4_udp_wait(&udp, &client, 50000);
        return;
    }
    sim_now_us += 10000;
    while ((size = roburoc4_client_poll_transmit(&client, datagram, sizeof datagram, sim_now_us)) >
           0) {
        roburoc4_sim_receive(sim, PEER, datagram, (size_t)size);
    }
    roburoc4_sim_advance(sim, sim_now_us);
    while ((size = roburoc4_sim_poll_transmit(sim, &peer, datagram, sizeof datagram)) > 0) {
        roburoc4_client_receive(&client, datagram, (size_t)size, sim_now_us);
    }
}

static roburoc4_result open_robot(const char *host) {
    roburoc4_address address;
    if (strcmp(host, "simulated") == 0) {
        sim = roburoc4_sim_create(NULL);
        return sim == NULL ? ROBUROC4_ERR_SYSTEM : ROBUROC4_OK;
    }
    const roburoc4_result result = roburoc4_udp_resolve(host, 0, &address);
    return result < 0 ? result : roburoc4_udp_open(&udp, sizeof udp, &address);
}

/* Connect and arm, for 10 s at most; less than 0 says why that failed. */
static roburoc4_result arm(const char *host) {
    roburoc4_result result = open_robot(host);
    if (result < 0) {
        return result;
    }
    const uint64_t end_us = now_us() + 10000000;
    roburoc4_client_init(&client, sizeof client, NULL);
    roburoc4_client_start(&client, now_us());
    do {
        exchange();
        result = roburoc4_client_arm(&client, now_us());
    } while (result < 0 && !udp.fault && now_us() < end_us);
    return result;
}

static void write_pose(FILE *path) {
    roburoc4_localization_status pose;
    roburoc4_sim_state state;
    if (path == NULL || roburoc4_client_localization(&client, &pose, NULL) < 0) {
        return;
    }
    fprintf(path, "%.3f,%.3f,%.3f", pose.x_m, pose.y_m, pose.theta_rad);
    if (sim != NULL && roburoc4_sim_get_state(sim, ROBUROC4_SIZED(&state)) == 0) {
        fprintf(path, ",%.3f,%.3f,%.3f", state.true_x_m, state.true_y_m, state.true_theta_rad);
    }
    fputc('\n', path);
}

/* Step a move to its end, and write down the path; the move's result. */
static int32_t go(roburoc4_move *move, FILE *path) {
    while (!interrupted && roburoc4_move_step(move, &client, now_us()) == ROBUROC4_MOVE_RUNNING) {
        roburoc4_result driven =
            roburoc4_client_drive(&client, move->linear_m_s, move->angular_rad_s, 0, now_us());
        (void)driven; /* where it is refused, the next step ends the move and says why */
        exchange();
        write_pose(path);
    }
    roburoc4_move_cancel(move, &client, now_us()); /* does nothing where the move has ended */
    return move->outcome;
}

int main(int argc, char **argv) {
    if (argc > 1 && argv[1][0] == '-') {
        printf("Usage: drive_square [HOST[:PORT] | simulated [PATH.csv]]\n");
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
    roburoc4_client_close(&client, now_us());
    while (roburoc4_client_state(&client) != ROBUROC4_STATE_IDLE) {
        exchange();
    }
    roburoc4_sim_destroy(sim);
    return interrupted ? 128 + interrupted : result < 0 ? 3 : reached != ROBUROC4_MOVE_REACHED;
}
