/* SPDX-License-Identifier: MIT */
#include "convert.h"

#include <assert.h>
#include <string.h>

#include "fail.h"

#define NOT_KNOWN 255

/* ------------------------------------------------------------------------------ arguments --- */

int take_number(const mxArray *value, const char *name, double *out) {
    if (!(mxIsNumeric(value) || mxIsLogical(value)) || mxIsComplex(value) || mxIsSparse(value) ||
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
    /* NaN fails both comparisons. */
    if (!(number >= least && number <= most)) {
        return fail(FAIL_ARGUMENT, "%s: %g is out of range; give %g to %g", name, number, least,
                    most);
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

/* ------------------------------------------------------------------------- members of structs ---
 */

typedef union member {
    uint8_t u8;
    uint16_t u16;
    uint32_t u32;
    uint64_t u64;
    float f32;
    double f64;
} member;

static uint64_t bits_of(const member *m, size_t size) {
    return size == 1 ? m->u8 : size == 2 ? m->u16 : size == 4 ? m->u32 : m->u64;
}

double field_value(const field *from, const void *base) {
    const double range = from->size < 4 ? 65536.0 : 4294967296.0;
    double number;
    member m;
    memcpy(&m, (const char *)base + from->offset, from->size);
    number = (double)bits_of(&m, from->size);
    switch (from->type) {
    case FIELD_INT:
        return number < range / 2 ? number : number - range;
    case FIELD_FLOAT:
        return from->size == sizeof m.f32 ? (double)m.f32 : m.f64;
    case FIELD_SECONDS:
        return number / 1e6;
    default:
        return number;
    }
}

static int take_integer(const field *to, const mxArray *value, member *out) {
    const int64_t half = (int64_t)1 << (to->size < 8 ? 8 * to->size - 1 : 52);
    int64_t number;
    if (!take_whole(value, to->name, to->type == FIELD_INT ? -half : 0,
                    to->type == FIELD_INT ? half - 1 : 2 * half - 1, &number)) {
        return 0;
    }
    /* Modulo 2^n: the bits of the signed types. */
    *out = to->size == 2   ? (member){.u16 = (uint16_t)number}
           : to->size == 4 ? (member){.u32 = (uint32_t)number}
                           : (member){.u64 = (uint64_t)number};
    return 1;
}

int field_take(const field *to, void *base, const mxArray *value) {
    char *place = (char *)base + to->offset;
    double number = 0.0;
    int fine, on = 0;
    member m;
    if (to->type == FIELD_TEXT) {
        return (mxIsChar(value) && mxGetString(value, place, (mwSize)to->size) == 0) ||
               fail(FAIL_ARGUMENT, "%s: give a text of less than %lu characters", to->name,
                    (unsigned long)to->size);
    }
    memcpy(&m, place, to->size);
    switch (to->type) {
    case FIELD_BIT:
        fine = take_flag(value, to->name, &on);
        m.u32 = on ? m.u32 | to->bit : m.u32 & ~to->bit;
        break;
    case FIELD_MS:
        fine = take_range(value, to->name, 0, 60000.0, &number);
        m.u32 = (uint32_t)(number * 1e3);
        break;
    case FIELD_FLOAT:
        fine = take_range(value, to->name, -1e30, 1e30, &number);
        m = to->size == sizeof m.f32 ? (member){.f32 = (float)number} : (member){.f64 = number};
        break;
    default:
        fine = take_integer(to, value, &m);
        break;
    }
    if (fine) {
        memcpy(place, &m, to->size);
    }
    return fine;
}

/* -------------------------------------------------------------------------------- answers --- */

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

static mxArray *make_field(const field *from, const void *base) {
    mxArray *made;
    switch (from->type) {
    case FIELD_FLAG:
        return mxCreateLogicalScalar(base != NULL && field_value(from, base) != 0.0);
    case FIELD_BYTE:
        made = mxCreateNumericMatrix(1, 1, mxUINT8_CLASS, mxREAL);
        *(uint8_t *)mxGetData(made) =
            base != NULL ? (uint8_t)((uint32_t)field_value(from, base) & 0xFFu) : NOT_KNOWN;
        return made;
    case FIELD_CYCLES:
        memcpy(make_cycles(&made, 1), (const char *)base + from->offset, sizeof(uint64_t));
        return made;
    default:
        return mxCreateDoubleScalar(base != NULL ? field_value(from, base) : mxGetNaN());
    }
}

void answer_fields(answer *out, const field *fields, size_t count, const void *base) {
    for (size_t i = 0; i < count; i++) {
        answer_add(out, fields[i].name, make_field(&fields[i], base));
    }
}

void answer_rows(answer *out, const field *fields, size_t members, const void *base, size_t size,
                 uint32_t count) {
    size_t k;
    uint32_t i;
    for (k = 0; k < members; k++) {
        mxArray *made;
        double *row = make_doubles(&made, 1, count);
        for (i = 0; i < count; i++) {
            row[i] = field_value(&fields[k], (const char *)base + i * size);
        }
        answer_add(out, fields[k].name, made);
    }
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

double *make_doubles(mxArray **out, size_t rows, size_t columns) {
    *out = mxCreateDoubleMatrix((mwSize)rows, (mwSize)columns, mxREAL);
    return mxGetData(*out);
}

uint64_t *make_cycles(mxArray **out, size_t rows) {
    *out = mxCreateNumericMatrix((mwSize)rows, 1, mxUINT64_CLASS, mxREAL);
    return mxGetData(*out);
}
