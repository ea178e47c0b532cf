/* SPDX-License-Identifier: MIT
 *
 * robot.h - a member of the family of robots that docs/PROTOCOL.md describes, written from the
 * manual and from that table. It shares nothing with the project's simulator.
 */
#ifndef ROBUROC4_SOAK_ROBOT_H
#define ROBUROC4_SOAK_ROBOT_H

#include "random.h"
#include "wire.h"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <limits>
#include <string>
#include <vector>

namespace soak {

/** How one axis follows its target. */
struct Response {
    double omega = 2.46; /* rad/s; more than 100: at once */
    double damping = 0.79;
    double gain = 1;
};

/** A robot's answers to the questions that the manual leaves open; they never change. */
struct RobotPlan {
    /* services: ids by the manual's order, 0 where the robot has no such service */
    std::uint16_t ids[5] = {2, 3, 4, 5, 6};
    bool type_codes = false;     /* type codes of other robots, else 0 everywhere */
    bool service_texts = true;   /* else the directory's texts are refused */
    std::uint16_t strangers = 0; /* unknown services, listed first */
    bool literal_ids = false;    /* answers every request with id 0x01 */
    bool only_literal = false;   /* and answers no other request */
    std::uint8_t error_shape = 0, error_code = 0; /* as error_header, error_code of the table */
    std::uint8_t surplus = 0;                     /* bytes after a status */
    std::uint8_t replace_mode = 0;

    std::int32_t analog_inputs = 9, analog_outputs = 0, digital_inputs = 22, digital_outputs = 8;
    std::int32_t pad_a = 8;               /* where game pad [A] really is */
    std::vector<std::string> input_texts; /* of the digital inputs */
    std::vector<bool> refused_texts;      /* which of them the robot refuses to give */
    std::vector<bool> unanswered_texts;   /* which of them it never answers */
    bool texts_twice = false;             /* texts and their refusals */
    std::uint64_t answer_us = 1000;       /* how long an answer takes */
    std::uint64_t text_us = 1000;         /* how long a text takes */
    std::int32_t telemeters = 2, reported_distances = 2;

    std::uint8_t refuses_subscriptions = 0; /* bit k: of ids[k] */
    bool ignores_refused = false;           /* which it acknowledges instead, and sends nothing */
    bool keeps_subscriptions = false;       /* over a restart */
    std::uint8_t min_period = 1;            /* cycles */
    bool own_queues = false; /* each service's statuses, and answers, may queue alone */

    float max_v = 2.6F, min_v = -2.6F, max_w = 6.5F, min_w = -6.5F; /* as its properties say */
    bool short_properties = false; /* differential properties of 9 floats */
    float width = 0.68F;

    std::uint64_t watchdog_us = 1000000;
    bool tripped_target_shown = false;
    std::uint8_t pad_keeps_target = 0;
    bool ignored_commands_feed = false, pad_target_hidden = false, commands_need_motors = false;
    bool over_limit_refused = false, start_safe = false;

    Response linear, angular = {2.42, 0.77, 1};
    std::uint64_t dead_time_cycles = 0;
    bool late_targets = false;
    float noise = 0;    /* on reported speeds */
    float rounding = 0; /* of all reported floats: added to or subtracted from them */
    std::uint64_t odometry_cycles = 1;
    bool stamp_measured = false;

    double clock_ppm = 0;          /* its clock is fast by this */
    std::uint64_t first_cycle = 0; /* at power on */

    bool drivable() const;
    /** Its statuses are made often enough to count as fresh. */
    bool prompt(std::uint32_t fresh_ms) const {
        const std::uint64_t stamps = stamp_measured ? odometry_cycles : 1;
        return 20 * std::max<std::uint64_t>(min_period, stamps) + 150 <= fresh_ms;
    }
    /** Sets the texts of the digital inputs; the robot gives all of them. */
    void give_texts(const std::vector<std::string> &texts);
    /** What differs from the default member. */
    std::string text() const;
};

/** A random member; most have few oddities. */
RobotPlan draw_robot(Random &random);

/** Texts like the manual's for a card with `count` digital inputs, with [A] at `pad_a`. Wordings:
 *  0 the manual's, 1 "Gamepad A", 2 "Joystick button A", 3 "A BUTTON (game-pad)",
 *  4 "Button A, game pad", 5 with Latin-1 quotes. */
std::vector<std::string> pad_texts(std::int32_t count, std::int32_t pad_a, int wording);

/** What is wrong with a robot at the moment. */
struct Trouble {
    bool motors_dead = false;
    bool blocked_v = false, blocked_w = false; /* the axis follows no target, only the creeping */
    Speeds creep;                              /* added to what it does */
    bool nan = false;                          /* in its reported speeds */
    bool frozen = false;                       /* reported speeds keep their last values */
    bool any() const {
        return motors_dead || blocked_v || blocked_w || !creep.zero() || nan || frozen;
    }
};

class Robot {
  public:
    Robot(RobotPlan plan, std::uint64_t now_us);

