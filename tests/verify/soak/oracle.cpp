/* SPDX-License-Identifier: MIT */
#include "oracle.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace soak {

namespace {

bool close_to(float value, double expected) {
    return std::fabs(static_cast<double>(value) - expected) <= 1e-4 * (1.0 + std::fabs(expected));
}

} // namespace

bool Oracle::Limits::valid() const {
    return known && std::isfinite(max_v) && std::isfinite(min_v) && std::isfinite(max_w) &&
           std::isfinite(min_w) && min_v <= 0 && max_v >= 0 && min_w <= 0 && max_w >= 0;
}

Oracle::Oracle(const roburoc4_config &config, const RobotTruth &robot, const Promises &excluded)
    : config_(config), robot_(robot), excluded_(excluded), robots_({robot}) {
    rule_.user_set(config.role_index[ROBUROC4_ROLE_OVERRIDE]);
}

void Oracle::violate(Promise promise, std::uint64_t true_us, const std::string &what) {
    if (violation_.found || excluded_.test(number(promise)))
        return;
    violation_.found = true;
    violation_.promise = promise;
    violation_.true_us = true_us;
    violation_.what = what;
}

/* Stamps count cycles of 10 ms. Where statuses queue and answers do not, nothing on the wire proves
 * how late the promptest status was: that is what SAFETY leaves assumed, and it may creep as two
 * clocks drift apart. */
/* Of statuses with a queue of their own, the first after an answer may be from before its request.
 */
constexpr std::uint64_t own_queue_us = 100000;

std::uint64_t Oracle::tolerance_us(Moment now) const {
    std::uint64_t unproven = 0;
    if (robot_.own_queues && unproven_us_ != UINT64_MAX)
        unproven = unproven_us_ + (now.true_us - unproven_since_us_) / 1000 + own_queue_us;
    const std::uint64_t stray = stray_us_ == UINT64_MAX ? 0 : stray_us_;
    return 2 * cycle_us + clock_error_us_ + unproven + stray; /* two cycles: two stamps */
}

/* ------------------------------------------------------------------ leases, arming, stopping */

/* Every call that carries the time: what has ended by it? */
void Oracle::observe(Moment now) {
    if (clock_known_) {
        const std::int64_t by_client = static_cast<std::int64_t>(now.client_us - last_.client_us);
        const std::int64_t truly = static_cast<std::int64_t>(now.true_us - last_.true_us);
        if (by_client != truly) { /* the clock jumped; times across the jump say nothing */
            clock_changed_ = true;
            jumped_us_ = now.true_us;
            disturbed(now.true_us);
            if (by_client < truly && by_client >= 0) /* which no client can notice */
                clock_error_us_ += static_cast<std::uint64_t>(truly - by_client);
            if (by_client < 0) { /* the client's ages are by a clock that is no more */
                ages_known_ = false;
                ages_judged_ = ages_judged_ && !robot_.literal_ids; /* nor what answers belong to */
                if (restart_us_ != 0 && now.true_us - restart_us_ < 3000000)
                    gave_up_ = true; /* what tells a restart from late statuses is gone, too */
            }
            /* a small step between two calls is none to the client: its stop goes on */
            if (by_client < 0 ||
                std::llabs(truly - by_client) > static_cast<std::int64_t>(slack_us)) {
                stop_.due_us = stop_.again_us = now.true_us;
                if (by_client < truly) /* ahead: by its own clock the time may be over */
                    stop_.due_client_us = now.client_us;
            }
            stop_requested_us_ = now.true_us;
        }
        /* A pause may have been a jump of the clock, and statuses with a queue of their own that
         * come late from then on may not be late (SAFETY.md). */
        if (robot_.own_queues && (by_client != truly || truly >= 100000))
            ages_judged_ = false;
        if (static_cast<std::uint64_t>(truly) > milliseconds(config_.drive_period_ms) + slack_us)
            stop_.again_us = /* the machine was frozen */
                std::min(stop_.again_us + static_cast<std::uint64_t>(truly), now.true_us);
        if (by_client < 0 && lease_.alive) {
            last_ = now;
            end_driving(now, Promise::clock_ends_lease);
        }
    }
    clock_known_ = true;
    last_ = now;
    if (lease_.alive && now.client_us - lease_.granted_us >= lease_.length_us) {
        end_driving(now, Promise::speed_needs_lease);
        lapse_us_ = lease_.granted_us + lease_.length_us + milliseconds(config_.lapse_disarm_ms);
    }
}

