/* SPDX-License-Identifier: MIT
 *
 * udp_test.cpp - the UDP adapter on real loopback sockets: addresses, strangers, garbage, floods.
 */
#include "counts.h"
#include "udp_support.h"

#include <gtest/gtest.h>

#include <string>

using test::eventually;
using test::free_port;
using test::loopback;
using test::Received;
using test::Socket;

namespace {

/* A client and its socket, connecting to a port of the loopback. */
struct Link {
    roburoc4_udp udp{};
    roburoc4_client client{};

    explicit Link(const roburoc4_address &address, bool started = true) {
        EXPECT_EQ(roburoc4_udp_open(&udp, sizeof udp, &address), ROBUROC4_OK);
        EXPECT_EQ(roburoc4_client_init(&client, sizeof client, nullptr), ROBUROC4_OK);
        if (started) {
            EXPECT_EQ(roburoc4_client_start(&client, roburoc4_udp_now_us()), ROBUROC4_OK);
        }
    }
    ~Link() {
        roburoc4_udp_close(&udp);
    }
    roburoc4_result wait(uint32_t timeout_us) {
        return roburoc4_udp_wait(&udp, &client, timeout_us);
    }
    uint32_t udp_count(uint32_t counter) const {
        return udp.counters[counter];
    }
    /* The address from which a robot sees this link come. */
    sockaddr_in seen_from() const {
        sockaddr_in own{};
        socklen_t length = sizeof own;
        getsockname(static_cast<int>(roburoc4_udp_fd(&udp)), reinterpret_cast<sockaddr *>(&own),
                    &length);
        return own;
    }
};

roburoc4_address address_of(uint16_t port) {
    roburoc4_address out{};
    EXPECT_EQ(roburoc4_udp_resolve("127.0.0.1", port, &out), ROBUROC4_OK);
    return out;
}

std::string text_of(const char *host) {
    roburoc4_address address{};
    char text[ROBUROC4_ADDRESS_TEXT_SIZE];
    if (roburoc4_udp_resolve(host, 1234, &address) < 0 ||
        roburoc4_udp_address_text(&address, text, sizeof text) < 0) {
        return "";
    }
    return text;
}

/* The directory of a robot that has only the two services every robot has. */
std::vector<uint8_t> directory_answer(uint8_t id) {
    roburoc4_directory_entry entries[2] = {{0x0001, 0}, {0x0002, 1}};
    std::vector<uint8_t> answer(64);
    roburoc4_result size =
        roburoc4_encode_directory(answer.data(), answer.size(), id, 0, entries, 2);
    EXPECT_GT(size, 0);
    answer.resize(static_cast<size_t>(size));
    return answer;
}

/* ----------------------------------------------------------------------- the local address --- */

TEST(OpenFrom, SendsFromTheLocalAddressAndPort) {
    Socket robot;
    const roburoc4_address address = robot.address();
    for (const bool with_ip : {false, true}) {
        for (const bool with_port : {false, true}) {
            roburoc4_address local = address_of(1);
            local.port = with_port ? free_port() : 0;
            local.ip[0] = with_ip ? 127 : 0;
            local.ip[3] = with_ip ? 9 : 0;
            roburoc4_udp udp{};
            ASSERT_EQ(roburoc4_udp_open_from(&udp, sizeof udp, &address, &local), ROBUROC4_OK);
            roburoc4_client client{};
            ASSERT_EQ(roburoc4_client_init(&client, sizeof client, nullptr), ROBUROC4_OK);
            ASSERT_EQ(roburoc4_client_start(&client, roburoc4_udp_now_us()), ROBUROC4_OK);
            ASSERT_EQ(roburoc4_udp_wait(&udp, &client, 0), 0);
            const Received got = robot.receive(static_cast<int>(test::kPatienceUs / 1000));
            EXPECT_EQ(got.from.sin_addr.s_addr,
                      loopback(0, with_ip ? "127.0.0.9" : "127.0.0.1").sin_addr.s_addr);
            if (with_port) {
                EXPECT_EQ(ntohs(got.from.sin_port), local.port);
            }
            EXPECT_EQ(roburoc4_udp_close(&udp), ROBUROC4_OK);
        }
    }
}

/* ------------------------------------------------------------------------------- addresses --- */

TEST(Resolve, AcceptsEveryDocumentedForm) {
    EXPECT_EQ(text_of("192.168.0.2"), "192.168.0.2:1234");
    EXPECT_EQ(text_of("192.168.0.2:60001"), "192.168.0.2:60001");
    EXPECT_EQ(text_of("localhost:7"), "127.0.0.1:7") << "a name with both families gives IPv4";
    EXPECT_EQ(text_of("::1"), "[::1]:1234");
    EXPECT_EQ(text_of("[::1]"), "[::1]:1234");
    EXPECT_EQ(text_of("[2001:db8::5]:65535"), "[2001:db8::5]:65535");
}

/* ---------------------------------------------------------------------- sending, receiving --- */

TEST(Udp, ShowsEachDatagramThatItReceives) {
    Socket robot;
    Link link(robot.address());
    link.wait(0);
    Received request = robot.receive(5000);
    ASSERT_FALSE(request.bytes.empty());
    std::vector<uint8_t> answer = directory_answer(request.bytes[0]);
    robot.send(request.from, answer);
    robot.send(request.from, answer);
    std::vector<std::vector<uint8_t>> seen;
    const auto keep = [](void *context, const uint8_t *datagram, size_t size) {
        static_cast<decltype(seen) *>(context)->emplace_back(datagram, datagram + size);
    };
    EXPECT_EQ(roburoc4_udp_receive(&link.udp, &link.client, keep, &seen), 1);
    EXPECT_EQ(seen.size(), 1u) << "the client has something to send";
    roburoc4_udp_transmit_all(&link.udp, &link.client);
    EXPECT_EQ(roburoc4_udp_receive(&link.udp, &link.client, keep, &seen), 0) << "the same again";
    EXPECT_EQ(seen, (std::vector<std::vector<uint8_t>>{answer, answer}));
    EXPECT_EQ(link.udp_count(ROBUROC4_UDP_COUNT_RECEIVED), 2u);
}

TEST(Udp, SurvivesGarbageOfEveryLength) {
    Socket robot;
    Link link(robot.address());
    uint32_t state = 1;
    for (size_t size = 0; size < 300; size++) {
        std::vector<uint8_t> garbage(size);
        for (uint8_t &byte : garbage) {
            state = state * 1664525u + 1013904223u;
            byte = static_cast<uint8_t>(state >> 24);
        }
        robot.send(link.seen_from(), garbage);
        ASSERT_GE(link.wait(0), 0);
    }
    ASSERT_TRUE(eventually([&] {
        link.wait(1000);
        return link.udp_count(ROBUROC4_UDP_COUNT_RECEIVED) == 300;
    }));
    EXPECT_EQ(roburoc4_client_count(&link.client, ROBUROC4_COUNT_RECEIVED), 300u);
    EXPECT_EQ(roburoc4_client_state(&link.client), uint32_t{ROBUROC4_STATE_CONNECTING});
}

TEST(Udp, ReceivesOnlyFromTheRobotsAddressAndPort) {
    Socket robot;
    Socket same_host;
    Socket same_port(robot.port(), "127.0.0.2");
    Link link(robot.address());
    link.wait(0);
    Received request = robot.receive(5000);
    ASSERT_FALSE(request.bytes.empty());
    std::vector<uint8_t> answer = directory_answer(request.bytes[0]);
    for (int i = 0; i < 50; i++) {
        same_host.send(request.from, answer);
        same_port.send(request.from, answer);
        link.wait(1000);
    }
    EXPECT_EQ(link.udp_count(ROBUROC4_UDP_COUNT_RECEIVED), 0u);
    EXPECT_EQ(roburoc4_client_count(&link.client, ROBUROC4_COUNT_RECEIVED), 0u);
    EXPECT_EQ(service_count(&link.client), 0u);

    robot.send(request.from, answer); /* the very same bytes, from the robot itself */
    ASSERT_TRUE(eventually([&] {
        link.wait(1000);
        return link.udp_count(ROBUROC4_UDP_COUNT_RECEIVED) == 1;
    }));
    EXPECT_EQ(roburoc4_client_count(&link.client, ROBUROC4_COUNT_RECEIVED), 1u);
}

/* ---------------------------------------------------------------------------------- floods --- */

TEST(Flood, IsTakenInBurstsOfBoundedLength) {
    Socket robot;
    Link link(robot.address(), false);
    for (int i = 0; i < 150; i++) {
        robot.send(link.seen_from(), {0x01});
    }
    EXPECT_EQ(link.wait(0), 0);
    EXPECT_EQ(link.udp_count(ROBUROC4_UDP_COUNT_RECEIVED), uint32_t{ROBUROC4_UDP_BURST});
    link.wait(0);
    link.wait(0);
    EXPECT_EQ(link.udp_count(ROBUROC4_UDP_COUNT_RECEIVED), 150u);
}

} // namespace
