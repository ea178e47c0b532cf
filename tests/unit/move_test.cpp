/* SPDX-License-Identifier: MIT
 *
 * move_test.cpp - moves of roburoc4_move.h: a client and the simulated robot in virtual time,
 * judged by the robot's final position and by the commanded speeds.
 */
#include "roburoc4_move.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "client_bench.h"
#include "drawn.h"
#include "roburoc4_sim.h"

using roburoc4_tests::Drawn;

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180;
constexpr std::uint64_t second = 1000000;
constexpr std::uint64_t cycle_us = 10000;
/* Lag of a RobuROC4's speed behind its target: 2 * damping / natural frequency. */
constexpr double response_s = 0.64;
constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

double wrapped(double angle_rad) {
    return std::remainder(angle_rad, 2 * pi);
}

/** A robot without slip in an empty world, and an armed client. */
class Moving : public testing::Test {
  protected:
    Moving() {
        roburoc4_sim_config_init(&robot_config, sizeof robot_config);
        robot_config.slip = 0;
        roburoc4_config_init(&config, sizeof config);
        roburoc4_move_options_init(&options, sizeof options);
    }
    ~Moving() override {
        roburoc4_world_destroy(world);
    }
    void connect() {
        world = roburoc4_world_create(&robot_config);
        roburoc4_sim_clear_obstacles(robot());
        roburoc4_client_init(&client, sizeof client, &config);
        roburoc4_world_join(world, &client);
    }
    void arm() {
        const std::uint64_t end_us = now() + 5 * second;
        while (roburoc4_client_arm(&client, now()) < 0 && now() < end_us)
            pass(cycle_us);
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_arm(&client, now()));
    }
    void connect_and_arm() {
        connect();
        arm();
        pass(second);
    }
    roburoc4_sim *robot() {
        return roburoc4_world_robot(world);
    }
    [[nodiscard]] std::uint64_t now() const {
        return roburoc4_world_now_us(world);
    }
    roburoc4_sim_state state() {
        roburoc4_sim_state s;
        s.size = sizeof s;
        roburoc4_sim_get_state(robot(), &s);
        return s;
    }
    void pass(std::uint64_t span_us) {
        const std::uint64_t end_us = now() + span_us;
        while (roburoc4_world_step(world, end_us, nullptr, nullptr) != 0) {
        }
    }

    /** Step the move to its end, or for this long; `meanwhile` is called at each step. */
    std::int32_t go(const std::function<void()> &meanwhile = nullptr, double seconds = 120) {
        begun_us = now();
        start = state();
        most_linear = most_angular = most_acceleration = most_reached = most_turned = 0;
        steepest_linear = steepest_angular = 0;
        double last_speed = start.true_linear_m_s;
        roburoc4_move before{};
        const auto end_us = begun_us + static_cast<std::uint64_t>(seconds * second);
        while (now() < end_us &&
               roburoc4_move_step(&move, &client, now()) == ROBUROC4_MOVE_RUNNING) {
            (void)roburoc4_client_drive(&client, move.linear_m_s, move.angular_rad_s, 0, now());
            steepest_linear =
                std::max(steepest_linear, 100 * std::fabs(move.linear_m_s - before.linear_m_s));
            steepest_angular = std::max(steepest_angular,
                                        100 * std::fabs(move.angular_rad_s - before.angular_rad_s));
            before = move;
            most_linear = std::max(most_linear, std::fabs(double{move.linear_m_s}));
            most_angular = std::max(most_angular, std::fabs(double{move.angular_rad_s}));
            if (meanwhile)
                meanwhile();
            pass(cycle_us);
            const roburoc4_sim_state s = state();
            most_acceleration = std::max(
                most_acceleration, std::fabs(s.true_linear_m_s - last_speed) / (cycle_us * 1e-6));
            last_speed = s.true_linear_m_s;
            most_reached = std::max(
                most_reached, std::hypot(s.true_x_m - start.true_x_m, s.true_y_m - start.true_y_m));
            most_turned =
                std::max(most_turned, std::fabs(wrapped(s.true_theta_rad - start.true_theta_rad)));
        }
        took_s = static_cast<double>(now() - begun_us) * 1e-6;
        EXPECT_TRUE(move.outcome == ROBUROC4_MOVE_RUNNING ||
                    (move.linear_m_s == 0 && move.angular_rad_s == 0));
        return move.outcome;
    }
    /** Ahead and to the left of where the last move started, and turned since. */
    double ahead() {
        const roburoc4_sim_state s = state();
        return (s.true_x_m - start.true_x_m) * std::cos(start.true_theta_rad) +
               (s.true_y_m - start.true_y_m) * std::sin(start.true_theta_rad);
    }
    double aside() {
        const roburoc4_sim_state s = state();
        return (s.true_y_m - start.true_y_m) * std::cos(start.true_theta_rad) -
               (s.true_x_m - start.true_x_m) * std::sin(start.true_theta_rad);
    }
    double turned() {
        return wrapped(state().true_theta_rad - start.true_theta_rad);
    }
    void expect_standing() {
        EXPECT_NEAR(0, state().true_linear_m_s, 0.03);
        EXPECT_NEAR(0, state().true_angular_rad_s, 0.06);
    }
    void expect_stopped() {
        pass(cycle_us);
        EXPECT_EQ(0, state().target_linear_m_s);
        EXPECT_EQ(0, state().target_angular_rad_s);
    }
    std::int32_t straight(float distance_m) {
        EXPECT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, distance_m, 0, &options));
        return go();
    }
    std::int32_t turn(double angle_rad) {
        EXPECT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 0, static_cast<float>(angle_rad), &options));
        return go();
    }
    /** The time of a profile with constant acceleration, and of the robot's response to it. */
    static double ideal_s(double way, double speed, double acceleration) {
        const double rise_s = speed / acceleration;
        return response_s +
               (speed * rise_s <= way ? way / speed + rise_s : 2 * std::sqrt(way / acceleration));
    }
    /** Half way through a straight move of 2 m, something happens. */
    std::int32_t interrupted_by(const std::function<void()> &what) {
        EXPECT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 2.0F, 0, &options));
        bool done = false;
        return go([&] {
            if (!done && ahead() > 1.0) {
                done = true;
                what();
            }
        });
    }

    roburoc4_sim_config robot_config{};
    roburoc4_config config{};
    roburoc4_move_options options{};
    roburoc4_client client{};
    roburoc4_move move{};
    roburoc4_world *world = nullptr;
    roburoc4_sim_state start{};
    std::uint64_t begun_us = 0;
    double most_linear = 0, most_angular = 0, most_acceleration = 0, most_reached = 0,
           most_turned = 0, took_s = 0;
    float steepest_linear = 0, steepest_angular = 0; /* of the commands, per second */
};

class Move : public Moving {
  protected:
    void SetUp() override {
        connect_and_arm();
    }
};

} // namespace

/* --------------------------------------------------------------------------- how well it moves */

TEST_F(Move, ASquareOfTwoMetresCloses) {
    const roburoc4_sim_state before = state();
    for (int side = 0; side < 4; side++) {
        ASSERT_EQ(ROBUROC4_MOVE_REACHED, straight(2.0F));
        ASSERT_EQ(ROBUROC4_MOVE_REACHED, turn(pi / 2));
    }
    EXPECT_LT(std::hypot(state().true_x_m - before.true_x_m, state().true_y_m - before.true_y_m),
              0.1);
}

TEST_F(Moving, ASquareOfACalibratedRobotReallyCloses) {
    robot_config.slip = 0.12F;
    config.scale_angular = 1 / (1 - robot_config.slip);
    connect_and_arm();
    const roburoc4_sim_state before = state();
    for (int side = 0; side < 4; side++) {
        ASSERT_EQ(ROBUROC4_MOVE_REACHED, straight(2.0F));
        ASSERT_EQ(ROBUROC4_MOVE_REACHED, turn(pi / 2));
        EXPECT_NEAR(pi / 2, move.angle_rad, 1 * degree) << "as it really turned";
    }
    EXPECT_LT(std::hypot(state().true_x_m - before.true_x_m, state().true_y_m - before.true_y_m),
              0.15);
}

TEST_F(Move, BackwardAndToTheRightAreNegative) {
    for (const float speed : {0.3F, 1.0F}) {
        options.max_linear_m_s = options.max_angular_rad_s = speed;
        ASSERT_EQ(ROBUROC4_MOVE_REACHED, straight(-0.7F)) << move.cause;
        EXPECT_NEAR(-0.7, ahead(), 0.01) << speed;
        EXPECT_NEAR(0, aside(), 0.01) << speed;
        EXPECT_LE(most_linear, speed);
        EXPECT_NEAR(-0.7, move.distance_m, 0.01);
        EXPECT_NEAR(0, move.remaining_m, 0.01);
        expect_standing();
        ASSERT_EQ(ROBUROC4_MOVE_REACHED, turn(-1.0));
        EXPECT_NEAR(-1.0, turned(), 1 * degree) << speed;
        EXPECT_LE(most_angular, speed);
        EXPECT_NEAR(-1.0, move.angle_rad, 1 * degree);
        expect_standing();
    }
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, straight(-4));
}

TEST_F(Move, SmallAndNoMovesAreReached) {
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, straight(0.05F));
    EXPECT_NEAR(0.05, ahead(), 0.01);
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, turn(3 * degree));
    EXPECT_NEAR(3 * degree, turned(), 1 * degree);
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, straight(0.0F));
    EXPECT_NEAR(0.0, ahead(), 0.01);
}

TEST_F(Move, MoreThanTwoTurnsMustBeAskedFor) {
    EXPECT_EQ(ROBUROC4_ERR_UNITS,
              roburoc4_move_by(&move, 0, static_cast<float>(4 * pi + 1), &options));
    options.allow_turns = 1;
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, turn(4 * pi + 1));
    EXPECT_NEAR(1.0, turned(), 1 * degree);
    EXPECT_NEAR(4 * pi + 1, move.angle_rad, 1 * degree);
}

TEST_F(Move, AnArcKeepsItsRadius) {
    for (const double side : {1.0, -1.0}) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, static_cast<float>(pi / 2),
                                                static_cast<float>(side * pi / 2), &options));
        ASSERT_EQ(ROBUROC4_MOVE_REACHED, go());
        EXPECT_NEAR(1.0, ahead(), 0.03) << side;
        EXPECT_NEAR(side * 1.0, aside(), 0.03) << side;
        EXPECT_NEAR(side * pi / 2, turned(), 2 * degree) << side;
        EXPECT_LE(most_angular, 0.55);
    }
}

TEST_F(Move, CirclesCloseHoweverUnevenlyTheyAreStepped) {
    std::mt19937 random(20261127);
    const auto draw = [&random](double least, double most) {
        return std::uniform_real_distribution<double>(least, most)(random);
    };
    for (int i = 0; i < 10; i++) {
        const double radius_m = draw(0.2, 0.6), longest_us = draw(0, 70000);
        const double turn = i % 2 == 0 ? 2 * pi : -2 * pi;
        SCOPED_TRACE(std::to_string(radius_m) + " m, " + std::to_string(longest_us) + " us");
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, static_cast<float>(radius_m * 2 * pi),
                                                static_cast<float>(turn), &options));
        ASSERT_EQ(ROBUROC4_MOVE_REACHED,
                  go([&] { pass(static_cast<std::uint64_t>(draw(0, longest_us))); }));
        EXPECT_NEAR(0, ahead(), 0.02);
        EXPECT_NEAR(0, aside(), 0.02);
    }
}

