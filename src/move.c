/* SPDX-License-Identifier: MIT
 *
 * Moves: which speeds to command so that the robot comes to rest at its goal.
 *
 * The robot follows a speed command like a linear second-order system with unit gain. So the
 * distance it has covered at rest is the integral of the commanded speed, and `to_command`, the
 * distance still to be commanded, shrinks with each command at once: a loop closed on it has
 * neither lag nor overshoot. From measurements, it is the remaining distance minus RESPONSE_S times
 * the speed minus BEND_S2 times the acceleration.
 */
#include "roburoc4_move.h"

#include "bytes.h"

/* The measured response (natural frequency 2.46 and 2.42 rad/s, damping 0.79 and 0.77): twice the
 * damping by the frequency, and one by the frequency squared. */
#define RESPONSE_S 0.64F
#define BEND_S2 0.168F
/* Weight of a status in the correction of `to_command`; below 1 to smooth noise. */
#define TRUST 0.5F
/* Speed per distance still to be commanded, at the end of a move. */
#define APPROACH_PER_S 4.0F
/* Turn rate per heading error, and heading per distance from the line. */
#define STEER_PER_S 1.5F
#define RETURN_PER_M 1.0F
#define RETURN_MAX_RAD 0.3F

#define SILENCE_US 1000000U
#define STEP_MAX_US 250000U
#define STILL_STATUSES 2
#define FAR_M 10000.0F
#define PI_F 3.14159265F

/* Callers declare moves: their size is part of the ABI. */
typedef char assert_move_never_grows[sizeof(roburoc4_move) == 264 ? 1 : -1];

enum { LENGTH, ANGLE, BOTH };
enum { BY, TO_POINT, TO_POSE, REST };
enum { AHEAD = 1, ASTERN = 2 };

/* Accepted error; the lowest speed that moves a robot; a robot slower than this is at rest. */
static const float near_enough[BOTH] = {0.004F, 0.004F};
static const float least_speed[BOTH] = {0.03F, 0.06F};
static const float rest_speed[BOTH] = {0.015F, 0.03F};
/* How far a pose may differ from the measured speeds, at once and per second, before it counts as a
 * jump. */
static const float jump[BOTH] = {0.02F, 0.02F};
static const float jump_per_s[BOTH] = {0.5F, 1.0F};

/* ------------------------------------------------------------------------ arithmetic, no libm */

static bool move_finite(float value) {
    return finite_f32_bits(bits_from_f32(value));
}

static float size_of(float value) {
    return f32_from_bits(bits_from_f32(value) & 0x7FFFFFFFU);
}

static float lesser(float a, float b) {
    return order_of(a) < order_of(b) ? a : b;
}

static float within(float value, float bound) {
    return order_of(size_of(value)) <= order_of(bound) ? value
           : order_of(value) < 0                       ? -bound
                                                       : bound;
}

static float with_sign(float size, float sign) {
    return order_of(sign) < 0 ? -size : size;
}

static float root(float square) {
    float y = f32_from_bits((bits_from_f32(square) >> 1) + 0x1FBD1DF5U);
    for (uint32_t i = 0; i < 3; i++) {
        y = 0.5F * (y + square / y);
    }
    return y;
}

/** Wrap an angle to -pi..pi; 0 for one that is far too large. */
static float half_turn(float angle_rad) {
    if (order_of(size_of(angle_rad)) > order_of(FAR_M)) {
        return 0;
    }
    const float turns = angle_rad / (2 * PI_F);
    return angle_rad - 2 * PI_F * (float)(int32_t)(turns + with_sign(0.5F, turns));
}

/** Within 1e-5 rad. */
static float angle_of(float x, float y) {
    const float ax = size_of(x), ay = size_of(y);
    const bool steep = order_of(ay) > order_of(ax);
    const float large = steep ? ay : ax;
    const float t = bits_from_f32(large) == 0 ? 0 : (steep ? ax : ay) / large;
    const float tt = t * t;
    static const float terms[] = {0.0208351F, -0.0851330F, 0.1801410F, -0.3302995F, 0.9998660F};
    float angle = 0;
    for (uint32_t i = 0; i < sizeof terms / sizeof *terms; i++) {
        angle = angle * tt + terms[i];
    }
    angle *= t;
    angle = steep ? PI_F / 2 - angle : angle;
    angle = order_of(x) < 0 ? PI_F - angle : angle;
    return with_sign(angle, y);
}

