/* SPDX-License-Identifier: MIT
 *
 * The control of one axis: which speed to command so that a robot comes to rest at its goal, if
 * nobody knows how late and how far it follows.
 *
 * When a robot is at rest again it has covered `gain` times the distance that was commanded,
 * however late it followed. So what is left to command is the goal divided by the gain, less what
 * was commanded; a loop closed on that has no lag. The gain is what has to be learned, while the
 * robot still accelerates. Several model robots, from one that follows at once to one that takes
 * seconds, get the same commands. For each of them least squares find the gain, and the time that
 * the robot is later than the model, that explain its speeds and poses best; and the models count
 * by how well they then do so. No measurement is differentiated. What the models disagree about is
 * the doubt: the more of it, the earlier a move brakes, to make up for it afterwards.
 */
#include "move_internal.h"

enum { AT, SPEED, SLOPE, SUMS }; /* of a model robot */
enum { PP, PQ, PR, QQ, QR, RR }; /* its sums of products, from SUMS on */

/* Square of the natural frequency, and twice that times the damping. */
static const float models[][2] = {{196, 28},      {25, 6},        {25, 8},         {25, 11.5F},
                                  {12.25F, 4.2F}, {12.25F, 5.6F}, {12.25F, 8.05F}, {6.05F, 2.95F},
                                  {6.05F, 3.89F}, {6.05F, 5.9F},  {3.61F, 2.28F},  {3.61F, 3.04F},
                                  {3.61F, 4.37F}, {2.25F, 1.8F},  {2.25F, 2.4F},   {2.25F, 3.6F}};
#define MODELS (sizeof models / sizeof *models)
typedef char assert_models_fit
    [sizeof((roburoc4_move *)NULL)->private_model == MODELS * (SUMS + RR + 1) * 4 ? 1 : -1];

/* The constants were found by a search on the robots of bench/family.c, but for the least and the
 * most that a move promises.
 *
 * Before anything is known: standard deviations of gain, of delay, and of a speed. The last one
 * counts as much as that of NOISE_STATUSES that were measured; no speed is explained better than by
 * NOISE_LEAST. */
#define GAIN_SPREAD 0.15F
#define DELAY_SPREAD_S 0.09F
#define NOISE 0.035F
#define NOISE_STATUSES 5.0F
#define NOISE_LEAST 0.0013F
/* Standard deviation of a pose, by that of a speed: at rest, and more per speed, since it is late.
 */
#define POSE_NOISE 0.24F
#define POSE_LATE 0.63F
/* How slowly what the models do not explain of the pose is believed, the more slowly the faster the
 * robot is. */
#define DRIFT_S 1.3F
#define DRIFT_PER_SPEED 9.3F
/* The gain may be larger by so many standard deviations. */
#define CAUTION 2.0F
/* Time constant of the approach to the goal, and how it grows with the doubt. */
#define APPROACH_S 0.2F
#define APPROACH_PER_DOUBT_S 2.0F
/* How single speeds are smoothed, and how long a robot rolls that is nearly at rest. */
#define SMOOTH 0.5F
#define ROLL_S 0.3F

/* Nothing is commanded for a rest below `hold`, until it is above `resume`. A goal within `reached`
 * is reached, and a robot slower than `rest` is at rest. */
static const struct bounds {
    float hold, resume, slowest, reached, rest;
} bounds_of[BOTH] = {{0.0012F, 0.008F, 0.024F, 0.0095F, 0.027F},
                     {0.0018F, 0.012F, 0.024F, 0.0166F, 0.054F}};
/* By `reached`: where the robot may be if it turned back twice; and the most that it may be off if
 * it rolls as it should, or as the models say. */
#define TWICE_BACK 1.7F
#define ROLLS_OUT 1.5F
#define STAYS 2.0F

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

/** e to the power of minus x, within a few percent. */
static float decay(float x) {
    return beyond(x, 80) ? 0 : f32_from_bits(0x3F800000U - (uint32_t)(int32_t)(12102203.0F * x));
}

/** Add a measurement to the sums of products: of what a model measures, of what it would
 * measure more if it were a second earlier, and of what the robot measures more. */
