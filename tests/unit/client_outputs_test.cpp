/* SPDX-License-Identifier: MIT
 *
 * Control calls other than motion: outputs, relocalization, subscriptions.
 */
#include "client_bench.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace roburoc4_tests;

namespace {

roburoc4_result set_one(Bench &bench, std::uint32_t index, std::int32_t on) {
    return set_digital_output(&bench.client, index, on, bench.client_us());
}
roburoc4_result set_many(Bench &bench, std::uint64_t mask, std::uint64_t values) {
    return roburoc4_client_set_digital_outputs(&bench.client, mask, values, bench.client_us());
}
roburoc4_result set_volts(Bench &bench, std::uint32_t index, float value) {
    return roburoc4_client_set_analog_output(&bench.client, index, value, bench.client_us());
}
roburoc4_result relocalize(Bench &bench, double x, double y, double theta) {
    return roburoc4_client_relocalize(&bench.client, x, y, theta, bench.client_us());
}
roburoc4_result subscribe(Bench &bench, std::uint32_t service, std::uint32_t period_ms) {
    return roburoc4_client_subscribe(&bench.client, service, period_ms, bench.client_us());
}
roburoc4_result unsubscribe(Bench &bench, std::uint32_t service) {
    return roburoc4_client_subscribe(&bench.client, service, 0, bench.client_us());
}

} // namespace

TEST(Outputs, AndPosesAreRefusedWheneverTheClientIsNotReady) {
    ScriptedRobot robot;
    robot.iocard.analog_outputs = 1;
    Bench bench(robot);
    const auto expect_refused_in = [&](int state) {
        ASSERT_EQ(static_cast<std::uint32_t>(state), bench.state());
        EXPECT_EQ(ROBUROC4_ERR_NOT_READY, set_one(bench, 1, 1)) << state;
        EXPECT_EQ(ROBUROC4_ERR_NOT_READY, set_many(bench, 2, 2)) << state;
        EXPECT_EQ(ROBUROC4_ERR_NOT_READY, set_volts(bench, 0, 1)) << state;
        EXPECT_EQ(ROBUROC4_ERR_NOT_READY, relocalize(bench, 1, 2, 3)) << state;
    };
    bench.delay_to_client = [] { return 1 * ms; }; /* so that each state lasts */
    expect_refused_in(ROBUROC4_STATE_IDLE);
    bench.start();
    expect_refused_in(ROBUROC4_STATE_CONNECTING);
    for (const int state : {ROBUROC4_STATE_DISCOVERING, ROBUROC4_STATE_SUBSCRIBING}) {
        ASSERT_TRUE(bench.run_until_state(static_cast<std::uint32_t>(state)));
        expect_refused_in(state);
    }
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    robot.powered = false;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    expect_refused_in(ROBUROC4_STATE_LOST);
    robot.powered = true;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    EXPECT_EQ(ROBUROC4_OK, bench.pause());
    EXPECT_EQ(ROBUROC4_OK, bench.close());
    expect_refused_in(ROBUROC4_STATE_CLOSING);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_IDLE));
    expect_refused_in(ROBUROC4_STATE_IDLE);
    EXPECT_TRUE(robot.output_commands.empty());
    EXPECT_TRUE(robot.seen(ROBUROC4_ACTION_REPLACE).empty());
}

TEST(Outputs, AreUnknownWithoutTheCardsProperties) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_IOCARD).get_refused = true;
    Ready bench(robot);
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, set_one(bench, 1, 1));
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, set_many(bench, 2, 2));
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, set_volts(bench, 0, 1));
}

TEST(Outputs, RefuseWhatTheRobotDoesNotHave) {
    Ready bench;
    EXPECT_EQ(ROBUROC4_ERR_RESERVED, set_one(bench, 0, 1));
    EXPECT_EQ(ROBUROC4_ERR_RESERVED, set_many(bench, 0xFF, 0));
    EXPECT_EQ(ROBUROC4_ERR_INDEX, set_one(bench, 8, 1));
    EXPECT_EQ(ROBUROC4_ERR_INDEX, set_one(bench, 63, 1));
    EXPECT_EQ(ROBUROC4_ERR_INDEX, set_many(bench, 0x102, 0)) << "all or none";
    EXPECT_EQ(ROBUROC4_ERR_INDEX, set_volts(bench, 0, 1)) << "it has no analog outputs";
    bench.run(second);
    EXPECT_TRUE(bench.robot.output_commands.empty());
}

TEST(Outputs, BeyondTheLastAreRefusedWhateverTheCardHas) {
    for (const std::int32_t count : {0, 1, 3, 16, 63}) {
        SCOPED_TRACE(count);
        ScriptedRobot robot;
        robot.iocard.analog_outputs = std::min(count, 4);
        robot.iocard.digital_outputs = count;
        Ready bench(robot);
        const auto beyond = static_cast<std::uint32_t>(count);
        for (const std::uint32_t index : {beyond, beyond + 1, beyond + 2, 63U, 64U, UINT32_MAX}) {
            if (index >= 4 || count < 4) {
                EXPECT_EQ(ROBUROC4_ERR_INDEX, set_volts(bench, index, 1)) << index;
            }
            if (index < 64) {
                EXPECT_EQ(index == 0 ? ROBUROC4_ERR_RESERVED : ROBUROC4_ERR_INDEX,
                          set_one(bench, index, 1))
                    << index;
            }
        }
        bench.run(second);
        EXPECT_TRUE(robot.output_commands.empty());
    }
}

