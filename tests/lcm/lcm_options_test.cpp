/* SPDX-License-Identifier: MIT
 *
 * The LCM bridge's command line and its texts.
 */
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "options.h"
#include "text.h"

namespace {

struct Read {
    std::shared_ptr<options> out = std::make_shared<options>();
    options_result result = OPTIONS_BAD;
    std::string error;
};

Read read(std::vector<std::string> arguments) {
    Read r;
    char error[OPTIONS_ERROR_SIZE] = "";
    std::vector<char *> pointers;
    arguments.insert(arguments.begin(), "roburoc4-lcm");
    for (std::string &argument : arguments)
        pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    static std::vector<std::vector<std::string>> kept; /* options point into arguments */
    r.result = options_read(static_cast<int>(arguments.size()), pointers.data(), r.out.get(), error,
                            sizeof error);
    r.error = error;
    kept.push_back(std::move(arguments));
    return r;
}

Read read_file(const std::string &text) {
    Read r;
    char error[OPTIONS_ERROR_SIZE] = "";
    r.result =
        options_read_text("fleet.ini", text.data(), text.size(), r.out.get(), error, sizeof error);
    r.error = error;
    return r;
}

std::string channel_of(const Read &r, int robot, enum channel which) {
    return r.out->robots[robot].channels.name[which];
}

std::string copied(const std::string &text, std::size_t capacity) {
    std::string room(capacity, 'x');
    text_copy(room.data(), capacity, reinterpret_cast<const std::uint8_t *>(text.data()),
              text.size());
    return room.c_str();
}

} // namespace

TEST(LcmOptions, OnlyWatchByDefault) {
    const Read r = read({});
    ASSERT_EQ(OPTIONS_RUN, r.result) << r.error;
    for (const bool enabled : r.out->robots[0].rules.enabled)
        EXPECT_FALSE(enabled);
    EXPECT_EQ(300000U, r.out->robots[0].rules.lease_us);
    EXPECT_EQ(200000U, r.out->robots[0].rules.max_age_us);
    EXPECT_STREQ("", r.out->lcm_url);
    EXPECT_EQ(1U, r.out->robot_count);
    EXPECT_STREQ(ROBUROC4_DEFAULT_HOST, r.out->robots[0].host);
    EXPECT_EQ("ROBUROC4_DIFFERENTIAL", channel_of(r, 0, CHANNEL_DIFFERENTIAL));
    EXPECT_EQ("ROBUROC4_BRIDGE_STATE", channel_of(r, 0, CHANNEL_BRIDGE_STATE));
    EXPECT_EQ("ROBUROC4_BRIDGE_STATISTICS", channel_of(r, 0, CHANNEL_BRIDGE_STATISTICS));
    EXPECT_EQ("ROBUROC4_DRIVE_CMD", channel_of(r, 0, CHANNEL_DRIVE_CMD));
    EXPECT_EQ("ROBUROC4_RELOCALIZE_CMD", channel_of(r, 0, CHANNEL_RELOCALIZE_CMD));
    EXPECT_EQ("ROBUROC4_OUTPUT_CMD", channel_of(r, 0, CHANNEL_OUTPUT_CMD));
    EXPECT_EQ("ROBUROC4_STOP_CMD", channel_of(r, 0, CHANNEL_STOP_CMD));
    EXPECT_EQ("", channel_of(r, 0, CHANNEL_POSE));
}

TEST(LcmOptions, RecordAllRobotsInOneFile) {
    EXPECT_STREQ("", read({}).out->record);
    EXPECT_STREQ("run.pcapng", read({"--record", "run.pcapng"}).out->record);
    const std::string folder = testing::TempDir();
    for (const std::string &path : {folder, folder + "run.pcapng"}) {
        const Read r = read_file("[DEFAULT]\nrecord = " + path + "\n[A]\naddress = a\n");
        EXPECT_EQ(OPTIONS_RUN, r.result) << r.error;
        EXPECT_EQ(path, r.out->record);
        EXPECT_EQ(OPTIONS_RUN, read({"--record", path}).result);
    }
}

