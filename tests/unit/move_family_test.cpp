/* SPDX-License-Identifier: MIT
 *
 * move_family_test.cpp - moves on robots that are not the simulator: the judge of family.h on a
 * sample, and robots whose odometry or sensors are wrong.
 */
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>

#include "drawn.h"
#include "family.h"

using roburoc4_tests::Drawn;
using roburoc4_tests::drawn_seed;

namespace {

constexpr double degree = 3.14159265358979323846 / 180;
const family_member nominal{2.46, 0.79, 1, 0, 0, 10, 50, 0.3, 0, 0};

/** One robot with something wrong, and its client. */
class MoveFault : public testing::Test {
  protected:
    MoveFault() {
        family_prepare(&rig, &nominal, 1);
        roburoc4_move_options_init(&options, sizeof options);
    }
    void arm() {
        family_connect(&rig, nullptr);
        ASSERT_EQ(1, family_arm(&rig));
        family_pass(&rig, 1000);
    }
    void drive_for_two_seconds(float linear_m_s, float angular_rad_s) {
        for (int i = 0; i < 20; i++) {
            ASSERT_EQ(ROBUROC4_OK, roburoc4_client_drive(&rig.client, linear_m_s, angular_rad_s, 0,
                                                         family_now_us(&rig)));
            family_pass(&rig, 100);
        }
    }
    void hold_wheels() {
        for (int axis = 0; axis < 2; axis++)
            rig.robot.speed[axis] = rig.robot.slope[axis] = 0;
    }
    /** As far as motors without power brake in a millisecond. */
    void brake_wheels() {
        for (int axis = 0; axis < 2; axis++) {
            const double speed = rig.robot.speed[axis];
            rig.robot.speed[axis] = std::copysign(std::fmax(std::fabs(speed) - 0.003, 0), speed);
            rig.robot.slope[axis] = 0;
        }
    }
    std::int32_t go(const std::function<void()> &when = nullptr) {
        begin_m = rig.robot.distance_m;
        begin_rad = rig.robot.theta_rad;
        meanwhile = when;
        const std::int32_t result = family_go(
            &rig, &move, 120000,
            [](void *self) {
                const auto *test = static_cast<MoveFault *>(self);
                if (test->meanwhile)
                    test->meanwhile();
            },
            this);
        family_pass(&rig, 4000); /* until it has rolled out */
        return result;
    }
    std::int32_t by(float distance_m, float angle_rad,
                    const std::function<void()> &when = nullptr) {
        EXPECT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, distance_m, angle_rad, &options));
        return go(when);
    }
    [[nodiscard]] double drove() const {
        return rig.robot.distance_m - begin_m;
    }
    [[nodiscard]] double turned() const {
        return rig.robot.theta_rad - begin_rad;
    }

    family_rig rig{};
    roburoc4_move move{};
    roburoc4_move_options options{};
    std::function<void()> meanwhile;
    double begin_m = 0, begin_rad = 0;
};

} // namespace

/* ----------------------------------------------------------------------------------- at rest */

/** Robots that had hardly begun to follow when they were stopped. */
TEST(MoveRest, IsReachedByARobotThatWillNotMoveAnyMore) {
    std::uint64_t state = drawn_seed();
    for (int i = 0; i < 200; i++) {
        family_member member = family_member_drawn(&state);
        member.noise_m_s = 0;
        family_rig rig;
        roburoc4_move move;
        ASSERT_EQ(1, family_open(&rig, &member, state));
        rig.loss = 0;
        const float speed = i % 2 == 0 ? 1.0F : 0.2F;
        const std::uint32_t ms = 10 + static_cast<std::uint32_t>(state % 200);
        if (i % 4 < 2) {
            ASSERT_EQ(ROBUROC4_OK,
                      roburoc4_client_drive(&rig.client, speed, speed, 0, family_now_us(&rig)));
            family_pass(&rig, ms);
            roburoc4_move_rest(&move, nullptr);
            while (roburoc4_move_step(&move, &rig.client, family_now_us(&rig)) ==
                   ROBUROC4_MOVE_RUNNING)
                family_pass(&rig, 10);
        } else {
            roburoc4_move_for(&move, speed, speed, 10 * ms, nullptr);
            family_go(&rig, &move, 60000, nullptr, nullptr);
        }
        EXPECT_EQ(ROBUROC4_MOVE_REACHED, move.outcome) << i;
        for (int later = 0; later < 1000; later++) {
            family_pass(&rig, 1);
            EXPECT_LT(std::fabs(rig.robot.speed[0]), 0.05) << i;
            EXPECT_LT(std::fabs(rig.robot.speed[1]), 0.1) << i;
        }
    }
}

TEST_F(MoveFault, ForATimeMayBeginWhileTheRobotRolls) {
    arm();
    drive_for_two_seconds(0.8F, 0);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_pause(&rig.client, family_now_us(&rig)));
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_for(&move, 0.3F, 0, 1000, &options));
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, go());
}

TEST_F(MoveFault, ATurnBegunWhileItRollsIsInPlace) {
    arm();
    drive_for_two_seconds(0.5F, 0);
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, by(0, static_cast<float>(180 * degree)));
    EXPECT_LT(std::fabs(drove()), 0.7) << "but to come to rest";
    EXPECT_NEAR(180 * degree, turned(), 1 * degree);
}

TEST_F(MoveFault, AStraightLineBegunWhileItTurnsIsStraight) {
    arm();
    drive_for_two_seconds(0, 1);
    const double x_m = rig.robot.x_m, y_m = rig.robot.y_m;
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, by(5, 0));
    const double along_m = (rig.robot.x_m - x_m) * std::cos(rig.robot.theta_rad) +
                           (rig.robot.y_m - y_m) * std::sin(rig.robot.theta_rad);
    EXPECT_NEAR(5, along_m, 0.02);
    EXPECT_NEAR(5, std::hypot(rig.robot.x_m - x_m, rig.robot.y_m - y_m), 0.02);
}

TEST_F(MoveFault, ACommandThatIsNotFollowedYetIsTakenBack) {
    arm();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_drive(&rig.client, 1, 0, 0, family_now_us(&rig)));
    family_pass(&rig, 45);
    double furthest_m = 0;
    const double from_m = rig.robot.distance_m;
    options.clearance_m = 0;
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, by(-0.5F, 0, [&] {
                  furthest_m = std::fmax(furthest_m, rig.robot.distance_m - from_m);
              }));
    EXPECT_LT(furthest_m, 0.1);
}

