/* SPDX-License-Identifier: MIT
 *
 * The small machines of the client, each alone: what they promise to whoever calls them, also in
 * situations from which the joined client keeps them away.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <string>

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
        return roburoc4_drive_grant(&d, &config, target.data(), lease_us, now_us, &events);
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
        roburoc4_drive_tick(&d, &config, refusal, now_us, &events);
    }
    /** Let a speed out, and leave driving after it. */
    void spoke(std::uint64_t now_us) {
        grant(0.5F, 0, now_us);
        ASSERT_TRUE(poll(now_us));
        ASSERT_TRUE(speaks());
    }
};

} // namespace

/* ---- drive ---- */

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
        roburoc4_drive_interrupt(&driver.d, &driver.config, ROBUROC4_ERR_DISARMED, &driver.events);
        EXPECT_EQ(begin_us, roburoc4_drive_deadline(&driver.d, &driver.config));
        EXPECT_TRUE(driver.poll(begin_us)) << "though a speed just left";
        EXPECT_FALSE(driver.speaks());
        EXPECT_FALSE(driver.poll(begin_us + 50 * ms - 1));
        EXPECT_TRUE(driver.poll(begin_us + 50 * ms));
    }
}

TEST(DriveMachine, ResumesAfterTheChosenCausesOnly) {
    for (roburoc4_result cause = ROBUROC4_ERR_NOT_NEUTRAL; cause < 0; cause++) {
        std::uint32_t bit = 0;
        switch (cause) {
        case ROBUROC4_ERR_OVERRIDE:
            bit = ROBUROC4_RESUME_OVERRIDE;
            break;
        case ROBUROC4_ERR_REBOOT:
            bit = ROBUROC4_RESUME_REBOOT;
            break;
        case ROBUROC4_ERR_LOST:
        case ROBUROC4_ERR_NOT_READY:
        case ROBUROC4_ERR_STALE_DIFFERENTIAL:
        case ROBUROC4_ERR_STALE_IOCARD:
            bit = ROBUROC4_RESUME_LOSS;
            break;
        default:
            break;
        }
        for (std::uint32_t resume = 0; resume < 8; resume++) {
            SCOPED_TRACE(testing::Message() << "cause " << cause << ", resume " << resume);
            Driver driver;
            driver.config.resume = resume;
            roburoc4_drive_interrupt(&driver.d, &driver.config, cause, &driver.events);
            EXPECT_EQ(0, driver.d.armed);
            driver.tick(begin_us);
            const bool resumes = (resume & bit) != 0;
            EXPECT_EQ(resumes ? ROBUROC4_OK : cause, driver.grant(0, 0, begin_us));
            EXPECT_EQ(resumes ? 1 : 0, driver.d.armed);
        }
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
        roburoc4_drive_interrupt(&spoke.d, &spoke.config, ROBUROC4_ERR_LOST, &spoke.events);
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
        return copy.d.foreign == 0;
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
    EXPECT_EQ(0, driver.d.foreign);
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
        EXPECT_EQ(0, driver.d.foreign);
        driver.status(speeds, begin_us + 100 * ms);
        EXPECT_EQ(1, driver.d.foreign);
        EXPECT_EQ(0, driver.d.armed);
        EXPECT_EQ(1, driver.d.moving) << "it cannot be said to stand";
        EXPECT_EQ(ROBUROC4_ERR_FOREIGN, driver.d.disarm_cause);
    }
}

TEST(DriveMachine, WhatIsNoNumberIsNotForeignUnderTheOverrideOrWhereTargetsAreOurs) {
    Driver overridden;
    for (std::uint64_t i = 0; i < 5; i++)
        overridden.status({nan32, 0, 0, 0}, begin_us + i * 50 * ms, true);
    EXPECT_EQ(0, overridden.d.foreign);
    EXPECT_EQ(1, overridden.d.moving);
    Driver ours;
    for (std::uint64_t i = 0; i < 5; i++)
        ours.status({0, nan32, 0, 0}, begin_us + i * 50 * ms);
    EXPECT_EQ(0, ours.d.foreign);
    EXPECT_EQ(1, ours.d.moving);
    EXPECT_EQ(1, ours.d.armed);
}

/* ---- requests ---- */

namespace {

constexpr ask get_directory{
    0, 0, ROBUROC4_ACTION_GET, ROBUROC4_SERVICE_DIRECTORY, 0, REQUEST_FOREVER};

ask get(std::uint8_t kind) {
    return {kind, 0, ROBUROC4_ACTION_GET, kind, 0, 3};
}

} // namespace

TEST(Requests, HaveRoomForFourAndNoneTwice) {
    requests r{};
    for (std::uint8_t kind = 2; kind < 6; kind++) {
        const ask a = get(kind);
        EXPECT_TRUE(roburoc4_requests_free(&r, 0));
        EXPECT_TRUE(roburoc4_requests_begin(&r, &a));
        EXPECT_FALSE(roburoc4_requests_begin(&r, &a)) << "it is open";
    }
    for (std::uint32_t keep = 0; keep < 5; keep++)
        EXPECT_FALSE(roburoc4_requests_free(&r, keep)) << keep;
    const ask fifth = get(6);
    EXPECT_FALSE(roburoc4_requests_begin(&r, &fifth));
    roburoc4_requests_cancel(&r, ROBUROC4_ACTION_GET, 3);
    EXPECT_TRUE(roburoc4_requests_free(&r, 0));
    EXPECT_FALSE(roburoc4_requests_free(&r, 1));
    EXPECT_TRUE(roburoc4_requests_begin(&r, &fifth));
}

/* Behind the four stands, as if it were a fifth, an open one: whoever looks too far finds it. */
TEST(Requests, NothingBehindTheFourIsReadOrChanged) {
    struct {
        requests r;
        slot behind;
    } memory{};
    const ask asked = get(2);
    memory.behind = {asked, 1, 2, 1, 0, 100000, begin_us};
    const slot before = memory.behind;
    requests *r = &memory.r;
    slot *given_up = nullptr;
    EXPECT_TRUE(roburoc4_requests_free(r, 3));
    r->fixed_id = 1;
    EXPECT_TRUE(roburoc4_requests_free(r, 0));
    r->fixed_id = 0;
    EXPECT_FALSE(roburoc4_requests_open(r, &asked));
    EXPECT_EQ(UINT64_MAX, roburoc4_requests_deadline(r));
    const std::array<std::uint8_t, 5> answer{2, ROBUROC4_ACTION_GET, 2, 0, 0};
    EXPECT_EQ(nullptr, roburoc4_requests_match(r, answer.data(), answer.size(), begin_us));
    EXPECT_EQ(nullptr, roburoc4_requests_due(r, 100, begin_us + second, &given_up));
    EXPECT_EQ(nullptr, given_up);
    roburoc4_requests_cancel(r, ROBUROC4_ACTION_GET, 2);
    roburoc4_requests_cancel_all(r);
    roburoc4_requests_rebase(r, begin_us - second);
    roburoc4_requests_clear(r);
    r->last_id = 1;
    ASSERT_TRUE(roburoc4_requests_begin(r, &asked)) << "it is not open";
    const slot *own = roburoc4_requests_due(r, 100, begin_us, &given_up);
    ASSERT_NE(nullptr, own);
    EXPECT_EQ(2, own->id) << "no open one has it";
    for (std::uint8_t kind = 3; kind < 6; kind++) {
        const ask a = get(kind);
        EXPECT_TRUE(roburoc4_requests_begin(r, &a));
    }
    const ask fifth = get(6);
    EXPECT_FALSE(roburoc4_requests_begin(r, &fifth));
    EXPECT_EQ(0, std::memcmp(&before, &memory.behind, sizeof before));
}

TEST(Requests, AreCancelledByActionAndKindWhereverTheyStand) {
    for (std::uint8_t cancelled = 2; cancelled < 6; cancelled++) {
        requests r{};
        for (std::uint8_t kind = 2; kind < 6; kind++) {
            const ask a = get(kind);
            ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        }
        roburoc4_requests_cancel(&r, ROBUROC4_ACTION_INSERT, cancelled);
        EXPECT_FALSE(roburoc4_requests_free(&r, 0)) << "that was another question";
        roburoc4_requests_cancel(&r, ROBUROC4_ACTION_GET, cancelled);
        for (std::uint8_t kind = 2; kind < 6; kind++) {
            const ask a = get(kind);
            EXPECT_EQ(kind != cancelled, roburoc4_requests_open(&r, &a)) << int{kind};
        }
        roburoc4_requests_cancel_all(&r);
        EXPECT_TRUE(roburoc4_requests_free(&r, 3));
    }
}

