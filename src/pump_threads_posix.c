/* SPDX-License-Identifier: MIT
 *
 * pump_threads_posix.c - threads, locks and wake-ups of Linux, macOS and the BSDs for the pump.
 */
#define _GNU_SOURCE 1
#define _DARWIN_C_SOURCE 1 /* pthread_cond_timedwait_relative_np */
#include "pump_threads.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#define LONGEST_WAIT_US 3600000000u

int64_t roburoc4_process_id(void) {
    return getpid();
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

void roburoc4_lock_take(roburoc4_lock *lock) {
    (void)pthread_mutex_lock(lock);
}

void roburoc4_lock_give(roburoc4_lock *lock) {
    (void)pthread_mutex_unlock(lock);
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

typedef struct start {
    void (*function)(void *);
    void *argument;
} start;

static void *run(void *argument) {
    start begin = *(start *)argument;
    free(argument);
    begin.function(begin.argument);
    return NULL;
}

int roburoc4_thread_start(roburoc4_thread *thread, void (*function)(void *), void *argument) {
    start *begin = malloc(sizeof *begin);
    sigset_t all, before;
    int error;
    if (begin == NULL) {
        return 0;
    }
    begin->function = function;
    begin->argument = argument;
    /* The new thread inherits the mask: handlers are for the program's own threads. */
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    error = pthread_create(thread, NULL, run, begin);
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (error != 0) {
        free(begin);
        errno = error;
    }
    return error == 0;
}

void roburoc4_thread_join(roburoc4_thread *thread) {
    (void)pthread_join(*thread, NULL);
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
    ssize_t written = write((int)wake->write_to, "", 1);
    (void)written; /* a full pipe wakes as well */
}

void roburoc4_wake_clear(const roburoc4_wake *wake) {
    char bytes[64];
    while (read((int)wake->wait_on, bytes, sizeof bytes) == (ssize_t)sizeof bytes) {
    }
}
