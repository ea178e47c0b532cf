/* SPDX-License-Identifier: MIT
 *
 * How the robot moves: from the target to wheel speeds (a second-order response with limits), from
 * wheel speeds to odometry, and from wheel speeds with slip to the true motion of the body.
 */
#include <math.h>

#include "model.h"

/* A response with a natural frequency from here on is immediate. */
#define IMMEDIATE_RAD_S 1000.0f

/* Deceleration without motor power: with brakes applied, or released and coasting. */
#define BRAKE_M_S2 5.0
#define BRAKE_RAD_S2 16.0
#define ROLL_M_S2 0.8
#define ROLL_RAD_S2 4.0

static const sim_speed no_speed = {0.0, 0.0};

/* An axis with target 0 counts as at rest below these speeds. */
#define REST_SPEED 1e-4
#define REST_SLOPE 1e-3

/* The solution of e'' + 2 zeta omega e' + omega^2 e = 0 after one cycle. */
static sim_response sample_response(double omega, double zeta) {
    double sigma = zeta * omega;
    double damped = omega * sqrt(fabs(1.0 - zeta * zeta));
    double decay = exp(-sigma * CYCLE_S);
    double c = decay; /* critical, if nothing else */
    double s = decay * CYCLE_S;
    if (damped > 1e-6 * omega) {
        c *= zeta < 1.0 ? cos(damped * CYCLE_S) : cosh(damped * CYCLE_S);
        s = decay * (zeta < 1.0 ? sin(damped * CYCLE_S) : sinh(damped * CYCLE_S)) / damped;
    }
    sim_response response;
    response.ee = c + s * sigma;
    response.es = s;
    response.se = -s * omega * omega;
    response.ss = c - s * sigma;
    return response;
}

/* A pair of limits, or its default where it is invalid. */
static void take_limits(float max, float min, double fallback, double *out_max, double *out_min) {
    bool usable =
        sim_is_finite((double)max) && sim_is_finite((double)min) && min <= 0.0f && max >= 0.0f;
    *out_max = usable ? (double)max : fallback;
    *out_min = usable ? (double)min : -fallback;
}

void sim_motion_init(roburoc4_sim *sim) {
    const roburoc4_sim_config *config = &sim->config;
    sim_axis *linear = &sim->linear;
    sim_axis *angular = &sim->angular;
    take_limits(config->max_linear_m_s, config->min_linear_m_s, 2.6, &linear->max_speed,
                &linear->min_speed);
    take_limits(config->max_linear_m_s2, config->min_linear_m_s2, 3.0, &linear->max_slope,
                &linear->min_slope);
    take_limits(config->max_angular_rad_s, config->min_angular_rad_s, 6.5, &angular->max_speed,
                &angular->min_speed);
    take_limits(config->max_angular_rad_s2, config->min_angular_rad_s2, 8.0, &angular->max_slope,
                &angular->min_slope);
    linear->response =
        sample_response((double)config->linear_omega_rad_s, (double)config->linear_damping);
    angular->response =
        sample_response((double)config->angular_omega_rad_s, (double)config->angular_damping);
    linear->immediate = config->linear_omega_rad_s >= IMMEDIATE_RAD_S;
    angular->immediate = config->angular_omega_rad_s >= IMMEDIATE_RAD_S;
}

static double clamp(double value, double min, double max) {
    return value < min ? min : value > max ? max : value;
}

bool sim_pad_drives(const roburoc4_sim *sim) {
    return sim->powered && sim->buttons[0];
}

void sim_motion_command(roburoc4_sim *sim, double linear_m_s, double angular_rad_s) {
    sim_speed *target = sim_pad_drives(sim) ? &sim->kept : &sim->target;
    target->linear_m_s = clamp(linear_m_s, sim->linear.min_speed, sim->linear.max_speed);
    target->angular_rad_s = clamp(angular_rad_s, sim->angular.min_speed, sim->angular.max_speed);
    sim->tripped = no_speed;
    sim_motion_feed(sim);
}

