/* SPDX-License-Identifier: MIT
 *
 * Commands of simulated robots: in virtual time, or in real time on a port and a thread of its own.
 */
#include <errno.h>
#include <stdlib.h>

#include "answers.h"
#include "commands.h"
#include "fail.h"
#include "handles.h"
#include "host.h"
#include "net.h"

typedef struct simulator {
    roburoc4_sim *sim; /* belongs to one of these */
    world *home;       /* in virtual time, or NULL */
    sim_host *host;    /* on a port, or NULL */
} simulator;

static simulator *told_simulator(const call *told) {
    simulator *found;
    double id;
    if (!take_number(told->arguments[0], "id", &id)) {
        return NULL;
    }
    found = handles_find(HANDLE_SIMULATOR, id);
    if (found == NULL) {
        (void)fail(FAIL_CLOSED,
                   "this simulator was deleted; make a new one with roburoc4.Simulator");
    }
    return found;
}

static void begin(const simulator *one) {
    if (one->host != NULL) {
        sim_host_lock(one->host);
    }
}

static void end(const simulator *one) {
    if (one->host != NULL) {
        sim_host_unlock(one->host);
    } else {
        world_exchange(one->home);
    }
}

/* -------------------------------------------------------------------------------------- life ---
 */

static void close_simulator(simulator *one) {
    if (one->host != NULL) {
        sim_host_destroy(one->host);
    } else if (one->home != NULL) {
        world_close(one->home);
    }
    free(one);
}

void close_simulators(void) {
    uint32_t place;
    for (place = 0; place < HANDLES_MAX; place++) {
        simulator *one = handles_at(HANDLE_SIMULATOR, place);
        if (one != NULL) {
            handles_clear(place);
            close_simulator(one);
        }
    }
}

static int begin_world(simulator *one, const roburoc4_sim_config *config) {
    one->home = world_create(config);
    if (one->home == NULL) {
        return fail(FAIL_LIMIT, "no memory for another simulator");
    }
    one->sim = one->home->sim;
    return 1;
}

static int begin_host(simulator *one, const roburoc4_sim_config *config, const char *address,
                      uint16_t port) {
    int error = 0;
    one->sim = roburoc4_sim_create(config);
    if (one->sim == NULL) {
        return fail(FAIL_LIMIT, "no memory for another simulator");
    }
    one->host = sim_host_open(one->sim, address, port, &error);
    if (one->host == NULL) {
        roburoc4_sim_destroy(one->sim);
        const char *remedy = "";
        char text[128];
        net_error_text(error, text, sizeof text);
        if (port != 0 && (error == EADDRINUSE || error == EACCES)) {
            remedy = "; give another port, or 0 for any";
        } else if (error == EADDRNOTAVAIL) {
            remedy = "; give an address of this machine";
        }
        return fail(FAIL_NETWORK, "cannot serve on %s:%u: %s%s", address, port, text, remedy);
    }
    return 1;
}

static int give_id(const call *told, simulator *made) {
    double id = handles_add(HANDLE_SIMULATOR, made);
    if (id == 0.0) {
        close_simulator(made);
        return fail(FAIL_LIMIT, "%d robots and simulators live already: delete one", HANDLES_MAX);
    }
    told->results[0] = mxCreateDoubleScalar(id);
    return 1;
}

/* simOpen(options) or simOpen(options, host, port): id */
static int open_simulator(const call *told) {
    roburoc4_sim_config config;
    char address[TEXT_SIZE];
    int64_t port = -1;
    simulator *made;
    if (!settings_of_simulator(told->arguments[0], &config)) {
        return 0;
    }
    if (told->count > 1 && (told->count != 3 || !take_text(told->arguments[1], "host", address) ||
                            !take_whole(told->arguments[2], "port", 0, 65535, &port))) {
        return told->count == 3 ? 0 : fail(FAIL_ARGUMENT, "host and port are needed");
    }
    made = calloc(1, sizeof *made);
    if (made == NULL) {
        return fail(FAIL_LIMIT, "no memory for another simulator");
    }
    if (!(port < 0 ? begin_world(made, &config)
                   : begin_host(made, &config, address, (uint16_t)port))) {
        free(made);
        return 0;
    }
    return give_id(told, made);
}

