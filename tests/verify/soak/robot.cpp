/* SPDX-License-Identifier: MIT */
#include "robot.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace soak {

namespace {

const char *const service_names[5] = {"IOCard", "Telemeter", "Battery", "Localization",
                                      "Differential"};
constexpr std::uint16_t service_types[5] = {0x4001, 0x4008, 0x0000, 0x8002, 0x4005};
constexpr float nan_speed = std::numeric_limits<float>::quiet_NaN();

float clamp(float value, float low, float high) {
    return std::min(std::max(value, low), high);
}

std::string button_text(const std::string &name, int wording) {
    switch (wording) {
    case 0:
        return "Game pad \"" + name + "\" button";
    case 1:
        return "Gamepad " + name;
    case 2:
        return "Joystick button " + name;
    case 3:
        return name + " BUTTON (game-pad)";
    case 4:
        return "Button " + name + ", game pad";
    default:
        return "Game pad \xAB" + name + "\xBB button";
    }
}

void draw_card(Random &random, RobotPlan &plan) {
    const int wording = static_cast<int>(random.between(0, 5));
    if (random.chance(0.3)) {
        plan.digital_inputs = 23;
        plan.pad_a = 9;
    }
    if (random.chance(0.05)) { /* more than a client stores */
        plan.digital_inputs = random.chance(0.5) ? 40 : 150;
        plan.pad_a = static_cast<std::int32_t>(random.between(2, 39));
    }
    if (random.chance(0.05))
        plan.analog_inputs = static_cast<std::int32_t>(random.between(0, 30));
    const auto count = static_cast<std::size_t>(plan.digital_inputs);
    if (random.chance(0.3))
        plan.pad_a = static_cast<std::int32_t>(random.between(2, count - 1));
    plan.give_texts(pad_texts(plan.digital_inputs, plan.pad_a, wording));
    const auto a = static_cast<std::size_t>(plan.pad_a);
    const std::size_t other = a < 5 ? count - 1 : 3;
    switch (random.between(0, 19)) {
    case 0: /* no texts at all: then the manual's table counts, so [A] is where it says */
        plan.refused_texts.assign(count, true);
        plan.pad_a = plan.digital_inputs == 23 ? 9 : 8;
        break;
    case 1:
        plan.refused_texts[a] = true;
        break;
    case 2:
        plan.unanswered_texts[a] = true;
        break;
    case 3: /* two inputs are called [A] */
        plan.input_texts[other] = button_text("A", 1);
        break;
    case 4: /* no input is called [A] */
        plan.input_texts[a] = random.chance(0.5) ? "spare" : "";
        break;
    case 5: /* an input resembles [A] */
        plan.input_texts[other] = random.chance(0.5) ? "Game pad A LED" : "Game pad battery A";
        break;
    case 6: /* and [A]'s own text is refused, or says nothing */
        plan.input_texts[other] = random.chance(0.5) ? "Game pad A LED" : "Game pad battery A";
        if (random.chance(0.5))
            plan.refused_texts[a] = true;
        else
            plan.input_texts[a] = "Override";
        break;
    case 7: /* two texts for one bumper */
        plan.input_texts[other] = "Front bumper";
        break;
    default:
        break;
    }
}

void draw_limits(Random &random, RobotPlan &plan) {
    const float infinity = std::numeric_limits<float>::infinity();
    switch (random.between(0, 20)) {
    case 0:
        plan.max_v = nan_speed;
        break;
    case 1:
        plan.min_w = -infinity;
        break;
    case 2:
        plan.min_v = 0.5F;
        break;
    case 3:
        plan.max_w = -1.0F;
        break;
    case 4:
        plan.max_v = plan.min_v = plan.max_w = plan.min_w = 0;
        break;
    case 5:
    case 6:
        plan.max_v = 0.8F;
        plan.min_v = -0.2F;
        plan.max_w = 1.5F;
        plan.min_w = -3.0F;
        break;
    default:
        break;
    }
}

void draw_services(Random &random, RobotPlan &plan) {
    plan.type_codes = random.chance(0.5);
    plan.service_texts = plan.type_codes ? random.chance(0.8) : true;
    if (random.chance(0.3)) { /* other ids; then the battery can be known by its text only */
        plan.service_texts = true;
        auto next = static_cast<std::uint16_t>(random.between(2, 300));
        for (std::uint16_t &id : plan.ids)
            id = next++;
        for (std::size_t i = 5; i > 1; i--)
            std::swap(plan.ids[i - 1], plan.ids[random.between(0, i - 1)]);
    } else if (random.chance(0.1)) {
        plan.service_texts = plan.type_codes = false; /* only the manual's ids tell */
    }
    if (random.chance(0.2))
        plan.strangers = static_cast<std::uint16_t>(random.between(1, 3));
    if (random.chance(0.03))
        plan.ids[random.between(0, 4)] = 0;
    plan.literal_ids = random.chance(0.08);
    plan.only_literal = plan.literal_ids && random.chance(0.3);
    if (plan.literal_ids) /* such a robot's texts decide nothing, so its ids must */
        plan.type_codes = plan.type_codes || plan.ids[iocard] != 2 || plan.ids[differential] != 6;
    plan.error_shape = random.chance(0.3) ? static_cast<std::uint8_t>(random.between(1, 2)) : 0;
    plan.error_code = random.chance(0.1) ? static_cast<std::uint8_t>(random.between(1, 255)) : 0;
    plan.surplus = random.chance(0.2) ? static_cast<std::uint8_t>(random.between(1, 8)) : 0;
    plan.replace_mode = static_cast<std::uint8_t>(random.chance(0.2) ? random.between(1, 2) : 0);
    plan.telemeters = static_cast<std::int32_t>(random.chance(0.3) ? random.between(0, 6) : 2);
    plan.reported_distances = plan.telemeters;
    if (random.chance(0.1))
        plan.reported_distances = static_cast<std::int32_t>(random.between(0, 6));
    if (random.chance(0.05)) {
        plan.refuses_subscriptions = static_cast<std::uint8_t>(random.between(1, 31));
        plan.ignores_refused = random.chance(0.5);
    }
    plan.keeps_subscriptions = random.chance(0.3);
    if (random.chance(0.1))
        plan.min_period = static_cast<std::uint8_t>(random.between(1, 20));
}

void draw_answers_to_commands(Random &random, RobotPlan &plan) {
    if (random.chance(0.5)) /* 0.3 to 60 s */
        plan.watchdog_us = 10000 * static_cast<std::uint64_t>(30 * std::pow(200, random.unit()));
    plan.tripped_target_shown = random.chance(0.2);
    plan.pad_keeps_target = static_cast<std::uint8_t>(random.between(0, 2));
    plan.ignored_commands_feed = random.chance(0.5);
    plan.pad_target_hidden = random.chance(0.3);
    plan.commands_need_motors = random.chance(0.2);
    plan.over_limit_refused = random.chance(0.2);
    plan.start_safe = random.chance(0.05);
}

Response draw_response(Random &random) {
    Response response;
    response.omega = random.chance(0.1) ? 1000 : 1.5 * std::pow(66, random.unit());
    response.damping = random.uniform(0.6, 1.5);
    response.gain = random.uniform(0.85, 1.15);
    return response;
}

void draw_motion(Random &random, RobotPlan &plan) {
    if (random.chance(0.7)) {
        plan.linear = draw_response(random);
        plan.angular = draw_response(random);
    }
    if (random.chance(0.3))
        plan.dead_time_cycles = random.between(1, 15);
    plan.late_targets = random.chance(0.3);
    if (random.chance(0.3))
        plan.noise = static_cast<float>(random.uniform(0, 0.02));
    if (random.chance(0.3))
        plan.rounding = random.chance(0.5) ? 1e-9F : 1e-7F;
    if (random.chance(0.3))
        plan.odometry_cycles = random.between(2, 20);
    plan.stamp_measured = random.chance(0.2);
    plan.width = random.chance(0.1) ? 0 : 0.68F;
}

} // namespace

