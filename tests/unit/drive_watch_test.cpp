/* SPDX-License-Identifier: MIT
 *
 * What a client watches for while it drives: another commander, inhibited motion, the override.
 */
#include "client_bench.h"
#include "drawn.h"

#include <array>
#include <cmath>
#include <deque>
#include <limits>

using namespace roburoc4_tests;

/* ---- another commander ---- */

TEST(OtherCommander, IsReportedAfterThreeStatuses) {
    ScriptedRobot robot;
    robot.follows = false;
    Ready bench(robot);
    robot.target_angular = 0.5F;
    for (std::uint64_t i = 1; i <= 2; i++)
        bench.receive(robot.status_at(6, robot.cycles() + i));
    EXPECT_EQ(0, bench.facts().other_commander);
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_OTHER_COMMANDER);
    bench.receive(robot.status_at(6, robot.cycles() + 3));
    EXPECT_EQ(1, bench.facts().other_commander);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_OTHER_COMMANDER);
    bench.run(second);
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_OTHER_COMMANDER) << "once";
    robot.target_angular = 0;
    bench.run(200 * ms);
    EXPECT_EQ(0, bench.facts().other_commander);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_OTHER_COMMANDER) << "and when it ends";
}

TEST(OtherCommander, IsAlsoOneThatCommandsSlowly) {
    for (const float speed : {0.05F, -0.05F})
        for (const bool turning : {false, true}) {
            ScriptedRobot robot;
            robot.follows = false;
            Ready bench(robot);
            (turning ? robot.target_angular : robot.target_linear) = speed;
            bench.run(200 * ms);
            EXPECT_EQ(1, bench.facts().other_commander) << speed << (turning ? " rad/s" : " m/s");
        }
}

TEST(OtherCommander, IsNotTwoStatuses) {
    ScriptedRobot robot;
    robot.follows = false;
    Ready bench(robot);
    for (std::uint64_t i = 1; i <= 9; i++) {
        robot.target_linear = i % 3 == 0 ? 0.0F : 0.5F;
        bench.receive(robot.status_at(6, robot.cycles() + i));
        EXPECT_EQ(0, bench.facts().other_commander) << i;
    }
}

TEST(OtherCommander, IsNeverTheClientItself) {
    Drawn drawn;
    roburoc4_config config = default_config();
    config.period_ms[ROBUROC4_SERVICE_DIFFERENTIAL] = 10;
    RobotBench bench(config);
    bench.delay_to_client = [] { return 120 * ms; }; /* what it reports is old */
    bench.armed();
    float linear = 1, angular = 2;
    for (int i = 0; i < 500; i++) {
        linear = drawn.within(1) < 0.5 ? linear : -linear;
        angular = drawn.within(1) < 0.5 ? angular : 1.5F - angular;
        ASSERT_EQ(ROBUROC4_OK, bench.drive(linear, angular)) << i;
        bench.run(30 * ms);
    }
    bench.pause();
    bench.run(3 * second);
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_OTHER_COMMANDER);
    EXPECT_EQ(1, bench.facts().armed) << bench.facts().disarm_cause;
}

TEST(OtherCommander, IsNeverTheGamePad) {
    ScriptedRobot robot;
    robot.follows = false;
    Ready bench(robot);
    robot.press(ROBUROC4_DI_PAD_A);
    bench.run(100 * ms);
    robot.target_linear = robot.current_linear = 1;
    bench.run(5 * second);
    EXPECT_EQ(0, bench.facts().other_commander);
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_OTHER_COMMANDER);
}

TEST(OtherCommander, DisarmsAndSendsZeros) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    bench.robot.follows = false;
    bench.robot.target_linear = 0.5F;
    bench.robot.target_angular = 1;
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0, 1000000));
    bench.run(200 * ms);
    EXPECT_EQ(0, bench.facts().armed);
    EXPECT_EQ(ROBUROC4_ERR_OTHER_COMMANDER, bench.facts().disarm_cause);
    EXPECT_TRUE(bench.commands().back().zero());
}

