/* SPDX-License-Identifier: MIT
 *
 * Every sequence of events, up to a number of rounds and of events that are not "nothing is wrong":
 * each is played to its end with the real client, and from each end, with nothing wrong any more,
 * the client must be ready, armed and moving again, and idle after close(). A state that was seen
 * before, with as many events still to come or more, is not played again.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "world.h"

#define MS 1000UL
#define SECOND 1000000UL
#define ROUNDS_MAX 64
#define ROUND_CYCLES 5
/* After the last event: ready within the first, moving within the second; then idle. */
#define READY_US (15 * SECOND)
#define MOVING_US (25 * SECOND)
#define SETTLE_US (200 * MS)

enum { BEFORE_READY, BEFORE_MOVING, CLOSING }; /* phases of the end */

typedef struct scenario {
    const char *name, *tells;
    uint32_t rounds, events;
    uint32_t cycles; /* of a round */
    int connected;   /* it begins while the robot is driven, else with start() */
    int quick;       /* short settings, so that much happens in few rounds */
} scenario;

static const scenario scenarios[] = {
    {"connecting", "from start() on, a round every 20 ms", 16, 3, 2, 0, 1},
    {"driving", "while driving, short leases and limits", 10, 3, ROUND_CYCLES, 1, 1},
    {"defaults", "while driving, with the default settings", 20, 3, ROUND_CYCLES, 1, 0},
    {"anything", "while driving, any event in each round", 5, 5, ROUND_CYCLES, 1, 1},
};
#define SCENARIOS (sizeof scenarios / sizeof *scenarios)

static struct {
    scenario how;
    uint8_t path[ROUNDS_MAX];
    uint32_t depth;
    uint64_t played, known, ends, ended_early;
    uint64_t ready_us, moving_us; /* the latest, after the last event */
    referee most;                 /* of its counters */
    int normalise;
} search;

/* --------------------------------------------------------------- states that were seen --- */

/** What only figures for the user are made of, and the referee's totals: equal in all states, as
 *  it changes nothing that the client does (--figures shows that). */
static void drop_figures(world *w) {
    roburoc4_client *c = &w->referee.client;
    uint32_t i;
    memset(c->private_counters, 0, sizeof c->private_counters);
    c->private_discovery.described_kind = 0;
    c->private_discovery.described_index = 0;
    c->private_link.round_trip_us = c->private_link.round_trip_min_us = 0;
    c->private_link.mapped = 0;
    c->private_link.offset_us = c->private_link.offset_before_us = 0;
    c->private_link.offset_since_us = 0;
    for (i = 0; i < 5; i++) {
        roburoc4_private_service *s = &c->private_link.services[i];
        s->seen = s->seen != 0;
        s->period_cycles = s->asked_cycles;
        s->gap_min = UINT16_MAX;
        s->gap_count = 0;
        s->received = s->lost = s->late = s->duplicates = 0;
        s->recent_received = s->recent_lost = s->transit_us = s->jitter_us = 0;
    }
}

static void drop_totals(referee *f) {
    f->digest = 0;
    f->speeds = f->trains = f->overrides = f->lost = f->reboots = f->clock_faults = 0;
    f->leases_over = 0;
}

static void mix(uint64_t hash[2], const void *data, size_t size) {
    const uint8_t *bytes = data;
    size_t at;
    for (at = 0; at < size; at += 8) {
        uint64_t word = 0;
        memcpy(&word, bytes + at, size - at < 8 ? size - at : 8);
        hash[0] = (hash[0] ^ word) * 0x9E3779B97F4A7C15U;
        hash[0] ^= hash[0] >> 32;
        hash[1] = (hash[1] + word) * 0xC2B2AE3D27D4EB4FU;
        hash[1] ^= hash[1] >> 29;
    }
}

/* 128 bits of each state, of which the last four are the events that were still to come. What has
 * no room is forgotten: then it is played again. */
#define TABLE_BITS 23
#define LEFT_MASK 15U
static uint64_t (*table)[2];

