/* SPDX-License-Identifier: MIT */
#include "robot.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fail.h"
#include "handles.h"

/* Samples taken at a time. */
#define CHUNK 256u

/* ----------------------------------------------------------------------------------- life --- */

static robot *make(const robot_settings *settings) {
    robot *made = calloc(1, sizeof *made);
    if (made == NULL) {
        (void)fail(FAIL_LIMIT, "there is no memory for another robot");
        return NULL;
    }
    made->lease_us = settings->config.lease_ms * 1000;
    made->fresh_us = settings->config.fresh_ms * 1000;
    return made;
}

static robot *begin(robot *made) {
    made->opened_us = made->furthest_us = robot_now_us(made);
    return made;
}

static int resolve(const char *text, roburoc4_address *out) {
    roburoc4_result result = roburoc4_udp_resolve(text, 0, out);
    if (result == ROBUROC4_ERR_ARGUMENT) {
        return fail(FAIL_ARGUMENT,
                    "'%s' is not an address; give HOST or HOST:PORT, such as 192.168.0.2:60000",
                    text);
    }
    return result < 0 ? fail_result(text, result) : 1;
}

robot *robot_open(const char *address, const robot_settings *settings) {
    roburoc4_address numbers;
    roburoc4_result result;
    robot *made = resolve(address, &numbers) ? make(settings) : NULL;
    if (made == NULL) {
        return NULL;
    }
    made->pump = roburoc4_pump_create(&numbers, &settings->config, settings->buffer, &result);
    if (made->pump == NULL) {
        (void)fail(FAIL_NETWORK, "%s: %s (%s)", address, roburoc4_result_text(result),
                   strerror(errno));
        free(made);
        return NULL;
    }
    return begin(made);
}

static void free_simulated(virtual_robot *v) {
    if (v != NULL) {
        free(v->samples);
        free(v);
    }
}

/* NULL without memory, or where the world is full. */
static virtual_robot *join(roburoc4_world *world, const robot_settings *settings) {
    virtual_robot *v = calloc(1, sizeof *v);
    roburoc4_result number = ROBUROC4_ERR_SYSTEM;
    if (v == NULL) {
        return NULL;
    }
    v->world = world;
    v->capacity = settings->buffer;
    v->samples = calloc(v->capacity, sizeof *v->samples);
    if (v->samples != NULL &&
        roburoc4_client_init(&v->client, sizeof v->client, &settings->config) >= 0) {
        number = roburoc4_world_join(world, &v->client);
    }
    if (number < 0) {
        free_simulated(v);
        return NULL;
    }
    v->number = (uint32_t)number;
    return v;
}

robot *robot_join(roburoc4_world *world, const robot_settings *settings) {
    robot *made = make(settings);
    if (made == NULL) {
        return NULL;
    }
    made->simulated = join(world, settings);
    if (made->simulated == NULL) {
        (void)fail(FAIL_LIMIT, "a simulator has room for %d robots; delete one",
                   ROBUROC4_WORLD_CLIENTS);
        free(made);
        return NULL;
    }
    return begin(made);
}

void robot_close(robot *r) {
    if (r->pump != NULL) {
        roburoc4_pump_destroy(r->pump);
    } else if (r->simulated->world != NULL) {
        robot_disarm(r);
        roburoc4_world_leave(r->simulated->world, &r->simulated->client);
    }
    free_simulated(r->simulated);
    samples_free(&r->recording);
    free(r);
}

int robot_is_open(const robot *r) {
    return r->pump != NULL ? roburoc4_pump_running(r->pump) : r->simulated->world != NULL;
}

int robot_can(const robot *r, int be_commanded) {
    if (robot_is_open(r)) {
        return 1;
    }
    if (r->pump != NULL) {
        return fail(FAIL_CLOSED, "this robot belongs to the process before a fork; make a new one");
    }
    return !be_commanded ||
           fail(FAIL_CLOSED, "the simulator of this robot was deleted; make a new one");
}

/* ----------------------------------------------------------------------------- virtual time --- */

static void keep_text(virtual_robot *v, const uint8_t *datagram, size_t size) {
    roburoc4_description text;
    char *to;
    if (roburoc4_client_description(&v->client, datagram, size, &text) < 0 || text.io_type < 0 ||
        text.io_type >= CHANNEL_TYPES || text.index >= CHANNELS_MAX) {
        return;
    }
    to = v->texts[text.io_type][text.index];
    (void)snprintf(to, CHANNEL_TEXT, "%.*s", (int)text.length, (const char *)text.text);
}

/* Take the client's events, and what they announce. */
static void collect(virtual_robot *v, const uint8_t *datagram, size_t size) {
    const uint32_t events = roburoc4_client_take_events(&v->client);
    uint32_t i;
    for (i = 0; i < SERVICES; i++) {
        roburoc4_sample sample;
        if ((events & (uint32_t)ROBUROC4_EVENT_IOCARD << i) != 0 &&
            samples_latest(&v->client, FIRST_SERVICE + i, &sample)) {
            sample.sequence = v->next_sample;
            v->samples[v->next_sample++ % v->capacity] = sample;
        }
    }
    if ((events & ROBUROC4_EVENT_DESCRIPTION) != 0) {
        keep_text(v, datagram, size);
    }
}

/* The robot at a place of the table, if it is in this world. */
static virtual_robot *robot_in(const roburoc4_world *world, uint32_t place) {
    const robot *r = handles_at(HANDLE_ROBOT, place);
    return r != NULL && r->simulated != NULL && r->simulated->world == world ? r->simulated : NULL;
}

