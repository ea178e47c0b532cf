/* SPDX-License-Identifier: MIT
 *
 * States of a client: connect, discover, subscribe, ready, lost, and back; restarts of the robot;
 * and everything that a robot may lack without keeping a client from being ready.
 */
#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

std::vector<std::uint32_t> states_until_ready(Bench &bench) {
    std::vector<std::uint32_t> states{bench.state()};
    EXPECT_EQ(ROBUROC4_OK, roburoc4_client_start(&bench.client, bench.client_us()));
    states.push_back(bench.state());
    EXPECT_TRUE(bench.run_until([&] {
        if (states.back() != bench.state())
            states.push_back(bench.state());
        return bench.state() == ROBUROC4_STATE_READY;
    }));
    return states;
}

void expect_ready_within(ScriptedRobot &robot, std::uint64_t limit_us) {
    Started bench(robot);
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, limit_us));
    bench.run(5 * second);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_LOST));
}

} // namespace

TEST(Life, IsIdleAndDisarmedAfterInitWhateverItsMemoryHeld) {
    ScriptedRobot robot;
    roburoc4_client client;
    memset(&client, 0xA5, sizeof client);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_init(&client, sizeof client, nullptr));
    roburoc4_facts facts{};
    facts.size = sizeof facts;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_facts(&client, 0, &facts));
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_IDLE), facts.state);
    EXPECT_EQ(0, facts.armed);
    EXPECT_EQ(ROBUROC4_ERR_DISARMED, facts.disarm_cause);
    EXPECT_EQ(UINT64_MAX, roburoc4_client_next_deadline(&client));
    std::uint8_t buffer[ROBUROC4_MAX_TRANSMIT];
    EXPECT_EQ(0, roburoc4_client_poll_transmit(&client, buffer, sizeof buffer, 5));
    EXPECT_EQ(ROBUROC4_ERR_STATE, roburoc4_client_receive(&client, buffer, 5, 5));
}

/* Uninitialized memory can look like a driving client, so init() cannot refuse it. */
TEST(Safety, InitOfADrivingClientLeavesItToTheWatchdog) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.3F, 0, second));
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_init(&bench.client, sizeof bench.client, nullptr));
    const std::size_t before = bench.sent.size();
    bench.run(5 * second);
    EXPECT_EQ(before, bench.sent.size()) << "nothing that was forgotten is sent";
    EXPECT_EQ(0, bench.robot.target_linear);
}

TEST(Life, GoesFromIdleThroughAllStatesToReady) {
    RobotBench bench;
    bench.delay_to_client = [] { return 1 * ms; };
    const std::vector<std::uint32_t> wanted{ROBUROC4_STATE_IDLE, ROBUROC4_STATE_CONNECTING,
                                            ROBUROC4_STATE_DISCOVERING, ROBUROC4_STATE_SUBSCRIBING,
                                            ROBUROC4_STATE_READY};
    EXPECT_EQ(wanted, states_until_ready(bench));
    const std::uint32_t events = bench.take_events();
    EXPECT_TRUE(events & ROBUROC4_EVENT_STATE);
    EXPECT_TRUE(events & ROBUROC4_EVENT_READY);
    EXPECT_TRUE(events & ROBUROC4_EVENT_PROPERTIES);
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_READY) << "events are cleared when taken";
}

TEST(Life, ReportsEveryNewStateAndReadyOnlyWhenItIs) {
    RobotBench bench;
    bench.delay_to_client = [] { return 1 * ms; };
    std::vector<std::uint32_t> told;
    const auto reaches = [&](std::uint32_t wanted) {
        return bench.run_until([&] {
            const std::uint32_t events =
                bench.take_events() & (ROBUROC4_EVENT_STATE | ROBUROC4_EVENT_READY);
            if (told.empty() || told.back() != bench.state()) {
                told.push_back(bench.state());
                EXPECT_EQ(bench.state() == ROBUROC4_STATE_READY
                              ? ROBUROC4_EVENT_STATE | ROBUROC4_EVENT_READY
                              : ROBUROC4_EVENT_STATE,
                          static_cast<int>(events))
                    << roburoc4_name(ROBUROC4_NAME_STATE, bench.state());
            } else {
                EXPECT_EQ(0U, events)
                    << "still " << roburoc4_name(ROBUROC4_NAME_STATE, bench.state());
            }
            return bench.state() == wanted;
        });
    };
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_start(&bench.client, bench.client_us()));
    ASSERT_TRUE(reaches(ROBUROC4_STATE_READY));
    bench.run(100 * ms); /* a robot that is lost before its first status is read anew */
    bench.robot.powered = false;
    ASSERT_TRUE(reaches(ROBUROC4_STATE_LOST));
    bench.robot.powered = true;
    ASSERT_TRUE(reaches(ROBUROC4_STATE_READY));
    bench.run(second);
    ASSERT_EQ(ROBUROC4_OK, bench.arm());
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0));
    bench.run(50 * ms);
    ASSERT_EQ(ROBUROC4_OK, bench.close());
    ASSERT_TRUE(reaches(ROBUROC4_STATE_IDLE));
    const std::vector<std::uint32_t> wanted{ROBUROC4_STATE_CONNECTING,  ROBUROC4_STATE_DISCOVERING,
                                            ROBUROC4_STATE_SUBSCRIBING, ROBUROC4_STATE_READY,
                                            ROBUROC4_STATE_LOST,        ROBUROC4_STATE_DISCOVERING,
                                            ROBUROC4_STATE_SUBSCRIBING, ROBUROC4_STATE_READY,
                                            ROBUROC4_STATE_CLOSING,     ROBUROC4_STATE_IDLE};
    EXPECT_EQ(wanted, told);
}

