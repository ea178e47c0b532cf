/* SPDX-License-Identifier: MIT
 *
 * The control panel in words. Its one job is to turn a line of text into the setter that does it,
 * from one table, which `help` prints too.
 */
#include <stdio.h>
#include <string.h>

#include "model.h"
#include "number.h"

#define MAX_WORDS 8
#define MAX_LINE 160

/* The words after the command's name. */
typedef struct words {
    uint32_t count;
    const char *at[MAX_WORDS];
} words;

typedef struct panel_answer {
    char *text;
    size_t capacity;
} panel_answer;

typedef struct choice {
    const char *word;
    uint32_t value;
} choice;

#define NOT_UNDERSTOOD ROBUROC4_ERR_ARGUMENT

static bool choose(const char *word, const choice *choices, size_t count, uint32_t *value) {
    for (size_t index = 0; index < count; index++) {
        if (strcmp(word, choices[index].word) == 0) {
            *value = choices[index].value;
            return true;
        }
    }
    return false;
}

#define CHOOSE(word, choices, value)                                                               \
    choose(word, choices, sizeof(choices) / sizeof((choices)[0]), value)

static bool decimal(const char *word, double min, double max, double *value) {
    return number_decimal(word, strlen(word), min, max, value);
}

static bool whole(const char *word, uint64_t max, uint32_t *value) {
    uint64_t read = 0;
    if (!number_whole(word, strlen(word), max, &read)) {
        return false;
    }
    *value = (uint32_t)read;
    return true;
}

static const choice on_off[] = {{"on", 1}, {"off", 0}};
static const choice press_release[] = {{"press", 1}, {"release", 0}};
static const choice down_up[] = {{"down", 1}, {"up", 0}};

/* -------------------------------------------------------------------------------- commands --- */

static const choice pad_buttons[] = {
    {"a", ROBUROC4_DI_PAD_A},
    {"b", ROBUROC4_DI_PAD_B},
    {"x", ROBUROC4_DI_PAD_X},
    {"y", ROBUROC4_DI_PAD_Y},
    {"back", ROBUROC4_DI_PAD_BACK},
    {"start", ROBUROC4_DI_PAD_START},
    {"ddown", ROBUROC4_DI_PAD_D_DOWN},
    {"dleft", ROBUROC4_DI_PAD_D_LEFT},
    {"dright", ROBUROC4_DI_PAD_D_RIGHT},
    {"dup", ROBUROC4_DI_PAD_D_UP},
    {"lj", ROBUROC4_DI_PAD_LJ_CLICK},
    {"rj", ROBUROC4_DI_PAD_RJ_CLICK},
    {"lb", ROBUROC4_DI_PAD_LB},
    {"rb", ROBUROC4_DI_PAD_RB},
};
static const choice pad_axes[] = {
    {"ljx", ROBUROC4_AI_PAD_LJ_X}, {"ljy", ROBUROC4_AI_PAD_LJ_Y}, {"rjx", ROBUROC4_AI_PAD_RJ_X},
    {"rjy", ROBUROC4_AI_PAD_RJ_Y}, {"lt", ROBUROC4_AI_PAD_LT},    {"rt", ROBUROC4_AI_PAD_RT},
};

static roburoc4_result do_pad(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    (void)answer;
    uint32_t which = 0;
    uint32_t down = 0;
    double value = 0.0;
    if (line->count == 1 && strcmp(line->at[0], "release") == 0) {
        roburoc4_sim_release_pad(sim);
        return ROBUROC4_OK;
    }
    if (line->count != 2) {
        return NOT_UNDERSTOOD;
    }
    if (CHOOSE(line->at[0], pad_buttons, &which) && CHOOSE(line->at[1], down_up, &down)) {
        return roburoc4_sim_set_pad_button(sim, which, (int32_t)down);
    }
    if (CHOOSE(line->at[0], pad_axes, &which) && decimal(line->at[1], -1.0, 1.0, &value)) {
        return roburoc4_sim_set_pad_axis(sim, which, (float)value);
    }
    return NOT_UNDERSTOOD;
}

