/* SPDX-License-Identifier: MIT
 *
 * Which request comes next: from the directory to the last channel's text, subscriptions, the
 * probe; the consequences of a failed request; and when a state has nothing left to wait for.
 */
#include "bytes.h"
#include "lifecycle.h"

/* A probe is given up after 1.5 s (at the default first_retry_ms). */
#define PROBE_TRIES 4
/* Given up after 2.5 s (at the default first_retry_ms); a probe asks again later. */
#define REQUEST_TRIES 5
#define FIRST_STATUS_SERVICE ROBUROC4_SERVICE_IOCARD
/* A refusal that does not name its request holds up texts, so what was refused is asked again only
 * after this long. */
#define DECLINED_US (30 * SECOND)
/* A pose that was not sent within this time is sent only to a robot at rest; one that is accepted
 * after POSE_TAKEN_US counts only if the robot is at rest then, too. */
#define POSE_US (50 * MS)
/* A robot below these speeds, in m/s and rad/s, is at rest for a new pose; older statuses do not
 * show that it still is. */
#define POSE_FRESH_MS 150
#define POSE_REST_M_S 0.02F
#define POSE_REST_RAD_S 0.05F

/** Request something without parameters, or the service's subscription. */
static bool open_about(client *c, uint8_t action, uint32_t service, uint8_t max_tries) {
    const uint16_t id = c->private_discovery.service_ids[service];
    ask a = {id, 0, action, (uint8_t)service, 0, max_tries};
    if (action == ROBUROC4_ACTION_INSERT || action == ROBUROC4_ACTION_DELETE) {
        a.target = ROBUROC4_SERVICE_NOTIFICATION;
        a.subject = id;
        a.detail = (uint8_t)cycles_of(c->private_config.period_ms[service]);
    }
    return roburoc4_requests_begin(&c->private_requests, &a);
}

/** Try the services of `set` in turn: the one for which a request was opened, or 0. */
static uint32_t open_first(client *c, uint8_t action, uint32_t set) {
    for (uint32_t service = FIRST_STATUS_SERVICE; service < ROBUROC4_SERVICE_COUNT; service++) {
        if ((set & service_bit(service)) != 0 && open_about(c, action, service, REQUEST_TRIES)) {
            return service;
        }
    }
    return 0;
}

static uint32_t properties_due(const discovery *d) {
    return d->listed & ~(uint32_t)(d->known | d->refused);
}

static uint32_t subscriptions_due(const client *c) {
    return roburoc4_subscriptions_due(&c->private_subscriptions, &c->private_config,
                                      &c->private_discovery);
}

static bool open_first_insert(client *c) {
    const uint32_t service = open_first(c, ROBUROC4_ACTION_INSERT, subscriptions_due(c));
    if (service == 0) {
        return false;
    }
    roburoc4_subscriptions_inserted(&c->private_subscriptions, service, c->private_timer.now_us);
    roburoc4_link_renewed(&c->private_link, STATUS_INDEX(service), c->private_timer.now_us);
    return true;
}

static bool open_text(client *c, text_choice choice) {
    discovery *d = &c->private_discovery;
    ask a;
    if (!WITH_TEXTS || (d->texts_done && !d->text_due) ||
        !roburoc4_requests_has_room_for_text(&c->private_requests) ||
        !roburoc4_discovery_next_text(d, &c->private_requests, c->private_values.io_counts, choice,
                                      &a)) {
        return false;
    }
    d->text_due = 0;
    return roburoc4_requests_begin(&c->private_requests, &a);
}

static void ask_declined_again(client *c) {
    subscriptions *s = &c->private_subscriptions;
    if (!c->private_requests.single_texts || due(&c->private_timer, s->refused_us, DECLINED_US)) {
        roburoc4_subscriptions_ask_declined(s);
    }
}

/** In fixed-id mode the proof of zeros comes before texts, unless [A] is not known: then nothing is
 * confirmed anyway. */
