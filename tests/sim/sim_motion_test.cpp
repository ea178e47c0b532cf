/* SPDX-License-Identifier: MIT
 *
 * sim_motion_test.cpp - how the simulated robot moves: the measured speed response, its limits, the
 * watchdog, odometry, and slip.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim_support.h"

using namespace roburoc4_tests;

namespace {

constexpr double cycle_s = 0.01;

roburoc4_sim_config without_slip() {
    roburoc4_sim_config config = default_sim_config();
    config.slip = 0.0F;
    return config;
}

/** A robot on an endless empty floor. */
class OpenFloor : public SimRobot {
  public:
    explicit OpenFloor(const roburoc4_sim_config &config = without_slip()) : SimRobot(config) {
        roburoc4_sim_clear_obstacles(get());
    }
};

/** Speeds after each of this many cycles of a step, as the differential statuses report them. */
std::vector<double> step_response(float linear_m_s, float angular_rad_s, int cycles) {
    OpenFloor robot;
    std::vector<double> speeds;
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_DIFFERENTIAL, 1));
    for (int cycle = 0; cycle < cycles; cycle++) {
        if (cycle % 10 == 0)
            robot.command(linear_m_s, angular_rad_s);
        robot.run(1);
        for (const auto &sent : robot.take()) {
            roburoc4_differential_status status{};
            EXPECT_EQ(0, roburoc4_decode_differential_status(sent.bytes.data(), sent.bytes.size(),
                                                             &status));
            speeds.push_back(double(linear_m_s != 0.0F ? status.current_linear_m_s
                                                       : status.current_angular_rad_s));
        }
    }
    EXPECT_EQ(std::size_t(cycles), speeds.size());
    return speeds;
}

/** That it is the step response of second order. */
void expect_second_order(const std::vector<double> &speeds, double gain, double omega,
                         double zeta) {
    const double damped = omega * std::sqrt(1.0 - zeta * zeta);
    const double sigma = zeta * omega;
    for (std::size_t index = 0; index < speeds.size(); index++) {
        const double t = cycle_s * double(index + 1);
        const double left =
            std::exp(-sigma * t) * (std::cos(damped * t) + sigma / damped * std::sin(damped * t));
        ASSERT_NEAR(gain * (1.0 - left), speeds[index], 1e-5) << "cycle " << index + 1;
    }
}

void run_to_rest(SimRobot &robot) {
    for (int cycle = 0; cycle < 2000 && (robot.state().wheel_linear_m_s != 0.0 ||
                                         robot.state().wheel_angular_rad_s != 0.0);
         cycle++)
        robot.run(1);
}

} // namespace

/* ------------------------------------------------------------------------------ response --- */

TEST(SimStepResponse, IsTheMeasuredOneOfSecondOrder) {
    expect_second_order(step_response(1.0F, 0.0F, 400), 1.0, 2.46, 0.79);
    expect_second_order(step_response(0.0F, -1.5F, 400), -1.5, 2.42, 0.77);
}

TEST(SimStepResponse, IsFlattenedByTheLimitsWhenReversing) {
    OpenFloor robot;
    robot.drive(2.6F, 6.5F, 500);
    double before = robot.state().wheel_linear_m_s;
    double turning = robot.state().wheel_angular_rad_s;
    double hardest = 0.0;
    for (int cycle = 0; cycle < 400; cycle++) {
        robot.drive(-2.6F, -6.5F, 1);
        const auto state = robot.state();
        ASSERT_LE(std::fabs(state.wheel_linear_m_s - before), 3.0 * cycle_s + 1e-9);
        ASSERT_LE(std::fabs(state.wheel_angular_rad_s - turning), 8.0 * cycle_s + 1e-9);
        hardest = std::max(hardest, std::fabs(state.wheel_linear_m_s - before));
        before = state.wheel_linear_m_s;
        turning = state.wheel_angular_rad_s;
    }
    EXPECT_NEAR(3.0 * cycle_s, hardest, 1e-6) << "a full reversal needs the limit";
    EXPECT_NEAR(-2.6, before, 0.05);
}

/* -------------------------------------------------------------------------------- commands --- */

