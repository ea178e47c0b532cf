/* SPDX-License-Identifier: MIT
 *
 * The client's data as LCM messages: every field arrives with its value. Messages travel over
 * memq://, LCM's network within one process.
 */
#include <gtest/gtest.h>
#include <lcm/lcm.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "client_bench.h"
#include "mapping.h"
#include "roburoc4_move.h"
#include "roburoc4_udp.h"

using namespace roburoc4_tests;

namespace {

constexpr std::int64_t utime = 1790000000123456;
constexpr std::uint64_t cycles = 0x123456789AULL;

/** Through LCM and back: encoded, sent, received, decoded, and shown to `look`. */
template <class Message, class Subscription>
void travel(const Message &message,
            Subscription *(*subscribe)(lcm_t *, const char *,
                                       void (*)(const lcm_recv_buf_t *, const char *,
                                                const Message *, void *),
                                       void *),
            int (*publish)(lcm_t *, const char *, const Message *),
            const std::function<void(const Message &)> &look) {
    struct State {
        const std::function<void(const Message &)> *look;
        int seen;
    } state{&look, 0};
    const std::unique_ptr<lcm_t, void (*)(lcm_t *)> lcm(lcm_create("memq://"), lcm_destroy);
    ASSERT_NE(nullptr, lcm);
    Subscription *subscription = subscribe(
        lcm.get(), "CHANNEL",
        [](const lcm_recv_buf_t *, const char *, const Message *in, void *user) {
            auto *s = static_cast<State *>(user);
            s->seen++;
            (*s->look)(*in);
        },
        &state);
    ASSERT_NE(nullptr, subscription);
    ASSERT_EQ(0, publish(lcm.get(), "CHANNEL", &message));
    EXPECT_EQ(1, lcm_handle_timeout(lcm.get(), 1000));
    EXPECT_EQ(1, state.seen);
    std::free(subscription);
}

#define TRAVEL(type, message, look)                                                                \
    travel<type, type##_subscription_t>(message, type##_subscribe,                                 \
                                        type##_publish, [&](const type &got) look)

template <class Status> void expect_stamp(const Status &got) {
    EXPECT_EQ(utime, got.utime);
    EXPECT_EQ(static_cast<std::int64_t>(cycles), got.robot_cycles);
}

/** Everything from which the bridge's state and statistics are made. */
struct View {
    View() {
        facts.size = sizeof facts;
        link.size = sizeof link;
        gate_rules rules{};
        rules.enabled[GATE_DRIVE] = true;
        rules.lease_us = 300000;
        rules.max_age_us = 200000;
        gate_init(&gate, &rules, {0, utime - 10000000});
        view.now = {10000000, utime};
        view.robot = address;
        view.bridge = "lab 17";
        view.started_utime = utime - 10000000;
        view.for_gate = {true, true, 0};
        view.facts = &facts;
        view.link = &link;
        view.gate = &gate;
        view.heard = true;
        view.command_us = -1;
        facts.state = ROBUROC4_STATE_READY;
        facts.armed = 1;
    }
    void command(const char *sender) {
        gate_command c{};
        c.sender = sender;
        c.sender_length = std::strlen(sender);
        c.utime = c.arrived_utime = utime;
        c.finite = true;
        const gate_robot robot{true, true, 0};
        std::uint32_t lease_us = 0;
        ASSERT_EQ(GATE_TAKEN, gate_judge(&gate, &c, &robot, view.now, &lease_us));
        facts.driving = 1;
        facts.lease_left_us = lease_us;
    }
    std::string message() {
        char room[MAPPING_MESSAGE_SIZE];
        mapping_message(&view, room, sizeof room);
        return room;
    }
    roburoc4_lcm_bridge_state_t state() {
        roburoc4_lcm_bridge_state_t out;
        mapping_bridge_state(&view, &texts, &out);
        return out;
    }
    roburoc4_lcm_bridge_statistics_t statistics() {
        roburoc4_lcm_bridge_statistics_t out;
        mapping_bridge_statistics(&view, &out);
        return out;
    }

    char address[20] = "10.0.0.1:60000";
    roburoc4_facts facts{};
    roburoc4_link link{};
    struct gate gate {};
    mapping_view view{};
    mapping_texts texts{};
};

} // namespace