TEST(LcmOptions, CeilingsAreThoseOfTheLibraryUnlessTheyAreGiven) {
    roburoc4_config usual;
    ASSERT_EQ(0, roburoc4_config_init(&usual, sizeof usual));
    EXPECT_EQ(usual.max_linear_m_s, read({}).out->robots[0].config.max_linear_m_s);
    EXPECT_EQ(usual.max_angular_rad_s, read({}).out->robots[0].config.max_angular_rad_s);
    const Read r = read({"--max-linear", "0.25", "--max-angular=10"});
    ASSERT_EQ(OPTIONS_RUN, r.result) << r.error;
    EXPECT_EQ(0.25F, r.out->robots[0].config.max_linear_m_s);
    EXPECT_EQ(10.0F, r.out->robots[0].config.max_angular_rad_s);
    const Read fleet = read_file("[DEFAULT]\nmax-linear = 0.5\n[A]\naddress = a\n"
                                 "[B]\naddress = b\nmax-linear = 2.5\nmax-angular = 0.001\n");
    ASSERT_EQ(OPTIONS_RUN, fleet.result) << fleet.error;
    EXPECT_EQ(0.5F, fleet.out->robots[0].config.max_linear_m_s);
    EXPECT_EQ(1.5F, fleet.out->robots[0].config.max_angular_rad_s);
    EXPECT_EQ(2.5F, fleet.out->robots[1].config.max_linear_m_s);
    for (const options_robot &robot : {fleet.out->robots[0], fleet.out->robots[1]})
        EXPECT_EQ(nullptr, roburoc4_config_error(&robot.config));
}

TEST(LcmOptions, EachEnablesItsOwnKind) {
    EXPECT_TRUE(read({"--enable-drive"}).out->robots[0].rules.enabled[GATE_DRIVE]);
    EXPECT_TRUE(read({"--enable-outputs"}).out->robots[0].rules.enabled[GATE_OUTPUT]);
    EXPECT_TRUE(read({"--enable-relocalize"}).out->robots[0].rules.enabled[GATE_RELOCALIZE]);
    EXPECT_FALSE(read({"--enable-outputs"}).out->robots[0].rules.enabled[GATE_DRIVE]);
}

TEST(LcmOptions, NameSeveralRobotsAndTheirChannels) {
    const Read r = read({"-r", "A=10.0.0.1", "--robot=B=10.0.0.2:6001", "--channel",
                         "B:DRIVE_CMD=GO_CMD", "--pose-channel", "A:POSE"});
    ASSERT_EQ(OPTIONS_RUN, r.result) << r.error;
    EXPECT_STREQ("10.0.0.2:6001", r.out->robots[1].host);
    EXPECT_EQ("A_DIFFERENTIAL", channel_of(r, 0, CHANNEL_DIFFERENTIAL));
    EXPECT_EQ("GO_CMD", channel_of(r, 1, CHANNEL_DRIVE_CMD));
    EXPECT_EQ("POSE", channel_of(r, 0, CHANNEL_POSE));
    EXPECT_EQ("", channel_of(r, 1, CHANNEL_POSE));
}

TEST(LcmOptions, AcceptValuesInEveryForm) {
    const Read r = read({"-p", "LAB", "-l", "udpm://", "--period-ms", "battery=0",
                         "--period-ms=iocard=10", "--lease-ms=20", "--max-age-ms", "0", "-q"});
    ASSERT_EQ(OPTIONS_RUN, r.result) << r.error;
    EXPECT_EQ("LAB_DRIVE_CMD", channel_of(r, 0, CHANNEL_DRIVE_CMD));
    EXPECT_STREQ("udpm://", r.out->lcm_url);
    EXPECT_EQ(0U, r.out->robots[0].config.subscriptions & 1U << ROBUROC4_SERVICE_BATTERY);
    EXPECT_EQ(10U, r.out->robots[0].config.period_ms[ROBUROC4_SERVICE_IOCARD]);
    EXPECT_EQ(20000U, r.out->robots[0].rules.lease_us);
    EXPECT_EQ(0U, r.out->robots[0].rules.max_age_us);
    EXPECT_EQ(LOG_ERROR, r.out->level);
    EXPECT_EQ(nullptr, roburoc4_config_error(&r.out->robots[0].config));
}

