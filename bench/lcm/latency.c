/* SPDX-License-Identifier: MIT
 *
 * lcm_latency LCM_URL BARE_PORT ROUNDS: how long a localization status takes from the robot's
 * send() to an LCM subscriber, through roburoc4-lcm and through lcm_bare, by turns, in changing
 * order.
 *
 * It is the robot (a simulator that answers, and whose statuses are sent when this program wants)
 * and the subscriber, so that one clock serves for both ends. Prints its robot's port, waits until
 * a bridge has subscribed there, and then prints a line for each round: the microseconds through
 * the bridge, and through the bare loop.
 */
#define _POSIX_C_SOURCE 200809L
#include <arpa/inet.h>
#include <lcm/lcm.h>
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>

#include "roburoc4_sim.h"

#define ROUND_US 10000
#define PATIENCE_MS 100
#define READY_ROUNDS 500
#define LOCALIZATION_ID 5

typedef struct bench {
    lcm_t *lcm;
    roburoc4_sim *sim;
    int robot; /* our socket as robot */
    struct sockaddr_in bridge;
    struct sockaddr_in bare;
    int heard; /* a message came on the channel that is waited for */
    const char *awaited;
    uint64_t heard_ns;
    uint8_t status[64]; /* the simulator's newest */
    size_t status_size;
    int is_new; /* the bridge, which drops what it had, did not get it yet */
} bench;

static uint64_t now_ns(void) {
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

static void on_message(const lcm_recv_buf_t *buffer, const char *channel, void *user) {
    bench *bench = user;
    uint64_t arrived_ns = now_ns();
    (void)buffer;
    if (bench->awaited != NULL && strcmp(channel, bench->awaited) == 0) {
        bench->heard = 1;
        bench->heard_ns = arrived_ns;
    }
}

/* The simulator answers what the bridge asks; its localization statuses are kept back, to be sent
 * when their time is measured. */
static void serve(bench *bench) {
    uint8_t data[ROBUROC4_SIM_MAX_TRANSMIT];
    struct sockaddr_in from;
    socklen_t length = sizeof from;
    ssize_t size = 0;
    roburoc4_sim_advance(bench->sim, now_ns() / 1000);
    while ((size = recvfrom(bench->robot, data, sizeof data, MSG_DONTWAIT, (struct sockaddr *)&from,
                            &length)) > 0) {
        bench->bridge = from;
        roburoc4_sim_receive(bench->sim, 1, data, (size_t)size);
    }
    uint64_t peer = 0;
    roburoc4_result got = 0;
    while ((got = roburoc4_sim_poll_transmit(bench->sim, &peer, data, sizeof data)) > 0) {
        roburoc4_localization_status status;
        if (data[0] == 0xff && data[1] == LOCALIZATION_ID &&
            roburoc4_decode_localization_status(data, (size_t)got, &status) >= 0) {
            memcpy(bench->status, data, (size_t)got);
            bench->status_size = (size_t)got;
            bench->is_new = 1;
        } else {
            (void)sendto(bench->robot, data, (size_t)got, 0, (struct sockaddr *)&bench->bridge,
                         sizeof bench->bridge);
        }
    }
}

/* Send the status and wait for its message: microseconds, or less than 0 where none came. */
static double once(bench *bench, const struct sockaddr_in *receiver, const char *channel) {
    bench->awaited = channel;
    bench->heard = 0;
    uint64_t sent_ns = now_ns();
    (void)sendto(bench->robot, bench->status, bench->status_size, 0,
                 (const struct sockaddr *)receiver, sizeof *receiver);
    while (bench->heard == 0 && now_ns() - sent_ns < PATIENCE_MS * 1000000u) {
        (void)lcm_handle_timeout(bench->lcm, PATIENCE_MS);
    }
    bench->awaited = NULL;
    return bench->heard != 0 ? (double)(bench->heard_ns - sent_ns) / 1000.0 : -1.0;
}

/* Serve, and throw other messages away, until then. */
static void rest(bench *bench, uint64_t until_ns) {
    while (now_ns() < until_ns) {
        struct pollfd ends[2] = {{.fd = bench->robot, .events = POLLIN},
                                 {.fd = lcm_get_fileno(bench->lcm), .events = POLLIN}};
        (void)poll(ends, 2, 1);
        while (lcm_handle_timeout(bench->lcm, 0) > 0) {
        }
        serve(bench);
    }
}

static double to_bridge(bench *bench) {
    if (bench->is_new == 0) {
        return -1.0;
    }
    bench->is_new = 0;
    return once(bench, &bench->bridge, "ROBUROC4_LOCALIZATION");
}

static int open_all(bench *bench, char **arguments) {
    socklen_t length = sizeof bench->bridge;
    struct sockaddr_in own;
    memset(&own, 0, sizeof own);
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    bench->bare = own;
    bench->bare.sin_port = htons((uint16_t)strtoul(arguments[2], NULL, 10));
    bench->robot = socket(AF_INET, SOCK_DGRAM, 0);
    bench->lcm = lcm_create(arguments[1]);
    bench->sim = roburoc4_sim_create(NULL);
    if (bench->robot < 0 || bench->lcm == NULL || bench->sim == NULL ||
        bind(bench->robot, (struct sockaddr *)&own, sizeof own) != 0 ||
        getsockname(bench->robot, (struct sockaddr *)&own, &length) != 0) {
        return -1;
    }
    (void)lcm_subscribe(bench->lcm, "BARE|ROBUROC4_LOCALIZATION", on_message, bench);
    (void)printf("%u\n", ntohs(own.sin_port));
    (void)fflush(stdout);
    return 0;
}

/* Until the bridge republishes what we send. */
static int wait_for_bridge(bench *bench) {
    for (int round = 0; round < READY_ROUNDS; round++) {
        rest(bench, now_ns() + ROUND_US * 1000u);
        if (round > 200 && to_bridge(bench) >= 0.0) {
            return 0;
        }
    }
    return -1;
}

int main(int count, char **arguments) {
    static bench bench;
    if (count != 4 || open_all(&bench, arguments) != 0) {
        (void)fprintf(stderr, "usage: lcm_latency LCM_URL BARE_PORT ROUNDS\n");
        return 1;
    }
    if (wait_for_bridge(&bench) != 0) {
        (void)fprintf(stderr, "lcm_latency: no bridge republishes the localization\n");
        return 1;
    }
    long rounds = strtol(arguments[3], NULL, 10);
    for (long round = 0; round < rounds; round++) {
        double us[2]; /* bridge, bare loop; the other one first in the next round */
        for (long half = 0; half < 2; half++) {
            rest(&bench, now_ns() + ROUND_US * 500u);
            if (((round + half) & 1) == 0) {
                us[1] = once(&bench, &bench.bare, "BARE");
            } else {
                for (int wait = 0; bench.is_new == 0 && wait < 1000; wait++) {
                    rest(&bench, now_ns() + ROUND_US * 100u);
                }
                us[0] = to_bridge(&bench);
            }
        }
        (void)printf("%.2f %.2f\n", us[0], us[1]);
    }
    roburoc4_sim_destroy(bench.sim);
    lcm_destroy(bench.lcm);
    return 0;
}