TEST(OtherCommander, IsSeenAlsoBetweenZeroAndOurTarget) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, 5 * second));
    bench.robot.follows = false;
    bench.robot.target_linear = 0.5F; /* we said 1 for five seconds */
    for (int i = 0; i < 20 && bench.facts().armed == 1; i++) {
        bench.drive(1, 0);
        bench.run(50 * ms);
    }
    EXPECT_EQ(1, bench.facts().other_commander);
    EXPECT_EQ(0, bench.facts().armed);
}

TEST(OtherCommander, MayUseTheSpeedThatWeUsedLongAgo) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, second));
    bench.run(5 * second);
    bench.robot.follows = false;
    bench.robot.target_linear = 1;
    bench.run(200 * ms);
    EXPECT_EQ(1, bench.facts().other_commander) << "nothing was sent for seconds";
}

TEST(OtherCommander, MayUseTheSpeedThatWeUsedLongAgoHoweverOftenWeStopped) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, 300 * ms));
    for (int i = 0; i < 8; i++) {
        bench.pause();
        bench.run(300 * ms);
        ASSERT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome) << i;
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.2F, 0, 400 * ms)) << i;
    }
    bench.robot.follows = false;
    bench.robot.target_linear = 1;
    EXPECT_EQ(ROBUROC4_ERR_OTHER_COMMANDER, bench.drive_until_refused(0.2F, 0, 400 * ms));
}

TEST(OtherCommander, MayUseTheSpeedThatWeUsedBeforeALeaseWithoutASpeed) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, 300 * ms));
    bench.pause();
    ASSERT_NO_FATAL_FAILURE(bench.driving(0, 0, 5 * second));
    bench.robot.follows = false;
    bench.robot.target_linear = 1;
    EXPECT_EQ(ROBUROC4_ERR_OTHER_COMMANDER, bench.drive_until_refused(0, 0, 400 * ms));
}

TEST(OtherCommander, IsNotARobotThatDropsItsTargetsItself) {
    ScriptedRobot robot;
    robot.follows = false; /* its targets stay 0 */
    Armed bench(robot);
    robot.current_linear = 1;
    EXPECT_EQ(ROBUROC4_ERR_INHIBITED, bench.drive_until_refused(1, -1, second));
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_OTHER_COMMANDER);
}

TEST(OtherCommander, IsNotOurTargetFromBeforeThatTheRobotStillHas) {
    roburoc4_config config = default_config();
    config.robot_watchdog_ms = 100; /* what was sent earlier than this is forgotten */
    Armed bench(config);
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
    bench.robot.follows = false;
    ASSERT_NO_FATAL_FAILURE(bench.driving(-0.3F, 0, 350 * ms));
    bench.robot.follows = true;
    ASSERT_NO_FATAL_FAILURE(bench.driving(-0.3F, 0, 500 * ms));
    EXPECT_EQ(0, bench.facts().other_commander);
}

TEST(OtherCommander, IsNotASpeedOfOursThatAQueueKeptThroughLaterLeases) {
    Armed bench;
    bench.drop_to_robot = everything; /* a queue takes it all */
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 20 * ms));
    for (int i = 0; i < 8; i++) { /* together too short for a dead uplink */
        bench.pause();
        bench.run(1350 * ms);
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.01F, 0)) << i;
        bench.run(40 * ms);
    }
    bench.pause();
    bench.run(1100 * ms);
    bench.take_events();
    bench.drop_to_robot = nullptr;
    bench.robot.target_linear = 0.5F; /* now it comes */
    bench.run(500 * ms);
    EXPECT_EQ(0.0F, bench.robot.target_linear);
    EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_OTHER_COMMANDER);
}

TEST(OtherCommander, CanBeIgnored) {
    roburoc4_config config = default_config();
    config.options = ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER;
    ScriptedRobot robot;
    robot.follows = false;
    Armed bench(robot, config);
    robot.target_linear = -1;
    robot.current_linear = -1;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
    EXPECT_EQ(1, bench.facts().other_commander);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_OTHER_COMMANDER);
    EXPECT_EQ(1, bench.facts().armed);
}

