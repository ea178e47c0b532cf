/* SPDX-License-Identifier: MIT
 *
 * The pump's promises in virtual time: each has the time that it takes, on a robot that remembers
 * every command.
 */
#include "pcapng.h"
#include "pump_calls.h"
#include "roburoc4_pump.h"
#include "system.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

extern "C" {
#include "os.h"
}

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
        sys.starves = false;
        roburoc4_pump_destroy(pump_);
        EXPECT_EQ(left(), 0);
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
        sleep_ms(507); /* all descriptions have come; between two statuses */
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
        sleep_ms(1); /* the last has arrived */
        EXPECT_LE(robot_->last_speed_us(), by_us + sys.delay_us);
        EXPECT_LE(robot_->first_zero_us(), by_us + sys.delay_us);
        EXPECT_GE(robot_->zeros_at_the_end(), 3u);
    }

    std::unique_ptr<Robot> robot_;
    roburoc4_config config_{};
    uint32_t queue_ = 0;
    roburoc4_pump *pump_ = nullptr;
};

/* ---------------------------------------------------------------------------------- motion --- */

TEST_F(Pump, AProgramThatHangsStopsTheRobotWhenItsLeaseEnds) {
    create_armed();
    const uint64_t granted_us = sys.now_us;
    drive_on();
    sleep_ms(3000); /* nobody calls drive */
    EXPECT_EQ(robot_->first_zero_us(), granted_us + kSecond + sys.delay_us);
    EXPECT_GE(robot_->last_speed_us(), granted_us + kSecond - 50 * kMs)
        << "within the lease the speed is repeated";
    EXPECT_EQ(robot_->speeds(), 20u);
    EXPECT_GE(robot_->zeros_at_the_end(), 3u);
    EXPECT_LE(robot_->zeros_at_the_end(), 5u) << "the robot confirms";
}

TEST_F(Pump, AMachineThatHangsSendsNoSpeedAfterwards) {
    create_driving();
    stall_ms(1100);
    const uint64_t awake_us = sys.now_us;
    const size_t speeds = robot_->speeds();
    sleep_ms(500);
    EXPECT_EQ(robot_->speeds(), speeds);
    EXPECT_EQ(robot_->first_zero_us(), awake_us + sys.delay_us);
}

TEST_F(Pump, AMachineThatHungLosesNoRobotWhoseStatusesWait) {
    create_armed();
    roburoc4_pump_reader reader{};
    roburoc4_pump_reader_init(pump_, &reader);
    stall_ms(2500);
    EXPECT_EQ(roburoc4_pump_wait_events(pump_, &reader, ROBUROC4_EVENT_LOST, kSecond), 0);
}

TEST_F(Pump, WhoseThreadStarvesReceivesInThoseOfTheProgram) {
    create_driving();
    sys.starves = true;
    for (int i = 0; i < 200; i++) {
        ASSERT_EQ(on_client(pump_, roburoc4_client_drive, 0.5f, 0.2f, 1000000u), ROBUROC4_OK) << i;
        sleep_ms(10);
    }
    EXPECT_EQ(robot_->zeros_at_the_end(), 0u);
}

TEST_F(Pump, DrivesAMoveToItsEnd) {
    create_armed();
    roburoc4_move move{};
    ASSERT_EQ(roburoc4_move_by(&move, 0.5f, 0.0f, nullptr), ROBUROC4_OK);
    EXPECT_EQ(roburoc4_pump_move(pump_, &move), ROBUROC4_MOVE_REACHED);
    roburoc4_facts facts{};
    facts.size = sizeof facts;
    EXPECT_EQ(on_client(pump_, roburoc4_client_facts, sys.now_us, &facts), ROBUROC4_OK);
    EXPECT_FALSE(facts.driving);
    EXPECT_NEAR(robot_->state().odometry_x_m, 0.5, 0.05);
    EXPECT_EQ(roburoc4_pump_move(pump_, &move), ROBUROC4_MOVE_REACHED) << "it has ended";
    EXPECT_EQ(on_client(pump_, roburoc4_client_drive, 0.1f, 0.0f, 0u), ROBUROC4_OK) << "armed";
}

TEST_F(Pump, DrivesOneMoveAtATime) {
    create_armed();
    roburoc4_move move{}, other{};
    ASSERT_EQ(roburoc4_move_by(&move, 0.5f, 0.0f, nullptr), ROBUROC4_OK);
    ASSERT_EQ(roburoc4_move_by(&other, -0.5f, 0.0f, nullptr), ROBUROC4_OK);
    Thread second([&] {
        sleep_ms(500);
        EXPECT_EQ(roburoc4_pump_move(pump_, &other), ROBUROC4_ERR_BUSY);
    });
    EXPECT_EQ(roburoc4_pump_move(pump_, &move), ROBUROC4_MOVE_REACHED);
    second.join();
    EXPECT_EQ(roburoc4_pump_move(pump_, &other), ROBUROC4_MOVE_REACHED);
    EXPECT_NEAR(robot_->state().odometry_x_m, 0.0, 0.05);
}

TEST_F(Pump, ARequestedStopEndsItsMove) {
    create_armed();
    roburoc4_move move{};
    ASSERT_EQ(roburoc4_move_by(&move, 5.0f, 0.0f, nullptr), ROBUROC4_OK);
    const uint64_t stop_us = sys.now_us + 2 * kSecond;
    at(stop_us, [&] { roburoc4_pump_request_stop(pump_); });
    EXPECT_EQ(roburoc4_pump_move(pump_, &move), ROBUROC4_MOVE_CANCELLED);
    EXPECT_LE(sys.now_us, stop_us + 100 * kMs);
    EXPECT_GE(robot_->speeds(), 2u);
    sleep_ms(500);
    EXPECT_LE(robot_->first_zero_us(), stop_us + 10 * kMs + sys.delay_us);
    EXPECT_EQ(on_client(pump_, roburoc4_client_drive, 0.1f, 0.0f, 0u), ROBUROC4_ERR_STOP_CALLED);
}

TEST_F(Pump, AStopRightBeforeAMoveEndsItAtOnce) {
    create_armed();
    roburoc4_move move{};
    ASSERT_EQ(roburoc4_move_by(&move, 5.0f, 0.0f, nullptr), ROBUROC4_OK);
    const uint64_t asked_us = sys.now_us;
    roburoc4_pump_request_stop(pump_);
    EXPECT_EQ(roburoc4_pump_move(pump_, &move), ROBUROC4_MOVE_CANCELLED);
    EXPECT_EQ(sys.now_us, asked_us);
    EXPECT_EQ(robot_->speeds(), 0u);
}

TEST_F(Pump, AMoveSpeedsUpEvenlyAlsoWhileTheRobotIsQuiet) {
    for (int service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++) {
        config_.period_ms[service] = 330;
    }
    config_.fresh_ms = 1000;
    config_.lost_ms = 5000;
    create_armed();
    roburoc4_move move{};
    ASSERT_EQ(roburoc4_move_for(&move, 0.3f, 0.0f, 3000, nullptr), ROBUROC4_OK);
    EXPECT_EQ(roburoc4_pump_move(pump_, &move), ROBUROC4_MOVE_REACHED);
    const float step = 0.5f * 0.075f; /* a drive period and a step, at 0.5 m/s^2 */
    for (size_t i = 1; i < robot_->commands.size(); i++) {
        EXPECT_NEAR(robot_->commands[i].linear_m_s, robot_->commands[i - 1].linear_m_s, step) << i;
    }
}

TEST_F(Pump, TheZeroThatEndsAMoveLeavesBeforeTheCallReturns) {
    create_armed();
    roburoc4_move move{};
    ASSERT_EQ(roburoc4_move_by(&move, 5.0f, 0.0f, nullptr), ROBUROC4_OK);
    at(sys.now_us + 2 * kSecond, [&] { robot_->panel("front bumper press"); });
    EXPECT_EQ(roburoc4_pump_move(pump_, &move), ROBUROC4_MOVE_BUMPER);
    const uint64_t ended_us = sys.now_us;
    sleep_ms(1);
    EXPECT_GE(robot_->speeds(), 2u);
    EXPECT_EQ(robot_->first_zero_us(), ended_us + sys.delay_us);
}

