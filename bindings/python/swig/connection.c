/* SPDX-License-Identifier: MIT
 *
 * One client in a pump, and who moves its datagrams: the pump's thread, the user of a socket, or a
 * simulation's virtual time. Every call of a client is made between connection_enter() and
 * leave_call(). The interpreter's lock is held from one to the other, so no Python code runs
 * while a pump is locked.
 */
#include "native.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Samples that are copied from a pump at once: the interpreter is not held up for long. */
#define SAMPLES_AT_ONCE 64
#define AT_ONCE_US 20u

struct connection {
    roburoc4_pump *pump;
    roburoc4_udp udp;  /* open where the user moves the datagrams */
    simulation *world; /* moves the client in virtual time, or NULL */
    PyObject *world_owner;
    roburoc4_recorder *recorder;      /* or NULL */
    roburoc4_recorder_state recorded; /* the last state, after its end */
    int is_played;                    /* a recording moves the client, at the recorded time */
    uint64_t played_us;
    struct made {
        uint64_t host_us, utc_us;
    } made[STATUS_SERVICES]; /* the last record of each service's status */
};

/* The call that is being made: of a client, or of a simulated robot. */
static connection *entered;
static roburoc4_client *entered_client;
static int entered_for_command;
static simulation *entered_simulation;

/* ---------------------------------------------------------------------------------- opening --- */

connection *new_connection(const roburoc4_address *address, const roburoc4_config *config,
                           uint32_t capacity, const char *robot, const char *record,
                           uint64_t max_file_bytes, uint64_t max_file_s) {
    const roburoc4_recorder_options options = {sizeof options, 0, max_file_bytes, max_file_s,
                                               robot};
    roburoc4_result result = ROBUROC4_OK;
    connection *c = calloc(1, sizeof *c);
    if (c == NULL) {
        return NULL;
    }
    if (record != NULL) {
        c->recorder = roburoc4_recorder_open(record, &options, &result);
        if (result == ROBUROC4_ERR_SYSTEM) {
            (void)PyErr_SetFromErrnoWithFilename(PyExc_OSError, record);
        }
    }
    if (result >= 0) {
        c->pump = roburoc4_pump_create(address, config, capacity, c->recorder, &result);
    }
    if (result < 0) {
        if (PyErr_Occurred() == NULL) {
            (void)raise_result(result);
        }
        connection_destroy(c);
        return NULL;
    }
    return c;
}

static void start(connection *c, uint64_t now_us) {
    (void)roburoc4_client_start(roburoc4_pump_lock(c->pump), now_us);
    roburoc4_pump_unlock(c->pump);
}

roburoc4_result connection_open_socket(connection *c, const roburoc4_address *robot) {
    roburoc4_result result = roburoc4_udp_open(&c->udp, sizeof c->udp, robot);
    if (result >= 0) {
        (void)roburoc4_udp_record(&c->udp, c->recorder);
        start(c, roburoc4_udp_now_us());
    }
    return result;
}

PyObject *connection_join(connection *c, PyObject *owner) {
    simulation *world = PyCapsule_GetPointer(owner, "simulation");
    roburoc4_result result;
    if (world == NULL) {
        return NULL;
    }
    result = simulation_join(world, c->pump);
    if (result < 0) {
        return raise_result(result);
    }
    c->world = world;
    c->world_owner = Py_NewRef(owner);
    Py_RETURN_NONE;
}

void connection_begin(connection *c, uint64_t begin_us) {
    c->is_played = 1;
    c->played_us = begin_us;
    start(c, begin_us);
}

void connection_destroy(connection *c) {
    if (c->world != NULL) {
        simulation_part(c->world, c->pump);
        Py_DECREF(c->world_owner);
    }
    Py_BEGIN_ALLOW_THREADS;
    roburoc4_pump_destroy(c->pump);
    (void)roburoc4_udp_close(&c->udp);
    (void)roburoc4_recorder_close(c->recorder, NULL);
    Py_END_ALLOW_THREADS;
    free(c);
}

void connection_end_recording(connection *c) {
    roburoc4_recorder *recorder = c->recorder;
    c->recorder = NULL;
    if (recorder != NULL) {
        (void)roburoc4_pump_record(c->pump, NULL);
        (void)roburoc4_udp_record(&c->udp, NULL);
        Py_BEGIN_ALLOW_THREADS;
        (void)roburoc4_recorder_close(recorder, &c->recorded);
        Py_END_ALLOW_THREADS;
    }
}

