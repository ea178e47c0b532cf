/* SPDX-License-Identifier: MIT
 *
 * The client joined: its life (connect, discover, subscribe, ready, lost), where datagrams go, and
 * what is sent next. Motion itself is in drive.c.
 */
#include "client.h"
#include "bytes.h"

/* Layout promises of a struct that callers declare. */
#define LAYOUT(name, condition) typedef char assert_##name[(condition) ? 1 : -1]
LAYOUT(slot, sizeof(roburoc4_private_slot) == 24);
LAYOUT(requests, sizeof(roburoc4_private_requests) == 112);
LAYOUT(service, sizeof(roburoc4_private_service) == 72);
LAYOUT(link, sizeof(roburoc4_private_link) == 416);
LAYOUT(drive, sizeof(roburoc4_private_drive) == 128);
LAYOUT(discovery, sizeof(roburoc4_private_discovery) == 256);
LAYOUT(values, sizeof(roburoc4_private_values) == 744);
LAYOUT(outputs, sizeof(roburoc4_private_outputs) == 120);
LAYOUT(config, sizeof(roburoc4_config) == 80);
LAYOUT(client, sizeof(roburoc4_client) == 1968);
LAYOUT(client_requests, offsetof(roburoc4_client, private_requests) == 160);
LAYOUT(client_outputs, offsetof(roburoc4_client, private_outputs) == 1816);

/* Given up after 2.5 s, within the patience below; a probe asks again later. */
#define REQUEST_TRIES 5
#define PROBE_US SECOND
/* How long to wait for the texts of the directory before the manual's ids are believed. */
#define IDENTIFY_US SECOND
/* Before it is ready, a client is patient: requests are repeated each second at the latest. */
#define PATIENCE_US (5 * SECOND)
#define RELOCALIZE_US (2 * SECOND)
#define OUTPUT_PAUSE_US (50 * MS)
#define FIRST_STATUS_SERVICE ROBUROC4_SERVICE_IOCARD

typedef roburoc4_client client;

static void count(client *c, uint32_t counter) {
    c->private_counters[counter]++;
}

static void raise_event(client *c, uint32_t event) {
    c->private_events |= event;
}

static bool connected(const client *c) {
    return c->private_state >= ROBUROC4_STATE_DISCOVERING &&
           c->private_state <= ROBUROC4_STATE_READY;
}

static void enter(client *c, uint32_t state, uint64_t now_us) {
    if (c->private_state != state) {
        c->private_state = state;
        raise_event(c, ROBUROC4_EVENT_STATE);
        raise_event(c, state == ROBUROC4_STATE_READY ? ROBUROC4_EVENT_READY : 0);
    }
    c->private_discovery.phase_us = now_us;
}

size_t roburoc4_client_size(void) {
    return sizeof(client);
}

/* ---- life ---- */

roburoc4_result roburoc4_client_init(client *c, size_t client_size, const roburoc4_config *config) {
    if (client_size != sizeof *c) {
        return ROBUROC4_ERR_SIZE;
    }
    memset(c, 0, sizeof *c);
    roburoc4_config_init(&c->private_config, sizeof c->private_config);
    if (config != NULL) {
        if (roburoc4_config_error(config) != NULL) {
            return ROBUROC4_ERR_CONFIG;
        }
        c->private_config = *config;
    }
    c->private_size = sizeof *c;
    c->private_drive.disarm_cause = ROBUROC4_ERR_DISARMED;
    c->private_outputs.relocalize_result = ROBUROC4_ERR_UNKNOWN;
    return ROBUROC4_OK;
}

/** Ask for the directory; what was learned about services counts no more until it is read again. */
static void connect(client *c, uint32_t state, uint64_t now_us) {
    roburoc4_discovery_restart(&c->private_discovery);
    roburoc4_requests_clear(&c->private_requests);
    roburoc4_link_restart(&c->private_link);
    c->private_values.override_known = 0;
    c->private_outputs.repeats = 0;
    c->private_outputs.relocalizing = 0;
    enter(c, state, now_us);
}