TEST_F(Pump, CloseEndsAMoveThatDrives) {
    create_armed();
    roburoc4_move move{};
    ASSERT_EQ(roburoc4_move_by(&move, 5.0f, 0.0f, nullptr), ROBUROC4_OK);
    Thread other([&] {
        sleep_ms(2000);
        EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
    });
    const uint64_t closes_us = sys.now_us + 2 * kSecond;
    EXPECT_EQ(roburoc4_pump_move(pump_, &move), ROBUROC4_ERR_CLOSED);
    EXPECT_EQ(sys.now_us, closes_us) << "when the stop sequence begins";
    other.join();
    expect_stopped_at(closes_us);
}

TEST_F(Pump, AClosedOneDrivesNoMove) {
    create_armed();
    roburoc4_move move{};
    ASSERT_EQ(roburoc4_move_by(&move, 0.5f, 0.0f, nullptr), ROBUROC4_OK);
    ASSERT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
    EXPECT_EQ(roburoc4_pump_move(pump_, &move), ROBUROC4_ERR_CLOSED);
    EXPECT_EQ(robot_->speeds(), 0u);
}

TEST_F(Pump, FeedsALeaseWhileTheRobotIsQuiet) {
    for (int service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++) {
        config_.period_ms[service] = 330; /* no status wakes the pump in time */
    }
    config_.fresh_ms = 1000;
    config_.lost_ms = 5000;
    create_armed();
    sys.delay_us = 60 * kMs; /* nor does an answer */
    sleep_ms(2000);
    for (int round = 0; round < 20; round++) {
        robot_->commands.clear();
        ASSERT_EQ(on_client(pump_, roburoc4_client_arm), ROBUROC4_OK);
        ASSERT_EQ(on_client(pump_, roburoc4_client_drive, 0.5f, 0.0f, 500000u), ROBUROC4_OK);
        sleep_ms(495 + 60);
        ASSERT_EQ(robot_->commands.size(), 10u) << round;
        for (size_t i = 1; i < 10; i++) {
            EXPECT_EQ(robot_->commands[i].at_us - robot_->commands[i - 1].at_us, 50 * kMs);
        }
        sleep_ms(1522); /* other times of the robot's statuses */
    }
}

TEST_F(Pump, SendsCommandsBeforeTheCallReturns) {
    create_armed();
    const uint64_t mask = uint64_t{1} << 3;
    const auto commands_since = [](size_t before) {
        return std::count_if(sys.sent.begin() + static_cast<std::ptrdiff_t>(before), sys.sent.end(),
                             [](const Bytes &bytes) { return bytes[0] == 0xFF; });
    };
    size_t before = sys.sent.size();
    ASSERT_EQ(on_client(pump_, roburoc4_client_set_digital_outputs, mask, mask), ROBUROC4_OK);
    EXPECT_EQ(commands_since(before), 1);
    before = sys.sent.size();
    ASSERT_EQ(on_client(pump_, roburoc4_client_drive, 0.1f, 0.0f, 0u), ROBUROC4_OK);
    EXPECT_EQ(commands_since(before), 1);
    EXPECT_EQ(sys.sent_us.back(), sys.now_us);
}

TEST_F(Pump, AFloodDoesNotKeepTheZerosFromTheRobot) {
    create_driving();
    sys.receive_forever = true;
    sys.receive_takes_us = 100;
    const uint64_t asked_us = sys.now_us;
    roburoc4_pump_request_stop(pump_);
    sleep_ms(30);
    EXPECT_LE(robot_->first_zero_us(), asked_us + 10 * kMs);
    sleep_ms(300);
    sys.receive_forever = false;
    sys.receive_takes_us = 0;
    for (size_t i = 1; i < robot_->zeros_at_the_end(); i++) {
        const auto *last = &robot_->commands.back() - i;
        EXPECT_LE(last[1].at_us - last[0].at_us, 60 * kMs);
    }
    EXPECT_GE(robot_->zeros_at_the_end(), 3u);
}

/* ------------------------------------------------------------------------------ an absent robot */

TEST_F(Pump, RetriesAnAbsentRobotWithoutSpinningAndFindsItLater) {
    robot_ = nullptr;
    robot_ = std::make_unique<Robot>(60001); /* at another port */
    roburoc4_address address = robot_->address();
    address.port = 60000;
    pump_ = roburoc4_pump_create(&address, &config_, 0, nullptr, nullptr);
    sleep_ms(10000);
    EXPECT_LE(sys.waits, 100);
    EXPECT_GE(sys.sent.size(), 8u);
    EXPECT_EQ(socket_of(pump_).fault, uint32_t{ROBUROC4_FAULT_REFUSED});
    EXPECT_EQ(on_client(pump_, roburoc4_client_arm), ROBUROC4_ERR_NOT_READY);
    robot_ = std::make_unique<Robot>();
    EXPECT_EQ(roburoc4_pump_arm(pump_, 3 * kSecond), ROBUROC4_OK);
}

TEST_F(Pump, ASocketWithoutARouteIsNeitherReadNorWaitedForNorReconnectedAfterClose) {
    sys.connect_fault = ROBUROC4_FAULT_UNREACHABLE;
    sys.receive_forever = true; /* from anybody */
    create();
    sleep_ms(10000);
    EXPECT_LE(sys.waits, 100);
    EXPECT_EQ(sys.receive_calls, 0);
    EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
    const size_t connects = sys.connects_us.size();
    sleep_ms(5000);
    EXPECT_EQ(on_client(pump_, roburoc4_client_state), uint32_t{ROBUROC4_STATE_IDLE});
    EXPECT_EQ(sys.connects_us.size(), connects);
}

TEST_F(Pump, ASocketThatCannotBeWaitedForOrReadDoesNotMakeItSpin) {
    create_armed();
    sys.waits_fail = true;
    int before = sys.waits;
    sleep_ms(10000);
    EXPECT_LE(sys.waits - before, 20000 / 50 * 2 + 210) << "the client's own deadlines, twice";
    sys.waits_fail = false;
    sys.receives.assign(1000000, ROBUROC4_OS_BROKEN);
    sleep_ms(100);
    before = sys.waits;
    const int calls = sys.receive_calls;
    sleep_ms(10000);
    EXPECT_GE(sys.waits - before, 95);
    EXPECT_LE(sys.waits - before, 150);
    EXPECT_LE(sys.receive_calls - calls, 150);
    sys.receives.clear();
}

TEST_F(Pump, ASocketThatCannotBeReadOrWaitedForDelaysNoCommand) {
    create_armed();
    for (const bool waits_fail : {false, true}) {
        sleep_ms(1000);
        ASSERT_EQ(roburoc4_pump_arm(pump_, kSecond), ROBUROC4_OK);
        robot_->commands.clear();
        sys.receives.assign(waits_fail ? 0 : 1000000, ROBUROC4_OS_BROKEN);
        sys.waits_fail = waits_fail;
        const uint64_t granted_us = sys.now_us;
        ASSERT_EQ(on_client(pump_, roburoc4_client_drive, 0.5f, 0.0f, 200000u), ROBUROC4_OK);
        sleep_ms(600);
        sys.receives.clear();
        EXPECT_EQ(robot_->speeds(), 4u);
        EXPECT_EQ(robot_->first_zero_us(), granted_us + 200 * kMs + sys.delay_us);
        for (size_t i = 1; i < robot_->commands.size(); i++) {
            EXPECT_EQ(robot_->commands[i].at_us - robot_->commands[i - 1].at_us, 50 * kMs);
        }
    }
    sys.waits_fail = false;
}

