/* SPDX-License-Identifier: MIT */
#include "promises.h"

#include <iterator>

namespace soak {

namespace {

struct Text {
    Promise promise;
    const char *name;
    const char *sentence;
};

const Text texts[] = {
    {Promise::speed_needs_arming, "speed-needs-arming",
     "No speed leaves unless the application armed the client and nothing has disarmed it since."},
    {Promise::speed_needs_lease, "speed-needs-lease",
     "No speed leaves outside a lease that the application granted and that has not ended."},
    {Promise::newest_target, "newest-target",
     "A speed on the wire is the newest target, scaled and clamped, and no other."},
    {Promise::within_limits, "within-limits",
     "Speeds are finite and within the robot's limits and the configured ceilings."},
    {Promise::keep_curvature, "keep-curvature",
     "With keep_curvature both speeds are reduced by one factor, so that the curve stays."},
    {Promise::bad_arguments_refused, "bad-arguments-refused",
     "NaN, infinity and a lease out of range are refused and store nothing."},
    {Promise::override_disarms, "override-disarms",
     "Once a status shows game pad [A] held, the client is disarmed and cannot be armed."},
    {Promise::override_by_texts, "override-by-texts",
     "Which input is [A] is what all the robot's texts say, or unknown; it is not guessed."},
    {Promise::fresh_by_age, "fresh-by-age",
     "No speed leaves, and nothing arms, on a status that is truly older than fresh_ms."},
    {Promise::ages_are_bounds, "ages-are-bounds",
     "No status is truly older than the client says that it can be."},
    {Promise::arming_conditions, "arming-conditions",
     "arm() succeeds only when ready, with valid limits, on a robot that stands."},
    {Promise::nothing_arms_itself, "nothing-arms-itself",
     "The client is armed only by arm(); once disarmed it stays so."},
    {Promise::reboot_disarms, "reboot-disarms",
     "After three statuses of a restarted robot the client is disarmed."},
    {Promise::clock_ends_lease, "clock-ends-lease",
     "A clock that steps back ends the lease for good."},
    {Promise::zeros_first, "zeros-first",
     "After driving ends, a zero command leaves at once, before all other traffic."},
    {Promise::zeros_repeated, "zeros-repeated",
     "A stop sequence repeats zeros at each drive period, at least three."},
    {Promise::stop_confirmed, "stop-confirmed",
     "A stop sequence ends early only by a status made after its zeros were sent."},
    {Promise::stop_ends, "stop-ends",
     "A stop sequence ends when it is confirmed or the robot's watchdog time is over."},
    {Promise::rounding_is_not_motion, "rounding-is-not-motion",
     "A reported speed within rounding of zero is zero: it confirms a stop and lets arm."},
    {Promise::stop_before_speed, "stop-before-speed",
     "No speed leaves before the stop sequence that is due has ended."},
    {Promise::stop_always_sends, "stop-always-sends",
     "stop() always sends zeros, now or as soon as the service is known."},
    {Promise::stop_latches, "stop-latches", "After stop() only arm() allows driving again."},
    {Promise::pause_keeps_armed, "pause-keeps-armed", "pause() ends the lease and stays armed."},
    {Promise::lapse_disarms, "lapse-disarms",
     "A lease that expired and is not renewed for lapse_disarm_ms disarms."},
    {Promise::outcome_is_true, "outcome-is-true",
     "A stop is reported as confirmed only by a status made after its zeros, not under [A], and "
     "with no speed on its way."},
    {Promise::stop_is_watched, "stop-is-watched",
     "Zeros leave for as long as a fresh status shows a target of ours without a lease."},
    {Promise::release_stops, "release-stops",
     "When [A] is released after a stop that was not confirmed, zeros leave again."},
    {Promise::stands_in_the_end, "stands-in-the-end",
     "On a good network no robot follows a target of ours for long after driving has ended."},
    {Promise::monitor_is_silent, "monitor-is-silent",
     "A client that was not asked to drive or stop sends no command, not even a zero."},
    {Promise::only_differential, "only-differential",
     "Speeds go to the robot's differential service and to no other."},
    {Promise::service_by_texts, "service-by-texts",
     "A service that only its text tells is not guessed while that text is missing; it is asked "
     "for again."},
    {Promise::spacing, "spacing",
     "Commands are at least 10 ms apart, except for the first zero after a speed."},
    {Promise::other_commander_disarms, "other-commander-disarms",
     "Three statuses with a target that is neither zero nor ours disarm the client."},
    {Promise::follows_or_disarmed, "follows-or-disarmed",
     "An axis that does not follow its target (too slow, too fast, wrong way, NaN) disarms."},
    {Promise::healthy_stays_armed, "healthy-stays-armed",
     "No healthy robot on a good network is taken for one that does not follow or hears late."},
    {Promise::late_uplink_disarms, "late-uplink-disarms",
     "Commands that reach the robot more than half a second late disarm."},
    {Promise::target_must_appear, "target-must-appear",
     "A target that does not appear in statuses for half a second disarms."},
    {Promise::restart_forgets, "restart-forgets",
     "After a restart, or with another robot, nothing counts that was read before it."},
    {Promise::no_old_pose, "no-old-pose",
     "A relocalization that was repeated or taken late while the robot moved is not done."},
    {Promise::feeds_watchdog, "feeds-watchdog",
     "While a lease lives, its command is repeated at each drive period."},
    {Promise::deadlines, "deadlines",
     "When everything due was sent, the next deadline is in the future and in time."},
    {Promise::comes_back, "comes-back",
     "With a healthy robot on a good network, the client can be armed within 30 s, and drives."},
};

} // namespace

const char *promise_name(Promise promise) {
    return texts[number(promise)].name;
}

const char *promise_sentence(Promise promise) {
    return texts[number(promise)].sentence;
}

const char *reached_name(std::size_t reached) {
    static const char *const names[] = {"stop under [A]",
                                        "resumed target",
                                        "revived speed",
                                        "unconfirmed stop",
                                        "long watchdog",
                                        "hidden restart",
                                        "another robot",
                                        "late uplink",
                                        "late statuses only",
                                        "one axis does not follow",
                                        "runs away",
                                        "not a number",
                                        "stands still",
                                        "small target stands",
                                        "doubled literal text",
                                        "resembling text",
                                        "lapsed",
                                        "paused",
                                        "late pose",
                                        "repeated pose",
                                        "others within limits",
                                        "drifted"};
    static_assert(std::size(names) == reached_count, "one name each");
    return names[reached];
}

bool find_promise(const std::string &name, Promise &out) {
    for (const Text &text : texts) {
        if (name != text.name)
            continue;
        out = text.promise;
        return true;
    }
    return false;
}

} // namespace soak
