/* SPDX-License-Identifier: MIT
 *
 * drive_square: arm, drive a square of 2 m to the left by odometry, stop, say where it ended.
 *
 * The order of a program that drives: connect, wait for ready, arm, then one drive() for each new
 * pose. A lease is renewed only on news: when poses stop coming, the robot stops.
 * What is printed is in drive_report.c.
 */
#define _POSIX_C_SOURCE 200809L

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "drive_report.h"
#include "roburoc4_udp.h"

#define PI 3.14159265358979323846
#define SIDE_M 2.0
#define ANSWER_S 0.4        /* about what a RobuROC4 takes to follow a speed */
#define CONNECT_US 5000000u /* silence */
#define FAULT_US 1500000u   /* nobody on the port, no route, cable out: known at once */
#define ARM_US 3000000u
#define DRIVE_US 120000000u
#define POSE_US 1000000u
#define FAR_M 1e6 /* no robot comes so far; no NaN is less than anything */

enum { EXIT_DROVE = 0, EXIT_FAILED = 1, EXIT_USAGE = 2, EXIT_ABSENT = 3 };

static volatile sig_atomic_t interrupted;

static void on_signal(int number) {
    interrupted = number;
}

/* The square in odometry: where it began, and how far it has come. */
typedef struct square {
    double x_m, y_m, theta_rad; /* start of the present side */
    int sides;                  /* completed, with the turn at their end */
    int turning;
} square;

typedef struct speeds {
    double linear_m_s, angular_rad_s;
} speeds;

static double within(double value, double limit) {
    return fmax(-limit, fmin(limit, value));
}

static double wrapped(double angle_rad) {
    return remainder(angle_rad, 2.0 * PI);
}

/* A speed towards what is missing: slower towards the end, and by where the robot will be when it
 * has answered to what it was told before. */
static double approach(double missing, double speed, double limit) {
    double ahead = missing - ANSWER_S * speed;
    return copysign(fmin(limit, 0.03 + 1.3 * fabs(ahead)), ahead);
}

/* Along the side, steering back to its line. */
static speeds follow_side(square *at, const roburoc4_localization_status *pose,
                          const roburoc4_differential_status *motion) {
    double dx = pose->x_m - at->x_m, dy = pose->y_m - at->y_m;
    double left = SIDE_M - (dx * cos(at->theta_rad) + dy * sin(at->theta_rad));
    double aside = dy * cos(at->theta_rad) - dx * sin(at->theta_rad);
    double heading = wrapped(at->theta_rad - within(aside, 0.5) - pose->theta_rad);
    speeds ask = {0.0, 0.0};

    if (fabs(left) > 0.04) {
        ask.linear_m_s = approach(left, (double)motion->current_linear_m_s, 0.75);
        ask.angular_rad_s = approach(heading, (double)motion->current_angular_rad_s, 0.4);
    } else {
        at->turning = fabs((double)motion->current_linear_m_s) < 0.04;
    }
    return ask;
}

/* In place, until the next side lies ahead. */
static speeds turn_left(square *at, const roburoc4_localization_status *pose,
                        const roburoc4_differential_status *motion) {
    double next_rad = wrapped(at->theta_rad + PI / 2.0);
    double missing = wrapped(next_rad - pose->theta_rad);
    speeds ask = {0.0, 0.0};

    if (fabs(missing) > 0.03) {
        ask.angular_rad_s = approach(missing, (double)motion->current_angular_rad_s, 1.2);
    } else if (fabs((double)motion->current_angular_rad_s) < 0.05) {
        at->x_m += SIDE_M * cos(at->theta_rad);
        at->y_m += SIDE_M * sin(at->theta_rad);
        at->theta_rad = next_rad;
        at->turning = 0;
        at->sides += 1;
    }
    return ask;
}

/* Wait on the network until one of the events, a signal, or the time is over; returns what came. */
static uint32_t wait_for(roburoc4_udp *udp, roburoc4_client *client, uint32_t events,
                         uint64_t until_us) {
    uint32_t seen = 0;
    while (!interrupted && !(seen & events) && roburoc4_udp_now_us() < until_us) {
        if (roburoc4_udp_wait(udp, client, 50000) < 0) {
            break;
        }
        seen |= roburoc4_client_take_events(client);
    }
    return seen;
}

