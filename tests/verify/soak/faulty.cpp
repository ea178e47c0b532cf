/* SPDX-License-Identifier: MIT */
#include "faulty.h"

#include <cmath>
#include <limits>
#include <map>

namespace soak {

namespace {

/* Offsets in a command (FF, service, v, w) and in a differential status (FF, service, stamp, target
 * v, v, target w, w). */
constexpr std::size_t service_at = 1, v_at = 3, w_at = 7;
constexpr std::size_t stamp_at = 3, target_v_at = 11, current_v_at = 15, target_w_at = 19,
                      current_w_at = 23;

bool is_nonzero(const Datagram &datagram) {
    return is_speed_command(datagram) && !command_speeds(datagram).zero();
}

bool is_zero(const Datagram &datagram) {
    return is_speed_command(datagram) && command_speeds(datagram).zero();
}

bool is_differential(const Datagram &datagram) {
    return datagram.origin.kind == Origin::Kind::differential_status;
}

void put_stamp(Datagram &datagram, std::uint64_t stamp) {
    for (std::size_t i = 0; i < 8; i++)
        datagram.bytes[stamp_at + i] = static_cast<std::uint8_t>(stamp >> (8 * i));
}

/** A client without a fault, from which the faulty ones are derived. */
class Wrapper : public RealClient {
  public:
    std::int32_t poll_transmit(Datagram &out, std::uint64_t now) override {
        for (;;) {
            const std::int32_t length = RealClient::poll_transmit(out, now);
            if (length <= 0 || passes(out, now))
                return length;
        }
    }
    std::int32_t receive(const Datagram &datagram, std::uint64_t now) override {
        Datagram changed = datagram;
        change_received(changed, now);
        return RealClient::receive(changed, now);
    }

  protected:
    /** May change what is sent; false drops it. */
    virtual bool passes(Datagram &, std::uint64_t) {
        return true;
    }
    virtual void change_received(Datagram &, std::uint64_t) {}
};

/** A fault that fits into one function of what is sent or received. */
class Filter : public Wrapper {
  public:
    using Send = std::function<bool(Datagram &, std::uint64_t)>;
    using Receive = std::function<void(Datagram &, std::uint64_t)>;
    Filter(Send send, Receive receive) : send_(std::move(send)), receive_(std::move(receive)) {}

  protected:
    bool passes(Datagram &datagram, std::uint64_t now) override {
        return !send_ || send_(datagram, now);
    }
    void change_received(Datagram &datagram, std::uint64_t now) override {
        if (receive_)
            receive_(datagram, now);
    }

  private:
    Send send_;
    Receive receive_;
};

std::function<std::unique_ptr<Client>()> sending(const Filter::Send &send) {
    return [send] { return std::make_unique<Filter>(send, nullptr); };
}

std::function<std::unique_ptr<Client>()> receiving(const Filter::Receive &receive) {
    return [receive] { return std::make_unique<Filter>(nullptr, receive); };
}

template <typename T> std::function<std::unique_ptr<Client>()> a() {
    return [] { return std::make_unique<T>(); };
}

/** Reports something else than the truth. */
class Liar : public RealClient {
  public:
    using Lie = std::function<void(Report &)>;
    explicit Liar(Lie lie) : lie_(std::move(lie)) {}
    Report report(std::uint64_t now) override {
        Report report = RealClient::report(now);
        lie_(report);
        return report;
    }

