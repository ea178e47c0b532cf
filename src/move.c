/* SPDX-License-Identifier: MIT
 *
 * Moves: which speeds to command so that the robot comes to rest at its goal.
 *
 * A robot follows its commands late and not quite as far: some time after they ended it has covered
 * `gain` times the distance that was commanded. So what is left to command is the goal divided by
 * the gain, less what was commanded already; it shrinks with each command at once, and a loop
 * closed on it has neither lag nor overshoot. The gain is learned while moving (learn()), together
 * with the response, by least squares on distances: no measurement is differentiated. As long as it
 * is in doubt, the move assumes a robot that goes too far, brakes early, and makes up for it
 * afterwards.
 */
#include "roburoc4_move.h"

#include "bytes.h"

/* How the response is learned, found by a search on the robots of bench/family.c. A distance is
 * explained with an error of FIT_M and of FIT_SHARE of the distance that the filters are behind;
 * SPREAD is the standard deviation of gain, lag and bend before anything is known, and WANDER the
 * growth of the gain's variance with each status. */
#define FILTER_S 0.276F
#define FIT_M 0.00796F
#define FIT_SHARE 0.142F
#define WANDER 1.375e-07F
#define GAIN_SPREAD 0.05F
#define LAG_SPREAD_S 0.4F
#define BEND_SPREAD_S2 0.2323F
#define SPREADS_TOGETHER 0.99F
/* Expected before anything is known: typical, and no more than a beginning. SLOW_S is the root of
 * BEND_S2. */
#define LAG_S 0.64F
#define BEND_S2 0.168F
#define SLOW_S 0.41F
/* No robot of the family has a gain beyond these; noise may suggest one. */
#define GAIN_LEAST 0.7833F
#define GAIN_MOST 1.16F
/* The gain is assumed to be larger than learned by so many standard deviations. */
#define CAUTION 0.592F
/* Time constant of the approach to the goal: the least, how it grows with the response, the most.
 */
#define APPROACH_S 0.1206F
#define APPROACH_GROWS 2.19F
#define APPROACH_MOST_S 0.7507F
/* How slowly what the pose says replaces what the speeds say, and how old it may be: a pose that is
 * computed seldom looks fresh. */
#define DRIFT_S 0.241F
#define STALE_S 0.1464F
/* Turn rate per heading error, by the lag, which counts as at least STEER_S more; and heading per
 * distance from the line. */
#define STEER 0.3F
#define STEER_S 0.3F
#define RETURN_PER_M 0.5F
#define RETURN_MAX_RAD 0.2F

/* Statuses that a move needs are older: it is lost. A longer step means that the program was held
 * up, so that nobody knows what was commanded meanwhile. */
#define SILENCE_US 1000000U
#define STEP_MAX_US 250000U
#define STILL_STATUSES 2
#define FAR_M 10000.0F
#define PI_F 3.14159265F
#define TWO_TURNS 12.57F

/* Callers declare moves: their size is part of the ABI. */
typedef char assert_move_never_grows[sizeof(roburoc4_move) == 376 ? 1 : -1];

enum { LENGTH, ANGLE, BOTH };
enum { BY, TO_POINT, TO_POSE, FOR, REST };
enum { AHEAD = 1, ASTERN = 2 };
enum { GAIN, LAG, BEND, UNKNOWNS };

/* Nothing is commanded for a smaller rest; a goal this near is reached; a robot slower than this is
 * at rest, and one faster than that rolls. */
static const float near_enough[BOTH] = {0.004F, 0.006F};
static const float reached_within[BOTH] = {0.01F, 0.0175F};
static const float rest_speed[BOTH] = {0.03F, 0.06F};
static const float rolling_speed[BOTH] = {0.1F, 0.2F};
static const float slowest_speed[BOTH] = {0.06F, 0.06F};
/* How far the three witnesses may disagree, besides a fifth of the way; and a pose may jump. */
static const float disagreement[BOTH] = {0.15F, 0.26F};
#define DISAGREEMENT_SHARE 0.2F
#define LAGGING_S 2.0F

/* ------------------------------------------------------------------------ arithmetic, no libm */

static bool move_finite(float value) {
    return finite_f32_bits(bits_from_f32(value));
}

static float size_of(float value) {
    return f32_from_bits(bits_from_f32(value) & 0x7FFFFFFFU);
}

