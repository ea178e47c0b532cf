/* SPDX-License-Identifier: MIT
 *
 * codec_lists_test.cpp - reading a status' list at once gives the same values as reading them one
 * by one, never more than there is room for, and never a bit that is not an input.
 */
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "roburoc4.h"
#include "telegrams.h"

namespace {

constexpr float untouched = -77.0F;

/** A status with this many inputs; all bits of its blocks are set, even those without an input. */
std::vector<uint8_t> iocard(uint32_t analog, uint32_t digital) {
    std::vector<float> values;
    for (uint32_t i = 0; i < analog; i++) {
        values.push_back(static_cast<float>(i) + 0.5F);
    }
    const std::vector<uint8_t> blocks((digital + 7) / 8, 0xFF);
    std::vector<uint8_t> bytes(1000);
    const int32_t size = roburoc4_encode_iocard_status(
        bytes.data(), bytes.size(), 2, 7, values.data(), values.size(), blocks.data(), digital);
    EXPECT_GT(size, 0);
    bytes.resize(static_cast<size_t>(size));
    return bytes;
}

TEST(Lists, AllAnalogInputsAreThoseReadOneByOne) {
    for (const uint32_t count : {0U, 1U, 9U, 32U, 100U}) {
        const std::vector<uint8_t> bytes = iocard(count, 22);
        roburoc4_channels status;
        ASSERT_EQ(0, roburoc4_decode_iocard_status(bytes.data(), bytes.size(), count, 22, &status));
        std::vector<float> all(count + 1, untouched);
        ASSERT_EQ(count, roburoc4_floats(status.analog, status.analog_count, all.data(), 200));
        for (uint32_t i = 0; i < count; i++) {
            float one = 0;
            ASSERT_EQ(0, analog_at(&status, i, &one));
            EXPECT_EQ(one, all[i]) << i << " of " << count;
        }
        EXPECT_EQ(untouched, all[count]) << "written beyond the last of " << count;
    }
}

TEST(Lists, NoMoreInputsAreCopiedThanHaveRoom) {
    const std::vector<uint8_t> bytes = iocard(9, 22);
    roburoc4_channels status;
    ASSERT_EQ(0, roburoc4_decode_iocard_status(bytes.data(), bytes.size(), 9, 22, &status));
    for (uint32_t room = 0; room <= 9; room++) {
        std::vector<float> all(10, untouched);
        EXPECT_EQ(room, roburoc4_floats(status.analog, status.analog_count, all.data(), room));
        EXPECT_EQ(untouched, all[room]) << "room for " << room;
    }
}

TEST(Lists, AllDistancesAreThoseReadOneByOneNotANumberToo) {
    const float distances_m[3] = {1.25F, std::numeric_limits<float>::quiet_NaN(), 3.0F};
    uint8_t bytes[64];
    const int32_t size =
        roburoc4_encode_telemeter_status(bytes, sizeof bytes, 3, 7, distances_m, 3);
    roburoc4_telemeter_status status;
    ASSERT_EQ(0, roburoc4_decode_telemeter_status(bytes, static_cast<size_t>(size), &status));
    float all[4] = {untouched, untouched, untouched, untouched};
    EXPECT_EQ(2U, roburoc4_floats(status.distances, status.count, all, 2));
    EXPECT_EQ(untouched, all[2]);
    EXPECT_EQ(3U, roburoc4_floats(status.distances, status.count, all, 4));
    EXPECT_EQ(1.25F, all[0]);
    EXPECT_TRUE(std::isnan(all[1]));
    EXPECT_EQ(3.0F, all[2]);
    EXPECT_EQ(untouched, all[3]);
}

} // namespace
