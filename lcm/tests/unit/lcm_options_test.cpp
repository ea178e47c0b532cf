/* SPDX-License-Identifier: MIT
 *
 * The LCM bridge's command line and its texts.
 */
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "../lcm/network.h" /* sim/ has one, too */
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

/* What --check prints. */
std::string printed(const Read &r) {
    testing::internal::CaptureStdout();
    options_print(r.out.get());
    std::fflush(stdout);
    return testing::internal::GetCapturedStdout();
}

std::string copied(const std::string &text, std::size_t capacity) {
    std::string room(capacity, 'x');
    text_copy(room.data(), capacity, reinterpret_cast<const std::uint8_t *>(text.data()),
              text.size());
    return room.c_str();
}

} // namespace

TEST(LcmOptions, CheckPrintsWhatWouldRun) {
    unsetenv("LCM_DEFAULT_URL");
    const struct {
        const char *arguments, *file, *printed;
    } cases[] = {{"", "", R"(network: LCM's default
robot: NO ADDRESS (192.168.0.2)
    obeys stop only; at most 1 m/s and 1.5 rad/s; lease at most 250 ms, commands at most 200 ms old
    statuses: iocard 50 ms telemeter 100 ms battery 1000 ms localization 50 ms differential 50 ms
    stop by ROBUROC4_STOP_CMD, state on ROBUROC4_BRIDGE_STATE
)"},
                 {"-p LAB -l udpm:// --period-ms battery=0 --period-ms=iocard=10 --enable-drive "
                  "--period-ms telemeter=2550 --lease-ms=20 --max-age-ms 0 --enable-outputs "
                  "--max-linear-m-s 0.25 --max-angular-rad-s=10 --allow-sender planner*,joystick "
                  "--fleet-stop ALL_STOP_CMD --channel STOP_CMD=HALT_CMD",
                  "", R"(network: udpm://
all robots are stopped by ALL_STOP_CMD
robot: NO ADDRESS (192.168.0.2)
    obeys stop, drive, outputs; at most 0.25 m/s and 10 rad/s; lease at most 20 ms, commands at most 0 ms old (ANY AGE)
    statuses: iocard 10 ms telemeter 2550 ms battery none localization 50 ms differential 50 ms
    only from senders planner*,joystick
    stop by HALT_CMD, drive by LAB_DRIVE_CMD, state on LAB_BRIDGE_STATE
    channel HALT_CMD instead of LAB_STOP_CMD
)"},
                 {"-r A=10.0.0.1 --robot=B=10.0.0.2:6001 --channel B:DRIVE_CMD=GO_CMD "
                  "--pose-channel A:POSE --enable-relocalize",
                  "", R"(network: LCM's default
A: NO ADDRESS (10.0.0.1)
    obeys stop, relocalize; at most 1 m/s and 1.5 rad/s; lease at most 250 ms, commands at most 200 ms old
    statuses: iocard 50 ms telemeter 100 ms battery 1000 ms localization 50 ms differential 50 ms
    stop by A_STOP_CMD, state on A_BRIDGE_STATE
    channel POSE
B: NO ADDRESS (10.0.0.2:6001)
    obeys stop, relocalize; at most 1 m/s and 1.5 rad/s; lease at most 250 ms, commands at most 200 ms old
    statuses: iocard 50 ms telemeter 100 ms battery 1000 ms localization 50 ms differential 50 ms
    stop by B_STOP_CMD, state on B_BRIDGE_STATE
    channel GO_CMD instead of B_DRIVE_CMD
)"},
                 {"", R"(# the lab
[DEFAULT]
lcm-url = udpm://239.255.76.67:7667?ttl=1
fleet-stop = HALT_CMD
period-ms.battery = 0 ; none
lease-ms = 200
max-linear-m-s = 0.5
enable-outputs = yes
allow-sender = planner*

[RED]
address = 192.168.0.2
enable-drive = yes
max-age-ms = 50
channel.LOCALIZATION = ODOMETRY
pose-channel = POSE
[BLUE]
address = 192.168.0.3:6001
enable-outputs = no
period-ms.battery = 500
lease-ms = 500
max-linear-m-s = 2.5
max-angular-rad-s = 0.001
allow-sender = joystick
)",
                  R"(network: udpm://239.255.76.67:7667?ttl=1
all robots are stopped by HALT_CMD
RED: NO ADDRESS (192.168.0.2)
    obeys stop, drive, outputs; at most 0.5 m/s and 1.5 rad/s; lease at most 200 ms, commands at most 50 ms old
    statuses: iocard 50 ms telemeter 100 ms battery none localization 50 ms differential 50 ms
    only from senders planner*
    stop by RED_STOP_CMD, drive by RED_DRIVE_CMD, state on RED_BRIDGE_STATE
    channel ODOMETRY instead of RED_LOCALIZATION
    channel POSE
BLUE: NO ADDRESS (192.168.0.3:6001)
    obeys stop only; at most 2.5 m/s and 0.001 rad/s; lease at most 500 ms, commands at most 200 ms old
    statuses: iocard 50 ms telemeter 100 ms battery 500 ms localization 50 ms differential 50 ms
    only from senders joystick
    stop by BLUE_STOP_CMD, state on BLUE_BRIDGE_STATE
)"}};
    for (const auto &each : cases) {
        std::istringstream words(each.arguments);
        const Read r = each.file[0] == '\0' ? read({std::istream_iterator<std::string>(words), {}})
                                            : read_file(each.file);
        ASSERT_EQ(OPTIONS_RUN, r.result) << r.error;
        EXPECT_EQ(each.printed, printed(r));
        for (uint32_t at = 0; at < r.out->robot_count; at++)
            EXPECT_EQ(nullptr, roburoc4_config_error(&r.out->robots[at].config));
    }
}

