/* SPDX-License-Identifier: MIT
 *
 * When the client believes that the robot restarted, on robots that answer the
 * manual's open questions in other ways than the simulator (docs/PROTOCOL.md, the family).
 */
#include <gtest/gtest.h>

#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

/** Another input is the game pad's [A] now. */
void move_pad_a(ScriptedRobot &robot) {
    robot.channel_text = [](std::uint32_t, std::uint32_t index) {
        return index == 20 ? "Game pad A" : "spare";
    };
}

void expect_moved_pad_a(Bench &bench) {
    EXPECT_EQ(20, roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE));
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

} // namespace

TEST(Restart, InAnOutageIsNoticedWhateverItsClockShows) {
    for (const std::uint64_t up_s : {1U, 20U, 60U, 3600U, 1000000U}) {
        SCOPED_TRACE(up_s);
        ScriptedRobot robot;
        Bench bench(robot);
        robot.set_cycles(1200);
        bench.ready();
        ASSERT_EQ(ROBUROC4_OK,
                  roburoc4_client_set_digital_outputs(&bench.client, 2, 2, bench.client_us()));
        bench.run(second);
        robot.powered = false;
        bench.run(30 * second);
        robot.reboot();
        robot.set_cycles(up_s * 100);
        robot.powered = true;
        robot.output_commands.clear();
        bench.run(10 * second);
        EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_REBOOTS));
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_REBOOT);
        EXPECT_EQ(ROBUROC4_OK,
                  roburoc4_client_set_digital_outputs(&bench.client, 4, 4, bench.client_us()));
        bench.run(second);
        ASSERT_FALSE(robot.output_commands.empty());
        EXPECT_EQ(4, robot.output_commands.back().second.back()) << "nothing from before";
    }
}

TEST(Restart, IsNotReportedOfTheSameRobotAfterAnOutage) {
    for (const std::uint64_t outage_s : {2U, 30U, 3600U}) {
        Ready bench;
        bench.robot.powered = false;
        bench.run(outage_s * second);
        bench.robot.powered = true;
        bench.run(10 * second);
        EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_REBOOTS)) << outage_s;
        EXPECT_EQ(ROBUROC4_OK, bench.arm()) << outage_s;
    }
}

/** Nothing of what was read then tells which start it was of. */
TEST(Restart, IsAssumedOfARobotThatWasLostBeforeItsFirstStatus) {
    ScriptedRobot robot;
    robot.remove(ROBUROC4_SERVICE_BATTERY);
    Bench bench(robot);
    const auto mute = [&robot](bool muted) {
        for (ScriptedService &service : robot.services)
            service.mute = muted;
    };
    mute(true);
    bench.start();
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    bench.run(100 * ms);
    robot.powered = false;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    robot.reboot();
    move_pad_a(robot);
    robot.powered = true;
    mute(false);
    bench.run(10 * second);
    expect_moved_pad_a(bench);
}

/** What was overheard before the subscriptions dates nothing: no request proved its age. */
TEST(Restart, IsAssumedOfARobotThatWasLostBeforeAStatusThatCounted) {
    ScriptedRobot robot;
    Ready bench(robot);
    const auto subscriptions = robot.subscriptions; /* some robots keep them */
    robot.reboot();
    robot.subscriptions = subscriptions;
    const auto lost = [&bench](const Bytes &bytes) {
        return bench.state() == ROBUROC4_STATE_READY && is_status(bytes);
    };
    bench.delay_to_client = [] { return 5 * ms; };
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_SUBSCRIBING));
    bench.drop_to_client = lost;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    bench.run(20 * ms);
    robot.powered = false;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    const std::uint64_t cycles = robot.cycles();
    robot.reboot();
    robot.set_cycles(cycles + 80);
    move_pad_a(robot);
    robot.powered = true;
    bench.drop_to_client = nullptr;
    bench.run(10 * second);
    expect_moved_pad_a(bench);
}

/** The first statuses look late, and each later one is only a little less late. */
TEST(Restart, ThatStatusesInAQueueHideIsNoticedWhenTheyAreOnTime) {
    for (const std::uint64_t ahead_s : {2U, 4U, 5U}) {
        SCOPED_TRACE(ahead_s);
        ScriptedRobot robot;
        Ready bench(robot);
        bench.run(10 * second);
        const std::uint64_t cycles = robot.cycles();
        const auto subscriptions = robot.subscriptions; /* some robots keep them */
        robot.reboot();
        robot.subscriptions = subscriptions;
        robot.set_cycles(cycles + ahead_s * 100);
        for (int i = 0; i < 600; i++) /* nobody receives */
            robot.advance(bench.now_us += 10 * ms);
        bench.run(100 * ms);
        EXPECT_LE(1U, bench.count(ROBUROC4_COUNT_REBOOTS));
        bench.run(2 * second);
        EXPECT_EQ(ROBUROC4_OK, bench.arm());
    }
}

