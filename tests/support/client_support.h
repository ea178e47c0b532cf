/* SPDX-License-Identifier: MIT
 *
 * client_support.h - a table-driven robot for tests of the client: it answers requests and sends
 * statuses as its fields say, right or wrong. Built only on the codec's encoders.
 */
#ifndef ROBUROC4_TESTS_CLIENT_SUPPORT_H
#define ROBUROC4_TESTS_CLIENT_SUPPORT_H

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "counts.h"
#include "hex.h"
#include "roburoc4.h"

namespace roburoc4_tests {

constexpr std::uint64_t ms = 1000;
constexpr std::uint64_t second = 1000000;

/** The other end of a client's link, in virtual time. */
class Partner {
  public:
    virtual ~Partner() = default;
    virtual void advance(std::uint64_t now_us) = 0;
    virtual void deliver(const Bytes &datagram) = 0;
    virtual std::vector<Bytes> take() = 0;
    [[nodiscard]] virtual std::uint64_t next_us() const = 0;
};

/** Set one digital output. */
inline roburoc4_result set_digital_output(roburoc4_client *client, std::uint32_t index, int on,
                                          std::uint64_t now_us) {
    return roburoc4_client_set_digital_outputs(client, std::uint64_t{1} << index,
                                               static_cast<std::uint64_t>(on) << index, now_us);
}

/** Call an encoder with a buffer and return what it wrote. */
template <typename Encoder> Bytes encoded(Encoder encoder) {
    std::array<std::uint8_t, 2048> buffer{};
    const roburoc4_result size = encoder(buffer.data(), buffer.size());
    EXPECT_GT(size, 0);
    return size > 0 ? Bytes(buffer.begin(), buffer.begin() + size) : Bytes();
}

inline Bytes plain_answer(std::uint8_t id, std::uint8_t action, std::uint16_t target,
                          std::uint8_t error) {
    return encoded([&](std::uint8_t *b, std::size_t n) {
        return roburoc4_encode_answer(b, n, id, action, target, error);
    });
}

struct ScriptedService {
    std::uint16_t type;
    std::uint16_t id;
    std::uint32_t kind; /* ROBUROC4_SERVICE_*, what it really is */
    std::string text;
    bool get_refused = false, get_silent = false;
    bool insert_refused = false, insert_silent = false;
    bool mute = false;          /* acknowledges its subscription, but sends no status */
    std::size_t get_length = 0; /* cut its properties to so many bytes */
};

inline std::vector<ScriptedService> usual_services() {
    return {{0, 0, 0, "Directory"},
            {0, 1, 1, "Notification"},
            {ROBUROC4_TYPE_IOCARD, 2, 2, "IOCard"},
            {ROBUROC4_TYPE_TELEMETER, 3, 3, "Telemeter"},
            {0x7777, 4, 4, "Battery"},
            {ROBUROC4_TYPE_LOCALIZATION, 5, 5, "Localization"},
            {ROBUROC4_TYPE_DIFFERENTIAL, 6, 6, "Differential"}};
}

class ScriptedRobot : public Partner {
  public:
    struct Request {
        std::uint64_t at_us;
        roburoc4_request what;
    };

    /* ---- the table ---- */
    std::vector<ScriptedService> services = usual_services();
    bool powered = true;
    bool directory_refused = false;
    bool texts_silent = false, texts_refused = false;
    bool delete_refused = false, replace_refused = false, replace_silent = false;
    bool always_manual_id = false;  /* answers carry 0x01 */
    bool only_manual_id = false;    /* requests with another id are ignored */
    bool error_header = false;      /* errors come as telegrams with header 0x00 */
    std::uint8_t forced_period = 0; /* the robot's own idea of every period, in cycles */
    /** Answers instead of the table if it returns true. */
    std::function<bool(const roburoc4_request &, std::vector<Bytes> &)> instead;
    std::function<std::string(std::uint32_t io_type, std::uint32_t index)> channel_text =
        [](std::uint32_t io_type, std::uint32_t index) {
            const char *name = roburoc4_client_channel_name(nullptr, io_type, index);
            return std::string(name != nullptr ? name : "");
        };
    roburoc4_iocard_properties iocard{9, 0, 22, 8, 0, 0};
    std::vector<roburoc4_telemeter> telemeters{{0.6F, 0, 0, 0.5F, 0.2F, 6, 1.5F},
                                               {-0.6F, 0, 3.14F, 0.5F, 0.2F, 6, 2.5F}};
    roburoc4_battery_properties battery{24, 60, 20, 0, 0};
    roburoc4_localization_properties localization{1, 2, 0.5, 0x18, 0, 0};
    roburoc4_differential_properties differential{0, 0,  0, 0,  2.6F,  -2.6F, 6.5F, -6.5F,
                                                  3, -3, 8, -8, 0.68F, 0,     0};
    /* ---- what statuses say ---- */
    std::uint64_t digital = 0;
    std::vector<float> analog = std::vector<float>(9, 0.25F);
    std::vector<float> distances{1.5F, 2.5F};
    std::uint8_t battery_state = ROBUROC4_BATTERY_OK, battery_percent = 80;
    std::array<double, 3> pose{0, 0, 0};
    /** Targets and currents follow the last command, unless a test sets them. */
    bool follows = true;
    std::uint64_t watchdog_us = second;
    float target_linear = 0, current_linear = 0, target_angular = 0, current_angular = 0;

