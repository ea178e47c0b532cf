/* SPDX-License-Identifier: MIT
 *
 * Motion: arming, the lease of a drive command, limits, the stop sequence. This is the only file
 * that decides which speeds are sent, and it does so in one function, roburoc4_drive_poll().
 */
#include "bytes.h"
#include "machines.h"

/* A changed target is sent at once, but not more often than the robot's cycle. */
#define SPACING_US ROBUROC4_CYCLE_US
#define STOP_ZEROS 3
#define OTHER_STATUSES 3
/* Without a lease, a status of at most this age that shows a speed of ours is answered with zeros,
 * although it may be too old to drive by. */
#define WATCHED_US (2 * SECOND)
/* The longest time, beside a drive period, without a proof that something of ours arrived. */
#define UPLINK_US (400 * MS)
/* This long after a command, a robot that seems to be at rest may still be changing its direction.
 */
#define SETTLED_US (4 * SECOND)
/* Fixed-point numbers: of speeds, and of wheels' speeds, which are exact to that of a float. */
#define SPEED_BITS 20
#define WHEEL_BITS 24
#define FIXED(value) ((int32_t)((value) * (INT32_C(1) << SPEED_BITS)))
/* How far reported targets may be from sent ones, due to rounding by the robot. A target that
 * differs by more from what was reported must appear in statuses. */
#define TARGET_TOLERANCE FIXED(0.02F)
/* What may still be on its way to the robot: nothing, commands of this lease, also those of earlier
 * ones; ALL: nothing seems to arrive any more. In this order. */
enum { IN_FLIGHT_NONE, IN_FLIGHT_THIS_LEASE, IN_FLIGHT_EARLIER, IN_FLIGHT_ALL };
/* Statuses show a target this long after the robot has taken it, at most. */
#define SHOWN_AFTER_US (160 * MS)
/* SHOWN: a status has targets of 0. CONFIRMED: one of the inputs as new shows [A] released. */
enum { UNCONFIRMED, SHOWN, CONFIRMED };
/* Far above any robot's speed, and low enough that products stay finite. */
#define ANY_SPEED 1000.0F
/* Widths outside of these are ignored. */
#define WIDTH_MIN_M 0.01F
#define WIDTH_MAX_M 10.0F

/* A robot slower than this is at rest. */
static const float rest_below[AXES] = {0.1F, 0.2F};

/* ---- floats compared by their bits: for speed and size where floats are software, and for NaN,
 * which compilers may be told not to expect ---- */

static float clamp(float value, float low, float high) {
    return order_of(value) < order_of(low) ? low : order_of(value) > order_of(high) ? high : value;
}

/** Whether a value lies between two others, or as little outside of them as the tolerance. */
static bool near(float value, float low, float high, int32_t tolerance) {
    const int32_t fixed = fixed_from_f32(value, SPEED_BITS);
    return fixed + tolerance >= fixed_from_f32(low, SPEED_BITS) &&
           fixed - tolerance <= fixed_from_f32(high, SPEED_BITS);
}

/* ---- ending a lease ---- */

static void fly_at_least(drive *d, uint8_t in_flight) {
    d->in_flight = d->in_flight > in_flight ? d->in_flight : in_flight;
}

/** The one place where a stop sequence begins. */
static void begin_stop_sequence(drive *d) {
    if (d->known && d->stop_pending) {
        d->stop_pending = 0;
        d->stopping = 1;
        d->outcome = ROBUROC4_STOP_TIMED_OUT; /* unless it is confirmed */
        d->zeros_sent = 0;
        d->confirmed = UNCONFIRMED;
        d->nonzero_sent = 0;
        fly_at_least(d, IN_FLIGHT_EARLIER);
    }
}

static void stop_again(drive *d) {
    d->stop_pending = 1;
    begin_stop_sequence(d);
}

static void end_lease(drive *d) {
    d->lease_active = 0;
    if (d->in_flight != IN_FLIGHT_NONE) {
        fly_at_least(d, IN_FLIGHT_EARLIER);
    }
    d->stop_pending = d->stop_pending || d->nonzero_sent;
    d->outcome = d->stop_pending ? ROBUROC4_STOP_TIMED_OUT : d->outcome;
    begin_stop_sequence(d);
}

