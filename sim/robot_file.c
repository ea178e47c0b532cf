/* SPDX-License-Identifier: MIT
 *
 * A simulated robot that is the one of a robot file.
 */
#include "roburoc4_robot_file.h"

#include "model.h"
#include "settings.h"

static bool known(const roburoc4_robot_file *file, const char *name, float *value) {
    return roburoc4_robot_file_get(file, name, value) == ROBUROC4_OK;
}

/* Services whose ids are not known get those that are free. */
static void keep_ids_apart(roburoc4_sim_config *config, const roburoc4_robot_file *file) {
    static const char *const names[] = {"iocard_id", "telemeter_id", "battery_id",
                                        "localization_id", "differential_id"};
    uint16_t *ids = &config->service_ids[ROBUROC4_SERVICE_IOCARD];
    float unused = 0.0f;
    for (uint32_t one = 0; one < 5; one++) {
        bool free = known(file, names[one], &unused);
        for (uint16_t id = ROBUROC4_SERVICE_IOCARD; !free; id++) {
            free = true;
            for (uint32_t other = 0; other < 5; other++) {
                bool kept = other < one || known(file, names[other], &unused);
                free = free && !(kept && ids[other] == id);
            }
            ids[one] = id;
        }
    }
}

/* Where the inputs are, beside the manual's table, by those that are known. */
static void shift_inputs(roburoc4_sim_config *config, const roburoc4_robot_file *file) {
    float index = 0.0f;
    float usual = ROBUROC4_DI_PAD_A;
    bool literal = config->digital_inputs == ROBUROC4_DI_COUNT + 1;
    bool found = known(file, "override_index", &index);
    if (!found && known(file, "battery_voltage_index", &index)) {
        found = true;
        usual = ROBUROC4_AI_BATTERY_V;
        literal = config->analog_inputs == ROBUROC4_AI_COUNT + 1;
    }
    float shift = index - usual - (literal ? 1.0f : 0.0f);
    if (found && shift >= 0.0f) {
        (void)sim_config_set(config, "input_shift", (double)shift);
    }
}

/* Its pose counts odometry_scale times what the wheels turn, of which slip is lost. */
static void keep_scales(roburoc4_sim_config *config, const roburoc4_robot_file *file) {
    float linear = 0.0f;
    float angular = 0.0f;
    bool known_linear = known(file, "scale_linear", &linear);
    if (known(file, "scale_angular", &angular)) {
        double counted = known_linear ? (double)linear : (double)config->odometry_scale;
        double lost = known_linear ? SIM_SLIP_AHEAD : 0.0;
        double slip = ((double)angular - counted) / ((double)angular - lost * counted);
        config->slip = slip < 0.0 ? 0.0f : slip > SIM_MAX_SLIP ? SIM_MAX_SLIP : (float)slip;
    }
    if (known_linear) {
        config->odometry_scale = linear * (1.0f - (float)SIM_SLIP_AHEAD * config->slip);
    }
}

void roburoc4_sim_config_robot_file(roburoc4_sim_config *config, const roburoc4_robot_file *file) {
    const char *name = NULL;
    float value = 0.0f;
    for (uint32_t index = 0; (name = roburoc4_robot_file_name(index)) != NULL; index++) {
        if (known(file, name, &value)) {
            (void)sim_config_set(config, name, (double)value); /* does nothing with other names */
        }
    }
    if (known(file, "robot_watchdog_ms", &value)) {
        config->watchdog_cycles = (uint32_t)(value / 10.0f + 0.5f);
    }
    keep_scales(config, file);
    shift_inputs(config, file);
    keep_ids_apart(config, file);
}
