/* SPDX-License-Identifier: MIT
 *
 * The UDP adapter on a network whose every failure happens exactly when it is wanted.
 */
#include "pcapng.h"
#include "system.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

extern "C" {
#include "os.h"
}

namespace {

using virtual_system::sys;

class Faults : public testing::Test {
  protected:
    void SetUp() override {
        roburoc4_udp_close(&udp_);
        virtual_system::begin();
        sys.closed_ports_refuse = false; /* nobody is there, and says so */
        ASSERT_EQ(roburoc4_client_init(&client_, sizeof client_, nullptr), ROBUROC4_OK);
        ASSERT_EQ(roburoc4_client_start(&client_, sys.now_us), ROBUROC4_OK);
        address_.family = 4;
        address_.port = 60000;
    }
    void TearDown() override {
        roburoc4_udp_close(&udp_);
    }
    void open() {
        ASSERT_EQ(roburoc4_udp_open(&udp_, sizeof udp_, &address_), ROBUROC4_OK);
    }
    uint32_t count(uint32_t counter) const {
        return udp_.counters[counter];
    }
    /* Lets the client's time pass; every wait ends at its deadline. */
    void live(uint64_t us) {
        uint64_t until_us = sys.now_us + us;
        while (sys.now_us < until_us) {
            ASSERT_GE(roburoc4_udp_wait(&udp_, &client_, 1000000), 0);
        }
    }

    roburoc4_udp udp_{};
    roburoc4_client client_{};
    roburoc4_address address_{};
};

TEST_F(Faults, AnUnreachableNetworkAtOpenIsAStateNotAnError) {
    sys.connect_fault = ROBUROC4_FAULT_UNREACHABLE;
    open();
    EXPECT_EQ(udp_.fault, uint32_t{ROBUROC4_FAULT_UNREACHABLE});
    EXPECT_EQ(udp_.system_error, 1000 + ROBUROC4_FAULT_UNREACHABLE);
    live(10000000);
    EXPECT_EQ(sys.waited_on, ROBUROC4_OS_NO_SOCKET);
    EXPECT_TRUE(sys.sent.empty());
    EXPECT_EQ(sys.receive_calls, 0) << "before it is connected, anybody could be heard";
    EXPECT_GE(count(ROBUROC4_UDP_COUNT_DROPPED), 5u);

    sys.connect_fault = ROBUROC4_FAULT_NONE;
    live(3000000);
    EXPECT_FALSE(sys.sent.empty());
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_RECONNECTS), 1u);
    EXPECT_EQ(sys.waited_on, roburoc4_udp_fd(&udp_));
}

TEST_F(Faults, CanBeOpenedAgainWithItsOwnAddress) {
    open();
    roburoc4_udp_close(&udp_);
    ASSERT_EQ(roburoc4_udp_open(&udp_, sizeof udp_, &udp_.address), ROBUROC4_OK);
    EXPECT_EQ(udp_.address.port, 60000);
    live(1000000);
    EXPECT_FALSE(sys.sent.empty());
}

TEST_F(Faults, ReconnectingIsLimitedToOnceASecond) {
    sys.connect_fault = ROBUROC4_FAULT_DOWN;
    open();
    for (int i = 0; i < 100000; i++) { /* a caller that calls without end */
        sys.now_us += 100;
        roburoc4_udp_transmit_all(&udp_, &client_);
    }
    EXPECT_GE(sys.connects_us.size(), 9u);
    EXPECT_LE(sys.connects_us.size(), 12u);
    for (size_t i = 1; i < sys.connects_us.size(); i++) {
        EXPECT_GE(sys.connects_us[i] - sys.connects_us[i - 1], 1000000u);
    }
}

