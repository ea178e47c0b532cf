/* SPDX-License-Identifier: MIT
 *
 * Mapping of the bridge's own state, in fields and as a sentence, and of its statistics.
 */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "mapping.h"
#include "roburoc4_udp.h"
#include "text.h"

#define PROBLEM(name) ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_##name
#define SILENT_US 1000000u

static bool is_silent(const mapping_view *view) {
    return !view->heard || view->link->silence_us >= SILENT_US;
}

static int32_t network_fault(uint32_t fault) {
    switch (fault) {
    case ROBUROC4_FAULT_NONE:
        return 0;
    case ROBUROC4_FAULT_REFUSED:
        return PROBLEM(REFUSED);
    case ROBUROC4_FAULT_UNREACHABLE:
        return PROBLEM(UNREACHABLE);
    case ROBUROC4_FAULT_DOWN:
        return PROBLEM(DOWN);
    case ROBUROC4_FAULT_DENIED:
        return PROBLEM(DENIED);
    case ROBUROC4_FAULT_FULL:
        return PROBLEM(FULL);
    default:
        return PROBLEM(OTHER);
    }
}

static int32_t problem_bits(const mapping_view *view) {
    const roburoc4_facts *facts = view->facts;
    int32_t bits = network_fault(view->fault);
    bits |= is_silent(view) ? PROBLEM(SILENT) : 0;
    bits |= view->no_socket ? PROBLEM(SOCKET) : 0;
    bits |= view->other_bridge ? PROBLEM(OTHER_BRIDGE) : 0;
    bits |= facts->other_commander ? PROBLEM(OTHER_COMMANDER) : 0;
    bits |= facts->inhibited ? PROBLEM(INHIBITED) : 0;
    bits |= facts->front_bumper ? PROBLEM(FRONT_BUMPER) : 0;
    bits |= facts->rear_bumper ? PROBLEM(REAR_BUMPER) : 0;
    bits |= facts->battery_low ? PROBLEM(BATTERY_LOW) : 0;
    return bits;
}

static void map_motion(const mapping_view *view, mapping_texts *storage,
                       roburoc4_lcm_bridge_state_t *out) {
    const roburoc4_facts *facts = view->facts;
    const gate *gate = view->gate;
    size_t length = 0;
    const char *owner = gate_control_owner(gate, view->now.us, &length);
    const char *stopped_by = gate->stopped ? gate->stopped_by : "";
    text_copy(storage->owner, sizeof storage->owner, (const uint8_t *)owner, length);
    text_copy(storage->stopped_by, sizeof storage->stopped_by, (const uint8_t *)stopped_by,
              strlen(stopped_by));
    out->can_drive = gate_can_drive(gate, &view->for_gate, view->now.us);
    out->armed = (int8_t)facts->armed;
    out->driving = (int8_t)facts->driving;
    out->stopping = (int8_t)facts->stopping;
    out->stop_outcome = facts->stop_outcome;
    out->lapsed = (int8_t)facts->lapsed;
    out->awaiting_pause = gate_is_waiting(gate, view->now.us);
    out->stop_latched = gate->stopped;
    out->stopped_by = storage->stopped_by;
    out->override_known = (int8_t)facts->override_known;
    out->overridden = (int8_t)facts->overridden;
    out->front_bumper_known = (int8_t)facts->front_bumper_known;
    out->rear_bumper_known = (int8_t)facts->rear_bumper_known;
    out->battery_known = (int8_t)facts->battery_known;
    out->missing = facts->missing;
    out->relocalize_result = facts->relocalize_result;
    out->control_owner = storage->owner;
    out->lease_left_us = (int32_t)facts->lease_left_us;
    out->command_age_us = view->command_us < 0 ? -1 : (int64_t)view->now.us - view->command_us;
    out->silence_us = view->heard ? (int64_t)view->link->silence_us : -1;
}

