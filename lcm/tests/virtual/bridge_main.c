/* SPDX-License-Identifier: MIT
 *
 * The bridge's main() as a function that tests call repeatedly.
 */
#define _POSIX_C_SOURCE 200809L
#include <sys/resource.h>
#include <unistd.h>

#include "lcm_bus.h"

/* Only behind the system's headers, which may define them as inline functions. */
#define gethostname bridge_gethostname
#define getrlimit bridge_getrlimit
#define setrlimit bridge_setrlimit
#define main bridge_main
#undef ROBUROC4_LCM_IS_OLD
#define ROBUROC4_LCM_IS_OLD bridge_lcm_is_old
#include "main.c"
#undef main

void bridge_forget(void) {
    memset(&settings, 0, sizeof settings);
    memset(robots, 0, sizeof robots);
    memset(served, 0, sizeof served);
    memset(deadlines_us, 0, sizeof deadlines_us);
    memset(&stall, 0, sizeof stall);
    robot_count = serving_count = 0;
    recorder = NULL;
    lcm_rests_until_us = 0;
    stop_signal = 0;
}

void bridge_signal(int number) {
    on_signal(number);
}
