/* SPDX-License-Identifier: MIT
 *
 * Commands from LCM: messages from lcm-gen's encoders are read correctly; everything else that a
 * network may deliver is rejected without reading beyond it.
 */
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "commands.h"
#include "roburoc4_lcm.h"

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr double nan_ = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

template <class Message>
Bytes encoded(const Message &message, int (*size)(const Message *),
              int (*encode)(void *, int, int, const Message *)) {
    Bytes bytes(static_cast<std::size_t>(size(&message)));
    EXPECT_EQ(static_cast<int>(bytes.size()),
              encode(bytes.data(), 0, static_cast<int>(bytes.size()), &message));
    return bytes;
}

Bytes drive(std::string sender = "planner", double linear = 0.5, double angular = -0.25) {
    roburoc4_lcm_drive_command_t m{};
    m.utime = 1790000000123456;
    m.sender = sender.data();
    m.linear_m_s = linear;
    m.angular_rad_s = angular;
    m.lease_us = 250000;
    return encoded(m, roburoc4_lcm_drive_command_t_encoded_size,
                   roburoc4_lcm_drive_command_t_encode);
}

Bytes relocalize(double x = 1.5, double y = -2.5, double theta = 3.0) {
    std::string sender = "operator";
    roburoc4_lcm_relocalize_command_t m{};
    m.utime = 5;
    m.sender = sender.data();
    m.x_m = x;
    m.y_m = y;
    m.theta_rad = theta;
    return encoded(m, roburoc4_lcm_relocalize_command_t_encoded_size,
                   roburoc4_lcm_relocalize_command_t_encode);
}

Bytes outputs(std::vector<std::int32_t> index, std::vector<std::int8_t> on,
              std::vector<std::int32_t> analog_index = {}, std::vector<float> analog = {}) {
    std::string sender = "lamp";
    roburoc4_lcm_output_command_t m{};
    m.utime = 7;
    m.sender = sender.data();
    m.digital_count = static_cast<std::int32_t>(index.size());
    m.digital_index = index.data();
    m.digital_on = on.data();
    m.analog_count = static_cast<std::int32_t>(analog.size());
    m.analog_index = analog_index.data();
    m.analog_value = analog.data();
    return encoded(m, roburoc4_lcm_output_command_t_encoded_size,
                   roburoc4_lcm_output_command_t_encode);
}

Bytes stop(std::string sender) {
    roburoc4_lcm_stop_command_t m{};
    m.sender = sender.data();
    return encoded(m, roburoc4_lcm_stop_command_t_encoded_size, roburoc4_lcm_stop_command_t_encode);
}

Bytes bridge_state(std::string robot = "10.0.0.1:60000", std::string bridge = "lab 17") {
    std::string text;
    roburoc4_lcm_bridge_state_t m{};
    m.utime = 8;
    m.robot = robot.data();
    m.bridge = bridge.data();
    m.started_utime = 9;
    m.message = m.stopped_by = m.control_owner = text.data();
    m.rejected_sender = m.rejected_message = text.data();
    return encoded(m, roburoc4_lcm_bridge_state_t_encoded_size, roburoc4_lcm_bridge_state_t_encode);
}

/** Decoded from memory of exactly that size, so that a sanitizer sees each access beyond it. */
bool decode(gate_kind kind, const Bytes &bytes, command *out) {
    const Bytes exact(bytes);
    const bool good = command_decode(kind, exact.data(), exact.size(), out);
    if (good) {
        EXPECT_EQ(out->sender_length, std::string(out->sender).size());
        out->sender = "gone with the message";
    }
    return good;
}

void put_int32(Bytes *bytes, std::size_t at, std::int32_t value) {
    for (int byte = 0; byte < 4; byte++)
        (*bytes)[at + static_cast<std::size_t>(byte)] =
            static_cast<std::uint8_t>(static_cast<std::uint32_t>(value) >> (24 - 8 * byte));
}

/* The position of the sender's length: after the fingerprint and the utime. */
constexpr std::size_t sender_at = 16;

const struct {
    gate_kind kind;
    Bytes bytes;
} good_ones[] = {
    {GATE_DRIVE, drive()},
    {GATE_RELOCALIZE, relocalize()},
    {GATE_OUTPUT, outputs({1, 7}, {1, 0}, {0, 3}, {1.5F, -2.0F})},
};

} // namespace

