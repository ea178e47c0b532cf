/* SPDX-License-Identifier: MIT
 *
 * One direction of a bad network. Its one job is to decide, from a seed and in virtual time, what
 * becomes of each datagram: lost, late, twice, out of order, damaged.
 */
#include <stdlib.h>
#include <string.h>

#include "model.h"

#define MAX_DATAGRAMS 65536u
#define MAX_LONGEST 65507u
#define REORDER_MIN_US 1000.0
#define REORDER_MAX_US 40000.0
#define MAX_FLIPPED_BITS 4u

typedef struct flight {
    uint64_t arrival_us, order, peer;
    uint32_t slot, length;
} flight;

struct roburoc4_sim_channel {
    roburoc4_sim_faults faults;
    roburoc4_sim_channel_counts counts;
    uint64_t random;
    uint64_t last_arrival_us; /* of those that keep their order */
    uint32_t capacity, longest, in_flight;
    flight *heap; /* by arrival, then order; behind in_flight lie the free slots */
    uint8_t *bytes;
};

/* ------------------------------------------------------------------ heap of what is on its way ---
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

/* --------------------------------------------------------------------------------- life --- */

static bool is_share(double value) {
    return value >= 0.0 && value <= 1.0;
}

bool sim_faults_are_valid(const roburoc4_sim_faults *faults) {
    return is_share(faults->loss) && is_share(faults->duplicate) && is_share(faults->reorder) &&
           is_share(faults->corrupt);
}