static void map_rules(const gate_rules *rules, roburoc4_lcm_bridge_state_t *out) {
    out->drive_enabled = rules->enabled[GATE_DRIVE];
    out->outputs_enabled = rules->enabled[GATE_OUTPUT];
    out->relocalize_enabled = rules->enabled[GATE_RELOCALIZE];
    out->lease_us = (int32_t)rules->lease_us;
    out->max_age_us = (int32_t)rules->max_age_us;
}

static void map_rejection(const mapping_view *view, mapping_texts *storage,
                          roburoc4_lcm_bridge_state_t *out) {
    const char *sender = view->rejected_sender != NULL ? view->rejected_sender : "";
    text_copy(storage->rejected_sender, sizeof storage->rejected_sender, (const uint8_t *)sender,
              strlen(sender));
    out->rejected_cause = (int32_t)view->rejected;
    out->rejected_sender = storage->rejected_sender;
    out->rejected_utime = view->rejected_utime;
    out->rejected_message = (char *)(view->rejected_why != NULL ? view->rejected_why : "");
}

void mapping_bridge_state(const mapping_view *view, mapping_texts *storage,
                          roburoc4_lcm_bridge_state_t *out) {
    memset(out, 0, sizeof *out);
    out->utime = view->now.utime;
    out->robot = view->robot;
    out->bridge = (char *)view->bridge; /* LCM's encoders only read */
    out->started_utime = view->started_utime;
    out->state = (int32_t)view->facts->state;
    out->disarm_cause = view->facts->disarm_cause;
    out->arm_refusal = view->facts->arm_refusal;
    out->problems = problem_bits(view);
    mapping_message(view, storage->message, sizeof storage->message);
    out->message = storage->message;
    map_motion(view, storage, out);
    map_rejection(view, storage, out);
    map_rules(&view->gate->rules, out);
    out->version = ROBUROC4_VERSION;
}

/* ------------------------------------------------------------------------------ statistics --- */

static void map_rejections(const int64_t *rejected, roburoc4_lcm_bridge_statistics_t *out) {
    out->rejected_malformed = rejected[GATE_MALFORMED];
    out->rejected_disabled = rejected[GATE_DISABLED];
    out->rejected_sender = rejected[GATE_SENDER];
    out->rejected_no_utime = rejected[GATE_NO_UTIME];
    out->rejected_not_finite = rejected[GATE_NOT_FINITE];
    out->rejected_starting = rejected[GATE_STARTING];
    out->rejected_too_old = rejected[GATE_TOO_OLD];
    out->rejected_in_future = rejected[GATE_IN_FUTURE];
    out->rejected_repeated = rejected[GATE_REPEATED];
    out->rejected_control = rejected[GATE_CONTROL];
    out->rejected_not_ready = rejected[GATE_NOT_READY];
    out->rejected_disarmed = rejected[GATE_DISARMED];
    out->rejected_impossible = rejected[GATE_IMPOSSIBLE];
    out->rejected_units = rejected[GATE_UNITS];
}

