/* SPDX-License-Identifier: MIT
 *
 * See helpers.h.
 */
#define PY_SSIZE_T_CLEAN
#include "helpers.h"

#include <stdlib.h>

#include "raise.h"

#define MAX_ARGUMENTS 64

int roburoc4_sim_main(int count, char **arguments); /* main() of sim/main.c */

/* ---------------------------------------------------------------------------------- memory --- */

roburoc4_address *new_address(void) {
    return calloc(1, sizeof(roburoc4_address));
}

roburoc4_config *new_config(void) {
    roburoc4_config *config = calloc(1, sizeof *config);
    if (config != NULL) {
        (void)roburoc4_config_init(config, sizeof *config);
    }
    return config;
}

roburoc4_client *new_client(void) {
    return calloc(1, sizeof(roburoc4_client));
}

roburoc4_udp *new_udp(void) {
    return calloc(1, sizeof(roburoc4_udp));
}

roburoc4_pump_reader *new_reader(void) {
    return calloc(1, sizeof(roburoc4_pump_reader));
}

roburoc4_sim_config *new_sim_config(void) {
    roburoc4_sim_config *config = calloc(1, sizeof *config);
    if (config != NULL) {
        roburoc4_sim_config_init(config);
    }
    return config;
}

roburoc4_sim_faults *new_faults(void) {
    return calloc(1, sizeof(roburoc4_sim_faults));
}

static void free_memory(PyObject *owner) {
    free(PyCapsule_GetPointer(owner, NULL));
}

static void destroy_pump(PyObject *owner) {
    roburoc4_pump *pump = PyCapsule_GetPointer(owner, NULL);
    Py_BEGIN_ALLOW_THREADS;
    roburoc4_pump_destroy(pump);
    Py_END_ALLOW_THREADS;
}

static void destroy_sim(PyObject *owner) {
    roburoc4_sim_destroy(PyCapsule_GetPointer(owner, NULL));
}

static void destroy_channel(PyObject *owner) {
    roburoc4_sim_channel_destroy(PyCapsule_GetPointer(owner, NULL));
}

static void destroy_host(PyObject *owner) {
    sim_host *host = PyCapsule_GetPointer(owner, NULL);
    Py_BEGIN_ALLOW_THREADS;
    sim_host_destroy(host);
    Py_END_ALLOW_THREADS;
}

static PyObject *own(void *thing, PyCapsule_Destructor destructor) {
    return thing != NULL ? PyCapsule_New(thing, NULL, destructor) : PyErr_NoMemory();
}

PyObject *own_memory(void *memory) {
    return own(memory, free_memory);
}

PyObject *own_pump(roburoc4_pump *pump) {
    return own(pump, destroy_pump);
}

PyObject *own_sim(roburoc4_sim *sim) {
    return own(sim, destroy_sim);
}

PyObject *own_channel(roburoc4_sim_channel *channel) {
    return own(channel, destroy_channel);
}

PyObject *own_host(sim_host *host) {
    return own(host, destroy_host);
}

/* -------------------------------------------------------------------------------- settings --- */

roburoc4_result config_set_period(roburoc4_config *config, uint32_t service, uint16_t period_ms) {
    if (service < ROBUROC4_SERVICE_IOCARD || service >= ROBUROC4_SERVICE_COUNT) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    config->period_ms[service] = period_ms;
    return ROBUROC4_OK;
}

roburoc4_result config_set_role(roburoc4_config *config, uint32_t role, int16_t index) {
    if (role >= ROBUROC4_ROLE_COUNT) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    config->role_index[role] = index;
    return ROBUROC4_OK;
}

roburoc4_result sim_config_set_id(roburoc4_sim_config *config, uint32_t service, uint16_t id) {
    if (service >= ROBUROC4_SERVICE_COUNT) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    config->service_ids[service] = id;
    return ROBUROC4_OK;
}

/* ------------------------------------------------------------------- several things at once --- */

uint64_t reader_lost(const roburoc4_pump_reader *reader) {
    return reader->lost;
}

PyObject *udp_receive(roburoc4_udp *udp, roburoc4_client *client) {
    const uint8_t *datagram = NULL;
    size_t size = 0;
    roburoc4_result result = roburoc4_udp_receive_one(udp, client, &datagram, &size);
    if (result < 0) {
        return raise_result(result);
    }
    return Py_BuildValue("(iy#)", (int)result, size > 0 ? (const char *)datagram : "",
                         (Py_ssize_t)size);
}

PyObject *client_describe(const roburoc4_client *client, PyObject *datagram) {
    roburoc4_description description;
    Py_buffer view;
    PyObject *described = Py_None;
    if (PyObject_GetBuffer(datagram, &view, PyBUF_SIMPLE) < 0) {
        return NULL;
    }
    if (roburoc4_client_description(client, view.buf, (size_t)view.len, &description) >= 0) {
        described = Py_BuildValue("(iIy#)", (int)description.io_type, description.index,
                                  (const char *)description.text, (Py_ssize_t)description.length);
    } else {
        Py_INCREF(described);
    }
    PyBuffer_Release(&view);
    return described;
}

PyObject *sim_host_call(sim_host *host, PyObject *function, PyObject *arguments) {
    PyObject *result;
    Py_BEGIN_ALLOW_THREADS;
    sim_host_lock(host);
    Py_END_ALLOW_THREADS;
    result = PyObject_CallObject(function, arguments);
    sim_host_unlock(host);
    return result;
}

PyObject *sim_panel(roburoc4_sim *sim, const char *line) {
    char reply[ROBUROC4_SIM_REPLY] = "";
    roburoc4_result result = roburoc4_sim_panel(sim, line, reply, sizeof reply);
    return Py_BuildValue("(is)", (int)result, reply);
}

/* --------------------------------------------------------------------------------- program --- */

PyObject *run_sim(PyObject *arguments) {
    PyObject *texts[MAX_ARGUMENTS] = {NULL};
    char *pointers[MAX_ARGUMENTS + 1] = {NULL};
    Py_ssize_t count = PyList_Size(arguments), i;
    int status = -1;
    if (count < 0 || count > MAX_ARGUMENTS) {
        PyErr_SetString(PyExc_ValueError, "run_sim: give a list of at most 64 arguments");
        return NULL;
    }
    for (i = 0; i < count; i++) {
        texts[i] = PyUnicode_EncodeFSDefault(PyList_GetItem(arguments, i));
        pointers[i] = texts[i] != NULL ? PyBytes_AsString(texts[i]) : NULL;
        if (pointers[i] == NULL) {
            break;
        }
    }
    if (i == count) {
        Py_BEGIN_ALLOW_THREADS;
        status = roburoc4_sim_main((int)count, pointers);
        Py_END_ALLOW_THREADS;
    }
    for (i = 0; i < count; i++) {
        Py_XDECREF(texts[i]);
    }
    return PyErr_Occurred() != NULL ? NULL : PyLong_FromLong(status);
}
