/* SPDX-License-Identifier: MIT
 *
 * For LD_PRELOAD: the wall clock is two seconds behind while the file $CLOCK_STEP_FILE exists.
 */
#define _GNU_SOURCE
#include <stdlib.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

int clock_gettime(clockid_t clock, struct timespec *now) {
    const char *file = getenv("CLOCK_STEP_FILE");
    int result = (int)syscall(SYS_clock_gettime, clock, now);
    if (result == 0 && clock == CLOCK_REALTIME && file != NULL && access(file, F_OK) == 0) {
        now->tv_sec -= 2;
    }
    return result;
}
