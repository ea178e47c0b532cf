/* SPDX-License-Identifier: MIT
 *
 * The configuration's members by name, for command lines and files.
 */
#include <float.h>
#include <stddef.h>
#include <string.h>

#include "config_file.h"
#include "model.h"

typedef enum kind { WHOLE, WHOLE_64, SIGNED, FLOAT, DOUBLE } kind;

typedef struct member {
    const char *name;
    size_t offset;
    kind kind;
} member;

#define MEMBER(name, kind)                                                                         \
    { #name, offsetof(roburoc4_sim_config, name), kind }

static const member members[] = {
    MEMBER(watchdog_cycles, WHOLE),
    MEMBER(seed, WHOLE_64),
    MEMBER(plain_types, WHOLE),
    MEMBER(hidden_services, WHOLE),
    MEMBER(refused_inserts, WHOLE),
    MEMBER(query_mode, WHOLE),
    MEMBER(answer_id_fixed, WHOLE),
    MEMBER(only_id_fixed, WHOLE),
    MEMBER(error_header, WHOLE),
    MEMBER(start_safe, WHOLE),
    MEMBER(as_manual, WHOLE),
    MEMBER(localization_flags, WHOLE),
    MEMBER(analog_inputs, SIGNED),
    MEMBER(analog_outputs, SIGNED),
    MEMBER(digital_inputs, SIGNED),
    MEMBER(digital_outputs, SIGNED),
    MEMBER(max_linear_m_s, FLOAT),
    MEMBER(min_linear_m_s, FLOAT),
    MEMBER(max_angular_rad_s, FLOAT),
    MEMBER(min_angular_rad_s, FLOAT),
    MEMBER(max_linear_m_s2, FLOAT),
    MEMBER(min_linear_m_s2, FLOAT),
    MEMBER(max_angular_rad_s2, FLOAT),
    MEMBER(min_angular_rad_s2, FLOAT),
    MEMBER(width_m, FLOAT),
    MEMBER(slip, FLOAT),
    MEMBER(nominal_voltage_v, FLOAT),
    MEMBER(capacity_ah, FLOAT),
    MEMBER(battery_percent, FLOAT),
    MEMBER(minimum_percent, WHOLE),
    MEMBER(start_x_m, DOUBLE),
    MEMBER(start_y_m, DOUBLE),
    MEMBER(start_theta_rad, DOUBLE),
};

/* An integer within these limits, all of which a double holds exactly. */
static bool is_whole(double value, double min, double max) {
    return value >= min && value <= max && floor(value) >= value;
}

static bool store(void *at, kind kind, double value) {
    switch (kind) {
    case WHOLE:
        if (is_whole(value, 0.0, UINT32_MAX)) {
            *(uint32_t *)at = (uint32_t)value;
            return true;
        }
        return false;
    case WHOLE_64:
        if (is_whole(value, 0.0, 9007199254740992.0)) {
            *(uint64_t *)at = (uint64_t)value;
            return true;
        }
        return false;
    case SIGNED:
        if (is_whole(value, INT32_MIN, INT32_MAX)) {
            *(int32_t *)at = (int32_t)value;
            return true;
        }
        return false;
    case FLOAT:
        if (sim_is_finite(value) && fabs(value) > (double)FLT_MAX) {
            return false;
        }
        *(float *)at = (float)value;
        return true;
    default:
        *(double *)at = value;
        return true;
    }
}

roburoc4_result sim_config_set(roburoc4_sim_config *config, const char *name, double value) {
    for (size_t index = 0; index < sizeof members / sizeof members[0]; index++) {
        const member *found = &members[index];
        bool known = found->offset < config->size; /* to the version that made the struct */
        if (known && strcmp(found->name, name) == 0) {
            void *at = (uint8_t *)config + found->offset;
            return store(at, found->kind, value) ? ROBUROC4_OK : ROBUROC4_ERR_ARGUMENT;
        }
    }
    return ROBUROC4_ERR_INDEX;
}

const char *sim_config_name(uint32_t index) {
    return index < sizeof members / sizeof members[0] ? members[index].name : NULL;
}
