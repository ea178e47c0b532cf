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

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>

namespace soak {

constexpr std::uint64_t spacing_us = 10000;
constexpr std::uint64_t slack_us = 1000;

inline std::uint64_t milliseconds(std::uint32_t ms) {
    return static_cast<std::uint64_t>(ms) * 1000;
}
inline std::string ms_text(std::uint64_t us) {
    return std::to_string(us / 1000) + " ms";
}
inline std::string speeds_text(Speeds speeds) {
    return "(" + std::to_string(speeds.v) + ", " + std::to_string(speeds.w) + ")";
}

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
    bool own_queues = false; /* then no answer proves how late statuses are */
    bool drifts = false;     /* its clock, by 300 ppm or more */
    bool prompt = true;      /* its statuses come often enough to be fresh */
};

/** What only the simulation sees. */
struct Truth {
    Speeds clients_target; /* that the robot follows */
    Speeds moving;
    std::uint64_t newest_heard_us = 0; /* what the robot received last: when it was sent */
    bool well = false; /* neither robot nor network have a fault, and nobody interferes */
    bool uplink_loses = false;
    std::uint64_t oldest_speed_us = UINT64_MAX; /* on its way to the robot, when it was sent */
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
    void drove(Moment now, Speeds speeds, std::uint32_t lease_us, std::int32_t result);
    void stopped(Moment now, std::int32_t result);
    void paused(Moment now, std::int32_t result);
    void pose_set(Moment now, std::int32_t result);
    void override_index_set(Moment now, std::int32_t index, std::int32_t result);
    void outputs_set(Moment now);

    /* the wire */
    void sent(Moment now, const Datagram &datagram);
    void received(Moment now, const Datagram &datagram, std::int32_t result);

    /** The client's report; `drained`: after it sent all that was due. */
    void reported(Moment now, const Report &report, const Truth &truth, bool drained,
                  std::uint64_t next_deadline);

