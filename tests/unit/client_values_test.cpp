/* SPDX-License-Identifier: MIT
 *
 * Accessors: latest values and their events, properties, texts, roles of inputs, battery.
 */
#include <algorithm>
#include <cmath>
#include <cstring>

#include "client_bench.h"

using namespace roburoc4_tests;

namespace {

roburoc4_result role(const Bench &bench, std::uint32_t role) {
    return roburoc4_client_role_index(&bench.client, role);
}

Bytes longer(Bytes bytes, std::size_t by) {
    bytes.resize(bytes.size() + by, 0xAB);
    return bytes;
}

/** Ids that are not the manual's. */
void renumber(ScriptedRobot &robot) {
    for (ScriptedService &service : robot.services)
        service.id =
            static_cast<std::uint16_t>(service.kind < 2 ? service.kind : 0x1230 + service.kind);
}

/** The accessor returns these bytes, whatever was in its memory before. The structs have no gaps.
 */
template <typename T, typename Getter> void expect_all(const T &expected, Getter getter) {
    T given;
    memset(&given, 0xA5, sizeof given);
    ASSERT_EQ(ROBUROC4_OK, getter(&given));
    const auto bytes = [](const T &of) {
        const auto *from = reinterpret_cast<const std::uint8_t *>(&of);
        return to_hex(Bytes(from, from + sizeof of));
    };
    EXPECT_EQ(bytes(expected), bytes(given));
}

/** Each property that the client returns is the robot's. */
void expect_properties(const Bench &bench, const ScriptedRobot &robot) {
    const roburoc4_client *client = &bench.client;
    expect_all(robot.iocard, [&](roburoc4_iocard_properties *out) {
        return roburoc4_client_iocard_properties(client, out);
    });
    expect_all(robot.battery, [&](roburoc4_battery_properties *out) {
        return roburoc4_client_battery_properties(client, out);
    });
    expect_all(robot.localization, [&](roburoc4_localization_properties *out) {
        return roburoc4_client_localization_properties(client, out);
    });
    expect_all(robot.differential, [&](roburoc4_differential_properties *out) {
        return roburoc4_client_differential_properties(client, out);
    });
    ASSERT_EQ(robot.telemeters.size(), telemeter_count(client));
    for (std::uint32_t i = 0; i < robot.telemeters.size(); i++) {
        roburoc4_telemeter telemeter = robot.telemeters[i];
        telemeter.distance_m = robot.distances[i]; /* the latest status's */
        expect_all(telemeter, [&](roburoc4_telemeter *out) {
            return roburoc4_client_telemeter(client, i, out);
        });
    }
}

/** A service's latest status in the client, as bytes. */
std::string value_of(const Bench &bench, std::uint32_t service) {
    const auto bytes = [](auto getter, auto out) {
        EXPECT_EQ(ROBUROC4_OK, getter(&out));
        const auto *from = reinterpret_cast<const std::uint8_t *>(&out);
        return to_hex(Bytes(from, from + sizeof out));
    };
    const roburoc4_client *client = &bench.client;
    switch (service) {
    case ROBUROC4_SERVICE_IOCARD:
        return bytes([&](auto *out) { return roburoc4_client_inputs(client, out, nullptr); },
                     roburoc4_inputs{});
    case ROBUROC4_SERVICE_TELEMETER:
        return bytes([&](auto *out) { return roburoc4_client_distances(client, out, nullptr); },
                     roburoc4_distances{});
    case ROBUROC4_SERVICE_BATTERY:
        return bytes([&](auto *out) { return roburoc4_client_battery(client, out, nullptr); },
                     roburoc4_battery_status{});
    case ROBUROC4_SERVICE_LOCALIZATION:
        return bytes([&](auto *out) { return roburoc4_client_localization(client, out, nullptr); },
                     roburoc4_localization_status{});
    default:
        return bytes([&](auto *out) { return roburoc4_client_differential(client, out, nullptr); },
                     roburoc4_differential_status{});
    }
}

} // namespace

TEST(Sizes, OfAnOlderProgramGetTheFieldsThatItKnows) {
    Ready bench;
    roburoc4_facts facts;
    std::memset(&facts, 0xFF, sizeof facts);
    facts.size = offsetof(roburoc4_facts, armed);
    EXPECT_EQ(ROBUROC4_OK, roburoc4_client_facts(&bench.client, bench.client_us(), &facts));
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), facts.state);
    EXPECT_EQ(0xFF, facts.armed) << "beyond the program's struct nothing is written";
    for (const std::size_t wrong : {std::size_t{0}, std::size_t{4}, sizeof facts + 4}) {
        facts.size = static_cast<std::uint32_t>(wrong);
        EXPECT_EQ(ROBUROC4_ERR_SIZE,
                  roburoc4_client_facts(&bench.client, bench.client_us(), &facts));
    }
    EXPECT_EQ(ROBUROC4_OK,
              roburoc4_client_facts(&bench.client, bench.client_us(), ROBUROC4_SIZED(&facts)));
}

TEST(Value, IsUnknownBeforeTheFirstStatus) {
    RobotBench bench;
    roburoc4_battery_status battery;
    roburoc4_localization_status pose;
    roburoc4_differential_status speeds;
    roburoc4_inputs inputs;
    roburoc4_distances distances;
    std::uint64_t host_us = 7;
    bench.start();
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, roburoc4_client_battery(&bench.client, &battery, &host_us));
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, roburoc4_client_localization(&bench.client, &pose, &host_us));
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN,
              roburoc4_client_differential(&bench.client, &speeds, &host_us));
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, roburoc4_client_inputs(&bench.client, &inputs, &host_us));
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN,
              roburoc4_client_distances(&bench.client, &distances, &host_us));
    EXPECT_EQ(7U, host_us);
}

