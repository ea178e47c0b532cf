/* SPDX-License-Identifier: MIT
 *
 * The client from init to close: its states and what ends with them, in which order things are sent
 * (zeros and speeds, outputs, requests), and when it must be called again.
 */
#include "internal.h"

/* The layout of a struct that callers declare is part of the ABI. */
#define LAYOUT(name, condition) typedef char assert_##name[(condition) ? 1 : -1]
LAYOUT(slot, sizeof(roburoc4_private_slot) == 20);
LAYOUT(requests, sizeof(roburoc4_private_requests) == 96);
LAYOUT(service, sizeof(roburoc4_private_service) == 56);
LAYOUT(link, sizeof(roburoc4_private_link) == 376);
LAYOUT(drive, sizeof(roburoc4_private_drive) == 160);
LAYOUT(follow, sizeof(roburoc4_private_follow) == 32);
LAYOUT(discovery, sizeof(roburoc4_private_discovery) == 216);
LAYOUT(subscriptions, sizeof(roburoc4_private_subscriptions) == 32);
LAYOUT(values, sizeof(roburoc4_private_values) == 456);
LAYOUT(outputs, sizeof(roburoc4_private_outputs) == 64);
LAYOUT(config, sizeof(roburoc4_config) == 88);
LAYOUT(client, sizeof(roburoc4_client) == 1600);
LAYOUT(client_drive, offsetof(roburoc4_client, private_drive) == 124);
LAYOUT(client_link, offsetof(roburoc4_client, private_link) == 760);
LAYOUT(client_values, offsetof(roburoc4_client, private_values) == 1136);

/* A client that is not ready starts over after a silence of this long. */
#define PATIENCE_US (5 * SECOND)
/* The same where only texts are left to request, one at a time, and each may stay unanswered. */
#define TEXT_PATIENCE_US (15 * SECOND)
#define RELOCALIZE_US (2 * SECOND)
#define OUTPUT_PAUSE_US (50 * MS)

uint32_t roburoc4_version(void) {
    return ROBUROC4_VERSION;
}

uint32_t roburoc4_abi_version(void) {
    return ROBUROC4_ABI_VERSION;
}

size_t roburoc4_client_size(void) {
    return sizeof(client);
}

/* ---- states, and what ends with them ---- */

void roburoc4_lifecycle_enter(client *c, uint32_t state) {
    wake(c);
    if (c->private_state != state) {
        c->private_state = (uint16_t)state;
        raise_event(c, ROBUROC4_EVENT_STATE);
        raise_event(c, state == ROBUROC4_STATE_READY ? ROBUROC4_EVENT_READY : 0);
    }
    if (state != ROBUROC4_STATE_READY) {
        c->private_outputs.repeats = 0; /* the IO card may be another now */
    }
    c->private_schedule.phase_us = c->private_timer.now_us;
}

void roburoc4_lifecycle_interrupt(client *c, roburoc4_result cause) {
    wake(c);
    roburoc4_drive_interrupt(&c->private_drive, cause, &c->private_events);
}

void roburoc4_lifecycle_forget_outputs(client *c) {
    c->private_outputs.repeats = 0;
    c->private_outputs.digital = 0;
    memset(c->private_outputs.analog, 0, sizeof c->private_outputs.analog);
}

void roburoc4_lifecycle_relocalize_ends(client *c, roburoc4_result result) {
    c->private_outputs.relocalizing = 0;
    c->private_outputs.relocalize_result = result;
    raise_event(c, result < 0 ? ROBUROC4_EVENT_RELOCALIZE_FAILED : ROBUROC4_EVENT_RELOCALIZED);
}

void roburoc4_lifecycle_forget_services(client *c, uint32_t state) {
    roburoc4_discovery_restart(&c->private_discovery);
    roburoc4_subscriptions_restart(&c->private_subscriptions);
    roburoc4_requests_cancel_all(&c->private_requests, c->private_timer.now_us);
    roburoc4_link_invalidate(&c->private_link);
    forget_override(c);
    if (c->private_outputs.relocalizing) {
        roburoc4_lifecycle_relocalize_ends(c, ROBUROC4_ERR_TIMEOUT);
    }
    roburoc4_lifecycle_enter(c, state);
}