static roburoc4_result do_estop(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    static const choice which_estop[] = {{"local", ROBUROC4_SIM_ESTOP_LOCAL},
                                         {"remote", ROBUROC4_SIM_ESTOP_REMOTE}};
    (void)answer;
    uint32_t which = 0;
    uint32_t pressed = 0;
    if (line->count != 2 || !CHOOSE(line->at[0], which_estop, &which) ||
        !CHOOSE(line->at[1], press_release, &pressed)) {
        return NOT_UNDERSTOOD;
    }
    return roburoc4_sim_set_estop(sim, which, (int32_t)pressed);
}

static roburoc4_result do_bumper(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    static const choice which_bumper[] = {{"front", ROBUROC4_SIM_FRONT},
                                          {"rear", ROBUROC4_SIM_REAR}};
    (void)answer;
    uint32_t which = 0;
    uint32_t pressed = 0;
    if (line->count != 2 || !CHOOSE(line->at[0], which_bumper, &which) ||
        !CHOOSE(line->at[1], press_release, &pressed)) {
        return NOT_UNDERSTOOD;
    }
    return roburoc4_sim_set_bumper(sim, which, (int32_t)pressed);
}

static roburoc4_result do_brakes(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    static const choice positions[] = {{"automatic", ROBUROC4_SIM_BRAKES_AUTOMATIC},
                                       {"released", ROBUROC4_SIM_BRAKES_RELEASED}};
    (void)answer;
    uint32_t position = 0;
    if (line->count != 1 || !CHOOSE(line->at[0], positions, &position)) {
        return NOT_UNDERSTOOD;
    }
    return roburoc4_sim_set_brakes(sim, position);
}

static roburoc4_result do_motor(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    if (line->count != 1 || strcmp(line->at[0], "on") != 0) {
        return NOT_UNDERSTOOD;
    }
    roburoc4_result result = roburoc4_sim_press_motor_button(sim);
    if (result < 0) {
        (void)snprintf(answer->text, answer->capacity,
                       "no motor power: turn the power on, release both emergency stops and set "
                       "the brakes to automatic first");
    }
    return result;
}

static roburoc4_result do_power(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    (void)answer;
    uint32_t on = 0;
    if (line->count != 1 || !CHOOSE(line->at[0], on_off, &on)) {
        return NOT_UNDERSTOOD;
    }
    roburoc4_sim_set_power(sim, (int32_t)on);
    return ROBUROC4_OK;
}

static roburoc4_result do_charger(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    (void)answer;
    uint32_t on = 0;
    if (line->count != 1 || !CHOOSE(line->at[0], on_off, &on)) {
        return NOT_UNDERSTOOD;
    }
    roburoc4_sim_set_charger(sim, (int32_t)on);
    return ROBUROC4_OK;
}

static roburoc4_result do_battery(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    (void)answer;
    double percent = 0.0;
    if (line->count != 1 || !decimal(line->at[0], 0.0, 100.0, &percent)) {
        return NOT_UNDERSTOOD;
    }
    return roburoc4_sim_set_battery_percent(sim, (float)percent);
}

static roburoc4_result do_pin(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    (void)answer;
    uint32_t index = 0;
    uint32_t on = 0;
    double value = 0.0;
    if (line->count == 1 && strcmp(line->at[0], "none") == 0) {
        roburoc4_sim_unpin_inputs(sim);
        return ROBUROC4_OK;
    }
    if (line->count != 3 || !whole(line->at[1], ROBUROC4_SIM_MAX_DIGITAL, &index)) {
        return NOT_UNDERSTOOD;
    }
    if (strcmp(line->at[0], "analog") == 0 && decimal(line->at[2], -1e9, 1e9, &value)) {
        return roburoc4_sim_pin_analog_input(sim, index, (float)value);
    }
    if (strcmp(line->at[0], "digital") == 0 && CHOOSE(line->at[2], on_off, &on)) {
        return roburoc4_sim_pin_digital_input(sim, index, (int32_t)on);
    }
    return NOT_UNDERSTOOD;
}

