/* SPDX-License-Identifier: MIT
 *
 * The configuration: its defaults, and which values are refused.
 */
#include <string.h>

#include "model.h"

static void set_defaults(roburoc4_sim_config *config) {
    static const uint16_t types[ROBUROC4_SERVICE_COUNT] = {
        0x0000,
        0x0001,
        ROBUROC4_TYPE_IOCARD,
        ROBUROC4_TYPE_TELEMETER,
        0x4006, /* the battery's type code is documented nowhere */
        ROBUROC4_TYPE_LOCALIZATION,
        ROBUROC4_TYPE_DIFFERENTIAL,
    };
    memset(config, 0, sizeof *config);
    config->size = sizeof *config;
    config->watchdog_cycles = 100;
    config->seed = 1;
    for (uint16_t service = 0; service < ROBUROC4_SERVICE_COUNT; service++) {
        config->service_ids[service] = service;
        config->service_types[service] = types[service];
    }
    config->analog_inputs = ROBUROC4_AI_COUNT;
    config->analog_outputs = ROBUROC4_AO_COUNT;
    config->digital_inputs = ROBUROC4_DI_COUNT;
    config->digital_outputs = ROBUROC4_DO_COUNT;
    config->max_linear_m_s = 2.6f;
    config->min_linear_m_s = -2.6f;
    config->max_angular_rad_s = 6.5f;
    config->min_angular_rad_s = -6.5f;
    config->max_linear_m_s2 = 3.0f;
    config->min_linear_m_s2 = -3.0f;
    config->max_angular_rad_s2 = 8.0f;
    config->min_angular_rad_s2 = -8.0f;
    config->width_m = 0.68f;
    config->localization_flags =
        ROBUROC4_LOCALIZATION_METRIC | ROBUROC4_LOCALIZATION_PROPRIOCEPTIVE;
    config->slip = 0.12f;
    config->nominal_voltage_v = 24.0f;
    config->capacity_ah = 60.0f;
    config->battery_percent = 100.0f;
    config->minimum_percent = 20;
}

roburoc4_result roburoc4_sim_config_init(roburoc4_sim_config *config, size_t size) {
    roburoc4_sim_config defaults;
    if (!sim_size_is_valid(size, sizeof defaults)) {
        return ROBUROC4_ERR_SIZE;
    }
    set_defaults(&defaults);
    defaults.size = (uint32_t)size;
    memcpy(config, &defaults, size);
    return ROBUROC4_OK;
}

bool sim_config_take(roburoc4_sim_config *out, const roburoc4_sim_config *config) {
    if (!sim_size_is_valid(config->size, sizeof *out)) {
        return false;
    }
    set_defaults(out);
    memcpy(out, config, config->size);
    out->size = sizeof *out;
    return true;
}

static bool within(double value, double min, double max) {
    return value >= min && value <= max;
}

static const char *ids_error(const roburoc4_sim_config *config) {
    if (config->service_ids[ROBUROC4_SERVICE_DIRECTORY] != ROBUROC4_SERVICE_DIRECTORY ||
        config->service_ids[ROBUROC4_SERVICE_NOTIFICATION] != ROBUROC4_SERVICE_NOTIFICATION) {
        return "service_ids: the directory's is always 0 and the notification's 1";
    }
    for (uint32_t one = 0; one < ROBUROC4_SERVICE_COUNT; one++) {
        for (uint32_t two = one + 1; two < ROBUROC4_SERVICE_COUNT; two++) {
            if (config->service_ids[one] == config->service_ids[two]) {
                return "service_ids: two services share an id; give each its own";
            }
        }
    }
    if ((config->hidden_services & 3u) != 0) {
        return "hidden_services: the directory and the notification cannot be hidden";
    }
    return NULL;
}

static const char *counts_error(const roburoc4_sim_config *config) {
    if (!within(config->analog_inputs, 0, ROBUROC4_SIM_MAX_ANALOG) ||
        !within(config->analog_outputs, 0, ROBUROC4_SIM_MAX_ANALOG)) {
        return "analog_inputs, analog_outputs: give 0 to 64";
    }
    if (!within(config->digital_inputs, 0, ROBUROC4_SIM_MAX_DIGITAL) ||
        !within(config->digital_outputs, 0, ROBUROC4_SIM_MAX_DIGITAL)) {
        return "digital_inputs, digital_outputs: give 0 to 256";
    }
    return NULL;
}

static const char *model_error(const roburoc4_sim_config *config) {
    if (!within((double)config->slip, 0.0, 0.9)) {
        return "slip: give a fraction of 0 to 0.9";
    }
    if (!within((double)config->nominal_voltage_v, 1.0, 1000.0)) {
        return "nominal_voltage_v: give 1 to 1000";
    }
    if (!within((double)config->capacity_ah, 0.001, 100000.0)) {
        return "capacity_ah: give 0.001 to 100000";
    }
    if (!within((double)config->battery_percent, 0.0, 100.0) || config->minimum_percent > 100) {
        return "battery_percent, minimum_percent: give 0 to 100";
    }
    if (!within(config->start_x_m, -1e5, 1e5) || !within(config->start_y_m, -1e5, 1e5) ||
        !sim_is_finite(config->start_theta_rad)) {
        return "start pose: give x and y of -100000 to 100000 m and a finite angle";
    }
    return NULL;
}

const char *roburoc4_sim_config_error(const roburoc4_sim_config *given) {
    roburoc4_sim_config all;
    const roburoc4_sim_config *config = &all;
    if (!sim_config_take(&all, given)) {
        return "size: fill the configuration with roburoc4_sim_config_init() of this library";
    }
    if (!within(config->watchdog_cycles, 1, 1000000)) {
        return "watchdog_cycles: give 1 to 1000000";
    }
    if (config->query_mode > ROBUROC4_SIM_QUERY_REFUSED) {
        return "query_mode: give one of ROBUROC4_SIM_QUERY_*";
    }
    if (config->localization_flags > SIM_LOCALIZATION_FLAGS_MAX) {
        return "localization_flags: give a sum of ROBUROC4_LOCALIZATION_*, 0 to 127";
    }
    const char *error = ids_error(config);
    error = error != NULL ? error : counts_error(config);
    return error != NULL ? error : model_error(config);
}
