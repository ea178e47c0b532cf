/* SPDX-License-Identifier: MIT
 *
 * The control calls (arm and drive, outputs, relocalization, subscriptions, roles) and the
 * accessors (services, properties, statuses, facts, statistics of the link).
 */
#include "bytes.h"
#include "internal.h"

#define OUTPUT_REPEATS 3

/* ---- the conditions of driving ---- */

static bool fresh(const client *c, uint32_t service, timer *t) {
    return roburoc4_link_fresh(&c->private_link, STATUS_INDEX(service),
                               c->private_config.fresh_ms * MS, t);
}

/** Whether an input may be the game pad's [A]. Until the services are known, the IO card's
 * properties were read and its texts were requested, there may be one. A configured override input
 * exists unless the card has fewer inputs. */
static bool may_have_pad(const client *c) {
    const discovery *d = &c->private_discovery;
    const bool automatic =
        c->private_config.role_index[ROBUROC4_ROLE_OVERRIDE] == ROBUROC4_INDEX_AUTO;
    if ((d->listed & service_bit(ROBUROC4_SERVICE_IOCARD)) == 0) {
        return !automatic || roburoc4_discovery_doubtful(d, &c->private_config);
    }
    return (d->known & service_bit(ROBUROC4_SERVICE_IOCARD)) == 0 ||
           (automatic && !roburoc4_discovery_inputs_passed(d, c->private_values.io_counts)) ||
           index_of_role(c, ROBUROC4_ROLE_OVERRIDE) >= 0;
}

/** Services that were to be subscribed to, but send nothing. */
static uint8_t missing(const client *c) {
    const discovery *d = &c->private_discovery;
    return d->identified ? (uint8_t)(d->wanted & (~d->listed | d->denied)) : 0;
}

/** Why there is no fresh status of a service: `stale`, unless there is no subscription. A service
 * that is not listed may be one that is not identified yet. */
static roburoc4_result not_fresh(const client *c, uint32_t service, roburoc4_result stale) {
    const discovery *d = &c->private_discovery;
    const bool listed = (d->listed & service_bit(service)) != 0;
    return (missing(c) & service_bit(service)) != 0 &&
                   (listed || !roburoc4_discovery_doubtful(d, &c->private_config))
               ? ROBUROC4_ERR_NOT_SUBSCRIBED
               : stale;
}

/** Why driving is not allowed now, or 0. */
static roburoc4_result refusal(const client *c, timer *t) {
    const roburoc4_private_values *v = &c->private_values;
    const uint32_t options = c->private_config.options;
    if (c->private_state != ROBUROC4_STATE_READY) {
        return ROBUROC4_ERR_NOT_READY;
    }
    if (!c->private_drive.known) {
        return ROBUROC4_ERR_NO_DIFFERENTIAL;
    }
    if (!roburoc4_drive_limits_valid(&v->limits)) {
        return ROBUROC4_ERR_LIMITS;
    }
    if (!fresh(c, ROBUROC4_SERVICE_DIFFERENTIAL, t)) {
        return not_fresh(c, ROBUROC4_SERVICE_DIFFERENTIAL, ROBUROC4_ERR_STALE_DIFFERENTIAL);
    }
    if ((options & ROBUROC4_OPTION_ALLOW_UNKNOWN_OVERRIDE) == 0 || may_have_pad(c)) {
        if (!fresh(c, ROBUROC4_SERVICE_IOCARD, t)) {
            return not_fresh(c, ROBUROC4_SERVICE_IOCARD, ROBUROC4_ERR_STALE_IOCARD);
        }
        if (!v->override_known) {
            return ROBUROC4_ERR_OVERRIDE_UNKNOWN;
        }
    }
    if (v->overridden) {
        return ROBUROC4_ERR_OVERRIDE;
    }
    if (c->private_drive.other_commander &&
        (options & ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER) == 0) {
        return ROBUROC4_ERR_OTHER_COMMANDER;
    }
    return ROBUROC4_OK;
}

/** Why arming is refused, or 0. */
static roburoc4_result arming_refusal(const client *c, uint64_t now_us) {
    timer at = {now_us, UINT64_MAX};
    const roburoc4_result why = refusal(c, &at);
    const drive *d = &c->private_drive;
    return why >= 0 && !d->armed && d->moving ? ROBUROC4_ERR_MOVING : why;
}

