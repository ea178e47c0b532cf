/* SPDX-License-Identifier: MIT
 *
 * Commands that open, wait for and close robots.
 */
#include <string.h>

#include "answers.h"
#include "commands.h"
#include "fail.h"
#include "handles.h"

robot *told_robot(const call *told) {
    robot *found;
    double id;
    if (!take_number(told->arguments[0], "id", &id)) {
        return NULL;
    }
    found = handles_find(HANDLE_ROBOT, id);
    if (found == NULL) {
        (void)fail(FAIL_CLOSED, "this robot was deleted; make a new one with roburoc4.Robot");
    }
    return found;
}

int take_service(const mxArray *value, uint32_t *out) {
    char text[TEXT_SIZE];
    uint32_t service;
    if (!take_text(value, "service", text)) {
        return 0;
    }
    for (service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++) {
        if (strcmp(text, samples_service(service)) == 0) {
            *out = service;
            return 1;
        }
    }
    return fail(FAIL_ARGUMENT,
                "no service '%s' with statuses: give one of iocard, telemeter, "
                "battery, localization, differential",
                text);
}

int give_robot(const call *told, robot *made) {
    double id;
    if (made == NULL) {
        return 0;
    }
    id = handles_add(HANDLE_ROBOT, made);
    if (id == 0.0) {
        robot_close(made);
        return fail(FAIL_LIMIT, "%d robots and simulators live already: delete one", HANDLES_MAX);
    }
    told->results[0] = mxCreateDoubleScalar(id);
    return 1;
}

/* open(address, options): id */
static int open_robot(const call *told) {
    char address[TEXT_SIZE];
    robot_settings settings;
    return take_text(told->arguments[0], "address", address) &&
           settings_of_robot(told->arguments[1], &settings) &&
           give_robot(told, robot_open(address, &settings));
}

/* close(id): for an id that is closed already it does nothing, as delete() can be called twice. */
static int close_one(const call *told) {
    robot *one;
    double id;
    if (!take_number(told->arguments[0], "id", &id)) {
        return 0;
    }
    one = handles_find(HANDLE_ROBOT, id);
    if (one != NULL) {
        handles_remove(id);
        robot_close(one);
    }
    return 1;
}

/* leave(id): disarm; true while zeros are on their way */
static int leave(const call *told) {
    robot *one;
    double id;
    if (!take_number(told->arguments[0], "id", &id)) {
        return 0;
    }
    one = handles_find(HANDLE_ROBOT, id);
    if (one != NULL) {
        (void)robot_disarm(one);
    }
    told->results[0] = mxCreateLogicalScalar(one != NULL && robot_is_stopping(one));
    return 1;
}

void close_robots(void) {
    robot *one;
    uint32_t place;
    for (place = 0; place < HANDLES_MAX; place++) {
        one = handles_at(HANDLE_ROBOT, place);
        if (one != NULL) {
            (void)robot_disarm(one);
        }
    }
    for (place = 0; place < HANDLES_MAX; place++) {
        one = handles_at(HANDLE_ROBOT, place);
        if (one != NULL) {
            /* Objects may outlive this: their ids must find nothing. */
            handles_clear(place);
            robot_close(one);
        }
    }
}

/* ----------------------------------------------------------------------------------- waiting ---
 */

static const char *what_to_check(robot *one) {
    if (robot_fault(one) != ROBUROC4_FAULT_NONE) {
        return roburoc4_udp_fault_text(robot_fault(one));
    }
    if (robot_count(one, ROBUROC4_COUNT_RECEIVED) == 0) {
        return "check that the robot is on, the cable is in, this machine has an address in the "
               "robot's network, and no firewall drops UDP";
    }
    return "something answers there; check that it is a RobuROC4, and look at link";
}

static int fail_silent(robot *one, double timeout_s) {
    char address[ROBUROC4_ADDRESS_TEXT_SIZE];
    robot_address_text(one, address, sizeof address);
    return fail(FAIL_TIMEOUT,
                "no answer from %s for %g s (state %s, %lu datagrams sent, %lu received): %s",
                address, timeout_s, roburoc4_state_name(robot_state(one)),
                (unsigned long)robot_count(one, ROBUROC4_COUNT_SENT),
                (unsigned long)robot_count(one, ROBUROC4_COUNT_RECEIVED), what_to_check(one));
}

