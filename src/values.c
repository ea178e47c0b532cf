/* SPDX-License-Identifier: MIT
 *
 * The calls that read: services, properties, statuses, facts, statistics of the link.
 */
#include "bytes.h"
#include "internal.h"

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
        return ROBUROC4_ERR_NOT_KNOWN;
    }
    return id_of(c, service);
}

roburoc4_result roburoc4_client_iocard_properties(const client *c,
                                                  roburoc4_iocard_properties *out) {
    const int32_t *counts = c->private_values.io_counts;
    if (!knows(c, ROBUROC4_SERVICE_IOCARD)) {
        return ROBUROC4_ERR_NOT_KNOWN;
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
        return ROBUROC4_ERR_NOT_KNOWN;
    }
    *out = c->private_values.battery_properties;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_localization_properties(const client *c,
                                                        roburoc4_localization_properties *out) {
    if (!knows(c, ROBUROC4_SERVICE_LOCALIZATION)) {
        return ROBUROC4_ERR_NOT_KNOWN;
    }
    *out = c->private_values.localization_properties;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_differential_properties(const client *c,
                                                        roburoc4_differential_properties *out) {
    if (!knows(c, ROBUROC4_SERVICE_DIFFERENTIAL)) {
        return ROBUROC4_ERR_NOT_KNOWN;
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
    out->distance_m = index < c->private_values.distance_count ? c->private_values.distances[index]
                                                               : f32_from_bits(F32_NAN);
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
        return ROBUROC4_ERR_NOT_KNOWN;
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
        return ROBUROC4_ERR_NOT_KNOWN;
    }
    *out = c->private_values.battery;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_localization(const client *c, roburoc4_localization_status *out,
                                             uint64_t *host_us) {
    if (latest(c, ROBUROC4_SERVICE_LOCALIZATION, host_us) == NULL) {
        return ROBUROC4_ERR_NOT_KNOWN;
    }
    *out = c->private_values.localization;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_differential(const client *c, roburoc4_differential_status *out,
                                             uint64_t *host_us) {
    if (latest(c, ROBUROC4_SERVICE_DIFFERENTIAL, host_us) == NULL) {
        return ROBUROC4_ERR_NOT_KNOWN;
    }
    *out = c->private_values.differential;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_inputs(const client *c, roburoc4_inputs *out, uint64_t *host_us) {
    const int32_t *counts = c->private_values.io_counts;
    const roburoc4_private_service *s = latest(c, ROBUROC4_SERVICE_IOCARD, host_us);
    if (s == NULL) {
        return ROBUROC4_ERR_NOT_KNOWN;
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
        return ROBUROC4_ERR_NOT_KNOWN;
    }
    out->robot_cycles = s->robot_cycles;
    memcpy(out->distances_m, c->private_values.distances, sizeof out->distances_m);
    out->count = c->private_values.distance_count;
    const bool known = (c->private_discovery.known & service_bit(ROBUROC4_SERVICE_TELEMETER)) != 0;
    if ((known || c->private_values.telemeter_count != 0) && /* or they were, before it was lost */
        out->count > c->private_values.telemeter_count) {
        out->count = c->private_values.telemeter_count; /* the others are surplus bytes */
    }
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

/** How long before now_us, which may be later than the last call, something was. */
static uint64_t passed_us(const client *c, uint32_t since_us, uint64_t now_us) {
    return now_us - c->private_now_us + (c->private_timer.now_us - since_us);
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

/** A status came after the minimum was known, or said that the charge is critical. */
static bool battery_known(const client *c) {
    return c->private_link.services[STATUS_INDEX(ROBUROC4_SERVICE_BATTERY)].fresh &&
           c->private_values.battery_low != 0;
}

roburoc4_result roburoc4_client_facts(const client *c, uint64_t now_us, roburoc4_facts *out) {
    roburoc4_facts f;
    const drive *d = &c->private_drive;
    const values *v = &c->private_values;
    const uint64_t elapsed_us = passed_us(c, d->granted_us, now_us);
    f.state = c->private_state;
    f.armed = d->armed;
    f.driving = d->lease_active && elapsed_us < d->lease_us;
    f.stopping = d->stopping || d->stop_pending;
    f.override_known = c->private_conditions.override_known;
    f.overridden = c->private_conditions.overridden;
    f.other_commander = d->other_commander;
    f.inhibited = d->inhibited;
    f.fixed_id = in_fixed_id_mode(&c->private_requests);
    f.front_bumper = bumper(c, ROBUROC4_ROLE_FRONT_BUMPER, &f.front_bumper_known);
    f.rear_bumper = bumper(c, ROBUROC4_ROLE_REAR_BUMPER, &f.rear_bumper_known);
    f.descriptions_done = c->private_discovery.texts_done;
    f.battery_low = (v->battery_low & BATTERY_LOW) != 0;
    f.disarm_cause = d->armed ? ROBUROC4_OK : d->disarm_cause;
    f.arm_refusal = roburoc4_conditions_refusal(c, now_us);
    f.relocalize_result = c->private_outputs.relocalize_result;
    f.lease_left_us = f.driving ? d->lease_us - (uint32_t)elapsed_us : 0;
    f.sent_linear_m_s = d->sent[0];
    f.sent_angular_rad_s = d->sent[1];
    f.lapsed = d->lapsed || (d->lease_active && !f.driving);
    f.stop_outcome = f.stopping ? ROBUROC4_STOP_RUNNING : d->outcome;
    f.battery_known = battery_known(c);
    f.missing = roburoc4_subscriptions_missing(&c->private_subscriptions, &c->private_config,
                                               &c->private_discovery);
    memset(f.reserved, 0, sizeof f.reserved);
    for (uint32_t service = 0; service < ROBUROC4_SERVICE_COUNT + 1; service++) {
        f.age_us[service] = UINT32_MAX;
    }
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        if (c->private_link.services[i].fresh) {
            f.age_us[i + ROBUROC4_SERVICE_IOCARD] = roburoc4_link_age(&c->private_link, i, now_us);
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
    f.silence_us = clipped(passed_us(c, l->last_used_us, now_us));
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
    f.subscribed = (c->private_config.subscriptions & ~(uint32_t)c->private_subscriptions.denied &
                    service_bit(service)) != 0;
    f.received = s->received;
    f.lost = s->lost;
    f.late = s->late;
    f.duplicates = s->duplicates;
    f.period_us = (uint32_t)s->period_cycles * ROBUROC4_CYCLE_US;
    f.jitter_us = s->jitter_us;
    f.age_us = s->received > 0 ? roburoc4_link_age(&c->private_link, STATUS_INDEX(service), now_us)
                               : UINT32_MAX;
    f.loss = share(s->recent_lost, s->recent);
    return give(out, &f, sizeof f);
}

roburoc4_result roburoc4_client_host_time(const client *c, uint64_t robot_cycles,
                                          uint64_t *host_us) {
    const roburoc4_private_link *l = &c->private_link;
    if (!l->mapped) {
        return ROBUROC4_ERR_NOT_KNOWN;
    }
    const int64_t offset_us =
        l->offset_us < l->offset_before_us ? l->offset_us : l->offset_before_us;
    *host_us = robot_cycles * ROBUROC4_CYCLE_US + (uint64_t)offset_us - l->round_trip_min_us / 2;
    return ROBUROC4_OK;
}

uint32_t roburoc4_client_count(const client *c, uint32_t counter) {
    return counter < ROBUROC4_COUNTERS ? c->private_counters[counter] : 0;
}