TEST(LcmOptions, RejectInvalidValuesAndNameThem) {
    const struct {
        std::vector<std::string> arguments;
        const char *named;
    } cases[] = {
        {{"--fly"}, "--fly"},
        {{"-x"}, "-x"},
        {{"stray"}, "stray"},
        {{"--robot"}, "--robot"},
        {{"-r", "a", "-r", "b"}, "each needs a name"},
        {{"-r", "A=a", "-r", "A=b"}, "already is a robot with this name"},
        {{"-r", "A=a", "-p", "B"}, "--prefix B"},
        {{"-r", "A.B=a"}, "A.B"},
        {{"-r", "=a"}, "name is missing"},
        {{"-p", std::string(46, 'p')}, "ppp"},
        {{"--period-ms", "battery"}, "battery"},
        {{"--period-ms", "battery=15"}, "battery=15"},
        {{"--period-ms", "battery=2560"}, "battery=2560"},
        {{"--period-ms", "batteries=10"}, "batteries=10"},
        {{"--period-ms", "battery=-10"}, "battery=-10"},
        {{"--lease-ms", "19"}, "19"},
        {{"--lease-ms", "1001"}, "1001"},
        {{"--lease-ms", "0.5"}, "0.5"},
        {{"--max-linear", "0"}, "--max-linear 0: give m/s, 0.001 to 5"},
        {{"--max-linear", "-1"}, "--max-linear -1: give"},
        {{"--max-linear", "5.001"}, "5.001"},
        {{"--max-linear", "1e-1"}, "1e-1"},
        {{"--max-linear", "nan"}, "nan"},
        {{"--max-linear", "0.5.1"}, "0.5.1"},
        {{"--max-linear", ""}, "--max-linear : give"},
        {{"--max-angular", "60"}, "--max-angular 60: give rad/s, 0.001 to 10"},
        {{"--record", ""}, "--record : no file can be made there"},
        {{"--record", "/no/such/folder/run.pcapng"}, "no file can be made there"},
        {{"--record", "/dev/null/run.pcapng"}, "no file can be made there"},
        {{"--record", "/no-such-folder/"}, "no file can be made there"},
        {{"--record", "run.csv"}, "ending in .pcapng"},
        {{"--record", "runs"}, "ending in .pcapng"},
        {{"-l", "udpm://239.255.76.67:7667?ttl=x"}, "ttl=0 (this machine) to ttl=255"},
        {{"-l", "udpm://239.255.76.67:7667?ttl=999"}, "ttl=0 (this machine) to ttl=255"},
        {{"-l", "udpm://239.255.76.67:7667?ttl="}, "ttl=0 (this machine) to ttl=255"},
        {{"-l", "udpm://?tttl=0"}, "after the ? give"},
        {{"-l", "udpm://?ttl=0&ttl=1"}, "after the ? give"},
        {{"-l", "udpm://?ttl=0&"}, "after the ? give"},
        {{"-l", "udpm://?ttl=0&ttl"}, "after the ? give"},
        {{"-l", "udpm://?"}, "after the ? give"},
        {{"--max-age-ms", "-1"}, "-1"},
        {{"--max-age-ms", "3600001"}, "3600001"},
        {{"--max-age-ms", "99999999999999999999"}, "9999"},
        {{"--channel", "DRIVE_CMD=GO"}, "_CMD"},
        {{"--channel", "BATTERY=X_CMD"}, "_CMD"},
        {{"--channel", "BATTERY=.*"}, ".*"},
        {{"--channel", "BATTERY"}, "BATTERY"},
        {{"--channel", "NOTHING=X"}, "NOTHING"},
        {{"--channel", "X:BATTERY=Y"}, "X:BATTERY"},
        {{"-r", "A=a", "-r", "B=b", "--channel", "BATTERY=X"}, "which robot"},
        {{"--channel", "BATTERY=ROBUROC4_IOCARD"}, "two channels"},
        {{"--pose-channel", "P_CMD"}, "P_CMD"},
        {{"--pose-channel", ""}, "--pose-channel"},
        {{"--enable-drive", "--period-ms", "iocard=0"}, "iocard"},
        {{"--enable-drive", "--period-ms", "differential=300"}, "differential"},
    };
    for (const auto &each : cases) {
        const Read r = read(each.arguments);
        EXPECT_EQ(OPTIONS_BAD, r.result) << each.named;
        EXPECT_NE(std::string::npos, r.error.find(each.named)) << r.error;
        EXPECT_LT(r.error.size() + 1, static_cast<std::size_t>(OPTIONS_ERROR_SIZE)) << r.error;
    }
}

