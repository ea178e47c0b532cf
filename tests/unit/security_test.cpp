/* SPDX-License-Identifier: MIT
 *
 * security_test.cpp - the claims of docs/SECURITY.md: what somebody who can forge the robot's
 * address can do to a client, and what they cannot. udp_test.cpp tests that other hosts are not
 * received.
 */
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

/** A forged datagram: a telegram of the robot with any bytes after its header. */
Bytes forged(std::mt19937 &random) {
    Bytes bytes(1 + random() % 120);
    for (std::uint8_t &byte : bytes)
        byte = static_cast<std::uint8_t>(random());
    if (random() % 10 < 7)
        bytes[0] = ROBUROC4_HEADER_STATUS;
    if (bytes.size() > 3 && random() % 10 < 8) {
        bytes[1] = static_cast<std::uint8_t>(random() % 8);
        bytes[2] = 0;
    }
    return bytes;
}

Bytes speed_status(ScriptedRobot &robot, std::uint64_t cycles, float target) {
    const float before = robot.target_linear;
    robot.target_linear = target;
    Bytes bytes = robot.status_at(ROBUROC4_SERVICE_DIFFERENTIAL, cycles);
    robot.target_linear = before;
    return bytes;
}

} // namespace

TEST(Security, NoForgedDatagramMakesAClientCommandThatWasNotArmed) {
    Ready bench;
    std::mt19937 random(1);
    for (int i = 0; i < 20000; i++) {
        bench.receive(forged(random));
        if (i % 20 == 0)
            bench.run(1 * ms);
    }
    EXPECT_TRUE(bench.commands().empty());
    EXPECT_EQ(0, bench.facts().armed);
}

TEST(Security, ForgedLimitsNeverLiftTheConfiguredCeilings) {
    ScriptedRobot robot;
    robot.differential.max_linear_m_s = robot.differential.max_angular_rad_s = 1e30F;
    roburoc4_config config = default_config();
    config.max_linear_m_s = 0.5F;
    config.max_angular_rad_s = 1.0F;
    Armed bench(robot, config);
    bench.driving(5.0F, 10.0F, 1 * second);
    ASSERT_GT(bench.speeds(), 0U);
    for (const auto &command : bench.commands()) {
        EXPECT_LE(std::fabs(command.linear), 0.5F);
        EXPECT_LE(std::fabs(command.angular), 1.0F);
    }
}

TEST(Security, ForgedLimitsThatAreNotFinitePreventDriving) {
    ScriptedRobot robot;
    robot.differential.max_linear_m_s = std::numeric_limits<float>::quiet_NaN();
    Ready bench(robot);
    EXPECT_EQ(ROBUROC4_ERR_LIMITS, bench.arm());
}

TEST(Security, AForgedOverrideOnlyDisarms) {
    Armed bench;
    bench.driving(0.5F, 0.0F, 200 * ms);
    bench.robot.press(ROBUROC4_DI_PAD_A);
    bench.receive(bench.robot.status_at(ROBUROC4_SERVICE_IOCARD, bench.robot.cycles() + 1));
    bench.robot.press(ROBUROC4_DI_PAD_A, false);
    EXPECT_EQ(0, bench.facts().armed);
    bench.sent.clear();
    bench.run(1 * second);
    EXPECT_EQ(0U, bench.speeds());
    EXPECT_GE(bench.commands().size(), 3U); /* zeros */
}

TEST(Security, AForgedConfirmationLeavesThreeZeros) {
    Armed bench;
    bench.driving(0.5F, 0.0F, 200 * ms);
    bench.sent.clear();
    bench.stop();
    bench.poll();
    bench.receive(speed_status(bench.robot, bench.robot.cycles() + 2, 0));
    bench.run(1 * second);
    EXPECT_GE(bench.commands().size(), 3U);
    EXPECT_EQ(0U, bench.speeds());
}

TEST(Security, StatusesFromAFarFutureAreDropped) {
    ScriptedRobot robot;
    Armed bench(robot);
    for (const std::uint32_t kind :
         std::vector<std::uint32_t>{ROBUROC4_SERVICE_DIFFERENTIAL, ROBUROC4_SERVICE_IOCARD})
        EXPECT_EQ(ROBUROC4_ERR_OLD,
                  bench.receive(robot.status_at(kind, robot.cycles() + 1000000000)));
    bench.run(1 * second);
    EXPECT_EQ(1, bench.facts().armed);
    for (std::uint64_t i = 0; i < 3; i++)
        bench.receive(robot.status_at(ROBUROC4_SERVICE_IOCARD, robot.cycles() + 1000000000 + i));
    EXPECT_EQ(0, bench.facts().armed) << "three in a row are a restart";
    EXPECT_TRUE(bench.run_until([&] { return bench.arm() == ROBUROC4_OK; }, 15 * second));
}

TEST(Security, AnAnswerToNoOpenRequestChangesNothing) {
    Ready bench;
    const std::uint32_t before = bench.count(ROBUROC4_COUNT_UNMATCHED);
    for (int id = 0; id < 255; id++)
        bench.receive(plain_answer(static_cast<std::uint8_t>(id), ROBUROC4_ACTION_QUERY, 77, 1));
    EXPECT_GE(bench.count(ROBUROC4_COUNT_UNMATCHED), before + 254);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

TEST(Security, AFloodOfNonsenseDoesNotEndALeaseNorRenewIt) {
    Armed bench;
    Bytes nonsense(2048, 0x01);
    for (int round = 0; round < 20; round++) {
        ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0.0F));
        for (int i = 0; i < 1000; i++)
            EXPECT_LT(bench.receive(nonsense), 0);
        bench.run(50 * ms);
    }
    const std::uint64_t last_us = bench.now_us - 50 * ms;
    for (int i = 0; i < 100; i++) {
        bench.receive(nonsense);
        bench.run(10 * ms);
    }
    EXPECT_EQ(0U, bench.speeds(last_us + 250 * ms));
}
