/* SPDX-License-Identifier: MIT
 *
 * Berkeley sockets: what os_posix.c and os_windows.c share. Each build compiles it in one of them.
 */
#ifndef ROBUROC4_OS_SOCKET_H
#define ROBUROC4_OS_SOCKET_H

#include "os.h"

#ifdef _WIN32
#define WIN32_LEAN_AND_MEAN
#ifndef _WIN32_WINNT
#define _WIN32_WINNT 0x0600
#endif
#include <winsock2.h>
#include <ws2tcpip.h>
typedef SOCKET system_socket;
#define LAST_ERROR() WSAGetLastError()
#else
#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
typedef int system_socket;
#define LAST_ERROR() errno
#endif
#include <string.h>

/* Small, so that a stalled network does not queue old speed commands. */
#define SEND_BUFFER_BYTES 4096
/* Room for all statuses of a few seconds. */
#define RECEIVE_BUFFER_BYTES (256 * 1024)
#define LONGEST_WAIT_US 3600000000u

static socklen_t to_system(const roburoc4_address *address, struct sockaddr_storage *out) {
    memset(out, 0, sizeof *out);
    if (address->family == 4) {
        struct sockaddr_in *in = (struct sockaddr_in *)out;
        in->sin_family = AF_INET;
        in->sin_port = htons(address->port);
        memcpy(&in->sin_addr, address->ip, 4);
        return sizeof *in;
    } else {
        struct sockaddr_in6 *in6 = (struct sockaddr_in6 *)out;
        in6->sin6_family = AF_INET6;
        in6->sin6_port = htons(address->port);
        in6->sin6_scope_id = address->scope;
        memcpy(&in6->sin6_addr, address->ip, 16);
        return sizeof *in6;
    }
}

static void from_system(const struct sockaddr *system, uint16_t port, roburoc4_address *out) {
    memset(out, 0, sizeof *out);
    out->port = port;
    if (system->sa_family == AF_INET) {
        struct sockaddr_in in;
        memcpy(&in, system, sizeof in);
        out->family = 4;
        memcpy(out->ip, &in.sin_addr, 4);
    } else {
        struct sockaddr_in6 in6;
        memcpy(&in6, system, sizeof in6);
        out->family = 6;
        out->scope = in6.sin6_scope_id;
        memcpy(out->ip, &in6.sin6_addr, 16);
    }
}

static uint16_t port_of(const struct sockaddr_storage *system) {
    return ntohs(system->ss_family == AF_INET ? ((const struct sockaddr_in *)system)->sin_port
                                              : ((const struct sockaddr_in6 *)system)->sin6_port);
}

/* ROBUROC4_ERR_RESOLVE, or the first address of the host; IPv4 comes before IPv6. */
static roburoc4_result look_up(const char *host, uint16_t port, roburoc4_address *out) {
    static const int families[] = {AF_INET, AF_INET6};
    struct addrinfo hints, *list, *entry;
    roburoc4_result result = ROBUROC4_ERR_RESOLVE;
    memset(&hints, 0, sizeof hints);
    hints.ai_family = AF_UNSPEC;
    hints.ai_socktype = SOCK_DGRAM;
    hints.ai_flags = AI_NUMERICHOST; /* first without asking any name server */
    if (getaddrinfo(host, NULL, &hints, &list) != 0) {
        hints.ai_flags = 0;
        if (getaddrinfo(host, NULL, &hints, &list) != 0) {
            return ROBUROC4_ERR_RESOLVE;
        }
    }
    for (size_t i = 0; i < 2 && result < 0; i++) {
        for (entry = list; entry != NULL && result < 0; entry = entry->ai_next) {
            if (entry->ai_family == families[i]) {
                from_system(entry->ai_addr, port, out);
                result = ROBUROC4_OK;
            }
        }
    }
    freeaddrinfo(list);
    return result;
}

static uint32_t fault_of(int error); /* of the system */

static roburoc4_os_outcome failure(int error) {
    roburoc4_os_outcome outcome;
    outcome.fault = fault_of(error);
    outcome.system_error = error;
    return outcome;
}

static const roburoc4_os_outcome success = {ROBUROC4_FAULT_NONE, 0};

roburoc4_os_outcome roburoc4_os_bind(int64_t socket, const roburoc4_address *local) {
    struct sockaddr_storage system;
    const socklen_t length = to_system(local, &system);
    return bind((system_socket)socket, (const struct sockaddr *)&system, length) != 0
               ? failure(LAST_ERROR())
               : success;
}

/* Connecting to nobody dissolves an earlier connection, and with it the local address; it fails if
 * there is none. */
static roburoc4_os_outcome reconnect(int64_t socket, const struct sockaddr *nobody, size_t size,
                                     const roburoc4_address *address) {
    struct sockaddr_storage system;
    const socklen_t length = to_system(address, &system);
    (void)connect((system_socket)socket, nobody, (socklen_t)size);
    return connect((system_socket)socket, (const struct sockaddr *)&system, length) != 0
               ? failure(LAST_ERROR())
               : success;
}

int roburoc4_os_own_address(int64_t socket, roburoc4_address *out) {
    struct sockaddr_storage own;
    socklen_t length = sizeof own;
    memset(&own, 0, sizeof own);
    if (getsockname((system_socket)socket, (struct sockaddr *)&own, &length) != 0) {
        return 0;
    }
    from_system((struct sockaddr *)&own, port_of(&own), out);
    return 1;
}

#endif
