/* SPDX-License-Identifier: MIT
 *
 * Received datagrams: statuses go into the stored values, to the link and to the drive state
 * machine; answers go to the request to which they belong.
 */
#include "bytes.h"
#include "lifecycle.h"

/* An answer that takes longer counts as lost. */
#define LATE_ANSWER_US SECOND

/* The head of a status: 0xFF, service, time. */
#define STATUS_HEAD 11

/* ---- properties ---- */

/** Store a property; a changed value raises an event. */
static void store(client *c, void *field, const void *value, size_t size) {
    if (memcmp(field, value, size) != 0) {
        memcpy(field, value, size);
        raise_event(c, ROBUROC4_EVENT_PROPERTIES);
    }
}

static void exceed(client *c, bool beyond) {
    c->private_events |= beyond ? ROBUROC4_EVENT_CAPACITY : 0;
}

static roburoc4_result take_iocard(client *c, const uint8_t *data, size_t size) {
    roburoc4_iocard_properties p;
    const roburoc4_result result = roburoc4_decode_iocard_properties(data, size, &p);
    discovery *d = &c->private_discovery;
    if (result < 0) {
        return result;
    }
    const int32_t counts[4] = {p.analog_inputs, p.analog_outputs, p.digital_inputs,
                               p.digital_outputs};
    if (memcmp(c->private_values.io_counts, counts, sizeof counts) != 0) {
        memcpy(c->private_values.io_counts, counts, sizeof counts);
        roburoc4_discovery_forget_inputs(d);
        roburoc4_requests_cancel_texts(&c->private_requests, LIST_DIRECTORY,
                                       c->private_timer.now_us);
        forget_override(c);
        roburoc4_lifecycle_forget_outputs(c); /* they belong to another card */
        c->private_events |= ROBUROC4_EVENT_PROPERTIES;
        exceed(c, p.analog_inputs > ROBUROC4_MAX_ANALOG_INPUTS ||
                      p.analog_outputs > ROBUROC4_MAX_ANALOG_OUTPUTS ||
                      p.digital_inputs > ROBUROC4_MAX_DIGITAL_INPUTS ||
                      p.digital_outputs > ROBUROC4_MAX_DIGITAL_OUTPUTS);
    }
    return result;
}

static roburoc4_result take_telemeters(client *c, const uint8_t *data, size_t size) {
    roburoc4_telemeter_list list;
    roburoc4_telemeter telemeter;
    values *v = &c->private_values;
    const roburoc4_result result = roburoc4_decode_telemeter_properties(data, size, &list);
    if (result < 0) {
        return result;
    }
    const uint8_t stored = (uint8_t)at_most(list.count, ROBUROC4_MAX_TELEMETERS);
    exceed(c, list.count > stored && v->telemeter_count != stored); /* once, not at each probe */
    store(c, &v->telemeter_count, &stored, 1);
    const bool none_came =
        c->private_link.services[STATUS_INDEX(ROBUROC4_SERVICE_TELEMETER)].received == 0;
    v->distance_count = none_came ? stored : v->distance_count;
    for (uint32_t i = 0; i < stored; i++) {
        roburoc4_telemeter_at(&list, i, &telemeter);
        if (none_came) {
            v->distances[i] = telemeter.distance_m; /* better than no distance */
        }
        /* the current distance is not a property */
        store(c, v->telemeters[i], &telemeter, sizeof v->telemeters[i]);
    }
    return result;
}

static roburoc4_result take_battery(client *c, const uint8_t *data, size_t size) {
    roburoc4_battery_properties p;
    const roburoc4_result result = roburoc4_decode_battery_properties(data, size, &p);
    if (result >= 0) {
        store(c, &c->private_values.battery_properties, &p, sizeof p);
    }
    return result;
}

static roburoc4_result take_localization(client *c, const uint8_t *data, size_t size) {
    roburoc4_localization_properties p;
    const roburoc4_result result = roburoc4_decode_localization_properties(data, size, &p);
    if (result >= 0) {
        store(c, &c->private_values.localization_properties, &p, sizeof p);
    }
    return result;
}

static roburoc4_result take_differential(client *c, const uint8_t *data, size_t size) {
    roburoc4_differential_properties p;
    roburoc4_differential_properties *limits = &c->private_values.limits;
    const roburoc4_result result = roburoc4_decode_differential_properties(data, size, &p);
    if (result >= 0) {
        /* the current speeds are not properties */
        limits->target_linear_m_s = p.target_linear_m_s;
        limits->target_angular_rad_s = p.target_angular_rad_s;
        limits->current_linear_m_s = p.current_linear_m_s;
        limits->current_angular_rad_s = p.current_angular_rad_s;
        store(c, limits, &p, sizeof p);
        roburoc4_drive_service(&c->private_drive, true, p.service);
    }
    return result;
}