TEST(LcmMapping, EveryFieldOfSpeedsPoseAndChargeArrives) {
    roburoc4_differential_status seen{};
    seen.robot_cycles = cycles;
    seen.target_linear_m_s = 0.1F;
    seen.current_linear_m_s = 0.2F;
    seen.target_angular_rad_s = 0.3F;
    seen.current_angular_rad_s = 0.4F;
    roburoc4_lcm_differential_status_t speeds;
    mapping_differential(&seen, utime, &speeds);
    TRAVEL(roburoc4_lcm_differential_status_t, speeds, {
        expect_stamp(got);
        EXPECT_EQ(0.1F, got.target_linear_m_s);
        EXPECT_EQ(0.2F, got.current_linear_m_s);
        EXPECT_EQ(0.3F, got.target_angular_rad_s);
        EXPECT_EQ(0.4F, got.current_angular_rad_s);
    });
    roburoc4_localization_status pose{};
    pose.robot_cycles = cycles;
    pose.x_m = 1.5;
    pose.y_m = -2.5;
    pose.theta_rad = 0.75;
    pose.flags = 5;
    roburoc4_lcm_localization_status_t where;
    mapping_localization(&pose, utime, &where);
    TRAVEL(roburoc4_lcm_localization_status_t, where, {
        expect_stamp(got);
        EXPECT_EQ(1.5, got.x_m);
        EXPECT_EQ(-2.5, got.y_m);
        EXPECT_EQ(0.75, got.theta_rad);
        EXPECT_EQ(5, got.flags);
    });
    roburoc4_battery_status charge{};
    charge.robot_cycles = cycles;
    charge.state = 2;
    charge.remaining_percent = 77;
    roburoc4_lcm_battery_status_t battery;
    mapping_battery(&charge, utime, &battery);
    TRAVEL(roburoc4_lcm_battery_status_t, battery, {
        expect_stamp(got);
        EXPECT_EQ(2, got.state);
        EXPECT_EQ(77, got.remaining_percent);
    });
}

TEST(LcmMapping, TelemeterStatusHasTheMountingBesideEachDistance) {
    roburoc4_distances in{};
    in.robot_cycles = cycles;
    in.count = 3;
    in.distances_m[0] = 1.5F;
    in.distances_m[1] = 2.5F;
    in.distances_m[2] = 3.5F;
    const roburoc4_telemeter known[] = {{0.1F, 0.2F, 0.3F, 0.4F, 0.5F, 0.6F, 9.0F},
                                        {1.1F, 1.2F, 1.3F, 1.4F, 1.5F, 1.6F, 9.0F}};
    roburoc4_lcm_telemeter_t storage[ROBUROC4_MAX_TELEMETERS];
    roburoc4_lcm_telemeter_status_t out;
    storage[3].distance_m = -7;
    mapping_telemeter(&in, known, 2, utime, storage, &out);
    EXPECT_EQ(-7, storage[3].distance_m) << "a full list has no place behind it";
    TRAVEL(roburoc4_lcm_telemeter_status_t, out, {
        expect_stamp(got);
        ASSERT_EQ(3, got.telemeter_count);
        EXPECT_EQ(1.5F, got.telemeters[0].distance_m);
        EXPECT_EQ(0.1F, got.telemeters[0].x_m);
        EXPECT_EQ(0.2F, got.telemeters[0].y_m);
        EXPECT_EQ(0.3F, got.telemeters[0].theta_rad);
        EXPECT_EQ(0.4F, got.telemeters[0].field_of_view_rad);
        EXPECT_EQ(0.5F, got.telemeters[0].min_distance_m);
        EXPECT_EQ(0.6F, got.telemeters[0].max_distance_m);
        EXPECT_EQ(2.5F, got.telemeters[1].distance_m);
        EXPECT_EQ(1.1F, got.telemeters[1].x_m);
        EXPECT_EQ(3.5F, got.telemeters[2].distance_m);
        EXPECT_TRUE(std::isnan(got.telemeters[2].x_m)) << "properties that were not reported";
    });
}

