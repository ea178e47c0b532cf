/* SPDX-License-Identifier: MIT
 *
 * One client, and who moves its datagrams: a pump's thread, the user of a socket, or virtual time.
 * Every call of a client is made between connection_enter() and connection_leave(). The interpreter
 * lock is held from one to the other, so no Python code runs while a pump is locked.
 */
#include "native.h"

#include <stdlib.h>

/* Samples that are copied from a pump at once: the interpreter is not held up for long. */
#define SAMPLES_AT_ONCE 64

struct connection {
    roburoc4_pump *pump; /* has a client and a socket of its own; or NULL, then: */
    roburoc4_client client;
    roburoc4_world *world; /* moves the client; or NULL, then: */
    roburoc4_udp udp;
    PyObject *world_owner;
    uint32_t number; /* in the world */
    uint32_t forks; /* of the process that made it */
    char address[ROBUROC4_ADDRESS_TEXT_SIZE];
};

static uint32_t forks;

/* The call that is being made. */
static connection *entered;
static int entered_for_command;

/* ------------------------------------------------------------------------------------ opening --- */

static connection *allocate(void) {
    connection *c = calloc(1, sizeof *c);
    if (c == NULL) {
        (void)PyErr_NoMemory();
    } else {
        c->forks = forks;
    }
    return c;
}

/* Resolve the address and run `open` without the interpreter's lock: names take their time. */
static connection *connect_host(const char *host, const roburoc4_config *config, uint32_t capacity,
                                roburoc4_result (*open)(connection *, const roburoc4_address *,
                                                        const roburoc4_config *, uint32_t)) {
    connection *c = allocate();
    roburoc4_address address;
    roburoc4_result result;
    if (c == NULL) {
        return NULL;
    }
    Py_BEGIN_ALLOW_THREADS;
    result = roburoc4_udp_resolve(host, 0, &address);
    if (result >= 0) {
        (void)roburoc4_udp_address_text(&address, c->address, sizeof c->address);
        result = open(c, &address, config, capacity);
    }
    Py_END_ALLOW_THREADS;
    if (result < 0) {
        (void)raise_result(result);
        connection_destroy(c);
        c = NULL;
    }
    return c;
}

static roburoc4_result open_pump(connection *c, const roburoc4_address *address,
                                 const roburoc4_config *config, uint32_t capacity) {
    roburoc4_result result = ROBUROC4_OK;
    c->pump = roburoc4_pump_create(address, config, capacity, &result);
    return result;
}

static roburoc4_result open_socket(connection *c, const roburoc4_address *address,
                                   const roburoc4_config *config, uint32_t capacity) {
    roburoc4_result result = roburoc4_client_init(&c->client, sizeof c->client, config);
    (void)capacity;
    if (result >= 0) {
        result = roburoc4_udp_open(&c->udp, sizeof c->udp, address);
    }
    if (result >= 0) {
        (void)roburoc4_client_start(&c->client, roburoc4_udp_now_us());
    }
    return result;
}

connection *connect_pump(const char *host, const roburoc4_config *config, uint32_t capacity) {
    return connect_host(host, config, capacity, open_pump);
}

connection *connect_socket(const char *host, const roburoc4_config *config) {
    return connect_host(host, config, 0, open_socket);
}

connection *connect_virtual(PyObject *owner, const roburoc4_config *config) {
    simulation *simulation = PyCapsule_GetPointer(owner, "simulation");
    connection *c = simulation != NULL ? allocate() : NULL;
    roburoc4_result result;
    if (c == NULL) {
        return NULL;
    }
    result = roburoc4_client_init(&c->client, sizeof c->client, config);
    if (result >= 0) {
        result = roburoc4_world_join(simulation_world(simulation), &c->client);
    }
    if (result < 0) {
        (void)raise_result(result);
        free(c);
        return NULL;
    }
    c->world = simulation_world(simulation);
    c->number = (uint32_t)result;
    Py_INCREF(owner);
    c->world_owner = owner;
    return c;
}

uint32_t connection_number(const connection *c) {
    return c->number;
}

void connection_destroy(connection *c) {
    if (c->pump != NULL) {
        Py_BEGIN_ALLOW_THREADS;
        roburoc4_pump_destroy(c->pump);
        Py_END_ALLOW_THREADS;
    } else if (c->world != NULL) {
        roburoc4_world_leave(c->world, &c->client);
        Py_DECREF(c->world_owner);
    } else {
        (void)roburoc4_udp_close(&c->udp);
    }
    free(c);
}

