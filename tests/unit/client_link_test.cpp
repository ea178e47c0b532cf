/* SPDX-License-Identifier: MIT
 *
 * Statistics of the link: loss, order, period, jitter, round trip, age, and the robot's clock on
 * the host's.
 */
#include "client_bench.h"
#include "drawn.h"

using namespace roburoc4_tests;

namespace {

constexpr std::uint32_t differential = ROBUROC4_SERVICE_DIFFERENTIAL;

/** When, on the true clock, the scripted robot's counter showed `cycles`. */
std::uint64_t true_us(const ScriptedRobot &robot, const Bench &bench, std::uint64_t cycles) {
    return bench.now_us - (robot.cycles() - cycles) * ROBUROC4_CYCLE_US;
}

/** The link's statistics, in a struct that had other contents before. */
roburoc4_link figures(const Bench &bench) {
    roburoc4_link link;
    memset(&link, 0xA5, sizeof link);
    link.size = sizeof link;
    EXPECT_EQ(ROBUROC4_OK, roburoc4_client_link(&bench.client, bench.client_us(), &link));
    return link;
}

/** Drops two statuses of each ten, of all services. */
std::function<bool(const Bytes &)> lossy() {
    return [seen = 0U](const Bytes &bytes) mutable {
        if (bytes[0] != ROBUROC4_HEADER_STATUS)
            return false;
        seen++;
        return seen % 10 == 3 || seen % 10 == 4;
    };
}

} // namespace

TEST(Link, IsCleanOnACleanNetwork) {
    Ready bench;
    bench.run(10 * second);
    const std::uint32_t age_us = bench.service_link(differential).age_us;
    bench.run(50 * second);
    EXPECT_LE(bench.service_link(differential).age_us, age_us);
    for (std::uint32_t service = 2; service < 7; service++) {
        const roburoc4_service_link link = bench.service_link(service);
        EXPECT_EQ(0U, link.lost) << service;
        EXPECT_EQ(0U, link.late + link.duplicates) << service;
        EXPECT_EQ(0.0F, link.loss) << service;
        EXPECT_EQ(0U, link.jitter_us) << service;
        EXPECT_EQ(1U, link.subscribed) << service;
    }
    EXPECT_EQ(50000U, bench.service_link(differential).period_us);
    EXPECT_NEAR(1224, bench.service_link(differential).received, 2);
    const roburoc4_link link = bench.link();
    EXPECT_EQ(0U, link.lost);
    EXPECT_EQ(0.0F, link.loss);
    EXPECT_GT(link.received, 3 * 1200U);
}

TEST(Link, LossIsTheShareThatDidNotArrive) {
    Ready bench;
    std::uint32_t seen = 0;
    std::uint32_t dropped = 0;
    bench.drop_to_client = [&](const Bytes &bytes) {
        if (bytes[0] != 0xFF || bytes[1] != 6)
            return false;
        const bool drop = ++seen % 10 == 3 || seen % 10 == 4;
        dropped += drop;
        return drop;
    };
    bench.run(60 * second);
    const roburoc4_service_link link = bench.service_link(differential);
    EXPECT_NEAR(dropped, link.lost, 2);
    EXPECT_NEAR(0.2, link.loss, 0.02);
    EXPECT_NEAR(0.05, bench.link().loss, 0.03) << "of all services together";
    EXPECT_EQ(50000U, link.period_us);
    EXPECT_EQ(0U, bench.service_link(ROBUROC4_SERVICE_LOCALIZATION).lost);
    bench.drop_to_client = nullptr;
    bench.run(60 * second);
    EXPECT_LT(bench.service_link(differential).loss, 0.01F) << "recent statuses only";
}

TEST(Link, TotalsAreTheSumsOfAllServices) {
    Ready bench;
    bench.drop_to_client = lossy();
    bench.run(10 * second);
    std::uint32_t received = 0;
    std::uint32_t lost = 0;
    for (std::uint32_t service = 2; service < 7; service++) {
        received += bench.service_link(service).received;
        lost += bench.service_link(service).lost;
    }
    const roburoc4_link link = figures(bench);
    EXPECT_EQ(received, link.received);
    EXPECT_EQ(lost, link.lost);
    EXPECT_GT(lost, 100U);
    EXPECT_EQ(0U, link.reserved);
}