TEST(OtherCommander, IsNotAScaledOrClampedTargetOfOurs) {
    roburoc4_config config = default_config();
    config.scale_linear = 1.3F;
    ScriptedRobot robot;
    robot.differential.max_linear_m_s = 1;
    Armed bench(robot, config);
    ASSERT_NO_FATAL_FAILURE(bench.driving(2, 0.5F, 3 * second));
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0.5F, 3 * second));
    EXPECT_EQ(0, bench.facts().other_commander);
}

/* ---- motion inhibited ---- */

/** It may be armed below 0.2 rad/s. */
TEST(Inhibited, IsNoRobotThatStillTurnedSlowlyWhenItWasArmed) {
    ScriptedRobot robot;
    robot.follows = false;
    Ready bench(robot);
    robot.current_angular = -0.199F;
    bench.run(100 * ms);
    ASSERT_EQ(ROBUROC4_OK, bench.arm());
    robot.target_angular = 0.3F;
    for (int i = 0; i < 80; i++) { /* overdamped, so it is slow to turn the other way */
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0, 0.3F)) << i;
        bench.run(50 * ms);
        robot.current_angular += 0.02F * (0.3F - robot.current_angular);
    }
}

/** One that takes the targets, but has a speed of its own. */
struct Disobedient : ScriptedRobot {
    void deliver(const Bytes &datagram) override {
        const float linear = current_linear;
        const float angular = current_angular;
        ScriptedRobot::deliver(datagram);
        current_linear = linear;
        current_angular = angular;
    }
};

/** One with a response of second order on each axis. */
struct Responding : Disobedient {
    float frequency, damping, gain;
    Responding(float frequency_, float damping_, float gain_, std::size_t dead_cycles)
        : frequency(frequency_), damping(damping_), gain(gain_), held(dead_cycles + 1, {0, 0}) {}
    /** A cycle of its wheels. */
    void respond() {
        held.push_back({target_linear, target_angular});
        held.pop_front();
        float *speed[2] = {&current_linear, &current_angular};
        for (std::size_t axis = 0; axis < 2; axis++)
            for (int i = 0; i < 10; i++) {
                slope[axis] += 0.001F * frequency *
                               (frequency * (gain * held.front()[axis] - *speed[axis]) -
                                2 * damping * slope[axis]);
                *speed[axis] += 0.001F * slope[axis];
            }
    }

  private:
    float slope[2] = {0, 0};
    std::deque<std::array<float, 2>> held;
};

TEST(Inhibited, DisarmsWhenTheRobotDoesNotFollow) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const struct {
        const char *what;
        float target[2], speed[2];
        std::uint64_t within_us = 1500 * ms;
    } cases[] = {
        {"it stands", {0.5F, 0}, {0, 0}},
        {"it stands at a low speed", {0.03F, 0}, {0, 0}, 4 * second},
        {"it stands and does not turn", {0, -1}, {0, 0}},
        {"it rolls backward", {0.5F, 0}, {-0.3F, 0}},
        {"it runs away", {0.1F, 0}, {2.6F, 0}},
        {"it turns, but does not drive", {0.5F, 0.5F}, {0, 0.5F}},
        {"it drives, but does not turn", {0.5F, 0.5F}, {0.5F, 0}},
        {"it turns although it should not", {0.5F, 0}, {0.5F, 0.6F}},
        {"its speed is no number", {0.5F, 0}, {nan, 0}},
        {"its turn rate is no number", {0.5F, 0}, {0.5F, nan}},
    };
    for (const auto &c : cases) {
        SCOPED_TRACE(c.what);
        Disobedient robot;
        Armed bench(robot);
        robot.current_linear = c.speed[0];
        robot.current_angular = c.speed[1];
        ASSERT_NO_FATAL_FAILURE(bench.driving(c.target[0], c.target[1], 800 * ms))
            << "a robot needs a moment to move";
        EXPECT_EQ(ROBUROC4_ERR_INHIBITED,
                  bench.drive_until_refused(c.target[0], c.target[1], c.within_us - 800 * ms));
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_INHIBITED);
        const std::uint64_t at_us = bench.now_us;
        bench.run(300 * ms);
        EXPECT_EQ(0, bench.facts().inhibited) << "no speed is commanded any more";
        EXPECT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome) << "of the targets";
        robot.current_linear = robot.current_angular = 0;
        bench.run(200 * ms);
        EXPECT_EQ(ROBUROC4_ERR_INHIBITED, bench.drive(0.5F, 0)) << "only arm() drives again";
        EXPECT_EQ(0U, bench.speeds(at_us));
        EXPECT_GE(bench.commands(at_us).size(), 3U);
        ASSERT_EQ(ROBUROC4_OK, bench.arm());
        ASSERT_NO_FATAL_FAILURE(bench.driving(c.target[0], c.target[1], 800 * ms))
            << "it has its moment again";
    }
}

