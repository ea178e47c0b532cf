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
#define FOREIGN_STATUSES 3
#define STILL_US (500 * MS)
/* How far reported targets may be from sent ones: rounding on the robot's side. */
#define TARGET_TOLERANCE 0.02F
/* A robot slower than these stands. */
#define STANDING_LINEAR_M_S 0.1F
#define STANDING_ANGULAR_RAD_S 0.2F
/* Far above any robot's speed; keeps products finite. */
#define INPUT_BOUND 1000.0F

/* Indices of limits, in the order of the differential properties. */
enum { MAX_LINEAR = 4, MIN_LINEAR, MAX_ANGULAR, MIN_ANGULAR, WIDTH = 12 };
/* Indices of speeds, in the order of the differential status. */
enum { TARGET_LINEAR, CURRENT_LINEAR, TARGET_ANGULAR, CURRENT_ANGULAR };
/* Values of resuming. */
enum { NOT_RESUMING, CAUSE_LASTS, CAUSE_CLEARED };

static bool all_finite(const float *values, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        if (!finite_f32_bits(bits_from_f32(values[i]))) {
            return false;
        }
    }
    return true;
}

static float clamp(float value, float low, float high) {
    return value < low ? low : value > high ? high : value;
}

static float magnitude(float value) {
    return value < 0 ? -value : value;
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

static uint32_t resume_bit(roburoc4_result cause) {
    switch (cause) {
    case ROBUROC4_ERR_OVERRIDE:
        return ROBUROC4_RESUME_OVERRIDE;
    case ROBUROC4_ERR_REBOOT:
        return ROBUROC4_RESUME_REBOOT;
    case ROBUROC4_ERR_LOST:
    case ROBUROC4_ERR_NOT_READY:
    case ROBUROC4_ERR_STALE_DIFFERENTIAL:
    case ROBUROC4_ERR_STALE_IOCARD:
        return ROBUROC4_RESUME_LOSS;
    default:
        return 0;
    }
}

void roburoc4_drive_interrupt(drive *d, const roburoc4_config *config, roburoc4_result cause,
                              uint32_t *events) {
    leave(d);
    if (d->armed || d->resuming) {
        d->resuming = (config->resume & resume_bit(cause)) != 0 ? CAUSE_LASTS : NOT_RESUMING;
        d->disarm_cause = cause;
        *events |= d->armed ? ROBUROC4_EVENT_DISARMED : 0;
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
        d->leased = 0;
        d->spoke = 0;
        d->train = 0; /* there is nobody to send it to */
    }
    d->known = known;
    d->service = id;
    if (known && d->stop_latched) {
        d->stop_latched = 0;
        begin_train(d);
    }
}

/* ---- arming and granting ---- */

static bool limits_valid(const float *limits) {
    return all_finite(limits + MAX_LINEAR, 4) && limits[MIN_LINEAR] <= 0 &&
           limits[MAX_LINEAR] >= 0 && limits[MIN_ANGULAR] <= 0 && limits[MAX_ANGULAR] >= 0;
}

roburoc4_result roburoc4_drive_refusal(const drive *d, const roburoc4_config *config,
                                       const float *limits, const conditions *now, bool arming) {
    const bool without_pad =
        !now->override_exists && (config->options & ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE) != 0;
    if (!now->ready) {
        return ROBUROC4_ERR_NOT_READY;
    }
    if (!d->known) {
        return ROBUROC4_ERR_NO_DIFFERENTIAL;
    }
    if (!limits_valid(limits)) {
        return ROBUROC4_ERR_LIMITS;
    }
    if (!now->differential_fresh) {
        return ROBUROC4_ERR_STALE_DIFFERENTIAL;
    }
    if (!now->iocard_fresh && !without_pad) {
        return ROBUROC4_ERR_STALE_IOCARD;
    }
    if (!now->override_known && !without_pad) {
        return ROBUROC4_ERR_OVERRIDE_UNKNOWN;
    }
    if (now->override_known && now->overridden) {
        return ROBUROC4_ERR_OVERRIDE;
    }
    if (d->foreign && (config->options & ROBUROC4_OPTION_IGNORE_FOREIGN) == 0) {
        return ROBUROC4_ERR_FOREIGN;
    }
    if (arming && !d->armed && d->moving) {
        return ROBUROC4_ERR_MOVING;
    }
    return ROBUROC4_OK;
}

void roburoc4_drive_arm(drive *d, uint32_t *events) {
    *events |= d->armed ? 0 : ROBUROC4_EVENT_ARMED;
    d->armed = 1;
    d->resuming = NOT_RESUMING;
    d->disarm_cause = ROBUROC4_OK;
}

roburoc4_result roburoc4_drive_grant(drive *d, const roburoc4_config *config, float linear,
                                     float angular, uint32_t lease_us, uint64_t now_us,
                                     uint32_t *events) {
    if (d->resuming == CAUSE_CLEARED) {
        const bool neutral = linear == 0 && angular == 0;
        if (!neutral && now_us - d->quiet_us < config->lease_ms * MS) {
            d->quiet_us = now_us;
            return ROBUROC4_ERR_NOT_NEUTRAL;
        }
        roburoc4_drive_arm(d, events);
    }
    if (!d->armed) {
        return d->disarm_cause;
    }
    linear = clamp(linear, -INPUT_BOUND, INPUT_BOUND);
    angular = clamp(angular, -INPUT_BOUND, INPUT_BOUND);
    if (!d->leased || d->linear != linear || d->angular != angular) {
        d->changed = 1; /* until it has left, however often it is renewed before */
    }
    d->leased = 1;
    d->granted_us = now_us;
    d->lease_us = lease_us;
    d->linear = linear;
    d->angular = angular;
    return ROBUROC4_OK;
}

static bool lease_over(const drive *d, uint64_t now_us) {
    return d->leased && now_us - d->granted_us >= d->lease_us;
}

void roburoc4_drive_tick(drive *d, const roburoc4_config *config, roburoc4_result refusal,
                         roburoc4_result arm_refusal, uint64_t now_us, uint32_t *events) {
    if (lease_over(d, now_us)) {
        leave(d);
        *events |= ROBUROC4_EVENT_LEASE_OVER;
    }
    if (refusal < 0 && d->armed) {
        roburoc4_drive_interrupt(d, config, refusal, events);
    }
    if (d->resuming == CAUSE_LASTS && arm_refusal >= 0) {
        d->resuming = CAUSE_CLEARED;
        d->quiet_us = now_us;
    } else if (d->resuming == CAUSE_CLEARED && arm_refusal < 0) {
        d->resuming = CAUSE_LASTS;
    }
}

/* ---- sending ---- */

/** Scale, then keep the curve, then clamp. */
static void shape(const drive *d, const roburoc4_config *config, const float *limits, float *linear,
                  float *angular) {
    const float high = clamp(limits[MAX_LINEAR], 0, config->max_linear_m_s);
    const float low = clamp(limits[MIN_LINEAR], -config->max_linear_m_s, 0);
    const float width = limits[WIDTH];
    float v = d->linear * config->scale_linear;
    float w = d->angular * config->scale_angular;
    if ((config->options & ROBUROC4_OPTION_TURN_KEEPING) != 0 && all_finite(&width, 1) &&
        width > 0 && width < 10) {
        const float outer = magnitude(w) * width / 2;
        v = clamp(v, low + outer < 0 ? low + outer : 0, high - outer > 0 ? high - outer : 0);
    }
    v = clamp(v, low, high);
    w = clamp(w, clamp(limits[MIN_ANGULAR], -config->max_angular_rad_s, 0),
              clamp(limits[MAX_ANGULAR], 0, config->max_angular_rad_s));
    *linear = v;
    *angular = w;
}

/** Remember what was sent lately: what the robot may report as its targets. */
static void widen_envelope(drive *d, float linear, float angular) {
    d->envelope[0] = linear < d->envelope[0] ? linear : d->envelope[0];
    d->envelope[1] = linear > d->envelope[1] ? linear : d->envelope[1];
    d->envelope[2] = angular < d->envelope[2] ? angular : d->envelope[2];
    d->envelope[3] = angular > d->envelope[3] ? angular : d->envelope[3];
}

static void age_envelope(drive *d, uint64_t window_us, uint64_t now_us) {
    if (now_us - d->envelope_us >= window_us) {
        memcpy(d->envelope_before, d->envelope, sizeof d->envelope);
        d->envelope[0] = d->envelope[1] = d->sent_linear;
        d->envelope[2] = d->envelope[3] = d->sent_angular;
        d->envelope_us = now_us;
    }
}

static bool train_ended(const drive *d, const roburoc4_config *config, uint64_t now_us) {
    return d->zeros >= TRAIN_ZEROS &&
           (d->confirmed || now_us - d->train_us >= config->robot_watchdog_ms * MS);
}

/** Until the next command. The first zero of a train interrupts a speed at once; half of a short
 *  lease, so that it is repeated at all. */
static uint64_t pause_us(const drive *d, const roburoc4_config *config) {
    const uint64_t period_us = config->drive_period_ms * MS;
    if (d->train && d->zeros == 0) {
        return d->sent_linear == 0 && d->sent_angular == 0 ? SPACING_US : 0;
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
                         uint64_t now_us, float *linear, float *angular, uint32_t *events) {
    *linear = 0;
    *angular = 0;
    if (d->train && train_ended(d, config, now_us)) {
        d->train = 0;
        *events |= ROBUROC4_EVENT_STOPPED;
    }
    if (d->train) {
        if (!poll_train(d, config, now_us)) {
            return false;
        }
    } else {
        if (!d->known || !d->armed || !d->leased || lease_over(d, now_us)) {
            return false;
        }
        shape(d, config, limits, linear, angular);
        if (now_us - d->sent_us < pause_us(d, config)) {
            *linear = 0;
            *angular = 0;
            return false;
        }
        d->changed = 0;
        d->spoke = d->spoke || *linear != 0 || *angular != 0;
    }
    d->sent_us = now_us;
    d->sent_linear = *linear;
    d->sent_angular = *angular;
    age_envelope(d, config->robot_watchdog_ms * MS, now_us);
    widen_envelope(d, *linear, *angular);
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

/** Whether a reported target is ours or zero: between the least and the most that was sent lately.
 */
static bool within(float value, const drive *d, uint32_t i) {
    const float low =
        d->envelope[i] < d->envelope_before[i] ? d->envelope[i] : d->envelope_before[i];
    const float high = d->envelope[i + 1] > d->envelope_before[i + 1] ? d->envelope[i + 1]
                                                                      : d->envelope_before[i + 1];
    return value == 0 || (value >= low - TARGET_TOLERANCE && value <= high + TARGET_TOLERANCE);
}

static void watch_foreign(drive *d, const roburoc4_config *config, bool ours, uint32_t *events) {
    if (ours) {
        d->foreign_count = 0;
    } else if (d->foreign_count < FOREIGN_STATUSES) {
        d->foreign_count++;
    }
    const bool foreign = ours ? false : d->foreign || d->foreign_count >= FOREIGN_STATUSES;
    if (foreign != (d->foreign != 0)) {
        d->foreign = foreign;
        *events |= ROBUROC4_EVENT_FOREIGN;
        if (foreign && (config->options & ROBUROC4_OPTION_IGNORE_FOREIGN) == 0) {
            roburoc4_drive_interrupt(d, config, ROBUROC4_ERR_FOREIGN, events);
        }
    }
}

/** A target is asked for on this axis; *stands is cleared where the robot follows it. */
static bool asked(float reported, float sent, float current, float least, bool *stands) {
    const float target =
        magnitude(reported) > magnitude(sent) ? magnitude(reported) : magnitude(sent);
    if (target < least) {
        return false;
    }
    if (magnitude(current) > target / 20) {
        *stands = false;
    }
    return true;
}

static void watch_inhibited(drive *d, const float *speeds, bool overridden, uint64_t now_us,
                            uint32_t *events) {
    const float linear = d->leased ? d->sent_linear : 0;
    const float angular = d->leased ? d->sent_angular : 0;
    bool stands = true;
    const bool v = asked(speeds[TARGET_LINEAR], linear, speeds[CURRENT_LINEAR], 0.02F, &stands);
    const bool w = asked(speeds[TARGET_ANGULAR], angular, speeds[CURRENT_ANGULAR], 0.05F, &stands);
    const bool still = (v || w) && stands && !overridden;
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
    age_envelope(d, config->robot_watchdog_ms * MS, now_us);
    const bool ours = all_finite(speeds + TARGET_LINEAR, 1) &&
                      all_finite(speeds + TARGET_ANGULAR, 1) &&
                      within(speeds[TARGET_LINEAR], d, 0) && within(speeds[TARGET_ANGULAR], d, 2);
    if (!all_finite(speeds, 4)) {
        d->moving = 1;
        watch_foreign(d, config, overridden || ours, events);
        return;
    }
    const bool zero = speeds[TARGET_LINEAR] == 0 && speeds[TARGET_ANGULAR] == 0;
    d->moving = !zero || magnitude(speeds[CURRENT_LINEAR]) > STANDING_LINEAR_M_S ||
                magnitude(speeds[CURRENT_ANGULAR]) > STANDING_ANGULAR_RAD_S;
    d->confirmed = d->confirmed || (zero && d->zeros >= TRAIN_ZEROS);
    watch_foreign(d, config, overridden || ours, events);
    watch_inhibited(d, speeds, overridden, now_us, events);
}

/** After a fault of the clock: a train goes on with a time of its own, everything else is due. */
void roburoc4_drive_rebase(drive *d, uint64_t now_us) {
    d->sent_us = now_us - SECOND;
    d->train_us = now_us;
    d->quiet_us = now_us;
    d->still_us = now_us;
    d->envelope_us = now_us;
}
