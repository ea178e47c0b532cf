/* SPDX-License-Identifier: MIT
 *
 * Makes texts of unknown origin fit for LCM, whose strings are UTF-8 with a NUL at the end, and
 * reads numbers.
 */
#ifndef ROBUROC4_LCM_TEXT_H
#define ROBUROC4_LCM_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Whether `length` bytes are UTF-8 without a NUL. */
bool text_is_utf8(const uint8_t *text, size_t length);
/* Copy a text into `room` (1 byte or more) with a NUL. It is cut at its first NUL or where room
 * ends, but never within a character. Text that is not UTF-8 is taken for Latin-1. */
void text_copy(char *room, size_t capacity, const uint8_t *text, size_t length);
/* The same text with '?' for each control byte, so that no sender can control the terminal. */
void text_for_terminal(char *room, size_t capacity, const char *text, size_t length);
/* Parse a number of at most `max` at *text and move *text behind it. */
bool text_number(const char **text, uint32_t max, uint32_t *out);

#ifdef __cplusplus
}
#endif

#endif
