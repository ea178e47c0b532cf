/* SPDX-License-Identifier: MIT
 *
 * For its size only: encode and decode of the five statuses and the drive command with roburoc4.
 */
#include "roburoc4.h"

static uint8_t buffer[64];
static float analog[9];
static uint8_t digital[3];
static volatile int32_t result;

static union {
    roburoc4_channels iocard;
    roburoc4_telemeter_status telemeter;
    roburoc4_battery_status battery;
    roburoc4_localization_status localization;
    roburoc4_differential_status differential;
    roburoc4_differential_command drive;
} v;

int main(void) {
    result = roburoc4_decode_iocard_status(buffer, sizeof buffer, 9, 22, &v.iocard);
    result = (int32_t)roburoc4_floats(v.iocard.analog, v.iocard.analog_count, analog, 9);
    result = v.iocard.digital[0];
    result = roburoc4_decode_telemeter_status(buffer, sizeof buffer, &v.telemeter);
    result = (int32_t)roburoc4_floats(v.telemeter.distances, v.telemeter.count, analog, 2);
    result = roburoc4_decode_battery_status(buffer, sizeof buffer, &v.battery);
    result = roburoc4_decode_localization_status(buffer, sizeof buffer, &v.localization);
    result = roburoc4_decode_differential_status(buffer, sizeof buffer, &v.differential);
    result = roburoc4_decode_differential_command(buffer, sizeof buffer, &v.drive);
    result = roburoc4_encode_iocard_status(buffer, sizeof buffer, 2, 1, analog, 9, digital, 22);
    result = roburoc4_encode_telemeter_status(buffer, sizeof buffer, 3, 1, analog, 2);
    result = roburoc4_encode_battery_status(buffer, sizeof buffer, &v.battery);
    result = roburoc4_encode_localization_status(buffer, sizeof buffer, &v.localization);
    result = roburoc4_encode_differential_status(buffer, sizeof buffer, &v.differential);
    result = roburoc4_encode_differential_command(buffer, sizeof buffer, 6, 0.5f, 0.1f);
    return 0;
}
