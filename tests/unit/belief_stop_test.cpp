/* SPDX-License-Identifier: MIT
 *
 * When the client believes that the robot has stopped, on robots that answer the
 * manual's open questions in other ways than the simulator (docs/PROTOCOL.md, the family).
 */
#include <gtest/gtest.h>

#include <vector>

#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

constexpr std::uint32_t differential = ROBUROC4_SERVICE_DIFFERENTIAL;

/** Keeps its last target while [A] is held, ignores commands meanwhile, and obeys it again. */
struct ResumingRobot : ScriptedRobot {
    ResumingRobot() {
        watchdog_us = 60 * second;
    }
    void hold(bool down) {
        press(ROBUROC4_DI_PAD_A, down);
        if (down) {
            kept_[0] = target_linear;
            kept_[1] = target_angular;
        }
        follows = !down;
        target_linear = current_linear = down ? 0 : kept_[0];
        target_angular = current_angular = down ? 0 : kept_[1];
    }

  private:
    float kept_[2] = {0, 0};
};

class StopBelief : public testing::Test {
  protected:
    ResumingRobot robot;
    Bench bench{robot};
};

} // namespace

TEST_F(StopBelief, IsSentAgainWhenTheOverrideEnds) {
    for (const std::uint64_t held_ms : {200U, 500U, 900U, 5000U}) {
        SCOPED_TRACE(held_ms);
        ResumingRobot fresh;
        robot = fresh;
        Bench again(robot);
        again.armed();
        ASSERT_NO_FATAL_FAILURE(again.driving(1, 0, second));
        robot.hold(true);
        again.run(held_ms * ms);
        robot.hold(false);
        ASSERT_EQ(1.0F, robot.target_linear) << "it resumes the target from before";
        again.run(60 * ms);
        EXPECT_EQ(0.0F, robot.target_linear);
        again.run(second);
        EXPECT_EQ(ROBUROC4_STOP_CONFIRMED, again.facts().stop_outcome);
        EXPECT_TRUE(again.take_events() & ROBUROC4_EVENT_STOP_CONFIRMED);
    }
}

TEST_F(StopBelief, OfAClientThatDroveNothingIsSentAgainWhenTheOverrideEnds) {
    bench.ready();
    robot.hold(true);
    bench.run(100 * ms);
    bench.pause();
    bench.run(3 * second);
    ASSERT_EQ(ROBUROC4_STOP_OVERRIDDEN, bench.facts().stop_outcome);
    bench.sent.clear();
    robot.hold(false);
    bench.run(second);
    EXPECT_LE(3U, bench.commands().size());
    EXPECT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
}

TEST_F(StopBelief, IsNotConfirmedWhileTheOverrideLasts) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, second));
    bench.take_events();
    robot.hold(true);
    bench.run(3 * second);
    EXPECT_EQ(ROBUROC4_STOP_OVERRIDDEN, bench.facts().stop_outcome);
    const std::uint32_t events = bench.take_events();
    EXPECT_FALSE(events & ROBUROC4_EVENT_STOP_CONFIRMED);
    EXPECT_TRUE(events & ROBUROC4_EVENT_STOP_UNCONFIRMED);
}

TEST_F(StopBelief, IsNotConfirmedBeforeTheInputOfTheOverrideIsRead) {
    for (const std::int32_t index : {ROBUROC4_DI_PAD_A, ROBUROC4_DI_PAD_A + 1}) {
        SCOPED_TRACE(index);
        ResumingRobot fresh;
        robot = fresh;
        Bench again(robot);
        again.armed();
        ASSERT_NO_FATAL_FAILURE(again.driving(1, 0, second));
        robot.hold(true);
        again.run(500 * ms);
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_set_role_index(&again.client, ROBUROC4_ROLE_OVERRIDE,
                                                              index, again.client_us()));
        ASSERT_EQ(ROBUROC4_OK, again.receive(robot.status_at(differential, robot.cycles() + 1)));
        again.poll();
        EXPECT_NE(ROBUROC4_STOP_CONFIRMED, again.facts().stop_outcome);
        if (index != ROBUROC4_DI_PAD_A)
            continue; /* from the next status on, [A] is another input */
        again.run(5 * second);
        robot.hold(false);
        ASSERT_EQ(1.0F, robot.target_linear);
        again.run(60 * ms);
        EXPECT_EQ(0.0F, robot.target_linear);
    }
}