TEST_F(Move, APointIsReachedFromAnyPose) {
    double points[12][2];
    Drawn drawn;
    for (auto &point : points)
        for (double &place : point)
            place = drawn.within(2);
    for (const auto &point : points) {
        const double y_m = point[1] - state().true_y_m, x_m = point[0] - state().true_x_m;
        const double way = std::atan2(y_m, x_m);
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_point(&move, point[0], point[1], &options));
        double most_aside = 0;
        ASSERT_EQ(ROBUROC4_MOVE_REACHED, go([&] {
                      const roburoc4_sim_state s = state();
                      most_aside =
                          std::max(most_aside, std::fabs((s.true_y_m - point[1]) * std::cos(way) -
                                                         (s.true_x_m - point[0]) * std::sin(way)));
                  }))
            << move.cause;
        EXPECT_LT(most_aside, 0.03) << "it drove straight";
        EXPECT_NEAR(0.0, wrapped(way - state().true_theta_rad), 0.05 + 0.01 / std::hypot(x_m, y_m));
        EXPECT_NEAR(point[0], state().true_x_m, 0.02);
        EXPECT_NEAR(point[1], state().true_y_m, 0.02);
        expect_standing();
    }
}

TEST_F(Moving, ALineAfterATurnBrakesEarlyToo) {
    robot_config.linear_gain = 1.15F;
    connect_and_arm();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_point(&move, 0, 1, &options));
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, go());
    EXPECT_LT(most_reached, 1.01);
}

TEST_F(Move, APoseIsReachedWithItsHeading) {
    for (const double theta : {0.0, 2.5, -1.0, 7.0}) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_pose(&move, theta, 1.0, theta, &options));
        ASSERT_EQ(ROBUROC4_MOVE_REACHED, go());
        EXPECT_NEAR(theta, state().true_x_m, 0.02);
        EXPECT_NEAR(1.0, state().true_y_m, 0.02);
        EXPECT_NEAR(0.0, wrapped(theta - state().true_theta_rad), 1 * degree);
    }
}

TEST_F(Moving, ItAcceleratesGently) {
    config.max_linear_m_s = 2;
    connect_and_arm();
    options.max_linear_m_s = 1.5F;
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, straight(4.0F));
    EXPECT_LT(most_acceleration, 0.5 * 1.2);
    options.max_linear_m_s2 = 1.0F;
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, straight(4.0F));
    EXPECT_GT(most_acceleration, 0.8);
    EXPECT_LT(most_acceleration, 1.0 * 1.2);
}

TEST_F(Move, AManyTimesSteppedMoveIsTheSame) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1.0F, 0, &options));
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, go([&] {
                  for (int i = 0; i < 9; i++) {
                      pass(cycle_us / 10);
                      roburoc4_move_step(&move, &client, now());
                      (void)roburoc4_client_drive(&client, move.linear_m_s, move.angular_rad_s, 0,
                                                  now());
                  }
              }));
    EXPECT_NEAR(1.0, ahead(), 0.01);
    EXPECT_NEAR(ideal_s(1, 0.3, 0.5), took_s, 0.15 * ideal_s(1, 0.3, 0.5));
}

TEST_F(Moving, TheRobotsOwnAccelerationsCountWhereLower) {
    robot_config.max_linear_m_s2 = 0.2F;
    robot_config.min_linear_m_s2 = -0.2F;
    robot_config.max_linear_m_s = 0.5F;
    robot_config.min_linear_m_s = -0.4F;
    connect_and_arm();
    options.max_linear_m_s = 1.0F;
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, straight(2.0F));
    EXPECT_NEAR(2.0, ahead(), 0.02);
    EXPECT_LT(most_reached, 2.04);
    EXPECT_LE(most_linear, 0.4 + 1e-6) << "the lower one of both ways";
    EXPECT_NEAR(0.2, steepest_linear, 0.01);
}

TEST_F(Moving, TheRobotsOwnTurnsCountWhereLower) {
    for (const float weaker : {1.0F, 0.5F, 2.0F}) { /* to the left, by those to the right */
        robot_config.max_angular_rad_s = 0.2F * std::max(weaker, 1.0F);
        robot_config.min_angular_rad_s = -0.2F * std::max(1 / weaker, 1.0F);
        robot_config.max_angular_rad_s2 = 0.3F * std::max(weaker, 1.0F);
        robot_config.min_angular_rad_s2 = -0.3F * std::max(1 / weaker, 1.0F);
        connect_and_arm();
        ASSERT_EQ(ROBUROC4_MOVE_REACHED, turn(1));
        EXPECT_NEAR(0.2, most_angular, 0.001) << weaker;
        EXPECT_NEAR(0.3, steepest_angular, 0.03) << weaker;
        roburoc4_world_destroy(world);
        world = nullptr;
    }
}

TEST_F(Move, APlaceIsWorthDrivingToFromTwoCentimetres) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_point(&move, 0.05, 0, &options));
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, go());
    EXPECT_NEAR(0.05, ahead(), 0.01);
    const roburoc4_sim_state here = state();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_pose(&move, here.odometry_x_m,
                                                 here.odometry_y_m + 0.008, 1, &options));
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, go());
    EXPECT_NEAR(1, wrapped(state().true_theta_rad), 1 * degree);
    EXPECT_EQ(0, most_linear) << "it turned in place";
    EXPECT_LT(most_turned, 1.02) << "the short way";
}

TEST_F(Moving, LimitsAndOdometryOfARobotThatCountsTwiceAreHalf) {
    robot_config.max_linear_m_s2 = 0.4F;
    robot_config.min_linear_m_s2 = -0.4F;
    robot_config.max_angular_rad_s = 0.4F;
    robot_config.min_angular_rad_s = -0.4F;
    robot_config.max_linear_m_s = 0.6F;
    robot_config.min_linear_m_s = -0.6F;
    config.scale_linear = config.scale_angular = 2;
    connect_and_arm();
    options.max_linear_m_s = options.max_angular_rad_s = 0.5F;
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, straight(1.0F));
    EXPECT_NEAR(2.0, ahead(), 0.02) << "as the robot counts";
    EXPECT_LT(most_reached, 2.04);
    EXPECT_LE(most_linear, 0.3 + 1e-6);
    EXPECT_NEAR(0.2, steepest_linear, 0.01);
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, turn(1.0));
    EXPECT_NEAR(2.0, turned(), 2 * degree);
    EXPECT_LE(most_angular, 0.2 + 1e-6);
}

TEST_F(Moving, CeilingsAndLimitsBoundAMove) {
    config.max_linear_m_s = 0.1F;
    robot_config.max_angular_rad_s = 0.2F;
    robot_config.min_angular_rad_s = -0.2F;
    connect_and_arm();
    options.max_angular_rad_s = 1.0F;
    options.max_linear_m_s = 0.31F;
    EXPECT_EQ(ROBUROC4_MOVE_TOO_FAST, straight(1.0F));
    for (const float linear_m_s : {0.11F, -0.11F}) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_for(&move, linear_m_s, 0, 1000, &options));
        EXPECT_EQ(ROBUROC4_MOVE_TOO_FAST, go());
    }
    EXPECT_EQ(0U, state().nonzero_speed_commands);
    options.max_linear_m_s = 0.3F;
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, straight(1.0F)) << "the default is lowered";
    EXPECT_NEAR(1.0, ahead(), 0.01);
    EXPECT_GT(took_s, 10);
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, turn(1.0));
    EXPECT_NEAR(1.0, turned(), 1 * degree);
    EXPECT_GT(took_s, 5);
}

TEST_F(Moving, CeilingsBoundWhatIsAskedForAndWhatIsSent) {
    config.scale_linear = 0.5F;
    config.scale_angular = 2;
    connect_and_arm();
    for (const float linear_m_s : {0.9F, 1.1F}) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_for(&move, linear_m_s, 0, 1000, &options));
        EXPECT_EQ(go(), linear_m_s < 1 ? ROBUROC4_MOVE_REACHED : ROBUROC4_MOVE_TOO_FAST);
    }
    for (const float angular_rad_s : {0.7F, 0.8F}) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_for(&move, 0, angular_rad_s, 1000, &options));
        EXPECT_EQ(go(), angular_rad_s < 0.75F ? ROBUROC4_MOVE_REACHED : ROBUROC4_MOVE_TOO_FAST);
    }
}

TEST_F(Moving, WithoutLocalizationSpeedsAreIntegrated) {
    robot_config.hidden_services = 1U << ROBUROC4_SERVICE_LOCALIZATION;
    connect_and_arm();
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, straight(1.0F)) << move.cause;
    EXPECT_NEAR(1.0, ahead(), 0.02);
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, turn(pi / 2));
    EXPECT_NEAR(pi / 2, turned(), 2 * degree);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_point(&move, 1, 1, &options));
    EXPECT_EQ(ROBUROC4_MOVE_LOST, go());
}

TEST_F(Move, IsNotEndedByThePassingOfTime) {
    pass((std::uint64_t{1} << 30) - now()); /* when old times are limited to that age */
    arm();
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, straight(3.0F)) << move.cause;
    EXPECT_NEAR(3.0, ahead(), 0.02);
}

TEST_F(Move, ARelocalizationEndsIt) {
    EXPECT_EQ(ROBUROC4_MOVE_RELOCALIZED, interrupted_by([&] {
                  roburoc4_localization_status pose{};
                  roburoc4_client_localization(&client, &pose, nullptr);
                  roburoc4_client_relocalize(&client, pose.x_m + 0.001, pose.y_m - 0.001,
                                             pose.theta_rad + 0.001, now());
              }));
    expect_stopped();
    pass(2 * second);
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, straight(0.3F)) << "the next one is free";
}

TEST_F(Move, AMoveMayBeginWhileTheRobotRolls) {
    const std::uint64_t end_us = now() + 2 * second;
    while (now() < end_us) {
        (void)roburoc4_client_drive(&client, 0.8F, 0, 0, now());
        pass(5 * cycle_us);
    }
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, straight(1.5F));
    EXPECT_NEAR(0, move.remaining_m, 0.01);
    EXPECT_NEAR(1.5 + 1.15, ahead(), 0.1) << "it counts from where the robot comes to rest";
}

/* ------------------------------------------------------------------------------- coming to rest */

TEST_F(Move, RestWaitsUntilTheRobotStands) {
    const std::uint64_t end_us = now() + 3 * second;
    while (now() < end_us) {
        (void)roburoc4_client_drive(&client, 1.0F, 0.5F, 0, now());
        pass(5 * cycle_us);
    }
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&move, nullptr));
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, go());
    expect_standing();
    EXPECT_GT(took_s, 1.0);
    EXPECT_LT(took_s, 3.0);
}

