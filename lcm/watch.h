/* SPDX-License-Identifier: MIT
 *
 * Waiting for sockets by number: epoll, whose cost does not grow with their count, or poll() where
 * there is none.
 */
#ifndef ROBUROC4_LCM_WATCH_H
#define ROBUROC4_LCM_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "options.h"

/* LCM, and each robot. */
#define WATCH_MAX (OPTIONS_MAX_ROBOTS + 1)

/* False where the system has none. */
bool watch_begin(void);
/* Watch this descriptor for `number`, instead of its last; -1: none, to be called before close().
 */
void watch_set(uint32_t number, int fd);
/* Wait until one has something to read, or for wait_ms. The numbers of those that have go into
 * ready[WATCH_MAX]; returns how many. */
uint32_t watch_wait(int wait_ms, uint32_t *ready);

#endif
