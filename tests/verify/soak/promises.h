/* SPDX-License-Identifier: MIT
 *
 * promises.h - what the oracle judges, by name. What each promise means stands in docs/SAFETY.md.
 */
#ifndef ROBUROC4_SOAK_PROMISES_H
#define ROBUROC4_SOAK_PROMISES_H

#include <bitset>
#include <cstddef>
#include <string>

namespace soak {

enum class Promise {
    speed_needs_arming,
    speed_needs_lease,
    newest_target,
    within_limits,
    keep_curvature,
    bad_arguments_refused,
    override_disarms,
    override_by_texts,
    fresh_by_age,
    ages_are_bounds,
    arming_conditions,
    nothing_arms_itself,
    reboot_disarms,
    clock_ends_lease,
    zeros_first,
    zeros_repeated,
    stop_confirmed,
    stop_ends,
    rounding_is_not_motion,
    stop_before_speed,
    stop_always_sends,
    stop_latches,
    pause_keeps_armed,
    lapse_disarms,
    outcome_is_true,
    stop_is_watched,
    release_stops,
    stands_in_the_end,
    monitor_is_silent,
    only_differential,
    service_by_texts,
    spacing,
    other_commander_disarms,
    follows_or_disarmed,
    healthy_stays_armed,
    late_uplink_disarms,
    target_must_appear,
    restart_forgets,
    no_old_pose,
    feeds_watchdog,
    deadlines,
    comes_back,
    count_
};

using Promises = std::bitset<static_cast<std::size_t>(Promise::count_)>;

/** States that a run of some hours must have reached: else it has judged less than it says. */
enum class Reached {
    stop_under_pad_a,   /* driving ended while [A] was held */
    resumed_target,     /* our target came back when [A] was released */
    revived_speed,      /* a late command of ours came back after a zero */
    unconfirmed_stop,   /* a stop sequence ended without a confirmation */
    long_watchdog,      /* the robot followed us after the stop sequence had ended */
    hidden_restart,     /* a restart whose cycle count does not go back */
    another_robot,      /* at the same address */
    late_uplink,        /* commands reached the robot 0.4 s late while it was armed */
    late_statuses_only, /* statuses, but no answers, were 0.3 s late while it was armed */
    one_axis_does_not_follow,
    runs_away,
    not_a_number,
    stands_still,
    small_target_stands,  /* below 0.1 m/s */
    doubled_literal_text, /* where all answers have one id */
    resembling_text,      /* "Game pad A LED" */
    lapsed,
    paused,
    late_pose,     /* REPLACE was answered after more than 0.25 s */
    repeated_pose, /* or was repeated */
    others_within_limits,
    drifted, /* a quarter of an hour with clocks 300 ppm apart */
    count_
};
constexpr std::size_t reached_count = static_cast<std::size_t>(Reached::count_);
const char *reached_name(std::size_t reached);

const char *promise_name(Promise promise);
/** The promise in one sentence. */
const char *promise_sentence(Promise promise);
/** False if there is no promise of this name. */
bool find_promise(const std::string &name, Promise &out);

inline std::size_t number(Promise promise) {
    return static_cast<std::size_t>(promise);
}

} // namespace soak

#endif
