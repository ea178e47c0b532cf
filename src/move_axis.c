/* SPDX-License-Identifier: MIT
 *
 * The control of one axis: which speed to command so that a robot comes to rest at its goal, if
 * nobody knows how late and how far it follows.
 *
 * When a robot is at rest again it has covered `gain` times the distance that was commanded,
 * however late it followed. So what is left to command is the goal divided by the gain, less what
 * was commanded; a loop closed on that has no lag. The gain has to be learned while the robot still
 * accelerates. A robot of second order with a dead time obeys
 *
 *     covered + lag * speed + bend * acceleration = gain * commanded - delay * sent + offset
 *
 * Both sides are smoothed by the same filter, once, twice and three times. Speed and acceleration
 * are differences of these: no measurement is differentiated, and the noise of the reported speeds
 * hardly counts. Recursive least squares fit the five numbers, beginning with what robots are like.
 * They also know how far the gain is in doubt: the more it is, the earlier a move brakes, and makes
 * up for it afterwards.
 */
#include "move_axis.h"

enum { GAIN, LAG, BEND, DELAY, OFFSET, FITS };
enum { COMMANDED, COVERED, SIGNALS };
#define TIMES 3 /* so often they are smoothed */

/* The constants below were found by a search on robots that were drawn at random between the
 * values of tests/support/family.c; but for `reached` and `slow`, which a move promises, and `fall`
 * and `stands`, which were chosen. Lengths and speeds are in meters; radians are `unit` times as
 * many.
 *
 * What robots are like, and standard deviations of that; lag and bend grow together. */
#define LAG_MEAN 0.34F
#define BEND_MEAN 0.19F
#define DELAY_MEAN 0.18F
#define GAIN_SPREAD 0.11F
#define LAG_SPREAD 0.42F
#define BEND_SPREAD 0.18F
#define DELAY_SPREAD 0.12F
#define OFFSET_SPREAD 0.0087F
#define LAG_AND_BEND 0.91F
#define FILTER_S 0.47F
/* How far off the equation is for a robot that stands, and more per speed; how much is known of
 * that, in statuses; and how fast the offset drifts. */
#define NOISE_M 0.005F
#define NOISE_S 0.0044F
#define NOISE_STATUSES 19.0F
#define DRIFT_M2_S 2.0e-6F
/* The gain may be larger by so many standard deviations, but no gain is farther from 1. */
#define CAUTION 0.84F
#define GAIN_RANGE 0.5F
/* Time constant of the approach to the goal, and how it grows with the doubt. */
#define APPROACH_S 0.069F
#define APPROACH_S_PER_M 4.5F
/* So late the manual's robot follows. */
#define FOLLOWS_S 0.6F
/* A speed is carried on for no longer, from its status to a pose or to now. */
#define LATE_MOST_S 0.3F
/* Something stopped the wheels if a speed that nobody braked has fallen by so much, in so many
 * statuses in a row. What was learned is wrong then, until they roll again. */
#define FALLEN 4
#define FALL 0.06F
#define FALL_SHARE 0.1F
/* What falls by this share of that has perhaps learned something wrong. */
#define SUSPECT 0.4F
#define SUSPECTED 2U
#define STANDS 0.05F
/* Nothing is commanded for a rest below `hold`. */
#define HOLD 0.0012F
/* A goal within `reached` is reached, by a robot that is slower than `slow`, if its gain is in
 * doubt by no more than `doubt`. */
#define REACHED 0.0095F
#define SLOW 0.027F
#define SLOW_LINE_M_S 0.06F
#define SLOW_TURN_RAD_S 0.1F
#define DOUBT_MOST 0.011F
/* By `reached`: where the robot may be if it turned back twice, or took long. */
#define LENIENT 1.9F
/* A robot that responds slowly swings, and is slow at the end of each swing, too. So one whose bend
 * is larger than `swings` is at its goal only if its two smoothed positions agree within `settled`;
 * but a move waits for that no longer than so many times its profile, and some seconds. If its bend
 * is larger than `calm`, it is braked more gently. */
#define SWINGS_S2 0.26F
#define CALM_S2 0.22F
#define SETTLED 0.0099F
#define SETTLE_TIMES 1.6F
#define SETTLE_MARGIN_S 1.5F
/* None rolls farther than this; after a long way, what was learned is not so exact. */
#define ROLLS_S 2.5F
#define ROLLS_M 0.05F
/* What was learned may be wrong on a robot that responds slowly and reports seldom: for as far as
 * robots roll, the gain counts as at least this. */
#define ROLLS_GAIN 0.95F
/* How far it rolls in proportion to its speed, where nothing was learned. */
#define ROLLS_UNKNOWN_S 1.75F

static const float unit[BOTH] = {1, 1.75F};

