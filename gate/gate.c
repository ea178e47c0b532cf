/* SPDX-License-Identifier: MIT */
#include "gate.h"

#include "roburoc4.h"

#include <string.h>

/* Changes of the sender with the same cause are logged at most this often. */
#define OTHER_SENDER_US 1000000u
/* After a stall, commands from during it may still arrive for as long as it took, within these
 * limits. */
#define STALL_ECHO_MIN_US 50000u
#define STALL_ECHO_MAX_US 250000u

void gate_init(gate *gate, const gate_rules *rules, gate_time now) {
    memset(gate, 0, sizeof *gate);
    gate->rules = *rules;
    gate->start = now;
    gate->owner = GATE_SENDERS;
    gate->clock_offset_us = now.utime - (int64_t)now.us;
    gate_hold(gate, now.us);
}

/* ---------------------------------------------------------------------------------- pauses --- */

void gate_hold(gate *gate, uint64_t now_us) {
    gate->quiet_since_us = now_us;
}

bool gate_is_waiting(const gate *gate, uint64_t now_us) {
    return now_us - gate->quiet_since_us < GATE_PAUSE_US;
}

void gate_was_stalled(gate *gate, uint64_t since_us, uint64_t now_us) {
    /* the pause may have begun after since_us, with what was read before it hung */
    const uint64_t paused_us =
        since_us > gate->quiet_since_us ? since_us - gate->quiet_since_us : 0;
    gate->quiet_since_us = now_us - paused_us;
}

void gate_stop(gate *gate, const char *sender, size_t length, uint64_t now_us) {
    length = length < GATE_MAX_SENDER ? length : GATE_MAX_SENDER;
    gate_hold(gate, now_us);
    gate->owner = GATE_SENDERS;
    gate->stopped = true;
    memset(gate->stopped_by, 0, sizeof gate->stopped_by);
    if (length > 0) {
        memcpy(gate->stopped_by, sender, length);
    }
}

/* --------------------------------------------------------------------------------- senders --- */

static uint32_t find_sender(const gate *gate, const gate_command *command) {
    uint32_t at = 0;
    while (at < GATE_SENDERS &&
           (gate->senders[at].length != command->sender_length ||
            memcmp(gate->senders[at].name, command->sender, command->sender_length) != 0)) {
        at++;
    }
    return at;
}

/* An old sender may be forgotten, because its earlier commands would be rejected for their age. If
 * ages are not checked, senders are forgotten after a while, because otherwise 32 names would lock
 * out all others. From then on, a replayed log of that sender is obeyed like new commands: this is
 * the documented price of --max-age-ms 0. */
static bool is_forgettable(const gate *gate, uint32_t at, gate_time now) {
    const gate_sender *sender = &gate->senders[at];
    if (sender->length == 0) {
        return true;
    }
    if (at == gate->owner && now.us < gate->control_until_us) {
        return false;
    }
    if (gate->rules.max_age_us == 0) {
        return now.us - sender->heard_us >= GATE_FORGET_US;
    }
    for (uint32_t kind = 0; kind < GATE_KINDS; kind++) {
        if (now.utime - sender->utime[kind] <= (int64_t)gate->rules.max_age_us) {
            return false;
        }
    }
    return true;
}

/* The sender's slot. If it has none, a free one, or that of the sender that was silent for longest;
 * GATE_SENDERS if all are in use. */
static uint32_t place_of(gate *gate, const gate_command *command, gate_time now) {
    uint32_t at = find_sender(gate, command);
    if (at < GATE_SENDERS) {
        return at;
    }
    for (uint32_t other = 0; other < GATE_SENDERS; other++) {
        if (is_forgettable(gate, other, now) &&
            (at == GATE_SENDERS || gate->senders[other].heard_us < gate->senders[at].heard_us)) {
            at = other;
        }
    }
    if (at < GATE_SENDERS) {
        gate_sender *sender = &gate->senders[at];
        memset(sender, 0, sizeof *sender);
        sender->length = (uint8_t)command->sender_length;
        memcpy(sender->name, command->sender, command->sender_length);
    }
    return at;
}

