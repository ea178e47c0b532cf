/* SPDX-License-Identifier: MIT
 *
 * wire.h - telegrams byte by byte, as the robot's manual prints them (sections 4.2.2 to 4.2.6). On
 * purpose not the project's codec: what judges the client shares no code with it.
 */
#ifndef ROBUROC4_SOAK_WIRE_H
#define ROBUROC4_SOAK_WIRE_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace soak {

constexpr std::uint8_t action_get = 0;
constexpr std::uint8_t action_query = 1;
constexpr std::uint8_t action_replace = 2;
constexpr std::uint8_t action_insert = 4;
constexpr std::uint8_t action_delete = 5;
constexpr std::uint8_t header_error = 0x00;
constexpr std::uint8_t header_literal = 0x01;
constexpr std::uint8_t header_status = 0xFF;
constexpr std::uint8_t digital_input_type = 2;
constexpr std::uint64_t cycle_us = 10000;

/* The services with statuses, in the manual's order. */
constexpr int iocard = 0, telemeter = 1, battery = 2, localization = 3, differential = 4;

/** What only the simulation knows of a datagram. */
struct Origin {
    enum class Kind : std::uint8_t {
        other, /* a request, a command, or an answer that nothing below names */
        status,
        differential_status,
        iocard_status,
        iocard_properties,
        differential_properties,
        input_text,    /* the text of digital input `index` */
        input_refusal, /* the robot refused to give it */
        replaced,      /* the answer to REPLACE */
    };
    Kind kind = Kind::other;
    std::int32_t index = 0; /* of the input; of a status: of its service, iocard to differential */
    std::uint32_t boot = 0; /* counts the robot's starts; another robot is another start */
    std::uint64_t made_us = 0;  /* true time at which it was made */
    std::uint64_t asked_us = 0; /* of an answer: when its request was sent */
    bool others_target = false; /* of a status: somebody else set the target */
    bool pad_a = false;         /* of a status: [A] was held */
    bool healthy = false;       /* of a status: the robot follows its target */
};

struct Datagram {
    std::array<std::uint8_t, 256> bytes{};
    std::size_t size = 0;
    Origin origin;

    void u8(std::uint8_t value) {
        if (size < bytes.size())
            bytes[size++] = value;
    }
    void u16(std::uint16_t value) {
        u8(static_cast<std::uint8_t>(value));
        u8(static_cast<std::uint8_t>(value >> 8));
    }
    void u32(std::uint32_t value) {
        u16(static_cast<std::uint16_t>(value));
        u16(static_cast<std::uint16_t>(value >> 16));
    }
    void u64(std::uint64_t value) {
        u32(static_cast<std::uint32_t>(value));
        u32(static_cast<std::uint32_t>(value >> 32));
    }
    void f32(float value) {
        std::uint32_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        u32(bits);
    }
    void f64(double value) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        u64(bits);
    }

    std::uint8_t u8_at(std::size_t at) const {
        return at < size ? bytes[at] : std::uint8_t{0};
    }
    std::uint16_t u16_at(std::size_t at) const {
        return static_cast<std::uint16_t>(u8_at(at) | u8_at(at + 1) << 8);
    }
    std::uint32_t u32_at(std::size_t at) const {
        return u16_at(at) | static_cast<std::uint32_t>(u16_at(at + 2)) << 16;
    }
    std::uint64_t u64_at(std::size_t at) const {
        return u32_at(at) | static_cast<std::uint64_t>(u32_at(at + 4)) << 32;
    }
    float f32_at(std::size_t at) const {
        const std::uint32_t bits = u32_at(at);
        float value = 0;
        std::memcpy(&value, &bits, sizeof value);
        return value;
    }
    void put_f32_at(std::size_t at, float value) {
        std::memcpy(bytes.data() + at, &value, sizeof value); /* little-endian hosts only */
    }
};

/** Speeds of a differential command: v in m/s, w in rad/s. */
struct Speeds {
    float v = 0;
    float w = 0;
    bool zero() const {
        return v == 0 && w == 0;
    }
};

/** `FF service v w` is the only command of 11 bytes that a client sends to the differential
 *  service; its status has 27 bytes: `FF service stamp u64, target v, v, target w, w`. */
inline bool is_command(const Datagram &datagram) {
    return datagram.size > 0 && datagram.bytes[0] == header_status;
}
inline bool is_speed_command(const Datagram &datagram) {
    return is_command(datagram) && datagram.size == 11;
}
inline Speeds command_speeds(const Datagram &datagram) {
    return {datagram.f32_at(3), datagram.f32_at(7)};
}

inline bool is_status(const Datagram &datagram) {
    return datagram.origin.kind == Origin::Kind::status ||
           datagram.origin.kind == Origin::Kind::differential_status ||
           datagram.origin.kind == Origin::Kind::iocard_status;
}

inline std::size_t digital_blocks(std::int32_t count) {
    return count <= 0 ? 0 : static_cast<std::size_t>((count - 1) / 8 + 1);
}

} // namespace soak

#endif
