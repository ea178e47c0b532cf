/* SPDX-License-Identifier: MIT
 *
 * One robot of the bridge: its client and socket, its gate, and the channels that both are joined
 * to. The main loop calls it; it never waits.
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

/* The newest drive command of a wake. Its sender has the seat. */
typedef struct robot_drive {
    float linear_m_s, angular_rad_s;
    uint32_t lease_us;
} robot_drive;

typedef struct robot {
    const char *name; /* "" for the only one */
    const channel_names *channels;
    const roburoc4_config *config;
    lcm_t *lcm;
    roburoc4_client client;
    roburoc4_udp udp;
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
    uint32_t told;             /* verdicts that were explained in the log, a bit each */
    bool has_drive;
    bool told_absent;
    bool status_due, properties_due;
    uint64_t status_us, properties_us; /* when these were published */
    int64_t command_us;                /* when the last command was taken, or -1 */
    int64_t superseded, clamped, published, publish_errors;
    int64_t clock_offset_us; /* of the wall clock, to notice that it was set */
} robot;

/* Subscribe to the commands' channels; false where LCM cannot. The robot must stay where it is. */
bool robot_subscribe(robot *robot, lcm_t *lcm, const options_robot *settings);
/* Open the socket and start the client. False, and said why, where there is no socket. */
bool robot_start(robot *robot, const options *options, const options_robot *settings,
                 gate_time now);

/* The bridge hung since `since_utime`, and goes on now: what is read soon may have come long ago.
 */
void robot_was_stalled(robot *robot, int64_t since_utime, gate_time now);

/* When robot_serve() must be called if nothing comes before. */
uint64_t robot_deadline(const robot *robot);
/* Read what the robot sent, publish it, and look after arming. False where its socket is broken. */
bool robot_serve(robot *robot);
/* After LCM was drained: apply the newest drive command, send what is due, publish the states. */
void robot_finish(robot *robot);

/* Begin to end: zeros are sent. LCM must not be read any more. */
void robot_close(robot *robot, gate_time now);
bool robot_is_closed(const robot *robot);
/* Publish the last state and close the socket. */
void robot_end(robot *robot);

#endif
