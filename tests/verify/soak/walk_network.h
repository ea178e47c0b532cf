/* SPDX-License-Identifier: MIT
 *
 * walk_network.h - one direction of a bad network for the walk: it draws from the life's own seed,
 * delays up to seconds, has outages, and tells which datagrams were damaged or forged.
 */
#ifndef ROBUROC4_TESTS_WALK_NETWORK_H
#define ROBUROC4_TESTS_WALK_NETWORK_H

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "hex.h"

namespace roburoc4_tests {

/** A stream of numbers that is the same on every machine. */
class Dice {
  public:
    explicit Dice(std::uint64_t seed) : state_(seed) {}

    std::uint64_t next() {
        std::uint64_t mixed = state_ += 0x9E3779B97F4A7C15U;
        mixed = (mixed ^ mixed >> 30) * 0xBF58476D1CE4E5B9U;
        mixed = (mixed ^ mixed >> 27) * 0x94D049BB133111EBU;
        return mixed ^ mixed >> 31;
    }
    /** 0 or more, less than 1. */
    double share() {
        return static_cast<double>(next() >> 11) / 9007199254740992.0;
    }
    bool chance(double probability) {
        return share() < probability;
    }
    /** low to high, both possible. */
    std::uint64_t between(std::uint64_t low, std::uint64_t high) {
        return low + next() % (high - low + 1);
    }
    double real(double low, double high) {
        return low + share() * (high - low);
    }

  private:
    std::uint64_t state_;
};

struct Weather {
    double loss = 0, duplicate = 0, reorder = 0, damage = 0;
    double burst = 0; /* the chance that a datagram begins an outage, in which all are lost */
    std::uint64_t burst_us = 0;                                /* the longest outage */
    std::uint64_t delay_us = 1000, jitter_us = 0, hold_us = 0; /* hold: what reordering adds */

    [[nodiscard]] std::uint64_t longest_us() const {
        return delay_us + jitter_us + hold_us;
    }
};

struct Arrival {
    Bytes bytes;
    bool damaged = false; /* or forged: it is not what its sender sent */
};

class BadNetwork {
  public:
    Weather weather;

    /** Send at `now_us`; the latest time at which a copy arrives, or 0 when none does. */
    std::uint64_t push(const Bytes &bytes, std::uint64_t now_us, Dice &dice) {
        std::uint64_t latest_us = 0;
        if (now_us < outage_until_us_ || dice.chance(weather.loss))
            return latest_us;
        if (weather.burst > 0 && dice.chance(weather.burst)) {
            outage_until_us_ = now_us + dice.between(0, weather.burst_us);
            return latest_us;
        }
        for (int copies = dice.chance(weather.duplicate) ? 2 : 1; copies > 0; copies--) {
            std::uint64_t arrival_us =
                now_us + weather.delay_us + dice.between(0, weather.jitter_us);
            if (dice.chance(weather.reorder))
                arrival_us += dice.between(0, weather.hold_us);
            else
                arrival_us = in_order_us_ = std::max(arrival_us, in_order_us_);
            Arrival arrival{bytes, false};
            if (dice.chance(weather.damage))
                damage(arrival, dice);
            flights_.emplace(arrival_us, std::move(arrival));
            latest_us = std::max(latest_us, arrival_us);
        }
        return latest_us;
    }
    std::optional<Arrival> pop(std::uint64_t now_us) {
        if (flights_.empty() || flights_.begin()->first > now_us)
            return std::nullopt;
        Arrival first = std::move(flights_.begin()->second);
        flights_.erase(flights_.begin());
        return first;
    }
    [[nodiscard]] std::uint64_t next_us() const {
        return flights_.empty() ? UINT64_MAX : flights_.begin()->first;
    }
    /** Somebody else puts a datagram where it arrives at once. */
    void forge(const Bytes &bytes, std::uint64_t now_us) {
        flights_.emplace(now_us, Arrival{bytes, true});
    }
    /** What is on its way is lost. */
    void clear() {
        flights_.clear();
        in_order_us_ = outage_until_us_ = 0;
    }

  private:
    static void damage(Arrival &arrival, Dice &dice) {
        arrival.damaged = true;
        if (dice.chance(0.2)) {
            arrival.bytes.resize(dice.between(1, arrival.bytes.size()));
            return;
        }
        for (std::uint64_t flips = dice.between(1, 4); flips > 0; flips--) {
            const auto flip = static_cast<std::uint8_t>(1U << dice.between(0, 7));
            const std::size_t which = dice.between(0, arrival.bytes.size() - 1);
            arrival.bytes[which] ^= flip;
        }
    }

    std::multimap<std::uint64_t, Arrival> flights_;
    std::uint64_t in_order_us_ = 0, outage_until_us_ = 0;
};

} // namespace roburoc4_tests

#endif
