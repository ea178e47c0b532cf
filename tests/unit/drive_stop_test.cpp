/* SPDX-License-Identifier: MIT
 *
 * Every exit from driving is followed by a stop sequence of zero commands: before all other
 * traffic, one per period, at least three, until the robot shows that it obeys or its watchdog must
 * have tripped.
 */
#include <algorithm>
#include <cmath>

#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

using Exit = std::pair<const char *, std::function<void(Bench &, ScriptedRobot &)>>;

const std::vector<Exit> exits{{"lease over", [](Bench &b, ScriptedRobot &) { b.run(251 * ms); }},
                              {"pause", [](Bench &b, ScriptedRobot &) { b.pause(); }},
                              {"stop", [](Bench &b, ScriptedRobot &) { b.stop(); }},
                              {"close", [](Bench &b, ScriptedRobot &) { b.close(); }},
                              {"override",
                               [](Bench &b, ScriptedRobot &r) {
                                   r.press(ROBUROC4_DI_PAD_A);
                                   b.receive(r.status_at(2, r.cycles() + 1));
                               }},
                              {"reboot",
                               [](Bench &b, ScriptedRobot &r) {
                                   for (std::uint64_t i = 0; i < 3; i++)
                                       b.receive(r.status_at(6, r.cycles() - 500 + i));
                               }},
                              {"clock", [](Bench &b, ScriptedRobot &) { b.skew_us -= 5000; }},
                              {"stale",
                               [](Bench &b, ScriptedRobot &r) {
                                   r.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = true;
                                   b.run(251 * ms);
                               }},
                              {"another commander",
                               [](Bench &b, ScriptedRobot &r) {
                                   r.target_linear = -1;
                                   for (std::uint64_t i = 1; i < 4; i++)
                                       b.receive(r.status_at(6, r.cycles() + i));
                               }},
                              {"role", [](Bench &b, ScriptedRobot &) {
                                   roburoc4_client_set_role_index(&b.client, ROBUROC4_ROLE_OVERRIDE,
                                                                  5, b.client_us());
                               }}};

/** Zeros since then, each a period after the one before. */
std::size_t expect_train(const Bench &bench, std::uint64_t since_us, std::uint64_t period_us) {
    const auto commands = bench.commands(since_us);
    for (std::size_t i = 0; i < commands.size(); i++) {
        EXPECT_TRUE(commands[i].zero()) << i;
        if (i > 0) {
            EXPECT_EQ(period_us, commands[i].at_us - commands[i - 1].at_us) << i;
        }
    }
    return commands.size();
}

/** The last stop sequence ended so, and exactly one event says it. */
void expect_outcome(Bench &bench, std::uint8_t outcome) {
    EXPECT_EQ(outcome, bench.facts().stop_outcome);
    EXPECT_EQ(outcome == ROBUROC4_STOP_CONFIRMED ? ROBUROC4_EVENT_STOP_CONFIRMED
                                                 : ROBUROC4_EVENT_STOP_UNCONFIRMED,
              bench.take_events() &
                  (ROBUROC4_EVENT_STOP_CONFIRMED | ROBUROC4_EVENT_STOP_UNCONFIRMED));
}

} // namespace

TEST(StopSequence, FollowsEveryExitFromDriving) {
    for (const Exit &exit : exits) {
        SCOPED_TRACE(exit.first);
        Armed bench;
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0.5F, 500 * ms));
        bench.now_us++;
        bench.sent.clear();
        exit.second(bench, bench.robot);
        bench.pump();
        EXPECT_EQ(0, bench.facts().driving);
        EXPECT_EQ(1, bench.facts().stopping);
        std::size_t first = 0;
        Command c{};
        while (first < bench.sent.size() && !(Bench::as_command(bench.sent[first], &c) && c.zero()))
            first++;
        ASSERT_LT(first, bench.sent.size()) << "a zero left at once";
        const std::uint64_t since_us = bench.sent[first].at_us;
        bench.run(3 * second);
        const std::size_t zeros = expect_train(bench, since_us, 50 * ms);
        EXPECT_GE(zeros, 3U);
        EXPECT_LE(zeros, 22U);
        EXPECT_EQ(0, bench.facts().stopping);
        const std::string name = exit.first;
        expect_outcome(bench, name == "stale"      ? ROBUROC4_STOP_TIMED_OUT
                              : name == "override" ? ROBUROC4_STOP_OVERRIDDEN
                                                   : ROBUROC4_STOP_CONFIRMED);
        EXPECT_EQ(0.0F, bench.facts().sent_linear_m_s);
        EXPECT_EQ(0.0F, bench.facts().sent_angular_rad_s);
    }
}

