/* SPDX-License-Identifier: MIT
 *
 * MAVLink 2: the C headers that mavgen writes from statuses.xml. They also frame a message and
 * compute its checksum, and their parser takes it byte by byte, as from a serial line.
 */
#include "messages.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Waddress-of-packed-member"
#include "statuses/mavlink.h"
#pragma GCC diagnostic pop

namespace {

template <class T, void (*fill)(T &),
          uint16_t (*pack)(uint8_t, uint8_t, mavlink_message_t *, const T *),
          void (*unpack)(const mavlink_message_t *, T *)>
message_codec of(const char *message) {
    using mine = values<T, fill>;
    return {message, "MAVLink",
            [](uint8_t *buffer, size_t) -> size_t {
                mavlink_message_t framed;
                pack(1, 1, &framed, &mine::sent());
                return mavlink_msg_to_send_buffer(buffer, &framed);
            },
            [](const uint8_t *wire, size_t size) {
                mavlink_message_t framed;
                mavlink_status_t status;
                for (size_t i = 0; i < size; i++) {
                    if (mavlink_parse_char(MAVLINK_COMM_0, wire[i], &framed, &status) != 0) {
                        unpack(&framed, &mine::received());
                        return true;
                    }
                }
                return false;
            },
            mine::intact};
}

} // namespace

message_codecs mavlink_codecs() {
    return {of<mavlink_iocard_t, fill_iocard, mavlink_msg_iocard_encode, mavlink_msg_iocard_decode>(
                "iocard"),
            of<mavlink_differential_t, fill_differential, mavlink_msg_differential_encode,
               mavlink_msg_differential_decode>("differential")};
}
