/* SPDX-License-Identifier: MIT
 *
 * referee.cpp - the referee's books and its judgement of each datagram that leaves the client.
 */
#include "referee.h"
#include "../../support/telegrams.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace roburoc4_tests {

namespace {

constexpr std::uint64_t ms = 1000;
constexpr std::uint64_t spacing_us = ROBUROC4_CYCLE_US;
constexpr int train_zeros = 3;
constexpr std::size_t speed_command_size = 11;
/* Between its wheels; a robot that tells another width turns as one that tells none. */
constexpr double narrowest_m = 0.01F, widest_m = 10;

std::uint16_t word(const Bytes &bytes, std::size_t at) {
    return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}

std::uint64_t cycles_of(const Bytes &status) {
    std::uint64_t cycles = 0;
    for (std::size_t i = 0; i < 8; i++)
        cycles |= static_cast<std::uint64_t>(status[3 + i]) << (8 * i);
    return cycles;
}

/** Which service an id stands for, by its last digit. */
int kind(std::uint16_t id) {
    return id % 10;
}

bool is_zero(float linear, float angular) {
    std::uint32_t bits[2];
    std::memcpy(&bits[0], &linear, 4);
    std::memcpy(&bits[1], &angular, 4);
    return ((bits[0] | bits[1]) & 0x7FFFFFFFU) == 0;
}

/** By its bits, because these tests run under -Ofast as well. */
bool is_finite(float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, 4);
    return (bits & 0x7F800000U) != 0x7F800000U;
}

double between(double value, double low, double high) {
    return std::min(std::max(value, low), high);
}

} // namespace

Referee::Referee(const roburoc4_config &config, const RobotTruth &truth, bool monitor)
    : config_(config), truth_(truth), monitor_(monitor) {
    if (roburoc4_client_init(&client_, sizeof client_, &config) < 0)
        complain(std::string("init refused: ") + roburoc4_config_error(&config));
}

void Referee::complain(const std::string &what) {
    if (!complaint_.empty())
        return;
    char books[256];
    std::snprintf(books, sizeof books,
                  " [client time %.6f s, armed %d, leased %d for %u us since %.6f s, train %d with "
                  "%d zeros, last command %.6f s]",
                  static_cast<double>(now_us_) * 1e-6, armed_, leased_,
                  static_cast<unsigned>(lease_us_), static_cast<double>(granted_us_) * 1e-6, train_,
                  zeros_, static_cast<double>(sent_us_.value_or(0)) * 1e-6);
    complaint_ = what + books;
}

/* ------------------------------------------------------------------------ leaving driving --- */

void Referee::begin_train() {
    train_ = true;
    zeros_ = 0;
    confirmed_ = confirmed_late_ = false;
    spoke_ = false;
    totals_.trains++;
}

void Referee::leave() {
    leased_ = false;
    if (spoke_)
        begin_train();
}

void Referee::lose_arming(std::uint64_t &total) {
    total += armed_ ? 1 : 0;
    armed_ = false;
    leave();
}

void Referee::forget_statuses() {
    differential_us_.reset();
    iocard_us_.reset();
    used_cycles_.fill(std::nullopt);
}

/** Every call that takes the time: a clock that went back is an exit. */
void Referee::begin(std::uint64_t now_us) {
    if (now_us < now_us_) {
        totals_.clock_faults++;
        lose_arming(totals_.disarms);
        differential_us_.reset(); /* their age is not known any more */
        iocard_us_.reset();
        sent_us_.reset(); /* what is due is due at once */
        first_zero_us_ = now_us;
    }
    now_us_ = now_us;
}

bool Referee::lease_lives() const {
    return leased_ && now_us_ - granted_us_ < lease_us_;
}

/** Calls at which the client looks at the time: poll, arm, drive. */
void Referee::tick() {
    if (leased_ && !lease_lives()) {
        totals_.leases_over++;
        leave();
    }
    const std::uint64_t fresh_us = config_.fresh_ms * ms;
    const bool fresh = differential_us_ && now_us_ - *differential_us_ < fresh_us &&
                       (deceived_inputs_ || (iocard_us_ && now_us_ - *iocard_us_ < fresh_us));
    if (armed_ && !fresh)
        lose_arming(totals_.stale);
}

