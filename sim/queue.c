/* SPDX-License-Identifier: MIT
 *
 * The transmit queue: records of `peer, length, bytes` in a ring. It keeps what the robot sends, in
 * order and without allocation, until the caller polls for it.
 */
#include <string.h>

#include "model.h"

typedef struct record_head {
    uint64_t peer;
    uint32_t length;
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

bool sim_queue_push(sim_queue *queue, uint64_t peer, const uint8_t *data, size_t size) {
    record_head head = {peer, (uint32_t)size};
    if (size > ROBUROC4_SIM_MAX_TRANSMIT ||
        sizeof head + size > (size_t)SIM_QUEUE_BYTES - queue->used) {
        return false;
    }
    put(queue, queue->used, &head, (uint32_t)sizeof head);
    put(queue, queue->used + (uint32_t)sizeof head, data, head.length);
    queue->used += (uint32_t)sizeof head + head.length;
    return true;
}

roburoc4_result sim_queue_pop(sim_queue *queue, uint64_t *peer, uint8_t *buffer, size_t capacity) {
    if (queue->used == 0) {
        return 0;
    }
    record_head head;
    get(queue, 0, &head, (uint32_t)sizeof head);
    if (head.length > capacity) {
        return ROBUROC4_ERR_BUFFER;
    }
    get(queue, (uint32_t)sizeof head, buffer, head.length);
    *peer = head.peer;
    uint32_t taken = (uint32_t)sizeof head + head.length;
    queue->used -= taken;
    /* An empty ring starts over, so that a quiet robot uses little memory. */
    queue->head = queue->used == 0 ? 0 : (queue->head + taken) % SIM_QUEUE_BYTES;
    return (roburoc4_result)head.length;
}