TEST_F(MoveFault, AnEmptyPlainHasNoObstacle) {
    std::uint64_t state = drawn_seed();
    options.max_linear_m_s = 1;
    for (int i = 0; i < 150; i++) {
        family_member member = family_member_drawn(&state);
        member.natural_rad_s = 1.5;
        member.damping = 1.2;
        ASSERT_EQ(1, family_open(&rig, &member, state));
        rig.loss = 0;
        EXPECT_NE(ROBUROC4_MOVE_OBSTACLE, by(i % 2 == 0 ? 30.0F : -30.0F, 0)) << i;
    }
}

TEST_F(MoveFault, RestNeedsNoSpeeds) {
    arm();
    options.max_linear_m_s = 4;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_drive(&rig.client, 0.5F, 0, 0, family_now_us(&rig)));
    family_pass(&rig, 200);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&move, &options));
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, go());
}

TEST_F(MoveFault, RestStopsOnceAndAtItsEnd) {
    arm();
    for (int i = 0; i < 20; i++) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_drive(&rig.client, 0.5F, 0, 0, family_now_us(&rig)));
        family_pass(&rig, 100);
    }
    int confirmed = 0;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_rest(&move, &options));
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, go([&] {
                  const std::uint32_t events = roburoc4_client_take_events(&rig.client);
                  confirmed += (events & ROBUROC4_EVENT_STOP_CONFIRMED) != 0;
              }));
    EXPECT_EQ(1, confirmed);
    EXPECT_NE(0U, roburoc4_client_take_events(&rig.client) & ROBUROC4_EVENT_STOP_CONFIRMED);
    roburoc4_facts facts;
    roburoc4_client_facts(&rig.client, family_now_us(&rig), ROBUROC4_SIZED(&facts));
    EXPECT_EQ(ROBUROC4_STOP_CONFIRMED, facts.stop_outcome);
    EXPECT_TRUE(facts.armed) << roburoc4_result_text(facts.disarm_cause);
}

TEST_F(MoveFault, BegunWhileDisarmedIsCancelled) {
    arm();
    family_pass(&rig, 100);
    (void)roburoc4_client_stop(&rig.client, family_now_us(&rig));
    family_pass(&rig, 1000);
    rig.client.private_drive.disarm_cause =
        ROBUROC4_ERR_STALE_DIFFERENTIAL; /* as after an outage */
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, &options));
    EXPECT_EQ(ROBUROC4_MOVE_CANCELLED, go());
    EXPECT_EQ(ROBUROC4_ERR_STALE_DIFFERENTIAL, move.cause);
}

TEST_F(MoveFault, APauseAfterItsFirstStepEndsIt) {
    arm();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, &options));
    ASSERT_EQ(ROBUROC4_MOVE_RUNNING, roburoc4_move_step(&move, &rig.client, family_now_us(&rig)));
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_drive(&rig.client, move.linear_m_s, move.angular_rad_s,
                                                 0, family_now_us(&rig)));
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_pause(&rig.client, family_now_us(&rig)));
    family_pass(&rig, 10);
    EXPECT_EQ(ROBUROC4_MOVE_CANCELLED, roburoc4_move_step(&move, &rig.client, family_now_us(&rig)));
}

TEST_F(MoveFault, APauseBeforeItsDriveEndsIt) {
    for (const int steps : {0, 150}) {
        arm();
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, &options));
        for (int i = 0; i <= steps + 1; i++) {
            ASSERT_EQ(ROBUROC4_MOVE_RUNNING,
                      roburoc4_move_step(&move, &rig.client, family_now_us(&rig)));
            if (i == steps)
                ASSERT_EQ(ROBUROC4_OK, roburoc4_client_pause(&rig.client, family_now_us(&rig)));
            ASSERT_EQ(ROBUROC4_OK,
                      roburoc4_client_drive(&rig.client, move.linear_m_s, move.angular_rad_s, 0,
                                            family_now_us(&rig)));
            family_pass(&rig, 10);
            if (i == steps)
                break;
        }
        EXPECT_EQ(ROBUROC4_MOVE_CANCELLED,
                  roburoc4_move_step(&move, &rig.client, family_now_us(&rig)))
            << steps;
        family_pass(&rig, 1000);
    }
}

TEST_F(MoveFault, APauseBeforeItsFirstStepEndsNothing) {
    arm();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_pause(&rig.client, family_now_us(&rig)));
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_drive(&rig.client, 0.1F, 0, 0, family_now_us(&rig)));
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, by(0.3F, 0));
}

TEST_F(MoveFault, APauseEndsOneThatBeginsWhileTheLastIsStopped) {
    arm();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 0.3F, 0, &options));
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, family_go(&rig, &move, 60000, nullptr, nullptr));
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 1, 0, &options));
    for (int i = 0; i < 6; i++) {
        ASSERT_EQ(ROBUROC4_MOVE_RUNNING,
                  roburoc4_move_step(&move, &rig.client, family_now_us(&rig)))
            << i;
        if (i == 5)
            ASSERT_EQ(ROBUROC4_OK, roburoc4_client_pause(&rig.client, family_now_us(&rig)));
        ASSERT_EQ(ROBUROC4_OK,
                  roburoc4_client_drive(&rig.client, move.linear_m_s, 0, 0, family_now_us(&rig)));
        family_pass(&rig, 20);
    }
    EXPECT_EQ(ROBUROC4_MOVE_CANCELLED, roburoc4_move_step(&move, &rig.client, family_now_us(&rig)));
}

/** While the zeros of the last one are sent, nothing else is. */
TEST_F(MoveFault, BeginsGentlyRightAfterAnother) {
    arm();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 0.3F, 0, &options));
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, family_go(&rig, &move, 60000, nullptr, nullptr));
    double before = 0, steepest = 0;
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, by(0.3F, 0, [&] {
                  steepest = std::fmax(steepest, rig.last_sent[0] - before);
                  before = rig.last_sent[0];
              }));
    EXPECT_LT(steepest, 0.06);
}

TEST_F(MoveFault, ComingToRestTakesNoneOfItsTime) {
    arm();
    options.max_linear_m_s2 = 0.3F;
    options.clearance_m = 0;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 0.2F, 0, &options));
    const std::uint32_t begun_ms = rig.now_ms;
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, family_go(&rig, &move, 60000, nullptr, nullptr));
    options.timeout_ms = rig.now_ms - begun_ms + 300;
    drive_for_two_seconds(0.9F, 0);
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, by(0.2F, 0));
}

