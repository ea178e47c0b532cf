/* SPDX-License-Identifier: MIT
 *
 * safety_test.cpp - findings of people who did not write the client, each as a test on the wire:
 * with an independent robot and network (tests/verify/soak), the public API, and nothing else.
 */
#include "world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <string>

namespace {

using soak::RobotPlan;
using soak::Speeds;
using soak::Weather;
using soak::World;

constexpr std::uint64_t ms = 1000;
constexpr std::uint64_t second = 1000000;

roburoc4_config default_config() {
    roburoc4_config config;
    roburoc4_config_init(&config, sizeof config);
    return config;
}

RobotPlan friendly_robot() {
    RobotPlan plan;
    plan.type_codes = true;
    plan.give_texts(soak::pad_texts(22, 8, 0));
    return plan;
}

Weather delayed(std::uint64_t us) {
    Weather weather;
    weather.delay_us = us;
    return weather;
}

/** A client and a robot in virtual time. The oracle also watches, but these tests have their own
 * expectations. */
class Safety : public ::testing::Test {
  protected:
    void make(const RobotPlan &plan, const roburoc4_config &config = default_config()) {
        client_ = std::make_unique<soak::RealClient>();
        world_ = std::make_unique<World>(plan, config, *client_, soak::Promises().set(), 1);
        world_->start();
    }

    /** Tries to arm every 10 ms; returns how long it took, or `patience_us`. */
    std::uint64_t arm_within(std::uint64_t patience_us) {
        const std::uint64_t begin_us = world_->now_us();
        while (world_->now_us() - begin_us < patience_us && (result_ = world_->arm()) < 0)
            world_->run_for(10 * ms);
        return world_->now_us() - begin_us;
    }

    /** Calls drive() every 50 ms, whatever it returns. */
    void drive_for(std::uint64_t us, Speeds speeds) {
        for (std::uint64_t t = 0; t < us; t += 50 * ms) {
            result_ = world_->drive(speeds);
            world_->run_for(50 * ms);
        }
    }

    bool robot_moves() const {
        return std::fabs(world_->robot().moving().v) > 0.01F ||
               std::fabs(world_->robot().moving().w) > 0.01F;
    }