void Oracle::end_lease(Promise promise) {
    if (!lease_.alive)
        return;
    lease_.alive = false;
    lease_.end_promise = promise;
    lapse_us_ = target_since_us_ = UINT64_MAX;
}

void Oracle::end_driving(Moment now, Promise promise) {
    end_lease(promise);
    if (speed_out_)
        begin_stop(now);
}

void Oracle::disarm(Moment now, Promise promise) {
    if (excluded_.test(number(promise)) && promise != Promise::nothing_arms_itself)
        return; /* this promise is not judged in this run */
    end_driving(now, promise);
    if (armed_)
        disarm_promise_ = promise;
    armed_ = false;
    lapse_us_ = UINT64_MAX;
}

/* Why it must not drive: what disarmed it, or that nobody armed it. */
Promise Oracle::unarmed_promise() const {
    return disarm_promise_ == Promise::nothing_arms_itself ? Promise::speed_needs_arming
                                                           : disarm_promise_;
}

void Oracle::begin_stop(Moment now) {
    if (stop_.active)
        return;
    if (overridden_ && unconfirmed_)
        reach(Reached::stop_under_pad_a);
    stop_ = Stop();
    stop_.active = true;
    stop_.due_us = stop_.again_us = now.true_us;
    stop_.due_client_us = now.client_us;
    if (command_out_ && last_command_zero_ && last_command_us_ == now.true_us)
        count_zero(now); /* the client noticed before the oracle could */
}

void Oracle::count_zero(Moment now) {
    stop_.zeros++;
    stop_.last_zero_us = now.true_us;
    if (stop_.zeros == 1)
        stop_.first_zero_us = now.true_us;
    if (++stop_.zeros_since_known == 3)
        stop_.third_zero_us = now.true_us;
}

bool Oracle::stop_may_end(Moment now) const {
    if (stop_.zeros < 3)
        return false;
    const std::uint64_t watchdog = milliseconds(config_.robot_watchdog_ms);
    return stop_.confirmed || now.true_us - stop_.due_us + slack_us >= watchdog ||
           now.client_us - stop_.due_client_us + slack_us >= watchdog ||
           now.true_us - last_speed_us_ + slack_us >= watchdog;
}

void Oracle::end_stop(Moment now, Promise otherwise) {
    if (!stop_may_end(now)) {
        if (stop_.zeros < 3)
            violate(otherwise, now.true_us,
                    "the stop sequence ended after " + std::to_string(stop_.zeros) + " zeros");
        else if (ages_judged_ && report_.differential_known)
            violate(Promise::stop_confirmed, now.true_us,
                    "the stop sequence ended " + ms_text(now.true_us - stop_.due_us) +
                        " after it became due, and no status made after its zeros was received" +
                        (stop_.confirmed_old ? " (an older one shows zero)" : ""));
    }
    if (stop_.confirmed) {
        unconfirmed_ = false;
        confirmed_us_ = now.true_us;
    }
    if (unconfirmed_)
        reach(Reached::unconfirmed_stop);
    stop_.active = false;
    speed_out_ = false;
}

/* ------------------------------------------------------------------- calls of the application */

void Oracle::started(Moment now) {
    clock_known_ = false; /* after a restart the clock may be another one */
    observe(now);
    started_ = true;
    started_us_ = well_since_us_ = now.true_us;
    unproven_us_ = UINT64_MAX;
    clock_error_us_ = answered_us_ = 0;
    stray_us_ = UINT64_MAX;
    last_of_start_.clear();
    for (Newest &newest : newest_)
        newest = Newest();
}

void Oracle::closed(Moment now) {
    observe(now);
    disarm(now, Promise::nothing_arms_itself);
    stop_requested_ = false;
    stop_.again_us = now.true_us;
}

bool Oracle::unknown_allowed() const {
    return (config_.options & ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE) != 0;
}

/** Where [A] is, if a client must know: the user may allow that texts which nobody answered, or
 * that may be another's where all answers have one id, leave it unknown. */
int Oracle::judged_index() const {
    return unknown_allowed() && report_.override_index < 0 ? -1 : rule_.index();
}

/** Where all answers have one id, a late text may have counted as another's: what matters is that
 * [A] is right. */
bool Oracle::override_is_right() const {
    return robot_.literal_ids && report_.override_index == robot_.pad_a;
}

