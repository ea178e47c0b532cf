/* SPDX-License-Identifier: MIT
 *
 * What happens, in words for the log.
 */
#ifndef ROBUROC4_LCM_EXPLAIN_H
#define ROBUROC4_LCM_EXPLAIN_H

#include "gate.h"
#include "roburoc4.h"

/* A command that was rejected, as far as it could be read. */
typedef struct explain_command {
    enum gate_kind kind;
    const char *channel;
    const char *sender; /* NULL where it could not be read; else sender_length bytes */
    size_t sender_length;
    int64_t utime;
} explain_command;

/* Why a command was rejected, and what to do: a note the first time, else a detail. */
void explain_rejection(const char *robot, enum gate_verdict verdict, const explain_command *command,
                       const gate_rules *rules, gate_time now, bool first);
/* What ROBUROC4_EVENT_* bits mean for the person who runs the bridge. */
void explain_events(const char *robot, const char *address, const roburoc4_client *client,
                    uint32_t events, uint64_t now_us);
/* fault: ROBUROC4_FAULT_* */
void explain_absence(const char *robot, const char *address, uint32_t fault);

#endif