/* ---------------------------------------------------------------------------------- beginning */

static const roburoc4_move_options move_defaults = {
    sizeof(roburoc4_move_options), 0, 0.3F, 0.5F, 0.5F, 1.0F, 0.5F};

/* Nothing shorter has ever been a view. */
#define VIEW_SIZE_1_0 (offsetof(roburoc4_move_view, reserved) + 6)

roburoc4_result roburoc4_move_options_init(roburoc4_move_options *options, size_t size) {
    if (!size_known(size, sizeof move_defaults)) {
        return ROBUROC4_ERR_SIZE;
    }
    memcpy(options, &move_defaults, size);
    options->size = (uint32_t)size;
    return ROBUROC4_OK;
}

static roburoc4_result bad_options(const roburoc4_move_options *o) {
    const float positive[] = {o->linear_m_s, o->angular_rad_s, o->linear_m_s2, o->angular_rad_s2};
    for (uint32_t i = 0; i < sizeof positive / sizeof *positive; i++) {
        if (!move_finite(positive[i]) || order_of(positive[i]) <= 0) {
            return ROBUROC4_ERR_ARGUMENT;
        }
    }
    return !move_finite(o->clearance_m) || order_of(o->clearance_m) < 0 ? ROBUROC4_ERR_ARGUMENT
                                                                        : ROBUROC4_OK;
}

/** Set up a move; if that fails, it has ended. */
static roburoc4_result begin(roburoc4_move *m, uint8_t kind, const roburoc4_move_options *options) {
    memset(m, 0, sizeof *m);
    m->result = ROBUROC4_MOVE_CANCELLED;
    m->private_kind = kind;
    m->private_options = move_defaults;
    if (options != NULL) {
        if (!size_known(options->size, sizeof move_defaults)) {
            return ROBUROC4_ERR_SIZE;
        }
        memcpy(&m->private_options, options, options->size);
    }
    const roburoc4_result result = bad_options(&m->private_options);
    m->result = result < 0 ? ROBUROC4_MOVE_CANCELLED : ROBUROC4_MOVE_RUNNING;
    return result;
}

static roburoc4_result refuse(roburoc4_move *m, roburoc4_result result) {
    m->result = ROBUROC4_MOVE_CANCELLED;
    return result;
}

roburoc4_result roburoc4_move_by(roburoc4_move *m, float distance_m, float angle_rad,
                                 const roburoc4_move_options *options) {
    const roburoc4_result result = begin(m, BY, options);
    if (!move_finite(distance_m) || !move_finite(angle_rad)) {
        return refuse(m, ROBUROC4_ERR_NOT_FINITE);
    }
    if (order_of(size_of(distance_m)) > order_of(FAR_M) ||
        order_of(size_of(angle_rad)) > order_of(FAR_M)) {
        return refuse(m, ROBUROC4_ERR_ARGUMENT);
    }
    m->private_goal[LENGTH] = distance_m;
    m->private_goal[ANGLE] = angle_rad;
    return result;
}

static roburoc4_result begin_to(roburoc4_move *m, uint8_t kind, double x_m, double y_m,
                                double theta_rad, const roburoc4_move_options *options) {
    const roburoc4_result result = begin(m, kind, options);
    if (!finite_f64_bits(bits_from_f64(x_m)) || !finite_f64_bits(bits_from_f64(y_m)) ||
        !finite_f64_bits(bits_from_f64(theta_rad))) {
        return refuse(m, ROBUROC4_ERR_NOT_FINITE);
    }
    m->private_x_m = x_m;
    m->private_y_m = y_m;
    m->private_theta_rad = theta_rad;
    return result;
}

roburoc4_result roburoc4_move_to_point(roburoc4_move *move, double x_m, double y_m,
                                       const roburoc4_move_options *options) {
    return begin_to(move, TO_POINT, x_m, y_m, 0, options);
}

roburoc4_result roburoc4_move_to_pose(roburoc4_move *move, double x_m, double y_m, double theta_rad,
                                      const roburoc4_move_options *options) {
    return begin_to(move, TO_POSE, x_m, y_m, theta_rad, options);
}

roburoc4_result roburoc4_move_rest(roburoc4_move *move, const roburoc4_move_options *options) {
    return begin(move, REST, options);
}