void Oracle::armed(Moment now, std::int32_t result) {
    observe(now);
    if (result < 0)
        return;
    if (!started_ || report_.state != ROBUROC4_STATE_READY)
        violate(Promise::arming_conditions, now.true_us, "armed without being ready");
    judge_fresh(now, "armed");
    if (overridden_ && judged_index() >= 0)
        violate(report_.override_index == rule_.index() ? Promise::override_disarms
                                                        : Promise::override_by_texts,
                now.true_us, "armed while the newest status shows [A]");
    if (rule_.index() < 0 && !override_is_right() && !unknown_allowed())
        violate(Promise::override_by_texts, now.true_us,
                "armed although the robot's texts do not tell which input is [A]");
    if (!limits_.valid())
        violate(required_boot_ > 0 && !limits_.known ? Promise::restart_forgets
                                                     : Promise::arming_conditions,
                now.true_us, "armed on limits that are not valid");
    const auto drivable = [](const RobotTruth &robot) { return robot.differential_id != 0; };
    if (std::none_of(robots_.begin() + required_boot_, robots_.end(), drivable))
        violate(Promise::arming_conditions, now.true_us, "armed without a differential service");
    /* else it has older statuses only, which judge_fresh() knows of */
    const bool settled = !speed_out_ && now.true_us - last_speed_us_ > 5000000 &&
                         now.true_us - newest_[differential].made_us < 1000000;
    if (!armed_ && settled &&
        (std::fabs(reported_current_.v) > 0.101F || std::fabs(reported_current_.w) > 0.201F ||
         std::fabs(reported_target_.v) > 0.05F || std::fabs(reported_target_.w) > 0.05F))
        violate(Promise::arming_conditions, now.true_us,
                "armed on a robot that reports target " + speeds_text(reported_target_) +
                    " and speed " + speeds_text(reported_current_));
    lapse_us_ = UINT64_MAX; /* the program is awake */
    if (!armed_) {
        armings_++;
        armed_before_restart_ = false;
        others_ = 0;
        v_ = w_ = Axis();
    }
    armed_ = true;
}

void Oracle::drove(Moment now, Speeds speeds, std::uint32_t lease_us, std::int32_t result) {
    observe(now);
    const bool good_lease = lease_us == 0 || (lease_us >= 20000 && lease_us <= 1000000);
    const bool sensible = std::fabs(speeds.v) <= ROBUROC4_MAX_DRIVE_M_S &&
                          std::fabs(speeds.w) <= ROBUROC4_MAX_DRIVE_RAD_S; /* and finite */
    if (result < 0)
        return;
    if (!good_lease || !sensible) {
        violate(Promise::bad_arguments_refused, now.true_us,
                "drive" + speeds_text(speeds) + " with a lease of " + std::to_string(lease_us) +
                    " us was accepted");
        return;
    }
    if (!armed_)
        violate(unarmed_promise(), now.true_us, "drive() was accepted while not armed");
    if (lapse_us_ != UINT64_MAX && now.client_us > lapse_us_ + slack_us)
        violate(Promise::lapse_disarms, now.true_us, "drive() was accepted long after a lapse");
    const bool changed = !lease_.alive || lease_.asked.v != speeds.v || lease_.asked.w != speeds.w;
    lease_.sent = lease_.sent && !changed;
    if (!lease_.alive)
        lease_.begun_true_us = now.true_us;
    lease_.alive = true;
    lapse_us_ = UINT64_MAX;
    lease_.granted_us = now.client_us;
    lease_.granted_true_us = now.true_us;
    lease_.length_us = lease_us != 0 ? lease_us : milliseconds(config_.lease_ms);
    lease_.asked = speeds;
}

void Oracle::stopped(Moment now, std::int32_t result) {
    observe(now);
    if (result < 0)
        return;
    disarm(now, Promise::stop_latches);
    stop_requested_ = unconfirmed_ = true;
    stop_requested_us_ = stop_.again_us = now.true_us;
}

void Oracle::paused(Moment now, std::int32_t result) {
    observe(now);
    if (result < 0)
        return;
    const bool late = now.client_us >= lapse_us_; /* that lapse is not forgiven */
    pausing_ = armed_ && !late;
    if (armed_)
        reach(Reached::paused);
    end_driving(now, Promise::speed_needs_lease);
    lapse_us_ = late ? lapse_us_ : UINT64_MAX;
    stop_requested_ = unconfirmed_ = true;
    stop_requested_us_ = stop_.again_us = now.true_us;
}

