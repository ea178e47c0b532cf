/* SPDX-License-Identifier: MIT
 *
 * A client's life from init to close: its states, what ends with them, and its clock.
 */
#include "lifecycle.h"

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
LAYOUT(config, sizeof(roburoc4_config) == 96);
LAYOUT(client, sizeof(roburoc4_client) == 1624);
LAYOUT(client_drive, offsetof(roburoc4_client, private_drive) == 132);
LAYOUT(client_link, offsetof(roburoc4_client, private_link) == 768);
LAYOUT(client_values, offsetof(roburoc4_client, private_values) == 1144);

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

void roburoc4_lifecycle_reboot(client *c) {
    roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_REBOOT);
    count_up(c, ROBUROC4_COUNT_REBOOTS);
    raise_event(c, ROBUROC4_EVENT_REBOOT);
    c->private_link.newest_cycles = 0;
    c->private_link.was_lost = 0; /* nothing is known of before */
    roburoc4_link_forget_times(&c->private_link, c->private_timer.now_us);
    roburoc4_lifecycle_forget_outputs(c); /* the robot switched its outputs off */
    roburoc4_discovery_clear(&c->private_discovery);
    roburoc4_lifecycle_connect(c, ROBUROC4_STATE_CONNECTING);
}

/* ---- its clock ---- */

/** Every 32-bit time stamp of a client: add new ones here and in stored_times_test.cpp. */
static const uint16_t stamps[] = {
#define AT(field) (uint16_t) offsetof(client, private_##field)
    AT(drive.granted_us),
    AT(drive.sent_us),
    AT(drive.stop_us),
    AT(drive.envelope_us),
    AT(drive.reached_us),
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
    AT(answered_us),
    AT(driven_us),
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
    memset(c, 0, client_size < sizeof *c ? client_size : sizeof *c); /* idle, if used anyway */
    if (client_size != sizeof *c) {
        return ROBUROC4_ERR_SIZE;
    }
    if (!roburoc4_config_load(&c->private_config, config)) {
        return ROBUROC4_ERR_CONFIG;
    }
    c->private_config.size = sizeof c->private_config;
    c->private_size = sizeof *c;
    c->private_drive.disarm_cause = ROBUROC4_ERR_DISARMED;
    c->private_outputs.relocalize_result = ROBUROC4_ERR_NOT_KNOWN;
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
    c->private_outputs.relocalize_result = ROBUROC4_ERR_NOT_KNOWN;
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

uint32_t roburoc4_client_state(const client *c) {
    return c->private_state;
}
