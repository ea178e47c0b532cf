/* SPDX-License-Identifier: MIT
 *
 * codec_lengths_test.cpp - lengths in the codec: every decoder with every length from nothing to
 * three bytes too many, and counts that claim more than a datagram can hold. Inputs and outputs are
 * in heap blocks of exactly their size. Capacities: codec_changes_test.cpp.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>

#include "hex.h"
#include "roburoc4.h"
#include "vectors.h"

using namespace roburoc4_tests;

namespace {

constexpr std::uint8_t pattern = 0xA5;

/** A decoder's result on a block of exactly these bytes; *untouched: whether it left `Out` alone.
 */
template <class Out, class Decode>
roburoc4_result decode_exact(const Bytes &bytes, Decode decode, bool *untouched) {
    ExactBlock input(bytes);
    ExactBlock output(sizeof(Out), pattern);
    const auto result = decode(input.data(), input.size(), reinterpret_cast<Out *>(output.data()));
    *untouched = output.bytes() == Bytes(sizeof(Out), pattern);
    EXPECT_EQ(bytes, input.bytes()) << "the input was changed";
    return result;
}

/** Lengths 0 to full + 3. An element of `list_size` bytes is no surplus where it is not 0; `whole`:
 *  any longer datagram is legal and nothing in it is surplus. */
template <class Out, class Decode>
void check_lengths(const char *name, const Bytes &full, Decode decode, std::size_t shortest,
                   std::size_t list_size = 0, bool whole = false) {
    Bytes longest = full;
    longest.insert(longest.end(), 3, 0x5A);
    for (std::size_t size = 0; size <= longest.size(); size++) {
        const Bytes bytes(longest.begin(), longest.begin() + static_cast<std::ptrdiff_t>(size));
        bool untouched = false;
        const roburoc4_result result = decode_exact<Out>(bytes, decode, &untouched);
        if (size < shortest) {
            EXPECT_EQ(ROBUROC4_ERR_SHORT, result) << name << ", " << size << " bytes";
            EXPECT_TRUE(untouched) << name << ", " << size << " bytes";
            continue;
        }
        std::size_t surplus = size - shortest;
        if (whole)
            surplus = 0;
        else if (list_size != 0)
            surplus %= list_size;
        EXPECT_EQ(static_cast<roburoc4_result>(surplus), result)
            << name << ", " << size << " bytes";
        EXPECT_FALSE(untouched) << name << ", " << size << " bytes";
    }
}

template <class Out, class Decode> void check_fixed(const char *name, Decode decode) {
    const Bytes full = vector_bytes(name);
    check_lengths<Out>(name, full, decode, full.size());
}

/* ------------------------------------------------------------------------------ decoders --- */

TEST(Lengths, RequestsOfEveryAction) {
    for (const char *const name :
         {"get", "query-directory", "query-analog-input", "query-analog-output",
          "query-digital-input", "query-digital-output", "insert", "delete",
          "replace-localization"})
        check_fixed<roburoc4_request>(name, roburoc4_decode_request);
}

TEST(Lengths, RequestsWithoutALayoutNeedTheirFourBytes) {
    check_lengths<roburoc4_request>("update", {7, ROBUROC4_ACTION_UPDATE, 6, 0},
                                    roburoc4_decode_request, 4);
    check_lengths<roburoc4_request>("submit", {7, ROBUROC4_ACTION_SUBMIT, 6, 0},
                                    roburoc4_decode_request, 4);
}

TEST(Lengths, PropertiesOfFixedSize) {
    check_fixed<roburoc4_iocard_properties>("iocard-properties", roburoc4_decode_iocard_properties);
    check_fixed<roburoc4_battery_properties>("battery-properties",
                                             roburoc4_decode_battery_properties);
    check_fixed<roburoc4_localization_properties>("localization-properties",
                                                  roburoc4_decode_localization_properties);
    check_fixed<roburoc4_differential_properties>("differential-properties",
                                                  roburoc4_decode_differential_properties);
    check_fixed<roburoc4_telemeter_list>("telemeter-properties",
                                         roburoc4_decode_telemeter_properties);
}

TEST(Lengths, ListsGrowWithTheDatagram) {
    check_lengths<roburoc4_directory>("directory", vector_bytes("directory"),
                                      roburoc4_decode_directory, 5, 4);
    check_lengths<roburoc4_notification>("notification", vector_bytes("notification"),
                                         roburoc4_decode_notification, 5, 3);
    check_lengths<roburoc4_telemeter_status>("telemeter-status", vector_bytes("telemeter-status"),
                                             roburoc4_decode_telemeter_status, 11, 4);
    for (std::size_t entries = 0; entries <= 7; entries++) {
        const Bytes all = vector_bytes("directory");
        const Bytes bytes(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(5 + 4 * entries));
        roburoc4_directory out{};
        ASSERT_EQ(0, roburoc4_decode_directory(bytes.data(), bytes.size(), &out));
        EXPECT_EQ(entries, out.count); // n = (size - 5) / 4, manual 4.2.2.2
    }
}

