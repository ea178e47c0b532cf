/* SPDX-License-Identifier: MIT
 *
 * One client in a pump, and who moves its datagrams: the pump's thread, the user of a socket, or a
 * simulation's virtual time. Every call of a client is made between connection_enter() and
 * connection_leave(). The interpreter's lock is held from one to the other, so no Python code runs
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
    char address[ROBUROC4_ADDRESS_TEXT_SIZE];
    struct {
        uint64_t host_us, utc_us;
    } made[RECORD_DIFFERENTIAL_STATUS + 1]; /* the last status of each kind that was asked for */
};

/* The call that is being made. */
static connection *entered;
static roburoc4_client *entered_client;
static int entered_for_command;

/* ---------------------------------------------------------------------------------- opening --- */

/* A connection whose pump has this address, or NULL. */
static connection *open_pump(const roburoc4_address *address, const roburoc4_config *config,
                             uint32_t capacity, roburoc4_recorder *recorder) {
    roburoc4_result result = ROBUROC4_ERR_SYSTEM;
    connection *c = calloc(1, sizeof *c);
    if (c != NULL) {
        c->pump = roburoc4_pump_create(address, config, capacity, recorder, &result);
    }
    if (c == NULL || c->pump == NULL) {
        (void)raise_result(result);
        free(c);
        return NULL;
    }
    return c;
}

/* Without the interpreter's lock: names take their time. 0, or -1 with an exception. */
static int resolve(const char *host, roburoc4_address *address) {
    roburoc4_result result;
    Py_BEGIN_ALLOW_THREADS;
    result = roburoc4_udp_resolve(host, 0, address);
    Py_END_ALLOW_THREADS;
    if (result < 0) {
        (void)raise_result(result);
    }
    return result < 0 ? -1 : 0;
}

static void start(connection *c) {
    (void)roburoc4_client_start(roburoc4_pump_lock(c->pump), roburoc4_udp_now_us());
    roburoc4_pump_unlock(c->pump);
}

/* -1 with an exception. Without a path: no recorder. */
static int open_recorder(const char *path, uint64_t max_file_bytes, uint64_t max_file_s,
                         const char *robot, roburoc4_recorder **recorder) {
    roburoc4_recorder_options options = {0};
    roburoc4_result result = ROBUROC4_OK;
    options.size = sizeof options;
    options.max_file_bytes = max_file_bytes;
    options.max_file_s = max_file_s;
    options.robot = robot;
    *recorder = path != NULL ? roburoc4_recorder_open(path, &options, &result) : NULL;
    if (result == ROBUROC4_ERR_SYSTEM) {
        (void)PyErr_SetFromErrnoWithFilename(PyExc_OSError, path);
    } else if (result < 0) {
        (void)raise_result(result);
    }
    return result < 0 ? -1 : 0;
}

connection *connect_host(const char *host, int threaded, const roburoc4_config *config,
                         uint32_t capacity, const char *record, uint64_t max_file_bytes,
                         uint64_t max_file_s) {
    char text[ROBUROC4_ADDRESS_TEXT_SIZE];
    roburoc4_recorder *recorder;
    roburoc4_address address;
    roburoc4_result result = ROBUROC4_OK;
    connection *c;
    if (resolve(host, &address) < 0) {
        return NULL;
    }
    (void)roburoc4_udp_address_text(&address, text, sizeof text);
    if (open_recorder(record, max_file_bytes, max_file_s, text, &recorder) < 0) {
        return NULL;
    }
    c = open_pump(threaded ? &address : NULL, config, capacity, recorder);
    if (c == NULL) {
        (void)roburoc4_recorder_close(recorder, NULL);
        return NULL;
    }
    c->recorder = recorder;
    memcpy(c->address, text, sizeof text);
    if (!threaded) {
        result = roburoc4_udp_open(&c->udp, sizeof c->udp, &address);
        (void)roburoc4_udp_record(&c->udp, recorder);
        start(c);
    }
    if (result < 0) {
        (void)raise_result(result);
        connection_destroy(c);
        return NULL;
    }
    return c;
}

