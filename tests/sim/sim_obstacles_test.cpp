/* SPDX-License-Identifier: MIT
 *
 * sim_obstacles_test.cpp - the obstacles around the simulated robot: free space at the start, walls
 * that no body passes, bumpers, telemeters.
 */
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "sim_support.h"

extern "C" roburoc4_result sim_obstacles_move_box(roburoc4_sim *sim, uint32_t number, double x_m,
                                                  double y_m, double theta_rad);

using namespace roburoc4_tests;

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double half_length = 0.655;
constexpr double half_width = 0.375;

roburoc4_sim_config without_slip() {
    roburoc4_sim_config config = default_sim_config();
    config.slip = 0.0F;
    return config;
}

/** A robot on an empty floor, for tests that add their own obstacles. */
class SimObstacles : public testing::Test {
  protected:
    SimObstacles() : robot(without_slip()) {
        roburoc4_sim_clear_obstacles(robot.get());
    }

    [[nodiscard]] roburoc4_sim *sim() const {
        return robot.get();
    }

    /** A thin box between two points; what adding it returns. */
    [[nodiscard]] roburoc4_result wall(double x1, double y1, double x2, double y2) const {
        return roburoc4_sim_add_box(sim(), 0.5 * (x1 + x2), 0.5 * (y1 + y2),
                                    std::hypot(x2 - x1, y2 - y1), 0.1,
                                    std::atan2(y2 - y1, x2 - x1));
    }

    SimRobot robot;
};

using SimBumper = SimObstacles;
using SimTelemeter = SimObstacles;

} // namespace

/* --------------------------------------------------------------------------- default world --- */

TEST(SimDefaultWorld, LeavesFiveMetresClearAllAroundTheStart) {
    for (const double heading : {0.0, 2.0}) {
        roburoc4_sim_config config = without_slip();
        config.start_x_m = 20.0;
        config.start_y_m = -7.0;
        config.start_theta_rad = heading;
        SimRobot robot(config);
        for (int degree = 0; degree < 360; degree += 2) {
            const double way = pi / 180.0 * degree;
            EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_place(robot.get(), 20.0 + 5.0 * std::cos(way),
                                                      -7.0 + 5.0 * std::sin(way), heading))
                << "moved 5 m towards " << degree;
        }
    }
}

/* --------------------------------------------------------------------------------- bumpers --- */

TEST_F(SimBumper, StopsAtAWallAndFreesTheOtherDirection) {
    ASSERT_EQ(0, wall(3.0, -2.0, 3.0, 2.0));
    robot.drive(1.0F, 0.0F, 500);
    auto state = robot.state();
    EXPECT_EQ(1, state.front_bumper);
    EXPECT_EQ(0, state.rear_bumper);
    EXPECT_NEAR(3.0 - 0.05 - half_length, state.true_x_m, 0.01) << "nose at the wall's face";
    EXPECT_LE(state.true_x_m, 3.0 - 0.05 - half_length);
    EXPECT_EQ(0.0, state.wheel_linear_m_s);
    EXPECT_EQ(0.0, state.true_linear_m_s);
    EXPECT_DOUBLE_EQ(1.0, state.target_linear_m_s) << "the target is still reported";
    robot.drive(-1.0F, 0.0F, 100);
    state = robot.state();
    EXPECT_EQ(0, state.front_bumper);
    EXPECT_LT(state.true_x_m, 2.0);
}

TEST_F(SimBumper, OfTheRearStopsBackwardMotion) {
    ASSERT_EQ(0, roburoc4_sim_add_box(sim(), -3.0, 0.0, 1.0, 1.0, 0.0));
    robot.drive(-2.6F, 0.0F, 500);
    const auto state = robot.state();
    EXPECT_EQ(1, state.rear_bumper);
    EXPECT_EQ(0, state.front_bumper);
    EXPECT_NEAR(-2.5 + half_length, state.true_x_m, 0.01);
    EXPECT_GE(state.true_x_m, -2.5 + half_length);
    EXPECT_EQ(0.0, state.wheel_linear_m_s);
}

TEST_F(SimBumper, PressedByHandBlocksItsDirectionOnly) {
    robot.drive(1.0F, 0.0F, 200);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_sim_set(sim(), ROBUROC4_SIM_FRONT_BUMPER, 1));
    robot.drive(1.0F, 0.5F, 100);
    EXPECT_EQ(0.0, robot.state().wheel_linear_m_s);
    EXPECT_GT(robot.state().wheel_angular_rad_s, 0.3) << "turning is free";
    robot.drive(-0.5F, 0.0F, 200);
    EXPECT_NEAR(-0.5, robot.state().wheel_linear_m_s, 0.02);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_sim_set(sim(), ROBUROC4_SIM_FRONT_BUMPER, 0));
    robot.drive(1.0F, 0.0F, 300);
    EXPECT_NEAR(1.0, robot.state().wheel_linear_m_s, 0.02);
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, roburoc4_sim_set(sim(), ROBUROC4_SIM_FRONT_BUMPER, 0.5));
}