TEST(Requests, OfOneActionAndKindAreAllCancelled) {
    requests r{};
    const ask other = get(2);
    ASSERT_TRUE(roburoc4_requests_begin(&r, &other));
    for (std::uint16_t index = 0; index < 3; index++) {
        const ask text{0, index, ROBUROC4_ACTION_QUERY, ROBUROC4_SERVICE_DIRECTORY, 4, 10};
        ASSERT_TRUE(roburoc4_requests_begin(&r, &text));
    }
    roburoc4_requests_cancel(&r, ROBUROC4_ACTION_QUERY, ROBUROC4_SERVICE_DIRECTORY);
    EXPECT_TRUE(roburoc4_requests_free(&r, 2));
    EXPECT_TRUE(roburoc4_requests_open(&r, &other));
}

TEST(Requests, AreTriedAsOftenAsTheySayAndThenGivenUp) {
    for (std::uint8_t tries = 1; tries < 12; tries++) {
        requests r{};
        ask a = get(2);
        a.max_tries = tries;
        ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        slot *given_up = nullptr;
        std::uint64_t now_us = begin_us;
        for (int i = 0; i < tries; i++, now_us = roburoc4_requests_deadline(&r)) {
            ASSERT_NE(nullptr, roburoc4_requests_due(&r, 100, now_us, &given_up)) << i;
            EXPECT_EQ(nullptr, given_up);
        }
        EXPECT_EQ(nullptr, roburoc4_requests_due(&r, 100, now_us - 1, &given_up));
        EXPECT_EQ(nullptr, given_up) << "the last try is waited for, too";
        EXPECT_EQ(nullptr, roburoc4_requests_due(&r, 100, now_us, &given_up));
        EXPECT_EQ(&r.slots[0], given_up);
        EXPECT_TRUE(roburoc4_requests_free(&r, 3));
    }
}

/* A whole round of ids later the next ones are those of requests that are still open. */
TEST(Requests, NeverShareAnId) {
    requests r{};
    slot *given_up = nullptr;
    for (std::uint8_t kind = 2; kind < 5; kind++) {
        const ask a = get(kind);
        ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        ASSERT_NE(nullptr, roburoc4_requests_due(&r, 100, begin_us, &given_up));
    }
    const std::uint8_t first = r.slots[0].id;
    const ask last = get(5);
    ASSERT_TRUE(roburoc4_requests_begin(&r, &last));
    for (std::uint8_t before = 0; before < 3; before++) {
        requests later = r;
        later.last_id = static_cast<std::uint8_t>(first - 1 + before);
        const slot *s = roburoc4_requests_due(&later, 100, begin_us, &given_up);
        ASSERT_NE(nullptr, s);
        EXPECT_EQ(first + 3, s->id) << int{before};
    }
    for (int own = 0; own < 3; own++) { /* those of closed ones are free again */
        requests later = r;
        later.last_id = static_cast<std::uint8_t>(first - 1);
        later.slots[own].open = 0;
        const slot *s = roburoc4_requests_due(&later, 100, begin_us, &given_up);
        ASSERT_NE(nullptr, s);
        EXPECT_EQ(first + own, s->id);
    }
}

TEST(Requests, UseAllIdsButThoseWithAMeaning) {
    requests r{};
    slot *given_up = nullptr;
    const ask a = get(2);
    std::array<int, 256> used{};
    for (int i = 0; i < 253; i++) {
        ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        slot *s = roburoc4_requests_due(&r, 100, begin_us, &given_up);
        ASSERT_NE(nullptr, s);
        used[s->id]++;
        roburoc4_requests_close(&r, s, begin_us);
    }
    for (int id = 0; id < 256; id++)
        EXPECT_EQ(id >= 2 && id <= 254 ? 1 : 0, used[static_cast<std::size_t>(id)]) << id;
}

TEST(Requests, OnlyWhoConnectsTriesTheManualId) {
    const auto uses_it = [](const ask &a) {
        requests r{};
        slot *given_up = nullptr;
        EXPECT_TRUE(roburoc4_requests_begin(&r, &a));
        bool used = false;
        for (std::uint64_t i = 0; i < 20; i++) {
            const slot *s = roburoc4_requests_due(&r, 100, begin_us + i * second, &given_up);
            EXPECT_NE(nullptr, s);
            used = used || (s != nullptr && s->id == ROBUROC4_HEADER_MANUAL);
        }
        return used;
    };
    EXPECT_TRUE(uses_it(get_directory));
    for (const std::uint8_t tries : std::array<std::uint8_t, 2>{REQUEST_FOREVER, 100}) {
        ask battery = get(4);
        battery.max_tries = tries;
        EXPECT_FALSE(uses_it(battery));
        ask text{0, 1, ROBUROC4_ACTION_QUERY, ROBUROC4_SERVICE_DIRECTORY, 4, tries};
        EXPECT_FALSE(uses_it(text));
    }
    ask probe = get_directory;
    probe.max_tries = 100;
    EXPECT_FALSE(uses_it(probe)) << "that the robot is there is known";
}

TEST(Requests, ThatWereNotSentMatchNothingAndAreDueNow) {
    requests r{};
    const ask a = get(2);
    ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
    EXPECT_EQ(0U, roburoc4_requests_deadline(&r));
    const std::array<std::uint8_t, 5> answer{0, ROBUROC4_ACTION_GET, 2, 0, 0};
    EXPECT_EQ(nullptr, roburoc4_requests_match(&r, answer.data(), answer.size(), begin_us));
    slot *given_up = nullptr;
    ASSERT_NE(nullptr, roburoc4_requests_due(&r, 100, begin_us, &given_up));
    EXPECT_EQ(begin_us + 100 * ms, roburoc4_requests_deadline(&r));
}

TEST(Requests, AShortDatagramThatIsNoErrorBelongsToNone) {
    requests r{};
    slot *given_up = nullptr;
    ASSERT_TRUE(roburoc4_requests_begin(&r, &get_directory));
    const slot *open = roburoc4_requests_due(&r, 100, begin_us, &given_up);
    ASSERT_NE(nullptr, open);
    const std::array<std::uint8_t, 4> cut{ROBUROC4_HEADER_MANUAL, ROBUROC4_ACTION_GET, 0, 0};
    for (int i = 0; i < 5; i++)
        EXPECT_EQ(nullptr, roburoc4_requests_match(&r, cut.data(), cut.size(), begin_us));
    EXPECT_EQ(0, r.fixed_id);
    const std::array<std::uint8_t, 4> own{open->id, ROBUROC4_ACTION_GET, 0, 0};
    EXPECT_EQ(nullptr, roburoc4_requests_match(&r, own.data(), own.size(), begin_us));
    const std::array<std::uint8_t, 1> error{ROBUROC4_HEADER_ERROR};
    EXPECT_EQ(open, roburoc4_requests_match(&r, error.data(), error.size(), begin_us));
}

/* Also on a clock that has just begun. */
TEST(Requests, AnErrorThatFitsSeveralEndsTheOneThatHasWaitedLongest) {
    for (std::size_t longest = 0; longest < std::size(requests{}.slots); longest++) {
        for (std::uint64_t sent_us = 0; sent_us < 4; sent_us++) {
            requests r{};
            for (std::uint8_t i = 0; i < 4; i++) {
                r.slots[i] = {get(2), 1, static_cast<std::uint8_t>(i + 2), 1, 0, 100000, 0};
                r.slots[i].sent_us = i == longest ? sent_us : 10 + i;
            }
            const std::array<std::uint8_t, 1> error{ROBUROC4_HEADER_ERROR};
            EXPECT_EQ(&r.slots[longest],
                      roburoc4_requests_match(&r, error.data(), error.size(), 20))
                << longest << " " << sent_us;
        }
    }
}