/** Store the properties in an answer. Returns 0 or more, or an error. */
static roburoc4_result take_properties(client *c, uint32_t service, const uint8_t *data,
                                       size_t size) {
    typedef roburoc4_result (*taker)(client *, const uint8_t *, size_t);
    static const taker takers[STATUS_SERVICES] = {take_iocard, take_telemeters, take_battery,
                                                  take_localization, take_differential};
    const roburoc4_result result = takers[STATUS_INDEX(service)](c, data, size);
    if (result >= 0 && (c->private_discovery.known & service_bit(service)) == 0) {
        c->private_events |= ROBUROC4_EVENT_PROPERTIES;
    }
    return result;
}

/* ---- statuses ----
 *
 * Most statuses of a ready robot only postpone time-outs, and do not wake() the client. Those do
 * that make something due: while subscribing or stopping, after an answer, where they end driving,
 * or change whether the override is known or how ages are bounded. */

/** A status shows that the robot restarted, or is another one. */
static void see_reboot(client *c, uint64_t robot_cycles) {
    forget_override(c);
    if (c->private_state == ROBUROC4_STATE_CLOSING) {
        roburoc4_discovery_forget_inputs(&c->private_discovery);
        return;
    }
    roburoc4_lifecycle_reboot(c);
    roburoc4_link_overhear(&c->private_link, robot_cycles, c->private_now_us);
}

/** Pass a status to the link; an error unless it counts. */
static roburoc4_result judge(client *c, uint32_t service, uint64_t robot_cycles) {
    roburoc4_private_link *l = &c->private_link;
    const uint64_t floor_us = l->floor_us;
    if (l->answered) {
        wake(c); /* this status may teach that those before are older than assumed */
    }
    const verdict judged = roburoc4_link_status(l, &l->services[STATUS_INDEX(service)],
                                                robot_cycles, c->private_now_us);
    if (judged == VERDICT_REBOOT) {
        see_reboot(c, robot_cycles);
    }
    if (judged != VERDICT_NEW) {
        return ROBUROC4_ERR_OLD;
    }
    if (c->private_state == ROBUROC4_STATE_SUBSCRIBING) {
        roburoc4_subscriptions_accepted(&c->private_subscriptions, service);
        wake(c);
    }
    if (l->floor_us != floor_us) {
        wake(c); /* the statuses of other services are older than assumed */
    }
    raise_event(c, (uint32_t)ROBUROC4_EVENT_IOCARD << STATUS_INDEX(service));
    return ROBUROC4_OK;
}

/** The first 64 digital inputs, bit i for input i; the last block may have bits of no input. */
static uint64_t digital_bits(const roburoc4_channels *inputs) {
    const uint32_t count = at_most(inputs->digital_count, 64);
    const uint8_t *block = inputs->digital + (count + 7) / 8;
    uint64_t bits = 0;
    while (block != inputs->digital) {
        bits = bits << 8 | *--block;
    }
    return bits & lowest_bits(count);
}

/** Any of the statuses; each begins with the robot's time. */
typedef union any_status {
    uint64_t robot_cycles;
    roburoc4_channels inputs;
    roburoc4_telemeter_status telemeters;
    roburoc4_battery_status battery;
    roburoc4_localization_status localization;
    roburoc4_differential_status differential;
} any_status;

static roburoc4_result decode_status(const client *c, uint32_t service, const uint8_t *data,
                                     size_t size, any_status *out) {
    const int32_t *counts = c->private_values.io_counts;
    switch (service) {
    case ROBUROC4_SERVICE_IOCARD:
        return roburoc4_decode_iocard_status(data, size, (uint32_t)counts[ROBUROC4_IO_ANALOG_INPUT],
                                             (uint32_t)counts[ROBUROC4_IO_DIGITAL_INPUT],
                                             &out->inputs);
    case ROBUROC4_SERVICE_TELEMETER:
        return roburoc4_decode_telemeter_status(data, size, &out->telemeters);
    case ROBUROC4_SERVICE_BATTERY:
        return roburoc4_decode_battery_status(data, size, &out->battery);
    case ROBUROC4_SERVICE_LOCALIZATION:
        return roburoc4_decode_localization_status(data, size, &out->localization);
    case ROBUROC4_SERVICE_DIFFERENTIAL:
        return roburoc4_decode_differential_status(data, size, &out->differential);
    default:
        return ROBUROC4_ERR_UNEXPECTED_STATUS;
    }
}

