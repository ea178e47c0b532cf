/* SPDX-License-Identifier: MIT
 *
 * robot.h - a robot for the walk, small enough for an 8-bit controller: seven services, answers,
 * subscriptions, targets with the watchdog, a game pad, and reboots. Time is the caller's.
 */
#ifndef ROBUROC4_TESTS_PORTABLE_ROBOT_H
#define ROBUROC4_TESTS_PORTABLE_ROBOT_H

#include "roburoc4.h"

#define ROBOT_WATCHDOG_US 1000000UL
#define ROBOT_MAX_LINEAR 2.5f
#define ROBOT_MAX_ANGULAR 6.0f

typedef struct robot {
    uint64_t now_us, boot_us, cycles, commanded_us;
    uint16_t first_id; /* of the five services that robots number as they like, 2 on a RobuROC4 */
    uint8_t powered;
    uint8_t periods[ROBUROC4_SERVICE_COUNT]; /* in cycles, by ROBUROC4_SERVICE_*; 0: none */
    uint8_t due;                             /* bit by ROBUROC4_SERVICE_* */
    uint8_t pad_a;
    float target[2];
} robot;

/** Switch it on. */
void robot_boot(robot *r, uint64_t now_us);
uint16_t robot_id(const robot *r, uint32_t service);
/** Advance its time by less than a second. */
void robot_advance(robot *r, uint64_t now_us);
/** Whether it has a target that is not 0. */
int robot_moves(const robot *r);
/** The next status that is due, or 0. */
size_t robot_status(robot *r, uint8_t *buffer, size_t capacity);
/** A datagram for it; gives the length of its answer, or 0. */
size_t robot_hear(robot *r, const uint8_t *data, size_t size, uint8_t *buffer, size_t capacity);

#endif