TEST(LcmMapping, IoCardStatusHasANameBesideEachValue) {
    ScriptedRobot robot;
    robot.texts_refused = true;
    Bench bench(robot);
    bench.ready();
    auto names = std::make_unique<mapping_names>();
    const std::uint8_t text[] = "T\xE9l\xE9m\xE8tre";
    mapping_names_set(names.get(), ROBUROC4_IO_ANALOG_INPUT, 1, text, sizeof text - 1);
    mapping_names_set(names.get(), ROBUROC4_IO_DIGITAL_INPUT, 63, text, 1);
    mapping_names_set(names.get(), ROBUROC4_IO_ANALOG_INPUT, 0, text, 0);
    mapping_names_set(names.get(), ROBUROC4_IO_ANALOG_INPUT, ROBUROC4_MAX_ANALOG_INPUTS, text, 1);
    EXPECT_STRNE("T", mapping_names_of(names.get(), &bench.client, ROBUROC4_IO_ANALOG_OUTPUT)[0])
        << "not the next list's";
    mapping_names_set(names.get(), ROBUROC4_IO_ANALOG_INPUT, 1, text, 0); /* keeps its name */
    mapping_names_set(names.get(), -1, 0, text, 1);
    mapping_names_set(names.get(), 4, 0, text, 1);
    roburoc4_inputs in{};
    in.robot_cycles = cycles;
    in.analog_count = ROBUROC4_MAX_ANALOG_INPUTS;
    in.digital_count = 64;
    in.digital = 1ULL << 63 | 1ULL << 8;
    for (std::uint32_t at = 0; at < ROBUROC4_MAX_ANALOG_INPUTS; at++)
        in.analog[at] = static_cast<float>(at) * 0.25F;
    std::int8_t storage[ROBUROC4_MAX_DIGITAL_INPUTS];
    roburoc4_lcm_iocard_status_t out;
    mapping_iocard(&in, &bench.client, names.get(), utime, storage, &out);
    TRAVEL(roburoc4_lcm_iocard_status_t, out, {
        expect_stamp(got);
        ASSERT_EQ(ROBUROC4_MAX_ANALOG_INPUTS, got.analog_input_count);
        ASSERT_EQ(64, got.digital_input_count);
        for (int at = 0; at < ROBUROC4_MAX_ANALOG_INPUTS; at++)
            EXPECT_EQ(static_cast<float>(at) * 0.25F, got.analog_inputs[at]);
        for (int at = 0; at < 64; at++)
            EXPECT_EQ(at == 8 || at == 63, got.digital_inputs[at]) << at;
        EXPECT_STREQ(roburoc4_client_channel_name(nullptr, ROBUROC4_IO_ANALOG_INPUT, 0),
                     got.analog_input_names[0]);
        EXPECT_STREQ("Télémètre", got.analog_input_names[1]);
        EXPECT_STREQ("", got.analog_input_names[ROBUROC4_MAX_ANALOG_INPUTS - 1]);
        EXPECT_STREQ("T", got.digital_input_names[63]);
        EXPECT_STREQ(
            roburoc4_client_channel_name(nullptr, ROBUROC4_IO_DIGITAL_INPUT, ROBUROC4_DI_PAD_A),
            got.digital_input_names[8]);
    });
}

TEST(LcmMapping, PoseIsXForwardYLeftInTheMainFrame) {
    roburoc4_localization_status in{};
    roburoc4_differential_status speeds{};
    in.x_m = 2.0;
    in.y_m = -3.0;
    in.theta_rad = M_PI / 6;
    speeds.current_linear_m_s = 0.5F;
    speeds.current_angular_rad_s = 0.25F;
    bot_core_pose_t out;
    mapping_pose(&in, &speeds, utime, &out);
    TRAVEL(bot_core_pose_t, out, {
        EXPECT_EQ(utime, got.utime);
        EXPECT_EQ(2.0, got.pos[0]);
        EXPECT_EQ(-3.0, got.pos[1]);
        EXPECT_EQ(0.0, got.pos[2]);
        EXPECT_NEAR(std::cos(M_PI / 12), got.orientation[0], 1e-12);
        EXPECT_EQ(0.0, got.orientation[1]);
        EXPECT_EQ(0.0, got.orientation[2]);
        EXPECT_NEAR(std::sin(M_PI / 12), got.orientation[3], 1e-12);
        EXPECT_NEAR(0.5 * std::sqrt(0.75), got.vel[0], 1e-12);
        EXPECT_NEAR(0.25, got.vel[1], 1e-12);
        EXPECT_EQ(0.25, got.rotation_rate[2]);
    });
    mapping_pose(&in, nullptr, utime, &out);
    EXPECT_EQ(0.0, out.vel[1]);
}

