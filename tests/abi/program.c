/* SPDX-License-Identifier: MIT
 *
 * program.c - a program that drives the simulated robot, passes every struct that begins with its
 * size, and looks whether the library wrote beyond one. newer.sh runs it with the library that it
 * was compiled for, and with a later one.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "roburoc4_move.h"
#include "roburoc4_pump.h"
#include "roburoc4_record.h"
#include "roburoc4_sim.h"

#define NOT_OURS 0xA5

/* A struct, and what lies behind it. */
#define GUARDED(type)                                                                              \
    struct {                                                                                       \
        type value;                                                                                \
        uint8_t behind[64];                                                                        \
    }

static struct {
    GUARDED(roburoc4_client) client;
    GUARDED(roburoc4_udp) udp;
    GUARDED(roburoc4_pump_reader) reader;
    GUARDED(roburoc4_move) move;
    GUARDED(roburoc4_config) config;
    GUARDED(roburoc4_facts) facts;
    GUARDED(roburoc4_link) link;
    GUARDED(roburoc4_service_link) service_link;
    GUARDED(roburoc4_move_options) move_options;
    GUARDED(roburoc4_move_view) move_view;
    GUARDED(roburoc4_recorder_options) recorder_options;
    GUARDED(roburoc4_sim_config) sim_config;
    GUARDED(roburoc4_sim_state) sim_state;
    GUARDED(roburoc4_sim_faults) sim_faults;
} all;

static void check(int holds, const char *what) {
    if (!holds) {
        fprintf(stderr, "program: %s\n", what);
        exit(1);
    }
}

static void check_behind(const uint8_t *behind, const char *name) {
    for (size_t i = 0; i < sizeof all.client.behind; i++) {
        check(behind[i] == NOT_OURS, name);
    }
}
#define CHECK_BEHIND(name) check_behind(all.name.behind, "written beyond its end: " #name)

static roburoc4_world *world;
static uint32_t events;

static uint64_t now_us(void) {
    return roburoc4_world_now_us(world);
}

static void pass(uint32_t span_us) {
    const uint64_t end_us = now_us() + span_us;
    while (roburoc4_world_step(world, end_us, NULL, NULL) != 0) {
        events |= roburoc4_client_take_events(&all.client.value);
    }
}

static void connect_to_robot(void) {
    check(roburoc4_sim_config_init(&all.sim_config.value, sizeof all.sim_config.value) == 0,
          "robot");
    check(roburoc4_config_init(&all.config.value, sizeof all.config.value) == 0, "settings");
    check(roburoc4_config_error(&all.config.value) == NULL, "settings have an error");
    all.sim_config.value.slip = 0.0f;
    all.config.value.lease_ms = 300;
    world = roburoc4_world_create(&all.sim_config.value);
    check(world != NULL, "no world");
    memset(&all.sim_faults.value, 0, sizeof all.sim_faults.value);
    all.sim_faults.value.delay_us = 1000;
    check(roburoc4_world_set_faults(world, ROBUROC4_SIZED(&all.sim_faults.value)) == 0, "faults");
    check(roburoc4_client_size() == sizeof all.client.value, "a client has another size");
    check(roburoc4_client_init(&all.client.value, sizeof all.client.value, &all.config.value) == 0,
          "no client");
    check(roburoc4_world_join(world, &all.client.value) > 0, "not joined");
}

/* A result that this program does not know is an error like others: it tries again; and a state is
 * not the one it waits for. */
static void arm(void) {
    for (int tries = 0;
         tries < 500 && roburoc4_client_state(&all.client.value) != ROBUROC4_STATE_READY; tries++) {
        pass(10000);
    }
    roburoc4_result result = ROBUROC4_ERR_NOT_READY;
    for (int tries = 0; result < 0 && tries < 500; tries++) {
        pass(10000);
        result = roburoc4_client_arm(&all.client.value, now_us());
        check(roburoc4_result_text(result)[0] != '\0', "a result without a text");
    }
    check(result == 0, "not armed");
}

static void drive(void) {
    for (int i = 0; i < 100; i++) {
        check(roburoc4_client_drive(&all.client.value, 0.5f, 0.0f, 0, now_us()) == 0, "drive");
        pass(50000);
    }
    check(roburoc4_client_facts(&all.client.value, now_us(), ROBUROC4_SIZED(&all.facts.value)) == 0,
          "facts");
    check(all.facts.value.driving == 1 && all.facts.value.sent_linear_m_s == 0.5f,
          "the facts are others");
    check(all.facts.value.size == sizeof all.facts.value, "size was written");
    check(roburoc4_client_link(&all.client.value, now_us(), ROBUROC4_SIZED(&all.link.value)) == 0 &&
              all.link.value.received > 100,
          "link");
    check(roburoc4_client_service_link(&all.client.value, ROBUROC4_SERVICE_DIFFERENTIAL, now_us(),
                                       ROBUROC4_SIZED(&all.service_link.value)) == 0 &&
              all.service_link.value.received > 50,
          "link of a service");
    check(roburoc4_client_count(&all.client.value, ROBUROC4_COUNT_SENT) > 100, "counter");
    check((events & ROBUROC4_EVENT_ARMED) != 0 && (events & ROBUROC4_EVENT_LOST) == 0, "events");
}

