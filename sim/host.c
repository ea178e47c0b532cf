/* SPDX-License-Identifier: MIT
 *
 * One thread: it waits for datagrams or the next cycle, and carries both ways through a network
 * with faults.
 */
#include "host.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "net.h"
#include "pump_threads.h"

#define LONGEST_FRAME 1472
#define FLIGHTS 4096u
/* Datagrams taken before time goes on. */
#define DATAGRAMS_PER_TURN 256

struct sim_host {
    int64_t process;
    roburoc4_sim *sim;
    net_sockets *net;
    roburoc4_sim_channel *in, *out;
    roburoc4_lock lock; /* the simulator, the channels, stopping */
    roburoc4_thread thread;
    int stopping;
    uint16_t port;
    uint8_t buffer[65536];
};

/* --------------------------------------------------------------------------------- carrying --- */

static void take_in(sim_host *host, uint64_t now_us) {
    int taken;
    uint64_t peer;
    ptrdiff_t size = 0;
    for (taken = 0; taken < DATAGRAMS_PER_TURN && size >= 0; taken++) {
        size = net_receive(host->net, 0, &peer, host->buffer, sizeof host->buffer);
        if (size >= 0 && size <= LONGEST_FRAME) {
            roburoc4_sim_channel_push(host->in, peer, host->buffer, (size_t)size, now_us);
        }
    }
    while (net_refused(host->net, 0, &peer)) {
        roburoc4_sim_peer_unreachable(host->sim, peer);
    }
}

static void send_out(sim_host *host, uint64_t now_us) {
    uint64_t peer;
    roburoc4_result size;
    while ((size = roburoc4_sim_poll_transmit(host->sim, &peer, host->buffer,
                                              sizeof host->buffer)) > 0) {
        roburoc4_sim_channel_push(host->out, peer, host->buffer, (size_t)size, now_us);
    }
    while ((size = roburoc4_sim_channel_poll(host->out, now_us, &peer, host->buffer,
                                             sizeof host->buffer)) > 0) {
        net_send(host->net, 0, peer, host->buffer, (size_t)size);
    }
}

static void turn(sim_host *host) {
    uint64_t now_us = net_now_us(), peer;
    roburoc4_result size;
    roburoc4_sim_advance(host->sim, now_us);
    take_in(host, now_us);
    while ((size = roburoc4_sim_channel_poll(host->in, now_us, &peer, host->buffer,
                                             sizeof host->buffer)) > 0) {
        roburoc4_sim_receive(host->sim, peer, host->buffer, (size_t)size);
    }
    send_out(host, now_us);
}

static uint64_t sooner(uint64_t one, uint64_t other) {
    return one < other ? one : other;
}

static uint64_t next_deadline(const sim_host *host) {
    uint64_t next_us = roburoc4_sim_next_deadline(host->sim);
    next_us = sooner(next_us, roburoc4_sim_channel_next_deadline(host->in));
    return sooner(next_us, roburoc4_sim_channel_next_deadline(host->out));
}

static void serve(void *argument) {
    sim_host *host = argument;
    int stopping = 0;
    while (!stopping) {
        uint64_t due_us, now_us;
        roburoc4_lock_take(&host->lock);
        turn(host);
        due_us = next_deadline(host);
        stopping = host->stopping;
        roburoc4_lock_give(&host->lock);
        now_us = net_now_us();
        if (!stopping) {
            net_wait(host->net, false, due_us > now_us ? due_us - now_us : 0);
        }
    }
}

/* ------------------------------------------------------------------------------------- life --- */

static void free_host(sim_host *host) {
    if (host->net != NULL) {
        net_destroy(host->net);
    }
    roburoc4_sim_channel_destroy(host->in);
    roburoc4_sim_channel_destroy(host->out);
    free(host);
}

sim_host *sim_host_open(roburoc4_sim *sim, const char *address, uint16_t port, int *error) {
    sim_host *host = calloc(1, sizeof *host);
    *error = ENOMEM;
    if (host == NULL) {
        return NULL;
    }
    host->process = roburoc4_process_id();
    host->sim = sim;
    host->net = net_create(1);
    host->in = roburoc4_sim_channel_create(NULL, 1, FLIGHTS, LONGEST_FRAME);
    host->out = roburoc4_sim_channel_create(NULL, 2, FLIGHTS, LONGEST_FRAME);
    if (host->net != NULL && host->in != NULL && host->out != NULL) {
        *error = net_bind(host->net, 0, address, port, &host->port);
        if (*error == 0 && roburoc4_lock_create(&host->lock)) {
            if (roburoc4_thread_start(&host->thread, serve, host)) {
                return host;
            }
            roburoc4_lock_destroy(&host->lock);
            *error = EAGAIN;
        }
    }
    free_host(host);
    return NULL;
}

void sim_host_stop(sim_host *host) {
    int begun;
    roburoc4_lock_take(&host->lock);
    begun = host->stopping;
    host->stopping = 1;
    roburoc4_lock_give(&host->lock);
    if (!begun) {
        roburoc4_thread_join(&host->thread);
        net_destroy(host->net);
        host->net = NULL;
    }
}

void sim_host_destroy(sim_host *host) {
    /* A forked child has no thread, and a lock in any state. */
    if (host->process == roburoc4_process_id()) {
        sim_host_stop(host);
        roburoc4_lock_destroy(&host->lock);
    }
    roburoc4_sim_destroy(host->sim);
    free_host(host);
}

uint16_t sim_host_port(const sim_host *host) {
    return host->port;
}

void sim_host_lock(sim_host *host) {
    roburoc4_lock_take(&host->lock);
}

void sim_host_unlock(sim_host *host) {
    roburoc4_lock_give(&host->lock);
}

roburoc4_result sim_host_set_faults(sim_host *host, const roburoc4_sim_faults *faults) {
    roburoc4_result result = roburoc4_sim_channel_set_faults(host->in, faults);
    return result < 0 ? result : roburoc4_sim_channel_set_faults(host->out, faults);
}