/** Whether this state was seen with as many events to come; it is now. */
static int seen(const world *w, uint32_t events_left) {
    static world bare;
    uint64_t hash[2] = {1, 2};
    uint64_t(*slot)[2];
    bare = *w;
    drop_figures(&bare);
    drop_totals(&bare.referee);
    mix(hash, &bare, offsetof(world, flights));
    mix(hash, bare.flights[0], bare.on_way[0] * sizeof(flight));
    mix(hash, bare.flights[1], bare.on_way[1] * sizeof(flight));
    slot = table + (hash[0] >> (64 - TABLE_BITS));
    if ((*slot)[0] == hash[0] && ((*slot)[1] ^ hash[1]) <= LEFT_MASK &&
        ((*slot)[1] & LEFT_MASK) >= events_left) {
        search.known++;
        return 1;
    }
    (*slot)[0] = hash[0];
    (*slot)[1] = (hash[1] & ~(uint64_t)LEFT_MASK) | events_left;
    return 0;
}

/* --------------------------------------------------------------------------- complaints --- */

static void print_path(void) {
    uint32_t i;
    printf("again, step by step: --scenario %s --path ", search.how.name);
    for (i = 0; i < search.depth; i++) {
        printf("%s%u", i > 0 ? "," : "", search.path[i]);
    }
    printf("\n");
    for (i = 0; i < search.depth; i++) {
        if (search.path[i] != NOTHING) {
            printf("  round %u: %s\n", i + 1, event_names[search.path[i]]);
        }
    }
}

static void complain(const char *what, long line) {
    printf("%s: BROKEN: %s", search.how.name, what);
    printf(line > 0 ? ":%ld\n" : "\n", line);
    print_path();
    exit(1);
}

static void look(void) {
    if (broken_part() != NULL) {
        complain(broken_part(), broken_line());
    }
}

static void play(world *w, event what, uint32_t cycles) {
    world_round(w, what, cycles);
    if (search.normalise) {
        drop_figures(w);
    }
    search.played++;
    look();
    if (world_tells) {
        printf("%7.3f s  %-26s state %u, armed %u, leased %u, robot's target %.2f %.2f\n",
               (double)w->now_us * 1e-6, event_names[what],
               (unsigned)roburoc4_client_state(&w->referee.client), w->referee.armed,
               w->referee.leased, (double)w->robot.target[0], (double)w->robot.target[1]);
    }
}

/* ------------------------------------------------------------------------ after the events --- */

static void most(uint32_t *so_far, uint32_t count) {
    *so_far = count > *so_far ? count : *so_far;
}

static void note_totals(const referee *f) {
    most(&search.most.speeds, f->speeds);
    most(&search.most.trains, f->trains);
    most(&search.most.overrides, f->overrides);
    most(&search.most.lost, f->lost);
    most(&search.most.reboots, f->reboots);
    most(&search.most.clock_faults, f->clock_faults);
    most(&search.most.leases_over, f->leases_over);
}

static void note_latest(uint64_t *latest_us, uint64_t span_us) {
    *latest_us = span_us > *latest_us ? span_us : *latest_us;
}

/** What the program does next, or EVENTS when all has come to its end. */
static event next_of_end(world *w, uint64_t since_us) {
    const uint32_t state = roburoc4_client_state(&w->referee.client);
    if (w->now_us < w->hung_until_us) {
        return NOTHING;
    }
    if (w->phase == BEFORE_READY && state == ROBUROC4_STATE_READY) {
        note_latest(&search.ready_us, w->now_us - since_us);
        w->phase = BEFORE_MOVING;
    }
    if (w->phase == BEFORE_MOVING && w->referee.armed && robot_moves(&w->robot) &&
        w->now_us >= w->foreign_until_us) {
        note_latest(&search.moving_us, w->now_us - since_us);
        w->phase = CLOSING;
        w->closed_us = w->now_us;
        return USER_CLOSES;
    }
    if (w->phase == CLOSING) {
        return state == ROBUROC4_STATE_IDLE && !robot_moves(&w->robot) ? EVENTS : USER_SILENT;
    }
    if (state == ROBUROC4_STATE_IDLE) {
        return USER_CLOSES; /* starts */
    }
    return w->referee.armed ? NOTHING : USER_ARMS;
}

