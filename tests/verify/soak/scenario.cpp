/* SPDX-License-Identifier: MIT */
#include "scenario.h"

#include "world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

namespace soak {

namespace {

constexpr std::uint64_t second = 1000000;

/** How an application behaves: weights of what it does at each of its steps. */
struct Manners {
    double arms = 0, drives = 0, stops = 0, pauses = 0, odd = 0;
    std::uint64_t shortest_us = 5000, longest_us = 120000; /* between its steps */
    bool persists = false;                                 /* drives on although it is refused */
    double keeps = 0.8;                                    /* a target, from step to step */
};

roburoc4_config draw_config(Random &random, const RobotPlan &plan) {
    roburoc4_config config;
    roburoc4_config_init(&config, sizeof config);
    if (random.chance(0.5)) {
        config.lease_ms = static_cast<std::uint32_t>(random.between(40, 1000));
        config.drive_period_ms =
            static_cast<std::uint32_t>(random.between(10, std::min(config.lease_ms / 2, 300U)));
    }
    if (random.chance(0.5))
        config.fresh_ms = static_cast<std::uint32_t>(random.between(200, 1000));
    if (random.chance(0.5))
        config.lost_ms = static_cast<std::uint32_t>(random.between(500, 5000));
    if (random.chance(0.3)) {
        const std::uint16_t periods[] = {10, 20, 50};
        config.period_ms[ROBUROC4_SERVICE_IOCARD] = random.pick(periods);
        config.period_ms[ROBUROC4_SERVICE_DIFFERENTIAL] = random.pick(periods);
    }
    if (random.chance(0.3)) {
        config.max_linear_m_s = static_cast<float>(random.uniform(0.1, 3));
        config.max_angular_rad_s = static_cast<float>(random.uniform(0.1, 7));
    }
    if (random.chance(0.2)) {
        config.scale_linear = static_cast<float>(random.uniform(0.5, 2));
        config.scale_angular = static_cast<float>(random.uniform(0.5, 2));
    }
    if (random.chance(0.2))
        config.options |= ROBUROC4_OPTION_KEEP_CURVATURE;
    if (random.chance(0.1))
        config.options |= ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    if (random.chance(0.1))
        config.options |= ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER;
    if (random.chance(0.05) && plan.pad_a < ROBUROC4_MAX_DIGITAL_INPUTS)
        config.role_index[ROBUROC4_ROLE_OVERRIDE] = static_cast<std::int16_t>(plan.pad_a);
    if (random.chance(0.2))
        config.lapse_disarm_ms = static_cast<std::uint32_t>(random.between(0, 5000));
    if (random.chance(0.5)) /* else it may be wrong */
        config.robot_watchdog_ms = static_cast<std::uint32_t>(plan.watchdog_us / 1000);
    const auto watchdog_ms =
        std::min(config.robot_watchdog_ms, static_cast<std::uint32_t>(plan.watchdog_us / 1000));
    config.drive_period_ms = std::min(config.drive_period_ms, watchdog_ms / 4);
    if (random.chance(0.1)) {
        config.iocard_id = plan.ids[iocard] != 0 ? plan.ids[iocard] : ROBUROC4_ID_AUTO;
        config.differential_id =
            plan.ids[differential] != 0 ? plan.ids[differential] : ROBUROC4_ID_AUTO;
    }
    return config;
}

Manners draw_manners(Random &random) {
    Manners manners;
    switch (random.between(0, 5)) {
    case 0: /* only watches */
        break;
    case 1: /* streams commands whatever the results, and keeps arming */
        manners = {0.2, 0.8, 0.005, 0.005, 0.005, 5000, 60000, true};
        break;
    case 2: /* does everything at random */
        manners = {0.2, 0.5, 0.1, 0.05, 0.15, 1000, 400000, true};
        break;
    case 3: /* drives well */
        manners = {0.05, 0.9, 0.02, 0.02, 0.01, 20000, 100000, false};
        break;
    default: /* drives evenly */
        manners = {0.02, 0.96, 0.005, 0.005, 0.002, 20000, 60000, false, 0.99};
        break;
    }
    return manners;
}

/** Whether [A] can be found from what this robot reports. */
bool override_can_be_known(const RobotPlan &plan, const roburoc4_config &config) {
    OverrideRule rule;
    rule.user_set(config.role_index[ROBUROC4_ROLE_OVERRIDE]);
    rule.set_counts(plan.analog_inputs, plan.analog_outputs, plan.digital_inputs,
                    plan.digital_outputs);
    for (std::size_t i = 0; i < plan.input_texts.size(); i++) {
        const auto index = static_cast<std::int32_t>(i);
        if (plan.refused_texts[i])
            rule.text_refused(index);
        else if (!plan.unanswered_texts[i])
            rule.text_read(index, plan.input_texts[i]);
    }
    if (rule.doubtful() && config.role_index[ROBUROC4_ROLE_OVERRIDE] < 0)
        return false;
    /* a card with more inputs than the client stores is one for the user's role_index */
    if (plan.digital_inputs > ROBUROC4_MAX_DIGITAL_INPUTS &&
        config.role_index[ROBUROC4_ROLE_OVERRIDE] < 0)
        return false;
    /* where all answers have one id, texts count only where they agree with the manual's table */
    const std::int32_t table = plan.digital_inputs == 23 ? 9 : 8;
    if (plan.literal_ids && config.role_index[ROBUROC4_ROLE_OVERRIDE] < 0 &&
        (rule.index() != table || plan.digital_inputs > 23 || plan.analog_inputs != 9))
        return false;
    return rule.index() >= 0 && rule.index() < ROBUROC4_MAX_DIGITAL_INPUTS && plan.text_us < second;
}

class Scenario {
  public:
    Scenario(std::uint64_t seed, Client &client, const Promises &excluded, bool trace)
        : random_(seed), plan_(draw_robot(random_)), config_(draw_config(random_, plan_)),
          manners_(draw_manners(random_)), restarts_often_(seed % 10 == 0),
          pulses_(seed % 10 == 1 && manners_.drives > 0), pulse_random_(~seed),
          world_(plan_, config_, client, excluded, seed) {
        world_.trace(trace);
        if (trace)
            print();
    }

