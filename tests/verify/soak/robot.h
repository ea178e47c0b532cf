/* SPDX-License-Identifier: MIT
 *
 * robot.h - a small robot written from the manual and from the notes on what the manual leaves
 * open. It shares nothing with the project's simulator, and it is unpleasant on request: other ids,
 * other texts, other counts, refusals, rounding, restarts.
 */
#ifndef ROBUROC4_SOAK_ROBOT_H
#define ROBUROC4_SOAK_ROBOT_H

#include "random.h"
#include "wire.h"

#include <cstdint>
#include <string>
#include <vector>

namespace soak {

/** Properties of a robot, which never change. */
struct RobotPlan {
    /* directory: ids by the manual's order IOCard, Telemeter, Battery, Localization, Differential;
     * 0 where the robot has no such service */
    std::uint16_t ids[5] = {2, 3, 4, 5, 6};
    bool type_codes = false;     /* type codes of sibling robots, else 0 everywhere */
    bool service_texts = true;   /* else the directory's texts are refused */
    std::uint16_t strangers = 0; /* unknown services, listed first */

    std::int32_t analog_inputs = 9, analog_outputs = 0, digital_inputs = 22, digital_outputs = 8;
    std::int32_t pad_a = 8;                 /* where game pad [A] really is */
    std::vector<std::string> input_texts;   /* of the digital inputs */
    std::vector<bool> refused_texts;        /* which of them the robot refuses to give */
    std::vector<bool> unanswered_texts;     /* which of them it never answers */
    std::uint64_t answer_us = 1000;         /* how long an answer takes */
    std::uint64_t text_us = 1000;           /* how long a text takes */
    bool literal_ids = false;               /* answers every request with id 0x01 */
    bool error_telegrams = false;           /* errors come with header 0x00 */
    std::uint8_t refuses_subscriptions = 0; /* bit k: of ids[k]; still sends nothing */
    bool keeps_subscriptions = false;       /* over a restart */
    bool short_properties = false;          /* differential properties of 9 floats */

    float max_v = 2.6F, min_v = -2.6F, max_w = 6.5F, min_w = -6.5F;
    float width = 0.68F;
    float noise = 0; /* of reported speeds, also of targets that are zero */
    std::uint64_t watchdog_us = 1000000;
    double clock_ppm = 0;          /* its clock is fast by this */
    std::uint64_t first_cycle = 0; /* at power on */
    double response_s = 0.3;

    bool drivable() const;
    /** Sets the texts of the digital inputs; the robot gives all of them. */
    void give_texts(const std::vector<std::string> &texts);
};

/** A random robot; most have few oddities. */
RobotPlan draw_robot(Random &random);

/** Texts like the manual's for a card with `count` digital inputs, with [A] at `pad_a`. Wordings:
 *  0 the manual's, 1 "Gamepad A", 2 "Joystick button A", 3 "A BUTTON (game-pad)". */
std::vector<std::string> pad_texts(std::int32_t count, std::int32_t pad_a, int wording);

class Robot {
  public:
    Robot(RobotPlan plan, std::uint64_t now_us);

    const RobotPlan &plan() const {
        return plan_;
    }
    std::uint16_t differential_id() const {
        return plan_.ids[4];
    }
    std::uint16_t iocard_id() const {
        return plan_.ids[0];
    }
    std::uint32_t boot() const {
        return boot_;
    }

    /* what happens to it */
    void hold_pad_a(bool held, Speeds speeds);
    void cut_motors(bool dead) {
        motors_dead_ = dead;
    }
    void delay_texts(std::uint64_t us) {
        plan_.text_us = us;
    }
    void reboot(std::uint64_t off_us, std::uint64_t now_us);
    void receive(const Datagram &datagram, std::uint64_t now_us, bool from_other_commander);

    /* its true state */
    bool pad_a_held() const {
        return pad_a_held_;
    }
    bool motors_dead() const {
        return motors_dead_;
    }
    Speeds moving() const {
        return current_;
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
    void tick(std::uint64_t now_us, std::vector<Datagram> &out);
    void plan_next_tick();
    void command(const Datagram &datagram, std::uint64_t now_us, bool from_other_commander);
    void answer(Datagram datagram, std::uint64_t due_us);
    void refuse(const Datagram &request, std::uint8_t error, std::uint64_t due_us);
    void get(const Datagram &request, std::uint64_t due_us);
    void query(const Datagram &request, std::uint64_t now_us);
    void subscribe(const Datagram &request, bool on, std::uint64_t due_us);
    Datagram begin_answer(const Datagram &request) const;
    Datagram status(int service) const;
    Origin origin(Origin::Kind kind, std::uint64_t made_us, std::int32_t index = 0) const;
    float noisy(float value) const;
    int service_of(std::uint16_t id) const;

    RobotPlan plan_;
    std::uint32_t boot_ = 0;
    std::uint64_t started_us_;
    std::uint64_t ticks_ = 0; /* since it started */
    std::uint64_t next_tick_us_ = 0;
    std::uint64_t now_us_ = 0;
    Subscription subscriptions_[5];
    std::vector<Answer> answers_;
    Speeds target_, current_, pad_speeds_;
    std::uint64_t commanded_us_ = 0;
    bool pad_a_held_ = false, motors_dead_ = false, others_target_ = false;
};

} // namespace soak

#endif
