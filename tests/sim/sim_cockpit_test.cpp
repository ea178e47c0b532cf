/* SPDX-License-Identifier: MIT
 *
 * sim_cockpit_test.cpp - what the person beside the simulated robot does: emergency stops, brakes,
 * motor power, game pad, battery and charger.
 */
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim_support.h"

using namespace roburoc4_tests;

namespace {

class SimCockpit : public testing::Test {
  protected:
    SimCockpit() {
        roburoc4_sim_clear_obstacles(sim());
    }

    [[nodiscard]] roburoc4_sim *sim() const {
        return robot.get();
    }

    SimRobot robot;
};

using SimMotors = SimCockpit;
using SimPad = SimCockpit;
using SimBattery = SimCockpit;

} // namespace

/* ---------------------------------------------------------------------------- motor power --- */

TEST_F(SimMotors, AreOnAtPowerOnUnlessStartSafe) {
    EXPECT_EQ(1, robot.state().motors_enabled);
    roburoc4_sim_config config = default_sim_config();
    config.start_safe = 1;
    SimRobot safe(config);
    EXPECT_EQ(0, safe.state().motors_enabled);
    safe.drive(1.0F, 0.0F, 100);
    EXPECT_EQ(0.0, safe.state().wheel_linear_m_s);
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(safe.get(), ROBUROC4_SIM_MOTOR_BUTTON, 1));
    safe.drive(1.0F, 0.0F, 100);
    EXPECT_GT(safe.state().wheel_linear_m_s, 0.5);
}

TEST_F(SimMotors, AsManualNeedTheButtonAndNoCharger) {
    roburoc4_sim_config config = default_sim_config();
    config.as_manual = 1;
    SimRobot manual(config);
    manual.drive(1.0F, 0.0F, 100);
    EXPECT_EQ(0.0, manual.state().wheel_linear_m_s) << "nobody pressed the green button";
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(manual.get(), ROBUROC4_SIM_MOTOR_BUTTON, 1));
    manual.drive(1.0F, 0.0F, 100);
    EXPECT_GT(manual.state().wheel_linear_m_s, 0.5);
    roburoc4_sim_set(manual.get(), ROBUROC4_SIM_CHARGER, 1);
    EXPECT_EQ(0, manual.state().motors_enabled);
    EXPECT_EQ(ROBUROC4_ERR_STATE, roburoc4_sim_set(manual.get(), ROBUROC4_SIM_MOTOR_BUTTON, 1));
    roburoc4_sim_set(manual.get(), ROBUROC4_SIM_CHARGER, 0);
    EXPECT_EQ(0, manual.state().motors_enabled) << "pulling the plug alone brings nothing back";
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(manual.get(), ROBUROC4_SIM_MOTOR_BUTTON, 1));
}

TEST_F(SimMotors, EitherEmergencyStopBrakesAndReportsTheTarget) {
    for (const auto which : {ROBUROC4_SIM_ESTOP_LOCAL, ROBUROC4_SIM_ESTOP_REMOTE}) {
        robot.drive(2.0F, 1.0F, 300);
        const double before = robot.state().wheel_linear_m_s;
        EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(sim(), std::uint32_t(which), 1));
        robot.drive(2.0F, 1.0F, 45);
        const auto state = robot.state();
        EXPECT_GT(before, 1.9);
        EXPECT_EQ(0.0, state.wheel_linear_m_s) << "45 cycles are enough";
        EXPECT_EQ(0.0, state.wheel_angular_rad_s);
        EXPECT_DOUBLE_EQ(2.0, state.target_linear_m_s);
        EXPECT_EQ(0, state.motors_enabled);
        EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(sim(), std::uint32_t(which), 0));
        robot.drive(2.0F, 1.0F, 50);
        EXPECT_EQ(0.0, robot.state().wheel_linear_m_s) << "releasing alone brings nothing back";
        EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(sim(), ROBUROC4_SIM_MOTOR_BUTTON, 1));
    }
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, roburoc4_sim_set(sim(), ROBUROC4_SIM_ESTOP_LOCAL, 2));
}

TEST_F(SimMotors, NeedBothStopsReleasedBrakesAutomaticAndPower) {
    for (int obstacle = 0; obstacle < 4; obstacle++) {
        (void)roburoc4_sim_set(sim(), ROBUROC4_SIM_ESTOP_LOCAL, obstacle == 0);
        (void)roburoc4_sim_set(sim(), ROBUROC4_SIM_ESTOP_REMOTE, obstacle == 1);
        (void)roburoc4_sim_set(sim(), ROBUROC4_SIM_BRAKES_RELEASED, obstacle == 2);
        roburoc4_sim_set(sim(), ROBUROC4_SIM_POWER, obstacle != 3);
        EXPECT_EQ(ROBUROC4_ERR_STATE, roburoc4_sim_set(sim(), ROBUROC4_SIM_MOTOR_BUTTON, 1))
            << obstacle;
        EXPECT_EQ(0, robot.state().motors_enabled) << obstacle;
    }
    (void)roburoc4_sim_set(sim(), ROBUROC4_SIM_ESTOP_REMOTE, 0);
    (void)roburoc4_sim_set(sim(), ROBUROC4_SIM_BRAKES_RELEASED, 0);
    roburoc4_sim_set(sim(), ROBUROC4_SIM_POWER, 1);
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(sim(), ROBUROC4_SIM_MOTOR_BUTTON, 1));
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, roburoc4_sim_set(sim(), ROBUROC4_SIM_BRAKES_RELEASED, 2));
}