    Outcome run(std::uint64_t seed) {
        const std::uint64_t begin_us = world_.now_us();
        const bool long_run = random_.chance(0.02);
        const std::uint64_t end_us =
            begin_us + (long_run ? 1200 : random_.between(60, 150)) * second;
        world_.start();
        if (random_.chance(0.1))
            world_.stop();
        next_mishap_us_ = begin_us + random_.between(1, 8) * second;
        while (world_.now_us() < end_us && !violated())
            step();
        end_well();
        Outcome outcome;
        outcome.seed = seed;
        outcome.violation = world_.oracle().violation();
        outcome.lasted_us = world_.now_us() - begin_us;
        outcome.speeds_sent = world_.oracle().speeds_sent();
        outcome.armings = world_.oracle().armings();
        outcome.reached = world_.oracle().reached();
        outcome.friendly = friendly() ? 1 : 0;
        return outcome;
    }

  private:
    void print() const {
        std::printf(
            "lease %u ms, period %u ms, fresh %u ms, lost %u ms, options %u; ceilings %g %g, "
            "scales %g %g\n",
            config_.lease_ms, config_.drive_period_ms, config_.fresh_ms, config_.lost_ms,
            config_.options, static_cast<double>(config_.max_linear_m_s),
            static_cast<double>(config_.max_angular_rad_s),
            static_cast<double>(config_.scale_linear), static_cast<double>(config_.scale_angular));
        std::printf("watchdog_ms %u, lapse %u ms\nmember:%s\n", config_.robot_watchdog_ms,
                    config_.lapse_disarm_ms, plan_.text().c_str());
        std::printf("limits v %g to %g, w %g to %g, width %g\n", static_cast<double>(plan_.min_v),
                    static_cast<double>(plan_.max_v), static_cast<double>(plan_.min_w),
                    static_cast<double>(plan_.max_w), static_cast<double>(plan_.width));
        for (std::size_t i = 0; i < plan_.input_texts.size(); i++)
            std::printf("  input %zu: %s%s%s\n", i, plan_.input_texts[i].c_str(),
                        plan_.refused_texts[i] ? " (refused)" : "",
                        plan_.unanswered_texts[i] ? " (unanswered)" : "");
    }

    bool violated() {
        return world_.oracle().over();
    }

    bool friendly() const {
        return plan_.drivable() && plan_.prompt(config_.fresh_ms) &&
               override_can_be_known(plan_, config_);
    }

    void step() {
        world_.run_for(random_.between(manners_.shortest_us, manners_.longest_us));
        if (violated())
            return;
        continue_mishap();
        if (world_.now_us() >= next_mishap_us_) {
            begin_mishap();
            next_mishap_us_ = world_.now_us() + random_.between(500, 8000) * 1000;
        }
        act();
    }

