/* SPDX-License-Identifier: MIT
 *
 * What happens, for the person at the terminal or for the journal: lines on stderr, each with the
 * program's name and, where there are several, the robot's.
 */
#ifndef ROBUROC4_LCM_LOG_H
#define ROBUROC4_LCM_LOG_H

#include "gate.h"
#include "roburoc4.h"

enum log_level { LOG_ERROR, LOG_NOTE, LOG_DETAIL };

/* Lines above this level are not printed; LOG_NOTE at first. */
void log_set_level(enum log_level level);

#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
/* robot: its name, or NULL or "" for none. */
void log_line(enum log_level level, const char *robot, const char *format, ...);

/* A command, as far as it could be read. */
typedef struct log_command {
    enum gate_kind kind;
    const char *channel;
    const char *sender; /* NULL where it could not be read; else sender_length bytes */
    size_t sender_length;
    int64_t utime;
} log_command;

/* A command that was rejected: a note where it is the first of an incident, else a detail. */
void log_rejection(const char *robot, const log_command *command, const char *why, bool first);
/* A stop command: a note the first time, else a detail. */
void log_stop(const char *robot, const log_command *command, bool first);
/* What ROBUROC4_EVENT_* bits mean for the person who runs the bridge. */
void log_events(const char *robot, const char *address, const roburoc4_client *client,
                uint32_t events, uint64_t now_us);
/* fault: ROBUROC4_FAULT_* */
void log_absence(const char *robot, const char *address, uint32_t fault);

#endif
