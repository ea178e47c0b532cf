/* SPDX-License-Identifier: MIT
 *
 * Robot files: one table of names serves reader, writer and configuration.
 */
#include "bytes.h"
#include "machines.h"
#include "roburoc4_robot_file.h"

typedef struct row {
    const char *section, *name;
    float low, high;
    bool whole;
    const char *remedy;
} row;

#define WHOLE(section, name, low, high)                                                            \
    {                                                                                              \
#section, #name, (float)(low), (float)(high), true,                                        \
            #name ": give a whole number, " #low " to " #high                                      \
    }
#define NUMBER(section, name, low, high)                                                           \
    {                                                                                              \
#section, #name, (float)(low), (float)(high), false,                                       \
            #name ": give a number, " #low " to " #high                                            \
    }

static const row rows[] = {
    WHOLE(services, iocard_id, 2, 65535),
    WHOLE(services, telemeter_id, 2, 65535),
    WHOLE(services, battery_id, 2, 65535),
    WHOLE(services, localization_id, 2, 65535),
    WHOLE(services, differential_id, 2, 65535),
    WHOLE(services, iocard_type, 0, 65535),
    WHOLE(services, telemeter_type, 0, 65535),
    WHOLE(services, battery_type, 0, 65535),
    WHOLE(services, localization_type, 0, 65535),
    WHOLE(services, differential_type, 0, 65535),
    WHOLE(services, hidden_services, 0, 124),
    WHOLE(telegrams, only_id_fixed, 0, 1),
    WHOLE(telegrams, answer_id_fixed, 0, 1),
    WHOLE(telegrams, error_header, 0, 2),
    WHOLE(telegrams, error_code, 0, 255),
    WHOLE(telegrams, surplus_bytes, 0, 8),
    WHOLE(telegrams, delete_refused, 0, 1),
    WHOLE(telegrams, replace_mode, 0, 2),
    WHOLE(inputs, analog_inputs, 0, 64),
    WHOLE(inputs, analog_outputs, 0, 64),
    WHOLE(inputs, digital_inputs, 0, 256),
    WHOLE(inputs, digital_outputs, 0, 256),
    WHOLE(inputs, override_index, 0, 63),
    WHOLE(inputs, front_bumper_index, 0, 63),
    WHOLE(inputs, rear_bumper_index, 0, 63),
    WHOLE(inputs, battery_voltage_index, 0, 15),
    WHOLE(inputs, query_mode, 0, 5),
    WHOLE(inputs, texts, 0, 31),
    WHOLE(inputs, queue_text_ms, 0, 5000),
    WHOLE(telemeters, telemeters, 0, 6),
    WHOLE(telemeters, reported_distances, 0, 6),
    NUMBER(telemeters, telemeter_turn_rad, -3.1416, 3.1416),
    WHOLE(subscriptions, refused_inserts, 0, 124),
    WHOLE(subscriptions, subscription_lists, 0, 2),
    WHOLE(subscriptions, min_period_cycles, 1, 20),
    WHOLE(subscriptions, max_subscriptions, 1, 448),
    WHOLE(subscriptions, full_list, 0, 2),
    WHOLE(subscriptions, keep_subscriptions, 0, 1),
    WHOLE(subscriptions, other_status_port, 0, 1),
    WHOLE(commands, robot_watchdog_ms, 100, 60000),
    WHOLE(commands, tripped_target_shown, 0, 1),
    WHOLE(commands, pad_keeps_target, 0, 2),
    WHOLE(commands, ignored_commands_feed, 0, 1),
    WHOLE(commands, pad_target_hidden, 0, 1),
    WHOLE(commands, commands_need_motors, 0, 1),
    WHOLE(commands, over_limit_refused, 0, 1),
    WHOLE(commands, start_safe, 0, 1),
    NUMBER(limits, max_linear_m_s, -1000, 1000),
    NUMBER(limits, min_linear_m_s, -1000, 1000),
    NUMBER(limits, max_angular_rad_s, -1000, 1000),
    NUMBER(limits, min_angular_rad_s, -1000, 1000),
    NUMBER(limits, max_linear_m_s2, -1000, 1000),
    NUMBER(limits, min_linear_m_s2, -1000, 1000),
    NUMBER(limits, max_angular_rad_s2, -1000, 1000),
    NUMBER(limits, min_angular_rad_s2, -1000, 1000),
    NUMBER(limits, width_m, 0.1, 10),
    NUMBER(response, linear_omega_rad_s, 1.5, 1000),
    NUMBER(response, angular_omega_rad_s, 1.5, 1000),
    NUMBER(response, linear_damping, 0.6, 1.5),
    NUMBER(response, angular_damping, 0.6, 1.5),
    NUMBER(response, linear_gain, 0.85, 1.15),
    NUMBER(response, angular_gain, 0.85, 1.15),
    WHOLE(response, dead_time_cycles, 0, 15),
    WHOLE(response, late_targets, 0, 1),
    NUMBER(response, speed_noise, 0, 0.02),
    WHOLE(odometry, odometry_period_cycles, 1, 20),
    NUMBER(odometry, odometry_scale, -2, 2),
    WHOLE(odometry, odometry_mirrored, 0, 1),
    WHOLE(odometry, stamp_measured, 0, 1),
    WHOLE(odometry, clock_ppm, -1000, 1000),
    WHOLE(delays, queue_answer_ms, 0, 5000),
    WHOLE(delays, queue_iocard_ms, 0, 5000),
    WHOLE(delays, queue_telemeter_ms, 0, 5000),
    WHOLE(delays, queue_battery_ms, 0, 5000),
    WHOLE(delays, queue_localization_ms, 0, 5000),
    WHOLE(delays, queue_differential_ms, 0, 5000),
    NUMBER(calibration, scale_linear, 0.5, 2),
    NUMBER(calibration, scale_angular, 0.5, 2),
};

