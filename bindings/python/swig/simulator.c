/* SPDX-License-Identifier: MIT
 *
 * What the simulator's headers leave to their caller and Python cannot do.
 */
#include "native.h"

#include <errno.h>

roburoc4_result usual_answer(const uint8_t *data, size_t size, uint8_t *buffer, size_t capacity) {
    roburoc4_sim *sim = roburoc4_sim_create(NULL);
    roburoc4_result length;
    uint64_t peer;
    if (sim == NULL) {
        return ROBUROC4_ERR_SYSTEM;
    }
    roburoc4_sim_advance(sim, 0);
    roburoc4_sim_receive(sim, 1, data, size);
    /* the default robot has a delay of its own, of less than a cycle or two */
    roburoc4_sim_advance(sim, 20000);
    length = roburoc4_sim_poll_transmit(sim, &peer, buffer, capacity);
    roburoc4_sim_destroy(sim);
    return length;
}

void draw_family(roburoc4_sim_config *config, uint64_t seed) {
    (void)roburoc4_sim_config_family(config, sizeof *config, seed);
}

simulation *new_simulation(const roburoc4_sim_config *config, const char *address, uint16_t port) {
    int error = 0;
    simulation *s = simulation_on_port(config, address, port, &error);
    if (s == NULL) {
        errno = error;
        (void)PyErr_SetFromErrno(PyExc_OSError);
    }
    return s;
}
