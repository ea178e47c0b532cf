/* SPDX-License-Identifier: MIT
 *
 * The flight recorder on a disk in memory: what is in its files, when it gets there, and that
 * whoever sends and receives never waits for it.
 */
#include "pcapng.h"
#include "pump_calls.h"
#include "system.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>

extern "C" {
#include "record_internal.h"
}

namespace {

using namespace virtual_system;
using test::Capture;
using test::on_client;
using test::RecordedDatagram;

constexpr uint64_t kStatistics = 64;

class Record : public testing::Test {
  protected:
    Record() {
        begin();
        options_.size = sizeof options_;
        here_.family = there_.family = 4;
        here_.port = 4000;
        there_.port = 60000;
        here_.ip[0] = there_.ip[0] = 10;
        here_.ip[3] = 2;
        there_.ip[3] = 1;
    }
    ~Record() override {
        close();
        EXPECT_EQ(left(), 0);
        EXPECT_FALSE(sys.waited_with_lock);
    }
    roburoc4_recorder *open(const char *path = "run.pcapng") {
        recorder_ = roburoc4_recorder_open(path, &options_, nullptr);
        EXPECT_NE(recorder_, nullptr);
        return recorder_;
    }
    roburoc4_result close() {
        roburoc4_recorder *recorder = recorder_;
        recorder_ = nullptr;
        return roburoc4_recorder_close(recorder, &last_);
    }
    roburoc4_recorder_state state() const {
        roburoc4_recorder_state state;
        roburoc4_recorder_get_state(recorder_, &state);
        return state;
    }
    /* A datagram from the robot; its first bytes are a number that counts up. */
    void take(size_t size = 12) {
        Bytes bytes(size, 0xAB);
        for (size_t i = 0; i < 4 && i < size; i++) {
            bytes[i] = static_cast<uint8_t>(number_ >> 8 * i);
        }
        number_++;
        const uint64_t before_us = sys.now_us;
        roburoc4_recorder_take(recorder_, 1, &there_, &here_, bytes.data(), bytes.size());
        EXPECT_EQ(sys.now_us, before_us) << "recording never waits";
    }
    static uint32_t number_of(const RecordedDatagram &datagram) {
        return datagram.payload.at(0) | uint32_t{datagram.payload.at(1)} << 8 |
               uint32_t{datagram.payload.at(2)} << 16;
    }
    static Capture capture(const std::string &name = "run.pcapng") {
        return test::read_capture(sys.files.at(name));
    }
    static uint64_t size_of(const std::string &name = "run.pcapng") {
        return sys.files.at(name).size();
    }
    /* All numbers, except for the gaps that the file counts. */
    static void expect_gaps_are_counted(const Capture &capture) {
        uint64_t next = 0;
        for (const RecordedDatagram &datagram : capture.datagrams) {
            next += datagram.drop_count;
            EXPECT_EQ(number_of(datagram), next);
            next++;
        }
    }