/** The inputs, and from them the override: whether the game pad's [A] is held. */
static void take_inputs(client *c, const roburoc4_channels *inputs) {
    values *v = &c->private_values;
    (void)roburoc4_floats(inputs->analog, inputs->analog_count, v->analog,
                          ROBUROC4_MAX_ANALOG_INPUTS);
    const uint64_t digital = digital_bits(inputs); /* the first ROBUROC4_MAX_DIGITAL_INPUTS */
    v->digital = digital;
    const roburoc4_result index = index_of_role(c, ROBUROC4_ROLE_OVERRIDE);
    const uint8_t known = index >= 0;
    const uint8_t overridden = known ? (uint8_t)(digital >> index & 1) : 0;
    if (overridden != c->private_conditions.overridden) {
        raise_event(c, ROBUROC4_EVENT_OVERRIDE);
    }
    if (known != c->private_conditions.override_known ||
        overridden != c->private_conditions.overridden || c->private_drive.stopping) {
        wake(c);
    }
    c->private_conditions.override_known = known;
    c->private_conditions.overridden = overridden;
    if (c->private_state == ROBUROC4_STATE_CLOSING &&
        c->private_timer.now_us - c->private_drive.granted_us >=
            c->private_config.robot_watchdog_ms * MS) {
        c->private_drive.overridden = overridden; /* set before, so that the release of [A] begins
                                                     no new sequence: this one must end */
    }
    const uint32_t card = STATUS_INDEX(ROBUROC4_SERVICE_IOCARD);
    roburoc4_drive_override(&c->private_drive, overridden, known,
                            (uint32_t)c->private_link.services[card].robot_cycles);
    if (overridden) {
        roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_OVERRIDE);
    }
}

static void take_battery_status(client *c, const roburoc4_battery_status *status) {
    values *v = &c->private_values;
    const bool known = (c->private_discovery.known & service_bit(ROBUROC4_SERVICE_BATTERY)) != 0;
    uint8_t low = status->state == ROBUROC4_BATTERY_CRITICAL ? BATTERY_CRITICAL : 0;
    if (known) {
        low |= BATTERY_JUDGED;
        low |= status->remaining_percent < v->battery_properties.minimum_percent
                   ? BATTERY_BELOW_MINIMUM
                   : 0;
    }
    if ((low & ~v->battery_low & BATTERY_CRITICAL) != 0) {
        raise_event(c, ROBUROC4_EVENT_BATTERY_CRITICAL);
    }
    if ((low & ~v->battery_low & BATTERY_BELOW_MINIMUM) != 0) {
        raise_event(c, ROBUROC4_EVENT_BATTERY_LOW);
    }
    v->battery_low = low;
    v->battery = *status;
}

/** Whether [A] is not held, by a status as new as that of the speeds; or cannot be known, which the
 * user has allowed. */
static bool pad_is_released(const client *c) {
    const roburoc4_private_service *services = c->private_link.services;
    return c->private_conditions.override_known
               ? services[STATUS_INDEX(ROBUROC4_SERVICE_IOCARD)].robot_cycles >=
                     services[STATUS_INDEX(ROBUROC4_SERVICE_DIFFERENTIAL)].robot_cycles
               : roburoc4_conditions_without_pad(c);
}

static void take_speeds(client *c, const roburoc4_differential_status *status) {
    values *v = &c->private_values;
    drive *d = &c->private_drive;
    const uint8_t armed = d->armed;
    v->differential = *status;
    if (c->private_outputs.relocalizing) {
        roburoc4_schedule_watch_pose(c);
    }
    const pad_state pad = c->private_conditions.overridden ? PAD_HELD
                          : pad_is_released(c)             ? PAD_RELEASED
                                                           : PAD_NOT_SEEN;
    roburoc4_drive_status(d, &c->private_config, &v->differential, pad, &c->private_link,
                          c->private_timer.now_us, &c->private_events);
    if (d->stopping || d->armed != armed) {
        wake(c);
    }
}

/** The one of these services with this id, or 0. The search begins with the manual's ids, which a
 * RobuROC4 uses. */
