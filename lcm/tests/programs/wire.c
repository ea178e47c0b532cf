/* SPDX-License-Identifier: MIT
 *
 * wire SEED LOSS REORDER RECORD INTERFACE...: an Ethernet switch for network namespaces, which
 * loses and reorders what it carries (LOSS and REORDER are shares), the same way for the same seed
 * and traffic. `cut N` and `join N` on stdin pull and plug the cable of the Nth interface.
 *
 * RECORD gets what it delivered of LCM's commands and of the robots' (UDP to ports 7667 and from
 * 60000 on): epoch microseconds (8 bytes; of LCM's when it left, of the robots' when it came,
 * however busy the machine is), the port that it left by, and the UDP payload's length (4 bytes
 * each, this machine's order), source and destination (address and port as on the wire, 6 bytes
 * each), and the payload.
 */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <poll.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { PORTS = 8, FRAME = 16384, ETHERNET = 14, IPV4 = 20, UDP = 8, HEADERS = 42, LONGEST_MS = 20 };

typedef struct frame {
    uint8_t bytes[FRAME];
    size_t size;
    uint64_t came_us;
} frame;

typedef struct port {
    int fd;
    bool cut;
    uint8_t host[6]; /* whoever sent last from there */
    frame held;      /* it leaves after the next one, or after LONGEST_MS */
    uint64_t held_us;
} port;

static port ports[PORTS];
static int port_count;
static uint64_t state;
static double loss, reorder;
static FILE *record;

static double luck(void) { /* xorshift64* */
    state ^= state >> 12;
    state ^= state << 25;
    state ^= state >> 27;
    return (double)((state * 2685821657736338717ull) >> 11) / 9007199254740992.0;
}

