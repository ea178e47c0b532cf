/* SPDX-License-Identifier: MIT */
#include "convert.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* --------------------------------------------------------------------------------- errors --- */

static const char *noted_id = FAIL_PROTOCOL;
static char noted_text[2560];

static const struct {
    roburoc4_result result;
    const char *id;
} ids[] = {
    {ROBUROC4_ERR_ARGUMENT, FAIL_ARGUMENT}, {ROBUROC4_ERR_CONFIG, FAIL_ARGUMENT},
    {ROBUROC4_ERR_STATE, FAIL_ARGUMENT},    {ROBUROC4_ERR_INDEX, FAIL_ARGUMENT},
    {ROBUROC4_ERR_RESERVED, FAIL_ARGUMENT}, {ROBUROC4_ERR_NOT_FINITE, FAIL_ARGUMENT},
    {ROBUROC4_ERR_TIMEOUT, FAIL_TIMEOUT},   {ROBUROC4_ERR_SYSTEM, FAIL_NETWORK},
    {ROBUROC4_ERR_RESOLVE, FAIL_NETWORK},   {ROBUROC4_ERR_CLOSED, FAIL_CLOSED},
    {ROBUROC4_ERR_UNITS, FAIL_ARGUMENT},    {ROBUROC4_ERR_ADDRESS, FAIL_ARGUMENT},
};

static const char *id_of(roburoc4_result result) {
    for (size_t i = 0; i < COUNT_OF(ids); i++) {
        if (ids[i].result == result) {
            return ids[i].id;
        }
    }
    return result <= ROBUROC4_ERR_DISARMED && result >= ROBUROC4_ERR_SUBSCRIPTION_REFUSED
               ? FAIL_NOT_ARMED
               : FAIL_PROTOCOL;
}

int fail(const char *id, const char *format, ...) {
    va_list arguments;
    noted_id = id;
    va_start(arguments, format);
    (void)vsnprintf(noted_text, sizeof noted_text, format, arguments);
    va_end(arguments);
    return 0;
}

int done(const char *what, roburoc4_result result) {
    const char *text = roburoc4_result_text(result);
    const size_t cause = strcspn(text, ":"); /* a remedy follows */
    return result >= 0 ||
           fail(id_of(result), "%s: %.*s%s%s", what, (int)cause, text,
                text[cause] != '\0' ? ";" : "", text[cause] != '\0' ? text + cause + 1 : "");
}

/* In Octave, mexErrMsgIdAndTxt() would put the name of this file before the message. */
void fail_raise(void) {
    mxArray *arguments[] = {mxCreateString(noted_id), mxCreateString("%s"),
                            mxCreateString(noted_text)};
    (void)mexCallMATLAB(0, NULL, 3, arguments, "error");
}

/* ------------------------------------------------------------------------------ arguments --- */

int take_number(const mxArray *value, const char *name, double *out) {
    if (mxIsComplex(value)) {
        return fail(FAIL_ARGUMENT, "%s: this is a complex number; give one real number", name);
    }
    if (!(mxIsNumeric(value) || mxIsLogical(value)) || mxIsSparse(value) ||
        mxGetNumberOfElements(value) != 1) {
        return fail(FAIL_ARGUMENT, "%s: this is %s of %lu elements; give one real number", name,
                    mxGetClassName(value), (unsigned long)mxGetNumberOfElements(value));
    }
    *out = mxGetScalar(value);
    return 1;
}

int take_range(const mxArray *value, const char *name, double least, double most, double *out) {
    double number = 0.0;
    if (!take_number(value, name, &number)) {
        return 0;
    }
    if (number != number) {
        return fail(FAIL_ARGUMENT, "%s: this is NaN; give a number", name);
    }
    if (!(number >= least && number <= most)) {
        return fail(FAIL_ARGUMENT, "%s: %g is out of range; give %.10g to %.10g", name, number,
                    least, most);
    }
    *out = number;
    return 1;
}

int take_whole(const mxArray *value, const char *name, double least, double most, double *out) {
    return take_range(value, name, least, most, out) &&
           (floor(*out) == *out || fail(FAIL_ARGUMENT, "%s: %g is not a whole number", name, *out));
}