TEST(Value, IsExactlyWhatTheStatusReported) {
    ScriptedRobot robot;
    renumber(robot);
    robot.follows = false;
    robot.target_linear = 0.125F;
    robot.current_linear = -0.25F;
    robot.target_angular = 0.5F;
    robot.current_angular = -1;
    robot.pose = {1.5, -2.5, 3.125};
    robot.digital = 0x2A5A5A;
    for (std::size_t i = 0; i < robot.analog.size(); i++)
        robot.analog[i] = 0.5F + static_cast<float>(i);
    Ready bench(robot);
    std::uint64_t host_us = 0;
    Bytes bytes;
    const auto receive = [&](std::uint32_t service) {
        bench.now_us += 100;
        bytes = robot.status_at(service, robot.cycles() + 1);
        EXPECT_EQ(0, bench.receive(bytes));
        host_us = 0;
    };

    receive(ROBUROC4_SERVICE_BATTERY);
    roburoc4_battery_status battery;
    ASSERT_EQ(0, roburoc4_decode_battery_status(bytes.data(), bytes.size(), &battery));
    expect_all(battery, [&](roburoc4_battery_status *out) {
        return roburoc4_client_battery(&bench.client, out, &host_us);
    });
    EXPECT_EQ(bench.now_us, host_us);

    receive(ROBUROC4_SERVICE_LOCALIZATION);
    roburoc4_localization_status pose;
    ASSERT_EQ(0, roburoc4_decode_localization_status(bytes.data(), bytes.size(), &pose));
    expect_all(pose, [&](roburoc4_localization_status *out) {
        return roburoc4_client_localization(&bench.client, out, &host_us);
    });
    EXPECT_EQ(bench.now_us, host_us);

    receive(ROBUROC4_SERVICE_DIFFERENTIAL);
    roburoc4_differential_status speeds;
    ASSERT_EQ(0, roburoc4_decode_differential_status(bytes.data(), bytes.size(), &speeds));
    expect_all(speeds, [&](roburoc4_differential_status *out) {
        return roburoc4_client_differential(&bench.client, out, &host_us);
    });
    EXPECT_EQ(bench.now_us, host_us);

    receive(ROBUROC4_SERVICE_IOCARD);
    roburoc4_inputs inputs{robot.cycles() + 1, robot.digital, {}, 9, 22};
    std::copy(robot.analog.begin(), robot.analog.end(), inputs.analog);
    expect_all(inputs, [&](roburoc4_inputs *out) {
        return roburoc4_client_inputs(&bench.client, out, &host_us);
    });
    EXPECT_EQ(bench.now_us, host_us);

    receive(ROBUROC4_SERVICE_TELEMETER);
    const roburoc4_distances distances{robot.cycles() + 1, {1.5F, 2.5F}, 2, 0};
    expect_all(distances, [&](roburoc4_distances *out) {
        return roburoc4_client_distances(&bench.client, out, &host_us);
    });
    EXPECT_EQ(bench.now_us, host_us);
}

TEST(Value, IsChangedByTheStatusesOfItsServiceOnly) {
    ScriptedRobot robot;
    robot.follows = false;
    Ready bench(robot);
    robot.digital = 0x2A0003;
    robot.analog.assign(9, 3.5F);
    robot.distances = {5.5F, 6.5F};
    robot.battery_state = ROBUROC4_BATTERY_CHARGED;
    robot.battery_percent = 99;
    robot.pose = {1.5, -2.5, 3.125};
    robot.target_linear = robot.current_linear = 0.5F;
    robot.target_angular = robot.current_angular = -0.5F;
    for (std::uint32_t received = 2; received < ROBUROC4_SERVICE_COUNT; received++) {
        std::array<std::string, ROBUROC4_SERVICE_COUNT> before;
        for (std::uint32_t service = 2; service < ROBUROC4_SERVICE_COUNT; service++)
            before[service] = value_of(bench, service);
        EXPECT_EQ(0, bench.receive(robot.status_at(received, robot.cycles() + 1)));
        for (std::uint32_t service = 2; service < ROBUROC4_SERVICE_COUNT; service++)
            EXPECT_EQ(service != received, before[service] == value_of(bench, service))
                << received << " " << service;
    }
}

TEST(Value, RaisesTheEventOfItsServiceAndNoOther) {
    Ready bench;
    const std::uint32_t all = ROBUROC4_EVENT_IOCARD | ROBUROC4_EVENT_TELEMETER |
                              ROBUROC4_EVENT_BATTERY | ROBUROC4_EVENT_LOCALIZATION |
                              ROBUROC4_EVENT_DIFFERENTIAL;
    for (std::uint32_t service = 2; service < 7; service++) {
        EXPECT_EQ(0, bench.receive(bench.robot.status_at(service, bench.robot.cycles() + 1)));
        EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_EVENT_IOCARD) << (service - 2),
                  bench.take_events() & all);
    }
}

TEST(Value, OfALongerStatusIsUsedAndTheSurplusCounted) {
    Ready bench;
    bench.robot.battery_percent = 33;
    EXPECT_EQ(2, bench.receive(longer(bench.robot.status_at(4, bench.robot.cycles() + 1), 2)));
    EXPECT_EQ(1, bench.receive(longer(bench.robot.status_at(2, bench.robot.cycles() + 1), 1)));
    EXPECT_EQ(2U, bench.count(ROBUROC4_COUNT_SURPLUS));
    roburoc4_battery_status battery;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_battery(&bench.client, &battery, nullptr));
    EXPECT_EQ(33, battery.remaining_percent);
}

