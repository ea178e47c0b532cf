/* SPDX-License-Identifier: MIT */
#include "judge.h"

namespace explore {

namespace {

constexpr std::uint64_t lease_us = 100 * ms, command_period_us = 50 * ms, watchdog_us = 200 * ms,
                        fresh_us = 150 * ms, lapse_us = 150 * ms, cycle_us = 10 * ms,
                        on_time_us = 10 * ms, uplink_us = 500 * ms;
constexpr std::uint8_t not_following_statuses = 33; /* in 1.6 s */

/** Time since then; 0 if the clock went back to before it. */
std::uint64_t since(std::uint64_t then_us, std::uint64_t now_us) {
    return now_us > then_us ? now_us - then_us : 0;
}

} // namespace

roburoc4_config client_config() {
    roburoc4_config config{};
    roburoc4_config_init(&config, sizeof config);
    config.subscriptions = 1U << ROBUROC4_SERVICE_IOCARD | 1U << ROBUROC4_SERVICE_DIFFERENTIAL;
    config.lost_ms = 300;
    config.fresh_ms = fresh_us / ms;
    config.drive_period_ms = command_period_us / ms;
    config.lease_ms = lease_us / ms;
    config.robot_watchdog_ms = watchdog_us / ms;
    config.lapse_disarm_ms = lapse_us / ms;
    return config;
}

const char *promise_text(Promise promise) {
    switch (promise) {
    case none:
        return "none";
    case monitor:
        return "a client that neither drove nor was told to stop sends no command";
    case arming:
        return "it is armed only since an arm() that nothing spoke against";
    case lease:
        return "a speed leaves only within its lease, as it was asked for";
    case fed:
        return "within the lease the command is repeated at its period";
    case rate:
        return "commands are a robot cycle apart";
    case latch:
        return "stop() disarms";
    case pausing:
        return "pause() keeps armed";
    case lapse:
        return "a lease that ran out by itself disarms after lapse_disarm_ms, and only such a one";
    case override_:
        return "a status that shows [A] disarms";
    case fresh:
        return "statuses that are too old disarm";
    case age:
        return "a reported age is never less than the true one";
    case clock:
        return "a step back of the clock disarms";
    case exit_:
        return "every exit from driving sends a zero at once";
    case first:
        return "zeros leave before all other traffic";
    case period:
        return "a stop sequence sends a zero in each period";
    case three:
        return "a stop sequence has at least three zeros";
    case ending:
        return "a stop sequence ends by a confirmation or after the watchdog's time";
    case belief:
        return "a stop is called confirmed only if the robot showed it, with [A] released, and "
               "answered since the first zero";
    case release:
        return "when [A] is released after an unconfirmed stop, a new stop sequence begins";
    case watched:
        return "a target of ours without a lease is answered by zeros";
    case commander:
        return "three statuses with another commander's target disarm";
    case follows:
        return "a robot that does not follow is disarmed";
    case uplink:
        return "commands that do not arrive disarm";
    case events:
        return "each change is reported by its event";
    case promise_count:
        break;
    }
    return "";
}

void Judge::started(std::uint64_t client_us) {
    now_us_ = client_us;
}

bool Judge::leased(std::uint64_t client_us) const {
    return lease_ != 0 && client_us >= granted_us_ && client_us - granted_us_ < lease_us;
}

/* ------------------------------------------------------------------------------------ calls */

void Judge::called(std::uint64_t client_us) {
    if (client_us < now_us_) {
        clock_back_ = 1;
        clock_steps_us_ += now_us_ - client_us;
        command_true_us_ = 0; /* a zero may follow a zero at once */
        end_lease();
    }
    now_us_ = client_us;
    if (lease_ != 0 && !leased(client_us)) {
        end_lease();
        lapsed_ = 1;
    }
}

void Judge::arm(roburoc4_result result, const roburoc4_facts &before, std::uint64_t true_us) {
    if (result < 0)
        return;
    if (before.armed == 0)
        armed_event_due_ = 1;
    armed_ = 1;
    lapsed_ = 0; /* the program is awake */
    require(io_known_ != 0 && held_ == 0, arming);
    require(settled_ == 0 || (since(io_made_us_ + clock_steps_us_, true_us) <= fresh_us &&
                              since(differential_made_us_ + clock_steps_us_, true_us) <= fresh_us),
            arming);
    require(before.armed != 0 || speed_.zero() || speed_ == sent_, arming);
}

void Judge::drive(roburoc4_result result, Speeds speeds, std::uint64_t client_us) {
    if (result < 0)
        return;
    require(armed_ != 0, arming);
    if (lease_ == 0 || !(target_ == speeds))
        unseen_ = not_following_ = 0;
    lease_ = 1;
    lapsed_ = 0;
    granted_us_ = client_us;
    target_ = speeds;
}

void Judge::pause(roburoc4_result result, bool was_armed, bool is_armed, std::uint64_t client_us) {
    const bool late = lapsed_ != 0 && since(granted_us_ + lease_us, client_us) >= lapse_us;
    require(result >= 0 && (is_armed || !was_armed || clock_back_ != 0 || late), pausing);
    require(!is_armed || !late, lapse);
    end_lease();
    lapsed_ = late ? 1 : 0;
    wanted_ = stop_called_ = 1;
}

void Judge::stop(roburoc4_result result, bool is_armed) {
    require(result >= 0 && !is_armed, latch);
    end_lease();
    lapsed_ = 0;
    armed_ = 0;
    wanted_ = stop_called_ = 1;
}

/* --------------------------------------------------------------------------------- statuses */

void Judge::io_status(bool held, std::uint64_t made_us, std::uint8_t boot) {
    if (held_ != 0 && !held && unconfirmed_ != 0 && driven_boot_ == boot) {
        /* Zeros were ignored until now. */
        sequence_ = zeros_ = 0;
        wanted_ = 1;
    }
    held_ = held ? 1 : 0;
    io_known_ = 1;
    io_made_us_ = made_us;
}

void Judge::differential_status(Speeds target, Speeds speed, std::uint64_t made_us,
                                std::uint8_t boot, std::uint64_t true_us) {
    differential_boot_ = boot;
    differential_made_us_ = made_us;
    speed_ = speed;
    if (true_us - made_us <= on_time_us && io_made_us_ == made_us)
        settled_ = 1;
    if (sequence_ != 0 && held_ == 0 && made_us >= first_zero_true_us_)
        confirmed_ = target.zero() ? 1 : 0;
    const bool ours = ever_driven_ != 0 && driven_boot_ == boot && target == sent_;
    watch_ = ours && !target.zero() && held_ == 0 && lease_ == 0 && true_us - made_us <= on_time_us;
    if (target == target_)
        unseen_ = 0;
    const bool others = !target.zero() && target == Speeds{0.4F, -0.4F} && held_ == 0;
    others_ = others ? static_cast<std::uint8_t>(others_ + (others_ < 3)) : 0;
    const bool stuck = leased(now_us_) && target == target_ && speed.zero();
    not_following_ = stuck ? static_cast<std::uint8_t>(not_following_ + (not_following_ < 100)) : 0;
}

void Judge::answered(std::uint64_t made_us) {
    if (zero_after_us_ != 0 && made_us >= zero_after_us_)
        on_its_way_ = 0;
}

/* -------------------------------------------------------------------------------- datagrams */

void Judge::before_poll(std::uint64_t client_us, std::uint64_t true_us) {
    called(client_us);
    polled_ = 0;
    first_due_ =
        (wanted_ != 0 && since(command_us_, client_us) >= cycle_us) ||
        (driven_ != 0 && lease_ == 0) ||
        (sequence_ != 0 && since(command_us_, client_us) >= command_period_us &&
         !(zeros_ >= 3 && (confirmed_ != 0 || since(first_zero_true_us_, true_us) >= watchdog_us)));
}

void Judge::other_traffic() {
    require(first_due_ == 0 || polled_ != 0, first);
    polled_ = 1;
}

void Judge::command(Speeds speeds, std::uint64_t client_us, std::uint64_t true_us) {
    polled_ = 1;
    require(ever_driven_ != 0 || stop_called_ != 0 || !speeds.zero(), monitor);
    const bool first_zero = speeds.zero() && driven_ != 0;
    require(first_zero || true_us - command_true_us_ >= cycle_us, rate);
    command_us_ = client_us;
    command_true_us_ = true_us;
    if (speeds.zero()) {
        if (sequence_ == 0) {
            sequence_ = 1;
            zeros_ = 0;
            confirmed_ = 0;
            first_zero_true_us_ = true_us;
            zero_after_us_ = on_its_way_ != 0 ? true_us : 0;
        }
        zeros_ = static_cast<std::uint8_t>(zeros_ + (zeros_ < 3));
        driven_ = wanted_ = 0;
        return;
    }
    require(leased(client_us) && speeds == target_, lease);
    require(armed_ != 0, arming);
    require(held_ == 0, override_);
    if (sequence_ != 0)
        end_sequence(true_us);
    if (unseen_ == 0) {
        unseen_ = 1;
        unseen_us_ = client_us;
    }
    driven_ = ever_driven_ = 1;
    driven_boot_ = differential_boot_;
    sent_ = speeds;
    unconfirmed_ = on_its_way_ = 1;
    zero_after_us_ = 0;
}

void Judge::after_poll(const roburoc4_facts &facts, std::uint64_t client_us,
                       std::uint64_t true_us) {
    judge_driving(facts, client_us, true_us);
    judge_sequence(facts, client_us, true_us);
    if (was_armed_ != 0 && facts.armed == 0)
        disarmed_event_due_ = 1;
    was_armed_ = facts.armed;
    if (facts.armed == 0) {
        end_lease();
        armed_ = lapsed_ = 0;
    }
    forget();
}

/** What no longer matters is cleared, so that more states are equal. */
void Judge::forget() {
    if (lease_ == 0) {
        target_ = Speeds{};
        unseen_ = 0;
        if (lapsed_ == 0)
            granted_us_ = 0;
    }
    if (unseen_ == 0)
        unseen_us_ = 0;
    if (sequence_ == 0)
        first_zero_true_us_ = 0;
    if (on_its_way_ == 0)
        zero_after_us_ = 0;
}

void Judge::judge_driving(const roburoc4_facts &facts, std::uint64_t client_us,
                          std::uint64_t true_us) {
    /* No client can tell how far its clock went back. */
    const std::uint64_t io_age = since(io_made_us_ + clock_steps_us_, true_us),
                        differential_age = since(differential_made_us_ + clock_steps_us_, true_us);
    if (facts.armed != 0) {
        require(armed_ != 0, arming);
        require(held_ == 0 && facts.override_known != 0, override_);
        require(settled_ == 0 || (io_age <= fresh_us && differential_age <= fresh_us), fresh);
        require(clock_back_ == 0, clock);
        require(lapsed_ == 0 || since(granted_us_ + lease_us, client_us) < lapse_us, lapse);
        require(others_ < 3, commander);
        require(not_following_ < not_following_statuses, follows);
        require(unseen_ == 0 || lease_ == 0 || since(unseen_us_, client_us) < uplink_us, uplink);
    }
    clock_back_ = 0;
    require(was_armed_ == 0 || facts.disarm_cause != ROBUROC4_ERR_LAPSED || lapsed_ != 0, lapse);
    require(facts.driving == 0 || lease_ != 0, lease);
    if (facts.state != ROBUROC4_STATE_READY)
        settled_ = 0;
    if (facts.override_known == 0)
        held_ =
            0; /* a lost robot's [A] may have been released unseen: facts do not claim to know */
    if (settled_ != 0) {
        require(facts.age_us[ROBUROC4_SERVICE_IOCARD] >= io_age, age);
        require(facts.age_us[ROBUROC4_SERVICE_DIFFERENTIAL] >= differential_age, age);
    }
    if (lease_ != 0 && facts.armed != 0 && sequence_ == 0)
        require(command_us_ != 0 && since(command_us_, client_us) < command_period_us, fed);
}

void Judge::judge_sequence(const roburoc4_facts &facts, std::uint64_t client_us,
                           std::uint64_t true_us) {
    require(driven_ == 0 || (lease_ != 0 && facts.armed != 0), exit_);
    const bool ready = facts.state == ROBUROC4_STATE_READY;
    if (wanted_ != 0 && ready)
        require(since(command_us_, client_us) < cycle_us,
                held_ == 0 && unconfirmed_ != 0 && stop_called_ == 0 ? release : exit_);
    if (sequence_ != 0 && facts.stopping != 0)
        require(since(command_us_, client_us) < command_period_us, period);
    if (sequence_ != 0 && facts.stopping == 0)
        end_sequence(true_us);
    if (ended_ != 0) {
        require((confirmed_ != 0 && arrived_ != 0) || facts.stop_outcome != ROBUROC4_STOP_CONFIRMED,
                belief);
        const bool confirmed = facts.stop_outcome == ROBUROC4_STOP_CONFIRMED;
        (confirmed ? ended_confirmed_ : ended_unconfirmed_) = 1;
        if (confirmed)
            unconfirmed_ = 0;
        ended_ = arrived_ = confirmed_ = 0;
    }
    if (watch_ != 0 && ready && facts.age_us[ROBUROC4_SERVICE_DIFFERENTIAL] <= fresh_us)
        require((sequence_ != 0 || wanted_ != 0) && facts.stopping != 0, watched);
    watch_ = 0;
}

void Judge::end_sequence(std::uint64_t true_us) {
    require(zeros_ >= 3, three);
    require(confirmed_ != 0 || since(first_zero_true_us_, true_us) >= watchdog_us, ending);
    sequence_ = zeros_ = 0;
    ended_ = 1;
    arrived_ = on_its_way_ == 0 ? 1 : 0;
}

void Judge::take_events(std::uint32_t events_seen) {
    require(disarmed_event_due_ == 0 || (events_seen & ROBUROC4_EVENT_DISARMED) != 0, events);
    require(armed_event_due_ == 0 || (events_seen & ROBUROC4_EVENT_ARMED) != 0, events);
    require(ended_confirmed_ == ((events_seen & ROBUROC4_EVENT_STOP_CONFIRMED) != 0), belief);
    require(ended_unconfirmed_ == ((events_seen & ROBUROC4_EVENT_STOP_UNCONFIRMED) != 0), events);
    disarmed_event_due_ = armed_event_due_ = ended_confirmed_ = ended_unconfirmed_ = 0;
}

} // namespace explore