TEST_F(Pump, ALossIsReportedWhenItHappens) {
    create_armed();
    roburoc4_pump_reader reader{};
    roburoc4_pump_reader_init(pump_, &reader);
    robot_->silent = true;
    const uint64_t silent_us = sys.now_us;
    EXPECT_GT(roburoc4_pump_wait_events(pump_, &reader, ROBUROC4_EVENT_LOST, 10 * kSecond), 0);
    EXPECT_GE(sys.now_us, silent_us + (config_.lost_ms - 100) * kMs);
    EXPECT_LE(sys.now_us, silent_us + config_.lost_ms * kMs);
}

/* ---------------------------------------------------------------------------------- arming --- */

TEST_F(Pump, ArmingTakesTheTimeThatItWasGivenAndNoMore) {
    robot_->silent = true;
    create();
    const uint64_t began_us = sys.now_us;
    EXPECT_EQ(roburoc4_pump_arm(pump_, 50000), ROBUROC4_ERR_NOT_READY);
    EXPECT_EQ(sys.now_us, began_us + 50000);
    EXPECT_EQ(roburoc4_pump_arm(pump_, 0), ROBUROC4_ERR_NOT_READY);
    EXPECT_EQ(sys.now_us, began_us + 50000);
    at(began_us + 2 * kSecond, [&] { robot_->silent = false; });
    EXPECT_EQ(roburoc4_pump_arm(pump_, UINT32_MAX), ROBUROC4_OK);
    EXPECT_GE(sys.now_us, began_us + 2 * kSecond);
    EXPECT_LE(sys.now_us, began_us + 4 * kSecond);
    EXPECT_EQ(on_client(pump_, roburoc4_client_drive, 0.5f, 0.0f, 0u), ROBUROC4_OK);
}

TEST_F(Pump, ArmingCountsTheTimeInWhichItWaitsForTheLock) {
    robot_->silent = true;
    create();
    Thread other([&] {
        (void)roburoc4_pump_lock(pump_);
        sleep_ms(100);
        roburoc4_pump_unlock(pump_);
    });
    sleep_ms(1);
    const uint64_t began_us = sys.now_us;
    EXPECT_EQ(roburoc4_pump_arm(pump_, 50000), ROBUROC4_ERR_NOT_READY);
    EXPECT_EQ(sys.now_us, began_us + 99 * kMs);
    other.join();
}

TEST_F(Pump, ArmingRefusesAtOnceWhatWaitingCannotChange) {
    create_armed();
    roburoc4_pump_reader reader{};
    roburoc4_pump_reader_init(pump_, &reader);
    ASSERT_TRUE(robot_->panel("pad a down"));
    ASSERT_GT(roburoc4_pump_wait_events(pump_, &reader, ROBUROC4_EVENT_OVERRIDE, kSecond), 0);
    const uint64_t began_us = sys.now_us;
    EXPECT_EQ(roburoc4_pump_arm(pump_, UINT32_MAX), ROBUROC4_ERR_OVERRIDE);
    EXPECT_EQ(sys.now_us, began_us);
    ASSERT_TRUE(robot_->panel("pad a up"));
    EXPECT_GT(roburoc4_pump_wait_events(pump_, &reader, ROBUROC4_EVENT_ARMABLE, kSecond), 0);
    EXPECT_EQ(roburoc4_pump_arm(pump_, 0), ROBUROC4_OK);
    EXPECT_GT(roburoc4_pump_wait_events(pump_, &reader, ROBUROC4_EVENT_ARMED, 0), 0);
}

TEST_F(Pump, ArmingIsEndedByAStopAndByTheEnd) {
    robot_->silent = true;
    create();
    for (const roburoc4_result expected : {ROBUROC4_ERR_STOP_CALLED, ROBUROC4_ERR_CLOSED}) {
        const uint64_t ends_us = sys.now_us + 50 * kMs;
        Thread later([&] {
            sleep_ms(50);
            if (expected == ROBUROC4_ERR_STOP_CALLED) {
                roburoc4_pump_request_stop(pump_);
            } else {
                roburoc4_pump_close(pump_);
            }
        });
        EXPECT_EQ(roburoc4_pump_arm(pump_, UINT32_MAX), expected);
        EXPECT_EQ(sys.now_us, ends_us);
    }
    EXPECT_EQ(roburoc4_pump_arm(pump_, UINT32_MAX), ROBUROC4_ERR_CLOSED);
}

TEST_F(Pump, AStopRightBeforeArmingWinsOnceOnly) {
    create_armed();
    roburoc4_pump_request_stop(pump_);
    EXPECT_EQ(roburoc4_pump_arm(pump_, 0), ROBUROC4_ERR_STOP_CALLED) << "asked for before the call";
    EXPECT_EQ(roburoc4_pump_arm(pump_, kSecond), ROBUROC4_OK);
}

/* ------------------------------------------------------------------------------------- the end */

TEST_F(Pump, CloseStopsADrivingRobotAtOnce) {
    create_driving();
    const uint64_t asked_us = sys.now_us;
    EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
    expect_stopped_at(asked_us);
    EXPECT_LE(sys.now_us, asked_us + 300 * kMs) << "the robot confirms it";
    EXPECT_EQ(roburoc4_pump_running(pump_), 0);
    EXPECT_EQ(on_client(pump_, roburoc4_client_state), uint32_t{ROBUROC4_STATE_IDLE});
    EXPECT_EQ(robot_->state().watchdog_tripped, 0);
    const uint64_t closed_us = sys.now_us;
    EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK) << "a second time";
    EXPECT_EQ(sys.now_us, closed_us);
}

TEST_F(Pump, CloseOfARobotAtRestTakesNoTime) {
    create_armed();
    const uint64_t asked_us = sys.now_us;
    EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
    EXPECT_EQ(sys.now_us, asked_us);
    EXPECT_TRUE(robot_->commands.empty());
}

TEST_F(Pump, CloseSendsZerosToASilentRobotForItsWatchdogsTime) {
    for (const uint32_t watchdog_ms : {300u, 1000u, 3000u}) {
        begin();
        robot_ = std::make_unique<Robot>();
        config_.robot_watchdog_ms = watchdog_ms;
        create_armed();
        drive_on();
        robot_->silent = true;
        const uint64_t asked_us = sys.now_us;
        EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
        expect_stopped_at(asked_us);
        EXPECT_GE(sys.now_us, asked_us + watchdog_ms * kMs);
        EXPECT_LE(sys.now_us, asked_us + (watchdog_ms + 50) * kMs);
        EXPECT_GE(robot_->zeros_at_the_end(), watchdog_ms / 50u);
        EXPECT_LE(robot_->zeros_at_the_end(), watchdog_ms / 50u + 1);
        roburoc4_pump_destroy(pump_);
        pump_ = nullptr;
    }
}

TEST_F(Pump, CloseSendsThreeZerosHoweverLongTheirPeriodIs) {
    config_.robot_watchdog_ms = 300;
    config_.drive_period_ms = 150;
    config_.lease_ms = 1000;
    create_armed();
    ASSERT_EQ(on_client(pump_, roburoc4_client_drive, 0.5f, 0.2f, 1000000u), ROBUROC4_OK);
    sleep_ms(300);
    robot_->silent = true;
    const uint64_t asked_us = sys.now_us;
    EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
    EXPECT_LE(sys.now_us, asked_us + 3 * 150 * kMs);
    expect_stopped_at(asked_us);
    EXPECT_EQ(robot_->zeros_at_the_end(), 3u);
}

TEST_F(Pump, CloseReturnsAlsoWhereTheSystemRefusesEveryDatagram) {
    create_driving();
    sys.send_fault = ROBUROC4_FAULT_FULL;
    const uint64_t asked_us = sys.now_us;
    EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
    EXPECT_LE(sys.now_us, asked_us + 1500 * kMs);
}

