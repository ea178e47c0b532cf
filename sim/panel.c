/* SPDX-License-Identifier: MIT
 *
 * The control panel as text: `NAME VALUE` for each control of controls.c, and a few commands, which
 * `help` lists too.
 */
#include <stdio.h>
#include <string.h>

#include "controls.h"
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

#define NOT_UNDERSTOOD ROBUROC4_ERR_ARGUMENT

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

/* -------------------------------------------------------------------------------- controls --- */

/* The words of a name, as one. */
static void join(const words *line, char *name, size_t capacity) {
    size_t used = 0;
    name[0] = '\0';
    for (uint32_t at = 0; at + 1 < line->count && used < capacity; at++) {
        int more = snprintf(name + used, capacity - used, "%s%s", at > 0 ? "_" : "", line->at[at]);
        used += more > 0 ? (size_t)more : 0;
    }
}

static bool read_value(const sim_control *control, const char *word, double *value) {
    for (int which = 0; which < 2; which++) {
        if (control->words[which] != NULL && strcmp(word, control->words[which]) == 0) {
            *value = which;
            return true;
        }
    }
    return decimal(word, -1e18, 1e18, value);
}

static void explain(panel_answer *answer, const sim_control *control) {
    const char *index = control->count > 1 ? " INDEX" : "";
    const char *const *word = control->words;
    if (word[0] != NULL && word[1] != NULL) {
        (void)snprintf(answer->text, answer->capacity, "usage: %s%s %s|%s", control->name, index,
                       word[0], word[1]);
    } else if (word[0] != NULL || word[1] != NULL) {
        (void)snprintf(answer->text, answer->capacity, "usage: %s%s %s", control->name, index,
                       word[0] != NULL ? word[0] : word[1]);
    } else if (control->number == ROBUROC4_SIM_PIN_ANALOG) {
        (void)snprintf(answer->text, answer->capacity, "usage: %s%s VALUE", control->name, index);
    } else {
        (void)snprintf(answer->text, answer->capacity, "usage: %s%s %.16g..%.16g", control->name,
                       index, control->low, control->high);
    }
}

/* A line `NAME VALUE`; its name can be several words. */
static roburoc4_result do_control(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    char name[MAX_LINE];
    double value = 0.0;
    join(line, name, sizeof name);
    roburoc4_result number = roburoc4_sim_control_find(name);
    const sim_control *control = number < 0 ? NULL : sim_control_numbered((uint32_t)number);
    if (control == NULL) {
        (void)snprintf(answer->text, answer->capacity, "unknown command '%s': try help",
                       line->count > 1 ? name : line->at[0]);
        return NOT_UNDERSTOOD;
    }
    roburoc4_result result = read_value(control, line->at[line->count - 1], &value)
                                 ? roburoc4_sim_set(sim, (uint32_t)number, value)
                                 : NOT_UNDERSTOOD;
    if (result == ROBUROC4_ERR_STATE) {
        (void)snprintf(answer->text, answer->capacity,
                       "no motor power: turn the power on, release both emergency stops and set "
                       "the brakes to automatic first%s",
                       sim->config.as_manual != 0 ? "; unplug the charger, and charge the battery"
                                                  : "");
    } else if (result < 0) {
        explain(answer, control);
        return NOT_UNDERSTOOD;
    }
    return result;
}

/* -------------------------------------------------------------------------------- commands --- */

static bool decimals(const words *line, uint32_t first, double *values, uint32_t count) {
    for (uint32_t index = 0; index < count; index++) {
        if (!decimal(line->at[first + index], -1e6, 1e6, &values[index])) {
            return false;
        }
    }
    return true;
}

static roburoc4_result place_result(roburoc4_result result, panel_answer *answer) {
    if (result == ROBUROC4_ERR_STATE) {
        (void)snprintf(answer->text, answer->capacity,
                       "robot and obstacle would overlap: choose another place");
    } else if (result == ROBUROC4_ERR_BUFFER) {
        (void)snprintf(answer->text, answer->capacity,
                       "there are too many boxes: clear them first");
        return ROBUROC4_ERR_STATE;
    } else if (result == ROBUROC4_ERR_INDEX) {
        return NOT_UNDERSTOOD;
    } else if (result >= 0) {
        (void)snprintf(answer->text, answer->capacity, "ok %d", (int)result);
    }
    return result;
}

/* A wall is a thin box between two points. */
static roburoc4_result add_wall(roburoc4_sim *sim, const double v[4]) {
    double dx = v[2] - v[0];
    double dy = v[3] - v[1];
    return roburoc4_sim_add_box(sim, 0.5 * (v[0] + v[2]), 0.5 * (v[1] + v[3]), hypot(dx, dy),
                                SIM_WALL_THICKNESS_M, atan2(dy, dx));
}

