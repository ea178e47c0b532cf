/* SPDX-License-Identifier: MIT
 *
 * move_family_test.cpp - moves on robots that are not the simulator: the judge of bench/family.h on a
 * sample, and robots whose odometry or sensors are wrong.
 */
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "family.h"

TEST(MoveFamily, ADrawnSampleOfRobotsMovesAsItShould) {
    const char *given = std::getenv("ROBUROC4_SEED");
    std::uint64_t seed = given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
    std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
    constexpr int sample = 200;
    int fine = 0;
    for (int i = 0; i < sample; i++) {
        const auto index = static_cast<std::uint32_t>(family_random(&seed) % FAMILY_SIZE);
        family_member member = family_member_at(index);
        member.loss = i % 2 != 0 ? 0.2 : 0;
        const family_verdict verdict = family_judge(&member, seed, 0);
        if (verdict.fault != nullptr)
            family_print(&member, &verdict);
        else
            fine++;
    }
    /* bench/moves judges all of them; see bench/RESULTS.md */
    EXPECT_GE(fine, sample * 8 / 10);
}
