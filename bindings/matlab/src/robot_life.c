/* SPDX-License-Identifier: MIT
 *
 * Commands that open, wait for and close robots.
 */
#include <math.h>

#include "commands.h"
#include "fail.h"

/* open(address, options): id */
static int open_robot(call *in) {
    char address[TEXT_SIZE];
    robot_settings settings;
    return take_text(in->arguments[0], "address", address) &&
           settings_of_robot(in->arguments[1], &settings) &&
           (in->number = robot_open(address, &settings)) != 0.0;
}

/* close(id): delete() can be called twice */
static int close_one(call *in) {
    if (in->object != NULL) {
        robot_close(in->object);
    }
    return 1;
}

/* leave(id): disarm; true while the stop sequence runs */
static int leave(call *in) {
    robot *r = in->object;
    if (r != NULL && robot_is_open(r)) {
        robot_disarm(r);
        in->number = robot_facts(r).stopping;
    }
    return 1;
}

/* -------------------------------------------------------------------------------- waiting --- */

static uint32_t count(const call *in, uint32_t counter) {
    return roburoc4_client_count(in->client, counter);
}

/* progress(id): the progress of a robot that is not ready */
static int read_progress(call *in) {
    roburoc4_link link = {.size = sizeof link};
    robot *r = in->object;
    const uint32_t state = roburoc4_client_state(in->client);
    char address[ROBUROC4_ADDRESS_TEXT_SIZE];
    const uint32_t fault = robot_socket(r, address);
    (void)roburoc4_client_link(in->client, in->now_us, &link);
    if (state > r->furthest && state <= ROBUROC4_STATE_READY) {
        r->furthest = state;
        r->furthest_us = in->now_us;
    }
    answer_flag(&in->out, "ready", state == ROBUROC4_STATE_READY);
    answer_add(&in->out, "state", make_text(roburoc4_name(ROBUROC4_NAME_STATE, state)));
    answer_add(&in->out, "address", make_text(address));
    answer_number(&in->out, "open_s", (double)(in->now_us - r->opened_us) / 1e6);
    answer_number(&in->out, "standstill_s", (double)(in->now_us - r->furthest_us) / 1e6);
    answer_number(&in->out, "silence_s", link.silence_us / 1e6);
    answer_number(&in->out, "sent", count(in, ROBUROC4_COUNT_SENT));
    answer_number(&in->out, "received", count(in, ROBUROC4_COUNT_RECEIVED));
    answer_number(&in->out, "refused", count(in, ROBUROC4_COUNT_REFUSED));
    answer_add(&in->out, "fault", make_text(fault != 0 ? roburoc4_udp_fault_text(fault) : ""));
    return 1;
}

/* now(id): seconds on the robot's clock */
static int read_time(call *in) {
    const robot *r = in->object;
    in->number = (double)(robot_now_us(r) - r->opened_us) / 1e6;
    return 1;
}

/* wait(id, seconds): seconds on the robot's clock afterwards */
static int wait(call *in) {
    double seconds;
    if (!take_range(in->arguments[0], "seconds", 0.0, LONGEST_WAIT_S, &seconds)) {
        return 0;
    }
    /* Rounded up, because a caller that waits for the rest of a rounded time would never finish. */
    robot_wait(in->object, (uint32_t)ceil(seconds * 1e6));
    return read_time(in);
}

/* lease(id): duration of a drive command in seconds */
static int read_lease(call *in) {
    in->number = ((const robot *)in->object)->lease_us / 1e6;
    return 1;
}

/* busy(id, on): a waiting method starts, or reached its end */
static int set_busy(call *in) {
    return take_flag(in->arguments[0], "busy", &((robot *)in->object)->busy);
}

/* interrupted(id): stop the robot if the waiting method did not reach its end. Only if this object
 * drives: otherwise it would take the robot from the program that drives it. */
static int interrupt(call *in) {
    robot *r = in->object;
    if (r != NULL && r->busy && robot_is_open(r)) {
        const roburoc4_facts facts = robot_facts(r);
        r->busy = 0;
        if (facts.driving || facts.stopping) {
            uint64_t now_us;
            roburoc4_client *client = robot_lock(r, &now_us);
            (void)roburoc4_client_stop(client, now_us);
            robot_unlock(r);
        }
    }
    return 1;
}

const command robot_life_commands[] = {
    {"open", NO_ID, 2, NUMBER, open_robot},
    {"close", ANY_ROBOT, 0, NOTHING, close_one},
    {"leave", ANY_ROBOT, 0, FLAG, leave},
    {"now", READ_ROBOT, 0, NUMBER, read_time},
    {"progress", READ_ROBOT, 0, STRUCT, read_progress},
    {"wait", WAIT_ROBOT, 1, NUMBER, wait},
    {"lease", READ_ROBOT, 0, NUMBER, read_lease},
    {"busy", READ_ROBOT, 1, NOTHING, set_busy},
    {"interrupted", ANY_ROBOT, 0, NOTHING, interrupt},
    {NULL, NO_ID, 0, NOTHING, NULL},
};
