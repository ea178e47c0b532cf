/* SPDX-License-Identifier: MIT
 *
 * Rare situations, and what the client promises even then.
 */
#include <cstring>
#include <tuple>

#include "client_bench.h"

using namespace roburoc4_tests;

TEST(Seldom, ClosingTwiceIsClosing) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    EXPECT_EQ(ROBUROC4_OK, bench.close());
    bench.take_events();
    EXPECT_EQ(ROBUROC4_OK, bench.close());
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_CLOSING), bench.state());
    EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_STATE) << "the state is the same";
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_IDLE));
    EXPECT_EQ(ROBUROC4_ERR_STATE, bench.close());
}

TEST(Seldom, ARobotRestartedDuringCloseIsNotDiscovered) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    ASSERT_EQ(ROBUROC4_OK, bench.close());
    ASSERT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_CLOSING), bench.state());
    for (std::uint64_t i = 0; i < 4; i++)
        EXPECT_EQ(ROBUROC4_ERR_OLD,
                  bench.receive(bench.robot.status_at(ROBUROC4_SERVICE_DIFFERENTIAL, 10 + i)));
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_CLOSING), bench.state());
    EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_REBOOTS));
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_IDLE));
}

TEST(Seldom, AnAnswerThatComesWhileTheClientClosesIsUnmatched) {
    Armed bench;
    bench.robot.instead = [](const roburoc4_request &r, std::vector<Bytes> &) {
        return r.action == ROBUROC4_ACTION_GET;
    };
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 300 * ms));
    const auto asked = bench.robot.seen(ROBUROC4_ACTION_GET).back().what;
    ASSERT_EQ(ROBUROC4_OK, bench.close());
    ASSERT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_CLOSING), bench.state());
    EXPECT_EQ(ROBUROC4_ERR_UNMATCHED,
              bench.receive(plain_answer(asked.id, asked.action, asked.service, 0)));
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_CLOSING), bench.state());
    EXPECT_TRUE(bench.run_until_state(ROBUROC4_STATE_IDLE));
}

TEST(Seldom, APendingStopEndsWithTheClient) {
    ScriptedRobot robot;
    robot.powered = false;
    Started bench(robot);
    ASSERT_EQ(ROBUROC4_OK, bench.pause());
    ASSERT_EQ(1, bench.facts().stopping);
    ASSERT_EQ(ROBUROC4_OK, bench.close());
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_IDLE), bench.state()) << "nothing is due";
    EXPECT_EQ(0, bench.facts().stopping);
    EXPECT_EQ(UINT64_MAX, roburoc4_client_next_deadline(&bench.client));
}

TEST(Seldom, EveryDatagramSentIsCounted) {
    Started bench;
    bench.run(5 * second);
    ASSERT_EQ(ROBUROC4_OK, bench.arm());
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, second));
    ASSERT_EQ(ROBUROC4_OK, set_digital_output(&bench.client, 3, 1, bench.client_us()));
    bench.run(5 * second);
    EXPECT_EQ(bench.sent.size(), bench.count(ROBUROC4_COUNT_SENT));
}

/* The bench checks each deadline itself: nothing is due before it, and no loop spins. */
TEST(Seldom, DeadlinesAreRightWhateverTheRobotDoesNotAnswer) {
    for (std::uint32_t silent = 0; silent < 64; silent++) {
        SCOPED_TRACE(silent);
        ScriptedRobot robot;
        robot.texts_silent = (silent & 1) != 0;
        robot.service(ROBUROC4_SERVICE_TELEMETER).get_silent = (silent & 2) != 0;
        robot.service(ROBUROC4_SERVICE_BATTERY).insert_silent = (silent & 4) != 0;
        robot.replace_silent = (silent & 8) != 0;
        robot.always_manual_id = (silent & 16) != 0;
        robot.service(ROBUROC4_SERVICE_LOCALIZATION).mute = (silent & 32) != 0;
        Bench bench(robot, default_config(), 1000 * second + 3700);
        bench.start();
        bench.now_us += 2100; /* no longer in step with the robot's cycles */
        ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
        bench.run(1234567);
        ASSERT_EQ(ROBUROC4_OK,
                  roburoc4_client_relocalize(&bench.client, 1, 2, 3, bench.client_us()));
        bench.run(10 * second);
        EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_LOST));
    }
}