/* ----------------------------------------------------------------------------- what a move sees */

static bool usable(const roburoc4_localization_status *pose) {
    return finite_f64_bits(bits_from_f64(pose->x_m)) && finite_f64_bits(bits_from_f64(pose->y_m)) &&
           finite_f64_bits(bits_from_f64(pose->theta_rad)) &&
           (pose->flags & (ROBUROC4_LOCALIZATION_INVALID | ROBUROC4_LOCALIZATION_ERROR)) == 0;
}

/** The smaller of two distances; NaN counts as blocked. */
static float nearer(float a, float b) {
    return move_finite(b) ? lesser(a, b) : 0;
}

static void view_distances(roburoc4_move_view *v, const roburoc4_client *client, uint64_t now_us) {
    roburoc4_distances distances;
    roburoc4_telemeter telemeter;
    uint64_t host_us;
    v->front_m = FAR_M;
    v->rear_m = FAR_M;
    v->blind = roburoc4_client_telemeter(client, 0, &telemeter) == ROBUROC4_OK &&
               (roburoc4_client_distances(client, &distances, &host_us) != ROBUROC4_OK ||
                now_us - host_us > SILENCE_US);
    for (uint32_t i = 0; roburoc4_client_telemeter(client, i, &telemeter) == ROBUROC4_OK; i++) {
        const int32_t aside = order_of(size_of(half_turn(telemeter.theta_rad)));
        if (aside < order_of(PI_F / 3)) {
            v->front_m = nearer(v->front_m, telemeter.distance_m);
        } else if (aside > order_of(2 * PI_F / 3)) {
            v->rear_m = nearer(v->rear_m, telemeter.distance_m);
        }
    }
}

static void view_client(roburoc4_move_view *v, const roburoc4_client *client,
                        const roburoc4_facts *facts, uint64_t now_us) {
    roburoc4_differential_properties limits;
    roburoc4_differential_status speeds;
    roburoc4_localization_status pose;
    roburoc4_link link;
    uint64_t host_us;
    memset(v, 0, sizeof *v);
    v->size = sizeof *v;
    v->armed = facts->armed;
    v->overridden = facts->overridden;
    v->inhibited = facts->inhibited;
    v->front_bumper = facts->front_bumper;
    v->rear_bumper = facts->rear_bumper;
    v->disarm_cause = facts->disarm_cause;
    v->sent_linear_m_s = facts->sent_linear_m_s;
    v->sent_angular_rad_s = facts->sent_angular_rad_s;
    if (roburoc4_client_differential(client, &speeds, &host_us) == ROBUROC4_OK) {
        (void)roburoc4_client_link(client, now_us, ROBUROC4_SIZED(&link));
        v->speed_cycles = speeds.robot_cycles;
        v->linear_m_s = speeds.current_linear_m_s;
        v->angular_rad_s = speeds.current_angular_rad_s;
        v->age_us = (uint32_t)(now_us - host_us) + link.round_trip_us;
    }
    if (roburoc4_client_localization(client, &pose, NULL) == ROBUROC4_OK && usable(&pose)) {
        v->pose_cycles = pose.robot_cycles;
        v->x_m = pose.x_m;
        v->y_m = pose.y_m;
        v->theta_rad = pose.theta_rad;
    }
    if (roburoc4_client_differential_properties(client, &limits) == ROBUROC4_OK) {
        v->max_linear_m_s2 =
            lesser(size_of(limits.max_linear_m_s2), size_of(limits.min_linear_m_s2));
        v->max_angular_rad_s2 =
            lesser(size_of(limits.max_angular_rad_s2), size_of(limits.min_angular_rad_s2));
    }
    view_distances(v, client, now_us);
}

/* ------------------------------------------------------------------------------------ the plan */

static void start_leg(roburoc4_move *m, float distance_m, float angle_rad) {
    m->private_goal[LENGTH] = distance_m;
    m->private_goal[ANGLE] = angle_rad;
    m->private_still = 0;
    m->private_planned = 0; /* to_command is set by the next status */
}