TEST(LcmMapping, PropertiesAreThoseOfTheRobotAndFitTheBuffer) {
    ScriptedRobot robot;
    robot.iocard.analog_outputs = ROBUROC4_MAX_ANALOG_OUTPUTS + 2;
    Bench bench(robot);
    bench.armed();
    auto names = std::make_unique<mapping_names>();
    auto storage = std::make_unique<mapping_services>();
    char address[] = "10.0.0.1:60000";
    roburoc4_lcm_robot_properties_t out;
    roburoc4_config config = default_config();
    config.max_linear_m_s = 0.75F;
    config.max_angular_rad_s = 1.25F;
    config.scale_linear = 0.9F;
    config.scale_angular = 1.1F;
    mapping_properties(&bench.client, &config, names.get(), address, utime, storage.get(), &out);
    roburoc4_differential_properties differential;
    roburoc4_iocard_properties card;
    roburoc4_battery_properties battery;
    ASSERT_EQ(0, roburoc4_client_battery_properties(&bench.client, &battery));
    ASSERT_EQ(0, roburoc4_client_differential_properties(&bench.client, &differential));
    ASSERT_EQ(0, roburoc4_client_iocard_properties(&bench.client, &card));
    TRAVEL(roburoc4_lcm_robot_properties_t, out, {
        EXPECT_STREQ("10.0.0.1:60000", got.robot);
        EXPECT_EQ(0.75F, got.ceiling_linear_m_s);
        EXPECT_EQ(1.25F, got.ceiling_angular_rad_s);
        EXPECT_EQ(0.9F, got.scale_linear);
        EXPECT_EQ(1.1F, got.scale_angular);
        EXPECT_TRUE(got.differential_known);
        EXPECT_EQ(differential.max_linear_m_s, got.max_linear_m_s);
        EXPECT_EQ(differential.min_linear_m_s, got.min_linear_m_s);
        EXPECT_EQ(differential.max_angular_rad_s, got.max_angular_rad_s);
        EXPECT_EQ(differential.min_angular_rad_s, got.min_angular_rad_s);
        EXPECT_EQ(differential.max_linear_m_s2, got.max_linear_m_s2);
        EXPECT_EQ(differential.min_linear_m_s2, got.min_linear_m_s2);
        EXPECT_EQ(differential.max_angular_rad_s2, got.max_angular_rad_s2);
        EXPECT_EQ(differential.min_angular_rad_s2, got.min_angular_rad_s2);
        EXPECT_EQ(differential.width_m, got.width_m);
        EXPECT_TRUE(got.battery_known && got.localization_known && got.telemeter_known);
        EXPECT_EQ(robot.localization.x_m, got.power_on_x_m);
        EXPECT_EQ(robot.localization.y_m, got.power_on_y_m);
        EXPECT_EQ(robot.localization.theta_rad, got.power_on_theta_rad);
        EXPECT_EQ(robot.localization.flags, got.power_on_flags);
        EXPECT_EQ(battery.nominal_voltage_v, got.nominal_voltage_v);
        EXPECT_EQ(battery.capacity_ah, got.capacity_ah);
        EXPECT_EQ(battery.minimum_percent, got.minimum_percent);
        ASSERT_EQ(2, got.telemeter_count);
        for (std::uint32_t at = 0; at < 2; at++) {
            roburoc4_telemeter known;
            ASSERT_EQ(0, roburoc4_client_telemeter(&bench.client, at, &known));
            EXPECT_EQ(known.x_m, got.telemeters[at].x_m);
            EXPECT_EQ(known.max_distance_m, got.telemeters[at].max_distance_m);
        }
        EXPECT_TRUE(got.iocard_known);
        EXPECT_EQ(card.analog_inputs, got.analog_input_count);
        EXPECT_EQ(ROBUROC4_MAX_ANALOG_OUTPUTS, got.analog_output_count) << "what is stored";
        EXPECT_EQ(card.digital_inputs, got.digital_input_count);
        EXPECT_STREQ("Front bumper", got.digital_input_names[ROBUROC4_DI_FRONT_BUMPER]);
        EXPECT_EQ(card.digital_outputs, got.digital_output_count);
        ASSERT_EQ(static_cast<std::int32_t>(service_count(&bench.client)), got.service_count);
        for (int at = 0; at < got.service_count; at++) {
            if (got.service_ids[at] == ROBUROC4_SERVICE_DIFFERENTIAL) {
                EXPECT_STREQ("Differential", got.service_names[at]);
            }
        }
    });
    for (auto &text : names->text)
        std::memset(text, 'n', sizeof text - 1);
    out.analog_input_count = ROBUROC4_MAX_ANALOG_INPUTS;
    out.analog_output_count = ROBUROC4_MAX_ANALOG_OUTPUTS;
    out.digital_input_count = ROBUROC4_MAX_DIGITAL_INPUTS;
    out.digital_output_count = ROBUROC4_MAX_DIGITAL_OUTPUTS;
    out.telemeter_count = ROBUROC4_MAX_TELEMETERS;
    out.service_count = ROBUROC4_MAX_SERVICES;
    for (int at = 0; at < ROBUROC4_MAX_SERVICES; at++)
        storage->list[at] = names->text[at];
    EXPECT_LE(roburoc4_lcm_robot_properties_t_encoded_size(&out), MAPPING_MAX_ENCODED);
}