TEST(Link, LossOfTheOnlyServiceIsThatOfTheLink) {
    roburoc4_config config = default_config();
    config.subscriptions = 1U << differential;
    Ready bench(config);
    bench.drop_to_client = lossy();
    bench.run(2 * second);
    EXPECT_NEAR(0.15, bench.service_link(differential).loss, 0.05);
    EXPECT_FLOAT_EQ(bench.service_link(differential).loss, figures(bench).loss);
}

/** The network also delays, doubles and reorders, if it is `shaken`. */
static void expect_true_loss(double share, unsigned period_ms, bool shaken) {
    SCOPED_TRACE(testing::Message() << share << " lost, " << period_ms << " ms, " << shaken);
    roburoc4_config config = default_config();
    config.period_ms[differential] = static_cast<std::uint16_t>(period_ms);
    config.subscriptions = 1U << differential; /* the others would queue before it */
    RobotBench bench(config);
    Drawn random(11);
    const auto chance = [&](double of) { return random.between(0, 1) < of; };
    double sent = 0, lost = 0, doubled = 0;
    bench.drop_to_robot = [&](const Bytes &) { return chance(share); };
    bench.drop_to_client = [&](const Bytes &bytes) {
        const bool drop = chance(share);
        if (is_status(bytes)) {
            sent++;
            lost += drop;
            if (shaken && !drop && chance(0.2)) {
                doubled++;
                bench.receive(bytes);
            }
        }
        return drop;
    };
    bench.delay_to_client = [&] {
        const double held_ms = chance(0.2) ? random.between(0, 3 * period_ms) : 0;
        const double jitter_ms = random.between(0, 8);
        return 3 * ms + (shaken ? static_cast<std::uint64_t>(1e3 * (jitter_ms + held_ms)) : 0);
    };
    bench.start();
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    double recent = 0;
    constexpr int samples = 40;
    for (int i = 0; i <= samples; i++) {
        bench.run(100 * period_ms * ms);
        recent += i == 0 ? 0 : static_cast<double>(bench.service_link(differential).loss) / samples;
    }
    const roburoc4_service_link link = bench.service_link(differential);
    EXPECT_NEAR(lost / sent, 1.0 * link.lost / (link.lost + link.received + link.late), 0.01);
    EXPECT_NEAR(lost / sent, recent, 0.01);
    EXPECT_EQ(period_ms * ms, link.period_us);
    EXPECT_GT(link.received, 2000U);
    EXPECT_NEAR(doubled, link.duplicates, 0.1 * doubled);
    EXPECT_EQ(shaken, link.late > 0);
}

TEST(Link, LossIsWithinOnePointWhateverElseHappens) {
    for (const double share : {0.0, 0.05, 0.3})
        for (const unsigned period_ms : {10U, 50U, 100U})
            for (const bool shaken : {false, true})
                expect_true_loss(share, period_ms, shaken);
}

TEST(Link, PeriodIsTheObservedOneIfTheRobotUsesAnother) {
    for (const std::uint8_t cycles : {std::uint8_t{2}, std::uint8_t{10}, std::uint8_t{25}}) {
        ScriptedRobot robot;
        robot.forced_period = cycles;
        roburoc4_config config = default_config();
        config.lost_ms = 5000;
        Ready bench(robot, config);
        bench.run(20 * second);
        const std::uint32_t lost = bench.service_link(differential).lost;
        EXPECT_EQ(cycles * 10000U, bench.service_link(differential).period_us);
        bench.run(60 * second);
        EXPECT_EQ(lost, bench.service_link(differential).lost) << "of " << int{cycles};
        EXPECT_LT(bench.service_link(differential).loss, 0.01F);
    }
}

TEST(Link, EarlierLossIsKeptIfThePeriodTurnsOutToBeLonger) {
    struct Periods {
        std::uint8_t asked, used;
    };
    for (const Periods &cycles : {Periods{6, 10}, Periods{2, 10}, Periods{1, 25}}) {
        SCOPED_TRACE(int{cycles.asked});
        roburoc4_config config = default_config();
        config.lost_ms = 5000;
        Ready bench(config);
        int to_drop = 3;
        bench.drop_to_client = [&](const Bytes &bytes) {
            return bytes[0] == 0xFF && bytes[1] == 6 && to_drop-- > 0;
        };
        bench.run(second);
        ASSERT_EQ(3U, bench.service_link(differential).lost);
        ASSERT_TRUE(bench.run_until([&] { return bench.robot.cycles() % 50 == 2; }));
        bench.robot.forced_period = cycles.used;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_subscribe(&bench.client, differential,
                                                         cycles.asked * 10U, bench.client_us()));
        ASSERT_TRUE(bench.run_until(
            [&] { return bench.service_link(differential).period_us == cycles.used * 10000U; }));
        const roburoc4_service_link learned = bench.service_link(differential);
        EXPECT_EQ(3U, learned.lost) << "what was never sent";
        EXPECT_NEAR(3.0 / (3 + learned.received), learned.loss, cycles.asked > 1 ? 0.002 : 0.1)
            << "with one more or less";
        bench.run(20 * second);
        EXPECT_EQ(cycles.used * 10000U, bench.service_link(differential).period_us);
        EXPECT_EQ(3U, bench.service_link(differential).lost);
    }
}