uint32_t roburoc4_move_axis(const roburoc4_move *m) {
    return is_zero(m->private_goal[LENGTH]) ? ANGLE : LENGTH;
}

float roburoc4_move_root(float square) {
    float y = f32_from_bits((bits_from_f32(square) >> 1) + 0x1FBD1DF5U);
    for (uint32_t i = 0; i < 3; i++) {
        y = 0.5F * (y + square / y);
    }
    return y;
}

float roburoc4_move_axis_seconds(const roburoc4_move *m, uint32_t axis, float way) {
    const float limit = m->private_limit[axis], slope = m->private_slope[axis];
    const float ramps = limit * limit / slope;
    return beyond(way, ramps) ? magnitude(way) / limit + limit / slope
                              : 2 * roburoc4_move_root(magnitude(way) / slope);
}

/** Learn anew, of a robot at rest. */
static void learn_anew(roburoc4_move *m) {
    static const float mean[FITS] = {1, LAG_MEAN, BEND_MEAN, DELAY_MEAN, 0};
    static const float deviation[FITS] = {GAIN_SPREAD, LAG_SPREAD, BEND_SPREAD, DELAY_SPREAD,
                                          OFFSET_SPREAD};
    const uint32_t axis = roburoc4_move_axis(m);
    const float commanded = m->private_commanded[axis], covered = m->private_covered[axis];
    roburoc4_private_fit *f = &m->private_fit;
    memset(f, 0, sizeof *f);
    for (uint32_t i = 0; i < FITS; i++) {
        f->numbers[i] = mean[i];
        f->spread[i][i] = deviation[i] * deviation[i];
    }
    f->gain = 1;
    f->shift = covered - m->private_by_speeds[axis];
    f->spread[LAG][BEND] = f->spread[BEND][LAG] = LAG_AND_BEND * LAG_SPREAD * BEND_SPREAD;
    for (uint32_t i = 0; i < TIMES; i++) {
        f->smooth[COMMANDED][i] = commanded;
        f->smooth[COVERED][i] = covered;
    }
    /* where it is now is known, whatever its gain */
    f->numbers[OFFSET] = covered - commanded;
    f->spread[GAIN][OFFSET] = f->spread[OFFSET][GAIN] = -commanded * f->spread[GAIN][GAIN];
    f->spread[OFFSET][OFFSET] += commanded * commanded * f->spread[GAIN][GAIN];
}

void roburoc4_move_axis_again(roburoc4_move *m) {
    const uint32_t axis = roburoc4_move_axis(m);
    learn_anew(m);
    m->private_patience_s =
        SETTLE_TIMES * roburoc4_move_axis_seconds(m, axis, roburoc4_move_left(m, axis)) +
        SETTLE_MARGIN_S;
    m->private_side = 0;
    m->private_turned = m->private_suspect = 0;
}

void roburoc4_move_axis_begin(roburoc4_move *m) {
    m->private_rested = m->private_fallen = 0;
    m->private_rolled = 0;
    roburoc4_move_axis_again(m);
}

/** One equation: the best numbers for it and all before. */
static void fit(roburoc4_move *m, float passed_s) {
    roburoc4_private_fit *f = &m->private_fit;
    const float *const commanded = f->smooth[COMMANDED];
    const float *const covered = f->smooth[COVERED];
    const float newer = (covered[0] - covered[1]) * (1 / FILTER_S);
    const float speed = (covered[1] - covered[2]) * (1 / FILTER_S);
    const float row[FITS] = {commanded[2], -speed, (speed - newer) * (1 / FILTER_S),
                             (commanded[2] - commanded[1]) * (1 / FILTER_S), 1};
    const float off = NOISE_M + NOISE_S * magnitude(speed);
    const float scale = unit[roburoc4_move_axis(m)] * unit[roburoc4_move_axis(m)];
    const float learned = (NOISE_STATUSES + f->surprise) / (NOISE_STATUSES + f->statuses);
    const float noise = off * off * scale * learned;
    float shared[FITS], variance = noise, error = covered[2];
    f->spread[OFFSET][OFFSET] += passed_s * DRIFT_M2_S * scale;
    for (uint32_t i = 0; i < FITS; i++) {
        shared[i] = 0;
        for (uint32_t k = 0; k < FITS; k++) {
            shared[i] += f->spread[i][k] * row[k];
        }
        variance += row[i] * shared[i];
        error -= row[i] * f->numbers[i];
    }
    f->surprise += learned * error * error / variance;
    f->statuses += 1;
    for (uint32_t i = 0; i < FITS; i++) {
        const float share = shared[i] / variance;
        f->numbers[i] += share * error;
        for (uint32_t k = 0; k < FITS; k++) {
            f->spread[i][k] -= share * shared[k];
        }
    }
    f->gain = 1 + within(f->numbers[GAIN] - 1, GAIN_RANGE);
}

