/* SPDX-License-Identifier: MIT
 *
 * The floor around the robot: boxes, walls (thin boxes) and the robot's body. The body never enters
 * a box, and bumpers feel what they touch.
 */
#include <math.h>

#include "model.h"

#define BUMPER_REACH_M 0.01
#define SMALLEST_BOX_M 0.01
#define LARGEST_BOX_M 10000.0
#define FARTHEST_M 1e6

static sim_box make_box(double x_m, double y_m, double size_x_m, double size_y_m,
                        double theta_rad) {
    sim_box box;
    box.x_m = x_m;
    box.y_m = y_m;
    box.half_x_m = 0.5 * size_x_m;
    box.half_y_m = 0.5 * size_y_m;
    box.cos_theta = cos(theta_rad);
    box.sin_theta = sin(theta_rad);
    box.radius_m = hypot(box.half_x_m, box.half_y_m);
    return box;
}

static sim_box body_box(const sim_pose *pose) {
    return make_box(pose->x_m, pose->y_m, SIM_BODY_LENGTH_M, SIM_BODY_WIDTH_M, pose->theta_rad);
}

/* The strip just before (side 1) or behind (side -1) the body that a bumper feels. */
static sim_box bumper_box(const sim_pose *pose, double side) {
    double offset = side * 0.5 * (SIM_BODY_LENGTH_M + BUMPER_REACH_M);
    return make_box(pose->x_m + offset * cos(pose->theta_rad),
                    pose->y_m + offset * sin(pose->theta_rad), BUMPER_REACH_M, SIM_BODY_WIDTH_M,
                    pose->theta_rad);
}

/* Whether the axes of `a` separate the boxes. */
static bool separated_along(const sim_box *a, const sim_box *b) {
    double dx = b->x_m - a->x_m;
    double dy = b->y_m - a->y_m;
    double c = fabs(a->cos_theta * b->cos_theta + a->sin_theta * b->sin_theta);
    double s = fabs(a->sin_theta * b->cos_theta - a->cos_theta * b->sin_theta);
    double along_x = fabs(dx * a->cos_theta + dy * a->sin_theta);
    double along_y = fabs(dy * a->cos_theta - dx * a->sin_theta);
    return along_x > a->half_x_m + b->half_x_m * c + b->half_y_m * s ||
           along_y > a->half_y_m + b->half_x_m * s + b->half_y_m * c;
}

static bool overlap(const sim_box *a, const sim_box *b) {
    double reach = a->radius_m + b->radius_m;
    double dx = b->x_m - a->x_m;
    double dy = b->y_m - a->y_m;
    return dx * dx + dy * dy <= reach * reach && !separated_along(a, b) && !separated_along(b, a);
}

static bool touches_any(const roburoc4_sim *sim, const sim_box *what) {
    for (uint32_t index = 0; index < sim->box_count; index++) {
        if (overlap(what, &sim->boxes[index])) {
            return true;
        }
    }
    return false;
}

static bool is_free(const roburoc4_sim *sim, const sim_pose *pose) {
    sim_box body = body_box(pose);
    return !touches_any(sim, &body);
}

static void feel(roburoc4_sim *sim) {
    sim_box front = bumper_box(&sim->truth, 1.0);
    sim_box rear = bumper_box(&sim->truth, -1.0);
    sim->contact[SIM_FRONT] = touches_any(sim, &front);
    sim->contact[SIM_REAR] = touches_any(sim, &rear);
}

/* --------------------------------------------------------------------------------- motion --- */

static sim_pose between(const sim_pose *from, const sim_pose *to, double share) {
    sim_pose pose;
    pose.x_m = from->x_m + share * (to->x_m - from->x_m);
    pose.y_m = from->y_m + share * (to->y_m - from->y_m);
    pose.theta_rad = sim_wrap(from->theta_rad + share * sim_wrap(to->theta_rad - from->theta_rad));
    return pose;
}

/* Go as far towards the goal as is free: one cycle's distance, bisected down to 0.1 mm. */
static void approach(roburoc4_sim *sim, const sim_pose *goal) {
    sim_pose start = sim->truth;
    double reached = 0.0;
    double step = 0.5;
    for (int halving = 0; halving < 9; halving++) {
        sim_pose attempt = between(&start, goal, reached + step);
        if (is_free(sim, &attempt)) {
            reached += step;
            sim->truth = attempt;
        }
        step *= 0.5;
    }
}

void sim_obstacles_move(roburoc4_sim *sim, const sim_pose *goal) {
    if (is_free(sim, goal)) {
        sim->truth = *goal;
    } else {
        approach(sim, goal);
        /* The rest of the turn, or else of the distance, may be free: the body slides along. */
        sim_pose turned = {sim->truth.x_m, sim->truth.y_m, goal->theta_rad};
        sim_pose shifted = {goal->x_m, goal->y_m, sim->truth.theta_rad};
        if (is_free(sim, &turned)) {
            sim->truth = turned;
        } else if (is_free(sim, &shifted)) {
            sim->truth = shifted;
        }
    }
    feel(sim);
}