TEST_F(Moving, RestNeedsNoArming) {
    connect();
    pass(2 * second);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&move, nullptr));
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, go());
    EXPECT_EQ(0U, state().nonzero_speed_commands);
    roburoc4_sim_set(robot(), ROBUROC4_SIM_PAD_BUTTON + ROBUROC4_DI_PAD_A, 1);
    pass(second);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&move, nullptr));
    EXPECT_EQ(ROBUROC4_MOVE_OVERRIDE, go()) << "the pad drives";
}

/* ------------------------------------------------------------------------------------ ways out */

TEST_F(Move, ALostRobotEndsIt) {
    EXPECT_EQ(ROBUROC4_MOVE_LOST,
              interrupted_by([&] { roburoc4_sim_set(robot(), ROBUROC4_SIM_POWER, 0); }));
    EXPECT_LT(move.cause, 0);
}

TEST_F(Move, AnEmergencyStopEndsIt) {
    EXPECT_EQ(ROBUROC4_MOVE_INHIBITED,
              interrupted_by([&] { roburoc4_sim_set(robot(), ROBUROC4_SIM_ESTOP_LOCAL, 1); }));
    EXPECT_EQ(ROBUROC4_ERR_INHIBITED, move.cause);
    expect_stopped();
}

TEST_F(Move, ACancelledMoveStopsTheRobot) {
    EXPECT_EQ(ROBUROC4_MOVE_CANCELLED,
              interrupted_by([&] { roburoc4_move_cancel(&move, &client, now()); }));
    expect_stopped();
    pass(second);
    EXPECT_EQ(ROBUROC4_MOVE_CANCELLED, roburoc4_move_step(&move, &client, now()));
    EXPECT_EQ(0, move.linear_m_s);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, &options));
    roburoc4_move_cancel(&move, &client, now());
    EXPECT_EQ(ROBUROC4_MOVE_CANCELLED, roburoc4_move_step(&move, &client, now()))
        << "not begun yet";
}

TEST_F(Move, ThatHasEndedKeepsItsResultWhenItIsCancelled) {
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, straight(0.1F));
    roburoc4_move_cancel(&move, &client, now());
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, move.outcome);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_drive(&client, 0.1F, 0, 0, now()));
    roburoc4_move_cancel(&move, &client, now());
    roburoc4_facts facts;
    roburoc4_client_facts(&client, now(), ROBUROC4_SIZED(&facts));
    EXPECT_EQ(1, facts.driving) << "what drives now is not this move";
}

TEST_F(Move, AViewOfAnUnknownSizeEndsIt) {
    for (const std::size_t size : {std::size_t{0}, std::size_t{8}, sizeof(roburoc4_move_view) - 4,
                                   sizeof(roburoc4_move_view) + 4}) {
        roburoc4_move_view view{};
        view.size = static_cast<std::uint32_t>(size);
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, nullptr));
        EXPECT_EQ(ROBUROC4_MOVE_CANCELLED, roburoc4_move_step_view(&move, &view, now()));
        EXPECT_EQ(ROBUROC4_ERR_SIZE, move.cause);
        EXPECT_EQ(0, move.linear_m_s);
    }
}

TEST_F(Move, ADisarmedClientEndsIt) {
    EXPECT_EQ(ROBUROC4_MOVE_CANCELLED,
              interrupted_by([&] { (void)roburoc4_client_stop(&client, now()); }));
    EXPECT_EQ(ROBUROC4_ERR_STOP_CALLED, move.cause);
    expect_stopped();
}

TEST_F(Move, AStopButtonEndsIt) {
    EXPECT_EQ(ROBUROC4_MOVE_CANCELLED,
              interrupted_by([&] { roburoc4_client_pause(&client, now()); }));
    EXPECT_EQ(ROBUROC4_OK, move.cause);
    expect_stopped();
    pass(2 * second);
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, straight(0.1F)) << "the next one is free";
}

TEST_F(Move, AClientThatWasDisarmedMeanwhileEndsIt) {
    EXPECT_EQ(ROBUROC4_MOVE_CANCELLED, interrupted_by([&] {
                  (void)roburoc4_client_stop(&client, now());
                  pass(3 * second);
                  EXPECT_EQ(ROBUROC4_OK, roburoc4_client_arm(&client, now()));
              }));
    expect_stopped();
}

TEST_F(Move, AProgramThatBlocksIsDisarmedASecondLaterHoweverItGoesOn) {
    EXPECT_EQ(ROBUROC4_MOVE_LAPSED, interrupted_by([&] { pass(second / 2); }));
    roburoc4_move other;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&other, nullptr));
    for (int i = 0; i < 100; i++) {
        (void)roburoc4_move_step(&move, &client, now());
        (void)roburoc4_move_step(&other, &client, now());
        pass(cycle_us);
    }
    roburoc4_facts facts;
    roburoc4_client_facts(&client, now(), ROBUROC4_SIZED(&facts));
    EXPECT_EQ(0, facts.armed);
    EXPECT_EQ(ROBUROC4_ERR_LAPSED, facts.disarm_cause);
    expect_stopped();
}

TEST_F(Move, ToRestEndsAnother) {
    roburoc4_move rest;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&rest, nullptr));
    EXPECT_EQ(ROBUROC4_MOVE_CANCELLED,
              interrupted_by([&] { roburoc4_move_step(&rest, &client, now()); }));
    expect_stopped();
}

TEST_F(Moving, ToRestSendsZerosAsLongAsAnotherCommanderDrives) {
    connect();
    roburoc4_client other;
    config.options = ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER;
    roburoc4_client_init(&other, sizeof other, &config);
    roburoc4_world_join(world, &other);
    pass(second);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_arm(&other, now()));
    for (int i = 0; i < 100; i++) {
        (void)roburoc4_client_drive(&other, 0.5F, 0, 0, now());
        pass(cycle_us);
    }
    std::uint64_t late_zeros = 0;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&move, nullptr));
    EXPECT_EQ(ROBUROC4_MOVE_OTHER_COMMANDER, go([&] {
                  (void)roburoc4_client_drive(&other, 0.5F, 0, 0, now());
                  roburoc4_facts facts;
                  roburoc4_client_facts(&client, now(), ROBUROC4_SIZED(&facts));
                  late_zeros += now() - begun_us > 3 * second && facts.stopping != 0;
              }));
    EXPECT_GT(late_zeros, 100U);
}

TEST_F(Moving, AMoveNeverArms) {
    connect();
    pass(2 * second);
    EXPECT_EQ(ROBUROC4_MOVE_CANCELLED, straight(1.0F));
    EXPECT_EQ(ROBUROC4_ERR_DISARMED, move.cause);
    roburoc4_facts facts;
    roburoc4_client_facts(&client, now(), ROBUROC4_SIZED(&facts));
    EXPECT_EQ(0, facts.stopping) << "nor does its end stop what others drive";
    EXPECT_EQ(0U, state().nonzero_speed_commands);
}

TEST_F(Move, ATimeoutStopsTheRobot) {
    options.timeout_ms = 2000;
    EXPECT_EQ(ROBUROC4_MOVE_TIMEOUT, straight(10.0F));
    EXPECT_NEAR(2.0, took_s, 0.1);
    EXPECT_GT(move.remaining_m, 9);
    expect_stopped();
}

TEST_F(Move, AProgramThatNoLongerStepsStopsTheRobot) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 2.0F, 0, &options));
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, go(nullptr, 2.0));
    EXPECT_GT(state().target_linear_m_s, 0.2);
    pass(300000);
    EXPECT_EQ(0, state().target_linear_m_s);
}

TEST_F(Move, StepsAloneDriveNothing) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 2.0F, 0, &options));
    for (int i = 0; i < 50; i++) {
        roburoc4_move_step(&move, &client, now());
        pass(5 * cycle_us);
    }
    EXPECT_EQ(0U, state().nonzero_speed_commands);
}

TEST_F(Move, APauseOfTheProgramCostsNoAccuracy) {
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, interrupted_by([&] { pass(200000); }));
    EXPECT_NEAR(2.0, ahead(), 0.02);
    EXPECT_LT(most_acceleration * cycle_us, 0.6 * 600000 + cycle_us);
}

/* -------------------------------------------------------------------------- looking where it goes
 */

TEST_F(Move, AWallEndsItBeforeTheClearance) {
    roburoc4_sim_add_box(robot(), 3.0, 0.0, 0.1, 2.0, 0.0);
    for (const float speed : {0.3F, 1.0F}) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_sim_place(robot(), 0, 0, 0));
        pass(second);
        (void)roburoc4_client_arm(&client, now());
        options.max_linear_m_s = speed;
        EXPECT_EQ(ROBUROC4_MOVE_OBSTACLE, straight(4.0F));
        EXPECT_GT(move.remaining_m, 1.0);
        pass(3 * second);
        const double gap = 3.0 - 0.05 - 0.655 - state().true_x_m;
        EXPECT_GT(gap, 0.45) << speed;
        EXPECT_LT(gap, 1.0) << speed;
    }
}

TEST_F(Moving, AWallRightAheadOfARobotThatFollowsLateEndsItInTime) {
    robot_config.dead_time_cycles = 15;
    connect_and_arm();
    options.max_linear_m_s = 1;
    options.max_linear_m_s2 = 3;
    for (const double gap : {0.52, 0.7, 0.8, 0.9}) {
        const double wall_m = gap + 0.655 + 0.05;
        roburoc4_sim_clear_obstacles(robot());
        roburoc4_sim_add_box(robot(), wall_m, 0, 0.1, 2, 0);
        ASSERT_EQ(ROBUROC4_OK, roburoc4_sim_place(robot(), 0, 0, 0));
        pass(second);
        (void)roburoc4_client_arm(&client, now());
        EXPECT_EQ(ROBUROC4_MOVE_OBSTACLE, straight(2));
        pass(3 * second);
        EXPECT_GT(wall_m - 0.05 - 0.655 - state().true_x_m, 0.49) << gap;
    }
}

TEST_F(Move, AWallBehindEndsAMoveBackward) {
    roburoc4_sim_add_box(robot(), -3.0, 0.0, 0.1, 2.0, 0.0);
    EXPECT_EQ(ROBUROC4_MOVE_OBSTACLE, straight(-4.0F));
    pass(3 * second);
    EXPECT_GT(3.0 - 0.05 - 0.655 + state().true_x_m, 0.45);
}

TEST_F(Move, GoingAwayFromAWallIsPossible) {
    roburoc4_sim_add_box(robot(), 1.0, 0.0, 0.1, 2.0, 0.0);
    pass(second);
    EXPECT_EQ(ROBUROC4_MOVE_OBSTACLE, straight(0.5F));
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, straight(-0.5F));
    EXPECT_NEAR(-0.5, ahead(), 0.01);
}

TEST_F(Move, TurnsInPlaceAndNoClearanceIgnoreTelemeters) {
    roburoc4_sim_add_box(robot(), 1.0, 0.0, 0.1, 2.0, 0.0);
    pass(second);
    options.clearance_m = 0;
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, straight(0.1F));
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, straight(-0.2F));
    options.clearance_m = 0.5F;
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, turn(0.3));
}

TEST_F(Move, AMoveThatEndsBeforeTheClearanceIsReached) {
    roburoc4_sim_add_box(robot(), 2.3, 0.0, 0.1, 2.0, 0.0);
    pass(second);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_for(&move, 0.3F, 0, 3300, &options));
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, go());
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, straight(-0.8F));
    options.max_linear_m_s = 1.0F;
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, straight(1.0F));
}

