/* SPDX-License-Identifier: MIT
 *
 * codec_vectors_test.cpp - every telegram of the manual, as bytes beside its values, decoded and
 * encoded.
 */
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "hex.h"
#include "roburoc4.h"
#include "telegrams.h"
#include "vectors.h"

using namespace roburoc4_tests;

namespace {

/** What an encoder writes into a buffer with room to spare. */
template <class Encode> std::string encoded(Encode encode) {
    Bytes buffer(256, 0xEE);
    const roburoc4_result length = encode(buffer.data(), buffer.size());
    if (length < 0)
        return roburoc4_result_text(length);
    buffer.resize(static_cast<std::size_t>(length));
    return to_hex(buffer);
}

std::string wire(const std::string &name) {
    return to_hex(vector_bytes(name));
}

roburoc4_request request(const std::string &name) {
    const Bytes bytes = vector_bytes(name);
    roburoc4_request out{};
    EXPECT_EQ(0, roburoc4_decode_request(bytes.data(), bytes.size(), &out)) << name;
    return out;
}

/** All of a request as it is in memory. */
std::string bytes_of(const roburoc4_request &request) {
    const auto *from = reinterpret_cast<const std::uint8_t *>(&request);
    return to_hex(Bytes(from, from + sizeof request));
}

roburoc4_answer answer(const Bytes &bytes) {
    roburoc4_answer out{};
    EXPECT_EQ(0, roburoc4_decode_answer(bytes.data(), bytes.size(), &out)) << to_hex(bytes);
    return out;
}

/* ------------------------------------------------------------------------------ requests --- */

TEST(Vectors, Get) { // 4.2.2.1
    const roburoc4_request get = request("get");
    EXPECT_EQ(1, get.id);
    EXPECT_EQ(ROBUROC4_ACTION_GET, get.action);
    EXPECT_EQ(6, get.service);
    EXPECT_EQ(wire("get"), encoded([](uint8_t *b, size_t n) { return encode_get(b, n, 1, 6); }));
}

TEST(Vectors, QueryDirectory) { // 4.2.3.1
    const roburoc4_request query = request("query-directory");
    EXPECT_EQ(42, query.id);
    EXPECT_EQ(ROBUROC4_ACTION_QUERY, query.action);
    EXPECT_EQ(0, query.service);
    EXPECT_EQ(3, query.index);
    EXPECT_EQ(wire("query-directory"),
              encoded([](uint8_t *b, size_t n) { return encode_query_directory(b, n, 42, 3); }));
}

TEST(Vectors, QueryOfTheFourElementTypes) { // 4.2.3.3
    const struct {
        const char *name;
        uint8_t id, io_type;
        int32_t index;
    } rows[] = {{"query-analog-input", 43, ROBUROC4_IO_ANALOG_INPUT, 8},
                {"query-analog-output", 44, ROBUROC4_IO_ANALOG_OUTPUT, 1},
                {"query-digital-input", 45, ROBUROC4_IO_DIGITAL_INPUT, 8},
                {"query-digital-output", 46, ROBUROC4_IO_DIGITAL_OUTPUT, 7}};
    for (const auto &row : rows) {
        const roburoc4_request query = request(row.name);
        EXPECT_EQ(row.id, query.id);
        EXPECT_EQ(ROBUROC4_ACTION_QUERY, query.action);
        EXPECT_EQ(2, query.service);
        EXPECT_EQ(row.io_type, query.io_type);
        EXPECT_EQ(row.index, query.index);
        EXPECT_EQ(wire(row.name), encoded([&row](uint8_t *b, size_t n) {
                      return encode_query_iocard(b, n, row.id, 2, row.io_type, row.index);
                  }));
    }
}

TEST(Vectors, Insert) { // 4.2.4.1
    const roburoc4_request insert = request("insert");
    EXPECT_EQ(47, insert.id);
    EXPECT_EQ(ROBUROC4_ACTION_INSERT, insert.action);
    EXPECT_EQ(ROBUROC4_SERVICE_NOTIFICATION, insert.service);
    EXPECT_EQ(6, insert.subject);
    EXPECT_EQ(5, insert.period_cycles);
    EXPECT_EQ(wire("insert"),
              encoded([](uint8_t *b, size_t n) { return encode_insert(b, n, 47, 6, 5); }));
}

TEST(Vectors, Delete) {
    const roburoc4_request del = request("delete");
    EXPECT_EQ(48, del.id);
    EXPECT_EQ(ROBUROC4_ACTION_DELETE, del.action);
    EXPECT_EQ(ROBUROC4_SERVICE_NOTIFICATION, del.service);
    EXPECT_EQ(6, del.subject);
    EXPECT_EQ(wire("delete"),
              encoded([](uint8_t *b, size_t n) { return encode_delete(b, n, 48, 6); }));
}

TEST(Vectors, ReplaceLocalization) { // 4.2.6.5
    const roburoc4_request replace = request("replace-localization");
    EXPECT_EQ(49, replace.id);
    EXPECT_EQ(ROBUROC4_ACTION_REPLACE, replace.action);
    EXPECT_EQ(5, replace.service);
    EXPECT_EQ(12345u, replace.timestamp);
    EXPECT_EQ(10.0, replace.x_m);
    EXPECT_EQ(-4.5, replace.y_m);
    EXPECT_EQ(1.5, replace.theta_rad);
    EXPECT_EQ(wire("replace-localization"), encoded([](uint8_t *b, size_t n) {
                  return encode_replace_localization(b, n, 49, 5, 12345, 10.0, -4.5, 1.5);
              }));
}

TEST(Vectors, FieldsThatAnActionDoesNotHaveAreZero) {
    roburoc4_request out;
    std::memset(&out, 0xA5, sizeof out);
    const Bytes get = vector_bytes("get");
    ASSERT_EQ(0, roburoc4_decode_request(get.data(), get.size(), &out));
    EXPECT_EQ(0, out.subject);
    EXPECT_EQ(0, out.period_cycles);
    EXPECT_EQ(0, out.io_type);
    EXPECT_EQ(0, out.index);
    EXPECT_EQ(0u, out.timestamp);
    EXPECT_EQ(0.0, out.x_m);
    EXPECT_EQ(0.0, out.y_m);
    EXPECT_EQ(0.0, out.theta_rad);
}

TEST(Vectors, SurplusBytesOfARequestAreNotFields) {
    for (const char *const name :
         {"get", "query-directory", "query-analog-input", "query-digital-output", "insert",
          "delete", "replace-localization"}) {
        roburoc4_request out;
        std::memset(&out, 0xA5, sizeof out);
        Bytes bytes = vector_bytes(name);
        bytes.insert(bytes.end(), 64, 0xEE);
        EXPECT_EQ(64, roburoc4_decode_request(bytes.data(), bytes.size(), &out)) << name;
        const roburoc4_request alone = request(name);
        EXPECT_EQ(bytes_of(alone), bytes_of(out)) << name;
    }
}

TEST(Vectors, ActionsWithoutALayoutHaveOnlyHeaderFields) {
    for (const int action : {ROBUROC4_ACTION_UPDATE, ROBUROC4_ACTION_SUBMIT, 7, 255}) {
        const Bytes bytes = {9, static_cast<uint8_t>(action), 0x34, 0x12};
        roburoc4_request out{};
        ASSERT_EQ(0, roburoc4_decode_request(bytes.data(), bytes.size(), &out)) << action;
        EXPECT_EQ(9, out.id);
        EXPECT_EQ(action, out.action);
        EXPECT_EQ(0x1234, out.service);
    }
}

/* ---------------------------------------------------------------------- property answers --- */

TEST(Vectors, Directory) { // 4.2.2.2
    const Bytes bytes = vector_bytes("directory");
    ASSERT_EQ(33u, bytes.size());
    const roburoc4_directory_entry entries[] = {{0, 0}, {0, 1},      {0x4001, 2}, {0x4008, 3},
                                                {0, 4}, {0x8002, 5}, {0x4005, 6}};
    roburoc4_directory out{};
    ASSERT_EQ(0, roburoc4_decode_directory(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(0, out.service);
    ASSERT_EQ(7u, out.count);
    for (uint32_t i = 0; i < 7; i++) {
        roburoc4_directory_entry entry{};
        ASSERT_EQ(0, roburoc4_directory_at(&out, i, &entry));
        EXPECT_EQ(entries[i].type, entry.type) << i;
        EXPECT_EQ(entries[i].id, entry.id) << i;
    }
    EXPECT_EQ(wire("directory"), encoded([&entries](uint8_t *b, size_t n) {
                  return roburoc4_encode_directory(b, n, 1, 0, entries, 7);
              }));
}

TEST(Vectors, Notification) { // 4.2.2.3
    const Bytes bytes = vector_bytes("notification");
    const roburoc4_subscription entries[] = {{6, 5, 0}, {2, 10, 0}, {4, 100, 0}};
    roburoc4_notification out{};
    ASSERT_EQ(0, roburoc4_decode_notification(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(1, out.service);
    ASSERT_EQ(3u, out.count);
    for (uint32_t i = 0; i < 3; i++) {
        roburoc4_subscription entry{};
        ASSERT_EQ(0, roburoc4_notification_at(&out, i, &entry));
        EXPECT_EQ(entries[i].service, entry.service) << i;
        EXPECT_EQ(entries[i].period_cycles, entry.period_cycles) << i;
    }
    EXPECT_EQ(wire("notification"), encoded([&entries](uint8_t *b, size_t n) {
                  return roburoc4_encode_notification(b, n, 1, 1, entries, 3);
              }));
}

TEST(Vectors, IocardProperties) { // 4.2.2.4
    const Bytes bytes = vector_bytes("iocard-properties");
    ASSERT_EQ(21u, bytes.size());
    roburoc4_iocard_properties out{};
    ASSERT_EQ(0, roburoc4_decode_iocard_properties(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(2, out.service);
    EXPECT_EQ(9, out.analog_inputs);
    EXPECT_EQ(0, out.analog_outputs);
    EXPECT_EQ(22, out.digital_inputs);
    EXPECT_EQ(8, out.digital_outputs);
    EXPECT_EQ(wire("iocard-properties"), encoded([&out](uint8_t *b, size_t n) {
                  return roburoc4_encode_iocard_properties(b, n, 1, &out);
              }));
}

TEST(Vectors, TelemeterProperties) { // 4.2.2.5
    const Bytes bytes = vector_bytes("telemeter-properties");
    ASSERT_EQ(65u, bytes.size());
    const float pi = 3.14159265F;
    const roburoc4_telemeter telemeters[] = {{0.625F, 0.0F, 0.0F, 0.5F, 0.25F, 4.0F, 1.5F},
                                             {-0.625F, 0.125F, pi, 0.75F, 0.1875F, 3.5F, 2.25F}};
    roburoc4_telemeter_list out{};
    ASSERT_EQ(0, roburoc4_decode_telemeter_properties(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(3, out.service);
    ASSERT_EQ(2u, out.count);
    for (uint32_t i = 0; i < 2; i++) {
        roburoc4_telemeter got{};
        ASSERT_EQ(0, roburoc4_telemeter_at(&out, i, &got));
        EXPECT_EQ(telemeters[i].x_m, got.x_m);
        EXPECT_EQ(telemeters[i].y_m, got.y_m);
        EXPECT_EQ(telemeters[i].theta_rad, got.theta_rad);
        EXPECT_EQ(telemeters[i].field_of_view_rad, got.field_of_view_rad);
        EXPECT_EQ(telemeters[i].min_distance_m, got.min_distance_m);
        EXPECT_EQ(telemeters[i].max_distance_m, got.max_distance_m);
        EXPECT_EQ(telemeters[i].distance_m, got.distance_m);
    }
    EXPECT_EQ(wire("telemeter-properties"), encoded([&telemeters](uint8_t *b, size_t n) {
                  return roburoc4_encode_telemeter_properties(b, n, 1, 3, telemeters, 2);
              }));
}

TEST(Vectors, BatteryProperties) { // 4.2.2.6
    const Bytes bytes = vector_bytes("battery-properties");
    ASSERT_EQ(14u, bytes.size());
    roburoc4_battery_properties out{};
    ASSERT_EQ(0, roburoc4_decode_battery_properties(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(4, out.service);
    EXPECT_EQ(24.0F, out.nominal_voltage_v);
    EXPECT_EQ(40.0F, out.capacity_ah);
    EXPECT_EQ(20, out.minimum_percent);
    EXPECT_EQ(wire("battery-properties"), encoded([&out](uint8_t *b, size_t n) {
                  return roburoc4_encode_battery_properties(b, n, 1, &out);
              }));
}

TEST(Vectors, LocalizationProperties) { // 4.2.2.7
    const Bytes bytes = vector_bytes("localization-properties");
    ASSERT_EQ(33u, bytes.size());
    roburoc4_localization_properties out{};
    ASSERT_EQ(0, roburoc4_decode_localization_properties(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(5, out.service);
    EXPECT_EQ(1.5, out.x_m);
    EXPECT_EQ(-2.25, out.y_m);
    EXPECT_EQ(0.5, out.theta_rad);
    EXPECT_EQ(
        static_cast<uint32_t>(ROBUROC4_LOCALIZATION_METRIC | ROBUROC4_LOCALIZATION_PROPRIOCEPTIVE),
        out.flags);
    EXPECT_EQ(wire("localization-properties"), encoded([&out](uint8_t *b, size_t n) {
                  return roburoc4_encode_localization_properties(b, n, 1, &out);
              }));
}

TEST(Vectors, DifferentialProperties) { // 4.2.2.8: targets first, then current speeds
    const Bytes bytes = vector_bytes("differential-properties");
    ASSERT_EQ(57u, bytes.size());
    roburoc4_differential_properties out{};
    ASSERT_EQ(0, roburoc4_decode_differential_properties(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(6, out.service);
    EXPECT_EQ(0.5F, out.target_linear_m_s);
    EXPECT_EQ(-0.25F, out.target_angular_rad_s);
    EXPECT_EQ(0.4375F, out.current_linear_m_s);
    EXPECT_EQ(-0.125F, out.current_angular_rad_s);
    EXPECT_EQ(2.6F, out.max_linear_m_s);
    EXPECT_EQ(-1.3F, out.min_linear_m_s);
    EXPECT_EQ(6.5F, out.max_angular_rad_s);
    EXPECT_EQ(-3.25F, out.min_angular_rad_s);
    EXPECT_EQ(2.0F, out.max_linear_m_s2);
    EXPECT_EQ(-3.0F, out.min_linear_m_s2);
    EXPECT_EQ(8.0F, out.max_angular_rad_s2);
    EXPECT_EQ(-10.0F, out.min_angular_rad_s2);
    EXPECT_EQ(0.68F, out.width_m);
    EXPECT_EQ(wire("differential-properties"), encoded([&out](uint8_t *b, size_t n) {
                  return roburoc4_encode_differential_properties(b, n, 1, &out);
              }));
}

/* ------------------------------------------------------------------------- other answers --- */

TEST(Vectors, Text) { // 4.2.3.1, 4.2.3.3
    const struct {
        const char *name;
        uint8_t id;
        uint16_t service;
        std::string text;
    } rows[] = {{"text-directory", 42, 0, "Differential"},
                {"text-iocard", 45, 2, "Game pad \"A\" button"}};
    for (const auto &row : rows) {
        const Bytes bytes = vector_bytes(row.name);
        roburoc4_text out{};
        ASSERT_EQ(0, roburoc4_decode_text(bytes.data(), bytes.size(), &out));
        EXPECT_EQ(row.service, out.service);
        EXPECT_EQ(row.text, std::string(reinterpret_cast<const char *>(out.text), out.length));
        EXPECT_EQ(wire(row.name), encoded([&row](uint8_t *b, size_t n) {
                      return roburoc4_encode_text(b, n, row.id, row.service, row.text.data(),
                                                  row.text.size());
                  }));
    }
}

TEST(Vectors, PlainAnswersAndErrors) { // 4.2.4.1, 4.2.4.2
    const struct {
        const char *name;
        uint8_t id, action;
        uint16_t service;
        uint8_t error;
    } rows[] = {{"insert-answer", 47, ROBUROC4_ACTION_INSERT, 1, ROBUROC4_ERROR_NONE},
                {"delete-answer", 48, ROBUROC4_ACTION_DELETE, 1, ROBUROC4_ERROR_NONE},
                {"replace-answer", 49, ROBUROC4_ACTION_REPLACE, 5, ROBUROC4_ERROR_NONE},
                {"error-answer", 50, ROBUROC4_ACTION_INSERT, 1, ROBUROC4_ERROR_DATA},
                {"error-telegram", 0, ROBUROC4_ACTION_GET, 9, ROBUROC4_ERROR_TARGET}};
    for (const auto &row : rows) {
        const Bytes bytes = vector_bytes(row.name);
        const roburoc4_answer out = answer(bytes);
        EXPECT_EQ(row.id, out.id) << row.name;
        EXPECT_EQ(row.action, out.action) << row.name;
        EXPECT_EQ(row.service, out.service) << row.name;
        EXPECT_EQ(row.error, out.error) << row.name;
        EXPECT_EQ(0u, out.payload_size) << row.name;
        EXPECT_EQ(wire(row.name), encoded([&row](uint8_t *b, size_t n) {
                      return roburoc4_encode_answer(b, n, row.id, row.action, row.service,
                                                    row.error);
                  }));
    }
}

TEST(Vectors, HeadOfAnAnswerIsReadWithItsPayload) {
    const Bytes bytes = vector_bytes("notification");
    const roburoc4_answer out = answer(bytes);
    EXPECT_EQ(1, out.id);
    EXPECT_EQ(ROBUROC4_ACTION_GET, out.action);
    EXPECT_EQ(1, out.service);
    EXPECT_EQ(0, out.error);
    EXPECT_EQ(bytes.data() + 5, out.payload);
    EXPECT_EQ(bytes.size() - 5, out.payload_size);
}

/* ------------------------------------------------------------------------------ statuses --- */

TEST(Vectors, IocardStatus) { // 4.2.4.4
    const Bytes bytes = vector_bytes("iocard-status");
    ASSERT_EQ(50u, bytes.size());
    const float analog[9] = {0.75F, 1.25F, 25.5F, -1.0F, -0.5F, 0.0F, 0.5F, 1.0F, -0.25F};
    const uint8_t digital[3] = {0x01, 0x01, 0x20};
    roburoc4_channels out{};
    ASSERT_EQ(0, roburoc4_decode_iocard_status(bytes.data(), bytes.size(), 9, 22, &out));
    EXPECT_EQ(2, out.service);
    EXPECT_EQ(360000u, out.robot_cycles);
    EXPECT_EQ(9u, out.analog_count);
    EXPECT_EQ(22u, out.digital_count);
    for (uint32_t i = 0; i < 9; i++) {
        float value = 99.0F;
        ASSERT_EQ(0, analog_at(&out, i, &value));
        EXPECT_EQ(analog[i], value) << i;
    }
    for (uint32_t i = 0; i < 22; i++) {
        const bool set =
            i == ROBUROC4_DI_FRONT_BUMPER || i == ROBUROC4_DI_PAD_A || i == ROBUROC4_DI_PAD_RB;
        EXPECT_EQ(set ? 1 : 0, digital_at(&out, i)) << i;
    }
    EXPECT_EQ(wire("iocard-status"), encoded([&](uint8_t *b, size_t n) {
                  return roburoc4_encode_iocard_status(b, n, 2, 360000, analog, 9, digital, 22);
              }));
}

TEST(Vectors, TelemeterStatus) { // 4.2.4.5
    const Bytes bytes = vector_bytes("telemeter-status");
    ASSERT_EQ(19u, bytes.size());
    const float distances[] = {1.5F, 2.25F};
    roburoc4_telemeter_status out{};
    ASSERT_EQ(0, roburoc4_decode_telemeter_status(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(3, out.service);
    EXPECT_EQ(360000u, out.robot_cycles);
    ASSERT_EQ(2u, out.count);
    for (uint32_t i = 0; i < 2; i++) {
        float value = 99.0F;
        ASSERT_EQ(0, distance_at(&out, i, &value));
        EXPECT_EQ(distances[i], value) << i;
    }
    EXPECT_EQ(wire("telemeter-status"), encoded([&distances](uint8_t *b, size_t n) {
                  return roburoc4_encode_telemeter_status(b, n, 3, 360000, distances, 2);
              }));
}

TEST(Vectors, BatteryStatus) { // 4.2.4.6
    const Bytes bytes = vector_bytes("battery-status");
    ASSERT_EQ(13u, bytes.size());
    roburoc4_battery_status out{};
    ASSERT_EQ(0, roburoc4_decode_battery_status(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(4, out.service);
    EXPECT_EQ(360000u, out.robot_cycles);
    EXPECT_EQ(ROBUROC4_BATTERY_OK, out.state);
    EXPECT_EQ(87, out.remaining_percent);
    EXPECT_EQ(wire("battery-status"), encoded([&out](uint8_t *b, size_t n) {
                  return roburoc4_encode_battery_status(b, n, &out);
              }));
}

TEST(Vectors, LocalizationStatus) { // 4.2.4.7
    const Bytes bytes = vector_bytes("localization-status");
    ASSERT_EQ(39u, bytes.size());
    roburoc4_localization_status out{};
    ASSERT_EQ(0, roburoc4_decode_localization_status(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(5, out.service);
    EXPECT_EQ(360000u, out.robot_cycles);
    EXPECT_EQ(-3.5, out.x_m);
    EXPECT_EQ(0.125, out.y_m);
    EXPECT_EQ(-1.75, out.theta_rad);
    EXPECT_EQ(static_cast<uint32_t>(ROBUROC4_LOCALIZATION_DECIMETRIC |
                                    ROBUROC4_LOCALIZATION_PROPRIOCEPTIVE),
              out.flags);
    EXPECT_EQ(wire("localization-status"), encoded([&out](uint8_t *b, size_t n) {
                  return roburoc4_encode_localization_status(b, n, &out);
              }));
}

TEST(Vectors, DifferentialStatus) { // 4.2.4.8: each target beside its current speed
    const Bytes bytes = vector_bytes("differential-status");
    ASSERT_EQ(27u, bytes.size());
    roburoc4_differential_status out{};
    ASSERT_EQ(0, roburoc4_decode_differential_status(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(6, out.service);
    EXPECT_EQ(360000u, out.robot_cycles);
    EXPECT_EQ(0.5F, out.target_linear_m_s);
    EXPECT_EQ(0.4375F, out.current_linear_m_s);
    EXPECT_EQ(-0.25F, out.target_angular_rad_s);
    EXPECT_EQ(-0.125F, out.current_angular_rad_s);
    EXPECT_EQ(wire("differential-status"), encoded([&out](uint8_t *b, size_t n) {
                  return roburoc4_encode_differential_status(b, n, &out);
              }));
}

TEST(Vectors, StatusHeaderIsReadFromEveryStatus) { // 4.2.4
    const char *const names[] = {"iocard-status", "telemeter-status", "battery-status",
                                 "localization-status", "differential-status"};
    uint16_t service = ROBUROC4_SERVICE_IOCARD;
    for (const char *const name : names) {
        const Bytes bytes = vector_bytes(name);
        roburoc4_status_header out{};
        EXPECT_LE(0, roburoc4_decode_status_header(bytes.data(), bytes.size(), &out)) << name;
        EXPECT_EQ(service++, out.service) << name;
        EXPECT_EQ(360000u, out.robot_cycles) << name;
    }
}

TEST(Vectors, EveryByteOfATimestampAndAnIdCounts) {
    const Bytes bytes = from_hex("FF 0A 0B  01 02 03 04 05 06 07 08  02 57");
    roburoc4_battery_status out{};
    ASSERT_EQ(0, roburoc4_decode_battery_status(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(0x0B0A, out.service);
    EXPECT_EQ(0x0807060504030201u, out.robot_cycles);
}

/* ------------------------------------------------------------------------------ commands --- */

TEST(Vectors, DifferentialCommand) { // 4.2.5.6
    const Bytes bytes = vector_bytes("differential-command");
    ASSERT_EQ(11u, bytes.size());
    roburoc4_differential_command out{};
    ASSERT_EQ(0, roburoc4_decode_differential_command(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(6, out.service);
    EXPECT_EQ(0.5F, out.linear_m_s);
    EXPECT_EQ(-0.25F, out.angular_rad_s);
    EXPECT_EQ(wire("differential-command"), encoded([](uint8_t *b, size_t n) {
                  return roburoc4_encode_differential_command(b, n, 6, 0.5F, -0.25F);
              }));
}

TEST(Vectors, IocardCommand) { // 4.2.5.2
    const Bytes bytes = vector_bytes("iocard-command");
    const uint8_t digital[] = {0x82};
    roburoc4_channels out{};
    ASSERT_EQ(0, roburoc4_decode_iocard_command(bytes.data(), bytes.size(), 0, 8, &out));
    EXPECT_EQ(2, out.service);
    EXPECT_EQ(0u, out.analog_count);
    EXPECT_EQ(8u, out.digital_count);
    for (uint32_t i = 0; i < 8; i++)
        EXPECT_EQ(i == 1 || i == 7 ? 1 : 0, digital_at(&out, i)) << i;
    EXPECT_EQ(wire("iocard-command"), encoded([&digital](uint8_t *b, size_t n) {
                  return roburoc4_encode_iocard_command(b, n, 2, nullptr, 0, digital, 8);
              }));
}

TEST(Vectors, IocardCommandWithAnalogOutputsAndASecondBlock) { // 4.2.5.2
    const Bytes bytes = from_hex("FF 02 00  00 00 80 3F  00 00 20 C0  80 01");
    const float analog[] = {1.0F, -2.5F};
    const uint8_t digital[] = {0x80, 0x01};
    roburoc4_channels out{};
    ASSERT_EQ(0, roburoc4_decode_iocard_command(bytes.data(), bytes.size(), 2, 9, &out));
    for (uint32_t i = 0; i < 2; i++) {
        float value = 99.0F;
        ASSERT_EQ(0, analog_at(&out, i, &value));
        EXPECT_EQ(analog[i], value) << i;
    }
    for (uint32_t i = 0; i < 9; i++)
        EXPECT_EQ(i >= 7 ? 1 : 0, digital_at(&out, i)) << i;
    EXPECT_EQ(to_hex(bytes), encoded([&](uint8_t *b, size_t n) {
                  return roburoc4_encode_iocard_command(b, n, 2, analog, 2, digital, 9);
              }));
}

TEST(Vectors, TheHeadOfACommandSaysWhichServiceItIsFor) {
    for (const char *const name : {"differential-command", "iocard-command"}) {
        const Bytes bytes = vector_bytes(name);
        roburoc4_channels out{};
        const auto rest = static_cast<roburoc4_result>(bytes.size()) - 3;
        EXPECT_EQ(rest, roburoc4_decode_iocard_command(bytes.data(), bytes.size(), 0, 0, &out));
        EXPECT_EQ(name[0] == 'd' ? 6 : 2, out.service) << name;
        EXPECT_EQ(0u, out.robot_cycles) << name;
    }
}

TEST(Vectors, FloatsArePassedOnAsTheyAre) {
    const Bytes bytes = from_hex("FF 06 00  01 00 C0 7F  00 00 80 FF");
    roburoc4_differential_command out{};
    ASSERT_EQ(0, roburoc4_decode_differential_command(bytes.data(), bytes.size(), &out));
    EXPECT_TRUE(std::isnan(out.linear_m_s));
    EXPECT_EQ(-std::numeric_limits<float>::infinity(), out.angular_rad_s);
    EXPECT_EQ(to_hex(bytes), encoded([&out](uint8_t *b, size_t n) {
                  return roburoc4_encode_differential_command(b, n, 6, out.linear_m_s,
                                                              out.angular_rad_s);
              }));
}

} // namespace