TEST_F(SimObstacles, AWallAtTheSideBlocksTheTurnWhileTheWheelsSpin) {
    ASSERT_EQ(0, wall(-3.0, half_width + 0.06, 3.0, half_width + 0.06));
    ASSERT_EQ(1, wall(-3.0, -half_width - 0.06, 3.0, -half_width - 0.06));
    robot.drive(0.0F, 1.0F, 300);
    const auto state = robot.state();
    EXPECT_LT(std::fabs(state.true_theta_rad), 0.05);
    EXPECT_GT(std::fabs(state.odometry_theta_rad), 2.0);
    EXPECT_NEAR(1.0, state.wheel_angular_rad_s, 0.02);
}

TEST_F(SimObstacles, FastMotionDoesNotTunnelThroughThinWalls) {
    ASSERT_EQ(0, wall(8.0, -5.0, 8.0, 5.0));
    robot.drive(2.6F, 0.0F, 1000);
    EXPECT_LT(robot.state().true_x_m, 8.0);
    EXPECT_EQ(1, robot.state().front_bumper);
}

TEST_F(SimObstacles, RefusesInvalidObstacles) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(ROBUROC4_ERR_STATE, roburoc4_sim_add_box(sim(), 0.9, 0.0, 1.0, 1.0, 0.0));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, roburoc4_sim_add_box(sim(), nan, 0.0, 1.0, 1.0, 0.0));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, roburoc4_sim_add_box(sim(), 5.0, 0.0, 0.0, 1.0, 0.0));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, roburoc4_sim_add_box(sim(), 5.0, 0.0, 1.0, nan, 0.0));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, wall(5.0, 0.0, 5.0, 0.0));
    EXPECT_EQ(ROBUROC4_ERR_INDEX, sim_obstacles_move_box(sim(), 0, 5.0, 0.0, 0.0));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, roburoc4_sim_place(sim(), 0.0, nan, 0.0));
    ASSERT_EQ(0, roburoc4_sim_add_box(sim(), 5.0, 0.0, 1.0, 1.0, 0.0));
    EXPECT_EQ(ROBUROC4_ERR_STATE, sim_obstacles_move_box(sim(), 0, 0.0, 0.0, 0.0));
    EXPECT_EQ(ROBUROC4_ERR_STATE, roburoc4_sim_place(sim(), 5.0, 0.0, 0.0));
    for (int number = 1; number < ROBUROC4_SIM_MAX_BOXES; number++)
        ASSERT_EQ(number, roburoc4_sim_add_box(sim(), 50.0, 0.0, 1.0, 1.0, 0.0));
    EXPECT_EQ(ROBUROC4_ERR_BUFFER, roburoc4_sim_add_box(sim(), 50.0, 0.0, 1.0, 1.0, 0.0));
}

TEST_F(SimObstacles, PlacingMovesTheBodyButNotTheOdometry) {
    robot.drive(1.0F, 0.0F, 100);
    const double odometry = robot.state().odometry_x_m;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_sim_place(sim(), -3.0, 2.0, 4.0));
    const auto state = robot.state();
    EXPECT_DOUBLE_EQ(-3.0, state.true_x_m);
    EXPECT_NEAR(4.0 - 2.0 * pi, state.true_theta_rad, 1e-12);
    EXPECT_DOUBLE_EQ(odometry, state.odometry_x_m);
    EXPECT_EQ(0.0, state.wheel_linear_m_s);
}

/* ------------------------------------------------------------------------------- telemeters --- */

TEST_F(SimTelemeter, MeasureFromTheBodysEnds) {
    ASSERT_EQ(0, wall(4.0, -3.0, 4.0, 3.0));
    ASSERT_EQ(1, wall(-3.0, -3.0, -3.0, 3.0));
    auto state = robot.state();
    EXPECT_NEAR(4.0 - 0.05 - half_length, double(state.distances_m[ROBUROC4_TELEMETER_FRONT]),
                1e-5);
    EXPECT_NEAR(3.0 - 0.05 - half_length, double(state.distances_m[ROBUROC4_TELEMETER_REAR]), 1e-5);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_sim_place(sim(), 1.0, 0.0, pi));
    state = robot.state();
    EXPECT_NEAR(4.0 - 0.05 - half_length, double(state.distances_m[ROBUROC4_TELEMETER_FRONT]),
                1e-5);
}

TEST_F(SimTelemeter, SeeWithinTheirConeAndRange) {
    const auto front = [this] { return double(robot.state().distances_m[0]); };
    EXPECT_DOUBLE_EQ(6.0, front()) << "nothing there: the largest distance";
    const auto box = roburoc4_sim_add_box(sim(), 4.0, 0.7, 0.4, 0.4, 0.0);
    ASSERT_EQ(0, box);
    EXPECT_LT(front(), 3.4) << "0.5 m aside at 3.1 m is within 15 degrees";
    ASSERT_EQ(ROBUROC4_OK, sim_obstacles_move_box(sim(), 0, 4.0, 1.6, 0.0));
    EXPECT_DOUBLE_EQ(6.0, front()) << "beside the cone";
    ASSERT_EQ(ROBUROC4_OK, sim_obstacles_move_box(sim(), 0, half_length + 0.3, 0.0, 0.0));
    EXPECT_DOUBLE_EQ(0.25, front()) << "nearer than it can measure";
    ASSERT_EQ(ROBUROC4_OK, sim_obstacles_move_box(sim(), 0, half_length + 6.5, 0.0, 0.0));
    EXPECT_DOUBLE_EQ(6.0, front()) << "farther than it can measure";
}
