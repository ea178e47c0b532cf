/* SPDX-License-Identifier: MIT
 *
 * commands.h - what roburoc4_mex('COMMAND', ...) can be told, by file. Each command returns 1, or 0
 * after noting why not (fail.h). A command that waits does so for LONGEST_WAIT_S at most, so that
 * Ctrl-C is heard between two of them.
 */
#ifndef ROBUROC4_MEX_COMMANDS_H
#define ROBUROC4_MEX_COMMANDS_H

#include "arguments.h"
#include "robot.h"

#define LONGEST_WAIT_S 0.1

typedef struct command {
    const char *name;
    int (*run)(const call *told);
    int arguments; /* how many follow the name; as many as -arguments or more where negative */
} command;

/** Tables that end with a name of NULL. */
extern const command robot_life_commands[];
extern const command robot_drive_commands[];
extern const command robot_look_commands[];
extern const command simulator_commands[];

/** The robot whose id is the first argument, or NULL after noting why. */
robot *told_robot(const call *told);
/** Enter a robot and answer its id; NULL is one that could not be made. 0 after noting why not. */
int give_robot(const call *told, robot *made);
/** The service with statuses that a text names. */
int take_service(const mxArray *value, uint32_t *out);
/** End all that lives: robots first, their zeros together. */
void close_robots(void);
void close_simulators(void);

#endif