#define ROWS ((uint32_t)(sizeof rows / sizeof rows[0]))
#define WORDS (ROBUROC4_ROBOT_FILE_NAMES / 32)
/* Digits of a number that fit 32 bits. */
#define MAX_DIGITS 9u
#define DECIMALS 5
#define DECIMALS_FACTOR 100000u

typedef char assert_rows_fit[ROWS <= ROBUROC4_ROBOT_FILE_NAMES ? 1 : -1];

static const char no_assignment[] = "give NAME = VALUE, or a section such as [inputs]";
static const char no_name[] =
    "no such name: correct it, delete the line, or use a newer version of roburoc4";
static const char twice[] = "the same name again: delete one of the lines";
static const char nothing[] =
    "nothing is known here: give a file of roburoc4 first-contact or roburoc4 calibrate";
static const char same_ids[] = "another service has this id: give each its own";

/* ------------------------------------------------------------------------------------ values ---
 */

static bool is_known(const roburoc4_robot_file *file, uint32_t index) {
    return (file->private_known[index / 32] >> index % 32 & 1U) != 0;
}

static bool fits(const row *r, float value) {
    return between(value, r->low, r->high) &&
           (!r->whole || order_of((float)(int32_t)value) == order_of(value));
}

static void keep_value(roburoc4_robot_file *file, uint32_t index, float value) {
    file->private_values[index] = value;
    file->private_known[index / 32] |= (uint32_t)1 << index % 32;
}

static uint32_t find(const char *name, size_t length) {
    uint32_t index = 0;
    while (index < ROWS &&
           (strlen(rows[index].name) != length || strncmp(rows[index].name, name, length) != 0)) {
        index++;
    }
    return index;
}

const char *roburoc4_robot_file_name(uint32_t index) {
    return index < ROWS ? rows[index].name : NULL;
}

roburoc4_result roburoc4_robot_file_get(const roburoc4_robot_file *file, const char *name,
                                        float *out) {
    const uint32_t index = find(name, strlen(name));
    if (index == ROWS) {
        return ROBUROC4_ERR_INDEX;
    }
    if (!is_known(file, index)) {
        return ROBUROC4_ERR_NOT_KNOWN;
    }
    *out = file->private_values[index];
    return ROBUROC4_OK;
}

