/* SPDX-License-Identifier: MIT
 *
 * Commands from LCM messages.
 *
 * The decoders that lcm-gen makes allocate by, and trust, lengths on the wire; here anybody on the
 * network may send anything. These read within the message, allocate nothing, and take all or
 * nothing. The fingerprints are lcm-gen's own.
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

/* No command is longer. LCM hands on some broken packets with a size of almost 4 GB. */
#define COMMAND_MAX_SIZE 4096

typedef struct command_analog {
    int32_t index;
    float value;
} command_analog;

/* Any command, with the fields of its kind (others are 0). */
typedef struct command {
    enum gate_kind kind;
    const char *sender; /* a view on the message, sender_length bytes of UTF-8, no NUL */
    size_t sender_length;
    int64_t utime;
    double linear_m_s, angular_rad_s; /* drive */
    int32_t lease_us;
    double x_m, y_m, theta_rad; /* relocalize */
    uint64_t digital_mask;      /* output: which digital outputs to set, and to what */
    uint64_t digital_values;
    bool digital_beyond; /* names a digital output that no client stores */
    uint32_t analog_count;
    command_analog analog[ROBUROC4_MAX_ANALOG_OUTPUTS];
} command;

/* Read a message of a kind's type; false, and nothing of use in *out, where it is none. */
bool command_decode(enum gate_kind kind, const void *data, size_t size, command *out);
/* What the gate has to know of it. */
gate_command command_for_gate(const command *command, int64_t arrived_utime);

#ifdef __cplusplus
}
#endif

#endif
