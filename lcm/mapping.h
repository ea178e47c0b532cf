/* SPDX-License-Identifier: MIT
 *
 * From what the client knows to LCM messages: pure functions. Lists and strings of a message point
 * into storage of the caller, which must last as long as the message is used.
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
#define MAPPING_MESSAGE_SIZE 240
#define MAPPING_REASON_SIZE 300
/* Room for the longest message: properties with every name at its longest. */
#define MAPPING_MAX_ENCODED 20000

/* --------------------------------------------------------------------------- channel names --- */

/* The robot's own texts for the IO card's channels, by ROBUROC4_IO_* and index: UTF-8, "" where it
 * gave none. All 0 at first. */
typedef struct mapping_names {
    char text[MAPPING_NAMES][MAPPING_NAME_SIZE];
    char *list[MAPPING_NAMES];
} mapping_names;

/* A text of the robot for one channel; an empty one, or one for no channel, changes nothing. */
void mapping_names_set(mapping_names *names, int32_t io_type, uint32_t index, const uint8_t *text,
                       uint32_t length);
/* A name for each channel of a ROBUROC4_IO_*, from index 0 on: the robot's own text, else the
 * manual's name for this robot's card, else "". */
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

/* storage: ROBUROC4_MAX_DIGITAL_INPUTS. `in` and `names` are pointed into, too. */
void mapping_iocard(const roburoc4_inputs *in, const roburoc4_client *client, mapping_names *names,
                    int64_t utime, int8_t *storage, roburoc4_lcm_iocard_status_t *out);

/* Position and heading of a localization status in the main frame, which is the local frame of
 * libbot2's viewers; z, roll and pitch are 0. speeds (NULL: 0) are turned from the robot's frame
 * into it. */
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

/* All that the client knows of the robot. robot: its address as text. */
void mapping_properties(const roburoc4_client *client, mapping_names *names, char *robot,
                        int64_t utime, mapping_services *storage,
                        roburoc4_lcm_robot_properties_t *out);

/* ------------------------------------------------------------------------------ the bridge --- */

/* What the bridge knows of one robot and its commands. */
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
    bool heard;        /* a datagram of the robot ever came */
    bool no_socket;    /* it broke, or could not be opened */
    bool other_bridge; /* another one serves this robot, or publishes on its channels */
    uint32_t times_lost, reboots;
    int64_t command_us; /* on the clock that never goes back; -1 before the first */
    int64_t superseded, clamped, published, publish_errors;
    enum gate_verdict rejected; /* why the last command was; GATE_TAKEN before the first */
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
/* The state in a sentence without a full stop. */
void mapping_message(const mapping_view *view, char *room, size_t capacity);

#ifdef __cplusplus
}
#endif

#endif