TEST(Outputs, AreSentAtOnceAndTwiceMore) {
    Ready bench;
    const std::uint64_t start_us = bench.now_us;
    ASSERT_EQ(ROBUROC4_OK, set_one(bench, 3, 1));
    bench.run(2 * second);
    ASSERT_EQ(3U, bench.robot.output_commands.size());
    EXPECT_EQ(start_us, bench.robot.output_commands[0].first);
    for (const auto &[at_us, bytes] : bench.robot.output_commands)
        EXPECT_EQ(from_hex("FF 02 00 08"), bytes);
    EXPECT_EQ(start_us + 50 * ms, bench.robot.output_commands[1].first);
    EXPECT_EQ(start_us + 100 * ms, bench.robot.output_commands[2].first);
}

TEST(Outputs, ThatChangeWhileTheyAreRepeatedAreSentAnewThreeTimes) {
    Ready bench;
    ASSERT_EQ(ROBUROC4_OK, set_one(bench, 3, 1));
    bench.run(70 * ms); /* sent twice */
    bench.robot.output_commands.clear();
    ASSERT_EQ(ROBUROC4_OK, set_one(bench, 4, 1));
    bench.run(2 * second);
    EXPECT_EQ(3U, bench.robot.output_commands.size());
}

TEST(Outputs, AreSentToTheMicrosecondWhenPolledOnlyAtDeadlines) {
    ScriptedRobot robot;
    robot.iocard.analog_outputs = 1;
    Ready bench(robot);
    bench.run(3700); /* so that neither a status nor a question falls on it */
    for (const bool analog : {false, true}) {
        robot.output_commands.clear();
        const std::uint64_t start_us = bench.now_us;
        ASSERT_EQ(ROBUROC4_OK, analog ? set_volts(bench, 0, 1) : set_one(bench, 3, 1));
        EXPECT_LE(roburoc4_client_next_deadline(&bench.client), bench.client_us()) << "now";
        bench.run(second);
        ASSERT_EQ(3U, robot.output_commands.size());
        for (std::size_t i = 0; i < 3; i++)
            EXPECT_EQ(start_us + i * 50 * ms, robot.output_commands[i].first);
    }
}

TEST(Outputs, AreAlsoSentAtOnceAtTimeZero) {
    RobotBench bench;
    bench.skew_us = -static_cast<std::int64_t>(bench.now_us);
    bench.start();
    ASSERT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
    ASSERT_EQ(ROBUROC4_OK, set_one(bench, 3, 1));
    bench.pump();
    EXPECT_EQ(1U, bench.robot.output_commands.size());
}

TEST(Outputs, AreLeftAloneByAPose) {
    ScriptedRobot robot;
    robot.iocard.analog_outputs = 2;
    Ready bench(robot);
    ASSERT_EQ(ROBUROC4_OK, set_volts(bench, 0, 2.5F));
    ASSERT_EQ(ROBUROC4_OK, set_volts(bench, 1, 2.5F));
    ASSERT_EQ(ROBUROC4_OK, set_one(bench, 3, 1));
    ASSERT_EQ(ROBUROC4_OK, relocalize(bench, -1.5, -2.5, -3.5));
    bench.run(second);
    EXPECT_EQ(from_hex("FF 02 00  00 00 20 40  00 00 20 40  08"),
              robot.output_commands.back().second);
}

TEST(Outputs, AreKeptOverALossOfTheSameRobot) {
    Ready bench;
    ASSERT_EQ(ROBUROC4_OK, set_one(bench, 3, 1));
    bench.run(second);
    bench.robot.powered = false;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    bench.robot.powered = true;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    EXPECT_EQ(ROBUROC4_ERR_NOT_READY, set_one(bench, 1, 1)) << "it may be another robot";
    bench.run(100 * ms);
    ASSERT_EQ(ROBUROC4_OK, set_one(bench, 1, 1));
    bench.run(second);
    EXPECT_EQ(from_hex("FF 02 00 0A"), bench.robot.output_commands.back().second);
}

TEST(Outputs, AreNotRepeatedToARobotThatIsLost) {
    roburoc4_config config = default_config();
    config.lost_ms = 200;
    Ready bench(config);
    bench.robot.powered = false;
    bench.run_to(bench.now_us - bench.link().silence_us + 180 * ms);
    ASSERT_EQ(ROBUROC4_OK, set_one(bench, 1, 1));
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    bench.sent.clear();
    bench.run(500 * ms);
    for (const Bench::Datagram &datagram : bench.sent)
        EXPECT_NE(ROBUROC4_HEADER_STATUS, datagram.bytes[0]) << "whose card is it now?";
}

TEST(Outputs, AreNotRepeatedToACardThatTurnsOutToBeAnother) {
    Ready bench;
    const auto asked = [&] {
        return bench.robot.seen(ROBUROC4_ACTION_GET, ROBUROC4_SERVICE_IOCARD).size();
    };
    bench.delay_to_client = [] { return 20 * ms; };
    bench.robot.iocard.digital_inputs++;
    const std::size_t before = asked();
    ASSERT_TRUE(bench.run_until([&] { return asked() > before; })) << "by the probe";
    ASSERT_EQ(ROBUROC4_OK,
              roburoc4_client_set_digital_outputs(&bench.client, 2, 2, bench.client_us()));
    bench.run(500 * ms);
    EXPECT_EQ(1U, bench.robot.output_commands.size());
}

