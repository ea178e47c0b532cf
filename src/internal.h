/* SPDX-License-Identifier: MIT
 *
 * What the files share that put the state machines together: client.c, lifecycle.c, schedule.c,
 * receive.c, conditions.c, commands.c and values.c.
 */
#ifndef ROBUROC4_INTERNAL_H
#define ROBUROC4_INTERNAL_H

#include "machines.h"

typedef roburoc4_client client;
typedef roburoc4_private_values values;

static inline void count_up(roburoc4_client *c, uint32_t counter) {
    if (WITH_STATISTICS) {
        c->private_counters[counter]++;
    }
}

static inline void raise_event(roburoc4_client *c, uint32_t event) {
    c->private_events |= event;
}

/** The robot has been found and is not lost. */
static inline bool connected(const roburoc4_client *c) {
    return c->private_state >= ROBUROC4_STATE_DISCOVERING &&
           c->private_state <= ROBUROC4_STATE_READY;
}

/** Whether the robot has a service that the client wants to be subscribed to. */
static inline bool expects_statuses(const roburoc4_client *c) {
    return (c->private_config.subscriptions & c->private_discovery.listed) != 0;
}

/** Until the next status of the right input, nothing is known of the override. */
static inline void forget_override(roburoc4_client *c) {
    c->private_conditions.override_known = 0;
    c->private_conditions.overridden = 0;
}

/** Index of the input with a role, or ROBUROC4_ERR_NOT_KNOWN. */
static inline roburoc4_result index_of_role(const roburoc4_client *c, uint32_t role) {
    return roburoc4_discovery_role(&c->private_discovery, &c->private_config,
                                   c->private_values.io_counts, role,
                                   in_fixed_id_mode(&c->private_requests));
}

/* How long to wait for the texts of the directory before services without one are left out. */
#define IDENTIFY_US SECOND
/* One probe a second goes to each service in turn. While it drives, more show that the robot still
 * receives; while a stop waits for proof, that its zeros arrived. */
static inline uint32_t probe_period_us(roburoc4_client *c) {
    return roburoc4_drive_asks(&c->private_drive, &c->private_timer) ? 50 * MS
           : c->private_drive.lease_active                           ? 150 * MS
                                                                     : SECOND;
}

/* ---- conditions.c ---- */

/** Whether the program allows to drive without knowing [A], and everything that could name it was
 * read or asked in vain. A configured input exists unless the card has fewer inputs. */
bool roburoc4_conditions_without_pad(const roburoc4_client *c);
/** Pass the time and the conditions of driving to the drive state machine. */
void roburoc4_conditions_tick(roburoc4_client *c);
/** Raise the event of a client that became armable. */
void roburoc4_conditions_watch_arming(roburoc4_client *c);
/** Why arming is refused, or 0. */
roburoc4_result roburoc4_conditions_refusal(const roburoc4_client *c, uint64_t now_us);

/* ---- schedule.c ---- */

/** A request failed: refused by the robot, answered with an invalid telegram, or never answered. */
void roburoc4_schedule_failed(roburoc4_client *c, const slot *s, roburoc4_result why);
/** Note whether the robot has moved since a pose was given. */
void roburoc4_schedule_watch_pose(roburoc4_client *c);
/** Before a datagram is looked at: note a gap in statuses since the pose, in which the robot may
 * have moved. */
void roburoc4_schedule_pose_waits(roburoc4_client *c);
/** The robot accepted the pose: does it still hold? */
void roburoc4_schedule_pose_taken(roburoc4_client *c, const slot *s);
/** Encode the next request that is due: its length, or 0. */
roburoc4_result roburoc4_schedule_poll(roburoc4_client *c, uint8_t *buffer, size_t capacity);

#endif
