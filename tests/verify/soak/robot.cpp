/* SPDX-License-Identifier: MIT */
#include "robot.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace soak {

namespace {

constexpr int iocard = 0;
constexpr int telemeter = 1;
constexpr int battery = 2;
constexpr int localization = 3;
constexpr int differential = 4;
const char *const service_names[5] = {"IOCard", "Telemeter", "Battery", "Localization",
                                      "Differential"};
constexpr std::uint16_t service_types[5] = {0x4001, 0x4008, 0x0000, 0x8002, 0x4005};

float clamp(float value, float low, float high) {
    return std::min(std::max(value, low), high);
}

std::string button_text(const char *letter, int wording) {
    const std::string name(letter);
    switch (wording) {
    case 0:
        return "Game pad \"" + name + "\" button";
    case 1:
        return "Gamepad " + name;
    case 2:
        return "Joystick button " + name;
    default:
        return name + " BUTTON (game-pad)";
    }
}

void draw_card(Random &random, RobotPlan &plan) {
    const int wording = static_cast<int>(random.between(0, 3));
    if (random.chance(0.3)) {
        plan.digital_inputs = 23;
        plan.pad_a = 9;
    }
    if (random.chance(0.05)) {
        plan.digital_inputs = 40;
        plan.pad_a = static_cast<std::int32_t>(random.between(2, 39));
    }
    if (random.chance(0.3))
        plan.pad_a = static_cast<std::int32_t>(
            random.between(2, static_cast<std::uint64_t>(plan.digital_inputs) - 1));
    plan.give_texts(pad_texts(plan.digital_inputs, plan.pad_a, wording));
    const auto count = static_cast<std::size_t>(plan.digital_inputs);
    const auto a = static_cast<std::size_t>(plan.pad_a);
    switch (random.between(0, 15)) {
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
        plan.input_texts[a < 5 ? count - 1 : 3] = button_text("A", 1);
        break;
    case 4: /* no input is called [A] */
        plan.input_texts[a] = "spare";
        break;
    default:
        break;
    }
}

void draw_limits(Random &random, RobotPlan &plan) {
    const float infinity = std::numeric_limits<float>::infinity();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    switch (random.between(0, 20)) {
    case 0:
        plan.max_v = nan;
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
    const float values[] = {max_v, min_v, max_w, min_w};
    for (const float value : values)
        if (!std::isfinite(value))
            return false;
    return ids[differential] != 0 && ids[iocard] != 0 && !short_properties && max_v >= 0 &&
           min_v <= 0 && max_w >= 0 && min_w <= 0 && (refuses_subscriptions & 0x11) == 0;
}

RobotPlan draw_robot(Random &random) {
    RobotPlan plan;
    plan.type_codes = random.chance(0.5);
    plan.service_texts = plan.type_codes ? random.chance(0.8) : true;
    if (random.chance(0.3)) { /* other ids; then the battery can be known by its text only */
        plan.service_texts = true;
        std::uint16_t next = static_cast<std::uint16_t>(random.between(2, 300));
        for (std::uint16_t &id : plan.ids)
            id = next++;
        for (std::size_t i = 5; i > 1; i--)
            std::swap(plan.ids[i - 1], plan.ids[random.between(0, i - 1)]);
    } else if (random.chance(0.1)) {
        plan.service_texts = plan.type_codes = false; /* only the manual's ids tell */
    }
    if (random.chance(0.2))
        plan.strangers = static_cast<std::uint16_t>(random.between(1, 3));
    draw_card(random, plan);
    draw_limits(random, plan);
    plan.answer_us = random.between(100, 10000);
    plan.text_us = random.chance(0.2) ? random.between(10000, 400000) : plan.answer_us;
    plan.literal_ids = random.chance(0.05);
    if (plan.literal_ids) { /* such a robot's texts decide nothing, so its ids must */
        plan.type_codes = plan.type_codes || plan.ids[iocard] != 2 || plan.ids[differential] != 6;
        plan.pad_a = 8;
        plan.give_texts(pad_texts(22, 8, 0));
    }
    plan.error_telegrams = random.chance(0.3);
    if (random.chance(0.05))
        plan.refuses_subscriptions = static_cast<std::uint8_t>(random.between(1, 31));
    plan.keeps_subscriptions = random.chance(0.3);
    plan.short_properties = random.chance(0.03);
    if (random.chance(0.03))
        plan.ids[random.between(0, 4)] = 0;
    if (random.chance(0.5))
        plan.noise = random.chance(0.5) ? 1e-9F : 1e-7F;
    plan.width = random.chance(0.1) ? 0 : 0.68F;
    plan.clock_ppm = random.uniform(-50, 50);
    plan.first_cycle = random.chance(0.5) ? 0 : random.between(0, 100000000);
    plan.response_s = random.uniform(0.1, 0.5);
    return plan;
}

Robot::Robot(RobotPlan plan, std::uint64_t now_us) : plan_(std::move(plan)), started_us_(now_us) {
    plan_next_tick();
}

Origin Robot::origin(Origin::Kind kind, std::uint64_t made_us, std::int32_t index) const {
    Origin origin;
    origin.kind = kind;
    origin.index = index;
    origin.boot = boot_;
    origin.made_us = made_us;
    return origin;
}

void Robot::hold_pad_a(bool held, Speeds speeds) {
    pad_a_held_ = held;
    pad_speeds_ = speeds;
    if (!held)
        target_ = {};
}

void Robot::reboot(std::uint64_t off_us, std::uint64_t now_us) {
    boot_++;
    started_us_ = now_us + off_us;
    ticks_ = 0;
    answers_.clear();
    target_ = {};
    current_ = {};
    pad_a_held_ = false;
    if (!plan_.keeps_subscriptions)
        std::fill(std::begin(subscriptions_), std::end(subscriptions_), Subscription());
    else
        for (Subscription &subscription : subscriptions_)
            subscription.since = 0;
    plan_.first_cycle = 0;
    plan_next_tick();
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

void Robot::tick(std::uint64_t now_us, std::vector<Datagram> &out) {
    ticks_++;
    if (pad_a_held_)
        target_ = pad_speeds_;
    else if (now_us - commanded_us_ >= plan_.watchdog_us)
        target_ = {};
    const auto share = static_cast<float>(0.01 / plan_.response_s);
    const Speeds goal = motors_dead_ ? Speeds() : target_;
    current_.v += (goal.v - current_.v) * (motors_dead_ ? 0.5F : share);
    current_.w += (goal.w - current_.w) * (motors_dead_ ? 0.5F : share);
    if (goal.zero() && std::fabs(current_.v) < 1e-4F && std::fabs(current_.w) < 1e-4F)
        current_ = {};
    now_us_ = now_us;
    for (int service = 0; service < 5; service++) {
        const Subscription &subscription = subscriptions_[service];
        if (subscription.period != 0 && (ticks_ - subscription.since) % subscription.period == 0)
            out.push_back(status(service));
    }
    plan_next_tick();
}

float Robot::noisy(float value) const {
    return value + ((ticks_ & 1) != 0 ? plan_.noise : -plan_.noise);
}

Datagram Robot::status(int service) const {
    Datagram datagram;
    datagram.u8(header_status);
    datagram.u16(plan_.ids[service]);
    datagram.u64(plan_.first_cycle + ticks_);
    datagram.origin = origin(Origin::Kind::other, now_us_);
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
        datagram.f32(1.5F);
        datagram.f32(2.5F);
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
    default:
        datagram.origin.kind = Origin::Kind::differential_status;
        datagram.origin.others_target = others_target_ && !pad_a_held_;
        datagram.f32(noisy(target_.v));
        datagram.f32(noisy(current_.v));
        datagram.f32(noisy(target_.w));
        datagram.f32(noisy(current_.w));
        break;
    }
    return datagram;
}

int Robot::service_of(std::uint16_t id) const {
    for (int service = 0; service < 5; service++)
        if (plan_.ids[service] == id && id != 0)
            return service;
    return -1;
}

void Robot::receive(const Datagram &datagram, std::uint64_t now_us, bool from_other_commander) {
    if (!running(now_us) || datagram.size < 3)
        return;
    now_us_ = now_us;
    if (datagram.bytes[0] == header_status) {
        command(datagram, now_us, from_other_commander);
        return;
    }
    if (datagram.size < 4 || from_other_commander)
        return;
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
        answer(begin_answer(datagram), due);
        break;
    default:
        refuse(datagram, 3, due);
        break;
    }
}

void Robot::command(const Datagram &datagram, std::uint64_t now_us, bool from_other_commander) {
    if (datagram.u16_at(1) != plan_.ids[differential] || datagram.size < 11)
        return;
    commanded_us_ = now_us;
    if (pad_a_held_)
        return;
    const Speeds asked = command_speeds(datagram);
    target_.v = clamp(asked.v, -2.6F, 2.6F);
    target_.w = clamp(asked.w, -6.5F, 6.5F);
    others_target_ = from_other_commander;
}

void Robot::answer(Datagram datagram, std::uint64_t due_us) {
    answers_.push_back({due_us, datagram});
}

Datagram Robot::begin_answer(const Datagram &request) const {
    Datagram datagram;
    datagram.u8(plan_.literal_ids ? header_literal : request.bytes[0]);
    datagram.u8(request.bytes[1]);
    datagram.u16(request.u16_at(2));
    datagram.u8(0);
    datagram.origin = origin(Origin::Kind::other, now_us_);
    return datagram;
}

void Robot::refuse(const Datagram &request, std::uint8_t error, std::uint64_t due_us) {
    Datagram datagram = begin_answer(request);
    datagram.bytes[4] = error;
    if (plan_.error_telegrams)
        datagram.bytes[0] = header_error;
    if (request.bytes[1] == action_query && request.size >= 9 &&
        request.bytes[4] == digital_input_type)
        datagram.origin = origin(Origin::Kind::input_refusal, now_us_,
                                 static_cast<std::int32_t>(request.u32_at(5)));
    answer(datagram, due_us);
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
        datagram.u32(2);
        for (int i = 0; i < 14; i++)
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
        const float values[] = {target_.v,   target_.w,   current_.v,  current_.w, plan_.max_v,
                                plan_.min_v, plan_.max_w, plan_.min_w, 2,          -3,
                                8,           -10,         plan_.width};
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
            datagram.origin =
                origin(Origin::Kind::input_text, now_us_, static_cast<std::int32_t>(index));
        } else {
            text = type == 0 && index == 2 ? "Battery voltage" : "channel";
        }
    } else {
        refuse(request, 2, due);
        return;
    }
    for (const char letter : text)
        datagram.u8(static_cast<std::uint8_t>(letter));
    answer(datagram, due);
}

void Robot::subscribe(const Datagram &request, bool on, std::uint64_t due_us) {
    const int service = service_of(request.u16_at(4));
    if (request.u16_at(2) != 1 || service < 0 || request.size < (on ? 7U : 6U) ||
        (plan_.refuses_subscriptions >> service & 1) != 0) {
        refuse(request, 2, due_us);
        return;
    }
    subscriptions_[service].period = on ? request.u8_at(6) : std::uint8_t{0};
    subscriptions_[service].since = ticks_;
    answer(begin_answer(request), due_us);
}

} // namespace soak
