/* SPDX-License-Identifier: MIT
 *
 * In the place of src/requests.c where Eva analyses the client: requests that do whatever they like
 * within what tests/verify/proof/eva/requests.c shows of the real ones. A request that is given out may be
 * any; which slot it lies in makes no difference to the client, so that it is always the first.
 */
#include "any.h"

static bool any_bool(void) {
    return Frama_C_nondet(0, 1) != 0;
}

static slot *any_slot(requests *r) {
    Frama_C_make_unknown((char *)r, sizeof *r);
    any_ask(&r->slots[0].ask);
    return &r->slots[0];
}

void roburoc4_requests_clear(requests *r) {
    Frama_C_make_unknown((char *)r, sizeof *r);
}

void roburoc4_requests_cancel_all(requests *r) {
    Frama_C_make_unknown((char *)r->slots, sizeof r->slots);
}

bool roburoc4_requests_free(const requests *r, uint32_t keep) {
    return any_bool();
}

bool roburoc4_requests_open(const requests *r, const ask *a) {
    //@ split a->detail;
    /*@ assert asked: ask_holds(*a); */
    return any_bool();
}

bool roburoc4_requests_begin(requests *r, const ask *a) {
    /*@ assert asked: ask_holds(*a); */
    return any_bool();
}

void roburoc4_requests_cancel(requests *r, uint8_t action, uint8_t kind) {
    Frama_C_make_unknown((char *)r->slots, sizeof r->slots);
}

slot *roburoc4_requests_due(requests *r, uint32_t first_retry_ms, uint64_t now_us,
                            slot **given_up) {
    *given_up = NULL;
    if (any_bool()) {
        return any_slot(r);
    }
    if (any_bool()) {
        *given_up = any_slot(r);
    }
    return NULL;
}

slot *roburoc4_requests_match(requests *r, const uint8_t *datagram, size_t size, uint64_t now_us) {
    return any_bool() ? any_slot(r) : NULL;
}

void roburoc4_requests_close(requests *r, slot *s, uint64_t now_us) {
    Frama_C_make_unknown((char *)r->slots, sizeof r->slots);
}

uint64_t roburoc4_requests_deadline(const requests *r) {
    return any_u64();
}

void roburoc4_requests_rebase(requests *r, uint64_t now_us) {
    Frama_C_make_unknown((char *)r->slots, sizeof r->slots);
}