/** Once it has asked for all, a client may find that there is nobody to command. */
void Referee::note_withdrawal() {
    roburoc4_differential_properties properties;
    const std::uint32_t now = state();
    const bool elsewhere =
        differential_id_ &&
        roburoc4_client_service_id(&client_, ROBUROC4_SERVICE_DIFFERENTIAL) != *differential_id_;
    if (now == ROBUROC4_STATE_DISCOVERING && elsewhere)
        doubt_ = true;
    if (now != ROBUROC4_STATE_SUBSCRIBING && now != ROBUROC4_STATE_READY)
        return;
    if (elsewhere)
        train_ = spoke_ = false; /* as far as it knows, another service or none has that id */
    doubt_ = doubt_ || roburoc4_client_differential_properties(&client_, &properties) < 0;
}

void Referee::take_events() {
    const std::uint32_t events = roburoc4_client_take_events(&client_);
    events_ |= events;
    if ((events & ROBUROC4_EVENT_LOST) != 0) {
        totals_.losses++;
        lose_arming(totals_.disarms);
        forget_statuses();
    }
    if ((events & ROBUROC4_EVENT_REBOOT) != 0) {
        totals_.reboots++;
        lose_arming(totals_.disarms);
        forget_statuses();
        if (deceived_services_) { /* what was owed may have gone to whom it took for the service */
            zeros_allowed_ = true;
            stop_waits_ = false;
            misled_ = true;
        }
        deceived_services_ = deceived_inputs_ = false; /* all is read again */
    }
    if ((events & ROBUROC4_EVENT_OTHER_COMMANDER) != 0 && armed_ && facts().other_commander != 0 &&
        (config_.options & ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER) == 0)
        lose_arming(totals_.foreign);
    if ((events & ROBUROC4_EVENT_DISARMED) != 0)
        lose_arming(totals_.disarms);
    note_withdrawal();
    if ((events & ROBUROC4_EVENT_ARMED) != 0 && !arming_call_)
        complain("armed itself without being asked");
}

void Referee::check_facts() {
    const roburoc4_facts now = facts();
    if (now.armed != 0 && !armed_)
        complain("says that it is armed, but it was disarmed");
    if (now.armed == 0 && armed_)
        complain("disarmed without an event");
    if (now.driving != 0 && !lease_lives())
        complain("says that it drives, but the lease is over");
}

void Referee::end() {
    take_events();
    check_facts();
}

/* ------------------------------------------------------------------------------ the calls --- */

roburoc4_result Referee::start(std::uint64_t now_us) {
    const roburoc4_result result = roburoc4_client_start(&client_, now_us);
    if (result >= 0) {
        now_us_ = now_us;
        armed_ = leased_ = spoke_ = train_ = stop_waits_ = zeros_allowed_ = train_anew_ = false;
        deceived_services_ = deceived_inputs_ = deceived_ids_ = false;
        sent_us_.reset();
        forget_statuses();
        listed_.clear();
        differential_id_.reset();
        doubt_ = misled_ = false;
        newest_iocard_cycles_ = 0;
    }
    end();
    return result;
}

roburoc4_result Referee::close(std::uint64_t now_us) {
    if (state() == ROBUROC4_STATE_IDLE)
        return roburoc4_client_close(&client_, now_us);
    begin(now_us);
    lose_arming(totals_.disarms);
    stop_waits_ = false;
    const roburoc4_result result = roburoc4_client_close(&client_, now_us);
    end();
    return result;
}

roburoc4_result Referee::arm(std::uint64_t now_us) {
    const std::uint32_t before = state();
    if (before != ROBUROC4_STATE_IDLE && before != ROBUROC4_STATE_CLOSING) {
        begin(now_us);
        tick();
    }
    const roburoc4_result result = roburoc4_client_arm(&client_, now_us);
    arming_call_ = true;
    take_events();
    if (result >= 0) {
        if (state() != ROBUROC4_STATE_READY)
            complain("armed before it was ready");
        if (!differential_us_ || (!iocard_us_ && !deceived_inputs_))
            complain("armed without statuses");
        if (iocard_us_ && overridden_ && !deceived_inputs_)
            complain("armed while the override was on");
        totals_.armings += armed_ ? 0 : 1;
        armed_ = true;
    }
    arming_call_ = false;
    check_facts();
    return result;
}