std::vector<std::string> pad_texts(std::int32_t count, std::int32_t pad_a, int wording) {
    static const char *const others[] = {"B",        "X",      "Y",       "Back", "Start",
                                         "D down",   "D left", "D right", "D up", "LJ click",
                                         "RJ click", "LB",     "RB"};
    std::vector<std::string> texts;
    std::size_t other = 0;
    for (std::int32_t i = 0; i < count; i++) {
        if (i == pad_a)
            texts.push_back(button_text("A", wording));
        else if (i == 0)
            texts.emplace_back("Front bumper");
        else if (i == 1)
            texts.emplace_back("Rear bumper");
        else if (i >= 8 && other < std::size(others))
            texts.push_back(button_text(others[other++], wording));
        else
            texts.emplace_back("-- exists but not used --");
    }
    return texts;
}

void RobotPlan::give_texts(const std::vector<std::string> &texts) {
    input_texts = texts;
    digital_inputs = static_cast<std::int32_t>(texts.size());
    refused_texts.assign(texts.size(), false);
    unanswered_texts.assign(texts.size(), false);
}

bool RobotPlan::drivable() const {
    for (const float value : {max_v, min_v, max_w, min_w})
        if (!std::isfinite(value))
            return false;
    return ids[differential] != 0 && ids[iocard] != 0 && !short_properties && max_v >= 0 &&
           min_v <= 0 && max_w >= 0 && min_w <= 0 && (refuses_subscriptions & 0x11) == 0;
}

