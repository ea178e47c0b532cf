/* SPDX-License-Identifier: MIT
 *
 * net.h on POSIX systems.
 */
#define _GNU_SOURCE /* struct in_pktinfo and friends beside POSIX */
#include "net.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "net_peer.h"

#define SPARE_DESCRIPTORS 32
/* Room for the statuses of many peers that leave in one cycle. */
#define SOCKET_BUFFER_BYTES 262144

struct net_sockets {
    size_t count;
    struct pollfd *polls; /* one for each socket, then standard input */
};

static bool allow_descriptors(size_t wanted) {
    struct rlimit limit;
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= wanted) {
        return true;
    }
    if (limit.rlim_max < wanted) {
        return false;
    }
    limit.rlim_cur = (rlim_t)wanted;
    return setrlimit(RLIMIT_NOFILE, &limit) == 0;
}

net_sockets *net_create(size_t sockets) {
    if (!allow_descriptors(sockets + SPARE_DESCRIPTORS)) {
        return NULL;
    }
    net_sockets *created = calloc(1, sizeof *created);
    if (created == NULL) {
        return NULL;
    }
    created->polls = calloc(sockets + 1, sizeof *created->polls);
    if (created->polls == NULL) {
        free(created);
        return NULL;
    }
    created->count = sockets;
    for (size_t index = 0; index <= sockets; index++) {
        created->polls[index].fd = -1;
        created->polls[index].events = POLLIN;
    }
    return created;
}

void net_destroy(net_sockets *net) {
    for (size_t index = 0; index < net->count; index++) {
        if (net->polls[index].fd >= 0) {
            (void)close(net->polls[index].fd);
        }
    }
    free(net->polls);
    free(net);
}

/* -------------------------------------------------------------------------------- addresses --- */

bool net_is_address(const char *address) {
    struct in_addr parsed;
    return inet_pton(AF_INET, address, &parsed) == 1;
}

void net_error_text(int error, char *text, size_t capacity) {
    (void)snprintf(text, capacity, "%s", strerror(error));
}

/* ---------------------------------------------------------------------------------- sockets --- */

static int set_up(int fd) {
    int size = SOCKET_BUFFER_BYTES;
    (void)setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
    (void)setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &size, sizeof size);
#ifdef IP_RECVERR
    /* Without it an unconnected socket never learns that a port is closed. */
    int on = 1;
    (void)setsockopt(fd, IPPROTO_IP, IP_RECVERR, &on, sizeof on);
#endif
    int flags = fcntl(fd, F_GETFL, 0);
    if (flags < 0 || fcntl(fd, F_SETFL, flags | O_NONBLOCK) != 0 ||
        fcntl(fd, F_SETFD, FD_CLOEXEC) != 0) {
        return errno;
    }
    return 0;
}

int net_bind(net_sockets *net, size_t index, const char *address, uint16_t port, uint16_t *bound) {
    struct sockaddr_in own;
    memset(&own, 0, sizeof own);
    own.sin_family = AF_INET;
    own.sin_port = htons(port);
    if (inet_pton(AF_INET, address, &own.sin_addr) != 1) {
        return EINVAL;
    }
    int fd = socket(AF_INET, SOCK_DGRAM, 0);
    if (fd < 0) {
        return errno;
    }
    net->polls[index].fd = fd;
    socklen_t length = sizeof own;
    int error = set_up(fd);
    if (error == 0 && (bind(fd, (const struct sockaddr *)&own, sizeof own) != 0 ||
                       getsockname(fd, (struct sockaddr *)&own, &length) != 0)) {
        error = errno;
    }
    *bound = ntohs(own.sin_port);
    return error;
}

void net_wait(net_sockets *net, bool input, uint64_t timeout_us) {
    uint64_t timeout_ms = (timeout_us + 999) / 1000;
    net->polls[net->count].fd = input ? STDIN_FILENO : -1;
    if (poll(net->polls, (nfds_t)(net->count + 1), timeout_ms < 1000 ? (int)timeout_ms : 1000) <
        0) {
        for (size_t index = 0; index <= net->count; index++) {
            net->polls[index].revents = 0;
        }
    }
}

bool net_is_ready(const net_sockets *net, size_t index) {
    return net->polls[index].revents != 0;
}

ptrdiff_t net_receive(net_sockets *net, size_t index, uint64_t *peer, uint8_t *buffer,
                      size_t capacity) {
    struct sockaddr_in from;
    memset(&from, 0, sizeof from);
    socklen_t length = sizeof from;
    ssize_t size =
        recvfrom(net->polls[index].fd, buffer, capacity, 0, (struct sockaddr *)&from, &length);
    if (size < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) {
        /* The pending error of an earlier datagram; reading it cleared it. */
        size =
            recvfrom(net->polls[index].fd, buffer, capacity, 0, (struct sockaddr *)&from, &length);
    }
    if (size < 0) {
        return -1;
    }
    *peer = net_peer_of(&from);
    return (ptrdiff_t)size;
}

void net_send(net_sockets *net, size_t index, uint64_t peer, const uint8_t *data, size_t size) {
    struct sockaddr_in to = net_address_of(peer);
    /* The first attempt may report only that an earlier datagram was refused. */
    for (int attempt = 0; attempt < 2; attempt++) {
        if (sendto(net->polls[index].fd, data, size, 0, (const struct sockaddr *)&to, sizeof to) >=
                0 ||
            errno == EAGAIN || errno == EWOULDBLOCK) {
            return;
        }
    }
}

bool net_refused(net_sockets *net, size_t index, uint64_t *peer) {
#ifdef IP_RECVERR
    struct sockaddr_in to;
    uint8_t start; /* of the refused datagram; emulators need a buffer here */
    struct iovec place = {&start, sizeof start};
    struct msghdr message;
    memset(&message, 0, sizeof message);
    message.msg_iov = &place;
    message.msg_iovlen = 1;
    memset(&to, 0, sizeof to);
    message.msg_name = &to;
    message.msg_namelen = sizeof to;
    if (recvmsg(net->polls[index].fd, &message, MSG_ERRQUEUE) >= 0) {
        *peer = net_peer_of(&to);
        return true;
    }
#else
    (void)net;
    (void)index;
    (void)peer;
#endif
    return false;
}

ptrdiff_t net_read_input(net_sockets *net, char *buffer, size_t capacity) {
    if (net->polls[net->count].revents == 0) {
        return 0;
    }
    ssize_t size = read(STDIN_FILENO, buffer, capacity);
    if (size < 0) {
        return errno == EINTR || errno == EAGAIN || errno == EWOULDBLOCK ? 0 : -1;
    }
    return size == 0 ? -1 : (ptrdiff_t)size;
}

uint64_t net_now_us(void) {
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

static volatile sig_atomic_t stop_wanted;

static void want_stop(int signal_number) {
    (void)signal_number;
    stop_wanted = 1;
}

void net_listen_for_stop(void) {
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = want_stop;
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(SIGINT, &action, NULL);
    (void)sigaction(SIGTERM, &action, NULL);
}

bool net_stop_wanted(void) {
    return stop_wanted != 0;
}
