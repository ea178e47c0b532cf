/* SPDX-License-Identifier: MIT
 *
 * Many statuses of one service to the rows of a NumPy table. Rows are packed and in the machine's
 * byte order: robot_cycles, then the fields of the service in the manual's order; a digital input
 * takes a byte.
 */
#include "native.h"

#include <string.h>

typedef struct batch batch;

/* Write the row of a status; 0 where it is none of this service. */
typedef int (*row_writer)(batch *b, const uint8_t *data, size_t size, uint8_t *row);

struct batch {
    row_writer write;
    uint32_t id; /* of the service, on the wire */
    uint32_t analog, digital; /* channels of the IO card; analog: telemeters */
    float *floats;            /* room for `analog` */
    uint8_t *rows;
    size_t row, capacity; /* bytes of a row, rows that there is room for */
    size_t good, index;
    PyObject *bad;
};

/* ------------------------------------------------------------------------- a row by service --- */

static uint8_t *put(uint8_t *at, const void *value, size_t size) {
    memcpy(at, value, size);
    return at + size;
}

static int write_iocard(batch *b, const uint8_t *data, size_t size, uint8_t *row) {
    roburoc4_channels status;
    uint32_t i;
    if (roburoc4_decode_iocard_status(data, size, b->analog, b->digital, &status) < 0 ||
        status.service != b->id) {
        return 0;
    }
    (void)roburoc4_analog_values(&status, b->floats, b->analog);
    row = put(row, &status.robot_cycles, sizeof status.robot_cycles);
    row = put(row, b->floats, b->analog * sizeof *b->floats);
    for (i = 0; i < b->digital; i++) {
        *row++ = status.digital[i / 8] >> i % 8 & 1;
    }
    return 1;
}

static int write_telemeter(batch *b, const uint8_t *data, size_t size, uint8_t *row) {
    roburoc4_telemeter_status status;
    if (roburoc4_decode_telemeter_status(data, size, &status) < 0 || status.service != b->id ||
        status.count != b->analog) {
        return 0;
    }
    (void)roburoc4_telemeter_distances(&status, b->floats, b->analog);
    row = put(row, &status.robot_cycles, sizeof status.robot_cycles);
    (void)put(row, b->floats, b->analog * sizeof *b->floats);
    return 1;
}

/* write_name() for a status that is one struct. */
#define WRITE(NAME, KIND)                                                                          \
    static int write_##NAME(batch *b, const uint8_t *data, size_t size, uint8_t *row) {            \
        roburoc4_##NAME##_status status;                                                           \
        if (roburoc4_decode_##NAME##_status(data, size, &status) < 0 || status.service != b->id) { \
            return 0;                                                                              \
        }                                                                                          \
        (void)pack(KIND, &status, row);                                                            \
        return 1;                                                                                  \
    }
WRITE(battery, RECORD_BATTERY_STATUS)
WRITE(localization, RECORD_LOCALIZATION_STATUS)
WRITE(differential, RECORD_DIFFERENTIAL_STATUS)

/* What writes the rows of a service, and how long they are. */
static row_writer writer_of(uint32_t service, const batch *b, size_t *row) {
    switch (service) {
    case ROBUROC4_SERVICE_IOCARD:
        *row = 8 + sizeof(float) * b->analog + b->digital;
        return write_iocard;
    case ROBUROC4_SERVICE_TELEMETER:
        *row = 8 + sizeof(float) * b->analog;
        return write_telemeter;
    case ROBUROC4_SERVICE_BATTERY:
        *row = pack(RECORD_BATTERY_STATUS, NULL, NULL);
        return write_battery;
    case ROBUROC4_SERVICE_LOCALIZATION:
        *row = pack(RECORD_LOCALIZATION_STATUS, NULL, NULL);
        return write_localization;
    default:
        *row = pack(RECORD_DIFFERENTIAL_STATUS, NULL, NULL);
        return write_differential;
    }
}

/* ----------------------------------------------------------------------------- all of them --- */

static int note_bad(batch *b) {
    PyObject *index = PyLong_FromSize_t(b->index);
    int result = index != NULL ? PyList_Append(b->bad, index) : -1;
    Py_XDECREF(index);
    return result;
}

static int take(batch *b, const uint8_t *data, size_t size) {
    int result = 0;
    if (b->good < b->capacity && b->write(b, data, size, b->rows + b->good * b->row)) {
        b->good++;
    } else {
        result = note_bad(b);
    }
    b->index++;
    return result;
}

static int take_buffer(batch *b, PyObject *source, size_t size) {
    Py_buffer view;
    size_t at;
    int result = 0;
    if (PyObject_GetBuffer(source, &view, PyBUF_SIMPLE) < 0) {
        return -1;
    }
    for (at = 0; result == 0 && at + size <= (size_t)view.len; at += size) {
        result = take(b, (const uint8_t *)view.buf + at, size);
    }
    PyBuffer_Release(&view);
    return result;
}

static int take_sequence(batch *b, PyObject *source) {
    Py_ssize_t count = PySequence_Size(source), i;
    int result = count < 0 ? -1 : 0;
    for (i = 0; result == 0 && i < count; i++) {
        Py_buffer view;
        PyObject *item = PySequence_GetItem(source, i);
        if (item == NULL) {
            return -1;
        }
        result = PyObject_GetBuffer(item, &view, PyBUF_SIMPLE);
        if (result == 0) {
            result = take(b, view.buf, (size_t)view.len);
            PyBuffer_Release(&view);
        }
        Py_DECREF(item);
    }
    return result;
}

PyObject *batch_decode(PyObject *source, size_t size, uint32_t service, uint32_t id,
                       uint32_t analog, uint32_t digital, PyObject *rows, size_t row) {
    batch b;
    Py_buffer view;
    size_t needed = 0;
    int result;
    memset(&b, 0, sizeof b);
    b.id = id;
    b.analog = analog;
    b.digital = digital;
    b.row = row;
    b.write = writer_of(service, &b, &needed);
    if (needed != row) {
        PyErr_SetString(PyExc_ValueError, "batch_decode: rows do not fit the service");
        return NULL;
    }
    if (PyObject_GetBuffer(rows, &view, PyBUF_WRITABLE) < 0) {
        return NULL;
    }
    b.rows = view.buf;
    b.capacity = (size_t)view.len / row;
    b.bad = PyList_New(0);
    b.floats = PyMem_Malloc(((size_t)analog + 1) * sizeof *b.floats);
    if (b.floats == NULL) {
        (void)PyErr_NoMemory();
    }
    result = b.bad == NULL || b.floats == NULL ? -1
             : size > 0                        ? take_buffer(&b, source, size)
                                               : take_sequence(&b, source);
    PyMem_Free(b.floats);
    PyBuffer_Release(&view);
    if (result < 0) {
        Py_CLEAR(b.bad);
    }
    return b.bad;
}
