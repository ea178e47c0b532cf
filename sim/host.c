/* SPDX-License-Identifier: MIT
 *
 * One thread, which waits for datagrams or the next cycle and then calls carrier.c.
 */
#include "host.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "carrier.h"
#include "os.h"

#define FLIGHTS 4096u

struct sim_host {
    int64_t process;
    sim_carrier carrier;
    roburoc4_lock lock; /* the carrier, stopping */
    roburoc4_thread thread;
    int stopping;
    uint16_t port;
    uint8_t buffer[SIM_LONGEST_UDP];
};

/* ---------------------------------------------------------------------------------- thread --- */

static void serve(void *argument) {
    sim_host *host = argument;
    int stopping = 0;
    while (!stopping) {
        uint64_t due_us, now_us;
        roburoc4_lock_take(&host->lock);
        net_wait(host->carrier.net, false, 0); /* the lock may have been held for long */
        sim_carrier_turn(&host->carrier, net_now_us());
        due_us = sim_carrier_next_deadline(&host->carrier);
        stopping = host->stopping;
        roburoc4_lock_give(&host->lock);
        now_us = net_now_us();
        if (!stopping) {
            net_wait(host->carrier.net, false, due_us > now_us ? due_us - now_us : 0);
        }
    }
}

/* ------------------------------------------------------------------------------------- creation
 * --- */

static void free_host(sim_host *host) {
    if (host->carrier.net != NULL) {
        net_destroy(host->carrier.net);
    }
    sim_network_destroy(host->carrier.in);
    sim_network_destroy(host->carrier.out);
    free(host);
}

sim_host *sim_host_open(roburoc4_sim *sim, const char *address, uint16_t port, int *error) {
    sim_host *host = calloc(1, sizeof *host);
    *error = ENOMEM;
    if (host == NULL) {
        return NULL;
    }
    host->process = roburoc4_process_id();
    host->carrier.sim = sim;
    host->carrier.buffer = host->buffer;
    host->carrier.net = net_create(1);
    *error = host->carrier.net == NULL ? EMFILE : ENOMEM; /* if one of these fails */
    host->carrier.in = sim_network_create(NULL, 1, FLIGHTS, SIM_LONGEST_FRAME);
    host->carrier.out = sim_network_create(NULL, 2, FLIGHTS, SIM_LONGEST_FRAME);
    if (host->carrier.net != NULL && host->carrier.in != NULL && host->carrier.out != NULL) {
        *error = net_bind(host->carrier.net, 0, address, port, &host->port);
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
        net_destroy(host->carrier.net);
        host->carrier.net = NULL;
    }
}

void sim_host_destroy(sim_host *host) {
    /* A forked child has no thread, and a lock in any state. */
    if (host->process == roburoc4_process_id()) {
        sim_host_stop(host);
        roburoc4_lock_destroy(&host->lock);
    }
    roburoc4_sim_destroy(host->carrier.sim);
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
    roburoc4_result result = sim_network_set_faults(host->carrier.in, faults);
    return result < 0 ? result : sim_network_set_faults(host->carrier.out, faults);
}
