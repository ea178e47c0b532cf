/* SPDX-License-Identifier: MIT */
#include "world.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace soak {

namespace {

RobotTruth truth_of(const RobotPlan &plan, const roburoc4_config &config) {
    RobotTruth truth;
    truth.differential_id = plan.short_properties ? std::uint16_t{0} : plan.ids[4];
    truth.iocard_id = plan.ids[0];
    truth.pad_a = plan.pad_a;
    truth.only_texts_tell = !plan.type_codes;
    truth.literal_ids = plan.literal_ids;
    truth.slow_texts = plan.text_us > 100000;
    truth.rounds = plan.rounding > 0;
    truth.own_queues = plan.own_queues;
    truth.drifts = std::fabs(plan.clock_ppm) > 300;
    truth.prompt = plan.prompt(config.fresh_ms);
    return truth;
}

} // namespace

World::World(const RobotPlan &plan, const roburoc4_config &config, Client &client,
             const Promises &excluded, std::uint64_t seed)
    : client_(client), config_(config), robot_(plan, 1000000000),
      oracle_(config, truth_of(plan, config), excluded), to_robot_(seed * 2 + 1),
      to_client_(seed * 2 + 2), offset_us_(seed % 7 * 123456789) {
    client_.init(config);
}

void World::say(const char *format, ...) const {
    if (!trace_)
        return;
    std::printf("%12.6f  ", static_cast<double>(now_us_ - 1000000000) * 1e-6);
    va_list arguments;
    va_start(arguments, format);
    std::vprintf(format, arguments);
    va_end(arguments);
    std::printf("\n");
}

void World::say_datagram(const char *what, const Datagram &datagram, std::int32_t result) const {
    if (!trace_)
        return;
    const bool status = is_status(datagram);
    if (datagram.origin.kind == Origin::Kind::differential_status)
        say("%s differential status made %.6f: target (%g, %g), speed (%g, %g): %d", what,
            static_cast<double>(datagram.origin.made_us - 1000000000) * 1e-6,
            static_cast<double>(datagram.f32_at(11)), static_cast<double>(datagram.f32_at(19)),
            static_cast<double>(datagram.f32_at(15)), static_cast<double>(datagram.f32_at(23)),
            result);
    else if (status)
        say("%s status of service %u made %.6f, cycle %llu: %d", what, datagram.u16_at(1),
            static_cast<double>(datagram.origin.made_us - 1000000000) * 1e-6,
            static_cast<unsigned long long>(datagram.u64_at(3)), result);
    else if (is_command(datagram))
        say("%s command to service %u: (%g, %g)", what, datagram.u16_at(1),
            static_cast<double>(datagram.f32_at(3)), static_cast<double>(datagram.f32_at(7)));
    else if (datagram.origin.kind == Origin::Kind::input_text ||
             datagram.origin.kind == Origin::Kind::input_refusal)
        say("%s id %u, text %d%s, %zu bytes: %d", what, datagram.bytes[0], datagram.origin.index,
            datagram.origin.kind == Origin::Kind::input_text ? "" : " refused", datagram.size,
            result);
    else
        say("%s id %u action %u service %u, %zu bytes: %d", what, datagram.bytes[0],
            datagram.bytes[1], datagram.u16_at(2), datagram.size, result);
}

/* ------------------------------------------------------------------------------------- time */

std::uint64_t World::deadline_true() const {
    if (deadline_us_ == UINT64_MAX)
        return UINT64_MAX;
    return deadline_us_ <= client_now() ? now_us_ : deadline_us_ - offset_us_;
}

void World::run_robot() {
    while (to_robot_.next_arrival() <= now_us_) {
        const bool stood = robot_.clients_target().zero();
        robot_.receive(to_robot_.take(), now_us_, false);
        if (stood && !robot_.clients_target().zero() && !report_.driving)
            oracle_.reach(Reached::revived_speed);
    }
    if (robot_.next_time() > now_us_)
        return;
    from_robot_.clear();
    robot_.run(now_us_, from_robot_);
    for (const Datagram &datagram : from_robot_)
        to_client_.send(datagram, now_us_);
}

void World::run_until(std::uint64_t end_us) {
    while (!oracle_.over()) {
        const std::uint64_t arrival = to_client_.next_arrival();
        const std::uint64_t deadline = deadline_true();
        const std::uint64_t next = std::min(std::min(robot_.next_time(), to_robot_.next_arrival()),
                                            std::min(arrival, deadline));
        if (next >= end_us)
            break;
        now_us_ = std::max(now_us_, next);
        if (arrival <= now_us_) {
            deliver_to_client();
            send_due();
        } else if (deadline <= now_us_) {
            send_due();
        }
        run_robot();
    }
    now_us_ = std::max(now_us_, end_us);
}

