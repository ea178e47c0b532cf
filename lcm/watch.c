/* SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "watch.h"

#include <stddef.h>

#if defined(__linux__)
#include <sys/epoll.h>

static int watcher = -1;
static int watched[WATCH_MAX]; /* descriptor + 1; 0: none */

bool watch_begin(void) {
    watcher = epoll_create1(EPOLL_CLOEXEC);
    return watcher >= 0;
}

void watch_set(uint32_t number, int fd) {
    struct epoll_event event = {.events = EPOLLIN, .data = {.u32 = number}};
    if (watched[number] == fd + 1) {
        return;
    }
    if (watched[number] != 0) {
        (void)epoll_ctl(watcher, EPOLL_CTL_DEL, watched[number] - 1, NULL);
    }
    watched[number] = fd >= 0 && epoll_ctl(watcher, EPOLL_CTL_ADD, fd, &event) == 0 ? fd + 1 : 0;
}

uint32_t watch_wait(int wait_ms, uint32_t *ready) {
    static struct epoll_event events[WATCH_MAX];
    int count = epoll_wait(watcher, events, WATCH_MAX, wait_ms);
    for (int at = 0; at < count; at++) {
        ready[at] = events[at].data.u32;
    }
    return count > 0 ? (uint32_t)count : 0;
}

#else
#include <poll.h>

static struct pollfd watched[WATCH_MAX];

bool watch_begin(void) {
    for (uint32_t at = 0; at < WATCH_MAX; at++) {
        watched[at].fd = -1;
        watched[at].events = POLLIN;
    }
    return true;
}

void watch_set(uint32_t number, int fd) {
    watched[number].fd = fd;
}

uint32_t watch_wait(int wait_ms, uint32_t *ready) {
    uint32_t count = 0;
    if (poll(watched, WATCH_MAX, wait_ms) > 0) {
        for (uint32_t at = 0; at < WATCH_MAX; at++) {
            if (watched[at].revents != 0) {
                ready[count++] = at;
            }
        }
    }
    return count;
}
#endif
