/* SPDX-License-Identifier: MIT
 *
 * What the client may believe about stops, ages, the uplink and restarts, on robots that answer the
 * manual's open questions in other ways than the simulator (docs/PROTOCOL.md, the family).
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <random>

#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

constexpr std::uint32_t differential = ROBUROC4_SERVICE_DIFFERENTIAL;

bool is_command(const Bytes &bytes) {
    return bytes.size() == 11 && bytes[0] == ROBUROC4_HEADER_STATUS;
}
bool is_status(const Bytes &bytes) {
    return !bytes.empty() && bytes[0] == ROBUROC4_HEADER_STATUS;
}

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

/* ---- a stop is believed late, and watched ---- */

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
        EXPECT_TRUE(again.take_events() & ROBUROC4_EVENT_STOPPED);
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
    EXPECT_FALSE(events & ROBUROC4_EVENT_STOPPED);
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
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_STOPPED);
}

/** Statuses show the speed that it resumes only when its motors follow. */
TEST_F(StopBelief, OfAClosingClientIsNotConfirmedBeforeTheResumedSpeedIsShown) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, second));
    robot.hold(true);
    bench.run(200 * ms);
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
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_STOPPED);
}

TEST_F(StopBelief, OfAClosingClientEndsHoweverOftenTheOverrideDoes) {
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, second));
    bench.drop_to_robot = is_command;
    ASSERT_EQ(ROBUROC4_OK, bench.close());
    for (int i = 0; i < 22; i++) {
        robot.press(ROBUROC4_DI_PAD_A, i % 2 == 0);
        bench.run(100 * ms);
    }
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_IDLE), bench.state());
}