TEST(Value, SurvivesAShorterStatus) {
    ScriptedRobot robot;
    Ready bench(robot);
    const auto before = bench.client.private_values;
    robot.battery_percent = 1;
    robot.pose = {9, 9, 9};
    robot.digital = 0x100;
    robot.target_linear = robot.current_linear = 9;
    for (const std::uint32_t service : {2U, 4U, 5U, 6U}) {
        const Bytes good = robot.status_at(service, robot.cycles() + 1);
        for (std::size_t size = 0; size < good.size(); size++)
            EXPECT_EQ(ROBUROC4_ERR_SHORT,
                      bench.receive(Bytes(good.begin(), good.begin() + static_cast<long>(size))))
                << service << " " << size;
    }
    EXPECT_EQ(0, memcmp(&before, &bench.client.private_values, sizeof before));
    EXPECT_EQ(50U + 13U + 39U + 27U, bench.count(ROBUROC4_COUNT_SHORT));
    EXPECT_EQ(0U, bench.take_events() & ~static_cast<std::uint32_t>(ROBUROC4_EVENT_STATE));
}

TEST(Value, SurvivesAStatusThatIsNotNewer) {
    Ready bench;
    roburoc4_battery_status battery;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_battery(&bench.client, &battery, nullptr));
    bench.robot.battery_percent = 5;
    EXPECT_EQ(ROBUROC4_ERR_OLD, bench.receive(bench.robot.status_at(4, battery.robot_cycles)));
    EXPECT_EQ(ROBUROC4_ERR_OLD, bench.receive(bench.robot.status_at(4, battery.robot_cycles - 1)));
    EXPECT_EQ(2U, bench.count(ROBUROC4_COUNT_OLD));
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_battery(&bench.client, &battery, nullptr));
    EXPECT_EQ(80, battery.remaining_percent);
    EXPECT_EQ(0U, bench.take_events());
}

TEST(Value, OfAServiceWithoutSubscriptionIsCountedAndNotUsed) {
    roburoc4_config config = default_config();
    config.subscriptions &= ~(1U << ROBUROC4_SERVICE_BATTERY);
    Ready bench(config);
    EXPECT_EQ(ROBUROC4_ERR_UNEXPECTED_STATUS, bench.receive(bench.robot.status(4)));
    EXPECT_EQ(ROBUROC4_ERR_UNEXPECTED_STATUS,
              bench.receive(from_hex("FF 99 00 01 00 00 00 00 00 00 00")));
    EXPECT_EQ(2U, bench.count(ROBUROC4_COUNT_UNEXPECTED_STATUS));
    roburoc4_battery_status battery;
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, roburoc4_client_battery(&bench.client, &battery, nullptr));
}

/* ---- properties ---- */

TEST(Telemeter, HasTheDistanceOfItsPropertiesBeforeAStatus) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_TELEMETER).mute = true;
    Ready bench(robot);
    roburoc4_telemeter telemeter;
    roburoc4_distances distances;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_telemeter(&bench.client, 1, &telemeter));
    EXPECT_EQ(robot.telemeters[1].distance_m, telemeter.distance_m);
    EXPECT_LT(roburoc4_client_distances(&bench.client, &distances, nullptr), 0);
    robot.service(ROBUROC4_SERVICE_TELEMETER).mute = false;
    robot.distances = {3.5F, 4.5F};
    bench.run(second);
    for (int i = 0; i < 1000; i++) { /* more properties come between the statuses */
        bench.run(10 * ms);
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_telemeter(&bench.client, 1, &telemeter));
        ASSERT_EQ(4.5F, telemeter.distance_m);
    }
}

TEST(Telemeter, StatusesCountThemWhilePropertiesAreNotKnown) {
    ScriptedRobot robot;
    robot.instead = [](const roburoc4_request &r, std::vector<Bytes> &) {
        return r.action == ROBUROC4_ACTION_GET && r.service == ROBUROC4_SERVICE_TELEMETER;
    };
    robot.distances = {1, 2, 3};
    Ready bench(robot);
    bench.run(second);
    roburoc4_distances distances;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_distances(&bench.client, &distances, nullptr));
    EXPECT_EQ(3U, distances.count);
}

TEST(Telemeter, WithoutADistanceInTheStatusesHasNone) {
    ScriptedRobot robot;
    robot.distances = {3.5F};
    Ready bench(robot);
    bench.run(second);
    roburoc4_telemeter telemeter;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_telemeter(&bench.client, 0, &telemeter));
    EXPECT_EQ(3.5F, telemeter.distance_m);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_telemeter(&bench.client, 1, &telemeter));
    EXPECT_TRUE(std::isnan(telemeter.distance_m)) << "not that of its properties";
}

TEST(Properties, AreUnknownFirstThenTheRobots) {
    RobotBench bench;
    roburoc4_iocard_properties io;
    roburoc4_battery_properties battery;
    roburoc4_localization_properties pose;
    roburoc4_differential_properties drive;
    roburoc4_telemeter telemeter;
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, roburoc4_client_iocard_properties(&bench.client, &io));
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, roburoc4_client_battery_properties(&bench.client, &battery));
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN,
              roburoc4_client_localization_properties(&bench.client, &pose));
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN,
              roburoc4_client_differential_properties(&bench.client, &drive));
    EXPECT_EQ(0U, telemeter_count(&bench.client));
    EXPECT_LT(roburoc4_client_telemeter(&bench.client, 0, &telemeter), 0);
    bench.ready();
    expect_properties(bench, bench.robot);
    for (const std::uint32_t beyond : {2U, 3U, 16U, UINT32_MAX})
        EXPECT_EQ(ROBUROC4_ERR_INDEX, roburoc4_client_telemeter(&bench.client, beyond, &telemeter));
}

