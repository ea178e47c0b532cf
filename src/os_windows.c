/* SPDX-License-Identifier: MIT
 *
 * os.h on Windows (Vista and later). Link with ws2_32. The reasons given in os_posix.c apply
 * here, too.
 */
#include "os_socket.h"

#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <process.h>
#include <share.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include <windows.h>

/* ----------------------------------------------------------------------------------- clock --- */

typedef void(WINAPI *precise_clock)(ULONGLONG *);

/* Windows 10 has it, in a library that older compilers cannot link. */
static precise_clock find_precise_clock(void) {
    HMODULE module = GetModuleHandleA("kernelbase.dll");
    FARPROC found = module != NULL ? GetProcAddress(module, "QueryInterruptTimePrecise") : NULL;
    precise_clock clock = NULL;
    memcpy(&clock, &found, sizeof clock);
    return clock;
}

uint64_t roburoc4_udp_now_us(void) {
    static volatile LONG searched = 0; /* every thread finds the same */
    static precise_clock volatile clock = NULL;
    ULONGLONG ticks_100ns = 0;
    if (InterlockedCompareExchange(&searched, 0, 0) == 0) {
        clock = find_precise_clock();
        (void)InterlockedExchange(&searched, 1);
    }
    if (clock == NULL) {
        return (uint64_t)GetTickCount64() * 1000u;
    }
    clock(&ticks_100ns);
    return (uint64_t)ticks_100ns / 10u;
}

/* ------------------------------------------------------------------------------- addresses --- */

/* Counted by Windows: each success needs a WSACleanup(). */
static int start_winsock(int32_t *system_error) {
    WSADATA data;
    *system_error = WSAStartup(MAKEWORD(2, 2), &data);
    return *system_error == 0;
}

roburoc4_result roburoc4_os_resolve(const char *host, uint16_t port, roburoc4_address *out) {
    int32_t error;
    roburoc4_result result;
    if (!start_winsock(&error)) {
        return ROBUROC4_ERR_RESOLVE;
    }
    result = look_up(host, port, out);
    (void)WSACleanup();
    return result;
}

int roburoc4_os_ip_text(const roburoc4_address *address, char *buffer, size_t capacity) {
    struct sockaddr_storage system;
    roburoc4_address alone = *address;
    int length, fits;
    int32_t error;
    alone.scope = 0;
    length = to_system(&alone, &system);
    if (!start_winsock(&error)) {
        return 0;
    }
    fits = getnameinfo((const struct sockaddr *)&system, (socklen_t)length, buffer, (DWORD)capacity,
                       NULL, 0, NI_NUMERICHOST) == 0;
    (void)WSACleanup();
    return fits;
}

/* ----------------------------------------------------------------------------------- socket --- */

static uint32_t fault_of(int error) {
    switch (error) {
    case WSAECONNREFUSED:
    case WSAECONNRESET: /* how Windows reports a refused datagram */
        return ROBUROC4_FAULT_REFUSED;
    case WSAENETUNREACH:
    case WSAEHOSTUNREACH:
    case WSAEHOSTDOWN:
        return ROBUROC4_FAULT_UNREACHABLE;
    case WSAENETDOWN:
    case WSAENETRESET:
    case WSAEADDRNOTAVAIL:
    case WSAEINVAL:
        return ROBUROC4_FAULT_DOWN;
    case WSAEACCES:
        return ROBUROC4_FAULT_DENIED;
    case WSAEWOULDBLOCK:
    case WSAEINTR:
    case WSAENOBUFS:
        return ROBUROC4_FAULT_FULL;
    default:
        return ROBUROC4_FAULT_OTHER;
    }
}

static void set_option(SOCKET handle, int option, int value) {
    (void)setsockopt(handle, SOL_SOCKET, option, (const char *)&value, (int)sizeof value);
}

