/* SPDX-License-Identifier: MIT
 *
 * A drive command is a lease: its target holds for its time and not a microsecond longer, whatever
 * the clock does and however often the client is polled.
 */
#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

/** Commands between two times (the second not included). */
std::size_t commands_between(const Bench &bench, std::uint64_t from_us, std::uint64_t to_us) {
    std::size_t number = 0;
    for (const Command &c : bench.commands(from_us))
        number += c.at_us < to_us;
    return number;
}

} // namespace

TEST(Lease, EndsExactlyWhenItsTimeIsOver) {
    for (const std::uint32_t lease_us : {20000U, 20001U, 99999U, 250000U, 1000000U}) {
        SCOPED_TRACE(lease_us);
        Armed bench;
        const std::uint64_t granted_us = bench.now_us;
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0.25F, lease_us));
        EXPECT_EQ(lease_us, bench.facts().lease_left_us);
        bench.run_to(granted_us + lease_us - 1);
        EXPECT_EQ(1, bench.facts().driving);
        EXPECT_EQ(1U, bench.facts().lease_left_us);
        EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_LAPSED);
        bench.now_us = granted_us + lease_us;
        EXPECT_EQ(0, bench.facts().driving) << "before any call that changes something";
        EXPECT_EQ(0U, bench.facts().lease_left_us);
        bench.pump();
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_LAPSED);
        EXPECT_TRUE(bench.commands().back().zero());
        EXPECT_EQ(granted_us + lease_us, bench.commands().back().at_us);
        EXPECT_EQ(1, bench.facts().armed) << "arming stays";
        bench.run(3 * second);
        EXPECT_EQ(0U, bench.speeds(granted_us + lease_us));
    }
}

TEST(Lease, IsTheConfiguredOneByDefault) {
    roburoc4_config config = default_config();
    config.lease_ms = 777;
    Armed bench(config);
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0));
    EXPECT_EQ(777000U, bench.facts().lease_left_us);
}

TEST(Lease, OutsideItsRangeIsRefusedAndStoresNothing) {
    Armed bench;
    for (const std::uint32_t lease_us : {1U, 19999U, 1000001U, UINT32_MAX}) {
        EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, bench.drive(0.5F, 0, lease_us));
        EXPECT_EQ(0, bench.facts().driving);
    }
    bench.run(second);
    EXPECT_EQ(0U, bench.commands().size());
}

TEST(Lease, RepeatsItsCommandAtThePeriod) {
    for (const std::uint32_t period_ms : {10U, 50U, 120U}) {
        roburoc4_config config = default_config();
        config.drive_period_ms = period_ms;
        Armed bench(config);
        const std::uint64_t start_us = bench.now_us;
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, -0.25F, 1000000));
        bench.run(second - 1);
        const auto commands = bench.commands();
        ASSERT_EQ((1000U + period_ms - 1) / period_ms, commands.size());
        for (std::size_t i = 0; i < commands.size(); i++) {
            EXPECT_EQ(start_us + i * period_ms * ms, commands[i].at_us);
            EXPECT_EQ(0.5F, commands[i].linear);
            EXPECT_EQ(-0.25F, commands[i].angular);
        }
    }
}

TEST(Lease, ThatIsShortIsRepeatedAtAtMostHalfOfIt) {
    for (const std::uint32_t lease_us : {40000U, 75000U}) { /* the period is 50 ms */
        Armed bench;
        const std::uint64_t start_us = bench.now_us;
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0, lease_us));
        bench.run(39 * ms);
        EXPECT_EQ(2U, commands_between(bench, start_us, start_us + 40 * ms)) << lease_us;
    }
}

TEST(Lease, RenewalWithTheSameTargetKeepsThePeriod) {
    Armed bench;
    const std::uint64_t start_us = bench.now_us;
    for (int i = 0; i < 1000; i++) {
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0));
        bench.run(1 * ms);
    }
    EXPECT_EQ(20U, commands_between(bench, start_us, start_us + second));
}

