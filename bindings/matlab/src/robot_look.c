/* SPDX-License-Identifier: MIT
 *
 * Commands that read: the latest of everything, what the robot is, the link, and columns.
 */
#include <string.h>

#include "answers.h"
#include "channels.h"
#include "commands.h"
#include "fail.h"

#define NOT_KNOWN 255

/* ------------------------------------------------------------------------------------ status ---
 */

/* How old a value is that was received then; read the value first. */
static uint64_t age_us(const robot *one, uint64_t received_us) {
    const uint64_t now_us = robot_now_us(one);
    return now_us > received_us ? now_us - received_us : 0;
}

static void add_age(answer *out, const char *name, const robot *one, int known,
                    uint64_t received_us) {
    answer_number(out, name, known ? (double)age_us(one, received_us) / 1e6 : mxGetInf());
}

static void add_facts(answer *out, robot *one) {
    roburoc4_facts facts = {.size = sizeof facts};
    (void)robot_facts(one, &facts);
    answer_flag(out, "ready", facts.state == ROBUROC4_STATE_READY);
    answer_flag(out, "armed", facts.armed);
    answer_flag(out, "driving", facts.driving);
    answer_flag(out, "stopping", facts.stopping);
    answer_flag(out, "override_known", facts.override_known);
    answer_flag(out, "overridden", facts.overridden);
    answer_flag(out, "other_commander", facts.foreign);
    answer_flag(out, "inhibited", facts.inhibited);
    answer_flag(out, "front_bumper", facts.front_bumper);
    answer_flag(out, "rear_bumper", facts.rear_bumper);
    answer_flag(out, "battery_low", facts.battery_low);
    answer_number(out, "disarm_cause", facts.disarm_cause);
}

static uint64_t add_localization(answer *out, robot *one) {
    roburoc4_localization_status status = {0};
    uint64_t received_us = 0;
    const int known = robot_localization(one, &status, &received_us) >= 0;
    answer_number(out, "x_m", known ? status.x_m : mxGetNaN());
    answer_number(out, "y_m", known ? status.y_m : mxGetNaN());
    answer_number(out, "theta_rad", known ? status.theta_rad : mxGetNaN());
    answer_byte(out, "localization_flags", (uint8_t)(status.flags & 0xFFu));
    add_age(out, "localization_age_s", one, known, received_us);
    return status.robot_cycles;
}

static uint64_t add_speeds(answer *out, robot *one) {
    roburoc4_differential_status status = {0};
    uint64_t received_us = 0;
    const int known = robot_differential(one, &status, &received_us) >= 0;
    const double unknown = mxGetNaN();
    answer_number(out, "target_linear_m_s", known ? (double)status.target_linear_m_s : unknown);
    answer_number(out, "linear_m_s", known ? (double)status.current_linear_m_s : unknown);
    answer_number(out, "target_angular_rad_s",
                  known ? (double)status.target_angular_rad_s : unknown);
    answer_number(out, "angular_rad_s", known ? (double)status.current_angular_rad_s : unknown);
    add_age(out, "differential_age_s", one, known, received_us);
    return status.robot_cycles;
}

static uint64_t add_distances(answer *out, robot *one) {
    roburoc4_distances status = {0};
    uint64_t received_us = 0;
    const int known = robot_distances(one, &status, &received_us) >= 0;
    answer_row(out, "distances_m", status.distance_m, status.count);
    add_age(out, "telemeter_age_s", one, known, received_us);
    return status.robot_cycles;
}

static uint64_t add_battery(answer *out, robot *one) {
    roburoc4_battery_status status = {0};
    uint64_t received_us = 0;
    const int known = robot_battery(one, &status, &received_us) >= 0;
    answer_byte(out, "battery_state", known ? status.state : NOT_KNOWN);
    answer_byte(out, "remaining_percent", known ? status.remaining_percent : NOT_KNOWN);
    add_age(out, "battery_age_s", one, known, received_us);
    return status.robot_cycles;
}