TEST_F(MoveFault, WaitsForACommandThatIsNotFollowedYet) {
    std::uint64_t state = drawn_seed();
    int reached = 0;
    for (std::uint32_t i = 0; i < 200; i++) {
        const family_member member = family_member_drawn(&state);
        ASSERT_EQ(1, family_open(&rig, &member, state));
        rig.loss = 0;
        ASSERT_EQ(ROBUROC4_OK,
                  roburoc4_client_drive(&rig.client, 0.2F, -0.2F, 0, family_now_us(&rig)));
        family_pass(&rig, static_cast<std::uint32_t>(10 + state % 240));
        const double before_m = rig.robot.distance_m;
        reached += by(i % 2 == 0 ? 1.0F : 0.0F, i % 2 == 0 ? 0.0F : 1.0F) == ROBUROC4_MOVE_REACHED;
        EXPECT_LT(rig.robot.distance_m - before_m, i % 2 == 0 ? 1.2 : 0.2) << i;
    }
    EXPECT_GE(reached, 196) << "of 200";
}

TEST_F(MoveFault, APoseIsReachedByARobotThatRolled) {
    std::uint64_t state = drawn_seed();
    for (std::uint32_t i = 0; i < 100; i++) {
        family_member member = family_member_drawn(&state);
        member.natural_rad_s = 2.5;
        ASSERT_EQ(1, family_open(&rig, &member, state));
        rig.loss = 0;
        ASSERT_EQ(ROBUROC4_OK,
                  roburoc4_client_drive(&rig.client, -0.5F, 0.5F, 0, family_now_us(&rig)));
        family_pass(&rig, 200);
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_pose(&move, 1e-3 * static_cast<double>(state % 400),
                                                     0.1, 1, &options));
        EXPECT_NE(ROBUROC4_MOVE_ODOMETRY, go()) << i;
    }
}

/** Weak turns towards a point are below what the client watches. */
TEST_F(MoveFault, ARobotThatStaysWhereItIsIsInhibited) {
    arm();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_point(&move, 20, 0.7, &options));
    const std::uint32_t begun_ms = rig.now_ms;
    EXPECT_EQ(ROBUROC4_MOVE_INHIBITED, go([&] { hold_wheels(); }));
    EXPECT_LT(rig.now_ms - begun_ms, 8000U + 4000U);
}

/** A person nearby takes it for done. */
TEST_F(MoveFault, ARobotThatIsHeldNearItsGoalIsInhibited) {
    for (const float left_m : {0.3F, 0.1F, 0.04F}) {
        arm();
        const double from_m = rig.robot.distance_m;
        EXPECT_EQ(ROBUROC4_MOVE_INHIBITED,
                  by(1, 0,
                     [&] {
                         if (rig.robot.distance_m > from_m + 1 - static_cast<double>(left_m))
                             hold_wheels();
                     }))
            << left_m;
    }
}

/* ------------------------------------------------------------ turns that respond as they like */

class MoveInACurve : public MoveFault {
  protected:
    void draw_robot() {
        family_member member = family_member_drawn(&state);
        if (state % 2 == 0)
            member.natural_rad_s = 0;
        ASSERT_EQ(1, family_open(&rig, &member, state));
        rig.loss = 0;
        rig.robot.turning_rad_s = drawn.between(1.5, 8);
    }
    std::uint64_t state = drawn_seed();
    Drawn drawn{state};
};

/** A person nearby takes a robot that stands for done. */
TEST_F(MoveInACurve, NeverStandsForLongAndThenGoesOn) {
    for (int i = 0; i < 300; i++) {
        draw_robot();
        const float length_m = static_cast<float>(drawn.between(0.4, 3));
        const float angle_rad = static_cast<float>(drawn.between(-3, 3));
        const double from_s = drawn.between(0, 6),
                     span_s = i % 2 == 0 ? drawn.between(0.05, 0.8) : 0;
        const double begun_s = 1e-3 * rig.now_ms;
        double moved_s = begun_s;
        (void)by(length_m, angle_rad, [&] {
            const double now_s = 1e-3 * rig.now_ms;
            if (now_s > begun_s + from_s && now_s < begun_s + from_s + span_s)
                hold_wheels();
            if (move.linear_m_s != 0 || move.angular_rad_s != 0) {
                EXPECT_LT(now_s, moved_s + 5) << i;
                moved_s = now_s;
            } else if (std::fabs(rig.robot.speed[0]) + std::fabs(rig.robot.speed[1]) > 0.05)
                moved_s = now_s;
        });
    }
}

TEST_F(MoveInACurve, IsReachedOnItsArcOnly) {
    int beside = 0, odometry = 0;
    for (int i = 0; i < 600; i++) {
        draw_robot();
        const double length_m = drawn.between(0.4, 3), angle_rad = drawn.between(0.3, 3);
        const double x_m = rig.robot.x_m, y_m = rig.robot.y_m,
                     left = rig.robot.theta_rad + 90 * degree;
        const double radius_m = length_m / angle_rad;
        const std::int32_t outcome =
            by(static_cast<float>(length_m), static_cast<float>(angle_rad));
        odometry += outcome == ROBUROC4_MOVE_ODOMETRY;
        if (outcome != ROBUROC4_MOVE_REACHED)
            continue;
        const double from_middle_m = std::hypot(rig.robot.x_m - x_m - radius_m * std::cos(left),
                                                rig.robot.y_m - y_m - radius_m * std::sin(left));
        EXPECT_NEAR(radius_m, from_middle_m, 0.08 + 0.01 * length_m) << i;
        beside += std::fabs(radius_m - from_middle_m) > 0.03 + 0.01 * length_m;
    }
    EXPECT_LE(beside, 2) << "of 600: 1 of 36,000 was found";
    EXPECT_LE(odometry, 1) << "of 600: 1 of 180,000 was found";
}

TEST_F(MoveInACurve, DrivesNoFartherThanItsWay) {
    for (int i = 0; i < 300; i++) {
        draw_robot();
        const double length_m = drawn.between(0.5, 10), angle_rad = drawn.between(-12, 12);
        options.max_linear_m_s = static_cast<float>(drawn.between(0.3, 1));
        options.max_angular_rad_s = static_cast<float>(drawn.between(0.3, 1.5));
        (void)by(static_cast<float>(length_m), static_cast<float>(angle_rad));
        EXPECT_LT(drove(), 1.3 * length_m + 0.5) << i;
        EXPECT_GT(drove(), -0.5) << i;
    }
}

