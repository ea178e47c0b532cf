/* SPDX-License-Identifier: MIT
 *
 * roburoc4's own codec. Lists are views on the datagram: their values are copied out, as the other
 * peers do in decoding.
 */
#include "messages.h"
#include "own_messages.h"

#include "roburoc4.h"

namespace {

using iocard = values<iocard_values, fill_iocard>;
using differential = values<roburoc4_differential_status, fill_differential>;

size_t length(roburoc4_result result) {
    return result > 0 ? static_cast<size_t>(result) : 0;
}

size_t encode_iocard(uint8_t *buffer, size_t capacity) {
    const iocard_values &v = iocard::sent();
    return length(roburoc4_encode_iocard_status(buffer, capacity, v.service, v.robot_cycles,
                                                v.analog, 9, v.digital, 22));
}

bool decode_iocard(const uint8_t *wire, size_t size) {
    iocard_values &v = iocard::received();
    roburoc4_channels status;
    if (roburoc4_decode_iocard_status(wire, size, 9, 22, &status) != 0) {
        return false;
    }
    v.service = status.service;
    v.robot_cycles = status.robot_cycles;
    roburoc4_floats(status.analog, status.analog_count, v.analog, 9);
    std::memcpy(v.digital, status.digital, 3);
    return true;
}

/* Decoded to roburoc4's struct, which is the application's too. */
size_t encode_differential(uint8_t *buffer, size_t capacity) {
    return length(roburoc4_encode_differential_status(buffer, capacity, &differential::sent()));
}

bool decode_differential(const uint8_t *wire, size_t size) {
    return roburoc4_decode_differential_status(wire, size, &differential::received()) == 0;
}

} // namespace

message_codecs roburoc4_codecs() {
    return {{"iocard", "roburoc4", encode_iocard, decode_iocard, iocard::intact},
            {"differential", "roburoc4", encode_differential, decode_differential,
             differential::intact}};
}
