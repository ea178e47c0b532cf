/* SPDX-License-Identifier: MIT
 *
 * codec_kinds_test.cpp - how the codec handles telegrams of another kind than expected, the robot's
 * errors, and impossible values.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "hex.h"
#include "roburoc4.h"
#include "telegrams.h"
#include "vectors.h"

using namespace roburoc4_tests;

namespace {

/** Calls `check(name, decode)` for each decoder, where decode(bytes) is its result. */
template <class Check> void each_properties_decoder(Check check) {
    const auto decoder = [](auto function, auto out) {
        return [function, out](const Bytes &bytes) mutable {
            return function(bytes.data(), bytes.size(), &out);
        };
    };
    check("directory", decoder(roburoc4_decode_directory, roburoc4_directory{}));
    check("notification", decoder(roburoc4_decode_notification, roburoc4_notification{}));
    check("iocard-properties",
          decoder(roburoc4_decode_iocard_properties, roburoc4_iocard_properties{}));
    check("telemeter-properties",
          decoder(roburoc4_decode_telemeter_properties, roburoc4_telemeter_list{}));
    check("battery-properties",
          decoder(roburoc4_decode_battery_properties, roburoc4_battery_properties{}));
    check("localization-properties",
          decoder(roburoc4_decode_localization_properties, roburoc4_localization_properties{}));
    check("differential-properties",
          decoder(roburoc4_decode_differential_properties, roburoc4_differential_properties{}));
}

TEST(Kinds, AnErrorByteMakesAnAnswerTheRobotsError) { // 4.2.2.2
    each_properties_decoder([](const char *name, auto decode) {
        Bytes bytes = vector_bytes(name);
        for (const int error : {1, 5, 16, 255}) {
            bytes[4] = static_cast<uint8_t>(error);
            EXPECT_EQ(ROBUROC4_ERR_ROBOT, decode(bytes)) << name;
            EXPECT_EQ(ROBUROC4_ERR_ROBOT, decode(Bytes(bytes.begin(), bytes.begin() + 5))) << name;
        }
    });
    Bytes text = vector_bytes("text-directory");
    text[4] = 4;
    roburoc4_text out{};
    EXPECT_EQ(ROBUROC4_ERR_ROBOT, roburoc4_decode_text(text.data(), 5, &out));
    roburoc4_answer answer{};
    ASSERT_EQ(0, roburoc4_decode_answer(text.data(), text.size(), &answer));
    EXPECT_EQ(ROBUROC4_ERROR_LENGTH, answer.error);
}

TEST(Kinds, PropertiesWithAnotherActionOrAStatusHeaderAreRefused) {
    each_properties_decoder([](const char *name, auto decode) {
        Bytes bytes = vector_bytes(name);
        for (int action = 1; action < 256; action++) {
            bytes[1] = static_cast<uint8_t>(action);
            EXPECT_EQ(ROBUROC4_ERR_KIND, decode(bytes)) << name << ", action " << action;
        }
        bytes = vector_bytes(name);
        bytes[0] = ROBUROC4_HEADER_STATUS;
        EXPECT_EQ(ROBUROC4_ERR_KIND, decode(bytes)) << name;
    });
    Bytes text = vector_bytes("text-directory");
    text[1] = ROBUROC4_ACTION_GET;
    roburoc4_text out{};
    EXPECT_EQ(ROBUROC4_ERR_KIND, roburoc4_decode_text(text.data(), text.size(), &out));
}

TEST(Kinds, PropertiesAreReadUnderEveryRequestId) {
    each_properties_decoder([](const char *name, auto decode) {
        Bytes bytes = vector_bytes(name);
        for (int id = 1; id <= 254; id++) {
            bytes[0] = static_cast<uint8_t>(id);
            EXPECT_EQ(0, decode(bytes)) << name << ", id " << id;
        }
    });
}

