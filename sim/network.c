/* SPDX-License-Identifier: MIT
 *
 * One direction of a faulty network. A seed decides, in virtual time, whether each datagram is
 * lost, delayed, duplicated, reordered or corrupted.
 */
#include <stdlib.h>
#include <string.h>

#include "model.h"
#include "network.h"

#define MAX_DATAGRAMS 65536u
#define MAX_LONGEST 65507u
#define REORDER_MIN_US 1000.0
#define REORDER_MAX_US 40000.0
#define MAX_FLIPPED_BITS 4u

typedef struct flight {
    uint64_t arrival_us, order, peer;
    uint32_t slot, length;
} flight;

struct sim_network {
    roburoc4_sim_faults faults;
    uint64_t random, pushed;
    uint64_t last_arrival_us; /* of the datagrams that are not reordered */
    uint32_t capacity, longest, in_flight;
    flight *heap; /* by arrival, then order; free slots from in_flight on */
    uint8_t *bytes;
};

/* ------------------------------------------------------------------ heap of datagrams in flight
 * ---
 */

static bool earlier(const flight *a, const flight *b) {
    return a->arrival_us != b->arrival_us ? a->arrival_us < b->arrival_us : a->order < b->order;
}

static void swap(flight *a, flight *b) {
    flight kept = *a;
    *a = *b;
    *b = kept;
}

static void sift_up(flight *heap, uint32_t at) {
    while (at > 0 && earlier(&heap[at], &heap[(at - 1) / 2])) {
        swap(&heap[at], &heap[(at - 1) / 2]);
        at = (at - 1) / 2;
    }
}

static void sift_down(flight *heap, uint32_t count) {
    uint32_t at = 0;
    for (;;) {
        uint32_t least = at;
        for (uint32_t child = 2 * at + 1; child <= 2 * at + 2; child++) {
            if (child < count && earlier(&heap[child], &heap[least])) {
                least = child;
            }
        }
        if (least == at) {
            return;
        }
        swap(&heap[at], &heap[least]);
        at = least;
    }
}

/* --------------------------------------------------------------------------------- creation --- */

static bool is_share(double value) {
    return value >= 0.0 && value <= 1.0;
}

