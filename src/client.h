/* SPDX-License-Identifier: MIT
 *
 * What the files of the joined client share: client.c (life and datagrams), control.c (what a user
 * asks for), snapshot.c (what a user reads).
 */
#ifndef ROBUROC4_CLIENT_H
#define ROBUROC4_CLIENT_H

#include "machines.h"

static inline uint8_t service_bit(uint32_t service) {
    return (uint8_t)(1U << service);
}

/** Every public call that knows the time begins here: a clock that went back is a fault. */
void roburoc4_client_clock(roburoc4_client *c, uint64_t now_us);
/** What motion depends on, at this time. */
conditions roburoc4_client_conditions(const roburoc4_client *c, uint64_t now_us);
/** Let the drive machine see the time and the conditions. */
void roburoc4_client_tick_drive(roburoc4_client *c, uint64_t now_us);
/** The reason against arming, or 0. */
roburoc4_result roburoc4_client_arm_refusal(const roburoc4_client *c, uint64_t now_us);

/** Take the properties of a service from a good answer: 0 or more, or what is wrong with it. */
roburoc4_result roburoc4_snapshot_properties(roburoc4_client *c, uint32_t service,
                                             const uint8_t *data, size_t size);
/** Check a status's layout and, where `store`, take its values. */
roburoc4_result roburoc4_snapshot_status(roburoc4_client *c, uint32_t service, const uint8_t *data,
                                         size_t size, bool store);

#endif
