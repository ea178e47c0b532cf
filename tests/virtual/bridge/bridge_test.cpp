/* SPDX-License-Identifier: MIT
 *
 * The LCM bridge in virtual time: its main loop with a simulated robot and an LCM network in
 * memory. This file takes the place of liblcm and of lcm/watch.c.
 */
#include "../system.h"
#include "lcm_bus.h"

#include <gtest/gtest.h>
#include <lcm/lcm.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <ctime>
#include <regex>

#include "bot_core_pose_t.h"
#include "roburoc4_lcm.h"
#include "roburoc4_move.h"

extern "C" {
#include "os.h"
#include "watch.h"
}

using namespace virtual_system;

/* ------------------------------------------------------------------------- LCM and its waits */

struct _lcm_subscription_t {
    std::regex pattern;
    lcm_msg_handler_t handler;
    void *user;
};

namespace {

constexpr int kLcmFile = 1;

struct Message {
    uint64_t at_us;
    std::string channel;
    Bytes bytes;
};

struct Bus {
    std::deque<Message> unread;
    std::vector<Message> published;
    std::vector<std::unique_ptr<lcm_subscription_t>> subscriptions;
    std::map<uint32_t, int> watched;
    bool breaks = false;
    int reads = 0;
    bool interrupted = false;
};
Bus bus;

} // namespace

struct _lcm_t {
    int none;
};

extern "C" {

lcm_t *lcm_create(const char *) {
    return new lcm_t{};
}
void lcm_destroy(lcm_t *lcm) {
    delete lcm;
}
lcm_subscription_t *lcm_subscribe(lcm_t *, const char *channel, lcm_msg_handler_t handler,
                                  void *user) {
    bus.subscriptions.push_back(std::make_unique<lcm_subscription_t>(
        lcm_subscription_t{std::regex(channel), handler, user}));
    return bus.subscriptions.back().get();
}
int lcm_unsubscribe(lcm_t *, lcm_subscription_t *) {
    return 0;
}
int lcm_subscription_set_queue_capacity(lcm_subscription_t *, int) {
    return 0;
}
int lcm_subscription_get_queue_size(lcm_subscription_t *) {
    return 0;
}
int lcm_get_fileno(lcm_t *) {
    return kLcmFile;
}
int lcm_publish(lcm_t *, const char *channel, const void *data, unsigned int size) {
    const auto *bytes = static_cast<const uint8_t *>(data);
    bus.published.push_back({sys.now_us, channel, Bytes(bytes, bytes + size)});
    return 0;
}
int lcm_handle_timeout(lcm_t *, int) {
    bus.reads++;
    if (bus.breaks) {
        return -1;
    }
    if (bus.unread.empty()) {
        return 0;
    }
    Message message = bus.unread.front();
    bus.unread.pop_front();
    lcm_recv_buf_t buffer{};
    buffer.data = message.bytes.data();
    buffer.data_size = static_cast<uint32_t>(message.bytes.size());
    buffer.recv_utime = static_cast<int64_t>(sys.calendar_us + sys.now_us); /* LCM's thread ran */
    for (const auto &subscription : bus.subscriptions) {
        if (std::regex_match(message.channel, subscription->pattern)) {
            subscription->handler(&buffer, message.channel.c_str(), subscription->user);
        }
    }
    return 1;
}

bool watch_begin(void) {
    return true;
}
void watch_set(uint32_t number, int fd) {
    bus.watched[number] = fd;
}
uint32_t watch_wait(int wait_ms, uint32_t *ready) {
    const auto is_ready = [](int fd) {
        return fd == kLcmFile ? !bus.unread.empty() || bus.breaks : socket_is_readable(fd);
    };
    wait_until(sys.now_us + static_cast<uint64_t>(wait_ms) * kMs, [=] {
        return bus.interrupted ||
               std::any_of(bus.watched.begin(), bus.watched.end(),
                           [=](const auto &one) { return is_ready(one.second); });
    });
    uint32_t count = 0;
    if (bus.interrupted) { /* as epoll_wait() does */
        bus.interrupted = false;
        return 0;
    }
    for (const auto &[number, fd] : bus.watched) {
        if (is_ready(fd)) {
            ready[count++] = number;
        }
    }
    return count;
}

/* lcm/ is compiled with this name for clock_gettime(). */
int virtual_clock_gettime(int clock, struct timespec *out);
int virtual_clock_gettime(int, struct timespec *out) {
    const uint64_t us = sys.calendar_us + sys.now_us;
    out->tv_sec = static_cast<std::time_t>(us / kSecond);
    out->tv_nsec = static_cast<long>(us % kSecond * 1000);
    return 0;
}

} // extern "C"

