/* SPDX-License-Identifier: MIT
 *
 * Commands that are sent to the robot, and moves (roburoc4_move.h). None of them waits: Robot.m
 * steps a move to its end.
 */
#include <math.h>

#include "commands.h"

/* For commands that need a robot that answers, armed or not. */
static int done_unarmed(const char *what, roburoc4_result result) {
    if (result == ROBUROC4_ERR_NOT_READY) {
        return fail(FAIL_TIMEOUT,
                    "%s: the robot does not answer; check link, and try again when status.ready",
                    what);
    }
    return done(what, result);
}

/* arm(id, last_try): true when armed; false if waiting may help, unless this is the last try */
static int arm(call *in) {
    const roburoc4_result result = roburoc4_client_arm(in->client, in->now_us);
    in->number = result >= 0;
    return (in->numbers[0] == 0.0 && roburoc4_refusal_may_pass(result)) ||
           done("not armed", result);
}

/* stop(id): and disarm */
static int stop(call *in) {
    return done("stop", roburoc4_client_stop(in->client, in->now_us));
}

/* pause(id): stop, and stay armed */
static int pause_driving(call *in) {
    return done("pause", roburoc4_client_pause(in->client, in->now_us));
}

/* drive(id, linear_m_s, angular_rad_s): how many seconds it lasts */
static int drive(call *in) {
    in->number = ((const robot *)in->object)->lease_us / 1e6;
    return done("not driving", roburoc4_client_drive(in->client, (float)in->numbers[0],
                                                     (float)in->numbers[1], 0, in->now_us));
}

/* renew(id, linear_m_s, angular_rad_s): likewise, if the last lease still runs */
static int renew(call *in) {
    const roburoc4_facts facts = client_facts(in->client, in->now_us);
    if (facts.armed && !facts.driving) {
        return facts.lapsed ? done("not driving", ROBUROC4_ERR_LAPSED)
                            : fail(FAIL_MOVE, "cancelled: pause was called");
    }
    return drive(in);
}

/* -------------------------------------------------------------------- outputs and the pose --- */

static int done_output(const call *in, const char *type, roburoc4_result result) {
    roburoc4_iocard_properties card = {0};
    (void)roburoc4_client_iocard_properties(in->client, &card);
    if (result == ROBUROC4_ERR_INDEX) {
        const int count = type[0] == 'a' ? card.analog_outputs : card.digital_outputs;
        return count <= 0 ? fail(FAIL_ARGUMENT, "the robot has no %s outputs", type)
                          : fail(FAIL_ARGUMENT, "the robot has no %s output %g; give 0 to %d", type,
                                 in->numbers[0], count - 1);
    }
    return done_unarmed("output", result);
}

/* digital(id, index, on) */
static int set_digital(call *in) {
    const double index = in->numbers[0];
    const uint64_t bit = index < ROBUROC4_MAX_DIGITAL_OUTPUTS ? (uint64_t)1 << (uint32_t)index : 0;
    return done_output(in, "digital",
                       bit == 0
                           ? ROBUROC4_ERR_INDEX
                           : roburoc4_client_set_digital_outputs(
                                 in->client, bit, in->numbers[1] != 0.0 ? bit : 0, in->now_us));
}

/* analog(id, index, value) */
static int set_analog(call *in) {
    return done_output(in, "analog",
                       roburoc4_client_set_analog_output(in->client, (uint32_t)in->numbers[0],
                                                         (float)in->numbers[1], in->now_us));
}

/* relocalize(id, x_m, y_m, theta_rad) */
static int relocalize(call *in) {
    return done_unarmed("relocalize",
                        roburoc4_client_relocalize(in->client, in->numbers[0], in->numbers[1],
                                                   in->numbers[2], in->now_us));
}

/* relocalized(id): true when the robot accepted it; false until it answers */
static int is_relocalized(call *in) {
    const roburoc4_result result = client_facts(in->client, in->now_us).relocalize_result;
    in->number = result == ROBUROC4_OK;
    return result == ROBUROC4_ERR_NOT_KNOWN || done("relocalize", result);
}

/* subscribe(id, service, period_ms): a period of 0 ends a subscription */
static int subscribe(call *in) {
    return done("subscribe", roburoc4_client_subscribe(in->client, (uint32_t)in->numbers[0],
                                                       (uint32_t)in->numbers[1], in->now_us));
}

/* ---------------------------------------------------------------------------------- moves --- */

enum { BY, TO_POINT, TO_POSE, REST, FOR, MOVES };

static roburoc4_result begin(roburoc4_move *move, int kind, const double *to,
                             const roburoc4_move_options *options) {
    return kind == BY         ? roburoc4_move_by(move, (float)to[0], (float)to[1], options)
           : kind == TO_POINT ? roburoc4_move_to_point(move, to[0], to[1], options)
           : kind == TO_POSE  ? roburoc4_move_to_pose(move, to[0], to[1], to[2], options)
           : kind == FOR      ? roburoc4_move_for(move, (float)to[0], (float)to[1],
                                                  (uint32_t)(to[2] * 1000), options)
                              : roburoc4_move_rest(move, options);
}