TEST(Outputs, FromBeforeARebootOrOfAnotherCardAreForgotten) {
    for (const bool reboot : {false, true}) {
        SCOPED_TRACE(reboot);
        ScriptedRobot robot;
        robot.iocard.analog_outputs = 2;
        Ready bench(robot);
        ASSERT_EQ(ROBUROC4_OK, set_volts(bench, 1, 2.5F));
        ASSERT_EQ(ROBUROC4_OK, set_one(bench, 3, 1));
        bench.run(second);
        if (reboot)
            robot.reboot();
        else
            robot.iocard.digital_inputs++;
        bench.run(20 * second);
        ASSERT_EQ(reboot ? 1U : 0U, bench.count(ROBUROC4_COUNT_REBOOTS));
        ASSERT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
        ASSERT_EQ(ROBUROC4_OK, set_one(bench, 1, 1));
        bench.pump();
        EXPECT_EQ(from_hex("FF 02 00  00 00 00 00  00 00 00 00  02"),
                  robot.output_commands.back().second);
    }
}

TEST(Outputs, AreNotRepeatedWhileAnotherDirectoryIsDiscovered) {
    Ready bench;
    const auto asked = [&] { return bench.robot.seen(ROBUROC4_ACTION_GET, 0).size(); };
    bench.delay_to_client = [] { return 20 * ms; };
    bench.robot.texts_silent = true; /* so that it takes its time */
    bench.robot.services.push_back({0x1234, 77, 99, "Coffee machine"});
    const std::size_t before = asked();
    ASSERT_TRUE(bench.run_until([&] { return asked() > before; })) << "by the probe";
    ASSERT_EQ(ROBUROC4_OK, set_one(bench, 1, 1));
    bench.run(500 * ms);
    ASSERT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_DISCOVERING), bench.state());
    EXPECT_EQ(1U, bench.robot.output_commands.size()) << "which id has the card now?";
}

TEST(Outputs, ThatWereNeverSetAreZeroAndTheOthersAreKept) {
    ScriptedRobot robot;
    robot.iocard.analog_outputs = 3;
    robot.iocard.digital_outputs = 12;
    Ready bench(robot);
    const auto last = [&] {
        bench.pump();
        return robot.output_commands.back().second;
    };
    ASSERT_EQ(ROBUROC4_OK, set_volts(bench, 1, 2.5F));
    EXPECT_EQ(from_hex("FF 02 00  00 00 00 00  00 00 20 40  00 00 00 00  00 00"), last());
    ASSERT_EQ(ROBUROC4_OK, set_one(bench, 11, 1));
    EXPECT_EQ(from_hex("FF 02 00  00 00 00 00  00 00 20 40  00 00 00 00  00 08"), last());
    ASSERT_EQ(ROBUROC4_OK, set_many(bench, 0xFFE, 0x0F6));
    EXPECT_EQ(from_hex("FF 02 00  00 00 00 00  00 00 20 40  00 00 00 00  F6 00"), last());
    ASSERT_EQ(ROBUROC4_OK, set_one(bench, 2, 0));
    EXPECT_EQ(from_hex("FF 02 00  00 00 00 00  00 00 20 40  00 00 00 00  F2 00"), last());
    ASSERT_EQ(ROBUROC4_OK, set_many(bench, 0x004, 0xF0F)) << "only those in the mask";
    EXPECT_EQ(from_hex("FF 02 00  00 00 00 00  00 00 20 40  00 00 00 00  F6 00"), last());
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
        EXPECT_EQ(ROBUROC4_ERR_NOT_FINITE, set_volts(bench, 0, bad));
    EXPECT_EQ(ROBUROC4_ERR_INDEX, set_volts(bench, 3, 1));
}

TEST(Outputs, OfTheLargestCardFitTheLongestDatagram) {
    ScriptedRobot robot;
    robot.iocard.analog_outputs = 4;
    robot.iocard.digital_outputs = 64;
    Started bench(robot);
    bench.run(3 * second);
    ASSERT_EQ(ROBUROC4_OK, set_volts(bench, 3, 1));
    ASSERT_EQ(ROBUROC4_OK, set_one(bench, 63, 1));
    bench.pump();
    const Bytes bytes = robot.output_commands.back().second;
    EXPECT_EQ(27U, bytes.size());
    EXPECT_LE(bytes.size(), static_cast<std::size_t>(ROBUROC4_MAX_TRANSMIT));
    EXPECT_EQ(0x80, bytes.back());
}

/* ---- relocalization ---- */