void roburoc4_drive_interrupt(drive *d, roburoc4_result cause, uint32_t *events) {
    end_lease(d);
    if (cause == ROBUROC4_ERR_UPLINK) {
        if (d->in_flight == IN_FLIGHT_NONE && !d->stopping) {
            /* only zeros are missing: no new sequence, but wait for a newer answer */
            d->stop_us = d->reached_us;
            d->zeros_sent = STOP_ZEROS;
        }
        d->in_flight = IN_FLIGHT_ALL;
    }
    if (d->armed) {
        d->disarm_cause = cause;
        *events |= ROBUROC4_EVENT_DISARMED;
        d->armed = 0;
    }
}

void roburoc4_drive_pause(drive *d) {
    d->stop_pending = 1;
    d->unconfirmed = 1;
    d->lapsed = 0;
    end_lease(d);
}

void roburoc4_drive_stop(drive *d, uint32_t *events) {
    roburoc4_drive_pause(d);
    roburoc4_drive_interrupt(d, ROBUROC4_ERR_STOP_CALLED, events);
    d->disarm_cause = ROBUROC4_ERR_STOP_CALLED; /* also if it was disarmed before */
}

void roburoc4_drive_override(drive *d, bool overridden, bool known, uint32_t cycles) {
    const bool released = d->overridden && !overridden;
    d->overridden = overridden;
    if (overridden) {
        d->confirmed = UNCONFIRMED; /* the robot ignores commands now */
    } else if (known && d->confirmed == SHOWN && (int32_t)(cycles - d->shown_cycles) >= 0) {
        d->confirmed = CONFIRMED; /* [A] was not held when the status was made that shows it */
    }
    if (released && d->unconfirmed && !d->lease_active) { /* else it obeys that of the lease */
        stop_again(d); /* the robot may have ignored the zeros, and obey the speed from before */
    }
}

void roburoc4_drive_service(drive *d, bool known, uint16_t id) {
    if (!known) {
        end_lease(d); /* if it is still there, its last command must be zero */
    }
    if (!known && id != d->service) {
        /* zeros go to the service that is found next */
        d->stop_pending = d->stop_pending || d->stopping;
        d->stopping = 0;
    }
    d->known = known;
    d->service = id;
    begin_stop_sequence(d);
}

/* ---- arming and granting ---- */

bool roburoc4_drive_limits_valid(const roburoc4_differential_properties *limits) {
    return is_finite(limits->min_linear_m_s) && is_finite(limits->max_linear_m_s) &&
           is_finite(limits->min_angular_rad_s) && is_finite(limits->max_angular_rad_s) &&
           between(0, limits->min_linear_m_s, limits->max_linear_m_s) &&
           between(0, limits->min_angular_rad_s, limits->max_angular_rad_s);
}

void roburoc4_drive_arm(drive *d, uint32_t *events) {
    if (!d->armed) {
        *events |= ROBUROC4_EVENT_ARMED | (d->inhibited ? ROBUROC4_EVENT_INHIBITED : 0);
        d->inhibited = 0; /* else a robot that still does not follow would go unnoticed */
        roburoc4_follow_begin(&d->follow);
    }
    d->armed = 1;
    d->lapsed = 0;
    d->disarm_cause = ROBUROC4_OK;
}

/** From now on, the robot must be heard to receive. Pauses do not count, but what was driven before
 * them does, unless it was heard since. */
static void watch_on(drive *d, uint32_t driven_us, uint32_t now_us) {
    const uint32_t unheard_us = driven_us - d->reached_us;
    d->reached_us = now_us - ((int32_t)unheard_us > 0 ? unheard_us : 0);
}