    std::unique_ptr<soak::RealClient> client_;
    std::unique_ptr<World> world_;
    std::int32_t result_ = 0;
};

/* ------------------------------------------------------------- how old a status really is */

TEST_F(Safety, LateStatusesAreNotFreshHoweverSteadyTheyCome) {
    make(friendly_robot());
    world_->set_weather(Weather(), delayed(450 * ms));
    EXPECT_EQ(arm_within(20 * second), 20 * second);
    EXPECT_TRUE(result_ == ROBUROC4_ERR_STALE_DIFFERENTIAL || result_ == ROBUROC4_ERR_STALE_IOCARD);
}

TEST_F(Safety, AGrowingQueueDisarms) {
    make(friendly_robot());
    ASSERT_LT(arm_within(10 * second), 10 * second);
    drive_for(5 * second, {0.3F, 0});
    ASSERT_TRUE(world_->report().armed);
    Weather queue;
    queue.growth = 10.0 / 60.0;
    queue.queue_us = 10 * second;
    world_->set_weather(Weather(), queue);
    drive_for(2500 * ms, {0.3F, 0}); /* by now a status is more than 400 ms old when it arrives */
    EXPECT_FALSE(world_->report().armed);
    EXPECT_TRUE(world_->last_command().zero());
}

TEST_F(Safety, ASlowlyGrowingQueueDisarms) {
    make(friendly_robot());
    ASSERT_LT(arm_within(10 * second), 10 * second);
    Weather queue;
    queue.growth = 0.002;
    queue.queue_us = 10 * second;
    world_->set_weather(Weather(), queue);
    drive_for(220 * second, {0.1F, 0}); /* the queue has grown to 440 ms */
    EXPECT_FALSE(world_->report().armed);
    EXPECT_TRUE(world_->last_command().zero());
}

TEST_F(Safety, PadAIsSeenInTimeBehindAQueue) {
    make(friendly_robot());
    ASSERT_LT(arm_within(10 * second), 10 * second);
    Weather queue;
    queue.growth = 10.0 / 60.0;
    queue.queue_us = 10 * second;
    world_->set_weather(Weather(), queue);
    drive_for(15 * second, {0.3F, 0});
    world_->hold_pad_a(true);
    const std::uint64_t commands = world_->commands();
    drive_for(300 * ms, {0.3F, 0});
    EXPECT_EQ(world_->commands(), commands) << "it still drove 15 s after the queue began to grow";
}

TEST_F(Safety, AShortDelayIsFresh) {
    make(friendly_robot());
    world_->set_weather(Weather(), delayed(100 * ms));
    EXPECT_LT(arm_within(10 * second), 10 * second);
}

/* ----------------------------------------------------------------------- which input is [A] */

TEST_F(Safety, PadAIsWhereTheRobotsTextsSay) {
    for (int wording = 0; wording < 4; wording++) {
        RobotPlan plan = friendly_robot();
        plan.pad_a = 9;
        plan.give_texts(soak::pad_texts(22, 9, wording));
        make(plan);
        ASSERT_LT(arm_within(10 * second), 10 * second) << plan.input_texts[9];
        EXPECT_EQ(world_->report().override_index, 9) << plan.input_texts[9];
        drive_for(second, {0.3F, 0});
        world_->hold_pad_a(true);
        drive_for(100 * ms, {0.3F, 0});
        EXPECT_FALSE(world_->report().armed) << plan.input_texts[9];
        EXPECT_EQ(result_, ROBUROC4_ERR_OVERRIDE) << plan.input_texts[9];
    }
}

TEST_F(Safety, PadAIsUnknownUntilItsTextsWereRead) {
    RobotPlan plan = friendly_robot();
    plan.text_us = 300 * ms;
    make(plan);
    while (world_->oracle().override_index() < 0) { /* not all texts were received yet */
        ASSERT_LT(world_->arm(), 0);
        ASSERT_FALSE(world_->report().override_known);
        world_->run_for(10 * ms);
    }
    EXPECT_LT(arm_within(10 * second), 10 * second);
}

TEST_F(Safety, PadAIsUnknownIfNoTextFits) {
    RobotPlan plan = friendly_robot();
    plan.give_texts(soak::pad_texts(22, 8, 0));
    plan.input_texts[8] = "spare";
    make(plan);
    EXPECT_EQ(arm_within(10 * second), 10 * second);
    EXPECT_EQ(result_, ROBUROC4_ERR_OVERRIDE_UNKNOWN);
}

TEST_F(Safety, TheManualsPadAIsNotBelievedOnAnotherCard) {
    RobotPlan plan = friendly_robot();
    plan.refused_texts.assign(22, true);
    plan.analog_inputs = 12;
    make(plan);
    EXPECT_EQ(arm_within(10 * second), 10 * second);
    EXPECT_EQ(result_, ROBUROC4_ERR_OVERRIDE_UNKNOWN);
}

TEST_F(Safety, AMissingTextIsNoRefusal) {
    RobotPlan plan = friendly_robot();
    plan.unanswered_texts[8] = true;
    make(plan);
    EXPECT_EQ(arm_within(30 * second), 30 * second);
    EXPECT_EQ(result_, ROBUROC4_ERR_OVERRIDE_UNKNOWN);
}

/** Only texts identify its services, and their ids are a permutation of the manual's: 6 is the
 * telemeters. */
RobotPlan robot_told_by_texts() {
    RobotPlan plan = friendly_robot();
    const std::uint16_t ids[5] = {4, 6, 2, 5, 3};
    std::copy(std::begin(ids), std::end(ids), std::begin(plan.ids));
    plan.type_codes = false;
    return plan;
}

TEST_F(Safety, AServiceIsNotGuessedWhileItsTextIsMissing) {
    RobotPlan plan = robot_told_by_texts();
    plan.text_us = 3600 * second;
    make(plan);
    for (int i = 0; i < 100; i++) {
        world_->stop();
        world_->run_for(100 * ms);
    }
    EXPECT_FALSE(world_->oracle().over()) << "a command went to another service";
}

TEST_F(Safety, ALostServiceTextIsRequestedAgain) {
    RobotPlan plan = robot_told_by_texts();
    plan.text_us = 3600 * second;
    make(plan);
    world_->run_for(20 * second);
    world_->robot().delay_texts(ms);
    EXPECT_LT(arm_within(30 * second), 30 * second);
}

/* ----------------------------------------------------------------------- motion is inhibited */

TEST_F(Safety, PowerThatComesBackDoesNotSetTheRobotOff) {
    make(friendly_robot());
    ASSERT_LT(arm_within(10 * second), 10 * second);
    drive_for(2 * second, {0.3F, 0});
    ASSERT_TRUE(robot_moves());
    world_->cut_motors(true);
    drive_for(2 * second, {0.3F, 0});
    EXPECT_FALSE(world_->report().armed);
    EXPECT_LT(result_, 0) << "drive() must say that nothing moves";
    drive_for(2 * second, {0.3F, 0});
    world_->cut_motors(false);
    drive_for(2 * second, {0.3F, 0});
    EXPECT_FALSE(robot_moves());
}

TEST_F(Safety, ASlowStartIsNotTakenForInhibitedMotion) {
    RobotPlan plan = friendly_robot();
    plan.linear = {1.5, 1.5, 1};
    plan.dead_time_cycles = 15;
    make(plan);
    ASSERT_LT(arm_within(10 * second), 10 * second);
    drive_for(3 * second, {0.05F, 0});
    EXPECT_TRUE(world_->report().armed);
    EXPECT_TRUE(robot_moves());
}

/* ------------------------------------------------------------------ how a stop sequence ends */

TEST_F(Safety, AStopIsNotConfirmedByAnOlderStatus) {
    roburoc4_config config = default_config();
    config.fresh_ms = 1000;
    make(friendly_robot(), config);
    world_->set_weather(Weather(), delayed(250 * ms));
    ASSERT_LT(arm_within(10 * second), 10 * second);
    world_->run_for(second);
    drive_for(100 * ms, {0.5F, 0});
    world_->take_events();
    const std::uint64_t stopped_us = world_->now_us();
    world_->stop();
    while ((world_->take_events() & ROBUROC4_EVENT_STOPPED) == 0 &&
           world_->now_us() - stopped_us < 3 * second)
        world_->run_for(ms);
    EXPECT_GE(world_->now_us() - stopped_us, 250 * ms);
    EXPECT_LT(world_->now_us() - stopped_us, 3 * second);
}

TEST_F(Safety, RoundingIsNotMotion) {
    for (const float noise : {1e-9F, 1e-6F}) {
        RobotPlan plan = friendly_robot();
        plan.rounding = noise;
        make(plan);
        ASSERT_LT(arm_within(10 * second), 10 * second);
        drive_for(second, {0.3F, 0});
        world_->take_events();
        world_->stop();
        world_->run_for(500 * ms); /* less than the watchdog's time */
        EXPECT_NE(world_->take_events() & ROBUROC4_EVENT_STOPPED, 0U);
    }
}

/* ------------------------------------------------------------------- speeds and settings */

/* Uninitialized memory can look like a driving client, so init() cannot refuse it. */
TEST_F(Safety, InitOfADrivingClientLeavesItToTheWatchdog) {
    make(friendly_robot());
    ASSERT_LT(arm_within(10 * second), 10 * second);
    drive_for(second, {0.3F, 0});
    ASSERT_FALSE(world_->last_command().zero());
    ASSERT_EQ(world_->init_again(default_config()), ROBUROC4_OK);
    const std::uint64_t commands = world_->commands();
    world_->run_for(5 * second);
    EXPECT_EQ(world_->commands(), commands) << "nothing that was forgotten is sent";
    EXPECT_FALSE(robot_moves());
}

} // namespace
