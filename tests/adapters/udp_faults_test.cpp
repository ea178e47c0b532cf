/* SPDX-License-Identifier: MIT
 *
 * udp_faults_test.cpp - the UDP adapter on a simulated network: linked with the static library,
 * this file replaces the operating system's part (src/os.h) and its clock, so that every failure
 * happens exactly when it is wanted.
 */
extern "C" {
#include "os.h"
#include "record_internal.h"
}

#include <gtest/gtest.h>

#include <cstring>
#include <deque>
#include <vector>

namespace {

constexpr int64_t kHandle = 77;

/* The system: its answers, and the calls it received. */
struct System {
    uint64_t now_us = 1000000;
    uint64_t waited_us = 0;
    int64_t waited_on = 0;
    uint32_t connect_fault = ROBUROC4_FAULT_NONE;
    uint32_t send_fault = ROBUROC4_FAULT_NONE; /* of every send */
    std::deque<uint32_t> send_faults;          /* of the next sends, before that */
    std::deque<int> receives;                  /* results of the next receives; then empty */
    uint32_t receive_forever = 0;              /* 1: a datagram is always there */
    uint64_t receive_takes_us = 0;
    std::vector<std::vector<uint8_t>> sent;
    std::vector<uint64_t> connects_us;
    int receive_calls = 0;
};
System fake;

roburoc4_os_outcome outcome_of(uint32_t fault) {
    return {fault, fault == ROBUROC4_FAULT_NONE ? 0 : 1000 + static_cast<int32_t>(fault)};
}

} // namespace

extern "C" {

uint64_t roburoc4_udp_now_us(void) {
    return fake.now_us;
}
roburoc4_result roburoc4_os_resolve(const char *, uint16_t, roburoc4_address *) {
    return ROBUROC4_ERR_RESOLVE;
}
int roburoc4_os_ip_text(const roburoc4_address *, char *, size_t) {
    return 0;
}
int64_t roburoc4_os_socket(const roburoc4_address *, roburoc4_os_outcome *outcome) {
    *outcome = outcome_of(ROBUROC4_FAULT_NONE);
    return kHandle;
}
void roburoc4_os_close(int64_t) {}
roburoc4_os_outcome roburoc4_os_bind(int64_t, const roburoc4_address *) {
    return outcome_of(ROBUROC4_FAULT_NONE);
}
roburoc4_os_outcome roburoc4_os_connect(int64_t, const roburoc4_address *) {
    fake.connects_us.push_back(fake.now_us);
    return outcome_of(fake.connect_fault);
}
roburoc4_os_outcome roburoc4_os_send(int64_t, const uint8_t *datagram, size_t size) {
    uint32_t fault = fake.send_fault;
    if (!fake.send_faults.empty()) {
        fault = fake.send_faults.front();
        fake.send_faults.pop_front();
    }
    if (fault == ROBUROC4_FAULT_NONE) {
        fake.sent.emplace_back(datagram, datagram + size);
    }
    return outcome_of(fault);
}
int roburoc4_os_own_address(int64_t, roburoc4_address *) {
    return 0;
}
void roburoc4_recorder_take(roburoc4_recorder *, int, const roburoc4_address *,
                            const roburoc4_address *, const uint8_t *, size_t) {}
int roburoc4_os_receive(int64_t, uint8_t *buffer, size_t, size_t *size,
                        roburoc4_os_outcome *outcome) {
    int result = ROBUROC4_OS_EMPTY;
    fake.receive_calls++;
    fake.now_us += fake.receive_takes_us;
    if (fake.receive_forever) {
        result = ROBUROC4_OS_DATAGRAM;
    } else if (!fake.receives.empty()) {
        result = fake.receives.front();
        fake.receives.pop_front();
    }
    buffer[0] = 0x01;
    *size = 1;
    *outcome =
        outcome_of(result == ROBUROC4_OS_FAULT ? ROBUROC4_FAULT_REFUSED : ROBUROC4_FAULT_OTHER);
    return result;
}
roburoc4_result roburoc4_os_wait(int64_t socket, int64_t, uint64_t timeout_us) {
    fake.waited_on = socket;
    fake.waited_us = timeout_us;
    fake.now_us += timeout_us;
    return ROBUROC4_OK;
}

} // extern "C"

