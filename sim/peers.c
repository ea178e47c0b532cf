/* SPDX-License-Identifier: MIT
 *
 * The table of peers: who subscribed, for as long as they may want it, in a fixed number of slots
 * that spoofed senders cannot take from real listeners.
 */
#include <string.h>

#include "model.h"

#define UNREACHABLE_SILENCE_US 5000000u
#define UNREACHABLE_REPORTS_US 2000000u
/* A subscriber that sent only one datagram may be spoofed: its slot is free for others soon. */
#define ONE_TIMER_SILENCE_US 1000000u
#define SUBSCRIBER_SILENCE_US 60000000u

uint32_t sim_peer_subscriptions(const sim_peer *peer) {
    uint32_t count = 0;
    for (uint32_t service = 0; service < ROBUROC4_SERVICE_COUNT; service++) {
        count += peer->subscriptions[service].period_cycles != 0 ? 1u : 0u;
    }
    return count;
}

int32_t sim_peers_slot(const roburoc4_sim *sim, uint64_t key) {
    for (uint32_t slot = 0; slot < sim->peer_count; slot++) {
        if (sim->peers[slot].datagrams != 0 && sim->peers[slot].key == key) {
            return (int32_t)slot;
        }
    }
    return -1;
}

sim_peer *sim_peers_find(roburoc4_sim *sim, uint64_t key) {
    int32_t slot = sim_peers_slot(sim, key);
    return slot < 0 ? NULL : &sim->peers[slot];
}

static int32_t free_slot(roburoc4_sim *sim) {
    for (uint32_t slot = 0; slot < sim->peer_count; slot++) {
        if (sim->peers[slot].datagrams == 0) {
            return (int32_t)slot;
        }
    }
    return sim->peer_count == ROBUROC4_SIM_MAX_PEERS ? -1 : (int32_t)sim->peer_count++;
}

/* How readily a peer's slot is given away: 0 for never, higher for sooner. */
static int readiness(const roburoc4_sim *sim, const sim_peer *peer, bool to_subscriber) {
    if (sim_peer_subscriptions(peer) == 0) {
        return 3;
    }
    uint64_t silence_us = sim->now_us - peer->heard_us;
    if (to_subscriber && peer->datagrams == 1 && silence_us >= ONE_TIMER_SILENCE_US) {
        return 2;
    }
    return to_subscriber && silence_us >= SUBSCRIBER_SILENCE_US ? 1 : 0;
}

static int32_t evictable_slot(const roburoc4_sim *sim, bool to_subscriber) {
    int32_t best = -1;
    int best_readiness = 1;
    for (uint32_t slot = 0; slot < sim->peer_count; slot++) {
        const sim_peer *peer = &sim->peers[slot];
        int ready = readiness(sim, peer, to_subscriber);
        if (ready > best_readiness ||
            (ready == best_readiness && (best < 0 || peer->heard_us < sim->peers[best].heard_us))) {
            best = (int32_t)slot;
            best_readiness = ready;
        }
    }
    return best;
}

sim_peer *sim_peers_heard(roburoc4_sim *sim, uint64_t key, bool subscribes) {
    int32_t slot = sim_peers_slot(sim, key);
    if (slot < 0) {
        slot = free_slot(sim);
        slot = slot >= 0 ? slot : evictable_slot(sim, subscribes);
        if (slot < 0) {
            return NULL;
        }
        memset(&sim->peers[slot], 0, sizeof sim->peers[slot]);
        sim->peers[slot].key = key;
    }
    sim_peer *peer = &sim->peers[slot];
    if (peer->datagrams < UINT32_MAX) {
        peer->datagrams++;
    }
    peer->heard_us = sim->now_us;
    peer->refused = false;
    return peer;
}

void sim_peers_clear(roburoc4_sim *sim) {
    memset(sim->peers, 0, sizeof sim->peers);
    sim->peer_count = 0;
}

void sim_peers_unreachable(roburoc4_sim *sim, uint64_t key) {
    sim_peer *peer = sim_peers_find(sim, key);
    if (peer == NULL) {
        return;
    }
    if (!peer->refused) {
        peer->refused = true;
        peer->refused_us = sim->now_us;
        return;
    }
    if (sim->now_us - peer->heard_us >= UNREACHABLE_SILENCE_US &&
        sim->now_us - peer->refused_us >= UNREACHABLE_REPORTS_US) {
        memset(peer, 0, sizeof *peer);
    }
}