    roburoc4_recorder_options options_{};
    roburoc4_recorder *recorder_ = nullptr;
    roburoc4_recorder_state last_{};
    roburoc4_address here_{}, there_{};
    uint32_t number_ = 0;
};

/* ----------------------------------------------------------------------------------- times --- */

TEST_F(Record, EachDatagramIsOnTheDiskAfter50Milliseconds) {
    open();
    for (int i = 0; i < 20; i++) {
        sleep_ms(static_cast<uint64_t>(i) * 13);
        const uint64_t size = size_of();
        take();
        sleep_ms(51);
        EXPECT_GT(size_of(), size) << i;
    }
    EXPECT_EQ(capture().datagrams.size(), 20u) << "also while the recording goes on";
    EXPECT_FALSE(capture().is_cut);
}

TEST_F(Record, ABufferThatIsHalfFullIsWrittenAtOnce) {
    options_.buffer_bytes = 4096;
    for (const uint64_t rest_us : {1000u, 0u}) { /* it waits for more, or not yet */
        sys.files.clear();
        open();
        take();
        if (rest_us > 0) {
            sleep_us(rest_us);
        }
        while (state().recorded * 80 < 2048) {
            take();
        }
        EXPECT_EQ(capture().datagrams.size(), 0u);
        sleep_us(1);
        EXPECT_GE(capture().datagrams.size(), 25u);
        close();
    }
}

TEST_F(Record, WithoutDatagramsItWritesNothingAndRests) {
    open();
    sleep_ms(1000);
    const size_t writes = sys.written_us.size();
    sleep_ms(60000);
    EXPECT_EQ(sys.written_us.size(), writes);
}

TEST_F(Record, EachDatagramHasItsTime) {
    open();
    for (uint64_t i = 0; i < 10; i++) {
        const uint64_t calendar_us = sys.calendar_us + sys.now_us;
        take();
        sleep_ms(60);
        EXPECT_EQ(capture().datagrams.at(i).calendar_us, calendar_us);
        EXPECT_EQ(capture().datagrams.at(i).flags, 1u);
    }
}

TEST_F(Record, CloseWritesWhatIsLeftAndTheStatistics) {
    open();
    const uint64_t begun_us = sys.calendar_us + sys.now_us;
    sleep_ms(3000);
    take();
    take();
    const uint64_t closed_us = sys.now_us;
    EXPECT_EQ(close(), ROBUROC4_OK);
    EXPECT_EQ(sys.now_us, closed_us) << "the disk takes no time";
    const Capture all = capture();
    EXPECT_EQ(all.datagrams.size(), 2u);
    EXPECT_TRUE(all.has_statistics);
    EXPECT_EQ(all.received, 2u);
    EXPECT_EQ(all.interface_name, "roburoc4");
    EXPECT_EQ(last_.recorded, 2u);
    EXPECT_EQ(last_.bytes, size_of());
    const Bytes &bytes = sys.files["run.pcapng"];
    const auto time_at = [&](size_t at) {
        uint64_t time = 0;
        for (const size_t i : {3U, 2U, 1U, 0U, 7U, 6U, 5U, 4U}) { /* the high half comes first */
            time = time << 8 | bytes[at + i];
        }
        return time;
    };
    EXPECT_EQ(time_at(bytes.size() - kStatistics + 12), sys.calendar_us + sys.now_us);
    EXPECT_EQ(time_at(bytes.size() - kStatistics + 24), begun_us);
    EXPECT_TRUE(std::all_of(&bytes[16], &bytes[24], [](uint8_t byte) { return byte == 0xFF; }))
        << "no length of the section";
    EXPECT_EQ(Bytes(&bytes[12], &bytes[16]), (Bytes{1, 0, 0, 0})) << "the format's version";
    const std::string program = "roburoc4 " + std::to_string(ROBUROC4_VERSION_MAJOR) + ".";
    EXPECT_TRUE(std::equal(program.begin(), program.end(), &bytes[28]));
}

/* ------------------------------------------------------------------------------- a full disk */

TEST_F(Record, WhatASlowDiskDropsIsCountedInTheFile) {
    options_.buffer_bytes = 4096;
    open();
    sys.disk_takes_us = 500 * kMs;
    for (int i = 0; i < 400; i++) {
        take();
        sleep_ms(5);
    }
    EXPECT_GT(state().dropped, 100u);
    sys.disk_takes_us = 0;
    sleep_ms(1000);
    take();
    EXPECT_EQ(close(), ROBUROC4_OK);
    const Capture all = capture();
    EXPECT_FALSE(all.is_cut);
    EXPECT_EQ(all.datagrams.size(), last_.recorded);
    EXPECT_EQ(all.drop_counts(), last_.dropped);
    EXPECT_EQ(all.dropped, last_.dropped);
    EXPECT_EQ(all.received, last_.dropped + last_.recorded);
    EXPECT_EQ(last_.dropped + last_.recorded, 401u);
    expect_gaps_are_counted(all);
}

TEST_F(Record, EachFileCountsWhatWasDroppedDuringIt) {
    options_.buffer_bytes = 4096;
    options_.max_file_bytes = 3000;
    open();
    for (const int count : {500, 20}) {
        for (int i = 0; i < count; i++)
            take();
        sleep_ms(1000);
    }
    EXPECT_EQ(close(), ROBUROC4_OK);
    uint64_t dropped = 0, datagrams = 0;
    for (const auto &[name, content] : sys.files) {
        const Capture one = capture(name);
        EXPECT_EQ(one.received, one.dropped + one.datagrams.size()) << name;
        dropped += one.dropped;
        datagrams += one.datagrams.size();
    }
    EXPECT_GT(sys.files.size(), 1u);
    EXPECT_EQ(dropped, last_.dropped);
    EXPECT_EQ(dropped + datagrams, 520u);
}

TEST_F(Record, ADatagramThatFitsIsWrittenWithTheGapBeforeItAndNothingBeyondTheBuffer) {
    options_.buffer_bytes = 4096;
    here_.family = there_.family = 6;
    for (size_t first = 0; first < 12; first++) {
        open(std::to_string(first).c_str());
        take(2900 + first);
        take(2900);
        EXPECT_EQ(state().dropped, 1u);
        for (size_t size = 1500; size >= 4 && state().recorded < 2; size--) {
            take(size);
        }
        const uint64_t dropped = state().dropped;
        sleep_ms(60);
        take(4000);
        take();
        EXPECT_EQ(close(), ROBUROC4_OK);
        const Capture all = capture(std::to_string(first));
        ASSERT_EQ(all.datagrams.size(), 3u);
        EXPECT_EQ(all.datagrams[1].drop_count, dropped);
        EXPECT_EQ(all.datagrams[2].drop_count, 1u);
    }
}

TEST_F(Record, ADiskThatHasRoomAgainIsWrittenToAgain) {
    options_.buffer_bytes = 4096;
    open();
    sys.disk_room = 1001; /* in the middle of a block */
    for (int i = 0; i < 20; i++) {
        take();
        sleep_ms(30);
    }
    EXPECT_EQ(state().system_error, ENOSPC);
    EXPECT_EQ(state().dropped, 0u) << "the buffers hold them";
    sys.disk_room = UINT64_MAX;
    sleep_ms(101); /* the pause before it tries again */
    EXPECT_EQ(state().system_error, 0);
    EXPECT_EQ(close(), ROBUROC4_OK);
    EXPECT_FALSE(capture().is_cut);
    EXPECT_EQ(capture().datagrams.size(), 20u);
    expect_gaps_are_counted(capture());
}

TEST_F(Record, AFileThatEndsOnAFullDiskGetsItsStatisticsOnceThereIsRoom) {
    options_.max_file_s = 1;
    open();
    take();
    sleep_ms(2000);
    sys.disk_room = 10;
    take();
    sleep_ms(1000);
    sys.disk_room = UINT64_MAX;
    sleep_ms(200);
    EXPECT_EQ(close(), ROBUROC4_OK);
    EXPECT_EQ(last_.files, 2u);
    EXPECT_EQ(capture("run.pcapng").received, 1u);
    EXPECT_EQ(capture("run.2.pcapng").received, 1u);
}

TEST_F(Record, AFullDiskIsNotTriedMoreThanTenTimesASecond) {
    open();
    sys.disk_room = 0;
    take();
    const int before = sys.writes;
    sleep_ms(10000);
    EXPECT_GE(sys.writes - before, 90);
    EXPECT_LE(sys.writes - before, 105);
    sys.disk_room = UINT64_MAX;
}

TEST_F(Record, ADiskThatStaysFullLeavesWholeBlocks) {
    options_.buffer_bytes = 4096;
    open();
    sys.disk_room = 1001;
    for (int i = 0; i < 100; i++) {
        take();
        sleep_ms(10);
    }
    const uint64_t closed_us = sys.now_us;
    EXPECT_EQ(close(), ROBUROC4_ERR_SYSTEM);
    EXPECT_EQ(sys.now_us, closed_us) << "it is not tried again";
    EXPECT_EQ(last_.system_error, ENOSPC);
    const Capture all = capture();
    EXPECT_FALSE(all.is_cut);
    EXPECT_GE(all.datagrams.size(), 10u);
    EXPECT_EQ(all.datagrams.size(), last_.recorded);
    EXPECT_EQ(last_.recorded + last_.dropped, 100u);
    expect_gaps_are_counted(all);
}

TEST_F(Record, NothingFollowsABlockThatIsNotWhole) {
    options_.buffer_bytes = 4096;
    sys.streams.insert("pipe");
    for (const char *name : {"run.pcapng", "pipe"}) {
        open(name);
        sys.disk_room = 1001;
        for (int i = 0; i < 60; i++) {
            take();
            sleep_ms(10);
        }
        const uint64_t size = size_of(name);
        sys.disk_takes_us = 10 * kMs;
        at(sys.now_us + 5 * kMs, [] { sys.disk_room = UINT64_MAX; }); /* for the last buffer */
        sys.disk_room = 0;
        EXPECT_EQ(close(), ROBUROC4_ERR_SYSTEM);
        EXPECT_LE(size_of(name), size);
        EXPECT_EQ(capture(name).is_cut, std::string(name) == "pipe");
        sys.disk_takes_us = 0;
        sleep_ms(10);
    }
}

TEST_F(Record, ADiskWithoutRoomForTheStatisticsLeavesWholeBlocks) {
    open();
    take();
    sleep_ms(100);
    sys.disk_room = 10;
    EXPECT_EQ(close(), ROBUROC4_ERR_SYSTEM);
    EXPECT_FALSE(capture().is_cut);
    EXPECT_EQ(capture().datagrams.size(), 1u);
}

TEST_F(Record, CloseOfOneThatRestsTakesNoTime) {
    open();
    take();
    sleep_ms(500);
    const uint64_t closed_us = sys.now_us;
    EXPECT_EQ(close(), ROBUROC4_OK);
    EXPECT_EQ(sys.now_us, closed_us);
}

TEST_F(Record, CloseWaitsTwoSecondsForADiskThatHangs) {
    open();
    sys.disk_hangs = true;
    take();
    sleep_ms(500);
    const uint64_t closed_us = sys.now_us;
    roburoc4_recorder *recorder = recorder_;
    EXPECT_EQ(close(), ROBUROC4_ERR_SYSTEM);
    EXPECT_GE(sys.now_us, closed_us + 2 * kSecond);
    EXPECT_LE(sys.now_us, closed_us + 2100 * kMs);
    EXPECT_EQ(last_.system_error, ETIMEDOUT);
    sys.disk_hangs = false;
    sleep_ms(1);
    recorder_ = recorder; /* to free it */
}

TEST_F(Record, ADiskThatTakesSevenBytesAtATimeGetsAll) {
    sys.largest_write = 7;
    open();
    for (int i = 0; i < 50; i++) {
        take(static_cast<size_t>(i) * 30);
    }
    EXPECT_EQ(close(), ROBUROC4_OK);
    EXPECT_FALSE(capture().is_cut);
    ASSERT_EQ(capture().datagrams.size(), 50u);
    for (size_t i = 0; i < 50; i++) {
        EXPECT_EQ(capture().datagrams[i].payload.size(), i * 30);
    }
}

TEST_F(Record, ZerosAreSentWhileTheDiskHangs) {
    options_.buffer_bytes = 4096;
    Robot robot;
    open();
    const roburoc4_address address = robot.address();
    roburoc4_pump *pump = roburoc4_pump_create(&address, nullptr, 0, recorder_, nullptr);
    ASSERT_EQ(roburoc4_pump_arm(pump, 10 * kSecond), ROBUROC4_OK);
    sys.disk_hangs = true;
    sleep_ms(2000);
    EXPECT_GT(state().dropped, 0u);
    ASSERT_EQ(on_client(pump, roburoc4_client_drive, 0.3f, 0.0f, 1000000u), ROBUROC4_OK);
    sleep_ms(200);
    const uint64_t asked_us = sys.now_us;
    EXPECT_EQ(on_client(pump, roburoc4_client_stop), ROBUROC4_OK);
    sleep_ms(1);
    EXPECT_EQ(robot.first_zero_us(), asked_us + sys.delay_us);
    roburoc4_pump_destroy(pump);
    sys.disk_hangs = false;
}

/* ------------------------------------------------------------------------------- rotation --- */

TEST_F(Record, AFileIsAsLongAsItMayBeAndNoLonger) {
    open();
    const uint64_t head = size_of();
    take();
    sleep_ms(60);
    const uint64_t packet = size_of() - head;
    close();
    for (const uint64_t less : {0u, 1u}) {
        const std::string name = less == 0 ? "fits.pcapng" : "over.pcapng";
        options_.max_file_bytes = head + 3 * packet + kStatistics - less;
        open(name.c_str());
        for (int i = 0; i < 12; i++) {
            take();
            sleep_ms(60);
        }
        EXPECT_EQ(close(), ROBUROC4_OK);
        for (const std::string &file : {name, name.substr(0, 5) + "2.pcapng"}) {
            EXPECT_EQ(capture(file).datagrams.size(), 3 - less);
            EXPECT_EQ(capture(file).received, 3 - less) << "of this file alone";
        }
        EXPECT_EQ(size_of(name), head + (3 - less) * packet + kStatistics);
        EXPECT_EQ(last_.files, less == 0 ? 4u : 6u);
        EXPECT_EQ(last_.path, name.substr(0, 5) + (less == 0 ? "4.pcapng" : "6.pcapng"));
    }
}

TEST_F(Record, TheNextFileBeginsWhenThisOneIsAsOldAsItMayBe) {
    options_.max_file_s = 10;
    open();
    const uint64_t begun_us = sys.now_us;
    sleep_ms(9900);
    take(); /* written after 9.95 s */
    sleep_us(begun_us + 9960 * kMs - sys.now_us);
    EXPECT_EQ(state().files, 1u);
    take(); /* written after 10.01 s */
    sleep_ms(60);
    EXPECT_EQ(state().files, 2u);
    sleep_ms(5000);
    take();
    sleep_ms(60);
    EXPECT_EQ(state().files, 2u) << "its own age";
    sleep_ms(60000);
    EXPECT_EQ(state().files, 2u) << "without datagrams no files";
    close();
    EXPECT_EQ(last_.files, 2u) << "nor does the end need one";
    EXPECT_EQ(capture("run.pcapng").datagrams.size(), 1u);
    EXPECT_EQ(capture("run.2.pcapng").datagrams.size(), 2u);
}

TEST_F(Record, NoFileIsEmpty) {
    options_.max_file_bytes = 1000;
    open();
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 40; k++) { /* more than a file may hold, at once */
            take();
        }
        sleep_ms(60);
    }
    close();
    EXPECT_EQ(last_.files, 3u);
    for (const auto &[name, bytes] : sys.files) {
        EXPECT_EQ(capture(name).datagrams.size(), 40u) << name;
    }
}

