/* SPDX-License-Identifier: MIT
 *
 * What bytes_exposed.c lets a C++ test call of src/bytes.h.
 */
#ifndef ROBUROC4_TESTS_BYTES_EXPOSED_H
#define ROBUROC4_TESTS_BYTES_EXPOSED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

uint32_t exposed_narrow_bits(uint64_t bits);
uint64_t exposed_widen_bits(uint32_t bits);
/** Read a number of 1, 2, 4 or 8 bytes and then one byte more; the bytes that are left. *failed:
 *  the number was not all there, and the byte after it failed too. */
size_t exposed_read(const uint8_t *data, size_t size, size_t width, uint64_t *value, bool *failed);
/** Write a number of 1, 2, 4 or 8 bytes; the room that is left. */
size_t exposed_write(uint8_t *buffer, size_t capacity, size_t width, uint64_t value);
/** Read a run of 32-bit words; whether they were all there. */
bool exposed_read_words(const uint8_t *data, size_t size, uint32_t *words, size_t count);

#ifdef __cplusplus
}
#endif

#endif
