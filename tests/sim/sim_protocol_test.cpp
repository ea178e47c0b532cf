/* SPDX-License-Identifier: MIT
 *
 * sim_protocol_test.cpp - the simulated robot on the wire: answers to every request, subscriptions
 * and statuses, commands, errors, many peers, and arbitrary datagrams.
 */
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "sim_support.h"
#include "telegrams.h"
#include "vectors.h"

using namespace roburoc4_tests;

namespace {

Bytes get(std::uint8_t service, std::uint8_t id = 0x21) {
    return {id, ROBUROC4_ACTION_GET, service, 0x00};
}

std::string text_of(const Bytes &answer) {
    roburoc4_text text{};
    if (roburoc4_decode_text(answer.data(), answer.size(), &text) < 0)
        return "no text";
    return {reinterpret_cast<const char *>(text.text), text.length};
}

std::string directory_text(SimRobot &robot, std::uint8_t index) {
    return text_of(robot.ask({0x22, ROBUROC4_ACTION_QUERY, 0x00, 0x00, index, 0x00}));
}

std::string channel_text(SimRobot &robot, std::uint8_t type, std::uint8_t index) {
    return text_of(
        robot.ask({0x23, ROBUROC4_ACTION_QUERY, 0x02, 0x00, type, index, 0x00, 0x00, 0x00}));
}

Bytes replace_localization(double x, double y, double theta) {
    Bytes bytes(36);
    roburoc4_request request =
        request_of(0x24, ROBUROC4_ACTION_REPLACE, ROBUROC4_SERVICE_LOCALIZATION);
    request.timestamp = 1;
    request.x_m = x;
    request.y_m = y;
    request.theta_rad = theta;
    EXPECT_EQ(36, roburoc4_encode_request(bytes.data(), bytes.size(), &request));
    return bytes;
}

template <class Status, class Decode> Status decode(const Bytes &bytes, Decode decoder) {
    Status status{};
    EXPECT_EQ(0, decoder(bytes.data(), bytes.size(), &status));
    return status;
}

} // namespace

/* ---------------------------------------------------------------------------------- errors --- */

struct Refused {
    const char *why;
    const char *request;
    std::uint8_t error;
};

class SimRefuses : public testing::TestWithParam<Refused> {};

TEST_P(SimRefuses, WithTheRightErrorAndHead) {
    SimRobot robot;
    const Bytes request = from_hex(GetParam().request);
    const Bytes answer = robot.ask(request);
    Bytes expected = request;
    expected.resize(4);
    if (request.size() < 4) /* what is missing of the head is 0 */
        expected[2] = expected[3] = 0;
    expected.push_back(GetParam().error);
    EXPECT_EQ(expected, answer) << GetParam().why;
    EXPECT_EQ(1U, robot.state().errors);
}

INSTANTIATE_TEST_SUITE_P(
    All, SimRefuses,
    testing::Values(
        Refused{"unknown service", "05 00 63 00", ROBUROC4_ERROR_TARGET},
        Refused{"unknown action", "05 07 00 00", ROBUROC4_ERROR_ACTION},
        Refused{"UPDATE of localization", "05 03 05 00", ROBUROC4_ERROR_UNSUPPORTED},
        Refused{"INSERT to the directory", "05 04 00 00 02 00 05", ROBUROC4_ERROR_UNSUPPORTED},
        Refused{"one byte", "05", ROBUROC4_ERROR_LENGTH},
        Refused{"short QUERY of the directory", "05 01 00 00 00", ROBUROC4_ERROR_LENGTH},
        Refused{"short INSERT", "05 04 01 00 02 00", ROBUROC4_ERROR_LENGTH},
        Refused{"short REPLACE", "05 02 05 00 01 02 03", ROBUROC4_ERROR_LENGTH},
        Refused{"QUERY behind the last service", "05 01 00 00 07 00", ROBUROC4_ERROR_DATA},
        Refused{"QUERY behind the last channel", "05 01 02 00 02 16 00 00 00", ROBUROC4_ERROR_DATA},
        Refused{"QUERY of an unknown type", "05 01 02 00 04 00 00 00 00", ROBUROC4_ERROR_DATA},
        Refused{"INSERT of the directory (4.2.4.2)", "05 04 01 00 00 00 05", ROBUROC4_ERROR_DATA},
        Refused{"INSERT with period 0", "05 04 01 00 06 00 00", ROBUROC4_ERROR_DATA},
        Refused{"DELETE of what is not subscribed", "05 05 01 00 06 00", ROBUROC4_ERROR_DATA}));

