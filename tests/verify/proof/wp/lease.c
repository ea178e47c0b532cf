/* SPDX-License-Identifier: MIT
 *
 * For Frama-C's WP: what src/drive.c promises about speeds. A command that roburoc4_drive_poll()
 * gives out is a zero of a train, or it belongs to a lease that lives; and a lease lives only where
 * it was taken while armed, for the time that was asked for, and not after it was left. Never
 * compiled.
 */
#include "bytes.h"
#include "machines.h"

/* WP's memory has no bytes of floats: copying and clearing a pair of them is told by its effect. */
/*@ requires \valid(to + (0 .. 1)) && \valid_read(from + (0 .. 1));
    assigns to[0 .. 1] \from from[0 .. 1];
    ensures to[0] == \old(from[0]) && to[1] == \old(from[1]); */
void copy_pair(float *to, const float *from);
/*@ axiomatic cleared { logic real cleared; } // the float that memset() makes: 0
 */
/*@ requires \valid(to + (0 .. 1));
    assigns to[0 .. 1];
    ensures to[0] == cleared && to[1] == cleared; */
void clear_speeds(float *to);
/*@ assigns *d; */
void clear_d(drive *d);

#define memcpy(to, from, size) copy_pair(to, from)
#define memset(to, value, size) clear_##to(to)

#include "drive.c"

/*@ predicate may_move(drive *d, uint64_t now_us) =
      d->armed != 0 && d->known != 0 && d->leased != 0 &&
      (uint64_t)(now_us - d->granted_us) < d->lease_us; */

/* Who is not armed has an error to be told: grant() gives it back in place of a lease. */
/*@ predicate caused(drive *d) = d->armed == 0 ==> d->disarm_cause < 0; */

/* ---- what speeds.c and bytes.h do, as far as it matters here ---- */

/*@ assigns \nothing; */
float roburoc4_clamp(float value, float low, float high);
/*@ assigns \nothing; */
bool roburoc4_between(float value, float low, float high);
/*@ assigns \nothing; */
bool roburoc4_all_finite(const float *values, uint32_t count);
/*@ assigns \nothing; */
static inline uint32_t bits_from_f32(float value);
/*@ assigns \nothing; */
static bool is_zero(float value);
/*@ assigns \nothing; */
static float magnitude(float value);

/* ---- leaving ends the lease ---- */

/*@ requires \valid(d);
    assigns d->train, d->zeros, d->confirmed, d->spoke;
    ensures d->train == 1 && d->zeros == 0 && d->spoke == 0; */
static void begin_train(drive *d);

/*@ requires \valid(d);
    assigns d->leased, d->train, d->zeros, d->confirmed, d->spoke;
    ensures no_lease: d->leased == 0;
    ensures a_train_if_it_spoke: \old(d->spoke) != 0 ==> d->train == 1 && d->zeros == 0;
    ensures else_as_before: \old(d->spoke) == 0 ==> d->train == \old(d->train); */
static void leave(drive *d);

/*@ requires \valid(d) && \valid(events);
    requires \separated(d, events);
    requires an_error: cause < 0;
    requires caused(d);
    assigns d->leased, d->train, d->zeros, d->confirmed, d->spoke, d->disarm_cause,
            d->armed, *events;
    ensures a_cause_is_an_error: caused(d);
    ensures no_lease: d->leased == 0;
    ensures disarmed: d->armed == 0;
    ensures a_train_if_it_spoke: \old(d->spoke) != 0 ==> d->train == 1 && d->zeros == 0; */
void roburoc4_drive_interrupt(drive *d, roburoc4_result cause, uint32_t *events);

/*@ requires \valid(d);
    assigns d->leased, d->train, d->zeros, d->confirmed, d->spoke, d->stop_latched;
    ensures no_lease: d->leased == 0;
    ensures a_train_or_owed: d->train == 1 || d->stop_latched == 1; */
void roburoc4_drive_stop(drive *d);

/* ---- taking a lease ---- */

/*@ requires \valid(d) && \valid(events) && \separated(d, events);
    assigns d->armed, d->disarm_cause, *events;
    ensures a_cause_is_an_error: caused(d);
    ensures d->armed == 1; */
void roburoc4_drive_arm(drive *d, uint32_t *events);

