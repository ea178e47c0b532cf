/* SPDX-License-Identifier: MIT
 *
 * The gate in front of a client: what a bridge's commands make a simulated robot do.
 */
#include <gtest/gtest.h>

#include <cfloat>
#include <cstdint>
#include <cstring>

#include "gate_client.h"
#include "roburoc4_sim.h"

namespace {

constexpr std::uint64_t ms = 1000;
constexpr std::uint32_t lease_us = 250 * ms;

/** A robot that can be armed, and a gate that may let commands through. */
class GateClient : public testing::Test {
  protected:
    GateClient() {
        roburoc4_client_init(&client, sizeof client, nullptr);
        roburoc4_world_join(world, &client);
        gate_rules rules{};
        rules.enabled[GATE_DRIVE] = true;
        rules.lease_us = lease_us;
        gate_init(&gate, &rules, {now_us(), 0});
        pass(2000);
    }
    ~GateClient() override {
        roburoc4_world_destroy(world);
    }
    GateClient(const GateClient &) = delete;
    GateClient &operator=(const GateClient &) = delete;

    [[nodiscard]] std::uint64_t now_us() const {
        return roburoc4_world_now_us(world);
    }
    void pass(std::uint64_t time_ms) {
        const std::uint64_t until_us = now_us() + time_ms * ms;
        while (roburoc4_world_step(world, until_us, nullptr, nullptr) != 0) {
            const std::uint32_t events = roburoc4_client_take_events(&client);
            gate_heed_events(&gate, &client, events, now_us());
        }
    }
    gate_verdict drive(float linear_m_s) {
        return gate_drive(&gate, &client, linear_m_s, 0.0F, lease_us, now_us());
    }
    /** One command of a stream, as a bridge handles it; the sender's clock is right. */
    gate_verdict send(float linear_m_s, const char *sender = "planner") {
        gate_command command{};
        command.kind = GATE_DRIVE;
        command.sender = sender;
        command.sender_length = std::strlen(sender);
        command.utime = command.arrived_utime = static_cast<std::int64_t>(now_us());
        command.finite = true;
        command.zero = linear_m_s == 0;
        const gate_robot robot = gate_robot_of(&client, now_us());
        std::uint32_t left_us = 0;
        const gate_verdict verdict =
            gate_judge(&gate, &command, &robot, {now_us(), command.utime}, &left_us);
        return verdict == GATE_TAKEN ? drive(linear_m_s) : verdict;
    }
    [[nodiscard]] double speed() const {
        roburoc4_sim_state state{};
        state.size = sizeof state;
        roburoc4_sim_get_state(roburoc4_world_robot(world), &state);
        return state.last_linear_m_s;
    }
    void set(const char *control, double value) {
        const roburoc4_result which = roburoc4_sim_control_find(control);
        ASSERT_GE(which, 0);
        roburoc4_sim_set(roburoc4_world_robot(world), static_cast<std::uint32_t>(which), value);
    }
    [[nodiscard]] bool is_armed() const {
        return gate_robot_of(&client, now_us()).armed;
    }
    [[nodiscard]] bool is_waiting() const {
        return gate_is_waiting(&gate, now_us());
    }

    roburoc4_world *world = roburoc4_world_create(nullptr);
    roburoc4_client client{};
    struct gate gate {};
};

} // namespace

TEST_F(GateClient, ASpeedArmsAndDrivesForItsLease) {
    EXPECT_EQ(GATE_TAKEN, drive(0.3F));
    EXPECT_TRUE(is_armed());
    pass(200);
    EXPECT_NEAR(0.3, speed(), 1e-6);
    pass(100);
    EXPECT_EQ(0.0, speed());
    EXPECT_EQ(1, gate.taken[GATE_DRIVE]);
    EXPECT_FALSE(is_waiting()) << "the end of a lease is no break";
}

TEST_F(GateClient, ArmingForAMoveIsNotCountedAsASpeed) {
    EXPECT_EQ(GATE_TAKEN, gate_arm(&gate, &client, now_us()));
    EXPECT_TRUE(is_armed());
    EXPECT_EQ(0, gate.taken[GATE_DRIVE]);
}