static bool decimals(const words *line, uint32_t first, double *values, uint32_t count) {
    for (uint32_t index = 0; index < count; index++) {
        if (!decimal(line->at[first + index], -1e6, 1e6, &values[index])) {
            return false;
        }
    }
    return true;
}

static roburoc4_result world_result(roburoc4_result result, panel_answer *answer) {
    if (result == ROBUROC4_ERR_STATE) {
        (void)snprintf(answer->text, answer->capacity,
                       "robot and obstacle would overlap: choose another place");
    } else if (result == ROBUROC4_ERR_BUFFER) {
        (void)snprintf(answer->text, answer->capacity, "the world is full: clear it first");
        return ROBUROC4_ERR_STATE;
    } else if (result == ROBUROC4_ERR_INDEX) {
        return NOT_UNDERSTOOD;
    } else if (result >= 0) {
        (void)snprintf(answer->text, answer->capacity, "ok %d", (int)result);
    }
    return result;
}

static roburoc4_result do_box(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    double v[5] = {0};
    uint32_t number = 0;
    if (line->count == 1 && strcmp(line->at[0], "clear") == 0) {
        roburoc4_sim_clear_world(sim);
        return ROBUROC4_OK;
    }
    if (line->count == 6 && strcmp(line->at[0], "add") == 0 && decimals(line, 1, v, 5)) {
        return world_result(roburoc4_sim_add_box(sim, v[0], v[1], v[2], v[3], v[4]), answer);
    }
    if (line->count == 5 && strcmp(line->at[0], "wall") == 0 && decimals(line, 1, v, 4)) {
        return world_result(roburoc4_sim_add_wall(sim, v[0], v[1], v[2], v[3]), answer);
    }
    if (line->count == 5 && strcmp(line->at[0], "move") == 0 &&
        whole(line->at[1], ROBUROC4_SIM_MAX_BOXES, &number) && decimals(line, 2, v, 3)) {
        return world_result(roburoc4_sim_move_box(sim, number, v[0], v[1], v[2]), answer);
    }
    return NOT_UNDERSTOOD;
}

static roburoc4_result do_place(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    double v[3] = {0};
    if (line->count != 3 || !decimals(line, 0, v, 3)) {
        return NOT_UNDERSTOOD;
    }
    return world_result(roburoc4_sim_place(sim, v[0], v[1], v[2]), answer);
}

static roburoc4_result do_status(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    if (line->count != 0) {
        return NOT_UNDERSTOOD;
    }
    roburoc4_sim_state state = {.size = sizeof state};
    (void)roburoc4_sim_snapshot(sim, &state);
    (void)snprintf(
        answer->text, answer->capacity,
        "power %s, motors %s%s%s%s, %llu cycles, pose %.3f %.3f %.3f, odometry %.3f "
        "%.3f %.3f, speed %.3f m/s %.3f rad/s, target %.3f m/s %.3f rad/s, battery "
        "%.0f %% %.1f V %s, telemeters %.2f %.2f m, peers %u, subscriptions %u",
        state.powered ? "on" : "off", state.motors_enabled ? "on" : "off",
        state.overridden ? ", game pad drives" : "", state.bumper_front ? ", front bumper" : "",
        state.bumper_rear ? ", rear bumper" : "", (unsigned long long)state.cycles, state.true_x_m,
        state.true_y_m, state.true_theta_rad, state.odometry_x_m, state.odometry_y_m,
        state.odometry_theta_rad, state.wheel_linear_m_s, state.wheel_angular_rad_s,
        state.target_linear_m_s, state.target_angular_rad_s, (double)state.battery_percent,
        (double)state.battery_v, roburoc4_battery_state_name(state.battery_state),
        (double)state.telemeters_m[ROBUROC4_TELEMETER_FRONT],
        (double)state.telemeters_m[ROBUROC4_TELEMETER_REAR], state.peers, state.subscriptions);
    return ROBUROC4_OK;
}

static roburoc4_result do_help(roburoc4_sim *sim, const words *line, panel_answer *answer);

typedef struct command {
    const char *name;
    roburoc4_result (*obey)(roburoc4_sim *sim, const words *line, panel_answer *answer);
    const char *usage;
} command;

