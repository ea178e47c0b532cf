/* SPDX-License-Identifier: MIT
 *
 * flood_cost KIND COUNT: give a ready client COUNT bad datagrams of one KIND; prints how many it
 * used. bench/flood-cost counts the instructions that roburoc4_client_receive() takes for them.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "roburoc4.h"
#include "roburoc4_sim.h"

static roburoc4_client client;

static int be_ready(void) {
    uint8_t data[ROBUROC4_SIM_MAX_TRANSMIT];
    roburoc4_sim *robot = roburoc4_sim_create(NULL);
    roburoc4_client_init(&client, sizeof client, NULL);
    roburoc4_client_start(&client, 0);
    for (uint64_t now_us = 0; now_us < 5000000; now_us += 5000) {
        roburoc4_result size;
        uint64_t peer;
        roburoc4_sim_advance(robot, now_us);
        while ((size = roburoc4_sim_poll_transmit(robot, &peer, data, sizeof data)) > 0) {
            roburoc4_client_receive(&client, data, (size_t)size, now_us);
        }
        while ((size = roburoc4_client_poll_transmit(&client, data, sizeof data, now_us)) > 0) {
            roburoc4_sim_receive(robot, 1, data, (size_t)size);
        }
    }
    roburoc4_sim_destroy(robot);
    return roburoc4_client_state(&client) == ROBUROC4_STATE_READY;
}

/** Fill `data` with a bad datagram; gives its size, or 0 for no such kind. */
static size_t make(const char *kind, uint8_t *data, unsigned turn) {
    memset(data, 0, 65507);
    if (strcmp(kind, "empty") == 0) {
        return 1;
    }
    if (strcmp(kind, "longest-nonsense") == 0) {
        memset(data, 0x55, 65507);
        return 65507;
    }
    if (strcmp(kind, "foreign-answer") == 0) {
        data[0] = (uint8_t)(1 + turn % 254); /* every id, so that it meets none or any */
        data[2] = 77;
        return 5;
    }
    if (strcmp(kind, "huge-directory") == 0) {
        data[0] = (uint8_t)(1 + turn % 254);
        memset(data + 5, 0x55, 65000);
        return 65005;
    }
    data[0] = ROBUROC4_HEADER_STATUS;
    if (strcmp(kind, "old-status") == 0) {
        data[1] = ROBUROC4_SERVICE_DIFFERENTIAL;
        return 27;
    }
    if (strcmp(kind, "new-status") == 0) { /* the dearest forgery: each is used */
        data[1] = ROBUROC4_SERVICE_IOCARD;
        data[3] = (uint8_t)turn;
        data[4] = (uint8_t)(turn >> 8);
        data[5] = (uint8_t)((turn >> 16) + 1);
        return 50;
    }
    if (strcmp(kind, "unknown-service") == 0) {
        data[1] = 99;
        return 27;
    }
    return 0;
}

int main(int argc, char **argv) {
    static uint8_t data[65507];
    unsigned used = 0;
    const unsigned count = argc == 3 ? (unsigned)strtoul(argv[2], NULL, 10) : 0;
    if (argc != 3 || make(argv[1], data, 0) == 0) {
        (void)fprintf(stderr, "Usage: flood_cost KIND COUNT\n");
        return 2;
    }
    if (!be_ready()) {
        (void)fprintf(stderr, "flood_cost: the client is not ready\n");
        return 1;
    }
    for (unsigned turn = 0; turn < count; turn++) {
        const size_t size = make(argv[1], data, turn);
        used += roburoc4_client_receive(&client, data, size, 5000000 + turn) >= 0;
    }
    printf("%u\n", used);
    return 0;
}
