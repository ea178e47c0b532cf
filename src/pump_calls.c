/* SPDX-License-Identifier: MIT
 *
 * pump_calls.c - the client's calls behind the pump's lock. Commands send at once; the clock is
 * read with the lock held, so that time never goes back from one call to the next.
 */
#include "pump_internal.h"

/* -------------------------------------------------------------------------------- commands --- */

static int enter_running(roburoc4_pump *pump) {
    if (!roburoc4_pump_enter(pump)) {
        return 0;
    }
    if (pump->phase != ROBUROC4_PUMP_RUNNING) {
        roburoc4_pump_leave(pump);
        return 0;
    }
    return 1;
}

static roburoc4_result send_and_leave(roburoc4_pump *pump, roburoc4_result result) {
    roburoc4_pump_flush(pump);
    roburoc4_pump_leave(pump);
    return result;
}

roburoc4_result roburoc4_pump_arm(roburoc4_pump *pump) {
    if (!enter_running(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    return send_and_leave(pump, roburoc4_client_arm(&pump->client, roburoc4_udp_now_us()));
}

roburoc4_result roburoc4_pump_disarm(roburoc4_pump *pump) {
    if (!enter_running(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    return send_and_leave(pump, roburoc4_client_disarm(&pump->client, roburoc4_udp_now_us()));
}

roburoc4_result roburoc4_pump_drive(roburoc4_pump *pump, float linear_m_s, float angular_rad_s,
                                    uint32_t lease_us) {
    if (!enter_running(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    return send_and_leave(pump, roburoc4_client_drive(&pump->client, linear_m_s, angular_rad_s,
                                                      lease_us, roburoc4_udp_now_us()));
}

roburoc4_result roburoc4_pump_stop_robot(roburoc4_pump *pump) {
    if (!enter_running(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    return send_and_leave(pump, roburoc4_client_stop(&pump->client, roburoc4_udp_now_us()));
}

roburoc4_result roburoc4_pump_set_digital_outputs(roburoc4_pump *pump, uint64_t mask,
                                                  uint64_t values) {
    if (!enter_running(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    return send_and_leave(pump, roburoc4_client_set_digital_outputs(&pump->client, mask, values,
                                                                    roburoc4_udp_now_us()));
}

roburoc4_result roburoc4_pump_set_analog_output(roburoc4_pump *pump, uint32_t index, float value) {
    if (!enter_running(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    return send_and_leave(pump, roburoc4_client_set_analog_output(&pump->client, index, value,
                                                                  roburoc4_udp_now_us()));
}

roburoc4_result roburoc4_pump_relocalize(roburoc4_pump *pump, double x_m, double y_m,
                                         double theta_rad) {
    if (!enter_running(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    return send_and_leave(pump, roburoc4_client_relocalize(&pump->client, x_m, y_m, theta_rad,
                                                           roburoc4_udp_now_us()));
}

roburoc4_result roburoc4_pump_subscribe(roburoc4_pump *pump, uint32_t service, uint32_t period_ms) {
    if (!enter_running(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    return send_and_leave(
        pump, roburoc4_client_subscribe(&pump->client, service, period_ms, roburoc4_udp_now_us()));
}

roburoc4_result roburoc4_pump_unsubscribe(roburoc4_pump *pump, uint32_t service) {
    if (!enter_running(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    return send_and_leave(
        pump, roburoc4_client_unsubscribe(&pump->client, service, roburoc4_udp_now_us()));
}

roburoc4_result roburoc4_pump_set_role_index(roburoc4_pump *pump, uint32_t role, int32_t index) {
    if (!enter_running(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    return send_and_leave(
        pump, roburoc4_client_set_role_index(&pump->client, role, index, roburoc4_udp_now_us()));
}

/* ------------------------------------------------------------------------ facts and values --- */

roburoc4_result roburoc4_pump_facts(roburoc4_pump *pump, roburoc4_facts *facts) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_facts(&pump->client, roburoc4_udp_now_us(), facts);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_link(roburoc4_pump *pump, roburoc4_link *link) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_link(&pump->client, roburoc4_udp_now_us(), link);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_service_link(roburoc4_pump *pump, uint32_t service,
                                           roburoc4_service_link *link) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_service_link(&pump->client, service, roburoc4_udp_now_us(), link);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_host_time(roburoc4_pump *pump, uint64_t robot_cycles,
                                        uint64_t *host_us) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_host_time(&pump->client, robot_cycles, host_us);
        roburoc4_pump_leave(pump);
    }
    return result;
}

uint32_t roburoc4_pump_state(roburoc4_pump *pump) {
    uint32_t result = 0;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_state(&pump->client);
        roburoc4_pump_leave(pump);
    }
    return result;
}

uint32_t roburoc4_pump_count(roburoc4_pump *pump, uint32_t counter) {
    uint32_t result = 0;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_count(&pump->client, counter);
        roburoc4_pump_leave(pump);
    }
    return result;
}

uint32_t roburoc4_pump_udp_count(roburoc4_pump *pump, uint32_t counter) {
    uint32_t result = 0;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_udp_count(&pump->udp, counter);
        roburoc4_pump_leave(pump);
    }
    return result;
}

uint32_t roburoc4_pump_fault(roburoc4_pump *pump) {
    uint32_t result = 0;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_udp_fault(&pump->udp);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_address(roburoc4_pump *pump, roburoc4_address *out) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_udp_address(&pump->udp, out);
        roburoc4_pump_leave(pump);
    }
    return result;
}

uint32_t roburoc4_pump_service_count(roburoc4_pump *pump) {
    uint32_t result = 0;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_service_count(&pump->client);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_service_at(roburoc4_pump *pump, uint32_t index,
                                         roburoc4_directory_entry *out) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_service_at(&pump->client, index, out);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_service_id(roburoc4_pump *pump, uint32_t service) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_service_id(&pump->client, service);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_iocard_properties(roburoc4_pump *pump,
                                                roburoc4_iocard_properties *out) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_iocard_properties(&pump->client, out);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_battery_properties(roburoc4_pump *pump,
                                                 roburoc4_battery_properties *out) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_battery_properties(&pump->client, out);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_localization_properties(roburoc4_pump *pump,
                                                      roburoc4_localization_properties *out) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_localization_properties(&pump->client, out);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_differential_properties(roburoc4_pump *pump,
                                                      roburoc4_differential_properties *out) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_differential_properties(&pump->client, out);
        roburoc4_pump_leave(pump);
    }
    return result;
}

uint32_t roburoc4_pump_telemeter_count(roburoc4_pump *pump) {
    uint32_t result = 0;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_telemeter_count(&pump->client);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_telemeter(roburoc4_pump *pump, uint32_t index,
                                        roburoc4_telemeter *out) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_telemeter(&pump->client, index, out);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_role_index(roburoc4_pump *pump, uint32_t role) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_role_index(&pump->client, role);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_battery(roburoc4_pump *pump, roburoc4_battery_status *out,
                                      uint64_t *host_us) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_battery(&pump->client, out, host_us);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_localization(roburoc4_pump *pump, roburoc4_localization_status *out,
                                           uint64_t *host_us) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_localization(&pump->client, out, host_us);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_differential(roburoc4_pump *pump, roburoc4_differential_status *out,
                                           uint64_t *host_us) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_differential(&pump->client, out, host_us);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_inputs(roburoc4_pump *pump, roburoc4_inputs *out, uint64_t *host_us) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_inputs(&pump->client, out, host_us);
        roburoc4_pump_leave(pump);
    }
    return result;
}

roburoc4_result roburoc4_pump_distances(roburoc4_pump *pump, roburoc4_distances *out,
                                        uint64_t *host_us) {
    roburoc4_result result = ROBUROC4_ERR_CLOSED;
    if (roburoc4_pump_enter(pump)) {
        result = roburoc4_client_distances(&pump->client, out, host_us);
        roburoc4_pump_leave(pump);
    }
    return result;
}
