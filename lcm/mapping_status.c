/* SPDX-License-Identifier: MIT
 *
 * The bridge's own status: in numbers, and in a sentence.
 */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "mapping.h"
#include "roburoc4_udp.h"
#include "text.h"

#define FAULT(name) ROBUROC4_LCM_BRIDGE_STATUS_T_FAULT_##name
#define SILENT_US 1000000u

static bool is_silent(const mapping_view *view) {
    return !view->heard || view->link->silence_us >= SILENT_US;
}

static int32_t network_fault(uint32_t fault) {
    switch (fault) {
    case ROBUROC4_FAULT_NONE:
        return 0;
    case ROBUROC4_FAULT_REFUSED:
        return FAULT(REFUSED);
    case ROBUROC4_FAULT_UNREACHABLE:
        return FAULT(UNREACHABLE);
    case ROBUROC4_FAULT_DOWN:
        return FAULT(DOWN);
    case ROBUROC4_FAULT_DENIED:
        return FAULT(DENIED);
    case ROBUROC4_FAULT_FULL:
        return FAULT(BUFFERS);
    default:
        return FAULT(NETWORK);
    }
}

static int32_t fault_bits(const mapping_view *view) {
    const roburoc4_facts *facts = view->facts;
    int32_t bits = network_fault(view->fault);
    bits |= is_silent(view) ? FAULT(SILENT) : 0;
    bits |= facts->other_commander ? FAULT(OTHER_COMMANDER) : 0;
    bits |= facts->inhibited ? FAULT(INHIBITED) : 0;
    bits |= facts->front_bumper ? FAULT(FRONT_BUMPER) : 0;
    bits |= facts->rear_bumper ? FAULT(REAR_BUMPER) : 0;
    bits |= facts->battery_low ? FAULT(BATTERY_LOW) : 0;
    return bits;
}

/* Why the robot cannot be driven now: what stands in the way, else why it was disarmed. */
static int32_t reason(const mapping_view *view) {
    const roburoc4_facts *facts = view->facts;
    if (facts->armed) {
        return 0;
    }
    return facts->arm_refusal < 0 ? facts->arm_refusal : facts->disarm_cause;
}

static void map_motion(const mapping_view *view, mapping_texts *storage,
                       roburoc4_lcm_bridge_status_t *out) {
    const roburoc4_facts *facts = view->facts;
    size_t length = 0;
    const char *commander = gate_commander(view->gate, view->now.us, &length);
    text_copy(storage->commander, sizeof storage->commander, (const uint8_t *)commander, length);
    out->armed = (int8_t)facts->armed;
    out->driving = (int8_t)facts->driving;
    out->stopping = (int8_t)facts->stopping;
    out->waiting = view->waiting;
    out->override_known = (int8_t)facts->override_known;
    out->overridden = (int8_t)facts->overridden;
    out->commander = storage->commander;
    out->lease_left_us = (int32_t)facts->lease_left_us;
    out->command_age_us = view->command_us < 0 ? -1 : (int64_t)view->now.us - view->command_us;
    out->robot_age_us = view->heard ? (int64_t)view->link->silence_us : -1;
}

static void map_rules(const gate_rules *rules, roburoc4_lcm_bridge_status_t *out) {
    out->drive_enabled = rules->enabled[GATE_DRIVE];
    out->outputs_enabled = rules->enabled[GATE_OUTPUT];
    out->relocalize_enabled = rules->enabled[GATE_RELOCALIZE];
    out->command_timeout_us = (int32_t)rules->command_timeout_us;
    out->max_age_us = (int32_t)rules->max_age_us;
}

static void map_counts(const mapping_view *view, roburoc4_lcm_bridge_status_t *out) {
    const int64_t *rejected = view->gate->rejected;
    out->accepted_drive = view->gate->taken[GATE_DRIVE];
    out->accepted_relocalize = view->gate->taken[GATE_RELOCALIZE];
    out->accepted_output = view->gate->taken[GATE_OUTPUT];
    out->superseded = view->superseded;
    out->clamped = view->clamped;
    out->rejected_malformed = rejected[GATE_MALFORMED];
    out->rejected_disabled = rejected[GATE_DISABLED];
    out->rejected_sender = rejected[GATE_SENDER];
    out->rejected_no_utime = rejected[GATE_NO_UTIME];
    out->rejected_not_finite = rejected[GATE_NOT_FINITE];
    out->rejected_starting = rejected[GATE_STARTING];
    out->rejected_too_old = rejected[GATE_TOO_OLD];
    out->rejected_in_future = rejected[GATE_IN_FUTURE];
    out->rejected_repeated = rejected[GATE_REPEATED];
    out->rejected_seat = rejected[GATE_SEAT];
    out->rejected_not_ready = rejected[GATE_NOT_READY];
    out->rejected_disarmed = rejected[GATE_DISARMED];
    out->rejected_impossible = rejected[GATE_IMPOSSIBLE];
}

