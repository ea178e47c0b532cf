/* SPDX-License-Identifier: MIT
 *
 * answers.h - scalar structs for MATLAB, built field by field.
 */
#ifndef ROBUROC4_MEX_ANSWERS_H
#define ROBUROC4_MEX_ANSWERS_H

#include <stddef.h>
#include <stdint.h>

#include "mex.h"

#define ANSWER_FIELDS 64

typedef struct answer {
    int count;
    const char *names[ANSWER_FIELDS]; /* must outlive the call of answer_finish() */
    mxArray *values[ANSWER_FIELDS];
} answer;

/** An answer without fields. */
void answer_begin(answer *out);
/** Add a field: no more than ANSWER_FIELDS. */
void answer_add(answer *out, const char *name, mxArray *value);
void answer_number(answer *out, const char *name, double value);
void answer_flag(answer *out, const char *name, int value);
void answer_byte(answer *out, const char *name, uint8_t value);
/** A uint64, which has room for all robot cycles. */
void answer_cycles(answer *out, const char *name, uint64_t value);
/** A row of doubles. */
void answer_row(answer *out, const char *name, const float *values, size_t count);
/** The struct. */
mxArray *answer_finish(const answer *in);

/** A char row; bytes that are no printable ASCII become '?', as nobody knows their character set.
 */
mxArray *make_text(const char *text, size_t length);
/** Doubles, uint64 or logicals of this size, all 0, and where their memory is. */
double *make_doubles(mxArray **out, size_t rows, size_t columns);
uint64_t *make_cycles(mxArray **out, size_t rows);
mxLogical *make_logicals(mxArray **out, size_t rows, size_t columns);

#endif
