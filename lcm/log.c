/* SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "log.h"

#include <poll.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "roburoc4_udp.h"
#include "text.h"

/* ----------------------------------------------------------------------------------- lines --- */

static enum log_level highest = LOG_NOTE;

void log_set_level(enum log_level level) {
    highest = level;
}

/* A pager or a stopped terminal must not delay a stop sequence, so what cannot be written at once
 * is dropped. */
static void write_line(const char *line) {
    struct pollfd end = {.fd = STDERR_FILENO, .events = POLLOUT};
    if (poll(&end, 1, 0) == 1 && (end.revents & POLLOUT) != 0) {
        /* A single write(), so that lines of several programs do not mix. After an error the line
         * is lost. */
        ssize_t written = write(STDERR_FILENO, line, strlen(line));
        (void)written;
    }
}

void log_line(enum log_level level, const char *robot, const char *format, ...) {
    char text[600];
    char line[700];
    if (level > highest) {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    bool named = robot != NULL && robot[0] != '\0';
    (void)snprintf(line, sizeof line, "roburoc4-lcm: %s%s%s\n", named ? robot : "",
                   named ? ": " : "", text);
    write_line(line);
}

static const char *const kinds[] = {"drive", "relocalize", "output", "stop"};

/* ------------------------------------------------------------------------------ rejections --- */

void log_rejection(const char *robot, const log_command *command, const char *why, bool first) {
    char sender[GATE_MAX_SENDER + 1] = "";
    bool known = command->sender != NULL;
    if (known) {
        text_for_terminal(sender, sizeof sender, command->sender, command->sender_length);
    }
    log_line(first ? LOG_NOTE : LOG_DETAIL, robot, "%s command %s '%s' rejected: %s",
             command->is_move ? "move" : kinds[command->kind], known ? "of" : "on",
             known ? sender : command->channel, why);
}

/* ---------------------------------------------------------------------------------- events --- */

void log_absence(const char *robot, const char *address, uint32_t fault) {
    log_line(LOG_NOTE, robot, "no answer from %s yet (%s); still trying", address,
             fault != ROBUROC4_FAULT_NONE ? roburoc4_udp_fault_text(fault)
                                          : "is it on, and on this network?");
}

/* An event as a sentence; if it begins or ends a condition, which of the two. */
static const char *event_text(uint32_t event, const roburoc4_facts *facts) {
    bool holds = false;
    switch (event) {
    case ROBUROC4_EVENT_OVERRIDE:
        holds = facts->overridden;
        break;
    case ROBUROC4_EVENT_OTHER_COMMANDER:
        holds = facts->other_commander;
        break;
    case ROBUROC4_EVENT_INHIBITED:
        holds = facts->inhibited;
        break;
    default:
        return roburoc4_name(ROBUROC4_NAME_EVENT, event);
    }
    return roburoc4_name(holds ? ROBUROC4_NAME_EVENT_BEGAN : ROBUROC4_NAME_EVENT_ENDED, event);
}

/* Events that are logged by name only. */
#define NOTED                                                                                      \
    (ROBUROC4_EVENT_REBOOT | ROBUROC4_EVENT_SUBSCRIPTION_REFUSED | ROBUROC4_EVENT_CAPACITY |       \
     ROBUROC4_EVENT_ARMED | ROBUROC4_EVENT_LAPSED | ROBUROC4_EVENT_OVERRIDE |                      \
     ROBUROC4_EVENT_OTHER_COMMANDER | ROBUROC4_EVENT_INHIBITED | ROBUROC4_EVENT_RELOCALIZED |      \
     ROBUROC4_EVENT_BATTERY_LOW | ROBUROC4_EVENT_BATTERY_CRITICAL |                                \
     ROBUROC4_EVENT_STOP_UNCONFIRMED)

/* Stops are logged with their sender, and an ended stream of commands is none of the robot's
 * faults: the next one arms again. */
static bool is_worth_a_note(int32_t disarm_cause) {
    return disarm_cause != ROBUROC4_ERR_DISARMED && disarm_cause != ROBUROC4_ERR_STOP_CALLED &&
           disarm_cause != ROBUROC4_ERR_LAPSED;
}

void log_events(const char *robot, const char *address, const roburoc4_client *client,
                uint32_t events, uint64_t now_us) {
    roburoc4_facts facts = {.size = sizeof facts};
    (void)roburoc4_client_facts(client, now_us, &facts);
    if (events & ROBUROC4_EVENT_LOST) {
        log_line(LOG_NOTE, robot, "%s fell silent; still trying", address);
    }
    if (events & ROBUROC4_EVENT_READY) {
        log_line(LOG_NOTE, robot, "connected to %s", address);
    }
    if (events & ROBUROC4_EVENT_DISARMED && is_worth_a_note(facts.disarm_cause)) {
        log_line(LOG_NOTE, robot, "disarmed: %s", roburoc4_result_text(facts.disarm_cause));
    }
    if (events & ROBUROC4_EVENT_RELOCALIZE_FAILED) {
        log_line(LOG_NOTE, robot, "the robot did not accept its new pose: %s",
                 roburoc4_result_text(facts.relocalize_result));
    }
    for (uint32_t event = 1; event <= ROBUROC4_EVENT_STOP_UNCONFIRMED; event <<= 1) {
        const bool is_detail = event == ROBUROC4_EVENT_LAPSED;
        if (events & NOTED & event && (event != ROBUROC4_EVENT_ARMED || facts.armed)) {
            log_line(is_detail ? LOG_DETAIL : LOG_NOTE, robot, "%s", event_text(event, &facts));
        }
    }
}

void log_stop(const char *robot, const log_command *command, bool first) {
    char sender[GATE_MAX_SENDER + 1] = "";
    bool named = command->sender != NULL && command->sender_length > 0;
    if (named) {
        text_for_terminal(sender, sizeof sender, command->sender, command->sender_length);
    }
    log_line(first ? LOG_NOTE : LOG_DETAIL, robot,
             "stopped by %s%s%s; drive commands are rejected until all senders have paused",
             named ? "'" : "a stop command ", named ? sender : "without a sender",
             named ? "'" : "");
}