/** Whether another service has this id. */
static bool id_is_taken(const roburoc4_robot_file *file, uint32_t index, float id) {
    for (uint32_t other = 0; index < 5 && other < 5; other++) {
        if (other != index && is_known(file, other) &&
            order_of(file->private_values[other]) == order_of(id)) {
            return true;
        }
    }
    return false;
}

roburoc4_result roburoc4_robot_file_set(roburoc4_robot_file *file, const char *name, float value) {
    const uint32_t index = find(name, strlen(name));
    if (index == ROWS) {
        return ROBUROC4_ERR_INDEX;
    }
    if (!fits(&rows[index], value) || id_is_taken(file, index, value)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    keep_value(file, index, value);
    return ROBUROC4_OK;
}

/* ----------------------------------------------------------------------------------- reading ---
 */

typedef struct span {
    const char *at;
    size_t length;
} span;

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r';
}

static span trim(span text) {
    while (text.length > 0 && is_blank(text.at[0])) {
        text.at++;
        text.length--;
    }
    while (text.length > 0 && is_blank(text.at[text.length - 1])) {
        text.length--;
    }
    return text;
}

/** Up to the first of the two characters, or all of it. */
static span before(span text, char one, char other) {
    size_t length = 0;
    while (length < text.length && text.at[length] != one && text.at[length] != other) {
        length++;
    }
    text.length = length;
    return text;
}

/** A decimal number without exponent, of at most nine digits. */
static bool read_number(span text, float *out) {
    const bool negative = text.length > 0 && text.at[0] == '-';
    uint32_t whole = 0, digits = 0, divisor = 1;
    bool fraction = false;
    for (size_t i = negative ? 1 : 0; i < text.length; i++) {
        const char c = text.at[i];
        if (c == '.' && !fraction) {
            fraction = true;
            continue;
        }
        digits++;
        if (c < '0' || c > '9' || digits > MAX_DIGITS) {
            return false;
        }
        whole = whole * 10 + (uint32_t)(c - '0');
        divisor *= fraction ? 10U : 1U;
    }
    const float size = (float)((double)whole / (double)divisor);
    *out = negative ? -size : size;
    return digits > 0;
}

/** What is wrong with a line; NULL: nothing. */
static const char *read_line(roburoc4_robot_file *file, span line) {
    line = trim(before(line, '#', ';'));
    if (line.length == 0) {
        return NULL;
    }
    if (line.at[0] == '[') {
        return line.at[line.length - 1] == ']' ? NULL : no_assignment;
    }
    const span left = before(line, '=', '=');
    if (left.length == line.length) {
        return no_assignment;
    }
    const span name = trim(left);
    const span value = trim((span){line.at + left.length + 1, line.length - left.length - 1});
    const uint32_t index = find(name.at, name.length);
    float number = 0;
    if (index == ROWS) {
        return no_name;
    }
    if (is_known(file, index)) {
        return twice;
    }
    if (!read_number(value, &number) || !fits(&rows[index], number)) {
        return rows[index].remedy;
    }
    if (id_is_taken(file, index, number)) {
        return same_ids;
    }
    keep_value(file, index, number);
    return NULL;
}

static roburoc4_result refuse(uint32_t at, const char *wrong, uint32_t *line, const char **remedy) {
    if (line != NULL) {
        *line = at;
    }
    if (remedy != NULL) {
        *remedy = wrong;
    }
    return ROBUROC4_ERR_CONFIG;
}

roburoc4_result roburoc4_robot_file_read(roburoc4_robot_file *out, const char *text, size_t length,
                                         uint32_t *line, const char **remedy) {
    static const uint32_t none[WORDS] = {0};
    static const uint8_t byte_order_mark[] = {0xEF, 0xBB, 0xBF};
    roburoc4_robot_file file;
    uint32_t at = 1;
    span rest = {text, length};
    memset(&file, 0, sizeof file);
    if (length >= sizeof byte_order_mark &&
        memcmp(text, byte_order_mark, sizeof byte_order_mark) == 0) {
        rest = (span){text + sizeof byte_order_mark, length - sizeof byte_order_mark};
    }
    for (; rest.length > 0; at++) {
        const span here = before(rest, '\n', '\n');
        const char *const wrong = read_line(&file, here);
        if (wrong != NULL) {
            return refuse(at, wrong, line, remedy);
        }
        const size_t used = here.length < rest.length ? here.length + 1 : here.length;
        rest = (span){rest.at + used, rest.length - used};
    }
    if (memcmp(file.private_known, none, sizeof none) == 0) {
        return refuse(1, nothing, line, remedy);
    }
    *out = file;
    return ROBUROC4_OK;
}