/* Also on a clock that has just begun. */
TEST(Requests, WithOneIdForAllWaitForLateAnswersOfTheLast) {
    for (const std::uint64_t start_us : {std::uint64_t{0}, begin_us}) {
        SCOPED_TRACE(start_us);
        requests r{};
        r.fixed_id = 1;
        slot *given_up = nullptr;
        const ask a = get(2);
        ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        slot *s = roburoc4_requests_due(&r, 10, start_us, &given_up);
        ASSERT_NE(nullptr, s);
        EXPECT_EQ(ROBUROC4_HEADER_MANUAL, s->id);
        roburoc4_requests_close(&r, s, start_us);
        EXPECT_TRUE(roburoc4_requests_free(&r, 0)) << "of a single try no answer is late";
        EXPECT_EQ(UINT64_MAX, roburoc4_requests_deadline(&r));

        ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        ASSERT_EQ(s, roburoc4_requests_due(&r, 10, start_us, &given_up));
        ASSERT_EQ(s, roburoc4_requests_due(&r, 10, start_us + 10 * ms, &given_up)) << "second try";
        EXPECT_EQ(ROBUROC4_HEADER_MANUAL, s->id);
        roburoc4_requests_close(&r, s, start_us + 20 * ms);
        for (const std::uint64_t wait_us : {20 * ms, 40 * ms, 120 * ms - 1}) {
            EXPECT_EQ(nullptr, roburoc4_requests_due(&r, 10, start_us + wait_us, &given_up));
            EXPECT_FALSE(roburoc4_requests_free(&r, 0)) << wait_us;
            EXPECT_EQ(start_us + 120 * ms, roburoc4_requests_deadline(&r));
        }
        ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        EXPECT_EQ(0U, roburoc4_requests_deadline(&r)) << "what is open counts";
        roburoc4_requests_cancel_all(&r);
        EXPECT_EQ(nullptr, roburoc4_requests_due(&r, 10, start_us + 120 * ms, &given_up));
        EXPECT_TRUE(roburoc4_requests_free(&r, 0));
        EXPECT_EQ(UINT64_MAX, roburoc4_requests_deadline(&r));
    }
}

/* Once a directory came for 0x01, what was tried three times or more is tried with it, too. */
TEST(Requests, UseTheManualIdWhereNoOtherWasEverAnswered) {
    for (std::uint64_t begun = 0; begun < 6; begun++) {
        requests r{};
        slot *given_up = nullptr;
        ask other = get(2);
        other.max_tries = 20;
        const slot *directory = nullptr;
        ASSERT_TRUE(roburoc4_requests_begin(&r, &get_directory));
        for (std::uint64_t i = 0; i < 6; i++) {
            if (i == begun) {
                ASSERT_TRUE(roburoc4_requests_begin(&r, &other));
            }
            while (const slot *s =
                       roburoc4_requests_due(&r, 100, begin_us + i * second, &given_up)) {
                directory = s->ask.kind == 0 ? s : directory;
                EXPECT_EQ(s == directory && i == 5, s->id == ROBUROC4_HEADER_MANUAL) << i;
            }
        }
        const std::array<std::uint8_t, 5> answer{ROBUROC4_HEADER_MANUAL, 0, 0, 0, 0};
        slot *answered =
            roburoc4_requests_match(&r, answer.data(), answer.size(), begin_us + 5 * second);
        ASSERT_EQ(directory, answered);
        roburoc4_requests_close(&r, answered, begin_us + 5 * second);
        std::uint64_t tries = 6 - begun;
        for (std::uint64_t i = 6; i < 10; i++, tries++) {
            const slot *s = roburoc4_requests_due(&r, 100, begin_us + i * second, &given_up);
            ASSERT_NE(nullptr, s);
            EXPECT_EQ(tries >= 3, s->id == ROBUROC4_HEADER_MANUAL) << begun << " " << i;
            EXPECT_EQ(tries >= 3, r.fixed_id == 1);
            EXPECT_EQ(r.fixed_id, r.announce);
        }
    }
}

/* Of any length; of several answers to one try one counts; of what is open only this is kept. */
TEST(Requests, ThreeTriesThatSawOnlyTheManualIdLeadToFixedId) {
    for (const std::size_t size : {std::size_t{5}, std::size_t{6}, std::size_t{60}}) {
        requests r{};
        slot *given_up = nullptr;
        const ask other = get(2);
        const ask asked = get(3);
        ASSERT_TRUE(roburoc4_requests_begin(&r, &other));
        ASSERT_TRUE(roburoc4_requests_begin(&r, &asked));
        std::array<std::uint8_t, 60> answer{ROBUROC4_HEADER_MANUAL, ROBUROC4_ACTION_GET, 3, 0, 0};
        for (std::uint64_t i = 0; i < 3; i++) {
            const std::uint64_t now_us = begin_us + i * 200 * ms;
            EXPECT_EQ(nullptr, roburoc4_requests_match(&r, answer.data(), size, now_us)) << i;
            for (int both = 0; both < 2; both++)
                ASSERT_NE(nullptr, roburoc4_requests_due(&r, 100, now_us, &given_up));
            for (int again = 0; i < 2 && again < 5; again++)
                EXPECT_EQ(nullptr, roburoc4_requests_match(&r, answer.data(), size, now_us)) << i;
        }
        EXPECT_EQ(0, r.fixed_id);
        const slot before = r.slots[1];
        slot *s = roburoc4_requests_match(&r, answer.data(), size, begin_us + second);
        ASSERT_NE(nullptr, s);
        EXPECT_EQ(0, std::memcmp(&asked, &s->ask, sizeof asked));
        EXPECT_EQ(before.sent_us, s->sent_us) << "of the round trip";
        EXPECT_EQ(1, r.fixed_id);
        EXPECT_EQ(1, r.announce);
        EXPECT_TRUE(roburoc4_requests_open(&r, &asked));
        EXPECT_FALSE(roburoc4_requests_open(&r, &other));
        EXPECT_FALSE(roburoc4_requests_free(&r, 0));
        roburoc4_requests_cancel_all(&r);
        EXPECT_TRUE(roburoc4_requests_free(&r, 0));
    }
}

TEST(Requests, AnswersWithAnyOtherIdThanTheManualsLeadToNoFixedId) {
    for (int id = 2; id < 256; id++) {
        requests r{};
        slot *given_up = nullptr;
        ask a = get(2);
        a.max_tries = 10;
        ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        for (std::uint64_t i = 0; i < 5; i++) {
            slot *s = roburoc4_requests_due(&r, 100, begin_us + i * second, &given_up);
            ASSERT_NE(nullptr, s);
            const std::array<std::uint8_t, 5> late{static_cast<std::uint8_t>(id),
                                                   ROBUROC4_ACTION_GET, 2, 0, 0};
            EXPECT_EQ(s->id == id ? s : nullptr,
                      roburoc4_requests_match(&r, late.data(), late.size(), begin_us + i * second));
        }
        EXPECT_EQ(0, r.fixed_id) << id;
    }
}

/* ---- link ---- */

TEST(Link, ARoundTripBeyondAllMeasureIsTheLargestNumber) {
    roburoc4_private_link l{};
    roburoc4_link_round_trip(&l, begin_us, begin_us + (std::uint64_t{1} << 40));
    EXPECT_EQ(UINT32_MAX, l.round_trip_us);
    EXPECT_EQ(UINT32_MAX, l.round_trip_min_us);
    roburoc4_link_round_trip(&l, begin_us, begin_us);
    EXPECT_EQ(1U, l.round_trip_min_us) << "0 would mean that there is none";
    EXPECT_EQ(UINT32_MAX - UINT32_MAX / 8, l.round_trip_us);
}

namespace {

/** A link with one service at 50 ms, which has brought a status of cycle 1000. */
struct Linked {
    roburoc4_private_link l{};
    std::uint64_t now_us = begin_us;

    Linked() {
        for (roburoc4_private_service &service : l.services)
            service.asked_cycles = 5;
        roburoc4_link_restart(&l);
        status(1000);
    }
    verdict status(std::uint64_t robot_cycles) {
        now_us += 50 * ms;
        return roburoc4_link_status(&l, 0, robot_cycles, now_us);
    }
};

} // namespace

TEST(Link, StatusesFromThePastAreCountedAnewAfterARestart) {
    Linked linked;
    EXPECT_EQ(VERDICT_OLD, linked.status(500));
    EXPECT_EQ(VERDICT_OLD, linked.status(505));
    roburoc4_link_restart(&linked.l);
    EXPECT_EQ(VERDICT_NEW, linked.status(510)) << "the first of the past, not the third";
    EXPECT_EQ(VERDICT_NEW, linked.status(515));
    EXPECT_EQ(VERDICT_REBOOT, linked.status(520));
}

