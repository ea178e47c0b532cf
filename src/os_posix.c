/* SPDX-License-Identifier: MIT
 *
 * os.h on Linux, macOS and the BSDs.
 */
#define _GNU_SOURCE 1      /* ppoll, CLOCK_BOOTTIME */
#define _DARWIN_C_SOURCE 1 /* hidden by -std=c99 on macOS */
#include "os_socket.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/ip.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#ifdef __APPLE__
#include <mach/mach_time.h>
#endif

/* ----------------------------------------------------------------------------------- clock --- */

#ifdef __APPLE__

uint64_t roburoc4_udp_now_us(void) {
    mach_timebase_info_data_t base;
    uint64_t ticks = mach_continuous_time();
    (void)mach_timebase_info(&base);
    /* in two parts, as ticks * numer would overflow after some days */
    return (ticks / base.denom * base.numer + ticks % base.denom * base.numer / base.denom) / 1000;
}

#else

uint64_t roburoc4_udp_now_us(void) {
    struct timespec now = {0, 0};
#ifdef CLOCK_BOOTTIME
    if (clock_gettime(CLOCK_BOOTTIME, &now) != 0)
#endif
    {
        (void)clock_gettime(CLOCK_MONOTONIC, &now);
    }
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

#endif

/* ------------------------------------------------------------------------------- addresses --- */

roburoc4_result roburoc4_os_resolve(const char *host, uint16_t port, roburoc4_address *out) {
    return look_up(host, port, out);
}

int roburoc4_os_ip_text(const roburoc4_address *address, char *buffer, size_t capacity) {
    int family = address->family == 4 ? AF_INET : AF_INET6;
    return inet_ntop(family, address->ip, buffer, (socklen_t)capacity) != NULL;
}

/* ----------------------------------------------------------------------------------- socket --- */

static uint32_t fault_of(int error) {
    switch (error) {
    case ECONNREFUSED:
    case ECONNRESET:
        return ROBUROC4_FAULT_REFUSED;
    case ENETUNREACH:
    case EHOSTUNREACH:
    case EHOSTDOWN:
        return ROBUROC4_FAULT_UNREACHABLE;
    case ENETDOWN:
    case ENETRESET:
    case ENODEV:
    case ENXIO:
    case EADDRNOTAVAIL:
    case EINVAL: /* Linux, when the address that the socket sends from was taken away */
        return ROBUROC4_FAULT_DOWN;
    case EPERM:
    case EACCES:
        return ROBUROC4_FAULT_DENIED;
    case EAGAIN:
#if EWOULDBLOCK != EAGAIN
    case EWOULDBLOCK:
#endif
    case EINTR:
    case ENOBUFS:
    case ENOMEM:
        return ROBUROC4_FAULT_FULL;
    default:
        return ROBUROC4_FAULT_OTHER;
    }
}

/* Optional: everything works without them. */
static void tune(int fd, uint8_t family) {
    int receive_bytes = RECEIVE_BUFFER_BYTES, send_bytes = SEND_BUFFER_BYTES;
    (void)setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
    (void)setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &send_bytes, sizeof send_bytes);
#ifdef IPTOS_LOWDELAY
    if (family == 4) {
        int low_delay = IPTOS_LOWDELAY;
        (void)setsockopt(fd, IPPROTO_IP, IP_TOS, &low_delay, sizeof low_delay);
    }
#else
    (void)family;
#endif
}

int64_t roburoc4_os_socket(const roburoc4_address *address, roburoc4_os_outcome *outcome) {
    int fd = socket(address->family == 4 ? AF_INET : AF_INET6, SOCK_DGRAM, 0);
    if (fd < 0) {
        *outcome = failure(errno);
        return ROBUROC4_OS_NO_SOCKET;
    }
    if (fcntl(fd, F_SETFD, FD_CLOEXEC) != 0 || fcntl(fd, F_SETFL, O_NONBLOCK) != 0) {
        *outcome = failure(errno);
        (void)close(fd);
        return ROBUROC4_OS_NO_SOCKET;
    }
    tune(fd, address->family);
    *outcome = success;
    return fd;
}

void roburoc4_os_close(int64_t socket) {
    (void)close((int)socket);
}

roburoc4_os_outcome roburoc4_os_connect(int64_t socket, const roburoc4_address *address) {
    struct sockaddr nobody;
    memset(&nobody, 0, sizeof nobody);
    nobody.sa_family = AF_UNSPEC;
    return reconnect(socket, &nobody, sizeof nobody, address);
}

roburoc4_os_outcome roburoc4_os_send(int64_t socket, const uint8_t *datagram, size_t size) {
    return send((int)socket, datagram, size, 0) < 0 ? failure(errno) : success;
}