static const command commands[] = {
    {"pad", do_pad,
     "pad a|b|x|y|back|start|ddown|dleft|dright|dup|lj|rj|lb|rb down|up\n"
     "pad ljx|ljy|rjx|rjy|lt|rt -1..1   (triggers rest at -1)\n"
     "pad release"},
    {"estop", do_estop, "estop local|remote press|release"},
    {"brakes", do_brakes, "brakes automatic|released"},
    {"motor", do_motor, "motor on   (press the motor-power button)"},
    {"power", do_power, "power on|off"},
    {"charger", do_charger, "charger on|off"},
    {"battery", do_battery, "battery 0..100"},
    {"bumper", do_bumper, "bumper front|rear press|release"},
    {"pin", do_pin,
     "pin analog INDEX VALUE   (an input reports this, whatever it measures)\n"
     "pin digital INDEX on|off\n"
     "pin none"},
    {"box", do_box,
     "box add X Y SIZE_X SIZE_Y ANGLE   (metres, radians; answers its number)\n"
     "box wall X1 Y1 X2 Y2\n"
     "box move NUMBER X Y ANGLE\n"
     "box clear"},
    {"place", do_place, "place X Y ANGLE   (lift the robot there)"},
    {"status", do_status, "status"},
    {"help", do_help, "help"},
};

static roburoc4_result do_help(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    (void)sim;
    size_t used = 0;
    if (line->count != 0) {
        return NOT_UNDERSTOOD;
    }
    for (size_t index = 0; index < sizeof commands / sizeof commands[0]; index++) {
        int more = snprintf(answer->text + used, answer->capacity - used, "%s%s",
                            index == 0 ? "" : "\n", commands[index].usage);
        if (more < 0 || (size_t)more >= answer->capacity - used) {
            break;
        }
        used += (size_t)more;
    }
    return ROBUROC4_OK;
}

/* ------------------------------------------------------------------------------------ line --- */

/* Cut a copy of the line into lower-case words; false: too many, or too long. */
static bool split(const char *line, char *copy, size_t capacity, words *out) {
    out->count = 0;
    bool inside = false;
    for (size_t at = 0;; at++) {
        char c = line[at];
        if (at + 1 >= capacity && c != '\0') {
            return false;
        }
        bool blank = c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\0';
        if (!blank && !inside) {
            if (out->count == MAX_WORDS) {
                return false;
            }
            out->at[out->count++] = copy + at;
        }
        inside = !blank;
        copy[at] = blank ? '\0' : c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
        if (c == '\0') {
            return true;
        }
    }
}

static const command *find_command(const char *name) {
    for (size_t index = 0; index < sizeof commands / sizeof commands[0]; index++) {
        if (strcmp(name, commands[index].name) == 0) {
            return &commands[index];
        }
    }
    return NULL;
}

roburoc4_result roburoc4_sim_panel(roburoc4_sim *sim, const char *line, char *reply,
                                   size_t capacity) {
    char copy[MAX_LINE];
    words all;
    panel_answer answer = {reply, capacity};
    (void)snprintf(reply, capacity, "ok");
    if (!split(line, copy, sizeof copy, &all)) {
        (void)snprintf(reply, capacity, "line too long: try help");
        return NOT_UNDERSTOOD;
    }
    if (all.count == 0 || all.at[0][0] == '#') {
        return ROBUROC4_OK;
    }
    const command *found = find_command(all.at[0]);
    if (found == NULL) {
        (void)snprintf(reply, capacity, "unknown command '%s': try help", all.at[0]);
        return NOT_UNDERSTOOD;
    }
    words rest = {all.count - 1, {0}};
    memcpy(rest.at, all.at + 1, sizeof rest.at - sizeof rest.at[0]);
    roburoc4_result result = found->obey(sim, &rest, &answer);
    if (result == NOT_UNDERSTOOD || result == ROBUROC4_ERR_INDEX) {
        (void)snprintf(reply, capacity, "usage: %s", found->usage);
        return NOT_UNDERSTOOD;
    }
    return result < 0 ? result : ROBUROC4_OK;
}