    /* ------------------------------------------------------------------------ the application */

    void act() {
        double draw = random_.unit();
        if (pulses_ && world_.report().armed)
            pulse();
        else if ((draw -= manners_.arms) < 0) {
            armed_ = world_.arm() >= 0;
        } else if ((draw -= manners_.drives) < 0) {
            if (world_.report().armed || manners_.persists) {
                const Speeds target = next_target();
                world_.drive(target, draw_lease());
            } else {
                world_.arm();
            }
        } else if ((draw -= manners_.stops) < 0) {
            world_.stop();
        } else if ((draw -= manners_.pauses) < 0) {
            world_.pause();
        } else if ((draw -= manners_.odd) < 0) {
            act_oddly();
        }
    }

    void pulse() {
        if (world_.now_us() >= pulse_until_us_) {
            driving_ = !driving_;
            pulse_until_us_ =
                world_.now_us() + pulse_random_.between(30, driving_ ? 400 : 1100) * 1000;
            if (!driving_)
                world_.pause();
        }
        if (driving_)
            world_.drive(next_target(), 0);
    }

    Speeds next_target() {
        if (random_.chance(manners_.keeps)) /* most programs keep a target for a while */
            return target_;
        target_ = {static_cast<float>(random_.uniform(-1.2, 1.2)),
                   static_cast<float>(random_.uniform(-2, 2))};
        if (random_.chance(0.3)) { /* small, or on one axis */
            float &axis = random_.chance(0.5) ? target_.v : target_.w;
            axis *= random_.chance(0.5) ? 0.0F : 0.1F;
        }
        if (random_.chance(0.1))
            target_ = {};
        if (random_.chance(0.02))
            target_ = {static_cast<float>(random_.uniform(-20, 20)),
                       static_cast<float>(random_.uniform(-50, 50))};
        if (random_.chance(0.02))
            return {std::numeric_limits<float>::quiet_NaN(), 0};
        if (random_.chance(0.01))
            return {0, -std::numeric_limits<float>::infinity()};
        return target_;
    }

    std::uint32_t draw_lease() {
        if (random_.chance(0.9))
            return 0;
        if (random_.chance(0.1))
            return static_cast<std::uint32_t>(random_.between(1000001, 100000000));
        return static_cast<std::uint32_t>(random_.between(1000, 1000000));
    }

    void set_override_index(std::int32_t index) {
        world_.set_override_index(index);
        config_.role_index[ROBUROC4_ROLE_OVERRIDE] = static_cast<std::int16_t>(index);
    }

    void subscribe(std::uint32_t service) {
        world_.subscribe(service, static_cast<std::uint32_t>(10 * random_.between(1, 10)));
    }

    void act_oddly() {
        switch (random_.between(0, 6)) {
        case 0:
            set_override_index(random_.chance(0.5) ? -1 : plan_.pad_a);
            break;
        case 1:
            world_.set_outputs(2, random_.next());
            break;
        case 2:
            world_.relocalize();
            break;
        case 3:
            subscribe(random_.chance(0.5) ? ROBUROC4_SERVICE_TELEMETER
                                          : ROBUROC4_SERVICE_DIFFERENTIAL);
            break;
        case 4:
            world_.close();
            world_.run_for(random_.between(0, 3000000));
            if (world_.report().state == ROBUROC4_STATE_IDLE)
                world_.start();
            break;
        case 5:
            world_.stop();
            world_.stop();
            break;
        default:
            world_.freeze(random_.between(1000, 2000000));
            break;
        }
        if (world_.report().state == ROBUROC4_STATE_IDLE)
            world_.start();
    }

    /* ----------------------------------------------------------------------------- mishaps */

    Weather weather() {
        return draw_weather(random_, plan_.own_queues);
    }

    void change_both_directions() {
        const Weather to_robot = weather();
        world_.set_weather(to_robot, weather());
    }

