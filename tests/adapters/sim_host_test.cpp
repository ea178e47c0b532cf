/* SPDX-License-Identifier: MIT
 *
 * sim_host_test.cpp - the simulated robot on its own thread, which bindings start in their process:
 * it behaves like other robots, and can be read and changed from another thread while it runs.
 */
#include "pump_calls.h"
#include "roburoc4_pump.h"
#include "roburoc4_sim.h"
#include "udp_support.h"

extern "C" { /* a C header of the bindings */
#include "host.h"
}

#include <gtest/gtest.h>

#include <cerrno>
#include <chrono>
#include <memory>
#include <thread>

using test::eventually;
using test::on_client;

namespace {

struct DestroyHost {
    void operator()(sim_host *host) const {
        sim_host_destroy(host);
    }
};
using Host = std::unique_ptr<sim_host, DestroyHost>;

struct DestroyPump {
    void operator()(roburoc4_pump *pump) const {
        roburoc4_pump_destroy(pump);
    }
};
using Pump = std::unique_ptr<roburoc4_pump, DestroyPump>;

/* A host and its simulator, which may only be used while the host is locked. */
struct Served {
    roburoc4_sim *sim = roburoc4_sim_create(nullptr);
    Host host;

    Served() {
        int error = -1;
        host.reset(sim_host_open(sim, "127.0.0.1", 0, &error));
        EXPECT_NE(host, nullptr) << "error " << error;
    }
    roburoc4_sim_state state() const {
        roburoc4_sim_state state{};
        state.size = sizeof state;
        sim_host_lock(host.get());
        EXPECT_EQ(roburoc4_sim_get_state(sim, &state), ROBUROC4_OK);
        sim_host_unlock(host.get());
        return state;
    }
    Pump pump() const {
        roburoc4_address address{};
        roburoc4_result result = 1;
        EXPECT_EQ(roburoc4_udp_resolve("127.0.0.1", sim_host_port(host.get()), &address),
                  ROBUROC4_OK);
        Pump pump(roburoc4_pump_create(&address, nullptr, 0, nullptr, &result));
        EXPECT_EQ(result, ROBUROC4_OK);
        return pump;
    }
};

void sleep_ms(int ms) {
    std::this_thread::sleep_for(std::chrono::milliseconds(ms));
}

bool moves(const Served &robot, roburoc4_pump *pump) {
    return eventually([&] {
        sleep_ms(10);
        on_client(pump, roburoc4_client_arm);
        on_client(pump, roburoc4_client_drive, 0.5F, 0.0F, 0U);
        return robot.state().true_linear_m_s > 0.3;
    });
}

} // namespace

TEST(SimHost, ReportsWhyItCannotServe) {
    const test::Socket taken;
    roburoc4_sim *sim = roburoc4_sim_create(nullptr);
    int error = 0;
    EXPECT_EQ(sim_host_open(sim, "127.0.0.1", taken.port(), &error), nullptr);
    EXPECT_EQ(error, EADDRINUSE);
    roburoc4_sim_destroy(sim); /* still ours */
}

TEST(SimHost, CanBeChangedByOthersWhileItRuns) {
    Served robot;
    ASSERT_NE(robot.host, nullptr);
    const Pump pump = robot.pump();
    ASSERT_TRUE(moves(robot, pump.get()));
    std::thread other([&] {
        for (int i = 0; i < 200; i++) {
            sim_host_lock(robot.host.get());
            roburoc4_sim_set(robot.sim, ROBUROC4_SIM_PAD_BUTTON + ROBUROC4_DI_PAD_B, i % 2);
            sim_host_unlock(robot.host.get());
            robot.state();
        }
    });
    for (int i = 0; i < 200; i++) {
        robot.state();
    }
    other.join();
    EXPECT_TRUE(moves(robot, pump.get()));
}
