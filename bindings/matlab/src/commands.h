/* SPDX-License-Identifier: MIT
 *
 * commands.h - the commands of roburoc4_mex('COMMAND', ...), by file. Each command returns 1, or 0
 * after noting the error (fail.h). A command that waits does so for at most LONGEST_WAIT_S, so that
 * Ctrl-C takes effect between two of them.
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
    CONTROL_ROBOT, /* the id of a robot that accepts commands; call.client is locked and its own: a
                    * command must not wait, nor make a value for MATLAB */
    WAIT_ROBOT,    /* the id of a robot that accepts commands; call.client is NULL */
    ANY_ROBOT,     /* likewise, but the robot may be gone: then call.object is NULL */
    SIMULATOR,     /* the id of a simulator */
    ANY_SIMULATOR  /* likewise, but it may be gone: then call.object is NULL */
} subject;

/** What the result is. */
typedef enum result_kind {
    NOTHING,
    NUMBER, /* call.number */
    FLAG,   /* call.number, as a logical */
    STRUCT, /* call.out */
    OTHER   /* made by the command */
} result_kind;

/** The call of a command. */
typedef struct call {
    mxArray **results;
    int count;
    const mxArray **arguments; /* behind the name of the command and the id */
    void *object;              /* the robot or simulator with this id */
    roburoc4_client *client;
    uint64_t now_us; /* the robot's time */
    double number;
    answer out;
} call;

typedef struct command {
    const char *name;
    subject of;
    int arguments; /* how many follow the id; if negative, -arguments - 1 or more */
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
