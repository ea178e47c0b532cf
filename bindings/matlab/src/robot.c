/* SPDX-License-Identifier: MIT */
#include "robot.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fail.h"

/* Samples taken at a time. */
#define CHUNK 256u

/* -------------------------------------------------------------------------------------- life ---
 */

static robot *make(const robot_settings *settings) {
    robot *made = calloc(1, sizeof *made);
    if (made == NULL) {
        (void)fail(FAIL_LIMIT, "no memory for another robot");
        return NULL;
    }
    made->lease_us = settings->config.lease_ms * 1000;
    made->fresh_us = settings->config.fresh_ms * 1000;
    return made;
}

static roburoc4_result resolve(const char *text, roburoc4_address *out) {
    roburoc4_result result = roburoc4_udp_resolve(text, 0, out);
    if (result == ROBUROC4_ERR_ARGUMENT) {
        (void)fail(FAIL_ARGUMENT,
                   "'%s' is no address: give HOST or HOST:PORT, such as 192.168.0.2:60000", text);
    } else if (result < 0) {
        (void)fail_result(text, result);
    }
    return result;
}

robot *robot_open(const char *address, const robot_settings *settings) {
    roburoc4_address numbers;
    roburoc4_result result;
    robot *made;
    if (resolve(address, &numbers) < 0) {
        return NULL;
    }
    made = make(settings);
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
    made->opened_us = made->furthest_us = robot_now_us(made);
    return made;
}

robot *robot_join(world *home, const robot_settings *settings) {
    robot *made = make(settings);
    if (made == NULL) {
        return NULL;
    }
    made->client = world_join(home, &settings->config, settings->buffer);
    if (made->client == NULL) {
        (void)fail(FAIL_LIMIT, "a simulator has room for %d robots: delete one", WORLD_CLIENTS);
        free(made);
        return NULL;
    }
    made->opened_us = made->furthest_us = robot_now_us(made);
    return made;
}

void robot_close(robot *one) {
    if (one->pump != NULL) {
        roburoc4_pump_destroy(one->pump);
    } else {
        (void)roburoc4_client_disarm(&one->client->client, robot_now_us(one));
        world_exchange(one->client->home);
        world_leave(one->client);
    }
    samples_free(&one->recording);
    free(one);
}

int robot_is_open(robot *one) {
    return one->pump != NULL ? roburoc4_pump_running(one->pump) : !one->client->home->closed;
}

uint64_t robot_now_us(const robot *one) {
    return one->pump != NULL ? roburoc4_udp_now_us() : one->client->home->now_us;
}

roburoc4_client *robot_lock(robot *one) {
    return one->pump != NULL ? roburoc4_pump_lock(one->pump) : &one->client->client;
}

void robot_unlock(robot *one) {
    if (one->pump != NULL) {
        roburoc4_pump_unlock(one->pump);
    } else {
        world_exchange(one->client->home);
    }
}

void robot_wait(robot *one, uint32_t duration_us) {
    roburoc4_pump_reader nothing = {0};
    if (one->pump != NULL) {
        (void)roburoc4_pump_wait_events(one->pump, &nothing, 0, duration_us);
    } else {
        world_run(one->client->home, duration_us);
    }
}

int robot_is_stopping(robot *one) {
    roburoc4_facts facts = {.size = sizeof facts};
    return robot_is_open(one) && robot_facts(one, &facts) == ROBUROC4_OK && facts.stopping;
}

int robot_is_driving(robot *one) {
    roburoc4_facts facts = {.size = sizeof facts};
    return robot_facts(one, &facts) == ROBUROC4_OK && (facts.driving || facts.stopping);
}

/* --------------------------------------------------------------------------------- the client ---
 */

/* What `call`, which uses `client`, returns: made between lock and unlock. */
#define RETURN_LOCKED(type, call)                                                                  \
    do {                                                                                           \
        roburoc4_client *client = robot_lock(one);                                                 \
        type returned = (call);                                                                    \
        robot_unlock(one);                                                                         \
        return returned;                                                                           \
    } while (0)

roburoc4_result robot_arm(robot *one) {
    if (!robot_is_open(one)) {
        return ROBUROC4_ERR_CLOSED;
    }
    RETURN_LOCKED(roburoc4_result, roburoc4_client_arm(client, robot_now_us(one)));
}