roburoc4_result sim_faults_take(roburoc4_sim_faults *out, const roburoc4_sim_faults *faults) {
    roburoc4_sim_faults all = {0};
    if (!sim_size_is_valid(faults->size, sizeof all)) {
        return ROBUROC4_ERR_SIZE;
    }
    memcpy(&all, faults, faults->size);
    if (!is_share(all.loss) || !is_share(all.duplicate) || !is_share(all.reorder) ||
        !is_share(all.corrupt)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    *out = all;
    out->size = sizeof *out;
    return ROBUROC4_OK;
}

roburoc4_result sim_network_set_faults(sim_network *network, const roburoc4_sim_faults *faults) {
    return sim_faults_take(&network->faults, faults);
}

sim_network *sim_network_create(const roburoc4_sim_faults *faults, uint64_t seed,
                                uint32_t datagrams, uint32_t longest) {
    if (datagrams == 0 || datagrams > MAX_DATAGRAMS || longest == 0 || longest > MAX_LONGEST) {
        return NULL;
    }
    sim_network *network = calloc(1, sizeof *network);
    if (network == NULL) {
        return NULL;
    }
    network->random = seed;
    network->capacity = datagrams;
    network->longest = longest;
    network->heap = calloc(datagrams, sizeof *network->heap);
    network->bytes = calloc(datagrams, longest);
    if (network->heap == NULL || network->bytes == NULL ||
        (faults != NULL && sim_network_set_faults(network, faults) < 0)) {
        sim_network_destroy(network);
        return NULL;
    }
    for (uint32_t slot = 0; slot < datagrams; slot++) {
        network->heap[slot].slot = slot;
    }
    return network;
}

void sim_network_destroy(sim_network *network) {
    if (network != NULL) {
        free(network->heap);
        free(network->bytes);
        free(network);
    }
}

/* ------------------------------------------------------------------------------- faults --- */

static uint8_t *bytes_of(sim_network *network, const flight *one) {
    return network->bytes + (size_t)one->slot * network->longest;
}

static void damage(sim_network *network, flight *one) {
    uint8_t *bytes = bytes_of(network, one);
    uint64_t luck = sim_random(&network->random);
    if (luck % 4 == 0 && one->length > 1) {
        one->length = 1 + (uint32_t)(luck / 4 % (one->length - 1));
        return;
    }
    uint64_t first_bit = sim_random(&network->random) % (8u * (uint64_t)one->length);
    uint64_t flips = 1 + luck / 4 % MAX_FLIPPED_BITS;
    for (uint64_t flip = 0; flip < flips; flip++) {
        /* Steps of a prime, unrelated to any field's width; no bit is flipped twice. */
        uint64_t bit = (first_bit + flip * 37) % (8u * (uint64_t)one->length);
        bytes[bit / 8] = (uint8_t)(bytes[bit / 8] ^ 1u << bit % 8);
    }
}

static uint64_t plus(uint64_t time_us, double more_us) {
    uint64_t more = (uint64_t)more_us;
    return time_us > UINT64_MAX - more ? UINT64_MAX : time_us + more;
}

static void launch(sim_network *network, uint64_t peer, const uint8_t *data, size_t size,
                   uint64_t now_us) {
    const roburoc4_sim_faults *faults = &network->faults;
    bool corrupt = sim_random_unit(&network->random) < faults->corrupt;
    bool reorder = sim_random_unit(&network->random) < faults->reorder;
    double jitter_us = sim_random_unit(&network->random) * (double)faults->jitter_us;
    double held_us =
        REORDER_MIN_US + sim_random_unit(&network->random) * (REORDER_MAX_US - REORDER_MIN_US);
    if (network->in_flight == network->capacity) {
        return;
    }
    flight *one = &network->heap[network->in_flight];
    one->peer = peer;
    one->length = (uint32_t)size;
    one->order = network->pushed;
    one->arrival_us = plus(now_us, (double)faults->delay_us + jitter_us);
    memcpy(bytes_of(network, one), data, size);
    if (reorder) {
        one->arrival_us = plus(one->arrival_us, held_us);
    } else {
        if (one->arrival_us < network->last_arrival_us) {
            one->arrival_us = network->last_arrival_us;
        }
        network->last_arrival_us = one->arrival_us;
    }
    if (corrupt) {
        damage(network, one);
    }
    sift_up(network->heap, network->in_flight);
    network->in_flight++;
}

void sim_network_push(sim_network *network, uint64_t peer, const uint8_t *data, size_t size,
                      uint64_t now_us) {
    network->pushed++;
    if (size == 0 || size > network->longest) {
        return;
    }
    /* After a clock was set back, new datagrams must not wait for the old time. */
    if (network->in_flight == 0) {
        network->last_arrival_us = 0;
    }
    bool lost = sim_random_unit(&network->random) < network->faults.loss;
    bool twice = sim_random_unit(&network->random) < network->faults.duplicate;
    if (lost) {
        return;
    }
    launch(network, peer, data, size, now_us);
    if (twice) {
        launch(network, peer, data, size, now_us);
    }
}

/* ------------------------------------------------------------------------------- receiving ---
 */

roburoc4_result sim_network_poll(sim_network *network, uint64_t now_us, uint64_t *peer,
                                 uint8_t *buffer, size_t capacity) {
    flight *first = &network->heap[0];
    if (network->in_flight == 0 || first->arrival_us > now_us) {
        return 0;
    }
    uint32_t length = first->length;
    if (length > capacity) {
        return ROBUROC4_ERR_BUFFER;
    }
    memcpy(buffer, bytes_of(network, first), length);
    if (peer != NULL) {
        *peer = first->peer;
    }
    network->in_flight--;
    swap(first, &network->heap[network->in_flight]);
    sift_down(network->heap, network->in_flight);
    return (roburoc4_result)length;
}

uint64_t sim_network_next_deadline(const sim_network *network) {
    return network->in_flight == 0 ? UINT64_MAX : network->heap[0].arrival_us;
}