TEST_F(Move, ABumperEndsIt) {
    EXPECT_EQ(ROBUROC4_MOVE_BUMPER,
              interrupted_by([&] { roburoc4_sim_set(robot(), ROBUROC4_SIM_FRONT_BUMPER, 1); }));
    expect_stopped();
}

TEST_F(Move, AnyBumperThatGetsPressedEndsIt) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 0, 3.0F, &options));
    EXPECT_EQ(ROBUROC4_MOVE_BUMPER, go([&] {
                  if (turned() > 0.5)
                      roburoc4_sim_set(robot(), ROBUROC4_SIM_REAR_BUMPER, 1);
              }));
}

TEST_F(Move, BackingAwayFromAPressedBumperIsPossible) {
    for (const bool front : {true, false}) {
        const float into_m = front ? 0.5F : -0.5F;
        roburoc4_sim_set(robot(), ROBUROC4_SIM_FRONT_BUMPER, front);
        roburoc4_sim_set(robot(), ROBUROC4_SIM_REAR_BUMPER, !front);
        pass(second);
        EXPECT_EQ(ROBUROC4_MOVE_BUMPER, straight(into_m));
        EXPECT_EQ(ROBUROC4_MOVE_REACHED, straight(-into_m));
        EXPECT_EQ(ROBUROC4_MOVE_REACHED, turn(0.3));
    }
}

/* ------------------------------------------------------------------------------------ arguments */

TEST_F(Move, BadArgumentsAreRefused) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinite = std::numeric_limits<float>::infinity();
    EXPECT_EQ(ROBUROC4_ERR_NOT_FINITE, roburoc4_move_by(&move, nan, 0, nullptr));
    EXPECT_EQ(ROBUROC4_MOVE_CANCELLED, roburoc4_move_step(&move, &client, now()));
    EXPECT_EQ(ROBUROC4_ERR_NOT_FINITE, roburoc4_move_by(&move, 0, infinite, nullptr));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, roburoc4_move_by(&move, 10001.0F, 0, nullptr));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, roburoc4_move_by(&move, 0, -10001.0F, nullptr));
    EXPECT_EQ(ROBUROC4_ERR_NOT_FINITE, roburoc4_move_to_point(&move, no_number, 0, nullptr));
    EXPECT_EQ(ROBUROC4_ERR_NOT_FINITE, roburoc4_move_to_point(&move, 0, no_number, nullptr));
    EXPECT_EQ(ROBUROC4_ERR_NOT_FINITE,
              roburoc4_move_to_pose(&move, 0, 0, std::numeric_limits<double>::infinity(), nullptr));
    roburoc4_move_options many = options;
    many.allow_turns = 1;
    EXPECT_EQ(ROBUROC4_ERR_NOT_FINITE, roburoc4_move_to_point(&move, no_number, 0, &many));
    EXPECT_EQ(ROBUROC4_MOVE_CANCELLED, move.outcome);
    for (float roburoc4_move_options::*field :
         {&roburoc4_move_options::max_linear_m_s, &roburoc4_move_options::max_angular_rad_s,
          &roburoc4_move_options::max_linear_m_s2, &roburoc4_move_options::max_angular_rad_s2}) {
        for (const float bad : {0.0F, -1.0F, nan, infinite}) {
            roburoc4_move_options changed = options;
            changed.*field = bad;
            EXPECT_LT(roburoc4_move_by(&move, 1.0F, 0, &changed), 0);
            EXPECT_EQ(ROBUROC4_MOVE_CANCELLED, move.outcome);
        }
    }
    for (const float bad : {-1.0F, nan, infinite}) {
        options.clearance_m = bad;
        EXPECT_LT(roburoc4_move_rest(&move, &options), 0);
    }
}

TEST_F(Move, OptionsOfAnotherSizeAreRefused) {
    EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_move_options_init(&options, 4));
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1.0F, 0, nullptr));
    options.size = 4;
    EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_move_by(&move, 1.0F, 0, &options));
    EXPECT_EQ(ROBUROC4_MOVE_CANCELLED, move.outcome);
}

TEST_F(Move, APointTooFarAwayIsRefused) {
    /* some are near where numbers overflow */
    for (const double far_m : {65536.0, 1e9, -std::exp2(48), std::exp2(53), -1e20, 1e300}) {
        for (const bool aside : {false, true}) {
            ASSERT_EQ(ROBUROC4_OK,
                      roburoc4_move_to_point(&move, aside ? 0 : far_m, aside ? far_m : 0, nullptr));
            EXPECT_EQ(ROBUROC4_MOVE_CANCELLED, go()) << far_m;
            EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, move.cause) << far_m;
        }
    }
}

/* ---------------------------------------------------------------- a program with its own view */

class MoveView : public testing::Test {
  protected:
    MoveView() {
        view.size = sizeof view;
        view.speed_cycles = view.pose_cycles = 1;
        view.armed = 1;
        view.front_m = view.rear_m = 100;
        view.front_known = view.rear_known = 1;
        view.front_bumper_known = view.rear_bumper_known = 1;
        roburoc4_move_options_init(&options, sizeof options);
    }
    /** A status of both services came, and the move is stepped. */
    std::int32_t step(std::uint64_t later_us = 50000) {
        now_us += later_us;
        view.speed_cycles += later_us / cycle_us;
        view.pose_cycles += later_us / cycle_us;
        return roburoc4_move_step_view(&move, &view, now_us);
    }
    /** A robot that follows at once, stepped each 10 ms until its next status. It covers so many
     * times what is commanded. */
    std::int32_t follow(std::uint64_t status_us = 50000, double way = 1, double turn = 1) {
        for (std::uint64_t us = cycle_us; us <= status_us; us += cycle_us) {
            view.sent_linear_m_s = move.linear_m_s;
            view.sent_angular_rad_s = move.angular_rad_s;
            const double turned = 0.01 * turn * double{move.angular_rad_s};
            const double covered = 0.01 * way * double{move.linear_m_s};
            x_m += covered * std::cos(theta_rad + turned / 2);
            y_m += covered * std::sin(theta_rad + turned / 2);
            theta_rad += turned;
            now_us += cycle_us;
            if (us == status_us) {
                side = -side;
                view.linear_m_s = static_cast<float>(way) * move.linear_m_s + side * shaking_m_s;
                view.angular_rad_s = static_cast<float>(turn) * move.angular_rad_s + turning_rad_s +
                                     side * shaking_rad_s;
                view.x_m = x_m + double{side * shaken};
                view.y_m = y_m;
                view.theta_rad = theta_rad + double{side * shaken};
                view.speed_cycles = view.pose_cycles += status_us / cycle_us;
            }
            roburoc4_move_step_view(&move, &view, now_us);
        }
        return move.outcome;
    }
    double x_m = 0, y_m = 0, theta_rad = 0;
    float turning_rad_s = 0; /* not commanded */
    /* something shakes it: what is added to one status, and taken from the next */
    float side = 1, shaking_m_s = 0, shaking_rad_s = 0, shaken = 0;
    roburoc4_move move{};
    roburoc4_move_view view{};
    roburoc4_move_options options{};
    std::uint64_t now_us = second;
};

TEST_F(MoveView, EachCauseOfADisarmedClientHasItsResult) {
    const std::pair<roburoc4_result, std::int32_t> rows[] = {
        {ROBUROC4_ERR_OVERRIDE, ROBUROC4_MOVE_OVERRIDE},
        {ROBUROC4_ERR_OVERRIDE_UNKNOWN, ROBUROC4_MOVE_OVERRIDE},
        {ROBUROC4_ERR_OTHER_COMMANDER, ROBUROC4_MOVE_OTHER_COMMANDER},
        {ROBUROC4_ERR_INHIBITED, ROBUROC4_MOVE_INHIBITED},
        {ROBUROC4_ERR_LAPSED, ROBUROC4_MOVE_LAPSED},
        {ROBUROC4_ERR_DISARMED, ROBUROC4_MOVE_CANCELLED},
        {ROBUROC4_ERR_STOP_CALLED, ROBUROC4_MOVE_CANCELLED},
        {ROBUROC4_ERR_LOST, ROBUROC4_MOVE_LOST}};
    for (const auto &[cause, result] : rows) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, nullptr));
        view.armed = 1;
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
        EXPECT_GT(move.linear_m_s, 0);
        view.armed = 0;
        view.disarm_cause = cause;
        EXPECT_EQ(result, step());
        EXPECT_EQ(cause, move.cause);
        EXPECT_EQ(0, move.linear_m_s);
        view.armed = 1;
        EXPECT_EQ(result, step()) << "it has ended";
    }
}

TEST_F(MoveView, ASecondOfSilenceEndsIt) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, nullptr));
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, roburoc4_move_step_view(&move, &view, now_us + second));
    EXPECT_EQ(ROBUROC4_MOVE_LOST, roburoc4_move_step_view(&move, &view, now_us + second + 1));
}

TEST_F(MoveView, AMoveToAPointWaitsASecondForThePose) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_point(&move, 1, 0, nullptr));
    view.pose_cycles = 0;
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, roburoc4_move_step_view(&move, &view, now_us));
    EXPECT_EQ(0, move.linear_m_s);
    EXPECT_EQ(0, move.remaining_m);
    EXPECT_EQ(ROBUROC4_MOVE_LOST, roburoc4_move_step_view(&move, &view, now_us + second + 1));
}

TEST_F(MoveView, AMoveToAPointDoesNotTurnBeforeItSeesAhead) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_point(&move, 0, 1, nullptr));
    view.front_known = 0;
    for (int i = 0; i < 10; i++) {
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
        EXPECT_EQ(0, move.angular_rad_s);
    }
    EXPECT_EQ(ROBUROC4_MOVE_NO_FRONT_TELEMETER, step(second));
}

TEST_F(MoveView, ItTurnsTheShortWayAndTheScaledWay) {
    view.theta_rad = 3;
    view.scale_linear = 0.5F;
    view.scale_angular = 2;
    theta_rad = 3;
    ASSERT_EQ(ROBUROC4_OK,
              roburoc4_move_to_point(&move, 5 * std::cos(-3), 5 * std::sin(-3), nullptr));
    step();
    EXPECT_NEAR(0.5 * (2 * pi - 6), move.remaining_rad, 1e-3);
    ASSERT_EQ(ROBUROC4_OK,
              roburoc4_move_to_point(&move, 3 * std::cos(3), 3 * std::sin(3), nullptr));
    while (move.remaining_m == 0 && step() == ROBUROC4_MOVE_RUNNING) {
    }
    EXPECT_NEAR(6, move.remaining_m, 1e-3);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_pose(&move, 0, 0, -3, nullptr));
    step();
    EXPECT_NEAR(0.5 * (2 * pi - 6), move.remaining_rad, 1e-3);
}

