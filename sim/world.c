/* SPDX-License-Identifier: MIT
 *
 * Virtual time: a robot, its clients, and the networks between them. Time jumps from one event to
 * the next and skips none.
 */
#include <stdlib.h>
#include <string.h>

#include "model.h"
#include "network.h"

/* Some clients treat time 0 as "never". */
#define BEGIN_US 1000000u
#define DATAGRAMS 4096u
#define LONGEST 1472u

/* A client and its network. */
typedef struct member {
    roburoc4_client *client;
    uint32_t number;
    uint64_t reported_us; /* when step() last returned it without a datagram */
    sim_network *to_robot, *from_robot;
} member;

struct roburoc4_world {
    roburoc4_sim *robot;
    uint64_t now_us;
    roburoc4_sim_faults faults;
    uint32_t joined; /* ever: seeds and numbers are not reused */
    uint32_t count;
    member members[ROBUROC4_WORLD_MAX_CLIENTS]; /* in the order in which they joined */
    uint8_t datagram[LONGEST];
};

/* ------------------------------------------------------------------------------------ creation ---
 */

roburoc4_world *roburoc4_world_create(const roburoc4_sim_config *config) {
    roburoc4_world *world = calloc(1, sizeof *world);
    if (world == NULL) {
        return NULL;
    }
    world->robot = roburoc4_sim_create(config);
    if (world->robot == NULL) {
        free(world);
        return NULL;
    }
    world->faults.size = sizeof world->faults;
    world->now_us = BEGIN_US;
    roburoc4_sim_advance(world->robot, world->now_us);
    return world;
}

static void free_network(member *at) {
    sim_network_destroy(at->to_robot);
    sim_network_destroy(at->from_robot);
}

void roburoc4_world_destroy(roburoc4_world *world) {
    if (world != NULL) {
        for (uint32_t i = 0; i < world->count; i++) {
            free_network(&world->members[i]);
        }
        roburoc4_sim_destroy(world->robot);
        free(world);
    }
}

roburoc4_sim *roburoc4_world_robot(roburoc4_world *world) {
    return world->robot;
}

uint64_t roburoc4_world_now_us(const roburoc4_world *world) {
    return world->now_us;
}

/* ----------------------------------------------------------------------------- the clients --- */

roburoc4_result roburoc4_world_join(roburoc4_world *world, roburoc4_client *client) {
    const uint64_t seed = 2 * ((uint64_t)world->joined + 1);
    member *made = &world->members[world->count];
    roburoc4_result result;
    if (world->count == ROBUROC4_WORLD_MAX_CLIENTS) {
        return ROBUROC4_ERR_BUFFER;
    }
    result = roburoc4_client_start(client, world->now_us);
    if (result < 0) {
        return result;
    }
    memset(made, 0, sizeof *made);
    made->client = client;
    made->to_robot = sim_network_create(&world->faults, seed, DATAGRAMS, LONGEST);
    made->from_robot = sim_network_create(&world->faults, seed + 1, DATAGRAMS, LONGEST);
    if (made->to_robot == NULL || made->from_robot == NULL) {
        free_network(made);
        return ROBUROC4_ERR_SYSTEM;
    }
    world->count++;
    made->number = ++world->joined;
    return (roburoc4_result)made->number;
}

void roburoc4_world_leave(roburoc4_world *world, const roburoc4_client *client) {
    for (uint32_t i = 0; i < world->count; i++) {
        if (world->members[i].client == client) {
            free_network(&world->members[i]);
            world->count--;
            memmove(&world->members[i], &world->members[i + 1],
                    (world->count - i) * sizeof *world->members);
            return;
        }
    }
}

roburoc4_result roburoc4_world_set_faults(roburoc4_world *world,
                                          const roburoc4_sim_faults *faults) {
    roburoc4_result result = sim_faults_take(&world->faults, faults);
    if (result < 0) {
        return result;
    }
    for (uint32_t i = 0; i < world->count; i++) {
        (void)sim_network_set_faults(world->members[i].to_robot, faults);
        (void)sim_network_set_faults(world->members[i].from_robot, faults);
    }
    return ROBUROC4_OK;
}