static bool texts_wait(const client *c) {
    return in_fixed_id_mode(&c->private_requests) &&
           (c->private_drive.armed ||
            (c->private_drive.stopping && c->private_conditions.override_known));
}

/** Texts that were given up are asked for again while nobody drives, or as long as [A] is not
 * known. */
static bool asks_again(const client *c) {
    return WITH_TEXTS && (!c->private_drive.lease_active || !c->private_conditions.override_known);
}

/** A request to each service in turn. It measures the round trip, keeps properties current, notices
 * a changed directory, and repeats what was refused. Then a missing text is requested. */
static bool open_probe(client *c) {
    discovery *d = &c->private_discovery;
    roburoc4_private_schedule *s = &c->private_schedule;
    if (!due(&c->private_timer, s->probe_us, probe_period_us(c))) {
        return false;
    }
    s->probe_us = c->private_timer.now_us;
    s->text_first = 1;
    if (asks_again(c)) {
        roburoc4_discovery_ask_again(d, c->private_values.io_counts);
    }
    if (s->probe_kind == 0) {
        ask_declined_again(c);
        if (in_fixed_id_mode(&c->private_requests) && !texts_wait(c) &&
            index_of_role(c, ROBUROC4_ROLE_OVERRIDE) < 0 &&
            roburoc4_discovery_inputs_passed(d, c->private_values.io_counts)) {
            roburoc4_discovery_forget_inputs(d);
            /* all texts may be shifted by one: read them again */
            roburoc4_requests_be_quiet(&c->private_requests, NULL, c->private_timer.now_us);
        }
    }
    do {
        s->probe_kind =
            s->probe_kind + 1U < ROBUROC4_SERVICE_COUNT ? (uint8_t)(s->probe_kind + 1U) : 0;
    } while (s->probe_kind != 0 && (d->listed & service_bit(s->probe_kind)) == 0);
    return open_about(c, ROBUROC4_ACTION_GET, s->probe_kind, PROBE_TRIES);
}

static void text_failed(client *c, const slot *s, roburoc4_result why) {
    discovery *d = &c->private_discovery;
    const bool doubtful =
        s->ask.detail != LIST_DIRECTORY &&
        (in_fixed_id_mode(&c->private_requests) || c->private_requests.single_texts);
    if (why != ROBUROC4_ERR_ROBOT) {
        roburoc4_discovery_text_given_up(d, s->ask.detail, s->ask.subject);
    } else if (doubtful) {
        roburoc4_discovery_doubt(d, s->ask.detail, s->ask.subject, TEXT_REFUSED);
    } else {
        roburoc4_discovery_text_refused(d, c->private_values.io_counts, s->ask.detail,
                                        s->ask.subject);
    }
}

void roburoc4_schedule_failed(client *c, const slot *s, roburoc4_result why) {
    discovery *d = &c->private_discovery;
    switch (s->ask.action) {
    case ROBUROC4_ACTION_GET:
        d->refused |= service_bit(s->ask.kind);
        /* it answered this before, so the refusal is meant for another request */
        if (s->ask.kind == ROBUROC4_SERVICE_DIFFERENTIAL && why != ROBUROC4_ERR_TIMEOUT &&
            (why != ROBUROC4_ERR_ROBOT ||
             (d->known & service_bit(ROBUROC4_SERVICE_DIFFERENTIAL)) == 0)) {
            roburoc4_drive_service(&c->private_drive, false, c->private_drive.service);
        }
        break;
    case ROBUROC4_ACTION_QUERY:
        if (WITH_TEXTS) {
            text_failed(c, s, why);
        }
        break;
    case ROBUROC4_ACTION_INSERT:
        raise_event(c, ROBUROC4_EVENT_SUBSCRIPTION_REFUSED);
        roburoc4_subscriptions_refused(&c->private_subscriptions, s->ask.kind,
                                       c->private_timer.now_us);
        break;
    case ROBUROC4_ACTION_DELETE:
        roburoc4_subscriptions_left(&c->private_subscriptions, s->ask.kind);
        break;
    default: /* REPLACE */
        roburoc4_lifecycle_relocalize_ends(c, why);
        break;
    }
}