TEST_F(Record, WhereTheNextFileCannotBeginThisOneContinues) {
    options_.max_file_s = 1;
    open();
    take();
    sleep_ms(1500);
    sys.create_error = EACCES;
    take();
    sleep_ms(60);
    EXPECT_EQ(capture().datagrams.size(), 2u);
    sys.create_error = 0;
    take();
    sleep_ms(60);
    EXPECT_EQ(state().files, 2u);
}

TEST_F(Record, AStreamIsNeitherRotatedNorCut) {
    sys.streams.insert("pipe");
    sys.files["pipe"];
    options_.max_file_bytes = 600;
    options_.max_file_s = 1;
    open("pipe");
    for (int i = 0; i < 40; i++) {
        take();
        sleep_ms(60);
    }
    sys.disk_room = 10;
    take();
    sleep_ms(60);
    const uint64_t size = size_of("pipe");
    EXPECT_EQ(close(), ROBUROC4_ERR_SYSTEM);
    EXPECT_EQ(size_of("pipe"), size);
    EXPECT_EQ(last_.files, 1u);
}

/* ----------------------------------------------------------------------------------- names --- */

TEST_F(Record, WhatExistsIsNotOverwritten) {
    sys.files["run.pcapng"] = sys.files["v1.0/run"] = sys.files["v1.0\\run"] =
        sys.files["my.run.pcapng"] = {1, 2, 3};
    EXPECT_STREQ((open(), state().path), "run.2.pcapng");
    close();
    EXPECT_STREQ((open(), state().path), "run.3.pcapng");
    close();
    EXPECT_STREQ((open("v1.0/run"), state().path), "v1.0/run.2");
    close();
    EXPECT_STREQ((open("my.run.pcapng"), state().path), "my.run.2.pcapng");
    close();
    EXPECT_STREQ((open("v1.0\\run"), state().path), "v1.0\\run.2");
    close();
    EXPECT_EQ(size_of(), 3u);
}

