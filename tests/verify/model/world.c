/* SPDX-License-Identifier: MIT
 *
 * The world: its link, its events, its time; and the judge on the robot's side.
 */
#include "world.h"

#include <stdio.h>
#include <string.h>

#include "../portable/check.h"

#define PART "world.c"
#define MS 1000UL
#define SECOND 1000000UL
#define CYCLE_US ((uint64_t)ROBUROC4_CYCLE_US)
/* How long a datagram is on its way when nothing is wrong. */
#define TRANSIT_US CYCLE_US
#define LATE_US (7 * CYCLE_US)
#define VERY_LATE_US (400 * MS)
#define TWICE_US (3 * CYCLE_US)
#define OUTAGE_US (400 * MS)
#define HANG_US (160 * MS)
#define LONG_HANG_US (1200 * MS)
#define CLOCK_STEP_US (700 * MS)

const char *const event_names[EVENTS] = {
    "nothing is wrong",
    "lost to the client",
    "lost to the robot",
    "first lost to the client",
    "first lost to the robot",
    "late to the client",
    "late to the robot",
    "very late to the client",
    "very late to the robot",
    "twice to the client",
    "twice to the robot",
    "cut off to the client",
    "cut off to the robot",
    "the robot refuses requests",
    "outage of the link",
    "the robot reboots",
    "power of the robot off or on",
    "pad [A] pressed or let go",
    "somebody else commands",
    "the program hangs",
    "the program hangs for long",
    "the clock steps back",
    "the clock steps ahead",
    "no drive()",
    "drive() to another target",
    "drive(0, 0)",
    "stop()",
    "disarm()",
    "arm()",
    "close(), or start()",
};

int world_tells;

static const char *part;
static long line;

const char *broken_part(void) {
    return part;
}

long broken_line(void) {
    return line;
}

void check(int passed, const char *where, long at) {
    if (!passed && part == NULL) {
        part = where;
        line = at;
    }
}

uint64_t world_clock_us(const world *w) {
    return w->now_us + w->clock_us;
}

/* ----------------------------------------------------------------------------- the link --- */

static void put(world *w, int to, const uint8_t *data, size_t size, uint64_t at_us) {
    flight *flights = w->flights[to];
    uint32_t i = w->on_way[to];
    if (i == FLIGHTS) {
        return; /* a queue that is full loses what comes */
    }
    for (; i > 0 && flights[i - 1].at_us > at_us; i--) {
        flights[i] = flights[i - 1];
    }
    memset(&flights[i], 0, sizeof flights[i]);
    flights[i].at_us = at_us;
    flights[i].size = (uint8_t)size;
    memcpy(flights[i].data, data, size);
    w->on_way[to]++;
}

static size_t take(world *w, int to, uint8_t *data) {
    flight *flights = w->flights[to];
    size_t size;
    if (w->on_way[to] == 0 || flights[0].at_us > w->now_us) {
        return 0;
    }
    size = flights[0].size;
    memcpy(data, flights[0].data, size);
    w->on_way[to]--;
    memmove(flights, flights + 1, w->on_way[to] * sizeof *flights);
    return size;
}

/** Cut off, a directory lists fewer services and is good: that deceives, and is not walked here. */
static int is_directory(const uint8_t *data) {
    return data[0] != ROBUROC4_HEADER_STATUS && data[1] == ROBUROC4_ACTION_GET && data[2] == 0;
}

