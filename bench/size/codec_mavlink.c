/* SPDX-License-Identifier: MIT
 *
 * For its size only: encode and decode of the five statuses and the drive command with MAVLink.
 */
#include "statuses/mavlink.h"

static uint8_t buffer[64];
static volatile int result;
static mavlink_message_t framed;
static mavlink_status_t status;

static union {
    mavlink_iocard_t iocard;
    mavlink_telemeter_t telemeter;
    mavlink_battery_t battery;
    mavlink_localization_t localization;
    mavlink_differential_t differential;
    mavlink_drive_t drive;
} v;

int main(void) {
    mavlink_msg_drive_encode(1, 1, &framed, &v.drive);
    mavlink_msg_drive_decode(&framed, &v.drive);
    mavlink_msg_iocard_encode(1, 1, &framed, &v.iocard);
    mavlink_msg_iocard_decode(&framed, &v.iocard);
    mavlink_msg_telemeter_encode(1, 1, &framed, &v.telemeter);
    mavlink_msg_telemeter_decode(&framed, &v.telemeter);
    mavlink_msg_battery_encode(1, 1, &framed, &v.battery);
    mavlink_msg_battery_decode(&framed, &v.battery);
    mavlink_msg_localization_encode(1, 1, &framed, &v.localization);
    mavlink_msg_localization_decode(&framed, &v.localization);
    mavlink_msg_differential_encode(1, 1, &framed, &v.differential);
    mavlink_msg_differential_decode(&framed, &v.differential);
    result = mavlink_msg_to_send_buffer(buffer, &framed);
    result = mavlink_parse_char(MAVLINK_COMM_0, buffer[0], &framed, &status);
    return 0;
}