void Oracle::pose_set(Moment now, std::int32_t result) {
    if (result < 0)
        return;
    pose_us_ = now.true_us;
    poses_sent_ = 0;
    way_at_pose_ = way_m_;
}

void Oracle::override_index_set(Moment now, std::int32_t index, std::int32_t result) {
    observe(now);
    if (result < 0)
        return;
    const int before = rule_.index();
    rule_.user_set(index);
    stop_.again_us = now.true_us; /* as if [A] was released, and once more when it is read */
    role_set_ = true;
    if (rule_.index() == before || rule_.index() == report_.override_index)
        return; /* nothing changes */
    overridden_ = false;
    disarm(now, Promise::override_by_texts);
}

void Oracle::outputs_set(Moment now) {
    observe(now);
    outputs_allowed_ = true;
    outputs_boot_ = static_cast<std::uint32_t>(robots_.size() - 1);
}

/* ------------------------------------------------------------------------------ what it sends */

void Oracle::sent(Moment now, const Datagram &datagram) {
    observe(now);
    if (!started_ || report_.state == ROBUROC4_STATE_IDLE) {
        if (!started_)
            violate(Promise::monitor_is_silent, now.true_us, "sent without having been started");
    }
    if (!is_command(datagram)) {
        request_sent(now, datagram);
        return;
    }
    const std::uint16_t service = datagram.u16_at(1);
    bool known = false, card = false; /* of any start that it may not have noticed yet */
    const bool zero = datagram.size == 11 && command_speeds(datagram).zero();
    for (std::size_t i = 0; i < robots_.size(); i++) {
        const bool may = i >= required_boot_;
        known = known || ((may || zero) && robots_[i].differential_id == service);
        card = card || (may && robots_[i].iocard_id == service);
    }
    /* what it knows of the services may be of two robots, until it reads them again */
    const bool reads =
        report_.state == ROBUROC4_STATE_CONNECTING || report_.state == ROBUROC4_STATE_DISCOVERING;
    if (start_is_hidden() && zero)
        mixed_service_ = service;
    else if (!reads)
        mixed_service_ = 0;
    known = known || (zero && service != 0 && service == mixed_service_);
    if (card && service != 0 && outputs_allowed_ && datagram.size != 11) {
        request_sent(now, datagram);
        return;
    }
    if (!known || service == 0 || datagram.size != 11) {
        violate(robot_.only_texts_tell && service == ROBUROC4_SERVICE_DIFFERENTIAL
                    ? Promise::service_by_texts
                    : Promise::only_differential,
                now.true_us,
                "a command of " + std::to_string(datagram.size) + " bytes went to service " +
                    std::to_string(service));
        gave_up_ = true; /* what follows from this is not another violation */
        return;
    }
    const Speeds speeds = command_speeds(datagram);
    judge_spacing(now, speeds.zero());
    if (speeds.zero())
        zero_sent(now);
    else
        speed_sent(now, speeds);
    command_out_ = true;
    const std::uint64_t hung_us = now.true_us - std::max(last_command_us_, lease_.begun_true_us);
    if (clock_changed_ || hung_us > milliseconds(config_.drive_period_ms) + slack_us)
        commanding_.clear();
    last_command_zero_ = speeds.zero();
    last_command_us_ = now.true_us;
    clock_changed_ = false;
}

void Oracle::request_sent(Moment now, const Datagram &datagram) {
    if (!is_command(datagram) && datagram.u8_at(1) == action_replace)
        poses_sent_++;
    if (stop_.active && stop_.zeros == 0 && speed_out_ && !last_command_zero_ &&
        report_.differential_known)
        violate(Promise::zeros_first, now.true_us, "other traffic left before the first zero");
}

void Oracle::judge_spacing(Moment now, bool zero) {
    if (!command_out_ || clock_changed_ || (zero && !last_command_zero_))
        return;
    if (now.true_us - last_command_us_ < spacing_us)
        violate(Promise::spacing, now.true_us,
                "a command left " + std::to_string(now.true_us - last_command_us_) +
                    " us after the one before");
}