TEST_F(Record, ANameThatIsTooLongIsRefused) {
    const std::string longest(ROBUROC4_RECORDER_PATH_SIZE - 1, 'a');
    EXPECT_EQ((open(longest.c_str()), state().path), longest);
    close();
    const std::string folder = longest.substr(32); /* with its file's name it is too long */
    const std::string second = longest.substr(33); /* with its second file's */
    sys.folders = {folder, second};
    sys.files[second + "/roburoc4-20260102T030406Z.pcapng"];
    for (const std::string &name : {longest, folder, second}) {
        EXPECT_EQ(roburoc4_recorder_open(name.c_str(), &options_, nullptr), nullptr);
        EXPECT_EQ(errno, ENAMETOOLONG);
    }
    roburoc4_result result = 0;
    EXPECT_EQ(roburoc4_recorder_open((longest + 'a').c_str(), &options_, &result), nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_ARGUMENT);
}

TEST_F(Record, AFolderGetsAFileNamedAfterTheTime) {
    sys.folders.insert("/data");
    EXPECT_STREQ((open("/data"), state().path), "/data/roburoc4-20260102T030406Z.pcapng");
}

TEST_F(Record, WhatCannotBeginLeavesNothingBehind) {
    roburoc4_result result = 0;
    const auto fails = [&](int error) {
        const uint64_t before_us = sys.now_us;
        errno = 0;
        EXPECT_EQ(roburoc4_recorder_open("run.pcapng", &options_, &result), nullptr);
        EXPECT_EQ(result, ROBUROC4_ERR_SYSTEM);
        EXPECT_EQ(errno, error);
        EXPECT_EQ(sys.now_us, before_us);
        EXPECT_EQ(left(), 0);
    };
    sys.create_error = EACCES;
    fails(EACCES);
    EXPECT_EQ(sys.creates, 1);
    sys.create_error = 0;
    sys.disk_room = 10;
    fails(ENOSPC);
    sys.disk_room = UINT64_MAX;
    sys.thread_fails = true;
    fails(EAGAIN);
    sys.thread_fails = false;
    for (bool *failure : {&sys.lock_fails, &sys.signal_fails}) {
        *failure = true;
        fails(0);
        *failure = false;
    }
    for (const int allocations : {0, 1, 2}) {
        sys.allocations = allocations;
        fails(ENOMEM);
    }
    for (const char *name : {static_cast<const char *>(nullptr), ""}) {
        EXPECT_EQ(roburoc4_recorder_open(name, nullptr, &result), nullptr);
        EXPECT_EQ(result, ROBUROC4_ERR_ARGUMENT);
    }
    options_.buffer_bytes = 4095;
    EXPECT_EQ(roburoc4_recorder_open("run.pcapng", &options_, &result), nullptr);
    EXPECT_EQ(result, ROBUROC4_ERR_ARGUMENT);
    for (const size_t size : {size_t{8}, sizeof options_ - 4, sizeof options_ + 4}) {
        options_.size = static_cast<uint32_t>(size);
        EXPECT_EQ(roburoc4_recorder_open("run.pcapng", &options_, &result), nullptr);
        EXPECT_EQ(result, ROBUROC4_ERR_SIZE);
    }
    EXPECT_EQ(roburoc4_recorder_close(nullptr, nullptr), ROBUROC4_OK);
}

