/* SPDX-License-Identifier: MIT
 *
 * A different directory while the client runs: earlier requests and knowledge do not count for the
 * services that are listed now.
 */
#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

/** Differential and telemeter swap places, as after a reconfiguration by somebody else. */
void swap_ids(ScriptedRobot &robot) {
    std::swap(robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).id,
              robot.service(ROBUROC4_SERVICE_TELEMETER).id);
}

TEST(Rediscovery, AcceptsNoPropertiesOfAnotherService) {
    std::vector<Bytes> kept;
    Armed bench;
    /* the answer of the old id 6 is held back until the new directory is known */
    bool hold = false;
    bench.robot.instead = [&](const roburoc4_request &request, std::vector<Bytes> &answers) {
        if (hold && request.action == ROBUROC4_ACTION_GET && request.service == 6) {
            roburoc4_differential_properties wrong = bench.robot.differential;
            wrong.service = 6;
            kept.push_back(encoded([&](std::uint8_t *b, std::size_t n) {
                return roburoc4_encode_differential_properties(b, n, request.id, &wrong);
            }));
            return true;
        }
        (void)answers;
        return false;
    };
    hold = true;
    for (int i = 0; i < 1000 && kept.empty(); i++)
        bench.run(10 * ms);
    ASSERT_FALSE(kept.empty()) << "the probe never asked the differential service";
    hold = false;
    swap_ids(bench.robot);
    const std::size_t held = kept.size();
    for (int i = 0; i < 1500; i++) {
        for (std::size_t k = 0; k < held; k++)
            bench.receive(kept[k]);
        bench.run(10 * ms);
        if (bench.facts().state == ROBUROC4_STATE_READY &&
            roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_DIFFERENTIAL) == 3)
            break;
    }
    ASSERT_EQ(3, roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_DIFFERENTIAL));
    bench.run(2 * second);
    bench.sent.clear();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_arm(&bench.client, bench.client_us()));
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.25F, 0, 200000));
    bench.run(100 * ms);
    int commands = 0;
    for (const Bench::Datagram &datagram : bench.sent)
        if (datagram.bytes.size() == 11 && datagram.bytes[0] == ROBUROC4_HEADER_STATUS) {
            EXPECT_EQ(3, datagram.bytes[1] | datagram.bytes[2] << 8);
            commands++;
        }
    EXPECT_GT(commands, 0);
}

TEST(Rediscovery, AcceptsNoAnswerToAnEarlierRequest) {
    Ready bench;
    bench.robot.instead = [](const roburoc4_request &r, std::vector<Bytes> &) {
        return (r.action == ROBUROC4_ACTION_GET && r.service == 6) ||
               r.action == ROBUROC4_ACTION_QUERY;
    };
    const auto asked = [&] { return bench.robot.seen(ROBUROC4_ACTION_GET, 6); };
    const std::size_t before = asked().size();
    ASSERT_TRUE(bench.run_until([&] { return asked().size() > before; })) << "by the probe";
    swap_ids(bench.robot); /* which the next probe finds */
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_DISCOVERING, 1200 * ms));
    roburoc4_differential_properties wrong = bench.robot.differential;
    wrong.service = 6;
    const Bytes late = encoded([&](std::uint8_t *b, std::size_t n) {
        return roburoc4_encode_differential_properties(b, n, asked().back().what.id, &wrong);
    });
    EXPECT_EQ(ROBUROC4_ERR_UNMATCHED, bench.receive(late)) << "6 are the telemeters now";
}

TEST(Rediscovery, DisarmsAndDoesNotArmOnEarlierStatuses) {
    roburoc4_config config = default_config();
    Armed bench(config);
    swap_ids(bench.robot);
    bench.robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).mute = true;
    for (int i = 0; i < 1500 && bench.facts().armed != 0; i++)
        bench.run(10 * ms);
    ASSERT_EQ(0, bench.facts().armed);
    for (int i = 0; i < 300; i++) {
        bench.run(10 * ms);
        EXPECT_LT(roburoc4_client_arm(&bench.client, bench.client_us()), 0);
        EXPECT_LT(bench.drive(0, 0, 200000), 0) << "it armed by itself";
    }
}

TEST(Rediscovery, OutputsFromBeforeARebootStayOff) {
    Armed bench;
    ASSERT_EQ(ROBUROC4_OK, set_digital_output(&bench.client, 3, 1, bench.client_us()));
    bench.run(500 * ms);
    for (std::uint64_t i = 0; i < 3; i++)
        bench.receive(bench.robot.status_at(6, i));
    bench.robot.reboot();
    bench.run(5 * second);
    ASSERT_EQ(ROBUROC4_STATE_READY, bench.facts().state);
    bench.robot.output_commands.clear();
    ASSERT_EQ(ROBUROC4_OK, set_digital_output(&bench.client, 1, 1, bench.client_us()));
    bench.run(500 * ms);
    ASSERT_FALSE(bench.robot.output_commands.empty());
    for (const auto &command : bench.robot.output_commands)
        EXPECT_EQ(0x02, command.second.back());
}

TEST(Rediscovery, OfTheSameRobotAfterALossRequestsNoTextAgain) {
    ScriptedRobot robot;
    robot.channel_text = [](std::uint32_t io_type, std::uint32_t index) -> std::string {
        return io_type == ROBUROC4_IO_DIGITAL_INPUT && index == 3 ? "Game pad A button" : "?";
    };
    Ready bench(robot);
    ASSERT_EQ(3, roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE));
    robot.powered = false;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    robot.powered = true;
    robot.requests.clear();
    ASSERT_TRUE(bench.run_until([&] {
        EXPECT_EQ(3, roburoc4_client_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE));
        return bench.state() == ROBUROC4_STATE_READY;
    }));
    EXPECT_EQ(1, bench.facts().descriptions_done);
    bench.run(second);
    EXPECT_EQ(0U, robot.seen(ROBUROC4_ACTION_QUERY).size());
}

