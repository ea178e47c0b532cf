/* SPDX-License-Identifier: MIT
 *
 * C structs to the records of records.py, and Python values to settings. A record's class says
 * which fields of its struct it has, and in which order: they are looked up by name, once. Records
 * without a struct are made by hand, here and in decode.c; importing checks that their fields are
 * those of this order.
 */
#include "native.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct field {
    const char *name; /* struct.member */
    char type;        /* u, i or f */
    uint8_t size;
    uint32_t offset, count; /* count: of an array, else 0 */
} field;

/* fields.h is written by make_fields.py from the headers. */
#define TYPE_OF(X)                                                                                 \
    _Generic((X), float : 'f', double : 'f', int16_t : 'i', int32_t : 'i', default : 'u')
#define FIELD(S, NAME)                                                                             \
    {#S "." #NAME, TYPE_OF(((S *)0)->NAME), sizeof(((S *)0)->NAME), offsetof(S, NAME), 0},
#define ARRAY(S, NAME)                                                                             \
    {#S "." #NAME, TYPE_OF(((S *)0)->NAME[0]), sizeof(((S *)0)->NAME[0]), offsetof(S, NAME),       \
     sizeof(((S *)0)->NAME) / sizeof(((S *)0)->NAME[0])},
static const field all_fields[] = {
#include "fields.h"
    {NULL, 0, 0, 0, 0}};

typedef struct column {
    const field *field;
    PyObject *meanings; /* a dict: what Python has for some of the numbers; or None */
} column;

#define COLUMNS_MAX 64

typedef struct record_class {
    PyObject *class;
    column columns[COLUMNS_MAX];
    int count;
} record_class;

/* Records that are made by hand, and their fields in the order in which they are. */
static const char *const by_hand[RECORD_KINDS] = {
    [RECORD_IOCARD_STATUS] = "IoCardStatus robot_cycles analog_inputs digital_inputs host_us utc_s",
    [RECORD_TELEMETER_STATUS] = "TelemeterStatus robot_cycles distances_m host_us utc_s",
};

static record_class classes[RECORD_KINDS];
static PyObject *make_error;
static newfunc tuple_new;

/* ---------------------------------------------------------------------------- registration --- */

static const field *find_field(const char *structure, const char *member) {
    size_t length = strlen(structure);
    const field *f = all_fields;
    while (f->name != NULL && (strncmp(f->name, structure, length) != 0 || f->name[length] != '.' ||
                               strcmp(f->name + length + 1, member) != 0)) {
        f++;
    }
    if (f->name == NULL) {
        (void)PyErr_Format(PyExc_AttributeError, "%s has no field %s", structure, member);
        return NULL;
    }
    return f;
}

PyObject *register_record(uint32_t kind, PyObject *type, const char *structure, PyObject *members) {
    record_class *record = &classes[kind < RECORD_KINDS ? kind : 0];
    Py_ssize_t count = PyList_Size(members), i;
    void *slot = PyType_GetSlot(&PyTuple_Type, Py_tp_new);
    if (kind >= RECORD_KINDS || count < 0 || count > COLUMNS_MAX) {
        PyErr_SetString(PyExc_ValueError, "register_record");
        return NULL;
    }
    if (by_hand[kind] != NULL && strcmp(structure, by_hand[kind]) != 0) {
        return PyErr_Format(PyExc_AttributeError, "%s: other fields are made: %s", structure,
                            by_hand[kind]);
    }
    for (i = 0; i < count; i++) {
        column *made = &record->columns[i];
        const char *name;
        if (!PyArg_ParseTuple(PyList_GetItem(members, i), "sO", &name, &made->meanings)) {
            return NULL;
        }
        Py_INCREF(made->meanings);
        made->field = find_field(structure, name);
        if (made->field == NULL) {
            return NULL;
        }
    }
    memcpy(&tuple_new, &slot, sizeof tuple_new); /* C has no cast for it */
    Py_INCREF(type);
    record->class = type;
    record->count = (int)count;
    Py_RETURN_NONE;
}

PyObject *register_errors(PyObject *error_of) {
    Py_INCREF(error_of);
    make_error = error_of;
    Py_RETURN_NONE;
}

PyObject *raise_result(roburoc4_result result) {
    PyObject *exception = PyObject_CallFunction(make_error, "i", (int)result);
    if (exception != NULL) {
        PyErr_SetObject((PyObject *)Py_TYPE(exception), exception);
        Py_DECREF(exception);
    }
    return NULL;
}

/* --------------------------------------------------------------------------------- records --- */

static uint64_t unsigned_at(const void *at, size_t size) {
    switch (size) {
    case 1:
        return *(const uint8_t *)at;
    case 2:
        return *(const uint16_t *)at;
    case 4:
        return *(const uint32_t *)at;
    default:
        return *(const uint64_t *)at;
    }
}

double shortest(float value) {
    static const double tens[] = {1,   1e1, 1e2,  1e3,  1e4,  1e5,  1e6, 1e7,
                                  1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14};
    const double magnitude = fabs((double)value);
    int decimals = 5, digits;
    if (!(magnitude >= 1e-6 && magnitude < 1e6)) {
        return value;
    }
    /* Six significant digits, then more: the quotient of two exact numbers is as near to the
     * decimal as a number can be. */
    while (decimals > 0 && magnitude >= tens[6 - decimals]) {
        decimals--;
    }
    while (decimals < 11 && magnitude * tens[decimals] < 1e5) {
        decimals++;
    }
    for (digits = 0; digits < 3; digits++) {
        const double candidate = rint(value * tens[decimals + digits]) / tens[decimals + digits];
        if ((float)candidate == value) {
            return candidate;
        }
    }
    return value;
}

static PyObject *number_at(const field *f, const void *at) {
    if (f->type == 'f') {
        return PyFloat_FromDouble(f->size == 4 ? shortest(*(const float *)at)
                                               : *(const double *)at);
    }
    if (f->type == 'i') {
        return PyLong_FromLong(f->size == 2 ? *(const int16_t *)at : *(const int32_t *)at);
    }
    return PyLong_FromUnsignedLongLong(unsigned_at(at, f->size));
}

static PyObject *value_of(const column *column, const void *structure) {
    const field *f = column->field;
    const void *at = (const uint8_t *)structure + f->offset;
    PyObject *number, *meaning = NULL;
    if (f->count > 0) {
        return tuple_of_floats(at, f->count);
    }
    number = number_at(f, at);
    if (number != NULL && column->meanings != Py_None) {
        meaning = PyDict_GetItemWithError(column->meanings, number);
    }
    if (meaning == NULL) {
        return number;
    }
    Py_INCREF(meaning);
    Py_DECREF(number);
    return meaning;
}

/* tuple.__new__ is called directly: the __new__ of a NamedTuple costs more than all the rest. */
PyObject *record_new(record_kind kind, PyObject *values) {
    PyObject *arguments, *record;
    if (values == NULL) {
        return NULL;
    }
    arguments = PyTuple_Pack(1, values);
    Py_DECREF(values);
    if (arguments == NULL) {
        return NULL;
    }
    record = tuple_new((PyTypeObject *)classes[kind].class, arguments, NULL);
    Py_DECREF(arguments);
    return record;
}

PyObject *put_item(PyObject *tuple, Py_ssize_t i, PyObject *item) {
    if (tuple != NULL && item != NULL) {
        (void)PyTuple_SetItem(tuple, i, item);
        return tuple;
    }
    Py_XDECREF(tuple);
    Py_XDECREF(item);
    return NULL;
}

/* A tuple of the values, with room for more. */
static PyObject *values_of(record_kind kind, const void *structure, int more) {
    const record_class *record = &classes[kind];
    PyObject *tuple = PyTuple_New(record->count + more);
    for (int i = 0; tuple != NULL && i < record->count; i++) {
        tuple = put_item(tuple, i, value_of(&record->columns[i], structure));
    }
    return tuple;
}

PyObject *record_of(record_kind kind, const void *value) {
    return record_new(kind, values_of(kind, value, 0));
}

PyObject *tuple_of_floats(const float *values, uint32_t count) {
    PyObject *tuple = PyTuple_New(count);
    for (uint32_t i = 0; tuple != NULL && i < count; i++) {
        tuple = put_item(tuple, i, PyFloat_FromDouble(shortest(values[i])));
    }
    return tuple;
}

PyObject *tuple_of_view(const uint8_t *view, uint32_t count) {
    float some[16];
    PyObject *tuple = PyTuple_New(count);
    for (uint32_t i = 0; tuple != NULL && i < count; i++) {
        if (i % 16 == 0) {
            (void)roburoc4_floats(view + i * sizeof *some, count - i, some, 16);
        }
        tuple = put_item(tuple, i, PyFloat_FromDouble(shortest(some[i % 16])));
    }
    return tuple;
}

PyObject *tuple_of_bits(const uint8_t *blocks, uint32_t count) {
    PyObject *tuple = PyTuple_New(count);
    for (uint32_t i = 0; tuple != NULL && i < count; i++) {
        tuple = put_item(tuple, i, Py_NewRef(blocks[i / 8] >> i % 8 & 1 ? Py_True : Py_False));
    }
    return tuple;
}

static PyObject *tuple_of_digital_inputs(const roburoc4_inputs *inputs) {
    uint8_t blocks[8];
    for (int i = 0; i < 8; i++) {
        blocks[i] = (uint8_t)(inputs->digital >> 8 * i);
    }
    return tuple_of_bits(blocks, inputs->digital_count);
}

PyObject *record_of_status(record_kind kind, const void *status, uint64_t host_us,
                           uint64_t utc_us) {
    const unsigned long long host = host_us;
    const double utc_s = (double)utc_us / 1e6;
    const int count = classes[kind].count;
    PyObject *values;
    if (kind == RECORD_IOCARD_STATUS) {
        const roburoc4_inputs *inputs = status;
        values = Py_BuildValue("(KNNKd)", (unsigned long long)inputs->robot_cycles,
                               tuple_of_floats(inputs->analog, inputs->analog_count),
                               tuple_of_digital_inputs(inputs), host, utc_s);
    } else if (kind == RECORD_TELEMETER_STATUS) {
        const roburoc4_distances *d = status;
        values = Py_BuildValue("(KNKd)", (unsigned long long)d->robot_cycles,
                               tuple_of_floats(d->distances_m, d->count), host, utc_s);
    } else {
        values = put_item(values_of(kind, status, 2), count, PyLong_FromUnsignedLongLong(host));
        values = put_item(values, count + 1, PyFloat_FromDouble(utc_s));
    }
    return record_new(kind, values);
}

/* --------------------------------------------------------------------------------- numbers --- */

static int out_of_range(PyObject *number) {
    (void)PyErr_Format(PyExc_OverflowError, "%S is out of range", number);
    return -1;
}

int take_double(PyObject *number, double *out) {
    *out = PyFloat_AsDouble(number);
    return *out == -1.0 && PyErr_Occurred() != NULL ? -1 : 0;
}

int take_float(PyObject *number, float *out) {
    double value;
    if (take_double(number, &value) < 0) {
        return -1;
    }
    *out = (float)value;
    return isinf(*out) && !isinf(value) ? out_of_range(number) : 0;
}

/* Convert a number to an integer; NULL with an exception if it is not one. */
static PyObject *whole_of(PyObject *number) {
    double value;
    if (PyIndex_Check(number)) {
        return PyNumber_Index(number);
    }
    if (take_double(number, &value) < 0) {
        return NULL;
    }
    if (!(floor(value) == value)) { /* NaN, too */
        return PyErr_Format(PyExc_OverflowError, "%S is not a whole number", number);
    }
    return PyLong_FromDouble(value);
}

int take_whole(PyObject *number, long long low, long long high, long long *out) {
    PyObject *whole = whole_of(number);
    int overflow = 0;
    if (whole == NULL) {
        return -1;
    }
    *out = PyLong_AsLongLongAndOverflow(whole, &overflow);
    Py_DECREF(whole);
    return overflow != 0 || *out < low || *out > high ? out_of_range(number) : 0;
}

int take_uint64(PyObject *number, uint64_t *out) {
    PyObject *whole = whole_of(number);
    if (whole == NULL) {
        return -1;
    }
    *out = PyLong_AsUnsignedLongLong(whole);
    Py_DECREF(whole);
    return PyErr_Occurred() != NULL ? -1 : 0;
}

/* -------------------------------------------------------------------------------- settings --- */

/* Store a number in a member; -1 with an exception if it is not a number or does not fit. */
static int store(const field *f, void *at, PyObject *value) {
    const long long count = f->size == 2 ? 1ll << 16 : 1ll << 32;
    const long long low = f->type == 'i' ? -count / 2 : 0;
    long long whole = 0;
    if (f->type == 'f') {
        return f->size == 8 ? take_double(value, at) : take_float(value, at);
    }
    if (f->size == 8) {
        return take_uint64(value, at);
    }
    if (take_whole(value, low, low + count - 1, &whole) < 0) {
        return -1;
    }
    if (f->size == 2) {
        *(uint16_t *)at = (uint16_t)whole;
    } else {
        *(uint32_t *)at = (uint32_t)whole;
    }
    return 0;
}

PyObject *set_member(PyObject *settings, const char *name, PyObject *value, uint32_t index) {
    const char *structure = PyCapsule_GetName(settings);
    uint8_t *at = structure != NULL ? PyCapsule_GetPointer(settings, structure) : NULL;
    const field *f = at != NULL ? find_field(structure, name) : NULL;
    if (f == NULL) {
        return NULL;
    }
    if (index > 0 && index >= f->count) {
        return PyErr_Format(PyExc_IndexError, "%s[%u]", name, (unsigned)index);
    }
    if (store(f, at + f->offset + (size_t)index * f->size, value) < 0) {
        return NULL;
    }
    Py_RETURN_NONE;
}
