/* SPDX-License-Identifier: MIT
 *
 * The gate in front of a client: what a bridge's commands make a simulated robot do.
 */
#include <gtest/gtest.h>

#include <cstdint>

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

TEST_F(GateClient, AZeroArmsNothing) {
    EXPECT_EQ(GATE_TAKEN, drive(0.0F));
    EXPECT_FALSE(is_armed());
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

TEST_F(GateClient, ALostRobotHolds) {
    EXPECT_EQ(GATE_TAKEN, drive(0.3F));
    pass(100);
    set("power", 0);
    pass(1200);
    EXPECT_FALSE(gate_robot_of(&client, now_us()).ready);
    EXPECT_TRUE(is_waiting());
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