TEST(Relocalize, IsRepeatedOnlyWhileTheRobotIsAtRest) {
    enum { AT_REST, DRIVEN_BEFORE, DRIVEN_AFTER, ROLLS, ROLLS_LATER, NOT_KNOWN, NAN_SPEED, CASES };
    for (int way = 0; way < CASES; way++) {
        SCOPED_TRACE(way);
        ScriptedRobot robot;
        robot.replace_silent = true;
        Armed bench(robot);
        robot.follows = way < ROLLS;
        const auto roll = [&] { robot.current_angular = 0.1F; };
        if (way == DRIVEN_BEFORE)
            bench.driving(0.5F, 0, 200 * ms);
        if (way == ROLLS)
            roll();
        if (way == NAN_SPEED)
            robot.current_linear = NAN;
        if (way == NOT_KNOWN)
            robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = true;
        bench.run(way == NOT_KNOWN ? 350 * ms : 60 * ms);
        if (way == DRIVEN_BEFORE) {
            ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0));
        }
        bench.take_events();
        robot.requests.clear();
        const std::uint64_t call_us = bench.now_us;
        ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
        bench.pump();
        ASSERT_EQ(1U, robot.seen(ROBUROC4_ACTION_REPLACE).size()) << "at once";
        EXPECT_EQ(call_us, robot.seen(ROBUROC4_ACTION_REPLACE)[0].at_us);
        EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, bench.facts().relocalize_result);
        if (way == DRIVEN_AFTER) {
            ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0));
        }
        if (way == ROLLS_LATER)
            roll();
        bench.run(second);
        const std::size_t tries = robot.seen(ROBUROC4_ACTION_REPLACE).size();
        if (way == AT_REST) {
            EXPECT_GE(tries, 3U);
            EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, bench.facts().relocalize_result);
            continue;
        }
        EXPECT_LE(tries, way == ROLLS_LATER ? 2U : 1U) << "a status comes before it is noticed";
        if (way == NOT_KNOWN) {
            robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = false;
            bench.run(second);
            EXPECT_EQ(1U, robot.seen(ROBUROC4_ACTION_REPLACE).size()) << "nor afterwards";
            EXPECT_EQ(ROBUROC4_ERR_TIMEOUT, bench.facts().relocalize_result);
            continue;
        }
        EXPECT_EQ(ROBUROC4_ERR_MOVING, bench.facts().relocalize_result);
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_RELOCALIZE_FAILED);
        bench.run(2 * second);
        EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_RELOCALIZE_FAILED) << "once";
    }
}

TEST(Relocalize, ThatIsAnsweredAtOnceHoldsInMotionToo) {
    Armed bench;
    bench.delay_to_client = [] { return 10 * ms; };
    bench.driving(0.5F, 0, 200 * ms);
    ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
    bench.driving(0.5F, 0, 200 * ms);
    EXPECT_EQ(ROBUROC4_OK, bench.facts().relocalize_result);
    EXPECT_EQ(1U, bench.robot.seen(ROBUROC4_ACTION_REPLACE).size());
}

TEST(Relocalize, ThatOnlyTheSecondTryBringsDoesNotHoldInMotion) {
    for (const std::size_t tries : {1U, 2U}) {
        ScriptedRobot robot;
        std::vector<Bytes> answers;
        robot.instead = [&answers](const roburoc4_request &r, std::vector<Bytes> &) {
            if (r.action == ROBUROC4_ACTION_REPLACE)
                answers.push_back(plain_answer(r.id, r.action, r.service, 0));
            return r.action == ROBUROC4_ACTION_REPLACE;
        };
        Armed bench(robot);
        ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
        ASSERT_TRUE(bench.run_until([&] { return answers.size() == tries; }, 200 * ms));
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0));
        bench.receive(answers.back());
        EXPECT_EQ(tries == 1 ? ROBUROC4_OK : ROBUROC4_ERR_MOVING, bench.facts().relocalize_result);
    }
}

TEST(Relocalize, AnAnswerToThePoseBeforeIsNoneToTheNext) {
    Ready bench;
    bench.robot.replace_silent = true;
    ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
    bench.pump();
    ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 4, 5, 6));
    bench.pump();
    const auto sent = bench.robot.seen(ROBUROC4_ACTION_REPLACE);
    ASSERT_EQ(2U, sent.size()) << "each at once";
    EXPECT_EQ(4, sent[1].what.x_m);
    EXPECT_EQ(ROBUROC4_ERR_UNMATCHED,
              bench.receive(
                  plain_answer(sent[0].what.id, ROBUROC4_ACTION_REPLACE, sent[0].what.service, 0)));
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, bench.facts().relocalize_result);
}

TEST(Relocalize, ThatIsTakenLateFailsUnlessTheRobotHasRested) {
    enum { AT_REST, MOVES, NOT_KNOWN, NO_LONGER_KNOWN, CASES };
    for (int way = 0; way < CASES; way++) {
        SCOPED_TRACE(way);
        ScriptedRobot robot;
        std::vector<Bytes> late;
        robot.follows = false;
        robot.instead = [&late](const roburoc4_request &r, std::vector<Bytes> &) {
            if (r.action == ROBUROC4_ACTION_REPLACE)
                late.push_back(plain_answer(r.id, r.action, r.service, 0));
            return r.action == ROBUROC4_ACTION_REPLACE;
        };
        Ready bench(robot);
        if (way == MOVES || way == NOT_KNOWN) {
            robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = true;
            bench.run(350 * ms);
        }
        ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
        bench.run(500 * ms);
        if (way == MOVES) {
            robot.current_linear = 0.5F;
            robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = false;
        }
        bench.run(1200 * ms);
        robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = way == NO_LONGER_KNOWN;
        bench.run(200 * ms);
        ASSERT_FALSE(late.empty());
        bench.receive(late.front());
        EXPECT_EQ(way == AT_REST ? ROBUROC4_OK
                  : way == MOVES ? ROBUROC4_ERR_MOVING
                                 : ROBUROC4_ERR_STALE_DIFFERENTIAL,
                  bench.facts().relocalize_result);
        robot.current_linear = 0;
        robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = false;
        bench.run(500 * ms);
        ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
        bench.run(500 * ms);
        bench.receive(late.back());
        EXPECT_EQ(ROBUROC4_OK, bench.facts().relocalize_result) << "the next begins anew";
    }
}

