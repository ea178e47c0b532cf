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
    move(v.robot_cycles);
    if constexpr (requires { v.analog; }) {
        move(v.analog);
        move(v.digital);
    } else {
        move(v.target_linear_m_s);
        move(v.current_linear_m_s);
        move(v.target_angular_rad_s);
        move(v.current_angular_rad_s);
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
            of<differential_values, fill_differential>("differential")};
}