  private:
    Lie lie_;
};

std::function<std::unique_ptr<Client>()> reporting(const Liar::Lie &lie) {
    return [lie] { return std::make_unique<Liar>(lie); };
}

void younger(Report &report) {
    for (std::uint32_t &age : report.age_us)
        age = age == UINT32_MAX ? age : age / 4;
}

void always_stopped(Report &report) {
    if ((report.events & ROBUROC4_EVENT_STOP_UNCONFIRMED) != 0)
        report.events |= ROBUROC4_EVENT_STOP_CONFIRMED;
}

void always_relocalized(Report &report) {
    if ((report.events & ROBUROC4_EVENT_RELOCALIZE_FAILED) != 0)
        report.events |= ROBUROC4_EVENT_RELOCALIZED;
}

/** Answers what it requests itself, as the robot did before. */
class AnswersItself : public Wrapper {
    bool passes(Datagram &datagram, std::uint64_t) override {
        const auto known = answers_.find(datagram.u16_at(2));
        if (!is_command(datagram) && datagram.u8_at(1) == action_get && known != answers_.end()) {
            own_.push_back(known->second);
            own_.back().bytes[0] = datagram.bytes[0];
        }
        return true;
    }
    void change_received(Datagram &datagram, std::uint64_t now) override {
        for (const Datagram &answer : own_)
            RealClient::receive(answer, now);
        own_.clear();
        if (!is_status(datagram) && datagram.u8_at(1) == action_get)
            answers_[datagram.u16_at(2)] = datagram;
    }
    std::map<std::uint16_t, Datagram> answers_;
    std::vector<Datagram> own_;
};

class OnlyPauses : public Wrapper {
    std::int32_t stop(std::uint64_t now) override {
        return RealClient::pause(now);
    }
};

class AlwaysStops : public Wrapper {
    std::int32_t pause(std::uint64_t now) override {
        return RealClient::stop(now);
    }
};

/** Takes the end of a lease for the program's own pause(). */
class ForgivesLapses : public Wrapper {
    Report report(std::uint64_t now) override {
        Report report = RealClient::report(now);
        if (report.armed && drove_ && !report.driving)
            RealClient::pause(now);
        drove_ = report.driving;
        return report;
    }
    bool drove_ = false;
};

/** After a stop sequence it never sends zeros by itself, whatever the robot shows. */
class StopsOnce : public Wrapper {
    bool passes(Datagram &datagram, std::uint64_t now) override {
        if (is_nonzero(datagram))
            begun_us_ = 0;
        if (!is_zero(datagram))
            return true;
        if (begun_us_ == 0)
            begun_us_ = now;
        return now - begun_us_ < 500000;
    }
    std::uint64_t begun_us_ = 0;
};

/** Is silent for a while after [A] was released. */
class MissesTheRelease : public Wrapper {
    void change_received(Datagram &datagram, std::uint64_t now) override {
        if (datagram.origin.kind != Origin::Kind::iocard_status)
            return;
        if (held_ && !datagram.origin.pad_a)
            released_us_ = now;
        held_ = datagram.origin.pad_a;
    }
    bool passes(Datagram &datagram, std::uint64_t now) override {
        return !is_zero(datagram) || now - released_us_ > 300000;
    }
    bool held_ = false;
    std::uint64_t released_us_ = 0;
};

class DisarmsForNothing : public Wrapper {
    Report report(std::uint64_t now) override {
        Report report = RealClient::report(now);
        since_us_ = report.armed && since_us_ != 0 ? since_us_ : now;
        if (now - since_us_ > 3000000) {
            RealClient::stop(now);
            report = RealClient::report(now);
            report.disarm_cause = ROBUROC4_ERR_INHIBITED;
        }
        return report;
    }
    std::uint64_t since_us_ = 0;
};

/** Believes that the robot has the target that was sent. */
class SeesWhatItSent : public Wrapper {
  protected:
    bool passes(Datagram &datagram, std::uint64_t) override {
        if (is_speed_command(datagram))
            sent_ = command_speeds(datagram);
        return true;
    }
    void change_received(Datagram &datagram, std::uint64_t) override {
        if (!is_differential(datagram) || sent_.zero())
            return;
        for (const std::size_t at : {target_v_at, current_v_at})
            datagram.put_f32_at(at, sent_.v);
        for (const std::size_t at : {target_w_at, current_w_at})
            datagram.put_f32_at(at, sent_.w);
    }

