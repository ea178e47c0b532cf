/* SPDX-License-Identifier: MIT
 *
 * One robot of the bridge: its client and socket, its gate, and the channels that connect them to
 * LCM. The main loop calls it; it never blocks.
 */
#ifndef ROBUROC4_LCM_ROBOT_H
#define ROBUROC4_LCM_ROBOT_H

#include <lcm/lcm.h>

#include "commands.h"
#include "mapping.h"
#include "options.h"
#include "roburoc4_move.h"
#include "roburoc4_record.h"

/* The newest drive command of an iteration of the loop. */
typedef struct robot_drive {
    float linear_m_s, angular_rad_s;
    uint32_t lease_us;
    int64_t utime;
} robot_drive;

/* The last move that was commanded. */
typedef struct robot_move {
    roburoc4_move move;
    bool known, active;
    char sender[GATE_MAX_SENDER + 1];
    int64_t id;
    uint64_t until_us; /* its lease */
    uint64_t ended_us;
} robot_move;

/* This bridge's identity, published so that bridges notice one another. */
typedef struct robot_bridge {
    char name[96]; /* host and process */
    int64_t started_utime;
} robot_bridge;

/* The rejections with one cause, and the last of them. */
typedef struct robot_rejection {
    int64_t utime;
    char sender[GATE_MAX_SENDER + 1];
    char why[MAPPING_REASON_SIZE];
} robot_rejection;

/* Something that is published periodically, and sooner after a change. */
typedef struct robot_publication {
    uint64_t last_us;
    bool due;
} robot_publication;

typedef struct robot {
    const char *name; /* "" if there is only one */
    uint32_t number;  /* of its socket, for watch_set() */
    const channel_names *channels;
    const options_robot *settings;
    const robot_bridge *bridge;
    lcm_t *lcm;
    roburoc4_recorder *recorder; /* or NULL */
    roburoc4_client client;
    roburoc4_udp udp; /* closed while the system provides none */
    roburoc4_address to;
    char address[ROBUROC4_ADDRESS_TEXT_SIZE];
    struct gate gate;
    gate_time started;
    mapping_names names;

    robot_move moving;
    robot_drive drive; /* if has_drive: will be applied at the end of this iteration */

    roburoc4_telemeter telemeters[ROBUROC4_MAX_TELEMETERS];
    uint32_t telemeter_count;
    roburoc4_differential_status speeds; /* for the pose; all 0 before the first */

    uint64_t open_us;        /* while the socket is closed: when to try again */
    uint64_t other_until_us; /* until when another bridge is assumed; 0: none */
    robot_rejection rejections[GATE_VERDICTS];
    enum gate_verdict last_rejection; /* GATE_TAKEN before the first */
    bool has_drive;
    bool heard; /* a datagram from the robot has arrived */
    bool logged_absent, logged_no_socket;
    robot_publication state, statistics, properties, move_status;
    int64_t command_us; /* when the last command was obeyed, or -1 */
    int64_t moves, superseded, clamped, published, publish_errors;
} robot;

/* Open the socket and start the client. If no socket can be opened, retry every second. The struct
 * must not be moved afterwards. */
void robot_start(robot *robot, uint32_t number, const options_robot *settings, lcm_t *lcm,
                 const robot_bridge *bridge, roburoc4_recorder *recorder, gate_time now);

/* Handle a message on a command's channel that arrived at arrived_utime on this machine's clock. */
void robot_take_message(robot *robot, enum channel channel, const void *data, size_t size,
                        int64_t arrived_utime);
/* Another bridge, whose state arrived on `channel`, serves a robot with this address. */
void robot_hear_bridge(robot *robot, const bridge_identity *other, const char *channel,
                       gate_time now);

/* When to call robot_serve() if nothing arrives before. */
uint64_t robot_deadline(const robot *robot);
/* Read what the robot sent, and publish it. */
void robot_serve(robot *robot);
/* Call after LCM was read: apply the newest drive command, send what is due, publish the states. */
void robot_finish(robot *robot);

/* Begin to close: the stop sequence is sent. Do not read LCM any more. */
void robot_close(robot *robot, gate_time now);
bool robot_is_closed(const robot *robot);
/* Publish the last state and close the socket. */
void robot_end(robot *robot);

#endif