/** How long ago it was given is not known then. */
TEST(Relocalize, ThatWaitsWhenThisClockGoesBackIsSentOnlyAtRest) {
    for (const float speed : {0.5F, 0.0F}) {
        SCOPED_TRACE(speed);
        Armed bench;
        bench.driving(speed, 0, 200 * ms);
        ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
        bench.now_us += 600 * ms; /* nobody polls */
        bench.skew_us -= static_cast<std::int64_t>(100 * second);
        bench.run(2 * second);
        EXPECT_EQ(0U, bench.robot.seen(ROBUROC4_ACTION_REPLACE).size());
        EXPECT_EQ(speed > 0 ? ROBUROC4_ERR_MOVING : ROBUROC4_ERR_TIMEOUT,
                  bench.facts().relocalize_result);
    }
}

/** Unseen, the robot may have moved and come to rest again. */
TEST(Relocalize, ThatWaitsWhileNothingIsHeardIsNotSent) {
    Armed bench;
    bench.robot.requests.clear();
    ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
    bench.now_us += 600 * ms; /* nobody polls */
    EXPECT_EQ(0, bench.receive(bench.robot.status_at(ROBUROC4_SERVICE_DIFFERENTIAL,
                                                     bench.robot.cycles() + 60)));
    bench.run(3 * second);
    EXPECT_EQ(0U, bench.robot.seen(ROBUROC4_ACTION_REPLACE).size());
    EXPECT_EQ(ROBUROC4_ERR_TIMEOUT, bench.facts().relocalize_result);
}

TEST(Relocalize, IsAnsweredWithAnEvent) {
    Ready bench;
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, bench.facts().relocalize_result);
    ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1.5, -2.5, 0.75));
    bench.run(10 * ms);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_RELOCALIZED);
    EXPECT_EQ(ROBUROC4_OK, bench.facts().relocalize_result);
    const auto sent = bench.robot.seen(ROBUROC4_ACTION_REPLACE);
    ASSERT_EQ(1U, sent.size());
    EXPECT_EQ(5, sent[0].what.service);
    EXPECT_EQ(1.5, sent[0].what.x_m);
    EXPECT_EQ(-2.5, sent[0].what.y_m);
    EXPECT_EQ(0.75, sent[0].what.theta_rad);
    EXPECT_GE(sent[0].what.timestamp, 1000U) << "the last known count";
    EXPECT_LE(sent[0].what.timestamp, bench.robot.cycles());
}

TEST(Relocalize, ThatIsRefusedIsAnEvent) {
    ScriptedRobot robot;
    robot.replace_refused = true;
    Ready bench(robot);
    ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
    bench.run(10 * ms);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_RELOCALIZE_FAILED);
    EXPECT_EQ(ROBUROC4_ERR_ROBOT, bench.facts().relocalize_result);
}

TEST(Relocalize, ThatIsNotAnsweredEndsAfterTwoSeconds) {
    ScriptedRobot robot;
    robot.replace_silent = true;
    Ready bench(robot);
    ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
    bench.run(2 * second - 1);
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_RELOCALIZE_FAILED);
    EXPECT_GE(robot.seen(ROBUROC4_ACTION_REPLACE).size(), 4U);
    bench.run(1);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_RELOCALIZE_FAILED);
    EXPECT_EQ(ROBUROC4_ERR_TIMEOUT, bench.facts().relocalize_result);
    robot.requests.clear();
    bench.run(5 * second);
    EXPECT_TRUE(robot.seen(ROBUROC4_ACTION_REPLACE).empty());
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_RELOCALIZE_FAILED) << "once";
}

TEST(Relocalize, EndsAfterTwoSecondsFromAnyTimeOn) {
    for (const std::uint64_t since_us : {std::uint64_t{0}, std::uint64_t{1}, second, 4 * second}) {
        SCOPED_TRACE(since_us);
        ScriptedRobot robot;
        robot.replace_silent = true;
        Bench bench(robot);
        bench.skew_us = -static_cast<std::int64_t>(bench.now_us);
        bench.start();
        ASSERT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
        bench.run(since_us);
        ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
        bench.run(2 * second - 1);
        EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, bench.facts().relocalize_result);
        bench.run(1);
        EXPECT_EQ(ROBUROC4_ERR_TIMEOUT, bench.facts().relocalize_result);
    }
}

TEST(Relocalize, EndsToTheMicrosecondWhenPolledOnlyAtDeadlines) {
    ScriptedRobot robot;
    robot.replace_silent = true;
    Ready bench(robot);
    bench.run(3700); /* so that neither a status nor a question falls on its end */
    const std::uint64_t since_us = bench.now_us;
    ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
    ASSERT_TRUE(
        bench.run_until([&] { return bench.facts().relocalize_result == ROBUROC4_ERR_TIMEOUT; }));
    EXPECT_EQ(2 * second, bench.now_us - since_us);
}

TEST(Relocalize, LaterOneReplacesAnOpenOne) {
    ScriptedRobot robot;
    robot.replace_silent = true;
    Ready bench(robot);
    ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
    bench.run(250 * ms);
    robot.replace_silent = false;
    const std::uint64_t second_us = bench.now_us;
    ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 4, 5, 6));
    bench.run(3 * second);
    for (const auto &r : robot.seen(ROBUROC4_ACTION_REPLACE))
        EXPECT_EQ(r.at_us < second_us ? 1 : 4, r.what.x_m);
    EXPECT_EQ(4, robot.pose[0]);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_RELOCALIZED);
}

