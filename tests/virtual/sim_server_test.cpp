/* SPDX-License-Identifier: MIT
 *
 * roburoc4-sim and the simulator's host in virtual time: the program's main() on a thread of the
 * test, its panel, and a pump that drives its robots.
 */
#include "pump_calls.h"
#include "system.h"

#include <gtest/gtest.h>

#include <iostream>
#include <sstream>

extern "C" {
#include "host.h"
#include "os.h"
/* sim/main.c is compiled with this name for main(). */
int sim_main(int count, char **arguments);
}

namespace {

using namespace virtual_system;
using test::on_client;

/* What a client of a robot knows of it. */
class Driver {
  public:
    explicit Driver(uint16_t port = 60000) {
        roburoc4_address address{};
        roburoc4_os_resolve("robot", port, &address);
        pump = roburoc4_pump_create(&address, nullptr, 0, nullptr, nullptr);
    }
    Driver(const Driver &) = delete;
    Driver &operator=(const Driver &) = delete;
    ~Driver() {
        roburoc4_pump_destroy(pump);
    }
    roburoc4_facts facts() const {
        roburoc4_facts facts{};
        facts.size = sizeof facts;
        on_client(pump, roburoc4_client_facts, sys.now_us, &facts);
        return facts;
    }
    uint32_t state() const {
        return on_client(pump, roburoc4_client_state);
    }
    bool arms() const {
        return roburoc4_pump_arm(pump, 10 * kSecond) == ROBUROC4_OK;
    }
    roburoc4_result drive(float linear_m_s = 0.5f, uint32_t lease_us = 1000000) const {
        return on_client(pump, roburoc4_client_drive, linear_m_s, 0.0f, lease_us);
    }
    roburoc4_differential_status reported() const {
        roburoc4_differential_status status{};
        on_client(pump, roburoc4_client_differential, &status, static_cast<uint64_t *>(nullptr));
        return status;
    }
    roburoc4_pump *pump;
};

class SimServer : public testing::Test {
  protected:
    SimServer() {
        begin();
    }
    ~SimServer() override {
        end();
    }
    void start(std::vector<std::string> options) {
        options.insert(options.begin(), "roburoc4-sim");
        arguments_ = std::move(options);
        testing::internal::CaptureStdout();
        began_us_ = sys.now_us;
        program_ = std::make_unique<Thread>([this] {
            std::vector<char *> pointers;
            for (std::string &argument : arguments_) {
                pointers.push_back(argument.data());
            }
            pointers.push_back(nullptr); /* as C promises main() */
            status_ = sim_main(static_cast<int>(arguments_.size()), pointers.data());
            ended_us_ = sys.now_us;
        });
        sleep_ms(1);
    }
    /* Its output. */
    std::string end() {
        if (program_ == nullptr) {
            return "";
        }
        sys.stop_at_us = sys.now_us;
        program_.reset();
        const std::string output = testing::internal::GetCapturedStdout();
        std::cout << (HasFailure() ? output : ""); /* with what failed */
        return output;
    }
    void type(const std::string &line) const {
        sys.input.push_back({sys.now_us, line + "\n"});
        sleep_ms(100);
    }