void Oracle::zero_sent(Moment now) {
    const bool within_lease = lease_.alive && armed_ && target_may_be_zero();
    watch_due_us_ = release_due_us_ = UINT64_MAX;
    if (!stop_.active && stop_requested_)
        begin_stop(now);
    if (!stop_.active && speed_out_ && !within_lease) /* it ended driving by itself */
        end_driving(now, Promise::speed_needs_lease);
    else if (!stop_.active && (!within_lease || report_.stopping) && zeros_welcome(now)) {
        begin_stop(now);
        if (last_command_zero_ && last_command_us_ == stop_reported_us_)
            count_zero(now);
    }
    stop_requested_ = false;
    if (lease_.alive && target_may_be_zero())
        lease_.sent = true;
    if (within_lease && !stop_.active)
        remember(now, {});
    if (stop_.active) {
        count_zero(now);
        return;
    }
    if (!within_lease)
        violate(Promise::monitor_is_silent, now.true_us, "a zero left that nobody asked for");
}

/* A stop was not confirmed, a status shows our target, or that [A] was released. */
bool Oracle::zeros_welcome(Moment now) const {
    return unconfirmed_ || now.true_us <= zeros_welcome_us_ ||
           (report_.stopping && !sent_.empty()) || last_outcome_ >= ROBUROC4_STOP_TIMED_OUT;
}

/* A target of zero, or one of which the limits leave nothing. */
bool Oracle::target_may_be_zero() const {
    const Bounds bounds = this->bounds();
    const auto gone = [](float value, float low, float high) {
        return value == 0 || (value > 0 && high <= 0) || (value < 0 && low >= 0);
    };
    const bool no_v = gone(lease_.asked.v, bounds.low.v, bounds.high.v);
    const bool no_w = gone(lease_.asked.w, bounds.low.w, bounds.high.w);
    const bool keeps = (config_.options & ROBUROC4_OPTION_KEEP_CURVATURE) != 0;
    return keeps ? no_v || no_w : no_v && no_w;
}

/* Neither what is asked for nor what is sent exceeds a ceiling. */
Oracle::Bounds Oracle::bounds() const {
    const float v = config_.max_linear_m_s * std::min(config_.scale_linear, 1.0F);
    const float w = config_.max_angular_rad_s * std::min(config_.scale_angular, 1.0F);
    return {{std::max(limits_.min_v, -v), std::max(limits_.min_w, -w)},
            {std::min(limits_.max_v, v), std::min(limits_.max_w, w)}};
}

void Oracle::speed_sent(Moment now, Speeds speeds) {
    speeds_sent_++;
    if (stop_.active)
        end_stop(now, Promise::stop_before_speed);
    if (!armed_)
        violate(unarmed_promise(), now.true_us,
                "the speed " + speeds_text(speeds) + " left while not armed");
    if (!lease_.alive)
        violate(lease_.end_promise, now.true_us,
                "the speed " + speeds_text(speeds) + " left without a lease");
    judge_value(now, speeds);
    judge_fresh(now, "a speed left");
    if (pad_a_held_ && !start_is_hidden() && ages_judged_ &&
        !(unknown_allowed() && judged_index() < 0) &&
        now.true_us - pad_a_us_ > milliseconds(config_.fresh_ms) + tolerance_us(now))
        violate(now.true_us - newest_[iocard].made_us > milliseconds(config_.fresh_ms)
                    ? Promise::fresh_by_age
                : rule_.index() == robot_.pad_a && report_.override_index == robot_.pad_a
                    ? Promise::override_disarms
                    : Promise::override_by_texts,
                now.true_us,
                "a speed left " + ms_text(now.true_us - pad_a_us_) + " after [A] was pressed");
    lease_.sent = true;
    speed_out_ = unconfirmed_ = true;
    ended_under_pad_a_ = false;
    last_speed_us_ = now.true_us;
    remember(now, speeds);
}

/* What the robot may show as its target. */
void Oracle::remember(Moment now, Speeds speeds) {
    const bool same = std::fabs(speeds.v - target_sent_.v) < 0.02F &&
                      std::fabs(speeds.w - target_sent_.w) < 0.02F;
    if (!same || target_since_us_ == UINT64_MAX) {
        target_sent_ = speeds;
        target_since_us_ = target_seen_us_ = now.true_us;
        target_shown_ = false;
    }
    if (speeds.zero())
        return;
    const bool repeated =
        !sent_.empty() && sent_.back().speeds.v == speeds.v && sent_.back().speeds.w == speeds.w;
    if (repeated)
        sent_.back() = {now.true_us, now.client_us, speeds};
    else
        sent_.push_back({now.true_us, now.client_us, speeds});
    /* until a stop is confirmed, those from before it count, however long ago */
    const bool settled = now.true_us - last_unconfirmed_us_ > 180000000;
    while (now.true_us - sent_.front().true_us > 180000000 && (settled || sent_.size() > 10000))
        sent_.pop_front();
}