TEST(LcmOptions, ARobotFileConfiguresTheClientAndABadOneNamesItsLine) {
    const std::string path = testing::TempDir() + "roburoc4_lcm_robot_file.txt";
    std::ofstream(path) << "override_index = 9\nrobot_watchdog_ms = 500\n";
    const Read good = read({"--robot-file", path});
    EXPECT_EQ(OPTIONS_RUN, good.result) << good.error;
    EXPECT_EQ(9, good.out->robots[0].config.role_index[ROBUROC4_ROLE_OVERRIDE]);
    EXPECT_EQ(500U, good.out->robots[0].config.robot_watchdog_ms);
    std::ofstream(path) << "override_index = 9\nwatchdog = 500\n";
    const Read bad = read({"--robot-file", path});
    EXPECT_EQ(OPTIONS_BAD, bad.result);
    EXPECT_NE(std::string::npos, bad.error.find("line 2: no such name")) << bad.error;
    EXPECT_EQ(OPTIONS_BAD, read({"--robot-file", path + ".missing"}).result);
    std::remove(path.c_str());
}

TEST(LcmOptions, FindTheRobotsAddresses) {
    char error[OPTIONS_ERROR_SIZE] = "";
    Read r = read({"-r", "A=127.0.0.1", "-r", "B=[::1]:6001"});
    ASSERT_EQ(OPTIONS_RUN, r.result) << r.error;
    ASSERT_EQ(OPTIONS_RUN, options_resolve(r.out.get(), error, sizeof error));
    EXPECT_EQ(ROBUROC4_DEFAULT_PORT, r.out->robots[0].address.port);
    EXPECT_EQ(6001, r.out->robots[1].address.port);
    for (const char *bad : {"host:99999", "host:0", "host:x", ""}) {
        r = read({"-r", bad});
        EXPECT_EQ(OPTIONS_BAD, options_resolve(r.out.get(), error, sizeof error)) << bad;
        EXPECT_NE(nullptr, std::strstr(error, "65535")) << error;
    }
    r = read({"-r", "no-such-robot.invalid"});
    EXPECT_EQ(OPTIONS_NO_ADDRESS, options_resolve(r.out.get(), error, sizeof error));
    EXPECT_NE(nullptr, std::strstr(error, "no-such-robot.invalid")) << error;
}

TEST(LcmOptions, AtMost1000Robots) {
    std::vector<std::string> arguments;
    for (int i = 0; i < OPTIONS_MAX_ROBOTS; i++)
        arguments.push_back("--robot=R" + std::to_string(i) + "=10.0.0.1");
    EXPECT_EQ(OPTIONS_RUN, read(arguments).result);
    arguments.push_back("--robot=TOO_MANY=10.0.0.1");
    EXPECT_EQ(OPTIONS_BAD, read(arguments).result);
}

TEST(LcmConfigFile, ConfiguresEachRobotSeparately) {
    const Read r = read_file("# the lab\n"
                             "[DEFAULT]\n"
                             "lcm-url = udpm://239.255.76.67:7667?ttl=1\n"
                             "period-ms.battery = 2000 ; slow\n"
                             "lease-ms = 200\n"
                             "\n"
                             "[RED]\n"
                             "address = 192.168.0.2\n"
                             "enable-drive = yes\n"
                             "max-age-ms = 50\n"
                             "channel.LOCALIZATION = ODOMETRY\n"
                             "pose-channel = POSE\n"
                             "[BLUE]\n"
                             "address = 192.168.0.3:6001\n"
                             "period-ms.telemeter = 0\n"
                             "lease-ms = 500\n");
    ASSERT_EQ(OPTIONS_RUN, r.result) << r.error;
    EXPECT_STREQ("udpm://239.255.76.67:7667?ttl=1", r.out->lcm_url);
    ASSERT_EQ(2U, r.out->robot_count);
    const options_robot &red = r.out->robots[0];
    const options_robot &blue = r.out->robots[1];
    EXPECT_STREQ("RED", red.name);
    EXPECT_STREQ("192.168.0.2", red.host);
    EXPECT_TRUE(red.rules.enabled[GATE_DRIVE]);
    EXPECT_EQ(200000U, red.rules.lease_us);
    EXPECT_EQ(50000U, red.rules.max_age_us);
    EXPECT_EQ(2000U, red.config.period_ms[ROBUROC4_SERVICE_BATTERY]);
    EXPECT_STREQ("ODOMETRY", red.channels.name[CHANNEL_LOCALIZATION]);
    EXPECT_STREQ("POSE", red.channels.name[CHANNEL_POSE]);
    EXPECT_FALSE(blue.rules.enabled[GATE_DRIVE]);
    EXPECT_EQ(500000U, blue.rules.lease_us);
    EXPECT_EQ(200000U, blue.rules.max_age_us);
    EXPECT_EQ(0U, blue.config.subscriptions >> ROBUROC4_SERVICE_TELEMETER & 1U);
    EXPECT_STREQ("BLUE_LOCALIZATION", blue.channels.name[CHANNEL_LOCALIZATION]);
    const channels_entry *found = channels_look_up(&r.out->directory, "BLUE_DRIVE_CMD");
    ASSERT_NE(nullptr, found);
    EXPECT_EQ(1U * CHANNELS + CHANNEL_DRIVE_CMD, found->which);
    EXPECT_EQ(nullptr, channels_look_up(&r.out->directory, "GREEN_DRIVE_CMD"));
}