TEST(Link, LossIsOfTheLastTwoHundredStatusesAtMostAlsoWhereHalfAreLost) {
    Linked linked;
    const roburoc4_private_service &service = linked.l.services[0];
    std::uint64_t robot_cycles = 1000;
    std::uint32_t most = 0;
    for (int i = 0; i < 1000; i++) {
        robot_cycles += i % 2 == 0 ? 5 : 15; /* two received, two lost */
        EXPECT_EQ(VERDICT_NEW, linked.status(robot_cycles));
        most = std::max(most, service.recent_received + service.recent_lost);
    }
    EXPECT_LT(most, 200U);
    EXPECT_GE(most, 190U) << "and not of much fewer";
    EXPECT_NEAR(service.recent_received, service.recent_lost, 2);
}

namespace {

/** A link that is full of figures, and what stands behind its last service. */
struct LinkInMemory {
    roburoc4_private_link l;
    roburoc4_private_values behind;
};

LinkInMemory full_link() {
    LinkInMemory link;
    std::memset(&link, 0xA5, sizeof link);
    return link;
}

} // namespace

TEST(Link, ARestartForgetsTheOrderOfStatusesAndKeepsTheTotals) {
    LinkInMemory link = full_link();
    LinkInMemory wanted = link;
    wanted.l.mapped = 0;
    wanted.l.back_count = 0;
    wanted.l.round_trip_us = 0;
    wanted.l.round_trip_min_us = 0;
    for (roburoc4_private_service &service : wanted.l.services) {
        service.seen = 0;
        service.period_cycles = service.asked_cycles;
        service.gap_count = 0;
        service.gap_min = UINT16_MAX;
    }
    roburoc4_link_restart(&link.l);
    EXPECT_EQ(0, std::memcmp(&wanted, &link, sizeof link));
}

TEST(Link, SpoiltItHasNoFreshStatusAndAllItsFigures) {
    LinkInMemory link = full_link();
    LinkInMemory wanted = link;
    for (roburoc4_private_service &service : wanted.l.services)
        service.fresh = 0;
    roburoc4_link_spoil(&link.l);
    EXPECT_EQ(0, std::memcmp(&wanted, &link, sizeof link));
    /* ... and on another clock, all that waits for something begins to wait now */
    for (roburoc4_private_service &service : wanted.l.services)
        service.inserted_us = begin_us;
    wanted.l.last_used_us = begin_us;
    wanted.l.mapped = 0;
    link = full_link();
    roburoc4_link_rebase(&link.l, begin_us);
    EXPECT_EQ(0, std::memcmp(&wanted, &link, sizeof link));
}

TEST(Link, JitterIsThatOfRfc3550) {
    Linked linked;
    const roburoc4_private_service &service = linked.l.services[0];
    const std::uint64_t origin_us = linked.now_us;
    std::uint64_t robot_cycles = 1000;
    double before_us = 0;
    double jitter_us = 0;
    std::uint32_t x = 1;
    for (int i = 0; i < 500; i++) {
        x = x * 1664525U + 1013904223U;
        const std::uint64_t delay_us = i % 100 < 60 ? x / 65536U % 30000U : 0;
        robot_cycles += 1 + x % 10U; /* that some are lost makes no difference */
        const std::uint64_t now_us =
            origin_us + (robot_cycles - 1000) * ROBUROC4_CYCLE_US + delay_us;
        ASSERT_EQ(VERDICT_NEW, roburoc4_link_status(&linked.l, 0, robot_cycles, now_us));
        const auto transit_us = static_cast<double>(delay_us);
        jitter_us += (std::abs(transit_us - before_us) - jitter_us) / 16;
        before_us = transit_us;
        EXPECT_NEAR(jitter_us, service.jitter_us, 16) << i << ": in whole microseconds";
    }
}

TEST(Link, OnlyAnOlderCountAfterANewSubscriptionOfASilentServiceIsARestart) {
    struct Case {
        std::int64_t subscribed_us; /* after the last status, which was 1000 */
        std::uint64_t silence_us, robot_cycles;
        verdict wanted;
    };
    for (const Case &c : {Case{1200000, 1500 * ms, 999, VERDICT_REBOOT},
                          Case{1200000, 1500 * ms, 1000, VERDICT_OLD}, /* a copy of the last */
                          Case{1200000, 1500 * ms, 1001, VERDICT_NEW},
                          Case{50000, 100 * ms, 999, VERDICT_OLD}, /* it never was silent */
                          Case{0, 1500 * ms, 999, VERDICT_OLD},    /* nor subscribed to anew */
                          Case{-1000000, 1500 * ms, 999, VERDICT_OLD}}) {
        SCOPED_TRACE(testing::Message() << c.subscribed_us << " us, cycle " << c.robot_cycles);
        Linked linked;
        linked.l.services[0].inserted_us =
            linked.now_us + static_cast<std::uint64_t>(c.subscribed_us);
        const std::uint64_t now_us = linked.now_us + c.silence_us;
        EXPECT_EQ(c.wanted, roburoc4_link_status(&linked.l, 0, c.robot_cycles, now_us));
    }
}

TEST(Link, ARestartIsToldUntilItIsHeeded) {
    Linked linked;
    for (std::uint64_t i = 0; i < 10; i++)
        EXPECT_EQ(i < 2 ? VERDICT_OLD : VERDICT_REBOOT, linked.status(500 + i)) << i;
    EXPECT_EQ(1U, linked.l.services[0].received);
}

TEST(Link, OnlyAnOlderCountAfterALossIsARestart) {
    for (const std::uint64_t back : {1U, 0U}) {
        Linked linked;
        roburoc4_link_restart(&linked.l);
        linked.l.resubscribed = 1;
        EXPECT_EQ(back > 0 ? VERDICT_REBOOT : VERDICT_NEW, linked.status(1000 - back)) << back;
    }
    /* the first one that is good ends the suspicion, for all services */
    Linked linked;
    linked.l.resubscribed = 1;
    EXPECT_EQ(VERDICT_NEW, linked.status(1001));
    EXPECT_EQ(VERDICT_NEW, roburoc4_link_status(&linked.l, 1, 990, linked.now_us));
    EXPECT_EQ(VERDICT_OLD, linked.status(1000));
}

TEST(Link, WhatCameBeforeTheFirstStatusIsLateAndNoCopy) {
    Linked linked;
    const roburoc4_private_service &service = linked.l.services[0];
    for (std::uint64_t back = 1; back <= 70; back++)
        EXPECT_EQ(VERDICT_OLD, linked.status(1000 - back));
    EXPECT_EQ(70U, service.late);
    EXPECT_EQ(0U, service.duplicates);
}

TEST(Link, ACopyIsACopyWhateverCameBetween) {
    for (std::uint64_t gap = 1; gap <= 63; gap++) {
        Linked linked;
        const roburoc4_private_service &service = linked.l.services[0];
        EXPECT_EQ(VERDICT_NEW, linked.status(1000 + gap));
        EXPECT_EQ(VERDICT_OLD, linked.status(1000 + gap));
        EXPECT_EQ(VERDICT_OLD, linked.status(1000));
        EXPECT_EQ(2U, service.duplicates) << gap;
        EXPECT_EQ(0U, service.late) << gap;
    }
}

TEST(Link, AVeryLateCopyTakesNoLossBack) {
    for (const std::uint64_t behind : {64U, 65U, 90U}) {
        Linked linked;
        const roburoc4_private_service &service = linked.l.services[0];
        EXPECT_EQ(VERDICT_NEW, linked.status(1000 + behind));
        const std::uint32_t lost = service.lost;
        EXPECT_GT(lost, 0U);
        EXPECT_EQ(VERDICT_OLD, linked.status(1000)); /* which had arrived long ago */
        EXPECT_EQ(lost, service.lost) << behind;
        EXPECT_EQ(VERDICT_OLD, linked.status(1000 + behind));
        EXPECT_EQ(1U, service.duplicates) << "the newest once more";
    }
}

TEST(Link, APauseOfTheRobotIsNoLoss) {
    for (const std::uint64_t gap : {std::uint64_t{6001}, std::uint64_t{65536 + 5},
                                    std::uint64_t{1} << 32, std::uint64_t{1} << 60}) {
        Linked linked;
        const roburoc4_private_service &service = linked.l.services[0];
        EXPECT_EQ(VERDICT_NEW, linked.status(1000 + gap));
        EXPECT_EQ(VERDICT_NEW, linked.status(1005 + gap));
        EXPECT_EQ(0U, service.lost) << gap;
        EXPECT_EQ(5U, service.period_cycles);
        EXPECT_EQ(3U, service.received);
    }
}