TEST_F(Record, NeedsNoOptions) {
    recorder_ = roburoc4_recorder_open("run.pcapng", nullptr, nullptr);
    ASSERT_NE(recorder_, nullptr);
    take();
    EXPECT_EQ(roburoc4_recorder_finish(recorder_), 1);
    take();
    EXPECT_EQ(state().recorded, 1u) << "what came after the end is not";
    EXPECT_EQ(roburoc4_recorder_close(recorder_, nullptr), ROBUROC4_OK);
    recorder_ = nullptr;
    EXPECT_EQ(capture().datagrams.size(), 1u);
}

TEST_F(Record, ALongNameOfTheRobotIsCut) {
    const std::string name(1000, 'r');
    options_.robot = name.c_str();
    open();
    close();
    EXPECT_EQ(capture().interface_name, name.substr(0, 255));
}

/* -------------------------------------------------------------------------------- checksums */

/* The one's complement sum of the 16-bit words. */
uint32_t sum_of(const Bytes &bytes, size_t from) {
    uint32_t sum = 0;
    for (size_t i = from; i < bytes.size(); i++) {
        sum += (i - from) % 2 == 0 ? uint32_t{bytes[i]} << 8 : bytes[i];
    }
    return sum;
}

uint32_t folded(uint32_t sum) {
    while (sum > 0xFFFF) {
        sum = (sum & 0xFFFF) + (sum >> 16);
    }
    return sum;
}

