/* SPDX-License-Identifier: MIT
 *
 * arguments.h - what MATLAB passes, checked once more: the .m files are not the last line.
 *
 * Functions return 1 and write *out, or note what is wrong with the value (fail.h) and return 0.
 * `name` is how the message calls the argument.
 */
#ifndef ROBUROC4_MEX_ARGUMENTS_H
#define ROBUROC4_MEX_ARGUMENTS_H

#include <stdint.h>

#include "mex.h"

/** A call of mexFunction() after the name of the command. */
typedef struct call {
    mxArray **results;
    int count;
    const mxArray **arguments;
} call;

/** Room for every text that is taken: addresses, names, lines of the simulator's panel. */
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

#endif
