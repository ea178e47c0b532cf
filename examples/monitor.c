/* SPDX-License-Identifier: MIT
 *
 * monitor: connect, and show what the robot reports. It never commands.
 *
 * A pump's thread keeps the link. This thread prints the latest values each second, or,
 * with --all, reads every status from the pump's queue.
 */
#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "roburoc4_pump.h"

enum { EXIT_DONE = 0, EXIT_USAGE = 2, EXIT_ABSENT = 3 };

#define CONNECT_US 5000000u /* silence */
#define FAULT_US 1500000u   /* nobody on the port, no route, cable out: known at once */
#define WAIT_US 200000u
#define LINE_US 1000000u
#define DEGREES_PER_RADIAN 57.29577951308232

static volatile sig_atomic_t interrupted;

static void on_signal(int number) {
    interrupted = number;
}

static uint32_t state_of(roburoc4_pump *pump) {
    uint32_t state = roburoc4_client_state(roburoc4_pump_lock(pump));
    roburoc4_pump_unlock(pump);
    return state;
}

/* A channel's name: the robot's own text, else the manual's, else its number. */
static const char *channel(roburoc4_pump *pump, int32_t io_type, uint32_t index, char *room,
                           size_t size) {
    const char *manual = roburoc4_client_channel_name(NULL, (uint32_t)io_type, index);
    if (roburoc4_pump_description(pump, io_type, index, room, size) > 0) {
        for (char *c = room; *c != '\0'; c++) {
            *c = *c >= ' ' && *c <= '~' ? *c : '?'; /* so that no text can control the terminal */
        }
        return room;
    }
    if (manual != NULL && manual[0] != '\0') {
        return manual;
    }
    snprintf(room, size, "input %" PRIu32, index);
    return room;
}

/* The names of the inputs that are on, or "none", cut where the room ends. */
static const char *pressed(roburoc4_pump *pump, const roburoc4_inputs *inputs, char *out,
                           size_t size) {
    char room[ROBUROC4_PUMP_DESCRIPTION_SIZE];
    size_t length = 0;
    snprintf(out, size, "none");
    for (uint32_t i = 0; i < inputs->digital_count && length < size; i++) {
        if (inputs->digital >> i & 1) {
            length +=
                (size_t)snprintf(out + length, size - length, "%s%s", length > 0 ? ", " : "",
                                 channel(pump, ROBUROC4_IO_DIGITAL_INPUT, i, room, sizeof room));
        }
    }
    return out;
}

static void print_inputs(roburoc4_pump *pump, const roburoc4_inputs *inputs) {
    char room[ROBUROC4_PUMP_DESCRIPTION_SIZE], on[1024];
    for (uint32_t i = 0; i < inputs->analog_count; i++) {
        const char *name = channel(pump, ROBUROC4_IO_ANALOG_INPUT, i, room, sizeof room);
        printf("%s %.2f%s; ", name, (double)inputs->analog[i], strstr(name, "olt") ? " V" : "");
    }
    printf("on: %s\n", pressed(pump, inputs, on, sizeof on));
}

