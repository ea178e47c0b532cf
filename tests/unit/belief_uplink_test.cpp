/* SPDX-License-Identifier: MIT
 *
 * Whether the client believes that its commands arrive, on robots that answer the
 * manual's open questions in other ways than the simulator (docs/PROTOCOL.md, the family).
 */
#include <gtest/gtest.h>

#include <deque>

#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

/** What arrives at the robot `delay_us` after it was sent. */
class SlowUplink {
  public:
    SlowUplink(Bench &bench, ScriptedRobot &robot) : bench_(bench), robot_(robot) {
        bench_.drop_to_robot = [this](const Bytes &bytes) {
            if (delay_us == 0 && flight_.empty())
                return false;
            flight_.emplace_back(bench_.now_us + delay_us, bytes);
            return true;
        };
    }
    std::uint64_t delay_us = 0;

    void run(std::uint64_t span_us) {
        for (const std::uint64_t end = bench_.now_us + span_us; bench_.now_us < end;) {
            bench_.run(5 * ms);
            while (!flight_.empty() && flight_.front().first <= bench_.now_us) {
                robot_.deliver(flight_.front().second);
                flight_.pop_front();
            }
        }
    }

  private:
    Bench &bench_;
    ScriptedRobot &robot_;
    std::deque<std::pair<std::uint64_t, Bytes>> flight_;
};

ScriptedRobot knows_one_id() {
    ScriptedRobot robot;
    robot.always_manual_id = true;
    return robot;
}

/** Its texts name no [A] for sure. */
roburoc4_config known_pad() {
    roburoc4_config config = default_config();
    config.role_index[ROBUROC4_ROLE_OVERRIDE] = ROBUROC4_DI_PAD_A;
    return config;
}

/** Of 256 datagrams each way, so many are lost; but no status. */
void lose(Bench &bench, std::uint32_t of_256, std::uint32_t &random) {
    const auto lost = [&random, of_256](const Bytes &) {
        random = random * 1664525U + 1013904223U;
        return random >> 24 < of_256;
    };
    bench.drop_to_robot = lost;
    bench.drop_to_client = [lost](const Bytes &bytes) { return !is_status(bytes) && lost(bytes); };
}

} // namespace

TEST(Uplink, ThatGrowsLateDisarms) {
    for (const bool steady : {true, false}) {
        SCOPED_TRACE(steady);
        Armed bench;
        SlowUplink uplink(bench, bench.robot);
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
        for (int i = 0; i < 200 && bench.facts().armed == 1; i++) {
            ASSERT_LT(uplink.delay_us, 600 * ms) << "it still commands";
            bench.drive(steady || i % 10 < 5 ? 0.5F : 0.3F, 0);
            uplink.run(50 * ms);
            uplink.delay_us += 10 * ms;
        }
        EXPECT_EQ(0, bench.facts().armed);
        EXPECT_EQ(ROBUROC4_ERR_UPLINK, bench.facts().disarm_cause);
    }
}

TEST(Uplink, ThatIsDeadDisarmsWithinHalfASecond) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
    bench.drop_to_robot = everything;
    EXPECT_EQ(ROBUROC4_ERR_UPLINK, bench.drive_until_refused(0.5F, 0, 550 * ms));
}

/** It may be about any request before that, which waited for long. */
TEST(Uplink, ThatIsDeadIsNotProvenByAnErrorThatNamesNoRequest) {
    Armed bench;
    bench.robot.service(ROBUROC4_SERVICE_TELEMETER).insert_silent = true;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
    bench.drop_to_robot = everything;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 100 * ms));
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_subscribe(&bench.client, ROBUROC4_SERVICE_TELEMETER, 70,
                                                     bench.client_us()));
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 150 * ms));
    ASSERT_EQ(ROBUROC4_OK, bench.receive(Bytes{ROBUROC4_HEADER_ERROR}));
    EXPECT_EQ(ROBUROC4_ERR_UPLINK, bench.drive_until_refused(0.5F, 0, 250 * ms));
}

TEST(Uplink, IsWatchedByEveryTargetThatDiffersFromTheReportedOne) {
    for (const auto &[linear, angular] :
         {std::pair(0.0F, 0.0201F), {0.0F, 0.0244F}, {0.0F, -0.0249F}, {0.0201F, 0.0F}}) {
        for (const bool again : {false, true}) {
            SCOPED_TRACE(testing::Message() << linear << " " << angular << " " << again);
            Armed bench;
            if (again) {
                ASSERT_NO_FATAL_FAILURE(bench.driving(linear, angular, second));
                bench.pause();
                bench.run(1020 * ms);
            }
            bench.robot.follows = false;
            EXPECT_GT(0, bench.drive_until_refused(linear, angular, 550 * ms));
        }
    }
    Armed bench;
    bench.robot.follows = false;
    EXPECT_EQ(ROBUROC4_OK, bench.drive_until_refused(0, 0.0199F, 2 * second)) << "rounding";
}