static int fail_refused(robot *one, double timeout_s) {
    char address[ROBUROC4_ADDRESS_TEXT_SIZE];
    robot_address_text(one, address, sizeof address);
    return fail(
        FAIL_TIMEOUT,
        "%s is not ready: it answers, but refuses or leaves out what is needed (no progress "
        "for %g s, state %s, %lu datagrams received, %lu of them refusals): check that it is "
        "a RobuROC4 and what the way to it loses, or give a longer timeout",
        address, timeout_s, roburoc4_state_name(robot_state(one)),
        (unsigned long)robot_count(one, ROBUROC4_COUNT_RECEIVED),
        (unsigned long)robot_count(one, ROBUROC4_COUNT_REFUSED));
}

/* For how long there was nothing from the robot. */
static double silence_s(robot *one) {
    roburoc4_link link = {.size = sizeof link};
    const double open_s = (double)(robot_now_us(one) - one->opened_us) / 1e6;
    if (robot_count(one, ROBUROC4_COUNT_RECEIVED) > 0 && robot_link(one, &link) == ROBUROC4_OK &&
        (double)link.silence_us / 1e6 < open_s) {
        return (double)link.silence_us / 1e6;
    }
    return open_s;
}

/* For how long it came no nearer to ready. */
static double standstill_s(robot *one) {
    const uint32_t state = robot_state(one);
    const uint64_t now_us = robot_now_us(one);
    if (state > one->furthest && state <= ROBUROC4_STATE_READY) {
        one->furthest = state;
        one->furthest_us = now_us;
    }
    return (double)(now_us - one->furthest_us) / 1e6;
}

/* connected(id, timeout_s): true when ready; an error after so long a silence or standstill */
static int is_connected(const call *told) {
    robot *one = told_robot(told);
    double timeout_s;
    if (one == NULL || !take_range(told->arguments[1], "timeout", 0.0, 1e6, &timeout_s)) {
        return 0;
    }
    told->results[0] = mxCreateLogicalScalar(robot_state(one) == ROBUROC4_STATE_READY);
    if (robot_state(one) == ROBUROC4_STATE_READY) {
        return 1;
    }
    if (silence_s(one) >= timeout_s) {
        return fail_silent(one, timeout_s);
    }
    return standstill_s(one) >= timeout_s ? fail_refused(one, timeout_s) : 1;
}

/* now(id): seconds on the robot's clock */
static int tell_time(const call *told) {
    robot *one = told_robot(told);
    if (one == NULL) {
        return 0;
    }
    told->results[0] = mxCreateDoubleScalar((double)(robot_now_us(one) - one->opened_us) / 1e6);
    return 1;
}

/* wait(id, seconds): seconds on the robot's clock afterwards */
static int pass_time(const call *told) {
    robot *one = told_robot(told);
    uint32_t duration_us;
    double seconds;
    if (one == NULL || !take_range(told->arguments[1], "seconds", 0.0, LONGEST_WAIT_S, &seconds)) {
        return 0;
    }
    if (!robot_is_open(one)) {
        return fail(FAIL_CLOSED, one->pump != NULL
                                     ? "the link of this robot was ended; make a new one"
                                     : "the simulator of this robot was deleted");
    }
    duration_us = (uint32_t)(seconds * 1e6);
    /* Rounded up, or who waits for the rest of a rounded time waits forever. */
    robot_wait(one, duration_us + ((double)duration_us < seconds * 1e6));
    return tell_time(told);
}

/* busy(id, on): a method that waits begins, or came to its end */
static int set_busy(const call *told) {
    robot *one = told_robot(told);
    return one != NULL && take_flag(told->arguments[1], "busy", &one->busy);
}

/* interrupted(id): stop the robot if the method that waits did not come to its end. Only where this
 * object drives: a monitor would take the robot from whoever does. */
static int interrupt(const call *told) {
    robot *one;
    double id;
    if (!take_number(told->arguments[0], "id", &id)) {
        return 0;
    }
    one = handles_find(HANDLE_ROBOT, id);
    if (one != NULL && one->busy) {
        one->busy = 0;
        if (robot_is_driving(one)) {
            (void)robot_stop(one);
        }
    }
    return 1;
}

const command robot_life_commands[] = {
    {"open", open_robot, 2}, {"close", close_one, 1},        {"leave", leave, 1},
    {"now", tell_time, 1},   {"connected", is_connected, 2}, {"wait", pass_time, 2},
    {"busy", set_busy, 2},   {"interrupted", interrupt, 1},  {NULL, NULL, 0},
};
