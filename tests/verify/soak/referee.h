/* SPDX-License-Identifier: MIT
 *
 * referee.h - a client under supervision. Every call goes through the referee, which keeps books of
 * its own on what was asked, received and sent, and complains as soon as a promise on motion is
 * broken. It never looks into the client's private fields.
 */
#ifndef ROBUROC4_TESTS_REFEREE_H
#define ROBUROC4_TESTS_REFEREE_H

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "hex.h"
#include "roburoc4.h"

namespace roburoc4_tests {

/** What the referee knows of the robot beforehand. In a robot with fault, services are renumbered
 *  by tens: an id's last digit is the manual's. */
struct RobotTruth {
    std::uint32_t analog_inputs = ROBUROC4_AI_COUNT;
    std::uint32_t digital_inputs = ROBUROC4_DI_COUNT;
    std::uint32_t override_index = ROBUROC4_DI_PAD_A;
};

/** How often something happened: to see that a run was not empty. */
struct RefereeTotals {
    std::uint64_t grants = 0, armings = 0;
    std::uint64_t speeds = 0, zeros = 0, trains = 0;
    std::uint64_t leases_over = 0, disarms = 0, stops = 0;
    std::uint64_t overrides = 0, stale = 0, losses = 0, reboots = 0, foreign = 0, clock_faults = 0;
    std::uint64_t used = 0, dropped = 0;
};

class Referee {
  public:
    Referee(const roburoc4_config &config, const RobotTruth &truth, bool monitor);

    /* The client's calls. */
    roburoc4_result start(std::uint64_t now_us);
    roburoc4_result close(std::uint64_t now_us);
    roburoc4_result arm(std::uint64_t now_us);
    roburoc4_result disarm(std::uint64_t now_us);
    roburoc4_result drive(float linear, float angular, std::uint32_t lease_us,
                          std::uint64_t now_us);
    roburoc4_result stop(std::uint64_t now_us);
    /** Any other call that takes the time: call(client) inside. */
    template <class Call> roburoc4_result other(std::uint64_t now_us, Call call) {
        begin(now_us);
        const roburoc4_result result = call(&client_);
        end();
        return result;
    }
    /** `damaged`: the network changed it on its way, or somebody else sent it. */
    roburoc4_result receive(const Bytes &datagram, bool damaged, std::uint64_t now_us);
    /** A request that the network changed came to the robot: the answer is whole, and to something
     *  that nobody asked. */
    void note_damaged_request(const Bytes &request);
    /** The next datagram to send, or an empty one. */
    Bytes poll(std::uint64_t now_us);
    [[nodiscard]] std::uint64_t next_deadline() const;
    [[nodiscard]] std::uint32_t state() const;
    [[nodiscard]] roburoc4_facts facts() const;

    /** Empty while every promise is held; else the first that was broken. */
    [[nodiscard]] const std::string &complaint() const {
        return complaint_;
    }
    [[nodiscard]] const RefereeTotals &totals() const {
        return totals_;
    }
    [[nodiscard]] const roburoc4_client &client() const {
        return client_;
    }
    /** By its own books: the time of the last lease on the client's clock, and its length. */
    [[nodiscard]] std::uint32_t last_lease_us() const {
        return lease_us_;
    }
    [[nodiscard]] bool armed() const {
        return armed_;
    }
    /** What the client was told is wrong in a way that no client could notice: which promises are
     *  not judged any more. */
    [[nodiscard]] bool deceived() const {
        return deceived_services_ || deceived_inputs_ || deceived_ids_;
    }

  private:
    void complain(const std::string &what);
    void begin(std::uint64_t now_us);
    void tick();
    void end();
    void take_events();
    void check_facts();
    void leave();
    void lose_arming(std::uint64_t &total);
    void begin_train();
    void forget_statuses();
    void note_withdrawal();
    void note_doubt(const Bytes &datagram, bool damaged);

    void note_answer(const Bytes &datagram, bool damaged);
    void note_status(const Bytes &datagram);
    [[nodiscard]] bool shows_override(const Bytes &datagram) const;

    void judge(const Bytes &datagram);
    void judge_speed(const Bytes &datagram);
    void judge_nonzero(float linear, float angular);
    void judge_zero();
    void judge_rest();
    void judge_deadline();
    [[nodiscard]] bool lease_lives() const;
    [[nodiscard]] bool first_zero_owed() const;
    [[nodiscard]] bool train_may_end() const;
    [[nodiscard]] bool train_must_end() const;
    [[nodiscard]] std::uint64_t repeat_us() const;
    [[nodiscard]] bool known() const;
    [[nodiscard]] std::array<double, 2> shaped() const;
    [[nodiscard]] bool is_shaped(float linear, float angular) const;

    const roburoc4_config config_;
    const RobotTruth truth_;
    const bool monitor_;
    roburoc4_client client_{};
    std::string complaint_;
    RefereeTotals totals_;
    std::uint64_t now_us_ = 0;
    std::uint32_t events_ = 0;

    /* arming and lease */
    bool armed_ = false;
    bool arming_call_ = false; /* a call that may arm is on its way */
    bool leased_ = false;
    std::uint64_t granted_us_ = 0;
    std::uint32_t lease_us_ = 0;
    float linear_ = 0, angular_ = 0;

    /* what was sent */
    std::optional<std::uint64_t> sent_us_; /* last speed command */
    float sent_linear_ = 0, sent_angular_ = 0;
    bool spoke_ = false; /* a speed left since the last train began */

    /* the zero train */
    bool train_ = false;
    bool stop_waits_ = false;    /* a stop() came when it was in doubt whom to send it to */
    bool train_anew_ = false;    /* its service was in doubt, and is known again */
    bool zeros_allowed_ = false; /* it may, but need not, have kept that stop() for later */
    int zeros_ = 0;
    bool confirmed_ = false;      /* a status showed targets of 0 since the first zero */
    bool confirmed_late_ = false; /* ... since the last that was due */
    std::uint64_t first_zero_us_ = 0;

    /* what was received */
    std::optional<std::uint64_t> differential_us_, iocard_us_;
    std::uint64_t newest_iocard_cycles_ = 0;
    std::array<std::optional<std::uint64_t>, 10> used_cycles_; /* by service, since connected */
    bool overridden_ = false; /* by the last status that was used */
    int past_deadlines_ = 0;
    std::set<std::uint16_t> listed_;
    std::optional<std::uint16_t> differential_id_;
    bool doubt_ = false; /* whether it can be driven: until its properties come again */
    roburoc4_differential_properties limits_{};
    bool limits_new_ = false; /* they count from the next command on */
    bool deceived_services_ = false, deceived_inputs_ = false, deceived_ids_ = false;
    bool misled_ = false; /* before a restart: zeros go on to whom it took for the service */
};

} // namespace roburoc4_tests

#endif