/* ----------------------------------------------------------------------------------- tests --- */

namespace {

class Bridge : public testing::Test {
  protected:
    Bridge() {
        bus = Bus();
        bridge_forget();
    }
    ~Bridge() override {
        if (bridge_ != nullptr && !bridge_->is_over()) {
            end(SIGTERM);
            bridge_->join();
        }
        bridge_.reset();
        for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
            std::signal(number, SIG_DFL);
        }
        EXPECT_EQ(sys.sockets, 0);
    }
    void start(std::vector<std::string> more = {}) {
        arguments_ = {"roburoc4-lcm", "--robot",      "robot",       "--enable-drive",
                      "--quiet",      "--fleet-stop", "ALL_STOP_CMD"};
        arguments_.insert(arguments_.end(), more.begin(), more.end());
        bridge_ = std::make_unique<Thread>([this] {
            std::vector<char *> pointers;
            for (std::string &argument : arguments_) {
                pointers.push_back(argument.data());
            }
            status_ = bridge_main(static_cast<int>(pointers.size()), pointers.data());
        });
        sleep_ms(3000); /* connected, and the first commands may be taken */
        ASSERT_FALSE(bridge_->is_over());
    }
    void end(int number) {
        bridge_signal(number);
        bus.interrupted = true;
    }
    int64_t utime() const {
        return static_cast<int64_t>(sys.calendar_us + sys.now_us);
    }
    /* Later than that of every command before. */
    int64_t next_utime() {
        return utime() + ++given_;
    }
    template <class Message>
    static void give(const char *channel, const Message &message, int (*size_of)(const Message *),
                     int (*encode)(void *, int, int, const Message *)) {
        Bytes bytes(static_cast<size_t>(size_of(&message)));
        ASSERT_EQ(encode(bytes.data(), 0, static_cast<int>(bytes.size()), &message),
                  static_cast<int>(bytes.size()));
        bus.unread.push_back({sys.now_us, channel, bytes});
    }
    void drive(double linear_m_s, int32_t lease_us = 0, const char *sender = "planner") {
        roburoc4_lcm_drive_command_t command{};
        command.utime = next_utime();
        command.sender = const_cast<char *>(sender);
        command.linear_m_s = linear_m_s;
        command.lease_us = lease_us;
        give("ROBUROC4_DRIVE_CMD", command, roburoc4_lcm_drive_command_t_encoded_size,
             roburoc4_lcm_drive_command_t_encode);
    }
    void stream(double linear_m_s, uint64_t for_ms) {
        for (uint64_t ms = 0; ms < for_ms; ms += 50) {
            drive(linear_m_s);
            sleep_ms(50);
        }
    }
    void move_by(double distance_m, int64_t id, int32_t lease_us = 0, double clearance_m = 0,
                 const char *sender = "planner") {
        roburoc4_lcm_move_command_t command{};
        command.utime = next_utime();
        command.sender = const_cast<char *>(sender);
        command.move_id = id;
        command.kind = ROBUROC4_LCM_MOVE_COMMAND_T_KIND_BY;
        command.distance_m = distance_m;
        command.lease_us = lease_us;
        command.clearance_m = clearance_m;
        give("ROBUROC4_MOVE_CMD", command, roburoc4_lcm_move_command_t_encoded_size,
             roburoc4_lcm_move_command_t_encode);
    }
    static int32_t last_move_result() {
        int32_t result = -1;
        for (const Message &message : bus.published) {
            roburoc4_lcm_move_status_t status{};
            if (message.channel == "ROBUROC4_MOVE_STATUS" &&
                roburoc4_lcm_move_status_t_decode(message.bytes.data(), 0,
                                                  static_cast<int>(message.bytes.size()),
                                                  &status) >= 0) {
                result = status.result;
                roburoc4_lcm_move_status_t_decode_cleanup(&status);
            }
        }
        return result;
    }
    static void stop(const char *channel = "ROBUROC4_STOP_CMD") {
        roburoc4_lcm_stop_command_t command{const_cast<char *>("operator")};
        give(channel, command, roburoc4_lcm_stop_command_t_encoded_size,
             roburoc4_lcm_stop_command_t_encode);
    }
    static std::vector<uint64_t> times_of(const std::string &channel) {
        std::vector<uint64_t> times;
        for (const Message &message : bus.published) {
            if (message.channel == channel) {
                times.push_back(message.at_us);
            }
        }
        return times;
    }
    void expect_stopped_at(uint64_t by_us) const {
        EXPECT_LE(robot_->last_speed_us(), by_us + sys.delay_us);
        EXPECT_LE(robot_->first_zero_us(), by_us + sys.delay_us);
        EXPECT_GE(robot_->zeros_at_the_end(), 3u);
    }

