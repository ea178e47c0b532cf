/* SPDX-License-Identifier: MIT
 *
 * The options of robots and simulators. The client's ranges are checked by roburoc4_config_error(),
 * and the simulator's members are known by name to config_file.h and roburoc4_sim_config_error().
 */
#include <stdio.h>
#include <string.h>

#include "commands.h"
#include "config_file.h"

/* ------------------------------------------------------------------------------ of one robot ---
 */

static const char robot_file[] = "robot_file"; /* read before all others, which take precedence */

/* Read the file that the options name, if they do: then `found`. */
static int take_robot_file(const mxArray *options, roburoc4_robot_file *file, int *found) {
    const mxArray *value = mxIsStruct(options) ? mxGetField(options, 0, robot_file) : NULL;
    char path[TEXT_SIZE], text[4 * ROBUROC4_ROBOT_FILE_SIZE]; /* with room for comments */
    const char *remedy = NULL;
    uint32_t line = 0;
    *found = value != NULL;
    if (value == NULL) {
        return 1;
    }
    if (!take_text(value, robot_file, path)) {
        return 0;
    }
    FILE *opened = fopen(path, "rb");
    if (opened == NULL) {
        return fail(FAIL_ARGUMENT, "robot_file: %s cannot be opened", path);
    }
    const size_t length = fread(text, 1, sizeof text, opened);
    const int whole = length < sizeof text && ferror(opened) == 0;
    (void)fclose(opened);
    if (!whole) {
        return fail(FAIL_ARGUMENT, "robot_file: %s cannot be read, or is longer than 24 kB", path);
    }
    return roburoc4_robot_file_read(file, text, length, &line, &remedy) >= 0 ||
           fail(FAIL_ARGUMENT, "robot_file: %s: line %u: %s", path, (unsigned)line, remedy);
}

/* ---------------------------------------------------------------------------- of the client --- */