TEST(LateInputs, ConfirmAStop) {
    for (const std::uint64_t inputs_us : {10 * ms, 55 * ms, 100 * ms}) {
        SCOPED_TRACE(inputs_us);
        LateInputsRobot robot;
        robot.inputs_us = inputs_us;
        Armed bench(robot);
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
        ASSERT_EQ(ROBUROC4_OK, bench.pause());
        bench.run(500 * ms);
        EXPECT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
    }
}

TEST(LateInputs, ConfirmNoStopFromBeforeItWasShown) {
    LateInputsRobot robot;
    robot.inputs_us = 100 * ms;
    Armed bench(robot);
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
    ASSERT_EQ(ROBUROC4_OK, bench.pause());
    bench.run(80 * ms); /* inputs from before the stop arrive */
    EXPECT_EQ(0.0F, robot.target_linear);
    EXPECT_NE(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
}

TEST_F(StopBelief, IsNotConfirmedWhereTheOverrideCannotBeKnown) {
    for (const bool allowed : {false, true}) {
        SCOPED_TRACE(allowed);
        ScriptedRobot plain;
        plain.channel_text = [](std::uint32_t, std::uint32_t) { return "spare"; };
        roburoc4_config config = default_config();
        config.options |= allowed ? ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE : 0;
        Bench monitor(plain, config);
        monitor.ready();
        ASSERT_TRUE(monitor.run_until([&] { return monitor.facts().descriptions_done == 1; }));
        ASSERT_EQ(ROBUROC4_OK, monitor.stop());
        monitor.run(2 * second);
        EXPECT_EQ(allowed ? ROBUROC4_STOP_CONFIRMED : ROBUROC4_STOP_TIMED_OUT,
                  monitor.facts().stop_outcome);
    }
}

TEST_F(StopBelief, OfAClosingClientIsConfirmedWhenTheOverrideEnds) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, second));
    robot.hold(true);
    bench.run(200 * ms);
    ASSERT_EQ(ROBUROC4_OK, bench.close());
    bench.run(100 * ms);
    ASSERT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_CLOSING), bench.state());
    robot.hold(false);
    bench.run(300 * ms);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_IDLE), bench.state());
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_STOP_CONFIRMED);
}

/** Statuses show the speed that it resumes only when its motors follow. */
TEST_F(StopBelief, OfAClosingClientIsNotConfirmedBeforeTheResumedSpeedIsShown) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, second));
    robot.hold(true);
    bench.run(850 * ms); /* soon its last lease is a watchdog time ago */
    ASSERT_EQ(ROBUROC4_OK, bench.close());
    bench.run(100 * ms);
    robot.hold(false);
    robot.target_linear = 0;
    bench.drop_to_robot = is_command; /* to see what it does if the zeros are lost */
    bench.run(150 * ms);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_CLOSING), bench.state());
    robot.target_linear = 1;
    bench.run(100 * ms);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_CLOSING), bench.state());
    bench.drop_to_robot = nullptr;
    bench.run(500 * ms);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_IDLE), bench.state());
    EXPECT_EQ(0.0F, robot.target_linear);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_STOP_CONFIRMED);
}

TEST_F(StopBelief, OfAClosingClientEndsHoweverOftenTheOverrideDoes) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, second));
    bench.drop_to_robot = is_command;
    ASSERT_EQ(ROBUROC4_OK, bench.close());
    for (int i = 0; i < 22; i++) {
        robot.press(ROBUROC4_DI_PAD_A, i % 2 == 0);
        bench.run(100 * ms);
        (void)bench.close(); /* nor however often the program closes it */
    }
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_IDLE), bench.state());
}