TEST(Uplink, IsWatchedWhileTargetsSwingAroundTheReportedOne) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.3F, 0.3F, second));
    bench.robot.follows = false;
    for (int i = 0; i < 12 && bench.facts().armed == 1; i++) {
        bench.drive(i % 2 == 0 ? 0.1F : 0.5F, i % 2 == 0 ? 0.5F : 0.1F);
        bench.run(50 * ms);
    }
    EXPECT_EQ(0, bench.facts().armed);
}

TEST(Uplink, OfALeaseThatEndedSaysNothingOfTheNext) {
    Armed bench;
    for (int lease = 0; lease < 2; lease++) {
        bench.robot.follows = false; /* its target appears late, or no more */
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 150 * ms)) << lease;
        bench.robot.follows = true;
        if (lease == 0) {
            bench.pause();
            bench.run(second);
        }
    }
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
}

TEST(Uplink, ThatLosesOneCommandDisarmsNobodyHoweverSeldomTheyAre) {
    roburoc4_config config = default_config();
    config.drive_period_ms = 400;
    config.lease_ms = 1000;
    Armed bench(config);
    bench.drop_to_robot = [lost = false](const Bytes &bytes) mutable {
        const bool first = is_command(bytes) && !lost;
        lost = lost || first;
        return first;
    };
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
}

TEST(Uplink, ThatWasDeadMustAnswerBeforeItArms) {
    enum { SPEED, ZEROS, ZEROS_WHILE_IT_STOPS, THEN_STOPPED };
    for (const int what : {SPEED, ZEROS, ZEROS_WHILE_IT_STOPS, THEN_STOPPED}) {
        SCOPED_TRACE(what);
        const float speed = what == ZEROS || what == ZEROS_WHILE_IT_STOPS ? 0 : 0.5F;
        Armed bench;
        ASSERT_NO_FATAL_FAILURE(bench.driving(what == ZEROS ? 0 : 0.5F, 0, second));
        bench.drop_to_robot = everything;
        if (what == ZEROS_WHILE_IT_STOPS)
            bench.pause();
        EXPECT_EQ(ROBUROC4_ERR_UPLINK, bench.drive_until_refused(speed, 0, 2 * second));
        bench.take_events();
        if (what == THEN_STOPPED)
            bench.stop();
        bench.run(400 * ms);
        EXPECT_EQ(ROBUROC4_ERR_UPLINK, bench.arm());
        EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_ARMABLE);
        bench.drop_to_robot = nullptr;
        bench.run(1200 * ms);
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_ARMABLE);
        EXPECT_EQ(ROBUROC4_OK, bench.arm());
    }
}

/** A lease of zeros needs no stop, and the answer to a request before it died proves nothing. */
TEST(Uplink, ThatWasDeadIsNotProvenByALateAnswer) {
    Armed bench;
    bench.robot.service(ROBUROC4_SERVICE_TELEMETER).insert_silent = true;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_subscribe(&bench.client, ROBUROC4_SERVICE_TELEMETER, 50,
                                                     bench.client_us()));
    bench.pump();
    const std::uint8_t id = bench.sent.back().bytes[0];
    ASSERT_NO_FATAL_FAILURE(bench.driving(0, 0, second));
    bench.drop_to_robot = everything;
    ASSERT_EQ(ROBUROC4_ERR_UPLINK, bench.drive_until_refused(0, 0, 2 * second));
    ASSERT_EQ(ROBUROC4_OK, bench.receive(plain_answer(id, ROBUROC4_ACTION_INSERT,
                                                      ROBUROC4_SERVICE_NOTIFICATION, 0)));
    EXPECT_EQ(ROBUROC4_ERR_UPLINK, bench.arm());
}

TEST(Uplink, OfARobotThatKnowsOneIdIsWatchedByChangesOfTheTarget) {
    ScriptedRobot robot = knows_one_id();
    Armed bench(robot, known_pad());
    ASSERT_TRUE(bench.facts().fixed_id);
    bench.drop_to_client = [](const Bytes &bytes) { return !is_status(bytes); };
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 2 * second));
    bench.drop_to_robot = everything;
    EXPECT_GT(0, bench.drive_until_refused(0.3F, 0, 550 * ms));
}

/** Its watchdog sets the target to 0, which lies between targets of both signs that were sent. */
TEST(Uplink, OfARobotThatKnowsOneIdIsNotProvenByTheZeroOfItsWatchdog) {
    ScriptedRobot robot = knows_one_id();
    robot.watchdog_us = 300 * ms;
    Armed bench(robot, known_pad());
    ASSERT_NO_FATAL_FAILURE(bench.driving(-0.5F, 0, second));
    bench.drop_to_robot = everything;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.3F, 0, 100 * ms));
    EXPECT_GT(0, bench.drive_until_refused(-0.7F, 0, 450 * ms));
}