TEST(LcmMapping, StatisticsHaveEveryCountUnderItsCause) {
    View v;
    v.gate.taken[GATE_DRIVE] = 101;
    v.gate.taken[GATE_RELOCALIZE] = 102;
    v.gate.taken[GATE_OUTPUT] = 103;
    v.gate.taken[GATE_STOP] = 104;
    for (int cause = 0; cause < GATE_VERDICTS; cause++)
        v.gate.rejected[cause] = 200 + cause;
    v.view.superseded = 301;
    v.view.clamped = 302;
    v.view.published = 303;
    v.view.publish_errors = 304;
    v.view.times_lost = 305;
    v.view.reboots = 306;
    v.link.round_trip_us = 401;
    v.link.round_trip_min_us = 402;
    v.link.received = 404;
    v.link.lost = 405;
    v.link.loss = 0.5F;
    TRAVEL(roburoc4_lcm_bridge_statistics_t, v.statistics(), {
        EXPECT_EQ(101, got.accepted_drive);
        EXPECT_EQ(102, got.accepted_relocalize);
        EXPECT_STREQ("10.0.0.1:60000", got.robot);
        EXPECT_EQ(103, got.accepted_output);
        EXPECT_EQ(104, got.accepted_stop);
        EXPECT_EQ(200 + GATE_MALFORMED, got.rejected_malformed);
        EXPECT_EQ(200 + GATE_DISABLED, got.rejected_disabled);
        EXPECT_EQ(200 + GATE_SENDER, got.rejected_sender);
        EXPECT_EQ(200 + GATE_NO_UTIME, got.rejected_no_utime);
        EXPECT_EQ(200 + GATE_NOT_FINITE, got.rejected_not_finite);
        EXPECT_EQ(200 + GATE_STARTING, got.rejected_starting);
        EXPECT_EQ(200 + GATE_TOO_OLD, got.rejected_too_old);
        EXPECT_EQ(200 + GATE_IN_FUTURE, got.rejected_in_future);
        EXPECT_EQ(200 + GATE_REPEATED, got.rejected_repeated);
        EXPECT_EQ(200 + GATE_CONTROL, got.rejected_control);
        EXPECT_EQ(200 + GATE_NOT_READY, got.rejected_not_ready);
        EXPECT_EQ(200 + GATE_DISARMED, got.rejected_disarmed);
        EXPECT_EQ(200 + GATE_IMPOSSIBLE, got.rejected_impossible);
        EXPECT_EQ(200 + GATE_UNITS, got.rejected_units);
        EXPECT_EQ(301, got.superseded);
        EXPECT_EQ(302, got.clamped);
        EXPECT_EQ(303, got.published);
        EXPECT_EQ(304, got.publish_errors);
        EXPECT_EQ(305, got.times_lost);
        EXPECT_EQ(306, got.reboots);
        EXPECT_EQ(401, got.round_trip_us);
        EXPECT_EQ(402, got.round_trip_min_us);
        EXPECT_EQ(404, got.received);
        EXPECT_EQ(405, got.lost);
        EXPECT_EQ(0.5F, got.loss);
    });
}

TEST(LcmMapping, StateHasTheBridgeAndItsRules) {
    View v;
    v.link.silence_us = 403;
    v.facts.relocalize_result = ROBUROC4_ERR_TIMEOUT;
    TRAVEL(roburoc4_lcm_bridge_state_t, v.state(), {
        EXPECT_STREQ("10.0.0.1:60000", got.robot);
        EXPECT_STREQ("lab 17", got.bridge);
        EXPECT_EQ(utime - 10000000, got.started_utime);
        EXPECT_EQ(403, got.silence_us);
        EXPECT_TRUE(got.can_drive);
        EXPECT_EQ(300000, got.lease_us);
        EXPECT_EQ(200000, got.max_age_us);
        EXPECT_EQ(ROBUROC4_VERSION, got.version);
        EXPECT_EQ(ROBUROC4_ERR_TIMEOUT, got.relocalize_result);
        EXPECT_TRUE(got.drive_enabled);
        EXPECT_FALSE(got.outputs_enabled);
        EXPECT_FALSE(got.relocalize_enabled);
    });
}

TEST(LcmMapping, StateNamesWhoStoppedTheRobot) {
    View v;
    gate_stop(&v.gate, "operator", 8, v.view.now.us);
    const roburoc4_lcm_bridge_state_t state = v.state();
    EXPECT_TRUE(state.stop_latched && state.awaiting_pause);
    EXPECT_FALSE(state.can_drive);
    EXPECT_STREQ("operator", state.stopped_by);
    EXPECT_NE(std::string::npos, v.message().find("stopped by operator; all senders must pause"));
    v.view.now.us += GATE_PAUSE_US;
    EXPECT_EQ("stopped by operator; the next command drives", v.message());
    v.gate.stopped = false;
    EXPECT_STREQ("", v.state().stopped_by);
}