roburoc4_result roburoc4_drive_grant(drive *d, const float *target, uint32_t lease_us,
                                     uint32_t driven_us, uint32_t now_us) {
    if (!d->armed) {
        return d->disarm_cause;
    }
    const float bounded[AXES] = {clamp(target[LINEAR], -ANY_SPEED, ANY_SPEED),
                                 clamp(target[ANGULAR], -ANY_SPEED, ANY_SPEED)};
    /* NOLINTNEXTLINE: -0 counts as another target than 0, which does no harm */
    if (!d->lease_active || memcmp(d->target, bounded, sizeof bounded) != 0) {
        d->changed = 1; /* until it was sent, however often it is renewed before */
    }
    if (!d->lease_active) {
        watch_on(d, driven_us, now_us);
        d->echo_due = 0;
        d->echoed[LINEAR] = 0;
        d->echoed[ANGULAR] = 0;
    }
    memcpy(d->target, bounded, sizeof bounded);
    d->lease_active = 1;
    d->lapsed = 0;
    d->granted_us = now_us;
    d->lease_us = lease_us;
    return ROBUROC4_OK;
}

static bool lease_over(const drive *d, timer *t) {
    return d->lease_active && due(t, d->granted_us, d->lease_us);
}

bool roburoc4_drive_is_cut_off(const drive *d) {
    return d->in_flight == IN_FLIGHT_ALL;
}

bool roburoc4_drive_asks(const drive *d, timer *t) {
    return d->stopping && d->in_flight != IN_FLIGHT_NONE && d->zeros_sent != 0 &&
           due(t, d->stop_us, SPACING_US);
}

void roburoc4_drive_heard(drive *d, uint32_t sent_us) {
    if ((int32_t)(sent_us - d->reached_us) > 0) {
        d->reached_us = sent_us;
    }
}

void roburoc4_drive_arrived(drive *d, uint32_t sent_us, uint32_t now_us) {
    if (d->in_flight != IN_FLIGHT_NONE && !d->nonzero_sent && !d->stop_pending &&
        d->zeros_sent != 0 && (int32_t)(sent_us - d->stop_us) > 0) {
        d->in_flight = IN_FLIGHT_NONE; /* what was sent before this request has arrived, or never
                                          will */
        d->expected_us = now_us;
    }
}

static uint32_t uplink_limit_us(const roburoc4_config *config) {
    return UPLINK_US + config->drive_period_ms * MS;
}

void roburoc4_drive_tick(drive *d, const roburoc4_config *config, roburoc4_result refusal, timer *t,
                         uint32_t *events) {
    if (lease_over(d, t)) {
        end_lease(d);
        d->lapsed = 1;
        *events |= ROBUROC4_EVENT_LAPSED;
    }
    if (d->lapsed && d->armed &&
        due(t, d->granted_us, d->lease_us + config->lapse_disarm_ms * MS)) {
        refusal = ROBUROC4_ERR_LAPSED;
    } else if (refusal >= 0 && d->lease_active && due(t, d->reached_us, uplink_limit_us(config))) {
        refusal = ROBUROC4_ERR_UPLINK;
    }
    if (refusal < 0 && d->armed) {
        roburoc4_drive_interrupt(d, refusal, events);
    }
}

/* ---- sending ---- */

/** Whether this share of the speeds is beyond the limits; the linear one is compared at the outer
 * wheels. */
static bool exceeds(const float *speeds, float share, const float *most, float half_width_m) {
    const float linear = magnitude(product(speeds[LINEAR], share));
    const float angular = magnitude(product(speeds[ANGULAR], share));
    const uint32_t outer = (uint32_t)fixed_from_f32(linear, WHEEL_BITS) +
                           (uint32_t)fixed_from_f32(product(angular, half_width_m), WHEEL_BITS);
    return (!is_zero(most[LINEAR]) && outer > (uint32_t)fixed_from_f32(most[LINEAR], WHEEL_BITS)) ||
           (!is_zero(most[ANGULAR]) && order_of(angular) > order_of(most[ANGULAR]));
}

/** The factor, at most 1, that brings both speeds within the limits and preserves the curvature. A
 * limit of 0 is ignored: in that direction the robot cannot drive at all, so there is no curvature
 * to preserve. */
