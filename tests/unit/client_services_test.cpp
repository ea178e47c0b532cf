/* SPDX-License-Identifier: MIT
 *
 * Services with other ids, texts and claims; other kinds of robots; robots that exceed the client's
 * capacities.
 */
#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

roburoc4_result id_of(const Bench &bench, std::uint32_t service) {
    return roburoc4_client_service_id(&bench.client, service);
}

/** Send no type code, so that texts or ids decide. */
void forget_types(ScriptedRobot &robot) {
    for (ScriptedService &s : robot.services)
        s.type = static_cast<std::uint16_t>(0x5000 + s.id);
}

void expect_every_service(const Bench &bench, const std::vector<int> &ids) {
    for (std::uint32_t service = 2; service < ROBUROC4_SERVICE_COUNT; service++) {
        EXPECT_EQ(ids[service], id_of(bench, service)) << service;
        EXPECT_GT(bench.service_link(service).received, 0U) << service;
    }
}

} // namespace

TEST(ServiceId, FirstTwoAreFixed) {
    RobotBench bench;
    EXPECT_EQ(0, id_of(bench, 0));
    EXPECT_EQ(1, id_of(bench, 1));
    for (std::uint32_t service = 2; service < 12; service++)
        EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, id_of(bench, service));
}

TEST(ServiceId, OfANumberThatIsNotAServiceIsUnknown) {
    Ready bench;
    for (const std::uint32_t service : {7U, 8U, 31U, 32U, 34U, 38U, UINT32_MAX})
        EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, id_of(bench, service)) << service;
}

TEST(ServiceId, IsIdentifiedByTypeCodeIfKnown) {
    ScriptedRobot robot;
    const std::vector<int> ids{0, 1, 300, 0x1203, 40, 0xFFFF, 9};
    for (ScriptedService &s : robot.services) {
        s.id = static_cast<std::uint16_t>(ids[s.kind]);
        s.text = s.kind == ROBUROC4_SERVICE_BATTERY ? "Battery" : "nonsense";
    }
    Ready bench(robot);
    expect_every_service(bench, ids);
    ASSERT_EQ(ROBUROC4_OK, bench.arm());
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, 0, 200 * ms));
    EXPECT_FLOAT_EQ(0.5F, robot.target_linear);
}

TEST(ServiceId, TypeCodeBeatsTextAndText) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_LOCALIZATION).text = "Differential drive";
    robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).text = "Localization";
    robot.services.push_back({0x7100, 90, 99, "Localization"});
    Ready bench(robot);
    expect_every_service(bench, {0, 1, 2, 3, 4, 5, 6});
}

TEST(ServiceId, TextBeatsTheManualsId) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_BATTERY).id = 40;
    robot.services.push_back({0x7777, ROBUROC4_SERVICE_BATTERY, 99, "nonsense"});
    Ready bench(robot);
    expect_every_service(bench, {0, 1, 2, 3, 40, 5, 6});
}

TEST(ServiceId, IsIdentifiedByTextIfTheTypeIsUnknown) {
    ScriptedRobot robot;
    forget_types(robot);
    const std::vector<int> ids{0, 1, 6, 5, 3, 4, 2}; /* each other's places */
    const std::vector<std::string> texts{
        "Directory", "Notification",        "IO card of the robot", "TELEMETER group",
        "a battery", "LocalizationService", "Differential drive"};
    for (ScriptedService &s : robot.services) {
        s.id = static_cast<std::uint16_t>(ids[s.kind]);
        s.text = texts[s.kind];
    }
    robot.services.insert(robot.services.begin() + 2, {0x7123, 90, 99, "Flattery"});
    Ready bench(robot);
    expect_every_service(bench, ids);
}

TEST(ServiceId, IsTheManualsIfTheRobotRefusesItsTexts) {
    ScriptedRobot robot;
    forget_types(robot);
    robot.texts_refused = true;
    Ready bench(robot);
    expect_every_service(bench, {0, 1, 2, 3, 4, 5, 6});
}

TEST(ServiceId, IsTheManualsOnlyIfTheDirectoryListsIt) {
    ScriptedRobot robot;
    forget_types(robot);
    robot.texts_refused = true;
    robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).id = 60;
    Ready bench(robot);
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, id_of(bench, ROBUROC4_SERVICE_DIFFERENTIAL));
    EXPECT_EQ(ROBUROC4_ERR_NO_DIFFERENTIAL, bench.arm());
    EXPECT_EQ(0U, bench.commands().size());
}

TEST(ServiceId, IsNotTheManualsIfAnotherServiceClaimsTheId) {
    for (const int type : {ROBUROC4_TYPE_LASER, ROBUROC4_TYPE_DIAGNOSTIC, ROBUROC4_TYPE_DRIVE}) {
        ScriptedRobot robot;
        robot.remove(ROBUROC4_SERVICE_DIFFERENTIAL);
        robot.services.push_back({static_cast<std::uint16_t>(type), 6, 99, "Differential"});
        Ready bench(robot);
        EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, id_of(bench, ROBUROC4_SERVICE_DIFFERENTIAL)) << type;
    }
}

