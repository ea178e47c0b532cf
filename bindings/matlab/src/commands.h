/* SPDX-License-Identifier: MIT
 *
 * commands.h - the commands of roburoc4_mex('COMMAND', ...), by file. Each command returns 1, or 0
 * after noting the error. A command that waits does so for at most LONGEST_WAIT_S, so that Ctrl-C
 * takes effect between two of them.
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
    ANY_ROBOT,     /* likewise, but the robot may be gone: then nothing is done, as delete() may be
                    * called twice */
    SIMULATOR,     /* the id of a simulator */
    ANY_SIMULATOR  /* likewise, but it may be gone */
} subject;

/** What another argument is, and where the call has it. */
typedef enum argument_kind {
    TAKE_RANGE,    /* numbers: finite */
    TAKE_SPEED,    /* likewise; true and false are refused */
    TAKE_WHOLE,    /* numbers: whole; with 0 to 1, also a logical */
    TAKE_NUMBER,   /* numbers: finite or not */
    TAKE_TEXT,     /* texts */
    TAKE_SERVICE,  /* numbers: ROBUROC4_SERVICE_* */
    TAKE_SERVICES, /* services: all further arguments; all services if there are none */
    TAKE_OPTIONS   /* arguments that the command checks itself */
} argument_kind;

typedef struct argument {
    const char *name; /* in messages */
    argument_kind kind;
    double least, most;
} argument;

/** What the result is. */
typedef enum result_kind {
    NOTHING,
    NUMBER, /* call.number */
    FLAG,   /* call.number, as a logical */
    STRUCT, /* call.out */
    OTHER   /* made by the command */
} result_kind;

#define ARGUMENTS_MAX 8

/** The call of a command. */
typedef struct call {
    mxArray **results;
    int count;
    const mxArray **arguments; /* behind the name of the command and the id */
    double numbers[ARGUMENTS_MAX];
    const char *texts[ARGUMENTS_MAX];
    uint32_t services; /* bits by ROBUROC4_SERVICE_* */
    void *object;      /* the robot or simulator with this id */
    roburoc4_client *client;
    uint64_t now_us; /* the robot's time */
    double number;
    answer out;
} call;

typedef struct command {
    const char *name;
    subject of;
    result_kind result;
    int (*run)(call *in);
    argument arguments[ARGUMENTS_MAX]; /* up to one without a name */
} command;

/* clang-format off */
/* Arguments, for the tables. NONE: a command has none. */
#define NONE {NULL, TAKE_NUMBER, 0, 0}
#define WITHIN(name, least, most) {name, TAKE_RANGE, least, most}
#define SPEED(name) {name, TAKE_SPEED, -1e30, 1e30} /* a float; drive() refuses most of it */
#define WHOLE(name, least, most) {name, TAKE_WHOLE, least, most}
#define ANY_NUMBER(name) {name, TAKE_NUMBER, 0, 0}
#define SWITCH(name) {name, TAKE_WHOLE, 0, 1}
#define TEXT(name) {name, TAKE_TEXT, 0, 0}
#define SERVICE {"service", TAKE_SERVICE, 0, 0}
#define SERVICES_IF_ANY {"services", TAKE_SERVICES, 0, 0}
#define OPTIONS {"options", TAKE_OPTIONS, 0, 0}

/** Tables that end with a name of NULL. */
#define LAST {NULL, NO_ID, NOTHING, NULL, {NONE}}
/* clang-format on */
extern const command robot_life_commands[];
extern const command robot_drive_commands[];
extern const command robot_read_commands[];
extern const command simulator_commands[];
extern const command settings_commands[];

/** Convert the options of a call, a scalar struct, to settings. Returns 1; or 0 after noting which
 * option is unknown or out of range. */
int settings_of_robot(const mxArray *options, roburoc4_config *out);
int settings_of_simulator(const mxArray *options, roburoc4_sim_config *out);

/** 1; or 0 after noting that it runs in real time. */
int simulator_is_virtual(const simulation *s);
/** End all simulators. */
void close_simulators(void);

#endif
