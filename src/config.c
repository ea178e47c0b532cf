/* SPDX-License-Identifier: MIT
 *
 * The client's settings: one table of place, range and default serves the defaults and the check.
 * The texts are separate, so that a linker leaves them out of programs that do not use them.
 */
#include "bytes.h"
#include "machines.h"

typedef struct setting {
    uint16_t offset, low, high, preset;
} setting;

typedef struct float_setting {
    uint16_t offset;
    float low, high, preset;
} float_setting;

#define MIN_LEASE_MS (ROBUROC4_MIN_LEASE_US / 1000)
#define MAX_LEASE_MS (ROBUROC4_MAX_LEASE_US / 1000)
#define AT(field) ((uint16_t)offsetof(roburoc4_config, field))

/* clang-format off */
static const setting integers[] = {
    {AT(subscriptions),              0,         0x7C, 0x7C},
    {AT(first_retry_ms),            10,          100,  100},
    {AT(lost_ms),                  200,        60000, 1000},
    {AT(fresh_ms),                  50,         1000,  300},
    {AT(drive_period_ms),           10,          500,   50},
    {AT(lease_ms),        MIN_LEASE_MS, MAX_LEASE_MS,  250},
    {AT(robot_watchdog_ms),        100,        60000, 1000},
    {AT(options),                    0,            7,    0},
    {AT(lapse_disarm_ms),            0,        60000, 1000},
};

static const float_setting floats[] = {
    {AT(max_linear_m_s),    0.001F, 5,     1},
    {AT(max_angular_rad_s), 0.001F, 10, 1.5F},
    {AT(scale_linear),       0.01F, 10,    1},
    {AT(scale_angular),      0.01F, 10,    1},
};
#undef AT
/* clang-format on */

#define COUNT(table) (sizeof(table) / sizeof((table)[0]))

/* Errors, as index of the texts: 0 is the size, then the rows of both tables. */
enum {
    BAD_SIZE,
    BAD_INTEGER,
    BAD_FLOAT = BAD_INTEGER + COUNT(integers),
    BAD_HALF_LEASE = BAD_FLOAT + COUNT(floats),
    BAD_HALF_WATCHDOG,
    BAD_PERIOD,
    BAD_FRESH,
    BAD_ROLE,
    BAD_ID,
    ALL_GOOD
};

static void set_defaults(roburoc4_config *config) {
    static const uint16_t period_ms[8] = {0, 0, 50, 100, 1000, 50, 50, 0};
    uint8_t *base = (uint8_t *)config;
    memset(config, 0, sizeof *config);
    memcpy(config->period_ms, period_ms, sizeof config->period_ms);
    for (size_t i = 0; i < COUNT(integers); i++) {
        const uint32_t value = integers[i].preset;
        memcpy(base + integers[i].offset, &value, sizeof value);
    }
    for (size_t i = 0; i < COUNT(floats); i++) {
        memcpy(base + floats[i].offset, &floats[i].preset, sizeof floats[i].preset);
    }
    for (size_t i = 0; i < COUNT(config->role_index); i++) {
        config->role_index[i] = ROBUROC4_INDEX_AUTO;
    }
    config->iocard_id = ROBUROC4_ID_AUTO;
    config->differential_id = ROBUROC4_ID_AUTO;
}

roburoc4_result roburoc4_config_init(roburoc4_config *config, size_t size) {
    roburoc4_config defaults;
    if (!size_known(size, sizeof *config)) {
        return ROBUROC4_ERR_SIZE;
    }
    set_defaults(&defaults);
    defaults.size = (uint32_t)size;
    memcpy(config, &defaults, size);
    return ROBUROC4_OK;
}

/** Of a service other than directory and notification, or ROBUROC4_ID_AUTO. */
static bool id_valid(int32_t id) {
    return id == ROBUROC4_ID_AUTO || (id > ROBUROC4_SERVICE_NOTIFICATION && id <= 0xFFFF);
}

/** The first value of the tables that is out of its range, or ALL_GOOD. */
static uint32_t first_out_of_range(const roburoc4_config *config) {
    const uint8_t *base = (const uint8_t *)config;
    for (uint32_t i = 0; i < COUNT(integers); i++) {
        uint32_t value;
        memcpy(&value, base + integers[i].offset, sizeof value);
        if (value < integers[i].low || value > integers[i].high) {
            return BAD_INTEGER + i;
        }
    }
    for (uint32_t i = 0; i < COUNT(floats); i++) {
        float value;
        memcpy(&value, base + floats[i].offset, sizeof value);
        if (!between(value, floats[i].low, floats[i].high)) {
            return BAD_FLOAT + i;
        }
    }
    return ALL_GOOD;
}