/* Wait for the robot; EXIT_ABSENT, with a message, where there is none. */
static int connect_robot(roburoc4_udp *udp, roburoc4_client *client, const char *host) {
    uint64_t begun_us = roburoc4_udp_now_us();
    uint32_t seen = 0, fault = 0;
    while (!interrupted && !(seen & ROBUROC4_EVENT_READY) &&
           roburoc4_udp_now_us() - begun_us < (fault ? FAULT_US : CONNECT_US)) {
        seen = wait_for(udp, client, ROBUROC4_EVENT_READY, roburoc4_udp_now_us() + 100000);
        fault = roburoc4_udp_fault(udp);
    }
    if (!(seen & ROBUROC4_EVENT_READY) && !interrupted) {
        fprintf(stderr, "drive_square: no robot answers at %s: %s\n", host,
                fault ? roburoc4_udp_fault_text(fault)
                      : "silence for 5 s; is it on, is the cable in, is this its address?");
    }
    return seen & ROBUROC4_EVENT_READY ? EXIT_DROVE : EXIT_ABSENT;
}

static int arm(roburoc4_udp *udp, roburoc4_client *client) {
    uint64_t until_us = roburoc4_udp_now_us() + ARM_US;
    roburoc4_result result = roburoc4_client_arm(client, roburoc4_udp_now_us());
    while (result < 0 && !interrupted && roburoc4_udp_now_us() < until_us) {
        wait_for(udp, client, ROBUROC4_EVENT_IOCARD | ROBUROC4_EVENT_DIFFERENTIAL, until_us);
        result = roburoc4_client_arm(client, roburoc4_udp_now_us());
    }
    if (result < 0 && !interrupted) {
        fprintf(stderr, "drive_square: the robot cannot be armed: %s\n",
                roburoc4_result_text(result));
    }
    return result == 0 ? EXIT_DROVE : EXIT_FAILED;
}

/* A pose to steer by: a NaN would make every distance look covered. */
static int usable(const roburoc4_localization_status *pose) {
    return fabs(pose->x_m) < FAR_M && fabs(pose->y_m) < FAR_M && fabs(pose->theta_rad) < FAR_M &&
           !(pose->flags & (ROBUROC4_LOCALIZATION_INVALID | ROBUROC4_LOCALIZATION_ERROR));
}

/* Why the robot cannot go on, or NULL. */
static const char *trouble(const roburoc4_client *client, uint64_t until_us, uint64_t posed_us) {
    roburoc4_facts facts;
    facts.size = sizeof facts;
    roburoc4_client_facts(client, roburoc4_udp_now_us(), &facts);
    if (roburoc4_udp_now_us() - posed_us >= POSE_US) {
        return "no usable pose from the localization service for 1 s";
    }
    if (!facts.armed) {
        return roburoc4_result_text(facts.disarm_cause);
    }
    if (facts.inhibited) {
        return "the robot does not move (emergency stop, brakes or bumper?)";
    }
    if (roburoc4_udp_now_us() >= until_us) {
        return "the square took too long";
    }
    return NULL;
}

static int drive(roburoc4_udp *udp, roburoc4_client *client, drive_report *report) {
    uint64_t until_us = roburoc4_udp_now_us() + DRIVE_US;
    uint64_t posed_us = roburoc4_udp_now_us();
    square at = {0.0, 0.0, 0.0, 0, 0};
    const char *stopped = NULL;
    int begun = 0;

    while (at.sides < 4 && !interrupted && stopped == NULL) {
        uint32_t seen = wait_for(udp, client,
                                 ROBUROC4_EVENT_LOCALIZATION | ROBUROC4_EVENT_DISARMED |
                                     ROBUROC4_EVENT_INHIBITED,
                                 posed_us + POSE_US);
        roburoc4_localization_status pose;
        roburoc4_differential_status motion;

        stopped = trouble(client, until_us, posed_us);
        if (stopped != NULL || !(seen & ROBUROC4_EVENT_LOCALIZATION) ||
            roburoc4_client_localization(client, &pose, NULL) < 0 || !usable(&pose) ||
            roburoc4_client_differential(client, &motion, NULL) < 0) {
            continue;
        }
        posed_us = roburoc4_udp_now_us();
        if (!begun) {
            at = (square){pose.x_m, pose.y_m, pose.theta_rad, 0, 0};
        }
        begun = 1;
        speeds ask = at.turning ? turn_left(&at, &pose, &motion) : follow_side(&at, &pose, &motion);
        roburoc4_client_drive(client, (float)ask.linear_m_s, (float)ask.angular_rad_s, 0,
                              roburoc4_udp_now_us());
        drive_report_pose(report, client, &pose, &motion);
    }
    drive_report_break(report);
    if (stopped != NULL) {
        fprintf(stderr, "drive_square: stopped on side %d: %s\n", at.sides + 1, stopped);
    }
    return at.sides == 4 ? EXIT_DROVE : EXIT_FAILED;
}

