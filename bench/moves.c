/* SPDX-License-Identifier: MIT
 *
 * moves: how well moves end, on the simulated robot in virtual time. Prints a line for each figure:
 * its name, what it was measured on, its unit and its value, with tabs between.
 * bench/measure_moves.py keeps them.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "roburoc4_move.h"
#include "roburoc4_sim.h"

#define PI 3.14159265358979323846
#define DEGREES (180 / PI)
#define RESPONSE_S 0.64 /* how much later than its target the robot has a speed */
#define SEEDS 20

/* Several drives of the same kind: the worst of each. */
typedef struct figures {
    double error, overshoot, late, speed;
} figures;

typedef struct drive {
    roburoc4_world *world;
    roburoc4_client client;
    roburoc4_sim_state begin, end;
    double furthest, took_s, fastest;
} drive;

static uint64_t now(const drive *d) {
    return roburoc4_world_now_us(d->world);
}

static void pass(drive *d, uint64_t span_us) {
    const uint64_t until_us = now(d) + span_us;
    while (roburoc4_world_step(d->world, until_us, NULL, NULL) != 0) {
    }
}

static void look(drive *d, roburoc4_sim_state *out) {
    out->size = sizeof *out;
    (void)roburoc4_sim_get_state(roburoc4_world_robot(d->world), out);
}

static void open_world(drive *d, float slip, double loss, uint64_t seed) {
    roburoc4_sim_config robot;
    roburoc4_config config;
    roburoc4_sim_faults faults = {.size = sizeof faults};
    roburoc4_sim_config_init(&robot, sizeof robot);
    robot.slip = slip;
    robot.seed = seed;
    roburoc4_config_init(&config, sizeof config);
    config.fresh_ms = 1000;
    faults.loss = loss;
    d->world = roburoc4_world_create(&robot);
    roburoc4_sim_clear_obstacles(roburoc4_world_robot(d->world));
    roburoc4_client_init(&d->client, sizeof d->client, &config);
    roburoc4_world_join(d->world, &d->client);
    while (roburoc4_client_arm(&d->client, now(d)) < 0) {
        pass(d, 10000);
    }
    pass(d, 1000000);
    roburoc4_world_set_faults(d->world, &faults);
}

static double wrapped(double angle_rad) {
    return remainder(angle_rad, 2 * PI);
}

static void go(drive *d, roburoc4_move *move) {
    const uint64_t begun_us = now(d);
    look(d, &d->begin);
    d->furthest = d->fastest = 0;
    while (roburoc4_move_step(move, &d->client, now(d)) == ROBUROC4_MOVE_RUNNING) {
        const roburoc4_result driven =
            roburoc4_client_drive(&d->client, move->linear_m_s, move->angular_rad_s, 0, now(d));
        (void)driven; /* where it is refused, the next step ends the move */
        pass(d, 10000);
        look(d, &d->end);
        const double x = d->end.odometry_x_m - d->begin.odometry_x_m,
                     y = d->end.odometry_y_m - d->begin.odometry_y_m;
        d->furthest =
            fmax(d->furthest, fmax(hypot(x, y), fabs(wrapped(d->end.odometry_theta_rad -
                                                             d->begin.odometry_theta_rad))));
        d->fastest =
            fmax(d->fastest, fmax(fabs(d->end.wheel_linear_m_s), fabs(d->end.wheel_angular_rad_s)));
    }
    d->took_s = (double)(now(d) - begun_us) * 1e-6;
    pass(d, 1000000);
    look(d, &d->end);
    if (move->result != ROBUROC4_MOVE_REACHED) {
        fprintf(stderr, "moves: %s\n", roburoc4_move_result_text(move->result));
        exit(1);
    }
}

static double ideal_s(double way, double speed, double slope) {
    return speed * speed / slope <= way ? way / speed + speed / slope : 2 * sqrt(way / slope);
}

static void print(const char *name, const char *on, const char *unit, double value) {
    printf("%s\t%s\t%s\t%.3f\n", name, on, unit, value);
}

