/* SPDX-License-Identifier: MIT
 *
 * A table for each struct has the place and the type of each option; the ranges are checked by
 * roburoc4_config_error() and roburoc4_sim_config_error().
 */
#include "settings.h"

#include <stdio.h>
#include <string.h>

#include "fail.h"

#define ROBOT_U32(name) FIELD_AS(#name, robot_settings, config.name, U32)
#define ROBOT_F32(name) FIELD_AS(#name, robot_settings, config.name, F32)
#define IN_ARRAY(name, member, index, size, type)                                                  \
    { name, offsetof(robot_settings, config.member) + (index) * (size), FIELD_##type, 0 }
#define PERIOD(name, service)                                                                      \
    IN_ARRAY(name, period_ms, ROBUROC4_SERVICE_##service, sizeof(uint16_t), U16)
#define ROLE(name, role) IN_ARRAY(name, role_index, ROBUROC4_ROLE_##role, sizeof(int16_t), I16)
#define OPTION(name, bit)                                                                          \
    { name, offsetof(robot_settings, config.options), FIELD_BIT, bit }

/* clang-format off */
static const field of_robot[] = {
    ROBOT_U32(first_retry_ms), ROBOT_U32(lost_ms), ROBOT_U32(fresh_ms), ROBOT_U32(drive_period_ms),
    ROBOT_U32(lease_ms), ROBOT_U32(robot_watchdog_ms),
    ROBOT_F32(max_linear_m_s), ROBOT_F32(max_angular_rad_s), ROBOT_F32(scale_linear),
    ROBOT_F32(scale_angular),
    PERIOD("iocard_period_ms", IOCARD), PERIOD("telemeter_period_ms", TELEMETER),
    PERIOD("battery_period_ms", BATTERY), PERIOD("localization_period_ms", LOCALIZATION),
    PERIOD("differential_period_ms", DIFFERENTIAL),
    OPTION("turn_keeping", ROBUROC4_OPTION_TURN_KEEPING),
    OPTION("allow_unknown_override", ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE),
    OPTION("ignore_other_commander", ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER),
    ROLE("override_index", OVERRIDE), ROLE("front_bumper_index", FRONT_BUMPER),
    ROLE("rear_bumper_index", REAR_BUMPER), ROLE("battery_voltage_index", BATTERY_V),
    FIELD(robot_settings, buffer, U32),
};
/* clang-format on */

#define SIM_U32(name) FIELD(roburoc4_sim_config, name, U32)
#define SIM_I32(name) FIELD(roburoc4_sim_config, name, I32)
#define SIM_F32(name) FIELD(roburoc4_sim_config, name, F32)
#define SIM_F64(name) FIELD(roburoc4_sim_config, name, F64)

/* clang-format off */
static const field of_simulator[] = {
    SIM_U32(watchdog_cycles),
    FIELD(roburoc4_sim_config, seed, U64),
    SIM_U32(plain_types), SIM_U32(hidden_services), SIM_U32(refused_inserts), SIM_U32(query_mode),
    SIM_U32(answer_id_fixed), SIM_U32(only_id_fixed), SIM_U32(error_header), SIM_U32(start_safe),
    SIM_I32(analog_inputs), SIM_I32(analog_outputs), SIM_I32(digital_inputs),
    SIM_I32(digital_outputs),
    SIM_F32(max_linear_m_s), SIM_F32(min_linear_m_s), SIM_F32(max_angular_rad_s),
    SIM_F32(min_angular_rad_s), SIM_F32(max_linear_m_s2), SIM_F32(min_linear_m_s2),
    SIM_F32(max_angular_rad_s2), SIM_F32(min_angular_rad_s2), SIM_F32(width_m), SIM_F32(slip),
    SIM_F32(nominal_voltage_v), SIM_F32(capacity_ah), SIM_F32(battery_percent),
    SIM_U32(minimum_percent),
    SIM_F64(start_x_m), SIM_F64(start_y_m), SIM_F64(start_theta_rad),
};
/* clang-format on */

static const field of_faults[] = {
    FIELD(roburoc4_sim_faults, loss, F64),
    FIELD(roburoc4_sim_faults, duplicate, F64),
    FIELD(roburoc4_sim_faults, reorder, F64),
    FIELD(roburoc4_sim_faults, corrupt, F64),
    FIELD_AS("delay_ms", roburoc4_sim_faults, delay_us, MS32),
    FIELD_AS("jitter_ms", roburoc4_sim_faults, jitter_us, MS32),
};

/* ------------------------------------------------------------------------------- all of them ---
 */

static int fail_unknown(const char *name, const field *settings, size_t count) {
    char known[1536] = "";
    size_t i, used = 0;
    for (i = 0; i < count; i++) {
        used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", i > 0 ? ", " : "",
                                 settings[i].name);
    }
    return fail(FAIL_ARGUMENT, "there is no '%s'; there are %s", name, known);
}

static int write_all(const mxArray *options, const field *settings, size_t count, void *base) {
    int fields;
    if (!mxIsStruct(options) || mxGetNumberOfElements(options) != 1) {
        return fail(FAIL_ARGUMENT, "options: give a scalar struct");
    }
    fields = mxGetNumberOfFields(options);
    for (int number = 0; number < fields; number++) {
        const char *name = mxGetFieldNameByNumber(options, number);
        const mxArray *value = mxGetFieldByNumber(options, 0, number);
        size_t i;
        for (i = 0; i < count && strcmp(settings[i].name, name) != 0; i++) {
        }
        if (i == count) {
            return fail_unknown(name, settings, count);
        }
        if (value == NULL || !field_take(&settings[i], base, value)) {
            return value != NULL ? 0 : fail(FAIL_ARGUMENT, "%s: a value is missing", name);
        }
    }
    return 1;
}

/* A period of 0 means: do not subscribe. */
static void drop_unwanted(roburoc4_config *config) {
    uint16_t usual_ms[8];
    roburoc4_config defaults;
    (void)roburoc4_config_init(&defaults, sizeof defaults);
    memcpy(usual_ms, defaults.period_ms, sizeof usual_ms);
    for (uint32_t service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++) {
        if (config->period_ms[service] == 0) {
            config->period_ms[service] = usual_ms[service];
            config->subscriptions &= ~((uint32_t)1 << service);
        }
    }
}

#define BUFFER_DEFAULT 50000u

int settings_of_robot(const mxArray *options, robot_settings *out) {
    const char *wrong;
    (void)roburoc4_config_init(&out->config, sizeof out->config);
    out->buffer = BUFFER_DEFAULT;
    if (!write_all(options, of_robot, COUNT_OF(of_robot), out)) {
        return 0;
    }
    drop_unwanted(&out->config);
    wrong = roburoc4_config_error(&out->config);
    if (wrong != NULL) {
        return fail(FAIL_ARGUMENT, "option out of range: %s", wrong);
    }
    if (out->buffer < ROBUROC4_PUMP_QUEUE_MIN || out->buffer > ROBUROC4_PUMP_QUEUE_MAX) {
        return fail(FAIL_ARGUMENT, "buffer: %lu is out of range; give %d to %d",
                    (unsigned long)out->buffer, ROBUROC4_PUMP_QUEUE_MIN, ROBUROC4_PUMP_QUEUE_MAX);
    }
    return 1;
}

int settings_of_simulator(const mxArray *options, roburoc4_sim_config *out) {
    const char *wrong;
    roburoc4_sim_config_init(out);
    if (!write_all(options, of_simulator, COUNT_OF(of_simulator), out)) {
        return 0;
    }
    wrong = roburoc4_sim_config_error(out);
    return wrong == NULL ? 1 : fail(FAIL_ARGUMENT, "option out of range: %s", wrong);
}

int settings_of_faults(const mxArray *options, roburoc4_sim_faults *out) {
    *out = (roburoc4_sim_faults){0};
    return write_all(options, of_faults, COUNT_OF(of_faults), out);
}
