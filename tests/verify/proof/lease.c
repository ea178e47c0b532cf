/* SPDX-License-Identifier: MIT
 *
 * For Frama-C's WP: no speed leaves without a lease. What src/drive.c sends is a zero of a stop
 * sequence, or it is armed and less time has passed since the lease was taken than it lasts, for
 * all states and all times of 32 bits, which wrap. That no age reaches 2^32 us is the duty of
 * see_time(), and not proved. A lease is taken only while armed; an
 * interruption, a stop and the end of the time end it; nothing but arming arms. Never compiled.
 */
#include "bytes.h"
#include "machines.h"

/* WP's memory model has no bytes of floats, so what copying and clearing do is stated here. */
/*@ requires \valid(to + (0 .. 1)) && \valid_read(from + (0 .. 1));
    assigns to[0 .. 1] \from from[0 .. 1]; */
void copy_pair(float *to, const float *from);
/*@ requires \valid(to + (0 .. 1));
    assigns to[0 .. 1]; */
void clear_speeds(float *to);
/*@ assigns *d; */
void clear_d(drive *d);
/*@ assigns \nothing; */
int differ(const float *one, const float *other);
#define memcmp(one, other, size) differ(one, other)
#define memcpy(to, from, size) copy_pair(to, from)
#define memset(to, value, size) clear_##to(to)

#include "drive.c"

/*@ requires \valid(t);
    assigns t->wait_us;
    ensures \result != 0 <==> passed_us >= span_us; */
static bool reached(timer *t, uint32_t passed_us, uint32_t span_us);
/*@ requires \valid(t);
    assigns t->wait_us;
    ensures \result != 0 <==> (uint32_t)(t->now_us - since_us) >= span_us; */
static bool due(timer *t, uint32_t since_us, uint32_t span_us);
/*@ requires \valid(t) && \separated(t, d);
    assigns t->wait_us;
    ensures \result != 0 <==>
        (d->lease_active != 0 && (uint32_t)(t->now_us - d->granted_us) >= d->lease_us); */
static bool lease_over(const drive *d, timer *t);

/*@ requires \valid(t) && \separated(t, d) && \separated(t, config);
    assigns t->wait_us;
    ensures \result != 0 ==> d->armed != 0 && d->lease_active != 0 &&
        (uint32_t)(t->now_us - d->granted_us) < d->lease_us; */
static bool speed_due(const drive *d, const roburoc4_config *config, timer *t);

/* These only compute: that they assign no more than this is assumed, not proved. */
/*@ assigns \nothing; */
static uint32_t uplink_limit_us(const roburoc4_config *config);
/*@ assigns \nothing; */
static bool is_zero(float value);
/*@ assigns \nothing; */
static float clamp(float value, float low, float high);
/*@ assigns t->wait_us; */
static bool stop_sequence_over(const drive *d, const roburoc4_config *config, timer *t);
/*@ assigns d->reached_us; */
static void watch_on(drive *d, uint32_t driven_us, uint32_t now_us);
/*@ assigns d->stopping, d->outcome, d->unconfirmed, *events;
    ensures d->stopping == 0; */
static void end_stop_sequence(drive *d, uint32_t *events);
/*@ assigns \nothing; */
static uint32_t pause_us(const drive *d, const roburoc4_config *config);
/*@ assigns d->zeros_sent, d->stop_us, d->expected_us, t->wait_us; */
static bool zero_due(drive *d, const roburoc4_config *config, timer *t);
/*@ assigns d->changed, d->nonzero_sent, d->unconfirmed, d->in_flight, d->echo_due, d->expected_us,
            d->echo_low[0 .. 1], d->echo_high[0 .. 1], d->follow; */
static void note_sent(drive *d, const float *speeds, uint32_t now_us);
/*@ assigns speeds[0 .. 1]; */
static void shape(const drive *d, const roburoc4_config *config,
                  const roburoc4_differential_properties *limits, float *speeds);
/*@ assigns d->low[0 .. 1], d->high[0 .. 1]; */
static void widen_envelope(drive *d);
/*@ assigns d->low[0 .. 1], d->high[0 .. 1], d->low_before[0 .. 1], d->high_before[0 .. 1],
            d->envelope_us; */
static void age_envelope(drive *d, uint32_t window_us, uint32_t now_us);

/*@ requires \valid(d) && \valid_read(config) && \valid_read(limits) && \valid(events) &&
        \valid(speeds + (0 .. 1));
    requires \valid(t) && \separated(d, config, limits, speeds + (0 .. 1), events, t);
    ensures no_speed_without_a_lease: \result != 0 && d->stopping == 0 ==>
        \old(d->armed) != 0 && \old(d->lease_active) != 0 &&
        (uint32_t)(t->now_us - \old(d->granted_us)) < \old(d->lease_us); */
bool roburoc4_drive_poll(drive *d, const roburoc4_config *config,
                         const roburoc4_differential_properties *limits, timer *t, float *speeds,
                         uint32_t *events);

/*@ requires \valid(d) && \valid_read(target + (0 .. 1)) && \separated(d, target + (0 .. 1));
    requires caused: d->armed == 0 ==> d->disarm_cause < 0;
    ensures only_armed: \result >= 0 ==> \old(d->armed) != 0 && d->granted_us == now_us &&
        d->lease_us == lease_us;
    ensures nothing_arms: d->armed == \old(d->armed); */
roburoc4_result roburoc4_drive_grant(drive *d, const float *target, uint32_t lease_us,
                                     uint32_t driven_us, uint32_t now_us);

/*@ requires \valid(d) && \valid(events) && \valid(t) && \valid_read(config) &&
        \separated(d, events, t, config);
    ensures a_lease_ends: \old(d->lease_active) != 0 &&
        (uint32_t)(t->now_us - \old(d->granted_us)) >= \old(d->lease_us) ==> d->lease_active == 0;
    ensures a_refusal_disarms: refusal < 0 ==> d->armed == 0;
    ensures disarmed_has_no_lease: \old(d->armed) != 0 && d->armed == 0 ==> d->lease_active == 0;
    ensures time_neither_arms_nor_grants: d->armed <= \old(d->armed) &&
        d->lease_active <= \old(d->lease_active); */
void roburoc4_drive_tick(drive *d, const roburoc4_config *config, roburoc4_result refusal, timer *t,
                         uint32_t *events);

/*@ requires \valid(d) && \valid(events) && \separated(d, events);
    ensures d->armed == 0 && d->lease_active == 0; */
void roburoc4_drive_interrupt(drive *d, roburoc4_result cause, uint32_t *events);

/*@ requires \valid(d) && \valid(events) && \separated(d, events);
    ensures d->lease_active == 0; */
void roburoc4_drive_stop(drive *d, uint32_t *events);
