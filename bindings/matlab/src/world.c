/* SPDX-License-Identifier: MIT */
#include "world.h"

#include <stdlib.h>

#define START_US 1000000u
#define FLIGHTS 4096u
#define LONGEST 1472u
/* A step where somebody's deadline stays in the past. */
#define STUCK_US 1000u

/* ------------------------------------------------------------------------------ one client --- */

/* Take the client's events, and the samples that they tell of. */
static void collect(world_client *one) {
    uint32_t events = roburoc4_client_take_events(&one->client);
    uint32_t service;
    for (service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++) {
        uint32_t arrived = (uint32_t)ROBUROC4_EVENT_IOCARD << (service - ROBUROC4_SERVICE_IOCARD);
        if ((events & arrived) != 0) {
            samples_store(&one->ring, &one->client, service);
        }
    }
}

/* Send what is due, and give the simulator what has arrived; whether there was any. */
static int send(world_client *one, uint64_t peer) {
    world *home = one->home;
    uint8_t datagram[LONGEST];
    roburoc4_result size;
    uint64_t ignored;
    int moved = 0;
    while ((size = roburoc4_client_poll_transmit(&one->client, datagram, sizeof datagram,
                                                 home->now_us)) > 0) {
        roburoc4_sim_channel_push(one->up, peer, datagram, (size_t)size, home->now_us);
        moved = 1;
    }
    collect(one);
    while ((size = roburoc4_sim_channel_poll(one->up, home->now_us, &ignored, datagram,
                                             sizeof datagram)) > 0) {
        roburoc4_sim_receive(home->sim, peer, datagram, (size_t)size);
        moved = 1;
    }
    return moved;
}

/* Take in what has arrived; whether there was any. */
static int receive(world_client *one) {
    uint8_t datagram[LONGEST];
    roburoc4_result size;
    uint64_t ignored;
    int moved = 0;
    while ((size = roburoc4_sim_channel_poll(one->down, one->home->now_us, &ignored, datagram,
                                             sizeof datagram)) > 0) {
        (void)roburoc4_client_receive(&one->client, datagram, (size_t)size, one->home->now_us);
        collect(one);
        moved = 1;
    }
    return moved;
}

/* -------------------------------------------------------------------------------------- time ---
 */

static int send_from_robot(world *home) {
    uint8_t datagram[LONGEST];
    roburoc4_result size;
    uint64_t peer;
    int moved = 0;
    while ((size = roburoc4_sim_poll_transmit(home->sim, &peer, datagram, sizeof datagram)) > 0) {
        world_client *one = peer - 1 < WORLD_CLIENTS ? home->clients[peer - 1] : NULL;
        moved = 1;
        if (one != NULL) {
            roburoc4_sim_channel_push(one->down, peer, datagram, (size_t)size, home->now_us);
        }
    }
    return moved;
}

void world_exchange(world *home) {
    int moved = !home->closed;
    uint64_t place;
    if (moved) {
        roburoc4_sim_advance(home->sim, home->now_us);
    }
    while (moved) {
        moved = 0;
        for (place = 0; place < WORLD_CLIENTS; place++) {
            if (home->clients[place] != NULL) {
                moved |= send(home->clients[place], place + 1);
            }
        }
        moved |= send_from_robot(home);
        for (place = 0; place < WORLD_CLIENTS; place++) {
            if (home->clients[place] != NULL) {
                moved |= receive(home->clients[place]);
            }
        }
    }
}

static uint64_t sooner(uint64_t one, uint64_t other) {
    return one < other ? one : other;
}

static uint64_t next_time(const world *home, uint64_t end_us) {
    uint64_t next_us = sooner(end_us, roburoc4_sim_next_deadline(home->sim));
    uint32_t place;
    for (place = 0; place < WORLD_CLIENTS; place++) {
        const world_client *one = home->clients[place];
        if (one != NULL) {
            next_us = sooner(next_us, roburoc4_client_next_deadline(&one->client));
            next_us = sooner(next_us, roburoc4_sim_channel_next_deadline(one->up));
            next_us = sooner(next_us, roburoc4_sim_channel_next_deadline(one->down));
        }
    }
    return next_us > home->now_us ? next_us : sooner(end_us, home->now_us + STUCK_US);
}

