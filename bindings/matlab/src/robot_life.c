/* SPDX-License-Identifier: MIT
 *
 * Commands that open, wait for and close robots.
 */
#include <math.h>

#include "commands.h"

/* open(address, options, buffer, record) or simConnect(id, options, buffer, record): its id */
static int open_robot(call *in) {
    simulation *world = in->object;
    const char *address = world == NULL ? in->texts[0] : NULL;
    const int i = address != NULL; /* the options */
    robot_settings settings = {.buffer = (uint32_t)in->numbers[i + 1], .record = in->texts[i + 2]};
    return (world == NULL || simulator_is_virtual(world)) &&
           settings_of_robot(in->arguments[i], &settings.config) &&
           (in->number = robot_open(address, world, &settings)) != 0.0;
}

/* close(id) */
static int close_one(call *in) {
    robot_close(in->object);
    return 1;
}

/* leave(id): stop the robot if this object drives it; true while the stop sequence runs */
static int leave(call *in) {
    in->number = robot_leave(in->object);
    return 1;
}

/* -------------------------------------------------------------------------------- waiting --- */

static void add_count(call *in, const char *name, uint32_t counter) {
    answer_number(&in->out, name, roburoc4_client_count(in->client, counter));
}

/* Whether each service that was subscribed to has sent a status, unless it never will. */
static int has_data(const call *in) {
    const roburoc4_facts facts = client_facts(in->client, in->now_us);
    roburoc4_service_link link = {.size = sizeof link};
    for (uint32_t service = FIRST_SERVICE; service < ROBUROC4_SERVICE_COUNT; service++) {
        (void)roburoc4_client_service_link(in->client, service, in->now_us, &link);
        if (link.subscribed && (facts.missing >> service & 1u) == 0 &&
            facts.age_us[service] == UINT32_MAX) {
            return 0;
        }
    }
    return 1;
}

/* progress(id): the progress of a robot that is not ready */
static int read_progress(call *in) {
    roburoc4_pump *pump = ((const robot *)in->object)->pump;
    const uint32_t state = roburoc4_client_state(in->client);
    roburoc4_link link = {.size = sizeof link};
    char address[ROBUROC4_ADDRESS_TEXT_SIZE] = "";
    uint32_t fault;
    (void)roburoc4_pump_lock(pump);
    fault = roburoc4_pump_udp(pump)->fault;
    (void)roburoc4_udp_address_text(&roburoc4_pump_udp(pump)->address, address, sizeof address);
    roburoc4_pump_unlock(pump);
    (void)roburoc4_client_link(in->client, in->now_us, &link);
    answer_flag(&in->out, "ready", state == ROBUROC4_STATE_READY);
    answer_number(&in->out, "step", state <= ROBUROC4_STATE_READY ? state : 0);
    answer_flag(&in->out, "data", has_data(in));
    answer_add(&in->out, "state", make_text(roburoc4_name(ROBUROC4_NAME_STATE, state)));
    answer_add(&in->out, "address", make_text(address[0] != '\0' ? address : "the simulator"));
    answer_number(&in->out, "time_s", answer_time(&in->out, in->now_us));
    answer_number(&in->out, "silence_s", link.silence_us / 1e6);
    add_count(in, "sent", ROBUROC4_COUNT_SENT);
    add_count(in, "received", ROBUROC4_COUNT_RECEIVED);
    add_count(in, "refused", ROBUROC4_COUNT_REFUSED);
    answer_add(&in->out, "fault", make_text(fault != 0 ? roburoc4_udp_fault_text(fault) : ""));
    return 1;
}

/* now(id): seconds on the robot's clock */
static int read_time(call *in) {
    in->number = answer_time(&in->out, robot_now_us(in->object));
    return 1;
}

/* wait(id, seconds): seconds on the robot's clock afterwards */
static int wait(call *in) {
    /* Rounded up, because a caller that waits for the rest of a rounded time would never finish. */
    robot_wait(in->object, (uint32_t)ceil(in->numbers[0] * 1e6), NULL);
    return read_time(in);
}

/* busy(id, on): a waiting method starts, or reached its end */
static int set_busy(call *in) {
    ((robot *)in->object)->busy = in->numbers[0] != 0.0;
    return 1;
}

/* interrupted(id): stop the robot if the waiting method did not reach its end. Only if this object
 * drives: otherwise it would take the robot from the program that drives it. */
static int interrupt(call *in) {
    robot *r = in->object;
    if (r->busy && robot_is_open(r)) {
        uint64_t now_us;
        roburoc4_client *client = robot_lock(r, &now_us);
        const roburoc4_facts facts = client_facts(client, now_us);
        if (facts.driving || facts.stopping) {
            roburoc4_result ignored = roburoc4_client_stop(client, now_us);
            (void)ignored;
        }
        robot_unlock(r);
        r->busy = 0;
    }
    return 1;
}

/* living(): how many robots and simulators there are */
static int count_living(call *in) {
    answer_number(&in->out, "robots", handles_count(HANDLE_ROBOT));
    answer_number(&in->out, "simulators", handles_count(HANDLE_SIMULATOR));
    return 1;
}

/* clang-format off */
#define SETTINGS                                                                                   \
    OPTIONS, WHOLE("buffer", ROBUROC4_PUMP_QUEUE_MIN, ROBUROC4_PUMP_QUEUE_MAX), TEXT("record")

const command robot_life_commands[] = {
    {"open", NO_ID, NUMBER, open_robot, {TEXT("address"), SETTINGS}},
    {"simConnect", SIMULATOR, NUMBER, open_robot, {SETTINGS}},
    {"close", ANY_ROBOT, NOTHING, close_one, {NONE}},
    {"leave", ANY_ROBOT, FLAG, leave, {NONE}},
    {"now", READ_ROBOT, NUMBER, read_time, {NONE}},
    {"progress", READ_ROBOT, STRUCT, read_progress, {NONE}},
    {"wait", WAIT_ROBOT, NUMBER, wait, {WITHIN("seconds", 0, LONGEST_WAIT_S)}},
    {"busy", READ_ROBOT, NOTHING, set_busy, {SWITCH("busy")}},
    {"living", NO_ID, STRUCT, count_living, {NONE}},
    {"interrupted", ANY_ROBOT, NOTHING, interrupt, {NONE}},
    LAST,
};
/* clang-format on */
