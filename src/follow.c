/* SPDX-License-Identifier: MIT
 *
 * Whether the robot follows its targets: on each axis, by sign and size, averaged over a few
 * statuses.
 *
 * How fast a robot responds is not known. Its measured speed must lie within what the fastest and
 * the slowest robot would show: each bound goes away from the other at once with the target, and
 * comes back in a few seconds. Numbers are fixed-point, as most targets have no floats.
 */
#include "bytes.h"
#include "machines.h"

#define FIXED_BITS 16
#define ONE (INT32_C(1) << FIXED_BITS)
#define LARGEST (32 * ONE)
/* Averages are taken over two to the power of this many cycles. Bounds come back in so many: longer
 * where the robot has to become faster, as it may be slow to start. */
#define MEAN_BITS 5
#define FASTER_BITS 9
#define SLOWER_BITS 8
/* Longer gaps between statuses count as this. */
#define MOST_CYCLES (1U << MEAN_BITS)
/* The robot does not follow if its speed was out of bounds for this long. */
#define FAULT_CYCLES 100
/* A share of the target below which the robot does not follow it. */
#define LEAST(bound) ((bound) / 2)
/* How far a robot may exceed its target: gain, overshoot, and rolling while it should rest. */
#define MOST(bound) ((bound) + (bound) / 4 + (bound) / 16)
/* Overshoot of a weakly damped robot when its target gets slower, from how much of the change is
 * left. */
#define SWING(change) ((change) / 3)
static const int32_t tolerance[AXES] = {ONE / 10, ONE / 5};
/* Slower than this is no motion, so targets of twice as much can be watched. */
static const int32_t slowest_motion[AXES] = {ONE / 200, ONE / 50};
/* Bounds allow a robot whose target changes direction to stand. One that has had targets of at
 * least `clear` in one direction for this long, none of half as much in the other, and never moved,
 * does not follow either. */
#define STILL_CYCLES 100
static const int32_t clear[AXES] = {ONE / 6, ONE / 3};
static const int32_t standing[AXES] = {ONE / 100, ONE / 40};

static int32_t bounded(int32_t value, int32_t most) {
    return value > most ? most : value < -most ? -most : value;
}

/** A speed as a fixed-point number; NaN is the largest. */
static int32_t fixed_from(float value) {
    return bounded(fixed_from_f32(value, FIXED_BITS), LARGEST);
}

/** `passed` of 2^bits parts of the way, rounded towards the beginning. A division would be a slow
 * function call on small machines. */
static int32_t part_way(int32_t from, int32_t to, uint32_t passed, uint32_t bits) {
    const int32_t way = to - from;
    const int32_t part = (int32_t)((uint32_t)(way < 0 ? -way : way) * passed >> bits);
    return way < 0 ? from - part : from + part;
}

static bool out_of_bounds(const follow *f, uint32_t axis, int32_t target) {
    const int32_t low = f->low[axis];
    const int32_t high = f->high[axis];
    const int32_t lowest = low > 0 ? LEAST(low) - slowest_motion[axis] - SWING(high - target)
                                   : MOST(low) - tolerance[axis];
    const int32_t highest = high < 0 ? LEAST(high) + slowest_motion[axis] + SWING(target - low)
                                     : MOST(high) + tolerance[axis];
    return f->mean[axis] < lowest || f->mean[axis] > highest;
}

/** Whether an axis stands although it should have moved by now. */
static bool stands(follow *f, uint32_t axis, int32_t target, uint32_t passed) {
    const int32_t span = (int32_t)passed;
    int32_t still = (int32_t)f->still_cycles[axis];
    if (f->mean[axis] >= standing[axis] || f->mean[axis] <= -standing[axis]) {
        still -= bounded(still, span);
    } else if (target >= clear[axis]) {
        still = (still > 0 ? still : 0) + span;
    } else if (target <= -clear[axis]) {
        still = (still < 0 ? still : 0) - span;
    } else if (still > 0 ? target <= -clear[axis] / 2 : target >= clear[axis] / 2) {
        still = 0; /* it has to turn back */
    }
    f->still_cycles[axis] = (int8_t)bounded(still, STILL_CYCLES);
    return still >= STILL_CYCLES || still <= -STILL_CYCLES;
}

void roburoc4_follow_begin(follow *f) {
    f->fault_cycles = f->fault = 0;
    f->still_cycles[LINEAR] = f->still_cycles[ANGULAR] = 0;
    if (f->watching == WATCHING_NOTHING) {
        f->watching = WATCHING_FROM_REST;
    }
}

/** The bounds go away from each other at once, and come back in a few seconds. */
static void move_bounds(follow *f, uint32_t axis, int32_t target, uint32_t passed) {
    const int32_t low =
        part_way(f->low[axis], target, passed, f->low[axis] < 0 ? SLOWER_BITS : FASTER_BITS);
    const int32_t high =
        part_way(f->high[axis], target, passed, f->high[axis] > 0 ? SLOWER_BITS : FASTER_BITS);
    f->low[axis] = target < low ? target : low;
    f->high[axis] = target > high ? target : high;
}

void roburoc4_follow_sent(follow *f, const float *targets) {
    for (uint32_t axis = 0; axis < AXES; axis++) {
        move_bounds(f, axis, fixed_from(targets[axis]), 0);
    }
}

/** Take a speed into the averages and bounds of an axis: whether it is out of bounds. */
static bool watch_axis(follow *f, uint32_t axis, float measured, const float *targets,
                       uint32_t passed) {
    const int32_t speed = fixed_from(measured);
    if (f->watching != WATCHING) {
        const int32_t most = f->watching == WATCHING_FROM_REST ? tolerance[axis] : LARGEST;
        f->mean[axis] = f->low[axis] = f->high[axis] = bounded(speed, most);
    }
    if (!is_finite(measured)) {
        return true;
    }
    f->mean[axis] = part_way(f->mean[axis], speed, passed, MEAN_BITS);
    const int32_t target = targets != NULL ? fixed_from(targets[axis]) : f->mean[axis];
    move_bounds(f, axis, target, passed);
    if (stands(f, axis, target, passed)) {
        f->fault_cycles = FAULT_CYCLES;
        return true;
    }
    return out_of_bounds(f, axis, target);
}

bool roburoc4_follow_status(follow *f, const float *targets,
                            const roburoc4_differential_status *s) {
    const uint32_t passed = at_most((uint16_t)((uint16_t)s->robot_cycles - f->cycles), MOST_CYCLES);
    const bool linear = watch_axis(f, LINEAR, s->current_linear_m_s, targets, passed);
    const bool angular = watch_axis(f, ANGULAR, s->current_angular_rad_s, targets, passed);
    f->cycles = (uint16_t)s->robot_cycles;
    f->watching = WATCHING;
    if (targets == NULL) {
        f->fault_cycles = f->fault = 0;
    } else if (linear || angular) {
        f->fault_cycles = (uint8_t)at_most(f->fault_cycles + passed, FAULT_CYCLES);
        f->fault = f->fault || f->fault_cycles == FAULT_CYCLES;
    } else {
        f->fault_cycles = (uint8_t)(f->fault_cycles > passed ? f->fault_cycles - passed : 0);
        f->fault = f->fault && f->fault_cycles > 0;
    }
    return f->fault != 0;
}