roburoc4_result roburoc4_client_start(client *c, uint64_t now_us) {
    if (c->private_size != sizeof *c || c->private_state != ROBUROC4_STATE_IDLE) {
        return ROBUROC4_ERR_STATE;
    }
    c->private_now_us = now_us;
    memset(&c->private_link, 0, sizeof c->private_link);
    memset(&c->private_discovery, 0, sizeof c->private_discovery);
    memset(&c->private_values, 0, sizeof c->private_values);
    memset(&c->private_outputs, 0, sizeof c->private_outputs);
    memset(c->private_counters, 0, sizeof c->private_counters);
    c->private_outputs.relocalize_result = ROBUROC4_ERR_UNKNOWN;
    roburoc4_discovery_clear(&c->private_discovery);
    c->private_discovery.wanted = (uint8_t)c->private_config.subscriptions;
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        c->private_link.services[i].asked_cycles =
            (uint8_t)(c->private_config.period_ms[i + FIRST_STATUS_SERVICE] / 10);
    }
    c->private_link.last_used_us = now_us;
    roburoc4_drive_start(&c->private_drive, now_us);
    connect(c, ROBUROC4_STATE_CONNECTING, now_us);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_close(client *c, uint64_t now_us) {
    if (c->private_state == ROBUROC4_STATE_IDLE) {
        return ROBUROC4_ERR_STATE;
    }
    roburoc4_client_clock(c, now_us);
    roburoc4_drive_interrupt(&c->private_drive, &c->private_config, ROBUROC4_ERR_DISARMED,
                             &c->private_events);
    c->private_drive.stop_latched = 0;
    roburoc4_requests_clear(&c->private_requests);
    enter(c, c->private_drive.train ? ROBUROC4_STATE_CLOSING : ROBUROC4_STATE_IDLE, now_us);
    return ROBUROC4_OK;
}

static void lose(client *c, uint64_t now_us) {
    const bool was_ready = c->private_state == ROBUROC4_STATE_READY;
    roburoc4_drive_interrupt(&c->private_drive, &c->private_config, ROBUROC4_ERR_LOST,
                             &c->private_events);
    count(c, ROBUROC4_COUNT_LOST);
    raise_event(c, ROBUROC4_EVENT_LOST);
    c->private_link.resubscribed = 1;
    connect(c, was_ready ? ROBUROC4_STATE_LOST : ROBUROC4_STATE_CONNECTING, now_us);
}

static void reboot(client *c, uint64_t now_us) {
    roburoc4_drive_interrupt(&c->private_drive, &c->private_config, ROBUROC4_ERR_REBOOT,
                             &c->private_events);
    count(c, ROBUROC4_COUNT_REBOOTS);
    raise_event(c, ROBUROC4_EVENT_REBOOT);
    c->private_link.newest_cycles = 0;
    c->private_link.resubscribed = 0;
    roburoc4_discovery_clear(&c->private_discovery);
    connect(c, ROBUROC4_STATE_CONNECTING, now_us);
}

void roburoc4_client_clock(client *c, uint64_t now_us) {
    if (now_us < c->private_now_us) {
        roburoc4_drive_interrupt(&c->private_drive, &c->private_config, ROBUROC4_ERR_CLOCK,
                                 &c->private_events);
        roburoc4_drive_rebase(&c->private_drive, now_us);
        roburoc4_requests_rebase(&c->private_requests, now_us);
        roburoc4_link_rebase(&c->private_link, now_us);
        c->private_discovery.phase_us = now_us;
        c->private_discovery.probe_us = now_us;
        c->private_outputs.sent_us = now_us;
        c->private_outputs.relocalize_us = now_us;
        count(c, ROBUROC4_COUNT_CLOCK_FAULTS);
        raise_event(c, ROBUROC4_EVENT_CLOCK);
    }
    c->private_now_us = now_us;
}

/** Silence that makes the robot lost: never less than three of the shortest period. */
static uint64_t patience_us(const client *c) {
    uint64_t shortest_us = PROBE_US;
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        const uint64_t period_us =
            (uint64_t)c->private_link.services[i].asked_cycles * ROBUROC4_CYCLE_US;
        if ((c->private_discovery.acked & service_bit(i + FIRST_STATUS_SERVICE)) != 0 &&
            period_us < shortest_us) {
            shortest_us = period_us;
        }
    }
    if (c->private_state != ROBUROC4_STATE_READY) {
        return PATIENCE_US;
    }
    const uint64_t lost_us = c->private_config.lost_ms * MS;
    return lost_us > 3 * shortest_us ? lost_us : 3 * shortest_us;
}

/* ---- motion ---- */