TEST(Link, ThePeriodIsTheShortestGapWhereverItStands) {
    for (int at = 0; at < 16; at++) {
        for (const bool once : {false, true}) {
            Linked linked;
            std::uint64_t robot_cycles = 1000;
            for (int i = 0; i < 16; i++) {
                robot_cycles += (i == at) == once ? 10 : 20;
                EXPECT_EQ(VERDICT_NEW, linked.status(robot_cycles));
            }
            EXPECT_EQ(10U, linked.l.services[0].period_cycles) << at << " " << once;
        }
    }
}

TEST(Link, LossOfBeforeIsKeptWhereThePeriodTurnsOutToBeShorter) {
    for (const std::uint64_t period : {4U, 3U, 2U, 1U}) {
        Linked linked;
        const roburoc4_private_service &service = linked.l.services[0];
        EXPECT_EQ(VERDICT_NEW, linked.status(1020)); /* three are lost */
        for (std::uint64_t i = 1; i <= 20; i++)
            EXPECT_EQ(VERDICT_NEW, linked.status(1020 + i * period));
        EXPECT_EQ(period, service.period_cycles);
        EXPECT_EQ(3U, service.lost);
        EXPECT_EQ(3U, service.recent_lost);
    }
}

TEST(Link, WhatComesLateAfterALongGapIsLateAndNoCopy) {
    Linked linked;
    const roburoc4_private_service &service = linked.l.services[0];
    EXPECT_EQ(VERDICT_NEW, linked.status(1100)); /* 19 are lost */
    for (std::uint64_t i = 1; i <= 12; i++) {
        EXPECT_EQ(VERDICT_OLD, linked.status(1100 - 5 * i));
        EXPECT_EQ(19 - i, service.lost);
    }
    EXPECT_EQ(12U, service.late);
    EXPECT_EQ(0U, service.duplicates);
}

TEST(Link, ANetworkThatSwapsEveryTwoStatusesLosesNone) {
    Linked linked;
    const roburoc4_private_service &service = linked.l.services[0];
    for (std::uint64_t i = 1; i <= 200; i++) {
        EXPECT_EQ(VERDICT_NEW, linked.status(1000 + 10 * i));
        EXPECT_LE(service.lost, 1U) << "the one that is on its way";
        EXPECT_LE(service.recent_lost, 1U);
        EXPECT_EQ(VERDICT_OLD, linked.status(1000 + 10 * i - 5));
        EXPECT_EQ(0U, service.lost) << i;
        EXPECT_EQ(0U, service.recent_lost) << i;
    }
    EXPECT_EQ(200U, service.late);
}

TEST(Link, ALateStatusTakesBackNoMoreLossThanThereIs) {
    for (std::uint64_t missing = 180; missing < 205; missing++) {
        Linked linked;
        const roburoc4_private_service &service = linked.l.services[0];
        for (std::uint64_t i = 1; i <= missing + 10; i++)
            if (i != missing) {
                EXPECT_EQ(VERDICT_NEW, linked.status(1000 + 5 * i));
            }
        EXPECT_LE(service.recent_lost, 1U);
        EXPECT_EQ(VERDICT_OLD, linked.status(1000 + 5 * missing));
        EXPECT_EQ(0U, service.recent_lost) << missing;
        EXPECT_EQ(0U, service.lost);
        EXPECT_EQ(missing + 10, service.received + service.late - 1);
    }
}

TEST(Link, WhatWasNeverSentIsNoLossHoweverOftenThePeriodGrows) {
    Linked linked;
    const roburoc4_private_service &service = linked.l.services[0];
    std::uint64_t robot_cycles = 1000;
    for (const std::uint64_t period : {5U, 10U, 40U, 80U}) {
        for (int i = 0; i < 16; i++) { /* after so many it is believed */
            robot_cycles += period == 5 && i == 7 ? 3 * period : period; /* two are lost */
            EXPECT_EQ(VERDICT_NEW, linked.status(robot_cycles));
        }
        EXPECT_EQ(period, service.period_cycles);
        EXPECT_EQ(2U, service.lost);
        EXPECT_EQ(2U, service.recent_lost);
    }
}

TEST(Link, TheFirstRoundTripIsTakenWholeAndOfAllTheShortestIsKept) {
    roburoc4_private_link l{};
    roburoc4_link_round_trip(&l, 1000, 9000);
    EXPECT_EQ(8000U, l.round_trip_us);
    EXPECT_EQ(8000U, l.round_trip_min_us);
    roburoc4_link_round_trip(&l, 1000, 17000);
    EXPECT_EQ(9000U, l.round_trip_us) << "an eighth of the way";
    EXPECT_EQ(8000U, l.round_trip_min_us);
    roburoc4_link_round_trip(&l, 1000, 1000);
    EXPECT_EQ(1U, l.round_trip_min_us) << "0 would be none";
}

/* ---- snapshot ---- */

TEST(Snapshot, PropertiesThatAreAllZeroAreNewsTheFirstTime) {
    for (const std::size_t surplus : {0U, 3U}) {
        roburoc4_client client{};
        std::array<std::uint8_t, 128> bytes{};
        const auto events_of = [&](std::uint32_t service, roburoc4_result size) {
            EXPECT_GT(size, 0);
            client.private_events = 0;
            EXPECT_GE(roburoc4_snapshot_properties(&client, service, bytes.data(),
                                                   static_cast<std::size_t>(size) + surplus),
                      0);
            return client.private_events;
        };
        const roburoc4_battery_properties battery{};
        const roburoc4_localization_properties localization{};
        const roburoc4_result battery_size =
            roburoc4_encode_battery_properties(bytes.data(), bytes.size(), 2, &battery);
        EXPECT_EQ(ROBUROC4_EVENT_PROPERTIES, events_of(ROBUROC4_SERVICE_BATTERY, battery_size));
        client.private_discovery.known = 1U << ROBUROC4_SERVICE_BATTERY;
        EXPECT_EQ(0U, events_of(ROBUROC4_SERVICE_BATTERY, battery_size)) << "and not again";
        EXPECT_EQ(ROBUROC4_EVENT_PROPERTIES,
                  events_of(ROBUROC4_SERVICE_LOCALIZATION,
                            roburoc4_encode_localization_properties(bytes.data(), bytes.size(), 2,
                                                                    &localization)));
    }
}

/* ---- discovery ---- */

namespace {

struct Directory {
    std::array<std::uint8_t, 64> bytes{};
    roburoc4_directory view{};

    Directory(std::initializer_list<roburoc4_directory_entry> entries) {
        std::array<roburoc4_directory_entry, 8> list{};
        std::copy(entries.begin(), entries.end(), list.begin());
        const roburoc4_result size = roburoc4_encode_directory(bytes.data(), bytes.size(), 2, 0,
                                                               list.data(), entries.size());
        EXPECT_EQ(ROBUROC4_OK,
                  roburoc4_decode_directory(bytes.data(), static_cast<std::size_t>(size), &view));
    }
};

} // namespace

TEST(Discovery, ADirectoryThatDiffersInAnyWayIsAnother) {
    const Directory none{};
    const Directory known{{0, 0}, {0, 1}, {ROBUROC4_TYPE_DIFFERENTIAL, 6}};
    const Directory shorter{{0, 0}, {0, 1}};
    const Directory longer{{0, 0}, {0, 1}, {ROBUROC4_TYPE_DIFFERENTIAL, 6}, {0, 4}};
    const Directory first_id{{0, 2}, {0, 1}, {ROBUROC4_TYPE_DIFFERENTIAL, 6}};
    const Directory first_type{{1, 0}, {0, 1}, {ROBUROC4_TYPE_DIFFERENTIAL, 6}};
    const Directory second_id{{0, 0}, {0, 2}, {ROBUROC4_TYPE_DIFFERENTIAL, 6}};
    const Directory last_id{{0, 0}, {0, 1}, {ROBUROC4_TYPE_DIFFERENTIAL, 7}};
    const Directory last_type{{0, 0}, {0, 1}, {ROBUROC4_TYPE_DRIVE, 6}};
    const std::array<const Directory *, 9> all{
        &none, &known, &shorter, &longer, &first_id, &first_type, &second_id, &last_id, &last_type};
    for (const Directory *one : all) {
        discovery d{};
        roburoc4_discovery_clear(&d);
        EXPECT_FALSE(roburoc4_discovery_directory(&d, &one->view)) << "there is room for it";
        for (const Directory *other : all)
            EXPECT_EQ(one == other, roburoc4_discovery_same(&d, &other->view));
    }
}

