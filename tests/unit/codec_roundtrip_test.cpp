/* SPDX-License-Identifier: MIT
 *
 * codec_roundtrip_test.cpp - encoding and decoding preserves every bit, for seeded random values of
 * every telegram, including extreme integers, NaN payloads, infinities, denormals and minus zero.
 */
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "hex.h"
#include "roburoc4.h"
#include "telegrams.h"

using namespace roburoc4_tests;

namespace {

constexpr int rounds = 400;

/** Random values, every second of them an edge of its type. */
class Source {
  public:
    explicit Source(std::uint64_t seed) : random_(seed) {}
    template <class T> T integer() {
        const T edges[] = {std::numeric_limits<T>::min(), std::numeric_limits<T>::max(),
                           static_cast<T>(std::numeric_limits<T>::max() / 2), 1, 0};
        return edge() ? pick(edges) : static_cast<T>(random_());
    }
    std::uint8_t request_id() {
        return static_cast<std::uint8_t>(1 + random_() % 254);
    }
    std::int32_t count() {
        const std::int32_t value = integer<std::int32_t>();
        return value < 0 ? ~value : value;
    }
    float real32() {
        using F = std::numeric_limits<float>;
        const float edges[] = {0.0F,        -0.0F,    F::infinity(),   -F::infinity(),  F::max(),
                               F::lowest(), F::min(), F::denorm_min(), -F::denorm_min()};
        if (edge())
            return pick(edges);
        auto bits = static_cast<std::uint32_t>(random_());
        if (random_() % 4 == 0) // all bits of a NaN, quiet: passing by value may quieten it
            bits |= 0x7FC00000U;
        else if ((bits & 0x7F800000U) == 0x7F800000U)
            bits |= 0x00400000U;
        return from_bits<float>(bits);
    }
    double real64() {
        using D = std::numeric_limits<double>;
        const double edges[] = {0.0,         -0.0,     D::infinity(),   -D::infinity(),  D::max(),
                                D::lowest(), D::min(), D::denorm_min(), -D::denorm_min()};
        if (edge())
            return pick(edges);
        std::uint64_t bits = random_();
        if (random_() % 4 == 0)
            bits |= 0x7FF8000000000000U;
        else if ((bits & 0x7FF0000000000000U) == 0x7FF0000000000000U)
            bits |= 0x0008000000000000U;
        return from_bits<double>(bits);
    }
    std::size_t up_to(std::size_t most) {
        return static_cast<std::size_t>(random_() % (most + 1));
    }

