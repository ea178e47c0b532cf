/* SPDX-License-Identifier: MIT
 *
 * A table for each struct has the place and the type of each option; the ranges are checked by
 * roburoc4_config_error() and roburoc4_sim_config_error().
 */
#include "settings.h"

#include <stdio.h>
#include <string.h>

#include "fail.h"

/* Named in messages only. */
#define TAKEN_IN_M(name)                                                                           \
    { name, 0, 0, FIELD_UINT, 0 }
#define ROBOT_UINT(name) FIELD_AS(#name, robot_settings, config.name, UINT)
#define ROBOT_FLOAT(name) FIELD_AS(#name, robot_settings, config.name, FLOAT)
#define PERIOD(name, service)                                                                      \
    FIELD_AS(name, robot_settings, config.period_ms[ROBUROC4_SERVICE_##service], UINT)
#define ROLE(name, role)                                                                           \
    FIELD_AS(name, robot_settings, config.role_index[ROBUROC4_ROLE_##role], INT)
#define OPTION(name, bit)                                                                          \
    { name, offsetof(robot_settings, config.options), sizeof(uint32_t), FIELD_BIT, bit }

/* clang-format off */
static const field of_robot[] = {
    ROBOT_UINT(first_retry_ms), ROBOT_UINT(lost_ms), ROBOT_UINT(fresh_ms),
    ROBOT_UINT(drive_period_ms), ROBOT_UINT(lease_ms), ROBOT_UINT(robot_watchdog_ms),
    ROBOT_FLOAT(max_linear_m_s), ROBOT_FLOAT(max_angular_rad_s), ROBOT_FLOAT(scale_linear),
    ROBOT_FLOAT(scale_angular),
    PERIOD("iocard_period_ms", IOCARD), PERIOD("telemeter_period_ms", TELEMETER),
    PERIOD("battery_period_ms", BATTERY), PERIOD("localization_period_ms", LOCALIZATION),
    PERIOD("differential_period_ms", DIFFERENTIAL),
    OPTION("turn_keeping", ROBUROC4_OPTION_TURN_KEEPING),
    OPTION("allow_unknown_override", ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE),
    OPTION("ignore_other_commander", ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER),
    ROLE("override_index", OVERRIDE), ROLE("front_bumper_index", FRONT_BUMPER),
    ROLE("rear_bumper_index", REAR_BUMPER), ROLE("battery_voltage_index", BATTERY_V),
    FIELD(robot_settings, buffer, UINT), FIELD(robot_settings, record, TEXT), TAKEN_IN_M("timeout"),
};
/* clang-format on */

#define SIM_UINT(name) FIELD(roburoc4_sim_config, name, UINT)
#define SIM_INT(name) FIELD(roburoc4_sim_config, name, INT)
#define SIM_FLOAT(name) FIELD(roburoc4_sim_config, name, FLOAT)

/* clang-format off */
static const field of_simulator[] = {
    SIM_UINT(watchdog_cycles), SIM_UINT(seed), SIM_UINT(plain_types), SIM_UINT(hidden_services),
    SIM_UINT(refused_inserts), SIM_UINT(query_mode), SIM_UINT(answer_id_fixed),
    SIM_UINT(only_id_fixed), SIM_UINT(error_header), SIM_UINT(start_safe),
    SIM_UINT(as_manual), SIM_UINT(localization_flags),
    SIM_INT(analog_inputs), SIM_INT(analog_outputs), SIM_INT(digital_inputs),
    SIM_INT(digital_outputs),
    SIM_FLOAT(max_linear_m_s), SIM_FLOAT(min_linear_m_s), SIM_FLOAT(max_angular_rad_s),
    SIM_FLOAT(min_angular_rad_s), SIM_FLOAT(max_linear_m_s2), SIM_FLOAT(min_linear_m_s2),
    SIM_FLOAT(max_angular_rad_s2), SIM_FLOAT(min_angular_rad_s2), SIM_FLOAT(width_m),
    SIM_FLOAT(slip), SIM_FLOAT(nominal_voltage_v), SIM_FLOAT(capacity_ah),
    SIM_FLOAT(battery_percent), SIM_UINT(minimum_percent),
    SIM_FLOAT(start_x_m), SIM_FLOAT(start_y_m), SIM_FLOAT(start_theta_rad),
    TAKEN_IN_M("port"), TAKEN_IN_M("host"),
};
/* clang-format on */

static const field of_faults[] = {
    FIELD(roburoc4_sim_faults, loss, FLOAT),
    FIELD(roburoc4_sim_faults, duplicate, FLOAT),
    FIELD(roburoc4_sim_faults, reorder, FLOAT),
    FIELD(roburoc4_sim_faults, corrupt, FLOAT),
    FIELD_AS("delay_ms", roburoc4_sim_faults, delay_us, MS),
    FIELD_AS("jitter_ms", roburoc4_sim_faults, jitter_us, MS),
};

/* ------------------------------------------------------------------------------- all of them ---
 */

#define LONGEST_NAME 32

/* How many letters to change, insert or delete between two names (Levenshtein). */
static size_t letters_between(const char *a, const char *b) {
    size_t row[LONGEST_NAME + 1], i, j;
    const size_t width = strlen(b);
    if (width > LONGEST_NAME) {
        return LONGEST_NAME;
    }
    for (j = 0; j <= width; j++) {
        row[j] = j;
    }
    for (i = 0; a[i] != '\0'; i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (j = 0; j < width; j++) {
            const size_t above = row[j + 1];
            const size_t least = above < row[j] ? above : row[j];
            const size_t changed = diagonal + (a[i] != b[j]);
            row[j + 1] = least + 1 < changed ? least + 1 : changed;
            diagonal = above;
        }
    }
    return row[width];
}

static int fail_unknown(const char *name, const field *settings, size_t count) {
    char known[1536] = "", meant[LONGEST_NAME + 32] = "";
    size_t i, used = 0, nearest = 3;
    for (i = 0; i < count; i++) {
        const size_t distance = letters_between(settings[i].name, name);
        used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", i > 0 ? ", " : "",
                                 settings[i].name);
        if (distance < nearest) {
            nearest = distance;
            (void)snprintf(meant, sizeof meant, "; did you mean '%s'?", settings[i].name);
        }
    }
    return fail(FAIL_ARGUMENT, "there is no option '%s'%s There are %s", name,
                nearest < 3 ? meant : ".", known);
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
        if (i == count || settings[i].size == 0) {
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
    out->record[0] = '\0';
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
    (void)roburoc4_sim_config_init(out, sizeof *out);
    if (!write_all(options, of_simulator, COUNT_OF(of_simulator), out)) {
        return 0;
    }
    wrong = roburoc4_sim_config_error(out);
    return wrong == NULL ? 1 : fail(FAIL_ARGUMENT, "option out of range: %s", wrong);
}

int settings_of_faults(const mxArray *options, roburoc4_sim_faults *out) {
    *out = (roburoc4_sim_faults){.size = sizeof *out};
    return write_all(options, of_faults, COUNT_OF(of_faults), out);
}
