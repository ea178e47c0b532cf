/* SPDX-License-Identifier: MIT
 *
 * LCM's C code, as lcm-gen writes it from statuses.lcm.
 */
#include "messages.h"

extern "C" {
#include "peer_differential_t.h"
#include "peer_iocard_t.h"
}

namespace {

template <class T, void (*fill)(T &), int (*write)(void *, int, int, const T *),
          int (*read)(const void *, int, int, T *)>
message_codec of(const char *message) {
    using mine = values<T, fill>;
    return {message, "LCM",
            [](uint8_t *buffer, size_t capacity) {
                return static_cast<size_t>(
                    write(buffer, 0, static_cast<int>(capacity), &mine::sent()));
            },
            [](const uint8_t *wire, size_t size) {
                return read(wire, 0, static_cast<int>(size), &mine::received()) ==
                       static_cast<int>(size);
            },
            mine::intact};
}

} // namespace

message_codecs lcm_codecs() {
    return {of<peer_iocard_t, fill_iocard, peer_iocard_t_encode, peer_iocard_t_decode>("iocard"),
            of<peer_differential_t, fill_differential, peer_differential_t_encode,
               peer_differential_t_decode>("differential")};
}
