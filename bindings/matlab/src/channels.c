/* SPDX-License-Identifier: MIT */
#include "channels.h"

#include <stdio.h>

#include "fail.h"

/* Inputs that the client itself looks for, by their number in the manual's tables. */
static const struct {
    uint32_t io_type, number, role;
} roles[] = {
    {ROBUROC4_IO_ANALOG_INPUT, ROBUROC4_AI_BATTERY_V, ROBUROC4_ROLE_BATTERY_V},
    {ROBUROC4_IO_DIGITAL_INPUT, ROBUROC4_DI_FRONT_BUMPER, ROBUROC4_ROLE_FRONT_BUMPER},
    {ROBUROC4_IO_DIGITAL_INPUT, ROBUROC4_DI_REAR_BUMPER, ROBUROC4_ROLE_REAR_BUMPER},
    {ROBUROC4_IO_DIGITAL_INPUT, ROBUROC4_DI_PAD_A, ROBUROC4_ROLE_OVERRIDE},
};

/* The manual's tables skip number 02; on a card with one channel more they are literal. */
#define FIRST_SHIFTED 2u

static uint32_t manual_count(uint32_t io_type) {
    uint32_t count = 0;
    while (roburoc4_channel_name(io_type, count) != NULL) {
        count++;
    }
    return count;
}

uint32_t channels_count(robot *one, uint32_t io_type) {
    roburoc4_iocard_properties card;
    int32_t counts[4];
    if (robot_iocard_properties(one, &card) < 0) {
        return 0;
    }
    counts[ROBUROC4_IO_ANALOG_INPUT] = card.analog_inputs;
    counts[ROBUROC4_IO_ANALOG_OUTPUT] = card.analog_outputs;
    counts[ROBUROC4_IO_DIGITAL_INPUT] = card.digital_inputs;
    counts[ROBUROC4_IO_DIGITAL_OUTPUT] = card.digital_outputs;
    return counts[io_type] > 0 ? (uint32_t)counts[io_type] : 0;
}

/* Where a channel of the manual is on this card, if the manual's tables are right. */
static uint32_t place_of(robot *one, uint32_t io_type, uint32_t number) {
    const int literal = channels_count(one, io_type) == manual_count(io_type) + 1;
    return literal && number >= FIRST_SHIFTED ? number + 1 : number;
}

static const char *manual_name(robot *one, uint32_t io_type, uint32_t index) {
    uint32_t number = index;
    if (index > 0 && place_of(one, io_type, index - 1) == index) {
        number = index - 1;
    } else if (place_of(one, io_type, index) != index) {
        return "";
    }
    return roburoc4_channel_name(io_type, number) != NULL ? roburoc4_channel_name(io_type, number)
                                                          : "";
}

void channels_name(robot *one, uint32_t io_type, uint32_t index, char out[CHANNEL_NAME]) {
    if (robot_description(one, (int32_t)io_type, index, out, CHANNEL_NAME) < 0) {
        (void)snprintf(out, CHANNEL_NAME, "%s", manual_name(one, io_type, index));
    }
}

static char lower(char letter) {
    return letter >= 'A' && letter <= 'Z' ? (char)(letter - 'A' + 'a') : letter;
}

static int is_same(const char *one, const char *other) {
    while (*one != '\0' && lower(*one) == lower(*other)) {
        one++;
        other++;
    }
    return lower(*one) == lower(*other);
}

/* How many channels of a type the robot itself calls so; *index is the last of them. */
static uint32_t said_by_robot(robot *one, const char *name, uint32_t io_type, uint32_t *index) {
    char text[CHANNEL_NAME];
    uint32_t count = channels_count(one, io_type), found = 0, i;
    for (i = 0; i < count && i < ROBUROC4_MAX_DIGITAL_INPUTS; i++) {
        if (robot_description(one, (int32_t)io_type, i, text, sizeof text) >= 0 &&
            is_same(text, name)) {
            *index = i;
            found++;
        }
    }
    return found;
}

/* The place of the channel that the manual calls so, or -1. */
static int32_t named_by_manual(robot *one, const char *name, uint32_t io_type) {
    uint32_t numbers = manual_count(io_type), number, i, said;
    for (number = 0; number < numbers; number++) {
        if (is_same(roburoc4_channel_name(io_type, number), name)) {
            break;
        }
    }
    if (number == numbers) {
        return -1;
    }
    for (i = 0; i < sizeof roles / sizeof roles[0]; i++) {
        if (roles[i].io_type == io_type && roles[i].number == number &&
            robot_role_index(one, roles[i].role) >= 0) {
            return robot_role_index(one, roles[i].role);
        }
    }
    if (said_by_robot(one, name, io_type, &said) == 1) {
        return (int32_t)said;
    }
    return (int32_t)place_of(one, io_type, number);
}

static int fail_not_found(const char *name, uint32_t found) {
    if (found > 1) {
        return fail(FAIL_ARGUMENT,
                    "'%s' is ambiguous: the robot has %lu channels of this name; "
                    "use io() and an index",
                    name, (unsigned long)found);
    }
    return fail(FAIL_ARGUMENT, "the robot has no such channel '%s': io() lists the names", name);
}

int channels_find(robot *one, const char *name, uint32_t io_types, channel *out) {
    uint32_t found = 0, io_type;
    for (io_type = 0; io_type <= ROBUROC4_IO_DIGITAL_OUTPUT && name[0] != '\0'; io_type++) {
        int32_t manual;
        if ((io_types >> io_type & 1u) == 0) {
            continue;
        }
        manual = named_by_manual(one, name, io_type);
        if (manual >= 0 && (uint32_t)manual < channels_count(one, io_type)) {
            out->io_type = io_type;
            out->index = (uint32_t)manual;
            return 1;
        }
        if (said_by_robot(one, name, io_type, &out->index) > 0) {
            found += said_by_robot(one, name, io_type, &out->index);
            out->io_type = io_type;
        }
    }
    return found == 1 ? 1 : fail_not_found(name, found);
}
