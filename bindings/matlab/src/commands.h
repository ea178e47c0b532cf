/* SPDX-License-Identifier: MIT
 *
 * commands.h - what roburoc4_mex('COMMAND', ...) can be called with, by file. Each command returns
 * 1, or 0 after noting why not (fail.h). A command that waits does so for LONGEST_WAIT_S at most,
 * so that Ctrl-C takes effect between two of them.
 */
#ifndef ROBUROC4_MEX_COMMANDS_H
#define ROBUROC4_MEX_COMMANDS_H

#include "handles.h"
#include "robot.h"

#define LONGEST_WAIT_S 0.1

/** What a command is called with. */
typedef enum subject {
    NO_ID,
    ROBOT,      /* the id of a robot */
    OPEN_ROBOT, /* likewise, of one that takes commands */
    ANY_ROBOT,  /* likewise; of a robot that is gone the object is NULL */
    SIMULATOR,  /* the id of a simulator */
    ANY_SIMULATOR
} subject;

typedef struct command {
    const char *name;
    subject of;
    int arguments; /* how many follow the id; as many as -arguments - 1 or more where negative */
    int (*run)(const call *in);
} command;

/** Tables that end with a name of NULL. */
extern const command robot_life_commands[];
extern const command robot_drive_commands[];
extern const command robot_look_commands[];
extern const command simulator_commands[];

/** Enter a robot and answer its id; NULL is one that could not be made. 0 after noting why not. */
int give_robot(const call *in, robot *made);
/** Note that there is no place for another object. 0. */
int fail_too_many(void);
/** The channel that the first argument names, among those of some types (bits by ROBUROC4_IO_*).
 *  0 after noting why there is none. */
int take_channel(const call *in, uint32_t io_types, uint32_t *io_type, uint32_t *index);
/** How many channels of a type the robot has; 0 before it is known. */
uint32_t count_channels(robot *r, uint32_t io_type);
/** End all that lives: robots first, and their stop sequences run together. */
void close_robots(void);
void close_simulators(void);

#endif
