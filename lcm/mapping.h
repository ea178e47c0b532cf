/* SPDX-License-Identifier: MIT
 *
 * Pure functions from the client's data to LCM messages. Lists and strings of a message point into
 * the caller's storage, which must last as long as the message is used.
 */
#ifndef ROBUROC4_LCM_MAPPING_H
#define ROBUROC4_LCM_MAPPING_H

#include "bot_core_pose_t.h"
#include "gate.h"
#include "roburoc4.h"
#include "roburoc4_lcm.h"

#ifdef __cplusplus
extern "C" {
#endif

#define MAPPING_NAME_SIZE 64
#define MAPPING_NAMES                                                                              \
    (ROBUROC4_MAX_ANALOG_INPUTS + ROBUROC4_MAX_ANALOG_OUTPUTS + ROBUROC4_MAX_DIGITAL_INPUTS +      \
     ROBUROC4_MAX_DIGITAL_OUTPUTS)
#define MAPPING_MESSAGE_SIZE 300
#define MAPPING_REASON_SIZE 300
/* Room for the longest message: properties with the longest possible names. */
#define MAPPING_MAX_ENCODED 20000

/* --------------------------------------------------------------------------- channel names --- */

/* The robot's own texts for the IO card's channels, by ROBUROC4_IO_* and index: UTF-8, "" if it
 * gave none. Must be all 0 at first. */
typedef struct mapping_names {
    char text[MAPPING_NAMES][MAPPING_NAME_SIZE];
    char *list[MAPPING_NAMES];
} mapping_names;

/* Store the robot's text for one channel. An empty text, or a channel that does not exist, is
 * ignored. */
void mapping_names_set(mapping_names *names, int32_t io_type, uint32_t index, const uint8_t *text,
                       uint32_t length);
/* The names of all channels of one ROBUROC4_IO_* type, from index 0 on: the robot's own text, else
 * the manual's name if the card matches, else "". */
char **mapping_names_of(mapping_names *names, const roburoc4_client *client, int32_t io_type);

/* -------------------------------------------------------------------------------- statuses --- */

void mapping_differential(const roburoc4_differential_status *in, int64_t utime,
                          roburoc4_lcm_differential_status_t *out);
void mapping_localization(const roburoc4_localization_status *in, int64_t utime,
                          roburoc4_lcm_localization_status_t *out);
void mapping_battery(const roburoc4_battery_status *in, int64_t utime,
                     roburoc4_lcm_battery_status_t *out);

/* known: `known_count` telemeters with their properties; storage: ROBUROC4_MAX_TELEMETERS. */
void mapping_telemeter(const roburoc4_distances *in, const roburoc4_telemeter *known,
                       uint32_t known_count, int64_t utime, roburoc4_lcm_telemeter_t *storage,
                       roburoc4_lcm_telemeter_status_t *out);

/* storage: ROBUROC4_MAX_DIGITAL_INPUTS. *out also points into `in` and `names`. */
void mapping_iocard(const roburoc4_inputs *in, const roburoc4_client *client, mapping_names *names,
                    int64_t utime, int8_t *storage, roburoc4_lcm_iocard_status_t *out);

/* Position and heading in the main (odometry) frame, which is the local frame of libbot2's viewers;
 * z, roll and pitch are 0. speeds (NULL: 0) are rotated from the robot's frame into it. */
void mapping_pose(const roburoc4_localization_status *in,
                  const roburoc4_differential_status *speeds, int64_t utime, bot_core_pose_t *out);

/* ------------------------------------------------------------------------------ properties --- */

typedef struct mapping_services {
    int32_t ids[ROBUROC4_MAX_SERVICES];
    int32_t types[ROBUROC4_MAX_SERVICES];
    char names[ROBUROC4_MAX_SERVICES][MAPPING_NAME_SIZE];
    char *list[ROBUROC4_MAX_SERVICES];
    roburoc4_lcm_telemeter_t telemeters[ROBUROC4_MAX_TELEMETERS];
} mapping_services;

/* Everything that the client knows about the robot. config: of the client; robot: its address as
 * text. */
void mapping_properties(const roburoc4_client *client, const roburoc4_config *config,
                        mapping_names *names, char *robot, int64_t utime, mapping_services *storage,
                        roburoc4_lcm_robot_properties_t *out);

/* ------------------------------------------------------------------------------ the bridge --- */

/* What the bridge knows about one robot and its commands. */
typedef struct mapping_view {
    gate_time now;
    char *robot;        /* address as text */
    const char *bridge; /* this bridge: host and process */
    int64_t started_utime;
    const roburoc4_facts *facts;
    const roburoc4_link *link;
    const struct gate *gate;
    gate_robot for_gate;
    uint32_t fault;    /* ROBUROC4_FAULT_* */
    bool heard;        /* a datagram from the robot has arrived */
    bool no_socket;    /* the socket broke, or could not be opened */
    bool no_address;   /* the robot's name has none */
    bool other_bridge; /* another bridge serves this robot, or publishes on its channels */
    uint32_t times_lost, reboots;
    int64_t command_us; /* monotonic time of the last command; -1 before the first */
    int64_t moves, superseded, clamped, published, publish_errors;
    enum gate_verdict rejected; /* why the last rejected command was rejected; GATE_TAKEN before the
                                 * first */
    const char *rejected_sender, *rejected_why;
    int64_t rejected_utime;
} mapping_view;

typedef struct mapping_texts {
    char owner[GATE_MAX_SENDER + 1];
    char stopped_by[GATE_MAX_SENDER + 1];
    char rejected_sender[GATE_MAX_SENDER + 1];
    char message[MAPPING_MESSAGE_SIZE];
} mapping_texts;

void mapping_bridge_state(const mapping_view *view, mapping_texts *storage,
                          roburoc4_lcm_bridge_state_t *out);
void mapping_bridge_statistics(const mapping_view *view, roburoc4_lcm_bridge_statistics_t *out);
/* The state as a sentence without a full stop. */
void mapping_message(const mapping_view *view, char *room, size_t capacity);

#ifdef __cplusplus
}
#endif

#endif
