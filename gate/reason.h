/* SPDX-License-Identifier: MIT
 *
 * Why the gate rejected a command, and what to do, as a sentence.
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
    const char *utime_word; /* what a bridge calls it: "utime", "stamp" */
} gate_rejection;

/* The sentence begins in lower case and has no full stop; it is cut to `capacity` bytes with its
 * NUL. */
void gate_reason(char *room, size_t capacity, const gate_rejection *rejection,
                 const gate_rules *rules, gate_time now);

#ifdef __cplusplus
}
#endif

#endif
