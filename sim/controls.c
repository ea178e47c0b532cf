/* SPDX-License-Identifier: MIT
 *
 * The table of controls, by number and by name, and the values that each accepts. What a value does
 * is up to the other parts.
 */
#include "controls.h"

#include <float.h>
#include <string.h>

#define MAX_WHOLE 9007199254740992.0 /* a double holds all up to it */

/* clang-format off */
#define ROW(number, count, name, zero, one, low, high) \
    {number, count, name, {zero, one}, low, high, 0, SIM_WHOLE}
static const sim_control controls[] = {
    ROW(ROBUROC4_SIM_POWER,              1, "power",              "off", "on",              0, 1),
    ROW(ROBUROC4_SIM_MOTOR_BUTTON,       1, "motor_button",       NULL, "on",               1, 1),
    ROW(ROBUROC4_SIM_ESTOP_LOCAL,        1, "estop_local",        "release", "press",       0, 1),
    ROW(ROBUROC4_SIM_ESTOP_REMOTE,       1, "estop_remote",       "release", "press",       0, 1),
    ROW(ROBUROC4_SIM_BRAKES_RELEASED,    1, "brakes_released",    "automatic", "released",  0, 1),
    ROW(ROBUROC4_SIM_CHARGER,            1, "charger",            "off", "on",              0, 1),
    ROW(ROBUROC4_SIM_BATTERY_PERCENT,    1, "battery_percent",    NULL, NULL,               0, 100),
    ROW(ROBUROC4_SIM_FRONT_BUMPER,       1, "front_bumper",       "release", "press",       0, 1),
    ROW(ROBUROC4_SIM_REAR_BUMPER,        1, "rear_bumper",        "release", "press",       0, 1),
    ROW(ROBUROC4_SIM_LOCALIZATION_FLAGS, 1, "localization_flags", NULL, NULL,               0, 127),
    ROW(ROBUROC4_SIM_PAD,                1, "pad",                "release", NULL,          0, 0),
    ROW(ROBUROC4_SIM_PIN,                1, "pin",                "none", NULL,             0, 0),
    ROW(ROBUROC4_SIM_FAMILY,             1, "family",             NULL, NULL,               0, MAX_WHOLE),
    ROW(ROBUROC4_SIM_FROZEN,             1, "frozen",             "none", NULL,             0, 124),
#define STORED(number, name, zero, one, member, kind, low, high) \
    {ROBUROC4_SIM_##number, 1, name, {zero, one}, low, high, \
     offsetof(roburoc4_sim, member), SIM_##kind}
    STORED(NAN,                "nan",             "none", NULL, nan,             WHOLE, 0, 124),
    STORED(BLOCKED_LINEAR,     "blocked_linear",  "off", "on",  blocked_linear,  WHOLE, 0, 1),
    STORED(BLOCKED_ANGULAR,    "blocked_angular", "off", "on",  blocked_angular, WHOLE, 0, 1),
#define NUMBER(number, name, member, kind, low, high) \
    STORED(number, name, NULL, NULL, member, kind, low, high)
    NUMBER(UPTIME_CYCLES,      "uptime_cycles",      config.uptime_cycles,  WHOLE_64, 0, MAX_WHOLE),
    NUMBER(CREEP_M_S,          "creep_m_s",          creep.linear_m_s,      DOUBLE,   -2.6, 2.6),
    NUMBER(CREEP_RAD_S,        "creep_rad_s",        creep.angular_rad_s,   DOUBLE,   -6.5, 6.5),
    NUMBER(ODOMETRY_SCALE,     "odometry_scale",     config.odometry_scale, FLOAT,    -2, 2),
    NUMBER(ODOMETRY_X_M,       "odometry_x_m",       odometry.x_m,          DOUBLE,   -1e5, 1e5),
    NUMBER(ODOMETRY_Y_M,       "odometry_y_m",       odometry.y_m,          DOUBLE,   -1e5, 1e5),
    NUMBER(ODOMETRY_THETA_RAD, "odometry_theta_rad", odometry.theta_rad,    DOUBLE,   -4, 4),
#define QUEUE(number, which) \
    NUMBER(QUEUE_##number##_MS, "queue_" #which "_ms", config.queue_##which##_ms, WHOLE, 0, \
           ROBUROC4_SIM_MAX_QUEUE_MS)
    QUEUE(UPLINK, uplink), QUEUE(ANSWER, answer), QUEUE(TEXT, text), QUEUE(IOCARD, iocard),
    QUEUE(TELEMETER, telemeter), QUEUE(BATTERY, battery), QUEUE(LOCALIZATION, localization),
    QUEUE(DIFFERENTIAL, differential),
#define BUTTON(channel, name) \
    ROW(ROBUROC4_SIM_PAD_BUTTON + ROBUROC4_DI_PAD_##channel, 1, "pad_" name, "up", "down", 0, 1)
    BUTTON(A, "a"), BUTTON(B, "b"), BUTTON(X, "x"), BUTTON(Y, "y"), BUTTON(BACK, "back"),
    BUTTON(START, "start"), BUTTON(D_DOWN, "d_down"), BUTTON(D_LEFT, "d_left"),
    BUTTON(D_RIGHT, "d_right"), BUTTON(D_UP, "d_up"), BUTTON(LJ_CLICK, "lj"),
    BUTTON(RJ_CLICK, "rj"), BUTTON(LB, "lb"), BUTTON(RB, "rb"),
#define AXIS(channel, name) \
    ROW(ROBUROC4_SIM_PAD_AXIS + ROBUROC4_AI_PAD_##channel, 1, "pad_" name, NULL, NULL, -1, 1)
    AXIS(LJ_X, "lj_x"), AXIS(LJ_Y, "lj_y"), AXIS(RJ_X, "rj_x"), AXIS(RJ_Y, "rj_y"),
    AXIS(LT, "lt"), AXIS(RT, "rt"),
    /* with an index after the name; controls without values are read-only */
    ROW(ROBUROC4_SIM_PIN_ANALOG,     ROBUROC4_SIM_MAX_ANALOG,  "pin_analog",     NULL, NULL, 0, 0),
    ROW(ROBUROC4_SIM_PIN_DIGITAL,    ROBUROC4_SIM_MAX_DIGITAL, "pin_digital",    "off", "on", 0, 1),
    ROW(ROBUROC4_SIM_ANALOG_OUTPUT,  ROBUROC4_SIM_MAX_ANALOG,  "analog_output",  NULL, NULL, 1, 0),
    ROW(ROBUROC4_SIM_DIGITAL_OUTPUT, ROBUROC4_SIM_MAX_DIGITAL, "digital_output", NULL, NULL, 1, 0),
};
/* clang-format on */

#define CONTROLS (sizeof controls / sizeof controls[0])

const sim_control *sim_control_numbered(uint32_t number) {
    for (size_t row = 0; row < CONTROLS; row++) {
        if (number >= controls[row].number && number - controls[row].number < controls[row].count) {
            return &controls[row];
        }
    }
    return NULL;
}

/* ----------------------------------------------------------------------------------- names --- */

typedef enum likeness { DIFFERENT, BEGINNING, SAME } likeness;

/* How well the first `length` letters of a name match a control's, ignoring underscores. */
static likeness compare(const char *name, size_t length, const char *control) {
    for (size_t at = 0; at < length; at++) {
        if (name[at] == '_') {
            continue;
        }
        control += *control == '_' ? 1 : 0;
        if (name[at] != *control++) {
            return DIFFERENT;
        }
    }
    return *control == '\0' ? SAME : *control == '_' ? BEGINNING : DIFFERENT;
}

/* The digits at the end of a name, as a number below 1000; their count. */
static size_t index_behind(const char *name, size_t length, uint32_t *index) {
    size_t digits = 0;
    uint32_t weight = 1;
    *index = 0;
    while (digits < 3 && digits < length && name[length - 1 - digits] >= '0' &&
           name[length - 1 - digits] <= '9') {
        *index += weight * (uint32_t)(name[length - 1 - digits] - '0');
        weight *= 10;
        digits++;
    }
    return digits;
}

roburoc4_result roburoc4_sim_control_find(const char *name) {
    uint32_t index = 0;
    size_t all = strlen(name);
    size_t digits = index_behind(name, all, &index);
    roburoc4_result beginning = ROBUROC4_ERR_INDEX;
    uint32_t beginnings = 0;
    for (size_t row = 0; row < CONTROLS; row++) {
        const sim_control *control = &controls[row];
        bool has_index = control->count > 1;
        likeness found = has_index == (digits > 0) && index < control->count
                             ? compare(name, all - digits, control->name)
                             : DIFFERENT;
        if (found == SAME) {
            return (roburoc4_result)(control->number + index);
        }
        if (found == BEGINNING && !has_index) {
            beginning = (roburoc4_result)control->number;
            beginnings++;
        }
    }
    return beginnings == 1 ? beginning : ROBUROC4_ERR_INDEX;
}

/* --------------------------------------------------------------------------------- setting --- */

static bool accepts(const sim_control *control, double value) {
    if (control->number == ROBUROC4_SIM_PIN_ANALOG) {
        return !(sim_is_finite(value) && fabs(value) > (double)FLT_MAX);
    }
    bool whole = (control->low >= 0.0 && control->high <= 1.0) ||
                 control->number == ROBUROC4_SIM_LOCALIZATION_FLAGS ||
                 control->number == ROBUROC4_SIM_FAMILY || control->number == ROBUROC4_SIM_FROZEN;
    return value >= control->low && value <= control->high && (!whole || floor(value) >= value);
}

static roburoc4_result pin(roburoc4_sim *sim, uint32_t kind, uint32_t index, double value) {
    bool analog = kind == ROBUROC4_SIM_PIN_ANALOG;
    if (index >= (uint32_t)(analog ? sim->config.analog_inputs : sim->config.digital_inputs)) {
        return ROBUROC4_ERR_INDEX;
    }
    if (analog) {
        sim->analog_pins[index] = (float)value;
        sim->analog_pinned[index] = true;
    } else {
        sim->digital_pins[index] = value > 0.0 ? 1 : 0;
    }
    return ROBUROC4_OK;
}

static void become_member(roburoc4_sim *sim, uint64_t seed) {
    roburoc4_sim_config config;
    (void)roburoc4_sim_config_family(&config, sizeof config, seed);
    sim_robot_replace(sim, &config);
}

static roburoc4_result set(roburoc4_sim *sim, uint32_t number, double value) {
    bool on = value > 0.0;
    switch (number) {
    case ROBUROC4_SIM_POWER:
        sim_cockpit_switch(sim, on);
        break;
    case ROBUROC4_SIM_MOTOR_BUTTON:
        return sim_cockpit_press_motor_button(sim) ? ROBUROC4_OK : ROBUROC4_ERR_STATE;
    case ROBUROC4_SIM_ESTOP_LOCAL:
    case ROBUROC4_SIM_ESTOP_REMOTE:
        sim->estop[number - ROBUROC4_SIM_ESTOP_LOCAL] = on;
        break;
    case ROBUROC4_SIM_BRAKES_RELEASED:
        sim->brakes_released = on;
        break;
    case ROBUROC4_SIM_CHARGER:
        sim->charger = on;
        break;
    case ROBUROC4_SIM_BATTERY_PERCENT:
        sim_battery_set(sim, (float)value);
        break;
    case ROBUROC4_SIM_FRONT_BUMPER:
    case ROBUROC4_SIM_REAR_BUMPER:
        sim->bumper_pressed[number - ROBUROC4_SIM_FRONT_BUMPER] = on;
        break;
    case ROBUROC4_SIM_LOCALIZATION_FLAGS:
        sim->localization_flags = (uint32_t)value;
        break;
    case ROBUROC4_SIM_PAD:
        sim_cockpit_release_pad(sim);
        break;
    case ROBUROC4_SIM_PIN:
        sim_inputs_unpin(sim);
        break;
    case ROBUROC4_SIM_FAMILY:
        become_member(sim, (uint64_t)value);
        break;
    case ROBUROC4_SIM_FROZEN:
        sim_services_freeze(sim, (uint32_t)value);
        break;
    default:
        if (number >= ROBUROC4_SIM_PAD_AXIS) {
            sim->axes[number - ROBUROC4_SIM_PAD_AXIS - ROBUROC4_AI_PAD_LJ_X] = (float)value;
        } else {
            sim_cockpit_press(sim, number - ROBUROC4_SIM_PAD_BUTTON, on);
        }
        break;
    }
    sim_cockpit_check_motors(sim);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_sim_set(roburoc4_sim *sim, uint32_t number, double value) {
    const sim_control *control = sim_control_numbered(number);
    if (control == NULL || control->number >= ROBUROC4_SIM_ANALOG_OUTPUT) {
        return ROBUROC4_ERR_INDEX;
    }
    if (!accepts(control, value)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    if (control->offset != 0) {
        bool stored = sim_value_store((uint8_t *)sim + control->offset, control->kind, value);
        return stored ? ROBUROC4_OK : ROBUROC4_ERR_ARGUMENT;
    }
    return control->count > 1 ? pin(sim, control->number, number - control->number, value)
                              : set(sim, number, value);
}

/* --------------------------------------------------------------------------------- reading --- */

static roburoc4_result get_channel(const roburoc4_sim *sim, uint32_t kind, uint32_t index,
                                   double *out) {
    const roburoc4_sim_config *config = &sim->config;
    int32_t count = kind == ROBUROC4_SIM_PIN_ANALOG      ? config->analog_inputs
                    : kind == ROBUROC4_SIM_PIN_DIGITAL   ? config->digital_inputs
                    : kind == ROBUROC4_SIM_ANALOG_OUTPUT ? config->analog_outputs
                                                         : config->digital_outputs;
    if (index >= (uint32_t)count) {
        return ROBUROC4_ERR_INDEX;
    }
    if (kind == ROBUROC4_SIM_PIN_ANALOG) {
        *out = (double)sim_analog_input(sim, index);
    } else if (kind == ROBUROC4_SIM_PIN_DIGITAL) {
        *out = sim_digital_input(sim, index) ? 1.0 : 0.0;
    } else if (kind == ROBUROC4_SIM_ANALOG_OUTPUT) {
        *out = (double)sim->analog_outputs[index];
    } else {
        bool on = index == ROBUROC4_DO_WATCHDOG ? sim->fed : sim->digital_outputs[index] != 0;
        *out = on ? 1.0 : 0.0;
    }
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_sim_get(const roburoc4_sim *sim, uint32_t number, double *out) {
    const sim_control *control = sim_control_numbered(number);
    if (control == NULL || number == ROBUROC4_SIM_PAD || number == ROBUROC4_SIM_PIN ||
        number == ROBUROC4_SIM_FAMILY) {
        return ROBUROC4_ERR_INDEX;
    }
    if (control->offset != 0) {
        *out = sim_value_get((const uint8_t *)sim + control->offset, control->kind);
        return ROBUROC4_OK;
    }
    if (control->count > 1) {
        return get_channel(sim, control->number, number - control->number, out);
    }
    switch (number) {
    case ROBUROC4_SIM_POWER:
        *out = sim->powered;
        break;
    case ROBUROC4_SIM_MOTOR_BUTTON:
        *out = sim->motors;
        break;
    case ROBUROC4_SIM_ESTOP_LOCAL:
    case ROBUROC4_SIM_ESTOP_REMOTE:
        *out = sim->estop[number - ROBUROC4_SIM_ESTOP_LOCAL];
        break;
    case ROBUROC4_SIM_BRAKES_RELEASED:
        *out = sim->brakes_released;
        break;
    case ROBUROC4_SIM_CHARGER:
        *out = sim->charger;
        break;
    case ROBUROC4_SIM_BATTERY_PERCENT:
        *out = (double)sim_battery_percent(sim);
        break;
    case ROBUROC4_SIM_FRONT_BUMPER:
    case ROBUROC4_SIM_REAR_BUMPER:
        *out = sim_bumper(sim, number - ROBUROC4_SIM_FRONT_BUMPER);
        break;
    case ROBUROC4_SIM_LOCALIZATION_FLAGS:
        *out = sim->localization_flags;
        break;
    case ROBUROC4_SIM_FROZEN:
        *out = sim->frozen;
        break;
    default:
        if (number >= ROBUROC4_SIM_PAD_AXIS) {
            *out = (double)sim->axes[number - ROBUROC4_SIM_PAD_AXIS - ROBUROC4_AI_PAD_LJ_X];
        } else if (number - ROBUROC4_SIM_PAD_BUTTON - ROBUROC4_DI_PAD_A < SIM_PAD_BUTTONS) {
            *out = sim->buttons[number - ROBUROC4_SIM_PAD_BUTTON - ROBUROC4_DI_PAD_A];
        }
        break;
    }
    return ROBUROC4_OK;
}