TEST(Inhibited, IsNoticedThroughNoise) {
    for (const std::uint32_t seed : {20261124U, 7U, 8U, 9U}) {
        SCOPED_TRACE(seed);
        std::uint32_t random = seed;
        Disobedient robot;
        Armed bench(robot);
        int steps = 0;
        roburoc4_result result = ROBUROC4_OK;
        while (result == ROBUROC4_OK && steps++ < 200) {
            random = random * 1664525U + 1013904223U;
            robot.current_linear =
                0.02F * (static_cast<float>(random >> 8) / static_cast<float>(1 << 23) - 1);
            result = bench.drive_until_refused(0.1F, 0, 50 * ms);
        }
        EXPECT_EQ(ROBUROC4_ERR_INHIBITED, result);
        EXPECT_LT(steps, 60) << "in steps of 50 ms";
    }
}

/** One that takes the targets, and moves only with motor power. */
struct Unpowered : ScriptedRobot {
    bool power = true;
    void deliver(const Bytes &datagram) override {
        ScriptedRobot::deliver(datagram);
        if (!power) {
            current_linear = current_angular = 0;
        }
    }
};

/** Else it would start to move when motor power returns. */
TEST(Inhibited, IsNoticedHoweverTheTargetsAlternate) {
    const struct {
        const char *what;
        float target[2], then[2];
        std::uint64_t span_us, then_us;
    } cases[] = {
        {"to and fro", {1, 0}, {-1, 0}, 2500 * ms, 2500 * ms},
        {"to and fro, slowly", {0.3F, 0}, {-0.3F, 0}, 1200 * ms, 1200 * ms},
        {"left and right", {0, 1}, {0, -1}, 2 * second, 2 * second},
        {"in pulses", {1, 0}, {0, 0}, second, 500 * ms},
        {"in short pulses", {0.3F, 0}, {0, 0}, 600 * ms, 300 * ms},
    };
    for (const auto &c : cases)
        for (const bool moved : {false, true}) {
            SCOPED_TRACE(testing::Message() << c.what << (moved ? ", after it moved" : ""));
            Unpowered robot;
            robot.power = moved;
            Armed bench(robot);
            std::uint64_t begun_us = bench.now_us;
            roburoc4_result result = ROBUROC4_OK;
            while (result == ROBUROC4_OK && bench.now_us - begun_us < 20 * second) {
                const bool first = (bench.now_us - begun_us) % (c.span_us + c.then_us) < c.span_us;
                const float *target = first ? c.target : c.then;
                robot.power = moved && bench.now_us - begun_us < 6 * second;
                if (target[0] != 0 || target[1] != 0)
                    result = bench.drive(target[0], target[1]);
                else
                    bench.pause();
                bench.run(50 * ms);
            }
            EXPECT_EQ(ROBUROC4_ERR_INHIBITED, result);
            EXPECT_LT(bench.now_us - begun_us, (moved ? 6 : 0) * second + 5 * second);
        }
}

TEST(Inhibited, IsNoticedAsSoonForwardAsBackward) {
    for (const bool moved : {false, true}) {
        std::uint64_t noticed_us[2] = {0, 0};
        for (const bool backward : {false, true}) {
            Unpowered robot;
            robot.power = moved;
            Armed bench(robot);
            const float target = (moved ? 0.15F : 0.5F) * (backward ? -1.0F : 1.0F);
            ASSERT_NO_FATAL_FAILURE(bench.driving(-target, 0, moved ? 5 * second : 800 * ms));
            robot.power = false;
            const std::uint64_t begun_us = bench.now_us;
            EXPECT_EQ(ROBUROC4_ERR_INHIBITED, bench.drive_until_refused(target, 0, 7 * second));
            noticed_us[backward ? 1 : 0] = bench.now_us - begun_us;
        }
        EXPECT_EQ(noticed_us[0], noticed_us[1]) << moved;
    }
}

