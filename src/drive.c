/* SPDX-License-Identifier: MIT
 *
 * Motion: arming, the lease of a drive command, limits, the zero train. This is the only place that
 * lets a speed out, and it does so in one function, roburoc4_drive_poll().
 *
 * Times are compared as `now - then >= span` on unsigned numbers: a clock that went back makes the
 * difference huge and the lease over.
 */
#include "bytes.h"
#include "machines.h"

/* A changed target leaves at once, but not more often than the robot looks. */
#define SPACING_US ROBUROC4_CYCLE_US
#define TRAIN_ZEROS 3
#define OTHER_STATUSES 3
#define STILL_US (500 * MS)
/* How far reported targets may be from sent ones: rounding on the robot's side. */
#define TARGET_TOLERANCE 0.02F
/* A robot with less than this share of a target's speed does not follow it. */
#define FOLLOWING_SHARE 0.05F
/* Far above any robot's speed; keeps products finite. */
#define ANY_SPEED 1000.0F

/* A width beyond these is not sensible. */
#define WIDTH_MIN_M 0.01F
#define WIDTH_MAX_M 10.0F

/* What is done alike for m/s and rad/s is done axis by axis. */
enum { LINEAR, ANGULAR, AXES };
/* A robot slower than this stands; a target greater than that is one to follow. */
static const float standing[AXES] = {0.1F, 0.2F};
static const float noticeable[AXES] = {0.02F, 0.05F};

/* Places in the differential properties and status, whose fields stand axis by axis too. */
#define LIMIT_MAX(axis) (4 + 2 * (axis))
#define LIMIT_MIN(axis) (5 + 2 * (axis))
#define LIMIT_WIDTH 12
#define REPORTED_TARGET(axis) (2 * (axis))
#define REPORTED_CURRENT(axis) (2 * (axis) + 1)

static bool is_zero(float value) {
    return bits_from_f32(value) << 1 == 0; /* of either sign */
}

static float magnitude(float value) {
    return f32_from_bits(bits_from_f32(value) & 0x7FFFFFFFU);
}

/* Adding it subtracts: where floats are software, that is a function less. */
static float opposite(float value) {
    return f32_from_bits(bits_from_f32(value) ^ 0x80000000U);
}

void roburoc4_drive_start(drive *d, uint64_t now_us) {
    memset(d, 0, sizeof *d);
    d->disarm_cause = ROBUROC4_ERR_DISARMED;
    roburoc4_drive_rebase(d, now_us);
}

/* ---- leaving ---- */

static void begin_train(drive *d) {
    d->train = 1;
    d->zeros = 0;
    d->confirmed = 0;
    d->spoke = 0;
}

static void leave(drive *d) {
    d->leased = 0;
    if (d->spoke) {
        begin_train(d);
    }
}

void roburoc4_drive_interrupt(drive *d, roburoc4_result cause, uint32_t *events) {
    leave(d);
    if (d->armed) {
        d->disarm_cause = cause;
        *events |= ROBUROC4_EVENT_DISARMED;
        d->armed = 0;
    }
}

void roburoc4_drive_stop(drive *d) {
    d->leased = 0;
    if (d->known) {
        begin_train(d);
    } else {
        d->stop_latched = 1;
    }
}

void roburoc4_drive_service(drive *d, bool known, uint16_t id) {
    if (!known && id == d->service) {
        leave(d); /* it is still there: the last that it hears must be zero */
    } else if (!known) {
        /* zeros that are still owed go to whom is found next */
        d->stop_latched = d->stop_latched || d->spoke || (d->train && d->zeros < TRAIN_ZEROS);
        d->leased = 0;
        d->spoke = 0;
        d->train = 0;
    }
    d->known = known;
    d->service = id;
    if (known && d->stop_latched) {
        d->stop_latched = 0;
        begin_train(d);
    }
}

/* ---- arming and granting ---- */

bool roburoc4_drive_limits_valid(const float *limits) {
    for (uint32_t axis = 0; axis < AXES; axis++) {
        if (!roburoc4_all_finite(limits + LIMIT_MAX(axis), 2) ||
            !roburoc4_between(0, limits[LIMIT_MIN(axis)], limits[LIMIT_MAX(axis)])) {
            return false;
        }
    }
    return true;
}

void roburoc4_drive_arm(drive *d, uint32_t *events) {
    *events |= d->armed ? 0 : ROBUROC4_EVENT_ARMED;
    d->armed = 1;
    d->disarm_cause = ROBUROC4_OK;
}

roburoc4_result roburoc4_drive_grant(drive *d, const float *target, uint32_t lease_us,
                                     uint64_t now_us) {
    if (!d->armed) {
        return d->disarm_cause;
    }
    const float bounded[AXES] = {roburoc4_clamp(target[LINEAR], -ANY_SPEED, ANY_SPEED),
                                 roburoc4_clamp(target[ANGULAR], -ANY_SPEED, ANY_SPEED)};
    if (!d->leased || bits_from_f32(d->target[LINEAR]) != bits_from_f32(bounded[LINEAR]) ||
        bits_from_f32(d->target[ANGULAR]) != bits_from_f32(bounded[ANGULAR])) {
        d->changed = 1; /* until it has left, however often it is renewed before */
    }
    memcpy(d->target, bounded, sizeof bounded);
    d->leased = 1;
    d->granted_us = now_us;
    d->lease_us = lease_us;
    return ROBUROC4_OK;
}

