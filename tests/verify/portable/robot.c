/* SPDX-License-Identifier: MIT
 *
 * The robot of the walk.
 */
#include "robot.h"

#include <string.h>

void robot_boot(robot *r, uint64_t now_us) {
    r->now_us = r->boot_us = now_us;
    r->cycles = r->commanded_us = 0;
    r->powered = 1;
    r->due = 0;
    memset(r->periods, 0, sizeof r->periods);
    r->target[0] = r->target[1] = 0;
}

uint16_t robot_id(const robot *r, uint32_t service) {
    return (uint16_t)(service < 2 ? service : r->first_id + service - 2);
}

int robot_moves(const robot *r) {
    return r->target[0] < 0 || r->target[0] > 0 || r->target[1] < 0 || r->target[1] > 0;
}

void robot_advance(robot *r, uint64_t now_us) {
    r->now_us = now_us;
    if (now_us - r->commanded_us >= ROBOT_WATCHDOG_US) {
        r->target[0] = r->target[1] = 0;
    }
    while (r->powered && now_us - r->boot_us >= (r->cycles + 1) * ROBUROC4_CYCLE_US) {
        uint8_t service;
        r->cycles++;
        for (service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++) {
            if (r->periods[service] > 0 && (uint32_t)r->cycles % r->periods[service] == 0) {
                r->due = (uint8_t)(r->due | 1U << service);
            }
        }
    }
}

/* ------------------------------------------------------------------------------ statuses --- */

static roburoc4_result iocard_status(const robot *r, uint8_t *buffer, size_t capacity) {
    static const float analog[ROBUROC4_AI_COUNT] = {0.5f, 0.5f, 24.5f};
    uint8_t digital[3] = {0, 0, 0};
    digital[ROBUROC4_DI_PAD_A / 8] = (uint8_t)(r->pad_a << ROBUROC4_DI_PAD_A % 8);
    return roburoc4_encode_iocard_status(buffer, capacity, robot_id(r, ROBUROC4_SERVICE_IOCARD),
                                         r->cycles, analog, ROBUROC4_AI_COUNT, digital,
                                         ROBUROC4_DI_COUNT);
}

static roburoc4_result differential_status(const robot *r, uint8_t *buffer, size_t capacity) {
    roburoc4_differential_status s;
    memset(&s, 0, sizeof s);
    s.robot_cycles = r->cycles;
    s.service = robot_id(r, ROBUROC4_SERVICE_DIFFERENTIAL);
    s.target_linear_m_s = s.current_linear_m_s = r->target[0];
    s.target_angular_rad_s = s.current_angular_rad_s = r->target[1];
    return roburoc4_encode_differential_status(buffer, capacity, &s);
}

static roburoc4_result battery_status(const robot *r, uint8_t *buffer, size_t capacity) {
    roburoc4_battery_status s;
    memset(&s, 0, sizeof s);
    s.robot_cycles = r->cycles;
    s.service = robot_id(r, ROBUROC4_SERVICE_BATTERY);
    s.state = ROBUROC4_BATTERY_OK;
    s.remaining_percent = 80;
    return roburoc4_encode_battery_status(buffer, capacity, &s);
}

static roburoc4_result localization_status(const robot *r, uint8_t *buffer, size_t capacity) {
    roburoc4_localization_status s;
    memset(&s, 0, sizeof s);
    s.robot_cycles = r->cycles;
    s.service = robot_id(r, ROBUROC4_SERVICE_LOCALIZATION);
    s.x_m = 1.5;
    s.y_m = -2.25;
    return roburoc4_encode_localization_status(buffer, capacity, &s);
}

static roburoc4_result telemeter_status(const robot *r, uint8_t *buffer, size_t capacity) {
    static const float distances[ROBUROC4_TELEMETER_COUNT] = {1.5f, 2.5f};
    return roburoc4_encode_telemeter_status(buffer, capacity,
                                            robot_id(r, ROBUROC4_SERVICE_TELEMETER), r->cycles,
                                            distances, ROBUROC4_TELEMETER_COUNT);
}

size_t robot_status(robot *r, uint8_t *buffer, size_t capacity) {
    uint8_t service = ROBUROC4_SERVICE_IOCARD;
    roburoc4_result size = 0;
    if (r->due == 0) {
        return 0;
    }
    while ((r->due & 1U << service) == 0) {
        service++;
    }
    r->due = (uint8_t)(r->due & ~(1U << service));
    switch (service) {
    case ROBUROC4_SERVICE_IOCARD:
        size = iocard_status(r, buffer, capacity);
        break;
    case ROBUROC4_SERVICE_TELEMETER:
        size = telemeter_status(r, buffer, capacity);
        break;
    case ROBUROC4_SERVICE_BATTERY:
        size = battery_status(r, buffer, capacity);
        break;
    case ROBUROC4_SERVICE_LOCALIZATION:
        size = localization_status(r, buffer, capacity);
        break;
    default:
        size = differential_status(r, buffer, capacity);
    }
    return size > 0 ? (size_t)size : 0;
}

/* ------------------------------------------------------------------------------- answers --- */

static roburoc4_result directory(const robot *r, uint8_t id, uint8_t *buffer, size_t capacity) {
    static const uint16_t types[ROBUROC4_SERVICE_COUNT] = {
        0, 0, ROBUROC4_TYPE_IOCARD, ROBUROC4_TYPE_TELEMETER, 0, ROBUROC4_TYPE_LOCALIZATION,
        0}; /* the differential service is found by its text */
    roburoc4_directory_entry entries[ROBUROC4_SERVICE_COUNT];
    uint32_t i;
    for (i = 0; i < ROBUROC4_SERVICE_COUNT; i++) {
        entries[i].type = types[i];
        entries[i].id = robot_id(r, i);
    }
    return roburoc4_encode_directory(buffer, capacity, id, 0, entries, ROBUROC4_SERVICE_COUNT);
}