TEST(Link, CountsDuplicatesAndLateOnesAndTakesLateOnesOffTheLost) {
    ScriptedRobot robot;
    Ready bench(robot);
    roburoc4_differential_status last;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_differential(&bench.client, &last, nullptr));
    const std::uint64_t base = last.robot_cycles;
    EXPECT_EQ(0, bench.receive(robot.status_at(differential, base + 15)));
    EXPECT_EQ(2U, bench.service_link(differential).lost);
    EXPECT_EQ(ROBUROC4_ERR_OLD, bench.receive(robot.status_at(differential, base + 10)));
    EXPECT_EQ(1U, bench.service_link(differential).lost);
    EXPECT_EQ(1U, bench.service_link(differential).late);
    EXPECT_EQ(ROBUROC4_ERR_OLD, bench.receive(robot.status_at(differential, base + 10)));
    EXPECT_EQ(ROBUROC4_ERR_OLD, bench.receive(robot.status_at(differential, base + 15)));
    EXPECT_EQ(1U, bench.service_link(differential).late);
    EXPECT_EQ(2U, bench.service_link(differential).duplicates);
    EXPECT_EQ(1U, bench.service_link(differential).lost);
    EXPECT_GT(bench.service_link(differential).loss, 0.0F);
    EXPECT_EQ(ROBUROC4_ERR_OLD, bench.receive(robot.status_at(differential, base + 5)));
    EXPECT_EQ(0U, bench.service_link(differential).lost);
    EXPECT_EQ(0.0F, bench.service_link(differential).loss) << "all of them arrived";
    EXPECT_EQ(ROBUROC4_ERR_OLD, bench.receive(robot.status_at(differential, base + 13)));
    EXPECT_EQ(0U, bench.service_link(differential).lost) << "one that nobody missed";
}

TEST(Link, CountsAGapToTheNearestPeriod) {
    Ready bench;
    const std::uint64_t base = bench.robot.cycles() / 5 * 5;
    EXPECT_EQ(0, bench.receive(bench.robot.status_at(differential, base + 7)));
    EXPECT_EQ(0U, bench.service_link(differential).lost);
    EXPECT_EQ(0, bench.receive(bench.robot.status_at(differential, base + 15)));
    EXPECT_EQ(1U, bench.service_link(differential).lost);
}

TEST(Link, AVeryLateStatusIsLateAndNotADuplicate) {
    ScriptedRobot robot;
    roburoc4_config config = default_config();
    config.period_ms[differential] = 10;
    Ready bench(robot, config);
    Bytes held;
    bench.drop_to_client = [&](const Bytes &bytes) {
        const bool hold = held.empty() && bytes[0] == 0xFF && bytes[1] == 6;
        if (hold)
            held = bytes;
        return hold;
    };
    bench.run(700 * ms);
    ASSERT_FALSE(held.empty());
    EXPECT_EQ(ROBUROC4_ERR_OLD, bench.receive(held));
    EXPECT_EQ(1U, bench.service_link(differential).late);
    EXPECT_EQ(0, bench.receive(robot.status_at(differential, robot.cycles() + 70)));
    EXPECT_EQ(ROBUROC4_ERR_OLD, bench.receive(robot.status_at(differential, robot.cycles() + 60)));
    EXPECT_EQ(2U, bench.service_link(differential).late);
    EXPECT_EQ(0U, bench.service_link(differential).duplicates);
}

TEST(Link, AStatusFromBeforeTheFirstIsLateAndNotADuplicate) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_BATTERY).mute = true;
    Ready bench(robot);
    const std::uint64_t now = robot.cycles();
    EXPECT_EQ(0, bench.receive(robot.status_at(ROBUROC4_SERVICE_BATTERY, now + 10)));
    EXPECT_EQ(ROBUROC4_ERR_OLD, bench.receive(robot.status_at(ROBUROC4_SERVICE_BATTERY, now + 5)));
    EXPECT_EQ(1U, bench.service_link(ROBUROC4_SERVICE_BATTERY).late);
    EXPECT_EQ(0U, bench.service_link(ROBUROC4_SERVICE_BATTERY).duplicates);
}

