/* SPDX-License-Identifier: MIT
 *
 * convert.h - values from MATLAB to C and back.
 *
 * Checks again what MATLAB passes: users can bypass the .m files. mxGetData() and mxGetLogicals()
 * mean the same under both of MATLAB's APIs, -R2017b and -R2018a.
 */
#ifndef ROBUROC4_MEX_CONVERT_H
#define ROBUROC4_MEX_CONVERT_H

#include <stddef.h>
#include <stdint.h>

#include "mex.h"

#define COUNT_OF(array) (sizeof(array) / sizeof *(array))

/* ------------------------------------------------------------------------------ arguments --- */
/* Functions return 1 and write *out, or note what is wrong with the value (fail.h) and return 0.
 * `name` is the argument's name in messages. */

/** Room for any text that is accepted: addresses, names, lines of the simulator's panel. */
#define TEXT_SIZE 512

/** A real number, finite or not. */
int take_number(const mxArray *value, const char *name, double *out);
/** A finite number within a range. */
int take_range(const mxArray *value, const char *name, double least, double most, double *out);
/** A whole number within a range. */
int take_whole(const mxArray *value, const char *name, int64_t least, int64_t most, int64_t *out);
/** true or false, 1 or 0. */
int take_flag(const mxArray *value, const char *name, int *out);
/** A char row of less than TEXT_SIZE bytes. */
int take_text(const mxArray *value, const char *name, char out[TEXT_SIZE]);

/* ------------------------------------------------------------------------- members of structs ---
 */

/** What a member is, and what it is in MATLAB: a double if nothing else is said. Its size is the
 *  compiler's. */
typedef enum kind {
    FIELD_UINT,
    FIELD_INT,
    FIELD_FLOAT,
    FIELD_SECONDS, /* unsigned microseconds; seconds */
    FIELD_MS,      /* a uint32_t of microseconds; milliseconds; options only */
    FIELD_BYTE,    /* unsigned; uint8, 255 where it is not known */
    FIELD_FLAG,    /* logical */
    FIELD_CYCLES,  /* a uint64_t of robot cycles; uint64 */
    FIELD_BIT,     /* one bit of a uint32_t; options only */
    FIELD_TEXT,    /* a path in an array of char; options only */
    FIELD_FLOATS,  /* float array of a status; see samples.c */
    FIELD_BITS     /* bits of a uint64_t of a status; logicals, likewise */
} kind;

typedef struct field {
    const char *name; /* in MATLAB */
    size_t offset, size;
    kind type;
    uint32_t bit; /* FIELD_BIT */
} field;

/** A row of a table: a member under its own name, or under a different one. */
#define FIELD(of, member, type) FIELD_AS(#member, of, member, type)
#define FIELD_AS(name, of, member, type)                                                           \
    { name, offsetof(of, member), sizeof(((of *)0)->member), FIELD_##type, 0 }

/** The value of a member, as a double. */
double field_value(const field *from, const void *base);
/** Set a member. Returns 1, or 0 after noting why the value does not fit. */
int field_take(const field *to, void *base, const mxArray *value);

/* -------------------------------------------------------------------------------- answers --- */

#define ANSWER_FIELDS 64

/** A scalar struct for MATLAB, built field by field, with at most ANSWER_FIELDS. count 0: empty. */
typedef struct answer {
    int count;
    const char *names[ANSWER_FIELDS]; /* must outlive the call of answer_finish() */
    mxArray *values[ANSWER_FIELDS];
} answer;

void answer_add(answer *out, const char *name, mxArray *value);
void answer_number(answer *out, const char *name, double value);
void answer_flag(answer *out, const char *name, int value);
/** Members of a struct; if base is NULL, they are unknown: NaN, 255, false. */
void answer_fields(answer *out, const field *fields, size_t count, const void *base);
/** A row for each member, over an array of `count` structs of this size. */
void answer_rows(answer *out, const field *fields, size_t members, const void *base, size_t size,
                 uint32_t count);
/** The struct. */
mxArray *answer_finish(const answer *in);

/** A char row; bytes that are not printable ASCII become '?', because their encoding is unknown. */
mxArray *make_text(const char *text);
/** Doubles or uint64 of this size, all 0, and a pointer to their memory. */
double *make_doubles(mxArray **out, size_t rows, size_t columns);
uint64_t *make_cycles(mxArray **out, size_t rows);

#endif