#ifdef __linux__
/* Linux returns a datagram's whole length on request, which is faster than recvmsg(). */
static ssize_t receive(int fd, uint8_t *buffer, size_t capacity, bool *truncated) {
    const ssize_t got = recv(fd, buffer, capacity, MSG_TRUNC);
    *truncated = got > 0 && (size_t)got > capacity;
    return got;
}
#else
static ssize_t receive(int fd, uint8_t *buffer, size_t capacity, bool *truncated) {
    struct iovec part;
    struct msghdr message;
    memset(&message, 0, sizeof message);
    part.iov_base = buffer;
    part.iov_len = capacity;
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    const ssize_t got = recvmsg(fd, &message, 0);
    *truncated = (message.msg_flags & MSG_TRUNC) != 0;
    return got;
}
#endif

int roburoc4_os_receive(int64_t socket, uint8_t *buffer, size_t capacity, size_t *size,
                        roburoc4_os_outcome *outcome) {
    bool truncated = false;
    const ssize_t got = receive((int)socket, buffer, capacity, &truncated);
    if (got >= 0) {
        *size = (size_t)got;
        return truncated ? ROBUROC4_OS_OVERSIZED : ROBUROC4_OS_DATAGRAM;
    }
    *outcome = failure(errno);
    if (outcome->system_error == EBADF || outcome->system_error == ENOTSOCK) {
        return ROBUROC4_OS_BROKEN;
    }
    return outcome->fault == ROBUROC4_FAULT_FULL ? ROBUROC4_OS_EMPTY : ROBUROC4_OS_FAULT;
}

roburoc4_result roburoc4_os_wait(int64_t socket, int64_t wake, uint64_t timeout_us) {
    struct pollfd watched[2];
    int ready;
    uint64_t us = timeout_us < LONGEST_WAIT_US ? timeout_us : LONGEST_WAIT_US;
    watched[0].fd = (int)socket; /* poll() ignores negative ones */
    watched[1].fd = (int)wake;
    watched[0].events = watched[1].events = POLLIN;
    watched[0].revents = watched[1].revents = 0;
#ifdef __linux__
    {
        struct timespec timeout;
        timeout.tv_sec = (time_t)(us / 1000000u);
        timeout.tv_nsec = (long)(us % 1000000u * 1000u);
        ready = ppoll(watched, 2, &timeout, NULL);
    }
#else
    ready = poll(watched, 2, (int)((us + 999u) / 1000u));
#endif
    if ((ready < 0 && errno != EINTR) || ((watched[0].revents | watched[1].revents) & POLLNVAL)) {
        return ROBUROC4_ERR_SYSTEM;
    }
    return ROBUROC4_OK;
}

/* ----------------------------------------------------------------------------------- files --- */

