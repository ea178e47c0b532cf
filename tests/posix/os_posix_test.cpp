/* SPDX-License-Identifier: MIT
 *
 * src/os_posix.c on a C library whose every failure happens exactly when it is wanted: it is
 * compiled so that it calls fake_send() instead of send(), and so on.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <deque>
#include <fcntl.h>
#include <future>
#include <map>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/ip.h>
#include <poll.h>
#include <set>
#include <string>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

extern "C" {
#include "os.h"
}

namespace {

struct Datagram {
    int error; /* other than 0: the call fails */
    std::vector<uint8_t> bytes;
};

/* What tests set, and what they look at. */
struct Library {
    std::map<std::string, int> errors; /* of all calls of a function; fcntl's by its command */
    std::deque<int> connect_errors;    /* of the next calls */
    std::deque<Datagram> inbox;
    std::map<std::string, std::vector<sockaddr_storage>> names; /* to look up */
    std::map<clockid_t, timespec> clocks;
    short ready[2] = {0, 0}; /* what ppoll() reports */

    bool real = false; /* descriptors are the system's */
    std::set<int> open;
    int socket_family = 0, flags = 0, descriptor_flags = 0;
    std::map<std::pair<int, int>, int> options;
    std::vector<sockaddr_storage> bound, connected;
    std::vector<uint8_t> sent;
    std::vector<std::string> asked; /* name servers */
    std::vector<addrinfo *> lists;  /* that were not freed */
    clockid_t signal_clock = -1;    /* of waits for a signal, and until when the last one was */
    timespec signal_until{};
    timespec waited{};
    std::vector<pollfd> watched;
};
Library library;

/* -1 and errno, or 0. */
int fails(const std::string &function) {
    const auto found = library.errors.find(function);
    errno = found == library.errors.end() ? 0 : found->second;
    return errno != 0 ? -1 : 0;
}

sockaddr_storage stored(const sockaddr *address, socklen_t size) {
    sockaddr_storage out{};
    std::memcpy(&out, address, size);
    return out;
}

} // namespace

