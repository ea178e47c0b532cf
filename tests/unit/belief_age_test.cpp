/* SPDX-License-Identifier: MIT
 *
 * How old the client believes statuses to be, on robots that answer the
 * manual's open questions in other ways than the simulator (docs/PROTOCOL.md, the family).
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

constexpr std::uint32_t differential = ROBUROC4_SERVICE_DIFFERENTIAL;

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

/** The network takes 200 ms, and 1 us longer than the answer for the last status of the inputs
 *  before it. */
struct OvertakenRobot : LateRobot {
    bool swaps = false;

    void deliver(const Bytes &request) override {
        LateRobot::deliver(request);
        if (!swaps || request[0] == ROBUROC4_HEADER_STATUS || request[0] == id_)
            return;
        id_ = request[0];
        for (auto at = held_.rbegin(); at != held_.rend(); ++at) {
            if (is_status(at->second) && at->second[1] == ROBUROC4_SERVICE_IOCARD) {
                held_.emplace(at_us_ + 200 * ms + 1, at->second);
                held_.erase(std::next(at).base());
                return;
            }
        }
    }

  private:
    std::uint64_t late_us(const Bytes &) override {
        return 200 * ms;
    }
    std::uint8_t id_ = 0;
};

std::uint32_t age_us(const Bench &bench) {
    return bench.facts().age_us[differential];
}

} // namespace

/** Where only they and speeds are subscribed, the newest status proves nothing. */
TEST(LateInputs, BoundAgesToo) {
    for (const std::uint64_t inputs_us : {20 * ms, 55 * ms, 80 * ms}) {
        SCOPED_TRACE(inputs_us);
        LateInputsRobot robot;
        robot.inputs_us = inputs_us;
        roburoc4_config config = default_config();
        config.subscriptions = 1U << ROBUROC4_SERVICE_IOCARD | 1U << ROBUROC4_SERVICE_DIFFERENTIAL;
        Ready bench(robot, config);
        bench.run(7 * second);
        ASSERT_EQ(ROBUROC4_OK, bench.arm());
        bench.run(600 * second);
        EXPECT_LT(age_us(bench), 150 * ms);
        EXPECT_GE(bench.facts().age_us[ROBUROC4_SERVICE_IOCARD] + 20 * ms, inputs_us);
        robot.inputs_us = 600 * ms;
        bench.run(50 * second);
        EXPECT_GE(bench.facts().age_us[ROBUROC4_SERVICE_IOCARD], 580 * ms);
    }
}

TEST(Age, OfStatusesThatAloneAreQueuedIsNotForgiven) {
    QueueingRobot robot;
    Ready bench(robot);
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
    Ready bench(robot);
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
    Ready bench(robot);
    for (int step = 0; step < 2; step++) {
        bench.run(1000 * second); /* in which its clock gains 200 ms */
        robot.queue_us += 200 * ms;
        bench.run(5 * second);
        EXPECT_GE(age_us(bench) + 20 * ms, robot.queue_us) << step;
    }
}

/** As far as a status that is faster than all before does not disprove it. */
TEST(Age, GrowsByThatPartOfTheDriftWhichIsStillPossible) {
    QueueingRobot robot;
    robot.all = true;
    robot.queue_us = 10 * ms;
    Ready bench(robot);
    bench.run(10 * second);
    bench.drop_to_client = [](const Bytes &bytes) { return !is_status(bytes); };
    bench.run(4 * second); /* 2 ms of drift */
    const auto least_us = [&bench] {
        std::uint32_t least = UINT32_MAX;
        for (int i = 0; i < 1000; i++) {
            bench.run(ms / 10);
            least = std::min(least, age_us(bench));
        }
        return least;
    };
    const std::uint32_t before_us = least_us();
    robot.queue_us = 9 * ms;
    bench.run(100 * ms);
    EXPECT_LT(least_us() + ms / 2, before_us);
}

