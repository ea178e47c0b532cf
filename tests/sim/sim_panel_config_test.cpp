/* SPDX-License-Identifier: MIT
 *
 * sim_panel_config_test.cpp - the simulator's texts: lines of the panel, the robot's udpserver.cfg,
 * and invalid configurations.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <regex>
#include <sstream>
#include <string>

#include "config_file.h"
#include "sim_support.h"

using namespace roburoc4_tests;

namespace {

/** A robot that obeys panel lines. */
class SimPanel : public testing::Test {
  protected:
    roburoc4_result obey(const std::string &line) {
        std::array<char, ROBUROC4_SIM_REPLY_SIZE> buffer{};
        const auto result =
            roburoc4_sim_panel(robot.get(), line.c_str(), buffer.data(), buffer.size());
        reply = buffer.data();
        return result;
    }

    SimRobot robot;
    std::string reply;
};

roburoc4_result read_config(roburoc4_sim_config &config, const std::string &text,
                            std::string *error = nullptr) {
    std::array<char, 160> buffer{};
    const auto result =
        sim_config_read(&config, text.data(), text.size(), buffer.data(), buffer.size());
    if (error != nullptr)
        *error = buffer.data();
    return result;
}

std::uint32_t watchdog_of(const std::string &text) {
    roburoc4_sim_config config = default_sim_config();
    EXPECT_EQ(ROBUROC4_OK, read_config(config, text)) << text;
    return config.watchdog_cycles;
}

} // namespace

/* ----------------------------------------------------------------------------------- panel --- */

TEST_F(SimPanel, SetsEveryControl) {
    EXPECT_EQ(ROBUROC4_OK, obey("pad rt 0.5"));
    EXPECT_EQ("ok", reply);
    EXPECT_EQ(ROBUROC4_OK, obey("pad a down"));
    robot.run(1);
    EXPECT_NEAR(0.75 * 2.6, robot.state().target_linear_m_s, 1e-6);
    EXPECT_EQ(ROBUROC4_OK, obey("pad a up"));
    EXPECT_EQ(0, robot.state().overridden);
    EXPECT_EQ(ROBUROC4_OK, obey("estop local press"));
    EXPECT_EQ(1, robot.state().estop_local);
    EXPECT_EQ(ROBUROC4_OK, obey("estop remote press"));
    EXPECT_EQ(1, robot.state().estop_remote);
    EXPECT_EQ(ROBUROC4_OK, obey("estop local release"));
    EXPECT_EQ(ROBUROC4_OK, obey("estop remote release"));
    EXPECT_EQ(ROBUROC4_OK, obey("brakes released"));
    EXPECT_EQ(1, robot.state().brakes_released);
    EXPECT_EQ(ROBUROC4_OK, obey("brakes automatic"));
    EXPECT_EQ(0, robot.state().motors_enabled);
    EXPECT_EQ(ROBUROC4_OK, obey("motor on"));
    EXPECT_EQ(1, robot.state().motors_enabled);
    EXPECT_EQ(ROBUROC4_OK, obey("battery 12"));
    EXPECT_NEAR(12.0, double(robot.state().battery_percent), 1e-3);
    EXPECT_EQ(ROBUROC4_OK, obey("charger on"));
    EXPECT_EQ(1, robot.state().charger);
    EXPECT_EQ(ROBUROC4_OK, obey("front bumper press"));
    EXPECT_EQ(1, robot.state().front_bumper);
    EXPECT_EQ(ROBUROC4_OK, obey("front bumper release"));
    EXPECT_EQ(ROBUROC4_OK, obey("power off"));
    EXPECT_EQ(0, robot.state().powered);
    EXPECT_EQ(ROBUROC4_OK, obey("power on"));
    EXPECT_EQ(1U, robot.state().reboots);
    EXPECT_EQ(ROBUROC4_OK, obey("place 1 -2 0.5"));
    EXPECT_DOUBLE_EQ(-2.0, robot.state().true_y_m);
}