/** Begin the next leg, with what the last one left over; false after the last leg. */
static bool next_leg(roburoc4_move *m) {
    m->private_covered[LENGTH] -= m->private_goal[LENGTH];
    m->private_covered[ANGLE] -= m->private_goal[ANGLE];
    m->private_leg++;
    if (m->private_kind == TO_POINT || m->private_kind == TO_POSE) {
        if (m->private_leg == 1) {
            start_leg(m, m->private_line_m, 0);
            return true;
        }
        if (m->private_leg == 2 && m->private_kind == TO_POSE) {
            start_leg(m, 0, m->private_last_turn_rad);
            return true;
        }
    }
    return false;
}

/** Turn, straight line and turn from this pose; false if it is farther than a move may go. */
static bool plan_to(roburoc4_move *m, const roburoc4_move_view *pose) {
    const float x = (float)(m->private_x_m - pose->x_m), y = (float)(m->private_y_m - pose->y_m);
    if (order_of(size_of(x)) > order_of(FAR_M) || order_of(size_of(y)) > order_of(FAR_M)) {
        return false;
    }
    const float heading = (float)pose->theta_rad;
    float bearing = heading;
    m->private_line_m = root(x * x + y * y);
    if (order_of(m->private_line_m) > order_of(near_enough[LENGTH])) {
        bearing = angle_of(x, y);
    } else {
        m->private_line_m = 0;
    }
    m->private_last_turn_rad = half_turn((float)m->private_theta_rad - bearing);
    start_leg(m, 0, half_turn(bearing - heading));
    return true;
}

/** The curvature of the present leg. */
static float curvature(const roburoc4_move *m) {
    return bits_from_f32(m->private_goal[LENGTH]) == 0
               ? 0
               : m->private_goal[ANGLE] / m->private_goal[LENGTH];
}

/** Speeds and accelerations: the requested ones, limited to the robot's own. */
static void set_profile(roburoc4_move *m, const roburoc4_move_view *v) {
    const roburoc4_move_options *o = &m->private_options;
    const float slopes[BOTH] = {o->linear_m_s2, o->angular_rad_s2};
    const float most[BOTH] = {v->max_linear_m_s2, v->max_angular_rad_s2};
    m->private_limit[LENGTH] = o->linear_m_s;
    m->private_limit[ANGLE] = o->angular_rad_s;
    for (uint32_t axis = 0; axis < BOTH; axis++) {
        const bool known = move_finite(most[axis]) && order_of(most[axis]) > 0;
        m->private_slope[axis] = known ? lesser(slopes[axis], most[axis]) : slopes[axis];
    }
    const float bend = size_of(curvature(m));
    if (order_of(bend) > 0) {
        m->private_limit[LENGTH] = lesser(m->private_limit[LENGTH], m->private_limit[ANGLE] / bend);
        m->private_slope[LENGTH] = lesser(m->private_slope[LENGTH], m->private_slope[ANGLE] / bend);
    }
}

static uint32_t default_timeout_ms(const roburoc4_move *m) {
    if (m->private_options.timeout_ms != 0) {
        return m->private_options.timeout_ms;
    }
    if (m->private_kind == REST) {
        return 5000;
    }
    const float path[BOTH] = {size_of(m->private_goal[LENGTH]) + m->private_line_m,
                              size_of(m->private_goal[ANGLE]) + size_of(m->private_last_turn_rad)};
    float seconds = 0;
    for (uint32_t axis = 0; axis < BOTH; axis++) {
        const float speed = m->private_limit[axis];
        seconds += path[axis] / speed + speed / m->private_slope[axis];
    }
    return order_of(seconds) > order_of(1e6F) ? UINT32_MAX : 10000 + (uint32_t)(4000 * seconds);
}

/* ------------------------------------------------------------------------------------ odometry */

/** Add a distance and an angle that the wheels covered. */
static void add_covered(roburoc4_move *m, float distance_m, float angle_rad) {
    const float astray = m->private_covered[ANGLE] - curvature(m) * m->private_covered[LENGTH];
    m->private_covered[LENGTH] += distance_m;
    m->private_covered[ANGLE] += angle_rad;
    m->private_aside_m += distance_m * (astray + 0.5F * angle_rad);
    m->distance_m += distance_m;
    m->angle_rad += angle_rad;
}

/** Robot time since the last status; 0 for the first, and after a restart. */
static float seconds_from(uint64_t before_cycles, uint64_t cycles) {
    const uint64_t passed = cycles - before_cycles;
    return before_cycles == 0 || passed > 1000 ? 0 : (float)(uint32_t)passed * 0.01F;
}