TEST(Life, AlsoWorksWithTheSimulator) {
    SimPartner sim;
    Bench bench(sim);
    states_until_ready(bench);
    bench.run(2 * second);
    for (std::uint32_t service = 2; service < ROBUROC4_SERVICE_COUNT; service++)
        EXPECT_GT(bench.service_link(service).received, 0U) << service;
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_LOST));
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_UNMATCHED));
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_DESCRIPTIONS_DONE);
    EXPECT_EQ(1, bench.facts().descriptions_done);
}

TEST(Life, WorksFromTimeZero) {
    ScriptedRobot robot;
    Bench bench(robot, default_config(), 20 * second);
    bench.skew_us = -static_cast<std::int64_t>(20 * second);
    bench.armed();
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 300 * ms));
    EXPECT_GE(bench.speeds(), 5U);
}

TEST(Life, GuessesNoServiceAfterASecondWithoutItsText) {
    for (const std::uint64_t start_us : {std::uint64_t{0}, 1000 * second}) {
        ScriptedRobot robot;
        robot.texts_silent = true;
        Bench bench(robot, default_config(), start_us);
        bench.start();
        bench.run_to(start_us + second - 1);
        EXPECT_EQ(1U, robot.seen(ROBUROC4_ACTION_GET).size()) << "the directory";
        bench.run_to(start_us + second);
        EXPECT_EQ(5U, robot.seen(ROBUROC4_ACTION_GET).size());
        EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
        EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN,
                  roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_BATTERY));
    }
}

TEST(Life, SubscribesWithTheConfiguredPeriods) {
    roburoc4_config config = default_config();
    config.period_ms[ROBUROC4_SERVICE_TELEMETER] = 2550;
    config.subscriptions = 0x7C & ~(1U << ROBUROC4_SERVICE_LOCALIZATION);
    Ready bench(config);
    const std::map<std::uint16_t, std::uint8_t> wanted{{2, 5}, {3, 255}, {4, 100}, {6, 5}};
    EXPECT_EQ(wanted, bench.robot.subscriptions);
}

TEST(Life, StartIsRefusedUnlessIdleAndCloseUnlessStarted) {
    RobotBench bench;
    EXPECT_EQ(ROBUROC4_ERR_STATE, bench.close());
    EXPECT_EQ(ROBUROC4_ERR_STATE, bench.pause());
    bench.start();
    EXPECT_EQ(ROBUROC4_ERR_STATE, roburoc4_client_start(&bench.client, bench.client_us()));
    EXPECT_EQ(ROBUROC4_OK, bench.close());
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_IDLE), bench.state());
    bench.ready();
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_LOST));
}

TEST(Life, KeepsAskingARobotThatIsNotThere) {
    ScriptedRobot robot;
    robot.powered = false;
    Started bench(robot);
    bench.run(60 * second);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_CONNECTING), bench.state());
    EXPECT_GT(bench.sent.size(), 55U);
    EXPECT_LT(bench.sent.size(), 70U);
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_LOST));
    robot.powered = true;
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 3 * second));
}

TEST(Life, IsLostAfterTheConfiguredSilenceAndReturnsByItself) {
    roburoc4_config config = default_config();
    config.lost_ms = 400;
    Ready bench(config);
    const std::uint64_t last_us = bench.now_us - bench.link().silence_us;
    bench.robot.powered = false;
    bench.run_to(last_us + 400 * ms - 1);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
    bench.run_to(last_us + 400 * ms);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_LOST), bench.state());
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_LOST);
    EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_LOST));
    bench.run(10 * second);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_LOST), bench.state());
    EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_LOST)) << "lost once";
    bench.robot.powered = true;
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 3 * second));
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_REBOOTS)) << "the same robot, its clock went on";
}