TEST_F(MoveInACurve, ForATimeIsNoFaultOfOdometry) {
    int reached = 0;
    for (int i = 0; i < 200; i++) {
        draw_robot();
        ASSERT_EQ(ROBUROC4_OK,
                  roburoc4_move_for(&move, static_cast<float>(drawn.between(-1, 1)),
                                    static_cast<float>(drawn.between(-1, 1)),
                                    static_cast<std::uint32_t>(drawn.between(1000, 6000)),
                                    &options));
        const std::int32_t outcome = go();
        EXPECT_NE(ROBUROC4_MOVE_ODOMETRY, outcome) << i;
        reached += outcome == ROBUROC4_MOVE_REACHED;
    }
    EXPECT_GE(reached, 198) << "of 200";
}

/* -------------------------------------------------------------------------- an interrupted way */

/** Wheels that stand still for a moment, as by an emergency stop: what was learned before is wrong,
 *  but where the robot is, is known. */
class MoveInterrupted : public MoveFault {
  protected:
    void interrupt_moves(std::uint64_t state) {
        Drawn drawn(state);
        far = furthest = reached = 0;
        mean_m = 0;
        for (int i = 0; i < moves; i++) {
            const family_member member = i % 3 == 0 ? nominal : family_member_drawn(&state);
            ASSERT_EQ(1, family_open(&rig, &member, state));
            const bool turn = i % 2 != 0;
            const double way = drawn.between(0.5, 3), speed = drawn.between(0.2, 1);
            const double from_s = drawn.between(0, way / speed), span_s = drawn.between(0.02, 0.9);
            const double begun_s = 1e-3 * rig.now_ms;
            options.max_linear_m_s = options.max_angular_rad_s = static_cast<float>(speed);
            const auto interrupt = [&] {
                const double passed_s = 1e-3 * rig.now_ms - begun_s - from_s;
                if (passed_s > 0 && passed_s < span_s)
                    i % 4 < 2 ? hold_wheels() : brake_wheels();
            };
            reached += (turn ? by(0, static_cast<float>(way), interrupt)
                             : by(static_cast<float>(way), 0, interrupt)) == ROBUROC4_MOVE_REACHED;
            const double beyond = (turn ? turned() : drove()) - way;
            mean_m += std::fmax(0, turn ? beyond / 1.75 : beyond) / moves;
            far += beyond > (turn ? 10 * degree : 0.1);
            if (beyond > (turn ? 90 * degree : 0.75)) {
                furthest++;
                std::printf("%d: %g beyond %g %s at %g, interrupted after %g s for %g s\n", i,
                            beyond, way, turn ? "rad" : "m", speed, from_s, span_s);
            }
        }
    }
    static constexpr int moves = 300;
    int far = 0, furthest = 0, reached = 0;
    double mean_m = 0;
};

TEST_F(MoveInterrupted, GoesNoFurtherThanItsGoal) {
    const std::uint64_t state = drawn_seed();
    interrupt_moves(state);
    EXPECT_LE(furthest, 1) << "of 300: 1 of 18,000 was found";
    EXPECT_LE(far, 15) << "of 300: 17 of 1,200 were found";
}

/** These seeds are always the same: what nine of ten robots do. */
TEST_F(MoveInterrupted, GoesOnAndPassesItsGoalByMillimetres) {
    int most_reached = 0, most_far = 0;
    double beyond_m = 0;
    for (const std::uint64_t state : {1U, 2U, 3U, 4U}) {
        interrupt_moves(state);
        most_reached += reached;
        most_far += far;
        beyond_m += mean_m / 4;
    }
    std::printf("%d reached, %d far, %g m\n", most_reached, most_far, beyond_m);
    EXPECT_GE(most_reached, 1040) << "of 1,200";
    EXPECT_LE(most_far, 20) << "of 1,200";
    EXPECT_LT(beyond_m, 0.0095);
}

TEST_F(MoveFault, ForATimeGoesOnAfterAnInterruption) {
    arm();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_for(&move, 0.3F, 0, 6000, &options));
    const std::uint32_t begun_ms = rig.now_ms;
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, go([&] {
                  const std::uint32_t passed_ms = rig.now_ms - begun_ms;
                  if (passed_ms > 2000 && passed_ms < 2300)
                      hold_wheels();
                  if (passed_ms > 1000 && passed_ms < 5000)
                      EXPECT_EQ(0.3F, move.linear_m_s) << passed_ms;
              }));
}

/* ------------------------------------------------------------------------------ the witnesses */

TEST_F(MoveFault, FrozenOdometryEndsIt) {
    arm();
    rig.robot.frozen = 1;
    for (const float speed : {0.3F, 1.0F}) {
        options.max_linear_m_s = options.max_angular_rad_s = speed;
        EXPECT_EQ(ROBUROC4_MOVE_ODOMETRY, by(1, 0));
        EXPECT_LT(drove(), 1.3) << speed;
        EXPECT_EQ(ROBUROC4_MOVE_ODOMETRY, by(0, static_cast<float>(90 * degree)));
        EXPECT_LT(turned(), 120 * degree) << speed;
    }
}

TEST_F(MoveFault, MirroredTurnsEndIt) {
    rig.robot.scale_angle = -1;
    arm();
    EXPECT_EQ(ROBUROC4_MOVE_ODOMETRY, by(0, static_cast<float>(90 * degree)));
    EXPECT_LT(std::fabs(turned()), 120 * degree);
}

/** Nothing contradicts wheels that count too little, but how much is commanded. */
TEST_F(MoveFault, WheelsThatCountTooLittleTakeItAtMostAQuarterTooFar) {
    Drawn drawn;
    for (int i = 0; i < 100; i++) {
        family_prepare(&rig, &nominal, 1);
        arm();
        rig.robot.scale_distance = rig.robot.scale_angle = rig.robot.scale_speeds =
            drawn.between(0.45, 0.75);
        const bool turn = i % 2 != 0;
        const double way = drawn.between(0.5, 4), unit = turn ? 1.75 : 1;
        options.max_linear_m_s = static_cast<float>(drawn.between(0.3, 1));
        options.max_angular_rad_s = static_cast<float>(drawn.between(0.3, 1.5));
        turn ? by(0, static_cast<float>(way)) : by(static_cast<float>(way), 0);
        family_pass(&rig, 3000);
        EXPECT_GT(turn ? turned() : drove(), 0.3 * way)
            << "it may end early, but not before it went anywhere";
        EXPECT_LT(turn ? turned() : drove(), 1.25 * way + 0.25 * unit)
            << way << ", scale " << rig.robot.scale_speeds;
    }
}

