/* SPDX-License-Identifier: MIT
 *
 * Where a datagram goes that came in: statuses into the snapshot and to the link and the drive
 * machine, answers to the request that they belong to.
 */
#include "joined.h"

typedef roburoc4_client client;

/* ---- statuses ---- */

/** The service that has this id and was subscribed to, or 0. */
static uint32_t subscribed_service(const client *c, uint16_t id) {
    const discovery *d = &c->private_discovery;
    for (uint32_t service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++) {
        if (d->service_ids[service] == id && (d->inserted & service_bit(service)) != 0) {
            return service;
        }
    }
    return 0;
}

static void tell_drive(client *c) {
    const roburoc4_private_values *v = &c->private_values;
    roburoc4_drive_status(&c->private_drive, &c->private_config, v->speeds,
                          v->override_known && v->overridden, c->private_now_us,
                          &c->private_events);
}

static roburoc4_result receive_status(client *c, const uint8_t *data, size_t size) {
    roburoc4_status_header head;
    any_status status;
    roburoc4_result result = roburoc4_decode_status_header(data, size, &head);
    if (result < 0) {
        return result;
    }
    const bool closing = c->private_state == ROBUROC4_STATE_CLOSING;
    const uint32_t service = connected(c) || closing ? subscribed_service(c, head.service) : 0;
    if (service == 0) {
        return ROBUROC4_ERR_UNSUBSCRIBED;
    }
    result = roburoc4_snapshot_decode(c, service, data, size, &status);
    if (result < 0) {
        return result;
    }
    const verdict age = roburoc4_link_status(&c->private_link, STATUS_INDEX(service),
                                             head.robot_cycles, c->private_now_us);
    if (age == VERDICT_REBOOT && !closing) {
        roburoc4_lifecycle_reboot(c);
    }
    if (age != VERDICT_NEW) {
        return ROBUROC4_ERR_OLD;
    }
    roburoc4_snapshot_store(c, service, &status);
    if (c->private_state == ROBUROC4_STATE_SUBSCRIBING) {
        c->private_discovery.acked |= service_bit(service); /* as good as the acknowledgement */
    }
    raise_event(c, (uint32_t)ROBUROC4_EVENT_IOCARD << STATUS_INDEX(service));
    if (service == ROBUROC4_SERVICE_DIFFERENTIAL) {
        tell_drive(c);
    } else if (service == ROBUROC4_SERVICE_IOCARD && c->private_values.override_known &&
               c->private_values.overridden) {
        roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_OVERRIDE);
    }
    return result;
}

/* ---- answers ---- */

/** The directory is there: new services are discovered anew, known ones keep their texts. */
static roburoc4_result take_directory(client *c, const uint8_t *data, size_t size) {
    discovery *d = &c->private_discovery;
    roburoc4_directory directory;
    const roburoc4_result result = roburoc4_decode_directory(data, size, &directory);
    if (result < 0) {
        return result;
    }
    const bool same = roburoc4_discovery_same(d, &directory);
    if (same && connected(c)) {
        return result;
    }
    if (!same) {
        if (connected(c)) { /* else driving was left before, and for what cause is known */
            roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_NO_DIFFERENTIAL);
        }
        roburoc4_discovery_clear(d);
        if (roburoc4_discovery_directory(d, &directory)) {
            raise_event(c, ROBUROC4_EVENT_CAPACITY);
        }
        raise_event(c, ROBUROC4_EVENT_PROPERTIES);
    }
    if (!roburoc4_discovery_may_drive(d, c->private_drive.service)) { /* it may list nothing */
        roburoc4_drive_service(&c->private_drive, false, 0);
    }
    roburoc4_lifecycle_forget_services(c, ROBUROC4_STATE_DISCOVERING);
    return result;
}

static roburoc4_result override_index(const client *c) {
    return index_of_role(c, ROBUROC4_ROLE_OVERRIDE);
}

static void take_text(client *c, const slot *s, const roburoc4_text *text) {
    discovery *d = &c->private_discovery;
    const roburoc4_result before = override_index(c);
    if (c->private_requests.fixed_id) {
        /* with one id for all, a late text may be another's: no service or input is chosen by it */
        roburoc4_discovery_described(d, s->ask.detail, s->ask.subject);
    } else if (roburoc4_discovery_text(d, s->ask.detail, s->ask.subject, text->text,
                                       text->length)) {
        raise_event(c, ROBUROC4_EVENT_ROLE);
    }
    if (override_index(c) != before) {
        c->private_values.override_known = 0; /* until a status tells it from the right input */
    }
    d->described_kind = (uint8_t)(s->ask.detail + 1);
    d->described_index = s->ask.subject;
    raise_event(c, ROBUROC4_EVENT_DESCRIPTION);
    if (s->ask.detail == LIST_DIRECTORY && d->identified && roburoc4_discovery_identify(d)) {
        /* a late text told that a service is another one */
        roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_NO_DIFFERENTIAL);
        roburoc4_lifecycle_forget_services(c, ROBUROC4_STATE_DISCOVERING);
    }
}