TEST(ServiceId, OfTwoClaimantsByTypeIsTheManualsOne) {
    ScriptedRobot robot;
    robot.services.insert(robot.services.begin() + 2,
                          {ROBUROC4_TYPE_DIFFERENTIAL, 90, 99, "Differential"});
    Ready bench(robot);
    EXPECT_EQ(6, id_of(bench, ROBUROC4_SERVICE_DIFFERENTIAL));
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

TEST(ServiceId, OfTwoOtherClaimantsIsTheFirst) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).id = 50;
    robot.services.push_back({ROBUROC4_TYPE_DIFFERENTIAL, 40, 99, "Differential"});
    Ready bench(robot);
    EXPECT_EQ(50, id_of(bench, ROBUROC4_SERVICE_DIFFERENTIAL));
}

TEST(ServiceId, DirectoryAndNotificationAreNeverMistakenForOthers) {
    ScriptedRobot robot;
    robot.services[0].type = ROBUROC4_TYPE_DIFFERENTIAL;
    robot.services[1].text = "Differential";
    robot.remove(ROBUROC4_SERVICE_DIFFERENTIAL);
    Ready bench(robot);
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, id_of(bench, ROBUROC4_SERVICE_DIFFERENTIAL));
    bench.pause();
    bench.run(second);
    EXPECT_EQ(0U, bench.commands().size());
}

TEST(ServiceId, IsCorrectedByALateText) {
    ScriptedRobot robot;
    forget_types(robot);
    robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).id = 60;
    robot.texts_silent = true;
    Started bench(robot);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, 3 * second));
    robot.texts_silent = false;
    ASSERT_TRUE(
        bench.run_until([&] { return id_of(bench, ROBUROC4_SERVICE_DIFFERENTIAL) == 60; }, second));
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, second));
    bench.run(second);
    EXPECT_EQ(ROBUROC4_OK, bench.arm());
}

TEST(Safety, AServiceIsNotGuessedWhileItsTextIsMissing) {
    ScriptedRobot robot;
    forget_types(robot);
    std::swap(robot.service(ROBUROC4_SERVICE_TELEMETER).id,
              robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).id);
    robot.texts_silent = true;
    Started bench(robot);
    for (int i = 0; i < 200; i++) {
        bench.stop();
        bench.run(100 * ms);
    }
    EXPECT_EQ(0U, bench.commands().size());
    robot.texts_silent = false; /* they are requested again */
    EXPECT_TRUE(bench.run_until([&] { return bench.arm() == ROBUROC4_OK; }));
    EXPECT_EQ(ROBUROC4_SERVICE_TELEMETER, id_of(bench, ROBUROC4_SERVICE_DIFFERENTIAL));
}

TEST(ServiceList, ReturnsTheDirectory) {
    Ready bench;
    ASSERT_EQ(7U, service_count(&bench.client));
    roburoc4_directory_entry entry{7, 7};
    for (std::uint32_t i = 0; i < 7; i++) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_service_at(&bench.client, i, &entry));
        EXPECT_EQ(bench.robot.services[i].type, entry.type) << i;
        EXPECT_EQ(bench.robot.services[i].id, entry.id) << i;
    }
    for (const std::uint32_t beyond : {7U, 8U, 32U, UINT32_MAX})
        EXPECT_EQ(ROBUROC4_ERR_INDEX, roburoc4_client_service_at(&bench.client, beyond, &entry));
}

/* ---- robots of another kind ---- */

TEST(OtherRobot, WithNineDifferentialPropertiesIsNeverCommanded) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).get_length = 5 + 9 * 4;
    Ready bench(robot);
    EXPECT_EQ(ROBUROC4_ERR_NO_DIFFERENTIAL, bench.arm());
    EXPECT_LT(bench.drive(1, 0), 0);
    EXPECT_EQ(ROBUROC4_OK, bench.pause());
    bench.run(20 * second);
    EXPECT_EQ(ROBUROC4_OK, bench.close());
    bench.run(2 * second);
    EXPECT_EQ(0U, bench.commands().size());
}

TEST(OtherRobot, WhosePropertiesBecomeShortIsStoppedAtTheSameId) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).id = 66;
    Armed bench(robot);
    robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).get_length = 5 + 9 * 4;
    const std::uint64_t start_us = bench.now_us;
    while (bench.facts().armed == 1 && bench.now_us < start_us + 10 * second) {
        bench.drive(0.5F, 0);
        bench.run(10 * ms);
    }
    ASSERT_EQ(0, bench.facts().armed);
    EXPECT_EQ(ROBUROC4_ERR_NO_DIFFERENTIAL, bench.facts().disarm_cause);
    const std::size_t before = bench.commands().size();
    bench.run(second);
    const auto commands = bench.commands();
    ASSERT_GT(commands.size(), before);
    EXPECT_EQ(0.0F, robot.target_linear) << "it goes on";
    EXPECT_TRUE(commands.back().zero());
    EXPECT_EQ(0, bench.facts().stopping);
}