namespace {

class Faults : public testing::Test {
  protected:
    void SetUp() override {
        fake = System();
        ASSERT_EQ(roburoc4_client_init(&client_, sizeof client_, nullptr), ROBUROC4_OK);
        ASSERT_EQ(roburoc4_client_start(&client_, fake.now_us), ROBUROC4_OK);
        address_.family = 4;
        address_.port = 60000;
    }
    void open() {
        ASSERT_EQ(roburoc4_udp_open(&udp_, sizeof udp_, &address_), ROBUROC4_OK);
    }
    uint32_t count(uint32_t counter) const {
        return udp_.counters[counter];
    }
    /* Lets the client's time pass; every wait ends at its deadline. */
    void live(uint64_t us) {
        uint64_t until_us = fake.now_us + us;
        while (fake.now_us < until_us) {
            ASSERT_GE(roburoc4_udp_wait(&udp_, &client_, 1000000), 0);
        }
    }

    roburoc4_udp udp_{};
    roburoc4_client client_{};
    roburoc4_address address_{};
};

TEST_F(Faults, AnUnreachableNetworkAtOpenIsAStateNotAnError) {
    fake.connect_fault = ROBUROC4_FAULT_UNREACHABLE;
    open();
    EXPECT_EQ(udp_.fault, uint32_t{ROBUROC4_FAULT_UNREACHABLE});
    EXPECT_EQ(udp_.system_error, 1000 + ROBUROC4_FAULT_UNREACHABLE);
    live(10000000);
    EXPECT_EQ(fake.waited_on, ROBUROC4_OS_NO_SOCKET);
    EXPECT_TRUE(fake.sent.empty());
    EXPECT_EQ(fake.receive_calls, 0) << "before it is connected, anybody could be heard";
    EXPECT_GE(count(ROBUROC4_UDP_COUNT_DROPPED), 5u);

    fake.connect_fault = ROBUROC4_FAULT_NONE;
    live(3000000);
    EXPECT_FALSE(fake.sent.empty());
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_RECONNECTS), 1u);
    EXPECT_EQ(fake.waited_on, kHandle);
}

TEST_F(Faults, ReconnectingIsLimitedToOnceASecond) {
    fake.connect_fault = ROBUROC4_FAULT_DOWN;
    open();
    for (int i = 0; i < 100000; i++) { /* a caller that calls without end */
        fake.now_us += 100;
        roburoc4_udp_transmit_all(&udp_, &client_);
    }
    EXPECT_GE(fake.connects_us.size(), 9u);
    EXPECT_LE(fake.connects_us.size(), 12u);
    for (size_t i = 1; i < fake.connects_us.size(); i++) {
        EXPECT_GE(fake.connects_us[i] - fake.connects_us[i - 1], 1000000u);
    }
}

TEST_F(Faults, APathThatFailsForASecondIsReconnected) {
    open();
    fake.send_fault = ROBUROC4_FAULT_DOWN; /* its own address was removed */
    live(600000);
    EXPECT_EQ(fake.connects_us.size(), 1u) << "time to recover by itself";
    live(2500000);
    EXPECT_GE(fake.connects_us.size(), 2u);
    fake.send_fault = ROBUROC4_FAULT_NONE;
    live(2000000);
    EXPECT_FALSE(fake.sent.empty());
    size_t connects = fake.connects_us.size();
    live(10000000);
    EXPECT_EQ(fake.connects_us.size(), connects) << "a path that works is left alone";
}

TEST_F(Faults, APathThatRecoversByItselfKeepsItsConnection) {
    open();
    fake.send_faults = {ROBUROC4_FAULT_UNREACHABLE, ROBUROC4_FAULT_UNREACHABLE};
    live(10000000);
    EXPECT_EQ(fake.connects_us.size(), 1u);
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_DROPPED), 2u);
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_RECONNECTS), 0u);
}