TEST(Discovery, WhatADirectoryListsNoMoreCountsNoMore) {
    discovery d{};
    roburoc4_discovery_clear(&d);
    const Directory longer{{0, 0}, {ROBUROC4_TYPE_TELEMETER, 3}, {0x7100, 6}};
    const Directory shorter{{0, 0}, {ROBUROC4_TYPE_TELEMETER, 3}};
    EXPECT_FALSE(roburoc4_discovery_directory(&d, &longer.view));
    EXPECT_TRUE(roburoc4_discovery_may_drive(&d, 6));
    EXPECT_FALSE(roburoc4_discovery_may_drive(&d, 3)) << "telemeters";
    EXPECT_TRUE(roburoc4_discovery_unseen(&d));
    EXPECT_TRUE(roburoc4_discovery_identify(&d));
    EXPECT_EQ(1U << ROBUROC4_SERVICE_TELEMETER | 1U << ROBUROC4_SERVICE_DIFFERENTIAL, d.listed);
    EXPECT_FALSE(roburoc4_discovery_directory(&d, &shorter.view));
    EXPECT_FALSE(roburoc4_discovery_may_drive(&d, 6));
    EXPECT_FALSE(roburoc4_discovery_unseen(&d));
    EXPECT_TRUE(roburoc4_discovery_identify(&d));
    EXPECT_EQ(1U << ROBUROC4_SERVICE_TELEMETER, d.listed);
    EXPECT_EQ(0, d.service_ids[ROBUROC4_SERVICE_DIFFERENTIAL]);
}

/* Of equals the one with the manual's id, else the first. */
TEST(Discovery, AServiceIsChosenByTypeThenByTextThenByTheManualsId) {
    struct Claimant {
        roburoc4_directory_entry entry;
        std::string text;
    };
    const std::array<Claimant, 6> ranks{{{{ROBUROC4_TYPE_DIFFERENTIAL, 6}, "?"},
                                         {{ROBUROC4_TYPE_DIFFERENTIAL, 70}, "?"},
                                         {{0x7100, 6}, "Differential"},
                                         {{0x7100, 80}, "Differential"},
                                         {{0x7100, 6}, "?"},
                                         {{ROBUROC4_TYPE_LASER, 6}, "Differential"}}};
    for (std::size_t better = 0; better < ranks.size(); better++) {
        for (std::size_t worse = better; worse < ranks.size(); worse++) {
            for (const auto &[first, second] :
                 {std::pair{better, worse}, std::pair{worse, better}}) {
                SCOPED_TRACE(std::to_string(first) + " " + std::to_string(second));
                const Directory directory{ranks[first].entry, ranks[second].entry};
                discovery d{};
                roburoc4_discovery_clear(&d);
                EXPECT_FALSE(roburoc4_discovery_directory(&d, &directory.view));
                for (std::uint32_t i = 0; i < 2; i++) {
                    const std::string &text = ranks[i == 0 ? first : second].text;
                    roburoc4_discovery_text(&d, LIST_DIRECTORY, i,
                                            reinterpret_cast<const std::uint8_t *>(text.data()),
                                            static_cast<std::uint32_t>(text.size()));
                }
                const bool none = better + 1 == ranks.size();
                EXPECT_EQ(!none, roburoc4_discovery_identify(&d));
                EXPECT_EQ(none ? 0 : 1 << ROBUROC4_SERVICE_DIFFERENTIAL, d.listed);
                EXPECT_EQ(none ? 0 : ranks[better].entry.id,
                          d.service_ids[ROBUROC4_SERVICE_DIFFERENTIAL]);
                EXPECT_EQ(1, d.identified);
            }
        }
    }
}

TEST(Discovery, AServiceIsTakenForNoOther) {
    struct Case {
        roburoc4_directory_entry entry;
        const char *text;
        int kind; /* or 0 */
    };
    const std::array<Case, 21> cases{{{{ROBUROC4_TYPE_IOCARD, 50}, "?", 2},
                                      {{ROBUROC4_TYPE_TELEMETER, 50}, "?", 3},
                                      {{ROBUROC4_TYPE_LOCALIZATION, 50}, "?", 5},
                                      {{ROBUROC4_TYPE_DIFFERENTIAL, 50}, "?", 6},
                                      {{ROBUROC4_TYPE_DIAGNOSTIC, 2}, "IO card", 0},
                                      {{ROBUROC4_TYPE_LASER, 3}, "Telemeter", 0},
                                      {{ROBUROC4_TYPE_DRIVE, 6}, "Differential", 0},
                                      {{0x7100, 50}, "IO card", 2},
                                      {{0x7100, 50}, "Telemeter", 3},
                                      {{0x7100, 50}, "Battery", 4},
                                      {{0x7100, 50}, "Localization", 5},
                                      {{0x7100, 50}, "Differential", 6},
                                      {{0x7100, 2}, "?", 2},
                                      {{0x7100, 3}, "?", 3},
                                      {{0x7100, 4}, "?", 4},
                                      {{0x7100, 5}, "?", 5},
                                      {{0x7100, 6}, "?", 6},
                                      {{0x7100, 7}, "?", 0},
                                      {{ROBUROC4_TYPE_IOCARD, 0}, "IO card", 0},
                                      {{ROBUROC4_TYPE_DIFFERENTIAL, 1}, "Differential", 0},
                                      {{0x7100, 50}, "?", 0}}};
    for (const Case &c : cases) {
        SCOPED_TRACE(std::to_string(c.entry.type) + " " + std::to_string(c.entry.id) + c.text);
        const Directory directory{c.entry};
        discovery d{};
        roburoc4_discovery_clear(&d);
        EXPECT_FALSE(roburoc4_discovery_directory(&d, &directory.view));
        const std::string text = c.text;
        roburoc4_discovery_text(&d, LIST_DIRECTORY, 0,
                                reinterpret_cast<const std::uint8_t *>(text.data()),
                                static_cast<std::uint32_t>(text.size()));
        EXPECT_EQ(c.kind != 0, roburoc4_discovery_identify(&d));
        EXPECT_EQ(c.kind != 0 ? 1 << c.kind : 0, d.listed);
        for (int kind = 2; kind < ROBUROC4_SERVICE_COUNT; kind++)
            EXPECT_EQ(kind == c.kind ? c.entry.id : 0, d.service_ids[kind]) << kind;
    }
}

TEST(Discovery, EachChangeOfAnIdIsOne) {
    discovery d{};
    roburoc4_discovery_clear(&d);
    const auto changed = [&](std::uint16_t first, std::uint16_t second) {
        const Directory directory{{ROBUROC4_TYPE_TELEMETER, first},
                                  {ROBUROC4_TYPE_TELEMETER, second}};
        EXPECT_FALSE(roburoc4_discovery_directory(&d, &directory.view));
        return roburoc4_discovery_identify(&d);
    };
    for (const std::uint16_t id : std::array<std::uint16_t, 6>{50, 40, 60, 2, 3, 0xFFFF}) {
        EXPECT_TRUE(changed(id, id == 3 ? 2 : 70)) << id;
        EXPECT_EQ(id, d.service_ids[ROBUROC4_SERVICE_TELEMETER]) << "the first of equals";
        EXPECT_FALSE(changed(id, 2)) << id;
        EXPECT_EQ(id, d.service_ids[ROBUROC4_SERVICE_TELEMETER]);
    }
    EXPECT_TRUE(changed(70, 3)) << "the manual's of equals";
    EXPECT_EQ(3, d.service_ids[ROBUROC4_SERVICE_TELEMETER]);
}