TEST(Life, ConnectsAgainAfterFiveSecondsOfSilenceBeforeItWasReady) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_BATTERY).get_silent = true;
    Started bench(robot);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_DISCOVERING));
    bench.run(100 * ms);
    const std::uint64_t last_us = bench.now_us - bench.link().silence_us;
    robot.powered = false;
    bench.run_to(last_us + 5 * second - 1);
    EXPECT_NE(static_cast<std::uint32_t>(ROBUROC4_STATE_CONNECTING), bench.state());
    bench.run_to(last_us + 5 * second);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_CONNECTING), bench.state());
    EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_LOST));
}

TEST(Life, WhileItStaysReadyItReportsOnlyStatuses) {
    Ready bench;
    bench.run(10 * second); /* every probe */
    const std::uint32_t news = ROBUROC4_EVENT_STATE | ROBUROC4_EVENT_READY |
                               ROBUROC4_EVENT_PROPERTIES | ROBUROC4_EVENT_CAPACITY;
    EXPECT_EQ(0U, bench.take_events() & news);
}

TEST(Life, IsNeverLostBeforeThreeOfTheShortestPeriod) {
    roburoc4_config config = default_config();
    config.lost_ms = 200;
    config.subscriptions = 1U << ROBUROC4_SERVICE_TELEMETER;
    config.period_ms[ROBUROC4_SERVICE_TELEMETER] = 600;
    Ready bench(config);
    bench.run(20 * second);
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_LOST));
    bench.robot.powered = false;
    bench.run(1700 * ms);
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_LOST));
    bench.run(200 * ms);
    EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_LOST));
}

TEST(Life, WhicheverPeriodIsTheShortestCounts) {
    for (std::uint32_t i = 0; i < 30; i++) {
        const std::uint32_t service = 2 + i % 5;
        const std::uint32_t lost_ms = std::array{200U, 250U, 299U, 301U, 350U, 450U}[i / 5];
        SCOPED_TRACE(testing::Message() << "service " << service << ", " << lost_ms << " ms");
        roburoc4_config config = default_config();
        config.lost_ms = lost_ms;
        config.fresh_ms = 1000;
        for (std::uint32_t other = 2; other < ROBUROC4_SERVICE_COUNT; other++)
            config.period_ms[other] = other == service ? 100 : 330;
        Ready bench(config);
        const std::uint64_t lost_us =
            bench.now_us - bench.link().silence_us + std::max(lost_ms, 300U) * ms;
        bench.robot.powered = false;
        bench.run_to(lost_us - 1);
        EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
        bench.run_to(lost_us);
        EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_LOST), bench.state());
    }
}

TEST(Life, APeriodThatIsRefusedOrNotListedShortensNothing) {
    for (const bool refused : {false, true}) {
        SCOPED_TRACE(refused);
        ScriptedRobot robot;
        if (refused)
            robot.service(ROBUROC4_SERVICE_TELEMETER).insert_refused = true;
        else
            robot.remove(ROBUROC4_SERVICE_TELEMETER);
        roburoc4_config config = default_config();
        config.lost_ms = 200;
        config.fresh_ms = 1000;
        for (std::uint32_t service = 2; service < ROBUROC4_SERVICE_COUNT; service++)
            config.period_ms[service] = service == ROBUROC4_SERVICE_TELEMETER ? 50 : 330;
        Ready bench(robot, config);
        bench.run(10 * second);
        EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_LOST)) << "three of 330 ms";
    }
}

TEST(Life, AClientWithoutSubscriptionsStaysReady) {
    roburoc4_config config = default_config();
    config.subscriptions = 0;
    Started bench(config);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    bench.run(30 * second);
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_LOST));
    EXPECT_TRUE(bench.robot.subscriptions.empty());
}

/* ---- what may be missing ---- */

TEST(ReadyWithout, Descriptions) {
    ScriptedRobot robot;
    robot.texts_silent = true;
    expect_ready_within(robot, 2 * second);
}