TEST_F(MoveFault, OdometryAtHalfScaleEndsIt) {
    rig.robot.scale_distance = rig.robot.scale_angle = 0.5;
    arm();
    EXPECT_EQ(ROBUROC4_MOVE_ODOMETRY, by(1, 0));
    EXPECT_LT(drove(), 1.3);
    EXPECT_EQ(ROBUROC4_MOVE_ODOMETRY, by(0, static_cast<float>(90 * degree)));
    EXPECT_LT(turned(), 120 * degree);
}

TEST_F(MoveFault, OdometryAndSpeedsThatAgreeButNotWithItsCommandsEndIt) {
    for (const auto &[gain, scale] : {std::pair(0.55, 1.0), {0.72, 1.2}, {0.864, 0.833}}) {
        family_member larger = nominal; /* than its wheels count */
        larger.natural_rad_s = 0;
        larger.gain = gain;
        family_prepare(&rig, &larger, 1);
        rig.robot.scale_distance = rig.robot.scale_angle = scale;
        arm();
        for (const float speed : {0.3F, 1.0F}) {
            options.max_linear_m_s = options.max_angular_rad_s = speed;
            EXPECT_EQ(ROBUROC4_MOVE_ODOMETRY, by(gain < 0.6 ? 1.5F : 4, 0)) << gain << " " << speed;
            EXPECT_EQ(ROBUROC4_MOVE_ODOMETRY, by(0, gain < 0.6 ? 2 : 6)) << gain << " " << speed;
        }
    }
}

TEST_F(MoveFault, CorrectionsOfACentimetreDoNotAddUp) {
    arm();
    const std::int32_t result = by(2, 0, [&] { rig.robot.odometry_x_m -= 0.002; });
    EXPECT_EQ(ROBUROC4_MOVE_ODOMETRY, result);
    EXPECT_LT(drove(), 2.3);
}

TEST_F(MoveFault, AJumpOfThePoseEndsIt) {
    arm();
    EXPECT_EQ(ROBUROC4_MOVE_RELOCALIZED, by(2, 0, [&] {
                  if (drove() > 1 && rig.robot.odometry_x_m < 4)
                      rig.robot.odometry_x_m += 5;
              }));
    EXPECT_LT(drove(), 1.5);
}

/** Measured each 0.2 s and sent each 10 ms, a pose stands, and then jumps by 20 cm at 1 m/s. */
TEST_F(MoveFault, APoseThatIsMeasuredSeldomAndSentOftenDoesNotJump) {
    std::uint64_t state = drawn_seed();
    for (int i = 0; i < 60; i++) {
        family_member member = family_member_drawn(&state);
        member.loss = member.noise_m_s = 0;
        member.odometry_ms = 150 + 10 * static_cast<std::uint32_t>(family_random(&state) % 6);
        family_prepare(&rig, &member, state);
        rig.pose_ms = 10;
        arm();
        options.max_linear_m_s = 1;
        options.max_angular_rad_s = 1.5F;
        EXPECT_EQ(ROBUROC4_MOVE_REACHED, i % 4 < 3 ? by(5, 0) : by(0, 5)) << i;
    }
}

TEST_F(MoveFault, APoseThatIsSilentForAWhileCostsNoAccuracy) {
    arm();
    double furthest_m = 0;
    const std::uint32_t silent_from_ms = rig.now_ms + 2200;
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, by(1, 0, [&] {
                  const bool silent = rig.now_ms - silent_from_ms < 800;
                  rig.robot.silent = silent ? 1U << ROBUROC4_SERVICE_LOCALIZATION : 0;
                  furthest_m = std::fmax(furthest_m, rig.robot.distance_m - begin_m);
              }));
    EXPECT_LT(furthest_m, 1.03);
}

/** A move that begins before the first pose counts speeds until then. */
TEST_F(MoveFault, APoseThatComesAfterItsFirstStepIsUsed) {
    std::uint64_t state = drawn_seed();
    for (const bool jumps : {false, true}) {
        for (int i = 0; i < 20; i++) {
            family_member member = family_member_drawn(&state);
            member.loss = member.noise_m_s = 0;
            family_prepare(&rig, &member, state);
            rig.robot.silent = 1U << ROBUROC4_SERVICE_LOCALIZATION;
            arm();
            const std::uint32_t until_ms = rig.now_ms + 10 * static_cast<std::uint32_t>(i);
            rig.robot.scale_speeds = jumps ? 1 : 0.9;
            const std::int32_t result = by(i % 2 == 0 ? 2 : 0, i % 2 == 0 ? 0 : 4, [&] {
                if (rig.now_ms >= until_ms)
                    rig.robot.silent = 0;
                if (jumps && rig.now_ms >= until_ms + 2000 && rig.robot.odometry_x_m < 4)
                    rig.robot.odometry_x_m += 5;
            });
            EXPECT_EQ(jumps ? ROBUROC4_MOVE_RELOCALIZED : ROBUROC4_MOVE_REACHED, result) << i;
            if (!jumps) {
                EXPECT_NEAR(i % 2 == 0 ? 2 : 4, i % 2 == 0 ? drove() : turned(), 0.06) << i;
            }
        }
    }
}

TEST_F(MoveFault, ASilentLocalizationEndsIt) {
    arm();
    EXPECT_EQ(ROBUROC4_MOVE_LOST, by(2, 0, [&] {
                  if (drove() > 0.5)
                      rig.robot.silent |= 1U << ROBUROC4_SERVICE_LOCALIZATION;
              }));
    EXPECT_LT(drove(), 1.2);
}

TEST_F(MoveFault, APoseThatIsNotFreshPlansNothing) {
    arm();
    rig.robot.silent |= 1U << ROBUROC4_SERVICE_LOCALIZATION;
    family_pass(&rig, 12500);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_point(&move, 0.1, 0, &options));
    EXPECT_EQ(ROBUROC4_MOVE_LOST, go());
    EXPECT_NEAR(0, drove(), 0.001);
}