    /* ---- what it saw ---- */
    std::vector<Request> requests;
    std::vector<std::pair<std::uint64_t, Bytes>> output_commands;
    std::map<std::uint16_t, std::uint8_t> subscriptions; /* by wire id: cycles */

    void reboot() {
        subscriptions.clear();
        queue_.clear();
        boot_us_ = now_us_;
        last_cycle_ = 0;
        target_linear = current_linear = target_angular = current_angular = 0;
    }
    [[nodiscard]] std::uint64_t cycles() const {
        return (now_us_ - boot_us_) / ROBUROC4_CYCLE_US;
    }
    /** Start the cycle counter from here. */
    void set_cycles(std::uint64_t cycles) {
        boot_us_ = now_us_ - cycles * ROBUROC4_CYCLE_US;
        last_cycle_ = cycles;
    }
    ScriptedService &service(std::uint32_t kind) {
        for (ScriptedService &s : services)
            if (s.kind == kind)
                return s;
        throw std::invalid_argument("no such service");
    }
    void remove(std::uint32_t kind) {
        for (std::size_t i = 0; i < services.size(); i++)
            if (services[i].kind == kind)
                services.erase(services.begin() + static_cast<std::ptrdiff_t>(i));
    }
    void press(std::uint32_t input, bool down = true) {
        const std::uint64_t bit = std::uint64_t{1} << input;
        digital = down ? digital | bit : digital & ~bit;
    }
    /** Requests with this action (and target, or subject of an INSERT or DELETE). */
    [[nodiscard]] std::vector<Request> seen(std::uint8_t action, int about = -1) const {
        std::vector<Request> found;
        for (const Request &r : requests) {
            const bool subject =
                action == ROBUROC4_ACTION_INSERT || action == ROBUROC4_ACTION_DELETE;
            if (r.what.action == action &&
                (about < 0 || about == (subject ? r.what.subject : r.what.service)))
                found.push_back(r);
        }
        return found;
    }

    Bytes status(std::uint32_t kind) {
        return status_at(kind, cycles());
    }
    Bytes status_at(std::uint32_t kind, std::uint64_t at_cycles) {
        const std::uint16_t id = service(kind).id;
        return encoded([&](std::uint8_t *b, std::size_t n) -> roburoc4_result {
            switch (kind) {
            case ROBUROC4_SERVICE_IOCARD: {
                Bytes blocks((static_cast<std::size_t>(iocard.digital_inputs) + 7) / 8);
                for (std::size_t i = 0; i < std::min(blocks.size(), sizeof digital); i++)
                    blocks[i] = static_cast<std::uint8_t>(digital >> (8 * i));
                return roburoc4_encode_iocard_status(
                    b, n, id, at_cycles, analog.data(), analog.size(), blocks.data(),
                    static_cast<std::size_t>(iocard.digital_inputs));
            }
            case ROBUROC4_SERVICE_TELEMETER:
                return roburoc4_encode_telemeter_status(b, n, id, at_cycles, distances.data(),
                                                        distances.size());
            case ROBUROC4_SERVICE_BATTERY: {
                const roburoc4_battery_status s{at_cycles, battery_state, battery_percent, id, 0};
                return roburoc4_encode_battery_status(b, n, &s);
            }
            case ROBUROC4_SERVICE_LOCALIZATION: {
                const roburoc4_localization_status s{at_cycles, pose[0], pose[1], pose[2],
                                                     0x18,      id,      0};
                return roburoc4_encode_localization_status(b, n, &s);
            }
            default: {
                const roburoc4_differential_status s{
                    at_cycles, target_linear, current_linear, target_angular, current_angular, id,
                    {}};
                return roburoc4_encode_differential_status(b, n, &s);
            }
            }
        });
    }