TEST(Seldom, WaitsASecondForMissingTexts) {
    ScriptedRobot robot;
    robot.texts_silent = true;
    roburoc4_config config = default_config();
    config.first_retry_ms = 100; /* the second ends between the tries after 0.92 s and 1.24 s */
    Started bench(robot, config);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_DISCOVERING));
    const std::uint64_t begun_us = bench.now_us;
    bench.run(950 * ms);
    ASSERT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_DISCOVERING), bench.state());
    EXPECT_EQ(begun_us + second, roburoc4_client_next_deadline(&bench.client));
    bench.run(50 * ms);
    EXPECT_FALSE(robot.seen(ROBUROC4_ACTION_GET, ROBUROC4_SERVICE_DIFFERENTIAL).empty());
}

TEST(Seldom, ABumperThatTheUserChoseHasNoSideEffects) {
    Armed bench;
    EXPECT_EQ(ROBUROC4_OK, roburoc4_client_set_role_index(&bench.client, ROBUROC4_ROLE_FRONT_BUMPER,
                                                          3, bench.client_us()));
    EXPECT_EQ(3, roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_FRONT_BUMPER));
    EXPECT_EQ(1, bench.facts().armed);
    EXPECT_EQ(1, bench.facts().override_known);
    bench.robot.press(3);
    bench.run(100 * ms);
    EXPECT_EQ(1, bench.facts().front_bumper);
}

TEST(Seldom, ADescriptionIsReadOnlyFromItsOwnDatagram) {
    RobotBench bench;
    Bytes text;
    bench.drop_to_client = [&](const Bytes &bytes) {
        if (text.empty() && bytes.size() > 5 && bytes[1] == ROBUROC4_ACTION_QUERY) {
            text = bytes;
            return true; /* it is given below */
        }
        return false;
    };
    bench.start();
    ASSERT_TRUE(bench.run_until([&] { return !text.empty(); }));
    ASSERT_GE(bench.receive(text), 0);
    roburoc4_description description{};
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN,
              roburoc4_client_description(&bench.client, text.data(), 4, &description))
        << "another datagram";
    EXPECT_EQ(ROBUROC4_OK,
              roburoc4_client_description(&bench.client, text.data(), text.size(), &description));
    EXPECT_EQ(text.size() - 5, description.length);
    bench.receive({0x77});
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN,
              roburoc4_client_description(&bench.client, text.data(), text.size(), &description));
}

TEST(Seldom, MoreChannelsThanCanBeStoredAreReportedOnce) {
    for (const roburoc4_iocard_properties &card :
         {roburoc4_iocard_properties{17, 0, 22, 8, 0, 0},
          roburoc4_iocard_properties{9, 5, 22, 8, 0, 0},
          roburoc4_iocard_properties{9, 0, 65, 8, 0, 0},
          roburoc4_iocard_properties{9, 0, 22, 65, 0, 0}}) {
        ScriptedRobot robot;
        robot.iocard = card;
        robot.analog.resize(static_cast<std::size_t>(card.analog_inputs));
        robot.texts_refused = true;
        Started bench(robot);
        ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_CAPACITY);
        bench.run(20 * second); /* it is read again by the probe */
        EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_CAPACITY);
        const bool outputs = card.analog_outputs > 4 || card.digital_outputs > 64;
        EXPECT_EQ(outputs ? ROBUROC4_ERR_INDEX : ROBUROC4_OK,
                  set_digital_output(&bench.client, 1, 1, bench.client_us()))
            << "a command carries all outputs";
    }
    for (const roburoc4_iocard_properties &card : {roburoc4_iocard_properties{16, 4, 64, 64, 0, 0},
                                                   roburoc4_iocard_properties{9, 0, 22, 8, 0, 0}}) {
        ScriptedRobot robot;
        robot.iocard = card;
        robot.analog.resize(static_cast<std::size_t>(card.analog_inputs));
        Started bench(robot);
        ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
        EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_CAPACITY) << "as many as fit";
    }
}

