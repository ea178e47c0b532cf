/* SPDX-License-Identifier: MIT
 *
 * Connects a simulated robot with its socket and the time, through a faulty network if there is
 * one. Used by server.c and host.c.
 */
#ifndef ROBUROC4_SIM_CARRIER_H
#define ROBUROC4_SIM_CARRIER_H

#include "net.h"
#include "network.h"

#define SIM_LONGEST_UDP 65536
/* The longest datagram that passes a faulty network: one Ethernet frame. */
#define SIM_LONGEST_FRAME 1472

typedef struct sim_carrier {
    roburoc4_sim *sim;
    net_sockets *net;
    size_t index;          /* of the robot's socket */
    size_t status_index;   /* of the one that it sends statuses from; may be the same */
    sim_network *in, *out; /* both NULL: a perfect network */
    uint8_t *buffer;       /* of SIM_LONGEST_UDP bytes; carriers may share one */
} sim_carrier;

/* Reads what arrived, advances to now_us, sends what is due. To be called after net_wait(). */
void sim_carrier_turn(const sim_carrier *carrier, uint64_t now_us);
/* When the next turn is due without a datagram. */
uint64_t sim_carrier_next_deadline(const sim_carrier *carrier);

#endif
