/* SPDX-License-Identifier: MIT
 *
 * For Frama-C's Eva: every encoder, with any values and any capacity to ROOM, returns the length
 * that the manual gives and writes exactly that many bytes: those before are set, those after are
 * untouched; or none, with an error, which it returns whenever they do not fit. Lists have up to 2
 * elements. tests/verify/proof/run analyses each main_* below; none is ever run.
 */
#include "roburoc4.h"

#include <__fc_builtin.h>

#define ROOM 80

static uint32_t up_to(uint32_t most) {
    return Frama_C_unsigned_int_interval(0, most);
}

static uint8_t any_u8(void) {
    return (uint8_t)up_to(UINT8_MAX);
}

static uint16_t any_u16(void) {
    return (uint16_t)up_to(UINT16_MAX);
}

static uint64_t any_u64(void) {
    return Frama_C_unsigned_long_long_interval(0, UINT64_MAX);
}

/* `buffer` is a local that nothing has set: what is set afterwards, the encoder wrote. */
#define HARNESS(name, prepare, size, call)                                                         \
    void main_##name(void) {                                                                       \
        uint8_t buffer[ROOM];                                                                      \
        roburoc4_result length;                                                                    \
        uint32_t room = up_to(2);                                                                  \
        prepare;                                                                                   \
        /*@ split room; */                                                                         \
        (void)0;                                                                                   \
        const size_t full = size;                                                                  \
        const size_t capacity = room == 0   ? up_to((uint32_t)full - 1)                            \
                                : room == 1 ? full                                                 \
                                            : full + 1 + up_to(ROOM - 1 - (uint32_t)full);         \
        length = call;                                                                             \
        /*@ assert all_or_nothing: length < 0 || (room > 0 && length == full); */                  \
        for (size_t i = 0; i < ROOM; i++) {                                                        \
            if (length >= 0 && i < full) {                                                         \
                /*@ assert set: \initialized(&buffer[i]); */                                       \
            } else {                                                                               \
                /*@ assert untouched: !\initialized(&buffer[i]); */                                \
            }                                                                                      \
        }                                                                                          \
    }

#define ANY(type, variable)                                                                        \
    type variable;                                                                                 \
    Frama_C_make_unknown((char *)&variable, sizeof variable)

#define TWO(type, variable)                                                                        \
    size_t count = up_to(2);                                                                       \
    type variable[2];                                                                              \
    Frama_C_make_unknown((char *)variable, sizeof variable);                                       \
    /*@ split count; */ (void)0

typedef double three_doubles[3];
typedef float two_floats[2];

#define TO buffer, capacity
#define NOTHING (void)0

#define REQUEST(what, of)                                                                          \
    ANY(roburoc4_request, any);                                                                    \
    any.action = (what);                                                                           \
    any.service = (of)
#define ENCODED roburoc4_encode_request(TO, &any)
HARNESS(request_get, REQUEST(ROBUROC4_ACTION_GET, any_u16()), 4U, ENCODED)
HARNESS(request_query_directory, REQUEST(ROBUROC4_ACTION_QUERY, 0), 6U, ENCODED)
HARNESS(request_query_channel, REQUEST(ROBUROC4_ACTION_QUERY, 2), 9U, ENCODED)
HARNESS(request_insert, REQUEST(ROBUROC4_ACTION_INSERT, 1), 7U, ENCODED)
HARNESS(request_delete, REQUEST(ROBUROC4_ACTION_DELETE, 1), 6U, ENCODED)
HARNESS(request_replace, REQUEST(ROBUROC4_ACTION_REPLACE, any_u16()), 36U, ENCODED)
HARNESS(answer, NOTHING, 5U, roburoc4_encode_answer(TO, any_u8(), any_u8(), any_u16(), any_u8()))
HARNESS(directory, TWO(roburoc4_directory_entry, any), 5U + 4U * count,
        roburoc4_encode_directory(TO, any_u8(), any_u16(), any, count))
HARNESS(notification, TWO(roburoc4_subscription, any), 5U + 3U * count,
        roburoc4_encode_notification(TO, any_u8(), any_u16(), any, count))
HARNESS(iocard_properties, ANY(roburoc4_iocard_properties, any), 21U,
        roburoc4_encode_iocard_properties(TO, any_u8(), &any))
HARNESS(telemeter_properties, TWO(roburoc4_telemeter, any), 9U + 28U * count,
        roburoc4_encode_telemeter_properties(TO, any_u8(), any_u16(), any, count))
HARNESS(battery_properties, ANY(roburoc4_battery_properties, any), 14U,
        roburoc4_encode_battery_properties(TO, any_u8(), &any))
HARNESS(localization_properties, ANY(roburoc4_localization_properties, any), 33U,
        roburoc4_encode_localization_properties(TO, any_u8(), &any))
HARNESS(differential_properties, ANY(roburoc4_differential_properties, any), 57U,
        roburoc4_encode_differential_properties(TO, any_u8(), &any))
HARNESS(text, TWO(char, any), 5U + count, roburoc4_encode_text(TO, any_u8(), any_u16(), any, count))
HARNESS(telemeter_status, TWO(float, any), 11U + 4U * count,
        roburoc4_encode_telemeter_status(TO, any_u16(), any_u64(), any, count))
HARNESS(battery_status, ANY(roburoc4_battery_status, any), 13U,
        roburoc4_encode_battery_status(TO, &any))
HARNESS(localization_status, ANY(roburoc4_localization_status, any), 39U,
        roburoc4_encode_localization_status(TO, &any))
HARNESS(differential_status, ANY(roburoc4_differential_status, any), 27U,
        roburoc4_encode_differential_status(TO, &any))
HARNESS(differential_command, ANY(two_floats, any), 11U,
        roburoc4_encode_differential_command(TO, any_u16(), any[0], any[1]))

/* Channels: 0 to 2 analog, and a digital one in each of 0 to 2 blocks. */
#define CHANNELS                                                                                   \
    TWO(float, any);                                                                               \
    const uint8_t bits[2] = {any_u8(), any_u8()};                                                  \
    size_t blocks = up_to(2);                                                                      \
    /*@ split blocks; */ (void)0

HARNESS(iocard_status, CHANNELS, 11U + 4U * count + blocks,
        roburoc4_encode_iocard_status(TO, any_u16(), any_u64(), any, count, bits,
                                      8 * blocks - (blocks > 0)))
HARNESS(iocard_command, CHANNELS, 3U + 4U * count + blocks,
        roburoc4_encode_iocard_command(TO, any_u16(), any, count, bits, 8 * blocks - (blocks > 0)))