extern "C" {

int fake_socket(int family, int type, int protocol);
int fake_socket(int family, int type, int protocol) {
    EXPECT_EQ(type, SOCK_DGRAM);
    EXPECT_EQ(protocol, 0);
    library.socket_family = family;
    if (fails("socket") != 0) {
        return -1;
    }
    library.open.insert(7);
    return 7;
}

int fake_close(int fd);
int fake_close(int fd) {
    if (library.real) {
        return close(fd);
    }
    EXPECT_EQ(library.open.erase(fd), 1u);
    return 0;
}

int fake_fcntl(int fd, int command, ...);
int fake_fcntl(int fd, int command, ...) {
    va_list arguments;
    va_start(arguments, command);
    const int value = va_arg(arguments, int);
    va_end(arguments);
    if (library.real) {
        return fails(command == F_SETFD ? "F_SETFD" : "F_SETFL") != 0 ? -1
                                                                      : fcntl(fd, command, value);
    }
    EXPECT_EQ(library.open.count(fd), 1u);
    (command == F_SETFD ? library.descriptor_flags : library.flags) = value;
    return fails(command == F_SETFD ? "F_SETFD" : "F_SETFL");
}

int fake_setsockopt(int fd, int level, int name, const void *value, socklen_t size);
int fake_setsockopt(int, int level, int name, const void *value, socklen_t size) {
    EXPECT_EQ(size, sizeof(int));
    std::memcpy(&library.options[{level, name}], value, sizeof(int));
    return fails("setsockopt");
}

int fake_bind(int fd, const sockaddr *address, socklen_t size);
int fake_bind(int, const sockaddr *address, socklen_t size) {
    library.bound.push_back(stored(address, size));
    return fails("bind");
}

int fake_connect(int fd, const sockaddr *address, socklen_t size);
int fake_connect(int, const sockaddr *address, socklen_t size) {
    library.connected.push_back(stored(address, size));
    errno = 0;
    if (!library.connect_errors.empty()) {
        errno = library.connect_errors.front();
        library.connect_errors.pop_front();
    }
    return errno != 0 ? -1 : 0;
}

int fake_getsockname(int fd, sockaddr *address, socklen_t *size);
int fake_getsockname(int, sockaddr *address, socklen_t *size) {
    if (fails("getsockname") == 0) {
        *size = sizeof library.bound.back();
        std::memcpy(address, &library.bound.back(), *size);
    }
    return errno != 0 ? -1 : 0;
}

ssize_t fake_send(int fd, const void *bytes, size_t size, int flags);
ssize_t fake_send(int, const void *bytes, size_t size, int) {
    if (fails("send") != 0) {
        return -1;
    }
    const auto *first = static_cast<const uint8_t *>(bytes);
    library.sent.assign(first, first + size);
    return static_cast<ssize_t>(size);
}

/* The first of the inbox; MSG_TRUNC as Linux has it. */
ssize_t fake_recv(int fd, void *buffer, size_t capacity, int flags);
ssize_t fake_recv(int, void *buffer, size_t capacity, int flags) {
    const Datagram first = library.inbox.front();
    library.inbox.pop_front();
    errno = first.error;
    if (errno != 0) {
        return -1;
    }
    const size_t copied = first.bytes.size() < capacity ? first.bytes.size() : capacity;
    std::copy_n(first.bytes.begin(), copied, static_cast<uint8_t *>(buffer));
    return static_cast<ssize_t>((flags & MSG_TRUNC) != 0 ? first.bytes.size() : copied);
}

int fake_ppoll(pollfd *watched, nfds_t count, const timespec *timeout, const sigset_t *mask);
int fake_ppoll(pollfd *watched, nfds_t count, const timespec *timeout, const sigset_t *mask) {
    EXPECT_EQ(mask, nullptr);
    library.watched.assign(watched, watched + count);
    library.waited = *timeout;
    for (nfds_t i = 0; i < count; i++) {
        watched[i].revents = library.ready[i];
    }
    return fails("ppoll");
}

int fake_getaddrinfo(const char *name, const char *service, const addrinfo *hints, addrinfo **out);
int fake_getaddrinfo(const char *name, const char *service, const addrinfo *hints, addrinfo **out) {
    EXPECT_EQ(service, nullptr);
    EXPECT_EQ(hints->ai_socktype, SOCK_DGRAM);
    EXPECT_EQ(hints->ai_family, AF_UNSPEC);
    const bool numeric = std::isdigit(static_cast<unsigned char>(name[0])) != 0;
    if (!numeric) {
        if ((hints->ai_flags & AI_NUMERICHOST) != 0) {
            return EAI_NONAME;
        }
        library.asked.push_back(name);
    }
    const auto found = library.names.find(name);
    if (found == library.names.end()) {
        return EAI_NONAME;
    }
    *out = nullptr;
    for (auto at = found->second.rbegin(); at != found->second.rend(); ++at) {
        auto *entry = new addrinfo{};
        entry->ai_family = at->ss_family;
        entry->ai_addr = reinterpret_cast<sockaddr *>(&*at);
        entry->ai_next = *out;
        *out = entry;
    }
    library.lists.push_back(*out);
    return 0;
}

void fake_freeaddrinfo(addrinfo *list);
void fake_freeaddrinfo(addrinfo *list) {
    ASSERT_FALSE(library.lists.empty());
    EXPECT_EQ(library.lists.back(), list);
    library.lists.pop_back();
    while (list != nullptr) {
        addrinfo *next = list->ai_next;
        delete list;
        list = next;
    }
}

int fake_clock_gettime(clockid_t clock, timespec *out);
int fake_clock_gettime(clockid_t clock, timespec *out) {
    const auto found = library.clocks.find(clock);
    if (found == library.clocks.end()) {
        errno = EINVAL;
        return -1;
    }
    *out = found->second;
    return 0;
}

int fake_pthread_mutex_init(pthread_mutex_t *mutex, const pthread_mutexattr_t *attributes);
int fake_pthread_mutex_init(pthread_mutex_t *mutex, const pthread_mutexattr_t *attributes) {
    return attributes != nullptr && fails("attributes") != 0 ? errno
           : fails("mutex") != 0                             ? errno
                                 : pthread_mutex_init(mutex, attributes);
}

int fake_pthread_condattr_setclock(pthread_condattr_t *attributes, clockid_t clock);
int fake_pthread_condattr_setclock(pthread_condattr_t *, clockid_t clock) {
    library.signal_clock = clock;
    return fails("setclock") != 0 ? errno : 0;
}

int fake_pthread_cond_timedwait(pthread_cond_t *signal, pthread_mutex_t *mutex,
                                const timespec *until);
int fake_pthread_cond_timedwait(pthread_cond_t *, pthread_mutex_t *, const timespec *until) {
    library.signal_until = *until;
    return ETIMEDOUT;
}

int fake_pthread_create(pthread_t *id, const pthread_attr_t *attributes, void *(*run)(void *),
                        void *argument);
int fake_pthread_create(pthread_t *id, const pthread_attr_t *attributes, void *(*run)(void *),
                        void *argument) {
    const int error = fails("thread") != 0 ? errno : pthread_create(id, attributes, run, argument);
    errno = 0; /* it is not set */
    return error;
}

} // extern "C"

