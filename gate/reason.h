/* SPDX-License-Identifier: MIT
 *
 * The reason why the gate rejected a command, and the remedy, as a sentence.
 */
#ifndef ROBUROC4_GATE_REASON_H
#define ROBUROC4_GATE_REASON_H

#include "gate.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gate_rejection {
    enum gate_verdict verdict;
    enum gate_kind kind;
    int64_t utime;
    const char *utime_word; /* the bridge's: "utime", "stamp" */
} gate_rejection;

/* The sentence starts in lower case and has no full stop; it is cut to `capacity` bytes with
 * NUL. */
void gate_reason(char *room, size_t capacity, const gate_rejection *rejection,
                 const gate_rules *rules, gate_time now);

#ifdef __cplusplus
}
#endif

#endif