/** Whether the robot rolls as it was told; `told` and `speed` are towards `side`. */
static bool note_rolling(roburoc4_move *m, int8_t side, float told, float speed, float stands) {
    const bool driven = beyond(told, 2 * stands);
    if (side != m->private_rolled || !driven) {
        m->private_rolled = 0;
        m->private_peak = m->private_told = 0;
    }
    if (driven && less(stands, speed)) {
        m->private_rolled = side;
    }
    return m->private_rolled != 0;
}

/** Whether the speed fell, or the robot stands, although it was not told to brake. */
static bool falls(roburoc4_move *m, uint32_t axis) {
    const float sent = axis == LENGTH ? m->linear_m_s : m->angular_rad_s;
    const float told = magnitude(sent), speed = with_sign(1, sent) * m->private_speed[axis];
    const float stands = STANDS * unit[axis];
    if (!note_rolling(m, negative(sent) ? -1 : 1, told, speed, stands)) {
        return false;
    }
    const bool brakes = less(told, m->private_told);
    m->private_told = brakes ? m->private_told : told;
    m->private_peak = less(speed, m->private_peak) ? m->private_peak : speed;
    const float fallen = brakes ? 0 : m->private_peak - speed;
    const float most = FALL * unit[axis] + FALL_SHARE * m->private_peak;
    if (m->private_suspect < SUSPECTED) { /* one status may be noise */
        const bool lower = beyond(fallen, SUSPECT * most);
        m->private_suspect = lower ? (uint8_t)(m->private_suspect + 1) : 0;
    }
    return beyond(fallen, most) || (less(2 * stands, m->private_peak) && !beyond(speed, stands));
}

/** Where it is now: as far as the speeds say since the last pose whose age is known. */
static float covers(roburoc4_move *m, float late_s, roburoc4_move_news news) {
    const uint32_t axis = roburoc4_move_axis(m);
    roburoc4_private_fit *f = &m->private_fit;
    const float speed = m->private_speed[axis] * news.stretch;
    if (news.prompt) {
        f->shift = m->private_covered[axis] - m->private_by_speeds[axis] -
                   within(news.ahead_s, LATE_MOST_S) * speed;
    }
    return m->private_by_speeds[axis] + f->shift + lesser(late_s, LATE_MOST_S) * speed;
}

bool roburoc4_move_axis_learn(roburoc4_move *m, float passed_s, float late_s,
                              roburoc4_move_news news) {
    const uint32_t axis = roburoc4_move_axis(m);
    roburoc4_private_fit *f = &m->private_fit;
    m->private_patience_s -= passed_s;
    const float signals[SIGNALS] = {m->private_commanded[axis], covers(m, late_s, news)};
    if (news.speeds) {
        m->private_fallen = falls(m, axis) ? count_on(m->private_fallen, 1) : 0;
    }
    const float share = passed_s / (passed_s + FILTER_S);
    for (uint32_t i = 0; i < SIGNALS; i++) {
        float value = signals[i];
        for (uint32_t k = 0; k < TIMES; k++) {
            value = f->smooth[i][k] += share * (value - f->smooth[i][k]);
        }
    }
    if (news.speeds || news.prompt) {
        fit(m, passed_s);
    }
    return news.speeds && m->private_fallen >= FALLEN;
}

/** Where it will be at rest, if nothing more is commanded. */
static float rest_at(const roburoc4_move *m) {
    const roburoc4_private_fit *f = &m->private_fit;
    return f->numbers[OFFSET] + f->gain * m->private_commanded[roburoc4_move_axis(m)];
}

/** Standard deviation of where it will be at rest after this was commanded. */
static float doubt(const roburoc4_move *m, float commanded) {
    const float(*spread)[FITS] = (const float(*)[FITS])m->private_fit.spread;
    const float square = commanded * (commanded * spread[GAIN][GAIN] + 2 * spread[GAIN][OFFSET]) +
                         spread[OFFSET][OFFSET];
    return positive(square) ? roburoc4_move_root(square) : 0;
}

float roburoc4_move_axis_rolls(const roburoc4_move *m, float stretch) {
    const roburoc4_private_fit *f = &m->private_fit;
    const bool learned = roburoc4_move_axis(m) == LENGTH;
    const float commanded = m->private_commanded[LENGTH];
    const float speed = magnitude(m->private_speed[LENGTH]);
    const float most = ROLLS_S * (speed + magnitude(m->linear_m_s));
    const float unsure =
        less(f->gain, ROLLS_GAIN) ? (ROLLS_GAIN - f->gain) * lesser(magnitude(commanded), most) : 0;
    const float rest = learned ? rest_at(m) - f->shift : commanded;
    const float known =
        magnitude(rest - m->private_by_speeds[LENGTH]) + unsure + 2 * doubt(m, commanded);
    return lesser(m->private_rolls ? ROLLS_UNKNOWN_S * speed : known / lesser(stretch, 1),
                  most + ROLLS_M);
}

