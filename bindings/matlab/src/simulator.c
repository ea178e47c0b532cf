/* SPDX-License-Identifier: MIT
 *
 * Commands of simulated robots: in virtual time, or in real time on a port with its own thread.
 */
#include <errno.h>

#include "commands.h"
#include "fail.h"
#include "net.h"

/* ----------------------------------------------------------------------------------- life --- */

static void close_simulator(simulation *s) {
    handles_remove(s);
    robots_lose(s);
    simulation_destroy(s);
}

void close_simulators(void) {
    for (uint32_t place = 0; place < HANDLES_MAX; place++) {
        simulation *s = handles_at(HANDLE_SIMULATOR, place);
        if (s != NULL) {
            close_simulator(s);
        }
    }
}

/* NULL after noting why not. */
static simulation *serve(const roburoc4_sim_config *config, const char *address, uint16_t port) {
    const char *remedy = "";
    char text[128];
    int error;
    simulation *s = simulation_on_port(config, address, port, &error);
    if (s == NULL) {
        net_error_text(error, text, sizeof text);
        if (port != 0 && (error == EADDRINUSE || error == EACCES)) {
            remedy = "; give another port, or 0 for any";
        } else if (error == EADDRNOTAVAIL) {
            remedy = "; give an address of this machine";
        }
        (void)fail(FAIL_NETWORK, "cannot serve on %s:%u: %s%s", address, port, text, remedy);
    }
    return s;
}

/* simOpen(options) or simOpen(options, host, port): id */
static int open_simulator(call *in) {
    roburoc4_sim_config config;
    char address[TEXT_SIZE];
    int64_t port = -1;
    simulation *made;
    if (!settings_of_simulator(in->arguments[0], &config)) {
        return 0;
    }
    if (in->count > 1 && (in->count != 3 || !take_text(in->arguments[1], "host", address) ||
                          !take_whole(in->arguments[2], "port", 0, 65535, &port))) {
        return in->count == 3 ? 0 : fail(FAIL_ARGUMENT, "give a host and a port");
    }
    (void)fail(FAIL_LIMIT, "there is no memory for another simulator");
    made = port < 0 ? simulation_in_world(&config) : serve(&config, address, (uint16_t)port);
    if (made == NULL) {
        return 0;
    }
    in->number = handles_add(HANDLE_SIMULATOR, made);
    if (in->number == 0.0) {
        close_simulator(made);
    }
    return in->number != 0.0;
}

/* simClose(id): delete() can be called twice */
static int close_one(call *in) {
    if (in->object != NULL) {
        close_simulator(in->object);
    }
    return 1;
}

/* simPort(id): 0 in virtual time */
static int read_port(call *in) {
    in->number = simulation_port(in->object);
    return 1;
}

/* ---------------------------------------------------------------------------- virtual time --- */

static int fail_real_time(void) {
    return fail(FAIL_ARGUMENT, "a simulator on a port runs in real time; use pause(), and "
                               "roburoc4.Robot with its address");
}

/* simConnect(id, options): id of a robot in virtual time */
static int connect_robot(call *in) {
    robot_settings settings;
    if (!settings_of_robot(in->arguments[0], &settings)) {
        return 0;
    }
    if (simulation_port(in->object) != 0) {
        return fail_real_time();
    }
    in->number = robot_join(in->object, &settings);
    return in->number != 0.0;
}

/* Simulating this much virtual time takes well below LONGEST_WAIT_S, even with all robots. */
#define LONGEST_STEP_S 1.0

/* simStep(id, seconds) */
static int step(call *in) {
    simulation *s = in->object;
    double seconds;
    if (!take_range(in->arguments[0], "seconds", 0.0, LONGEST_STEP_S, &seconds)) {
        return 0;
    }
    if (simulation_port(s) != 0) {
        return fail_real_time();
    }
    simulation_run(s, simulation_now_us(s) + (uint64_t)(seconds * 1e6 + 0.5));
    return 1;
}

/* simFaults(id, faults) */
static int set_faults(call *in) {
    roburoc4_sim_faults faults;
    roburoc4_result result;
    if (!settings_of_faults(in->arguments[0], &faults)) {
        return 0;
    }
    result = simulation_set_faults(in->object, &faults);
    return result >= 0 || fail_result("the shares of faults: give 0 to 1", result);
}

/* ------------------------------------------------------------------------ looking and acting ---
 */

#define SI(member) FIELD(roburoc4_sim_state, member, FLOAT)
#define ON(member) FIELD(roburoc4_sim_state, member, FLAG)
#define COUNT(member) FIELD(roburoc4_sim_state, member, UINT)

