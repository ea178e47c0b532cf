/* SPDX-License-Identifier: MIT
 *
 * A robot that refuses subscriptions, because its list is full.
 */
#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

void refuse_inserts(ScriptedRobot &robot, bool refused) {
    for (ScriptedService &service : robot.services)
        service.insert_refused = refused;
}

} // namespace

TEST(FullList, ARobotThatAcceptsNoSubscriptionIsNotReadyAndAskedAgain) {
    ScriptedRobot robot;
    refuse_inserts(robot, true);
    Started bench(robot);
    bench.run(10 * second);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_SUBSCRIBING), bench.state());
    EXPECT_EQ(0x7CU, bench.facts().missing);
    EXPECT_EQ(ROBUROC4_ERR_NOT_READY, bench.arm());
    const std::size_t asked = robot.seen(ROBUROC4_ACTION_INSERT, 6).size();
    EXPECT_GE(asked, 9U);
    EXPECT_LE(asked, 12U) << "once a second";
    refuse_inserts(robot, false);
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 2 * second));
    bench.run(second);
    EXPECT_EQ(0U, bench.facts().missing);
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

TEST(FullList, AnotherRobotIsNoticedAlthoughNoStatusShowsIt) {
    ScriptedRobot robot;
    refuse_inserts(robot, true);
    Started bench(robot);
    bench.run(3 * second);
    robot.services = usual_services();
    for (ScriptedService &service : robot.services)
        if (service.kind >= ROBUROC4_SERVICE_IOCARD)
            service.id = static_cast<std::uint16_t>(service.id + 100);
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 5 * second));
    bench.run(second);
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

TEST(FullList, AProgramThatWantsNoSubscriptionBecomesReady) {
    ScriptedRobot robot;
    refuse_inserts(robot, true);
    roburoc4_config config = default_config();
    config.subscriptions = 0;
    Started bench(robot, config);
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 2 * second));
    EXPECT_EQ(0U, bench.facts().missing);
}

TEST(FullList, ARefusedSubscriptionThatDrivingNeedsIsTheReason) {
    const std::uint32_t services[] = {ROBUROC4_SERVICE_IOCARD, ROBUROC4_SERVICE_DIFFERENTIAL};
    for (const std::uint32_t service : services) {
        SCOPED_TRACE(service);
        ScriptedRobot robot;
        robot.service(service).insert_refused = true;
        Ready bench(robot);
        EXPECT_EQ(1U << service, bench.facts().missing);
        for (int i = 0; i < 100; i++) { /* it is asked again meanwhile */
            bench.run(100 * ms);
            ASSERT_EQ(ROBUROC4_ERR_SUBSCRIPTION_REFUSED, bench.arm()) << i;
            ASSERT_EQ(1U << service, bench.facts().missing) << i;
            robot.service(service).insert_silent = i >= 50;
        }
        robot.service(service).insert_silent = false;
        EXPECT_GE(robot.seen(ROBUROC4_ACTION_INSERT, static_cast<int>(service)).size(), 2U);
        ASSERT_EQ(ROBUROC4_OK,
                  roburoc4_client_subscribe(&bench.client, service, 50, bench.client_us()));
        EXPECT_EQ(0U, bench.facts().missing) << "this one is not refused yet";
        bench.run(100 * ms);
        EXPECT_EQ(1U << service, bench.facts().missing);
        robot.service(service).insert_refused = false;
        EXPECT_TRUE(bench.run_until([&] { return bench.arm() == ROBUROC4_OK; }, 10 * second));
        EXPECT_EQ(0U, bench.facts().missing);
    }
}

TEST(FullList, AServiceThatRefusesAndSendsAllTheSameIsNotMissing) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_BATTERY).insert_refused = true;
    Ready bench(robot);
    ASSERT_EQ(1U << ROBUROC4_SERVICE_BATTERY, bench.facts().missing);
    robot.subscriptions[ROBUROC4_SERVICE_BATTERY] = 5;
    bench.run(second);
    EXPECT_EQ(0U, bench.facts().missing);
}

TEST(FullList, ACardThatIsNotListedIsTheReason) {
    ScriptedRobot robot;
    robot.remove(ROBUROC4_SERVICE_IOCARD);
    Ready bench(robot);
    EXPECT_EQ(1U << ROBUROC4_SERVICE_IOCARD, bench.facts().missing);
    EXPECT_EQ(ROBUROC4_ERR_SUBSCRIPTION_REFUSED, bench.arm());
}