TEST(Rediscovery, AStopIsNotForgottenWhenTheServiceGetsAnotherId) {
    Armed bench;
    swap_ids(bench.robot);
    bench.robot.texts_silent = true; /* discovering takes its time */
    for (int i = 0; i < 15000 && bench.facts().state == ROBUROC4_STATE_READY; i++)
        bench.run(1 * ms);
    ASSERT_NE(ROBUROC4_STATE_READY, bench.facts().state);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_stop(&bench.client, bench.client_us()));
    bench.sent.clear();
    bench.run(3 * second);
    ASSERT_EQ(3, roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_DIFFERENTIAL));
    int zeros = 0;
    for (const Bench::Datagram &datagram : bench.sent)
        zeros += datagram.bytes == from_hex("ff 03 00 00 00 00 00 00 00 00 00") ? 1 : 0;
    EXPECT_GE(zeros, 3);
}

TEST(Rediscovery, AStopIsNotForgottenWhilePropertiesAreRefused) {
    ScriptedRobot robot;
    ScriptedService &differential = robot.service(ROBUROC4_SERVICE_DIFFERENTIAL);
    Ready bench(robot);
    robot.powered = false;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    robot.powered = differential.get_refused = true;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    ASSERT_EQ(ROBUROC4_OK, bench.stop());
    bench.run(3 * second);
    EXPECT_TRUE(bench.commands().empty());
    differential.get_refused = false;
    differential.id = 60;
    EXPECT_TRUE(bench.run_until([&] { return bench.commands().size() >= 3; }));
}

TEST(Rediscovery, ZerosWaitForNoPropertiesWhereverItIsListed) {
    ScriptedRobot robot;
    std::reverse(robot.services.begin(), robot.services.end());
    Armed bench(robot);
    robot.service(ROBUROC4_SERVICE_BATTERY).id = 44;
    robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).get_silent = true;
    EXPECT_EQ(ROBUROC4_ERR_NO_DIFFERENTIAL, bench.drive_until_refused(0.5F, 0, 10 * second));
    ASSERT_FALSE(bench.commands().empty());
    EXPECT_TRUE(bench.commands().back().zero());
}

/* If no type code is known, the directory alone does not show that the old id is another
 * service. */
TEST(Rediscovery, AStopGoesToNoServiceThatIsKnownToBeAnother) {
    for (const std::uint16_t before : {std::uint16_t{6}, std::uint16_t{3}}) {
        SCOPED_TRACE(before);
        const std::uint16_t after = before == 6 ? 3 : 6;
        ScriptedRobot robot;
        for (ScriptedService &s : robot.services)
            s.type = static_cast<std::uint16_t>(0x5000 + s.kind);
        if (before != 6)
            swap_ids(robot);
        Ready bench(robot);
        ASSERT_EQ(before, roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_DIFFERENTIAL));
        swap_ids(robot);
        robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).get_silent = true;
        ASSERT_TRUE(bench.run_until([&] {
            return roburoc4_client_service_id(&bench.client, ROBUROC4_SERVICE_DIFFERENTIAL) ==
                   after;
        }));
        ASSERT_EQ(ROBUROC4_OK, bench.pause());
        bench.sent.clear();
        bench.run(200 * ms);
        EXPECT_TRUE(bench.commands().empty()) << "to the telemeters";
        robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).get_silent = false;
        ASSERT_TRUE(bench.run_until([&] { return bench.commands().size() >= 3; }));
        EXPECT_EQ(0U, bench.speeds());
    }
}

/* Its limits are those of before: another program may run there now. */
TEST(Rediscovery, AServiceWithoutPropertiesIsNoLongerDriven) {
    const std::array<std::function<void(ScriptedService &)>, 3> ways{
        [](ScriptedService &s) { s.get_silent = true; },
        [](ScriptedService &s) { s.get_refused = true; },
        [](ScriptedService &s) { s.get_length = 40; }};
    for (std::size_t i = 0; i < ways.size(); i++) {
        SCOPED_TRACE(i);
        Armed bench;
        bench.robot.powered = false;
        ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
        bench.robot.powered = true;
        ways[i](bench.robot.service(ROBUROC4_SERVICE_DIFFERENTIAL));
        ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
        bench.run(500 * ms);
        EXPECT_EQ(ROBUROC4_ERR_NO_DIFFERENTIAL, bench.arm());
        EXPECT_LT(bench.drive(0.25F, 0), 0);
        bench.robot.service(ROBUROC4_SERVICE_DIFFERENTIAL) = usual_services().back();
        bench.run(8 * second); /* the probe asks again */
        EXPECT_EQ(ROBUROC4_OK, bench.arm());
    }
}

TEST(Rediscovery, PropertiesThatWereRefusedAreRequestedAgain) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_BATTERY).get_refused = true;
    Ready bench(robot);
    robot.powered = false;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    robot.service(ROBUROC4_SERVICE_BATTERY).get_refused = false;
    robot.powered = true;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    roburoc4_battery_properties battery;
    EXPECT_EQ(ROBUROC4_OK, roburoc4_client_battery_properties(&bench.client, &battery));
}

TEST(Rediscovery, ARobotWithTheManualIdIsFoundHoweverLate) {
    ScriptedRobot robot;
    robot.only_manual_id = true;
    robot.powered = false;
    Started bench(robot);
    bench.run(1000 * second);
    robot.powered = true;
    bench.run(20 * second);
    EXPECT_EQ(ROBUROC4_STATE_READY, bench.facts().state);
    EXPECT_EQ(1, bench.facts().fixed_id);
}

} // namespace