TEST(Kinds, AnErrorTelegramIsNeverProperties) {
    each_properties_decoder([](const char *name, auto decode) {
        Bytes bytes = vector_bytes(name);
        bytes[0] = ROBUROC4_HEADER_ERROR;
        for (const int error : {0, 1, 255}) {
            bytes[4] = static_cast<uint8_t>(error);
            EXPECT_GT(0, decode(bytes)) << name << ", error " << error;
        }
    });
}

TEST(Kinds, RequestsHaveAnIdOf1To254) {
    Bytes bytes = vector_bytes("get");
    roburoc4_request out{};
    for (int id = 0; id < 256; id++) {
        bytes[0] = static_cast<uint8_t>(id);
        const roburoc4_result expected = id == 0 || id == 255 ? ROBUROC4_ERR_KIND : ROBUROC4_OK;
        EXPECT_EQ(expected, roburoc4_decode_request(bytes.data(), bytes.size(), &out)) << id;
    }
}

TEST(Kinds, AStatusIsNoAnswer) {
    const Bytes bytes = vector_bytes("battery-status");
    roburoc4_answer out{};
    EXPECT_EQ(ROBUROC4_ERR_KIND, roburoc4_decode_answer(bytes.data(), bytes.size(), &out));
}

/** No other header is that of a status or a command. */
template <class Out, class Decode> void expect_header_255(const char *name, Decode decode) {
    Bytes bytes = vector_bytes(name);
    for (int header = 0; header < 255; header++) {
        Out out{};
        bytes[0] = static_cast<uint8_t>(header);
        EXPECT_EQ(ROBUROC4_ERR_KIND, decode(bytes.data(), bytes.size(), &out)) << name;
    }
}

TEST(Kinds, StatusesAndCommandsHaveHeader255) {
    expect_header_255<roburoc4_status_header>("iocard-status", roburoc4_decode_status_header);
    expect_header_255<roburoc4_channels>("iocard-status", [](auto *data, auto size, auto *out) {
        return roburoc4_decode_iocard_status(data, size, 9, 22, out);
    });
    expect_header_255<roburoc4_telemeter_status>("telemeter-status",
                                                 roburoc4_decode_telemeter_status);
    expect_header_255<roburoc4_battery_status>("battery-status", roburoc4_decode_battery_status);
    expect_header_255<roburoc4_localization_status>("localization-status",
                                                    roburoc4_decode_localization_status);
    expect_header_255<roburoc4_differential_status>("differential-status",
                                                    roburoc4_decode_differential_status);
    expect_header_255<roburoc4_differential_command>("differential-command",
                                                     roburoc4_decode_differential_command);
    for (const uint32_t digital : {0U, 8U})
        expect_header_255<roburoc4_channels>(
            "iocard-command", [digital](auto *data, auto size, auto *out) {
                return roburoc4_decode_iocard_command(data, size, 0, digital, out);
            });
}

TEST(Values, ACardWithANegativeCountIsImpossible) {
    for (size_t field = 0; field < 4; field++) {
        for (const char *const hex : {"FF FF FF FF", "00 00 00 80"}) {
            Bytes bytes = vector_bytes("iocard-properties");
            const Bytes count = from_hex(hex);
            std::copy(count.begin(), count.end(),
                      bytes.begin() + static_cast<std::ptrdiff_t>(5 + 4 * field));
            roburoc4_iocard_properties out{};
            EXPECT_EQ(ROBUROC4_ERR_VALUE,
                      roburoc4_decode_iocard_properties(bytes.data(), bytes.size(), &out))
                << "field " << field;
        }
    }
}