/** Statuses of the robot that restarted count again once its clock shows more than before. */
TEST_F(StopBelief, OfAClosingClientIsNotConfirmedByInputsOfAnotherRobot) {
    roburoc4_config config = default_config();
    config.robot_watchdog_ms = 10000;
    Bench closing(robot, config);
    closing.armed();
    ASSERT_NO_FATAL_FAILURE(closing.driving(1, 0, second));
    ASSERT_EQ(ROBUROC4_OK, closing.close());
    closing.drop_to_robot = is_command;
    robot.set_cycles(robot.cycles() - 130);
    robot.press(ROBUROC4_DI_PAD_A + 1); /* where [A] is now */
    robot.follows = false;
    robot.target_linear = robot.current_linear = 0;
    closing.run(9 * second);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_CLOSING), closing.state());
    closing.run(2 * second);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_IDLE), closing.state());
    EXPECT_FALSE(closing.take_events() & ROBUROC4_EVENT_STOP_CONFIRMED);
}

/** [A] was held, and then the program says that no input is [A]. */
TEST_F(StopBelief, DoesNotInterruptALeaseWhenTheOverrideBecomesUnknown) {
    robot.channel_text = [](std::uint32_t, std::uint32_t) { return "spare"; };
    roburoc4_config config = default_config();
    config.options |= ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE;
    config.role_index[ROBUROC4_ROLE_OVERRIDE] = ROBUROC4_DI_PAD_A;
    Bench again(robot, config);
    again.armed();
    ASSERT_TRUE(again.run_until([&] { return again.facts().descriptions_done == 1; }));
    ASSERT_NO_FATAL_FAILURE(again.driving(1, 0, second));
    robot.hold(true);
    again.run(3 * second);
    ASSERT_EQ(ROBUROC4_STOP_OVERRIDDEN, again.facts().stop_outcome);
    robot.hold(false);
    robot.target_linear = robot.current_linear = 0;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_set_role_index(&again.client, ROBUROC4_ROLE_OVERRIDE,
                                                          ROBUROC4_INDEX_AUTO, again.client_us()));
    ASSERT_EQ(ROBUROC4_OK, again.arm());
    const std::uint64_t at_us = again.now_us;
    ASSERT_NO_FATAL_FAILURE(again.driving(0.5F, 0, 500 * ms));
    EXPECT_LE(10U, again.commands(at_us).size());
    EXPECT_EQ(again.commands(at_us).size(), again.speeds(at_us));
}

TEST_F(StopBelief, EndsUnconfirmedOnARobotThatLostItsInputs) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, second));
    robot.hold(true);
    bench.run(500 * ms);
    robot.reboot();
    robot.hold(false);
    robot.target_linear = robot.current_linear = 0;
    robot.remove(ROBUROC4_SERVICE_IOCARD);
    bench.run(10 * second);
    ASSERT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
    EXPECT_EQ(ROBUROC4_STOP_TIMED_OUT, bench.facts().stop_outcome);
}

TEST_F(StopBelief, IsSentAgainWhenOurSpeedComesBack) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, second));
    bench.pause();
    bench.run(300 * ms);
    ASSERT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
    robot.target_linear = 1; /* an old command overtook nothing and comes last */
    bench.run(60 * ms);
    EXPECT_EQ(0.0F, robot.target_linear);
    bench.run(300 * ms);
    ASSERT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
    robot.target_linear = 1;
    bench.drop_to_robot = everything;
    bench.run(60 * ms);
    robot.target_linear = 0; /* as others come late, too */
    bench.run(2 * second);
    EXPECT_EQ(ROBUROC4_STOP_TIMED_OUT, bench.facts().stop_outcome) << "the new zeros are lost";
}

