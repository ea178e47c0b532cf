/* SPDX-License-Identifier: MIT
 *
 * sim_host_test.cpp - the simulated robot on its own thread, which bindings start in their process:
 * it behaves like other robots, can be read and changed from another thread while it runs, and
 * tolerates a process that stands still.
 */
#include "pump_calls.h"
#include "roburoc4_pump.h"
#include "roburoc4_sim.h"
#include "udp_support.h"

extern "C" { /* a C header of the bindings */
#include "host.h"
}

#include <gtest/gtest.h>

#include <algorithm>
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
        const roburoc4_config patient = test::patient_config();
        Pump pump(roburoc4_pump_create(&address, &patient, 0, nullptr, &result));
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

/* A program that sends a speed every 50 ms and does nothing else. */
class Commander {
  public:
    explicit Commander(uint16_t port) : to_(test::loopback(port)), command_(11) {
        EXPECT_EQ(roburoc4_encode_differential_command(command_.data(), command_.size(),
                                                       ROBUROC4_SERVICE_DIFFERENTIAL, 0.2F, 0.0F),
                  11);
    }
    void say() const {
        socket_.send(to_, command_);
    }
    void say_for(int ms) const {
        for (int said_ms = 0; said_ms < ms; said_ms += 50) {
            say();
            sleep_ms(50);
        }
    }

  private:
    test::Socket socket_;
    sockaddr_in to_;
    std::vector<uint8_t> command_;
};

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

TEST(SimHost, FaultsCanBeSetWhileItRuns) {
    Served robot;
    ASSERT_NE(robot.host, nullptr);
    const Pump pump = robot.pump();
    ASSERT_TRUE(moves(robot, pump.get()));
    roburoc4_sim_faults faults{};
    faults.size = sizeof faults;
    faults.loss = 2;
    sim_host_lock(robot.host.get());
    EXPECT_LT(sim_host_set_faults(robot.host.get(), &faults), 0) << "no such loss";
    faults.loss = 1;
    EXPECT_EQ(sim_host_set_faults(robot.host.get(), &faults), ROBUROC4_OK);
    sim_host_unlock(robot.host.get());
    EXPECT_TRUE(eventually([&] {
        sleep_ms(10);
        return robot.state().target_linear_m_s == 0 && robot.state().watchdog_tripped != 0;
    })) << "nothing arrives any more";
    faults.loss = 0;
    sim_host_lock(robot.host.get());
    EXPECT_EQ(sim_host_set_faults(robot.host.get(), &faults), ROBUROC4_OK);
    sim_host_unlock(robot.host.get());
    EXPECT_TRUE(moves(robot, pump.get()));
}

/* The host stays locked for longer than the watchdog time. Commands arrive meanwhile: they wait in
 * the socket, and the robot must not stop. A round in which the test itself could not send the next
 * command in time is ignored. */
TEST(SimHost, DoesNotStarveWhileCommandsLieInItsSocket) {
    Served robot;
    ASSERT_NE(robot.host, nullptr);
    const Pump pump = robot.pump(); /* only listens: the robot sends every cycle */
    const Commander commander(sim_host_port(robot.host.get()));
    int judged = 0;
    for (int round = 0; round < 30 && judged < 3; round++) {
        double slowest = 1;
        uint64_t longest_us = 0;
        commander.say_for(300);
        sim_host_lock(robot.host.get());
        sleep_ms(60); /* it wakes up to send statuses, not for a command */
        commander.say_for(1200);
        sim_host_unlock(robot.host.get());
        for (int i = 0; i < 40; i++) {
            const uint64_t before_us = roburoc4_udp_now_us();
            commander.say();
            slowest = std::min(slowest, robot.state().target_linear_m_s);
            sleep_ms(5);
            longest_us = std::max(longest_us, roburoc4_udp_now_us() - before_us);
        }
        if (longest_us < 500000) { /* half of the watchdog's time */
            EXPECT_GT(slowest, 0.1) << "round " << round;
            judged++;
        }
    }
    EXPECT_GT(judged, 0);
}

TEST(SimHost, CanBeStoppedRepeatedlyAndReadAfterwards) {
    Served robot;
    ASSERT_NE(robot.host, nullptr);
    const Pump pump = robot.pump();
    ASSERT_TRUE(moves(robot, pump.get()));
    sim_host_stop(robot.host.get());
    sim_host_stop(robot.host.get());
    const roburoc4_sim_state then = robot.state();
    EXPECT_GT(then.speed_commands, 0U);
    sleep_ms(100);
    EXPECT_EQ(robot.state().cycles, then.cycles) << "time stands still";
}
