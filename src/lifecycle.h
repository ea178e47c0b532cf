/* SPDX-License-Identifier: MIT
 *
 * The states of a client, what ends with them, and the clock.
 */
#ifndef ROBUROC4_LIFECYCLE_H
#define ROBUROC4_LIFECYCLE_H

#include "internal.h"

/** The remembered deadline is no longer valid. Whoever makes something due earlier calls this: all
 * that changes a state, a lease, a request or a time that poll_all() asks of, outside of a poll. */
static inline void wake(roburoc4_client *c) {
    c->private_idle_until_us = 0;
}

void roburoc4_lifecycle_enter(roburoc4_client *c, uint32_t state);
/** End driving for this cause. */
void roburoc4_lifecycle_interrupt(roburoc4_client *c, roburoc4_result cause);
/** Forget the outputs that were set. */
void roburoc4_lifecycle_forget_outputs(roburoc4_client *c);
void roburoc4_lifecycle_relocalize_ends(roburoc4_client *c, roburoc4_result result);
/** Read everything about the services again, beginning with this state. */
void roburoc4_lifecycle_forget_services(roburoc4_client *c, uint32_t state);
/** Begin anew with the directory: forgets requests, what the link knows and the services. */
void roburoc4_lifecycle_connect(roburoc4_client *c, uint32_t state);
/** The robot restarted: discover it again. */
void roburoc4_lifecycle_reboot(roburoc4_client *c);
/** Before the time becomes now_us: it went back, the program paused, or ages must be limited. */
void roburoc4_lifecycle_jump(roburoc4_client *c, uint64_t now_us);
/** The door, where times have 64 bits: every public call with a time that may change something
 * begins with this. */
static inline void see_time(roburoc4_client *c, uint64_t now_us) {
    if (now_us - c->private_now_us >= PAUSE_US || (now_us ^ c->private_now_us) >> AGES_BITS != 0) {
        roburoc4_lifecycle_jump(c, now_us);
    }
    c->private_now_us = now_us;
    c->private_timer.now_us = (uint32_t)now_us;
}
/** Whether a lease is over and that was not noticed yet: notice it before anything else. */
static inline bool lapses(const roburoc4_private_drive *d, uint32_t now_us) {
    return (d->lease_active || (d->lapsed && d->armed)) && now_us - d->granted_us >= d->lease_us;
}
/** As see_time(), out of line and so smaller, for rare calls. It also notices a lapse. */
void roburoc4_lifecycle_see_time(roburoc4_client *c, uint64_t now_us);
/** The same for a call that makes something due. */
static inline void begin_call(roburoc4_client *c, uint64_t now_us) {
    roburoc4_lifecycle_see_time(c, now_us);
    wake(c);
}

#endif