TEST(LcmConfigFile, ErrorsNameTheLineAndTheRemedy) {
    const struct {
        const char *text, *error;
    } cases[] = {
        {"address = 10.0.0.1\n", "fleet.ini:1: a section such as"},
        {"[RED\n", "fleet.ini:1: a section's name ends with ]"},
        {"[RED]\nadress = 10.0.0.1\n", "fleet.ini:2: adress = 10.0.0.1: no such setting"},
        {"[RED]\nenable-drive\n", "fleet.ini:2: enable-drive: no such setting"},
        {"[RED]\naddress = 10.0.0.1\nenable-drive = true\n",
         "fleet.ini:3: enable-drive = true: give yes or no"},
        {"[RED]\nlease-ms = 5\n", "fleet.ini:2: lease-ms = 5: give milliseconds, 20 to 1000"},
        {"[RED]\nmax-linear = 300\n", "fleet.ini:2: max-linear = 300: give m/s, 0.001 to 5"},
        {"[RED]\naddress = a\nlease-ms = 200\n\nlease-ms = 300\n",
         "fleet.ini:5: lease-ms = 300: line 3 has it already; remove one of them"},
        {"[RED]\nperiod-ms.iocard = 50\nperiod-ms.battery = 500\nperiod-ms.iocard = 60\n",
         "fleet.ini:4: period-ms.iocard = 60: line 2 has it already"},
        {"[DEFAULT]\nlcm-url=udpm://\nlcm-url=udpm://\n", "fleet.ini:3: lcm-url = udpm://: line 2"},
        {"[DEFAULT]\nlease-ms=200\n[DEFAULT]\nlease-ms=300\n", "fleet.ini:3: [DEFAULT]: put"},
        {"[DEFAULT]\nlcm-url = udpm://?ttl=999\n",
         "fleet.ini:2: lcm-url = udpm://?ttl=999: after the ? give"},
        {"[DEFAULT]\nrecord = /no/such/folder/run.pcapng\n",
         "fleet.ini:2: record = /no/such/folder/run.pcapng: no file can be made there"},
        {"[RED]\nperiod-ms.lidar = 50\n", "fleet.ini:2: period-ms.lidar = 50: give SERVICE=MS"},
        {"[RED]\nchannel.STOP_CMD = HALT\n", "fleet.ini:2: channel.STOP_CMD = HALT: names of"},
        {"[RED]\nlcm-url = udpm://\n", "fleet.ini:2: lcm-url = udpm://: put it into [DEFAULT]"},
        {"[DEFAULT]\naddress = 10.0.0.1\n", "fleet.ini:2: address = 10.0.0.1: put it into"},
        {"[RED]\naddress = a\n[RED]\n",
         "fleet.ini:3: [RED]: there already is a robot with this name; give each its own"},
        {"[RED]\naddress = a\n[DEFAULT]\n", "fleet.ini:3: [DEFAULT]: put [DEFAULT], which"},
        {"[A B]\n", "fleet.ini:1: 'A B' cannot be the start"},
        {"[]\naddress = a\n", "fleet.ini:1: a section such as"},
        {"[RED]\naddress =\n", "fleet.ini:2: address = : give HOST"},
        {"[RED]\n\n[BLUE]\naddress = b\n", "fleet.ini:1: [RED]: address is missing"},
        {"[BLUE]\naddress=b\nenable-drive=yes\nperiod-ms.iocard=500\n",
         "fleet.ini:1: [BLUE]: enable-drive needs statuses"},
        {"[A]\naddress=a\n[B]\naddress=b\nchannel.BATTERY=A_BATTERY\n", "two channels are named"},
        {"# nothing\n", "fleet.ini: no robot"},
        {"[DEFAULT]\nlcm-url = tcpq://host\n[A]\naddress=a\n",
         "fleet.ini:2: lcm-url = tcpq://host: the bridge"},
    };
    for (const auto &each : cases) {
        const Read r = read_file(each.text);
        EXPECT_EQ(OPTIONS_BAD, r.result) << each.text;
        EXPECT_EQ(0U, r.error.find(each.error)) << r.error << "\n" << each.text;
    }
}

