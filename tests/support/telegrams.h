/* SPDX-License-Identifier: MIT
 *
 * Short ways to write a request and to read one digital channel.
 */
#ifndef ROBUROC4_TESTS_TELEGRAMS_H
#define ROBUROC4_TESTS_TELEGRAMS_H

#include <string.h>

#include "roburoc4_codec.h"

static inline roburoc4_request request_of(uint8_t id, uint8_t action, uint16_t service) {
    roburoc4_request request;
    memset(&request, 0, sizeof request);
    request.id = id;
    request.action = action;
    request.service = service;
    return request;
}

/** Digital channel `index`, read from the datagram. */
static inline int digital_at(const roburoc4_channels *channels, uint32_t index) {
    return channels->digital[index / 8] >> (index % 8) & 1;
}

#endif
