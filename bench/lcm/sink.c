/* SPDX-License-Identifier: MIT
 *
 * lcm_sink LCM_URL PERIOD_CYCLES SECONDS: counts the statuses of all robots on an LCM network, and
 * those that are missing: each service's robot_cycles must advance in steps of PERIOD_CYCLES.
 * Prints "channels C messages M lost L", of the time between the first full second and the end.
 */
#define _POSIX_C_SOURCE 200809L
#include <lcm/lcm.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define MAX_CHANNELS 5000
/* Where every status has its robot_cycles: after the fingerprint and the utime. */
#define CYCLES_AT 16

typedef struct counted {
    char channel[64];
    uint64_t cycles;
    uint64_t messages;
    uint64_t lost;
} counted;

typedef struct sink {
    counted channels[MAX_CHANNELS];
    size_t count, last;
    uint64_t period;
    int counting;
} sink;

static double now_s(void) {
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec / 1e9;
}

/* Channels come by turns, mostly: the search begins behind the last. */
static counted *find(sink *sink, const char *channel) {
    for (size_t step = 1; step <= sink->count; step++) {
        size_t index = (sink->last + step) % sink->count;
        if (strcmp(sink->channels[index].channel, channel) == 0) {
            sink->last = index;
            return &sink->channels[index];
        }
    }
    if (sink->count == MAX_CHANNELS || strlen(channel) >= sizeof sink->channels[0].channel) {
        return NULL;
    }
    counted *added = &sink->channels[sink->count++];
    memcpy(added->channel, channel, strlen(channel) + 1);
    return added;
}

static void on_message(const lcm_recv_buf_t *buffer, const char *channel, void *user) {
    sink *sink = user;
    const uint8_t *data = buffer->data;
    uint64_t cycles = 0;
    counted *counted = find(sink, channel);
    if (counted == NULL || buffer->data_size < CYCLES_AT + 8) {
        return;
    }
    for (size_t index = CYCLES_AT; index < CYCLES_AT + 8; index++) {
        cycles = cycles << 8 | data[index];
    }
    if (sink->counting != 0 && counted->cycles != 0) {
        counted->messages++;
        if (cycles != counted->cycles + sink->period) {
            counted->lost +=
                cycles > counted->cycles ? (cycles - counted->cycles) / sink->period - 1 : 1;
        }
    }
    counted->cycles = cycles;
}

int main(int count, char **arguments) {
    static sink sink;
    lcm_t *lcm = count == 4 ? lcm_create(arguments[1]) : NULL;
    if (lcm == NULL) {
        (void)fprintf(stderr, "usage: lcm_sink LCM_URL PERIOD_CYCLES SECONDS\n");
        return 1;
    }
    sink.period = strtoull(arguments[2], NULL, 10);
    double seconds = strtod(arguments[3], NULL);
    lcm_subscription_t *all = lcm_subscribe(
        lcm, ".*_(DIFFERENTIAL|LOCALIZATION|BATTERY|TELEMETER|IOCARD)", on_message, &sink);
    (void)lcm_subscription_set_queue_capacity(all, 0);
    double begun_s = now_s();
    while (now_s() < begun_s + 1.0 + seconds) {
        (void)lcm_handle_timeout(lcm, 10);
        sink.counting = now_s() > begun_s + 1.0;
    }
    unsigned long long messages = 0, lost = 0;
    for (size_t index = 0; index < sink.count; index++) {
        messages += sink.channels[index].messages;
        lost += sink.channels[index].lost;
    }
    (void)printf("channels %zu messages %llu lost %llu\n", sink.count, messages, lost);
    lcm_destroy(lcm);
    return 0;
}