static roburoc4_result iocard_properties(uint16_t wire_id, uint8_t id, uint8_t *buffer,
                                         size_t capacity) {
    roburoc4_iocard_properties p = {
        ROBUROC4_AI_COUNT, ROBUROC4_AO_COUNT, ROBUROC4_DI_COUNT, ROBUROC4_DO_COUNT, 0, 0};
    p.service = wire_id;
    return roburoc4_encode_iocard_properties(buffer, capacity, id, &p);
}

static roburoc4_result telemeter_properties(uint16_t wire_id, uint8_t id, uint8_t *buffer,
                                            size_t capacity) {
    static const roburoc4_telemeter telemeters[ROBUROC4_TELEMETER_COUNT] = {
        {0.5f, 0, 0, 0.5f, 0.25f, 4, 1.5f}, {-0.5f, 0, 3, 0.5f, 0.25f, 4, 2.5f}};
    return roburoc4_encode_telemeter_properties(buffer, capacity, id, wire_id, telemeters,
                                                ROBUROC4_TELEMETER_COUNT);
}

static roburoc4_result battery_properties(uint16_t wire_id, uint8_t id, uint8_t *buffer,
                                          size_t capacity) {
    roburoc4_battery_properties p = {24, 40, 20, 0, 0};
    p.service = wire_id;
    return roburoc4_encode_battery_properties(buffer, capacity, id, &p);
}

static roburoc4_result localization_properties(uint16_t wire_id, uint8_t id, uint8_t *buffer,
                                               size_t capacity) {
    roburoc4_localization_properties p = {1, 2, 0.5, 0x12, 0, 0};
    p.service = wire_id;
    return roburoc4_encode_localization_properties(buffer, capacity, id, &p);
}

static roburoc4_result differential_properties(uint16_t wire_id, uint8_t id, uint8_t *buffer,
                                               size_t capacity) {
    roburoc4_differential_properties p;
    memset(&p, 0, sizeof p);
    p.service = wire_id;
    p.max_linear_m_s = ROBOT_MAX_LINEAR;
    p.min_linear_m_s = -ROBOT_MAX_LINEAR;
    p.max_angular_rad_s = ROBOT_MAX_ANGULAR;
    p.min_angular_rad_s = -ROBOT_MAX_ANGULAR;
    p.width_m = 0.68f;
    return roburoc4_encode_differential_properties(buffer, capacity, id, &p);
}

static roburoc4_result properties(const robot *r, const roburoc4_request *q, uint8_t *buffer,
                                  size_t capacity) {
    if (q->service == 0) {
        return directory(r, q->id, buffer, capacity);
    }
    switch (q->service - r->first_id + 2) {
    case ROBUROC4_SERVICE_IOCARD:
        return iocard_properties(q->service, q->id, buffer, capacity);
    case ROBUROC4_SERVICE_TELEMETER:
        return telemeter_properties(q->service, q->id, buffer, capacity);
    case ROBUROC4_SERVICE_BATTERY:
        return battery_properties(q->service, q->id, buffer, capacity);
    case ROBUROC4_SERVICE_LOCALIZATION:
        return localization_properties(q->service, q->id, buffer, capacity);
    case ROBUROC4_SERVICE_DIFFERENTIAL:
        return differential_properties(q->service, q->id, buffer, capacity);
    default:
        return roburoc4_encode_answer(buffer, capacity, q->id, q->action, q->service, 0);
    }
}

static roburoc4_result answer(robot *r, const roburoc4_request *q, uint8_t *buffer,
                              size_t capacity) {
    const char *text;
    switch (q->action) {
    case ROBUROC4_ACTION_GET:
        return properties(r, q, buffer, capacity);
    case ROBUROC4_ACTION_QUERY:
        text = q->service == 0 ? roburoc4_name(ROBUROC4_NAME_SERVICE, (uint32_t)q->index)
                               : roburoc4_client_channel_name(NULL, q->io_type, (uint32_t)q->index);
        text = text != NULL ? text : "";
        return roburoc4_encode_text(buffer, capacity, q->id, q->service, text, strlen(text));
    case ROBUROC4_ACTION_INSERT:
        if (q->subject >= r->first_id && q->subject < r->first_id + 5U) {
            r->periods[q->subject - r->first_id + 2U] = q->period_cycles;
        }
        break;
    default:
        break;
    }
    return roburoc4_encode_answer(buffer, capacity, q->id, q->action, q->service, 0);
}

size_t robot_hear(robot *r, const uint8_t *data, size_t size, uint8_t *buffer, size_t capacity) {
    roburoc4_request request;
    roburoc4_differential_command command;
    roburoc4_result length = 0;
    if (!r->powered) {
        return 0;
    }
    if (roburoc4_decode_differential_command(data, size, &command) >= 0) {
        if (command.service == robot_id(r, ROBUROC4_SERVICE_DIFFERENTIAL)) {
            r->target[0] = command.linear_m_s;
            r->target[1] = command.angular_rad_s;
            r->commanded_us = r->now_us;
        }
    } else if (roburoc4_decode_request(data, size, &request) >= 0) {
        length = answer(r, &request, buffer, capacity);
    }
    return length > 0 ? (size_t)length : 0;
}
