/* SPDX-License-Identifier: MIT
 *
 * drive_simulator_test.cpp - the effect of the promises on motion at the robot: a client drives the
 * simulated robot, whose target and true speed show whether it stopped.
 */
#include <gtest/gtest.h>

#include <cmath>

#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

constexpr std::uint64_t watchdog_us = 1000 * ms;
constexpr std::uint64_t cycle_us = ROBUROC4_CYCLE_US;
/* From 1 m/s to a standstill by the measured response. */
constexpr std::uint64_t stopping_us = 4 * second;

/** A client and a robot in an empty world; time advances in robot cycles, so nothing is missed. */
class DriveSimulator : public testing::Test {
  protected:
    DriveSimulator() : bench(robot) {
        roburoc4_sim_clear_obstacles(robot.get());
    }

    void drive_at_one_metre_per_second() {
        bench.armed();
        bench.driving(1.0F, 0.0F, 4 * second);
        ASSERT_NEAR(1.0, robot.state().true_linear_m_s, 0.05);
    }
    /** Time until the robot's target is 0; more than `limit_us` if that does not happen. */
    std::uint64_t until_target_is_zero(std::uint64_t limit_us = 5 * second) {
        const std::uint64_t begin_us = bench.now_us;
        while (has_target() && bench.now_us - begin_us <= limit_us)
            bench.run(cycle_us);
        return bench.now_us - begin_us;
    }
    [[nodiscard]] bool has_target() const {
        const roburoc4_sim_state state = robot.state();
        return state.target_linear_m_s != 0 || state.target_angular_rad_s != 0;
    }
    [[nodiscard]] bool stands() const {
        const roburoc4_sim_state state = robot.state();
        return std::fabs(state.true_linear_m_s) < 0.01 &&
               std::fabs(state.true_angular_rad_s) < 0.02;
    }
    void expect_stop() {
        bench.run(stopping_us);
        EXPECT_FALSE(has_target());
        EXPECT_TRUE(stands()) << robot.state().true_linear_m_s;
    }
    /** Nothing moves it but arm() and drive(). */
    void expect_that_only_arming_moves_it() {
        bench.take_events();
        bench.sent.clear();
        for (int i = 0; i < 20; i++) {
            EXPECT_LT(bench.drive(1.0F, 0.0F), 0);
            bench.run(50 * ms);
        }
        EXPECT_EQ(0U, bench.speeds());
        EXPECT_TRUE(stands());
        ASSERT_EQ(ROBUROC4_OK, bench.arm());
        bench.driving(0.5F, 0.0F, 3 * second);
        EXPECT_NEAR(0.5, robot.state().true_linear_m_s, 0.1);
    }
    void power(int on) {
        roburoc4_sim_set(robot.get(), ROBUROC4_SIM_POWER, on);
    }
    void press_a(int down) {
        roburoc4_sim_set(robot.get(), ROBUROC4_SIM_PAD_BUTTON + ROBUROC4_DI_PAD_A, down);
    }

    SimPartner robot;
    Bench bench;
};

} // namespace

/* ------------------------------------------------------------------------------- the lease --- */

TEST_F(DriveSimulator, TheRobotStopsWhenTheCallerNoLongerRenews) {
    drive_at_one_metre_per_second();
    ASSERT_EQ(ROBUROC4_OK, bench.drive(1.0F, 0.0F, 250000));
    EXPECT_LE(until_target_is_zero(), 250 * ms + cycle_us);
    EXPECT_EQ(0, robot.state().watchdog_tripped);
    expect_stop();
    EXPECT_EQ(0, bench.facts().stopping);
    EXPECT_EQ(0U, robot.state().refused_speed_commands);
}

