/* SPDX-License-Identifier: MIT
 *
 * The cursors and conversions of src/bytes.h, which are all inline, as functions for a test.
 */
#include "bytes_exposed.h"

#include "bytes.h"

uint32_t exposed_narrow_bits(uint64_t bits) {
    return narrow_bits(bits);
}

uint64_t exposed_widen_bits(uint32_t bits) {
    return widen_bits(bits);
}

size_t exposed_read(const uint8_t *data, size_t size, size_t width, uint64_t *value, bool *failed) {
    reader r = reader_of(data, size);
    switch (width) {
    case 1:
        *value = read_u8(&r);
        break;
    case 2:
        *value = read_u16(&r);
        break;
    case 4:
        *value = read_u32(&r);
        break;
    default:
        *value = read_u64(&r);
        break;
    }
    *failed = r.failed;
    read_u8(&r); /* what comes after a failure fails, even where a byte is left */
    *failed = *failed && r.failed;
    return r.left;
}

size_t exposed_write(uint8_t *buffer, size_t capacity, size_t width, uint64_t value) {
    writer w = writer_of(buffer, capacity);
    switch (width) {
    case 1:
        write_u8(&w, (uint8_t)value);
        break;
    case 2:
        write_u16(&w, (uint16_t)value);
        break;
    case 4:
        write_u32(&w, (uint32_t)value);
        break;
    default:
        write_u64(&w, value);
        break;
    }
    return w.left;
}

bool exposed_read_words(const uint8_t *data, size_t size, uint32_t *words, size_t count) {
    reader r = reader_of(data, size);
    read_words(&r, words, count);
    return !r.failed;
}
