/* SPDX-License-Identifier: MIT
 *
 * What the files of the moves share: arithmetic without libm, and the control of one axis.
 */
#ifndef ROBUROC4_MOVE_AXIS_H
#define ROBUROC4_MOVE_AXIS_H

#include "bytes.h"
#include "roburoc4_move.h"

/** What a move is for. */
enum { BY, TO_POINT, TO_POSE, FOR, REST };
/** An axis of the robot: ahead, or the angle. */
enum { LENGTH, ANGLE, BOTH };

#define PI_F 3.14159265F
#define FAR_M 10000.0F
/* Statuses that a move needs are older: it is lost. */
#define SILENCE_US 1000000U

static inline bool positive(float value) {
    return order_of(value) > 0;
}

static inline bool negative(float value) {
    return order_of(value) < 0;
}

static inline bool less(float a, float b) {
    return order_of(a) < order_of(b);
}

static inline bool beyond(float value, float bound) {
    return less(bound, magnitude(value));
}

static inline float lesser(float a, float b) {
    return less(a, b) ? a : b;
}

static inline float with_sign(float size, float sign) {
    return negative(sign) ? -size : size;
}

static inline float within(float value, float bound) {
    return beyond(value, bound) ? with_sign(bound, value) : value;
}

/** Integers as floats and back are signed here: the others are more functions on small machines. */
static inline float seconds_of(uint64_t span_us) {
    return (float)(int32_t)(span_us < INT32_MAX ? span_us : INT32_MAX) * 1e-6F;
}

/** The smaller of two distances; NaN counts as blocked. */
static inline float nearer(float a, float b) {
    return is_finite(b) ? lesser(a, b) : 0;
}

/** As far as such a counter goes. */
static inline uint8_t count_on(uint8_t cycles, uint32_t passed) {
    return passed < (uint32_t)UINT8_MAX - cycles ? (uint8_t)(cycles + passed) : UINT8_MAX;
}

/** It has a way to go, or a place; the others have a time, or come to rest. */
static inline bool has_goal(const roburoc4_move *m) {
    return m->private_kind < FOR;
}

/** What is left of the leg. */
static inline float roburoc4_move_left(const roburoc4_move *m, uint32_t axis) {
    return m->private_goal[axis] - m->private_covered[axis];
}

extern const roburoc4_move_options roburoc4_move_defaults;

float roburoc4_move_root(float square);
/** Wrap an angle to -pi..pi. */
float roburoc4_move_half_turn(float angle_rad);
/** One step with what the view says; ends the move where it has to. Converts *v in place: call it
 * once for each view. */
int32_t roburoc4_move_advance(roburoc4_move *m, roburoc4_move_view *v, uint64_t now_us);
int32_t roburoc4_move_end(roburoc4_move *m, int32_t outcome);
/** What it proposed was not sent: begin from standing speeds again. */
void roburoc4_move_hold(roburoc4_move *m);

/* One leg of a move is about one axis; move_axis.c knows how far it was commanded, and learns how
 * far the robot will have come when it is at rest. */

/** The axis that the present leg is about. */
uint32_t roburoc4_move_axis(const roburoc4_move *m);
/** How long the profile of a way takes. */
float roburoc4_move_axis_seconds(const roburoc4_move *m, uint32_t axis, float way);
/** The robot is at rest; nothing is known of its response. */
void roburoc4_move_axis_begin(roburoc4_move *m);
/** The same in the middle of a leg: what was learned is wrong. */
void roburoc4_move_axis_again(roburoc4_move *m);
/** What the statuses of a step show. */
typedef struct roburoc4_move_news {
    bool speeds; /* there is a status of speeds */
    bool prompt; /* another pose than before (some robots compute it seldom, and repeat it), and no
                    status was lost before it, so it is no older than it looks */
    float ahead_s; /* by so much it is newer than the speeds */
    float stretch; /* the robot comes along so many times as far as it drives */
} roburoc4_move_news;

/** Time passed, and the last speeds came so long ago. True if something stopped the wheels. */
bool roburoc4_move_axis_learn(roburoc4_move *m, float passed_s, float late_s,
                              roburoc4_move_news news);
/** The speed towards the end of the leg. */
float roburoc4_move_axis_speed(roburoc4_move *m);
/** Whether the robot is at rest at the end of the leg, and will stay there. */
bool roburoc4_move_axis_arrived(const roburoc4_move *m);
/** How far the robot drives yet by what was commanded; it comes along `stretch` times as far. */
float roburoc4_move_axis_rolls(const roburoc4_move *m, float stretch);

#endif
