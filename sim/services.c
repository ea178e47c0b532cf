/* SPDX-License-Identifier: MIT
 *
 * The seven services: the model's state as properties, texts and statuses (manual 4.2.2 to 4.2.4).
 */
#include <stdio.h>
#include <string.h>

#include "model.h"

#define UNKNOWN_TYPE 0x7100
#define UNUSED_TEXT "-- exists but not used --"
#define STAMP_AT 3 /* in a status */

bool sim_service_exists(const roburoc4_sim *sim, uint32_t service) {
    return service < ROBUROC4_SERVICE_COUNT && (sim->config.hidden_services >> service & 1u) == 0;
}

int32_t sim_service_of_id(const roburoc4_sim *sim, uint16_t id) {
    for (uint32_t service = 0; service < ROBUROC4_SERVICE_COUNT; service++) {
        if (sim->config.service_ids[service] == id && sim_service_exists(sim, service)) {
            return (int32_t)service;
        }
    }
    return -1;
}

/* ------------------------------------------------------------------------------ properties --- */

static roburoc4_result directory_properties(const roburoc4_sim *sim, uint8_t id, uint8_t *buffer,
                                            size_t capacity) {
    roburoc4_directory_entry entries[ROBUROC4_SERVICE_COUNT];
    size_t count = 0;
    for (uint32_t service = 0; service < ROBUROC4_SERVICE_COUNT; service++) {
        if (sim_service_exists(sim, service)) {
            entries[count].type = sim->config.plain_types != 0 ? (uint16_t)(UNKNOWN_TYPE + service)
                                                               : sim->config.service_types[service];
            entries[count].id = sim->config.service_ids[service];
            count++;
        }
    }
    return roburoc4_encode_directory(buffer, capacity, id, ROBUROC4_SERVICE_DIRECTORY, entries,
                                     count);
}

static roburoc4_result notification_properties(const roburoc4_sim *sim, const sim_peer *asker,
                                               uint8_t id, uint8_t *buffer, size_t capacity) {
    roburoc4_subscription entries[ROBUROC4_SERVICE_COUNT];
    size_t count = 0;
    for (uint32_t service = 0; service < ROBUROC4_SERVICE_COUNT; service++) {
        uint8_t period_cycles = sim_peers_period(sim, asker, service);
        if (period_cycles != 0) {
            entries[count].service = sim->config.service_ids[service];
            entries[count].period_cycles = period_cycles;
            entries[count].reserved = 0;
            count++;
        }
    }
    return roburoc4_encode_notification(buffer, capacity, id, ROBUROC4_SERVICE_NOTIFICATION,
                                        entries, count);
}

static roburoc4_result iocard_properties(const roburoc4_sim *sim, uint8_t id, uint8_t *buffer,
                                         size_t capacity) {
    roburoc4_iocard_properties properties = {0};
    properties.analog_inputs = sim->config.analog_inputs;
    properties.analog_outputs = sim->config.analog_outputs;
    properties.digital_inputs = sim->config.digital_inputs;
    properties.digital_outputs = sim->config.digital_outputs;
    properties.service = sim->config.service_ids[ROBUROC4_SERVICE_IOCARD];
    return roburoc4_encode_iocard_properties(buffer, capacity, id, &properties);
}

static roburoc4_result telemeter_properties(const roburoc4_sim *sim, uint8_t id, uint8_t *buffer,
                                            size_t capacity) {
    roburoc4_telemeter telemeters[ROBUROC4_SIM_MAX_TELEMETERS];
    for (uint32_t which = 0; which < sim->config.telemeters; which++) {
        sim_telemeter_describe(sim, which, &telemeters[which]);
    }
    return roburoc4_encode_telemeter_properties(buffer, capacity, id,
                                                sim->config.service_ids[ROBUROC4_SERVICE_TELEMETER],
                                                telemeters, sim->config.telemeters);
}

static roburoc4_result battery_properties(const roburoc4_sim *sim, uint8_t id, uint8_t *buffer,
                                          size_t capacity) {
    roburoc4_battery_properties properties = {0};
    properties.nominal_voltage_v = sim->config.nominal_voltage_v;
    properties.capacity_ah = sim->config.capacity_ah;
    properties.minimum_percent = (uint8_t)sim->config.minimum_percent;
    properties.service = sim->config.service_ids[ROBUROC4_SERVICE_BATTERY];
    return roburoc4_encode_battery_properties(buffer, capacity, id, &properties);
}

