/* SPDX-License-Identifier: MIT
 *
 * Rows are packed and in the machine's byte order, as codec.py tells NumPy: robot_cycles, then the
 * fields of the service in the manual's order; a digital input takes a byte.
 */
#include "batch.h"

#include <string.h>

#include "decode.h"

typedef struct batch {
    batch_shape shape;
    uint8_t *rows;
    size_t capacity; /* rows that there is room for */
    size_t good, index;
    PyObject *bad;
} batch;

static uint8_t *put(uint8_t *at, const void *value, size_t size) {
    memcpy(at, value, size);
    return at + size;
}

/* ------------------------------------------------------------------------- a row by service --- */

static roburoc4_result iocard_row(const batch_shape *shape, const uint8_t *data, size_t size,
                                  uint8_t *row) {
    roburoc4_channels status;
    uint32_t i;
    roburoc4_result result =
        roburoc4_decode_iocard_status(data, size, shape->analog, shape->digital, &status);
    if (result < 0 || status.service != shape->id) {
        return ROBUROC4_ERR_KIND;
    }
    row = put(row, &status.robot_cycles, sizeof status.robot_cycles);
    for (i = 0; i < shape->analog; i++) {
        const float value = channels_analog(&status, i);
        row = put(row, &value, sizeof value);
    }
    for (i = 0; i < shape->digital; i++) {
        *row++ = (uint8_t)channels_digital(&status, i);
    }
    return ROBUROC4_OK;
}

static roburoc4_result telemeter_row(const batch_shape *shape, const uint8_t *data, size_t size,
                                     uint8_t *row) {
    roburoc4_telemeter_status status;
    uint32_t i;
    roburoc4_result result = roburoc4_decode_telemeter_status(data, size, &status);
    if (result < 0 || status.service != shape->id || status.count != shape->analog) {
        return ROBUROC4_ERR_KIND;
    }
    row = put(row, &status.robot_cycles, sizeof status.robot_cycles);
    for (i = 0; i < shape->analog; i++) {
        const float value = distances_at(&status, i);
        row = put(row, &value, sizeof value);
    }
    return ROBUROC4_OK;
}

static roburoc4_result battery_row(const batch_shape *shape, const uint8_t *data, size_t size,
                                   uint8_t *row) {
    roburoc4_battery_status status;
    roburoc4_result result = roburoc4_decode_battery_status(data, size, &status);
    if (result < 0 || status.service != shape->id) {
        return ROBUROC4_ERR_KIND;
    }
    row = put(row, &status.robot_cycles, sizeof status.robot_cycles);
    row = put(row, &status.state, 1);
    (void)put(row, &status.remaining_percent, 1);
    return ROBUROC4_OK;
}

static roburoc4_result localization_row(const batch_shape *shape, const uint8_t *data, size_t size,
                                        uint8_t *row) {
    roburoc4_localization_status status;
    roburoc4_result result = roburoc4_decode_localization_status(data, size, &status);
    if (result < 0 || status.service != shape->id) {
        return ROBUROC4_ERR_KIND;
    }
    row = put(row, &status.robot_cycles, sizeof status.robot_cycles);
    row = put(row, &status.x_m, sizeof status.x_m);
    row = put(row, &status.y_m, sizeof status.y_m);
    row = put(row, &status.theta_rad, sizeof status.theta_rad);
    (void)put(row, &status.flags, sizeof status.flags);
    return ROBUROC4_OK;
}

static roburoc4_result differential_row(const batch_shape *shape, const uint8_t *data, size_t size,
                                        uint8_t *row) {
    roburoc4_differential_status status;
    roburoc4_result result = roburoc4_decode_differential_status(data, size, &status);
    if (result < 0 || status.service != shape->id) {
        return ROBUROC4_ERR_KIND;
    }
    row = put(row, &status.robot_cycles, sizeof status.robot_cycles);
    row = put(row, &status.target_linear_m_s, sizeof(float));
    row = put(row, &status.current_linear_m_s, sizeof(float));
    row = put(row, &status.target_angular_rad_s, sizeof(float));
    (void)put(row, &status.current_angular_rad_s, sizeof(float));
    return ROBUROC4_OK;
}

typedef roburoc4_result (*row_writer)(const batch_shape *, const uint8_t *, size_t, uint8_t *);

static row_writer writer_of(const batch_shape *shape, size_t *row) {
    switch (shape->service) {
    case ROBUROC4_SERVICE_IOCARD:
        *row = 8 + (size_t)4 * shape->analog + shape->digital;
        return iocard_row;
    case ROBUROC4_SERVICE_TELEMETER:
        *row = 8 + (size_t)4 * shape->analog;
        return telemeter_row;
    case ROBUROC4_SERVICE_BATTERY:
        *row = 8 + 2;
        return battery_row;
    case ROBUROC4_SERVICE_LOCALIZATION:
        *row = 8 + 3 * 8 + 4;
        return localization_row;
    case ROBUROC4_SERVICE_DIFFERENTIAL:
        *row = 8 + 4 * 4;
        return differential_row;
    default:
        return NULL;
    }
}

/* ------------------------------------------------------------------------------- all of them ---
 */

static int note_bad(batch *b) {
    PyObject *index = PyLong_FromSize_t(b->index);
    int result = index != NULL ? PyList_Append(b->bad, index) : -1;
    Py_XDECREF(index);
    return result;
}

static int take(batch *b, row_writer write, const uint8_t *data, size_t size) {
    int result = 0;
    if (b->good < b->capacity &&
        write(&b->shape, data, size, b->rows + b->good * b->shape.row) >= 0) {
        b->good++;
    } else {
        result = note_bad(b);
    }
    b->index++;
    return result;
}

static int take_buffer(batch *b, row_writer write, PyObject *source, size_t size) {
    Py_buffer view;
    size_t at;
    int result = 0;
    if (PyObject_GetBuffer(source, &view, PyBUF_SIMPLE) < 0) {
        return -1;
    }
    for (at = 0; result == 0 && at + size <= (size_t)view.len; at += size) {
        result = take(b, write, (const uint8_t *)view.buf + at, size);
    }
    PyBuffer_Release(&view);
    return result;
}

static int take_sequence(batch *b, row_writer write, PyObject *source) {
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
            result = take(b, write, view.buf, (size_t)view.len);
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
    row_writer write;
    int result;
    memset(&b, 0, sizeof b);
    b.shape.service = service;
    b.shape.id = id;
    b.shape.analog = analog;
    b.shape.digital = digital;
    b.shape.row = row;
    write = writer_of(&b.shape, &needed);
    if (write == NULL || needed != row) {
        PyErr_SetString(PyExc_ValueError, "batch_decode: rows do not fit the service");
        return NULL;
    }
    if (PyObject_GetBuffer(rows, &view, PyBUF_WRITABLE) < 0) {
        return NULL;
    }
    b.rows = view.buf;
    b.capacity = (size_t)view.len / row;
    b.bad = PyList_New(0);
    result = b.bad == NULL ? -1
             : size > 0    ? take_buffer(&b, write, source, size)
                           : take_sequence(&b, write, source);
    PyBuffer_Release(&view);
    if (result < 0) {
        Py_CLEAR(b.bad);
    }
    return b.bad;
}
