/* SPDX-License-Identifier: MIT
 *
 * What the simulator's headers leave to their caller and Python cannot do.
 */
#include "native.h"

#include <errno.h>
#include <stdlib.h>

#define MAX_ARGUMENTS 64

int roburoc4_sim_main(int count, char **arguments); /* main() of sim/main.c */

struct simulation {
    roburoc4_world *world; /* has its robot, in virtual time; or NULL, then: */
    roburoc4_sim *sim;
    sim_host *host; /* serves the robot on a port, from a thread of its own */
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

roburoc4_world *simulation_world(simulation *s) {
    return s->world;
}

uint16_t simulation_port(const simulation *s) {
    return sim_host_port(s->host);
}

PyObject *simulation_stop(simulation *s) {
    Py_BEGIN_ALLOW_THREADS;
    sim_host_stop(s->host);
    Py_END_ALLOW_THREADS;
    Py_RETURN_NONE;
}

PyObject *simulation_set_faults(simulation *s, const roburoc4_sim_faults *faults) {
    if (s->world != NULL) {
        (void)roburoc4_world_set_faults(s->world, faults);
    } else {
        (void)simulation_enter(s);
        (void)sim_host_set_faults(s->host, faults);
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
    if (entered != NULL && entered->host != NULL) {
        sim_host_unlock(entered->host);
    }
    entered = NULL;
}

PyObject *simulation_panel(simulation *s, const char *line) {
    char reply[ROBUROC4_SIM_REPLY] = "";
    roburoc4_result result;
    result = roburoc4_sim_panel(simulation_enter(s), line, reply, sizeof reply);
    simulation_leave();
    return Py_BuildValue("(is)", (int)result, reply);
}

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
