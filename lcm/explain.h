/* SPDX-License-Identifier: MIT
 *
 * What happens, in words for the log.
 */
#ifndef ROBUROC4_LCM_EXPLAIN_H
#define ROBUROC4_LCM_EXPLAIN_H

#include "commands.h"

/* Why a command was rejected, and what to do: a note the first time, else a detail. command: NULL
 * where it could not be read. */
void explain_rejection(const char *robot, enum gate_verdict verdict, const command *command,
                       const gate_rules *rules, gate_time now, bool first);
/* What ROBUROC4_EVENT_* bits mean for the person who runs the bridge. */
void explain_events(const char *robot, const char *address, const roburoc4_client *client,
                    uint32_t events, uint64_t now_us);
/* fault: ROBUROC4_FAULT_* */
void explain_absence(const char *robot, const char *address, uint32_t fault);

#endif