static void print_distances(const roburoc4_distances *distances) {
    static const char *const ends[] = {"front", "rear"};
    for (uint32_t i = 0; i < distances->count; i++) {
        printf("%s%s %.2f m", i > 0 ? ", " : "", i < 2 ? ends[i] : "next",
               (double)distances->distances_m[i]);
    }
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
    const roburoc4_sample_value *value = &sample->value;
    const char *state = NULL;

    printf("%10.2f s  %-12s  ", (double)sample->robot_cycles * 0.01,
           roburoc4_name(ROBUROC4_NAME_SERVICE, sample->service));
    switch (sample->service) {
    case ROBUROC4_SERVICE_IOCARD:
        print_inputs(pump, &value->inputs);
        break;
    case ROBUROC4_SERVICE_TELEMETER:
        print_distances(&value->distances);
        printf("\n");
        break;
    case ROBUROC4_SERVICE_BATTERY:
        state = roburoc4_name(ROBUROC4_NAME_BATTERY, value->battery.state);
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

/* ------------------------------------------------------------------------- the latest values ---
 */

/* What was not reported yet is 0, or NaN where 0 would mean something. */
typedef struct latest {
    roburoc4_localization_status pose;
    roburoc4_differential_status motion;
    char battery[40];
    roburoc4_distances distances;
    roburoc4_facts facts;
} latest;

/* The pump's link waits while its lock is held: copy, then print. */
static void look(roburoc4_pump *pump, latest *out) {
    roburoc4_battery_status battery;
    memset(out, 0, sizeof *out);
    out->facts.size = sizeof out->facts;
    const roburoc4_client *client = roburoc4_pump_lock(pump);
    roburoc4_client_facts(client, roburoc4_udp_now_us(), &out->facts);
    if (roburoc4_client_localization(client, &out->pose, NULL) < 0) {
        out->pose.x_m = out->pose.y_m = out->pose.theta_rad = NAN;
    }
    if (roburoc4_client_differential(client, &out->motion, NULL) < 0) {
        out->motion.current_linear_m_s = out->motion.current_angular_rad_s = NAN;
        out->motion.target_linear_m_s = out->motion.target_angular_rad_s = NAN;
    }
    snprintf(out->battery, sizeof out->battery, "not reported yet");
    if (roburoc4_client_battery(client, &battery, NULL) == 0) {
        const char *state = roburoc4_name(ROBUROC4_NAME_BATTERY, battery.state);
        snprintf(out->battery, sizeof out->battery, "%u %%, %s",
                 (unsigned)battery.remaining_percent, state != NULL ? state : "unknown state");
    }
    roburoc4_client_distances(client, &out->distances, NULL);
    roburoc4_pump_unlock(pump);
}

static void print_line(const latest *now) {
    if (now->facts.state != ROBUROC4_STATE_READY) {
        printf("%s\n", roburoc4_name(ROBUROC4_NAME_STATE, now->facts.state));
        return;
    }
    printf("x %.2f m, y %.2f m, %.1f deg; %.2f m/s, %.2f rad/s; ", now->pose.x_m, now->pose.y_m,
           now->pose.theta_rad * DEGREES_PER_RADIAN, (double)now->motion.current_linear_m_s,
           (double)now->motion.current_angular_rad_s);
    print_distances(&now->distances);
    printf("; battery %s%s%s%s\n", now->battery, now->facts.overridden ? "; game pad [A] held" : "",
           now->facts.front_bumper ? "; front bumper" : "",
           now->facts.rear_bumper ? "; rear bumper" : "");
}

static void show_latest(roburoc4_pump *pump, uint64_t until_us) {
    roburoc4_pump_reader reader;
    roburoc4_pump_reader_init(pump, &reader);
    roburoc4_pump_wait_events(pump, &reader, ROBUROC4_EVENT_TELEMETER, WAIT_US);
    for (uint64_t line_us = 0; !interrupted && roburoc4_udp_now_us() < until_us;) {
        if (roburoc4_udp_now_us() - line_us >= LINE_US) {
            latest now;
            line_us = roburoc4_udp_now_us();
            look(pump, &now);
            print_line(&now);
            fflush(stdout);
        }
        roburoc4_pump_wait_events(pump, &reader, ROBUROC4_EVENT_STATE, WAIT_US);
        roburoc4_pump_take_events(pump, &reader);
    }
}

/* ------------------------------------------------------------------------------ every status ---
 */

static void show_all(roburoc4_pump *pump, uint64_t until_us) {
    roburoc4_pump_reader reader;
    roburoc4_pump_reader_init(pump, &reader);
    while (!interrupted && roburoc4_udp_now_us() < until_us) {
        roburoc4_sample sample;
        roburoc4_pump_wait_samples(pump, &reader, WAIT_US);
        while (roburoc4_pump_read_samples(pump, &reader, &sample, 1) > 0) {
            print_sample(pump, &sample);
        }
        if (roburoc4_pump_take_events(pump, &reader) & ROBUROC4_EVENT_STATE) {
            printf("%s\n", roburoc4_name(ROBUROC4_NAME_STATE, state_of(pump)));
        }
        fflush(stdout);
    }
}

/* Wait until the robot is ready. Returns 0, with a message, if there is none. */
static int connected(roburoc4_pump *pump, const char *host) {
    roburoc4_pump_reader reader = {0};
    uint64_t begun_us = roburoc4_udp_now_us();
    while (!interrupted &&
           roburoc4_pump_wait_events(pump, &reader, ROBUROC4_EVENT_READY, WAIT_US) == 0) {
        roburoc4_pump_lock(pump);
        uint32_t fault = roburoc4_pump_udp(pump)->fault;
        roburoc4_pump_unlock(pump);
        if (roburoc4_udp_now_us() - begun_us >= (fault ? FAULT_US : CONNECT_US)) {
            fprintf(stderr, "monitor: no robot answers at %s: %s\n", host,
                    fault ? roburoc4_udp_fault_text(fault)
                          : "silence for 5 s; is it on, is the cable in, is this its address?");
            return 0;
        }
    }
    return 1;
}

int main(int argc, char **argv) {
    const char *host = ROBUROC4_DEFAULT_HOST;
    double seconds = 0.0;
    int hosts = 0, all = 0;
    for (int i = 1; i < argc; i++) {
        char *end = NULL;
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            printf("Usage: monitor [--all] [--seconds N] [HOST[:PORT]]\n"
                   "Print what a RobuROC4 (default %s:%d) reports, a line each second. It never\n"
                   "commands the robot. Ctrl-C ends it.\n"
                   "  --all        print every status as it arrives, about 75 lines a second\n"
                   "  --seconds N  end after N s\n"
                   "Exit status: 0 done, 2 bad usage, 3 no robot there.\n",
                   ROBUROC4_DEFAULT_HOST, ROBUROC4_DEFAULT_PORT);
            return EXIT_DONE;
        }
        if (strcmp(argv[i], "--all") == 0) {
            all = 1;
            continue;
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
    roburoc4_pump *pump =
        result == 0 ? roburoc4_pump_create(&address, NULL, 0, NULL, &result) : NULL;
    if (pump == NULL) {
        fprintf(stderr, "monitor: %s: %s\n", host, roburoc4_result_text(result));
        return result == ROBUROC4_ERR_ADDRESS ? EXIT_USAGE : EXIT_ABSENT;
    }
    signal(SIGINT, on_signal);
    signal(SIGTERM, on_signal);
    int code = connected(pump, host) ? EXIT_DONE : EXIT_ABSENT;
    if (code == EXIT_DONE) {
        uint64_t until_us =
            seconds > 0.0 ? roburoc4_udp_now_us() + (uint64_t)(seconds * 1e6) : UINT64_MAX;
        if (all) {
            show_all(pump, until_us);
        } else {
            show_latest(pump, until_us);
        }
    }
    roburoc4_pump_destroy(pump);
    return code;
}
