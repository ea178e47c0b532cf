/* SPDX-License-Identifier: MIT
 *
 * The network of the walk.
 */
#include "network.h"

#include <string.h>

#define STATUS_HEAD 11 /* what is never damaged: whose status it is, and of when */

uint32_t roll(network *n, uint32_t below) {
    n->dice ^= n->dice << 13;
    n->dice ^= n->dice >> 17;
    n->dice ^= n->dice << 5;
    return n->dice % below;
}

int chance(network *n, uint8_t of_256) {
    return roll(n, 256) < of_256;
}

static flight *free_flight(network *n) {
    size_t i;
    for (i = 0; i < NETWORK_FLIGHTS; i++) {
        if (!n->flights[i].used) {
            return &n->flights[i];
        }
    }
    return NULL;
}

/** Flip a bit behind the head of a status, or cut its end off. Answers are left whole: with a
 *  damaged one the robot seems to be another, and there is nothing to compare with. */
static void damage(network *n, flight *f) {
    if (f->to != TO_CLIENT || f->data[0] != 0xFF || f->size <= STATUS_HEAD) {
        return;
    }
    if (chance(n, 64)) {
        f->size = (uint8_t)(1 + roll(n, f->size));
    } else {
        const uint32_t at = STATUS_HEAD + roll(n, (uint32_t)f->size - STATUS_HEAD);
        f->data[at] = (uint8_t)(f->data[at] ^ 1U << roll(n, 8));
    }
}

void network_send(network *n, int to, const uint8_t *data, size_t size, uint64_t now_us) {
    int copies = chance(n, n->loss) ? 0 : chance(n, n->duplicate) ? 2 : 1;
    for (; copies > 0; copies--) {
        flight *f = free_flight(n);
        if (f == NULL || size > NETWORK_LONGEST) {
            return;
        }
        f->used = 1;
        f->to = (uint8_t)to;
        f->size = (uint8_t)size;
        f->at_us = now_us + n->delay_us + roll(n, n->jitter_us + 1);
        memcpy(f->data, data, size);
        if (chance(n, n->damage)) {
            damage(n, f);
        }
    }
}

size_t network_take(network *n, int to, uint64_t now_us, uint8_t *buffer) {
    flight *first = NULL;
    size_t i;
    for (i = 0; i < NETWORK_FLIGHTS; i++) {
        flight *f = &n->flights[i];
        if (f->used && f->to == to && f->at_us <= now_us &&
            (first == NULL || f->at_us < first->at_us)) {
            first = f;
        }
    }
    if (first == NULL) {
        return 0;
    }
    memcpy(buffer, first->data, first->size);
    first->used = 0;
    return first->size;
}

uint64_t network_next_us(const network *n) {
    uint64_t next_us = UINT64_MAX;
    size_t i;
    for (i = 0; i < NETWORK_FLIGHTS; i++) {
        if (n->flights[i].used && n->flights[i].at_us < next_us) {
            next_us = n->flights[i].at_us;
        }
    }
    return next_us;
}
