/* SPDX-License-Identifier: MIT
 *
 * network.h - a bad network in virtual time for the walk, and the dice that everything in it is
 * drawn from: the same numbers on every target.
 */
#ifndef ROBUROC4_TESTS_PORTABLE_NETWORK_H
#define ROBUROC4_TESTS_PORTABLE_NETWORK_H

#include <stddef.h>
#include <stdint.h>

#define TO_CLIENT 0
#define TO_ROBOT 1
#define NETWORK_LONGEST 75
#define NETWORK_FLIGHTS 20

typedef struct flight {
    uint64_t at_us;
    uint8_t used, to, size;
    uint8_t data[NETWORK_LONGEST];
} flight;

typedef struct network {
    uint32_t dice;
    uint8_t loss, duplicate, damage; /* of 256 */
    uint32_t delay_us, jitter_us;
    flight flights[NETWORK_FLIGHTS];
} network;

/** 0 to below - 1. */
uint32_t roll(network *n, uint32_t below);
/** True in `of_256` of 256 cases. */
int chance(network *n, uint8_t of_256);

void network_send(network *n, int to, const uint8_t *data, size_t size, uint64_t now_us);
/** Take the first datagram that has arrived at `to`: its length, or 0. */
size_t network_take(network *n, int to, uint64_t now_us, uint8_t *buffer);
/** When the next one arrives anywhere; UINT64_MAX: none is on its way. */
uint64_t network_next_us(const network *n);

#endif
