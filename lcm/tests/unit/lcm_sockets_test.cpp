/* SPDX-License-Identifier: MIT
 *
 * Parts of the LCM bridge that need the system itself: which sockets can be read, the filter for an
 * LCM before 1.5, and a log that nobody reads. On sockets and pipes of this machine.
 */
#include <gtest/gtest.h>

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <set>
#include <vector>

extern "C" {
#include "filter.h"
#include "log.h"
#include "watch.h"
}

namespace {

class Socket {
  public:
    explicit Socket(int type = SOCK_DGRAM) : fd(socket(AF_INET, type, 0)) {
        sockaddr_in own{};
        own.sin_family = AF_INET;
        own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof own;
        EXPECT_EQ(bind(fd, reinterpret_cast<sockaddr *>(&own), size), 0);
        EXPECT_EQ(getsockname(fd, reinterpret_cast<sockaddr *>(&own), &size), 0);
        port = ntohs(own.sin_port);
    }
    Socket(const Socket &) = delete;
    Socket &operator=(const Socket &) = delete;
    ~Socket() {
        close(fd);
    }
    void send(const Socket &to, const std::vector<std::uint8_t> &bytes) const {
        sockaddr_in there{};
        there.sin_family = AF_INET;
        there.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        there.sin_port = htons(to.port);
        EXPECT_EQ(sendto(fd, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr *>(&there),
                         sizeof there),
                  static_cast<ssize_t>(bytes.size()));
    }
    /* Waits until something is there; its last byte. */
    int receive() const {
        std::uint8_t bytes[64];
        await();
        const ssize_t size = recv(fd, bytes, sizeof bytes, MSG_DONTWAIT);
        return size > 0 ? bytes[size - 1] : -1;
    }
    void await() const {
        pollfd end{fd, POLLIN, 0};
        EXPECT_EQ(poll(&end, 1, 10000), 1);
    }
    int fd;
    std::uint16_t port = 0;
};

std::set<std::uint32_t> ready() {
    static std::uint32_t numbers[WATCH_MAX];
    const std::uint32_t count = watch_wait(0, numbers);
    return {numbers, numbers + count};
}

} // namespace

TEST(LcmLog, WaitsForNoReader) {
    int pipe_ends[2];
    ASSERT_EQ(pipe(pipe_ends), 0);
    ASSERT_EQ(fcntl(pipe_ends[1], F_SETFL, O_NONBLOCK), 0);
    const std::vector<char> filling(4096, ' ');
    while (write(pipe_ends[1], filling.data(), filling.size()) > 0) {
    }
    ASSERT_EQ(fcntl(pipe_ends[1], F_SETFL, 0), 0); /* writing would wait */
    const int before = dup(STDERR_FILENO);
    ASSERT_EQ(dup2(pipe_ends[1], STDERR_FILENO), STDERR_FILENO);
    const auto begun = std::chrono::steady_clock::now();
    for (int line = 0; line < 1000; line++) {
        log_line(LOG_ERROR, "", "%d", line);
    }
    const auto took = std::chrono::steady_clock::now() - begun;
    EXPECT_EQ(dup2(before, STDERR_FILENO), STDERR_FILENO);
    for (const int end : {before, pipe_ends[0], pipe_ends[1]}) {
        close(end);
    }
    EXPECT_LT(took, std::chrono::milliseconds(900)) << "a wait of a millisecond each takes longer";
}

TEST(LcmWatch, NamesWhatCanBeReadUnderItsLatestSocket) {
    using Numbers = std::set<std::uint32_t>;
    const Socket one, two, three, sender;
    ASSERT_TRUE(watch_begin());
    watch_set(0, one.fd);
    watch_set(7, two.fd);
    watch_set(7, two.fd);
    EXPECT_EQ(ready(), Numbers{});
    for (const Socket *each : {&one, &two, &three}) {
        sender.send(*each, {1});
        each->await();
    }
    EXPECT_EQ(ready(), (Numbers{0, 7}));
    EXPECT_EQ(one.receive(), 1);
    EXPECT_EQ(ready(), Numbers{7});
    watch_set(7, -1);
    EXPECT_EQ(ready(), Numbers{});
    watch_set(0, three.fd);
    EXPECT_EQ(ready(), Numbers{0});
#if defined(__linux__)     /* poll() reports it */
    watch_set(0, 1 << 20); /* no descriptor */
    EXPECT_EQ(ready(), Numbers{});
#endif
    watch_set(0, two.fd);
    EXPECT_EQ(ready(), Numbers{0});
    watch_set(0, -1);
}

#if defined(__linux__)
/** A fragment: magic, number and size of the message, its offset, and number of the fragment. */
TEST(LcmFilter, DropsFragmentsThatAnOldLcmWritesOutsideOfTheirMessage) {
    const Socket lcm, sender;
    const Socket stream(SOCK_STREAM); /* of another kind, and perhaps with this port */
    EXPECT_FALSE(filter_fragments(1));
    EXPECT_FALSE(filter_fragments(stream.port == lcm.port ? 2 : stream.port));
    ASSERT_TRUE(filter_fragments(lcm.port));
    const struct {
        std::uint8_t magic, offset[4], number;
        bool dropped;
    } cases[] = {
        {0x33, {0, 0, 0, 0}, 0, false},
        {0x33, {0, 0, 0xFF, 0}, 1, false},
        {0x33, {0x10, 0, 0, 0}, 1, false},
        {0x33, {0x10, 0, 0, 1}, 1, true},
        {0x33, {0xFF, 0xFF, 0xFF, 0xFF}, 1, true},
        {0x33, {0, 0, 0xFF, 0}, 0, true},           /* the first one does not begin it */
        {0x32, {0xFF, 0xFF, 0xFF, 0xFF}, 0, false}, /* a short message, whole */
    };
    for (const auto &c : cases) {
        std::vector<std::uint8_t> bytes = {'L', 'C', '0', c.magic, 0, 0, 0, 0, 0, 0, 0, 9};
        bytes.insert(bytes.end(), c.offset, c.offset + 4);
        bytes.insert(bytes.end(), {0, c.number, 0, 2, 'x'});
        sender.send(lcm, bytes);
        sender.send(lcm, std::vector<std::uint8_t>(32, 0)); /* comes behind it */
        ASSERT_EQ(lcm.receive(), c.dropped ? 0 : 'x') << &c - cases;
        ASSERT_TRUE(c.dropped || lcm.receive() == 0) << &c - cases;
    }
}
#endif
