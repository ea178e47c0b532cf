/* SPDX-License-Identifier: MIT
 *
 * The LCM bridge in virtual time: its main loop with a simulated robot and an LCM network in
 * memory. This file takes the place of liblcm and of lcm/watch.c.
 */
#include "lcm_bus.h"
#include "system.h"

#include <gtest/gtest.h>
#include <lcm/lcm.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <regex>
#include <tuple>
#include <unistd.h>

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
    bool breaks = false, publishing_fails = false, watching_fails = false;
    int calls = INT_MAX; /* of LCM to begin with that succeed */
    std::string url = "none";
    int reads = 0, existing = 0;
    uint64_t read_takes_us = 0;
    bool interrupted = false;
    std::string host = "host";
    rlim_t files = 1024, most_files = 4096;
};
Bus bus;

bool succeeds() {
    return bus.calls-- > 0;
}

} // namespace

struct _lcm_t {
    int none;
};

extern "C" {

bool bridge_lcm_is_old = false;

int bridge_gethostname(char *name, size_t size) {
    std::strncpy(name, bus.host.c_str(), size);
    return 0;
}
int bridge_getrlimit(int, struct rlimit *out) {
    *out = {bus.files, bus.most_files};
    return 0;
}
int bridge_setrlimit(int, const struct rlimit *limit) {
    bus.files = limit->rlim_cur;
    return 0;
}

lcm_t *lcm_create(const char *url) {
    bus.url = url != nullptr ? url : "";
    if (!succeeds()) {
        return nullptr;
    }
    bus.existing++;
    return new lcm_t{};
}
void lcm_destroy(lcm_t *lcm) {
    bus.existing--;
    delete lcm;
}
lcm_subscription_t *lcm_subscribe(lcm_t *, const char *channel, lcm_msg_handler_t handler,
                                  void *user) {
    if (!succeeds()) {
        return nullptr;
    }
    bus.subscriptions.push_back(std::make_unique<lcm_subscription_t>(
        lcm_subscription_t{std::regex(channel), handler, user}));
    return bus.subscriptions.back().get();
}
int lcm_unsubscribe(lcm_t *, lcm_subscription_t *) {
    return 0;
}
int lcm_subscription_set_queue_capacity(lcm_subscription_t *, int) {
    return succeeds() ? 0 : -1;
}
int lcm_subscription_get_queue_size(lcm_subscription_t *) {
    return 0;
}
int lcm_get_fileno(lcm_t *) {
    return kLcmFile;
}
int lcm_publish(lcm_t *lcm, const char *channel, const void *data, unsigned int size) {
    EXPECT_NE(lcm, nullptr);
    const auto *bytes = static_cast<const uint8_t *>(data);
    if (bus.publishing_fails) {
        return -1;
    }
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
    if (bus.read_takes_us != 0) {
        sleep_us(bus.read_takes_us);
    }
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
    errno = EMFILE;
    return !bus.watching_fails;
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
        unsetenv("LCM_DEFAULT_URL");
        forget();
    }
    static void forget() {
        bus = Bus();
        bridge_forget();
        bridge_lcm_is_old = false;
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
        EXPECT_EQ(bus.existing, 0);
    }
    void launch(std::vector<std::string> arguments) {
        arguments_ = std::move(arguments);
        arguments_.insert(arguments_.begin(), "roburoc4-lcm");
        bridge_ = std::make_unique<Thread>([this] { status_ = run(arguments_); });
    }
    void start(const std::vector<std::string> &more = {}, const char *robot = "robot") {
        std::vector<std::string> arguments = {"--robot", robot,          "--enable-drive",
                                              "--quiet", "--fleet-stop", "ALL_STOP_CMD"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        launch(arguments);
        sleep_ms(3000); /* connected, and the first commands may be taken */
        ASSERT_FALSE(bridge_->is_over());
    }
    static int run(std::vector<std::string> &arguments) {
        std::vector<char *> pointers;
        for (std::string &argument : arguments) {
            pointers.push_back(argument.data());
        }
        pointers.push_back(nullptr);
        return bridge_main(static_cast<int>(pointers.size() - 1), pointers.data());
    }
    /* The exit status of a bridge that does not run, and all that it printed. */
    static int run_early(std::vector<std::string> arguments, std::string &printed) {
        arguments.insert(arguments.begin(), "roburoc4-lcm");
        bridge_forget();
        const auto runs = std::make_shared<bool>(true);
        at(sys.now_us + 10 * kSecond, [runs] {
            if (*runs) { /* although it should not */
                end(SIGTERM);
            }
        });
        testing::internal::CaptureStdout();
        testing::internal::CaptureStderr();
        const int status = run(arguments);
        *runs = false;
        std::fflush(stdout);
        printed = testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr();
        return status;
    }
    /* In the place of the usual one. */
    template <class Change> void use_robot(Change change) {
        roburoc4_sim_config config;
        ASSERT_EQ(roburoc4_sim_config_init(&config, sizeof config), ROBUROC4_OK);
        change(config);
        robot_.reset();
        robot_ = std::make_unique<Robot>(60000, &config);
    }
    static void end(int number) {
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
    using Drive = roburoc4_lcm_drive_command_t;
    using Move = roburoc4_lcm_move_command_t;
    using Output = roburoc4_lcm_output_command_t;
#define KIND(name) ROBUROC4_LCM_MOVE_COMMAND_T_KIND_##name
    /* A command of zeros, but for what `change` sets. */
    template <class Change>
    void drive_as(Change change, const char *channel = "ROBUROC4_DRIVE_CMD") {
        Drive command{};
        command.utime = next_utime();
        command.sender = const_cast<char *>("planner");
        change(command);
        sent_utime_ = command.utime;
        sent_sender_ = command.sender;
        give(channel, command, roburoc4_lcm_drive_command_t_encoded_size,
             roburoc4_lcm_drive_command_t_encode);
    }
    void drive(double linear_m_s, int32_t lease_us = 0) {
        drive_as([=](Drive &command) {
            command.linear_m_s = linear_m_s;
            command.lease_us = lease_us;
        });
    }
    void stream(double linear_m_s, uint64_t for_ms) {
        for (uint64_t ms = 0; ms < for_ms; ms += 50) {
            drive(linear_m_s);
            sleep_ms(50);
        }
    }
    template <class Change> void move_as(Change change) {
        Move command{};
        command.utime = next_utime();
        command.sender = const_cast<char *>("planner");
        change(command);
        sent_utime_ = command.utime;
        sent_sender_ = command.sender;
        give("ROBUROC4_MOVE_CMD", command, roburoc4_lcm_move_command_t_encoded_size,
             roburoc4_lcm_move_command_t_encode);
    }
    void move_by(double distance_m, int64_t id, int32_t lease_us = 0, double clearance_m = -1,
                 const char *sender = "planner") {
        move_as([=](Move &command) {
            command.sender = const_cast<char *>(sender);
            command.move_id = id;
            command.distance_m = distance_m;
            command.lease_us = lease_us;
            command.clearance_m = clearance_m;
        });
    }
    void relocalize(double x_m, double y_m, double theta_rad) {
        roburoc4_lcm_relocalize_command_t command{next_utime(), const_cast<char *>("planner"), x_m,
                                                  y_m, theta_rad};
        give("ROBUROC4_RELOCALIZE_CMD", command, roburoc4_lcm_relocalize_command_t_encoded_size,
             roburoc4_lcm_relocalize_command_t_encode);
    }
    template <class Change> void output_as(Change change) {
        roburoc4_lcm_output_command_t command{};
        command.utime = next_utime();
        command.sender = const_cast<char *>("planner");
        change(command);
        give("ROBUROC4_OUTPUT_CMD", command, roburoc4_lcm_output_command_t_encoded_size,
             roburoc4_lcm_output_command_t_encode);
    }
    /* The last message that was published on this channel. */
    template <class Message>
    static std::shared_ptr<Message> last(const char *channel,
                                         int (*decode)(const void *, int, int, Message *),
                                         int (*cleanup)(Message *)) {
        const auto found =
            std::find_if(bus.published.rbegin(), bus.published.rend(),
                         [=](const auto &message) { return message.channel == channel; });
        auto out = std::make_unique<Message>();
        if (found == bus.published.rend() ||
            decode(found->bytes.data(), 0, static_cast<int>(found->bytes.size()), out.get()) < 0) {
            ADD_FAILURE() << "nothing on " << channel;
            return std::make_shared<Message>();
        }
        return {out.release(), [=](Message *message) {
                    cleanup(message);
                    delete message;
                }};
    }
#define LAST(type, channel)                                                                        \
    last<roburoc4_lcm_##type##_t>(channel, roburoc4_lcm_##type##_t_decode,                         \
                                  roburoc4_lcm_##type##_t_decode_cleanup)
    static auto state(const char *channel = "ROBUROC4_BRIDGE_STATE") {
        return LAST(bridge_state, channel);
    }
    static auto statistics() {
        return LAST(bridge_statistics, "ROBUROC4_BRIDGE_STATISTICS");
    }
    static int32_t last_move_outcome() {
        return LAST(move_status, "ROBUROC4_MOVE_STATUS")->outcome;
    }
#define PROBLEM(name) ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_##name
    static bool has_problem(int32_t problem) {
        return (state()->problems & problem) != 0;
    }
    /* Until just after the state was published, so that the next one would be 200 ms later. */
    static void await_state() {
        const size_t states = times_of("ROBUROC4_BRIDGE_STATE").size();
        EXPECT_TRUE(
            eventually(kSecond, [=] { return times_of("ROBUROC4_BRIDGE_STATE").size() > states; }));
    }
    static size_t lines_with(const std::string &log, const std::string &part) {
        size_t count = 0;
        for (size_t at = log.find(part); at != std::string::npos; at = log.find(part, at + 1)) {
            count++;
        }
        return count;
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
    int64_t given_ = 0, sent_utime_ = 0;
    std::string sent_sender_;
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

TEST_F(Bridge, AStreamOfBeforeItsStartDrivesOnlyOnceItPauses) {
    launch({"--robot", "robot", "--enable-drive", "--quiet", "--max-age-ms", "0"});
    stream(0.3, 6000);
    EXPECT_EQ(robot_->speeds(), 0u);
    sleep_ms(500);
    stream(0.3, 200);
    EXPECT_GT(robot_->speeds(), 0u);
}

TEST_F(Bridge, ASignalStopsTheRobotAtOnceAndEndsTheBridge) {
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        forget();
        start();
        stream(0.3, 500);
        drive(0.3);
        sleep_ms(17);
        const uint64_t asked_us = sys.now_us;
        end(number);
        bridge_->join();
        EXPECT_EQ(status_, 0);
        EXPECT_LE(sys.now_us, asked_us + 300 * kMs) << "the robot has confirmed";
        EXPECT_EQ(state()->state, ROBUROC4_STATE_IDLE) << "the last state is the end";
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
    at(rests_us + 10 * kMs, [this] {
        drive_as([](Drive &command) {
            command.sender = const_cast<char *>("without a clock");
            command.utime = 1;
            command.linear_m_s = 0.4;
            command.lease_us = 60000;
        });
    });
    stall_ms(230); /* longer than its longest wait, and short enough for the client */
    sleep_ms(400);
    EXPECT_STREQ(state()->rejected_message, "its lease ended before it could be read");
    EXPECT_LE(robot_->last_speed_us(), rests_us);
    sleep_ms(600);
    drive(0.4);
    sleep_ms(100);
    EXPECT_GT(robot_->last_speed_us(), rests_us);
    EXPECT_EQ(statistics()->rejected_too_old, 1);
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
    testing::internal::CaptureStderr();
    start({"--verbose", "--max-age-ms", "1000"});
    stream(0.3, 500);
    sys.calendar_us += 3600 * kSecond;
    const uint64_t set_us = sys.now_us;
    stream(0.3, 3000);
    const std::string log = testing::internal::GetCapturedStderr();
    EXPECT_EQ(lines_with(log, "this machine's clock was set by 3600.000 s"), 1u) << log;
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
    EXPECT_EQ(std::count_if(bus.watched.begin(), bus.watched.end(),
                            [](const auto &each) { return each.second >= 0; }),
              2)
        << "LCM's socket and the new one";
    sleep_ms(600);
    stream(0.3, 200);
    EXPECT_GT(robot_->last_speed_us(), broke_us + 3500 * kMs);
}

TEST_F(Bridge, ASocketThatBreaksAgainIsLoggedOnce) {
    testing::internal::CaptureStderr();
    start({"--verbose"});
    sys.receives.assign(100, ROBUROC4_OS_BROKEN);
    sleep_ms(5000);
    EXPECT_LE(sys.receives.size(), 96u);
    const std::string log = testing::internal::GetCapturedStderr();
    EXPECT_EQ(lines_with(log, "its socket broke"), 1u) << log;
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

TEST_F(Bridge, ASocketThatBrokeAtRestNeedsAPauseToo) {
    start();
    sleep_ms(777);
    sys.receives = {ROBUROC4_OS_BROKEN};
    const size_t connects = sys.connects_us.size();
    ASSERT_TRUE(eventually(kSecond, [] { return sys.receives.empty(); }));
    const uint64_t broke_us = sys.now_us;
    sleep_ms(100);
    EXPECT_TRUE(has_problem(PROBLEM(SOCKET)));
    EXPECT_TRUE(state()->awaiting_pause);
    sleep_ms(230);
    stop(); /* so that no state is due when the second is over */
    sleep_ms(2000);
    EXPECT_FALSE(has_problem(PROBLEM(SOCKET)));
    ASSERT_EQ(sys.connects_us.size(), connects + 1);
    EXPECT_NEAR(static_cast<double>(sys.connects_us.back() - broke_us), 1e6, 1000);
}

TEST_F(Bridge, ASystemWithoutSocketsIsLoggedOnceAndAskedOnceASecond) {
    sys.connect_fault = ROBUROC4_FAULT_OTHER;
    testing::internal::CaptureStderr();
    start({"--verbose"});
    sys.connect_fault = ROBUROC4_FAULT_NONE;
    sleep_ms(2000);
    for (size_t at = 1; at < sys.connects_us.size(); at++) {
        const uint64_t between_us = sys.connects_us[at] - sys.connects_us[at - 1];
        EXPECT_NEAR(static_cast<double>(between_us), 1e6, 1000);
    }
    EXPECT_EQ(sys.connects_us.size(), 4u);
    const std::string log = testing::internal::GetCapturedStderr();
    EXPECT_EQ(lines_with(log, "no socket for 10.0.0.1:60000: "), 1u) << log;
    EXPECT_EQ(lines_with(log, "its socket works again"), 1u) << log;
    EXPECT_EQ(lines_with(log, "no answer from 10.0.0.1:60000 yet"), 1u) << log;
    EXPECT_EQ(state()->state, ROBUROC4_STATE_READY);
}

TEST_F(Bridge, StatusesThatWaitDoNotDelayAStop) {
    start({"--period-ms", "iocard=10", "--period-ms", "differential=10"});
    const uint64_t lease_us = sys.now_us + 200 * kMs;
    drive(0.3, 200000);
    sleep_ms(130);
    stall_ms(60);
    sys.receive_takes_us = 4000; /* in all, until long after the lease */
    sleep_ms(1);
    EXPECT_GE(sys.now_us, lease_us + 30 * kMs);
    const auto first_zero = std::find_if(sys.sent.begin(), sys.sent.end(), [](const auto &bytes) {
        roburoc4_differential_command command;
        return roburoc4_decode_differential_command(bytes.data(), bytes.size(), &command) == 0 &&
               command.service == ROBUROC4_SERVICE_DIFFERENTIAL && command.linear_m_s == 0;
    });
    ASSERT_NE(first_zero, sys.sent.end());
    EXPECT_LE(sys.sent_us[static_cast<size_t>(first_zero - sys.sent.begin())],
              lease_us + sys.receive_takes_us);
    sys.receive_takes_us = 0;
}

TEST_F(Bridge, PublishesItsStateFiveTimesASecondAndStatisticsOnce) {
    const uint64_t begun_us = sys.now_us;
    start();
    bus.published.clear();
    sleep_ms(10000);
    EXPECT_NEAR(static_cast<double>(times_of("ROBUROC4_BRIDGE_STATE").size()), 50, 1);
    EXPECT_NEAR(static_cast<double>(times_of("ROBUROC4_BRIDGE_STATISTICS").size()), 10, 1);
    EXPECT_NEAR(static_cast<double>(times_of("ROBUROC4_PROPERTIES").size()), 10, 1);
    EXPECT_NEAR(static_cast<double>(times_of("ROBUROC4_DIFFERENTIAL").size()), 200, 2);
    EXPECT_NEAR(static_cast<double>(times_of("ROBUROC4_IOCARD").size()), 200, 2);
    EXPECT_NEAR(static_cast<double>(times_of("ROBUROC4_LOCALIZATION").size()), 200, 2);
    EXPECT_NEAR(static_cast<double>(times_of("ROBUROC4_TELEMETER").size()), 100, 2);
    EXPECT_NEAR(static_cast<double>(times_of("ROBUROC4_BATTERY").size()), 10, 2);
    EXPECT_EQ(state()->problems, 0);
    EXPECT_TRUE(state()->can_drive);
    EXPECT_NEAR(static_cast<double>(utime() - state()->utime), 100e3, 100e3);
    EXPECT_NEAR(statistics()->round_trip_us, static_cast<double>(2 * sys.delay_us), 1000);
    EXPECT_EQ(sys.connects_us.front(), begun_us) << "at once";
    EXPECT_GT(LAST(battery_status, "ROBUROC4_BATTERY")->remaining_percent, 0);
    const auto telemeters = LAST(telemeter_status, "ROBUROC4_TELEMETER");
    ASSERT_EQ(telemeters->telemeter_count, 2);
    EXPECT_GT(telemeters->telemeters[0].max_distance_m, 0);
    const auto properties = LAST(robot_properties, "ROBUROC4_PROPERTIES");
    EXPECT_NEAR(static_cast<double>(utime() - properties->utime), 500e3, 501e3);
    EXPECT_TRUE(properties->telemeter_known);
    robot_->silent = true;
    sleep_ms(500);
    EXPECT_NEAR(static_cast<double>(state()->silence_us), 400e3, 110e3);
}

TEST_F(Bridge, TelemetersThatTheRobotLacksAreNotKnown) {
    use_robot([](roburoc4_sim_config &config) {
        config.hidden_services = 1u << ROBUROC4_SERVICE_TELEMETER;
    });
    start();
    EXPECT_FALSE(LAST(robot_properties, "ROBUROC4_PROPERTIES")->telemeter_known);
}

TEST_F(Bridge, ThePoseHasTheSpeedsThatTheRobotMeasured) {
    start({"--pose-channel", "POSE"});
    stream(0.3, 2000);
    const auto pose =
        last<bot_core_pose_t>("POSE", bot_core_pose_t_decode, bot_core_pose_t_decode_cleanup);
    EXPECT_NEAR(pose->vel[0], 0.3, 0.03);
    EXPECT_GT(pose->pos[0], 0.3);
}

TEST_F(Bridge, AsksOnlyForWhatItIsToPublish) {
    start({"--period-ms", "battery=0"});
    EXPECT_TRUE(times_of("ROBUROC4_BATTERY").empty());
    EXPECT_FALSE(times_of("ROBUROC4_IOCARD").empty());
}

TEST_F(Bridge, AStatusHasTheTimeWhenTheRobotMadeIt) {
    start();
    sys.delay_us = 100 * kMs; /* from now on */
    sleep_ms(300);
    EXPECT_NEAR(
        static_cast<double>(utime() - LAST(differential_status, "ROBUROC4_DIFFERENTIAL")->utime),
        125e3, 30e3);
}

TEST_F(Bridge, AChangeIsPublishedSoon) {
    start();
    await_state();
    stop();
    sleep_ms(60);
    EXPECT_TRUE(state()->stop_latched);
    await_state();
    ASSERT_TRUE(robot_->panel("pad a down"));
    sleep_ms(110); /* its status came, and 50 ms */
    EXPECT_TRUE(state()->overridden);
    sleep_ms(1000);
    drive(0.3);
    sleep_ms(60);
    EXPECT_EQ(std::string(state()->rejected_message).find("the robot cannot be armed: "), 0u);
}

TEST_F(Bridge, RobotsThatStartTogetherPublishAtDifferentTimes) {
    std::vector<std::string> others;
    for (int robot = 0; robot < 50; robot++) {
        others.insert(others.end(), {"-r", "R" + std::to_string(robot) + "=unknown"});
    }
    testing::internal::CaptureStderr();
    const uint64_t started_us = sys.now_us;
    start(others, "A=robot");
    const std::string log = testing::internal::GetCapturedStderr();
    EXPECT_EQ(lines_with(log, "the name unknown has no address"), 50u) << log;
    std::set<uint64_t> times;
    for (int robot = 0; robot < 50; robot++) {
        const auto all = times_of("R" + std::to_string(robot) + "_BRIDGE_STATE");
        times.insert(all.back());
        EXPECT_LE(all.front(), started_us + 220 * kMs) << "once within the first period";
    }
    EXPECT_GE(times.size(), 9u) << "200 us each, and it waits in milliseconds";
    EXPECT_EQ(state("A_BRIDGE_STATE")->state, ROBUROC4_STATE_READY);
}

/* --------------------------------------------------------------------- commands, by their kinds */

TEST_F(Bridge, ARejectedCommandIsCountedAndItsRemedyIsPublishedSoon) {
    start({"--allow-sender", "planner*"});
    using Count = int64_t roburoc4_lcm_bridge_statistics_t::*;
    using Counts = roburoc4_lcm_bridge_statistics_t;
    const std::string long_name = "planner" + std::string(57, 'x');
    const struct {
        std::function<void(Drive &)> drive;
        std::function<void(Move &)> move;
        Count count;
        const char *message;
    } cases[] = {
        {[](Drive &c) { c.utime = 0; }, {}, &Counts::rejected_no_utime, "its utime is 0"},
        {[](Drive &c) { c.utime /= 1000000; }, {}, &Counts::rejected_too_old, "its utime is not "},
        {[](Drive &c) { c.utime *= 1000; }, {}, &Counts::rejected_in_future, "its utime is not of"},
        {[](Drive &c) { c.utime -= 1000000; }, {}, &Counts::rejected_too_old, "by its utime it is"},
        {[](Drive &c) { c.sender = const_cast<char *>("x"); },
         {},
         &Counts::rejected_sender,
         "only senders planner* are obeyed (--allow-sender)"},
        {[&](Drive &c) { c.sender = const_cast<char *>(long_name.c_str()); },
         {},
         &Counts::rejected_sender,
         "its sender is empty or longer than 63 bytes"},
        {[](Drive &c) { c.angular_rad_s = 57; }, {}, &Counts::rejected_units, "it is faster than"},
        {{}, [](Move &c) { c.kind = 9; }, &Counts::rejected_impossible, "there is no such move"},
        {{}, [](Move &c) { c.angle_rad = 90; }, &Counts::rejected_units, "angles are in radians"},
    };
    for (const auto &each : cases) {
        sleep_ms(6000); /* each is logged */
        await_state();
        const int64_t before = statistics().get()->*each.count;
        each.drive ? drive_as(each.drive) : move_as(each.move);
        sleep_ms(60);
        EXPECT_EQ(std::string(state()->rejected_message).find(each.message), 0u)
            << state()->rejected_message << "\n"
            << each.message;
        EXPECT_EQ(statistics().get()->*each.count, before + 1) << each.message;
        EXPECT_EQ(state()->rejected_utime, sent_utime_);
        EXPECT_EQ(state()->rejected_sender, sent_sender_.substr(0, 63));
        EXPECT_NE(state()->rejected_cause, 0);
    }
    EXPECT_EQ(statistics()->accepted_drive, 0);
    EXPECT_TRUE(robot_->commands.empty());
}

TEST_F(Bridge, TheLastRejectionIsPublishedAlsoIfOneLikeItWasLogged) {
    start({"--allow-sender", "planner*"});
    int32_t causes[3];
    for (int i = 0; i < 3; i++) {
        drive_as([=](Drive &command) {
            command.utime -= i % 2 == 0 ? 1000000 : 0;
            command.angular_rad_s = 57;
        });
        sleep_ms(300);
        causes[i] = state()->rejected_cause;
        EXPECT_EQ(state()->rejected_utime, sent_utime_) << i;
    }
    EXPECT_NE(causes[0], causes[1]);
    EXPECT_EQ(causes[0], causes[2]);
}

TEST_F(Bridge, OfWhatIsNoCommandTheLogNamesTheChannel) {
    testing::internal::CaptureStderr();
    start({"--verbose"});
    for (const char *channel :
         {"ROBUROC4_MOVE_CMD", "ROBUROC4_DRIVE_CMD", "ROBUROC4_OUTPUT_CMD", "ROBUROC4_STOP_CMD"}) {
        bus.unread.push_back({sys.now_us, channel, Bytes(9)});
        sleep_ms(100);
    }
    const std::string log = testing::internal::GetCapturedStderr();
    EXPECT_EQ(lines_with(log, "no answer"), 0u) << "it came within a second";
    EXPECT_EQ(lines_with(log, "move command on 'ROBUROC4_MOVE_CMD' rejected"), 1u) << log;
    EXPECT_EQ(lines_with(log, "drive command on 'ROBUROC4_DRIVE_CMD' rejected"), 1u) << log;
    EXPECT_EQ(lines_with(log, "output command on 'ROBUROC4_OUTPUT_CMD' rejected"), 1u) << log;
    EXPECT_EQ(lines_with(log, "stopped by a stop command without a sender"), 1u) << log;
}

TEST_F(Bridge, TheLogNamesTheSenderAndAQuietOneSaysNothing) {
    const auto log_with = [this](std::vector<std::string> arguments) {
        arguments.insert(arguments.end(), {"--robot", "RED=robot", "--allow-sender", "planner"});
        forget();
        testing::internal::CaptureStderr();
        launch(arguments);
        sleep_ms(3000);
        for (int i = 0; i < 3; i++) {
            drive_as([](Drive &command) { command.sender = const_cast<char *>("someone else"); },
                     "RED_DRIVE_CMD");
            sleep_ms(100);
        }
        end(SIGTERM);
        bridge_->join();
        return testing::internal::GetCapturedStderr();
    };
    const std::string rejection = "RED: drive command of 'someone else' rejected";
    const std::string usual = log_with({"--enable-drive"});
    EXPECT_EQ(lines_with(usual, rejection), 1u) << usual;
    EXPECT_EQ(lines_with(usual, "ended by SIGTERM"), 1u) << usual;
    const std::string verbose = log_with({"--enable-drive", "--verbose"});
    EXPECT_EQ(lines_with(verbose, rejection), 3u) << verbose;
    EXPECT_EQ(log_with({"--enable-drive", "--quiet"}), "");
}

TEST_F(Bridge, CommandsThatWereReducedOrReplacedAreCounted) {
    start({"--max-linear-m-s", "5"}); /* the robot: 2.6 and 6.5 */
    int64_t clamped = 0;
    for (const auto &[linear, angular, reduced] : {std::tuple{0.3, 1.4, 0},
                                                   {-0.3, -1.4, 0},
                                                   {2.6, 1.5, 0},
                                                   {2.7, 0.0, 1},
                                                   {-2.7, 0.0, 1},
                                                   {0.0, 1.6, 1},
                                                   {0.0, -1.6, 1}}) {
        const double linear_m_s = linear, angular_rad_s = angular;
        drive_as([=](Drive &command) {
            command.linear_m_s = linear_m_s;
            command.angular_rad_s = angular_rad_s;
        });
        sleep_ms(1100);
        clamped += reduced;
        EXPECT_EQ(statistics()->clamped, clamped) << linear << " " << angular;
    }
    drive(0.3, 60000);
    drive(0.2, 200000);
    const uint64_t sent_us = sys.now_us;
    sleep_ms(1100);
    EXPECT_EQ(statistics()->superseded, 1);
    EXPECT_EQ(statistics()->accepted_drive, 8);
    EXPECT_GE(robot_->last_speed_us(), sent_us + 100 * kMs);
}

TEST_F(Bridge, WithoutEnableItOnlyWatches) {
    launch({"--robot", "robot", "--quiet"});
    sleep_ms(3000);
    drive(0.3);
    move_by(1, 1);
    relocalize(1, 2, 3);
    output_as([](Output &) {});
    sleep_ms(1100);
    EXPECT_EQ(statistics()->rejected_disabled, 4);
    end(SIGTERM);
    bridge_->join();
    sleep_ms(100);
    EXPECT_TRUE(robot_->commands.empty()) << "not even a zero at the end";
    EXPECT_EQ(robot_->state().odometry_x_m, 0);
}

TEST_F(Bridge, ARelocalizationSetsThePose) {
    start({"--enable-relocalize"});
    EXPECT_EQ(state()->command_age_us, -1);
    relocalize(1, 2, 3);
    sleep_ms(1100);
    EXPECT_NEAR(robot_->state().odometry_x_m, 1, 1e-6);
    EXPECT_NEAR(robot_->state().odometry_y_m, 2, 1e-6);
    EXPECT_NEAR(robot_->state().odometry_theta_rad, 3, 1e-6);
    EXPECT_EQ(statistics()->accepted_relocalize, 1);
    EXPECT_NEAR(static_cast<double>(state()->command_age_us), 1000e3, 101e3);
}

TEST_F(Bridge, AMoveGoesWhereItSaysAndNoFaster) {
    start();
    const struct {
        int32_t kind;
        double distance_m, angle_rad, x_m, y_m, theta_rad, linear_m_s, angular_rad_s;
        double end_x_m, end_y_m, end_theta_rad, fastest_m_s, fastest_rad_s;
    } cases[] = {
        {KIND(BY), 1, 0, 9, 9, 9, 0.2, 0, 1, 0, 0, 0.2, 0},
        {KIND(BY), 0, -1.5, 9, 9, 9, 0, 0.4, 1, 0, -1.5, 0, 0.4},
        {KIND(TO_POINT), 9, 9, 2, 1, 9, 0, 0, 2, 1, 0.785, 0.3, 0.5},
        {KIND(TO_POSE), 9, 9, 1, 2, 0, 0, 0, 1, 2, 0, 0.3, 0.5},
    };
    for (const auto &each : cases) {
        robot_->commands.clear();
        for (int i = 0, ended = 0; i < 400 && ended < 20; i++) {
            ended += i >= 5 && last_move_outcome() != ROBUROC4_MOVE_RUNNING;
            move_as([&](Move &command) {
                command.move_id = &each - cases;
                command.kind = each.kind;
                command.distance_m = each.distance_m;
                command.angle_rad = each.angle_rad;
                command.x_m = each.x_m;
                command.y_m = each.y_m;
                command.theta_rad = each.theta_rad;
                command.max_linear_m_s = each.linear_m_s;
                command.max_angular_rad_s = each.angular_rad_s;
            });
            sleep_ms(50);
        }
        const auto status = LAST(move_status, "ROBUROC4_MOVE_STATUS");
        EXPECT_EQ(status->outcome, ROBUROC4_MOVE_REACHED);
        EXPECT_EQ(status->move_id, &each - cases);
        EXPECT_EQ(status->sender, std::string("planner"));
        if (each.kind == KIND(BY)) {
            EXPECT_NEAR(status->distance_m, each.distance_m, 0.05);
        }
        EXPECT_NEAR(robot_->state().odometry_x_m, each.end_x_m, 0.05) << "not a second time";
        EXPECT_NEAR(robot_->state().odometry_y_m, each.end_y_m, 0.05);
        EXPECT_NEAR(robot_->state().odometry_theta_rad, each.end_theta_rad, 0.1);
        double fastest_m_s = 0, fastest_rad_s = 0;
        for (const SpeedCommand &command : robot_->commands) {
            fastest_m_s = std::max<double>(fastest_m_s, std::abs(command.linear_m_s));
            fastest_rad_s = std::max<double>(fastest_rad_s, std::abs(command.angular_rad_s));
        }
        EXPECT_NEAR(fastest_m_s, each.fastest_m_s, 0.01);
        EXPECT_NEAR(fastest_rad_s, each.fastest_rad_s, 0.05);
    }
}

TEST_F(Bridge, AMoveTakesItsTimeItsAccelerationAndTurnsAsItSays) {
    start();
    const auto duration_us = [this](int64_t id, auto change) {
        const uint64_t began_us = sys.now_us;
        do {
            move_as([=](Move &command) {
                command.move_id = id;
                change(command);
            });
            sleep_ms(50);
        } while (last_move_outcome() == ROBUROC4_MOVE_RUNNING &&
                 sys.now_us - began_us < 60 * kSecond);
        return sys.now_us - began_us;
    };
    const uint64_t usual_us = duration_us(1, [](Move &c) { c.distance_m = 1; });
    EXPECT_EQ(last_move_outcome(), ROBUROC4_MOVE_REACHED);
    const uint64_t gentle_us = duration_us(2, [](Move &c) {
        c.distance_m = 1;
        c.max_linear_m_s2 = 0.05;
    });
    EXPECT_GT(gentle_us, usual_us + 3 * kSecond);
    duration_us(3, [](Move &c) {
        c.distance_m = 1;
        c.timeout_ms = 500;
    });
    EXPECT_EQ(last_move_outcome(), ROBUROC4_MOVE_TIMEOUT);
    sleep_ms(1000);
    duration_us(4, [](Move &c) {
        c.angle_rad = 13;
        c.max_angular_rad_s = 1.5;
        c.max_angular_rad_s2 = 0.5;
        c.allow_turns = 1;
    });
    EXPECT_EQ(last_move_outcome(), ROBUROC4_MOVE_REACHED);
    EXPECT_GT(statistics()->accepted_move, 100);
    EXPECT_EQ(statistics()->accepted_drive, 0);
}

TEST_F(Bridge, AMoveThatIsNotRenewedEndsWithItsLease) {
    start();
    const uint64_t sent_us = sys.now_us;
    move_by(5, 7, 250000);
    sleep_ms(100);
    stall_ms(60);
    sleep_ms(840);
    EXPECT_GE(robot_->speeds(), 3u);
    EXPECT_LE(robot_->commands.size(), 1 + robot_->speeds() + robot_->zeros_at_the_end())
        << "without a break, besides a zero to begin with";
    EXPECT_GE(robot_->last_speed_us(), sent_us + 150 * kMs);
    expect_stopped_at(sent_us + 271 * kMs); /* the shortest lease more */
    EXPECT_EQ(last_move_outcome(), ROBUROC4_MOVE_LAPSED);
    EXPECT_NEAR(static_cast<double>(state()->command_age_us), 900e3, 101e3);
    stop();
    sleep_ms(1000);
    EXPECT_EQ(last_move_outcome(), ROBUROC4_MOVE_LAPSED) << "it had ended before";
    EXPECT_NEAR(static_cast<double>(times_of("ROBUROC4_MOVE_STATUS").back() - sent_us), 1.15e6, 1e5)
        << "published for a second more";
    EXPECT_LE(times_of("ROBUROC4_MOVE_STATUS").size(), 12u) << "five times a second";
}

TEST_F(Bridge, TheEndOfTheBridgeCancelsAMove) {
    for (const uint64_t after_ms : {1u, 200u}) {
        forget();
        start();
        move_by(5, 7);
        sleep_ms(after_ms);
        end(SIGTERM);
        bridge_->join();
        EXPECT_EQ(last_move_outcome(), ROBUROC4_MOVE_CANCELLED) << after_ms;
        EXPECT_STREQ(state()->message, "the bridge has ended");
    }
}

TEST_F(Bridge, AStopThatIsReadWithACommandWins) {
    start({"--lease-ms", "1000"}); /* longer than the stop takes */
    drive(0.3);
    stop();
    sleep_ms(1000);
    EXPECT_EQ(robot_->speeds(), 0u);
}

TEST_F(Bridge, OfASpeedAndAMoveThatAreReadTogetherTheLaterDrives) {
    start();
    drive(-0.2);
    move_by(5, 7);
    sleep_ms(200);
    EXPECT_EQ(last_move_outcome(), ROBUROC4_MOVE_RUNNING);
    ASSERT_GE(robot_->speeds(), 2u);
    for (const SpeedCommand &command : robot_->commands) {
        EXPECT_GE(command.linear_m_s, 0.0f);
    }
    for (const double speed : {-0.2, 0.0}) {
        move_by(5, speed < 0 ? 7 : 8);
        drive(speed);
        sleep_ms(200);
        EXPECT_EQ(last_move_outcome(), ROBUROC4_MOVE_CANCELLED);
        EXPECT_EQ(robot_->commands.back().linear_m_s, static_cast<float>(speed));
    }
    sleep_ms(1000);
    EXPECT_EQ(statistics()->superseded, 1) << "the first speed";
}

TEST_F(Bridge, ASpeedEndsAMoveAlsoIfARenewalFollowsAtOnce) {
    start();
    move_by(5, 7);
    sleep_ms(200);
    drive(0.0);
    move_by(5, 7);
    sleep_ms(200);
    EXPECT_EQ(last_move_outcome(), ROBUROC4_MOVE_CANCELLED);
    drive(-0.2);
    move_by(5, 7); /* it has ended */
    sleep_ms(200);
    EXPECT_EQ(last_move_outcome(), ROBUROC4_MOVE_CANCELLED);
    EXPECT_EQ(robot_->commands.back().linear_m_s, -0.2f);
    EXPECT_EQ(statistics()->superseded, 0);
    EXPECT_EQ(statistics()->accepted_move, 1);
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
        EXPECT_EQ(last_move_outcome(), ROBUROC4_MOVE_REACHED);
        sleep_ms(600);
    }
    EXPECT_NEAR(robot_->state().odometry_x_m, 0.4, 0.03);
}

TEST_F(Bridge, AMoveKeepsTheClearanceThatItAsksForOrHalfAMetre) {
    start();
    for (const auto &[box, clearance_m, outcome] :
         {std::tuple{"box add 2.2 0 0.2 2 0", 3.0, ROBUROC4_MOVE_OBSTACLE},
          {"", 0.0, ROBUROC4_MOVE_RUNNING},
          {"box add 1.2 0 0.2 2 0", 0.0, ROBUROC4_MOVE_OBSTACLE},
          {"", -1.0, ROBUROC4_MOVE_RUNNING}}) {
        ASSERT_TRUE(*box == '\0' || robot_->panel(box));
        sleep_ms(200);
        move_by(0.1, next_utime(), 0, clearance_m);
        sleep_ms(100);
        EXPECT_EQ(last_move_outcome(), outcome) << box << " " << clearance_m;
        sleep_ms(600);
    }
}

TEST_F(Bridge, OutputsAreSetTogetherOrNotAtAll) {
    use_robot([](roburoc4_sim_config &config) { config.analog_outputs = 2; });
    start({"--enable-outputs"});
    const struct {
        int32_t digital, analog;
        int8_t on;
        double output, voltage; /* then, of digital 3 and analog 1 */
    } cases[] = {{3, 2, 1, 0, 0},   {3, -1, 1, 0, 0},  {64, 1, 1, 0, 0},
                 {-1, 1, 1, 0, 0},  {0, 1, 1, 0, 0}, /* it belongs to the robot */
                 {3, 1, 1, 1, 1.5}, {3, 1, 0, 0, 1.5}, {64, 1, 1, 0, 1.5}};
    int64_t accepted = 0;
    for (const auto &each : cases) {
        int32_t digital = each.digital, analog[] = {0, each.analog};
        int8_t on = each.on;
        float voltages[] = {0.5, 1.5};
        output_as([&](Output &command) {
            command.digital_count = 1;
            command.analog_count = 2;
            command.digital_index = &digital;
            command.digital_on = &on;
            command.analog_index = analog;
            command.analog_value = voltages;
        });
        sleep_ms(1100);
        accepted += each.digital == 3 && each.analog == 1;
        EXPECT_EQ(robot_->control(ROBUROC4_SIM_DIGITAL_OUTPUT + 3), each.output);
        EXPECT_EQ(robot_->control(ROBUROC4_SIM_ANALOG_OUTPUT + 1), each.voltage);
        EXPECT_EQ(statistics()->accepted_output, accepted);
        EXPECT_EQ(statistics()->rejected_impossible, &each - cases + 1 - accepted);
    }
}

TEST_F(Bridge, OutputsOfARobotWithoutThemAreRefused) {
    use_robot([](roburoc4_sim_config &config) {
        config.hidden_services = 1u << ROBUROC4_SERVICE_IOCARD;
    });
    start({"--enable-outputs"});
    output_as([](Output &) {});
    sleep_ms(1100);
    EXPECT_EQ(statistics()->accepted_output, 0);
    EXPECT_EQ(statistics()->rejected_impossible, 1);
}

TEST_F(Bridge, TheEndOfAMoveSaysWhatToDoAboutIt) {
    start();
    const struct {
        double linear_m_s;
        bool renewed, stopped;
        int32_t result;
        const char *message;
    } cases[] = {
        {2, true, false, ROBUROC4_MOVE_TOO_FAST, "--max-linear-m-s or --max-angular-rad-s"},
        {0, false, false, ROBUROC4_MOVE_LAPSED, "begin again with another move_id"},
        {0, true, true, ROBUROC4_MOVE_CANCELLED, "see BRIDGE_STATE"},
        {0, true, false, ROBUROC4_MOVE_REACHED, "goal reached"}};
    for (const auto &each : cases) {
        sleep_ms(600);
        for (int i = 0; i < (each.renewed ? 100 : 1); i++) {
            move_as([&](Move &command) {
                command.move_id = &each - cases;
                command.distance_m = 0.3;
                command.max_linear_m_s = each.linear_m_s;
                command.clearance_m = i % 2 == 0 ? -1 : 0; /* that of the first holds */
            });
            sleep_ms(50);
            if (each.stopped && i == 5) {
                stop();
            }
        }
        sleep_ms(600);
        const auto status = LAST(move_status, "ROBUROC4_MOVE_STATUS");
        EXPECT_EQ(status->outcome, each.result) << status->message;
        EXPECT_NE(std::string(status->message).find(each.message), std::string::npos)
            << status->message;
    }
}

/* ---------------------------------------------------------------------------- begin and end */

TEST_F(Bridge, WhatDoesNotRunSaysWhyAndEndsWithTheStatusOfItsHelp) {
    const struct {
        std::vector<std::string> arguments;
        int status;
        const char *printed;
    } cases[] = {
        {{"--help"},
         0,
         "Exit status: 0 ended on\nrequest, 1 error, 2 bad usage, 3 no LCM network."},
        {{"--version"}, 0, "(built with LCM 0)\n"},
        {{"--nonsense"}, 2, "unknown option '--nonsense'"},
        {{"-r", "robot:0"}, 2, "with a port of 1 to 65535"},
        {{"-r", "nobody"}, 1, "the name has no address"},
        {{"-r", "robot", "--check"}, 0, "robot: 10.0.0.1:60000 (robot)\n"},
        {{"-r", "A=robot", "-r", "B=nobody", "--check"}, 1, "B: NO ADDRESS (nobody)\n"},
    };
    for (const auto &each : cases) {
        std::string printed;
        EXPECT_EQ(run_early(each.arguments, printed), each.status) << each.printed;
        EXPECT_EQ(lines_with(printed, each.printed), 1u) << printed;
        EXPECT_EQ(lines_with(printed, "unrecognized"), 0u) << "these are getopt's words";
    }
    EXPECT_EQ(bus.url, "none") << "no network was joined";
}

TEST_F(Bridge, WhatCannotBePrintedIsAnError) {
    if (access("/dev/full", W_OK) != 0) {
        GTEST_SKIP() << "this system has no /dev/full";
    }
    for (const char *option : {"--help", "--version", "--check"}) {
        std::vector<std::string> arguments = {"roburoc4-lcm", option, "--robot", "robot"};
        bridge_forget();
        std::fflush(stdout);
        const int before = dup(STDOUT_FILENO), full = open("/dev/full", O_WRONLY);
        ASSERT_GE(dup2(full, STDOUT_FILENO), 0);
        const int status = run(arguments);
        ASSERT_GE(dup2(before, STDOUT_FILENO), 0);
        close(before);
        close(full);
        std::clearerr(stdout);
        EXPECT_EQ(status, 1) << option;
    }
}

TEST_F(Bridge, WithoutAnLcmNetworkItDoesNotRun) {
    const std::vector<std::string> arguments = {"-r",           "robot",
                                                "-l",           "udpm://239.255.76.67:7667?ttl=0",
                                                "--channel",    "STOP_CMD=HALT_CMD",
                                                "--channel",    "BRIDGE_STATE=STATE",
                                                "--fleet-stop", "ALL_CMD"};
    std::string printed;
    for (int calls = 0; calls < 13; calls++) { /* the network, six channels and their queues */
        bus.calls = calls;
        EXPECT_EQ(run_early(arguments, printed), 3) << calls;
        EXPECT_EQ(lines_with(printed, "no LCM network at udpm://239.255.76.67:7667?ttl=0"), 1u);
        EXPECT_EQ(lines_with(printed, "ip route add 224.0.0.0/4 dev lo"), 1u);
        EXPECT_EQ(bus.existing, 0);
    }
    forget();
    bus.calls = 0;
    EXPECT_EQ(run_early({"-r", "robot"}, printed), 3);
    EXPECT_EQ(lines_with(printed, "no LCM network at LCM's default"), 1u) << printed;
    bus.watching_fails = true;
    EXPECT_EQ(run_early({"-r", "robot"}, printed), 1);
    EXPECT_EQ(lines_with(printed, "cannot wait for sockets: Too many open files"), 1u) << printed;
}

TEST_F(Bridge, AnLcmThatOnePacketEndsDoesNotDrive) {
    bridge_lcm_is_old = true;
    std::string printed;
    EXPECT_EQ(run_early({"-r", "robot", "--enable-drive"}, printed), 1);
    EXPECT_EQ(lines_with(printed, "so it does not drive"), 1u) << printed;
    for (const bool local : {true, false}) { /* without packets, and without driving */
        forget();
        bridge_lcm_is_old = true;
        testing::internal::CaptureStderr();
        bridge_ = std::make_unique<Thread>([this, local] {
            std::vector<std::string> arguments = {"roburoc4-lcm", "-r", "robot", "-l",
                                                  local ? "memq://" : "udpm://"};
            if (local) {
                arguments.push_back("--enable-drive");
            }
            status_ = run(arguments);
        });
        sleep_ms(3000);
        EXPECT_EQ(state()->state, ROBUROC4_STATE_READY);
        end(SIGTERM);
        bridge_->join();
        EXPECT_EQ(lines_with(testing::internal::GetCapturedStderr(), "cannot drop such packets"),
                  local ? 0u : 1u);
    }
}

TEST_F(Bridge, ManyRobotsGetALargerBufferAndEnoughFiles) {
    const struct {
        uint32_t robots;
        std::string given, used;
        rlim_t files, most_files, allowed;
    } cases[] = {
        {1, "", "", 1024, 4096, 1024},
        {31, "", "", 80, 4096, 95},
        {32, "", "udpm://?recv_buf_size=4194304", 80, 90, 90},
        {32, "udpm://?ttl=0", "udpm://?ttl=0&recv_buf_size=4194304", 96, 4096, 96},
        {32, "udpm://?recv_buf_size=9", "udpm://?recv_buf_size=9", 1024, 4096, 1024},
        {32, "memq://", "memq://", 1024, 4096, 1024},
    };
    for (const auto &each : cases) {
        forget();
        bus.files = each.files;
        bus.most_files = each.most_files;
        std::vector<std::string> more = {};
        for (uint32_t robot = 1; robot < each.robots; robot++) {
            more.insert(more.end(), {"-r", "R" + std::to_string(robot) + "=unknown"});
        }
        if (!each.given.empty()) {
            more.insert(more.end(), {"-l", each.given});
        }
        testing::internal::CaptureStderr();
        start(more, "A=robot");
        end(SIGTERM);
        bridge_->join();
        (void)testing::internal::GetCapturedStderr();
        EXPECT_EQ(bus.url, each.used);
        EXPECT_EQ(bus.files, each.allowed);
    }
}

TEST_F(Bridge, ASignalThatWasIgnoredStaysIgnoredOnlyIfItIsTheHangup) {
    for (const bool nohup : {true, false}) {
        forget();
        std::signal(SIGHUP, nohup ? SIG_IGN : SIG_DFL);
        std::signal(SIGTERM, SIG_IGN);
        start();
        EXPECT_EQ(std::signal(SIGHUP, SIG_IGN) == SIG_IGN, nohup);
        EXPECT_NE(std::signal(SIGTERM, SIG_IGN), SIG_IGN);
        EXPECT_EQ(std::signal(SIGPIPE, SIG_IGN), SIG_IGN);
        end(SIGTERM);
        bridge_->join();
    }
}

TEST_F(Bridge, IsNamedByItsHostIfThatIsText) {
    for (const auto &[host, name] : {std::pair{"lab", "lab"}, {"two words", "two"}, {"\xFF", ""}}) {
        forget();
        bus.host = host;
        start();
        EXPECT_EQ(state()->bridge, name + (" " + std::to_string(getpid())));
        end(SIGTERM);
        bridge_->join();
    }
}

TEST_F(Bridge, RecordsAllRobotsInAFileOrDoesNotRun) {
    const std::string file = testing::TempDir() + "bridge_records.pcapng";
    const std::string again = testing::TempDir() + "bridge_records_again.pcapng";
    sys.disk_room = 6000;
    testing::internal::CaptureStderr();
    start({"--record", file, "--verbose"});
    end(SIGTERM);
    bridge_->join();
    const std::string log = testing::internal::GetCapturedStderr();
    EXPECT_EQ(lines_with(log, "recording to " + file), 1u) << log;
    EXPECT_EQ(lines_with(log, "datagrams are missing because the disk was full or slow: "), 1u);
    EXPECT_GT(sys.files[file].size(), 5000u);
    sys.disk_room = UINT64_MAX;
    forget();
    start({"--record", again});
    sys.receives = {ROBUROC4_OS_BROKEN}; /* it gets another socket */
    sleep_ms(2000);
    const size_t size = sys.files[again].size();
    sleep_ms(1000);
    EXPECT_GT(sys.files[again].size(), size + 5000u);
    end(SIGTERM);
    bridge_->join();
    sys.create_error = EACCES;
    std::string printed;
    forget();
    EXPECT_EQ(run_early({"-r", "robot", "--record", file}, printed), 1);
    EXPECT_EQ(lines_with(printed, "--record " + file + ": Permission denied"), 1u) << printed;
}

/* -------------------------------------------------------------------------- robots and bridges */

TEST_F(Bridge, ItsChannelsMayHaveAnyNames) {
    start({"--channel", "STOP_CMD=HALT_CMD", "--channel", "BRIDGE_STATE=STATE", "--fleet-stop",
           "ALL_CMD", "--pose-channel", "POSE"});
    for (const char *channel : {"HALT_CMD", "ALL_CMD"}) {
        sleep_ms(600);
        stream(0.3, 500);
        EXPECT_GT(robot_->last_speed_us(), sys.now_us - 100 * kMs);
        const uint64_t asked_us = sys.now_us;
        stop(channel);
        sleep_ms(300);
        expect_stopped_at(asked_us);
        stop("ANOTHER_STOP_CMD");
    }
    const auto pose =
        last<bot_core_pose_t>("POSE", bot_core_pose_t_decode, bot_core_pose_t_decode_cleanup);
    EXPECT_NEAR(pose->pos[0], robot_->state().odometry_x_m, 0.01);
    const auto seen = state("STATE"); /* which has the texts */
    auto other = *seen;
    other.bridge = const_cast<char *>("elsewhere 1");
    for (const std::string address : {"10.0.0.9:60000", "10.0.0.1:60000"}) {
        sleep_ms(2300);
        EXPECT_FALSE((state("STATE")->problems & PROBLEM(OTHER_BRIDGE)) != 0);
        auto sent = other;
        sent.utime = utime();
        sent.robot = const_cast<char *>(address.c_str());
        give("STATE", sent, roburoc4_lcm_bridge_state_t_encoded_size,
             roburoc4_lcm_bridge_state_t_encode);
        bus.unread.push_back({sys.now_us, "STATE", Bytes(9)}); /* it is no state */
        sleep_ms(60);
        EXPECT_TRUE((state("STATE")->problems & PROBLEM(OTHER_BRIDGE)) != 0) << address;
    }
}

TEST_F(Bridge, AnLcmThatCannotSendIsLoggedOnceUntilItCanAgain) {
    testing::internal::CaptureStderr();
    start({"--verbose"});
    sleep_ms(200);
    EXPECT_EQ(lines_with(testing::internal::GetCapturedStderr(), "LCM cannot"), 0u);
    testing::internal::CaptureStderr();
    const auto errors = [] { return statistics()->publish_errors; };
    EXPECT_EQ(errors(), 0);
    const int64_t published = statistics()->published;
    for (const uint64_t ms : {3000u, 500u}) { /* it works again after a second without an error */
        bus.publishing_fails = true;
        sleep_ms(ms);
        bus.publishing_fails = false;
        sleep_ms(500);
    }
    sleep_ms(2000);
    EXPECT_GT(errors(), 3 * 50);
    EXPECT_LT(statistics()->published - published, 350) << "in three of six seconds";
    const std::string log = testing::internal::GetCapturedStderr();
    EXPECT_EQ(lines_with(log, "LCM cannot send: "), 1u) << log;
    EXPECT_EQ(lines_with(log, "LCM can send again"), 1u) << log;
}

TEST_F(Bridge, AFloodOfCommandsDelaysAStatusByAThousandOfThem) {
    start();
    bus.published.clear();
    bus.read_takes_us = 50;
    uint64_t before_us = sys.now_us;
    for (int i = 0; i < 10000; i++) {
        bus.unread.push_back({sys.now_us, "ANOTHER_DRIVE_CMD", Bytes(9)});
    }
    sleep_ms(1000);
    EXPECT_TRUE(bus.unread.empty());
    const auto times = times_of("ROBUROC4_DIFFERENTIAL");
    ASSERT_NEAR(static_cast<double>(times.size()), 20, 1);
    for (const uint64_t time_us : times) {
        EXPECT_LE(time_us - before_us, 110 * kMs);
        before_us = time_us;
    }
}

TEST_F(Bridge, WhatHappensToTheRobotIsLoggedInWords) {
    use_robot(
        [](roburoc4_sim_config &config) { config.replace_mode = ROBUROC4_SIM_REPLACE_REFUSED; });
    testing::internal::CaptureStderr();
    start({"--verbose", "--enable-relocalize"});
    relocalize(1, 2, 3);
    stream(0.3, 500);
    sleep_ms(1000);
    ASSERT_TRUE(robot_->panel("pad_a down"));
    stream(0.3, 200);
    ASSERT_TRUE(robot_->panel("pad_a up"));
    sleep_ms(1000);
    ASSERT_TRUE(robot_->panel("estop_local press"));
    stream(0.3, 2000);
    ASSERT_TRUE(robot_->panel("estop_local release"));
    sleep_ms(1000);
    const roburoc4_differential_command another{0.2F, 0, ROBUROC4_SERVICE_DIFFERENTIAL, 0};
    Bytes bytes(64);
    bytes.resize(static_cast<size_t>(roburoc4_encode_differential_command(
        bytes.data(), bytes.size(), another.service, another.linear_m_s, another.angular_rad_s)));
    for (int i = 0; i < 20; i++) {
        robot_->receive(9, bytes);
        sleep_ms(50);
    }
    sleep_ms(2000);
    stream(0.3, 300);
    sleep_ms(2000); /* a stream that ended is none of the robot's faults */
    stop();
    robot_->silent = true;
    sleep_ms(3000);
    robot_->silent = false;
    sleep_ms(3000);
    const std::string log = testing::internal::GetCapturedStderr();
    size_t at = 0;
    for (const char *text :
         {"bridging 1 robot; driving is ON", "connected to 10.0.0.1:60000",
          "armed: drive commands are accepted", "the robot did not accept its new pose: the robot",
          "the lease expired without a new drive command", "disarmed: game pad override",
          "[A] is held on the game pad", "[A] on the game pad was released",
          "armed: drive commands are accepted", "disarmed: the robot does not follow its commands",
          "motion inhibited: ", "the robot follows its commands again",
          "another client commands the robot", "no other client commands the robot any more",
          "stopped by 'operator'", "10.0.0.1:60000 fell silent; still trying",
          "the stop sequence ended, but the robot did not confirm it",
          "connected to 10.0.0.1:60000"}) {
        at = log.find(text, at);
        ASSERT_NE(at, std::string::npos) << text << "\n" << log;
    }
    EXPECT_EQ(lines_with(log, "disarmed: "), 2u) << log;
    EXPECT_EQ(lines_with(log, "clock was set"), 0u) << log;
}

TEST_F(Bridge, NothingIsKeptOfARobotThatAnotherReplaced) {
    use_robot([](roburoc4_sim_config &config) { config.texts = ROBUROC4_SIM_TEXTS_REORDERED; });
    start();
    const auto names = [] {
        const auto status = LAST(iocard_status, "ROBUROC4_IOCARD");
        return std::vector<std::string>(status->analog_input_names,
                                        status->analog_input_names + status->analog_input_count);
    };
    const auto telemeters = LAST(telemeter_status, "ROBUROC4_TELEMETER");
    ASSERT_EQ(telemeters->telemeter_count, 2);
    EXPECT_GT(telemeters->telemeters[0].x_m, 0);
    EXPECT_LT(telemeters->telemeters[1].x_m, 0);
    EXPECT_EQ(names().front(), "voltage, Front telemeter");
    ASSERT_TRUE(robot_->panel("family 1")); /* another robot, which refuses to name anything */
    sleep_ms(6000);
    for (const std::string &name : names()) {
        EXPECT_EQ(name, "");
    }
}

TEST_F(Bridge, AnotherBridgeOfThisRobotOrOnItsChannelsIsNoticedUntilItIsGone) {
    for (const auto &[host, max_age_ms] : {std::pair{"robot", "200"}, {"localhost", "0"}}) {
        forget();
        start({"--max-age-ms", max_age_ms}, host);
        const std::string own = state()->bridge;
        const std::string here = own.substr(0, own.find(' ')) + " 1", there = "elsewhere 1";
        const std::string address = state()->robot;
        const bool local = host[0] == 'l', any_age = local;
        const struct {
            std::string channel, robot, bridge;
            int64_t age_ms;
            bool noticed;
        } cases[] = {
            {"OTHER_BRIDGE_STATE", address, there, 0, !local},
            {"OTHER_BRIDGE_STATE", address, here, 0, true},
            {"ROBUROC4_BRIDGE_STATE", "10.0.0.9:60000", there, 0, true},
            {"OTHER_BRIDGE_STATE", "10.0.0.9:60000", here, 0, false},
            {"OTHER_BRIDGE_STATE", address, own, 0, false}, /* itself */
            {"OTHER_BRIDGE_STATE", address, here, 2100, true},
            {"OTHER_BRIDGE_STATE", address, here, 2300, any_age},
            {"OTHER_BRIDGE_STATE", address, here, -2100, true},
            {"OTHER_BRIDGE_STATE", address, here, -2300, any_age},
        };
        for (const auto &each : cases) {
            const auto seen = state();
            auto other = *seen;
            other.robot = const_cast<char *>(each.robot.c_str());
            other.bridge = const_cast<char *>(each.bridge.c_str());
            testing::internal::CaptureStderr();
            for (int i = 0; i < 3; i++) { /* it goes on publishing */
                other.utime = utime() - each.age_ms * 1000;
                give(each.channel.c_str(), other, roburoc4_lcm_bridge_state_t_encoded_size,
                     roburoc4_lcm_bridge_state_t_encode);
                sleep_ms(1000);
                EXPECT_EQ(has_problem(PROBLEM(OTHER_BRIDGE)), each.noticed) << &each - cases;
            }
            sleep_ms(960);
            EXPECT_EQ(has_problem(PROBLEM(OTHER_BRIDGE)), each.noticed) << &each - cases;
            sleep_ms(300);
            EXPECT_FALSE(has_problem(PROBLEM(OTHER_BRIDGE)));
            const std::string log = testing::internal::GetCapturedStderr();
            EXPECT_EQ(lines_with(log, "another bridge ("), each.noticed ? 1u : 0u) << log;
        }
        end(SIGTERM);
        bridge_->join();
    }
}

} // namespace
