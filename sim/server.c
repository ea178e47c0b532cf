/* SPDX-License-Identifier: MIT
 *
 * The simulator in real time behind UDP sockets: a loop that waits, serves each robot, and carries
 * out the panel's commands.
 */
#include "server.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "carrier.h"
#include "number.h"

#define FLIGHTS_OF_ALL 65536u
#define FLIGHTS_MIN 256u
#define FLIGHTS_MAX 4096u
/* After a longer gap (a debugger, a suspended machine) the robots continue where they were. */
#define LONGEST_GAP_US 1000000u
#define MAX_INPUT_LINE 256

typedef struct served_robot {
    sim_carrier carrier;
    uint16_t port;
} served_robot;

typedef struct server_state {
    const server_options *options;
    net_sockets *net;
    served_robot *robots;
    uint64_t skipped_us, last_us;
    bool quit, input;
    char line[MAX_INPUT_LINE];
    size_t line_used;
    bool line_too_long;
    uint8_t buffer[SIM_LONGEST_UDP];
} server_state;

/* ------------------------------------------------------------------------------------- setup ---
 */

static bool has_faults(const roburoc4_sim_faults *faults) {
    return faults->loss > 0.0 || faults->duplicate > 0.0 || faults->reorder > 0.0 ||
           faults->corrupt > 0.0 || faults->delay_us > 0 || faults->jitter_us > 0;
}

static bool create_robot(const server_options *options, uint32_t index, sim_carrier *robot) {
    roburoc4_sim_config config = options->config;
    /* Each robot has a seed of its own, the same in every run. */
    config.seed += (uint64_t)index * 3;
    robot->sim = roburoc4_sim_create(&config);
    if (robot->sim == NULL || !has_faults(&options->faults)) {
        return robot->sim != NULL;
    }
    uint32_t flights = FLIGHTS_OF_ALL / options->robots;
    flights = flights < FLIGHTS_MIN ? FLIGHTS_MIN : flights > FLIGHTS_MAX ? FLIGHTS_MAX : flights;
    robot->in = sim_network_create(&options->faults, config.seed + 1, flights, SIM_LONGEST_FRAME);
    robot->out =
        sim_network_create(&options->faults, config.seed + 2, flights, ROBUROC4_SIM_MAX_TRANSMIT);
    return robot->in != NULL && robot->out != NULL;
}

/* A second socket of a robot, behind those of all robots. */
static bool open_status_port(server_state *server, uint32_t index) {
    const server_options *options = server->options;
    uint16_t port = 0;
    size_t status_index = options->robots + index;
    int error = net_bind(server->net, status_index, options->address, 0, &port);
    if (error != 0) {
        (void)fprintf(stderr, "roburoc4-sim: %s has no free port for statuses\n", options->address);
        return false;
    }
    server->robots[index].carrier.status_index = status_index;
    return true;
}

static bool open_robot(server_state *server, uint32_t index) {
    const server_options *options = server->options;
    served_robot *robot = &server->robots[index];
    uint16_t port = options->port == 0 ? 0 : (uint16_t)(options->port + index);
    robot->carrier.net = server->net;
    robot->carrier.index = index;
    robot->carrier.status_index = index;
    robot->carrier.buffer = server->buffer;
    if (!create_robot(options, index, &robot->carrier)) {
        (void)fprintf(stderr, "roburoc4-sim: out of memory: ask for fewer --robots\n");
        return false;
    }
    int error = net_bind(server->net, index, options->address, port, &robot->port);
    if (error != 0) {
        char text[128];
        net_error_text(error, text, sizeof text);
        (void)fprintf(stderr,
                      "roburoc4-sim: cannot use %s:%u: %s; choose another --port or --bind\n",
                      options->address, port, text);
        return false;
    }
    return options->config.other_status_port == 0 || open_status_port(server, index);
}

static bool open_all(server_state *server) {
    server->net = net_create((size_t)server->options->robots *
                             (server->options->config.other_status_port != 0 ? 2 : 1));
    server->robots = calloc(server->options->robots, sizeof *server->robots);
    if (server->net == NULL || server->robots == NULL) {
        (void)fprintf(stderr,
                      "roburoc4-sim: the system does not allow %u sockets: ask for fewer "
                      "--robots\n",
                      server->options->robots);
        return false;
    }
    for (uint32_t index = 0; index < server->options->robots; index++) {
        if (!open_robot(server, index)) {
            return false;
        }
    }
    return true;
}

static void close_all(server_state *server) {
    for (uint32_t index = 0; server->robots != NULL && index < server->options->robots; index++) {
        roburoc4_sim_destroy(server->robots[index].carrier.sim);
        sim_network_destroy(server->robots[index].carrier.in);
        sim_network_destroy(server->robots[index].carrier.out);
    }
    free(server->robots);
    if (server->net != NULL) {
        net_destroy(server->net);
    }
}

