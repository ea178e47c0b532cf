/* SPDX-License-Identifier: MIT
 *
 * The codec: every telegram of the manual, both directions. Pure functions; see roburoc4_codec.h
 * for their contract. Requests first, then answers, statuses and commands, each as encoder and
 * decoder side by side, in the order of the manual.
 */
#include "roburoc4_codec.h"

#include "bytes.h"

#define HEAD_REQUEST 4
#define HEAD_ANSWER 5
#define HEAD_STATUS 11
#define HEAD_COMMAND 3
#define SIZE_DIRECTORY_ENTRY 4
#define SIZE_SUBSCRIPTION 3
#define SIZE_TELEMETER 28
#define BODY_QUERY_DIRECTORY 2
#define BODY_QUERY_IOCARD 5
#define BODY_INSERT 3
#define BODY_DELETE 2
#define BODY_REPLACE 32
#define BODY_COMMAND 8
#define WORDS_TELEMETER 7
/* The largest payload of a UDP datagram over IPv4, which no telegram exceeds. */
#define SIZE_LIMIT 65507

/* ---- layouts ---- */

/** A telegram of fixed length and its struct: after the head come doubles, 32-bit words and bytes,
 * on the wire as in the struct, and without gaps. */
typedef struct layout {
    uint8_t size, service, body; /* of the struct, and where in it these are */
    uint8_t doubles, words, bytes;
} layout;

#define BODY_OF(doubles, words, bytes) (8 * (doubles) + 4 * (words) + (bytes))
/* `first` of the body, `next` behind it */
#define FIXED_LAYOUT(name, type, first, next, doubles, words, bytes)                               \
    static const layout name = {                                                                   \
        sizeof(type), offsetof(type, service), offsetof(type, first), doubles, words, bytes};      \
    typedef char assert_##name##_has_no_gaps                                                       \
        [offsetof(type, next) - offsetof(type, first) == BODY_OF(doubles, words, bytes) ? 1 : -1]

FIXED_LAYOUT(iocard_properties, roburoc4_iocard_properties, analog_inputs, service, 0, 4, 0);
FIXED_LAYOUT(battery_properties, roburoc4_battery_properties, nominal_voltage_v, reserved, 0, 2, 1);
FIXED_LAYOUT(localization_properties, roburoc4_localization_properties, x_m, service, 3, 1, 0);
FIXED_LAYOUT(differential_properties, roburoc4_differential_properties, target_linear_m_s, service,
             0, 13, 0);
FIXED_LAYOUT(battery_status, roburoc4_battery_status, state, service, 0, 0, 2);
FIXED_LAYOUT(localization_status, roburoc4_localization_status, x_m, service, 3, 1, 0);
FIXED_LAYOUT(differential_status, roburoc4_differential_status, target_linear_m_s, service, 0, 4,
             0);

typedef char assert_telemeter_is_packed[sizeof(roburoc4_telemeter) == SIZE_TELEMETER ? 1 : -1];

CURSOR size_t body_size(const layout *l) {
    return BODY_OF((size_t)l->doubles, (size_t)l->words, (size_t)l->bytes);
}

/** Copy a body from the wire to memory, or back. */
CURSOR void copy_body(uint8_t *to, const uint8_t *from, const layout *l) {
    const size_t words = 8 * (size_t)l->doubles;
    const size_t bytes = words + 4 * (size_t)l->words;
    copy_numbers(to, from, 8, l->doubles);
    copy_numbers(to + words, from + words, 4, l->words);
    copy_numbers(to + bytes, from + bytes, 1, l->bytes);
}

/** Fill a struct whose telegram is long enough; the reader is left at the body. */
CURSOR void read_body(reader *r, const layout *l, uint16_t service, uint8_t *out) {
    memset(out, 0, l->size);
    memcpy(out + l->service, &service, sizeof service);
    copy_body(out + l->body, r->at, l);
}