uint64_t roburoc4_os_calendar_us(void) {
    struct timespec now = {0, 0};
    (void)clock_gettime(CLOCK_REALTIME, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

void roburoc4_os_calendar_text(uint64_t calendar_us, char text[17]) {
    time_t seconds = (time_t)(calendar_us / 1000000u);
    struct tm parts;
    memset(&parts, 0, sizeof parts);
    (void)gmtime_r(&seconds, &parts);
    (void)strftime(text, 17, "%Y%m%dT%H%M%SZ", &parts);
}

int roburoc4_os_path_kind(const char *path) {
    struct stat found;
    if (stat(path, &found) != 0 || S_ISREG(found.st_mode)) {
        return ROBUROC4_OS_FILE;
    }
    return S_ISDIR(found.st_mode) ? ROBUROC4_OS_FOLDER : ROBUROC4_OS_STREAM;
}

int64_t roburoc4_os_file_create(const char *path) {
    int flags = O_WRONLY | O_CLOEXEC;
    int fd;
    if (roburoc4_os_path_kind(path) != ROBUROC4_OS_STREAM) {
        return open(path, flags | O_CREAT | O_EXCL, 0666);
    }
    fd = open(path, flags | O_NONBLOCK); /* does not wait for a reader of the pipe */
    if (fd >= 0) {
        (void)fcntl(fd, F_SETFL, 0);
    }
    return fd;
}

size_t roburoc4_os_file_write(int64_t file, const uint8_t *bytes, size_t size) {
    ssize_t written = write((int)file, bytes, size);
    return written < 0 ? 0 : (size_t)written;
}

void roburoc4_os_file_truncate(int64_t file, uint64_t size) {
    const int ignored = ftruncate((int)file, (off_t)size);
    (void)ignored;
}

void roburoc4_os_file_close(int64_t file) {
    (void)close((int)file);
}

/* --------------------------------------------------------------------------------- process --- */

int64_t roburoc4_process_id(void) {
    return getpid();
}

int roburoc4_atomic_exchange(roburoc4_atomic *atomic, int number) {
    return __atomic_exchange_n(&atomic->number, number, __ATOMIC_SEQ_CST);
}

int roburoc4_atomic_read(roburoc4_atomic *atomic) {
    return __atomic_load_n(&atomic->number, __ATOMIC_SEQ_CST);
}

/* ------------------------------------------------------------------------------------ lock --- */

int roburoc4_lock_create(roburoc4_lock *lock) {
    pthread_mutexattr_t attributes;
    int error = pthread_mutexattr_init(&attributes);
    if (error == 0) {
#if defined(_POSIX_THREAD_PRIO_INHERIT) && _POSIX_THREAD_PRIO_INHERIT > 0
        (void)pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
#endif
        error = pthread_mutex_init(lock, &attributes);
        (void)pthread_mutexattr_destroy(&attributes);
    }
    if (error != 0) {
        error = pthread_mutex_init(lock, NULL);
    }
    return error == 0;
}

void roburoc4_lock_destroy(roburoc4_lock *lock) {
    (void)pthread_mutex_destroy(lock);
}

/* A thread that is cancelled while it holds a lock would never release it. The locks are counted,
 * because they are not always released in reverse order. */
static __thread int locks_taken, cancel_state_before;

void roburoc4_lock_take(roburoc4_lock *lock) {
    int state;
    (void)pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, &state);
    if (locks_taken++ == 0) {
        cancel_state_before = state;
    }
    (void)pthread_mutex_lock(lock);
}

void roburoc4_lock_give(roburoc4_lock *lock) {
    int state;
    (void)pthread_mutex_unlock(lock);
    if (--locks_taken == 0) {
        (void)pthread_setcancelstate(cancel_state_before, &state);
    }
}

/* ---------------------------------------------------------------------------------- signal --- */

int roburoc4_signal_create(roburoc4_signal *signal) {
#ifdef __APPLE__
    return pthread_cond_init(signal, NULL) == 0;
#else
    pthread_condattr_t attributes;
    int error;
    if (pthread_condattr_init(&attributes) != 0) {
        return 0;
    }
    error = pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    if (error == 0) {
        error = pthread_cond_init(signal, &attributes);
    }
    (void)pthread_condattr_destroy(&attributes);
    return error == 0;
#endif
}

void roburoc4_signal_destroy(roburoc4_signal *signal) {
    (void)pthread_cond_destroy(signal);
}

void roburoc4_signal_wake_all(roburoc4_signal *signal) {
    (void)pthread_cond_broadcast(signal);
}

void roburoc4_signal_wait(roburoc4_signal *signal, roburoc4_lock *lock, uint64_t timeout_us) {
    uint64_t us = timeout_us < LONGEST_WAIT_US ? timeout_us : LONGEST_WAIT_US;
    struct timespec until = {0, 0};
#ifndef __APPLE__
    (void)clock_gettime(CLOCK_MONOTONIC, &until);
    us += (uint64_t)until.tv_nsec / 1000u;
#endif
    until.tv_sec += (time_t)(us / 1000000u);
    until.tv_nsec = (long)(us % 1000000u * 1000u);
#ifdef __APPLE__
    (void)pthread_cond_timedwait_relative_np(signal, lock, &until);
#else
    (void)pthread_cond_timedwait(signal, lock, &until);
#endif
}

/* ---------------------------------------------------------------------------------- thread --- */

static void *run(void *argument) {
    roburoc4_thread *thread = argument;
    thread->function(thread->argument);
    (void)roburoc4_atomic_exchange(&thread->over, 1);
    return NULL;
}

int roburoc4_thread_start(roburoc4_thread *thread, void (*function)(void *), void *argument) {
    sigset_t all, before;
    int error;
    thread->function = function;
    thread->argument = argument;
    (void)roburoc4_atomic_exchange(&thread->over, 0);
    /* The new thread inherits the mask: signal handlers run on the program's own threads. */
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    error = pthread_create(&thread->id, NULL, run, thread);
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (error != 0) {
        errno = error;
    }
    return error == 0;
}

int roburoc4_thread_is_over(roburoc4_thread *thread) {
    return thread->function == NULL || roburoc4_atomic_read(&thread->over) != 0;
}

void roburoc4_thread_join(roburoc4_thread *thread) {
    (void)pthread_join(thread->id, NULL);
}

/* ------------------------------------------------------------------------------------ wake --- */

static int prepare(int fd) {
    return fcntl(fd, F_SETFD, FD_CLOEXEC) == 0 && fcntl(fd, F_SETFL, O_NONBLOCK) == 0;
}

int roburoc4_wake_create(roburoc4_wake *wake) {
    int ends[2];
    if (pipe(ends) != 0) {
        return 0;
    }
    wake->wait_on = ends[0];
    wake->write_to = ends[1];
    if (!prepare(ends[0]) || !prepare(ends[1])) {
        roburoc4_wake_destroy(wake);
        return 0;
    }
    return 1;
}

void roburoc4_wake_destroy(roburoc4_wake *wake) {
    (void)close((int)wake->wait_on);
    (void)close((int)wake->write_to);
}

void roburoc4_wake_raise(const roburoc4_wake *wake) {
    const int error = errno;
    const ssize_t written = write((int)wake->write_to, "", 1);
    (void)written; /* a full pipe wakes, too */
    errno = error;
}

void roburoc4_wake_clear(const roburoc4_wake *wake) {
    char bytes[64];
    while (read((int)wake->wait_on, bytes, sizeof bytes) == (ssize_t)sizeof bytes) {
    }
}