conditions roburoc4_client_conditions(const client *c, uint64_t now_us) {
    const uint64_t fresh_us = c->private_config.fresh_ms * MS;
    const roburoc4_private_link *l = &c->private_link;
    const conditions now = {
        c->private_state == ROBUROC4_STATE_READY,
        roburoc4_link_fresh(l, STATUS_INDEX(ROBUROC4_SERVICE_DIFFERENTIAL), fresh_us, now_us),
        roburoc4_link_fresh(l, STATUS_INDEX(ROBUROC4_SERVICE_IOCARD), fresh_us, now_us),
        roburoc4_client_role_index(c, ROBUROC4_ROLE_OVERRIDE) >= 0,
        c->private_values.override_known != 0,
        c->private_values.overridden != 0,
    };
    return now;
}

static roburoc4_result refusal(const client *c, uint64_t now_us, bool arming) {
    const conditions now = roburoc4_client_conditions(c, now_us);
    return roburoc4_drive_refusal(&c->private_drive, &c->private_config, c->private_values.limits,
                                  &now, arming);
}

roburoc4_result roburoc4_client_arm_refusal(const client *c, uint64_t now_us) {
    return refusal(c, now_us, true);
}

void roburoc4_client_tick_drive(client *c, uint64_t now_us) {
    roburoc4_drive_tick(&c->private_drive, &c->private_config, refusal(c, now_us, false),
                        refusal(c, now_us, true), now_us, &c->private_events);
}

/* ---- statuses ---- */

/** The service that has this id and was subscribed to, or 0. */
static uint32_t subscribed_service(const client *c, uint16_t id) {
    const discovery *d = &c->private_discovery;
    for (uint32_t service = FIRST_STATUS_SERVICE; service < ROBUROC4_SERVICE_COUNT; service++) {
        if (d->service_ids[service] == id && (d->inserted & service_bit(service)) != 0) {
            return service;
        }
    }
    return 0;
}

static void tell_drive(client *c, uint64_t now_us) {
    const roburoc4_private_values *v = &c->private_values;
    roburoc4_drive_status(&c->private_drive, &c->private_config, v->speeds,
                          v->override_known && v->overridden, now_us, &c->private_events);
}

static roburoc4_result receive_status(client *c, const uint8_t *data, size_t size,
                                      uint64_t now_us) {
    roburoc4_status_header head;
    roburoc4_result result = roburoc4_decode_status_header(data, size, &head);
    if (result < 0) {
        return result;
    }
    const bool closing = c->private_state == ROBUROC4_STATE_CLOSING;
    const uint32_t service = connected(c) || closing ? subscribed_service(c, head.service) : 0;
    if (service == 0) {
        return ROBUROC4_ERR_UNSUBSCRIBED;
    }
    result = roburoc4_snapshot_status(c, service, data, size, false);
    if (result < 0) {
        return result;
    }
    switch (
        roburoc4_link_status(&c->private_link, STATUS_INDEX(service), head.robot_cycles, now_us)) {
    case VERDICT_REBOOT:
        if (!closing) {
            reboot(c, now_us);
        }
        return ROBUROC4_ERR_OLD;
    case VERDICT_OLD:
        return ROBUROC4_ERR_OLD;
    case VERDICT_NEW:
        break;
    }
    roburoc4_snapshot_status(c, service, data, size, true);
    if (c->private_state == ROBUROC4_STATE_SUBSCRIBING) {
        c->private_discovery.acked |= service_bit(service); /* as good as the acknowledgement */
    }
    raise_event(c, (uint32_t)ROBUROC4_EVENT_IOCARD << STATUS_INDEX(service));
    if (service == ROBUROC4_SERVICE_DIFFERENTIAL) {
        tell_drive(c, now_us);
    } else if (service == ROBUROC4_SERVICE_IOCARD && c->private_values.override_known &&
               c->private_values.overridden) {
        roburoc4_drive_interrupt(&c->private_drive, &c->private_config, ROBUROC4_ERR_OVERRIDE,
                                 &c->private_events);
    }
    return result;
}

/* ---- answers ---- */

