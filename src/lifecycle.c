/* SPDX-License-Identifier: MIT
 *
 * The states of a client, and what ends with them: services that are read again, a robot that is
 * lost or restarted, a clock that went back.
 */
#include "joined.h"

typedef roburoc4_client client;

void roburoc4_lifecycle_enter(client *c, uint32_t state) {
    if (c->private_state != state) {
        c->private_state = state;
        raise_event(c, ROBUROC4_EVENT_STATE);
        raise_event(c, state == ROBUROC4_STATE_READY ? ROBUROC4_EVENT_READY : 0);
    }
    if (state != ROBUROC4_STATE_READY) {
        c->private_outputs.repeats = 0; /* what is an IO card, and of what size, is to be seen */
    }
    c->private_discovery.phase_us = c->private_now_us;
}

void roburoc4_lifecycle_interrupt(client *c, roburoc4_result cause) {
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
    roburoc4_requests_cancel_all(&c->private_requests);
    roburoc4_link_spoil(&c->private_link);
    c->private_values.override_known = 0;
    if (c->private_outputs.relocalizing) {
        roburoc4_lifecycle_relocalize_ends(c, ROBUROC4_ERR_TIMEOUT);
    }
    roburoc4_lifecycle_enter(c, state);
}

void roburoc4_lifecycle_connect(client *c, uint32_t state) {
    if (c->private_requests.fixed_id) { /* what was read in that mode names nothing */
        roburoc4_discovery_read_texts_again(&c->private_discovery);
    }
    roburoc4_requests_clear(&c->private_requests);
    roburoc4_link_restart(&c->private_link);
    roburoc4_lifecycle_forget_services(c, state);
}

void roburoc4_lifecycle_lose(client *c) {
    const bool was_ready = c->private_state == ROBUROC4_STATE_READY;
    roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_LOST);
    count(c, ROBUROC4_COUNT_LOST);
    raise_event(c, ROBUROC4_EVENT_LOST);
    c->private_link.resubscribed = 1;
    roburoc4_lifecycle_connect(c, was_ready ? ROBUROC4_STATE_LOST : ROBUROC4_STATE_CONNECTING);
}

void roburoc4_lifecycle_reboot(client *c) {
    roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_REBOOT);
    count(c, ROBUROC4_COUNT_REBOOTS);
    raise_event(c, ROBUROC4_EVENT_REBOOT);
    c->private_link.newest_cycles = 0;
    c->private_link.resubscribed = 0;
    roburoc4_lifecycle_forget_outputs(c); /* its own are off again */
    roburoc4_discovery_clear(&c->private_discovery);
    roburoc4_lifecycle_connect(c, ROBUROC4_STATE_CONNECTING);
}

void roburoc4_lifecycle_clock(client *c, uint64_t now_us) {
    if (now_us < c->private_now_us) {
        roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_CLOCK);
        roburoc4_drive_rebase(&c->private_drive, now_us);
        roburoc4_requests_rebase(&c->private_requests, now_us);
        roburoc4_link_rebase(&c->private_link, now_us);
        c->private_discovery.phase_us = now_us;
        c->private_discovery.probe_us = now_us;
        c->private_outputs.sent_us = now_us;
        c->private_outputs.relocalize_us = now_us;
        count(c, ROBUROC4_COUNT_CLOCK_FAULTS);
        raise_event(c, ROBUROC4_EVENT_CLOCK);
    }
    c->private_now_us = now_us;
}