/** A good answer: take what it says, or tell what is wrong with it. */
static roburoc4_result take_answer(client *c, const slot *s, const uint8_t *data, size_t size) {
    discovery *d = &c->private_discovery;
    roburoc4_text text;
    roburoc4_result result = ROBUROC4_OK;
    switch (s->ask.action) {
    case ROBUROC4_ACTION_GET:
        if (s->ask.kind == ROBUROC4_SERVICE_DIRECTORY) {
            return take_directory(c, data, size);
        }
        result = roburoc4_snapshot_properties(c, s->ask.kind, data, size);
        if (result >= 0) {
            d->known |= service_bit(s->ask.kind);
            d->refused &= (uint8_t)~service_bit(s->ask.kind);
        }
        break;
    case ROBUROC4_ACTION_QUERY:
        result = roburoc4_decode_text(data, size, &text);
        if (result >= 0) {
            take_text(c, s, &text);
        }
        break;
    case ROBUROC4_ACTION_INSERT:
        roburoc4_link_expect(&c->private_link, STATUS_INDEX((uint32_t)s->ask.kind));
        d->acked |= service_bit(s->ask.kind);
        d->declined &= (uint8_t)~service_bit(s->ask.kind);
        break;
    case ROBUROC4_ACTION_DELETE:
        d->leaving &= (uint8_t)~service_bit(s->ask.kind);
        break;
    default: /* REPLACE */
        roburoc4_lifecycle_relocalize_ends(c, ROBUROC4_OK);
        break;
    }
    return result;
}

static roburoc4_result receive_answer(client *c, const uint8_t *data, size_t size) {
    const bool bad = data[0] == ROBUROC4_HEADER_ERROR || (size >= 5 && data[4] != 0);
    if (size < 5 && !bad) {
        return ROBUROC4_ERR_SHORT;
    }
    const bool fixed_id = c->private_requests.fixed_id;
    slot *s = roburoc4_requests_match(&c->private_requests, data, size, c->private_now_us);
    if (fixed_id && !c->private_requests.fixed_id) {
        roburoc4_discovery_read_texts_again(&c->private_discovery);
    }
    if (s == NULL) {
        return ROBUROC4_ERR_UNMATCHED;
    }
    const slot request = *s;
    roburoc4_link_round_trip(&c->private_link, s->sent_us, c->private_now_us);
    if (bad && s->ask.max_tries == REQUEST_FOREVER) {
        count(c, ROBUROC4_COUNT_REFUSED);
        return ROBUROC4_OK; /* no directory, no robot: it stays open and is tried again in its time
                             */
    }
    roburoc4_requests_close(&c->private_requests, s, c->private_now_us);
    if (c->private_requests.announce) {
        c->private_requests.announce = 0;
        raise_event(c, ROBUROC4_EVENT_FIXED_ID);
    }
    if (bad) {
        count(c, ROBUROC4_COUNT_REFUSED);
        roburoc4_asking_failed(c, &request, ROBUROC4_ERR_ROBOT);
        return ROBUROC4_OK;
    }
    const roburoc4_result result = take_answer(c, &request, data, size);
    if (result < 0) {
        roburoc4_asking_failed(c, &request, result);
    }
    return result;
}

static void count_drop(client *c, roburoc4_result why) {
    switch (why) {
    case ROBUROC4_ERR_SHORT:
        count(c, ROBUROC4_COUNT_SHORT);
        break;
    case ROBUROC4_ERR_UNMATCHED:
        count(c, ROBUROC4_COUNT_UNMATCHED);
        break;
    case ROBUROC4_ERR_UNSUBSCRIBED:
        count(c, ROBUROC4_COUNT_UNSUBSCRIBED);
        break;
    case ROBUROC4_ERR_OLD:
        count(c, ROBUROC4_COUNT_OLD);
        break;
    default:
        count(c, ROBUROC4_COUNT_MALFORMED);
        break;
    }
}

roburoc4_result roburoc4_client_receive(client *c, const uint8_t *datagram, size_t size,
                                        uint64_t now_us) {
    roburoc4_result result;
    if (c->private_state == ROBUROC4_STATE_IDLE) {
        return ROBUROC4_ERR_STATE;
    }
    roburoc4_lifecycle_clock(c, now_us);
    count(c, ROBUROC4_COUNT_RECEIVED);
    c->private_discovery.described_kind = 0;
    if (size == 0) {
        result = ROBUROC4_ERR_SHORT;
    } else if (datagram[0] == ROBUROC4_HEADER_STATUS) {
        result = receive_status(c, datagram, size);
    } else {
        result = receive_answer(c, datagram, size);
    }
    if (result < 0) {
        count_drop(c, result);
        return result;
    }
    if (result > 0) {
        count(c, ROBUROC4_COUNT_SURPLUS);
    }
    c->private_link.last_used_us = now_us;
    return result;
}