TEST_F(StopBelief, IsConfirmedAgainByARobotThatLostItsInputs) {
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
    EXPECT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
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
    bench.drop_to_robot = [](const Bytes &) { return true; };
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
    bench.drop_to_robot = [](const Bytes &) { return true; }; /* a queue takes it all */
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
    EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_STOPPED);
    bench.drop_to_robot = nullptr;
    for (const Bytes &bytes : queue)
        robot.deliver(bytes);
    bench.run(350 * ms);
    EXPECT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_STOPPED);
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
    EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_STOPPED);
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
        bench.run(210 * ms);
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
    bench.drop_to_robot = [](const Bytes &) { return true; }; /* a queue takes it all */
    ASSERT_NO_FATAL_FAILURE(bench.driving(1, 0, 200 * ms));
    for (int i = 0; i < 4; i++) {
        bench.stop();
        bench.run(1500 * ms);
        ASSERT_EQ(ROBUROC4_OK, bench.arm());
        ASSERT_NO_FATAL_FAILURE(bench.driving(0, 0, 200 * ms)) << i;
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

/* ---- ages ---- */

namespace {

/** Delays statuses, and answers if `all`, by `queue_us`, and answers by what `answer_us` says. Its
 *  clock is fast by `ppm`. */
struct QueueingRobot : LateRobot {
    std::uint64_t queue_us = 0;
    bool all = false;
    std::int64_t ppm = 0;
    std::function<std::uint64_t(const Bytes &)> answer_us = [](const Bytes &) { return 0; };

  private:
    std::uint64_t late_us(const Bytes &bytes) override {
        return is_status(bytes) ? queue_us : (all ? queue_us : 0) + answer_us(bytes);
    }
    Bytes sent_as(Bytes bytes) override {
        if (!is_status(bytes))
            return bytes;
        std::uint64_t cycles = 0;
        for (int i = 7; i >= 0; i--)
            cycles = cycles << 8 | bytes[static_cast<std::size_t>(3 + i)];
        cycles = static_cast<std::uint64_t>(static_cast<std::int64_t>(cycles) +
                                            static_cast<std::int64_t>(cycles) * ppm / 1000000);
        for (int i = 0; i < 8; i++)
            bytes[static_cast<std::size_t>(3 + i)] = static_cast<std::uint8_t>(cycles >> (8 * i));
        return bytes;
    }
};

/** Stamps of the services that measure motion are 15 cycles older than the others. */
struct MeasuringRobot : ScriptedRobot {
    std::vector<Bytes> take() override {
        std::vector<Bytes> all = ScriptedRobot::take();
        for (Bytes &bytes : all)
            if (measured(bytes))
                bytes = status_at(bytes[1], cycles() - 15);
        std::stable_partition(all.begin(), all.end(), measured);
        return all;
    }
    static bool measured(const Bytes &bytes) {
        return is_status(bytes) && bytes[1] >= ROBUROC4_SERVICE_LOCALIZATION;
    }
};

std::uint32_t age_us(const Bench &bench) {
    return bench.facts().age_us[differential];
}

} // namespace

TEST(Age, OfStatusesThatAloneAreQueuedIsNotForgiven) {
    QueueingRobot robot;
    Bench bench(robot);
    bench.ready();
    bench.run(10 * second);
    ASSERT_LT(age_us(bench), 150 * ms);
    robot.queue_us = 600 * ms;
    bench.run(50 * second);
    EXPECT_GE(age_us(bench), 600 * ms) << "answers are on time, but prove nothing";
    EXPECT_EQ(ROBUROC4_ERR_STALE_DIFFERENTIAL, bench.arm());
    robot.queue_us = 0;
    bench.run(3 * second);
    EXPECT_LT(age_us(bench), 150 * ms);
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

TEST(Age, IsNoLastingReasonAgainstDriving) {
    QueueingRobot robot;
    Bench bench(robot);
    bench.ready();
    robot.queue_us = 500 * ms;
    bench.run(70 * second);
    ASSERT_EQ(ROBUROC4_OK, bench.arm()) << "nothing else says that the statuses are late";
    EXPECT_EQ(ROBUROC4_ERR_INHIBITED, bench.drive_until_refused(0.5F, 0, second))
        << "but now their target is";
}

TEST(Age, GrowsWithTheDriftThatAFastRobotClockMayHide) {
    QueueingRobot robot;
    robot.ppm = 200;
    robot.all = true;
    Bench bench(robot);
    bench.ready();
    for (int step = 0; step < 2; step++) {
        bench.run(1000 * second); /* in which its clock gains 200 ms */
        robot.queue_us += 200 * ms;
        bench.run(5 * second);
        EXPECT_GE(age_us(bench) + 20 * ms, robot.queue_us) << step;
    }
}

TEST(Age, IsLearntAgainWhereClocksDrift) {
    for (const std::int64_t ppm : {-400, 400}) {
        QueueingRobot robot;
        robot.ppm = ppm;
        Bench bench(robot);
        bench.ready();
        for (int part = 0; part < 3; part++) {
            bench.run(1000 * second); /* in which the clocks drift apart by 400 ms */
            EXPECT_LT(age_us(bench), 200 * ms) << ppm;
        }
        EXPECT_EQ(ROBUROC4_OK, bench.arm()) << ppm;
    }
}

/** What a datagram teaches may make the last statuses of all services older at once. */
TEST(Age, IsNeverHigherThanTheStoredDeadlineKnows) {
    for (const std::int64_t ppm : {-400, 0, 400}) {
        SCOPED_TRACE(ppm);
        QueueingRobot robot;
        robot.ppm = ppm;
        Bench bench(robot);
        std::mt19937 random(7);
        bench.delay_to_client = [&random] { return random() % 40 * ms; };
        bench.ready();
        std::uint64_t late_us = 0;
        const std::uint64_t end_us = bench.now_us + 300 * second;
        while (bench.now_us < end_us) {
            bench.run_to(bench.now_us + 1 + random() % (20 * ms));
            if (bench.facts().armed == 0 && bench.arm() < 0)
                continue;
            const std::uint64_t left_us =
                roburoc4_client_next_deadline(&bench.client) -
                std::min(bench.client_us(), roburoc4_client_next_deadline(&bench.client));
            for (const std::uint32_t service :
                 {std::uint32_t{ROBUROC4_SERVICE_IOCARD}, differential}) {
                const std::uint64_t age = bench.facts().age_us[service];
                late_us = std::max(late_us, std::max(age + left_us, 300 * ms) - 300 * ms);
            }
        }
        EXPECT_EQ(0U, late_us);
    }
}

TEST(Age, IsNoShorterAfterAHundredDaysOfSilence) {
    const std::uint64_t days_us = 8529600 * second; /* the drift of these needs 33 bits */
    for (std::uint64_t more_s = 0; more_s < 4000; more_s += 300) {
        SCOPED_TRACE(more_s);
        ScriptedRobot robot;
        Bench bench(robot);
        bench.ready();
        robot.powered = false;
        bench.run(3 * second);
        ASSERT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_LOST), bench.state());
        const std::uint64_t silent_us = days_us + more_s * second;
        bench.skew_us += static_cast<std::int64_t>(silent_us);
        robot.set_cycles(robot.cycles() + (silent_us + 900 * ms) / ROBUROC4_CYCLE_US);
        bench.delay_to_client = [] { return 400 * ms; };
        robot.powered = true;
        EXPECT_FALSE(bench.run_until([&] { return age_us(bench) < 400 * ms; }));
    }
}