TEST(OtherRobot, WithoutDifferentialServiceIsMonitored) {
    ScriptedRobot robot;
    robot.remove(ROBUROC4_SERVICE_DIFFERENTIAL);
    Ready bench(robot);
    EXPECT_EQ(ROBUROC4_ERR_NO_DIFFERENTIAL, bench.arm());
    EXPECT_GT(bench.service_link(ROBUROC4_SERVICE_BATTERY).received, 0U);
}

/* ---- more than a client stores ---- */

TEST(Capacity, ARobotThatClaimsTwoBillionInputsCostsNothing) {
    ScriptedRobot robot;
    robot.iocard = {INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX, 0, 0};
    robot.service(ROBUROC4_SERVICE_IOCARD).mute = true;
    Started bench(robot);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, second));
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_CAPACITY);
    roburoc4_iocard_properties properties;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_iocard_properties(&bench.client, &properties));
    EXPECT_EQ(INT32_MAX, properties.analog_inputs);
    ASSERT_TRUE(bench.run_until([&] { return bench.facts().descriptions_done == 1; }, 5 * second));
    EXPECT_EQ(7U + 16U + 4U + 64U + 64U, robot.seen(ROBUROC4_ACTION_QUERY).size());
    EXPECT_EQ(ROBUROC4_ERR_SHORT, bench.receive(from_hex("FF 02 00 FF FF 00 00 00 00 00 00 01")));
    EXPECT_EQ(ROBUROC4_ERR_INDEX, set_digital_output(&bench.client, 3, 1, bench.client_us()));
}

TEST(Capacity, InputsBeyondAreReportedAndNotStored) {
    ScriptedRobot robot;
    robot.iocard = {40, 2, 70, 8, 0, 0};
    robot.analog.assign(40, 1.5F);
    robot.analog[15] = 3.25F;
    robot.digital = UINT64_C(0x8000000000000001);
    robot.instead = [&](const roburoc4_request &r, std::vector<Bytes> &) {
        return r.action == ROBUROC4_ACTION_INSERT && r.subject == ROBUROC4_SERVICE_IOCARD;
    };
    Started bench(robot);
    ASSERT_TRUE(bench.run_until(
        [&] { return !robot.seen(ROBUROC4_ACTION_INSERT, ROBUROC4_SERVICE_IOCARD).empty(); }));
    std::array<std::uint8_t, 9> blocks{1, 0, 0, 0, 0, 0, 0, 0x80, 0x3F};
    const Bytes status = encoded([&](std::uint8_t *b, std::size_t n) {
        return roburoc4_encode_iocard_status(b, n, 2, robot.cycles(), robot.analog.data(), 40,
                                             blocks.data(), 70);
    });
    EXPECT_EQ(0, bench.receive(status));
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_CAPACITY);
    roburoc4_inputs inputs;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_inputs(&bench.client, &inputs, nullptr));
    EXPECT_EQ(16U, inputs.analog_count);
    EXPECT_EQ(64U, inputs.digital_count);
    EXPECT_EQ(3.25F, inputs.analog[15]);
    EXPECT_EQ(UINT64_C(0x8000000000000001), inputs.digital);
}

TEST(Capacity, ServicesBeyondAreReportedAndNotStored) {
    ScriptedRobot robot;
    for (std::uint16_t i = 0; i < 33; i++)
        robot.services.push_back({0x1111, static_cast<std::uint16_t>(100 + i), 99, "spare"});
    Started bench(robot);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, second));
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_CAPACITY);
    EXPECT_EQ(16U, service_count(&bench.client));
    bench.run(20 * second);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), bench.state()) << "and stays so";
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_CAPACITY) << "reported once";
    EXPECT_EQ(16U + 9U + 22U + 8U, robot.seen(ROBUROC4_ACTION_QUERY).size());
}

TEST(Capacity, TelemetersBeyondAreReportedOnceAndNotStored) {
    ScriptedRobot robot;
    robot.telemeters.resize(9, robot.telemeters[1]);
    robot.distances.assign(9, 4.5F);
    robot.distances[ROBUROC4_MAX_TELEMETERS - 1] = 0.5F;
    Started bench(robot);
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY, second));
    bench.run(200 * ms);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_CAPACITY);
    EXPECT_EQ(ROBUROC4_MAX_TELEMETERS, telemeter_count(&bench.client));
    roburoc4_distances distances;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_distances(&bench.client, &distances, nullptr));
    EXPECT_EQ(ROBUROC4_MAX_TELEMETERS, distances.count);
    EXPECT_EQ(0.5F, distances.distances_m[ROBUROC4_MAX_TELEMETERS - 1]);
    bench.run(20 * second); /* they are read again */
    EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_CAPACITY) << "reported once";
    for (const std::uint32_t reserved : bench.client.private_reserved)
        EXPECT_EQ(0U, reserved);
}