TEST(ReadyWithout, TheAnswersOfAnyServices) {
    for (unsigned silent = 1; silent < 32; silent++) {
        for (int ids = 0; ids < 3; ids++) {
            for (const bool properties : {true, false}) {
                if (silent == 31 && !properties)
                    continue; /* who never sends anything is lost */
                SCOPED_TRACE(testing::Message() << silent << " " << ids << " " << properties);
                ScriptedRobot robot;
                robot.always_manual_id = ids == 1;
                robot.only_manual_id = ids == 2;
                for (std::uint32_t i = 0; i < 5; i++) {
                    ScriptedService &service = robot.service(ROBUROC4_SERVICE_IOCARD + i);
                    if ((silent & (1U << i)) != 0)
                        (properties ? service.get_silent : service.insert_silent) = true;
                }
                expect_ready_within(robot, 20 * second);
            }
        }
    }
}

TEST(ReadyWithout, DescriptionsThatAreRefused) {
    ScriptedRobot robot;
    robot.texts_refused = true;
    expect_ready_within(robot, 1 * second);
}

TEST(ReadyWithout, KnowingAService) {
    ScriptedRobot robot;
    robot.services.push_back({0x1234, 77, 99, "Coffee machine"});
    expect_ready_within(robot, 1 * second);
}

TEST(ReadyWithout, ARefusedSubscription) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_TELEMETER).insert_refused = true;
    Started bench(robot);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 1 * second));
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_SUBSCRIPTION_REFUSED);
    EXPECT_EQ(0U, bench.service_link(ROBUROC4_SERVICE_TELEMETER).subscribed);
    EXPECT_EQ(1U, bench.service_link(ROBUROC4_SERVICE_BATTERY).subscribed);
}

TEST(ReadyWithout, AnAnswerToASubscription) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_TELEMETER).insert_silent = true;
    expect_ready_within(robot, 4 * second);
}

TEST(ReadyWithout, TheStatusesOfAService) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_TELEMETER).mute = true;
    Ready bench(robot);
    bench.run(10 * second);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
    const auto again = robot.seen(ROBUROC4_ACTION_INSERT, ROBUROC4_SERVICE_TELEMETER).size();
    EXPECT_GE(again, 3U) << "a silent service is subscribed to again";
    EXPECT_LE(again, 12U);
    EXPECT_EQ(1U, robot.seen(ROBUROC4_ACTION_INSERT, ROBUROC4_SERVICE_DIFFERENTIAL).size());
}

TEST(ReadyWithout, TheAnswersOfAService) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_BATTERY).get_silent = true;
    expect_ready_within(robot, 4 * second);
}

TEST(ReadyWithout, DescriptionsAndTheAnswersOfMostServices) {
    ScriptedRobot robot;
    robot.texts_silent = true;
    for (std::uint32_t service = 2; service < ROBUROC4_SERVICE_DIFFERENTIAL; service++)
        robot.service(service).get_silent = true;
    expect_ready_within(robot, 5 * second);
}

TEST(ReadyWithout, PropertiesThatAreRefusedOrShort) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_LOCALIZATION).get_refused = true;
    robot.service(ROBUROC4_SERVICE_IOCARD).get_length = 20;
    expect_ready_within(robot, 1 * second);
}

TEST(ReadyWithout, AnyService) {
    ScriptedRobot robot;
    robot.services.clear();
    Started bench(robot);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 1 * second));
    bench.run(10 * second);
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_LOST));
    EXPECT_EQ(0U, service_count(&bench.client));
    EXPECT_EQ(ROBUROC4_ERR_NO_DIFFERENTIAL, bench.arm());
}

TEST(Ready, StatusesBeforeTheAcknowledgementAreAccepted) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_BATTERY).insert_silent = true;
    Started bench(robot);
    ASSERT_TRUE(bench.run_until(
        [&] { return !robot.seen(ROBUROC4_ACTION_INSERT, ROBUROC4_SERVICE_BATTERY).empty(); }));
    EXPECT_EQ(0, bench.receive(robot.status(ROBUROC4_SERVICE_BATTERY)));
    roburoc4_battery_status battery;
    EXPECT_EQ(ROBUROC4_OK, roburoc4_client_battery(&bench.client, &battery, nullptr));
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 0))
        << "a status is as good as an acknowledgement";
}

