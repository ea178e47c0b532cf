/* SPDX-License-Identifier: MIT
 *
 * A filter in front of LCM's receiving socket, for libraries before 1.5.
 */
#ifndef ROBUROC4_LCM_FILTER_H
#define ROBUROC4_LCM_FILTER_H

#include <stdbool.h>
#include <stdint.h>

/* Let the system drop the fragments that crash LCM before 1.5: those whose offset, added to their
 * size, wraps around, so that LCM writes outside of its buffer. port: of the LCM network. Call it
 * when LCM has its socket and no other socket is open. False where the system has no such filter.
 */
bool filter_fragments(uint16_t port);

#endif
