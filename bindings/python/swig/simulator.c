/* SPDX-License-Identifier: MIT
 *
 * What the simulator's headers leave to their caller and Python cannot do.
 */
#include "native.h"

#include <errno.h>

/* The one whose robot is being called; the interpreter lock is held meanwhile. */
static simulation *entered;

simulation *new_host(const roburoc4_sim_config *config, const char *address, uint16_t port) {
    int error;
    simulation *s = simulation_on_port(config, address, port, &error);
    if (s == NULL) {
        errno = error;
        (void)PyErr_SetFromErrno(PyExc_OSError);
    }
    return s;
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

roburoc4_sim *simulation_enter(simulation *s) {
    entered = s;
    return simulation_lock(s);
}

void simulation_leave(void) {
    simulation *s = entered;
    entered = NULL;
    if (s != NULL) {
        simulation_unlock(s);
        if (simulation_port(s) == 0) {
            simulation_exchange(s);
        }
    }
}

PyObject *simulation_panel(simulation *s, const char *line) {
    char reply[ROBUROC4_SIM_REPLY_SIZE] = "";
    roburoc4_result result;
    result = roburoc4_sim_panel(simulation_enter(s), line, reply, sizeof reply);
    simulation_leave();
    return Py_BuildValue("(is)", (int)result, reply);
}