TEST_F(MoveView, WhatTheRobotReportsIsScaled) {
    view.scale_linear = 0.7F;
    view.scale_angular = 1.3F;
    view.max_linear_m_s = 0.21F; /* really 0.3 */
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 2, 0, nullptr));
    step();
    float fastest_m_s = 0;
    while (follow(50000, 0.7, 1.3) == ROBUROC4_MOVE_RUNNING)
        fastest_m_s = std::max(fastest_m_s, move.linear_m_s);
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, move.outcome);
    EXPECT_NEAR(0.7 * 2, x_m, 0.01);
    EXPECT_NEAR(0.3F, fastest_m_s, 0.005F);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 0, 1, nullptr));
    step();
    while (follow(50000, 0.7, 1.3) == ROBUROC4_MOVE_RUNNING) {
    }
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, move.outcome);
    EXPECT_NEAR(1.3, theta_rad, 0.02);
}

TEST_F(MoveView, AScaleThatIsNoneEndsIt) {
    for (const float scale : {-1.0F, 1e-30F, 0.0099F, 10.1F, 1e30F, NAN, INFINITY}) {
        for (float *const changed : {&view.scale_linear, &view.scale_angular}) {
            ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 2, 0, nullptr));
            EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
            *changed = scale;
            EXPECT_EQ(ROBUROC4_MOVE_CANCELLED, step()) << scale;
            EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, move.cause);
            EXPECT_EQ(0, move.linear_m_s);
            *changed = 0;
        }
    }
}

TEST_F(MoveView, WhatAPoseMeansMayChangeInMidMove) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 2, 0, nullptr));
    view.scale_linear = 2;
    step();
    float driven_m = 0;
    while (driven_m < 1) {
        if (driven_m > 0.5F)
            view.pose_external = 1;
        view.sent_linear_m_s = move.linear_m_s;
        view.linear_m_s = 2 * move.linear_m_s;
        driven_m += 0.05F * move.linear_m_s;
        view.x_m += double{0.05F * move.linear_m_s * (view.pose_external != 0 ? 1 : 2)};
        view.speed_cycles = view.pose_cycles += 5;
        now_us += 50000;
        ASSERT_EQ(ROBUROC4_MOVE_RUNNING, roburoc4_move_step_view(&move, &view, now_us));
        ASSERT_NEAR(driven_m, move.distance_m, 1e-3);
    }
}

TEST_F(MoveView, ALegIsAsGoodAsAMoveOfItsOwn) {
    std::vector<float> speeds[2]; /* of the last turn, as the last leg and alone */
    for (const bool alone : {false, true}) {
        theta_rad = view.theta_rad = 0;
        x_m = view.x_m = alone ? 1 : 0;
        ASSERT_EQ(ROBUROC4_OK, alone ? roburoc4_move_by(&move, 0, -1, nullptr)
                                     : roburoc4_move_to_pose(&move, 1, 0, -1, nullptr));
        step();
        while (follow(50000, 1.2, 1.2) == ROBUROC4_MOVE_RUNNING) {
            if (x_m > 0.9 && (!speeds[alone].empty() || std::fabs(move.angular_rad_s) > 0.01F))
                speeds[alone].push_back(move.angular_rad_s);
        }
        EXPECT_EQ(ROBUROC4_MOVE_REACHED, move.outcome);
    }
    ASSERT_NEAR(static_cast<double>(speeds[0].size()), static_cast<double>(speeds[1].size()), 1);
    for (std::size_t i = 0; i < std::min(speeds[0].size(), speeds[1].size()); i++)
        EXPECT_NEAR(speeds[0][i], speeds[1][i], 0.051) << i;
}

TEST_F(MoveView, AnArcEndsWithATurnWhereItsAngleIsMissed) {
    options.max_angular_rad_s = 1;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 0.2F, 1.5F, &options));
    step();
    while (follow(50000, 1, 0.9) == ROBUROC4_MOVE_RUNNING) {
    }
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, move.outcome);
    EXPECT_NEAR(1.5, theta_rad, 0.0175 + 0.01);
    EXPECT_NEAR(0.2F, move.distance_m, 0.01F) << "of all legs";
}

TEST_F(MoveView, ForATimeObeysTheRobotsOwnLimits) {
    for (const float linear_m_s : {1.0F, 0.2F}) {
        view.max_linear_m_s = linear_m_s;
        view.max_angular_rad_s = 1.2F - linear_m_s;
        roburoc4_move_for(&move, 0.5F, 0.5F, 3000, &options);
        for (int i = 0; i < 40; i++)
            follow();
        EXPECT_FLOAT_EQ(0.2F, move.angular_rad_s);
        EXPECT_FLOAT_EQ(0.2F, move.linear_m_s) << "the same curve";
    }
}

TEST_F(MoveView, ForATimeSpeedsUpAsAskedForOnEitherAxis) {
    for (const bool turns : {false, true}) {
        roburoc4_move_for(&move, turns ? 0 : 0.5F, turns ? 0.5F : 0, 3000, &options);
        step();
        for (int i = 0; i < 40; i++) {
            const float linear_m_s = move.linear_m_s, angular_rad_s = move.angular_rad_s;
            step(cycle_us);
            EXPECT_LE(move.linear_m_s - linear_m_s, options.max_linear_m_s2 * 0.01F + 1e-4F);
            EXPECT_LE(move.angular_rad_s - angular_rad_s,
                      options.max_angular_rad_s2 * 0.01F + 1e-4F);
        }
        EXPECT_GT(move.linear_m_s + move.angular_rad_s, 0.1F);
    }
}

/* What a leg needed to get right is no business of the next. */
TEST_F(MoveView, EachLegMayTurnBack) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_pose(&move, 1, 0, 1, &options));
    step();
    follow();
    move.private_turned = 2;
    while (x_m < 0.95 || std::fabs(move.angular_rad_s) < 0.01F)
        ASSERT_EQ(ROBUROC4_MOVE_RUNNING, follow());
    EXPECT_EQ(0, move.private_turned);
}

TEST_F(MoveView, AnOverrideEndsIt) {
    roburoc4_move_by(&move, 1, 0, &options);
    step();
    view.overridden = 1;
    EXPECT_EQ(ROBUROC4_MOVE_OVERRIDE, step());
}

TEST_F(MoveView, OneStatusOfStandingWheelsMayBeNoise) {
    double took_s[2];
    options.max_angular_rad_s = 0.3F;
    for (const bool noisy : {false, true}) {
        const std::uint64_t begun_us = now_us;
        roburoc4_move_by(&move, 0, 1.57F, &options);
        for (int i = 0; follow(50000, 1, 0.87) == ROBUROC4_MOVE_RUNNING; i++)
            turning_rad_s = noisy && i == 105 ? -0.87F * move.angular_rad_s : 0;
        EXPECT_EQ(ROBUROC4_MOVE_REACHED, move.outcome);
        took_s[noisy] = 1e-6 * static_cast<double>(now_us - begun_us);
    }
    EXPECT_NEAR(took_s[0], took_s[1], 0.2);
}

TEST_F(MoveView, AnInhibitedRobotEndsIt) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, nullptr));
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    view.inhibited = 1;
    EXPECT_EQ(ROBUROC4_MOVE_INHIBITED, step());
}

TEST_F(MoveView, ALineIsNotReachedWhileTheRobotTurns) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 0.3F, 0, nullptr));
    step();
    for (int i = 0; i<20; i += x_m> 0.25) {
        turning_rad_s = x_m > 0.25 ? 0.2F : 0;
        ASSERT_EQ(ROBUROC4_MOVE_RUNNING, follow());
    }
    turning_rad_s = 0;
    for (int i = 0; i < 20 && follow() == ROBUROC4_MOVE_RUNNING; i++) {
    }
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, move.outcome);
}

TEST_F(MoveView, IsReachedByARobotThatIsSlowOnEitherAxis) {
    const std::tuple<float, float, float, std::int32_t> rows[] = {
        {0, 0.02F, 0.09F, ROBUROC4_MOVE_REACHED},
        {0, 0, 0.11F, ROBUROC4_MOVE_TIMEOUT},
        {1, 0.05F, 0.04F, ROBUROC4_MOVE_REACHED},
        {1, 0.07F, 0, ROBUROC4_MOVE_TIMEOUT},
        {1, 0, 0.06F, ROBUROC4_MOVE_TIMEOUT}};
    shaken = 0.0015F; /* or it would be stuck */
    for (const auto &[turn, linear_m_s, angular_rad_s, outcome] : rows) {
        shaking_m_s = linear_m_s;
        shaking_rad_s = angular_rad_s;
        x_m = theta_rad = view.x_m = view.theta_rad = 0;
        view.linear_m_s = view.angular_rad_s = 0;
        view.sent_linear_m_s = view.sent_angular_rad_s = 0;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 0.5F * (1 - turn), turn, nullptr));
        step();
        while (follow() == ROBUROC4_MOVE_RUNNING) {
        }
        EXPECT_EQ(outcome, move.outcome) << turn << " " << linear_m_s << " " << angular_rad_s;
    }
}

/** Its speeds are too noisy to show rest. */
TEST_F(MoveView, GivesUpAfterTwiceItsProfileAndThreeSeconds) {
    const auto ramps = [](double way, double speed, double slope) {
        return way / speed + speed / slope;
    };
    const double to_corner = ramps(std::sqrt(2), 0.3, 0.5) + ramps(pi / 4, 0.5, 1);
    const std::pair<double, std::function<roburoc4_result()>> rows[] = {
        {ramps(1, 0.3, 0.5), [&] { return roburoc4_move_by(&move, -1, 0, &options); }},
        {2 * std::sqrt(0.1 / 0.5), [&] { return roburoc4_move_by(&move, 0.1F, 0, &options); }},
        {ramps(1, 0.5, 1), [&] { return roburoc4_move_by(&move, 0, -1, &options); }},
        {ramps(0.5, 0.5 / 6, 1.0 / 6), [&] { return roburoc4_move_by(&move, 0.5F, 3, &options); }},
        {ramps(0.5, 0.5 / 6, 1.0 / 6), [&] { return roburoc4_move_by(&move, -0.5F, 3, &options); }},
        {ramps(2, 0.3, 0.5), [&] { return roburoc4_move_by(&move, 2, 0.1F, &options); }},
        {to_corner, [&] { return roburoc4_move_to_point(&move, 1, -1, &options); }},
        {to_corner + pi / 4 / 0.5, [&] { return roburoc4_move_to_pose(&move, 1, 1, 0, &options); }},
        {to_corner + pi / 2 / 0.5,
         [&] { return roburoc4_move_to_pose(&move, 1, 1, -pi / 4, &options); }},
        {to_corner, [&] { return roburoc4_move_to_pose(&move, 1, 1, pi / 4, &options); }},
        {2, [&] { return roburoc4_move_for(&move, 0.3F, 0, 2000, &options); }},
        {1, [&] { return roburoc4_move_rest(&move, &options); }}};
    shaking_m_s = 0.04F;
    shaking_rad_s = 0.07F;
    shaken = 0.0015F;
    for (const auto &[profile_s, begin] : rows) {
        x_m = y_m = theta_rad = view.x_m = view.y_m = view.theta_rad = 0;
        view.linear_m_s = view.angular_rad_s = 0;
        view.sent_linear_m_s = view.sent_angular_rad_s = 0;
        ASSERT_EQ(ROBUROC4_OK, begin());
        step();
        const std::uint64_t begun_us = now_us;
        while (follow() == ROBUROC4_MOVE_RUNNING) {
        }
        EXPECT_EQ(ROBUROC4_MOVE_TIMEOUT, move.outcome) << profile_s;
        EXPECT_NEAR(2 * profile_s + 3, 1e-6 * static_cast<double>(now_us - begun_us), 0.08);
    }
}

