/* SPDX-License-Identifier: MIT
 *
 * A robot that restarts: how a client notices, and that it reads everything again.
 */
#include "client_bench.h"

using namespace roburoc4_tests;

TEST(Reboot, IsAnOlderCycleCountAfterANewSubscription) {
    RobotBench bench;
    bench.delay_to_client = [] { return 1 * ms; };
    bench.ready();
    bench.robot.powered = false;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    bench.robot.reboot();
    bench.robot.set_cycles(1050); /* less than before, but not by 100 cycles */
    bench.robot.powered = true;
    ASSERT_TRUE(bench.run_until([&] { return bench.count(ROBUROC4_COUNT_REBOOTS) == 1; }));
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_REBOOT);
    EXPECT_NE(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 2 * second));
    bench.run(10 * second);
    EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_REBOOTS)) << "noticed once";
}

TEST(Reboot, IsThreeStatusesInARowMoreThanAHundredCyclesBack) {
    Ready bench;
    const std::uint64_t newest = bench.robot.cycles();
    EXPECT_EQ(ROBUROC4_ERR_OLD, bench.receive(bench.robot.status_at(6, newest - 101)));
    EXPECT_EQ(ROBUROC4_ERR_OLD, bench.receive(bench.robot.status_at(2, newest - 150)));
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_REBOOTS));
    bench.receive(bench.robot.status_at(5, newest - 200));
    EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_REBOOTS));
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_REBOOT);
}

TEST(Reboot, IsNotThreeStatusesAHundredCyclesBack) {
    ScriptedRobot robot;
    Ready bench(robot);
    roburoc4_differential_status last;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_differential(&bench.client, &last, nullptr));
    for (int i = 0; i < 10; i++)
        EXPECT_EQ(ROBUROC4_ERR_OLD, bench.receive(robot.status_at(6, last.robot_cycles - 100)));
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_REBOOTS));
}

TEST(Reboot, BetweenStatusesOfTwoSubscriptionsIsSurvived) {
    RobotBench bench;
    bench.delay_to_client = [] { return 1 * ms; };
    bench.start();
    ASSERT_TRUE(bench.run_until([&] { return roburoc4_client_service_id(&bench.client, 6) > 0; }));
    const std::uint64_t before = bench.robot.cycles() + 1000000;
    EXPECT_EQ(ROBUROC4_ERR_UNEXPECTED_STATUS, bench.receive(bench.robot.status_at(6, before)));
    EXPECT_TRUE(bench.run_until([&] { return bench.arm() >= 0; }, 5 * second));
    EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_REBOOTS));
}

TEST(Reboot, IsNotAnotherKindOfStatusWithAStampOfItsOwn) {
    ScriptedRobot robot;
    robot.services.push_back({ROBUROC4_TYPE_LASER, 9, 99, "Laser"});
    Bench bench(robot);
    bench.delay_to_client = [] { return 1 * ms; };
    bench.start();
    for (int i = 0; i < 5000 && bench.arm() < 0; i++) {
        bench.run(2 * ms);
        bench.receive(robot.status_at(99, bench.now_us));
    }
    EXPECT_EQ(1, bench.facts().armed);
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_REBOOTS));
}

TEST(Reboot, IsNotTwoStatusesBackAndANewerOne) {
    Ready bench;
    for (int i = 0; i < 10; i++) {
        const std::uint64_t newest = bench.robot.cycles();
        bench.receive(bench.robot.status_at(6, newest - 300));
        bench.receive(bench.robot.status_at(6, newest - 300));
        if (i % 2 == 0)
            bench.run(100 * ms);
        else
            bench.receive(bench.robot.status_at(6, newest - 50));
    }
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_REBOOTS));
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
}