static uint32_t first_bad_period(const roburoc4_config *config) {
    if (config->period_ms[ROBUROC4_SERVICE_COUNT] != 0) {
        return BAD_PERIOD;
    }
    const uint32_t services_of_arming =
        (uint32_t)service_bit(ROBUROC4_SERVICE_IOCARD) | service_bit(ROBUROC4_SERVICE_DIFFERENTIAL);
    for (uint32_t service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++) {
        const uint32_t period_ms = config->period_ms[service];
        if (period_ms == 0 || period_ms > 2550 || 10 * cycles_of(period_ms) != period_ms) {
            return BAD_PERIOD;
        }
        if ((services_of_arming & config->subscriptions & service_bit(service)) != 0 &&
            config->fresh_ms < 3 * period_ms) {
            return BAD_FRESH;
        }
    }
    return ALL_GOOD;
}

static bool roles_valid(const roburoc4_config *config) {
    for (uint32_t role = 0; role < COUNT(config->role_index); role++) {
        const int32_t capacity = role < ROBUROC4_ROLE_COUNT ? role_capacity(role) : 0;
        if (config->role_index[role] < ROBUROC4_INDEX_AUTO ||
            config->role_index[role] >= capacity) {
            return false;
        }
    }
    return true;
}

static bool ids_valid(const roburoc4_config *config) {
    return id_valid(config->iocard_id) && id_valid(config->differential_id) &&
           (config->iocard_id < 0 || config->iocard_id != config->differential_id);
}

static uint32_t first_bad(const roburoc4_config *config) {
    uint32_t bad = first_out_of_range(config);
    if (bad != ALL_GOOD) {
        return bad;
    }
    if ((config->subscriptions & 3) != 0) {
        return BAD_INTEGER; /* directory and notification have no statuses */
    }
    if (config->lease_ms < 2 * config->drive_period_ms) {
        return BAD_HALF_LEASE;
    }
    if (config->robot_watchdog_ms < 2 * config->drive_period_ms) {
        return BAD_HALF_WATCHDOG;
    }
    bad = first_bad_period(config);
    if (bad != ALL_GOOD) {
        return bad;
    }
    if (!roles_valid(config)) {
        return BAD_ROLE;
    }
    return ids_valid(config) ? ALL_GOOD : BAD_ID;
}

/** Fill *out with the fields that the program knows, defaults for the others. Returns one of the
 * errors above. */
static uint32_t load(roburoc4_config *out, const roburoc4_config *config) {
    set_defaults(out);
    if (!size_known(config->size, sizeof *out)) {
        return BAD_SIZE;
    }
    memcpy(out, config, config->size);
    return first_bad(out);
}

bool roburoc4_config_load(roburoc4_config *out, const roburoc4_config *config) {
    if (config == NULL) {
        set_defaults(out);
        return true;
    }
    return load(out, config) == ALL_GOOD;
}

const char *roburoc4_config_error(const roburoc4_config *config) {
    static const char *const texts[ALL_GOOD + 1] = {
        "size: set by roburoc4_config_init()",
        "subscriptions: bits 2 to 6",
        "first_retry_ms: 10 to 100",
        "lost_ms: 200 to 60000",
        "fresh_ms: 50 to 1000",
        "drive_period_ms: 10 to 500",
        "lease_ms: 20 to 1000",
        "robot_watchdog_ms: 100 to 60000",
        "options: unknown bit",
        "lapse_disarm_ms: 0 to 60000",
        "max_linear_m_s: 0.001 to 5",
        "max_angular_rad_s: 0.001 to 10",
        "scale_linear: 0.01 to 10",
        "scale_angular: 0.01 to 10",
        "drive_period_ms: at most half of lease_ms",
        "drive_period_ms: at most half of robot_watchdog_ms",
        "period_ms: multiples of 10, 10 to 2550; the last is 0",
        "period_ms of IO card and differential: at most a third of fresh_ms",
        "role_index: -1, or an index to 63 (battery voltage: 15); the last four are -1",
        "iocard_id, differential_id: -1, or 2 to 65535, not the same",
        NULL,
    };
    roburoc4_config loaded;
    return texts[load(&loaded, config)];
}
