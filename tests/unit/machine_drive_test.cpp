/* SPDX-License-Identifier: MIT
 *
 * The machine "drive": lets speeds out under a living lease, and zeros after them.
 * Alone: what it promises to whoever calls it, also where the joined client never leads it.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

extern "C" {
#include "joined.h"
}

namespace {

constexpr std::uint64_t ms = 1000;
constexpr std::uint64_t second = 1000000;
constexpr std::uint64_t begin_us = 100 * second;
constexpr float nan32 = std::numeric_limits<float>::quiet_NaN();

/** A drive machine that may drive: known service, armed. */
struct Driver {
    roburoc4_private_drive d{};
    roburoc4_config config{};
    std::uint32_t events = 0;
    /* speeds of the moment (4), limits: max and min linear, max and min angular, accelerations,
     * width */
    std::array<float, 13> limits{0, 0, 0, 0, 2, -2, 6, -6, 3, -3, 8, -8, 0.68F};
    std::array<float, 2> out{};

    Driver() {
        roburoc4_config_init(&config, sizeof config);
        roburoc4_drive_start(&d, begin_us);
        roburoc4_drive_service(&d, true, 6);
        roburoc4_drive_arm(&d, &events);
        events = 0;
    }
    roburoc4_result grant(float linear, float angular, std::uint64_t now_us,
                          std::uint32_t lease_us = 250000) {
        const std::array<float, 2> target{linear, angular};
        return roburoc4_drive_grant(&d, target.data(), lease_us, now_us);
    }
    bool poll(std::uint64_t now_us) {
        return roburoc4_drive_poll(&d, &config, limits.data(), now_us, out.data(), &events);
    }
    [[nodiscard]] bool speaks() const {
        return out[0] != 0 || out[1] != 0;
    }
    void status(std::array<float, 4> speeds, std::uint64_t now_us, bool overridden = false) {
        roburoc4_drive_status(&d, &config, speeds.data(), overridden, now_us, &events);
    }
    void tick(std::uint64_t now_us, roburoc4_result refusal = ROBUROC4_OK) {
        roburoc4_drive_tick(&d, refusal, now_us, &events);
    }
    /** Let a speed out, and leave driving after it. */
    void spoke(std::uint64_t now_us) {
        grant(0.5F, 0, now_us);
        ASSERT_TRUE(poll(now_us));
        ASSERT_TRUE(speaks());
    }
};

} // namespace

TEST(DriveMachine, LetsNoSpeedOutAfterTheLeaseEvenWhenNobodyToldItTheTime) {
    Driver driver;
    ASSERT_EQ(ROBUROC4_OK, driver.grant(0.5F, 0, begin_us));
    EXPECT_FALSE(driver.poll(begin_us + 250 * ms));
    EXPECT_FALSE(driver.poll(begin_us - 1)) << "a clock that went back";
    EXPECT_TRUE(driver.poll(begin_us + 250 * ms - 1));
    EXPECT_FLOAT_EQ(0.5F, driver.out[0]);
}

TEST(DriveMachine, LetsTheFirstSpeedOutAtOnceWhateverTheTime) {
    for (const std::uint64_t now_us : {std::uint64_t{0}, std::uint64_t{1}, second - 1, second,
                                       begin_us + 5, std::uint64_t{1} << 40, UINT64_MAX}) {
        Driver driver;
        roburoc4_drive_start(&driver.d, now_us);
        roburoc4_drive_service(&driver.d, true, 6);
        roburoc4_drive_arm(&driver.d, &driver.events);
        for (int i = 0; i < 2; i++) {
            EXPECT_EQ(ROBUROC4_OK, driver.grant(0.5F, 0, now_us));
            EXPECT_TRUE(driver.poll(now_us)) << now_us;
            EXPECT_FALSE(driver.poll(now_us)) << "and only once";
            roburoc4_drive_rebase(&driver.d, now_us); /* after a fault of the clock likewise */
        }
    }
}

