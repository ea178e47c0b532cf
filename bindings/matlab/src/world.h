/* SPDX-License-Identifier: MIT
 *
 * world.h - virtual time: one simulated robot, its clients, and the network between them.
 *
 * Nothing happens but by world_run() and world_exchange(), so everything goes the same way every
 * time.
 */
#ifndef ROBUROC4_MEX_WORLD_H
#define ROBUROC4_MEX_WORLD_H

#include "roburoc4_sim.h"
#include "samples.h"

#define WORLD_CLIENTS 16

typedef struct world world;

/** A client in a world's time. */
typedef struct world_client {
    world *home;
    roburoc4_client client;
    sample_ring ring;
    roburoc4_sim_channel *up, *down;
} world_client;

struct world {
    roburoc4_sim *sim;
    uint64_t now_us;
    int closed; /* the simulator object is gone; clients may still hold on to the world */
    uint32_t peers;
    roburoc4_sim_faults faults;
    world_client *clients[WORLD_CLIENTS]; /* the peer of a client is its place and 1 */
};

/** NULL where there is no memory, or for a bad configuration. */
world *world_create(const roburoc4_sim_config *config);
/** The simulator object is gone. The memory goes with the last client. */
void world_close(world *home);
/** Carry all that can arrive at this moment. */
void world_exchange(world *home);
/** Let time pass. */
void world_run(world *home, uint64_t duration_us);
/** ROBUROC4_ERR_ARGUMENT for a share that is not within 0 to 1. */
roburoc4_result world_set_faults(world *home, const roburoc4_sim_faults *faults);

/** Let a client in. NULL where there is no memory or WORLD_CLIENTS are there. */
world_client *world_join(world *home, const roburoc4_config *config, uint32_t buffer);
/** Take a client out, at once: close it and let time pass before, for its last zeros. */
void world_leave(world_client *leaving);

#endif