static roburoc4_result localization_properties(const roburoc4_sim *sim, uint8_t id, uint8_t *buffer,
                                               size_t capacity) {
    roburoc4_localization_properties properties = {0};
    properties.x_m = sim->config.start_x_m;
    properties.y_m = sim->config.start_y_m;
    properties.theta_rad = sim->config.start_theta_rad;
    properties.flags = sim->config.localization_flags;
    properties.service = sim->config.service_ids[ROBUROC4_SERVICE_LOCALIZATION];
    return roburoc4_encode_localization_properties(buffer, capacity, id, &properties);
}

static roburoc4_result differential_properties(const roburoc4_sim *sim, uint8_t id, uint8_t *buffer,
                                               size_t capacity) {
    const roburoc4_sim_config *config = &sim->config;
    roburoc4_differential_properties properties = {0};
    const sim_speed target = sim_motion_shown_target(sim);
    properties.target_linear_m_s = (float)target.linear_m_s;
    properties.target_angular_rad_s = (float)target.angular_rad_s;
    properties.current_linear_m_s = (float)sim->linear.speed;
    properties.current_angular_rad_s = (float)sim->angular.speed;
    properties.max_linear_m_s = config->max_linear_m_s;
    properties.min_linear_m_s = config->min_linear_m_s;
    properties.max_angular_rad_s = config->max_angular_rad_s;
    properties.min_angular_rad_s = config->min_angular_rad_s;
    properties.max_linear_m_s2 = config->max_linear_m_s2;
    properties.min_linear_m_s2 = config->min_linear_m_s2;
    properties.max_angular_rad_s2 = config->max_angular_rad_s2;
    properties.min_angular_rad_s2 = config->min_angular_rad_s2;
    properties.width_m = config->width_m;
    properties.service = config->service_ids[ROBUROC4_SERVICE_DIFFERENTIAL];
    return roburoc4_encode_differential_properties(buffer, capacity, id, &properties);
}

roburoc4_result sim_service_properties(const roburoc4_sim *sim, const sim_peer *asker,
                                       uint32_t service, uint8_t id, uint8_t *buffer,
                                       size_t capacity) {
    switch (service) {
    case ROBUROC4_SERVICE_DIRECTORY:
        return directory_properties(sim, id, buffer, capacity);
    case ROBUROC4_SERVICE_NOTIFICATION:
        return notification_properties(sim, asker, id, buffer, capacity);
    case ROBUROC4_SERVICE_IOCARD:
        return iocard_properties(sim, id, buffer, capacity);
    case ROBUROC4_SERVICE_TELEMETER:
        return telemeter_properties(sim, id, buffer, capacity);
    case ROBUROC4_SERVICE_BATTERY:
        return battery_properties(sim, id, buffer, capacity);
    case ROBUROC4_SERVICE_LOCALIZATION:
        return localization_properties(sim, id, buffer, capacity);
    default:
        return differential_properties(sim, id, buffer, capacity);
    }
}

/* ----------------------------------------------------------------------------------- texts --- */

/* Encodes a text in the configuration's manner. */
static roburoc4_result encode_text(const roburoc4_sim *sim, uint32_t service, const char *text,
                                   uint8_t id, uint8_t *buffer, size_t capacity) {
    char out[64] = "";
    size_t length = sim->config.query_mode == ROBUROC4_SIM_QUERY_EMPTY ? 0 : strlen(text);
    const char *last = length > 0 ? strrchr(text, ' ') : NULL;
    if (last != NULL && (sim->config.texts & ROBUROC4_SIM_TEXTS_REORDERED) != 0) {
        (void)snprintf(out, sizeof out, "%s, %.*s", last + 1, (int)(last - text), text);
        length = strlen(out);
    } else {
        (void)snprintf(out, sizeof out, "%.*s", (int)length, text);
    }
    bool opened = false;
    for (size_t at = 0; (sim->config.texts & ROBUROC4_SIM_TEXTS_LATIN_1) != 0 && at < length;
         at++) {
        if (out[at] == '"') {
            out[at] = opened ? '\xBB' : '\xAB';
            opened = !opened;
        }
    }
    return roburoc4_encode_text(buffer, capacity, id, sim->config.service_ids[service], out,
                                length);
}

roburoc4_result sim_directory_text(const roburoc4_sim *sim, uint32_t index, uint8_t id,
                                   uint8_t *buffer, size_t capacity) {
    for (uint32_t service = 0; service < ROBUROC4_SERVICE_COUNT; service++) {
        if (sim_service_exists(sim, service) && index-- == 0) {
            const char *name = roburoc4_name(ROBUROC4_NAME_SERVICE, service);
            return encode_text(sim, ROBUROC4_SERVICE_DIRECTORY, name, id, buffer, capacity);
        }
    }
    return ROBUROC4_ERR_INDEX;
}