TEST_F(Faults, AnAddressThatItCannotUseLeavesNoSocketOpen) {
    roburoc4_address local = address_;
    sys.bind_fault = ROBUROC4_FAULT_DOWN;
    EXPECT_EQ(roburoc4_udp_open_from(&udp_, sizeof udp_, &address_, &local), ROBUROC4_ERR_SYSTEM);
    sys.bind_fault = ROBUROC4_FAULT_NONE;
    for (uint32_t fault : {uint32_t{ROBUROC4_FAULT_DENIED}, uint32_t{ROBUROC4_FAULT_OTHER}}) {
        sys.connect_fault = fault;
        EXPECT_EQ(roburoc4_udp_open(&udp_, sizeof udp_, &address_), ROBUROC4_ERR_SYSTEM);
        EXPECT_EQ(udp_.fault, fault);
    }
    EXPECT_EQ(sys.sockets, 0);
}

TEST_F(Faults, ALinkLocalAddressOfItsOwnNeedsAZone) {
    roburoc4_address local{};
    address_.family = local.family = 6;
    address_.ip[0] = 0x20;
    local.ip[0] = 0xFE;
    local.ip[1] = 0x80;
    EXPECT_EQ(roburoc4_udp_open_from(&udp_, sizeof udp_, &address_, &local), ROBUROC4_ERR_ADDRESS);
    local.scope = 2;
    EXPECT_EQ(roburoc4_udp_open_from(&udp_, sizeof udp_, &address_, &local), ROBUROC4_OK);
    roburoc4_udp_close(&udp_);
    local.scope = 0;
    local.ip[1] = 0xC0; /* of a site */
    EXPECT_EQ(roburoc4_udp_open_from(&udp_, sizeof udp_, &address_, &local), ROBUROC4_OK);
    roburoc4_udp_close(&udp_);
    local.family = 4;
    EXPECT_EQ(roburoc4_udp_open_from(&udp_, sizeof udp_, &address_, &local), ROBUROC4_ERR_ADDRESS);
}

TEST_F(Faults, WhatWasNeverOpenedHasNoDescriptor) {
    EXPECT_EQ(roburoc4_udp_fd(&udp_), -1) << "0 is somebody's";
}

TEST_F(Faults, EveryFaultOfThePathIsReconnected) {
    for (const uint32_t fault : {uint32_t{ROBUROC4_FAULT_UNREACHABLE},
                                 uint32_t{ROBUROC4_FAULT_DOWN}, uint32_t{ROBUROC4_FAULT_OTHER}}) {
        TearDown();
        SetUp();
        open();
        sys.send_fault = fault;
        live(5000000);
        EXPECT_GE(sys.connects_us.size(), 4u) << fault;
    }
}

TEST_F(Faults, IsReconnectedOnceWhileNothingIsSent) {
    open();
    sys.send_faults = {ROBUROC4_FAULT_DOWN};
    EXPECT_EQ(roburoc4_udp_transmit_all(&udp_, &client_), 0);
    ASSERT_EQ(roburoc4_client_init(&client_, sizeof client_, nullptr), ROBUROC4_OK); /* is idle */
    for (int second = 0; second < 10; second++) {
        sys.now_us += 1000000;
        EXPECT_EQ(roburoc4_udp_transmit_all(&udp_, &client_), 0);
    }
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_RECONNECTS), 1u);
    EXPECT_EQ(sys.connects_us.size(), 2u);
}

TEST_F(Faults, AReconnectingThatFailsIsReportedAndTriedAgain) {
    open();
    sys.send_fault = ROBUROC4_FAULT_DOWN;
    live(500000);
    EXPECT_EQ(udp_.fault, uint32_t{ROBUROC4_FAULT_DOWN});
    sys.connect_fault = ROBUROC4_FAULT_UNREACHABLE;
    const uint32_t faults = count(ROBUROC4_UDP_COUNT_FAULTS);
    const uint32_t dropped = count(ROBUROC4_UDP_COUNT_DROPPED);
    live(4000000);
    EXPECT_EQ(udp_.fault, uint32_t{ROBUROC4_FAULT_UNREACHABLE});
    EXPECT_GE(count(ROBUROC4_UDP_COUNT_FAULTS), faults + 3);
    EXPECT_GT(count(ROBUROC4_UDP_COUNT_DROPPED), dropped);
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_RECONNECTS), 0u);
}