roburoc4_result roburoc4_sim_channel_set_faults(roburoc4_sim_channel *channel,
                                                const roburoc4_sim_faults *faults) {
    if (!sim_faults_are_valid(faults)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    channel->faults = *faults;
    return ROBUROC4_OK;
}

roburoc4_sim_channel *roburoc4_sim_channel_create(const roburoc4_sim_faults *faults, uint64_t seed,
                                                  uint32_t datagrams, uint32_t longest) {
    if (datagrams == 0 || datagrams > MAX_DATAGRAMS || longest == 0 || longest > MAX_LONGEST) {
        return NULL;
    }
    roburoc4_sim_channel *channel = calloc(1, sizeof *channel);
    if (channel == NULL) {
        return NULL;
    }
    channel->random = seed;
    channel->capacity = datagrams;
    channel->longest = longest;
    channel->heap = calloc(datagrams, sizeof *channel->heap);
    channel->bytes = calloc(datagrams, longest);
    if (channel->heap == NULL || channel->bytes == NULL ||
        (faults != NULL && roburoc4_sim_channel_set_faults(channel, faults) < 0)) {
        roburoc4_sim_channel_destroy(channel);
        return NULL;
    }
    for (uint32_t slot = 0; slot < datagrams; slot++) {
        channel->heap[slot].slot = slot;
    }
    return channel;
}

void roburoc4_sim_channel_destroy(roburoc4_sim_channel *channel) {
    if (channel != NULL) {
        free(channel->heap);
        free(channel->bytes);
        free(channel);
    }
}

/* ------------------------------------------------------------------------------- the faults --- */

static uint8_t *bytes_of(roburoc4_sim_channel *channel, const flight *one) {
    return channel->bytes + (size_t)one->slot * channel->longest;
}

static void damage(roburoc4_sim_channel *channel, flight *one) {
    uint8_t *bytes = bytes_of(channel, one);
    uint64_t luck = sim_random(&channel->random);
    if (luck % 4 == 0 && one->length > 1) {
        one->length = 1 + (uint32_t)(luck / 4 % (one->length - 1));
        return;
    }
    uint64_t first_bit = sim_random(&channel->random) % (8u * (uint64_t)one->length);
    uint64_t flips = 1 + luck / 4 % MAX_FLIPPED_BITS;
    for (uint64_t flip = 0; flip < flips; flip++) {
        /* Steps of a prime far from any field's width; the same bit is never flipped back. */
        uint64_t bit = (first_bit + flip * 37) % (8u * (uint64_t)one->length);
        bytes[bit / 8] = (uint8_t)(bytes[bit / 8] ^ 1u << bit % 8);
    }
}

static uint64_t plus(uint64_t time_us, double more_us) {
    uint64_t more = (uint64_t)more_us;
    return time_us > UINT64_MAX - more ? UINT64_MAX : time_us + more;
}

static void launch(roburoc4_sim_channel *channel, uint64_t peer, const uint8_t *data, size_t size,
                   uint64_t now_us) {
    const roburoc4_sim_faults *faults = &channel->faults;
    bool corrupt = sim_random_unit(&channel->random) < faults->corrupt;
    bool reorder = sim_random_unit(&channel->random) < faults->reorder;
    double jitter_us = sim_random_unit(&channel->random) * (double)faults->jitter_us;
    double held_us =
        REORDER_MIN_US + sim_random_unit(&channel->random) * (REORDER_MAX_US - REORDER_MIN_US);
    if (channel->in_flight == channel->capacity) {
        channel->counts.dropped++;
        return;
    }
    flight *one = &channel->heap[channel->in_flight];
    one->peer = peer;
    one->length = (uint32_t)size;
    one->order = channel->counts.pushed;
    one->arrival_us = plus(now_us, (double)faults->delay_us + jitter_us);
    memcpy(bytes_of(channel, one), data, size);
    if (reorder) {
        channel->counts.reordered++;
        one->arrival_us = plus(one->arrival_us, held_us);
    } else {
        if (one->arrival_us < channel->last_arrival_us) {
            one->arrival_us = channel->last_arrival_us;
        }
        channel->last_arrival_us = one->arrival_us;
    }
    if (corrupt) {
        channel->counts.corrupted++;
        damage(channel, one);
    }
    sift_up(channel->heap, channel->in_flight);
    channel->in_flight++;
}

void roburoc4_sim_channel_push(roburoc4_sim_channel *channel, uint64_t peer, const uint8_t *data,
                               size_t size, uint64_t now_us) {
    channel->counts.pushed++;
    if (size == 0 || size > channel->longest) {
        channel->counts.dropped++;
        return;
    }
    /* A clock that was set back must not make new datagrams wait for the old time. */
    if (channel->in_flight == 0) {
        channel->last_arrival_us = 0;
    }
    bool lost = sim_random_unit(&channel->random) < channel->faults.loss;
    bool twice = sim_random_unit(&channel->random) < channel->faults.duplicate;
    if (lost) {
        channel->counts.lost++;
        return;
    }
    launch(channel, peer, data, size, now_us);
    if (twice) {
        channel->counts.duplicated++;
        launch(channel, peer, data, size, now_us);
    }
}

/* ------------------------------------------------------------------------------- the way out ---
 */

roburoc4_result roburoc4_sim_channel_poll(roburoc4_sim_channel *channel, uint64_t now_us,
                                          uint64_t *peer, uint8_t *buffer, size_t capacity) {
    flight *first = &channel->heap[0];
    if (channel->in_flight == 0 || first->arrival_us > now_us) {
        return 0;
    }
    uint32_t length = first->length;
    if (length > capacity) {
        return ROBUROC4_ERR_BUFFER;
    }
    memcpy(buffer, bytes_of(channel, first), length);
    if (peer != NULL) {
        *peer = first->peer;
    }
    channel->in_flight--;
    swap(first, &channel->heap[channel->in_flight]);
    sift_down(channel->heap, channel->in_flight);
    channel->counts.delivered++;
    return (roburoc4_result)length;
}

uint64_t roburoc4_sim_channel_next_deadline(const roburoc4_sim_channel *channel) {
    return channel->in_flight == 0 ? UINT64_MAX : channel->heap[0].arrival_us;
}

void roburoc4_sim_channel_count(const roburoc4_sim_channel *channel,
                                roburoc4_sim_channel_counts *counts) {
    *counts = channel->counts;
}
