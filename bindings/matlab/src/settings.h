/* SPDX-License-Identifier: MIT
 *
 * settings.h - converts the options of a call, a scalar struct, to the structs of the library.
 */
#ifndef ROBUROC4_MEX_SETTINGS_H
#define ROBUROC4_MEX_SETTINGS_H

#include "convert.h"
#include "roburoc4_pump.h"
#include "roburoc4_sim.h"

/** Settings with which a robot is opened. */
typedef struct robot_settings {
    roburoc4_config config;
    uint32_t buffer;                          /* statuses that are kept for record() and log() */
    char record[ROBUROC4_RECORDER_PATH_SIZE]; /* "": datagrams are not recorded */
} robot_settings;

/** Returns 1; or 0 after noting which option is unknown or out of range. */
int settings_of_robot(const mxArray *options, robot_settings *out);
int settings_of_simulator(const mxArray *options, roburoc4_sim_config *out);
int settings_of_faults(const mxArray *options, roburoc4_sim_faults *out);

#endif
