/* SPDX-License-Identifier: MIT
 *
 * scenario.h - one random run from one seed: a member of the family, a configuration, weather,
 * mishaps and an application that may be a bad one; at the end everything is well again, and it
 * must drive.
 */
#ifndef ROBUROC4_SOAK_SCENARIO_H
#define ROBUROC4_SOAK_SCENARIO_H

#include "client.h"
#include "oracle.h"
#include "promises.h"

#include <array>
#include <cstdint>

namespace soak {

struct Outcome {
    Violation violation;
    std::uint64_t seed = 0;
    std::uint64_t lasted_us = 0;
    std::uint64_t speeds_sent = 0;
    std::uint64_t armings = 0;
    std::array<std::uint64_t, reached_count> reached{};
    std::uint32_t friendly = 0; /* 1: the robot can be driven, and was driven at the end */
};

/** Runs the scenario of `seed` with this client (not yet initialized). */
Outcome run_scenario(std::uint64_t seed, Client &client, const Promises &excluded, bool trace);

} // namespace soak

#endif