/* Overridden and the bumpers are with the facts. */
static uint64_t add_inputs_age(answer *out, robot *one) {
    roburoc4_inputs status = {0};
    uint64_t received_us = 0;
    const int known = robot_inputs(one, &status, &received_us) >= 0;
    add_age(out, "iocard_age_s", one, known, received_us);
    return status.robot_cycles;
}

static uint64_t later(uint64_t one, uint64_t other) {
    return one > other ? one : other;
}

/* status(id) */
static int look_status(const call *told) {
    robot *one = told_robot(told);
    uint64_t cycles;
    answer out;
    if (one == NULL) {
        return 0;
    }
    answer_begin(&out);
    answer_number(&out, "time_s", (double)(robot_now_us(one) - one->opened_us) / 1e6);
    add_facts(&out, one);
    cycles = add_inputs_age(&out, one);
    cycles = later(cycles, add_localization(&out, one));
    cycles = later(cycles, add_speeds(&out, one));
    cycles = later(cycles, add_distances(&out, one));
    cycles = later(cycles, add_battery(&out, one));
    answer_cycles(&out, "robot_cycles", cycles);
    told->results[0] = answer_finish(&out);
    return 1;
}

/* What steers a robot must be fresh: pose() and speeds() are NaN where it is not. */
static int is_fresh(const robot *one, uint64_t received_us) {
    return age_us(one, received_us) < one->fresh_us;
}

/* pose(id): x_m, y_m, theta_rad, for loops that need no more: a row costs a third of a struct */
static int look_pose(const call *told) {
    roburoc4_localization_status status = {0};
    robot *one = told_robot(told);
    uint64_t received_us = 0;
    double *row;
    int known;
    if (one == NULL) {
        return 0;
    }
    known = robot_localization(one, &status, &received_us) >= 0 && is_fresh(one, received_us);
    row = make_doubles(&told->results[0], 1, 3);
    row[0] = known ? status.x_m : mxGetNaN();
    row[1] = known ? status.y_m : mxGetNaN();
    row[2] = known ? status.theta_rad : mxGetNaN();
    return 1;
}

/* speeds(id): linear_m_s, angular_rad_s */
static int look_speeds(const call *told) {
    roburoc4_differential_status status = {0};
    robot *one = told_robot(told);
    uint64_t received_us = 0;
    double *row;
    int known;
    if (one == NULL) {
        return 0;
    }
    known = robot_differential(one, &status, &received_us) >= 0 && is_fresh(one, received_us);
    row = make_doubles(&told->results[0], 1, 2);
    row[0] = known ? (double)status.current_linear_m_s : mxGetNaN();
    row[1] = known ? (double)status.current_angular_rad_s : mxGetNaN();
    return 1;
}

/* -------------------------------------------------------------------------------------- info ---
 */

static double known_or_nan(int known, float value) {
    return known ? (double)value : mxGetNaN();
}

static void add_limits(answer *out, robot *one) {
    roburoc4_differential_properties it = {0};
    const int known = robot_differential_properties(one, &it) >= 0;
    answer_number(out, "max_linear_m_s", known_or_nan(known, it.max_linear_m_s));
    answer_number(out, "min_linear_m_s", known_or_nan(known, it.min_linear_m_s));
    answer_number(out, "max_angular_rad_s", known_or_nan(known, it.max_angular_rad_s));
    answer_number(out, "min_angular_rad_s", known_or_nan(known, it.min_angular_rad_s));
    answer_number(out, "max_linear_m_s2", known_or_nan(known, it.max_linear_m_s2));
    answer_number(out, "min_linear_m_s2", known_or_nan(known, it.min_linear_m_s2));
    answer_number(out, "max_angular_rad_s2", known_or_nan(known, it.max_angular_rad_s2));
    answer_number(out, "min_angular_rad_s2", known_or_nan(known, it.min_angular_rad_s2));
    answer_number(out, "width_m", known_or_nan(known, it.width_m));
}

