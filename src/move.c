/* SPDX-License-Identifier: MIT
 *
 * Moves: their legs, what they need to see, and how they end. move_axis.c knows which speed to
 * command, move_client.c asks the client.
 */
#include "move_axis.h"

/* Turn rate per heading error, and heading per distance from the line. */
#define STEER_1_S 0.4F
#define RETURN_PER_M 0.5F
#define RETURN_MAX_RAD 0.2F

/* A longer step means that the program was held up, so that nobody knows what was commanded. */
#define STEP_MAX_US 250000U
#define STILL_STATUSES 2
/* What private_rolls says: it moved at the beginning, or something stopped its wheels. */
enum { ROLLED = 1, INTERRUPTED };
/* A robot that is slow to begin shows this much later what it was told last. */
#define SHOWN_CYCLES 40
/* A robot that stands for so long, and was told nothing, is at rest, whatever was learned. */
#define STOOD_CYCLES 150
/* One that covers less in so long is held, or has no motor power. */
#define STUCK_M 0.002F
#define STUCK_US 4500000U
/* Nothing shorter has ever been a view. */
#define VIEW_SIZE_1_0 120
#define TWO_TURNS 12.57F
#define NO_TIMEOUT UINT32_MAX

/* Callers declare moves: their size is part of the ABI. */
typedef char assert_move_never_grows[sizeof(roburoc4_move) == 504 ? 1 : -1];

enum { AHEAD = 1, ASTERN = 2 };

static const float rest_speed[BOTH] = {0.03F, 0.06F};
static const float rolling_speed[BOTH] = {0.1F, 0.2F};
/* How far the three witnesses may disagree, besides a fifth of the way; and a pose may jump. */
static const float disagreement[BOTH] = {0.15F, 0.26F};
#define DISAGREEMENT_SHARE 0.2F
#define LAGGING_S 2.0F
/* Robots measure their pose at least so often. */
#define REPEATED_MOST_S 0.3F
/* A robot so far beside its line or arc, or so far turned from it, is off its course. */
#define STRAY_M 0.5F
#define STRAY_RAD 1.0F

/* ------------------------------------------------------------------------ arithmetic, no libm */

float roburoc4_move_half_turn(float angle_rad) {
    const float turns = angle_rad * (0.5F / PI_F);
    return beyond(turns, FAR_M)
               ? 0
               : angle_rad - 2 * PI_F * (float)(int32_t)(turns + with_sign(0.5F, turns));
}

/** Within 2e-4. */
static float sine_of(float angle_rad) {
    float x = roburoc4_move_half_turn(angle_rad);
    x = beyond(x, PI_F / 2) ? with_sign(PI_F, x) - x : x;
    const float xx = x * x;
    return x * (1 - xx / 6 * (1 - xx / 20 * (1 - xx / 42)));
}

/** Within 1e-5 rad. */
static float angle_of(float x, float y) {
    const float ax = magnitude(x), ay = magnitude(y);
    const bool steep = less(ax, ay);
    const float large = steep ? ay : ax;
    const float t = is_zero(large) ? 0 : (steep ? ax : ay) / large;
    const float tt = t * t;
    static const float terms[] = {0.0208351F, -0.0851330F, 0.1801410F, -0.3302995F, 0.9998660F};
    float angle = 0;
    for (uint32_t i = 0; i < sizeof terms / sizeof *terms; i++) {
        angle = angle * tt + terms[i];
    }
    angle *= t;
    angle = steep ? PI_F / 2 - angle : angle;
    angle = negative(x) ? PI_F - angle : angle;
    return with_sign(angle, y);
}

/* ---------------------------------------------------------------------------------- beginning */

const roburoc4_move_options roburoc4_move_defaults = {
    sizeof(roburoc4_move_options), 0, 0.3F, 0.5F, 0.5F, 1.0F, 0.5F, 0};

roburoc4_result roburoc4_move_options_init(roburoc4_move_options *options, size_t size) {
    if (!size_known(size, sizeof roburoc4_move_defaults)) {
        return ROBUROC4_ERR_SIZE;
    }
    memcpy(options, &roburoc4_move_defaults, size);
    options->size = (uint32_t)size;
    return ROBUROC4_OK;
}

/** Whether this can limit a speed or an acceleration. */
static bool limits(float most) {
    return is_finite(most) && positive(most);
}

static bool options_valid(const roburoc4_move_options *o) {
    return is_finite(o->clearance_m) && !negative(o->clearance_m) && limits(o->max_linear_m_s) &&
           limits(o->max_angular_rad_s) && limits(o->max_linear_m_s2) &&
           limits(o->max_angular_rad_s2);
}

/** Speeds beyond any RobuROC4, or degrees. */
static bool units_mistaken(const roburoc4_move *m) {
    const roburoc4_move_options *o = &m->private_options;
    const float length = m->private_goal[LENGTH], angle = m->private_goal[ANGLE];
    const bool speeds = m->private_kind == FOR;
    return beyond(speeds ? length : o->max_linear_m_s, ROBUROC4_MAX_DRIVE_M_S) ||
           beyond(speeds ? angle : o->max_angular_rad_s, ROBUROC4_MAX_DRIVE_RAD_S) ||
           (o->allow_turns == 0 && beyond(angle, TWO_TURNS));
}

