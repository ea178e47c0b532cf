/* SPDX-License-Identifier: MIT
 *
 * Plain structs for the limit (memcpy) and for where roburoc4's lists are copied to.
 */
#ifndef BENCH_OWN_MESSAGES_H
#define BENCH_OWN_MESSAGES_H

#include <cstdint>

struct iocard_values {
    uint64_t robot_cycles;
    float analog[9];
    uint8_t digital[3];
    uint16_t service;
};

struct telemeter_values {
    uint64_t robot_cycles;
    float distance_m[2];
    uint16_t service;
};

struct battery_values {
    uint64_t robot_cycles;
    uint16_t service;
    uint8_t state, remaining_percent;
};

struct localization_values {
    uint64_t robot_cycles;
    double x_m, y_m, theta_rad;
    uint32_t flags;
    uint16_t service;
};

struct differential_values {
    uint64_t robot_cycles;
    float target_linear_m_s, current_linear_m_s, target_angular_rad_s, current_angular_rad_s;
    uint16_t service;
};

struct drive_values {
    uint16_t service;
    float linear_m_s, angular_rad_s;
};

#endif