TEST_F(StopBelief, IsSentAgainHoweverLateStatusesShowThatOurSpeedCameBack) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, second));
    bench.pause();
    bench.run(300 * ms);
    ASSERT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
    bench.delay_to_client = [] { return 3 * second; };
    robot.target_linear = 1;
    bench.run(10 * second);
    EXPECT_EQ(1.0F, robot.target_linear) << "what it shows is too old to act on";
    bench.delay_to_client = nullptr;
    bench.run(2 * second);
    EXPECT_EQ(0.0F, robot.target_linear);
}

TEST_F(StopBelief, IsNotSentAgainByStatusesOfMoreThanTwoSeconds) {
    roburoc4_config config = default_config();
    config.lost_ms = 60000;
    ResumingRobot fresh;
    robot = fresh;
    Bench patient(robot, config);
    patient.armed();
    ASSERT_NO_FATAL_FAILURE(patient.driving(1, 0, second));
    patient.pause();
    patient.run(300 * ms);
    ASSERT_EQ(ROBUROC4_STOP_CONFIRMED, patient.facts().stop_outcome);
    patient.delay_to_client = [] { return 3 * second; };
    const std::uint64_t late_us = patient.now_us;
    robot.target_linear = 1;
    patient.run(4 * second);
    EXPECT_GT(patient.facts().age_us[ROBUROC4_SERVICE_DIFFERENTIAL], 3 * second);
    EXPECT_LT(patient.facts().age_us[ROBUROC4_SERVICE_DIFFERENTIAL], 4 * second) << "they come";
    EXPECT_TRUE(patient.commands(late_us).empty());
}

TEST_F(StopBelief, IsRepeatedForAsLongAsOurSpeedIsReported) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, second));
    bench.drop_to_robot = is_command;
    bench.pause();
    bench.take_events();
    bench.run(30 * second);
    EXPECT_EQ(1.0F, robot.target_linear) << "nothing arrived, and its watchdog is longer";
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_STOP_UNCONFIRMED);
    EXPECT_NE(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
    bench.drop_to_robot = nullptr;
    bench.run(100 * ms);
    EXPECT_EQ(0.0F, robot.target_linear);
}

TEST_F(StopBelief, IsWatchedWhileWhatWasSentMayStillArrive) {
    bench.armed();
    bench.drop_to_robot = everything; /* a queue takes it all */
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, 200 * ms));
    bench.stop();
    bench.run(6 * second);
    ASSERT_EQ(ROBUROC4_STOP_TIMED_OUT, bench.facts().stop_outcome);
    bench.drop_to_robot = nullptr;
    robot.target_linear = 1; /* the speed comes, the zeros do not */
    bench.run(60 * ms);
    EXPECT_EQ(0.0F, robot.target_linear);
}

TEST_F(StopBelief, IsNotConfirmedWhileItsZerosAreOnTheirWay) {
    bench.armed();
    std::vector<Bytes> queue;
    bench.drop_to_robot = [&](const Bytes &bytes) {
        queue.push_back(bytes);
        return true;
    };
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, 200 * ms));
    bench.take_events();
    bench.pause();
    bench.run(700 * ms);
    EXPECT_EQ(0.0F, robot.target_linear) << "it never had another target";
    EXPECT_EQ(ROBUROC4_STOP_RUNNING, bench.facts().stop_outcome);
    EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_STOP_CONFIRMED);
    bench.drop_to_robot = nullptr;
    for (const Bytes &bytes : queue)
        robot.deliver(bytes);
    bench.run(350 * ms);
    EXPECT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_STOP_CONFIRMED);
}

/** The zeros are lost, and requests are not; a robot shows its target up to 150 ms late. */
TEST_F(StopBelief, IsNotConfirmedBeforeAShortSpeedIsShown) {
    bench.armed();
    bench.drop_to_robot = is_command;
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, 50 * ms));
    bench.pause();
    bench.run(150 * ms);
    EXPECT_EQ(ROBUROC4_STOP_RUNNING, bench.facts().stop_outcome);
    robot.target_linear = 1;
    bench.run(100 * ms);
    bench.drop_to_robot = nullptr;
    EXPECT_EQ(ROBUROC4_STOP_RUNNING, bench.facts().stop_outcome);
    bench.run(500 * ms);
    EXPECT_EQ(0.0F, robot.target_linear);
    EXPECT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
}

