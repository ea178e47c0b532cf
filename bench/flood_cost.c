/* SPDX-License-Identifier: MIT
 *
 * flood_cost KIND COUNT: give a ready client COUNT forged datagrams of one KIND; prints how long
 * they are. Before each the client is as it was before the first, and each must be counted as its
 * kind is, else what was measured is something else. bench/flood-cost counts the instructions that
 * roburoc4_client_receive() takes for them.
 */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "roburoc4.h"
#include "roburoc4_sim.h"

#define LONGEST 65507
#define USED ROBUROC4_COUNT_RECEIVED /* it is taken for the robot's, and no counter tells */
#define PATIENCE_US 20000000

/** The client that is attacked, and what a forger on its network knows of it. */
static struct {
    roburoc4_client client;
    roburoc4_request question; /* the open one that is answered */
    uint64_t cycles;           /* of the newest status */
    uint64_t now_us;
} victim;

typedef struct forgery {
    const char *name;
    size_t (*make)(uint8_t *data, unsigned turn);
    uint32_t counter;                 /* what each raises */
    const roburoc4_request *question; /* action, service and io_type of the one that it answers */
} forgery;

/* ---- what fits nothing ---- */

static size_t one_byte(uint8_t *data, unsigned turn) {
    data[0] = (uint8_t)(turn % 255 + 1);
    return 1;
}

static size_t nonsense(uint8_t *data, unsigned turn) {
    memset(data, (int)(turn % 250 + 1), LONGEST);
    return LONGEST;
}

/** As if an answer to the question of another client. */
static size_t foreign_answer(uint8_t *data, unsigned turn) {
    data[0] = (uint8_t)(turn % 250 + 1);
    data[2] = 77;
    return 5;
}

static size_t foreign_directory(uint8_t *data, unsigned turn) {
    data[0] = (uint8_t)(turn % 250 + 1);
    memset(data + 5, 0x55, LONGEST - 7);
    return LONGEST - 2; /* elements of 4 bytes */
}

/* ---- statuses ---- */

static size_t status(uint8_t *data, uint16_t service, uint64_t cycles, size_t size) {
    data[0] = ROBUROC4_HEADER_STATUS;
    data[1] = (uint8_t)service;
    for (unsigned i = 0; i < 8; i++) {
        data[3 + i] = (uint8_t)(cycles >> 8 * i);
    }
    return size;
}

static size_t unknown_status(uint8_t *data, unsigned turn) {
    return status(data, 99, victim.cycles + 1 + turn, 27);
}

static size_t old_status(uint8_t *data, unsigned turn) {
    return status(data, ROBUROC4_SERVICE_DIFFERENTIAL, victim.cycles - 10 - turn % 90, 27);
}

static size_t new_status(uint8_t *data, unsigned turn) {
    const int digital_inputs = ROBUROC4_DI_COUNT;
    const size_t size = 11 + 4 * ROBUROC4_AI_COUNT + (digital_inputs + 7) / 8;
    return status(data, ROBUROC4_SERVICE_IOCARD, victim.cycles + 1 + turn, size);
}

/* ---- answers that fit an open question ---- */

static void head(uint8_t *data) {
    data[0] = victim.question.id;
    data[1] = victim.question.action;
    data[2] = (uint8_t)victim.question.service;
    data[3] = (uint8_t)(victim.question.service >> 8);
}

static size_t blank_text(uint8_t *data, unsigned turn) {
    (void)turn;
    memset(data, ' ', LONGEST);
    data[4] = 0;
    head(data);
    return LONGEST;
}

/** `pattern` again and again: beginnings of words that are looked for, so that the search for one
 *  goes on, and none of which comes to its end. Of all texts tried, these were the slowest. */
static size_t near_text(uint8_t *data, const char *pattern) {
    const size_t length = strlen(pattern);
    for (size_t i = 5; i < LONGEST; i++) {
        data[i] = (uint8_t)pattern[i % length];
    }
    data[4] = 0;
    head(data);
    return LONGEST;
}

static size_t near_input_text(uint8_t *data, unsigned turn) {
    (void)turn;
    return near_text(data, "fr"); /* front bumper, rear bumper */
}

static size_t near_service_text(uint8_t *data, unsigned turn) {
    (void)turn;
    return near_text(data, "batte");
}

static size_t directory(uint8_t *data, unsigned turn) {
    const size_t size = foreign_directory(data, turn);
    data[4] = 0;
    head(data);
    return size;
}

/** As many as it holds. */
static size_t telemeters(uint8_t *data, unsigned turn) {
    const uint32_t count = (LONGEST - 9) / 56;
    (void)turn;
    memset(data, 0, LONGEST);
    head(data);
    for (unsigned i = 0; i < 4; i++) {
        data[5 + i] = (uint8_t)(count >> 8 * i);
    }
    return 9 + (size_t)count * 56;
}

static const roburoc4_request input_text = {.action = ROBUROC4_ACTION_QUERY,
                                            .service = ROBUROC4_SERVICE_IOCARD,
                                            .io_type = ROBUROC4_IO_DIGITAL_INPUT};
static const roburoc4_request service_text = {.action = ROBUROC4_ACTION_QUERY,
                                              .service = ROBUROC4_SERVICE_DIRECTORY};