TEST(LcmConfigFile, SectionsMayGiveTheSameSettings) {
    const Read r = read_file("[DEFAULT]\nlease-ms = 200\n[A]\naddress = a\nlease-ms = 250\n"
                             "[B]\naddress = b\nlease-ms = 300\n");
    ASSERT_EQ(OPTIONS_RUN, r.result) << r.error;
    EXPECT_EQ(250000U, r.out->robots[0].rules.lease_us);
    EXPECT_EQ(300000U, r.out->robots[1].rules.lease_us);
}

TEST(LcmOptions, SendersAreAllowedByNameOrBeginning) {
    const auto allows = [](const std::string &patterns, const std::string &sender) {
        const Read r = read({"--allow-sender", patterns});
        EXPECT_EQ(OPTIONS_RUN, r.result) << r.error;
        return options_allows(&r.out->robots[0], sender.data(), sender.size());
    };
    EXPECT_TRUE(options_allows(&read({}).out->robots[0], "anybody", 7));
    for (const char *patterns :
         {"planner*, joystick", "joystick,planner*", " planner* joystick "}) {
        EXPECT_TRUE(allows(patterns, "planner"));
        EXPECT_TRUE(allows(patterns, "planner 17"));
        EXPECT_TRUE(allows(patterns, "joystick"));
        EXPECT_FALSE(allows(patterns, "joystick 2"));
        EXPECT_FALSE(allows(patterns, "plan"));
        EXPECT_FALSE(allows(patterns, "a planner"));
        EXPECT_FALSE(allows(patterns, ""));
    }
    EXPECT_TRUE(allows("*", "anybody"));
    const Read fleet = read_file("[DEFAULT]\nallow-sender = planner*\n[A]\naddress = a\n"
                                 "[B]\naddress = b\nallow-sender = joystick\n");
    ASSERT_EQ(OPTIONS_RUN, fleet.result) << fleet.error;
    EXPECT_TRUE(options_allows(&fleet.out->robots[0], "planner 1", 9));
    EXPECT_FALSE(options_allows(&fleet.out->robots[1], "planner 1", 9));
    for (const std::string &bad : {std::string(), std::string(" , "), std::string("a*b"),
                                   std::string("a,*b"), std::string(64, 'x')}) {
        const Read r = read({"--allow-sender", bad});
        EXPECT_EQ(OPTIONS_BAD, r.result) << bad;
        EXPECT_NE(std::string::npos, r.error.find("such as planner*")) << r.error;
    }
}

TEST(LcmOptions, OneChannelMayStopTheFleet) {
    EXPECT_STREQ("", read({}).out->fleet_stop);
    const Read r = read({"-r", "A=a", "-r", "B=b", "--fleet-stop", "ALL_STOP_CMD"});
    ASSERT_EQ(OPTIONS_RUN, r.result) << r.error;
    const channels_entry *found = channels_look_up(&r.out->directory, "ALL_STOP_CMD");
    ASSERT_NE(nullptr, found);
    EXPECT_EQ(OPTIONS_FLEET_STOP, found->which);
    EXPECT_STREQ("HALT_CMD",
                 read_file("[DEFAULT]\nfleet-stop = HALT_CMD\n[A]\naddress = a\n").out->fleet_stop);
    for (const char *bad : {"", "STOP", "A.*_CMD"})
        EXPECT_EQ(OPTIONS_BAD, read({"--fleet-stop", bad}).result) << bad;
    const Read doubled = read({"-r", "A=a", "--fleet-stop", "A_STOP_CMD"});
    EXPECT_NE(std::string::npos, doubled.error.find("two channels are named A_STOP_CMD"));
}

