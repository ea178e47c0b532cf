/* SPDX-License-Identifier: MIT
 *
 * stalls: prints how many milliseconds too late a nap ended, if that is too late for a robot's
 * client. On Linux, a thread naps on each processor, since one of them may stall alone.
 */
#define _GNU_SOURCE /* sched_setaffinity */
#include <pthread.h>
#include <stdio.h>
#include <time.h>
#ifdef __linux__
#include <sched.h>
#endif

#define NAP_MS 20
/* A program gives up after 300 ms without a status: two such stalls in a row can cause that. */
#define TOO_LATE_MS 100
#define PROCESSORS 64U

static long long now_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1000LL + now.tv_nsec / 1000000;
}

static void *nap_on(void *unused) {
    const struct timespec nap = {0, NAP_MS * 1000000L};
    (void)unused;
    for (;;) {
        const long long begun_ms = now_ms();
        nanosleep(&nap, NULL);
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