TEST(Age, IsLearntAgainAfterThisClockJumpedAhead) {
    for (const std::int64_t jump_ms : {150, 500, 900, 1500, 60000}) {
        SCOPED_TRACE(jump_ms);
        ScriptedRobot robot;
        Bench bench(robot);
        bench.ready();
        bench.skew_us += jump_ms * 1000;
        bench.run(500 * ms);
        robot.advance(bench.now_us += 120 * ms); /* a shorter pause is not the jump */
        bench.run(15 * second);
        EXPECT_EQ(ROBUROC4_OK, bench.arm());
    }
}

TEST(Age, IsNotLoweredByAnAnswerThatOvertookAStatus) {
    QueueingRobot robot;
    robot.queue_us = 200 * ms;
    robot.answer_us = [](const Bytes &) { return 400 * ms; };
    Bench bench(robot);
    bench.ready();
    ASSERT_GE(age_us(bench), 400 * ms);
    int count = 0;
    robot.answer_us = [&count, id = 0](const Bytes &bytes) mutable {
        if (bytes[1] != ROBUROC4_ACTION_GET)
            return 200 * ms; /* a text proves nothing */
        count += bytes[0] != id;
        id = bytes[0];
        return count == 3 ? 100 * second : count == 4 ? 0 : 200 * ms; /* one is lost */
    };
    for (int i = 0; i < 200; i++) {
        bench.run(50 * ms);
        ASSERT_GE(age_us(bench), 190 * ms) << i;
    }
    EXPECT_GT(count, 4);
    EXPECT_LT(age_us(bench), 300 * ms) << "but by those that did not";
}

/** A slow answer bounds no age, so it must not end the search for the jumps. */
TEST(Age, IsLearntAgainAfterJumpsWhereEveryThirdAnswerIsSlow) {
    QueueingRobot robot;
    Bench bench(robot);
    bench.ready();
    bench.run(5 * second);
    robot.answer_us = [](const Bytes &bytes) { return bytes[0] % 3 == 0 ? 900 * ms : 0; };
    for (int jump = 0; jump < 5; jump++) {
        bench.run(4 * second);
        bench.skew_us += 200 * ms;
    }
    bench.run(90 * second);
    EXPECT_LT(age_us(bench), 150 * ms);
}

/** Texts may have a queue of their own, and it takes long to read them all. */
TEST(Age, IsLearntWhileSlowTextsAreRead) {
    QueueingRobot robot;
    robot.iocard.digital_inputs = 64;
    robot.answer_us = [](const Bytes &bytes) {
        return bytes[1] == ROBUROC4_ACTION_QUERY ? 300 * ms : 0;
    };
    robot.all = true;
    robot.queue_us = 200 * ms;
    Bench bench(robot);
    bench.start();
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    bench.run(second);
    ASSERT_GT(age_us(bench), 200 * ms);
    robot.queue_us = 0;
    bench.run(5 * second);
    EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_DESCRIPTIONS_DONE);
    EXPECT_LT(age_us(bench), 150 * ms);
}

TEST(Age, IsNotProvenByStampsOfTheMeasurement) {
    MeasuringRobot robot;
    Bench bench(robot);
    const auto mute = [&robot](bool muted) {
        for (ScriptedService &service : robot.services)
            service.mute = muted && service.kind < ROBUROC4_SERVICE_LOCALIZATION;
    };
    mute(true); /* so that motion is reported first */
    bench.start();
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    bench.run(200 * ms);
    bench.delay_to_client = [] { return 140 * ms; };
    mute(false);
    for (int i = 0; i < 100; i++) {
        bench.run(50 * ms);
        EXPECT_GE(bench.service_link(ROBUROC4_SERVICE_IOCARD).age_us, 130 * ms) << i;
    }
}