TEST(StopSequence, FollowsLoss) {
    roburoc4_config config = default_config();
    config.fresh_ms = 1000;
    config.lost_ms = 200;
    Armed bench(config);
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    bench.robot.powered = false;
    while (bench.state() == ROBUROC4_STATE_READY) {
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0));
        bench.run(10 * ms);
    }
    EXPECT_EQ(ROBUROC4_ERR_LOST, bench.facts().disarm_cause);
    const std::uint64_t lost_us = bench.now_us - 10 * ms;
    bench.run(5 * second);
    EXPECT_EQ(0U, bench.speeds(lost_us + 10 * ms));
    EXPECT_NEAR(20, static_cast<double>(bench.commands(lost_us).size()), 2)
        << "until the robot's watchdog must have tripped";
}

TEST(StopSequence, ContinuesWhileTheSameRobotIsDiscoveredAgain) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    bench.drop_to_client = everything;
    while (bench.state() == ROBUROC4_STATE_READY) {
        bench.drive(0.5F, 0);
        bench.run(10 * ms);
    }
    bench.drop_to_client = nullptr;
    bench.robot.subscriptions.clear();
    bench.robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).get_silent = true;
    bench.pause();
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_DISCOVERING));
    const std::uint64_t found_us = bench.now_us;
    bench.run(200 * ms);
    EXPECT_GE(bench.commands(found_us).size(), 3U);
}

TEST(StopSequence, GoesBeforeAllOtherTraffic) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    bench.run(60 * ms);
    bench.sent.clear();
    ASSERT_EQ(ROBUROC4_OK, set_digital_output(&bench.client, 1, 1, bench.client_us()));
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_relocalize(&bench.client, 1, 2, 3, bench.client_us()));
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_subscribe(&bench.client, 3, 50, bench.client_us()));
    bench.pause();
    bench.pump();
    ASSERT_GE(bench.sent.size(), 4U);
    Command c{};
    ASSERT_TRUE(Bench::as_command(bench.sent[0], &c));
    EXPECT_TRUE(c.zero());
    bench.now_us += 50 * ms;
    bench.sent.clear();
    ASSERT_EQ(ROBUROC4_OK, set_digital_output(&bench.client, 1, 0, bench.client_us()));
    ASSERT_TRUE(bench.poll());
    EXPECT_TRUE(Bench::as_command(bench.sent[0], &c)) << "its second zero too";
}

TEST(StopSequence, EndsOnALaterStatusWithBothTargetsZero) {
    ScriptedRobot robot;
    robot.follows = false;
    Armed bench(robot);
    bench.drive(0.5F, 0.5F);
    bench.pump();
    robot.target_linear = 0.5F;
    robot.target_angular = 0.5F;
    bench.run(101 * ms);
    const std::uint64_t start_us = bench.now_us;
    bench.pause();
    bench.run(400 * ms);
    EXPECT_EQ(1, bench.facts().stopping);
    robot.target_linear = 0.0009F; /* rounding is no motion */
    bench.run(200 * ms);
    EXPECT_EQ(1, bench.facts().stopping) << "one target is not zero yet";
    robot.target_angular = -0.0009F;
    bench.run(60 * ms);
    EXPECT_EQ(0, bench.facts().stopping);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_STOP_CONFIRMED);
    const std::size_t zeros = expect_train(bench, start_us, 50 * ms);
    EXPECT_GE(zeros, 12U);
    EXPECT_LE(zeros, 15U);
}