TEST(Relocalize, HasNoResultWhileItIsOpen) {
    Ready bench;
    ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
    bench.run(10 * ms);
    ASSERT_EQ(ROBUROC4_OK, bench.facts().relocalize_result);
    bench.robot.replace_silent = true;
    ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 4, 5, 6));
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, bench.facts().relocalize_result) << "that was of another";
    bench.run(2 * second - 1);
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, bench.facts().relocalize_result);
}

TEST(Relocalize, IsRefusedIfItIsImpossible) {
    ScriptedRobot robot;
    robot.remove(ROBUROC4_SERVICE_LOCALIZATION);
    Bench bench(robot);
    EXPECT_EQ(ROBUROC4_ERR_NOT_READY, relocalize(bench, 1, 2, 3));
    bench.ready();
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, relocalize(bench, 1, 2, 3));
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
        EXPECT_EQ(ROBUROC4_ERR_NOT_FINITE, relocalize(bench, bad, 0, 0));
        EXPECT_EQ(ROBUROC4_ERR_NOT_FINITE, relocalize(bench, 0, bad, 0));
        EXPECT_EQ(ROBUROC4_ERR_NOT_FINITE, relocalize(bench, 0, 0, bad));
    }
    for (const double degrees : {90.0, -45.0})
        EXPECT_EQ(ROBUROC4_ERR_UNITS, relocalize(bench, 0, 0, degrees));
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, relocalize(bench, 0, 0, -12.5)) << "two turns";
}

TEST(Relocalize, SendsOneAsTimestampIfNoCountIsKnown) {
    roburoc4_config config = default_config();
    config.subscriptions = 0;
    Ready bench(config);
    ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
    bench.pump();
    EXPECT_EQ(1U, bench.robot.seen(ROBUROC4_ACTION_REPLACE).at(0).what.timestamp);
}

TEST(Relocalize, ThatALossInterruptsEndsInAnEvent) {
    roburoc4_config config = default_config();
    config.lost_ms = 300;
    Ready bench(config);
    bench.robot.powered = false;
    ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
    bench.run(5 * second);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_RELOCALIZE_FAILED);
    EXPECT_EQ(ROBUROC4_ERR_TIMEOUT, bench.facts().relocalize_result);
}

TEST(Relocalize, EndsWithTheRobotThatItWasMeantFor) {
    for (int way = 0; way < 3; way++) {
        SCOPED_TRACE(way);
        ScriptedRobot robot;
        robot.replace_silent = true;
        roburoc4_config config = default_config();
        config.lost_ms = 200;
        Ready bench(robot, config);
        const auto asked = [&] { return robot.seen(ROBUROC4_ACTION_GET, 0).size(); };
        const std::size_t before = asked();
        if (way == 2) { /* another directory, found by the next probe */
            bench.delay_to_client = [] { return 20 * ms; };
            robot.remove(ROBUROC4_SERVICE_LOCALIZATION);
            ASSERT_TRUE(bench.run_until([&] { return asked() > before; }));
        }
        ASSERT_EQ(ROBUROC4_OK, relocalize(bench, 1, 2, 3));
        bench.run(10 * ms);
        ASSERT_EQ(ROBUROC4_ERR_NOT_KNOWN, bench.facts().relocalize_result);
        if (way == 0) {
            robot.powered = false;
            ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST, 250 * ms));
            robot.powered = true;
        } else if (way == 1) {
            for (std::uint64_t i = 0; i < 3; i++)
                bench.receive(robot.status_at(ROBUROC4_SERVICE_DIFFERENTIAL, i));
            ASSERT_EQ(1U, bench.count(ROBUROC4_COUNT_REBOOTS));
        } else {
            ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_DISCOVERING, 50 * ms));
        }
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_RELOCALIZE_FAILED);
        EXPECT_EQ(ROBUROC4_ERR_TIMEOUT, bench.facts().relocalize_result);
        robot.requests.clear();
        bench.run(3 * second);
        EXPECT_TRUE(robot.seen(ROBUROC4_ACTION_REPLACE).empty());
    }
}

/* ---- subscriptions ---- */

TEST(Subscribe, ChangesThePeriodAtRunTime) {
    Ready bench;
    ASSERT_EQ(ROBUROC4_OK, subscribe(bench, ROBUROC4_SERVICE_BATTERY, 2550));
    ASSERT_EQ(ROBUROC4_OK, subscribe(bench, ROBUROC4_SERVICE_DIFFERENTIAL, 10));
    bench.pump();
    EXPECT_EQ(255, bench.robot.subscriptions[4]);
    EXPECT_EQ(1, bench.robot.subscriptions[6]);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
}

TEST(Subscribe, RefusesInvalidPeriodsAndServices) {
    Ready bench;
    for (const std::uint32_t period : {1U, 5U, 15U, 2560U, UINT32_MAX})
        EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, subscribe(bench, 6, period));
    for (const std::uint32_t service : {0U, 1U, 7U, UINT32_MAX}) {
        EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, subscribe(bench, service, 50));
        EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, unsubscribe(bench, service));
    }
}

