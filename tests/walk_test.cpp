/* SPDX-License-Identifier: MIT
 *
 * walk_test.cpp - thousands of lives with faults, each at least 30 virtual seconds long.
 *
 *     ROBUROC4_WALK_LIVES=50000 walk_test     more lives per test
 *     ROBUROC4_WALK_SEED=N walk_test          one life again, told step by step
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <string>

#include "walk.h"

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

struct Sum {
    RefereeTotals totals;
    std::uint64_t monitors = 0, damaged = 0, deceived = 0, virtual_us = 0;
    std::uint64_t ready_us = 0, armed_us = 0, moving_us = 0, moved_cycles = 0;

    void add(const LifeReport &life) {
        const RefereeTotals &t = life.totals;
        totals.grants += t.grants;
        totals.resumptions += t.resumptions;
        totals.armings += t.armings;
        totals.speeds += t.speeds;
        totals.zeros += t.zeros;
        totals.trains += t.trains;
        totals.leases_over += t.leases_over;
        totals.stops += t.stops;
        totals.disarms += t.disarms;
        totals.overrides += t.overrides;
        totals.stale += t.stale;
        totals.losses += t.losses;
        totals.reboots += t.reboots;
        totals.foreign += t.foreign;
        totals.clock_faults += t.clock_faults;
        totals.used += t.used;
        totals.dropped += t.dropped;
        monitors += life.monitor ? 1 : 0;
        damaged += life.damaged ? 1 : 0;
        deceived += life.deceived ? 1 : 0;
        virtual_us += life.virtual_us;
        ready_us = std::max(ready_us, life.ready_after_us);
        armed_us = std::max(armed_us, life.armed_after_us);
        moving_us = std::max(moving_us, life.moving_after_us);
        moved_cycles += life.robot_moved_cycles;
    }
    /** The lives were not empty. */
    void expect_full(std::uint64_t lives) const {
        EXPECT_GE(virtual_us, lives * 30000000);
        EXPECT_GE(totals.speeds, 100 * lives);
        EXPECT_GE(totals.trains, 10 * lives);
        EXPECT_GE(moved_cycles, 200 * lives);
        for (const std::uint64_t often : {totals.leases_over, totals.overrides, totals.stops})
            EXPECT_GE(often, lives);
        for (const std::uint64_t seldom :
             {totals.stale, totals.losses, totals.reboots, totals.clock_faults, totals.foreign})
            EXPECT_GE(seldom, lives / 10);
        EXPECT_GE(totals.resumptions, lives / 50);
        EXPECT_GE(monitors, lives / 50);
        EXPECT_LE(deceived, lives / 5); /* else much was not judged */
    }
    void print(std::uint64_t lives) const {
        std::cout << lives << " lives, " << virtual_us / 1000000 << " virtual s, " << monitors
                  << " monitors, " << damaged << " with damage (" << deceived
                  << " deceived); grants " << totals.grants << ", armings " << totals.armings
                  << ", resumptions " << totals.resumptions << ", speeds " << totals.speeds
                  << ", zeros " << totals.zeros << ", trains " << totals.trains << "; leases over "
                  << totals.leases_over << ", stops " << totals.stops << ", disarms "
                  << totals.disarms << ", overrides " << totals.overrides << ", stale "
                  << totals.stale << ", losses " << totals.losses << ", reboots " << totals.reboots
                  << ", foreign " << totals.foreign << ", clock " << totals.clock_faults
                  << "; used " << totals.used << ", dropped " << totals.dropped
                  << "; at the latest ready after " << static_cast<double>(ready_us) * 1e-6
                  << " s, armed " << static_cast<double>(armed_us) * 1e-6 << " s, moving "
                  << static_cast<double>(moving_us) * 1e-6 << " s\n";
    }
};

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
    Sum sum;
    int failures = 0;
    for (std::uint64_t i = 0; i < lives && failures < 10; i++) {
        const std::uint64_t seed = 1 + GetParam() + i * tests;
        const LifeReport life = live(seed);
        EXPECT_EQ("", life.complaint) << advice(seed);
        failures += life.complaint.empty() ? 0 : 1;
        sum.add(life);
    }
    sum.print(lives);
    if (failures == 0 && lives >= 100)
        sum.expect_full(lives);
}

INSTANTIATE_TEST_SUITE_P(Lives, Walk, testing::Range<std::uint64_t>(0, tests));
