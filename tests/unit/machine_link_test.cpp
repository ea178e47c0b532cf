/* SPDX-License-Identifier: MIT
 *
 * The machine "link": the order of statuses, loss, jitter, period, round trip, restarts.
 * Alone: what it promises to whoever calls it, also where the joined client never leads it.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

extern "C" {
#include "joined.h"
}

namespace {

constexpr std::uint64_t ms = 1000;
constexpr std::uint64_t second = 1000000;
constexpr std::uint64_t begin_us = 100 * second;

} // namespace

TEST(Link, ARoundTripBeyondAllMeasureIsTheLargestNumber) {
    roburoc4_private_link l{};
    roburoc4_link_round_trip(&l, begin_us, begin_us + (std::uint64_t{1} << 40));
    EXPECT_EQ(UINT32_MAX, l.round_trip_us);
    EXPECT_EQ(UINT32_MAX, l.round_trip_min_us);
    roburoc4_link_round_trip(&l, begin_us, begin_us);
    EXPECT_EQ(1U, l.round_trip_min_us) << "0 would mean that there is none";
    EXPECT_EQ(UINT32_MAX - UINT32_MAX / 8, l.round_trip_us);
}

namespace {

/** A link with one service at 50 ms, which has brought a status of cycle 1000. */
struct Linked {
    roburoc4_private_link l{};
    std::uint64_t now_us = begin_us;

    Linked() {
        for (roburoc4_private_service &service : l.services)
            service.asked_cycles = 5;
        roburoc4_link_restart(&l);
        status(1000);
    }
    verdict status(std::uint64_t robot_cycles) {
        now_us += 50 * ms;
        return roburoc4_link_status(&l, 0, robot_cycles, now_us);
    }
};

} // namespace

TEST(Link, StatusesFromThePastAreCountedAnewAfterARestart) {
    Linked linked;
    EXPECT_EQ(VERDICT_OLD, linked.status(500));
    EXPECT_EQ(VERDICT_OLD, linked.status(505));
    roburoc4_link_restart(&linked.l);
    EXPECT_EQ(VERDICT_NEW, linked.status(510)) << "the first of the past, not the third";
    EXPECT_EQ(VERDICT_NEW, linked.status(515));
    EXPECT_EQ(VERDICT_REBOOT, linked.status(520));
}

TEST(Link, LossIsOfTheLastTwoHundredStatusesAtMostAlsoWhereHalfAreLost) {
    Linked linked;
    const roburoc4_private_service &service = linked.l.services[0];
    std::uint64_t robot_cycles = 1000;
    std::uint32_t most = 0;
    for (int i = 0; i < 1000; i++) {
        robot_cycles += i % 2 == 0 ? 5 : 15; /* two received, two lost */
        EXPECT_EQ(VERDICT_NEW, linked.status(robot_cycles));
        most = std::max(most, service.recent_received + service.recent_lost);
    }
    EXPECT_LT(most, 200U);
    EXPECT_GE(most, 190U) << "and not of much fewer";
    EXPECT_NEAR(service.recent_received, service.recent_lost, 2);
}

namespace {

/** A link that is full of figures, and what stands behind its last service. */
struct LinkInMemory {
    roburoc4_private_link l;
    roburoc4_private_values behind;
};

LinkInMemory full_link() {
    LinkInMemory link;
    std::memset(&link, 0xA5, sizeof link);
    return link;
}

} // namespace

TEST(Link, ARestartForgetsTheOrderOfStatusesAndKeepsTheTotals) {
    LinkInMemory link = full_link();
    LinkInMemory wanted = link;
    wanted.l.mapped = 0;
    wanted.l.back_count = 0;
    wanted.l.round_trip_us = 0;
    wanted.l.round_trip_min_us = 0;
    for (roburoc4_private_service &service : wanted.l.services) {
        service.seen = 0;
        service.period_cycles = service.asked_cycles;
        service.gap_count = 0;
        service.gap_min = UINT16_MAX;
    }
    roburoc4_link_restart(&link.l);
    EXPECT_EQ(0, std::memcmp(&wanted, &link, sizeof link));
}