/*@ requires \valid(d) && \valid_read(target + (0 .. 1));
    requires \separated(d, target + (0 .. 1));
    requires caused(d);
    assigns *d;
    ensures a_cause_is_an_error: caused(d);
    ensures only_armed: \result == 0 ==> d->armed != 0 && d->leased == 1 &&
        d->granted_us == now_us && d->lease_us == lease_us;
    ensures refused: \result != 0 ==> d->leased == \old(d->leased) &&
        d->granted_us == \old(d->granted_us) && d->lease_us == \old(d->lease_us) &&
        d->target[0] == \old(d->target[0]) && d->target[1] == \old(d->target[1]) &&
        d->armed == \old(d->armed);
    ensures disarmed_stays: \old(d->armed) == 0 ==>
        \result != 0 && d->armed == 0; */
roburoc4_result roburoc4_drive_grant(drive *d, const float *target, uint32_t lease_us,
                                     uint64_t now_us);

/* ---- time passes ---- */

/*@ requires \valid_read(d);
    assigns \nothing;
    ensures (\result != 0) <==>
        (d->leased != 0 && (uint64_t)(now_us - d->granted_us) >= d->lease_us); */
static bool lease_over(const drive *d, uint64_t now_us);

/*@ requires \valid(d) && \valid(events);
    requires \separated(d, events);
    requires caused(d);
    assigns d->leased, d->train, d->zeros, d->confirmed, d->spoke, d->disarm_cause,
            d->armed, *events;
    ensures a_cause_is_an_error: caused(d);
    ensures over_is_left: \old(d->leased) != 0 &&
        (uint64_t)(now_us - \old(d->granted_us)) >= \old(d->lease_us) ==> d->leased == 0;
    ensures a_refusal_disarms: refusal < 0 ==> d->armed == 0;
    ensures disarming_ends_the_lease: \old(d->armed) != 0 && d->armed == 0 ==> d->leased == 0;
    ensures never_arms: \old(d->armed) == 0 ==> d->armed == 0;
    ensures never_leases: \old(d->leased) == 0 ==> d->leased == 0; */
void roburoc4_drive_tick(drive *d, roburoc4_result refusal, uint64_t now_us, uint32_t *events);

/* ---- sending ---- */

/*@ requires \valid_read(d) && \valid_read(config) && \valid_read(limits + (0 .. 12)) &&
        \valid(speeds + (0 .. 1));
    assigns speeds[0 .. 1]; */
static void shape(const drive *d, const roburoc4_config *config, const float *limits,
                  float *speeds);

/*@ requires \valid(d);
    assigns d->low[0 .. 1], d->high[0 .. 1]; */
static void widen_envelope(drive *d);

/*@ requires \valid(d);
    assigns d->low[0 .. 1], d->high[0 .. 1], d->low_before[0 .. 1], d->high_before[0 .. 1],
            d->envelope_us; */
static void age_envelope(drive *d, uint32_t window_us, uint64_t now_us);

/*@ requires \valid_read(d) && \valid_read(config);
    assigns \nothing; */
static bool train_ended(const drive *d, const roburoc4_config *config, uint64_t now_us);

/*@ requires \valid_read(d) && \valid_read(config);
    assigns \nothing; */
static uint32_t pause_us(const drive *d, const roburoc4_config *config);

/*@ requires \valid(d) && \valid_read(config) && \separated(d, config);
    assigns d->zeros, d->train_us; */
static bool poll_train(drive *d, const roburoc4_config *config, uint64_t now_us);

/*@ requires \valid(d) && \valid_read(config) && \valid_read(limits + (0 .. 12)) &&
        \valid(speeds + (0 .. 1)) && \valid(events);
    requires \separated(d, config, limits + (0 .. 12), speeds + (0 .. 1), events);
    assigns *d, speeds[0 .. 1], *events;
    ensures train_or_leased: \result != 0 ==> d->train != 0 || \old(may_move(d, now_us));
    ensures a_train_is_zero: d->train != 0 ==> speeds[0] == cleared && speeds[1] == cleared;
    ensures nothing_is_zero: \result == 0 ==> speeds[0] == cleared && speeds[1] == cleared;
    ensures no_new_lease: d->leased == \old(d->leased) && d->armed == \old(d->armed) &&
        d->granted_us == \old(d->granted_us) && d->lease_us == \old(d->lease_us); */
bool roburoc4_drive_poll(drive *d, const roburoc4_config *config, const float *limits,
                         uint64_t now_us, float *speeds, uint32_t *events);
