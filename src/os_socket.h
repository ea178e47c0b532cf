/* SPDX-License-Identifier: MIT
 *
 * Berkeley sockets, which os_posix.c and os_windows.c share.
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
#else
#include <netinet/in.h>
#include <sys/socket.h>
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

#endif