static float curve_share(const float *speeds, const float *low, const float *high, float width_m) {
    float most[AXES];
    uint32_t share = bits_from_f32(1);
    for (uint32_t axis = 0; axis < AXES; axis++) {
        most[axis] = magnitude(order_of(speeds[axis]) < 0 ? low[axis] : high[axis]);
    }
    if (exceeds(speeds, 1, most, product(width_m, 0.5F))) {
        /* bit by bit, as such floats are ordered like their bits, and a division is a large
         * function */
        share = 0;
        for (uint32_t bit = UINT32_C(1) << 29; bit != 0; bit >>= 1) {
            const bool less =
                exceeds(speeds, f32_from_bits(share | bit), most, product(width_m, 0.5F));
            share |= less ? 0 : bit;
        }
    }
    return f32_from_bits(share);
}

/** Scale, then reduce both speeds together, then clamp. A ceiling bounds the speed before and after
 * it is scaled. */
static void shape(const drive *d, const roburoc4_config *config,
                  const roburoc4_differential_properties *limits, float *speeds) {
    const float ceiling[AXES] = {
        product(config->max_linear_m_s, clamp(config->scale_linear, 0, 1)),
        product(config->max_angular_rad_s, clamp(config->scale_angular, 0, 1))};
    const float low[AXES] = {clamp(limits->min_linear_m_s, -ceiling[LINEAR], 0),
                             clamp(limits->min_angular_rad_s, -ceiling[ANGULAR], 0)};
    const float high[AXES] = {clamp(limits->max_linear_m_s, 0, ceiling[LINEAR]),
                              clamp(limits->max_angular_rad_s, 0, ceiling[ANGULAR])};
    float share = 1;
    speeds[LINEAR] = product(d->target[LINEAR], config->scale_linear);
    speeds[ANGULAR] = product(d->target[ANGULAR], config->scale_angular);
    if ((config->options & ROBUROC4_OPTION_KEEP_CURVATURE) != 0 && is_finite(limits->width_m) &&
        between(limits->width_m, WIDTH_MIN_M, WIDTH_MAX_M)) {
        share = curve_share(speeds, low, high, limits->width_m);
    }
    for (uint32_t axis = 0; axis < AXES; axis++) {
        speeds[axis] = clamp(product(speeds[axis], share), low[axis], high[axis]);
    }
}

/** Remember what was sent recently, which the robot may report as its targets. */
static void widen_envelope(drive *d) {
    for (uint32_t axis = 0; axis < AXES; axis++) {
        d->low[axis] = clamp(d->sent[axis], -ANY_SPEED, d->low[axis]);
        d->high[axis] = clamp(d->sent[axis], d->high[axis], ANY_SPEED);
    }
}

/** The envelope narrows once no older speed can be shown: under a lease, when the new target was;
 * without one, when the stop is confirmed and nothing is on its way. A target of 0 also confirms
 * the stop of a robot that no speed has reached yet. */
static void age_envelope(drive *d, uint32_t window_us, uint32_t now_us) {
    if (now_us - d->envelope_us < window_us) {
        return;
    }
    const bool settled = d->lease_active && d->nonzero_sent && !d->stopping
                             ? !d->echo_due && d->in_flight != IN_FLIGHT_EARLIER
                             : !d->unconfirmed && d->in_flight == IN_FLIGHT_NONE;
    if (settled) {
        memcpy(d->low_before, d->low, sizeof d->low);
        memcpy(d->high_before, d->high, sizeof d->high);
        memcpy(d->low, d->sent, sizeof d->low);
        memcpy(d->high, d->sent, sizeof d->high);
        d->envelope_us = now_us;
    }
}