TEST(LcmCommands, ReadWhatTheGeneratedEncodersWrite) {
    command c;
    const Bytes bytes = drive();
    ASSERT_TRUE(command_decode(GATE_DRIVE, bytes.data(), bytes.size(), &c));
    EXPECT_EQ(1790000000123456, c.utime);
    EXPECT_EQ("planner", std::string(c.sender, c.sender_length));
    EXPECT_EQ(0.5, c.linear_m_s);
    EXPECT_EQ(-0.25, c.angular_rad_s);
    EXPECT_EQ(250000, c.lease_us);

    ASSERT_TRUE(decode(GATE_RELOCALIZE, relocalize(), &c));
    EXPECT_EQ(5, c.utime);
    EXPECT_EQ(1.5, c.x_m);
    EXPECT_EQ(-2.5, c.y_m);
    EXPECT_EQ(3.0, c.theta_rad);

    ASSERT_TRUE(decode(GATE_OUTPUT, outputs({1, 7, 63}, {1, 0, 1}, {0, 3}, {1.5F, -2.0F}), &c));
    EXPECT_EQ(1ULL << 1 | 1ULL << 7 | 1ULL << 63, c.digital_mask);
    EXPECT_EQ(1ULL << 1 | 1ULL << 63, c.digital_values);
    EXPECT_FALSE(c.digital_beyond);
    ASSERT_EQ(2U, c.analog_count);
    EXPECT_EQ(3, c.analog[1].index);
    EXPECT_EQ(-2.0F, c.analog[1].value);
}

TEST(LcmCommands, AStopHasASenderOnlyWhichMayBeEmpty) {
    command c;
    for (const std::string sender : {"", "operator"}) {
        const Bytes bytes = stop(sender);
        ASSERT_TRUE(command_decode(GATE_STOP, bytes.data(), bytes.size(), &c));
        EXPECT_EQ(sender, std::string(c.sender, c.sender_length));
        EXPECT_FALSE(command_decode(GATE_STOP, bytes.data(), bytes.size() - 1, &c));
        EXPECT_FALSE(command_decode(GATE_DRIVE, bytes.data(), bytes.size(), &c));
    }
    EXPECT_FALSE(decode(GATE_STOP, drive(), &c));
}

TEST(LcmCommands, ReadWhichBridgeServesWhichRobot) {
    const Bytes bytes = bridge_state();
    bridge_identity found{};
    ASSERT_TRUE(bridge_identity_decode(bytes.data(), bytes.size(), &found));
    EXPECT_EQ(8, found.utime);
    EXPECT_EQ(9, found.started_utime);
    EXPECT_STREQ("10.0.0.1:60000", found.robot);
    EXPECT_STREQ("lab 17", found.bridge);
    for (std::size_t size = 0; size < 8 + 8 + 4 + 15 + 4 + 7 + 8; size++) {
        const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_FALSE(bridge_identity_decode(cut.data(), cut.size(), &found)) << size;
    }
    EXPECT_FALSE(bridge_identity_decode(bytes.data(), 0xFFFFFFF8U, &found));
    const Bytes other = drive();
    EXPECT_FALSE(bridge_identity_decode(other.data(), other.size(), &found));
}

TEST(LcmCommands, OfSeveralValuesForOneOutputTheLaterCounts) {
    command c;
    ASSERT_TRUE(decode(GATE_OUTPUT, outputs({2, 2, 3, 3}, {1, 0, 0, 1}), &c));
    EXPECT_EQ(1ULL << 2 | 1ULL << 3, c.digital_mask);
    EXPECT_EQ(1ULL << 3, c.digital_values);
}

TEST(LcmCommands, MarkOutputsBeyondTheClientsCapacity) {
    for (const std::int32_t index : {-1, 64, INT32_MIN, INT32_MAX}) {
        command c;
        ASSERT_TRUE(decode(GATE_OUTPUT, outputs({1, index}, {1, 1}), &c));
        EXPECT_TRUE(c.digital_beyond) << index;
    }
}

TEST(LcmCommands, RejectOtherTypesLengthsAndFingerprints) {
    command c;
    for (const auto &good : good_ones) {
        for (int kind = 0; kind < GATE_KINDS; kind++)
            EXPECT_EQ(kind == good.kind, decode(static_cast<gate_kind>(kind), good.bytes, &c));
        for (std::size_t size = 0; size < good.bytes.size(); size++)
            EXPECT_FALSE(decode(
                good.kind,
                Bytes(good.bytes.begin(), good.bytes.begin() + static_cast<std::ptrdiff_t>(size)),
                &c))
                << size;
        Bytes longer = good.bytes;
        longer.push_back(0);
        EXPECT_FALSE(decode(good.kind, longer, &c));
        for (std::size_t at = 0; at < 8; at++) {
            Bytes other = good.bytes;
            other[at] ^= 1;
            EXPECT_FALSE(decode(good.kind, other, &c)) << at;
        }
    }
}