static void send(world *w, int to, treatment *how, const uint8_t *data, size_t size) {
    uint8_t bytes[NETWORK_LONGEST];
    const uint64_t at_us = w->now_us + TRANSIT_US + how->delay_us;
    const int lost = how->lose || how->lose_first || w->now_us < w->outage_until_us;
    if (world_tells) {
        printf("    %7.3f s to the %s: %02x %02x %02x %02x (%u bytes)%s\n",
               (double)w->now_us * 1e-6, to == TO_CLIENT ? "client" : "robot", data[0], data[1],
               data[2], size > 3 ? data[3] : 0, (unsigned)size, lost ? ", lost" : "");
    }
    how->lose_first = 0;
    if (lost) {
        return;
    }
    memcpy(bytes, data, size);
    if (how->refuse && data[0] != ROBUROC4_HEADER_STATUS && size >= 5) {
        bytes[4] = 1;
    }
    size -= how->cut && !is_directory(data);
    put(w, to, bytes, size, at_us);
    if (how->twice) {
        put(w, to, bytes, size, at_us + TWICE_US);
    }
    if (at_us - w->now_us + TWICE_US > w->delay_us) {
        w->delay_us = (uint32_t)(at_us - w->now_us + TWICE_US);
    }
}

/* ------------------------------------------------------------------- the two that talk --- */

static void robot_speaks(world *w, treatment how[2]) {
    uint8_t data[NETWORK_LONGEST];
    uint8_t reply[NETWORK_LONGEST];
    size_t size;
    robot_advance(&w->robot, w->now_us);
    while ((size = take(w, TO_ROBOT, data)) > 0) {
        size = robot_hear(&w->robot, data, size, reply, sizeof reply);
        if (size > 0) {
            send(w, TO_CLIENT, &how[TO_CLIENT], reply, size);
        }
    }
    while ((size = robot_status(&w->robot, data, sizeof data)) > 0) {
        send(w, TO_CLIENT, &how[TO_CLIENT], data, size);
    }
}

static void client_speaks(world *w, treatment how[2]) {
    uint8_t data[ROBUROC4_MAX_TRANSMIT];
    size_t size;
    while ((size = take(w, TO_CLIENT, data)) > 0) {
        referee_receive(&w->referee, data, size, world_clock_us(w));
    }
    while ((size = referee_poll(&w->referee, data, sizeof data, world_clock_us(w))) > 0) {
        send(w, TO_ROBOT, &how[TO_ROBOT], data, size);
    }
}

/** Nobody has asked for a speed for a lease, the longest delay and the robot's watchdog: whatever
 *  went wrong, and however long the program hung, the robot has no target then. */
static void judge_robot(const world *w) {
    const uint64_t longest_us = w->referee.lease_us + w->delay_us + ROBOT_WATCHDOG_US + CYCLE_US;
    CHECK(!robot_moves(&w->robot) || w->now_us < w->foreign_until_us ||
          w->now_us - w->drove_us <= longest_us);
}

static void cycle(world *w, event what, treatment how[2]) {
    w->now_us += CYCLE_US;
    robot_speaks(w, how);
    if (what == FOREIGN_COMMAND && w->robot.powered) {
        w->robot.target[0] = 0.75f;
        w->robot.commanded_us = w->now_us;
        w->foreign_until_us = w->now_us + ROBOT_WATCHDOG_US + CYCLE_US;
    }
    if (w->now_us >= w->hung_until_us) {
        client_speaks(w, how);
    }
    judge_robot(w);
}

/* ------------------------------------------------------------------------------ events --- */

void world_drive(world *w, float linear, float angular) {
    if (referee_drive(&w->referee, linear, angular, world_clock_us(w)) >= 0) {
        w->drove_us = w->now_us;
    }
}

static void user_closes(world *w) {
    const uint32_t state = roburoc4_client_state(&w->referee.client);
    if (state == ROBUROC4_STATE_IDLE) {
        referee_begin(&w->referee, &w->robot, world_clock_us(w));
    } else if (state != ROBUROC4_STATE_CLOSING) {
        referee_close(&w->referee, world_clock_us(w));
    }
}

/** Where it is not known whom to drive, a stop() waits; the small referee does not judge that. */
static void user_stops(world *w) {
    roburoc4_facts facts;
    facts.size = sizeof facts;
    (void)roburoc4_client_facts(&w->referee.client, world_clock_us(w), &facts);
    if (facts.state == ROBUROC4_STATE_READY && facts.arm_refusal != ROBUROC4_ERR_NO_DIFFERENTIAL) {
        referee_stop(&w->referee, world_clock_us(w));
    }
}