TEST(Inhibited, IsNotEndedByAMomentOfMotion) {
    Disobedient robot;
    Ready bench(robot);
    robot.target_linear = 0.5F; /* another commander's */
    bench.run(2 * second);
    ASSERT_EQ(1, bench.facts().inhibited);
    bench.take_events();
    robot.current_linear = 0.5F;
    bench.run(800 * ms);
    EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_INHIBITED);
    bench.run(second);
    EXPECT_EQ(0, bench.facts().inhibited);
}

TEST(Inhibited, IsNoRobotTooSlowForTargetsThatAlternate) {
    for (const std::uint64_t span_us : {200 * ms, 500 * ms, 1500 * ms}) {
        SCOPED_TRACE(span_us);
        Responding robot(1.5F, 1.2F, 1, 15);
        Armed bench(robot);
        for (int cycle = 0; cycle < 2000; cycle++) {
            const float sign =
                static_cast<std::uint64_t>(cycle) * 10 * ms / span_us % 2 == 0 ? 1 : -1;
            if (cycle % 5 == 0) {
                ASSERT_EQ(ROBUROC4_OK, bench.drive(sign * 0.3F, sign * -0.5F)) << cycle;
            }
            bench.run(10 * ms);
            robot.respond();
        }
    }
}

TEST(Inhibited, IsNoRobotWhoseTargetsAlternateUnevenly) {
    Drawn drawn;
    for (int i = 0; i < 60; i++) {
        const float there[2] = {static_cast<float>(drawn.between(0.1, 0.4)),
                                static_cast<float>(drawn.between(0.2, 0.8))};
        const auto share = static_cast<float>(drawn.between(0.8, 1));
        const auto cycles = static_cast<int>(drawn.between(10, 60));
        SCOPED_TRACE(testing::Message() << there[0] << " m/s, " << there[1] << " rad/s, back by "
                                        << share << ", each " << cycles << " cycles");
        Responding robot(static_cast<float>(drawn.between(1.5, 4)), 0.79F, 1, 0);
        Armed bench(robot);
        for (int cycle = 0; cycle < 1000; cycle++) {
            const float part = cycle / cycles % 2 == 0 ? 1 : -share;
            if (cycle % 5 == 0) {
                ASSERT_EQ(ROBUROC4_OK, bench.drive(part * there[0], part * there[1])) << cycle;
            }
            bench.run(10 * ms);
            robot.respond();
        }
    }
}

/** A second-order response, as slow, as fast and as far off as the family allows. */
TEST(Inhibited, IsNoRobotThatRespondsInItsOwnWay) {
    const float steps[][2] = {{1, 0},        {-1, 0.5F},  {0.1F, -1.5F},    {0.1F, 0}, {1, 1.5F},
                              {0.02F, 0.1F}, {-1, -1.5F}, {-0.04F, -0.05F}, {0, 0},    {0.05F, 0}};
    for (const float frequency : {1.5F, 2.46F, 8.0F, 40.0F})
        for (const float damping : {0.6F, 0.79F, 1.5F})
            for (const float gain : {0.85F, 1.15F})
                for (const std::size_t dead : {0U, 15U}) {
                    SCOPED_TRACE(testing::Message()
                                 << "frequency " << frequency << ", damping " << damping
                                 << ", gain " << gain << ", dead time " << dead << " cycles");
                    Responding robot(frequency, damping, gain, dead);
                    Armed bench(robot);
                    for (const auto &step : steps) {
                        for (int cycle = 0; cycle < 300; cycle++) {
                            if (cycle % 5 == 0) {
                                ASSERT_EQ(ROBUROC4_OK, bench.drive(step[0], step[1])) << cycle;
                            }
                            bench.run(10 * ms);
                            robot.respond();
                        }
                    }
                }
}

