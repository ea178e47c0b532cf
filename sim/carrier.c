/* SPDX-License-Identifier: MIT
 *
 * Advances one simulated robot in real time.
 */
#include "carrier.h"

/* Datagrams read from one robot's socket before the other robots are served. */
#define DATAGRAMS_PER_TURN 256
/* Waiting datagrams are taken to be at most this old: less than the robot's watchdog. */
#define LONGEST_WAIT_US 900000u

static void take_in(const sim_carrier *c, uint64_t now_us) {
    uint64_t peer = 0;
    for (int taken = 0; taken < DATAGRAMS_PER_TURN; taken++) {
        ptrdiff_t size = net_receive(c->net, c->index, &peer, c->buffer, SIM_LONGEST_UDP);
        if (size < 0) {
            break;
        }
        if (c->in != NULL) {
            sim_network_push(c->in, peer, c->buffer, (size_t)size, now_us);
        } else {
            roburoc4_sim_receive(c->sim, peer, c->buffer, (size_t)size);
        }
    }
    while (net_refused(c->net, c->index, &peer)) {
        roburoc4_sim_receive(c->sim, peer, NULL, 0);
    }
}

static void deliver_in(const sim_carrier *c, uint64_t now_us) {
    uint64_t peer = 0;
    roburoc4_result size = 0;
    while ((size = sim_network_poll(c->in, now_us, &peer, c->buffer, SIM_LONGEST_UDP)) > 0) {
        roburoc4_sim_receive(c->sim, peer, c->buffer, (size_t)size);
    }
}

static void send(const sim_carrier *c, uint64_t peer, size_t size) {
    bool status = c->buffer[0] == ROBUROC4_HEADER_STATUS;
    net_send(c->net, status ? c->status_index : c->index, peer, c->buffer, size);
}

/* Nobody listens on a port that only sends. */
static void drain(const sim_carrier *c) {
    uint64_t peer = 0;
    while (c->status_index != c->index &&
           (net_receive(c->net, c->status_index, &peer, c->buffer, SIM_LONGEST_UDP) >= 0 ||
            net_refused(c->net, c->status_index, &peer))) {
    }
}

static void send_out(const sim_carrier *c, uint64_t now_us) {
    uint64_t peer = 0;
    roburoc4_result size = 0;
    while ((size = roburoc4_sim_poll_transmit(c->sim, &peer, c->buffer, SIM_LONGEST_UDP)) > 0) {
        if (c->out != NULL) {
            sim_network_push(c->out, peer, c->buffer, (size_t)size, now_us);
        } else {
            send(c, peer, (size_t)size);
        }
    }
    while (c->out != NULL &&
           (size = sim_network_poll(c->out, now_us, &peer, c->buffer, SIM_LONGEST_UDP)) > 0) {
        send(c, peer, (size_t)size);
    }
}

void sim_carrier_turn(const sim_carrier *c, uint64_t now_us) {
    /* Read datagrams before advancing the time: after a stall of this process no robot's watchdog
     * may trip while commands wait in the socket. */
    if (net_is_ready(c->net, c->index)) {
        roburoc4_sim_advance(c->sim, now_us - LONGEST_WAIT_US);
        take_in(c, now_us);
    }
    drain(c);
    if (c->in != NULL) {
        deliver_in(c, now_us);
    }
    roburoc4_sim_advance(c->sim, now_us);
    send_out(c, now_us);
}

static uint64_t sooner(uint64_t one, uint64_t other) {
    return one < other ? one : other;
}

uint64_t sim_carrier_next_deadline(const sim_carrier *c) {
    uint64_t next_us = roburoc4_sim_next_deadline(c->sim);
    if (c->in != NULL) {
        next_us = sooner(next_us, sim_network_next_deadline(c->in));
        next_us = sooner(next_us, sim_network_next_deadline(c->out));
    }
    return next_us;
}