/* ---- the uplink ---- */

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

} // namespace

TEST(Uplink, ThatGrowsLateDisarms) {
    for (const bool steady : {true, false}) {
        SCOPED_TRACE(steady);
        ScriptedRobot robot;
        Bench bench(robot);
        bench.armed();
        SlowUplink uplink(bench, robot);
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
    ScriptedRobot robot;
    Bench bench(robot);
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
    bench.drop_to_robot = [](const Bytes &) { return true; };
    EXPECT_EQ(ROBUROC4_ERR_UPLINK, bench.drive_until_refused(0.5F, 0, 550 * ms));
}

TEST(Uplink, IsWatchedByEveryTargetThatDiffersFromTheReportedOne) {
    for (const float angular : {0.0201F, 0.0244F, -0.0249F}) {
        SCOPED_TRACE(angular);
        ScriptedRobot robot;
        Bench bench(robot);
        bench.armed();
        robot.follows = false;
        EXPECT_GT(0, bench.drive_until_refused(0, angular, 550 * ms));
    }
    ScriptedRobot robot;
    Bench bench(robot);
    bench.armed();
    robot.follows = false;
    EXPECT_EQ(ROBUROC4_OK, bench.drive_until_refused(0, 0.0199F, 2 * second)) << "rounding";
}

TEST(Uplink, IsWatchedWhileTargetsSwingAroundTheReportedOne) {
    ScriptedRobot robot;
    Bench bench(robot);
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.3F, 0.3F, second));
    robot.follows = false;
    for (int i = 0; i < 12 && bench.facts().armed == 1; i++) {
        bench.drive(i % 2 == 0 ? 0.1F : 0.5F, i % 2 == 0 ? 0.5F : 0.1F);
        bench.run(50 * ms);
    }
    EXPECT_EQ(0, bench.facts().armed);
}

TEST(Uplink, OfALeaseThatEndedSaysNothingOfTheNext) {
    ScriptedRobot robot;
    Bench bench(robot);
    bench.armed();
    for (int lease = 0; lease < 2; lease++) {
        robot.follows = false; /* its target appears late, or no more */
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 150 * ms)) << lease;
        robot.follows = true;
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
    ScriptedRobot robot;
    Bench bench(robot, config);
    bench.armed();
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
        ScriptedRobot robot;
        Bench bench(robot);
        bench.armed();
        ASSERT_NO_FATAL_FAILURE(bench.driving(what == ZEROS ? 0 : 0.5F, 0, second));
        bench.drop_to_robot = [](const Bytes &) { return true; };
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
    ScriptedRobot robot;
    Bench bench(robot);
    bench.armed();
    robot.service(ROBUROC4_SERVICE_TELEMETER).insert_silent = true;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_subscribe(&bench.client, ROBUROC4_SERVICE_TELEMETER, 50,
                                                     bench.client_us()));
    bench.pump();
    const std::uint8_t id = bench.sent.back().bytes[0];
    ASSERT_NO_FATAL_FAILURE(bench.driving(0, 0, second));
    bench.drop_to_robot = [](const Bytes &) { return true; };
    ASSERT_EQ(ROBUROC4_ERR_UPLINK, bench.drive_until_refused(0, 0, 2 * second));
    ASSERT_EQ(ROBUROC4_OK, bench.receive(plain_answer(id, ROBUROC4_ACTION_INSERT,
                                                      ROBUROC4_SERVICE_NOTIFICATION, 0)));
    EXPECT_EQ(ROBUROC4_ERR_UPLINK, bench.arm());
}

TEST(Uplink, OfARobotThatKnowsOneIdIsWatchedByChangesOfTheTargetAlone) {
    ScriptedRobot robot;
    robot.always_manual_id = true;
    roburoc4_config config = default_config();
    config.role_index[ROBUROC4_ROLE_OVERRIDE] = ROBUROC4_DI_PAD_A;
    Bench bench(robot, config);
    bench.armed();
    ASSERT_TRUE(bench.facts().fixed_id);
    bench.drop_to_client = [](const Bytes &bytes) { return !is_status(bytes); };
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 2 * second));
    bench.drop_to_robot = [](const Bytes &) { return true; };
    EXPECT_GT(0, bench.drive_until_refused(0.3F, 0, 550 * ms));
}