TEST_F(Record, EveryChecksumHoldsAndNoneOfIPv6IsZero) {
    for (const uint8_t family : {uint8_t{4}, uint8_t{6}}) {
        SCOPED_TRACE(int{family});
        here_.family = there_.family = family;
        for (size_t i = 0; i < 16; i++) {
            here_.ip[i] = static_cast<uint8_t>(17 * i + 1);
            there_.ip[i] = static_cast<uint8_t>(29 * i + 3);
        }
        const std::string name = family == 4 ? "four" : "six";
        options_.buffer_bytes = 16 << 20;
        open(name.c_str());
        for (uint32_t i = 0; i <= 0xFFFF; i++) { /* each sum that there is */
            const uint8_t bytes[] = {static_cast<uint8_t>(i >> 8), static_cast<uint8_t>(i), 0xEE};
            roburoc4_recorder_take(recorder_, 1, &there_, &here_, bytes, i % 3 == 0 ? 3 : 2);
        }
        close();
        const size_t header = family == 4 ? 20 : 40, ips = family == 4 ? 12 : 8;
        uint32_t full = 0;
        for (const RecordedDatagram &datagram : capture(name).datagrams) {
            const Bytes &ip = datagram.ip;
            const Bytes addresses(ip.begin() + static_cast<std::ptrdiff_t>(ips),
                                  ip.begin() + static_cast<std::ptrdiff_t>(header));
            const auto half = static_cast<std::ptrdiff_t>(addresses.size() / 2);
            ASSERT_TRUE(std::equal(there_.ip, there_.ip + half, addresses.begin()));
            ASSERT_TRUE(std::equal(here_.ip, here_.ip + half, addresses.begin() + half));
            if (family == 4) {
                ASSERT_EQ(folded(sum_of(Bytes(ip.begin(), ip.begin() + 20), 0)), 0xFFFFu);
                ASSERT_EQ(ip[9], 17);
            } else {
                ASSERT_EQ(ip[6], 17);
                ASSERT_EQ(size_t{ip[4]} << 8 | ip[5], ip.size() - 40);
            }
            const uint32_t checksum = uint32_t{ip[header + 6]} << 8 | ip[header + 7];
            if (family == 4) {
                ASSERT_EQ(checksum, 0u);
                continue;
            }
            ASSERT_NE(checksum, 0u) << "which IPv6 does not allow";
            full += checksum == 0xFFFF;
            ASSERT_EQ(folded(sum_of(addresses, 0) + 17 + static_cast<uint32_t>(ip.size() - header) +
                             sum_of(ip, header)),
                      0xFFFFu);
        }
        EXPECT_EQ(full > 0, family == 6) << "sums whose complement is 0";
    }
}

