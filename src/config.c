/* SPDX-License-Identifier: MIT
 *
 * The client's settings: one table of name, place, range and default serves the defaults and the
 * check.
 */
#include "bytes.h"
#include "internal.h"

typedef struct setting {
    const char *range; /* "name: range", what roburoc4_config_error() says */
    uint16_t offset, low, high, preset;
} setting;

typedef struct float_setting {
    const char *range;
    uint16_t offset;
    float low, high, preset;
} float_setting;

#define AT(field) ((uint16_t)offsetof(roburoc4_config, field))

/* clang-format off */
static const setting integers[] = {
    {"subscriptions: bits 2 to 6",      AT(subscriptions),       0,  0x7C, 0x7C},
    {"first_retry_ms: 10 to 100",       AT(first_retry_ms),     10,   100,  100},
    {"lost_ms: 200 to 60000",           AT(lost_ms),           200, 60000, 1000},
    {"fresh_ms: 50 to 1000",            AT(fresh_ms),           50,  1000,  300},
    {"drive_period_ms: 10 to 500",      AT(drive_period_ms),    10,   500,   50},
    {"lease_ms: 20 to 1000",            AT(lease_ms), LEASE_MIN_MS, LEASE_MAX_MS, 250},
    {"robot_watchdog_ms: 100 to 60000", AT(robot_watchdog_ms), 100, 60000, 1000},
    {"options: unknown bit",            AT(options),             0,     7,    0},
};

static const float_setting floats[] = {
    {"max_linear_m_s: 0.001 to 20",     AT(max_linear_m_s),    0.001F, 20, 2.6F},
    {"max_angular_rad_s: 0.001 to 50",  AT(max_angular_rad_s), 0.001F, 50, 6.5F},
    {"scale_linear: 0.01 to 10",        AT(scale_linear),       0.01F, 10,    1},
    {"scale_angular: 0.01 to 10",       AT(scale_angular),      0.01F, 10,    1},
};
/* clang-format on */

#define COUNT(table) (sizeof(table) / sizeof((table)[0]))

roburoc4_result roburoc4_config_init(roburoc4_config *config, size_t size) {
    static const uint8_t period_in_10_ms[8] = {0, 0, 5, 10, 100, 5, 5, 0};
    uint8_t *base = (uint8_t *)config;
    if (size != sizeof *config) {
        return ROBUROC4_ERR_SIZE;
    }
    memset(config, 0, sizeof *config);
    config->size = sizeof *config;
    for (size_t i = 0; i < COUNT(period_in_10_ms); i++) {
        config->period_ms[i] = (uint16_t)(period_in_10_ms[i] * 10U);
    }
    for (size_t i = 0; i < COUNT(integers); i++) {
        const uint32_t value = integers[i].preset;
        memcpy(base + integers[i].offset, &value, sizeof value);
    }
    for (size_t i = 0; i < COUNT(floats); i++) {
        memcpy(base + floats[i].offset, &floats[i].preset, sizeof floats[i].preset);
    }
    for (uint32_t role = 0; role < ROBUROC4_ROLE_COUNT; role++) {
        config->role_index[role] = ROBUROC4_INDEX_AUTO;
    }
    return ROBUROC4_OK;
}

const char *roburoc4_config_error(const roburoc4_config *config) {
    const uint8_t *base = (const uint8_t *)config;
    if (config->size != sizeof *config) {
        return "size: set by roburoc4_config_init()";
    }
    for (size_t i = 0; i < COUNT(integers); i++) {
        uint32_t value;
        memcpy(&value, base + integers[i].offset, sizeof value);
        if (value < integers[i].low || value > integers[i].high) {
            return integers[i].range;
        }
    }
    for (size_t i = 0; i < COUNT(floats); i++) {
        float value;
        memcpy(&value, base + floats[i].offset, sizeof value);
        if (!finite_f32_bits(bits_from_f32(value)) ||
            value < floats[i].low || value > floats[i].high) {
            return floats[i].range;
        }
    }
    if ((config->subscriptions & 3) != 0) {
        return integers[0].range;
    }
    if (config->lease_ms < 2 * config->drive_period_ms) {
        return "drive_period_ms: at most half of lease_ms";
    }
    for (uint32_t service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++) {
        const uint32_t period_ms = config->period_ms[service];
        if (period_ms == 0 || period_ms > 2550 || period_ms % 10 != 0) {
            return "period_ms: multiples of 10, 10 to 2550";
        }
    }
    for (uint32_t role = 0; role < ROBUROC4_ROLE_COUNT; role++) {
        if (config->role_index[role] < ROBUROC4_INDEX_AUTO ||
            config->role_index[role] >= roburoc4_role_capacity(role)) {
            return "role_index: -1, or an index to 63 (battery voltage: 15)";
        }
    }
    return NULL;
}