TEST_F(StopBelief, IsNotConfirmedByStatusesOfUnknownAge) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, 500 * ms));
    bench.pause();
    for (int i = 0; i < 900; i++) { /* no answer proves how old they are */
        bench.client.private_link.floor_age_us = UINT32_MAX;
        bench.client.private_link.answered = 0;
        bench.run(ms);
    }
    EXPECT_EQ(ROBUROC4_STOP_RUNNING, bench.facts().stop_outcome);
}

/** Its zeros are lost, and statuses show targets late. */
TEST_F(StopBelief, IsNotConfirmedBeforeAnEarlierSpeedIsShown) {
    for (const bool again : {false, true}) {
        SCOPED_TRACE(again ? "the stop is interrupted by a lease" : "the lease ends with zeros");
        ResumingRobot fresh;
        robot = fresh;
        Bench late(robot);
        late.armed();
        late.drop_to_robot = is_command;
        ASSERT_NO_FATAL_FAILURE(late.driving(1, 0, 50 * ms));
        if (again) {
            late.pause();
            late.run(20 * ms);
        }
        ASSERT_NO_FATAL_FAILURE(late.driving(again ? 1.0F : 0, 0, 70 * ms));
        late.pause();
        late.run(190 * ms);
        EXPECT_EQ(ROBUROC4_STOP_RUNNING, late.facts().stop_outcome);
    }
}

TEST_F(StopBelief, IsNotConfirmedBeforeItIsKnownWhichInputTheOverrideIs) {
    robot.texts_silent = true;
    bench.ready();
    robot.hold(true);
    bench.pause();
    bench.run(600 * ms);
    EXPECT_EQ(ROBUROC4_STOP_RUNNING, bench.facts().stop_outcome);
    robot.texts_silent = false;
    robot.hold(false);
    bench.run(20 * second);
    bench.pause();
    bench.run(500 * ms);
    EXPECT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
}

/** An error of one byte may refuse either of two open requests. */
TEST_F(StopBelief, SendsItsZerosAlthoughAnotherRequestWasRefused) {
    bench.armed();
    robot.service(differential).get_silent = true;
    bench.run(10 * second);
    robot.replace_silent = true;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_relocalize(&bench.client, 1, 2, 3, bench.client_us()));
    for (int i = 0; i < 300; i++) { /* whichever is the oldest */
        bench.run(10 * ms);
        (void)bench.receive(Bytes{0});
    }
    bench.sent.clear();
    bench.stop();
    bench.run(100 * ms);
    EXPECT_LE(2U, bench.commands().size());
}

TEST_F(StopBelief, IsNotConfirmedByStatusesFromBeforeItsZeros) {
    bench.delay_to_client = [] { return 240 * ms; };
    bench.ready();
    const std::uint64_t paused_us = bench.now_us;
    bench.pause();
    ASSERT_TRUE(bench.run_until(
        [this] { return bench.facts().stop_outcome == ROBUROC4_STOP_CONFIRMED; }, second));
    EXPECT_GE(bench.now_us, paused_us + 240 * ms);
}

/** [A] is pressed before the first zero that arrives, and the status that shows it is lost. */
TEST_F(StopBelief, IsNotConfirmedByAStatusNewerThanTheOverrides) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, second));
    bench.drop_to_robot = is_command;
    bench.drop_to_client = [](const Bytes &bytes) {
        return is_status(bytes) && bytes[1] == ROBUROC4_SERVICE_IOCARD;
    };
    bench.pause();
    bench.take_events();
    bench.run(30 * ms);
    robot.hold(true);
    ASSERT_EQ(0.0F, robot.target_linear) << "it shows the pad's target, and keeps the other";
    bench.run(170 * ms);
    robot.press(ROBUROC4_DI_PAD_A, false);
    const Bytes late = robot.status_at(ROBUROC4_SERVICE_IOCARD, robot.cycles() - 18);
    robot.press(ROBUROC4_DI_PAD_A, true);
    ASSERT_EQ(ROBUROC4_OK, bench.receive(late)) << "made before [A] was pressed";
    bench.run(1);
    EXPECT_NE(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
    bench.drop_to_robot = bench.drop_to_client = nullptr;
    bench.run(200 * ms);
    EXPECT_TRUE(bench.facts().overridden);
    EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_STOP_CONFIRMED);
    robot.hold(false);
    bench.run(60 * ms);
    EXPECT_EQ(0.0F, robot.target_linear);
}