PyObject *connection_recorder_state(connection *c) {
    if (c->recorder != NULL) {
        roburoc4_recorder_get_state(c->recorder, &c->recorded);
    }
    return c->recorded.path[0] != '\0' ? record_of("roburoc4_recorder_state", &c->recorded)
                                       : Py_NewRef(Py_None);
}

/* --------------------------------------------------------------------------------- one call --- */

uint64_t connection_now_us(const connection *c) {
    if (c->is_played) {
        return c->played_us;
    }
    return c->world != NULL ? simulation_now_us(c->world) : roburoc4_udp_now_us();
}

static int is_ended(const connection *c, const roburoc4_client *client) {
    uint32_t state = roburoc4_client_state(client);
    return state == ROBUROC4_STATE_IDLE || state == ROBUROC4_STATE_CLOSING ||
           (c->world != NULL && simulation_stopped(c->world));
}

roburoc4_client *connection_enter(connection *c, int is_command) {
    roburoc4_client *client = roburoc4_pump_lock(c->pump);
    if (client != NULL && is_command && is_ended(c, client)) {
        roburoc4_pump_unlock(c->pump);
        client = NULL;
    }
    if (client == NULL) {
        (void)raise_result(ROBUROC4_ERR_CLOSED);
        return NULL;
    }
    entered = c;
    entered_client = client;
    entered_for_command = is_command;
    return client;
}

uint64_t connection_entered_us(void) {
    return connection_now_us(entered);
}

static void leave_client(connection *c) {
    if (entered_for_command) {
        (void)roburoc4_udp_transmit_all(&c->udp, entered_client);
    }
    roburoc4_pump_unlock(c->pump);
    if (entered_for_command && c->world != NULL) {
        simulation_exchange(c->world);
    }
}

roburoc4_sim *simulation_enter(simulation *s) {
    entered_simulation = s;
    return simulation_lock(s);
}

static void leave_simulation(simulation *s) {
    simulation_unlock(s);
    if (simulation_port(s) == 0) {
        simulation_exchange(s);
    }
}

void leave_call(void) {
    connection *c = entered;
    simulation *s = entered_simulation;
    entered = NULL;
    entered_simulation = NULL;
    if (c != NULL) {
        leave_client(c);
    } else if (s != NULL) {
        leave_simulation(s);
    }
}

roburoc4_pump *connection_pump(connection *c) {
    return c->pump;
}

roburoc4_udp *connection_udp(connection *c) {
    return &c->udp;
}