static void add_battery_data(answer *out, robot *one) {
    roburoc4_battery_properties it = {0};
    const int known = robot_battery_properties(one, &it) >= 0;
    answer_number(out, "nominal_voltage_v", known_or_nan(known, it.nominal_voltage_v));
    answer_number(out, "capacity_ah", known_or_nan(known, it.capacity_ah));
    answer_byte(out, "minimum_percent", known ? it.minimum_percent : NOT_KNOWN);
}

static void add_start(answer *out, robot *one) {
    roburoc4_localization_properties it = {0};
    const int known = robot_localization_properties(one, &it) >= 0;
    answer_number(out, "initial_x_m", known ? it.x_m : mxGetNaN());
    answer_number(out, "initial_y_m", known ? it.y_m : mxGetNaN());
    answer_number(out, "initial_theta_rad", known ? it.theta_rad : mxGetNaN());
}

static void add_telemeters(answer *out, robot *one) {
    static const char *const names[] = {"telemeter_x_m",
                                        "telemeter_y_m",
                                        "telemeter_theta_rad",
                                        "telemeter_field_of_view_rad",
                                        "telemeter_min_distance_m",
                                        "telemeter_max_distance_m"};
    float rows[6][ROBUROC4_MAX_TELEMETERS];
    uint32_t count = robot_telemeter_count(one), i;
    for (i = 0; i < count; i++) {
        roburoc4_telemeter it = {0};
        (void)robot_telemeter(one, i, &it);
        rows[0][i] = it.x_m;
        rows[1][i] = it.y_m;
        rows[2][i] = it.theta_rad;
        rows[3][i] = it.field_of_view_rad;
        rows[4][i] = it.min_distance_m;
        rows[5][i] = it.max_distance_m;
    }
    for (i = 0; i < 6; i++) {
        answer_row(out, names[i], rows[i], count);
    }
}

static void add_directory(answer *out, robot *one) {
    float ids[ROBUROC4_MAX_SERVICES], types[ROBUROC4_MAX_SERVICES];
    uint32_t count = robot_service_count(one), i;
    for (i = 0; i < count; i++) {
        roburoc4_directory_entry it = {0};
        (void)robot_service_at(one, i, &it);
        ids[i] = (float)it.id;
        types[i] = (float)it.type;
    }
    answer_row(out, "service_ids", ids, count);
    answer_row(out, "service_types", types, count);
}

/* info(id) */
static int look_info(const call *told) {
    robot *one = told_robot(told);
    answer out;
    if (one == NULL) {
        return 0;
    }
    answer_begin(&out);
    add_limits(&out, one);
    add_battery_data(&out, one);
    add_start(&out, one);
    answer_number(&out, "analog_inputs", channels_count(one, ROBUROC4_IO_ANALOG_INPUT));
    answer_number(&out, "analog_outputs", channels_count(one, ROBUROC4_IO_ANALOG_OUTPUT));
    answer_number(&out, "digital_inputs", channels_count(one, ROBUROC4_IO_DIGITAL_INPUT));
    answer_number(&out, "digital_outputs", channels_count(one, ROBUROC4_IO_DIGITAL_OUTPUT));
    add_telemeters(&out, one);
    add_directory(&out, one);
    told->results[0] = answer_finish(&out);
    return 1;
}

/* address(id) */
static int look_address(const call *told) {
    robot *one = told_robot(told);
    char address[ROBUROC4_ADDRESS_TEXT_SIZE];
    if (one == NULL) {
        return 0;
    }
    robot_address_text(one, address, sizeof address);
    told->results[0] = make_text(address, strlen(address));
    return 1;
}

/* -------------------------------------------------------------------------------------- link ---
 */

