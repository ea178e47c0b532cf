/* SPDX-License-Identifier: MIT
 *
 * convert.h - values from MATLAB to C and back, and errors.
 *
 * Checks again what MATLAB passes: users can bypass the .m files. mxGetData() and mxGetLogicals()
 * mean the same under both of MATLAB's APIs, -R2017b and -R2018a.
 */
#ifndef ROBUROC4_MEX_CONVERT_H
#define ROBUROC4_MEX_CONVERT_H

#include <stddef.h>
#include <stdint.h>

#include "mex.h"
#include "roburoc4.h"

#define COUNT_OF(array) (sizeof(array) / sizeof *(array))

/* --------------------------------------------------------------------------------- errors --- */
/* Raising an error does not return. So commands only note the error of a call, and mexFunction()
 * raises it as its very last action, when everything is cleaned up. */

#define FAIL_ARGUMENT "roburoc4:badArgument"
#define FAIL_CLOSED "roburoc4:closed"
#define FAIL_LIMIT "roburoc4:limit"
#define FAIL_MOVE "roburoc4:moveEnded"
#define FAIL_NETWORK "roburoc4:network"
#define FAIL_NOT_ARMED "roburoc4:notArmed"
#define FAIL_PROTOCOL "roburoc4:protocol"
#define FAIL_TIMEOUT "roburoc4:timeout"

/** Note an error with its id. Returns 0, for `return fail(...)` in a command. */
#ifdef __GNUC__
__attribute__((format(printf, 2, 3)))
#endif
int fail(const char *id, const char *format, ...);
/** 1; or 0 after noting the meaning of a negative result of the library, and the remedy, after
 * `what`. */
int done(const char *what, roburoc4_result result);
/** Raise the noted error, and do not return. */
void fail_raise(void);

/* ------------------------------------------------------------------------------ arguments --- */
/* Functions return 1 and write *out, or note what is wrong with the value and return 0.
 * `name` is the argument's name in messages. */

/** Room for any text that is accepted: addresses, names, paths, lines of the simulator's panel. */
#define TEXT_SIZE 1024

/** A real number, finite or not. */
int take_number(const mxArray *value, const char *name, double *out);
/** A finite number within a range. */
int take_range(const mxArray *value, const char *name, double least, double most, double *out);
/** A whole number within a range; with 0 to 1, also true or false. */
int take_whole(const mxArray *value, const char *name, double least, double most, double *out);
/** A char row of less than TEXT_SIZE bytes. */
int take_text(const mxArray *value, const char *name, char out[TEXT_SIZE]);

/* -------------------------------------------------------------------- members of structs --- */

/** What a member is, and what it is in MATLAB: a double if nothing else is said. Its size is the
 *  compiler's. */
typedef enum kind {
    FIELD_UINT,
    FIELD_INT,
    FIELD_FLOAT,
    FIELD_SECONDS, /* unsigned microseconds; seconds */
    FIELD_TIME,    /* a uint64_t, microseconds of the robot's clock; seconds since the answer's
                    * begin_us */
    FIELD_UTC,     /* likewise; seconds since 1970 */
    FIELD_BYTE,    /* unsigned; the lowest byte, uint8; in columns all of it, a double */
    FIELD_FLAG,    /* logical */
    FIELD_BITS,    /* a uint64_t; a row of logicals */
    FIELD_CYCLES,  /* a uint64_t of robot cycles; uint64 */
    FIELD_BIT      /* one bit of a uint32_t; options only */
} kind;

typedef struct field {
    const char *name; /* in MATLAB */
    size_t offset, size;
    kind type;
    size_t stride, count; /* of a row: from one number to the next, and the offset of a uint32_t
                           * with their number; of a FIELD_BIT: 0, and the bit */
} field;

/** A row of a table: a member under its own name, or under a different one. */
#define FIELD(of, member, type) FIELD_AS(#member, of, member, type)
#define FIELD_AS(name, of, member, type)                                                           \
    { name, offsetof(of, member), sizeof(((of *)0)->member), FIELD_##type, 0, 0 }
/** Likewise, a member of each element of an array; `first` is that of the first element. */
#define FIELD_ROW(name, of, array, first, type, count)                                             \
    {                                                                                              \
        name, offsetof(of, first), sizeof(((of *)0)->first), FIELD_##type,                         \
            sizeof(((of *)0)->array[0]), offsetof(of, count)                                       \
    }

/* -------------------------------------------------------------------------------- answers --- */

#define ANSWER_FIELDS 128

/** A scalar struct for MATLAB, built field by field, with at most ANSWER_FIELDS. count 0: empty. */
typedef struct answer {
    uint64_t begin_us; /* when time_s is 0, on the robot's clock */
    uint64_t utc_us;   /* UTC when that clock is 0, since 1970 */
    int count;
    const char *names[ANSWER_FIELDS]; /* must outlive the call of answer_finish() */
    mxArray *values[ANSWER_FIELDS];
} answer;

void answer_add(answer *out, const char *name, mxArray *value);
void answer_number(answer *out, const char *name, double value);
void answer_flag(answer *out, const char *name, int value);
/** Members of a struct. */
void answer_fields(answer *out, const field *fields, size_t count, const void *base);
/** Columns with a row for each of the structs in an array. */
void answer_columns(answer *out, const field *fields, size_t count, const void *base, size_t size,
                    uint32_t rows);
/** The struct. */
mxArray *answer_finish(const answer *in);

/** A number of a member, of a row the one in this column; CYCLES may be rounded. */
double field_number(const answer *times, const field *from, const void *base, size_t column);
/** A time on the robot's clock, in seconds since begin_us. */
double answer_time(const answer *times, uint64_t time_us);
/** A char row; bytes that are not printable ASCII become '?', because their encoding is unknown. */
mxArray *make_text(const char *text);
/** A row of doubles, all 0, and a pointer to their memory. */
double *make_row(mxArray **out, size_t columns);

#endif