TEST(LcmCommands, RejectStringsWithAWrongLength) {
    command c;
    for (const auto &good : good_ones) {
        for (const std::int32_t length : {INT32_MIN, -1, 0, 1, 3, 10, 1000, INT32_MAX}) {
            Bytes bytes = good.bytes;
            put_int32(&bytes, sender_at, length);
            EXPECT_FALSE(decode(good.kind, bytes, &c)) << length;
        }
    }
    Bytes unterminated = drive("planner");
    unterminated[sender_at + 4 + 7] = 'x';
    EXPECT_FALSE(decode(GATE_DRIVE, unterminated, &c));
    Bytes two_ends = drive("planner");
    two_ends[sender_at + 4 + 3] = 0;
    EXPECT_FALSE(decode(GATE_DRIVE, two_ends, &c));
    EXPECT_FALSE(decode(GATE_DRIVE, drive("latin-1 \xE9"), &c)) << "LCM's strings are UTF-8";
    EXPECT_TRUE(decode(GATE_DRIVE, drive(""), &c)) << "for the gate to judge";
    EXPECT_TRUE(decode(GATE_DRIVE, drive("é"), &c));
}

TEST(LcmCommands, RejectImpossibleSizes) {
    /* LCM passes on a packet without a channel with sizes such as -1. */
    const Bytes good = drive(std::string(3000, 's'));
    command c;
    ASSERT_TRUE(decode(GATE_DRIVE, good, &c)) << "for the gate to judge";
    EXPECT_FALSE(decode(GATE_DRIVE, drive(std::string(COMMANDS_MAX_SIZE, 's')), &c));
    Bytes lies = good;
    put_int32(&lies, sender_at, INT32_MAX);
    for (const std::uint32_t size : {0xFFFFFFFFU, 0xFFFFFFF8U, 0x80000000U, 4097U})
        EXPECT_FALSE(command_decode(GATE_DRIVE, lies.data(), size, &c)) << size;
}

TEST(LcmCommands, RejectListsWithAWrongLength) {
    const Bytes good = outputs({1}, {1}, {0}, {1.0F});
    const std::size_t digital_at = sender_at + 4 + 5;
    const std::size_t analog_at = digital_at + 4 + 4 + 1;
    command c;
    ASSERT_TRUE(decode(GATE_OUTPUT, good, &c));
    for (const std::size_t at : {digital_at, analog_at}) {
        for (const std::int32_t count : {INT32_MIN, -1, 0, 2, 64, 65, 0x40000000, INT32_MAX}) {
            Bytes bytes = good;
            put_int32(&bytes, at, count);
            EXPECT_FALSE(decode(GATE_OUTPUT, bytes, &c)) << count;
        }
    }
    EXPECT_TRUE(decode(GATE_OUTPUT,
                       outputs(std::vector<std::int32_t>(64, 5), std::vector<std::int8_t>(64, 1)),
                       &c));
    EXPECT_FALSE(decode(GATE_OUTPUT,
                        outputs(std::vector<std::int32_t>(65, 5), std::vector<std::int8_t>(65, 1)),
                        &c));
    EXPECT_FALSE(decode(
        GATE_OUTPUT,
        outputs({}, {}, std::vector<std::int32_t>(17, 0), std::vector<float>(17, 0.0F)), &c));
}

TEST(LcmCommands, SurviveAnyBytes) {
    std::mt19937 random(3);
    std::size_t taken = 0;
    for (int i = 0; i < 30000; i++) {
        const auto &good = good_ones[random() % 3];
        Bytes bytes = good.bytes;
        for (std::uint32_t changes = random() % 4; changes > 0; changes--)
            bytes[8 + random() % (bytes.size() - 8)] = static_cast<std::uint8_t>(random());
        if (random() % 4 == 0)
            bytes.resize(random() % (bytes.size() + 8));
        command c;
        if (decode(good.kind, bytes, &c)) {
            taken++;
            ASSERT_LE(c.analog_count, static_cast<std::uint32_t>(ROBUROC4_MAX_ANALOG_OUTPUTS));
            ASSERT_EQ(0U, c.digital_values & ~c.digital_mask);
        }
    }
    EXPECT_GT(taken, 1000U);
}

TEST(LcmCommands, MarkWhatIsFiniteAndWhatIsZero) {
    const struct {
        gate_kind kind;
        Bytes bytes;
        bool finite, zero;
    } cases[] = {
        {GATE_DRIVE, drive("a", 0.0, 0.0), true, true},
        {GATE_DRIVE, drive("a", -0.0, 0.0), true, true},
        {GATE_DRIVE, drive("a", 0.0, 1e-9), true, false},
        {GATE_DRIVE, drive("a", 1e308, 0.0), true, false},
        {GATE_DRIVE, drive("a", nan_, 0.0), false, false},
        {GATE_DRIVE, drive("a", 0.0, infinity), false, false},
        {GATE_DRIVE, drive("a", -infinity, 0.0), false, false},
        {GATE_RELOCALIZE, relocalize(0, 0, 0), true, false},
        {GATE_RELOCALIZE, relocalize(nan_, 0, 0), false, false},
        {GATE_RELOCALIZE, relocalize(0, infinity, 0), false, false},
        {GATE_RELOCALIZE, relocalize(0, 0, -infinity), false, false},
        {GATE_OUTPUT, outputs({1}, {1}), true, false},
        {GATE_OUTPUT, outputs({}, {}, {0}, {static_cast<float>(nan_)}), false, false},
        {GATE_OUTPUT, outputs({}, {}, {0, 1}, {0.0F, static_cast<float>(infinity)}), false, false},
    };
    for (const auto &each : cases) {
        command c;
        ASSERT_TRUE(decode(each.kind, each.bytes, &c));
        const gate_command for_gate = command_for_gate(&c, 99);
        EXPECT_EQ(each.finite, for_gate.finite);
        EXPECT_EQ(each.zero, for_gate.zero);
        EXPECT_EQ(99, for_gate.arrived_utime);
        EXPECT_EQ(c.utime, for_gate.utime);
        EXPECT_EQ(c.lease_us, for_gate.lease_us);
    }
}