    void begin_mishap() {
        if (restarts_often_ && random_.chance(0.5)) {
            restart();
            return;
        }
        const Speeds pad = {static_cast<float>(random_.uniform(-1, 1)),
                            static_cast<float>(random_.uniform(-1, 1))};
        switch (random_.between(0, 14)) {
        case 0:
        case 1:
            change_both_directions();
            break;
        case 2:
            world_.set_weather(weather(), Weather());
            break;
        case 3:
            world_.set_weather(Weather(), weather());
            break;
        case 4:
        case 5:
            world_.set_weather(Weather(), Weather());
            break;
        case 6:
        case 7:
            world_.hold_pad_a(true, random_.chance(0.5) ? Speeds() : pad);
            pad_until_us_ =
                world_.now_us() + random_.between(50, random_.chance(0.5) ? 1000 : 5000) * 1000;
            break;
        case 8:
        case 9:
            begin_trouble();
            break;
        case 10:
            if (random_.chance(0.5))
                restart();
            break;
        case 11:
            others_ = {static_cast<float>(random_.uniform(-2.5, 2.5)),
                       static_cast<float>(random_.uniform(-5, 5))};
            if (random_.chance(0.5))
                others_ = {target_.v * 0.7F, target_.w * 0.7F};
            others_until_us_ = world_.now_us() + random_.between(50, 3000) * 1000;
            break;
        case 12:
            step_clock();
            break;
        case 13:
            pose_until_us_ = world_.now_us() + random_.between(100, 3000) * 1000;
            change_both_directions();
            world_.relocalize();
            break;
        default:
            world_.freeze(random_.between(1000, 3000000));
            break;
        }
    }

    void begin_trouble() {
        Trouble trouble;
        switch (random_.between(0, 6)) {
        case 0:
        case 1:
            trouble.motors_dead = true;
            break;
        case 2:
            trouble.blocked_v = true;
            break;
        case 3:
            trouble.blocked_w = true;
            break;
        case 4: /* it runs away, or the wrong way */
            trouble.blocked_v = random_.chance(0.7);
            trouble.blocked_w = random_.chance(0.3);
            trouble.creep = {static_cast<float>(random_.uniform(-2.6, 2.6)),
                             static_cast<float>(random_.uniform(-3, 3))};
            break;
        case 5:
            trouble.nan = true;
            break;
        default:
            trouble.frozen = true;
            break;
        }
        world_.set_trouble(trouble);
        trouble_until_us_ = world_.now_us() + random_.between(100, 10000) * 1000;
    }

    /** The user set what another robot may have elsewhere. */
    bool user_told() const {
        return config_.role_index[ROBUROC4_ROLE_OVERRIDE] >= 0 || config_.iocard_id >= 0 ||
               config_.differential_id >= 0;
    }

    /* Often in an outage of the link; and it may be another robot that answers afterwards. */
    void restart() {
        if (random_.chance(0.6)) {
            Weather dark;
            dark.dark = true;
            world_.set_weather(dark, dark);
            dark_until_us_ = world_.now_us() + random_.between(100, 40000) * 1000;
        }
        RobotPlan plan = plan_;
        if (random_.chance(restarts_often_ ? 0.8 : 0.3) && !user_told()) {
            plan = draw_robot(random_);
            plan.own_queues = plan_.own_queues;
            plan.literal_ids = plan_.literal_ids;
            plan.only_literal = plan_.only_literal;
            plan.type_codes = plan_.type_codes || plan_.literal_ids;
            world_.oracle().reach(Reached::another_robot);
        }
        const std::uint64_t counts[] = {0, 1000, 10000, 100000000};
        plan.first_cycle = random_.between(0, random_.pick(counts));
        plan_ = plan;
        world_.reboot(plan, random_.between(50, 4000) * 1000);
    }

    void step_clock() {
        const std::uint64_t sizes[] = {1, 1000, 50000, 300000, 5000000, 3600 * second};
        const auto size = static_cast<std::int64_t>(random_.between(1, random_.pick(sizes)));
        world_.step_clock(random_.chance(0.5) ? -size : size);
    }

    void continue_mishap() {
        const std::uint64_t now = world_.now_us();
        if (pad_until_us_ != 0 && now >= pad_until_us_) {
            world_.hold_pad_a(false);
            pad_until_us_ = 0;
        }
        if (trouble_until_us_ != 0 && now >= trouble_until_us_) {
            world_.set_trouble(Trouble());
            trouble_until_us_ = 0;
        }
        if (dark_until_us_ != 0 && now >= dark_until_us_) {
            world_.set_weather(Weather(), Weather());
            dark_until_us_ = 0;
        }
        if (now < pose_until_us_ && random_.chance(0.2))
            world_.relocalize();
        if (now < others_until_us_)
            world_.other_commander(others_);
    }

    /* ------------------------------------------------------------------------------- the end */