TEST_F(Pump, CloseOfAMachineThatHangsTakesNoLongerThanPromised) {
    for (const uint64_t stall : {1490u, 2000u}) {
        begin();
        robot_ = std::make_unique<Robot>();
        create_driving();
        const uint64_t asked_us = sys.now_us;
        at(asked_us + 1, [=] { stall_ms(stall); });
        EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
        EXPECT_EQ(sys.now_us, stall < 1500 ? asked_us + 1500 * kMs : asked_us + 1 + stall * kMs);
        roburoc4_pump_destroy(pump_);
        pump_ = nullptr;
    }
}

TEST_F(Pump, TwoThatCloseBothWaitForTheStop) {
    create_driving();
    robot_->silent = true;
    const uint64_t asked_us = sys.now_us;
    uint64_t other_us = 0;
    Thread other([&] {
        EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
        other_us = sys.now_us;
    });
    EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
    other.join();
    EXPECT_GE(sys.now_us, asked_us + kSecond);
    EXPECT_EQ(other_us, sys.now_us);
}

TEST_F(Pump, CloseWakesAllWaitingThreadsWhenItBegins) {
    create_driving();
    robot_->silent = true;
    sleep_ms(10);
    const uint64_t closes_us = sys.now_us + 300 * kMs;
    std::vector<std::unique_ptr<Thread>> threads;
    int closed = 0;
    for (int i = 0; i < 6; i++) {
        threads.push_back(std::make_unique<Thread>([&, i] {
            roburoc4_pump_reader reader{};
            roburoc4_pump_reader_init(pump_, &reader);
            const roburoc4_result result =
                i % 2 == 0
                    ? roburoc4_pump_wait_samples(pump_, &reader, UINT32_MAX)
                    : roburoc4_pump_wait_events(pump_, &reader, ROBUROC4_EVENT_READY, UINT32_MAX);
            closed += result == ROBUROC4_ERR_CLOSED && sys.now_us == closes_us;
        }));
    }
    sleep_ms(300);
    EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
    threads.clear();
    EXPECT_EQ(closed, 6);
}

TEST_F(Pump, AfterAWaitSaidThatNoMoreWillComeNoneComes) {
    create_driving();
    Thread other([&] { EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK); });
    sleep_us(1);
    roburoc4_pump_reader reader{};
    roburoc4_pump_reader_init(pump_, &reader);
    EXPECT_EQ(roburoc4_pump_wait_samples(pump_, &reader, UINT32_MAX), ROBUROC4_ERR_CLOSED);
    other.join();
    sleep_ms(200);
    roburoc4_sample sample;
    EXPECT_EQ(roburoc4_pump_read_samples(pump_, &reader, &sample, 1), ROBUROC4_ERR_CLOSED);
}

TEST_F(Pump, DestroyWaitsForWaitingThreads) {
    robot_->silent = true;
    for (uint64_t seed = 0; seed < 50; seed++) {
        sys.seed = seed;
        create();
        roburoc4_result result = 0;
        Thread waiter([&] {
            roburoc4_pump_reader reader{};
            result = roburoc4_pump_wait_samples(pump_, &reader, UINT32_MAX);
        });
        sleep_ms(10);
        const uint64_t asked_us = sys.now_us;
        roburoc4_pump_destroy(pump_);
        EXPECT_EQ(sys.now_us, asked_us) << "no longer than they take to return";
        waiter.join();
        EXPECT_EQ(result, ROBUROC4_ERR_CLOSED);
    }
    pump_ = nullptr;
}

TEST_F(Pump, ClosedLeavesValuesReadableAndRefusesCommands) {
    create_armed();
    roburoc4_pump_reader reader{};
    ASSERT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
    roburoc4_pump *p = pump_;
    EXPECT_EQ(on_client(p, roburoc4_client_arm), ROBUROC4_ERR_NOT_READY);
    EXPECT_EQ(on_client(p, roburoc4_client_stop), ROBUROC4_ERR_STATE);
    EXPECT_EQ(on_client(p, roburoc4_client_drive, 0.0f, 0.0f, 0u), ROBUROC4_ERR_DISARMED);
    EXPECT_EQ(on_client(p, roburoc4_client_pause), ROBUROC4_ERR_STATE);
    EXPECT_EQ(on_client(p, service_count), uint32_t{ROBUROC4_SERVICE_COUNT});
    roburoc4_sample samples[64];
    roburoc4_result got;
    uint64_t read = 0;
    EXPECT_GT(roburoc4_pump_wait_samples(p, &reader, UINT32_MAX), 0);
    EXPECT_EQ(roburoc4_pump_read_samples(p, &reader, samples, 0), 0) << "some are left";
    while ((got = roburoc4_pump_read_samples(p, &reader, samples, 64)) > 0) {
        read += static_cast<uint64_t>(got);
    }
    EXPECT_GT(read, 0u) << "what came before the end can be read";
    EXPECT_EQ(got, ROBUROC4_ERR_CLOSED);
    EXPECT_EQ(roburoc4_pump_wait_samples(p, &reader, UINT32_MAX), ROBUROC4_ERR_CLOSED);
    EXPECT_GT(roburoc4_pump_take_events(p, &reader), 0);
    EXPECT_EQ(roburoc4_pump_take_events(p, &reader), ROBUROC4_ERR_CLOSED);
    EXPECT_EQ(roburoc4_pump_arm(p, UINT32_MAX), ROBUROC4_ERR_CLOSED);
}

/* ----------------------------------------------------------------------------- request_stop() */

TEST_F(Pump, RequestStopStopsTheRobotAtOnceAndDisarms) {
    create_driving();
    sleep_ms(17); /* in between two commands and statuses */
    const uint64_t asked_us = sys.now_us;
    roburoc4_pump_request_stop(pump_);
    EXPECT_EQ(sys.now_us, asked_us) << "it never waits";
    sleep_ms(300);
    expect_stopped_at(asked_us);
    EXPECT_EQ(robot_->first_zero_us(), asked_us + sys.delay_us);
    EXPECT_EQ(on_client(pump_, roburoc4_client_drive, 0.5f, 0.0f, 0u), ROBUROC4_ERR_STOP_CALLED);
    EXPECT_EQ(roburoc4_pump_running(pump_), 1) << "the link lives on";
    EXPECT_EQ(roburoc4_pump_arm(pump_, kSecond), ROBUROC4_OK) << "as after any stop()";
    drive_on();
}

TEST_F(Pump, RequestStopByAHandlerOfTheThreadWithTheLockSendsNoLaterSpeed) {
    create_driving();
    roburoc4_client *client = roburoc4_pump_lock(pump_);
    roburoc4_pump_request_stop(pump_);
    EXPECT_EQ(roburoc4_client_drive(client, 0.7f, 0.0f, 0, sys.now_us), ROBUROC4_OK);
    const uint64_t unlocked_us = sys.now_us;
    roburoc4_pump_unlock(pump_);
    sleep_ms(300);
    expect_stopped_at(unlocked_us);
    for (const SpeedCommand &command : robot_->commands) {
        EXPECT_LT(command.linear_m_s, 0.7f);
    }
}

TEST_F(Pump, RequestStopIsHarmlessBeforeReadyAfterCloseAndOfNone) {
    roburoc4_pump_request_stop(nullptr);
    create();
    roburoc4_pump_request_stop(pump_);
    sleep_ms(1000);
    ASSERT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
    roburoc4_pump_request_stop(pump_);
    EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
    EXPECT_EQ(robot_->speeds(), 0u);
}

/* --------------------------------------------------------------------------------- exit() --- */

TEST_F(Pump, ExitStopsADrivingRobotAtOnce) {
    create_driving();
    sleep_ms(17);
    const uint64_t asked_us = sys.now_us;
    run_exit_handlers();
    expect_stopped_at(asked_us);
    EXPECT_EQ(robot_->first_zero_us(), asked_us + sys.delay_us);
    EXPECT_LE(sys.now_us, asked_us + 300 * kMs) << "it ends when the robot has confirmed";
    EXPECT_EQ(roburoc4_pump_running(pump_), 0);
}