void mapping_bridge_statistics(const mapping_view *view, roburoc4_lcm_bridge_statistics_t *out) {
    const roburoc4_link *link = view->link;
    const int64_t *taken = view->gate->taken;
    memset(out, 0, sizeof *out);
    out->utime = view->now.utime;
    out->robot = view->robot;
    out->accepted_drive = taken[GATE_DRIVE];
    out->accepted_move = view->moves;
    out->accepted_relocalize = taken[GATE_RELOCALIZE];
    out->accepted_output = taken[GATE_OUTPUT];
    out->accepted_stop = taken[GATE_STOP];
    out->superseded = view->superseded;
    out->clamped = view->clamped;
    map_rejections(view->gate->rejected, out);
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

/* -------------------------------------------------------------------------------- sentence --- */

#define PAUSE "all senders must pause (or send zero) for 500 ms"

static void write_absent(const mapping_view *view, char *room, size_t capacity) {
    const char *state = roburoc4_name(ROBUROC4_NAME_STATE, view->facts->state);
    (void)snprintf(room, capacity, "%s: no answer from %s; %s", state, view->robot,
                   view->fault != ROBUROC4_FAULT_NONE ? roburoc4_udp_fault_text(view->fault)
                                                      : "is it on, and on this network?");
}

/* Only the cause: the remedy after the colon is for something that is over. */
static int cause_length(const char *text) {
    return (int)strcspn(text, ":");
}

/* Ready; describe whether the next drive command will move the robot. */
static void write_ready(const mapping_view *view, char *room, size_t capacity) {
    const roburoc4_facts *facts = view->facts;
    const char *next =
        gate_is_waiting(view->gate, view->now.us) ? PAUSE : "the next command drives";
    if (view->gate->stopped) {
        const char *by = view->gate->stopped_by;
        (void)snprintf(room, capacity, "stopped%s%s; %s", by[0] != '\0' ? " by " : "", by, next);
    } else if (facts->armed || facts->disarm_cause == ROBUROC4_ERR_DISARMED ||
               facts->disarm_cause == ROBUROC4_ERR_STOP_CALLED) {
        (void)snprintf(room, capacity, "ready; %s", next);
    } else {
        const char *text = roburoc4_result_text(facts->disarm_cause);
        (void)snprintf(room, capacity, "ready, was disarmed (%.*s); %s", cause_length(text), text,
                       next);
    }
}

static void write_connected(const mapping_view *view, char *room, size_t capacity) {
    const roburoc4_facts *facts = view->facts;
    char sender[GATE_MAX_SENDER + 1];
    size_t length = 0;
    const char *owner = gate_control_owner(view->gate, view->now.us, &length);
    if (!view->gate->rules.enabled[GATE_DRIVE]) {
        (void)snprintf(room, capacity, "ready; driving is off (--enable-drive)");
    } else if (!facts->armed && facts->arm_refusal < 0) {
        (void)snprintf(room, capacity, "ready, not armed: %s",
                       roburoc4_result_text(facts->arm_refusal));
    } else if (facts->driving && owner != NULL) {
        text_copy(sender, sizeof sender, (const uint8_t *)owner, length);
        (void)snprintf(room, capacity, "driving for %s", sender);
    } else {
        write_ready(view, room, capacity);
    }
}

static bool is_stop_unconfirmed(const roburoc4_facts *facts) {
    return !facts->driving && (facts->stop_outcome == ROBUROC4_STOP_TIMED_OUT ||
                               facts->stop_outcome == ROBUROC4_STOP_OVERRIDDEN);
}

static void append(char *room, size_t capacity, const char *text) {
    size_t length = strlen(room);
    (void)snprintf(room + length, capacity - length, "%s", text);
}

void mapping_message(const mapping_view *view, char *room, size_t capacity) {
    const char *state = roburoc4_name(ROBUROC4_NAME_STATE, view->facts->state);
    if (view->facts->state == ROBUROC4_STATE_CLOSING || view->facts->state == ROBUROC4_STATE_IDLE) {
        (void)snprintf(room, capacity, "the bridge %s",
                       view->facts->state == ROBUROC4_STATE_IDLE ? "has ended" : "is ending");
    } else if (view->no_address) {
        (void)snprintf(room, capacity,
                       "the name %s has no address; correct it, then restart the bridge",
                       view->robot);
    } else if (view->no_socket) {
        (void)snprintf(room, capacity, "no socket for %s; retrying every second", view->robot);
    } else if (view->facts->state == ROBUROC4_STATE_READY) {
        write_connected(view, room, capacity);
    } else if (is_silent(view)) {
        write_absent(view, room, capacity);
    } else {
        (void)snprintf(room, capacity, "%s", state);
    }
    if (is_stop_unconfirmed(view->facts)) {
        append(room, capacity, "; THE STOP WAS NOT CONFIRMED by the robot");
    }
    if (view->other_bridge) {
        append(room, capacity, "; ANOTHER BRIDGE also serves this robot");
    }
}
