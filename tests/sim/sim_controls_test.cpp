/* SPDX-License-Identifier: MIT
 *
 * sim_controls_test.cpp - the simulator's controls by number and by name, and structs of programs
 * that know fewer of their members.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <limits>
#include <regex>
#include <string>

#include "config_file.h"
#include "sim_support.h"

using namespace roburoc4_tests;

namespace {

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char letter) { return std::tolower(letter); });
    return text;
}

std::string text_of(const std::string &header) {
    std::ifstream file(std::string(ROBUROC4_SOURCE_DIR "/include/") + header);
    return {(std::istreambuf_iterator<char>(file)), {}};
}

} // namespace

TEST(SimControls, HaveTheNamesOfTheirConstants) {
    const std::string all = text_of("roburoc4_sim.h");
    const std::string text = all.substr(all.find("controls --- */"));
    const std::regex constant(R"(#define ROBUROC4_SIM_(\w+) (\d+))");
    int found = 0;
    for (std::sregex_iterator at(text.begin(), text.end(), constant), end; at != end; ++at) {
        const std::string name = lower((*at)[1].str());
        const auto number = std::stoi((*at)[2].str());
        if (name == "max_boxes" || name == "reply_size" || name == "pad_button" ||
            name == "pad_axis")
            continue;
        found++;
        if (number < 1000) {
            EXPECT_EQ(number, roburoc4_sim_control_find(name.c_str())) << name;
            continue;
        }
        EXPECT_EQ(number + 7, roburoc4_sim_control_find((name + "_7").c_str())) << name;
        EXPECT_EQ(ROBUROC4_ERR_INDEX, roburoc4_sim_control_find(name.c_str())) << name;
    }
    EXPECT_EQ(36, found);
}

TEST(SimControls, OfThePadHaveTheNamesOfTheirChannels) {
    const std::string text = text_of("roburoc4_codec.h");
    const std::regex channel(R"(#define ROBUROC4_(AI|DI)_(PAD_\w+) (\d+))");
    int found = 0;
    for (std::sregex_iterator at(text.begin(), text.end(), channel), end; at != end; ++at) {
        const std::string name =
            std::regex_replace(lower((*at)[2].str()), std::regex("_click"), "");
        const int base = (*at)[1] == "DI" ? ROBUROC4_SIM_PAD_BUTTON : ROBUROC4_SIM_PAD_AXIS;
        EXPECT_EQ(base + std::stoi((*at)[3].str()), roburoc4_sim_control_find(name.c_str()))
            << name;
        found++;
    }
    EXPECT_EQ(20, found);
}

TEST(SimControls, CanBeAbbreviated) {
    EXPECT_EQ(ROBUROC4_SIM_BATTERY_PERCENT, roburoc4_sim_control_find("battery"));
    EXPECT_EQ(ROBUROC4_SIM_BRAKES_RELEASED, roburoc4_sim_control_find("brakes"));
    EXPECT_EQ(ROBUROC4_SIM_PAD_AXIS + ROBUROC4_AI_PAD_LJ_X, roburoc4_sim_control_find("pad_ljx"));
    EXPECT_EQ(ROBUROC4_SIM_PAD_BUTTON + ROBUROC4_DI_PAD_LJ_CLICK,
              roburoc4_sim_control_find("pad_lj"));
    for (const char *name : {"", "_", "estop", "bumper", "bat", "powers", "pin_analog",
                             "pin_analog_64", "pin_digital_256", "pin_digital_1234", "pad_a_1",
                             "estop_local_1", "8", "Power", "pin_analog_x"})
        EXPECT_EQ(ROBUROC4_ERR_INDEX, roburoc4_sim_control_find(name)) << name;
}

TEST(SimControls, ReadWhatWasSet) {
    SimRobot robot;
    for (const char *name : {"power", "estop_local", "estop_remote", "brakes_released", "charger",
                             "front_bumper", "rear_bumper", "pad_a", "pad_rb", "pin_digital_4"}) {
        const auto control = std::uint32_t(roburoc4_sim_control_find(name));
        for (const double value : {0.0, 1.0, 0.0}) {
            EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(robot.get(), control, value)) << name;
            EXPECT_EQ(value, robot.value(control)) << name;
        }
        for (const double wrong : {-1.0, 0.5, 2.0, std::numeric_limits<double>::quiet_NaN()})
            EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, roburoc4_sim_set(robot.get(), control, wrong)) << name;
        EXPECT_EQ(0, robot.value(control)) << name;
    }
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(robot.get(), ROBUROC4_SIM_PAD_AXIS + 8, -0.25));
    EXPECT_EQ(-0.25, robot.value(ROBUROC4_SIM_PAD_AXIS + 8));
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(robot.get(), ROBUROC4_SIM_BATTERY_PERCENT, 37.5));
    EXPECT_EQ(37.5, robot.value(ROBUROC4_SIM_BATTERY_PERCENT));
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(robot.get(), ROBUROC4_SIM_LOCALIZATION_FLAGS, 82));
    EXPECT_EQ(82, robot.value(ROBUROC4_SIM_LOCALIZATION_FLAGS));
}

/* ------------------------------------------------------------------------------------ sizes --- */

TEST(SimSizes, AShorterConfigurationHasDefaultsForTheRest) {
    roburoc4_sim_config config;
    ASSERT_EQ(ROBUROC4_OK, roburoc4_sim_config_init(&config, sizeof config));
    config.slip = 5.0F;
    config.start_x_m = 3.0;
    config.watchdog_cycles = 7;
    config.size = offsetof(roburoc4_sim_config, service_ids);
    EXPECT_EQ(nullptr, roburoc4_sim_config_error(&config)) << "it does not know of slip";
    EXPECT_EQ(ROBUROC4_ERR_INDEX, sim_config_set(&config, "slip", 0.5));
    SimRobot robot(config);
    EXPECT_EQ(0.0, robot.state().true_x_m);
    roburoc4_sim_config longer = default_sim_config();
    longer.size = sizeof longer + 8;
    EXPECT_NE(nullptr, roburoc4_sim_config_error(&longer));
    EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_sim_config_init(&config, sizeof config + 8));
    EXPECT_EQ(ROBUROC4_ERR_SIZE, roburoc4_sim_config_init(&config, 0));
}

TEST(SimSizes, AShorterStateIsNotWrittenBeyondItsEnd) {
    SimRobot robot;
    robot.run(3);
    roburoc4_sim_state state;
    std::fill_n(reinterpret_cast<std::uint8_t *>(&state), sizeof state, std::uint8_t{0x5A});
    state.size = offsetof(roburoc4_sim_state, true_x_m);
    const double beyond = state.true_x_m;
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_get_state(robot.get(), &state));
    EXPECT_EQ(3U, state.cycles);
    EXPECT_EQ(beyond, state.true_x_m);
    EXPECT_EQ(offsetof(roburoc4_sim_state, true_x_m), state.size);
}