TEST_F(Pump, ExitEndsARecordingWithItsLastZeros) {
    roburoc4_recorder *recorder = roburoc4_recorder_open("run.pcapng", nullptr, nullptr);
    ASSERT_NE(recorder, nullptr);
    create_driving();
    ASSERT_EQ(roburoc4_pump_record(pump_, recorder), ROBUROC4_OK);
    sleep_ms(17);
    run_exit_handlers();
    const auto capture = test::read_capture(sys.files.at("run.pcapng"));
    EXPECT_TRUE(capture.has_statistics);
    EXPECT_GE(capture.datagrams.size(), robot_->zeros_at_the_end());
    roburoc4_pump_destroy(pump_);
    pump_ = nullptr;
    EXPECT_EQ(roburoc4_recorder_close(recorder, nullptr), ROBUROC4_OK);
}

TEST_F(Pump, ExitStopsAllRobotsAtTheSameTime) {
    Robot second(60001);
    create_driving();
    const roburoc4_address address = second.address();
    roburoc4_pump *other = roburoc4_pump_create(&address, &config_, 0, nullptr, nullptr);
    ASSERT_EQ(roburoc4_pump_arm(other, 10 * kSecond), ROBUROC4_OK);
    ASSERT_EQ(on_client(other, roburoc4_client_drive, 0.5f, 0.2f, 1000000u), ROBUROC4_OK);
    drive_on();
    ASSERT_GE(second.speeds(), 2u);
    robot_->silent = second.silent = true;
    const uint64_t asked_us = sys.now_us;
    run_exit_handlers();
    expect_stopped_at(asked_us);
    EXPECT_EQ(second.first_zero_us(), asked_us + sys.delay_us);
    EXPECT_GE(sys.now_us, asked_us + kSecond);
    EXPECT_LE(sys.now_us, asked_us + 1050 * kMs) << "together, not one after the other";
    EXPECT_GE(second.zeros_at_the_end(), 20u);
    EXPECT_GE(robot_->zeros_at_the_end(), 20u);
    roburoc4_pump_destroy(other);
}

TEST_F(Pump, ExitWithTheLockHeldWaitsForOneStopSequenceAndHalfASecond) {
    const uint32_t watchdogs_ms[] = {300, 1000, 3000, 300};
    const uint32_t periods_ms[] = {50, 50, 50, 150}; /* three of the last take longer */
    const uint64_t sequences_ms[] = {300, 1000, 3000, 450};
    for (size_t i = 0; i < 4; i++) {
        begin();
        robot_ = std::make_unique<Robot>();
        config_.robot_watchdog_ms = watchdogs_ms[i];
        config_.drive_period_ms = periods_ms[i];
        config_.lease_ms = 1000;
        create_armed();
        const uint64_t asked_us = sys.now_us;
        (void)roburoc4_pump_lock(pump_);
        run_exit_handlers();
        EXPECT_GE(sys.now_us, asked_us + (sequences_ms[i] + 500) * kMs);
        EXPECT_LE(sys.now_us, asked_us + (sequences_ms[i] + 510) * kMs);
        roburoc4_pump_unlock(pump_); /* which a process that has ended does not do */
        roburoc4_pump_destroy(pump_);
        pump_ = nullptr;
    }
}

TEST_F(Pump, ExitWithTwoLocksHeldWaitsOnce) {
    Robot second(60001);
    create_armed();
    const roburoc4_address address = second.address();
    roburoc4_pump *other = roburoc4_pump_create(&address, &config_, 0, nullptr, nullptr);
    (void)roburoc4_pump_lock(pump_);
    (void)roburoc4_pump_lock(other);
    const uint64_t asked_us = sys.now_us;
    run_exit_handlers();
    EXPECT_LE(sys.now_us, asked_us + 1510 * kMs);
    roburoc4_pump_unlock(other);
    roburoc4_pump_unlock(pump_);
    roburoc4_pump_destroy(other);
}

TEST_F(Pump, ExitHasNothingToDoAfterDestroy) {
    create_driving();
    roburoc4_pump_destroy(pump_);
    pump_ = nullptr;
    const uint64_t asked_us = sys.now_us;
    const size_t sent = sys.sent.size();
    run_exit_handlers();
    EXPECT_EQ(sys.now_us, asked_us);
    EXPECT_EQ(sys.sent.size(), sent);
}

TEST_F(Pump, ExitFindsEachOfManyPumpsThatAreLeft) {
    std::vector<std::unique_ptr<Robot>> robots;
    std::vector<roburoc4_pump *> pumps;
    for (uint16_t i = 0; i < 5; i++) {
        robots.push_back(std::make_unique<Robot>(static_cast<uint16_t>(60001 + i)));
        const roburoc4_address address = robots.back()->address();
        pumps.push_back(roburoc4_pump_create(&address, &config_, 0, nullptr, nullptr));
        ASSERT_EQ(roburoc4_pump_arm(pumps.back(), 10 * kSecond), ROBUROC4_OK);
    }
    for (const size_t gone : {2U, 0U, 4U}) { /* in the middle, first, last */
        roburoc4_pump_destroy(pumps[gone]);
    }
    for (const size_t left : {1U, 3U}) {
        ASSERT_EQ(on_client(pumps[left], roburoc4_client_drive, 0.5f, 0.0f, 1000000u), ROBUROC4_OK);
    }
    sleep_ms(200);
    const uint64_t asked_us = sys.now_us;
    run_exit_handlers();
    for (const size_t left : {1U, 3U}) {
        EXPECT_EQ(robots[left]->first_zero_us(), asked_us + sys.delay_us);
        roburoc4_pump_destroy(pumps[left]);
    }
}

/* --------------------------------------------------------------------------------- fork() --- */

TEST_F(Pump, AForkedChildHasNoPumpAndTheParentDrivesOn) {
    create_driving();
    const size_t commands = robot_->commands.size();
    const uint64_t forked_us = sys.now_us;
    in_child([&] {
        roburoc4_pump_reader reader{};
        roburoc4_sample sample;
        EXPECT_EQ(roburoc4_pump_lock(pump_), nullptr);
        EXPECT_EQ(roburoc4_pump_running(pump_), 0);
        EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_ERR_CLOSED);
        EXPECT_EQ(roburoc4_pump_arm(pump_, UINT32_MAX), ROBUROC4_ERR_CLOSED);
        EXPECT_EQ(roburoc4_pump_record(pump_, nullptr), ROBUROC4_ERR_CLOSED);
        EXPECT_EQ(roburoc4_pump_reader_init(pump_, &reader), ROBUROC4_ERR_CLOSED);
        EXPECT_EQ(roburoc4_pump_wait_samples(pump_, &reader, UINT32_MAX), ROBUROC4_ERR_CLOSED);
        EXPECT_EQ(roburoc4_pump_read_samples(pump_, &reader, &sample, 1), ROBUROC4_ERR_CLOSED);
        EXPECT_EQ(roburoc4_pump_take_events(pump_, &reader), ROBUROC4_ERR_CLOSED);
        char text[8];
        roburoc4_move move{};
        EXPECT_EQ(roburoc4_pump_description(pump_, -1, 0, text, 8), ROBUROC4_ERR_CLOSED);
        EXPECT_EQ(roburoc4_pump_move(pump_, &move), ROBUROC4_ERR_CLOSED);
        roburoc4_pump_request_stop(pump_);
        run_exit_handlers(); /* not _exit() */
    });
    EXPECT_EQ(sys.parents_locks_taken, 0);
    EXPECT_EQ(sys.now_us, forked_us);
    EXPECT_EQ(robot_->commands.size(), commands) << "the child sent nothing";
    drive_on();
    EXPECT_EQ(roburoc4_pump_running(pump_), 1);
}