/** The directory is there: new services are discovered anew, known ones keep their texts. */
static roburoc4_result take_directory(client *c, const uint8_t *data, size_t size,
                                      uint64_t now_us) {
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
        roburoc4_drive_interrupt(&c->private_drive, &c->private_config, ROBUROC4_ERR_NOT_READY,
                                 &c->private_events);
        roburoc4_discovery_clear(d);
        if (roburoc4_discovery_directory(d, &directory)) {
            raise_event(c, ROBUROC4_EVENT_CAPACITY);
        }
        raise_event(c, ROBUROC4_EVENT_PROPERTIES);
    }
    roburoc4_discovery_restart(d);
    roburoc4_requests_cancel(&c->private_requests, ROBUROC4_ACTION_QUERY,
                             ROBUROC4_SERVICE_DIRECTORY);
    enter(c, ROBUROC4_STATE_DISCOVERING, now_us);
    return result;
}

static roburoc4_result override_index(const client *c) {
    return roburoc4_client_role_index(c, ROBUROC4_ROLE_OVERRIDE);
}

static void take_text(client *c, const slot *s, const roburoc4_text *text, uint64_t now_us) {
    discovery *d = &c->private_discovery;
    const roburoc4_result before = override_index(c);
    if (roburoc4_discovery_text(d, s->detail, s->subject, text->text, text->length)) {
        raise_event(c, ROBUROC4_EVENT_ROLE);
    }
    if (override_index(c) != before) {
        c->private_values.override_known = 0; /* until a status tells it from the right input */
    }
    d->described_kind = (uint8_t)(s->detail + 1);
    d->described_index = s->subject;
    raise_event(c, ROBUROC4_EVENT_DESCRIPTION);
    if (s->detail == LIST_DIRECTORY && d->identified && roburoc4_discovery_identify(d)) {
        roburoc4_discovery_restart(d); /* a late text told that a service is another one */
        enter(c, ROBUROC4_STATE_DISCOVERING, now_us);
    }
}

static void relocalize_ends(client *c, roburoc4_result result) {
    c->private_outputs.relocalizing = 0;
    c->private_outputs.relocalize_result = result;
    raise_event(c, result < 0 ? ROBUROC4_EVENT_RELOCALIZE_FAILED : ROBUROC4_EVENT_RELOCALIZED);
}

/** A request came to nothing: refused by the robot, answered with nonsense, or never answered. */
static void fail(client *c, const slot *s, roburoc4_result why) {
    discovery *d = &c->private_discovery;
    switch (s->action) {
    case ROBUROC4_ACTION_GET:
        d->refused |= service_bit(s->kind);
        if (s->kind == ROBUROC4_SERVICE_DIFFERENTIAL && why != ROBUROC4_ERR_TIMEOUT) {
            roburoc4_drive_service(&c->private_drive, false, 0);
        }
        break;
    case ROBUROC4_ACTION_QUERY:
        roburoc4_discovery_described(d, s->detail, s->subject);
        break;
    case ROBUROC4_ACTION_INSERT:
        if ((d->declined & service_bit(s->kind)) == 0) {
            raise_event(c, ROBUROC4_EVENT_SUBSCRIPTION_REFUSED);
        }
        d->declined |= service_bit(s->kind);
        break;
    case ROBUROC4_ACTION_DELETE:
        d->leaving &= (uint8_t)~service_bit(s->kind);
        break;
    default: /* REPLACE */
        relocalize_ends(c, why);
        break;
    }
}

/** A good answer: take what it says, or tell what is wrong with it. */
static roburoc4_result take_answer(client *c, const slot *s, const uint8_t *data, size_t size,
                                   uint64_t now_us) {
    discovery *d = &c->private_discovery;
    roburoc4_text text;
    roburoc4_result result = ROBUROC4_OK;
    switch (s->action) {
    case ROBUROC4_ACTION_GET:
        if (s->kind == ROBUROC4_SERVICE_DIRECTORY) {
            return take_directory(c, data, size, now_us);
        }
        result = roburoc4_snapshot_properties(c, s->kind, data, size);
        if (result >= 0) {
            d->known |= service_bit(s->kind);
            d->refused &= (uint8_t)~service_bit(s->kind);
        }
        break;
    case ROBUROC4_ACTION_QUERY:
        result = roburoc4_decode_text(data, size, &text);
        if (result >= 0) {
            take_text(c, s, &text, now_us);
        }
        break;
    case ROBUROC4_ACTION_INSERT:
        d->acked |= service_bit(s->kind);
        d->declined &= (uint8_t)~service_bit(s->kind);
        break;
    case ROBUROC4_ACTION_DELETE:
        d->leaving &= (uint8_t)~service_bit(s->kind);
        break;
    default: /* REPLACE */
        relocalize_ends(c, ROBUROC4_OK);
        break;
    }
    return result;
}