TEST(Lease, AChangedTargetLeavesAtOnceOrNextCycle) {
    Armed bench;
    const std::uint64_t start_us = bench.now_us;
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.1F, 0));
    bench.pump();
    ASSERT_EQ(1U, bench.commands().size());
    bench.run(3 * ms);
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.2F, 0));
    bench.run(3 * ms);
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.3F, 0));
    bench.run(3 * ms);
    EXPECT_EQ(1U, bench.commands().size());
    bench.run(1 * ms);
    ASSERT_EQ(2U, bench.commands().size());
    EXPECT_EQ(start_us + 10 * ms, bench.commands()[1].at_us);
    EXPECT_EQ(0.3F, bench.commands()[1].linear);
    bench.run(15 * ms);
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.4F, 0));
    bench.pump();
    EXPECT_EQ(0.4F, bench.commands().back().linear) << "at once where a cycle has passed";
    EXPECT_EQ(bench.now_us, bench.commands().back().at_us);
}

TEST(Lease, ChangeThatIsRenewedBeforeItLeftStillLeavesAtOnce) {
    Armed bench;
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.1F, 0));
    bench.pump();
    const std::uint64_t start_us = bench.now_us;
    for (int i = 0; i < 10; i++) {
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.2F, 0));
        bench.run(1 * ms);
    }
    ASSERT_EQ(2U, bench.commands().size());
    EXPECT_EQ(start_us + 10 * ms, bench.commands()[1].at_us);
}

TEST(Lease, CommandsAreNeverWithinACycleWhateverTheTargets) {
    Armed bench;
    for (int i = 0; i < 2000; i++) {
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.01F * static_cast<float>(i % 100), 0.1F));
        bench.run(700);
    }
    const auto commands = bench.commands();
    EXPECT_GT(commands.size(), 100U);
    for (std::size_t i = 1; i < commands.size(); i++)
        EXPECT_GE(commands[i].at_us - commands[i - 1].at_us, 10 * ms);
}

TEST(Lease, ThatIsRenewedForAShorterTimeEndsAfterThat) {
    roburoc4_config config = default_config();
    config.drive_period_ms = 500; /* nothing else is due earlier */
    config.lease_ms = 1000;
    Armed bench(config);
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0, 1000 * ms));
    bench.run(15 * ms);
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0, 20 * ms));
    const std::uint64_t renewed_us = bench.now_us;
    bench.run(100 * ms);
    const auto commands = bench.commands(renewed_us);
    ASSERT_FALSE(commands.empty());
    EXPECT_TRUE(commands.back().zero());
    EXPECT_EQ(renewed_us + 20 * ms, commands.back().at_us);
}

TEST(Lease, HasNoSpeedAfterItForAnyPollSchedule) {
    for (std::uint64_t period_us = 1 * ms; period_us < 700 * ms; period_us += 13777) {
        for (const std::uint32_t lease_us : {20000U, 250000U, 1000000U}) {
            Armed bench;
            const std::uint64_t granted_us = bench.now_us;
            ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0, lease_us));
            for (int i = 0; i < 100 && bench.now_us < granted_us + 2 * second; i++) {
                bench.pump();
                bench.now_us += period_us;
            }
            ASSERT_EQ(0U, bench.speeds(granted_us + lease_us)) << period_us << " " << lease_us;
        }
    }
}

TEST(Lease, GapBetweenCallsLongerThanItEndsItAndNeverRevivesIt) {
    Armed bench;
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0));
    bench.pump();
    bench.now_us += 260 * ms; /* no call was made: a blocked program, or a machine that slept */
    const std::uint64_t back_us = bench.now_us;
    ASSERT_TRUE(bench.poll());
    EXPECT_TRUE(bench.commands().back().zero());
    EXPECT_EQ(0, bench.facts().driving);
    bench.run(3 * second);
    EXPECT_EQ(0U, bench.speeds(back_us));
}

TEST(Clock, StepBackEndsTheLeaseDisarmsAndNeverRevivesIt) {
    for (const std::int64_t step_us : {-1, -1000, -250000, -1000000, -900000000}) {
        SCOPED_TRACE(step_us);
        Armed bench;
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0, 1000000));
        bench.pump();
        bench.take_events();
        bench.now_us++;
        const std::uint64_t at_us = bench.now_us;
        bench.skew_us += step_us - 1;
        bench.pump();
        EXPECT_EQ(0, bench.facts().armed);
        EXPECT_EQ(0, bench.facts().driving);
        EXPECT_EQ(ROBUROC4_ERR_CLOCK, bench.facts().disarm_cause);
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_CLOCK);
        EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_CLOCK_FAULTS));
        ASSERT_FALSE(bench.commands(at_us).empty());
        EXPECT_TRUE(bench.commands(at_us).back().zero()) << "a stop sequence";
        bench.skew_us -= step_us - 1; /* and forth again */
        bench.run(3 * second);
        EXPECT_EQ(0U, bench.speeds(at_us));
        EXPECT_GE(bench.commands(at_us).size(), 3U);
        EXPECT_EQ(0, bench.facts().stopping);
        EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
        EXPECT_EQ(ROBUROC4_OK, bench.arm()) << "it is not blocked";
    }
}

