/* SPDX-License-Identifier: MIT
 *
 * The gate decides which commands from the network may reach the robot, and counts the others by
 * cause. It is a pure state machine: its callers give it times and the robot's state. The bridges
 * share it; it is not part of the public libraries.
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
 * - since the start, the last disarm and the last stop command, there was a pause: GATE_PAUSE_US
 *   without a request for a speed. (A disarm because no command came needs no further pause.)
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
/* If ages are not checked, a sender is remembered for this long after its last command. */
#define GATE_FORGET_US 60000000u
/* Rejections with one cause are one incident until none has occurred for this long. */
#define GATE_INCIDENT_US 5000000u
/* A larger step against the monotonic clock means that the wall clock was set. */
#define GATE_CLOCK_SET_US 100000
/* A loop that comes back this much later than it asked was stalled. */
#define GATE_STALL_US 20000u
/* The time allowed for reading a command; it is longer only on an overloaded machine. */
#define GATE_READ_US 10000

/* The kinds of command. A stop is always obeyed. */
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
    GATE_UNITS,
    GATE_VERDICTS
};

typedef struct gate_rules {
    bool enabled[GATE_KINDS];
    uint32_t lease_us;   /* default and longest lease: ROBUROC4_MIN_ to _MAX_LEASE_US */
    uint32_t max_age_us; /* 0: ages are not checked */
} gate_rules;

/* Both clocks, read together. */
typedef struct gate_time {
    uint64_t us;   /* monotonic */
    int64_t utime; /* microseconds since 1970 */
} gate_time;

/* What the gate needs to know of a command. */
typedef struct gate_command {
    enum gate_kind kind;
    const char *sender; /* sender_length bytes, no NUL needed */
    size_t sender_length;
    int64_t utime;
    int64_t arrived_utime; /* when it arrived, on this machine's clock */
    int32_t lease_us;      /* 0 or less for the default */
    bool finite;
    bool zero; /* asks for no motion */
} gate_command;

/* What the gate needs to know of the robot. */
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

/* The last rejection with one cause. */
typedef struct gate_incident {
    uint64_t last_us, logged_us; /* 0: never */
    char sender[GATE_MAX_SENDER + 1];
} gate_incident;

typedef struct gate {
    gate_rules rules;
    gate_time start;
    gate_sender senders[GATE_SENDERS];
    uint64_t control_until_us;
    uint64_t quiet_since_us; /* the last interruption, or request for a speed while waiting */
    uint32_t owner;          /* index of the sender in control, or GATE_SENDERS */
    bool stopped;            /* by a stop command, and no speed or move was obeyed since */
    char stopped_by[GATE_MAX_SENDER + 1];
    int64_t taken[GATE_KINDS];
    int64_t rejected[GATE_VERDICTS];
    gate_incident incidents[GATE_VERDICTS];
    int64_t clock_offset_us; /* wall clock minus monotonic clock, to notice when the wall clock is
                              * set */
} gate;

/* Detects times in which this process hung; see gate_look_for_stall(). */
typedef struct gate_stall {
    gate_time last_look;
    int64_t began_utime; /* when the last stall began */
    uint64_t until_us;   /* until when commands that were sent during it may still arrive */
} gate_stall;

/* Initialize a gate that starts now. Commands are rejected until all senders have paused, because a
 * planner may have been streaming since before a restart. */
void gate_init(gate *gate, const gate_rules *rules, gate_time now);

/* Judge one command, and count it unless it is taken. A caller that could obey it then calls
 * gate_count_taken(), otherwise gate_reject(). GATE_TAKEN for a drive command while the robot is
 * not armed means: arm, then drive. *lease_us is set to the time left of the command's lease. */
enum gate_verdict gate_judge(gate *gate, const gate_command *command, const gate_robot *robot,
                             gate_time now, uint32_t *lease_us);
void gate_count_taken(gate *gate, enum gate_kind kind);
/* Count a rejection that was decided elsewhere. */
void gate_reject(gate *gate, enum gate_verdict verdict);

/* A stop command from this sender (length bytes, may be 0): nobody is in control any more, and
 * drive commands are rejected until all senders have paused. */
void gate_stop(gate *gate, const char *sender, size_t length, uint64_t now_us);
/* An interruption (the robot was disarmed, overridden, lost or restarted): reject commands until
 * all senders have paused. */
void gate_hold(gate *gate, uint64_t now_us);
/* The bridge hung from since_us until now and read nothing: that time does not count as a pause. */
void gate_was_stalled(gate *gate, uint64_t since_us, uint64_t now_us);
/* By how much this machine's clock was set since the last call or the start; 0: it was not. If it
 * was, all utimes are forgotten, and all senders must pause. */
int64_t gate_look_at_clock(gate *gate, gate_time now);

/* Call this before anything else, and then repeatedly. Returns true if more time has passed since
 * the last call than the caller wanted to wait (asked_us), so that this process was stopped or
 * got no CPU time. Then call gate_was_stalled() for each gate, with `since_us`. */
bool gate_look_for_stall(gate_stall *stall, uint64_t asked_us, gate_time now, uint64_t *since_us);
/* The earliest time at which a command that was read at this time can have arrived: after a stall,
 * what the system queued meanwhile is read late. */
int64_t gate_arrival(const gate_stall *stall, int64_t utime);

/* Whether a rejection begins an incident, which should be logged: none with its cause came for
 * GATE_INCIDENT_US, or the last one was from another sender (at most once a second). Call it for
 * every rejection; sender: length bytes, may be 0. */
bool gate_is_incident(gate *gate, enum gate_verdict verdict, const char *sender, size_t length,
                      uint64_t now_us);

/* Whether the next drive command, of any sender that may be in control, would move the robot. */
bool gate_can_drive(const gate *gate, const gate_robot *robot, uint64_t now_us);
/* Whether commands are rejected until all senders have paused. */
bool gate_is_waiting(const gate *gate, uint64_t now_us);
/* The sender in control (*length bytes, no NUL), or NULL. */
const char *gate_control_owner(const gate *gate, uint64_t now_us, size_t *length);

#ifdef __cplusplus
}
#endif

#endif
