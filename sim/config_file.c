/* SPDX-License-Identifier: MIT
 *
 * The robot's `udpserver.cfg` (manual 4.2.5.6): an INI text of `[Section]` and `Field=value`
 * lines. Its one job is to find the fields that the simulator knows and to skip the rest.
 */
#include <stdio.h>

#include "model.h"
#include "number.h"

#define MAX_WATCHDOG_CYCLES 1000000u

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

/* One line; `in_section` remembers whether the differential service's section goes on. */
static bool read_line(roburoc4_sim_config *config, piece line, unsigned number, bool *in_section,
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
        *in_section = is_named(trim(line.text + 1, end - 1), "DifferentialService");
        return true;
    }
    size_t equals = find(line, '=');
    if (!*in_section || equals == line.length || !is_named(trim(line.text, equals), "Watchdog")) {
        return true;
    }
    piece value = {line.text + equals + 1, line.length - equals - 1};
    return read_watchdog(config, without_comment(value), number, error, capacity);
}

roburoc4_result roburoc4_sim_config_read(roburoc4_sim_config *config, const char *text,
                                         size_t length, char *error, size_t capacity) {
    roburoc4_sim_config read = *config;
    bool in_section = false;
    size_t at = length >= 3 && (uint8_t)text[0] == 0xEF && (uint8_t)text[1] == 0xBB &&
                        (uint8_t)text[2] == 0xBF
                    ? 3
                    : 0;
    for (unsigned number = 1; at < length; number++) {
        piece rest = {text + at, length - at};
        size_t end = find(rest, '\n');
        if (!read_line(&read, trim(rest.text, end), number, &in_section, error, capacity)) {
            return ROBUROC4_ERR_VALUE;
        }
        at += end + 1;
    }
    *config = read;
    return ROBUROC4_OK;
}
