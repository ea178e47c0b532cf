/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "filter.h"

#if defined(__linux__)
#include <linux/filter.h>
#include <netinet/in.h>
#include <sys/socket.h>

#define LAST_FD 1024
/* In a datagram, behind the UDP header: magic, number and size of the message, offset of the
 * fragment (32 bits each), number of the fragment (16 bits). */
#define MAGIC_AT 8
#define OFFSET_AT 20
#define NUMBER_AT 24
#define LONG_MESSAGE 0x4C433033u /* "LC03" */
/* LCM's longest message. */
#define MAX_OFFSET (1u << 28)

static bool is_socket_of(int fd, uint16_t port) {
    struct sockaddr_in own = {0};
    socklen_t size = sizeof own;
    int type = 0;
    socklen_t type_size = sizeof type;
    return getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &type_size) == 0 && type == SOCK_DGRAM &&
           getsockname(fd, (struct sockaddr *)&own, &size) == 0 && own.sin_family == AF_INET &&
           ntohs(own.sin_port) == port;
}

bool filter_fragments(uint16_t port) {
    /* The first fragment has the channel's name, from whose length LCM computes a size, too: it
     * must begin the message. */
    struct sock_filter program[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, MAGIC_AT),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, LONG_MESSAGE, 0, 5),
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, OFFSET_AT),
        BPF_JUMP(BPF_JMP | BPF_JGT | BPF_K, MAX_OFFSET, 4, 0),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0, 2, 0),
        BPF_STMT(BPF_LD | BPF_H | BPF_ABS, NUMBER_AT),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0, 1, 0),
        BPF_STMT(BPF_RET | BPF_K, UINT32_MAX), /* all of it */
        BPF_STMT(BPF_RET | BPF_K, 0),          /* nothing */
    };
    const struct sock_fprog filter = {sizeof program / sizeof program[0], program};
    bool found = false;
    for (int fd = 0; fd < LAST_FD; fd++) {
        if (is_socket_of(fd, port)) {
            if (setsockopt(fd, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter) != 0) {
                return false;
            }
            found = true;
        }
    }
    return found;
}

#else

bool filter_fragments(uint16_t port) {
    (void)port;
    return false;
}
#endif