TEST_F(StopBelief, IsConfirmedSoonWhereAllArrives) {
    bench.armed();
    for (int i = 0; i < 20; i++) {
        ASSERT_NO_FATAL_FAILURE(
            bench.driving(1, 0, second + static_cast<std::uint64_t>(i) * 7 * ms));
        bench.pause();
        bench.run(300 * ms);
        ASSERT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome) << i;
    }
}

TEST_F(StopBelief, IsNotConfirmedByTheStopBeforeWhereTheServiceIsGone) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, second));
    bench.pause();
    bench.run(second);
    ASSERT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
    robot.remove(differential);
    bench.run(10 * second);
    ASSERT_EQ(ROBUROC4_OK, bench.stop());
    bench.run(second);
    EXPECT_EQ(ROBUROC4_STOP_RUNNING, bench.facts().stop_outcome);
    ASSERT_EQ(ROBUROC4_OK, bench.close());
    EXPECT_EQ(ROBUROC4_STOP_TIMED_OUT, bench.facts().stop_outcome);
}

TEST_F(StopBelief, IsWatchedThroughLeasesWithoutASpeed) {
    bench.armed();
    bench.drop_to_robot = everything; /* a queue takes it all */
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, 50 * ms));
    for (int i = 0; i < 4; i++) { /* together too short for a dead uplink */
        bench.stop();
        bench.run(1500 * ms);
        ASSERT_EQ(ROBUROC4_OK, bench.arm());
        ASSERT_NO_FATAL_FAILURE(bench.driving(0, 0, 50 * ms)) << i;
    }
    bench.stop();
    bench.run(second);
    bench.drop_to_robot = nullptr;
    robot.target_linear = 1; /* the speed comes, the zeros do not */
    bench.run(60 * ms);
    EXPECT_EQ(0.0F, robot.target_linear);
}

TEST_F(StopBelief, IsNeverSentToAnotherCommandersSpeed) {
    bench.ready();
    robot.follows = false;
    for (const float speed : {0.01F, 0.5F}) {
        robot.target_linear = speed;
        bench.run(2 * second);
    }
    EXPECT_TRUE(bench.commands().empty()) << "a monitor never commands";
}

TEST_F(StopBelief, LeavesAnotherCommanderAloneLater) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, second));
    bench.pause();
    bench.run(5 * second);
    bench.stop();
    bench.run(second);
    bench.sent.clear();
    robot.follows = false;
    robot.target_linear = 0.5F;
    bench.run(5 * second);
    EXPECT_TRUE(bench.commands().empty());
}

/** A bad link can make any robot look like that. */
TEST_F(StopBelief, InFixedIdModeIsNotConfirmedWhileItsZerosAreOnTheirWay) {
    robot.always_manual_id = true;
    roburoc4_config config = default_config();
    config.role_index[ROBUROC4_ROLE_OVERRIDE] = ROBUROC4_DI_PAD_A;
    Bench told(robot, config);
    told.armed();
    ASSERT_TRUE(told.facts().fixed_id);
    told.drop_to_robot = everything; /* a queue takes it all */
    ASSERT_NO_FATAL_FAILURE(told.driving(1, 0, 200 * ms));
    told.pause();
    told.run(700 * ms);
    EXPECT_EQ(ROBUROC4_STOP_RUNNING, told.facts().stop_outcome);
}