std::string RobotPlan::text() const {
    const RobotPlan usual;
    std::string text;
    const auto say = [&text](const char *name, double value, double default_value) {
        if (value != default_value)
            text += std::string(" ") + name + " " + std::to_string(value).substr(0, 8);
    };
    for (int i = 0; i < 5; i++)
        say(service_names[i], ids[i], usual.ids[i]);
    say("type_codes", type_codes, 0);
    say("service_texts", service_texts, 1);
    say("literal_ids", literal_ids, 0);
    say("only_literal", only_literal, 0);
    say("error_shape", error_shape, 0);
    say("error_code", error_code, 0);
    say("surplus", surplus, 0);
    say("replace_mode", replace_mode, 0);
    say("analog_inputs", analog_inputs, 9);
    say("digital_inputs", digital_inputs, 22);
    say("pad_a", pad_a, 8);
    say("texts_twice", texts_twice, 0);
    say("answer_us", static_cast<double>(answer_us), 0);
    say("text_us", static_cast<double>(text_us), static_cast<double>(answer_us));
    say("refuses_subscriptions", refuses_subscriptions, 0);
    say("min_period", min_period, 1);
    say("own_queues", own_queues, 0);
    say("watchdog_s", static_cast<double>(watchdog_us) * 1e-6, 1);
    say("tripped_target_shown", tripped_target_shown, 0);
    say("pad_keeps_target", pad_keeps_target, 0);
    say("ignored_commands_feed", ignored_commands_feed, 0);
    say("pad_target_hidden", pad_target_hidden, 0);
    say("commands_need_motors", commands_need_motors, 0);
    say("over_limit_refused", over_limit_refused, 0);
    say("start_safe", start_safe, 0);
    const std::pair<const char *, const Response *> axes[] = {{"v", &linear}, {"w", &angular}};
    for (const auto &axis : axes)
        text += std::string(" ") + axis.first + ": omega " + std::to_string(axis.second->omega) +
                " damping " + std::to_string(axis.second->damping) + " gain " +
                std::to_string(axis.second->gain);
    say("dead_time_cycles", static_cast<double>(dead_time_cycles), 0);
    say("late_targets", late_targets, 0);
    say("noise", static_cast<double>(noise), 0);
    say("odometry_cycles", static_cast<double>(odometry_cycles), 1);
    say("stamp_measured", stamp_measured, 0);
    say("clock_ppm", clock_ppm, 0);
    say("first_cycle", static_cast<double>(first_cycle), 0);
    return text;
}