/* ------------------------------------------------------------------------------- datagrams --- */

/* Sends what a client has to send, and delivers to the robot what has arrived. True if the client
 * was due and step() has not returned it at this time yet: it may have events. */
static bool send(roburoc4_world *world, member *from) {
    const bool due = roburoc4_client_next_deadline(from->client) <= world->now_us;
    uint64_t number;
    roburoc4_result size;
    while ((size = roburoc4_client_poll_transmit(from->client, world->datagram, LONGEST,
                                                 world->now_us)) > 0) {
        sim_network_push(from->to_robot, from->number, world->datagram, (size_t)size,
                         world->now_us);
    }
    while ((size = sim_network_poll(from->to_robot, world->now_us, &number, world->datagram,
                                    LONGEST)) > 0) {
        roburoc4_sim_receive(world->robot, number, world->datagram, (size_t)size);
    }
    if (!due || from->reported_us == world->now_us) {
        return false;
    }
    from->reported_us = world->now_us;
    return true;
}

static void send_from_robot(roburoc4_world *world) {
    uint64_t number;
    roburoc4_result size;
    while ((size = roburoc4_sim_poll_transmit(world->robot, &number, world->datagram, LONGEST)) >
           0) {
        for (uint32_t i = 0; i < world->count; i++) {
            if (world->members[i].number == number) {
                sim_network_push(world->members[i].from_robot, number, world->datagram,
                                 (size_t)size, world->now_us);
            }
        }
    }
}

/* Gives a client the next datagram that has arrived: its length, or 0. */
static size_t receive(roburoc4_world *world, const member *to) {
    uint64_t number;
    roburoc4_result size =
        sim_network_poll(to->from_robot, world->now_us, &number, world->datagram, LONGEST);
    if (size <= 0) {
        return 0;
    }
    (void)roburoc4_client_receive(to->client, world->datagram, (size_t)size, world->now_us);
    return (size_t)size;
}

/* Handles what is due at this moment, up to the first client with news: its number, or 0. */
static uint32_t exchange(roburoc4_world *world, size_t *size) {
    roburoc4_sim_advance(world->robot, world->now_us);
    *size = 0;
    for (uint32_t i = 0; i < world->count; i++) {
        if (send(world, &world->members[i])) {
            return world->members[i].number;
        }
    }
    send_from_robot(world);
    for (uint32_t i = 0; i < world->count && *size == 0; i++) {
        *size = receive(world, &world->members[i]);
        if (*size > 0) {
            return world->members[i].number;
        }
    }
    return 0;
}

/* ------------------------------------------------------------------------------------ time --- */

static uint64_t sooner(uint64_t a_us, uint64_t b_us) {
    return a_us < b_us ? a_us : b_us;
}

static uint64_t next_moment(const roburoc4_world *world, uint64_t until_us) {
    uint64_t next_us = sooner(until_us, roburoc4_sim_next_deadline(world->robot));
    for (uint32_t i = 0; i < world->count; i++) {
        const member *at = &world->members[i];
        next_us = sooner(next_us, roburoc4_client_next_deadline(at->client));
        next_us = sooner(next_us, sim_network_next_deadline(at->to_robot));
        next_us = sooner(next_us, sim_network_next_deadline(at->from_robot));
    }
    /* At least a microsecond, or a deadline in the past would stop the time. */
    return next_us > world->now_us + 1 ? next_us : world->now_us + 1;
}

uint32_t roburoc4_world_step(roburoc4_world *world, uint64_t until_us, const uint8_t **datagram,
                             size_t *size) {
    size_t length;
    uint32_t number = exchange(world, &length);
    while (number == 0 && world->now_us < until_us) {
        world->now_us = next_moment(world, until_us);
        number = exchange(world, &length);
    }
    if (datagram != NULL) {
        *datagram = world->datagram;
    }
    if (size != NULL) {
        *size = length;
    }
    return number;
}
