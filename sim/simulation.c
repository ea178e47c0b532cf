/* SPDX-License-Identifier: MIT */
#include "simulation.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>

#include "host.h"

/* A client of the world, and its pump, which collects what the client receives. */
typedef struct member {
    uint32_t number; /* in the world; 0: a free place */
    roburoc4_client *client;
    roburoc4_pump *pump;
} member;

struct simulation {
    roburoc4_world *world; /* in virtual time, or NULL */
    sim_host *host;        /* on a port, or NULL */
    roburoc4_sim *robot;   /* belongs to one of these */
    bool stopped, destroyed;
    member members[ROBUROC4_WORLD_MAX_CLIENTS];
};

/* ----------------------------------------------------------------------------- both of them --- */

simulation *simulation_in_world(const roburoc4_sim_config *config) {
    simulation *s = calloc(1, sizeof *s);
    if (s != NULL) {
        s->world = roburoc4_world_create(config);
    }
    if (s == NULL || s->world == NULL) {
        free(s);
        return NULL;
    }
    s->robot = roburoc4_world_robot(s->world);
    return s;
}

simulation *simulation_on_port(const roburoc4_sim_config *config, const char *address,
                               uint16_t port, int *error) {
    simulation *s = calloc(1, sizeof *s);
    *error = ENOMEM;
    if (s != NULL) {
        s->robot = roburoc4_sim_create(config);
    }
    if (s != NULL && s->robot != NULL) {
        s->host = sim_host_open(s->robot, address, port, error);
    }
    if (s == NULL || s->host == NULL) {
        roburoc4_sim_destroy(s != NULL ? s->robot : NULL);
        free(s);
        return NULL;
    }
    return s;
}

static void free_if_unused(simulation *s) {
    for (int i = 0; i < ROBUROC4_WORLD_MAX_CLIENTS; i++) {
        if (s->members[i].number != 0) {
            return;
        }
    }
    if (s->host != NULL) {
        sim_host_destroy(s->host);
    }
    roburoc4_world_destroy(s->world);
    free(s);
}

void simulation_destroy(simulation *s) {
    s->stopped = s->destroyed = true;
    free_if_unused(s);
}

uint16_t simulation_port(const simulation *s) {
    return s->host != NULL ? sim_host_port(s->host) : 0;
}

void simulation_stop(simulation *s) {
    s->stopped = true;
    if (s->host != NULL) {
        sim_host_stop(s->host);
    }
}

int simulation_stopped(const simulation *s) {
    return s->stopped;
}

roburoc4_sim *simulation_lock(simulation *s) {
    if (s->host != NULL) {
        sim_host_lock(s->host);
    }
    return s->robot;
}

void simulation_unlock(simulation *s) {
    if (s->host != NULL) {
        sim_host_unlock(s->host);
    }
}

roburoc4_result simulation_set_faults(simulation *s, const roburoc4_sim_faults *faults) {
    roburoc4_result result;
    (void)simulation_lock(s);
    result = s->host != NULL ? sim_host_set_faults(s->host, faults)
                             : roburoc4_world_set_faults(s->world, faults);
    simulation_unlock(s);
    return result;
}

/* ----------------------------------------------------------------------------- virtual time --- */

roburoc4_result simulation_join(simulation *s, roburoc4_pump *pump) {
    roburoc4_client *client = roburoc4_pump_lock(pump);
    const roburoc4_result number = roburoc4_world_join(s->world, client);
    roburoc4_pump_unlock(pump);
    if (number > 0) {
        member *free_place = s->members;
        while (free_place->number != 0) {
            free_place++; /* the world has as many places */
        }
        *free_place = (member){(uint32_t)number, client, pump};
        simulation_exchange(s);
    }
    return number;
}

void simulation_part(simulation *s, const roburoc4_pump *pump) {
    for (int i = 0; i < ROBUROC4_WORLD_MAX_CLIENTS; i++) {
        if (s->members[i].number != 0 && s->members[i].pump == pump) {
            roburoc4_world_leave(s->world, s->members[i].client);
            s->members[i].number = 0;
        }
    }
    if (s->destroyed) {
        free_if_unused(s);
    }
}

uint64_t simulation_now_us(const simulation *s) {
    return roburoc4_world_now_us(s->world);
}

int simulation_step(simulation *s, uint64_t until_us) {
    const uint8_t *datagram;
    size_t size;
    const uint32_t number = roburoc4_world_step(s->world, until_us, &datagram, &size);
    for (int i = 0; number != 0 && i < ROBUROC4_WORLD_MAX_CLIENTS; i++) {
        if (s->members[i].number == number && roburoc4_pump_lock(s->members[i].pump) != NULL) {
            roburoc4_pump_collect(s->members[i].pump, size > 0 ? datagram : NULL, size);
            roburoc4_pump_unlock(s->members[i].pump);
        }
    }
    return number != 0;
}

void simulation_run(simulation *s, uint64_t until_us) {
    while (!s->stopped && simulation_step(s, until_us)) {
    }
}

void simulation_exchange(simulation *s) {
    simulation_run(s, simulation_now_us(s));
}