TEST_F(GateClient, AZeroArmsNothing) {
    EXPECT_EQ(GATE_TAKEN, drive(0.0F));
    EXPECT_FALSE(is_armed());
    EXPECT_EQ(GATE_TAKEN, gate_drive(&gate, &client, 0, 0.3F, lease_us, now_us()));
    EXPECT_TRUE(is_armed()) << "a turn on the spot is no zero";
    EXPECT_EQ(GATE_TAKEN, drive(0.3F));
    pass(50);
    EXPECT_EQ(GATE_TAKEN, drive(0.0F));
    pass(50);
    EXPECT_EQ(0.0, speed());
}

TEST_F(GateClient, WhereArmingIsRefusedFurtherCommandsAreHeld) {
    set("pad_a", 1);
    pass(500);
    pass(600);
    ASSERT_FALSE(is_waiting());
    EXPECT_EQ(GATE_DISARMED, drive(0.3F));
    EXPECT_TRUE(is_waiting());
    EXPECT_EQ(1, gate.rejected[GATE_DISARMED]);
    EXPECT_EQ(0, gate.taken[GATE_DRIVE]);
}

TEST_F(GateClient, AnOverrideHolds) {
    EXPECT_EQ(GATE_TAKEN, drive(0.3F));
    pass(100);
    set("pad_a", 1);
    pass(200);
    EXPECT_FALSE(is_armed());
    EXPECT_TRUE(is_waiting());
}

TEST_F(GateClient, AnOverrideThatIsOverHoldsAlsoAClientThatWasNotArmed) {
    set("pad_a", 1);
    pass(100);
    set("pad_a", 0);
    pass(100);
    EXPECT_FALSE(is_armed());
    EXPECT_EQ(GATE_DISARMED, send(0.3F)) << "a stream that did not pause";
    pass(500);
    EXPECT_EQ(GATE_TAKEN, send(0.3F));
}

TEST_F(GateClient, TheEndOfAnOverrideHoldsNoLonger) {
    set("pad_a", 1);
    pass(1000);
    ASSERT_FALSE(is_waiting());
    set("pad_a", 0);
    pass(200);
    EXPECT_FALSE(is_waiting());
    EXPECT_EQ(GATE_TAKEN, send(0.3F));
}

TEST_F(GateClient, ALostRobotHolds) {
    EXPECT_EQ(GATE_TAKEN, drive(0.3F));
    pass(100);
    set("power", 0);
    pass(1200);
    EXPECT_FALSE(gate_robot_of(&client, now_us()).ready);
    EXPECT_TRUE(is_waiting());
}

TEST_F(GateClient, OfTheEventsOfTheLinkEachOfThreeHoldsAndNoOther) {
    for (std::uint32_t bit = 0; bit < 32; bit++) {
        const std::uint32_t event = std::uint32_t{1} << bit;
        if (event == ROBUROC4_EVENT_DISARMED || event == ROBUROC4_EVENT_OVERRIDE) {
            continue; /* these depend on the cause */
        }
        pass(600);
        ASSERT_FALSE(is_waiting());
        gate_heed_events(&gate, &client, event, now_us());
        EXPECT_EQ(event == ROBUROC4_EVENT_LOST || event == ROBUROC4_EVENT_REBOOT ||
                      event == ROBUROC4_EVENT_CLOCK,
                  is_waiting())
            << bit;
    }
}

TEST_F(GateClient, AStopStopsAndHolds) {
    EXPECT_EQ(GATE_TAKEN, drive(0.3F));
    pass(100);
    gate_stop_client(&gate, &client, "operator", 8, now_us());
    pass(50);
    EXPECT_EQ(0.0, speed());
    EXPECT_TRUE(is_waiting());
    EXPECT_STREQ("operator", gate.stopped_by);
    EXPECT_EQ(1, gate.taken[GATE_STOP]);
}

TEST_F(GateClient, AStopIsOverOnceASpeedOrAMoveIsObeyed) {
    for (const bool moves : {false, true}) {
        gate_stop_client(&gate, &client, "operator", 8, now_us());
        pass(1000);
        EXPECT_EQ(GATE_UNITS, send(300));
        pass(10);
        EXPECT_EQ(GATE_TAKEN, send(0));
        pass(10);
        EXPECT_TRUE(gate.stopped);
        EXPECT_EQ(GATE_TAKEN, moves ? gate_arm(&gate, &client, now_us()) : send(0.3F));
        EXPECT_FALSE(gate.stopped);
    }
}

