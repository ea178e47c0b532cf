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
#include "roburoc4_record.h"

/* The newest drive command of a wake. */
typedef struct robot_drive {
    float linear_m_s, angular_rad_s;
    uint32_t lease_us;
    int64_t utime;
} robot_drive;

/* Which bridge this is, for others to read. */
typedef struct robot_bridge {
    char name[96]; /* host and process */
    int64_t started_utime;
} robot_bridge;

/* A cause for which commands were rejected, and the last one of them. */
typedef struct robot_rejection {
    int64_t utime;
    char sender[GATE_MAX_SENDER + 1];
    char why[MAPPING_REASON_SIZE];
} robot_rejection;

/* What is published in a period, and sooner after a change. */
typedef struct robot_publication {
    uint64_t last_us;
    bool due;
} robot_publication;

typedef struct robot {
    const char *name; /* "" for the only one */
    uint32_t number;  /* that of its socket for watch_set() */
    const channel_names *channels;
    const roburoc4_config *config;
    const robot_bridge *bridge;
    lcm_t *lcm;
    roburoc4_recorder *recorder; /* or NULL */
    roburoc4_client client;
    roburoc4_udp udp; /* closed while the system gives none */
    roburoc4_address to;
    char address[ROBUROC4_ADDRESS_TEXT_SIZE];
    struct gate gate;
    gate_time started;
    mapping_names names;

    robot_drive drive; /* where has_drive: to be applied at the end of this wake */

    roburoc4_telemeter telemeters[ROBUROC4_MAX_TELEMETERS];
    uint32_t telemeter_count;
    roburoc4_differential_status speeds; /* for the pose; all 0 before the first */

    uint64_t open_us;        /* while the socket is closed: when to open one */
    uint64_t other_until_us; /* another bridge was heard; 0: none */
    robot_rejection rejections[GATE_VERDICTS];
    enum gate_verdict last_rejection; /* GATE_TAKEN before the first */
    bool has_drive;
    bool heard; /* a datagram of the robot ever came */
    bool logged_absent, logged_no_socket;
    robot_publication state, statistics, properties;
    int64_t command_us; /* when the last command was obeyed, or -1 */
    int64_t superseded, clamped, published, publish_errors;
} robot;

/* Open the socket and start the client. Where there is no socket now, it is tried each second. The
 * robot must stay where it is. */
void robot_start(robot *robot, uint32_t number, const options_robot *settings, lcm_t *lcm,
                 const robot_bridge *bridge, roburoc4_recorder *recorder, gate_time now);

/* A message on the channel of a command, which came at arrived_utime on this machine's clock. */
void robot_take_message(robot *robot, enum gate_kind kind, const void *data, size_t size,
                        int64_t arrived_utime);
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
