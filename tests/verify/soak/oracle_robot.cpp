/* SPDX-License-Identifier: MIT
 *
 * oracle_robot.cpp - what the client must conclude from what it receives, and must not claim.
 */
#include "oracle.h"

#include <algorithm>
#include <cmath>

namespace soak {

namespace {

/* A client can judge a status's age only by round trips and by the pauses between statuses. */
constexpr std::uint64_t sure_after_us = 300000;
constexpr std::uint64_t watched_us = 1900000; /* beyond 2 s, it does not answer with zeros */
constexpr std::uint64_t uplink_us = 650000;   /* half a second, and the time to notice it */
constexpr std::uint64_t well_after_us = 12000000;
constexpr std::uint64_t standing_us = 1000000;
/* Until then the ages may seem too high, where this clock jumped by more than one pause shows. */
constexpr std::uint64_t forgiven_after_us = 75000000;
constexpr float rounding = 1e-3F;
constexpr float same_target = 0.02F;

bool zero_by_rounding(Speeds speeds) {
    return std::fabs(speeds.v) <= rounding && std::fabs(speeds.w) <= rounding;
}

bool near(Speeds a, Speeds b) {
    return std::fabs(a.v - b.v) <= same_target && std::fabs(a.w - b.w) <= same_target;
}

bool searching(const Report &report) {
    return report.state == ROBUROC4_STATE_CONNECTING || report.state == ROBUROC4_STATE_DISCOVERING;
}

/* A robot that stands is noticed by its own clock, as far as statuses come (SAFETY.md). */
constexpr std::uint64_t noticed_cycles = 330;
constexpr std::uint64_t cycles_of_a_status = 30; /* at most */
constexpr float clear_target = 0.4F;
constexpr float no_motion = 0.005F;

/* Up to eight seconds (SAFETY.md), and longer for small targets; UINT64_MAX where it need not be
 * noticed. */
std::uint64_t follow_us(float size) {
    return size >= 0.2F ? 8000000 : size >= 0.05F ? 10000000 : UINT64_MAX;
}

} // namespace

/* --------------------------------------------------------------------------- what it receives */

void Oracle::received(Moment now, const Datagram &datagram, std::int32_t result) {
    observe(now);
    const Origin &origin = datagram.origin;
    if (is_status(datagram) && (result >= 0 || result == ROBUROC4_ERR_OLD))
        watch_restart(now, datagram);
    const bool text =
        origin.kind == Origin::Kind::input_text || origin.kind == Origin::Kind::input_refusal;
    /* where answers do not name their request, it is seen, too, what one before was taken for */
    const bool nameless = robot_.literal_ids || datagram.bytes[0] == ROBUROC4_HEADER_ERROR;
    const bool doubted = text && nameless && result == ROBUROC4_ERR_UNMATCHED;
    if (doubted)
        reach(Reached::doubled_literal_text);
    if (!is_status(datagram)) {
        answer_delay_us_ = now.true_us - origin.made_us;
        if (result >= 0)
            answered_us_ = std::max(answered_us_, origin.asked_us);
        /* close() forgets what was asked before */
        if (stop_.zeros > 0 && origin.asked_us > stop_.first_zero_us &&
            (result >= 0 || result == ROBUROC4_ERR_ROBOT))
            stop_.answered_us = std::min(stop_.answered_us, now.true_us);
    }
    if ((result < 0 && result != ROBUROC4_ERR_ROBOT && !doubted) || origin.boot < required_boot_)
        return;
    switch (origin.kind) {
    case Origin::Kind::iocard_properties:
        if (result > 0) /* taken for those of a service that had this id before a restart */
            break;
        analog_inputs_ = static_cast<std::int32_t>(datagram.u32_at(5));
        rule_.set_counts(analog_inputs_, static_cast<std::int32_t>(datagram.u32_at(9)),
                         static_cast<std::int32_t>(datagram.u32_at(13)),
                         static_cast<std::int32_t>(datagram.u32_at(17)), origin.boot);
        break;
    case Origin::Kind::differential_properties:
        if (datagram.size < 57 || result > 0)
            break;
        limits_ = {true,
                   datagram.f32_at(21),
                   datagram.f32_at(25),
                   datagram.f32_at(29),
                   datagram.f32_at(33),
                   datagram.f32_at(53),
                   origin.boot};
        break;
    case Origin::Kind::input_text: {
        const auto *const letters = reinterpret_cast<const char *>(datagram.bytes.data() + 5);
        rule_.text_read(origin.index, std::string(letters, datagram.size - 5), origin.boot);
        if (rule_.doubtful())
            reach(Reached::resembling_text);
        break;
    }
    case Origin::Kind::input_refusal:
        rule_.text_refused(origin.index, origin.boot);
        break;
    default:
        if (is_status(datagram))
            status(now, datagram);
        break;
    }
}

void Oracle::status(Moment now, const Datagram &datagram) {
    const std::uint64_t made = datagram.origin.made_us;
    Newest &newest = newest_[datagram.origin.index];
    if (newest.known && made <= newest.made_us)
        return;
    ages_known_ = true;
    const std::uint64_t age = now.true_us - made;
    newest = {true, made, datagram.u64_at(3), now.client_us, age, datagram.origin.boot};
    ages_known_of_[datagram.origin.index]++;
    /* one may come after an answer, and answers may overtake them, which two in a row seem to deny
     * (SAFETY.md) */
    overtaken_ = made < answered_us_ ? overtaken_ + 1 : 0;
    if (overtaken_ > 1)
        stray_us_ = stray_us_ == UINT64_MAX ? age : std::max(stray_us_, age);
    else if (made < started_us_ || stray_us_ != UINT64_MAX)
        stray_us_ = std::min(stray_us_, age);
    const std::uint64_t crept = (now.true_us - unproven_since_us_) / 1000;
    if (unproven_us_ == UINT64_MAX || age <= unproven_us_ + crept) {
        unproven_us_ = age;
        unproven_since_us_ = now.true_us;
    }
    if (armed_ && age > 200000 && answer_delay_us_ < 50000 && robot_.own_queues)
        reach(Reached::late_statuses_only);
    if (armed_ && robot_.drifts && now.true_us - started_us_ > 900000000)
        reach(Reached::drifted);
    if (datagram.origin.kind == Origin::Kind::differential_status)
        differential_status(now, datagram);
    if (datagram.origin.kind == Origin::Kind::iocard_status)
        iocard_status(now, datagram);
}

void Oracle::differential_status(Moment now, const Datagram &datagram) {
    const std::uint64_t made = datagram.origin.made_us;
    const Speeds target = {datagram.f32_at(11), datagram.f32_at(19)};
    const Speeds current = {datagram.f32_at(15), datagram.f32_at(23)};
    reported_target_ = target;
    reported_current_ = current;
    if (stop_.active && zero_by_rounding(target)) {
        if (stop_.zeros > 0 &&
            made + tolerance_us(now) + first_ages_us(now) >= stop_.first_zero_us &&
            !(overridden_ && report_.override_known))
            stop_.confirmed = true;
        else
            stop_.confirmed_old = true;
        if (stop_.zeros_since_known >= 3 && stop_.sure_us == 0 && stop_.answered_us < made &&
            made > std::max(stop_.third_zero_us, stop_.answered_us) + sure_after_us +
                       report_.age_us[differential])
            stop_.sure_us = now.true_us;
    }
    watch_target(now, datagram);
    watch_other_commander(now, datagram);
    watch_axis(now, datagram, v_, target.v, current.v);
    watch_axis(now, datagram, w_, target.w, current.w);
    watch_swing(now, v_swing_, target.v, current.v);
    watch_swing(now, w_swing_, target.w, current.w);
}

/** Whether it is one of the speeds that left since then. */
bool Oracle::ours(Speeds target, std::uint64_t since_us) const {
    return std::any_of(sent_.begin(), sent_.end(), [&](const Sent &sent) {
        return sent.true_us >= since_us && near(sent.speeds, target);
    });
}

/** Whether it lies between speeds that left lately: late statuses show those from before. */
bool Oracle::resembles_ours(Speeds target, std::uint64_t since_us) const {
    const auto spans = [&](float Speeds::*axis) {
        bool below = false, above = false;
        for (const Sent &sent : sent_) {
            below = below || (sent.true_us >= since_us && sent.speeds.*axis <= target.*axis);
            above = above || (sent.true_us >= since_us && sent.speeds.*axis >= target.*axis);
        }
        return below && above;
    };
    return spans(&Speeds::v) && spans(&Speeds::w);
}

/* What the robot shows as its target: ours within a lease, and none of ours without. */
void Oracle::watch_target(Moment now, const Datagram &datagram) {
    const Speeds target = reported_target_;
    const bool interfered = datagram.origin.others_target || datagram.origin.pad_a || overridden_;
    if (lease_.alive && armed_ && !stop_.active && target_since_us_ != UINT64_MAX &&
        config_.drive_period_ms <= 100) {
        /* of two changes in a row, the first proves that commands arrived, too */
        const bool shown = near(target, target_sent_) || interfered ||
                           ours(target, now.true_us - uplink_us) ||
                           (robot_.own_queues && resembles_ours(target, now.true_us - 4000000));
        /* one that disappears is missing since a status has shown it: while none came, nothing
         * could (and where all answers have one id, nothing else tells) */
        if (shown || target_shown_)
            target_seen_us_ = now.true_us;
        else if (now.true_us - target_seen_us_ > uplink_us &&
                 (config_.options & ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER) == 0)
            disarm(now, Promise::target_must_appear);
        target_shown_ = shown;
    }
    if (zero_by_rounding(target)) {
        if (!lease_.alive)
            watch_due_us_ = UINT64_MAX;
        return;
    }
    zeros_welcome_us_ = now.true_us + milliseconds(config_.drive_period_ms) + slack_us;
    stop_.again_us = std::max(stop_.again_us, now.true_us);
    const std::uint64_t watchdog = milliseconds(config_.robot_watchdog_ms);
    std::uint64_t since = now.true_us - watchdog;
    if (unconfirmed_) { /* and within that time before the last stop, unless it was confirmed */
        const std::uint64_t stop = stop_.first_zero_us;
        since = std::min(since, std::max(confirmed_us_, stop - std::min(stop, watchdog)));
    }
    const bool must = ours(target, since) && !interfered && datagram.origin.boot <= judged_boot_ &&
                      now.true_us - std::max(disturbed_us_, others_us_) > well_after_us;
    const std::uint64_t age = /* by the client's own bound, too: others judge that */
        std::max<std::uint64_t>(report_.age_us[differential],
                                now.true_us - datagram.origin.made_us);
    const bool fresh = age + 100000 < milliseconds(config_.fresh_ms);
    if (must && fresh && !lease_.alive && !stop_.active && watch_due_us_ == UINT64_MAX &&
        report_.state == ROBUROC4_STATE_READY && report_.differential_known)
        watch_due_us_ = now.true_us + milliseconds(config_.drive_period_ms) + spacing_us;
}

void Oracle::watch_other_commander(Moment now, const Datagram &datagram) {
    /* until a stop is confirmed, and for a while after, any that was sent may come back */
    const std::uint64_t longest = 6 * milliseconds(config_.robot_watchdog_ms);
    const bool all = report_.stopping || now.true_us - last_unconfirmed_us_ <= longest;
    Speeds low, high; /* each axis by itself */
    for (const Sent &sent : sent_) {
        if (!all && now.true_us - sent.true_us > longest)
            continue;
        low = {std::min(low.v, sent.speeds.v), std::min(low.w, sent.speeds.w)};
        high = {std::max(high.v, sent.speeds.v), std::max(high.w, sent.speeds.w)};
    }
    const Speeds target = reported_target_;
    const auto inside = [](float value, float at_least,
                           float at_most) { /* and some tolerance */
                                            return value >= at_least * 1.05F - same_target &&
                                                   value <= at_most * 1.05F + same_target;
    };
    const bool within = inside(target.v, low.v, high.v) && inside(target.w, low.w, high.w);
    const bool others = datagram.origin.others_target && !zero_by_rounding(target);
    if (others && within)
        reach(Reached::others_within_limits);
    others_ = others && !within && !overridden_ ? others_ + 1 : 0;
    if (others_ >= 3 && (config_.options & ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER) == 0)
        disarm(now, Promise::other_commander_disarms);
}

/* Far from the target, for longer than any member of the family needs to reach it. */
void Oracle::watch_axis(Moment now, const Datagram &datagram, Axis &axis, float target,
                        float current) {
    const std::uint64_t stamp = datagram.u64_at(3);
    const float size = std::fabs(target);
    const float along = target < 0 ? -current : current;
    const bool slow = size >= 0.05F && !(along >= 0.2F * size);
    const bool fast = !(along <= 1.8F * size + 0.3F) || !(along >= -0.3F - 0.8F * size);
    const bool watched = armed_ && lease_.alive && !datagram.origin.pad_a && !overridden_ &&
                         !datagram.origin.others_target && near(reported_target_, target_sent_);
    const bool off = watched && (slow || fast);
    const bool same = std::fabs(target - axis.target) <= 0.1F * size;
    if (!off || !axis.off || !same) {
        axis = {off, false, now.true_us, target, stamp, 0};
        return;
    }
    const std::uint64_t since = now.true_us - axis.since_us;
    axis.still_cycles = std::fabs(current) <= no_motion
                            ? axis.still_cycles + std::min(stamp - axis.stamp, cycles_of_a_status)
                            : 0;
    axis.stamp = stamp;
    if (axis.still_cycles >= noticed_cycles && size >= clear_target)
        disarm(now, Promise::follows_or_disarmed);
    if (since >= 500000 && !axis.counted) {
        axis.counted = true;
        reach(std::isnan(current) ? Reached::not_a_number
              : fast              ? Reached::runs_away
              : size < 0.1F       ? Reached::small_target_stands
              : v_.off != w_.off  ? Reached::one_axis_does_not_follow
                                  : Reached::stands_still);
    }
    if (since >= (fast ? follow_us(1) : follow_us(size)))
        disarm(now, Promise::follows_or_disarmed);
}

/* A slow member overshoots: after a large target, it may move against a small one for seconds. */
void Oracle::watch_swing(Moment now, Swing &swing, float target, float current) {
    if (std::fabs(target - swing.target) > same_target)
        swing = Swing();
    swing.target = target;
    const float along = target < 0 ? -current : current;
    swing.along = swing.along || along > 0.05F;
    if (swing.along && along < -0.02F && std::fabs(target) > rounding)
        swing.against_us = now.true_us;
}

bool Oracle::shows_input(const Datagram &datagram, int index) const {
    const std::size_t first = 11 + 4 * static_cast<std::size_t>(analog_inputs_);
    const std::uint8_t block = datagram.u8_at(first + static_cast<std::size_t>(index / 8));
    return (block >> (index % 8) & 1) != 0;
}

void Oracle::iocard_status(Moment now, const Datagram &datagram) {
    const int index = judged_index();
    const bool before = overridden_;
    const bool shown_before = pad_a_shown_;
    overridden_ = index >= 0 && shows_input(datagram, index);
    pad_a_shown_ = overridden_;
    /* [A] may have been shown before the client was ready: a stop that began then, too, is sent
     * again when [A] is released; one that does not know [A] any more cannot exclude that it was */
    const bool clients_before = clients_pad_shown_; /* of the input that the client takes for [A] */
    clients_pad_shown_ =
        report_.override_index >= 0 && shows_input(datagram, report_.override_index);
    if ((shown_before && !pad_a_shown_) || (clients_before && !clients_pad_shown_) ||
        pad_a_forgotten_) {
        zeros_welcome_us_ = now.true_us + milliseconds(config_.drive_period_ms) + slack_us;
        stop_.again_us = now.true_us;
    }
    pad_a_forgotten_ = false;
    if (role_set_)
        stop_.again_us = now.true_us;
    role_set_ = false;
    if (index < 0)
        return;
    if (overridden_) {
        ended_under_pad_a_ = ended_under_pad_a_ || lease_.alive || stop_.active;
        disarm(now, report_.override_index == index ? Promise::override_disarms
                                                    : Promise::override_by_texts);
    } else if (before && datagram.origin.boot <= judged_boot_) {
        if (unconfirmed_ && ended_under_pad_a_ && !sent_.empty() && report_.override_known &&
            report_.stop_outcome != ROBUROC4_STOP_CONFIRMED &&
            report_.state == ROBUROC4_STATE_READY && report_.differential_known &&
            !report_.stopping)
            release_due_us_ = now.true_us + spacing_us;
    }
}

/** By how much the robot's clock advanced. */
double Oracle::counted_us(const Newest &from, const Datagram &datagram) {
    return (static_cast<double>(datagram.u64_at(3)) - static_cast<double>(from.stamp)) * 1e4;
}

/** Whether the robot's clock advanced as the client's did. Statuses that are late may be of the
 *  same start, and so may those after them. */
bool Oracle::may_be_same_start(const Newest &from, Moment now, const Datagram &datagram) {
    const double passed =
        static_cast<double>(now.client_us) - static_cast<double>(from.received_us);
    const double hidden = 2e6 + static_cast<double>(from.late_us) +
                          static_cast<double>(now.true_us - datagram.origin.made_us);
    return std::fabs(counted_us(from, datagram) - passed) < hidden;
}

/** Whether after several restarts, of which the client has noticed none, the clock shows what it
 *  would have shown without. */
bool Oracle::hides_restarts(Moment now, const Datagram &datagram) const {
    return std::any_of(last_of_start_.begin(), last_of_start_.end(), [&](const auto &start) {
        return start.first < boot_ && may_be_same_start(start.second, now, datagram);
    });
}

/* A restart shows in stamps: they go back, or they did not advance as time did. */
void Oracle::watch_restart(Moment now, const Datagram &datagram) {
    const std::uint64_t stamp = datagram.u64_at(3);
    if (datagram.origin.boot < boot_) /* from a queue of its own: they are not in a row */
        restarted_statuses_ = 0;
    if (datagram.origin.boot > boot_ && hides_restarts(now, datagram)) {
        gave_up_ = true; /* what was forgotten after the first of them may count again */
        return;
    }
    last_of_start_[datagram.origin.boot] = {true,
                                            datagram.origin.made_us,
                                            stamp,
                                            now.client_us,
                                            now.true_us - datagram.origin.made_us,
                                            datagram.origin.boot};
    if (datagram.origin.boot <= judged_boot_)
        return;
    const Newest *last = nullptr; /* of the robot before */
    for (const Newest &newest : newest_)
        if (newest.known && newest.boot < datagram.origin.boot &&
            (last == nullptr || newest.received_us > last->received_us))
            last = &newest;
    /* of a start whose statuses only showed that it was another, the clock is known, too; but a
     * pause of the program may be as long as what the next one's lacks */
    bool hidden = false;
    for (const auto &start : last_of_start_)
        if (start.first < datagram.origin.boot && last != nullptr && start.first > last->boot) {
            last = &start.second;
            hidden = disturbed_us_ > last->made_us;
        }
    if (datagram.origin.boot != boot_) {
        boot_ = datagram.origin.boot;
        restart_us_ = now.true_us;
        restarted_statuses_ = 0;
        armed_before_restart_ = armed_;
        const double counted = last != nullptr ? counted_us(*last, datagram) : 0;
        if (last == nullptr || hidden || may_be_same_start(*last, now, datagram)) {
            judged_boot_ = boot_; /* nothing to notice; but ages are wrong by what it is ahead */
            jumped_us_ = now.true_us;
            const auto truly = static_cast<double>(datagram.origin.made_us) -
                               static_cast<double>(last != nullptr ? last->made_us : 0);
            if (last != nullptr && counted > truly)
                clock_error_us_ += static_cast<std::uint64_t>(counted - truly);
            if (last == nullptr && changed_us_ >= started_us_)
                clock_error_us_ += 1000000; /* it overheard the start before, less than that off */
            return;
        }
        if (counted > 0)
            reach(Reached::hidden_restart);
    }
    if (++restarted_statuses_ >= 3)
        forget_robot(now);
}

void Oracle::forget_robot(Moment now) {
    judged_boot_ = required_boot_ = boot_;
    robot_ = robots_[boot_];
    if (armed_before_restart_)
        disarm(now, Promise::reboot_disarms);
    else if (limits_.boot < boot_) /* armed on limits of the robot before */
        disarm(now, Promise::restart_forgets);
    rule_.forget_before(boot_);
    if (limits_.boot < boot_)
        limits_ = Limits();
    overridden_ = speed_out_ = false;
    outputs_allowed_ = outputs_allowed_ && outputs_boot_ >= boot_;
    for (Newest &newest : newest_)
        if (newest.boot < boot_)
            newest = Newest();
    unproven_us_ = UINT64_MAX;
}

void Oracle::robot_changed(const RobotTruth &robot) {
    if (robot_.own_queues || robot.own_queues) /* statuses of the one before may come, as if new */
        ages_judged_ = false;
    robots_.push_back(robot);
    changed_us_ = last_.true_us;
}

/* ---------------------------------------------------------------------------- what it reports */

void Oracle::reported(Moment now, const Report &report, const Truth &truth, bool drained,
                      std::uint64_t next_deadline) {
    observe(now);
    const Report before = report_;
    report_ = report;
    if (report.stopping && !before.stopping) /* the zero of this call may be its first */
        stop_reported_us_ = now.true_us;
    if (truth.well != well_) {
        well_ = truth.well;
        well_since_us_ = now.true_us;
    }
    way_m_ += static_cast<double>(std::fabs(truth.moving.v)) *
              static_cast<double>(now.true_us - way_us_) * 1e-6;
    way_us_ = now.true_us;
    if (report.other_commander) /* a speed of ours that came so late counts as another's */
        others_us_ = now.true_us;
    if (report.armed && !armed_)
        violate(disarm_promise_, now.true_us, "the client reports that it is armed");
    if (!report.armed && armed_) {
        if (report.disarm_cause == ROBUROC4_ERR_LAPSED)
            reach(Reached::lapsed);
        judge_disarming(now, report);
        disarm(now, Promise::nothing_arms_itself);
    }
    pausing_ = false;
    if (before.override_known && !report.override_known && pad_a_shown_)
        pad_a_forgotten_ = true;
    if (!before.override_known && report.override_known) /* and its release, perhaps */
        stop_.again_us = now.true_us;
    if ((report.events & ROBUROC4_EVENT_REBOOT) != 0) { /* the newest it knows now */
        last_of_start_.erase(last_of_start_.begin(), last_of_start_.lower_bound(boot_));
        ages_judged_ = ages_judged_ && !robot_.own_queues; /* a delay that it finds is normal */
    }
    judge_override_report(now, report);
    judge_ages(now, report);
    judge_outcome(now, before, truth);
    judge_pose(now, report);
    /* closed before a robot was found again: no service is known that zeros could go to */
    if (report.state == ROBUROC4_STATE_IDLE && (searching(before) || !before.differential_known))
        stop_.active = speed_out_ = false;
    if (!drained)
        return;
    if (report.state != before.state && report.state != ROBUROC4_STATE_READY)
        unproven_us_ = UINT64_MAX; /* as after a start */
    if (report.state != before.state)
        stop_.again_us = now.true_us; /* a robot that is lost, or found, is stopped again */
    if (report.state != ROBUROC4_STATE_READY)
        overridden_ = false;
    if (report.state == ROBUROC4_STATE_IDLE) {
        started_ = unconfirmed_ = false;
        sent_.clear();
    }
    if (lease_.alive && !report.driving)
        end_driving(now, Promise::speed_needs_lease);
    if (report.driving && !lease_.alive)
        violate(lease_.end_promise, now.true_us, "the client reports a living lease");
    judge_stop_in_time(now, report);
    judge_feeding(now);
    judge_watch(now);
    judge_uplink(now, truth);
    judge_standing(now, truth);
    if (lapse_us_ != UINT64_MAX && now.client_us > lapse_us_ + slack_us) {
        if (report.armed)
            violate(Promise::lapse_disarms, now.true_us, "it is armed long after a lapse");
        lapse_us_ = UINT64_MAX;
    }
    if (next_deadline <= now.client_us)
        violate(Promise::deadlines, now.true_us, "everything was sent, and the deadline is past");
}

/* A healthy robot on a good network gives no reason to disarm, and pause() is none. */
void Oracle::judge_disarming(Moment now, const Report &report) {
    const std::int32_t cause = report.disarm_cause;
    if (pausing_ && (cause == ROBUROC4_ERR_STOP_CALLED || cause == ROBUROC4_ERR_DISARMED ||
                     cause == ROBUROC4_ERR_LAPSED))
        violate(Promise::pause_keeps_armed, now.true_us, "pause() has disarmed");
    switch (cause) {
    case ROBUROC4_ERR_STALE_DIFFERENTIAL:
    case ROBUROC4_ERR_STALE_IOCARD:
        if (!robots_.back().prompt ||
            (jumped_us_ != 0 && now.true_us - well_since_us_ < forgiven_after_us) ||
            (changed_us_ != 0 && now.true_us - changed_us_ < forgiven_after_us))
            return; /* only a good network shows a jump of either clock, however long ago */
        break;
    case ROBUROC4_ERR_INHIBITED:
        if (now.true_us - std::max(v_swing_.against_us, w_swing_.against_us) < 1500000)
            return; /* it moves the wrong way, which SAFETY says disarms, though it is healthy */
        break;
    case ROBUROC4_ERR_UPLINK:
    case ROBUROC4_ERR_OTHER_COMMANDER:
    case ROBUROC4_ERR_LOST:
    case ROBUROC4_ERR_REBOOT:
        break;
    default:
        return;
    }
    if (well_ && now.true_us - well_since_us_ > well_after_us)
        violate(Promise::healthy_stays_armed, now.true_us,
                "disarmed (" + std::string(roburoc4_result_text(cause)) +
                    ") although all was well for " + ms_text(now.true_us - well_since_us_));
}

/* The first pairs of an answer and a status prove little. */
bool Oracle::ages_are_new(std::uint64_t true_us, int service) const {
    return true_us < ages_since_us_[service] + 3000000;
}

/* By so much a status may be older then (SAFETY.md). */
std::uint64_t Oracle::first_ages_us(Moment now) const {
    return ages_are_new(now.true_us, differential) ? 100000 : 0;
}

void Oracle::judge_ages(Moment now, const Report &report) {
    for (int service = 0; service < 5; service++) {
        const Newest &newest = newest_[service];
        if (report.state != ROBUROC4_STATE_READY || report.age_us[service] == UINT32_MAX) {
            ages_since_us_[service] = now.true_us;
            ages_known_of_[service] = 0;
        }
        const std::uint64_t received_us = newest.made_us + newest.late_us;
        if (!newest.known || !ages_known_ || !ages_judged_ || ages_known_of_[service] <= 3 ||
            ages_are_new(received_us, service))
            continue;
        if (newest.boot < boot_) /* by the clock of another start */
            continue;
        const std::uint64_t age = now.true_us - newest.made_us;
        if (age > report.age_us[service] + tolerance_us(now))
            violate(Promise::ages_are_bounds, now.true_us,
                    "a status of service " + std::to_string(service) + " is " + ms_text(age) +
                        " old, and the client says at most " + ms_text(report.age_us[service]));
    }
}

void Oracle::judge_outcome(Moment now, const Report &before, const Truth &truth) {
    if (report_.stop_outcome != ROBUROC4_STOP_RUNNING)
        last_outcome_ = report_.stop_outcome;
    if (report_.stop_outcome != ROBUROC4_STOP_CONFIRMED)
        last_unconfirmed_us_ = now.true_us;
    const bool says = (report_.events & ROBUROC4_EVENT_STOP_CONFIRMED) != 0 ||
                      (report_.stop_outcome == ROBUROC4_STOP_CONFIRMED &&
                       before.stop_outcome != ROBUROC4_STOP_CONFIRMED);
    if (says && !stop_.confirmed && ages_judged_)
        violate(
            Promise::outcome_is_true, now.true_us,
            std::string("the stop is reported as confirmed") +
                ((report_.events & ROBUROC4_EVENT_STOP_CONFIRMED) != 0 ? ", " : " (no event), ") +
                (overridden_ ? "but [A] is held" : "but no status shows it"));
    const bool knew = report_.override_index >= 0 || before.override_index >= 0 ||
                      unknown_allowed() ||
                      (report_.events & ROBUROC4_EVENT_REBOOT) != 0; /* it forgot it since */
    if (says && !knew)
        violate(Promise::outcome_is_true, now.true_us,
                "the stop is reported as confirmed, and it is not known whether [A] is held");
    stop_.nameless = stop_.nameless || before.fixed_id;
    if (says && truth.oldest_speed_us < stop_.first_zero_us && !stop_.nameless)
        violate(Promise::outcome_is_true, now.true_us,
                "the stop is reported as confirmed, and a speed is still on its way");
}

void Oracle::judge_watch(Moment now) {
    const bool able =
        report_.state == ROBUROC4_STATE_READY && report_.differential_known && !lease_.alive;
    if (!able)
        watch_due_us_ = release_due_us_ = UINT64_MAX;
    if (watch_due_us_ != UINT64_MAX && now.true_us > watch_due_us_ + slack_us)
        violate(Promise::stop_is_watched, now.true_us,
                "a fresh status shows our target " + speeds_text(reported_target_) +
                    " without a lease, and no zero has left");
    if (release_due_us_ != UINT64_MAX && now.true_us > release_due_us_ + slack_us)
        violate(Promise::release_stops, now.true_us,
                "[A] was released after a stop that was not confirmed, and no zero has left");
}

void Oracle::judge_uplink(Moment now, const Truth &truth) {
    /* where all answers have one id, none proves when its request arrived */
    const std::uint64_t since_us = std::exchange(looked_us_, now.true_us);
    const std::uint64_t heard_us = truth.newest_heard_us;
    while (!commanding_.empty() && commanding_.front().second <= heard_us)
        commanding_.pop_front();
    if (!armed_ || truth.uplink_loses || robot_.literal_ids || report_.fixed_id ||
        config_.drive_period_ms > 100)
        commanding_.clear();
    else if (lease_.alive && !stop_.active && !last_command_zero_)
        commanding_.emplace_back(std::max(since_us, lease_.begun_true_us), now.true_us);
    std::uint64_t unheard_us = 0;
    for (const auto &[begin_us, end_us] : commanding_)
        unheard_us += end_us - std::min(end_us, std::max(begin_us, heard_us));
    if (unheard_us > 400000)
        reach(Reached::late_uplink);
    if (unheard_us > uplink_us)
        violate(Promise::late_uplink_disarms, now.true_us,
                "the robot has received nothing that was sent during the last " +
                    ms_text(unheard_us) + " of driving, and the client is armed");
}

void Oracle::judge_standing(Moment now, const Truth &truth) {
    /* statuses of 2 s are too old, and a speed that comes late enough is another commander's */
    const bool loose = !lease_.alive && !truth.clients_target.zero() &&
                       report_.state == ROBUROC4_STATE_READY && report_.differential_known &&
                       newest_[differential].known && !sent_.empty() &&
                       report_.age_us[differential] < watched_us && !report_.other_commander;
    if (loose && now.true_us - last_speed_us_ > milliseconds(config_.robot_watchdog_ms) + 100000)
        reach(Reached::long_watchdog);
    if (!loose || !truth.well || now.true_us - well_since_us_ < 100000)
        standing_due_us_ = now.true_us + standing_us;
    if (now.true_us > standing_due_us_)
        violate(Promise::stands_in_the_end, now.true_us,
                "the robot follows our target " + speeds_text(truth.clients_target) + " for " +
                    ms_text(now.true_us - standing_due_us_ + standing_us) +
                    " without a lease, on a good network");
}

void Oracle::judge_pose(Moment now, const Report &report) {
    const bool at_once = poses_sent_ < 2 && now.true_us - pose_us_ < 250000 + slack_us;
    if ((report.events & ROBUROC4_EVENT_RELOCALIZED) == 0 || at_once)
        return;
    reach(poses_sent_ < 2 ? Reached::late_pose : Reached::repeated_pose);
    /* a status of 0.15 s may still show the rest before, and one that alone is late as well */
    if (way_m_ - way_at_pose_ > 0.4 && !robot_.own_queues)
        violate(Promise::no_old_pose, now.true_us,
                "a pose was accepted late, and the robot has moved " +
                    std::to_string(way_m_ - way_at_pose_) + " m since it was given");
}

void Oracle::judge_override_report(Moment now, const Report &report) {
    /* while statuses are old, nothing is done that a restart could make wrong */
    if (!report.override_known || report.state != ROBUROC4_STATE_READY ||
        report.age_us[iocard] >= milliseconds(config_.fresh_ms) || override_is_right())
        return;
    const int index = rule_.index();
    if (index < 0 && boot_ == 0) /* after a restart, it is not certain which texts count */
        violate(Promise::override_by_texts, now.true_us,
                "the override counts as known (input " + std::to_string(report.override_index) +
                    ") although the robot's texts do not tell it yet");
    else if (index != report.override_index)
        violate(Promise::override_by_texts, now.true_us,
                "input " + std::to_string(report.override_index) + " is taken for [A], which is " +
                    std::to_string(index) + " (" + rule_.text() + ")");
}

void Oracle::judge_stop_in_time(Moment now, const Report &report) {
    const std::uint64_t period = milliseconds(config_.drive_period_ms);
    const bool known = report.state == ROBUROC4_STATE_READY && report.differential_known &&
                       robot_.differential_id != 0;
    if (known && !known_)
        known_us_ = now.true_us;
    known_ = known;
    if (stop_requested_ && known &&
        now.true_us - std::max(stop_requested_us_, known_us_) > spacing_us + slack_us)
        violate(Promise::stop_always_sends, now.true_us,
                "no zero has left " + ms_text(now.true_us - stop_requested_us_) + " after stop()");
    if (!stop_.active)
        return;
    if (!report.differential_known) {
        stop_.zeros_since_known = 0;
        stop_.sure_us = 0;
    }
    if (stop_.zeros == 0 && speed_out_ &&
        report.differential_known) { /* a zero within the lease may delay it */
        if (!last_command_zero_ ||
            (!clock_changed_ && now.true_us - last_command_us_ > spacing_us + slack_us))
            violate(Promise::zeros_first, now.true_us, "driving has ended, and no zero has left");
        return;
    }
    if (!report.stopping) {
        if (searching(report)) /* what it drove is gone, or another one now */
            speed_out_ = false;
        else if (speed_out_ || report.differential_known)
            end_stop(now, Promise::zeros_repeated);
        stop_.active = false;
        return;
    }
    if (!report.differential_known &&
        (searching(report) || !speed_out_ ||
         stop_may_end(now))) { /* stop() is latched until the service is known */
        stop_.again_us = stop_.last_zero_us = now.true_us;
        return;
    }
    if (stop_.zeros == 0 || !report.differential_known) /* they go to the service found next */
        return;
    if (now.true_us - stop_.last_zero_us > period + slack_us && !clock_changed_)
        violate(Promise::zeros_repeated, now.true_us,
                "the last zero left " + ms_text(now.true_us - stop_.last_zero_us) + " ago");
    const std::uint64_t watchdog = milliseconds(config_.robot_watchdog_ms);
    const std::uint64_t longest = std::max(watchdog, 3 * period) + 3 * period;
    if (now.true_us - std::max({stop_.first_zero_us, stop_.again_us, known_us_}) > longest &&
        report.state != ROBUROC4_STATE_SUBSCRIBING)
        violate(Promise::stop_ends, now.true_us,
                "the stop sequence lasts " + ms_text(now.true_us - stop_.due_us));
    /* where all answers have one id, or take long, ages are known late; while [A] is not known,
     * nothing confirms; while closing, nothing asks, so ages that a step of the clock made unknown,
     * or a restart long, stay so */
    const bool calm =
        !robot_.literal_ids && !robot_.slow_texts && calm_us_ < now.true_us &&
        now.true_us - calm_us_ > 5000000 && report.override_known &&
        (report.state != ROBUROC4_STATE_CLOSING || report.age_us[differential] < 1000000);
    if (calm && stop_.sure_us > stop_.again_us && now.true_us - stop_.sure_us > period + slack_us)
        violate(robot_.rounds ? Promise::rounding_is_not_motion : Promise::stop_ends, now.true_us,
                "a status has confirmed the stop, but the sequence continues");
}

void Oracle::judge_feeding(Moment now) {
    if (!lease_.alive || !armed_ || stop_.active || clock_changed_)
        return;
    const std::uint64_t period = milliseconds(config_.drive_period_ms);
    const std::uint64_t since = command_out_ ? now.true_us - last_command_us_ : UINT64_MAX;
    const std::uint64_t granted = now.true_us - lease_.granted_true_us;
    if (!lease_.sent && granted > spacing_us + slack_us && since > spacing_us + slack_us)
        violate(Promise::feeds_watchdog, now.true_us,
                "a new target has not left after " + ms_text(granted));
    if (lease_.sent && since > period + slack_us)
        violate(Promise::feeds_watchdog, now.true_us,
                "no command for " + ms_text(since) + " within a lease");
}

void Oracle::pad_a_changed(bool held, std::uint64_t true_us) {
    pad_a_held_ = held;
    pad_a_us_ = true_us;
}

} // namespace soak
