/* SPDX-License-Identifier: MIT */
#include "oracle.h"

#include <algorithm>
#include <cmath>

namespace soak {

namespace {

constexpr std::uint64_t spacing_us = 10000;
constexpr std::uint64_t slack_us = 1000;
/* A client can judge a status's age only by round trips and by the pauses between statuses. */
constexpr std::uint64_t sure_after_us = 300000;
constexpr std::uint64_t inhibited_us = 2000000;
constexpr float rounding = 1e-3F;

bool zero_by_rounding(Speeds speeds) {
    return std::fabs(speeds.v) <= rounding && std::fabs(speeds.w) <= rounding;
}

bool close_to(float value, double expected) {
    return std::fabs(static_cast<double>(value) - expected) <= 1e-4 * (1.0 + std::fabs(expected));
}

std::uint64_t milliseconds(std::uint32_t ms) {
    return static_cast<std::uint64_t>(ms) * 1000;
}

std::string speeds_text(Speeds speeds) {
    return "(" + std::to_string(speeds.v) + ", " + std::to_string(speeds.w) + ")";
}

std::string ms_text(std::uint64_t us) {
    return std::to_string(us / 1000) + " ms";
}

} // namespace

bool Oracle::Limits::valid() const {
    return known && std::isfinite(max_v) && std::isfinite(min_v) && std::isfinite(max_w) &&
           std::isfinite(min_w) && min_v <= 0 && max_v >= 0 && min_w <= 0 && max_w >= 0;
}

void Oracle::Envelope::include(Speeds speeds) {
    low_v = std::min(low_v, speeds.v);
    high_v = std::max(high_v, speeds.v);
    low_w = std::min(low_w, speeds.w);
    high_w = std::max(high_w, speeds.w);
}

bool Oracle::Envelope::contains(Speeds speeds) const {
    const float near = 0.1F;
    return speeds.v >= low_v - near && speeds.v <= high_v + near && speeds.w >= low_w - near &&
           speeds.w <= high_w + near;
}

Oracle::Oracle(const roburoc4_config &config, const RobotTruth &robot, const Promises &excluded)
    : config_(config), robot_(robot), excluded_(excluded) {
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

/* The truth about a status is known to the microsecond, the client has stamps of 10 ms, clocks
 * that drift, and a bound on both. */
std::uint64_t Oracle::tolerance_us(Moment now) const {
    return 30000 + (now.true_us - started_us_) / 5000;
}

/* ------------------------------------------------------------------ leases, arming, stopping */

/* Every call that carries the time: what has ended by it? */
void Oracle::observe(Moment now) {
    if (clock_known_) {
        const std::int64_t by_client = static_cast<std::int64_t>(now.client_us - last_.client_us);
        const std::int64_t truly = static_cast<std::int64_t>(now.true_us - last_.true_us);
        if (by_client != truly) { /* the clock jumped; times across the jump say nothing */
            clock_changed_ = true;
            stop_.due_us = stop_.again_us = now.true_us;
            if (by_client < truly) /* ahead: by its own clock the time may be over */
                stop_.due_client_us = now.client_us;
            stop_requested_us_ = now.true_us;
        }
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
    if (lease_.alive && now.client_us - lease_.granted_us >= lease_.length_us)
        end_driving(now, Promise::speed_needs_lease);
}

void Oracle::end_lease(Promise promise) {
    if (!lease_.alive)
        return;
    lease_.alive = false;
    lease_.end_promise = promise;
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
}

/* Why it must not drive: what disarmed it, or that nobody armed it. */
Promise Oracle::unarmed_promise() const {
    return disarm_promise_ == Promise::nothing_arms_itself ? Promise::speed_needs_arming
                                                           : disarm_promise_;
}

void Oracle::begin_stop(Moment now) {
    if (stop_.active)
        return;
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
        else
            violate(Promise::stop_confirmed, now.true_us,
                    "the stop sequence ended " + ms_text(now.true_us - stop_.due_us) +
                        " after it became due, and no status made after its zeros was received" +
                        (stop_.confirmed_old ? " (an older one shows zero)" : ""));
    }
    stop_.active = false;
    speed_out_ = false;
}

/* ------------------------------------------------------------------- calls of the application */

void Oracle::started(Moment now) {
    clock_known_ = false; /* after a restart the clock may be another one */
    observe(now);
    started_ = true;
    started_us_ = now.true_us;
}

void Oracle::closed(Moment now) {
    observe(now);
    disarm(now, Promise::nothing_arms_itself);
    stop_requested_ = false;
}

bool Oracle::unknown_allowed() const {
    return (config_.options & ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE) != 0;
}

/** Where [A] is, if a client must know: the user may allow that texts which nobody answered, or
 * that may be another's where all answers have one id, leave it unknown. */
int Oracle::judged_index() const {
    return unknown_allowed() && report_.override_index < 0 ? -1 : rule_.index();
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
    if (rule_.index() < 0 && !unknown_allowed() && !robot_.literal_ids)
        violate(Promise::override_by_texts, now.true_us,
                "armed although the robot's texts do not tell which input is [A]");
    if (!limits_.valid())
        violate(Promise::arming_conditions, now.true_us, "armed on limits that are not valid");
    if (robot_.differential_id == 0)
        violate(Promise::arming_conditions, now.true_us, "armed without a differential service");
    const bool settled = !speed_out_ && now.true_us - last_speed_us_ > 5000000;
    if (!armed_ && settled &&
        (std::fabs(reported_current_.v) > 0.101F || std::fabs(reported_current_.w) > 0.201F ||
         std::fabs(reported_target_.v) > 0.05F || std::fabs(reported_target_.w) > 0.05F))
        violate(Promise::arming_conditions, now.true_us,
                "armed on a robot that reports target " + speeds_text(reported_target_) +
                    " and speed " + speeds_text(reported_current_));
    if (!armed_) {
        armings_++;
        restarted_statuses_ = 0;
        others_ = 0;
        still_ = false;
    }
    armed_ = true;
}

void Oracle::disarmed(Moment now) {
    observe(now);
    disarm(now, Promise::nothing_arms_itself);
    zeros_welcome_us_ = now.true_us + spacing_us + slack_us; /* disarm() also stops */
}

void Oracle::drove(Moment now, Speeds speeds, std::uint32_t lease_us, std::int32_t result) {
    observe(now);
    const bool good_lease = lease_us == 0 || (lease_us >= 20000 && lease_us <= 1000000);
    const bool finite = std::isfinite(speeds.v) && std::isfinite(speeds.w);
    if (result < 0)
        return;
    if (!good_lease || !finite) {
        violate(Promise::bad_arguments_refused, now.true_us,
                "drive" + speeds_text(speeds) + " with a lease of " + std::to_string(lease_us) +
                    " us was accepted");
        return;
    }
    if (!armed_)
        violate(unarmed_promise(), now.true_us, "drive() was accepted while not armed");
    const bool changed = !lease_.alive || lease_.asked.v != speeds.v || lease_.asked.w != speeds.w;
    lease_.sent = lease_.sent && !changed;
    lease_.alive = true;
    lease_.granted_us = now.client_us;
    lease_.granted_true_us = now.true_us;
    lease_.length_us = lease_us != 0 ? lease_us : milliseconds(config_.lease_ms);
    lease_.asked = speeds;
}

void Oracle::stopped(Moment now, std::int32_t result) {
    observe(now);
    if (result < 0)
        return;
    end_driving(now, Promise::speed_needs_lease);
    stop_requested_ = true;
    stop_requested_us_ = stop_.again_us = now.true_us;
}

void Oracle::override_index_set(Moment now, std::int32_t index, std::int32_t result) {
    observe(now);
    if (result < 0)
        return;
    const int before = rule_.index();
    rule_.user_set(index);
    if (rule_.index() == before || rule_.index() == report_.override_index)
        return; /* nothing changes */
    overridden_ = false;
    disarm(now, Promise::override_by_texts);
}

void Oracle::outputs_set(Moment now) {
    observe(now);
    outputs_allowed_ = true;
}

/* ------------------------------------------------------------------------------ what it sends */

void Oracle::sent(Moment now, const Datagram &datagram) {
    observe(now);
    if (!started_ || report_.state == ROBUROC4_STATE_IDLE) {
        if (!started_)
            violate(Promise::monitor_is_silent, now.true_us, "sent without having been started");
    }
    if (!is_command(datagram)) {
        request_sent(now);
        return;
    }
    const std::uint16_t service = datagram.u16_at(1);
    if (service == robot_.iocard_id && service != 0 && outputs_allowed_) {
        request_sent(now);
        return;
    }
    if (service != robot_.differential_id || service == 0 || datagram.size != 11) {
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
    last_command_zero_ = speeds.zero();
    last_command_us_ = now.true_us;
    clock_changed_ = false;
}

void Oracle::request_sent(Moment now) {
    if (stop_.active && stop_.zeros == 0 && speed_out_ && !last_command_zero_)
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
    if (!stop_.active && stop_requested_)
        begin_stop(now);
    if (!stop_.active && speed_out_ && !within_lease) /* it ended driving by itself */
        end_driving(now, Promise::speed_needs_lease);
    else if (!stop_.active && !within_lease && now.true_us <= zeros_welcome_us_)
        begin_stop(now);
    stop_requested_ = false;
    if (lease_.alive && target_may_be_zero())
        lease_.sent = true;
    if (stop_.active) {
        count_zero(now);
        return;
    }
    if (!within_lease)
        violate(Promise::monitor_is_silent, now.true_us, "a zero left that nobody asked for");
}

/* A target of zero, or one of which the limits leave nothing. */
bool Oracle::target_may_be_zero() const {
    const Bounds bounds = this->bounds();
    const auto gone = [](float value, float low, float high) {
        return value == 0 || (value > 0 && high <= 0) || (value < 0 && low >= 0);
    };
    const bool no_v = gone(lease_.asked.v, bounds.low.v, bounds.high.v);
    const bool no_w = gone(lease_.asked.w, bounds.low.w, bounds.high.w);
    const bool keeps = (config_.options & ROBUROC4_OPTION_TURN_KEEPING) != 0;
    return keeps ? no_v || no_w : no_v && no_w;
}

Oracle::Bounds Oracle::bounds() const {
    return {{std::max(limits_.min_v, -config_.max_linear_m_s),
             std::max(limits_.min_w, -config_.max_angular_rad_s)},
            {std::min(limits_.max_v, config_.max_linear_m_s),
             std::min(limits_.max_w, config_.max_angular_rad_s)}};
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
    if (pad_a_held_ && !(unknown_allowed() && judged_index() < 0) &&
        now.true_us - pad_a_us_ > milliseconds(config_.fresh_ms) + tolerance_us(now))
        violate(now.true_us - iocard_.made_us > milliseconds(config_.fresh_ms)
                    ? Promise::fresh_by_age
                : rule_.index() == robot_.pad_a && report_.override_index == robot_.pad_a
                    ? Promise::override_disarms
                    : Promise::override_by_texts,
                now.true_us,
                "a speed left " + ms_text(now.true_us - pad_a_us_) + " after [A] was pressed");
    lease_.sent = true;
    speed_out_ = true;
    last_speed_us_ = now.true_us;
    if (now.true_us - envelope_us_ > 10000000) {
        ours_before_ = ours_;
        ours_ = Envelope();
        envelope_us_ = now.true_us;
    }
    ours_.include(speeds);
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
    const bool keeps = (config_.options & ROBUROC4_OPTION_TURN_KEEPING) != 0 &&
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
        violate(Promise::turn_keeping, now.true_us,
                "the speed " + speeds_text(speeds) + " left where " + speeds_text(asked) +
                    " was asked for, which is another curve");
}

void Oracle::judge_fresh(Moment now, const char *what) {
    const std::uint64_t limit = milliseconds(config_.fresh_ms) + tolerance_us(now);
    const Newest *const statuses[] = {&differential_, &iocard_};
    for (const Newest *status : statuses) {
        const char *const name = status == &iocard_ ? "IO card" : "differential";
        if (status == &iocard_ && unknown_allowed() &&
            (robot_.iocard_id == 0 || judged_index() < 0))
            continue;
        if (!status->known)
            violate(Promise::fresh_by_age, now.true_us,
                    std::string(what) + " without any " + name + " status");
        else if (now.true_us - status->made_us > limit)
            violate(Promise::fresh_by_age, now.true_us,
                    std::string(what) + " on a " + name + " status that is truly " +
                        ms_text(now.true_us - status->made_us) + " old (fresh_ms " +
                        std::to_string(config_.fresh_ms) + ")");
    }
}

/* --------------------------------------------------------------------------- what it receives */

void Oracle::received(Moment now, const Datagram &datagram, std::int32_t result) {
    observe(now);
    const Origin &origin = datagram.origin;
    if (result != ROBUROC4_ERR_UNSUBSCRIBED && is_command(datagram))
        watch_reboot(now, datagram);
    if (result < 0 && result != ROBUROC4_ERR_ROBOT)
        return;
    switch (origin.kind) {
    case Origin::Kind::iocard_properties:
        analog_inputs_ = static_cast<std::int32_t>(datagram.u32_at(5));
        rule_.set_counts(analog_inputs_, static_cast<std::int32_t>(datagram.u32_at(9)),
                         static_cast<std::int32_t>(datagram.u32_at(13)),
                         static_cast<std::int32_t>(datagram.u32_at(17)));
        break;
    case Origin::Kind::differential_properties:
        if (datagram.size < 57)
            break;
        limits_ = {true,
                   datagram.f32_at(21),
                   datagram.f32_at(25),
                   datagram.f32_at(29),
                   datagram.f32_at(33),
                   datagram.f32_at(53)};
        break;
    case Origin::Kind::input_text:
        rule_.text_read(origin.index, std::string(datagram.bytes.begin() + 5,
                                                  datagram.bytes.begin() +
                                                      static_cast<std::ptrdiff_t>(datagram.size)));
        break;
    case Origin::Kind::input_refusal:
        rule_.text_refused(origin.index);
        break;
    case Origin::Kind::differential_status:
        differential_status(now, datagram);
        break;
    case Origin::Kind::iocard_status:
        iocard_status(now, datagram);
        break;
    default:
        break;
    }
}

void Oracle::differential_status(Moment now, const Datagram &datagram) {
    const std::uint64_t made = datagram.origin.made_us;
    const Speeds target = {datagram.f32_at(11), datagram.f32_at(19)};
    const Speeds current = {datagram.f32_at(15), datagram.f32_at(23)};
    if (stop_.active && zero_by_rounding(target)) {
        if (stop_.zeros > 0 && made + tolerance_us(now) >= stop_.first_zero_us)
            stop_.confirmed = true;
        else
            stop_.confirmed_old = true;
        if (stop_.zeros_since_known >= 3 && made > stop_.third_zero_us + sure_after_us &&
            stop_.sure_us == 0)
            stop_.sure_us = now.true_us;
    }
    if (differential_.known && made <= differential_.made_us)
        return;
    differential_ = {true, made};
    reported_target_ = target;
    reported_current_ = current;
    watch_other_commander(now, datagram);
    watch_inhibited(now, datagram);
}

void Oracle::watch_other_commander(Moment now, const Datagram &datagram) {
    Envelope recent = ours_; /* each axis by itself */
    recent.include({ours_before_.low_v, ours_before_.low_w});
    recent.include({ours_before_.high_v, ours_before_.high_w});
    const bool others = datagram.origin.others_target && !zero_by_rounding(reported_target_) &&
                        !recent.contains(reported_target_);
    others_ = others ? others_ + 1 : 0;
    if (others_ >= 3 && (config_.options & ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER) == 0)
        disarm(now, Promise::other_commander_disarms);
}

void Oracle::watch_inhibited(Moment now, const Datagram &datagram) {
    const bool asked =
        std::fabs(reported_target_.v) >= 0.1F || std::fabs(reported_target_.w) >= 0.1F;
    const bool stands =
        std::fabs(reported_current_.v) < 0.01F && std::fabs(reported_current_.w) < 0.01F;
    const bool still =
        motors_dead_ && asked && stands && !datagram.origin.others_target && !pad_a_held_ && armed_;
    if (still && !still_)
        still_since_us_ = datagram.origin.made_us;
    still_ = still;
    if (still && datagram.origin.made_us - still_since_us_ >= inhibited_us)
        disarm(now, Promise::inhibited_disarms);
}

void Oracle::iocard_status(Moment now, const Datagram &datagram) {
    if (iocard_.known && datagram.origin.made_us <= iocard_.made_us)
        return;
    iocard_ = {true, datagram.origin.made_us};
    const int index = judged_index();
    overridden_ = false;
    if (index < 0)
        return;
    const std::size_t first = 11 + 4 * static_cast<std::size_t>(analog_inputs_);
    const std::uint8_t block = datagram.u8_at(first + static_cast<std::size_t>(index / 8));
    overridden_ = (block >> (index % 8) & 1) != 0;
    if (overridden_)
        disarm(now, report_.override_index == index ? Promise::override_disarms
                                                    : Promise::override_by_texts);
}

void Oracle::watch_reboot(Moment now, const Datagram &datagram) {
    const std::uint64_t stamp = datagram.u64_at(3);
    if (datagram.origin.boot == boot_) {
        highest_stamp_ = std::max(highest_stamp_, stamp);
        restarted_statuses_ = 0;
        return;
    }
    if (datagram.origin.boot < boot_)
        return;
    if (!armed_ || stamp >= highest_stamp_) { /* nothing to notice */
        boot_ = datagram.origin.boot;
        highest_stamp_ = stamp;
        restarted_statuses_ = 0;
        return;
    }
    restarted_statuses_ = stamp + 101 < highest_stamp_ ? restarted_statuses_ + 1 : 0;
    if (restarted_statuses_ >= 3)
        disarm(now, Promise::reboot_disarms);
}

/* ---------------------------------------------------------------------------- what it reports */

void Oracle::reported(Moment now, const Report &report, bool drained, std::uint64_t next_deadline) {
    report_ = report;
    if (report.armed && !armed_)
        violate(disarm_promise_, now.true_us, "the client reports that it is armed");
    if (!report.armed && armed_)
        disarm(now, Promise::nothing_arms_itself);
    judge_override_report(now, report);
    if (!drained)
        return;
    if (report.state == ROBUROC4_STATE_IDLE)
        started_ = false;
    if (lease_.alive && !report.driving)
        end_driving(now, Promise::speed_needs_lease);
    if (report.driving && !lease_.alive)
        violate(lease_.end_promise, now.true_us, "the client reports a living lease");
    judge_stop_in_time(now, report);
    judge_feeding(now);
    if (next_deadline <= now.client_us)
        violate(Promise::deadlines, now.true_us, "everything was sent, and the deadline is past");
}

void Oracle::judge_override_report(Moment now, const Report &report) {
    if (!report.override_known || robot_.literal_ids)
        return;
    const int index = rule_.index();
    if (index < 0)
        violate(Promise::override_by_texts, now.true_us,
                "the override counts as known (input " + std::to_string(report.override_index) +
                    ") although the robot's texts do not tell it yet");
    else if (index != report.override_index)
        violate(Promise::override_by_texts, now.true_us,
                "input " + std::to_string(report.override_index) + " is taken for [A], which is " +
                    std::to_string(index));
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
    if (stop_.zeros == 0 && speed_out_) { /* a zero within the lease may delay it */
        if (!last_command_zero_ || now.true_us - last_command_us_ > spacing_us + slack_us)
            violate(Promise::zeros_first, now.true_us, "driving has ended, and no zero has left");
        return;
    }
    if (!report.stopping) {
        if (speed_out_ || report.differential_known)
            end_stop(now, Promise::zeros_repeated);
        stop_.active = false;
        return;
    }
    if (!report.differential_known &&
        (!speed_out_ || stop_may_end(now))) { /* stop() is latched until the service is known */
        stop_.again_us = stop_.last_zero_us = now.true_us;
        return;
    }
    if (stop_.zeros == 0)
        return;
    if (now.true_us - stop_.last_zero_us > period + slack_us && !clock_changed_)
        violate(Promise::zeros_repeated, now.true_us,
                "the last zero left " + ms_text(now.true_us - stop_.last_zero_us) + " ago");
    const std::uint64_t watchdog = milliseconds(config_.robot_watchdog_ms);
    const std::uint64_t longest = std::max(watchdog, 3 * period) + 3 * period;
    if (now.true_us - std::max(stop_.first_zero_us, stop_.again_us) > longest)
        violate(Promise::stop_ends, now.true_us,
                "the stop sequence lasts " + ms_text(now.true_us - stop_.due_us));
    /* where all answers have one id, or take long, ages are known late */
    const bool calm = !robot_.literal_ids && !robot_.slow_texts && calm_us_ < now.true_us &&
                      now.true_us - calm_us_ > 5000000;
    if (calm && stop_.sure_us != 0 && now.true_us - stop_.sure_us > period + slack_us)
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
