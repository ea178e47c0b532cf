/* SPDX-License-Identifier: MIT
 *
 * types_echo: C's side of the test that C and Python read each other's messages. Without arguments
 * it prints each type and its fingerprint. With the name of a type it decodes the message on stdin,
 * encodes the result to stdout, and exits with 1 if it is not such a message.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "roburoc4_lcm.h"

#define MAX_MESSAGE 65536

#define ALL_TYPES(type)                                                                            \
    type(battery_status_t) type(bridge_state_t) type(bridge_statistics_t)                          \
        type(differential_status_t) type(drive_command_t) type(iocard_status_t)                    \
            type(localization_status_t) type(output_command_t) type(relocalize_command_t)          \
                type(robot_properties_t) type(stop_command_t) type(telemeter_status_t)             \
                    type(telemeter_t)

/* Decode `in` and encode it into `out`; returns the length, or a negative value. */
#define DEFINE_ECHO(name)                                                                          \
    static int echo_##name(const uint8_t *in, int size, uint8_t *out) {                            \
        roburoc4_lcm_##name message;                                                               \
        memset(&message, 0, sizeof message);                                                       \
        if (roburoc4_lcm_##name##_decode(in, 0, size, &message) != size) {                         \
            return -1;                                                                             \
        }                                                                                          \
        int length = roburoc4_lcm_##name##_encode(out, 0, MAX_MESSAGE, &message);                  \
        (void)roburoc4_lcm_##name##_decode_cleanup(&message);                                      \
        return length;                                                                             \
    }
ALL_TYPES(DEFINE_ECHO)

typedef struct known_type {
    const char *name;
    int64_t (*fingerprint)(void);
    int (*echo)(const uint8_t *in, int size, uint8_t *out);
} known_type;

#define TABLE_ROW(name) {#name, __roburoc4_lcm_##name##_get_hash, echo_##name},
static const known_type known_types[] = {ALL_TYPES(TABLE_ROW)};
#define KNOWN_TYPES (sizeof known_types / sizeof known_types[0])

static int print_fingerprints(void) {
    for (size_t index = 0; index < KNOWN_TYPES; index++) {
        (void)printf("%s %016llx\n", known_types[index].name,
                     (unsigned long long)known_types[index].fingerprint());
    }
    return 0;
}

static int echo(const known_type *type) {
    static uint8_t in[MAX_MESSAGE];
    static uint8_t out[MAX_MESSAGE];
    size_t size = fread(in, 1, sizeof in, stdin);
    int length = type->echo(in, (int)size, out);
    if (length < 0) {
        (void)fprintf(stderr, "types_echo: these %zu bytes are no %s\n", size, type->name);
        return 1;
    }
    return fwrite(out, 1, (size_t)length, stdout) == (size_t)length ? 0 : 1;
}

int main(int count, char **arguments) {
    if (count == 1) {
        return print_fingerprints();
    }
    for (size_t index = 0; index < KNOWN_TYPES; index++) {
        if (strcmp(known_types[index].name, arguments[1]) == 0) {
            return echo(&known_types[index]);
        }
    }
    (void)fprintf(stderr, "types_echo: no type '%s'\n", arguments[1]);
    return 2;
}