TEST(DriveMachine, LetsNoSpeedOutWhileDisarmedUnknownOrWithoutALease) {
    for (int without = 0; without < 3; without++) {
        Driver driver;
        ASSERT_EQ(ROBUROC4_OK, driver.grant(0.5F, 0, begin_us));
        driver.d.known = without != 0;
        driver.d.armed = without != 1;
        driver.d.leased = without != 2;
        EXPECT_FALSE(driver.poll(begin_us)) << without;
        EXPECT_FALSE(driver.speaks());
    }
}

TEST(DriveMachine, EveryChangeOfTheTargetLeavesAtOnceAndNoRenewalDoes) {
    const std::array<float, 2> first{0.5F, -0.5F};
    for (const std::array<float, 2> &next :
         {std::array<float, 2>{0.5F, -0.5F}, std::array<float, 2>{0.4F, -0.5F},
          std::array<float, 2>{0.6F, -0.5F}, std::array<float, 2>{-0.5F, -0.5F},
          std::array<float, 2>{0.5F, -0.4F}, std::array<float, 2>{0.5F, -0.6F},
          std::array<float, 2>{0.5F, 0.5F}, std::array<float, 2>{0, 0}}) {
        SCOPED_TRACE(testing::Message() << next[0] << " " << next[1]);
        Driver driver;
        driver.grant(first[0], first[1], begin_us);
        ASSERT_TRUE(driver.poll(begin_us));
        driver.grant(next[0], next[1], begin_us + 5 * ms);
        const bool changed = next != first;
        const std::uint64_t due_us = begin_us + (changed ? 10 : 50) * ms;
        EXPECT_EQ(due_us, roburoc4_drive_deadline(&driver.d, &driver.config));
        EXPECT_FALSE(driver.poll(due_us - 1));
        EXPECT_TRUE(driver.poll(due_us));
        EXPECT_EQ(next, driver.out);
    }
}

TEST(DriveMachine, RepeatsACommandAtThePeriodOrHalfOfItsLease) {
    for (const std::uint32_t lease_ms : {20U, 40U, 60U, 80U, 98U, 100U, 102U, 120U, 150U, 1000U}) {
        SCOPED_TRACE(lease_ms);
        Driver driver;
        driver.grant(0.5F, 0, begin_us, lease_ms * 1000);
        ASSERT_TRUE(driver.poll(begin_us));
        const std::uint64_t due_us = begin_us + std::min(lease_ms / 2, 50U) * ms;
        EXPECT_EQ(due_us, roburoc4_drive_deadline(&driver.d, &driver.config));
        EXPECT_FALSE(driver.poll(due_us - 1));
        EXPECT_TRUE(driver.poll(due_us));
        EXPECT_TRUE(driver.speaks());
    }
}

TEST(DriveMachine, AnySpeedIsFollowedByZerosOfWhichTheFirstLeavesAtOnce) {
    for (const std::array<float, 2> &speed :
         {std::array<float, 2>{0.5F, 0}, std::array<float, 2>{-0.5F, 0},
          std::array<float, 2>{0, 0.5F}, std::array<float, 2>{0, -0.5F}}) {
        SCOPED_TRACE(testing::Message() << speed[0] << " " << speed[1]);
        Driver driver;
        driver.grant(speed[0], speed[1], begin_us);
        ASSERT_TRUE(driver.poll(begin_us));
        EXPECT_EQ(speed, driver.out);
        roburoc4_drive_interrupt(&driver.d, ROBUROC4_ERR_DISARMED, &driver.events);
        EXPECT_EQ(begin_us, roburoc4_drive_deadline(&driver.d, &driver.config));
        EXPECT_TRUE(driver.poll(begin_us)) << "though a speed just left";
        EXPECT_FALSE(driver.speaks());
        EXPECT_FALSE(driver.poll(begin_us + 50 * ms - 1));
        EXPECT_TRUE(driver.poll(begin_us + 50 * ms));
    }
}

