/* SPDX-License-Identifier: MIT
 *
 * This machine's two clocks, read together. Define _POSIX_C_SOURCE before including this file.
 */
#ifndef ROBUROC4_LCM_CLOCK_H
#define ROBUROC4_LCM_CLOCK_H

#include <time.h>

#include "gate.h"
#include "roburoc4_udp.h"

static inline gate_time clock_now(void) {
    struct timespec wall = {0, 0};
    gate_time now = {roburoc4_udp_now_us(), 0};
    (void)clock_gettime(CLOCK_REALTIME, &wall);
    now.utime = (int64_t)wall.tv_sec * 1000000 + wall.tv_nsec / 1000;
    return now;
}

#endif