/** A new target must be seen in statuses; any that was sent since counts, as statuses miss some. */
static void expect_echo(drive *d, const float *speeds, uint32_t now_us) {
    for (uint32_t axis = 0; axis < AXES && !d->echo_due; axis++) {
        if (!near(speeds[axis], d->echoed[axis], d->echoed[axis], TARGET_TOLERANCE)) {
            d->echo_due = 1;
            d->expected_us = now_us;
            memcpy(d->echo_low, speeds, sizeof d->echo_low);
            memcpy(d->echo_high, speeds, sizeof d->echo_high);
        }
    }
    for (uint32_t axis = 0; axis < AXES; axis++) {
        d->echo_low[axis] = clamp(speeds[axis], -ANY_SPEED, d->echo_low[axis]);
        d->echo_high[axis] = clamp(speeds[axis], d->echo_high[axis], ANY_SPEED);
    }
}

static bool stop_sequence_over(const drive *d, const roburoc4_config *config, timer *t) {
    return d->zeros_sent >= STOP_ZEROS &&
           (d->confirmed == CONFIRMED || due(t, d->stop_us, config->robot_watchdog_ms * MS));
}

/** The time until the next command. The first zero of a stop sequence is sent at once; a short
 * lease is repeated after half of it. */
static uint32_t pause_us(const drive *d, const roburoc4_config *config) {
    const uint32_t period_us = config->drive_period_ms * MS;
    if (d->stopping && d->zeros_sent == 0) {
        return is_zero(d->sent[LINEAR]) && is_zero(d->sent[ANGULAR]) ? SPACING_US : 0;
    }
    if (d->stopping) {
        return period_us;
    }
    if (d->changed) {
        return SPACING_US;
    }
    return d->lease_us / 2 < period_us ? d->lease_us / 2 : period_us;
}

static void end_stop_sequence(drive *d, uint32_t *events) {
    d->stopping = 0;
    const bool confirmed = d->confirmed == CONFIRMED;
    if (confirmed) {
        d->outcome = ROBUROC4_STOP_CONFIRMED;
        d->unconfirmed = 0;
    } else if (d->overridden) {
        d->outcome = ROBUROC4_STOP_OVERRIDDEN;
    }
    *events |= confirmed ? ROBUROC4_EVENT_STOP_CONFIRMED : ROBUROC4_EVENT_STOP_UNCONFIRMED;
}

/** Whether the next zero must be sent now. */
static bool zero_due(drive *d, const roburoc4_config *config, timer *t) {
    if (!due(t, d->sent_us, pause_us(d, config))) {
        return false;
    }
    if (d->zeros_sent == 0) {
        d->stop_us = d->expected_us = t->now_us;
    }
    if (d->zeros_sent < STOP_ZEROS) {
        d->zeros_sent++;
    }
    return true;
}

/** Whether a speed must be sent now: only under a lease of an armed client. */
static bool speed_due(const drive *d, const roburoc4_config *config, timer *t) {
    return d->known && d->armed && d->lease_active && !lease_over(d, t) &&
           due(t, d->sent_us, pause_us(d, config));
}

static void note_sent(drive *d, const float *speeds, uint32_t now_us) {
    d->changed = 0;
    if (!is_zero(speeds[LINEAR]) || !is_zero(speeds[ANGULAR])) {
        d->nonzero_sent = 1;
        d->unconfirmed = 1;
        fly_at_least(d, IN_FLIGHT_THIS_LEASE);
        roburoc4_follow_sent(&d->follow, speeds);
    }
    expect_echo(d, speeds, now_us);
}

bool roburoc4_drive_poll(drive *d, const roburoc4_config *config,
                         const roburoc4_differential_properties *limits, timer *t, float *speeds,
                         uint32_t *events) {
    memset(speeds, 0, sizeof d->sent);
    if (d->stopping && stop_sequence_over(d, config, t)) {
        end_stop_sequence(d, events);
    }
    if (d->stopping ? !zero_due(d, config, t) : !speed_due(d, config, t)) {
        return false;
    }
    if (!d->stopping) {
        shape(d, config, limits, speeds);
        note_sent(d, speeds, t->now_us);
    }
    d->sent_us = t->now_us;
    memcpy(d->sent, speeds, sizeof d->sent);
    age_envelope(d, config->robot_watchdog_ms * MS, t->now_us);
    widen_envelope(d);
    return true;
}

/* ---- what the robot reports ---- */

/** Whether a reported target is ours or zero: between the lowest and the highest sent recently, or
 * the last that the robot took. */