TEST(Seldom, TruncatedPropertiesAreNotKnown) {
    const std::array<std::pair<std::uint32_t, std::size_t>, 5> cuts{
        {{ROBUROC4_SERVICE_IOCARD, 20},
         {ROBUROC4_SERVICE_TELEMETER, 40},
         {ROBUROC4_SERVICE_BATTERY, 13},
         {ROBUROC4_SERVICE_LOCALIZATION, 32},
         {ROBUROC4_SERVICE_DIFFERENTIAL, 56}}};
    for (const auto &[service, length] : cuts) {
        SCOPED_TRACE(service);
        ScriptedRobot robot;
        robot.service(service).get_length = length;
        Started bench(robot);
        ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
        EXPECT_GT(bench.count(ROBUROC4_COUNT_SHORT), 0U);
        roburoc4_battery_properties battery{};
        roburoc4_localization_properties localization{};
        roburoc4_differential_properties differential{};
        roburoc4_iocard_properties iocard{};
        EXPECT_EQ(service == ROBUROC4_SERVICE_BATTERY,
                  roburoc4_client_battery_properties(&bench.client, &battery) < 0);
        EXPECT_EQ(service == ROBUROC4_SERVICE_LOCALIZATION,
                  roburoc4_client_localization_properties(&bench.client, &localization) < 0);
        EXPECT_EQ(service == ROBUROC4_SERVICE_DIFFERENTIAL,
                  roburoc4_client_differential_properties(&bench.client, &differential) < 0);
        EXPECT_EQ(service == ROBUROC4_SERVICE_IOCARD,
                  roburoc4_client_iocard_properties(&bench.client, &iocard) < 0);
        EXPECT_EQ(service == ROBUROC4_SERVICE_TELEMETER ? 0U : 2U, telemeter_count(&bench.client));
        bench.take_events();
        bench.run(20 * second);
        EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_PROPERTIES) << "however often it is read";
    }
}

TEST(Seldom, TruncatedPropertiesKeepTheEarlierOnes) {
    Ready bench;
    std::array<roburoc4_telemeter, 2> before{};
    for (std::uint32_t i = 0; i < 2; i++)
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_telemeter(&bench.client, i, &before[i]));
    bench.robot.service(ROBUROC4_SERVICE_TELEMETER).get_length = 8;
    bench.drop_to_client = [](const Bytes &) {
        /* if nothing was decoded, leftovers on the stack would be read */
        volatile std::uint8_t litter[16384];
        for (volatile std::uint8_t &byte : litter)
            byte = 1;
        return false;
    };
    bench.run(20 * second);
    EXPECT_GT(bench.count(ROBUROC4_COUNT_SHORT), 0U);
    EXPECT_EQ(2U, telemeter_count(&bench.client));
    for (std::uint32_t i = 0; i < 2; i++) {
        roburoc4_telemeter now;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_telemeter(&bench.client, i, &now));
        EXPECT_EQ(0, std::memcmp(&before[i], &now, sizeof now)) << i;
    }
    EXPECT_FALSE(bench.take_events() & (ROBUROC4_EVENT_PROPERTIES | ROBUROC4_EVENT_CAPACITY));
}

TEST(Seldom, AnotherCardHasNoKnownOverrideBeforeItsFirstStatus) {
    ScriptedRobot robot;
    robot.digital = 0x20003;
    Ready bench(robot);
    ASSERT_EQ(1, bench.facts().override_known);
    robot.service(ROBUROC4_SERVICE_IOCARD).mute = true;
    robot.iocard.digital_outputs = 9; /* so that the input of the override has the same index */
    ASSERT_TRUE(bench.run_until(
        [&] { return (bench.take_events() & ROBUROC4_EVENT_PROPERTIES) != 0; }, 20 * second));
    EXPECT_EQ(0, bench.facts().override_known);
    EXPECT_EQ(0, bench.facts().overridden);
    roburoc4_inputs inputs;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_inputs(&bench.client, &inputs, nullptr));
    EXPECT_EQ(0x20003U, inputs.digital) << "the latest status is still that of before";
}