TEST(LcmOptions, ANameIsAsLongAsAPrefix) {
    EXPECT_EQ(OPTIONS_RUN, read({"-r", std::string(45, 'n') + "=a"}).result);
    EXPECT_EQ(OPTIONS_RUN, read({"-p", std::string(45, 'n')}).result);
    EXPECT_EQ(OPTIONS_BAD, read({"-r", std::string(46, 'n') + "=a"}).result);
    EXPECT_EQ(OPTIONS_BAD, read({"-p", std::string(46, 'n')}).result);
}

TEST(LcmOptions, LcmUrlsAreTakenAsLcmReadsThem) {
    for (const char *url : {"udpm://", "udpm://?ttl=0", "udpm://239.255.76.67?ttl=255", "memq://",
                            "udpm://239.255.76.67:7667?recv_buf_size=4194304&ttl=1"})
        EXPECT_EQ(OPTIONS_RUN, read({"-l", url}).result) << url;
}

TEST(LcmOptions, ANumberThatIsTooLongIsNoSmallerOne) {
    for (const char *ms : {"4294967596", "18446744073709551916"}) /* 300 and a power of 2 */
        EXPECT_EQ(OPTIONS_BAD, read({"--lease-ms", ms}).result) << ms;
}

TEST(LcmOptions, LcmUrlsNameAMulticastGroupAndAPort) {
    for (const char *url : {"udpm://224.0.0.1", "udpm://239.255.255.255:1", "udpm://?ttl=0"})
        EXPECT_EQ(OPTIONS_RUN, read({"--lcm-url", url}).result) << url;
    for (const char *url : {"udpm://223.255.255.255:7667", "udpm://240.0.0.1:7667",
                            "udpm://239.255.76.67:0", "udpm://239.255.76.67:"})
        EXPECT_EQ(OPTIONS_BAD, read({"--lcm-url", url}).result) << url;
}

TEST(LcmConfigFile, TheCommandLineTakesPrecedence) {
    const std::string path = testing::TempDir() + "fleet.ini";
    std::ofstream(path) << "[DEFAULT]\nlcm-url = memq://\nfleet-stop = FILE_CMD\nrecord = "
                        << testing::TempDir() << "file.pcapng\n[A]\naddress = 127.0.0.1\n";
    const Read file = read({"--config", path});
    ASSERT_EQ(OPTIONS_RUN, file.result) << file.error;
    EXPECT_STREQ("memq://", file.out->lcm_url);
    EXPECT_STREQ("FILE_CMD", file.out->fleet_stop);
    EXPECT_EQ(testing::TempDir() + "file.pcapng", file.out->record);
    const Read both = read({"--config", path, "--lcm-url", "udpm://239.1.1.1:1", "--fleet-stop",
                            "LINE_CMD", "--record", "line.pcapng"});
    ASSERT_EQ(OPTIONS_RUN, both.result) << both.error;
    EXPECT_STREQ("udpm://239.1.1.1:1", both.out->lcm_url);
    EXPECT_STREQ("LINE_CMD", both.out->fleet_stop);
    EXPECT_STREQ("line.pcapng", both.out->record);
    std::remove(path.c_str());
}

TEST(LcmConfigFile, ARobotMayHaveAServiceThatTheOthersLack) {
    const Read r = read_file("[DEFAULT]\nperiod-ms.battery = 0\n[A]\naddress = a\n"
                             "[B]\naddress = b\nperiod-ms.battery = 500\n");
    ASSERT_EQ(OPTIONS_RUN, r.result) << r.error;
    const auto battery = [&](int robot) {
        return r.out->robots[robot].config.subscriptions >> ROBUROC4_SERVICE_BATTERY & 1U;
    };
    EXPECT_EQ(0U, battery(0));
    EXPECT_EQ(1U, battery(1));
    EXPECT_EQ(500, r.out->robots[1].config.period_ms[ROBUROC4_SERVICE_BATTERY]);
}