static bool is_ours(const drive *d, uint32_t axis, float target) {
    if (nearly_zero(target)) {
        return true;
    }
    return is_finite(target) &&
           (near(target, clamp(d->low[axis], -ANY_SPEED, d->low_before[axis]),
                 clamp(d->high[axis], d->high_before[axis], ANY_SPEED), TARGET_TOLERANCE) ||
            (!d->lease_active && d->unconfirmed &&
             near(target, d->echoed[axis], d->echoed[axis], TARGET_TOLERANCE)));
}

static void watch_other_commander(drive *d, const roburoc4_config *config, bool ours,
                                  uint32_t *events) {
    if (ours) {
        d->other_count = 0;
    } else if (d->other_count < OTHER_STATUSES) {
        d->other_count++;
    }
    const bool other = !ours && (d->other_commander || d->other_count >= OTHER_STATUSES);
    if (other != (d->other_commander != 0)) {
        d->other_commander = other;
        *events |= ROBUROC4_EVENT_OTHER_COMMANDER;
        if (other && (config->options & ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER) == 0) {
            roburoc4_drive_interrupt(d, ROBUROC4_ERR_OTHER_COMMANDER, events);
        }
    }
}

bool roburoc4_drive_moving(const roburoc4_differential_status *s) {
    return !nearly_zero(s->target_linear_m_s) || !nearly_zero(s->target_angular_rad_s) ||
           !within_f32(s->current_linear_m_s, rest_below[LINEAR]) ||
           !within_f32(s->current_angular_rad_s, rest_below[ANGULAR]);
}

/** Whether one of our speeds may still reach the robot, or be obeyed by it. */
static bool has_driven(const drive *d) {
    bool driven = d->unconfirmed != 0;
    for (uint32_t axis = 0; axis < AXES; axis++) {
        driven = driven || !is_zero(d->low[axis]) || !is_zero(d->high[axis]) ||
                 !is_zero(d->low_before[axis]) || !is_zero(d->high_before[axis]);
    }
    return driven;
}

static bool both_near(const float *values, const float *low, const float *high) {
    return near(values[LINEAR], low[LINEAR], high[LINEAR], TARGET_TOLERANCE) &&
           near(values[ANGULAR], low[ANGULAR], high[ANGULAR], TARGET_TOLERANCE);
}

static bool both_zero(const float *values) {
    return nearly_zero(values[LINEAR]) && nearly_zero(values[ANGULAR]);
}

/** Whether a reported target shows that one of those that were sent since has arrived. To see the
 * old one again proves nothing, unless it was sent again; nor does a zero between others, as it may
 * be that of the robot's watchdog. */
static bool shows_new_target(const drive *d, const float *reported) {
    bool beside_zero = false;
    for (uint32_t axis = 0; axis < AXES; axis++) {
        beside_zero =
            beside_zero || (!nearly_zero(d->echo_low[axis]) && !nearly_zero(d->echo_high[axis]));
    }
    return both_near(reported, d->sent, d->sent) ||
           (both_near(reported, d->echo_low, d->echo_high) &&
            !both_near(reported, d->echoed, d->echoed) && !(beside_zero && both_zero(reported)));
}

/** While driving, what is sent must appear among the reported targets. */
static void watch_echo(drive *d, const roburoc4_config *config, const float *reported, bool ours,
                       uint32_t now_us, uint32_t *events) {
    if (d->echo_due && shows_new_target(d, reported)) {
        d->echo_due = 0;
        d->in_flight = IN_FLIGHT_THIS_LEASE; /* what was sent before it has arrived, too */
    }
    const uint32_t limit_us = uplink_limit_us(config);
    if (!d->echo_due && ours) {
        memcpy(d->echoed, reported, sizeof d->echoed);
    } else if (d->echo_due && now_us - d->expected_us >= limit_us &&
               (config->options & ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER) == 0) {
        /* if it answers requests in time, it received the target, and dropped it */
        roburoc4_drive_interrupt(
            d, now_us - d->reached_us < limit_us ? ROBUROC4_ERR_INHIBITED : ROBUROC4_ERR_UPLINK,
            events);
    }
}

