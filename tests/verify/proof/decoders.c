/* SPDX-License-Identifier: MIT
 *
 * For Frama-C's Eva: every decoder, and what reads its result, on arbitrary bytes of every length
 * that a UDP datagram can have. tests/verify/proof/run analyses each main_* below; none is ever
 * run.
 */
#include "roburoc4.h"

#include <__fc_builtin.h>

#define LONGEST 65507
/* Each length to this one is a case of its own; all layouts of the manual are shorter. */
#define EACH 160

static uint8_t memory[LONGEST];
static uint8_t some_bytes[EACH];
static volatile double sink;

#define READ(value) (sink = (double)(value))

static uint32_t any_u32(void) {
    return Frama_C_unsigned_int_interval(0, UINT32_MAX);
}

/* Any longer length. Its first EACH bytes are all that a decoder of a fixed layout may touch; what
 * reads a list may touch what lies in the longest datagram. */
#define FIXED some_bytes
#define LIST memory

static void on_every_length(void (*use)(const uint8_t *, size_t), const uint8_t *long_datagram) {
    size_t size = Frama_C_size_t_interval(0, EACH);
    Frama_C_make_unknown((char *)memory, sizeof memory);
    Frama_C_make_unknown((char *)some_bytes, sizeof some_bytes);
    if (Frama_C_nondet(0, 1)) {
        /* it lies at the very end of `memory`: the byte after it is no object's */
        //@ split size;
        use(memory + (LONGEST - size), size);
    } else {
        use(long_datagram, Frama_C_size_t_interval(EACH + 1, LONGEST));
    }
}

#define HARNESS(name, long_datagram)                                                               \
    void main_##name(void) {                                                                       \
        on_every_length(name, long_datagram);                                                      \
    }

/** All of a result can be read: it is set. */
static void read_all(const uint8_t *result, size_t size) {
    for (size_t i = 0; i < size; i++) {
        READ(result[i]);
    }
}

/* Of a layout without a list. */
#define DECODES(name)                                                                              \
    static void name(const uint8_t *data, size_t size) {                                           \
        roburoc4_##name out;                                                                       \
        if (roburoc4_decode_##name(data, size, &out) >= 0) {                                       \
            read_all((const uint8_t *)&out, sizeof out);                                           \
        }                                                                                          \
    }

DECODES(request)
HARNESS(request, FIXED)
DECODES(battery_properties)
HARNESS(battery_properties, FIXED)
DECODES(localization_properties)
HARNESS(localization_properties, FIXED)
DECODES(differential_properties)
HARNESS(differential_properties, FIXED)
DECODES(status_header)
HARNESS(status_header, FIXED)
DECODES(battery_status)
HARNESS(battery_status, FIXED)
DECODES(localization_status)
HARNESS(localization_status, FIXED)
DECODES(differential_status)
HARNESS(differential_status, FIXED)
DECODES(differential_command)
HARNESS(differential_command, FIXED)

static void answer(const uint8_t *data, size_t size) {
    roburoc4_answer out;
    if (roburoc4_decode_answer(data, size, &out) >= 0) {
        READ(out.id + out.action + out.service + out.error);
        if (out.payload_size > 0) {
            READ(out.payload[0]);
            READ(out.payload[out.payload_size - 1]);
        }
    }
}
HARNESS(answer, LIST)

static void directory(const uint8_t *data, size_t size) {
    roburoc4_directory out;
    roburoc4_directory_entry entry;
    if (roburoc4_decode_directory(data, size, &out) >= 0) {
        READ(out.service);
        if (roburoc4_directory_at(&out, any_u32(), &entry) >= 0) {
            READ(entry.type + entry.id);
        }
    }
}
HARNESS(directory, LIST)

static void notification(const uint8_t *data, size_t size) {
    roburoc4_notification out;
    roburoc4_subscription entry;
    if (roburoc4_decode_notification(data, size, &out) >= 0) {
        READ(out.service);
        if (roburoc4_notification_at(&out, any_u32(), &entry) >= 0) {
            READ(entry.service + entry.period_cycles);
        }
    }
}
HARNESS(notification, LIST)

