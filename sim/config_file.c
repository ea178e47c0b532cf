/* SPDX-License-Identifier: MIT
 *
 * The robot's `udpserver.cfg` (manual 4.2.5.6). Fields that the simulator does not know are
 * skipped.
 */
#include "config_file.h"

#include <stdio.h>
#include <string.h>

#include "ini.h"
#include "number.h"

#define MAX_WATCHDOG_CYCLES 1000000u
#define MAX_NAME 40

static bool read_watchdog(roburoc4_sim_config *config, ini_text value, char *error,
                          size_t capacity) {
    uint64_t cycles = 0;
    if (!number_whole(value.at, value.length, MAX_WATCHDOG_CYCLES, &cycles) || cycles == 0) {
        (void)snprintf(error, capacity,
                       "Watchdog=%.*s: give a whole number of cycles (10 ms), 1 to %u",
                       (int)(value.length < 40 ? value.length : 40), value.at, MAX_WATCHDOG_CYCLES);
        return false;
    }
    config->watchdog_cycles = (uint32_t)cycles;
    return true;
}

/* What is wrong with a setting alone; NULL: nothing. */
static const char *setting_error(const char *name, double value) {
    roburoc4_sim_config alone;
    (void)roburoc4_sim_config_init(&alone, sizeof alone);
    roburoc4_result result = sim_config_set(&alone, name, value);
    return result == ROBUROC4_ERR_INDEX ? "no such setting; give a member of roburoc4_sim_config"
           : result < 0                 ? "give a number that fits it"
                                        : sim_setting_error(sim_setting_named(name), value);
}

static bool read_setting(roburoc4_sim_config *config, ini_text name, ini_text value, char *error,
                         size_t capacity) {
    char text[MAX_NAME] = "";
    double number = -1.0;
    if (name.length < sizeof text) {
        memcpy(text, name.at, name.length);
    }
    bool read = number_decimal(value.at, value.length, -1e18, 1e18, &number);
    const char *wrong = setting_error(text, number);
    wrong = wrong == NULL && !read ? "give a number" : wrong;
    if (wrong != NULL) {
        (void)snprintf(error, capacity, "%.*s=%.*s: %s",
                       (int)(name.length < MAX_NAME ? name.length : MAX_NAME), name.at,
                       (int)(value.length < MAX_NAME ? value.length : MAX_NAME), value.at, wrong);
        return false;
    }
    (void)sim_config_set(config, text, number);
    return true;
}

static bool read_line(void *user, const ini_line *line, char *error, size_t capacity) {
    roburoc4_sim_config *config = user;
    if (line->name.length == 0 || line->value.at == NULL) {
        return true;
    }
    if (ini_is(line->section, "Simulator", true)) {
        return read_setting(config, line->name, line->value, error, capacity);
    }
    bool watchdog =
        ini_is(line->section, "DifferentialService", true) && ini_is(line->name, "Watchdog", true);
    return !watchdog || read_watchdog(config, line->value, error, capacity);
}

roburoc4_result sim_config_read(roburoc4_sim_config *config, const char *text, size_t length,
                                char *error, size_t capacity) {
    roburoc4_sim_config read = *config;
    char why[160];
    unsigned line = ini_read(text, length, read_line, &read, why, sizeof why);
    if (line != 0) {
        (void)snprintf(error, capacity, "line %u: %s", line, why);
        return ROBUROC4_ERR_VALUE;
    }
    const char *wrong = roburoc4_sim_config_error(&read); /* settings that do not go together */
    if (wrong != NULL) {
        (void)snprintf(error, capacity, "%s", wrong);
        return ROBUROC4_ERR_VALUE;
    }
    *config = read;
    return ROBUROC4_OK;
}
