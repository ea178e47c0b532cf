/* SPDX-License-Identifier: MIT
 *
 * codec_bench: nanoseconds for decoding a status (every field read), for encoding it, and for
 * taking it through a client, against the project's aims. Figures, not a test: it never fails for
 * being slow.
 */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "roburoc4.h"
#include "roburoc4_sim.h"

#define REPETITIONS 31
#define REPETITION_NS 5e6
#define AIM_CODEC_NS 15.0
#define AIM_CLIENT_NS 60.0

/* Datagrams of all statuses, as a RobuROC4 sends them. */
typedef struct status {
    const char *name;
    uint8_t datagram[64];
    size_t size;
} status;

static status statuses[ROBUROC4_SERVICE_COUNT];
static roburoc4_client client;
static uint64_t now_us;
static uint64_t cycles = 1000000;
/* What was read goes here, so that no reading can be left out. */
static volatile double sink;

/* ---- what is measured ---- */

static double decode_iocard(const status *s) {
    roburoc4_iocard_status v;
    float volts;
    double sum;
    roburoc4_decode_iocard_status(s->datagram, s->size, ROBUROC4_AI_COUNT, ROBUROC4_DI_COUNT, &v);
    sum = (double)v.robot_cycles + v.service;
    for (uint32_t i = 0; i < v.analog_inputs; i++) {
        roburoc4_analog_input_at(&v, i, &volts);
        sum += (double)volts;
    }
    for (uint32_t i = 0; i < v.digital_inputs; i++) {
        sum += roburoc4_digital_input_at(&v, i);
    }
    return sum;
}

static double decode_telemeter(const status *s) {
    roburoc4_telemeter_status v;
    float distance_m;
    double sum;
    roburoc4_decode_telemeter_status(s->datagram, s->size, &v);
    sum = (double)v.robot_cycles + v.service;
    for (uint32_t i = 0; i < v.count; i++) {
        roburoc4_distance_at(&v, i, &distance_m);
        sum += (double)distance_m;
    }
    return sum;
}

static double decode_battery(const status *s) {
    roburoc4_battery_status v;
    roburoc4_decode_battery_status(s->datagram, s->size, &v);
    return (double)v.robot_cycles + v.service + v.state + v.remaining_percent;
}

static double decode_localization(const status *s) {
    roburoc4_localization_status v;
    roburoc4_decode_localization_status(s->datagram, s->size, &v);
    return (double)v.robot_cycles + v.service + v.x_m + v.y_m + v.theta_rad + v.flags;
}

static double decode_differential(const status *s) {
    roburoc4_differential_status v;
    roburoc4_decode_differential_status(s->datagram, s->size, &v);
    return (double)v.robot_cycles + v.service + (double)v.target_linear_m_s +
           (double)v.current_linear_m_s + (double)v.target_angular_rad_s +
           (double)v.current_angular_rad_s;
}

static double encode_iocard(const status *s) {
    static const float analog[ROBUROC4_AI_COUNT] = {1, 2, 24, 0, 0, 0, 0, 0, 0};
    static const uint8_t digital[3] = {1, 2, 3};
    uint8_t buffer[64];
    return roburoc4_encode_iocard_status(buffer, sizeof buffer, ROBUROC4_SERVICE_IOCARD, s->size,
                                         analog, ROBUROC4_AI_COUNT, digital, ROBUROC4_DI_COUNT) +
           buffer[20];
}

static double encode_telemeter(const status *s) {
    static const float distances_m[ROBUROC4_TELEMETER_COUNT] = {1, 2};
    uint8_t buffer[64];
    return roburoc4_encode_telemeter_status(buffer, sizeof buffer, ROBUROC4_SERVICE_TELEMETER,
                                            s->size, distances_m, ROBUROC4_TELEMETER_COUNT) +
           buffer[12];
}

static double encode_battery(const status *s) {
    const roburoc4_battery_status v = {s->size, ROBUROC4_BATTERY_OK, 80, ROBUROC4_SERVICE_BATTERY,
                                       0};
    uint8_t buffer[64];
    return roburoc4_encode_battery_status(buffer, sizeof buffer, &v) + buffer[12];
}

static double encode_localization(const status *s) {
    const roburoc4_localization_status v = {s->size, 1, 2, 3, 2, ROBUROC4_SERVICE_LOCALIZATION, 0};
    uint8_t buffer[64];
    return roburoc4_encode_localization_status(buffer, sizeof buffer, &v) + buffer[38];
}

static double encode_differential(const status *s) {
    const roburoc4_differential_status v = {s->size,  1, 2, 3, 4, ROBUROC4_SERVICE_DIFFERENTIAL,
                                            {0, 0, 0}};
    uint8_t buffer[64];
    return roburoc4_encode_differential_status(buffer, sizeof buffer, &v) + buffer[26];
}

/** A newer status each time: receive it, and ask whether there is anything to send. */
static double through_client(const status *s) {
    uint8_t datagram[64];
    uint8_t buffer[ROBUROC4_MAX_TRANSMIT];
    memcpy(datagram, s->datagram, sizeof datagram);
    cycles++;
    now_us++;
    for (unsigned i = 0; i < 8; i++) {
        datagram[3 + i] = (uint8_t)(cycles >> (8 * i));
    }
    return roburoc4_client_receive(&client, datagram, s->size, now_us) +
           roburoc4_client_poll_transmit(&client, buffer, sizeof buffer, now_us);
}