/* clang-format off */
static const field state_fields[] = {
    FIELD_AS("time_s", roburoc4_sim_state, now_us, SECONDS),
    FIELD_AS("robot_cycles", roburoc4_sim_state, cycles, CYCLES),
    SI(true_x_m), SI(true_y_m), SI(true_theta_rad), SI(true_linear_m_s), SI(true_angular_rad_s),
    SI(odometry_x_m), SI(odometry_y_m), SI(odometry_theta_rad), SI(wheel_linear_m_s),
    SI(wheel_angular_rad_s), SI(target_linear_m_s), SI(target_angular_rad_s), SI(last_linear_m_s),
    SI(last_angular_rad_s),
    FIELD_AS("last_command_s", roburoc4_sim_state, last_command_us, SECONDS),
    FIELD(roburoc4_sim_state, battery_percent, FLOAT), FIELD(roburoc4_sim_state, battery_v, FLOAT),
    FIELD(roburoc4_sim_state, battery_state, BYTE),
    ON(powered), ON(motors_enabled), ON(estop_local), ON(estop_remote), ON(brakes_released),
    ON(charger), ON(overridden), ON(watchdog_tripped), ON(bumper_front), ON(bumper_rear),
    COUNT(reboots), COUNT(requests), COUNT(errors), COUNT(speed_commands),
    COUNT(nonzero_speed_commands), COUNT(refused_speed_commands), COUNT(io_commands),
    COUNT(ignored), COUNT(peers), COUNT(subscriptions),
};
/* clang-format on */
static const field telemeters = {"distances_m", 0, sizeof(float), FIELD_FLOAT, 0};

/* simState(id) */
static int read_state(call *in) {
    roburoc4_sim_state state = {.size = sizeof state};
    (void)roburoc4_sim_get_state(simulation_lock(in->object), &state);
    simulation_unlock(in->object);
    answer_fields(&in->out, state_fields, COUNT_OF(state_fields), &state);
    answer_rows(&in->out, &telemeters, 1, state.distances_m, sizeof *state.distances_m,
                COUNT_OF(state.distances_m));
    return 1;
}

/* The number of a named control. */
static int find_control(const char *name, uint32_t *out) {
    roburoc4_result number = roburoc4_sim_control_find(name);
    *out = (uint32_t)number;
    return number >= 0 ||
           fail(FAIL_ARGUMENT, "there is no control '%s'; see help roburoc4.Simulator.set", name);
}

static int fail_control(const char *name, double value, roburoc4_result result) {
    if (result == ROBUROC4_ERR_STATE) {
        return fail(FAIL_ARGUMENT,
                    "%s: impossible now; turn power on, release both emergency stops "
                    "and set the brakes to automatic first",
                    name);
    }
    return result == ROBUROC4_ERR_INDEX
               ? fail(FAIL_ARGUMENT, "%s: this robot has none, or it is not for that", name)
               : fail(FAIL_ARGUMENT, "%s: %g is out of range", name, value);
}

/* simSet(id, control, value) */
static int set_control(call *in) {
    char name[TEXT_SIZE];
    roburoc4_result result;
    uint32_t control;
    double value;
    if (!take_text(in->arguments[0], "control", name) || !find_control(name, &control) ||
        !take_number(in->arguments[1], name, &value)) {
        return 0;
    }
    result = roburoc4_sim_set(simulation_lock(in->object), control, value);
    simulation_unlock(in->object);
    return result >= 0 || fail_control(name, value, result);
}

/* simGet(id, control) */
static int get_control(call *in) {
    char name[TEXT_SIZE];
    roburoc4_result result;
    uint32_t control;
    if (!take_text(in->arguments[0], "control", name) || !find_control(name, &control)) {
        return 0;
    }
    result = roburoc4_sim_get(simulation_lock(in->object), control, &in->number);
    simulation_unlock(in->object);
    return result >= 0 || fail_control(name, 0.0, result);
}

/* simPanel(id, line): the reply */
static int panel(call *in) {
    static char reply[ROBUROC4_SIM_REPLY_SIZE];
    char line[TEXT_SIZE];
    roburoc4_result result;
    if (!take_text(in->arguments[0], "line", line)) {
        return 0;
    }
    result = roburoc4_sim_panel(simulation_lock(in->object), line, reply, sizeof reply);
    simulation_unlock(in->object);
    if (result < 0) {
        return fail(FAIL_ARGUMENT, "'%s': %s", line, reply);
    }
    in->results[0] = mxCreateString(reply);
    return 1;
}

const command simulator_commands[] = {
    {"simOpen", NO_ID, -2, NUMBER, open_simulator},
    {"simClose", ANY_SIMULATOR, 0, NOTHING, close_one},
    {"simPort", SIMULATOR, 0, NUMBER, read_port},
    {"simConnect", SIMULATOR, 1, NUMBER, connect_robot},
    {"simStep", SIMULATOR, 1, NOTHING, step},
    {"simFaults", SIMULATOR, 1, NOTHING, set_faults},
    {"simState", SIMULATOR, 0, STRUCT, read_state},
    {"simSet", SIMULATOR, 2, NOTHING, set_control},
    {"simGet", SIMULATOR, 1, NUMBER, get_control},
    {"simPanel", SIMULATOR, 1, OTHER, panel},
    {NULL, NO_ID, 0, NOTHING, NULL},
};
