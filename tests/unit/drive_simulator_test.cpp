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

    SimPartner robot;
    Bench bench;
};

} // namespace

TEST_F(DriveSimulator, TheRobotStopsWhenTheCallerNoLongerRenews) {
    drive_at_one_metre_per_second();
    ASSERT_EQ(ROBUROC4_OK, bench.drive(1.0F, 0.0F, 250000));
    EXPECT_LE(until_target_is_zero(), 250 * ms + cycle_us);
    EXPECT_EQ(0, robot.state().watchdog_tripped);
    expect_stop();
    EXPECT_EQ(0, bench.facts().stopping);
    EXPECT_EQ(0U, robot.state().refused_speed_commands);
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
