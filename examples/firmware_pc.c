/* SPDX-License-Identifier: MIT
 *
 * firmware_pc.c - a PC as the board of docs/firmware.md: POSIX sockets to the simulated robot at
 * 127.0.0.1, and a switch that somebody holds from the third second to the sixth.
 */
#include "board.h"

#include <netinet/in.h>
#include <stdio.h>
#include <sys/socket.h>
#include <time.h>

static int robot; /* a socket */
static uint64_t begun_us;

uint64_t board_now_us(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000 + (uint64_t)now.tv_nsec / 1000;
}

size_t board_udp_receive(uint8_t *datagram, size_t capacity) {
    ssize_t size = recv(robot, datagram, capacity, MSG_DONTWAIT | MSG_TRUNC);
    return size > 0 && (size_t)size <= capacity ? (size_t)size : 0;
}

void board_udp_send(const uint8_t *datagram, size_t size) {
    if (send(robot, datagram, size, 0) < 0) {
        perror("send");
    }
}

int board_drive_wanted(float *linear_m_s, float *angular_rad_s) {
    uint64_t for_us = board_now_us() - begun_us;
    *linear_m_s = 0.3f;
    *angular_rad_s = 0.0f;
    return for_us >= 3000000 && for_us < 6000000;
}

int main(void) {
    const struct timespec pause = {0, 1000000};
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons(60000)};
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    robot = socket(AF_INET, SOCK_DGRAM, 0);
    if (robot < 0 || connect(robot, (struct sockaddr *)&address, sizeof address) < 0) {
        perror("firmware_pc");
        return 1;
    }
    begun_us = board_now_us();
    for (robot_begin(); board_now_us() - begun_us < 8000000; nanosleep(&pause, NULL)) {
        robot_poll();
    }
    return 0;
}