roburoc4_result sim_iocard_text(const roburoc4_sim *sim, uint32_t io_type, int32_t index,
                                uint8_t id, uint8_t *buffer, size_t capacity) {
    const roburoc4_sim_config *config = &sim->config;
    const int32_t counts[] = {config->analog_inputs, config->analog_outputs, config->digital_inputs,
                              config->digital_outputs};
    if (io_type > ROBUROC4_IO_DIGITAL_OUTPUT || index < 0 || index >= counts[io_type]) {
        return ROBUROC4_ERR_INDEX;
    }
    int32_t meaning = sim_channel_meaning(sim, io_type, (uint32_t)index);
    const char *name =
        meaning < 0 ? NULL : roburoc4_client_channel_name(NULL, io_type, (uint32_t)meaning);
    name = name == NULL ? "" : name;
    if (sim->config.as_manual != 0 && name[0] == '\0') {
        name = UNUSED_TEXT;
    }
    bool input = io_type == ROBUROC4_IO_DIGITAL_INPUT;
    if (input && meaning == SIM_SECOND_FRONT &&
        (config->texts & ROBUROC4_SIM_TEXTS_TWO_FRONT) != 0) {
        name = roburoc4_client_channel_name(NULL, io_type, ROBUROC4_DI_FRONT_BUMPER);
    } else if (input && meaning == SIM_LIKE_A && (config->texts & ROBUROC4_SIM_TEXTS_LIKE_A) != 0) {
        name = "Game pad A LED";
    }
    return encode_text(sim, ROBUROC4_SERVICE_IOCARD, name, id, buffer, capacity);
}

/* -------------------------------------------------------------------------------- statuses --- */

static bool is_nan(const roburoc4_sim *sim, uint32_t service) {
    return (sim->nan >> service & 1u) != 0;
}

static roburoc4_result iocard_status(const roburoc4_sim *sim, uint8_t *buffer, size_t capacity) {
    float analog[ROBUROC4_SIM_MAX_ANALOG];
    uint8_t digital[ROBUROC4_SIM_MAX_DIGITAL / 8] = {0};
    uint32_t analog_inputs = (uint32_t)sim->config.analog_inputs;
    uint32_t digital_inputs = (uint32_t)sim->config.digital_inputs;
    for (uint32_t index = 0; index < analog_inputs; index++) {
        analog[index] = is_nan(sim, ROBUROC4_SERVICE_IOCARD) ? NAN : sim_analog_input(sim, index);
    }
    for (uint32_t index = 0; index < digital_inputs; index++) {
        if (sim_digital_input(sim, index)) {
            digital[index / 8] = (uint8_t)(digital[index / 8] | 1u << index % 8);
        }
    }
    return roburoc4_encode_iocard_status(
        buffer, capacity, sim->config.service_ids[ROBUROC4_SERVICE_IOCARD], sim->cycles, analog,
        analog_inputs, digital, digital_inputs);
}

static roburoc4_result telemeter_status(const roburoc4_sim *sim, uint8_t *buffer, size_t capacity) {
    float distances[ROBUROC4_SIM_MAX_TELEMETERS];
    uint32_t count = sim->config.telemeters;
    count = count < sim->config.reported_distances ? count : sim->config.reported_distances;
    for (uint32_t which = 0; which < count; which++) {
        distances[which] =
            is_nan(sim, ROBUROC4_SERVICE_TELEMETER) ? NAN : sim_telemeter_distance(sim, which);
    }
    return roburoc4_encode_telemeter_status(buffer, capacity,
                                            sim->config.service_ids[ROBUROC4_SERVICE_TELEMETER],
                                            sim->cycles, distances, count);
}

static roburoc4_result battery_status(const roburoc4_sim *sim, uint8_t *buffer, size_t capacity) {
    roburoc4_battery_status status = {0};
    status.robot_cycles = sim->cycles;
    status.state = sim_battery_state(sim);
    status.remaining_percent = sim_battery_remaining(sim);
    status.service = sim->config.service_ids[ROBUROC4_SERVICE_BATTERY];
    return roburoc4_encode_battery_status(buffer, capacity, &status);
}

static uint64_t odometry_stamp(const roburoc4_sim *sim) {
    return sim->config.stamp_measured != 0 ? sim->measured_cycles : sim->cycles;
}