    std::unique_ptr<Robot> robot_ = (begin(), std::make_unique<Robot>());
    std::vector<std::string> arguments_;
    std::unique_ptr<Thread> bridge_;
    int status_ = -1;
    int64_t given_ = 0;
};

TEST_F(Bridge, ACommandDrivesAtOnceAndUntilItsLeaseEnds) {
    start();
    const uint64_t sent_us = sys.now_us;
    drive(0.3, 200000);
    sleep_ms(1000);
    ASSERT_GE(robot_->speeds(), 4u);
    EXPECT_EQ(robot_->commands[0].at_us, sent_us + sys.delay_us);
    EXPECT_FLOAT_EQ(robot_->commands[0].linear_m_s, 0.3f);
    EXPECT_GE(robot_->first_zero_us(), sent_us + 200 * kMs + sys.delay_us);
    expect_stopped_at(sent_us + 201 * kMs); /* it waits in milliseconds */
}

TEST_F(Bridge, ASignalStopsTheRobotAtOnceAndEndsTheBridge) {
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        bus = Bus();
        bridge_forget();
        start();
        stream(0.3, 500);
        drive(0.3);
        sleep_ms(17);
        const uint64_t asked_us = sys.now_us;
        end(number);
        bridge_->join();
        EXPECT_EQ(status_, 0);
        EXPECT_LE(sys.now_us, asked_us + 200 * kMs) << "the robot has confirmed";
        sleep_ms(1);
        expect_stopped_at(asked_us);
        robot_->commands.clear();
    }
}

TEST_F(Bridge, ItClosesForAtMost600Milliseconds) {
    start();
    stream(0.3, 500);
    drive(0.3);
    sleep_ms(17);
    robot_->silent = true;
    const uint64_t asked_us = sys.now_us;
    end(SIGTERM);
    drive(0.5);
    bridge_->join();
    EXPECT_EQ(bus.unread.size(), 1u) << "not read any more";
    EXPECT_GE(sys.now_us, asked_us + 600 * kMs);
    EXPECT_LE(sys.now_us, asked_us + 660 * kMs);
    sleep_ms(1);
    expect_stopped_at(asked_us);
    EXPECT_GE(robot_->zeros_at_the_end(), 12u);
}

TEST_F(Bridge, AStopStopsAtOnceAndHoldsAStreamUntilItPauses) {
    start();
    stream(0.3, 500);
    drive(0.3);
    sleep_ms(17);
    const uint64_t asked_us = sys.now_us;
    stop();
    stream(0.3, 3000);
    expect_stopped_at(asked_us);
    EXPECT_EQ(robot_->state().last_linear_m_s, 0.0);
    sleep_ms(500);
    stream(0.3, 200);
    EXPECT_GT(robot_->last_speed_us(), asked_us + 3500 * kMs);
}

TEST_F(Bridge, OneStopStopsTheFleet) {
    start();
    stream(0.3, 500);
    const uint64_t asked_us = sys.now_us;
    stop("ALL_STOP_CMD");
    sleep_ms(300);
    expect_stopped_at(asked_us);
}

TEST_F(Bridge, AHugeSpeedIsRefusedAndNeverChangesItsSign) {
    start();
    for (const double speed : {-1e300, -3.5e38, -1e39, -6.0}) {
        drive(speed);
        sleep_ms(200);
        EXPECT_TRUE(robot_->commands.empty()) << speed;
    }
    stream(-0.3, 200);
    ASSERT_GE(robot_->speeds(), 1u);
    for (const SpeedCommand &command : robot_->commands) {
        EXPECT_LE(command.linear_m_s, 0.0f);
    }
}

