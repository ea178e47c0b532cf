/* SPDX-License-Identifier: MIT
 *
 * The table of controls, for who reads their names and values from text.
 */
#ifndef ROBUROC4_SIM_CONTROLS_H
#define ROBUROC4_SIM_CONTROLS_H

#include "model.h"

typedef struct sim_control {
    uint32_t number, count; /* count: more than 1 with an index behind the name */
    const char *name;
    const char *words[2]; /* for 0 and 1 in a line of text, or NULL */
    int32_t low, high;
} sim_control;

/* The one that has this number; NULL: none. */
const sim_control *sim_control_numbered(uint32_t number);

#endif