/* Everything between an open socket and the last zero command. */
static int run(roburoc4_udp *udp, const char *host, drive_report *report) {
    roburoc4_client client;
    roburoc4_config config;
    roburoc4_config_init(&config, sizeof config);
    config.max_linear_m_s = 0.8f; /* a ceiling that no mistake above can raise */
    config.max_angular_rad_s = 1.3f;
    roburoc4_client_init(&client, sizeof client, &config);
    roburoc4_client_start(&client, roburoc4_udp_now_us());

    int code = connect_robot(udp, &client, host);
    if (code == EXIT_DROVE) {
        code = arm(udp, &client);
    }
    if (code == EXIT_DROVE) {
        code = drive(udp, &client, report);
    }

    roburoc4_client_close(&client, roburoc4_udp_now_us());
    while (roburoc4_client_state(&client) != ROBUROC4_STATE_IDLE &&
           roburoc4_udp_wait(udp, &client, 50000) >= 0) {
        ;
    }
    if (code != EXIT_ABSENT) {
        drive_report_end(report, &client);
    }
    return interrupted ? 128 + (int)interrupted : code;
}

static void help(void) {
    printf("Usage: drive_square [--csv FILE] [HOST[:PORT]]\n"
           "Drive a RobuROC4 (default %s:%d) around a square of 2 m to its left.\n"
           "  --csv FILE  write the poses that odometry gave\n"
           "  --help, --version\n"
           "Exit status: 0 driven, 1 not (all the way), 2 bad usage, 3 no robot there.\n",
           ROBUROC4_DEFAULT_HOST, ROBUROC4_DEFAULT_PORT);
}

int main(int argc, char **argv) {
    const char *host = ROBUROC4_DEFAULT_HOST, *csv = NULL;
    int hosts = 0;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--help") == 0) {
            help();
            return EXIT_DROVE;
        }
        if (strcmp(argv[i], "--version") == 0) {
            printf("drive_square %d.%d.%d\n", ROBUROC4_VERSION_MAJOR, ROBUROC4_VERSION_MINOR,
                   ROBUROC4_VERSION_PATCH);
            return EXIT_DROVE;
        }
        if (strcmp(argv[i], "--csv") == 0 && i + 1 < argc) {
            csv = argv[++i];
        } else if (argv[i][0] != '-' && hosts++ == 0) {
            host = argv[i];
        } else {
            fprintf(stderr, "drive_square: cannot use '%s'; see drive_square --help\n", argv[i]);
            return EXIT_USAGE;
        }
    }

    roburoc4_address address;
    roburoc4_udp udp;
    drive_report report;
    roburoc4_result result = roburoc4_udp_resolve(host, 0, &address);
    if (result == 0) {
        result = roburoc4_udp_open(&udp, sizeof udp, &address);
    }
    if (result < 0) {
        fprintf(stderr,
                "drive_square: '%s': %s; give the robot's name or address, and :PORT (1 to 65535) "
                "if it is not %d\n",
                host, roburoc4_result_text(result), ROBUROC4_DEFAULT_PORT);
        return result == ROBUROC4_ERR_ARGUMENT ? EXIT_USAGE : EXIT_ABSENT;
    }
    if (!drive_report_begin(&report, csv)) {
        return EXIT_USAGE;
    }
    signal(SIGINT, on_signal);
    signal(SIGTERM, on_signal);
#ifndef _WIN32
    signal(SIGHUP, on_signal); /* the terminal was closed, the connection dropped */
    signal(SIGQUIT, on_signal);
    signal(SIGPIPE, SIG_IGN); /* nobody reads any more: the zeros are sent all the same */
#endif
    int code = run(&udp, host, &report);
    roburoc4_udp_close(&udp);
    return code;
}