TEST_F(Bridge, CommandsOfTheTimeInWhichItHungDoNotDrive) {
    start();
    stream(0.3, 500);
    at(sys.now_us + 100 * kMs, [this] { drive(0.4, 250000); });
    stall_ms(1500);
    const uint64_t awake_us = sys.now_us;
    sleep_ms(400);
    for (const SpeedCommand &command : robot_->commands) {
        EXPECT_LT(command.linear_m_s, 0.35f);
    }
    EXPECT_LE(robot_->last_speed_us(), awake_us);
    expect_stopped_at(awake_us);
}

TEST_F(Bridge, ALeaseRunsWhileTheBridgeHangsAlsoWhereAgesAreNotChecked) {
    start({"--max-age-ms", "0"});
    stream(0.3, 500);
    sleep_ms(600);
    const uint64_t rests_us = sys.now_us;
    at(rests_us + 10 * kMs, [this] { drive(0.4, 60000); });
    stall_ms(230); /* longer than its longest wait, and short enough for the client */
    sleep_ms(400);
    EXPECT_LE(robot_->last_speed_us(), rests_us);
    sleep_ms(600);
    drive(0.4);
    sleep_ms(100);
    EXPECT_GT(robot_->last_speed_us(), rests_us);
}

TEST_F(Bridge, TheTimeInWhichItHungIsNoPause) {
    start();
    stream(0.3, 500);
    stop();
    sleep_ms(240);
    const uint64_t hangs_us = sys.now_us;
    stall_ms(230); /* longer than its longest wait */
    sleep_ms(50);  /* half a second after the stop, of which it saw less */
    drive(0.3);
    sleep_ms(300);
    EXPECT_LE(robot_->last_speed_us(), hangs_us);
    sleep_ms(500);
    drive(0.3);
    sleep_ms(100);
    EXPECT_GT(robot_->last_speed_us(), hangs_us);
}

TEST_F(Bridge, AfterTheClockWasSetAllMustPause) {
    start({"--max-age-ms", "1000"});
    stream(0.3, 500);
    sys.calendar_us += 3600 * kSecond;
    const uint64_t set_us = sys.now_us;
    stream(0.3, 3000);
    EXPECT_LE(robot_->last_speed_us(), set_us + 300 * kMs);
    sleep_ms(500);
    stream(0.3, 200);
    EXPECT_GT(robot_->last_speed_us(), set_us + 3500 * kMs);
}

TEST_F(Bridge, ABrokenSocketIsReplacedAfterASecondAndAllMustPause) {
    start();
    stream(0.3, 300);
    sys.receives = {ROBUROC4_OS_BROKEN};
    const uint64_t broke_us = sys.now_us;
    const size_t connects = sys.connects_us.size();
    stream(0.3, 3000);
    EXPECT_TRUE(std::any_of(robot_->commands.begin(), robot_->commands.end(), [=](const auto &c) {
        return c.is_zero() && c.at_us >= broke_us && c.at_us <= broke_us + 60 * kMs;
    })) << "it may still be able to send";
    ASSERT_EQ(sys.connects_us.size(), connects + 1);
    EXPECT_GE(sys.connects_us.back(), broke_us + kSecond);
    EXPECT_LE(sys.connects_us.back(), broke_us + 1100 * kMs);
    EXPECT_LE(robot_->last_speed_us(), broke_us + 100 * kMs);
    sleep_ms(600);
    stream(0.3, 200);
    EXPECT_GT(robot_->last_speed_us(), broke_us + 3500 * kMs);
}

TEST_F(Bridge, AnLcmThatCannotBeReadIsTriedOnceASecond) {
    start();
    stream(0.3, 300);
    const uint64_t broke_us = sys.now_us;
    bus.breaks = true;
    const int reads = bus.reads;
    sleep_ms(10000);
    EXPECT_GE(bus.reads - reads, 9);
    EXPECT_LE(bus.reads - reads, 11);
    EXPECT_LE(robot_->last_speed_us(), broke_us + 250 * kMs);
    bus.breaks = false;
    sleep_ms(1000);
    stream(0.3, 200);
    EXPECT_GT(robot_->last_speed_us(), broke_us + 10 * kSecond);
}

TEST_F(Bridge, PublishesItsStateFiveTimesASecondAndStatisticsOnce) {
    start();
    bus.published.clear();
    const uint64_t began_us = sys.now_us;
    sleep_ms(10000);
    EXPECT_NEAR(static_cast<double>(times_of("ROBUROC4_BRIDGE_STATE").size()), 50, 1);
    EXPECT_NEAR(static_cast<double>(times_of("ROBUROC4_BRIDGE_STATISTICS").size()), 10, 1);
    EXPECT_NEAR(static_cast<double>(times_of("ROBUROC4_DIFFERENTIAL").size()), 200, 2);
    EXPECT_NEAR(static_cast<double>(times_of("ROBUROC4_IOCARD").size()), 200, 2);
    stop();
    sleep_ms(60);
    EXPECT_LE(sys.now_us - times_of("ROBUROC4_BRIDGE_STATE").back(), 60 * kMs)
        << "after a change, sooner";
    (void)began_us;
}