/* From the client's clock to microseconds since 1970. */
static uint64_t utc_offset_us(const connection *c) {
    uint64_t utc_us = 0, before_us = 0, after_us = 0;
    int tries;
    if (c->world != NULL || c->is_played) {
        return 0;
    }
    /* Where the thread had to wait between the two clocks, they are read again. */
    for (tries = 0; tries < 5 && (tries == 0 || after_us - before_us > AT_ONCE_US); tries++) {
        struct timespec now;
        before_us = roburoc4_udp_now_us();
        (void)timespec_get(&now, TIME_UTC);
        after_us = roburoc4_udp_now_us();
        utc_us = (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
    }
    return utc_us - after_us;
}

static PyObject *record_of_status(connection *c, const roburoc4_sample *sample) {
    struct made *made = &c->made[sample->service - ROBUROC4_SERVICE_IOCARD];
    if (made->host_us != sample->host_us || made->utc_us == 0) {
        made->host_us = sample->host_us;
        made->utc_us = sample->made_us + utc_offset_us(c);
    }
    return record_of_sample(sample, (double)made->utc_us / 1e6);
}

PyObject *latest_status(connection *c, uint32_t service) {
    roburoc4_client *client = connection_enter(c, 0);
    roburoc4_sample sample;
    roburoc4_result result;
    if (client == NULL) {
        return NULL;
    }
    result = roburoc4_sample_latest(client, service, &sample);
    leave_call();
    return result < 0 ? raise_result(result) : record_of_status(c, &sample);
}

uint32_t connection_fault(connection *c) {
    uint32_t fault = ROBUROC4_FAULT_NONE;
    if (roburoc4_pump_lock(c->pump) != NULL) {
        fault = c->udp.fault + roburoc4_pump_udp(c->pump)->fault; /* one of them is not open */
        roburoc4_pump_unlock(c->pump);
    }
    return fault;
}

/* ------------------------------------------------------------------ moved by hand: a socket --- */

static void seen(void *pump, const uint8_t *datagram, size_t size) {
    roburoc4_pump_collect(pump, datagram, size);
}

PyObject *connection_exchange(connection *c) {
    roburoc4_client *client = roburoc4_pump_lock(c->pump);
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (client != NULL) {
        (void)roburoc4_udp_transmit_all(&c->udp, client);
        result = roburoc4_udp_receive(&c->udp, client, seen, c->pump);
        (void)roburoc4_udp_transmit_all(&c->udp, client);
        roburoc4_pump_collect(c->pump, NULL, 0);
        roburoc4_pump_unlock(c->pump);
    }
    return result < 0 ? raise_result(result) : PyLong_FromLong(result);
}

/* --------------------------------------------------------------------- moved by a recording --- */

/* Append a new item; NULL, with the list released, if there is none. */
static PyObject *append(PyObject *list, PyObject *item) {
    if (item == NULL || PyList_Append(list, item) < 0) {
        Py_CLEAR(list);
    }
    Py_XDECREF(item);
    return list;
}

/* What the client has to send now, or NULL with an exception. */
static PyObject *take_transmits(connection *c, roburoc4_client *client) {
    uint8_t buffer[ROBUROC4_MAX_TRANSMIT];
    PyObject *list = PyList_New(0);
    roburoc4_result size;
    while (list != NULL && (size = roburoc4_client_poll_transmit(client, buffer, sizeof buffer,
                                                                 c->played_us)) > 0) {
        list = append(list, PyBytes_FromStringAndSize((const char *)buffer, size));
    }
    roburoc4_pump_collect(c->pump, NULL, 0);
    return list;
}

PyObject *connection_play(connection *c, const uint8_t *data, size_t size, uint64_t at_us) {
    roburoc4_client *client = roburoc4_pump_lock(c->pump);
    PyObject *list;
    if (client == NULL) {
        return raise_result(ROBUROC4_ERR_CLOSED);
    }
    c->played_us = at_us;
    if (size > 0) {
        (void)roburoc4_client_receive(client, data, size, at_us);
        roburoc4_pump_collect(c->pump, data, size);
    }
    list = take_transmits(c, client);
    roburoc4_pump_unlock(c->pump);
    return list;
}

/* ------------------------------------------------------------------------ readers of a pump --- */

PyObject *read_samples(connection *c, roburoc4_pump_reader *reader, uint32_t mask) {
    roburoc4_sample samples[SAMPLES_AT_ONCE];
    roburoc4_result got = roburoc4_pump_read_samples(c->pump, reader, samples, SAMPLES_AT_ONCE);
    PyObject *list;
    if (got < 0) {
        return raise_result(got);
    }
    if (got == 0) {
        Py_RETURN_NONE;
    }
    list = PyList_New(0);
    for (roburoc4_result i = 0; list != NULL && i < got; i++) {
        if ((mask >> samples[i].service & 1u) != 0) {
            list = append(list, record_of_status(c, &samples[i]));
        }
    }
    return list;
}

/* ------------------------------------------------------------------------------------ moves --- */

PyObject *renew_drive(connection *c, float linear_m_s, float angular_rad_s) {
    roburoc4_client *client = connection_enter(c, 1);
    roburoc4_facts facts;
    roburoc4_result result = ROBUROC4_OK;
    int renewed;
    if (client == NULL) {
        return NULL;
    }
    (void)roburoc4_client_facts(client, connection_entered_us(), ROBUROC4_SIZED(&facts));
    renewed = !facts.armed || facts.driving;
    if (renewed) {
        result =
            roburoc4_client_drive(client, linear_m_s, angular_rad_s, 0, connection_entered_us());
    }
    leave_call();
    return result < 0 ? raise_result(result) : PyBool_FromLong(renewed);
}

PyObject *move_step(connection *c, roburoc4_move *move) {
    roburoc4_client *client = connection_enter(c, 1);
    uint64_t now_us;
    if (client == NULL) {
        return NULL;
    }
    now_us = connection_entered_us();
    if (roburoc4_move_step(move, client, now_us) == ROBUROC4_MOVE_RUNNING) {
        roburoc4_result ignored =
            roburoc4_client_drive(client, move->linear_m_s, move->angular_rad_s, 0, now_us);
        (void)ignored;
    }
    leave_call();
    return PyLong_FromLong(move->outcome);
}