TEST_F(Faults, ARecordingShowsBothAddressesOfEachDatagram) {
    roburoc4_recorder_options options{};
    options.size = sizeof options;
    roburoc4_recorder *recorder = roburoc4_recorder_open("run.pcapng", &options, nullptr);
    ASSERT_NE(recorder, nullptr);
    open();
    ASSERT_EQ(roburoc4_udp_record(&udp_, recorder), ROBUROC4_OK);
    for (int path = 0; path < 2; path++) {
        sys.receives = {ROBUROC4_OS_DATAGRAM};
        live(500000);
        sys.send_faults = {ROBUROC4_FAULT_DOWN}; /* it gets another address of its own */
        live(1500000);
    }
    ASSERT_EQ(count(ROBUROC4_UDP_COUNT_RECONNECTS), 2u);
    const uint32_t sent = count(ROBUROC4_UDP_COUNT_SENT);
    roburoc4_recorder_state last{};
    ASSERT_EQ(roburoc4_recorder_close(recorder, &last), ROBUROC4_OK);
    const test::Capture capture = test::read_capture(sys.files.at("run.pcapng"));
    std::set<uint16_t> own_ports;
    uint32_t outbound = 0;
    for (const test::RecordedDatagram &datagram : capture.datagrams) {
        const bool inbound = datagram.flags == 1;
        outbound += !inbound;
        EXPECT_EQ(inbound ? datagram.from_port : datagram.to_port, 60000);
        own_ports.insert(inbound ? datagram.to_port : datagram.from_port);
    }
    EXPECT_EQ(outbound, sent) << "what was not sent is not recorded";
    EXPECT_EQ(capture.datagrams.size(), sent + 2);
    EXPECT_EQ(own_ports.size(), 3u);
    EXPECT_EQ(own_ports.count(0), 0u);
}

TEST_F(Faults, APathThatFailsForASecondIsReconnected) {
    open();
    live(5000000);                        /* long after it was connected */
    sys.send_fault = ROBUROC4_FAULT_DOWN; /* its own address was removed */
    while (count(ROBUROC4_UDP_COUNT_DROPPED) == 0) {
        live(1000);
    }
    for (int i = 0; i < 90; i++) {
        ASSERT_GE(roburoc4_udp_wait(&udp_, &client_, 10000), 0);
    }
    EXPECT_EQ(sys.connects_us.size(), 1u) << "time to recover by itself";
    live(2500000);
    EXPECT_GE(sys.connects_us.size(), 2u);
    sys.send_fault = ROBUROC4_FAULT_NONE;
    sys.sent.clear();
    live(2000000);
    EXPECT_FALSE(sys.sent.empty());
    size_t connects = sys.connects_us.size();
    live(10000000);
    EXPECT_EQ(sys.connects_us.size(), connects) << "a path that works is left alone";
}

TEST_F(Faults, APathThatFailsIsReconnectedHoweverOftenItIsSentTo) {
    open();
    sys.send_fault = ROBUROC4_FAULT_DOWN;
    for (int i = 0; i < 35; i++) { /* a new client sends at once */
        ASSERT_EQ(roburoc4_client_init(&client_, sizeof client_, nullptr), ROBUROC4_OK);
        ASSERT_EQ(roburoc4_client_start(&client_, sys.now_us), ROBUROC4_OK);
        ASSERT_GE(roburoc4_udp_transmit_all(&udp_, &client_), 0);
        sys.now_us += 100000;
    }
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_DROPPED), 35u);
    EXPECT_EQ(sys.connects_us.size(), 4u) << "each second";
}

TEST_F(Faults, APathThatRecoversByItselfKeepsItsConnection) {
    open();
    sys.send_faults = {ROBUROC4_FAULT_UNREACHABLE, ROBUROC4_FAULT_UNREACHABLE};
    live(10000000);
    EXPECT_EQ(sys.connects_us.size(), 1u);
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_DROPPED), 2u);
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_RECONNECTS), 0u);
}

