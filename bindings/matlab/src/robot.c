/* SPDX-License-Identifier: MIT */
#include "robot.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fail.h"
#include "handles.h"

/* The most that is recorded: 200 bytes each. */
#define SAMPLES_MAX 4000000u

/* ----------------------------------------------------------------------------------- life --- */

static int resolve(const char *text, roburoc4_address *out) {
    roburoc4_result result = roburoc4_udp_resolve(text, 0, out);
    if (result == ROBUROC4_ERR_ARGUMENT) {
        return fail(FAIL_ARGUMENT,
                    "'%s' is not an address; give HOST or HOST:PORT, such as 192.168.0.2:60000",
                    text);
    }
    return result < 0 ? fail_result(text, result) : 1;
}

/* Returns 1, also if nothing is to be recorded. */
static int open_recorder(robot *made, const char *name, const roburoc4_address *address,
                         const robot_settings *settings) {
    roburoc4_recorder_options how = {.size = sizeof how, .robot = name};
    if (settings->record[0] == '\0') {
        return 1;
    }
    if (address == NULL) {
        return fail(FAIL_ARGUMENT, "record: there are no datagrams in virtual time; give the "
                                   "simulator a port, and connect to that");
    }
    made->recorder = roburoc4_recorder_open(settings->record, &how, NULL);
    return made->recorder != NULL ||
           fail(FAIL_ARGUMENT, "record: %s: %s", settings->record, strerror(errno));
}

/* A robot with a pump; without an address, in virtual time. */
static robot *make(const char *name, const roburoc4_address *address,
                   const robot_settings *settings) {
    roburoc4_result result;
    robot *made = calloc(1, sizeof *made);
    if (made == NULL) {
        (void)fail(FAIL_LIMIT, "there is no memory for another robot");
        return NULL;
    }
    if (!open_recorder(made, name, address, settings)) {
        free(made);
        return NULL;
    }
    made->pump =
        roburoc4_pump_create(address, &settings->config, settings->buffer, made->recorder, &result);
    if (made->pump == NULL) {
        (void)roburoc4_recorder_close(made->recorder, NULL);
        (void)fail(FAIL_NETWORK, "%s: %s (%s)", name, roburoc4_result_text(result),
                   strerror(errno));
        free(made);
        return NULL;
    }
    made->lease_us = settings->config.lease_ms * 1000;
    made->fresh_us = settings->config.fresh_ms * 1000;
    return made;
}

/* Add it to the table and return its id. NULL: it could not be made. */
static double enter(robot *made) {
    double id = 0.0;
    if (made != NULL) {
        made->opened_us = made->furthest_us = robot_now_us(made);
        id = handles_add(HANDLE_ROBOT, made);
    }
    if (made != NULL && id == 0.0) {
        robot_close(made);
    }
    return id;
}

double robot_open(const char *address, const robot_settings *settings) {
    roburoc4_address numbers;
    return enter(resolve(address, &numbers) ? make(address, &numbers, settings) : NULL);
}

double robot_join(simulation *world, const robot_settings *settings) {
    robot *made = make("the simulator", NULL, settings);
    if (made == NULL) {
        return 0.0;
    }
    made->simulated = 1;
    if (simulation_join(world, made->pump) < 0) {
        robot_close(made);
        return fail(FAIL_LIMIT, "a simulator has room for %d robots; delete one",
                    ROBUROC4_WORLD_MAX_CLIENTS);
    }
    made->world = world;
    return enter(made);
}

void robot_close(robot *r) {
    handles_remove(r);
    if (r->world != NULL) {
        robot_disarm(r);
        simulation_part(r->world, r->pump);
    }
    roburoc4_pump_destroy(r->pump);
    (void)roburoc4_recorder_close(r->recorder, NULL);
    recording_end(&r->logged);
    recording_end(&r->recorded);
    free(r);
}

void robots_close(void) {
    robot *r;
    for (uint32_t place = 0; place < HANDLES_MAX; place++) {
        r = handles_at(HANDLE_ROBOT, place);
        if (r != NULL && robot_is_open(r)) {
            robot_disarm(r);
        }
    }
    for (uint32_t place = 0; place < HANDLES_MAX; place++) {
        r = handles_at(HANDLE_ROBOT, place);
        if (r != NULL) {
            robot_close(r);
        }
    }
}

int robot_is_open(const robot *r) {
    return roburoc4_pump_running(r->pump) && (!r->simulated || r->world != NULL);
}

int robot_can(const robot *r, int be_commanded) {
    if (!roburoc4_pump_running(r->pump)) {
        return fail(FAIL_CLOSED, "this robot belongs to the process before a fork; make a new one");
    }
    return robot_is_open(r) || !be_commanded ||
           fail(FAIL_CLOSED, "the simulator of this robot was deleted; make a new one");
}