TEST(LcmOptions, WithoutAUrlLcmsOwnVariableHolds) {
    setenv("LCM_DEFAULT_URL", "tcpq://host", 1);
    EXPECT_EQ(0U, read({}).error.find("LCM_DEFAULT_URL tcpq://host: the bridge has no such"));
    EXPECT_EQ(OPTIONS_RUN, read({"-l", "memq://"}).result);
    EXPECT_EQ(0U, read({"-l", "tcpq://host"}).error.find("--lcm-url tcpq://host: the bridge"));
    setenv("LCM_DEFAULT_URL", "udpm://?ttl=1", 1);
    EXPECT_EQ(0U, printed(read({})).find("network: udpm://?ttl=1\n"));
    unsetenv("LCM_DEFAULT_URL");
}

TEST(LcmOptions, TheNetworksPortIsLcmsUnlessTheUrlHasOne) {
    EXPECT_EQ(7667, network_port(""));
    EXPECT_EQ(7667, network_port("udpm://239.255.76.67?ttl=1"));
    EXPECT_EQ(65535, network_port("udpm://239.255.76.67:65535?ttl=1"));
    EXPECT_EQ(0, network_port("memq://")) << "none";
}

TEST(LcmOptions, RecordAllRobotsInOneFile) {
    EXPECT_STREQ("", read({}).out->record);
    EXPECT_STREQ("run.pcapng", read({"--record", "run.pcapng"}).out->record);
    const std::string folder = testing::TempDir(), existing = folder + "exists.pcapng";
    std::ofstream(existing) << "kept";
    for (const std::string &path : {folder, folder + "run.pcapng", existing}) {
        const Read r = read_file("[DEFAULT]\nrecord = " + path + "\n[A]\naddress = a\n");
        EXPECT_EQ(OPTIONS_RUN, r.result) << r.error;
        EXPECT_EQ(path, r.out->record);
        EXPECT_EQ(OPTIONS_RUN, read({"--record", path}).result);
    }
    std::remove(existing.c_str());
    const std::string closed = folder + "roburoc4_lcm_closed";
    mkdir(closed.c_str(), 0500);
    for (const std::string &place : {std::string("/"), closed + "/"}) {
        const auto expected = access(place.c_str(), W_OK) == 0 ? OPTIONS_RUN : OPTIONS_BAD;
        EXPECT_EQ(expected, read({"--record", place}).result) << place;
        EXPECT_EQ(expected, read({"--record", place + "run.pcapng"}).result) << place;
    }
    rmdir(closed.c_str());
}