void world_run(world *home, uint64_t duration_us) {
    uint64_t end_us = home->now_us + duration_us;
    world_exchange(home);
    while (home->now_us < end_us && !home->closed) {
        home->now_us = next_time(home, end_us);
        world_exchange(home);
    }
}

/* -------------------------------------------------------------------------------------- life ---
 */

world *world_create(const roburoc4_sim_config *config) {
    world *home = calloc(1, sizeof *home);
    if (home == NULL) {
        return NULL;
    }
    home->now_us = START_US;
    home->sim = roburoc4_sim_create(config);
    if (home->sim == NULL) {
        free(home);
        return NULL;
    }
    roburoc4_sim_advance(home->sim, home->now_us);
    return home;
}

static void free_if_empty(world *home) {
    uint32_t place;
    for (place = 0; place < WORLD_CLIENTS; place++) {
        if (home->clients[place] != NULL) {
            return;
        }
    }
    if (home->closed) {
        roburoc4_sim_destroy(home->sim);
        free(home);
    }
}

void world_close(world *home) {
    home->closed = 1;
    free_if_empty(home);
}

roburoc4_result world_set_faults(world *home, const roburoc4_sim_faults *faults) {
    roburoc4_sim_channel *trial = roburoc4_sim_channel_create(NULL, 1, 1, 1);
    roburoc4_result result = ROBUROC4_ERR_SYSTEM;
    uint32_t place;
    if (trial != NULL) {
        result = roburoc4_sim_channel_set_faults(trial, faults);
        roburoc4_sim_channel_destroy(trial);
    }
    if (result < 0) {
        return result;
    }
    home->faults = *faults;
    for (place = 0; place < WORLD_CLIENTS; place++) {
        if (home->clients[place] != NULL) {
            (void)roburoc4_sim_channel_set_faults(home->clients[place]->up, faults);
            (void)roburoc4_sim_channel_set_faults(home->clients[place]->down, faults);
        }
    }
    return ROBUROC4_OK;
}

static void free_client(world_client *one) {
    roburoc4_sim_channel_destroy(one->up);
    roburoc4_sim_channel_destroy(one->down);
    free(one->ring.samples);
    free(one);
}

world_client *world_join(world *home, const roburoc4_config *config, uint32_t buffer) {
    uint32_t place = 0;
    world_client *one = calloc(1, sizeof *one);
    while (place < WORLD_CLIENTS && home->clients[place] != NULL) {
        place++;
    }
    if (one == NULL || place == WORLD_CLIENTS) {
        free(one);
        return NULL;
    }
    one->home = home;
    one->ring.capacity = buffer;
    one->ring.samples = calloc(buffer, sizeof *one->ring.samples);
    home->peers++;
    one->up =
        roburoc4_sim_channel_create(&home->faults, 2 * (uint64_t)home->peers, FLIGHTS, LONGEST);
    one->down =
        roburoc4_sim_channel_create(&home->faults, 2 * (uint64_t)home->peers + 1, FLIGHTS, LONGEST);
    if (one->ring.samples == NULL || one->up == NULL || one->down == NULL ||
        roburoc4_client_init(&one->client, sizeof one->client, config) < 0) {
        free_client(one);
        return NULL;
    }
    home->clients[place] = one;
    (void)roburoc4_client_start(&one->client, home->now_us);
    world_exchange(home);
    return one;
}

void world_leave(world_client *leaving) {
    world *home = leaving->home;
    uint32_t place;
    for (place = 0; place < WORLD_CLIENTS; place++) {
        if (home->clients[place] == leaving) {
            home->clients[place] = NULL;
        }
    }
    free_client(leaving);
    free_if_empty(home);
}