void robots_lose(const simulation *world) {
    for (uint32_t place = 0; place < HANDLES_MAX; place++) {
        robot *r = handles_at(HANDLE_ROBOT, place);
        if (r != NULL && r->world == world) {
            r->left_us = robot_now_us(r);
            r->world = NULL;
        }
    }
}

/* ------------------------------------------------------------------------- time and client --- */

uint64_t robot_now_us(const robot *r) {
    if (!r->simulated) {
        return roburoc4_udp_now_us();
    }
    return r->world != NULL ? simulation_now_us(r->world) : r->left_us;
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

void robot_wait(robot *r, uint32_t duration_us) {
    const roburoc4_pump_reader nothing = {0};
    if (r->world != NULL) {
        simulation_run(r->world, robot_now_us(r) + duration_us);
    } else {
        (void)roburoc4_pump_wait_events(r->pump, &nothing, 0, duration_us);
    }
}

void robot_wait_sample(robot *r, const roburoc4_pump_reader *reader, uint64_t until_us) {
    const uint64_t now_us = robot_now_us(r);
    if (r->world != NULL) {
        simulation_run(r->world, now_us + ROBUROC4_CYCLE_US);
    } else if (now_us < until_us) {
        (void)roburoc4_pump_wait_samples(r->pump, reader, (uint32_t)(until_us - now_us));
    }
}

roburoc4_facts client_facts(const roburoc4_client *client, uint64_t now_us) {
    roburoc4_facts facts = {.size = sizeof facts};
    (void)roburoc4_client_facts(client, now_us, &facts);
    return facts;
}

roburoc4_facts robot_facts(robot *r) {
    uint64_t now_us;
    const roburoc4_client *client = robot_copy(r, &now_us);
    return client_facts(client, now_us);
}

uint32_t channel_count(const roburoc4_client *client, uint32_t io_type) {
    roburoc4_iocard_properties card = {0};
    (void)roburoc4_client_iocard_properties(client, &card);
    return (uint32_t)(io_type == ROBUROC4_IO_ANALOG_INPUT    ? card.analog_inputs
                      : io_type == ROBUROC4_IO_ANALOG_OUTPUT ? card.analog_outputs
                      : io_type == ROBUROC4_IO_DIGITAL_INPUT ? card.digital_inputs
                                                             : card.digital_outputs);
}

void robot_disarm(robot *r) {
    uint64_t now_us;
    roburoc4_client *client = robot_lock(r, &now_us);
    (void)roburoc4_client_disarm(client, now_us);
    robot_unlock(r);
}

uint32_t robot_socket(robot *r, char address[ROBUROC4_ADDRESS_TEXT_SIZE]) {
    const roburoc4_udp *udp;
    uint32_t fault;
    (void)roburoc4_pump_lock(r->pump);
    udp = roburoc4_pump_udp(r->pump);
    fault = udp->fault;
    if (roburoc4_udp_address_text(&udp->address, address, ROBUROC4_ADDRESS_TEXT_SIZE) < 0) {
        (void)snprintf(address, ROBUROC4_ADDRESS_TEXT_SIZE, "the simulator");
    }
    roburoc4_pump_unlock(r->pump);
    return fault;
}

void robot_texts(robot *r, uint32_t io_type, uint32_t count, channel_texts out) {
    for (uint32_t i = 0; i < count; i++) {
        if (roburoc4_pump_description(r->pump, (int32_t)io_type, i, out[i], CHANNEL_TEXT) < 0) {
            out[i][0] = '\0';
        }
    }
}

int recording_go_on(recording *rec, roburoc4_pump *pump) {
    const roburoc4_result waiting = roburoc4_pump_wait_samples(pump, &rec->reader, 0);
    const uint32_t needed = rec->list.count + (waiting > 0 ? (uint32_t)waiting : 0);
    roburoc4_result got;
    if (needed > rec->list.capacity) {
        void *bigger = needed <= SAMPLES_MAX
                           ? realloc(rec->list.samples, 2 * needed * sizeof(roburoc4_sample))
                           : NULL;
        if (bigger == NULL) {
            return fail(FAIL_LIMIT, "there is no room for more than %lu statuses; record less long",
                        (unsigned long)rec->list.count);
        }
        rec->list.samples = bigger;
        rec->list.capacity = 2 * needed;
    }
    got = roburoc4_pump_read_samples(pump, &rec->reader, rec->list.samples + rec->list.count,
                                     needed - rec->list.count);
    rec->list.count += got > 0 ? (uint32_t)got : 0;
    return 1;
}

void recording_end(recording *rec) {
    free(rec->list.samples);
    memset(&rec->list, 0, sizeof rec->list);
    rec->reader.lost = 0;
}