namespace {

roburoc4_address v4(uint16_t port, uint8_t last = 2) {
    roburoc4_address address{};
    const uint8_t ip[] = {192, 168, 0, last};
    std::memcpy(address.ip, ip, sizeof ip);
    address.family = 4;
    address.port = port;
    return address;
}

roburoc4_address v6(uint16_t port, uint32_t scope) {
    roburoc4_address address{};
    for (uint8_t i = 0; i < 16; i++) {
        address.ip[i] = static_cast<uint8_t>(0xF0 + i);
    }
    address.family = 6;
    address.port = port;
    address.scope = scope;
    return address;
}

sockaddr_storage system_v4(const char *ip) {
    sockaddr_in in{};
    in.sin_family = AF_INET;
    inet_pton(AF_INET, ip, &in.sin_addr);
    return stored(reinterpret_cast<const sockaddr *>(&in), sizeof in);
}

sockaddr_storage system_v6(const char *ip, uint32_t scope = 0) {
    sockaddr_in6 in6{};
    in6.sin6_family = AF_INET6;
    in6.sin6_scope_id = scope;
    inet_pton(AF_INET6, ip, &in6.sin6_addr);
    return stored(reinterpret_cast<const sockaddr *>(&in6), sizeof in6);
}

class Posix : public testing::Test {
  protected:
    void SetUp() override {
        library = Library();
    }
    void TearDown() override {
        EXPECT_TRUE(library.lists.empty()) << "each list of addresses is freed";
    }
    /* A call that fails with this error. */
    static roburoc4_os_outcome send_with(int error) {
        library.errors["send"] = error;
        const uint8_t byte = 1;
        return roburoc4_os_send(7, &byte, 1);
    }
    int receive(size_t capacity) {
        buffer_.assign(capacity + 1, 0xEE);
        size_ = 12345;
        const int result = roburoc4_os_receive(7, buffer_.data(), capacity, &size_, &outcome_);
        EXPECT_EQ(buffer_[capacity], 0xEE) << "nothing is written beyond the buffer";
        return result;
    }
    int receive_error(int error) {
        library.inbox.push_back({error, {}});
        return receive(10);
    }