TEST(StopSequence, IsNotEndedByAStatusBeforeItsThirdZero) {
    ScriptedRobot robot;
    robot.follows = false;
    Armed bench(robot);
    bench.drive(0.5F, 0);
    bench.pump();
    const std::uint64_t start_us = bench.now_us;
    bench.pause();
    for (std::uint64_t i = 1; i < 8; i++) {
        bench.run(10 * ms);
        bench.receive(robot.status_at(6, robot.cycles() + 1));
    }
    EXPECT_EQ(1, bench.facts().stopping);
    bench.run(second);
    EXPECT_GE(expect_train(bench, start_us + 1, 50 * ms) + 1, 3U);
}

TEST(StopSequence, IsNotEndedByTheConfirmationOfTheOneBefore) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    bench.pause();
    bench.run(second);
    expect_outcome(bench, ROBUROC4_STOP_CONFIRMED);
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    bench.robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = true;
    const std::uint64_t start_us = bench.now_us;
    bench.pause();
    bench.take_events();
    ASSERT_TRUE(bench.run_until([&] { return bench.facts().stopping == 0; }));
    EXPECT_EQ(start_us + second, bench.now_us) << "the robot's watchdog";
    expect_outcome(bench, ROBUROC4_STOP_TIMED_OUT);
}

TEST(StopSequence, EndsWhenTheRobotsWatchdogHasTripped) {
    for (const std::uint32_t watchdog_ms : {100U, 1023U, 3000U, 15000U, 1000U}) {
        roburoc4_config config = default_config();
        config.robot_watchdog_ms = watchdog_ms;
        Armed bench(config);
        bench.drive(0.5F, 0);
        bench.run(30 * ms);
        bench.robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = true; /* nothing can confirm it */
        const std::uint64_t start_us = bench.now_us;
        bench.pause();
        bench.take_events();
        ASSERT_TRUE(bench.run_until([&] { return bench.facts().stopping == 0; }));
        EXPECT_EQ(start_us + watchdog_ms * ms, bench.now_us);
        expect_outcome(bench, ROBUROC4_STOP_TIMED_OUT);
        bench.run(6 * second);
        const std::size_t wanted = std::max<std::size_t>(3, watchdog_ms / 50);
        const std::size_t zeros = expect_train(bench, start_us, 50 * ms);
        EXPECT_GE(zeros, wanted);
        EXPECT_LE(zeros, wanted + 1);
        EXPECT_EQ(0, bench.facts().stopping);
    }
}

TEST(StopSequence, HasTheConfiguredPeriod) {
    roburoc4_config config = default_config();
    config.drive_period_ms = 20;
    Armed bench(config);
    bench.drive(0.5F, 0);
    bench.pump();
    bench.run(5 * ms);
    const std::uint64_t start_us = bench.now_us;
    bench.stop();
    bench.run(second);
    EXPECT_GE(expect_train(bench, start_us, 20 * ms), 3U);
}

TEST(StopSequence, IsNeverSentByAMonitor) {
    ScriptedRobot robot;
    Ready bench(robot);
    robot.press(ROBUROC4_DI_PAD_A);
    bench.run(second);
    robot.press(ROBUROC4_DI_PAD_A, false);
    bench.run(second);
    bench.skew_us -= 5000;
    bench.run(second);
    robot.powered = false;
    bench.run(3 * second);
    robot.reboot();
    robot.powered = true;
    bench.run(5 * second);
    robot.target_linear = robot.current_linear = 0.5F;
    bench.run(second);
    bench.close();
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_IDLE), bench.state()) << "nothing is due";
    EXPECT_EQ(0U, bench.commands().size());
}

TEST(StopSequence, DoesNotFollowAnAutomaticDisarmAfterOnlyArmingOrDrivingAtZero) {
    Armed bench;
    bench.robot.press(ROBUROC4_DI_PAD_A);
    bench.run(second);
    bench.robot.press(ROBUROC4_DI_PAD_A, false);
    bench.run(second);
    EXPECT_EQ(0U, bench.commands().size());
    ASSERT_EQ(ROBUROC4_OK, bench.arm());
    bench.drive(0, 0);
    bench.run(200 * ms);
    const std::size_t before = bench.commands().size();
    EXPECT_EQ(5U, before);
    bench.robot.press(ROBUROC4_DI_PAD_A);
    bench.run(second);
    EXPECT_EQ(before, bench.commands().size());
}

