/* SPDX-License-Identifier: MIT
 *
 * Between a simulated robot and its socket: time and datagrams, through a network with faults
 * where there is one. What server.c and host.c have in common.
 */
#ifndef ROBUROC4_SIM_CARRIER_H
#define ROBUROC4_SIM_CARRIER_H

#include "net.h"
#include "network.h"

#define SIM_LONGEST_UDP 65536
/* What passes through a faulty network: one Ethernet frame. */
#define SIM_LONGEST_FRAME 1472

typedef struct sim_carrier {
    roburoc4_sim *sim;
    net_sockets *net;
    size_t index;          /* of the robot's socket */
    sim_network *in, *out; /* both NULL: a perfect network */
    uint8_t *buffer;       /* of SIM_LONGEST_UDP bytes; carriers may share one */
} sim_carrier;

/* Take what arrived, let time go on to now_us, send what there is to send. After net_wait(). */
void sim_carrier_turn(const sim_carrier *carrier, uint64_t now_us);
/* When the next turn is due without a datagram. */
uint64_t sim_carrier_next_deadline(const sim_carrier *carrier);

#endif
