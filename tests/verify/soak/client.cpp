/* SPDX-License-Identifier: MIT */
#include "client.h"

namespace soak {

std::int32_t RealClient::init(const roburoc4_config &config) {
    return roburoc4_client_init(&client_, sizeof client_, &config);
}

std::int32_t RealClient::start(std::uint64_t now) {
    return roburoc4_client_start(&client_, now);
}

std::int32_t RealClient::close(std::uint64_t now) {
    return roburoc4_client_close(&client_, now);
}

std::int32_t RealClient::arm(std::uint64_t now) {
    return roburoc4_client_arm(&client_, now);
}

std::int32_t RealClient::pause(std::uint64_t now) {
    return roburoc4_client_pause(&client_, now);
}

std::int32_t RealClient::drive(Speeds speeds, std::uint32_t lease_us, std::uint64_t now) {
    return roburoc4_client_drive(&client_, speeds.v, speeds.w, lease_us, now);
}

std::int32_t RealClient::stop(std::uint64_t now) {
    return roburoc4_client_stop(&client_, now);
}

std::int32_t RealClient::set_override_index(std::int32_t index, std::uint64_t now) {
    return roburoc4_client_set_role_index(&client_, ROBUROC4_ROLE_OVERRIDE, index, now);
}

std::int32_t RealClient::set_outputs(std::uint64_t mask, std::uint64_t values, std::uint64_t now) {
    return roburoc4_client_set_digital_outputs(&client_, mask, values, now);
}

std::int32_t RealClient::relocalize(std::uint64_t now) {
    return roburoc4_client_relocalize(&client_, 1, 2, 3, now);
}

std::int32_t RealClient::subscribe(std::uint32_t service, std::uint32_t period_ms,
                                   std::uint64_t now) {
    return roburoc4_client_subscribe(&client_, service, period_ms, now);
}

std::int32_t RealClient::receive(const Datagram &datagram, std::uint64_t now) {
    return roburoc4_client_receive(&client_, datagram.bytes.data(), datagram.size, now);
}

std::int32_t RealClient::poll_transmit(Datagram &out, std::uint64_t now) {
    const std::int32_t length =
        roburoc4_client_poll_transmit(&client_, out.bytes.data(), out.bytes.size(), now);
    out.size = length > 0 ? static_cast<std::size_t>(length) : 0;
    return length;
}

std::uint64_t RealClient::next_deadline() {
    return roburoc4_client_next_deadline(&client_);
}

Report RealClient::report(std::uint64_t now) {
    roburoc4_facts facts{};
    facts.size = sizeof facts;
    roburoc4_client_facts(&client_, now, &facts);
    Report report;
    report.state = facts.state;
    report.events = roburoc4_client_take_events(&client_);
    report.armed = facts.armed != 0;
    report.driving = facts.driving != 0;
    report.stopping = facts.stopping != 0;
    report.fixed_id = facts.fixed_id != 0;
    report.other_commander = facts.other_commander != 0;
    report.override_known = facts.override_known != 0;
    roburoc4_differential_properties properties{};
    report.differential_known =
        facts.state != ROBUROC4_STATE_CONNECTING && facts.state != ROBUROC4_STATE_DISCOVERING &&
        facts.arm_refusal != ROBUROC4_ERR_NO_DIFFERENTIAL &&
        roburoc4_client_service_id(&client_, ROBUROC4_SERVICE_DIFFERENTIAL) >= 0 &&
        roburoc4_client_differential_properties(&client_, &properties) >= 0;
    report.override_index = roburoc4_client_role_index(&client_, ROBUROC4_ROLE_OVERRIDE);
    report.disarm_cause = facts.disarm_cause;
    report.stop_outcome = facts.stop_outcome;
    for (int service = 0; service < 5; service++)
        report.age_us[service] = facts.age_us[ROBUROC4_SERVICE_IOCARD + service];
    return report;
}

} // namespace soak