TEST(Seldom, ZerosAreStillSentAfterAnEmptyDirectory) {
    Armed bench;
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    bench.robot.instead = [](const roburoc4_request &r, std::vector<Bytes> &) {
        return r.action == ROBUROC4_ACTION_GET && r.service == ROBUROC4_SERVICE_DIRECTORY;
    };
    for (std::uint64_t i = 0; i < 3; i++) /* it restarts in mid-drive */
        bench.receive(bench.robot.status_at(ROBUROC4_SERVICE_DIFFERENTIAL, 10 + i));
    ASSERT_EQ(1U, bench.count(ROBUROC4_COUNT_REBOOTS));
    bench.sent.clear();
    const std::uint64_t first_us = bench.now_us;
    bench.run(60 * ms);
    ASSERT_EQ(2U, bench.commands().size()) << "two zeros of the stop sequence";

    /* when the third is due, a truncated answer arrives */
    bench.now_us = first_us + 100 * ms;
    const std::uint8_t id = bench.robot.seen(ROBUROC4_ACTION_GET, 0).back().what.id;
    ASSERT_EQ(ROBUROC4_OK, bench.receive(plain_answer(id, ROBUROC4_ACTION_GET, 0, 0)));
    bench.pump();
    EXPECT_EQ(2U, bench.commands().size()) << "a command to a service that is not listed";
    EXPECT_EQ(1, bench.facts().stopping) << "the zeros are still owed";

    bench.robot.instead = nullptr;
    bench.sent.clear();
    ASSERT_TRUE(bench.run_until([&] { return bench.commands().size() >= 3; }));
    EXPECT_EQ(0U, bench.speeds());
}

TEST(Seldom, ReservedFieldsAreZero) {
    ScriptedRobot robot;
    const Bench bench(robot);
    roburoc4_link link;
    std::memset(&link, 0xA5, sizeof link);
    link.size = sizeof link;
    EXPECT_EQ(ROBUROC4_OK, roburoc4_client_link(&bench.client, bench.client_us(), &link));
    EXPECT_EQ(0U, link.reserved);
}

TEST(Seldom, AClockStepBackLeavesNoRequestWaiting) {
    ScriptedRobot robot;
    robot.powered = false;
    Started bench(robot);
    bench.run(5 * second);
    bench.skew_us -= 900000000;
    EXPECT_LT(bench.receive({1}), 0); /* whichever call comes first sees the step */
    EXPECT_LE(roburoc4_client_next_deadline(&bench.client), bench.client_us())
        << "who sleeps until then would sleep for a quarter of an hour";
}

/** A faster status of one service shows that those of the others were later than they seemed. */
TEST(Seldom, AFasterStatusBringsTheEndOfArmingForward) {
    Armed bench;
    const std::size_t before = bench.robot.requests.size();
    ASSERT_TRUE(bench.run_until([&] { return bench.robot.requests.size() > before; }, 2 * second));
    const std::uint64_t deadline_us = roburoc4_client_next_deadline(&bench.client);
    EXPECT_EQ(ROBUROC4_OK, bench.receive(bench.robot.status_at(ROBUROC4_SERVICE_TELEMETER,
                                                               bench.robot.cycles() + 5)));
    EXPECT_LE(roburoc4_client_next_deadline(&bench.client), deadline_us - 49 * ms);
}

TEST(Seldom, AClockStepBackEndsThePauseOfTextsAfterAnError) {
    ScriptedRobot robot;
    robot.error_header = robot.texts_refused = true;
    Started bench(robot);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    const std::size_t before = robot.seen(ROBUROC4_ACTION_QUERY).size();
    bench.skew_us -= 900000000;
    bench.run(5 * second);
    EXPECT_GT(robot.seen(ROBUROC4_ACTION_QUERY).size(), before);
}

