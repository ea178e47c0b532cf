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
    turn_keeping,
    bad_arguments_refused,
    override_disarms,
    override_by_texts,
    fresh_by_age,
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
    monitor_is_silent,
    only_differential,
    service_by_texts,
    spacing,
    other_commander_disarms,
    inhibited_disarms,
    feeds_watchdog,
    deadlines,
    comes_back,
    count_
};

using Promises = std::bitset<static_cast<std::size_t>(Promise::count_)>;

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