/* The robot may have lost the subscription; one or two lost statuses do not show that. */
TEST(Ready, AServiceThatFallsSilentIsSubscribedToAgain) {
    for (std::uint32_t service = 2; service < ROBUROC4_SERVICE_COUNT; service++) {
        for (const bool from_the_first : {true, false}) {
            SCOPED_TRACE(std::to_string(service) + (from_the_first ? " from the first" : ""));
            ScriptedRobot robot;
            robot.service(service).mute = from_the_first;
            Bench bench(robot, default_config(), from_the_first ? 0 : 1000 * second);
            bench.start();
            ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
            bench.run(from_the_first ? 0 : 1500 * ms);
            robot.service(service).mute = true;
            const std::uint64_t silent_us = bench.now_us;
            const std::uint64_t period_us = default_config().period_ms[service] * ms;
            const auto asked = [&] { return robot.seen(ROBUROC4_ACTION_INSERT).size(); };
            bench.run_to(silent_us + 3 * period_us);
            EXPECT_EQ(5U, asked());
            bench.run_to(silent_us + 8 * period_us + second);
            EXPECT_EQ(6U, asked());
            EXPECT_EQ(service, robot.seen(ROBUROC4_ACTION_INSERT).back().what.subject);
            robot.service(service).mute = false;
            bench.run(8 * period_us + 2 * second);
            EXPECT_EQ(6U, asked());
            EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state());
        }
    }
}

TEST(Ready, DescriptionsAreStillFetchedAfterIt) {
    RobotBench bench;
    bench.delay_to_client = [] { return 1 * ms; };
    bench.start();
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    EXPECT_EQ(0, bench.facts().descriptions_done);
    ASSERT_TRUE(bench.run_until([&] { return bench.facts().descriptions_done == 1; }, second));
    EXPECT_EQ(7U + 9U + 22U + 8U, bench.robot.seen(ROBUROC4_ACTION_QUERY).size());
}

TEST(Ready, PropertiesAreReadBeforeSubscriptions) {
    Ready bench;
    std::size_t last_get = 0;
    std::size_t first_insert = bench.robot.requests.size();
    for (std::size_t i = 0; i < bench.robot.requests.size(); i++) {
        const roburoc4_request &r = bench.robot.requests[i].what;
        if (r.action == ROBUROC4_ACTION_INSERT)
            first_insert = std::min(first_insert, i);
        if (r.action == ROBUROC4_ACTION_GET && r.service == 6 && i < first_insert)
            last_get = i;
    }
    EXPECT_GT(last_get, 0U);
    EXPECT_LT(last_get, first_insert);
}

/* ---- another directory ---- */

TEST(Directory, AnotherOneIsNoticedAndDiscovered) {
    Armed bench;
    bench.robot.service(ROBUROC4_SERVICE_BATTERY).id = 44;
    ASSERT_TRUE(bench.run_until(
        [&] { return roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_BATTERY) == 44; },
        10 * second));
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 2 * second));
    EXPECT_EQ(0, bench.facts().armed);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_PROPERTIES);
}

TEST(Directory, IsAPropertyWhoseChangeIsAnEvent) {
    ScriptedRobot robot;
    robot.services.resize(2); /* itself and notification, which have no others */
    Started bench(robot);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 1 * second));
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_PROPERTIES);
    EXPECT_EQ(2U, service_count(&bench.client));
    bench.run(10 * second);
    EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_PROPERTIES);
    robot.services.push_back({0x1234, 77, 99, "Coffee machine"});
    bench.run(10 * second);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_PROPERTIES);
    EXPECT_EQ(3U, service_count(&bench.client));
}

TEST(Directory, WithFewerEntriesIsAnotherOne) {
    Ready bench;
    bench.robot.services.pop_back();
    ASSERT_TRUE(bench.run_until([&] { return service_count(&bench.client) == 6; }, 10 * second));
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN,
              roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_DIFFERENTIAL));
}

TEST(Directory, WithAnotherTypeIsAnotherOne) {
    for (std::size_t i = 0; i < usual_services().size(); i++) {
        Armed bench;
        bench.robot.services[i].type = ROBUROC4_TYPE_LASER;
        EXPECT_TRUE(bench.run_until([&] { return bench.facts().armed == 0; }, 10 * second)) << i;
    }
}

TEST(Directory, ARemovedIoCardIsNotRequested) {
    RobotBench bench;
    bench.delay_to_client = [] { return 1 * ms; };
    bench.ready();
    bench.robot.remove(ROBUROC4_SERVICE_IOCARD);
    ASSERT_TRUE(bench.run_until(
        [&] { return roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_IOCARD) < 0; },
        10 * second));
    bench.robot.requests.clear();
    bench.run(10 * second);
    for (const auto &r : bench.robot.seen(ROBUROC4_ACTION_QUERY, 0))
        EXPECT_LT(r.what.index, 6) << "a question about a channel went to the directory";
    EXPECT_EQ(1, bench.facts().descriptions_done);
    EXPECT_EQ(0, bench.facts().override_known);
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN,
              roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE));
}