TEST_F(MoveView, ARobotThatRollsOnAndOnIsGivenUp) {
    view.pose_cycles = 0;
    view.linear_m_s = 0.2F;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 0.3F, 0, &options));
    const std::uint64_t begun_us = now_us;
    while (move.outcome == ROBUROC4_MOVE_RUNNING) {
        ASSERT_LT(now_us, begun_us + 7 * second);
        now_us += 50000;
        view.speed_cycles += 5;
        roburoc4_move_step_view(&move, &view, now_us);
    }
    EXPECT_EQ(ROBUROC4_MOVE_TIMEOUT, move.outcome);
}

TEST_F(MoveView, WhatIsLeftIsExactFromAnyPose) {
    Drawn drawn;
    for (int i = 0; i < 300; i++) {
        const double way = 0.5 + std::fabs(drawn.within(100)), bearing = drawn.within(pi);
        view.x_m = drawn.within(i % 2 == 0 ? 1e6 : 10);
        view.y_m = drawn.within(i % 2 == 0 ? 1e6 : 10);
        view.theta_rad = i % 3 == 0 ? drawn.within(50) : bearing; /* it may look there */
        const double x = view.x_m + way * std::cos(bearing), y = view.y_m + way * std::sin(bearing);
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_point(&move, x, y, nullptr));
        for (int k = 0; k < 60 && move.remaining_m == 0; k++) {
            ASSERT_EQ(ROBUROC4_MOVE_RUNNING, step());
            ASSERT_NEAR(wrapped(bearing - view.theta_rad), move.remaining_rad,
                        i % 3 == 0 ? 5e-4 : 1e-2);
            if (i % 3 == 0)
                break;
        }
        if (i % 3 != 0) {
            ASSERT_NEAR(way, move.remaining_m, 1e-4 * (1 + way));
        }
        ASSERT_EQ(ROBUROC4_OK,
                  roburoc4_move_to_pose(&move, view.x_m, view.y_m, drawn.within(12), nullptr));
        const double theta = double{move.private_goal[1]};
        (void)step();
        ASSERT_NEAR(0, wrapped(theta - view.theta_rad - double{move.remaining_rad}), 5e-4);
    }
}

TEST_F(MoveView, WayAndAngleAreExactInAnyDirection) {
    Drawn drawn;
    for (int i = 0; i < 300; i++) {
        const double heading = drawn.within(9), pace = drawn.within(0.015),
                     across = drawn.within(0.005), turns = drawn.within(0.02);
        const bool arc = i % 2 == 0;
        view.x_m = drawn.within(100);
        view.y_m = drawn.within(100);
        view.theta_rad = heading;
        view.linear_m_s = view.angular_rad_s = 0;
        ASSERT_EQ(
            ROBUROC4_OK,
            roburoc4_move_by(&move, std::copysign(3.0F, static_cast<float>(pace)), 0, nullptr));
        ASSERT_EQ(ROBUROC4_MOVE_RUNNING, step());
        for (int k = 0; k < 8; k++) {
            const double middle = view.theta_rad + (arc ? turns / 2 : 0);
            view.x_m += pace * std::cos(middle) - across * std::sin(middle);
            view.y_m += pace * std::sin(middle) + across * std::cos(middle);
            view.theta_rad += arc ? turns : 0;
            ASSERT_EQ(ROBUROC4_MOVE_RUNNING, step());
        }
        ASSERT_NEAR(8 * pace, move.distance_m, 1e-4);
        ASSERT_NEAR(arc ? 8 * turns : 0, move.angle_rad, 1e-4);
    }
}

TEST_F(MoveView, FarBesideItsLineOrTurnedFromItItIsOffCourse) {
    for (const int way : {0, 1}) {
        for (const float side : {1.0F, -1.0F}) {
            view.x_m = view.y_m = view.theta_rad = 0;
            view.angular_rad_s = view.sent_angular_rad_s = 0;
            ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 3, 0, nullptr));
            ASSERT_EQ(ROBUROC4_MOVE_RUNNING, step());
            double most = 0;
            while (step() == ROBUROC4_MOVE_RUNNING && most < 2) {
                most += 0.05;
                (way == 0 ? view.y_m : view.theta_rad) += double{side} * 0.05;
                view.angular_rad_s = view.sent_angular_rad_s = way == 0 ? 0 : side;
            }
            EXPECT_EQ(ROBUROC4_MOVE_OFF_COURSE, move.outcome) << way;
            EXPECT_NEAR(way == 0 ? 0.5 : 1, most, 0.11) << way;
        }
    }
}

/** What is nearer than the clearance is too near before it moves, too. */
TEST_F(MoveView, BeginsNotTowardsWhatIsNearerThanItsClearance) {
    for (const bool ahead : {true, false}) {
        view.front_m = ahead ? 0.49F : 9;
        view.rear_m = ahead ? 9 : 0.49F;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, ahead ? 0.3F : -0.3F, 0, nullptr));
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
        EXPECT_EQ(ROBUROC4_MOVE_OBSTACLE, step()) << "before it can have moved";
        (ahead ? view.front_m : view.rear_m) = 0.56F;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, ahead ? 0.03F : -0.03F, 0, nullptr));
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
        EXPECT_NE(0, move.linear_m_s);
    }
}

TEST_F(MoveView, ASteepStartIsNoFall) {
    options.max_linear_m_s = options.max_linear_m_s2 = 3;
    options.max_angular_rad_s = options.max_angular_rad_s2 = 3;
    for (const float turn : {0.0F, 1.0F}) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 6 * (1 - turn), 6 * turn, &options));
        step();
        const std::uint64_t begun_us = now_us;
        while (follow(150000) == ROBUROC4_MOVE_RUNNING) {
        }
        EXPECT_EQ(ROBUROC4_MOVE_REACHED, move.outcome);
        EXPECT_LT(1e-6 * static_cast<double>(now_us - begun_us), 2 * 3) << turn;
    }
}

TEST_F(MoveView, BumpersThatAreNotKnownMustBeRenounced) {
    for (const bool front : {true, false}) {
        view.front_bumper_known = !front;
        view.rear_bumper_known = front;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, &options));
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
        EXPECT_EQ(0, move.linear_m_s);
        EXPECT_EQ(front ? ROBUROC4_MOVE_NO_FRONT_BUMPER : ROBUROC4_MOVE_NO_REAR_BUMPER,
                  step(second + cycle_us));
    }
    options.clearance_m = 0;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, &options));
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    EXPECT_GT(move.linear_m_s, 0);
}

TEST_F(MoveView, ABumperThatGetsPressedAgainEndsIt) {
    view.rear_bumper = 1;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, &options));
    for (int i = 0; i < 10; i++)
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, follow()) << "it backs away";
    view.rear_bumper = 0;
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, follow());
    view.rear_bumper = 1;
    EXPECT_EQ(ROBUROC4_MOVE_BUMPER, follow());
}

TEST_F(MoveView, ADistanceOlderThanASecondIsNotKnown) {
    view.distance_age_us = 2 * second;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, &options));
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    EXPECT_EQ(ROBUROC4_MOVE_NO_FRONT_TELEMETER, step(second + cycle_us));
}

TEST_F(MoveView, ARobotThatBrakesGentlyKeepsMoreDistance) {
    options.max_linear_m_s = 1;
    view.max_linear_m_s2 = 0.8F;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 9, 0, &options));
    do
        view.front_m = static_cast<float>(6 - x_m);
    while (follow() == ROBUROC4_MOVE_RUNNING);
    EXPECT_EQ(ROBUROC4_MOVE_OBSTACLE, move.outcome);
    EXPECT_GT(6 - x_m, 0.5 + 1 / (2 * 0.8));
}

TEST_F(MoveView, RestEndsWhenThePadDrives) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&move, nullptr));
    view.linear_m_s = 0.5F;
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    view.overridden = 1;
    EXPECT_EQ(ROBUROC4_MOVE_OVERRIDE, step());
}

TEST_F(MoveView, ALongWayHasTime) {
    options.max_linear_m_s = 0.001F;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 10000, 0, &options));
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step(5000000 * second)) << "two months later";
    options.timeout_ms = 4294968; /* more microseconds than 32 bits hold */
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 10000, 0, &options));
    for (int i = 0; i < 5; i++)
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_for(&move, 0.3F, 0, 4294968, nullptr));
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step(300000)) << "held up before its time began";
    for (int i = 0; i < 5; i++)
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    EXPECT_NEAR(5 * 0.05F * 0.5F, move.linear_m_s, 0.001);
}

TEST_F(MoveView, ASpeedThatIsNoNumberIsNeitherAWayNorRest) {
    view.linear_m_s = view.angular_rad_s = std::numeric_limits<float>::quiet_NaN();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, nullptr));
    for (int i = 0; i < 20; i++)
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    EXPECT_NEAR(0, move.distance_m, 1e-6);
    EXPECT_EQ(0, move.linear_m_s);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&move, nullptr));
    for (int i = 0; i < 20; i++)
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
}

TEST_F(MoveView, IsNotReachedWhileItsSpeedIsNoNumber) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 0.5F, 0, nullptr));
    while (move.remaining_m > 0.03F || now_us < 2 * second)
        ASSERT_EQ(ROBUROC4_MOVE_RUNNING, follow());
    turning_rad_s = std::numeric_limits<float>::quiet_NaN();
    for (int i = 0; i < 20; i++)
        ASSERT_EQ(ROBUROC4_MOVE_RUNNING, follow());
    turning_rad_s = 0;
    while (follow() == ROBUROC4_MOVE_RUNNING) {
    }
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, move.outcome);
}

TEST_F(MoveView, AccelerationsThatTheRobotDoesNotReportLimitNothing) {
    for (const float turn : {0.0F, 1.0F}) {
        const auto speed_with = [&](float most) {
            view.max_linear_m_s2 = view.max_angular_rad_s2 = most;
            EXPECT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1 - turn, turn, nullptr));
            EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
            EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
            return move.linear_m_s + move.angular_rad_s;
        };
        const float unlimited = speed_with(100);
        EXPECT_LT(speed_with(0.1F), unlimited);
        for (const float most : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN()})
            EXPECT_EQ(unlimited, speed_with(most)) << most;
    }
}

TEST_F(MoveView, APoseWhereTheRobotStandsIsATurn) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_pose(&move, 0, 0, 1, nullptr));
    bool turned = false;
    for (int i = 0; i < 10; i++) {
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
        EXPECT_EQ(0, move.linear_m_s);
        turned = turned || move.angular_rad_s > 0;
    }
    EXPECT_TRUE(turned);
}

TEST_F(MoveView, ADistanceThatIsNoNumberIsAnObstacle) {
    for (const bool ahead : {true, false}) {
        view.front_m = view.rear_m = 100;
        view.front_known = view.rear_known = 1;
        view.front_bumper_known = view.rear_bumper_known = 1;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, ahead ? 1 : -1, 0, nullptr));
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
        (ahead ? view.rear_m : view.front_m) = static_cast<float>(no_number);
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step()) << "not where it goes";
        (ahead ? view.front_m : view.rear_m) = static_cast<float>(no_number);
        EXPECT_EQ(ROBUROC4_MOVE_OBSTACLE, step());
    }
}