TEST(Properties, ThatAreReadAgainAfterALossAreNew) {
    Ready bench;
    bench.robot.powered = false;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    bench.robot.powered = true;
    bench.take_events();
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_PROPERTIES);
}

TEST(Properties, AreExactlyWhatTheRobotReported) {
    ScriptedRobot robot;
    renumber(robot);
    robot.iocard.analog_outputs = 3;
    robot.telemeters = {{0.5F, 0.25F, 1, 0.125F, 0.75F, 6, 0}, {-1, -2, -3, 4, 5, 7, 0}};
    robot.localization = {1, 2, 3, 0x5A, 0, 0};
    robot.differential = {0.1F, 0.2F, 0.3F, 0.4F, 2.6F,  -2.5F, 6.5F, -6.25F,
                          3,    -4,   8,    -9,   0.68F, 0,     0};
    Ready bench(robot);
    expect_properties(bench, robot);
}

TEST(Properties, WithSurplusBytesAreStillWhatTheRobotReported) {
    ScriptedRobot robot;
    robot.service(ROBUROC4_SERVICE_IOCARD).get_length = 5 + 4 * 4 + 3;
    robot.service(ROBUROC4_SERVICE_TELEMETER).get_length = 5 + 4 + 2 * 28 + 3;
    robot.service(ROBUROC4_SERVICE_BATTERY).get_length = 5 + 9 + 3;
    robot.service(ROBUROC4_SERVICE_LOCALIZATION).get_length = 5 + 28 + 3;
    robot.service(ROBUROC4_SERVICE_DIFFERENTIAL).get_length = 5 + 13 * 4 + 3;
    Ready bench(robot);
    expect_properties(bench, robot);
    EXPECT_GE(bench.count(ROBUROC4_COUNT_SURPLUS), 5U);
}

TEST(Properties, OfWhichAnyFieldChangesRaiseTheEvent) {
    const std::vector<std::function<void(ScriptedRobot &)>> changes{
        [](ScriptedRobot &r) {
            r.iocard.analog_inputs++;
            r.analog.push_back(1);
        },
        [](ScriptedRobot &r) { r.iocard.analog_outputs++; },
        [](ScriptedRobot &r) { r.iocard.digital_inputs++; },
        [](ScriptedRobot &r) { r.iocard.digital_outputs++; },
        [](ScriptedRobot &r) { r.telemeters[0].x_m++; },
        [](ScriptedRobot &r) { r.telemeters[0].y_m++; },
        [](ScriptedRobot &r) { r.telemeters[0].theta_rad++; },
        [](ScriptedRobot &r) { r.telemeters[0].field_of_view_rad++; },
        [](ScriptedRobot &r) { r.telemeters[0].min_distance_m++; },
        [](ScriptedRobot &r) { r.telemeters[0].max_distance_m++; },
        [](ScriptedRobot &r) { r.telemeters[1].max_distance_m++; },
        [](ScriptedRobot &r) { r.telemeters.pop_back(); },
        [](ScriptedRobot &r) { r.telemeters.clear(); },
        [](ScriptedRobot &r) { r.battery.nominal_voltage_v++; },
        [](ScriptedRobot &r) { r.battery.capacity_ah++; },
        [](ScriptedRobot &r) { r.battery.minimum_percent++; },
        [](ScriptedRobot &r) { r.localization.x_m++; },
        [](ScriptedRobot &r) { r.localization.y_m++; },
        [](ScriptedRobot &r) { r.localization.theta_rad++; },
        [](ScriptedRobot &r) { r.localization.flags++; },
        [](ScriptedRobot &r) { r.differential.max_linear_m_s++; },
        [](ScriptedRobot &r) { r.differential.min_linear_m_s--; },
        [](ScriptedRobot &r) { r.differential.max_angular_rad_s++; },
        [](ScriptedRobot &r) { r.differential.min_angular_rad_s--; },
        [](ScriptedRobot &r) { r.differential.max_linear_m_s2++; },
        [](ScriptedRobot &r) { r.differential.min_linear_m_s2--; },
        [](ScriptedRobot &r) { r.differential.max_angular_rad_s2++; },
        [](ScriptedRobot &r) { r.differential.min_angular_rad_s2--; },
        [](ScriptedRobot &r) { r.differential.width_m++; },
    };
    ScriptedRobot robot;
    Ready bench(robot);
    const auto expect_news = [&] {
        bench.run(10 * second);
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_PROPERTIES);
        expect_properties(bench, robot);
        bench.run(10 * second);
        EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_PROPERTIES) << "news once";
    };
    for (std::size_t i = 0; i < changes.size(); i++) {
        SCOPED_TRACE(i);
        const ScriptedRobot before = robot;
        changes[i](robot);
        expect_news();
        robot.iocard = before.iocard;
        robot.analog = before.analog;
        robot.telemeters = before.telemeters;
        robot.battery = before.battery;
        robot.localization = before.localization;
        robot.differential = before.differential;
        expect_news(); /* and back */
    }
    /* facts that are only momentary are not properties */
    robot.telemeters[0].distance_m++;
    robot.differential.target_linear_m_s++;
    robot.differential.current_linear_m_s++;
    robot.differential.target_angular_rad_s++;
    robot.differential.current_angular_rad_s++;
    bench.run(10 * second);
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_PROPERTIES);
    expect_properties(bench, robot);
}

/* ---- texts ---- */

