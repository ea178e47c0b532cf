/* SPDX-License-Identifier: MIT
 *
 * C structs to the records of records.py, and Python's numbers to those of C. A record's class says
 * which fields of its struct it has, and in which order: they are looked up by name, once.
 */
#include "native.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct field {
    const char *structure, *name;
    char type;      /* as in Python's module struct; s: a path */
    uint16_t count; /* of an array, else 0 */
    uint32_t offset;
} field;

/* fields.h is written by make_fields.py from the headers. */
#define TYPE_OF(X)                                                                                 \
    _Generic((X), uint8_t                                                                          \
             : 'B', uint16_t                                                                       \
             : 'H', uint32_t                                                                       \
             : 'I', uint64_t                                                                       \
             : 'Q', int16_t                                                                        \
             : 'h', int32_t                                                                        \
             : 'i', float                                                                          \
             : 'f', double                                                                         \
             : 'd', char                                                                           \
             : 's')
#define FIELD(S, NAME) {#S, #NAME, TYPE_OF(((S *)0)->NAME), 0, offsetof(S, NAME)},
#define ARRAY(S, NAME)                                                                             \
    {#S, #NAME, TYPE_OF(((S *)0)->NAME[0]), sizeof(((S *)0)->NAME) / sizeof(((S *)0)->NAME[0]),    \
     offsetof(S, NAME)},
static const field all_fields[] = {
#include "fields.h"
    {NULL, NULL, 0, 0, 0}};

typedef struct column {
    const field *field;
    const field *known; /* a flag: 0 makes the value None; or NULL */
    PyObject *meanings; /* a dict: what Python has for some of the numbers; or None */
} column;

#define CLASSES_MAX 32
#define COLUMNS_MAX 64

typedef struct record_class {
    const char *structure;
    PyObject *class;
    column columns[COLUMNS_MAX];
    int count;
} record_class;

static record_class classes[CLASSES_MAX]; /* those of statuses first, in the order of services */
static int class_count;
static PyObject *make_error;
static newfunc tuple_new;

/* ---------------------------------------------------------------------------- registration --- */

static const field *find_field(const char *structure, const char *name) {
    const field *f = all_fields;
    while (f->name != NULL &&
           (strcmp(f->structure, structure) != 0 || strcmp(f->name, name) != 0)) {
        f++;
    }
    if (f->name == NULL) {
        (void)PyErr_Format(PyExc_AttributeError, "%s has no field %s", structure, name);
        return NULL;
    }
    return f;
}

PyObject *register_record(const char *structure, PyObject *type, PyObject *members) {
    record_class *record = &classes[class_count];
    Py_ssize_t count = PyList_Size(members), i;
    void *slot = PyType_GetSlot(&PyTuple_Type, Py_tp_new);
    if (class_count == CLASSES_MAX || count < 0 || count > COLUMNS_MAX) {
        PyErr_SetString(PyExc_ValueError, "register_record");
        return NULL;
    }
    for (i = 0; i < count; i++) {
        column *made = &record->columns[i];
        const char *name, *known;
        if (!PyArg_ParseTuple(PyList_GetItem(members, i), "szO", &name, &known, &made->meanings)) {
            return NULL;
        }
        Py_INCREF(made->meanings);
        made->field = find_field(structure, name);
        made->known = known != NULL ? find_field(structure, known) : NULL;
        if (made->field == NULL || (known != NULL && made->known == NULL)) {
            return NULL;
        }
    }
    memcpy(&tuple_new, &slot, sizeof tuple_new); /* C has no cast for it */
    Py_INCREF(type);
    record->structure = count > 0 ? record->columns[0].field->structure : "";
    record->class = type;
    record->count = (int)count;
    class_count++;
    Py_RETURN_NONE;
}

