/* SPDX-License-Identifier: MIT
 *
 * world.h - a client, a very small robot and the network between them, in virtual time. A World is
 * plain memory without pointers: a copy of it is another history that goes on from here.
 */
#ifndef ROBUROC4_EXPLORE_WORLD_H
#define ROBUROC4_EXPLORE_WORLD_H

#include "faulty.h"
#include "judge.h"

#include <cstdint>

namespace explore {

constexpr std::uint64_t period_us = 50 * ms; /* of statuses, and how long one letter lasts */

/** What can happen in one period of 50 ms. */
struct Letter {
    char letter;
    const char *meaning;
};
extern const Letter letters[];
extern const std::uint32_t letter_count;

/** What the manual leaves open about a robot. */
struct RobotKind {
    const char *name;
    bool resumes;              /* its target comes back when [A] is released, else it is 0 */
    std::uint64_t watchdog_us; /* the client believes that it is that of client_config() */
};
extern const RobotKind robot_kinds[];
extern const std::uint32_t robot_kind_count;

struct Message {
    std::uint64_t due_us, made_us; /* true time */
    std::uint64_t cycles;          /* of a status */
    Speeds target, speed;          /* of a status or command */
    std::uint16_t service, subject;
    std::uint8_t kind, id, action, boot, held, index, reserved[2];
};

struct Robot {
    std::uint64_t boot_us, commanded_us;
    Speeds target, kept;
    std::uint8_t kind, boots, held, motors_off, subscribed, reserved[3];
};

class World {
  public:
    /** Both clocks of a world that begins later show later times; nothing else differs. */
    explicit World(std::uint32_t robot_kind, std::uint64_t later_us = 0);

    /** One period in which this happens. False if a promise was broken: judge().broken. */
    bool step(char letter);

    const Judge &judge() const {
        return judge_;
    }
    Judge &judge() {
        return judge_;
    }
    roburoc4_facts facts() const {
        return client_.facts(client_us());
    }
    /** A hash of all that the future depends on, apart from those 32-bit words of the client that
     *  are marked in `ignored`. */
    std::uint64_t hash(const std::uint8_t *ignored) const;
    roburoc4_client &client() {
        return client_.client;
    }
    /** Everything that can be seen from outside since the world began: datagrams and their times,
     *  results, events, facts. */
    std::uint64_t seen() const {
        return seen_;
    }
    bool trace = false; /* print what happens */

  private:
    enum Kind : std::uint8_t { io_status, differential_status, answer, command, request };
    static constexpr std::uint32_t capacity = 40;

    std::uint64_t client_us() const {
        return true_us_ + skew_us_;
    }
    std::uint64_t cycles(std::uint64_t at_us) const;
    void run_to(std::uint64_t end_us);
    void call_client();
    void pass(const std::uint8_t *bytes, std::size_t size);
    void send(Message message, std::uint64_t delay_us);
    void arrive(const Message &message);
    void make_statuses();
    void downlink(const Message &message);
    void robot_receives(const Message &message);
    void client_receives(const Message &message);
    void watchdog();
    void note(std::uint64_t value);
    void say(const char *format, ...) const;

    Port client_{};
    Judge judge_{};
    Robot robot_{};
    std::uint64_t begin_us_, first_cycle_;
    std::uint64_t true_us_, skew_us_, status_us_; /* the client's clock: true time plus skew */
    std::uint64_t seen_ = 0;
    std::uint8_t uplink_out_ = 0, letter_ = 0, asleep_ = 0;
    std::uint32_t count_ = 0;
    Message messages_[capacity]{}; /* on their way, by time of arrival */
};

} // namespace explore

#endif