TEST(Link, SpoiltItHasNoFreshStatusAndAllItsFigures) {
    LinkInMemory link = full_link();
    LinkInMemory wanted = link;
    for (roburoc4_private_service &service : wanted.l.services)
        service.fresh = 0;
    roburoc4_link_spoil(&link.l);
    EXPECT_EQ(0, std::memcmp(&wanted, &link, sizeof link));
    /* ... and on another clock, all that waits for something begins to wait now */
    for (roburoc4_private_service &service : wanted.l.services)
        service.inserted_us = begin_us;
    wanted.l.last_used_us = begin_us;
    wanted.l.mapped = 0;
    link = full_link();
    roburoc4_link_rebase(&link.l, begin_us);
    EXPECT_EQ(0, std::memcmp(&wanted, &link, sizeof link));
}

TEST(Link, JitterIsThatOfRfc3550) {
    Linked linked;
    const roburoc4_private_service &service = linked.l.services[0];
    const std::uint64_t origin_us = linked.now_us;
    std::uint64_t robot_cycles = 1000;
    double before_us = 0;
    double jitter_us = 0;
    std::uint32_t x = 1;
    for (int i = 0; i < 500; i++) {
        x = x * 1664525U + 1013904223U;
        const std::uint64_t delay_us = i % 100 < 60 ? x / 65536U % 30000U : 0;
        robot_cycles += 1 + x % 10U; /* that some are lost makes no difference */
        const std::uint64_t now_us =
            origin_us + (robot_cycles - 1000) * ROBUROC4_CYCLE_US + delay_us;
        ASSERT_EQ(VERDICT_NEW, roburoc4_link_status(&linked.l, 0, robot_cycles, now_us));
        const auto transit_us = static_cast<double>(delay_us);
        jitter_us += (std::abs(transit_us - before_us) - jitter_us) / 16;
        before_us = transit_us;
        EXPECT_NEAR(jitter_us, service.jitter_us, 16) << i << ": in whole microseconds";
    }
}

TEST(Link, OnlyAnOlderCountAfterANewSubscriptionOfASilentServiceIsARestart) {
    struct Case {
        std::int64_t subscribed_us; /* after the last status, which was 1000 */
        std::uint64_t silence_us, robot_cycles;
        verdict wanted;
    };
    for (const Case &c : {Case{1200000, 1500 * ms, 999, VERDICT_REBOOT},
                          Case{1200000, 1500 * ms, 1000, VERDICT_OLD}, /* a copy of the last */
                          Case{1200000, 1500 * ms, 1001, VERDICT_NEW},
                          Case{50000, 100 * ms, 999, VERDICT_OLD}, /* it never was silent */
                          Case{0, 1500 * ms, 999, VERDICT_OLD},    /* nor subscribed to anew */
                          Case{-1000000, 1500 * ms, 999, VERDICT_OLD}}) {
        SCOPED_TRACE(testing::Message() << c.subscribed_us << " us, cycle " << c.robot_cycles);
        Linked linked;
        linked.l.services[0].inserted_us =
            linked.now_us + static_cast<std::uint64_t>(c.subscribed_us);
        const std::uint64_t now_us = linked.now_us + c.silence_us;
        EXPECT_EQ(c.wanted, roburoc4_link_status(&linked.l, 0, c.robot_cycles, now_us));
    }
}

TEST(Link, ARestartIsToldUntilItIsHeeded) {
    Linked linked;
    for (std::uint64_t i = 0; i < 10; i++)
        EXPECT_EQ(i < 2 ? VERDICT_OLD : VERDICT_REBOOT, linked.status(500 + i)) << i;
    EXPECT_EQ(1U, linked.l.services[0].received);
}