TEST(Clock, StepBackSeenFirstByAnyCallEndsTheLease) {
    struct Call {
        roburoc4_result result;
        std::function<roburoc4_result(Bench &)> of;
    };
    const std::vector<Call> calls{
        {ROBUROC4_ERR_CLOCK, [](Bench &b) { return b.drive(0.5F, 0); }},
        {ROBUROC4_ERR_STALE_DIFFERENTIAL, [](Bench &b) { return b.arm(); }},
        {ROBUROC4_ERR_SHORT,
         [](Bench &b) {
             return b.receive({1, 2});
         }},
        {ROBUROC4_OK,
         [](Bench &b) { return roburoc4_client_subscribe(&b.client, 3, 100, b.client_us()); }},
        {ROBUROC4_OK,
         [](Bench &b) { return roburoc4_client_subscribe(&b.client, 3, 0, b.client_us()); }},
        {ROBUROC4_OK, [](Bench &b) { return set_digital_output(&b.client, 1, 1, b.client_us()); }},
        {ROBUROC4_OK,
         [](Bench &b) {
             return roburoc4_client_set_analog_output(&b.client, 0, 1, b.client_us());
         }},
        {ROBUROC4_OK,
         [](Bench &b) { return roburoc4_client_relocalize(&b.client, 0, 0, 0, b.client_us()); }},
        {ROBUROC4_OK,
         [](Bench &b) { return roburoc4_client_set_role_index(&b.client, 1, 3, b.client_us()); }},
        {ROBUROC4_OK, [](Bench &b) { return b.pause(); }},
        /* stop() gives its own reason */
        {ROBUROC4_OK, [](Bench &b) { return b.close(); }},
        {1, [](Bench &b) { return b.poll() ? 1 : 0; }},
    };
    for (std::size_t i = 0; i < calls.size(); i++) {
        SCOPED_TRACE(i);
        ScriptedRobot robot;
        robot.iocard.analog_outputs = 1;
        Armed bench(robot);
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0, 1000000));
        bench.pump();
        bench.now_us++;
        bench.skew_us -= 100000;
        EXPECT_EQ(calls[i].result, calls[i].of(bench));
        EXPECT_EQ(0, bench.facts().driving);
        EXPECT_EQ(0, bench.facts().armed);
        EXPECT_EQ(ROBUROC4_ERR_CLOCK, bench.facts().disarm_cause);
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_CLOCK);
        EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_CLOCK_FAULTS));
        const std::uint64_t at_us = bench.now_us;
        if (bench.commands(at_us).empty()) {
            EXPECT_LE(roburoc4_client_next_deadline(&bench.client), bench.client_us());
        }
        bench.run(2 * second);
        EXPECT_EQ(0U, bench.speeds(at_us));
        EXPECT_GE(bench.commands(at_us).size(), 3U);
    }
}

TEST(Clock, StepBackLosesNoRobotButTrustsNoEarlierStatus) {
    ScriptedRobot robot;
    Ready bench(robot);
    bench.skew_us -= 500000;
    while (bench.poll()) {
    }
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
    EXPECT_EQ(ROBUROC4_ERR_STALE_DIFFERENTIAL, bench.arm()) << "their age is not known";
    bench.run(100 * ms);
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
    std::uint64_t host_us = 0;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_host_time(&bench.client, robot.cycles(), &host_us));
    EXPECT_NEAR(static_cast<double>(bench.client_us()), static_cast<double>(host_us), 10000)
        << "the robot's time on the new clock";
    bench.run(10 * second);
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_LOST));
}

TEST(Clock, StepBackForgetsTheAnswerBeforeIt) {
    Ready bench;
    bench.drop_to_client = [](const Bytes &bytes) { return bytes[0] == ROBUROC4_HEADER_STATUS; };
    ASSERT_TRUE(bench.run_until([&] { return bench.client.private_link.answered != 0; }));
    bench.drop_to_client = [](const Bytes &bytes) { return bytes[0] != ROBUROC4_HEADER_STATUS; };
    bench.skew_us -= 500000;
    bench.run(300 * ms);
    EXPECT_EQ(ROBUROC4_ERR_STALE_DIFFERENTIAL, bench.arm())
        << "no answer says how old these statuses are";
    bench.drop_to_client = nullptr;
    EXPECT_TRUE(bench.run_until([&] { return bench.arm() == ROBUROC4_OK; }, 5 * second));
}