TEST(SimErrors, AreThoseOfTheVectors) {
    SimRobot robot;
    EXPECT_EQ(vector_bytes("error-answer"), robot.ask(from_hex("32 04 01 00 00 00 05")));
    roburoc4_sim_config config = default_sim_config();
    config.error_header = 1;
    SimRobot with_telegrams(config);
    EXPECT_EQ(vector_bytes("error-telegram"), with_telegrams.ask(from_hex("32 00 09 00")));
}

TEST(SimErrors, ReplaceWithoutFiniteNumbersChangesNothing) {
    SimRobot robot;
    const Bytes answer =
        robot.ask(replace_localization(1.0, std::numeric_limits<double>::quiet_NaN(), 0.0));
    EXPECT_EQ(from_hex("24 02 05 00 05"), answer);
    EXPECT_DOUBLE_EQ(0.0, robot.state().odometry_x_m);
}

TEST(SimErrors, InvalidRequestsGetNoAnswer) {
    SimRobot robot;
    EXPECT_TRUE(robot.ask({}).empty());
    EXPECT_TRUE(robot.ask(from_hex("00 00 02 00")).empty());
    EXPECT_TRUE(robot.ask(from_hex("FF")).empty());
    EXPECT_TRUE(robot.ask(from_hex("FF 06 00 00 00")).empty());
    EXPECT_EQ(4U, robot.state().ignored);
    EXPECT_EQ(0U, robot.state().requests);
}

/* --------------------------------------------------------------------------- subscriptions --- */

TEST(SimSubscriptions, BelongToThePeerThatAsked) {
    SimRobot robot;
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_BATTERY, 2, 10));
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_BATTERY, 4, 20));
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_TELEMETER, 255, 20));
    EXPECT_EQ(from_hex("21 00 01 00 00  04 00 02"), robot.ask(get(1), 10));
    EXPECT_EQ(from_hex("21 00 01 00 00  03 00 FF 04 00 04"), robot.ask(get(1), 20));
    EXPECT_EQ(from_hex("21 00 01 00 00"), robot.ask(get(1), 30));
    EXPECT_EQ(2U, robot.state().peers);
    EXPECT_EQ(3U, robot.state().subscriptions);
    robot.take();
    robot.run(4);
    std::size_t to_ten = 0;
    for (const auto &status : robot.take())
        to_ten += status.peer == 10 ? 1 : 0;
    EXPECT_EQ(2U, to_ten);
}

TEST(SimSubscriptions, ChangePeriodByInsertAndEndByDelete) {
    SimRobot robot;
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_DIFFERENTIAL, 5));
    robot.run(3);
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_DIFFERENTIAL, 5));
    robot.run(2);
    EXPECT_EQ(1U, robot.take().size()) << "the same wish again must not shift the beat";
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_DIFFERENTIAL, 1));
    EXPECT_EQ(1U, robot.subscription(ROBUROC4_SERVICE_DIFFERENTIAL));
    robot.run(5);
    EXPECT_EQ(5U, robot.take().size());
    EXPECT_EQ(from_hex("09 05 01 00 00"), robot.ask(from_hex("09 05 01 00 06 00")));
    robot.run(20);
    EXPECT_TRUE(robot.take().empty());
    EXPECT_EQ(0U, robot.state().subscriptions);
}

TEST(SimSubscriptions, EndWhenThePeerIsSilentAndUnreachable) {
    SimRobot robot;
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_BATTERY, 10));
    robot.run(400);
    roburoc4_sim_receive(robot.get(), 1, nullptr, 0);
    robot.run(150);
    roburoc4_sim_receive(robot.get(), 1, nullptr, 0);
    EXPECT_EQ(1U, robot.state().subscriptions) << "reports only 1.5 s apart";
    robot.run(50);
    roburoc4_sim_receive(robot.get(), 1, nullptr, 0);
    EXPECT_EQ(0U, robot.state().subscriptions);
}

TEST(SimPeers, ATableOfActiveSubscribersRefusesMoreButStillAnswers) {
    SimRobot robot;
    for (std::uint64_t peer = 1; peer <= ROBUROC4_SIM_MAX_PEERS; peer++) {
        robot.ask(get(0), peer);
        EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_BATTERY, 255, peer));
    }
    EXPECT_EQ(ROBUROC4_ERROR_SERVICE, robot.insert(ROBUROC4_SERVICE_BATTERY, 5, 500));
    EXPECT_EQ(33U, robot.ask(get(0), 500).size());
    robot.run(6100);
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_BATTERY, 5, 500)) << "after a minute of silence";
    EXPECT_EQ(0U, robot.subscription(ROBUROC4_SERVICE_BATTERY)) << "the longest silent made room";
    EXPECT_EQ(unsigned(ROBUROC4_SIM_MAX_PEERS), robot.state().peers);
}

