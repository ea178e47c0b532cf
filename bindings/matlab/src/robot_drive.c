/* SPDX-License-Identifier: MIT
 *
 * Commands that tell the robot something. None of them waits.
 */
#include "answers.h"
#include "channels.h"
#include "commands.h"
#include "fail.h"

/* Beyond every robot, and well within a float. */
#define FASTEST 1e6

static int done(const char *what, roburoc4_result result) {
    return result >= 0 ? 1 : fail_result(what, result);
}

/* For what needs a robot that answers, but not that it is armed. */
static int done_there(const char *what, roburoc4_result result) {
    if (result == ROBUROC4_ERR_NOT_READY) {
        return fail(FAIL_TIMEOUT,
                    "%s: the robot does not answer; look at link, and try again when status.ready",
                    what);
    }
    return done(what, result);
}

/* Reasons against arming that time alone may take away. */
static int is_transient(roburoc4_result result) {
    return result == ROBUROC4_ERR_NOT_READY || result == ROBUROC4_ERR_STALE_DIFFERENTIAL ||
           result == ROBUROC4_ERR_STALE_IOCARD || result == ROBUROC4_ERR_OVERRIDE_UNKNOWN ||
           result == ROBUROC4_ERR_MOVING;
}

/* arm(id, last_try): true when armed; false where time may help, unless this is the last try */
static int arm(const call *told) {
    robot *one = told_robot(told);
    roburoc4_result result;
    int last_try;
    if (one == NULL || !take_flag(told->arguments[1], "last_try", &last_try)) {
        return 0;
    }
    result = robot_arm(one);
    told->results[0] = mxCreateLogicalScalar(result >= 0);
    return !last_try && is_transient(result) ? 1 : done("not armed", result);
}

/* disarm(id) */
static int disarm(const call *told) {
    robot *one = told_robot(told);
    return one != NULL && done("disarm", robot_disarm(one));
}

/* stop(id) */
static int stop(const call *told) {
    robot *one = told_robot(told);
    return one != NULL && done("stop", robot_stop(one));
}

/* drive(id, linear_m_s, angular_rad_s) */
static int drive(const call *told) {
    robot *one = told_robot(told);
    double linear_m_s, angular_rad_s;
    return one != NULL &&
           take_range(told->arguments[1], "linear speed", -FASTEST, FASTEST, &linear_m_s) &&
           take_range(told->arguments[2], "angular speed", -FASTEST, FASTEST, &angular_rad_s) &&
           done("not driving", robot_drive(one, (float)linear_m_s, (float)angular_rad_s));
}

/* lease(id): seconds for which a drive command lives */
static int tell_lease(const call *told) {
    robot *one = told_robot(told);
    if (one == NULL) {
        return 0;
    }
    told->results[0] = mxCreateDoubleScalar((double)one->lease_us / 1e6);
    return 1;
}

/* A channel by its name, or by its index on the wire. */
static int take_channel(const call *told, robot *one, uint32_t io_type, uint32_t *out) {
    char name[TEXT_SIZE];
    channel found = {0};
    int64_t index = 0;
    if (!mxIsChar(told->arguments[1])) {
        int fine = take_whole(told->arguments[1], "channel", 0, UINT16_MAX, &index);
        *out = (uint32_t)index;
        return fine;
    }
    if (!take_text(told->arguments[1], "channel", name) ||
        !channels_find(one, name, 1u << io_type, &found)) {
        return 0;
    }
    *out = found.index;
    return 1;
}

static int outcome(robot *one, uint32_t io_type, uint32_t index, roburoc4_result result) {
    if (result == ROBUROC4_ERR_INDEX) {
        return fail(FAIL_ARGUMENT, "the robot has no %s output %lu: it has %lu, from 0 on",
                    io_type == ROBUROC4_IO_DIGITAL_OUTPUT ? "digital" : "analog",
                    (unsigned long)index, (unsigned long)channels_count(one, io_type));
    }
    return done_there("output", result);
}

/* digital(id, channel, on) */
static int set_digital(const call *told) {
    robot *one = told_robot(told);
    uint32_t index;
    int on;
    return one != NULL && take_channel(told, one, ROBUROC4_IO_DIGITAL_OUTPUT, &index) &&
           take_flag(told->arguments[2], "on", &on) &&
           outcome(one, ROBUROC4_IO_DIGITAL_OUTPUT, index,
                   robot_set_digital_output(one, index, on));
}

/* analog(id, channel, value) */
static int set_analog(const call *told) {
    robot *one = told_robot(told);
    uint32_t index;
    double value;
    return one != NULL && take_channel(told, one, ROBUROC4_IO_ANALOG_OUTPUT, &index) &&
           take_range(told->arguments[2], "value", -1e9, 1e9, &value) &&
           outcome(one, ROBUROC4_IO_ANALOG_OUTPUT, index,
                   robot_set_analog_output(one, index, (float)value));
}

/* relocalize(id, x_m, y_m, theta_rad) */
static int relocalize(const call *told) {
    robot *one = told_robot(told);
    double x_m, y_m, theta_rad;
    return one != NULL && take_range(told->arguments[1], "x", -1e9, 1e9, &x_m) &&
           take_range(told->arguments[2], "y", -1e9, 1e9, &y_m) &&
           take_range(told->arguments[3], "theta", -1e9, 1e9, &theta_rad) &&
           done_there("relocalize", robot_relocalize(one, x_m, y_m, theta_rad));
}

/* relocalized(id): true when the robot took it; false while it did not answer */
static int is_relocalized(const call *told) {
    roburoc4_facts facts = {.size = sizeof facts};
    robot *one = told_robot(told);
    roburoc4_result result;
    if (one == NULL) {
        return 0;
    }
    result = robot_facts(one, &facts);
    if (result == ROBUROC4_OK) {
        result = facts.relocalize_result;
    }
    told->results[0] = mxCreateLogicalScalar(result == ROBUROC4_OK);
    return result == ROBUROC4_ERR_UNKNOWN ? 1 : done("relocalize", result);
}

/* subscribe(id, service, period_ms) */
static int subscribe(const call *told) {
    robot *one = told_robot(told);
    uint32_t service;
    int64_t period_ms;
    return one != NULL && take_service(told->arguments[1], &service) &&
           take_whole(told->arguments[2], "period_ms", 0, 2550, &period_ms) &&
           done("period_ms: 0, or a multiple of 10 to 2550",
                robot_subscribe(one, service, (uint32_t)period_ms));
}

const command robot_drive_commands[] = {
    {"drive", drive, 3},
    {"arm", arm, 2},
    {"disarm", disarm, 1},
    {"stop", stop, 1},
    {"lease", tell_lease, 1},
    {"digital", set_digital, 3},
    {"analog", set_analog, 3},
    {"relocalize", relocalize, 4},
    {"relocalized", is_relocalized, 1},
    {"subscribe", subscribe, 3},
    {NULL, NULL, 0},
};