TEST(Lengths, TextsAndHeadsOfAnswersTakeAllRemainingBytes) {
    check_lengths<roburoc4_text>("text-directory", vector_bytes("text-directory"),
                                 roburoc4_decode_text, 5, 0, true);
    check_lengths<roburoc4_answer>("text-directory", vector_bytes("text-directory"),
                                   roburoc4_decode_answer, 5, 0, true);
    check_lengths<roburoc4_answer>("error-telegram", vector_bytes("error-telegram"),
                                   roburoc4_decode_answer, 5, 0, true);
}

TEST(Lengths, StatusesAndCommandsOfFixedSize) {
    check_fixed<roburoc4_battery_status>("battery-status", roburoc4_decode_battery_status);
    check_fixed<roburoc4_localization_status>("localization-status",
                                              roburoc4_decode_localization_status);
    check_fixed<roburoc4_differential_status>("differential-status",
                                              roburoc4_decode_differential_status);
    check_fixed<roburoc4_differential_command>("differential-command",
                                               roburoc4_decode_differential_command);
}

TEST(Lengths, StatusesAndCommandsOfTheCard) {
    check_fixed<roburoc4_channels>("iocard-status",
                                   [](const uint8_t *data, size_t size, roburoc4_channels *out) {
                                       return roburoc4_decode_iocard_status(data, size, 9, 22, out);
                                   });
    check_fixed<roburoc4_channels>("iocard-command",
                                   [](const uint8_t *data, size_t size, roburoc4_channels *out) {
                                       return roburoc4_decode_iocard_command(data, size, 0, 8, out);
                                   });
}

TEST(Lengths, HeadsOfStatusesNeed11Bytes) {
    check_lengths<roburoc4_status_header>("battery-status", vector_bytes("battery-status"),
                                          roburoc4_decode_status_header, 11);
}

TEST(Lengths, ErrorsOfEveryKindLeaveTheOutputAlone) {
    bool untouched = false;
    Bytes bytes = vector_bytes("differential-properties");
    bytes[4] = 2;
    EXPECT_EQ(ROBUROC4_ERR_ROBOT, decode_exact<roburoc4_differential_properties>(
                                      bytes, roburoc4_decode_differential_properties, &untouched));
    EXPECT_TRUE(untouched);
    bytes = vector_bytes("iocard-properties");
    bytes[20] = 0x80;
    EXPECT_EQ(ROBUROC4_ERR_VALUE, decode_exact<roburoc4_iocard_properties>(
                                      bytes, roburoc4_decode_iocard_properties, &untouched));
    EXPECT_TRUE(untouched);
    bytes = vector_bytes("battery-status");
    bytes[0] = 1;
    EXPECT_EQ(ROBUROC4_ERR_KIND, decode_exact<roburoc4_battery_status>(
                                     bytes, roburoc4_decode_battery_status, &untouched));
    EXPECT_TRUE(untouched);
}

/* ------------------------------------------------------------------------------- IO card --- */

TEST(DigitalBlocks, EveryNumberOfChannelsIsReadInItsExactLength) {
    for (uint32_t analog = 0; analog <= 3; analog++) {
        for (uint32_t digital = 0; digital <= 33; digital++) {
            const std::size_t blocks = digital == 0 ? 0 : (digital - 1) / 8 + 1;
            Bytes status(11 + 4 * analog + blocks, 0xFF);
            Bytes command(3 + 4 * analog + blocks, 0xFF);
            check_lengths<roburoc4_channels>(
                "status", status,
                [=](const uint8_t *data, size_t size, roburoc4_channels *out) {
                    return roburoc4_decode_iocard_status(data, size, analog, digital, out);
                },
                status.size());
            check_lengths<roburoc4_channels>(
                "command", command,
                [=](const uint8_t *data, size_t size, roburoc4_channels *out) {
                    return roburoc4_decode_iocard_command(data, size, analog, digital, out);
                },
                command.size());
        }
    }
}