TEST(Age, GrowsWithTheDriftWhileNothingIsAnswered) {
    QueueingRobot robot;
    robot.ppm = 400;
    Ready bench(robot);
    bench.run(10 * second);
    robot.answer_us = [](const Bytes &) { return 10000 * second; };
    for (int step = 0; step < 40; step++) {
        bench.run(10 * second); /* in which its clock gains 4 ms */
        robot.queue_us += 4 * ms;
        bench.run(100 * ms);
        EXPECT_GE(age_us(bench) + 20 * ms, robot.queue_us) << step;
    }
}

TEST(Age, IsLearntAgainWhereClocksDrift) {
    for (const std::int64_t ppm : {-400, 400}) {
        QueueingRobot robot;
        robot.ppm = ppm;
        Ready bench(robot);
        for (int part = 0; part < 3; part++) {
            bench.run(1000 * second); /* in which the clocks drift apart by 400 ms */
            EXPECT_LT(age_us(bench), 200 * ms) << ppm;
        }
        EXPECT_EQ(ROBUROC4_OK, bench.arm()) << ppm;
    }
}

TEST(Safety, ASlowlyGrowingQueueDisarms) {
    for (const auto &[growth_us, steps] : {std::pair{100U, 4400}, {8333U, 50}}) {
        SCOPED_TRACE(growth_us);
        QueueingRobot robot;
        robot.all = true;
        Armed bench(robot);
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.1F, 0, 5 * second));
        for (int i = 0; i < steps; i++) {
            robot.queue_us += growth_us;
            bench.drive(0.1F, 0);
            bench.run(50 * ms);
        }
        EXPECT_EQ(ROBUROC4_ERR_STALE_DIFFERENTIAL, bench.facts().disarm_cause);
        EXPECT_EQ(0, bench.facts().armed);
        EXPECT_TRUE(bench.commands().back().zero());
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
        Ready bench;
        bench.robot.powered = false;
        bench.run(3 * second);
        ASSERT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_LOST), bench.state());
        const std::uint64_t silent_us = days_us + more_s * second;
        bench.skew_us += static_cast<std::int64_t>(silent_us);
        bench.robot.set_cycles(bench.robot.cycles() + (silent_us + 900 * ms) / ROBUROC4_CYCLE_US);
        bench.delay_to_client = [] { return 400 * ms; };
        bench.robot.powered = true;
        EXPECT_FALSE(bench.run_until([&] { return age_us(bench) < 400 * ms; }));
    }
}

TEST(Age, IsLearntAgainAfterThisClockJumpedAhead) {
    for (const std::int64_t jump_ms : {150, 500, 900, 1500, 60000}) {
        SCOPED_TRACE(jump_ms);
        Ready bench;
        bench.skew_us += jump_ms * 1000;
        bench.run(500 * ms);
        bench.robot.advance(bench.now_us += 120 * ms); /* a shorter pause is not the jump */
        bench.run(15 * second);
        EXPECT_EQ(ROBUROC4_OK, bench.arm());
    }
}

TEST(Age, IsNotLoweredByAnAnswerThatOvertookAStatus) {
    QueueingRobot robot;
    robot.queue_us = 200 * ms;
    robot.answer_us = [](const Bytes &) { return 400 * ms; };
    Ready bench(robot);
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

TEST(Age, IsNotLoweredByStatusesThatAnswersOvertook) {
    OvertakenRobot robot;
    roburoc4_config config = default_config();
    config.subscriptions = 1U << ROBUROC4_SERVICE_IOCARD | 1U << differential;
    config.period_ms[ROBUROC4_SERVICE_IOCARD] = config.period_ms[differential] = 190;
    config.fresh_ms = 1000;
    Ready bench(robot, config);
    bench.run(10 * second);
    robot.swaps = true;
    for (int i = 0; i < 2000; i++) {
        bench.run(10 * ms);
        ASSERT_GE(age_us(bench) + 20 * ms, 200 * ms) << i;
        ASSERT_LT(age_us(bench), 550 * ms) << i;
    }
}

/** A slow answer bounds no age, so it must not end the search for the jumps. */
TEST(Age, IsLearntAgainAfterJumpsWhereEveryThirdAnswerIsSlow) {
    QueueingRobot robot;
    Ready bench(robot);
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
    Started bench(robot);
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
