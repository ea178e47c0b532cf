/* SPDX-License-Identifier: MIT
 *
 * The gate: which commands from the network may reach the robot, and how many may not, by cause. A
 * pure state machine: times and facts in, a verdict out; no clock, no socket. The bridges share it;
 * it is not part of the public libraries.
 *
 * It promises that a command passes only if
 *
 * - its kind is enabled, and it has a sender, a utime, and finite values;
 * - it is no older and no further in the future than max_age_us, its utime is later than the last
 *   of its sender and kind, and it was sent after the gate started: a log that is replayed moves
 *   nothing;
 * - no other sender is in control. A speed takes control until its lease ends; zeros and commands
 *   of the other kinds neither take nor keep it;
 * - the robot is ready, and (to drive) armed, or can be armed;
 * - nobody has asked for a speed for GATE_PAUSE_US since the start, the last disarm and the last
 *   stop command.
 *
 * A replay within max_age_us of the original is caught by the sender's last utime, one across a
 * restart by the start rule: what was sent before the start has a utime of at most
 * start + max_age_us, even if the sender's clock is ahead.
 */
#ifndef ROBUROC4_GATE_H
#define ROBUROC4_GATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GATE_PAUSE_US 500000u
#define GATE_MAX_SENDER 63
#define GATE_SENDERS 32
/* Where ages are not checked, a sender is remembered for this long after its last command. */
#define GATE_FORGET_US 60000000u
/* The shortest and the longest lease that the client accepts. */
#define GATE_MIN_LEASE_US 20000u
#define GATE_MAX_LEASE_US 1000000u
/* Rejections of one cause are one incident until none came for this long. */
#define GATE_INCIDENT_US 5000000u
/* The wall clock was set when it moved by more than this against the other one. */
#define GATE_CLOCK_SET_US 100000
/* Longer than this a command's lease may not begin late. */
#define GATE_STALL_US 20000u
/* A command is read within this time, except on a machine that is too busy. */
#define GATE_READ_US 10000

/* The kinds of command; a stop is obeyed without being judged. */
enum gate_kind { GATE_DRIVE, GATE_RELOCALIZE, GATE_OUTPUT, GATE_STOP, GATE_KINDS };

/* As REJECTED_* of LCM's bridge_state_t. */
enum gate_verdict {
    GATE_TAKEN,
    GATE_MALFORMED,
    GATE_DISABLED,
    GATE_SENDER,
    GATE_NO_UTIME,
    GATE_NOT_FINITE,
    GATE_STARTING,
    GATE_TOO_OLD,
    GATE_IN_FUTURE,
    GATE_REPEATED,
    GATE_CONTROL,
    GATE_NOT_READY,
    GATE_DISARMED,
    GATE_IMPOSSIBLE,
    GATE_VERDICTS
};

typedef struct gate_rules {
    bool enabled[GATE_KINDS];
    uint32_t command_timeout_us; /* default and longest lease: GATE_MIN_ to GATE_MAX_LEASE_US */
    uint32_t max_age_us;         /* 0: ages are not checked */
} gate_rules;

/* Both clocks, read together. */
typedef struct gate_time {
    uint64_t us;   /* never goes back */
    int64_t utime; /* microseconds since 1970 */
} gate_time;

/* What the gate has to know of a command. */
typedef struct gate_command {
    enum gate_kind kind;
    const char *sender; /* sender_length bytes, no NUL needed */
    size_t sender_length;
    int64_t utime;
    int64_t arrived_utime; /* this machine's clock when it came in */
    int32_t lease_us;      /* its own; 0 or less for the default */
    bool finite;
    bool zero; /* asks for no motion */
} gate_command;

/* What the gate has to know of the robot. */
typedef struct gate_robot {
    bool ready;
    bool armed;
    int32_t arm_refusal; /* why arming would be refused: ROBUROC4_ERR_*, or 0 */
} gate_robot;

/* A sender, and the latest utime of each kind that was received from it. */
typedef struct gate_sender {
    uint8_t length; /* 0: free */
    char name[GATE_MAX_SENDER];
    int64_t utime[GATE_KINDS];
    uint64_t heard_us;
} gate_sender;