TEST_F(SimPanel, HasEveryButtonAndAxisOfThePad) {
    const char *buttons[] = {"a",     "b",       "x",    "y",  "back", "start", "d_down",
                             "dleft", "D_Right", "d_up", "lj", "rj",   "lb",    "rb"};
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_IOCARD, 1));
    for (std::uint32_t index = 0; index < 14; index++) {
        EXPECT_EQ(ROBUROC4_OK, obey(std::string("pad ") + buttons[index] + " down"));
        robot.take();
        robot.run(1);
        const Bytes status = robot.take().at(0).bytes;
        const std::uint32_t channel = ROBUROC4_DI_PAD_A + index;
        EXPECT_EQ(1 << channel % 8, status.at(47 + channel / 8)) << buttons[index];
        EXPECT_EQ(ROBUROC4_OK, obey(std::string("pad ") + buttons[index] + " up"));
    }
    const char *axes[] = {"lj_x", "ljy", "rj x", "rjy", "lt", "rt"};
    for (std::uint32_t index = 0; index < 6; index++) {
        EXPECT_EQ(ROBUROC4_OK, obey(std::string("pad ") + axes[index] + " -0.5"));
        robot.take();
        robot.run(1);
        const Bytes status = robot.take().at(0).bytes;
        EXPECT_EQ(0xBF, status.at(11 + 4 * (ROBUROC4_AI_PAD_LJ_X + index) + 3)) << axes[index];
    }
    EXPECT_EQ(ROBUROC4_OK, obey("pad release"));
}

TEST_F(SimPanel, PutsBoxesOnTheFloor) {
    EXPECT_EQ(ROBUROC4_OK, obey("box clear"));
    EXPECT_EQ(ROBUROC4_OK, obey("box add 3 0 0.5 0.5 0"));
    EXPECT_EQ("ok 0", reply);
    EXPECT_NEAR(2.75 - 0.655, double(robot.state().distances_m[0]), 1e-5);
    EXPECT_EQ(ROBUROC4_OK, obey("box wall -3 -1 -3 1"));
    EXPECT_EQ("ok 1", reply);
    EXPECT_EQ(ROBUROC4_OK, obey("box move 0 4 0 0"));
    EXPECT_NEAR(3.75 - 0.655, double(robot.state().distances_m[0]), 1e-5);
    EXPECT_EQ(ROBUROC4_ERR_STATE, obey("box move 0 0 0 0"));
    EXPECT_NE(std::string::npos, reply.find("overlap")) << reply;
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, obey("box move 7 0 0 0"));
}

TEST_F(SimPanel, AcceptsAControlByItsName) {
    EXPECT_EQ(ROBUROC4_OK, obey("estop_local 1"));
    EXPECT_EQ(1, robot.state().estop_local);
    EXPECT_EQ(ROBUROC4_OK, obey("localization 82"));
    EXPECT_EQ(82, robot.value(ROBUROC4_SIM_LOCALIZATION_FLAGS));
    EXPECT_EQ(ROBUROC4_OK, obey("pin_analog_2 24.5"));
    EXPECT_EQ(24.5, robot.value(ROBUROC4_SIM_PIN_ANALOG + 2));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, obey("brakes on")) << "which of the two is meant?";
    EXPECT_EQ("usage: brakes_released automatic|released", reply);
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, obey("digital_output_1 1"));
}

TEST_F(SimPanel, HelpListsEveryCommandAndStatusShowsThePose) {
    EXPECT_EQ(ROBUROC4_OK, obey("help"));
    for (const char *word : {"pad", "estop", "brakes", "motor", "power", "charger", "battery",
                             "bumper", "localization", "pin", "box", "place", "status"})
        EXPECT_NE(std::string::npos, reply.find(word)) << word;
    EXPECT_EQ(ROBUROC4_OK, obey("place 1.25 0 0"));
    EXPECT_EQ(ROBUROC4_OK, obey("status"));
    EXPECT_NE(std::string::npos, reply.find("pose 1.250")) << reply;
}

TEST_F(SimPanel, RefusesWhatItDoesNotUnderstandAndNamesTheRemedy) {
    for (const char *line : {"fly",
                             "pad",
                             "pad a",
                             "pad q down",
                             "pad rt 1.5",
                             "pad rt 1 2",
                             "pad rt nan",
                             "estop",
                             "estop both press",
                             "brakes on",
                             "power",
                             "battery",
                             "battery 101",
                             "bumper left press",
                             "charger",
                             "box",
                             "box add 1 2 3",
                             "place 1 2",
                             "status now",
                             "pin analog x 1",
                             "pad a down down down down down down down down"}) {
        EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, obey(line)) << line;
        EXPECT_TRUE(reply.find("usage: ") == 0 || reply.find("try help") != std::string::npos)
            << line << " -> " << reply;
    }
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, obey(std::string(10000, 'a')));
    EXPECT_EQ(1, robot.state().powered);
}