roburoc4_result Referee::disarm(std::uint64_t now_us) {
    begin(now_us);
    lose_arming(totals_.disarms);
    const roburoc4_result result = roburoc4_client_disarm(&client_, now_us);
    if (result != ROBUROC4_OK)
        complain("disarm() was refused");
    end();
    return result;
}

roburoc4_result Referee::drive(float linear, float angular, std::uint32_t lease_us,
                               std::uint64_t now_us) {
    if (!is_finite(linear) || !is_finite(angular)) {
        const roburoc4_result result =
            roburoc4_client_drive(&client_, linear, angular, lease_us, now_us);
        if (result != ROBUROC4_ERR_NOT_FINITE)
            complain("NaN or infinity was not refused as such");
        return result;
    }
    const std::uint32_t lease = lease_us == 0 ? config_.lease_ms * 1000U : lease_us;
    if (lease < 20000 || lease > 1000000) {
        const roburoc4_result result =
            roburoc4_client_drive(&client_, linear, angular, lease_us, now_us);
        if (result != ROBUROC4_ERR_ARGUMENT)
            complain("a lease out of range was not refused as such");
        return result;
    }
    begin(now_us);
    tick();
    const roburoc4_result result =
        roburoc4_client_drive(&client_, linear, angular, lease_us, now_us);
    take_events();
    if (result >= 0) {
        if (!armed_)
            complain("drive() was accepted while disarmed");
        totals_.grants++;
        armed_ = true;
        leased_ = true;
        granted_us_ = now_us;
        lease_us_ = lease;
        linear_ = linear;
        angular_ = angular;
    } else if (armed_) {
        complain("drive() was refused while armed");
    }
    check_facts();
    return result;
}

roburoc4_result Referee::stop(std::uint64_t now_us) {
    const std::uint32_t before = state();
    if (before == ROBUROC4_STATE_IDLE || before == ROBUROC4_STATE_CLOSING)
        return roburoc4_client_stop(&client_, now_us);
    begin(now_us);
    leased_ = false;
    totals_.stops++;
    stop_waits_ = !known();
    begin_train();
    const roburoc4_result result = roburoc4_client_stop(&client_, now_us);
    if (result != ROBUROC4_OK)
        complain("stop() was refused");
    end();
    return result;
}

std::uint64_t Referee::next_deadline() const {
    return roburoc4_client_next_deadline(&client_);
}

std::uint32_t Referee::state() const {
    return roburoc4_client_state(&client_);
}

roburoc4_facts Referee::facts() const {
    roburoc4_facts facts{};
    facts.size = sizeof facts;
    roburoc4_client_facts(&client_, now_us_, &facts);
    return facts;
}

/* ---------------------------------------------------------------------- what is received --- */

bool Referee::known() const {
    return differential_id_.has_value() && !doubt_;
}

/** An answer that makes the client doubt that there is a differential service. */
void Referee::note_doubt(const Bytes &datagram, bool damaged) {
    const bool refusal = datagram.size() < 5 || datagram[0] == ROBUROC4_HEADER_ERROR ||
                         datagram[4] != ROBUROC4_ERROR_NONE;
    doubt_ = doubt_ || damaged || (refusal && kind(word(datagram, 2)) == 6);
}

void Referee::note_answer(const Bytes &datagram, bool damaged) {
    note_doubt(datagram, damaged);
    deceived_ids_ = deceived_ids_ || damaged; /* it may believe now that the robot knows any id */
    if (datagram.size() < 5 || datagram[0] == ROBUROC4_HEADER_ERROR || datagram[4] != 0) {
        if (damaged)
            deceived_services_ = deceived_inputs_ = true; /* told that a service is not there */
        return;
    }
    const std::uint16_t target = word(datagram, 2);
    if (damaged) {
        const bool services = datagram[1] == ROBUROC4_ACTION_GET && kind(target) != 6;
        deceived_services_ = deceived_services_ || services || target == 0;
        deceived_inputs_ = deceived_inputs_ || kind(target) == ROBUROC4_SERVICE_IOCARD || services;
    }
    if (datagram[1] != ROBUROC4_ACTION_GET)
        return;
    if (target == ROBUROC4_SERVICE_DIRECTORY) {
        listed_.clear();
        for (std::size_t at = 5; at + 4 <= datagram.size(); at += 4)
            listed_.insert(word(datagram, at + 2));
        if (differential_id_ && listed_.count(*differential_id_) == 0) {
            differential_id_.reset();
            if (spoke_ || (train_ && zeros_ < 3)) { /* owed to whom is found next */
                stop_waits_ = true;
                zeros_ = 0;
            }
            train_ = spoke_ = false;
        }
    } else if (kind(target) == ROBUROC4_SERVICE_DIFFERENTIAL) {
        roburoc4_differential_properties properties;
        if (roburoc4_decode_differential_properties(datagram.data(), datagram.size(),
                                                    &properties) >= 0) {
            limits_ = properties;
            limits_new_ = true;
            differential_id_ = target;
            misled_ = false;
            train_anew_ = train_anew_ || (doubt_ && train_);
            doubt_ = false;
            zeros_allowed_ = zeros_allowed_ || (stop_waits_ && zeros_ > 0);
            if (stop_waits_ && zeros_ == 0)
                begin_train();
            stop_waits_ = false;
        }
    }
}