const char *connection_address(const connection *c) {
    return c->address;
}

PyObject *resolve_address(const char *host) {
    char text[ROBUROC4_ADDRESS_TEXT_SIZE];
    roburoc4_address address;
    roburoc4_result result;
    Py_BEGIN_ALLOW_THREADS;
    result = roburoc4_udp_resolve(host, 0, &address);
    Py_END_ALLOW_THREADS;
    if (result < 0) {
        return raise_result(result);
    }
    (void)roburoc4_udp_address_text(&address, text, sizeof text);
    return PyUnicode_FromString(text);
}

void connections_forked(void) {
    forks++;
}

/* ---------------------------------------------------------------------------------- one call --- */

uint64_t connection_now_us(const connection *c) {
    return c->world != NULL ? roburoc4_world_now_us(c->world) : roburoc4_udp_now_us();
}

static roburoc4_client *lock(connection *c) {
    if (c->forks != forks) {
        return NULL;
    }
    return c->pump != NULL ? roburoc4_pump_lock(c->pump) : &c->client;
}

static void unlock(connection *c) {
    if (c->pump != NULL) {
        roburoc4_pump_unlock(c->pump);
    }
}

static int is_ended(const roburoc4_client *client) {
    uint32_t state = roburoc4_client_state(client);
    return state == ROBUROC4_STATE_IDLE || state == ROBUROC4_STATE_CLOSING;
}

roburoc4_client *connection_enter(connection *c, int is_command) {
    roburoc4_client *client = lock(c);
    if (client != NULL && is_command && is_ended(client)) {
        unlock(c);
        client = NULL;
    }
    if (client == NULL) {
        (void)raise_result(ROBUROC4_ERR_CLOSED);
        return NULL;
    }
    entered = c;
    entered_for_command = is_command;
    return client;
}

uint64_t connection_entered_us(void) {
    return connection_now_us(entered);
}

void connection_leave(void) {
    connection *c = entered;
    if (c != NULL) {
        entered = NULL;
        if (entered_for_command && c->pump == NULL && c->world == NULL) {
            (void)roburoc4_udp_transmit_all(&c->udp, &c->client);
        }
        unlock(c);
    }
}

roburoc4_pump *connection_pump(connection *c) {
    return c->pump;
}

roburoc4_udp *connection_udp(connection *c) {
    return &c->udp;
}

uint32_t connection_fault(connection *c) {
    uint32_t fault = ROBUROC4_FAULT_NONE;
    if (c->world == NULL && lock(c) != NULL) {
        fault = roburoc4_udp_fault(c->pump != NULL ? roburoc4_pump_udp(c->pump) : &c->udp);
        unlock(c);
    }
    return fault;
}

/* ---------------------------------------------------------------------------- what came in --- */

PyObject *connection_description(const connection *c, PyObject *datagram) {
    roburoc4_description d;
    char *data;
    Py_ssize_t size;
    if (PyBytes_AsStringAndSize(datagram, &data, &size) < 0) {
        return NULL;
    }
    if (roburoc4_client_description(&c->client, (const uint8_t *)data, (size_t)size, &d) < 0) {
        Py_RETURN_NONE;
    }
    return Py_BuildValue("(iIy#)", (int)d.io_type, d.index, (const char *)d.text,
                         (Py_ssize_t)d.length);
}

static int append(PyObject *list, const roburoc4_sample *sample) {
    record_kind kind = sample->service - ROBUROC4_SERVICE_IOCARD + RECORD_IOCARD_STATUS;
    PyObject *record = record_of_status(kind, &sample->value, sample->host_us);
    int result = record != NULL ? PyList_Append(list, record) : -1;
    Py_XDECREF(record);
    return result;
}

PyObject *read_samples(roburoc4_pump *pump, roburoc4_pump_reader *reader, uint32_t mask) {
    roburoc4_sample samples[SAMPLES_AT_ONCE];
    roburoc4_result got = roburoc4_pump_read_samples(pump, reader, samples, SAMPLES_AT_ONCE);
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

roburoc4_pump_reader *new_reader(void) {
    return calloc(1, sizeof(roburoc4_pump_reader));
}

uint64_t reader_lost(const roburoc4_pump_reader *reader) {
    return reader->lost;
}