TEST(LcmOptions, RejectInvalidValuesAndNameThem) {
    const struct {
        std::vector<std::string> arguments;
        const char *named;
    } cases[] = {
        {{"--fly"}, "--fly"},
        {{"-vx"}, "unknown option '-x'"},
        {{"--quiet=1"}, "no value is allowed for '--quiet=1'"},
        {{"stray"}, "stray"},
        {{"--robot"}, "a value is missing after '--robot'"},
        {{"-r"}, "a value is missing after '-r'"},
        {{"-r", std::string(256, 'h')}, "at most 255 letters"},
        {{"-r", "a", "-r", "b"}, "each needs a name"},
        {{"-r", "A=a", "-r", "A=b"}, "already is a robot with this name"},
        {{"-r", "A=a", "-p", "B"}, "--prefix B"},
        {{"-r", "A.B=a"}, "A.B"},
        {{"-r", "=a"}, "name is missing"},
        {{"-r", "A="}, "--robot A=: the address is missing"},
        {{"-r", ""}, "--robot : the address is missing"},
        {{"--robot-file", "/"}, "--robot-file /: cannot be read"},
        {{"-r", std::string(46, 'n') + "=a"}, "nnn"},
        {{"-p", std::string(46, 'p')}, "ppp"},
        {{"--period-ms", "battery"}, "battery"},
        {{"--period-ms", "battery=15"}, "battery=15"},
        {{"--period-ms", "battery=2560"}, "battery=2560"},
        {{"--period-ms", "batteries=10"}, "batteries=10"},
        {{"--period-ms", "battery=-10"}, "battery=-10"},
        {{"--lease-ms", "19"}, "19"},
        {{"--lease-ms", "1001"}, "1001"},
        {{"--lease-ms", "300x"}, "300x"},
        {{"--lease-ms", "4294967596"}, "4294967596"}, /* 300 and a power of 2 */
        {{"--lease-ms", "18446744073709551916"}, "18446744073709551916"},
        {{"--max-linear-m-s", "0"}, "--max-linear-m-s 0: give m/s, 0.001 to 5"},
        {{"--max-linear-m-s", "5.001"}, "5.001"},
        {{"--max-linear-m-s", "nan"}, "nan"},
        {{"--max-linear-m-s", "0.5.1"}, "0.5.1"},
        {{"--max-linear-m-s", ""}, "--max-linear-m-s : give"},
        {{"--max-angular-rad-s", "60"}, "--max-angular-rad-s 60: give rad/s, 0.001 to 10"},
        {{"--record", ""}, "--record : no file can be made there"},
        {{"--record", "/no/such/folder/run.pcapng"}, "no file can be made there"},
        {{"--record", "run.csv"}, "ending in .pcapng"},
        {{"--record", "runs"}, "ending in .pcapng"},
        {{"--record", std::string(249, 'r') + ".pcapng"}, "at most 255 letters"},
        {{"-l", "udpm://223.255.255.255:7667"}, "no such LCM network"},
        {{"-l", "udpm://240.0.0.1:7667"}, "no such LCM network"},
        {{"-l", "udpm://239.255.76"}, "no such LCM network"},
        {{"-l", "udpm://239:255.76.67"}, "no such LCM network"},
        {{"-l", "udpm://239.255.76.67/7667"}, "no such LCM network"},
        {{"-l", "udpm://239.255.76.67:0"}, "no such LCM network"},
        {{"-l", "udpm://239.255.76.67:"}, "no such LCM network"},
        {{"-l", "udpm://239.255.76.67:65536"}, "no such LCM network"},
        {{"-l", "udpm://239.255.76.67:7667?ttl=x"}, "ttl=0 (this machine) to ttl=255"},
        {{"-l", "udpm://239.255.76.67:7667?ttl=256"}, "ttl=0 (this machine) to ttl=255"},
        {{"-l", "udpm://239.255.76.67:7667?ttl="}, "ttl=0 (this machine) to ttl=255"},
        {{"-l", "udpm://?tttl=0"}, "after the ? give"},
        {{"-l", "udpm://?other_setting=0"}, "after the ? give"},
        {{"-l", "udpm://?ttl=0&ttl=1"}, "after the ? give"},
        {{"-l", "udpm://?ttl=0xrecv_buf_size=1"}, "after the ? give"},
        {{"-l", "udpm://?recv_buf_size=1000000000"}, "after the ? give"},
        {{"-l", "udpm://?ttl=0&"}, "after the ? give"},
        {{"-l", "udpm://?ttl=0&ttl"}, "after the ? give"},
        {{"-l", "udpm://?"}, "after the ? give"},
        {{"--max-age-ms", "3600001"}, "3600001"},
        {{"--fleet-stop", ""}, "--fleet-stop : give 1 to 63"},
        {{"--fleet-stop", "STOP"}, "--fleet-stop STOP: give 1 to 63"},
        {{"--fleet-stop", "A.*_CMD"}, "A.*_CMD: give 1 to 63"},
        {{"-r", "A=a", "--fleet-stop", "A_STOP_CMD"}, "two channels are named A_STOP_CMD"},
        {{"--channel", "DRIVE_CMD=GO"}, "_CMD"},
        {{"--channel", "BATTERY=X_CMD"}, "_CMD"},
        {{"--channel", "BATTERY=.*"}, ".*"},
        {{"--channel", "BATTERY"}, "BATTERY"},
        {{"--channel", "NOTHING=X"}, "NOTHING"},
        {{"--channel", "BATTERY=" + std::string(64, 'n')}, "CHANNEL has 1 to 63"},
        {{"--channel", "X:BATTERY=Y"}, "X:BATTERY"},
        {{"--channel", ":BATTERY=Y"}, "no --robot has the name before the colon"},
        {{"--pose-channel", "X:POSE"}, "no --robot has the name before the colon"},
        {{"-r", "A=a", "-r", "B=b", "--channel", "BATTERY=X"}, "which robot"},
        {{"--channel", "BATTERY=ROBUROC4_IOCARD"}, "two channels"},
        {{"--pose-channel", "P_CMD"}, "P_CMD"},
        {{"--pose-channel", ""}, "--pose-channel"},
        {{"--enable-drive", "--period-ms", "iocard=0"}, "--enable-drive needs statuses of iocard"},
        {{"--enable-drive", "--period-ms", "differential=300"}, "differential"},
    };
    for (const auto &each : cases) {
        const Read r = read(each.arguments);
        EXPECT_EQ(OPTIONS_BAD, r.result) << each.named;
        const std::size_t at = r.error.find(each.named);
        ASSERT_NE(std::string::npos, at) << r.error;
        EXPECT_EQ(0, std::isdigit(r.error[at + std::strlen(each.named)])) << r.error;
        EXPECT_LT(r.error.size() + 1, static_cast<std::size_t>(OPTIONS_ERROR_SIZE)) << r.error;
    }
}