static void say_ready(const server_state *server) {
    (void)printf("roburoc4-sim: ready on");
    for (uint32_t index = 0; index < server->options->robots; index++) {
        (void)printf(" %s:%u", server->options->address, server->robots[index].port);
    }
    (void)printf("\n");
    (void)fflush(stdout);
}

/* ------------------------------------------------------------------------------------ panel --- */

/* `robot 3 pad a down` is for the third robot; without the prefix a line is for all. */
static bool choose_robots(const server_state *server, const char **line, uint32_t *first,
                          uint32_t *last) {
    *first = 1;
    *last = server->options->robots;
    if (strncmp(*line, "robot ", 6) != 0) {
        return true;
    }
    const char *number = *line + 6;
    size_t digits = strspn(number, "0123456789");
    uint64_t chosen = 0;
    if (!number_whole(number, digits, server->options->robots, &chosen) || chosen == 0) {
        return false;
    }
    *first = *last = (uint32_t)chosen;
    *line = number + digits;
    return true;
}

static void obey(server_state *server, const char *line) {
    char reply[ROBUROC4_SIM_REPLY_SIZE];
    uint32_t first = 0;
    uint32_t last = 0;
    if (strcmp(line, "quit") == 0) {
        server->quit = true;
        return;
    }
    if (!choose_robots(server, &line, &first, &last)) {
        (void)printf("error: usage: robot 1..%u COMMAND\n", server->options->robots);
        return;
    }
    for (uint32_t number = first; number <= last; number++) {
        roburoc4_result result =
            roburoc4_sim_panel(server->robots[number - 1].carrier.sim, line, reply, sizeof reply);
        bool each = strstr(line, "status") != NULL && server->options->robots > 1;
        if (result < 0) {
            (void)printf("error: %s\n", reply);
            return;
        }
        if (each) {
            (void)printf("robot %u: %s\n", number, reply);
        } else if (number == last) {
            (void)printf("%s\n", reply);
        }
    }
    if (strcmp(line, "help") == 0) {
        (void)printf("robot NUMBER COMMAND   (else a command is for all robots)\nquit\n");
    }
}

static void end_line(server_state *server) {
    while (server->line_used > 0 && strchr(" \t\r", server->line[server->line_used - 1]) != NULL) {
        server->line_used--;
    }
    server->line[server->line_used] = '\0';
    if (server->line_too_long) {
        (void)printf("error: line too long: try help\n");
    } else if (server->line_used > 0) {
        obey(server, server->line);
    }
    (void)fflush(stdout);
    server->line_used = 0;
    server->line_too_long = false;
}

static void read_panel(server_state *server) {
    char text[MAX_INPUT_LINE];
    ptrdiff_t size = net_read_input(server->net, text, sizeof text);
    if (size < 0) {
        end_line(server);
        server->input = false;
        return;
    }
    for (ptrdiff_t at = 0; at < size && !server->quit; at++) {
        if (text[at] == '\n') {
            end_line(server);
        } else if (server->line_used + 1 < sizeof server->line) {
            server->line[server->line_used++] = text[at];
        } else {
            server->line_too_long = true;
        }
    }
}

/* ------------------------------------------------------------------------------------- loop --- */

static uint64_t robot_time_us(server_state *server) {
    uint64_t now_us = net_now_us();
    if (now_us - server->last_us > LONGEST_GAP_US) {
        server->skipped_us += now_us - server->last_us;
    }
    server->last_us = now_us;
    return now_us - server->skipped_us;
}

static uint64_t next_deadline(const server_state *server) {
    uint64_t next_us = UINT64_MAX;
    for (uint32_t index = 0; index < server->options->robots; index++) {
        uint64_t due_us = sim_carrier_next_deadline(&server->robots[index].carrier);
        next_us = due_us < next_us ? due_us : next_us;
    }
    return next_us;
}

static void turn(server_state *server) {
    uint64_t now_us = robot_time_us(server);
    for (uint32_t index = 0; index < server->options->robots; index++) {
        sim_carrier_turn(&server->robots[index].carrier, now_us);
    }
    if (server->input) {
        read_panel(server);
    }
}

static void serve(server_state *server) {
    server->last_us = net_now_us();
    server->input = server->options->panel;
    turn(server);
    while (!server->quit && !net_stop_wanted()) {
        uint64_t now_us = robot_time_us(server);
        uint64_t due_us = next_deadline(server);
        net_wait(server->net, server->input, due_us > now_us ? due_us - now_us : 0);
        turn(server);
    }
}

int server_run(const server_options *options) {
    server_state *running = calloc(1, sizeof *running);
    if (running == NULL) {
        (void)fprintf(stderr, "roburoc4-sim: out of memory\n");
        return 1;
    }
    running->options = options;
    net_listen_for_stop(); /* before it prints that it is ready: a signal may follow at once */
    bool opened = open_all(running);
    if (opened) {
        say_ready(running);
        serve(running);
    }
    close_all(running);
    free(running);
    return opened ? 0 : 1;
}
