/* SPDX-License-Identifier: MIT
 *
 * judge.h - the promises of docs/SAFETY.md and roburoc4.h, judged from outside: from the calls and
 * their results, the datagrams that are sent, and what the robot's statuses really say. It shares
 * no code with the client.
 */
#ifndef ROBUROC4_EXPLORE_JUDGE_H
#define ROBUROC4_EXPLORE_JUDGE_H

#include "roburoc4.h"

#include <cstdint>

namespace explore {

constexpr std::uint64_t ms = 1000;

struct Speeds {
    float linear, angular;
    bool zero() const {
        return linear == 0 && angular == 0;
    }
    bool operator==(const Speeds &other) const {
        return linear == other.linear && angular == other.angular;
    }
};

/** What they say is in promise_text(). */
enum Promise : std::uint8_t {
    none,
    monitor,
    arming,
    lease,
    fed,
    rate,
    latch,
    pausing,
    lapse,
    override_,
    fresh,
    age,
    clock,
    exit_,
    first,
    period,
    three,
    ending,
    belief,
    release,
    watched,
    commander,
    follows,
    uplink,
    events,
    promise_count
};
const char *promise_text(Promise promise);

/** The client's settings: as short as they may be, so that a few periods reach every end. */
roburoc4_config client_config();

class Judge {
  public:
    Promise broken = none;

    void started(std::uint64_t client_us);
    /* Calls and their results. */
    void called(std::uint64_t client_us); /* before any call, with the time that it will get */
    void arm(roburoc4_result result, const roburoc4_facts &before, std::uint64_t true_us);
    void drive(roburoc4_result result, Speeds speeds, std::uint64_t client_us);
    void pause(roburoc4_result result, bool was_armed, bool is_armed, std::uint64_t client_us);
    void stop(roburoc4_result result, bool is_armed);
    /* Statuses that the client used. */
    void io_status(bool held, std::uint64_t made_us, std::uint8_t boot);
    void differential_status(Speeds target, Speeds speed, std::uint64_t made_us, std::uint8_t boot,
                             std::uint64_t true_us);
    /** An answer that the client used: the robot made it then. */
    void answered(std::uint64_t made_us);
    /* Datagrams between before_poll() and after_poll(). */
    void before_poll(std::uint64_t client_us, std::uint64_t true_us);
    void command(Speeds speeds, std::uint64_t client_us, std::uint64_t true_us);
    void other_traffic();
    void after_poll(const roburoc4_facts &facts, std::uint64_t client_us, std::uint64_t true_us);
    void take_events(std::uint32_t events);

  private:
    bool leased(std::uint64_t client_us) const;
    void end_lease() {
        lease_ = 0;
    }
    void require(bool kept, Promise promise) {
        if (!kept && broken == none)
            broken = promise;
    }
    void judge_driving(const roburoc4_facts &facts, std::uint64_t client_us, std::uint64_t true_us);
    void judge_sequence(const roburoc4_facts &facts, std::uint64_t client_us,
                        std::uint64_t true_us);
    void end_sequence(std::uint64_t true_us);
    void forget();

    std::uint8_t armed_ = 0, lease_ = 0, lapsed_ = 0;
    std::uint8_t driven_ = 0, ever_driven_ = 0;    /* a speed left since the last zero; ever */
    std::uint8_t wanted_ = 0, stop_called_ = 0;    /* a zero is due; stop() or pause() ever */
    std::uint8_t sequence_ = 0, zeros_ = 0;        /* a stop sequence runs */
    std::uint8_t confirmed_ = 0, unconfirmed_ = 0; /* this sequence; a speed left since the last */
    /* A status was on time since the client became ready: before, no client can know ages. */
    std::uint8_t settled_ = 0;
    std::uint8_t held_ = 0, watch_ = 0, clock_back_ = 0;
    std::uint8_t first_due_ = 0, polled_ = 0;
    std::uint8_t io_known_ = 0, differential_boot_ = 0;
    std::uint8_t driven_boot_ = 0, others_ = 0;
    std::uint8_t was_armed_ = 0, disarmed_event_due_ = 0, armed_event_due_ = 0;
    std::uint8_t ended_confirmed_ = 0, ended_unconfirmed_ = 0, ended_ = 0;
    std::uint8_t arrived_ = 0; /* by the end of the sequence */
    std::uint8_t not_following_ = 0, unseen_ = 0;
    /* A speed left, and nothing shows that the zero after it arrived. */
    std::uint8_t on_its_way_ = 0;
    Speeds target_{}, sent_{}, speed_{};
    std::uint64_t now_us_ = 0;         /* of the latest call, by the client's clock */
    std::uint64_t clock_steps_us_ = 0; /* back, in all */
    std::uint64_t granted_us_ = 0, command_us_ = 0, unseen_us_ = 0;
    std::uint64_t zero_after_us_ = 0; /* when that zero left, if it has */
    std::uint64_t first_zero_true_us_ = 0, command_true_us_ = 0, io_made_us_ = 0,
                  differential_made_us_ = 0;
};

} // namespace explore

#endif
