/* SPDX-License-Identifier: MIT
 *
 * Samples are copied in small handfuls: the interpreter is not held up for long, and no memory is
 * allocated for what nobody asked for.
 */
#include "samples.h"

#include "raise.h"

#define HANDFUL 64

static PyObject *record_of_sample(const roburoc4_sample *sample) {
    switch (sample->service) {
    case ROBUROC4_SERVICE_IOCARD:
        return record_of_inputs(&sample->value.inputs, sample->host_us);
    case ROBUROC4_SERVICE_TELEMETER:
        return record_of_distances(&sample->value.distances, sample->host_us);
    case ROBUROC4_SERVICE_BATTERY:
        return record_of_battery(&sample->value.battery, sample->host_us);
    case ROBUROC4_SERVICE_LOCALIZATION:
        return record_of_localization(&sample->value.localization, sample->host_us);
    default:
        return record_of_differential(&sample->value.differential, sample->host_us);
    }
}

static int append(PyObject *list, const roburoc4_sample *sample) {
    PyObject *record = record_of_sample(sample);
    int result = record != NULL ? PyList_Append(list, record) : -1;
    Py_XDECREF(record);
    return result;
}

PyObject *samples_read(roburoc4_pump *pump, roburoc4_pump_reader *reader, uint32_t mask) {
    roburoc4_sample samples[HANDFUL];
    roburoc4_result got = roburoc4_pump_read_samples(pump, reader, samples, HANDFUL);
    PyObject *list;
    roburoc4_result i;
    if (got < 0) {
        return raise_result(got);
    }
    if (got == 0) {
        Py_RETURN_NONE;
    }
    list = PyList_New(0);
    for (i = 0; list != NULL && i < got; i++) {
        if ((mask >> samples[i].service & 1u) != 0 && append(list, &samples[i]) < 0) {
            Py_CLEAR(list);
        }
    }
    return list;
}