TEST(Reboot, PropertiesAreReadAgainBeforeAnythingElseCounts) {
    ScriptedRobot robot;
    Ready bench(robot);
    const std::uint64_t newest = robot.cycles();
    robot.reboot();
    robot.differential.max_linear_m_s = 1.25F;
    robot.requests.clear();
    for (std::uint64_t i = 3; i > 0; i--)
        bench.receive(robot.status_at(6, newest - 200 - i));
    ASSERT_EQ(1U, bench.count(ROBUROC4_COUNT_REBOOTS));
    EXPECT_EQ(0U, service_count(&bench.client));
    EXPECT_EQ(ROBUROC4_ERR_UNEXPECTED_STATUS, bench.receive(robot.status_at(6, 7)))
        << "statuses before the new properties do not count";
    roburoc4_differential_properties properties;
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN,
              roburoc4_client_differential_properties(&bench.client, &properties));
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 2 * second));
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_differential_properties(&bench.client, &properties));
    EXPECT_EQ(1.25F, properties.max_linear_m_s);
    EXPECT_EQ(5U, robot.seen(ROBUROC4_ACTION_INSERT).size());
}

TEST(Reboot, TextsAreAskedForAgain) {
    Ready bench;
    bench.robot.powered = false;
    bench.run(2 * second);
    bench.robot.reboot();
    bench.robot.channel_text = [](std::uint32_t io_type, std::uint32_t index) {
        return io_type == ROBUROC4_IO_DIGITAL_INPUT && index == 3 ? "Game pad \"A\" button" : "";
    };
    bench.robot.powered = true;
    ASSERT_TRUE(bench.run_until([&] { return bench.count(ROBUROC4_COUNT_REBOOTS) == 1; }));
    ASSERT_TRUE(bench.run_until([&] { return bench.facts().descriptions_done == 1; }, 3 * second));
    EXPECT_EQ(3, roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE));
}

TEST(Reboot, OfTheSimulatorIsNoticed) {
    SimPartner sim;
    Bench bench(sim);
    bench.ready();
    bench.run(5 * second);
    roburoc4_sim_set(sim.get(), ROBUROC4_SIM_POWER, 0);
    bench.run(3 * second);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_LOST), bench.state());
    roburoc4_sim_set(sim.get(), ROBUROC4_SIM_POWER, 1);
    ASSERT_TRUE(bench.run_until([&] { return bench.count(ROBUROC4_COUNT_REBOOTS) == 1; }));
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 3 * second));
    bench.run(5 * second);
    EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_REBOOTS));
}

TEST(Reboot, TooQuickToBeLostIsStillNoticed) {
    Ready bench;
    bench.robot.reboot(); /* answers at once, but nothing is subscribed to any more */
    EXPECT_TRUE(
        bench.run_until([&] { return bench.count(ROBUROC4_COUNT_REBOOTS) == 1; }, 10 * second));
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 3 * second));
}

TEST(Reboot, AnOlderCountAfterANewSubscriptionIsOne) {
    roburoc4_config config = default_config();
    config.lost_ms = 5000; /* so that it is not lost first */
    Ready bench(config);
    const std::uint64_t newest = bench.robot.cycles();
    bench.robot.reboot();
    bench.robot.set_cycles(newest - 180); /* so that the new count is less, but not by 100 cycles */
    EXPECT_TRUE(
        bench.run_until([&] { return bench.count(ROBUROC4_COUNT_REBOOTS) == 1; }, 3 * second));
}

TEST(Reboot, IsNoStragglerOfAServiceThatPaused) {
    Ready bench;
    bench.robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = true;
    const std::uint64_t last = bench.robot.cycles();
    bench.run(1100 * ms); /* not yet subscribed to again */
    EXPECT_EQ(ROBUROC4_ERR_OLD, bench.receive(bench.robot.status_at(6, last - 7)));
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_REBOOTS));
}

TEST(Reboot, DoesNotComeFromAnotherPeriodOfAService) {
    ScriptedRobot robot;
    Ready bench(robot);
    for (int i = 0; i < 20; i++) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_subscribe(&bench.client, 5, i % 2 == 0 ? 20 : 50,
                                                         bench.client_us()));
        bench.receive(robot.status_at(6, robot.cycles() - 4)); /* a straggler of another service */
        bench.pump();
        bench.receive(robot.status_at(5, robot.cycles() - 9)); /* and of this one */
        bench.run(100 * ms);
    }
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_REBOOTS));
}
