/* SPDX-License-Identifier: MIT
 *
 * For LD_PRELOAD: a socket that is connected to port $BREAK_PORT cannot be read while the file
 * $BREAK_FILE exists, as if it were not a socket.
 */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <errno.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

static int is_broken(int file) {
    const char *path = getenv("BREAK_FILE");
    const char *port = getenv("BREAK_PORT");
    struct sockaddr_in peer = {0};
    socklen_t size = sizeof peer;
    return path != NULL && port != NULL && access(path, F_OK) == 0 &&
           getpeername(file, (struct sockaddr *)&peer, &size) == 0 &&
           ntohs(peer.sin_port) == strtol(port, NULL, 10);
}

ssize_t recv(int file, void *buffer, size_t size, int flags) {
    if (is_broken(file)) {
        errno = EBADF;
        return -1;
    }
    return syscall(SYS_recvfrom, file, buffer, size, flags, NULL, NULL);
}
