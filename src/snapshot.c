/* SPDX-License-Identifier: MIT
 *
 * Into the snapshot: the latest properties and statuses of the robot. report.c reads it.
 */
#include "bytes.h"
#include "joined.h"

typedef roburoc4_client client;
typedef roburoc4_private_values values;

/* Bits of battery_low. */
enum { BATTERY_CRITICAL = 1, BATTERY_BELOW_MINIMUM = 2 };

/* ---- properties in ---- */

/** Store a property; another value than before is an event. */
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
    if (result >= 0 && memcmp(c->private_values.io_counts, &p, sizeof(int32_t) * 4) != 0) {
        memcpy(c->private_values.io_counts, &p, sizeof(int32_t) * 4);
        memset(d->described, 0, sizeof(uint64_t) * 4); /* other channels, other texts */
        memset(d->role_texts, 0xFF, sizeof d->role_texts);
        d->done = 0;
        c->private_values.override_known = 0;
        roburoc4_lifecycle_forget_outputs(c); /* they were set for another card */
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
    for (uint32_t i = 0; i < stored; i++) {
        roburoc4_telemeter_at(&list, i, &telemeter);
        store(c, v->telemeters[i], &telemeter, sizeof v->telemeters[i]);
    }
    return result;
}

static roburoc4_result take_battery(client *c, const uint8_t *data, size_t size) {
    roburoc4_battery_properties p;
    const roburoc4_result result = roburoc4_decode_battery_properties(data, size, &p);
    if (result >= 0) {
        store(c, &c->private_values.nominal_voltage_v, &p.nominal_voltage_v, sizeof(float));
        store(c, &c->private_values.capacity_ah, &p.capacity_ah, sizeof(float));
        store(c, &c->private_values.minimum_percent, &p.minimum_percent, 1);
    }
    return result;
}

static void store_pose(uint64_t *bits, const double *x_m, const double *y_m,
                       const double *theta_rad) {
    bits[0] = bits_from_f64(*x_m);
    bits[1] = bits_from_f64(*y_m);
    bits[2] = bits_from_f64(*theta_rad);
}

static roburoc4_result take_localization(client *c, const uint8_t *data, size_t size) {
    roburoc4_localization_properties p;
    const roburoc4_result result = roburoc4_decode_localization_properties(data, size, &p);
    if (result >= 0) {
        uint64_t bits[3];
        store_pose(bits, &p.x_m, &p.y_m, &p.theta_rad);
        store(c, c->private_values.initial_bits, bits, sizeof bits);
        store(c, &c->private_values.initial_flags, &p.flags, sizeof p.flags);
    }
    return result;
}

static roburoc4_result take_differential(client *c, const uint8_t *data, size_t size) {
    roburoc4_differential_properties p;
    const roburoc4_result result = roburoc4_decode_differential_properties(data, size, &p);
    if (result >= 0) {
        float *limits = c->private_values.limits;
        memcpy(limits, &p, 4 * sizeof *limits); /* the speeds of the moment are no property */
        store(c, limits + 4,
              (const uint8_t *)&p + offsetof(roburoc4_differential_properties, max_linear_m_s),
              9 * sizeof *limits);
        roburoc4_drive_service(&c->private_drive, true, p.service);
    }
    return result;
}

roburoc4_result roburoc4_snapshot_properties(client *c, uint32_t service, const uint8_t *data,
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

/* ---- statuses in ---- */

static void take_inputs(client *c, const roburoc4_channels *status) {
    values *v = &c->private_values;
    roburoc4_analog_values(status, v->analog, ROBUROC4_MAX_ANALOG_INPUTS);
    v->digital = roburoc4_digital_values(status); /* ROBUROC4_MAX_DIGITAL_INPUTS of them */
    const roburoc4_result override = index_of_role(c, ROBUROC4_ROLE_OVERRIDE);
    const uint8_t overridden = override >= 0 ? (uint8_t)(v->digital >> override & 1) : 0;
    if (overridden != (v->override_known && v->overridden)) {
        c->private_events |= ROBUROC4_EVENT_OVERRIDE;
    }
    v->override_known = override >= 0;
    v->overridden = overridden;
}

static void take_charge(client *c, const roburoc4_battery_status *status) {
    values *v = &c->private_values;
    const bool known = (c->private_discovery.known & service_bit(ROBUROC4_SERVICE_BATTERY)) != 0;
    const uint8_t critical = status->state == ROBUROC4_BATTERY_CRITICAL ? BATTERY_CRITICAL : 0;
    const uint8_t below =
        known && status->remaining_percent < v->minimum_percent ? BATTERY_BELOW_MINIMUM : 0;
    if ((critical & ~v->battery_low) != 0) {
        raise_event(c, ROBUROC4_EVENT_BATTERY_CRITICAL);
    }
    if ((below & ~v->battery_low) != 0) {
        raise_event(c, ROBUROC4_EVENT_BATTERY_LOW);
    }
    v->battery_low = critical | below;
    v->battery_state = status->state;
    v->battery_percent = status->remaining_percent;
}

static void take_distances(client *c, const roburoc4_telemeter_status *status) {
    values *v = &c->private_values;
    v->distance_count =
        (uint8_t)roburoc4_telemeter_distances(status, v->distances, ROBUROC4_MAX_TELEMETERS);
}

static void take_pose(client *c, const roburoc4_localization_status *status) {
    store_pose(c->private_values.pose_bits, &status->x_m, &status->y_m, &status->theta_rad);
    c->private_values.flags = status->flags;
}

roburoc4_result roburoc4_snapshot_decode(const client *c, uint32_t service, const uint8_t *data,
                                         size_t size, any_status *out) {
    const int32_t *counts = c->private_values.io_counts;
    switch (service) {
    case ROBUROC4_SERVICE_IOCARD:
        return roburoc4_decode_iocard_status(data, size, (uint32_t)counts[ROBUROC4_IO_ANALOG_INPUT],
                                             (uint32_t)counts[ROBUROC4_IO_DIGITAL_INPUT],
                                             &out->iocard);
    case ROBUROC4_SERVICE_TELEMETER:
        return roburoc4_decode_telemeter_status(data, size, &out->telemeter);
    case ROBUROC4_SERVICE_BATTERY:
        return roburoc4_decode_battery_status(data, size, &out->battery);
    case ROBUROC4_SERVICE_LOCALIZATION:
        return roburoc4_decode_localization_status(data, size, &out->localization);
    default:
        return roburoc4_decode_differential_status(data, size, &out->differential);
    }
}

void roburoc4_snapshot_store(client *c, uint32_t service, const any_status *status) {
    switch (service) {
    case ROBUROC4_SERVICE_IOCARD:
        take_inputs(c, &status->iocard);
        break;
    case ROBUROC4_SERVICE_TELEMETER:
        take_distances(c, &status->telemeter);
        break;
    case ROBUROC4_SERVICE_BATTERY:
        take_charge(c, &status->battery);
        break;
    case ROBUROC4_SERVICE_LOCALIZATION:
        take_pose(c, &status->localization);
        break;
    default:
        memcpy(c->private_values.speeds,
               (const uint8_t *)&status->differential +
                   offsetof(roburoc4_differential_status, target_linear_m_s),
               sizeof c->private_values.speeds);
        break;
    }
}