    std::vector<uint8_t> buffer_;
    size_t size_ = 0;
    roburoc4_os_outcome outcome_{99, 99};
};

/* ---------------------------------------------------------------------------------- socket --- */

TEST_F(Posix, ASocketNeverBlocksAndIsNotInherited) {
    for (const bool six : {false, true}) {
        SetUp();
        const roburoc4_address address = six ? v6(1, 0) : v4(1);
        EXPECT_EQ(roburoc4_os_socket(&address, &outcome_), 7);
        EXPECT_EQ(outcome_.fault, uint32_t{ROBUROC4_FAULT_NONE});
        EXPECT_EQ(outcome_.system_error, 0);
        EXPECT_EQ(library.socket_family, six ? AF_INET6 : AF_INET);
        EXPECT_EQ(library.flags, O_NONBLOCK);
        EXPECT_EQ(library.descriptor_flags, FD_CLOEXEC);
        EXPECT_LE((library.options[{SOL_SOCKET, SO_SNDBUF}]), 4096) << "no queue of old commands";
        EXPECT_GT((library.options[{SOL_SOCKET, SO_SNDBUF}]), 0);
        EXPECT_GE((library.options[{SOL_SOCKET, SO_RCVBUF}]), 100000) << "statuses of seconds";
        EXPECT_EQ(library.options.count({IPPROTO_IP, IP_TOS}), six ? 0u : 1u);
        if (!six) {
            EXPECT_EQ((library.options[{IPPROTO_IP, IP_TOS}]), IPTOS_LOWDELAY);
        }
        roburoc4_os_close(7);
        EXPECT_TRUE(library.open.empty());
    }
}

TEST_F(Posix, ASocketThatCannotBeMadeLeavesNone) {
    const roburoc4_address address = v4(1);
    for (const char *function : {"socket", "F_SETFD", "F_SETFL"}) {
        SetUp();
        library.errors[function] = EACCES;
        outcome_ = {99, 99};
        EXPECT_EQ(roburoc4_os_socket(&address, &outcome_), ROBUROC4_OS_NO_SOCKET) << function;
        EXPECT_EQ(outcome_.fault, uint32_t{ROBUROC4_FAULT_DENIED}) << function;
        EXPECT_EQ(outcome_.system_error, EACCES) << function;
        EXPECT_TRUE(library.open.empty()) << function;
    }
}

TEST_F(Posix, TheOwnAddressIsThatWhichWasBound) {
    for (const roburoc4_address &own : {v4(60001, 9), v6(60002, 77)}) {
        roburoc4_address found{};
        EXPECT_EQ(roburoc4_os_bind(7, &own).fault, uint32_t{ROBUROC4_FAULT_NONE});
        ASSERT_EQ(roburoc4_os_own_address(7, &found), 1);
        EXPECT_EQ(std::memcmp(&found, &own, sizeof own), 0);
        const uint16_t port = htons(own.port);
        EXPECT_EQ(std::memcmp(reinterpret_cast<const char *>(&library.bound.back()) + 2, &port, 2),
                  0);
    }
    library.errors["bind"] = EADDRINUSE;
    const roburoc4_address own = v4(1);
    const roburoc4_os_outcome outcome = roburoc4_os_bind(7, &own);
    EXPECT_NE(outcome.fault, uint32_t{ROBUROC4_FAULT_NONE});
    EXPECT_EQ(outcome.system_error, EADDRINUSE);
    library.errors["getsockname"] = ENOTSOCK;
    roburoc4_address found{};
    EXPECT_EQ(roburoc4_os_own_address(7, &found), 0);
}

TEST_F(Posix, ConnectingAgainChoosesTheLocalAddressAgain) {
    const roburoc4_address robot = v4(60000);
    library.connect_errors = {EAFNOSUPPORT, 0}; /* there was no connection to dissolve */
    EXPECT_EQ(roburoc4_os_connect(7, &robot).fault, uint32_t{ROBUROC4_FAULT_NONE});
    ASSERT_EQ(library.connected.size(), 2u);
    EXPECT_EQ(library.connected[0].ss_family, AF_UNSPEC);
    EXPECT_EQ(library.connected[1].ss_family, AF_INET);
    library.connect_errors = {0, ENETUNREACH};
    const roburoc4_os_outcome outcome = roburoc4_os_connect(7, &robot);
    EXPECT_EQ(outcome.fault, uint32_t{ROBUROC4_FAULT_UNREACHABLE});
    EXPECT_EQ(outcome.system_error, ENETUNREACH);
}

/* ------------------------------------------------------------------------------- datagrams --- */

TEST_F(Posix, EveryErrorOfSendingIsTheFaultThatPeopleAreTold) {
    const std::map<int, uint32_t> faults = {
        {0, ROBUROC4_FAULT_NONE},
        {ECONNREFUSED, ROBUROC4_FAULT_REFUSED},
        {ECONNRESET, ROBUROC4_FAULT_REFUSED},
        {ENETUNREACH, ROBUROC4_FAULT_UNREACHABLE},
        {EHOSTUNREACH, ROBUROC4_FAULT_UNREACHABLE},
        {EHOSTDOWN, ROBUROC4_FAULT_UNREACHABLE},
        {ENETDOWN, ROBUROC4_FAULT_DOWN},
        {ENETRESET, ROBUROC4_FAULT_DOWN},
        {ENODEV, ROBUROC4_FAULT_DOWN},
        {ENXIO, ROBUROC4_FAULT_DOWN},
        {EADDRNOTAVAIL, ROBUROC4_FAULT_DOWN},
        {EINVAL, ROBUROC4_FAULT_DOWN},
        {EPERM, ROBUROC4_FAULT_DENIED},
        {EACCES, ROBUROC4_FAULT_DENIED},
        {EAGAIN, ROBUROC4_FAULT_FULL},
        {EWOULDBLOCK, ROBUROC4_FAULT_FULL},
        {EINTR, ROBUROC4_FAULT_FULL},
        {ENOBUFS, ROBUROC4_FAULT_FULL},
        {ENOMEM, ROBUROC4_FAULT_FULL},
        {EMSGSIZE, ROBUROC4_FAULT_OTHER},
        {EBADF, ROBUROC4_FAULT_OTHER},
    };
    for (const auto &[error, fault] : faults) {
        const roburoc4_os_outcome outcome = send_with(error);
        EXPECT_EQ(outcome.fault, fault) << std::strerror(error);
        EXPECT_EQ(outcome.system_error, error) << std::strerror(error);
    }
}

TEST_F(Posix, ADatagramThatFillsTheBufferIsWholeAndALongerOneIsNot) {
    for (const size_t size : {size_t{0}, size_t{1}, size_t{9}, size_t{10}}) {
        library.inbox.push_back({0, std::vector<uint8_t>(size, 5)});
        EXPECT_EQ(receive(10), ROBUROC4_OS_DATAGRAM) << size;
        EXPECT_EQ(size_, size);
    }
    for (const size_t size : {size_t{11}, size_t{60000}}) {
        library.inbox.push_back({0, std::vector<uint8_t>(size, 5)});
        EXPECT_EQ(receive(10), ROBUROC4_OS_OVERSIZED) << size;
    }
}

TEST_F(Posix, ErrorsOfReceivingAreEmptyOrOfEarlierDatagramsOrOfTheSocket) {
    for (const int error : {EAGAIN, EWOULDBLOCK, EINTR, ENOBUFS, ENOMEM}) {
        EXPECT_EQ(receive_error(error), ROBUROC4_OS_EMPTY) << std::strerror(error);
    }
    for (const int error : {ECONNREFUSED, EHOSTUNREACH, ENETDOWN, EPERM, EIO}) {
        EXPECT_EQ(receive_error(error), ROBUROC4_OS_FAULT) << std::strerror(error);
        EXPECT_EQ(outcome_.system_error, error);
    }
    for (const int error : {EBADF, ENOTSOCK}) {
        EXPECT_EQ(receive_error(error), ROBUROC4_OS_BROKEN) << std::strerror(error);
        EXPECT_EQ(outcome_.system_error, error);
    }
}

/* ----------------------------------------------------------------------------------- waiting ---
 */

TEST_F(Posix, WaitsForBothAndNoLongerThanWanted) {
    struct {
        uint64_t us;
        timespec wanted;
    } const waits[] = {{0, {0, 0}},
                       {1, {0, 1000}},
                       {999999, {0, 999999000}},
                       {1000000, {1, 0}},
                       {2500000, {2, 500000000}},
                       {UINT64_MAX, {3600, 0}}};
    for (const auto &wait : waits) {
        EXPECT_EQ(roburoc4_os_wait(7, 8, wait.us), ROBUROC4_OK);
        EXPECT_EQ(library.waited.tv_sec, wait.wanted.tv_sec) << wait.us;
        EXPECT_EQ(library.waited.tv_nsec, wait.wanted.tv_nsec) << wait.us;
    }
    ASSERT_EQ(library.watched.size(), 2u);
    EXPECT_EQ(library.watched[0].fd, 7);
    EXPECT_EQ(library.watched[1].fd, 8);
    EXPECT_EQ(library.watched[0].events, POLLIN);
    EXPECT_EQ(library.watched[1].events, POLLIN);
    EXPECT_EQ(roburoc4_os_wait(ROBUROC4_OS_NO_SOCKET, ROBUROC4_OS_NO_SOCKET, 1), ROBUROC4_OK);
    EXPECT_LT(library.watched[0].fd, 0);
    EXPECT_LT(library.watched[1].fd, 0);
}

TEST_F(Posix, AWaitEndsWellAfterASignalAndBadlyWithoutASocket) {
    library.errors["ppoll"] = EINTR;
    EXPECT_EQ(roburoc4_os_wait(7, 8, 1000), ROBUROC4_OK);
    for (const int error : {ENOMEM, EINVAL, EFAULT}) {
        library.errors["ppoll"] = error;
        EXPECT_EQ(roburoc4_os_wait(7, 8, 1000), ROBUROC4_ERR_SYSTEM) << std::strerror(error);
    }
    library.errors.clear();
    for (const int which : {0, 1}) {
        library.ready[which] = POLLNVAL;
        EXPECT_EQ(roburoc4_os_wait(7, 8, 1000), ROBUROC4_ERR_SYSTEM) << which;
        library.ready[which] = POLLERR; /* receiving reports it */
        EXPECT_EQ(roburoc4_os_wait(7, 8, 1000), ROBUROC4_OK) << which;
        library.ready[which] = 0;
    }
}

/* ----------------------------------------------------------------------------------- names --- */

TEST_F(Posix, ANumberIsNoQuestionForANameServer) {
    library.names["10.0.0.7"] = {system_v4("10.0.0.7")};
    roburoc4_address found{};
    EXPECT_EQ(roburoc4_os_resolve("10.0.0.7", 99, &found), ROBUROC4_OK);
    EXPECT_EQ(found.port, 99);
    EXPECT_TRUE(library.asked.empty());
    EXPECT_EQ(roburoc4_os_resolve("10.0.0.8", 99, &found), ROBUROC4_ERR_RESOLVE);
}

TEST_F(Posix, ANameGivesItsFirstIPv4AddressElseItsFirstIPv6Address) {
    library.names["robot"] = {system_v6("fe80::1", 3), system_v4("10.0.0.1"),
                              system_v4("10.0.0.2")};
    library.names["six"] = {system_v6("fe80::5", 4), system_v6("fe80::6", 4)};
    sockaddr_storage other{};
    other.ss_family = AF_UNIX;
    library.names["neither"] = {other};
    roburoc4_address found{};
    EXPECT_EQ(roburoc4_os_resolve("robot", 99, &found), ROBUROC4_OK);
    EXPECT_EQ(library.asked, std::vector<std::string>{"robot"});
    EXPECT_EQ(found.family, 4);
    EXPECT_EQ(found.ip[3], 1);
    EXPECT_EQ(found.port, 99);
    EXPECT_EQ(roburoc4_os_resolve("six", 98, &found), ROBUROC4_OK);
    EXPECT_EQ(found.family, 6);
    EXPECT_EQ(found.ip[15], 5);
    EXPECT_EQ(found.scope, 4u);
    EXPECT_EQ(found.port, 98);
    for (const char *name : {"neither", "nobody"}) {
        EXPECT_EQ(roburoc4_os_resolve(name, 1, &found), ROBUROC4_ERR_RESOLVE) << name;
    }
}

/* ----------------------------------------------------------------------------------- clock --- */

TEST_F(Posix, TheClockCountsWhileTheMachineSleeps) {
    library.clocks = {{CLOCK_BOOTTIME, {5, 123456789}},
                      {CLOCK_MONOTONIC, {4, 999999999}},
                      {CLOCK_REALTIME, {1767323045, 0}}};
    EXPECT_EQ(roburoc4_udp_now_us(), 5123456u);
    library.clocks.erase(CLOCK_BOOTTIME);
    EXPECT_EQ(roburoc4_udp_now_us(), 4999999u) << "an old kernel";
    EXPECT_EQ(roburoc4_os_calendar_us(), 1767323045000000u);
}

/* ----------------------------------------------------------------------------------- files --- */

/* With files and descriptors of the system. */
class PosixFiles : public Posix {
  protected:
    void SetUp() override {
        Posix::SetUp();
        library.real = true;
        free_descriptor_ = lowest_descriptor();
        ASSERT_NE(mkdtemp(folder_), nullptr);
    }
    void TearDown() override {
        library.real = false;
        for (const char *name : {"/run", "/pipe"}) {
            (void)unlink((folder_ + std::string(name)).c_str());
        }
        EXPECT_EQ(rmdir(folder_), 0);
        EXPECT_EQ(lowest_descriptor(), free_descriptor_) << "one was not closed";
    }
    static int lowest_descriptor() {
        const int fd = dup(STDERR_FILENO);
        close(fd);
        return fd;
    }
    char folder_[64] = "/tmp/roburoc4-posix-XXXXXX";
    int free_descriptor_ = 0;
};

TEST_F(PosixFiles, AFileIsNeverOverwritten) {
    const std::string path = folder_ + std::string("/run");
    EXPECT_EQ(roburoc4_os_path_kind(path.c_str()), ROBUROC4_OS_FILE) << "nothing yet";
    const int64_t file = roburoc4_os_file_create(path.c_str());
    ASSERT_NE(file, ROBUROC4_OS_NO_FILE);
    EXPECT_NE(fcntl(static_cast<int>(file), F_GETFD) & FD_CLOEXEC, 0);
    const uint8_t bytes[] = {1, 2, 3};
    EXPECT_EQ(roburoc4_os_file_write(file, bytes, 3), 3u);
    roburoc4_os_file_truncate(file, 2);
    EXPECT_EQ(lseek(static_cast<int>(file), 0, SEEK_END), 2);
    roburoc4_os_file_close(file);
    EXPECT_EQ(roburoc4_os_file_write(file, bytes, 3), 0u);
    EXPECT_EQ(errno, EBADF);
    EXPECT_EQ(roburoc4_os_path_kind(path.c_str()), ROBUROC4_OS_FILE);
    EXPECT_EQ(roburoc4_os_file_create(path.c_str()), ROBUROC4_OS_NO_FILE);
    EXPECT_EQ(errno, EEXIST);
    EXPECT_EQ(roburoc4_os_path_kind(folder_), ROBUROC4_OS_FOLDER);
}

TEST_F(PosixFiles, APipeIsNotWaitedForButWrittenToHoweverSlowItsReaderIs) {
    const std::string path = folder_ + std::string("/pipe");
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
    EXPECT_EQ(roburoc4_os_path_kind(path.c_str()), ROBUROC4_OS_STREAM);
    EXPECT_EQ(roburoc4_os_file_create(path.c_str()), ROBUROC4_OS_NO_FILE) << "no reader";
    EXPECT_EQ(errno, ENXIO);
    const int reader = open(path.c_str(), O_RDONLY | O_NONBLOCK);
    const int64_t file = roburoc4_os_file_create(path.c_str());
    ASSERT_NE(file, ROBUROC4_OS_NO_FILE);
    EXPECT_EQ(fcntl(static_cast<int>(file), F_GETFL) & O_NONBLOCK, 0);
    roburoc4_os_file_close(file);
    close(reader);
}

TEST_F(Posix, AFileIsNamedInUniversalTime) {
    setenv("TZ", "XXX-5", 1);
    tzset();
    char text[17];
    roburoc4_os_calendar_text(1767323045999999, text);
    EXPECT_STREQ(text, "20260102T030405Z");
    unsetenv("TZ");
    tzset();
}

/* ----------------------------------------------------------------------- locks and threads --- */

bool is_cancellable() {
    int state = 0, ignored = 0;
    pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, &state);
    pthread_setcancelstate(state, &ignored);
    return state == PTHREAD_CANCEL_ENABLE;
}