TEST_F(Faults, RefusalsAndFullBuffersDoNotReconnect) {
    for (uint32_t fault : {uint32_t{ROBUROC4_FAULT_REFUSED}, uint32_t{ROBUROC4_FAULT_FULL},
                           uint32_t{ROBUROC4_FAULT_DENIED}}) {
        SetUp();
        open();
        fake.send_fault = fault;
        live(10000000);
        EXPECT_EQ(fake.connects_us.size(), 1u) << fault;
        EXPECT_EQ(udp_.fault, fault);
    }
}

TEST_F(Faults, AReportedRefusalDoesNotCostTheDatagram) {
    open();
    fake.send_faults = {ROBUROC4_FAULT_REFUSED};
    EXPECT_EQ(roburoc4_udp_transmit_all(&udp_, &client_), 1);
    EXPECT_EQ(fake.sent.size(), 1u);
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_REFUSED), 1u);
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_DROPPED), 0u);
}

TEST_F(Faults, WhatTheSocketRefusesIsDroppedNotQueued) {
    open();
    fake.send_fault = ROBUROC4_FAULT_FULL;
    EXPECT_EQ(roburoc4_udp_transmit_all(&udp_, &client_), 0);
    uint32_t dropped = count(ROBUROC4_UDP_COUNT_DROPPED);
    EXPECT_GE(dropped, 1u);
    fake.send_fault = ROBUROC4_FAULT_NONE;
    EXPECT_EQ(roburoc4_udp_transmit_all(&udp_, &client_), 0) << "nothing is due, nothing was kept";
    EXPECT_TRUE(fake.sent.empty());
}

TEST_F(Faults, EveryFaultOnReceivingIsSkipped) {
    open();
    fake.receives = {ROBUROC4_OS_FAULT, ROBUROC4_OS_OVERSIZED, ROBUROC4_OS_FAULT,
                     ROBUROC4_OS_DATAGRAM};
    EXPECT_EQ(roburoc4_udp_receive_one(&udp_, &client_, nullptr, nullptr), ROBUROC4_UDP_DROPPED);
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_REFUSED), 2u);
    EXPECT_EQ(count(ROBUROC4_UDP_COUNT_OVERSIZED), 1u);
    EXPECT_EQ(udp_.fault, uint32_t{ROBUROC4_FAULT_NONE}) << "a datagram came in";
}

TEST_F(Faults, FaultsWithoutEndDoNotTrapTheCaller) {
    open();
    fake.receives.assign(100000, ROBUROC4_OS_FAULT);
    EXPECT_EQ(roburoc4_udp_wait(&udp_, &client_, 0), 0);
    EXPECT_EQ(fake.receive_calls, ROBUROC4_UDP_BURST);
}

TEST_F(Faults, AFloodIsInterruptedWhenTheClientMustSend) {
    open();
    roburoc4_udp_transmit_all(&udp_, &client_);
    fake.receive_forever = 1;
    fake.receive_takes_us = 10000; /* the first retry is due in the middle of the burst */
    size_t sent = fake.sent.size();
    roburoc4_udp_wait(&udp_, &client_, 0);
    EXPECT_LE(fake.receive_calls, 11);
    EXPECT_GE(fake.receive_calls, 5);
    EXPECT_GT(fake.sent.size(), sent);
}

TEST_F(Faults, ABrokenSocketIsReportedAtOnce) {
    open();
    fake.receives = {ROBUROC4_OS_BROKEN};
    EXPECT_EQ(roburoc4_udp_wait(&udp_, &client_, 0), ROBUROC4_ERR_SYSTEM);
    EXPECT_EQ(udp_.system_error, 1000 + ROBUROC4_FAULT_OTHER);
}

TEST_F(Faults, WaitingEndsAtTheEarlierOfDeadlineAndTimeout) {
    open();
    roburoc4_udp_wait(&udp_, &client_, 1000);
    EXPECT_EQ(fake.waited_us, 1000u);
    uint64_t left_us = roburoc4_client_next_deadline(&client_) - fake.now_us;
    roburoc4_udp_wait(&udp_, &client_, UINT32_MAX);
    EXPECT_EQ(fake.waited_us, left_us);
}

} // namespace