TEST_F(MoveFault, APoseFromBeforeARebootPlansNothing) {
    arm();
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, by(2, 0));
    family_reboot(&rig);
    for (int i = 0; i < 300; i++) { /* from the reboot until well after the client knows of it */
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_to_point(&move, rig.robot.pose[0] + 0.3, 0, &options));
        const std::int32_t result = go();
        EXPECT_LT(std::fabs(drove()), 0.32) << roburoc4_move_outcome_text(result);
        (void)roburoc4_client_arm(&rig.client, family_now_us(&rig));
        if (result == ROBUROC4_MOVE_REACHED)
            return;
    }
    ADD_FAILURE() << "it never recovered";
}

TEST_F(MoveFault, BesideItsGoalIsNotReached) {
    for (const float way_m : {1.0F, 6.0F}) { /* a hundredth of it is near enough */
        family_prepare(&rig, &nominal, 1);
        arm();
        EXPECT_EQ(way_m > 1 ? ROBUROC4_MOVE_REACHED : ROBUROC4_MOVE_OFF_COURSE, by(way_m, 0, [&] {
                      if (drove() > double{way_m} - 0.1 && rig.robot.odometry_y_m < 0.06)
                          rig.robot.odometry_y_m += 0.002; /* another program corrects it */
                  }));
        EXPECT_NEAR(way_m, drove(), 0.02);
    }
}

TEST_F(MoveFault, AnArcThatIsReachedEndsAtItsEnd) {
    int reached = 0;
    for (const double natural : {1.5, 2.46, 8.0, 0.0}) {
        for (const float angle : {-0.8F, 1.57F, 3.14F}) {
            family_member member = nominal;
            member.natural_rad_s = natural;
            member.gain = 0.9;
            member.dead_ms = 50;
            member.odometry_ms = 100;
            family_prepare(&rig, &member, 1);
            arm();
            if (by(1.5F, angle) != ROBUROC4_MOVE_REACHED)
                continue; /* then it says so */
            reached++;
            const double radius = 1.5 / static_cast<double>(angle);
            EXPECT_LT(std::hypot(rig.robot.x_m - radius * std::sin(angle),
                                 rig.robot.y_m - radius * (1 - std::cos(angle))),
                      0.05)
                << natural << " " << angle;
            EXPECT_NEAR(static_cast<double>(angle), turned(), 2 * degree);
        }
    }
    EXPECT_GE(reached, 8);
}

/* ---------------------------------------------------------------- what is not seen is not free */

TEST_F(MoveFault, WithoutAnyTelemeterInItsDirectionItDoesNotBegin) {
    const std::function<void()> faults[] = {
        [&] { rig.robot.unanswered |= 1U << ROBUROC4_SERVICE_TELEMETER; },
        [&] { rig.robot.telemeters = rig.robot.distances = 0; },
        [&] { rig.robot.telemeter_rad[0] = rig.robot.telemeter_rad[1] = 1.57F; },
        [&] { rig.robot.silent |= 1U << ROBUROC4_SERVICE_TELEMETER; },
        [&] { rig.robot.distances = 0; }};
    for (const auto &fault : faults) {
        family_prepare(&rig, &nominal, 1);
        fault();
        rig.robot.wall_x_m = 0.9;
        family_connect(&rig, nullptr);
        if (!family_arm(&rig))
            continue; /* not armed is safe, too */
        EXPECT_EQ(ROBUROC4_MOVE_NO_FRONT_TELEMETER, by(2, 0));
        EXPECT_EQ(ROBUROC4_MOVE_NO_REAR_TELEMETER, by(-2, 0));
        EXPECT_NEAR(0, drove(), 0.001);
        options.clearance_m = 0;
        EXPECT_EQ(ROBUROC4_MOVE_REACHED, by(0.2F, 0));
        options.clearance_m = 0.5F;
    }
}

/** Slow robots that compute pose and speeds seldom: what a move learns of them may be wrong. */
TEST_F(MoveFault, KeepsItsClearanceWhateverTheRobotIsLike) {
    Drawn drawn;
    for (int i = 0; i < 300; i++) {
        family_member slow = nominal;
        slow.natural_rad_s = drawn.between(1.5, 2.6);
        slow.damping = drawn.between(0.8, 1.5);
        slow.gain = drawn.between(0.85, 1.15);
        slow.dead_ms = static_cast<std::uint32_t>(drawn.between(0, 150));
        slow.odometry_ms = 10 * static_cast<std::uint32_t>(drawn.between(1, 21));
        slow.status_ms = 10 * static_cast<std::uint32_t>(drawn.between(1, 11));
        family_prepare(&rig, &slow, static_cast<std::uint64_t>(drawn.between(0, 1e9)));
        rig.robot.speeds_stand = 1;
        rig.pose_ms = 10 * static_cast<std::uint32_t>(drawn.between(5, 31));
        arm();
        rig.robot.wall_x_m = drawn.between(0.9, 3.5);
        options.max_linear_m_s = static_cast<float>(drawn.between(0.3, 1));
        EXPECT_EQ(ROBUROC4_MOVE_OBSTACLE, by(4, 0));
        family_pass(&rig, 8000);
        EXPECT_GT(rig.robot.wall_x_m - rig.robot.x_m, 0.2)
            << slow.natural_rad_s << " rad/s, damping " << slow.damping << ", gain " << slow.gain
            << ", dead " << slow.dead_ms << " ms, odometry " << slow.odometry_ms << ", speeds "
            << slow.status_ms << ", pose " << rig.pose_ms << " ms, " << options.max_linear_m_s
            << " m/s";
    }
}

/** What was learned before something held the wheels is gone, but where the robot rolls to is not.
 */
TEST_F(MoveFault, KeepsItsClearanceAfterAnInterruption) {
    Drawn drawn;
    for (int i = 0; i < 60; i++) {
        const bool wall = i % 2 == 0;
        family_member robot = nominal;
        robot.natural_rad_s = drawn.between(1.5, 2.5);
        robot.damping = drawn.between(0.8, 1.2);
        robot.gain = wall ? drawn.between(0.85, 1) : drawn.between(1, 1.15);
        family_prepare(&rig, &robot, static_cast<std::uint64_t>(drawn.between(0, 1e9)));
        arm();
        options.max_linear_m_s = 1;
        const double from_m = drawn.between(5, 12);
        rig.robot.wall_x_m = wall ? from_m + drawn.between(4, 8) : 0;
        std::uint32_t end_ms = 0;
        const std::int32_t outcome = by(30, 0, [&] {
            if (end_ms == 0 && rig.robot.x_m > from_m)
                end_ms = rig.now_ms + 400;
            if (rig.now_ms < end_ms)
                hold_wheels();
        });
        EXPECT_NE(0U, end_ms);
        EXPECT_EQ(wall, outcome == ROBUROC4_MOVE_OBSTACLE) << i << ": " << outcome;
        if (wall) {
            EXPECT_GT(rig.robot.wall_x_m - rig.robot.x_m, 0.2)
                << robot.natural_rad_s << " rad/s, damping " << robot.damping << ", gain "
                << robot.gain << ", held at " << from_m << ", wall at " << rig.robot.wall_x_m;
        }
    }
}

