/* SPDX-License-Identifier: MIT
 *
 * Which of the codec's decoders a datagram is for, and the record of what it says.
 */
#include "native.h"

#include <string.h>

/* What bytes alone do not tell: ids of the services, and counts of the IO card's channels. */
typedef struct layout {
    uint32_t ids[ROBUROC4_SERVICE_COUNT];
    uint32_t analog_inputs, analog_outputs, digital_inputs, digital_outputs;
} layout;

typedef struct datagram {
    const uint8_t *data;
    size_t size;
    const layout *layout;
} datagram;

static const layout usual_layout = {{0, 1, 2, 3, 4, 5, 6}, 9, 0, 22, 8};

/* ---------------------------------------------------------------------------------- layout --- */

static int read_layout(PyObject *tuple, layout *out) {
    int values[9], i;
    if (!PyArg_ParseTuple(tuple, "iiiiiiiii;layout: give a roburoc4.Layout", &values[0], &values[1],
                          &values[2], &values[3], &values[4], &values[5], &values[6], &values[7],
                          &values[8])) {
        return -1;
    }
    *out = usual_layout;
    for (i = 0; i < 9; i++) {
        if (values[i] < 0 || (i < 5 && values[i] > UINT16_MAX)) {
            PyErr_SetString(PyExc_OverflowError, "layout");
            return -1;
        }
    }
    for (i = 0; i < 5; i++) {
        out->ids[ROBUROC4_SERVICE_IOCARD + i] = (uint32_t)values[i];
    }
    out->analog_inputs = (uint32_t)values[5];
    out->analog_outputs = (uint32_t)values[6];
    out->digital_inputs = (uint32_t)values[7];
    out->digital_outputs = (uint32_t)values[8];
    return 0;
}

static uint32_t service_of_id(const layout *layout, uint32_t id) {
    uint32_t service = 0;
    while (service < ROBUROC4_SERVICE_COUNT && layout->ids[service] != id) {
        service++;
    }
    return service;
}

/* ------------------------------------------------------------------------- structs and lists ---
 */

static PyObject *status_of(record_kind kind, const void *value) {
    return record_of_status(kind, value, 0, 0);
}

/* name() decodes a telegram that is one struct; a status did not arrive at any time. */
#define STRUCT(NAME, MAKE, KIND)                                                                   \
    static PyObject *NAME(const datagram *d) {                                                     \
        roburoc4_##NAME value;                                                                     \
        roburoc4_result result = roburoc4_decode_##NAME(d->data, d->size, &value);                 \
        return result < 0 ? raise_result(result) : MAKE(KIND, &value);                             \
    }
/* name() decodes a telegram that is a list. */
#define LIST(NAME, VIEW, ITEM, AT, KIND)                                                           \
    static PyObject *NAME(const datagram *d) {                                                     \
        VIEW list;                                                                                 \
        PyObject *tuple;                                                                           \
        uint32_t i;                                                                                \
        roburoc4_result result = roburoc4_decode_##NAME(d->data, d->size, &list);                  \
        if (result < 0) {                                                                          \
            return raise_result(result);                                                           \
        }                                                                                          \
        tuple = PyTuple_New(list.count);                                                           \
        for (i = 0; tuple != NULL && i < list.count; i++) {                                        \
            ITEM item;                                                                             \
            (void)AT(&list, i, &item);                                                             \
            (void)PyTuple_SetItem(tuple, i, record_of(KIND, &item));                               \
        }                                                                                          \
        return tuple;                                                                              \
    }

STRUCT(battery_status, status_of, RECORD_BATTERY_STATUS)
STRUCT(localization_status, status_of, RECORD_LOCALIZATION_STATUS)
STRUCT(differential_status, status_of, RECORD_DIFFERENTIAL_STATUS)
STRUCT(iocard_properties, record_of, RECORD_IOCARD_PROPERTIES)
STRUCT(battery_properties, record_of, RECORD_BATTERY_PROPERTIES)
STRUCT(localization_properties, record_of, RECORD_LOCALIZATION_PROPERTIES)
STRUCT(differential_properties, record_of, RECORD_DIFFERENTIAL_PROPERTIES)
STRUCT(differential_command, record_of, RECORD_DIFFERENTIAL_COMMAND)
STRUCT(request, record_of, RECORD_REQUEST)
LIST(directory, roburoc4_directory, roburoc4_directory_entry, roburoc4_directory_at,
     RECORD_DIRECTORY_ENTRY)
LIST(notification, roburoc4_notification, roburoc4_subscription, roburoc4_notification_at,
     RECORD_SUBSCRIPTION)
LIST(telemeter_properties, roburoc4_telemeter_list, roburoc4_telemeter, roburoc4_telemeter_at,
     RECORD_TELEMETER_PROPERTIES)