TEST_F(Faults, RefusalsAndFullBuffersDoNotReconnect) {
    for (uint32_t fault : {uint32_t{ROBUROC4_FAULT_REFUSED}, uint32_t{ROBUROC4_FAULT_FULL},
                           uint32_t{ROBUROC4_FAULT_DENIED}}) {
        SetUp();
        open();
        sys.send_fault = fault;
        live(10000000);
        EXPECT_EQ(sys.connects_us.size(), 1u) << fault;
        EXPECT_EQ(udp_.fault, fault);
    }
}

TEST_F(Faults, AReportedRefusalDoesNotCostTheDatagram) {
    open();
    sys.send_faults = {ROBUROC4_FAULT_REFUSED};
    EXPECT_EQ(roburoc4_udp_transmit_all(&udp_, &client_), 1);
    EXPECT_EQ(sys.sent.size(), 1u);
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_REFUSED), 1u);
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_DROPPED), 0u);
}

TEST_F(Faults, WhatTheSocketRefusesIsDroppedNotQueued) {
    open();
    sys.send_fault = ROBUROC4_FAULT_FULL;
    EXPECT_EQ(roburoc4_udp_transmit_all(&udp_, &client_), 0);
    uint32_t dropped = count(ROBUROC4_UDP_COUNT_DROPPED);
    EXPECT_GE(dropped, 1u);
    sys.send_fault = ROBUROC4_FAULT_NONE;
    EXPECT_EQ(roburoc4_udp_transmit_all(&udp_, &client_), 0) << "nothing is due, nothing was kept";
    EXPECT_TRUE(sys.sent.empty());
}

TEST_F(Faults, EveryFaultOnReceivingIsSkipped) {
    open();
    sys.receives = {ROBUROC4_OS_FAULT, ROBUROC4_OS_OVERSIZED, ROBUROC4_OS_FAULT,
                    ROBUROC4_OS_DATAGRAM};
    EXPECT_EQ(roburoc4_udp_receive(&udp_, &client_, nullptr, nullptr), 0) << "it was no telegram";
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_REFUSED), 2u);
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_OVERSIZED), 1u);
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_RECEIVED), 1u);
    EXPECT_EQ(udp_.fault, uint32_t{ROBUROC4_FAULT_NONE}) << "a datagram came in";
    EXPECT_EQ(udp_.system_error, 0);
}

TEST_F(Faults, SaysHowManyDatagramsLeftAndHowManyTheClientUsed) {
    virtual_system::Robot robot;
    open();
    roburoc4_result most = 0;
    while (roburoc4_client_state(&client_) != ROBUROC4_STATE_READY) {
        const size_t before = sys.sent.size();
        const roburoc4_result sent = roburoc4_udp_transmit_all(&udp_, &client_);
        ASSERT_EQ(static_cast<size_t>(sent), sys.sent.size() - before);
        most = std::max(most, sent);
        virtual_system::sleep_ms(1);
        roburoc4_udp_receive(&udp_, &client_, nullptr, nullptr);
    }
    EXPECT_GT(most, 1);
    virtual_system::sleep_ms(200);
    roburoc4_udp_transmit_all(&udp_, &client_);
    sys.receives = {ROBUROC4_OS_DATAGRAM}; /* which the client drops */
    sys.received.clear();
    const roburoc4_result used = roburoc4_udp_wait(&udp_, &client_, 0);
    EXPECT_GT(used, 0);
    EXPECT_EQ(static_cast<size_t>(used), sys.received.size());
}

TEST_F(Faults, FaultsWithoutEndDoNotTrapTheCaller) {
    open();
    sys.receives.assign(100000, ROBUROC4_OS_FAULT);
    EXPECT_EQ(roburoc4_udp_wait(&udp_, &client_, 0), 0);
    EXPECT_EQ(sys.receive_calls, ROBUROC4_UDP_BURST);
}

