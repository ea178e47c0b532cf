/* SPDX-License-Identifier: MIT
 *
 * The conditions of driving: which of them fails first, in the order in which arm() reports them;
 * and what follows from that as time passes.
 */
#include "internal.h"

/* In fixed-id mode, requests go one by one, and slowly where some are lost. */
#define UNANSWERED_US (10 * SECOND)

static bool fresh(const client *c, uint32_t service, uint64_t now_us, timer *t) {
    return roburoc4_link_fresh(&c->private_link, STATUS_INDEX(service),
                               c->private_config.fresh_ms * MS, now_us, t);
}

/* Without texts, only the program can say which services these are, and which input is [A]. */

static bool pad_can_be_found(const roburoc4_config *config) {
    return WITH_TEXTS ||
           (config->iocard_id >= 0 && config->role_index[ROBUROC4_ROLE_OVERRIDE] >= 0);
}

/** Either the texts of all inputs were given, refused, or asked for in vain, or there is no card;
 * and no text names [A]. */
static bool nothing_names_pad(const client *c, bool card) {
    const discovery *d = &c->private_discovery;
    const int32_t *counts = c->private_values.io_counts;
    const bool passed = card ? roburoc4_discovery_inputs_passed(d, counts)
                             : c->private_config.iocard_id < 0 &&
                                   !roburoc4_discovery_doubtful(d, &c->private_config);
    return passed && counts[ROBUROC4_IO_DIGITAL_INPUT] <= ROBUROC4_MAX_DIGITAL_INPUTS &&
           d->role_texts[ROBUROC4_ROLE_OVERRIDE] == ROLE_TEXT_NONE;
}

bool roburoc4_conditions_without_pad(const client *c) {
    if ((c->private_config.options & ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE) == 0) {
        return false;
    }
    const discovery *d = &c->private_discovery;
    const bool automatic =
        c->private_config.role_index[ROBUROC4_ROLE_OVERRIDE] == ROBUROC4_INDEX_AUTO;
    const bool card = (d->listed & service_bit(ROBUROC4_SERVICE_IOCARD)) != 0;
    const bool counted = (d->known & service_bit(ROBUROC4_SERVICE_IOCARD)) != 0;
    return pad_can_be_found(&c->private_config) && d->truncated == 0 &&
           (counted || (automatic && !card)) && index_of_role(c, ROBUROC4_ROLE_OVERRIDE) < 0 &&
           (!automatic || nothing_names_pad(c, card));
}

/** Why there is no fresh status of a service: `stale`, unless there is no subscription. A service
 * that is not listed may be one that is not identified yet. */
static roburoc4_result not_fresh(const client *c, uint32_t service, roburoc4_result stale) {
    const discovery *d = &c->private_discovery;
    const bool listed = (d->listed & service_bit(service)) != 0;
    const uint8_t missing =
        roburoc4_subscriptions_missing(&c->private_subscriptions, &c->private_config, d);
    return (missing & service_bit(service)) != 0 &&
                   (listed || !roburoc4_discovery_doubtful(d, &c->private_config))
               ? ROBUROC4_ERR_SUBSCRIPTION_REFUSED
               : stale;
}

static bool knows_differential(const client *c) {
    return c->private_drive.known && (WITH_TEXTS || c->private_config.differential_id >= 0);
}

static bool knows_override(const client *c) {
    return c->private_conditions.override_known && pad_can_be_found(&c->private_config);
}

static bool commanded_by_another(const client *c) {
    return c->private_drive.other_commander &&
           (c->private_config.options & ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER) == 0;
}

/** Why driving is not allowed now, or 0. */
static roburoc4_result refusal(const client *c, uint64_t now_us, timer *t) {
    if (c->private_state != ROBUROC4_STATE_READY) {
        return ROBUROC4_ERR_NOT_READY;
    }
    if (!knows_differential(c)) {
        return ROBUROC4_ERR_NO_DIFFERENTIAL;
    }
    if (!roburoc4_drive_limits_valid(&c->private_values.limits)) {
        return ROBUROC4_ERR_LIMITS;
    }
    if (!fresh(c, ROBUROC4_SERVICE_DIFFERENTIAL, now_us, t)) {
        return not_fresh(c, ROBUROC4_SERVICE_DIFFERENTIAL, ROBUROC4_ERR_STALE_DIFFERENTIAL);
    }
    if (!roburoc4_conditions_without_pad(c)) {
        if (!fresh(c, ROBUROC4_SERVICE_IOCARD, now_us, t)) {
            return not_fresh(c, ROBUROC4_SERVICE_IOCARD, ROBUROC4_ERR_STALE_IOCARD);
        }
        if (!knows_override(c)) {
            return ROBUROC4_ERR_OVERRIDE_UNKNOWN;
        }
    }
    if (c->private_conditions.overridden) {
        return ROBUROC4_ERR_OVERRIDE;
    }
    if (commanded_by_another(c)) {
        return ROBUROC4_ERR_OTHER_COMMANDER;
    }
    return roburoc4_drive_is_cut_off(&c->private_drive) ? ROBUROC4_ERR_UPLINK : ROBUROC4_OK;
}

roburoc4_result roburoc4_conditions_refusal(const client *c, uint64_t now_us) {
    timer unused = {0, UINT32_MAX};
    const roburoc4_result why = refusal(c, now_us, &unused);
    const bool moves = roburoc4_drive_moving(&c->private_values.differential);
    return why >= 0 && !c->private_drive.armed && moves ? ROBUROC4_ERR_MOVING : why;
}

int32_t roburoc4_refusal_may_pass(roburoc4_result refusal) {
    return refusal == ROBUROC4_ERR_NOT_READY || refusal == ROBUROC4_ERR_STALE_DIFFERENTIAL ||
           refusal == ROBUROC4_ERR_STALE_IOCARD || refusal == ROBUROC4_ERR_OVERRIDE_UNKNOWN ||
           refusal == ROBUROC4_ERR_MOVING || refusal == ROBUROC4_ERR_UPLINK;
}

void roburoc4_conditions_watch_arming(client *c) {
    const bool armable =
        !c->private_drive.armed && roburoc4_conditions_refusal(c, c->private_now_us) >= 0;
    raise_event(c, armable && !c->private_conditions.armable ? ROBUROC4_EVENT_ARMABLE : 0);
    c->private_conditions.armable = armable;
}

void roburoc4_conditions_tick(client *c) {
    timer *t = &c->private_timer;
    timer unarmed = *t; /* whether its statuses become stale is asked when it is to be armed */
    if (c->private_drive.lease_active &&
        t->now_us - c->private_drive.granted_us < c->private_drive.lease_us) { /* else it hung */
        c->private_driven_us = t->now_us;
    }
    /* in fixed-id mode, an answer does not prove when its request arrived; but some must come */
    if (in_fixed_id_mode(&c->private_requests) &&
        t->now_us - c->private_answered_us < UNANSWERED_US) {
        roburoc4_drive_heard(&c->private_drive, t->now_us);
    }
    roburoc4_drive_tick(&c->private_drive, &c->private_config,
                        refusal(c, c->private_now_us, c->private_drive.armed ? t : &unarmed), t,
                        &c->private_events);
    roburoc4_conditions_watch_arming(c);
}