/** Follow the change of the pose. If the pose jumped, the integrated speeds count instead. */
static void note_pose(roburoc4_move *m, const roburoc4_move_view *pose) {
    const float ahead_s = seconds_from(m->private_pose_cycles, pose->pose_cycles);
    const float since_s = m->private_speed_cycles > pose->pose_cycles
                              ? -seconds_from(pose->pose_cycles, m->private_speed_cycles)
                              : seconds_from(m->private_speed_cycles, pose->pose_cycles);
    const float rest[BOTH] = {m->private_speed[LENGTH] * since_s,
                              m->private_speed[ANGLE] * since_s};
    const float by_speeds[BOTH] = {m->private_since_pose[LENGTH] + rest[LENGTH],
                                   m->private_since_pose[ANGLE] + rest[ANGLE]};
    const float x = (float)(pose->x_m - m->private_x0_m), y = (float)(pose->y_m - m->private_y0_m);
    const float turned = half_turn((float)(pose->theta_rad - m->private_theta0_rad));
    const float chord =
        order_of(size_of(x)) > order_of(1.0F) || order_of(size_of(y)) > order_of(1.0F)
            ? 1.0F
            : root(x * x + y * y);
    const float differs[BOTH] = {with_sign(chord, by_speeds[LENGTH]) - by_speeds[LENGTH],
                                 turned - by_speeds[ANGLE]};
    bool jumped = !m->private_posed;
    for (uint32_t axis = 0; axis < BOTH; axis++) {
        jumped = jumped || order_of(size_of(differs[axis])) >
                               order_of(jump[axis] + jump_per_s[axis] * ahead_s);
    }
    if (!jumped) {
        add_covered(m, differs[LENGTH], differs[ANGLE]);
    }
    m->private_posed = 1;
    m->private_pose_cycles = pose->pose_cycles;
    m->private_x0_m = pose->x_m;
    m->private_y0_m = pose->y_m;
    m->private_theta0_rad = pose->theta_rad;
    m->private_since_pose[LENGTH] = -rest[LENGTH];
    m->private_since_pose[ANGLE] = -rest[ANGLE];
}

/** A differential status: add the distance since the last one. */
static void note_speeds(roburoc4_move *m, const roburoc4_move_view *v, float *slopes) {
    const float speeds[BOTH] = {v->linear_m_s, v->angular_rad_s};
    const float passed_s = seconds_from(m->private_speed_cycles, v->speed_cycles);
    float covered[BOTH];
    bool still = true;
    for (uint32_t axis = 0; axis < BOTH; axis++) {
        const float speed = move_finite(speeds[axis]) ? speeds[axis] : 0;
        covered[axis] = 0.5F * (speed + m->private_speed[axis]) * passed_s;
        slopes[axis] =
            bits_from_f32(passed_s) == 0 ? 0 : (speed - m->private_speed[axis]) / passed_s;
        m->private_since_pose[axis] += covered[axis];
        m->private_speed[axis] = speed;
        still = still && order_of(size_of(speed)) < order_of(rest_speed[axis]);
    }
    m->private_speed_cycles = v->speed_cycles;
    m->private_still = still ? (uint8_t)(m->private_still + (m->private_still < 100)) : 0;
    add_covered(m, covered[LENGTH], covered[ANGLE]);
}

/** Take what is new in the view, and note when it arrived. */
static void note_view(roburoc4_move *m, const roburoc4_move_view *v, uint64_t now_us) {
    float slopes[BOTH] = {0, 0};
    const bool news = v->speed_cycles != m->private_speed_cycles;
    if (news) {
        note_speeds(m, v, slopes);
        m->private_heard_us = now_us;
    }
    if (v->pose_cycles != 0 && v->pose_cycles != m->private_pose_cycles) {
        note_pose(m, v);
    }
    const float age_s = (float)v->age_us * 1e-6F;
    const float sent[BOTH] = {v->sent_linear_m_s, v->sent_angular_rad_s};
    for (uint32_t axis = 0; news && axis < BOTH; axis++) {
        const float measured = m->private_goal[axis] - m->private_covered[axis] -
                               RESPONSE_S * m->private_speed[axis] - BEND_S2 * slopes[axis] -
                               age_s * sent[axis];
        m->private_to_command[axis] +=
            (m->private_planned ? TRUST : 1) * (measured - m->private_to_command[axis]);
    }
    m->private_planned = m->private_planned || news;
}

