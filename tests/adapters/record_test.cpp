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

roburoc4_recorder_state state_of(roburoc4_recorder *recorder) {
    roburoc4_recorder_state state;
    roburoc4_recorder_get_state(recorder, &state);
    return state;
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
            while (roburoc4_udp_receive_one(&udp_, &client_, nullptr, nullptr) ==
                   ROBUROC4_UDP_NOTHING) {
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

TEST(Record, WhatExistsIsNotOverwritten) {
    Folder folder;
    roburoc4_recorder *recorders[3];
    for (roburoc4_recorder *&recorder : recorders) {
        recorder = roburoc4_recorder_open((folder / "run.pcapng").c_str(), nullptr, nullptr);
        ASSERT_NE(recorder, nullptr);
    }
    EXPECT_EQ(state_of(recorders[2]).path, folder / "run.3.pcapng");
    for (roburoc4_recorder *recorder : recorders) {
        EXPECT_EQ(roburoc4_recorder_close(recorder, nullptr), ROBUROC4_OK);
    }
    EXPECT_EQ(folder.files(),
              (std::vector<std::string>{"run.2.pcapng", "run.3.pcapng", "run.pcapng"}));
}

TEST(Record, AFolderGetsAFileNamedAfterTheTime) {
    Folder folder;
    roburoc4_recorder *recorder = roburoc4_recorder_open(folder.path().c_str(), nullptr, nullptr);
    ASSERT_NE(recorder, nullptr);
    EXPECT_EQ(roburoc4_recorder_close(recorder, nullptr), ROBUROC4_OK);
    ASSERT_EQ(folder.files().size(), 1u);
    EXPECT_EQ(folder.files()[0].rfind("roburoc4-20", 0), 0u);
    EXPECT_EQ(folder.files()[0].size(), std::string("roburoc4-20260102T030405Z.pcapng").size());
}

TEST(Record, WhatCannotBeOpenedIsAnError) {
    Folder folder;
    roburoc4_result result = 0;
    EXPECT_EQ(roburoc4_recorder_open((folder / "none/run.pcapng").c_str(), nullptr, &result),
              nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_SYSTEM);
    EXPECT_EQ(errno, ENOENT);
    EXPECT_EQ(roburoc4_recorder_open("/dev/full", nullptr, &result), nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_SYSTEM);
    EXPECT_EQ(errno, ENOSPC);
    EXPECT_EQ(roburoc4_recorder_open("", nullptr, &result), nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_ARGUMENT);
    EXPECT_EQ(roburoc4_recorder_open(std::string(2000, 'a').c_str(), nullptr, &result), nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_ARGUMENT);
    roburoc4_recorder_options wanted = options();
    wanted.buffer_bytes = 100;
    EXPECT_EQ(roburoc4_recorder_open((folder / "a").c_str(), &wanted, &result), nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_ARGUMENT);
    for (const std::size_t size :
         {std::size_t{1}, std::size_t{8}, sizeof wanted - 4, sizeof wanted + 4}) {
        wanted.size = static_cast<uint32_t>(size);
        EXPECT_EQ(roburoc4_recorder_open((folder / "a").c_str(), &wanted, &result), nullptr);
        EXPECT_EQ(result, ROBUROC4_ERR_SIZE);
    }
    EXPECT_TRUE(folder.files().empty());
    EXPECT_EQ(roburoc4_recorder_close(nullptr, nullptr), ROBUROC4_OK);
}

/* A pipe that is not read until a test wants it. */
class Pipe {
  public:
    explicit Pipe(const Folder &folder) : path_(folder / "pipe.pcapng") {
        EXPECT_EQ(mkfifo(path_.c_str(), 0600), 0);
        fd_ = open(path_.c_str(), O_RDONLY | O_NONBLOCK);
        EXPECT_GE(fd_, 0);
    }
    Pipe(const Pipe &) = delete;
    Pipe &operator=(const Pipe &) = delete;
    ~Pipe() {
        close(fd_);
    }
    const std::string &path() const {
        return path_;
    }
    void fill() {
        const int fd = open(path_.c_str(), O_WRONLY | O_NONBLOCK);
        while (write(fd, "", 1) == 1) {
        }
        close(fd);
    }
    /* Its current contents are appended to the file. */
    void drain_to(const std::string &file) {
        std::vector<char> bytes(1 << 16);
        std::ofstream out(file, std::ios::binary | std::ios::app);
        ssize_t got;
        while ((got = read(fd_, bytes.data(), bytes.size())) > 0) {
            out.write(bytes.data(), got);
        }
    }

  private:
    std::string path_;
    int fd_;
};

/* Limits the file size for this process: a full disk for one thread. */
class FileLimit {
  public:
    explicit FileLimit(rlim_t bytes) {
        getrlimit(RLIMIT_FSIZE, &before_);
        rlimit limit = before_;
        limit.rlim_cur = bytes;
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    FileLimit(const FileLimit &) = delete;
    FileLimit &operator=(const FileLimit &) = delete;
    ~FileLimit() {
        lift();
    }
    void lift() {
        setrlimit(RLIMIT_FSIZE, &before_);
    }

  private:
    rlimit before_;
};

roburoc4_recorder *open_small(const std::string &path) {
    roburoc4_recorder_options wanted = options();
    wanted.buffer_bytes = 4096;
    return roburoc4_recorder_open(path.c_str(), &wanted, nullptr);
}

/* All numbers, except for the gaps that the file counts. */
void expect_gaps_are_counted(const Capture &capture) {
    uint64_t next = 0;
    for (const RecordedDatagram &datagram : capture.datagrams) {
        next += datagram.drop_count;
        EXPECT_EQ(Traffic::number_of(datagram), next);
        next++;
    }
}

TEST(Record, WhatASlowDiskDropsIsCountedInTheFile) {
    Folder folder;
    Pipe pipe(folder);
    roburoc4_recorder *recorder = open_small(pipe.path());
    ASSERT_NE(recorder, nullptr);
    {
        Traffic traffic(recorder);
        traffic.receive(3000); /* 80 bytes each; a pipe holds 64 KiB */
        EXPECT_GT(state_of(recorder).dropped, 1000u);
        ASSERT_TRUE(eventually([&] {
            pipe.drain_to(folder / "file");
            const uint64_t dropped = state_of(recorder).dropped;
            traffic.receive(1);
            return state_of(recorder).dropped == dropped;
        }));
    }
    roburoc4_recorder_state last;
    EXPECT_EQ(roburoc4_recorder_close(recorder, &last), ROBUROC4_OK);
    pipe.drain_to(folder / "file");
    Capture capture = read_capture(folder / "file");
    EXPECT_FALSE(capture.is_cut);
    EXPECT_EQ(capture.datagrams.size(), last.recorded);
    EXPECT_EQ(capture.drop_counts(), last.dropped);
    EXPECT_EQ(capture.dropped, last.dropped);
    EXPECT_EQ(capture.received, last.dropped + last.recorded);
    expect_gaps_are_counted(capture);
}

TEST(Record, ADiskThatStaysFullLeavesWholeBlocks) {
    Folder folder;
    roburoc4_recorder *recorder = open_small(folder / "a");
    ASSERT_NE(recorder, nullptr);
    FileLimit limit(10001);
    Traffic traffic(recorder);
    uint64_t sent = 0;
    ASSERT_TRUE(eventually([&] {
        traffic.receive(10);
        sent += 10;
        return state_of(recorder).system_error == EFBIG;
    }));
    roburoc4_recorder_state last;
    EXPECT_EQ(roburoc4_recorder_close(recorder, &last), ROBUROC4_ERR_SYSTEM);
    EXPECT_EQ(last.system_error, EFBIG);
    Capture capture = read_capture(folder / "a");
    EXPECT_FALSE(capture.is_cut);
    EXPECT_GT(capture.datagrams.size(), 100u);
    EXPECT_EQ(capture.datagrams.size(), last.recorded);
    EXPECT_EQ(last.recorded + last.dropped, sent);
    expect_gaps_are_counted(capture);
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

TEST(Record, ExitCompletesTheFile) {
    Folder folder;
    UdpRobot robot;
    const std::string address = "127.0.0.1:" + std::to_string(robot.port());
    const std::string program = beside_this_program("exit_in_mid_drive");
    const std::string file = folder / "a";
    const pid_t child = fork();
    if (child == 0) {
        setenv("TSAN_OPTIONS", "report_thread_leaks=0", 1); /* exit() leaves threads */
        execl(program.c_str(), program.c_str(), address.c_str(), file.c_str(), nullptr);
        _exit(127);
    }
    waitpid(child, nullptr, 0);
    Capture capture = read_capture(folder / "a");
    EXPECT_TRUE(capture.has_statistics);
    std::vector<RecordedDatagram> commands;
    for (const RecordedDatagram &datagram : capture.datagrams) {
        if (datagram.flags == 2 && datagram.payload[0] == 0xFF) {
            commands.push_back(datagram);
        }
    }
    ASSERT_GE(commands.size(), 4u); /* a speed and three zeros */
    EXPECT_EQ(commands.back().payload, (std::vector<uint8_t>{0xFF, 6, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
}

} // namespace