/** Each speed comes and goes between two statuses. */
TEST(Inhibited, IsNoRobotWithTargetsThatNoStatusShows) {
    Responding robot(2.64F, 0.69F, 1.1F, 9);
    robot.forced_period = 16;
    Armed bench(robot);
    for (int cycle = 0; cycle < 1000; cycle++) {
        const bool turns = robot.cycles() % 16 >= 2 && robot.cycles() % 16 < 8;
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0, turns ? 1.5F : 0)) << cycle;
        bench.run(10 * ms);
        robot.respond();
    }
}

/** It seems to be at rest for a moment, and goes on in the other direction. */
TEST(Inhibited, IsNoRobotThatIsArmedAgainWhileItChangesItsDirection) {
    Disobedient robot;
    Armed bench(robot);
    float slope = 0;
    const auto roll = [&](int cycles, float target) {
        for (int cycle = 0; cycle < cycles; cycle++) {
            if (cycle % 5 == 0 && target != 0) {
                ASSERT_EQ(ROBUROC4_OK, bench.drive(target, 0)) << cycle;
            }
            bench.run(10 * ms);
            for (int i = 0; i < 10; i++) {
                slope += 0.001F * 2.08F *
                         (2.08F * (robot.target_linear - robot.current_linear) - 1.3F * slope);
                robot.current_linear += 0.001F * slope;
            }
        }
    };
    ASSERT_NO_FATAL_FAILURE(roll(300, 0.66F));
    ASSERT_NO_FATAL_FAILURE(roll(60, -0.86F));
    EXPECT_EQ(ROBUROC4_OK, bench.stop());
    ASSERT_NO_FATAL_FAILURE(roll(5, 0));
    ASSERT_LT(std::fabs(robot.current_linear), 0.1F);
    ASSERT_EQ(ROBUROC4_OK, bench.arm());
    ASSERT_NO_FATAL_FAILURE(roll(300, 0.3F));
}

TEST(Inhibited, IsNotReportedWhenTheTargetIsNotFinite) {
    for (const bool turning : {false, true}) {
        ScriptedRobot robot;
        robot.follows = false;
        Ready bench(robot);
        (turning ? robot.target_angular : robot.target_linear) =
            std::numeric_limits<float>::quiet_NaN();
        bench.run(2 * second);
        EXPECT_EQ(0, bench.facts().inhibited) << "nobody knows whether it should move";
        EXPECT_EQ(1, bench.facts().other_commander);
    }
}

TEST(Inhibited, DisarmsWhereTheRobotDropsTheTargetItself) {
    ScriptedRobot robot;
    robot.follows = false; /* target and speed stay 0 */
    Armed bench(robot);
    EXPECT_EQ(ROBUROC4_ERR_INHIBITED, bench.drive_until_refused(0.5F, 0, second));
}

/** Where no echo is waited for, its speeds alone show that it stands. */
TEST(Inhibited, EndsWithAnEventWhenArmedAgainAtOnce) {
    roburoc4_config config = default_config();
    config.options = ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER;
    ScriptedRobot robot;
    robot.follows = false;
    Armed bench(robot, config);
    bool inhibited = false;
    while (bench.facts().armed == 1) {
        bench.drive(0.5F, 0);
        inhibited = bench.run_until([&] { return bench.facts().inhibited == 1; }, 50 * ms);
    }
    ASSERT_TRUE(inhibited);
    bench.take_events();
    ASSERT_EQ(ROBUROC4_OK, bench.arm());
    EXPECT_EQ(0, bench.facts().inhibited);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_INHIBITED);
}

TEST(Inhibited, DisarmsAgainWhenArmedAgainAtOnce) {
    ScriptedRobot robot;
    robot.follows = false;
    Armed bench(robot);
    EXPECT_EQ(ROBUROC4_ERR_INHIBITED, bench.drive_until_refused(0.5F, 0, second));
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
    robot.target_linear = 0.5F; /* the command from before arrives late */
    EXPECT_EQ(ROBUROC4_ERR_INHIBITED, bench.drive_until_refused(0.5F, 0, 3 * second));
}