/* ------------------------------------------------------------------------------- reasons to end */

/** The direction in which the robot moves, or is about to. */
static uint8_t direction(const roburoc4_move *m) {
    const float speed = m->private_speed[LENGTH], commanded = m->linear_m_s;
    const bool rolls = order_of(size_of(speed)) > order_of(0.05F);
    uint8_t sides = 0;
    sides |= order_of(commanded) > 0 || (rolls && order_of(speed) > 0) ? AHEAD : 0;
    sides |= order_of(commanded) < 0 || (rolls && order_of(speed) < 0) ? ASTERN : 0;
    return sides;
}

static int32_t check_bumpers(roburoc4_move *m, const roburoc4_move_view *v, uint8_t sides) {
    const uint8_t pressed =
        (uint8_t)((v->front_bumper ? AHEAD : 0) | (v->rear_bumper ? ASTERN : 0));
    m->private_bumpers &= pressed; /* pressed since the beginning */
    return (pressed & (sides | ~m->private_bumpers)) != 0 ? ROBUROC4_MOVE_BUMPER
                                                          : ROBUROC4_MOVE_RUNNING;
}

static int32_t check_clearance(const roburoc4_move *m, const roburoc4_move_view *v, uint8_t sides) {
    const float needed =
        m->private_options.clearance_m + RESPONSE_S * size_of(m->private_speed[LENGTH]);
    if (sides == 0 || order_of(m->private_options.clearance_m) == 0) {
        return ROBUROC4_MOVE_RUNNING;
    }
    if (v->blind) {
        return ROBUROC4_MOVE_LOST;
    }
    return ((sides & AHEAD) != 0 && order_of(nearer(FAR_M, v->front_m)) < order_of(needed)) ||
                   ((sides & ASTERN) != 0 && order_of(nearer(FAR_M, v->rear_m)) < order_of(needed))
               ? ROBUROC4_MOVE_OBSTACLE
               : ROBUROC4_MOVE_RUNNING;
}

static int32_t result_of(roburoc4_result cause) {
    switch (cause) {
    case ROBUROC4_ERR_OVERRIDE:
    case ROBUROC4_ERR_OVERRIDE_UNKNOWN:
        return ROBUROC4_MOVE_OVERRIDE;
    case ROBUROC4_ERR_OTHER_COMMANDER:
        return ROBUROC4_MOVE_OTHER_COMMANDER;
    case ROBUROC4_ERR_INHIBITED:
        return ROBUROC4_MOVE_INHIBITED;
    case ROBUROC4_ERR_DISARMED:
        return ROBUROC4_MOVE_CANCELLED;
    default:
        return ROBUROC4_MOVE_LOST;
    }
}

/** Reasons to end the move, whether it has arrived or not. */
static int32_t check_for_end(roburoc4_move *m, const roburoc4_move_view *v, uint64_t now_us) {
    const uint8_t sides = direction(m);
    int32_t result = check_bumpers(m, v, sides);
    if (m->private_kind == REST) {
        result = v->overridden ? ROBUROC4_MOVE_OVERRIDE : ROBUROC4_MOVE_RUNNING;
    } else if (v->inhibited) {
        result = ROBUROC4_MOVE_INHIBITED;
    } else if (!v->armed) {
        m->cause = v->disarm_cause;
        result = result_of(m->cause);
    } else if (result == ROBUROC4_MOVE_RUNNING) {
        result = check_clearance(m, v, sides);
    }
    if (result == ROBUROC4_MOVE_RUNNING && now_us - m->private_heard_us > SILENCE_US) {
        result = ROBUROC4_MOVE_LOST;
    }
    if (result == ROBUROC4_MOVE_RUNNING &&
        now_us - m->private_begun_us >= (uint64_t)m->private_timeout_ms * 1000U) {
        result = ROBUROC4_MOVE_TIMEOUT;
    }
    return result;
}

/* ----------------------------------------------------------------------------------- the speed */

/** The speed from which the robot comes to rest exactly when `to_command` is 0. A target ahead of
 * the speed by RESPONSE_S times an acceleration yields that acceleration. While braking, the square
 * root yields it: it is the speed at constant deceleration as a function of `to_command`. */