const char *gate_control_owner(const gate *gate, uint64_t now_us, size_t *length) {
    if (gate->owner == GATE_SENDERS || now_us >= gate->control_until_us) {
        return NULL;
    }
    *length = gate->senders[gate->owner].length;
    return gate->senders[gate->owner].name;
}

/* ----------------------------------------------------------------------------------- times --- */

/* Forget all utimes. */
static void forget(gate *gate, gate_time now) {
    gate->start = now;
    memset(gate->senders, 0, sizeof gate->senders);
    gate->owner = GATE_SENDERS;
    gate_hold(gate, now.us);
}

int64_t gate_look_at_clock(gate *gate, gate_time now) {
    int64_t offset_us = now.utime - (int64_t)now.us;
    int64_t step_us = offset_us - gate->clock_offset_us;
    gate->clock_offset_us = offset_us;
    if (step_us <= GATE_CLOCK_SET_US && step_us >= -GATE_CLOCK_SET_US) {
        return 0;
    }
    forget(gate, now);
    return step_us;
}

bool gate_look_for_stall(gate_stall *stall, uint64_t asked_us, gate_time now, uint64_t *since_us) {
    const gate_time last = stall->last_look;
    stall->last_look = now;
    *since_us = last.us;
    if (last.us == 0 || now.us - last.us < asked_us + GATE_STALL_US) {
        return false;
    }
    const uint64_t stall_us = now.us - last.us - asked_us;
    if (now.us >= stall->until_us) {
        stall->began_utime = last.utime;
    }
    stall->until_us = now.us + (stall_us < STALL_ECHO_MIN_US   ? STALL_ECHO_MIN_US
                                : stall_us > STALL_ECHO_MAX_US ? STALL_ECHO_MAX_US
                                                               : stall_us);
    return true;
}

int64_t gate_arrival(const gate_stall *stall, int64_t utime) {
    return stall->last_look.us < stall->until_us && stall->began_utime < utime ? stall->began_utime
                                                                               : utime;
}

/* Check a command's age by its utime. Any value is possible, so no sum may overflow. */
static enum gate_verdict judge_utime(const gate *gate, int64_t utime, gate_time now) {
    int64_t max_age_us = (int64_t)gate->rules.max_age_us;
    if (utime <= 0) {
        return GATE_NO_UTIME;
    }
    if (max_age_us == 0) {
        return GATE_TAKEN;
    }
    if (utime < now.utime - max_age_us) {
        return GATE_TOO_OLD;
    }
    if (utime > now.utime + max_age_us) {
        return GATE_IN_FUTURE;
    }
    return utime <= gate->start.utime + max_age_us ? GATE_STARTING : GATE_TAKEN;
}

/* Time left of a command's lease, which began when it arrived; 0 if it has ended. The time that
 * reading a command takes does not shorten the shortest lease. */
static uint32_t lease_left(const gate *gate, const gate_command *command, gate_time now) {
    uint32_t lease_us = gate->rules.lease_us;
    if (command->lease_us > 0 && (uint32_t)command->lease_us < lease_us) {
        lease_us = (uint32_t)command->lease_us;
    }
    if (lease_us < ROBUROC4_MIN_LEASE_US) {
        lease_us = ROBUROC4_MIN_LEASE_US;
    }
    int64_t waited_us = now.utime - command->arrived_utime;
    if (waited_us <= 0) {
        return lease_us;
    }
    if (waited_us > (int64_t)lease_us) {
        return 0;
    }
    lease_us -= (uint32_t)waited_us;
    if (lease_us >= ROBUROC4_MIN_LEASE_US) {
        return lease_us;
    }
    return waited_us < GATE_READ_US ? ROBUROC4_MIN_LEASE_US : 0;
}

/* --------------------------------------------------------------------------------- verdict --- */

/* What every command must have. */
static enum gate_verdict judge_form(const gate *gate, const gate_command *command) {
    if (!gate->rules.enabled[command->kind]) {
        return GATE_DISABLED;
    }
    if (command->sender_length == 0 || command->sender_length > GATE_MAX_SENDER) {
        return GATE_SENDER;
    }
    return command->finite ? GATE_TAKEN : GATE_NOT_FINITE;
}