TEST(Claims, CountsBeyondTheDatagramAreShortWithoutOverflow) {
    const uint32_t large[] = {51,          0x3FFFFFFDu, 0x3FFFFFFFu, 0x40000000u, 0x40000001u,
                              0x7FFFFFFEu, 0x7FFFFFFFu, 0x80000000u, 0x80000001u, 0xBFFFFFFFu,
                              0xC0000000u, 0xFFFFFFFEu, 0xFFFFFFFFu};
    const Bytes status = vector_bytes("iocard-status");
    const Bytes command = vector_bytes("differential-command");
    for (const uint32_t count : large) {
        const uint32_t digital = count < 1000 ? 8 * count : count;
        for (const auto &[ai, di] :
             {std::pair{count, 0u}, {count, 22u}, {9u, digital}, {0u, digital}, {count, digital}}) {
            bool untouched = false;
            EXPECT_EQ(
                ROBUROC4_ERR_SHORT,
                decode_exact<roburoc4_channels>(
                    status,
                    [a = ai, d = di](const uint8_t *data, size_t size, roburoc4_channels *out) {
                        return roburoc4_decode_iocard_status(data, size, a, d, out);
                    },
                    &untouched))
                << ai << " analog, " << di << " digital";
            EXPECT_TRUE(untouched);
            EXPECT_EQ(
                ROBUROC4_ERR_SHORT,
                decode_exact<roburoc4_channels>(
                    command,
                    [a = ai, d = di](const uint8_t *data, size_t size, roburoc4_channels *out) {
                        return roburoc4_decode_iocard_command(data, size, a, d, out);
                    },
                    &untouched))
                << ai << " analog, " << di << " digital";
            EXPECT_TRUE(untouched);
        }
    }
}

TEST(Claims, MoreTelemetersThanBytesAreShort) {
    for (const uint32_t count :
         {3u, 0x09249249u, 0x0924924Au, 0x24924925u, 0x40000000u, 0x7FFFFFFFu}) {
        Bytes bytes = vector_bytes("telemeter-properties");
        for (std::size_t i = 0; i < 4; i++)
            bytes[5 + i] = static_cast<std::uint8_t>(count >> (8 * i));
        bool untouched = false;
        EXPECT_EQ(ROBUROC4_ERR_SHORT, decode_exact<roburoc4_telemeter_list>(
                                          bytes, roburoc4_decode_telemeter_properties, &untouched))
            << count;
        EXPECT_TRUE(untouched) << count;
    }
}

TEST(Claims, FewerTelemetersThanBytesLeaveSurplus) {
    Bytes bytes = vector_bytes("telemeter-properties");
    roburoc4_telemeter_list out{};
    bytes[5] = 1;
    EXPECT_EQ(28, roburoc4_decode_telemeter_properties(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(1u, out.count);
    bytes[5] = 0;
    EXPECT_EQ(56, roburoc4_decode_telemeter_properties(bytes.data(), bytes.size(), &out));
    EXPECT_EQ(0u, out.count);
}

/* ------------------------------------------------------------------------ views by index --- */

/** The accessor refuses `count` and more, and writes nothing then. */
template <class Item, class View, class At>
void check_beyond(const char *name, const View &view, uint32_t count, At at) {
    for (const uint32_t index :
         {count, count + 1, 0x3FFFFFFFu, 0x40000000u, 0x7FFFFFFFu, 0x80000000u, 0xFFFFFFFFu}) {
        ExactBlock item(sizeof(Item), pattern);
        EXPECT_EQ(ROBUROC4_ERR_INDEX, at(&view, index, reinterpret_cast<Item *>(item.data())))
            << name << " " << index;
        EXPECT_EQ(Bytes(sizeof(Item), pattern), item.bytes()) << name << " " << index;
    }
}

TEST(Views, EndAtTheirCount) {
    ExactBlock directory_bytes(vector_bytes("directory"));
    roburoc4_directory directory{};
    ASSERT_EQ(
        0, roburoc4_decode_directory(directory_bytes.data(), directory_bytes.size(), &directory));
    check_beyond<roburoc4_directory_entry>("directory", directory, 7, roburoc4_directory_at);

    ExactBlock notification_bytes(vector_bytes("notification"));
    roburoc4_notification notification{};
    ASSERT_EQ(0, roburoc4_decode_notification(notification_bytes.data(), notification_bytes.size(),
                                              &notification));
    check_beyond<roburoc4_subscription>("notification", notification, 3, roburoc4_notification_at);

    ExactBlock telemeter_bytes(vector_bytes("telemeter-properties"));
    roburoc4_telemeter_list telemeters{};
    ASSERT_EQ(0, roburoc4_decode_telemeter_properties(telemeter_bytes.data(),
                                                      telemeter_bytes.size(), &telemeters));
    check_beyond<roburoc4_telemeter>("telemeters", telemeters, 2, roburoc4_telemeter_at);

    ExactBlock distance_bytes(vector_bytes("telemeter-status"));
    roburoc4_telemeter_status distances{};
    ASSERT_EQ(0, roburoc4_decode_telemeter_status(distance_bytes.data(), distance_bytes.size(),
                                                  &distances));
    for (const uint32_t room : {0U, 1U, 2U, 3U}) {
        float values[3] = {-77.0F, -77.0F, -77.0F};
        const uint32_t copied = std::min(room, 2U);
        EXPECT_EQ(copied, roburoc4_floats(distances.distances, distances.count, values, room));
        EXPECT_EQ(-77.0F, values[copied]) << "room for " << room;
    }
}

} // namespace
