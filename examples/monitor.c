/* SPDX-License-Identifier: MIT
 *
 * monitor: connect, and print every status that comes, by name and unit. It never commands.
 *
 * A pump's thread keeps the link; this thread reads each sample from its queue.
 */
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "roburoc4_pump.h"

enum { EXIT_DONE = 0, EXIT_USAGE = 2, EXIT_ABSENT = 3 };

#define CONNECT_US 10000000u
#define WAIT_US 200000u

static volatile sig_atomic_t interrupted;

static void on_signal(int number) {
    interrupted = number;
}

/* A channel's name: the robot's own text, else the manual's, else its number. */
static const char *channel(roburoc4_pump *pump, int32_t io_type, uint32_t index, char *room,
                           size_t size) {
    const char *manual = roburoc4_channel_name((uint32_t)io_type, index);
    if (roburoc4_pump_description(pump, io_type, index, room, size) > 0) {
        for (char *c = room; *c != '\0'; c++) {
            *c = *c >= ' ' && *c <= '~' ? *c : '?'; /* no text commands the terminal */
        }
        return room;
    }
    if (manual != NULL && manual[0] != '\0') {
        return manual;
    }
    snprintf(room, size, "input %" PRIu32, index);
    return room;
}

static void print_inputs(roburoc4_pump *pump, const roburoc4_inputs *inputs) {
    char room[ROBUROC4_PUMP_DESCRIPTION_MAX + 1];
    const char *pressed = "";
    for (uint32_t i = 0; i < inputs->analog_count; i++) {
        const char *name = channel(pump, ROBUROC4_IO_ANALOG_INPUT, i, room, sizeof room);
        printf("%s %.2f%s; ", name, (double)inputs->analog[i], strstr(name, "olt") ? " V" : "");
    }
    printf("on:");
    for (uint32_t i = 0; i < inputs->digital_count; i++) {
        if (inputs->digital >> i & 1) {
            printf("%s %s", pressed,
                   channel(pump, ROBUROC4_IO_DIGITAL_INPUT, i, room, sizeof room));
            pressed = ",";
        }
    }
    printf("%s\n", pressed[0] ? "" : " none");
}

static void print_localization(const roburoc4_localization_status *pose) {
    static const char *const names[] = {"invalid",     "metric",         "decimetric",
                                        "centimetric", "proprioceptive", "exteroceptive",
                                        "error"};
    printf("x %.3f m, y %.3f m, theta %.3f rad;", pose->x_m, pose->y_m, pose->theta_rad);
    for (uint32_t bit = 0; bit < sizeof names / sizeof names[0]; bit++) {
        if (pose->flags >> bit & 1) {
            printf(" %s", names[bit]);
        }
    }
    printf("\n");
}

static void print_sample(roburoc4_pump *pump, const roburoc4_sample *sample) {
    static const char *const ends[] = {"front", "rear"};
    const roburoc4_sample_value *value = &sample->value;
    const char *state = NULL;

    printf("%10.2f s  %-12s  ", (double)sample->robot_cycles * 0.01,
           roburoc4_service_name(sample->service));
    switch (sample->service) {
    case ROBUROC4_SERVICE_IOCARD:
        print_inputs(pump, &value->inputs);
        break;
    case ROBUROC4_SERVICE_TELEMETER:
        for (uint32_t i = 0; i < value->distances.count; i++) {
            printf("%s %.2f m  ", i < 2 ? ends[i] : "next", (double)value->distances.distance_m[i]);
        }
        printf("\n");
        break;
    case ROBUROC4_SERVICE_BATTERY:
        state = roburoc4_battery_state_name(value->battery.state);
        printf("%u %%, %s\n", (unsigned)value->battery.remaining_percent,
               state != NULL ? state : "unknown state");
        break;
    case ROBUROC4_SERVICE_LOCALIZATION:
        print_localization(&value->localization);
        break;
    default:
        printf("linear %.3f m/s (target %.3f), angular %.3f rad/s (target %.3f)\n",
               (double)value->differential.current_linear_m_s,
               (double)value->differential.target_linear_m_s,
               (double)value->differential.current_angular_rad_s,
               (double)value->differential.target_angular_rad_s);
    }
}