    Bytes properties(const ScriptedService &s, std::uint8_t id) {
        return encoded([&](std::uint8_t *b, std::size_t n) -> roburoc4_result {
            switch (s.kind) {
            case ROBUROC4_SERVICE_IOCARD:
                iocard.service = s.id;
                return roburoc4_encode_iocard_properties(b, n, id, &iocard);
            case ROBUROC4_SERVICE_TELEMETER:
                return roburoc4_encode_telemeter_properties(b, n, id, s.id, telemeters.data(),
                                                            telemeters.size());
            case ROBUROC4_SERVICE_BATTERY:
                battery.service = s.id;
                return roburoc4_encode_battery_properties(b, n, id, &battery);
            case ROBUROC4_SERVICE_LOCALIZATION:
                localization.service = s.id;
                return roburoc4_encode_localization_properties(b, n, id, &localization);
            case ROBUROC4_SERVICE_DIFFERENTIAL:
                differential.service = s.id;
                return roburoc4_encode_differential_properties(b, n, id, &differential);
            default:
                return roburoc4_encode_answer(b, n, id, ROBUROC4_ACTION_GET, s.id, 0);
            }
        });
    }

    void say(const Bytes &datagram) {
        queue_.push_back(datagram);
    }

    /* ---- Partner ---- */
    void advance(std::uint64_t now_us) override {
        if (!begun_) {
            begun_ = true;
            boot_us_ = now_us - 1000 * ROBUROC4_CYCLE_US;
            last_cycle_ = 1000;
        }
        now_us_ = now_us;
        if (follows && last_command_us_ != 0 && now_us - last_command_us_ >= watchdog_us) {
            target_linear = current_linear = target_angular = current_angular = 0;
            last_command_us_ = 0; /* its watchdog has tripped */
        }
        for (; last_cycle_ < cycles(); last_cycle_++) {
            for (const auto &[id, period] : subscriptions)
                for (const ScriptedService &s : services)
                    if (s.id == id && !s.mute && powered && (last_cycle_ + 1) % period == 0)
                        queue_.push_back(status_at(s.kind, last_cycle_ + 1));
        }
    }
    [[nodiscard]] std::uint64_t next_us() const override {
        return boot_us_ + (last_cycle_ + 1) * ROBUROC4_CYCLE_US;
    }
    std::vector<Bytes> take() override {
        std::vector<Bytes> all;
        all.swap(queue_);
        return all;
    }
    void deliver(const Bytes &datagram) override {
        if (!powered)
            return;
        roburoc4_request r{};
        if (datagram[0] == ROBUROC4_HEADER_STATUS) {
            command(datagram);
        } else if (roburoc4_decode_request(datagram.data(), datagram.size(), &r) >= 0) {
            requests.push_back({now_us_, r});
            if (instead && instead(r, queue_))
                return;
            if (!only_manual_id || r.id == ROBUROC4_HEADER_MANUAL)
                answer(r);
        } else {
            ADD_FAILURE() << "the client sent no telegram: " << to_hex(datagram);
        }
    }

  private:
    void command(const Bytes &datagram) {
        const auto id = static_cast<std::uint16_t>(datagram[1] | datagram[2] << 8);
        for (const ScriptedService &s : services) {
            if (s.id != id)
                continue;
            roburoc4_differential_command c{};
            if (s.kind == ROBUROC4_SERVICE_IOCARD) {
                output_commands.emplace_back(now_us_, datagram);
            } else if (s.kind != ROBUROC4_SERVICE_DIFFERENTIAL) {
                ADD_FAILURE() << "a command to a service that takes none: " << to_hex(datagram);
            } else if (roburoc4_decode_differential_command(datagram.data(), datagram.size(), &c) ==
                           0 &&
                       follows) {
                last_command_us_ = now_us_;
                target_linear = current_linear = c.linear_m_s;
                target_angular = current_angular = c.angular_rad_s;
            }
            return;
        }
        ADD_FAILURE() << "a command to a service that is not there: " << to_hex(datagram);
    }

    void fail(const roburoc4_request &r, std::uint8_t error) {
        const std::uint8_t id = error_header ? std::uint8_t{0} : r.id;
        queue_.push_back(plain_answer(id, r.action, r.service, error));
    }

    void answer(roburoc4_request r) {
        if (always_manual_id)
            r.id = ROBUROC4_HEADER_MANUAL;
        switch (r.action) {
        case ROBUROC4_ACTION_GET:
            return answer_get(r);
        case ROBUROC4_ACTION_QUERY:
            return answer_query(r);
        case ROBUROC4_ACTION_INSERT:
            return answer_insert(r);
        case ROBUROC4_ACTION_DELETE:
            if (delete_refused)
                return fail(r, ROBUROC4_ERROR_UNSUPPORTED);
            subscriptions.erase(r.subject);
            return queue_.push_back(plain_answer(r.id, r.action, r.service, 0));
        default:
            if (replace_silent)
                return;
            if (replace_refused)
                return fail(r, ROBUROC4_ERROR_DATA);
            pose = {r.x_m, r.y_m, r.theta_rad};
            return queue_.push_back(plain_answer(r.id, r.action, r.service, 0));
        }
    }