TEST(Link, OnlyAnOlderCountAfterALossIsARestart) {
    for (const std::uint64_t back : {1U, 0U}) {
        Linked linked;
        roburoc4_link_restart(&linked.l);
        linked.l.resubscribed = 1;
        EXPECT_EQ(back > 0 ? VERDICT_REBOOT : VERDICT_NEW, linked.status(1000 - back)) << back;
    }
    /* the first one that is good ends the suspicion, for all services */
    Linked linked;
    linked.l.resubscribed = 1;
    EXPECT_EQ(VERDICT_NEW, linked.status(1001));
    EXPECT_EQ(VERDICT_NEW, roburoc4_link_status(&linked.l, 1, 990, linked.now_us));
    EXPECT_EQ(VERDICT_OLD, linked.status(1000));
}

TEST(Link, WhatCameBeforeTheFirstStatusIsLateAndNoCopy) {
    Linked linked;
    const roburoc4_private_service &service = linked.l.services[0];
    for (std::uint64_t back = 1; back <= 70; back++)
        EXPECT_EQ(VERDICT_OLD, linked.status(1000 - back));
    EXPECT_EQ(70U, service.late);
    EXPECT_EQ(0U, service.duplicates);
}

TEST(Link, ACopyIsACopyWhateverCameBetween) {
    for (std::uint64_t gap = 1; gap <= 63; gap++) {
        Linked linked;
        const roburoc4_private_service &service = linked.l.services[0];
        EXPECT_EQ(VERDICT_NEW, linked.status(1000 + gap));
        EXPECT_EQ(VERDICT_OLD, linked.status(1000 + gap));
        EXPECT_EQ(VERDICT_OLD, linked.status(1000));
        EXPECT_EQ(2U, service.duplicates) << gap;
        EXPECT_EQ(0U, service.late) << gap;
    }
}

TEST(Link, AVeryLateCopyTakesNoLossBack) {
    for (const std::uint64_t behind : {64U, 65U, 90U}) {
        Linked linked;
        const roburoc4_private_service &service = linked.l.services[0];
        EXPECT_EQ(VERDICT_NEW, linked.status(1000 + behind));
        const std::uint32_t lost = service.lost;
        EXPECT_GT(lost, 0U);
        EXPECT_EQ(VERDICT_OLD, linked.status(1000)); /* which had arrived long ago */
        EXPECT_EQ(lost, service.lost) << behind;
        EXPECT_EQ(VERDICT_OLD, linked.status(1000 + behind));
        EXPECT_EQ(1U, service.duplicates) << "the newest once more";
    }
}

TEST(Link, APauseOfTheRobotIsNoLoss) {
    for (const std::uint64_t gap : {std::uint64_t{6001}, std::uint64_t{65536 + 5},
                                    std::uint64_t{1} << 32, std::uint64_t{1} << 60}) {
        Linked linked;
        const roburoc4_private_service &service = linked.l.services[0];
        EXPECT_EQ(VERDICT_NEW, linked.status(1000 + gap));
        EXPECT_EQ(VERDICT_NEW, linked.status(1005 + gap));
        EXPECT_EQ(0U, service.lost) << gap;
        EXPECT_EQ(5U, service.period_cycles);
        EXPECT_EQ(3U, service.received);
    }
}

TEST(Link, ThePeriodIsTheShortestGapWhereverItStands) {
    for (int at = 0; at < 16; at++) {
        for (const bool once : {false, true}) {
            Linked linked;
            std::uint64_t robot_cycles = 1000;
            for (int i = 0; i < 16; i++) {
                robot_cycles += (i == at) == once ? 10 : 20;
                EXPECT_EQ(VERDICT_NEW, linked.status(robot_cycles));
            }
            EXPECT_EQ(10U, linked.l.services[0].period_cycles) << at << " " << once;
        }
    }
}