TEST_F(SimPanel, KeepsWithinTheReplysCapacity) {
    for (std::size_t capacity : {1U, 2U, 10U, 500U}) {
        for (const char *line : {"help", "status", "fly", "motor on", "pad"}) {
            std::vector<char> buffer(capacity, '~');
            roburoc4_sim_panel(robot.get(), line, buffer.data(), capacity);
            EXPECT_NE(buffer.end(), std::find(buffer.begin(), buffer.end(), '\0')) << line;
        }
    }
}

/* ---------------------------------------------------------------------------- udpserver.cfg --- */

TEST(SimConfigFile, GivesTheWatchdogOfTheDifferentialService) {
    EXPECT_EQ(50U, watchdog_of("[DifferentialService]\nWatchdog=50\n"));
    EXPECT_EQ(7U, watchdog_of("\xEF\xBB\xBF; PURE server\r\n[IOCard]\r\nWatchdog=1\r\n"
                              "[ differentialservice ]\r\n  watchdog = 7 ; cycles\r\n"
                              "Port=60000\r\n[Battery]\r\nWatchdog=2"));
    EXPECT_EQ(20U, watchdog_of("[DifferentialService]\nWatchdog=10\nWatchdog=20"));
}

TEST(SimConfigFile, KeepsTheDefaultIfNothingIsConfigured) {
    for (const char *text :
         {"", "\n\n", "[DifferentialService]", "Watchdog=5", "[Other]\nWatchdog=5",
          "[DifferentialService]\n#Watchdog=5\n;Watchdog=6\nWatchdogs=7",
          "[DifferentialServices]\nWatchdog=5", "some words\n= 5\n"})
        EXPECT_EQ(100U, watchdog_of(text)) << text;
}

TEST(SimConfigFile, NamesLineValueAndRemedyOfANonsenseValue) {
    for (const char *value :
         {"", "0", "-5", "abc", "10.5", "1 2", "1000001", "99999999999999999999", "0x10"}) {
        roburoc4_sim_config config = default_sim_config();
        std::string error;
        const std::string text = std::string("\n[DifferentialService]\nWatchdog=") + value + "\n";
        EXPECT_EQ(ROBUROC4_ERR_VALUE, read_config(config, text, &error)) << value;
        EXPECT_EQ(100U, config.watchdog_cycles);
        EXPECT_NE(std::string::npos, error.find("line 3: Watchdog=" + std::string(value))) << error;
        EXPECT_NE(std::string::npos, error.find("1 to 1000000")) << error;
        EXPECT_EQ(ROBUROC4_ERR_VALUE,
                  sim_config_read(&config, text.data(), text.size(), nullptr, 0));
    }
}

TEST(SimConfigFile, SetsAnyNumberInTheSectionSimulator) {
    roburoc4_sim_config config = default_sim_config();
    EXPECT_EQ(ROBUROC4_OK, read_config(config, "[Simulator]\nas_manual = 1\nslip=0.25 ; much\n"
                                               "digital_inputs=23\nstart_theta_rad=-1.5\n"));
    EXPECT_EQ(1U, config.as_manual);
    EXPECT_FLOAT_EQ(0.25F, config.slip);
    EXPECT_EQ(23, config.digital_inputs);
    EXPECT_DOUBLE_EQ(-1.5, config.start_theta_rad);
    std::string error;
    EXPECT_EQ(ROBUROC4_ERR_VALUE, read_config(config, "[Simulator]\nwings=2\n", &error));
    EXPECT_NE(std::string::npos, error.find("line 2: wings=2: no such setting")) << error;
    EXPECT_EQ(ROBUROC4_ERR_VALUE, read_config(config, "[Simulator]\nslip=2\n", &error));
    EXPECT_EQ("line 2: slip=2: slip: give 0 to 0.9", error);
    for (const char *value : {"", "-1", "0.5", "yes", "4294967296"}) {
        const auto text = std::string("[Simulator]\nas_manual=") + value;
        EXPECT_EQ(ROBUROC4_ERR_VALUE, read_config(config, text, &error)) << value;
        EXPECT_NE(std::string::npos, error.find("give a number")) << error;
    }
}

/* ---------------------------------------------------------------------------- configuration --- */

TEST(SimConfig, DefaultsAreARobuRoc4) {
    const roburoc4_sim_config config = default_sim_config();
    EXPECT_EQ(nullptr, roburoc4_sim_config_error(&config));
    EXPECT_EQ(100U, config.watchdog_cycles);
    roburoc4_sim *sim = roburoc4_sim_create(nullptr);
    EXPECT_NE(nullptr, sim);
    EXPECT_EQ(0U, roburoc4_sim_next_deadline(sim)) << "it wants to be told the time first";
    roburoc4_sim_destroy(sim);
    roburoc4_sim_destroy(nullptr);
}

