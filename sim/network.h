/* SPDX-License-Identifier: MIT
 *
 * One direction of a faulty network in virtual time: push what is sent, poll what arrives.
 */
#ifndef ROBUROC4_SIM_NETWORK_H
#define ROBUROC4_SIM_NETWORK_H

#include "roburoc4_sim.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Faults of this or an older size, 0 where it has none. ROBUROC4_ERR_SIZE, or ROBUROC4_ERR_ARGUMENT
 * for a share that is not within 0 to 1: nothing was changed. */
roburoc4_result sim_faults_take(roburoc4_sim_faults *out, const roburoc4_sim_faults *faults);

typedef struct sim_network sim_network;

/* A network that holds up to `datagrams` (1 to 65536) in flight, of up to `longest` (1 to 65507)
 * bytes each. NULL: an argument outside its range, or no memory. faults may be NULL for none. */
sim_network *sim_network_create(const roburoc4_sim_faults *faults, uint64_t seed,
                                uint32_t datagrams, uint32_t longest);
/* NULL is ignored. */
void sim_network_destroy(sim_network *network);
/* Change the faults; what is in flight stays unchanged. Results as of sim_faults_take(). */
roburoc4_result sim_network_set_faults(sim_network *network, const roburoc4_sim_faults *faults);
/* Send a datagram. One that is empty, too long, or finds the network full is dropped.
 * `peer` is any number, and is returned with the datagram. */
void sim_network_push(sim_network *network, uint64_t peer, const uint8_t *data, size_t size,
                      uint64_t now_us);
/* Take the next datagram that has arrived: its length, or 0 when there is none.
 * ROBUROC4_ERR_BUFFER leaves it where it is. peer may be NULL. */
roburoc4_result sim_network_poll(sim_network *network, uint64_t now_us, uint64_t *peer,
                                 uint8_t *buffer, size_t capacity);
/* When the next datagram arrives; UINT64_MAX when none is in flight. */
uint64_t sim_network_next_deadline(const sim_network *network);

#ifdef __cplusplus
}
#endif

#endif