bool sim_motion_is_beyond(const roburoc4_sim *sim, double linear_m_s, double angular_rad_s) {
    return linear_m_s > sim->linear.max_speed || linear_m_s < sim->linear.min_speed ||
           angular_rad_s > sim->angular.max_speed || angular_rad_s < sim->angular.min_speed;
}

void sim_motion_feed(roburoc4_sim *sim) {
    sim->cycles_since_command = 0;
    sim->fed = true;
}

void sim_motion_forget(roburoc4_sim *sim) {
    sim->target = sim->kept = sim->tripped = no_speed;
    sim->fed = false;
}

static void watch(roburoc4_sim *sim) {
    if (!sim->fed || ++sim->cycles_since_command < sim->config.watchdog_cycles) {
        return;
    }
    const sim_speed target = sim->target;
    sim_motion_forget(sim);
    if (sim_pad_drives(sim)) {
        sim->target = target;
    } else if (sim->config.tripped_target_shown != 0) {
        sim->tripped = target;
    }
}

/* The target that the motors follow, after the dead time. */
static sim_speed late_target(const roburoc4_sim *sim) {
    return sim->accepted[(sim->accepted_at + SIM_DEAD_TIME_CYCLES - sim->config.dead_time_cycles) %
                         SIM_DEAD_TIME_CYCLES];
}

sim_speed sim_motion_shown_target(const roburoc4_sim *sim) {
    if (sim_pad_drives(sim) && sim->config.pad_target_hidden != 0) {
        return sim->kept;
    }
    if (sim->config.late_targets != 0) {
        return late_target(sim);
    }
    return sim->fed || sim_pad_drives(sim) ? sim->target : sim->tripped;
}

static void follow(sim_axis *axis, double target) {
    if (axis->immediate) {
        axis->speed = target;
        axis->slope = 0.0;
        return;
    }
    double error = axis->speed - target;
    double slope = axis->response.se * error + axis->response.ss * axis->slope;
    double limited = clamp(slope, axis->min_slope, axis->max_slope);
    if (limited < slope || limited > slope) {
        axis->speed += 0.5 * (axis->slope + limited) * CYCLE_S;
    } else {
        axis->speed = target + axis->response.ee * error + axis->response.es * axis->slope;
    }
    axis->slope = limited;
    if (fabs(target) <= 0.0 && fabs(axis->speed) < REST_SPEED && fabs(axis->slope) < REST_SLOPE) {
        axis->speed = 0.0;
        axis->slope = 0.0;
    }
}

static void brake(sim_axis *axis, double deceleration) {
    double change = deceleration * CYCLE_S;
    axis->slope = 0.0;
    axis->speed -= clamp(axis->speed, -change, change);
}

static void drive_wheels(roburoc4_sim *sim) {
    if (!sim->motors) {
        brake(&sim->linear, sim->brakes_released ? ROLL_M_S2 : BRAKE_M_S2);
        brake(&sim->angular, sim->brakes_released ? ROLL_RAD_S2 : BRAKE_RAD_S2);
        return;
    }
    bool front = sim_bumper(sim, SIM_FRONT);
    bool rear = sim_bumper(sim, SIM_REAR);
    sim_speed target = late_target(sim);
    target.linear_m_s = clamp(target.linear_m_s, rear ? 0.0 : sim->linear.min_speed,
                              front ? 0.0 : sim->linear.max_speed);
    target.linear_m_s *= sim->blocked_linear != 0 ? 0.0 : (double)sim->config.linear_gain;
    target.angular_rad_s *= sim->blocked_angular != 0 ? 0.0 : (double)sim->config.angular_gain;
    if ((front && sim->linear.speed > 0.0) || (rear && sim->linear.speed < 0.0)) {
        brake(&sim->linear, BRAKE_M_S2);
    } else {
        follow(&sim->linear, target.linear_m_s + sim->creep.linear_m_s);
    }
    follow(&sim->angular, target.angular_rad_s + sim->creep.angular_rad_s);
}

