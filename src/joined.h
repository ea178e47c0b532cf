/* SPDX-License-Identifier: MIT
 *
 * What the files of the joined client share, from the ground up: each calls only what stands above
 * it here. client.c, receive.c, control.c and report.c are the public calls.
 */
#ifndef ROBUROC4_JOINED_H
#define ROBUROC4_JOINED_H

#include "machines.h"

static inline uint8_t service_bit(uint32_t service) {
    return (uint8_t)(1U << service);
}

static inline uint32_t at_most(uint32_t value, uint32_t limit) {
    return value < limit ? value : limit;
}

static inline void count(roburoc4_client *c, uint32_t counter) {
    c->private_counters[counter]++;
}

static inline void raise_event(roburoc4_client *c, uint32_t event) {
    c->private_events |= event;
}

/** The robot has been found and is not lost. */
static inline bool connected(const roburoc4_client *c) {
    return c->private_state >= ROBUROC4_STATE_DISCOVERING &&
           c->private_state <= ROBUROC4_STATE_READY;
}

/** Index of the input with a role, or ROBUROC4_ERR_UNKNOWN. */
static inline roburoc4_result index_of_role(const roburoc4_client *c, uint32_t role) {
    return roburoc4_discovery_role(&c->private_discovery, &c->private_config,
                                   c->private_values.io_counts, role);
}

/* How long to wait for the texts of the directory before the manual's ids are believed. */
#define IDENTIFY_US SECOND
/* One question a second goes to each service in turn. */
#define PROBE_US SECOND

/* ---- lifecycle.c: the states, and what ends with them ---- */

void roburoc4_lifecycle_enter(roburoc4_client *c, uint32_t state);
/** Leave driving for this cause. */
void roburoc4_lifecycle_interrupt(roburoc4_client *c, roburoc4_result cause);
/** Outputs that were set are no more. */
void roburoc4_lifecycle_forget_outputs(roburoc4_client *c);
void roburoc4_lifecycle_relocalize_ends(roburoc4_client *c, roburoc4_result result);
/** What was learned about services counts no more until it is read again, from this state on. */
void roburoc4_lifecycle_forget_services(roburoc4_client *c, uint32_t state);
/** Ask for the directory. */
void roburoc4_lifecycle_connect(roburoc4_client *c, uint32_t state);
/** The robot has been silent for too long. */
void roburoc4_lifecycle_lose(roburoc4_client *c);
/** The robot restarted: it is discovered anew. */
void roburoc4_lifecycle_reboot(roburoc4_client *c);
/** Every public call that knows the time begins here: a clock that went back is a fault. */
void roburoc4_lifecycle_clock(roburoc4_client *c, uint64_t now_us);

/* ---- arming.c: whether the robot may be driven now ---- */

/** The reason against arming, or 0. */
roburoc4_result roburoc4_arming_refusal(const roburoc4_client *c, uint64_t now_us);
/** Let the drive machine see the time and the conditions. */
void roburoc4_arming_tick(roburoc4_client *c);

/* ---- snapshot.c: values in ---- */

/** Take the properties of a service from a good answer: 0 or more, or what is wrong with it. */
roburoc4_result roburoc4_snapshot_properties(roburoc4_client *c, uint32_t service,
                                             const uint8_t *data, size_t size);
/** A status of any service; each begins with its time. */
typedef union any_status {
    uint64_t robot_cycles;
    roburoc4_channels iocard;
    roburoc4_telemeter_status telemeter;
    roburoc4_battery_status battery;
    roburoc4_localization_status localization;
    roburoc4_differential_status differential;
} any_status;

roburoc4_result roburoc4_snapshot_decode(const roburoc4_client *c, uint32_t service,
                                         const uint8_t *data, size_t size, any_status *out);
void roburoc4_snapshot_store(roburoc4_client *c, uint32_t service, const any_status *status);

/* ---- asking.c: requests ---- */

/** A request came to nothing: refused by the robot, answered with nonsense, or never answered. */
void roburoc4_asking_failed(roburoc4_client *c, const slot *s, roburoc4_result why);
/** Services that were subscribed to and send nothing are subscribed to again. */
void roburoc4_asking_renew_silent(roburoc4_client *c);
/** When the first of them has been silent for long enough. */
uint64_t roburoc4_asking_deadline(const roburoc4_client *c);
/** The next request that must leave now: its length, or 0. */
roburoc4_result roburoc4_asking_poll(roburoc4_client *c, uint8_t *buffer, size_t capacity);

#endif
