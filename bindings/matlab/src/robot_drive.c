/* SPDX-License-Identifier: MIT
 *
 * Commands that are sent to the robot. None of them waits.
 */
#include "commands.h"
#include "fail.h"

/* Beyond every robot, and well within a float. */
#define FASTEST 1e6
#define FARTHEST_M 1e9

static int done(const char *what, roburoc4_result result) {
    return result >= 0 || fail_result(what, result);
}

/* For what needs a robot that answers, but not that it is armed. */
static int done_unarmed(const char *what, roburoc4_result result) {
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
static int arm(const call *in) {
    roburoc4_client *client;
    roburoc4_result result;
    uint64_t now_us;
    int last_try;
    if (!take_flag(in->arguments[0], "last_try", &last_try)) {
        return 0;
    }
    client = robot_lock(in->object, &now_us);
    result = roburoc4_client_arm(client, now_us);
    robot_unlock(in->object);
    in->results[0] = mxCreateLogicalScalar(result >= 0);
    return (!last_try && is_transient(result)) || done("not armed", result);
}

/* disarm(id) */
static int disarm(const call *in) {
    robot_disarm(in->object);
    return 1;
}

/* stop(id) */
static int stop(const call *in) {
    uint64_t now_us;
    roburoc4_client *client = robot_lock(in->object, &now_us);
    const roburoc4_result result = roburoc4_client_stop(client, now_us);
    robot_unlock(in->object);
    return done("stop", result);
}

/* drive(id, linear_m_s, angular_rad_s) */
static int drive(const call *in) {
    roburoc4_client *client;
    roburoc4_result result;
    uint64_t now_us;
    double linear_m_s, angular_rad_s;
    if (!take_range(in->arguments[0], "linear speed", -FASTEST, FASTEST, &linear_m_s) ||
        !take_range(in->arguments[1], "angular speed", -FASTEST, FASTEST, &angular_rad_s)) {
        return 0;
    }
    client = robot_lock(in->object, &now_us);
    result = roburoc4_client_drive(client, (float)linear_m_s, (float)angular_rad_s, 0, now_us);
    robot_unlock(in->object);
    return done("not driving", result);
}

/* lease(id): seconds for which a drive command lives */
static int look_lease(const call *in) {
    in->results[0] = mxCreateDoubleScalar(((const robot *)in->object)->lease_us / 1e6);
    return 1;
}

/* An output by its name, or by its index on the wire. */
static int take_output(const call *in, uint32_t io_type, uint32_t *index) {
    int64_t number;
    uint32_t found_type;
    if (mxIsChar(in->arguments[0])) {
        return take_channel(in, 1u << io_type, &found_type, index);
    }
    if (!take_whole(in->arguments[0], "channel", 0, UINT16_MAX, &number)) {
        return 0;
    }
    *index = (uint32_t)number;
    return 1;
}

static int done_output(const call *in, uint32_t io_type, uint32_t index, roburoc4_result result) {
    if (result != ROBUROC4_ERR_INDEX) {
        return done_unarmed("output", result);
    }
    return fail(FAIL_ARGUMENT, "the robot has no %s output %lu: it has %lu, from 0 on",
                io_type == ROBUROC4_IO_DIGITAL_OUTPUT ? "digital" : "analog", (unsigned long)index,
                (unsigned long)count_channels(in->object, io_type));
}

/* digital(id, channel, on) */
static int set_digital(const call *in) {
    roburoc4_result result = ROBUROC4_ERR_INDEX;
    uint32_t index;
    int on;
    if (!take_output(in, ROBUROC4_IO_DIGITAL_OUTPUT, &index) ||
        !take_flag(in->arguments[1], "on", &on)) {
        return 0;
    }
    if (index < ROBUROC4_MAX_DIGITAL_OUTPUTS) {
        const uint64_t bit = (uint64_t)1 << index;
        uint64_t now_us;
        roburoc4_client *client = robot_lock(in->object, &now_us);
        result = roburoc4_client_set_digital_outputs(client, bit, on ? bit : 0, now_us);
        robot_unlock(in->object);
    }
    return done_output(in, ROBUROC4_IO_DIGITAL_OUTPUT, index, result);
}

/* analog(id, channel, value) */
static int set_analog(const call *in) {
    roburoc4_client *client;
    roburoc4_result result;
    uint64_t now_us;
    uint32_t index;
    double value;
    if (!take_output(in, ROBUROC4_IO_ANALOG_OUTPUT, &index) ||
        !take_range(in->arguments[1], "value", -1e9, 1e9, &value)) {
        return 0;
    }
    client = robot_lock(in->object, &now_us);
    result = roburoc4_client_set_analog_output(client, index, (float)value, now_us);
    robot_unlock(in->object);
    return done_output(in, ROBUROC4_IO_ANALOG_OUTPUT, index, result);
}

/* relocalize(id, x_m, y_m, theta_rad) */
static int relocalize(const call *in) {
    roburoc4_client *client;
    roburoc4_result result;
    uint64_t now_us;
    double x_m, y_m, theta_rad;
    if (!take_range(in->arguments[0], "x", -FARTHEST_M, FARTHEST_M, &x_m) ||
        !take_range(in->arguments[1], "y", -FARTHEST_M, FARTHEST_M, &y_m) ||
        !take_range(in->arguments[2], "theta", -FARTHEST_M, FARTHEST_M, &theta_rad)) {
        return 0;
    }
    client = robot_lock(in->object, &now_us);
    result = roburoc4_client_relocalize(client, x_m, y_m, theta_rad, now_us);
    robot_unlock(in->object);
    return done_unarmed("relocalize", result);
}

/* relocalized(id): true when the robot took it; false while it did not answer */
static int is_relocalized(const call *in) {
    const roburoc4_result result = robot_facts(in->object).relocalize_result;
    in->results[0] = mxCreateLogicalScalar(result == ROBUROC4_OK);
    return result == ROBUROC4_ERR_UNKNOWN || done("relocalize", result);
}

/* subscribe(id, service, period_ms): a period of 0 ends a subscription */
static int subscribe(const call *in) {
    roburoc4_client *client;
    roburoc4_result result;
    uint64_t now_us;
    uint32_t service;
    int64_t period_ms;
    if (!take_service(in->arguments[0], &service) ||
        !take_whole(in->arguments[1], "period_ms", 0, 2550, &period_ms)) {
        return 0;
    }
    client = robot_lock(in->object, &now_us);
    result = period_ms == 0
                 ? roburoc4_client_unsubscribe(client, service, now_us)
                 : roburoc4_client_subscribe(client, service, (uint32_t)period_ms, now_us);
    robot_unlock(in->object);
    return done("period_ms: give a multiple of 10, 10 to 2550", result);
}

const command robot_drive_commands[] = {
    {"drive", OPEN_ROBOT, 2, drive},
    {"arm", OPEN_ROBOT, 1, arm},
    {"disarm", OPEN_ROBOT, 0, disarm},
    {"stop", OPEN_ROBOT, 0, stop},
    {"lease", ROBOT, 0, look_lease},
    {"digital", OPEN_ROBOT, 2, set_digital},
    {"analog", OPEN_ROBOT, 2, set_analog},
    {"relocalize", OPEN_ROBOT, 3, relocalize},
    {"relocalized", ROBOT, 0, is_relocalized},
    {"subscribe", OPEN_ROBOT, 2, subscribe},
    {NULL, NO_ID, 0, NULL},
};
