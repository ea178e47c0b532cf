/* SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "clock.h"

#include <time.h>

#include "roburoc4_udp.h"

gate_time clock_now(void) {
    struct timespec wall = {0, 0};
    gate_time now = {roburoc4_udp_now_us(), 0};
    (void)clock_gettime(CLOCK_REALTIME, &wall);
    now.utime = (int64_t)wall.tv_sec * 1000000 + wall.tv_nsec / 1000;
    return now;
}
