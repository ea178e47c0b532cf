/* SPDX-License-Identifier: MIT
 *
 * arming [RUNS]: how long a client takes from its start until it can be armed, in virtual time, by
 * round trip and loss of each direction. Prints median and 90th percentile of so many runs (default
 * 1000), in each of which the network loses other datagrams.
 */
#include <stdio.h>
#include <stdlib.h>

#include "roburoc4.h"
#include "roburoc4_sim.h"

#define MS 1000
#define PATIENCE_US 120000000

static int failed(const char *what) {
    fprintf(stderr, "arming: %s\n", what);
    exit(1);
}

static void run_to(roburoc4_world *world, uint64_t until_us) {
    while (roburoc4_world_step(world, until_us, NULL, NULL) != 0) {
    }
}

/** The time that one client takes, which tries each millisecond; each gets a network of its own. */
static uint64_t arm(roburoc4_world *world) {
    static roburoc4_client client;
    uint64_t now_us = roburoc4_world_now_us(world);
    const uint64_t start_us = now_us;
    if (roburoc4_client_init(&client, sizeof client, NULL) < 0 ||
        roburoc4_world_join(world, &client) < 0) {
        failed("a client cannot start");
    }
    while (roburoc4_client_arm(&client, now_us) < 0) {
        now_us += MS;
        if (now_us - start_us > PATIENCE_US) {
            failed("a client could not be armed within two minutes");
        }
        run_to(world, now_us);
    }
    roburoc4_world_leave(world, &client);
    return now_us - start_us;
}

static void measure(uint32_t round_trip_us, double loss, uint64_t *times, size_t runs) {
    const roburoc4_sim_faults faults = {
        .size = sizeof faults, .delay_us = round_trip_us / 2, .loss = loss};
    roburoc4_world *world = roburoc4_world_create(NULL);
    if (world == NULL || roburoc4_world_set_faults(world, &faults) < 0) {
        failed("there is no world");
    }
    for (size_t i = 0; i < runs; i++) {
        /* the robot forgets the last one; 61: somewhere within its periods */
        run_to(world, roburoc4_world_now_us(world) + 20000 * MS + i * 61 % 100 * MS);
        times[i] = arm(world);
    }
    roburoc4_world_destroy(world);
}

static int compare(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a;
    const uint64_t y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv) {
    const long runs = argc > 1 ? strtol(argv[1], NULL, 10) : 1000;
    uint64_t *times = runs > 0 && runs <= 1000000 ? calloc((size_t)runs, sizeof *times) : NULL;
    if (times == NULL) {
        return failed("give a number of runs, 1 to 1000000");
    }
    printf("round trip   loss    median       90 %%\n");
    for (uint32_t round_trip_us = MS; round_trip_us <= 10 * MS; round_trip_us *= 10) {
        for (int percent = 0; percent <= 30; percent += 30) {
            measure(round_trip_us, percent / 100.0, times, (size_t)runs);
            const size_t middle = (size_t)(runs / 2);
            const size_t late = (size_t)(runs * 9 / 10);
            qsort(times, (size_t)runs, sizeof *times, compare);
            printf("%7u ms  %3d %%  %5.0f ms  %6.0f ms\n", (unsigned)(round_trip_us / MS), percent,
                   1e-3 * (double)times[middle], 1e-3 * (double)times[late]);
            fflush(stdout);
        }
    }
    free(times);
    return 0;
}