TEST(Seldom, AServiceThatIsSilentAfterAClockStepIsSubscribedToAgain) {
    Ready bench;
    bench.robot.subscriptions.clear();
    bench.skew_us -= 900000000;
    bench.run(3 * second);
    EXPECT_EQ(1U, bench.robot.subscriptions.count(6)) << "the differential service";
}

TEST(Seldom, NoPoseWasSetBeforeOneIsSet) {
    ScriptedRobot robot;
    const Bench bench(robot);
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, bench.facts().relocalize_result);
}

TEST(Seldom, AClockThatStepsBackChangesNoCounterButItsOwn) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_BATTERY).get_silent = true; /* retries are counted */
    Ready bench(robot);
    for (const Bytes &bad : {Bytes{}, Bytes{7, 0, 0, 0, 0}, Bytes{0xFF, 9, 0}})
        EXPECT_LT(bench.receive(bad), 0);
    std::array<std::uint32_t, ROBUROC4_COUNTERS> before{};
    for (std::uint32_t i = 0; i < ROBUROC4_COUNTERS; i++)
        before[i] = bench.count(i);
    bench.skew_us -= 900000000;
    EXPECT_EQ(ROBUROC4_OK, bench.stop());
    for (std::uint32_t i = 0; i < ROBUROC4_COUNTERS; i++)
        EXPECT_EQ(before[i] + (i == ROBUROC4_COUNT_CLOCK_FAULTS ? 1 : 0), bench.count(i)) << i;
}

/* Except for the next request's id, which continues, and for events that were not taken yet. */
TEST(Seldom, ARestartedClientIsLikeANewOne) {
    for (const std::int64_t pause_us : {0, 5000000, -900000000}) {
        Armed bench;
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0.5F, 200 * ms));
        ASSERT_EQ(ROBUROC4_OK, set_digital_output(&bench.client, 3, 1, bench.client_us()));
        ASSERT_EQ(ROBUROC4_OK,
                  roburoc4_client_relocalize(&bench.client, 1, 2, 3, bench.client_us()));
        bench.run(10 * ms);
        bench.robot.powered = false;
        ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
        EXPECT_EQ(ROBUROC4_OK, bench.pause());
        EXPECT_EQ(ROBUROC4_OK, bench.close());
        ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_IDLE));
        EXPECT_EQ(0, bench.facts().stopping);
        bench.skew_us += pause_us;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_start(&bench.client, bench.client_us()));
        roburoc4_client first{};
        const roburoc4_config config = default_config();
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_init(&first, sizeof first, &config));
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_start(&first, bench.client_us()));
        first.private_requests.last_id = bench.client.private_requests.last_id;
        first.private_events = bench.client.private_events;
        EXPECT_EQ(0, std::memcmp(&first, &bench.client, sizeof first));
    }
}

TEST(Seldom, SilenceBeforeTheFirstDatagramCountsFromTheStart) {
    ScriptedRobot robot;
    robot.powered = false;
    Started bench(robot);
    EXPECT_EQ(0U, bench.link().silence_us);
    bench.run(3 * second);
    EXPECT_EQ(3 * second, bench.link().silence_us);
}

TEST(Seldom, RepeatsAnOutputAfterTheClockSteppedBack) {
    Ready bench;
    ASSERT_EQ(ROBUROC4_OK, set_digital_output(&bench.client, 3, 1, bench.client_us()));
    bench.pump();
    ASSERT_EQ(1U, bench.robot.output_commands.size());
    bench.skew_us -= 900000000;
    EXPECT_EQ(ROBUROC4_ERR_DISARMED, bench.drive(0, 0)); /* whichever call comes first sees it */
    EXPECT_TRUE(bench.poll()) << "a probe, because ages are unknown";
    bench.pump();
    for (std::size_t i = 2; i <= 3; i++) {
        const std::uint64_t wait_us =
            roburoc4_client_next_deadline(&bench.client) - bench.client_us();
        ASSERT_LT(wait_us, 200 * ms);
        bench.now_us += wait_us - 1;
        EXPECT_FALSE(bench.poll()) << "before the deadline";
        bench.now_us += 1;
        EXPECT_TRUE(bench.poll());
        bench.pump();
        EXPECT_EQ(i, bench.robot.output_commands.size());
    }
}