TEST_F(MoveFault, WheelsThatCountTooLittleTakeItNoFurtherAfterInterruptions) {
    Drawn drawn;
    for (int i = 0; i < 30; i++) {
        family_member robot = nominal;
        robot.natural_rad_s = drawn.between(2, 4);
        family_prepare(&rig, &robot, static_cast<std::uint64_t>(drawn.between(0, 1e9)));
        arm();
        rig.robot.scale_distance = rig.robot.scale_angle = rig.robot.scale_speeds =
            drawn.between(0.3, 0.75);
        options.max_linear_m_s = static_cast<float>(drawn.between(0.3, 0.8));
        const auto way_m = static_cast<float>(drawn.between(2, 5));
        const double apart_m = drawn.between(0.7, 1.5);
        double next_m = apart_m;
        std::uint32_t end_ms = 0;
        by(way_m, 0, [&] {
            if (rig.robot.x_m > next_m) {
                end_ms = rig.now_ms + 800;
                next_m += apart_m;
            }
            if (rig.now_ms < end_ms)
                hold_wheels();
        });
        EXPECT_LT(rig.robot.x_m, 1.25 * double{way_m} + 0.2 + 0.4)
            << i << ": " << way_m << " m, scale " << rig.robot.scale_speeds << ", outcome "
            << move.outcome;
    }
}

TEST_F(MoveFault, ForATimeKeepsItsClearanceIfItRolledBefore) {
    Drawn drawn;
    for (int i = 0; i < 40; i++) {
        const bool wall = i % 2 == 0;
        family_member robot = nominal;
        robot.natural_rad_s = drawn.between(1.5, 2.5);
        robot.gain = drawn.between(0.85, 1.15);
        family_prepare(&rig, &robot, static_cast<std::uint64_t>(drawn.between(0, 1e9)));
        arm();
        drive_for_two_seconds(0.8F, 0);
        rig.robot.wall_x_m = wall ? rig.robot.x_m + drawn.between(4, 8) : 0;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_for(&move, 0.8F, 0, 12000, &options));
        EXPECT_EQ(wall ? ROBUROC4_MOVE_OBSTACLE : ROBUROC4_MOVE_REACHED, go()) << i;
        if (wall)
            EXPECT_GT(rig.robot.wall_x_m - rig.robot.x_m, 0.2) << i << ", gain " << robot.gain;
    }
}

TEST_F(MoveFault, WithoutABumperOfItsOwnItDoesNotBegin) {
    const std::int32_t outcomes[] = {ROBUROC4_MOVE_NO_FRONT_BUMPER, ROBUROC4_MOVE_NO_REAR_BUMPER};
    for (const int bumper : {0, 1}) {
        family_prepare(&rig, &nominal, 1);
        rig.robot.texts[bumper] = "Something else";
        arm();
        EXPECT_EQ(outcomes[bumper], by(bumper == 0 ? 0.3F : -0.3F, 0));
        EXPECT_NEAR(0, drove(), 0.001);
    }
}

TEST_F(MoveFault, WithoutADistanceBehindItMovesOnlyAhead) {
    rig.robot.distances = 1;
    arm();
    EXPECT_EQ(ROBUROC4_MOVE_NO_REAR_TELEMETER, by(-0.3F, 0));
    EXPECT_NEAR(0, drove(), 0.001);
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, by(0.3F, 0));
}

TEST_F(MoveFault, TelemetersThatFallSilentKeepItAwayFromTheWall) {
    arm();
    rig.robot.wall_x_m = 3;
    for (const float speed : {0.3F, 1.0F}) {
        options.max_linear_m_s = speed;
        const std::int32_t result = by(4, 0, [&] {
            if (3 - rig.robot.x_m < 1.8)
                rig.robot.silent |= 1U << ROBUROC4_SERVICE_TELEMETER;
        });
        EXPECT_EQ(speed < 1 ? ROBUROC4_MOVE_NO_FRONT_TELEMETER : ROBUROC4_MOVE_OBSTACLE, result);
        EXPECT_GT(3 - rig.robot.x_m, 0.45) << speed;
        rig.robot.silent = 0;
        rig.robot.x_m = 0;
        family_pass(&rig, 2000);
        (void)roburoc4_client_arm(&rig.client, family_now_us(&rig));
    }
}

TEST_F(MoveFault, AMoveRightAfterArmingWaitsForTheTelemeters) {
    family_connect(&rig, nullptr);
    rig.robot.silent |= 1U << ROBUROC4_SERVICE_TELEMETER;
    ASSERT_EQ(1, family_arm(&rig));
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, by(0.2F, 0, [&] { rig.robot.silent = 0; }));
}

/* ------------------------------------------------------------------------------- times, units */

TEST_F(MoveFault, ATimeIsATimeRightAfterAnotherMove) {
    arm();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_by(&move, 0.3F, 0, &options));
    ASSERT_EQ(ROBUROC4_MOVE_REACHED, family_go(&rig, &move, 60000, nullptr, nullptr));
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_for(&move, 0.3F, 0, 1000, &options));
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, go());
    EXPECT_NEAR(1000, rig.last_ms - rig.first_ms, 20);
    EXPECT_LT(rig.steepest[0], 0.51);
}

TEST_F(MoveFault, ATimeIsATimeHoweverFarTheRobotComes) {
    for (const double gain : {0.2, 1.0}) {
        family_member member = nominal;
        member.gain = gain;
        family_prepare(&rig, &member, 1);
        arm();
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_for(&move, 0.3F, 0.1F, 3000, &options));
        (void)go();
        EXPECT_LE(rig.last_ms - rig.first_ms, 3000U) << gain;
        if (gain == 1.0) {
            EXPECT_EQ(ROBUROC4_MOVE_REACHED, move.outcome);
            EXPECT_NEAR(3000, rig.last_ms - rig.first_ms, 20);
            EXPECT_NEAR(0.3 * 3 - 0.3 * 0.3 / 0.5, drove(), 0.02);
            EXPECT_LT(rig.steepest[0], 0.51);
        }
    }
}