TEST(Subscribe, AsksForTheNewPeriodWhileStatusesOfTheOldOneCome) {
    Ready bench;
    bench.robot.service(ROBUROC4_SERVICE_LOCALIZATION).insert_silent = true;
    ASSERT_EQ(ROBUROC4_OK, subscribe(bench, ROBUROC4_SERVICE_LOCALIZATION, 100));
    bench.run(5 * second); /* it is given up */
    bench.robot.service(ROBUROC4_SERVICE_LOCALIZATION).insert_silent = false;
    bench.run(10 * second); /* and tried again later */
    EXPECT_EQ(10, bench.robot.subscriptions[5]);
    EXPECT_EQ(100000U, bench.service_link(ROBUROC4_SERVICE_LOCALIZATION).period_us);
    EXPECT_EQ(1U, bench.service_link(ROBUROC4_SERVICE_LOCALIZATION).subscribed);
}

TEST(Subscribe, IsKeptOverALossAndANewStart) {
    ScriptedRobot robot;
    roburoc4_config config = default_config();
    config.subscriptions = 0;
    Ready bench(robot, config);
    EXPECT_TRUE(robot.subscriptions.empty());
    ASSERT_EQ(ROBUROC4_OK, subscribe(bench, ROBUROC4_SERVICE_TELEMETER, 70));
    bench.pump();
    EXPECT_EQ(7, robot.subscriptions[3]);
    robot.powered = false;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    robot.reboot();
    robot.powered = true;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    bench.run(second);
    EXPECT_EQ(7, robot.subscriptions[3]);
    ASSERT_EQ(ROBUROC4_OK, bench.close());
    robot.subscriptions.clear();
    bench.ready();
    EXPECT_EQ(7, robot.subscriptions[3]);
}

TEST(Unsubscribe, EndsTheStatuses) {
    Ready bench;
    ASSERT_EQ(ROBUROC4_OK, unsubscribe(bench, ROBUROC4_SERVICE_TELEMETER));
    bench.pump();
    EXPECT_EQ(0U, bench.robot.subscriptions.count(3));
    EXPECT_EQ(0U, bench.service_link(ROBUROC4_SERVICE_TELEMETER).subscribed);
    bench.run(10 * second);
    EXPECT_EQ(1U, bench.robot.seen(ROBUROC4_ACTION_DELETE).size());
    EXPECT_EQ(1U, bench.robot.seen(ROBUROC4_ACTION_INSERT, 3).size());
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, bench.facts().relocalize_result)
        << "its answer is no other's";
}

TEST(Unsubscribe, SurvivesARefusalAndDropsWhatStillArrives) {
    ScriptedRobot robot;
    robot.delete_refused = true;
    Ready bench(robot);
    roburoc4_distances before;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_distances(&bench.client, &before, nullptr));
    ASSERT_EQ(ROBUROC4_OK, unsubscribe(bench, ROBUROC4_SERVICE_TELEMETER));
    robot.distances = {0.1F, 0.1F};
    bench.run(2 * second);
    EXPECT_GE(bench.count(ROBUROC4_COUNT_UNEXPECTED_STATUS), 19U);
    EXPECT_EQ(1U, robot.seen(ROBUROC4_ACTION_DELETE).size());
    roburoc4_distances after;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_distances(&bench.client, &after, nullptr));
    EXPECT_EQ(before.robot_cycles, after.robot_cycles);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
}

TEST(Unsubscribe, IsKeptOverALossAndANewStart) {
    ScriptedRobot robot;
    Ready bench(robot);
    ASSERT_EQ(ROBUROC4_OK, unsubscribe(bench, ROBUROC4_SERVICE_TELEMETER));
    bench.run(second);
    robot.powered = false;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    robot.reboot();
    robot.powered = true;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    bench.run(5 * second);
    EXPECT_EQ(0U, robot.subscriptions.count(3));
    EXPECT_EQ(4U, robot.subscriptions.size());
    ASSERT_EQ(ROBUROC4_OK, bench.close());
    robot.subscriptions.clear();
    bench.ready();
    EXPECT_EQ(0U, robot.subscriptions.count(3));
    EXPECT_EQ(4U, robot.subscriptions.size());
}

TEST(Unsubscribe, AlsoEndsASubscriptionThatIsStillRequested) {
    ScriptedRobot robot;
    Ready bench(robot);
    robot.service(ROBUROC4_SERVICE_TELEMETER).insert_silent = true;
    ASSERT_EQ(ROBUROC4_OK, subscribe(bench, ROBUROC4_SERVICE_TELEMETER, 70));
    bench.run(150 * ms);
    ASSERT_EQ(ROBUROC4_OK, unsubscribe(bench, ROBUROC4_SERVICE_TELEMETER));
    robot.service(ROBUROC4_SERVICE_TELEMETER).insert_silent = false;
    robot.requests.clear();
    bench.take_events();
    bench.run(5 * second);
    EXPECT_EQ(0U, robot.seen(ROBUROC4_ACTION_INSERT).size());
    EXPECT_EQ(1U, robot.seen(ROBUROC4_ACTION_DELETE, ROBUROC4_SERVICE_TELEMETER).size());
    EXPECT_EQ(0U, robot.subscriptions.count(3));
    EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_SUBSCRIPTION_REFUSED);
}

TEST(Unsubscribe, TakesThePeriodOutOfTheSilenceThatIsALoss) {
    roburoc4_config config = default_config();
    config.lost_ms = 200;
    config.subscriptions = 1U << ROBUROC4_SERVICE_TELEMETER | 1U << ROBUROC4_SERVICE_BATTERY;
    config.period_ms[ROBUROC4_SERVICE_TELEMETER] = 50;
    config.period_ms[ROBUROC4_SERVICE_BATTERY] = 600;
    Ready bench(config);
    ASSERT_EQ(ROBUROC4_OK, unsubscribe(bench, ROBUROC4_SERVICE_TELEMETER));
    bench.run(10 * second);
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_LOST)) << "three of 600 ms";
}