static uint64_t now_us(void) {
    struct timespec now;
    (void)clock_gettime(CLOCK_REALTIME, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

static bool is_udp(const frame *frame) {
    return frame->size >= HEADERS && frame->bytes[12] == 8 && frame->bytes[13] == 0 &&
           frame->bytes[ETHERNET] == 0x45 && frame->bytes[23] == 17;
}

static void write_down(const frame *frame, int number) {
    const uint8_t *ip = frame->bytes + ETHERNET;
    const uint8_t *udp = ip + IPV4;
    unsigned to = (unsigned)udp[2] << 8 | udp[3];
    uint32_t length = ((uint32_t)udp[4] << 8 | udp[5]) - UDP;
    uint32_t words[2] = {(uint32_t)number, length};
    uint64_t time_us = now_us();
    bool to_robot = to >= 60000 && length > 0 && udp[8] == 0xFF;
    time_us = to_robot ? frame->came_us : time_us;
    bool command = to == 7667 && memmem(udp + UDP, length < 80 ? length : 80, "_CMD", 5) != NULL;
    if (frame->size < HEADERS + length || (!to_robot && !command)) {
        return;
    }
    (void)fwrite(&time_us, 1, sizeof time_us, record);
    (void)fwrite(words, 1, sizeof words, record);
    (void)fwrite(ip + 12, 1, 4, record);
    (void)fwrite(udp, 1, 2, record);
    (void)fwrite(ip + 16, 1, 4, record);
    (void)fwrite(udp + 2, 1, 2, record);
    (void)fwrite(udp + UDP, 1, length, record);
}

static void deliver(const frame *frame, int number) {
    if (is_udp(frame)) {
        write_down(frame, number);
    }
    ssize_t sent = send(ports[number].fd, frame->bytes, frame->size, MSG_DONTWAIT);
    (void)sent; /* a frame that does not fit is lost, as on a switch */
}

static void release(port *port) {
    size_t size = port->held.size;
    port->held.size = 0;
    if (size > 0 && !port->cut) {
        frame *held = &port->held;
        held->size = size;
        deliver(held, (int)(port - ports));
        held->size = 0;
    }
}

static void carry(const frame *frame, int number) {
    port *port = &ports[number];
    if (port->cut || (is_udp(frame) && luck() < loss)) {
        return;
    }
    if (is_udp(frame) && port->held.size == 0 && luck() < reorder) {
        memcpy(port->held.bytes, frame->bytes, frame->size);
        port->held.size = frame->size;
        port->held.came_us = frame->came_us;
        port->held_us = now_us();
        return;
    }
    deliver(frame, number);
    release(port);
}

/* Frames for a host go to its port, those for all go everywhere. */
static void pass_on(frame *frame, int from) {
    memcpy(ports[from].host, frame->bytes + 6, 6);
    if (is_udp(
            frame)) { /* the sender's kernel leaves checksums to the hardware, which is not there */
        frame->bytes[40] = frame->bytes[41] = 0;
    }
    int only = -1;
    for (int to = 0; to < port_count; to++) {
        only = memcmp(ports[to].host, frame->bytes, 6) == 0 ? to : only;
    }
    for (int to = 0; to < port_count; to++) {
        if (to != from && !ports[from].cut && (only < 0 || only == to)) {
            carry(frame, to);
        }
    }
}

/* When the kernel had it. */
static uint64_t stamp(struct msghdr *message) {
    struct cmsghdr *part = CMSG_FIRSTHDR(message);
    struct timespec time = {0, 0};
    if (part != NULL && part->cmsg_type == SO_TIMESTAMPNS) {
        memcpy(&time, CMSG_DATA(part), sizeof time);
    }
    return time.tv_sec > 0 ? (uint64_t)time.tv_sec * 1000000u + (uint64_t)time.tv_nsec / 1000u
                           : now_us();
}

static void receive(int from) {
    static frame frame;
    for (int count = 0; count < 64; count++) {
        struct sockaddr_ll sender;
        union {
            char bytes[256];
            struct cmsghdr aligned;
        } control;
        struct iovec room = {frame.bytes, sizeof frame.bytes};
        struct msghdr message = {.msg_name = &sender,
                                 .msg_namelen = sizeof sender,
                                 .msg_iov = &room,
                                 .msg_iovlen = 1,
                                 .msg_control = control.bytes,
                                 .msg_controllen = sizeof control.bytes};
        ssize_t got = recvmsg(ports[from].fd, &message, MSG_DONTWAIT);
        if (got < ETHERNET) {
            return;
        }
        frame.size = (size_t)got;
        frame.came_us = stamp(&message);
        if (sender.sll_pkttype != PACKET_OUTGOING) {
            pass_on(&frame, from);
        }
    }
}

static int plug(const char *interface) {
    int bytes = 8 << 20;
    int fd = socket(AF_PACKET, SOCK_RAW, htons(ETH_P_ALL));
    struct sockaddr_ll address;
    memset(&address, 0, sizeof address);
    address.sll_family = AF_PACKET;
    address.sll_protocol = htons(ETH_P_ALL);
    address.sll_ifindex = (int)if_nametoindex(interface);
    (void)setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
    (void)setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
    (void)setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &(int){1}, sizeof(int));
    return address.sll_ifindex != 0 && bind(fd, (struct sockaddr *)&address, sizeof address) == 0
               ? fd
               : -1;
}

/* False at the end of stdin. */
static bool obey(void) {
    char line[64];
    ssize_t got = read(STDIN_FILENO, line, sizeof line - 1);
    if (got <= 0) {
        return false;
    }
    line[got] = '\0';
    for (char *at = strtok(line, "\n"); at != NULL; at = strtok(NULL, "\n")) {
        char *number = strchr(at, ' ');
        long which = number != NULL ? strtol(number, NULL, 10) : -1;
        if (which >= 0 && which < port_count) {
            ports[which].cut = at[0] == 'c';
        }
    }
    return true;
}

int main(int count, char **arguments) {
    struct pollfd watched[PORTS + 1];
    if (count < 6 || count - 5 > PORTS || (record = fopen(arguments[4], "wb")) == NULL) {
        (void)fprintf(stderr, "usage: wire SEED LOSS REORDER RECORD INTERFACE...\n");
        return 2;
    }
    state = strtoull(arguments[1], NULL, 10) * 2 + 1;
    loss = strtod(arguments[2], NULL);
    reorder = strtod(arguments[3], NULL);
    for (port_count = 0; port_count < count - 5; port_count++) {
        ports[port_count].fd = plug(arguments[5 + port_count]);
        if (ports[port_count].fd < 0) {
            perror(arguments[5 + port_count]);
            return 1;
        }
        watched[port_count] = (struct pollfd){.fd = ports[port_count].fd, .events = POLLIN};
    }
    watched[port_count] = (struct pollfd){.fd = STDIN_FILENO, .events = POLLIN};
    (void)puts("ready");
    (void)fflush(stdout);
    bool more = true;
    while (more) {
        (void)poll(watched, (nfds_t)port_count + 1, LONGEST_MS);
        for (int at = 0; at < port_count; at++) {
            receive(at);
            if (ports[at].held.size > 0 && now_us() - ports[at].held_us >= LONGEST_MS * 1000) {
                release(&ports[at]);
            }
        }
        more = (watched[port_count].revents & (POLLIN | POLLHUP)) == 0 || obey();
    }
    return fclose(record) == 0 ? 0 : 1;
}
