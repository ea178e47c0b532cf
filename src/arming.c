/* SPDX-License-Identifier: MIT
 *
 * Whether the robot may be driven now, and why not. What every machine knows comes together here;
 * motion itself is in drive.c.
 */
#include "joined.h"

typedef roburoc4_client client;

static bool fresh(const client *c, uint32_t service, uint64_t now_us) {
    return roburoc4_link_fresh(&c->private_link, STATUS_INDEX(service),
                               c->private_config.fresh_ms * MS, now_us);
}

/** Whether an input may be the game pad's [A]: a service that is not known yet may be the card, and
 *  a card may have one until its properties tell. */
static bool may_have_pad(const client *c) {
    const discovery *d = &c->private_discovery;
    const bool listed = (d->listed & service_bit(ROBUROC4_SERVICE_IOCARD)) != 0;
    if (listed) {
        return (d->known & service_bit(ROBUROC4_SERVICE_IOCARD)) == 0 ||
               index_of_role(c, ROBUROC4_ROLE_OVERRIDE) >= 0;
    }
    return roburoc4_discovery_unseen(d);
}

/** Why driving is not allowed now, or 0. */
static roburoc4_result refusal(const client *c, uint64_t now_us) {
    const roburoc4_private_values *v = &c->private_values;
    const uint32_t options = c->private_config.options;
    if (c->private_state != ROBUROC4_STATE_READY) {
        return ROBUROC4_ERR_NOT_READY;
    }
    if (!c->private_drive.known) {
        return ROBUROC4_ERR_NO_DIFFERENTIAL;
    }
    if (!roburoc4_drive_limits_valid(v->limits)) {
        return ROBUROC4_ERR_LIMITS;
    }
    if (!fresh(c, ROBUROC4_SERVICE_DIFFERENTIAL, now_us)) {
        return ROBUROC4_ERR_STALE_DIFFERENTIAL;
    }
    if ((options & ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE) == 0 || may_have_pad(c)) {
        if (!fresh(c, ROBUROC4_SERVICE_IOCARD, now_us)) {
            return ROBUROC4_ERR_STALE_IOCARD;
        }
        if (!v->override_known) {
            return ROBUROC4_ERR_OVERRIDE_UNKNOWN;
        }
    }
    if (v->override_known && v->overridden) {
        return ROBUROC4_ERR_OVERRIDE;
    }
    if (c->private_drive.other_commander && (options & ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER) == 0) {
        return ROBUROC4_ERR_OTHER_COMMANDER;
    }
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_arming_refusal(const client *c, uint64_t now_us) {
    const roburoc4_result why = refusal(c, now_us);
    const drive *d = &c->private_drive;
    return why >= 0 && !d->armed && d->moving ? ROBUROC4_ERR_MOVING : why;
}

void roburoc4_arming_tick(client *c) {
    roburoc4_drive_tick(&c->private_drive, refusal(c, c->private_now_us), c->private_now_us,
                        &c->private_events);
}