connection *connect_virtual(PyObject *owner, const roburoc4_config *config, uint32_t capacity) {
    simulation *world = PyCapsule_GetPointer(owner, "simulation");
    connection *c = world != NULL ? open_pump(NULL, config, capacity, NULL) : NULL;
    roburoc4_result result;
    if (c == NULL) {
        return NULL;
    }
    result = simulation_join(world, c->pump);
    if (result < 0) {
        (void)raise_result(result);
        connection_destroy(c);
        return NULL;
    }
    c->world = world;
    Py_INCREF(owner);
    c->world_owner = owner;
    return c;
}

connection *connect_played(const roburoc4_config *config, uint32_t capacity, uint64_t begin_us) {
    connection *c = open_pump(NULL, config, capacity, NULL);
    if (c != NULL) {
        c->is_played = 1;
        c->played_us = begin_us;
        (void)roburoc4_client_start(roburoc4_pump_lock(c->pump), begin_us);
        roburoc4_pump_unlock(c->pump);
    }
    return c;
}

void connection_destroy(connection *c) {
    if (c->world != NULL) {
        simulation_part(c->world, c->pump);
        Py_DECREF(c->world_owner);
    }
    Py_BEGIN_ALLOW_THREADS;
    (void)roburoc4_pump_close(c->pump);
    Py_END_ALLOW_THREADS;
    connection_end_recording(c);
    roburoc4_pump_destroy(c->pump);
    (void)roburoc4_udp_close(&c->udp);
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

static PyObject *decode_path(void *path) {
    return PyUnicode_DecodeFSDefault(path);
}

PyObject *connection_recorder_state(connection *c) {
    if (c->recorder != NULL) {
        roburoc4_recorder_get_state(c->recorder, &c->recorded);
    }
    if (c->recorded.path[0] == '\0') {
        Py_RETURN_NONE;
    }
    return Py_BuildValue(
        "(O&KKKIi)", decode_path, c->recorded.path, (unsigned long long)c->recorded.recorded,
        (unsigned long long)c->recorded.dropped, (unsigned long long)c->recorded.bytes,
        (unsigned)c->recorded.files, (int)c->recorded.system_error);
}

PyObject *resolve_address(const char *host) {
    char text[ROBUROC4_ADDRESS_TEXT_SIZE];
    roburoc4_address address;
    if (resolve(host, &address) < 0) {
        return NULL;
    }
    (void)roburoc4_udp_address_text(&address, text, sizeof text);
    return PyUnicode_FromString(text);
}

const char *connection_address(const connection *c) {
    return c->address;
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

void connection_leave(void) {
    connection *c = entered;
    if (c == NULL) {
        return;
    }
    entered = NULL;
    if (entered_for_command) {
        (void)roburoc4_udp_transmit_all(&c->udp, entered_client);
    }
    roburoc4_pump_unlock(c->pump);
    if (entered_for_command && c->world != NULL) {
        simulation_exchange(c->world);
    }
}

roburoc4_pump *connection_pump(connection *c) {
    return c->pump;
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

/* When the robot made a status: the same each time that the latest of a kind is read. */
static uint64_t utc_us_of(connection *c, record_kind kind, const roburoc4_sample *sample) {
    if (c->made[kind].host_us != sample->host_us || c->made[kind].utc_us == 0) {
        c->made[kind].host_us = sample->host_us;
        c->made[kind].utc_us = sample->made_us + utc_offset_us(c);
    }
    return c->made[kind].utc_us;
}

static PyObject *record_of_sample(connection *c, const roburoc4_sample *sample) {
    const record_kind kind = sample->service - ROBUROC4_SERVICE_IOCARD + RECORD_IOCARD_STATUS;
    return record_of_status(kind, &sample->value, sample->host_us, utc_us_of(c, kind, sample));
}

PyObject *latest_status(connection *c, uint32_t service) {
    const roburoc4_client *client = connection_enter(c, 0);
    roburoc4_sample sample;
    roburoc4_result result;
    if (client == NULL) {
        return NULL;
    }
    result = roburoc4_sample_latest(client, service, &sample);
    connection_leave();
    return result < 0 ? raise_result(result) : record_of_sample(c, &sample);
}

uint32_t connection_fault(connection *c) {
    uint32_t fault = ROBUROC4_FAULT_NONE;
    if (roburoc4_pump_lock(c->pump) != NULL) {
        fault = roburoc4_udp_fd(&c->udp) >= 0 ? c->udp.fault : roburoc4_pump_udp(c->pump)->fault;
        roburoc4_pump_unlock(c->pump);
    }
    return fault;
}

/* ------------------------------------------------------------------ moved by hand: a socket --- */

PyObject *connection_disarm_for_good(connection *c) {
    roburoc4_client *client = roburoc4_pump_lock(c->pump);
    if (client != NULL) {
        if (!is_ended(c, client)) {
            (void)roburoc4_client_close(client, connection_now_us(c));
            (void)roburoc4_udp_transmit_all(&c->udp, client);
        }
        roburoc4_pump_unlock(c->pump);
        (void)roburoc4_pump_close(c->pump);
        if (c->world != NULL) {
            simulation_exchange(c->world);
        }
    }
    Py_RETURN_NONE;
}

/* Take what is there, one by one, as each may be a sample. What is due to be sent goes first. */
static roburoc4_result receive(connection *c, roburoc4_client *client) {
    int taken;
    for (taken = 0; taken < ROBUROC4_UDP_BURST; taken++) {
        const uint8_t *datagram;
        size_t size;
        roburoc4_result got = roburoc4_udp_receive_one(&c->udp, client, &datagram, &size);
        if (got <= ROBUROC4_UDP_NOTHING) {
            return got < 0 ? got : taken;
        }
        roburoc4_pump_collect(c->pump, datagram, size);
        if (roburoc4_client_next_deadline(client) <= roburoc4_udp_now_us()) {
            break;
        }
    }
    return taken;
}

PyObject *connection_exchange(connection *c) {
    roburoc4_client *client = roburoc4_pump_lock(c->pump);
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (client != NULL) {
        (void)roburoc4_udp_transmit_all(&c->udp, client);
        result = receive(c, client);
        (void)roburoc4_udp_transmit_all(&c->udp, client);
        roburoc4_pump_collect(c->pump, NULL, 0);
        roburoc4_pump_unlock(c->pump);
    }
    return result < 0 ? raise_result(result) : PyLong_FromLong(result);
}

long connection_fd(const connection *c) {
    return (long)roburoc4_udp_fd(&c->udp);
}

void connection_close_socket(connection *c) {
    (void)roburoc4_udp_close(&c->udp);
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

PyObject *connection_play(connection *c, PyObject *datagram, uint64_t at_us) {
    PyObject *list;
    roburoc4_client *client;
    char *data = NULL;
    Py_ssize_t size = 0;
    if (datagram != Py_None && PyBytes_AsStringAndSize(datagram, &data, &size) < 0) {
        return NULL;
    }
    client = roburoc4_pump_lock(c->pump);
    if (client == NULL) {
        return raise_result(ROBUROC4_ERR_CLOSED);
    }
    c->played_us = at_us;
    if (data != NULL) {
        (void)roburoc4_client_receive(client, (const uint8_t *)data, (size_t)size, at_us);
        roburoc4_pump_collect(c->pump, (const uint8_t *)data, (size_t)size);
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
            list = append(list, record_of_sample(c, &samples[i]));
        }
    }
    return list;
}

uint64_t reader_lost(const roburoc4_pump_reader *reader) {
    return reader->lost;
}

/* ------------------------------------------------------------------------------------ moves --- */

PyObject *move_step(connection *c, roburoc4_move *move) {
    roburoc4_client *client = connection_enter(c, 1);
    uint64_t now_us;
    if (client == NULL) {
        return NULL;
    }
    now_us = connection_entered_us();
    if (roburoc4_move_step(move, client, now_us) == ROBUROC4_MOVE_RUNNING) {
        (void)roburoc4_client_drive(client, move->linear_m_s, move->angular_rad_s, 0, now_us);
    }
    connection_leave();
    return PyLong_FromLong(move->result);
}

PyObject *move_values(const roburoc4_move *move) {
    return Py_BuildValue("(iidddd)", (int)move->result, (int)move->cause,
                         shortest(move->distance_m), shortest(move->angle_rad),
                         shortest(move->left_m), shortest(move->left_rad));
}