TEST(LcmOptions, TwoRobotsMayShareAHostButNoAddress) {
    char error[OPTIONS_ERROR_SIZE] = "";
    const Read ports = read({"--robot", "A=127.0.0.1:1", "--robot", "B=127.0.0.1:2"});
    EXPECT_EQ(OPTIONS_RUN, options_resolve(ports.out.get(), error, sizeof error)) << error;
    const Read same = read({"--robot", "A=127.0.0.1:1", "--robot", "B=127.0.0.1:1"});
    EXPECT_EQ(OPTIONS_BAD, options_resolve(same.out.get(), error, sizeof error));
}

TEST(LcmConfigFile, CommandLineSetsNoRobotBesideIt) {
    const Read drive = read({"--config", "/dev/null", "--enable-drive"});
    EXPECT_EQ(OPTIONS_BAD, drive.result);
    EXPECT_EQ(0U, drive.error.find("--enable-drive: with --config")) << drive.error;
    EXPECT_EQ(OPTIONS_BAD, read({"--config", "/dev/null", "-r", "10.0.0.1"}).result);
    EXPECT_EQ(0U, read({"-c", "/no/such/file"}).error.find("--config /no/such/file: "));
}

TEST(LcmConfigFile, UnknownNameAffectsOneRobot) {
    const Read r =
        read_file("[RED]\naddress = no-such-robot.invalid\n[BLUE]\naddress = 10.0.0.1\n");
    char error[OPTIONS_ERROR_SIZE] = "";
    EXPECT_EQ(OPTIONS_NO_ADDRESS, options_resolve(r.out.get(), error, sizeof error));
    EXPECT_EQ(0, r.out->robots[0].address.family);
    EXPECT_EQ(4, r.out->robots[1].address.family);
}

TEST(LcmOptions, HelpAndVersionWinOverWhatFollows) {
    EXPECT_EQ(OPTIONS_HELP, read({"-h", "--fly"}).result);
    EXPECT_EQ(OPTIONS_VERSION, read({"--version"}).result);
}

TEST(LcmText, IsReadAsUtf8ElseAsLatin1) {
    EXPECT_EQ("Télémètre", copied("Télémètre", 64));
    EXPECT_EQ("Télémètre", copied("T\xE9l\xE9m\xE8tre", 64));
    EXPECT_EQ("cut", copied(std::string("cut\0here", 8), 64));
    EXPECT_EQ("", copied("", 1));
    EXPECT_EQ("", copied("x", 1));
}

TEST(LcmText, IsNeverCutWithinACharacter) {
    EXPECT_EQ("T", copied("Télémètre", 3));
    EXPECT_EQ("Té", copied("Télémètre", 4));
    EXPECT_EQ("T", copied("T\xE9", 3));
}

TEST(LcmText, DistinguishesUtf8FromLookalikes) {
    const struct {
        const char *text;
        bool good;
    } cases[] = {{"plain", true},
                 {"\xC3\xA9", true},
                 {"\xE2\x82\xAC", true},
                 {"\xF0\x9F\xA4\x96", true},
                 {"\xC3", false},
                 {"\xC0\xAF", false},
                 {"\xE0\x80\xAF", false},
                 {"\xED\xA0\x80", false},
                 {"\xF4\x90\x80\x80", false},
                 {"\xF0\x80\x80\xAF", false},
                 {"\xFF", false},
                 {"\xA9", false},
                 {"\xE2\x82", false},
                 {"\xE2\x28\xA1", false}};
    for (const auto &each : cases)
        EXPECT_EQ(each.good, text_is_utf8(reinterpret_cast<const std::uint8_t *>(each.text),
                                          std::strlen(each.text)));
    EXPECT_FALSE(text_is_utf8(reinterpret_cast<const std::uint8_t *>("a\0b"), 3));
}

TEST(LcmText, CannotControlTheTerminal) {
    char room[16];
    text_for_terminal(room, sizeof room, "a\x1B[2J\n\x7F", 7);
    EXPECT_STREQ("a?[2J??", room);
    text_for_terminal(room, sizeof room, "\xC2\x9BJ \xC3\xA9", 6);
    EXPECT_STREQ("??J \xC3\xA9", room) << "U+009B begins a command, too";
    text_for_terminal(room, 3, "abcdef", 6);
    EXPECT_STREQ("ab", room);
}
