/* SPDX-License-Identifier: MIT
 *
 * pump_test.cpp - the pump with the system's own threads, sockets, signals and processes: what
 * virtual/pump_test.cpp, which has its promises, takes the place of.
 */
#include "pump_calls.h"
#include "roburoc4_pump.h"
#include "sim_process.h"
#include "udp_robot.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <pthread.h>
#include <sys/wait.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

using test::eventually;
using test::kPatienceUs;
using test::on_client;
using test::socket_of;
using test::SpeedCommand;
using test::UdpRobot;

namespace {

constexpr uint32_t kPatience = static_cast<uint32_t>(kPatienceUs);

struct Destroy {
    void operator()(roburoc4_pump *pump) const {
        roburoc4_pump_destroy(pump);
    }
};
using Pump = std::unique_ptr<roburoc4_pump, Destroy>;

Pump make_pump(const roburoc4_address &address, uint32_t queue = 0) {
    roburoc4_result result = 1;
    Pump pump(roburoc4_pump_create(&address, nullptr, queue, nullptr, &result));
    EXPECT_EQ(result, ROBUROC4_OK);
    return pump;
}

void sleep_ms(int ms) {
    std::this_thread::sleep_for(std::chrono::milliseconds(ms));
}

bool becomes_ready(roburoc4_pump *pump) {
    roburoc4_pump_reader reader{};
    return roburoc4_pump_wait_events(pump, &reader, ROBUROC4_EVENT_READY, kPatience) > 0;
}

/* Arms again where this machine did not run the pump for so long that it disarmed. */
bool becomes_driven(roburoc4_pump *pump, uint32_t lease_us) {
    return eventually([&] {
        return roburoc4_pump_arm(pump, kPatience) == ROBUROC4_OK &&
               on_client(pump, roburoc4_client_drive, 0.5f, 0.0f, lease_us) == ROBUROC4_OK;
    });
}

size_t zeros_at_the_end(const std::vector<SpeedCommand> &commands) {
    size_t zeros = 0;
    while (zeros < commands.size() && commands[commands.size() - 1 - zeros].is_zero()) {
        zeros++;
    }
    return zeros;
}

size_t speeds_in(const std::vector<SpeedCommand> &commands) {
    size_t speeds = 0;
    for (const SpeedCommand &command : commands) {
        speeds += !command.is_zero();
    }
    return speeds;
}

/* --------------------------------------------------------------------- signals and exit() --- */

/* What the handler stops. */
std::atomic<roburoc4_pump *> signalled{nullptr};

void stop_robot(int) {
    roburoc4_pump_request_stop(signalled);
}

class RequestStop : public ::testing::Test {
  protected:
    void SetUp() override {
        signalled = pump_.get();
        std::signal(SIGUSR1, stop_robot);
    }
    void TearDown() override {
        std::signal(SIGUSR1, SIG_DFL);
        signalled = nullptr;
    }
    void drive_off() {
        ASSERT_TRUE(eventually([&] {
            EXPECT_TRUE(becomes_driven(pump_.get(), 1000000));
            sleep_ms(5);
            return speeds_in(robot_.commands()) >= 2;
        }));
    }
    bool stops() {
        return eventually([&] {
            sleep_ms(5);
            return zeros_at_the_end(robot_.commands()) >= 3;
        });
    }