roburoc4_result robot_disarm(robot *one) {
    if (!robot_is_open(one)) {
        return ROBUROC4_ERR_CLOSED;
    }
    RETURN_LOCKED(roburoc4_result, roburoc4_client_disarm(client, robot_now_us(one)));
}

roburoc4_result robot_stop(robot *one) {
    if (!robot_is_open(one)) {
        return ROBUROC4_ERR_CLOSED;
    }
    RETURN_LOCKED(roburoc4_result, roburoc4_client_stop(client, robot_now_us(one)));
}

roburoc4_result robot_drive(robot *one, float linear_m_s, float angular_rad_s) {
    if (!robot_is_open(one)) {
        return ROBUROC4_ERR_CLOSED;
    }
    RETURN_LOCKED(roburoc4_result,
                  roburoc4_client_drive(client, linear_m_s, angular_rad_s, 0, robot_now_us(one)));
}

roburoc4_result robot_set_digital_output(robot *one, uint32_t index, int32_t on) {
    if (!robot_is_open(one)) {
        return ROBUROC4_ERR_CLOSED;
    }
    RETURN_LOCKED(roburoc4_result, index < 64 ? roburoc4_client_set_digital_outputs(
                                                    client, (uint64_t)1 << index,
                                                    (uint64_t)(on != 0) << index, robot_now_us(one))
                                              : ROBUROC4_ERR_INDEX);
}

roburoc4_result robot_set_analog_output(robot *one, uint32_t index, float value) {
    if (!robot_is_open(one)) {
        return ROBUROC4_ERR_CLOSED;
    }
    RETURN_LOCKED(roburoc4_result,
                  roburoc4_client_set_analog_output(client, index, value, robot_now_us(one)));
}

roburoc4_result robot_relocalize(robot *one, double x_m, double y_m, double theta_rad) {
    if (!robot_is_open(one)) {
        return ROBUROC4_ERR_CLOSED;
    }
    RETURN_LOCKED(roburoc4_result,
                  roburoc4_client_relocalize(client, x_m, y_m, theta_rad, robot_now_us(one)));
}

roburoc4_result robot_subscribe(robot *one, uint32_t service, uint32_t period_ms) {
    if (!robot_is_open(one)) {
        return ROBUROC4_ERR_CLOSED;
    }
    RETURN_LOCKED(roburoc4_result,
                  period_ms == 0
                      ? roburoc4_client_unsubscribe(client, service, robot_now_us(one))
                      : roburoc4_client_subscribe(client, service, period_ms, robot_now_us(one)));
}

uint32_t robot_state(robot *one) {
    RETURN_LOCKED(uint32_t, roburoc4_client_state(client));
}

uint32_t robot_count(robot *one, uint32_t counter) {
    RETURN_LOCKED(uint32_t, roburoc4_client_count(client, counter));
}

uint32_t robot_fault(robot *one) {
    uint32_t fault = ROBUROC4_FAULT_NONE;
    if (one->pump != NULL) {
        (void)roburoc4_pump_lock(one->pump);
        fault = roburoc4_udp_fault(roburoc4_pump_udp(one->pump));
        roburoc4_pump_unlock(one->pump);
    }
    return fault;
}

void robot_address_text(robot *one, char *text, size_t capacity) {
    roburoc4_address address;
    (void)snprintf(text, capacity, "the simulator");
    if (one->pump != NULL) {
        (void)roburoc4_pump_lock(one->pump);
        (void)roburoc4_udp_address(roburoc4_pump_udp(one->pump), &address);
        roburoc4_pump_unlock(one->pump);
        (void)roburoc4_udp_address_text(&address, text, capacity);
    }
}

roburoc4_result robot_facts(robot *one, roburoc4_facts *out) {
    RETURN_LOCKED(roburoc4_result, roburoc4_client_facts(client, robot_now_us(one), out));
}

roburoc4_result robot_link(robot *one, roburoc4_link *out) {
    RETURN_LOCKED(roburoc4_result, roburoc4_client_link(client, robot_now_us(one), out));
}

