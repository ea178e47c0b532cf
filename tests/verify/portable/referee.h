/* SPDX-License-Identifier: MIT
 *
 * referee.h - the small referee of the walk: a client under supervision, with books of its own on
 * what was asked for, received and sent. It complains (a failed CHECK, by its line) as soon as a
 * promise of docs/SAFETY.md is broken. Its big brother for hosts is ../soak/referee.h.
 */
#ifndef ROBUROC4_TESTS_PORTABLE_REFEREE_H
#define ROBUROC4_TESTS_PORTABLE_REFEREE_H

#include "robot.h"

typedef struct referee {
    roburoc4_client client;
    roburoc4_config config;
    uint16_t iocard_id, differential_id;
    uint8_t monitor; /* it never commands */
    uint8_t armed, leased, overridden, spoke, known, sent_any, calling;
    uint8_t train, confirmed, confirmed_late;
    uint32_t zeros;
    uint64_t now_us, granted_us, sent_us, first_zero_us;
    uint32_t lease_us;
    float target[2], sent[2];
    uint32_t digest; /* of all that left, and when */
    uint32_t speeds, trains, overrides, lost, reboots, clock_faults, leases_over;
} referee;

void referee_begin(referee *f, const robot *r, uint64_t now_us);
roburoc4_result referee_arm(referee *f, uint64_t now_us);
void referee_disarm(referee *f, uint64_t now_us);
roburoc4_result referee_drive(referee *f, float linear, float angular, uint64_t now_us);
void referee_stop(referee *f, uint64_t now_us);
void referee_close(referee *f, uint64_t now_us);
void referee_receive(referee *f, const uint8_t *data, size_t size, uint64_t now_us);
/** The next datagram to send, or 0. */
size_t referee_poll(referee *f, uint8_t *buffer, size_t capacity, uint64_t now_us);

#endif