    std::vector<std::string> arguments_;
    std::unique_ptr<Thread> program_;
    uint64_t began_us_ = 0, ended_us_ = 0;
    int status_ = -1;
};

TEST_F(SimServer, ServesARobotWithoutSpinningAndEndsAtOnce) {
    sys.stop_at_us = sys.now_us + 10 * kSecond + 3 * kMs;
    start({});
    sleep_ms(20000);
    EXPECT_EQ(ended_us_, sys.stop_at_us);
    EXPECT_EQ(status_, 0);
    EXPECT_LE(sys.waits, 1010) << "once in a cycle";
    EXPECT_EQ(end(), "roburoc4-sim: ready on 127.0.0.1:60000\n");
}

TEST_F(SimServer, ItsRobotDrivesAndItsWatchdogStopsIt) {
    start({});
    Driver driver;
    ASSERT_TRUE(driver.arms());
    ASSERT_EQ(driver.drive(), ROBUROC4_OK);
    sleep_ms(900);
    EXPECT_GT(driver.reported().current_linear_m_s, 0.2f);
    sys.send_fault = ROBUROC4_FAULT_FULL; /* no command leaves any more */
    sleep_ms(900);
    EXPECT_FLOAT_EQ(driver.reported().target_linear_m_s, 0.5f) << "the watchdog takes a second";
    sleep_ms(200);
    EXPECT_EQ(driver.reported().target_linear_m_s, 0.0f);
    sys.send_fault = ROBUROC4_FAULT_NONE;
}

TEST_F(SimServer, ExecutesPanelCommands) {
    start({"--panel"});
    Driver driver;
    ASSERT_TRUE(driver.arms());
    type("pad a down");
    EXPECT_EQ(driver.facts().overridden, 1);
    EXPECT_EQ(driver.facts().armed, 0);
    type("pad a up");
    EXPECT_EQ(driver.facts().overridden, 0);
    type("  ");
    type("dance");
    type("pad a down" + std::string(1000, ' '));
    EXPECT_EQ(driver.facts().overridden, 0) << "a line that is too long is none";
    sys.input.push_back({sys.now_us, "front bum"});
    sleep_ms(50);
    type("per press\r");
    EXPECT_EQ(driver.facts().front_bumper, 1);
    type("power off");
    sleep_ms(2000);
    EXPECT_EQ(driver.state(), uint32_t{ROBUROC4_STATE_LOST});
    type("power on");
    sleep_ms(3000);
    EXPECT_EQ(driver.state(), uint32_t{ROBUROC4_STATE_READY});
    type("quit");
    EXPECT_TRUE(program_->is_over());
    EXPECT_EQ(status_, 0);
    std::istringstream output(end());
    std::vector<std::string> lines;
    for (std::string line; std::getline(output, line);) {
        lines.push_back(line.substr(0, 7));
    }
    EXPECT_EQ(lines, (std::vector<std::string>{"roburoc", "ok", "ok", "error: ", "error: ", "ok",
                                               "ok", "ok"}));
}

TEST_F(SimServer, OutlivesTheEndOfItsInput) {
    sys.input.push_back({sys.now_us + kSecond, ""});
    start({"--panel"});
    sleep_ms(2000);
    const int waits = sys.waits;
    Driver driver;
    EXPECT_TRUE(driver.arms());
    sleep_ms(10000);
    EXPECT_LE(sys.waits - waits, 3000) << "nor does it spin";
    EXPECT_FALSE(program_->is_over());
}

TEST_F(SimServer, AsManualWaitsForTheMotorButton) {
    start({"--as-manual", "--panel"});
    Driver driver;
    ASSERT_TRUE(driver.arms());
    EXPECT_EQ(driver.facts().fixed_id, 1);
    EXPECT_TRUE(eventually(5 * kSecond, [&] {
        (void)driver.drive(1.0f);
        return driver.facts().inhibited == 1;
    })) << "the green button was not pressed";
    EXPECT_EQ(driver.reported().current_linear_m_s, 0.0f);
    type("motor on");
    ASSERT_TRUE(driver.arms());
    EXPECT_TRUE(eventually(3 * kSecond, [&] {
        (void)driver.drive(1.0f);
        return driver.reported().current_linear_m_s > 0.5f;
    }));
}

TEST_F(SimServer, APrefixChoosesTheRobot) {
    start({"--robots", "3", "--panel"});
    Driver first(60000), second(60001), third(60002);
    ASSERT_TRUE(first.arms() && second.arms() && third.arms());
    type("robot 2 pad a down");
    EXPECT_EQ(first.facts().overridden, 0);
    EXPECT_EQ(second.facts().overridden, 1);
    EXPECT_EQ(third.facts().overridden, 0);
    type("pad a down");
    EXPECT_EQ(first.facts().overridden + third.facts().overridden, 2) << "else it is for all";
    type("robot 0 pad a up");
    type("robot 4 pad a up");
    EXPECT_EQ(first.facts().overridden + second.facts().overridden + third.facts().overridden, 3);
    EXPECT_NE(end().find("error: usage: robot 1..3 COMMAND"), std::string::npos);
}

TEST_F(SimServer, AfterALongGapTheRobotsContinueWhereTheyWere) {
    start({});
    Driver driver;
    ASSERT_TRUE(driver.arms());
    sleep_ms(1000);
    const uint64_t before = driver.reported().robot_cycles;
    stall_ms(60000);
    sleep_ms(1000);
    const uint64_t after = driver.reported().robot_cycles;
    EXPECT_LE(after - before, 110u) << "a second";
    stall_ms(900);
    sleep_ms(100);
    EXPECT_GE(driver.reported().robot_cycles - after, 90u) << "a short one is made up for";
    const uint64_t later = driver.reported().robot_cycles;
    stall_ms(60000);
    sleep_ms(1000);
    EXPECT_LE(driver.reported().robot_cycles - later, 110u) << "and after another long one";
}

TEST_F(SimServer, APortThatIsTakenEndsIt) {
    Robot other(60001);
    testing::internal::CaptureStderr();
    start({"--robots", "2"});
    EXPECT_TRUE(program_->is_over());
    EXPECT_EQ(status_, 1);
    EXPECT_NE(testing::internal::GetCapturedStderr().find("cannot use 127.0.0.1:60001"),
              std::string::npos);
}

/* ------------------------------------------------------------------------------- the host --- */

class SimHost : public testing::Test {
  protected:
    SimHost() {
        begin();
        int error = 0;
        host_ = sim_host_open(sim_, "10.0.0.1", 60000, &error);
    }
    ~SimHost() override {
        sim_host_destroy(host_);
        EXPECT_EQ(sys.locks + sys.threads, 0);
    }
    roburoc4_sim_state state() const {
        roburoc4_sim_state state{};
        state.size = sizeof state;
        sim_host_lock(host_);
        roburoc4_sim_get_state(sim_, &state);
        sim_host_unlock(host_);
        return state;
    }
    roburoc4_sim *sim_ = roburoc4_sim_create(nullptr);
    sim_host *host_ = nullptr;
};

TEST_F(SimHost, DoesNotStarveWhileCommandsLieInItsSocket) {
    Driver listener; /* so that the robot sends */
    roburoc4_address address{};
    roburoc4_os_resolve("robot", 60000, &address);
    roburoc4_os_outcome outcome;
    const int64_t socket = roburoc4_os_socket(&address, &outcome);
    roburoc4_os_connect(socket, &address);
    const Bytes command{0xFF, 6, 0, 0x00, 0x00, 0x00, 0x3F, 0, 0, 0, 0}; /* 0.5 m/s */
    for (int round = 0; round < 5; round++) {
        for (int i = 0; i < 6; i++) {
            roburoc4_os_send(socket, command.data(), command.size());
            sleep_ms(50);
        }
        sleep_ms(static_cast<uint64_t>(round));
        const size_t before = sys.received.size();
        sim_host_lock(host_); /* for longer than the watchdog's time */
        sleep_ms(60);         /* it wakes up to send statuses, not for a command */
        for (int i = 0; i < 24; i++) {
            roburoc4_os_send(socket, command.data(), command.size());
            sleep_ms(50);
        }
        sim_host_unlock(host_);
        for (int i = 0; i < 40; i++) {
            roburoc4_os_send(socket, command.data(), command.size());
            sleep_ms(5);
        }
        int seen = 0;
        for (size_t i = before; i < sys.received.size(); i++) {
            roburoc4_differential_status status;
            const Bytes &bytes = sys.received[i];
            if (roburoc4_decode_differential_status(bytes.data(), bytes.size(), &status) == 0) {
                EXPECT_GT(status.target_linear_m_s, 0.1f) << round;
                seen++;
            }
        }
        EXPECT_GT(seen, 20);
    }
    roburoc4_os_close(socket);
}

TEST_F(SimHost, FaultsCanBeSetWhileItRuns) {
    Driver driver;
    ASSERT_TRUE(driver.arms());
    roburoc4_sim_faults faults{};
    faults.size = sizeof faults;
    faults.loss = 2;
    sim_host_lock(host_);
    EXPECT_LT(sim_host_set_faults(host_, &faults), 0) << "no such loss";
    faults.loss = 1;
    EXPECT_EQ(sim_host_set_faults(host_, &faults), ROBUROC4_OK);
    sim_host_unlock(host_);
    sleep_ms(2000);
    EXPECT_EQ(driver.state(), uint32_t{ROBUROC4_STATE_LOST});
    faults.loss = 0;
    sim_host_lock(host_);
    EXPECT_EQ(sim_host_set_faults(host_, &faults), ROBUROC4_OK);
    sim_host_unlock(host_);
    EXPECT_TRUE(driver.arms());
}

TEST_F(SimHost, ADelayIsAsLongAsItWasSet) {
    roburoc4_sim_faults faults{};
    faults.size = sizeof faults;
    faults.delay_us = 3000;
    sim_host_lock(host_);
    EXPECT_EQ(sim_host_set_faults(host_, &faults), ROBUROC4_OK);
    sim_host_unlock(host_);
    Driver driver;
    ASSERT_TRUE(driver.arms());
    sleep_ms(20000);
    roburoc4_link link{};
    link.size = sizeof link;
    on_client(driver.pump, roburoc4_client_link, sys.now_us, &link);
    EXPECT_EQ(link.round_trip_min_us, 6000 + 2 * sys.delay_us);
    EXPECT_NEAR(link.round_trip_us, 6000 + 2.0 * static_cast<double>(sys.delay_us), 100);
}

TEST_F(SimHost, ForgetsAClientWhosePortIsClosed) {
    {
        Driver driver;
        ASSERT_TRUE(driver.arms());
        EXPECT_EQ(state().peers, 1u);
    }
    sleep_ms(4000);
    EXPECT_EQ(state().peers, 1u);
    sleep_ms(6000);
    EXPECT_EQ(state().peers, 0u);
}

TEST_F(SimHost, CanBeStoppedRepeatedlyAndReadAfterwards) {
    Driver driver;
    ASSERT_TRUE(driver.arms());
    const uint64_t asked_us = sys.now_us;
    sim_host_stop(host_);
    EXPECT_LE(sys.now_us, asked_us + 10 * kMs);
    sim_host_stop(host_);
    const uint64_t cycles = state().cycles;
    sleep_ms(100);
    EXPECT_EQ(state().cycles, cycles) << "time stands still";
}

} // namespace