TEST_F(MoveFault, ATimeIsATimeBackwardAndToTheRight) {
    arm();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_move_for(&move, -0.3F, -0.1F, 2000, &options));
    EXPECT_EQ(ROBUROC4_MOVE_REACHED, go());
    EXPECT_NEAR(2000, rig.last_ms - rig.first_ms, 20);
    EXPECT_NEAR(-(0.3 * 2 - 0.3 * 0.3 / 0.5), drove(), 0.02);
}

TEST_F(MoveFault, DegreesAndSpeedsBeyondAnyRobotAreRefused) {
    for (const float degrees : {90.0F, -90.0F, 12.6F, -12.6F})
        EXPECT_EQ(ROBUROC4_ERR_UNITS, roburoc4_move_by(&move, 0, degrees, &options)) << degrees;
    EXPECT_EQ(ROBUROC4_ERR_UNITS, roburoc4_move_to_pose(&move, 0, 0, 90, &options));
    for (const float speed : {10.1F, -10.1F, 300.0F}) {
        EXPECT_EQ(ROBUROC4_ERR_UNITS, roburoc4_move_for(&move, speed, 0, 1000, &options)) << speed;
        EXPECT_EQ(ROBUROC4_ERR_UNITS, roburoc4_move_for(&move, 0, speed, 1000, &options)) << speed;
    }
    options.max_linear_m_s = 100;
    EXPECT_EQ(ROBUROC4_ERR_UNITS, roburoc4_move_by(&move, 1, 0, &options));
    options.max_linear_m_s = 1.1F;
    arm();
    EXPECT_EQ(ROBUROC4_MOVE_TOO_FAST, by(1, 0));
    EXPECT_NEAR(0, drove(), 0.001);
    for (const int axis : {0, 1}) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_move_for(&move, axis == 0 ? 1.1F : 0, axis == 0 ? 0 : 1.6F,
                                                 1000, nullptr));
        EXPECT_EQ(ROBUROC4_MOVE_TOO_FAST, go());
    }
}

TEST(MoveFamily, ADrawnSampleOfRobotsMovesAsItShould) {
    std::uint64_t seed = drawn_seed();
    constexpr int sample = 300;
    int fine = 0;
    for (int i = 0; i < sample; i++) {
        const auto index = static_cast<std::uint32_t>(family_random(&seed) % FAMILY_SIZE);
        family_member member = i % 3 == 0 ? family_member_drawn(&seed) : family_member_at(index);
        member.loss = i % 2 != 0 ? 0.2 : 0;
        const family_verdict verdict = family_judge(&member, seed, 0);
        if (verdict.fault != nullptr)
            family_print(&member, &verdict);
        else
            fine++;
    }
    /* bench/moves judges all of them: 98 %. Below 94 % of a sample is no chance. */
    EXPECT_GE(fine, sample * 94 / 100);
}

/** Always the same robots: the means of all 7,488, which bench/moves judges, are 4.1 mm (a radian
 * counts as 1.75 m), 2.9 mm and 1.31 times the time of the profile and of the response. */
TEST(MoveFamily, IsAsExactAndAsFastAsItWas) {
    for (const double loss : {0.0, 0.2}) {
        int robots = 0, faults = 0, beside = 0, turned_back = 0;
        double error_m = 0, overshoot_m = 0, took = 0;
        for (std::uint32_t index = 1; index < FAMILY_SIZE; index += 13) {
            family_member robot = family_member_at(index);
            robot.loss = loss;
            const family_verdict verdict = family_judge(&robot, 20260301U + index, 0);
            const double unit = robot.turn != 0 ? 1.75 : 1;
            robots++;
            faults += verdict.fault != nullptr;
            beside += verdict.error > 0.0105 * unit;
            turned_back += static_cast<int>(verdict.reversals);
            error_m += verdict.error / unit;
            overshoot_m += std::fmax(0, verdict.overshoot / unit);
            took += verdict.took_s / verdict.ideal_s;
        }
        std::printf("%d faults, %d beside, %g m off, %g m too far, %g of the time, %g times back\n",
                    faults, beside, error_m / robots, overshoot_m / robots, took / robots,
                    1.0 * turned_back / robots);
        EXPECT_LE(faults, loss > 0 ? 4 : 1) << "of 576";
        EXPECT_LE(beside, loss > 0 ? 20 : 14) << "of 576, more than a centimetre";
        EXPECT_LT(error_m / robots, 0.0042);
        EXPECT_LT(overshoot_m / robots, loss > 0 ? 0.0048 : 0.0040);
        EXPECT_LT(took / robots, loss > 0 ? 1.345 : 1.33);
        EXPECT_LT(1.0 * turned_back / robots, loss > 0 ? 0.3 : 0.245);
    }
}

/** Who turned back once drives on to within a centimetre; the second time, 1.8 are near enough. */
TEST(MoveFamily, OneTurnBackIsNoExcuse) {
    for (const std::uint32_t index : {1599U, 2694U, 2718U, 2739U, 2742U, 3972U, 3996U, 5739U}) {
        const family_member robot = family_member_at(index);
        const family_verdict verdict = family_judge(&robot, 20260301U + index, 0);
        EXPECT_LT(verdict.error, (robot.turn != 0 ? 1.75 : 1) * 0.01) << index;
    }
}

/* Robots that were slow at the end of a swing, and 2 to 3 cm off when it was over. */
TEST(MoveFamily, ARobotThatSwingsIsNotThereYet) {
    for (const std::uint32_t index : {620U, 692U, 812U, 876U, 936U, 1012U, 1020U, 1068U}) {
        const family_member robot = family_member_at(index);
        const family_verdict verdict = family_judge(&robot, 20260301U + index, 0);
        EXPECT_EQ(nullptr, verdict.fault) << index;
    }
}

/* A robot that covers 1.15 times the commanded distance stood a hair too far from its goal to be
 * there, and not far enough to move again. */
TEST(MoveFamily, ARobotThatStandsIsThereOrMovesAgain) {
    for (const std::uint32_t odometry_ms : {10U, 50U, 100U, 200U}) {
        for (const int turn : {0, 1}) {
            const family_member robot{1.5, 0.6, 1.15, 0, 0, odometry_ms, 100, 1, turn, 0};
            EXPECT_EQ(ROBUROC4_MOVE_REACHED, family_judge(&robot, 1, 0).result)
                << odometry_ms << " " << turn;
        }
    }
}
