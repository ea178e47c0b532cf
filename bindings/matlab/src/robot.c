/* SPDX-License-Identifier: MIT */
#include "robot.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "handles.h"
#include "os.h"

/* ------------------------------------------------------------------------------ lifecycle --- */

static int resolve(const char *text, roburoc4_address *out) {
    return done(text, roburoc4_udp_resolve(text, 0, out));
}

/* Returns 1, also if nothing is to be recorded. */
static int open_recorder(robot *made, const char *address, const char *path) {
    const roburoc4_recorder_options how = {.size = sizeof how, .robot = address};
    if (path[0] == '\0') {
        return 1;
    }
    if (address == NULL) {
        return fail(FAIL_ARGUMENT, "record: there are no datagrams in virtual time; give the "
                                   "simulator a port, and connect to that");
    }
    made->recorder = roburoc4_recorder_open(path, &how, NULL);
    return made->recorder != NULL || fail(FAIL_ARGUMENT, "record: %s: %s", path, strerror(errno));
}

/* Returns 0 after noting why not; robot_close() ends what was begun. */
static int begin(robot *made, const char *address, simulation *world,
                 const robot_settings *settings) {
    roburoc4_result result;
    roburoc4_address numbers;
    if ((address != NULL && !resolve(address, &numbers)) ||
        !open_recorder(made, address, settings->record)) {
        return 0;
    }
    made->pump = roburoc4_pump_create(address != NULL ? &numbers : NULL, &settings->config,
                                      settings->buffer, made->recorder, &result);
    if (made->pump == NULL) {
        return fail(FAIL_NETWORK, "%s: %s (%s)", address != NULL ? address : "the simulator",
                    roburoc4_result_text(result), strerror(errno));
    }
    if (world != NULL && simulation_join(world, made->pump) < 0) {
        return fail(FAIL_LIMIT, "a simulator has room for %d robots; delete one",
                    ROBUROC4_WORLD_MAX_CLIENTS);
    }
    made->world = world;
    made->opened_us = made->logged.begin_us = robot_now_us(made);
    made->lease_us = settings->config.lease_ms * 1000;
    made->fresh_us = settings->config.fresh_ms * 1000;
    return 1;
}

double robot_open(const char *address, simulation *world, const robot_settings *settings) {
    robot *made = calloc(1, sizeof *made);
    double id = 0.0;
    if (made == NULL) {
        return fail(FAIL_LIMIT, "there is no memory for another robot");
    }
    if (begin(made, address, world, settings)) {
        id = handles_add(HANDLE_ROBOT, made);
    }
    if (id == 0.0) {
        robot_close(made);
    }
    return id;
}

void robot_close(void *closed) {
    robot *r = closed;
    handles_remove(r);
    if (r->world != NULL) {
        (void)robot_leave(r);
        simulation_part(r->world, r->pump);
    }
    roburoc4_pump_destroy(r->pump);
    (void)roburoc4_recorder_close(r->recorder, NULL);
    recording_end(&r->logged);
    recording_end(&r->recorded);
    free(r);
}

static void leave(void *r) {
    (void)robot_leave(r);
}

void robots_close(void) {
    handles_each(HANDLE_ROBOT, leave);
    handles_each(HANDLE_ROBOT, robot_close);
}

int robot_is_open(const robot *r) {
    return roburoc4_pump_running(r->pump) && (r->world == NULL || !simulation_stopped(r->world));
}

int robot_can(const robot *r, int be_commanded) {
    if (!roburoc4_pump_running(r->pump)) {
        return fail(FAIL_CLOSED, "this robot belongs to the process before a fork; make a new one");
    }
    return robot_is_open(r) || !be_commanded ||
           fail(FAIL_CLOSED, "the simulator of this robot was deleted; make a new one");
}

/* ------------------------------------------------------------------------- time and client --- */

uint64_t robot_now_us(const robot *r) {
    return r->world != NULL ? simulation_now_us(r->world) : roburoc4_udp_now_us();
}

uint64_t robot_utc_us(const robot *r) {
    return r->world != NULL ? 0 : roburoc4_os_calendar_us() - roburoc4_udp_now_us();
}

roburoc4_client *robot_lock(robot *r, uint64_t *now_us) {
    roburoc4_client *client = roburoc4_pump_lock(r->pump);
    /* With the lock held, so that time never goes back from one call to the next. */
    *now_us = robot_now_us(r);
    return client;
}

void robot_unlock(robot *r) {
    roburoc4_pump_unlock(r->pump);
    if (r->world != NULL) {
        simulation_exchange(r->world);
    }
}

roburoc4_client *robot_copy(robot *r, uint64_t *now_us) {
    static roburoc4_client copy;
    copy = *robot_lock(r, now_us);
    robot_unlock(r);
    return &copy;
}

void robot_wait(robot *r, uint32_t duration_us, const roburoc4_pump_reader *reader) {
    const roburoc4_pump_reader nothing = {0};
    if (r->world != NULL) {
        simulation_run(r->world, robot_now_us(r) + duration_us);
    } else if (reader != NULL) {
        (void)roburoc4_pump_wait_samples(r->pump, reader, duration_us);
    } else {
        (void)roburoc4_pump_wait_events(r->pump, &nothing, 0, duration_us);
    }
}

roburoc4_facts client_facts(const roburoc4_client *client, uint64_t now_us) {
    roburoc4_facts facts = {.size = sizeof facts};
    (void)roburoc4_client_facts(client, now_us, &facts);
    return facts;
}

roburoc4_facts robot_facts(const robot *r, const roburoc4_client *copy, uint64_t now_us) {
    roburoc4_facts facts = client_facts(copy, now_us);
    if (!robot_is_open(r)) {
        facts.state = ROBUROC4_STATE_IDLE;
        facts.armed = facts.driving = facts.stopping = 0;
        facts.disarm_cause = ROBUROC4_ERR_CLOSED;
        memset(facts.age_us, 0xFF, sizeof facts.age_us);
    }
    return facts;
}

int robot_leave(robot *r) {
    uint64_t now_us;
    int stopping = 0;
    if (robot_is_open(r)) {
        roburoc4_client *client = robot_lock(r, &now_us);
        if (client_facts(client, now_us).driving) {
            roburoc4_result ignored = roburoc4_client_stop(client, now_us);
            (void)ignored;
        }
        stopping = client_facts(client, now_us).stopping;
        robot_unlock(r);
    }
    return stopping;
}