TEST_F(DriveSimulator, EveryLeaseEndsAtTheRobotInTime) {
    bench.armed();
    for (const std::uint32_t lease_us : {20000U, 100000U, 500000U, 1000000U}) {
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.3F, 0.5F, lease_us));
        bench.run(cycle_us);
        EXPECT_TRUE(has_target()) << lease_us;
        EXPECT_LE(until_target_is_zero(), lease_us + cycle_us) << lease_us;
        bench.run(stopping_us);
    }
}

TEST_F(DriveSimulator, TheWatchdogStopsTheRobotOfAFrozenProcess) {
    drive_at_one_metre_per_second();
    const std::uint64_t frozen_us = bench.now_us;
    while (has_target() && bench.now_us - frozen_us < 5 * second) {
        bench.now_us += cycle_us; /* no call of the client */
        robot.advance(bench.now_us);
        robot.take();
    }
    EXPECT_LE(bench.now_us - frozen_us, watchdog_us + cycle_us);
    EXPECT_EQ(1, robot.state().watchdog_tripped);
    /* it wakes up: its earlier command is over */
    bench.now_us += 2 * second;
    bench.sent.clear();
    bench.run(stopping_us);
    EXPECT_EQ(0U, bench.speeds());
    EXPECT_TRUE(stands());
}

TEST_F(DriveSimulator, StopDisarmAndCloseStopTheRobotAtOnce) {
    for (int way = 0; way < 3; way++) {
        SimPartner other;
        roburoc4_sim_clear_obstacles(other.get());
        Bench user(other);
        user.armed();
        user.driving(1.0F, 1.0F, 2 * second);
        ASSERT_NE(0.0, other.state().target_linear_m_s);
        ASSERT_EQ(ROBUROC4_OK, way == 0 ? user.stop() : way == 1 ? user.disarm() : user.close());
        user.run(cycle_us);
        EXPECT_EQ(0.0, other.state().target_linear_m_s) << way;
        EXPECT_EQ(0.0, other.state().target_angular_rad_s) << way;
        user.run(stopping_us);
        EXPECT_NEAR(0.0, other.state().true_linear_m_s, 0.01) << way;
        EXPECT_EQ(way == 2 ? ROBUROC4_STATE_IDLE : ROBUROC4_STATE_READY,
                  static_cast<int>(user.state()));
    }
}

TEST_F(DriveSimulator, TheRobotGetsNoMoreThanItsLimits) {
    bench.armed();
    bench.driving(50.0F, -50.0F, 1 * second);
    EXPECT_NEAR(2.6, robot.state().last_linear_m_s, 1e-6);
    EXPECT_NEAR(-6.5, robot.state().last_angular_rad_s, 1e-6);
}

TEST_F(DriveSimulator, ALossyNetworkDoesNotStopADriverThatRenews) {
    std::uint32_t number = 0;
    bench.drop_to_robot = [&](const Bytes &) { return ++number % 3 == 0; };
    bench.drop_to_client = [&](const Bytes &) { return ++number % 5 == 0; };
    drive_at_one_metre_per_second();
    for (int i = 0; i < 200; i++) {
        ASSERT_EQ(ROBUROC4_OK, bench.drive(1.0F, 0.0F));
        bench.run(50 * ms);
        ASSERT_TRUE(has_target());
    }
    EXPECT_EQ(0, robot.state().watchdog_tripped);
}

/* ------------------------------------------------------------------------------- the pad --- */

TEST_F(DriveSimulator, HoldingAOnThePadTakesControl) {
    drive_at_one_metre_per_second();
    press_a(1);
    bench.run(60 * ms); /* a status tells it */
    EXPECT_EQ(1, bench.facts().overridden);
    EXPECT_EQ(0, bench.facts().armed);
    EXPECT_EQ(ROBUROC4_ERR_OVERRIDE, bench.facts().disarm_cause);
    EXPECT_EQ(ROBUROC4_ERR_OVERRIDE, bench.drive(1.0F, 0.0F));
    EXPECT_EQ(ROBUROC4_ERR_OVERRIDE, bench.arm());
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_OVERRIDE);
    expect_stop();

    roburoc4_sim_set(robot.get(), ROBUROC4_SIM_PAD_AXIS + ROBUROC4_AI_PAD_RT, 0.0F);
    bench.run(3 * second);
    EXPECT_NEAR(1.3, robot.state().true_linear_m_s, 0.1);
    EXPECT_EQ(0, bench.facts().other_commander) << "the pad is no other client";
}