/* -------------------------------------------------------------------------------- commands --- */

TEST(SimCommands, OfTheIoCardSetAllOutputsButTheRobotsOwn) {
    roburoc4_sim_config config = default_sim_config();
    config.analog_outputs = 2;
    SimRobot robot(config);
    /* AO 1.5 and -2, DO 0, 3 and 7 */
    EXPECT_TRUE(robot.ask(from_hex("FF 02 00  00 00 C0 3F  00 00 00 C0  89")).empty());
    EXPECT_EQ(1.5, robot.value(ROBUROC4_SIM_ANALOG_OUTPUT));
    EXPECT_EQ(-2.0, robot.value(ROBUROC4_SIM_ANALOG_OUTPUT + 1));
    EXPECT_EQ(ROBUROC4_ERR_INDEX, robot.value(ROBUROC4_SIM_ANALOG_OUTPUT + 2));
    EXPECT_EQ(0, robot.value(ROBUROC4_SIM_DIGITAL_OUTPUT)) << "no speed command feeds it";
    EXPECT_EQ(1, robot.value(ROBUROC4_SIM_DIGITAL_OUTPUT + 3));
    EXPECT_EQ(0, robot.value(ROBUROC4_SIM_DIGITAL_OUTPUT + 4));
    EXPECT_EQ(1, robot.value(ROBUROC4_SIM_DIGITAL_OUTPUT + 7));
    EXPECT_EQ(ROBUROC4_ERR_INDEX, robot.value(ROBUROC4_SIM_DIGITAL_OUTPUT + 8));
    robot.command(0.0F, 0.0F);
    EXPECT_EQ(1, robot.value(ROBUROC4_SIM_DIGITAL_OUTPUT));
    EXPECT_EQ(1U, robot.state().io_commands);
    EXPECT_TRUE(robot.ask(from_hex("FF 02 00  00 00 C0 3F  00 00 00 C0")).empty());
    EXPECT_EQ(1U, robot.state().io_commands) << "too short";
}

/* ----------------------------------------------------------------------------------- inputs --- */

TEST(SimInputs, ShowPadBumpersAndVoltages) {
    SimRobot robot;
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_IOCARD, 1));
    EXPECT_EQ(ROBUROC4_OK,
              roburoc4_sim_set(robot.get(), ROBUROC4_SIM_PAD_BUTTON + ROBUROC4_DI_PAD_RB, 1));
    EXPECT_EQ(ROBUROC4_OK,
              roburoc4_sim_set(robot.get(), ROBUROC4_SIM_PAD_AXIS + ROBUROC4_AI_PAD_RJ_Y, 0.75F));
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(robot.get(), ROBUROC4_SIM_REAR_BUMPER, 1));
    robot.run(1);
    const auto statuses = robot.take();
    ASSERT_EQ(1U, statuses.size());
    roburoc4_channels status{};
    ASSERT_EQ(0, roburoc4_decode_iocard_status(statuses[0].bytes.data(), statuses[0].bytes.size(),
                                               9, 22, &status));
    for (std::uint32_t index = 0; index < 22; index++) {
        const bool expected = index == ROBUROC4_DI_PAD_RB || index == ROBUROC4_DI_REAR_BUMPER;
        EXPECT_EQ(expected ? 1 : 0, digital_at(&status, index)) << index;
    }
    float analog[9];
    ASSERT_EQ(9U, roburoc4_floats(status.analog, status.analog_count, analog, 9));
    const auto state = robot.state();
    EXPECT_FLOAT_EQ(0.75F, analog[ROBUROC4_AI_PAD_RJ_Y]);
    EXPECT_FLOAT_EQ(-1.0F, analog[ROBUROC4_AI_PAD_LT]) << "a trigger at rest";
    EXPECT_FLOAT_EQ(state.battery_v, analog[ROBUROC4_AI_BATTERY_V]);
    EXPECT_NEAR(double(state.distances_m[0]) * 5.0 / 6.0,
                double(analog[ROBUROC4_AI_FRONT_TELEMETER_V]), 1e-5);
}

