/* SPDX-License-Identifier: MIT
 *
 * The robot's `udpserver.cfg` (manual 4.2.5.6): an INI text of `[Section]` and `Field=value`
 * lines. Fields that the simulator does not know are skipped.
 */
#include <stdio.h>
#include <string.h>

#include "config_file.h"
#include "number.h"

#define MAX_WATCHDOG_CYCLES 1000000u
#define MAX_NAME 40

typedef enum section { OTHER, DIFFERENTIAL_SERVICE, SIMULATOR } section;

typedef struct piece {
    const char *text;
    size_t length;
} piece;

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r';
}

static piece trim(const char *text, size_t length) {
    while (length > 0 && is_blank(text[0])) {
        text++;
        length--;
    }
    while (length > 0 && is_blank(text[length - 1])) {
        length--;
    }
    piece trimmed = {text, length};
    return trimmed;
}

static char lower(char c) {
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

static bool is_named(piece name, const char *wanted) {
    for (size_t at = 0; at < name.length; at++) {
        if (wanted[at] == '\0' || lower(name.text[at]) != lower(wanted[at])) {
            return false;
        }
    }
    return wanted[name.length] == '\0';
}

static size_t find(piece line, char wanted) {
    size_t at = 0;
    while (at < line.length && line.text[at] != wanted) {
        at++;
    }
    return at;
}

/* A comment may follow a value. */
static piece without_comment(piece value) {
    size_t semicolon = find(value, ';');
    size_t hash = find(value, '#');
    return trim(value.text, semicolon < hash ? semicolon : hash);
}

static bool read_watchdog(roburoc4_sim_config *config, piece value, unsigned line, char *error,
                          size_t capacity) {
    uint64_t cycles = 0;
    if (!number_whole(value.text, value.length, MAX_WATCHDOG_CYCLES, &cycles) || cycles == 0) {
        (void)snprintf(error, capacity,
                       "line %u: Watchdog=%.*s: give a whole number of cycles (10 ms), 1 to %u",
                       line, (int)(value.length < 40 ? value.length : 40), value.text,
                       MAX_WATCHDOG_CYCLES);
        return false;
    }
    config->watchdog_cycles = (uint32_t)cycles;
    return true;
}

/* What is wrong with this one setting; NULL if nothing. */
static const char *setting_error(const char *name, double value) {
    roburoc4_sim_config alone;
    (void)roburoc4_sim_config_init(&alone, sizeof alone);
    roburoc4_result result = roburoc4_sim_config_set(&alone, name, value);
    return result == ROBUROC4_ERR_INDEX ? "no such setting; give a member of roburoc4_sim_config"
           : result < 0                 ? "give a number that fits it"
                                        : roburoc4_sim_config_error(&alone);
}

static bool read_setting(roburoc4_sim_config *config, piece name, piece value, unsigned line,
                         char *error, size_t capacity) {
    char text[MAX_NAME] = "";
    double number = -1.0;
    if (name.length < sizeof text) {
        memcpy(text, name.text, name.length);
    }
    bool read = number_decimal(value.text, value.length, -1e18, 1e18, &number);
    const char *wrong = setting_error(text, number);
    wrong = wrong == NULL && !read ? "give a number" : wrong;
    if (wrong != NULL) {
        (void)snprintf(error, capacity, "line %u: %.*s=%.*s: %s", line,
                       (int)(name.length < MAX_NAME ? name.length : MAX_NAME), name.text,
                       (int)(value.length < MAX_NAME ? value.length : MAX_NAME), value.text, wrong);
        return false;
    }
    (void)roburoc4_sim_config_set(config, text, number);
    return true;
}

static section section_named(piece name) {
    return is_named(name, "DifferentialService") ? DIFFERENTIAL_SERVICE
           : is_named(name, "Simulator")         ? SIMULATOR
                                                 : OTHER;
}

/* One line; `inside` keeps the current section. */
static bool read_line(roburoc4_sim_config *config, piece line, unsigned number, section *inside,
                      char *error, size_t capacity) {
    if (line.length == 0 || line.text[0] == ';' || line.text[0] == '#') {
        return true;
    }
    if (line.text[0] == '[') {
        size_t end = find(line, ']');
        if (end == line.length) {
            (void)snprintf(error, capacity, "line %u: a section's name ends with ]", number);
            return false;
        }
        *inside = section_named(trim(line.text + 1, end - 1));
        return true;
    }
    size_t equals = find(line, '=');
    if (*inside == OTHER || equals == line.length) {
        return true;
    }
    piece name = trim(line.text, equals);
    piece rest = {line.text + equals + 1, line.length - equals - 1};
    piece value = without_comment(rest);
    if (*inside == SIMULATOR) {
        return read_setting(config, name, value, number, error, capacity);
    }
    return !is_named(name, "Watchdog") || read_watchdog(config, value, number, error, capacity);
}

roburoc4_result sim_config_read(roburoc4_sim_config *config, const char *text, size_t length,
                                char *error, size_t capacity) {
    roburoc4_sim_config read = *config;
    section inside = OTHER;
    size_t at = length >= 3 && (uint8_t)text[0] == 0xEF && (uint8_t)text[1] == 0xBB &&
                        (uint8_t)text[2] == 0xBF
                    ? 3
                    : 0;
    for (unsigned number = 1; at < length; number++) {
        piece rest = {text + at, length - at};
        size_t end = find(rest, '\n');
        if (!read_line(&read, trim(rest.text, end), number, &inside, error, capacity)) {
            return ROBUROC4_ERR_VALUE;
        }
        at += end + 1;
    }
    *config = read;
    return ROBUROC4_OK;
}