TEST_F(DriveSimulator, SpeedsOfOthersDoNotReachAnOverriddenRobot) {
    bench.armed();
    press_a(1);
    const std::uint32_t refused = robot.state().refused_speed_commands;
    Bytes command(11);
    roburoc4_encode_differential_command(command.data(), command.size(),
                                         ROBUROC4_SERVICE_DIFFERENTIAL, 1.0F, 0.0F);
    robot.deliver(command);
    bench.run(second);
    EXPECT_EQ(refused + 1, robot.state().refused_speed_commands);
    EXPECT_TRUE(stands());
}

TEST_F(DriveSimulator, ReleasingThePadMovesNothingByItself) {
    drive_at_one_metre_per_second();
    press_a(1);
    bench.run(3 * second);
    roburoc4_sim_set(robot.get(), ROBUROC4_SIM_PAD, 0);
    expect_stop();
    EXPECT_EQ(0, bench.facts().overridden);
    expect_that_only_arming_moves_it();
}

/* ------------------------------------------------------------- inhibited, loss, reboot --- */

TEST_F(DriveSimulator, AnEmergencyStopShowsAsInhibited) {
    drive_at_one_metre_per_second();
    bench.take_events();
    EXPECT_EQ(0, bench.facts().inhibited);
    roburoc4_sim_set(robot.get(), ROBUROC4_SIM_ESTOP_REMOTE, 1);
    EXPECT_EQ(ROBUROC4_ERR_INHIBITED, bench.drive_until_refused(1.0F, 0.0F, 2 * second));
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_INHIBITED);
    bench.run(second);
    EXPECT_TRUE(stands());

    roburoc4_sim_set(robot.get(), ROBUROC4_SIM_ESTOP_REMOTE, 0);
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(robot.get(), ROBUROC4_SIM_MOTOR_BUTTON, 1));
    EXPECT_EQ(ROBUROC4_ERR_INHIBITED, bench.drive_until_refused(1.0F, 0.0F, 2 * second));
    EXPECT_TRUE(stands()) << "power that comes back does not set it off";
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
    bench.driving(1.0F, 0.0F, 4 * second);
    EXPECT_NEAR(1.0, robot.state().true_linear_m_s, 0.05);
}

TEST_F(DriveSimulator, BrakesAndBumperShowAsInhibited) {
    bench.armed();
    roburoc4_sim_set(robot.get(), ROBUROC4_SIM_BRAKES_RELEASED, 1);
    EXPECT_EQ(ROBUROC4_ERR_INHIBITED, bench.drive_until_refused(1.0F, 0.0F, 2 * second));
    roburoc4_sim_set(robot.get(), ROBUROC4_SIM_BRAKES_RELEASED, 0);
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(robot.get(), ROBUROC4_SIM_MOTOR_BUTTON, 1));
    bench.run(second);
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
    bench.driving(1.0F, 0.0F, 2 * second);

    roburoc4_sim_set(robot.get(), ROBUROC4_SIM_BUMPER_FRONT, 1);
    EXPECT_EQ(ROBUROC4_ERR_INHIBITED, bench.drive_until_refused(1.0F, 0.0F, 2 * second));
    EXPECT_EQ(1, bench.facts().front_bumper);
    bench.run(second);
    EXPECT_TRUE(stands());
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
    bench.driving(-0.5F, 0.0F, 2 * second);
    EXPECT_EQ(0, bench.facts().inhibited) << "the way back is free";
    EXPECT_LT(robot.state().true_linear_m_s, -0.3);
}