/* Until a signal, or the end of the time. */
static int watch(roburoc4_pump *pump, const char *host, uint64_t until_us) {
    roburoc4_pump_reader reader;
    roburoc4_pump_reader_init(pump, &reader);
    for (uint64_t begun_us = roburoc4_udp_now_us();
         roburoc4_pump_state(pump) != ROBUROC4_STATE_READY;) {
        if (interrupted) {
            return EXIT_DONE;
        }
        if (roburoc4_udp_now_us() - begun_us >= CONNECT_US) {
            uint32_t fault = roburoc4_pump_fault(pump);
            fprintf(stderr, "monitor: no robot answers at %s (%s)\n", host,
                    fault ? roburoc4_udp_fault_text(fault) : "no answer within 10 s; is it on?");
            return EXIT_ABSENT;
        }
        roburoc4_pump_wait_events(pump, &reader, ROBUROC4_EVENT_READY, WAIT_US);
    }
    while (!interrupted && roburoc4_udp_now_us() < until_us) {
        roburoc4_sample sample;
        roburoc4_pump_wait_samples(pump, &reader, WAIT_US);
        while (roburoc4_pump_read_samples(pump, &reader, &sample, 1) > 0) {
            print_sample(pump, &sample);
        }
        if (roburoc4_pump_take_events(pump, &reader) & ROBUROC4_EVENT_STATE) {
            printf("%s\n", roburoc4_state_name(roburoc4_pump_state(pump)));
        }
        fflush(stdout);
    }
    return EXIT_DONE;
}

int main(int argc, char **argv) {
    const char *host = ROBUROC4_DEFAULT_HOST;
    double seconds = 0.0;
    int hosts = 0;
    for (int i = 1; i < argc; i++) {
        char *end = NULL;
        if (strcmp(argv[i], "--help") == 0) {
            printf("Usage: monitor [--seconds N] [HOST[:PORT]]\n"
                   "Print every status of a RobuROC4 (default %s:%d), until Ctrl-C or for N s.\n"
                   "Exit status: 0 done, 2 bad usage, 3 no robot there.\n",
                   ROBUROC4_DEFAULT_HOST, ROBUROC4_DEFAULT_PORT);
            return EXIT_DONE;
        }
        if (strcmp(argv[i], "--version") == 0) {
            printf("monitor %d.%d.%d\n", ROBUROC4_VERSION_MAJOR, ROBUROC4_VERSION_MINOR,
                   ROBUROC4_VERSION_PATCH);
            return EXIT_DONE;
        }
        if (strcmp(argv[i], "--seconds") == 0 && i + 1 < argc) {
            seconds = strtod(argv[++i], &end);
            if (*end == '\0' && seconds > 0.0 && seconds < 1e9) {
                continue;
            }
        } else if (argv[i][0] != '-' && hosts++ == 0) {
            host = argv[i];
            continue;
        }
        fprintf(stderr, "monitor: cannot use '%s'; see monitor --help\n", argv[i]);
        return EXIT_USAGE;
    }

    roburoc4_address address;
    roburoc4_result result = roburoc4_udp_resolve(host, 0, &address);
    roburoc4_pump *pump = result == 0 ? roburoc4_pump_create(&address, NULL, 0, &result) : NULL;
    if (pump == NULL) {
        fprintf(stderr,
                "monitor: '%s': %s; give the robot's name or address, and :PORT (1 to 65535) "
                "if it is not %d\n",
                host, roburoc4_result_text(result), ROBUROC4_DEFAULT_PORT);
        return result == ROBUROC4_ERR_ARGUMENT ? EXIT_USAGE : EXIT_ABSENT;
    }
    signal(SIGINT, on_signal);
    signal(SIGTERM, on_signal);
    int code = watch(
        pump, host, seconds > 0.0 ? roburoc4_udp_now_us() + (uint64_t)(seconds * 1e6) : UINT64_MAX);
    roburoc4_pump_destroy(pump);
    return code;
}
