/* SPDX-License-Identifier: MIT
 *
 * Waits for sockets by number: with epoll, whose cost does not grow with their count, or with
 * poll() where there is no epoll.
 */
#ifndef ROBUROC4_LCM_WATCH_H
#define ROBUROC4_LCM_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "options.h"

/* One for LCM and one for each robot. */
#define WATCH_MAX (OPTIONS_MAX_ROBOTS + 1)

/* Returns false if the system has no means to wait. */
bool watch_begin(void);
/* Watch this descriptor for `number` instead of its previous one. -1: none; call this before
 * close(). */
void watch_set(uint32_t number, int fd);
/* Wait until at least one is readable, or for wait_ms. Writes the numbers of the readable ones to
 * ready[WATCH_MAX] and returns how many there are. */
uint32_t watch_wait(int wait_ms, uint32_t *ready);

#endif
