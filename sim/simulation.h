/* SPDX-License-Identifier: MIT
 *
 * A simulated robot for bindings: in virtual time, together with the pumps of its clients, or in
 * real time behind a UDP port (host.h).
 */
#ifndef ROBUROC4_SIM_SIMULATION_H
#define ROBUROC4_SIM_SIMULATION_H

#include "roburoc4_pump.h"
#include "roburoc4_sim.h"

typedef struct simulation simulation;

/* In virtual time. NULL: a bad configuration, or no memory. */
simulation *simulation_in_world(const roburoc4_sim_config *config);
/* On an IPv4 address and port (0: any free one). On NULL, *error is the system's error number. */
simulation *simulation_on_port(const roburoc4_sim_config *config, const char *address,
                               uint16_t port, int *error);
/* Stop it. Clients in it can still be read; its memory is freed when the last one has left. */
void simulation_destroy(simulation *s);
/* 0 in virtual time. */
uint16_t simulation_port(const simulation *s);
/* Stop serving, or stop the virtual time; its robot can still be inspected. */
void simulation_stop(simulation *s);
int simulation_stopped(const simulation *s);
/* The robot, for one call. */
roburoc4_sim *simulation_lock(simulation *s);
void simulation_unlock(simulation *s);
/* Set the faults of its network. */
roburoc4_result simulation_set_faults(simulation *s, const roburoc4_sim_faults *faults);

/* ---- in virtual time ---- */

/* Start the client of a pump without a thread, and carry its datagrams. The client's number in the
 * world, or an error. */
roburoc4_result simulation_join(simulation *s, roburoc4_pump *pump);
void simulation_part(simulation *s, const roburoc4_pump *pump);
uint64_t simulation_now_us(const simulation *s);
/* Advance to the next news of a client, at most until then; whether there were any. */
int simulation_step(simulation *s, uint64_t until_us);
void simulation_run(simulation *s, uint64_t until_us);
/* Carry all that can arrive at this moment. */
void simulation_exchange(simulation *s);

#endif