TEST(Link, APauseOfMoreThanAMinuteIsNotLoss) {
    constexpr std::uint64_t minute_cycles = 60 * second / ROBUROC4_CYCLE_US;
    for (const std::uint64_t cycles : {minute_cycles, minute_cycles + 1}) {
        ScriptedRobot robot;
        Ready bench(robot);
        roburoc4_differential_status last;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_differential(&bench.client, &last, nullptr));
        const std::uint32_t period_us = bench.service_link(differential).period_us;
        const std::uint64_t missing = cycles * ROBUROC4_CYCLE_US / period_us - 1;
        robot.service(differential).mute = true;
        bench.run(cycles * ROBUROC4_CYCLE_US);
        EXPECT_EQ(0, bench.receive(robot.status_at(differential, last.robot_cycles + cycles)));
        EXPECT_EQ(cycles > minute_cycles ? 0 : missing, bench.service_link(differential).lost);
    }
}

TEST(Link, JitterIsTheSmoothedDeviationOfArrivals) {
    Ready bench;
    bool late = false;
    bench.delay_to_client = [&] {
        late = !late;
        return late ? 8 * ms : 0;
    };
    bench.robot.subscriptions = {{6, 5}}; /* so that its statuses alternate */
    bench.run(20 * second);
    EXPECT_GT(bench.service_link(differential).jitter_us, 4000U);
    EXPECT_LE(bench.service_link(differential).jitter_us, 8000U);
    bench.delay_to_client = nullptr;
    bench.run(20 * second);
    EXPECT_LT(bench.service_link(differential).jitter_us, 100U);
}

TEST(Link, RoundTripIsThatOfAnsweredRequests) {
    RobotBench bench;
    EXPECT_EQ(0U, bench.link().round_trip_us);
    bench.delay_to_client = [] { return 7 * ms; };
    bench.ready();
    EXPECT_EQ(7000U, bench.link().round_trip_min_us);
    EXPECT_NEAR(7000, bench.link().round_trip_us, 100);
    bench.delay_to_client = [] { return 21 * ms; };
    bench.run(60 * second);
    EXPECT_EQ(7000U, bench.link().round_trip_min_us);
    EXPECT_NEAR(21000, bench.link().round_trip_us, 300);
    bench.delay_to_client = [] { return 3 * ms; };
    bench.run(60 * second);
    EXPECT_EQ(3000U, bench.link().round_trip_min_us);
}

TEST(Link, RoundTripIsThatOfTheNetworkSinceTheRobotWasFoundAgain) {
    for (const bool reboot : {false, true}) {
        SCOPED_TRACE(reboot);
        ScriptedRobot robot;
        robot.powered = false;
        Started bench(robot);
        EXPECT_EQ(0U, bench.link().round_trip_us) << "before the first answer";
        EXPECT_EQ(0U, bench.link().round_trip_min_us);
        robot.powered = true;
        bench.delay_to_client = [] { return 7 * ms; };
        ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
        bench.run(second);
        robot.powered = false;
        bench.delay_to_client = nullptr;
        if (reboot) {
            for (std::uint64_t i = 0; i < 3; i++)
                bench.receive(robot.status_at(differential, i));
            ASSERT_EQ(1U, bench.count(ROBUROC4_COUNT_REBOOTS));
        } else {
            ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
        }
        EXPECT_EQ(0U, bench.link().round_trip_us);
        EXPECT_EQ(0U, bench.link().round_trip_min_us);
        robot.powered = true;
        bench.delay_to_client = [] { return 21 * ms; };
        ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
        EXPECT_EQ(21000U, bench.link().round_trip_min_us);
        EXPECT_NEAR(21000, bench.link().round_trip_us, 100);
    }
}

TEST(Link, AgeAndSilenceGrowWhileNothingComes) {
    RobotBench bench;
    EXPECT_EQ(UINT32_MAX, bench.service_link(differential).age_us);
    EXPECT_EQ(0.0F, bench.service_link(differential).loss);
    EXPECT_EQ(0.0F, bench.link().loss);
    bench.ready();
    bench.robot.powered = false;
    const std::uint32_t before_us = bench.service_link(differential).age_us;
    EXPECT_LE(before_us, 110000U);
    bench.run(500 * ms);
    EXPECT_EQ(before_us + 500000U, bench.service_link(differential).age_us);
    EXPECT_GE(bench.link().silence_us, 500000U);
    bench.run(3 * second);
    EXPECT_NEAR(before_us + 3500000.0, bench.service_link(differential).age_us, 1000);
}

