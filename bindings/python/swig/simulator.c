/* SPDX-License-Identifier: MIT
 *
 * What the simulator's headers leave to their caller and Python cannot do.
 */
#include "native.h"

#include <errno.h>
#include <stdlib.h>

struct simulation {
    roburoc4_world *world; /* has its robot, in virtual time; or NULL, then: */
    roburoc4_sim *sim;
    sim_host *host; /* serves the robot on a port, from a thread of its own */
    int stopped;
    struct {
        uint32_t number; /* of the client in the world; 0: a free place */
        roburoc4_client *client;
        roburoc4_pump *pump; /* which keeps what the client hears */
    } members[ROBUROC4_WORLD_CLIENTS];
};

/* The one whose robot is being called; the interpreter lock is held meanwhile. */
static simulation *entered;

static simulation *allocate(void) {
    simulation *s = calloc(1, sizeof *s);
    if (s == NULL) {
        (void)PyErr_NoMemory();
    }
    return s;
}

simulation *new_world(const roburoc4_sim_config *config) {
    simulation *s = allocate();
    if (s != NULL && (s->world = roburoc4_world_create(config)) == NULL) {
        (void)PyErr_NoMemory();
        free(s);
        s = NULL;
    }
    return s;
}

simulation *new_host(const roburoc4_sim_config *config, const char *address, uint16_t port) {
    simulation *s = allocate();
    int error = ENOMEM;
    if (s != NULL && (s->sim = roburoc4_sim_create(config)) != NULL) {
        s->host = sim_host_open(s->sim, address, port, &error);
    }
    if (s != NULL && s->host == NULL) {
        errno = error;
        (void)PyErr_SetFromErrno(PyExc_OSError);
        simulation_destroy(s);
        s = NULL;
    }
    return s;
}

void simulation_destroy(simulation *s) {
    roburoc4_world_destroy(s->world);
    if (s->host != NULL) {
        Py_BEGIN_ALLOW_THREADS;
        sim_host_destroy(s->host);
        Py_END_ALLOW_THREADS;
    } else {
        roburoc4_sim_destroy(s->sim);
    }
    free(s);
}

PyObject *usual_answer(PyObject *request) {
    uint8_t answer[ROBUROC4_SIM_MAX_TRANSMIT];
    char *data;
    Py_ssize_t size;
    uint64_t peer;
    roburoc4_result length = 0;
    roburoc4_sim *sim;
    if (PyBytes_AsStringAndSize(request, &data, &size) < 0) {
        return NULL;
    }
    sim = roburoc4_sim_create(NULL);
    if (sim == NULL) {
        return PyErr_NoMemory();
    }
    roburoc4_sim_advance(sim, 0);
    roburoc4_sim_receive(sim, 1, (const uint8_t *)data, (size_t)size);
    /* the default robot has a delay of its own, of less than a cycle or two */
    roburoc4_sim_advance(sim, 20000);
    length = roburoc4_sim_poll_transmit(sim, &peer, answer, sizeof answer);
    roburoc4_sim_destroy(sim);
    if (length <= 0) {
        Py_RETURN_NONE;
    }
    return PyBytes_FromStringAndSize((const char *)answer, length);
}

uint16_t simulation_port(const simulation *s) {
    return sim_host_port(s->host);
}

PyObject *simulation_stop(simulation *s) {
    s->stopped = 1;
    if (s->host != NULL) {
        Py_BEGIN_ALLOW_THREADS;
        sim_host_stop(s->host);
        Py_END_ALLOW_THREADS;
    }
    Py_RETURN_NONE;
}

int simulation_stopped(const simulation *s) {
    return s->stopped;
}

/* ------------------------------------------------------------------------------- virtual time ---
 */

roburoc4_result simulation_join(simulation *s, roburoc4_pump *pump) {
    roburoc4_client *client = roburoc4_pump_lock(pump);
    roburoc4_result number = roburoc4_world_join(s->world, client);
    roburoc4_pump_unlock(pump);
    if (number > 0) {
        int i = 0;
        while (s->members[i].number != 0) {
            i++; /* the world has as many places */
        }
        s->members[i].number = (uint32_t)number;
        s->members[i].client = client;
        s->members[i].pump = pump;
        simulation_exchange(s);
    }
    return number;
}

void simulation_part(simulation *s, const roburoc4_pump *pump) {
    for (int i = 0; i < ROBUROC4_WORLD_CLIENTS; i++) {
        if (s->members[i].number != 0 && s->members[i].pump == pump) {
            roburoc4_world_leave(s->world, s->members[i].client);
            s->members[i].number = 0;
        }
    }
}

uint64_t simulation_now_us(const simulation *s) {
    return roburoc4_world_now_us(s->world);
}

int simulation_step(simulation *s, uint64_t until_us) {
    const uint8_t *datagram;
    size_t size;
    uint32_t number = roburoc4_world_step(s->world, until_us, &datagram, &size);
    for (int i = 0; number != 0 && i < ROBUROC4_WORLD_CLIENTS; i++) {
        if (s->members[i].number == number && roburoc4_pump_lock(s->members[i].pump) != NULL) {
            roburoc4_pump_collect(s->members[i].pump, size > 0 ? datagram : NULL, size);
            roburoc4_pump_unlock(s->members[i].pump);
        }
    }
    return number != 0;
}

void simulation_exchange(simulation *s) {
    while (!s->stopped && simulation_step(s, simulation_now_us(s))) {
    }
}

PyObject *simulation_set_faults(simulation *s, double loss, double duplicate, double reorder,
                                double corrupt, uint32_t delay_us, uint32_t jitter_us) {
    const roburoc4_sim_faults faults = {sizeof faults, delay_us,  jitter_us, 0,
                                        loss,          duplicate, reorder,   corrupt};
    if (s->world != NULL) {
        (void)roburoc4_world_set_faults(s->world, &faults);
    } else {
        (void)simulation_enter(s);
        (void)sim_host_set_faults(s->host, &faults);
        simulation_leave();
    }
    Py_RETURN_NONE;
}

roburoc4_sim *simulation_enter(simulation *s) {
    if (s->host != NULL) {
        sim_host_lock(s->host);
    }
    entered = s;
    return s->world != NULL ? roburoc4_world_robot(s->world) : s->sim;
}

void simulation_leave(void) {
    simulation *s = entered;
    entered = NULL;
    if (s != NULL && s->host != NULL) {
        sim_host_unlock(s->host);
    } else if (s != NULL) {
        simulation_exchange(s);
    }
}

PyObject *simulation_panel(simulation *s, const char *line) {
    char reply[ROBUROC4_SIM_REPLY] = "";
    roburoc4_result result;
    result = roburoc4_sim_panel(simulation_enter(s), line, reply, sizeof reply);
    simulation_leave();
    return Py_BuildValue("(is)", (int)result, reply);
}