static void user_acts(world *w, event what) {
    switch (what) {
    case USER_SILENT:
        break;
    case USER_TURNS:
        world_drive(w, -0.25f, 0.5f);
        break;
    case USER_ZERO:
        world_drive(w, 0, 0);
        break;
    case USER_STOPS:
        user_stops(w);
        break;
    case USER_DISARMS:
        referee_disarm(&w->referee, world_clock_us(w));
        break;
    case USER_ARMS:
        (void)referee_arm(&w->referee, world_clock_us(w));
        break;
    case USER_CLOSES:
        user_closes(w);
        break;
    default:
        world_drive(w, 0.5f, 0);
        break;
    }
}

static void power(world *w) {
    if (w->robot.powered) {
        w->robot.powered = 0;
        w->robot.target[0] = w->robot.target[1] = 0;
    } else {
        robot_boot(&w->robot, w->now_us);
    }
}

/** What happens at the beginning of the round. */
static void strike(world *w, event what) {
    switch (what) {
    case OUTAGE:
        w->outage_until_us = w->now_us + OUTAGE_US;
        break;
    case REBOOT:
        robot_boot(&w->robot, w->now_us);
        break;
    case POWER:
        power(w);
        break;
    case PAD:
        w->robot.pad_a = !w->robot.pad_a;
        break;
    case HANG:
        w->hung_until_us = w->now_us + HANG_US;
        break;
    case LONG_HANG:
        w->hung_until_us = w->now_us + LONG_HANG_US;
        break;
    case CLOCK_BACK:
        w->clock_us -= CLOCK_STEP_US;
        break;
    case CLOCK_AHEAD:
        w->clock_us += CLOCK_STEP_US;
        break;
    default:
        break;
    }
}

static void treat(event what, treatment how[2]) {
    treatment *to_client = &how[TO_CLIENT];
    treatment *to_robot = &how[TO_ROBOT];
    memset(how, 0, 2 * sizeof *how);
    to_client->lose = what == LOSE_TO_CLIENT;
    to_robot->lose = what == LOSE_TO_ROBOT;
    to_client->lose_first = what == LOSE_FIRST_TO_CLIENT;
    to_robot->lose_first = what == LOSE_FIRST_TO_ROBOT;
    to_client->twice = what == TWICE_TO_CLIENT;
    to_robot->twice = what == TWICE_TO_ROBOT;
    to_client->cut = what == CUT_TO_CLIENT;
    to_robot->cut = what == CUT_TO_ROBOT;
    to_client->refuse = what == ANSWERS_REFUSE;
    to_client->delay_us = what == LATE_TO_CLIENT        ? LATE_US
                          : what == VERY_LATE_TO_CLIENT ? VERY_LATE_US
                                                        : 0;
    to_robot->delay_us = what == LATE_TO_ROBOT        ? LATE_US
                         : what == VERY_LATE_TO_ROBOT ? VERY_LATE_US
                                                      : 0;
}

void world_round(world *w, event what, uint32_t cycles) {
    treatment how[2];
    treat(what, how);
    strike(w, what);
    if (w->now_us >= w->hung_until_us) {
        user_acts(w, what);
        client_speaks(w, how);
    }
    while (cycles-- > 0) {
        cycle(w, what, how);
    }
}

void world_begin(world *w, const roburoc4_config *config) {
    memset(w, 0, sizeof *w);
    w->clock_us = 100 * SECOND;
    w->robot.first_id = ROBUROC4_SERVICE_IOCARD;
    robot_boot(&w->robot, 0);
    w->referee.config = *config;
    referee_begin(&w->referee, &w->robot, world_clock_us(w));
}

void world_mend(world *w) {
    w->outage_until_us = 0;
    w->robot.pad_a = 0;
    if (!w->robot.powered) {
        robot_boot(&w->robot, w->now_us);
    }
}
