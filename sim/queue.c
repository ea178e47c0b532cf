/* SPDX-License-Identifier: MIT
 *
 * A queue: records of a head and bytes in a ring, in the order in which they were pushed. It keeps
 * what the robot sends, without allocation, until it is due and the caller polls for it.
 */
#include <string.h>

#include "model.h"

typedef struct record_head {
    uint64_t peer, due_us;
    uint32_t length;
    bool taken;
} record_head;

static void put(sim_queue *queue, uint32_t offset, const void *data, uint32_t size) {
    uint32_t at = (queue->head + offset) % SIM_QUEUE_BYTES;
    uint32_t first = size < SIM_QUEUE_BYTES - at ? size : SIM_QUEUE_BYTES - at;
    memcpy(queue->bytes + at, data, first);
    memcpy(queue->bytes, (const uint8_t *)data + first, size - first);
}

static void get(const sim_queue *queue, uint32_t offset, void *data, uint32_t size) {
    uint32_t at = (queue->head + offset) % SIM_QUEUE_BYTES;
    uint32_t first = size < SIM_QUEUE_BYTES - at ? size : SIM_QUEUE_BYTES - at;
    memcpy(data, queue->bytes + at, first);
    memcpy((uint8_t *)data + first, queue->bytes, size - first);
}

void sim_queue_clear(sim_queue *queue) {
    queue->head = 0;
    queue->used = 0;
}

bool sim_queue_push(sim_queue *queue, uint64_t peer, const uint8_t *data, size_t size,
                    uint64_t due_us) {
    record_head head = {peer, due_us, (uint32_t)size, false};
    if (size > ROBUROC4_SIM_MAX_TRANSMIT ||
        sizeof head + size > (size_t)SIM_QUEUE_BYTES - queue->used) {
        return false;
    }
    put(queue, queue->used, &head, (uint32_t)sizeof head);
    put(queue, queue->used + (uint32_t)sizeof head, data, head.length);
    queue->used += (uint32_t)sizeof head + head.length;
    return true;
}

/* Frees the records at the head that were taken. */
static void trim(sim_queue *queue) {
    while (queue->used > 0) {
        record_head head;
        get(queue, 0, &head, (uint32_t)sizeof head);
        if (!head.taken) {
            return;
        }
        uint32_t size = (uint32_t)sizeof head + head.length;
        queue->used -= size;
        queue->head = (queue->head + size) % SIM_QUEUE_BYTES;
    }
    queue->head = 0; /* an empty ring starts over, so that a quiet robot uses little memory */
}

roburoc4_result sim_queue_pop(sim_queue *queue, uint64_t now_us, uint64_t *peer, uint8_t *buffer,
                              size_t capacity) {
    record_head head;
    for (uint32_t at = 0; at < queue->used; at += (uint32_t)sizeof head + head.length) {
        get(queue, at, &head, (uint32_t)sizeof head);
        if (head.taken || head.due_us > now_us) {
            continue;
        }
        if (head.length > capacity) {
            return ROBUROC4_ERR_BUFFER;
        }
        get(queue, at + (uint32_t)sizeof head, buffer, head.length);
        *peer = head.peer;
        head.taken = true;
        put(queue, at, &head, (uint32_t)sizeof head);
        trim(queue);
        return (roburoc4_result)head.length;
    }
    return 0;
}

uint32_t *sim_queue_delay_ms(roburoc4_sim_config *config, sim_delay delay) {
    uint32_t *const all[SIM_DELAYS] = {
        &config->queue_uplink_ms,       &config->queue_answer_ms,       &config->queue_text_ms,
        &config->queue_iocard_ms,       &config->queue_telemeter_ms,    &config->queue_battery_ms,
        &config->queue_localization_ms, &config->queue_differential_ms,
    };
    return all[delay];
}

uint64_t sim_queue_due_us(roburoc4_sim *sim, sim_delay delay) {
    uint64_t due_us = sim->now_us + 1000u * (uint64_t)*sim_queue_delay_ms(&sim->config, delay);
    uint64_t *last_us = &sim->last_due_us[delay];
    *last_us = due_us > *last_us ? due_us : *last_us; /* nothing overtakes within a queue */
    return *last_us;
}