static inline uint32_t service_with_id(const discovery *d, uint32_t services, uint16_t id) {
    if (id < ROBUROC4_SERVICE_COUNT && d->service_ids[id] == id && (services >> id & 1) != 0) {
        return id;
    }
    for (uint32_t service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++) {
        if (d->service_ids[service] == id && (services & service_bit(service)) != 0) {
            return service;
        }
    }
    return 0;
}

/** A status of at least its head's length. */
static roburoc4_result receive_status(client *c, const uint8_t *data, size_t size) {
    const discovery *d = &c->private_discovery;
    const uint32_t service =
        service_with_id(d, c->private_subscriptions.inserted, load_u16(data + 1));
    values *v = &c->private_values;
    any_status status;
    const roburoc4_result surplus = decode_status(c, service, data, size, &status);
    if (surplus < 0) {
        return surplus;
    }
    const roburoc4_result result = judge(c, service, status.robot_cycles);
    if (result < 0) {
        return result;
    }
    switch (service) {
    case ROBUROC4_SERVICE_IOCARD:
        take_inputs(c, &status.inputs);
        break;
    case ROBUROC4_SERVICE_TELEMETER:
        v->distance_count =
            (uint8_t)roburoc4_floats(status.telemeters.distances, status.telemeters.count,
                                     v->distances, ROBUROC4_MAX_TELEMETERS);
        break;
    case ROBUROC4_SERVICE_BATTERY:
        take_battery_status(c, &status.battery);
        break;
    case ROBUROC4_SERVICE_LOCALIZATION:
        v->localization = status.localization;
        break;
    default:
        take_speeds(c, &status.differential);
        break;
    }
    return surplus;
}

/** A status that was not subscribed to yet: an earlier client subscribed to it. */
static void overhear(client *c, const uint8_t *data) {
    const discovery *d = &c->private_discovery;
    if (c->private_state == ROBUROC4_STATE_DISCOVERING && d->identified &&
        service_with_id(d, d->listed, load_u16(data + 1)) != 0) {
        roburoc4_link_overhear(&c->private_link, load_u64(data + 3), c->private_now_us);
    }
}

/* ---- answers ---- */

/** A directory arrived: new services are discovered, known ones keep their texts. */
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
        if (connected(c)) { /* otherwise the client has already disarmed, with its cause */
            roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_NO_DIFFERENTIAL);
        }
        roburoc4_discovery_clear(d);
        if (roburoc4_discovery_directory(d, &directory)) {
            raise_event(c, ROBUROC4_EVENT_CAPACITY);
        }
        raise_event(c, ROBUROC4_EVENT_PROPERTIES);
    }
    if (!roburoc4_discovery_may_drive(d, &c->private_config,
                                      c->private_drive.service)) { /* its list may be empty */
        roburoc4_drive_service(&c->private_drive, false, 0);
    }
    roburoc4_lifecycle_forget_services(c, ROBUROC4_STATE_DISCOVERING);
    return result;
}

static void take_text(client *c, const slot *s, const roburoc4_text *text) {
    discovery *d = &c->private_discovery;
    if (in_fixed_id_mode(&c->private_requests) && s->ask.detail == LIST_DIRECTORY) {
        /* in fixed-id mode a late text may belong to another request: it identifies no service */
        roburoc4_discovery_doubtful_text(d, s->ask.subject);
    } else if (in_fixed_id_mode(&c->private_requests)) {
        roburoc4_discovery_doubt(d, s->ask.detail, s->ask.subject,
                                 roburoc4_discovery_roles(s->ask.detail, text->text, text->length));
    } else if (roburoc4_discovery_text(d, s->ask.detail, s->ask.subject, text->text,
                                       text->length)) {
        raise_event(c, ROBUROC4_EVENT_ROLE);
    }
    d->described_kind = (uint8_t)(s->ask.detail + 1);
    d->described_index = s->ask.subject;
    raise_event(c, ROBUROC4_EVENT_DESCRIPTION);
}

/** A late text may change which service an id belongs to. */
static void identify_again(client *c) {
    if (c->private_discovery.identified &&
        roburoc4_discovery_identify(&c->private_discovery, &c->private_config)) {
        roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_NO_DIFFERENTIAL);
        roburoc4_lifecycle_forget_services(c, ROBUROC4_STATE_DISCOVERING);
    }
}