    void answer_get(const roburoc4_request &r) {
        if (r.service == ROBUROC4_SERVICE_DIRECTORY) {
            if (directory_refused)
                return fail(r, ROBUROC4_ERROR_TARGET);
            std::vector<roburoc4_directory_entry> entries;
            for (const ScriptedService &s : services)
                entries.push_back({s.type, s.id});
            return queue_.push_back(encoded([&](std::uint8_t *b, std::size_t n) {
                return roburoc4_encode_directory(b, n, r.id, 0, entries.data(), entries.size());
            }));
        }
        for (const ScriptedService &s : services) {
            if (s.id != r.service)
                continue;
            if (s.get_silent)
                return;
            if (s.get_refused)
                return fail(r, ROBUROC4_ERROR_UNSUPPORTED);
            Bytes bytes = properties(s, r.id);
            if (s.get_length > 0)
                bytes.resize(s.get_length);
            return queue_.push_back(bytes);
        }
        fail(r, ROBUROC4_ERROR_TARGET);
    }

    void answer_query(const roburoc4_request &r) {
        if (texts_silent)
            return;
        const auto index = static_cast<std::size_t>(r.index);
        if (texts_refused || (r.service == 0 && index >= services.size()))
            return fail(r, ROBUROC4_ERROR_UNSUPPORTED);
        const std::string text = r.service == 0
                                     ? services[index].text
                                     : channel_text(r.io_type, static_cast<std::uint32_t>(index));
        queue_.push_back(encoded([&](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_text(b, n, r.id, r.service, text.data(), text.size());
        }));
    }

    void answer_insert(const roburoc4_request &r) {
        for (const ScriptedService &s : services) {
            if (s.id != r.subject)
                continue;
            if (s.insert_silent)
                return;
            if (s.insert_refused)
                return fail(r, ROBUROC4_ERROR_DATA);
            subscriptions[s.id] = forced_period > 0 ? forced_period : r.period_cycles;
            return queue_.push_back(plain_answer(r.id, r.action, r.service, 0));
        }
        fail(r, ROBUROC4_ERROR_DATA);
    }

    bool begun_ = false;
    std::uint64_t now_us_ = 0, boot_us_ = 0, last_cycle_ = 0, last_command_us_ = 0;
    std::vector<Bytes> queue_;
};

/** For what a network drops: all, commands, or statuses. */
inline bool everything(const Bytes &) {
    return true;
}
inline bool is_command(const Bytes &bytes) {
    return bytes.size() == 11 && bytes[0] == ROBUROC4_HEADER_STATUS;
}
inline bool is_status(const Bytes &bytes) {
    return !bytes.empty() && bytes[0] == ROBUROC4_HEADER_STATUS;
}

/** Sends each datagram as late as late_us() says. */
class LateRobot : public ScriptedRobot {
  public:
    std::vector<Bytes> take() override {
        for (const Bytes &bytes : ScriptedRobot::take())
            held_.emplace(at_us_ + late_us(bytes), sent_as(bytes));
        std::vector<Bytes> due;
        for (; !held_.empty() && held_.begin()->first <= at_us_; held_.erase(held_.begin()))
            due.push_back(held_.begin()->second);
        return due;
    }
    void advance(std::uint64_t now_us) override {
        at_us_ = now_us;
        ScriptedRobot::advance(now_us);
    }
    [[nodiscard]] std::uint64_t next_us() const override {
        const std::uint64_t next = ScriptedRobot::next_us();
        return held_.empty() ? next : std::min(next, held_.begin()->first);
    }

  protected:
    std::uint64_t at_us_ = 0;
    std::multimap<std::uint64_t, Bytes> held_;

  private:
    virtual std::uint64_t late_us(const Bytes &datagram) = 0;
    virtual Bytes sent_as(Bytes datagram) {
        return datagram;
    }
};

/** Statuses of the inputs have a queue of their own. */
struct LateInputsRobot : LateRobot {
    std::uint64_t inputs_us = 0;

  private:
    std::uint64_t late_us(const Bytes &bytes) override {
        return is_status(bytes) && bytes[1] == ROBUROC4_SERVICE_IOCARD ? inputs_us : 0;
    }
};

/** Stamps of the services that measure motion are 15 cycles older than the others. */
struct MeasuringRobot : ScriptedRobot {
    std::vector<Bytes> take() override {
        std::vector<Bytes> all = ScriptedRobot::take();
        for (Bytes &bytes : all)
            if (measured(bytes))
                bytes = status_at(bytes[1], cycles() - 15);
        std::stable_partition(all.begin(), all.end(), measured);
        return all;
    }
    static bool measured(const Bytes &bytes) {
        return is_status(bytes) && bytes[1] >= ROBUROC4_SERVICE_LOCALIZATION;
    }
};

} // namespace roburoc4_tests

#endif