TEST(Inhibited, IsNotReportedWhenItMovesOrHasNoTarget) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0.5F, 3 * second));
    ASSERT_NO_FATAL_FAILURE(bench.driving(0, 0, 3 * second));
    bench.run(3 * second);
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_INHIBITED);
}

TEST(Inhibited, IsNoRobotOfWhichStatusesWereLost) {
    roburoc4_config config = default_config();
    config.fresh_ms = 1000;
    Armed bench(config);
    for (const std::uint64_t gap_us : {300 * ms, 500 * ms, 800 * ms}) {
        SCOPED_TRACE(gap_us);
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.2F, -0.2F, second));
        bench.robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = true;
        ASSERT_NO_FATAL_FAILURE(bench.driving(1, 1, gap_us));
        bench.robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = false;
        ASSERT_NO_FATAL_FAILURE(bench.driving(1, 1, 2 * second));
    }
}

TEST(Inhibited, IsNotARobotWhoseTargetIsNearlyZero) {
    for (const bool turning : {false, true}) {
        ScriptedRobot robot;
        robot.follows = false;
        Ready bench(robot);
        (turning ? robot.target_angular : robot.target_linear) = 0.0009F;
        bench.run(2 * second);
        EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_INHIBITED);
        EXPECT_EQ(ROBUROC4_OK, bench.arm());
    }
}

/* ---- override ---- */

TEST(Override, IsAnEventOnBothEdges) {
    Ready bench;
    EXPECT_EQ(1, bench.facts().override_known);
    EXPECT_EQ(0, bench.facts().overridden);
    bench.robot.press(ROBUROC4_DI_PAD_A);
    bench.run(60 * ms);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_OVERRIDE);
    EXPECT_EQ(1, bench.facts().overridden);
    bench.run(second);
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_OVERRIDE);
    bench.robot.press(ROBUROC4_DI_PAD_A, false);
    bench.run(60 * ms);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_OVERRIDE);
    EXPECT_EQ(0, bench.facts().overridden);
}

TEST(Override, IsAnEventWhenItIsKnownAgainAndStillPressed) {
    Ready bench;
    bench.robot.press(ROBUROC4_DI_PAD_A);
    bench.run(60 * ms);
    ASSERT_EQ(1, bench.facts().overridden);
    for (const bool pressed : {true, false}) {
        bench.robot.press(ROBUROC4_DI_PAD_A, pressed);
        ASSERT_EQ(ROBUROC4_OK,
                  roburoc4_client_set_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE,
                                                 ROBUROC4_DI_PAD_A, bench.client_us()));
        EXPECT_EQ(0, bench.facts().overridden) << "for all that is known";
        bench.take_events();
        bench.run(60 * ms);
        EXPECT_EQ(pressed, bench.facts().overridden == 1);
        EXPECT_EQ(pressed, (bench.take_events() & ROBUROC4_EVENT_OVERRIDE) != 0);
    }
}

TEST(Override, IsNoEventWhileItIsUnknown) {
    ScriptedRobot robot;
    robot.iocard.digital_inputs = 4;
    robot.digital = 0xF;
    robot.texts_refused = true;
    Started bench(robot);
    bench.run(3 * second);
    EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_OVERRIDE);
    EXPECT_EQ(0, bench.facts().override_known);
    EXPECT_EQ(0, bench.facts().overridden);
}

TEST(Override, SendsNoSpeedAfterTheStatusThatShowedIt) {
    for (int offset = 0; offset < 60; offset += 7) {
        Armed bench;
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
        bench.run(static_cast<std::uint64_t>(offset) * ms);
        bench.drive(0.6F, 0, 1000000);
        bench.robot.press(ROBUROC4_DI_PAD_A);
        bench.receive(bench.robot.status_at(2, bench.robot.cycles() + 1));
        const std::size_t before = bench.sent.size();
        bench.run(3 * second);
        for (std::size_t i = before; i < bench.sent.size(); i++) {
            Command c{};
            if (Bench::as_command(bench.sent[i], &c)) {
                EXPECT_TRUE(c.zero());
            }
        }
    }
}