TEST_F(Faults, AFloodIsInterruptedWhenTheClientMustSend) {
    open();
    roburoc4_udp_transmit_all(&udp_, &client_);
    sys.receive_forever = true;
    sys.receive_takes_us = 10000; /* the first retry is due in the middle of the burst */
    size_t sent = sys.sent.size();
    roburoc4_udp_wait(&udp_, &client_, 0);
    EXPECT_LE(sys.receive_calls, 11);
    EXPECT_GE(sys.receive_calls, 5);
    EXPECT_GT(sys.sent.size(), sent);
}

TEST_F(Faults, ABrokenSocketIsReportedAtOnce) {
    open();
    sys.receives = {ROBUROC4_OS_BROKEN};
    EXPECT_EQ(roburoc4_udp_wait(&udp_, &client_, 0), ROBUROC4_ERR_SYSTEM);
    EXPECT_EQ(udp_.system_error, 1000 + ROBUROC4_FAULT_OTHER);
    sys.waits_fail = true;
    EXPECT_EQ(roburoc4_udp_wait(&udp_, &client_, 1000), ROBUROC4_ERR_SYSTEM);
}

TEST_F(Faults, CanBeClosedRepeatedly) {
    open();
    EXPECT_EQ(roburoc4_udp_close(&udp_), ROBUROC4_OK);
    EXPECT_EQ(roburoc4_udp_close(&udp_), ROBUROC4_ERR_CLOSED);
    EXPECT_EQ(roburoc4_udp_fd(&udp_), -1);
    EXPECT_EQ(roburoc4_udp_wait(&udp_, &client_, 1000), ROBUROC4_ERR_CLOSED);
    EXPECT_EQ(roburoc4_udp_transmit_all(&udp_, &client_), ROBUROC4_ERR_CLOSED);
    EXPECT_EQ(roburoc4_udp_receive(&udp_, &client_, nullptr, nullptr), ROBUROC4_ERR_CLOSED);
}

TEST_F(Faults, WaitingEndsAtTheEarlierOfDeadlineAndTimeout) {
    open();
    roburoc4_udp_wait(&udp_, &client_, 1000);
    EXPECT_EQ(sys.waited_us, 1000u);
    uint64_t left_us = roburoc4_client_next_deadline(&client_) - sys.now_us;
    roburoc4_udp_wait(&udp_, &client_, UINT32_MAX);
    EXPECT_EQ(sys.waited_us, left_us);
}

TEST_F(Faults, WaitingForADeadlineThatHasPassedTakesNoTime) {
    open();
    sys.send_takes_us = 2000000; /* by then the next try is due */
    roburoc4_udp_wait(&udp_, &client_, 1000000);
    EXPECT_EQ(sys.waited_us, 0u);
}

/* ------------------------------------------------------------------------------- addresses --- */

roburoc4_address some_address(uint16_t port) {
    roburoc4_address address{};
    address.ip[0] = 127;
    address.ip[3] = 1;
    address.family = 4;
    address.port = port;
    return address;
}

TEST(Resolve, HasThePortOfTheTextElseTheDefault) {
    for (const auto &[text, port] : {std::pair<const char *, int>{"robot", 1},
                                     {"robot:65535", 65535},
                                     {"::1", 1},
                                     {"[::1]", 1},
                                     {"[::1]:7", 7},
                                     {"[robot:", 0},
                                     {"robot:00080", 80}}) {
        roburoc4_address address{};
        EXPECT_EQ(roburoc4_udp_resolve(text, 1, &address),
                  port != 0 ? ROBUROC4_OK : ROBUROC4_ERR_ADDRESS)
            << text;
        EXPECT_EQ(address.port, port) << text;
    }
    roburoc4_address address{};
    EXPECT_EQ(roburoc4_udp_resolve("robot", 0, &address), ROBUROC4_OK);
    EXPECT_EQ(address.port, ROBUROC4_DEFAULT_PORT);
    EXPECT_EQ(roburoc4_udp_resolve("nobody", 0, &address), ROBUROC4_ERR_RESOLVE);
    EXPECT_EQ(roburoc4_udp_resolve("robot", 0, nullptr), ROBUROC4_ERR_ADDRESS);
}