  private:
    bool edge() {
        return random_() % 2 == 0;
    }
    template <class T, std::size_t n> T pick(const T (&values)[n]) {
        return values[random_() % n];
    }
    template <class F, class B> static F from_bits(B bits) {
        static_assert(sizeof(F) == sizeof(B), "same size");
        F value;
        std::memcpy(&value, &bits, sizeof value);
        return value;
    }
    std::mt19937_64 random_;
};

/** The bytes of a value in memory, as hex. */
template <class T> std::string raw(const T &value) {
    Bytes bytes(sizeof(T));
    std::memcpy(bytes.data(), &value, sizeof(T));
    return to_hex(bytes);
}

/** Same bits, so that a NaN equals itself and 0 differs from -0. */
template <class T>::testing::AssertionResult same(const T &a, const T &b) {
    if (raw(a) == raw(b))
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << raw(a) << " is not " << raw(b);
}

/** The telegram that an encoder writes, in a block of exactly its length. */
template <class Encode> ExactBlock telegram(Encode encode) {
    Bytes buffer(4096);
    const roburoc4_result length = encode(buffer.data(), buffer.size());
    EXPECT_GT(length, 0) << roburoc4_result_text(length);
    buffer.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
    return ExactBlock(buffer);
}

/** Encodes a struct, decodes it, and compares all of it: padding is named in these structs. */
template <class Value, class Encode, class Decode>
void check_struct(const Value &value, Encode encode, Decode decode) {
    ExactBlock wire =
        telegram([&](std::uint8_t *b, std::size_t n) { return encode(b, n, &value); });
    Value back;
    std::memset(&back, 0xA5, sizeof back);
    ASSERT_EQ(0, decode(wire.data(), wire.size(), &back));
    EXPECT_TRUE(same(value, back));
}

roburoc4_request decoded(ExactBlock &wire) {
    roburoc4_request out{};
    EXPECT_EQ(0, roburoc4_decode_request(wire.data(), wire.size(), &out));
    return out;
}

TEST(RoundTrip, Requests) {
    Source source(1);
    for (int round = 0; round < rounds; round++) {
        const std::uint8_t id = source.request_id();
        const auto service = source.integer<std::uint16_t>();
        const auto index16 = source.integer<std::uint16_t>();
        ExactBlock get = telegram([&](auto *b, auto n) { return encode_get(b, n, id, service); });
        roburoc4_request out = decoded(get);
        EXPECT_EQ(id, out.id);
        EXPECT_EQ(ROBUROC4_ACTION_GET, out.action);
        EXPECT_EQ(service, out.service);
        ExactBlock query =
            telegram([&](auto *b, auto n) { return encode_query_directory(b, n, id, index16); });
        out = decoded(query);
        EXPECT_EQ(id, out.id);
        EXPECT_EQ(ROBUROC4_ACTION_QUERY, out.action);
        EXPECT_EQ(index16, out.index);
        const auto period = static_cast<std::uint8_t>(1 + source.up_to(254));
        ExactBlock insert =
            telegram([&](auto *b, auto n) { return encode_insert(b, n, id, service, period); });
        out = decoded(insert);
        EXPECT_EQ(ROBUROC4_ACTION_INSERT, out.action);
        EXPECT_EQ(service, out.subject);
        EXPECT_EQ(period, out.period_cycles);
        ExactBlock del =
            telegram([&](auto *b, auto n) { return encode_delete(b, n, id, service); });
        out = decoded(del);
        EXPECT_EQ(ROBUROC4_ACTION_DELETE, out.action);
        EXPECT_EQ(service, out.subject);
    }
}

TEST(RoundTrip, QueriesOfTheCard) {
    Source source(2);
    for (int round = 0; round < rounds; round++) {
        const std::uint8_t id = source.request_id();
        const auto service = static_cast<std::uint16_t>(1 + source.up_to(0xFFFE));
        const auto io_type = static_cast<std::uint8_t>(source.up_to(3));
        const std::int32_t index = source.count();
        ExactBlock wire = telegram([&](auto *b, auto n) {
            return encode_query_iocard(b, n, id, service, io_type, index);
        });
        const roburoc4_request out = decoded(wire);
        EXPECT_EQ(id, out.id);
        EXPECT_EQ(ROBUROC4_ACTION_QUERY, out.action);
        EXPECT_EQ(service, out.service);
        EXPECT_EQ(io_type, out.io_type);
        EXPECT_EQ(index, out.index);
    }
}

TEST(RoundTrip, Replace) {
    Source source(3);
    for (int round = 0; round < rounds; round++) {
        const std::uint8_t id = source.request_id();
        const auto service = source.integer<std::uint16_t>();
        const auto timestamp = source.integer<std::uint64_t>();
        const double x = source.real64(), y = source.real64(), theta = source.real64();
        ExactBlock wire = telegram([&](auto *b, auto n) {
            return encode_replace_localization(b, n, id, service, timestamp, x, y, theta);
        });
        const roburoc4_request out = decoded(wire);
        EXPECT_EQ(id, out.id);
        EXPECT_EQ(service, out.service);
        EXPECT_EQ(timestamp, out.timestamp);
        EXPECT_TRUE(same(x, out.x_m));
        EXPECT_TRUE(same(y, out.y_m));
        EXPECT_TRUE(same(theta, out.theta_rad));
    }
}

TEST(RoundTrip, AnswersWithAnyError) {
    Source source(4);
    for (int round = 0; round < rounds; round++) {
        const auto id = static_cast<std::uint8_t>(source.up_to(254));
        const auto action = source.integer<std::uint8_t>();
        const auto service = source.integer<std::uint16_t>();
        const auto error = source.integer<std::uint8_t>();
        ExactBlock wire = telegram([&](auto *b, auto n) {
            return roburoc4_encode_answer(b, n, id, action, service, error);
        });
        roburoc4_answer out{};
        ASSERT_EQ(0, roburoc4_decode_answer(wire.data(), wire.size(), &out));
        EXPECT_EQ(id, out.id);
        EXPECT_EQ(action, out.action);
        EXPECT_EQ(service, out.service);
        EXPECT_EQ(error, out.error);
        EXPECT_EQ(0u, out.payload_size);
    }
}

TEST(RoundTrip, DirectoryOfAnyLength) {
    Source source(5);
    for (int round = 0; round < rounds; round++) {
        std::vector<roburoc4_directory_entry> entries(source.up_to(100));
        for (auto &entry : entries)
            entry = {source.integer<std::uint16_t>(), source.integer<std::uint16_t>()};
        const std::uint8_t id = source.request_id();
        const auto service = source.integer<std::uint16_t>();
        ExactBlock wire = telegram([&](auto *b, auto n) {
            return roburoc4_encode_directory(b, n, id, service, entries.data(), entries.size());
        });
        EXPECT_EQ(id, wire.data()[0]);
        roburoc4_directory out{};
        ASSERT_EQ(0, roburoc4_decode_directory(wire.data(), wire.size(), &out));
        EXPECT_EQ(service, out.service);
        ASSERT_EQ(entries.size(), out.count);
        for (std::uint32_t i = 0; i < out.count; i++) {
            roburoc4_directory_entry entry{};
            ASSERT_EQ(0, roburoc4_directory_at(&out, i, &entry));
            EXPECT_TRUE(same(entries[i], entry));
        }
    }
}

TEST(RoundTrip, NotificationOfAnyLength) {
    Source source(6);
    for (int round = 0; round < rounds; round++) {
        std::vector<roburoc4_subscription> entries(source.up_to(100));
        for (auto &entry : entries)
            entry = {source.integer<std::uint16_t>(), source.integer<std::uint8_t>(), 0};
        const auto service = source.integer<std::uint16_t>();
        ExactBlock wire = telegram([&](auto *b, auto n) {
            return roburoc4_encode_notification(b, n, 1, service, entries.data(), entries.size());
        });
        roburoc4_notification out{};
        ASSERT_EQ(0, roburoc4_decode_notification(wire.data(), wire.size(), &out));
        EXPECT_EQ(service, out.service);
        ASSERT_EQ(entries.size(), out.count);
        for (std::uint32_t i = 0; i < out.count; i++) {
            roburoc4_subscription entry{};
            ASSERT_EQ(0, roburoc4_notification_at(&out, i, &entry));
            EXPECT_EQ(entries[i].service, entry.service);
            EXPECT_EQ(entries[i].period_cycles, entry.period_cycles);
        }
    }
}

TEST(RoundTrip, TelemeterPropertiesOfAnyLength) {
    Source source(7);
    for (int round = 0; round < rounds; round++) {
        std::vector<roburoc4_telemeter> telemeters(source.up_to(40));
        for (auto &t : telemeters)
            t = {source.real32(), source.real32(), source.real32(), source.real32(),
                 source.real32(), source.real32(), source.real32()};
        const auto service = source.integer<std::uint16_t>();
        ExactBlock wire = telegram([&](auto *b, auto n) {
            return roburoc4_encode_telemeter_properties(b, n, 1, service, telemeters.data(),
                                                        telemeters.size());
        });
        roburoc4_telemeter_list out{};
        ASSERT_EQ(0, roburoc4_decode_telemeter_properties(wire.data(), wire.size(), &out));
        EXPECT_EQ(service, out.service);
        ASSERT_EQ(telemeters.size(), out.count);
        for (std::uint32_t i = 0; i < out.count; i++) {
            roburoc4_telemeter telemeter{};
            ASSERT_EQ(0, roburoc4_telemeter_at(&out, i, &telemeter));
            EXPECT_TRUE(same(telemeters[i], telemeter));
        }
    }
}

TEST(RoundTrip, PropertiesOfFixedSize) {
    Source source(8);
    for (int round = 0; round < rounds; round++) {
        const std::uint8_t id = source.request_id();
        const auto under_id = [id](auto encode) {
            return [id, encode](std::uint8_t *b, std::size_t n, const auto *value) {
                return encode(b, n, id, value);
            };
        };
        const auto service = source.integer<std::uint16_t>();
        check_struct<roburoc4_iocard_properties>(
            {source.count(), source.count(), source.count(), source.count(), service, 0},
            under_id(roburoc4_encode_iocard_properties), roburoc4_decode_iocard_properties);
        check_struct<roburoc4_battery_properties>(
            {source.real32(), source.real32(), source.integer<std::uint8_t>(), 0, service},
            under_id(roburoc4_encode_battery_properties), roburoc4_decode_battery_properties);
        check_struct<roburoc4_localization_properties>(
            {source.real64(), source.real64(), source.real64(), source.integer<std::uint32_t>(),
             service, 0},
            under_id(roburoc4_encode_localization_properties),
            roburoc4_decode_localization_properties);
        check_struct<roburoc4_differential_properties>(
            {source.real32(), source.real32(), source.real32(), source.real32(), source.real32(),
             source.real32(), source.real32(), source.real32(), source.real32(), source.real32(),
             source.real32(), source.real32(), source.real32(), service, 0},
            under_id(roburoc4_encode_differential_properties),
            roburoc4_decode_differential_properties);
    }
}

TEST(RoundTrip, TextsOfAnyBytes) {
    Source source(9);
    for (int round = 0; round < rounds; round++) {
        std::string text(source.up_to(300), '\0');
        for (char &c : text)
            c = static_cast<char>(source.integer<std::uint8_t>());
        const auto service = source.integer<std::uint16_t>();
        ExactBlock wire = telegram([&](auto *b, auto n) {
            return roburoc4_encode_text(b, n, 7, service, text.data(), text.size());
        });
        roburoc4_text out{};
        ASSERT_EQ(0, roburoc4_decode_text(wire.data(), wire.size(), &out));
        EXPECT_EQ(service, out.service);
        EXPECT_EQ(text, std::string(reinterpret_cast<const char *>(out.text), out.length));
    }
}

TEST(RoundTrip, StatusesOfFixedSize) {
    Source source(10);
    for (int round = 0; round < rounds; round++) {
        const auto service = source.integer<std::uint16_t>();
        const auto cycles = source.integer<std::uint64_t>();
        check_struct<roburoc4_battery_status>(
            {cycles, source.integer<std::uint8_t>(), source.integer<std::uint8_t>(), service, 0},
            roburoc4_encode_battery_status, roburoc4_decode_battery_status);
        check_struct<roburoc4_localization_status>(
            {cycles, source.real64(), source.real64(), source.real64(),
             source.integer<std::uint32_t>(), service, 0},
            roburoc4_encode_localization_status, roburoc4_decode_localization_status);
        check_struct<roburoc4_differential_status>({cycles,
                                                    source.real32(),
                                                    source.real32(),
                                                    source.real32(),
                                                    source.real32(),
                                                    service,
                                                    {0, 0, 0}},
                                                   roburoc4_encode_differential_status,
                                                   roburoc4_decode_differential_status);
    }
}

TEST(RoundTrip, TelemeterStatusOfAnyLength) {
    Source source(11);
    for (int round = 0; round < rounds; round++) {
        std::vector<float> distances(source.up_to(100));
        for (float &distance : distances)
            distance = source.real32();
        const auto service = source.integer<std::uint16_t>();
        const auto cycles = source.integer<std::uint64_t>();
        ExactBlock wire = telegram([&](auto *b, auto n) {
            return roburoc4_encode_telemeter_status(b, n, service, cycles, distances.data(),
                                                    distances.size());
        });
        roburoc4_telemeter_status out{};
        ASSERT_EQ(0, roburoc4_decode_telemeter_status(wire.data(), wire.size(), &out));
        EXPECT_EQ(service, out.service);
        EXPECT_EQ(cycles, out.robot_cycles);
        ASSERT_EQ(distances.size(), out.count);
        for (std::uint32_t i = 0; i < out.count; i++) {
            float value = 0;
            ASSERT_EQ(0, distance_at(&out, i, &value));
            EXPECT_TRUE(same(distances[i], value));
        }
    }
}

/** Channels of an IO card, in the form that the encoders take. */
struct Channels {
    std::vector<float> analog;
    std::uint32_t digital;
    std::vector<std::uint8_t> blocks;
};

Channels random_channels(Source &source) {
    Channels channels{};
    channels.analog.resize(source.up_to(40));
    for (float &value : channels.analog)
        value = source.real32();
    channels.digital = static_cast<std::uint32_t>(source.up_to(100));
    channels.blocks.resize((channels.digital + 7) / 8);
    for (std::uint8_t &block : channels.blocks)
        block = source.integer<std::uint8_t>();
    return channels;
}

/** Compares what the accessors return with what was sent. */
template <class View, class Analog, class Digital>
void check_channels(const Channels &sent, const View &view, Analog analog_at, Digital digital_at) {
    for (std::uint32_t i = 0; i < sent.analog.size(); i++) {
        float value = 0;
        ASSERT_EQ(0, analog_at(&view, i, &value));
        EXPECT_TRUE(same(sent.analog[i], value));
    }
    for (std::uint32_t i = 0; i < sent.digital; i++)
        EXPECT_EQ(sent.blocks[i / 8] >> (i % 8) & 1, digital_at(&view, i)) << i;
}

TEST(RoundTrip, StatusesAndCommandsOfAnyCard) {
    Source source(12);
    for (int round = 0; round < rounds; round++) {
        const Channels sent = random_channels(source);
        const auto analog = static_cast<std::uint32_t>(sent.analog.size());
        const auto service = source.integer<std::uint16_t>();
        const auto cycles = source.integer<std::uint64_t>();
        ExactBlock status_wire = telegram([&](auto *b, auto n) {
            return roburoc4_encode_iocard_status(b, n, service, cycles, sent.analog.data(), analog,
                                                 sent.blocks.data(), sent.digital);
        });
        roburoc4_channels status{};
        ASSERT_EQ(0, roburoc4_decode_iocard_status(status_wire.data(), status_wire.size(), analog,
                                                   sent.digital, &status));
        EXPECT_EQ(service, status.service);
        EXPECT_EQ(cycles, status.robot_cycles);
        check_channels(sent, status, analog_at, digital_at);

        ExactBlock command_wire = telegram([&](auto *b, auto n) {
            return roburoc4_encode_iocard_command(b, n, service, sent.analog.data(), analog,
                                                  sent.blocks.data(), sent.digital);
        });
        roburoc4_channels command{};
        ASSERT_EQ(0, roburoc4_decode_iocard_command(command_wire.data(), command_wire.size(),
                                                    analog, sent.digital, &command));
        EXPECT_EQ(service, command.service);
        check_channels(sent, command, analog_at, digital_at);
    }
}

TEST(RoundTrip, DifferentialCommands) {
    Source source(13);
    for (int round = 0; round < rounds; round++) {
        const auto service = source.integer<std::uint16_t>();
        const float linear = source.real32(), angular = source.real32();
        ExactBlock wire = telegram([&](auto *b, auto n) {
            return roburoc4_encode_differential_command(b, n, service, linear, angular);
        });
        roburoc4_differential_command out{};
        ASSERT_EQ(0, roburoc4_decode_differential_command(wire.data(), wire.size(), &out));
        EXPECT_EQ(service, out.service);
        EXPECT_TRUE(same(linear, out.linear_m_s));
        EXPECT_TRUE(same(angular, out.angular_rad_s));
    }
}

} // namespace
