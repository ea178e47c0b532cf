/* SPDX-License-Identifier: MIT
 *
 * The pump's promises in virtual time: each has the time that it takes, on a robot that remembers
 * every command.
 */
#include "pump_calls.h"
#include "roburoc4_pump.h"
#include "system.h"

#include <gtest/gtest.h>

namespace {

using namespace virtual_system;
using test::on_client;
using test::socket_of;

/* A robot, and a pump that drives it. */
class Pump : public testing::Test {
  protected:
    Pump() {
        begin();
        robot_ = std::make_unique<Robot>();
        roburoc4_config_init(&config_, sizeof config_);
    }
    ~Pump() override {
        roburoc4_pump_destroy(pump_);
        EXPECT_EQ(sys.locks + sys.signals + sys.wakes + sys.threads + sys.sockets, 0);
        EXPECT_FALSE(sys.waited_with_lock);
    }
    roburoc4_pump *create() {
        roburoc4_result result = 1;
        const roburoc4_address address = robot_->address();
        pump_ = roburoc4_pump_create(&address, &config_, queue_, nullptr, &result);
        EXPECT_EQ(result, ROBUROC4_OK);
        return pump_;
    }
    void create_armed() {
        create();
        ASSERT_EQ(roburoc4_pump_arm(pump_, 10 * kSecond), ROBUROC4_OK);
        sleep_ms(500); /* all descriptions have come */
    }
    /* Drives for so long under the longest lease. */
    void drive_on(uint64_t for_ms = 200) {
        ASSERT_EQ(on_client(pump_, roburoc4_client_drive, 0.5f, 0.2f, 1000000u), ROBUROC4_OK);
        sleep_ms(for_ms);
        ASSERT_GE(robot_->speeds(), 2u);
        ASSERT_EQ(robot_->zeros_at_the_end(), 0u);
    }
    void create_driving() {
        create_armed();
        drive_on();
    }
    /* The last speed left before `by_us`, and at least three zeros followed it. */
    void expect_stopped_at(uint64_t by_us) const {
        EXPECT_LE(robot_->last_speed_us(), by_us + sys.delay_us);
        EXPECT_LE(robot_->first_zero_us(), by_us + sys.delay_us);
        EXPECT_GE(robot_->zeros_at_the_end(), 3u);
    }

    std::unique_ptr<Robot> robot_;
    roburoc4_config config_{};
    uint32_t queue_ = 0;
    roburoc4_pump *pump_ = nullptr;
};

TEST_F(Pump, Drives) {
    create_driving();
}

} // namespace
