/* SPDX-License-Identifier: MIT
 *
 * net.h on Windows. A console cannot be polled together with sockets, so a thread reads standard
 * input into a small buffer. Closed ports of peers are not reported here.
 */
#define _WIN32_WINNT 0x0600
#include <winsock2.h>
#include <ws2tcpip.h>

#include <windows.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "net.h"
#include "net_peer.h"

#define INPUT_BYTES 4096
#define SOCKET_BUFFER_BYTES 262144
/* The control code of <mstcpip.h>'s SIO_UDP_CONNRESET, which not every SDK has. */
#define UDP_CONNRESET _WSAIOW(IOC_VENDOR, 12)

struct net_sockets {
    size_t count;
    WSAPOLLFD *polls;
    HANDLE reader;
    CRITICAL_SECTION lock; /* protects the two members below */
    size_t input_used;
    bool input_ended;
    char input[INPUT_BYTES];
};

net_sockets *net_create(size_t sockets) {
    WSADATA data;
    if (WSAStartup(MAKEWORD(2, 2), &data) != 0) {
        return NULL;
    }
    net_sockets *created = calloc(1, sizeof *created);
    WSAPOLLFD *polls = calloc(sockets, sizeof *polls);
    if (created == NULL || polls == NULL) {
        free(created);
        free(polls);
        (void)WSACleanup();
        return NULL;
    }
    created->count = sockets;
    created->polls = polls;
    for (size_t index = 0; index < sockets; index++) {
        polls[index].fd = INVALID_SOCKET;
        polls[index].events = POLLRDNORM;
    }
    InitializeCriticalSection(&created->lock);
    return created;
}

void net_destroy(net_sockets *net) {
    for (size_t index = 0; index < net->count; index++) {
        if (net->polls[index].fd != INVALID_SOCKET) {
            (void)closesocket(net->polls[index].fd);
        }
    }
    (void)WSACleanup();
    if (net->reader != NULL) {
        /* The reader may be in a read that never returns: it ends with the process, and its buffer
         * must last until then. */
        return;
    }
    DeleteCriticalSection(&net->lock);
    free(net->polls);
    free(net);
}

/* -------------------------------------------------------------------------------- addresses --- */

bool net_is_address(const char *address) {
    unsigned parts[4];
    char rest;
    if (strlen(address) > 15 || strspn(address, "0123456789.") != strlen(address) ||
        sscanf(address, "%3u.%3u.%3u.%3u%c", &parts[0], &parts[1], &parts[2], &parts[3], &rest) !=
            4) {
        return false;
    }
    return parts[0] < 256 && parts[1] < 256 && parts[2] < 256 && parts[3] < 256;
}

void net_error_text(int error, char *text, size_t capacity) {
    if (error == WSAEADDRINUSE || error == WSAEACCES) {
        (void)snprintf(text, capacity, "Address already in use");
    } else {
        (void)snprintf(text, capacity, "Windows error %d", error);
    }
}

/* ---------------------------------------------------------------------------------- sockets --- */

static void set_up(SOCKET fd) {
    int size = SOCKET_BUFFER_BYTES;
    BOOL exclusive = TRUE;
    BOOL report = FALSE;
    u_long nonblocking = 1;
    DWORD returned = 0;
    (void)setsockopt(fd, SOL_SOCKET, SO_RCVBUF, (const char *)&size, sizeof size);
    (void)setsockopt(fd, SOL_SOCKET, SO_SNDBUF, (const char *)&size, sizeof size);
    (void)setsockopt(fd, SOL_SOCKET, SO_EXCLUSIVEADDRUSE, (const char *)&exclusive,
                     sizeof exclusive);
    /* Reports of closed ports name no peer here, and each makes a receive fail. */
    (void)WSAIoctl(fd, UDP_CONNRESET, &report, sizeof report, NULL, 0, &returned, NULL, NULL);
    (void)ioctlsocket(fd, (long)FIONBIO, &nonblocking);
}