TEST(DriveMachine, OwesItsZerosToTheServiceThatIsFoundNext) {
    /* a speed was sent and the service is gone */
    for (const std::uint16_t id : {std::uint16_t{0}, std::uint16_t{9}}) {
        Driver spoke;
        spoke.spoke(begin_us);
        roburoc4_drive_service(&spoke.d, false, id);
        EXPECT_EQ(1, spoke.d.stop_latched);
        EXPECT_EQ(0, spoke.d.leased);
        EXPECT_FALSE(spoke.poll(begin_us + second));
        roburoc4_drive_interrupt(&spoke.d, ROBUROC4_ERR_LOST, &spoke.events);
        EXPECT_FALSE(spoke.poll(begin_us + second)) << "to whom?";
        roburoc4_drive_service(&spoke.d, false, static_cast<std::uint16_t>(9 - id));
        EXPECT_EQ(1, spoke.d.stop_latched) << "gone twice: still owed";
        roburoc4_drive_service(&spoke.d, true, 16);
        EXPECT_TRUE(spoke.poll(begin_us + second));
        EXPECT_FALSE(spoke.speaks());
    }

    /* a train had sent two of its three zeros */
    Driver train;
    train.spoke(begin_us);
    roburoc4_drive_stop(&train.d);
    ASSERT_TRUE(train.poll(begin_us));
    ASSERT_TRUE(train.poll(begin_us + 50 * ms));
    roburoc4_drive_service(&train.d, false, 0);
    EXPECT_EQ(1, train.d.stop_latched);
    EXPECT_EQ(0, train.d.train);

    /* ... and a train that had sent all three owes nothing, nor does one that never spoke */
    Driver done;
    done.spoke(begin_us);
    roburoc4_drive_stop(&done.d);
    for (std::uint64_t i = 0; i < 3; i++)
        ASSERT_TRUE(done.poll(begin_us + i * 50 * ms));
    roburoc4_drive_service(&done.d, false, 0);
    EXPECT_EQ(0, done.d.stop_latched);
    Driver silent;
    roburoc4_drive_service(&silent.d, false, 0);
    EXPECT_EQ(0, silent.d.stop_latched);
    EXPECT_EQ(0, silent.d.known);
}

TEST(DriveMachine, ATrainThatWasConfirmedWantsToBePolledNow) {
    Driver driver;
    driver.spoke(begin_us);
    roburoc4_drive_stop(&driver.d);
    for (std::uint64_t i = 0; i < 3; i++)
        ASSERT_TRUE(driver.poll(begin_us + i * 50 * ms));
    EXPECT_EQ(begin_us + 150 * ms, roburoc4_drive_deadline(&driver.d, &driver.config));
    driver.status({0, 0, 0, 0}, begin_us + 101 * ms);
    EXPECT_EQ(0U, roburoc4_drive_deadline(&driver.d, &driver.config));
    EXPECT_FALSE(driver.poll(begin_us + 102 * ms));
    EXPECT_TRUE(driver.events & ROBUROC4_EVENT_STOPPED);
    EXPECT_EQ(UINT64_MAX, roburoc4_drive_deadline(&driver.d, &driver.config));
}

TEST(DriveMachine, OnlyStatusesAfterTheThirdZeroConfirmATrain) {
    Driver driver;
    driver.spoke(begin_us);
    roburoc4_drive_stop(&driver.d);
    ASSERT_TRUE(driver.poll(begin_us));
    ASSERT_TRUE(driver.poll(begin_us + 50 * ms));
    driver.status({0, 0, 0, 0}, begin_us + 60 * ms);
    EXPECT_TRUE(driver.poll(begin_us + 100 * ms));
    EXPECT_TRUE(driver.poll(begin_us + 150 * ms)) << "not confirmed since the third";
    for (const std::array<float, 4> speeds :
         {std::array<float, 4>{0.1F, 0, 0, 0}, std::array<float, 4>{0, 0, 0.1F, 0}}) {
        driver.status(speeds, begin_us + 160 * ms);
        EXPECT_EQ(0, driver.d.confirmed);
    }
    driver.status({-0.0F, 0.3F, -0.0F, 0.3F}, begin_us + 160 * ms);
    EXPECT_EQ(1, driver.d.confirmed) << "its targets count, not what it does";
}

namespace {

/** A driver on one axis, whose commander or robot may be another. */
struct OnOneAxis {
    Driver driver;
    std::size_t axis;
    float sign;
    std::uint64_t now_us = begin_us;
    bool more = false;