/** The sanitizer of addresses looks on. */
TEST_F(Pump, AConfigOfAnOlderProgramIsNotReadBeyondItsEnd) {
    const std::uint32_t older[] = {8, 0};
    std::vector<std::uint8_t> bytes(sizeof older);
    std::memcpy(bytes.data(), older, sizeof older);
    pump_ = roburoc4_pump_create(nullptr, reinterpret_cast<roburoc4_config *>(bytes.data()), 0,
                                 nullptr, nullptr);
    EXPECT_NE(nullptr, pump_);
}

TEST_F(Pump, AForkedChildMayDestroyWhatIsLocked) {
    pump_ = roburoc4_pump_create(nullptr, nullptr, 0, nullptr, nullptr);
    in_child([&] { roburoc4_pump_destroy(pump_); });
    EXPECT_EQ(sys.parents_locks_taken, 0);
    EXPECT_EQ(sys.wakes, 0);
    EXPECT_EQ(sys.locks + sys.signals, 2) << "which may be in any state";
    pump_ = nullptr;
    begin();
}

TEST_F(Pump, AForkedChildThatExitsStopsOnlyItsOwnRobot) {
    Robot second(60001);
    create_armed();
    in_child([&] {
        const roburoc4_address address = second.address();
        roburoc4_pump *own = roburoc4_pump_create(&address, &config_, 0, nullptr, nullptr);
        ASSERT_EQ(roburoc4_pump_arm(own, 10 * kSecond), ROBUROC4_OK);
        ASSERT_EQ(on_client(own, roburoc4_client_drive, 0.5f, 0.2f, 1000000u), ROBUROC4_OK);
        sleep_ms(200);
        const uint64_t asked_us = sys.now_us;
        run_exit_handlers();
        EXPECT_LE(sys.now_us, asked_us + 300 * kMs);
        EXPECT_EQ(second.first_zero_us(), asked_us + sys.delay_us);
        EXPECT_GE(second.zeros_at_the_end(), 3u);
        EXPECT_EQ(sys.parents_locks_taken, 0);
        roburoc4_pump_destroy(own);
    });
    sleep_ms(100);
    EXPECT_TRUE(robot_->commands.empty());
    EXPECT_EQ(roburoc4_pump_running(pump_), 1);
}

/* -------------------------------------------------------------------- samples and events --- */

TEST_F(Pump, EveryReaderSeesEverySampleOnceAndInOrder) {
    create();
    roburoc4_pump_reader often{}, seldom{};
    std::vector<roburoc4_sample> first, second(1000);
    uint32_t services = 0;
    while (first.size() < 500) {
        sys.delay_us = first.size() < 250 ? 200 : 8200;
        ASSERT_GT(roburoc4_pump_wait_samples(pump_, &often, kSecond), 0);
        EXPECT_GT(roburoc4_pump_wait_events(pump_, &often, UINT32_MAX, 0), 0)
            << "each sample is an event, too";
        roburoc4_pump_take_events(pump_, &often);
        roburoc4_sample some[7];
        const roburoc4_result got = roburoc4_pump_read_samples(pump_, &often, some, 7);
        ASSERT_GT(got, 0);
        EXPECT_EQ(some[0].host_us, sys.now_us) << "it wakes when the sample comes";
        first.insert(first.end(), some, some + got);
    }
    const roburoc4_result count = roburoc4_pump_wait_samples(pump_, &seldom, 0);
    ASSERT_EQ(static_cast<size_t>(count), first.size());
    roburoc4_pump_reader part{};
    EXPECT_EQ(roburoc4_pump_read_samples(pump_, &part, second.data(), 70), 70);
    EXPECT_EQ(roburoc4_pump_read_samples(pump_, &seldom, second.data(), 1000), count)
        << "in one call";
    for (size_t i = 0; i < first.size(); i++) {
        ASSERT_EQ(first[i].sequence, i);
        EXPECT_EQ(std::memcmp(&first[i], &second[i], sizeof first[i]), 0);
        EXPECT_LE(first[i].made_us, first[i].host_us);
        if (i > 260) {
            EXPECT_NEAR(static_cast<double>(first[i].host_us - first[i].made_us), 8000, 1000)
                << "later than the fastest";
        }
        services |= 1u << first[i].service;
    }
    EXPECT_EQ(services, 0x7Cu);
    EXPECT_EQ(often.lost + seldom.lost, 0u);
}

TEST_F(Pump, ASlowReaderLosesTheOldestAndLearnsHowMany) {
    queue_ = ROBUROC4_PUMP_QUEUE_MIN + 1;
    create();
    roburoc4_pump_reader slow{}, newest{};
    roburoc4_sample samples[100];
    while (newest.next_sample < queue_) { /* as many as it keeps */
        sleep_us(100);
        roburoc4_pump_reader_init(pump_, &newest);
    }
    ASSERT_EQ(newest.next_sample, queue_);
    roburoc4_pump_reader early{};
    EXPECT_EQ(roburoc4_pump_read_samples(pump_, &early, samples, 100), int32_t(queue_));
    EXPECT_EQ(early.lost, 0u);
    sleep_ms(2000);
    roburoc4_pump_reader_init(pump_, &newest);
    EXPECT_EQ(roburoc4_pump_wait_samples(pump_, &slow, 0), int32_t(queue_));
    EXPECT_EQ(roburoc4_pump_read_samples(pump_, &slow, samples, 10), 10);
    EXPECT_EQ(slow.lost, newest.next_sample - queue_);
    EXPECT_EQ(samples[0].sequence, slow.lost);
    EXPECT_EQ(roburoc4_pump_read_samples(pump_, &slow, samples, 100), int32_t(queue_) - 10);
    EXPECT_EQ(samples[0].sequence, slow.lost + 10);
    EXPECT_EQ(roburoc4_pump_read_samples(pump_, &slow, samples, 100), 0);
    EXPECT_EQ(newest.lost, 0u);
    const uint64_t lost = slow.lost, read = slow.next_sample;
    sleep_ms(2000);
    EXPECT_EQ(roburoc4_pump_read_samples(pump_, &slow, samples, 1), 1);
    EXPECT_EQ(slow.lost, lost + samples[0].sequence - read);
    roburoc4_pump_reader_init(pump_, &slow);
    EXPECT_EQ(slow.lost, 0u);
    slow.next_sample += 1000; /* of another pump */
    EXPECT_EQ(roburoc4_pump_wait_samples(pump_, &slow, 0), 0);
    EXPECT_EQ(roburoc4_pump_read_samples(pump_, &slow, samples, 100), 0);
}

TEST_F(Pump, ASampleHasTheTimeOfItsMeasurementUnlessThatIsTenSecondsAgo) {
    config_.lost_ms = 60000;
    const uint64_t delays_us[] = {8 * kSecond, 12 * kSecond};
    const uint64_t ages_us[] = {8 * kSecond, 0};
    for (size_t i = 0; i < 2; i++) {
        begin();
        robot_ = std::make_unique<Robot>();
        create_armed();
        sleep_ms(1000);
        sys.delay_us = delays_us[i]; /* a queue that suddenly holds everything */
        sleep_ms(100);
        roburoc4_pump_reader reader{};
        roburoc4_pump_reader_init(pump_, &reader);
        ASSERT_GT(roburoc4_pump_wait_samples(pump_, &reader, 20 * kSecond), 0);
        roburoc4_sample sample;
        ASSERT_EQ(roburoc4_pump_read_samples(pump_, &reader, &sample, 1), 1);
        EXPECT_NEAR(static_cast<double>(sample.host_us - sample.made_us),
                    static_cast<double>(ages_us[i]), 30 * kMs);
        roburoc4_pump_destroy(pump_);
        pump_ = nullptr;
    }
}

