/* SPDX-License-Identifier: MIT
 *
 * Subscriptions: which are wanted (by the configuration), requested, accepted or refused, and which
 * fell silent and are requested again. Nothing is sent here: schedule.c sends the requests.
 *
 * Of a service: `inserted` once a subscription was requested, so its statuses count; `acked` once
 * the robot accepted it; `declined` when it refused, until it is asked again; `denied` when it
 * refused, until it accepts; `leaving` until the robot has confirmed the end.
 */
#include "machines.h"

#define FIRST_STATUS_SERVICE ROBUROC4_SERVICE_IOCARD

void roburoc4_subscriptions_restart(subscriptions *s) {
    s->inserted = 0;
    s->acked = 0;
    s->declined = 0;
    s->denied = 0;
    s->leaving = 0;
}

uint32_t roburoc4_subscriptions_due(const subscriptions *s, const roburoc4_config *config,
                                    const discovery *d) {
    /* the IO card's statuses cannot be decoded without its properties */
    const uint32_t readable = d->known | ~(uint32_t)service_bit(ROBUROC4_SERVICE_IOCARD);
    return config->subscriptions & d->listed & readable & ~(uint32_t)(s->acked | s->declined);
}

bool roburoc4_subscriptions_all_declined(const subscriptions *s, const roburoc4_config *config,
                                         const discovery *d) {
    return roburoc4_subscriptions_due(s, config, d) == 0 &&
           (s->declined & config->subscriptions & d->listed) != 0 &&
           (s->acked & config->subscriptions) == 0;
}

uint8_t roburoc4_subscriptions_missing(const subscriptions *s, const roburoc4_config *config,
                                       const discovery *d) {
    return d->identified ? (uint8_t)(config->subscriptions & (~(uint32_t)d->listed | s->denied))
                         : 0;
}

void roburoc4_subscriptions_inserted(subscriptions *s, uint32_t service, uint32_t now_us) {
    s->inserted |= service_bit(service);
    s->inserted_us[STATUS_INDEX(service)] = now_us;
}

void roburoc4_subscriptions_accepted(subscriptions *s, uint32_t service) {
    s->acked |= service_bit(service);
    s->denied &= (uint8_t)~service_bit(service);
}

void roburoc4_subscriptions_refused(subscriptions *s, uint32_t service, uint32_t now_us) {
    s->declined |= service_bit(service);
    s->denied |= service_bit(service);
    s->refused_us = now_us;
}

void roburoc4_subscriptions_forget(subscriptions *s, uint32_t service) {
    const uint8_t others = (uint8_t)~service_bit(service);
    s->acked &= others;
    s->declined &= others;
    s->denied &= others;
    s->leaving &= others;
}

void roburoc4_subscriptions_leave(subscriptions *s, uint32_t service) {
    s->leaving |= s->inserted & service_bit(service);
    s->inserted &= (uint8_t)~service_bit(service);
}

void roburoc4_subscriptions_left(subscriptions *s, uint32_t service) {
    s->leaving &= (uint8_t)~service_bit(service);
}

void roburoc4_subscriptions_ask_declined(subscriptions *s) {
    s->declined = 0;
}

void roburoc4_subscriptions_renew_silent(subscriptions *s, const roburoc4_config *config,
                                         const roburoc4_private_link *l, uint64_t now_us,
                                         timer *t) {
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        const uint8_t bit = service_bit(i + FIRST_STATUS_SERVICE);
        const bool heard = roburoc4_link_heard(l, i);
        const uint32_t silent_us =
            heard ? clipped(now_us - l->services[i].received_us) : t->now_us - s->inserted_us[i];
        if ((s->acked & config->subscriptions & bit) != 0 &&
            reached(t, silent_us, SECOND + 5 * MS * config->period_ms[i + FIRST_STATUS_SERVICE])) {
            s->acked &= (uint8_t)~bit;
        }
        if (heard) {
            s->denied &= (uint8_t)~bit; /* it refused the subscription, but sends statuses */
        }
    }
}