TEST(Restart, IsNotReportedOfTheSameRobotWhoseQueueEmpties) {
    Ready bench;
    std::uint64_t delay_us = 0;
    bench.delay_to_client = [&delay_us] { return delay_us; };
    for (const std::uint64_t step_us : {1 * ms, 10 * ms, 40 * ms}) {
        for (; delay_us < 4 * second; delay_us += step_us)
            bench.run(50 * ms);
        bench.run(20 * second);
        for (; delay_us > step_us; delay_us -= step_us)
            bench.run(50 * ms);
        bench.run(20 * second);
        for (int i = 0; i < 600; i++) /* nobody receives */
            bench.robot.advance(bench.now_us += 10 * ms);
    }
    bench.run(2 * second);
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_REBOOTS));
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

TEST(Restart, IsNotReportedForEverWhereStampsAreOfTheMeasurement) {
    MeasuringRobot robot;
    Ready bench(robot);
    robot.powered = false;
    bench.run(30 * second);
    bench.delay_to_client = [] { return 60 * ms; };
    robot.powered = true; /* with its subscriptions, so that statuses come before they count */
    bench.run(10 * second);
    EXPECT_LE(bench.count(ROBUROC4_COUNT_REBOOTS), 1U);
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

/** Nothing tells then which time the robot should show. */
TEST(Restart, InAnOutageIsAssumedIfThisClockWentBackMeanwhile) {
    for (const std::uint64_t up_s : {20U, 3600U}) {
        SCOPED_TRACE(up_s);
        RobotBench bench;
        bench.robot.set_cycles(1200);
        bench.ready();
        bench.robot.powered = false;
        bench.run(5 * second);
        bench.skew_us -= static_cast<std::int64_t>(2 * second);
        bench.run(5 * second);
        bench.robot.reboot();
        bench.robot.set_cycles(up_s * 100);
        bench.robot.powered = true;
        bench.run(10 * second);
        EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_REBOOTS));
        EXPECT_EQ(ROBUROC4_OK, bench.arm());
    }
}

/** By how much it went back is not known either, if nobody called meanwhile. */
TEST(Restart, IsAssumedIfThisClockWentBackAndTheRobotsIsASecondAhead) {
    ScriptedRobot robot;
    Ready bench(robot);
    const std::uint64_t cycles = robot.cycles();
    robot.powered = false;
    bench.run(900 * ms);
    bench.now_us += 2 * second;
    robot.advance(bench.now_us);
    bench.skew_us -= static_cast<std::int64_t>(2500 * ms);
    const auto subscriptions = robot.subscriptions; /* some robots keep them */
    robot.reboot();
    robot.subscriptions = subscriptions;
    robot.set_cycles(cycles + 800);
    robot.powered = true;
    bench.run(10 * second);
    EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_REBOOTS));
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

TEST(Restart, IsNotHiddenByWhatIsOverheardWhileServicesAreRead) {
    ScriptedRobot robot;
    Ready bench(robot);
    bench.run(10 * second);
    robot.remove(ROBUROC4_SERVICE_BATTERY);
    robot.service(ROBUROC4_SERVICE_TELEMETER).get_silent = true; /* so that it takes long */
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_DISCOVERING));
    const auto subscriptions = robot.subscriptions; /* some robots keep them */
    const std::uint64_t cycles = robot.cycles();
    robot.reboot();
    robot.subscriptions = subscriptions;
    robot.set_cycles(cycles - 500);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    bench.run(500 * ms);
    EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_REBOOTS));
}

TEST(Restart, IsAssumedAfterASecondOfSilenceInWhichThisClockWentBack) {
    roburoc4_config config = default_config();
    config.lost_ms = 5000;
    Ready bench(config);
    bench.robot.powered = false;
    bench.run(700 * ms);
    bench.skew_us -= static_cast<std::int64_t>(second);
    bench.run(700 * ms);
    bench.robot.powered = true; /* its clock was set meanwhile, to about the same time */
    bench.robot.set_cycles(bench.robot.cycles() - 100);
    bench.run(100 * ms);
    EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_REBOOTS));
}

TEST(Restart, IsNotAssumedWhereOnlyThisClockWentBack) {
    Ready bench;
    bench.run(5 * second);
    bench.skew_us -= static_cast<std::int64_t>(2 * second);
    bench.run(5 * second);
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_REBOOTS));
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}