CURSOR void write_body(writer *w, const layout *l, const uint8_t *in) {
    uint8_t *to = next_bytes(w, body_size(l));
    if (to != NULL) {
        copy_body(to, in + l->body, l);
    }
}

CURSOR uint16_t service_in(const layout *l, const uint8_t *in) {
    uint16_t service;
    memcpy(&service, in + l->service, sizeof service);
    return service;
}

/* ---- beginnings and ends ---- */

/** Whether `count` entries of `entry` bytes after `head` fit into a datagram. */
static bool sendable(size_t head, size_t count, size_t entry) {
    return count <= (SIZE_LIMIT - head) / entry;
}

/** The bytes that will be left after `length` more, or ROBUROC4_ERR_SHORT. */
CURSOR roburoc4_result surplus(const reader *r, size_t length) {
    if (r->left < length) {
        return ROBUROC4_ERR_SHORT;
    }
    const size_t left = r->left - length;
    return left <= INT32_MAX ? (roburoc4_result)left : INT32_MAX;
}

/** Reserve `length` bytes of the buffer, or none if they do not fit. */
CURSOR roburoc4_result claim(writer *w, size_t length) {
    const bool fits = length <= w->left;
    w->left = fits ? length : 0;
    return fits ? (roburoc4_result)length : ROBUROC4_ERR_BUFFER;
}

/** The three doubles of a pose. */
CURSOR void write_pose(writer *w, const roburoc4_request *q) {
    write_numbers(w, (const uint8_t *)q + offsetof(roburoc4_request, x_m), 8, 3);
}

CURSOR void read_pose(reader *r, roburoc4_request *out) {
    const uint8_t *from = read_bytes(r, 24);
    if (from != NULL) {
        copy_numbers((uint8_t *)out + offsetof(roburoc4_request, x_m), from, 8, 3);
    }
}

/* ---- requests ---- */

/** Bytes after the head; 0 for GET and for actions whose layout is not published. */
static size_t request_body(uint8_t action, uint16_t service) {
    switch (action) {
    case ROBUROC4_ACTION_QUERY:
        return service == ROBUROC4_SERVICE_DIRECTORY ? BODY_QUERY_DIRECTORY : BODY_QUERY_IOCARD;
    case ROBUROC4_ACTION_REPLACE:
        return BODY_REPLACE;
    case ROBUROC4_ACTION_INSERT:
        return BODY_INSERT;
    case ROBUROC4_ACTION_DELETE:
        return BODY_DELETE;
    default:
        return 0;
    }
}

/** Whether the fields of a request can be sent. */
static bool request_valid(const roburoc4_request *q) {
    if (q->id == ROBUROC4_HEADER_ERROR || q->id == ROBUROC4_HEADER_STATUS) {
        return false;
    }
    switch (q->action) {
    case ROBUROC4_ACTION_GET:
    case ROBUROC4_ACTION_REPLACE:
    case ROBUROC4_ACTION_DELETE:
        return true;
    case ROBUROC4_ACTION_QUERY:
        return q->service != ROBUROC4_SERVICE_DIRECTORY || (q->index >= 0 && q->index <= 0xFFFF);
    case ROBUROC4_ACTION_INSERT:
        return q->period_cycles != 0;
    default:
        return false;
    }
}