/** Also for -0. */
static bool at_zero(float value) {
    return bits_from_f32(value) << 1 == 0;
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

/** Within 2e-4. */
static float sine_of(float angle_rad) {
    float x = half_turn(angle_rad);
    x = order_of(size_of(x)) > order_of(PI_F / 2) ? with_sign(PI_F, x) - x : x;
    const float xx = x * x;
    return x * (1 - xx / 6 * (1 - xx / 20 * (1 - xx / 42)));
}

/** Within 1e-5 rad. */
static float angle_of(float x, float y) {
    const float ax = size_of(x), ay = size_of(y);
    const bool steep = order_of(ay) > order_of(ax);
    const float large = steep ? ay : ax;
    const float t = at_zero(large) ? 0 : (steep ? ax : ay) / large;
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
    sizeof(roburoc4_move_options), 0, 0.3F, 0.5F, 0.5F, 1.0F, 0.5F, 0};

roburoc4_result roburoc4_move_options_init(roburoc4_move_options *options, size_t size) {
    if (!size_known(size, sizeof move_defaults)) {
        return ROBUROC4_ERR_SIZE;
    }
    memcpy(options, &move_defaults, size);
    options->size = (uint32_t)size;
    return ROBUROC4_OK;
}

static bool beyond(float value, float bound) {
    return order_of(size_of(value)) > order_of(bound);
}

/** To a point or a pose. */
static bool to_place(const roburoc4_move *m) {
    return m->private_kind == TO_POINT || m->private_kind == TO_POSE;
}

/** No speed is proposed. */
static bool halted(const roburoc4_move *m) {
    return at_zero(m->linear_m_s) && at_zero(m->angular_rad_s);
}

static roburoc4_result bad_speeds(float linear_m_s, float angular_rad_s) {
    return beyond(linear_m_s, ROBUROC4_MAX_DRIVE_M_S) ||
                   beyond(angular_rad_s, ROBUROC4_MAX_DRIVE_RAD_S)
               ? ROBUROC4_ERR_UNITS
               : ROBUROC4_OK;
}

static roburoc4_result bad_options(const roburoc4_move_options *o) {
    const float positive[] = {o->linear_m_s, o->angular_rad_s, o->linear_m_s2, o->angular_rad_s2};
    for (uint32_t i = 0; i < sizeof positive / sizeof *positive; i++) {
        if (!move_finite(positive[i]) || order_of(positive[i]) <= 0) {
            return ROBUROC4_ERR_ARGUMENT;
        }
    }
    if (!move_finite(o->clearance_m) || order_of(o->clearance_m) < 0) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    return bad_speeds(o->linear_m_s, o->angular_rad_s);
}

static roburoc4_result refuse(roburoc4_move *m, roburoc4_result result) {
    m->result = ROBUROC4_MOVE_CANCELLED;
    return result;
}

/** Set up a move; if that fails, it has ended. */
static roburoc4_result begin(roburoc4_move *m, uint8_t kind, const roburoc4_move_options *options) {
    memset(m, 0, sizeof *m);
    m->private_kind = kind;
    m->private_options = move_defaults;
    if (options != NULL) {
        if (!size_known(options->size, sizeof move_defaults)) {
            return refuse(m, ROBUROC4_ERR_SIZE);
        }
        memcpy(&m->private_options, options, options->size);
    }
    const roburoc4_result result = bad_options(&m->private_options);
    return result < 0 ? refuse(m, result) : ROBUROC4_OK;
}

/** A distance or speed, and an angle or a turn rate. */
static roburoc4_result begin_with(roburoc4_move *m, uint8_t kind, float length, float angle,
                                  const roburoc4_move_options *options) {
    const roburoc4_result result = begin(m, kind, options);
    if (!move_finite(length) || !move_finite(angle)) {
        return refuse(m, ROBUROC4_ERR_NOT_FINITE);
    }
    m->private_goal[LENGTH] = length;
    m->private_goal[ANGLE] = angle;
    return result;
}

roburoc4_result roburoc4_move_by(roburoc4_move *m, float distance_m, float angle_rad,
                                 const roburoc4_move_options *options) {
    const roburoc4_result result = begin_with(m, BY, distance_m, angle_rad, options);
    if (result == ROBUROC4_OK && (beyond(distance_m, FAR_M) || beyond(angle_rad, FAR_M))) {
        return refuse(m, ROBUROC4_ERR_ARGUMENT);
    }
    if (result == ROBUROC4_OK && m->private_options.turns == 0 && beyond(angle_rad, TWO_TURNS)) {
        return refuse(m, ROBUROC4_ERR_UNITS);
    }
    return result;
}

roburoc4_result roburoc4_move_for(roburoc4_move *m, float linear_m_s, float angular_rad_s,
                                  uint32_t duration_ms, const roburoc4_move_options *options) {
    const roburoc4_result result = begin_with(m, FOR, linear_m_s, angular_rad_s, options);
    m->private_duration_ms = duration_ms;
    if (result == ROBUROC4_OK && bad_speeds(linear_m_s, angular_rad_s) < 0) {
        return refuse(m, ROBUROC4_ERR_UNITS);
    }
    return result;
}

static roburoc4_result begin_to(roburoc4_move *m, uint8_t kind, double x_m, double y_m,
                                double theta_rad, const roburoc4_move_options *options) {
    const roburoc4_result result = begin(m, kind, options);
    if (!finite_f64_bits(bits_from_f64(x_m)) || !finite_f64_bits(bits_from_f64(y_m)) ||
        !finite_f64_bits(bits_from_f64(theta_rad))) {
        return refuse(m, ROBUROC4_ERR_NOT_FINITE);
    }
    if (result == ROBUROC4_OK && m->private_options.turns == 0 &&
        beyond((float)theta_rad, TWO_TURNS)) {
        return refuse(m, ROBUROC4_ERR_UNITS);
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

static void view_distances(roburoc4_move_view *v, const roburoc4_client *client) {
    roburoc4_distances distances;
    roburoc4_telemeter telemeter;
    v->front_m = FAR_M;
    v->rear_m = FAR_M;
    if (v->distance_age_us > SILENCE_US ||
        roburoc4_client_distances(client, &distances, NULL) != ROBUROC4_OK) {
        return;
    }
    for (uint32_t i = 0;
         i < distances.count && roburoc4_client_telemeter(client, i, &telemeter) == ROBUROC4_OK;
         i++) {
        const float aside = half_turn(telemeter.theta_rad);
        if (!beyond(aside, PI_F / 3)) {
            v->front_m = nearer(v->front_m, telemeter.distance_m);
            v->front_known = 1;
        } else if (beyond(aside, 2 * PI_F / 3)) {
            v->rear_m = nearer(v->rear_m, telemeter.distance_m);
            v->rear_known = 1;
        }
    }
}

/** The smaller size of a pair of limits. */
static float both_ways(float low, float high) {
    return lesser(size_of(low), size_of(high));
}

static void view_client(roburoc4_move_view *v, const roburoc4_client *client,
                        const roburoc4_facts *facts) {
    roburoc4_differential_properties limits;
    roburoc4_differential_status speeds;
    roburoc4_localization_status pose;
    memset(v, 0, sizeof *v);
    v->size = sizeof *v;
    v->relocalized = (uint32_t)client->private_outputs.relocalize_us;
    v->armed = facts->armed;
    v->overridden = facts->overridden;
    v->inhibited = facts->inhibited;
    v->front_bumper = facts->front_bumper;
    v->rear_bumper = facts->rear_bumper;
    v->front_bumper_known = facts->front_bumper_known;
    v->rear_bumper_known = facts->rear_bumper_known;
    v->distance_age_us = facts->age_us[ROBUROC4_SERVICE_TELEMETER];
    v->disarm_cause = facts->disarm_cause;
    if (!facts->stopping) {
        v->sent_linear_m_s = facts->sent_linear_m_s;
        v->sent_angular_rad_s = facts->sent_angular_rad_s;
    }
    if (facts->age_us[ROBUROC4_SERVICE_DIFFERENTIAL] != UINT32_MAX &&
        !client->private_outputs.relocalizing &&
        roburoc4_client_differential(client, &speeds, NULL) == ROBUROC4_OK) {
        v->speed_cycles = speeds.robot_cycles;
        v->linear_m_s = speeds.current_linear_m_s;
        v->angular_rad_s = speeds.current_angular_rad_s;
    }
    if (facts->age_us[ROBUROC4_SERVICE_LOCALIZATION] < client->private_config.fresh_ms * 1000U &&
        roburoc4_client_localization(client, &pose, NULL) == ROBUROC4_OK && usable(&pose)) {
        v->pose_cycles = pose.robot_cycles;
        v->x_m = pose.x_m;
        v->y_m = pose.y_m;
        v->theta_rad = pose.theta_rad;
    }
    if (roburoc4_client_differential_properties(client, &limits) == ROBUROC4_OK) {
        v->max_linear_m_s = both_ways(limits.min_linear_m_s, limits.max_linear_m_s);
        v->max_angular_rad_s = both_ways(limits.min_angular_rad_s, limits.max_angular_rad_s);
        v->max_linear_m_s2 = both_ways(limits.min_linear_m_s2, limits.max_linear_m_s2);
        v->max_angular_rad_s2 = both_ways(limits.min_angular_rad_s2, limits.max_angular_rad_s2);
    }
    view_distances(v, client);
}

/* ------------------------------------------------------------------------------------ the plan */

/** The axis that the present leg is about. */
static uint32_t axis_of(const roburoc4_move *m) {
    return at_zero(m->private_goal[LENGTH]) ? ANGLE : LENGTH;
}

/** Begin a leg of this length, counted from here; the robot is at rest. */
static void start_leg(roburoc4_move *m, float distance_m, float angle_rad) {
    static const float expected[UNKNOWNS] = {1, LAG_S / FILTER_S, BEND_S2 / (FILTER_S * FILTER_S)};
    static const float spread[UNKNOWNS] = {GAIN_SPREAD, LAG_SPREAD_S / FILTER_S,
                                           BEND_SPREAD_S2 / (FILTER_S * FILTER_S)};
    m->private_goal[LENGTH] = distance_m;
    m->private_goal[ANGLE] = angle_rad;
    memset(m->private_covered, 0, sizeof m->private_covered);
    memset(m->private_by_speeds, 0, sizeof m->private_by_speeds);
    memset(m->private_commanded, 0, sizeof m->private_commanded);
    memset(m->private_lagging, 0, sizeof m->private_lagging);
    memset(m->private_filter, 0, sizeof m->private_filter);
    memset(m->private_doubt, 0, sizeof m->private_doubt);
    memcpy(m->private_fit, expected, sizeof expected);
    for (uint32_t i = 0; i < UNKNOWNS; i++) {
        m->private_doubt[i * UNKNOWNS + i] = spread[i] * spread[i];
    }
    m->private_doubt[LAG * UNKNOWNS + BEND] = SPREADS_TOGETHER * spread[LAG] * spread[BEND];
    m->private_doubt[BEND * UNKNOWNS + LAG] = SPREADS_TOGETHER * spread[LAG] * spread[BEND];
    m->private_drift = 0;
    m->private_distance = 0;
    m->private_aside_m = 0;
    m->private_holds = 0;
    m->private_side = 0;
    m->private_turned = 0;
}

/** Begin the next leg, with what the last one left over; false after the last leg. */
static bool next_leg(roburoc4_move *m) {
    const float left_rad = m->private_goal[ANGLE] - m->private_covered[ANGLE];
    m->private_leg++;
    if (to_place(m)) {
        if (m->private_leg == 1 && !at_zero(m->private_line_m)) {
            start_leg(m, m->private_line_m, 0);
            m->private_covered[ANGLE] = m->private_by_speeds[ANGLE] = -left_rad;
            return true;
        }
        if (m->private_leg <= 2 && m->private_kind == TO_POSE) {
            m->private_leg = 2;
            start_leg(m, 0, left_rad + m->private_last_turn_rad);
            return true;
        }
    } else if (m->private_kind == BY && axis_of(m) == LENGTH &&
               beyond(left_rad, reached_within[ANGLE])) {
        start_leg(m, 0, left_rad);
        return true;
    }
    return false;
}

/** Turn, straight line and turn from this pose; false if it is farther than a move may go. */
static bool plan_to(roburoc4_move *m, const roburoc4_move_view *pose) {
    const float x = (float)(m->private_x_m - pose->x_m), y = (float)(m->private_y_m - pose->y_m);
    if (beyond(x, FAR_M) || beyond(y, FAR_M)) {
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
    return axis_of(m) == ANGLE ? 0 : m->private_goal[ANGLE] / m->private_goal[LENGTH];
}

/** Not more than the robot's own limit, where that is known. */
static float at_most_own(float value, float own) {
    return move_finite(own) && order_of(own) > 0 ? lesser(value, own) : value;
}

/** Speeds and accelerations: the requested ones, limited to the robot's own. A move for a time has
 * one profile for both axes: the share of its speeds. */
static void set_profile(roburoc4_move *m, const roburoc4_move_view *v) {
    const roburoc4_move_options *o = &m->private_options;
    float *limit = m->private_limit, *slope = m->private_slope;
    limit[LENGTH] = at_most_own(o->linear_m_s, v->max_linear_m_s);
    limit[ANGLE] = at_most_own(o->angular_rad_s, v->max_angular_rad_s);
    slope[LENGTH] = at_most_own(o->linear_m_s2, v->max_linear_m_s2);
    slope[ANGLE] = at_most_own(o->angular_rad_s2, v->max_angular_rad_s2);
    const float bend = m->private_kind == BY ? size_of(curvature(m)) : 0;
    if (order_of(bend) > 0) {
        limit[LENGTH] = lesser(limit[LENGTH], limit[ANGLE] / bend);
        slope[LENGTH] = lesser(slope[LENGTH], slope[ANGLE] / bend);
    }
}

/** Twice the time of the profile, and 3 s. */
static uint32_t default_timeout_ms(const roburoc4_move *m) {
    if (m->private_options.timeout_ms != 0) {
        return m->private_options.timeout_ms;
    }
    if (m->private_kind == REST) {
        return 5000;
    }
    if (m->private_kind == FOR) {
        return m->private_duration_ms > 1000000000U ? UINT32_MAX
                                                    : 2 * m->private_duration_ms + 3000;
    }
    const float path[BOTH] = {size_of(m->private_goal[LENGTH]) + m->private_line_m,
                              size_of(m->private_goal[ANGLE]) + size_of(m->private_last_turn_rad)};
    float seconds = 0;
    for (uint32_t axis = 0; axis < BOTH; axis++) {
        const float speed = m->private_limit[axis];
        seconds += path[axis] / speed + (!at_zero(path[axis]) ? speed / m->private_slope[axis] : 0);
    }
    return order_of(seconds) > order_of(1e6F) ? UINT32_MAX : 3000 + (uint32_t)(2000 * seconds);
}

/* ------------------------------------------------------------------------------------ odometry */

/** The time since the last step; 0 if the program was stopped meanwhile. */
static float seconds_of(uint64_t passed_us) {
    return passed_us > STEP_MAX_US ? 0 : (float)(uint32_t)passed_us * 1e-6F;
}

/** Robot time since the last status; 0 for the first, and after a restart. */
static float seconds_from(uint64_t before_cycles, uint64_t cycles) {
    const uint64_t passed = cycles - before_cycles;
    return before_cycles == 0 || passed > 1000 ? 0 : (float)(uint32_t)passed * 0.01F;
}

/** Count a distance and an angle; `across_m` is to the left. */
static void cover(roburoc4_move *m, float distance_m, float across_m, float angle_rad) {
    const float astray = m->private_covered[ANGLE] - curvature(m) * m->private_covered[LENGTH];
    m->private_covered[LENGTH] += distance_m;
    m->private_covered[ANGLE] += angle_rad;
    m->private_aside_m += distance_m * (astray + 0.5F * angle_rad) + across_m;
    m->distance_m += distance_m;
    m->angle_rad += angle_rad;
}

/** Follow the pose; false if it jumped by more than any speed explains. */
static bool note_pose(roburoc4_move *m, const roburoc4_move_view *pose) {
    const float passed_s = seconds_from(m->private_pose_cycles, pose->pose_cycles);
    const float x = (float)(pose->x_m - m->private_x0_m), y = (float)(pose->y_m - m->private_y0_m);
    const float turned = half_turn((float)(pose->theta_rad - m->private_theta0_rad));
    const float heading = half_turn((float)m->private_theta0_rad) + 0.5F * turned;
    const float ahead = sine_of(heading + PI_F / 2), left = sine_of(heading);
    const float distance_m = x * ahead + y * left, across_m = y * ahead - x * left;
    if (m->private_posed) {
        for (uint32_t axis = 0; axis < BOTH; axis++) {
            const float most = disagreement[axis] + 1.5F * passed_s * m->private_limit[axis];
            if (beyond(axis == LENGTH ? distance_m : turned, most) ||
                (axis == LENGTH && beyond(across_m, most))) {
                return false;
            }
        }
        cover(m, distance_m, across_m, turned);
    }
    m->private_pose_cycles = pose->pose_cycles;
    m->private_x0_m = pose->x_m;
    m->private_y0_m = pose->y_m;
    m->private_theta0_rad = pose->theta_rad;
    return true;
}

/** A differential status: add the distance since the last one. */
static void note_speeds(roburoc4_move *m, const roburoc4_move_view *v) {
    const float speeds[BOTH] = {v->linear_m_s, v->angular_rad_s};
    const float passed_s = seconds_from(m->private_speed_cycles, v->speed_cycles);
    float covered[BOTH];
    bool still = true;
    for (uint32_t axis = 0; axis < BOTH; axis++) {
        const float speed = move_finite(speeds[axis]) ? speeds[axis] : 0;
        covered[axis] = 0.5F * (speed + m->private_speed[axis]) * passed_s;
        m->private_by_speeds[axis] += covered[axis];
        m->private_speed[axis] = speed;
        still = still && !beyond(speed, rest_speed[axis]);
    }
    m->private_speed_cycles = v->speed_cycles;
    m->private_still = still ? (uint8_t)(m->private_still + (m->private_still < 100)) : 0;
    if (!m->private_posed) {
        cover(m, covered[LENGTH], 0, covered[ANGLE]);
    }
}

/** The speed on the axis of the leg, smoothed. */
static float slow_speed(const roburoc4_move *m) {
    return (m->private_distance - m->private_filter[0]) / FILTER_S;
}

/** Whether the robot is at rest: by the smoothed speed, or sooner by two statuses if that agrees
 * roughly. Single statuses may be too noisy to decide. */
static bool stands(const roburoc4_move *m) {
    const float rest = rest_speed[axis_of(m)], speed = slow_speed(m);
    return !beyond(speed, 0.7F * rest) ||
           (m->private_still >= STILL_STATUSES && !beyond(speed, 2.2F * rest));
}

/** Learn how the robot follows, from the distance by its speeds and the one commanded, c:
 *
 *     distance + lag * speed + bend * acceleration = gain * c
 *
 * Both sides pass the same filter twice, after which the speed and the acceleration of the distance
 * are differences of its stages: they need no derivative, and all are distances. The three unknowns
 * follow by recursive least squares; `doubt` is their covariance. */
static void learn(roburoc4_move *m, float passed_s, bool news) {
    const uint32_t axis = axis_of(m);
    const float share = passed_s / FILTER_S;
    const float distance = m->private_distance;
    float *f = m->private_filter, *doubt = m->private_doubt;
    f[0] += share * (distance - f[0]);
    f[1] += share * (f[0] - f[1]);
    f[2] += share * (m->private_commanded[axis] - f[2]);
    f[3] += share * (f[2] - f[3]);
    if (!news) {
        return;
    }
    const float terms[UNKNOWNS] = {f[3], f[1] - f[0], f[0] + f[0] - distance - f[1]};
    const float behind = FIT_SHARE * (f[2] - f[3]);
    float weights[UNKNOWNS], error = f[1], variance = FIT_M * FIT_M + behind * behind;
    for (uint32_t i = 0; i < UNKNOWNS; i++) {
        weights[i] = 0;
        for (uint32_t j = 0; j < UNKNOWNS; j++) {
            weights[i] += doubt[i * UNKNOWNS + j] * terms[j];
        }
        error -= m->private_fit[i] * terms[i];
        variance += weights[i] * terms[i];
    }
    for (uint32_t i = 0; i < UNKNOWNS; i++) {
        const float step = weights[i] / variance;
        m->private_fit[i] += step * error;
        for (uint32_t j = 0; j < UNKNOWNS; j++) {
            doubt[i * UNKNOWNS + j] -= step * weights[j];
        }
    }
    doubt[GAIN] += WANDER;
}

/** Take what is new in the view, and note when it arrived; false if the pose jumped. */
static bool note_view(roburoc4_move *m, const roburoc4_move_view *v, float passed_s,
                      uint64_t now_us) {
    const float sent[BOTH] = {v->sent_linear_m_s, v->sent_angular_rad_s};
    const uint32_t axis = axis_of(m);
    const bool news = v->speed_cycles != m->private_speed_cycles;
    m->private_step_us = now_us;
    for (uint32_t i = 0; i < BOTH; i++) {
        m->private_commanded[i] += passed_s * sent[i];
        m->private_lagging[i] +=
            passed_s / LAGGING_S * (m->private_commanded[i] - m->private_lagging[i]);
    }
    if (news) {
        note_speeds(m, v);
        m->private_heard_us = now_us;
    }
    if (m->private_posed && v->pose_cycles != 0 && v->pose_cycles != m->private_pose_cycles) {
        m->private_pose_us = now_us;
        if (!note_pose(m, v)) {
            return false;
        }
    }
    const float drift = m->private_covered[axis] - m->private_by_speeds[axis] - m->private_drift;
    m->private_drift +=
        passed_s / DRIFT_S * (drift - within(drift, STALE_S * size_of(slow_speed(m))));
    m->private_distance = m->private_by_speeds[axis] +
                          m->private_speed[axis] * seconds_of(now_us - m->private_heard_us);
    learn(m, passed_s, news);
    return true;
}

/* ------------------------------------------------------------------------------- reasons to end */

static float gain_of(const roburoc4_move *m, float deviations) {
    const float doubt = m->private_doubt[GAIN];
    const float gain = m->private_fit[GAIN] + (order_of(doubt) > 0 ? deviations * root(doubt) : 0);
    return order_of(gain) < order_of(GAIN_LEAST) ? GAIN_LEAST : lesser(gain, GAIN_MOST);
}

/** The direction in which the robot moves, or is about to. */
static uint8_t direction(const roburoc4_move *m) {
    const float speed = m->private_speed[LENGTH], commanded = m->linear_m_s;
    const bool rolls = beyond(speed, 0.05F);
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

/** What a move with a clearance needs and does not see. */
static int32_t check_sight(const roburoc4_move *m, const roburoc4_move_view *v, uint8_t sides) {
    if (m->private_kind == REST || order_of(m->private_options.clearance_m) == 0) {
        return ROBUROC4_MOVE_RUNNING;
    }
    return !v->front_bumper_known                    ? ROBUROC4_MOVE_NO_FRONT_BUMPER
           : !v->rear_bumper_known                   ? ROBUROC4_MOVE_NO_REAR_BUMPER
           : (sides & AHEAD) != 0 && !v->front_known ? ROBUROC4_MOVE_NO_FRONT_TELEMETER
           : (sides & ASTERN) != 0 && !v->rear_known ? ROBUROC4_MOVE_NO_REAR_TELEMETER
                                                     : ROBUROC4_MOVE_RUNNING;
}

/** The robot still covers what was commanded and not covered yet, and has covered something since
 * the distances were measured. */
static int32_t check_clearance(const roburoc4_move *m, const roburoc4_move_view *v, uint8_t sides) {
    const float speed = size_of(m->private_speed[LENGTH]);
    const float rolls =
        size_of(gain_of(m, CAUTION) * m->private_commanded[LENGTH] - m->private_by_speeds[LENGTH]);
    const float needed =
        m->private_options.clearance_m + rolls + speed * (float)v->distance_age_us * 1e-6F;
    if (order_of(m->private_options.clearance_m) == 0) {
        return ROBUROC4_MOVE_RUNNING;
    }
    return ((sides & AHEAD) != 0 && order_of(nearer(FAR_M, v->front_m)) < order_of(needed)) ||
                   ((sides & ASTERN) != 0 && order_of(nearer(FAR_M, v->rear_m)) < order_of(needed))
               ? ROBUROC4_MOVE_OBSTACLE
               : ROBUROC4_MOVE_RUNNING;
}

/** Whether a distance is beyond one of two others by more than may be. */
static bool disagree(uint32_t axis, float distance, float a, float b) {
    const bool less = order_of(a) < order_of(b);
    const float low = less ? a : b, high = less ? b : a;
    const float way = beyond(a, size_of(distance)) ? size_of(a) : size_of(distance);
    const float most = disagreement[axis] + DISAGREEMENT_SHARE * way;
    return order_of(distance) > order_of(high + most) || order_of(distance) < order_of(low - most);
}

/** The three witnesses: what was commanded, what the speeds say, what the pose says. The robot
 * follows commands late: it is between them and what they were. */
static bool witnesses_disagree(const roburoc4_move *m) {
    for (uint32_t axis = 0; axis < BOTH; axis++) {
        const float speeds = m->private_by_speeds[axis], covered = m->private_covered[axis];
        if (disagree(axis, covered, speeds, speeds) ||
            (!m->private_rolls &&
             disagree(axis, speeds, m->private_commanded[axis], m->private_lagging[axis]))) {
            return true;
        }
    }
    return false;
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
    case ROBUROC4_ERR_LAPSED:
        return ROBUROC4_MOVE_LAPSED;
    case ROBUROC4_ERR_DISARMED:
    case ROBUROC4_ERR_STOPPED:
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
        result = m->private_ready ? check_sight(m, v, sides) : ROBUROC4_MOVE_RUNNING;
        result = result == ROBUROC4_MOVE_RUNNING ? check_clearance(m, v, sides) : result;
        if (result == ROBUROC4_MOVE_RUNNING && witnesses_disagree(m)) {
            result = ROBUROC4_MOVE_ODOMETRY;
        }
    }
    if (result == ROBUROC4_MOVE_RUNNING &&
        (now_us - m->private_heard_us > SILENCE_US ||
         (m->private_posed && now_us - m->private_pose_us > SILENCE_US))) {
        result = ROBUROC4_MOVE_LOST;
    }
    if (result == ROBUROC4_MOVE_RUNNING &&
        now_us - m->private_begun_us >= (uint64_t)m->private_timeout_ms * 1000U) {
        result = ROBUROC4_MOVE_TIMEOUT;
    }
    return result;
}

/* ----------------------------------------------------------------------------------- the speed */

/** Whether the robot stands beside the goal of its line or arc, and no leg corrects that. */
static bool off_course(const roburoc4_move *m) {
    return m->private_kind != FOR && m->private_kind != REST && axis_of(m) == LENGTH &&
           beyond(m->private_aside_m, 0.02F + 0.01F * size_of(m->private_goal[LENGTH]));
}

/** What is left to command on the axis of the leg. */
static float to_command(const roburoc4_move *m, float deviations) {
    const uint32_t axis = axis_of(m);
    return (m->private_goal[axis] - m->private_drift) / gain_of(m, deviations) -
           m->private_commanded[axis];
}

/** The time constant of the approach: longer for a robot that responds more slowly. */
static float approach_s(const roburoc4_move *m) {
    const float lag_s = m->private_fit[LAG] * FILTER_S, bend = m->private_fit[BEND];
    const float swing_s = order_of(bend) > 0 ? root(bend) * FILTER_S : 0;
    const float slow_s = order_of(swing_s) > order_of(0.5F * lag_s) ? swing_s : 0.5F * lag_s;
    const float time_s = APPROACH_S + APPROACH_GROWS * (slow_s - SLOW_S);
    return order_of(time_s) < order_of(APPROACH_S) ? APPROACH_S : lesser(time_s, APPROACH_MOST_S);
}

/** The speed that the profile has next, `passed_s` after `now`. */
static float toward(float now, float wanted, float slope, float passed_s) {
    return now + within(wanted - now, slope * passed_s);
}

/** The speed at which braking has to begin for the leg's end: at constant deceleration far from it,
 * and in proportion to what is left near it. */
static float speed_for(roburoc4_move *m) {
    const uint32_t axis = axis_of(m);
    const float left = to_command(m, CAUTION), distance = size_of(left);
    const float slope = m->private_slope[axis], time_s = approach_s(m);
    const float bound = m->private_holds ? 2 * near_enough[axis] : near_enough[axis];
    m->private_holds = !beyond(distance, bound);
    if (m->private_holds) {
        return 0;
    }
    float speed = slope * (root(time_s * time_s + 2 * distance / slope) - time_s);
    speed = order_of(speed) < order_of(slowest_speed[axis]) ? slowest_speed[axis] : speed;
    speed = with_sign(lesser(speed, m->private_limit[axis]), left);
    /* It turns back once while the robot rolls, to brake; then only from rest. */
    const float now = axis == LENGTH ? m->linear_m_s : m->angular_rad_s;
    const int8_t side = order_of(speed) < 0 ? -1 : 1;
    if (side == -m->private_side) {
        if (m->private_turned && !(at_zero(now) && stands(m))) {
            return 0;
        }
        m->private_turned = 1;
    }
    m->private_side = side;
    return speed;
}

/** The turn rate that keeps the robot on its line. */
static float steer(const roburoc4_move *m) {
    const float bend = curvature(m);
    if (at_zero(m->linear_m_s)) {
        return 0;
    }
    const float lag_s = m->private_fit[LAG] * FILTER_S;
    const float back = within(RETURN_PER_M * m->private_aside_m, RETURN_MAX_RAD);
    const float heading = bend * m->private_covered[LENGTH] - m->private_covered[ANGLE] -
                          with_sign(back, m->linear_m_s);
    const float rate = STEER / (order_of(lag_s) > 0 ? lag_s + STEER_S : STEER_S);
    return within(bend * m->linear_m_s + rate * heading, m->private_limit[ANGLE]);
}

/** The share of its speeds that a move for a time has now: up, along and down again in time. */
static float share_for(roburoc4_move *m, float passed_s, uint64_t now_us) {
    if (m->private_first_us == 0 && order_of(passed_s) > 0) {
        m->private_first_us = now_us;
    }
    const uint64_t end_us = m->private_first_us + (uint64_t)m->private_duration_ms * 1000U;
    const float left_s = now_us < end_us ? (float)(end_us - now_us) * 1e-6F : 0;
    float slope = FAR_M;
    for (uint32_t axis = 0; axis < BOTH; axis++) {
        const float speed = size_of(m->private_goal[axis]);
        slope = order_of(speed) > 0 ? lesser(slope, m->private_slope[axis] / speed) : slope;
    }
    return lesser(lesser(1, slope * left_s), m->private_share + slope * passed_s);
}

/** Ramp down a robot that moved when the move began; its first leg begins at rest. */
static bool rolls(roburoc4_move *m) {
    if (m->private_rolls && halted(m) && m->private_still >= STILL_STATUSES) {
        m->private_rolls = 0;
        if (m->private_kind != FOR) {
            start_leg(m, m->private_goal[LENGTH] - m->private_covered[LENGTH],
                      m->private_goal[ANGLE] - m->private_covered[ANGLE]);
        }
    }
    return m->private_rolls;
}

static void propose(roburoc4_move *m, float passed_s, uint64_t now_us) {
    float wanted[BOTH] = {0, 0};
    const uint32_t axis = axis_of(m);
    if (rolls(m)) {
    } else if (m->private_kind == FOR) {
        m->private_share = share_for(m, passed_s, now_us);
        m->linear_m_s = m->private_share * m->private_goal[LENGTH];
        m->angular_rad_s = m->private_share * m->private_goal[ANGLE];
        return;
    } else {
        wanted[axis] = speed_for(m);
        wanted[ANGLE] = axis == LENGTH ? steer(m) : wanted[ANGLE];
    }
    m->linear_m_s = toward(m->linear_m_s, wanted[LENGTH], m->private_slope[LENGTH], passed_s);
    m->angular_rad_s = toward(m->angular_rad_s, wanted[ANGLE], m->private_slope[ANGLE], passed_s);
}

/** At the goal of the leg, and about to stay there. */
static bool arrived(const roburoc4_move *m) {
    const uint32_t axis = axis_of(m);
    if (m->private_kind == FOR) {
        return m->private_first_us != 0 && m->private_still >= STILL_STATUSES;
    }
    return !m->private_rolls && stands(m) && !beyond(to_command(m, 0), reached_within[axis]) &&
           !beyond(m->private_goal[axis] - m->private_covered[axis], reached_within[axis]);
}

/* ------------------------------------------------------------------------------------ one step */

/** Where a move is about to go. */
static uint8_t intended(const roburoc4_move *m) {
    const int32_t length = order_of(m->private_goal[LENGTH]);
    return to_place(m) || length > 0 ? AHEAD : length < 0 ? ASTERN : 0;
}

/** Plan the move as soon as everything that it needs is known, or after a second end it with what
 * is missing. */
static int32_t plan(roburoc4_move *m, const roburoc4_move_view *v, uint64_t now_us) {
    const bool to = to_place(m);
    const int32_t sight = check_sight(m, v, intended(m));
    if (!m->private_begun) {
        m->private_begun = 1;
        m->private_begun_us = now_us;
        m->private_heard_us = now_us;
        m->private_timeout_ms = UINT32_MAX;
        m->private_bumpers = AHEAD | ASTERN;
    }
    m->private_step_us = now_us;
    if (m->private_kind != REST && !v->armed) {
        return ROBUROC4_MOVE_RUNNING; /* the reason ends it */
    }
    if (v->speed_cycles == 0 || (to && v->pose_cycles == 0) || sight != ROBUROC4_MOVE_RUNNING) {
        return now_us - m->private_begun_us <= SILENCE_US ? ROBUROC4_MOVE_RUNNING
               : sight != ROBUROC4_MOVE_RUNNING           ? sight
                                                          : ROBUROC4_MOVE_LOST;
    }
    if (m->private_kind != REST) {
        m->linear_m_s = v->sent_linear_m_s;
        m->angular_rad_s = v->sent_angular_rad_s;
    }
    m->private_rolls = !halted(m) || beyond(v->linear_m_s, rolling_speed[LENGTH]) ||
                       beyond(v->angular_rad_s, rolling_speed[ANGLE]);
    if (to && !plan_to(m, v)) {
        m->cause = ROBUROC4_ERR_ARGUMENT;
        return ROBUROC4_MOVE_CANCELLED;
    }
    if (m->private_kind == BY) {
        start_leg(m, m->private_goal[LENGTH], m->private_goal[ANGLE]);
    }
    set_profile(m, v);
    m->private_timeout_ms = default_timeout_ms(m);
    m->private_relocalized = v->relocalized;
    m->private_pose_us = now_us;
    (void)note_pose(m, v);
    m->private_posed = v->pose_cycles != 0;
    m->private_ready = 1;
    (void)check_bumpers(m, v, 0);
    return ROBUROC4_MOVE_RUNNING;
}

static int32_t end(roburoc4_move *m, int32_t result) {
    m->result = result;
    m->linear_m_s = 0;
    m->angular_rad_s = 0;
    return result;
}

static int32_t step(roburoc4_move *move, const roburoc4_move_view *view, uint64_t now_us) {
    int32_t result = move->private_ready ? ROBUROC4_MOVE_RUNNING : plan(move, view, now_us);
    const float passed_s = seconds_of(now_us - move->private_step_us);
    if (result == ROBUROC4_MOVE_RUNNING && move->private_ready &&
        ((move->private_posed && view->relocalized != move->private_relocalized) ||
         !note_view(move, view, passed_s, now_us))) {
        result = ROBUROC4_MOVE_RELOCALIZED;
    }
    if (result == ROBUROC4_MOVE_RUNNING) {
        result = check_for_end(move, view, now_us);
    }
    if (move->private_kind != FOR) {
        move->remaining_m = move->private_goal[LENGTH] - move->private_covered[LENGTH];
        move->remaining_rad = move->private_goal[ANGLE] - move->private_covered[ANGLE];
    }
    if (result == ROBUROC4_MOVE_RUNNING && move->private_ready) {
        if (move->private_kind != REST) {
            propose(move, passed_s, now_us);
        }
        if (halted(move) &&
            (move->private_kind == REST ? move->private_still >= STILL_STATUSES : arrived(move)) &&
            !next_leg(move)) {
            result = off_course(move) ? ROBUROC4_MOVE_OFF_COURSE : ROBUROC4_MOVE_REACHED;
        }
    }
    return result == ROBUROC4_MOVE_RUNNING ? result : end(move, result);
}

int32_t roburoc4_move_step_view(roburoc4_move *move, const roburoc4_move_view *view,
                                uint64_t now_us) {
    if (move->result != ROBUROC4_MOVE_RUNNING) {
        return move->result;
    }
    if (view->size != sizeof *view) {
        move->cause = ROBUROC4_ERR_SIZE;
        return end(move, ROBUROC4_MOVE_CANCELLED);
    }
    return step(move, view, now_us);
}

/** Whether a speed was asked for that the client would lower; the defaults are lowered. */
static bool too_fast(roburoc4_move *m, const roburoc4_client *client) {
    const roburoc4_config *config = &client->private_config;
    const float ceilings[BOTH] = {config->max_linear_m_s, config->max_angular_rad_s};
    const float defaults[BOTH] = {move_defaults.linear_m_s, move_defaults.angular_rad_s};
    float *asked[BOTH] = {&m->private_options.linear_m_s, &m->private_options.angular_rad_s};
    for (uint32_t axis = 0; axis < BOTH; axis++) {
        if (beyond(m->private_kind == FOR ? m->private_goal[axis] : *asked[axis], ceilings[axis]) &&
            (m->private_kind == FOR || beyond(*asked[axis], defaults[axis]))) {
            return true;
        }
        *asked[axis] = lesser(*asked[axis], ceilings[axis]);
    }
    return false;
}

int32_t roburoc4_move_step(roburoc4_move *move, roburoc4_client *client, uint64_t now_us) {
    roburoc4_move_view view;
    roburoc4_facts facts;
    if (move->result != ROBUROC4_MOVE_RUNNING) {
        return move->result;
    }
    (void)roburoc4_client_facts(client, now_us, ROBUROC4_SIZED(&facts));
    /* After a lapse the stop sequence is sent already. pause() would keep the client armed. */
    const bool lapsed = facts.armed && facts.lapsed;
    move->private_driven |= facts.driving;
    if (!move->private_ready && too_fast(move, client)) {
        end(move, ROBUROC4_MOVE_TOO_FAST);
    } else if (move->private_kind != REST && move->private_driven && !facts.driving &&
               facts.armed) { /* the lease ended without this move */
        end(move, lapsed ? ROBUROC4_MOVE_LAPSED : ROBUROC4_MOVE_CANCELLED);
    } else {
        view_client(&view, client, &facts);
        (void)step(move, &view, now_us);
    }
    /* A robot that is brought to rest may have been driven by another commander since. A client
     * that disarmed itself has begun its stop sequence, and one that never drove commands nothing.
     */
    const bool ended = move->result != ROBUROC4_MOVE_RUNNING;
    if (!lapsed && (ended ? facts.armed : move->private_kind == REST && !facts.stopping)) {
        (void)roburoc4_client_pause(client, now_us);
    }
    if (move->result == ROBUROC4_MOVE_TIMEOUT && facts.other_commander) {
        move->result = ROBUROC4_MOVE_OTHER_COMMANDER;
    }
    return move->result;
}

void roburoc4_move_cancel(roburoc4_move *move, roburoc4_client *client, uint64_t now_us) {
    if (move->result == ROBUROC4_MOVE_RUNNING) {
        end(move, ROBUROC4_MOVE_CANCELLED);
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
        "commands, speeds and pose disagree: check the odometry and what blocks or slips",
        "the robot was relocalized, or its pose jumped: begin again from its new pose",
        "at rest beside its goal: go on from here, slower",
        "a speed beyond the ceilings: ask for less, or raise max_linear_m_s or max_angular_rad_s",
        "the front bumper is not known: see role_index, or drive without by clearance 0",
        "the rear bumper is not known: see role_index, or drive without by clearance 0",
        "no fresh distance ahead: check the front telemeter, or drive without by clearance 0",
        "no fresh distance behind: check the rear telemeter, or drive without by clearance 0",
    };
    return result >= 0 && result < (int32_t)(sizeof texts / sizeof *texts) ? texts[result]
                                                                           : "unknown result";
}