roburoc4_result robot_service_link(robot *one, uint32_t service, roburoc4_service_link *out) {
    RETURN_LOCKED(roburoc4_result,
                  roburoc4_client_service_link(client, service, robot_now_us(one), out));
}

uint32_t robot_service_count(robot *one) {
    RETURN_LOCKED(uint32_t, roburoc4_client_service_count(client));
}

roburoc4_result robot_service_at(robot *one, uint32_t index, roburoc4_directory_entry *out) {
    RETURN_LOCKED(roburoc4_result, roburoc4_client_service_at(client, index, out));
}

roburoc4_result robot_iocard_properties(robot *one, roburoc4_iocard_properties *out) {
    RETURN_LOCKED(roburoc4_result, roburoc4_client_iocard_properties(client, out));
}

roburoc4_result robot_battery_properties(robot *one, roburoc4_battery_properties *out) {
    RETURN_LOCKED(roburoc4_result, roburoc4_client_battery_properties(client, out));
}

roburoc4_result robot_localization_properties(robot *one, roburoc4_localization_properties *out) {
    RETURN_LOCKED(roburoc4_result, roburoc4_client_localization_properties(client, out));
}

roburoc4_result robot_differential_properties(robot *one, roburoc4_differential_properties *out) {
    RETURN_LOCKED(roburoc4_result, roburoc4_client_differential_properties(client, out));
}

uint32_t robot_telemeter_count(robot *one) {
    RETURN_LOCKED(uint32_t, roburoc4_client_telemeter_count(client));
}

roburoc4_result robot_telemeter(robot *one, uint32_t index, roburoc4_telemeter *out) {
    RETURN_LOCKED(roburoc4_result, roburoc4_client_telemeter(client, index, out));
}

roburoc4_result robot_role_index(robot *one, uint32_t role) {
    RETURN_LOCKED(roburoc4_result, roburoc4_client_role_index(client, role));
}

roburoc4_result robot_description(robot *one, int32_t io_type, uint32_t index, char *buffer,
                                  size_t capacity) {
    return one->pump != NULL
               ? roburoc4_pump_description(one->pump, io_type, index, buffer, capacity)
               : ROBUROC4_ERR_UNKNOWN;
}

roburoc4_result robot_battery(robot *one, roburoc4_battery_status *out, uint64_t *host_us) {
    RETURN_LOCKED(roburoc4_result, roburoc4_client_battery(client, out, host_us));
}

roburoc4_result robot_localization(robot *one, roburoc4_localization_status *out,
                                   uint64_t *host_us) {
    RETURN_LOCKED(roburoc4_result, roburoc4_client_localization(client, out, host_us));
}

roburoc4_result robot_differential(robot *one, roburoc4_differential_status *out,
                                   uint64_t *host_us) {
    RETURN_LOCKED(roburoc4_result, roburoc4_client_differential(client, out, host_us));
}

roburoc4_result robot_inputs(robot *one, roburoc4_inputs *out, uint64_t *host_us) {
    RETURN_LOCKED(roburoc4_result, roburoc4_client_inputs(client, out, host_us));
}

roburoc4_result robot_distances(robot *one, roburoc4_distances *out, uint64_t *host_us) {
    RETURN_LOCKED(roburoc4_result, roburoc4_client_distances(client, out, host_us));
}

/* ----------------------------------------------------------------------------------- samples ---
 */

void robot_begin_reading(robot *one, roburoc4_pump_reader *reader) {
    if (one->pump != NULL) {
        (void)roburoc4_pump_reader_init(one->pump, reader);
    } else {
        reader->next_sample = one->client->ring.next;
        reader->lost = 0;
    }
}

int robot_drain(robot *one, roburoc4_pump_reader *reader, sample_list *list) {
    roburoc4_result got;
    do {
        roburoc4_sample *end = samples_reserve(list, CHUNK);
        if (end == NULL) {
            return fail(FAIL_LIMIT, "no room for more than %lu statuses: record for less long",
                        (unsigned long)list->count);
        }
        got = one->pump != NULL ? roburoc4_pump_read_samples(one->pump, reader, end, CHUNK)
                                : samples_read(&one->client->ring, reader, end, CHUNK);
        list->count += got > 0 ? (uint32_t)got : 0;
    } while (got > 0);
    return 1;
}