/* Only of those above the first two ids something may be unseen, wherever it stands. */
TEST(Discovery, AServiceIsUnseenUntilItsTypeOrTextTellsWhatItIs) {
    for (std::uint32_t place = 0; place < 3; place++) {
        for (const std::uint16_t id : std::array<std::uint16_t, 4>{0, 1, 2, 99}) {
            SCOPED_TRACE(std::to_string(place) + " " + std::to_string(id));
            std::array<roburoc4_directory_entry, 3> entries{};
            for (roburoc4_directory_entry &entry : entries)
                entry = {ROBUROC4_TYPE_LASER, 50};
            entries[place] = {0x7100, id};
            const Directory directory{entries[0], entries[1], entries[2]};
            discovery d{};
            roburoc4_discovery_clear(&d);
            EXPECT_FALSE(roburoc4_discovery_unseen(&d)) << "nothing is listed";
            EXPECT_FALSE(roburoc4_discovery_directory(&d, &directory.view));
            EXPECT_EQ(id > 1, roburoc4_discovery_unseen(&d));
            EXPECT_TRUE(roburoc4_discovery_may_drive(&d, id)) << "it may be anything";
            EXPECT_FALSE(roburoc4_discovery_may_drive(&d, 50));
            roburoc4_discovery_described(&d, LIST_DIRECTORY, place);
            EXPECT_EQ(id > 1, roburoc4_discovery_unseen(&d)) << "its text was not believed";
            const std::uint8_t text[] = "Camera";
            roburoc4_discovery_text(&d, LIST_DIRECTORY, place, text, 6);
            EXPECT_FALSE(roburoc4_discovery_unseen(&d)) << "its text says that it is another";
        }
    }
}

TEST(Discovery, WordsAreLookedForInTheFirst255BytesOfAText) {
    const std::string word = "- Front. BUMPER"; /* signs and blanks do not count */
    const auto found = [&](std::size_t before) {
        roburoc4_private_discovery d{};
        roburoc4_discovery_clear(&d);
        const std::string text = std::string(before, ' ') + word + std::string(65000, ' ');
        return roburoc4_discovery_text(&d, ROBUROC4_IO_DIGITAL_INPUT, 3,
                                       reinterpret_cast<const std::uint8_t *>(text.data()),
                                       static_cast<std::uint32_t>(text.size()));
    };
    EXPECT_TRUE(found(0));
    EXPECT_TRUE(found(255 - word.size()));
    EXPECT_FALSE(found(256 - word.size()));
}

TEST(Discovery, TheSameTextOfTheSameInputAgainIsNotAmbiguous) {
    discovery d{};
    roburoc4_discovery_clear(&d);
    const char text[] = "Front bumper";
    const auto *bytes = reinterpret_cast<const std::uint8_t *>(text);
    const auto take = [&](std::uint32_t index) {
        return roburoc4_discovery_text(&d, ROBUROC4_IO_DIGITAL_INPUT, index, bytes, 12);
    };
    EXPECT_TRUE(take(7));
    EXPECT_TRUE(take(7));
    EXPECT_EQ(7, d.role_texts[ROBUROC4_ROLE_FRONT_BUMPER]);
    EXPECT_TRUE(take(8));
    EXPECT_EQ(ROLE_TEXT_AMBIGUOUS, d.role_texts[ROBUROC4_ROLE_FRONT_BUMPER]);
    EXPECT_TRUE(take(7));
    EXPECT_EQ(ROLE_TEXT_AMBIGUOUS, d.role_texts[ROBUROC4_ROLE_FRONT_BUMPER]) << "and stays so";
    roburoc4_discovery_clear(&d);
    EXPECT_TRUE(take(8));
    EXPECT_TRUE(take(7));
    EXPECT_EQ(ROLE_TEXT_AMBIGUOUS, d.role_texts[ROBUROC4_ROLE_FRONT_BUMPER]) << "in any order";
}

TEST(Discovery, OnlyLettersAndDigitsMakeWords) {
    const auto found = [](char between) {
        discovery d{};
        roburoc4_discovery_clear(&d);
        const std::string text = std::string("Front ") + between + " bumper";
        return roburoc4_discovery_text(&d, ROBUROC4_IO_DIGITAL_INPUT, 3,
                                       reinterpret_cast<const std::uint8_t *>(text.data()),
                                       static_cast<std::uint32_t>(text.size()));
    };
    for (const char sign : std::string(" /:@[`{")) /* those beside letters and digits, too */
        EXPECT_TRUE(found(sign)) << sign;
    for (const char other : std::string("09AZaz"))
        EXPECT_FALSE(found(other)) << other;
}

TEST(Discovery, AWordCountsOnlyWithAllOfItsLetters) {
    const auto claim = [](const std::string &text) {
        discovery d{};
        roburoc4_discovery_clear(&d);
        roburoc4_discovery_text(&d, LIST_DIRECTORY, 0,
                                reinterpret_cast<const std::uint8_t *>(text.data()),
                                static_cast<std::uint32_t>(text.size()));
        return d.claims[0] != CLAIM_OTHER;
    };
    const auto role = [](const std::string &text) {
        discovery d{};
        roburoc4_discovery_clear(&d);
        const auto *bytes = reinterpret_cast<const std::uint8_t *>(text.data());
        const auto length = static_cast<std::uint32_t>(text.size());
        const bool digital =
            roburoc4_discovery_text(&d, ROBUROC4_IO_DIGITAL_INPUT, 0, bytes, length);
        return roburoc4_discovery_text(&d, ROBUROC4_IO_ANALOG_INPUT, 0, bytes, length) || digital;
    };
    const auto expect_all = [](const auto &found, const std::string &word) {
        EXPECT_TRUE(found(word)) << word;
        EXPECT_TRUE(found("my " + word + "s")) << word;
        for (std::size_t i = 0; i < word.size(); i++) {
            std::string other = word;
            other[i] = 'q';
            EXPECT_FALSE(found(other)) << other;
            other = word;
            other.erase(i, 1);
            EXPECT_FALSE(found(other)) << other;
        }
    };
    for (const char *word : {"iocard", "telemeter", "battery", "locali", "differential"})
        expect_all(claim, word);
    for (const char *word : {"gamepadabutton", "frontbumper", "rearbumper", "batteryvoltage"})
        expect_all(role, word);
}

/* Services, digital inputs (among them is the override), analog ones, then outputs; of each no more
 * than a client stores. */
TEST(Discovery, EachTextIsAskedForOnceAndInItsTurn) {
    const std::array<std::int32_t, 4> none{}, usual{9, 2, 22, 8}, full{32, 16, 64, 64},
        beyond{33, 17, 65, std::numeric_limits<std::int32_t>::max()};
    for (const std::array<std::int32_t, 4> &counts : {none, usual, full, beyond}) {
        discovery d{};
        roburoc4_discovery_clear(&d);
        d.service_count = 3;
        d.service_ids[ROBUROC4_SERVICE_IOCARD] = 0x1234;
        const requests nothing_open{};
        for (const std::uint8_t list : std::array<std::uint8_t, 5>{4, 2, 0, 3, 1}) {
            const std::int32_t capacity = list > 1 ? 64 : 32 >> list;
            const std::int32_t length = list == 4 ? 3 : std::min(counts[list], capacity);
            for (std::int32_t i = 0; i < length; i++) {
                SCOPED_TRACE(std::to_string(list) + " " + std::to_string(i));
                ask a{};
                ASSERT_TRUE(
                    roburoc4_discovery_next_text(&d, &nothing_open, counts.data(), true, &a));
                EXPECT_EQ(ROBUROC4_ACTION_QUERY, a.action);
                EXPECT_EQ(list, a.detail);
                EXPECT_EQ(i, a.subject);
                EXPECT_EQ(list == 4 ? ROBUROC4_SERVICE_DIRECTORY : ROBUROC4_SERVICE_IOCARD, a.kind);
                EXPECT_EQ(list == 4 ? 0 : 0x1234, a.target);
                EXPECT_GE(a.max_tries, 10);
                EXPECT_FALSE(roburoc4_discovery_texts_done(&d, counts.data(), true));
                EXPECT_EQ(list != 4, roburoc4_discovery_texts_done(&d, counts.data(), false));
                EXPECT_EQ(list == 4, roburoc4_discovery_next_text(&d, &nothing_open, counts.data(),
                                                                  false, &a));
                roburoc4_discovery_described(&d, list, static_cast<std::uint32_t>(i));
            }
        }
        ask a{};
        EXPECT_FALSE(roburoc4_discovery_next_text(&d, &nothing_open, counts.data(), true, &a));
        EXPECT_TRUE(roburoc4_discovery_texts_done(&d, counts.data(), true));
    }
}