int take_text(const mxArray *value, const char *name, char out[TEXT_SIZE]) {
    if (!mxIsChar(value) || (mxGetM(value) != 1 && mxGetNumberOfElements(value) != 0)) {
        return fail(FAIL_ARGUMENT, "%s: this is %s; give a text, such as 'abc'", name,
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

/* -------------------------------------------------------------------- members of structs --- */

static uint64_t bits_at(const void *at, size_t size) {
    return size == 1   ? *(const uint8_t *)at
           : size == 2 ? *(const uint16_t *)at
           : size == 4 ? *(const uint32_t *)at
                       : *(const uint64_t *)at;
}

double field_number(const answer *times, const field *from, const void *base, size_t column) {
    const void *at = (const char *)base + from->offset + column * from->stride;
    const uint64_t bits = from->type == FIELD_FLOAT ? 0 : bits_at(at, from->size);
    switch (from->type) {
    case FIELD_INT:
        return *(const int32_t *)at;
    case FIELD_FLOAT:
        return from->size == sizeof(float) ? (double)*(const float *)at : *(const double *)at;
    case FIELD_SECONDS:
        return (double)bits / 1e6;
    case FIELD_TIME:
        return answer_time(times, bits);
    case FIELD_UTC:
        return (double)(int64_t)(times->utc_us + bits) / 1e6;
    case FIELD_BITS:
        return (double)(bits >> column & 1u);
    default:
        return (double)bits;
    }
}

/* How many numbers a member has. */
static uint32_t width_of(const field *from, const void *base) {
    return from->count != 0 ? (uint32_t)bits_at((const char *)base + from->count, 4) : 1;
}

static uint32_t widest(const field *from, const char *base, size_t size, uint32_t rows) {
    uint32_t width = from->count == 0, row;
    for (row = 0; row < rows; row++) {
        const uint32_t here = width_of(from, base + row * size);
        width = here > width ? here : width;
    }
    return width;
}

static mxClassID class_of(kind type, int in_columns) {
    return type == FIELD_FLAG || type == FIELD_BITS ? mxLOGICAL_CLASS
           : type == FIELD_CYCLES                   ? mxUINT64_CLASS
           : type == FIELD_BYTE && !in_columns      ? mxUINT8_CLASS
                                                    : mxDOUBLE_CLASS;
}

/* ------------------------------------------------------------------------------- answers --- */

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

/* A row for each of some structs, as wide as the widest; NaN or false beyond their ends. */
static void add_field(answer *out, const field *from, const char *base, size_t size,
                      uint32_t rows) {
    const mxClassID class = class_of(from->type, size != 0);
    const uint32_t width = widest(from, base, size, rows);
    mxArray *made = class == mxLOGICAL_CLASS ? mxCreateLogicalMatrix(rows, width)
                                             : mxCreateNumericMatrix(rows, width, class, mxREAL);
    void *data = class == mxLOGICAL_CLASS ? (void *)mxGetLogicals(made) : mxGetData(made);
    size_t place = 0;
    for (uint32_t column = 0; column < width; column++) {
        for (uint32_t row = 0; row < rows; row++, place++) {
            const char *at = base + row * size;
            const double number =
                column < width_of(from, at) ? field_number(out, from, at, column) : mxGetNaN();
            if (class == mxLOGICAL_CLASS) {
                ((mxLogical *)data)[place] = number > 0.0;
            } else if (class == mxUINT8_CLASS) {
                ((uint8_t *)data)[place] = (uint8_t)(uint32_t)number;
            } else if (class == mxUINT64_CLASS) { /* a double could round it */
                ((uint64_t *)data)[place] = bits_at(at + from->offset, from->size);
            } else {
                ((double *)data)[place] = number;
            }
        }
    }
    answer_add(out, from->name, made);
}

void answer_columns(answer *out, const field *fields, size_t count, const void *base, size_t size,
                    uint32_t rows) {
    for (size_t i = 0; i < count; i++) {
        add_field(out, &fields[i], base, size, rows);
    }
}

void answer_fields(answer *out, const field *fields, size_t count, const void *base) {
    answer_columns(out, fields, count, base, 0, 1);
}

double answer_time(const answer *times, uint64_t time_us) {
    return (double)(int64_t)(time_us - times->begin_us) / 1e6;
}

mxArray *answer_finish(const answer *in) {
    const char *names[ANSWER_FIELDS];
    mxArray *made;
    memcpy(names, in->names, sizeof names);
    made = mxCreateStructMatrix(1, 1, in->count, names);
    for (int i = 0; i < in->count; i++) {
        mxSetFieldByNumber(made, 0, i, in->values[i]);
    }
    return made;
}

mxArray *make_text(const char *text) {
    char copy[256];
    size_t i;
    for (i = 0; text[i] != '\0' && i + 1 < sizeof copy; i++) {
        copy[i] = text[i] >= ' ' && text[i] <= '~' ? text[i] : '?';
    }
    copy[i] = '\0';
    return mxCreateString(copy);
}

double *make_row(mxArray **out, size_t columns) {
    *out = mxCreateDoubleMatrix(1, (mwSize)columns, mxREAL);
    return mxGetData(*out);
}