TEST(Seldom, AClockThatStepsBackEndsNoRelocalization) {
    ScriptedRobot robot;
    robot.replace_silent = true;
    Ready bench(robot);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_relocalize(&bench.client, 1, 2, 3, bench.client_us()));
    bench.run(200 * ms);
    bench.skew_us -= 900000000;
    bench.run(500 * ms);
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, bench.facts().relocalize_result) << "it has its two seconds";
    const std::size_t before = robot.seen(ROBUROC4_ACTION_REPLACE).size();
    bench.run(1500 * ms);
    EXPECT_EQ(ROBUROC4_ERR_TIMEOUT, bench.facts().relocalize_result);
    EXPECT_EQ(before, robot.seen(ROBUROC4_ACTION_REPLACE).size())
        << "how old statuses are was not known, so it may have moved";
}

TEST(Seldom, AClockThatStepsBackDoesNotHurryDiscovery) {
    ScriptedRobot robot;
    for (ScriptedService &s : robot.services)
        s.type = static_cast<std::uint16_t>(0x5000 + s.kind); /* only texts tell */
    std::swap(robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).id,
              robot.service(ROBUROC4_SERVICE_TELEMETER).id);
    robot.texts_silent = true;
    Started bench(robot);
    bench.run(300 * ms);
    bench.skew_us -= 900000000;
    bench.run(300 * ms);
    robot.texts_silent = false;
    ASSERT_TRUE(bench.run_until([&] {
        EXPECT_NE(6, roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_DIFFERENTIAL))
            << "the manual's, before a second is over";
        return bench.state() == ROBUROC4_STATE_READY;
    }));
    EXPECT_EQ(3, roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_DIFFERENTIAL));
}

TEST(Seldom, AStatusFromBeforeAClockStepIsNeverRecentAgain) {
    for (const bool card : {false, true}) {
        SCOPED_TRACE(card);
        ScriptedRobot robot;
        Armed bench(robot);
        robot.service(card ? ROBUROC4_SERVICE_IOCARD : ROBUROC4_SERVICE_DIFFERENTIAL).mute = true;
        bench.skew_us -= 2000000;
        bench.run(100 * ms);
        for (int i = 0; i < 400; i++) { /* past the time at which it was received */
            ASSERT_EQ(card ? ROBUROC4_ERR_STALE_IOCARD : ROBUROC4_ERR_STALE_DIFFERENTIAL,
                      bench.arm())
                << i;
            bench.run(10 * ms);
        }
    }
}

/* Inside the client, times have 32 bits. */
TEST(Seldom, TheClockMayPassAnyMultipleOf32Bits) {
    for (const std::uint64_t wrap_us : {1ULL << 31, 1ULL << 32, 7ULL << 32}) {
        for (const std::uint64_t before_us : {300 * ms, 2 * second, 4 * second}) {
            SCOPED_TRACE(wrap_us);
            SCOPED_TRACE(before_us);
            ScriptedRobot robot;
            Bench bench(robot, default_config(), wrap_us - before_us);
            ASSERT_NO_FATAL_FAILURE(bench.armed());
            ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0.5F, 4 * second));
            bench.run(3 * second);
            EXPECT_EQ(1U, bench.facts().lapsed);
            EXPECT_EQ(ROBUROC4_STOP_CONFIRMED, bench.facts().stop_outcome);
            EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_LOST));
            EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_REBOOTS));
            EXPECT_EQ(0U, bench.count(ROBUROC4_COUNT_CLOCK_FAULTS));
        }
    }
}