roburoc4_result roburoc4_encode_request(uint8_t *buffer, size_t capacity,
                                        const roburoc4_request *request) {
    const roburoc4_request *q = request;
    writer w = writer_of(buffer, capacity);
    if (!request_valid(q)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    const roburoc4_result result = claim(&w, HEAD_REQUEST + request_body(q->action, q->service));
    write_u8(&w, q->id);
    write_u8(&w, q->action);
    write_u16(&w, q->service);
    switch (q->action) {
    case ROBUROC4_ACTION_QUERY:
        if (q->service == ROBUROC4_SERVICE_DIRECTORY) {
            write_u16(&w, (uint16_t)q->index);
        } else {
            write_u8(&w, q->io_type);
            write_u32(&w, (uint32_t)q->index);
        }
        break;
    case ROBUROC4_ACTION_REPLACE:
        write_u64(&w, q->timestamp);
        write_pose(&w, q);
        break;
    case ROBUROC4_ACTION_INSERT:
        write_u16(&w, q->subject);
        write_u8(&w, q->period_cycles);
        break;
    case ROBUROC4_ACTION_DELETE:
        write_u16(&w, q->subject);
        break;
    default: /* GET */
        break;
    }
    return result;
}

static void read_request_body(reader *r, roburoc4_request *out) {
    switch (out->action) {
    case ROBUROC4_ACTION_QUERY:
        if (out->service == ROBUROC4_SERVICE_DIRECTORY) {
            out->index = read_u16(r);
        } else {
            out->io_type = read_u8(r);
            out->index = i32_from_bits(read_u32(r));
        }
        break;
    case ROBUROC4_ACTION_REPLACE:
        out->timestamp = read_u64(r);
        read_pose(r, out);
        break;
    case ROBUROC4_ACTION_INSERT:
        out->subject = read_u16(r);
        out->period_cycles = read_u8(r);
        break;
    case ROBUROC4_ACTION_DELETE:
        out->subject = read_u16(r);
        break;
    default:
        break;
    }
}

roburoc4_result roburoc4_decode_request(const uint8_t *data, size_t size, roburoc4_request *out) {
    reader r = reader_of(data, size);
    const uint8_t id = read_u8(&r);
    const uint8_t action = read_u8(&r);
    const uint16_t service = read_u16(&r);
    const roburoc4_result result =
        r.failed ? ROBUROC4_ERR_SHORT : surplus(&r, request_body(action, service));
    if (!r.failed && (id == ROBUROC4_HEADER_ERROR || id == ROBUROC4_HEADER_STATUS)) {
        return ROBUROC4_ERR_KIND;
    }
    if (result < 0) {
        return result;
    }
    memset(out, 0, sizeof *out);
    out->id = id;
    out->action = action;
    out->service = service;
    read_request_body(&r, out);
    return result;
}

/* ---- answers ---- */

static roburoc4_result write_answer_head(writer *w, size_t body, uint8_t id, uint8_t action,
                                         uint16_t service, uint8_t error) {
    if (id == ROBUROC4_HEADER_STATUS) {
        w->left = 0;
        return ROBUROC4_ERR_ARGUMENT;
    }
    const roburoc4_result result = claim(w, HEAD_ANSWER + body);
    write_u8(w, id);
    write_u8(w, action);
    write_u16(w, service);
    write_u8(w, error);
    return result;
}

/** Check the head of a good answer to `action` and that `body` bytes follow it; the reader is left
 *  at the service, for read_answer_service(). */
static roburoc4_result read_answer_head(reader *r, uint8_t action, size_t body) {
    if (r->left < HEAD_ANSWER) {
        return ROBUROC4_ERR_SHORT;
    }
    const uint8_t error = r->at[4];
    const uint8_t id = read_u8(r);
    if (read_u8(r) != action || id == ROBUROC4_HEADER_STATUS) {
        return ROBUROC4_ERR_KIND;
    }
    if (id == ROBUROC4_HEADER_ERROR || error != ROBUROC4_ERROR_NONE) {
        return ROBUROC4_ERR_ROBOT;
    }
    return surplus(r, HEAD_ANSWER - 2 + body);
}

static uint16_t read_answer_service(reader *r) {
    const uint16_t service = read_u16(r);
    read_u8(r); /* the error byte, already known to be 0 */
    return service;
}

/** Properties of fixed length. */
CURSOR roburoc4_result decode_fixed_properties(const uint8_t *data, size_t size, const layout *l,
                                               void *out) {
    reader r = reader_of(data, size);
    const roburoc4_result result = read_answer_head(&r, ROBUROC4_ACTION_GET, body_size(l));
    if (result >= 0) {
        read_body(&r, l, read_answer_service(&r), out);
    }
    return result;
}

CURSOR roburoc4_result encode_fixed_properties(uint8_t *buffer, size_t capacity, uint8_t id,
                                               const layout *l, const void *properties) {
    writer w = writer_of(buffer, capacity);
    const roburoc4_result result =
        write_answer_head(&w, body_size(l), id, ROBUROC4_ACTION_GET, service_in(l, properties), 0);
    write_body(&w, l, properties);
    return result;
}

roburoc4_result roburoc4_decode_answer(const uint8_t *data, size_t size, roburoc4_answer *out) {
    reader r = reader_of(data, size);
    if (size < HEAD_ANSWER) {
        return ROBUROC4_ERR_SHORT;
    }
    if (data[0] == ROBUROC4_HEADER_STATUS) {
        return ROBUROC4_ERR_KIND;
    }
    memset(out, 0, sizeof *out);
    out->id = read_u8(&r);
    out->action = read_u8(&r);
    out->service = read_u16(&r);
    out->error = read_u8(&r);
    out->payload = r.at;
    out->payload_size = r.left;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_encode_answer(uint8_t *buffer, size_t capacity, uint8_t id, uint8_t action,
                                       uint16_t service, uint8_t error) {
    writer w = writer_of(buffer, capacity);
    return write_answer_head(&w, 0, id, action, service, error);
}

roburoc4_result roburoc4_decode_directory(const uint8_t *data, size_t size,
                                          roburoc4_directory *out) {
    reader r = reader_of(data, size);
    const roburoc4_result result = read_answer_head(&r, ROBUROC4_ACTION_GET, 0);
    if (result < 0) {
        return result;
    }
    out->service = read_answer_service(&r);
    out->reserved = 0;
    out->entries = r.at;
    out->count = (uint32_t)(r.left / SIZE_DIRECTORY_ENTRY);
    return (roburoc4_result)(r.left % SIZE_DIRECTORY_ENTRY);
}

roburoc4_result roburoc4_directory_at(const roburoc4_directory *directory, uint32_t index,
                                      roburoc4_directory_entry *out) {
    if (index >= directory->count) {
        return ROBUROC4_ERR_INDEX;
    }
    const uint8_t *entry = directory->entries + (size_t)index * SIZE_DIRECTORY_ENTRY;
    out->type = load_u16(entry);
    out->id = load_u16(entry + 2);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_encode_directory(uint8_t *buffer, size_t capacity, uint8_t id,
                                          uint16_t service, const roburoc4_directory_entry *entries,
                                          size_t count) {
    if (!sendable(HEAD_ANSWER, count, SIZE_DIRECTORY_ENTRY)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    writer w = writer_of(buffer, capacity);
    const roburoc4_result result =
        write_answer_head(&w, count * SIZE_DIRECTORY_ENTRY, id, ROBUROC4_ACTION_GET, service, 0);
    for (size_t i = 0; i < count; i++) {
        write_u16(&w, entries[i].type);
        write_u16(&w, entries[i].id);
    }
    return result;
}

roburoc4_result roburoc4_decode_notification(const uint8_t *data, size_t size,
                                             roburoc4_notification *out) {
    reader r = reader_of(data, size);
    const roburoc4_result result = read_answer_head(&r, ROBUROC4_ACTION_GET, 0);
    if (result < 0) {
        return result;
    }
    out->service = read_answer_service(&r);
    out->reserved = 0;
    out->entries = r.at;
    out->count = (uint32_t)(r.left / SIZE_SUBSCRIPTION);
    return (roburoc4_result)(r.left % SIZE_SUBSCRIPTION);
}

roburoc4_result roburoc4_notification_at(const roburoc4_notification *notification, uint32_t index,
                                         roburoc4_subscription *out) {
    if (index >= notification->count) {
        return ROBUROC4_ERR_INDEX;
    }
    const uint8_t *entry = notification->entries + (size_t)index * SIZE_SUBSCRIPTION;
    out->service = load_u16(entry);
    out->period_cycles = entry[2];
    out->reserved = 0;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_encode_notification(uint8_t *buffer, size_t capacity, uint8_t id,
                                             uint16_t service, const roburoc4_subscription *entries,
                                             size_t count) {
    if (!sendable(HEAD_ANSWER, count, SIZE_SUBSCRIPTION)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    writer w = writer_of(buffer, capacity);
    const roburoc4_result result =
        write_answer_head(&w, count * SIZE_SUBSCRIPTION, id, ROBUROC4_ACTION_GET, service, 0);
    for (size_t i = 0; i < count; i++) {
        write_u16(&w, entries[i].service);
        write_u8(&w, entries[i].period_cycles);
    }
    return result;
}

/* The number of 8-bit blocks for this many digital channels (4.2.4.4). */
static uint32_t digital_blocks(uint32_t channels) {
    return channels / 8 + (channels % 8 != 0);
}

roburoc4_result roburoc4_decode_iocard_properties(const uint8_t *data, size_t size,
                                                  roburoc4_iocard_properties *out) {
    roburoc4_iocard_properties p;
    const roburoc4_result result = decode_fixed_properties(data, size, &iocard_properties, &p);
    if (result < 0) {
        return result;
    }
    if ((p.analog_inputs | p.analog_outputs | p.digital_inputs | p.digital_outputs) < 0) {
        return ROBUROC4_ERR_VALUE;
    }
    *out = p;
    return result;
}

roburoc4_result roburoc4_encode_iocard_properties(uint8_t *buffer, size_t capacity, uint8_t id,
                                                  const roburoc4_iocard_properties *properties) {
    return encode_fixed_properties(buffer, capacity, id, &iocard_properties, properties);
}

/** How many telemeters fit into the rest of a datagram. Dividing is a large function on small
 * machines; this is exact. */
static uint32_t telemeters_in(size_t bytes) {
    const uint32_t words = (uint32_t)(bytes < SIZE_LIMIT ? bytes : SIZE_LIMIT) / 4;
    return words * UINT32_C(149797) >> 20; /* a seventh */
}

roburoc4_result roburoc4_decode_telemeter_properties(const uint8_t *data, size_t size,
                                                     roburoc4_telemeter_list *out) {
    reader r = reader_of(data, size);
    const roburoc4_result result = read_answer_head(&r, ROBUROC4_ACTION_GET, 4);
    if (result < 0) {
        return result;
    }
    const uint16_t service = read_answer_service(&r);
    const uint32_t count = read_u32(&r);
    if (count > INT32_MAX) {
        return ROBUROC4_ERR_VALUE;
    }
    if (count > telemeters_in(r.left)) {
        return ROBUROC4_ERR_SHORT;
    }
    out->entries = r.at;
    out->count = count;
    out->service = service;
    out->reserved = 0;
    return surplus(&r, (size_t)count * SIZE_TELEMETER);
}

roburoc4_result roburoc4_telemeter_at(const roburoc4_telemeter_list *telemeters, uint32_t index,
                                      roburoc4_telemeter *out) {
    if (index >= telemeters->count) {
        return ROBUROC4_ERR_INDEX;
    }
    copy_numbers((uint8_t *)out, telemeters->entries + (size_t)index * SIZE_TELEMETER, 4,
                 WORDS_TELEMETER);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_encode_telemeter_properties(uint8_t *buffer, size_t capacity, uint8_t id,
                                                     uint16_t service,
                                                     const roburoc4_telemeter *telemeters,
                                                     size_t count) {
    if (!sendable(HEAD_ANSWER + 4, count, SIZE_TELEMETER)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    writer w = writer_of(buffer, capacity);
    const roburoc4_result result =
        write_answer_head(&w, 4 + count * SIZE_TELEMETER, id, ROBUROC4_ACTION_GET, service, 0);
    write_u32(&w, (uint32_t)count);
    write_numbers(&w, telemeters, 4, count * WORDS_TELEMETER);
    return result;
}

roburoc4_result roburoc4_decode_battery_properties(const uint8_t *data, size_t size,
                                                   roburoc4_battery_properties *out) {
    return decode_fixed_properties(data, size, &battery_properties, out);
}

roburoc4_result roburoc4_encode_battery_properties(uint8_t *buffer, size_t capacity, uint8_t id,
                                                   const roburoc4_battery_properties *properties) {
    return encode_fixed_properties(buffer, capacity, id, &battery_properties, properties);
}

roburoc4_result roburoc4_decode_localization_properties(const uint8_t *data, size_t size,
                                                        roburoc4_localization_properties *out) {
    return decode_fixed_properties(data, size, &localization_properties, out);
}

roburoc4_result
roburoc4_encode_localization_properties(uint8_t *buffer, size_t capacity, uint8_t id,
                                        const roburoc4_localization_properties *properties) {
    return encode_fixed_properties(buffer, capacity, id, &localization_properties, properties);
}

roburoc4_result roburoc4_decode_differential_properties(const uint8_t *data, size_t size,
                                                        roburoc4_differential_properties *out) {
    return decode_fixed_properties(data, size, &differential_properties, out);
}

roburoc4_result
roburoc4_encode_differential_properties(uint8_t *buffer, size_t capacity, uint8_t id,
                                        const roburoc4_differential_properties *properties) {
    return encode_fixed_properties(buffer, capacity, id, &differential_properties, properties);
}

roburoc4_result roburoc4_decode_text(const uint8_t *data, size_t size, roburoc4_text *out) {
    reader r = reader_of(data, size);
    const roburoc4_result result = read_answer_head(&r, ROBUROC4_ACTION_QUERY, 0);
    if (result < 0) {
        return result;
    }
    out->service = read_answer_service(&r);
    out->reserved = 0;
    out->text = r.at;
    out->length = (uint32_t)r.left;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_encode_text(uint8_t *buffer, size_t capacity, uint8_t id, uint16_t service,
                                     const char *text, size_t length) {
    if (!sendable(HEAD_ANSWER, length, 1)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    writer w = writer_of(buffer, capacity);
    const roburoc4_result result =
        write_answer_head(&w, length, id, ROBUROC4_ACTION_QUERY, service, 0);
    write_bytes(&w, (const uint8_t *)text, length);
    return result;
}

/* ---- statuses and commands ---- */

CURSOR roburoc4_result write_status_head(writer *w, size_t body, uint16_t service,
                                         uint64_t robot_cycles) {
    const roburoc4_result result = claim(w, HEAD_STATUS + body);
    write_u8(w, ROBUROC4_HEADER_STATUS);
    write_u16(w, service);
    write_u64(w, robot_cycles);
    return result;
}

CURSOR roburoc4_result write_command_head(writer *w, size_t body, uint16_t service) {
    const roburoc4_result result = claim(w, HEAD_COMMAND + body);
    write_u8(w, ROBUROC4_HEADER_STATUS);
    write_u16(w, service);
    return result;
}

/** Check the header of a status or command and its whole length; the reader is left at the
 *  service. */
CURSOR roburoc4_result read_status_header(reader *r, size_t length) {
    if (r->left < length) {
        return ROBUROC4_ERR_SHORT;
    }
    if (read_u8(r) != ROBUROC4_HEADER_STATUS) {
        return ROBUROC4_ERR_KIND;
    }
    return surplus(r, length - 1);
}

/** A status of fixed length. Its struct begins with the time. */
CURSOR roburoc4_result decode_fixed_status(const uint8_t *data, size_t size, const layout *l,
                                           void *out) {
    reader r = reader_of(data, size);
    const roburoc4_result result = read_status_header(&r, HEAD_STATUS + body_size(l));
    if (result >= 0) {
        const uint16_t service = read_u16(&r);
        const uint64_t robot_cycles = read_u64(&r);
        read_body(&r, l, service, out);
        memcpy(out, &robot_cycles, sizeof robot_cycles);
    }
    return result;
}

CURSOR roburoc4_result encode_fixed_status(uint8_t *buffer, size_t capacity, const layout *l,
                                           const void *status) {
    uint64_t robot_cycles;
    writer w = writer_of(buffer, capacity);
    memcpy(&robot_cycles, status, sizeof robot_cycles);
    const roburoc4_result result =
        write_status_head(&w, body_size(l), service_in(l, status), robot_cycles);
    write_body(&w, l, status);
    return result;
}

roburoc4_result roburoc4_decode_status_header(const uint8_t *data, size_t size,
                                              roburoc4_status_header *out) {
    reader r = reader_of(data, size);
    const roburoc4_result result = read_status_header(&r, HEAD_STATUS);
    if (result >= 0) {
        memset(out, 0, sizeof *out);
        out->service = read_u16(&r);
        out->robot_cycles = read_u64(&r);
    }
    return result;
}

/** Read `analog` floats and the blocks of `digital` bits; the reader is behind the head. */
CURSOR roburoc4_result read_channels(reader *r, uint32_t analog, uint32_t digital, uint16_t service,
                                     uint64_t robot_cycles, roburoc4_channels *out) {
    const uint64_t length = ((uint64_t)analog * 32 + digital + 7) / 8; /* whole bytes */
    if (length > r->left) {
        return ROBUROC4_ERR_SHORT;
    }
    out->robot_cycles = robot_cycles;
    out->analog = r->at;
    out->digital = r->at + (size_t)analog * 4;
    out->analog_count = analog;
    out->digital_count = digital;
    out->service = service;
    memset(out->reserved, 0, sizeof out->reserved);
    return surplus(r, (size_t)length);
}

uint32_t roburoc4_floats(const uint8_t *view, uint32_t count, float *out, uint32_t capacity) {
    const uint32_t copied = count < capacity ? count : capacity;
    copy_numbers((uint8_t *)out, view, 4, copied);
    return copied;
}

/** Whether these channels fit into a datagram after a head; stores their length in *body. */
static bool channels_sendable(size_t analog, size_t digital, size_t *body) {
    const size_t blocks = digital / 8 + (digital % 8 != 0);
    *body = analog * 4 + blocks;
    return sendable(HEAD_STATUS, analog, 4) && sendable(HEAD_STATUS + analog * 4, blocks, 1);
}

roburoc4_result roburoc4_decode_iocard_status(const uint8_t *data, size_t size,
                                              uint32_t analog_inputs, uint32_t digital_inputs,
                                              roburoc4_channels *out) {
    reader r = reader_of(data, size);
    const roburoc4_result result = read_status_header(&r, HEAD_STATUS);
    if (result < 0) {
        return result;
    }
    const uint16_t service = read_u16(&r);
    const uint64_t robot_cycles = read_u64(&r);
    return read_channels(&r, analog_inputs, digital_inputs, service, robot_cycles, out);
}

roburoc4_result roburoc4_encode_iocard_status(uint8_t *buffer, size_t capacity, uint16_t service,
                                              uint64_t robot_cycles, const float *analog,
                                              size_t analog_inputs, const uint8_t *digital,
                                              size_t digital_inputs) {
    size_t body;
    if (!channels_sendable(analog_inputs, digital_inputs, &body)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    writer w = writer_of(buffer, capacity);
    const roburoc4_result result = write_status_head(&w, body, service, robot_cycles);
    write_numbers(&w, analog, 4, analog_inputs);
    write_bytes(&w, digital, digital_blocks((uint32_t)digital_inputs));
    return result;
}

roburoc4_result roburoc4_decode_telemeter_status(const uint8_t *data, size_t size,
                                                 roburoc4_telemeter_status *out) {
    reader r = reader_of(data, size);
    const roburoc4_result result = read_status_header(&r, HEAD_STATUS);
    if (result < 0) {
        return result;
    }
    memset(out, 0, sizeof *out);
    out->service = read_u16(&r);
    out->robot_cycles = read_u64(&r);
    out->distances = r.at;
    out->count = (uint32_t)(r.left / 4);
    return (roburoc4_result)(r.left % 4);
}

roburoc4_result roburoc4_encode_telemeter_status(uint8_t *buffer, size_t capacity, uint16_t service,
                                                 uint64_t robot_cycles, const float *distances_m,
                                                 size_t count) {
    if (!sendable(HEAD_STATUS, count, 4)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    writer w = writer_of(buffer, capacity);
    const roburoc4_result result = write_status_head(&w, count * 4, service, robot_cycles);
    write_numbers(&w, distances_m, 4, count);
    return result;
}

roburoc4_result roburoc4_decode_battery_status(const uint8_t *data, size_t size,
                                               roburoc4_battery_status *out) {
    return decode_fixed_status(data, size, &battery_status, out);
}

roburoc4_result roburoc4_encode_battery_status(uint8_t *buffer, size_t capacity,
                                               const roburoc4_battery_status *status) {
    return encode_fixed_status(buffer, capacity, &battery_status, status);
}

roburoc4_result roburoc4_decode_localization_status(const uint8_t *data, size_t size,
                                                    roburoc4_localization_status *out) {
    return decode_fixed_status(data, size, &localization_status, out);
}

roburoc4_result roburoc4_encode_localization_status(uint8_t *buffer, size_t capacity,
                                                    const roburoc4_localization_status *status) {
    return encode_fixed_status(buffer, capacity, &localization_status, status);
}

roburoc4_result roburoc4_decode_differential_status(const uint8_t *data, size_t size,
                                                    roburoc4_differential_status *out) {
    return decode_fixed_status(data, size, &differential_status, out);
}

roburoc4_result roburoc4_encode_differential_status(uint8_t *buffer, size_t capacity,
                                                    const roburoc4_differential_status *status) {
    return encode_fixed_status(buffer, capacity, &differential_status, status);
}

roburoc4_result roburoc4_decode_differential_command(const uint8_t *data, size_t size,
                                                     roburoc4_differential_command *out) {
    reader r = reader_of(data, size);
    const roburoc4_result result = read_status_header(&r, HEAD_COMMAND + BODY_COMMAND);
    if (result >= 0) {
        memset(out, 0, sizeof *out);
        out->service = read_u16(&r);
        out->linear_m_s = read_f32(&r);
        out->angular_rad_s = read_f32(&r);
    }
    return result;
}

roburoc4_result roburoc4_encode_differential_command(uint8_t *buffer, size_t capacity,
                                                     uint16_t service, float linear_m_s,
                                                     float angular_rad_s) {
    writer w = writer_of(buffer, capacity);
    const roburoc4_result result = write_command_head(&w, BODY_COMMAND, service);
    write_f32(&w, linear_m_s);
    write_f32(&w, angular_rad_s);
    return result;
}

roburoc4_result roburoc4_decode_iocard_command(const uint8_t *data, size_t size,
                                               uint32_t analog_outputs, uint32_t digital_outputs,
                                               roburoc4_channels *out) {
    reader r = reader_of(data, size);
    const roburoc4_result result = read_status_header(&r, HEAD_COMMAND);
    if (result < 0) {
        return result;
    }
    const uint16_t service = read_u16(&r);
    return read_channels(&r, analog_outputs, digital_outputs, service, 0, out);
}

roburoc4_result roburoc4_encode_iocard_command(uint8_t *buffer, size_t capacity, uint16_t service,
                                               const float *analog, size_t analog_outputs,
                                               const uint8_t *digital, size_t digital_outputs) {
    size_t body;
    if (!channels_sendable(analog_outputs, digital_outputs, &body)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    writer w = writer_of(buffer, capacity);
    const roburoc4_result result = write_command_head(&w, body, service);
    write_numbers(&w, analog, 4, analog_outputs);
    write_bytes(&w, digital, digital_blocks((uint32_t)digital_outputs));
    return result;
}