TEST_F(Pump, AStatusFromBeforeARestartWasMadeWhenItArrived) {
    create();
    sleep_ms(60000);
    robot_.reset();
    robot_ = std::make_unique<Robot>();
    roburoc4_pump_reader reader{};
    ASSERT_GT(roburoc4_pump_wait_events(pump_, &reader, ROBUROC4_EVENT_REBOOT, 20 * kSecond), 0);
    sleep_ms(200);
    roburoc4_sample latest;
    const roburoc4_client *client = roburoc4_pump_lock(pump_);
    ASSERT_EQ(roburoc4_sample_latest(client, ROBUROC4_SERVICE_BATTERY, &latest), ROBUROC4_OK);
    roburoc4_pump_unlock(pump_);
    ASSERT_GT(latest.robot_cycles, 5000u) << "from before";
    EXPECT_EQ(latest.made_us, latest.host_us);
}

TEST_F(Pump, WaitingEndsWithItsTime) {
    robot_->silent = true;
    create();
    roburoc4_pump_reader reader{};
    const uint64_t began_us = sys.now_us;
    EXPECT_EQ(roburoc4_pump_wait_samples(pump_, &reader, 30000), 0);
    EXPECT_EQ(sys.now_us, began_us + 30000);
    EXPECT_EQ(roburoc4_pump_wait_samples(pump_, &reader, 0), 0);
    EXPECT_EQ(roburoc4_pump_wait_events(pump_, &reader, ROBUROC4_EVENT_READY, 1000), 0);
    EXPECT_EQ(sys.now_us, began_us + 31000);
}

TEST_F(Pump, EventsAreTakenByEachReaderForItself) {
    create();
    roburoc4_pump_reader first{}, second{};
    ASSERT_GT(roburoc4_pump_wait_events(pump_, &first, ROBUROC4_EVENT_READY, kSecond), 0);
    EXPECT_NE(roburoc4_pump_take_events(pump_, &first) & ROBUROC4_EVENT_READY, 0);
    EXPECT_EQ(roburoc4_pump_take_events(pump_, &first) & ROBUROC4_EVENT_READY, 0);
    EXPECT_NE(roburoc4_pump_take_events(pump_, &second) & ROBUROC4_EVENT_READY, 0);
    ASSERT_EQ(roburoc4_pump_reader_init(pump_, &second), ROBUROC4_OK);
    EXPECT_EQ(roburoc4_pump_take_events(pump_, &second), 0);
    const uint64_t began_us = sys.now_us;
    EXPECT_EQ(roburoc4_pump_wait_events(pump_, &second, ROBUROC4_EVENT_REBOOT, 500000), 0)
        << "others than those of the mask do not end the wait";
    EXPECT_EQ(sys.now_us, began_us + 500000);
    EXPECT_EQ(roburoc4_pump_wait_events(pump_, &second, ROBUROC4_EVENT_IOCARD, 0),
              int64_t{ROBUROC4_EVENT_IOCARD})
        << "of those that occurred";
    EXPECT_NE(roburoc4_pump_take_events(pump_, &second) & ROBUROC4_EVENT_IOCARD, 0)
        << "waiting does not take";
}

TEST_F(Pump, KeepsTheRobotsTexts) {
    sys.rewrites = [](Bytes &datagram) {
        const std::string name = "Rear bumper";
        const auto found = std::search(datagram.begin(), datagram.end(), name.begin(), name.end());
        if (found != datagram.end()) {
            datagram.resize(datagram.size() + 60, 'x'); /* longer than what is kept */
        }
    };
    create();
    char text[ROBUROC4_PUMP_DESCRIPTION_SIZE];
    const auto description = [&](int32_t kind, uint32_t index, size_t capacity = sizeof text) {
        return roburoc4_pump_description(pump_, kind, index, text, capacity);
    };
    EXPECT_EQ(description(ROBUROC4_IO_DIGITAL_INPUT, 63), ROBUROC4_ERR_NOT_KNOWN);
    sleep_ms(5000);
    const int32_t kinds[] = {-1, ROBUROC4_IO_ANALOG_INPUT, ROBUROC4_IO_DIGITAL_INPUT,
                             ROBUROC4_IO_DIGITAL_OUTPUT};
    const uint32_t counts[] = {ROBUROC4_SERVICE_COUNT, ROBUROC4_AI_COUNT, ROBUROC4_DI_COUNT,
                               ROBUROC4_DO_COUNT};
    for (size_t kind = 0; kind < 4; kind++) {
        for (uint32_t index = 0; index < counts[kind]; index++) {
            EXPECT_GE(description(kinds[kind], index), 0) << kinds[kind] << " " << index;
        }
        EXPECT_LT(description(kinds[kind], counts[kind]), 0);
    }
    EXPECT_EQ(description(-1, ROBUROC4_SERVICE_BATTERY, 8), 7);
    EXPECT_STREQ(text, "Battery");
    EXPECT_EQ(description(-1, ROBUROC4_SERVICE_BATTERY, 7), ROBUROC4_ERR_BUFFER);
    EXPECT_EQ(description(ROBUROC4_IO_DIGITAL_INPUT, 0), 12);
    EXPECT_STREQ(text, "Front bumper");
    EXPECT_EQ(description(ROBUROC4_IO_DIGITAL_INPUT, 1), ROBUROC4_PUMP_DESCRIPTION_SIZE - 1);
    EXPECT_EQ(text, "Rear bumper" + std::string(52, 'x'));
    EXPECT_EQ(description(-2, 0), ROBUROC4_ERR_ARGUMENT);
    EXPECT_EQ(description(4, 0), ROBUROC4_ERR_ARGUMENT);
    EXPECT_EQ(description(-1, ROBUROC4_MAX_SERVICES), ROBUROC4_ERR_INDEX);
}

TEST_F(Pump, ATextThatAnotherRobotHasReplacesTheFirst) {
    create();
    sleep_ms(5000);
    sys.rewrites = [](Bytes &datagram) {
        const std::string name = "Front bumper";
        const auto found = std::search(datagram.begin(), datagram.end(), name.begin(), name.end());
        if (found != datagram.end())
            *found = 'f';
    };
    ASSERT_TRUE(robot_->panel("power off"));
    sleep_ms(3000);
    ASSERT_TRUE(robot_->panel("power on"));
    sleep_ms(20000);
    char text[ROBUROC4_PUMP_DESCRIPTION_SIZE];
    ASSERT_GE(roburoc4_pump_description(pump_, ROBUROC4_IO_DIGITAL_INPUT, 0, text, sizeof text), 0);
    EXPECT_STREQ(text, "front bumper");
}

/* ------------------------------------------------------------------------------- creation --- */

TEST_F(Pump, WhatTheSystemRefusesLeavesNothingBehind) {
    const roburoc4_address address = robot_->address();
    roburoc4_result result = 0;
    for (bool *fails : {&sys.lock_fails, &sys.signal_fails, &sys.wake_fails, &sys.thread_fails}) {
        *fails = true;
        EXPECT_EQ(roburoc4_pump_create(&address, nullptr, 0, nullptr, &result), nullptr);
        EXPECT_EQ(result, ROBUROC4_ERR_SYSTEM);
        EXPECT_TRUE(errno == EAGAIN || !sys.thread_fails) << "why";
        EXPECT_EQ(left(), 0);
        *fails = false;
    }
    sys.socket_fault = ROBUROC4_FAULT_DENIED;
    EXPECT_EQ(roburoc4_pump_create(&address, nullptr, 0, nullptr, &result), nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_SYSTEM);
    sys.lock_fails = true;
    EXPECT_EQ(roburoc4_pump_create(nullptr, nullptr, 0, nullptr, &result), nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_SYSTEM);
    for (const int allocations : {0, 1}) {
        sys.allocations = allocations;
        EXPECT_EQ(roburoc4_pump_create(&address, nullptr, 0, nullptr, &result), nullptr);
        EXPECT_EQ(result, ROBUROC4_ERR_SYSTEM);
        EXPECT_EQ(errno, ENOMEM);
    }
    run_exit_handlers();
}

