/* SPDX-License-Identifier: MIT
 *
 * sim_world_test.cpp - virtual time: clients and a robot meet without sockets, no event is missed,
 * and runs are reproducible.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "roburoc4_sim.h"

namespace {

constexpr std::uint64_t ms = 1000;
constexpr std::uint64_t second = 1000 * ms;

/** A world, and one client that has joined it. */
class World : public testing::Test {
  protected:
    World() : world(roburoc4_world_create(nullptr), roburoc4_world_destroy) {
        roburoc4_client_init(&client, sizeof client, nullptr);
        number = roburoc4_world_join(world.get(), &client);
        roburoc4_sim_clear_obstacles(roburoc4_world_robot(world.get()));
    }

    [[nodiscard]] std::uint64_t now() const {
        return roburoc4_world_now_us(world.get());
    }
    /** Let time pass; returns the client's events meanwhile. */
    std::uint32_t run(std::uint64_t duration_us) {
        const std::uint64_t until_us = now() + duration_us;
        std::uint32_t events = 0;
        while (roburoc4_world_step(world.get(), until_us, nullptr, nullptr) != 0)
            events |= roburoc4_client_take_events(&client);
        EXPECT_EQ(until_us, now());
        return events;
    }
    void send_at_once() {
        while (roburoc4_world_step(world.get(), now(), nullptr, nullptr) != 0) {
        }
    }
    [[nodiscard]] roburoc4_sim_state robot() const {
        roburoc4_sim_state state{};
        state.size = sizeof state;
        roburoc4_sim_get_state(roburoc4_world_robot(world.get()), &state);
        return state;
    }
    void make_ready() {
        EXPECT_NE(0U, run(2 * second) & ROBUROC4_EVENT_READY);
    }
    void lose(double share) {
        roburoc4_sim_faults faults{};
        faults.size = sizeof faults;
        faults.loss = share;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_world_set_faults(world.get(), &faults));
    }

    std::unique_ptr<roburoc4_world, decltype(&roburoc4_world_destroy)> world;
    roburoc4_client client{};
    roburoc4_result number;
};

/** All statuses of a run with faults, and the robot's final pose. */
std::string run_with_faults() {
    const std::unique_ptr<roburoc4_world, decltype(&roburoc4_world_destroy)> world(
        roburoc4_world_create(nullptr), roburoc4_world_destroy);
    roburoc4_sim_faults faults{};
    faults.size = sizeof faults;
    roburoc4_client client;
    std::string log;
    const std::uint8_t *datagram = nullptr;
    std::size_t size = 0;
    faults.loss = 0.2;
    faults.reorder = 0.2;
    faults.corrupt = 0.1;
    faults.delay_us = 5 * ms;
    faults.jitter_us = 20 * ms;
    roburoc4_world_set_faults(world.get(), &faults);
    roburoc4_client_init(&client, sizeof client, nullptr);
    roburoc4_world_join(world.get(), &client);
    while (roburoc4_world_step(world.get(), 10 * second, &datagram, &size) != 0) {
        log += std::to_string(roburoc4_world_now_us(world.get())) + ' ';
        log.append(reinterpret_cast<const char *>(datagram), size);
        if (roburoc4_client_arm(&client, roburoc4_world_now_us(world.get())) >= 0)
            (void)roburoc4_client_drive(&client, 0.3F, 0.1F, 0, roburoc4_world_now_us(world.get()));
    }
    return log;
}

} // namespace

TEST_F(World, AClientConnectsArmsAndDrives) {
    EXPECT_EQ(second, now());
    make_ready();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_arm(&client, now()));
    for (int i = 0; i < 40; i++) {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_drive(&client, 0.5F, 0.0F, 0, now()));
        run(100 * ms);
    }
    EXPECT_NEAR(0.5, robot().true_linear_m_s, 0.05);
    EXPECT_NE(0U, run(4 * second) & ROBUROC4_EVENT_LAPSED);
    EXPECT_NEAR(0.0, robot().true_linear_m_s, 0.01);
}

TEST_F(World, ACommandLeavesAtOnce) {
    make_ready();
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_arm(&client, now()));
    const std::uint32_t before = robot().nonzero_speed_commands;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_client_drive(&client, 0.5F, 0.0F, 0, now()));
    send_at_once();
    EXPECT_EQ(before + 1, robot().nonzero_speed_commands);
}

TEST_F(World, TimeGoesNoFurtherThanRequested) {
    run(1);
    run(12344);
    EXPECT_EQ(second + 12345, now());
    EXPECT_EQ(0U, roburoc4_world_step(world.get(), 0, nullptr, nullptr));
    EXPECT_EQ(second + 12345, now());
    EXPECT_EQ(now(), robot().now_us);
}

TEST_F(World, NoStatusIsOmitted) {
    std::uint64_t last = 0, count = 0;
    make_ready();
    const std::uint64_t until_us = now() + 10 * second;
    while (roburoc4_world_step(world.get(), until_us, nullptr, nullptr) != 0) {
        roburoc4_differential_status status;
        if ((roburoc4_client_take_events(&client) & ROBUROC4_EVENT_DIFFERENTIAL) == 0)
            continue;
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_differential(&client, &status, nullptr));
        if (count++ > 0) {
            EXPECT_EQ(last + 5, status.robot_cycles);
        }
        last = status.robot_cycles;
    }
    EXPECT_EQ(200U, count);
}

TEST_F(World, AClientThatIsDueHasNewsWithoutADatagram) {
    make_ready();
    lose(1.0);
    const std::uint64_t begin_us = now();
    std::uint32_t events = 0;
    while ((events & ROBUROC4_EVENT_LOST) == 0 && now() < begin_us + 5 * second) {
        ASSERT_NE(0U, roburoc4_world_step(world.get(), begin_us + 5 * second, nullptr, nullptr));
        events |= roburoc4_client_take_events(&client);
    }
    EXPECT_LE(now(), begin_us + second);
    lose(0.0);
    make_ready();
}

TEST_F(World, TheSameCallsGiveTheSameRun) {
    const std::string first = run_with_faults();
    EXPECT_GT(first.size(), 10000U);
    EXPECT_EQ(first, run_with_faults());
}

TEST_F(World, AClientThatLeftIsNoLongerTouched) {
    auto gone = std::make_unique<roburoc4_client>();
    roburoc4_client_init(gone.get(), sizeof *gone, nullptr);
    ASSERT_GT(roburoc4_world_join(world.get(), gone.get()), 0);
    run(2 * second);
    ASSERT_EQ(2U, robot().peers);
    roburoc4_world_leave(world.get(), gone.get());
    roburoc4_world_leave(world.get(), gone.get());
    gone.reset();
    EXPECT_EQ(0U, run(2 * second) & ROBUROC4_EVENT_LOST);
}

TEST(WorldLife, ABadConfigurationMakesNoWorld) {
    roburoc4_sim_config config;
    roburoc4_sim_config_init(&config, sizeof config);
    config.slip = -1.0F;
    EXPECT_EQ(nullptr, roburoc4_world_create(&config));
    roburoc4_world_destroy(nullptr);
}