TEST_F(MoveView, HoweverFarItStraysItTurnsBackWithinTheLimit) {
    options.max_angular_rad_s = 0.06F;
    for (const float side : {1.0F, -1.0F}) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 10, 0, &options));
        view.pose_cycles = 0;
        float most = 0;
        for (int i = 0; i < 200 && move.outcome == ROBUROC4_MOVE_RUNNING; i++) {
            view.linear_m_s = view.sent_linear_m_s = move.linear_m_s;
            view.angular_rad_s = side * 0.1F;
            now_us += 5 * cycle_us;
            view.speed_cycles += 5;
            roburoc4_move_step_view(&move, &view, now_us);
            most = std::max(most, -side * move.angular_rad_s);
        }
        EXPECT_EQ(ROBUROC4_MOVE_ODOMETRY, move.outcome) << "it does not turn as commanded";
        EXPECT_GT(most, 0.05F);
        EXPECT_LE(most, options.max_angular_rad_s);
    }
}

TEST_F(MoveView, ItReturnsToItsLineForwardAndBackward) {
    for (const auto &[way_m, side] :
         {std::pair(2.0F, 1.0F), {2.0F, -1.0F}, {-2.0F, 1.0F}, {-2.0F, -1.0F}}) {
        view.y_m = 0;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, way_m, 0, nullptr));
        for (int i = 0; i < 3; i++)
            step();
        view.y_m = 0.1 * double{side}; /* to the left or right, heading along the line */
        step();
        step();
        ASSERT_EQ(ROBUROC4_MOVE_RUNNING, move.outcome);
        EXPECT_LT(way_m * side * move.angular_rad_s, -0.01F) << way_m;
        for (int i = 0; i < 3; i++) {
            view.y_m += 0.1 * double{side};
            step();
        }
        ASSERT_EQ(ROBUROC4_MOVE_RUNNING, move.outcome);
        EXPECT_NEAR(-way_m * side * move.angular_rad_s, 2 * 0.4F * 0.2F, 0.01F)
            << "not at right angles";
    }
}

TEST_F(MoveView, ATightArcSpeedsUpNoFasterThanItsTurnMay) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 0.5F, 3, &options));
    step();
    for (int i = 1; i <= 3; i++) {
        ASSERT_EQ(ROBUROC4_MOVE_RUNNING, step());
        EXPECT_GT(move.linear_m_s, 0);
        EXPECT_LE(move.linear_m_s,
                  static_cast<float>(i) * 0.05F * options.max_angular_rad_s2 * 0.5F / 3 + 1e-6F);
    }
}

TEST_F(MoveView, OneStatusAtRestIsNotRest) {
    view.linear_m_s = 0.5F;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&move, nullptr));
    for (int i = 0; i < 10; i++)
        ASSERT_EQ(ROBUROC4_MOVE_RUNNING, step());
    view.linear_m_s = 0;
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, step());
}

TEST_F(MoveView, AfterAProgramWasHeldUpTheSpeedGoesOnFromWhereItWas) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 2, 0, nullptr));
    for (int i = 0; i < 3; i++)
        ASSERT_EQ(ROBUROC4_MOVE_RUNNING, step());
    const float before = move.linear_m_s;
    ASSERT_GT(before, 0);
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step(260000));
    EXPECT_EQ(before, move.linear_m_s) << "nobody knows what was commanded meanwhile";
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    EXPECT_GT(move.linear_m_s, before);
}

TEST_F(MoveView, ARobotMayFollowTwoSecondsLateAndNotFour) {
    view.pose_cycles = 0;
    for (const int rolled : {0, 20}) { /* steps, before that */
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 3, 0, nullptr));
        view.linear_m_s = rolled != 0 ? 0.5F : 0;
        std::uint64_t moved_us = 0;
        for (int i = 0; move.outcome == ROBUROC4_MOVE_RUNNING && moved_us < 5 * second; i++) {
            now_us += 50000;
            view.speed_cycles += 5;
            view.linear_m_s = i < rolled ? view.linear_m_s : 0;
            view.sent_linear_m_s = i == 0 ? 0 : i < rolled ? 2 : move.linear_m_s;
            roburoc4_move_step_view(&move, &view, now_us);
            moved_us += i >= rolled && move.linear_m_s > 0 ? 50000 : 0;
        }
        EXPECT_EQ(ROBUROC4_MOVE_INHIBITED, move.outcome);
        EXPECT_GT(moved_us, 2350000U) << rolled;
        EXPECT_LT(moved_us, 4 * second) << rolled;
    }
}

TEST_F(MoveView, ASecondWithoutSpeedsEndsAMoveThatHasNoPose) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, nullptr));
    view.pose_cycles = 0;
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, roburoc4_move_step_view(&move, &view, now_us));
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, roburoc4_move_step_view(&move, &view, now_us + second));
    EXPECT_EQ(ROBUROC4_MOVE_LOST, roburoc4_move_step_view(&move, &view, now_us + second + 1));
}

TEST_F(MoveView, WhatARollingRobotRollsTowardsIsInItsWay) {
    for (const bool bumper : {false, true}) {
        view.front_m = 100;
        view.front_bumper = 0;
        view.linear_m_s = 0.5F;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, -1, 0, nullptr));
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
        (bumper ? view.rear_m : view.front_m) = 0.2F;
        view.front_bumper = bumper;
        EXPECT_EQ(bumper ? ROBUROC4_MOVE_BUMPER : ROBUROC4_MOVE_OBSTACLE, step());
        view.rear_m = 100;
    }
}

TEST_F(MoveView, BeginsWithTheSpeedThatIsCommandedAndSlowsDown) {
    view.linear_m_s = view.sent_linear_m_s = 0.3F;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, &options));
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    EXPECT_EQ(0.3F, move.linear_m_s);
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    EXPECT_NEAR(0.3F - 0.05F * options.max_linear_m_s2, move.linear_m_s, 1e-6);
    view.linear_m_s = -0.3F; /* it has not followed yet */
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, &options));
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    EXPECT_EQ(0, move.linear_m_s);
}

TEST_F(MoveView, WaitsUntilARobotThatRollsStands) {
    for (const bool turns : {false, true}) {
        (turns ? view.angular_rad_s : view.linear_m_s) = 0.5F;
        view.y_m = 0;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, nullptr));
        for (int i = 0; i < 6; i++) {
            ASSERT_EQ(ROBUROC4_MOVE_RUNNING, step()) << turns;
            ASSERT_EQ(0, move.linear_m_s);
            ASSERT_EQ(0, move.angular_rad_s);
            view.y_m = 0.1;
        }
        view.linear_m_s = view.angular_rad_s = 0;
        for (int i = 0; i < 4; i++)
            ASSERT_EQ(ROBUROC4_MOVE_RUNNING, step());
        EXPECT_GT(move.linear_m_s, 0) << turns;
        EXPECT_EQ(0, move.angular_rad_s) << "its line begins where it stands";
    }
}

TEST_F(MoveView, APoseThatJumpsAnyWayEndsIt) {
    for (const int way : {0, 1, 2}) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 2, 0, nullptr));
        view.x_m = view.y_m = view.theta_rad = 0;
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
        (way == 0 ? view.x_m : way == 1 ? view.y_m : view.theta_rad) = 0.5;
        EXPECT_EQ(ROBUROC4_MOVE_RELOCALIZED, step()) << way;
    }
    view.x_m = view.y_m = view.theta_rad = 0;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 2, 0, nullptr));
    step();
    step();
    view.x_m = 0.2; /* the robot's speed explains it */
    view.linear_m_s = view.sent_linear_m_s = 0.8F;
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step(240000));
}

TEST_F(MoveView, ARobotThatNeverRestsEndsTheWaitForItAfterFiveSecondsOrAsAskedFor) {
    view.linear_m_s = 0.5F;
    for (const std::uint32_t timeout_ms : {0U, 1000U, 8000U}) {
        options.timeout_ms = timeout_ms;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&move, &options));
        const std::uint64_t begun_us = now_us;
        while (step() == ROBUROC4_MOVE_RUNNING && now_us < begun_us + 60 * second) {
        }
        EXPECT_EQ(ROBUROC4_MOVE_TIMEOUT, move.outcome);
        EXPECT_NEAR(timeout_ms == 0 ? 5e6 : 1e3 * timeout_ms,
                    static_cast<double>(now_us - begun_us), 1e5);
    }
}

TEST_F(MoveView, WayIsTheMeanOfTwoSpeedsAndThePoseIsScaled) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 2, 0, nullptr));
    view.pose_cycles = 0;
    roburoc4_move_step_view(&move, &view, now_us);
    view.linear_m_s = 0.4F;
    view.speed_cycles += 10;
    roburoc4_move_step_view(&move, &view, now_us += 100000);
    EXPECT_NEAR(0.02F, move.distance_m, 1e-5);
    for (const auto &[cycles, covered_m] : {std::pair{1000, 4.0}, {1001, 0.0}, {-1005, 0.0}}) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 2, 0, nullptr));
        roburoc4_move_step_view(&move, &view, now_us);
        view.speed_cycles += static_cast<std::uint64_t>(cycles); /* beyond, it has restarted */
        roburoc4_move_step_view(&move, &view, now_us += 100000);
        EXPECT_NEAR(covered_m, move.distance_m, 1e-5) << cycles;
    }
    view.linear_m_s = 0;
    view.pose_cycles = 1;
    view.scale_linear = 1 / 1.5F;
    view.scale_angular = 2;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 2, 0, nullptr));
    step();
    view.x_m = 0.01;
    view.theta_rad = 0.01;
    step();
    EXPECT_NEAR(0.015F, move.distance_m, 1e-4);
    EXPECT_NEAR(0.005F, move.angle_rad, 1e-4);
}

TEST_F(MoveView, AnArcIsExactHoweverSeldomItsStatusesCome) {
    for (const std::uint64_t status_us : {50000U, 100000U, 200000U}) {
        for (const double side : {1.0, -1.0}) {
            x_m = y_m = theta_rad = view.x_m = view.y_m = view.theta_rad = 0;
            options.max_linear_m_s = options.max_angular_rad_s = 1;
            ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, static_cast<float>(pi / 2),
                                                    static_cast<float>(side * pi / 2), &options));
            step();
            while (follow(status_us) == ROBUROC4_MOVE_RUNNING) {
            }
            EXPECT_EQ(ROBUROC4_MOVE_REACHED, move.outcome) << status_us;
            EXPECT_NEAR(1, x_m, 0.003) << status_us;
            EXPECT_NEAR(side, y_m, 0.012) << status_us;
            EXPECT_NEAR(side * pi / 2, theta_rad, 0.006) << status_us;
        }
    }
}