/** Only the answer with a text does not say what it is about. */
void Referee::note_damaged_request(const Bytes &request) {
    if (request.size() < 4 || request[1] != ROBUROC4_ACTION_QUERY)
        return;
    const std::uint16_t target = word(request, 2);
    const bool service = target == ROBUROC4_SERVICE_DIRECTORY;
    deceived_services_ = deceived_services_ || service;
    deceived_inputs_ = deceived_inputs_ || service || kind(target) == ROBUROC4_SERVICE_IOCARD;
}

bool Referee::shows_override(const Bytes &datagram) const {
    roburoc4_channels status;
    return roburoc4_decode_iocard_status(datagram.data(), datagram.size(), truth_.analog_inputs,
                                         truth_.digital_inputs, &status) >= 0 &&
           digital_at(&status, truth_.override_index) == 1;
}

/** A status that the client used. */
void Referee::note_status(const Bytes &datagram) {
    const std::uint16_t id = word(datagram, 1);
    std::optional<std::uint64_t> &used = used_cycles_[static_cast<std::size_t>(kind(id))];
    if (used && cycles_of(datagram) <= *used && !deceived_services_)
        complain("a status was used that is not newer than the last");
    used = cycles_of(datagram);
    if (kind(id) == ROBUROC4_SERVICE_IOCARD) {
        iocard_us_ = now_us_;
        overridden_ = !deceived_inputs_ && shows_override(datagram);
        if (overridden_) {
            totals_.overrides++;
            lose_arming(totals_.disarms);
        }
    } else if (kind(id) == ROBUROC4_SERVICE_DIFFERENTIAL) {
        differential_us_ = now_us_;
        roburoc4_differential_status status;
        if (roburoc4_decode_differential_status(datagram.data(), datagram.size(), &status) >= 0 &&
            is_zero(status.target_linear_m_s, status.target_angular_rad_s)) {
            const bool believable =
                is_finite(status.current_linear_m_s) && is_finite(status.current_angular_rad_s);
            confirmed_ = confirmed_ || zeros_ > 0;
            confirmed_late_ = confirmed_late_ || (believable && zeros_ >= train_zeros);
        }
    }
}

roburoc4_result Referee::receive(const Bytes &datagram, bool damaged, std::uint64_t now_us) {
    if (state() == ROBUROC4_STATE_IDLE)
        return roburoc4_client_receive(&client_, datagram.data(), datagram.size(), now_us);
    begin(now_us);
    const bool status = datagram.size() >= 11 && datagram[0] == ROBUROC4_HEADER_STATUS;
    const bool iocard = status && kind(word(datagram, 1)) == ROBUROC4_SERVICE_IOCARD;
    const std::uint64_t cycles = status ? cycles_of(datagram) : 0;
    const bool newest = iocard && cycles > newest_iocard_cycles_;

    const roburoc4_result result =
        roburoc4_client_receive(&client_, datagram.data(), datagram.size(), now_us);
    (result >= 0 ? totals_.used : totals_.dropped)++;
    take_events();
    if (result >= 0 && status)
        note_status(datagram);
    if (result >= 0 && !status)
        note_answer(datagram, damaged);
    if (result < 0 && !status)
        doubt_ = doubt_ || (damaged && result != ROBUROC4_ERR_UNMATCHED);
    if (iocard)
        newest_iocard_cycles_ = std::max(newest_iocard_cycles_, cycles);
    if (newest && !damaged && result != ROBUROC4_ERR_UNSUBSCRIBED && !deceived_inputs_ &&
        shows_override(datagram) && facts().armed != 0)
        complain("armed after the newest status of all showed the override");
    check_facts();
    return result;
}

