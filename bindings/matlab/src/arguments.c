/* SPDX-License-Identifier: MIT */
#include "arguments.h"

#include <string.h>

#include "fail.h"

static int is_finite(double value) {
    return value - value == 0.0;
}

int take_number(const mxArray *value, const char *name, double *out) {
    if (!(mxIsNumeric(value) || mxIsLogical(value)) || mxIsComplex(value) || mxIsSparse(value) ||
        mxGetNumberOfElements(value) != 1) {
        return fail(FAIL_ARGUMENT, "%s: one real number is needed, this is %s of %lu elements",
                    name, mxGetClassName(value), (unsigned long)mxGetNumberOfElements(value));
    }
    *out = mxGetScalar(value);
    return 1;
}

int take_range(const mxArray *value, const char *name, double least, double most, double *out) {
    double number = 0.0;
    if (!take_number(value, name, &number)) {
        return 0;
    }
    if (!is_finite(number) || number < least || number > most) {
        return fail(FAIL_ARGUMENT, "%s: %g is out of range: %g to %g", name, number, least, most);
    }
    *out = number;
    return 1;
}

int take_whole(const mxArray *value, const char *name, int64_t least, int64_t most, int64_t *out) {
    double number = 0.0;
    if (!take_range(value, name, (double)least, (double)most, &number)) {
        return 0;
    }
    if ((double)(int64_t)number != number) {
        return fail(FAIL_ARGUMENT, "%s: %g is not a whole number", name, number);
    }
    *out = (int64_t)number;
    return 1;
}

int take_flag(const mxArray *value, const char *name, int *out) {
    double number = 0.0;
    if (!take_number(value, name, &number)) {
        return 0;
    }
    if (number != 0.0 && number != 1.0) {
        return fail(FAIL_ARGUMENT, "%s: %g is neither true nor false", name, number);
    }
    *out = number != 0.0;
    return 1;
}

int take_text(const mxArray *value, const char *name, char out[TEXT_SIZE]) {
    if (!mxIsChar(value) || (mxGetM(value) != 1 && mxGetNumberOfElements(value) != 0)) {
        return fail(FAIL_ARGUMENT, "%s: a text is needed, such as 'abc'; this is %s", name,
                    mxGetClassName(value));
    }
    if (mxGetNumberOfElements(value) >= TEXT_SIZE || mxGetString(value, out, TEXT_SIZE) != 0) {
        return fail(FAIL_ARGUMENT, "%s: the text is longer than %d characters", name,
                    TEXT_SIZE - 1);
    }
    if (strlen(out) < mxGetNumberOfElements(value)) {
        return fail(FAIL_ARGUMENT, "%s: there is a character 0 in '%s'", name, out);
    }
    return 1;
}
