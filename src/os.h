/* SPDX-License-Identifier: MIT
 *
 * What the UDP adapter, the pump and the simulator's host need from the operating system: sockets,
 * addresses and the clock; threads, locks and wake-ups. os_posix.c or os_windows.c implements it; a
 * build has one of them. Not public.
 */
#ifndef ROBUROC4_OS_H
#define ROBUROC4_OS_H

#include "roburoc4_record.h"

#ifdef _WIN32
#include <winsock2.h> /* before windows.h, which would include the old winsock.h */

#include <windows.h>
typedef SRWLOCK roburoc4_lock;
typedef CONDITION_VARIABLE roburoc4_signal;
typedef HANDLE roburoc4_thread_id;
typedef LONG roburoc4_number;
#define ROBUROC4_LOCK_INIT SRWLOCK_INIT
#else
#include <pthread.h>
typedef pthread_mutex_t roburoc4_lock;
typedef pthread_cond_t roburoc4_signal;
typedef pthread_t roburoc4_thread_id;
typedef int roburoc4_number;
#define ROBUROC4_LOCK_INIT PTHREAD_MUTEX_INITIALIZER
#endif

/* --------------------------------------------------------------------------------- sockets --- */

#define ROBUROC4_OS_NO_SOCKET (-1)

/** The outcome of a socket call: a ROBUROC4_FAULT_* and the system's error number. */
typedef struct roburoc4_os_outcome {
    uint32_t fault;
    int32_t system_error;
} roburoc4_os_outcome;

/** Results of roburoc4_os_receive(). */
#define ROBUROC4_OS_DATAGRAM 0
#define ROBUROC4_OS_EMPTY 1     /* no datagram is waiting */
#define ROBUROC4_OS_OVERSIZED 2 /* one was longer than the buffer, and is discarded */
#define ROBUROC4_OS_FAULT 3     /* an error caused by something sent before */
#define ROBUROC4_OS_BROKEN 4    /* the socket is unusable */

/** Resolve a name or address; port and all other fields of *out are set, too. */
roburoc4_result roburoc4_os_resolve(const char *host, uint16_t port, roburoc4_address *out);
/** The IP address alone, without zone and port, terminated by NUL. 0 if it does not fit. */
int roburoc4_os_ip_text(const roburoc4_address *address, char *buffer, size_t capacity);

/** A non-blocking datagram socket of the address's family, or ROBUROC4_OS_NO_SOCKET. */
int64_t roburoc4_os_socket(const roburoc4_address *address, roburoc4_os_outcome *outcome);
void roburoc4_os_close(int64_t socket);
/** Use this local address and port; zeros leave the choice to the system. */
roburoc4_os_outcome roburoc4_os_bind(int64_t socket, const roburoc4_address *local);
/** Connect, or connect again: the system chooses the local address unless it was bound. */
roburoc4_os_outcome roburoc4_os_connect(int64_t socket, const roburoc4_address *address);
roburoc4_os_outcome roburoc4_os_send(int64_t socket, const uint8_t *datagram, size_t size);
/** One of ROBUROC4_OS_DATAGRAM ...; *outcome is set for _FAULT and _BROKEN. */
int roburoc4_os_receive(int64_t socket, uint8_t *buffer, size_t capacity, size_t *size,
                        roburoc4_os_outcome *outcome);
/** Wait until one of the two (each may be ROBUROC4_OS_NO_SOCKET) is readable, the time is over, or
 * a signal handler ran. ROBUROC4_ERR_SYSTEM if one of them is unusable. */
roburoc4_result roburoc4_os_wait(int64_t socket, int64_t wake, uint64_t timeout_us);

/** This end's address of a connected socket; 0 where it has none. */
int roburoc4_os_own_address(int64_t socket, roburoc4_address *out);

/* ----------------------------------------------------------------------------------- files --- */

/** Microseconds since 1970 (UTC). It may jump: for people, never for control. */
uint64_t roburoc4_os_calendar_us(void);
/** The same as "20260102T030405Z", with a NUL. */
void roburoc4_os_calendar_text(uint64_t calendar_us, char text[17]);

#define ROBUROC4_OS_NO_FILE (-1)
/** What a path leads to. */
#define ROBUROC4_OS_FILE 0 /* a file, or nothing yet */
#define ROBUROC4_OS_FOLDER 1
#define ROBUROC4_OS_STREAM 2 /* a pipe or device */
int roburoc4_os_path_kind(const char *path);
/** Opens a stream, or makes a file; ROBUROC4_OS_NO_FILE and errno, EEXIST where it exists. */
int64_t roburoc4_os_file_create(const char *path);
/** How many bytes were written, fewer than requested or even none; errno says why. */
size_t roburoc4_os_file_write(int64_t file, const uint8_t *bytes, size_t size);
void roburoc4_os_file_truncate(int64_t file, uint64_t size);
void roburoc4_os_file_close(int64_t file);

/* --------------------------------------------------------------------------------- threads --- */

/** Identifies this process: different after fork(). */
int64_t roburoc4_process_id(void);

/** A number that threads and signal handlers share without a lock. */
typedef struct roburoc4_atomic {
    volatile roburoc4_number number;
} roburoc4_atomic;
/** Returns the previous number. */
int roburoc4_atomic_exchange(roburoc4_atomic *atomic, int number);
int roburoc4_atomic_read(roburoc4_atomic *atomic);

/** A mutex, with priority inheritance where the system has it. A thread that holds one is not
 * cancelled (pthread_cancel) until it has released all of them. 0 if none can be created. */
int roburoc4_lock_create(roburoc4_lock *lock);
void roburoc4_lock_destroy(roburoc4_lock *lock);
void roburoc4_lock_take(roburoc4_lock *lock);
void roburoc4_lock_give(roburoc4_lock *lock);

/** A condition variable; 0 if none can be created. */
int roburoc4_signal_create(roburoc4_signal *signal);
void roburoc4_signal_destroy(roburoc4_signal *signal);
void roburoc4_signal_wake_all(roburoc4_signal *signal);
/** Returns after a wake_all, or timeout_us, or for no reason. */
void roburoc4_signal_wait(roburoc4_signal *signal, roburoc4_lock *lock, uint64_t timeout_us);

/** A thread; its struct must not move between start and join. */
typedef struct roburoc4_thread {
    roburoc4_thread_id id;
    void (*function)(void *);
    void *argument;
    roburoc4_atomic over;
} roburoc4_thread;

/** Run function(argument) on a thread that no signal handler interrupts. 0 on failure. */
int roburoc4_thread_start(roburoc4_thread *thread, void (*function)(void *), void *argument);
/** Whether it has ended or never started. Does not wait. */
int roburoc4_thread_is_over(roburoc4_thread *thread);
void roburoc4_thread_join(roburoc4_thread *thread);

/** Ends a roburoc4_os_wait() of another thread. */
typedef struct roburoc4_wake {
    int64_t wait_on; /* for roburoc4_os_wait() */
    int64_t write_to;
} roburoc4_wake;

/** 0 if none can be created. */
int roburoc4_wake_create(roburoc4_wake *wake);
void roburoc4_wake_destroy(roburoc4_wake *wake);
/** Can be called in a signal handler; keeps errno. */
void roburoc4_wake_raise(const roburoc4_wake *wake);
void roburoc4_wake_clear(const roburoc4_wake *wake);

#endif
