/* SPDX-License-Identifier: MIT
 *
 * walk.cpp - the life: world, caller, user, faults, and the judge on the robot's side.
 *
 * A seed is the same life with every compiler: nothing is drawn twice within one list of arguments
 * or one expression, whose order is the compiler's choice.
 */
#include "walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "roburoc4_sim.h"
#include "walk_network.h"

namespace roburoc4_tests {

namespace {

constexpr std::uint64_t ms = 1000;
constexpr std::uint64_t second = 1000000;
constexpr std::uint64_t client_peer = 1, foreign_peer = 2;
constexpr std::uint64_t watchdog_us = second;
/* A cycle to notice, a cycle to act. */
constexpr std::uint64_t robot_slack_us = 2 * ROBUROC4_CYCLE_US;

constexpr std::uint64_t never_us = UINT64_MAX;

/** What can go wrong in a life. */
struct Menu {
    bool weather, long_delays, damage, power, renumber, pad, estop, bumper, clock, hang, foreign,
        silence, subscriptions, restart, bursts, spoof;
};

class Life {
  public:
    Life(std::uint64_t seed, bool trace);
    LifeReport run();

  private:
    using Sim = std::unique_ptr<roburoc4_sim, void (*)(roburoc4_sim *)>;

    void say(const char *what, double a = 0, double b = 0) const;
    void complain(const std::string &what);
    [[nodiscard]] bool fine() const {
        return report_.complaint.empty();
    }
    void draw_menu();
    [[nodiscard]] roburoc4_config draw_config();
    [[nodiscard]] roburoc4_sim_config draw_robot();

    /* time */
    [[nodiscard]] std::uint64_t client_now() const {
        return now_us_ + offset_us_;
    }
    void at(std::uint64_t time_us, std::function<void()> what) {
        script_.emplace(time_us, std::move(what));
    }
    void run_until(std::uint64_t end_us);
    [[nodiscard]] std::uint64_t caller_wakes_us() const;
    void step_robot();
    void judge_robot(const roburoc4_sim_state &state);

    /* caller and user */
    void call();
    void receive_all();
    void transmit_all();
    void act();
    void act_oddly();
    void push_target();
    void draw_target();
    [[nodiscard]] std::uint32_t draw_lease();
    void deliver_to_robot();

    /* faults */
    void draw_weather();
    void next_fault();
    void fault_of_power();
    void fault_of_pad();
    void fault_of_estop();
    void fault_of_clock();
    void fault_of_foreigner();
    void foreign_command(std::uint64_t until_us, std::uint64_t period_us);
    void remember(const Bytes &datagram);
    void change_byte(Bytes &bytes, std::size_t first, std::size_t last);
    [[nodiscard]] Bytes forged();
    void spoof(std::uint64_t until_us);

    /* the end */
    void mend();
    void subscribe_again();
    void come_back();
    void go_home();

    Dice dice_;
    const bool trace_;
    LifeReport report_;
    Menu menu_{};
    roburoc4_config config_;
    roburoc4_sim_config robot_;
    Sim sim_;
    std::unique_ptr<Referee> client_;
    BadNetwork to_robot_, to_client_;
    std::vector<Bytes> overheard_; /* by a forger: the last datagrams of both ways */
    std::size_t overheard_next_ = 0;
    std::multimap<std::uint64_t, std::function<void()>> script_;

    std::uint64_t now_us_ = 100 * second;
    std::uint64_t offset_us_ = 0; /* client's clock - real time, modulo 2^64 */
    bool stepped_ = false;
    bool faults_ = true;

    std::uint64_t tick_us_ = 0; /* 0: a prompt caller, else one with a loop of this period */
    std::uint64_t lateness_us_ = 0;
    std::uint64_t next_tick_us_ = 0, hung_until_us_ = 0;
    std::uint64_t idle_wakes_ = 0;

    std::uint64_t next_act_us_ = 0, act_period_us_ = 50 * ms, quiet_until_us_ = 0;
    float linear_ = 0, angular_ = 0;
    bool drives_ = true;