TEST(Resolve, RefusesTextsThatAreNotAddresses) {
    for (const char *text : {"", ":60000", "host:", "host:0", "host:65536", "host:70000", "host:-1",
                             "host:6x", "[]", "[::1", "[::1]60000", "[::1]:", "[::1]:0", "[host]:1",
                             "a b", " 1.2.3.4", "1.2.3.4\n", "a\x7f"}) {
        roburoc4_address address{};
        EXPECT_EQ(roburoc4_udp_resolve(text, 1, &address), ROBUROC4_ERR_ADDRESS) << text;
        EXPECT_EQ(address.family, 0) << text;
    }
    roburoc4_address address{};
    EXPECT_EQ(roburoc4_udp_resolve(nullptr, 1, &address), ROBUROC4_ERR_ADDRESS);
    EXPECT_EQ(roburoc4_udp_resolve(std::string(256, 'a').c_str(), 1, &address),
              ROBUROC4_ERR_ADDRESS);
}

TEST(AddressText, NeedsRoomForItsNul) {
    roburoc4_address address = some_address(80);
    char text[ROBUROC4_ADDRESS_TEXT_SIZE];
    EXPECT_EQ(roburoc4_udp_address_text(&address, text, sizeof text), 12);
    EXPECT_EQ(roburoc4_udp_address_text(&address, text, 13), 12);
    EXPECT_EQ(roburoc4_udp_address_text(&address, text, 12), ROBUROC4_ERR_BUFFER);
    address.family = 5;
    EXPECT_EQ(roburoc4_udp_address_text(&address, text, sizeof text), ROBUROC4_ERR_ADDRESS);
    address.family = 6;
    address.ip[15] = 9;
    EXPECT_EQ(roburoc4_udp_address_text(&address, text, sizeof text), 8);
    EXPECT_STREQ(text, "[::9]:80");
    address.scope = 4;
    EXPECT_EQ(roburoc4_udp_address_text(&address, text, 11), 10);
    EXPECT_STREQ(text, "[::9%4]:80");
    EXPECT_EQ(roburoc4_udp_address_text(&address, text, 10), ROBUROC4_ERR_BUFFER);
}

TEST(Udp, RefusesAnotherStructSizeAndBadAddresses) {
    roburoc4_udp udp{};
    roburoc4_address address = some_address(1);
    EXPECT_EQ(roburoc4_udp_open(&udp, sizeof udp - 8, &address), ROBUROC4_ERR_SIZE);
    EXPECT_EQ(roburoc4_udp_open(&udp, sizeof udp, nullptr), ROBUROC4_ERR_ADDRESS);
    address.port = 0;
    EXPECT_EQ(roburoc4_udp_open(&udp, sizeof udp, &address), ROBUROC4_ERR_ADDRESS);
    address.port = 1;
    address.family = 0;
    EXPECT_EQ(roburoc4_udp_open(&udp, sizeof udp, &address), ROBUROC4_ERR_ADDRESS);
    address.family = 6;
    address.ip[0] = 0xFE;
    address.ip[1] = 0x80;
    EXPECT_EQ(roburoc4_udp_open(&udp, sizeof udp, &address), ROBUROC4_ERR_ADDRESS)
        << "a link-local address says nothing without its zone";
    EXPECT_EQ(roburoc4_udp_fd(&udp), -1);
}

TEST(AbsentRobot, HasATextForEveryFault) {
    for (uint32_t fault = 0; fault <= ROBUROC4_FAULT_OTHER; fault++) {
        EXPECT_STRNE(roburoc4_udp_fault_text(fault), "unknown fault");
    }
    EXPECT_STREQ(roburoc4_udp_fault_text(0), "no fault");
    EXPECT_STREQ(roburoc4_udp_fault_text(ROBUROC4_FAULT_OTHER + 1), "unknown fault");
}

} // namespace