TEST(Seldom, APauseOfAnyLengthEndsDriving) {
    for (const std::uint64_t pause_us : {1ULL << 30, 1ULL << 31, 3ULL << 30, 1ULL << 32,
                                         (1ULL << 32) + 20 * ms, 5ULL << 32, 1ULL << 40}) {
        SCOPED_TRACE(pause_us);
        Armed bench;
        ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 100 * ms));
        bench.robot.powered = false;
        bench.now_us += pause_us;
        EXPECT_EQ(0, bench.facts().driving);
        EXPECT_EQ(1, bench.facts().lapsed);
        const std::size_t speeds = bench.speeds();
        EXPECT_LT(bench.drive(0.5F, 0), 0);
        while (bench.poll()) {
        }
        EXPECT_EQ(speeds, bench.speeds());
        EXPECT_EQ(0, bench.facts().armed);
        EXPECT_EQ(1U, bench.count(ROBUROC4_COUNT_LOST));
    }
}

/* The robot's reports stay known; only [A] must be reported as released again after a loss. */
TEST(Seldom, NeitherAClockThatStepsBackNorALossChangesAValue) {
    for (const bool loss : {false, true}) {
        SCOPED_TRACE(loss);
        ScriptedRobot robot;
        robot.digital = 0x20003;
        robot.pose = {1.5, -2.5, 3.125};
        Ready bench(robot);
        roburoc4_private_values before = bench.client.private_values;
        robot.powered = false;
        if (loss) {
            ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
            EXPECT_EQ(0, bench.facts().override_known);
        } else {
            bench.skew_us -= 900000000;
            EXPECT_EQ(ROBUROC4_OK, bench.stop());
            ASSERT_EQ(1U, bench.count(ROBUROC4_COUNT_CLOCK_FAULTS));
        }
        EXPECT_EQ(0, std::memcmp(&before, &bench.client.private_values, sizeof before));
    }
}

TEST(Seldom, AnEmptyDatagramIsShortWhateverStandsWhereItWouldBegin) {
    RobotBench bench;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_start(&bench.client, bench.client_us()));
    ASSERT_TRUE(bench.poll()); /* a question is open, which an error telegram would end */
    roburoc4_client before = bench.client;
    for (unsigned first = 0; first < 256; first++) {
        const auto byte = static_cast<std::uint8_t>(first);
        EXPECT_EQ(ROBUROC4_ERR_SHORT,
                  roburoc4_client_receive(&bench.client, &byte, 0, bench.client_us()));
        before.private_counters[ROBUROC4_COUNT_RECEIVED]++;
        before.private_counters[ROBUROC4_COUNT_SHORT]++;
        EXPECT_EQ(0, std::memcmp(&before, &bench.client, sizeof before)) << first;
    }
}

