/* SPDX-License-Identifier: MIT
 *
 * The server of roburoc4-sim, called by main.c.
 */
#ifndef ROBUROC4_SIM_SERVER_H
#define ROBUROC4_SIM_SERVER_H

#include <stdbool.h>

#include "roburoc4_sim.h"

typedef struct server_options {
    const char *address;
    uint16_t port; /* of the first robot; 0 lets each pick a free one */
    uint32_t robots;
    bool panel;
    const char *family; /* the seed that the robot was drawn from, or NULL */
    roburoc4_sim_config config;
    roburoc4_sim_faults faults;
} server_options;

/* Serve until a stop is requested. Returns the program's exit status: 0, or 1 after a line on
 * stderr. */
int server_run(const server_options *options);

#endif
