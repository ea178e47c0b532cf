/* SPDX-License-Identifier: MIT
 *
 * The calls that change something: arm and drive, outputs, a new pose, subscriptions, roles.
 */
#include "bytes.h"
#include "lifecycle.h"

#define OUTPUT_REPEATS 3
/* Two turns; beyond them, an angle is taken for degrees. */
#define MOST_THETA_RAD 12.57

static bool started(const client *c) {
    return c->private_state != ROBUROC4_STATE_IDLE && c->private_state != ROBUROC4_STATE_CLOSING;
}

/* ---- motion ---- */

roburoc4_result roburoc4_client_arm(client *c, uint64_t now_us) {
    if (!started(c)) {
        return ROBUROC4_ERR_NOT_READY;
    }
    /* programs may try again and again, so a refused call wakes nothing unless it disarms */
    roburoc4_lifecycle_see_time(c, now_us);
    if (c->private_drive.armed) {
        wake(c);
    }
    roburoc4_conditions_tick(c);
    const roburoc4_result refusal = roburoc4_conditions_refusal(c, now_us);
    if (refusal >= 0) {
        wake(c);
        roburoc4_drive_arm(&c->private_drive, &c->private_events);
        c->private_conditions.armable = 0; /* the event comes again after disarming */
    }
    return refusal;
}

/** The renewal of an unchanged target makes nothing due; a lease that ended just now does. */
static bool is_due(const drive *d, bool lease_differs) {
    return d->changed || d->stopping || lease_differs;
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
        lease_us = c->private_config.lease_ms * MS;
    }
    if (lease_us < ROBUROC4_MIN_LEASE_US || lease_us > ROBUROC4_MAX_LEASE_US) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    roburoc4_lifecycle_see_time(c, now_us);
    roburoc4_conditions_tick(c);
    const uint32_t lease_before_us = c->private_drive.lease_us;
    const roburoc4_result result = roburoc4_drive_grant(&c->private_drive, target, lease_us,
                                                        c->private_driven_us, (uint32_t)now_us);
    if (is_due(&c->private_drive, lease_us != lease_before_us)) {
        wake(c);
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
        index >= role_capacity(role)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    begin_call(c, now_us);
    c->private_config.role_index[role] = (int16_t)index;
    if (role == ROBUROC4_ROLE_OVERRIDE) {
        roburoc4_conditions_tick(c);
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
        return ROBUROC4_ERR_NOT_KNOWN;
    }
    if (c->private_link.was_lost && expects_statuses(c)) {
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
    c->private_outputs.sent_us = (uint32_t)now_us - SECOND;
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
    if ((bits_from_f64(theta_rad) & INT64_MAX) > bits_from_f64(MOST_THETA_RAD)) {
        return ROBUROC4_ERR_UNITS;
    }
    if (c->private_state != ROBUROC4_STATE_READY) {
        return ROBUROC4_ERR_NOT_READY;
    }
    if ((c->private_discovery.listed & service_bit(ROBUROC4_SERVICE_LOCALIZATION)) == 0) {
        return ROBUROC4_ERR_NOT_KNOWN;
    }
    begin_call(c, now_us);
    roburoc4_requests_cancel(&c->private_requests, ROBUROC4_ACTION_REPLACE,
                             ROBUROC4_SERVICE_LOCALIZATION, (uint32_t)now_us);
    o->x_m = x_m;
    o->y_m = y_m;
    o->theta_rad = theta_rad;
    o->relocalizing = 1;
    o->relocalize_result = ROBUROC4_ERR_NOT_KNOWN;
    o->relocalize_us = (uint32_t)now_us;
    o->moved = 0;
    o->unwatched = 0;
    roburoc4_schedule_watch_pose(c);
    return ROBUROC4_OK;
}

static bool has_status(uint32_t service) {
    return service >= ROBUROC4_SERVICE_IOCARD && service < ROBUROC4_SERVICE_COUNT;
}

roburoc4_result roburoc4_client_subscribe(client *c, uint32_t service, uint32_t period_ms,
                                          uint64_t now_us) {
    if (!has_status(service) || period_ms > 2550 || 10 * cycles_of(period_ms) != period_ms) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    begin_call(c, now_us);
    roburoc4_subscriptions_forget(&c->private_subscriptions, service);
    roburoc4_requests_cancel(&c->private_requests, ROBUROC4_ACTION_INSERT, (uint8_t)service,
                             (uint32_t)now_us);
    roburoc4_requests_cancel(&c->private_requests, ROBUROC4_ACTION_DELETE, (uint8_t)service,
                             (uint32_t)now_us);
    if (period_ms == 0) {
        roburoc4_subscriptions_leave(&c->private_subscriptions, service);
        c->private_config.subscriptions &= ~(uint32_t)service_bit(service);
        return ROBUROC4_OK;
    }
    c->private_config.subscriptions |= service_bit(service);
    c->private_config.period_ms[service] = (uint16_t)period_ms;
    return ROBUROC4_OK;
}