static roburoc4_result localization_status(const roburoc4_sim *sim, uint8_t *buffer,
                                           size_t capacity) {
    roburoc4_localization_status status = {0};
    bool nan = is_nan(sim, ROBUROC4_SERVICE_LOCALIZATION);
    status.robot_cycles = odometry_stamp(sim);
    status.x_m = nan ? (double)NAN : sim->measured_pose.x_m;
    status.y_m = nan ? (double)NAN : sim->measured_pose.y_m;
    status.theta_rad = nan ? (double)NAN : sim->measured_pose.theta_rad;
    status.flags = sim->localization_flags;
    status.service = sim->config.service_ids[ROBUROC4_SERVICE_LOCALIZATION];
    return roburoc4_encode_localization_status(buffer, capacity, &status);
}

static roburoc4_result differential_status(const roburoc4_sim *sim, uint8_t *buffer,
                                           size_t capacity) {
    roburoc4_differential_status status = {0};
    const sim_speed target = sim_motion_shown_target(sim);
    bool nan = is_nan(sim, ROBUROC4_SERVICE_DIFFERENTIAL);
    status.robot_cycles = odometry_stamp(sim);
    status.target_linear_m_s = (float)target.linear_m_s;
    status.current_linear_m_s = nan ? NAN : (float)sim->measured_speed.linear_m_s;
    status.target_angular_rad_s = (float)target.angular_rad_s;
    status.current_angular_rad_s = nan ? NAN : (float)sim->measured_speed.angular_rad_s;
    status.service = sim->config.service_ids[ROBUROC4_SERVICE_DIFFERENTIAL];
    return roburoc4_encode_differential_status(buffer, capacity, &status);
}

static roburoc4_result service_status(const roburoc4_sim *sim, uint32_t service, uint8_t *buffer,
                                      size_t capacity) {
    switch (service) {
    case ROBUROC4_SERVICE_IOCARD:
        return iocard_status(sim, buffer, capacity);
    case ROBUROC4_SERVICE_TELEMETER:
        return telemeter_status(sim, buffer, capacity);
    case ROBUROC4_SERVICE_BATTERY:
        return battery_status(sim, buffer, capacity);
    case ROBUROC4_SERVICE_LOCALIZATION:
        return localization_status(sim, buffer, capacity);
    default:
        return differential_status(sim, buffer, capacity);
    }
}

void sim_services_freeze(roburoc4_sim *sim, uint32_t services) {
    for (uint32_t service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++) {
        if ((services & ~sim->frozen) >> service & 1u) {
            sim->last_status_length[service] = service_status(
                sim, service, sim->last_status[service], sizeof sim->last_status[service]);
        }
    }
    sim->frozen = services;
}

/* The status that a service sends now. */
static roburoc4_result current_status(roburoc4_sim *sim, uint32_t service, uint8_t *buffer,
                                      size_t capacity) {
    roburoc4_result length;
    if ((sim->frozen >> service & 1u) == 0) {
        length = service_status(sim, service, buffer, capacity);
    } else {
        length = sim->last_status_length[service];
        memcpy(buffer, sim->last_status[service], sizeof sim->last_status[service]);
        for (uint32_t at = 0; sim->config.stamp_measured == 0 && at < 8; at++) {
            buffer[STAMP_AT + at] = (uint8_t)(sim->cycles >> 8 * at);
        }
    }
    if (length <= 0) {
        return length;
    }
    memset(buffer + length, 0, sim->config.surplus_bytes);
    return length + (roburoc4_result)sim->config.surplus_bytes;
}

void sim_services_notify(roburoc4_sim *sim) {
    uint8_t buffer[ROBUROC4_SIM_MAX_TRANSMIT];
    for (uint32_t slot = 0; slot < sim->peer_count; slot++) {
        const sim_peer *peer = &sim->peers[slot];
        for (uint32_t service = 0; service < ROBUROC4_SERVICE_COUNT; service++) {
            const sim_subscription *wish = &peer->subscriptions[service];
            if (wish->period_cycles == 0 ||
                (sim->cycles - wish->phase_cycles) % wish->period_cycles != 0) {
                continue;
            }
            roburoc4_result length = current_status(sim, service, buffer, sizeof buffer);
            uint64_t due_us = sim_queue_due_us(
                sim, (sim_delay)(SIM_DELAY_IOCARD + (service - ROBUROC4_SERVICE_IOCARD)));
            if (length <= 0 ||
                !sim_queue_push(&sim->queue, peer->key, buffer, (size_t)length, due_us)) {
                sim->counts.dropped++;
            }
        }
    }
}