void World::freeze(std::uint64_t us) {
    oracle_.disturbed(now_us_);
    say("the client's machine freezes for %.3f s", static_cast<double>(us) * 1e-6);
    const std::uint64_t end_us = now_us_ + us;
    for (;;) {
        const std::uint64_t next = std::min(robot_.next_time(), to_robot_.next_arrival());
        if (next >= end_us)
            break;
        now_us_ = std::max(now_us_, next);
        run_robot();
    }
    now_us_ = end_us;
    oracle_.disturbed(now_us_);
}

void World::step_clock(std::int64_t us) {
    say("the client's clock jumps by %.6f s", static_cast<double>(us) * 1e-6);
    if (us < 0 && client_now() < static_cast<std::uint64_t>(-us))
        return;
    offset_us_ += static_cast<std::uint64_t>(us);
}

void World::deliver_to_client() {
    while (to_client_.next_arrival() <= now_us_) {
        const Datagram datagram = to_client_.take();
        const std::int32_t result = client_.receive(datagram, client_now());
        say_datagram("received", datagram, result);
        oracle_.received(moment(), datagram, result);
    }
}

void World::send_due() {
    poll();
    for (int again = 0; again < 3 && client_.next_deadline() <= client_now(); again++)
        poll();
    report_all();
}

void World::poll() {
    for (int guard = 0;; guard++) {
        Datagram datagram;
        const std::int32_t length = client_.poll_transmit(datagram, client_now());
        if (length <= 0)
            break;
        if (guard > 1000) {
            oracle_.violate(Promise::deadlines, now_us_, "it sends without end");
            break;
        }
        datagram.origin.made_us = now_us_;
        say_datagram("sent", datagram, length);
        oracle_.sent(moment(), datagram);
        to_robot_.send(datagram, now_us_);
    }
}

void World::report_all() {
    deadline_us_ = client_.next_deadline();
    const Report report = client_.report(client_now());
    events_ |= report.events;
    if (trace_ && (report.state != report_.state || report.armed != report_.armed ||
                   report.driving != report_.driving || report.stopping != report_.stopping))
        say("reports %s%s%s%s", roburoc4_name(ROBUROC4_NAME_STATE, report.state),
            report.armed ? ", armed" : "", report.driving ? ", driving" : "",
            report.stopping ? ", stopping" : "");
    report_ = report;
    if (trace_ && (report.events & ROBUROC4_EVENT_STOP_CONFIRMED) != 0)
        say("reports STOP_CONFIRMED");
    if (trace_ && (report.events & ROBUROC4_EVENT_STOP_UNCONFIRMED) != 0)
        say("reports STOP_UNCONFIRMED, outcome %u", report.stop_outcome);
    if (trace_ && (report.events & ROBUROC4_EVENT_DISARMED) != 0)
        say("reports DISARMED: %s", roburoc4_result_text(report.disarm_cause));
    oracle_.reported(moment(), report, truth(), true, deadline_us_);
}

Truth World::truth() const {
    const auto good = [](const Weather &weather) {
        return weather.delay_us <= 1000 && weather.jitter_us == 0 && weather.loss == 0 &&
               weather.duplicates == 0 && weather.reordering == 0 && weather.burst == 0 &&
               weather.growth == 0 && !weather.dark;
    };
    const Weather &up = to_robot_.weather();
    Truth truth;
    truth.clients_target = robot_.clients_target();
    truth.moving = robot_.trouble().frozen ? Speeds() : robot_.moving(); /* as can be known */
    truth.newest_heard_us = robot_.newest_heard_us();
    truth.well = good(up) && good(to_client_.weather()) && !robot_.trouble().any() &&
                 !robot_.pad_a_held() && robot_.running(now_us_) && now_us_ >= others_until_us_;
    /* commands may be lost, and requests between them arrive */
    truth.oldest_speed_us = to_robot_.oldest_speed_us();
    truth.uplink_loses = (up.loss > 0.05 || up.burst > 0 || up.reordering > 0) && !up.dark;
    return truth;
}

std::uint32_t World::take_events() {
    const std::uint32_t events = events_;
    events_ = 0;
    return events;
}

/* ----------------------------------------------------------------------- the application's calls
 */

/* An application may call at any time, also before the client has received what has arrived. */
std::int32_t World::called(const char *call, std::int32_t result) {
    const Report report = client_.report(client_now());
    say("%s: %d %s (ages %u, %u us)", call, result, result < 0 ? roburoc4_result_text(result) : "",
        report.age_us[iocard], report.age_us[differential]);
    events_ |= report.events;
    oracle_.reported(moment(), report, truth(), false, UINT64_MAX);
    send_due();
    return result;
}

