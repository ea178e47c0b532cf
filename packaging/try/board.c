/* SPDX-License-Identifier: MIT
 *
 * board ADDRESS:PORT: the firmware of examples/Firmware on this computer. Its network is a socket
 * to the simulator, and its button is held for three seconds, after two. It fails unless the robot
 * was driven, and is at rest at the end.
 */
#define _POSIX_C_SOURCE 200809L
#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>

#define main firmware
#include "main.c"
#undef main

static int network;

uint64_t board_now_us(void) {
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000 + (uint64_t)now.tv_nsec / 1000;
}

size_t board_receive(uint8_t *datagram, size_t capacity) {
    const ssize_t size = recv(network, datagram, capacity, 0);
    return size > 0 ? (size_t)size : 0;
}

void board_send(const uint8_t *datagram, size_t size) {
    (void)send(network, datagram, size, 0);
}

int board_button(void) {
    static uint64_t begun_us;
    roburoc4_localization_status pose = {0};
    roburoc4_differential_status speeds = {0};
    begun_us = begun_us == 0 ? board_now_us() : begun_us;
    const uint64_t past_us = board_now_us() - begun_us;
    (void)poll(NULL, 0, 1);
    if (past_us > 7000000) {
        (void)roburoc4_client_localization(&client, &pose, NULL);
        (void)roburoc4_client_differential(&client, &speeds, NULL);
        printf("x %.2f m, %.2f m/s\n", pose.x_m, speeds.current_linear_m_s);
        exit(pose.x_m < 0.3 || speeds.current_linear_m_s > 0.01f);
    }
    return past_us > 2000000 && past_us < 5000000;
}

int main(int argc, char **argv) {
    const char *port = argc > 1 ? strchr(argv[1], ':') : NULL;
    struct sockaddr_in robot = {.sin_family = AF_INET};
    robot.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    robot.sin_port = htons((uint16_t)(port == NULL ? 60000 : atoi(port + 1)));
    network = socket(AF_INET, SOCK_DGRAM, 0);
    if (network < 0 || connect(network, (struct sockaddr *)&robot, sizeof robot) < 0 ||
        fcntl(network, F_SETFL, O_NONBLOCK) < 0) {
        return 2;
    }
    return firmware();
}