  private:
    Speeds sent_;
};

/** And answers its own questions with the answers to earlier ones. */
class BlindToTheUplink : public SeesWhatItSent {
    std::int32_t poll_transmit(Datagram &out, std::uint64_t now) override {
        const std::int32_t length = SeesWhatItSent::poll_transmit(out, now);
        if (length == 4 && out.bytes[1] == action_get) {
            const auto known = answers_.find(out.u16_at(2));
            if (known != answers_.end()) {
                known->second.bytes[0] = out.bytes[0];
                RealClient::receive(known->second, now);
            }
        }
        return length;
    }
    void change_received(Datagram &datagram, std::uint64_t now) override {
        SeesWhatItSent::change_received(datagram, now);
        if (!is_status(datagram) && datagram.u8_at(1) == action_get && datagram.size > 5)
            answers_[datagram.u16_at(2)] = datagram;
    }
    std::map<std::uint16_t, Datagram> answers_;
};

class ArmsItself : public Wrapper {
    Report report(std::uint64_t now) override {
        RealClient::arm(now);
        return RealClient::report(now);
    }
};

class AcceptsWhileDisarmed : public Wrapper {
    std::int32_t drive(Speeds speeds, std::uint32_t lease_us, std::uint64_t now) override {
        const std::int32_t result = RealClient::drive(speeds, lease_us, now);
        return result == ROBUROC4_ERR_DISARMED ? ROBUROC4_OK : result;
    }
};

class RenewsTheLease : public Wrapper {
    std::int32_t drive(Speeds speeds, std::uint32_t lease_us, std::uint64_t now) override {
        speeds_ = speeds;
        return RealClient::drive(speeds, lease_us, now);
    }
    std::int32_t poll_transmit(Datagram &out, std::uint64_t now) override {
        if (RealClient::report(now).driving && ++polls_ % 8 == 0)
            RealClient::drive(speeds_, 0, now);
        return RealClient::poll_transmit(out, now);
    }
    Speeds speeds_;
    int polls_ = 0;
};

/** Keeps each tenth speed and sends it 300 ms later instead of whatever is due then. */
class SendsLate : public Wrapper {
    bool passes(Datagram &datagram, std::uint64_t now) override {
        if (is_nonzero(datagram) && ++speeds_ % 10 == 0) {
            kept_ = datagram;
            kept_us_ = now;
        }
        if (kept_us_ != 0 && now - kept_us_ > 300000 && is_speed_command(datagram)) {
            datagram = kept_;
            kept_us_ = 0;
        }
        return true;
    }
    Datagram kept_;
    std::uint64_t kept_us_ = 0;
    int speeds_ = 0;
};

class TakesNan : public Wrapper {
    std::int32_t drive(Speeds speeds, std::uint32_t lease_us, std::uint64_t now) override {
        if (!std::isfinite(speeds.v) || !std::isfinite(speeds.w))
            speeds = {0.1F, 0};
        return RealClient::drive(speeds, lease_us, now);
    }
};

class TakesLongLeases : public Wrapper {
    std::int32_t drive(Speeds speeds, std::uint32_t lease_us, std::uint64_t now) override {
        return RealClient::drive(speeds, lease_us > 1000000 ? 1000000 : lease_us, now);
    }
};

/** Believes that [A] is where the manual says, whatever the robot's texts say. */
class GuessesPadA : public Wrapper {
    std::int32_t init(const roburoc4_config &config) override {
        roburoc4_config changed = config;
        changed.role_index[ROBUROC4_ROLE_OVERRIDE] = ROBUROC4_DI_PAD_A;
        return RealClient::init(changed);
    }
};

/** Believes that every status was made when it arrived, by changing its stamp. */
class IgnoresAge : public Wrapper {
    void change_received(Datagram &datagram, std::uint64_t now) override {
        if (datagram.origin.made_us == 0 || !is_command(datagram))
            return;
        put_stamp(datagram, now / cycle_us);
    }
};

/** Does not notice that the clock steps back: its own continues from where it was. */
class HidesClockSteps : public Wrapper {
    std::int32_t receive(const Datagram &datagram, std::uint64_t now) override {
        return RealClient::receive(datagram, steady(now));
    }
    std::int32_t poll_transmit(Datagram &out, std::uint64_t now) override {
        return RealClient::poll_transmit(out, steady(now));
    }
    std::int32_t drive(Speeds speeds, std::uint32_t lease_us, std::uint64_t now) override {
        return RealClient::drive(speeds, lease_us, steady(now));
    }
    std::int32_t arm(std::uint64_t now) override {
        return RealClient::arm(steady(now));
    }
    std::int32_t pause(std::uint64_t now) override {
        return RealClient::pause(steady(now));
    }
    std::int32_t stop(std::uint64_t now) override {
        return RealClient::stop(steady(now));
    }
    std::int32_t close(std::uint64_t now) override {
        return RealClient::close(steady(now));
    }
    std::uint64_t next_deadline() override {
        const std::uint64_t deadline = RealClient::next_deadline();
        return deadline == UINT64_MAX ? deadline : deadline - lead_;
    }
    Report report(std::uint64_t now) override {
        return RealClient::report(steady(now));
    }
    std::uint64_t steady(std::uint64_t now) {
        if (now < last_)
            lead_ += last_ - now;
        last_ = now;
        return now + lead_;
    }
    std::uint64_t last_ = 0, lead_ = 0;
};

/** Lets the first zero after a speed wait behind the next request. */
class ZerosLast : public Wrapper {
    bool passes(Datagram &datagram, std::uint64_t) override {
        const bool first_zero = is_zero(datagram) && moving_;
        if (is_speed_command(datagram))
            moving_ = is_nonzero(datagram);
        return !first_zero;
    }
    bool moving_ = false;
};

class OneZero : public Wrapper {
    bool passes(Datagram &datagram, std::uint64_t) override {
        if (is_nonzero(datagram))
            zeros_ = 0;
        return !is_zero(datagram) || ++zeros_ == 1;
    }
    int zeros_ = 0;
};

/** Gives the client, right after each zero, a confirmation that the robot did not send. */
class BelievesOldConfirmations : public Wrapper {
    std::int32_t receive(const Datagram &datagram, std::uint64_t now) override {
        if (is_differential(datagram))
            status_ = datagram;
        return RealClient::receive(datagram, now);
    }
    bool passes(Datagram &datagram, std::uint64_t now) override {
        if (!is_zero(datagram) || status_.size == 0)
            return true;
        Datagram forged = status_;
        for (const std::size_t at : {target_v_at, current_v_at, target_w_at, current_w_at})
            forged.put_f32_at(at, 0);
        put_stamp(forged, forged.u64_at(stamp_at) + ++forged_);
        RealClient::receive(forged, now);
        return true;
    }
    Datagram status_;
    std::uint64_t forged_ = 0;
};

class IgnoresStop : public Wrapper {
    std::int32_t stop(std::uint64_t) override {
        return ROBUROC4_OK;
    }
};

class NeverEndsAStop : public Wrapper {
    std::int32_t poll_transmit(Datagram &out, std::uint64_t now) override {
        const Report report = RealClient::report(now);
        events_ |= report.events;
        if (report.stopping)
            RealClient::stop(now);
        if ((report.events & ROBUROC4_EVENT_STOP_CONFIRMED) != 0)
            RealClient::stop(now);
        return RealClient::poll_transmit(out, now);
    }
    Report report(std::uint64_t now) override {
        Report report = RealClient::report(now);
        report.events |= events_;
        events_ = 0;
        return report;
    }
    std::uint32_t events_ = 0;
};

/** A speed may leave before its stop sequence has ended. */
class SkipsStops : public Wrapper {
    bool passes(Datagram &datagram, std::uint64_t) override {
        if (is_nonzero(datagram))
            speed_ = datagram;
        if (is_zero(datagram) && speed_.size != 0 && ++zeros_ % 2 == 0)
            datagram = speed_;
        return true;
    }
    Datagram speed_;
    int zeros_ = 0;
};

class StopsUnasked : public Wrapper {
    std::int32_t arm(std::uint64_t now) override {
        const std::int32_t result = RealClient::arm(now);
        RealClient::stop(now);
        return result;
    }
};

class SendsTwice : public Wrapper {
    std::int32_t poll_transmit(Datagram &out, std::uint64_t now) override {
        if (again_) {
            again_ = false;
            out = last_;
            return static_cast<std::int32_t>(out.size);
        }
        const std::int32_t length = RealClient::poll_transmit(out, now);
        last_ = out;
        again_ = length > 0 && is_nonzero(out);
        return length;
    }
    Datagram last_;
    bool again_ = false;
};

class ForgetsToRepeat : public Wrapper {
    bool passes(Datagram &datagram, std::uint64_t) override {
        return !is_nonzero(datagram) || ++speeds_ % 4 != 0;
    }
    int speeds_ = 0;
};

class DeadlineInThePast : public Wrapper {
    std::uint64_t next_deadline() override {
        return 1;
    }
};

class NeverArms : public Wrapper {
    std::int32_t arm(std::uint64_t) override {
        return ROBUROC4_ERR_STALE_IOCARD;
    }
};

/** After a restart, stamps continue where they were, so the restart goes unnoticed. */
class HidesRestarts : public Wrapper {
    void change_received(Datagram &datagram, std::uint64_t) override {
        if (datagram.origin.made_us == 0 || !is_command(datagram))
            return;
        const std::uint64_t stamp = datagram.u64_at(stamp_at);
        if (datagram.origin.boot != boot_) {
            boot_ = datagram.origin.boot;
            ahead_ = highest_ != 0 ? highest_ - stamp + 5 : 0; /* wraps around, and back */
        }
        highest_ = stamp + ahead_ > highest_ ? stamp + ahead_ : highest_;
        put_stamp(datagram, stamp + ahead_);
    }
    std::uint32_t boot_ = 0;
    std::uint64_t highest_ = 0, ahead_ = 0;
};

/** When nothing comes, it gives itself the last statuses again with younger stamps. */
class InventsStatuses : public Wrapper {
    std::int32_t receive(const Datagram &datagram, std::uint64_t now) override {
        if (is_differential(datagram))
            differential_ = datagram;
        if (datagram.origin.kind == Origin::Kind::iocard_status)
            iocard_ = datagram;
        heard_us_ = now;
        return RealClient::receive(datagram, now);
    }
    std::int32_t poll_transmit(Datagram &out, std::uint64_t now) override {
        for (Datagram *const datagram : {&differential_, &iocard_}) {
            if (datagram->size == 0 || now - heard_us_ < 100000)
                continue;
            put_stamp(*datagram, datagram->u64_at(stamp_at) + 5);
            RealClient::receive(*datagram, now);
        }
        return RealClient::poll_transmit(out, now);
    }
    Datagram differential_, iocard_;
    std::uint64_t heard_us_ = 0;
};

void hide_pad_a(Datagram &datagram, std::uint64_t) {
    if (datagram.origin.kind != Origin::Kind::iocard_status)
        return;
    for (std::size_t at = 11 + 9 * 4; at < datagram.size; at++)
        datagram.bytes[at] = 0;
}

void hide_targets(Datagram &datagram, std::uint64_t) {
    if (!is_differential(datagram) || !datagram.origin.others_target)
        return;
    datagram.put_f32_at(target_v_at, 0);
    datagram.put_f32_at(target_w_at, 0);
}

void hide_standing(Datagram &datagram, std::uint64_t) {
    if (!is_differential(datagram))
        return;
    datagram.put_f32_at(current_v_at, datagram.f32_at(target_v_at));
    datagram.put_f32_at(current_w_at, datagram.f32_at(target_w_at));
}

/** Sees that the robot stands once it has for 5 s. */
class SeesStandingLate : public Wrapper {
  protected:
    void change_received(Datagram &datagram, std::uint64_t now) override {
        if (!is_differential(datagram))
            return;
        const std::uint64_t cycles = datagram.u64_at(3);
        const bool stands = std::fabs(datagram.f32_at(current_v_at)) < 0.005F &&
                            std::fabs(datagram.f32_at(current_w_at)) < 0.005F;
        if (!stands || !stood_)
            since_ = cycles;
        stood_ = stands;
        if (stands && cycles - since_ < 500)
            hide_standing(datagram, now);
    }

