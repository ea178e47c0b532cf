/* SPDX-License-Identifier: MIT
 *
 * lcm_bare LCM_URL: the least that a bridge can be, to compare roburoc4-lcm with: receive a
 * datagram, publish its bytes on the channel BARE, and nothing else. Prints the port that it
 * listens on.
 */
#include <arpa/inet.h>
#include <lcm/lcm.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>

int main(int count, char **arguments) {
    lcm_t *lcm = count == 2 ? lcm_create(arguments[1]) : NULL;
    int end = socket(AF_INET, SOCK_DGRAM, 0);
    struct sockaddr_in address;
    socklen_t length = sizeof address;
    memset(&address, 0, sizeof address);
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (lcm == NULL || end < 0 || bind(end, (struct sockaddr *)&address, sizeof address) != 0 ||
        getsockname(end, (struct sockaddr *)&address, &length) != 0) {
        (void)fprintf(stderr, "lcm_bare: needs an LCM URL and a socket\n");
        return 1;
    }
    (void)printf("%u\n", ntohs(address.sin_port));
    (void)fflush(stdout);
    for (;;) {
        unsigned char datagram[512];
        ssize_t size = recv(end, datagram, sizeof datagram, 0);
        if (size > 0) {
            (void)lcm_publish(lcm, "BARE", datagram, (unsigned)size);
        }
    }
}