int32_t roburoc4_refusal_may_pass(roburoc4_result refusal) {
    return refusal == ROBUROC4_ERR_NOT_READY || refusal == ROBUROC4_ERR_STALE_DIFFERENTIAL ||
           refusal == ROBUROC4_ERR_STALE_IOCARD || refusal == ROBUROC4_ERR_OVERRIDE_UNKNOWN ||
           refusal == ROBUROC4_ERR_MOVING;
}

void roburoc4_control_watch_arming(client *c) {
    const bool armable = !c->private_drive.armed && arming_refusal(c, c->private_timer.now_us) >= 0;
    raise_event(c, armable && !c->private_values.armable ? ROBUROC4_EVENT_ARMABLE : 0);
    c->private_values.armable = armable;
}

void roburoc4_control_tick(client *c) {
    timer *t = &c->private_timer;
    timer unarmed = *t; /* whether its statuses become stale is asked when it is to be armed */
    if (c->private_requests.fixed_id) { /* an answer does not prove when its request arrived */
        roburoc4_drive_heard(&c->private_drive, t->now_us);
    }
    roburoc4_drive_tick(&c->private_drive, &c->private_config,
                        refusal(c, c->private_drive.armed ? t : &unarmed), t, &c->private_events);
    roburoc4_control_watch_arming(c);
}

static bool started(const client *c) {
    return c->private_state != ROBUROC4_STATE_IDLE && c->private_state != ROBUROC4_STATE_CLOSING;
}

/* ---- motion ---- */

roburoc4_result roburoc4_client_arm(client *c, uint64_t now_us) {
    if (!started(c)) {
        return ROBUROC4_ERR_NOT_READY;
    }
    see_time(c, now_us); /* a refused call makes nothing due: programs may try again and again */
    roburoc4_control_tick(c);
    const roburoc4_result refusal = arming_refusal(c, now_us);
    if (refusal >= 0) {
        wake(c);
        roburoc4_drive_arm(&c->private_drive, &c->private_follow, &c->private_events);
        c->private_values.armable = 0; /* the event comes again after disarming */
    }
    return refusal;
}

roburoc4_result roburoc4_client_drive(client *c, float linear_m_s, float angular_rad_s,
                                      uint32_t lease_us, uint64_t now_us) {
    const float target[2] = {linear_m_s, angular_rad_s};
    if (c->private_size != sizeof *c) {
        return ROBUROC4_ERR_STATE;
    }
    if (!is_finite(linear_m_s) || !is_finite(angular_rad_s)) {
        return ROBUROC4_ERR_NOT_FINITE;
    }
    if (!within_f32(linear_m_s, ROBUROC4_MAX_DRIVE_M_S) ||
        !within_f32(angular_rad_s, ROBUROC4_MAX_DRIVE_RAD_S)) {
        return ROBUROC4_ERR_UNITS;
    }
    if (lease_us == 0) {
        lease_us = c->private_config.lease_ms * 1000U;
    }
    if (lease_us < LEASE_MIN_MS * MS || lease_us > LEASE_MAX_MS * MS) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    see_time(c, now_us);
    roburoc4_control_tick(c);
    const uint32_t lease_before_us = c->private_drive.lease_us;
    const roburoc4_result result =
        roburoc4_drive_grant(&c->private_drive, target, lease_us, now_us);
    if (c->private_drive.changed || lease_us != lease_before_us) {
        wake(c); /* a lease that is only renewed makes nothing due */
    }
    if (c->private_outputs.relocalizing) {
        roburoc4_schedule_watch_pose(c);
    }
    return result;
}