TEST(LcmMapping, StateNamesTheDriverOrTheReason) {
    View v;
    EXPECT_STREQ("", v.state().control_owner);
    EXPECT_EQ(-1, v.state().command_age_us);
    v.command("planner");
    v.view.command_us = 9999000;
    const roburoc4_lcm_bridge_state_t driving = v.state();
    EXPECT_STREQ("planner", driving.control_owner);
    EXPECT_STREQ("driving for planner", driving.message);
    EXPECT_TRUE(driving.driving && driving.armed);
    EXPECT_EQ(1000, driving.command_age_us);
    EXPECT_EQ(300000, driving.lease_left_us);
    EXPECT_EQ(0, driving.disarm_cause);
    v.facts.armed = v.facts.driving = 0;
    v.facts.disarm_cause = ROBUROC4_ERR_LOST;
    v.facts.arm_refusal = ROBUROC4_ERR_OVERRIDE;
    v.facts.override_known = v.facts.overridden = 1;
    EXPECT_EQ(ROBUROC4_ERR_LOST, v.state().disarm_cause);
    EXPECT_EQ(ROBUROC4_ERR_OVERRIDE, v.state().arm_refusal) << "what prevents it now";
    EXPECT_TRUE(v.state().override_known && v.state().overridden);
}

TEST(LcmMapping, AStopThatTheRobotDidNotConfirmIsNamed) {
    View v;
    const auto is_named = [&] {
        return v.message().find("THE STOP WAS NOT CONFIRMED") != std::string::npos;
    };
    for (const int outcome : {ROBUROC4_STOP_NONE, ROBUROC4_STOP_RUNNING, ROBUROC4_STOP_CONFIRMED}) {
        v.facts.stop_outcome = static_cast<std::uint8_t>(outcome);
        EXPECT_EQ(outcome, v.state().stop_outcome);
        EXPECT_FALSE(is_named()) << outcome;
    }
    for (const int outcome : {ROBUROC4_STOP_TIMED_OUT, ROBUROC4_STOP_OVERRIDDEN}) {
        v.facts.stop_outcome = static_cast<std::uint8_t>(outcome);
        EXPECT_EQ(outcome, v.state().stop_outcome);
        EXPECT_TRUE(is_named()) << outcome;
    }
    v.facts.state = ROBUROC4_STATE_LOST;
    EXPECT_TRUE(is_named()) << "also of a robot that has fallen silent";
    v.view.other_bridge = true;
    EXPECT_NE(std::string::npos, v.message().find("ANOTHER BRIDGE"));
    v.facts.state = ROBUROC4_STATE_READY;
    v.facts.driving = 1;
    EXPECT_FALSE(is_named()) << "it was driven since";
}

TEST(LcmMapping, StateTellsWhatIsNotKnownFromWhatIsNot) {
    View v;
    v.facts.front_bumper_known = 1;
    v.facts.battery_known = 1;
    v.facts.lapsed = 1;
    v.facts.missing = 1 << ROBUROC4_SERVICE_TELEMETER;
    TRAVEL(roburoc4_lcm_bridge_state_t, v.state(), {
        EXPECT_TRUE(got.front_bumper_known);
        EXPECT_FALSE(got.rear_bumper_known);
        EXPECT_TRUE(got.battery_known);
        EXPECT_TRUE(got.lapsed);
        EXPECT_EQ(ROBUROC4_LCM_BRIDGE_STATE_T_MISSING_TELEMETER, got.missing);
    });
    v.facts.front_bumper_known = 0;
    v.facts.rear_bumper_known = 1;
    EXPECT_FALSE(v.state().front_bumper_known);
    EXPECT_TRUE(v.state().rear_bumper_known);
}

