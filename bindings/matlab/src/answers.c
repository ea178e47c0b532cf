/* SPDX-License-Identifier: MIT
 *
 * mxGetData() and mxGetLogicals() mean the same under both of MATLAB's APIs, -R2017b and -R2018a.
 */
#include "answers.h"

#include <assert.h>

void answer_begin(answer *out) {
    out->count = 0;
}

void answer_add(answer *out, const char *name, mxArray *value) {
    assert(out->count < ANSWER_FIELDS);
    out->names[out->count] = name;
    out->values[out->count] = value;
    out->count++;
}

void answer_number(answer *out, const char *name, double value) {
    answer_add(out, name, mxCreateDoubleScalar(value));
}

void answer_flag(answer *out, const char *name, int value) {
    answer_add(out, name, mxCreateLogicalScalar(value != 0));
}

void answer_byte(answer *out, const char *name, uint8_t value) {
    mxArray *made = mxCreateNumericMatrix(1, 1, mxUINT8_CLASS, mxREAL);
    *(uint8_t *)mxGetData(made) = value;
    answer_add(out, name, made);
}

void answer_cycles(answer *out, const char *name, uint64_t value) {
    mxArray *made;
    *make_cycles(&made, 1) = value;
    answer_add(out, name, made);
}

void answer_row(answer *out, const char *name, const float *values, size_t count) {
    mxArray *made;
    double *numbers = make_doubles(&made, 1, count);
    size_t i;
    for (i = 0; i < count; i++) {
        numbers[i] = (double)values[i];
    }
    answer_add(out, name, made);
}

mxArray *answer_finish(const answer *in) {
    const char *names[ANSWER_FIELDS];
    mxArray *made;
    int i;
    for (i = 0; i < in->count; i++) {
        names[i] = in->names[i];
    }
    made = mxCreateStructMatrix(1, 1, in->count, names);
    for (i = 0; i < in->count; i++) {
        mxSetFieldByNumber(made, 0, i, in->values[i]);
    }
    return made;
}

mxArray *make_text(const char *text, size_t length) {
    char copy[256];
    size_t i;
    for (i = 0; i < length && i + 1 < sizeof copy; i++) {
        copy[i] = text[i] >= ' ' && text[i] <= '~' ? text[i] : '?';
    }
    copy[i] = '\0';
    return mxCreateString(copy);
}

double *make_doubles(mxArray **out, size_t rows, size_t columns) {
    *out = mxCreateDoubleMatrix((mwSize)rows, (mwSize)columns, mxREAL);
    return mxGetData(*out);
}

uint64_t *make_cycles(mxArray **out, size_t rows) {
    *out = mxCreateNumericMatrix((mwSize)rows, 1, mxUINT64_CLASS, mxREAL);
    return mxGetData(*out);
}

mxLogical *make_logicals(mxArray **out, size_t rows, size_t columns) {
    *out = mxCreateLogicalMatrix((mwSize)rows, (mwSize)columns);
    return mxGetLogicals(*out);
}