int net_bind(net_sockets *net, size_t index, const char *address, uint16_t port, uint16_t *bound) {
    struct sockaddr_in own;
    memset(&own, 0, sizeof own);
    own.sin_family = AF_INET;
    own.sin_port = htons(port);
    own.sin_addr.s_addr = inet_addr(address);
    SOCKET fd = socket(AF_INET, SOCK_DGRAM, IPPROTO_UDP);
    if (fd == INVALID_SOCKET) {
        return WSAGetLastError();
    }
    net->polls[index].fd = fd;
    set_up(fd);
    int length = (int)sizeof own;
    if (bind(fd, (const struct sockaddr *)&own, (int)sizeof own) != 0 ||
        getsockname(fd, (struct sockaddr *)&own, &length) != 0) {
        return WSAGetLastError();
    }
    *bound = ntohs(own.sin_port);
    return 0;
}

static DWORD WINAPI read_standard_input(LPVOID context) {
    net_sockets *owner = context;
    char byte;
    while (fread(&byte, 1, 1, stdin) == 1) {
        for (bool stored = false; !stored;) {
            EnterCriticalSection(&owner->lock);
            if (owner->input_used < INPUT_BYTES) {
                owner->input[owner->input_used++] = byte;
                stored = true;
            }
            LeaveCriticalSection(&owner->lock);
            if (!stored) {
                Sleep(1);
            }
        }
    }
    EnterCriticalSection(&owner->lock);
    owner->input_ended = true;
    LeaveCriticalSection(&owner->lock);
    return 0;
}

void net_wait(net_sockets *net, bool input, uint64_t timeout_us) {
    uint64_t timeout_ms = (timeout_us + 999) / 1000;
    if (input && net->reader == NULL) {
        net->reader = CreateThread(NULL, 0, read_standard_input, net, 0, NULL);
    }
    if (WSAPoll(net->polls, (ULONG)net->count, timeout_ms < 1000 ? (INT)timeout_ms : 1000) < 0) {
        for (size_t index = 0; index < net->count; index++) {
            net->polls[index].revents = 0;
        }
        Sleep(1);
    }
}

bool net_is_ready(const net_sockets *net, size_t index) {
    return net->polls[index].revents != 0;
}

ptrdiff_t net_receive(net_sockets *net, size_t index, uint64_t *peer, uint8_t *buffer,
                      size_t capacity) {
    struct sockaddr_in from;
    int length = (int)sizeof from;
    int size = recvfrom(net->polls[index].fd, (char *)buffer, (int)capacity, 0,
                        (struct sockaddr *)&from, &length);
    if (size < 0) {
        return -1;
    }
    *peer = net_peer_of(&from);
    return size;
}

void net_send(net_sockets *net, size_t index, uint64_t peer, const uint8_t *data, size_t size) {
    struct sockaddr_in to = net_address_of(peer);
    (void)sendto(net->polls[index].fd, (const char *)data, (int)size, 0,
                 (const struct sockaddr *)&to, (int)sizeof to);
}

bool net_refused(net_sockets *net, size_t index, uint64_t *peer) {
    (void)net;
    (void)index;
    (void)peer;
    return false;
}

ptrdiff_t net_read_input(net_sockets *net, char *buffer, size_t capacity) {
    EnterCriticalSection(&net->lock);
    size_t size = net->input_used < capacity ? net->input_used : capacity;
    memcpy(buffer, net->input, size);
    memmove(net->input, net->input + size, net->input_used - size);
    net->input_used -= size;
    bool ended = net->input_ended && size == 0;
    LeaveCriticalSection(&net->lock);
    return ended ? -1 : (ptrdiff_t)size;
}

uint64_t net_now_us(void) {
    LARGE_INTEGER now;
    LARGE_INTEGER frequency;
    (void)QueryPerformanceCounter(&now);
    (void)QueryPerformanceFrequency(&frequency);
    uint64_t ticks = (uint64_t)now.QuadPart;
    uint64_t per_s = (uint64_t)frequency.QuadPart;
    return ticks / per_s * 1000000u + ticks % per_s * 1000000u / per_s;
}

static volatile LONG stop_wanted;

static BOOL WINAPI want_stop(DWORD event) {
    (void)event;
    (void)InterlockedExchange(&stop_wanted, 1);
    return TRUE;
}

void net_listen_for_stop(void) {
    (void)SetConsoleCtrlHandler(want_stop, TRUE);
}

bool net_stop_wanted(void) {
    return InterlockedCompareExchange(&stop_wanted, 0, 0) != 0;
}
