/* SPDX-License-Identifier: MIT
 *
 * stalls: naps and sends itself a datagram, and prints how many milliseconds too late that ended,
 * if it is too late for a robot's client. On Linux, a thread does so on each processor, since one
 * of them may stall alone.
 */
#define _GNU_SOURCE /* sched_setaffinity, CLOCK_BOOTTIME */
#include <arpa/inet.h>
#include <netinet/in.h>
#include <pthread.h>
#include <stdio.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>
#ifdef __linux__
#include <sched.h>
#endif

#define NAP_MS 20
/* A program gives up after 300 ms without a status: four such stalls in a row can cause that. */
#define TOO_LATE_MS 50
#define PROCESSORS 64U

static long long now_ms(void) {
    struct timespec now;
#ifdef CLOCK_BOOTTIME
    clock_gettime(CLOCK_BOOTTIME, &now); /* as the library: a suspended machine stalls, too */
#else
    clock_gettime(CLOCK_MONOTONIC, &now);
#endif
    return now.tv_sec * 1000LL + now.tv_nsec / 1000000;
}

/* A socket that is connected to itself. */
static int mirror(void) {
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof address;
    const int fd = socket(AF_INET, SOCK_DGRAM, 0);
    if (bind(fd, (struct sockaddr *)&address, size) != 0 ||
        getsockname(fd, (struct sockaddr *)&address, &size) != 0 ||
        connect(fd, (struct sockaddr *)&address, size) != 0) {
        perror("stalls");
        _exit(1);
    }
    return fd;
}

static void *nap_on(void *unused) {
    const struct timespec nap = {0, NAP_MS * 1000000L};
    const int fd = mirror();
    char byte = 0;
    (void)unused;
    for (;;) {
        const long long begun_ms = now_ms();
        nanosleep(&nap, NULL);
        if (write(fd, &byte, 1) != 1 || read(fd, &byte, 1) != 1) {
            perror("stalls");
            _exit(1);
        }
        const long long late_ms = now_ms() - begun_ms - NAP_MS;
        if (late_ms > TOO_LATE_MS) {
            printf("%lld\n", late_ms);
            fflush(stdout);
        }
    }
    return NULL;
}

int main(void) {
#ifdef __linux__
    cpu_set_t all;
    if (sched_getaffinity(0, sizeof all, &all) == 0) {
        for (size_t cpu = 0; cpu < PROCESSORS; cpu++) {
            pthread_t thread;
            cpu_set_t one;
            CPU_ZERO(&one);
            CPU_SET(cpu, &one);
            /* a thread begins where the one runs that creates it */
            if (CPU_ISSET(cpu, &all) && sched_setaffinity(0, sizeof one, &one) == 0) {
                pthread_create(&thread, NULL, nap_on, NULL);
            }
        }
        sched_setaffinity(0, sizeof all, &all);
    }
#endif
    nap_on(NULL);
}