TEST(LcmMapping, StateHasABitForEachProblem) {
    const struct {
        std::uint32_t fault;
        std::int32_t bit;
    } faults[] = {{ROBUROC4_FAULT_NONE, 0},
                  {ROBUROC4_FAULT_REFUSED, ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_REFUSED},
                  {ROBUROC4_FAULT_UNREACHABLE, ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_UNREACHABLE},
                  {ROBUROC4_FAULT_DOWN, ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_DOWN},
                  {ROBUROC4_FAULT_DENIED, ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_DENIED},
                  {ROBUROC4_FAULT_FULL, ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_FULL},
                  {ROBUROC4_FAULT_OTHER, ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_OTHER}};
    for (const auto &each : faults) {
        View v;
        v.view.fault = each.fault;
        EXPECT_EQ(each.bit, v.state().problems);
    }
    View v;
    v.facts.other_commander = v.facts.inhibited = v.facts.front_bumper = v.facts.rear_bumper =
        v.facts.battery_low = 1;
    v.link.silence_us = 1000000;
    v.view.no_socket = v.view.other_bridge = true;
    EXPECT_EQ(ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_SOCKET |
                  ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_OTHER_BRIDGE |
                  ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_OTHER_COMMANDER |
                  ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_INHIBITED |
                  ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_FRONT_BUMPER |
                  ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_REAR_BUMPER |
                  ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_BATTERY_LOW |
                  ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_SILENT,
              v.state().problems);
    View pressed;
    pressed.facts.front_bumper = 1;
    EXPECT_EQ(ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_FRONT_BUMPER, pressed.state().problems);
}

TEST(LcmMapping, TheMessageSaysWhatToDo) {
    View v;
    EXPECT_EQ("ready; the next command drives", v.message());
    v.facts.armed = 0;
    for (const std::int32_t cause : {ROBUROC4_ERR_DISARMED, ROBUROC4_ERR_STOP_CALLED}) {
        v.facts.disarm_cause = cause;
        EXPECT_EQ("ready; the next command drives", v.message()) << "as somebody wanted";
    }
    gate_hold(&v.gate, v.view.now.us);
    v.facts.disarm_cause = ROBUROC4_ERR_OVERRIDE;
    EXPECT_NE(std::string::npos, v.message().find("pause")) << v.message();
    v.view.now.us += GATE_PAUSE_US;
    EXPECT_NE(std::string::npos, v.message().find("next command")) << v.message();
    v.facts.arm_refusal = ROBUROC4_ERR_OVERRIDE;
    EXPECT_NE(std::string::npos, v.message().find("[A]")) << v.message();
    v.gate.rules.enabled[GATE_DRIVE] = false;
    EXPECT_NE(std::string::npos, v.message().find("--enable-drive")) << v.message();
    v.facts.state = ROBUROC4_STATE_CONNECTING;
    v.view.heard = false;
    EXPECT_NE(std::string::npos, v.message().find("10.0.0.1:60000")) << v.message();
    EXPECT_EQ(-1, v.state().silence_us);
    for (std::uint32_t fault = 0; fault <= ROBUROC4_FAULT_OTHER; fault++) {
        v.view.fault = fault;
        EXPECT_LT(v.message().size(), MAPPING_MESSAGE_SIZE - 20U) << "not cut";
    }
    v.view.no_socket = v.view.other_bridge = true;
    EXPECT_NE(std::string::npos, v.message().find("no socket for 10.0.0.1:60000")) << v.message();
    EXPECT_NE(std::string::npos, v.message().find("ANOTHER BRIDGE")) << v.message();
    v.view.no_address = true;
    EXPECT_NE(std::string::npos, v.message().find("has no address; correct it")) << v.message();
    EXPECT_EQ(std::string::npos, v.message().find("retrying")) << v.message();
    v.view.other_bridge = false;
    v.facts.state = ROBUROC4_STATE_CLOSING;
    EXPECT_EQ("the bridge is ending", v.message());
    v.facts.state = ROBUROC4_STATE_IDLE;
    EXPECT_EQ("the bridge has ended", v.message());
}

TEST(LcmMappingBridge, CausesOfRejectionsAreTheGates) {
#define CAUSE(name) EXPECT_EQ(GATE_##name, ROBUROC4_LCM_BRIDGE_STATE_T_REJECTED_##name)
    CAUSE(MALFORMED);
    CAUSE(DISABLED);
    CAUSE(SENDER);
    CAUSE(NO_UTIME);
    CAUSE(NOT_FINITE);
    CAUSE(STARTING);
    CAUSE(TOO_OLD);
    CAUSE(IN_FUTURE);
    CAUSE(REPEATED);
    CAUSE(CONTROL);
    CAUSE(NOT_READY);
    CAUSE(DISARMED);
    CAUSE(IMPOSSIBLE);
    CAUSE(UNITS);
#undef CAUSE
    EXPECT_EQ(GATE_VERDICTS, ROBUROC4_LCM_BRIDGE_STATE_T_REJECTED_UNITS + 1);
}

