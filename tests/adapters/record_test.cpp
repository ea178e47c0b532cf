/* SPDX-License-Identifier: MIT
 *
 * The flight recorder: the contents of its files, whatever happens to the disk and the process, and
 * that the robot's datagrams never wait for it. The pump's robot is on a loopback socket.
 */
#include "pcapng.h"
#include "pump_calls.h"
#include "sim_process.h"
#include "udp_robot.h"

#include "roburoc4_pump.h"
#include "roburoc4_record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

namespace {

using namespace test;
namespace fs = std::filesystem;

/* A folder that goes with the test. */
class Folder {
  public:
    Folder() {
        char name[] = "/tmp/roburoc4-record-XXXXXX";
        path_ = mkdtemp(name);
    }
    Folder(const Folder &) = delete;
    Folder &operator=(const Folder &) = delete;
    ~Folder() {
        fs::remove_all(path_);
    }
    std::string operator/(const std::string &name) const {
        return path_ + "/" + name;
    }
    const std::string &path() const {
        return path_;
    }
    std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto &entry : fs::directory_iterator(path_)) {
            names.push_back(entry.path().filename());
        }
        std::sort(names.begin(), names.end());
        return names;
    }

  private:
    std::string path_;
};

roburoc4_recorder_options options() {
    roburoc4_recorder_options options{};
    options.size = sizeof options;
    return options;
}

/* A client's socket connected to a socket of the test, without a client's own traffic: what is
 * received is a number that counts up. */
class Traffic {
  public:
    explicit Traffic(roburoc4_recorder *recorder) {
        roburoc4_address address = peer_.address();
        EXPECT_EQ(roburoc4_udp_open(&udp_, sizeof udp_, &address), ROBUROC4_OK);
        EXPECT_EQ(roburoc4_udp_record(&udp_, recorder), ROBUROC4_OK);
        roburoc4_client_init(&client_, sizeof client_, nullptr);
        sockaddr_in own{};
        socklen_t length = sizeof own;
        getsockname(static_cast<int>(roburoc4_udp_fd(&udp_)), reinterpret_cast<sockaddr *>(&own),
                    &length);
        own_ = own;
    }
    Traffic(const Traffic &) = delete;
    Traffic &operator=(const Traffic &) = delete;
    ~Traffic() {
        roburoc4_udp_close(&udp_);
    }
    void receive(size_t count) {
        for (size_t i = 0; i < count; i++) {
            peer_.send(own_, bytes_of(sent_++));
            const uint32_t before = udp_.counters[ROBUROC4_UDP_COUNT_RECEIVED];
            while (udp_.counters[ROBUROC4_UDP_COUNT_RECEIVED] == before) {
                roburoc4_udp_receive(&udp_, &client_, nullptr, nullptr);
            }
        }
    }
    static std::vector<uint8_t> bytes_of(uint32_t number) {
        return {0xFF,
                0x06,
                0x00,
                static_cast<uint8_t>(number),
                static_cast<uint8_t>(number >> 8),
                static_cast<uint8_t>(number >> 16)};
    }
    static uint32_t number_of(const RecordedDatagram &datagram) {
        return datagram.payload.at(3) | uint32_t{datagram.payload.at(4)} << 8 |
               uint32_t{datagram.payload.at(5)} << 16;
    }

  private:
    Socket peer_;
    roburoc4_udp udp_;
    roburoc4_client client_;
    sockaddr_in own_;
    uint32_t sent_ = 0;
};

TEST(Record, EveryDatagramOfBothDirectionsIsInTheFile) {
    Folder folder;
    UdpRobot robot;
    roburoc4_recorder_options wanted = options();
    wanted.robot = "lab 3";
    roburoc4_recorder *recorder =
        roburoc4_recorder_open((folder / "a.pcapng").c_str(), &wanted, nullptr);
    ASSERT_NE(recorder, nullptr);
    roburoc4_udp udp;
    roburoc4_client client;
    roburoc4_address address = robot.address();
    ASSERT_EQ(roburoc4_udp_open(&udp, sizeof udp, &address), ROBUROC4_OK);
    ASSERT_EQ(roburoc4_udp_record(&udp, recorder), ROBUROC4_OK);
    roburoc4_client_init(&client, sizeof client, nullptr);
    roburoc4_client_start(&client, roburoc4_udp_now_us());
    ASSERT_TRUE(eventually([&] {
        roburoc4_udp_wait(&udp, &client, 10000);
        return udp.counters[ROBUROC4_UDP_COUNT_RECEIVED] > 60;
    }));
    const uint32_t sent = udp.counters[ROBUROC4_UDP_COUNT_SENT];
    const uint32_t received = udp.counters[ROBUROC4_UDP_COUNT_RECEIVED];
    roburoc4_udp_close(&udp);
    roburoc4_recorder_state last;
    EXPECT_EQ(roburoc4_recorder_close(recorder, &last), ROBUROC4_OK);
    EXPECT_EQ(last.recorded, sent + received);
    EXPECT_EQ(last.bytes, fs::file_size(folder / "a.pcapng"));

    Capture capture = read_capture(folder / "a.pcapng");
    EXPECT_FALSE(capture.is_cut);
    EXPECT_EQ(capture.interface_name, "lab 3");
    EXPECT_TRUE(capture.has_statistics);
    EXPECT_EQ(capture.received, sent + received);
    EXPECT_EQ(capture.dropped, 0u);
    ASSERT_EQ(capture.datagrams.size(), sent + received);
    uint32_t outbound = 0;
    for (const RecordedDatagram &datagram : capture.datagrams) {
        EXPECT_TRUE(datagram.flags == 1 || datagram.flags == 2);
        EXPECT_EQ(datagram.flags == 2 ? datagram.to_port : datagram.from_port, robot.port());
        outbound += datagram.flags == 2;
    }
    EXPECT_EQ(outbound, sent);
    /* a request of the directory's properties */
    EXPECT_EQ(capture.datagrams[0].flags, 2u);
    EXPECT_EQ(capture.datagrams[0].payload.size(), 4u);
}

TEST(Record, AKilledProcessLeavesWhatItRecorded) {
    Folder folder;
    const pid_t child = fork();
    if (child == 0) {
        roburoc4_recorder *recorder =
            roburoc4_recorder_open((folder / "a").c_str(), nullptr, nullptr);
        Traffic traffic(recorder);
        traffic.receive(100);
        pause();
        _exit(1);
    }
    const bool complete = eventually([&] {
        return fs::exists(folder / "a") && fs::file_size(folder / "a") > 200 &&
               read_capture(folder / "a").datagrams.size() == 100;
    });
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    EXPECT_TRUE(complete);
    EXPECT_FALSE(read_capture(folder / "a").is_cut);
}

} // namespace
