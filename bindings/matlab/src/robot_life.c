/* SPDX-License-Identifier: MIT
 *
 * Commands that open, wait for and close robots.
 */
#include "commands.h"
#include "fail.h"

int fail_too_many(void) {
    return fail(FAIL_LIMIT, "there are %d robots and simulators; delete one", HANDLES_MAX);
}

int give_robot(const call *in, robot *made) {
    double id;
    if (made == NULL) {
        return 0;
    }
    id = handles_add(HANDLE_ROBOT, made);
    if (id == 0.0) {
        robot_close(made);
        return fail_too_many();
    }
    in->results[0] = mxCreateDoubleScalar(id);
    return 1;
}

/* open(address, options): id */
static int open_robot(const call *in) {
    char address[TEXT_SIZE];
    robot_settings settings;
    return take_text(in->arguments[0], "address", address) &&
           settings_of_robot(in->arguments[1], &settings) &&
           give_robot(in, robot_open(address, &settings));
}

/* close(id): delete() can be called twice */
static int close_one(const call *in) {
    if (in->object != NULL) {
        handles_remove(in->object);
        robot_close(in->object);
    }
    return 1;
}

/* leave(id): disarm; true while the stop sequence runs */
static int leave(const call *in) {
    robot *r = in->object;
    int stopping = 0;
    if (r != NULL && robot_is_open(r)) {
        robot_disarm(r);
        stopping = robot_facts(r).stopping;
    }
    in->results[0] = mxCreateLogicalScalar(stopping != 0);
    return 1;
}

void close_robots(void) {
    uint32_t place;
    for (place = 0; place < HANDLES_MAX; place++) {
        robot *r = handles_at(HANDLE_ROBOT, place);
        if (r != NULL && robot_is_open(r)) {
            robot_disarm(r);
        }
    }
    for (place = 0; place < HANDLES_MAX; place++) {
        robot *r = handles_at(HANDLE_ROBOT, place);
        if (r != NULL) {
            /* Objects may outlive this: their ids must find nothing. */
            handles_remove(r);
            robot_close(r);
        }
    }
}

/* -------------------------------------------------------------------------------- waiting --- */

static const char *what_to_check(robot *r, uint32_t received) {
    const uint32_t fault = robot_fault(r);
    if (fault != ROBUROC4_FAULT_NONE) {
        return roburoc4_udp_fault_text(fault);
    }
    return received == 0
               ? "check that the robot is on, the cable is in, this machine has an address in the "
                 "robot's network, and no firewall drops UDP"
               : "something answers there; check that it is a RobuROC4, and look at link";
}

static int fail_silent(robot *r, const roburoc4_client *client, double timeout_s) {
    char address[ROBUROC4_ADDRESS_TEXT_SIZE];
    const uint32_t received = roburoc4_client_count(client, ROBUROC4_COUNT_RECEIVED);
    robot_address_text(r, address, sizeof address);
    return fail(FAIL_TIMEOUT,
                "no answer from %s for %g s (state %s, %lu datagrams sent, %lu received): %s",
                address, timeout_s, roburoc4_state_name(roburoc4_client_state(client)),
                (unsigned long)roburoc4_client_count(client, ROBUROC4_COUNT_SENT),
                (unsigned long)received, what_to_check(r, received));
}

static int fail_refused(robot *r, const roburoc4_client *client, double timeout_s) {
    char address[ROBUROC4_ADDRESS_TEXT_SIZE];
    robot_address_text(r, address, sizeof address);
    return fail(FAIL_TIMEOUT,
                "%s is not ready: it answers, but refuses or leaves out what is needed (no "
                "progress for %g s, state %s, %lu datagrams received, %lu of them refusals); check "
                "that it is a RobuROC4 and that the network loses little, or give a longer timeout",
                address, timeout_s, roburoc4_state_name(roburoc4_client_state(client)),
                (unsigned long)roburoc4_client_count(client, ROBUROC4_COUNT_RECEIVED),
                (unsigned long)roburoc4_client_count(client, ROBUROC4_COUNT_REFUSED));
}

/* For how long nothing came from the robot. */
static double silence_s(const robot *r, const roburoc4_client *client, uint64_t now_us) {
    roburoc4_link link = {.size = sizeof link};
    const double open_s = (double)(now_us - r->opened_us) / 1e6;
    if (roburoc4_client_count(client, ROBUROC4_COUNT_RECEIVED) > 0 &&
        roburoc4_client_link(client, now_us, &link) >= 0 && link.silence_us / 1e6 < open_s) {
        return link.silence_us / 1e6;
    }
    return open_s;
}

/* For how long it came no nearer to ready. */
static double standstill_s(robot *r, uint32_t state, uint64_t now_us) {
    if (state > r->furthest && state <= ROBUROC4_STATE_READY) {
        r->furthest = state;
        r->furthest_us = now_us;
    }
    return (double)(now_us - r->furthest_us) / 1e6;
}

/* connected(id, timeout_s): true when ready; an error after so long a silence or standstill */
static int is_connected(const call *in) {
    robot *r = in->object;
    uint64_t now_us;
    const roburoc4_client *client = robot_copy(r, &now_us);
    const uint32_t state = roburoc4_client_state(client);
    double timeout_s;
    if (!take_range(in->arguments[0], "timeout", 0.0, 1e6, &timeout_s)) {
        return 0;
    }
    in->results[0] = mxCreateLogicalScalar(state == ROBUROC4_STATE_READY);
    if (state == ROBUROC4_STATE_READY) {
        return 1;
    }
    if (silence_s(r, client, now_us) >= timeout_s) {
        return fail_silent(r, client, timeout_s);
    }
    return standstill_s(r, state, now_us) < timeout_s || fail_refused(r, client, timeout_s);
}

/* now(id): seconds on the robot's clock */
static int look_time(const call *in) {
    const robot *r = in->object;
    in->results[0] = mxCreateDoubleScalar((double)(robot_now_us(r) - r->opened_us) / 1e6);
    return 1;
}

/* wait(id, seconds): seconds on the robot's clock afterwards */
static int wait(const call *in) {
    uint32_t duration_us;
    double seconds;
    if (!take_range(in->arguments[0], "seconds", 0.0, LONGEST_WAIT_S, &seconds)) {
        return 0;
    }
    duration_us = (uint32_t)(seconds * 1e6);
    /* Rounded up, or who waits for the rest of a rounded time waits forever. */
    robot_wait(in->object, duration_us + ((double)duration_us < seconds * 1e6));
    return look_time(in);
}

/* busy(id, on): a method that waits begins, or came to its end */
static int set_busy(const call *in) {
    return take_flag(in->arguments[0], "busy", &((robot *)in->object)->busy);
}

/* interrupted(id): stop the robot if the method that waits did not come to its end. Only where this
 * object drives: a monitor would take the robot from whoever does. */
static int interrupt(const call *in) {
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
    {"open", NO_ID, 2, open_robot},
    {"close", ANY_ROBOT, 0, close_one},
    {"leave", ANY_ROBOT, 0, leave},
    {"now", ROBOT, 0, look_time},
    {"connected", ROBOT, 1, is_connected},
    {"wait", OPEN_ROBOT, 1, wait},
    {"busy", ROBOT, 1, set_busy},
    {"interrupted", ANY_ROBOT, 0, interrupt},
    {NULL, NO_ID, 0, NULL},
};