static roburoc4_result receive_answer(client *c, const uint8_t *data, size_t size,
                                      uint64_t now_us) {
    const bool bad = data[0] == ROBUROC4_HEADER_ERROR || (size >= 5 && data[4] != 0);
    if (size < 5 && !bad) {
        return ROBUROC4_ERR_SHORT;
    }
    slot *s = roburoc4_requests_match(&c->private_requests, data, size, now_us);
    if (s == NULL) {
        return ROBUROC4_ERR_UNMATCHED;
    }
    const slot request = *s;
    roburoc4_link_round_trip(&c->private_link, s->sent_us, now_us);
    if (bad && s->max_tries == REQUEST_FOREVER) {
        count(c, ROBUROC4_COUNT_REFUSED);
        return ROBUROC4_OK; /* no directory, no robot: it stays open and is tried again in its time
                             */
    }
    roburoc4_requests_close(&c->private_requests, s, now_us);
    if (c->private_requests.announce) {
        c->private_requests.announce = 0;
        raise_event(c, ROBUROC4_EVENT_FIXED_ID);
    }
    if (bad) {
        count(c, ROBUROC4_COUNT_REFUSED);
        fail(c, &request, ROBUROC4_ERR_ROBOT);
        return ROBUROC4_OK;
    }
    const roburoc4_result result = take_answer(c, &request, data, size, now_us);
    if (result < 0) {
        fail(c, &request, result);
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
    roburoc4_client_clock(c, now_us);
    count(c, ROBUROC4_COUNT_RECEIVED);
    c->private_discovery.described_kind = 0;
    if (size == 0) {
        result = ROBUROC4_ERR_SHORT;
    } else if (datagram[0] == ROBUROC4_HEADER_STATUS) {
        result = receive_status(c, datagram, size, now_us);
    } else {
        result = receive_answer(c, datagram, size, now_us);
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

/* ---- what to ask next ---- */

static bool open_get(client *c, uint32_t service, uint8_t max_tries) {
    const ask a = {ROBUROC4_ACTION_GET,
                   (uint8_t)service,
                   0,
                   max_tries,
                   service == 0 ? (uint16_t)0 : c->private_discovery.service_ids[service],
                   0};
    if (roburoc4_requests_open(&c->private_requests, &a)) {
        return false;
    }
    roburoc4_requests_begin(&c->private_requests, &a);
    return true;
}

static bool open_notification(client *c, uint8_t action, uint32_t service) {
    const ask a = {action,
                   (uint8_t)service,
                   c->private_link.services[STATUS_INDEX(service)].asked_cycles,
                   REQUEST_TRIES,
                   ROBUROC4_SERVICE_NOTIFICATION,
                   c->private_discovery.service_ids[service]};
    if (roburoc4_requests_open(&c->private_requests, &a)) {
        return false;
    }
    roburoc4_requests_begin(&c->private_requests, &a);
    return true;
}

/** Services of `set`, each in turn; true when a request was opened. */
static bool open_first_get(client *c, uint32_t set) {
    for (uint32_t service = FIRST_STATUS_SERVICE; service < ROBUROC4_SERVICE_COUNT; service++) {
        if ((set & service_bit(service)) != 0 && open_get(c, service, REQUEST_TRIES)) {
            return true;
        }
    }
    return false;
}

/** Services whose subscription is wanted and possible, but neither given nor refused. The IO card's
 *  statuses cannot be read without its properties. */
static uint32_t subscriptions_due(const client *c) {
    const discovery *d = &c->private_discovery;
    const uint32_t readable = d->known | ~(uint32_t)service_bit(ROBUROC4_SERVICE_IOCARD);
    return d->wanted & d->listed & readable & ~(uint32_t)(d->acked | d->declined);
}

static bool open_first_insert(client *c, uint64_t now_us) {
    discovery *d = &c->private_discovery;
    const uint32_t set = subscriptions_due(c);
    for (uint32_t service = FIRST_STATUS_SERVICE; service < ROBUROC4_SERVICE_COUNT; service++) {
        if ((set & service_bit(service)) != 0 &&
            open_notification(c, ROBUROC4_ACTION_INSERT, service)) {
            d->inserted |= service_bit(service);
            c->private_link.services[STATUS_INDEX(service)].inserted_us = now_us;
            return true;
        }
    }
    return false;
}

static bool open_first_delete(client *c) {
    for (uint32_t service = FIRST_STATUS_SERVICE; service < ROBUROC4_SERVICE_COUNT; service++) {
        if ((c->private_discovery.leaving & service_bit(service)) != 0 &&
            open_notification(c, ROBUROC4_ACTION_DELETE, service)) {
            return true;
        }
    }
    return false;
}

static bool open_text(client *c, bool channels) {
    ask a;
    /* texts leave a request free for what is more urgent */
    if (!roburoc4_requests_free(&c->private_requests, 1) ||
        !roburoc4_discovery_next_text(&c->private_discovery, &c->private_requests,
                                      c->private_values.io_counts, channels, &a)) {
        return false;
    }
    roburoc4_requests_begin(&c->private_requests, &a);
    return true;
}

static bool open_relocalize(client *c) {
    const ask a = {ROBUROC4_ACTION_REPLACE,
                   ROBUROC4_SERVICE_LOCALIZATION,
                   0,
                   REQUEST_TRIES,
                   c->private_discovery.service_ids[ROBUROC4_SERVICE_LOCALIZATION],
                   0};
    if (!c->private_outputs.relocalizing || roburoc4_requests_open(&c->private_requests, &a)) {
        return false;
    }
    roburoc4_requests_begin(&c->private_requests, &a);
    return true;
}

/** One question a second, to each service in turn: measures the round trip, keeps properties true,
 *  notices another directory, and tries again what was refused. */
static bool open_probe(client *c, uint64_t now_us) {
    discovery *d = &c->private_discovery;
    if (now_us - d->probe_us < PROBE_US) {
        return false;
    }
    d->probe_us = now_us;
    if (d->probe_kind == 0) {
        d->declined = 0;
    }
    do {
        d->probe_kind = (uint8_t)((d->probe_kind + 1) % ROBUROC4_SERVICE_COUNT);
    } while (d->probe_kind != 0 && (d->listed & service_bit(d->probe_kind)) == 0);
    return open_get(c, d->probe_kind, 1);
}

/** Services that were subscribed to and send nothing are subscribed to again. */
static void renew_silent(client *c, uint64_t now_us) {
    discovery *d = &c->private_discovery;
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        roburoc4_private_service *s = &c->private_link.services[i];
        const uint8_t bit = service_bit(i + FIRST_STATUS_SERVICE);
        const uint64_t limit_us = SECOND + 5 * (uint64_t)s->asked_cycles * ROBUROC4_CYCLE_US;
        if ((d->acked & d->wanted & bit) != 0 && now_us - s->inserted_us >= limit_us &&
            !roburoc4_link_fresh(&c->private_link, i, limit_us, now_us)) {
            d->acked &= (uint8_t)~bit;
        }
    }
}

/** Open the most urgent request that is not open yet. */
static bool open_next(client *c, uint64_t now_us) {
    discovery *d = &c->private_discovery;
    switch (c->private_state) {
    case ROBUROC4_STATE_CONNECTING:
    case ROBUROC4_STATE_LOST:
        return open_get(c, ROBUROC4_SERVICE_DIRECTORY, REQUEST_FOREVER);
    case ROBUROC4_STATE_DISCOVERING:
        if (!d->identified) {
            return open_text(c, false);
        }
        return open_first_get(c, d->listed & ~(uint32_t)(d->known | d->refused));
    case ROBUROC4_STATE_SUBSCRIBING:
        return open_first_insert(c, now_us);
    case ROBUROC4_STATE_READY:
        return open_relocalize(c) || open_first_insert(c, now_us) || open_first_delete(c) ||
               open_probe(c, now_us) || (!d->done && open_text(c, true));
    default:
        return false;
    }
}

/** Go on to the next state where this one has nothing left to wait for. */
static void advance(client *c, uint64_t now_us) {
    discovery *d = &c->private_discovery;
    const int32_t *io_counts = c->private_values.io_counts;
    if (c->private_state == ROBUROC4_STATE_DISCOVERING && !d->identified &&
        (roburoc4_discovery_texts_done(d, io_counts, false) ||
         now_us - d->phase_us >= IDENTIFY_US)) {
        roburoc4_discovery_identify(d);
        roburoc4_requests_cancel(&c->private_requests, ROBUROC4_ACTION_QUERY,
                                 ROBUROC4_SERVICE_DIRECTORY);
        if (d->service_ids[ROBUROC4_SERVICE_DIFFERENTIAL] != c->private_drive.service) {
            roburoc4_drive_service(&c->private_drive, false, 0);
        }
    }
    if (c->private_state == ROBUROC4_STATE_DISCOVERING && d->identified &&
        (d->listed & ~(uint32_t)(d->known | d->refused)) == 0) {
        if ((d->known & service_bit(ROBUROC4_SERVICE_DIFFERENTIAL)) == 0) {
            roburoc4_drive_service(&c->private_drive, false, 0);
        }
        enter(c, ROBUROC4_STATE_SUBSCRIBING, now_us);
    }
    if (c->private_state == ROBUROC4_STATE_SUBSCRIBING && subscriptions_due(c) == 0) {
        d->probe_us = now_us;
        enter(c, ROBUROC4_STATE_READY, now_us);
    }
    if (c->private_state == ROBUROC4_STATE_READY && !d->done &&
        roburoc4_discovery_texts_done(d, io_counts, true)) {
        d->done = 1;
        raise_event(c, ROBUROC4_EVENT_DESCRIPTIONS_DONE);
    }
}

/* ---- sending ---- */

static roburoc4_result encode_request(const client *c, const slot *s, uint8_t *buffer,
                                      size_t capacity) {
    const uint64_t *pose = c->private_outputs.pose_bits;
    const uint64_t cycles = c->private_link.newest_cycles;
    switch (s->action) {
    case ROBUROC4_ACTION_GET:
        return roburoc4_encode_get(buffer, capacity, s->id, s->target);
    case ROBUROC4_ACTION_QUERY:
        if (s->detail == LIST_DIRECTORY) {
            return roburoc4_encode_query_directory(buffer, capacity, s->id, s->subject);
        }
        return roburoc4_encode_query_iocard(buffer, capacity, s->id, s->target, s->detail,
                                            s->subject);
    case ROBUROC4_ACTION_INSERT:
        return roburoc4_encode_insert(buffer, capacity, s->id, s->subject, s->detail);
    case ROBUROC4_ACTION_DELETE:
        return roburoc4_encode_delete(buffer, capacity, s->id, s->subject);
    default: /* REPLACE; a timestamp of 0 is said to be refused by some robots */
        return roburoc4_encode_replace_localization(buffer, capacity, s->id, s->target,
                                                    cycles > 0 ? cycles : 1, f64_from_bits(pose[0]),
                                                    f64_from_bits(pose[1]), f64_from_bits(pose[2]));
    }
}

static roburoc4_result poll_requests(client *c, uint8_t *buffer, size_t capacity, uint64_t now_us) {
    for (;;) {
        slot *given_up;
        advance(c, now_us);
        slot *s = roburoc4_requests_due(&c->private_requests, c->private_config.first_retry_ms,
                                        now_us, &given_up);
        if (s != NULL) {
            if (s->tries > 1) {
                count(c, ROBUROC4_COUNT_RETRIES);
            }
            return encode_request(c, s, buffer, capacity);
        }
        if (given_up != NULL) {
            count(c, ROBUROC4_COUNT_ABANDONED);
            fail(c, given_up, ROBUROC4_ERR_TIMEOUT);
            continue;
        }
        if (!roburoc4_requests_free(&c->private_requests, 0) || !open_next(c, now_us)) {
            return 0;
        }
    }
}

/** Outputs are sent at once and twice more: nothing tells whether they arrived. */
static roburoc4_result poll_outputs(client *c, uint8_t *buffer, size_t capacity, uint64_t now_us) {
    roburoc4_private_outputs *o = &c->private_outputs;
    const int32_t *counts = c->private_values.io_counts;
    uint8_t blocks[ROBUROC4_MAX_DIGITAL_OUTPUTS / 8];
    if (o->repeats == 0 || now_us - o->sent_us < OUTPUT_PAUSE_US) {
        return 0;
    }
    for (uint32_t i = 0; i < sizeof blocks; i++) {
        blocks[i] = (uint8_t)(o->digital >> (8 * i));
    }
    o->repeats--;
    o->sent_us = now_us;
    return roburoc4_encode_iocard_command(buffer, capacity,
                                          c->private_discovery.service_ids[ROBUROC4_SERVICE_IOCARD],
                                          o->analog, (size_t)counts[ROBUROC4_IO_ANALOG_OUTPUT],
                                          blocks, (size_t)counts[ROBUROC4_IO_DIGITAL_OUTPUT]);
}

static void tick(client *c, uint64_t now_us) {
    if (connected(c) && now_us - c->private_link.last_used_us >= patience_us(c)) {
        lose(c, now_us);
    }
    roburoc4_client_tick_drive(c, now_us);
    if (c->private_outputs.relocalizing &&
        now_us - c->private_outputs.relocalize_us >= RELOCALIZE_US) {
        roburoc4_requests_cancel(&c->private_requests, ROBUROC4_ACTION_REPLACE,
                                 ROBUROC4_SERVICE_LOCALIZATION);
        relocalize_ends(c, ROBUROC4_ERR_TIMEOUT);
    }
    if (c->private_state == ROBUROC4_STATE_READY) {
        renew_silent(c, now_us);
    }
}

roburoc4_result roburoc4_client_poll_transmit(client *c, uint8_t *buffer, size_t capacity,
                                              uint64_t now_us) {
    float linear;
    float angular;
    roburoc4_result length = 0;
    if (capacity < ROBUROC4_MAX_TRANSMIT) {
        return ROBUROC4_ERR_BUFFER;
    }
    if (c->private_state == ROBUROC4_STATE_IDLE) {
        return 0;
    }
    roburoc4_client_clock(c, now_us);
    tick(c, now_us);
    if (roburoc4_drive_poll(&c->private_drive, &c->private_config, c->private_values.limits, now_us,
                            &linear, &angular, &c->private_events)) {
        length = roburoc4_encode_differential_command(buffer, capacity, c->private_drive.service,
                                                      linear, angular);
    } else if (c->private_state == ROBUROC4_STATE_CLOSING) {
        if (!c->private_drive.train) {
            enter(c, ROBUROC4_STATE_IDLE, now_us);
        }
    } else {
        length = poll_outputs(c, buffer, capacity, now_us);
        if (length == 0) {
            length = poll_requests(c, buffer, capacity, now_us);
        }
    }
    c->private_counters[ROBUROC4_COUNT_SENT] += length > 0;
    return length;
}

static void sooner(uint64_t *deadline, uint64_t candidate) {
    if (candidate < *deadline) {
        *deadline = candidate;
    }
}

uint64_t roburoc4_client_next_deadline(const client *c) {
    const discovery *d = &c->private_discovery;
    uint64_t deadline = UINT64_MAX;
    if (c->private_state == ROBUROC4_STATE_IDLE) {
        return deadline;
    }
    sooner(&deadline, roburoc4_drive_deadline(&c->private_drive, &c->private_config));
    if (c->private_state == ROBUROC4_STATE_CLOSING) {
        return deadline;
    }
    sooner(&deadline, roburoc4_requests_deadline(&c->private_requests));
    if (connected(c)) {
        sooner(&deadline, c->private_link.last_used_us + patience_us(c));
    }
    if (c->private_state == ROBUROC4_STATE_DISCOVERING && !d->identified) {
        sooner(&deadline, d->phase_us + IDENTIFY_US);
    }
    if (c->private_state == ROBUROC4_STATE_READY &&
        roburoc4_requests_free(&c->private_requests, 0)) {
        sooner(&deadline, d->probe_us + PROBE_US);
    }
    if (c->private_outputs.repeats > 0) {
        sooner(&deadline, c->private_outputs.sent_us + OUTPUT_PAUSE_US);
    }
    if (c->private_drive.armed) {
        const uint64_t fresh_us = c->private_config.fresh_ms * MS;
        const roburoc4_private_service *s = c->private_link.services;
        sooner(&deadline, s[STATUS_INDEX(ROBUROC4_SERVICE_DIFFERENTIAL)].received_us + fresh_us);
        if (c->private_values.override_known) {
            sooner(&deadline, s[STATUS_INDEX(ROBUROC4_SERVICE_IOCARD)].received_us + fresh_us);
        }
    }
    return deadline;
}

uint32_t roburoc4_client_take_events(client *c) {
    const uint32_t events = c->private_events;
    c->private_events = 0;
    return events;
}

uint32_t roburoc4_client_state(const client *c) {
    return c->private_state;
}