static bool lease_over(const drive *d, uint64_t now_us) {
    return d->leased && now_us - d->granted_us >= d->lease_us;
}

void roburoc4_drive_tick(drive *d, roburoc4_result refusal, uint64_t now_us, uint32_t *events) {
    if (lease_over(d, now_us)) {
        leave(d);
        *events |= ROBUROC4_EVENT_LEASE_OVER;
    }
    if (refusal < 0 && d->armed) {
        roburoc4_drive_interrupt(d, refusal, events);
    }
}

/* ---- sending ---- */

/** Scale, then keep the curve, then clamp. */
static void shape(const drive *d, const roburoc4_config *config, const float *limits,
                  float *speeds) {
    const float ceiling[AXES] = {config->max_linear_m_s, config->max_angular_rad_s};
    const float scale[AXES] = {config->scale_linear, config->scale_angular};
    const float width = limits[LIMIT_WIDTH];
    float low[AXES];
    float high[AXES];
    for (uint32_t axis = 0; axis < AXES; axis++) {
        low[axis] = roburoc4_clamp(limits[LIMIT_MIN(axis)], -ceiling[axis], 0);
        high[axis] = roburoc4_clamp(limits[LIMIT_MAX(axis)], 0, ceiling[axis]);
        speeds[axis] = d->target[axis] * scale[axis];
    }
    if ((config->options & ROBUROC4_OPTION_TURN_KEEPING) != 0 && roburoc4_all_finite(&width, 1) &&
        roburoc4_between(width, WIDTH_MIN_M, WIDTH_MAX_M)) {
        const float outer = magnitude(speeds[ANGULAR]) * width / 2;
        low[LINEAR] = roburoc4_clamp(low[LINEAR] + outer, low[LINEAR], 0);
        high[LINEAR] = roburoc4_clamp(high[LINEAR] + opposite(outer), 0, high[LINEAR]);
    }
    for (uint32_t axis = 0; axis < AXES; axis++) {
        speeds[axis] = roburoc4_clamp(speeds[axis], low[axis], high[axis]);
    }
}

/** Remember what was sent lately: what the robot may report as its targets. */
static void widen_envelope(drive *d) {
    for (uint32_t axis = 0; axis < AXES; axis++) {
        d->low[axis] = roburoc4_clamp(d->sent[axis], -ANY_SPEED, d->low[axis]);
        d->high[axis] = roburoc4_clamp(d->sent[axis], d->high[axis], ANY_SPEED);
    }
}

static void age_envelope(drive *d, uint32_t window_us, uint64_t now_us) {
    if (now_us - d->envelope_us >= window_us) {
        memcpy(d->low_before, d->low, sizeof d->low);
        memcpy(d->high_before, d->high, sizeof d->high);
        memcpy(d->low, d->sent, sizeof d->low);
        memcpy(d->high, d->sent, sizeof d->high);
        d->envelope_us = now_us;
    }
}

static bool train_ended(const drive *d, const roburoc4_config *config, uint64_t now_us) {
    return d->zeros >= TRAIN_ZEROS &&
           (d->confirmed || now_us - d->train_us >= config->robot_watchdog_ms * MS);
}

/** Until the next command. The first zero of a train interrupts a speed at once; half of a short
 *  lease, so that it is repeated at all. */
static uint32_t pause_us(const drive *d, const roburoc4_config *config) {
    const uint32_t period_us = config->drive_period_ms * MS;
    if (d->train && d->zeros == 0) {
        return is_zero(d->sent[LINEAR]) && is_zero(d->sent[ANGULAR]) ? SPACING_US : 0;
    }
    if (d->train) {
        return period_us;
    }
    if (d->changed) {
        return SPACING_US;
    }
    return d->lease_us / 2 < period_us ? d->lease_us / 2 : period_us;
}

static bool poll_train(drive *d, const roburoc4_config *config, uint64_t now_us) {
    if (now_us - d->sent_us < pause_us(d, config)) {
        return false;
    }
    if (d->zeros == 0) {
        d->train_us = now_us;
    }
    if (d->zeros < TRAIN_ZEROS) {
        d->zeros++;
    }
    return true;
}