static void map_link(const mapping_view *view, roburoc4_lcm_bridge_status_t *out) {
    const roburoc4_link *link = view->link;
    out->round_trip_us = (int32_t)link->round_trip_us;
    out->round_trip_min_us = (int32_t)link->round_trip_min_us;
    out->received = link->received;
    out->lost = link->lost;
    out->loss = link->loss;
    out->times_lost = view->times_lost;
    out->reboots = view->reboots;
    out->published = view->published;
    out->publish_errors = view->publish_errors;
}

void mapping_bridge_status(const mapping_view *view, mapping_texts *storage,
                           roburoc4_lcm_bridge_status_t *out) {
    memset(out, 0, sizeof *out);
    out->utime = view->now.utime;
    out->robot = view->robot;
    out->state = (int32_t)view->facts->state;
    out->reason = reason(view);
    out->faults = fault_bits(view);
    mapping_message(view, storage->message, sizeof storage->message);
    out->message = storage->message;
    map_motion(view, storage, out);
    map_rules(&view->gate->rules, out);
    map_counts(view, out);
    map_link(view, out);
}

/* -------------------------------------------------------------------------------- sentence --- */

static void tell_absent(const mapping_view *view, char *room, size_t capacity) {
    const char *state = roburoc4_state_name(view->facts->state);
    (void)snprintf(room, capacity, "%s: no answer from %s; %s", state != NULL ? state : "unknown",
                   view->robot,
                   view->fault != ROBUROC4_FAULT_NONE ? roburoc4_udp_fault_text(view->fault)
                                                      : "is it on, and on this network?");
}

/* The cause without what to do against it, which is past. */
static int cause_length(const char *text) {
    return (int)strcspn(text, ":");
}

static void tell_disarmed(const mapping_view *view, char *room, size_t capacity) {
    int32_t cause = view->facts->disarm_cause;
    if (view->facts->arm_refusal < 0) {
        (void)snprintf(room, capacity, "ready, not armed: %s",
                       roburoc4_result_text(view->facts->arm_refusal));
        return;
    }
    const char *next = view->waiting ? "all senders must pause (or send zero) for 500 ms"
                                     : "the next command arms it";
    if (cause == 0 || cause == ROBUROC4_ERR_DISARMED) {
        (void)snprintf(room, capacity, "ready, disarmed; %s", next);
    } else {
        const char *text = roburoc4_result_text(cause);
        (void)snprintf(room, capacity, "ready, was disarmed (%.*s); %s", cause_length(text), text,
                       next);
    }
}

static void tell_armed(const mapping_view *view, char *room, size_t capacity) {
    char sender[GATE_MAX_SENDER + 1];
    size_t length = 0;
    const char *commander = gate_commander(view->gate, view->now.us, &length);
    if (view->waiting) {
        (void)snprintf(room, capacity, "ready, armed; all senders must pause for %u ms",
                       GATE_PAUSE_US / 1000u);
    } else if (view->facts->inhibited) {
        (void)snprintf(room, capacity,
                       "armed, but the robot stands: emergency stop, brakes, bumper?");
    } else if (view->facts->driving && commander != NULL) {
        text_copy(sender, sizeof sender, (const uint8_t *)commander, length);
        (void)snprintf(room, capacity, "driving for %s", sender);
    } else {
        (void)snprintf(room, capacity, "ready, armed");
    }
}

void mapping_message(const mapping_view *view, char *room, size_t capacity) {
    const char *state = roburoc4_state_name(view->facts->state);
    if (view->facts->state != ROBUROC4_STATE_READY) {
        if (is_silent(view)) {
            tell_absent(view, room, capacity);
        } else {
            (void)snprintf(room, capacity, "%s", state != NULL ? state : "unknown");
        }
    } else if (!view->gate->rules.enabled[GATE_DRIVE]) {
        (void)snprintf(room, capacity, "ready; driving is off (--enable-drive)");
    } else if (view->facts->armed) {
        tell_armed(view, room, capacity);
    } else {
        tell_disarmed(view, room, capacity);
    }
}