/** Targets that come and go: the zero of its watchdog looks like one of them. */
TEST(Uplink, OfARobotThatKnowsOneIdIsDeadWhenNothingIsAnswered) {
    for (const std::uint64_t half_us : {50 * ms, 200 * ms, 350 * ms}) {
        ScriptedRobot robot = knows_one_id();
        Armed bench(robot, known_pad());
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.15F, 0, second));
        bench.drop_to_robot = everything;
        std::uint64_t passed_us = 0;
        for (int i = 0; passed_us < 20 * second; i++, passed_us += half_us)
            if (bench.drive_until_refused(i % 2 == 0 ? 0 : 0.15F, 0, half_us) < 0)
                break;
        EXPECT_LE(passed_us, 11 * second) << half_us;
    }
}

/** For so long it drives and pauses in turn. */
void pulse(Bench &bench, std::uint64_t drive_us, std::uint64_t pause_us, std::uint64_t span_us) {
    const std::uint64_t end_us = bench.now_us + span_us;
    while (bench.now_us < end_us && bench.drive_until_refused(0.15F, 0, drive_us) >= 0 &&
           bench.pause() >= 0) {
        bench.run(pause_us);
    }
}

const std::pair<std::uint64_t, std::uint64_t> pulses[] = {
    {50 * ms, 50 * ms},  {200 * ms, 50 * ms},  {200 * ms, 400 * ms},
    {400 * ms, 50 * ms}, {300 * ms, 750 * ms}, {250 * ms, 1100 * ms}};

TEST(Uplink, IsWatchedWhateverPausesTheProgramMakes) {
    for (const auto &[drive_us, pause_us] : pulses) {
        Armed bench;
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.15F, 0, second));
        bench.drop_to_robot = everything;
        const std::uint64_t cut_us = bench.now_us;
        pulse(bench, drive_us, pause_us, 20 * second);
        const std::uint64_t periods = 500 * ms / drive_us + 2;
        EXPECT_LE(bench.now_us - cut_us, periods * (drive_us + pause_us))
            << drive_us << " " << pause_us;
        EXPECT_EQ(ROBUROC4_ERR_UPLINK, bench.facts().disarm_cause);
    }
}

TEST(Uplink, OfARobotThatKnowsOneIdIsWatchedWhateverPausesTheProgramMakes) {
    for (const auto &[drive_us, pause_us] : pulses) {
        ScriptedRobot robot = knows_one_id();
        Armed bench(robot, known_pad());
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.15F, 0, second));
        bench.drop_to_robot = everything;
        const std::uint64_t cut_us = bench.now_us;
        pulse(bench, drive_us, pause_us, 20 * second);
        EXPECT_LE(bench.now_us - cut_us, drive_us + pause_us + 11 * second)
            << drive_us << " " << pause_us;
    }
}

TEST(Uplink, IsNotDeadWhereTheProgramHung) {
    for (const std::uint64_t hung_us : {260 * ms, 500 * ms, 900 * ms, 1100 * ms}) {
        Armed bench;
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.15F, 0, second));
        bench.robot.advance(bench.now_us += hung_us);
        bench.run(5 * ms);
        EXPECT_NO_FATAL_FAILURE(bench.driving(0.15F, 0, second)) << hung_us;
    }
}

TEST(Uplink, ThatLosesAFifthAllowsPauses) {
    for (const auto &[drive_us, pause_us] : pulses) {
        Armed bench;
        std::uint32_t random = 20261130;
        lose(bench, 51, random);
        pulse(bench, drive_us, pause_us, 300 * second);
        EXPECT_TRUE(bench.facts().armed) << drive_us << " " << pause_us << " seed 20261130";
    }
}

TEST(Uplink, OfARobotThatKnowsOneIdMayLoseATenth) {
    ScriptedRobot robot = knows_one_id();
    Armed bench(robot, known_pad());
    std::uint32_t random = 20261130;
    lose(bench, 26, random);
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0.2F, 600 * second)) << "seed 20261130";
}

TEST(Uplink, IsProvenByAZeroThatWasSent) {
    Armed bench;
    for (int i = 0; i < 60; i++) {
        ASSERT_EQ(ROBUROC4_OK, bench.drive(i % 2 == 0 ? 0.3F : 0, 0)) << i;
        bench.run(50 * ms);
    }
}

TEST(Uplink, ThatLosesAFifthDisarmsNobody) {
    Armed bench;
    std::uint32_t random = 20261124;
    lose(bench, 51, random);
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0.2F, 600 * second)) << "seed 20261124";
}
