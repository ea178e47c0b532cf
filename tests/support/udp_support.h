/* SPDX-License-Identifier: MIT
 *
 * udp_support.h - what the socket tests share: a plain UDP socket on the loopback that a test reads
 * and writes by hand, and the time that such tests may take at most.
 */
#ifndef ROBUROC4_TESTS_UDP_SUPPORT_H
#define ROBUROC4_TESTS_UDP_SUPPORT_H

#include "roburoc4_udp.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <functional>
#include <random>
#include <stdexcept>
#include <vector>

namespace test {

/* Generous: a loaded machine is slow, but a wrong program never succeeds. */
constexpr uint64_t kPatienceUs = 60000000;

inline sockaddr_in loopback(uint16_t port, const char *ip = "127.0.0.1") {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    inet_pton(AF_INET, ip, &address.sin_addr);
    return address;
}

/* A datagram and who sent it. */
struct Received {
    std::vector<uint8_t> bytes;
    sockaddr_in from{};
};

class Socket {
  public:
    explicit Socket(uint16_t port = 0, const char *ip = "127.0.0.1")
        : fd_(socket(AF_INET, SOCK_DGRAM, 0)) {
        sockaddr_in own = loopback(port, ip);
        socklen_t length = sizeof own;
        if (fd_ < 0 || bind(fd_, reinterpret_cast<sockaddr *>(&own), length) != 0 ||
            getsockname(fd_, reinterpret_cast<sockaddr *>(&own), &length) != 0) {
            throw std::runtime_error("no loopback socket");
        }
        port_ = ntohs(own.sin_port);
        ip_ = ip;
    }
    Socket(const Socket &) = delete;
    Socket &operator=(const Socket &) = delete;
    ~Socket() {
        close(fd_);
    }

    uint16_t port() const {
        return port_;
    }
    int fd() const {
        return fd_;
    }
    roburoc4_address address() const {
        roburoc4_address out{};
        roburoc4_udp_resolve(ip_, port_, &out);
        return out;
    }
    /* What arrives in time; no bytes from port 0 if nothing does. */
    Received receive(int timeout_ms) const {
        Received got;
        pollfd watched{fd_, POLLIN, 0};
        if (poll(&watched, 1, timeout_ms) > 0) {
            uint8_t buffer[4096];
            socklen_t length = sizeof got.from;
            ssize_t size = recvfrom(fd_, buffer, sizeof buffer, 0,
                                    reinterpret_cast<sockaddr *>(&got.from), &length);
            if (size >= 0) {
                got.bytes.assign(buffer, buffer + size);
            }
        }
        return got;
    }
    void send(const sockaddr_in &to, const std::vector<uint8_t> &bytes) const {
        sendto(fd_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr *>(&to),
               sizeof to);
    }

  private:
    int fd_;
    uint16_t port_ = 0;
    const char *ip_;
};

/* A loopback port on which nobody listens; none that the system may give to another test meanwhile.
 */
inline uint16_t free_port() {
    std::random_device random;
    for (;;) {
        try {
            return Socket(static_cast<uint16_t>(12000 + random() % 20000)).port();
        } catch (const std::runtime_error &) {
            continue; /* taken */
        }
    }
}

/* Calls `step` until it returns true, or the time is over. */
inline bool eventually(const std::function<bool()> &step) {
    uint64_t until_us = roburoc4_udp_now_us() + kPatienceUs;
    while (!step()) {
        if (roburoc4_udp_now_us() > until_us) {
            return false;
        }
    }
    return true;
}

} // namespace test

#endif