TEST(Link, LossOfBeforeIsKeptWhereThePeriodTurnsOutToBeShorter) {
    for (const std::uint64_t period : {4U, 3U, 2U, 1U}) {
        Linked linked;
        const roburoc4_private_service &service = linked.l.services[0];
        EXPECT_EQ(VERDICT_NEW, linked.status(1020)); /* three are lost */
        for (std::uint64_t i = 1; i <= 20; i++)
            EXPECT_EQ(VERDICT_NEW, linked.status(1020 + i * period));
        EXPECT_EQ(period, service.period_cycles);
        EXPECT_EQ(3U, service.lost);
        EXPECT_EQ(3U, service.recent_lost);
    }
}

TEST(Link, WhatComesLateAfterALongGapIsLateAndNoCopy) {
    Linked linked;
    const roburoc4_private_service &service = linked.l.services[0];
    EXPECT_EQ(VERDICT_NEW, linked.status(1100)); /* 19 are lost */
    for (std::uint64_t i = 1; i <= 12; i++) {
        EXPECT_EQ(VERDICT_OLD, linked.status(1100 - 5 * i));
        EXPECT_EQ(19 - i, service.lost);
    }
    EXPECT_EQ(12U, service.late);
    EXPECT_EQ(0U, service.duplicates);
}

TEST(Link, ANetworkThatSwapsEveryTwoStatusesLosesNone) {
    Linked linked;
    const roburoc4_private_service &service = linked.l.services[0];
    for (std::uint64_t i = 1; i <= 200; i++) {
        EXPECT_EQ(VERDICT_NEW, linked.status(1000 + 10 * i));
        EXPECT_LE(service.lost, 1U) << "the one that is on its way";
        EXPECT_LE(service.recent_lost, 1U);
        EXPECT_EQ(VERDICT_OLD, linked.status(1000 + 10 * i - 5));
        EXPECT_EQ(0U, service.lost) << i;
        EXPECT_EQ(0U, service.recent_lost) << i;
    }
    EXPECT_EQ(200U, service.late);
}

TEST(Link, ALateStatusTakesBackNoMoreLossThanThereIs) {
    for (std::uint64_t missing = 180; missing < 205; missing++) {
        Linked linked;
        const roburoc4_private_service &service = linked.l.services[0];
        for (std::uint64_t i = 1; i <= missing + 10; i++)
            if (i != missing) {
                EXPECT_EQ(VERDICT_NEW, linked.status(1000 + 5 * i));
            }
        EXPECT_LE(service.recent_lost, 1U);
        EXPECT_EQ(VERDICT_OLD, linked.status(1000 + 5 * missing));
        EXPECT_EQ(0U, service.recent_lost) << missing;
        EXPECT_EQ(0U, service.lost);
        EXPECT_EQ(missing + 10, service.received + service.late - 1);
    }
}

TEST(Link, WhatWasNeverSentIsNoLossHoweverOftenThePeriodGrows) {
    Linked linked;
    const roburoc4_private_service &service = linked.l.services[0];
    std::uint64_t robot_cycles = 1000;
    for (const std::uint64_t period : {5U, 10U, 40U, 80U}) {
        for (int i = 0; i < 16; i++) { /* after so many it is believed */
            robot_cycles += period == 5 && i == 7 ? 3 * period : period; /* two are lost */
            EXPECT_EQ(VERDICT_NEW, linked.status(robot_cycles));
        }
        EXPECT_EQ(period, service.period_cycles);
        EXPECT_EQ(2U, service.lost);
        EXPECT_EQ(2U, service.recent_lost);
    }
}

TEST(Link, TheFirstRoundTripIsTakenWholeAndOfAllTheShortestIsKept) {
    roburoc4_private_link l{};
    roburoc4_link_round_trip(&l, 1000, 9000);
    EXPECT_EQ(8000U, l.round_trip_us);
    EXPECT_EQ(8000U, l.round_trip_min_us);
    roburoc4_link_round_trip(&l, 1000, 17000);
    EXPECT_EQ(9000U, l.round_trip_us) << "an eighth of the way";
    EXPECT_EQ(8000U, l.round_trip_min_us);
    roburoc4_link_round_trip(&l, 1000, 1000);
    EXPECT_EQ(1U, l.round_trip_min_us) << "0 would be none";
}