static void add(roburoc4_move *m, float measured, uint32_t of, float weight) {
    for (uint32_t k = 0; k < MODELS; k++) {
        float *s = m->private_model[k], *sum = s + SUMS;
        const float row[] = {s[of], s[of + 1], measured - s[of]};
        for (uint32_t i = 0; i < 3; i++) {
            for (uint32_t j = i; j < 3; j++) {
                *sum++ += weight * row[i] * row[j];
            }
        }
    }
}

/** For each model the best gain and delay; then of all models, each by how well it does. */
static void solve(roburoc4_move *m) {
    float fit[MODELS][4], best = 1e30F; /* gain - 1, delay times gain, variance, error */
    const float noise = m->private_noise;
    for (uint32_t k = 0; k < MODELS; k++) {
        const float *s = m->private_model[k] + SUMS;
        const float pp = s[PP] + noise * (1 / (GAIN_SPREAD * GAIN_SPREAD)),
                    qq = s[QQ] + noise * (1 / (DELAY_SPREAD_S * DELAY_SPREAD_S));
        const float by = 1 / (pp * qq - s[PQ] * s[PQ]);
        fit[k][0] = by * (s[PR] * qq - s[PQ] * s[QR]);
        fit[k][1] = by * (s[QR] * pp - s[PQ] * s[PR]);
        fit[k][2] = by * qq * noise;
        fit[k][3] = s[RR] - fit[k][0] * s[PR] - fit[k][1] * s[QR];
        best = lesser(best, fit[k][3]);
    }
    float sum = 0, gain = 0, square = 0, at = 0, speed = 0;
    for (uint32_t k = 0; k < MODELS; k++) {
        const float *s = m->private_model[k];
        const float weight = decay(0.5F * (fit[k][3] - best) / noise), more = fit[k][0];
        sum += weight;
        gain += weight * more;
        square += weight * (more * more + fit[k][2]);
        at += weight * (s[AT] + more * s[AT] + fit[k][1] * s[SPEED]);
        speed += weight * (s[SPEED] + more * s[SPEED] + fit[k][1] * s[SLOPE]);
    }
    gain /= sum;
    m->private_gain = 1 + gain;
    m->private_doubt = square / sum - gain * gain;
    m->private_doubt = order_of(m->private_doubt) > 0 ? roburoc4_move_root(m->private_doubt) : 0;
    m->private_at = at / sum;
    m->private_slow = speed / sum;
    m->private_noise = (NOISE_STATUSES * NOISE * NOISE * m->private_scale + best) /
                           (NOISE_STATUSES + m->private_statuses) +
                       NOISE_LEAST * NOISE_LEAST * m->private_scale;
}

void roburoc4_move_axis_begin(roburoc4_move *m) {
    memset(m->private_model, 0, sizeof m->private_model);
    m->private_scale = roburoc4_move_axis(m) == LENGTH ? 1 : 4;
    m->private_noise = NOISE * NOISE * m->private_scale;
    m->private_statuses = m->private_drift = m->private_at = m->private_slow = m->private_smooth =
        0;
    m->private_gain = 1;
    m->private_doubt = GAIN_SPREAD;
    m->private_holds = 0;
    m->private_side = 0;
    m->private_turned = 0;
}

void roburoc4_move_axis_learn(roburoc4_move *m, uint32_t passed_us, float sent, bool speeds,
                              bool pose) {
    const uint32_t axis = roburoc4_move_axis(m);
    for (uint32_t left_us = passed_us; left_us > 0;) {
        const uint32_t span_us = left_us > 10000 ? 10000 : left_us;
        const float span_s = seconds_of(span_us);
        left_us -= span_us;
        for (uint32_t k = 0; k < MODELS; k++) {
            float *s = m->private_model[k];
            s[SLOPE] += span_s * (models[k][0] * (sent - s[SPEED]) - models[k][1] * s[SLOPE]);
            s[SPEED] += span_s * s[SLOPE];
            s[AT] += span_s * s[SPEED];
        }
    }
    if (speeds) {
        add(m, m->private_speed[axis], SPEED, 1);
        m->private_smooth += SMOOTH * (m->private_speed[axis] - m->private_smooth);
        m->private_statuses += 1;
    }
    const float late = POSE_LATE * magnitude(m->private_slow);
    if (pose) {
        const float w = 1 / (POSE_NOISE + late);
        add(m, m->private_covered[axis], AT, w * w);
    }
    if (speeds || pose) {
        solve(m);
    }
    m->private_drift += seconds_of(passed_us) /
                        (DRIFT_S * (1 + DRIFT_PER_SPEED * magnitude(m->private_slow))) *
                        (m->private_covered[axis] - m->private_at - m->private_drift);
}