    /** The promise that is tested with a robot that cannot be armed. */
    Promise promise_behind(std::int32_t refusal) const {
        if (refusal == ROBUROC4_ERR_OVERRIDE_UNKNOWN)
            return Promise::override_by_texts;
        const bool missing =
            refusal == ROBUROC4_ERR_NO_DIFFERENTIAL || refusal == ROBUROC4_ERR_STALE_IOCARD;
        if (missing && !plan_.type_codes)
            return Promise::service_by_texts;
        if (refusal == ROBUROC4_ERR_MOVING && plan_.rounding > 0)
            return Promise::rounding_is_not_motion;
        return Promise::comes_back;
    }

    void end_well() {
        if (violated())
            return;
        world_.calm();
        if (world_.report().state == ROBUROC4_STATE_CLOSING)
            world_.run_for(70 * second);
        if (world_.report().state == ROBUROC4_STATE_IDLE)
            world_.start();
        world_.stop();
        const std::uint64_t calm_us = world_.now_us();
        /* slow texts, one at a time */
        const bool slow = plan_.text_us > 500000;
        const std::uint64_t patience_us = (!friendly() ? 5 : slow ? 180 : 90) * second;
        std::int32_t result = -1;
        while (!violated() && result < 0 && world_.now_us() - calm_us < patience_us) {
            if (result == ROBUROC4_ERR_OTHER_COMMANDER ||
                result == ROBUROC4_ERR_MOVING) { /* a target that it left behind */
                world_.stop();
                world_.run_for(second);
            }
            world_.run_for(50000);
            result = world_.arm();
        }
        if (violated() || !friendly())
            return;
        if (result < 0) {
            if (world_.oracle().start_is_hidden())
                return; /* it may go by the texts of the robot before */
            const Promise broken = promise_behind(result);
            world_.oracle().violate(broken, world_.now_us(),
                                    "arm() is still refused although all is well: " +
                                        std::string(roburoc4_result_text(result)));
            return;
        }
        drive_in_the_end();
    }

    /* Drives for 8 s, each way. The client may have found out something meanwhile (a text that came
     * late) that makes it look again: then it must be armed again. For a minute after a jump of its
     * clock, ages may seem so high that it is disarmed now and then. */
    void drive_in_the_end() {
        const std::uint64_t interval_us = std::min<std::uint64_t>(config_.lease_ms * 500, 50000);
        Speeds target = {plan_.max_v > 0 ? 0.3F : 0.0F, plan_.max_w > 0 ? 0.3F : 0.0F};
        const std::uint64_t begin_us = world_.now_us();
        std::uint64_t driven_us = 0;
        const std::uint64_t before = world_.oracle().speeds_sent();
        std::int32_t result = 0;
        while (driven_us < 8 * second && !violated() && world_.now_us() - begin_us < 90 * second) {
            if (driven_us > 4 * second)
                target = {plan_.min_v < -0.1F ? -0.1F : 0.0F, plan_.min_w < -0.5F ? -0.5F : 0.0F};
            result = world_.drive(target);
            if (result < 0) {
                world_.arm();
                driven_us = 0;
            }
            world_.run_for(interval_us);
            driven_us += interval_us;
        }
        /* where all answers have one id, a text that nobody answers delays the proof of a stop */
        const bool drove =
            target.zero() || plan_.literal_ids || world_.oracle().speeds_sent() > before;
        if (!violated() && (result < 0 || !drove))
            world_.oracle().violate(Promise::comes_back, world_.now_us(),
                                    "it is armed and all is well, but it does not drive: " +
                                        std::string(roburoc4_result_text(result)));
        world_.stop();
        world_.run_for(3 * second);
        if (!violated() && !world_.robot().clients_target().zero())
            world_.oracle().violate(Promise::stop_always_sends, world_.now_us(),
                                    "the robot still moves 3 s after stop()");
        world_.close();
        world_.run_for(second);
    }

    Random random_;
    RobotPlan plan_;
    roburoc4_config config_;
    Manners manners_;
    bool restarts_often_; /* and is another robot then, mostly */
    bool pulses_;         /* the application drives and pauses in turn */
    Random pulse_random_; /* so that other seeds draw what they did */
    World world_;
    Speeds target_, others_;
    bool armed_ = false, driving_ = false;
    std::uint64_t pulse_until_us_ = 0;
    std::uint64_t next_mishap_us_ = 0, pad_until_us_ = 0, trouble_until_us_ = 0, dark_until_us_ = 0,
                  pose_until_us_ = 0, others_until_us_ = 0;
};

} // namespace

Outcome run_scenario(std::uint64_t seed, Client &client, const Promises &excluded, bool trace) {
    Scenario scenario(seed, client, excluded, trace);
    return scenario.run(seed);
}

} // namespace soak
