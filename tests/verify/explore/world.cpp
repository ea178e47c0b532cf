/* SPDX-License-Identifier: MIT */
#include "world.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <type_traits>

namespace explore {

static_assert(std::is_trivially_copyable_v<World>, "a world is copied as bytes");

const Letter letters[] = {
    {'.', "nothing: statuses and answers arrive on time"},
    {'x', "statuses and answers are lost"},
    {'l', "statuses and answers arrive a period late"},
    {'r', "statuses and answers arrive after those of the next period"},
    {'q', "statuses arrive a period late, answers on time"},
    {'a', "answers are lost"},
    {'2', "statuses and answers arrive twice"},
    {'v', "what the client sends arrives after what it sends in the next period"},
    {'U', "what the client sends is lost from now on, or no longer"},
    {'D', "drive(0.5, 0.25)"},
    {'d', "drive(-0.3, 0)"},
    {'P', "pause()"},
    {'S', "stop()"},
    {'A', "arm()"},
    {'B', "[A] is pressed, or released"},
    {'O', "another commander sends a speed"},
    {'E', "the emergency stop is pressed, or released"},
    {'R', "the robot restarts: it is down for two periods"},
    {'C', "the host's clock steps back by 20 ms"},
    {'H', "the program hangs for three periods"},
};
const std::uint32_t letter_count = sizeof letters / sizeof *letters;

const RobotKind robot_kinds[] = {
    {"a robot that forgets its target under [A]", false, 200 * ms},
    {"a robot that resumes its target after [A], with a watchdog of 60 s", true, 60000 * ms},
};
const std::uint32_t robot_kind_count = sizeof robot_kinds / sizeof *robot_kinds;

namespace {

constexpr std::uint16_t iocard_id = 2, differential_id = 6;
constexpr std::uint64_t flight_us = 1 * ms;    /* of a datagram */
constexpr std::uint64_t measured_us = 20 * ms; /* after a period's begin a status is made */

/* Far from 0 and from each other, so that a hash can tell what a number is relative to. */
constexpr std::uint64_t client_base = 0x0012345600000000, true_base = 0x0023456700000000,
                        cycle_base = 0x0000034500000000, cycle_step = 0x0000001100000000;

bool near(std::uint64_t value, std::uint64_t base) {
    return value - base + 0x40000000 < 0x80000000;
}

} // namespace

World::World(std::uint32_t robot_kind, std::uint64_t later_us)
    : begin_us_(true_base + later_us), first_cycle_(cycle_base + later_us / 7000),
      true_us_(begin_us_), skew_us_(client_base - true_base), status_us_(true_us_ + measured_us) {
    robot_.kind = static_cast<std::uint8_t>(robot_kind);
    robot_.boot_us = true_us_ - 1000 * ROBUROC4_CYCLE_US;
    client_.begin(client_config(), client_us());
    judge_.started(client_us());
}

std::uint64_t World::cycles(std::uint64_t at_us) const {
    const auto since_boot_us = static_cast<std::int64_t>(at_us - robot_.boot_us);
    return first_cycle_ - robot_.boots * cycle_step +
           static_cast<std::uint64_t>(since_boot_us / ROBUROC4_CYCLE_US);
}

bool World::step(char letter) {
    const std::uint64_t now = client_us();
    letter_ = static_cast<std::uint8_t>(letter);
    say("---- %c", letter);
    judge_.called(now);
    switch (letter) {
    case 'U':
        uplink_out_ ^= 1;
        break;
    case 'D':
    case 'd': {
        const Speeds speeds = letter == 'D' ? Speeds{0.5F, 0.25F} : Speeds{-0.3F, 0};
        const roburoc4_result result = client_.drive(speeds, now);
        say("drive: %d", result);
        note(static_cast<std::uint32_t>(result));
        judge_.drive(result, speeds, now);
        break;
    }
    case 'P': {
        const bool was_armed = facts().armed != 0;
        const roburoc4_result result = client_.pause(now);
        say("pause: %d", result);
        note(static_cast<std::uint32_t>(result));
        judge_.pause(result, was_armed, facts().armed != 0, now);
        break;
    }
    case 'S': {
        const roburoc4_result result = client_.stop(now);
        say("stop: %d", result);
        note(static_cast<std::uint32_t>(result));
        judge_.stop(result, facts().armed != 0);
        break;
    }
    case 'A': {
        const roburoc4_facts before = facts();
        const roburoc4_result result = client_.arm(now);
        say("arm: %d", result);
        note(static_cast<std::uint32_t>(result));
        judge_.arm(result, before, true_us_);
        break;
    }
    case 'B':
        robot_.held ^= 1;
        if (robot_.held) {
            robot_.kept = robot_.target;
            robot_.target = Speeds{};
        } else {
            if (robot_kinds[robot_.kind].resumes)
                robot_.target = robot_.kept;
            robot_.kept = Speeds{};
        }
        break;
    case 'O':
        if (!robot_.held) {
            robot_.target = Speeds{0.4F, -0.4F};
            robot_.commanded_us = true_us_;
        }
        break;
    case 'E':
        robot_.motors_off ^= 1;
        break;
    case 'R':
        if (robot_.boots < 2) {
            robot_.boots++;
            robot_.boot_us = true_us_ + 2 * period_us; /* so long it is down */
            robot_.target = robot_.kept = Speeds{};
            robot_.subscribed = 0;
        }
        break;
    case 'C':
        skew_us_ -= 20 * ms;
        judge_.called(client_us());
        break;
    default:
        break;
    }
    asleep_ = letter == 'H';
    run_to(true_us_ + (asleep_ ? 3 : 1) * period_us);
    asleep_ = 0;
    letter_ = 0;
    call_client();
    const std::uint32_t events = client_.take_events();
    if (events != 0)
        say("events %08x", events);
    note(events);
    judge_.take_events(events);
    return judge_.broken == none;
}

void World::run_to(std::uint64_t end_us) {
    if (!asleep_)
        call_client();
    while (true) {
        std::uint64_t next = std::min(end_us, status_us_);
        if (!asleep_) {
            if (count_ > 0)
                next = std::min(next, messages_[0].due_us);
            const std::uint64_t deadline = client_.deadline();
            if (deadline < client_us() + (next - true_us_))
                next = deadline > client_us() ? true_us_ + (deadline - client_us()) : true_us_ + 1;
        } else {
            /* The robot goes on. */
            for (std::uint32_t i = 0; i < count_; i++)
                if (messages_[i].kind >= command) {
                    next = std::min(next, messages_[i].due_us);
                    break;
                }
        }
        next = std::max(next, true_us_);
        if (next >= end_us)
            break;
        true_us_ = next;
        bool called = false;
        watchdog();
        if (true_us_ == status_us_) {
            make_statuses();
            status_us_ += period_us;
        }
        for (std::uint32_t i = 0; i < count_ && messages_[i].due_us <= true_us_;) {
            if (asleep_ && messages_[i].kind < command) {
                i++;
                continue;
            }
            const Message message = messages_[i];
            count_--;
            std::memmove(messages_ + i, messages_ + i + 1, (count_ - i) * sizeof(Message));
            std::memset(messages_ + count_, 0, sizeof(Message));
            if (message.kind >= command) {
                robot_receives(message);
            } else {
                client_receives(message);
                call_client();
                called = true;
            }
        }
        if (!asleep_ && !called && client_.deadline() <= client_us())
            call_client();
    }
    true_us_ = end_us;
    watchdog();
    while (asleep_ && count_ > 0 && messages_[0].due_us <= true_us_) {
        /* What waited in the socket, at one time. */
        const Message message = messages_[0];
        count_--;
        std::memmove(messages_, messages_ + 1, count_ * sizeof(Message));
        std::memset(messages_ + count_, 0, sizeof(Message));
        if (message.kind < command)
            client_receives(message);
        else
            robot_receives(message);
    }
}

/* ---- the client's side ---- */

void World::call_client() {
    const std::uint64_t now = client_us();
    std::uint8_t buffer[ROBUROC4_MAX_TRANSMIT];
    judge_.before_poll(now, true_us_);
    for (std::uint32_t i = 0; i < 32; i++) {
        const roburoc4_result size = client_.poll(buffer, now);
        if (size <= 0)
            break;
        pass(buffer, static_cast<std::size_t>(size));
    }
    const roburoc4_facts f = facts();
    std::uint64_t word = 0;
    for (std::size_t i = 0; i + sizeof word <= sizeof f; i += sizeof word) {
        std::memcpy(&word, reinterpret_cast<const char *>(&f) + i, sizeof word);
        note(word);
    }
    note(client_.deadline() - now);
    judge_.after_poll(f, now, true_us_);
}

/** A datagram of the client. */
void World::pass(const std::uint8_t *bytes, std::size_t size) {
    note(true_us_ - begin_us_);
    for (std::size_t i = 0; i < size; i++)
        note(bytes[i]);
    Message message{};
    message.made_us = true_us_;
    roburoc4_differential_command c{};
    roburoc4_request r{};
    if (roburoc4_decode_differential_command(bytes, size, &c) == 0 &&
        c.service == differential_id) {
        message.kind = command;
        message.target = {c.linear_m_s, c.angular_rad_s};
        say("sends %g %g", c.linear_m_s, c.angular_rad_s);
        judge_.command(message.target, client_us(), true_us_);
    } else if (roburoc4_decode_request(bytes, size, &r) >= 0) {
        message.kind = request;
        message.id = r.id;
        message.action = r.action;
        message.service = r.service;
        message.subject = r.subject;
        message.index = static_cast<std::uint8_t>(r.index);
        say("asks %u of %u", r.action, r.service);
        judge_.other_traffic();
    }
    if (!uplink_out_)
        send(message, letter_ == 'v' ? period_us + 25 * ms : flight_us);
}

void World::client_receives(const Message &m) {
    std::uint8_t bytes[64];
    roburoc4_result size = 0;
    if (m.kind == io_status) {
        size = roburoc4_encode_iocard_status(bytes, sizeof bytes, iocard_id, m.cycles, nullptr, 0,
                                             &m.held, 1);
    } else if (m.kind == differential_status) {
        const roburoc4_differential_status status{m.cycles,
                                                  m.target.linear,
                                                  m.speed.linear,
                                                  m.target.angular,
                                                  m.speed.angular,
                                                  differential_id,
                                                  {}};
        size = roburoc4_encode_differential_status(bytes, sizeof bytes, &status);
    } else if (m.action == ROBUROC4_ACTION_GET && m.service == ROBUROC4_SERVICE_DIRECTORY) {
        const roburoc4_directory_entry entries[] = {
            {0, ROBUROC4_SERVICE_DIRECTORY},
            {0, ROBUROC4_SERVICE_NOTIFICATION},
            {ROBUROC4_TYPE_IOCARD, iocard_id},
            {ROBUROC4_TYPE_DIFFERENTIAL, differential_id},
        };
        size = roburoc4_encode_directory(bytes, sizeof bytes, m.id, m.service, entries, 4);
    } else if (m.action == ROBUROC4_ACTION_GET && m.service == iocard_id) {
        const roburoc4_iocard_properties properties{0, 0, 1, 0, iocard_id, 0};
        size = roburoc4_encode_iocard_properties(bytes, sizeof bytes, m.id, &properties);
    } else if (m.action == ROBUROC4_ACTION_GET && m.service == differential_id) {
        const roburoc4_differential_properties properties{
            0, 0, 0, 0, 2.6F, -2.6F, 6.5F, -6.5F, 3, -3, 8, -8, 0.68F, differential_id, 0};
        size = roburoc4_encode_differential_properties(bytes, sizeof bytes, m.id, &properties);
    } else if (m.action == ROBUROC4_ACTION_QUERY) {
        static const char *const services[] = {"Directory", "Notification", "IOCard",
                                               "Differential"};
        const char *text = m.service == iocard_id ? "Gamepad A" : services[m.index % 4];
        size = roburoc4_encode_text(bytes, sizeof bytes, m.id, m.service, text, std::strlen(text));
    } else {
        size = roburoc4_encode_answer(bytes, sizeof bytes, m.id, m.action, m.service, 0);
    }
    judge_.called(client_us());
    const roburoc4_result result =
        client_.receive(bytes, static_cast<std::size_t>(size), client_us());
    note(static_cast<std::uint32_t>(result));
    if (m.kind == io_status) {
        say("IO status, [A] %d, of %+lld ms: %d", m.held,
            static_cast<long long>(m.made_us - true_us_) / 1000, result);
        if (result >= 0)
            judge_.io_status(m.held != 0, m.made_us, m.boot);
    } else if (m.kind == differential_status) {
        say("status, target %g %g, speed %g %g, of %+lld ms: %d", m.target.linear, m.target.angular,
            m.speed.linear, m.speed.angular, static_cast<long long>(m.made_us - true_us_) / 1000,
            result);
        if (result >= 0)
            judge_.differential_status(m.target, m.speed, m.made_us, m.boot, true_us_);
    } else if (result >= 0) {
        judge_.answered(m.made_us);
    }
}

/* ---- the robot and the network ---- */

void World::watchdog() {
    if (true_us_ - robot_.commanded_us >= robot_kinds[robot_.kind].watchdog_us)
        robot_.target = robot_.kept = Speeds{};
    if (robot_.target.zero() && robot_.kept.zero())
        robot_.commanded_us = 0;
}

void World::make_statuses() {
    if (true_us_ < robot_.boot_us)
        return;
    Message m{};
    m.made_us = true_us_;
    m.cycles = cycles(true_us_);
    m.boot = robot_.boots;
    if (robot_.subscribed & 1) {
        m.kind = io_status;
        m.held = robot_.held;
        downlink(m);
    }
    if (robot_.subscribed & 2) {
        m.kind = differential_status;
        m.held = 0;
        m.target = robot_.target;
        m.speed = robot_.motors_off ? Speeds{} : robot_.target;
        downlink(m);
    }
}

void World::robot_receives(const Message &m) {
    if (true_us_ < robot_.boot_us)
        return;
    if (m.kind == command) {
        say("    the robot gets %g %g", m.target.linear, m.target.angular);
        if (!robot_.held)
            robot_.target = m.target;
        if (!robot_.held || robot_kinds[robot_.kind].resumes)
            robot_.commanded_us = true_us_;
        watchdog();
        return;
    }
    Message reply = m;
    reply.kind = answer;
    reply.made_us = true_us_;
    reply.boot = robot_.boots;
    if (m.action == ROBUROC4_ACTION_INSERT)
        robot_.subscribed |= m.subject == iocard_id ? 1 : m.subject == differential_id ? 2 : 0;
    downlink(reply);
}

void World::downlink(const Message &message) {
    switch (letter_) {
    case 'x':
        return;
    case 'l':
        return send(message, flight_us + period_us);
    case 'r':
        return send(message, flight_us + period_us + 10 * ms);
    case 'q':
        return send(message, flight_us + (message.kind == answer ? 0 : period_us));
    case 'a':
        if (message.kind == answer)
            return;
        return send(message, flight_us);
    case '2':
        send(message, flight_us);
        return send(message, flight_us + 10 * ms);
    default:
        return send(message, flight_us);
    }
}

void World::send(Message message, std::uint64_t delay_us) {
    message.due_us = true_us_ + delay_us;
    if (count_ == capacity) {
        std::fprintf(stderr, "explore: too many datagrams on their way\n");
        std::abort();
    }
    std::uint32_t i = count_;
    for (; i > 0 && messages_[i - 1].due_us > message.due_us; i--)
        messages_[i] = messages_[i - 1];
    messages_[i] = message;
    count_++;
}

/* ---- what is known of it ---- */

void World::note(std::uint64_t value) {
    seen_ = (seen_ ^ value) * 0x9E3779B97F4A7C15;
    seen_ ^= seen_ >> 29;
}

void World::say(const char *format, ...) const {
    if (!trace)
        return;
    std::printf("%8.3f  ", static_cast<double>(true_us_ - begin_us_) / 1e6);
    va_list arguments;
    va_start(arguments, format);
    std::vprintf(format, arguments);
    va_end(arguments);
    std::printf("\n");
}

std::uint64_t World::hash(const std::uint8_t *ignored) const {
    const std::uint64_t client_now = client_us(), cycles_now = cycles(true_us_);
    /* Times count from now. */
    const auto relative = [&](std::uint64_t word) {
        return near(word, client_now)   ? word - client_now
               : near(word, true_us_)   ? word - true_us_
               : near(word, cycles_now) ? word - cycles_now
                                        : word;
    };
    std::uint64_t hash = 0x243F6A8885A308D3;
    const auto add = [&](const void *from, std::size_t size, const std::uint8_t *without) {
        for (std::size_t i = 0; i < size; i += 8) {
            std::uint64_t word = 0;
            std::memcpy(&word, static_cast<const char *>(from) + i, sizeof word);
            word = relative(word);
            if (without != nullptr) {
                std::uint8_t halves[2];
                std::memcpy(halves, without + i / 4, sizeof halves);
                if (halves[0])
                    word &= 0xFFFFFFFF00000000;
                if (halves[1])
                    word &= 0x00000000FFFFFFFF;
            }
            hash = (hash ^ word) * 0x9E3779B97F4A7C15;
            hash ^= hash >> 29;
        }
    };
    const std::uint64_t others[] = {status_us_ - true_us_, skew_us_, uplink_out_};
    add(&client_.client, sizeof client_.client, ignored);
    add(reinterpret_cast<const char *>(&client_) + sizeof client_.client,
        sizeof client_ - sizeof client_.client, nullptr);
    add(&judge_, sizeof judge_, nullptr);
    add(&robot_, sizeof robot_, nullptr);
    add(others, sizeof others, nullptr);
    add(messages_, count_ * sizeof(Message), nullptr);
    return hash;
}

} // namespace explore
