/* SPDX-License-Identifier: MIT
 *
 * A simulated robot in real time behind a UDP port, on a thread of its own, for bindings. The
 * program roburoc4-sim uses server.h instead, which has a panel and many robots.
 */
#ifndef ROBUROC4_SIM_HOST_H
#define ROBUROC4_SIM_HOST_H

#include "roburoc4_sim.h"

typedef struct sim_host sim_host;

/* Serve `sim`, which from here on belongs to the host, on an IPv4 address and port (0: any free
 * one). On NULL, *error is the system's error number, and the caller still owns the simulator. */
sim_host *sim_host_open(roburoc4_sim *sim, const char *address, uint16_t port, int *error);
/* Stop serving; the simulator can still be inspected. May be called again, but not in a forked
 * child. */
void sim_host_stop(sim_host *host);
/* Stop, and free host and simulator. */
void sim_host_destroy(sim_host *host);
uint16_t sim_host_port(const sim_host *host);
/* Lock the simulator for the calling thread; not recursive. */
void sim_host_lock(sim_host *host);
void sim_host_unlock(sim_host *host);
/* Set the faults of the network in both directions. Call it between lock and unlock. */
roburoc4_result sim_host_set_faults(sim_host *host, const roburoc4_sim_faults *faults);

#endif