TEST_F(Pump, RefusesInvalidArguments) {
    roburoc4_address address{};
    roburoc4_result result = 0;
    EXPECT_EQ(roburoc4_pump_create(&address, nullptr, 0, nullptr, &result), nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_ADDRESS);
    for (const uint32_t limit :
         {uint32_t{ROBUROC4_PUMP_QUEUE_MIN}, uint32_t{ROBUROC4_PUMP_QUEUE_MAX}}) {
        roburoc4_pump_destroy(roburoc4_pump_create(nullptr, nullptr, limit, nullptr, &result));
        EXPECT_EQ(result, ROBUROC4_OK);
        const uint32_t beyond = limit == ROBUROC4_PUMP_QUEUE_MIN ? limit - 1 : limit + 1;
        EXPECT_EQ(roburoc4_pump_create(nullptr, nullptr, beyond, nullptr, &result), nullptr);
        EXPECT_EQ(result, ROBUROC4_ERR_ARGUMENT);
    }
    config_.lease_ms = 1;
    address = robot_->address();
    EXPECT_EQ(roburoc4_pump_create(&address, &config_, 0, nullptr, &result), nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_CONFIG);
    sys.connect_fault = ROBUROC4_FAULT_DENIED; /* broadcast */
    EXPECT_EQ(roburoc4_pump_create(&address, nullptr, 0, nullptr, nullptr), nullptr)
        << "the result is not asked for";
    roburoc4_pump_destroy(nullptr);
}

TEST_F(Pump, SendsFromTheLocalAddress) {
    const roburoc4_address address = robot_->address();
    roburoc4_address local = address;
    local.port = 4321;
    pump_ = roburoc4_pump_create_from(&address, &local, nullptr, 0, nullptr, nullptr);
    EXPECT_EQ(socket_of(pump_).private_own_address.port, 4321);
}

TEST_F(Pump, WithoutAnAddressHasNeitherSocketNorThread) {
    roburoc4_result result = 1;
    pump_ = roburoc4_pump_create(nullptr, nullptr, 0, nullptr, &result);
    ASSERT_EQ(result, ROBUROC4_OK);
    EXPECT_EQ(sys.sockets + sys.threads, 0);
    EXPECT_EQ(roburoc4_pump_running(pump_), 1);
    EXPECT_EQ(roburoc4_pump_arm(pump_, UINT32_MAX), ROBUROC4_ERR_CLOSED);
    EXPECT_EQ(roburoc4_pump_record(pump_, nullptr), ROBUROC4_ERR_CLOSED);
    roburoc4_move move{};
    ASSERT_EQ(roburoc4_move_by(&move, 1.0f, 0.0f, nullptr), ROBUROC4_OK);
    EXPECT_EQ(roburoc4_pump_move(pump_, &move), ROBUROC4_ERR_CLOSED);
    roburoc4_pump_request_stop(pump_);
    run_exit_handlers();
    Thread waiter([&] {
        roburoc4_pump_reader reader{};
        EXPECT_EQ(roburoc4_pump_wait_samples(pump_, &reader, UINT32_MAX), ROBUROC4_ERR_CLOSED);
    });
    sleep_ms(100);
    const uint64_t closes_us = sys.now_us;
    EXPECT_EQ(roburoc4_pump_close(pump_), ROBUROC4_OK);
    EXPECT_EQ(roburoc4_pump_running(pump_), 0);
    waiter.join();
    EXPECT_EQ(sys.now_us, closes_us);
}

/** A pump without a thread, whose client a world moves. */
TEST_F(Pump, WithoutAnAddressKeepsWhatItsClientReceives) {
    roburoc4_result result = ROBUROC4_ERR_SYSTEM;
    roburoc4_pump *pump = roburoc4_pump_create(nullptr, nullptr, 0, nullptr, &result);
    ASSERT_NE(pump, nullptr);
    roburoc4_world *world = roburoc4_world_create(nullptr);
    ASSERT_EQ(roburoc4_world_join(world, roburoc4_pump_lock(pump)), 1);
    roburoc4_pump_unlock(pump);
    const uint8_t *datagram = nullptr;
    size_t size = 0;
    while (roburoc4_world_step(world, 11000000, &datagram, &size) != 0) {
        roburoc4_pump_lock(pump);
        roburoc4_pump_collect(pump, datagram, size);
        roburoc4_pump_unlock(pump);
    }
    roburoc4_pump_reader reader{};
    std::vector<roburoc4_sample> samples(1000);
    EXPECT_GT(roburoc4_pump_read_samples(pump, &reader, samples.data(), 1000), 600);
    EXPECT_NE(roburoc4_pump_take_events(pump, &reader) & ROBUROC4_EVENT_READY, 0);
    char text[ROBUROC4_PUMP_DESCRIPTION_SIZE];
    EXPECT_GT(roburoc4_pump_description(pump, ROBUROC4_IO_DIGITAL_INPUT, 0, text, sizeof text), 0);
    EXPECT_STREQ(text, "Front bumper");
    EXPECT_EQ(roburoc4_pump_running(pump), 1);
    EXPECT_EQ(roburoc4_pump_close(pump), ROBUROC4_OK);
    EXPECT_EQ(roburoc4_pump_running(pump), 0);
    EXPECT_EQ(roburoc4_pump_read_samples(pump, &reader, samples.data(), 1000), ROBUROC4_ERR_CLOSED);
    roburoc4_client *client = roburoc4_pump_lock(pump);
    EXPECT_EQ(roburoc4_client_state(client), ROBUROC4_STATE_READY);
    roburoc4_sample latest;
    for (uint32_t service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++) {
        EXPECT_EQ(roburoc4_sample_latest(client, service, &latest), ROBUROC4_OK);
        EXPECT_EQ(latest.service, service);
        EXPECT_GT(latest.robot_cycles, 0U);
        EXPECT_GT(latest.host_us, 0U);
        EXPECT_LE(latest.made_us, latest.host_us);
        EXPECT_GT(latest.made_us + 1000000, latest.host_us);
    }
    EXPECT_EQ(roburoc4_sample_latest(client, ROBUROC4_SERVICE_DIRECTORY, &latest),
              ROBUROC4_ERR_ARGUMENT);
    roburoc4_pump_unlock(pump);
    roburoc4_world_destroy(world);
    roburoc4_pump_destroy(pump);
}

/* ---------------------------------------------------------------------- many at a time --- */

TEST_F(Pump, ThreadsCanAllCallEverythingAtOnceWhateverTheirOrder) {
    for (uint64_t seed = 1; seed <= 30; seed++) {
        SCOPED_TRACE(seed);
        begin();
        sys.seed = seed;
        robot_ = std::make_unique<Robot>();
        queue_ = 32;
        create_armed();
        roburoc4_pump *p = pump_;
        bool running = true;
        std::vector<std::unique_ptr<Thread>> threads;
        const auto start = [&](std::function<void()> function) {
            threads.push_back(std::make_unique<Thread>(std::move(function)));
        };
        start([&] {
            while (running) {
                on_client(p, roburoc4_client_drive, 0.2f, 0.1f, 100000u);
                sleep_ms(3);
            }
        });
        start([&] {
            while (running) {
                on_client(p, roburoc4_client_arm);
                sleep_ms(5);
                roburoc4_pump_request_stop(p);
                sleep_ms(2);
            }
        });
        for (int i = 0; i < 2; i++) {
            start([&] {
                roburoc4_pump_reader reader{};
                roburoc4_sample samples[5];
                while (running) {
                    roburoc4_pump_wait_samples(p, &reader, 10000);
                    roburoc4_pump_read_samples(p, &reader, samples, 5);
                    roburoc4_pump_take_events(p, &reader);
                }
            });
        }
        sleep_ms(500);
        running = false;
        const uint64_t asked_us = sys.now_us;
        EXPECT_EQ(roburoc4_pump_close(p), ROBUROC4_OK);
        EXPECT_LE(robot_->last_speed_us(), asked_us + sys.delay_us);
        EXPECT_GE(robot_->zeros_at_the_end(), 3u);
        threads.clear();
        roburoc4_pump_destroy(p);
        pump_ = nullptr;
    }
}

} // namespace
