/* SPDX-License-Identifier: MIT
 *
 * pump_threads.h - the few things that pump.c needs of the operating system's threads: implemented
 * by pump_threads_posix.c and by pump_threads_windows.c, of which a build has one. Not public.
 */
#ifndef ROBUROC4_PUMP_THREADS_H
#define ROBUROC4_PUMP_THREADS_H

#include "roburoc4_udp.h"

#ifdef _WIN32
#include <winsock2.h> /* before windows.h, which else brings in its forerunner */

#include <windows.h>
typedef SRWLOCK roburoc4_lock;
typedef CONDITION_VARIABLE roburoc4_signal;
typedef HANDLE roburoc4_thread;
#else
#include <pthread.h>
typedef pthread_mutex_t roburoc4_lock;
typedef pthread_cond_t roburoc4_signal;
typedef pthread_t roburoc4_thread;
#endif

/** Of this process: another one after fork(). */
int64_t roburoc4_process_id(void);

/** A mutual exclusion that lends a waiting thread's priority to its owner where the system can.
 *  0 where there is none to be had. */
int roburoc4_lock_create(roburoc4_lock *lock);
void roburoc4_lock_destroy(roburoc4_lock *lock);
void roburoc4_lock_take(roburoc4_lock *lock);
void roburoc4_lock_give(roburoc4_lock *lock);

/** What threads wait for while they lend the lock; 0 where there is none to be had. */
int roburoc4_signal_create(roburoc4_signal *signal);
void roburoc4_signal_destroy(roburoc4_signal *signal);
void roburoc4_signal_wake_all(roburoc4_signal *signal);
/** Returns after a wake_all, or timeout_us, or for no reason. */
void roburoc4_signal_wait(roburoc4_signal *signal, roburoc4_lock *lock, uint64_t timeout_us);

/** Runs function(argument) on a thread that no signal handler interrupts. 0 where it cannot. */
int roburoc4_thread_start(roburoc4_thread *thread, void (*function)(void *), void *argument);
/** Waits for the thread's end. */
void roburoc4_thread_join(roburoc4_thread *thread);

/** Ends a roburoc4_os_wait() from another thread. */
typedef struct roburoc4_wake {
    int64_t wait_on; /* for roburoc4_os_wait() */
    int64_t write_to;
} roburoc4_wake;

/** 0 where there is none to be had. */
int roburoc4_wake_create(roburoc4_wake *wake);
void roburoc4_wake_destroy(roburoc4_wake *wake);
void roburoc4_wake_raise(const roburoc4_wake *wake);
/** Forget what was raised. */
void roburoc4_wake_clear(const roburoc4_wake *wake);

#endif