TEST(SimTarget, IsClampedToThePropertiesLimits) {
    OpenFloor robot;
    robot.command(10.0F, -100.0F);
    EXPECT_NEAR(2.6, robot.state().target_linear_m_s, 1e-6);
    EXPECT_NEAR(-6.5, robot.state().target_angular_rad_s, 1e-6);
    roburoc4_sim_config config = without_slip();
    config.max_linear_m_s = 0.5F;
    config.min_linear_m_s = -0.25F;
    OpenFloor slow(config);
    slow.command(-1.0F, 0.0F);
    EXPECT_NEAR(-0.25, slow.state().target_linear_m_s, 1e-6);
}

TEST(SimTarget, IgnoresNaNAndInfinity) {
    OpenFloor robot;
    robot.command(0.5F, 0.1F);
    robot.command(std::numeric_limits<float>::quiet_NaN(), 0.0F);
    robot.command(0.0F, std::numeric_limits<float>::infinity());
    EXPECT_DOUBLE_EQ(0.5, robot.state().target_linear_m_s);
    EXPECT_EQ(2U, robot.state().refused_speed_commands);
    EXPECT_EQ(3U, robot.state().speed_commands);
}

TEST(SimWatchdog, TripsExactlyAfterItsCyclesAndReportsTargetZero) {
    OpenFloor robot;
    robot.command(1.0F, 0.5F);
    robot.run(99);
    EXPECT_DOUBLE_EQ(1.0, robot.state().target_linear_m_s);
    EXPECT_EQ(0, robot.state().watchdog_tripped);
    robot.run(1);
    EXPECT_DOUBLE_EQ(0.0, robot.state().target_linear_m_s);
    EXPECT_DOUBLE_EQ(0.0, robot.state().target_angular_rad_s);
    EXPECT_EQ(1, robot.state().watchdog_tripped);
    EXPECT_GT(robot.state().wheel_linear_m_s, 0.5) << "it is still fast";
    run_to_rest(robot);
    robot.run(1);
    EXPECT_DOUBLE_EQ(0.0, robot.state().true_linear_m_s);
    robot.command(1.0F, 0.0F);
    robot.run(50);
    EXPECT_GT(robot.state().wheel_linear_m_s, 0.1) << "the next command is obeyed again";
}

TEST(SimWatchdog, IsFedByAnySpeedCommandAndHasAConfigurableTime) {
    roburoc4_sim_config config = without_slip();
    config.watchdog_cycles = 7;
    OpenFloor robot(config);
    for (int turn = 0; turn < 20; turn++) {
        robot.command(0.3F, 0.0F);
        robot.run(6);
        ASSERT_EQ(0, robot.state().watchdog_tripped);
    }
    robot.run(1);
    EXPECT_EQ(1, robot.state().watchdog_tripped);
}

/* -------------------------------------------------------------------- odometry, true motion --- */

TEST(SimOdometry, WithoutSlipIsTheTruth) {
    OpenFloor robot;
    robot.drive(1.0F, 0.7F, 800);
    robot.drive(-0.5F, -1.5F, 400);
    const auto state = robot.state();
    EXPECT_NEAR(state.true_x_m, state.odometry_x_m, 1e-9);
    EXPECT_NEAR(state.true_y_m, state.odometry_y_m, 1e-9);
    EXPECT_NEAR(state.true_theta_rad, state.odometry_theta_rad, 1e-9);
}

TEST(SimSlip, TheBodyTurnsLessThanTheWheelsSay) {
    OpenFloor robot(default_sim_config());
    double wheels = 0.0;
    double body = 0.0;
    for (int cycle = 0; cycle < 1000; cycle++) {
        robot.drive(0.0F, 1.0F, 1);
        wheels += robot.state().wheel_angular_rad_s * cycle_s;
        body += robot.state().true_angular_rad_s * cycle_s;
    }
    EXPECT_GT(wheels, 9.0);
    EXPECT_NEAR(0.12, 1.0 - body / wheels, 0.06);
    EXPECT_GT(1.0 - body / wheels, 0.02);
}

TEST(SimMotion, ComesToAnExactRest) {
    OpenFloor robot;
    robot.drive(1.0F, 1.0F, 200);
    robot.drive(0.0F, 0.0F, 600);
    const auto state = robot.state();
    EXPECT_EQ(0.0, state.wheel_linear_m_s);
    EXPECT_EQ(0.0, state.wheel_angular_rad_s);
    robot.run(500);
    EXPECT_EQ(state.true_x_m, robot.state().true_x_m);
}