static roburoc4_result do_box(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    double v[5] = {0};
    uint32_t number = 0;
    if (line->count == 1 && strcmp(line->at[0], "clear") == 0) {
        roburoc4_sim_clear_obstacles(sim);
        return ROBUROC4_OK;
    }
    if (line->count == 6 && strcmp(line->at[0], "add") == 0 && decimals(line, 1, v, 5)) {
        return place_result(roburoc4_sim_add_box(sim, v[0], v[1], v[2], v[3], v[4]), answer);
    }
    if (line->count == 5 && strcmp(line->at[0], "wall") == 0 && decimals(line, 1, v, 4)) {
        return place_result(add_wall(sim, v), answer);
    }
    if (line->count == 5 && strcmp(line->at[0], "move") == 0 &&
        whole(line->at[1], ROBUROC4_SIM_MAX_BOXES, &number) && decimals(line, 2, v, 3)) {
        return place_result(sim_obstacles_move_box(sim, number, v[0], v[1], v[2]), answer);
    }
    return NOT_UNDERSTOOD;
}

static roburoc4_result do_place(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    double v[3] = {0};
    if (line->count != 3 || !decimals(line, 0, v, 3)) {
        return NOT_UNDERSTOOD;
    }
    return place_result(roburoc4_sim_place(sim, v[0], v[1], v[2]), answer);
}

static roburoc4_result do_status(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    if (line->count != 0) {
        return NOT_UNDERSTOOD;
    }
    roburoc4_sim_state state = {.size = sizeof state};
    (void)roburoc4_sim_get_state(sim, &state);
    (void)snprintf(
        answer->text, answer->capacity,
        "power %s, motors %s%s%s%s, %llu cycles, pose %.3f %.3f %.3f, odometry %.3f "
        "%.3f %.3f, speed %.3f m/s %.3f rad/s, target %.3f m/s %.3f rad/s, battery "
        "%.0f %% %.1f V %s, telemeters %.2f %.2f m, peers %u, subscriptions %u",
        state.powered ? "on" : "off", state.motors_enabled ? "on" : "off",
        state.overridden ? ", game pad drives" : "", state.front_bumper ? ", front bumper" : "",
        state.rear_bumper ? ", rear bumper" : "", (unsigned long long)state.cycles, state.true_x_m,
        state.true_y_m, state.true_theta_rad, state.odometry_x_m, state.odometry_y_m,
        state.odometry_theta_rad, state.wheel_linear_m_s, state.wheel_angular_rad_s,
        state.target_linear_m_s, state.target_angular_rad_s, (double)state.battery_percent,
        (double)state.battery_v, roburoc4_name(ROBUROC4_NAME_BATTERY, state.battery_state),
        (double)state.distances_m[ROBUROC4_TELEMETER_FRONT],
        (double)state.distances_m[ROBUROC4_TELEMETER_REAR], state.peers, state.subscriptions);
    return ROBUROC4_OK;
}

static roburoc4_result do_help(roburoc4_sim *sim, const words *line, panel_answer *answer);

typedef struct command {
    const char *name;
    roburoc4_result (*obey)(roburoc4_sim *sim, const words *line, panel_answer *answer);
    const char *usage;
} command;

static const command commands[] = {
    {"box", do_box,
     "box add X Y SIZE_X SIZE_Y ANGLE   (metres, radians; answers its number)\n"
     "box wall X1 Y1 X2 Y2\n"
     "box move NUMBER X Y ANGLE\n"
     "box clear"},
    {"place", do_place, "place X Y ANGLE   (lift the robot there)"},
    {"status", do_status, "status"},
    {"help", do_help, "help"},
};

/* Lines that are not in commands[]. */
static const char controls_usage[] =
    "pad a|b|x|y|back|start|d_down|d_left|d_right|d_up|lj|rj|lb|rb down|up\n"
    "pad lj_x|lj_y|rj_x|rj_y|lt|rt -1..1   (triggers rest at -1)\n"
    "pad release\n"
    "estop local|remote press|release\n"
    "brakes automatic|released\n"
    "motor on   (press the motor-power button)\n"
    "power on|off\n"
    "charger on|off\n"
    "battery 0..100\n"
    "front|rear bumper press|release\n"
    "localization 0..127   (its flags; 82 with Error)\n"
    "pin analog INDEX VALUE   (an input reports this, whatever it measures)\n"
    "pin digital INDEX on|off\n"
    "pin none\n"
    "blocked linear|angular on|off   (the axis follows no target)\n"
    "creep m_s|rad_s SPEED   (added to what it does; with a blocked axis it runs away)\n"
    "frozen SERVICES   (their values stand still: 32 localization, 64 differential, 96 both)\n"
    "nan SERVICES\n"
    "odometry scale|x_m|y_m|theta_rad NUMBER\n"
    "queue uplink|answer|text|iocard|...|differential ms 0..5000\n"
    "uptime 0..9007199254740992   (cycles at the next power on)\n"
    "family SEED   (another robot at the same address)";

static roburoc4_result do_help(roburoc4_sim *sim, const words *line, panel_answer *answer) {
    (void)sim;
    if (line->count != 0) {
        return NOT_UNDERSTOOD;
    }
    (void)snprintf(answer->text, answer->capacity, "%s", controls_usage);
    for (size_t index = 0; index < sizeof commands / sizeof commands[0]; index++) {
        size_t used = strlen(answer->text);
        (void)snprintf(answer->text + used, answer->capacity - used, "\n%s", commands[index].usage);
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
        return do_control(sim, &all, &answer);
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
