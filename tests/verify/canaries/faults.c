/* SPDX-License-Identifier: MIT
 *
 * Faults on purpose, one for each sanitizer: faults address|undefined|memory|thread. Under the
 * right one the program must not come to its end.
 */
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int shared;

static void *count(void *unused) {
    for (int i = 0; i < 100000; i++) {
        shared++;
    }
    return unused;
}

static void race(void) {
    pthread_t threads[2];
    for (int i = 0; i < 2; i++) {
        if (pthread_create(&threads[i], NULL, count, NULL) != 0) {
            exit(2);
        }
    }
    for (int i = 0; i < 2; i++) {
        pthread_join(threads[i], NULL);
    }
}

int main(int argc, char **argv) {
    const char *fault = argc > 1 ? argv[1] : "";
    volatile int one = 1;
    int *volatile block = malloc(4 * sizeof *block); /* volatile: its size is not known below */
    if (block == NULL) {
        return 2;
    }
    if (strcmp(fault, "address") == 0) {
        printf("%d\n", block[3 + one]);
    } else if (strcmp(fault, "undefined") == 0) {
        printf("%d\n", INT_MAX + one);
    } else if (strcmp(fault, "memory") == 0) {
        if (block[one] > 0) {
            puts("more than 0");
        }
    } else if (strcmp(fault, "thread") == 0) {
        race();
    }
    free(block);
    return 0;
}
