/* SPDX-License-Identifier: MIT
 *
 * The ultrasonic telemeters: the nearest obstacle within each one's cone.
 */
#include <math.h>

#include "model.h"

#define FIELD_OF_VIEW_RAD 0.5236
#define MIN_DISTANCE_M 0.25
#define MAX_DISTANCE_M 6.0
#define RAYS 11
#define FULL_SCALE_V 5.0

/* The distance at which a ray enters a box, at most `limit`. */
static double ray_to_box(const sim_box *box, double x, double y, double ux, double uy,
                         double limit) {
    double px = (x - box->x_m) * box->cos_theta + (y - box->y_m) * box->sin_theta;
    double py = (y - box->y_m) * box->cos_theta - (x - box->x_m) * box->sin_theta;
    double vx = ux * box->cos_theta + uy * box->sin_theta;
    double vy = uy * box->cos_theta - ux * box->sin_theta;
    const double from[2] = {px, py};
    const double along[2] = {vx, vy};
    const double half[2] = {box->half_x_m, box->half_y_m};
    double enter = 0.0;
    double leave = limit;
    for (int axis = 0; axis < 2; axis++) {
        if (fabs(along[axis]) < 1e-12) {
            if (fabs(from[axis]) > half[axis]) {
                return limit;
            }
            continue;
        }
        double one = (-half[axis] - from[axis]) / along[axis];
        double two = (half[axis] - from[axis]) / along[axis];
        enter = fmax(enter, fmin(one, two));
        leave = fmin(leave, fmax(one, two));
    }
    return enter <= leave ? enter : limit;
}

static double look(const roburoc4_sim *sim, double x, double y, double direction) {
    double nearest = MAX_DISTANCE_M;
    for (uint32_t index = 0; index < sim->box_count; index++) {
        const sim_box *box = &sim->boxes[index];
        if (hypot(box->x_m - x, box->y_m - y) - box->radius_m >= nearest) {
            continue;
        }
        for (int ray = 0; ray < RAYS; ray++) {
            double angle = direction + FIELD_OF_VIEW_RAD * ((double)ray / (double)(RAYS - 1) - 0.5);
            nearest = ray_to_box(box, x, y, cos(angle), sin(angle), nearest);
        }
    }
    return nearest;
}

/* Where it is, and where it points, in the robot's frame: around the body at equal angles, front
 * first; its position in whole millimetres. */
static sim_pose mounting(const roburoc4_sim *sim, uint32_t which) {
    double place = 2.0 * SIM_PI * which / sim->config.telemeters;
    sim_pose pose;
    pose.x_m = round(500.0 * SIM_BODY_LENGTH_M * cos(place)) / 1000.0;
    pose.y_m = round(500.0 * SIM_BODY_WIDTH_M * sin(place)) / 1000.0;
    pose.theta_rad = sim_wrap(place + (which + 1) * (double)sim->config.telemeter_turn_rad);
    return pose;
}

float sim_telemeter_distance(const roburoc4_sim *sim, uint32_t which) {
    if (which >= sim->config.telemeters) {
        return NAN;
    }
    sim_pose at = mounting(sim, which);
    double c = cos(sim->truth.theta_rad);
    double s = sin(sim->truth.theta_rad);
    double seen =
        look(sim, sim->truth.x_m + at.x_m * c - at.y_m * s,
             sim->truth.y_m + at.x_m * s + at.y_m * c, sim->truth.theta_rad + at.theta_rad);
    return (float)fmax(seen, MIN_DISTANCE_M);
}

float sim_telemeter_voltage(const roburoc4_sim *sim, uint32_t which) {
    return which >= sim->config.telemeters
               ? 0.0f
               : sim_telemeter_distance(sim, which) * (float)(FULL_SCALE_V / MAX_DISTANCE_M);
}

void sim_telemeter_describe(const roburoc4_sim *sim, uint32_t which, roburoc4_telemeter *out) {
    sim_pose at = mounting(sim, which);
    out->x_m = (float)at.x_m;
    out->y_m = (float)at.y_m;
    out->theta_rad = (float)at.theta_rad;
    out->field_of_view_rad = (float)FIELD_OF_VIEW_RAD;
    out->min_distance_m = (float)MIN_DISTANCE_M;
    out->max_distance_m = (float)MAX_DISTANCE_M;
    out->distance_m = sim_telemeter_distance(sim, which);
}