RobotPlan draw_robot(Random &random) {
    RobotPlan plan;
    draw_services(random, plan);
    draw_card(random, plan);
    draw_limits(random, plan);
    draw_answers_to_commands(random, plan);
    draw_motion(random, plan);
    plan.short_properties = random.chance(0.03);
    plan.texts_twice = random.chance(0.2);
    plan.answer_us = random.between(100, 10000);
    plan.text_us = plan.answer_us;
    if (random.chance(0.2))
        plan.text_us = random.between(10000, random.chance(0.2) ? 3000000 : 400000);
    plan.own_queues = random.chance(0.5);
    plan.clock_ppm = random.uniform(-500, 500);
    plan.first_cycle = random.chance(0.5) ? 0 : random.between(0, 100000000);
    return plan;
}

/* ----------------------------------------------------------------------------------- its life */

Robot::Robot(RobotPlan plan, std::uint64_t now_us)
    : plan_(std::move(plan)), random_(now_us), started_us_(now_us) {
    trouble_.motors_dead = plan_.start_safe;
    plan_next_tick();
}

Origin Robot::origin(Origin::Kind kind, std::int32_t index) const {
    Origin origin;
    origin.kind = kind;
    origin.index = index;
    origin.boot = boot_;
    origin.made_us = now_us_;
    return origin;
}

void Robot::hold_pad_a(bool held, Speeds speeds) {
    if (held && plan_.pad_keeps_target == 0)
        accepted_ = {};
    pad_a_held_ = held;
    pad_speeds_ = speeds;
}

void Robot::reboot(const RobotPlan &plan, std::uint64_t off_us, std::uint64_t now_us) {
    const bool keeps = plan_.keeps_subscriptions && plan.ids[iocard] == plan_.ids[iocard];
    plan_ = plan;
    boot_++;
    started_us_ = now_us + off_us;
    ticks_ = measured_tick_ = 0;
    answers_.clear();
    accepted_ = goal_ = measured_ = {};
    tripped_ = true;
    dead_time_.clear();
    v_ = w_ = Axis();
    pad_a_held_ = false;
    trouble_ = Trouble();
    trouble_.motors_dead = plan_.start_safe;
    for (Subscription &subscription : subscriptions_) {
        subscription.since = 0;
        if (!keeps)
            subscription.period = 0;
    }
    plan_next_tick();
}

Speeds Robot::clients_target() const {
    return pad_a_held_ || tripped_ || others_ || trouble_.motors_dead ? Speeds() : accepted_;
}

void Robot::plan_next_tick() {
    const double us = static_cast<double>(ticks_ + 1) * 10000.0 * (1.0 - plan_.clock_ppm * 1e-6);
    next_tick_us_ = started_us_ + static_cast<std::uint64_t>(us);
}

std::uint64_t Robot::next_time() const {
    std::uint64_t next = next_tick_us_;
    for (const Answer &answer : answers_)
        next = std::min(next, answer.due_us);
    return next;
}