TEST(Link, AgeIsThatOfTheVeryFirstStatus) {
    Started bench;
    ASSERT_TRUE(bench.run_until([&] { return bench.service_link(differential).received == 1; }));
    EXPECT_LE(bench.service_link(differential).age_us, 60000U) << "an upper bound";
    const std::uint32_t before_us = bench.service_link(differential).age_us;
    bench.run(20 * ms);
    ASSERT_EQ(1U, bench.service_link(differential).received);
    EXPECT_EQ(before_us + 20000U, bench.service_link(differential).age_us);
}

TEST(Link, AnOlderRequestThatIsAnsweredLaterMakesNoStatusOlder) {
    ScriptedRobot robot;
    for (ScriptedService &service : robot.services)
        service.mute = true;
    std::uint8_t id = 0;
    robot.instead = [&](const roburoc4_request &r, std::vector<Bytes> &) {
        id = r.action == ROBUROC4_ACTION_REPLACE ? r.id : id;
        return r.action == ROBUROC4_ACTION_REPLACE;
    };
    roburoc4_config config = default_config();
    config.lost_ms = 2000; /* no status comes for a second */
    Started bench(robot, config);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_relocalize(&bench.client, 1, 2, 3, bench.client_us()));
    bench.run(1010 * ms); /* a probe is answered */
    robot.say(plain_answer(id, ROBUROC4_ACTION_REPLACE, ROBUROC4_SERVICE_LOCALIZATION, 0));
    bench.pump();
    ASSERT_EQ(ROBUROC4_ERR_STALE_DIFFERENTIAL, bench.facts().relocalize_result) << "but answered";
    robot.say(robot.status(ROBUROC4_SERVICE_IOCARD));
    bench.pump();
    EXPECT_EQ(20000U, bench.service_link(ROBUROC4_SERVICE_IOCARD).age_us)
        << "since the probe, and a cycle";
}

/** Where motion is measured seldom, the first status may have a stamp from long before it was made,
 *  so an answer proves nothing about it. */
TEST(Link, TheFirstStatusOfMotionProvesNoAge) {
    ScriptedRobot robot;
    for (ScriptedService &service : robot.services)
        service.mute = true;
    roburoc4_config config = default_config();
    config.lost_ms = 2000;
    Started bench(robot, config);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    bench.run(1010 * ms); /* a probe is answered */
    robot.say(robot.status_at(ROBUROC4_SERVICE_DIFFERENTIAL, robot.cycles() - 8));
    bench.pump();
    bench.run(400 * ms);
    robot.say(robot.status_at(ROBUROC4_SERVICE_DIFFERENTIAL, robot.cycles() - 38));
    bench.pump();
    EXPECT_GE(bench.service_link(differential).age_us, 360000U) << "it took that long";
}

TEST(Link, HugeAgeAndSilenceAreTheLargestNumber) {
    Ready bench;
    bench.now_us += std::uint64_t{UINT32_MAX} + 5 * second;
    EXPECT_EQ(UINT32_MAX, bench.service_link(differential).age_us);
    EXPECT_EQ(UINT32_MAX, figures(bench).silence_us);
}

TEST(Link, SilenceIsNotEndedByWhatWasDropped) {
    Ready bench;
    bench.robot.powered = false;
    bench.run(500 * ms);
    bench.receive({1, 2, 3, 4, 0, 6});
    bench.receive({0xFF, 6});
    bench.receive(bench.robot.status_at(6, 5));
    EXPECT_GE(bench.link().silence_us, 500000U);
}

TEST(HostTime, IsUnknownBeforeTheFirstStatus) {
    RobotBench bench;
    std::uint64_t host_us = 3;
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, roburoc4_client_host_time(&bench.client, 5, &host_us));
    EXPECT_EQ(3U, host_us);
}

