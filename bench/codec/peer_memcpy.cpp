/* SPDX-License-Identifier: MIT
 *
 * The limit: the robot's bytes moved by hand with memcpy, nothing checked, on a little-endian host.
 */
#include "messages.h"
#include "own_messages.h"

namespace {

/** Walks over a telegram, a field at a time; the offsets are known to the compiler. */
struct mover {
    uint8_t *to;
    const uint8_t *from;
    size_t at = 0;
    template <class T> void get(T &field) {
        std::memcpy(&field, from + at, sizeof field);
        at += sizeof field;
    }
    template <class T> void put(const T &field) {
        std::memcpy(to + at, &field, sizeof field);
        at += sizeof field;
    }
};

/* Which fields there are, once for both directions: `move` puts or gets one. */
template <class V, class F> void body(V &v, F move) {
    if constexpr (requires { v.robot_cycles; }) {
        move(v.robot_cycles);
    }
    if constexpr (requires { v.analog; }) {
        move(v.analog);
        move(v.digital);
    } else if constexpr (requires { v.distance_m; }) {
        move(v.distance_m);
    } else if constexpr (requires { v.remaining_percent; }) {
        move(v.state);
        move(v.remaining_percent);
    } else if constexpr (requires { v.x_m; }) {
        move(v.x_m);
        move(v.y_m);
        move(v.theta_rad);
        move(v.flags);
    } else if constexpr (requires { v.target_linear_m_s; }) {
        move(v.target_linear_m_s);
        move(v.current_linear_m_s);
        move(v.target_angular_rad_s);
        move(v.current_angular_rad_s);
    } else {
        move(v.linear_m_s);
        move(v.angular_rad_s);
    }
}

template <class T, void (*fill)(T &)> message_codec of(const char *message) {
    using mine = values<T, fill>;
    return {message, "memcpy",
            [](uint8_t *buffer, size_t) -> size_t {
                mover m{buffer, nullptr};
                m.put(uint8_t{0xFF});
                m.put(mine::sent().service);
                body(mine::sent(), [&m](const auto &field) { m.put(field); });
                return m.at;
            },
            [](const uint8_t *wire, size_t) {
                mover m{nullptr, wire, 1};
                m.get(mine::received().service);
                body(mine::received(), [&m](auto &field) { m.get(field); });
                return true;
            },
            mine::intact};
}

} // namespace

message_codecs memcpy_codecs() {
    return {of<iocard_values, fill_iocard>("iocard"),
            of<telemeter_values, fill_telemeter>("telemeter"),
            of<battery_values, fill_battery>("battery"),
            of<localization_values, fill_localization>("localization"),
            of<differential_values, fill_differential>("differential"),
            of<drive_values, fill_drive>("drive")};
}
