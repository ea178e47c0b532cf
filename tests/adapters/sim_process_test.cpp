/* SPDX-License-Identifier: MIT
 *
 * sim_process_test.cpp - the program roburoc4-sim as a real process on the loopback: options, ready
 * line, signals, panel, and a client that drives it.
 */
#include "sim_process.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <sstream>

using test::eventually;
using test::SimProcess;
using test::Socket;

namespace {

/* A client of a robot on a loopback port. */
struct Driver {
    roburoc4_udp udp{};
    roburoc4_client client{};

    explicit Driver(uint16_t port) {
        roburoc4_address address{};
        EXPECT_EQ(roburoc4_udp_resolve("127.0.0.1", port, &address), ROBUROC4_OK);
        EXPECT_EQ(roburoc4_udp_open(&udp, sizeof udp, &address), ROBUROC4_OK);
        EXPECT_EQ(roburoc4_client_init(&client, sizeof client, nullptr), ROBUROC4_OK);
        EXPECT_EQ(roburoc4_client_start(&client, roburoc4_udp_now_us()), ROBUROC4_OK);
    }
    ~Driver() {
        roburoc4_udp_close(&udp);
    }
    bool reaches(const std::function<bool()> &aim) {
        return eventually([&] {
            roburoc4_udp_wait(&udp, &client, 20000);
            return aim();
        });
    }
};

/* ----------------------------------------------------------------------- command line, life --- */

TEST(SimProgram, EndsCleanlyOnSigtermAndSigint) {
    for (int number : {SIGTERM, SIGINT}) {
        SimProcess sim({"--port", "0"});
        ASSERT_EQ(sim.ports().size(), 1u);
        sim.signal(number);
        EXPECT_EQ(sim.exit_status(), 0) << number;
        EXPECT_EQ(sim.errors(), "");
    }
}

TEST(SimProgram, EndsWithOneIfThePortIsTaken) {
    Socket other;
    SimProcess sim({"--port", std::to_string(other.port())});
    EXPECT_EQ(sim.exit_status(), 1);
    EXPECT_EQ(sim.output(), "");
    EXPECT_NE(sim.errors().find(std::to_string(other.port())), std::string::npos);
}

TEST(SimProgram, EndsWithTwoAndOneLineOnBadOptions) {
    const std::vector<std::vector<std::string>> lines = {
        {"--nonsense"},
        {"--port"},
        {"--port", "65536"},
        {"--port", "x"},
        {"--robots", "0"},
        {"--robots", "2", "--port", "65535"},
        {"--bind", "300.0.0.1"},
        {"--loss", "1.5"},
        {"--jitter-ms", "1e9"},
        {"--seed", "abc"},
        {"--iocard-id", "7", "--battery-id", "7"},
        {"--config", "/no/such/file"},
        {"--family", "1", "--slip", "2"},
        {"--slip", "much"},
        {"--localization-flags", "128"},
        {"--"},
        {"--start_safe_and_much_more_than_any_name_is_long", "1"},
    };
    for (const std::vector<std::string> &arguments : lines) {
        SimProcess sim(arguments);
        EXPECT_EQ(sim.exit_status(), 2) << arguments[0];
        EXPECT_EQ(sim.output(), "") << arguments[0];
        std::string errors = sim.errors();
        ASSERT_FALSE(errors.empty()) << arguments[0];
        EXPECT_EQ(errors.find('\n'), errors.size() - 1) << errors;
        EXPECT_EQ(errors.rfind("roburoc4-sim: ", 0), 0u) << errors;
    }
}

TEST(SimProgram, ExplainsItself) {
    SimProcess help({"--help"});
    EXPECT_EQ(help.exit_status(), 0);
    std::string text = help.output();
    for (const char *option :
         {"--bind", "--port", "--robots", "--seed", "--loss", "--delay-ms", "--jitter-ms",
          "--duplicate", "--reorder", "--corrupt", "--config", "--panel", "--family"}) {
        EXPECT_NE(text.find(option), std::string::npos) << option;
    }
    SimProcess version({"--version"});
    EXPECT_EQ(version.exit_status(), 0);
    EXPECT_EQ(version.output(), "roburoc4-sim " + std::to_string(ROBUROC4_VERSION_MAJOR) + "." +
                                    std::to_string(ROBUROC4_VERSION_MINOR) + "." +
                                    std::to_string(ROBUROC4_VERSION_PATCH) + "\n");
}

/* ------------------------------------------------------------------------------------ clients ---
 */

TEST(SimProgram, AcceptsTheRobotsNumbersByTheirNames) {
    std::string path = testing::TempDir() + "roburoc4_numbers_" + std::to_string(getpid());
    std::ofstream(path) << "[Simulator]\nbattery_percent=30\n";
    SimProcess sim(
        {"--start-safe", "--localization-flags=82", "--config", path, "--port", "0", "--panel"});
    std::vector<uint16_t> ports = sim.ports();
    std::remove(path.c_str());
    ASSERT_EQ(ports.size(), 1u);
    EXPECT_NE(sim.panel("status").find("power on, motors off"), std::string::npos);
    Driver driver(ports[0]);
    roburoc4_localization_status pose{};
    roburoc4_battery_status battery{};
    ASSERT_TRUE(driver.reaches([&] {
        return roburoc4_client_localization(&driver.client, &pose, nullptr) == 0 &&
               roburoc4_client_battery(&driver.client, &battery, nullptr) == 0;
    }));
    EXPECT_EQ(pose.flags, 82u);
    EXPECT_EQ(battery.remaining_percent, 30);
}

TEST(SimProgram, RunsManyRobotsOnConsecutivePorts) {
    ASSERT_TRUE(eventually([] { /* another program may use one of the ports */
                                unsigned first = test::free_port();
                                if (first > 65533) {
                                    return false;
                                }
                                SimProcess sim({"--port", std::to_string(first), "--robots", "3"});
                                std::vector<uint16_t> ports = sim.ports();
                                return ports.size() == 3 && ports[0] == first &&
                                       ports[1] == first + 1 && ports[2] == first + 2;
    }));
}

TEST(SimProgram, PrintsAMemberOfTheFamilyAsOptionsThatItAccepts) {
    SimProcess drawn({"--family", "4", "--port", "0"});
    const std::string line = drawn.line();
    ASSERT_EQ(line.rfind("roburoc4-sim: family 4: --", 0), 0u) << line;
    EXPECT_EQ(drawn.ports().size(), 1u);
    std::istringstream words(line.substr(line.find("--")));
    std::vector<std::string> options = {"--port", "0", "--panel"};
    for (std::string word; words >> word;) {
        options.push_back(word);
    }
    SimProcess repeated(options);
    EXPECT_EQ(repeated.ports().size(), 1u);
    EXPECT_NE(line.find("--telemeters 0"), std::string::npos) << line;
    EXPECT_NE(repeated.panel("status").find("telemeters nan nan"), std::string::npos);
}

TEST(SimProgram, SendsStatusesFromAnotherPort) {
    SimProcess sim({"--other-status-port", "--port", "0"});
    std::vector<uint16_t> ports = sim.ports();
    ASSERT_EQ(ports.size(), 1u);
    Socket client;
    sockaddr_in robot{};
    robot.sin_family = AF_INET;
    robot.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    robot.sin_port = htons(ports[0]);
    client.send(robot, {9, ROBUROC4_ACTION_INSERT, 1, 0, 6, 0, 1});
    const auto answer = client.receive(10000);
    ASSERT_EQ(answer.bytes.size(), 5u);
    EXPECT_EQ(ntohs(answer.from.sin_port), ports[0]);
    const auto status = client.receive(10000);
    ASSERT_EQ(status.bytes.size(), 27u);
    EXPECT_NE(ntohs(status.from.sin_port), ports[0]);
}

} // namespace