static roburoc4_result checked(const roburoc4_move *m) {
    const float length = m->private_goal[LENGTH], angle = m->private_goal[ANGLE];
    if (!options_valid(&m->private_options)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    if (!is_finite(length) || !is_finite(angle)) {
        return ROBUROC4_ERR_NOT_FINITE;
    }
    if (m->private_kind != FOR && (beyond(length, FAR_M) || beyond(angle, FAR_M))) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    return units_mistaken(m) ? ROBUROC4_ERR_UNITS : ROBUROC4_OK;
}

/** Set up a move; if that fails, it has ended. */
static roburoc4_result begin(roburoc4_move *m, uint8_t kind, float length, float angle,
                             const roburoc4_move_options *options) {
    roburoc4_result result = ROBUROC4_ERR_SIZE;
    memset(m, 0, sizeof *m);
    m->private_kind = kind;
    m->private_options = roburoc4_move_defaults;
    m->private_goal[LENGTH] = length;
    m->private_goal[ANGLE] = angle;
    if (options == NULL || size_known(options->size, sizeof roburoc4_move_defaults)) {
        if (options != NULL) {
            memcpy(&m->private_options, options, options->size);
        }
        result = checked(m);
    }
    m->outcome = result < 0 ? ROBUROC4_MOVE_CANCELLED : ROBUROC4_MOVE_RUNNING;
    return result;
}

roburoc4_result roburoc4_move_by(roburoc4_move *m, float distance_m, float angle_rad,
                                 const roburoc4_move_options *options) {
    return begin(m, BY, distance_m, angle_rad, options);
}

roburoc4_result roburoc4_move_for(roburoc4_move *m, float linear_m_s, float angular_rad_s,
                                  uint32_t duration_ms, const roburoc4_move_options *options) {
    const roburoc4_result result = begin(m, FOR, linear_m_s, angular_rad_s, options);
    m->private_duration_ms = duration_ms;
    return result;
}

roburoc4_result roburoc4_move_rest(roburoc4_move *m, const roburoc4_move_options *options) {
    return begin(m, REST, 0, 0, options);
}

/* Positions are counted in 2^-16 m, and angles in 2^-16 rad: without arithmetic on doubles, which
 * small machines would need a kilobyte for. */

static int64_t fixed(double value) {
    const uint64_t bits = bits_from_f64(value);
    const int32_t down = 1075 - 16 - (int32_t)(bits >> 52 & 0x7FF);
    const uint64_t mantissa = (bits & 0xFFFFFFFFFFFFFU) | 0x10000000000000U;
    const int64_t size = down < 0    ? INT64_MAX / 2 /* farther than any planet */
                         : down < 64 ? (int64_t)(mantissa >> down)
                                     : 0;
    return bits >> 63 != 0 ? -size : size;
}

/** A difference of two of them; beyond 32 km it does not matter how far. */
static float unfixed(int64_t difference) {
    const int32_t near = (int32_t)difference;
    return near == difference ? (float)near * (1 / 65536.0F) : 1e9F;
}

static roburoc4_result begin_to(roburoc4_move *m, uint8_t kind, double x_m, double y_m,
                                double theta_rad, const roburoc4_move_options *options) {
    const double place[] = {x_m, y_m, theta_rad};
    int64_t goal[3];
    float no_number = 0;
    for (uint32_t i = 0; i < 3; i++) {
        no_number += finite_f64_bits(bits_from_f64(place[i])) ? 0 : f32_from_bits(F32_NAN);
        goal[i] = fixed(place[i]);
    }
    const roburoc4_result result = begin(m, kind, no_number, unfixed(goal[2]), options);
    memcpy(m->private_place, goal, sizeof goal);
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

/* ------------------------------------------------------------------------------------ the legs */

/** To a point or a pose. */
static bool to_place(const roburoc4_move *m) {
    return m->private_kind == TO_POINT || m->private_kind == TO_POSE;
}

/** No speed is proposed. */
static bool halted(const roburoc4_move *m) {
    return is_zero(m->linear_m_s) && is_zero(m->angular_rad_s);
}

/** The present leg is a line or an arc; a move for a time has no path to keep to. */
static bool on_path(const roburoc4_move *m) {
    return m->private_kind != FOR && roburoc4_move_axis(m) == LENGTH;
}

/** Count from here. */
static void forget_way(roburoc4_move *m) {
    for (uint32_t axis = 0; axis < BOTH; axis++) {
        m->private_covered[axis] = m->private_by_speeds[axis] = 0;
        m->private_commanded[axis] = m->private_lagging[axis] = 0;
    }
    m->private_aside_m = m->private_mark = 0;
    m->private_stood_us = 0;
}

/** Begin a leg of this length, counted from here; the robot is at rest. */
static void start_leg(roburoc4_move *m, float distance_m, float angle_rad) {
    m->private_goal[LENGTH] = distance_m;
    m->private_goal[ANGLE] = angle_rad;
    m->private_asked[LENGTH] = m->private_asked[ANGLE] = 0;
    forget_way(m);
    roburoc4_move_axis_begin(m);
}

/** Distance to the place, and its bearing from ahead. */
static float look_to(const roburoc4_move *m, float *bearing_rad) {
    const float x = unfixed(m->private_place[0] - m->private_pose[0]);
    const float y = unfixed(m->private_place[1] - m->private_pose[1]);
    *bearing_rad = m->private_per_pose[ANGLE] *
                   roburoc4_move_half_turn(angle_of(x, y) - unfixed(m->private_pose[2]));
    return m->private_per_pose[LENGTH] * roburoc4_move_root(x * x + y * y);
}

/** To a place: a turn, a line, a turn, each from where the robot is. */
static bool next_leg_to_place(roburoc4_move *m, uint8_t leg) {
    float bearing_rad = 0;
    const float distance_m = look_to(m, &bearing_rad);
    if (leg < 2 && beyond(distance_m, 0.01F)) {
        start_leg(m, leg == 0 ? 0 : distance_m, leg == 0 ? bearing_rad : 0);
        if (leg == 1) {
            m->private_covered[ANGLE] = m->private_by_speeds[ANGLE] = -bearing_rad;
            m->private_commanded[ANGLE] = m->private_lagging[ANGLE] = -bearing_rad;
        }
        return true;
    }
    m->private_leg = 3;
    if (m->private_kind == TO_POINT || leg > 2) {
        return false;
    }
    const float left_rad =
        roburoc4_move_half_turn(unfixed(m->private_place[2] - m->private_pose[2]));
    start_leg(m, 0, m->private_per_pose[ANGLE] * left_rad);
    return true;
}

/** Begin the next leg; false after the last one. */
static bool next_leg(roburoc4_move *m) {
    const float left_rad = roburoc4_move_left(m, ANGLE);
    const uint8_t leg = m->private_leg++;
    if (to_place(m)) {
        return next_leg_to_place(m, leg);
    }
    if (m->private_kind != BY || (leg != 0 && !(on_path(m) && beyond(left_rad, 0.0175F)))) {
        return false;
    }
    start_leg(m, leg == 0 ? m->private_goal[LENGTH] : 0, left_rad);
    return true;
}

/** The curvature of the present leg. */
static float curvature(const roburoc4_move *m) {
    return on_path(m) ? m->private_goal[ANGLE] / m->private_goal[LENGTH] : 0;
}

/** By how much the robot is turned to the left of its line or arc. */
static float astray(const roburoc4_move *m) {
    return m->private_covered[ANGLE] - curvature(m) * m->private_covered[LENGTH];
}

/** A robot beside its line or arc, or turned from it, comes along so many times as far as it
 * drives; else 1. */
static float stretch_of(const roburoc4_move *m) {
    return on_path(m) ? sine_of(astray(m) + PI_F / 2) /
                            (1 - within(curvature(m) * m->private_aside_m, 0.5F))
                      : 1;
}

/** Not more than the robot's own limit, where that is known. */
static float at_most_own(float value, float own) {
    return limits(own) ? lesser(value, own) : value;
}

/** Speeds and accelerations: the requested ones, limited to the robot's own. Returns how long their
 * profiles take. */
static float set_profile(roburoc4_move *m, const roburoc4_move_view *v) {
    const roburoc4_move_options *o = &m->private_options;
    float *limit = m->private_limit, *slope = m->private_slope;
    float path[BOTH] = {m->private_goal[LENGTH], m->private_goal[ANGLE]};
    limit[LENGTH] = at_most_own(o->max_linear_m_s, v->max_linear_m_s);
    limit[ANGLE] = at_most_own(o->max_angular_rad_s, v->max_angular_rad_s);
    slope[LENGTH] = at_most_own(o->max_linear_m_s2, v->max_linear_m_s2);
    slope[ANGLE] = at_most_own(o->max_angular_rad_s2, v->max_angular_rad_s2);
    if (to_place(m)) {
        path[LENGTH] = look_to(m, &path[ANGLE]);
        const float last = unfixed(m->private_place[2] - m->private_pose[2]) - path[ANGLE];
        path[ANGLE] = magnitude(path[ANGLE]) +
                      (m->private_kind == TO_POSE ? magnitude(roburoc4_move_half_turn(last)) : 0);
    } else if (!is_zero(curvature(m))) {
        const float bend = magnitude(curvature(m));
        limit[LENGTH] = lesser(limit[LENGTH], limit[ANGLE] / bend);
        slope[LENGTH] = lesser(slope[LENGTH], slope[ANGLE] / bend);
        path[ANGLE] = 0; /* an arc turns on its way */
    }
    return roburoc4_move_axis_seconds(m, LENGTH, path[LENGTH]) +
           roburoc4_move_axis_seconds(m, ANGLE, path[ANGLE]);
}

/** The speeds of a move for a time, in their proportion, within the robot's own limits. */
static void obey_own_limits(roburoc4_move *m, const roburoc4_move_view *v) {
    const float own[BOTH] = {v->max_linear_m_s, v->max_angular_rad_s};
    float share = 1;
    for (uint32_t i = 0; i < BOTH; i++) {
        const float speed = magnitude(m->private_goal[i]);
        share = is_zero(speed) ? share : lesser(share, at_most_own(speed, own[i]) / speed);
    }
    m->private_goal[LENGTH] *= share;
    m->private_goal[ANGLE] *= share;
}

/** Twice the time of the profile, and 3 s. */
static uint32_t timeout_ms(const roburoc4_move *m, float profile_s) {
    const float seconds =
        m->private_kind == FOR ? 1000 * seconds_of(m->private_duration_ms) : profile_s;
    return m->private_options.timeout_ms != 0 ? m->private_options.timeout_ms
           : m->private_kind == REST          ? 5000
           : beyond(seconds, 1e6F)            ? NO_TIMEOUT
                                              : 3000 + (uint32_t)(int32_t)(2000 * seconds);
}

/* ------------------------------------------------------------------------------------ odometry */

/** Robot time since the last status; 0 for the first, and after a restart. */
static uint32_t cycles_from(uint64_t before, uint64_t now) {
    return before == 0 || now - before > 1000 ? 0 : (uint32_t)(now - before);
}

static float seconds_in(uint32_t cycles) {
    return (float)(int32_t)cycles * 0.01F;
}

/** Count a distance and an angle; `across_m` is to the left. */
static void cover(roburoc4_move *m, float distance_m, float across_m, float angle_rad) {
    const float along_m = distance_m * stretch_of(m);
    const float half_turned = 0.5F * (angle_rad - curvature(m) * along_m);
    m->private_aside_m += distance_m * sine_of(astray(m) + half_turned) + across_m;
    m->private_covered[LENGTH] += along_m;
    m->private_covered[ANGLE] += angle_rad;
    m->distance_m += distance_m;
    m->angle_rad += angle_rad;
}

/** The shortest time between two poses lately, as a program may subscribe less often meanwhile. */
static void note_gap(roburoc4_move *m, uint32_t passed) {
    if (passed > m->private_pose_gap) {
        m->private_pose_gap = count_on(m->private_pose_gap, 1);
    } else if (passed != 0) {
        m->private_pose_gap = (uint8_t)passed;
    }
}

/** Real metres or radians per reported one. */
static float per_count(float scale) {
    return is_zero(scale) ? 1 : 1 / scale;
}

/** How far a pose may be from the last one: what may be commanded at any moment, and what the robot
 * drove while the pose was repeated. */
static float explained(const roburoc4_move *m, uint32_t axis, float passed_s) {
    const float speed = magnitude(m->private_speed[axis]);
    const float repeated_s = lesser(seconds_in(m->private_pose_same), REPEATED_MOST_S);
    return disagreement[axis] +
           1.5F * (passed_s * (m->private_limit[axis] + speed) + repeated_s * speed);
}

/** Follow the pose, and say what is new in it; false if it jumped by more than any speed explains.
 */
static bool note_pose(roburoc4_move *m, const roburoc4_move_view *v, roburoc4_move_news *news) {
    const uint32_t passed = cycles_from(m->private_pose_cycles, v->pose_cycles);
    const float passed_s = seconds_in(passed);
    const int64_t pose[] = {fixed(v->x_m), fixed(v->y_m), fixed(v->theta_rad)};
    /* An external localizer may begin, or fall silent. */
    m->private_per_pose[LENGTH] = v->pose_external != 0 ? 1 : per_count(v->scale_linear);
    m->private_per_pose[ANGLE] = v->pose_external != 0 ? 1 : per_count(v->scale_angular);
    if (m->private_posed) {
        const float x = unfixed(pose[0] - m->private_pose[0]);
        const float y = unfixed(pose[1] - m->private_pose[1]);
        const float turned = roburoc4_move_half_turn(unfixed(pose[2] - m->private_pose[2]));
        const float heading = unfixed(m->private_pose[2]) + 0.5F * turned;
        const float ahead = sine_of(heading + PI_F / 2), left = sine_of(heading);
        const float distance_m = (x * ahead + y * left) * m->private_per_pose[LENGTH];
        const float across_m = (y * ahead - x * left) * m->private_per_pose[LENGTH];
        const float angle_rad = turned * m->private_per_pose[ANGLE];
        const float most_m = explained(m, LENGTH, passed_s);
        if (beyond(distance_m, most_m) || beyond(across_m, most_m) ||
            beyond(angle_rad, explained(m, ANGLE, passed_s))) {
            return false;
        }
        cover(m, distance_m, across_m, angle_rad);
    }
    const bool repeated = memcmp(pose, m->private_pose, sizeof pose) == 0;
    news->prompt = !repeated && passed <= m->private_pose_gap + 1U;
    news->ahead_s = seconds_in((uint32_t)(v->pose_cycles - m->private_speed_cycles));
    note_gap(m, passed);
    m->private_pose_same = repeated ? count_on(m->private_pose_same, passed) : 0;
    m->private_pose_cycles = v->pose_cycles;
    memcpy(m->private_pose, pose, sizeof pose);
    return true;
}

/** The last status shows a robot that moves. */
static bool is_moving(const roburoc4_move *m) {
    return beyond(m->private_speed[LENGTH], rest_speed[LENGTH]) ||
           beyond(m->private_speed[ANGLE], rest_speed[ANGLE]);
}

/** How long the robot has stood; a single speed may be noise. */
static void note_standing(roburoc4_move *m, uint32_t passed) {
    const uint8_t stood = m->private_stood_cycles;
    m->private_stood_cycles = !is_moving(m)        ? count_on(stood, passed)
                              : stood > 2 * passed ? (uint8_t)(stood - 2 * passed)
                                                   : 0;
}

/** A differential status: add the distance since the last one. */
static void note_speeds(roburoc4_move *m, const roburoc4_move_view *v, const float *stretch) {
    const float speeds[BOTH] = {v->linear_m_s, v->angular_rad_s};
    const uint32_t passed = cycles_from(m->private_speed_cycles, v->speed_cycles);
    const float passed_s = seconds_in(passed);
    float covered[BOTH];
    m->private_quiet_cycles = count_on(m->private_quiet_cycles, passed);
    const bool measured = is_finite(speeds[LENGTH]) && is_finite(speeds[ANGLE]);
    for (uint32_t axis = 0; axis < BOTH; axis++) {
        const float speed = is_finite(speeds[axis]) ? speeds[axis] : 0;
        covered[axis] = 0.5F * (speed + m->private_speed[axis]) * passed_s;
        m->private_by_speeds[axis] += covered[axis] * stretch[axis];
        m->private_speed[axis] = speed;
    }
    m->private_unmeasured = !measured;
    note_standing(m, passed);
    m->private_still = measured && !is_moving(m) ? count_on(m->private_still, 1) : 0;
    m->private_speed_cycles = v->speed_cycles;
    if (!m->private_posed) {
        cover(m, covered[LENGTH], 0, covered[ANGLE]);
    }
}

/** Time passed, in which this was commanded. */
static void note_commands(roburoc4_move *m, const roburoc4_move_view *v, const float *stretch,
                          float passed_s) {
    const float sent[BOTH] = {v->sent_linear_m_s, v->sent_angular_rad_s};
    for (uint32_t i = 0; i < BOTH; i++) {
        const float commanded = passed_s * sent[i] * stretch[i];
        m->private_commanded[i] += commanded;
        m->private_asked[i] += is_moving(m) ? commanded : 0;
        m->private_lagging[i] +=
            passed_s / LAGGING_S * (m->private_commanded[i] - m->private_lagging[i]);
    }
}

/** The first pose: what is covered is carried on to its time. */
static void begin_with_pose(roburoc4_move *m, const roburoc4_move_view *v) {
    roburoc4_move_news first = {0};
    (void)note_pose(m, v, &first);
    cover(m, first.ahead_s * m->private_speed[LENGTH], 0, first.ahead_s * m->private_speed[ANGLE]);
    m->private_posed = 1;
    m->private_pose_gap = UINT8_MAX;
}

/** What is new of the pose; false if it jumped. */
static bool take_pose(roburoc4_move *m, const roburoc4_move_view *v, roburoc4_move_news *news,
                      uint64_t now_us) {
    if (!m->private_posed) {
        m->private_pose_us = now_us;
        news->prompt = news->speeds;
        if (v->pose_cycles != 0 && m->private_kind != REST) {
            begin_with_pose(m, v);
        }
        return true;
    }
    const bool pose = v->pose_cycles != 0 && v->pose_cycles != m->private_pose_cycles;
    if (pose) {
        m->private_pose_us = now_us;
    }
    return v->relocalized == m->private_relocalized && (!pose || note_pose(m, v, news));
}

/** Take what is new in the view, and note when it arrived; false if the pose jumped. */
static bool note_view(roburoc4_move *m, const roburoc4_move_view *v, uint32_t passed_us,
                      uint64_t now_us) {
    const float passed_s = seconds_of(passed_us);
    const float stretch[BOTH] = {stretch_of(m), 1};
    roburoc4_move_news news = {v->speed_cycles != m->private_speed_cycles, false, 0, 1};
    note_commands(m, v, stretch, passed_s);
    if (news.speeds) {
        note_speeds(m, v, stretch);
        m->private_heard_us = now_us;
    }
    if (!take_pose(m, v, &news, now_us)) {
        return false;
    }
    const float late_s = seconds_of(now_us - m->private_heard_us);
    news.stretch = stretch_of(m);
    if (roburoc4_move_axis_learn(m, passed_s, late_s, news) && has_goal(m) && !m->private_rolls) {
        m->private_rolls = INTERRUPTED;
    }
    return true;
}

/* ------------------------------------------------------------------------------- reasons to end */

/** The direction in which the robot moves, or is about to: a speed against its own only brakes. */
static uint8_t direction(const roburoc4_move *m) {
    const float goal = to_place(m) ? 1 : m->private_goal[LENGTH];
    const float next = m->private_ready ? m->linear_m_s : goal;
    const float speed = m->private_speed[LENGTH];
    const float way = beyond(speed, 0.05F) ? speed : next;
    return is_zero(way) ? 0 : negative(way) ? ASTERN : AHEAD;
}

/** A bumper on one of these sides is pressed, or another was pressed during the move. */
static bool touches(roburoc4_move *m, const roburoc4_move_view *v, uint8_t sides) {
    const uint8_t pressed[] = {v->front_bumper, v->rear_bumper};
    bool touched = false;
    for (uint32_t i = 0; i < 2; i++) {
        const uint8_t side = (uint8_t)(AHEAD << i);
        if (!pressed[i]) {
            m->private_bumpers &= (uint8_t)~side; /* those pressed since the beginning */
        } else {
            touched = touched || ((sides | ~m->private_bumpers) & side) != 0;
        }
    }
    return touched;
}

/** What is in the way; or what a move with a clearance needs and does not see. The robot still
 * covers what was commanded and not covered yet, and has covered something since the distances were
 * measured. */
static int32_t blocked(roburoc4_move *m, const roburoc4_move_view *v) {
    const float clearance_m = m->private_options.clearance_m;
    const float speed = magnitude(m->private_speed[LENGTH]);
    const float brakes_m = limits(v->max_linear_m_s2) /* as hard as the robot may */
                               ? 0.5F * speed * speed / v->max_linear_m_s2
                               : 0;
    const float needed_m = clearance_m + roburoc4_move_axis_rolls(m, stretch_of(m)) + brakes_m +
                           speed * seconds_of(v->distance_age_us);
    const uint8_t bumper_known[] = {v->front_bumper_known, v->rear_bumper_known};
    const uint8_t known[] = {v->front_known, v->rear_known};
    const float distances_m[] = {v->front_m, v->rear_m};
    const uint8_t sides = direction(m);
    if (touches(m, v, sides)) {
        return ROBUROC4_MOVE_BUMPER;
    }
    for (int32_t i = 0; i < 2 && !is_zero(clearance_m); i++) {
        if (!bumper_known[i]) {
            return ROBUROC4_MOVE_NO_FRONT_BUMPER + i;
        }
        if (sides >> i & 1) {
            if (!known[i] || v->distance_age_us > SILENCE_US) {
                return ROBUROC4_MOVE_NO_FRONT_TELEMETER + i;
            }
            if (m->private_ready && less(nearer(FAR_M, distances_m[i]), needed_m)) {
                return ROBUROC4_MOVE_OBSTACLE;
            }
        }
    }
    return ROBUROC4_MOVE_RUNNING;
}

/** Whether a distance is beyond one of two others by more than may be. */
static bool disagree(uint32_t axis, float distance, float a, float b) {
    const float way = beyond(a, magnitude(distance)) ? magnitude(a) : magnitude(distance);
    const float most = disagreement[axis] + DISAGREEMENT_SHARE * way;
    const float low = lesser(a, b), high = a + b - low;
    return less(high + most, distance) || less(distance, low - most);
}

/** The three witnesses: what was commanded, what the speeds say, what the pose says. The robot is
 * between what was commanded and what it follows: as late as robots may be, or at once. */
static bool witnesses_disagree(const roburoc4_move *m, const float *follows) {
    for (uint32_t axis = 0; axis < BOTH; axis++) {
        const float speeds = m->private_by_speeds[axis], covered = m->private_covered[axis];
        const float commanded = m->private_commanded[axis];
        if (disagree(axis, covered, speeds, speeds) ||
            (!m->private_rolls && (disagree(axis, speeds, commanded, follows[axis]) ||
                                   disagree(axis, covered, commanded, follows[axis])))) {
            return true;
        }
    }
    return false;
}

/** However late a robot follows, reaching its goal takes no commands far beyond it. Where it seems
 * to, the robot hardly moves, or its odometry counts too little; then what was commanded before
 * something held the wheels counts, too. */
static bool commands_too_much(const roburoc4_move *m) {
    const uint32_t axis = roburoc4_move_axis(m);
    return has_goal(m) && !m->private_rolls &&
           (disagree(axis, m->private_commanded[axis], m->private_goal[axis], 0) ||
            disagree(axis, m->private_asked[axis], m->private_goal[axis], 0));
}

/** So far from its line or arc that it would hardly find back: it does not turn as it drives. */
static bool strays(const roburoc4_move *m) {
    return !m->private_rolls && on_path(m) &&
           (beyond(m->private_aside_m, STRAY_M) || beyond(astray(m), STRAY_RAD));
}

static int32_t outcome_of(roburoc4_result cause) {
    static const int8_t outcomes[][2] = {
        {ROBUROC4_ERR_OVERRIDE, ROBUROC4_MOVE_OVERRIDE},
        {ROBUROC4_ERR_OVERRIDE_UNKNOWN, ROBUROC4_MOVE_OVERRIDE},
        {ROBUROC4_ERR_OTHER_COMMANDER, ROBUROC4_MOVE_OTHER_COMMANDER},
        {ROBUROC4_ERR_INHIBITED, ROBUROC4_MOVE_INHIBITED},
        {ROBUROC4_ERR_LAPSED, ROBUROC4_MOVE_LAPSED},
        {ROBUROC4_ERR_DISARMED, ROBUROC4_MOVE_CANCELLED},
        {ROBUROC4_ERR_STOP_CALLED, ROBUROC4_MOVE_CANCELLED}};
    for (uint32_t i = 0; i < sizeof outcomes / sizeof *outcomes; i++) {
        if (outcomes[i][0] == cause) {
            return outcomes[i][1];
        }
    }
    return ROBUROC4_MOVE_LOST;
}

/** At rest, however late it follows. */
static bool rests(const roburoc4_move *m) {
    return m->private_still >= STILL_STATUSES && m->private_quiet_cycles >= SHOWN_CYCLES;
}

/** Whether the robot has stood for so long that nobody nearby expects it to go on. One that stands
 * and was told nothing is learned anew before. */
static bool stuck(roburoc4_move *m, uint32_t passed_us) {
    const float covered = m->private_covered[roburoc4_move_axis(m)];
    if (beyond(covered - m->private_mark, STUCK_M)) {
        m->private_mark = covered;
        m->private_stood_us = 0;
    }
    m->private_stood_us += passed_us;
    if (m->private_quiet_cycles >= STOOD_CYCLES && m->private_stood_cycles >= STOOD_CYCLES) {
        m->private_stood_cycles = 0;
        roburoc4_move_axis_again(m);
    }
    return m->private_stood_us > STUCK_US;
}

/** Why a planned move cannot go on. */
static int32_t hindered(roburoc4_move *m, const roburoc4_move_view *v, uint32_t passed_us,
                        uint64_t now_us) {
    const int32_t seen = blocked(m, v);
    return seen != ROBUROC4_MOVE_RUNNING        ? seen
           : has_goal(m) && stuck(m, passed_us) ? ROBUROC4_MOVE_INHIBITED
           : strays(m)                          ? ROBUROC4_MOVE_OFF_COURSE
           : !witnesses_disagree(m, m->private_lagging) && !commands_too_much(m)
               ? ROBUROC4_MOVE_RUNNING
           : now_us - m->private_pose_us > SILENCE_US / 3 ? ROBUROC4_MOVE_LOST
           : m->private_stood_cycles > STOOD_CYCLES / 3   ? ROBUROC4_MOVE_INHIBITED
                                                          : ROBUROC4_MOVE_ODOMETRY;
}

/** What the client says against it. */
static int32_t refused(roburoc4_move *m, const roburoc4_move_view *v) {
    const bool rest = m->private_kind == REST;
    if (v->overridden && (v->armed || rest)) {
        return ROBUROC4_MOVE_OVERRIDE;
    }
    if (rest || (v->armed && !v->inhibited)) {
        return ROBUROC4_MOVE_RUNNING;
    }
    m->cause = v->armed ? ROBUROC4_OK : v->disarm_cause;
    return v->inhibited ? ROBUROC4_MOVE_INHIBITED : outcome_of(m->cause);
}

/** Reasons to end the move, whether it has arrived or not. */
static int32_t reason_to_end(roburoc4_move *m, const roburoc4_move_view *v, uint32_t passed_us,
                             uint64_t now_us) {
    int32_t outcome = refused(m, v);
    if (outcome == ROBUROC4_MOVE_RUNNING && m->private_ready && m->private_kind != REST) {
        outcome = hindered(m, v, passed_us, now_us);
    }
    return outcome != ROBUROC4_MOVE_RUNNING ? outcome
           : now_us - m->private_heard_us > SILENCE_US || now_us - m->private_pose_us > SILENCE_US
               ? ROBUROC4_MOVE_LOST
           : m->private_timeout_ms != NO_TIMEOUT &&
                   now_us - m->private_begun_us >= (uint64_t)m->private_timeout_ms * 1000U
               ? ROBUROC4_MOVE_TIMEOUT
               : ROBUROC4_MOVE_RUNNING;
}

/* ----------------------------------------------------------------------------------- the speed */

/** Whether the robot stands beside the goal of its line or arc, and no leg corrects that. */
static bool off_course(const roburoc4_move *m) {
    return on_path(m) &&
           beyond(m->private_aside_m, 0.02F + 0.01F * magnitude(m->private_goal[LENGTH]));
}

/** The turn rate that keeps the robot on its line. */
static float steer(const roburoc4_move *m) {
    const float bend = curvature(m);
    const float back = within(RETURN_PER_M * m->private_aside_m, RETURN_MAX_RAD);
    const float heading = bend * m->private_covered[LENGTH] - m->private_covered[ANGLE] -
                          with_sign(back, m->linear_m_s);
    return is_zero(m->linear_m_s)
               ? 0
               : within(bend * m->linear_m_s + STEER_1_S * heading, m->private_limit[ANGLE]);
}

/** The share of its speeds that a move for a time has now: up, along and down again in time. */
static float share_for(roburoc4_move *m, float passed_s, uint64_t now_us) {
    if (m->private_first_us == 0 && positive(passed_s)) {
        m->private_first_us = now_us;
    }
    const uint64_t end_us = m->private_first_us + (uint64_t)m->private_duration_ms * 1000U;
    const float left_s = now_us < end_us ? seconds_of(end_us - now_us) : 0;
    float slope = FAR_M;
    for (uint32_t axis = 0; axis < BOTH; axis++) {
        const float speed = magnitude(m->private_goal[axis]);
        slope = is_zero(speed) ? slope : lesser(slope, m->private_slope[axis] / speed);
    }
    return lesser(lesser(1, slope * left_s), m->private_share + slope * passed_s);
}

/** Ramp down a robot that moved when the move began, so that its first leg begins at rest; or whose
 * wheels something stopped, so that what it does then says nothing about it. */
static bool rolls(roburoc4_move *m, uint64_t now_us) {
    if (m->private_rolls == ROLLED && !halted(m)) {
        m->private_begun_us = now_us; /* it may take as long as it takes */
    }
    if (m->private_rolls && rests(m)) {
        if (m->private_rolls == INTERRUPTED) {
            for (uint32_t axis = 0; axis < BOTH; axis++) { /* nobody followed the rest */
                m->private_commanded[axis] = m->private_lagging[axis] = m->private_by_speeds[axis];
            }
            roburoc4_move_axis_again(m);
        } else {
            m->private_begun_us = now_us;
            forget_way(m);
            if (m->private_kind == FOR) {
                roburoc4_move_axis_begin(m);
            } else {
                m->private_leg = 0;
                (void)next_leg(m);
            }
        }
        m->private_rolls = 0;
    }
    return m->private_rolls;
}

static void propose(roburoc4_move *m, float passed_s, uint64_t now_us) {
    float *speed[BOTH] = {&m->linear_m_s, &m->angular_rad_s};
    float wanted[BOTH] = {0, 0};
    const bool waits = rolls(m, now_us);
    if (!waits && m->private_kind == FOR) {
        m->private_share = share_for(m, passed_s, now_us);
    } else if (!waits) {
        wanted[ANGLE] = steer(m);
        wanted[roburoc4_move_axis(m)] = roburoc4_move_axis_speed(m);
    }
    for (uint32_t i = 0; i < BOTH; i++) {
        *speed[i] = !waits && m->private_kind == FOR
                        ? m->private_share * m->private_goal[i]
                        : *speed[i] + within(wanted[i] - *speed[i], m->private_slope[i] * passed_s);
    }
    if (!halted(m)) {
        m->private_quiet_cycles = 0;
    }
}

/** At the goal of the leg, and about to stay there. */
static bool arrived(const roburoc4_move *m) {
    return halted(m) && !m->private_unmeasured &&
           (has_goal(m) ? !m->private_rolls && roburoc4_move_axis_arrived(m)
                        : rests(m) && (m->private_kind == REST || m->private_first_us != 0));
}

/* ------------------------------------------------------------------------------------ one step */

/** How much of a command the robot follows already; nothing if one of them is no number. */
static float followed(float sent, float speed) {
    const bool along = negative(sent) == negative(speed);
    return is_finite(sent) && is_finite(speed) && along
               ? with_sign(lesser(magnitude(sent), magnitude(speed)), sent)
               : 0;
}

/** The first step. */
static void open_move(roburoc4_move *m, uint64_t now_us) {
    m->private_begun = 1;
    m->private_begun_us = m->private_step_us = now_us;
    m->private_heard_us = m->private_pose_us = now_us;
    m->private_timeout_ms = NO_TIMEOUT;
    m->private_bumpers = AHEAD | ASTERN;
}

/** What is not known yet that it needs: an outcome, LOST for statuses; else RUNNING. */
static int32_t lacks(roburoc4_move *m, const roburoc4_move_view *v) {
    const int32_t unseen = m->private_kind == REST ? ROBUROC4_MOVE_RUNNING : blocked(m, v);
    return unseen == ROBUROC4_MOVE_RUNNING &&
                   (v->speed_cycles == 0 || (to_place(m) && v->pose_cycles == 0))
               ? ROBUROC4_MOVE_LOST
               : unseen;
}

/** Where it begins, and how fast. */
static void note_start(roburoc4_move *m, const roburoc4_move_view *v, uint64_t now_us) {
    const bool rest = m->private_kind == REST;
    if (!rest) { /* a command that the robot has not followed yet is taken back at once */
        m->linear_m_s = followed(v->sent_linear_m_s, v->linear_m_s);
        m->angular_rad_s = followed(v->sent_angular_rad_s, v->angular_rad_s);
    }
    m->private_rolls = !is_zero(v->sent_linear_m_s) || !is_zero(v->sent_angular_rad_s) ||
                       beyond(v->linear_m_s, rolling_speed[LENGTH]) ||
                       beyond(v->angular_rad_s, rolling_speed[ANGLE]);
    m->private_relocalized = v->relocalized;
    m->private_step_us = m->private_pose_us = now_us;
    if (v->pose_cycles != 0 && !rest) {
        begin_with_pose(m, v);
    }
}

/** Plan the move as soon as everything that it needs is known, or after a second end it with what
 * is missing. */
static int32_t plan(roburoc4_move *m, const roburoc4_move_view *v, uint64_t now_us) {
    if (!m->private_begun) {
        open_move(m, now_us);
        if (!v->armed &&
            m->private_kind != REST) { /* whatever disarmed it, this move did not drive */
            m->cause = v->disarm_cause;
            return ROBUROC4_MOVE_CANCELLED;
        }
    }
    const int32_t lacking = lacks(m, v);
    if (lacking != ROBUROC4_MOVE_RUNNING) {
        return now_us - m->private_begun_us <= SILENCE_US ? ROBUROC4_MOVE_RUNNING : lacking;
    }
    note_start(m, v, now_us);
    if (m->private_kind == FOR) {
        obey_own_limits(m, v);
    }
    const float profile_s = set_profile(m, v);
    if (to_place(m) && beyond(profile_s, FAR_M / m->private_limit[LENGTH])) {
        m->cause = ROBUROC4_ERR_ARGUMENT;
        return ROBUROC4_MOVE_CANCELLED;
    }
    m->private_timeout_ms = timeout_ms(m, profile_s);
    m->private_ready = 1;
    roburoc4_move_axis_begin(m);
    (void)next_leg(m);
    return ROBUROC4_MOVE_RUNNING;
}

void roburoc4_move_hold(roburoc4_move *m) {
    m->linear_m_s = m->angular_rad_s = m->private_share = 0;
    m->private_first_us = 0;
    m->private_stood_us = 0;
}

int32_t roburoc4_move_end(roburoc4_move *m, int32_t outcome) {
    m->outcome = outcome;
    m->linear_m_s = 0;
    m->angular_rad_s = 0;
    return outcome;
}

/** The leg is at its end: the outcome, or RUNNING if there is another one. */
static int32_t end_leg(roburoc4_move *m) {
    return has_goal(m) && witnesses_disagree(m, m->private_commanded) ? ROBUROC4_MOVE_ODOMETRY
           : off_course(m)                                            ? ROBUROC4_MOVE_OFF_COURSE
           : next_leg(m)                                              ? ROBUROC4_MOVE_RUNNING
                                                                      : ROBUROC4_MOVE_REACHED;
}

/** Propose the next speeds; the outcome if it has arrived. */
static int32_t drive_on(roburoc4_move *m, float passed_s, uint64_t now_us) {
    if (m->private_kind != REST) {
        propose(m, passed_s, now_us);
    }
    return arrived(m) ? end_leg(m) : ROBUROC4_MOVE_RUNNING;
}

/** The robot's odometry is off by the factors that scale its commands: make what it reports real
 * metres and radians. */
static void make_real(roburoc4_move_view *v) {
    const float length = per_count(v->scale_linear), angle = per_count(v->scale_angular);
    v->linear_m_s *= length;
    v->max_linear_m_s *= length;
    v->max_linear_m_s2 *= length;
    v->angular_rad_s *= angle;
    v->max_angular_rad_s *= angle;
    v->max_angular_rad_s2 *= angle;
}

int32_t roburoc4_move_advance(roburoc4_move *m, roburoc4_move_view *v, uint64_t now_us) {
    make_real(v);
    int32_t outcome = m->private_ready ? ROBUROC4_MOVE_RUNNING : plan(m, v, now_us);
    const uint64_t passed = now_us - m->private_step_us;
    const uint32_t passed_us = passed > STEP_MAX_US ? 0 : (uint32_t)passed;
    const bool ready = m->private_ready != 0;
    if (outcome == ROBUROC4_MOVE_RUNNING && ready && !note_view(m, v, passed_us, now_us)) {
        outcome = ROBUROC4_MOVE_RELOCALIZED;
    }
    m->private_step_us = now_us;
    if (outcome == ROBUROC4_MOVE_RUNNING) {
        outcome = reason_to_end(m, v, passed_us, now_us);
    }
    if (m->private_kind != FOR) {
        m->remaining_m = roburoc4_move_left(m, LENGTH);
        m->remaining_rad = roburoc4_move_left(m, ANGLE);
    }
    if (outcome == ROBUROC4_MOVE_RUNNING && ready) {
        outcome = drive_on(m, seconds_of(passed_us), now_us);
    }
    return outcome == ROBUROC4_MOVE_RUNNING ? outcome : roburoc4_move_end(m, outcome);
}

/** 0, or within the range of roburoc4_config. */
static bool is_scale(float scale) {
    return is_zero(scale) || between(scale, 0.01F, 10);
}

int32_t roburoc4_move_step_view(roburoc4_move *move, const roburoc4_move_view *view,
                                uint64_t now_us) {
    if (move->outcome != ROBUROC4_MOVE_RUNNING) {
        return move->outcome;
    }
    roburoc4_move_view known = {0}; /* the view of an older program lacks the last fields */
    if (view->size < VIEW_SIZE_1_0 || !size_known(view->size, sizeof known)) {
        move->cause = ROBUROC4_ERR_SIZE;
        return roburoc4_move_end(move, ROBUROC4_MOVE_CANCELLED);
    }
    memcpy(&known, view, view->size);
    if (!is_scale(known.scale_linear) || !is_scale(known.scale_angular)) {
        move->cause = ROBUROC4_ERR_ARGUMENT;
        return roburoc4_move_end(move, ROBUROC4_MOVE_CANCELLED);
    }
    return roburoc4_move_advance(move, &known, now_us);
}