    UdpRobot robot_;
    Pump pump_ = make_pump(robot_.address());
};

TEST_F(RequestStop, NeverBlocksWhateverItsHandlerInterrupts) {
    drive_off();
    std::atomic<bool> running{true};
    std::thread driver([&] {
        while (running) {
            on_client(pump_.get(), roburoc4_client_arm);
            on_client(pump_.get(), roburoc4_client_drive, 0.5f, 0.0f, 0);
        }
    });
    for (int i = 0; i < 2000; i++) {
        pthread_kill(driver.native_handle(), SIGUSR1);
        std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    running = false;
    driver.join();
    roburoc4_pump_request_stop(pump_.get());
    EXPECT_TRUE(stops());
}

/* The system's own atexit(), which the tests in virtual time replace. */
TEST(Exit, WhileDrivingStopsTheRobot) {
    UdpRobot robot;
    const std::string address = "127.0.0.1:" + std::to_string(robot.port());
    const std::string program = test::beside_this_program("exit_in_mid_drive");
    const pid_t child = fork();
    if (child == 0) {
        setenv("TSAN_OPTIONS", "report_thread_leaks=0", 1); /* exit() leaves threads */
        execl(program.c_str(), program.c_str(), address.c_str(), nullptr);
        _exit(127);
    }
    int status = -1;
    EXPECT_TRUE(eventually([&] {
        sleep_ms(5);
        return waitpid(child, &status, WNOHANG) == child;
    }));
    EXPECT_EQ(status, 0);
    EXPECT_TRUE(eventually([&] { return zeros_at_the_end(robot.commands()) >= 3; }));
    EXPECT_GE(speeds_in(robot.commands()), 1u);
    EXPECT_LT(speeds_in(robot.commands()), 15u) << "it is stopped; its lease ends after 20";
}

/* ------------------------------------------------------------------------- many at a time --- */

int open_files() {
    int count = 0;
    for (int file = 0; file < 1024; file++) {
        count += fcntl(file, F_GETFD) != -1;
    }
    return count;
}

TEST(Fork, LeavesTheChildWithoutAPumpAndTheParentWithIts) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address());
    ASSERT_TRUE(becomes_ready(pump.get()));
    pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        roburoc4_pump *p = pump.release();
        int wrong = roburoc4_pump_running(p) != 0;
        const int files = open_files();
        roburoc4_pump_destroy(p);
        wrong += open_files() != files - 3; /* the socket, and both ends of the pipe that wakes */
        exit(wrong); /* what was registered for exit() runs in the child, too */
    }
    int status = -1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0);
    roburoc4_pump_reader reader{};
    ASSERT_EQ(roburoc4_pump_reader_init(pump.get(), &reader), ROBUROC4_OK);
    EXPECT_GT(roburoc4_pump_wait_samples(pump.get(), &reader, kPatience), 0)
        << "the parent's link lives on";
}

TEST(Threads, CanAllCallEverythingAtOnce) {
    UdpRobot robot;
    Pump pump = make_pump(robot.address(), 32);
    ASSERT_TRUE(becomes_driven(pump.get(), 0));
    roburoc4_pump *p = pump.get();
    std::atomic<bool> running{true};
    std::vector<std::thread> threads;
    threads.emplace_back([&] {
        while (running) {
            on_client(p, roburoc4_client_drive, 0.2f, 0.1f, 100000);
            sleep_ms(3);
        }
    });
    threads.emplace_back([&] {
        while (running) {
            on_client(p, roburoc4_client_arm);
            on_client(p, roburoc4_client_stop);
            on_client(p, roburoc4_client_set_digital_outputs, 0x0E, 0x0A);
            sleep_ms(7);
        }
    });
    for (int i = 0; i < 3; i++) {
        threads.emplace_back([&] {
            roburoc4_pump_reader reader{};
            roburoc4_sample samples[5];
            roburoc4_facts facts{};
            facts.size = sizeof facts;
            while (running) {
                roburoc4_pump_wait_samples(p, &reader, 10000);
                roburoc4_pump_read_samples(p, &reader, samples, 5);
                roburoc4_pump_take_events(p, &reader);
                EXPECT_EQ(on_client(p, roburoc4_client_facts, roburoc4_udp_now_us(), &facts),
                          ROBUROC4_OK);
            }
        });
    }
    sleep_ms(300);
    running = false;
    for (std::thread &thread : threads) {
        thread.join();
    }
    EXPECT_EQ(roburoc4_pump_close(p), ROBUROC4_OK);
    EXPECT_TRUE(eventually([&] { return zeros_at_the_end(robot.commands()) >= 3; }));
}

} // namespace