void Oracle::judge_value(Moment now, Speeds speeds) {
    if (!std::isfinite(speeds.v) || !std::isfinite(speeds.w)) {
        violate(Promise::within_limits, now.true_us, "the speed " + speeds_text(speeds) + " left");
        return;
    }
    if (!limits_.valid()) {
        violate(Promise::within_limits, now.true_us, "a speed left on limits that are not valid");
        return;
    }
    const Speeds low = bounds().low;
    const Speeds high = bounds().high;
    if (speeds.v < low.v || speeds.v > high.v || speeds.w < low.w || speeds.w > high.w)
        violate(Promise::within_limits, now.true_us,
                "the speed " + speeds_text(speeds) + " is beyond " + speeds_text(low) + " to " +
                    speeds_text(high));
    if (!lease_.alive)
        return;
    const Speeds asked = {lease_.asked.v * config_.scale_linear,
                          lease_.asked.w * config_.scale_angular};
    const bool keeps = (config_.options & ROBUROC4_OPTION_KEEP_CURVATURE) != 0 &&
                       limits_.width > 0.05F && limits_.width < 5.0F;
    if (keeps) {
        judge_turn(now, asked, speeds, low, high);
        return;
    }
    if (!close_to(speeds.v, std::min(std::max(asked.v, low.v), high.v)) ||
        !close_to(speeds.w, std::min(std::max(asked.w, low.w), high.w)))
        violate(Promise::newest_target, now.true_us,
                "the speed " + speeds_text(speeds) + " left where " + speeds_text(asked) +
                    " was asked for");
}

/* The curve stays: v and w reduced by one factor. A direction that the robot does not have at all
 * has no curve to keep. */
void Oracle::judge_turn(Moment now, Speeds asked, Speeds speeds, Speeds low, Speeds high) {
    const auto blocked = [](float value, float at_least, float at_most) {
        return (value > 0 && at_most <= 0) || (value < 0 && at_least >= 0);
    };
    if (blocked(asked.v, low.v, high.v) || blocked(asked.w, low.w, high.w))
        return;
    const double crossed = static_cast<double>(speeds.v) * static_cast<double>(asked.w) -
                           static_cast<double>(speeds.w) * static_cast<double>(asked.v);
    const double size = std::hypot(asked.v, asked.w) * std::hypot(speeds.v, speeds.w);
    const bool same_side = static_cast<double>(speeds.v) * static_cast<double>(asked.v) >= 0 &&
                           static_cast<double>(speeds.w) * static_cast<double>(asked.w) >= 0;
    const bool larger = std::fabs(speeds.v) > std::fabs(asked.v) * 1.0001F ||
                        std::fabs(speeds.w) > std::fabs(asked.w) * 1.0001F;
    if (std::fabs(crossed) > 1e-4 * size || !same_side || larger)
        violate(Promise::keep_curvature, now.true_us,
                "the speed " + speeds_text(speeds) + " left where " + speeds_text(asked) +
                    " was asked for, which is another curve");
}

void Oracle::judge_fresh(Moment now, const char *what) {
    const std::uint64_t limit = milliseconds(config_.fresh_ms) + tolerance_us(now);
    const Newest *const statuses[] = {&newest_[differential], &newest_[iocard]};
    for (const Newest *status : statuses) {
        const char *const name = status == &newest_[iocard] ? "IO card" : "differential";
        if (status == &newest_[iocard] && unknown_allowed() &&
            (robot_.iocard_id == 0 || judged_index() < 0))
            continue;
        if (!status->known && ages_judged_)
            violate(Promise::fresh_by_age, now.true_us,
                    std::string(what) + " without any " + name + " status");
        else if (status->known && ages_judged_ && now.true_us - status->made_us > limit)
            violate(Promise::fresh_by_age, now.true_us,
                    std::string(what) + " on a " + name + " status that is truly " +
                        ms_text(now.true_us - status->made_us) + " old (fresh_ms " +
                        std::to_string(config_.fresh_ms) + ")");
    }
}

} // namespace soak
