/* SPDX-License-Identifier: MIT */
#include "commands.h"

#include <string.h>

#include "roburoc4_lcm.h"
#include "text.h"

#define MAX_DIGITAL ROBUROC4_MAX_DIGITAL_OUTPUTS
#define MAX_ANALOG ROBUROC4_MAX_ANALOG_OUTPUTS

/* ---------------------------------------------------------------------------------- reader --- */

/* LCM is big-endian. After a read has failed, all later ones fail too and return 0. */
typedef struct reader {
    const uint8_t *at;
    size_t left;
    bool failed;
} reader;

static const uint8_t *take(reader *reader, size_t size) {
    const uint8_t *at = reader->at;
    if (reader->failed || size > reader->left) {
        reader->failed = true;
        return NULL;
    }
    reader->at += size;
    reader->left -= size;
    return at;
}

static uint64_t read_bits(reader *reader, size_t size) {
    const uint8_t *bytes = take(reader, size);
    uint64_t value = 0;
    for (size_t at = 0; bytes != NULL && at < size; at++) {
        value = value << 8 | bytes[at];
    }
    return value;
}

static int64_t read_int64(reader *reader) {
    return (int64_t)read_bits(reader, 8);
}

static int32_t read_int32(reader *reader) {
    return (int32_t)(uint32_t)read_bits(reader, 4);
}