/* -------------------------------------------------------------------------- exit() and fork() */

TEST_F(Record, ExitCompletesTheFileOfAllPumpsThatShareIt) {
    for (const bool first_is_slow : {false, true}) {
        begin();
        Robot first, second(60001);
        open();
        std::vector<roburoc4_pump *> pumps;
        for (const Robot *robot : {&first, &second}) {
            const roburoc4_address address = robot->address();
            pumps.push_back(roburoc4_pump_create(&address, nullptr, 0, recorder_, nullptr));
            ASSERT_EQ(roburoc4_pump_arm(pumps.back(), 10 * kSecond), ROBUROC4_OK);
            ASSERT_EQ(on_client(pumps.back(), roburoc4_client_drive, 0.3f, 0.0f, 1000000u),
                      ROBUROC4_OK);
        }
        sleep_ms(100);
        (first_is_slow ? first : second).silent = true; /* its stop takes longer */
        run_exit_handlers();
        const Capture all = capture();
        EXPECT_TRUE(all.has_statistics);
        for (const Robot *robot : {&first, &second}) {
            const Bytes zero{0xFF, 6, 0, 0, 0, 0, 0, 0, 0, 0, 0};
            const auto zeros = std::count_if(
                all.datagrams.begin(), all.datagrams.end(), [&](const RecordedDatagram &datagram) {
                    return datagram.to_port == robot->port() && datagram.payload == zero;
                });
            EXPECT_EQ(static_cast<size_t>(zeros), robot->zeros_at_the_end());
            EXPECT_GE(zeros, 3);
        }
        for (const RecordedDatagram &datagram : all.datagrams) {
            EXPECT_GT(datagram.flags == 2 ? datagram.from_port : datagram.to_port, 40000)
                << "this end's port";
        }
        EXPECT_EQ(all.datagrams[0].flags, 2u) << "complete from the first request";
        EXPECT_EQ(all.datagrams[0].payload.size(), 4u);
        for (roburoc4_pump *pump : pumps) {
            roburoc4_pump_destroy(pump);
        }
        close();
    }
}