/* The last rejection of a cause. */
typedef struct gate_incident {
    uint64_t last_us, logged_us; /* 0: never */
    char sender[GATE_MAX_SENDER + 1];
} gate_incident;

typedef struct gate {
    gate_rules rules;
    gate_time start;
    gate_sender senders[GATE_SENDERS];
    uint64_t control_until_us;
    uint64_t quiet_since_us; /* the last hold, or the last request for a speed while held */
    uint32_t owner;          /* index of the sender in control, or GATE_SENDERS */
    bool stopped;            /* by a stop command, and no speed was obeyed since */
    char stopped_by[GATE_MAX_SENDER + 1];
    int64_t taken[GATE_KINDS];
    int64_t rejected[GATE_VERDICTS];
    gate_incident incidents[GATE_VERDICTS];
    int64_t clock_offset_us; /* of the wall clock, to notice that it was set */
} gate;

/* Looks for times in which this process hung; see gate_look_for_stall(). */
typedef struct gate_stall {
    gate_time last_look;
    int64_t began_utime; /* of the last stall ... */
    uint64_t until_us;   /* ... and until when commands from during it may still come in */
} gate_stall;

/* A gate that starts now: commands are held until all senders have paused, because a planner may
 * be streaming since before a restart. */
void gate_init(gate *gate, const gate_rules *rules, gate_time now);

/* Judge one command, and count it unless it is taken: a caller who could obey it reports that by
 * gate_count_taken(), else by gate_reject(). GATE_TAKEN of GATE_DRIVE for a robot that is not
 * armed means: arm, then drive. *lease_us is set to what is left of the command's lease. */
enum gate_verdict gate_judge(gate *gate, const gate_command *command, const gate_robot *robot,
                             gate_time now, uint32_t *lease_us);
void gate_count_taken(gate *gate, enum gate_kind kind);
/* Count a rejection that was decided elsewhere. */
void gate_reject(gate *gate, enum gate_verdict verdict);

/* A stop command of this sender (length bytes, which may be 0): nobody is in control, and drive
 * commands are held. */
void gate_stop(gate *gate, const char *sender, size_t length, uint64_t now_us);
/* The robot was disarmed, overridden, lost or restarted: hold commands until all senders have
 * paused. */
void gate_hold(gate *gate, uint64_t now_us);
/* The bridge hung from since_us until now, and read nothing: that time is no pause. */
void gate_was_stalled(gate *gate, uint64_t since_us, uint64_t now_us);
/* This machine's clock was set: all that is known of utimes is void. */
void gate_clock_was_set(gate *gate, gate_time now);
/* Whether it was set since the last call or the start, and by how much; 0: it was not. */
int64_t gate_look_at_clock(gate *gate, gate_time now);

/* To be called again and again, and once before all else. Where more time went by since the last
 * call than the caller asked to wait for (asked_us), this process was stopped, or starved: true,
 * and each gate must be told by gate_was_stalled(), since `since_us`. */
bool gate_look_for_stall(gate_stall *stall, uint64_t asked_us, gate_time now, uint64_t *since_us);
/* When a command came, at the earliest, that seemed to come at this time: after a stall, what was
 * queued below this process is read late. */
int64_t gate_arrival(const gate_stall *stall, int64_t utime);

/* Whether a rejection begins an incident, which is worth a line in a log: none of its cause came
 * for GATE_INCIDENT_US, or the last one was of another sender, and then once a second at most. Ask
 * for each rejection; sender: length bytes, which may be 0. */
bool gate_is_incident(gate *gate, enum gate_verdict verdict, const char *sender, size_t length,
                      uint64_t now_us);

/* Whether the next drive command, of whoever may be in control, would move the robot. */
bool gate_can_drive(const gate *gate, const gate_robot *robot, uint64_t now_us);
/* Whether commands are held until all senders have paused. */
bool gate_is_waiting(const gate *gate, uint64_t now_us);
/* The sender in control (*length bytes, no NUL), or NULL. */
const char *gate_control_owner(const gate *gate, uint64_t now_us, size_t *length);

#ifdef __cplusplus
}
#endif

#endif