static double robot_x_m(void) {
    check(roburoc4_sim_get_state(roburoc4_world_robot(world),
                                 ROBUROC4_SIZED(&all.sim_state.value)) == 0,
          "state of the robot");
    return all.sim_state.value.true_x_m;
}

static void move(void) {
    const double begun_m = robot_x_m();
    roburoc4_move *move = &all.move.value;
    check(roburoc4_move_options_init(&all.move_options.value, sizeof all.move_options.value) == 0,
          "options of a move");
    check(roburoc4_move_by(move, 1.0f, 0.0f, &all.move_options.value) == 0, "move");
    while (roburoc4_move_step(move, &all.client.value, now_us()) == ROBUROC4_MOVE_RUNNING) {
        if (roburoc4_client_drive(&all.client.value, move->linear_m_s, move->angular_rad_s, 0,
                                  now_us()) < 0) {
            break;
        }
        pass(50000);
    }
    check(move->outcome == ROBUROC4_MOVE_REACHED, roburoc4_move_outcome_text(move->outcome));
    check(robot_x_m() > begun_m + 0.9, "the move is too short");
    memset(&all.move_view.value, 0, sizeof all.move_view.value);
    check(roburoc4_move_by(move, 1.0f, 0.0f, NULL) == 0, "second move");
    (void)roburoc4_move_step_view(move, ROBUROC4_SIZED(&all.move_view.value), now_us());
    check(move->cause != ROBUROC4_ERR_SIZE, "a view of this size is refused");
}

static void record(const char *folder) {
    roburoc4_recorder *recorder;
    roburoc4_address address;
    roburoc4_result result;
    memset(&all.recorder_options.value, 0, sizeof all.recorder_options.value);
    recorder = roburoc4_recorder_open(folder, ROBUROC4_SIZED(&all.recorder_options.value), &result);
    check(recorder != NULL, "no recorder");
    check(roburoc4_udp_resolve("127.0.0.1", 9, &address) == 0, "address");
    check(roburoc4_udp_open(&all.udp.value, sizeof all.udp.value, &address) == 0, "socket");
    check(roburoc4_udp_record(&all.udp.value, recorder) == 0, "record");
    check(roburoc4_client_init(&all.client.value, sizeof all.client.value, NULL) == 0, "a client");
    check(roburoc4_client_start(&all.client.value, roburoc4_udp_now_us()) == 0, "start");
    /* more than one where this machine stalls for longer than a request waits for its answer */
    result = roburoc4_udp_transmit_all(&all.udp.value, &all.client.value);
    check(result >= 1, "send a request");
    check(all.udp.value.counters[ROBUROC4_UDP_COUNT_SENT] == (uint64_t)result &&
              all.udp.value.counters[ROBUROC4_UDP_COUNT_RECEIVED] == 0 &&
              all.udp.value.address.port == address.port,
          "the socket's fields are others");
    check(roburoc4_udp_close(&all.udp.value) == 0, "close");
    check(roburoc4_recorder_close(recorder, NULL) == 0, "close the recorder");
}

static void read_pump(void) {
    roburoc4_result result;
    roburoc4_pump *pump = roburoc4_pump_create(NULL, NULL, 0, NULL, &result);
    roburoc4_pump_reader zero = {0};
    check(pump != NULL, "no pump");
    check(roburoc4_pump_take_events(pump, &zero) >= 0, "events since create");
    check(roburoc4_pump_reader_init(pump, &all.reader.value) == 0, "a reader");
    check(roburoc4_pump_take_events(pump, &all.reader.value) == 0 && all.reader.value.lost == 0,
          "a reader starts with what comes");
    roburoc4_pump_destroy(pump);
}

#ifdef NEWER
static void use_what_is_new(void) {
    check(all.config.value.new_field == 0, "a new field has another default");
    check(roburoc4_client_new(&all.client.value) == 0, "a new function");
    check(all.udp.value.counters[ROBUROC4_UDP_COUNT_NEW] == 1, "a new counter");
}
#else
static void use_what_is_new(void) {}
#endif

int main(int argc, char **argv) {
    check(argc == 2, "usage: program FOLDER");
    check(roburoc4_abi_version() == ROBUROC4_ABI_VERSION, "another ABI");
    memset(&all, NOT_OURS, sizeof all);
    connect_to_robot();
    arm();
    drive();
    check(robot_x_m() > 1.0, "the robot did not drive");
    move();
    record(argv[1]);
    read_pump();
    use_what_is_new();
    roburoc4_world_destroy(world);
    CHECK_BEHIND(client);
    CHECK_BEHIND(udp);
    CHECK_BEHIND(reader);
    CHECK_BEHIND(move);
    CHECK_BEHIND(config);
    CHECK_BEHIND(facts);
    CHECK_BEHIND(link);
    CHECK_BEHIND(service_link);
    CHECK_BEHIND(move_options);
    CHECK_BEHIND(move_view);
    CHECK_BEHIND(recorder_options);
    CHECK_BEHIND(sim_config);
    CHECK_BEHIND(sim_state);
    CHECK_BEHIND(sim_faults);
    printf("compiled for %06X, runs with %06X\n", (unsigned)ROBUROC4_VERSION,
           (unsigned)roburoc4_version());
    return 0;
}