static bool open_properties(client *c) {
    return open_first(c, ROBUROC4_ACTION_GET, properties_due(&c->private_discovery)) != 0;
}

static bool open_pose(client *c) {
    return c->private_outputs.relocalizing &&
           open_about(c, ROBUROC4_ACTION_REPLACE, ROBUROC4_SERVICE_LOCALIZATION, REQUEST_TRIES);
}

/** With a text and a probe open, nobody knows which of them an error without an id refuses. So a
 * probe waits for the text, unless the robot may move. */
static bool probe_waits(const client *c) {
    return c->private_requests.single_texts && roburoc4_requests_text_open(&c->private_requests) &&
           !c->private_drive.armed && !c->private_drive.stopping;
}

/** The probe, else a text. With a slow robot in fixed-id mode a probe is always due: then they take
 * turns. */
static bool open_probe_or_text(client *c) {
    roburoc4_private_schedule *s = &c->private_schedule;
    const bool text_first = s->text_first && in_fixed_id_mode(&c->private_requests);
    if (texts_wait(c)) {
        return open_probe(c);
    }
    if (probe_waits(c)) {
        return false;
    }
    s->text_first = 0;
    return (text_first && open_text(c, TEXTS_ALL)) || open_probe(c) || open_text(c, TEXTS_ALL);
}

static bool open_first_delete(client *c) {
    return open_first(c, ROBUROC4_ACTION_DELETE, c->private_subscriptions.leaving) != 0;
}

/** Ask for the directory: to connect, or in closing to prove that zeros arrived. In fixed-id mode
 * an answer may not prove it, and then the next request waits. */
static bool open_directory(client *c) {
    roburoc4_private_schedule *s = &c->private_schedule;
    if (c->private_state == ROBUROC4_STATE_CLOSING &&
        !due(&c->private_timer, s->probe_us, c->private_config.first_retry_ms * MS)) {
        return false;
    }
    s->probe_us = c->private_timer.now_us;
    return open_about(c, ROBUROC4_ACTION_GET, ROBUROC4_SERVICE_DIRECTORY, REQUEST_FOREVER);
}

/** Open the most urgent request that is not open yet. */
static bool open_next(client *c) {
    switch (c->private_state) {
    case ROBUROC4_STATE_DISCOVERING:
        if (!c->private_discovery.identified) {
            return open_text(c, TEXTS_OF_SERVICES);
        }
        return open_properties(c) || open_text(c, TEXTS_THAT_DECIDE);
    case ROBUROC4_STATE_SUBSCRIBING:
        return open_first_insert(c) || open_text(c, TEXTS_THAT_DECIDE);
    case ROBUROC4_STATE_READY:
        return open_pose(c) || open_properties(c) || open_first_insert(c) || open_first_delete(c) ||
               open_probe_or_text(c);
    default: /* connecting, lost, closing */
        return open_directory(c);
    }
}

/* ---- the next state, once nothing remains to wait for in this one ---- */

static void identify(client *c) {
    discovery *d = &c->private_discovery;
    if (WITH_TEXTS && !roburoc4_discovery_services_passed(d) &&
        !due(&c->private_timer, c->private_schedule.phase_us, IDENTIFY_US)) {
        return;
    }
    roburoc4_discovery_identify(d, &c->private_config);
    roburoc4_requests_cancel(&c->private_requests, ROBUROC4_ACTION_QUERY,
                             ROBUROC4_SERVICE_DIRECTORY, c->private_timer.now_us);
    if (d->service_ids[ROBUROC4_SERVICE_DIFFERENTIAL] != c->private_drive.service) {
        roburoc4_drive_service(&c->private_drive, false, 0);
    }
    if ((d->listed & service_bit(ROBUROC4_SERVICE_IOCARD)) == 0) {
        memset(c->private_values.io_counts, 0, sizeof c->private_values.io_counts);
        forget_override(c);
        roburoc4_drive_override(&c->private_drive, false, false, 0);
    }
}

