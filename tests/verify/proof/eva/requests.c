/* SPDX-License-Identifier: MIT
 *
 * For Frama-C's Eva: the real requests, on any requests whose questions fulfil ask_holds(), give
 * out only such, and keep it so. What requests_stub.c may do is no less. Never run.
 */
#include "any.h"

static requests all;
static uint8_t bytes[5];

/** Each slot holds a question of any of the three cases: 81 states. */
static void any_requests(void) {
    Frama_C_make_unknown((char *)&all, sizeof all);
    Frama_C_make_unknown((char *)bytes, sizeof bytes);
    for (uint32_t i = 0; i < 4; i++) {
        all.slots[i].open = (uint8_t)up_to(1);
        any_ask(&all.slots[i].ask);
    }
}

static void check_requests(void) {
    /*@ assert asks: ask_holds(all.slots[0].ask) && ask_holds(all.slots[1].ask) &&
            ask_holds(all.slots[2].ask) && ask_holds(all.slots[3].ask); */
}

static void check_slot(const slot *s) {
    /*@ assert ours: s == \null || s == &all.slots[0] || s == &all.slots[1] ||
            s == &all.slots[2] || s == &all.slots[3]; */
    check_requests();
}

void main_requests_due(void) {
    slot *given_up;
    any_requests();
    check_slot(roburoc4_requests_due(&all, any_u32(), any_u64(), &given_up));
    check_slot(given_up);
}

void main_requests_match(void) {
    size_t size = 1 + up_to(4);
    any_requests();
    //@ split size;
    check_slot(roburoc4_requests_match(&all, bytes + (sizeof bytes - size), size, any_u64()));
}

void main_requests_begin(void) {
    roburoc4_private_ask a;
    any_requests();
    any_ask(&a);
    roburoc4_requests_begin(&all, &a);
    check_requests();
}

void main_requests_rest(void) {
    any_requests();
    switch (up_to(4)) {
    case 0:
        roburoc4_requests_clear(&all);
        break;
    case 1:
        roburoc4_requests_cancel_all(&all);
        break;
    case 2:
        roburoc4_requests_cancel(&all, (uint8_t)up_to(255), (uint8_t)up_to(255));
        break;
    case 3:
        roburoc4_requests_close(&all, &all.slots[0], any_u64());
        break;
    default:
        roburoc4_requests_rebase(&all, any_u64());
        break;
    }
    check_requests();
}