  private:
    bool stood_ = false;
    std::uint64_t since_ = 0;
};

void shake(Datagram &datagram, std::uint64_t) {
    if (!is_differential(datagram))
        return;
    datagram.put_f32_at(target_v_at, datagram.f32_at(target_v_at) + 0.02F);
    datagram.put_f32_at(current_v_at, datagram.f32_at(current_v_at) + 0.2F);
}

void hide_speeds(Datagram &datagram, std::uint64_t) {
    if (!is_differential(datagram))
        return;
    for (const std::size_t at : {target_v_at, current_v_at, target_w_at, current_w_at})
        datagram.put_f32_at(at, 0);
}

/* The texts of the directory. */
void lose_texts(Datagram &datagram, std::uint64_t) {
    if (!is_status(datagram) && datagram.u8_at(1) == action_query && datagram.u16_at(2) == 0)
        datagram.bytes[1] = 0x7F;
}

bool doubled(Datagram &datagram, std::uint64_t) {
    if (is_nonzero(datagram))
        datagram.put_f32_at(v_at, 2 * datagram.f32_at(v_at));
    return true;
}

bool slightly_more(Datagram &datagram, std::uint64_t) {
    if (is_nonzero(datagram))
        datagram.put_f32_at(w_at, 0.9F * datagram.f32_at(w_at) + 0.01F);
    return true;
}

bool not_a_number(Datagram &datagram, std::uint64_t) {
    if (is_nonzero(datagram))
        datagram.put_f32_at(v_at, std::numeric_limits<float>::quiet_NaN());
    return true;
}

bool to_another_service(Datagram &datagram, std::uint64_t) {
    if (is_speed_command(datagram))
        datagram.bytes[service_at]++;
    return true;
}

} // namespace

const std::vector<Fault> &faults() {
    static const std::vector<Fault> all = {
        {Promise::nothing_arms_itself, "arms by itself", a<ArmsItself>()},
        {Promise::speed_needs_arming, "accepts drive() while disarmed", a<AcceptsWhileDisarmed>()},
        {Promise::speed_needs_lease, "renews the lease by itself", a<RenewsTheLease>()},
        {Promise::stop_before_speed, "sends a kept command later", a<SendsLate>()},
        {Promise::bad_arguments_refused, "takes NaN for a speed", a<TakesNan>()},
        {Promise::bad_arguments_refused, "takes any lease", a<TakesLongLeases>()},
        {Promise::within_limits, "sends twice the speed", sending(doubled)},
        {Promise::within_limits, "sends NaN", sending(not_a_number)},
        {Promise::newest_target, "sends another turn rate", sending(slightly_more)},
        {Promise::keep_curvature, "sends another curve", sending(slightly_more)},
        {Promise::override_disarms, "does not see [A]", receiving(hide_pad_a)},
        {Promise::override_by_texts, "guesses [A]", a<GuessesPadA>()},
        {Promise::fresh_by_age, "believes that what arrives is new", a<IgnoresAge>()},
        {Promise::fresh_by_age, "invents statuses", a<InventsStatuses>()},
        {Promise::ages_are_bounds, "claims that statuses are younger", reporting(younger)},
        {Promise::arming_conditions, "does not see that the robot moves", receiving(hide_speeds)},
        {Promise::reboot_disarms, "does not see a restart", a<HidesRestarts>()},
        {Promise::restart_forgets, "does not see a restart", a<HidesRestarts>()},
        {Promise::clock_ends_lease, "does not see a clock step", a<HidesClockSteps>()},
        {Promise::zeros_first, "drops the first zero", a<ZerosLast>()},
        {Promise::zeros_repeated, "sends one zero", a<OneZero>()},
        {Promise::stop_confirmed, "believes an old confirmation", a<BelievesOldConfirmations>()},
        {Promise::stop_ends, "never ends a stop sequence", a<NeverEndsAStop>()},
        {Promise::rounding_is_not_motion, "takes noise for motion", receiving(shake)},
        {Promise::stop_before_speed, "mixes speeds into a stop sequence", a<SkipsStops>()},
        {Promise::stop_always_sends, "ignores stop()", a<IgnoresStop>()},
        {Promise::stop_latches, "stays armed after stop()", a<OnlyPauses>()},
        {Promise::pause_keeps_armed, "disarms at pause()", a<AlwaysStops>()},
        {Promise::lapse_disarms, "forgives a lapse", a<ForgivesLapses>()},
        {Promise::outcome_is_true, "takes every stop for confirmed", reporting(always_stopped)},
        {Promise::outcome_is_true, "answers its own requests", a<AnswersItself>()},
        {Promise::stop_is_watched, "stops only once", a<StopsOnce>()},
        {Promise::stands_in_the_end, "stops only once", a<StopsOnce>()},
        {Promise::release_stops, "misses the release of [A]", a<MissesTheRelease>()},
        {Promise::monitor_is_silent, "sends zeros unasked", a<StopsUnasked>()},
        {Promise::service_by_texts, "loses the directory's texts", receiving(lose_texts)},
        {Promise::only_differential, "commands another service", sending(to_another_service)},
        {Promise::spacing, "sends each command twice", a<SendsTwice>()},
        {Promise::other_commander_disarms, "does not see others", receiving(hide_targets)},
        {Promise::follows_or_disarmed, "does not see that it stands", receiving(hide_standing)},
        {Promise::follows_or_disarmed, "sees late that it stands", a<SeesStandingLate>()},
        {Promise::healthy_stays_armed, "disarms for nothing", a<DisarmsForNothing>()},
        {Promise::target_must_appear, "sees what it sent", a<SeesWhatItSent>()},
        {Promise::late_uplink_disarms, "is blind to the uplink", a<BlindToTheUplink>()},
        {Promise::no_old_pose, "takes every pose for accepted", reporting(always_relocalized)},
        {Promise::feeds_watchdog, "forgets to repeat", a<ForgetsToRepeat>()},
        {Promise::deadlines, "is always late", a<DeadlineInThePast>()},
        {Promise::comes_back, "never arms", a<NeverArms>()},
    };
    return all;
}

} // namespace soak