/* link(id) */
static int look_link(const call *told) {
    roburoc4_link link = {.size = sizeof link};
    robot *one = told_robot(told);
    answer out;
    if (one == NULL) {
        return 0;
    }
    (void)robot_link(one, &link);
    answer_begin(&out);
    answer_number(&out, "round_trip_s", link.round_trip_us / 1e6);
    answer_number(&out, "round_trip_min_s", link.round_trip_min_us / 1e6);
    answer_number(&out, "silence_s", link.silence_us / 1e6);
    answer_number(&out, "received", link.received);
    answer_number(&out, "lost", link.lost);
    answer_number(&out, "loss", (double)link.loss);
    told->results[0] = answer_finish(&out);
    return 1;
}

/* serviceLink(id, service) */
static int look_service_link(const call *told) {
    roburoc4_service_link link = {.size = sizeof link};
    robot *one = told_robot(told);
    uint32_t service;
    answer out;
    if (one == NULL || !take_service(told->arguments[1], &service)) {
        return 0;
    }
    (void)robot_service_link(one, service, &link);
    answer_begin(&out);
    answer_flag(&out, "subscribed", link.subscribed != 0);
    answer_number(&out, "received", link.received);
    answer_number(&out, "lost", link.lost);
    answer_number(&out, "late", link.late);
    answer_number(&out, "duplicates", link.duplicates);
    answer_number(&out, "period_s", link.period_us / 1e6);
    answer_number(&out, "jitter_s", link.jitter_us / 1e6);
    answer_number(&out, "age_s", link.age_us == UINT32_MAX ? mxGetInf() : link.age_us / 1e6);
    answer_number(&out, "loss", (double)link.loss);
    told->results[0] = answer_finish(&out);
    return 1;
}

/* ---------------------------------------------------------------------------------------- io ---
 */

static int fail_no_inputs(void) {
    return fail(FAIL_PROTOCOL, "the robot has sent no IO card status yet: wait with spin(0.1)");
}

/* io(id, name): double of an analog input, logical of a digital one */
static int look_input(const call *told) {
    robot *one = told_robot(told);
    char name[TEXT_SIZE];
    roburoc4_inputs inputs;
    channel found;
    if (one == NULL || !take_text(told->arguments[1], "channel", name) ||
        !channels_find(one, name, CHANNEL_INPUTS, &found)) {
        return 0;
    }
    if (robot_inputs(one, &inputs, NULL) < 0) {
        return fail_no_inputs();
    }
    if (found.io_type == ROBUROC4_IO_DIGITAL_INPUT && found.index < inputs.digital_count) {
        told->results[0] = mxCreateLogicalScalar((inputs.digital >> found.index & 1u) != 0);
        return 1;
    }
    if (found.io_type == ROBUROC4_IO_ANALOG_INPUT && found.index < inputs.analog_count) {
        told->results[0] = mxCreateDoubleScalar((double)inputs.analog[found.index]);
        return 1;
    }
    return fail(FAIL_LIMIT, "'%s' lies beyond the inputs that the client keeps", name);
}

static void add_names(answer *out, const char *field, robot *one, uint32_t io_type) {
    uint32_t count = channels_count(one, io_type), i;
    char name[CHANNEL_NAME];
    mxArray *names;
    if (count > ROBUROC4_MAX_DIGITAL_INPUTS) {
        count = ROBUROC4_MAX_DIGITAL_INPUTS;
    }
    names = mxCreateCellMatrix(1, count);
    for (i = 0; i < count; i++) {
        channels_name(one, io_type, i, name);
        mxSetCell(names, i, make_text(name, strlen(name)));
    }
    answer_add(out, field, names);
}

