/* SPDX-License-Identifier: MIT
 *
 * record_internal.h - what record.c offers udp.c and pump.c. Not public.
 */
#ifndef ROBUROC4_RECORD_INTERNAL_H
#define ROBUROC4_RECORD_INTERNAL_H

#include "roburoc4_record.h"

/** Take a copy of a datagram that was just received, or sent. */
void roburoc4_recorder_take(roburoc4_recorder *recorder, int inbound, const roburoc4_address *from,
                            const roburoc4_address *to, const uint8_t *datagram, size_t size);
/** Write what is left and end the file, in 2 s at most; later datagrams are not taken. 0 where the
 *  disk was not done in that time. */
int roburoc4_recorder_finish(roburoc4_recorder *recorder);

#endif