PyObject *register_errors(PyObject *error_of) {
    static int64_t owner = -1;
    int64_t interpreter = PyInterpreterState_GetID(PyInterpreterState_Get());
    if (owner >= 0 && owner != interpreter) { /* its classes are static here */
        PyErr_SetString(PyExc_ImportError,
                        "roburoc4 is used by another interpreter of this process: use threads or "
                        "processes instead of subinterpreters");
        return NULL;
    }
    owner = interpreter;
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

static PyObject *plain_value_of(const field *f, const void *at) {
    switch (f->type) {
    case 's':
        return PyUnicode_DecodeFSDefault(at);
    case 'f':
        return f->count > 0 ? tuple_of_floats(at, f->count)
                            : PyFloat_FromDouble(shortest(*(const float *)at));
    case 'd':
        return PyFloat_FromDouble(*(const double *)at);
    case 'B':
        return PyLong_FromLong(*(const uint8_t *)at);
    case 'H':
        return PyLong_FromLong(*(const uint16_t *)at);
    case 'h':
        return PyLong_FromLong(*(const int16_t *)at);
    case 'i':
        return PyLong_FromLong(*(const int32_t *)at);
    case 'I':
        return PyLong_FromUnsignedLong(*(const uint32_t *)at);
    default:
        return PyLong_FromUnsignedLongLong(*(const uint64_t *)at);
    }
}

static PyObject *value_of(const column *column, const void *structure) {
    PyObject *meaning = NULL, *value;
    if (column->known != NULL && ((const uint8_t *)structure)[column->known->offset] == 0) {
        Py_RETURN_NONE;
    }
    value =
        plain_value_of(column->field, (const uint8_t *)structure + column->field->offset);
    if (value != NULL && column->meanings != Py_None) {
        meaning = PyDict_GetItemWithError(column->meanings, value);
    }
    if (meaning == NULL) {
        return value;
    }
    Py_DECREF(value);
    return Py_NewRef(meaning);
}

/* tuple.__new__ is called directly: the __new__ of a NamedTuple costs more than all the rest. */
static PyObject *record_new(const record_class *record, PyObject *values) {
    PyObject *arguments, *made = NULL;
    if (values == NULL) {
        return NULL;
    }
    arguments = PyTuple_Pack(1, values);
    Py_DECREF(values);
    if (arguments != NULL) {
        made = tuple_new((PyTypeObject *)record->class, arguments, NULL);
        Py_DECREF(arguments);
    }
    return made;
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

static PyObject *values_of(const record_class *record, const void *value, int more) {
    PyObject *tuple = PyTuple_New(record->count + more);
    for (int i = 0; tuple != NULL && i < record->count; i++) {
        tuple = put_item(tuple, i, value_of(&record->columns[i], value));
    }
    return tuple;
}

PyObject *record_of(const char *structure, const void *value) {
    const record_class *record = classes;
    while (strcmp(record->structure, structure) != 0) {
        record++; /* importing has registered it */
    }
    return record_new(record, values_of(record, value, 0));
}

PyObject *status_of_values(uint32_t service, PyObject *values) {
    return record_new(&classes[service - ROBUROC4_SERVICE_IOCARD], values);
}

PyObject *status_of_struct(uint32_t service, const void *value, uint64_t host_us, double utc_s) {
    const record_class *record = &classes[service - ROBUROC4_SERVICE_IOCARD];
    PyObject *values = values_of(record, value, 2);
    values = put_item(values, record->count, PyLong_FromUnsignedLongLong(host_us));
    return record_new(record, put_item(values, record->count + 1, PyFloat_FromDouble(utc_s)));
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

int take_text(PyObject *text, const char **out) {
    Py_ssize_t length = 0;
    *out = NULL;
    if (!PyUnicode_Check(text)) {
        (void)PyErr_Format(PyExc_TypeError, "%R is not a text", text);
        return -1;
    }
    *out = PyUnicode_AsUTF8AndSize(text, &length);
    if (*out != NULL && strlen(*out) != (size_t)length) {
        (void)PyErr_Format(PyExc_ValueError, "%R contains a NUL character", text);
        *out = NULL;
    }
    return *out != NULL ? 0 : -1;
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
