/* SPDX-License-Identifier: MIT
 *
 * Commands of moves (roburoc4_move.h). None of them waits: Robot.m steps a move to its end.
 */
#include <math.h>

#include "commands.h"
#include "fail.h"

#define LONGEST_S 4e6

enum { STRAIGHT, TURN, ARC, TO_POINT, TO_POSE, REST, KINDS };

static roburoc4_result begin(roburoc4_move *move, int64_t kind, const double *values,
                             const roburoc4_move_options *options) {
    switch (kind) {
    case STRAIGHT:
    case TURN:
    case ARC:
        return roburoc4_move_by(move, (float)values[0], (float)values[1], options);
    case TO_POINT:
        return roburoc4_move_to_point(move, values[0], values[1], options);
    case TO_POSE:
        return roburoc4_move_to_pose(move, values[0], values[1], values[2], options);
    default:
        return roburoc4_move_rest(move, options);
    }
}

/* moveBegin(id, kind, x or distance, y or angle, theta, speed, clearance, timeout): a speed or
 * timeout of 0, and a clearance below 0, are the default */
static int begin_move(call *in) {
    robot *r = in->object;
    roburoc4_move_options options;
    const roburoc4_facts facts = client_facts(in->client, in->now_us);
    int64_t kind;
    double values[3], speed, clearance_m, timeout_s;
    roburoc4_result result;
    (void)roburoc4_move_options_init(&options, sizeof options);
    if (!take_whole(in->arguments[0], "kind", 0, KINDS - 1, &kind) ||
        !take_range(in->arguments[1], "distance or x", -1e9, 1e9, &values[0]) ||
        !take_range(in->arguments[2], "angle or y", -1e9, 1e9, &values[1]) ||
        !take_range(in->arguments[3], "theta", -1e4, 1e4, &values[2]) ||
        !take_range(in->arguments[4], "speed", 0, 100, &speed) ||
        !take_range(in->arguments[5], "clearance", -1, 100, &clearance_m) ||
        !take_range(in->arguments[6], "timeout", 0, LONGEST_S, &timeout_s)) {
        return 0;
    }
    if (kind != REST && !facts.armed) {
        return fail_result("not moving", facts.disarm_cause);
    }
    if (speed > 0) {
        options.linear_m_s = (float)speed;
        options.angular_rad_s = kind == TURN ? (float)speed : options.angular_rad_s;
    }
    if (speed > 0 && kind == ARC && values[0] != 0 && values[1] != 0) {
        options.angular_rad_s = (float)(speed * fabs(values[1] / values[0]));
    }
    options.clearance_m = clearance_m < 0 ? options.clearance_m : (float)clearance_m;
    options.timeout_ms = (uint32_t)(timeout_s * 1000);
    result = begin(&r->move, kind, values, &options);
    return result >= 0 ||
           fail(FAIL_ARGUMENT, "a move is at most 10 km long, and turns by at most 10000 rad");
}

/* moveStep(id): continue; false when the move has ended */
static int step_move(call *in) {
    roburoc4_move *move = &((robot *)in->object)->move;
    in->number = roburoc4_move_step(move, in->client, in->now_us) == ROBUROC4_MOVE_RUNNING;
    if (in->number != 0.0) {
        (void)roburoc4_client_drive(in->client, move->linear_m_s, move->angular_rad_s, 0,
                                    in->now_us);
    }
    return 1;
}

/* moveResult(id): its progress, or how it ended */
static int read_move(call *in) {
    static const char *const names[] = {"running",  "reached",   "override", "bumper",
                                        "obstacle", "inhibited", "lost",     "other_commander",
                                        "timeout",  "cancelled"};
    const roburoc4_move *move = &((const robot *)in->object)->move;
    answer_add(&in->out, "result", make_text(names[move->result]));
    answer_number(&in->out, "distance_m", (double)move->distance_m);
    answer_number(&in->out, "angle_rad", (double)move->angle_rad);
    answer_number(&in->out, "left_m", (double)move->left_m);
    answer_number(&in->out, "left_rad", (double)move->left_rad);
    answer_add(&in->out, "text", make_text(roburoc4_move_result_text(move->result)));
    return 1;
}

const command robot_move_commands[] = {
    {"moveBegin", CONTROL_ROBOT, 7, NOTHING, begin_move},
    {"moveStep", CONTROL_ROBOT, 0, FLAG, step_move},
    {"moveResult", READ_ROBOT, 0, STRUCT, read_move},
    {NULL, NO_ID, 0, NOTHING, NULL},
};
