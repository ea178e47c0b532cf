/* SPDX-License-Identifier: MIT
 *
 * client_cost KIND COUNT: do what KIND names COUNT times with a ready client. bench/client-cost
 * counts the instructions.
 */
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include <arpa/inet.h>
#include <netinet/in.h>

#include "roburoc4_sim.h"
#include "roburoc4_udp.h"

#define STEP_US 10000
#define GET_READY_US 20000000

static roburoc4_client client;
static roburoc4_sim *robot;
static bool drives;
static unsigned long heard; /* statuses */
static roburoc4_udp udp;
static uint64_t now_us;
static uint8_t statuses[ROBUROC4_SERVICE_COUNT][ROBUROC4_SIM_MAX_TRANSMIT];
static size_t sizes[ROBUROC4_SERVICE_COUNT];

static void die(const char *why) {
    (void)fprintf(stderr, "client_cost: %s\n", why);
    exit(1);
}

/* ---- a client that is ready, and the robot's last statuses ---- */

/** All that a program calls when a datagram has come, or, without one, when something is due. */
__attribute__((noinline)) static roburoc4_result turn(uint8_t *data, size_t received) {
    roburoc4_result due;
    if (received > 0) {
        (void)roburoc4_client_receive(&client, data, received, now_us);
        if (drives && data[1] == ROBUROC4_SERVICE_DIFFERENTIAL &&
            roburoc4_client_drive(&client, 0.3F, 0, 0, now_us) < 0) {
            die("it no longer drives");
        }
    }
    due = roburoc4_client_poll_transmit(&client, data, ROBUROC4_SIM_MAX_TRANSMIT, now_us);
    (void)roburoc4_client_next_deadline(&client);
    return due;
}

/** The robot's next datagram; or, if it sends no more now, what it sends a cycle later. */
static void hear(void) {
    uint8_t data[ROBUROC4_SIM_MAX_TRANSMIT];
    uint64_t peer;
    const roburoc4_result size = roburoc4_sim_poll_transmit(robot, &peer, data, sizeof data);
    if (size > 0 && data[0] == ROBUROC4_HEADER_STATUS) {
        memcpy(statuses[data[1]], data, (size_t)size);
        sizes[data[1]] = (size_t)size;
        heard++;
    }
    if (size > 0 || roburoc4_client_next_deadline(&client) <= now_us) {
        roburoc4_result due = turn(data, (size_t)size);
        for (; due > 0; due = turn(data, 0)) {
            roburoc4_sim_receive(robot, 1, data, (size_t)due);
        }
    }
    if (size == 0) {
        now_us += STEP_US;
        roburoc4_sim_advance(robot, now_us);
    }
}

static void get_ready(void) {
    const uint64_t until_us = roburoc4_udp_now_us();
    now_us = until_us - GET_READY_US; /* the adapter continues in real time */
    robot = roburoc4_sim_create(NULL);
    roburoc4_sim_clear_obstacles(robot);
    roburoc4_client_init(&client, sizeof client, NULL);
    roburoc4_client_start(&client, now_us);
    while (now_us < until_us) {
        hear();
    }
    if (roburoc4_client_state(&client) != ROBUROC4_STATE_READY) {
        die("the client did not get ready");
    }
}

/** The service's status of the next period, so many cycles later. */
static const uint8_t *next_status(uint32_t service, uint32_t cycles) {
    uint8_t *stamp = statuses[service] + 3;
    uint32_t carry = cycles;
    for (int i = 0; i < 8; i++) {
        carry += stamp[i];
        stamp[i] = (uint8_t)carry;
        carry >>= 8;
    }
    now_us += cycles * ROBUROC4_CYCLE_US;
    return statuses[service];
}

/* ---- kinds ---- */

static void receive(uint32_t service) {
    const uint8_t *status = next_status(service, 5);
    if (roburoc4_client_receive(&client, status, sizes[service], now_us) < 0) {
        die("a status was not used");
    }
}

static void receive_differential(void) {
    receive(ROBUROC4_SERVICE_DIFFERENTIAL);
}

static void receive_iocard(void) {
    receive(ROBUROC4_SERVICE_IOCARD);
}

static void receive_battery(void) {
    receive(ROBUROC4_SERVICE_BATTERY);
}

static void poll_idle(void) {
    uint8_t data[ROBUROC4_MAX_TRANSMIT];
    if (roburoc4_client_poll_transmit(&client, data, sizeof data, now_us) < 0) {
        die("a poll failed");
    }
}

static void watch(void) {
    const unsigned long before = heard;
    while (heard == before) {
        hear();
    }
}

static void drive(void) {
    while (!drives) {
        drives = roburoc4_client_arm(&client, now_us) == ROBUROC4_OK;
        hear();
    }
    watch();
}

static void renew(void) {
    while (!drives) {
        drive();
    }
    if (roburoc4_client_drive(&client, 0.3F, 0.1F, 0, now_us) < 0) {
        die("a lease was not renewed");
    }
}

static void read_facts(void) {
    roburoc4_facts facts;
    if (roburoc4_client_facts(&client, now_us, ROBUROC4_SIZED(&facts)) < 0) {
        die("no facts");
    }
}

static int robot_fd = -1;

static void open_robot(void) {
    struct sockaddr_in to = {.sin_family = AF_INET};
    roburoc4_address address = {.ip = {127, 0, 0, 1}, .family = 4};
    socklen_t size = sizeof to;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    robot_fd = socket(AF_INET, SOCK_DGRAM, 0);
    if (bind(robot_fd, (struct sockaddr *)&to, size) != 0 ||
        getsockname(robot_fd, (struct sockaddr *)&to, &size) != 0) {
        die("no socket for the robot");
    }
    address.port = ntohs(to.sin_port);
    if (roburoc4_udp_open(&udp, sizeof udp, &address) < 0 ||
        getsockname((int)roburoc4_udp_fd(&udp), (struct sockaddr *)&to, &size) != 0 ||
        connect(robot_fd, (struct sockaddr *)&to, size) != 0) {
        die("no socket for the client");
    }
}

static void receive_udp(void) {
    const uint32_t service = ROBUROC4_SERVICE_DIFFERENTIAL;
    if (robot_fd < 0) {
        open_robot();
    }
    (void)poll(NULL, 0, ROBUROC4_CYCLE_US / 1000); /* no robot is ahead of real time */
    if (send(robot_fd, next_status(service, 1), sizes[service], 0) < 0 ||
        roburoc4_udp_receive(&udp, &client, NULL, NULL) != 1) {
        die("a status did not come through");
    }
}

static const struct {
    const char *name;
    void (*run)(void);
} kinds[] = {
    {"receive-differential", receive_differential},
    {"receive-iocard", receive_iocard},
    {"receive-battery", receive_battery},
    {"poll-idle", poll_idle},
    {"renew", renew},
    {"facts", read_facts},
    {"watching", watch},
    {"driving", drive},
    {"udp-differential", receive_udp},
};

int main(int argc, char **argv) {
    for (size_t i = 0; argc == 3 && i < sizeof kinds / sizeof kinds[0]; i++) {
        if (strcmp(argv[1], kinds[i].name) == 0) {
            get_ready();
            for (long left = strtol(argv[2], NULL, 10); left > 0; left--) {
                kinds[i].run();
            }
            return 0;
        }
    }
    (void)fprintf(stderr, "usage: client_cost KIND COUNT\n");
    return 2;
}