TEST(SimConfig, NonsenseIsNamedAndMakesNoRobot) {
    const auto refused = [](const char *field, auto change) {
        roburoc4_sim_config config = default_sim_config();
        change(config);
        const char *error = roburoc4_sim_config_error(&config);
        ASSERT_NE(nullptr, error) << field;
        EXPECT_NE(std::string::npos, std::string(error).find(field)) << error;
        EXPECT_EQ(nullptr, roburoc4_sim_create(&config)) << field;
    };
    using Config = roburoc4_sim_config;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    refused("size", [](Config &config) { config.size--; });
    refused("watchdog_cycles", [](Config &config) { config.watchdog_cycles = 0; });
    refused("localization_flags", [](Config &config) { config.localization_flags = 128; });
    refused("query_mode", [](Config &config) { config.query_mode = 6; });
    refused("service_ids", [](Config &config) { config.service_ids[0] = 9; });
    refused("service_ids", [](Config &config) { config.service_ids[3] = 6; });
    refused("hidden_services", [](Config &config) { config.hidden_services = 1; });
    refused("analog_inputs", [](Config &config) { config.analog_inputs = -1; });
    refused("digital_inputs", [](Config &config) { config.digital_inputs = 257; });
    refused("slip", [](Config &config) { config.slip = 0.95F; });
    refused("nominal_voltage_v", [](Config &config) { config.nominal_voltage_v = 0.0F; });
    refused("battery_percent", [](Config &config) { config.battery_percent = 101.0F; });
    refused("minimum_percent", [](Config &config) { config.minimum_percent = 101; });
    refused("start_x_m", [nan](Config &config) { config.start_x_m = nan; });
}

/* The header's members, except arrays and the size. */
TEST(SimConfig, EveryNumberHasItsName) {
    std::ifstream file(ROBUROC4_SOURCE_DIR "/include/roburoc4_sim.h");
    const std::string header((std::istreambuf_iterator<char>(file)), {});
    const auto begin = header.find("typedef struct roburoc4_sim_config {");
    std::string body = header.substr(begin, header.find("} roburoc4_sim_config;") - begin);
    body = std::regex_replace(body, std::regex(R"(/\*[^]*?\*/)"), "");
    std::size_t names = 0;
    const std::regex declaration(R"((?:u?int\d+_t|float|double) ([^;\[]*);)");
    for (std::sregex_iterator at(body.begin(), body.end(), declaration), end; at != end; ++at) {
        std::istringstream list((*at)[1].str());
        for (std::string name; std::getline(list >> std::ws, name, ',');) {
            roburoc4_sim_config config = default_sim_config();
            if (name == "size")
                continue;
            names++;
            EXPECT_EQ(ROBUROC4_OK, sim_config_set(&config, name.c_str(), 4.0)) << name;
            const roburoc4_sim_config defaults = default_sim_config();
            EXPECT_NE(0, std::memcmp(&config, &defaults, sizeof config)) << name;
        }
    }
    EXPECT_GT(names, 70U);
    roburoc4_sim_config config = default_sim_config();
    EXPECT_EQ(ROBUROC4_ERR_INDEX, sim_config_set(&config, "size", 1.0));
    EXPECT_EQ(ROBUROC4_ERR_INDEX, sim_config_set(&config, "", 1.0));
    for (const double wrong : {-1.0, 0.5, 1e30, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, sim_config_set(&config, "seed", wrong)) << wrong;
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, sim_config_set(&config, "slip", 1e300));
}

TEST(SimConfig, TheLargestCardFitsIntoADatagram) {
    roburoc4_sim_config config = default_sim_config();
    config.analog_inputs = config.analog_outputs = ROBUROC4_SIM_MAX_ANALOG;
    config.digital_inputs = config.digital_outputs = ROBUROC4_SIM_MAX_DIGITAL;
    SimRobot robot(config);
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_IOCARD, 1));
    robot.run(1);
    EXPECT_EQ(11U + 4U * 64U + 32U, robot.take().at(0).bytes.size());
    Bytes command(3 + 4 * 64 + 32, 0xFF);
    command[1] = 2;
    command[2] = 0;
    robot.send(command);
    EXPECT_EQ(1, robot.value(ROBUROC4_SIM_DIGITAL_OUTPUT + 255));
}