/** The client does not find its service again, and no answer proves that the zeros arrived. */
TEST_F(StopBelief, OfAClosingClientInFixedIdModeIsNotAskedForWithoutPause) {
    roburoc4_config config = default_config();
    config.robot_watchdog_ms = 5000;
    config.role_index[ROBUROC4_ROLE_OVERRIDE] = ROBUROC4_DI_PAD_A;
    ResumingRobot partner;
    partner.always_manual_id = true;
    Bench closing(partner, config);
    closing.ready();
    ASSERT_TRUE(
        closing.run_until([&] { return closing.facts().descriptions_done == 1; }, 60 * second));
    ASSERT_EQ(ROBUROC4_OK, closing.arm());
    ASSERT_EQ(1, closing.facts().fixed_id);
    ASSERT_NO_FATAL_FAILURE(closing.driving(1, 0, 200 * ms));
    partner.set_cycles(partner.cycles() + 100000); /* it seems to have restarted */
    ASSERT_TRUE(
        closing.run_until([&] { return closing.facts().state != ROBUROC4_STATE_READY; }, second));
    closing.close();
    const std::size_t before = closing.sent.size();
    closing.run(4 * second);
    EXPECT_LE(closing.sent.size() - before, 150U); /* 80 of them zeros */
}

/** The zeros are lost, and a subscription is requested before the stop and again; one is answered.
 */
TEST_F(StopBelief, IsProvenOnlyByWhatIsCertainlyTheAnswerToALaterRequest) {
    const struct {
        const char *what;
        bool fixed_id, bad, later;
        std::uint8_t outcome;
    } cases[] = {
        {"the later one", false, false, true, ROBUROC4_STOP_CONFIRMED},
        {"the later one, with an error", false, true, true, ROBUROC4_STOP_RUNNING},
        {"the one that left just before the zero", false, false, false, ROBUROC4_STOP_RUNNING},
        {"one of them, as all ids are the same", true, false, true, ROBUROC4_STOP_RUNNING},
    };
    roburoc4_config config = default_config();
    config.role_index[ROBUROC4_ROLE_OVERRIDE] = ROBUROC4_DI_PAD_A;
    for (const auto &c : cases) {
        SCOPED_TRACE(c.what);
        ResumingRobot partner;
        partner.always_manual_id = c.fixed_id;
        Bench told(partner, config);
        told.ready();
        ASSERT_TRUE(
            told.run_until([&] { return told.facts().descriptions_done == 1; }, 60 * second));
        ASSERT_EQ(ROBUROC4_OK, told.arm());
        ASSERT_EQ(c.fixed_id, told.facts().fixed_id == 1);
        told.drop_to_robot = is_command;
        ASSERT_NO_FATAL_FAILURE(told.driving(1, 0, 200 * ms));
        told.drop_to_robot = everything;
        const auto subscribe = [&](std::uint32_t period_ms) {
            ASSERT_EQ(ROBUROC4_OK,
                      roburoc4_client_subscribe(&told.client, ROBUROC4_SERVICE_TELEMETER, period_ms,
                                                told.client_us()));
            told.pump();
            ASSERT_EQ(ROBUROC4_ACTION_INSERT, told.sent.back().bytes[1]);
        };
        ASSERT_NO_FATAL_FAILURE(subscribe(50));
        std::uint8_t id = told.sent.back().bytes[0];
        told.pause();
        told.pump(); /* a zero, at the same time */
        told.run(160 * ms);
        if (c.later) {
            ASSERT_NO_FATAL_FAILURE(subscribe(100));
            id = told.sent.back().bytes[0];
        }
        told.receive(plain_answer(c.bad ? std::uint8_t{0} : id, ROBUROC4_ACTION_INSERT,
                                  ROBUROC4_SERVICE_NOTIFICATION, c.bad ? 1 : 0));
        told.run(300 * ms);
        EXPECT_EQ(c.outcome, told.facts().stop_outcome);
    }
}