/** Store the content of a good answer; returns an error if there is one. */
static roburoc4_result take_answer(client *c, const slot *s, const uint8_t *data, size_t size) {
    discovery *d = &c->private_discovery;
    roburoc4_text text;
    roburoc4_result result = ROBUROC4_OK;
    switch (s->ask.action) {
    case ROBUROC4_ACTION_GET:
        if (s->ask.kind == ROBUROC4_SERVICE_DIRECTORY) {
            return take_directory(c, data, size);
        }
        result = take_properties(c, s->ask.kind, data, size);
        if (result >= 0) {
            d->known |= service_bit(s->ask.kind);
            d->refused &= (uint8_t)~service_bit(s->ask.kind);
        }
        break;
    case ROBUROC4_ACTION_QUERY:
        result = WITH_TEXTS ? roburoc4_decode_text(data, size, &text) : ROBUROC4_ERR_KIND;
        if (WITH_TEXTS && result >= 0) {
            take_text(c, s, &text);
        }
        break;
    case ROBUROC4_ACTION_INSERT:
        roburoc4_link_expect(&c->private_link, STATUS_INDEX((uint32_t)s->ask.kind),
                             c->private_config.period_ms[s->ask.kind]);
        roburoc4_subscriptions_accepted(&c->private_subscriptions, s->ask.kind);
        break;
    case ROBUROC4_ACTION_DELETE:
        roburoc4_subscriptions_left(&c->private_subscriptions, s->ask.kind);
        break;
    default: /* REPLACE */
        roburoc4_schedule_pose_taken(c, s);
        break;
    }
    return result;
}

/** Whether this certainly answers that request, and not an earlier one of the same service and
 * action. In fixed-id mode only probes are far enough apart for that. */
static bool measures_round_trip(const client *c, const slot *s, uint8_t id) {
    if (id != s->id || (s->tries > 1 && s->ask.max_tries == REQUEST_FOREVER)) {
        return false;
    }
    return !in_fixed_id_mode(&c->private_requests) ||
           (s->tries == 1 && s->ask.action == ROBUROC4_ACTION_GET &&
            c->private_state == ROBUROC4_STATE_READY &&
            c->private_timer.now_us - c->private_schedule.phase_us >= LATE_ANSWER_US);
}

/** An answer to no open request while a text is doubted. If it means something else, that one may
 * have been an earlier request's answer, and this the right one: the text is requested again. */
static void contradict(client *c, const uint8_t *data, size_t size, bool bad) {
    discovery *d = &c->private_discovery;
    roburoc4_text text;
    uint8_t roles = TEXT_REFUSED;
    if ((size > 1 && data[1] != ROBUROC4_ACTION_QUERY) ||
        (size > 3 && load_u16(data + 2) != d->service_ids[ROBUROC4_SERVICE_IOCARD])) {
        return;
    }
    if (!bad && roburoc4_decode_text(data, size, &text) >= 0) {
        roles = roburoc4_discovery_roles(d->doubted_list, text.text, text.length);
    }
    if (d->doubted && roles != d->doubted_roles) {
        d->doubted = 0;
        wake(c);
    }
}

/** The request to which an answer belongs, or NULL. The answer may begin or end fixed-id mode, and
 * then other texts are believed; or end a text for which a probe waits. */
static slot *find_request(client *c, const uint8_t *data, size_t size) {
    const requests *r = &c->private_requests;
    const bool fixed_id = in_fixed_id_mode(r);
    const bool text_open = roburoc4_requests_text_open(r);
    slot *s = roburoc4_requests_match(&c->private_requests, data, size, c->private_timer.now_us);
    if (fixed_id != in_fixed_id_mode(r) || text_open != roburoc4_requests_text_open(r)) {
        wake(c);
    }
    if (fixed_id != in_fixed_id_mode(r)) {
        forget_override(c);
        if (fixed_id) {
            roburoc4_discovery_read_texts_again(&c->private_discovery);
        }
    }
    return s;
}

/** Store what the answer to a request says, or note why that request failed. */
static roburoc4_result end_request(client *c, const slot *request, const uint8_t *data, size_t size,
                                   bool bad) {
    if (c->private_state == ROBUROC4_STATE_CLOSING) {
        return ROBUROC4_OK; /* that it came is all that counts */
    }
    const roburoc4_result result = bad ? ROBUROC4_ERR_ROBOT : take_answer(c, request, data, size);
    if (result < 0) {
        roburoc4_schedule_failed(c, request, result);
    }
    if (WITH_TEXTS && request->ask.action == ROBUROC4_ACTION_QUERY &&
        request->ask.detail == LIST_DIRECTORY) {
        identify_again(c);
    }
    return bad ? ROBUROC4_OK : result;
}