    OnOneAxis(std::uint32_t watchdog_ms, std::size_t axis_, float sign_)
        : axis(axis_), sign(sign_) {
        driver.config.robot_watchdog_ms = watchdog_ms;
    }
    /** Another target, 10 ms and a little after the last. */
    void steer(float speed) {
        now_us += 10 * ms + 7;
        driver.grant(axis == 0 ? sign * speed : 0, axis == 1 ? sign * speed : 0, now_us);
        EXPECT_TRUE(driver.poll(now_us));
    }
    void steer_at_half_for(std::uint64_t span_us) {
        for (const std::uint64_t end_us = now_us + span_us; now_us < end_us; more = !more)
            steer(more ? 0.5001F : 0.5F);
    }
    [[nodiscard]] bool is_ours(float target) const {
        Driver copy = driver;
        std::array<float, 4> speeds{};
        speeds[2 * axis] = sign * target;
        for (std::uint64_t i = 0; i < 3; i++)
            copy.status(speeds, now_us + i * ms);
        return copy.d.other_commander == 0;
    }
};

} // namespace

TEST(DriveMachine, TargetsAreOursWhereTheyAreZeroOrWhatWasSent) {
    for (const std::size_t axis : {std::size_t{0}, std::size_t{1}})
        for (const float sign : {1.0F, -1.0F}) {
            SCOPED_TRACE(testing::Message() << "axis " << axis << ", sign " << sign);
            OnOneAxis robot(1000, axis, sign);
            robot.steer_at_half_for(3 * second);
            for (const float target : {0.0F, 0.5F, 0.49F, 0.51F}) /* it may round */
                EXPECT_TRUE(robot.is_ours(target)) << target;
            for (const float target : {0.45F, 0.55F, 0.05F, -0.05F, -0.5F, 1.0F})
                EXPECT_FALSE(robot.is_ours(target)) << target;
        }
}

/* The smallest box around all that was sent in the last one to two watchdog times. */
TEST(DriveMachine, TargetsAreOursForAWatchdogTimeAndNotForTwo) {
    for (const std::uint32_t watchdog_ms : {100U, 1000U, 2500U})
        for (const std::size_t axis : {std::size_t{0}, std::size_t{1}})
            for (const float sign : {1.0F, -1.0F}) {
                SCOPED_TRACE(testing::Message()
                             << watchdog_ms << " ms, axis " << axis << ", sign " << sign);
                OnOneAxis robot(watchdog_ms, axis, sign);
                robot.steer_at_half_for(3 * watchdog_ms * ms);
                robot.steer(1);
                robot.steer(0.25F);
                robot.steer(0.6F);
                for (const float target : {0.25F, 0.3F, 0.7F, 1.0F})
                    EXPECT_TRUE(robot.is_ours(target)) << target;
                for (const float target : {0.2F, 1.05F})
                    EXPECT_FALSE(robot.is_ours(target)) << target;
                robot.steer_at_half_for(watchdog_ms * ms - 40 * ms);
                for (const float target : {0.25F, 1.0F})
                    EXPECT_TRUE(robot.is_ours(target)) << target;
                robot.steer_at_half_for(watchdog_ms * ms + 40 * ms);
                for (const float target : {0.25F, 1.0F})
                    EXPECT_FALSE(robot.is_ours(target)) << target;
            }
}

TEST(DriveMachine, ARobotThatStandsForASecondIsInhibitedWhateverTheTime) {
    for (const std::uint64_t since_us :
         {std::uint64_t{0}, 100 * ms, 300 * ms, second, 3 * second, begin_us}) {
        SCOPED_TRACE(since_us);
        Driver driver;
        roburoc4_drive_start(&driver.d, since_us);
        driver.status({0, 0, -0.5F, 0}, since_us);
        EXPECT_EQ(0, driver.d.inhibited);
        driver.status({0, 0, -0.5F, 0}, since_us + 10 * ms);
        EXPECT_EQ(0, driver.d.inhibited);
        driver.status({0, 0, -0.5F, 0}, since_us + second);
        EXPECT_EQ(1, driver.d.inhibited);
    }
}