TEST(Description, IsAViewOnTheDatagramThatRaisedTheEvent) {
    ScriptedRobot robot;
    robot.iocard.analog_outputs = 3;
    std::vector<Bytes> held;
    const auto text_of = [](int io_type, std::uint32_t index) {
        return "text " + std::to_string(index) + " of list " + std::to_string(io_type);
    };
    robot.instead = [&](const roburoc4_request &r, std::vector<Bytes> &) {
        if (r.action != ROBUROC4_ACTION_QUERY)
            return false;
        const int list = r.service == ROBUROC4_SERVICE_DIRECTORY ? -1 : r.io_type;
        const std::string text = text_of(list, static_cast<std::uint32_t>(r.index));
        held.push_back(encoded([&](std::uint8_t *b, std::size_t n) {
            return roburoc4_encode_text(b, n, r.id, r.service, text.data(), text.size());
        }));
        return true;
    };
    Started bench(robot);
    std::map<int, int> texts;
    while (!held.empty()) {
        const Bytes bytes = held.front();
        held.erase(held.begin());
        bench.take_events();
        ASSERT_EQ(0, bench.receive(bytes));
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_DESCRIPTION);
        roburoc4_description d;
        ASSERT_EQ(ROBUROC4_OK,
                  roburoc4_client_description(&bench.client, bytes.data(), bytes.size(), &d));
        EXPECT_EQ(bytes.data() + 5, d.text);
        EXPECT_EQ(text_of(d.io_type, d.index),
                  std::string(reinterpret_cast<const char *>(d.text), d.length));
        texts[d.io_type]++;
        bench.pump();
    }
    EXPECT_EQ((std::map<int, int>{{-1, 7}, {0, 9}, {1, 3}, {2, 22}, {3, 8}}), texts);
    const Bytes status = robot.status(6);
    bench.receive(status);
    roburoc4_description d;
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN,
              roburoc4_client_description(&bench.client, status.data(), status.size(), &d));
}

TEST(Description, MayBeEmptyOrOfAnyBytes) {
    ScriptedRobot robot;
    robot.channel_text = [](std::uint32_t, std::uint32_t index) {
        return index % 2 == 0 ? std::string() : std::string("\0\xFF\x80 \n", 5);
    };
    Ready bench(robot);
    EXPECT_EQ(1, bench.facts().descriptions_done);
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, role(bench, ROBUROC4_ROLE_OVERRIDE)) << "none names it";
}

/* ---- roles ---- */

TEST(Role, IsFoundByText) {
    ScriptedRobot robot;
    robot.iocard.digital_inputs = 40;
    robot.channel_text = [](std::uint32_t io_type, std::uint32_t index) -> std::string {
        if (io_type == ROBUROC4_IO_ANALOG_INPUT)
            return index == 7 ? "BATTERY VOLTAGE (V)" : "?";
        const std::map<std::uint32_t, std::string> texts{
            {30, "Game pad \"A\" button"}, {31, "front bumper"}, {2, "Rear  Bumper"}};
        const auto found = texts.find(index);
        return found != texts.end() && io_type == ROBUROC4_IO_DIGITAL_INPUT ? found->second : "?";
    };
    Started bench(robot);
    ASSERT_TRUE(bench.run_until([&] { return bench.facts().descriptions_done == 1; }));
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_ROLE);
    EXPECT_EQ(30, role(bench, ROBUROC4_ROLE_OVERRIDE));
    EXPECT_EQ(31, role(bench, ROBUROC4_ROLE_FRONT_BUMPER));
    EXPECT_EQ(2, role(bench, ROBUROC4_ROLE_REAR_BUMPER));
    EXPECT_EQ(7, role(bench, ROBUROC4_ROLE_BATTERY_V));
    for (const std::uint32_t none : {4U, 5U, 32U, UINT32_MAX})
        EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, role(bench, none)) << none;
}

/* Outputs and inputs of the other type have the same texts. */
TEST(Inputs, BitsOfNoInputAreLeftOut) {
    ScriptedRobot robot; /* its 22 inputs have 24 bits */
    robot.digital = UINT64_MAX & ~(std::uint64_t{1} << ROBUROC4_DI_PAD_A);
    Ready bench(robot);
    roburoc4_inputs inputs{};
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_inputs(&bench.client, &inputs, nullptr));
    EXPECT_EQ(22U, inputs.digital_count);
    EXPECT_EQ(robot.digital & 0x3FFFFFU, inputs.digital);
}

TEST(Role, IsFoundByTextOfAnInputOfItsTypeOnly) {
    const std::array<std::string, ROBUROC4_ROLE_COUNT> texts{"Game pad A button", "Front bumper",
                                                             "Rear bumper", "Battery voltage"};
    const std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> right{
        {{ROBUROC4_IO_DIGITAL_INPUT, 7}, ROBUROC4_ROLE_OVERRIDE},
        {{ROBUROC4_IO_DIGITAL_INPUT, 6}, ROBUROC4_ROLE_FRONT_BUMPER},
        {{ROBUROC4_IO_DIGITAL_INPUT, 5}, ROBUROC4_ROLE_REAR_BUMPER},
        {{ROBUROC4_IO_ANALOG_INPUT, 4}, ROBUROC4_ROLE_BATTERY_V}};
    ScriptedRobot robot;
    robot.iocard.analog_outputs = 4;
    robot.channel_text = [&](std::uint32_t io_type, std::uint32_t index) -> std::string {
        const auto found = right.find({io_type, index});
        if (found != right.end())
            return texts[found->second];
        const std::uint32_t wrong = io_type == ROBUROC4_IO_DIGITAL_INPUT  ? ROBUROC4_ROLE_BATTERY_V
                                    : io_type == ROBUROC4_IO_ANALOG_INPUT ? index % 3
                                                                          : index % 4;
        return texts[wrong];
    };
    Ready bench(robot);
    ASSERT_EQ(1, bench.facts().descriptions_done);
    for (const auto &[channel, which] : right)
        EXPECT_EQ(static_cast<roburoc4_result>(channel.second), role(bench, which)) << which;
}