TEST_F(Bridge, AMoveThatIsNotRenewedEndsWithItsLease) {
    start();
    const uint64_t sent_us = sys.now_us;
    move_by(5, 7, 250000);
    sleep_ms(1000);
    EXPECT_GE(robot_->speeds(), 3u);
    EXPECT_GE(robot_->last_speed_us(), sent_us + 150 * kMs);
    expect_stopped_at(sent_us + 271 * kMs); /* the shortest lease more */
    EXPECT_EQ(last_move_result(), ROBUROC4_MOVE_LAPSED);
}

TEST_F(Bridge, AStopThatIsReadWithACommandWins) {
    start();
    drive(0.3);
    stop();
    sleep_ms(500);
    EXPECT_EQ(robot_->speeds(), 0u);
}

TEST_F(Bridge, OfASpeedAndAMoveThatAreReadTogetherTheLaterDrives) {
    start();
    drive(-0.2);
    move_by(5, 7);
    sleep_ms(200);
    EXPECT_EQ(last_move_result(), ROBUROC4_MOVE_RUNNING);
    ASSERT_GE(robot_->speeds(), 2u);
    for (const SpeedCommand &command : robot_->commands) {
        EXPECT_GE(command.linear_m_s, 0.0f);
    }
    move_by(5, 7);
    drive(-0.2);
    sleep_ms(200);
    EXPECT_EQ(last_move_result(), ROBUROC4_MOVE_CANCELLED);
    EXPECT_FLOAT_EQ(robot_->commands.back().linear_m_s, -0.2f);
}

TEST_F(Bridge, AMoveOfAnotherSenderIsAnotherMove) {
    start();
    for (const char *sender : {"planner", "another"}) {
        const size_t speeds = robot_->speeds();
        for (int i = 0; i < 100; i++) {
            move_by(0.2, 7, 0, 0, sender);
            sleep_ms(50);
        }
        EXPECT_GT(robot_->speeds(), speeds) << sender;
        EXPECT_EQ(last_move_result(), ROBUROC4_MOVE_REACHED);
        sleep_ms(600);
    }
    EXPECT_NEAR(robot_->state().odometry_x_m, 0.4, 0.03);
}

TEST_F(Bridge, AMoveKeepsTheClearanceThatItAsksForAndNoneWhereThatIsZero) {
    start();
    ASSERT_TRUE(robot_->panel("box add 1.2 0 0.2 2 0"));
    move_by(0.1, 7, 0, 3);
    sleep_ms(200);
    EXPECT_EQ(last_move_result(), ROBUROC4_MOVE_OBSTACLE);
    sleep_ms(600);
    move_by(0.1, 8, 0, 0);
    sleep_ms(200);
    EXPECT_EQ(last_move_result(), ROBUROC4_MOVE_RUNNING);
}

TEST_F(Bridge, OutputsAreSetTogetherOrNotAtAll) {
    start({"--enable-outputs"});
    const auto commands = [] {
        return std::count_if(sys.sent.begin(), sys.sent.end(),
                             [](const Bytes &bytes) { return bytes[0] == 0xFF; });
    };
    roburoc4_lcm_output_command_t command{};
    int32_t digital_index = 3, analog_index = 0; /* of a card without analog outputs */
    int8_t digital_on = 1;
    float analog_value = 1;
    command.sender = const_cast<char *>("planner");
    command.digital_count = command.analog_count = 1;
    command.digital_index = &digital_index;
    command.digital_on = &digital_on;
    command.analog_index = &analog_index;
    command.analog_value = &analog_value;
    for (command.analog_count = 1; command.analog_count >= 0; command.analog_count--) {
        command.utime = utime();
        give("ROBUROC4_OUTPUT_CMD", command, roburoc4_lcm_output_command_t_encoded_size,
             roburoc4_lcm_output_command_t_encode);
        sleep_ms(300);
        EXPECT_EQ(commands(), command.analog_count == 0 ? 3 : 0);
    }
}

} // namespace
