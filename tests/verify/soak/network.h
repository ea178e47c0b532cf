/* SPDX-License-Identifier: MIT
 *
 * network.h - one direction of a bad network, in virtual time: it loses, doubles, delays and
 * reorders datagrams, loses them in bursts, goes dark, and queues: a queue delays what is in it by
 * an amount that grows with time, as under a radio link that is slower than what is sent through
 * it. Each kind of datagram (answers, statuses of each service) can have a queue of its own.
 */
#ifndef ROBUROC4_SOAK_NETWORK_H
#define ROBUROC4_SOAK_NETWORK_H

#include "random.h"
#include "wire.h"

#include <cstdint>
#include <vector>

namespace soak {

/** Lanes: statuses of service k of RobotPlan::ids, and all else. */
constexpr unsigned lane_answers = 5, lane_count = 6;
constexpr std::uint8_t all_lanes = 0x3F;

/** How the network is at the moment. */
struct Weather {
    std::uint64_t delay_us = 1000; /* of every datagram */
    std::uint64_t jitter_us = 0;   /* added, evenly spread; does not reorder */
    double loss = 0;               /* probability */
    double duplicates = 0;         /* probability */
    double reordering = 0;         /* probability that one is held back by up to reorder_us */
    std::uint64_t reorder_us = 0;
    double burst = 0; /* probability that a burst of losses begins at a datagram */
    std::uint64_t burst_us = 0;
    double growth = 0;              /* of the queue: seconds of delay for each second */
    std::uint64_t queue_us = 0;     /* the queue grows no longer than this */
    std::uint64_t step_us = 0;      /* it grows in steps of this */
    std::uint8_t lanes = all_lanes; /* bits of those that queue */
    bool dark = false;              /* nothing arrives */
};

/** Random conditions of the network; each kind that a promise names occurs. `own_queues`: a queue
 *  may hold back some lanes only. */
Weather draw_weather(Random &random, bool own_queues);

class Path {
  public:
    explicit Path(std::uint64_t seed) : random_(seed) {}

    /** Changes the conditions. A queue that had grown is delivered at once, or dropped. */
    void set_weather(const Weather &weather, std::uint64_t now_us);
    void send(const Datagram &datagram, std::uint64_t now_us);
    const Weather &weather() const {
        return weather_;
    }
    /** Time of the next arrival; UINT64_MAX if nothing is in flight. */
    std::uint64_t next_arrival() const;
    /** The datagram that arrives next. */
    Datagram take();
    /** When the oldest speed in flight was sent that nothing sent later has overtaken; UINT64_MAX
     * if there is none. */
    std::uint64_t oldest_speed_us() const;

  private:
    struct Flight {
        std::uint64_t arrival_us;
        std::uint64_t number;
        Datagram datagram;
    };
    struct Later {
        bool operator()(const Flight &a, const Flight &b) const {
            return a.arrival_us != b.arrival_us ? a.arrival_us > b.arrival_us : a.number > b.number;
        }
    };
    void fly(const Datagram &datagram, std::uint64_t arrival_us);

    Random random_;
    Weather weather_;
    std::uint64_t weather_since_us_ = 0;
    std::uint64_t burst_until_us_ = 0;
    std::uint64_t last_arrival_us_[lane_count] = {};
    std::uint64_t sent_ = 0, newest_taken_ = 0;
    std::vector<Flight> flights_; /* a heap: the next arrival first */
};

} // namespace soak

#endif