static void check_end(const world *w, uint64_t since_us) {
    const uint64_t after_us = w->now_us - since_us;
    if (w->phase == BEFORE_READY && after_us > READY_US) {
        complain("not ready again in time", 0);
    }
    if (w->phase == BEFORE_MOVING && after_us > MOVING_US) {
        complain(w->referee.armed ? "armed again, but the robot does not move"
                                  : "not armed again in time",
                 0);
    }
    if (w->phase == CLOSING && roburoc4_client_state(&w->referee.client) != ROBUROC4_STATE_IDLE &&
        w->now_us - w->closed_us > w->referee.config.robot_watchdog_ms * MS + SETTLE_US) {
        complain("not idle in time after close()", 0);
    }
}

/** From here on nothing is wrong. */
static void end(const world *before) {
    world w = *before;
    event what;
    search.ends++;
    world_mend(&w);
    while ((what = next_of_end(&w, before->now_us)) != EVENTS) {
        play(&w, what, ROUND_CYCLES);
        check_end(&w, before->now_us);
        if (!search.normalise && !world_tells && seen(&w, 0)) {
            search.ended_early++;
            return;
        }
    }
    note_totals(&w.referee);
}

/* ------------------------------------------------------------------------------- search --- */

static void walk(const world *before, uint32_t events_left) {
    uint32_t what;
    if (search.depth == search.how.rounds) {
        end(before);
        return;
    }
    for (what = NOTHING; what < (events_left > 0 ? (uint32_t)EVENTS : NOTHING + 1U); what++) {
        const uint32_t left = what == NOTHING ? events_left : events_left - 1;
        world w = *before;
        search.path[search.depth++] = (uint8_t)what;
        play(&w, (event)what, search.how.cycles);
        if (!seen(&w, left)) {
            walk(&w, left);
        }
        search.depth--;
    }
}

/* -------------------------------------------------------------------------------- begin --- */

static void begin(world *w) {
    roburoc4_config config;
    uint64_t until_us;
    roburoc4_config_init(&config, sizeof config);
    if (search.how.quick) {
        config.lease_ms = 100;
        config.fresh_ms = 150;
        config.lost_ms = 300;
        config.robot_watchdog_ms = 200;
    }
    world_begin(w, &config);
    until_us = 4 * SECOND;
    while (search.how.connected && w->now_us < until_us) {
        play(w, w->referee.armed ? NOTHING : USER_ARMS, ROUND_CYCLES);
    }
    if (search.how.connected && !robot_moves(&w->robot)) {
        complain("it does not begin to drive", 0);
    }
}

/** How many sequences were walked. */
static double sequences(void) {
    double all = 0;
    double ways = 1;
    uint32_t k;
    for (k = 0; k <= search.how.events && k <= search.how.rounds; k++) {
        all += ways;
        ways *= (double)(search.how.rounds - k) / (k + 1) * (EVENTS - 1);
    }
    return all;
}

static void report(void) {
    const referee *m = &search.most;
    printf("%s: %.0f sequences (%u rounds, to %u of %u events), %" PRIu64 " rounds played; ready "
           "again in %.2f s, moving in %.2f s; all promises held\n",
           search.how.name, sequences(), (unsigned)search.how.rounds, (unsigned)search.how.events,
           EVENTS - 1, search.played, (double)search.ready_us * 1e-6,
           (double)search.moving_us * 1e-6);
    printf(
        "    most in one: %u speeds, %u zero trains, %u overrides, %u losses, %u reboots, %u clock "
        "faults, %u leases over; %" PRIu64 " ends, %" PRIu64 " states met again\n",
        (unsigned)m->speeds, (unsigned)m->trains, (unsigned)m->overrides, (unsigned)m->lost,
        (unsigned)m->reboots, (unsigned)m->clock_faults, (unsigned)m->leases_over, search.ends,
        search.known);
    if (search.how.connected && (m->speeds == 0 || m->trains == 0 || m->overrides == 0 ||
                                 m->reboots == 0 || m->clock_faults == 0 || m->leases_over == 0)) {
        complain("the sequences were empty", 0);
    }
}

/* -------------------------------------------------------------------------- other runs --- */