TEST(HostTime, IsThatOfTheArrivalLessHalfOfTheShortestRoundTrip) {
    ScriptedRobot robot;
    Bench bench(robot);
    const std::uint64_t power_on_us = bench.now_us - 1000 * ROBUROC4_CYCLE_US;
    bench.delay_to_client = [] { return 20 * ms; };
    bench.ready();
    for (const std::uint64_t cycles : {std::uint64_t{0}, robot.cycles(), robot.cycles() + 77}) {
        std::uint64_t host_us = 0;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_host_time(&bench.client, cycles, &host_us));
        EXPECT_EQ(power_on_us + cycles * ROBUROC4_CYCLE_US + 20 * ms - 10 * ms, host_us);
    }
}

TEST(HostTime, IsWithinTenMillisecondsPlusTheJitter) {
    RobotBench bench;
    std::uint32_t x = 1;
    bench.delay_to_client = [&] {
        x = x * 1664525U + 1013904223U;
        return 2 * ms + x / 65536U % 15000U;
    };
    bench.start();
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    for (int i = 0; i < 30; i++) {
        bench.run(second);
        const std::uint64_t cycles = bench.robot.cycles() - 3;
        std::uint64_t host_us = 0;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_host_time(&bench.client, cycles, &host_us));
        const auto error = static_cast<std::int64_t>(host_us - true_us(bench.robot, bench, cycles));
        EXPECT_LE(std::abs(error), 25000) << "after " << i << " s";
    }
}

TEST(HostTime, FollowsARobotWhoseClockDrifts) {
    for (const bool from_zero : {false, true}) {
        SCOPED_TRACE(from_zero);
        ScriptedRobot robot;
        Bench bench(robot);
        if (from_zero)
            bench.skew_us = -static_cast<std::int64_t>(bench.now_us);
        bench.ready();
        for (int i = 0; i < 60; i++) {
            bench.run(second);
            robot.set_cycles(robot.cycles()); /* it falls behind by what is left of a cycle */
            bench.run(5 * ms);
        }
        bench.run(12 * second);
        std::uint64_t host_us = 0;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_host_time(&bench.client, robot.cycles(), &host_us));
        EXPECT_NEAR(static_cast<double>(bench.client_us()), static_cast<double>(host_us), 15000);
    }
}

TEST(HostTime, IsThatOfTheFastestStatusOfTheLastSeconds) {
    for (std::uint64_t phase = 0; phase < 5; phase++) {
        SCOPED_TRACE(phase);
        Ready bench;
        const auto error_us = [&] {
            const std::uint64_t cycles = bench.robot.cycles();
            std::uint64_t host_us = 0;
            EXPECT_EQ(ROBUROC4_OK, roburoc4_client_host_time(&bench.client, cycles, &host_us));
            return host_us - true_us(bench.robot, bench, cycles);
        };
        bench.run((5 + phase) * second);
        bench.delay_to_client = [] { return 40 * ms; };
        for (int i = 0; i < 40; i++) {
            bench.run(100 * ms);
            ASSERT_EQ(0U, error_us()) << "the fast ones count for seconds, " << i;
        }
        bench.run(8 * second);
        EXPECT_EQ(40 * ms, error_us()) << "but not for ever";
        bench.delay_to_client = nullptr;
        bench.run(200 * ms);
        EXPECT_EQ(0U, error_us()) << "the first fast one counts";
    }
}

TEST(RoundTrip, OfMoreThanAnHourCountsAsAQuarterOfAnHour) {
    RobotBench bench;
    Bytes answer;
    bench.drop_to_client = [&](const Bytes &bytes) {
        answer = bytes;
        return true;
    };
    bench.start();
    bench.now_us += 80 * 60 * second;
    bench.receive(answer);
    EXPECT_EQ(1U << 30, bench.link().round_trip_us);
}

TEST(HostTime, IsAsGoodAsTheBestStatusOfTheLastSeconds) {
    ScriptedRobot robot;
    Ready bench(robot);
    std::uint64_t delay_us = 30 * ms;
    bench.delay_to_client = [&] { return delay_us; };
    for (int i = 0; i < 4; i++) {
        bench.run(11300 * ms); /* what came before is forgotten */
        std::uint64_t host_us = 0;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_host_time(&bench.client, robot.cycles(), &host_us));
        EXPECT_EQ(true_us(robot, bench, robot.cycles()) + 30 * ms, host_us);
        delay_us = 4 * ms;
        bench.run(50 * ms);
        delay_us = 30 * ms;
        bench.run(3 * second);
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_host_time(&bench.client, robot.cycles(), &host_us));
        EXPECT_EQ(true_us(robot, bench, robot.cycles()) + 4 * ms, host_us)
            << "delays only ever add";
    }
}