int64_t roburoc4_os_socket(const roburoc4_address *address, roburoc4_os_outcome *outcome) {
    u_long non_blocking = 1;
    SOCKET handle;
    int32_t error;
    if (!start_winsock(&error)) {
        *outcome = failure(error);
        return ROBUROC4_OS_NO_SOCKET;
    }
    handle = socket(address->family == 4 ? AF_INET : AF_INET6, SOCK_DGRAM, IPPROTO_UDP);
    if (handle == INVALID_SOCKET) {
        *outcome = failure(WSAGetLastError());
        (void)WSACleanup();
        return ROBUROC4_OS_NO_SOCKET;
    }
    if (ioctlsocket(handle, (long)FIONBIO, &non_blocking) != 0) {
        *outcome = failure(WSAGetLastError());
        roburoc4_os_close((int64_t)handle);
        return ROBUROC4_OS_NO_SOCKET;
    }
    (void)SetHandleInformation((HANDLE)handle, HANDLE_FLAG_INHERIT, 0);
    set_option(handle, SO_RCVBUF, RECEIVE_BUFFER_BYTES);
    set_option(handle, SO_SNDBUF, SEND_BUFFER_BYTES);
    *outcome = success;
    return (int64_t)handle;
}

void roburoc4_os_close(int64_t socket) {
    (void)closesocket((SOCKET)socket);
    (void)WSACleanup();
}

roburoc4_os_outcome roburoc4_os_connect(int64_t socket, const roburoc4_address *address) {
    struct sockaddr_storage nobody;
    roburoc4_address unspecified = *address;
    memset(unspecified.ip, 0, sizeof unspecified.ip);
    unspecified.scope = 0;
    unspecified.port = 0;
    const socklen_t length = to_system(&unspecified, &nobody);
    return reconnect(socket, (const struct sockaddr *)&nobody, (size_t)length, address);
}

roburoc4_os_outcome roburoc4_os_send(int64_t socket, const uint8_t *datagram, size_t size) {
    return send((SOCKET)socket, (const char *)datagram, (int)size, 0) == SOCKET_ERROR
               ? failure(WSAGetLastError())
               : success;
}

int roburoc4_os_receive(int64_t socket, uint8_t *buffer, size_t capacity, size_t *size,
                        roburoc4_os_outcome *outcome) {
    int got = recv((SOCKET)socket, (char *)buffer, (int)capacity, 0);
    if (got != SOCKET_ERROR) {
        *size = (size_t)got;
        return ROBUROC4_OS_DATAGRAM;
    }
    *outcome = failure(WSAGetLastError());
    switch (outcome->system_error) {
    case WSAEMSGSIZE:
        return ROBUROC4_OS_OVERSIZED;
    case WSAENOTSOCK:
    case WSANOTINITIALISED:
        return ROBUROC4_OS_BROKEN;
    default:
        return outcome->fault == ROBUROC4_FAULT_FULL ? ROBUROC4_OS_EMPTY : ROBUROC4_OS_FAULT;
    }
}

roburoc4_result roburoc4_os_wait(int64_t socket, int64_t wake, uint64_t timeout_us) {
    uint64_t us = timeout_us < LONGEST_WAIT_US ? timeout_us : LONGEST_WAIT_US;
    struct timeval timeout;
    fd_set watched;
    FD_ZERO(&watched);
    if (socket != ROBUROC4_OS_NO_SOCKET) {
        FD_SET((SOCKET)socket, &watched);
    }
    if (wake != ROBUROC4_OS_NO_SOCKET) {
        FD_SET((SOCKET)wake, &watched);
    }
    if (watched.fd_count == 0) { /* select() refuses an empty set */
        Sleep((DWORD)((us + 999u) / 1000u));
        return ROBUROC4_OK;
    }
    timeout.tv_sec = (long)(us / 1000000u);
    timeout.tv_usec = (long)(us % 1000000u);
    if (select(0, &watched, NULL, NULL, &timeout) == SOCKET_ERROR &&
        WSAGetLastError() != WSAEINTR) {
        return ROBUROC4_ERR_SYSTEM;
    }
    return ROBUROC4_OK;
}

/* ----------------------------------------------------------------------------------- files --- */

