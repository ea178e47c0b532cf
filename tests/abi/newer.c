/* SPDX-License-Identifier: MIT
 *
 * newer.c - part of the library that newer.sh makes: a new result, event, state, counter and
 * function.
 */
#include "roburoc4.h"

#define REFUSALS 3
#define ROBUROC4_ERR_NEW (-70)
#define ROBUROC4_EVENT_NEW 0x20000000
#define ROBUROC4_STATE_NEW 7

roburoc4_result inner_client_arm(roburoc4_client *client, uint64_t now_us);
uint32_t inner_client_state(const roburoc4_client *client);
uint32_t inner_client_take_events(roburoc4_client *client);
int32_t inner_refusal_may_pass(roburoc4_result refusal);

roburoc4_result roburoc4_client_arm(roburoc4_client *client, uint64_t now_us) {
    static int calls;
    calls++;
    return calls <= REFUSALS ? ROBUROC4_ERR_NEW : inner_client_arm(client, now_us);
}

int32_t roburoc4_refusal_may_pass(roburoc4_result refusal) {
    return refusal == ROBUROC4_ERR_NEW || inner_refusal_may_pass(refusal);
}

uint32_t roburoc4_client_state(const roburoc4_client *client) {
    const uint32_t state = inner_client_state(client);
    return state == ROBUROC4_STATE_CONNECTING ? ROBUROC4_STATE_NEW : state;
}

uint32_t roburoc4_client_take_events(roburoc4_client *client) {
    return inner_client_take_events(client) | ROBUROC4_EVENT_NEW;
}

uint32_t roburoc4_client_new(const roburoc4_client *client) {
    return roburoc4_client_count(client, ROBUROC4_COUNT_NEW);
}