TEST(DriveMachine, AFaultOfTheClockInhibitsNobody) {
    Driver driver;
    driver.status({0.5F, 0, 0, 0}, begin_us);
    driver.status({0.5F, 0, 0, 0}, begin_us + 100 * ms);
    roburoc4_drive_rebase(&driver.d, begin_us - 10 * second);
    driver.status({0.5F, 0, 0, 0}, begin_us - 10 * second + 100 * ms);
    EXPECT_EQ(0, driver.d.inhibited) << "it had a fifth of a second to move";
    EXPECT_EQ(0U, driver.events & ROBUROC4_EVENT_INHIBITED);
    driver.status({0.5F, 0, 0, 0}, begin_us - 9 * second);
    EXPECT_EQ(1, driver.d.inhibited);
}

TEST(DriveMachine, WhatWasSentBeforeAFaultOfTheClockIsStillOurs) {
    Driver driver;
    driver.spoke(begin_us);
    const std::uint64_t late_us = begin_us + driver.config.robot_watchdog_ms * ms;
    driver.grant(0.1F, 0, late_us);
    ASSERT_TRUE(driver.poll(late_us));
    roburoc4_drive_rebase(&driver.d, begin_us);
    for (std::uint64_t i = 1; i < 5; i++)
        driver.status({0.5F, 0, 0, 0}, begin_us + i * 50 * ms); /* these were on their way */
    EXPECT_EQ(0, driver.d.other_commander);
    EXPECT_EQ(1, driver.d.armed);
}

TEST(DriveMachine, ARobotThatReportsATargetOrASpeedIsNotAtRest) {
    Driver driver;
    driver.status({0, 0.05F, 0, 0.1F}, begin_us);
    EXPECT_EQ(0, driver.d.moving) << "noise";
    for (const std::array<float, 4> speeds :
         {std::array<float, 4>{0.1F, 0, 0, 0}, std::array<float, 4>{0, 0, 0.1F, 0},
          std::array<float, 4>{0, -0.2F, 0, 0}, std::array<float, 4>{0, 0, 0, 0.3F}}) {
        driver.status(speeds, begin_us);
        EXPECT_EQ(1, driver.d.moving);
        driver.status({0, 0, 0, 0}, begin_us);
        EXPECT_EQ(0, driver.d.moving);
    }
}

TEST(DriveMachine, ATargetThatIsNoNumberIsNobodysOfOurs) {
    for (const std::array<float, 4> speeds :
         {std::array<float, 4>{nan32, 0, 0, 0}, std::array<float, 4>{0, 0, nan32, 0},
          std::array<float, 4>{std::numeric_limits<float>::infinity(), 0, 0, 0}}) {
        Driver driver;
        for (std::uint64_t i = 0; i < 2; i++)
            driver.status(speeds, begin_us + i * 50 * ms);
        EXPECT_EQ(0, driver.d.other_commander);
        driver.status(speeds, begin_us + 100 * ms);
        EXPECT_EQ(1, driver.d.other_commander);
        EXPECT_EQ(0, driver.d.armed);
        EXPECT_EQ(1, driver.d.moving) << "it cannot be said to stand";
        EXPECT_EQ(ROBUROC4_ERR_OTHER_COMMANDER, driver.d.disarm_cause);
    }
}

TEST(DriveMachine, WhatIsNoNumberIsNotForeignUnderTheOverrideOrWhereTargetsAreOurs) {
    Driver overridden;
    for (std::uint64_t i = 0; i < 5; i++)
        overridden.status({nan32, 0, 0, 0}, begin_us + i * 50 * ms, true);
    EXPECT_EQ(0, overridden.d.other_commander);
    EXPECT_EQ(1, overridden.d.moving);
    Driver ours;
    for (std::uint64_t i = 0; i < 5; i++)
        ours.status({0, nan32, 0, 0}, begin_us + i * 50 * ms);
    EXPECT_EQ(0, ours.d.other_commander);
    EXPECT_EQ(1, ours.d.moving);
    EXPECT_EQ(1, ours.d.armed);
}
