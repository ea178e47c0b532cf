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
using telemeter = values<telemeter_values, fill_telemeter>;
using drive = values<roburoc4_differential_command, fill_drive>;

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

size_t encode_telemeter(uint8_t *buffer, size_t capacity) {
    const telemeter_values &v = telemeter::sent();
    return length(roburoc4_encode_telemeter_status(buffer, capacity, v.service, v.robot_cycles,
                                                   v.distance_m, 2));
}

bool decode_telemeter(const uint8_t *wire, size_t size) {
    telemeter_values &v = telemeter::received();
    roburoc4_telemeter_status status;
    if (roburoc4_decode_telemeter_status(wire, size, &status) != 0 || status.count != 2) {
        return false;
    }
    v.service = status.service;
    v.robot_cycles = status.robot_cycles;
    roburoc4_floats(status.distances, status.count, v.distance_m, 2);
    return true;
}

size_t encode_drive(uint8_t *buffer, size_t capacity) {
    const roburoc4_differential_command &v = drive::sent();
    return length(roburoc4_encode_differential_command(buffer, capacity, v.service, v.linear_m_s,
                                                       v.angular_rad_s));
}

bool decode_drive(const uint8_t *wire, size_t size) {
    return roburoc4_decode_differential_command(wire, size, &drive::received()) == 0;
}

/** The statuses without lists: decoded to roburoc4's struct, which is the application's too. */
template <class T, void (*fill)(T &), roburoc4_result (*write)(uint8_t *, size_t, const T *),
          roburoc4_result (*read)(const uint8_t *, size_t, T *)>
message_codec of(const char *message) {
    using mine = values<T, fill>;
    return {
        message, "roburoc4",
        [](uint8_t *buffer, size_t capacity) {
            return length(write(buffer, capacity, &mine::sent()));
        },
        [](const uint8_t *wire, size_t size) { return read(wire, size, &mine::received()) == 0; },
        mine::intact};
}

} // namespace

message_codecs roburoc4_codecs() {
    return {{"iocard", "roburoc4", encode_iocard, decode_iocard, iocard::intact},
            {"telemeter", "roburoc4", encode_telemeter, decode_telemeter, telemeter::intact},
            of<roburoc4_battery_status, fill_battery, roburoc4_encode_battery_status,
               roburoc4_decode_battery_status>("battery"),
            of<roburoc4_localization_status, fill_localization, roburoc4_encode_localization_status,
               roburoc4_decode_localization_status>("localization"),
            of<roburoc4_differential_status, fill_differential, roburoc4_encode_differential_status,
               roburoc4_decode_differential_status>("differential"),
            {"drive", "roburoc4", encode_drive, decode_drive, drive::intact}};
}
