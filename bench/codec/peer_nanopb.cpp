/* SPDX-License-Identifier: MIT
 *
 * nanopb: protocol buffers in C, with the tables that its generator writes from statuses.proto.
 */
#include "messages.h"

#include "statuses.pb.h"
#include <pb_decode.h>
#include <pb_encode.h>

namespace {

template <class T, void (*fill)(T &), const pb_msgdesc_t *fields>
message_codec of(const char *message) {
    using mine = values<T, fill>;
    return {message, "nanopb",
            [](uint8_t *buffer, size_t capacity) -> size_t {
                pb_ostream_t stream = pb_ostream_from_buffer(buffer, capacity);
                return pb_encode(&stream, fields, &mine::sent()) ? stream.bytes_written : 0;
            },
            [](const uint8_t *wire, size_t size) {
                pb_istream_t stream = pb_istream_from_buffer(wire, size);
                return pb_decode(&stream, fields, &mine::received());
            },
            mine::intact};
}

} // namespace

message_codecs nanopb_codecs() {
    return {of<peer_iocard, fill_iocard, &peer_iocard_msg>("iocard"),
            of<peer_differential, fill_differential, &peer_differential_msg>("differential")};
}