TEST(StopSequence, IsSentOnceForEachDrive) {
    Armed bench;
    bench.drive(0.5F, 0);
    bench.run(3 * second);
    const std::size_t before = bench.commands().size();
    bench.robot.press(ROBUROC4_DI_PAD_A);
    bench.run(second);
    EXPECT_EQ(before, bench.commands().size());
}

/* ---- stop and pause ---- */

TEST(Stop, AlwaysSendsZeros) {
    Ready bench;
    for (int i = 0; i < 4; i++) {
        const std::uint64_t start_us = bench.now_us;
        ASSERT_EQ(ROBUROC4_OK, i % 2 == 0 ? bench.stop() : bench.pause());
        EXPECT_EQ(ROBUROC4_ERR_STOP_CALLED, bench.facts().disarm_cause)
            << "though it was not armed";
        EXPECT_EQ(1, bench.facts().stopping);
        bench.run(second);
        EXPECT_GE(expect_train(bench, start_us, 50 * ms), 3U);
        EXPECT_EQ(0, bench.facts().stopping);
    }
}

TEST(Stop, BeforeDiscoveryIsLatchedUntilTheServiceIsKnown) {
    ScriptedRobot robot;
    robot.powered = false;
    Started bench(robot);
    ASSERT_EQ(ROBUROC4_OK, bench.stop());
    bench.run(5 * second);
    EXPECT_EQ(1, bench.facts().stopping);
    EXPECT_EQ(0U, bench.commands().size());
    robot.powered = true;
    ASSERT_TRUE(bench.run_until([&] { return !bench.commands().empty(); }, 3 * second));
    const auto gets = robot.seen(ROBUROC4_ACTION_GET, 6);
    ASSERT_FALSE(gets.empty());
    EXPECT_EQ(gets.back().at_us, bench.commands()[0].at_us) << "as soon as it is known";
    bench.run(3 * second);
    EXPECT_GE(expect_train(bench, 0, 50 * ms), 3U);
    EXPECT_EQ(0, bench.facts().stopping);
}

TEST(Stop, LatchesUntilTheNextArm) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    bench.run(1 * ms);
    bench.take_events();
    const std::uint64_t stop_us = bench.now_us;
    ASSERT_EQ(ROBUROC4_OK, bench.stop());
    EXPECT_EQ(0, bench.facts().armed);
    EXPECT_EQ(0, bench.facts().driving);
    EXPECT_EQ(ROBUROC4_ERR_STOP_CALLED, bench.facts().disarm_cause);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_DISARMED);
    bench.pump();
    ASSERT_FALSE(bench.commands(stop_us).empty());
    EXPECT_TRUE(bench.commands(stop_us)[0].zero()) << "at once";
    for (int i = 0; i < 40; i++) { /* the program's own loop knows nothing of the stop button */
        EXPECT_EQ(ROBUROC4_ERR_STOP_CALLED, bench.drive(0.5F, 0)) << i;
        bench.run(50 * ms);
    }
    EXPECT_EQ(0U, bench.speeds(stop_us));
    EXPECT_EQ(ROBUROC4_OK, bench.stop()) << "again";
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_DISARMED);
    EXPECT_EQ(ROBUROC4_ERR_STOP_CALLED, bench.facts().disarm_cause);
    bench.run(second);
    ASSERT_EQ(ROBUROC4_OK, bench.arm());
    EXPECT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0));
}

TEST(Stop, OfAClientThatIsIdleOrClosingChangesNothing) {
    RobotBench bench;
    const auto expect_nothing = [&](roburoc4_result cause) {
        const roburoc4_client before = bench.client;
        EXPECT_EQ(ROBUROC4_ERR_STATE, bench.stop());
        EXPECT_EQ(ROBUROC4_ERR_STATE, bench.pause());
        EXPECT_EQ(0, memcmp(&before, &bench.client, sizeof before));
        EXPECT_EQ(cause, bench.facts().disarm_cause);
    };
    expect_nothing(ROBUROC4_ERR_DISARMED);
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    bench.robot.press(ROBUROC4_DI_PAD_A);
    bench.run(100 * ms);
    ASSERT_EQ(ROBUROC4_OK, bench.close());
    ASSERT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_CLOSING), bench.state());
    expect_nothing(ROBUROC4_ERR_OVERRIDE); /* the error that led there is not hidden */
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_IDLE));
    expect_nothing(ROBUROC4_ERR_OVERRIDE);
}