static enum gate_verdict judge_robot(const gate *gate, const gate_command *command,
                                     const gate_robot *robot, uint64_t now_us) {
    if (!robot->ready) {
        return GATE_NOT_READY;
    }
    if (gate_is_waiting(gate, now_us)) {
        return GATE_DISARMED;
    }
    if (command->kind == GATE_DRIVE && !robot->armed && robot->arm_refusal < 0) {
        return GATE_DISARMED;
    }
    return GATE_TAKEN;
}

/* A speed takes control for its lease; a zero gives it up. */
static void give_control(gate *gate, uint32_t place, bool zero, uint64_t until_us) {
    gate->owner = zero ? GATE_SENDERS : place;
    gate->control_until_us = until_us;
}

static enum gate_verdict judge(gate *gate, const gate_command *command, const gate_robot *robot,
                               gate_time now, uint32_t *lease_us) {
    enum gate_verdict verdict = judge_form(gate, command);
    if (verdict == GATE_TAKEN) {
        verdict = judge_utime(gate, command->utime, now);
    }
    if (verdict != GATE_TAKEN) {
        return verdict;
    }
    uint32_t place = place_of(gate, command, now);
    if (place == GATE_SENDERS) {
        return GATE_SENDER;
    }
    gate_sender *sender = &gate->senders[place];
    sender->heard_us = now.us;
    if (command->utime <= sender->utime[command->kind]) {
        return GATE_REPEATED;
    }
    sender->utime[command->kind] = command->utime;
    *lease_us = lease_left(gate, command, now);
    if (*lease_us == 0) {
        return GATE_TOO_OLD;
    }
    if (gate->owner != GATE_SENDERS && gate->owner != place && now.us < gate->control_until_us) {
        return GATE_CONTROL;
    }
    verdict = judge_robot(gate, command, robot, now.us);
    if (verdict == GATE_TAKEN && command->kind == GATE_DRIVE) {
        give_control(gate, place, command->zero, now.us + *lease_us);
    }
    return verdict;
}

enum gate_verdict gate_judge(gate *gate, const gate_command *command, const gate_robot *robot,
                             gate_time now, uint32_t *lease_us) {
    enum gate_verdict verdict = judge(gate, command, robot, now, lease_us);
    if (verdict == GATE_TAKEN) {
        return verdict;
    }
    gate_reject(gate, verdict);
    /* Every request for motion makes the wait begin anew, whoever sends it: until all senders have
     * paused, none may drive. */
    bool asks_for_motion =
        command->kind == GATE_DRIVE && gate->rules.enabled[GATE_DRIVE] && !command->zero;
    if (asks_for_motion && judge_robot(gate, command, robot, now.us) != GATE_TAKEN) {
        gate_hold(gate, now.us);
    }
    return verdict;
}

void gate_count_taken(gate *gate, enum gate_kind kind) {
    gate->taken[kind]++;
}

void gate_reject(gate *gate, enum gate_verdict verdict) {
    gate->rejected[verdict]++;
}

bool gate_is_incident(gate *gate, enum gate_verdict verdict, const char *sender, size_t length,
                      uint64_t now_us) {
    gate_incident *last = &gate->incidents[verdict];
    length = length < GATE_MAX_SENDER ? length : GATE_MAX_SENDER;
    bool same = strlen(last->sender) == length &&
                (length == 0 || memcmp(last->sender, sender, length) == 0);
    bool first = last->logged_us == 0 || now_us - last->last_us >= GATE_INCIDENT_US ||
                 (!same && now_us - last->logged_us >= OTHER_SENDER_US);
    last->last_us = now_us;
    if (first) {
        last->logged_us = now_us;
    }
    memset(last->sender, 0, sizeof last->sender);
    if (length > 0) {
        memcpy(last->sender, sender, length);
    }
    return first;
}

bool gate_can_drive(const gate *gate, const gate_robot *robot, uint64_t now_us) {
    static const gate_command drive = {.kind = GATE_DRIVE};
    return gate->rules.enabled[GATE_DRIVE] &&
           judge_robot(gate, &drive, robot, now_us) == GATE_TAKEN;
}