/** The robot must not start moving because power returns or a bumper is released. */
static void watch_following(drive *d, const roburoc4_differential_status *s, bool expected,
                            uint32_t now_us, uint32_t *events) {
    if (!expected && !d->armed && !d->inhibited && now_us - d->sent_us >= SETTLED_US) {
        follow_pause(&d->follow, s); /* a client that only listens does a third less work */
        return;
    }
    const float reported[AXES] = {s->target_linear_m_s, s->target_angular_rad_s};
    const bool ours = d->lease_active && !d->other_commander;
    const float *targets = ours ? d->sent : reported;
    const bool inhibited = roburoc4_follow_status(&d->follow, expected ? targets : NULL, s);
    if (inhibited != (d->inhibited != 0)) {
        d->inhibited = inhibited;
        *events |= ROBUROC4_EVENT_INHIBITED;
        if (inhibited) {
            roburoc4_drive_interrupt(d, ROBUROC4_ERR_INHIBITED, events);
        }
    }
}

/** Whether a status confirms the stop: it shows targets of 0, and was made SHOWN_AFTER_US after an
 * answer to a request that followed a zero, when it would show any speed from before. */
static void watch_stop(drive *d, bool zero, bool released, const roburoc4_private_link *l,
                       uint32_t now_us) {
    const uint32_t index = STATUS_INDEX(ROBUROC4_SERVICE_DIFFERENTIAL);
    const uint32_t since_us = now_us - d->expected_us;
    if (!zero) {
        d->confirmed = UNCONFIRMED;
    } else if (!d->overridden && d->in_flight == IN_FLIGHT_NONE && d->zeros_sent >= STOP_ZEROS &&
               d->confirmed != CONFIRMED && since_us >= SHOWN_AFTER_US &&
               since_us - SHOWN_AFTER_US >= roburoc4_link_age_at_arrival(l, index)) {
        if (d->confirmed == UNCONFIRMED) {
            d->shown_cycles = (uint32_t)l->services[index].robot_cycles;
        }
        d->confirmed = released ? CONFIRMED : SHOWN;
    }
}

/** Whether the robot has a target to follow, of ours or of another commander. */
static bool has_target(const drive *d, const float *reported, bool zero) {
    return d->lease_active ||
           (!zero && is_finite(reported[LINEAR]) && is_finite(reported[ANGULAR]));
}

/** A speed of ours came late, or came back, although nobody drives. */
static void answer_returned_target(drive *d, const roburoc4_private_link *l) {
    d->unconfirmed = 1;
    fly_at_least(d, IN_FLIGHT_EARLIER);
    if (roburoc4_link_age_at_arrival(l, STATUS_INDEX(ROBUROC4_SERVICE_DIFFERENTIAL)) < WATCHED_US) {
        stop_again(d);
    }
}

void roburoc4_drive_status(drive *d, const roburoc4_config *config,
                           const roburoc4_differential_status *s, pad_state pad,
                           const roburoc4_private_link *l, uint32_t now_us, uint32_t *events) {
    const float reported[AXES] = {s->target_linear_m_s, s->target_angular_rad_s};
    const bool zero = both_zero(reported);
    age_envelope(d, config->robot_watchdog_ms * MS, now_us);
    const bool ours =
        zero || (is_ours(d, LINEAR, reported[LINEAR]) && is_ours(d, ANGULAR, reported[ANGULAR]));
    watch_other_commander(d, config, ours || pad == PAD_HELD, events);
    if (pad != PAD_HELD) {
        if (d->stopping) {
            watch_stop(d, zero, pad == PAD_RELEASED, l, now_us);
        } else if (d->lease_active) {
            watch_echo(d, config, reported, ours, now_us, events);
        } else if (!zero && ours && has_driven(d)) {
            answer_returned_target(d, l);
        }
    }
    const bool expected = pad != PAD_HELD && has_target(d, reported, zero);
    watch_following(d, s, expected, now_us, events);
}