TEST_F(GateClient, AStreamThatNeverPausesDoesNotDriveOnAfterAStop) {
    for (int at = 0; at < 20; at++) {
        EXPECT_EQ(GATE_TAKEN, send(0.3F));
        pass(50);
    }
    gate_stop_client(&gate, &client, "operator", 8, now_us());
    EXPECT_FALSE(is_armed()) << "a stop latches";
    for (int at = 0; at < 200; at++) {
        EXPECT_EQ(GATE_DISARMED, send(0.3F));
        pass(50);
        ASSERT_EQ(0.0, speed()) << at;
        ASSERT_FALSE(is_armed()) << at;
    }
    pass(GATE_PAUSE_US / ms);
    EXPECT_EQ(GATE_TAKEN, send(0.3F)) << "after a pause the first speed arms";
    pass(50);
    EXPECT_NEAR(0.3, speed(), 1e-6);
}

TEST_F(GateClient, AStopHoldsTheStreamsOfAllSenders) {
    EXPECT_EQ(GATE_TAKEN, send(0.3F));
    pass(50);
    gate_stop_client(&gate, &client, "operator", 8, now_us());
    for (int at = 0; at < 40; at++) {
        EXPECT_EQ(GATE_DISARMED, send(0.3F, at % 2 == 0 ? "planner" : "other"));
        pass(300); /* each of them pauses for 600 ms, but not both */
        ASSERT_EQ(0.0, speed());
    }
}

TEST_F(GateClient, ALapseIsAPause) {
    EXPECT_EQ(GATE_TAKEN, send(0.3F));
    pass(1400); /* the lease, and lapse_disarm_ms */
    EXPECT_FALSE(is_armed());
    EXPECT_EQ(GATE_TAKEN, send(0.3F));
    EXPECT_TRUE(is_armed());
    pass(50);
    EXPECT_NEAR(0.3, speed(), 1e-6);
}

TEST_F(GateClient, ACommandThatFindsTheLapseIsRefusedButThePauseIsOver) {
    EXPECT_EQ(GATE_TAKEN, drive(0.3F));
    pass(100);
    const std::uint64_t later_us = now_us() + 1400 * ms; /* the client was not called meanwhile */
    EXPECT_EQ(GATE_DISARMED, gate_drive(&gate, &client, 0.3F, 0, lease_us, later_us));
    EXPECT_FALSE(gate_is_waiting(&gate, later_us));
}

TEST_F(GateClient, SpeedsInOtherUnitsAreRefusedAndNeverChangeTheirSign) {
    EXPECT_EQ(GATE_TAKEN, send(0.3F));
    pass(50);
    for (const float speed : {300.0F, -300.0F, -1e6F, -1e30F, -FLT_MAX, 5.001F, -5.001F}) {
        EXPECT_EQ(GATE_UNITS, send(speed)) << speed;
        pass(10);
        EXPECT_NEAR(0.3, this->speed(), 1e-6) << "the last target holds until its lease ends";
    }
    for (const float turn : {45.0F, -45.0F}) {
        EXPECT_EQ(GATE_UNITS, gate_drive(&gate, &client, 0.3F, turn, 0, now_us())) << turn;
    }
    EXPECT_EQ(9, gate.rejected[GATE_UNITS]);
    EXPECT_EQ(GATE_TAKEN, gate_drive(&gate, &client, 0.3F, -10, 0, now_us()));
    EXPECT_EQ(GATE_TAKEN, gate_drive(&gate, &client, 0.3F, 10, 0, now_us()));
    EXPECT_FALSE(is_waiting()) << "a mistake is no reason to wait for a pause";
    EXPECT_EQ(GATE_TAKEN, send(5.0F));
    pass(50);
    EXPECT_EQ(GATE_TAKEN, send(-5.0F));
    pass(50);
    EXPECT_NEAR(-1.0, speed(), 1e-6) << "clamped to the ceiling";
}

TEST_F(GateClient, ArmsForAMoveUnlessThatIsRefused) {
    EXPECT_EQ(GATE_TAKEN, gate_arm(&gate, &client, now_us()));
    EXPECT_TRUE(is_armed());
    EXPECT_FALSE(is_waiting());
    set("pad_a", 1);
    pass(200);
    EXPECT_EQ(GATE_DISARMED, gate_arm(&gate, &client, now_us()));
    EXPECT_FALSE(is_armed());
    EXPECT_TRUE(is_waiting());
}
