/* SPDX-License-Identifier: MIT
 *
 * Statuses, the most frequent telegrams, to records: those that a client has, and those in
 * datagrams. telegrams.py decodes all other telegrams.
 */
#include "native.h"

/* What the bytes do not contain, in the order of Layout in telegrams.py: ids of the services that
 * send statuses, and counts of the IO card's channels. */
enum {
    IDS = STATUS_SERVICES,
    ANALOG_INPUTS = IDS,
    ANALOG_OUTPUTS,
    DIGITAL_INPUTS,
    DIGITAL_OUTPUTS,
    NUMBERS
};

static const int usual_layout[NUMBERS] = {2, 3, 4, 5, 6, 9, 0, 22, 8};

static PyObject *iocard_status(uint64_t robot_cycles, PyObject *analog, PyObject *digital,
                               uint64_t host_us, double utc_s) {
    PyObject *values = put_item(PyTuple_New(5), 0, PyLong_FromUnsignedLongLong(robot_cycles));
    values = put_item(put_item(values, 1, analog), 2, digital);
    values = put_item(values, 3, PyLong_FromUnsignedLongLong(host_us));
    return status_of_values(ROBUROC4_SERVICE_IOCARD,
                            put_item(values, 4, PyFloat_FromDouble(utc_s)));
}

static PyObject *telemeter_status(uint64_t robot_cycles, PyObject *distances, uint64_t host_us,
                                  double utc_s) {
    PyObject *values = put_item(PyTuple_New(4), 0, PyLong_FromUnsignedLongLong(robot_cycles));
    values = put_item(values, 1, distances);
    values = put_item(values, 2, PyLong_FromUnsignedLongLong(host_us));
    return status_of_values(ROBUROC4_SERVICE_TELEMETER,
                            put_item(values, 3, PyFloat_FromDouble(utc_s)));
}

static PyObject *tuple_of_digital_inputs(const roburoc4_inputs *inputs) {
    uint8_t blocks[8];
    for (int i = 0; i < 8; i++) {
        blocks[i] = (uint8_t)(inputs->digital >> 8 * i);
    }
    return tuple_of_bits(blocks, inputs->digital_count);
}

PyObject *record_of_sample(const roburoc4_sample *sample, double utc_s) {
    const roburoc4_inputs *inputs = &sample->value.inputs;
    const roburoc4_distances *distances = &sample->value.distances;
    switch (sample->service) {
    case ROBUROC4_SERVICE_IOCARD:
        return iocard_status(sample->robot_cycles,
                             tuple_of_floats(inputs->analog, inputs->analog_count),
                             tuple_of_digital_inputs(inputs), sample->host_us, utc_s);
    case ROBUROC4_SERVICE_TELEMETER:
        return telemeter_status(sample->robot_cycles,
                                tuple_of_floats(distances->distances_m, distances->count),
                                sample->host_us, utc_s);
    default:
        return status_of_struct(sample->service, &sample->value, sample->host_us, utc_s);
    }
}

/* ---------------------------------------------------------------------------- in datagrams --- */

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

static PyObject *decode(uint32_t service, const uint8_t *data, size_t size,
                        const int layout[NUMBERS]) {
    union {
        roburoc4_channels iocard;
        roburoc4_telemeter_status telemeter;
        roburoc4_battery_status battery;
        roburoc4_localization_status localization;
        roburoc4_differential_status differential;
    } s;
    roburoc4_result result;
    switch (service) {
    case ROBUROC4_SERVICE_IOCARD:
        result = roburoc4_decode_iocard_status(data, size, (uint32_t)layout[ANALOG_INPUTS],
                                               (uint32_t)layout[DIGITAL_INPUTS], &s.iocard);
        return result < 0
                   ? raise_result(result)
                   : iocard_status(s.iocard.robot_cycles,
                                   tuple_of_view(s.iocard.analog, s.iocard.analog_count),
                                   tuple_of_bits(s.iocard.digital, s.iocard.digital_count), 0, 0.0);
    case ROBUROC4_SERVICE_TELEMETER:
        result = roburoc4_decode_telemeter_status(data, size, &s.telemeter);
        return result < 0
                   ? raise_result(result)
                   : telemeter_status(s.telemeter.robot_cycles,
                                      tuple_of_view(s.telemeter.distances, s.telemeter.count), 0,
                                      0.0);
    case ROBUROC4_SERVICE_BATTERY:
        result = roburoc4_decode_battery_status(data, size, &s.battery);
        break;
    case ROBUROC4_SERVICE_LOCALIZATION:
        result = roburoc4_decode_localization_status(data, size, &s.localization);
        break;
    default:
        result = roburoc4_decode_differential_status(data, size, &s.differential);
        break;
    }
    return result < 0 ? raise_result(result) : status_of_struct(service, &s, 0, 0.0);
}

static PyObject *decode_known(const uint8_t *data, size_t size, const int layout[NUMBERS]) {
    roburoc4_status_header header;
    roburoc4_result result;
    if (size == 0 || data[0] != ROBUROC4_HEADER_STATUS) {
        Py_RETURN_NONE;
    }
    result = roburoc4_decode_status_header(data, size, &header);
    if (result < 0) {
        return raise_result(result);
    }
    for (uint32_t i = 0; i < IDS; i++) {
        if (layout[i] == header.service) {
            return decode(ROBUROC4_SERVICE_IOCARD + i, data, size, layout);
        }
    }
    Py_RETURN_NONE;
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
    record = decode_known(data.buf, (size_t)data.len, given);
    PyBuffer_Release(&data);
    return record;
}
