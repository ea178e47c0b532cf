/* SPDX-License-Identifier: MIT
 *
 * Decoders for what the bridge reads from LCM: commands, and the identity of other bridges.
 *
 * lcm-gen's decoders allocate as much as lengths from the network say. These stay within the
 * message, allocate nothing, and accept all of a message or nothing. The fingerprints are lcm-gen's
 * own.
 */
#ifndef ROBUROC4_LCM_COMMANDS_H
#define ROBUROC4_LCM_COMMANDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gate.h"
#include "roburoc4.h"

#ifdef __cplusplus
extern "C" {
#endif

/* No valid message is longer. LCM delivers some malformed packets with a size of almost 4 GB. */
#define COMMANDS_MAX_SIZE 4096

typedef struct command_analog {
    int32_t index;
    float value;
} command_analog;

/* Any command; the fields of other kinds are 0. */
typedef struct command {
    enum gate_kind kind;
    const char *sender; /* a view on the message, sender_length bytes of UTF-8, no NUL */
    size_t sender_length;
    int64_t utime;
    double linear_m_s, angular_rad_s; /* drive */
    int32_t lease_us;
    double x_m, y_m, theta_rad; /* relocalize, move */
    bool is_move;               /* then its kind is GATE_DRIVE, and its speeds are limits */
    int32_t move_kind;
    int64_t move_id;
    double distance_m, angle_rad, clearance_m, max_linear_m_s2, max_angular_rad_s2;
    int32_t timeout_ms;
    bool allow_turns;
    uint64_t digital_mask; /* output: which digital outputs to set, and to what */
    uint64_t digital_values;
    bool digital_beyond; /* an index is above those that the client stores */
    uint32_t analog_count;
    command_analog analog[ROBUROC4_MAX_ANALOG_OUTPUTS];
} command;

/* Decode a message of this kind. Returns false, with *out undefined, if it is not one. A stop
 * command has only a sender. */
bool command_decode(enum gate_kind kind, const void *data, size_t size, command *out);
/* The same for a move. */
bool command_decode_move(const void *data, size_t size, command *out);
/* The part of a command that the gate looks at. */
gate_command command_for_gate(const command *command, int64_t arrived_utime);

/* A speed of a drive command as the client takes it. One that no float has becomes 1e6 with its
 * sign, which is still refused as too fast. */
float command_speed(double value);

/* The first fields of a bridge_state_t: which bridge serves which robot. */
typedef struct bridge_identity {
    int64_t utime, started_utime;
    const char *robot, *bridge; /* views on the message, UTF-8 with a NUL */
} bridge_identity;

bool bridge_identity_decode(const void *data, size_t size, bridge_identity *out);

#ifdef __cplusplus
}
#endif

#endif
