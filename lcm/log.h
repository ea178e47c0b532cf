/* SPDX-License-Identifier: MIT
 *
 * Log lines on stderr, for a terminal or the journal. Each has the program's name and, if there are
 * several robots, the robot's.
 */
#ifndef ROBUROC4_LCM_LOG_H
#define ROBUROC4_LCM_LOG_H

#include "gate.h"
#include "roburoc4.h"

enum log_level { LOG_ERROR, LOG_NOTE, LOG_DETAIL };

/* Lines above this level are not printed; initially LOG_NOTE. */
void log_set_level(enum log_level level);

#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
/* robot: its name, or NULL or "" for none. */
void log_line(enum log_level level, const char *robot, const char *format, ...);

/* A command, as far as it could be read. */
typedef struct log_command {
    enum gate_kind kind;
    bool is_move;
    const char *channel;
    const char *sender; /* NULL if it could not be read; else sender_length bytes */
    size_t sender_length;
    int64_t utime;
} log_command;

/* Log a command that was rejected: as a note if it begins an incident, else as a detail. */
void log_rejection(const char *robot, const log_command *command, const char *why, bool first);
/* Log a stop command: as a note the first time, else as a detail. */
void log_stop(const char *robot, const log_command *command, bool first);
/* Log ROBUROC4_EVENT_* bits in the words of a user. */
void log_events(const char *robot, const char *address, const roburoc4_client *client,
                uint32_t events, uint64_t now_us);
/* fault: ROBUROC4_FAULT_* */
void log_absence(const char *robot, const char *address, uint32_t fault);

#endif