TEST(LcmMapping, StatesAndFlagsAreNumberedAsInTheCore) {
    EXPECT_EQ(ROBUROC4_STATE_IDLE, ROBUROC4_LCM_BRIDGE_STATE_T_STATE_IDLE);
    EXPECT_EQ(ROBUROC4_STATE_CONNECTING, ROBUROC4_LCM_BRIDGE_STATE_T_STATE_CONNECTING);
    EXPECT_EQ(ROBUROC4_STATE_DISCOVERING, ROBUROC4_LCM_BRIDGE_STATE_T_STATE_DISCOVERING);
    EXPECT_EQ(ROBUROC4_STATE_SUBSCRIBING, ROBUROC4_LCM_BRIDGE_STATE_T_STATE_SUBSCRIBING);
    EXPECT_EQ(ROBUROC4_STATE_READY, ROBUROC4_LCM_BRIDGE_STATE_T_STATE_READY);
    EXPECT_EQ(ROBUROC4_STATE_LOST, ROBUROC4_LCM_BRIDGE_STATE_T_STATE_LOST);
    EXPECT_EQ(ROBUROC4_STATE_CLOSING, ROBUROC4_LCM_BRIDGE_STATE_T_STATE_CLOSING);
#define ENDS(name) EXPECT_EQ(ROBUROC4_MOVE_##name, ROBUROC4_LCM_MOVE_STATUS_T_OUTCOME_##name)
    ENDS(RUNNING);
    ENDS(REACHED);
    ENDS(OVERRIDE);
    ENDS(BUMPER);
    ENDS(OBSTACLE);
    ENDS(INHIBITED);
    ENDS(LOST);
    ENDS(OTHER_COMMANDER);
    ENDS(TIMEOUT);
    ENDS(CANCELLED);
    ENDS(LAPSED);
#undef ENDS
#define SAME(core, lcm) EXPECT_EQ(ROBUROC4_##core, ROBUROC4_LCM_BRIDGE_STATE_T_##lcm)
    SAME(STOP_NONE, STOP_NONE);
    SAME(STOP_RUNNING, STOP_RUNNING);
    SAME(STOP_CONFIRMED, STOP_CONFIRMED);
    SAME(STOP_TIMED_OUT, STOP_TIMED_OUT);
    SAME(STOP_OVERRIDDEN, STOP_OVERRIDDEN);
#undef SAME
#define MISSES(service)                                                                            \
    EXPECT_EQ(1 << ROBUROC4_SERVICE_##service, ROBUROC4_LCM_BRIDGE_STATE_T_MISSING_##service)
    MISSES(IOCARD);
    MISSES(TELEMETER);
    MISSES(BATTERY);
    MISSES(LOCALIZATION);
    MISSES(DIFFERENTIAL);
#undef MISSES
    EXPECT_EQ(ROBUROC4_BATTERY_CHARGING, ROBUROC4_LCM_BATTERY_STATUS_T_STATE_CHARGING);
    EXPECT_EQ(ROBUROC4_BATTERY_CHARGED, ROBUROC4_LCM_BATTERY_STATUS_T_STATE_CHARGED);
    EXPECT_EQ(ROBUROC4_BATTERY_OK, ROBUROC4_LCM_BATTERY_STATUS_T_STATE_OK);
    EXPECT_EQ(ROBUROC4_BATTERY_CRITICAL, ROBUROC4_LCM_BATTERY_STATUS_T_STATE_CRITICAL);
    EXPECT_EQ(ROBUROC4_LOCALIZATION_INVALID, ROBUROC4_LCM_LOCALIZATION_STATUS_T_FLAG_INVALID);
    EXPECT_EQ(ROBUROC4_LOCALIZATION_METRIC, ROBUROC4_LCM_LOCALIZATION_STATUS_T_FLAG_METRIC);
    EXPECT_EQ(ROBUROC4_LOCALIZATION_DECIMETRIC, ROBUROC4_LCM_LOCALIZATION_STATUS_T_FLAG_DECIMETRIC);
    EXPECT_EQ(ROBUROC4_LOCALIZATION_CENTIMETRIC,
              ROBUROC4_LCM_LOCALIZATION_STATUS_T_FLAG_CENTIMETRIC);
    EXPECT_EQ(ROBUROC4_LOCALIZATION_PROPRIOCEPTIVE,
              ROBUROC4_LCM_LOCALIZATION_STATUS_T_FLAG_PROPRIOCEPTIVE);
    EXPECT_EQ(ROBUROC4_LOCALIZATION_EXTEROCEPTIVE,
              ROBUROC4_LCM_LOCALIZATION_STATUS_T_FLAG_EXTEROCEPTIVE);
    EXPECT_EQ(ROBUROC4_LOCALIZATION_ERROR, ROBUROC4_LCM_LOCALIZATION_STATUS_T_FLAG_ERROR);
}
