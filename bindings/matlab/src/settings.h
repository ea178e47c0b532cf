/* SPDX-License-Identifier: MIT
 *
 * settings.h - from the options of a call, a scalar struct, to the structs of the library.
 */
#ifndef ROBUROC4_MEX_SETTINGS_H
#define ROBUROC4_MEX_SETTINGS_H

#include "convert.h"
#include "roburoc4_pump.h"
#include "roburoc4_sim.h"

/** What a robot is opened with. */
typedef struct robot_settings {
    roburoc4_config config;
    uint32_t buffer;                          /* statuses that are kept for record() and log() */
    char record[ROBUROC4_RECORDER_PATH_SIZE]; /* "": no datagram is recorded */
} robot_settings;

/** 1; or 0 after noting which option is unknown or out of range. */
int settings_of_robot(const mxArray *options, robot_settings *out);
int settings_of_simulator(const mxArray *options, roburoc4_sim_config *out);
int settings_of_faults(const mxArray *options, roburoc4_sim_faults *out);

#endif
