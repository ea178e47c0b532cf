/* SPDX-License-Identifier: MIT
 *
 * walk_test.cpp - thousands of lives with faults, each at least 30 virtual seconds long.
 *
 *     ROBUROC4_WALK_LIVES=50000 walk_test     more lives per test
 *     ROBUROC4_WALK_SEED=N walk_test          one life again, told step by step
 */
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <string>

#include "walk.h"
#include "walk_sum.h"

using namespace roburoc4_tests;

namespace {

constexpr std::uint64_t lives_per_test = 500;
constexpr std::uint64_t tests = 8;

std::uint64_t number_from(const char *variable, std::uint64_t fallback) {
    const char *text = std::getenv(variable);
    return text != nullptr && *text != '\0' ? std::strtoull(text, nullptr, 10) : fallback;
}

std::string advice(std::uint64_t seed) {
    return "seed " + std::to_string(seed) +
           "; again, step by step: ROBUROC4_WALK_SEED=" + std::to_string(seed) + " walk_test";
}

/** The lives were not empty. */
void expect_full(const WalkSum &sum) {
    const RefereeTotals &totals = sum.totals;
    const std::uint64_t lives = sum.lives;
    EXPECT_GE(sum.virtual_us, lives * 30000000);
    EXPECT_GE(totals.speeds, 100 * lives);
    EXPECT_GE(totals.trains, 10 * lives);
    EXPECT_GE(sum.moved_cycles, 200 * lives);
    for (const std::uint64_t often : {totals.leases_over, totals.overrides, totals.stops})
        EXPECT_GE(often, lives);
    for (const std::uint64_t seldom :
         {totals.stale, totals.losses, totals.reboots, totals.clock_faults, totals.foreign})
        EXPECT_GE(seldom, lives / 10);
    EXPECT_GE(sum.monitors, lives / 50);
    EXPECT_GE(sum.forged, lives);
    EXPECT_LE(sum.deceived, lives / 5); /* else much was not judged */
}

} // namespace

class Walk : public testing::TestWithParam<std::uint64_t> {};

TEST_P(Walk, KeepsEveryPromiseOnMotionAndComesBack) {
    if (const std::uint64_t seed = number_from("ROBUROC4_WALK_SEED", 0); seed != 0) {
        if (GetParam() == 0) {
            const LifeReport life = live(seed, true);
            EXPECT_EQ("", life.complaint) << advice(seed);
        }
        return;
    }
    const std::uint64_t lives = number_from("ROBUROC4_WALK_LIVES", lives_per_test);
    WalkSum sum;
    int failures = 0;
    for (std::uint64_t i = 0; i < lives && failures < 10; i++) {
        const std::uint64_t seed = 1 + GetParam() + i * tests;
        const LifeReport life = live(seed);
        EXPECT_EQ("", life.complaint) << advice(seed);
        failures += life.complaint.empty() ? 0 : 1;
        sum.add(life);
    }
    sum.print(std::cout);
    if (failures == 0 && lives >= 100)
        expect_full(sum);
}

INSTANTIATE_TEST_SUITE_P(Lives, Walk, testing::Range<std::uint64_t>(0, tests));
