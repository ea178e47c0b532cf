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
    if (peer == NULL || sim->config.keep_subscriptions != 0) {
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

/* ---------------------------------------------------------------------------- subscriptions --- */

static bool is_shared(const roburoc4_sim *sim) {
    return sim->config.subscription_lists != ROBUROC4_SIM_LIST_BY_SENDER;
}

/* The oldest entry of the whole list, or NULL; its size in `count`. */
static sim_subscription *oldest(roburoc4_sim *sim, uint32_t *count) {
    sim_subscription *found = NULL;
    *count = 0;
    for (uint32_t slot = 0; slot < sim->peer_count; slot++) {
        for (uint32_t service = 0; service < ROBUROC4_SERVICE_COUNT; service++) {
            sim_subscription *entry = &sim->peers[slot].subscriptions[service];
            if (entry->period_cycles == 0) {
                continue;
            }
            ++*count;
            if (found == NULL || entry->phase_cycles < found->phase_cycles) {
                found = entry;
            }
        }
    }
    return found;
}

/* Gives all entries of a service this period. */
static void set_all(roburoc4_sim *sim, uint32_t service, uint8_t period_cycles) {
    for (uint32_t slot = 0; slot < sim->peer_count; slot++) {
        sim_subscription *entry = &sim->peers[slot].subscriptions[service];
        entry->period_cycles = entry->period_cycles != 0 ? period_cycles : 0;
    }
}

uint8_t sim_peers_subscribe(roburoc4_sim *sim, uint64_t key, uint32_t service,
                            uint8_t period_cycles) {
    uint32_t count = 0;
    const int32_t slot = sim_peers_slot(sim, key);
    sim_peer *peer = slot < 0 ? sim_peers_heard(sim, key, true) : &sim->peers[slot];
    if (peer == NULL) {
        return ROBUROC4_ERROR_SERVICE; /* the table is full of active subscribers */
    }
    sim_subscription *wish = &peer->subscriptions[service];
    if (period_cycles < sim->config.min_period_cycles) {
        period_cycles = (uint8_t)sim->config.min_period_cycles;
    }
    if (is_shared(sim)) {
        bool last = sim->config.subscription_lists == ROBUROC4_SIM_LIST_LAST;
        set_all(sim, service, last && wish->period_cycles == 0 ? 0 : period_cycles);
    }
    sim_subscription *first = oldest(sim, &count);
    if (wish->period_cycles == 0 && first != NULL && count >= sim->config.max_subscriptions) {
        if (sim->config.full_list != ROBUROC4_SIM_FULL_FORGETS) {
            return sim->config.full_list == ROBUROC4_SIM_FULL_REFUSES ? ROBUROC4_ERROR_SERVICE
                                                                      : ROBUROC4_ERROR_NONE;
        }
        first->period_cycles = 0;
    }
    if (wish->period_cycles != period_cycles) {
        /* A repeated request must not shift the phase of a running subscription. */
        wish->period_cycles = period_cycles;
        wish->phase_cycles = sim->cycles;
    }
    return ROBUROC4_ERROR_NONE;
}

bool sim_peers_unsubscribe(roburoc4_sim *sim, uint64_t key, uint32_t service) {
    sim_peer *peer = sim_peers_find(sim, key);
    if (sim_peers_period(sim, peer, service) == 0) {
        return false;
    }
    if (is_shared(sim)) {
        set_all(sim, service, 0);
    } else {
        peer->subscriptions[service].period_cycles = 0;
    }
    return true;
}

uint8_t sim_peers_period(const roburoc4_sim *sim, const sim_peer *asker, uint32_t service) {
    uint8_t period = asker != NULL ? asker->subscriptions[service].period_cycles : 0;
    for (uint32_t slot = 0; period == 0 && is_shared(sim) && slot < sim->peer_count; slot++) {
        period = sim->peers[slot].subscriptions[service].period_cycles;
    }
    return period;
}
