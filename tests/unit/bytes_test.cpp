/* SPDX-License-Identifier: MIT
 *
 * The byte cursors never leave their buffer, whatever is asked of them; and where a double has 32
 * bits, the conversion by bits is the one that this machine's hardware makes.
 */
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>

#include "bytes_exposed.h"
#include "hex.h"

using namespace roburoc4_tests;

namespace {

std::uint64_t bits_of(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
}

std::uint32_t bits_of(float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
}

double double_of(std::uint64_t bits) {
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

/** Numbers around every power of two: where rounding, underflow and overflow begin. */
template <class Check> void around_every_exponent(Check check) {
    const std::array<std::uint64_t, 12> fractions{0,
                                                  1,
                                                  0x0000010000000,
                                                  0x000000FFFFFFF,
                                                  0x0000010000001,
                                                  0x0000020000000,
                                                  0x0000030000000,
                                                  0x000002FFFFFFF,
                                                  0x8000000000000,
                                                  0xFFFFFE0000000,
                                                  0xFFFFFF0000000,
                                                  0xFFFFFFFFFFFFF};
    for (std::uint64_t exponent = 0; exponent < 0x7FF; exponent++)
        for (const std::uint64_t fraction : fractions)
            for (const std::uint64_t sign : {0U, 1U})
                check(sign << 63 | exponent << 52 | fraction);
}

} // namespace

TEST(Bytes, ADoubleBecomesTheNearestFloat) {
    around_every_exponent([](std::uint64_t bits) {
        EXPECT_EQ(bits_of(static_cast<float>(double_of(bits))), exposed_narrow_bits(bits))
            << std::hex << bits;
    });
    /* the halves between the numbers below the least normal one */
    for (std::uint64_t shift = 30; shift < 54; shift++) {
        const std::uint64_t exponent = 1023 - 126 - (shift - 29) + 1;
        for (const std::uint64_t low : {std::uint64_t{0}, std::uint64_t{1}})
            for (std::uint64_t top = 0; top < 4; top++) {
                const std::uint64_t fraction = (top << (shift - 1) | low) & 0xFFFFFFFFFFFFFU;
                const std::uint64_t bits = exponent << 52 | fraction;
                EXPECT_EQ(bits_of(static_cast<float>(double_of(bits))), exposed_narrow_bits(bits))
                    << std::hex << bits;
            }
    }
}

TEST(Bytes, InfinitiesStayAndWhatIsNoNumberStaysNone) {
    EXPECT_EQ(0x7F800000U, exposed_narrow_bits(0x7FF0000000000000U));
    EXPECT_EQ(0xFF800000U, exposed_narrow_bits(0xFFF0000000000000U));
    EXPECT_EQ(0x7FC00000U, exposed_narrow_bits(0x7FF8000000000000U));
    EXPECT_EQ(0xFFC00000U, exposed_narrow_bits(0xFFF0000000000001U)) << "a payload that is lost";
    EXPECT_EQ(0x7FE00000U, exposed_narrow_bits(0x7FFC000000000000U));
    EXPECT_EQ(0x7FF0000000000000U, exposed_widen_bits(0x7F800000U));
    EXPECT_EQ(0xFFF0000000000000U, exposed_widen_bits(0xFF800000U));
    EXPECT_EQ(0x7FF8000000000000U, exposed_widen_bits(0x7FC00000U));
    EXPECT_EQ(0xFFF0000020000000U, exposed_widen_bits(0xFF800001U));
}

TEST(Bytes, AFloatBecomesTheSameDouble) {
    const std::array<std::uint32_t, 9> fractions{0,        1,        2,        3,       0x400000,
                                                 0x3FFFFF, 0x400001, 0x7FFFFE, 0x7FFFFF};
    for (std::uint32_t exponent = 0; exponent < 0xFF; exponent++)
        for (const std::uint32_t fraction : fractions)
            for (const std::uint32_t sign : {0U, 1U}) {
                const std::uint32_t bits = sign << 31 | exponent << 23 | fraction;
                float value = 0;
                std::memcpy(&value, &bits, sizeof value);
                EXPECT_EQ(bits_of(static_cast<double>(value)), exposed_widen_bits(bits))
                    << std::hex << bits;
                EXPECT_EQ(bits, exposed_narrow_bits(exposed_widen_bits(bits)));
            }
    for (std::uint32_t bit = 1; bit < 0x800000; bit <<= 1)
        EXPECT_EQ(bit, exposed_narrow_bits(exposed_widen_bits(bit)));
}

TEST(Bytes, AReaderThatRunsOutGivesZeroAndReadsNoMore) {
    const Bytes bytes = from_hex("01 02 03 04 05 06 07 08 09");
    const std::array<std::uint64_t, 4> values{0x01, 0x0201, 0x04030201, 0x0807060504030201};
    std::size_t i = 0;
    for (const std::size_t width : {1U, 2U, 4U, 8U}) {
        for (std::size_t size = 0; size < width; size++) {
            ExactBlock block(Bytes(bytes.begin(), bytes.begin() + static_cast<long>(size)));
            std::uint64_t value = 99;
            bool failed = false;
            EXPECT_EQ(size, exposed_read(block.data(), size, width, &value, &failed));
            EXPECT_EQ(0U, value);
            EXPECT_TRUE(failed);
        }
        ExactBlock block(bytes);
        std::uint64_t value = 0;
        bool failed = true;
        EXPECT_EQ(bytes.size() - width - 1,
                  exposed_read(block.data(), bytes.size(), width, &value, &failed));
        EXPECT_EQ(values[i++], value);
        EXPECT_FALSE(failed);
    }
}

TEST(Bytes, ARunOfWordsIsReadWholeOrGivesZeros) {
    const Bytes bytes = from_hex("01 02 03 04 05 06 07 08");
    const std::array<std::uint32_t, 3> untouched{0xA5A5A5A5, 0xA5A5A5A5, 0xA5A5A5A5};
    for (std::size_t size = 0; size < bytes.size(); size++) {
        ExactBlock block(Bytes(bytes.begin(), bytes.begin() + static_cast<long>(size)));
        auto words = untouched;
        EXPECT_FALSE(exposed_read_words(block.data(), size, words.data(), 2));
        EXPECT_EQ((std::array<std::uint32_t, 3>{0, 0, untouched[2]}), words);
    }
    ExactBlock block(bytes);
    auto words = untouched;
    EXPECT_TRUE(exposed_read_words(block.data(), bytes.size(), words.data(), 2));
    EXPECT_EQ((std::array<std::uint32_t, 3>{0x04030201, 0x08070605, untouched[2]}), words);
}

TEST(Bytes, AWriterThatRunsOutWritesNothing) {
    for (const std::size_t width : {1U, 2U, 4U, 8U}) {
        const std::size_t piece = width == 8 ? 4 : width; /* a u64 is written as two halves */
        for (std::size_t size = 0; size < width; size++) {
            ExactBlock block(size, 0xAA);
            EXPECT_EQ(0U, exposed_write(block.data(), size, width, 0x0102030405060708U));
            for (std::size_t at = size < piece ? 0 : piece; at < size; at++)
                EXPECT_EQ(0xAA, block.data()[at]);
        }
        ExactBlock block(width + 1, 0xAA);
        EXPECT_EQ(1U, exposed_write(block.data(), width + 1, width, 0x0102030405060708U));
        EXPECT_EQ(8, block.data()[0]);
        EXPECT_EQ(9 - width, block.data()[width - 1]);
        EXPECT_EQ(0xAA, block.data()[width]);
    }
}