TEST_F(DriveSimulator, ALostNetworkStopsTheRobotPermanently) {
    drive_at_one_metre_per_second();
    bench.drop_to_robot = bench.drop_to_client = [](const Bytes &) { return true; };
    const std::uint64_t lost_us = bench.now_us;
    while (has_target() && bench.now_us - lost_us < 5 * second) {
        bench.drive(1.0F, 0.0F);
        bench.run(50 * ms);
    }
    EXPECT_LE(bench.now_us - lost_us, watchdog_us + 100 * ms);
    EXPECT_EQ(0, bench.facts().armed);
    bench.run(stopping_us);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_LOST), bench.state());
    EXPECT_TRUE(stands());
    bench.drop_to_robot = bench.drop_to_client = nullptr;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 10 * second));
    bench.run(second);
    expect_that_only_arming_moves_it();
}

TEST_F(DriveSimulator, StopsTheRobotWhenStatusesNoLongerCome) {
    drive_at_one_metre_per_second();
    bench.drop_to_client = [](const Bytes &) { return true; };
    const std::uint64_t deaf_us = bench.now_us;
    while (has_target() && bench.now_us - deaf_us < 5 * second) {
        bench.drive(1.0F, 0.0F);
        bench.run(10 * ms);
    }
    EXPECT_LE(bench.now_us - deaf_us, 300 * ms + 2 * cycle_us);
    EXPECT_EQ(0, robot.state().watchdog_tripped);
    expect_stop();
}

TEST_F(DriveSimulator, ARebootStopsTheRobotAndTheReturnDoesNotMoveIt) {
    for (const std::uint64_t off_us : {20 * ms, 500 * ms, 5 * second}) {
        SCOPED_TRACE(off_us);
        if (bench.state() == ROBUROC4_STATE_IDLE)
            drive_at_one_metre_per_second();
        power(0);
        const std::uint64_t on_us = bench.now_us + off_us;
        while (bench.now_us < on_us) {
            bench.drive(1.0F, 0.0F);
            bench.run(10 * ms);
        }
        power(1);
        for (int i = 0; i < 500; i++) {
            bench.drive(1.0F, 0.0F);
            bench.run(10 * ms);
        }
        ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 10 * second));
        EXPECT_EQ(0, bench.facts().armed);
        expect_stop();
        expect_that_only_arming_moves_it();
    }
}

/* ------------------------------------------------------------------------- two clients --- */

TEST_F(DriveSimulator, AMonitorNeverCommands) {
    bench.ready();
    std::uint32_t foreign = 0;
    for (int i = 0; i < 300; i++) {
        Bytes command(11);
        roburoc4_encode_differential_command(command.data(), command.size(),
                                             ROBUROC4_SERVICE_DIFFERENTIAL, 0.5F, 0.2F);
        robot.deliver(command);
        foreign++;
        if (i == 100)
            bench.disarm();
        if (i == 200)
            power(0), power(1);
        bench.run(50 * ms);
    }
    EXPECT_EQ(ROBUROC4_OK, bench.close());
    bench.run(2 * second);
    EXPECT_EQ(foreign, robot.state().speed_commands);
    EXPECT_EQ(0U, bench.commands().size());
}

TEST_F(DriveSimulator, AnotherCommanderDisarmsTheDriver) {
    drive_at_one_metre_per_second();
    for (int i = 0; i < 50; i++) {
        Bytes command(11);
        roburoc4_encode_differential_command(command.data(), command.size(),
                                             ROBUROC4_SERVICE_DIFFERENTIAL, -0.5F, 0.0F);
        robot.deliver(command);
        bench.drive(1.0F, 0.0F);
        bench.run(10 * ms);
    }
    EXPECT_EQ(0, bench.facts().armed);
    EXPECT_EQ(ROBUROC4_ERR_OTHER_COMMANDER, bench.facts().disarm_cause);
    expect_stop();
}
