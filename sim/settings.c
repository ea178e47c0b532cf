/* SPDX-License-Identifier: MIT
 *
 * The table of settings: the configuration's members with their names, defaults, limits, and the
 * range of each in the family of robots.
 */
#include "settings.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "model.h"

#define ROW(kind, name, member, usual, low, high, from, to)                                        \
    {                                                                                              \
        name, offsetof(roburoc4_sim_config, member), SIM_##kind, usual, low, high, from, to,       \
            name ": give " #low " to " #high                                                       \
    }
#define ONE(kind, member, usual, low, high, from, to)                                              \
    ROW(kind, #member, member, usual, low, high, from, to)
#define SWITCH(member) ONE(WHOLE, member, 0, 0, 1, 0, 1)
#define ANY(member, usual, from, to) ONE(FLOAT, member, usual, 1, 0, from, to)
#define QUEUE(member) ONE(WHOLE, member, 0, 0, 5000, 0, 400)
#define ID(name, service) ROW(SHORT, name "_id", service_ids[service], service, 2, 65535, 2, 65535)
#define TYPE(name, service, usual)                                                                 \
    ROW(SHORT, name "_type", service_types[service], usual, 0, 65535, 0, 65535)

/* clang-format off */
static const sim_setting settings[] = {
    /*  kind    member                  default   valid            in the family */
    ONE(WHOLE,  watchdog_cycles,        100,      1, 1000000,      30, 6000),
    ONE(WHOLE_64, seed,                 1,        1, 0,            1, 1), /* any */
    ID("iocard", 2), ID("telemeter", 3), ID("battery", 4), ID("localization", 5),
    ID("differential", 6),
    TYPE("iocard", 2, ROBUROC4_TYPE_IOCARD), TYPE("telemeter", 3, ROBUROC4_TYPE_TELEMETER),
    TYPE("battery", 4, 0x4006), /* documented nowhere */
    TYPE("localization", 5, ROBUROC4_TYPE_LOCALIZATION),
    TYPE("differential", 6, ROBUROC4_TYPE_DIFFERENTIAL),
    SWITCH(plain_types),
    ONE(WHOLE,  hidden_services,        0,        0, 127,          0, 124),
    ONE(WHOLE,  refused_inserts,        0,        0, 127,          0, 124),
    ONE(WHOLE,  query_mode,             0,        0, 5,            0, 5),
    SWITCH(answer_id_fixed),
    SWITCH(only_id_fixed),
    ONE(WHOLE,  error_header,           0,        0, 2,            0, 2),
    SWITCH(start_safe),
    ONE(WHOLE,  as_manual,              0,        0, 1,            0, 0),
    ONE(WHOLE,  localization_flags,     18,       0, 127,          18, 18),
    ONE(SIGNED, analog_inputs,          9,        0, 64,           0, 12),
    ONE(SIGNED, analog_outputs,         0,        0, 64,           0, 4),
    ONE(SIGNED, digital_inputs,         22,       0, 256,          0, 40),
    ONE(SIGNED, digital_outputs,        8,        0, 256,          0, 17),
    ANY(max_linear_m_s,                 2.6,                       0.5, 5),
    ANY(min_linear_m_s,                 -2.6,                      -5, -0.5),
    ANY(max_angular_rad_s,              6.5,                       0.5, 8),
    ANY(min_angular_rad_s,              -6.5,                      -8, -0.5),
    ANY(max_linear_m_s2,                3,                         0.5, 20),
    ANY(min_linear_m_s2,                -3,                        -20, -0.5),
    ANY(max_angular_rad_s2,             8,                         1, 40),
    ANY(min_angular_rad_s2,             -8,                        -40, -1),
    ANY(width_m,                        0.68,                      0.5, 1),
    ONE(FLOAT,  slip,                   0.12,     0, 0.9,          0, 0.9),
    ONE(FLOAT,  nominal_voltage_v,      24,       1, 1000,         24, 24),
    ONE(FLOAT,  capacity_ah,            60,       0.001, 100000,   60, 60),
    ONE(FLOAT,  battery_percent,        100,      0, 100,          100, 100),
    ONE(WHOLE,  minimum_percent,        20,       0, 100,          20, 20),
    ONE(DOUBLE, start_x_m,              0,        -100000, 100000, 0, 0),
    ONE(DOUBLE, start_y_m,              0,        -100000, 100000, 0, 0),
    ONE(DOUBLE, start_theta_rad,        0,        -1000000, 1000000, 0, 0),
    ONE(WHOLE_64, uptime_cycles,        0,        0, 9007199254740992, 0, 9007199254740992),
    ONE(SIGNED, clock_ppm,              0,        -1000, 1000,     -500, 500),
    SWITCH(stamp_measured),
    ONE(WHOLE,  error_code,             0,        0, 255,          0, 255),
    ONE(WHOLE,  surplus_bytes,          0,        0, 8,            0, 8),
    SWITCH(delete_refused),
    ONE(WHOLE,  replace_mode,           0,        0, 2,            0, 2),
    ONE(WHOLE,  input_shift,            0,        0, 8,            0, 8),
    ONE(WHOLE,  texts,                  0,        0, 31,           0, 31),
    ONE(WHOLE,  telemeters,             2,        0, 6,            0, 6),
    ONE(WHOLE,  reported_distances,     6,        0, 6,            0, 6),
    ONE(FLOAT,  telemeter_turn_rad,     0,        -3.142, 3.142,   -3.141, 3.141),
    SWITCH(other_status_port),
    ONE(WHOLE,  subscription_lists,     0,        0, 2,            0, 2),
    ONE(WHOLE,  min_period_cycles,      1,        1, 20,           1, 20),
    ONE(WHOLE,  max_subscriptions,      448,      1, 448,          1, 16),
    ONE(WHOLE,  full_list,              0,        0, 2,            0, 2),
    SWITCH(keep_subscriptions),
    ONE(WHOLE,  pad_keeps_target,       0,        0, 2,            0, 2),
    SWITCH(ignored_commands_feed),
    SWITCH(pad_target_hidden),
    SWITCH(tripped_target_shown),
    SWITCH(commands_need_motors),
    SWITCH(over_limit_refused),
    ONE(FLOAT,  linear_omega_rad_s,     2.46,     1.5, 1000,       1.5, 1000),
    ONE(FLOAT,  angular_omega_rad_s,    2.42,     1.5, 1000,       1.5, 1000),
    ONE(FLOAT,  linear_damping,         0.79,     0.6, 1.5,        0.6, 1.5),
    ONE(FLOAT,  angular_damping,        0.77,     0.6, 1.5,        0.6, 1.5),
    ONE(FLOAT,  linear_gain,            1,        0.85, 1.15,      0.85, 1.15),
    ONE(FLOAT,  angular_gain,           1,        0.85, 1.15,      0.85, 1.15),
    ONE(WHOLE,  dead_time_cycles,       0,        0, 15,           0, 15),
    SWITCH(late_targets),
    ONE(FLOAT,  speed_noise,            0,        0, 0.02,         0, 0.02),
    ONE(WHOLE,  odometry_period_cycles, 1,        1, 20,           1, 20),
    ONE(FLOAT,  odometry_scale,         1,        -2, 2,           -2, 2),
    SWITCH(odometry_mirrored),
    QUEUE(queue_uplink_ms),
    QUEUE(queue_answer_ms),
    ONE(WHOLE,  queue_text_ms,          0,        0, 5000,         0, 3000),
    QUEUE(queue_iocard_ms),
    QUEUE(queue_telemeter_ms),
    QUEUE(queue_battery_ms),
    QUEUE(queue_localization_ms),
    QUEUE(queue_differential_ms),
};
/* clang-format on */

const sim_setting *sim_setting_at(uint32_t index) {
    return index < sizeof settings / sizeof settings[0] ? &settings[index] : NULL;
}

const sim_setting *sim_setting_named(const char *name) {
    for (uint32_t index = 0; index < sizeof settings / sizeof settings[0]; index++) {
        if (strcmp(settings[index].name, name) == 0) {
            return &settings[index];
        }
    }
    return NULL;
}

const char *sim_setting_error(const sim_setting *setting, double value) {
    bool any = setting->low > setting->high;
    bool single = setting->kind == SIM_FLOAT; /* limits are rounded as the value is */
    double low = single ? (double)(float)setting->low : setting->low;
    double high = single ? (double)(float)setting->high : setting->high;
    double kept = single ? (double)(float)value : value;
    return any || (kept >= low && kept <= high) ? NULL : setting->remedy;
}

double sim_setting_get(const roburoc4_sim_config *config, const sim_setting *setting) {
    return sim_value_get((const uint8_t *)config + setting->offset, setting->kind);
}

double sim_value_get(const void *at, sim_kind kind) {
    switch (kind) {
    case SIM_SHORT:
        return *(const uint16_t *)at;
    case SIM_WHOLE:
        return *(const uint32_t *)at;
    case SIM_WHOLE_64:
        return (double)*(const uint64_t *)at;
    case SIM_SIGNED:
        return *(const int32_t *)at;
    case SIM_FLOAT:
        return (double)*(const float *)at;
    default:
        return *(const double *)at;
    }
}

/* An integer within these limits, all of which a double holds exactly. */
static bool is_whole(double value, double min, double max) {
    return value >= min && value <= max && floor(value) >= value;
}

bool sim_value_store(void *at, sim_kind kind, double value) {
    switch (kind) {
    case SIM_SHORT:
        if (is_whole(value, 0.0, UINT16_MAX)) {
            *(uint16_t *)at = (uint16_t)value;
            return true;
        }
        return false;
    case SIM_WHOLE:
        if (is_whole(value, 0.0, UINT32_MAX)) {
            *(uint32_t *)at = (uint32_t)value;
            return true;
        }
        return false;
    case SIM_WHOLE_64:
        if (is_whole(value, 0.0, 9007199254740992.0)) {
            *(uint64_t *)at = (uint64_t)value;
            return true;
        }
        return false;
    case SIM_SIGNED:
        if (is_whole(value, INT32_MIN, INT32_MAX)) {
            *(int32_t *)at = (int32_t)value;
            return true;
        }
        return false;
    case SIM_FLOAT:
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
    const sim_setting *found = sim_setting_named(name);
    if (found == NULL || found->offset >= config->size) { /* of the version that made the struct */
        return ROBUROC4_ERR_INDEX;
    }
    void *at = (uint8_t *)config + found->offset;
    return sim_value_store(at, found->kind, value) ? ROBUROC4_OK : ROBUROC4_ERR_ARGUMENT;
}

const char *sim_config_name(uint32_t index) {
    const sim_setting *setting = sim_setting_at(index);
    return setting != NULL ? setting->name : NULL;
}
