/* SPDX-License-Identifier: MIT
 *
 * In which order a client sends (zeros and speeds, outputs, requests), after which silence the
 * robot is lost, and when the client must be called again.
 */
#include "lifecycle.h"

/* A client that is not ready starts over after a silence this long. */
#define PATIENCE_US (5 * SECOND)
/* The same where only texts are left to request, one at a time, and each may stay unanswered. */
#define TEXT_PATIENCE_US (15 * SECOND)
#define RELOCALIZE_US (2 * SECOND)
#define OUTPUT_PAUSE_US (50 * MS)

/** The robot has been silent for too long. */
static void lose(client *c) {
    const bool was_ready = c->private_state == ROBUROC4_STATE_READY;
    roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_LOST);
    count_up(c, ROBUROC4_COUNT_LOST);
    raise_event(c, ROBUROC4_EVENT_LOST);
    c->private_link.was_lost = 1;
    if (!expects_statuses(c)) { /* without statuses nothing tells whether it is the same robot */
        roburoc4_lifecycle_forget_outputs(c);
        roburoc4_discovery_clear(&c->private_discovery);
    }
    roburoc4_lifecycle_connect(c, was_ready ? ROBUROC4_STATE_LOST : ROBUROC4_STATE_CONNECTING);
}

/** The silence after which the robot is lost: at least three of the shortest period. */
static uint32_t patience_us(const client *c) {
    uint32_t patience_us = c->private_config.lost_ms * MS;
    uint32_t shortest_us = SECOND;
    if (c->private_state != ROBUROC4_STATE_READY) {
        return PATIENCE_US;
    }
    if (in_fixed_id_mode(&c->private_requests) && !expects_statuses(c)) {
        return TEXT_PATIENCE_US;
    }
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        const uint32_t period_us = c->private_config.period_ms[i + ROBUROC4_SERVICE_IOCARD] * MS;
        if ((c->private_subscriptions.acked & service_bit(i + ROBUROC4_SERVICE_IOCARD)) != 0) {
            shortest_us = at_most(shortest_us, period_us);
        }
    }
    return patience_us > 3 * shortest_us ? patience_us : 3 * shortest_us;
}

/* ---- sending ---- */

/** Outputs are sent three times, because the robot does not confirm them. */
static roburoc4_result poll_outputs(client *c, uint8_t *buffer, size_t capacity) {
    roburoc4_private_outputs *o = &c->private_outputs;
    const int32_t *counts = c->private_values.io_counts;
    uint8_t blocks[ROBUROC4_MAX_DIGITAL_OUTPUTS / 8];
    if (o->repeats == 0 || !due(&c->private_timer, o->sent_us, OUTPUT_PAUSE_US)) {
        return 0;
    }
    for (uint32_t i = 0; i < sizeof blocks; i++) {
        blocks[i] = (uint8_t)(o->digital >> (8 * i));
    }
    o->repeats--;
    o->sent_us = c->private_timer.now_us;
    return roburoc4_encode_iocard_command(buffer, capacity,
                                          c->private_discovery.service_ids[ROBUROC4_SERVICE_IOCARD],
                                          o->analog, (size_t)counts[ROBUROC4_IO_ANALOG_OUTPUT],
                                          blocks, (size_t)counts[ROBUROC4_IO_DIGITAL_OUTPUT]);
}

static void tick(client *c) {
    timer *t = &c->private_timer;
    if (connected(c) && due(t, c->private_link.last_used_us, patience_us(c))) {
        lose(c);
    }
    roburoc4_conditions_tick(c);
    if (c->private_outputs.relocalizing &&
        due(t, c->private_outputs.relocalize_us, RELOCALIZE_US)) {
        roburoc4_requests_cancel(&c->private_requests, ROBUROC4_ACTION_REPLACE,
                                 ROBUROC4_SERVICE_LOCALIZATION, t->now_us);
        roburoc4_lifecycle_relocalize_ends(c, ROBUROC4_ERR_TIMEOUT);
    }
    if (c->private_state == ROBUROC4_STATE_READY) {
        roburoc4_subscriptions_renew_silent(&c->private_subscriptions, &c->private_config,
                                            &c->private_link, c->private_now_us, t);
    }
}

/** Everything that may be due, the most urgent first. */
APART roburoc4_result poll_all(client *c, uint8_t *buffer, size_t capacity, uint64_t now_us) {
    float speeds[2];
    roburoc4_result length = 0;
    begin_call(c, now_us);
    c->private_timer.wait_us = UINT32_MAX;
    tick(c);
    if (roburoc4_drive_poll(&c->private_drive, &c->private_config, &c->private_values.limits,
                            &c->private_timer, speeds, &c->private_events)) {
        length = roburoc4_encode_differential_command(buffer, capacity, c->private_drive.service,
                                                      speeds[0], speeds[1]);
    } else if (c->private_state == ROBUROC4_STATE_CLOSING) {
        if (!c->private_drive.stopping) {
            roburoc4_lifecycle_enter(c, ROBUROC4_STATE_IDLE);
        } else if (roburoc4_drive_asks(&c->private_drive, &c->private_timer)) {
            length = roburoc4_schedule_poll(c, buffer, capacity);
        }
    } else {
        length = poll_outputs(c, buffer, capacity);
        if (length == 0) {
            length = roburoc4_schedule_poll(c, buffer, capacity);
        }
    }
    if (length > 0) {
        count_up(c, ROBUROC4_COUNT_SENT);
    } else { /* it asked of everything whether it is due */
        c->private_idle_until_us = now_us + c->private_timer.wait_us;
    }
    return length;
}

roburoc4_result roburoc4_client_poll_transmit(client *c, uint8_t *buffer, size_t capacity,
                                              uint64_t now_us) {
    if (capacity < ROBUROC4_MAX_TRANSMIT) {
        return ROBUROC4_ERR_BUFFER;
    }
    if (c->private_state == ROBUROC4_STATE_IDLE) {
        return 0;
    }
    if (now_us >= c->private_now_us && now_us < c->private_idle_until_us) {
        see_time(c, now_us);
        return 0; /* nothing changed since this deadline was computed */
    }
    return poll_all(c, buffer, capacity, now_us);
}

uint64_t roburoc4_client_next_deadline(const client *c) {
    return c->private_state == ROBUROC4_STATE_IDLE ? UINT64_MAX : c->private_idle_until_us;
}

uint32_t roburoc4_client_take_events(client *c) {
    const uint32_t events = c->private_events;
    c->private_events = 0;
    return events;
}