/* inputs(id): all of them, with the names of all channels */
static int look_inputs(const call *told) {
    robot *one = told_robot(told);
    roburoc4_inputs inputs;
    mxArray *digital;
    mxLogical *on;
    uint32_t i;
    answer out;
    if (one == NULL) {
        return 0;
    }
    if (robot_inputs(one, &inputs, NULL) < 0) {
        return fail_no_inputs();
    }
    answer_begin(&out);
    answer_cycles(&out, "robot_cycles", inputs.robot_cycles);
    answer_row(&out, "analog_inputs", inputs.analog, inputs.analog_count);
    on = make_logicals(&digital, 1, inputs.digital_count);
    for (i = 0; i < inputs.digital_count; i++) {
        on[i] = (inputs.digital >> i & 1u) != 0;
    }
    answer_add(&out, "digital_inputs", digital);
    add_names(&out, "analog_input_names", one, ROBUROC4_IO_ANALOG_INPUT);
    add_names(&out, "digital_input_names", one, ROBUROC4_IO_DIGITAL_INPUT);
    add_names(&out, "analog_output_names", one, ROBUROC4_IO_ANALOG_OUTPUT);
    add_names(&out, "digital_output_names", one, ROBUROC4_IO_DIGITAL_OUTPUT);
    told->results[0] = answer_finish(&out);
    return 1;
}

/* ----------------------------------------------------------------------------------- columns ---
 */

#define ALL_SERVICES 0x7Cu

static int take_mask(const call *told, uint32_t *mask) {
    int i;
    *mask = told->count > 1 ? 0 : ALL_SERVICES;
    for (i = 1; i < told->count; i++) {
        uint32_t service;
        if (!take_service(told->arguments[i], &service)) {
            return 0;
        }
        *mask |= 1u << service;
    }
    return 1;
}

/* record(id, service, ...): forget what was recorded, and begin now */
static int begin_recording(const call *told) {
    robot *one = told_robot(told);
    uint32_t mask;
    if (one == NULL || !take_mask(told, &mask)) {
        return 0;
    }
    samples_free(&one->recording);
    robot_begin_reading(one, &one->reader);
    one->recording_us = robot_now_us(one);
    one->recording_mask = mask;
    return 1;
}

/* recorded(id): take what has come since */
static int go_on_recording(const call *told) {
    robot *one = told_robot(told);
    return one != NULL && robot_drain(one, &one->reader, &one->recording);
}

/* recording(id): all that was recorded, as columns */
static int end_recording(const call *told) {
    robot *one = told_robot(told);
    if (one == NULL || !robot_drain(one, &one->reader, &one->recording)) {
        return 0;
    }
    if (one->recording.count == 0 && robot_state(one) != ROBUROC4_STATE_READY) {
        return fail(FAIL_TIMEOUT, "nothing was recorded: the robot does not answer; look at link");
    }
    told->results[0] =
        samples_columns(&one->recording, one->recording_mask, one->recording_us, one->reader.lost);
    samples_free(&one->recording);
    return 1;
}

/* log(id, service, ...): all since the robot was made, or since the last logged() */
static int look_log(const call *told) {
    robot *one = told_robot(told);
    sample_list list = {0};
    uint32_t mask;
    if (one == NULL || !take_mask(told, &mask)) {
        return 0;
    }
    one->log_end = one->log;
    if (!robot_drain(one, &one->log_end, &list)) {
        samples_free(&list);
        return 0;
    }
    told->results[0] = samples_columns(&list, mask, one->opened_us, one->log_end.lost);
    samples_free(&list);
    return 1;
}

/* logged(id): the file of log() is written; the next one begins after it */
static int end_log(const call *told) {
    robot *one = told_robot(told);
    if (one == NULL) {
        return 0;
    }
    one->log = one->log_end;
    one->log.lost = 0;
    return 1;
}

const command robot_look_commands[] = {
    {"status", look_status, 1},
    {"pose", look_pose, 1},
    {"speeds", look_speeds, 1},
    {"info", look_info, 1},
    {"address", look_address, 1},
    {"link", look_link, 1},
    {"serviceLink", look_service_link, 2},
    {"io", look_input, 2},
    {"inputs", look_inputs, 1},
    {"record", begin_recording, -1},
    {"recorded", go_on_recording, 1},
    {"recording", end_recording, 1},
    {"log", look_log, -1},
    {"logged", end_log, 1},
    {NULL, NULL, 0},
};