/* simClose(id): nothing for one that is closed already */
static int close_one(const call *told) {
    simulator *one;
    double id;
    if (!take_number(told->arguments[0], "id", &id)) {
        return 0;
    }
    one = handles_find(HANDLE_SIMULATOR, id);
    if (one != NULL) {
        handles_remove(id);
        close_simulator(one);
    }
    return 1;
}

/* simPort(id): 0 in virtual time */
static int look_port(const call *told) {
    const simulator *one = told_simulator(told);
    if (one == NULL) {
        return 0;
    }
    told->results[0] =
        mxCreateDoubleScalar(one->host != NULL ? (double)sim_host_port(one->host) : 0.0);
    return 1;
}

static int fail_real_time(void) {
    return fail(FAIL_ARGUMENT, "a simulator on a port runs in real time: use pause(), and "
                               "roburoc4.Robot with its address");
}

/* simConnect(id, options): id of a robot in virtual time */
static int connect_robot(const call *told) {
    simulator *one = told_simulator(told);
    robot_settings settings;
    if (one == NULL || !settings_of_robot(told->arguments[1], &settings)) {
        return 0;
    }
    if (one->home == NULL) {
        return fail_real_time();
    }
    return give_robot(told, robot_join(one->home, &settings));
}

/* -------------------------------------------------------------------------------------- time ---
 */

/* So much virtual time takes well below LONGEST_WAIT_S, also with as many robots as can be. */
#define LONGEST_STEP_S 1.0

/* simStep(id, seconds) */
static int step(const call *told) {
    simulator *one = told_simulator(told);
    double seconds;
    if (one == NULL || !take_range(told->arguments[1], "seconds", 0.0, LONGEST_STEP_S, &seconds)) {
        return 0;
    }
    if (one->home == NULL) {
        return fail_real_time();
    }
    world_run(one->home, (uint64_t)(seconds * 1e6 + 0.5));
    return 1;
}

/* simFaults(id, loss, duplicate, reorder, corrupt, delay_ms, jitter_ms) */
static int set_faults(const call *told) {
    static const char *const names[] = {"loss",    "duplicate", "reorder",
                                        "corrupt", "delay_ms",  "jitter_ms"};
    simulator *one = told_simulator(told);
    roburoc4_sim_faults faults;
    roburoc4_result result;
    double v[6];
    int i;
    if (one == NULL) {
        return 0;
    }
    for (i = 0; i < 6; i++) {
        if (!take_range(told->arguments[i + 1], names[i], 0.0, i < 4 ? 1.0 : 60000.0, &v[i])) {
            return 0;
        }
    }
    faults = (roburoc4_sim_faults){
        v[0], v[1], v[2], v[3], (uint32_t)(v[4] * 1e3), (uint32_t)(v[5] * 1e3)};
    begin(one);
    result = one->host != NULL ? sim_host_set_faults(one->host, &faults)
                               : world_set_faults(one->home, &faults);
    end(one);
    return result >= 0 ? 1 : fail_result("faults", result);
}

/* ------------------------------------------------------------------------- looking and hands ---
 */

static void add_motion(answer *out, const roburoc4_sim_state *it) {
    answer_number(out, "true_x_m", it->true_x_m);
    answer_number(out, "true_y_m", it->true_y_m);
    answer_number(out, "true_theta_rad", it->true_theta_rad);
    answer_number(out, "true_linear_m_s", it->true_linear_m_s);
    answer_number(out, "true_angular_rad_s", it->true_angular_rad_s);
    answer_number(out, "odometry_x_m", it->odometry_x_m);
    answer_number(out, "odometry_y_m", it->odometry_y_m);
    answer_number(out, "odometry_theta_rad", it->odometry_theta_rad);
    answer_number(out, "wheel_linear_m_s", it->wheel_linear_m_s);
    answer_number(out, "wheel_angular_rad_s", it->wheel_angular_rad_s);
    answer_number(out, "target_linear_m_s", it->target_linear_m_s);
    answer_number(out, "target_angular_rad_s", it->target_angular_rad_s);
    answer_number(out, "last_linear_m_s", it->last_linear_m_s);
    answer_number(out, "last_angular_rad_s", it->last_angular_rad_s);
    answer_number(out, "last_command_s", (double)it->last_command_us / 1e6);
}

