/* SPDX-License-Identifier: MIT */
#include "gate.h"

#include <string.h>

#include "roburoc4.h"

void gate_init(gate *gate, const gate_rules *rules, gate_time now) {
    memset(gate, 0, sizeof *gate);
    gate->rules = *rules;
    gate->start = now;
    gate->seat = GATE_SENDERS;
    gate->fresh = true;
    gate->arms_alone = true;
}

/* ---------------------------------------------------------------------------------- pauses --- */

void gate_hold(gate *gate, uint64_t now_us) {
    gate->held = true;
    gate->fresh = false;
    gate->quiet_since_us = now_us;
}

bool gate_is_waiting(const gate *gate, uint64_t now_us) {
    return gate->held && now_us - gate->quiet_since_us < GATE_PAUSE_US;
}

void gate_armed(gate *gate) {
    gate->fresh = false;
    gate->arms_alone = false;
}

/* Refusals that end by themselves while a robot that nobody touches is being read. */
static bool is_early(int32_t refusal) {
    switch (refusal) {
    case ROBUROC4_ERR_NOT_READY:
    case ROBUROC4_ERR_NO_DIFFERENTIAL:
    case ROBUROC4_ERR_LIMITS:
    case ROBUROC4_ERR_STALE_DIFFERENTIAL:
    case ROBUROC4_ERR_STALE_IOCARD:
    case ROBUROC4_ERR_OVERRIDE_UNKNOWN:
        return true;
    default:
        return false;
    }
}

/* Whether only the robot itself can stand in the way of its first arming. */
static bool may_arm_alone(const gate *gate, const gate_robot *robot, uint64_t now_us) {
    return gate->rules.enabled[GATE_DRIVE] && gate->arms_alone && robot->ready && !robot->armed &&
           !gate_is_waiting(gate, now_us);
}

void gate_tick(gate *gate, const gate_robot *robot, uint64_t now_us) {
    if (may_arm_alone(gate, robot, now_us) && robot->arm_refusal < 0 &&
        !is_early(robot->arm_refusal)) {
        gate_hold(gate, now_us); /* in other hands: a planner that streams already must pause */
    }
}

bool gate_wants_arming(const gate *gate, const gate_robot *robot, uint64_t now_us) {
    return may_arm_alone(gate, robot, now_us) && robot->arm_refusal >= 0;
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

/* What an old sender sent is rejected for its age already, so it may be forgotten. Without ages a
 * sender must be forgotten some day, or programs with names of their own would lock all others out;
 * from then on its log is as good as new, which --max-age 0 says. */
static bool is_forgettable(const gate *gate, uint32_t at, gate_time now) {
    const gate_sender *sender = &gate->senders[at];
    if (sender->length == 0) {
        return true;
    }
    if (at == gate->seat && now.us < gate->seat_until_us) {
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

/* The sender's place; where it has none, a free one, or that of who was silent for longest;
 * GATE_SENDERS where all are in use. */
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
        if (gate->seat == at) {
            gate->seat = GATE_SENDERS;
        }
    }
    return at;
}

const char *gate_commander(const gate *gate, uint64_t now_us, size_t *length) {
    if (gate->seat == GATE_SENDERS || now_us >= gate->seat_until_us) {
        return NULL;
    }
    *length = gate->senders[gate->seat].length;
    return gate->senders[gate->seat].name;
}

/* ----------------------------------------------------------------------------------- times --- */

void gate_clock_was_set(gate *gate, gate_time now) {
    gate->start = now;
    memset(gate->senders, 0, sizeof gate->senders);
    gate->seat = GATE_SENDERS;
    gate_hold(gate, now.us);
}

/* Whether a utime says that the command is alive. The values of a wire: no sum may overflow. */
static enum gate_verdict judge_utime(const gate *gate, int64_t utime, gate_time now) {
    int64_t max_age_us = (int64_t)gate->rules.max_age_us;
    if (utime <= 0) {
        return GATE_NO_UTIME;
    }
    if (now.us - gate->start.us < GATE_START_US) {
        return GATE_STARTING;
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

/* What is left of a command's lease, which began when it arrived; 0 where it is over. The shortest
 * lease is not shortened by the moment that it takes to read a command. */
static uint32_t lease_left(const gate *gate, const gate_command *command, gate_time now) {
    uint32_t lease_us = gate->rules.command_timeout_us;
    if (command->lease_us > 0 && (uint32_t)command->lease_us < lease_us) {
        lease_us = (uint32_t)command->lease_us;
    }
    if (lease_us < GATE_MIN_LEASE_US) {
        lease_us = GATE_MIN_LEASE_US;
    }
    int64_t waited_us = now.utime - command->arrived_utime;
    if (waited_us <= 0) {
        return lease_us;
    }
    if (waited_us > (int64_t)lease_us) {
        return 0;
    }
    lease_us -= (uint32_t)waited_us;
    if (lease_us >= GATE_MIN_LEASE_US) {
        return lease_us;
    }
    return waited_us < GATE_READ_US ? GATE_MIN_LEASE_US : 0;
}

/* --------------------------------------------------------------------------------- verdict --- */

/* What a command must have to be one. */
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
    if (gate->seat != GATE_SENDERS && gate->seat != place && now.us < gate->seat_until_us) {
        return GATE_SEAT;
    }
    verdict = judge_robot(gate, command, robot, now.us);
    /* Who switches a lamp takes no seat, and neither prolongs nor shortens its own. */
    if (verdict == GATE_TAKEN && command->kind == GATE_DRIVE) {
        gate->seat = place;
        gate->seat_until_us = now.us + *lease_us;
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
    /* Whoever asks for motion keeps all waiting; and who goes on while the robot is away or in
     * other hands must pause once it is back. */
    bool asks_for_motion =
        command->kind == GATE_DRIVE && gate->rules.enabled[GATE_DRIVE] && !command->zero;
    bool away = !gate->fresh && judge_robot(gate, command, robot, now.us) != GATE_TAKEN;
    if (asks_for_motion && away) {
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

int64_t gate_rejections(const gate *gate) {
    int64_t sum = 0;
    for (uint32_t cause = 0; cause < GATE_VERDICTS; cause++) {
        sum += gate->rejected[cause];
    }
    return sum;
}
