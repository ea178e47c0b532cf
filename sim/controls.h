/* SPDX-License-Identifier: MIT
 *
 * The table of controls, for readers of names and values in text.
 */
#ifndef ROBUROC4_SIM_CONTROLS_H
#define ROBUROC4_SIM_CONTROLS_H

#include "model.h"
#include "settings.h"

typedef struct sim_control {
    uint32_t number, count; /* count above 1: an index follows the name */
    const char *name;
    const char *words[2]; /* the text for 0 and 1, or NULL */
    double low, high;
    size_t offset; /* of the number in roburoc4_sim that it is; 0: more than a number */
    sim_kind kind; /* of that number */
} sim_control;

/* The control with this number, or NULL. */
const sim_control *sim_control_numbered(uint32_t number);

#endif