TEST_F(Record, ExitCompletesTheFileOfEachPump) {
    Robot first, second(60001);
    std::vector<std::pair<roburoc4_recorder *, roburoc4_pump *>> opened;
    for (const Robot *robot : {&first, &second}) {
        const roburoc4_address address = robot->address();
        const std::string path = std::to_string(robot->port());
        roburoc4_recorder *recorder = roburoc4_recorder_open(path.c_str(), &options_, nullptr);
        opened.emplace_back(recorder,
                            roburoc4_pump_create(&address, nullptr, 0, recorder, nullptr));
    }
    sleep_ms(100);
    run_exit_handlers();
    for (const Robot *robot : {&first, &second}) {
        EXPECT_TRUE(capture(std::to_string(robot->port())).has_statistics) << robot->port();
    }
    for (const auto &[recorder, pump] : opened) {
        roburoc4_pump_destroy(pump);
        EXPECT_EQ(roburoc4_recorder_close(recorder, nullptr), ROBUROC4_OK);
    }
}

TEST_F(Record, AForkedChildRecordsNothing) {
    open();
    take();
    in_child([&] {
        take();
        roburoc4_recorder_state state;
        roburoc4_recorder_get_state(recorder_, &state);
        EXPECT_EQ(state.recorded, 0u);
        EXPECT_EQ(roburoc4_recorder_finish(recorder_), 1);
    });
    EXPECT_EQ(sys.parents_locks_taken, 0);
    EXPECT_EQ(close(), ROBUROC4_OK);
    EXPECT_EQ(capture().datagrams.size(), 1u);
}

} // namespace