    const RobotPlan &plan() const {
        return plan_;
    }
    std::uint16_t differential_id() const {
        return plan_.ids[differential];
    }
    std::uint32_t boot() const {
        return boot_;
    }

    /* what happens to it */
    void hold_pad_a(bool held, Speeds speeds);
    void cut_motors(bool dead) {
        trouble_.motors_dead = dead;
    }
    void set_trouble(const Trouble &trouble) {
        trouble_ = trouble;
    }
    /** It is off, and then starts as this member, which may be another one, with any count. */
    void reboot(const RobotPlan &plan, std::uint64_t off_us, std::uint64_t now_us);
    void receive(const Datagram &datagram, std::uint64_t now_us, bool from_other_commander);

    /* its true state */
    bool pad_a_held() const {
        return pad_a_held_;
    }
    const Trouble &trouble() const {
        return trouble_;
    }
    Speeds moving() const {
        return {static_cast<float>(v_.speed) + trouble_.creep.v,
                static_cast<float>(w_.speed) + trouble_.creep.w};
    }
    /** The target that it follows, if a command of the client set it; else zero. */
    Speeds clients_target() const;
    /** When the newest of the client's commands and requests that it received was sent; 0 before
     *  the first. A request counts, too: its answer is what the client knows of its uplink. */
    std::uint64_t newest_heard_us() const {
        return newest_heard_us_;
    }
    bool running(std::uint64_t now_us) const {
        return now_us >= started_us_;
    }

    /** True time of the next thing that it does. */
    std::uint64_t next_time() const;
    /** Does what is due, and appends what it sends. */
    void run(std::uint64_t now_us, std::vector<Datagram> &out);

  private:
    struct Answer {
        std::uint64_t due_us;
        Datagram datagram;
    };
    struct Subscription {
        std::uint8_t period = 0; /* cycles; 0: none */
        std::uint64_t since = 0;
    };
    struct Axis {
        double speed = 0, slope = 0;
        void follow(const Response &response, double target);
        void brake() {
            speed *= 0.5;
            slope = 0;
        }
    };
    void tick(std::uint64_t now_us, std::vector<Datagram> &out);
    void move();
    void plan_next_tick();
    void command(const Datagram &datagram, std::uint64_t now_us, bool from_other_commander);
    void answer(Datagram datagram, std::uint64_t due_us, bool text = false);
    void refuse(const Datagram &request, std::uint8_t error, std::uint64_t due_us);
    void get(const Datagram &request, std::uint64_t due_us);
    void query(const Datagram &request, std::uint64_t now_us);
    void subscribe(const Datagram &request, bool on, std::uint64_t due_us);
    Datagram begin_answer(const Datagram &request) const;
    Datagram status(int service);
    Speeds shown_target() const;
    Origin origin(Origin::Kind kind, std::int32_t index = 0) const;
    float rounded(float value) const;
    int service_of(std::uint16_t id) const;

    RobotPlan plan_;
    Random random_;
    std::uint32_t boot_ = 0;
    std::uint64_t started_us_;
    std::uint64_t ticks_ = 0; /* since it started */
    std::uint64_t next_tick_us_ = 0;
    std::uint64_t now_us_ = 0;
    Subscription subscriptions_[5];
    std::vector<Answer> answers_;

    Speeds accepted_;     /* the last command that counts */
    bool others_ = false; /* which another commander sent */
    bool tripped_ = true; /* the watchdog: accepted_ is not obeyed */
    std::uint64_t fed_us_ = 0;
    std::deque<Speeds> dead_time_; /* targets that the motors do not follow yet */
    Speeds goal_, pad_speeds_, measured_;
    std::uint64_t measured_tick_ = 0;
    Axis v_, w_;
    bool pad_a_held_ = false;
    Trouble trouble_;
    std::uint64_t newest_heard_us_ = 0;
};

} // namespace soak

#endif