    /* for the judge on the robot's side */
    std::uint64_t grant_bound_us_ = 0, arrival_bound_us_ = 0;
    std::uint64_t foreign_until_us_ = 0, damaged_until_us_ = 0;
    std::uint64_t longest_delay_us_ = 0;
};

void Life::say(const char *what, double a, double b) const {
    if (trace_)
        std::printf("%10.6f  client %14.6f  %s %g %g\n", static_cast<double>(now_us_) * 1e-6,
                    static_cast<double>(client_now()) * 1e-6, what, a, b);
}

void Life::complain(const std::string &what) {
    if (fine())
        report_.complaint = what + " (at " + std::to_string(static_cast<double>(now_us_) * 1e-6) +
                            " s of real time)";
}

/* ----------------------------------------------------------------------------- the drawing --- */

void Life::draw_menu() {
    const bool all = dice_.chance(0.3);
    const auto some = [&](double probability) { return all || dice_.chance(probability); };
    menu_.weather = some(0.7);
    menu_.long_delays = dice_.chance(0.2);
    menu_.damage = dice_.chance(0.3);
    menu_.power = some(0.4);
    menu_.renumber = dice_.chance(0.2);
    menu_.pad = some(0.5);
    menu_.estop = some(0.3);
    menu_.bumper = some(0.2);
    menu_.clock = some(0.4);
    menu_.hang = some(0.4);
    menu_.foreign = some(0.3);
    menu_.silence = some(0.5);
    menu_.subscriptions = some(0.3);
    menu_.restart = some(0.2);
    menu_.bursts = some(0.3);
    menu_.spoof = dice_.chance(0.2);
    report_.damaged = menu_.damage;
}

roburoc4_config Life::draw_config() {
    roburoc4_config config;
    roburoc4_config_init(&config, sizeof config);
    if (dice_.chance(0.3))
        return config;
    config.first_retry_ms = static_cast<std::uint32_t>(dice_.between(10, 100));
    config.lost_ms = static_cast<std::uint32_t>(dice_.between(200, 3000));
    for (int service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++)
        config.period_ms[service] = static_cast<std::uint16_t>(10 * dice_.between(1, 10));
    config.period_ms[ROBUROC4_SERVICE_BATTERY] = 1000;
    config.fresh_ms = static_cast<std::uint32_t>(dice_.between(200, 1000));
    config.lease_ms = static_cast<std::uint32_t>(dice_.between(20, 1000));
    config.drive_period_ms = static_cast<std::uint32_t>(dice_.between(10, config.lease_ms / 2));
    config.scale_linear = dice_.chance(0.3) ? static_cast<float>(dice_.real(0.5, 2)) : 1.0F;
    config.scale_angular = dice_.chance(0.3) ? static_cast<float>(dice_.real(0.5, 2)) : 1.0F;
    config.max_linear_m_s = dice_.chance(0.3) ? static_cast<float>(dice_.real(0.5, 5)) : 2.6F;
    config.max_angular_rad_s = dice_.chance(0.3) ? static_cast<float>(dice_.real(0.5, 9)) : 6.5F;
    config.options = dice_.chance(0.3) ? static_cast<std::uint32_t>(dice_.between(0, 7)) : 0;
    return config;
}

roburoc4_sim_config Life::draw_robot() {
    roburoc4_sim_config robot;
    roburoc4_sim_config_init(&robot);
    robot.seed = dice_.next();
    if (dice_.chance(0.2)) {
        robot.digital_inputs = ROBUROC4_DI_COUNT + 1;
        robot.analog_inputs = ROBUROC4_AI_COUNT + 1;
    }
    if (dice_.chance(0.2)) {
        robot.max_linear_m_s = static_cast<float>(dice_.real(0.3, 2.6));
        robot.min_linear_m_s = static_cast<float>(dice_.real(-2.6, 0));
    }
    robot.error_header = dice_.chance(0.1) ? 1 : 0;
    robot.plain_types = !menu_.damage && dice_.chance(0.2) ? 1 : 0;
    if (robot.plain_types == 0 && dice_.chance(0.1))
        (dice_.chance(0.5) ? robot.answer_id_fixed : robot.only_id_fixed) = 1;
    return robot;
}

Life::Life(std::uint64_t seed, bool trace)
    : dice_(seed), trace_(trace), sim_(nullptr, roburoc4_sim_destroy) {
    draw_menu();
    config_ = draw_config();
    robot_ = draw_robot();
    sim_.reset(roburoc4_sim_create(&robot_));
    roburoc4_sim_clear_world(sim_.get());
    drives_ = !dice_.chance(0.1);
    report_.monitor = !drives_;
    RobotTruth truth;
    truth.analog_inputs = static_cast<std::uint32_t>(robot_.analog_inputs);
    truth.digital_inputs = static_cast<std::uint32_t>(robot_.digital_inputs);
    truth.override_index = ROBUROC4_DI_PAD_A + truth.digital_inputs - ROBUROC4_DI_COUNT;
    client_ = std::make_unique<Referee>(config_, truth, !drives_);

    const std::uint64_t clocks[] = {0, 5 * second, 1000000 * second};
    offset_us_ = clocks[dice_.between(0, 2)] - now_us_;
    tick_us_ = dice_.chance(0.5) ? 0 : dice_.between(2 * ms, 40 * ms);
    lateness_us_ = dice_.chance(0.5) ? 0 : dice_.between(0, 3 * ms);
    act_period_us_ = dice_.between(10 * ms, 100 * ms);
    next_tick_us_ = next_act_us_ = now_us_;
    roburoc4_sim_advance(sim_.get(), now_us_);
}

/* ---------------------------------------------------------------------------------- faults --- */

void Life::draw_weather() {
    for (BadNetwork *way : {&to_robot_, &to_client_}) {
        Weather &weather = way->weather;
        weather = Weather();
        weather.loss = dice_.chance(0.15) ? 1 : dice_.chance(0.5) ? dice_.real(0, 0.6) : 0;
        weather.duplicate = dice_.chance(0.4) ? dice_.real(0, 0.5) : 0;
        weather.reorder = dice_.chance(0.4) ? dice_.real(0, 0.5) : 0;
        weather.hold_us = dice_.between(0, 200 * ms);
        weather.delay_us = dice_.between(0, 20 * ms);
        weather.jitter_us = dice_.chance(0.5) ? dice_.between(0, 50 * ms) : 0;
        if (menu_.long_delays && dice_.chance(0.5))
            weather.delay_us = dice_.between(100 * ms, 3 * second);
        if (menu_.damage)
            weather.damage = dice_.chance(0.5) ? dice_.real(0, 0.005) : dice_.real(0, 0.1);
        if (menu_.bursts && dice_.chance(0.5)) {
            weather.burst = dice_.real(0, 0.1);
            weather.burst_us = dice_.between(50 * ms, 2 * second);
        }
        longest_delay_us_ = std::max(longest_delay_us_, weather.longest_us());
    }
    say("weather: loss to robot, to client", to_robot_.weather.loss, to_client_.weather.loss);
    if (dice_.chance(0.7))
        at(now_us_ + dice_.between(50 * ms, 3 * second), [this] {
            say("calm");
            to_robot_.weather = to_client_.weather = Weather();
        });
}

void Life::fault_of_power() {
    say("power off");
    roburoc4_sim_set_power(sim_.get(), 0);
    if (menu_.renumber && dice_.chance(0.5)) {
        const auto tens = static_cast<std::uint16_t>(10 * dice_.between(0, 20));
        for (std::uint16_t i = ROBUROC4_SERVICE_IOCARD; i < ROBUROC4_SERVICE_COUNT; i++)
            robot_.service_ids[i] = static_cast<std::uint16_t>(tens + i);
        if (roburoc4_sim_reconfigure(sim_.get(), &robot_) < 0)
            complain("the simulator refused other ids");
    }
    at(now_us_ + dice_.between(20 * ms, 5 * second), [this] {
        say("power on");
        roburoc4_sim_set_power(sim_.get(), 1);
    });
}

void Life::fault_of_pad() {
    say("pad A down");
    roburoc4_sim_set_pad_button(sim_.get(), ROBUROC4_DI_PAD_A, 1);
    roburoc4_sim_set_pad_axis(sim_.get(), ROBUROC4_AI_PAD_RT,
                              static_cast<float>(dice_.real(-1, 1)));
    roburoc4_sim_set_pad_axis(sim_.get(), ROBUROC4_AI_PAD_LJ_X,
                              static_cast<float>(dice_.real(-1, 1)));
    at(now_us_ + dice_.between(20 * ms, 3 * second), [this] {
        say("pad let go");
        roburoc4_sim_release_pad(sim_.get());
    });
}

void Life::fault_of_estop() {
    const auto which = static_cast<std::uint32_t>(dice_.between(0, 1));
    say("emergency stop");
    roburoc4_sim_set_estop(sim_.get(), which, 1);
    at(now_us_ + dice_.between(100 * ms, 3 * second), [this, which] {
        say("emergency stop released");
        roburoc4_sim_set_estop(sim_.get(), which, 0);
        roburoc4_sim_press_motor_button(sim_.get());
    });
}

void Life::fault_of_clock() {
    static const std::uint64_t sizes[] = {1, 100, 20 * ms, 300 * ms, 2 * second, 3600 * second};
    const std::uint64_t largest = sizes[dice_.between(0, 5)];
    const std::uint64_t size = dice_.between(1, largest);
    stepped_ = true;
    if (dice_.chance(0.5)) {
        offset_us_ += size;
        say("clock ahead", static_cast<double>(size) * 1e-6);
    } else {
        offset_us_ -= std::min(size, client_now());
        say("clock back", static_cast<double>(size) * 1e-6);
    }
}

void Life::foreign_command(std::uint64_t until_us, std::uint64_t period_us) {
    Bytes command(11);
    const bool zero = dice_.chance(0.3);
    const float linear = zero ? 0 : static_cast<float>(dice_.real(-1, 1));
    const float angular = zero ? 0 : static_cast<float>(dice_.real(-1, 1));
    roburoc4_encode_differential_command(command.data(), command.size(),
                                         robot_.service_ids[ROBUROC4_SERVICE_DIFFERENTIAL], linear,
                                         angular);
    roburoc4_sim_receive(sim_.get(), foreign_peer, command.data(), command.size());
    foreign_until_us_ = now_us_ + watchdog_us + robot_slack_us;
    if (now_us_ < until_us)
        at(now_us_ + period_us, [=] { foreign_command(until_us, period_us); });
}

void Life::fault_of_foreigner() {
    say("foreign commander");
    const std::uint64_t until_us = now_us_ + dice_.between(0, 2 * second);
    const std::uint64_t period_us = dice_.between(20 * ms, 200 * ms);
    foreign_command(until_us, period_us);
}

/* A forger has the robot's address, hears what is said on the network, and speaks to the client:
 * with what was said before, that slightly changed, what the client itself said, or noise. */

void Life::remember(const Bytes &datagram) {
    constexpr std::size_t most = 64;
    if (!menu_.spoof)
        return;
    if (overheard_.size() < most)
        overheard_.push_back(datagram);
    else
        overheard_[overheard_next_++ % most] = datagram;
}

void Life::change_byte(Bytes &bytes, std::size_t first, std::size_t last) {
    const auto value = static_cast<std::uint8_t>(dice_.next());
    const std::size_t which = dice_.between(first, last);
    bytes[which] = value;
}

Bytes Life::forged() {
    Bytes bytes(dice_.between(1, 80));
    if (!overheard_.empty() && dice_.chance(0.8)) {
        bytes = overheard_[dice_.between(0, overheard_.size() - 1)];
        const bool status = bytes[0] == ROBUROC4_HEADER_STATUS && bytes.size() >= 11;
        if (dice_.chance(0.3) && status)
            change_byte(bytes, 3, 10);
        else if (dice_.chance(0.3))
            bytes[0] = static_cast<std::uint8_t>(dice_.next());
        else if (dice_.chance(0.5))
            change_byte(bytes, 0, bytes.size() - 1);
        return bytes;
    }
    for (std::uint8_t &byte : bytes)
        byte = static_cast<std::uint8_t>(dice_.next());
    return bytes;
}

void Life::spoof(std::uint64_t until_us) {
    to_client_.forge(forged(), now_us_);
    report_.forged++;
    if (now_us_ < until_us)
        at(now_us_ + dice_.between(ms / 10, 50 * ms), [=] { spoof(until_us); });
}

void Life::next_fault() {
    if (!faults_)
        return;
    at(now_us_ + dice_.between(50 * ms, 3 * second), [this] { next_fault(); });
    switch (dice_.between(0, 9)) {
    case 0:
    case 1:
        if (menu_.weather)
            draw_weather();
        break;
    case 2:
        if (menu_.power)
            fault_of_power();
        break;
    case 3:
        if (menu_.pad)
            fault_of_pad();
        break;
    case 4:
        if (menu_.estop)
            fault_of_estop();
        break;
    case 5:
        if (menu_.clock)
            fault_of_clock();
        break;
    case 6:
        if (menu_.hang) {
            hung_until_us_ = now_us_ + dice_.between(20 * ms, 4 * second);
            say("caller hangs");
        }
        break;
    case 7:
        if (menu_.foreign)
            fault_of_foreigner();
        break;
    case 8:
        if (menu_.spoof) {
            say("forger");
            spoof(now_us_ + dice_.between(0, 3 * second));
        }
        break;
    default:
        if (menu_.bumper) {
            roburoc4_sim_set_bumper(sim_.get(), ROBUROC4_SIM_FRONT, 1);
            at(now_us_ + second,
               [this] { roburoc4_sim_set_bumper(sim_.get(), ROBUROC4_SIM_FRONT, 0); });
        }
        break;
    }
}

/* ------------------------------------------------------------------------ caller and user --- */

void Life::receive_all() {
    while (const auto arrival = to_client_.pop(now_us_)) {
        const std::uint32_t before = client_->state();
        client_->receive(arrival->bytes, arrival->damaged, client_now());
        if (client_->state() != before)
            say("state by receive", before, client_->state());
    }
}

void Life::transmit_all() {
    int count = 0;
    for (Bytes sent; !(sent = client_->poll(client_now())).empty() && fine();) {
        const std::uint64_t latest_us = to_robot_.push(sent, now_us_, dice_);
        remember(sent);
        roburoc4_differential_command command{};
        if (sent.size() == 11 && sent[0] == ROBUROC4_HEADER_STATUS) {
            roburoc4_decode_differential_command(sent.data(), sent.size(), &command);
            say("  speed", command.linear_m_s, command.angular_rad_s);
            if (command.linear_m_s != 0 || command.angular_rad_s != 0)
                arrival_bound_us_ = std::max(arrival_bound_us_, latest_us);
        } else {
            say("  other, action, service", sent[1], sent[2]);
        }
        if (++count > 1000)
            complain("poll_transmit never ends");
    }
    idle_wakes_ = count > 0 ? 0 : idle_wakes_ + 1;
}

std::uint32_t Life::draw_lease() {
    static const std::uint32_t leases[] = {0, 0, 0, 20000, 100000, 250000, 600000, 1000000};
    if (dice_.chance(0.01))
        return dice_.chance(0.5) ? 19999 : 1000001;
    return leases[dice_.between(0, 7)];
}

void Life::draw_target() {
    const auto draw = [&](double span) {
        return dice_.chance(0.05) ? static_cast<float>(dice_.real(-1e6, 1e6))
                                  : static_cast<float>(dice_.real(-span, span));
    };
    linear_ = dice_.chance(0.2) ? 0 : draw(3);
    angular_ = dice_.chance(0.3) ? 0 : draw(7);
}

void Life::push_target() {
    const std::uint32_t lease_us = draw_lease();
    float linear = linear_;
    if (dice_.chance(0.01))
        linear = dice_.chance(0.5) ? std::numeric_limits<float>::quiet_NaN()
                                   : std::numeric_limits<float>::infinity();
    const std::uint64_t grants = client_->totals().grants;
    const roburoc4_result result = client_->drive(linear, angular_, lease_us, client_now());
    say("drive", static_cast<double>(linear), result);
    if (client_->totals().grants > grants)
        grant_bound_us_ = std::max(grant_bound_us_, now_us_ + client_->last_lease_us());
    if (result < 0 && dice_.chance(0.5))
        say("arm", client_->arm(client_now()));
}

void Life::act_oddly() {
    const std::uint64_t now = client_now();
    switch (dice_.between(0, 11)) {
    case 0:
        say("stop");
        if (drives_)
            client_->stop(now);
        break;
    case 1:
        say("disarm");
        client_->disarm(now);
        break;
    case 2:
        client_->arm(now);
        break;
    case 3:
        client_->other(now, [&](roburoc4_client *client) {
            return roburoc4_client_relocalize(client, 1, 2, 3, now);
        });
        break;
    case 4:
        client_->other(now, [&](roburoc4_client *client) {
            return roburoc4_client_set_digital_outputs(client, 0x0E, dice_.next(), now);
        });
        break;
    case 5:
        if (menu_.subscriptions)
            client_->other(now, [&](roburoc4_client *client) {
                const auto service = static_cast<std::uint32_t>(dice_.between(2, 6));
                return dice_.chance(0.2)
                           ? roburoc4_client_unsubscribe(client, service, now)
                           : roburoc4_client_subscribe(
                                 client, service,
                                 static_cast<std::uint32_t>(10 * dice_.between(1, 10)), now);
            });
        break;
    case 6:
        client_->other(now, [&](roburoc4_client *client) {
            return roburoc4_client_set_role_index(client, ROBUROC4_ROLE_OVERRIDE,
                                                  ROBUROC4_INDEX_AUTO, now);
        });
        break;
    case 7:
        act_period_us_ = dice_.between(10 * ms, 100 * ms);
        break;
    case 8:
        if (menu_.silence)
            quiet_until_us_ = now_us_ + dice_.between(50 * ms, 3 * second);
        break;
    case 9:
        if (menu_.restart && dice_.chance(0.3)) {
            say("close");
            client_->close(now);
        }
        break;
    default:
        draw_target();
        break;
    }
}

/** The user: a tick of the program that drives. */
void Life::act() {
    next_act_us_ = now_us_ + act_period_us_;
    if (client_->state() == ROBUROC4_STATE_IDLE) {
        say("start");
        client_->start(client_now());
    }
    if (now_us_ < quiet_until_us_)
        return;
    if (dice_.chance(0.05))
        act_oddly();
    if (dice_.chance(0.1))
        draw_target();
    if (drives_)
        push_target();
}

/** One round of the caller's loop. */
void Life::call() {
    const bool poll_first = dice_.chance(0.2);
    if (poll_first)
        transmit_all();
    receive_all();
    if (faults_ && now_us_ >= next_act_us_)
        act();
    transmit_all();
    if (tick_us_ != 0)
        next_tick_us_ = now_us_ + tick_us_;
    if (idle_wakes_ > 2000)
        complain("the caller spins: 2000 rounds without anything to send");
}

std::uint64_t Life::caller_wakes_us() const {
    if (tick_us_ != 0)
        return std::max(next_tick_us_, hung_until_us_);
    std::uint64_t wake_us = std::min(to_client_.next_us(), faults_ ? next_act_us_ : never_us);
    const std::uint64_t deadline = client_->next_deadline();
    if (deadline != UINT64_MAX) {
        const std::uint64_t left = deadline > client_now() ? deadline - client_now() : 0;
        wake_us = std::min(wake_us, now_us_ + std::min(left, 3600 * second) + lateness_us_);
    }
    return std::max(wake_us, hung_until_us_);
}

/* --------------------------------------------------------------------------- robot and time --- */

void Life::deliver_to_robot() {
    while (const auto arrival = to_robot_.pop(now_us_)) {
        roburoc4_sim_receive(sim_.get(), client_peer, arrival->bytes.data(), arrival->bytes.size());
        if (arrival->damaged) {
            damaged_until_us_ = now_us_ + watchdog_us + robot_slack_us;
            client_->note_damaged_request(arrival->bytes);
        }
    }
}

void Life::judge_robot(const roburoc4_sim_state &state) {
    const bool target = state.target_linear_m_s != 0 || state.target_angular_rad_s != 0;
    report_.robot_moved_cycles += target ? 1 : 0;
    if (!target || state.overridden != 0 || now_us_ < foreign_until_us_ ||
        now_us_ < damaged_until_us_)
        return;
    if (now_us_ > arrival_bound_us_ + watchdog_us + robot_slack_us)
        complain("the robot has a target, but no speed arrived within its watchdog time");
    if (!stepped_ && now_us_ > grant_bound_us_ + longest_delay_us_ + watchdog_us + robot_slack_us)
        complain("the robot has a target later than lease, delay and watchdog after the grant");
    if (report_.monitor)
        complain("the robot of a monitor has a target");
}

void Life::step_robot() {
    roburoc4_sim_advance(sim_.get(), now_us_);
    Bytes bytes(ROBUROC4_SIM_MAX_TRANSMIT);
    std::uint64_t peer = 0;
    roburoc4_result size = 0;
    while ((size = roburoc4_sim_poll_transmit(sim_.get(), &peer, bytes.data(), bytes.size())) > 0) {
        if (peer != client_peer)
            continue;
        const Bytes datagram(bytes.begin(), bytes.begin() + size);
        to_client_.push(datagram, now_us_, dice_);
        remember(datagram);
    }
    roburoc4_sim_state state{};
    state.size = sizeof state;
    roburoc4_sim_snapshot(sim_.get(), &state);
    judge_robot(state);
}

void Life::run_until(std::uint64_t end_us) {
    while (fine() && now_us_ < end_us) {
        const std::uint64_t robot_us = roburoc4_sim_next_deadline(sim_.get());
        const std::uint64_t script_us = script_.empty() ? never_us : script_.begin()->first;
        const std::uint64_t wake_us = caller_wakes_us();
        const std::uint64_t next_us =
            std::min({end_us, robot_us, script_us, wake_us, to_robot_.next_us()});
        now_us_ = std::max(now_us_, next_us);
        while (!script_.empty() && script_.begin()->first <= now_us_) {
            const auto what = std::move(script_.begin()->second);
            script_.erase(script_.begin());
            what();
        }
        deliver_to_robot();
        step_robot();
        if (wake_us <= now_us_ && hung_until_us_ <= now_us_)
            call();
        if (!client_->complaint().empty())
            complain(client_->complaint());
    }
}

/* --------------------------------------------------------------------------------- the end --- */

/** From now on nothing goes wrong, and the user behaves. */
void Life::mend() {
    faults_ = false;
    say("faults end");
    script_.clear();
    hung_until_us_ = quiet_until_us_ = 0;
    for (BadNetwork *way : {&to_robot_, &to_client_}) {
        way->weather = Weather();
        way->clear();
    }
    roburoc4_sim_set_power(sim_.get(), 1);
    roburoc4_sim_release_pad(sim_.get());
    roburoc4_sim_set_bumper(sim_.get(), ROBUROC4_SIM_FRONT, 0);
    roburoc4_sim_set_estop(sim_.get(), ROBUROC4_SIM_ESTOP_LOCAL, 0);
    roburoc4_sim_set_estop(sim_.get(), ROBUROC4_SIM_ESTOP_REMOTE, 0);
    roburoc4_sim_press_motor_button(sim_.get());
    report_.deceived = client_->deceived();
    if (report_.deceived)
        client_->close(client_now()); /* whom it took for the robot was partly noise: start anew */
    if (client_->state() == ROBUROC4_STATE_IDLE)
        client_->start(client_now());
}

/** What the user changed, or a damaged request did. */
void Life::subscribe_again() {
    const std::uint64_t now = client_now();
    for (const std::uint32_t service :
         std::array<std::uint32_t, 2>{ROBUROC4_SERVICE_IOCARD, ROBUROC4_SERVICE_DIFFERENTIAL})
        client_->other(now, [&](roburoc4_client *client) {
            return roburoc4_client_subscribe(client, service, 50, now);
        });
}

/** Ready, armed and moving, each within its bound. */
void Life::come_back() {
    const std::uint64_t since_us = now_us_;
    bool arming = false;
    while (fine() && report_.moving_after_us == 0) {
        run_until(now_us_ + 50 * ms);
        const std::uint64_t now = client_now();
        const std::uint64_t after_us = now_us_ - since_us;
        if (client_->state() == ROBUROC4_STATE_IDLE)
            client_->start(now); /* it was closing when the faults ended */
        if (client_->state() == ROBUROC4_STATE_READY && report_.ready_after_us == 0) {
            report_.ready_after_us = after_us;
            if (menu_.subscriptions || menu_.damage)
                subscribe_again();
        }
        if (report_.ready_after_us == 0 && after_us > ready_bound_us)
            complain("not ready again in time, state " + std::to_string(client_->state()));
        if (report_.monitor && report_.ready_after_us != 0)
            return;
        if (report_.ready_after_us != 0 && !client_->armed()) {
            arming = client_->arm(now) >= 0;
            if (arming && report_.armed_after_us == 0)
                report_.armed_after_us = after_us;
        }
        if (client_->armed()) {
            client_->drive(0.4F, 0.1F, 1000000, now);
            grant_bound_us_ = std::max(grant_bound_us_, now_us_ + second);
        }
        transmit_all();
        roburoc4_sim_state state{};
        state.size = sizeof state;
        roburoc4_sim_snapshot(sim_.get(), &state);
        if (std::fabs(state.true_linear_m_s) > 0.05 && client_->armed())
            report_.moving_after_us = after_us;
        if (after_us > moving_bound_us)
            complain(client_->armed() ? "armed again, but the robot does not move"
                                      : std::string("not armed again in time: ") +
                                            roburoc4_result_text(client_->facts().arm_refusal));
    }
}

/** close() stops the robot and comes to an end. */
void Life::go_home() {
    client_->close(client_now());
    transmit_all();
    run_until(now_us_ + config_.robot_watchdog_ms * ms + config_.drive_period_ms * ms +
              idle_slack_us);
    if (client_->state() != ROBUROC4_STATE_IDLE)
        complain("not idle in time after close()");
    run_until(now_us_ + watchdog_us);
    roburoc4_sim_state state{};
    state.size = sizeof state;
    roburoc4_sim_snapshot(sim_.get(), &state);
    if (state.target_linear_m_s != 0 || state.target_angular_rad_s != 0)
        complain("the robot still has a target after close()");
}

LifeReport Life::run() {
    const std::uint64_t begin_us = now_us_;
    longest_delay_us_ = to_robot_.weather.longest_us();
    client_->start(client_now());
    next_fault();
    run_until(now_us_ + dice_.between(30 * second, 40 * second));
    if (fine())
        mend();
    if (fine())
        come_back();
    if (fine())
        go_home();
    if (!client_->complaint().empty())
        complain(client_->complaint());
    report_.totals = client_->totals();
    report_.virtual_us = now_us_ - begin_us;
    return report_;
}

} // namespace

LifeReport live(std::uint64_t seed, bool trace) {
    return Life(seed, trace).run();
}

} // namespace roburoc4_tests
