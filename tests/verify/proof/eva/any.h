/* SPDX-License-Identifier: MIT
 *
 * What the harnesses of the client and of its requests share: arbitrary values, and what every
 * question that the client asks fulfils.
 */
#ifndef PROOF_ANY_H
#define PROOF_ANY_H

#include "joined.h"

#include <__fc_builtin.h>

static inline uint32_t up_to(uint32_t most) {
    return Frama_C_unsigned_int_interval(0, most);
}

static inline uint32_t any_u32(void) {
    return up_to(UINT32_MAX);
}

static inline uint64_t any_u64(void) {
    return Frama_C_unsigned_long_long_interval(0, UINT64_MAX);
}

/*@ predicate ask_holds(roburoc4_private_ask a) =
      ((a.action == 4 || a.action == 5) && 2 <= a.kind <= 6) ||
      (a.action <= 2 && (a.kind == 0 || 2 <= a.kind <= 6) && (a.detail == 0 || a.detail == 4) &&
       a.subject <= 31) ||
      (a.action == 1 && a.kind == 2 && a.detail <= 3 && a.subject <= 63);
*/

/** Any question for which ask_holds(), its three cases apart. */
static inline void any_ask(roburoc4_private_ask *a) {
    Frama_C_make_unknown((char *)a, sizeof *a);
    uint32_t which = up_to(2);
    //@ split which;
    switch (which) {
    case 0: /* about a subscription */
        a->action = Frama_C_nondet(ROBUROC4_ACTION_INSERT, ROBUROC4_ACTION_DELETE);
        a->kind = (uint8_t)(2 + up_to(4));
        break;
    case 1: /* of the directory, or without parameters */
        a->action = Frama_C_nondet(Frama_C_nondet(ROBUROC4_ACTION_GET, ROBUROC4_ACTION_REPLACE),
                                   ROBUROC4_ACTION_QUERY);
        a->kind = (uint8_t)(Frama_C_nondet(0, 1) ? 0 : 2 + up_to(4));
        a->detail = (uint8_t)Frama_C_nondet(0, LIST_DIRECTORY);
        a->subject = (uint16_t)up_to(ROBUROC4_MAX_SERVICES - 1);
        break;
    default: /* of a channel's text */
        a->action = ROBUROC4_ACTION_QUERY;
        a->kind = ROBUROC4_SERVICE_IOCARD;
        a->detail = (uint8_t)up_to(3);
        a->subject = (uint16_t)up_to(63);
        break;
    }
}

#endif