TEST(Role, IsFoundByTheManualsTableWhereThereAreNoTexts) {
    struct Case {
        std::int32_t digital, analog, pad_a, battery;
    };
    for (const Case &c : {Case{22, 9, 8, 2}, Case{23, 10, 9, 3}, Case{24, 11, -10, -10},
                          Case{21, 8, -10, -10}, Case{22, 12, -10, -10}, Case{0, 0, -10, -10}}) {
        ScriptedRobot robot;
        robot.texts_refused = true;
        robot.iocard.digital_inputs = c.digital;
        robot.iocard.analog_inputs = c.analog;
        robot.analog.resize(static_cast<std::size_t>(c.analog));
        Ready bench(robot);
        EXPECT_EQ(c.pad_a, role(bench, ROBUROC4_ROLE_OVERRIDE)) << c.digital;
        EXPECT_EQ(c.battery, role(bench, ROBUROC4_ROLE_BATTERY_V)) << c.analog;
        const bool bumpers = c.digital == 22 || c.digital == 23; /* a guess is enough for them */
        EXPECT_EQ(bumpers ? 0 : -10, role(bench, ROBUROC4_ROLE_FRONT_BUMPER)) << c.digital;
        EXPECT_EQ(bumpers ? 1 : -10, role(bench, ROBUROC4_ROLE_REAR_BUMPER)) << c.digital;
    }
}

TEST(Role, OneTextMayNameTwo) {
    ScriptedRobot robot;
    robot.channel_text = [](std::uint32_t io_type, std::uint32_t index) -> std::string {
        return io_type == ROBUROC4_IO_DIGITAL_INPUT && index == 5 ? "Bumper front/rear" : "";
    };
    Ready bench(robot);
    EXPECT_EQ(5, role(bench, ROBUROC4_ROLE_FRONT_BUMPER));
    EXPECT_EQ(5, role(bench, ROBUROC4_ROLE_REAR_BUMPER));
}

TEST(Role, OfThePadIsNotGuessedOnACardWithOtherOutputs) {
    for (const bool analog : {false, true}) {
        ScriptedRobot robot;
        robot.texts_refused = true;
        (analog ? robot.iocard.analog_outputs : robot.iocard.digital_outputs)++;
        Ready bench(robot);
        EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, role(bench, ROBUROC4_ROLE_OVERRIDE));
        EXPECT_EQ(0, role(bench, ROBUROC4_ROLE_FRONT_BUMPER)) << "for which a guess is enough";
    }
}

TEST(Role, ThatTwoTextsClaimIsUnknown) {
    ScriptedRobot robot;
    robot.channel_text = [](std::uint32_t, std::uint32_t index) -> std::string {
        return index == 4 || index == 12 ? "Game pad A button" : "";
    };
    Ready bench(robot);
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, role(bench, ROBUROC4_ROLE_OVERRIDE));
    EXPECT_EQ(ROBUROC4_ERR_OVERRIDE_UNKNOWN, bench.arm());
}

TEST(Role, OfTheUserBeatsTextAndTable) {
    roburoc4_config config = default_config();
    config.role_index[ROBUROC4_ROLE_OVERRIDE] = 15;
    Ready bench(config);
    EXPECT_EQ(15, role(bench, ROBUROC4_ROLE_OVERRIDE));
    bench.robot.press(8);
    bench.run(100 * ms);
    EXPECT_EQ(0, bench.facts().overridden);
    bench.robot.press(15);
    bench.run(100 * ms);
    EXPECT_EQ(1, bench.facts().overridden);
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_set_role_index(&bench.client, ROBUROC4_ROLE_OVERRIDE,
                                                          ROBUROC4_INDEX_AUTO, bench.client_us()));
    EXPECT_EQ(8, role(bench, ROBUROC4_ROLE_OVERRIDE));
    EXPECT_EQ(0, bench.facts().override_known) << "until the next status";
    bench.run(100 * ms);
    EXPECT_EQ(1, bench.facts().override_known);
    EXPECT_EQ(1, bench.facts().overridden);
}

TEST(Role, MayBeTheVeryFirstInput) {
    for (const bool by_text : {false, true}) {
        SCOPED_TRACE(by_text);
        ScriptedRobot robot;
        roburoc4_config config = default_config();
        if (by_text)
            robot.channel_text = [](std::uint32_t io_type, std::uint32_t index) -> std::string {
                return io_type == ROBUROC4_IO_DIGITAL_INPUT && index == 0 ? "Game pad A button"
                                                                          : "?";
            };
        else
            config.role_index[ROBUROC4_ROLE_OVERRIDE] = 0;
        Ready bench(robot, config);
        EXPECT_EQ(0, role(bench, ROBUROC4_ROLE_OVERRIDE));
        EXPECT_EQ(1, bench.facts().override_known);
        EXPECT_EQ(ROBUROC4_OK, bench.arm());
        bench.take_events();
        robot.press(0);
        bench.run(100 * ms);
        EXPECT_EQ(1, bench.facts().overridden);
        EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_OVERRIDE);
        EXPECT_EQ(ROBUROC4_ERR_OVERRIDE, bench.facts().disarm_cause);
        EXPECT_EQ(ROBUROC4_ERR_OVERRIDE, bench.arm());
    }
}