TEST(Seldom, EveryDroppedDatagramIsCountedOnceByItsCause) {
    ScriptedRobot robot;
    roburoc4_config config = default_config();
    config.subscriptions &= ~(1U << ROBUROC4_SERVICE_BATTERY);
    Ready bench(robot, config);
    const auto counts = [&] {
        std::array<std::uint32_t, ROBUROC4_COUNTERS> all{};
        for (std::uint32_t i = 0; i < ROBUROC4_COUNTERS; i++)
            all[i] = bench.count(i);
        return all;
    };
    const Bytes status = robot.status_at(ROBUROC4_SERVICE_DIFFERENTIAL, robot.cycles() + 1);
    Bytes longer = status;
    longer.push_back(0);
    struct Case {
        Bytes datagram;
        roburoc4_result result;
        std::uint32_t counter;
    };
    for (const Case &c :
         {Case{{}, ROBUROC4_ERR_SHORT, ROBUROC4_COUNT_SHORT},
          Case{{9, 0, 0, 0}, ROBUROC4_ERR_SHORT, ROBUROC4_COUNT_SHORT},
          Case{Bytes(status.begin(), status.end() - 1), ROBUROC4_ERR_SHORT, ROBUROC4_COUNT_SHORT},
          Case{{9, 0, 0, 0, 0}, ROBUROC4_ERR_UNMATCHED, ROBUROC4_COUNT_UNMATCHED},
          Case{{0}, ROBUROC4_ERR_UNMATCHED, ROBUROC4_COUNT_UNMATCHED},
          Case{robot.status(ROBUROC4_SERVICE_BATTERY), ROBUROC4_ERR_UNEXPECTED_STATUS,
               ROBUROC4_COUNT_UNEXPECTED_STATUS},
          Case{longer, 1, ROBUROC4_COUNT_SURPLUS},
          Case{status, ROBUROC4_ERR_OLD, ROBUROC4_COUNT_OLD}}) {
        SCOPED_TRACE(to_hex(c.datagram));
        auto wanted = counts();
        wanted[ROBUROC4_COUNT_RECEIVED]++;
        wanted[c.counter]++;
        EXPECT_EQ(c.result, bench.receive(c.datagram));
        EXPECT_EQ(wanted, counts());
    }
    /* an answer with an impossible value, to the probe */
    bool told = false;
    robot.instead = [&](const roburoc4_request &r, std::vector<Bytes> &) {
        if (r.action != ROBUROC4_ACTION_GET || r.service != ROBUROC4_SERVICE_IOCARD || told)
            return false;
        roburoc4_iocard_properties properties = robot.iocard;
        properties.service = ROBUROC4_SERVICE_IOCARD;
        Bytes answer = encoded([&](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_iocard_properties(b, n, r.id, &properties);
        });
        answer[8] = 0x80; /* the count of analog inputs is below 0 */
        auto wanted = counts();
        wanted[ROBUROC4_COUNT_RECEIVED]++;
        wanted[ROBUROC4_COUNT_MALFORMED]++;
        EXPECT_EQ(ROBUROC4_ERR_VALUE, bench.receive(answer));
        EXPECT_EQ(wanted, counts());
        told = true;
        return true;
    };
    ASSERT_TRUE(bench.run_until([&] { return told; }));
    roburoc4_iocard_properties properties{};
    EXPECT_EQ(ROBUROC4_OK, roburoc4_client_iocard_properties(&bench.client, &properties));
    EXPECT_EQ(9, properties.analog_inputs) << "as it was before";
}

TEST(Seldom, AnotherCardHasOtherTextsAndTheSameServices) {
    ScriptedRobot robot;
    robot.iocard.analog_outputs = 2;
    bool tells = true;
    robot.channel_text = [&](std::uint32_t io_type, std::uint32_t index) -> std::string {
        const std::array<const char *, 3> words{"Game pad A button", "Front bumper", "Rear bumper"};
        if (tells && io_type == ROBUROC4_IO_DIGITAL_INPUT && index >= 10 && index < 13)
            return words[index - 10];
        return tells && io_type == ROBUROC4_IO_ANALOG_INPUT && index == 7 ? "Battery voltage" : "";
    };
    Ready bench(robot);
    const auto roles = [&] {
        std::array<roburoc4_result, ROBUROC4_ROLE_COUNT> all{};
        for (std::uint32_t role = 0; role < ROBUROC4_ROLE_COUNT; role++)
            all[role] = roburoc4_client_role_index(&bench.client, role);
        return all;
    };
    EXPECT_EQ((std::array<roburoc4_result, 4>{10, 11, 12, 7}), roles());
    tells = false;
    robot.iocard.digital_outputs++;
    robot.requests.clear();
    ASSERT_TRUE(
        bench.run_until([&] { return !robot.seen(ROBUROC4_ACTION_QUERY).empty(); }, 20 * second));
    ASSERT_TRUE(bench.run_until([&] { return bench.facts().descriptions_done == 1; }));
    std::set<std::tuple<int, int, int>> asked;
    for (const auto &r : robot.seen(ROBUROC4_ACTION_QUERY))
        asked.emplace(r.what.service, r.what.io_type, r.what.index);
    EXPECT_EQ(9U + 2U + 22U + 9U, asked.size());
    EXPECT_EQ(ROBUROC4_SERVICE_IOCARD, std::get<0>(*asked.begin())) << "and none of the directory";
    EXPECT_EQ((std::array<roburoc4_result, 4>{ROBUROC4_ERR_NOT_KNOWN, 0, 1, 2}), roles());
}