/* Answers come in any order, and some not at all. */
TEST(Discovery, ATextThatIsLeftIsAskedForWhereverItStands) {
    const std::array<std::int32_t, 4> counts{9, 5, 63, 64};
    const std::array<std::uint32_t, 5> lengths{9, 5, 63, 64, 7};
    for (std::uint32_t left = 0; left < 5; left++) {
        for (std::uint32_t index = 0; index < lengths[left]; index++) {
            SCOPED_TRACE(std::to_string(left) + " " + std::to_string(index));
            discovery d{};
            roburoc4_discovery_clear(&d);
            d.service_count = 7;
            for (std::uint32_t list = 0; list < 5; list++)
                for (std::uint32_t i = lengths[list]; i-- > 0;)
                    if (list != left || i != index)
                        roburoc4_discovery_described(&d, list, i);
            requests r{};
            ask a{};
            ASSERT_TRUE(roburoc4_discovery_next_text(&d, &r, counts.data(), true, &a));
            EXPECT_EQ(left, a.detail);
            EXPECT_EQ(index, a.subject);
            EXPECT_FALSE(roburoc4_discovery_texts_done(&d, counts.data(), true));
            EXPECT_EQ(left != 4, roburoc4_discovery_texts_done(&d, counts.data(), false));
            ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
            ask other{};
            EXPECT_FALSE(roburoc4_discovery_next_text(&d, &r, counts.data(), true, &other));
            EXPECT_FALSE(roburoc4_discovery_texts_done(&d, counts.data(), true)) << "it is open";
            roburoc4_discovery_described(&d, left, index);
            EXPECT_TRUE(roburoc4_discovery_texts_done(&d, counts.data(), true));
        }
    }
}

TEST(Discovery, TextsThatAreReadAgainAreAllReadAgain) {
    discovery d{};
    roburoc4_discovery_clear(&d);
    std::fill(std::begin(d.described), std::end(d.described), UINT64_MAX);
    d.done = 1;
    roburoc4_discovery_read_texts_again(&d);
    for (const std::uint64_t list : d.described)
        EXPECT_EQ(0U, list);
    EXPECT_EQ(0, d.done);
}

TEST(Discovery, OfARobotThatIsForgottenOnlyTheUsersWishesStay) {
    discovery d;
    std::memset(&d, 0xA5, sizeof d);
    discovery fresh{};
    fresh.wanted = 0xA5;
    std::fill(std::begin(fresh.claims), std::end(fresh.claims), std::uint8_t{CLAIM_NONE});
    std::fill(std::begin(fresh.role_texts), std::end(fresh.role_texts),
              std::int16_t{ROLE_TEXT_NONE});
    roburoc4_discovery_clear(&d);
    EXPECT_EQ(0, std::memcmp(&fresh, &d, sizeof d));
}

TEST(Discovery, ARestartForgetsWhatWasAgreedAndNoText) {
    discovery d;
    std::memset(&d, 0xA5, sizeof d);
    discovery wanted = d;
    for (std::uint8_t *field :
         {&wanted.identified, &wanted.known, &wanted.refused, &wanted.inserted, &wanted.acked,
          &wanted.declined, &wanted.leaving, &wanted.done})
        *field = 0;
    roburoc4_discovery_restart(&d);
    EXPECT_EQ(0, std::memcmp(&wanted, &d, sizeof d));
}

/* The next id, so that late answers of before do not fit; and that a robot echoed one of ours. */
TEST(Requests, ThatAreClearedLeaveNothingButWhatLaterOnesNeed) {
    for (std::uint8_t suspect = 0; suspect < 3; suspect++) {
        requests r;
        std::memset(&r, 0xA5, sizeof r);
        r.suspect = suspect;
        requests wanted{};
        wanted.last_id = 0xA5;
        wanted.suspect = suspect == 2 ? 2 : 0;
        roburoc4_requests_clear(&r);
        EXPECT_EQ(0, std::memcmp(&wanted, &r, sizeof r)) << int{suspect};
    }
}

TEST(Requests, AreAllDueAtOnceAfterAFaultOfTheClock) {
    requests r{};
    slot *given_up = nullptr;
    for (std::uint8_t kind = 2; kind < 6; kind++) {
        const ask a = get(kind);
        ASSERT_TRUE(roburoc4_requests_begin(&r, &a));
        ASSERT_NE(nullptr, roburoc4_requests_due(&r, 100, begin_us, &given_up));
    }
    EXPECT_EQ(nullptr, roburoc4_requests_due(&r, 100, begin_us, &given_up));
    const std::uint64_t earlier_us = begin_us - 50 * second;
    roburoc4_requests_rebase(&r, earlier_us);
    for (std::size_t only = 0; only < std::size(r.slots); only++) {
        requests alone = r;
        roburoc4_requests_cancel_all(&alone);
        alone.slots[only].open = 1;
        EXPECT_LE(roburoc4_requests_deadline(&alone), earlier_us) << only;
    }
    for (std::uint8_t kind = 2; kind < 6; kind++) {
        const slot *s = roburoc4_requests_due(&r, 100, earlier_us, &given_up);
        ASSERT_NE(nullptr, s);
        EXPECT_EQ(kind, s->ask.kind);
        EXPECT_EQ(2, s->tries) << "what was asked before counts";
    }
    EXPECT_EQ(nullptr, roburoc4_requests_due(&r, 100, earlier_us, &given_up));
    EXPECT_EQ(earlier_us + 200 * ms, roburoc4_requests_deadline(&r));
    r.fixed_id = 1;
    roburoc4_requests_cancel_all(&r);
    roburoc4_requests_close(&r, &r.slots[0], earlier_us);
    ASSERT_FALSE(roburoc4_requests_free(&r, 0));
    roburoc4_requests_rebase(&r, earlier_us - second);
    EXPECT_TRUE(roburoc4_requests_free(&r, 0)) << "nor is a late answer waited for";
}

TEST(Requests, AreDueWhenTheSoonestIsWhereverItStands) {
    for (std::size_t soonest = 0; soonest < std::size(requests{}.slots); soonest++) {
        requests r{};
        for (std::size_t i = 0; i < std::size(r.slots); i++) {
            r.slots[i].open = 1;
            r.slots[i].tries = 1;
            r.slots[i].sent_us = 5000000;
            r.slots[i].wait_us = i == soonest ? 100000 : 200000;
        }
        EXPECT_EQ(5100000U, roburoc4_requests_deadline(&r)) << soonest;
    }
}

TEST(Discovery, ATextClaimsTheServiceThatItNamesAndElseNone) {
    const std::array<std::pair<const char *, int>, 10> texts{
        {{"IO card", ROBUROC4_SERVICE_IOCARD},
         {"Telemeters", ROBUROC4_SERVICE_TELEMETER},
         {"battery", ROBUROC4_SERVICE_BATTERY},
         {"Localisation", ROBUROC4_SERVICE_LOCALIZATION},
         {"Localization", ROBUROC4_SERVICE_LOCALIZATION},
         {"The DIFFERENTIAL", ROBUROC4_SERVICE_DIFFERENTIAL},
         {"Camera", CLAIM_OTHER},
         {"000000000000000", CLAIM_OTHER},
         {"zzzzzzzzzzzzzzz", CLAIM_OTHER},
         {"", CLAIM_OTHER}}};
    for (const auto &[text, claim] : texts) {
        discovery d{};
        roburoc4_discovery_clear(&d);
        const std::string copy(text);
        EXPECT_FALSE(roburoc4_discovery_text(&d, LIST_DIRECTORY, 31,
                                             reinterpret_cast<const std::uint8_t *>(copy.data()),
                                             static_cast<std::uint32_t>(copy.size())));
        EXPECT_EQ(claim, d.claims[31]) << text;
    }
}

TEST(Discovery, AServiceThatTurnsOutToBeAnotherIsListedNoMore) {
    discovery d{};
    roburoc4_discovery_clear(&d);
    const Directory known{{0x7001, ROBUROC4_SERVICE_IOCARD}};
    EXPECT_FALSE(roburoc4_discovery_directory(&d, &known.view));
    EXPECT_TRUE(roburoc4_discovery_identify(&d));
    EXPECT_EQ(1U << ROBUROC4_SERVICE_IOCARD, d.listed) << "by the manual's number";
    const char text[] = "Battery";
    roburoc4_discovery_text(&d, LIST_DIRECTORY, 0, reinterpret_cast<const std::uint8_t *>(text), 7);
    EXPECT_TRUE(roburoc4_discovery_identify(&d));
    EXPECT_EQ(1U << ROBUROC4_SERVICE_BATTERY, d.listed);
    EXPECT_EQ(0, d.service_ids[ROBUROC4_SERVICE_IOCARD]);
    EXPECT_EQ(ROBUROC4_SERVICE_IOCARD, d.service_ids[ROBUROC4_SERVICE_BATTERY]);
    EXPECT_FALSE(roburoc4_discovery_identify(&d)) << "nothing changed";
}
