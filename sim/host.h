/* SPDX-License-Identifier: MIT
 *
 * A simulated robot in real time behind a UDP port, on a thread of its own: what a binding starts
 * in its own process. The program roburoc4-sim has server.h instead, with its panel and many
 * robots.
 */
#ifndef ROBUROC4_SIM_HOST_H
#define ROBUROC4_SIM_HOST_H

#include "roburoc4_sim.h"

typedef struct sim_host sim_host;

/* Serve `sim`, which from here on belongs to the host, on an IPv4 address and port (0: any free
 * one). NULL: *error is the system's error number, and the simulator is still yours. */
sim_host *sim_host_open(roburoc4_sim *sim, const char *address, uint16_t port, int *error);
/* Stop serving; the simulator can still be looked at. Several times, not in a forked child. */
void sim_host_stop(sim_host *host);
/* Stop, and free host and simulator. */
void sim_host_destroy(sim_host *host);
/* The port that it listens on. */
uint16_t sim_host_port(const sim_host *host);
/* Take the simulator for the calling thread; not twice. */
void sim_host_lock(sim_host *host);
void sim_host_unlock(sim_host *host);
/* Faults of the network in both directions from now on. Between lock and unlock. */
roburoc4_result sim_host_set_faults(sim_host *host, const roburoc4_sim_faults *faults);

#endif