/** Nothing is commanded, and the robot nearly stands. */
static bool slow(const roburoc4_move *m) {
    const uint32_t axis = roburoc4_move_axis(m);
    return is_zero(axis == LENGTH ? m->linear_m_s : m->angular_rad_s) &&
           !beyond(m->private_speed[axis], SLOW * unit[axis]) &&
           !beyond(m->private_speed[LENGTH], SLOW_LINE_M_S) &&
           !beyond(m->private_speed[ANGLE], SLOW_TURN_RAD_S);
}

/** It does not swing any more, or nobody waits for that. */
static bool settled(const roburoc4_move *m) {
    const roburoc4_private_fit *f = &m->private_fit;
    const float *const covered = f->smooth[COVERED];
    return less(f->numbers[BEND], SWINGS_S2) || negative(m->private_patience_s) ||
           !beyond(covered[0] - covered[1], SETTLED * unit[roburoc4_move_axis(m)]);
}

/** How near its goal a robot is there: not so near if it turned back twice, or took long. */
static float near_goal(const roburoc4_move *m) {
    const bool enough = m->private_turned > 1 || negative(m->private_patience_s);
    return REACHED * (enough ? LENIENT : 1) * unit[roburoc4_move_axis(m)];
}

/** The speed from which it comes to rest in this distance: at constant deceleration far from the
 * end, and in proportion to what is left near it. */
static float profile(float distance, float slope, float time_s) {
    return slope * (roburoc4_move_root(time_s * time_s + 2 * distance / slope) - time_s);
}

/** Whatever was learned: towards the goal, no faster than it can stop there from where it is (the
 * manual's robot, if what was learned is suspect); and away from the goal only to brake. */
static float bounded_by_goal(const roburoc4_move *m, float speed) {
    const uint32_t axis = roburoc4_move_axis(m);
    const float left = roburoc4_move_left(m, axis);
    const float towards = with_sign(1, left);
    if (positive(speed * towards)) {
        const float rolls =
            m->private_suspect == SUSPECTED ? FOLLOWS_S * magnitude(m->private_speed[axis]) : 0;
        const float room = beyond(left, rolls) ? magnitude(left) - rolls : 0;
        return within(speed, profile(room, m->private_slope[axis], APPROACH_S));
    }
    return less(SLOW * unit[axis], m->private_speed[axis] * towards) ? speed : 0;
}

/** How hard a move brakes: a robot that responds slowly would swing. */
static float calm_slope(const roburoc4_move *m, uint32_t axis) {
    const float bend = m->private_fit.numbers[BEND];
    return m->private_slope[axis] * (less(CALM_S2, bend) ? CALM_S2 / bend : 1);
}

float roburoc4_move_axis_speed(roburoc4_move *m) {
    const uint32_t axis = roburoc4_move_axis(m);
    roburoc4_private_fit *f = &m->private_fit;
    const float slope = calm_slope(m, axis);
    const bool stands = slow(m) && !is_zero(m->private_commanded[axis]);
    m->private_rested |= stands;
    const float goal = m->private_goal[axis], unsure = doubt(m, goal);
    const float caution = m->private_rested ? 0 : with_sign(CAUTION * unsure, goal);
    const float short_by = goal - rest_at(m) - caution, distance = magnitude(short_by / f->gain);
    if (!is_finite(short_by) || !beyond(short_by, stands ? near_goal(m) : HOLD * unit[axis])) {
        return 0;
    }
    const float time_s = APPROACH_S + APPROACH_S_PER_M * unsure / unit[axis];
    const float speed = lesser(profile(distance, slope, time_s), m->private_limit[axis]);
    /* It turns back once while the robot rolls, to brake, and once more from rest. */
    const int8_t side = negative(short_by) ? -1 : 1;
    if (side == -m->private_side) {
        if (m->private_turned > 1 || (m->private_turned && !stands) ||
            !beyond(short_by, near_goal(m))) {
            return 0;
        }
        m->private_turned++;
    }
    m->private_side = side;
    return bounded_by_goal(m, with_sign(speed, short_by));
}

bool roburoc4_move_axis_arrived(const roburoc4_move *m) {
    const uint32_t axis = roburoc4_move_axis(m);
    const float bound = near_goal(m), goal = m->private_goal[axis];
    return slow(m) && settled(m) && !beyond(roburoc4_move_left(m, axis), bound) &&
           !beyond(goal - rest_at(m), bound) &&
           !beyond(doubt(m, m->private_commanded[axis]), DOUBT_MOST * unit[axis]);
}