static void advance_discovering(client *c) {
    discovery *d = &c->private_discovery;
    if (!d->identified) {
        identify(c);
    }
    if (d->identified && properties_due(d) == 0) {
        if ((d->known & service_bit(ROBUROC4_SERVICE_DIFFERENTIAL)) == 0) {
            roburoc4_drive_service(&c->private_drive, false, c->private_drive.service);
        }
        roburoc4_lifecycle_enter(c, ROBUROC4_STATE_SUBSCRIBING);
    }
}

static void advance_subscribing(client *c) {
    if (subscriptions_due(c) != 0) {
        return;
    }
    if (!roburoc4_subscriptions_all_declined(&c->private_subscriptions, &c->private_config,
                                             &c->private_discovery)) {
        c->private_schedule.probe_us = c->private_timer.now_us;
        roburoc4_lifecycle_enter(c, ROBUROC4_STATE_READY);
    } else if (due(&c->private_timer, c->private_subscriptions.refused_us, SECOND)) {
        roburoc4_subscriptions_ask_declined(&c->private_subscriptions); /* not ready: no data */
        open_about(c, ROBUROC4_ACTION_GET, ROBUROC4_SERVICE_DIRECTORY, PROBE_TRIES);
    }
}

static void advance(client *c) {
    discovery *d = &c->private_discovery;
    if (c->private_state == ROBUROC4_STATE_DISCOVERING) {
        advance_discovering(c);
    }
    if (c->private_state == ROBUROC4_STATE_SUBSCRIBING) {
        advance_subscribing(c);
    }
    if (c->private_state == ROBUROC4_STATE_READY && !d->texts_done &&
        (!WITH_TEXTS || roburoc4_discovery_texts_passed(d, c->private_values.io_counts))) {
        d->texts_done = 1;
        raise_event(c, ROBUROC4_EVENT_DESCRIPTIONS_DONE);
    }
}

/* ---- a pose holds only while the robot is at rest ---- */

void roburoc4_schedule_watch_pose(client *c) {
    const roburoc4_differential_status *s = &c->private_values.differential;
    const drive *d = &c->private_drive;
    const bool driving =
        d->lease_active && !(within_f32(d->target[0], 0) && within_f32(d->target[1], 0));
    const bool rests = within_f32(s->target_linear_m_s, POSE_REST_M_S) &&
                       within_f32(s->current_linear_m_s, POSE_REST_M_S) &&
                       within_f32(s->target_angular_rad_s, POSE_REST_RAD_S) &&
                       within_f32(s->current_angular_rad_s, POSE_REST_RAD_S);
    if (driving || !rests) {
        c->private_outputs.moved = 1;
    }
}

static void expect_speeds_within(client *c, uint32_t limit_ms) {
    if (!roburoc4_link_fresh(&c->private_link, STATUS_INDEX(ROBUROC4_SERVICE_DIFFERENTIAL),
                             limit_ms * MS, c->private_now_us, &c->private_timer)) {
        c->private_outputs.unwatched = 1;
    }
}

void roburoc4_schedule_pose_waits(client *c) {
    expect_speeds_within(c, c->private_config.fresh_ms);
}

/** Whether statuses show that the robot has been at rest since the call. */
static bool has_rested(client *c) {
    expect_speeds_within(c, at_most(c->private_config.fresh_ms, POSE_FRESH_MS));
    return !c->private_outputs.moved && !c->private_outputs.unwatched;
}

/** Whether a pose that is sent now is still that of the call. */
static bool pose_holds(client *c, const slot *s) {
    return (s->tries == 1 &&
            c->private_timer.now_us - c->private_outputs.relocalize_us < POSE_US) ||
           has_rested(c);
}