static void add_panel(answer *out, const roburoc4_sim_state *it) {
    answer_row(out, "telemeters_m", it->telemeters_m, 2);
    answer_number(out, "battery_percent", (double)it->battery_percent);
    answer_number(out, "battery_v", (double)it->battery_v);
    answer_byte(out, "battery_state", (uint8_t)it->battery_state);
    answer_flag(out, "powered", it->powered);
    answer_flag(out, "motors_enabled", it->motors_enabled);
    answer_flag(out, "estop_local", it->estop_local);
    answer_flag(out, "estop_remote", it->estop_remote);
    answer_flag(out, "brakes_released", it->brakes_released);
    answer_flag(out, "charger", it->charger);
    answer_flag(out, "overridden", it->overridden);
    answer_flag(out, "watchdog_bitten", it->watchdog_bitten);
    answer_flag(out, "bumper_front", it->bumper_front);
    answer_flag(out, "bumper_rear", it->bumper_rear);
}

static void add_counts(answer *out, const roburoc4_sim_state *it) {
    answer_number(out, "reboots", it->reboots);
    answer_number(out, "requests", it->requests);
    answer_number(out, "errors", it->errors);
    answer_number(out, "speed_commands", it->speed_commands);
    answer_number(out, "nonzero_speed_commands", it->nonzero_speed_commands);
    answer_number(out, "refused_speed_commands", it->refused_speed_commands);
    answer_number(out, "io_commands", it->io_commands);
    answer_number(out, "ignored", it->ignored);
    answer_number(out, "peers", it->peers);
    answer_number(out, "subscriptions", it->subscriptions);
}

/* simState(id) */
static int look_state(const call *told) {
    const simulator *one = told_simulator(told);
    roburoc4_sim_state state = {.size = sizeof state};
    answer out;
    if (one == NULL) {
        return 0;
    }
    begin(one);
    (void)roburoc4_sim_snapshot(one->sim, &state);
    end(one);
    answer_begin(&out);
    answer_number(&out, "time_s", (double)state.now_us / 1e6);
    answer_cycles(&out, "robot_cycles", state.cycles);
    add_motion(&out, &state);
    add_panel(&out, &state);
    add_counts(&out, &state);
    told->results[0] = answer_finish(&out);
    return 1;
}

/* simOutput(id, index): what a digital output was last set to */
static int look_output(const call *told) {
    const simulator *one = told_simulator(told);
    roburoc4_result on;
    int64_t index;
    if (one == NULL || !take_whole(told->arguments[1], "index", 0, UINT16_MAX, &index)) {
        return 0;
    }
    begin(one);
    on = roburoc4_sim_digital_output(one->sim, (uint32_t)index);
    end(one);
    told->results[0] = mxCreateLogicalScalar(on > 0);
    return on >= 0 ? 1 : fail_result("output", on);
}

/* simPanel(id, line): the reply */
static int panel(const call *told) {
    const simulator *one = told_simulator(told);
    static char reply[ROBUROC4_SIM_REPLY];
    char line[TEXT_SIZE];
    roburoc4_result result;
    if (one == NULL || !take_text(told->arguments[1], "line", line)) {
        return 0;
    }
    begin(one);
    result = roburoc4_sim_panel(one->sim, line, reply, sizeof reply);
    end(one);
    if (result < 0) {
        return fail(FAIL_ARGUMENT, "'%s': %s", line, reply);
    }
    told->results[0] = mxCreateString(reply);
    return 1;
}

const command simulator_commands[] = {
    {"simOpen", open_simulator, -1},
    {"simClose", close_one, 1},
    {"simPort", look_port, 1},
    {"simConnect", connect_robot, 2},
    {"simStep", step, 2},
    {"simFaults", set_faults, 7},
    {"simState", look_state, 1},
    {"simOutput", look_output, 2},
    {"simPanel", panel, 2},
    {NULL, NULL, 0},
};