/* ---------------------------------------------------------------------------------- boxes --- */

static bool is_place(double x_m, double y_m, double theta_rad) {
    return fabs(x_m) <= FARTHEST_M && fabs(y_m) <= FARTHEST_M && sim_is_finite(theta_rad);
}

static bool is_size(double size_m) {
    return size_m >= SMALLEST_BOX_M && size_m <= LARGEST_BOX_M;
}

roburoc4_result roburoc4_sim_add_box(roburoc4_sim *sim, double x_m, double y_m, double size_x_m,
                                     double size_y_m, double theta_rad) {
    if (!is_place(x_m, y_m, theta_rad) || !is_size(size_x_m) || !is_size(size_y_m)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    if (sim->box_count == ROBUROC4_SIM_MAX_BOXES) {
        return ROBUROC4_ERR_BUFFER;
    }
    sim_box box = make_box(x_m, y_m, size_x_m, size_y_m, theta_rad);
    sim_box body = body_box(&sim->truth);
    if (overlap(&box, &body)) {
        return ROBUROC4_ERR_STATE;
    }
    sim->boxes[sim->box_count] = box;
    sim->box_count++;
    feel(sim);
    return (roburoc4_result)sim->box_count - 1;
}

roburoc4_result sim_obstacles_move_box(roburoc4_sim *sim, uint32_t number, double x_m, double y_m,
                                       double theta_rad) {
    if (number >= sim->box_count) {
        return ROBUROC4_ERR_INDEX;
    }
    if (!is_place(x_m, y_m, theta_rad)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    sim_box *box = &sim->boxes[number];
    sim_box moved = make_box(x_m, y_m, 2.0 * box->half_x_m, 2.0 * box->half_y_m, theta_rad);
    sim_box body = body_box(&sim->truth);
    if (overlap(&moved, &body)) {
        return ROBUROC4_ERR_STATE;
    }
    *box = moved;
    feel(sim);
    return ROBUROC4_OK;
}

void roburoc4_sim_clear_obstacles(roburoc4_sim *sim) {
    sim->box_count = 0;
    feel(sim);
}

roburoc4_result roburoc4_sim_place(roburoc4_sim *sim, double x_m, double y_m, double theta_rad) {
    if (!is_place(x_m, y_m, theta_rad)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    sim_pose pose = {x_m, y_m, sim_wrap(theta_rad)};
    if (!is_free(sim, &pose)) {
        return ROBUROC4_ERR_STATE;
    }
    sim->truth = pose;
    sim->body.linear_m_s = sim->body.angular_rad_s = 0.0;
    sim->linear.speed = sim->linear.slope = 0.0;
    sim->angular.speed = sim->angular.slope = 0.0;
    feel(sim);
    return ROBUROC4_OK;
}

/* ----------------------------------------------------------------------------- default room --- */

typedef struct furniture {
    double x_m, y_m, size_x_m, size_y_m, theta_rad;
} furniture;

void sim_obstacles_init(roburoc4_sim *sim) {
    /* Relative to the start pose. The telemeters see the first box and the wall behind it; nothing
     * is nearer to the body than 5 m. */
    static const furniture room[] = {
        {2.0, 6.5, 16.1, SIM_WALL_THICKNESS_M, 0.0},
        {2.0, -6.5, 16.1, SIM_WALL_THICKNESS_M, 0.0},
        {-6.0, 0.0, SIM_WALL_THICKNESS_M, 13.0, 0.0},
        {10.0, 0.0, SIM_WALL_THICKNESS_M, 13.0, 0.0},
        {6.3, 0.4, 0.6, 0.8, 0.0},
        {3.0, 6.1, 0.8, 0.6, 0.0},
        {-4.0, -6.1, 0.6, 0.6, 0.5},
        {8.0, -4.0, 1.2, 0.5, 0.8},
    };
    double c = cos(sim->config.start_theta_rad);
    double s = sin(sim->config.start_theta_rad);
    for (uint32_t index = 0; index < sizeof room / sizeof room[0]; index++) {
        const furniture *piece = &room[index];
        sim->boxes[index] =
            make_box(sim->config.start_x_m + c * piece->x_m - s * piece->y_m,
                     sim->config.start_y_m + s * piece->x_m + c * piece->y_m, piece->size_x_m,
                     piece->size_y_m, sim->config.start_theta_rad + piece->theta_rad);
    }
    sim->box_count = (uint32_t)(sizeof room / sizeof room[0]);
}
