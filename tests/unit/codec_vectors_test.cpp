/* SPDX-License-Identifier: MIT
 *
 * codec_vectors_test.cpp - every telegram of the manual, as bytes beside the values that are
 * decoded from it. That values are encoded to their bytes, codec_changes_test.cpp demands of each
 * of them.
 */
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>

#include "hex.h"
#include "roburoc4.h"
#include "telegrams.h"
#include "vectors.h"

using namespace roburoc4_tests;

namespace {

template <class T> using Decode = roburoc4_result (*)(const std::uint8_t *, std::size_t, T *);

/** Decoded, these are the values and nothing else, whatever was in their memory before: the
 *  decoders clear it, and what the telegram lacks or is reserved is 0. */
template <class T>
void expect_exactly(const Bytes &bytes, Decode<T> decode, const T &expected,
                    roburoc4_result surplus = 0) {
    T out;
    std::memset(static_cast<void *>(&out), 0xA5, sizeof out);
    EXPECT_EQ(surplus, decode(bytes.data(), bytes.size(), &out)) << to_hex(bytes);
    EXPECT_EQ(0, std::memcmp(&expected, &out, sizeof out)) << to_hex(bytes);
}

/** The values of a vector, also with an id of two bytes, and with bytes behind it. */
template <class T> void expect_values(const char *name, Decode<T> decode, T expected) {
    Bytes bytes = vector_bytes(name);
    expect_exactly(bytes, decode, expected);
    bytes[bytes[0] == ROBUROC4_HEADER_STATUS ? 2 : 3] = 0x2B;
    bytes.insert(bytes.end(), 64, 0xEE);
    expect_exactly(bytes, decode, (expected.service |= 0x2B00, expected), 64);
}

/** The elements of a decoded list. */
template <class View, class Item, std::size_t count>
void expect_items(const View &view, roburoc4_result (*at)(const View *, std::uint32_t, Item *),
                  const Item (&expected)[count]) {
    for (std::uint32_t i = 0; i < count; i++) {
        Item item;
        std::memset(&item, 0xA5, sizeof item);
        EXPECT_EQ(ROBUROC4_OK, at(&view, i, &item)) << i;
        EXPECT_EQ(0, std::memcmp(&expected[i], &item, sizeof item)) << i;
    }
}

template <std::size_t count>
void expect_floats(const std::uint8_t *list, const float (&expected)[count]) {
    float values[count];
    ASSERT_EQ(count, roburoc4_floats(list, count, values, count));
    for (std::size_t i = 0; i < count; i++)
        EXPECT_EQ(expected[i], values[i]) << i;
}

constexpr std::uint64_t cycles = 360000; /* of all statuses */

/* ------------------------------------------------------------------------------ requests --- */

TEST(Vectors, Requests) {
    static const struct { /* static: the gap in a request is 0 */
        const char *name;
        roburoc4_request values;
    } rows[] = {
        /* 4.2.2.1 */
        {"get", {1, ROBUROC4_ACTION_GET, 6, 0, 0, 0, 0, 0, 0, 0, 0}},
        /* 4.2.3.1, 4.2.3.3 */
        {"query-directory", {42, ROBUROC4_ACTION_QUERY, 0, 0, 0, 0, 3, 0, 0, 0, 0}},
        {"query-analog-input",
         {43, ROBUROC4_ACTION_QUERY, 2, 0, 0, ROBUROC4_IO_ANALOG_INPUT, 8, 0, 0, 0, 0}},
        {"query-analog-output",
         {44, ROBUROC4_ACTION_QUERY, 2, 0, 0, ROBUROC4_IO_ANALOG_OUTPUT, 1, 0, 0, 0, 0}},
        {"query-digital-input",
         {45, ROBUROC4_ACTION_QUERY, 2, 0, 0, ROBUROC4_IO_DIGITAL_INPUT, 8, 0, 0, 0, 0}},
        {"query-digital-output",
         {46, ROBUROC4_ACTION_QUERY, 2, 0, 0, ROBUROC4_IO_DIGITAL_OUTPUT, 7, 0, 0, 0, 0}},
        /* 4.2.4.1 */
        {"insert", {47, ROBUROC4_ACTION_INSERT, 1, 6, 5, 0, 0, 0, 0, 0, 0}},
        {"delete", {48, ROBUROC4_ACTION_DELETE, 1, 6, 0, 0, 0, 0, 0, 0, 0}},
        /* 4.2.6.5 */
        {"replace-localization",
         {49, ROBUROC4_ACTION_REPLACE, 5, 0, 0, 0, 0, 12345, 10.0, -4.5, 1.5}},
    };
    for (const auto &row : rows) {
        Bytes bytes = vector_bytes(row.name);
        expect_exactly(bytes, roburoc4_decode_request, row.values);
        bytes.insert(bytes.end(), 64, 0xEE);
        expect_exactly(bytes, roburoc4_decode_request, row.values, 64);
    }
}

TEST(Vectors, ActionsWithoutALayoutHaveOnlyHeaderFields) {
    for (const int action : {ROBUROC4_ACTION_UPDATE, ROBUROC4_ACTION_SUBMIT, 7, 255}) {
        const auto kind = static_cast<std::uint8_t>(action);
        expect_exactly(Bytes{9, kind, 0x34, 0x12}, roburoc4_decode_request,
                       request_of(9, kind, 0x1234));
    }
}

/* ---------------------------------------------------------------------- property answers --- */

TEST(Vectors, Directory) { // 4.2.2.2
    const Bytes bytes = vector_bytes("directory");
    const roburoc4_directory_entry entries[] = {{0, 0}, {0, 1},      {0x4001, 2}, {0x4008, 3},
                                                {0, 4}, {0x8002, 5}, {0x4005, 6}};
    const roburoc4_directory directory{bytes.data() + 5, 7, 0, 0};
    expect_exactly(bytes, roburoc4_decode_directory, directory);
    expect_items(directory, roburoc4_directory_at, entries);
}

TEST(Vectors, Notification) { // 4.2.2.3
    const Bytes bytes = vector_bytes("notification");
    const roburoc4_subscription entries[] = {{6, 5, 0}, {2, 10, 0}, {4, 100, 0}};
    const roburoc4_notification notification{bytes.data() + 5, 3, 1, 0};
    expect_exactly(bytes, roburoc4_decode_notification, notification);
    expect_items(notification, roburoc4_notification_at, entries);
}

TEST(Vectors, TelemeterProperties) { // 4.2.2.5
    const Bytes bytes = vector_bytes("telemeter-properties");
    const float pi = 3.14159265F;
    const roburoc4_telemeter telemeters[] = {{0.625F, 0.0F, 0.0F, 0.5F, 0.25F, 4.0F, 1.5F},
                                             {-0.625F, 0.125F, pi, 0.75F, 0.1875F, 3.5F, 2.25F}};
    const roburoc4_telemeter_list list{bytes.data() + 9, 2, 3, 0};
    expect_exactly(bytes, roburoc4_decode_telemeter_properties, list);
    expect_items(list, roburoc4_telemeter_at, telemeters);
}

TEST(Vectors, PropertiesOfFixedSize) {
    expect_values("iocard-properties", roburoc4_decode_iocard_properties, // 4.2.2.4
                  roburoc4_iocard_properties{9, 0, 22, 8, 2, 0});
    expect_values("battery-properties", roburoc4_decode_battery_properties, // 4.2.2.6
                  roburoc4_battery_properties{24.0F, 40.0F, 20, 0, 4});
    expect_values("localization-properties", roburoc4_decode_localization_properties, // 4.2.2.7
                  roburoc4_localization_properties{
                      1.5, -2.25, 0.5,
                      ROBUROC4_LOCALIZATION_METRIC | ROBUROC4_LOCALIZATION_PROPRIOCEPTIVE, 5, 0});
    roburoc4_differential_properties p{}; // 4.2.2.8: targets first, then current speeds
    p.service = 6;
    p.target_linear_m_s = 0.5F;
    p.target_angular_rad_s = -0.25F;
    p.current_linear_m_s = 0.4375F;
    p.current_angular_rad_s = -0.125F;
    p.max_linear_m_s = 2.6F;
    p.min_linear_m_s = -1.3F;
    p.max_angular_rad_s = 6.5F;
    p.min_angular_rad_s = -3.25F;
    p.max_linear_m_s2 = 2.0F;
    p.min_linear_m_s2 = -3.0F;
    p.max_angular_rad_s2 = 8.0F;
    p.min_angular_rad_s2 = -10.0F;
    p.width_m = 0.68F;
    expect_values("differential-properties", roburoc4_decode_differential_properties, p);
}

/* ------------------------------------------------------------------------- other answers --- */

TEST(Vectors, Text) { // 4.2.3.1, 4.2.3.3
    const struct {
        const char *name;
        std::uint16_t service;
        std::string text;
    } rows[] = {{"text-directory", 0, "Differential"}, {"text-iocard", 2, "Game pad \"A\" button"}};
    for (const auto &row : rows) {
        const Bytes bytes = vector_bytes(row.name);
        const auto length = static_cast<std::uint32_t>(row.text.size());
        expect_exactly(bytes, roburoc4_decode_text,
                       roburoc4_text{bytes.data() + 5, length, row.service, 0});
        EXPECT_EQ(row.text, std::string(bytes.begin() + 5, bytes.end()));
    }
    const Bytes empty = from_hex("2A 01 00 00 00");
    expect_exactly(empty, roburoc4_decode_text, roburoc4_text{empty.data() + 5, 0, 0, 0});
}

TEST(Vectors, AnswersAndErrors) { // 4.2.4.1, 4.2.4.2
    const struct {
        const char *name;
        std::uint8_t id, action, error;
        std::uint16_t service;
    } rows[] = {{"insert-answer", 47, ROBUROC4_ACTION_INSERT, ROBUROC4_ERROR_NONE, 1},
                {"delete-answer", 48, ROBUROC4_ACTION_DELETE, ROBUROC4_ERROR_NONE, 1},
                {"replace-answer", 49, ROBUROC4_ACTION_REPLACE, ROBUROC4_ERROR_NONE, 5},
                {"error-answer", 50, ROBUROC4_ACTION_INSERT, ROBUROC4_ERROR_DATA, 1},
                {"error-telegram", 0, ROBUROC4_ACTION_GET, ROBUROC4_ERROR_TARGET, 9},
                {"notification", 1, ROBUROC4_ACTION_GET, ROBUROC4_ERROR_NONE, 1}};
    for (const auto &row : rows) {
        Bytes bytes = vector_bytes(row.name);
        bytes[3] = 0x2B;
        expect_exactly(bytes, roburoc4_decode_answer,
                       roburoc4_answer{row.id, row.action, row.error, 0,
                                       static_cast<std::uint16_t>(row.service | 0x2B00), 0,
                                       bytes.data() + 5, bytes.size() - 5});
    }
}

/* ------------------------------------------------------------------------------ statuses --- */

TEST(Vectors, IocardStatus) { // 4.2.4.4
    const Bytes bytes = vector_bytes("iocard-status");
    const roburoc4_channels expected{
        cycles, bytes.data() + 11, bytes.data() + 47, 9, 22, ROBUROC4_SERVICE_IOCARD, {}};
    expect_exactly<roburoc4_channels>(
        bytes,
        [](const std::uint8_t *data, std::size_t size, roburoc4_channels *out) {
            return roburoc4_decode_iocard_status(data, size, 9, 22, out);
        },
        expected);
    expect_floats(expected.analog, {0.75F, 1.25F, 25.5F, -1.0F, -0.5F, 0.0F, 0.5F, 1.0F, -0.25F});
    for (std::uint32_t i = 0; i < 22; i++) {
        const bool set =
            i == ROBUROC4_DI_FRONT_BUMPER || i == ROBUROC4_DI_PAD_A || i == ROBUROC4_DI_PAD_RB;
        EXPECT_EQ(set ? 1 : 0, digital_at(&expected, i)) << i;
    }
}

TEST(Vectors, TelemeterStatus) { // 4.2.4.5
    const Bytes bytes = vector_bytes("telemeter-status");
    const roburoc4_telemeter_status expected{cycles, bytes.data() + 11, 2, 3, 0};
    expect_exactly(bytes, roburoc4_decode_telemeter_status, expected);
    expect_floats(expected.distances, {1.5F, 2.25F});
}

TEST(Vectors, StatusesOfFixedSize) {
    expect_values("battery-status", roburoc4_decode_battery_status, // 4.2.4.6
                  roburoc4_battery_status{cycles, ROBUROC4_BATTERY_OK, 87, 4, 0});
    expect_values("localization-status", roburoc4_decode_localization_status, // 4.2.4.7
                  roburoc4_localization_status{cycles, -3.5, 0.125, -1.75,
                                               ROBUROC4_LOCALIZATION_DECIMETRIC |
                                                   ROBUROC4_LOCALIZATION_PROPRIOCEPTIVE,
                                               5, 0});
    expect_values("differential-status", roburoc4_decode_differential_status, // 4.2.4.8
                  roburoc4_differential_status{cycles, 0.5F, 0.4375F, -0.25F, -0.125F, 6, {}});
}

TEST(Vectors, StatusHeaderIsReadFromEveryStatus) { // 4.2.4
    std::uint16_t service = ROBUROC4_SERVICE_IOCARD;
    for (const char *const name : {"iocard-status", "telemeter-status", "battery-status",
                                   "localization-status", "differential-status"}) {
        const Bytes bytes = vector_bytes(name);
        expect_exactly(bytes, roburoc4_decode_status_header,
                       roburoc4_status_header{cycles, service++, {}},
                       static_cast<roburoc4_result>(bytes.size()) - 11);
    }
}

TEST(Vectors, EveryByteOfATimestampCounts) {
    expect_exactly(from_hex("FF 0A 0B  01 02 03 04 05 06 07 08  02 57"),
                   roburoc4_decode_battery_status,
                   roburoc4_battery_status{0x0807060504030201, 2, 0x57, 0x0B0A, 0});
}

/* ------------------------------------------------------------------------------ commands --- */

TEST(Vectors, DifferentialCommand) { // 4.2.5.6
    expect_values("differential-command", roburoc4_decode_differential_command,
                  roburoc4_differential_command{0.5F, -0.25F, 6, 0});
}

TEST(Vectors, IocardCommand) { // 4.2.5.2
    const Bytes bytes = vector_bytes("iocard-command");
    const roburoc4_channels expected{
        0, bytes.data() + 3, bytes.data() + 3, 0, 8, ROBUROC4_SERVICE_IOCARD, {}};
    expect_exactly<roburoc4_channels>(
        bytes,
        [](const std::uint8_t *data, std::size_t size, roburoc4_channels *out) {
            return roburoc4_decode_iocard_command(data, size, 0, 8, out);
        },
        expected);
    for (std::uint32_t i = 0; i < 8; i++)
        EXPECT_EQ(i == 1 || i == 7 ? 1 : 0, digital_at(&expected, i)) << i;
}

TEST(Vectors, IocardCommandWithAnalogOutputsAndASecondBlock) { // 4.2.5.2
    const Bytes bytes = from_hex("FF 02 00  00 00 80 3F  00 00 20 C0  80 01");
    roburoc4_channels out{};
    ASSERT_EQ(0, roburoc4_decode_iocard_command(bytes.data(), bytes.size(), 2, 9, &out));
    expect_floats(out.analog, {1.0F, -2.5F});
    for (std::uint32_t i = 0; i < 9; i++)
        EXPECT_EQ(i >= 7 ? 1 : 0, digital_at(&out, i)) << i;
    Bytes again(bytes.size());
    const float analog[] = {1.0F, -2.5F};
    const std::uint8_t digital[] = {0x80, 0x01};
    EXPECT_EQ(static_cast<roburoc4_result>(bytes.size()),
              roburoc4_encode_iocard_command(again.data(), again.size(), 2, analog, 2, digital, 9));
    EXPECT_EQ(bytes, again);
}

TEST(Vectors, TheHeadOfACommandSaysWhichServiceItIsFor) {
    for (const char *const name : {"differential-command", "iocard-command"}) {
        const Bytes bytes = vector_bytes(name);
        roburoc4_channels out{};
        const auto rest = static_cast<roburoc4_result>(bytes.size()) - 3;
        EXPECT_EQ(rest, roburoc4_decode_iocard_command(bytes.data(), bytes.size(), 0, 0, &out));
        EXPECT_EQ(name[0] == 'd' ? 6 : 2, out.service) << name;
    }
}

} // namespace
