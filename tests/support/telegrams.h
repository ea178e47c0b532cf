/* SPDX-License-Identifier: MIT
 *
 * Short ways to write a request and to read one channel, in C and C++.
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

static inline roburoc4_result encode_get(uint8_t *buffer, size_t capacity, uint8_t id,
                                         uint16_t service) {
    const roburoc4_request request = request_of(id, ROBUROC4_ACTION_GET, service);
    return roburoc4_encode_request(buffer, capacity, &request);
}

static inline roburoc4_result encode_query_directory(uint8_t *buffer, size_t capacity, uint8_t id,
                                                     uint16_t index) {
    roburoc4_request request = request_of(id, ROBUROC4_ACTION_QUERY, ROBUROC4_SERVICE_DIRECTORY);
    request.index = index;
    return roburoc4_encode_request(buffer, capacity, &request);
}

static inline roburoc4_result encode_query_iocard(uint8_t *buffer, size_t capacity, uint8_t id,
                                                  uint16_t service, uint8_t io_type,
                                                  int32_t index) {
    roburoc4_request request = request_of(id, ROBUROC4_ACTION_QUERY, service);
    request.io_type = io_type;
    request.index = index;
    return roburoc4_encode_request(buffer, capacity, &request);
}

static inline roburoc4_result encode_insert(uint8_t *buffer, size_t capacity, uint8_t id,
                                            uint16_t subject, uint8_t period_cycles) {
    roburoc4_request request =
        request_of(id, ROBUROC4_ACTION_INSERT, ROBUROC4_SERVICE_NOTIFICATION);
    request.subject = subject;
    request.period_cycles = period_cycles;
    return roburoc4_encode_request(buffer, capacity, &request);
}

static inline roburoc4_result encode_delete(uint8_t *buffer, size_t capacity, uint8_t id,
                                            uint16_t subject) {
    roburoc4_request request =
        request_of(id, ROBUROC4_ACTION_DELETE, ROBUROC4_SERVICE_NOTIFICATION);
    request.subject = subject;
    return roburoc4_encode_request(buffer, capacity, &request);
}

static inline roburoc4_result encode_replace_localization(uint8_t *buffer, size_t capacity,
                                                          uint8_t id, uint16_t service,
                                                          uint64_t timestamp, double x_m,
                                                          double y_m, double theta_rad) {
    roburoc4_request request = request_of(id, ROBUROC4_ACTION_REPLACE, service);
    request.timestamp = timestamp;
    request.x_m = x_m;
    request.y_m = y_m;
    request.theta_rad = theta_rad;
    return roburoc4_encode_request(buffer, capacity, &request);
}

/** Analog channel `index`, read by the library; ROBUROC4_ERR_INDEX beyond the last. */
static inline roburoc4_result analog_at(const roburoc4_channels *channels, uint32_t index,
                                        float *out) {
    if (index >= channels->analog_count) {
        return ROBUROC4_ERR_INDEX;
    }
    (void)roburoc4_floats(channels->analog + (size_t)index * 4, 1, out, 1);
    return ROBUROC4_OK;
}

/** Digital channel `index`, read from the datagram; ROBUROC4_ERR_INDEX beyond the last. */
static inline roburoc4_result digital_at(const roburoc4_channels *channels, uint32_t index) {
    if (index >= channels->digital_count) {
        return ROBUROC4_ERR_INDEX;
    }
    return channels->digital[index / 8] >> (index % 8) & 1;
}

/** Distance `index`, read by the library; ROBUROC4_ERR_INDEX beyond the last. */
static inline roburoc4_result distance_at(const roburoc4_telemeter_status *status, uint32_t index,
                                          float *out) {
    if (index >= status->count) {
        return ROBUROC4_ERR_INDEX;
    }
    (void)roburoc4_floats(status->distances + (size_t)index * 4, 1, out, 1);
    return ROBUROC4_OK;
}

#endif