/** A bad link can make any robot look like that. */
TEST_F(StopBelief, InFixedIdModeIsNotConfirmedWhileItsZerosAreOnTheirWay) {
    robot.always_manual_id = true;
    roburoc4_config config = default_config();
    config.role_index[ROBUROC4_ROLE_OVERRIDE] = ROBUROC4_DI_PAD_A;
    Bench told(robot, config);
    told.armed();
    ASSERT_TRUE(told.facts().fixed_id);
    told.drop_to_robot = [](const Bytes &) { return true; }; /* a queue takes it all */
    ASSERT_NO_FATAL_FAILURE(told.driving(1, 0, 200 * ms));
    told.pause();
    told.run(700 * ms);
    EXPECT_EQ(ROBUROC4_STOP_RUNNING, told.facts().stop_outcome);
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
        told.armed();
        ASSERT_TRUE(
            told.run_until([&] { return told.facts().descriptions_done == 1; }, 60 * second));
        ASSERT_EQ(c.fixed_id, told.facts().fixed_id == 1);
        told.drop_to_robot = is_command;
        ASSERT_NO_FATAL_FAILURE(told.driving(1, 0, 200 * ms));
        told.drop_to_robot = [](const Bytes &) { return true; };
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

TEST(Uplink, ThatLosesAFifthDisarmsNobody) {
    ScriptedRobot robot;
    Bench bench(robot);
    bench.armed();
    std::uint32_t random = 20261124;
    const auto lost = [&random](const Bytes &) {
        random = random * 1664525U + 1013904223U;
        return random >> 24 < 51;
    };
    bench.drop_to_robot = lost;
    bench.drop_to_client = [&](const Bytes &bytes) { return !is_status(bytes) && lost(bytes); };
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0.2F, 600 * second)) << "seed 20261124";
}

/* ---- restarts ---- */

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
        ScriptedRobot robot;
        Bench bench(robot);
        bench.ready();
        robot.powered = false;
        bench.run(outage_s * second);
        robot.powered = true;
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
    Bench bench(robot);
    bench.ready();
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
        Bench bench(robot);
        bench.ready();
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
    ScriptedRobot robot;
    Bench bench(robot);
    bench.ready();
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
            robot.advance(bench.now_us += 10 * ms);
    }
    bench.run(2 * second);
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_REBOOTS));
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

TEST(Restart, IsNotReportedForEverWhereStampsAreOfTheMeasurement) {
    MeasuringRobot robot;
    Bench bench(robot);
    bench.ready();
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
        ScriptedRobot robot;
        Bench bench(robot);
        robot.set_cycles(1200);
        bench.ready();
        robot.powered = false;
        bench.run(5 * second);
        bench.skew_us -= static_cast<std::int64_t>(2 * second);
        bench.run(5 * second);
        robot.reboot();
        robot.set_cycles(up_s * 100);
        robot.powered = true;
        bench.run(10 * second);
        EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_REBOOTS));
        EXPECT_EQ(ROBUROC4_OK, bench.arm());
    }
}

/** By how much it went back is not known either, if nobody called meanwhile. */
TEST(Restart, IsAssumedIfThisClockWentBackAndTheRobotsIsASecondAhead) {
    ScriptedRobot robot;
    Bench bench(robot);
    bench.ready();
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
    Bench bench(robot);
    bench.ready();
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
    ScriptedRobot robot;
    Bench bench(robot, config);
    bench.ready();
    robot.powered = false;
    bench.run(700 * ms);
    bench.skew_us -= static_cast<std::int64_t>(second);
    bench.run(700 * ms);
    robot.powered = true; /* its clock was set meanwhile, to about the same time */
    robot.set_cycles(robot.cycles() - 100);
    bench.run(100 * ms);
    EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_REBOOTS));
}

TEST(Restart, IsNotAssumedWhereOnlyThisClockWentBack) {
    ScriptedRobot robot;
    Bench bench(robot);
    bench.ready();
    bench.run(5 * second);
    bench.skew_us -= static_cast<std::int64_t>(2 * second);
    bench.run(5 * second);
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_REBOOTS));
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}