TEST_F(Posix, AThreadIsNotCancelledWhileItHasALockNorAfterwardsWhereItForbadeThat) {
    roburoc4_lock first, second;
    library.errors["attributes"] = ENOTSUP; /* no inheritance of priorities */
    ASSERT_EQ(roburoc4_lock_create(&first), 1);
    library.errors.clear();
    ASSERT_EQ(roburoc4_lock_create(&second), 1);
    int ignored = 0;
    for (const bool allowed : {false, true}) {
        pthread_setcancelstate(allowed ? PTHREAD_CANCEL_ENABLE : PTHREAD_CANCEL_DISABLE, &ignored);
        roburoc4_lock_take(&first);
        roburoc4_lock_take(&second);
        EXPECT_FALSE(is_cancellable());
        roburoc4_lock_give(&first); /* not in the reverse order */
        EXPECT_FALSE(is_cancellable());
        roburoc4_lock_give(&second);
        EXPECT_EQ(is_cancellable(), allowed);
    }
    roburoc4_lock_destroy(&first);
    roburoc4_lock_destroy(&second);
    library.errors["mutex"] = ENOMEM;
    EXPECT_EQ(roburoc4_lock_create(&first), 0);
}

TEST_F(Posix, AWaitForASignalIsNoLongerWhenSomebodySetsTheClock) {
    roburoc4_signal signal;
    roburoc4_lock lock;
    library.errors["setclock"] = EINVAL;
    EXPECT_EQ(roburoc4_signal_create(&signal), 0);
    library.errors.clear();
    ASSERT_EQ(roburoc4_signal_create(&signal), 1);
    ASSERT_EQ(roburoc4_lock_create(&lock), 1);
    EXPECT_EQ(library.signal_clock, CLOCK_MONOTONIC);
    library.clocks = {{CLOCK_MONOTONIC, {10, 999999999}}};
    roburoc4_signal_wait(&signal, &lock, 2500000);
    EXPECT_EQ(library.signal_until.tv_sec, 13);
    EXPECT_EQ(library.signal_until.tv_nsec, 499999000);
    roburoc4_signal_wait(&signal, &lock, UINT64_MAX);
    EXPECT_EQ(library.signal_until.tv_sec, 10 + 3600);
    roburoc4_signal_destroy(&signal);
    roburoc4_lock_destroy(&lock);
}

