/* SPDX-License-Identifier: MIT
 *
 * The channels of a robot and their names.
 */
#ifndef ROBUROC4_LCM_CHANNELS_H
#define ROBUROC4_LCM_CHANNELS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum channel {
    CHANNEL_DIFFERENTIAL,
    CHANNEL_LOCALIZATION,
    CHANNEL_BATTERY,
    CHANNEL_TELEMETER,
    CHANNEL_IOCARD,
    CHANNEL_PROPERTIES,
    CHANNEL_BRIDGE_STATE,
    CHANNEL_BRIDGE_STATISTICS,
    CHANNEL_MOVE_STATUS,
    CHANNEL_DRIVE_CMD, /* these four commands are in the order of enum gate_kind */
    CHANNEL_RELOCALIZE_CMD,
    CHANNEL_OUTPUT_CMD,
    CHANNEL_STOP_CMD,
    CHANNEL_MOVE_CMD, /* to the gate, a GATE_DRIVE */
    CHANNEL_POSE,     /* "" if it is not published */
    CHANNELS
};

/* The longest channel name that LCM allows. */
#define CHANNEL_MAX_NAME 63

typedef struct channel_names {
    char name[CHANNELS][CHANNEL_MAX_NAME + 1];
} channel_names;

/* Prefix followed by "_DIFFERENTIAL" and so on; no pose. Returns false if the prefix makes a name
 * too long. */
bool channels_set_prefix(channel_names *names, const char *prefix);
/* The channel with this key, such as "DRIVE_CMD", of `length` bytes; CHANNELS if there is none. */
enum channel channels_find(const char *key, size_t length);
/* Whether LCM, which treats names as patterns, takes this one literally. */
bool channels_is_name(const char *name);
bool channels_is_command(enum channel channel);

/* All channels of a bridge, sorted by name. */
typedef struct channels_entry {
    const char *name;
    uint32_t which;
} channels_entry;

typedef struct channels_directory {
    channels_entry *entries;
    size_t count;
} channels_directory;

/* Sort the entries once all have been added. Returns a name that occurs twice, or NULL. */
const char *channels_sort(channels_directory *directory);
/* The entry with this name, or NULL. */
const channels_entry *channels_look_up(const channels_directory *directory, const char *name);
/* Whether a name is that of a command channel: it ends in _CMD. */
bool channels_ends_in_cmd(const char *name);

#ifdef __cplusplus
}
#endif

#endif