TEST(Role, BeyondTheRobotsInputsIsUnknownAndBeyondTheRangeRefused) {
    Ready bench;
    const auto set = [&](std::uint32_t which, std::int32_t index) {
        return roburoc4_client_set_role_index(&bench.client, which, index, bench.client_us());
    };
    EXPECT_EQ(ROBUROC4_OK, set(ROBUROC4_ROLE_OVERRIDE, 22));
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN, role(bench, ROBUROC4_ROLE_OVERRIDE));
    EXPECT_EQ(ROBUROC4_OK, set(ROBUROC4_ROLE_OVERRIDE, 63));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, set(ROBUROC4_ROLE_OVERRIDE, 64));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, set(ROBUROC4_ROLE_OVERRIDE, -2));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, set(ROBUROC4_ROLE_BATTERY_V, 16));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, set(ROBUROC4_ROLE_COUNT, 0));
}

TEST(Role, BumpersAreFacts) {
    Ready bench;
    bench.robot.press(ROBUROC4_DI_FRONT_BUMPER);
    bench.run(100 * ms);
    EXPECT_EQ(1, bench.facts().front_bumper);
    EXPECT_EQ(0, bench.facts().rear_bumper);
    bench.robot.press(ROBUROC4_DI_FRONT_BUMPER, false);
    bench.robot.press(ROBUROC4_DI_REAR_BUMPER);
    bench.run(100 * ms);
    EXPECT_EQ(0, bench.facts().front_bumper);
    EXPECT_EQ(1, bench.facts().rear_bumper);
}

/* ---- facts ---- */

TEST(Facts, AreExactlyTheCurrentFacts) {
    RobotBench bench;
    roburoc4_facts facts{};
    facts.size = sizeof facts;
    const auto expect_facts = [&] {
        for (std::uint32_t service = 0; service < 8; service++) {
            const bool has_status = service >= 2 && service <= 6;
            facts.age_us[service] = has_status ? bench.service_link(service).age_us : UINT32_MAX;
        }
        expect_all(facts, [&](roburoc4_facts *out) {
            out->size = sizeof *out;
            return roburoc4_client_facts(&bench.client, bench.client_us(), out);
        });
    };
    facts.disarm_cause = ROBUROC4_ERR_DISARMED;
    facts.arm_refusal = ROBUROC4_ERR_NOT_READY;
    facts.relocalize_result = ROBUROC4_ERR_NOT_KNOWN;
    expect_facts();
    bench.ready();
    facts.state = ROBUROC4_STATE_READY;
    facts.override_known = facts.front_bumper_known = facts.rear_bumper_known = 1;
    facts.battery_known = 1;
    facts.descriptions_done = 1;
    facts.arm_refusal = ROBUROC4_OK;
    expect_facts();
    ASSERT_EQ(ROBUROC4_OK, bench.arm());
    facts.armed = 1;
    facts.disarm_cause = ROBUROC4_OK;
    expect_facts();
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, -0.25F, 200000));
    bench.run(30 * ms);
    facts.driving = 1;
    facts.lease_left_us = 170000;
    facts.sent_linear_m_s = 0.5F;
    facts.sent_angular_rad_s = -0.25F;
    expect_facts();
    ASSERT_EQ(ROBUROC4_OK, bench.pause());
    bench.pump();
    facts.driving = 0;
    facts.stopping = 1;
    facts.stop_outcome = ROBUROC4_STOP_RUNNING;
    facts.lease_left_us = 0;
    facts.sent_linear_m_s = facts.sent_angular_rad_s = 0;
    expect_facts();
    bench.run(second);
    facts.stopping = 0;
    facts.stop_outcome = ROBUROC4_STOP_CONFIRMED;
    expect_facts();
    bench.robot.press(ROBUROC4_DI_PAD_A);
    bench.run(100 * ms);
    facts.armed = 0;
    facts.overridden = 1;
    facts.disarm_cause = facts.arm_refusal = ROBUROC4_ERR_OVERRIDE;
    expect_facts();
}

TEST(Facts, ALeaseIsOverAtItsEndAlsoBeforeAPoll) {
    Armed bench;
    ASSERT_EQ(ROBUROC4_OK, bench.drive(0.5F, 0, 200000));
    bench.pump();
    bench.now_us += 199999;
    EXPECT_EQ(1, bench.facts().driving);
    EXPECT_EQ(1U, bench.facts().lease_left_us);
    for (const std::uint64_t later_us : {1U, 1U, 50000U}) {
        bench.now_us += later_us;
        EXPECT_EQ(0, bench.facts().driving);
        EXPECT_EQ(0U, bench.facts().lease_left_us);
    }
}

TEST(Facts, AnOverrideThatIsNoLongerKnownIsNotHeld) {
    Ready bench;
    bench.robot.press(ROBUROC4_DI_PAD_A);
    bench.run(100 * ms);
    ASSERT_EQ(1, bench.facts().overridden);
    bench.robot.powered = false;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    EXPECT_EQ(0, bench.facts().override_known);
    EXPECT_EQ(0, bench.facts().overridden);
}

TEST(Facts, ReportTheSpeedsThatWereSentLast) {
    roburoc4_config config = default_config();
    config.max_angular_rad_s = 0.75F;
    Armed bench(config);
    ASSERT_NO_FATAL_FAILURE(bench.driving(0.5F, -2, 100 * ms));
    EXPECT_EQ(0.5F, bench.facts().sent_linear_m_s);
    EXPECT_EQ(-0.75F, bench.facts().sent_angular_rad_s) << "as it was clamped";
    bench.run(second);
    EXPECT_EQ(0.0F, bench.facts().sent_linear_m_s);
    EXPECT_EQ(0.0F, bench.facts().sent_angular_rad_s);
}

/* ---- battery ---- */

