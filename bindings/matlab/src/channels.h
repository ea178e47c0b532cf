/* SPDX-License-Identifier: MIT
 *
 * channels.h - channels of the IO card by name: the manual's (5.5.1), wherever this robot has the
 * channel, and the robot's own where it is unique. Upper and lower case are the same.
 */
#ifndef ROBUROC4_MEX_CHANNELS_H
#define ROBUROC4_MEX_CHANNELS_H

#include "robot.h"

#define CHANNEL_NAME 64

/** Bits of a set of channel types, ROBUROC4_IO_*. */
#define CHANNEL_INPUTS ((1u << ROBUROC4_IO_ANALOG_INPUT) | (1u << ROBUROC4_IO_DIGITAL_INPUT))

typedef struct channel {
    uint32_t io_type, index;
} channel;

/** How many channels of a type the card has; 0 before it is known. */
uint32_t channels_count(robot *one, uint32_t io_type);
/** The robot's own text for a channel, else the manual's; possibly empty. */
void channels_name(robot *one, uint32_t io_type, uint32_t index, char out[CHANNEL_NAME]);
/** The channel with this name among these types. 0 after noting what is wrong with it. */
int channels_find(robot *one, const char *name, uint32_t io_types, channel *out);

#endif
