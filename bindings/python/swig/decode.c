/* SPDX-License-Identifier: MIT
 *
 * Statuses, the most frequent telegrams, to records. telegrams.py decodes all others.
 */
#include "native.h"

/* What bytes alone do not tell, in the order of Layout in telegrams.py: ids of the services that
 * send statuses, and counts of the IO card's channels. */
enum { IDS = 5, ANALOG_INPUTS = IDS, ANALOG_OUTPUTS, DIGITAL_INPUTS, DIGITAL_OUTPUTS, NUMBERS };

static const int usual_layout[NUMBERS] = {2, 3, 4, 5, 6, 9, 0, 22, 8};

static int read_layout(PyObject *tuple, int out[NUMBERS]) {
    if (!PyArg_ParseTuple(tuple, "iiiiiiiii;layout: give a roburoc4.Layout", &out[0], &out[1],
                          &out[2], &out[3], &out[4], &out[5], &out[6], &out[7], &out[8])) {
        return -1;
    }
    for (int i = 0; i < NUMBERS; i++) {
        if (out[i] < 0 || (i < IDS && out[i] > UINT16_MAX)) {
            PyErr_SetString(PyExc_OverflowError, "layout");
            return -1;
        }
    }
    return 0;
}

static PyObject *iocard_status(const Py_buffer *data, const int layout[NUMBERS]) {
    roburoc4_channels s;
    PyObject *values;
    roburoc4_result result =
        roburoc4_decode_iocard_status(data->buf, (size_t)data->len, (uint32_t)layout[ANALOG_INPUTS],
                                      (uint32_t)layout[DIGITAL_INPUTS], &s);
    if (result < 0) {
        return raise_result(result);
    }
    values = put_item(PyTuple_New(5), 0, PyLong_FromUnsignedLongLong(s.robot_cycles));
    values = put_item(values, 1, tuple_of_view(s.analog, s.analog_count));
    values = put_item(values, 2, tuple_of_bits(s.digital, s.digital_count));
    values = put_item(values, 3, PyLong_FromLong(0));
    return record_new(RECORD_IOCARD_STATUS, put_item(values, 4, PyFloat_FromDouble(0.0)));
}

static PyObject *telemeter_status(const Py_buffer *data) {
    roburoc4_telemeter_status s;
    roburoc4_result result = roburoc4_decode_telemeter_status(data->buf, (size_t)data->len, &s);
    if (result < 0) {
        return raise_result(result);
    }
    return record_new(RECORD_TELEMETER_STATUS,
                      Py_BuildValue("(KNid)", (unsigned long long)s.robot_cycles,
                                    tuple_of_view(s.distances, s.count), 0, 0.0));
}

/* name(): the record of a status that is one struct. */
#define STATUS(NAME, KIND)                                                                         \
    static PyObject *NAME(const Py_buffer *data) {                                                 \
        roburoc4_##NAME s;                                                                         \
        roburoc4_result result = roburoc4_decode_##NAME(data->buf, (size_t)data->len, &s);         \
        return result < 0 ? raise_result(result) : record_of_status(KIND, &s, 0, 0);               \
    }
STATUS(battery_status, RECORD_BATTERY_STATUS)
STATUS(localization_status, RECORD_LOCALIZATION_STATUS)
STATUS(differential_status, RECORD_DIFFERENTIAL_STATUS)

static PyObject *status(const Py_buffer *data, const int layout[NUMBERS]) {
    roburoc4_status_header header;
    roburoc4_result result;
    int kind = RECORD_IOCARD_STATUS;
    if (data->len == 0 || *(const uint8_t *)data->buf != ROBUROC4_HEADER_STATUS) {
        Py_RETURN_NONE;
    }
    result = roburoc4_decode_status_header(data->buf, (size_t)data->len, &header);
    if (result < 0) {
        return raise_result(result);
    }
    while (kind < IDS && layout[kind] != header.service) {
        kind++;
    }
    switch (kind) {
    case RECORD_IOCARD_STATUS:
        return iocard_status(data, layout);
    case RECORD_TELEMETER_STATUS:
        return telemeter_status(data);
    case RECORD_BATTERY_STATUS:
        return battery_status(data);
    case RECORD_LOCALIZATION_STATUS:
        return localization_status(data);
    case RECORD_DIFFERENTIAL_STATUS:
        return differential_status(data);
    default:
        Py_RETURN_NONE;
    }
}

PyObject *decode_status(PyObject *self, PyObject *const *arguments, Py_ssize_t count) {
    int layout[NUMBERS];
    const int *given = usual_layout;
    Py_buffer data;
    PyObject *record;
    (void)self;
    if (count != 2) {
        PyErr_SetString(PyExc_TypeError, "decode_status takes data and layout");
        return NULL;
    }
    if (arguments[1] != Py_None) {
        if (read_layout(arguments[1], layout) < 0) {
            return NULL;
        }
        given = layout;
    }
    if (PyObject_GetBuffer(arguments[0], &data, PyBUF_SIMPLE) < 0) {
        return NULL;
    }
    record = status(&data, given);
    PyBuffer_Release(&data);
    return record;
}
