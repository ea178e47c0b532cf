/* SPDX-License-Identifier: MIT
 *
 * What no datagram can carry is refused before anything is read or written, however large the
 * numbers are; and the library's version is reported.
 */
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
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

namespace {

/** The decoded bytes, in an output that had other contents before. */
template <class Output>
Output decoded(roburoc4_result (*decode)(const std::uint8_t *, std::size_t, Output *),
               const std::vector<std::uint8_t> &bytes) {
    Output out;
    std::memset(&out, 0xA5, sizeof out);
    EXPECT_GE(decode(bytes.data(), bytes.size(), &out), 0);
    return out;
}

template <class Output, class Encode>
Output both_ways(roburoc4_result (*decode)(const std::uint8_t *, std::size_t, Output *),
                 Encode encode) {
    std::vector<std::uint8_t> bytes(100);
    const roburoc4_result size = encode(bytes.data(), bytes.size());
    EXPECT_GT(size, 0);
    bytes.resize(static_cast<std::size_t>(size));
    return decoded(decode, bytes);
}

} // namespace

TEST(CodecLimits, ReservedFieldsAreZero) {
    const roburoc4_directory_entry entry{5, 6};
    const auto directory =
        both_ways(roburoc4_decode_directory, [&](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_directory(b, n, 2, 0, &entry, 1);
        });
    EXPECT_EQ(0, directory.reserved);
    const roburoc4_subscription subscribed{5, 6, 0};
    const auto notification =
        both_ways(roburoc4_decode_notification, [&](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_notification(b, n, 2, 1, &subscribed, 1);
        });
    EXPECT_EQ(0, notification.reserved);
    roburoc4_subscription subscription{0, 0, 0xA5};
    const std::vector<std::uint8_t> one{2, 0x00, 1, 0, 0, 5, 0, 6};
    roburoc4_notification list = decoded(roburoc4_decode_notification, one);
    EXPECT_EQ(ROBUROC4_OK, roburoc4_notification_at(&list, 0, &subscription));
    EXPECT_EQ(0, subscription.reserved);
    const auto text = both_ways(roburoc4_decode_text, [](std::uint8_t *b, std::size_t n) {
        return roburoc4_encode_text(b, n, 2, 0, "text", 4);
    });
    EXPECT_EQ(0, text.reserved);
    const roburoc4_iocard_properties counts{1, 2, 3, 4, 5, 0};
    const auto iocard =
        both_ways(roburoc4_decode_iocard_properties, [&](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_iocard_properties(b, n, 2, &counts);
        });
    EXPECT_EQ(0, iocard.reserved);
    const auto telemeters =
        both_ways(roburoc4_decode_telemeter_properties, [](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_telemeter_properties(b, n, 2, 3, nullptr, 0);
        });
    EXPECT_EQ(0, telemeters.reserved);

    const std::array<std::uint16_t, 3> zeros{0, 0, 0};
    std::array<std::uint8_t, 32> card{};
    roburoc4_channels status;
    std::memset(&status, 0xA5, sizeof status);
    ASSERT_GT(roburoc4_encode_iocard_status(card.data(), card.size(), 2, 1, nullptr, 0, nullptr, 0),
              0);
    EXPECT_GE(roburoc4_decode_iocard_status(card.data(), card.size(), 0, 0, &status), 0);
    EXPECT_EQ(0, std::memcmp(status.reserved, zeros.data(), sizeof status.reserved));
    roburoc4_channels command;
    std::memset(&command, 0xA5, sizeof command);
    ASSERT_GT(roburoc4_encode_iocard_command(card.data(), card.size(), 2, nullptr, 0, nullptr, 0),
              0);
    EXPECT_GE(roburoc4_decode_iocard_command(card.data(), card.size(), 0, 0, &command), 0);
    EXPECT_EQ(0, std::memcmp(command.reserved, zeros.data(), sizeof command.reserved));
}

