/* SPDX-License-Identifier: MIT
 *
 * Little-endian byte cursors with a sticky failure, checked once at the end.
 *
 * A reader that runs out gives zeros from then on; a writer that runs out writes nothing more. The
 * codec asks for a telegram's whole length before the first byte, so that it is all or nothing; the
 * cursors' own checks are what keeps memory safe whatever the codec asks for. No cast of bytes to a
 * struct, no assumption on the host's byte order or alignment.
 */
#ifndef ROBUROC4_BYTES_H
#define ROBUROC4_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Unless optimised for size the cursors are inlined: the compiler then sees that the length claimed
 * first suffices, and drops the checks of each field. */
#if defined(__GNUC__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__)
#define CURSOR static inline __attribute__((always_inline))
#else
#define CURSOR static inline
#endif

/** Whether a struct that begins with its size is from a program of this or an older version; the
 * size says which of its members that program knows. */
static inline bool size_known(size_t size, size_t newest) {
    return size >= 2 * sizeof(uint32_t) && size <= newest && size % 4 == 0;
}

/* Assumptions: IEEE floats of these sizes; int may have only 16 bits. */
typedef char assert_floats_are_ieee[sizeof(float) == 4 && sizeof(double) == 8 ? 1 : -1];

typedef struct reader {
    const uint8_t *at;
    size_t left;
    bool failed;
} reader;

CURSOR reader reader_of(const uint8_t *data, size_t size) {
    reader r = {data, size, false};
    return r;
}

/** The next `count` bytes, or NULL if there are fewer. */
CURSOR const uint8_t *read_bytes(reader *r, size_t count) {
    const uint8_t *bytes = r->at;
    if (r->failed || count > r->left) {
        r->failed = true;
        return NULL;
    }
    if (count > 0) {
        r->at += count;
        r->left -= count;
    }
    return bytes;
}

CURSOR uint8_t read_u8(reader *r) {
    const uint8_t *b = read_bytes(r, 1);
    return b != NULL ? b[0] : 0;
}

static inline uint16_t load_u16(const uint8_t *b) {
    return (uint16_t)(b[0] | (uint16_t)(b[1] << 8));
}

