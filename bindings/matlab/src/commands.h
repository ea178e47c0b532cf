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

/** What the first argument is. */
typedef enum subject {
    NO_ID,
    READ_ROBOT,    /* the id of a robot; call.client is a copy of its client */
    CONTROL_ROBOT, /* the id of a robot that takes commands; call.client is locked and its own: a
                      command may not wait, nor make a value for MATLAB */
    WAIT_ROBOT,    /* the id of a robot that takes commands; call.client is NULL */
    ANY_ROBOT,     /* likewise, or of a robot that is gone: call.object is NULL */
    SIMULATOR,     /* the id of a simulator */
    ANY_SIMULATOR  /* likewise, or of one that is gone: call.object is NULL */
} subject;

/** What the result is. */
typedef enum result_kind {
    NOTHING,
    NUMBER, /* call.number */
    FLAG,   /* call.number, as a logical */
    STRUCT, /* call.out */
    OTHER   /* the command has made it */
} result_kind;

/** A call of a command. */
typedef struct call {
    mxArray **results;
    int count;
    const mxArray **arguments; /* behind the name of the command and the id */
    void *object;              /* the robot or simulator of the id */
    roburoc4_client *client;
    uint64_t now_us; /* the robot's time */
    double number;
    answer out;
} call;

typedef struct command {
    const char *name;
    subject of;
    int arguments; /* how many follow the id; as many as -arguments - 1 or more where negative */
    result_kind result;
    int (*run)(call *in);
} command;

/** Tables that end with a name of NULL. */
extern const command robot_life_commands[];
extern const command robot_drive_commands[];
extern const command robot_move_commands[];
extern const command robot_read_commands[];
extern const command simulator_commands[];

/** End all simulators. */
void close_simulators(void);

#endif