std::int32_t World::init_again(const roburoc4_config &config) {
    return called("init", client_.init(config));
}

std::int32_t World::start() {
    const std::int32_t result = client_.start(client_now());
    if (result >= 0)
        oracle_.started(moment());
    return called("start", result);
}

std::int32_t World::close() {
    const std::int32_t result = client_.close(client_now());
    oracle_.closed(moment());
    return called("close", result);
}

std::int32_t World::arm() {
    const std::int32_t result = client_.arm(client_now());
    oracle_.armed(moment(), result);
    return called("arm", result);
}

std::int32_t World::drive(Speeds speeds, std::uint32_t lease_us) {
    say("drive(%g, %g) for %u us", static_cast<double>(speeds.v), static_cast<double>(speeds.w),
        lease_us);
    const std::int32_t result = client_.drive(speeds, lease_us, client_now());
    oracle_.drove(moment(), speeds, lease_us, result);
    return called("drive", result);
}

std::int32_t World::stop() {
    const std::int32_t result = client_.stop(client_now());
    oracle_.stopped(moment(), result);
    return called("stop", result);
}

std::int32_t World::pause() {
    const std::int32_t result = client_.pause(client_now());
    oracle_.paused(moment(), result);
    return called("pause", result);
}

std::int32_t World::set_override_index(std::int32_t index) {
    const std::int32_t result = client_.set_override_index(index, client_now());
    oracle_.override_index_set(moment(), index, result);
    return called("set_role_index", result);
}

std::int32_t World::set_outputs(std::uint64_t mask, std::uint64_t values) {
    const std::int32_t result = client_.set_outputs(mask, values, client_now());
    oracle_.outputs_set(moment());
    return called("set_digital_outputs", result);
}

std::int32_t World::relocalize() {
    const std::int32_t result = client_.relocalize(client_now());
    oracle_.pose_set(moment(), result);
    return called("relocalize", result);
}

std::int32_t World::subscribe(std::uint32_t service, std::uint32_t period_ms) {
    return called("subscribe", client_.subscribe(service, period_ms, client_now()));
}

/* ---------------------------------------------------------------- what happens to robot and
 * network */

void World::set_weather(const Weather &to_robot, const Weather &to_client) {
    say("the network changes: to the client %s delay %.3f s, loss %.2f, growth %.3f up to %.3f s",
        to_client.dark ? "dark," : "", static_cast<double>(to_client.delay_us) * 1e-6,
        to_client.loss, to_client.growth, static_cast<double>(to_client.queue_us) * 1e-6);
    to_robot_.set_weather(to_robot, now_us_);
    to_client_.set_weather(to_client, now_us_);
}

void World::hold_pad_a(bool held, Speeds speeds) {
    say("[A] is %s", held ? "pressed" : "released");
    const bool released = robot_.pad_a_held() && !held;
    robot_.hold_pad_a(held, speeds);
    if (released && !robot_.clients_target().zero() && !report_.driving)
        oracle_.reach(Reached::resumed_target);
    oracle_.pad_a_changed(held, now_us_);
}

void World::cut_motors(bool dead) {
    say("the motors are %s", dead ? "dead" : "alive");
    robot_.cut_motors(dead);
}

void World::set_trouble(const Trouble &trouble) {
    say("trouble: motors %d, blocked %d %d, creep (%g, %g), nan %d, frozen %d", trouble.motors_dead,
        trouble.blocked_v, trouble.blocked_w, static_cast<double>(trouble.creep.v),
        static_cast<double>(trouble.creep.w), trouble.nan, trouble.frozen);
    robot_.set_trouble(trouble);
}

void World::reboot(const RobotPlan &plan, std::uint64_t off_us) {
    say("the robot restarts, off for %.3f s:%s", static_cast<double>(off_us) * 1e-6,
        plan.text().c_str());
    robot_.reboot(plan, off_us, now_us_);
    oracle_.robot_changed(truth_of(plan, config_));
    oracle_.pad_a_changed(false, now_us_);
}

void World::other_commander(Speeds speeds) {
    say("another commander: (%g, %g)", static_cast<double>(speeds.v),
        static_cast<double>(speeds.w));
    Datagram command;
    command.u8(header_status);
    command.u16(robot_.differential_id());
    command.f32(speeds.v);
    command.f32(speeds.w);
    others_until_us_ = now_us_ + 100000;
    robot_.receive(command, now_us_, true);
}

void World::calm() {
    say("from now on all is well");
    set_weather(Weather(), Weather());
    hold_pad_a(false);
    set_trouble(Trouble());
    oracle_.calm_from(now_us_);
}

} // namespace soak