struct Started {
    std::promise<void> may_end;
    sigset_t mask;
};

void take_a_look(void *argument) {
    auto *started = static_cast<Started *>(argument);
    pthread_sigmask(SIG_BLOCK, nullptr, &started->mask);
    started->may_end.get_future().wait();
}

TEST_F(Posix, AThreadTakesNoSignalsAndSaysWhenItIsOver) {
    Started started;
    roburoc4_thread thread{};
    EXPECT_EQ(roburoc4_thread_is_over(&thread), 1) << "it never started";
    library.errors["thread"] = EAGAIN;
    EXPECT_EQ(roburoc4_thread_start(&thread, take_a_look, &started), 0);
    EXPECT_EQ(errno, EAGAIN);
    library.errors.clear();
    thread.over.number = 1; /* of an earlier thread */
    ASSERT_EQ(roburoc4_thread_start(&thread, take_a_look, &started), 1);
    EXPECT_EQ(roburoc4_thread_is_over(&thread), 0);
    started.may_end.set_value();
    roburoc4_thread_join(&thread);
    EXPECT_EQ(roburoc4_thread_is_over(&thread), 1);
    EXPECT_EQ(sigismember(&started.mask, SIGINT), 1);
    sigset_t mine;
    pthread_sigmask(SIG_BLOCK, nullptr, &mine);
    EXPECT_EQ(sigismember(&mine, SIGINT), 0);
}

