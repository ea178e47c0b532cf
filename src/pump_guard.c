/* SPDX-License-Identifier: MIT
 *
 * pump_guard.c - the lock around a pump's memory, and waiting for it to change.
 */
#include "pump_internal.h"

int roburoc4_pump_enter(roburoc4_pump *pump) {
    if (pump->process != roburoc4_process_id()) {
        return 0;
    }
    roburoc4_lock_take(&pump->lock);
    return 1;
}

void roburoc4_pump_leave(roburoc4_pump *pump) {
    roburoc4_lock_give(&pump->lock);
}

void roburoc4_pump_wait(roburoc4_pump *pump, uint64_t until_us) {
    uint64_t now_us = roburoc4_udp_now_us();
    if (until_us <= now_us) {
        return;
    }
    pump->waiters++;
    roburoc4_signal_wait(&pump->changed, &pump->lock, until_us - now_us);
    pump->waiters--;
    if (pump->phase == ROBUROC4_PUMP_JOINED && pump->waiters == 0) {
        roburoc4_signal_wake_all(&pump->changed); /* destroy() waits for this */
    }
}
