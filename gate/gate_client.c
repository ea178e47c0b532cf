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
    const uint32_t ends_driving = ROBUROC4_EVENT_DISARMED | ROBUROC4_EVENT_LOST |
                                  ROBUROC4_EVENT_REBOOT | ROBUROC4_EVENT_CLOCK;
    if ((events & ends_driving) != 0 ||
        ((events & ROBUROC4_EVENT_OVERRIDE) != 0 && facts_of(client, now_us).overridden != 0)) {
        gate_hold(gate, now_us);
    }
}

enum gate_verdict gate_drive(gate *gate, roburoc4_client *client, float linear_m_s,
                             float angular_rad_s, uint32_t lease_us, uint64_t now_us) {
    bool zero = linear_m_s == 0.0f && angular_rad_s == 0.0f;
    bool armed = gate_robot_of(client, now_us).armed;
    roburoc4_result result = armed || zero ? 0 : roburoc4_client_arm(client, now_us);
    if (result >= 0 && (armed || !zero)) {
        result = roburoc4_client_drive(client, linear_m_s, angular_rad_s, lease_us, now_us);
    }
    if (result < 0) {
        gate_hold(gate, now_us);
        gate_reject(gate, GATE_DISARMED);
        return GATE_DISARMED;
    }
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