/* -------------------------------------------------------------------------- what is sent --- */

std::array<double, 2> Referee::shaped() const {
    const double v_high = std::min<double>(limits_.max_linear_m_s, config_.max_linear_m_s);
    const double v_low = std::max<double>(limits_.min_linear_m_s, -config_.max_linear_m_s);
    const double w_high = std::min<double>(limits_.max_angular_rad_s, config_.max_angular_rad_s);
    const double w_low = std::max<double>(limits_.min_angular_rad_s, -config_.max_angular_rad_s);
    double v = static_cast<double>(linear_) * config_.scale_linear;
    const double w = static_cast<double>(angular_) * config_.scale_angular;
    const double width = limits_.width_m;
    const bool believable = width >= narrowest_m && width <= widest_m;
    if ((config_.options & ROBUROC4_OPTION_TURN_KEEPING) != 0 && believable) {
        const double outer = std::fabs(w) * width / 2;
        v = between(v, std::min(0.0, v_low + outer), std::max(0.0, v_high - outer));
    }
    return {between(v, v_low, v_high), between(w, w_low, w_high)};
}

bool Referee::is_shaped(float linear, float angular) const {
    const auto wanted = shaped();
    return std::fabs(linear - wanted[0]) <= 1e-4 * (1 + std::fabs(wanted[0])) &&
           std::fabs(angular - wanted[1]) <= 1e-4 * (1 + std::fabs(wanted[1]));
}

/** The first zero interrupts a speed at once; after a zero it waits for the next robot cycle. */
bool Referee::first_zero_owed() const {
    return train_ && zeros_ == 0 &&
           (!sent_us_ || !is_zero(sent_linear_, sent_angular_) ||
            now_us_ - *sent_us_ >= spacing_us);
}

/** Whether the train has done all that it owes. */
bool Referee::train_may_end() const {
    return zeros_ >= train_zeros &&
           (confirmed_ || now_us_ - first_zero_us_ >= config_.robot_watchdog_ms * ms);
}

/** Whether nothing is left that the train could wait for. */
bool Referee::train_must_end() const {
    return zeros_ >= train_zeros &&
           (confirmed_late_ || now_us_ - first_zero_us_ >= config_.robot_watchdog_ms * ms);
}

/** How often the target of a lease is repeated: a short one at half its life. */
std::uint64_t Referee::repeat_us() const {
    return std::min<std::uint64_t>(config_.drive_period_ms * ms, lease_us_ / 2);
}

void Referee::judge_nonzero(float linear, float angular) {
    totals_.speeds++;
    if (monitor_)
        complain("a monitor sent a speed");
    if (!armed_)
        complain("a speed left while disarmed");
    if (!lease_lives())
        complain("a speed left after its lease");
    if (train_ && !train_may_end())
        complain("a speed left before the zero train had ended");
    if (!is_shaped(linear, angular))
        complain("a speed left that is not the last accepted target: " + std::to_string(linear) +
                 " " + std::to_string(angular));
    train_ = zeros_allowed_ = false;
    spoke_ = true;
}

void Referee::judge_zero() {
    totals_.zeros++;
    if (train_) {
        if (zeros_ == 0)
            first_zero_us_ = now_us_;
        zeros_++;
        stop_waits_ = stop_waits_ && !known();
        return;
    }
    if (zeros_allowed_ || deceived_services_ || doubt_)
        return;
    if (monitor_)
        complain("a monitor sent a command");
    if (!armed_ || !lease_lives())
        complain("a zero left that nobody asked for");
    if (!is_shaped(0, 0))
        complain("a zero left instead of the accepted target");
}

