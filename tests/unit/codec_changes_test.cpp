/* SPDX-License-Identifier: MIT
 *
 * codec_changes_test.cpp - every telegram as it is, in every length and with seeded random
 * changes, for every decoder: the fuzzer's harness (verify/fuzz/codec.cpp) demands that what is
 * accepted is encoded to the same bytes again, that what is refused leaves the output alone, and
 * that encoders respect their capacity.
 */
#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "../verify/fuzz/fuzz.h"
#include "vectors.h"

using namespace roburoc4_tests;

namespace {

constexpr std::uint8_t decoders = 18; /* of the harness */
constexpr int rounds = 100;

/** The bytes that a field is most often read wrong with, and any others. */
std::uint8_t any_byte(std::mt19937_64 &random) {
    const std::uint8_t edges[] = {0x00, 0x01, 0x7F, 0x80, 0xFF};
    return random() % 2 == 0 ? edges[random() % std::size(edges)]
                             : static_cast<std::uint8_t>(random());
}

/** Other values behind the head, and sometimes another length. */
Bytes changed(Bytes telegram, std::mt19937_64 &random) {
    for (std::uint64_t changes = 1 + random() % 16; changes > 0; changes--)
        telegram[random() % 4 == 0 ? random() % telegram.size()
                                   : telegram.size() - 1 - random() % (telegram.size() / 2)] =
            any_byte(random);
    if (random() % 4 == 0)
        telegram.resize(telegram.size() + random() % 20 - 4, any_byte(random));
    return telegram;
}

/* For the IO card the harness takes the numbers of analog and digital channels first. */
const Bytes usual[] = {{9, 0, 0, 0, 22, 0, 0, 0}, {0, 0, 0, 0, 8, 0, 0, 0}};

/* A decoder that accepts too little cannot write back what it read. */
TEST(Changes, OfALengthNeverReadBeyondTheTelegram) {
    for (std::uint8_t decoder = 0; decoder < decoders; decoder++) {
        for (const Vector &vector : vectors) {
            const Bytes whole = from_hex(vector.hex);
            for (std::size_t size = 0; size <= whole.size() + 3; size++) {
                for (const Bytes &counts : {Bytes(), usual[0], usual[1]}) {
                    Bytes telegram = whole;
                    telegram.resize(size, 0x5A);
                    telegram.insert(telegram.begin(), counts.begin(), counts.end());
                    telegram.insert(telegram.begin(), decoder);
                    LLVMFuzzerTestOneInput(telegram.data(), telegram.size());
                }
            }
        }
    }
}

TEST(Changes, OfATelegramAreWrittenBackAsTheyWereRead) {
    std::mt19937_64 random(1);
    for (std::uint8_t decoder = 0; decoder < decoders; decoder++) {
        for (const Vector &vector : vectors) {
            for (int round = 0; round < rounds; round++) {
                Bytes telegram = from_hex(vector.hex);
                if (round != 0)
                    telegram = changed(telegram, random);
                for (const Bytes &counts : {Bytes(), usual[0], usual[1]}) {
                    Bytes input = counts;
                    input.insert(input.begin(), decoder);
                    input.insert(input.end(), telegram.begin(), telegram.end());
                    LLVMFuzzerTestOneInput(input.data(), input.size());
                }
            }
        }
    }
}

} // namespace