/* -------------------------------------------------------------------------------- statuses --- */

/* Room for the floats of a datagram, whose number is bounded by its size. */
static float *room_for_floats(uint32_t count) {
    float *floats = PyMem_Malloc((count + 1) * sizeof *floats);
    if (floats == NULL) {
        (void)PyErr_NoMemory();
    }
    return floats;
}

static PyObject *analog_values(const roburoc4_channels *channels) {
    float *values = room_for_floats(channels->analog_count);
    PyObject *tuple = NULL;
    if (values != NULL) {
        (void)roburoc4_floats(channels->analog, channels->analog_count, values,
                              channels->analog_count);
        tuple = tuple_of_floats(values, channels->analog_count);
        PyMem_Free(values);
    }
    return tuple;
}

static PyObject *iocard_status(const datagram *d) {
    roburoc4_channels status;
    roburoc4_result result = roburoc4_decode_iocard_status(
        d->data, d->size, d->layout->analog_inputs, d->layout->digital_inputs, &status);
    if (result < 0) {
        return raise_result(result);
    }
    return record_new(RECORD_IOCARD_STATUS,
                      Py_BuildValue("(KNNid)", (unsigned long long)status.robot_cycles,
                                    analog_values(&status),
                                    tuple_of_bits(status.digital, status.digital_count), 0, 0.0));
}

static PyObject *telemeter_status(const datagram *d) {
    roburoc4_telemeter_status status;
    float *values;
    PyObject *distances;
    roburoc4_result result = roburoc4_decode_telemeter_status(d->data, d->size, &status);
    if (result < 0) {
        return raise_result(result);
    }
    values = room_for_floats(status.count);
    if (values == NULL) {
        return NULL;
    }
    (void)roburoc4_floats(status.distances, status.count, values, status.count);
    distances = tuple_of_floats(values, status.count);
    PyMem_Free(values);
    return record_new(
        RECORD_TELEMETER_STATUS,
        Py_BuildValue("(KNid)", (unsigned long long)status.robot_cycles, distances, 0, 0.0));
}

static PyObject *unknown_status(const datagram *d, const roburoc4_status_header *header) {
    return record_new(RECORD_UNKNOWN_STATUS,
                      Py_BuildValue("(Kiy#)", (unsigned long long)header->robot_cycles,
                                    (int)header->service, (const char *)d->data + 11,
                                    (Py_ssize_t)d->size - 11));
}

static PyObject *status(const datagram *d) {
    roburoc4_status_header header;
    roburoc4_result result = roburoc4_decode_status_header(d->data, d->size, &header);
    if (result < 0) {
        return raise_result(result);
    }
    switch (service_of_id(d->layout, header.service)) {
    case ROBUROC4_SERVICE_IOCARD:
        return iocard_status(d);
    case ROBUROC4_SERVICE_TELEMETER:
        return telemeter_status(d);
    case ROBUROC4_SERVICE_BATTERY:
        return battery_status(d);
    case ROBUROC4_SERVICE_LOCALIZATION:
        return localization_status(d);
    case ROBUROC4_SERVICE_DIFFERENTIAL:
        return differential_status(d);
    default:
        return unknown_status(d, &header);
    }
}

/* --------------------------------------------------------------------------------- answers --- */

static PyObject *payload(const roburoc4_answer *answer) {
    return PyBytes_FromStringAndSize((const char *)answer->payload,
                                     (Py_ssize_t)answer->payload_size);
}

static PyObject *properties(const datagram *d, const roburoc4_answer *answer) {
    static PyObject *(*const decoders[ROBUROC4_SERVICE_COUNT])(const datagram *) = {
        directory,
        notification,
        iocard_properties,
        telemeter_properties,
        battery_properties,
        localization_properties,
        differential_properties};
    uint32_t service = service_of_id(d->layout, answer->service);
    return service < ROBUROC4_SERVICE_COUNT ? decoders[service](d) : payload(answer);
}

/* Its character set is not known: UTF-8 where it can be, else Latin-1, which any bytes are. */
static PyObject *text(const roburoc4_answer *answer) {
    const char *bytes = (const char *)answer->payload;
    Py_ssize_t size = (Py_ssize_t)answer->payload_size;
    PyObject *text = PyUnicode_DecodeUTF8(bytes, size, "strict");
    if (text == NULL && PyErr_ExceptionMatches(PyExc_UnicodeDecodeError)) {
        PyErr_Clear();
        text = PyUnicode_DecodeLatin1(bytes, size, "strict");
    }
    return text;
}