void roburoc4_lifecycle_connect(client *c, uint32_t state) {
    if (in_fixed_id_mode(
            &c->private_requests)) { /* texts read in that mode cannot identify a service */
        roburoc4_discovery_read_texts_again(&c->private_discovery);
    }
    roburoc4_requests_clear(&c->private_requests);
    roburoc4_link_restart(&c->private_link, &c->private_config);
    roburoc4_lifecycle_forget_services(c, state);
}

/** The robot has been silent for too long. */
static void lose(client *c) {
    const bool was_ready = c->private_state == ROBUROC4_STATE_READY;
    roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_LOST);
    count_up(c, ROBUROC4_COUNT_LOST);
    raise_event(c, ROBUROC4_EVENT_LOST);
    c->private_link.resubscribed = 1;
    if (!expects_statuses(c)) { /* without statuses nothing tells whether it is the same robot */
        roburoc4_lifecycle_forget_outputs(c);
        roburoc4_discovery_clear(&c->private_discovery);
    }
    roburoc4_lifecycle_connect(c, was_ready ? ROBUROC4_STATE_LOST : ROBUROC4_STATE_CONNECTING);
}

void roburoc4_lifecycle_reboot(client *c) {
    roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_REBOOT);
    count_up(c, ROBUROC4_COUNT_REBOOTS);
    raise_event(c, ROBUROC4_EVENT_REBOOT);
    c->private_link.newest_cycles = 0;
    c->private_link.resubscribed = 0; /* nothing is known of before */
    roburoc4_link_forget_times(&c->private_link, c->private_timer.now_us);
    roburoc4_lifecycle_forget_outputs(c); /* the robot switched its outputs off */
    roburoc4_discovery_clear(&c->private_discovery);
    roburoc4_lifecycle_connect(c, ROBUROC4_STATE_CONNECTING);
}

/** Every 32-bit time stamp of a client: add new ones here and in stored_times_test.cpp. */
static const uint16_t stamps[] = {
#define AT(field) (uint16_t) offsetof(client, private_##field)
    AT(drive.granted_us),
    AT(drive.sent_us),
    AT(drive.stop_us),
    AT(drive.envelope_us),
    AT(drive.heard_us),
    AT(drive.expected_us),
    AT(link.offset_since_us),
    AT(link.last_used_us),
    AT(link.asked_us),
    AT(link.heard_us),
    AT(link.card_inserted_us),
    AT(link.excess_since_us),
    AT(link.contradicted_us),
    AT(requests.quiet_since_us),
    AT(requests.slots[0].sent_us),
    AT(requests.slots[1].sent_us),
    AT(requests.slots[2].sent_us),
    AT(requests.slots[3].sent_us),
    AT(schedule.phase_us),
    AT(schedule.probe_us),
    AT(subscriptions.refused_us),
    AT(subscriptions.inserted_us[0]),
    AT(subscriptions.inserted_us[1]),
    AT(subscriptions.inserted_us[2]),
    AT(subscriptions.inserted_us[3]),
    AT(subscriptions.inserted_us[4]),
    AT(outputs.sent_us),
    AT(outputs.relocalize_us),
#undef AT
};

static uint32_t *stamp_at(client *c, uint32_t i) {
    return (uint32_t *)(void *)((uint8_t *)c + stamps[i]);
}

static void set_stamps(client *c, uint32_t us) {
    for (uint32_t i = 0; i < sizeof stamps / sizeof stamps[0]; i++) {
        *stamp_at(c, i) = us;
    }
}

/** Before the time becomes now_us: shorten what would have been longer ago than OLDEST_US. */
static void limit_ages(client *c, uint64_t now_us) {
    const uint64_t passed_us = now_us - c->private_now_us;
    for (uint32_t i = 0; i < sizeof stamps / sizeof stamps[0]; i++) {
        uint32_t *stamp = stamp_at(c, i);
        if (stamp == &c->private_outputs.relocalize_us && !c->private_outputs.relocalizing) {
            continue; /* moves compare it, to see whether the robot was relocalized */
        }
        const uint64_t age_us = (c->private_timer.now_us - *stamp) + passed_us;
        *stamp = (uint32_t)now_us - (age_us < OLDEST_US ? (uint32_t)age_us : OLDEST_US);
    }
}