void Referee::judge_speed(const Bytes &datagram) {
    roburoc4_differential_command command;
    roburoc4_decode_differential_command(datagram.data(), datagram.size(), &command);
    if (!is_finite(command.linear_m_s) || !is_finite(command.angular_rad_s))
        complain("a speed left that is not finite");
    const bool zero = is_zero(command.linear_m_s, command.angular_rad_s);
    if (!deceived_services_ && !(misled_ && zero) &&
        (!differential_id_ || command.service != *differential_id_ ||
         listed_.count(command.service) == 0))
        complain("a speed command left for service " + std::to_string(command.service) +
                 ", which is not the listed differential service");
    const bool first = first_zero_owed();
    if (!first && sent_us_ && now_us_ - *sent_us_ < spacing_us)
        complain("speed commands nearer than a robot cycle");
    if (train_ && zeros_ > 0 && sent_us_ && !train_may_end() && !train_anew_ &&
        now_us_ - *sent_us_ < config_.drive_period_ms * ms)
        complain("a zero train faster than the drive period");
    train_anew_ = false;
    if (zero)
        judge_zero();
    else
        judge_nonzero(command.linear_m_s, command.angular_rad_s);
    limits_new_ = false;
    sent_us_ = now_us_;
    sent_linear_ = command.linear_m_s;
    sent_angular_ = command.angular_rad_s;
}

void Referee::judge(const Bytes &datagram) {
    if (datagram[0] == ROBUROC4_HEADER_STATUS && datagram.size() == speed_command_size) {
        judge_speed(datagram);
        return;
    }
    if (first_zero_owed() && known() && !deceived_services_)
        complain("other traffic before the first zero");
    if (datagram[0] == ROBUROC4_HEADER_STATUS) {
        const std::uint16_t id = word(datagram, 1);
        if (!deceived_services_ && (kind(id) != ROBUROC4_SERVICE_IOCARD || listed_.count(id) == 0))
            complain("an output command left for service " + std::to_string(id));
    }
}

/** Nothing more leaves at this time: is anything owed? */
void Referee::judge_rest() {
    if (state() == ROBUROC4_STATE_IDLE || !known() || deceived_services_)
        return;
    const std::uint64_t since_us = sent_us_ ? now_us_ - *sent_us_ : UINT64_MAX;
    const std::uint64_t period_us = config_.drive_period_ms * ms;
    if (first_zero_owed())
        complain("the first zero did not leave");
    if (train_ && zeros_ > 0 && !train_may_end() && since_us >= period_us)
        complain("a zero of the train did not leave");
    const bool drives = armed_ && lease_lives() && !train_ && !zeros_allowed_;
    if (drives && since_us >= repeat_us())
        complain("the target is not repeated");
    if (drives && since_us >= spacing_us && !limits_new_ && !is_shaped(sent_linear_, sent_angular_))
        complain("a changed target does not leave");
    judge_deadline();
}

void Referee::judge_deadline() {
    const std::uint64_t deadline = next_deadline();
    const std::uint64_t period_us = config_.drive_period_ms * ms;
    /* a time in the past means: once more, now; but not again and again */
    past_deadlines_ = deadline <= now_us_ ? past_deadlines_ + 1 : 0;
    if (past_deadlines_ > 2)
        complain("the deadline " + std::to_string(deadline) +
                 " us stays in the past: the caller would spin");
    if (train_ && !train_may_end() && sent_us_ &&
        deadline > *sent_us_ + (zeros_ == 0 ? spacing_us : period_us))
        complain("the deadline misses the next zero");
    if (armed_ && lease_lives() && !train_ && !zeros_allowed_ && deadline > granted_us_ + lease_us_)
        complain("the deadline misses the end of the lease");
    if (armed_ && lease_lives() && !train_ && !zeros_allowed_ && sent_us_ &&
        deadline > *sent_us_ + repeat_us())
        complain("the deadline misses the next repetition");
    if (armed_ && differential_us_ && deadline > *differential_us_ + config_.fresh_ms * ms)
        complain("the deadline misses that statuses grow old");
}

Bytes Referee::poll(std::uint64_t now_us) {
    Bytes datagram(ROBUROC4_MAX_TRANSMIT);
    if (state() != ROBUROC4_STATE_IDLE) {
        begin(now_us);
        tick();
        train_ = train_ && !train_must_end();
    }
    const roburoc4_result size =
        roburoc4_client_poll_transmit(&client_, datagram.data(), datagram.size(), now_us);
    if (size < 0)
        complain(std::string("poll_transmit: ") + roburoc4_result_text(size));
    datagram.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    take_events();
    if (!datagram.empty())
        judge(datagram);
    else
        judge_rest();
    check_facts();
    return datagram;
}

} // namespace roburoc4_tests