TEST(LcmOptions, EachChannelMayHaveAnotherName) {
    const char *const keys[] = {"DIFFERENTIAL", "LOCALIZATION",      "BATTERY",      "TELEMETER",
                                "IOCARD",       "PROPERTIES",        "BRIDGE_STATE", "MOVE_STATUS",
                                "STOP_CMD",     "BRIDGE_STATISTICS", "DRIVE_CMD",    "MOVE_CMD",
                                "OUTPUT_CMD",   "RELOCALIZE_CMD"};
    for (const std::string key : keys) {
        const std::string name = "OTHER_" + key;
        const Read r = read({"-r", "A=a", "--channel", key + "=" + name});
        ASSERT_EQ(OPTIONS_RUN, r.result) << r.error;
        const std::string line = "    channel " + name + " instead of A_" + key + "\n";
        const std::string all = printed(r);
        const std::size_t at = all.find(line);
        EXPECT_NE(std::string::npos, at) << all;
        EXPECT_EQ(at, all.find("    channel ")) << "and no other";
    }
}

TEST(LcmOptions, TheHelpNamesThemAll) {
    for (const std::string name :
         {"robot",        "config",       "check",          "lcm-url",           "record",
          "prefix",       "channel",      "pose-channel",   "period-ms",         "robot-file",
          "allow-sender", "fleet-stop",   "max-linear-m-s", "max-angular-rad-s", "lease-ms",
          "max-age-ms",   "enable-drive", "enable-outputs", "enable-relocalize", "verbose",
          "quiet",        "help",         "version"}) {
        const Read r = read({"--" + name});
        EXPECT_EQ(std::string::npos, r.error.find("unknown option")) << name;
        EXPECT_NE(nullptr, std::strstr(options_help, ("--" + name).c_str())) << name;
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
    std::ofstream(path) << std::string(24000, '#') << "\noverride_index = 9\n";
    EXPECT_EQ(
        9, read({"--robot-file", path}).out->robots[0].config.role_index[ROBUROC4_ROLE_OVERRIDE]);
    std::ofstream(path) << std::string(25000, '\n') << "override_index = 9\n";
    const Read large = read({"--robot-file", path});
    EXPECT_EQ(OPTIONS_BAD, large.result);
    EXPECT_NE(std::string::npos, large.error.find("longer than 24 kB")) << large.error;
    std::ofstream(path) << "override_index = 9\n";
    const Read fleet = read_file("[A]\naddress = a\nrobot-file = " + path + "\n[B]\naddress = b\n");
    ASSERT_EQ(OPTIONS_RUN, fleet.result) << fleet.error;
    EXPECT_EQ(9, fleet.out->robots[0].config.role_index[ROBUROC4_ROLE_OVERRIDE]);
    EXPECT_NE(9, fleet.out->robots[1].config.role_index[ROBUROC4_ROLE_OVERRIDE]);
    std::remove(path.c_str());
}

TEST(LcmOptions, FindTheRobotsAddresses) {
    char error[OPTIONS_ERROR_SIZE] = "";
    Read r = read({"-r", "A=127.0.0.1", "-r", "B=[::1]:6001"});
    ASSERT_EQ(OPTIONS_RUN, r.result) << r.error;
    ASSERT_EQ(OPTIONS_RUN, options_resolve(r.out.get(), error, sizeof error));
    EXPECT_NE(std::string::npos, printed(r).find("A: 127.0.0.1:60000 (127.0.0.1)\n"));
    EXPECT_NE(std::string::npos, printed(r).find("B: [::1]:6001 ([::1]:6001)\n"));
    for (const char *bad : {"host:99999", "host:0", "host:x"}) {
        r = read({"-r", bad});
        EXPECT_EQ(OPTIONS_BAD, options_resolve(r.out.get(), error, sizeof error)) << bad;
        EXPECT_NE(nullptr, std::strstr(error, "65535")) << error;
    }
    r = read({"-r", "A=host:0", "-r", "B=no-such-robot.invalid"});
    EXPECT_EQ(OPTIONS_BAD, options_resolve(r.out.get(), error, sizeof error)) << "the worst";
    r = read({"-r", "A=no-such-robot.invalid", "-r", "B=127.0.0.1"});
    EXPECT_EQ(OPTIONS_NO_ADDRESS, options_resolve(r.out.get(), error, sizeof error));
    EXPECT_NE(nullptr, std::strstr(error, "no-such-robot.invalid")) << error;
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
        {"[RED]\nmax-linear-m-s = 300\n",
         "fleet.ini:2: max-linear-m-s = 300: give m/s, 0.001 to 5"},
        {"[RED]\naddress = a\nlease-ms = 200\n\nlease-ms = 300\n",
         "fleet.ini:5: lease-ms = 300: line 3 has it already; remove one of them"},
        {"[RED]\nperiod-ms.iocard = 50\nperiod-ms.battery = 500\nperiod-ms.iocard = 60\n",
         "fleet.ini:4: period-ms.iocard = 60: line 2 has it already"},
        {"[DEFAULT]\nlease-ms=200\n[DEFAULT]\nlease-ms=300\n", "fleet.ini:3: [DEFAULT]: put"},
        {"[DEFAULT]\nlcm-url = udpm://?ttl=999\n",
         "fleet.ini:2: lcm-url = udpm://?ttl=999: after the ? give"},
        {"[DEFAULT]\nrecord = /no/such/folder/run.pcapng\n",
         "fleet.ini:2: record = /no/such/folder/run.pcapng: no file can be made there"},
        {"[RED]\nperiod-ms.lidar = 50\n", "fleet.ini:2: period-ms.lidar = 50: give SERVICE=MS"},
        {"[RED]\nlcm-url = udpm://\n", "fleet.ini:2: lcm-url = udpm://: put it into [DEFAULT]"},
        {"[DEFAULT]\naddress = 10.0.0.1\n", "fleet.ini:2: address = 10.0.0.1: put it into"},
        {"[RED]\naddress = a\n[RED]\n",
         "fleet.ini:3: [RED]: there already is a robot with this name; give each its own"},
        {"[RED]\naddress = a\n[DEFAULT]\n", "fleet.ini:3: [DEFAULT]: put [DEFAULT], which"},
        {"[A B]\n", "fleet.ini:1: 'A B' cannot be the start"},
        {"[]\naddress = a\n", "fleet.ini:1: a section such as"},
        {"[RED]\n= 10.0.0.1\n", "fleet.ini:2:  = 10.0.0.1: no such setting"},
        {"[RED]\n\n[BLUE]\naddress = b\n", "fleet.ini:1: [RED]: address is missing"},
        {"[BLUE]\naddress = b\n[RED]\n[GREEN]\naddress = g\n",
         "fleet.ini:3: [RED]: address is missing"},
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
    for (const std::string &bad : {std::string(), std::string(" , "), std::string("a*b"),
                                   std::string("a,*b"), std::string(64, 'x')}) {
        const Read r = read({"--allow-sender", bad});
        EXPECT_EQ(OPTIONS_BAD, r.result) << bad;
        EXPECT_NE(std::string::npos, r.error.find("such as planner*")) << r.error;
    }
}

TEST(LcmOptions, OneChannelMayStopTheFleet) {
    const Read r = read({"-r", "A=a", "-r", "B=b", "--fleet-stop", "ALL_STOP_CMD"});
    ASSERT_EQ(OPTIONS_RUN, r.result) << r.error;
    const channels_entry *found = channels_look_up(&r.out->directory, "ALL_STOP_CMD");
    ASSERT_NE(nullptr, found);
    EXPECT_EQ(OPTIONS_FLEET_STOP, found->which);
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

TEST(LcmOptions, ANameHasAtMost45Letters) {
    const std::string longest(45, 'A');
    EXPECT_EQ(OPTIONS_RUN, read({"--robot", longest + "=127.0.0.1"}).result);
    EXPECT_EQ(OPTIONS_RUN, read({"--prefix", longest}).result);
    EXPECT_EQ(OPTIONS_BAD, read({"--robot", longest + "A=127.0.0.1"}).result);
    EXPECT_EQ(OPTIONS_BAD, read({"--prefix", longest + "A"}).result);
}

TEST(LcmOptions, TwoRobotsMayShareAHostButNoAddress) {
    char error[OPTIONS_ERROR_SIZE] = "";
    const Read ports = read({"--robot", "A=127.0.0.1:1", "--robot", "B=127.0.0.1:2"});
    EXPECT_EQ(OPTIONS_RUN, options_resolve(ports.out.get(), error, sizeof error)) << error;
    const Read same = read({"--robot", "A=127.0.0.1:1", "--robot", "B=127.0.0.1:1"});
    EXPECT_EQ(OPTIONS_BAD, options_resolve(same.out.get(), error, sizeof error));
    const Read hosts = read({"--robot", "A=127.0.0.1:1", "--robot", "B=127.0.0.2:1", "--robot",
                             "C=[fd00:1::2]:1", "--robot", "D=[fd00:1::3]:1"});
    EXPECT_EQ(OPTIONS_RUN, options_resolve(hosts.out.get(), error, sizeof error)) << error;
    const Read links = read({"--robot", "A=[fe80::1%1]:1", "--robot", "B=[fe80::1%2]:1"});
    EXPECT_EQ(OPTIONS_RUN, options_resolve(links.out.get(), error, sizeof error)) << error;
}

TEST(LcmConfigFile, CommandLineSetsNoRobotBesideIt) {
    const Read drive = read({"--config", "/dev/null", "--enable-drive"});
    EXPECT_EQ(OPTIONS_BAD, drive.result);
    EXPECT_EQ(0U, drive.error.find("--enable-drive: with --config")) << drive.error;
    EXPECT_EQ(OPTIONS_BAD, read({"--config", "/dev/null", "-r", "10.0.0.1"}).result);
    EXPECT_EQ(0U, read({"-c", "/dev/null", "-p", "A"}).error.find("--prefix: with --config"));
    EXPECT_EQ(0U, read({"-c", "/no/such/file"}).error.find("--config /no/such/file: "));
    for (const std::string path : {"/dev/zero", "/"})
        EXPECT_EQ(0U, read({"-c", path}).error.find("--config " + path + ": give a text file"));
}

TEST(LcmOptions, HelpAndVersionWinOverWhatFollows) {
    EXPECT_EQ(OPTIONS_HELP, read({"-h", "--fly"}).result);
    EXPECT_EQ(OPTIONS_VERSION, read({"--version"}).result);
}

TEST(LcmText, IsReadAsUtf8ElseAsLatin1) {
    EXPECT_EQ("Télémètre", copied("Télémètre", 64));
    EXPECT_EQ("Télémètre", copied("T\xE9l\xE9m\xE8tre", 64));
    EXPECT_EQ("\xC2\x80", copied("\x80", 64));
    EXPECT_EQ("cut", copied(std::string("cut\0here", 8), 64));
    EXPECT_EQ("", copied("", 1));
    EXPECT_EQ("", copied("x", 1));
}

TEST(LcmText, IsNeverCutWithinACharacter) {
    EXPECT_EQ("T", copied("Télémètre", 3));
    EXPECT_EQ("Té", copied("Télémètre", 4));
    EXPECT_EQ("T", copied("T\xE9", 3));
}

TEST(LcmText, EndsWhereItsLengthSays) {
    const std::uint8_t text[] = {'a', 0xC3, 0xA9};
    EXPECT_TRUE(text_is_utf8(text, 3));
    EXPECT_FALSE(text_is_utf8(text, 2)) << "what follows is no part of it";
}

TEST(LcmText, DistinguishesUtf8FromLookalikes) {
    const struct {
        const char *text;
        bool good;
    } cases[] = {{"plain", true},
                 {"\xC3\xA9", true},
                 {"\xE2\x82\xAC", true},
                 {"\xF0\x9F\xA4\x96", true},
                 {"\xF0\x90\x80\x80", true},
                 {"\xE0\xA0\x80", true},
                 {"\xED\x9F\xBF", true},
                 {"\xF4\x8F\xBF\xBF", true},
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
    text_for_terminal(room, sizeof room, "a\xC2\x9BJ \xC3\xA9", 7);
    EXPECT_STREQ("a??J \xC3\xA9", room) << "U+009B begins a command, too";
    text_for_terminal(room, 3, "abcdef", 6);
    EXPECT_STREQ("ab", room);
    text_for_terminal(room, sizeof room, "\xC2\xA9 a\0b", 6);
    EXPECT_STREQ("\xC2\xA9 a", room);
}
