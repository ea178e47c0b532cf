/* SPDX-License-Identifier: MIT
 *
 * The bridge's main() as a function that tests call repeatedly.
 */
#define main bridge_main
#include "main.c"
#undef main

#include "lcm_bus.h"

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