/* ---- measuring ---- */

/** The processor's time for this program: what else runs on the machine is not counted. */
static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

typedef double (*work)(const status *s);

static double ns_of(work what, const status *s, uint32_t times) {
    double sum = 0;
    const double begun = seconds();
    for (uint32_t i = 0; i < times; i++) {
        sum += what(s);
    }
    sink = sum;
    return (seconds() - begun) * 1e9;
}

/** The median nanoseconds of one call over several repetitions of a few milliseconds each. */
static double median_ns(work what, const status *s) {
    double results[REPETITIONS];
    uint32_t times = 1000;
    while (ns_of(what, s, times) < REPETITION_NS) {
        times *= 2;
    }
    for (size_t i = 0; i < REPETITIONS; i++) {
        results[i] = ns_of(what, s, times) / times;
    }
    qsort(results, REPETITIONS, sizeof results[0], ascending);
    return results[REPETITIONS / 2];
}

static void report(const char *what, const char *of, double ns, double aim_ns) {
    printf("| %-26s | %-12s | %6.1f | %3.0f | %-7s |\n", what, of, ns, aim_ns,
           ns <= aim_ns ? "reached" : "MISSED");
    fflush(stdout);
}

/* ---- making ready ---- */

/** Run client and robot in virtual time until the client is ready and knows all texts; keep the
 *  first status of each service. */
static int make_ready(void) {
    uint8_t datagram[ROBUROC4_SIM_MAX_TRANSMIT];
    uint64_t peer;
    roburoc4_facts facts;
    int kept = 0;
    roburoc4_sim *robot = roburoc4_sim_create(NULL);
    memset(&facts, 0, sizeof facts);
    facts.size = sizeof facts;
    if (robot == NULL || roburoc4_client_init(&client, sizeof client, NULL) < 0 ||
        roburoc4_client_start(&client, 0) < 0) {
        return 0;
    }
    for (now_us = 0; now_us < 10000000 && !(facts.descriptions_done && kept == 5); now_us += 1000) {
        int32_t size;
        roburoc4_sim_advance(robot, now_us);
        while ((size = (int32_t)roburoc4_sim_poll_transmit(robot, &peer, datagram,
                                                           sizeof datagram)) > 0) {
            if (datagram[0] == ROBUROC4_HEADER_STATUS && datagram[1] < ROBUROC4_SERVICE_COUNT &&
                (size_t)size <= sizeof statuses[0].datagram && statuses[datagram[1]].size == 0) {
                memcpy(statuses[datagram[1]].datagram, datagram, (size_t)size);
                statuses[datagram[1]].size = (size_t)size;
                kept++;
            }
            roburoc4_client_receive(&client, datagram, (size_t)size, now_us);
        }
        while ((size = roburoc4_client_poll_transmit(&client, datagram, sizeof datagram, now_us)) >
               0) {
            roburoc4_sim_receive(robot, 1, datagram, (size_t)size);
        }
        roburoc4_client_facts(&client, now_us, &facts);
    }
    roburoc4_sim_destroy(robot);
    return kept == 5 && roburoc4_client_state(&client) == ROBUROC4_STATE_READY;
}

int main(void) {
    static const work decoders[ROBUROC4_SERVICE_COUNT] = {NULL,
                                                          NULL,
                                                          decode_iocard,
                                                          decode_telemeter,
                                                          decode_battery,
                                                          decode_localization,
                                                          decode_differential};
    static const work encoders[ROBUROC4_SERVICE_COUNT] = {NULL,
                                                          NULL,
                                                          encode_iocard,
                                                          encode_telemeter,
                                                          encode_battery,
                                                          encode_localization,
                                                          encode_differential};
    if (!make_ready()) {
        fputs("codec_bench: the client did not get ready with the simulated robot\n", stderr);
        return 1;
    }
    puts("| what                       | status       |     ns | aim | result  |");
    puts("| -------------------------- | ------------ | ------ | --- | ------- |");
    for (uint32_t k = ROBUROC4_SERVICE_IOCARD; k < ROBUROC4_SERVICE_COUNT; k++) {
        report("decode, every field read", roburoc4_service_name(k),
               median_ns(decoders[k], &statuses[k]), AIM_CODEC_NS);
    }
    for (uint32_t k = ROBUROC4_SERVICE_IOCARD; k < ROBUROC4_SERVICE_COUNT; k++) {
        report("encode", roburoc4_service_name(k), median_ns(encoders[k], &statuses[k]),
               AIM_CODEC_NS);
    }
    for (uint32_t k = ROBUROC4_SERVICE_IOCARD; k < ROBUROC4_SERVICE_COUNT; k++) {
        const uint32_t dropped = roburoc4_client_count(&client, ROBUROC4_COUNT_OLD);
        report("receive and poll, client", roburoc4_service_name(k),
               median_ns(through_client, &statuses[k]), AIM_CLIENT_NS);
        if (roburoc4_client_count(&client, ROBUROC4_COUNT_OLD) != dropped ||
            roburoc4_client_state(&client) != ROBUROC4_STATE_READY) {
            fputs("codec_bench: the client did not use the statuses that it was given\n", stderr);
            return 1;
        }
    }
    return 0;
}