/* -------------------------------------------------------------------------------- game pad --- */

TEST_F(SimPad, DrivesWhileAIsHeldAndCommandsAreIgnored) {
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_DIFFERENTIAL, 1));
    EXPECT_EQ(ROBUROC4_OK,
              roburoc4_sim_set(sim(), ROBUROC4_SIM_PAD_AXIS + ROBUROC4_AI_PAD_RT, 0.0F));
    EXPECT_EQ(ROBUROC4_OK,
              roburoc4_sim_set(sim(), ROBUROC4_SIM_PAD_AXIS + ROBUROC4_AI_PAD_LJ_X, -0.5F));
    robot.drive(-1.0F, 0.0F, 10);
    EXPECT_DOUBLE_EQ(-1.0, robot.state().target_linear_m_s) << "axes alone do nothing";
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(sim(), ROBUROC4_SIM_PAD_BUTTON + ROBUROC4_DI_PAD_A, 1));
    robot.take();
    robot.drive(-1.0F, 0.0F, 300);
    const auto state = robot.state();
    EXPECT_EQ(1, state.overridden);
    EXPECT_NEAR(1.3, state.target_linear_m_s, 1e-6) << "half a trigger, half of the speed";
    EXPECT_NEAR(3.25, state.target_angular_rad_s, 1e-6) << "stick to the left turns left";
    EXPECT_NEAR(1.3, state.wheel_linear_m_s, 0.03);
    EXPECT_EQ(30U, state.refused_speed_commands);
    EXPECT_EQ(300U, robot.take().size()) << "statuses continue";
}

TEST_F(SimPad, AxesHaveTheManualsDirections) {
    (void)roburoc4_sim_set(sim(), ROBUROC4_SIM_PAD_BUTTON + ROBUROC4_DI_PAD_A, 1);
    robot.run(1);
    EXPECT_EQ(0.0, robot.state().target_linear_m_s) << "triggers rest at -1";
    (void)roburoc4_sim_set(sim(), ROBUROC4_SIM_PAD_AXIS + ROBUROC4_AI_PAD_LT, 1.0F);
    (void)roburoc4_sim_set(sim(), ROBUROC4_SIM_PAD_AXIS + ROBUROC4_AI_PAD_LJ_X, 1.0F);
    robot.run(1);
    EXPECT_NEAR(-2.6, robot.state().target_linear_m_s, 1e-6);
    EXPECT_NEAR(-6.5, robot.state().target_angular_rad_s, 1e-6) << "right is clockwise";
    (void)roburoc4_sim_set(sim(), ROBUROC4_SIM_PAD_AXIS + ROBUROC4_AI_PAD_LJ_X, 0.04F);
    robot.run(1);
    EXPECT_EQ(0.0, robot.state().target_angular_rad_s) << "a stick is never quite at 0";
}

TEST_F(SimPad, ReleaseGivesUdpBackWithTargetZeroUntilTheNextCommand) {
    robot.command(1.0F, 0.0F);
    (void)roburoc4_sim_set(sim(), ROBUROC4_SIM_PAD_AXIS + ROBUROC4_AI_PAD_RT, 1.0F);
    (void)roburoc4_sim_set(sim(), ROBUROC4_SIM_PAD_BUTTON + ROBUROC4_DI_PAD_A, 1);
    robot.run(50);
    (void)roburoc4_sim_set(sim(), ROBUROC4_SIM_PAD_BUTTON + ROBUROC4_DI_PAD_A, 0);
    EXPECT_EQ(0.0, robot.state().target_linear_m_s);
    robot.run(30);
    EXPECT_EQ(0.0, robot.state().target_linear_m_s);
    robot.command(0.25F, 0.0F);
    robot.run(1);
    EXPECT_DOUBLE_EQ(0.25, robot.state().target_linear_m_s);
    EXPECT_EQ(0, robot.state().overridden);
}