static void tell(const char *text) {
    world w;
    char *rest;
    world_tells = 0;
    begin(&w);
    world_tells = 1;
    while (*text != '\0' && search.depth < ROUNDS_MAX) {
        const unsigned long what = strtoul(text, &rest, 10);
        if (rest == text || what >= EVENTS) {
            printf("search: '%s' is no path; it is event numbers with commas between\n", text);
            exit(2);
        }
        search.path[search.depth++] = (uint8_t)what;
        play(&w, (event)what, search.how.cycles);
        text = *rest == ',' ? rest + 1 : rest;
    }
    end(&w);
    printf("no promise was broken\n");
}

static uint32_t dice(uint64_t *state) {
    *state = *state * 6364136223846793005U + 1442695040888963407U;
    return (uint32_t)(*state >> 33);
}

/** What drop_figures() drops changes nothing: random sequences, with it and without it after each
 *  round, send the same bytes at the same times. */
static void compare_figures(uint32_t count) {
    uint64_t state = 1;
    uint32_t i;
    for (i = 0; i < count; i++) {
        world plain;
        world bare;
        uint32_t round;
        search.normalise = 0;
        begin(&plain);
        bare = plain;
        for (search.depth = 0; search.depth < ROUNDS_MAX;) {
            round = dice(&state) % 4 == 0 ? dice(&state) % EVENTS : NOTHING;
            search.path[search.depth++] = (uint8_t)round;
            search.normalise = 0;
            play(&plain, (event)round, search.how.cycles);
            search.normalise = 1;
            play(&bare, (event)round, search.how.cycles);
            if (plain.referee.digest != bare.referee.digest) {
                complain("figures for the user change what the client sends", 0);
            }
        }
    }
    printf("%s: %u random sequences of %u rounds send the same without the figures\n",
           search.how.name, (unsigned)count, ROUNDS_MAX);
}

static const char usage[] =
    "search [--scenario NAME] [--depth ROUNDS] [--events COUNT] [--path A,B,... | --figures]\n"
    "  --depth     rounds in which something may happen\n"
    "  --events    at most so many of them something happens in\n"
    "  --path      play this one and tell it step by step\n"
    "  --figures   are states that differ only in figures for the user really equal?\n";

static uint32_t number(const char *text, uint32_t most_of_it) {
    char *rest;
    const unsigned long value = strtoul(text, &rest, 10);
    if (rest == text || *rest != '\0' || value == 0 || value > most_of_it) {
        printf("search: '%s' is not a number from 1 to %u\n", text, (unsigned)most_of_it);
        exit(2);
    }
    return (uint32_t)value;
}

static void choose(const char *name) {
    size_t i;
    for (i = 0; i < SCENARIOS; i++) {
        if (strcmp(name, scenarios[i].name) == 0) {
            search.how = scenarios[i];
            return;
        }
    }
    printf("search: no scenario '%s'; there are:\n", name);
    for (i = 0; i < SCENARIOS; i++) {
        printf("  %-12s %s\n", scenarios[i].name, scenarios[i].tells);
    }
    exit(2);
}

int main(int argc, char **argv) {
    static world first;
    const char *path = NULL;
    int figures = 0;
    int i;
    search.how = scenarios[1];
    for (i = 1; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : "";
        if (strcmp(argv[i], "--figures") == 0) {
            figures = 1;
            continue;
        }
        if (strcmp(argv[i], "--scenario") == 0) {
            choose(value);
        } else if (strcmp(argv[i], "--depth") == 0) {
            search.how.rounds = number(value, ROUNDS_MAX);
        } else if (strcmp(argv[i], "--events") == 0) {
            search.how.events = number(value, LEFT_MASK);
        } else if (strcmp(argv[i], "--path") == 0) {
            path = value;
        } else {
            printf("%s", usage);
            return strcmp(argv[i], "--help") == 0 ? 0 : 2;
        }
        i++;
    }
    if (path != NULL) {
        tell(path);
        return 0;
    }
    if (figures) {
        compare_figures(200);
        return 0;
    }
    table = calloc((size_t)1 << TABLE_BITS, sizeof *table);
    if (table == NULL) {
        printf("search: no memory for %u million states\n", 1U << (TABLE_BITS - 20));
        return 2;
    }
    begin(&first);
    walk(&first, search.how.events);
    report();
    free(table);
    return 0;
}