TEST_F(MoveView, ATightArcIsNoFasterThanItsTurnMayBe) {
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 2, 12, &options));
    view.pose_cycles = 0;
    float most = 0;
    for (int i = 0; i < 60 && move.outcome == ROBUROC4_MOVE_RUNNING; i++) {
        now_us += 50000;
        view.speed_cycles += 5;
        view.linear_m_s = view.sent_linear_m_s = move.linear_m_s;
        view.angular_rad_s = view.sent_angular_rad_s = move.angular_rad_s;
        roburoc4_move_step_view(&move, &view, now_us);
        most = std::max(most, move.linear_m_s);
    }
    EXPECT_NEAR(options.max_angular_rad_s * 2 / 12, most, 0.005);
}

/* ------------------------------------------------------------------------- what a client knows */

TEST(MoveOfAClient, TurnsByTheAngleAlsoWhereOnlyTurnsAreScaled) {
    roburoc4_config config = roburoc4_tests::default_config();
    config.scale_angular = 2; /* it counts two radians where it turns one */
    roburoc4_tests::ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_LOCALIZATION).mute = true;
    roburoc4_tests::Armed bench(robot, config);
    roburoc4_move move;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 0, 1, nullptr));
    while (roburoc4_move_step(&move, &bench.client, bench.now_us) == ROBUROC4_MOVE_RUNNING) {
        ASSERT_EQ(ROBUROC4_OK, bench.drive(move.linear_m_s, move.angular_rad_s));
        bench.run(2 * cycle_us);
    }
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, move.outcome);
    EXPECT_NEAR(1, move.angle_rad, 0.02);
}

TEST(MoveOfAClient, RestIsLostIfNothingIsHeardForASecond) {
    roburoc4_tests::RobotBench bench;
    roburoc4_move move;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&move, nullptr));
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, roburoc4_move_step(&move, &bench.client, second));
    EXPECT_EQ(ROBUROC4_MOVE_RUNNING, roburoc4_move_step(&move, &bench.client, 2 * second));
    EXPECT_EQ(ROBUROC4_MOVE_LOST, roburoc4_move_step(&move, &bench.client, 2 * second + 1));
}

TEST(MoveOfAClient, StatusesOfBeforeAHangDoNotShowRest) {
    for (const bool one_by_one : {true, false}) {
        roburoc4_tests::Armed bench;
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
        roburoc4_move move;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&move, nullptr));
        const auto step = [&] { return roburoc4_move_step(&move, &bench.client, bench.now_us); };
        for (int i = 0; i < 35; i++) {
            ASSERT_EQ(ROBUROC4_MOVE_RUNNING, step());
            bench.run(cycle_us);
        }
        std::vector<roburoc4_tests::Bytes> waiting;
        for (int i = 0; i < 60; i++) { /* nobody polls, either */
            bench.now_us += cycle_us;
            bench.robot.advance(bench.now_us);
            for (const auto &bytes : bench.robot.take())
                waiting.push_back(bytes);
        }
        bench.now_us += 350000;
        for (const auto &bytes : waiting) {
            bench.receive(bytes);
            if (one_by_one) {
                ASSERT_EQ(ROBUROC4_MOVE_RUNNING, step());
            }
        }
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, step());
    }
}

TEST(MoveOfAClient, UsesNoPoseThatIsInvalidOrNoNumber) {
    const std::pair<bool, roburoc4_localization_status> rows[] = {
        {true, {}},
        {false, {0, no_number, 0, 0, 0, 0, 0}},
        {false, {0, 0, no_number, 0, 0, 0, 0}},
        {false, {0, 0, 0, no_number, 0, 0, 0}},
        {false, {0, 0, 0, 0, ROBUROC4_LOCALIZATION_INVALID, 0, 0}},
        {false, {0, 0, 0, 0, ROBUROC4_LOCALIZATION_ERROR, 0, 0}}};
    for (auto [good, pose] : rows) {
        roburoc4_tests::ScriptedRobot robot;
        robot.service(ROBUROC4_SERVICE_LOCALIZATION).mute = true;
        roburoc4_tests::Armed bench(robot);
        pose.robot_cycles = robot.cycles();
        pose.service = ROBUROC4_SERVICE_LOCALIZATION;
        robot.say(roburoc4_tests::encoded([&status = pose](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_localization_status(b, n, &status);
        }));
        bench.pump();
        roburoc4_move move;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_point(&move, 0, 1, nullptr));
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, roburoc4_move_step(&move, &bench.client, bench.now_us));
        EXPECT_EQ(good, move.remaining_rad != 0);
        bench.run(second + 1);
        EXPECT_EQ(ROBUROC4_MOVE_LOST, roburoc4_move_step(&move, &bench.client, bench.now_us))
            << "it never came, or no more";
    }
}

TEST(MoveOfAClient, APoseThatIsSeenIsNotScaled) {
    for (const bool seen : {false, true}) {
        roburoc4_tests::ScriptedRobot robot;
        robot.service(ROBUROC4_SERVICE_LOCALIZATION).mute = true;
        roburoc4_config config = roburoc4_tests::default_config();
        config.scale_angular = 2;
        roburoc4_tests::Armed bench(robot, config);
        roburoc4_localization_status pose{};
        pose.flags = seen ? ROBUROC4_LOCALIZATION_EXTEROCEPTIVE : 0;
        pose.robot_cycles = robot.cycles();
        pose.service = ROBUROC4_SERVICE_LOCALIZATION;
        robot.say(roburoc4_tests::encoded([&pose](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_localization_status(b, n, &pose);
        }));
        bench.pump();
        roburoc4_move move;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_point(&move, 0, 1, nullptr));
        EXPECT_EQ(ROBUROC4_MOVE_RUNNING, roburoc4_move_step(&move, &bench.client, bench.now_us));
        EXPECT_NEAR(seen ? pi / 2 : pi / 4, move.remaining_rad, 1e-3);
    }
}

static void expect_obstacles_ahead_only(float distance_m) {
    const std::tuple<float, float, std::int32_t> rows[] = {
        {1.0F, 1.57F, ROBUROC4_MOVE_RUNNING},  {-1.0F, -1.57F, ROBUROC4_MOVE_RUNNING},
        {1.0F, 3.14F, ROBUROC4_MOVE_RUNNING},  {-1.0F, 0, ROBUROC4_MOVE_RUNNING},
        {1.0F, 0, ROBUROC4_MOVE_OBSTACLE},     {-1.0F, 3.14F, ROBUROC4_MOVE_OBSTACLE},
        {1.0F, 1.0F, ROBUROC4_MOVE_OBSTACLE},  {-1.0F, -2.2F, ROBUROC4_MOVE_OBSTACLE},
        {1.0F, 6.28F, ROBUROC4_MOVE_OBSTACLE}, {-1.0F, 9.42F, ROBUROC4_MOVE_OBSTACLE}};
    for (const auto &[way_m, theta_rad, result] : rows) {
        roburoc4_tests::ScriptedRobot robot;
        robot.telemeters[0].theta_rad = theta_rad;
        robot.distances[0] = distance_m;
        if (result == ROBUROC4_MOVE_OBSTACLE) { /* the nearest one counts */
            robot.telemeters[1].theta_rad = way_m > 0 ? 0 : 3.14F;
            robot.distances[1] = 9;
        }
        roburoc4_tests::Armed bench(robot);
        roburoc4_move move;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, way_m, 0, nullptr));
        for (int i = 0; i < 2; i++) {
            EXPECT_EQ(ROBUROC4_MOVE_RUNNING,
                      roburoc4_move_step(&move, &bench.client, bench.now_us));
            bench.run(5 * cycle_us);
        }
        EXPECT_EQ(result, roburoc4_move_step(&move, &bench.client, bench.now_us))
            << way_m << " m, " << theta_rad << " rad";
    }
}

TEST(MoveOfAClient, WhatATelemeterSeesBesideOrBehindIsNoObstacle) {
    expect_obstacles_ahead_only(0.1F);
    expect_obstacles_ahead_only(static_cast<float>(no_number)); /* what is not known is near */
}

TEST(MoveOfAClient, ATelemeterWhoseBeamPassesByDoesNotSeeWhatIsAhead) {
    for (const auto &[theta_rad, other_rad] :
         {std::pair(0.4F, 0.4F), {0.7F, 0.7F}, {0.4F, 0.7F}, {0.7F, 0.4F}}) {
        roburoc4_tests::ScriptedRobot robot;
        robot.telemeters[0].theta_rad = theta_rad;
        robot.telemeters[1].theta_rad = other_rad;
        robot.telemeters[0].field_of_view_rad = robot.telemeters[1].field_of_view_rad = 0.5F;
        roburoc4_tests::Armed bench(robot);
        roburoc4_move move;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, nullptr));
        for (int i = 0; i < 150; i++) {
            (void)roburoc4_move_step(&move, &bench.client, bench.now_us);
            bench.run(cycle_us);
        }
        EXPECT_EQ(std::min(theta_rad, other_rad) < 0.5F ? ROBUROC4_MOVE_RUNNING
                                                        : ROBUROC4_MOVE_NO_FRONT_TELEMETER,
                  move.outcome);
    }
}

/** An uplink that delivers two seconds late: the stop is not confirmed in its time. */
TEST(MoveOfAClient, RestIsNotReachedByAnUnconfirmedStop) {
    roburoc4_tests::ScriptedRobot robot;
    roburoc4_tests::Armed bench(robot);
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second / 5));
    bench.drop_to_robot = [](const roburoc4_tests::Bytes &) { return true; };
    robot.target_linear = robot.current_linear = 0; /* as one that has not got them yet */
    roburoc4_move move;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&move, nullptr));
    for (int i = 0; i < 300; i++) {
        ASSERT_EQ(ROBUROC4_MOVE_RUNNING, roburoc4_move_step(&move, &bench.client, bench.now_us));
        bench.run(cycle_us);
    }
    bench.drop_to_robot = nullptr;
    for (int i = 0; i < 300 && move.outcome == ROBUROC4_MOVE_RUNNING; i++) {
        (void)roburoc4_move_step(&move, &bench.client, bench.now_us);
        bench.run(cycle_us);
    }
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, move.outcome);
}

TEST(MoveOfAClient, RestIsReachedByARobotWhoseTargetsAreRounded) {
    roburoc4_tests::ScriptedRobot robot;
    roburoc4_tests::Armed bench(robot);
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second / 5));
    roburoc4_move move;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&move, nullptr));
    for (int i = 0; i < 300 && move.outcome == ROBUROC4_MOVE_RUNNING; i++) {
        (void)roburoc4_move_step(&move, &bench.client, bench.now_us);
        robot.current_linear = 0;
        robot.target_linear = 0.0005F;
        bench.run(cycle_us);
    }
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, move.outcome);
}

TEST(MoveOutcome, EveryOutcomeHasASentence) {
    for (std::int32_t result = ROBUROC4_MOVE_RUNNING; result <= ROBUROC4_MOVE_NO_REAR_TELEMETER;
         result++) {
        const std::string text = roburoc4_move_outcome_text(result);
        EXPECT_GT(text.size(), 8U);
        EXPECT_NE("unknown outcome", text);
    }
    EXPECT_STREQ(roburoc4_result_text(ROBUROC4_ERR_CLOSED),
                 roburoc4_move_outcome_text(ROBUROC4_ERR_CLOSED));
    EXPECT_STREQ("unknown outcome", roburoc4_move_outcome_text(19));
}