TEST_F(SimPad, ReleasePadReleasesEverything) {
    (void)roburoc4_sim_set(sim(), ROBUROC4_SIM_PAD_AXIS + ROBUROC4_AI_PAD_RT, 1.0F);
    (void)roburoc4_sim_set(sim(), ROBUROC4_SIM_PAD_BUTTON + ROBUROC4_DI_PAD_A, 1);
    robot.run(10);
    roburoc4_sim_set(sim(), ROBUROC4_SIM_PAD, 0);
    EXPECT_EQ(0, robot.state().overridden);
    EXPECT_EQ(0.0, robot.state().target_linear_m_s);
    robot.command(0.25F, 0.0F);
    roburoc4_sim_set(sim(), ROBUROC4_SIM_PAD, 0);
    EXPECT_DOUBLE_EQ(0.25, robot.state().target_linear_m_s) << "nobody held it";
}

/* --------------------------------------------------------------------------------- battery --- */

TEST_F(SimBattery, DrainsMoreWhenDriving) {
    SimRobot idle;
    const float full = robot.state().battery_percent;
    idle.run(60000);
    for (int turn = 0; turn < 10; turn++)
        robot.drive(turn % 2 == 0 ? 1.5F : -1.5F, 0.5F, 6000);
    const float resting = full - idle.state().battery_percent;
    const float working = full - robot.state().battery_percent;
    EXPECT_NEAR(0.52, double(resting), 0.05) << "45 W for ten minutes of 1440 Wh";
    EXPECT_GT(working, 2.0F * resting);
}

TEST_F(SimBattery, ChargesThenIsChargedThenOk) {
    EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(sim(), ROBUROC4_SIM_BATTERY_PERCENT, 99.9F));
    EXPECT_EQ(unsigned(ROBUROC4_BATTERY_OK), robot.state().battery_state);
    const float before = robot.state().battery_v;
    roburoc4_sim_set(sim(), ROBUROC4_SIM_CHARGER, 1);
    EXPECT_EQ(unsigned(ROBUROC4_BATTERY_CHARGING), robot.state().battery_state);
    EXPECT_GT(robot.state().battery_v, before);
    robot.run(3000);
    EXPECT_EQ(unsigned(ROBUROC4_BATTERY_CHARGED), robot.state().battery_state);
    EXPECT_FLOAT_EQ(100.0F, robot.state().battery_percent);
    roburoc4_sim_set(sim(), ROBUROC4_SIM_CHARGER, 0);
    EXPECT_EQ(unsigned(ROBUROC4_BATTERY_OK), robot.state().battery_state);
}

TEST_F(SimBattery, IsCriticalWhenThePercentIsBelowTheMinimum) {
    EXPECT_EQ(0, robot.insert(ROBUROC4_SERVICE_BATTERY, 1));
    for (float percent = 22.0F; percent > 18.0F; percent -= 0.05F) {
        EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_set(sim(), ROBUROC4_SIM_BATTERY_PERCENT, percent));
        robot.take();
        robot.run(1);
        roburoc4_battery_status status{};
        const Bytes bytes = robot.take().at(0).bytes;
        ASSERT_EQ(0, roburoc4_decode_battery_status(bytes.data(), bytes.size(), &status));
        ASSERT_EQ(status.remaining_percent < 20 ? ROBUROC4_BATTERY_CRITICAL : ROBUROC4_BATTERY_OK,
                  status.state)
            << percent;
    }
}

/* 5.5.3: the battery service has only the voltage to go by. */
TEST_F(SimBattery, AsManualGoesByTheVoltage) {
    roburoc4_sim_config config = default_sim_config();
    config.as_manual = 1;
    SimRobot manual(config);
    const auto status = [&manual] {
        roburoc4_battery_status out{};
        manual.take();
        manual.run(1);
        const Bytes bytes = manual.take().at(0).bytes;
        EXPECT_EQ(0, roburoc4_decode_battery_status(bytes.data(), bytes.size(), &out));
        return out;
    };
    EXPECT_EQ(0, manual.insert(ROBUROC4_SERVICE_BATTERY, 1));
    for (const float percent : {100.0F, 60.0F, 25.0F, 0.0F}) {
        EXPECT_EQ(ROBUROC4_OK,
                  roburoc4_sim_set(manual.get(), ROBUROC4_SIM_BATTERY_PERCENT, percent));
        EXPECT_NEAR(double(percent), status().remaining_percent, 3.0) << "idle, it hardly sags";
    }
    EXPECT_EQ(
        ROBUROC4_OK,
        roburoc4_sim_set(manual.get(), ROBUROC4_SIM_PIN_ANALOG + ROBUROC4_AI_BATTERY_V, 22.9F));
    EXPECT_NEAR(8.0, status().remaining_percent, 1.0);
    EXPECT_EQ(ROBUROC4_BATTERY_CRITICAL, status().state);
    EXPECT_EQ(ROBUROC4_OK,
              roburoc4_sim_set(manual.get(), ROBUROC4_SIM_PIN_ANALOG + ROBUROC4_AI_BATTERY_V,
                               std::numeric_limits<float>::quiet_NaN()));
    EXPECT_EQ(0, status().remaining_percent);
}