static float speed_for(const roburoc4_move *m, uint32_t axis) {
    const float to_command = m->private_to_command[axis], slope = m->private_slope[axis];
    const float distance = size_of(to_command), lead = RESPONSE_S * slope;
    if (order_of(distance) < order_of(near_enough[axis])) {
        return 0;
    }
    const float now = with_sign(m->private_speed[axis], m->private_speed[axis]);
    const bool turns_back = (order_of(m->private_speed[axis]) < 0) != (order_of(to_command) < 0);
    float speed = (turns_back ? 0 : now) + lead;
    speed = lesser(speed,
                   root(slope * (slope * (RESPONSE_S * RESPONSE_S - 2 * BEND_S2) + 2 * distance)));
    speed = lesser(speed, APPROACH_PER_S * distance);
    speed = order_of(speed) < order_of(least_speed[axis]) ? least_speed[axis] : speed;
    return with_sign(lesser(speed, m->private_limit[axis]), to_command);
}

/** The turn rate that keeps the robot on its line. */
static float steer(const roburoc4_move *m, float linear_m_s) {
    const float bend = curvature(m);
    const float distance_m = size_of(m->private_to_command[LENGTH]);
    const float back = within(RETURN_PER_M * m->private_aside_m, RETURN_MAX_RAD);
    const float faded =
        order_of(distance_m) < order_of(RETURN_MAX_RAD) ? back * distance_m / RETURN_MAX_RAD : back;
    const float heading = m->private_to_command[ANGLE] - bend * m->private_to_command[LENGTH] -
                          with_sign(faded, linear_m_s);
    const float lead = size_of(m->private_speed[ANGLE]) + RESPONSE_S * m->private_slope[ANGLE];
    return within(within(bend * linear_m_s + STEER_PER_S * heading, lead), m->private_limit[ANGLE]);
}

static void propose(roburoc4_move *m) {
    const bool turn = bits_from_f32(m->private_goal[LENGTH]) == 0;
    m->linear_m_s = turn ? 0 : speed_for(m, LENGTH);
    m->angular_rad_s =
        bits_from_f32(m->linear_m_s) == 0 ? speed_for(m, ANGLE) : steer(m, m->linear_m_s);
}

/* ------------------------------------------------------------------------------------ one step */

/** Plan the move as soon as everything that it needs is known. */
static int32_t plan(roburoc4_move *m, const roburoc4_move_view *v, uint64_t now_us) {
    const bool to = m->private_kind == TO_POINT || m->private_kind == TO_POSE;
    const bool looks = m->private_kind != REST && order_of(m->private_options.clearance_m) != 0;
    if (!m->private_begun) {
        m->private_begun = 1;
        m->private_begun_us = now_us;
        m->private_heard_us = now_us;
        m->private_step_us = now_us;
        m->private_timeout_ms = UINT32_MAX;
        m->private_bumpers = AHEAD | ASTERN;
    }
    if (v->speed_cycles == 0 || (to && v->pose_cycles == 0) || (looks && v->blind)) {
        return now_us - m->private_begun_us > SILENCE_US ? ROBUROC4_MOVE_LOST
                                                         : ROBUROC4_MOVE_RUNNING;
    }
    if (to && !plan_to(m, v)) {
        m->cause = ROBUROC4_ERR_ARGUMENT;
        return ROBUROC4_MOVE_CANCELLED;
    }
    set_profile(m, v);
    m->private_timeout_ms = default_timeout_ms(m);
    m->private_ready = 1;
    (void)check_bumpers(m, v, 0);
    return ROBUROC4_MOVE_RUNNING;
}

/** Subtract what was sent since the last step from `to_command`. */
static void count_sent(roburoc4_move *m, const roburoc4_move_view *v, uint64_t now_us) {
    const uint64_t passed_us = now_us - m->private_step_us;
    const float passed_s = passed_us > STEP_MAX_US ? 0 : (float)(uint32_t)passed_us * 1e-6F;
    m->private_step_us = now_us;
    m->private_to_command[LENGTH] -= v->sent_linear_m_s * passed_s;
    m->private_to_command[ANGLE] -= v->sent_angular_rad_s * passed_s;
}