static inline uint32_t load_u32(const uint8_t *b) {
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static inline uint64_t load_u64(const uint8_t *b) {
    return (uint64_t)load_u32(b) | (uint64_t)load_u32(b + 4) << 32;
}

CURSOR uint16_t read_u16(reader *r) {
    const uint8_t *b = read_bytes(r, 2);
    return b != NULL ? load_u16(b) : 0;
}

CURSOR uint32_t read_u32(reader *r) {
    const uint8_t *b = read_bytes(r, 4);
    return b != NULL ? load_u32(b) : 0;
}

CURSOR uint64_t read_u64(reader *r) {
    const uint8_t *b = read_bytes(r, 8);
    return b != NULL ? load_u64(b) : 0;
}

static inline int32_t i32_from_bits(uint32_t bits) {
    int32_t value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

#define F32_NAN 0x7FC00000U

static inline float f32_from_bits(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline uint32_t bits_from_f32(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static inline uint64_t bits_from_f64(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/** An integer that orders like the float, unless that is NaN. Comparing floats is a slow function
 * call on machines without floating-point hardware. */
static inline int32_t order_of(float value) {
    const uint32_t bits = bits_from_f32(value);
    const int32_t size = (int32_t)(bits & 0x7FFFFFFFU);
    return (bits & 0x80000000U) != 0 ? -size : size;
}

/** Whether a value lies from low to high, which are numbers. NaN and infinity do not. */
static inline bool between(float value, float low, float high) {
    return order_of(value) >= order_of(low) && order_of(value) <= order_of(high);
}

/** Without the sign. The bits of such floats are in the order of their values, with infinity and
 *  then NaN above all numbers. */
static inline uint32_t magnitude_bits(float value) {
    return bits_from_f32(value) & 0x7FFFFFFFU;
}

static inline float magnitude(float value) {
    return f32_from_bits(magnitude_bits(value));
}

/** Also for -0. */
static inline bool is_zero(float value) {
    return magnitude_bits(value) == 0;
}

/** Whether it is a number from -limit to limit. */
static inline bool within_f32(float value, float limit) {
    return magnitude_bits(value) <= bits_from_f32(limit);
}

/** Whether a reported target or speed, in m/s or rad/s, is a rounded zero. */
static inline bool nearly_zero(float value) {
    return within_f32(value, 1e-3F);
}

/** In units of two to the power of -bits, rounded towards zero; FIXED_MOST for anything larger, for
 * infinity, and for NaN. Adding floats is a large function on machines without hardware for it. */
#define FIXED_MOST (INT32_C(1) << 30)
static inline int32_t fixed_from_f32(float value, uint32_t bits) {
    const uint32_t exponent = magnitude_bits(value) >> 23;
    const uint32_t mantissa = (bits_from_f32(value) & 0x7FFFFFU) | 0x800000U;
    int32_t size = 0;
    if (exponent >= 157 - bits) {
        size = FIXED_MOST;
    } else if (exponent >= 150 - bits) {
        size = (int32_t)(mantissa << (exponent + bits - 150));
    } else if (exponent > 126 - bits) {
        size = (int32_t)(mantissa >> (150 - bits - exponent));
    }
    return bits_from_f32(value) >> 31 != 0 ? -size : size;
}

/** The product of two finite floats, rounded as floats are; it must not be too large for one.
 * Anything below the normal floats counts as 0. Multiplying floats is a large function, too. */
static inline float product(float a, float b) {
    const uint32_t sign = (bits_from_f32(a) ^ bits_from_f32(b)) & 0x80000000U;
    const uint32_t exponent_a = magnitude_bits(a) >> 23;
    const uint32_t exponent_b = magnitude_bits(b) >> 23;
    const uint64_t exact = (uint64_t)((bits_from_f32(a) & 0x7FFFFFU) | 0x800000U) *
                           ((bits_from_f32(b) & 0x7FFFFFU) | 0x800000U);
    const uint32_t upper = (uint32_t)(exact >> 16) | ((exact & 0xFFFF) != 0); /* 31 or 32 bits */
    const uint32_t carry = upper >> 31;
    const uint32_t aligned = carry != 0 ? upper : upper << 1;
    const uint32_t exponent = exponent_a + exponent_b + carry;
    /* to the nearest, to the even one of two */
    const uint32_t rounding = (aligned & 0xFF) + (aligned >> 8 & 1) > 0x80;
    if (exponent_a == 0 || exponent_b == 0 || exponent <= 127) {
        return f32_from_bits(sign);
    }
    return f32_from_bits(sign | (((exponent - 128) << 23) + (aligned >> 8) + rounding));
}

/** Whether a float is finite; works even if the compiler may assume that all are. */
static inline bool is_finite(float value) {
    return (bits_from_f32(value) >> 23 & 0xFF) != 0xFF;
}

static inline bool finite_f64_bits(uint64_t bits) {
    return (bits >> 52 & 0x7FF) != 0x7FF;
}

CURSOR float read_f32(reader *r) {
    return f32_from_bits(read_u32(r));
}

/** Copy numbers of `width` bytes each from the wire to memory, or back. */
CURSOR void copy_numbers(uint8_t *to, const uint8_t *from, size_t width, size_t count) {
    const uint16_t probe = 1;
    uint8_t little_endian;
    memcpy(&little_endian, &probe, 1); /* compilers know the result */
    if (little_endian && count > 0) {
        memcpy(to, from, width * count);
        return;
    }
    for (size_t i = 0; i < width * count; i++) {
        to[i] = from[i - i % width + (width - 1 - i % width)];
    }
}

typedef struct writer {
    uint8_t *at;
    size_t left;
} writer;

CURSOR writer writer_of(uint8_t *buffer, size_t capacity) {
    writer w = {buffer, capacity};
    return w;
}

/** Where the next `count` bytes go, or NULL if there is no room for them. */
CURSOR uint8_t *next_bytes(writer *w, size_t count) {
    uint8_t *to = w->at;
    if (count > w->left) {
        w->left = 0;
        return NULL;
    }
    if (count > 0) {
        w->at += count;
        w->left -= count;
    }
    return to;
}

CURSOR void write_bytes(writer *w, const uint8_t *bytes, size_t count) {
    uint8_t *to = next_bytes(w, count);
    if (to != NULL && count > 0) {
        memcpy(to, bytes, count);
    }
}

CURSOR void write_u8(writer *w, uint8_t value) {
    write_bytes(w, &value, 1);
}

CURSOR void write_u16(writer *w, uint16_t value) {
    const uint8_t b[2] = {(uint8_t)value, (uint8_t)(value >> 8)};
    write_bytes(w, b, sizeof b);
}

CURSOR void write_u32(writer *w, uint32_t value) {
    const uint8_t b[4] = {(uint8_t)value, (uint8_t)(value >> 8), (uint8_t)(value >> 16),
                          (uint8_t)(value >> 24)};
    write_bytes(w, b, sizeof b);
}

/** Numbers of `width` bytes each. */
CURSOR void write_numbers(writer *w, const void *numbers, size_t width, size_t count) {
    uint8_t *to = next_bytes(w, width * count);
    if (to != NULL) {
        copy_numbers(to, numbers, width, count);
    }
}

CURSOR void write_u64(writer *w, uint64_t value) {
    write_numbers(w, &value, sizeof value, 1);
}

CURSOR void write_f32(writer *w, float value) {
    write_u32(w, bits_from_f32(value));
}

#endif
