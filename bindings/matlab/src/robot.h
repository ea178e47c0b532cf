/* SPDX-License-Identifier: MIT
 *
 * robot.h - one robot on a pump: in real time, where the pump's thread calls nothing of MATLAB, or
 * in the virtual time of a simulator, where the pump has no thread.
 */
#ifndef ROBUROC4_MEX_ROBOT_H
#define ROBUROC4_MEX_ROBOT_H

#include "roburoc4_move.h"
#include "samples.h"
#include "simulation.h"

typedef struct robot {
    roburoc4_pump *pump;         /* in virtual time one without a thread */
    roburoc4_recorder *recorder; /* or NULL */
    simulation *world;           /* in virtual time; stopped when the simulator was deleted */
    uint64_t opened_us;
    uint32_t lease_us;
    uint32_t fresh_us;          /* maximum age of a status that counts */
    int busy;                   /* a waiting method is running: if it ends early, the robot stops */
    recording logged;           /* since the robot was made, or since the last log() */
    recording recorded;         /* since record() */
    roburoc4_pump_reader heard; /* of receive() */
    roburoc4_pump_reader told;  /* of news() */
    uint32_t events;            /* of news(): bits that it has not returned yet */
    roburoc4_move move;         /* the one that was started last */
} robot;

/** Settings with which a robot is opened. */
typedef struct robot_settings {
    roburoc4_config config;
    uint32_t buffer;    /* statuses that are kept for record() and log() */
    const char *record; /* file or folder for all datagrams; "": they are not recorded */
} robot_settings;

/** Open a link in real time, or (with a NULL address) join a world. Returns its id, or 0 after
 * noting the error; an absent robot is not an error. */
double robot_open(const char *address, simulation *world, const robot_settings *settings);
/** End the link of a robot, and free it. In real time it waits until the stop sequence is over: see
 * robot_leave(). */
void robot_close(void *closed);
/** Close all of them; their stop sequences run in parallel. */
void robots_close(void);

/** Whether it accepts commands: not after its simulator was deleted, nor in a forked process. */
int robot_is_open(const robot *r);
/** Returns 0 after noting why the robot cannot be read, or cannot be commanded. */
int robot_can(const robot *r, int be_commanded);
/** The clock of the robot's times. */
uint64_t robot_now_us(const robot *r);
/** UTC when that clock is 0, by what this machine's clock shows now; in virtual time 0, so that
 * runs are reproducible. */
uint64_t robot_utc_us(const robot *r);
/** A copy of its client, for reading only, and the time. Valid until the next call. */
roburoc4_client *robot_copy(robot *r, uint64_t *now_us);
/** Its client and the time, for any roburoc4_client_*() call until robot_unlock(), which sends what
 * is due. Nothing in between may wait, or call MATLAB, which may not return. Only for a robot that
 * was open at the beginning of the command, or is in virtual time. */
roburoc4_client *robot_lock(robot *r, uint64_t *now_us);
void robot_unlock(robot *r);
/** Let this much of the robot's time pass; in real time less if there is a reader (or NULL) and a
 * sample that it has not read. */
void robot_wait(robot *r, uint32_t duration_us, const roburoc4_pump_reader *reader);

/** Those of its copy. Of a robot that is no longer open nothing is fresh, and it does not drive. */
roburoc4_facts robot_facts(const robot *r, const roburoc4_client *copy, uint64_t now_us);
roburoc4_facts client_facts(const roburoc4_client *client, uint64_t now_us);
/** Stop it if this object drives it: one that only reads commands nothing. Whether a stop sequence
 * runs then. */
int robot_leave(robot *r);

#endif
