/* SPDX-License-Identifier: MIT
 *
 * One robot of the bridge: its client and socket, its gate, and the channels that connect both to
 * LCM. The main loop calls it; it never waits.
 */
#ifndef ROBUROC4_LCM_ROBOT_H
#define ROBUROC4_LCM_ROBOT_H

#include <lcm/lcm.h>

#include "commands.h"
#include "mapping.h"
#include "options.h"
#include "roburoc4_udp.h"

struct robot;

/* What LCM hands back with a message of a command's channel. */
typedef struct robot_input {
    struct robot *robot;
    enum gate_kind kind;
} robot_input;

/* The newest drive command of a wake. */
typedef struct robot_drive {
    float linear_m_s, angular_rad_s;
    uint32_t lease_us;
} robot_drive;

/* Which bridge this is, for others to read. */
typedef struct robot_bridge {
    char name[96]; /* host and process */
    int64_t started_utime;
} robot_bridge;

/* What is published in a period, and sooner after a change. */
typedef struct robot_publication {
    uint64_t last_us;
    bool due;
} robot_publication;

typedef struct robot {
    const char *name; /* "" for the only one */
    const channel_names *channels;
    const roburoc4_config *config;
    const robot_bridge *bridge;
    lcm_t *lcm;
    roburoc4_client client;
    roburoc4_udp udp; /* closed while the system gives none */
    roburoc4_address to;
    char address[ROBUROC4_ADDRESS_TEXT_SIZE];
    struct gate gate;
    gate_time started;
    mapping_names names;
    robot_input inputs[GATE_KINDS];

    robot_drive drive; /* where has_drive: to be applied at the end of this wake */

    roburoc4_telemeter telemeters[ROBUROC4_MAX_TELEMETERS];
    uint32_t telemeter_count;
    roburoc4_differential_status speeds; /* for the pose; all 0 before the first */

    int64_t stalled_utime;     /* the bridge hung from here ... */
    uint64_t stalled_until_us; /* ... and may still read what came meanwhile, until here */
    uint64_t open_us;          /* while the socket is closed: when to open one */
    uint64_t other_until_us;   /* another bridge was heard; 0: none */
    uint32_t logged;           /* verdicts that were explained in the log, a bit each */
    bool has_drive;
    bool heard; /* a datagram of the robot ever came */
    bool logged_absent, logged_no_socket;
    robot_publication state, statistics, properties;
    int64_t command_us; /* when the last command was obeyed, or -1 */
    int64_t superseded, clamped, published, publish_errors;
    int64_t clock_offset_us; /* of the wall clock, to notice that it was set */
} robot;

/* Subscribe to the commands' channels; false where LCM cannot. The robot must stay where it is. */
bool robot_subscribe(robot *robot, lcm_t *lcm, const options_robot *settings);
/* Open the socket and start the client. Where there is no socket now, it is tried each second. */
void robot_start(robot *robot, const options *options, const options_robot *settings,
                 const robot_bridge *bridge, gate_time now);

/* The bridge hung since `since_utime`, and goes on now: what is read soon may have come long ago.
 */
void robot_was_stalled(robot *robot, int64_t since_utime, gate_time now);
/* Another bridge (its state came on `channel`) serves the robot of this address. */
void robot_hear_bridge(robot *robot, const bridge_identity *other, const char *channel,
                       gate_time now);

/* When robot_serve() must be called if nothing comes before. */
uint64_t robot_deadline(const robot *robot);
/* Read what the robot sent, and publish it. */
void robot_serve(robot *robot);
/* After LCM was drained: apply the newest drive command, send what is due, publish the states. */
void robot_finish(robot *robot);

/* Begin to end: the stop sequence is sent. LCM must not be read any more. */
void robot_close(robot *robot, gate_time now);
bool robot_is_closed(const robot *robot);
/* Publish the last state and close the socket. */
void robot_end(robot *robot);

#endif
