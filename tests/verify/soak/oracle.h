/* SPDX-License-Identifier: MIT
 *
 * oracle.h - judges a client from the outside. It is written from docs/SAFETY.md and the wire, by
 * somebody who has not read src/: it sees each datagram in both directions with the true time at
 * which it was made, each call of the application with its result, and what the client reports of
 * itself; and it knows the truth about the robot. Nothing here may be changed because the client's
 * implementation changed: only because a promise did.
 */
#ifndef ROBUROC4_SOAK_ORACLE_H
#define ROBUROC4_SOAK_ORACLE_H

#include "client.h"
#include "override_rule.h"
#include "promises.h"
#include "wire.h"

#include <cstdint>
#include <string>

namespace soak {

/** The true time, and what the client's clock showed. */
struct Moment {
    std::uint64_t true_us = 0;
    std::uint64_t client_us = 0;
};

/** What the oracle may know of the robot beyond the wire. */
struct RobotTruth {
    std::uint16_t differential_id = 0; /* 0: none may be commanded */
    std::uint16_t iocard_id = 0;
    std::int32_t pad_a = -1;      /* the input that really is [A] */
    bool only_texts_tell = false; /* only the texts say which service is which */
    bool literal_ids = false;
    bool slow_texts = false; /* answers with texts take so long that they bound no age */
    bool rounds = false;     /* reports tiny speeds instead of zero */
};

struct Violation {
    bool found = false;
    Promise promise = Promise::count_;
    std::uint64_t true_us = 0;
    std::string what;
};

class Oracle {
  public:
    Oracle(const roburoc4_config &config, const RobotTruth &robot, const Promises &excluded);

    /* calls of the application, with their results */
    void started(Moment now);
    void closed(Moment now);
    void armed(Moment now, std::int32_t result);
    void disarmed(Moment now);
    void drove(Moment now, Speeds speeds, std::uint32_t lease_us, std::int32_t result);
    void stopped(Moment now, std::int32_t result);
    void override_index_set(Moment now, std::int32_t index, std::int32_t result);
    void outputs_set(Moment now);

    /* the wire */
    void sent(Moment now, const Datagram &datagram);
    void received(Moment now, const Datagram &datagram, std::int32_t result);

    /** The client's report; `drained`: after it sent all that was due. */
    void reported(Moment now, const Report &report, bool drained, std::uint64_t next_deadline);

    /* the world */
    void pad_a_changed(bool held, std::uint64_t true_us);
    void motors_changed(bool dead) {
        motors_dead_ = dead;
    }
    /** From now on network, robot and clock have no faults. */
    void calm_from(std::uint64_t true_us) {
        calm_us_ = true_us;
    }

    void violate(Promise promise, std::uint64_t true_us, const std::string &what);
    const Violation &violation() const {
        return violation_;
    }
    /** Nothing more can be judged: a promise was broken, maybe one that is not judged. */
    bool over() const {
        return violation_.found || gave_up_;
    }
    /** The input that may be taken for [A] by what the robot said so far, or -1. */
    int override_index() const {
        return rule_.index();
    }
    std::uint64_t speeds_sent() const {
        return speeds_sent_;
    }
    std::uint64_t armings() const {
        return armings_;
    }

