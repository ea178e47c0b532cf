/* SPDX-License-Identifier: MIT */
#include "channels.h"

#include <stdlib.h>
#include <string.h>

static const char *const keys[] = {
    "DIFFERENTIAL",   "LOCALIZATION", "BATTERY",           "TELEMETER",   "IOCARD",
    "PROPERTIES",     "BRIDGE_STATE", "BRIDGE_STATISTICS", "MOVE_STATUS", "DRIVE_CMD",
    "RELOCALIZE_CMD", "OUTPUT_CMD",   "STOP_CMD",          "MOVE_CMD",
};

bool channels_set_prefix(channel_names *names, const char *prefix) {
    size_t length = strlen(prefix);
    memset(names, 0, sizeof *names);
    for (size_t at = 0; at < CHANNEL_POSE; at++) {
        if (length + 1 + strlen(keys[at]) > CHANNEL_MAX_NAME) {
            return false;
        }
        memcpy(names->name[at], prefix, length);
        names->name[at][length] = '_';
        memcpy(names->name[at] + length + 1, keys[at], strlen(keys[at]) + 1);
    }
    return true;
}

enum channel channels_find(const char *key, size_t length) {
    size_t at = 0;
    while (at < CHANNEL_POSE &&
           (strlen(keys[at]) != length || memcmp(keys[at], key, length) != 0)) {
        at++;
    }
    return at < CHANNEL_POSE ? (enum channel)at : CHANNELS;
}

bool channels_is_name(const char *name) {
    static const char fit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-/";
    size_t length = strlen(name);
    return length > 0 && length <= CHANNEL_MAX_NAME && strspn(name, fit) == length;
}

bool channels_is_command(enum channel channel) {
    return channel >= CHANNEL_DRIVE_CMD && channel <= CHANNEL_MOVE_CMD;
}

bool channels_ends_in_cmd(const char *name) {
    size_t length = strlen(name);
    return length >= 4 && strcmp(name + length - 4, "_CMD") == 0;
}

static int by_name(const void *one, const void *other) {
    return strcmp(((const channels_entry *)one)->name, ((const channels_entry *)other)->name);
}

const char *channels_sort(channels_directory *directory) {
    qsort(directory->entries, directory->count, sizeof directory->entries[0], by_name);
    for (size_t at = 1; at < directory->count; at++) {
        if (by_name(&directory->entries[at - 1], &directory->entries[at]) == 0) {
            return directory->entries[at].name;
        }
    }
    return NULL;
}

const channels_entry *channels_look_up(const channels_directory *directory, const char *name) {
    channels_entry wanted = {name, 0};
    return bsearch(&wanted, directory->entries, directory->count, sizeof wanted, by_name);
}
