/* SPDX-License-Identifier: MIT
 *
 * What a user asks of a client: arm and drive, outputs, relocalization, subscriptions, roles.
 */
#include "bytes.h"
#include "joined.h"

typedef roburoc4_client client;

#define LEASE_MIN_US (20 * MS)
#define LEASE_MAX_US SECOND
#define OUTPUT_REPEATS 3

static bool started(const client *c) {
    return c->private_state != ROBUROC4_STATE_IDLE && c->private_state != ROBUROC4_STATE_CLOSING;
}

/* ---- motion ---- */

roburoc4_result roburoc4_client_arm(client *c, uint64_t now_us) {
    if (!started(c)) {
        return ROBUROC4_ERR_NOT_READY;
    }
    roburoc4_lifecycle_clock(c, now_us);
    roburoc4_arming_tick(c);
    const roburoc4_result refusal = roburoc4_arming_refusal(c, now_us);
    if (refusal >= 0) {
        roburoc4_drive_arm(&c->private_drive, &c->private_events);
    }
    return refusal;
}

roburoc4_result roburoc4_client_disarm(client *c, uint64_t now_us) {
    roburoc4_lifecycle_clock(c, now_us);
    roburoc4_lifecycle_interrupt(c, ROBUROC4_ERR_DISARMED);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_drive(client *c, float linear_m_s, float angular_rad_s,
                                      uint32_t lease_us, uint64_t now_us) {
    const float target[2] = {linear_m_s, angular_rad_s};
    if (c->private_size != sizeof *c) {
        return ROBUROC4_ERR_STATE;
    }
    if (!finite_f32_bits(bits_from_f32(linear_m_s)) ||
        !finite_f32_bits(bits_from_f32(angular_rad_s))) {
        return ROBUROC4_ERR_NOT_FINITE;
    }
    if (lease_us == 0) {
        lease_us = c->private_config.lease_ms * 1000U;
    }
    if (lease_us < LEASE_MIN_US || lease_us > LEASE_MAX_US) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    roburoc4_lifecycle_clock(c, now_us);
    roburoc4_arming_tick(c);
    return roburoc4_drive_grant(&c->private_drive, target, lease_us, now_us);
}

roburoc4_result roburoc4_client_stop(client *c, uint64_t now_us) {
    if (!started(c)) {
        return ROBUROC4_ERR_STATE;
    }
    roburoc4_lifecycle_clock(c, now_us);
    roburoc4_drive_stop(&c->private_drive);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_set_role_index(client *c, uint32_t role, int32_t index,
                                               uint64_t now_us) {
    if (role >= ROBUROC4_ROLE_COUNT || index < ROBUROC4_INDEX_AUTO ||
        index >= roburoc4_role_capacity(role)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    roburoc4_lifecycle_clock(c, now_us);
    c->private_config.role_index[role] = (int16_t)index;
    if (role == ROBUROC4_ROLE_OVERRIDE) {
        c->private_values.override_known = 0;
        roburoc4_arming_tick(c);
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
    /* a command carries all outputs: of a card that has more than fit, none can be set */
    if (counts[ROBUROC4_IO_ANALOG_OUTPUT] > ROBUROC4_MAX_ANALOG_OUTPUTS ||
        counts[ROBUROC4_IO_DIGITAL_OUTPUT] > ROBUROC4_MAX_DIGITAL_OUTPUTS) {
        return ROBUROC4_ERR_INDEX;
    }
    return counts[io_type] < capacity ? counts[io_type] : capacity;
}

static void send_outputs(client *c, uint64_t now_us) {
    roburoc4_lifecycle_clock(c, now_us);
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
    if (!finite_f32_bits(bits_from_f32(value))) {
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

roburoc4_result roburoc4_client_relocalize(client *c, double x_m, double y_m, double theta_rad,
                                           uint64_t now_us) {
    const uint64_t bits[3] = {bits_from_f64(x_m), bits_from_f64(y_m), bits_from_f64(theta_rad)};
    roburoc4_private_outputs *o = &c->private_outputs;
    if (!finite_f64_bits(bits[0]) || !finite_f64_bits(bits[1]) || !finite_f64_bits(bits[2])) {
        return ROBUROC4_ERR_NOT_FINITE;
    }
    if (c->private_state != ROBUROC4_STATE_READY) {
        return ROBUROC4_ERR_NOT_READY;
    }
    if ((c->private_discovery.listed & service_bit(ROBUROC4_SERVICE_LOCALIZATION)) == 0) {
        return ROBUROC4_ERR_UNKNOWN;
    }
    roburoc4_lifecycle_clock(c, now_us);
    roburoc4_requests_cancel(&c->private_requests, ROBUROC4_ACTION_REPLACE,
                             ROBUROC4_SERVICE_LOCALIZATION);
    memcpy(o->pose_bits, bits, sizeof bits);
    o->relocalizing = 1;
    o->relocalize_result = ROBUROC4_ERR_UNKNOWN;
    o->relocalize_us = now_us;
    return ROBUROC4_OK;
}

static bool has_status(uint32_t service) {
    return service >= ROBUROC4_SERVICE_IOCARD && service < ROBUROC4_SERVICE_COUNT;
}

/** Whatever was agreed about this subscription is void. */
static void forget_subscription(client *c, uint32_t service) {
    discovery *d = &c->private_discovery;
    const uint8_t others = (uint8_t)~service_bit(service);
    d->acked &= others;
    d->declined &= others;
    d->leaving &= others;
    roburoc4_requests_cancel(&c->private_requests, ROBUROC4_ACTION_INSERT, (uint8_t)service);
    roburoc4_requests_cancel(&c->private_requests, ROBUROC4_ACTION_DELETE, (uint8_t)service);
}

roburoc4_result roburoc4_client_subscribe(client *c, uint32_t service, uint32_t period_ms,
                                          uint64_t now_us) {
    if (!has_status(service) || period_ms < 10 || period_ms > 2550 || period_ms % 10 != 0) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    roburoc4_lifecycle_clock(c, now_us);
    forget_subscription(c, service);
    c->private_discovery.wanted |= service_bit(service);
    c->private_config.subscriptions |= service_bit(service);
    c->private_config.period_ms[service] = (uint16_t)period_ms;
    c->private_link.services[STATUS_INDEX(service)].asked_cycles = (uint8_t)(period_ms / 10);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_client_unsubscribe(client *c, uint32_t service, uint64_t now_us) {
    discovery *d = &c->private_discovery;
    if (!has_status(service)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    roburoc4_lifecycle_clock(c, now_us);
    forget_subscription(c, service);
    if ((d->inserted & service_bit(service)) != 0) {
        d->leaving |= service_bit(service);
    }
    d->inserted &= (uint8_t)~service_bit(service);
    d->wanted &= (uint8_t)~service_bit(service);
    c->private_config.subscriptions &= ~(uint32_t)service_bit(service);
    return ROBUROC4_OK;
}
