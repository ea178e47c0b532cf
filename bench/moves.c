/* SPDX-License-Identifier: MIT
 *
 * moves: how well moves end, in virtual time.
 *
 *     moves               figures of the family, of the nominal robot, and of squares with slip
 *     moves --faults      the members of the family whose move is not fine, one a line
 *
 * Prints a line for each figure: its name, what it was measured on, its unit and its value, with
 * tabs between. bench/measure_moves.py keeps them.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "family.h"
#include "roburoc4_sim.h"

#define PI 3.14159265358979323846
#define DEGREES (180 / PI)
#define SEEDS 20

typedef struct drive {
    roburoc4_world *world;
    roburoc4_client client;
    roburoc4_sim_state begin, end;
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

/* What calibration says of turns. */
static float scale = 1;

static void open_world(drive *d, float slip, uint64_t seed) {
    roburoc4_sim_config robot;
    roburoc4_config config;
    roburoc4_sim_config_init(&robot, sizeof robot);
    robot.slip = slip;
    robot.seed = seed;
    roburoc4_config_init(&config, sizeof config);
    config.fresh_ms = 1000;
    config.scale_angular = scale;
    d->world = roburoc4_world_create(&robot);
    roburoc4_sim_clear_obstacles(roburoc4_world_robot(d->world));
    roburoc4_client_init(&d->client, sizeof d->client, &config);
    roburoc4_world_join(d->world, &d->client);
    while (roburoc4_client_arm(&d->client, now(d)) < 0) {
        pass(d, 10000);
    }
    pass(d, 1000000);
}

static double wrapped(double angle_rad) {
    return remainder(angle_rad, 2 * PI);
}

static void go(drive *d, roburoc4_move *move) {
    look(d, &d->begin);
    while (roburoc4_move_step(move, &d->client, now(d)) == ROBUROC4_MOVE_RUNNING) {
        const roburoc4_result driven =
            roburoc4_client_drive(&d->client, move->linear_m_s, move->angular_rad_s, 0, now(d));
        (void)driven; /* where it is refused, the next step ends the move */
        pass(d, 10000);
    }
    pass(d, 1000000);
    look(d, &d->end);
    if (move->outcome != ROBUROC4_MOVE_REACHED) {
        fprintf(stderr, "moves: %s\n", roburoc4_move_outcome_text(move->outcome));
        exit(1);
    }
}

static void print(const char *name, const char *on, const char *unit, double value) {
    printf("%s\t%s\t%s\t%.3f\n", name, on, unit, value);
}

/* Squares of 2 m, without slip and with the one that was measured. */
static void measure_square(float slip, float scale_angular) {
    double closes = 0, truly = 0, heading = 0, turns = 0, ways = 0;
    const char *on = scale_angular > 1 ? "with slip, calibrated"
                     : slip > 0        ? "with slip"
                                       : "without slip";
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        drive d;
        roburoc4_sim_state first;
        scale = scale_angular;
        open_world(&d, slip, seed);
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

/* ------------------------------------------------------------------------------- the family --- */

#define SEED 20260301U
#define DRAWN 2000
static void measure_family(double loss, int only_faults) {
    unsigned fine = 0;
    char name[96];
    for (uint32_t index = 0; index < FAMILY_SIZE; index++) {
        family_member m = family_member_at(index);
        m.loss = loss;
        const family_verdict v = family_judge(&m, SEED + index, 0);
        fine += v.fault == NULL;
        if (only_faults && v.fault != NULL) {
            printf("%u ", index);
            family_print(&m, &v);
        }
    }
    if (!only_faults) {
        snprintf(name, sizeof name, "family of %d%s", FAMILY_SIZE, loss > 0 ? ", 20 % lost" : "");
        print(name, "moves that are fine", "%", 100.0 * fine / FAMILY_SIZE);
    }
}

/** Robots that no constant of the moves was chosen for. */
static void measure_drawn(void) {
    uint64_t seed = SEED;
    unsigned fine = 0;
    for (int i = 0; i < DRAWN; i++) {
        const family_member m = family_member_drawn(&seed);
        fine += family_judge(&m, seed, 0).fault == NULL;
    }
    print("robots drawn between the members of the family", "moves that are fine", "%",
          100.0 * fine / DRAWN);
}

static void measure_nominal(int turn, double speed) {
    const family_member m = {2.46, 0.79, 1, 0, 0, 10, 50, speed, turn, 0};
    family_verdict worst = {0};
    char name[80];
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        const family_verdict v = family_judge(&m, seed, 1);
        worst.error = fmax(worst.error, v.error);
        worst.overshoot = fmax(worst.overshoot, v.overshoot);
        worst.took_s = fmax(worst.took_s, v.took_s);
        worst.ideal_s = v.ideal_s;
    }
    snprintf(name, sizeof name, "%s at %.1f %s", turn ? "quarter turn" : "straight metre", speed,
             turn ? "rad/s" : "m/s");
    print(name, "error", turn ? "degrees" : "mm", worst.error * (turn ? DEGREES : 1000));
    print(name, "overshoot", "%", 100 * worst.overshoot / (turn ? PI / 2 : 1));
    print(name, "time", "s", worst.took_s);
    print(name, "time by that of the profile and the robot's response", "×",
          worst.took_s / worst.ideal_s);
}

int main(int argc, char **argv) {
    const int only_faults = argc == 2 && strcmp(argv[1], "--faults") == 0;
    measure_family(0, only_faults);
    measure_family(0.2, only_faults);
    if (only_faults) {
        return 0;
    }
    measure_drawn();
    for (int i = 0; i < 4; i++) {
        measure_nominal(i / 2, i % 2 ? 1.0 : 0.3);
    }
    measure_square(0, 1);
    measure_square(0.12F, 1);
    measure_square(0.12F, 1 / 0.88F);
    return 0;
}
