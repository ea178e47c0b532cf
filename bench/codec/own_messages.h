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

struct differential_values {
    uint64_t robot_cycles;
    float target_linear_m_s, current_linear_m_s, target_angular_rad_s, current_angular_rad_s;
    uint16_t service;
};

#endif