TEST(LcmCommands, MovesAreReadCompletelyOrNotAtAll) {
    std::string sender = "planner";
    roburoc4_lcm_move_command_t m{};
    m.utime = 11;
    m.sender = sender.data();
    m.move_id = -12;
    m.kind = ROBUROC4_LCM_MOVE_COMMAND_T_KIND_TO_POSE;
    double *const numbers[] = {&m.distance_m,
                               &m.angle_rad,
                               &m.x_m,
                               &m.y_m,
                               &m.theta_rad,
                               &m.max_linear_m_s,
                               &m.max_angular_rad_s,
                               &m.max_linear_m_s2,
                               &m.max_angular_rad_s2,
                               &m.clearance_m};
    double next = 1.5;
    for (double *number : numbers)
        *number = next++;
    m.timeout_ms = 14;
    m.allow_turns = 1;
    m.lease_us = 13;
    const auto bytes = [&] {
        return encoded(m, roburoc4_lcm_move_command_t_encoded_size,
                       roburoc4_lcm_move_command_t_encode);
    };
    const Bytes good = bytes();
    command c;
    ASSERT_TRUE(command_decode_move(good.data(), good.size(), &c));
    EXPECT_EQ(GATE_DRIVE, c.kind);
    EXPECT_TRUE(c.is_move);
    EXPECT_EQ(11, c.utime);
    EXPECT_EQ("planner", std::string(c.sender, c.sender_length));
    EXPECT_EQ(-12, c.move_id);
    EXPECT_EQ(2, c.move_kind);
    EXPECT_EQ(13, c.lease_us);
    EXPECT_EQ(14, c.timeout_ms);
    EXPECT_TRUE(c.allow_turns);
    const double read[] = {c.distance_m,         c.angle_rad,  c.x_m,           c.y_m,
                           c.theta_rad,          c.linear_m_s, c.angular_rad_s, c.max_linear_m_s2,
                           c.max_angular_rad_s2, c.clearance_m};
    for (std::size_t at = 0; at < std::size(read); at++)
        EXPECT_EQ(1.5 + static_cast<double>(at), read[at]) << at;
    for (std::size_t size = 0; size < good.size(); size++)
        EXPECT_FALSE(command_decode_move(good.data(), size, &c)) << size;
    Bytes longer = good;
    longer.push_back(0);
    EXPECT_FALSE(command_decode_move(longer.data(), longer.size(), &c));
    EXPECT_FALSE(decode(GATE_DRIVE, good, &c));
    const Bytes speed = drive();
    EXPECT_FALSE(command_decode_move(speed.data(), speed.size(), &c));
    for (double *number : numbers) {
        const double before = *number;
        for (const double bad : {nan_, infinity, -infinity}) {
            *number = bad;
            const Bytes wrong = bytes();
            ASSERT_TRUE(command_decode_move(wrong.data(), wrong.size(), &c));
            EXPECT_FALSE(command_for_gate(&c, 0).finite);
        }
        *number = before;
    }
    for (double *number : numbers)
        *number = 0;
    const Bytes nowhere = bytes();
    ASSERT_TRUE(command_decode_move(nowhere.data(), nowhere.size(), &c));
    EXPECT_FALSE(command_for_gate(&c, 0).zero) << "it asks to drive all the same";
    sender.assign(COMMANDS_MAX_SIZE, 's');
    m.sender = sender.data();
    longer = bytes();
    EXPECT_FALSE(command_decode_move(longer.data(), longer.size(), &c));
}

/** Beyond every ceiling it stays, so that it is refused, and never changes its direction. */
TEST(LcmCommands, AHugeSpeedKeepsItsDirection) {
    EXPECT_EQ(1e6F, command_speed(1e300));
    EXPECT_EQ(-1e6F, command_speed(-1e300));
    EXPECT_EQ(-0.25F, command_speed(-0.25));
}