TEST(Pause, KeepsTheArming) {
    Armed bench;
    bench.drive(0.5F, 0);
    bench.pump();
    bench.pause();
    EXPECT_EQ(1, bench.facts().armed);
    EXPECT_EQ(0, bench.facts().driving);
    EXPECT_EQ(0, bench.facts().lapsed);
    bench.run(60 * second);
    EXPECT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0));
    bench.pump();
    EXPECT_EQ(0.5F, bench.commands().back().linear);
}

TEST(Pause, CalledRepeatedlyStillKeepsItsPeriodAndStops) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    bench.run(1 * ms);
    const std::uint64_t start_us = bench.now_us;
    for (int i = 0; i < 1000; i++) {
        bench.pause();
        bench.run(1 * ms);
    }
    EXPECT_EQ(0.0F, bench.robot.target_linear);
    const auto commands = bench.commands(start_us);
    EXPECT_LE(commands.size(), 101U) << "at most one in a cycle of the robot";
}

/* ---- a lease that meets a stop sequence ---- */

TEST(StopSequence, NewLeaseWaitsForThreeZeros) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    bench.run(1 * ms);
    const std::uint64_t start_us = bench.now_us;
    bench.pause();
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.75F, 0, 1000000));
    EXPECT_EQ(1, bench.facts().driving);
    bench.run(second);
    const auto commands = bench.commands(start_us);
    ASSERT_GE(commands.size(), 4U);
    for (std::size_t i = 0; i < 3; i++)
        EXPECT_TRUE(commands[i].zero()) << i;
    EXPECT_GT(bench.speeds(start_us), 5U);
    for (std::size_t i = 1; i < commands.size(); i++) {
        if (!commands[i].zero()) {
            EXPECT_GE(commands[i].at_us - commands[i - 1].at_us, 10 * ms);
        }
    }
}

TEST(StopSequence, LeaseThatEndsWhileItWaitsSendsNoSpeed) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    bench.run(1 * ms);
    const std::uint64_t start_us = bench.now_us;
    bench.pause();
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.75F, 0, 90000));
    bench.run(3 * second);
    EXPECT_EQ(0U, bench.speeds(start_us));
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_LAPSED);
}

TEST(Close, SendsItsZerosThenIsIdle) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    const std::uint64_t start_us = bench.now_us;
    ASSERT_EQ(ROBUROC4_OK, bench.close());
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_CLOSING), bench.state());
    EXPECT_EQ(ROBUROC4_ERR_DISARMED, bench.drive(0.5F, 0));
    EXPECT_EQ(ROBUROC4_ERR_NOT_READY, bench.arm());
    EXPECT_EQ(ROBUROC4_ERR_STATE, bench.pause());
    EXPECT_EQ(ROBUROC4_ERR_STATE, roburoc4_client_start(&bench.client, bench.client_us()));
    bench.run(400 * ms);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_IDLE), bench.state());
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_STOP_CONFIRMED);
    EXPECT_EQ(bench.commands(start_us).size() + 1,
              static_cast<std::size_t>(
                  std::count_if(bench.sent.begin(), bench.sent.end(),
                                [&](const Bench::Datagram &d) { return d.at_us >= start_us; })))
        << "one request shows that the zeros arrived, and nothing else is sent";
    EXPECT_TRUE(bench.robot.seen(ROBUROC4_ACTION_DELETE).empty()) << "subscriptions are left alone";
    EXPECT_EQ(0.0F, bench.robot.target_linear);
}

TEST(Close, TakesAtMostTheRobotsWatchdog) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    bench.robot.powered = false;
    ASSERT_EQ(ROBUROC4_OK, bench.close());
    bench.run(1000 * ms);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_IDLE), bench.state());
}
