/* SPDX-License-Identifier: MIT
 *
 * The seven services: the model's state as properties, texts and statuses (manual 4.2.2 to 4.2.4).
 */
#include <string.h>

#include "model.h"

#define UNKNOWN_TYPE 0x7100
#define UNUSED_TEXT "-- exists but not used --"

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
    for (uint32_t service = 0; asker != NULL && service < ROBUROC4_SERVICE_COUNT; service++) {
        if (asker->subscriptions[service].period_cycles != 0) {
            entries[count].service = sim->config.service_ids[service];
            entries[count].period_cycles = asker->subscriptions[service].period_cycles;
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
    roburoc4_telemeter telemeters[ROBUROC4_TELEMETER_COUNT];
    for (uint32_t which = 0; which < ROBUROC4_TELEMETER_COUNT; which++) {
        sim_telemeter_describe(sim, which, &telemeters[which]);
    }
    return roburoc4_encode_telemeter_properties(buffer, capacity, id,
                                                sim->config.service_ids[ROBUROC4_SERVICE_TELEMETER],
                                                telemeters, ROBUROC4_TELEMETER_COUNT);
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
    properties.target_linear_m_s = (float)sim->target.linear_m_s;
    properties.target_angular_rad_s = (float)sim->target.angular_rad_s;
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

roburoc4_result sim_directory_text(const roburoc4_sim *sim, uint32_t index, uint8_t id,
                                   uint8_t *buffer, size_t capacity) {
    for (uint32_t service = 0; service < ROBUROC4_SERVICE_COUNT; service++) {
        if (sim_service_exists(sim, service) && index-- == 0) {
            const char *name = roburoc4_name(ROBUROC4_NAME_SERVICE, service);
            return roburoc4_encode_text(buffer, capacity, id, ROBUROC4_SERVICE_DIRECTORY, name,
                                        strlen(name));
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
    return roburoc4_encode_text(buffer, capacity, id, config->service_ids[ROBUROC4_SERVICE_IOCARD],
                                name, strlen(name));
}

/* -------------------------------------------------------------------------------- statuses --- */

static roburoc4_result iocard_status(const roburoc4_sim *sim, uint8_t *buffer, size_t capacity) {
    float analog[ROBUROC4_SIM_MAX_ANALOG];
    uint8_t digital[ROBUROC4_SIM_MAX_DIGITAL / 8] = {0};
    uint32_t analog_inputs = (uint32_t)sim->config.analog_inputs;
    uint32_t digital_inputs = (uint32_t)sim->config.digital_inputs;
    for (uint32_t index = 0; index < analog_inputs; index++) {
        analog[index] = sim_analog_input(sim, index);
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
    float distances[ROBUROC4_TELEMETER_COUNT];
    for (uint32_t which = 0; which < ROBUROC4_TELEMETER_COUNT; which++) {
        distances[which] = sim_telemeter_distance(sim, which);
    }
    return roburoc4_encode_telemeter_status(buffer, capacity,
                                            sim->config.service_ids[ROBUROC4_SERVICE_TELEMETER],
                                            sim->cycles, distances, ROBUROC4_TELEMETER_COUNT);
}

static roburoc4_result battery_status(const roburoc4_sim *sim, uint8_t *buffer, size_t capacity) {
    roburoc4_battery_status status = {0};
    status.robot_cycles = sim->cycles;
    status.state = sim_battery_state(sim);
    status.remaining_percent = sim_battery_remaining(sim);
    status.service = sim->config.service_ids[ROBUROC4_SERVICE_BATTERY];
    return roburoc4_encode_battery_status(buffer, capacity, &status);
}

static roburoc4_result localization_status(const roburoc4_sim *sim, uint8_t *buffer,
                                           size_t capacity) {
    roburoc4_localization_status status = {0};
    status.robot_cycles = sim->cycles;
    status.x_m = sim->odometry.x_m;
    status.y_m = sim->odometry.y_m;
    status.theta_rad = sim->odometry.theta_rad;
    status.flags = sim->localization_flags;
    status.service = sim->config.service_ids[ROBUROC4_SERVICE_LOCALIZATION];
    return roburoc4_encode_localization_status(buffer, capacity, &status);
}

static roburoc4_result differential_status(const roburoc4_sim *sim, uint8_t *buffer,
                                           size_t capacity) {
    roburoc4_differential_status status = {0};
    status.robot_cycles = sim->cycles;
    status.target_linear_m_s = (float)sim->target.linear_m_s;
    status.current_linear_m_s = (float)sim->linear.speed;
    status.target_angular_rad_s = (float)sim->target.angular_rad_s;
    status.current_angular_rad_s = (float)sim->angular.speed;
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
            roburoc4_result length = service_status(sim, service, buffer, sizeof buffer);
            if (length <= 0 || !sim_queue_push(&sim->queue, peer->key, buffer, (size_t)length)) {
                sim->counts.dropped++;
            }
        }
    }
}