#define WHOLE_OF(name) FIELD(roburoc4_config, name, UINT)
#define FLOAT_OF(name) FIELD(roburoc4_config, name, FLOAT)
#define PERIOD(name, service)                                                                      \
    FIELD_AS(name, roburoc4_config, period_ms[ROBUROC4_SERVICE_##service], UINT)
#define ROLE(name, role) FIELD_AS(name, roburoc4_config, role_index[ROBUROC4_ROLE_##role], INT)
#define OPTION(name, bit)                                                                          \
    {                                                                                              \
        name, offsetof(roburoc4_config, options), sizeof(uint32_t), FIELD_BIT, 0,                  \
            ROBUROC4_OPTION_##bit                                                                  \
    }

/* clang-format off */
static const field settings[] = {
    WHOLE_OF(first_retry_ms), WHOLE_OF(lost_ms), WHOLE_OF(fresh_ms), WHOLE_OF(drive_period_ms),
    WHOLE_OF(lease_ms), WHOLE_OF(robot_watchdog_ms), WHOLE_OF(lapse_disarm_ms),
    FIELD(roburoc4_config, iocard_id, INT), FIELD(roburoc4_config, differential_id, INT),
    FLOAT_OF(max_linear_m_s), FLOAT_OF(max_angular_rad_s), FLOAT_OF(scale_linear),
    FLOAT_OF(scale_angular),
    PERIOD("iocard_period_ms", IOCARD), PERIOD("telemeter_period_ms", TELEMETER),
    PERIOD("battery_period_ms", BATTERY), PERIOD("localization_period_ms", LOCALIZATION),
    PERIOD("differential_period_ms", DIFFERENTIAL),
    OPTION("keep_curvature", KEEP_CURVATURE),
    OPTION("allow_unknown_override", ALLOW_UNKNOWN_OVERRIDE),
    OPTION("ignore_other_commander", IGNORE_OTHER_COMMANDER),
    ROLE("override_index", OVERRIDE), ROLE("front_bumper_index", FRONT_BUMPER),
    ROLE("rear_bumper_index", REAR_BUMPER), ROLE("battery_voltage_index", BATTERY_V),
};
/* clang-format on */

static int store(const field *to, void *at, const mxArray *value) {
    const int is_float = to->type == FIELD_FLOAT, is_short = to->size == sizeof(int16_t);
    const int is_signed = to->type == FIELD_INT;
    const double least = is_float ? -1e30 : is_signed ? INT16_MIN : 0;
    const double most = is_float ? 1e30 : is_short ? INT16_MAX : is_signed ? INT32_MAX : UINT32_MAX;
    uint32_t *whole = at;
    double number = 0.0;
    if (!(is_float ? take_range : take_whole)(value, to->name, least,
                                              to->type == FIELD_BIT ? 1 : most, &number)) {
        return 0;
    }
    if (is_float) {
        *(float *)at = (float)number;
    } else if (is_short) {
        *(int16_t *)at = (int16_t)number;
    } else if (is_signed) {
        *(int32_t *)at = (int32_t)number;
    } else if (to->type == FIELD_UINT) {
        *whole = (uint32_t)number;
    } else {
        *whole = number != 0.0 ? *whole | (uint32_t)to->count : *whole & ~(uint32_t)to->count;
    }
    return 1;
}

static int take_setting(void *config, const char *name, const mxArray *value) {
    for (size_t i = 0; i < COUNT_OF(settings); i++) {
        if (strcmp(settings[i].name, name) == 0) {
            return store(&settings[i], (char *)config + settings[i].offset, value);
        }
    }
    return strcmp(name, robot_file) == 0 || fail(FAIL_ARGUMENT, "there is no option '%s'", name);
}

/* A period of 0 means: do not subscribe. */
static void drop_unwanted(roburoc4_config *config) {
    roburoc4_config usual;
    (void)roburoc4_config_init(&usual, sizeof usual);
    for (uint32_t service = FIRST_SERVICE; service < ROBUROC4_SERVICE_COUNT; service++) {
        if (config->period_ms[service] == 0) {
            config->period_ms[service] = usual.period_ms[service];
            config->subscriptions &= ~((uint32_t)1 << service);
        }
    }
}

/* ------------------------------------------------------------------------- of the simulator --- */

static int take_sim_setting(void *config, const char *name, const mxArray *value) {
    double number;
    if (strcmp(name, "family") == 0 ||
        strcmp(name, robot_file) == 0) { /* before all others: settings_of_simulator() */
        return 1;
    }
    return take_number(value, name, &number) &&
           (sim_config_set(config, name, number) >= 0 ||
            fail(FAIL_ARGUMENT, "%s: %g does not fit; see roburoc4_sim_config in roburoc4_sim.h",
                 name, number));
}

/* -------------------------------------------------------------------------------- of both --- */

static int take_all(const mxArray *options, void *config,
                    int (*take)(void *config, const char *name, const mxArray *value)) {
    int count;
    if (!mxIsStruct(options) || mxGetNumberOfElements(options) != 1) {
        return fail(FAIL_ARGUMENT, "options: give a scalar struct");
    }
    count = mxGetNumberOfFields(options);
    for (int i = 0; i < count; i++) {
        const char *name = mxGetFieldNameByNumber(options, i);
        const mxArray *value = mxGetFieldByNumber(options, 0, i);
        if (value == NULL || !take(config, name, value)) {
            return value != NULL ? 0 : fail(FAIL_ARGUMENT, "%s: a value is missing", name);
        }
    }
    return 1;
}

static int check(const char *wrong) {
    return wrong == NULL || fail(FAIL_ARGUMENT, "option out of range: %s", wrong);
}

int settings_of_robot(const mxArray *options, roburoc4_config *out) {
    roburoc4_robot_file file;
    int found;
    (void)roburoc4_config_init(out, sizeof *out);
    if (!take_robot_file(options, &file, &found)) {
        return 0;
    }
    if (found) {
        roburoc4_robot_file_config(&file, out);
    }
    if (!take_all(options, out, take_setting)) {
        return 0;
    }
    drop_unwanted(out);
    return check(roburoc4_config_error(out));
}

int settings_of_simulator(const mxArray *options, roburoc4_sim_config *out) {
    const mxArray *family = mxIsStruct(options) ? mxGetField(options, 0, "family") : NULL;
    double seed = 0.0;
    roburoc4_robot_file file;
    int found;
    (void)roburoc4_sim_config_init(out, sizeof *out);
    if (family != NULL) {
        if (!take_whole(family, "family", 0, 9007199254740992.0, &seed)) {
            return 0;
        }
        (void)roburoc4_sim_config_family(out, sizeof *out, (uint64_t)seed);
    }
    if (!take_robot_file(options, &file, &found)) {
        return 0;
    }
    if (found) {
        roburoc4_sim_config_robot_file(out, &file);
    }
    return take_all(options, out, take_sim_setting) && check(roburoc4_sim_config_error(out));
}

/* options(simulated): a struct whose fields are the names of a simulator's or a robot's options */
static int list_options(call *in) {
    const char *name;
    answer_flag(&in->out, robot_file, 1);
    if (in->numbers[0] != 0.0) {
        answer_flag(&in->out, "family", 1);
    }
    for (uint32_t i = 0; in->numbers[0] != 0.0 && (name = sim_config_name(i)) != NULL; i++) {
        answer_flag(&in->out, name, 1);
    }
    for (uint32_t i = 0; in->numbers[0] == 0.0 && i < COUNT_OF(settings); i++) {
        answer_flag(&in->out, settings[i].name, 1);
    }
    return 1;
}

const command settings_commands[] = {
    {"options", NO_ID, STRUCT, list_options, {SWITCH("simulated")}},
    LAST,
};