/* It may belong to another client: whether clients share subscriptions is unknown. */
TEST(Unsubscribe, EndsNothingThatThisClientNeverSubscribedTo) {
    roburoc4_config config = default_config();
    config.subscriptions &= ~(1U << ROBUROC4_SERVICE_TELEMETER);
    Ready bench(config);
    EXPECT_EQ(ROBUROC4_OK, unsubscribe(bench, ROBUROC4_SERVICE_TELEMETER));
    bench.run(2 * second);
    EXPECT_EQ(0U, bench.robot.seen(ROBUROC4_ACTION_DELETE).size());
    EXPECT_EQ(ROBUROC4_OK, unsubscribe(bench, ROBUROC4_SERVICE_BATTERY));
    bench.run(2 * second);
    EXPECT_EQ(ROBUROC4_OK, unsubscribe(bench, ROBUROC4_SERVICE_BATTERY)) << "once is enough";
    bench.run(2 * second);
    EXPECT_EQ(1U, bench.robot.seen(ROBUROC4_ACTION_DELETE).size());
}

TEST(Unsubscribe, ThenSubscribeRestartsTheStatuses) {
    Ready bench;
    ASSERT_EQ(ROBUROC4_OK, unsubscribe(bench, ROBUROC4_SERVICE_TELEMETER));
    bench.run(second);
    ASSERT_EQ(ROBUROC4_OK, subscribe(bench, ROBUROC4_SERVICE_TELEMETER, 50));
    bench.take_events();
    bench.run(second);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_TELEMETER);
    EXPECT_EQ(5, bench.robot.subscriptions[3]);
}

TEST(Subscribe, IsRequestedAtOnceWhateverWasRefusedBefore) {
    for (int way = 0; way < 4; way++) {
        SCOPED_TRACE(way);
        ScriptedRobot robot;
        ScriptedService &telemeter = robot.service(ROBUROC4_SERVICE_TELEMETER);
        telemeter.insert_refused = way == 0;
        Ready bench(robot);
        telemeter.insert_refused = false;
        if (way == 1) { /* is requested with another period, so far without an answer */
            telemeter.insert_silent = true;
            ASSERT_EQ(ROBUROC4_OK, subscribe(bench, ROBUROC4_SERVICE_TELEMETER, 200));
            bench.run(450 * ms);
            telemeter.insert_silent = false;
        } else if (way == 2) { /* its end is owed, and not sent yet */
            ASSERT_EQ(ROBUROC4_OK, unsubscribe(bench, ROBUROC4_SERVICE_TELEMETER));
        } else if (way == 3) { /* its end was sent, but not answered yet */
            bench.drop_to_robot = everything;
            ASSERT_EQ(ROBUROC4_OK, unsubscribe(bench, ROBUROC4_SERVICE_TELEMETER));
            bench.pump();
            bench.drop_to_robot = nullptr;
        }
        robot.requests.clear();
        const auto cycles = [&] {
            const auto found = robot.subscriptions.find(3);
            return found == robot.subscriptions.end() ? 0 : int{found->second};
        };
        ASSERT_EQ(ROBUROC4_OK, subscribe(bench, ROBUROC4_SERVICE_TELEMETER, 70));
        bench.pump();
        EXPECT_EQ(7, cycles());
        bench.run(2 * second);
        EXPECT_EQ(7, cycles()) << "nothing of before ends it";
        EXPECT_EQ(1U, robot.seen(ROBUROC4_ACTION_INSERT).size());
        EXPECT_EQ(0U, robot.seen(ROBUROC4_ACTION_DELETE).size());
    }
}

/* ---- another robot ---- */

/** The other one has the same list of services, but other texts. */
TEST(Outputs, NeverGoToAServiceThatTheRobotBeforeHadThere) {
    for (const bool subscribed : {true, false}) {
        SCOPED_TRACE(subscribed);
        ScriptedRobot robot;
        for (ScriptedService &service : robot.services)
            service.type = 0;
        roburoc4_config config = default_config();
        config.subscriptions = subscribed ? config.subscriptions : 0;
        Ready bench(robot, config);
        ASSERT_EQ(ROBUROC4_OK, set_digital_output(&bench.client, 3, 1, bench.client_us()));
        bench.run(second);
        robot.powered = false;
        ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
        robot.reboot();
        std::swap(robot.service(ROBUROC4_SERVICE_IOCARD).id,
                  robot.service(ROBUROC4_SERVICE_BATTERY).id);
        std::swap(robot.services[2], robot.services[4]);
        for (ScriptedService &service : robot.services)
            service.mute = true; /* it accepts subscriptions, but sends nothing */
        robot.powered = true;
        robot.output_commands.clear();
        for (int i = 0; i < 100; i++) {
            set_digital_output(&bench.client, 4, 1, bench.client_us());
            bench.run(200 * ms); /* the robot complains about commands to a battery */
        }
        EXPECT_EQ(subscribed, robot.output_commands.empty());
        for (const auto &command : robot.output_commands)
            EXPECT_EQ(0x10, command.second.back()) << "nothing from before";
    }
}
