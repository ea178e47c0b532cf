/* SPDX-License-Identifier: MIT */
#include "reason.h"

#include <stdio.h>

static const char *option(enum gate_kind kind) {
    static const char *const options[] = {"--enable-drive", "--enable-relocalize",
                                          "--enable-outputs", ""};
    return options[kind];
}

static const char *reason(enum gate_verdict verdict) {
    switch (verdict) {
    case GATE_MALFORMED:
        return "it is not a message of the expected type; use the types of this bridge's version";
    case GATE_SENDER:
        return "its sender is empty or longer than 63 bytes, or there are more than 32 senders; "
               "give each program its own name, and use at most 32";
    case GATE_NOT_FINITE:
        return "it contains NaN or infinity";
    case GATE_CONTROL:
        return "another sender is in control until its lease ends; a stop command needs no control";
    case GATE_NOT_READY:
        return "the robot is not connected";
    case GATE_DISARMED:
        return "the robot cannot be armed, or not all senders have paused since the bridge "
               "started, a stop, or a disarm; pause (or send zero) for 500 ms";
    case GATE_UNITS:
        return "it is faster than any RobuROC4; give m/s and rad/s, at most 5 and 10";
    case GATE_IMPOSSIBLE:
        return "the robot has no such output or service; digital output 0 is its own";
    default:
        return "its lease ended before it could be read";
    }
}

/* Whether its utime is the cause. Then it is positive: the difference cannot overflow. */
static bool is_about_age(const gate_rejection *rejection, const gate_rules *rules, gate_time now) {
    return rejection->verdict == GATE_IN_FUTURE ||
           (rejection->verdict == GATE_TOO_OLD && rules->max_age_us != 0 &&
            now.utime - rejection->utime > (int64_t)rules->max_age_us);
}

static void write_age(char *room, size_t capacity, const gate_rejection *rejection,
                      const gate_rules *rules, gate_time now) {
    double age_s = (double)(now.utime - rejection->utime) / 1e6;
    (void)snprintf(
        room, capacity,
        "by its %s it is %.3f s %s (--max-age-ms %u): a replayed log, a slow network, or clocks "
        "that differ: set both by NTP (--max-age-ms 0 accepts all ages, including replays)",
        rejection->utime_word, age_s < 0 ? -age_s : age_s, age_s < 0 ? "in the future" : "old",
        rules->max_age_us / 1000u);
}

void gate_reason(char *room, size_t capacity, const gate_rejection *rejection,
                 const gate_rules *rules, gate_time now) {
    if (rejection->verdict == GATE_DISABLED) {
        (void)snprintf(room, capacity, "start the bridge with %s to enable it",
                       option(rejection->kind));
    } else if (rejection->verdict == GATE_NO_UTIME) {
        (void)snprintf(room, capacity,
                       "its %s is 0 or less; set it to the time at which it is sent",
                       rejection->utime_word);
    } else if (rejection->verdict == GATE_REPEATED) {
        (void)snprintf(room, capacity,
                       "its %s is not later than the sender's last: a replayed log, or two "
                       "programs with the same name",
                       rejection->utime_word);
    } else if (rejection->verdict == GATE_STARTING) {
        (void)snprintf(room, capacity,
                       "the bridge has just started, and the command may be older: wait for "
                       "--max-age-ms, then pause 500 ms");
    } else if (is_about_age(rejection, rules, now)) {
        write_age(room, capacity, rejection, rules, now);
    } else {
        (void)snprintf(room, capacity, "%s", reason(rejection->verdict));
    }
}