/* ----------------------------------------------------------------------------------- writing ---
 */

typedef struct output {
    char *at;
    size_t left;
    bool full;
} output;

static void put(output *out, const char *text, size_t length) {
    if (out->full || length > out->left) {
        out->full = true;
        return;
    }
    memcpy(out->at, text, length);
    out->at += length;
    out->left -= length;
}

static void put_text(output *out, const char *text) {
    put(out, text, strlen(text));
}

static void put_whole(output *out, uint32_t value) {
    char digits[10];
    size_t at = sizeof digits;
    do {
        digits[--at] = (char)('0' + value % 10);
        value /= 10;
    } while (value != 0);
    put(out, digits + at, sizeof digits - at);
}

/** With five decimals, less the zeros at the end. */
static void put_number(output *out, float value) {
    const float size = magnitude(value);
    uint32_t whole = (uint32_t)size;
    uint32_t fraction = (uint32_t)((size - (float)whole) * (float)DECIMALS_FACTOR + 0.5F);
    char digits[1 + DECIMALS];
    size_t length = 0;
    if (fraction >= DECIMALS_FACTOR) {
        whole++;
        fraction = 0;
    }
    digits[0] = '.';
    for (size_t at = DECIMALS; at > 0; at--) {
        digits[at] = (char)('0' + fraction % 10);
        length = length == 0 && fraction % 10 != 0 ? at + 1 : length;
        fraction /= 10;
    }
    if (order_of(value) < 0 && (whole != 0 || length != 0)) {
        put_text(out, "-");
    }
    put_whole(out, whole);
    put(out, digits, length);
}

roburoc4_result roburoc4_robot_file_write(const roburoc4_robot_file *file, char *text,
                                          size_t capacity) {
    output out = {text, capacity, false};
    const char *section = "";
    put_text(&out, "# A RobuROC4: docs/first-contact.md explains the names.\n");
    for (uint32_t index = 0; index < ROWS; index++) {
        const row *r = &rows[index];
        if (!is_known(file, index)) {
            continue;
        }
        if (strcmp(section, r->section) != 0) {
            section = r->section;
            put_text(&out, "\n[");
            put_text(&out, section);
            put_text(&out, "]\n");
        }
        put_text(&out, r->name);
        put_text(&out, " = ");
        put_number(&out, file->private_values[index]);
        put_text(&out, "\n");
    }
    return out.full ? ROBUROC4_ERR_BUFFER : (roburoc4_result)(out.at - text);
}

/* ----------------------------------------------------------------------------- configuration ---
 */

static float value_or(const roburoc4_robot_file *file, const char *name, float otherwise) {
    (void)roburoc4_robot_file_get(file, name, &otherwise);
    return otherwise;
}

void roburoc4_robot_file_config(const roburoc4_robot_file *file, roburoc4_config *config) {
    static const char *const roles[ROBUROC4_ROLE_COUNT] = {
        "override_index", "front_bumper_index", "rear_bumper_index", "battery_voltage_index"};
    for (uint32_t role = 0; role < ROBUROC4_ROLE_COUNT; role++) {
        config->role_index[role] =
            (int16_t)value_or(file, roles[role], (float)config->role_index[role]);
    }
    config->iocard_id = (int32_t)value_or(file, "iocard_id", (float)config->iocard_id);
    config->differential_id =
        (int32_t)value_or(file, "differential_id", (float)config->differential_id);
    config->robot_watchdog_ms =
        (uint32_t)value_or(file, "robot_watchdog_ms", (float)config->robot_watchdog_ms);
    config->scale_linear = value_or(file, "scale_linear", config->scale_linear);
    config->scale_angular = value_or(file, "scale_angular", config->scale_angular);
}
