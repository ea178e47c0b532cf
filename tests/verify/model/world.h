/* SPDX-License-Identifier: MIT
 *
 * world.h - the real client, a small robot with its watchdog, the link between them and the program
 * that drives, in virtual time and in one struct without pointers: it can be copied and compared.
 * In each round one event of a fixed list happens. ../portable/referee.h judges the client.
 */
#ifndef ROBUROC4_TESTS_MODEL_WORLD_H
#define ROBUROC4_TESTS_MODEL_WORLD_H

#include "../portable/network.h"
#include "../portable/referee.h"

/* Enough for what is on its way in the longest delay; what is more is lost. */
#define FLIGHTS 24

typedef enum event {
    NOTHING, /* all goes well, and the program calls drive() */
    LOSE_TO_CLIENT,
    LOSE_TO_ROBOT,
    LOSE_FIRST_TO_CLIENT,
    LOSE_FIRST_TO_ROBOT,
    LATE_TO_CLIENT, /* overtaken by what is sent in the next round */
    LATE_TO_ROBOT,
    VERY_LATE_TO_CLIENT,
    VERY_LATE_TO_ROBOT,
    TWICE_TO_CLIENT,
    TWICE_TO_ROBOT,
    CUT_TO_CLIENT, /* the last byte of each datagram is missing */
    CUT_TO_ROBOT,
    ANSWERS_REFUSE, /* each answer says that the robot refuses */
    OUTAGE,         /* nothing passes for a while, either way */
    REBOOT,
    POWER, /* off, or on again */
    PAD,   /* [A] is pressed, or let go */
    FOREIGN_COMMAND,
    HANG, /* the program does not call the client for longer than a lease */
    LONG_HANG,
    CLOCK_BACK,
    CLOCK_AHEAD,
    USER_SILENT, /* does not call drive() */
    USER_TURNS,  /* another target */
    USER_ZERO,
    USER_STOPS,
    USER_DISARMS,
    USER_ARMS,
    USER_CLOSES, /* and starts again once it is idle */
    EVENTS
} event;

extern const char *const event_names[EVENTS];

/** How the network treats what is sent in one direction in this round. */
typedef struct treatment {
    uint8_t lose, lose_first, twice, cut, refuse;
    uint32_t delay_us;
} treatment;

typedef struct world {
    referee referee;
    robot robot;
    uint64_t now_us;
    uint64_t clock_us; /* what the client's clock shows at time 0 */
    uint64_t hung_until_us, outage_until_us, foreign_until_us;
    uint64_t drove_us;  /* the last drive() that was accepted */
    uint64_t closed_us; /* the last close(), and the phase: of the end, in search.c */
    uint32_t phase;
    uint32_t delay_us;  /* the longest that happened */
    uint32_t on_way[2]; /* flights by TO_CLIENT, TO_ROBOT, the earliest first */
    flight flights[2][FLIGHTS];
} world;

/** A robot that was just switched on and a client that was just started. */
void world_begin(world *w, const roburoc4_config *config);
/** The program calls drive(), whether or not it may. */
void world_drive(world *w, float linear, float angular);
/** Let this event happen, then let this many robot cycles pass. */
void world_round(world *w, event what, uint32_t cycles);
/** Nothing else is wrong from now on; what is on its way still comes. */
void world_mend(world *w);
/** The client's clock. */
uint64_t world_clock_us(const world *w);

/** The first promise that was broken, as file and line of the judge; NULL: none. */
const char *broken_part(void);
long broken_line(void);
/** Print what passes, for a path that is told step by step. */
extern int world_tells;

#endif