#define FROM_1601_TO_1970_US 11644473600000000u

uint64_t roburoc4_os_calendar_us(void) {
    FILETIME now;
    GetSystemTimeAsFileTime(&now);
    return ((uint64_t)now.dwHighDateTime << 32 | now.dwLowDateTime) / 10u - FROM_1601_TO_1970_US;
}

void roburoc4_os_calendar_text(uint64_t calendar_us, char text[17]) {
    __time64_t seconds = (__time64_t)(calendar_us / 1000000u);
    struct tm parts;
    memset(&parts, 0, sizeof parts);
    (void)_gmtime64_s(&parts, &seconds);
    (void)strftime(text, 17, "%Y%m%dT%H%M%SZ", &parts);
}

/* Paths are UTF-8, as Python's and Octave's are. 0 where one is too long. */
static int to_wide(const char *path, wchar_t wide[ROBUROC4_RECORDER_PATH_SIZE]) {
    return MultiByteToWideChar(CP_UTF8, 0, path, -1, wide, ROBUROC4_RECORDER_PATH_SIZE);
}

int roburoc4_os_path_kind(const char *path) {
    wchar_t wide[ROBUROC4_RECORDER_PATH_SIZE];
    DWORD found = to_wide(path, wide) ? GetFileAttributesW(wide) : INVALID_FILE_ATTRIBUTES;
    return found != INVALID_FILE_ATTRIBUTES && (found & FILE_ATTRIBUTE_DIRECTORY) != 0
               ? ROBUROC4_OS_FOLDER
               : ROBUROC4_OS_FILE;
}

int64_t roburoc4_os_file_create(const char *path) {
    wchar_t wide[ROBUROC4_RECORDER_PATH_SIZE];
    if (!to_wide(path, wide)) {
        errno = EINVAL;
        return ROBUROC4_OS_NO_FILE;
    }
    return _wsopen(wide, _O_WRONLY | _O_CREAT | _O_EXCL | _O_BINARY | _O_NOINHERIT, _SH_DENYWR,
                   _S_IREAD | _S_IWRITE);
}

size_t roburoc4_os_file_write(int64_t file, const uint8_t *bytes, size_t size) {
    int written = _write((int)file, bytes, (unsigned)size);
    return written < 0 ? 0 : (size_t)written;
}

void roburoc4_os_file_truncate(int64_t file, uint64_t size) {
    (void)_chsize_s((int)file, (int64_t)size);
}

void roburoc4_os_file_close(int64_t file) {
    (void)_close((int)file);
}

/* --------------------------------------------------------------------------------- process --- */

int64_t roburoc4_process_id(void) {
    return (int64_t)GetCurrentProcessId();
}

int roburoc4_atomic_exchange(roburoc4_atomic *atomic, int number) {
    return (int)InterlockedExchange(&atomic->number, number);
}

int roburoc4_atomic_read(roburoc4_atomic *atomic) {
    return (int)InterlockedCompareExchange(&atomic->number, 0, 0);
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

static unsigned __stdcall run(void *argument) {
    const roburoc4_thread *thread = argument;
    thread->function(thread->argument);
    return 0;
}

int roburoc4_thread_start(roburoc4_thread *thread, void (*function)(void *), void *argument) {
    thread->function = function;
    thread->argument = argument;
    thread->id = (HANDLE)_beginthreadex(NULL, 0, run, thread, 0, NULL);
    return thread->id != NULL;
}

/* Also for a thread that the system ended, as it does before a DLL is notified of exit(). */
int roburoc4_thread_is_over(roburoc4_thread *thread) {
    return thread->id == NULL || WaitForSingleObject(thread->id, 0) == WAIT_OBJECT_0;
}

void roburoc4_thread_join(roburoc4_thread *thread) {
    (void)WaitForSingleObject(thread->id, INFINITE);
    (void)CloseHandle(thread->id);
    thread->id = NULL;
}

/* ------------------------------------------------------------------------------------ wake --- */

/* select() watches only sockets, so the wake is a loopback socket connected to itself. */
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