static void iocard_properties(const uint8_t *data, size_t size) {
    roburoc4_iocard_properties out;
    if (roburoc4_decode_iocard_properties(data, size, &out) >= 0) {
        /*@ assert none_below_0: out.analog_inputs >= 0 && out.analog_outputs >= 0 &&
                   out.digital_inputs >= 0 && out.digital_outputs >= 0; */
        READ(out.service);
    }
}
HARNESS(iocard_properties, FIXED)

static void telemeter_properties(const uint8_t *data, size_t size) {
    roburoc4_telemeter_list out;
    roburoc4_telemeter telemeter;
    if (roburoc4_decode_telemeter_properties(data, size, &out) >= 0) {
        READ(out.service);
        if (roburoc4_telemeter_at(&out, any_u32(), &telemeter) >= 0) {
            READ(telemeter.x_m + telemeter.y_m + telemeter.theta_rad);
            READ(telemeter.field_of_view_rad + telemeter.distance_m);
            READ(telemeter.min_distance_m + telemeter.max_distance_m);
        }
    }
}
HARNESS(telemeter_properties, LIST)

static void text(const uint8_t *data, size_t size) {
    roburoc4_text out;
    if (roburoc4_decode_text(data, size, &out) >= 0) {
        READ(out.service);
        if (out.length > 0) {
            READ(out.text[0]);
            READ(out.text[out.length - 1]);
        }
    }
}
HARNESS(text, LIST)

static void telemeter_status(const uint8_t *data, size_t size) {
    roburoc4_telemeter_status out;
    if (roburoc4_decode_telemeter_status(data, size, &out) >= 0) {
        READ(out.robot_cycles);
        READ(out.service);
        float distances[2];
        if (out.count > 0) { /* Frama-C's memcpy wants a byte even where none is copied */
            READ(roburoc4_floats(out.distances, out.count, distances, 2));
        }
    }
}
HARNESS(telemeter_status, LIST)

/* ---- channels: their counts are the caller's, and as arbitrary as the bytes ---- */

static void iocard_status(const uint8_t *data, size_t size) {
    roburoc4_channels out;
    if (roburoc4_decode_iocard_status(data, size, any_u32(), any_u32(), &out) >= 0) {
        READ(out.robot_cycles);
        READ(out.service + out.analog_count + out.digital_count);
    }
}
HARNESS(iocard_status, LIST)

static void iocard_command(const uint8_t *data, size_t size) {
    roburoc4_channels out;
    if (roburoc4_decode_iocard_command(data, size, any_u32(), any_u32(), &out) >= 0) {
        READ(out.service + out.analog_count + out.digital_count);
    }
}
HARNESS(iocard_command, LIST)

/** Channels are read where Eva takes each count and each length by itself: how many bytes there are
 *  for more channels it does not relate to their number. */
static void iocard_channels(const uint8_t *data, size_t size) {
    const uint32_t analog = Frama_C_unsigned_int_interval(0, 2);
    const uint32_t digital =
        8 * Frama_C_unsigned_int_interval(0, 2) + Frama_C_unsigned_int_interval(0, 1);
    roburoc4_channels status;
    roburoc4_channels command;
    float values[2];
    if (size > 24) {
        return;
    }
    //@ split analog;
    //@ split digital;
    if (roburoc4_decode_iocard_status(data, size, analog, digital, &status) >= 0) {
        if (analog > 0) {
            READ(roburoc4_floats(status.analog, status.analog_count, values, 2));
        }
        if (digital > 0) {
            READ(status.digital[(digital - 1) / 8]);
        }
    }
    if (roburoc4_decode_iocard_command(data, size, analog, digital, &command) >= 0) {
        if (analog > 0) {
            READ(roburoc4_floats(command.analog, command.analog_count, values, 2));
        }
        if (digital > 0) {
            READ(command.digital[(digital - 1) / 8]);
        }
    }
}
HARNESS(iocard_channels, LIST)