static const roburoc4_request all_services = {.action = ROBUROC4_ACTION_GET,
                                              .service = ROBUROC4_SERVICE_DIRECTORY};
static const roburoc4_request all_telemeters = {.action = ROBUROC4_ACTION_GET,
                                                .service = ROBUROC4_SERVICE_TELEMETER};

static const forgery forgeries[] = {
    {"one-byte", one_byte, ROBUROC4_COUNT_SHORT, NULL},
    {"longest-nonsense", nonsense, ROBUROC4_COUNT_UNMATCHED, NULL},
    {"foreign-answer", foreign_answer, ROBUROC4_COUNT_UNMATCHED, NULL},
    {"foreign-directory", foreign_directory, ROBUROC4_COUNT_UNMATCHED, NULL},
    {"unknown-status", unknown_status, ROBUROC4_COUNT_UNEXPECTED_STATUS, NULL},
    {"old-status", old_status, ROBUROC4_COUNT_OLD, NULL},
    {"new-status", new_status, USED, NULL},
    {"blank-input-text", blank_text, USED, &input_text},
    {"near-input-text", near_input_text, USED, &input_text},
    {"blank-service-text", blank_text, USED, &service_text},
    {"near-service-text", near_service_text, USED, &service_text},
    {"other-directory", directory, USED, &all_services},
    {"telemeter-list", telemeters, USED, &all_telemeters},
};

/** Whether the client just asked what this forgery answers. */
static bool is_asked(const forgery *f, const uint8_t *data, size_t size) {
    roburoc4_request *asked = &victim.question;
    return f->question != NULL && roburoc4_decode_request(data, size, asked) >= 0 &&
           asked->action == f->question->action && asked->service == f->question->service &&
           asked->io_type == f->question->io_type;
}

/** A client and a robot, until the question is open that the forgery answers, or until the client
 *  is ready and has nothing open. */
static bool meet(const forgery *f) {
    uint8_t data[ROBUROC4_SIM_MAX_TRANSMIT];
    roburoc4_sim *robot = roburoc4_sim_create(NULL);
    bool open = false;
    uint64_t spoke_us = 0;
    roburoc4_client_init(&victim.client, sizeof victim.client, NULL);
    roburoc4_client_start(&victim.client, 0);
    while (!open && victim.now_us < PATIENCE_US) {
        roburoc4_result size;
        roburoc4_status_header newest;
        uint64_t peer;
        victim.now_us += 5000;
        roburoc4_sim_advance(robot, victim.now_us);
        while ((size = roburoc4_sim_poll_transmit(robot, &peer, data, sizeof data)) > 0) {
            if (roburoc4_decode_status_header(data, (size_t)size, &newest) >= 0) {
                victim.cycles = newest.robot_cycles;
            }
            roburoc4_client_receive(&victim.client, data, (size_t)size, victim.now_us);
        }
        while (!open && (size = roburoc4_client_poll_transmit(&victim.client, data, sizeof data,
                                                              victim.now_us)) > 0) {
            open = is_asked(f, data, (size_t)size);
            spoke_us = victim.now_us;
            roburoc4_sim_receive(robot, 1, data, (size_t)size);
        }
        if (f->question == NULL) { /* nothing is open between two probes */
            open = victim.now_us > PATIENCE_US / 2 && victim.now_us - spoke_us > 300000 &&
                   roburoc4_client_state(&victim.client) == ROBUROC4_STATE_READY;
        }
    }
    roburoc4_sim_destroy(robot);
    return open;
}

/** How often one of `f` raises its counter. */
static uint32_t counted(const forgery *f, const roburoc4_client *c, roburoc4_result result) {
    if (f->counter == USED) {
        return result >= 0;
    }
    return result < 0 ? roburoc4_client_count(c, f->counter) -
                            roburoc4_client_count(&victim.client, f->counter)
                      : 0;
}

static int attack(const forgery *f, unsigned count) {
    static uint8_t data[LONGEST];
    static roburoc4_client client;
    size_t size = 0;
    for (unsigned turn = 0; turn < count; turn++) {
        memset(data, 0, sizeof data);
        size = f->make(data, turn);
        client = victim.client;
        const roburoc4_result result =
            roburoc4_client_receive(&client, data, size, victim.now_us + 10000 * (turn + 1));
        if (counted(f, &client, result) != 1) {
            (void)fprintf(stderr, "flood_cost: %s, turn %u: came to %d, and was not counted so\n",
                          f->name, turn, (int)result);
            return 1;
        }
    }
    printf("%u\n", (unsigned)size);
    return 0;
}

int main(int argc, char **argv) {
    const unsigned count = argc == 3 ? (unsigned)strtoul(argv[2], NULL, 10) : 0;
    for (size_t i = 0; argc == 3 && i < sizeof forgeries / sizeof forgeries[0]; i++) {
        if (strcmp(forgeries[i].name, argv[1]) == 0) {
            if (!meet(&forgeries[i])) {
                (void)fprintf(stderr, "flood_cost: the client never came to be attacked so\n");
                return 1;
            }
            return attack(&forgeries[i], count);
        }
    }
    (void)fprintf(stderr, "Usage: flood_cost KIND COUNT\n");
    return 2;
}
