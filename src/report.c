/* SPDX-License-Identifier: MIT
 *
 * What a user reads of a client: services, properties, statuses, facts, figures of the link.
 */
#include "bytes.h"
#include "joined.h"

typedef roburoc4_client client;
typedef roburoc4_private_values values;

static void load_pose(const uint64_t *bits, double *x_m, double *y_m, double *theta_rad) {
    *x_m = f64_from_bits(bits[0]);
    *y_m = f64_from_bits(bits[1]);
    *theta_rad = f64_from_bits(bits[2]);
}

/* ---- services and properties ---- */

static bool knows(const client *c, uint32_t service) {
    return (c->private_discovery.known & service_bit(service)) != 0;
}

static uint16_t id_of(const client *c, uint32_t service) {
    return c->private_discovery.service_ids[service];
}

uint32_t roburoc4_client_service_count(const client *c) {
    return c->private_discovery.service_count;
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
    if (!knows(c, ROBUROC4_SERVICE_IOCARD)) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    memcpy(out, c->private_values.io_counts, sizeof c->private_values.io_counts);
    out->service = id_of(c, ROBUROC4_SERVICE_IOCARD);
    out->reserved = 0;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_battery_properties(const client *c,
                                                   roburoc4_battery_properties *out) {
    if (!knows(c, ROBUROC4_SERVICE_BATTERY)) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    out->nominal_voltage_v = c->private_values.nominal_voltage_v;
    out->capacity_ah = c->private_values.capacity_ah;
    out->minimum_percent = c->private_values.minimum_percent;
    out->reserved = 0;
    out->service = id_of(c, ROBUROC4_SERVICE_BATTERY);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_localization_properties(const client *c,
                                                        roburoc4_localization_properties *out) {
    if (!knows(c, ROBUROC4_SERVICE_LOCALIZATION)) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    load_pose(c->private_values.initial_bits, &out->x_m, &out->y_m, &out->theta_rad);
    out->flags = c->private_values.initial_flags;
    out->service = id_of(c, ROBUROC4_SERVICE_LOCALIZATION);
    out->reserved = 0;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_differential_properties(const client *c,
                                                        roburoc4_differential_properties *out) {
    if (!knows(c, ROBUROC4_SERVICE_DIFFERENTIAL)) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    memcpy(out, c->private_values.limits, sizeof c->private_values.limits);
    out->service = id_of(c, ROBUROC4_SERVICE_DIFFERENTIAL);
    out->reserved = 0;
    return ROBUROC4_OK;
}

uint32_t roburoc4_client_telemeter_count(const client *c) {
    return c->private_values.telemeter_count;
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

/** Begin a copy of a service's latest status: all zero but its time, which stands first in every
 *  status. False before the first. */
static bool begin(const client *c, uint32_t service, void *out, size_t size, uint64_t *host_us) {
    const roburoc4_private_service *s = &c->private_link.services[STATUS_INDEX(service)];
    if (s->received == 0) {
        return false;
    }
    if (host_us != NULL) {
        *host_us = s->received_us;
    }
    memset(out, 0, size);
    memcpy(out, &s->robot_cycles, sizeof s->robot_cycles);
    return true;
}

roburoc4_result roburoc4_client_battery(const client *c, roburoc4_battery_status *out,
                                        uint64_t *host_us) {
    if (!begin(c, ROBUROC4_SERVICE_BATTERY, out, sizeof *out, host_us)) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    out->state = c->private_values.battery_state;
    out->remaining_percent = c->private_values.battery_percent;
    out->service = id_of(c, ROBUROC4_SERVICE_BATTERY);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_localization(const client *c, roburoc4_localization_status *out,
                                             uint64_t *host_us) {
    if (!begin(c, ROBUROC4_SERVICE_LOCALIZATION, out, sizeof *out, host_us)) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    load_pose(c->private_values.pose_bits, &out->x_m, &out->y_m, &out->theta_rad);
    out->flags = c->private_values.flags;
    out->service = id_of(c, ROBUROC4_SERVICE_LOCALIZATION);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_differential(const client *c, roburoc4_differential_status *out,
                                             uint64_t *host_us) {
    if (!begin(c, ROBUROC4_SERVICE_DIFFERENTIAL, out, sizeof *out, host_us)) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    memcpy((uint8_t *)out + offsetof(roburoc4_differential_status, target_linear_m_s),
           c->private_values.speeds, sizeof c->private_values.speeds);
    out->service = id_of(c, ROBUROC4_SERVICE_DIFFERENTIAL);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_inputs(const client *c, roburoc4_inputs *out, uint64_t *host_us) {
    const int32_t *counts = c->private_values.io_counts;
    if (!begin(c, ROBUROC4_SERVICE_IOCARD, out, sizeof *out, host_us)) {
        return ROBUROC4_ERR_UNKNOWN;
    }
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
    if (!begin(c, ROBUROC4_SERVICE_TELEMETER, out, sizeof *out, host_us)) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    memcpy(out->distance_m, c->private_values.distances, sizeof out->distance_m);
    out->count = c->private_values.distance_count;
    return ROBUROC4_OK;
}

/* ---- facts and figures ---- */

static uint8_t input_of_role(const client *c, uint32_t role) {
    const roburoc4_result index = index_of_role(c, role);
    return index >= 0 ? (uint8_t)(c->private_values.digital >> index & 1) : 0;
}

static uint32_t clipped(uint64_t span_us) {
    return span_us < UINT32_MAX ? (uint32_t)span_us : UINT32_MAX;
}

roburoc4_result roburoc4_client_facts(const client *c, uint64_t now_us, roburoc4_facts *out) {
    const drive *d = &c->private_drive;
    const values *v = &c->private_values;
    const uint64_t elapsed_us = now_us - d->granted_us;
    if (out->size != sizeof *out) {
        return ROBUROC4_ERR_SIZE;
    }
    out->state = c->private_state;
    out->armed = d->armed;
    out->driving = d->leased && elapsed_us < d->lease_us;
    out->stopping = d->train || d->stop_latched;
    out->override_known = v->override_known;
    out->overridden = v->override_known && v->overridden;
    out->other_commander = d->other_commander;
    out->inhibited = d->inhibited;
    out->fixed_id = c->private_requests.fixed_id;
    out->front_bumper = input_of_role(c, ROBUROC4_ROLE_FRONT_BUMPER);
    out->rear_bumper = input_of_role(c, ROBUROC4_ROLE_REAR_BUMPER);
    out->descriptions_done = c->private_discovery.done;
    out->battery_low = v->battery_low != 0;
    out->disarm_cause = d->armed ? ROBUROC4_OK : d->disarm_cause;
    out->arm_refusal = roburoc4_arming_refusal(c, now_us);
    out->relocalize_result = c->private_outputs.relocalize_result;
    out->lease_left_us = out->driving ? d->lease_us - (uint32_t)elapsed_us : 0;
    out->linear_m_s = d->sent[0];
    out->angular_rad_s = d->sent[1];
    return ROBUROC4_OK;
}

static float share(uint32_t lost, uint32_t received) {
    return lost > 0 ? (float)lost / (float)(lost + received) : 0;
}

roburoc4_result roburoc4_client_link(const client *c, uint64_t now_us, roburoc4_link *out) {
    const roburoc4_private_link *l = &c->private_link;
    uint32_t recent_lost = 0;
    uint32_t recent_received = 0;
    if (out->size != sizeof *out) {
        return ROBUROC4_ERR_SIZE;
    }
    out->round_trip_us = l->round_trip_us;
    out->round_trip_min_us = l->round_trip_min_us;
    out->silence_us = clipped(now_us - l->last_used_us);
    out->received = 0;
    out->lost = 0;
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        out->received += l->services[i].received;
        out->lost += l->services[i].lost;
        recent_received += l->services[i].recent_received;
        recent_lost += l->services[i].recent_lost;
    }
    out->loss = share(recent_lost, recent_received);
    out->reserved = 0;
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_service_link(const client *c, uint32_t service, uint64_t now_us,
                                             roburoc4_service_link *out) {
    if (service < ROBUROC4_SERVICE_IOCARD || service >= ROBUROC4_SERVICE_COUNT) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    if (out->size != sizeof *out) {
        return ROBUROC4_ERR_SIZE;
    }
    const roburoc4_private_service *s = &c->private_link.services[STATUS_INDEX(service)];
    const discovery *d = &c->private_discovery;
    out->subscribed = (d->wanted & ~d->declined & service_bit(service)) != 0;
    out->received = s->received;
    out->lost = s->lost;
    out->late = s->late;
    out->duplicates = s->duplicates;
    out->period_us = (uint32_t)s->period_cycles * ROBUROC4_CYCLE_US;
    out->jitter_us = s->jitter_us;
    out->age_us = s->received > 0 ? clipped(now_us - s->received_us) : UINT32_MAX;
    out->loss = share(s->recent_lost, s->recent_received);
    return ROBUROC4_OK;
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
