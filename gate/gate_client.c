/* SPDX-License-Identifier: MIT */
#include "gate_client.h"

static roburoc4_facts facts_of(const roburoc4_client *client, uint64_t now_us) {
    roburoc4_facts facts = {.size = sizeof facts};
    (void)roburoc4_client_facts(client, now_us, &facts);
    return facts;
}

gate_robot gate_robot_of(const roburoc4_client *client, uint64_t now_us) {
    roburoc4_facts facts = facts_of(client, now_us);
    gate_robot robot = {facts.state == ROBUROC4_STATE_READY, facts.armed != 0, facts.arm_refusal};
    return robot;
}

void gate_heed_events(gate *gate, const roburoc4_client *client, uint32_t events, uint64_t now_us) {
    const uint32_t link_events = ROBUROC4_EVENT_LOST | ROBUROC4_EVENT_REBOOT | ROBUROC4_EVENT_CLOCK;
    const roburoc4_facts facts = facts_of(client, now_us);
    /* A lapse disarms because no command came: that was a pause. */
    const bool disarmed =
        (events & ROBUROC4_EVENT_DISARMED) != 0 && facts.disarm_cause != ROBUROC4_ERR_LAPSED;
    const bool overridden = (events & ROBUROC4_EVENT_OVERRIDE) != 0 && facts.overridden != 0;
    if (disarmed || overridden || (events & link_events) != 0) {
        gate_hold(gate, now_us);
    }
}

/* A speed that no RobuROC4 reaches; the robot keeps the target that it has. */
static bool is_too_fast(float linear_m_s, float angular_rad_s) {
    return linear_m_s > ROBUROC4_MAX_DRIVE_M_S || linear_m_s < -ROBUROC4_MAX_DRIVE_M_S ||
           angular_rad_s > ROBUROC4_MAX_DRIVE_RAD_S || angular_rad_s < -ROBUROC4_MAX_DRIVE_RAD_S;
}

static enum gate_verdict refuse(gate *gate, roburoc4_result result, uint64_t now_us) {
    if (result != ROBUROC4_ERR_LAPSED) {
        gate_hold(gate, now_us);
    }
    gate_reject(gate, GATE_DISARMED);
    return GATE_DISARMED;
}

enum gate_verdict gate_arm(gate *gate, roburoc4_client *client, uint64_t now_us) {
    const roburoc4_result result = roburoc4_client_arm(client, now_us);
    if (result < 0) {
        return refuse(gate, result, now_us);
    }
    gate->stopped = false;
    return GATE_TAKEN;
}

enum gate_verdict gate_drive(gate *gate, roburoc4_client *client, float linear_m_s,
                             float angular_rad_s, uint32_t lease_us, uint64_t now_us) {
    bool zero = linear_m_s == 0.0f && angular_rad_s == 0.0f;
    bool armed = gate_robot_of(client, now_us).armed;
    if (is_too_fast(linear_m_s, angular_rad_s)) {
        gate_reject(gate, GATE_UNITS);
        return GATE_UNITS;
    }
    roburoc4_result result = armed || zero ? 0 : roburoc4_client_arm(client, now_us);
    if (result >= 0 && (armed || !zero)) {
        result = roburoc4_client_drive(client, linear_m_s, angular_rad_s, lease_us, now_us);
    }
    if (result < 0) {
        return refuse(gate, result, now_us);
    }
    gate->stopped = gate->stopped && zero;
    gate_count_taken(gate, GATE_DRIVE);
    return GATE_TAKEN;
}

void gate_stop_client(gate *gate, roburoc4_client *client, const char *sender, size_t length,
                      uint64_t now_us) {
    const roburoc4_result stopped = roburoc4_client_stop(client, now_us);
    (void)stopped; /* nothing moves if it is idle or closing */
    gate_stop(gate, sender, length, now_us);
    gate_count_taken(gate, GATE_STOP);
}