TEST(SimInputs, WithLiteralNumbersLieOneIndexHigher) {
    roburoc4_sim_config config = default_sim_config();
    config.digital_inputs = 23;
    config.analog_inputs = 10;
    SimRobot robot(config);
    EXPECT_EQ(roburoc4_client_channel_name(nullptr, ROBUROC4_IO_DIGITAL_INPUT, ROBUROC4_DI_PAD_A),
              channel_text(robot, ROBUROC4_IO_DIGITAL_INPUT, 9));
    EXPECT_EQ(
        roburoc4_client_channel_name(nullptr, ROBUROC4_IO_ANALOG_INPUT, ROBUROC4_AI_BATTERY_V),
        channel_text(robot, ROBUROC4_IO_ANALOG_INPUT, 3));
    EXPECT_EQ("", channel_text(robot, ROBUROC4_IO_ANALOG_INPUT, 2));
    EXPECT_EQ(ROBUROC4_OK,
              roburoc4_sim_set(robot.get(), ROBUROC4_SIM_PAD_BUTTON + ROBUROC4_DI_PAD_A, 1));
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_IOCARD, 1));
    robot.run(1);
    const auto statuses = robot.take();
    ASSERT_EQ(1U, statuses.size());
    ASSERT_EQ(11U + 40U + 3U, statuses[0].bytes.size());
    EXPECT_EQ(0x02, statuses[0].bytes[11 + 40 + 1]) << "bit 1 of block 1 is channel 9";
}

TEST(SimInputs, CanBeFixedAndReleased) {
    SimRobot robot;
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(robot.get(), ROBUROC4_SIM_PIN_DIGITAL + 3, 1));
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(robot.get(), ROBUROC4_SIM_PIN_ANALOG + 2, 7.5F));
    EXPECT_EQ(ROBUROC4_ERR_INDEX, roburoc4_sim_set(robot.get(), ROBUROC4_SIM_PIN_DIGITAL + 22, 1));
    EXPECT_EQ(ROBUROC4_ERR_INDEX, roburoc4_sim_set(robot.get(), ROBUROC4_SIM_PIN_ANALOG + 9, 1.0F));
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_IOCARD, 1));
    robot.run(1);
    Bytes status = robot.take().at(0).bytes;
    EXPECT_EQ(0x08, status[47]);
    EXPECT_EQ(from_hex("00 00 F0 40"), Bytes(status.begin() + 19, status.begin() + 23));
    roburoc4_sim_set(robot.get(), ROBUROC4_SIM_PIN, 0);
    robot.run(1);
    status = robot.take().at(0).bytes;
    EXPECT_EQ(0x00, status[47]);
}

/* ----------------------------------------------------------------------------- other robots --- */

TEST(SimDialects, OtherIdsHoldForRequestsStatusesAndCommands) {
    roburoc4_sim_config config = default_sim_config();
    config.service_ids[ROBUROC4_SERVICE_DIFFERENTIAL] = 0x1234;
    SimRobot robot(config);
    EXPECT_EQ(from_hex("21 00 06 00 01"), robot.ask(get(6)));
    EXPECT_EQ(57U, robot.ask(from_hex("21 00 34 12")).size());
    EXPECT_EQ(0, robot.insert(0x1234, 1));
    robot.send(from_hex("FF 06 00  00 00 80 3F  00 00 00 00"));
    EXPECT_EQ(0U, robot.state().speed_commands);
    robot.send(from_hex("FF 34 12  00 00 80 3F  00 00 00 00"));
    robot.run(1);
    const Bytes status = robot.take().at(0).bytes;
    EXPECT_EQ(from_hex("FF 34 12"), Bytes(status.begin(), status.begin() + 3));
    EXPECT_DOUBLE_EQ(1.0, robot.state().target_linear_m_s);
}

TEST(SimDialects, PlainTypesAreUnknownOnes) {
    roburoc4_sim_config config = default_sim_config();
    config.plain_types = 1;
    SimRobot robot(config);
    const Bytes answer = robot.ask(get(0));
    for (std::size_t at = 5; at < answer.size(); at += 4) {
        const int type = answer[at] | answer[at + 1] << 8;
        for (const int known : {0x0002, 0x4001, 0x4004, 0x4005, 0x4008, 0x4009, 0x8002})
            EXPECT_NE(known, type);
    }
    EXPECT_EQ("Differential", directory_text(robot, 6));
}