void Robot::run(std::uint64_t now_us, std::vector<Datagram> &out) {
    now_us_ = now_us;
    for (std::size_t i = 0; i < answers_.size();) {
        if (answers_[i].due_us > now_us) {
            i++;
            continue;
        }
        out.push_back(answers_[i].datagram);
        answers_.erase(answers_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    while (next_tick_us_ <= now_us)
        tick(next_tick_us_, out);
}

/* Second order, in steps that are short for any natural frequency. */
void Robot::Axis::follow(const Response &response, double target) {
    if (response.omega > 100) {
        speed = response.gain * target;
        return;
    }
    constexpr int steps = 20;
    constexpr double dt = 0.01 / steps;
    for (int i = 0; i < steps; i++) {
        slope += dt * response.omega *
                 (response.omega * (response.gain * target - speed) - 2 * response.damping * slope);
        speed += dt * slope;
    }
}

void Robot::move() {
    const Speeds target = pad_a_held_ ? pad_speeds_ : tripped_ ? Speeds() : accepted_;
    dead_time_.push_back(target);
    goal_ = dead_time_.front();
    if (dead_time_.size() > plan_.dead_time_cycles)
        dead_time_.pop_front();
    if (trouble_.motors_dead || trouble_.blocked_v)
        v_.brake();
    else
        v_.follow(plan_.linear, static_cast<double>(goal_.v));
    if (trouble_.motors_dead || trouble_.blocked_w)
        w_.brake();
    else
        w_.follow(plan_.angular, static_cast<double>(goal_.w));
}

void Robot::tick(std::uint64_t now_us, std::vector<Datagram> &out) {
    ticks_++;
    now_us_ = now_us;
    if (!tripped_ && now_us - fed_us_ >= plan_.watchdog_us) {
        tripped_ = true;
        if (!plan_.tripped_target_shown)
            accepted_ = {};
    }
    move();
    if (ticks_ % plan_.odometry_cycles == 0) {
        if (!trouble_.frozen)
            measured_ = moving();
        measured_tick_ = ticks_;
    }
    for (int service = 0; service < 5; service++) {
        const Subscription &subscription = subscriptions_[service];
        if (subscription.period != 0 && (ticks_ - subscription.since) % subscription.period == 0)
            out.push_back(status(service));
    }
    plan_next_tick();
}

float Robot::rounded(float value) const {
    return value + ((ticks_ & 1) != 0 ? plan_.rounding : -plan_.rounding);
}

Speeds Robot::shown_target() const {
    if (pad_a_held_ && !plan_.pad_target_hidden)
        return pad_speeds_;
    if (plan_.late_targets && !pad_a_held_)
        return goal_;
    return accepted_;
}

Datagram Robot::status(int service) {
    Datagram datagram;
    datagram.u8(header_status);
    datagram.u16(plan_.ids[service]);
    const bool measured = service == differential && plan_.stamp_measured;
    datagram.u64(plan_.first_cycle + (measured ? measured_tick_ : ticks_));
    datagram.origin = origin(Origin::Kind::status, service);
    datagram.origin.pad_a = pad_a_held_;
    switch (service) {
    case iocard: {
        datagram.origin.kind = Origin::Kind::iocard_status;
        for (std::int32_t i = 0; i < plan_.analog_inputs; i++)
            datagram.f32(i == 2 ? 25.0F : 0.5F);
        const std::size_t first = datagram.size;
        for (std::size_t i = 0; i < digital_blocks(plan_.digital_inputs); i++)
            datagram.u8(0);
        if (pad_a_held_) {
            std::uint8_t &block = datagram.bytes[first + static_cast<std::size_t>(plan_.pad_a / 8)];
            block = static_cast<std::uint8_t>(block | 1U << (plan_.pad_a % 8));
        }
        break;
    }
    case telemeter:
        for (std::int32_t i = 0; i < plan_.reported_distances; i++)
            datagram.f32(1.5F);
        break;
    case battery:
        datagram.u8(2);
        datagram.u8(80);
        break;
    case localization:
        datagram.f64(0);
        datagram.f64(0);
        datagram.f64(0);
        datagram.u32(2);
        break;
    default: {
        const auto noisy = [this](float value) {
            return rounded(value + static_cast<float>(random_.uniform(-1, 1)) * plan_.noise);
        };
        const Speeds target = shown_target();
        datagram.origin.kind = Origin::Kind::differential_status;
        datagram.origin.others_target = others_ && !pad_a_held_;
        datagram.origin.healthy = !trouble_.any() && !pad_a_held_ && !tripped_;
        datagram.f32(rounded(target.v));
        datagram.f32(trouble_.nan ? nan_speed : noisy(measured_.v));
        datagram.f32(rounded(target.w));
        datagram.f32(trouble_.nan ? nan_speed : noisy(measured_.w));
        break;
    }
    }
    for (int i = 0; i < plan_.surplus; i++)
        datagram.u8(0);
    return datagram;
}

int Robot::service_of(std::uint16_t id) const {
    for (int service = 0; service < 5; service++)
        if (plan_.ids[service] == id && id != 0)
            return service;
    return -1;
}

/* -------------------------------------------------------------------------- what it receives */

void Robot::receive(const Datagram &datagram, std::uint64_t now_us, bool from_other_commander) {
    if (!running(now_us) || datagram.size < 3)
        return;
    now_us_ = now_us;
    if (datagram.bytes[0] == header_status) {
        command(datagram, now_us, from_other_commander);
        return;
    }
    if (datagram.size < 4 || (plan_.only_literal && datagram.bytes[0] != header_literal))
        return;
    newest_heard_us_ = std::max(newest_heard_us_, datagram.origin.made_us);
    const std::uint64_t due = now_us + plan_.answer_us;
    switch (datagram.bytes[1]) {
    case action_get:
        get(datagram, due);
        break;
    case action_query:
        query(datagram, now_us);
        break;
    case action_insert:
    case action_delete:
        subscribe(datagram, datagram.bytes[1] == action_insert, due);
        break;
    case action_replace:
        if (plan_.replace_mode == 1) {
            refuse(datagram, 2, due);
        } else {
            Datagram done = begin_answer(datagram);
            done.origin.kind = Origin::Kind::replaced;
            answer(done, due);
        }
        break;
    default:
        refuse(datagram, 3, due);
        break;
    }
}

void Robot::command(const Datagram &datagram, std::uint64_t now_us, bool from_other_commander) {
    if (datagram.u16_at(1) != plan_.ids[differential] || datagram.size < 11)
        return;
    if (!from_other_commander)
        newest_heard_us_ = std::max(newest_heard_us_, datagram.origin.made_us);
    const Speeds asked = command_speeds(datagram);
    const bool beyond = std::fabs(asked.v) > 2.6F || std::fabs(asked.w) > 6.5F;
    if (plan_.over_limit_refused && beyond)
        return;
    if (plan_.commands_need_motors && trouble_.motors_dead) {
        accepted_ = {};
        return;
    }
    if (pad_a_held_ && plan_.ignored_commands_feed)
        fed_us_ = now_us;
    if (pad_a_held_ && plan_.pad_keeps_target != 1)
        return;
    if (!pad_a_held_ || plan_.ignored_commands_feed) {
        fed_us_ = now_us;
        tripped_ = false;
    }
    accepted_.v = clamp(asked.v, -2.6F, 2.6F);
    accepted_.w = clamp(asked.w, -6.5F, 6.5F);
    others_ = from_other_commander;
}

void Robot::answer(Datagram datagram, std::uint64_t due_us, bool text) {
    answers_.push_back({due_us, datagram});
    if (text && plan_.texts_twice)
        answers_.push_back({due_us + random_.between(0, 20000), datagram});
}

Datagram Robot::begin_answer(const Datagram &request) const {
    Datagram datagram;
    datagram.u8(plan_.literal_ids ? header_literal : request.bytes[0]);
    datagram.u8(request.bytes[1]);
    datagram.u16(request.u16_at(2));
    datagram.u8(0);
    datagram.origin = origin(Origin::Kind::other);
    datagram.origin.asked_us = request.origin.made_us;
    return datagram;
}

void Robot::refuse(const Datagram &request, std::uint8_t error, std::uint64_t due_us) {
    Datagram datagram = begin_answer(request);
    datagram.bytes[4] = plan_.error_code != 0 ? plan_.error_code : error;
    if (plan_.error_shape != 0)
        datagram.bytes[0] = header_error;
    if (plan_.error_shape == 2)
        datagram.size = 1;
    const bool text = request.bytes[1] == action_query && request.size >= 9;
    if (text && request.bytes[4] == digital_input_type) {
        datagram.origin.kind = Origin::Kind::input_refusal;
        datagram.origin.index = static_cast<std::int32_t>(request.u32_at(5));
    }
    answer(datagram, due_us, text);
}

void Robot::get(const Datagram &request, std::uint64_t due_us) {
    const std::uint16_t id = request.u16_at(2);
    Datagram datagram = begin_answer(request);
    if (id == 0) {
        datagram.u32(0);
        datagram.u16(0);
        datagram.u16(1);
        for (std::uint16_t i = 0; i < plan_.strangers; i++) {
            datagram.u16(static_cast<std::uint16_t>(i == 0 ? 0x4004 : 0x7000 + i));
            datagram.u16(static_cast<std::uint16_t>(1000 + i));
        }
        for (int service = 0; service < 5; service++) {
            if (plan_.ids[service] == 0)
                continue;
            datagram.u16(plan_.type_codes ? service_types[service] : std::uint16_t{0});
            datagram.u16(plan_.ids[service]);
        }
        answer(datagram, due_us);
        return;
    }
    switch (id == 1 ? -2 : service_of(id)) {
    case -2:
        break;
    case iocard:
        datagram.origin.kind = Origin::Kind::iocard_properties;
        datagram.u32(static_cast<std::uint32_t>(plan_.analog_inputs));
        datagram.u32(static_cast<std::uint32_t>(plan_.analog_outputs));
        datagram.u32(static_cast<std::uint32_t>(plan_.digital_inputs));
        datagram.u32(static_cast<std::uint32_t>(plan_.digital_outputs));
        break;
    case telemeter:
        datagram.u32(static_cast<std::uint32_t>(plan_.telemeters));
        for (int i = 0; i < 7 * plan_.telemeters; i++)
            datagram.f32(0.5F);
        break;
    case battery:
        datagram.f32(24);
        datagram.f32(40);
        datagram.u8(20);
        break;
    case localization:
        datagram.f64(0);
        datagram.f64(0);
        datagram.f64(0);
        datagram.u32(2);
        break;
    case differential: {
        datagram.origin.kind = Origin::Kind::differential_properties;
        const float values[13] = {0,           0, 0,  0, plan_.max_v, plan_.min_v, plan_.max_w,
                                  plan_.min_w, 3, -3, 8, -8,          plan_.width};
        for (int i = 0; i < (plan_.short_properties ? 9 : 13); i++)
            datagram.f32(values[i]);
        break;
    }
    default:
        refuse(request, 1, due_us);
        return;
    }
    answer(datagram, due_us);
}

void Robot::query(const Datagram &request, std::uint64_t now_us) {
    const std::uint64_t due = now_us + plan_.text_us;
    Datagram datagram = begin_answer(request);
    std::string text;
    if (request.u16_at(2) == 0 && request.size >= 6) {
        const int index = request.u16_at(4);
        if (!plan_.service_texts) {
            refuse(request, 2, due);
            return;
        }
        std::vector<std::string> names = {"Directory", "Notification"};
        for (std::uint16_t i = 0; i < plan_.strangers; i++)
            names.emplace_back(i == 0 ? "Laser range finder" : "Something else");
        for (int service = 0; service < 5; service++)
            if (plan_.ids[service] != 0)
                names.emplace_back(service_names[service]);
        if (index >= static_cast<int>(names.size())) {
            refuse(request, 5, due);
            return;
        }
        text = names[static_cast<std::size_t>(index)];
    } else if (service_of(request.u16_at(2)) == iocard && request.size >= 9) {
        const std::uint8_t type = request.bytes[4];
        const auto index = static_cast<std::size_t>(request.u32_at(5));
        if (type == digital_input_type) {
            if (index >= plan_.input_texts.size() || plan_.refused_texts[index]) {
                refuse(request, 2, due);
                return;
            }
            if (plan_.unanswered_texts[index])
                return;
            text = plan_.input_texts[index];
            datagram.origin.kind = Origin::Kind::input_text;
            datagram.origin.index = static_cast<std::int32_t>(index);
        } else {
            text = type == 0 && index == 2 ? "Battery voltage" : "channel";
        }
    } else {
        refuse(request, 2, due);
        return;
    }
    for (const char letter : text)
        datagram.u8(static_cast<std::uint8_t>(letter));
    answer(datagram, due, true);
}

void Robot::subscribe(const Datagram &request, bool on, std::uint64_t due_us) {
    const int service = service_of(request.u16_at(4));
    const bool unwilling = service >= 0 && (plan_.refuses_subscriptions >> service & 1) != 0;
    if (request.u16_at(2) != 1 || service < 0 || request.size < (on ? 7U : 6U) ||
        (unwilling && !plan_.ignores_refused)) {
        refuse(request, unwilling ? 16 : 2, due_us);
        return;
    }
    if (!unwilling) {
        const std::uint8_t period = std::max(request.u8_at(6), plan_.min_period);
        subscriptions_[service].period = on ? period : std::uint8_t{0};
        subscriptions_[service].since = ticks_;
    }
    answer(begin_answer(request), due_us);
}

} // namespace soak