TEST(Clock, StepBackWhileConnectingKeepsRequesting) {
    ScriptedRobot robot;
    robot.powered = false;
    Started bench(robot);
    bench.run(5 * second);
    bench.skew_us -= 900000000;
    const std::size_t before = bench.sent.size();
    bench.run(10 * second);
    EXPECT_GE(bench.sent.size(), before + 9);
    EXPECT_LE(bench.sent.size(), before + 12);
    robot.powered = true;
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 3 * second));
}

TEST(Clock, StepBackToNearZeroDoesNotDelayTheZeros) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    bench.robot.powered = false;
    bench.pause();
    bench.pump();
    const std::uint64_t at_us = bench.now_us;
    bench.skew_us = -static_cast<std::int64_t>(bench.now_us) + 5;
    bench.run(3 * second);
    EXPECT_NEAR(20, static_cast<double>(bench.commands(at_us).size()), 3);
    EXPECT_EQ(0, bench.facts().stopping);
}

TEST(Clock, JumpFarAheadSendsNoSpeedAndDoesNotBlock) {
    for (const std::int64_t step_us :
         {std::int64_t{300000}, std::int64_t{3600000000}, std::int64_t{1} << 52}) {
        SCOPED_TRACE(step_us);
        Armed bench;
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0));
        bench.pump();
        const std::uint64_t at_us = bench.now_us;
        bench.now_us++;
        bench.skew_us += step_us;
        bench.run(10 * second);
        EXPECT_EQ(0U, bench.speeds(at_us + 1));
        EXPECT_GE(bench.commands(at_us + 1).size(), 3U);
        EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
        EXPECT_EQ(ROBUROC4_OK, bench.arm());
    }
}

TEST(Deadline, NeverLetsALoopSpinInAnyState) {
    /* the bench itself checks that no deadline is in the past after everything was polled */
    roburoc4_config config = default_config();
    config.drive_period_ms = 10;
    RobotBench bench(config);
    bench.delay_to_client = [] { return 3 * ms; };
    bench.robot.powered = false;
    const auto polls_per_second = [&](std::uint64_t seconds) {
        const std::uint64_t before = bench.polls;
        bench.run(seconds * second);
        return (bench.polls - before) / seconds;
    };
    bench.start();
    EXPECT_LT(polls_per_second(10), 300U) << "connecting";
    bench.robot.powered = true;
    EXPECT_LT(polls_per_second(10), 500U) << "discovering to ready";
    ASSERT_EQ(ROBUROC4_OK, bench.arm());
    EXPECT_LT(polls_per_second(5), 500U) << "armed";
    for (int i = 0; i < 50; i++) {
        bench.drive(0.5F, 0);
        EXPECT_LT(polls_per_second(1), 700U) << "driving and stopping";
    }
    bench.pause();
    EXPECT_LT(polls_per_second(3), 500U) << "stopping";
    bench.robot.powered = false;
    EXPECT_LT(polls_per_second(10), 300U) << "lost";
    bench.robot.powered = true;
    bench.run(5 * second);
    ASSERT_EQ(ROBUROC4_OK, bench.arm());
    bench.drive(0.5F, 0);
    bench.pump();
    bench.robot.powered = false;
    bench.close();
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_CLOSING), bench.state());
    EXPECT_LT(polls_per_second(2), 500U) << "closing";
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_IDLE), bench.state());
    EXPECT_EQ(UINT64_MAX, roburoc4_client_next_deadline(&bench.client));
}

/* ---- a lease that lapsed ---- */