/** What it means that the answer with this id came now. */
static void take_times(client *c, const slot *s, uint8_t id) {
    const uint32_t now_us = c->private_timer.now_us;
    const bool certain = measures_round_trip(c, s, id);
    c->private_answered_us = now_us;
    /* an error without an id may be about an earlier request, as all may be in fixed-id mode */
    if (certain || (id == s->id && !in_fixed_id_mode(&c->private_requests))) {
        roburoc4_drive_heard(&c->private_drive, s->sent_us);
        roburoc4_drive_arrived(&c->private_drive, s->sent_us, now_us);
    }
    if (certain) {
        roburoc4_link_round_trip(&c->private_link, s->ask.action == ROBUROC4_ACTION_QUERY,
                                 s->sent_us, now_us);
    }
}

static roburoc4_result receive_answer(client *c, const uint8_t *data, size_t size) {
    const bool bad = data[0] == ROBUROC4_HEADER_ERROR || (size >= 5 && data[4] != 0);
    if (size < 5 && !bad) {
        return ROBUROC4_ERR_SHORT;
    }
    slot *s = find_request(c, data, size);
    if (s == NULL) {
        if (WITH_TEXTS) {
            contradict(c, data, size, bad);
        }
        return ROBUROC4_ERR_UNMATCHED;
    }
    wake(c);
    const slot request = *s; /* closing it, or a new state, may change the slot */
    take_times(c, s, data[0]);
    if (bad) {
        count_up(c, ROBUROC4_COUNT_REFUSED);
    }
    if (bad && s->ask.max_tries == REQUEST_FOREVER) {
        return ROBUROC4_OK; /* without a directory there is no robot: the request stays open and is
                               repeated */
    }
    roburoc4_requests_close(&c->private_requests, s, c->private_timer.now_us);
    if (c->private_requests.announce) {
        c->private_requests.announce = 0;
        raise_event(c, ROBUROC4_EVENT_FIXED_ID);
    }
    return end_request(c, &request, data, size, bad);
}

static void count_drop(client *c, roburoc4_result why) {
    switch (why) {
    case ROBUROC4_ERR_SHORT:
        count_up(c, ROBUROC4_COUNT_SHORT);
        break;
    case ROBUROC4_ERR_UNMATCHED:
        count_up(c, ROBUROC4_COUNT_UNMATCHED);
        break;
    case ROBUROC4_ERR_UNEXPECTED_STATUS:
        count_up(c, ROBUROC4_COUNT_UNEXPECTED_STATUS);
        break;
    case ROBUROC4_ERR_OLD:
        count_up(c, ROBUROC4_COUNT_OLD);
        break;
    default:
        count_up(c, ROBUROC4_COUNT_MALFORMED);
        break;
    }
}

static inline void see_time_of_datagram(client *c, uint64_t now_us) {
    see_time(c, now_us);
    if (lapses(&c->private_drive, c->private_timer.now_us)) {
        roburoc4_lifecycle_see_time(c, now_us);
    }
    if (c->private_outputs.relocalizing) {
        roburoc4_schedule_pose_waits(c);
    }
}

roburoc4_result roburoc4_client_receive(client *c, const uint8_t *datagram, size_t size,
                                        uint64_t now_us) {
    roburoc4_result result;
    c->private_discovery.described_kind = 0;
    if (c->private_state == ROBUROC4_STATE_IDLE) {
        return ROBUROC4_ERR_STATE;
    }
    see_time_of_datagram(c, now_us);
    count_up(c, ROBUROC4_COUNT_RECEIVED);
    if (size >= STATUS_HEAD && datagram[0] == ROBUROC4_HEADER_STATUS) {
        result = receive_status(c, datagram, size);
        if (!c->private_drive.armed && !c->private_conditions.armable) {
            roburoc4_conditions_watch_arming(c);
        }
    } else if (size == 0 || datagram[0] == ROBUROC4_HEADER_STATUS) {
        result = ROBUROC4_ERR_SHORT;
    } else {
        result = receive_answer(c, datagram, size);
    }
    if (result < 0) {
        if (result == ROBUROC4_ERR_UNEXPECTED_STATUS) {
            overhear(c, datagram);
        }
        count_drop(c, result);
        return result;
    }
    if (result > 0) {
        count_up(c, ROBUROC4_COUNT_SURPLUS);
    }
    c->private_link.last_used_us = (uint32_t)now_us;
    return result;
}