TEST_F(PosixFiles, AWakeNeverBlocksKeepsErrnoAndIsClearedAtOnce) {
    roburoc4_wake wake;
    for (const char *call : {"F_SETFD", "F_SETFL"}) {
        library.errors[call] = EINVAL;
        EXPECT_EQ(roburoc4_wake_create(&wake), 0);
        EXPECT_EQ(lowest_descriptor(), free_descriptor_);
        library.errors.clear();
    }
    ASSERT_EQ(roburoc4_wake_create(&wake), 1);
    for (const int64_t end : {wake.wait_on, wake.write_to}) {
        EXPECT_NE(fcntl(static_cast<int>(end), F_GETFL) & O_NONBLOCK, 0);
        EXPECT_NE(fcntl(static_cast<int>(end), F_GETFD) & FD_CLOEXEC, 0);
    }
    errno = E2BIG;
    for (int i = 0; i < 70000; i++) { /* more than a pipe holds */
        roburoc4_wake_raise(&wake);
    }
    EXPECT_EQ(errno, E2BIG);
    pollfd end{static_cast<int>(wake.wait_on), POLLIN, 0};
    EXPECT_EQ(poll(&end, 1, 0), 1);
    roburoc4_wake_clear(&wake);
    EXPECT_EQ(poll(&end, 1, 0), 0);
    roburoc4_wake_destroy(&wake);
}

} // namespace