TEST(SimDialects, AHiddenServiceIsNeverReported) {
    roburoc4_sim_config config = default_sim_config();
    config.hidden_services = 1U << ROBUROC4_SERVICE_BATTERY;
    config.refused_inserts = 1U << ROBUROC4_SERVICE_TELEMETER;
    SimRobot robot(config);
    EXPECT_EQ(29U, robot.ask(get(0)).size());
    EXPECT_EQ("Localization", directory_text(robot, 4)) << "the list closes up";
    EXPECT_EQ(from_hex("21 00 04 00 01"), robot.ask(get(4)));
    EXPECT_EQ(ROBUROC4_ERROR_DATA, robot.insert(ROBUROC4_SERVICE_BATTERY, 5));
    EXPECT_EQ(ROBUROC4_ERROR_SERVICE, robot.insert(ROBUROC4_SERVICE_TELEMETER, 5));
}

/* ------------------------------------------------------------------------------- power, time ---
 */

TEST(SimPower, OffIsSilentAndOnIsAReboot) {
    SimRobot robot;
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_DIFFERENTIAL, 1));
    robot.drive(1.0F, 0.0F, 300);
    const double stood_at = robot.state().true_x_m;
    robot.take();
    robot.send(get(0));
    roburoc4_sim_set(robot.get(), ROBUROC4_SIM_POWER, 0);
    EXPECT_TRUE(robot.take().empty()) << "what was not sent yet is lost";
    EXPECT_TRUE(robot.ask(get(0)).empty());
    robot.run(300);
    EXPECT_TRUE(robot.take().empty());
    EXPECT_EQ(0, robot.state().powered);
    roburoc4_sim_set(robot.get(), ROBUROC4_SIM_POWER, 1);
    const auto state = robot.state();
    EXPECT_EQ(0U, state.cycles);
    EXPECT_EQ(0U, state.subscriptions);
    EXPECT_EQ(1U, state.reboots);
    EXPECT_DOUBLE_EQ(0.0, state.target_linear_m_s);
    EXPECT_DOUBLE_EQ(0.0, state.odometry_x_m);
    EXPECT_GT(state.true_x_m, stood_at) << "it rolled on a little and stayed there";
    robot.run(7);
    EXPECT_EQ(7U, robot.state().cycles);
    EXPECT_TRUE(robot.take().empty());
}

TEST(SimTime, RunsEveryCycleThatIsDueAndNoneTwice) {
    SimRobot robot;
    EXPECT_EQ(SimRobot::origin_us + 10000, roburoc4_sim_next_deadline(robot.get()));
    roburoc4_sim_advance(robot.get(), SimRobot::origin_us + 9999);
    EXPECT_EQ(0U, robot.state().cycles);
    roburoc4_sim_advance(robot.get(), SimRobot::origin_us + 10000);
    roburoc4_sim_advance(robot.get(), SimRobot::origin_us + 10000);
    EXPECT_EQ(1U, robot.state().cycles);
    roburoc4_sim_advance(robot.get(), 3);
    EXPECT_EQ(1U, robot.state().cycles) << "a time before the last";
    roburoc4_sim_advance(robot.get(), SimRobot::origin_us + 1000000);
    EXPECT_EQ(100U, robot.state().cycles);
    EXPECT_EQ(SimRobot::origin_us + 1010000, roburoc4_sim_next_deadline(robot.get()));
}

TEST(SimTime, AFullQueueDropsWhatIsNewAndCountsIt) {
    SimRobot robot;
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_DIFFERENTIAL, 1));
    robot.run(2000);
    const auto kept = robot.take();
    EXPECT_EQ(2000U, kept.size() + robot.state().dropped);
    EXPECT_GT(robot.state().dropped, 0U);
    for (std::size_t index = 0; index < kept.size(); index++) {
        const auto status = decode<roburoc4_differential_status>(
            kept[index].bytes, roburoc4_decode_differential_status);
        ASSERT_EQ(index + 1, status.robot_cycles);
    }
}

TEST(SimTime, TheSameSeedAndCallsGiveTheSameBytes) {
    const auto life = [](std::uint64_t seed) {
        roburoc4_sim_config config = default_sim_config();
        config.seed = seed;
        SimRobot robot(config);
        Bytes all;
        for (std::uint16_t service = 2; service < 7; service++)
            robot.insert(service, 2);
        for (int turn = 0; turn < 100; turn++) {
            robot.drive(turn % 3 == 0 ? 1.0F : -0.4F, turn % 2 == 0 ? 2.0F : -1.5F, 20);
            for (const auto &sent : robot.take())
                all.insert(all.end(), sent.bytes.begin(), sent.bytes.end());
        }
        return all;
    };
    const Bytes first = life(4);
    EXPECT_GT(first.size(), 10000U);
    EXPECT_TRUE(first == life(4));
    EXPECT_FALSE(first == life(5)) << "slip has a seed of its own";
}
