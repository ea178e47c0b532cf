/* SPDX-License-Identifier: MIT
 *
 * For its size only: encode and decode of the five statuses and the drive command with nanopb.
 */
#include "statuses.pb.h"
#include <pb_decode.h>
#include <pb_encode.h>

static uint8_t buffer[64];
static volatile bool result;

static union {
    peer_iocard iocard;
    peer_telemeter telemeter;
    peer_battery battery;
    peer_localization localization;
    peer_differential differential;
    peer_drive drive;
} v;

int main(void) {
    static const pb_msgdesc_t *const messages[] = {
        peer_iocard_fields,       peer_telemeter_fields,    peer_battery_fields,
        peer_localization_fields, peer_differential_fields, peer_drive_fields};
    for (unsigned i = 0; i < sizeof messages / sizeof messages[0]; i++) {
        pb_ostream_t out = pb_ostream_from_buffer(buffer, sizeof buffer);
        pb_istream_t in = pb_istream_from_buffer(buffer, sizeof buffer);
        result = pb_encode(&out, messages[i], &v);
        result = pb_decode(&in, messages[i], &v);
    }
    return 0;
}