roburoc4_result roburoc4_client_pause(client *c, uint64_t now_us) {
    if (!started(c)) {
        return ROBUROC4_ERR_STATE;
    }
    begin_call(c, now_us);
    roburoc4_drive_pause(&c->private_drive);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_stop(client *c, uint64_t now_us) {
    if (!started(c)) {
        return ROBUROC4_ERR_STATE;
    }
    begin_call(c, now_us);
    roburoc4_drive_stop(&c->private_drive, &c->private_events);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_set_role_index(client *c, uint32_t role, int32_t index,
                                               uint64_t now_us) {
    if (role >= ROBUROC4_ROLE_COUNT || index < ROBUROC4_INDEX_AUTO ||
        index >= roburoc4_role_capacity(role)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    begin_call(c, now_us);
    c->private_config.role_index[role] = (int16_t)index;
    if (role == ROBUROC4_ROLE_OVERRIDE) {
        c->private_drive.overridden = 0; /* of another input */
        roburoc4_control_tick(c);
        forget_override(c);
        roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_OVERRIDE_UNKNOWN);
    }
    return ROBUROC4_OK;
}

/* ---- outputs ---- */

/** Why outputs cannot be set now, or how many there are. */
static roburoc4_result output_count(const client *c, uint32_t io_type, int32_t capacity) {
    const int32_t *counts = c->private_values.io_counts;
    if (!started(c) || c->private_state != ROBUROC4_STATE_READY) {
        return ROBUROC4_ERR_NOT_READY;
    }
    if ((c->private_discovery.known & service_bit(ROBUROC4_SERVICE_IOCARD)) == 0) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    if (c->private_link.resubscribed && c->private_discovery.acked != 0) {
        return ROBUROC4_ERR_NOT_READY; /* it may have restarted: its first status tells */
    }
    /* a command carries all outputs, so a card with more than fit cannot be commanded */
    if (counts[ROBUROC4_IO_ANALOG_OUTPUT] > ROBUROC4_MAX_ANALOG_OUTPUTS ||
        counts[ROBUROC4_IO_DIGITAL_OUTPUT] > ROBUROC4_MAX_DIGITAL_OUTPUTS) {
        return ROBUROC4_ERR_INDEX;
    }
    return counts[io_type] < capacity ? counts[io_type] : capacity;
}

static void send_outputs(client *c, uint64_t now_us) {
    begin_call(c, now_us);
    c->private_outputs.repeats = OUTPUT_REPEATS;
    c->private_outputs.sent_us = now_us - SECOND;
}

roburoc4_result roburoc4_client_set_digital_outputs(client *c, uint64_t mask, uint64_t values,
                                                    uint64_t now_us) {
    const roburoc4_result count =
        output_count(c, ROBUROC4_IO_DIGITAL_OUTPUT, ROBUROC4_MAX_DIGITAL_OUTPUTS);
    if (count < 0) {
        return count;
    }
    if ((mask & 1) != 0) {
        return ROBUROC4_ERR_RESERVED;
    }
    if (count < 64 && mask >> count != 0) {
        return ROBUROC4_ERR_INDEX;
    }
    c->private_outputs.digital = (c->private_outputs.digital & ~mask) | (values & mask);
    send_outputs(c, now_us);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_set_analog_output(client *c, uint32_t index, float value,
                                                  uint64_t now_us) {
    const roburoc4_result count =
        output_count(c, ROBUROC4_IO_ANALOG_OUTPUT, ROBUROC4_MAX_ANALOG_OUTPUTS);
    if (!is_finite(value)) {
        return ROBUROC4_ERR_NOT_FINITE;
    }
    if (count < 0) {
        return count;
    }
    if (index >= (uint32_t)count) {
        return ROBUROC4_ERR_INDEX;
    }
    c->private_outputs.analog[index] = value;
    send_outputs(c, now_us);
    return ROBUROC4_OK;
}

/* ---- localization and subscriptions ---- */

static bool finite_f64(double value) {
    return finite_f64_bits(bits_from_f64(value));
}

roburoc4_result roburoc4_client_relocalize(client *c, double x_m, double y_m, double theta_rad,
                                           uint64_t now_us) {
    roburoc4_private_outputs *o = &c->private_outputs;
    if (!finite_f64(x_m) || !finite_f64(y_m) || !finite_f64(theta_rad)) {
        return ROBUROC4_ERR_NOT_FINITE;
    }
    if (c->private_state != ROBUROC4_STATE_READY) {
        return ROBUROC4_ERR_NOT_READY;
    }
    if ((c->private_discovery.listed & service_bit(ROBUROC4_SERVICE_LOCALIZATION)) == 0) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    begin_call(c, now_us);
    roburoc4_requests_cancel(&c->private_requests, ROBUROC4_ACTION_REPLACE,
                             ROBUROC4_SERVICE_LOCALIZATION);
    o->x_m = x_m;
    o->y_m = y_m;
    o->theta_rad = theta_rad;
    o->relocalizing = 1;
    o->relocalize_result = ROBUROC4_ERR_UNKNOWN;
    o->relocalize_us = now_us;
    o->moved = 0;
    o->unwatched = 0;
    roburoc4_schedule_watch_pose(c);
    return ROBUROC4_OK;
}

static bool has_status(uint32_t service) {
    return service >= ROBUROC4_SERVICE_IOCARD && service < ROBUROC4_SERVICE_COUNT;
}

/** Forget what the robot answered about this subscription. */
static void forget_subscription(client *c, uint32_t service) {
    discovery *d = &c->private_discovery;
    const uint8_t others = (uint8_t)~service_bit(service);
    d->acked &= others;
    d->declined &= others;
    d->denied &= others;
    d->leaving &= others;
    roburoc4_requests_cancel(&c->private_requests, ROBUROC4_ACTION_INSERT, (uint8_t)service);
    roburoc4_requests_cancel(&c->private_requests, ROBUROC4_ACTION_DELETE, (uint8_t)service);
}

static void unsubscribe(client *c, uint32_t service) {
    discovery *d = &c->private_discovery;
    if ((d->inserted & service_bit(service)) != 0) {
        d->leaving |= service_bit(service);
    }
    d->inserted &= (uint8_t)~service_bit(service);
    d->wanted &= (uint8_t)~service_bit(service);
    c->private_config.subscriptions &= ~(uint32_t)service_bit(service);
}

roburoc4_result roburoc4_client_subscribe(client *c, uint32_t service, uint32_t period_ms,
                                          uint64_t now_us) {
    if (!has_status(service) || period_ms > 2550 || period_ms % 10 != 0) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    begin_call(c, now_us);
    forget_subscription(c, service);
    if (period_ms == 0) {
        unsubscribe(c, service);
        return ROBUROC4_OK;
    }
    c->private_discovery.wanted |= service_bit(service);
    c->private_config.subscriptions |= service_bit(service);
    c->private_config.period_ms[service] = (uint16_t)period_ms;
    c->private_link.services[STATUS_INDEX(service)].asked_cycles = (uint8_t)(period_ms / 10);
    return ROBUROC4_OK;
}

/* ---- services and properties ---- */

static bool knows(const client *c, uint32_t service) {
    return (c->private_discovery.known & service_bit(service)) != 0;
}

static uint16_t id_of(const client *c, uint32_t service) {
    return c->private_discovery.service_ids[service];
}

roburoc4_result roburoc4_client_service_at(const client *c, uint32_t index,
                                           roburoc4_directory_entry *out) {
    if (index >= c->private_discovery.service_count) {
        return ROBUROC4_ERR_INDEX;
    }
    out->type = c->private_discovery.types[index];
    out->id = c->private_discovery.ids[index];
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_service_id(const client *c, uint32_t service) {
    if (service <= ROBUROC4_SERVICE_NOTIFICATION) {
        return (roburoc4_result)service;
    }
    if (service >= ROBUROC4_SERVICE_COUNT ||
        (c->private_discovery.listed & service_bit(service)) == 0) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    return id_of(c, service);
}

roburoc4_result roburoc4_client_iocard_properties(const client *c,
                                                  roburoc4_iocard_properties *out) {
    const int32_t *counts = c->private_values.io_counts;
    if (!knows(c, ROBUROC4_SERVICE_IOCARD)) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    out->analog_inputs = counts[ROBUROC4_IO_ANALOG_INPUT];
    out->analog_outputs = counts[ROBUROC4_IO_ANALOG_OUTPUT];
    out->digital_inputs = counts[ROBUROC4_IO_DIGITAL_INPUT];
    out->digital_outputs = counts[ROBUROC4_IO_DIGITAL_OUTPUT];
    out->service = id_of(c, ROBUROC4_SERVICE_IOCARD);
    out->reserved = 0;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_battery_properties(const client *c,
                                                   roburoc4_battery_properties *out) {
    if (!knows(c, ROBUROC4_SERVICE_BATTERY)) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    *out = c->private_values.battery_properties;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_localization_properties(const client *c,
                                                        roburoc4_localization_properties *out) {
    if (!knows(c, ROBUROC4_SERVICE_LOCALIZATION)) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    *out = c->private_values.initial;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_differential_properties(const client *c,
                                                        roburoc4_differential_properties *out) {
    if (!knows(c, ROBUROC4_SERVICE_DIFFERENTIAL)) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    *out = c->private_values.limits;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_telemeter(const client *c, uint32_t index,
                                          roburoc4_telemeter *out) {
    if (index >= c->private_values.telemeter_count) {
        return ROBUROC4_ERR_INDEX;
    }
    memcpy(out, c->private_values.telemeters[index], sizeof c->private_values.telemeters[index]);
    out->distance_m = c->private_values.distances[index];
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_role_index(const client *c, uint32_t role) {
    if (role >= ROBUROC4_ROLE_COUNT) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    return index_of_role(c, role);
}

roburoc4_result roburoc4_client_description(const client *c, const uint8_t *datagram, size_t size,
                                            roburoc4_description *out) {
    roburoc4_text text;
    const uint32_t kind = c->private_discovery.described_kind;
    if (kind == 0 || roburoc4_decode_text(datagram, size, &text) < 0) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    out->text = text.text;
    out->length = text.length;
    out->io_type = kind - 1 == LIST_DIRECTORY ? -1 : (int32_t)(kind - 1);
    out->index = c->private_discovery.described_index;
    return ROBUROC4_OK;
}

/* ---- statuses ---- */

/** The service's link statistics, or NULL before its first status; *host_us is when the latest
 * arrived. */
static const roburoc4_private_service *latest(const client *c, uint32_t service,
                                              uint64_t *host_us) {
    const roburoc4_private_service *s = &c->private_link.services[STATUS_INDEX(service)];
    if (s->received > 0 && host_us != NULL) {
        *host_us = s->received_us;
    }
    return s->received > 0 ? s : NULL;
}

roburoc4_result roburoc4_client_battery(const client *c, roburoc4_battery_status *out,
                                        uint64_t *host_us) {
    if (latest(c, ROBUROC4_SERVICE_BATTERY, host_us) == NULL) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    *out = c->private_values.battery;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_localization(const client *c, roburoc4_localization_status *out,
                                             uint64_t *host_us) {
    if (latest(c, ROBUROC4_SERVICE_LOCALIZATION, host_us) == NULL) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    *out = c->private_values.localization;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_differential(const client *c, roburoc4_differential_status *out,
                                             uint64_t *host_us) {
    if (latest(c, ROBUROC4_SERVICE_DIFFERENTIAL, host_us) == NULL) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    *out = c->private_values.differential;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_inputs(const client *c, roburoc4_inputs *out, uint64_t *host_us) {
    const int32_t *counts = c->private_values.io_counts;
    const roburoc4_private_service *s = latest(c, ROBUROC4_SERVICE_IOCARD, host_us);
    if (s == NULL) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    out->robot_cycles = s->robot_cycles;
    out->digital = c->private_values.digital;
    memcpy(out->analog, c->private_values.analog, sizeof out->analog);
    out->analog_count =
        at_most((uint32_t)counts[ROBUROC4_IO_ANALOG_INPUT], ROBUROC4_MAX_ANALOG_INPUTS);
    out->digital_count =
        at_most((uint32_t)counts[ROBUROC4_IO_DIGITAL_INPUT], ROBUROC4_MAX_DIGITAL_INPUTS);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_distances(const client *c, roburoc4_distances *out,
                                          uint64_t *host_us) {
    const roburoc4_private_service *s = latest(c, ROBUROC4_SERVICE_TELEMETER, host_us);
    if (s == NULL) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    out->robot_cycles = s->robot_cycles;
    memcpy(out->distances_m, c->private_values.distances, sizeof out->distances_m);
    out->count = c->private_values.distance_count;
    out->reserved = 0;
    return ROBUROC4_OK;
}

/* ---- facts and statistics ---- */

/** Whether a bumper is pressed, by any of its inputs, and whether that is known. */
static uint8_t bumper(const client *c, uint32_t role, uint8_t *known) {
    bool certain;
    const uint64_t inputs = roburoc4_discovery_bumper(&c->private_discovery, &c->private_config,
                                                      c->private_values.io_counts, role, &certain);
    *known = certain && c->private_link.services[STATUS_INDEX(ROBUROC4_SERVICE_IOCARD)].fresh;
    return (c->private_values.digital & inputs) != 0;
}

static uint32_t clipped(uint64_t span_us) {
    return span_us < UINT32_MAX ? (uint32_t)span_us : UINT32_MAX;
}

/** Copy a struct that begins with its size to a program that may know fewer of its members. */
static roburoc4_result give(void *out, const void *filled, uint32_t filled_size) {
    uint32_t size;
    memcpy(&size, out, sizeof size);
    if (!size_known(size, filled_size)) {
        return ROBUROC4_ERR_SIZE;
    }
    memcpy((uint8_t *)out + sizeof size, (const uint8_t *)filled + sizeof size, size - sizeof size);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_facts(const client *c, uint64_t now_us, roburoc4_facts *out) {
    roburoc4_facts f;
    const drive *d = &c->private_drive;
    const values *v = &c->private_values;
    const uint64_t elapsed_us = now_us - d->granted_us;
    f.state = c->private_state;
    f.armed = d->armed;
    f.driving = d->lease_active && elapsed_us < d->lease_us;
    f.stopping = d->stopping || d->stop_pending;
    f.override_known = v->override_known;
    f.overridden = v->overridden;
    f.other_commander = d->other_commander;
    f.inhibited = d->inhibited;
    f.fixed_id = c->private_requests.fixed_id;
    f.front_bumper = bumper(c, ROBUROC4_ROLE_FRONT_BUMPER, &f.front_bumper_known);
    f.rear_bumper = bumper(c, ROBUROC4_ROLE_REAR_BUMPER, &f.rear_bumper_known);
    f.descriptions_done = c->private_discovery.done;
    f.battery_low = v->battery_low != 0;
    f.disarm_cause = d->armed ? ROBUROC4_OK : d->disarm_cause;
    f.arm_refusal = arming_refusal(c, now_us);
    f.relocalize_result = c->private_outputs.relocalize_result;
    f.lease_left_us = f.driving ? d->lease_us - (uint32_t)elapsed_us : 0;
    f.sent_linear_m_s = d->sent[0];
    f.sent_angular_rad_s = d->sent[1];
    f.lapsed = d->lapsed || (d->lease_active && !f.driving);
    f.stop_outcome = f.stopping ? ROBUROC4_STOP_RUNNING : d->outcome;
    f.battery_known = c->private_link.services[STATUS_INDEX(ROBUROC4_SERVICE_BATTERY)].fresh;
    f.missing = missing(c);
    memset(f.reserved, 0, sizeof f.reserved);
    for (uint32_t service = 0; service < ROBUROC4_SERVICE_COUNT + 1; service++) {
        f.age_us[service] = UINT32_MAX;
    }
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        if (c->private_link.services[i].fresh) {
            f.age_us[i + ROBUROC4_SERVICE_IOCARD] =
                clipped(roburoc4_link_age(&c->private_link, i, now_us));
        }
    }
    return give(out, &f, sizeof f);
}

static float share(uint32_t lost, uint32_t all) {
    return lost > 0 ? (float)lost / (float)all : 0;
}

roburoc4_result roburoc4_client_link(const client *c, uint64_t now_us, roburoc4_link *out) {
    roburoc4_link f;
    const roburoc4_private_link *l = &c->private_link;
    uint32_t recent_lost = 0;
    uint32_t recent = 0;
    f.round_trip_us = l->round_trip_us;
    f.round_trip_min_us = l->round_trip_min_us;
    f.silence_us = clipped(now_us - l->last_used_us);
    f.received = 0;
    f.lost = 0;
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        f.received += l->services[i].received;
        f.lost += l->services[i].lost;
        recent += l->services[i].recent;
        recent_lost += l->services[i].recent_lost;
    }
    f.loss = share(recent_lost, recent);
    f.reserved = 0;
    return give(out, &f, sizeof f);
}

roburoc4_result roburoc4_client_service_link(const client *c, uint32_t service, uint64_t now_us,
                                             roburoc4_service_link *out) {
    roburoc4_service_link f;
    if (service < ROBUROC4_SERVICE_IOCARD || service >= ROBUROC4_SERVICE_COUNT) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    const roburoc4_private_service *s = &c->private_link.services[STATUS_INDEX(service)];
    const discovery *d = &c->private_discovery;
    f.subscribed = (d->wanted & ~d->denied & service_bit(service)) != 0;
    f.received = s->received;
    f.lost = s->lost;
    f.late = s->late;
    f.duplicates = s->duplicates;
    f.period_us = (uint32_t)s->period_cycles * ROBUROC4_CYCLE_US;
    f.jitter_us = s->jitter_us;
    f.age_us = s->received > 0
                   ? clipped(roburoc4_link_age(&c->private_link, STATUS_INDEX(service), now_us))
                   : UINT32_MAX;
    f.loss = share(s->recent_lost, s->recent);
    return give(out, &f, sizeof f);
}

roburoc4_result roburoc4_client_host_time(const client *c, uint64_t robot_cycles,
                                          uint64_t *host_us) {
    const roburoc4_private_link *l = &c->private_link;
    if (!l->mapped) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    const int64_t offset_us =
        l->offset_us < l->offset_before_us ? l->offset_us : l->offset_before_us;
    *host_us = robot_cycles * ROBUROC4_CYCLE_US + (uint64_t)offset_us - l->round_trip_min_us / 2;
    return ROBUROC4_OK;
}

uint32_t roburoc4_client_count(const client *c, uint32_t counter) {
    return counter < ROBUROC4_COUNTERS ? c->private_counters[counter] : 0;
}