/** The clock went back: restart everything that is timed. */
static void clock_fault(client *c, uint32_t now_us) {
    roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_CLOCK);
    const uint32_t heard_us = c->private_link.heard_us + now_us - c->private_timer.now_us;
    set_stamps(c, now_us);
    c->private_link.heard_us = heard_us;
    c->private_drive.sent_us -= SECOND; /* so that a zero is due at once */
    c->private_schedule.probe_us -=
        SECOND; /* so that a probe is: no age is known before its answer */
    c->private_outputs.relocalize_us -= POSE_TAKEN_US; /* perhaps longer ago: it is late */
    roburoc4_requests_rebase(&c->private_requests, now_us);
    c->private_discovery.doubted = 0; /* copies of its answer are no longer waited for */
    roburoc4_link_rebase(&c->private_link, now_us);
    count_up(c, ROBUROC4_COUNT_CLOCK_FAULTS);
    raise_event(c, ROBUROC4_EVENT_CLOCK);
}

void roburoc4_lifecycle_jump(client *c, uint64_t now_us) {
    if (now_us < c->private_now_us) {
        clock_fault(c, (uint32_t)now_us);
        return;
    }
    if (now_us - c->private_now_us >= PAUSE_US) {
        roburoc4_link_pause(&c->private_link, now_us - c->private_now_us);
    }
    if ((now_us ^ c->private_now_us) >> AGES_BITS != 0) {
        limit_ages(c, now_us);
    }
}

void roburoc4_lifecycle_see_time(client *c, uint64_t now_us) {
    see_time(c, now_us);
    if (lapses(&c->private_drive, c->private_timer.now_us)) {
        roburoc4_drive_tick(&c->private_drive, &c->private_config, ROBUROC4_OK, &c->private_timer,
                            &c->private_events);
        wake(c);
    }
}

/* ---- init, start, close ---- */

roburoc4_result roburoc4_client_init(client *c, size_t client_size, const roburoc4_config *config) {
    memset(c, 0, client_size < sizeof *c ? client_size : sizeof *c); /* idle, if still used */
    if (client_size != sizeof *c) {
        return ROBUROC4_ERR_SIZE;
    }
    if (!roburoc4_config_load(&c->private_config, config)) {
        return ROBUROC4_ERR_CONFIG;
    }
    c->private_config.size = sizeof c->private_config;
    c->private_size = sizeof *c;
    c->private_drive.disarm_cause = ROBUROC4_ERR_DISARMED;
    c->private_outputs.relocalize_result = ROBUROC4_ERR_UNKNOWN;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_start(client *c, uint64_t now_us) {
    if (c->private_size != sizeof *c || c->private_state != ROBUROC4_STATE_IDLE) {
        return ROBUROC4_ERR_STATE;
    }
    c->private_now_us = now_us;
    c->private_timer.now_us = (uint32_t)now_us;
    c->private_timer.wait_us = 0;
    const uint8_t last_id = c->private_requests.last_id;
    memset((uint8_t *)c + offsetof(client, private_conditions), 0,
           sizeof *c - offsetof(client, private_conditions));
    c->private_requests.last_id = last_id; /* late answers must not match */
    c->private_outputs.relocalize_result = ROBUROC4_ERR_UNKNOWN;
    c->private_drive.disarm_cause = ROBUROC4_ERR_DISARMED;
    roburoc4_discovery_clear(&c->private_discovery);
    set_stamps(c, c->private_timer.now_us - OLDEST_US); /* nothing has happened yet */
    c->private_link.last_used_us = c->private_timer.now_us;
    roburoc4_lifecycle_connect(c, ROBUROC4_STATE_CONNECTING);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_close(client *c, uint64_t now_us) {
    if (c->private_state == ROBUROC4_STATE_IDLE) {
        return ROBUROC4_ERR_STATE;
    }
    if (c->private_state == ROBUROC4_STATE_CLOSING) {
        return ROBUROC4_OK;
    }
    begin_call(c, now_us);
    roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_DISARMED);
    c->private_drive.stop_pending = 0;
    c->private_drive.granted_us = (uint32_t)now_us; /* no longer a lease: when it was closed */
    roburoc4_requests_clear(&c->private_requests);
    roburoc4_lifecycle_enter(c, c->private_drive.stopping ? ROBUROC4_STATE_CLOSING
                                                          : ROBUROC4_STATE_IDLE);
    return ROBUROC4_OK;
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

uint32_t roburoc4_client_state(const client *c) {
    return c->private_state;
}
