/* SPDX-License-Identifier: MIT
 *
 * Commands that are sent to the robot. None of them waits.
 */
#include "commands.h"
#include "fail.h"

/* Beyond any robot, and well within a float. */
#define FASTEST 1e6
#define FARTHEST_M 1e9

static int done(const char *what, roburoc4_result result) {
    return result >= 0 || fail_result(what, result);
}

/* For commands that need a robot that answers, but not that it is armed. */
static int done_unarmed(const char *what, roburoc4_result result) {
    if (result == ROBUROC4_ERR_NOT_READY) {
        return fail(FAIL_TIMEOUT,
                    "%s: the robot does not answer; look at link, and try again when status.ready",
                    what);
    }
    return done(what, result);
}

/* arm(id, last_try): true when armed; false if waiting may help, unless this is the last try */
static int arm(call *in) {
    roburoc4_result result;
    int last_try;
    if (!take_flag(in->arguments[0], "last_try", &last_try)) {
        return 0;
    }
    result = roburoc4_client_arm(in->client, in->now_us);
    in->number = result >= 0;
    return (!last_try && roburoc4_refusal_may_pass(result)) || done("not armed", result);
}

/* disarm(id) */
static int disarm(call *in) {
    return done("disarm", roburoc4_client_disarm(in->client, in->now_us));
}

/* stop(id) */
static int stop(call *in) {
    return done("stop", roburoc4_client_stop(in->client, in->now_us));
}

/* A speed. Elsewhere true counts as a number, but nobody means 1 m/s by it. */
static int take_speed(const mxArray *value, const char *name, double *out) {
    if (mxIsLogical(value)) {
        return fail(FAIL_ARGUMENT, "%s: this is logical; give one real number", name);
    }
    return take_range(value, name, -FASTEST, FASTEST, out);
}

/* drive(id, linear_m_s, angular_rad_s) */
static int drive(call *in) {
    double linear_m_s, angular_rad_s;
    return take_speed(in->arguments[0], "linear speed", &linear_m_s) &&
           take_speed(in->arguments[1], "angular speed", &angular_rad_s) &&
           done("not driving", roburoc4_client_drive(in->client, (float)linear_m_s,
                                                     (float)angular_rad_s, 0, in->now_us));
}

static int done_output(const call *in, uint32_t io_type, int64_t index, roburoc4_result result) {
    if (result != ROBUROC4_ERR_INDEX) {
        return done_unarmed("output", result);
    }
    return fail(FAIL_ARGUMENT, "the robot has no %s output %d: it has %lu, from 0 on",
                io_type == ROBUROC4_IO_DIGITAL_OUTPUT ? "digital" : "analog", (int)index,
                (unsigned long)channel_count(in->client, io_type));
}

/* digital(id, index, on) */
static int set_digital(call *in) {
    int64_t index;
    uint64_t bit;
    int on;
    if (!take_whole(in->arguments[0], "output", 0, UINT16_MAX, &index) ||
        !take_flag(in->arguments[1], "on", &on)) {
        return 0;
    }
    bit = index < ROBUROC4_MAX_DIGITAL_OUTPUTS ? (uint64_t)1 << index : 0;
    return done_output(
        in, ROBUROC4_IO_DIGITAL_OUTPUT, index,
        bit == 0 ? ROBUROC4_ERR_INDEX
                 : roburoc4_client_set_digital_outputs(in->client, bit, on ? bit : 0, in->now_us));
}

/* analog(id, index, value) */
static int set_analog(call *in) {
    int64_t index;
    double value;
    return take_whole(in->arguments[0], "output", 0, UINT16_MAX, &index) &&
           take_range(in->arguments[1], "value", -1e9, 1e9, &value) &&
           done_output(in, ROBUROC4_IO_ANALOG_OUTPUT, index,
                       roburoc4_client_set_analog_output(in->client, (uint32_t)index, (float)value,
                                                         in->now_us));
}

/* relocalize(id, x_m, y_m, theta_rad) */
static int relocalize(call *in) {
    double x_m, y_m, theta_rad;
    return take_range(in->arguments[0], "x", -FARTHEST_M, FARTHEST_M, &x_m) &&
           take_range(in->arguments[1], "y", -FARTHEST_M, FARTHEST_M, &y_m) &&
           take_range(in->arguments[2], "theta", -FARTHEST_M, FARTHEST_M, &theta_rad) &&
           done_unarmed("relocalize",
                        roburoc4_client_relocalize(in->client, x_m, y_m, theta_rad, in->now_us));
}

/* relocalized(id): true when the robot accepted it; false until it answers */
static int is_relocalized(call *in) {
    const roburoc4_result result = client_facts(in->client, in->now_us).relocalize_result;
    in->number = result == ROBUROC4_OK;
    return result == ROBUROC4_ERR_UNKNOWN || done("relocalize", result);
}

/* subscribe(id, service, period_ms): a period of 0 ends a subscription */
static int subscribe(call *in) {
    uint32_t service;
    int64_t period_ms;
    if (!take_service(in->arguments[0], &service) ||
        !take_whole(in->arguments[1], "period_ms", 0, 2550, &period_ms)) {
        return 0;
    }
    if (period_ms % 10 != 0) {
        return fail(FAIL_ARGUMENT,
                    "period_ms: %d is not allowed; give a multiple of 10, 10 to 2550",
                    (int)period_ms);
    }
    return done("subscribe",
                roburoc4_client_subscribe(in->client, service, (uint32_t)period_ms, in->now_us));
}

const command robot_drive_commands[] = {
    {"drive", CONTROL_ROBOT, 2, NOTHING, drive},
    {"arm", CONTROL_ROBOT, 1, FLAG, arm},
    {"disarm", CONTROL_ROBOT, 0, NOTHING, disarm},
    {"stop", CONTROL_ROBOT, 0, NOTHING, stop},
    {"digital", CONTROL_ROBOT, 2, NOTHING, set_digital},
    {"analog", CONTROL_ROBOT, 2, NOTHING, set_analog},
    {"relocalize", CONTROL_ROBOT, 3, NOTHING, relocalize},
    {"relocalized", READ_ROBOT, 0, FLAG, is_relocalized},
    {"subscribe", CONTROL_ROBOT, 2, NOTHING, subscribe},
    {NULL, NO_ID, 0, NOTHING, NULL},
};