  private:
    struct Lease {
        bool alive = false;
        std::uint64_t granted_us = 0; /* by the client's clock */
        std::uint64_t granted_true_us = 0;
        std::uint64_t length_us = 0;
        Speeds asked;
        bool sent = false; /* the newest target has left */
        Promise end_promise = Promise::speed_needs_lease;
    };
    struct Stop {
        bool active = false;
        std::uint64_t due_us = 0;   /* all in true time */
        std::uint64_t again_us = 0; /* due, or asked for again */
        std::uint64_t due_client_us = 0;
        std::uint32_t zeros = 0;
        std::uint32_t zeros_since_known = 0; /* the service, whose id may be another now */
        std::uint64_t first_zero_us = 0, third_zero_us = 0, last_zero_us = 0;
        bool confirmed = false;     /* by a status made after the first zero */
        bool confirmed_old = false; /* by an older one only */
        std::uint64_t sure_us = 0;  /* when a status made well after the third zero arrived */
    };
    struct Newest {
        bool known = false;
        std::uint64_t made_us = 0;
    };
    struct Limits {
        bool known = false;
        float max_v = 0, min_v = 0, max_w = 0, min_w = 0, width = 0;
        bool valid() const;
    };
    struct Bounds {
        Speeds low, high;
    };
    struct Envelope {
        float low_v = 0, high_v = 0, low_w = 0, high_w = 0;
        void include(Speeds speeds);
        bool contains(Speeds speeds) const;
    };

    void observe(Moment now);
    void end_lease(Promise promise);
    void end_driving(Moment now, Promise promise);
    void disarm(Moment now, Promise promise);
    Promise unarmed_promise() const;
    void begin_stop(Moment now);
    void count_zero(Moment now);
    bool unknown_allowed() const;
    int judged_index() const;
    bool stop_may_end(Moment now) const;
    void end_stop(Moment now, Promise otherwise);
    void request_sent(Moment now);
    void zero_sent(Moment now);
    void speed_sent(Moment now, Speeds speeds);
    void judge_spacing(Moment now, bool zero);
    void judge_value(Moment now, Speeds speeds);
    void judge_turn(Moment now, Speeds asked, Speeds speeds, Speeds low, Speeds high);
    void judge_fresh(Moment now, const char *what);
    void judge_override_report(Moment now, const Report &report);
    void judge_stop_in_time(Moment now, const Report &report);
    void judge_feeding(Moment now);
    void differential_status(Moment now, const Datagram &datagram);
    void watch_other_commander(Moment now, const Datagram &datagram);
    void watch_inhibited(Moment now, const Datagram &datagram);
    void iocard_status(Moment now, const Datagram &datagram);
    void watch_reboot(Moment now, const Datagram &datagram);
    std::uint64_t tolerance_us(Moment now) const;
    Bounds bounds() const;
    bool target_may_be_zero() const;

    roburoc4_config config_;
    RobotTruth robot_;
    Promises excluded_;
    Violation violation_;
    bool gave_up_ = false;

    OverrideRule rule_;
    Limits limits_;
    std::int32_t analog_inputs_ = 0;
    Report report_;
    bool started_ = false, armed_ = false, overridden_ = false, outputs_allowed_ = false,
         known_ = false;
    Promise disarm_promise_ = Promise::nothing_arms_itself;
    Lease lease_;
    Stop stop_;
    bool speed_out_ = false;      /* a speed left since the last stop sequence ended */
    bool stop_requested_ = false; /* by the application, and no zero has left since */
    std::uint64_t stop_requested_us_ = 0, zeros_welcome_us_ = 0, known_us_ = 0;
    bool command_out_ = false, last_command_zero_ = true, clock_changed_ = false;
    std::uint64_t last_command_us_ = 0, last_speed_us_ = 0;
    bool clock_known_ = false;
    Moment last_;
    std::uint64_t started_us_ = 0;

    Newest differential_, iocard_;
    Speeds reported_target_, reported_current_;
    std::uint32_t boot_ = 0;
    std::uint64_t highest_stamp_ = 0;
    int restarted_statuses_ = 0;
    Envelope ours_, ours_before_;
    std::uint64_t envelope_us_ = 0;
    int others_ = 0;
    std::uint64_t still_since_us_ = 0;
    bool still_ = false, motors_dead_ = false;
    bool pad_a_held_ = false;
    std::uint64_t pad_a_us_ = 0;
    std::uint64_t calm_us_ = UINT64_MAX;
    std::uint64_t speeds_sent_ = 0, armings_ = 0;
};

} // namespace soak

#endif
