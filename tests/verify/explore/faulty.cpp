/* SPDX-License-Identifier: MIT */
#include "faulty.h"

#include <algorithm>
#include <cstring>

namespace explore {

namespace {

enum : std::uint32_t {
    lease_renewed = 1,
    speed_changed,
    second_speed_missing,
    commands_doubled,
    stop_only_pauses,
    pause_stops,
    lapse_ignored,
    override_not_seen,
    armed_under_override,
    arms_by_itself,
    fresh_too_long,
    age_halved,
    clock_fault_hidden,
    first_zero_missing,
    later_zeros_missing,
    two_zeros,
    ended_at_once,
    traffic_first,
    confirmed_by_time,
    stopped_event_early,
    sequence_not_repeated,
    disarmed_event_missing,
    monitor_commands,
    others_ignored,
    release_unanswered,
    speeds_not_compared,
    late_uplink_ignored,
    arrival_assumed,
};

std::uint32_t fault = no_fault;

bool is_command(const std::uint8_t *datagram, roburoc4_result size) {
    return size == 11 && datagram[0] == ROBUROC4_HEADER_STATUS;
}

constexpr std::size_t iocard = 12, differential = 27; /* lengths of statuses */

bool is_status(const std::uint8_t *datagram, std::size_t size, std::size_t wanted) {
    return size == wanted && datagram[0] == ROBUROC4_HEADER_STATUS;
}

bool is_zero(const std::uint8_t *datagram) {
    for (int i = 3; i < 11; i++)
        if (datagram[i] != 0)
            return false;
    return true;
}

} // namespace

const Fault faults[] = {
    {"no fault", none},
    {"a lease never ends", lease},
    {"a speed is higher than asked for", lease},
    {"every second command within a lease is missing", fed},
    {"each command is sent twice", rate},
    {"stop() keeps armed", latch},
    {"pause() disarms", pausing},
    {"a lapsed lease keeps armed", lapse},
    {"[A] is never seen", override_},
    {"arm() is accepted while [A] is held", arming},
    {"it arms by itself", arming},
    {"old statuses count as fresh", fresh},
    {"reported ages are half of the true ones", age},
    {"a step back of the clock goes unnoticed", clock},
    {"the first zero is missing", exit_},
    {"zeros after the first are missing", period},
    {"a stop sequence has two zeros", three},
    {"a stop sequence ends after three zeros, whatever the robot shows", ending},
    {"another datagram leaves before a zero", first},
    {"a stop that ran out of time is called confirmed", belief},
    {"STOP_CONFIRMED is raised by stop()", belief},
    {"nothing is sent after the end of a stop sequence", watched},
    {"the event DISARMED is missing", events},
    {"a zero is sent without a reason", monitor},
    {"another commander goes unnoticed", commander},
    {"nothing is sent when [A] is released", release},
    {"reported speeds are not compared with the target", follows},
    {"it stays armed when commands do not arrive", uplink},
    {"a stop is confirmed though nothing shows that it arrived", belief},
};
const std::uint32_t fault_count = sizeof faults / sizeof *faults;

void set_fault(std::uint32_t index) {
    fault = index;
}

void Port::begin(const roburoc4_config &settings, std::uint64_t now_us) {
    roburoc4_config config = settings;
    if (fault == lapse_ignored)
        config.lapse_disarm_ms = 60000;
    if (fault == fresh_too_long)
        config.fresh_ms = 1000;
    if (fault == others_ignored)
        config.options |= ROBUROC4_OPTION_IGNORE_OTHER_COMMANDER;
    if (fault == ended_at_once)
        config.robot_watchdog_ms = 100;
    roburoc4_client_init(&client, sizeof client, &config);
    roburoc4_client_start(&client, now_us);
}

roburoc4_result Port::arm(std::uint64_t now_us) {
    const roburoc4_result result = roburoc4_client_arm(&client, now_us);
    if (fault == armed_under_override && result == ROBUROC4_ERR_OVERRIDE)
        return ROBUROC4_OK;
    return result;
}

roburoc4_result Port::drive(Speeds wanted, std::uint64_t now_us) {
    if (fault != no_fault) {
        speeds = wanted;
        zeros = 0;
    }
    const roburoc4_result result =
        roburoc4_client_drive(&client, wanted.linear, wanted.angular, 0, now_us);
    return fault == late_uplink_ignored && result == ROBUROC4_ERR_UPLINK ? ROBUROC4_OK : result;
}

roburoc4_result Port::pause(std::uint64_t now_us) {
    if (fault == pause_stops)
        return roburoc4_client_stop(&client, now_us);
    return roburoc4_client_pause(&client, now_us);
}

roburoc4_result Port::stop(std::uint64_t now_us) {
    if (fault == stop_only_pauses)
        return roburoc4_client_pause(&client, now_us);
    if (fault == stopped_event_early)
        polls = 1;
    return roburoc4_client_stop(&client, now_us);
}

roburoc4_result Port::receive(std::uint8_t *datagram, std::size_t size, std::uint64_t now_us) {
    if (fault == override_not_seen && is_status(datagram, size, iocard))
        datagram[11] = 0;
    if (fault == clock_fault_hidden)
        now_us = latest_us = std::max(now_us, latest_us);
    if (fault == release_unanswered && is_status(datagram, size, iocard)) {
        if (polls != 0 && datagram[11] == 0)
            latest_us = now_us + 1000 * ms;
        polls = datagram[11];
    }
    if (fault == speeds_not_compared && is_status(datagram, size, differential)) {
        std::memcpy(datagram + 15, datagram + 11, 4);
        std::memcpy(datagram + 23, datagram + 19, 4);
    }
    if (fault == arrival_assumed) {
        client.private_drive.in_flight = 0;
        client.private_drive.expected_us = client.private_drive.stop_us;
    }
    return roburoc4_client_receive(&client, datagram, size, now_us);
}

roburoc4_result Port::poll(std::uint8_t *buffer, std::uint64_t now_us) {
    if (fault == no_fault)
        return roburoc4_client_poll_transmit(&client, buffer, ROBUROC4_MAX_TRANSMIT, now_us);
    if (fault == clock_fault_hidden)
        now_us = latest_us = std::max(now_us, latest_us);
    if (fault == lease_renewed && facts(now_us).driving)
        static_cast<void>(roburoc4_client_drive(&client, speeds.linear, speeds.angular, 0, now_us));
    if (fault == arms_by_itself)
        static_cast<void>(roburoc4_client_arm(&client, now_us));
    roburoc4_result size = 0;
    while ((size = roburoc4_client_poll_transmit(&client, buffer, ROBUROC4_MAX_TRANSMIT, now_us)) >
           0) {
        if (!is_command(buffer, size)) {
            if (fault == monitor_commands) /* in the place of a request */
                return roburoc4_encode_differential_command(buffer, ROBUROC4_MAX_TRANSMIT, 6, 0, 0);
            return size;
        }
        if (is_zero(buffer)) {
            zeros++;
            if ((fault == first_zero_missing && zeros == 1) ||
                (fault == later_zeros_missing && zeros > 1) || (fault == two_zeros && zeros > 2) ||
                (fault == sequence_not_repeated && zeros > 4) ||
                (fault == release_unanswered && now_us < latest_us))
                continue;
            if (fault == traffic_first && zeros == 1)
                break;
        } else {
            if (fault == second_speed_missing && ++polls % 2 == 0)
                continue;
            if (fault == speed_changed)
                buffer[5] ^= 1;
        }
        if (fault == commands_doubled && polls++ % 2 == 0) {
            std::memcpy(doubled, buffer, sizeof doubled);
            return size;
        }
        return size;
    }
    if (fault == commands_doubled && polls % 2 != 0) {
        polls++;
        std::memcpy(buffer, doubled, sizeof doubled);
        return sizeof doubled;
    }
    if (fault == traffic_first && zeros == 1) {
        zeros = 2;
        const roburoc4_request request{1, ROBUROC4_ACTION_GET, 0, 0, 0, 0, 0, 0, 0, 0, 0};
        return roburoc4_encode_request(buffer, ROBUROC4_MAX_TRANSMIT, &request);
    }
    return size;
}

std::uint64_t Port::deadline() const {
    return roburoc4_client_next_deadline(&client);
}

std::uint32_t Port::take_events() {
    std::uint32_t events = roburoc4_client_take_events(&client);
    if (fault == disarmed_event_missing)
        events &= ~static_cast<std::uint32_t>(ROBUROC4_EVENT_DISARMED);
    if (fault == stopped_event_early && polls == 1) {
        polls = 0;
        events |= ROBUROC4_EVENT_STOP_CONFIRMED;
    }
    return events;
}

roburoc4_facts Port::facts(std::uint64_t now_us) const {
    roburoc4_facts out;
    if (fault == clock_fault_hidden && latest_us > now_us)
        now_us = latest_us;
    roburoc4_client_facts(&client, now_us, ROBUROC4_SIZED(&out));
    if (fault == age_halved)
        for (std::uint32_t &age_us : out.age_us)
            age_us /= 2;
    if (fault == late_uplink_ignored && out.disarm_cause == ROBUROC4_ERR_UPLINK)
        out.armed = 1;
    if (fault == confirmed_by_time && out.stop_outcome == ROBUROC4_STOP_TIMED_OUT)
        out.stop_outcome = ROBUROC4_STOP_CONFIRMED;
    return out;
}

} // namespace explore
