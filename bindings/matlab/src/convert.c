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
    int16_t i16;
    uint32_t u32;
    int32_t i32;
    uint64_t u64;
    float f32;
    double f64;
} member;

static size_t size_of(kind type) {
    static const uint8_t sizes[] = {2, 2, 4, 4, 8, 4, 8, 4, 8, 1, 4, 1, 4, 8, 4, 4};
    return sizes[type];
}

double field_value(const field *from, const void *base) {
    member m = {0};
    memcpy(&m, (const char *)base + from->offset, size_of(from->type));
    switch (from->type) {
    case FIELD_U16:
        return m.u16;
    case FIELD_I16:
        return m.i16;
    case FIELD_I32:
        return m.i32;
    case FIELD_US32:
        return m.u32 / 1e6;
    case FIELD_US64:
        return (double)m.u64 / 1e6;
    case FIELD_U64:
    case FIELD_CYCLES:
        return (double)m.u64;
    case FIELD_F32:
        return (double)m.f32;
    case FIELD_F64:
        return m.f64;
    case FIELD_BYTE:
    case FIELD_FLAG8:
        return m.u8;
    default:
        return m.u32;
    }
}

/* The least and the most of the integers, from FIELD_U16 to FIELD_U64. */
static const int64_t least[] = {0, INT16_MIN, 0, INT32_MIN, 0};
static const int64_t most[] = {UINT16_MAX, INT16_MAX, UINT32_MAX, INT32_MAX, (int64_t)1 << 53};

static int take_member(const field *to, member *out, const mxArray *value) {
    int64_t whole;
    double number;
    int on;
    switch (to->type) {
    case FIELD_BIT:
        if (!take_flag(value, to->name, &on)) {
            return 0;
        }
        out->u32 = on ? out->u32 | to->bit : out->u32 & ~to->bit;
        return 1;
    case FIELD_MS32:
        if (!take_range(value, to->name, 0, 60000.0, &number)) {
            return 0;
        }
        out->u32 = (uint32_t)(number * 1e3);
        return 1;
    case FIELD_F32:
    case FIELD_F64:
        if (!take_range(value, to->name, -1e30, 1e30, &number)) {
            return 0;
        }
        *out = to->type == FIELD_F32 ? (member){.f32 = (float)number} : (member){.f64 = number};
        return 1;
    default:
        if (!take_whole(value, to->name, least[to->type], most[to->type], &whole)) {
            return 0;
        }
        /* Modulo 2^n: the bits of the signed types. */
        *out = size_of(to->type) == 2   ? (member){.u16 = (uint16_t)whole}
               : size_of(to->type) == 4 ? (member){.u32 = (uint32_t)whole}
                                        : (member){.u64 = (uint64_t)whole};
        return 1;
    }
}

int field_take(const field *to, void *base, const mxArray *value) {
    char *place = (char *)base + to->offset;
    member m;
    memcpy(&m, place, size_of(to->type));
    if (!take_member(to, &m, value)) {
        return 0;
    }
    memcpy(place, &m, size_of(to->type));
    return 1;
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
    case FIELD_FLAG8:
    case FIELD_FLAG32:
        return mxCreateLogicalScalar(base != NULL && field_value(from, base) != 0.0);
    case FIELD_BYTE:
    case FIELD_BYTE32:
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