namespace {

/** Decoded, it is this and nothing else, whatever was in its memory before: no struct here has
 *  gaps. */
template <typename T, typename Decode, std::size_t size>
void expect_decoded(const T &expected, Decode decode, const std::array<std::uint8_t, size> &bytes) {
    T decoded;
    std::memset(&decoded, 0xA5, sizeof decoded);
    EXPECT_GE(decode(bytes.data(), bytes.size(), &decoded), 0);
    EXPECT_EQ(0, std::memcmp(&expected, &decoded, sizeof decoded)) << size << " bytes";
}

} // namespace

TEST(CodecLimits, ATextMayBeEmpty) {
    std::uint8_t buffer[8];
    EXPECT_EQ(5, roburoc4_encode_text(buffer, sizeof buffer, 7, 2, "", 0));
    roburoc4_text text{};
    EXPECT_EQ(ROBUROC4_OK, roburoc4_decode_text(buffer, 5, &text));
    EXPECT_EQ(0U, text.length);
}

TEST(CodecLimits, FieldsThatATelegramLacksAreZero) {
    expect_decoded(
        roburoc4_answer{7, 4, 5, 0, 0x0201, 0, nullptr, 0},
        [](const std::uint8_t *data, std::size_t size, roburoc4_answer *out) {
            const auto result = roburoc4_decode_answer(data, size, out);
            EXPECT_EQ(data + 5, out->payload);
            out->payload = nullptr;
            return result;
        },
        std::array<std::uint8_t, 5>{7, 4, 1, 2, 5});
    const std::array<std::uint8_t, 11> head{0xFF, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    expect_decoded(roburoc4_status_header{0x0A09080706050403, 0x0201, {}},
                   roburoc4_decode_status_header, head);
    expect_decoded(roburoc4_differential_command{0, 2, 0x0201, 0},
                   roburoc4_decode_differential_command,
                   std::array<std::uint8_t, 11>{0xFF, 1, 2, 0, 0, 0, 0, 0, 0, 0, 0x40});
    expect_decoded(roburoc4_battery_status{3, 2, 80, 0x0201, 0}, roburoc4_decode_battery_status,
                   std::array<std::uint8_t, 13>{0xFF, 1, 2, 3, 0, 0, 0, 0, 0, 0, 0, 2, 80});
    expect_decoded(roburoc4_localization_status{3, 0, 0, 0, 0, 0x0201, 0},
                   roburoc4_decode_localization_status,
                   std::array<std::uint8_t, 39>{0xFF, 1, 2, 3});
    expect_decoded(roburoc4_differential_status{3, 0, 0, 0, 0, 0x0201, {}},
                   roburoc4_decode_differential_status,
                   std::array<std::uint8_t, 27>{0xFF, 1, 2, 3});
    expect_decoded(
        roburoc4_telemeter_status{3, nullptr, 0, 0x0201, 0},
        [](const std::uint8_t *data, std::size_t size, roburoc4_telemeter_status *out) {
            const auto result = roburoc4_decode_telemeter_status(data, size, out);
            EXPECT_EQ(data + 11, out->distances);
            out->distances = nullptr;
            return result;
        },
        std::array<std::uint8_t, 11>{0xFF, 1, 2, 3});
    expect_decoded(roburoc4_battery_properties{0, 0, 20, 0, 0x0201},
                   roburoc4_decode_battery_properties,
                   std::array<std::uint8_t, 14>{7, 0, 1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 20});
    expect_decoded(roburoc4_localization_properties{0, 0, 0, 0, 0x0201, 0},
                   roburoc4_decode_localization_properties,
                   std::array<std::uint8_t, 33>{7, 0, 1, 2});
    roburoc4_differential_properties differential{};
    differential.service = 0x0201;
    expect_decoded(differential, roburoc4_decode_differential_properties,
                   std::array<std::uint8_t, 57>{7, 0, 1, 2});
}

TEST(Version, OfTheLibraryIsThatOfItsHeader) {
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_VERSION), roburoc4_version());
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_ABI_VERSION), roburoc4_abi_version());
}
