/* SPDX-License-Identifier: MIT
 *
 * codec_claims_test.cpp - counts that claim more than a datagram can hold, and views that end at
 * their count. Inputs and outputs are in heap blocks of exactly their size. Lengths and capacities:
 * codec_changes_test.cpp.
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