void roburoc4_schedule_pose_taken(client *c, const slot *s) {
    const roburoc4_private_outputs *o = &c->private_outputs;
    roburoc4_result result = ROBUROC4_OK;
    const bool late = s->tries > 1 || c->private_timer.now_us - o->relocalize_us >= POSE_TAKEN_US;
    if (late && !has_rested(c)) {
        result = o->moved ? ROBUROC4_ERR_MOVING : ROBUROC4_ERR_STALE_DIFFERENTIAL;
    }
    roburoc4_lifecycle_relocalize_ends(c, result);
}

/* ---- sending ---- */

static roburoc4_result encode_request(const client *c, const slot *s, uint8_t *buffer,
                                      size_t capacity) {
    const roburoc4_private_outputs *o = &c->private_outputs;
    const uint64_t cycles = c->private_link.newest_cycles;
    roburoc4_request request;
    memset(&request, 0, sizeof request);
    request.id = s->id;
    request.action = s->ask.action;
    request.service = s->ask.target;
    request.subject = s->ask.subject;
    if (s->ask.action == ROBUROC4_ACTION_INSERT) {
        request.period_cycles = s->ask.detail;
    } else {
        request.io_type = s->ask.detail;
        request.index = s->ask.subject;
    }
    request.timestamp = cycles > 0 ? cycles : 1; /* some robots are said to refuse 0 */
    request.x_m = o->x_m;
    request.y_m = o->y_m;
    request.theta_rad = o->theta_rad;
    return roburoc4_encode_request(buffer, capacity, &request);
}

/** Whether a request that is due may be sent: all but a pose that no longer holds. */
static bool may_send(client *c, slot *s) {
    if (s->ask.action != ROBUROC4_ACTION_REPLACE || pose_holds(c, s)) {
        return true;
    }
    if (c->private_outputs.moved) {
        roburoc4_requests_abandon(&c->private_requests, s, c->private_timer.now_us);
        roburoc4_lifecycle_relocalize_ends(c, ROBUROC4_ERR_MOVING);
    } /* else it may still be answered, and ends after its time */
    return false;
}

static void give_up(client *c, const slot *s) {
    count_up(c, ROBUROC4_COUNT_ABANDONED);
    roburoc4_schedule_failed(c, s, ROBUROC4_ERR_TIMEOUT);
    if (c->private_state != ROBUROC4_STATE_READY) {
        /* find out whether only this service is silent */
        open_about(c, ROBUROC4_ACTION_GET, ROBUROC4_SERVICE_DIRECTORY, REQUEST_FOREVER);
    }
}

/** Whether a doubted text was believed, because nothing contradicted it. */
static bool believe(client *c) {
    if (!WITH_TEXTS || !c->private_discovery.doubted || c->private_requests.quiet) {
        return false;
    }
    const bool found =
        roburoc4_discovery_believe(&c->private_discovery, c->private_values.io_counts);
    raise_event(c, found ? ROBUROC4_EVENT_ROLE : 0);
    return true;
}

/** The next request to send. It may begin fixed-id mode, in which other texts are believed. */
static slot *next_request(client *c, slot **given_up) {
    requests *r = &c->private_requests;
    const bool fixed_id = in_fixed_id_mode(r);
    slot *s = roburoc4_requests_due(r, c->private_config.first_retry_ms,
                                    c->private_link.round_trip_min_us, &c->private_timer, given_up);
    if (fixed_id != in_fixed_id_mode(r)) {
        forget_override(c);
    }
    return s;
}

roburoc4_result roburoc4_schedule_poll(client *c, uint8_t *buffer, size_t capacity) {
    bool more = true;
    while (more) {
        slot *given_up;
        advance(c);
        slot *s = next_request(c, &given_up);
        if (s != NULL) {
            if (may_send(c, s)) {
                if (s->tries > 1) {
                    count_up(c, ROBUROC4_COUNT_RETRIES);
                }
                return encode_request(c, s, buffer, capacity);
            }
        } else if (given_up != NULL) {
            give_up(c, given_up);
        } else {
            more =
                believe(c) || (roburoc4_requests_has_room(&c->private_requests, 0) && open_next(c));
        }
    }
    return 0;
}