void robots_run(roburoc4_world *world, uint64_t until_us) {
    const uint8_t *datagram;
    size_t size;
    uint32_t number, place;
    while ((number = roburoc4_world_step(world, until_us, &datagram, &size)) != 0) {
        for (place = 0; place < HANDLES_MAX; place++) {
            virtual_robot *v = robot_in(world, place);
            if (v != NULL && v->number == number) {
                collect(v, datagram, size);
            }
        }
    }
}

void robots_lose(const roburoc4_world *world) {
    uint32_t place;
    for (place = 0; place < HANDLES_MAX; place++) {
        virtual_robot *v = robot_in(world, place);
        if (v != NULL) {
            v->now_us = roburoc4_world_now_us(world);
            v->world = NULL;
        }
    }
}

/* ------------------------------------------------------------------------- time and client --- */

uint64_t robot_now_us(const robot *r) {
    if (r->pump != NULL) {
        return roburoc4_udp_now_us();
    }
    return r->simulated->world != NULL ? roburoc4_world_now_us(r->simulated->world)
                                       : r->simulated->now_us;
}

roburoc4_client *robot_lock(robot *r, uint64_t *now_us) {
    roburoc4_client *client = r->pump != NULL ? roburoc4_pump_lock(r->pump) : &r->simulated->client;
    /* With the lock held, so that time never goes back from one call to the next. */
    *now_us = robot_now_us(r);
    return client;
}

void robot_unlock(robot *r) {
    if (r->pump != NULL) {
        roburoc4_pump_unlock(r->pump);
    } else if (r->simulated->world != NULL) {
        robots_run(r->simulated->world, robot_now_us(r));
    }
}

void robot_wait(robot *r, uint32_t duration_us) {
    const roburoc4_pump_reader nothing = {0};
    if (r->pump != NULL) {
        (void)roburoc4_pump_wait_events(r->pump, &nothing, 0, duration_us);
    } else {
        robots_run(r->simulated->world, robot_now_us(r) + duration_us);
    }
}

roburoc4_client *robot_copy(robot *r, uint64_t *now_us) {
    static roburoc4_client copy;
    copy = *robot_lock(r, now_us);
    robot_unlock(r);
    return &copy;
}

roburoc4_facts robot_facts(robot *r) {
    roburoc4_facts facts = {.size = sizeof facts};
    uint64_t now_us;
    const roburoc4_client *client = robot_copy(r, &now_us);
    (void)roburoc4_client_facts(client, now_us, &facts);
    return facts;
}

void robot_disarm(robot *r) {
    uint64_t now_us;
    roburoc4_client *client = robot_lock(r, &now_us);
    (void)roburoc4_client_disarm(client, now_us);
    robot_unlock(r);
}

uint32_t robot_fault(robot *r) {
    uint32_t fault = ROBUROC4_FAULT_NONE;
    if (r->pump != NULL) {
        (void)roburoc4_pump_lock(r->pump);
        fault = roburoc4_udp_fault(roburoc4_pump_udp(r->pump));
        roburoc4_pump_unlock(r->pump);
    }
    return fault;
}

void robot_address_text(robot *r, char *text, size_t capacity) {
    roburoc4_address address;
    (void)snprintf(text, capacity, "the simulator");
    if (r->pump != NULL) {
        (void)roburoc4_pump_lock(r->pump);
        (void)roburoc4_udp_address(roburoc4_pump_udp(r->pump), &address);
        roburoc4_pump_unlock(r->pump);
        (void)roburoc4_udp_address_text(&address, text, capacity);
    }
}

void robot_texts(robot *r, uint32_t io_type, channel_texts out) {
    uint32_t i;
    if (r->pump == NULL) {
        memcpy(out, r->simulated->texts[io_type], sizeof(channel_texts));
        return;
    }
    for (i = 0; i < CHANNELS_MAX; i++) {
        if (roburoc4_pump_description(r->pump, (int32_t)io_type, i, out[i], CHANNEL_TEXT) < 0) {
            out[i][0] = '\0';
        }
    }
}

/* -------------------------------------------------------------------------------- samples --- */

void robot_begin_reading(robot *r, roburoc4_pump_reader *reader) {
    if (r->pump != NULL) {
        (void)roburoc4_pump_reader_init(r->pump, reader);
    } else {
        reader->next_sample = r->simulated->next_sample;
        reader->lost = 0;
    }
}

/* What roburoc4_pump_read_samples() does. */
static roburoc4_result read_samples(const virtual_robot *v, roburoc4_pump_reader *reader,
                                    roburoc4_sample *samples, uint32_t capacity) {
    const uint64_t oldest = v->next_sample > v->capacity ? v->next_sample - v->capacity : 0;
    uint32_t copied = 0;
    if (reader->next_sample < oldest) {
        reader->lost += oldest - reader->next_sample;
        reader->next_sample = oldest;
    }
    while (copied < capacity && reader->next_sample < v->next_sample) {
        samples[copied++] = v->samples[reader->next_sample++ % v->capacity];
    }
    return (roburoc4_result)copied;
}

int robot_drain(robot *r, roburoc4_pump_reader *reader, sample_list *list) {
    roburoc4_result got;
    do {
        roburoc4_sample *end = samples_reserve(list, CHUNK);
        if (end == NULL) {
            return fail(FAIL_LIMIT, "there is no room for more than %lu statuses; record less long",
                        (unsigned long)list->count);
        }
        got = r->pump != NULL ? roburoc4_pump_read_samples(r->pump, reader, end, CHUNK)
                              : read_samples(r->simulated, reader, end, CHUNK);
        list->count += got > 0 ? (uint32_t)got : 0;
    } while (got > 0);
    return 1;
}