TEST(Values, ACardMayClaimAnyOtherCount) {
    const Bytes bytes =
        from_hex("01 00 02 00 00  FF FF FF 7F  00 00 00 00  FF FF FF 7F  01 00 00 00");
    roburoc4_iocard_properties out{};
    ASSERT_EQ(0, roburoc4_decode_iocard_properties(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(std::numeric_limits<int32_t>::max(), out.analog_inputs);
    EXPECT_EQ(std::numeric_limits<int32_t>::max(), out.digital_inputs);
}

TEST(Values, ANegativeNumberOfTelemetersIsImpossible) {
    for (const char *const hex : {"FF FF FF FF", "00 00 00 80"}) {
        Bytes bytes = vector_bytes("telemeter-properties");
        const Bytes count = from_hex(hex);
        std::copy(count.begin(), count.end(), bytes.begin() + 5);
        roburoc4_telemeter_list out{};
        EXPECT_EQ(ROBUROC4_ERR_VALUE,
                  roburoc4_decode_telemeter_properties(bytes.data(), bytes.size(), &out));
    }
}

/** The encoder refuses, and writes no byte. */
template <class Encode> void expect_refused(Encode encode) {
    ExactBlock buffer(80, 0xA5);
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, encode(buffer.data(), buffer.size()));
    EXPECT_EQ(Bytes(80, 0xA5), buffer.bytes());
}

TEST(Values, RequestsAreNotSentWithAReservedId) {
    for (const int reserved : {ROBUROC4_HEADER_ERROR, ROBUROC4_HEADER_STATUS}) {
        const auto id = static_cast<uint8_t>(reserved);
        for (uint8_t action = ROBUROC4_ACTION_GET; action <= ROBUROC4_ACTION_DELETE; action++) {
            roburoc4_request request = request_of(id, action, 2);
            request.period_cycles = 5;
            expect_refused(
                [&](uint8_t *b, size_t n) { return roburoc4_encode_request(b, n, &request); });
        }
    }
}

TEST(Values, AnAnswerIsNotSentUnderTheHeaderOfAStatus) {
    const uint8_t id = ROBUROC4_HEADER_STATUS;
    expect_refused([&](uint8_t *b, size_t n) { return roburoc4_encode_answer(b, n, id, 4, 1, 0); });
    const roburoc4_directory_entry entry{1, 2};
    expect_refused(
        [&](uint8_t *b, size_t n) { return roburoc4_encode_directory(b, n, id, 0, &entry, 1); });
    const roburoc4_subscription subscription{6, 5, 0};
    expect_refused([&](uint8_t *b, size_t n) {
        return roburoc4_encode_notification(b, n, id, 1, &subscription, 1);
    });
    const roburoc4_iocard_properties counts{9, 0, 22, 8, 2, 0};
    expect_refused(
        [&](uint8_t *b, size_t n) { return roburoc4_encode_iocard_properties(b, n, id, &counts); });
    const roburoc4_telemeter telemeter{};
    expect_refused([&](uint8_t *b, size_t n) {
        return roburoc4_encode_telemeter_properties(b, n, id, 3, &telemeter, 1);
    });
    const roburoc4_battery_properties battery{};
    expect_refused([&](uint8_t *b, size_t n) {
        return roburoc4_encode_battery_properties(b, n, id, &battery);
    });
    const roburoc4_localization_properties pose{};
    expect_refused([&](uint8_t *b, size_t n) {
        return roburoc4_encode_localization_properties(b, n, id, &pose);
    });
    const roburoc4_differential_properties limits{};
    expect_refused([&](uint8_t *b, size_t n) {
        return roburoc4_encode_differential_properties(b, n, id, &limits);
    });
    for (const size_t length : {0U, 1U, 4U})
        expect_refused([&](uint8_t *b, size_t n) {
            return roburoc4_encode_text(b, n, id, 0, "text", length);
        });
}

TEST(Values, APeriodOf0IsNotSent) {
    roburoc4_request insert = request_of(1, ROBUROC4_ACTION_INSERT, 1);
    expect_refused([&](uint8_t *b, size_t n) { return roburoc4_encode_request(b, n, &insert); });
    for (const uint8_t period : {uint8_t{1}, uint8_t{255}}) {
        uint8_t b[64];
        insert.period_cycles = period;
        EXPECT_EQ(7, roburoc4_encode_request(b, sizeof b, &insert));
    }
}

} // namespace
