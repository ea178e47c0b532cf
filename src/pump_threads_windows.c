/* SPDX-License-Identifier: MIT
 *
 * pump_threads_windows.c - threads, locks and wake-ups of Windows (Vista and later) for the pump.
 */
#define WIN32_LEAN_AND_MEAN
#ifndef _WIN32_WINNT
#define _WIN32_WINNT 0x0600
#endif
#include "pump_threads.h"
#include "udp_os.h"

#include <process.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST_WAIT_US 3600000000u

int64_t roburoc4_process_id(void) {
    return (int64_t)GetCurrentProcessId();
}

/* ------------------------------------------------------------------------- lock and signal --- */

int roburoc4_lock_create(roburoc4_lock *lock) {
    InitializeSRWLock(lock);
    return 1;
}

void roburoc4_lock_destroy(roburoc4_lock *lock) {
    (void)lock; /* holds nothing */
}

void roburoc4_lock_take(roburoc4_lock *lock) {
    AcquireSRWLockExclusive(lock);
}

void roburoc4_lock_give(roburoc4_lock *lock) {
    ReleaseSRWLockExclusive(lock);
}

int roburoc4_signal_create(roburoc4_signal *signal) {
    InitializeConditionVariable(signal);
    return 1;
}

void roburoc4_signal_destroy(roburoc4_signal *signal) {
    (void)signal; /* holds nothing */
}

void roburoc4_signal_wake_all(roburoc4_signal *signal) {
    WakeAllConditionVariable(signal);
}

void roburoc4_signal_wait(roburoc4_signal *signal, roburoc4_lock *lock, uint64_t timeout_us) {
    uint64_t us = timeout_us < LONGEST_WAIT_US ? timeout_us : LONGEST_WAIT_US;
    (void)SleepConditionVariableSRW(signal, lock, (DWORD)((us + 999u) / 1000u), 0);
}

/* ---------------------------------------------------------------------------------- thread --- */

typedef struct start {
    void (*function)(void *);
    void *argument;
} start;

static unsigned __stdcall run(void *argument) {
    start begin = *(start *)argument;
    free(argument);
    begin.function(begin.argument);
    return 0;
}

int roburoc4_thread_start(roburoc4_thread *thread, void (*function)(void *), void *argument) {
    start *begin = malloc(sizeof *begin);
    uintptr_t handle;
    if (begin == NULL) {
        return 0;
    }
    begin->function = function;
    begin->argument = argument;
    handle = _beginthreadex(NULL, 0, run, begin, 0, NULL);
    if (handle == 0) {
        free(begin);
        return 0;
    }
    *thread = (HANDLE)handle;
    return 1;
}

void roburoc4_thread_join(roburoc4_thread *thread) {
    (void)WaitForSingleObject(*thread, INFINITE);
    (void)CloseHandle(*thread);
}

/* ------------------------------------------------------------------------------------ wake --- */

/* select() watches sockets only: so the wake is one that is connected to itself on the loopback. */
int roburoc4_wake_create(roburoc4_wake *wake) {
    roburoc4_address loopback;
    roburoc4_os_outcome outcome;
    struct sockaddr_in own;
    int length = (int)sizeof own;
    memset(&loopback, 0, sizeof loopback);
    loopback.family = 4;
    memset(&own, 0, sizeof own);
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    wake->wait_on = wake->write_to = roburoc4_os_socket(&loopback, &outcome);
    if (wake->wait_on == ROBUROC4_OS_NO_SOCKET) {
        return 0;
    }
    if (bind((SOCKET)wake->wait_on, (const struct sockaddr *)&own, length) != 0 ||
        getsockname((SOCKET)wake->wait_on, (struct sockaddr *)&own, &length) != 0 ||
        connect((SOCKET)wake->wait_on, (const struct sockaddr *)&own, length) != 0) {
        roburoc4_wake_destroy(wake);
        return 0;
    }
    return 1;
}

void roburoc4_wake_destroy(roburoc4_wake *wake) {
    roburoc4_os_close(wake->wait_on);
}

void roburoc4_wake_raise(const roburoc4_wake *wake) {
    (void)roburoc4_os_send(wake->write_to, (const uint8_t *)"", 1);
}

void roburoc4_wake_clear(const roburoc4_wake *wake) {
    uint8_t byte[1];
    size_t size;
    roburoc4_os_outcome outcome;
    while (roburoc4_os_receive(wake->wait_on, byte, sizeof byte, &size, &outcome) ==
           ROBUROC4_OS_DATAGRAM) {
    }
}