/* Where a pose ends on an arc: exact for constant speeds. */
static sim_pose along_arc(const sim_pose *from, double distance_m, double turn_rad) {
    double half = 0.5 * turn_rad;
    double chord = fabs(half) < 1e-6 ? distance_m : distance_m * sin(half) / half;
    sim_pose to;
    to.x_m = from->x_m + chord * cos(from->theta_rad + half);
    to.y_m = from->y_m + chord * sin(from->theta_rad + half);
    to.theta_rad = sim_wrap(from->theta_rad + turn_rad);
    return to;
}

/* A skid-steered robot drags its wheels sideways: it turns less than they report, and unevenly. */
static sim_speed slip(roburoc4_sim *sim, sim_speed wheels) {
    double share = (double)sim->config.slip;
    sim->slip_noise = 0.98 * sim->slip_noise + 0.1 * sim_random_signed(&sim->random);
    sim->drift_noise = 0.995 * sim->drift_noise + 0.05 * sim_random_signed(&sim->random);
    sim_speed body;
    body.linear_m_s = wheels.linear_m_s * (1.0 - SIM_SLIP_AHEAD * share);
    body.angular_rad_s = wheels.angular_rad_s * (1.0 - share * (1.0 + 0.3 * sim->slip_noise)) +
                         0.05 * share * sim->drift_noise * wheels.linear_m_s;
    return body;
}

static void move_body(roburoc4_sim *sim, sim_speed wheels) {
    sim_pose before = sim->truth;
    sim_speed wanted = slip(sim, wheels);
    sim_pose goal = along_arc(&before, wanted.linear_m_s * CYCLE_S, wanted.angular_rad_s * CYCLE_S);
    sim_obstacles_move(sim, &goal);

    double turned = sim_wrap(sim->truth.theta_rad - before.theta_rad);
    double heading = before.theta_rad + 0.5 * turned;
    double ahead =
        (sim->truth.x_m - before.x_m) * cos(heading) + (sim->truth.y_m - before.y_m) * sin(heading);
    sim->body.linear_m_s = ahead / CYCLE_S;
    sim->body.angular_rad_s = turned / CYCLE_S;

    if ((sim->contact[SIM_FRONT] && sim->linear.speed > 0.0) ||
        (sim->contact[SIM_REAR] && sim->linear.speed < 0.0)) {
        sim->linear.speed = 0.0;
        sim->linear.slope = 0.0;
    }
}

static double noise(roburoc4_sim *sim) {
    double share = (double)sim->config.speed_noise;
    return share > 0.0 ? share * sim_random_signed(&sim->random) : 0.0;
}

static void measure(roburoc4_sim *sim) {
    if (sim->cycles % sim->config.odometry_period_cycles == 0) {
        sim->measured_pose = sim->odometry;
        sim->measured_speed.linear_m_s = sim->linear.speed + noise(sim);
        sim->measured_speed.angular_rad_s = sim->angular.speed + noise(sim);
        sim->measured_cycles = sim->cycles;
    }
}

static void move(roburoc4_sim *sim) {
    sim_speed mean = {0.5 * sim->linear.speed, 0.5 * sim->angular.speed};
    drive_wheels(sim);
    mean.linear_m_s += 0.5 * sim->linear.speed;
    mean.angular_rad_s += 0.5 * sim->angular.speed;
    if (fabs(mean.linear_m_s) <= 0.0 && fabs(mean.angular_rad_s) <= 0.0) {
        sim->body = mean;
        return;
    }
    if (sim->powered) {
        double scaled_s = (double)sim->config.odometry_scale * CYCLE_S;
        double turned_s = sim->config.odometry_mirrored != 0 ? -scaled_s : scaled_s;
        sim->odometry =
            along_arc(&sim->odometry, mean.linear_m_s * scaled_s, mean.angular_rad_s * turned_s);
    }
    move_body(sim, mean);
}

void sim_motion_cycle(roburoc4_sim *sim) {
    watch(sim);
    sim->accepted_at = (sim->accepted_at + 1) % SIM_DEAD_TIME_CYCLES;
    sim->accepted[sim->accepted_at] = sim->target;
    move(sim);
    measure(sim);
}
