/* SPDX-License-Identifier: MIT */
#include "network.h"

#include <algorithm>
#include <iterator>

namespace soak {

namespace {

/* It grows faster than clocks can drift apart: what grows slower cannot be told from a clock. */
void draw_queue(Random &random, Weather &weather, bool own_queues) {
    const double growths[] = {0.002, 0.02, 0.2, 0.8, 1000};
    weather.growth = random.pick(growths);
    weather.growth *= random.uniform(1, 3);
    weather.queue_us = random.between(100000, random.chance(0.2) ? 30000000 : 3000000);
    if (random.chance(0.3))
        weather.step_us = random.between(20000, 300000);
    if (own_queues && random.chance(0.5)) {
        const std::uint8_t some[] = {0x01, 0x10, 0x11, 0x1F, 1U << lane_answers};
        weather.lanes = random.pick(some);
    }
}

} // namespace

Weather draw_weather(Random &random, bool own_queues) {
    Weather weather;
    weather.delay_us = random.between(100, 8000);
    weather.jitter_us = random.between(0, 2000);
    switch (random.between(0, 10)) {
    case 0:
    case 1: /* a good cable */
        break;
    case 2: /* steady loss */
        weather.loss = random.uniform(0.01, 0.5);
        break;
    case 3:
        weather.burst = 0.02;
        weather.burst_us = random.between(50000, 1500000);
        break;
    case 4:
        weather.reordering = random.uniform(0.02, 0.3);
        weather.reorder_us = random.between(10000, 600000);
        weather.duplicates = random.uniform(0, 0.3);
        break;
    case 5: /* far away: old before it arrives */
        weather.delay_us = random.between(20000, 700000);
        break;
    case 6:
    case 7:
        draw_queue(random, weather, own_queues);
        break;
    case 8:
        weather.dark = true;
        break;
    case 9:
        weather.jitter_us = random.between(10000, 400000);
        break;
    default: /* everything at once */
        weather.loss = random.uniform(0, 0.2);
        weather.duplicates = random.uniform(0, 0.2);
        weather.reordering = random.uniform(0, 0.2);
        weather.reorder_us = random.between(1000, 300000);
        draw_queue(random, weather, own_queues);
        break;
    }
    return weather;
}

void Path::set_weather(const Weather &weather, std::uint64_t now_us) {
    const bool drop = random_.chance(0.3);
    if (drop)
        flights_.clear();
    std::uint64_t last_us = 0; /* what is sent from now on overtakes none of them */
    for (Flight &flight : flights_) {
        const std::uint64_t usual = now_us + weather.delay_us + weather.jitter_us;
        flight.arrival_us = std::min(flight.arrival_us, usual);
        last_us = std::max(last_us, flight.arrival_us);
    }
    std::make_heap(flights_.begin(), flights_.end(), Later());
    weather_ = weather;
    weather_since_us_ = now_us;
    burst_until_us_ = 0;
    std::fill(std::begin(last_arrival_us_), std::end(last_arrival_us_), last_us);
}

void Path::send(const Datagram &datagram, std::uint64_t now_us) {
    if (now_us < burst_until_us_ || weather_.dark || random_.chance(weather_.loss))
        return;
    if (weather_.burst > 0 && random_.chance(weather_.burst)) {
        burst_until_us_ = now_us + weather_.burst_us;
        return;
    }
    unsigned lane =
        is_status(datagram) ? static_cast<unsigned>(datagram.origin.index) : lane_answers;
    std::uint64_t arrival = now_us + weather_.delay_us;
    if ((weather_.lanes >> lane & 1) != 0) {
        const double grown = weather_.growth * static_cast<double>(now_us - weather_since_us_);
        std::uint64_t queue = weather_.queue_us;
        if (grown < static_cast<double>(queue))
            queue = static_cast<std::uint64_t>(grown);
        if (weather_.step_us != 0)
            queue -= queue % weather_.step_us;
        arrival += queue;
    }
    if (weather_.lanes == all_lanes)
        lane = 0; /* one queue for all */
    if (weather_.jitter_us > 0)
        arrival += random_.between(0, weather_.jitter_us);
    arrival = std::max(arrival, last_arrival_us_[lane]);
    if (weather_.reordering > 0 && random_.chance(weather_.reordering))
        fly(datagram, arrival + random_.between(0, weather_.reorder_us));
    else
        fly(datagram, last_arrival_us_[lane] = arrival);
    if (weather_.duplicates > 0 && random_.chance(weather_.duplicates))
        fly(datagram, arrival + random_.between(0, 50000));
}

void Path::fly(const Datagram &datagram, std::uint64_t arrival_us) {
    flights_.push_back({arrival_us, ++sent_, datagram});
    std::push_heap(flights_.begin(), flights_.end(), Later());
}

std::uint64_t Path::next_arrival() const {
    return flights_.empty() ? UINT64_MAX : flights_.front().arrival_us;
}

Datagram Path::take() {
    std::pop_heap(flights_.begin(), flights_.end(), Later());
    const Flight flight = flights_.back();
    flights_.pop_back();
    newest_taken_ = std::max(newest_taken_, flight.number);
    return flight.datagram;
}

std::uint64_t Path::oldest_speed_us() const {
    std::uint64_t oldest = UINT64_MAX;
    for (const Flight &flight : flights_) {
        const Datagram &datagram = flight.datagram;
        if (flight.number > newest_taken_ && is_speed_command(datagram) &&
            !command_speeds(datagram).zero())
            oldest = std::min(oldest, datagram.origin.made_us);
    }
    return oldest;
}

} // namespace soak