/* moveBegin(id, kind, x | distance | v, y | angle | w, theta | seconds, speed, clearance, timeout,
 * allow_turns): a speed or timeout of 0, and a clearance below 0, are the default */
static int begin_move(call *in) {
    const int kind = (int)in->numbers[0];
    const double *to = &in->numbers[1], speed = in->numbers[4], clearance_m = in->numbers[5];
    const roburoc4_facts facts = client_facts(in->client, in->now_us);
    roburoc4_move_options options;
    (void)roburoc4_move_options_init(&options, sizeof options);
    if (kind != REST && !facts.armed) {
        return done("not moving", facts.disarm_cause);
    }
    const bool in_place = kind == BY && to[0] == 0;
    if (speed > 0 && !in_place) {
        options.max_linear_m_s = (float)speed;
    }
    if (speed > 0 && kind == BY && to[1] != 0) { /* of an arc, both rates in proportion */
        options.max_angular_rad_s = (float)(in_place ? speed : speed * fabs(to[1] / to[0]));
    }
    options.clearance_m = clearance_m < 0 ? options.clearance_m : (float)clearance_m;
    options.timeout_ms = (uint32_t)(in->numbers[6] * 1000);
    options.allow_turns = in->numbers[7] != 0;
    const roburoc4_result result = begin(&((robot *)in->object)->move, kind, to, &options);
    return result >= 0 ||
           fail(FAIL_ARGUMENT,
                result == ROBUROC4_ERR_UNITS
                    ? "angles are in radians, beyond two turns only with allow_turns; speeds in "
                      "m/s and rad/s, at most 5 and 10"
                    : "a move is at most 10 km long, and turns by at most 10000 rad");
}

/* moveStep(id): continue; false when the move has ended */
static int step_move(call *in) {
    roburoc4_move *move = &((robot *)in->object)->move;
    in->number = roburoc4_move_step(move, in->client, in->now_us) == ROBUROC4_MOVE_RUNNING;
    if (in->number != 0.0) {
        const roburoc4_result driven =
            roburoc4_client_drive(in->client, move->linear_m_s, move->angular_rad_s, 0, in->now_us);
        (void)driven; /* where it is refused, the next step ends the move */
    }
    return 1;
}

/* moveResult(id): its progress, or how it ended */
static int read_move(call *in) {
    static const char *const names[] = {
        "running",         "reached",        "override",           "bumper",           "obstacle",
        "inhibited",       "lost",           "other_commander",    "timeout",          "cancelled",
        "lapsed",          "odometry",       "relocalized",        "off_course",       "too_fast",
        "no_front_bumper", "no_rear_bumper", "no_front_telemeter", "no_rear_telemeter"};
    static const field figures[] = {
        FIELD(roburoc4_move, distance_m, FLOAT), FIELD(roburoc4_move, angle_rad, FLOAT),
        FIELD(roburoc4_move, remaining_m, FLOAT), FIELD(roburoc4_move, remaining_rad, FLOAT)};
    const roburoc4_move *move = &((const robot *)in->object)->move;
    answer_add(&in->out, "outcome", make_text(names[move->outcome]));
    answer_fields(&in->out, figures, COUNT_OF(figures), move);
    answer_add(&in->out, "text", make_text(roburoc4_move_outcome_text(move->outcome)));
    return 1;
}

/* clang-format off */
#define OUTPUT WHOLE("output", 0, UINT16_MAX)
#define FINITE(name) WITHIN(name, -1e9, 1e9)

const command robot_drive_commands[] = {
    {"drive", CONTROL_ROBOT, NUMBER, drive, {SPEED("linear speed"), SPEED("angular speed")}},
    {"renew", CONTROL_ROBOT, NUMBER, renew, {SPEED("linear speed"), SPEED("angular speed")}},
    {"arm", CONTROL_ROBOT, FLAG, arm, {SWITCH("last_try")}},
    {"stop", CONTROL_ROBOT, NOTHING, stop, {NONE}},
    {"pause", CONTROL_ROBOT, NOTHING, pause_driving, {NONE}},
    {"digital", CONTROL_ROBOT, NOTHING, set_digital, {OUTPUT, SWITCH("on")}},
    {"analog", CONTROL_ROBOT, NOTHING, set_analog, {OUTPUT, FINITE("value")}},
    {"relocalize", CONTROL_ROBOT, NOTHING, relocalize, {FINITE("x"), FINITE("y"), FINITE("theta")}},
    {"relocalized", READ_ROBOT, FLAG, is_relocalized, {NONE}},
    {"subscribe", CONTROL_ROBOT, NOTHING, subscribe, {SERVICE, WHOLE("period_ms", 0, 2550)}},
    {"moveBegin", CONTROL_ROBOT, NOTHING, begin_move,
     {WHOLE("kind", 0, MOVES - 1), FINITE("distance or x"), FINITE("angle or y"),
      WITHIN("theta", -1e4, 1e4), WITHIN("speed", 0, 100), WITHIN("clearance", -1, 100),
      WITHIN("timeout", 0, 4e6), SWITCH("allow_turns")}},
    {"moveStep", CONTROL_ROBOT, FLAG, step_move, {NONE}},
    {"moveResult", READ_ROBOT, STRUCT, read_move, {NONE}},
    LAST,
};
/* clang-format on */