static int32_t step(roburoc4_move *move, const roburoc4_move_view *view, uint64_t now_us) {
    int32_t result = move->private_ready ? ROBUROC4_MOVE_RUNNING : plan(move, view, now_us);
    if (result == ROBUROC4_MOVE_RUNNING) {
        count_sent(move, view, now_us);
        note_view(move, view, now_us);
        result = check_for_end(move, view, now_us);
    }
    move->remaining_m = move->private_goal[LENGTH] - move->private_covered[LENGTH];
    move->remaining_rad = move->private_goal[ANGLE] - move->private_covered[ANGLE];
    if (result == ROBUROC4_MOVE_RUNNING && move->private_ready && move->private_planned) {
        if (move->private_kind != REST) {
            propose(move);
        }
        if (bits_from_f32(move->linear_m_s) == 0 && bits_from_f32(move->angular_rad_s) == 0 &&
            move->private_still >= STILL_STATUSES && !next_leg(move)) {
            result = ROBUROC4_MOVE_REACHED;
        }
    }
    if (result != ROBUROC4_MOVE_RUNNING) {
        move->linear_m_s = 0;
        move->angular_rad_s = 0;
    }
    move->result = result;
    return result;
}

int32_t roburoc4_move_step_view(roburoc4_move *move, const roburoc4_move_view *view,
                                uint64_t now_us) {
    roburoc4_move_view known; /* the view of an older program lacks the last fields */
    if (move->result != ROBUROC4_MOVE_RUNNING) {
        return move->result;
    }
    if (view->size < VIEW_SIZE_1_0 || !size_known(view->size, sizeof known)) {
        move->linear_m_s = 0;
        move->angular_rad_s = 0;
        move->cause = ROBUROC4_ERR_SIZE;
        move->result = ROBUROC4_MOVE_CANCELLED;
        return move->result;
    }
    memset(&known, 0, sizeof known);
    memcpy(&known, view, view->size);
    return step(move, &known, now_us);
}

int32_t roburoc4_move_step(roburoc4_move *move, roburoc4_client *client, uint64_t now_us) {
    roburoc4_move_view view;
    roburoc4_facts facts;
    if (move->result != ROBUROC4_MOVE_RUNNING) {
        return move->result;
    }
    (void)roburoc4_client_facts(client, now_us, ROBUROC4_SIZED(&facts));
    if (move->private_kind == REST) {
        if (!facts.stopping) { /* another commander may have driven the robot since */
            (void)roburoc4_client_pause(client, now_us);
        }
    } else if (facts.driving) {
        move->private_driven = 1;
    } else if (move->private_driven && facts.armed) { /* the lease ended without this move */
        roburoc4_move_cancel(move, client, now_us);
        if (facts.lapsed) {
            move->result = ROBUROC4_MOVE_LAPSED;
        }
        return move->result;
    }
    view_client(&view, client, &facts, now_us);
    /* A client that disarmed itself has begun its stop sequence, and one that never drove commands
     * nothing. */
    if (step(move, &view, now_us) != ROBUROC4_MOVE_RUNNING && view.armed) {
        (void)roburoc4_client_pause(client, now_us);
    }
    if (move->result == ROBUROC4_MOVE_TIMEOUT && facts.other_commander) {
        move->result = ROBUROC4_MOVE_OTHER_COMMANDER;
    }
    return move->result;
}

void roburoc4_move_cancel(roburoc4_move *move, roburoc4_client *client, uint64_t now_us) {
    if (move->result == ROBUROC4_MOVE_RUNNING) {
        move->result = ROBUROC4_MOVE_CANCELLED;
        move->linear_m_s = 0;
        move->angular_rad_s = 0;
        (void)roburoc4_client_pause(client, now_us);
    }
}

const char *roburoc4_move_result_text(int32_t result) {
    static const char *const texts[] = {
        "the move is under way",
        "goal reached, the robot is at rest",
        "somebody holds [A] on the game pad: wait until it is released, then begin again",
        "a bumper is pressed: check what it touches, then back away",
        "a telemeter sees something too near: clear the way, or give a smaller clearance",
        "the robot does not move: check emergency stops, brakes selector and motor power",
        "no fresh statuses of what the move needs: check the link and the subscriptions",
        "another client commands the robot: end that one first",
        "timed out: check what blocks the robot, or allow more time",
        "cancelled, or the client is not armed",
        "the program did not step the move in time: find what blocked it, then begin again",
    };
    return result >= 0 && result < (int32_t)(sizeof texts / sizeof *texts) ? texts[result]
                                                                           : "unknown result";
}