static double read_double(reader *reader) {
    uint64_t bits = read_bits(reader, 8);
    double value = 0.0;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static float read_float(reader *reader) {
    uint32_t bits = (uint32_t)read_bits(reader, 4);
    float value = 0.0f;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* A string's length includes its NUL; there must be no other. */
static const char *read_text(reader *reader, size_t *text_length) {
    int32_t length = read_int32(reader);
    const uint8_t *text = length > 0 ? take(reader, (size_t)length) : NULL;
    if (text == NULL || text[length - 1] != 0 || !text_is_utf8(text, (size_t)length - 1)) {
        reader->failed = true;
        return NULL;
    }
    *text_length = (size_t)length - 1;
    return (const char *)text;
}

static uint32_t read_count(reader *reader, uint32_t max) {
    int32_t count = read_int32(reader);
    if (count < 0 || (uint32_t)count > max) {
        reader->failed = true;
    }
    return reader->failed ? 0 : (uint32_t)count;
}

/* ---------------------------------------------------------------------------------- bodies --- */

static void read_drive(reader *reader, command *out) {
    out->linear_m_s = read_double(reader);
    out->angular_rad_s = read_double(reader);
    out->lease_us = read_int32(reader);
}

static void read_relocalize(reader *reader, command *out) {
    out->x_m = read_double(reader);
    out->y_m = read_double(reader);
    out->theta_rad = read_double(reader);
}

static void set_digital(command *out, int32_t index, bool on) {
    if (index < 0 || index >= MAX_DIGITAL) {
        out->digital_beyond = true;
        return;
    }
    uint64_t bit = (uint64_t)1 << index;
    out->digital_mask |= bit;
    out->digital_values = on ? out->digital_values | bit : out->digital_values & ~bit;
}

static void read_outputs(reader *reader, command *out) {
    int32_t index[MAX_DIGITAL];
    uint32_t count = read_count(reader, MAX_DIGITAL);
    for (uint32_t at = 0; at < count; at++) {
        index[at] = read_int32(reader);
    }
    for (uint32_t at = 0; at < count; at++) {
        set_digital(out, index[at], read_bits(reader, 1) != 0);
    }
    out->analog_count = read_count(reader, MAX_ANALOG);
    for (uint32_t at = 0; at < out->analog_count; at++) {
        out->analog[at].index = read_int32(reader);
    }
    for (uint32_t at = 0; at < out->analog_count; at++) {
        out->analog[at].value = read_float(reader);
    }
}

static int64_t fingerprint(enum gate_kind kind) {
    switch (kind) {
    case GATE_DRIVE:
        return __roburoc4_lcm_drive_command_t_get_hash();
    case GATE_RELOCALIZE:
        return __roburoc4_lcm_relocalize_command_t_get_hash();
    case GATE_OUTPUT:
        return __roburoc4_lcm_output_command_t_get_hash();
    default:
        return __roburoc4_lcm_stop_command_t_get_hash();
    }
}

static void read_body(reader *reader, command *out) {
    switch (out->kind) {
    case GATE_DRIVE:
        read_drive(reader, out);
        break;
    case GATE_RELOCALIZE:
        read_relocalize(reader, out);
        break;
    case GATE_OUTPUT:
        read_outputs(reader, out);
        break;
    default:
        break;
    }
}

bool command_decode(enum gate_kind kind, const void *data, size_t size, command *out) {
    reader reader = {data, size, false};
    memset(out, 0, sizeof *out);
    out->kind = kind;
    if (size > COMMANDS_MAX_SIZE || read_int64(&reader) != fingerprint(kind)) {
        return false;
    }
    if (kind != GATE_STOP) {
        out->utime = read_int64(&reader);
    }
    out->sender = read_text(&reader, &out->sender_length);
    read_body(&reader, out);
    return !reader.failed && reader.left == 0;
}

bool command_decode_move(const void *data, size_t size, command *out) {
    reader reader = {data, size, false};
    memset(out, 0, sizeof *out);
    out->kind = GATE_DRIVE;
    out->is_move = true;
    if (size > COMMANDS_MAX_SIZE ||
        read_int64(&reader) != __roburoc4_lcm_move_command_t_get_hash()) {
        return false;
    }
    out->utime = read_int64(&reader);
    out->sender = read_text(&reader, &out->sender_length);
    out->move_id = read_int64(&reader);
    out->move_kind = read_int32(&reader);
    out->distance_m = read_double(&reader);
    out->angle_rad = read_double(&reader);
    out->x_m = read_double(&reader);
    out->y_m = read_double(&reader);
    out->theta_rad = read_double(&reader);
    out->linear_m_s = read_double(&reader);
    out->angular_rad_s = read_double(&reader);
    out->max_linear_m_s2 = read_double(&reader);
    out->max_angular_rad_s2 = read_double(&reader);
    out->clearance_m = read_double(&reader);
    out->timeout_ms = read_int32(&reader);
    out->allow_turns = read_bits(&reader, 1) != 0;
    out->lease_us = read_int32(&reader);
    return !reader.failed && reader.left == 0;
}

bool bridge_identity_decode(const void *data, size_t size, bridge_identity *out) {
    reader reader = {data, size, false};
    size_t length = 0;
    if (size > COMMANDS_MAX_SIZE ||
        read_int64(&reader) != __roburoc4_lcm_bridge_state_t_get_hash()) {
        return false;
    }
    out->utime = read_int64(&reader);
    out->robot = read_text(&reader, &length);
    out->bridge = read_text(&reader, &length);
    out->started_utime = read_int64(&reader);
    return !reader.failed;
}

/* -------------------------------------------------------------------------------- for gate --- */

/* Tests the bits, so that no compiler option can assume NaN away. */
static bool is_finite(double value) {
    uint64_t bits = 0;
    memcpy(&bits, &value, sizeof bits);
    return (bits >> 52 & 0x7FFu) != 0x7FFu;
}

static bool has_finite_values(const command *command) {
    bool finite = is_finite(command->linear_m_s) && is_finite(command->angular_rad_s) &&
                  is_finite(command->x_m) && is_finite(command->y_m) &&
                  is_finite(command->theta_rad) && is_finite(command->distance_m) &&
                  is_finite(command->angle_rad) && is_finite(command->clearance_m) &&
                  is_finite(command->max_linear_m_s2) && is_finite(command->max_angular_rad_s2);
    for (uint32_t at = 0; at < command->analog_count; at++) {
        uint32_t bits = 0;
        memcpy(&bits, &command->analog[at].value, sizeof bits);
        finite = finite && (bits >> 23 & 0xFFu) != 0xFFu;
    }
    return finite;
}

gate_command command_for_gate(const command *command, int64_t arrived_utime) {
    gate_command for_gate = {
        .kind = command->kind,
        .sender = command->sender,
        .sender_length = command->sender_length,
        .utime = command->utime,
        .arrived_utime = arrived_utime,
        .lease_us = command->lease_us,
        .finite = has_finite_values(command),
    };
    for_gate.zero = command->kind == GATE_DRIVE && !command->is_move && for_gate.finite &&
                    command->linear_m_s == 0.0 && command->angular_rad_s == 0.0;
    return for_gate;
}

float command_speed(double value) {
    const double far = 1e6;
    return (float)(value > far ? far : value < -far ? -far : value);
}