static PyObject *body(const datagram *d, const roburoc4_answer *answer) {
    if (answer->error == ROBUROC4_ERROR_NONE && answer->id != ROBUROC4_HEADER_ERROR) {
        if (answer->action == ROBUROC4_ACTION_GET) {
            return properties(d, answer);
        }
        if (answer->action == ROBUROC4_ACTION_QUERY) {
            return text(answer);
        }
    }
    return payload(answer);
}

static PyObject *answer(const datagram *d) {
    roburoc4_answer answer;
    PyObject *said;
    roburoc4_result result = roburoc4_decode_answer(d->data, d->size, &answer);
    if (result < 0) {
        return raise_result(result);
    }
    said = body(d, &answer);
    if (said == NULL) {
        return NULL;
    }
    return record_new(RECORD_ANSWER, Py_BuildValue("(iiiiN)", (int)answer.id, (int)answer.action,
                                                   (int)answer.service, (int)answer.error, said));
}

/* ------------------------------------------------------------------- what a client has sent --- */

static PyObject *iocard_command(const datagram *d) {
    roburoc4_channels command;
    roburoc4_result result = roburoc4_decode_iocard_command(
        d->data, d->size, d->layout->analog_outputs, d->layout->digital_outputs, &command);
    if (result < 0) {
        return raise_result(result);
    }
    return record_new(RECORD_IOCARD_COMMAND,
                      Py_BuildValue("(NN)", analog_values(&command),
                                    tuple_of_bits(command.digital, command.digital_count)));
}

static PyObject *command(const datagram *d) {
    roburoc4_channels header;
    roburoc4_result result = roburoc4_decode_iocard_command(d->data, d->size, 0, 0, &header);
    uint32_t service;
    if (result < 0) {
        return raise_result(result);
    }
    service = service_of_id(d->layout, header.service);
    if (service == ROBUROC4_SERVICE_IOCARD) {
        return iocard_command(d);
    }
    if (service == ROBUROC4_SERVICE_DIFFERENTIAL) {
        return differential_command(d);
    }
    return record_new(RECORD_UNKNOWN_COMMAND,
                      Py_BuildValue("(iy#)", (int)header.service, (const char *)d->data + 3,
                                    (Py_ssize_t)d->size - 3));
}

/* --------------------------------------------------------------------------------- choosing --- */

static PyObject *decode(const datagram *d, int from_client) {
    int is_marked = d->size > 0 && d->data[0] == ROBUROC4_HEADER_STATUS;
    if (from_client) {
        return is_marked ? command(d) : request(d);
    }
    return is_marked ? status(d) : answer(d);
}

PyObject *decode_telegram(PyObject *self, PyObject *const *arguments, Py_ssize_t count) {
    layout given;
    datagram d = {NULL, 0, &usual_layout};
    Py_buffer view;
    PyObject *record;
    int from_client;
    (void)self;
    if (count != 3) {
        PyErr_SetString(PyExc_TypeError, "decode takes data, layout and from_client");
        return NULL;
    }
    from_client = PyObject_IsTrue(arguments[2]);
    if (from_client < 0) {
        return NULL;
    }
    if (arguments[1] != Py_None) {
        if (read_layout(arguments[1], &given) < 0) {
            return NULL;
        }
        d.layout = &given;
    }
    if (PyObject_GetBuffer(arguments[0], &view, PyBUF_SIMPLE) < 0) {
        return NULL;
    }
    d.data = view.buf;
    d.size = (size_t)view.len;
    record = decode(&d, from_client);
    PyBuffer_Release(&view);
    return record;
}

/* --------------------------------------------------------------------------------- encoding --- */

PyObject *answer_bytes(uint8_t id, uint8_t action, uint16_t service, uint8_t error) {
    uint8_t buffer[16];
    roburoc4_result size =
        roburoc4_encode_answer(buffer, sizeof buffer, id, action, service, error);
    return size < 0 ? raise_result(size) : PyBytes_FromStringAndSize((const char *)buffer, size);
}

PyObject *restamped(PyObject *status, uint64_t robot_cycles) {
    roburoc4_status_header header;
    char *from;
    Py_ssize_t size;
    PyObject *bytes;
    roburoc4_result result;
    if (PyBytes_AsStringAndSize(status, &from, &size) < 0) {
        return NULL;
    }
    result = roburoc4_decode_status_header((const uint8_t *)from, (size_t)size, &header);
    if (result < 0) {
        return raise_result(result);
    }
    bytes = PyBytes_FromStringAndSize(from, size);
    if (bytes != NULL) {
        uint8_t *stamp = (uint8_t *)PyBytes_AsString(bytes) + 3;
        int i;
        for (i = 0; i < 8; i++) {
            stamp[i] = (uint8_t)(robot_cycles >> (8 * i));
        }
    }
    return bytes;
}
