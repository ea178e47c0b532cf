/* SPDX-License-Identifier: MIT */
#include "explain.h"

#include <stdio.h>

#include "log.h"
#include "roburoc4_udp.h"
#include "text.h"

static const char *const kinds[] = {"drive", "relocalize", "output"};

/* ------------------------------------------------------------------------------ rejections --- */

static const char *reason(enum gate_verdict verdict) {
    switch (verdict) {
    case GATE_MALFORMED:
        return "it is not a message of the channel's type; are its .lcm types those of this "
               "bridge?";
    case GATE_SENDER:
        return "its sender is empty or longer than 63 bytes, or there are more than 32 senders; "
               "name each program once";
    case GATE_NO_UTIME:
        return "its utime is 0 or less; set it to the microseconds since 1970 when it is sent";
    case GATE_NOT_FINITE:
        return "it has NaN or infinity in it";
    case GATE_STARTING:
        return "the bridge has just started, and cannot tell it from an old one; go on sending";
    case GATE_REPEATED:
        return "its utime is not later than the sender's last: a replayed log, or two programs "
               "with one sender";
    case GATE_SEAT:
        return "another sender's lease still lives; one commander at a time";
    case GATE_NOT_READY:
        return "the robot is not connected";
    case GATE_DISARMED:
        return "the robot is not armed, or was disarmed since all senders paused; pause (or send "
               "zero) for 500 ms";
    case GATE_IMPOSSIBLE:
        return "the robot has no such output or service; digital output 0 is its own";
    default:
        return "its lease was over before it could be read";
    }
}

static const char *flag(enum gate_kind kind) {
    static const char *const flags[] = {"--enable-drive", "--enable-relocalize",
                                        "--enable-outputs"};
    return flags[kind];
}

/* Whether it was rejected for its utime, which is positive then: the difference cannot overflow. */
static bool is_about_time(enum gate_verdict verdict, const explain_command *command,
                          const gate_rules *rules, gate_time now) {
    return verdict == GATE_IN_FUTURE || (verdict == GATE_TOO_OLD && rules->max_age_us != 0 &&
                                         now.utime - command->utime > (int64_t)rules->max_age_us);
}

static void explain_time(char *room, size_t capacity, const explain_command *command,
                         const gate_rules *rules, gate_time now) {
    double age_s = (double)(now.utime - command->utime) / 1e6;
    (void)snprintf(
        room, capacity,
        "by its utime it is %.3f s %s (--max-age %u ms): a replayed log, a slow network, "
        "or clocks that differ: set both by NTP (--max-age 0 takes all ages, replays "
        "too)",
        age_s < 0 ? -age_s : age_s, age_s < 0 ? "in the future" : "old", rules->max_age_us / 1000u);
}

void explain_rejection(const char *robot, enum gate_verdict verdict, const explain_command *command,
                       const gate_rules *rules, gate_time now, bool first) {
    char sender[GATE_MAX_SENDER + 1] = "";
    char why[300];
    bool known = command->sender != NULL;
    if (known) {
        text_for_terminal(sender, sizeof sender, command->sender, command->sender_length);
    }
    if (verdict == GATE_DISABLED) {
        (void)snprintf(why, sizeof why, "start the bridge with %s to take it", flag(command->kind));
    } else if (is_about_time(verdict, command, rules, now)) {
        explain_time(why, sizeof why, command, rules, now);
    } else {
        (void)snprintf(why, sizeof why, "%s", reason(verdict));
    }
    log_line(first ? LOG_NOTE : LOG_DETAIL, robot, "%s command %s '%s' rejected: %s%s",
             kinds[command->kind], known ? "of" : "on", known ? sender : command->channel, why,
             first ? " (told once; bridge status counts them)" : "");
}

/* ---------------------------------------------------------------------------------- events --- */

void explain_absence(const char *robot, const char *address, uint32_t fault) {
    log_line(LOG_NOTE, robot, "no answer from %s yet (%s); going on trying", address,
             fault != ROBUROC4_FAULT_NONE ? roburoc4_udp_fault_text(fault)
                                          : "is it on, and on this network?");
}

static void explain_link(const char *robot, const char *address, uint32_t events) {
    if (events & ROBUROC4_EVENT_LOST) {
        log_line(LOG_NOTE, robot, "%s fell silent; going on trying", address);
    }
    if (events & ROBUROC4_EVENT_REBOOT) {
        log_line(LOG_NOTE, robot, "the robot restarted");
    }
    if (events & ROBUROC4_EVENT_READY) {
        log_line(LOG_NOTE, robot, "connected to %s", address);
    }
    if (events & ROBUROC4_EVENT_SUBSCRIPTION_REFUSED) {
        log_line(LOG_NOTE, robot,
                 "the robot refused a subscription: some statuses will be missing");
    }
    if (events & ROBUROC4_EVENT_CAPACITY) {
        log_line(LOG_NOTE, robot, "the robot has more channels than the bridge can store");
    }
}

static void explain_motion(const char *robot, const roburoc4_facts *facts, uint32_t events) {
    if (events & ROBUROC4_EVENT_DISARMED && facts->disarm_cause != ROBUROC4_ERR_DISARMED) {
        log_line(LOG_NOTE, robot, "disarmed: %s", roburoc4_result_text(facts->disarm_cause));
    }
    if (events & ROBUROC4_EVENT_ARMED && facts->armed) {
        log_line(LOG_NOTE, robot, "armed: drive commands move the robot");
    }
    if (events & ROBUROC4_EVENT_OVERRIDE) {
        log_line(LOG_NOTE, robot,
                 facts->overridden ? "[A] is held on the game pad"
                                   : "[A] on the game pad was let go");
    }
    if (events & ROBUROC4_EVENT_OTHER_COMMANDER) {
        log_line(LOG_NOTE, robot,
                 facts->other_commander ? "another program commands the robot"
                                : "the other program ended to command the robot");
    }
    if (events & ROBUROC4_EVENT_INHIBITED && facts->inhibited) {
        log_line(LOG_NOTE, robot,
                 "asked to move, but the robot stands: emergency stop, brakes, bumper?");
    }
    if (events & ROBUROC4_EVENT_LEASE_OVER) {
        log_line(LOG_DETAIL, robot, "the command's lease is over: stopping");
    }
}

static void explain_rest(const char *robot, const roburoc4_facts *facts, uint32_t events) {
    if (events & ROBUROC4_EVENT_RELOCALIZED) {
        log_line(LOG_NOTE, robot, "the robot took its new pose");
    }
    if (events & ROBUROC4_EVENT_RELOCALIZE_FAILED) {
        log_line(LOG_NOTE, robot, "the robot did not take its new pose: %s",
                 roburoc4_result_text(facts->relocalize_result));
    }
    if (events & ROBUROC4_EVENT_BATTERY_LOW) {
        log_line(LOG_NOTE, robot, "the battery is low");
    }
    if (events & ROBUROC4_EVENT_BATTERY_CRITICAL) {
        log_line(LOG_NOTE, robot, "the battery is critical");
    }
}

void explain_events(const char *robot, const char *address, const roburoc4_client *client,
                    uint32_t events, uint64_t now_us) {
    roburoc4_facts facts = {.size = sizeof facts};
    (void)roburoc4_client_facts(client, now_us, &facts);
    explain_link(robot, address, events);
    explain_motion(robot, &facts, events);
    explain_rest(robot, &facts, events);
}