bool roburoc4_drive_poll(drive *d, const roburoc4_config *config, const float *limits,
                         uint64_t now_us, float *speeds, uint32_t *events) {
    memset(speeds, 0, sizeof d->sent);
    if (d->train && train_ended(d, config, now_us)) {
        d->train = 0;
        *events |= ROBUROC4_EVENT_STOPPED;
    }
    if (d->train) {
        if (!poll_train(d, config, now_us)) {
            return false;
        }
    } else {
        if (!d->known || !d->armed || !d->leased || lease_over(d, now_us) ||
            now_us - d->sent_us < pause_us(d, config)) {
            return false;
        }
        shape(d, config, limits, speeds);
        d->changed = 0;
        d->spoke = d->spoke || !is_zero(speeds[LINEAR]) || !is_zero(speeds[ANGULAR]);
    }
    d->sent_us = now_us;
    memcpy(d->sent, speeds, sizeof d->sent);
    age_envelope(d, config->robot_watchdog_ms * MS, now_us);
    widen_envelope(d);
    return true;
}

uint64_t roburoc4_drive_deadline(const drive *d, const roburoc4_config *config) {
    const uint64_t next = d->sent_us + pause_us(d, config);
    if (d->train) {
        return d->confirmed ? 0 : next;
    }
    if (!d->leased) {
        return UINT64_MAX;
    }
    const uint64_t over = d->granted_us + d->lease_us;
    return over < next ? over : next;
}

/* ---- what the robot reports ---- */

/** Whether the reported targets are ours or zero: between the least and the most that was sent
 *  lately. */
static bool within(const drive *d, const float *speeds) {
    for (uint32_t axis = 0; axis < AXES; axis++) {
        const float target = speeds[REPORTED_TARGET(axis)];
        if (!is_zero(target)) {
            const float low = roburoc4_clamp(d->low[axis], -ANY_SPEED, d->low_before[axis]);
            const float high = roburoc4_clamp(d->high[axis], d->high_before[axis], ANY_SPEED);
            if (!roburoc4_all_finite(&target, 1) || target + TARGET_TOLERANCE < low ||
                target > high + TARGET_TOLERANCE) {
                return false;
            }
        }
    }
    return true;
}

static void watch_other_commander(drive *d, const roburoc4_config *config, bool ours, uint32_t *events) {
    if (ours) {
        d->other_count = 0;
    } else if (d->other_count < OTHER_STATUSES) {
        d->other_count++;
    }
    const bool other_commander = ours ? false : d->other_commander || d->other_count >= OTHER_STATUSES;
    if (other_commander != (d->other_commander != 0)) {
        d->other_commander = other_commander;
        *events |= ROBUROC4_EVENT_OTHER_COMMANDER;
        if (other_commander && (config->options & ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER) == 0) {
            roburoc4_drive_interrupt(d, ROBUROC4_ERR_OTHER_COMMANDER, events);
        }
    }
}

/** A speed is asked for, by us or on the robot, and no axis follows. */
static bool stands_still(const drive *d, const float *speeds) {
    bool asked = false;
    for (uint32_t axis = 0; axis < AXES; axis++) {
        const float sent = d->leased ? magnitude(d->sent[axis]) : 0;
        const float target =
            roburoc4_clamp(magnitude(speeds[REPORTED_TARGET(axis)]), sent, ANY_SPEED);
        if (target >= noticeable[axis]) {
            asked = true;
            if (magnitude(speeds[REPORTED_CURRENT(axis)]) > target * FOLLOWING_SHARE) {
                return false;
            }
        }
    }
    return asked;
}

static void watch_inhibited(drive *d, const float *speeds, bool overridden, uint64_t now_us,
                            uint32_t *events) {
    const bool still = !overridden && stands_still(d, speeds);
    if (still && !d->still) {
        d->still_us = now_us;
    }
    d->still = still;
    const bool inhibited = still && now_us - d->still_us >= STILL_US;
    if (inhibited != (d->inhibited != 0)) {
        d->inhibited = inhibited;
        *events |= ROBUROC4_EVENT_INHIBITED;
    }
}

void roburoc4_drive_status(drive *d, const roburoc4_config *config, const float *speeds,
                           bool overridden, uint64_t now_us, uint32_t *events) {
    bool zero = true;
    age_envelope(d, config->robot_watchdog_ms * MS, now_us);
    const bool ours = within(d, speeds);
    d->moving = 0;
    if (!roburoc4_all_finite(speeds, 2 * AXES)) {
        d->moving = 1;
        watch_other_commander(d, config, overridden || ours, events);
        return;
    }
    for (uint32_t axis = 0; axis < AXES; axis++) {
        zero = zero && is_zero(speeds[REPORTED_TARGET(axis)]);
        if (!roburoc4_between(speeds[REPORTED_CURRENT(axis)], -standing[axis], standing[axis])) {
            d->moving = 1;
        }
    }
    d->moving = d->moving || !zero;
    d->confirmed = d->confirmed || (zero && d->zeros >= TRAIN_ZEROS);
    watch_other_commander(d, config, overridden || ours, events);
    watch_inhibited(d, speeds, overridden, now_us, events);
}

/** After a fault of the clock: a train goes on with a time of its own, everything else is due. */
void roburoc4_drive_rebase(drive *d, uint64_t now_us) {
    d->sent_us = now_us - SECOND;
    d->train_us = now_us;
    d->still_us = now_us;
    d->envelope_us = now_us;
}
