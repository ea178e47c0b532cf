/* SPDX-License-Identifier: MIT
 *
 * What no datagram can carry is refused before anything is read or written, however large the
 * numbers are; and the library's version is reported.
 */
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "roburoc4.h"

namespace {

/* The largest payload of UDP over IPv4, and the headers before lists. */
constexpr std::size_t datagram = 65507;
constexpr std::size_t answer_head = 5, status_head = 11;
constexpr std::size_t huge = std::numeric_limits<std::size_t>::max();

struct Encoder {
    const char *name;
    std::size_t most;       /* entries that fit a datagram */
    roburoc4_result length; /* of a telegram with so many */
    roburoc4_result (*encode)(std::uint8_t *, std::size_t, const void *entries, std::size_t count);
};

template <class Entry> const Entry *as(const void *entries) {
    return static_cast<const Entry *>(entries);
}

const Encoder encoders[] = {
    {"directory", (datagram - answer_head) / 4, 65505,
     [](std::uint8_t *b, std::size_t n, const void *entries, std::size_t count) {
         return roburoc4_encode_directory(b, n, 2, 0, as<roburoc4_directory_entry>(entries), count);
     }},
    {"notification", (datagram - answer_head) / 3, 65507,
     [](std::uint8_t *b, std::size_t n, const void *entries, std::size_t count) {
         return roburoc4_encode_notification(b, n, 2, 1, as<roburoc4_subscription>(entries), count);
     }},
    {"telemeters", (datagram - answer_head - 4) / 28, 65501,
     [](std::uint8_t *b, std::size_t n, const void *entries, std::size_t count) {
         return roburoc4_encode_telemeter_properties(b, n, 2, 3, as<roburoc4_telemeter>(entries),
                                                     count);
     }},
    {"text", datagram - answer_head, 65507,
     [](std::uint8_t *b, std::size_t n, const void *entries, std::size_t count) {
         return roburoc4_encode_text(b, n, 2, 0, as<char>(entries), count);
     }},
    {"analog inputs", (datagram - status_head) / 4, 65507,
     [](std::uint8_t *b, std::size_t n, const void *entries, std::size_t count) {
         return roburoc4_encode_iocard_status(b, n, 2, 1, as<float>(entries), count, nullptr, 0);
     }},
    {"digital inputs", (datagram - status_head) * 8, 65507,
     [](std::uint8_t *b, std::size_t n, const void *entries, std::size_t count) {
         return roburoc4_encode_iocard_status(b, n, 2, 1, nullptr, 0, as<std::uint8_t>(entries),
                                              count);
     }},
    {"distances", (datagram - status_head) / 4, 65507,
     [](std::uint8_t *b, std::size_t n, const void *entries, std::size_t count) {
         return roburoc4_encode_telemeter_status(b, n, 3, 1, as<float>(entries), count);
     }},
    {"analog outputs", (datagram - status_head) / 4, 65499,
     [](std::uint8_t *b, std::size_t n, const void *entries, std::size_t count) {
         return roburoc4_encode_iocard_command(b, n, 2, as<float>(entries), count, nullptr, 0);
     }},
    {"digital outputs", (datagram - status_head) * 8, 65499,
     [](std::uint8_t *b, std::size_t n, const void *entries, std::size_t count) {
         return roburoc4_encode_iocard_command(b, n, 2, nullptr, 0, as<std::uint8_t>(entries),
                                               count);
     }},
};

} // namespace

TEST(CodecLimits, MoreEntriesThanADatagramCarriesAreRefused) {
    std::array<std::uint8_t, 8> buffer{};
    for (const Encoder &e : encoders) {
        SCOPED_TRACE(e.name);
        for (const std::size_t count : {e.most + 1, e.most * 2, huge / 2, huge}) {
            buffer.fill(0xAA);
            /* decided without reading the entries: there are none here */
            EXPECT_EQ(ROBUROC4_ERR_ARGUMENT,
                      e.encode(buffer.data(), buffer.size(), nullptr, count));
            EXPECT_EQ(0xAA, buffer[0]) << "something was written";
        }
    }
}

TEST(CodecLimits, AFullDatagramIsOnlyTooLongForAShortBuffer) {
    const std::vector<roburoc4_telemeter> entries(datagram); /* more than enough of any kind */
    std::vector<std::uint8_t> large(datagram);
    for (const Encoder &e : encoders) {
        SCOPED_TRACE(e.name);
        EXPECT_EQ(e.length, e.encode(large.data(), large.size(), entries.data(), e.most));
        for (const roburoc4_result capacity : {16, e.length - 1})
            EXPECT_EQ(
                ROBUROC4_ERR_BUFFER,
                e.encode(large.data(), static_cast<std::size_t>(capacity), entries.data(), e.most));
    }
}

TEST(CodecLimits, AnalogAndDigitalChannelsShareOneDatagram) {
    std::vector<std::uint8_t> large(datagram);
    const std::vector<float> analog(16374);
    std::vector<std::uint8_t> digital(16);
    /* exactly full: an 11 byte head, 65496 bytes of analog channels, none left for a digital one */
    EXPECT_EQ(static_cast<roburoc4_result>(datagram),
              roburoc4_encode_iocard_status(large.data(), large.size(), 2, 1, analog.data(), 16374,
                                            digital.data(), 0));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT,
              roburoc4_encode_iocard_status(large.data(), large.size(), 2, 1, analog.data(), 16374,
                                            digital.data(), 1));
    EXPECT_EQ(static_cast<roburoc4_result>(datagram),
              roburoc4_encode_iocard_status(large.data(), large.size(), 2, 1, analog.data(), 16373,
                                            digital.data(), 32));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT,
              roburoc4_encode_iocard_status(large.data(), large.size(), 2, 1, analog.data(), 16373,
                                            digital.data(), 33));
}

TEST(CodecLimits, ATextOfTheDirectoryHasAnIndexOf16Bits) {
    std::array<std::uint8_t, 16> buffer{};
    roburoc4_request request{};
    request.id = 2;
    request.action = ROBUROC4_ACTION_QUERY;
    for (const std::int32_t index : {0, 0xFFFF}) {
        request.index = index;
        EXPECT_EQ(6, roburoc4_encode_request(buffer.data(), buffer.size(), &request)) << index;
    }
    for (const std::int32_t index : {-1, 0x10000}) {
        request.index = index;
        EXPECT_EQ(ROBUROC4_ERR_ARGUMENT,
                  roburoc4_encode_request(buffer.data(), buffer.size(), &request))
            << index;
    }
}

TEST(CodecLimits, ALengthBeyondEveryDatagramIsClipped) {
    if (huge <= 0xFFFFFFFFU)
        GTEST_SKIP() << "a size_t of 32 bits has no such lengths";
    const std::array<std::uint8_t, 11> status{0xFF, 6, 0, 1, 0, 0, 0, 0, 0, 0, 0};
    roburoc4_status_header header{};
    for (const std::size_t surplus : {std::size_t{INT32_MAX}, std::size_t{INT32_MAX} + 1}) {
        EXPECT_EQ(INT32_MAX,
                  roburoc4_decode_status_header(status.data(), status.size() + surplus, &header));
        EXPECT_EQ(6, header.service);
    }
    EXPECT_EQ(INT32_MAX - 1,
              roburoc4_decode_status_header(status.data(), status.size() + INT32_MAX - 1, &header));
}

TEST(Version, OfTheLibraryIsThatOfItsHeader) {
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_VERSION), roburoc4_version());
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_ABI_VERSION), roburoc4_abi_version());
}