/** What is left to command: the robot is at `covered`, has yet to follow what was commanded
 * already, and goes too far rather than not far enough. */
static float to_command(const roburoc4_move *m) {
    const uint32_t axis = roburoc4_move_axis(m);
    const float covered = m->private_drift + m->private_at;
    return (m->private_goal[axis] - covered) / (m->private_gain + CAUTION * m->private_doubt) -
           (m->private_commanded[axis] - m->private_at / m->private_gain);
}

float roburoc4_move_axis_rolls(const roburoc4_move *m) {
    const float most = m->private_gain + 2 * m->private_doubt;
    return most * m->private_commanded[LENGTH] - m->private_by_speeds[LENGTH];
}

/** At rest: single statuses may be too noisy to decide. */
static bool stands(const roburoc4_move *m) {
    return !beyond(m->private_smooth, bounds_of[roburoc4_move_axis(m)].rest);
}

/** How near its goal it is there: not so near if it turned back twice. */
static float near_goal(const roburoc4_move *m) {
    return (m->private_turned > 1 ? TWICE_BACK : 1) * bounds_of[roburoc4_move_axis(m)].reached;
}

/** Where it will come to rest if it rolls already: short of its goal by this. */
static float short_by(const roburoc4_move *m) {
    const uint32_t axis = roburoc4_move_axis(m);
    return m->private_goal[axis] - m->private_covered[axis] - ROLL_S * m->private_smooth;
}

float roburoc4_move_axis_speed(roburoc4_move *m) {
    const uint32_t axis = roburoc4_move_axis(m);
    const float now = axis == LENGTH ? m->linear_m_s : m->angular_rad_s;
    const bool rests = is_zero(now) && stands(m);
    const float left = rests ? short_by(m) / m->private_gain : to_command(m);
    const float distance = magnitude(left), slope = m->private_slope[axis];
    const float bound = rests              ? near_goal(m)
                        : m->private_holds ? bounds_of[axis].resume
                                           : bounds_of[axis].hold;
    m->private_holds = !beyond(distance, bound);
    if (m->private_holds) {
        return 0;
    }
    /* At constant deceleration far from the end, and in proportion to what is left near it. */
    const float time_s = APPROACH_S + APPROACH_PER_DOUBT_S * m->private_doubt;
    float speed = slope * (roburoc4_move_root(time_s * time_s + 2 * distance / slope) - time_s);
    speed = lesser(speed, m->private_limit[axis]);
    speed = beyond(speed, bounds_of[axis].slowest) ? speed : bounds_of[axis].slowest;
    /* It turns back once while the robot rolls, to brake; then only from rest. */
    const int8_t side = order_of(left) < 0 ? -1 : 1;
    if (side == -m->private_side) {
        if (m->private_turned && !rests) {
            return 0;
        }
        m->private_turned++;
    }
    m->private_side = side;
    return with_sign(speed, left);
}

bool roburoc4_move_axis_arrived(const roburoc4_move *m) {
    const uint32_t axis = roburoc4_move_axis(m);
    const float bound = near_goal(m);
    const float left = m->private_goal[axis] - m->private_covered[axis];
    const float stays =
        m->private_goal[axis] - m->private_drift - m->private_gain * m->private_commanded[axis];
    return stands(m) && !beyond(left, bound) && !beyond(short_by(m), ROLLS_OUT * bound) &&
           !beyond(stays, STAYS * bound);
}