    /* the world */
    void pad_a_changed(bool held, std::uint64_t true_us);
    /** The robot restarts, or another one takes its place. */
    void robot_changed(const RobotTruth &robot);
    /** The client's machine stood still, or its clock was changed. */
    void disturbed(std::uint64_t true_us) {
        disturbed_us_ = well_since_us_ = true_us;
        commanding_.clear();
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
    /** Whether there was a start of the robot that the client need not have noticed. */
    bool start_is_hidden() const {
        return required_boot_ + 1 < robots_.size();
    }
    std::uint64_t speeds_sent() const {
        return speeds_sent_;
    }
    std::uint64_t armings() const {
        return armings_;
    }
    void reach(Reached what) {
        reached_[static_cast<std::size_t>(what)]++;
    }
    const std::array<std::uint64_t, reached_count> &reached() const {
        return reached_;
    }

  private:
    struct Lease {
        bool alive = false;
        std::uint64_t granted_us = 0; /* by the client's clock */
        std::uint64_t granted_true_us = 0;
        std::uint64_t begun_true_us = 0; /* by the first of a row of grants */
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
        bool confirmed = false;     /* by a status made after the first zero, not under [A] */
        bool confirmed_old = false; /* by another one only */
        bool nameless = false; /* the client was in fixed-id mode: no answer proves an arrival */
        std::uint64_t answered_us = UINT64_MAX; /* a request that was sent after the first zero */
        std::uint64_t sure_us = 0; /* when a status made well after that and the third arrived */
    };
    struct Newest {
        bool known = false;
        std::uint64_t made_us = 0, stamp = 0, received_us = 0, late_us = 0;
        std::uint32_t boot = 0;
    };
    /** An axis that does not follow its target. */
    struct Axis {
        bool off = false, counted = false;
        std::uint64_t since_us = 0; /* and the target is the same since then */
        float target = 0;
        std::uint64_t stamp = 0, still_cycles = 0;
    };
    /** An axis that went along with its target, and then against it. */
    struct Swing {
        float target = 0;
        bool along = false;
        std::uint64_t against_us = 0;
    };
    struct Sent {
        std::uint64_t true_us, client_us;
        Speeds speeds;
    };
    struct Limits {
        bool known = false;
        float max_v = 0, min_v = 0, max_w = 0, min_w = 0, width = 0;
        std::uint32_t boot = 0;
        bool valid() const;
    };
    struct Bounds {
        Speeds low, high;
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
    bool override_is_right() const;
    bool stop_may_end(Moment now) const;
    void end_stop(Moment now, Promise otherwise);
    void request_sent(Moment now, const Datagram &datagram);
    void zero_sent(Moment now);
    void speed_sent(Moment now, Speeds speeds);
    void remember(Moment now, Speeds speeds);
    void judge_spacing(Moment now, bool zero);
    void judge_value(Moment now, Speeds speeds);
    void judge_turn(Moment now, Speeds asked, Speeds speeds, Speeds low, Speeds high);
    void judge_fresh(Moment now, const char *what);
    void judge_override_report(Moment now, const Report &report);
    void judge_stop_in_time(Moment now, const Report &report);
    void judge_feeding(Moment now);
    void judge_ages(Moment now, const Report &report);
    void judge_outcome(Moment now, const Report &before, const Truth &truth);
    void judge_watch(Moment now);
    void judge_uplink(Moment now, const Truth &truth);
    void judge_standing(Moment now, const Truth &truth);
    void judge_disarming(Moment now, const Report &report);
    void judge_pose(Moment now, const Report &report);
    void status(Moment now, const Datagram &datagram);
    void differential_status(Moment now, const Datagram &datagram);
    void watch_target(Moment now, const Datagram &datagram);
    void watch_other_commander(Moment now, const Datagram &datagram);
    void watch_axis(Moment now, const Datagram &datagram, Axis &axis, float target, float current);
    static void watch_swing(Moment now, Swing &swing, float target, float current);
    bool shows_input(const Datagram &datagram, int index) const;
    void iocard_status(Moment now, const Datagram &datagram);
    static double counted_us(const Newest &from, const Datagram &datagram);
    static bool may_be_same_start(const Newest &from, Moment now, const Datagram &datagram);
    bool hides_restarts(Moment now, const Datagram &datagram) const;
    void watch_restart(Moment now, const Datagram &datagram);
    void forget_robot(Moment now);
    bool ours(Speeds target, std::uint64_t since_us) const;
    bool resembles_ours(Speeds target, std::uint64_t since_us) const;
    std::uint64_t tolerance_us(Moment now) const;
    bool ages_are_new(std::uint64_t true_us, int service) const;
    std::uint64_t first_ages_us(Moment now) const;
    Bounds bounds() const;
    bool target_may_be_zero() const;
    bool zeros_welcome(Moment now) const;

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
         known_ = false, role_set_ = false;
    Promise disarm_promise_ = Promise::nothing_arms_itself;
    Lease lease_;
    Stop stop_;
    bool speed_out_ = false;      /* a speed left since the last stop sequence ended */
    bool stop_requested_ = false; /* by the application, and no zero has left since */
    std::uint64_t stop_requested_us_ = 0, zeros_welcome_us_ = 0, known_us_ = 0;
    std::uint64_t stop_reported_us_ = UINT64_MAX;
    bool command_out_ = false, last_command_zero_ = true, clock_changed_ = false;
    std::uint64_t last_command_us_ = 0, last_speed_us_ = 0;
    bool clock_known_ = false;
    Moment last_;
    std::uint64_t started_us_ = 0;

    Newest newest_[5];
    std::uint64_t unproven_us_ = UINT64_MAX; /* of the age of all statuses: see tolerance_us() */
    std::uint64_t unproven_since_us_ = 0, clock_error_us_ = 0;
    std::uint64_t stray_us_ = UINT64_MAX; /* how late the promptest was since a misleading one */
    std::uint64_t answered_us_ = 0;       /* when the newest request was sent that is answered */
    int overtaken_ = 0;                   /* statuses in a row that answers overtook */
    std::uint64_t restart_us_ = 0, changed_us_ = 0;
    std::uint64_t others_us_ = 0; /* when the client last reported another commander */
    Speeds reported_target_, reported_current_;
    std::uint32_t boot_ = 0, required_boot_ = 0;
    std::deque<RobotTruth> robots_; /* by start; those before required_boot_ are forgotten */
    std::uint32_t outputs_boot_ = 0;
    std::uint32_t judged_boot_ = 0; /* whose restart was noticed, or could not be */
    int restarted_statuses_ = 0;
    std::map<std::uint32_t, Newest> last_of_start_; /* since a restart was noticed */
    bool armed_before_restart_ = false;
    std::deque<Sent> sent_; /* speeds, during the last two watchdog times and longer */
    Speeds target_sent_;    /* the newest speed, and since when it has not changed */
    std::uint64_t target_since_us_ = UINT64_MAX, target_seen_us_ = 0; /* none was sent */
    bool target_shown_ = false;                                       /* by the newest status */
    int others_ = 0;
    Axis v_, w_;
    Swing v_swing_, w_swing_;
    bool unconfirmed_ = false; /* a speed left, and no stop was confirmed since */
    std::uint64_t confirmed_us_ = 0;
    bool ended_under_pad_a_ = false;
    bool pad_a_shown_ = false;       /* by the newest status, in whatever state */
    bool clients_pad_shown_ = false; /* by the input that the client takes for it */
    bool pad_a_forgotten_ = false; /* that it was shown, as after a restart that seemed to be one */
    std::uint16_t mixed_service_ = 0; /* to which zeros left while a start was hidden */
    std::uint64_t watch_due_us_ = UINT64_MAX, release_due_us_ = UINT64_MAX, zeros_allowed_us_ = 0;
    std::uint64_t lapse_us_ = UINT64_MAX; /* by the client's clock */
    bool pausing_ = false, ages_known_ = true;
    bool ages_judged_ = true;
    std::uint64_t ages_since_us_[5] = {}; /* since when the client claims to know them */
    std::uint64_t ages_known_of_[5] = {}; /* of so many statuses since then */
    std::uint64_t jumped_us_ = 0;         /* when the client's clock jumped last, or so it seems */
    std::uint32_t last_outcome_ = 0;      /* of the last stop that has ended */
    std::uint64_t last_unconfirmed_us_ = 0; /* up to then, no stop was confirmed */
    /* when it commanded, since what the robot heard last; pauses do not count */
    std::deque<std::pair<std::uint64_t, std::uint64_t>> commanding_;
    std::uint64_t looked_us_ = 0, well_since_us_ = 0, disturbed_us_ = 0, standing_due_us_ = 0;
    bool well_ = false;
    double way_m_ = 0, way_at_pose_ = 0;
    std::uint64_t way_us_ = 0;
    int poses_sent_ = 0;
    std::uint64_t pose_us_ = 0;
    std::uint64_t answer_delay_us_ = 0; /* of the last answer, from the robot */
    bool pad_a_held_ = false;
    std::uint64_t pad_a_us_ = 0;
    std::array<std::uint64_t, reached_count> reached_{};
    std::uint64_t calm_us_ = UINT64_MAX;
    std::uint64_t speeds_sent_ = 0, armings_ = 0;
};

} // namespace soak

#endif