/* Straight metres, or quarter turns, of many seeds. */
static void measure(int turn, float speed, double loss) {
    const double way = turn ? PI / 2 : 1, slope = turn ? 1.0 : 0.5;
    const double bare_s = ideal_s(way, (double)speed, slope);
    figures worst = {0, 0, 0, 0};
    double took_s = 0;
    char name[80];
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        drive d;
        roburoc4_move move;
        roburoc4_move_options options;
        roburoc4_move_options_init(&options, sizeof options);
        options.linear_m_s = options.angular_rad_s = speed;
        open_world(&d, 0, loss, seed);
        if (turn) {
            roburoc4_move_by(&move, 0, (float)way, &options);
        } else {
            roburoc4_move_by(&move, (float)way, 0, &options);
        }
        go(&d, &move);
        const double come = turn ? wrapped(d.end.odometry_theta_rad - d.begin.odometry_theta_rad)
                                 : hypot(d.end.odometry_x_m - d.begin.odometry_x_m,
                                         d.end.odometry_y_m - d.begin.odometry_y_m);
        worst.error = fmax(worst.error, fabs(come - way));
        worst.overshoot = fmax(worst.overshoot, d.furthest - way);
        worst.speed = fmax(worst.speed, d.fastest / (double)speed);
        took_s = fmax(took_s, d.took_s);
        roburoc4_world_destroy(d.world);
    }
    snprintf(name, sizeof name, "%s at %.1f %s%s", turn ? "quarter turn" : "straight metre",
             (double)speed, turn ? "rad/s" : "m/s", loss > 0 ? ", 20 % lost" : "");
    print(name, "error", turn ? "degrees" : "mm", worst.error * (turn ? DEGREES : 1000));
    print(name, "overshoot", "%", 100 * worst.overshoot / way);
    print(name, "time", "s", took_s);
    print(name, "time by that of the profile and the robot's response", "×",
          took_s / (bare_s + RESPONSE_S));
    print(name, "time by that of the profile alone", "×", took_s / bare_s);
    print(name, "speed by that asked for", "×", worst.speed);
}

/* Squares of 2 m, without slip and with the one that was measured. */
static void measure_square(float slip) {
    double closes = 0, truly = 0, heading = 0, turns = 0, ways = 0;
    const char *on = slip > 0 ? "with slip" : "without slip";
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        drive d;
        roburoc4_sim_state first;
        open_world(&d, slip, 0, seed);
        look(&d, &first);
        for (int side = 0; side < 4; side++) {
            roburoc4_move move;
            roburoc4_move_by(&move, 2, 0, NULL);
            go(&d, &move);
            ways = fmax(ways, fabs(2 - hypot(d.end.true_x_m - d.begin.true_x_m,
                                             d.end.true_y_m - d.begin.true_y_m)));
            roburoc4_move_by(&move, 0, (float)(PI / 2), NULL);
            go(&d, &move);
            turns =
                fmax(turns, fabs(PI / 2 - wrapped(d.end.true_theta_rad - d.begin.true_theta_rad)));
        }
        closes = fmax(closes, hypot(d.end.odometry_x_m - first.odometry_x_m,
                                    d.end.odometry_y_m - first.odometry_y_m));
        truly =
            fmax(truly, hypot(d.end.true_x_m - first.true_x_m, d.end.true_y_m - first.true_y_m));
        heading = fmax(heading, fabs(wrapped(d.end.true_theta_rad - first.true_theta_rad)));
        roburoc4_world_destroy(d.world);
    }
    print("square of 2 m, closes by odometry within", on, "mm", closes * 1000);
    print("square of 2 m, really closes within", on, "mm", truly * 1000);
    print("square of 2 m, heading really off at its end", on, "degrees", heading * DEGREES);
    print("quarter turn, really off", on, "degrees", turns * DEGREES);
    print("straight 2 m, really off", on, "mm", ways * 1000);
}

int main(void) {
    const double losses[] = {0, 0.2};
    const float speeds[] = {0.3F, 1.0F};
    for (int i = 0; i < 8; i++) {
        measure(i / 2 % 2, speeds[i % 2], losses[i / 4]);
    }
    measure_square(0);
    measure_square(0.12F);
    return 0;
}
