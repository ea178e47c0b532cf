/* SPDX-License-Identifier: MIT
 *
 * A simulator with a robot file is that robot.
 */
#include "roburoc4_sim.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>

namespace {

roburoc4_sim_config config_of(const std::string &text) {
    roburoc4_robot_file file;
    roburoc4_sim_config config;
    const char *remedy = "";
    EXPECT_EQ(ROBUROC4_OK,
              roburoc4_robot_file_read(&file, text.data(), text.size(), nullptr, &remedy))
        << remedy;
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_config_init(&config, sizeof config));
    roburoc4_sim_config_robot_file(&config, &file);
    const char *wrong = roburoc4_sim_config_error(&config);
    EXPECT_EQ(nullptr, wrong) << wrong;
    return config;
}

TEST(RobotFileOfSimulator, IsThatRobot) {
    const roburoc4_sim_config config = config_of(
        "differential_id = 300\nrobot_watchdog_ms = 730\nlinear_omega_rad_s = 3.5\n"
        "dead_time_cycles = 4\npad_keeps_target = 2\ndigital_inputs = 23\noverride_index = 11\n"
        "scale_angular = 1.25\nmax_linear_m_s = 1.5\n");
    EXPECT_EQ(300, config.service_ids[ROBUROC4_SERVICE_DIFFERENTIAL]);
    EXPECT_EQ(73U, config.watchdog_cycles);
    EXPECT_EQ(3.5F, config.linear_omega_rad_s);
    EXPECT_EQ(4U, config.dead_time_cycles);
    EXPECT_EQ(2U, config.pad_keeps_target);
    EXPECT_EQ(2U, config.input_shift); /* 23 inputs: the manual's [A] is 9 */
    EXPECT_FLOAT_EQ(0.2F, config.slip);
    EXPECT_EQ(1.5F, config.max_linear_m_s);
    EXPECT_EQ(-2.6F, config.min_linear_m_s);
}

TEST(RobotFileOfSimulator, CountsItsWayAndTurnAsTheScalesSay) {
    struct {
        const char *text;
        double scale_linear, scale_angular;
    } const files[] = {
        {"odometry_scale = 1.302\nscale_linear = 1.317\nscale_angular = 1.467\n", 1.317, 1.467},
        {"scale_linear = 0.9\nscale_angular = 1.2\n", 0.9, 1.2},
        {"odometry_scale = 1.302\nscale_angular = 1.467\n", 1.317, 1.467},
    };
    for (const auto &file : files) {
        const roburoc4_sim_config config = config_of(file.text);
        const double counted = config.odometry_scale;
        const double slip = config.slip;
        EXPECT_NEAR(file.scale_linear, counted / (1.0 - 0.1 * slip), 1e-3) << file.text;
        EXPECT_NEAR(file.scale_angular, counted / (1.0 - slip), 1e-3) << file.text;
    }
}

TEST(RobotFileOfSimulator, DoesNotSlipWhereItsWheelsCountLessInTurns) {
    const roburoc4_sim_config config = config_of("scale_linear = 1.2\nscale_angular = 1.1\n");
    EXPECT_EQ(0.0F, config.slip);
    EXPECT_FLOAT_EQ(1.2F, config.odometry_scale);
    EXPECT_EQ(0.9F, config_of("odometry_scale = -1\nscale_angular = 1.1\n").slip);
}

TEST(RobotFileOfSimulator, GivesServicesThatItDoesNotKnowFreeIds) {
    const roburoc4_sim_config config = config_of("iocard_id = 6\nbattery_id = 2\n");
    EXPECT_EQ(6, config.service_ids[ROBUROC4_SERVICE_IOCARD]);
    EXPECT_EQ(2, config.service_ids[ROBUROC4_SERVICE_BATTERY]);
}

} // namespace