TEST(Battery, BelowItsMinimumIsAnEventOncePerFall) {
    Ready bench;
    EXPECT_EQ(0, bench.facts().battery_low);
    bench.robot.battery_percent = 20;
    bench.run(1100 * ms);
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_BATTERY_LOW) << "20 is not below 20";
    bench.robot.battery_percent = 19;
    bench.run(1100 * ms);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_BATTERY_LOW);
    EXPECT_EQ(1, bench.facts().battery_low);
    bench.run(5 * second);
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_BATTERY_LOW);
    bench.robot.battery_percent = 50;
    bench.run(1100 * ms);
    EXPECT_EQ(0, bench.facts().battery_low);
    bench.robot.battery_percent = 10;
    bench.run(1100 * ms);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_BATTERY_LOW);
}

TEST(Battery, CriticalIsAnEventAndLow) {
    Ready bench;
    bench.robot.battery_state = ROBUROC4_BATTERY_CRITICAL;
    bench.run(1100 * ms);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_BATTERY_CRITICAL);
    EXPECT_EQ(1, bench.facts().battery_low);
    bench.run(5 * second);
    EXPECT_EQ(0U, bench.take_events() & ROBUROC4_EVENT_BATTERY_CRITICAL);
    bench.robot.battery_percent = 19;
    bench.run(1100 * ms);
    EXPECT_TRUE(bench.take_events() & ROBUROC4_EVENT_BATTERY_LOW) << "low after critical";
}

TEST(Battery, CriticalAfterLowIsAnEvent) {
    Ready bench;
    bench.robot.battery_percent = 19;
    bench.run(1100 * ms);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_EVENT_BATTERY_LOW),
              bench.take_events() & (ROBUROC4_EVENT_BATTERY_LOW | ROBUROC4_EVENT_BATTERY_CRITICAL));
    bench.robot.battery_state = ROBUROC4_BATTERY_CRITICAL;
    bench.run(1100 * ms);
    EXPECT_EQ(static_cast<std::uint32_t>(ROBUROC4_EVENT_BATTERY_CRITICAL),
              bench.take_events() & (ROBUROC4_EVENT_BATTERY_LOW | ROBUROC4_EVENT_BATTERY_CRITICAL));
}

TEST(Battery, IsCriticalInNoOtherState) {
    Ready bench;
    for (int state = 0; state < 256; state++) {
        bench.robot.battery_state = static_cast<std::uint8_t>(state);
        bench.now_us += 10 * ms;
        ASSERT_EQ(0, bench.receive(bench.robot.status_at(ROBUROC4_SERVICE_BATTERY,
                                                         bench.robot.cycles() + 1 +
                                                             static_cast<std::uint64_t>(state))));
        const bool critical = state == ROBUROC4_BATTERY_CRITICAL;
        EXPECT_EQ(critical, bench.facts().battery_low == 1) << state;
        EXPECT_EQ(critical, (bench.take_events() & ROBUROC4_EVENT_BATTERY_CRITICAL) != 0) << state;
    }
}

TEST(Battery, HasNoMinimumIfTheRobotNoLongerReportsIt) {
    Ready bench;
    bench.robot.service(ROBUROC4_SERVICE_BATTERY).get_refused = true;
    bench.robot.powered = false;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    bench.robot.reboot();
    bench.robot.powered = true;
    ASSERT_TRUE(bench.run_until([&] { return bench.count(ROBUROC4_COUNT_REBOOTS) == 1; }));
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_READY));
    bench.take_events();
    bench.robot.battery_percent = 5;
    bench.run(2 * second);
    roburoc4_battery_properties properties;
    EXPECT_EQ(ROBUROC4_ERR_NOT_KNOWN,
              roburoc4_client_battery_properties(&bench.client, &properties));
    EXPECT_EQ(0, bench.facts().battery_low);
    EXPECT_FALSE(bench.take_events() & ROBUROC4_EVENT_BATTERY_LOW);
}

TEST(Battery, CriticalAndLowFromTheFirstStatusAreEvents) {
    ScriptedRobot robot;
    robot.battery_state = ROBUROC4_BATTERY_CRITICAL;
    robot.battery_percent = 3;
    Started bench(robot);
    bench.run(2 * second);
    const std::uint32_t events = bench.take_events();
    EXPECT_TRUE(events & ROBUROC4_EVENT_BATTERY_CRITICAL);
    EXPECT_TRUE(events & ROBUROC4_EVENT_BATTERY_LOW);
}

/* ---- what was not judged, or is not there ---- */

TEST(Facts, TheBatteryIsNotKnownToBeFullBeforeItsMinimumIs) {
    ScriptedRobot robot;
    robot.battery_percent = 12;
    bool answers = false;
    robot.instead = [&](const roburoc4_request &request, std::vector<Bytes> &) {
        return !answers && request.action == ROBUROC4_ACTION_GET &&
               request.service == ROBUROC4_SERVICE_BATTERY;
    };
    Ready bench(robot);
    bench.run(5 * second);
    EXPECT_EQ(0, bench.facts().battery_known);
    answers = true;
    for (int i = 0; i < 3000; i++) {
        bench.run(10 * ms);
        if (bench.facts().battery_known == 1) {
            EXPECT_EQ(1, bench.facts().battery_low) << i;
        }
    }
    EXPECT_EQ(1, bench.facts().battery_known);
}

TEST(Distances, OfSurplusBytesAreNone) {
    ScriptedRobot robot;
    robot.distances = {1.5F, 2.5F, 0, 0};
    Ready bench(robot);
    bench.run(second);
    roburoc4_distances distances;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_distances(&bench.client, &distances, nullptr));
    EXPECT_EQ(2U, distances.count);
    robot.powered = false;
    ASSERT_TRUE(bench.run_until_state(ROBUROC4_STATE_LOST));
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_distances(&bench.client, &distances, nullptr));
    EXPECT_EQ(2U, distances.count);
}