TEST(Lapse, DisarmsOnceTheLeaseWasNotRenewedForLongEnough) {
    for (const std::uint32_t lapse_ms : {0U, 400U, 1000U, 60000U}) {
        SCOPED_TRACE(lapse_ms);
        roburoc4_config config = default_config();
        config.lapse_disarm_ms = lapse_ms;
        Armed bench(config);
        const std::uint64_t granted_us = bench.now_us;
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0, 250000));
        EXPECT_EQ(0, bench.facts().lapsed);
        bench.run_to(granted_us + 250 * ms + lapse_ms * ms - 1);
        EXPECT_EQ(1, bench.facts().armed);
        EXPECT_EQ(lapse_ms > 0, bench.facts().lapsed);
        bench.take_events();
        bench.run(1);
        EXPECT_EQ(0, bench.facts().armed);
        EXPECT_EQ(1, bench.facts().lapsed);
        EXPECT_EQ(ROBUROC4_ERR_LAPSED, bench.facts().disarm_cause);
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_DISARMED);
        EXPECT_EQ(ROBUROC4_ERR_LAPSED, bench.drive(0.5F, 0));
        bench.run(2 * second);
        ASSERT_EQ(ROBUROC4_OK, bench.arm());
        EXPECT_EQ(0, bench.facts().lapsed);
        EXPECT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0));
    }
}

TEST(Lapse, IsForgivenByANewLeaseInTimeAndByAPause) {
    Armed bench;
    for (int i = 0; i < 5; i++) {
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.2F, 0)) << i;
        bench.run(1200 * ms); /* the lease of 250 ms, and less than a second more */
        EXPECT_EQ(1, bench.facts().lapsed);
    }
    bench.pause();
    EXPECT_EQ(0, bench.facts().lapsed);
    bench.run(60 * second);
    EXPECT_EQ(1, bench.facts().armed);
}

TEST(Lapse, IsNotForgivenByAPauseThatComesTooLate) {
    for (const std::uint32_t hang_ms : {1240U, 1260U}) {
        Armed bench;
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 500 * ms));
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0));
        bench.now_us += hang_ms * ms; /* the lease of 250 ms, and a second */
        EXPECT_EQ(ROBUROC4_OK, roburoc4_client_pause(&bench.client, bench.now_us));
        EXPECT_EQ(hang_ms < 1250, bench.facts().armed);
        EXPECT_EQ(hang_ms < 1250 ? ROBUROC4_OK : ROBUROC4_ERR_LAPSED, bench.facts().disarm_cause);
    }
}

/* Whatever the program calls first afterwards, and whatever the robot shows then. */
TEST(Lapse, IsNoticedBeforeAnythingElse) {
    for (int first = 0; first < 4; first++) {
        SCOPED_TRACE(first);
        Armed bench;
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 500 * ms));
        bench.take_events();
        bench.robot.follows = false; /* its watchdog tripped, or a button was pressed */
        bench.now_us += 8 * second;
        bench.robot.advance(bench.now_us);
        switch (first) {
        case 0:
            bench.run(ms);
            break;
        case 1:
            EXPECT_EQ(ROBUROC4_OK, roburoc4_client_stop(&bench.client, bench.now_us));
            break;
        case 2:
            EXPECT_EQ(ROBUROC4_OK, roburoc4_client_close(&bench.client, bench.now_us));
            break;
        default:
            EXPECT_EQ(ROBUROC4_OK, roburoc4_client_pause(&bench.client, bench.now_us));
        }
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_LAPSED);
        if (first != 1) { /* stop() is a cause of its own */
            EXPECT_EQ(ROBUROC4_ERR_LAPSED, bench.facts().disarm_cause);
        }
    }
}

TEST(Lapse, IsNoticedBeforeTheStatusThatIsReadFirst) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 500 * ms));
    bench.take_events();
    bench.now_us += 2 * second;
    bench.robot.press(ROBUROC4_DI_PAD_A);
    bench.robot.advance(bench.now_us);
    for (const Bytes &bytes : bench.robot.take())
        bench.receive(bytes);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_LAPSED);
    EXPECT_EQ(ROBUROC4_ERR_LAPSED, bench.facts().disarm_cause);
}

TEST(Lapse, AProgramThatHungNeverDrivesOn) {
    for (const bool pump_runs_on : {false, true}) {
        SCOPED_TRACE(pump_runs_on);
        Armed bench;
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 500 * ms));
        const std::uint64_t hang_us = bench.now_us;
        if (pump_runs_on) {
            bench.run(8 * second);
        } else { /* statuses wait in the socket meanwhile */
            bench.now_us += 8 * second;
            bench.robot.advance(bench.now_us);
        }
        for (int i = 0; i < 40; i++) {
            EXPECT_EQ(ROBUROC4_ERR_LAPSED, bench.drive(0.5F, 0)) << i;
            bench.run(50 * ms);
        }
        EXPECT_EQ(0U, bench.speeds(hang_us + 250 * ms));
        EXPECT_EQ(ROBUROC4_ERR_LAPSED, bench.facts().disarm_cause);
    }
}
