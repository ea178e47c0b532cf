/* SPDX-License-Identifier: MIT
 *
 * Commands of simulated robots: in virtual time, or in real time on a port with its own thread.
 */
#include <errno.h>
#include <string.h>

#include "commands.h"
#include "net.h"

/* ------------------------------------------------------------------------------ lifecycle --- */

static void close_simulator(void *s) {
    handles_remove(s);
    simulation_destroy(s);
}

void close_simulators(void) {
    handles_each(HANDLE_SIMULATOR, close_simulator);
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

/* simOpen(options, host, port): [id port]; with '' as host in virtual time */
static int open_simulator(call *in) {
    const char *host = in->texts[1];
    roburoc4_sim_config config;
    simulation *made;
    double *row, id;
    if (!settings_of_simulator(in->arguments[0], &config)) {
        return 0;
    }
    (void)fail(FAIL_LIMIT, "there is no memory for another simulator");
    made = host[0] == '\0' ? simulation_in_world(&config)
                           : serve(&config, host, (uint16_t)in->numbers[2]);
    if (made == NULL) {
        return 0;
    }
    id = handles_add(HANDLE_SIMULATOR, made);
    if (id == 0.0) {
        close_simulator(made);
        return 0;
    }
    row = make_row(&in->results[0], 2);
    row[0] = id;
    row[1] = simulation_port(made);
    return 1;
}

/* simClose(id) */
static int close_one(call *in) {
    close_simulator(in->object);
    return 1;
}

int simulator_is_virtual(const simulation *s) {
    return simulation_port(s) == 0 ||
           fail(FAIL_ARGUMENT, "a simulator on a port runs in real time; use pause(), and "
                               "roburoc4.Robot with its address");
}

/* Simulating this much virtual time takes well below LONGEST_WAIT_S, even with all robots. */
#define LONGEST_STEP_S 1.0

/* simStep(id, seconds) */
static int step(call *in) {
    simulation *s = in->object;
    if (!simulator_is_virtual(s)) {
        return 0;
    }
    simulation_run(s, simulation_now_us(s) + (uint64_t)(in->numbers[0] * 1e6 + 0.5));
    return 1;
}

/* simFaults(id, loss, duplicate, reorder, corrupt, delay_ms, jitter_ms) */
static int set_faults(call *in) {
    const double *of = in->numbers;
    const roburoc4_sim_faults faults = {.size = sizeof faults,
                                        .loss = of[0],
                                        .duplicate = of[1],
                                        .reorder = of[2],
                                        .corrupt = of[3],
                                        .delay_us = (uint32_t)(of[4] * 1e3),
                                        .jitter_us = (uint32_t)(of[5] * 1e3)};
    return done("faults", simulation_set_faults(in->object, &faults));
}

/* -------------------------------------------------------------------- looking and acting --- */

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
    ON(charger), ON(overridden), ON(watchdog_tripped), ON(front_bumper), ON(rear_bumper),
    COUNT(reboots), COUNT(requests), COUNT(errors), COUNT(speed_commands),
    COUNT(nonzero_speed_commands), COUNT(refused_speed_commands), COUNT(io_commands),
    COUNT(ignored), COUNT(peers), COUNT(subscriptions),
};
/* clang-format on */

/* simState(id) */
static int read_state(call *in) {
    roburoc4_sim_state state = {.size = sizeof state};
    roburoc4_sample seen = {.service = ROBUROC4_SERVICE_TELEMETER, .host_us = 1};
    (void)roburoc4_sim_get_state(simulation_lock(in->object), &state);
    simulation_unlock(in->object);
    seen.value.distances.count = COUNT_OF(state.distances_m);
    memcpy(seen.value.distances.distances_m, state.distances_m, sizeof state.distances_m);
    answer_fields(&in->out, state_fields, COUNT_OF(state_fields), &state);
    sample_values(&in->out, &seen);
    return 1;
}

/* simSet(id, control, value), or simGet(id, control): its value */
static int set_or_get(call *in) {
    const char *name = in->texts[0];
    const roburoc4_result control = roburoc4_sim_control_find(name);
    roburoc4_result result = control;
    roburoc4_sim *sim = simulation_lock(in->object);
    if (control >= 0) {
        result = in->count == 2 ? roburoc4_sim_set(sim, (uint32_t)control, in->numbers[1])
                                : roburoc4_sim_get(sim, (uint32_t)control, &in->number);
    }
    simulation_unlock(in->object);
    switch (result) {
    case ROBUROC4_ERR_STATE:
        return fail(FAIL_ARGUMENT,
                    "%s: impossible now; turn power on, release both emergency stops "
                    "and set the brakes to automatic first",
                    name);
    case ROBUROC4_ERR_INDEX:
        return fail(FAIL_ARGUMENT,
                    "%s: this robot has no such control, or it is not for that; see help "
                    "roburoc4.Simulator.set",
                    name);
    default:
        return result >= 0 || fail(FAIL_ARGUMENT, "%s: %g is out of range", name, in->numbers[1]);
    }
}

/* simPanel(id, line): the reply */
static int panel(call *in) {
    static char reply[ROBUROC4_SIM_REPLY_SIZE];
    const roburoc4_result result =
        roburoc4_sim_panel(simulation_lock(in->object), in->texts[0], reply, sizeof reply);
    simulation_unlock(in->object);
    if (result < 0) {
        return fail(FAIL_ARGUMENT, "'%s': %s", in->texts[0], reply);
    }
    in->results[0] = mxCreateString(reply);
    return 1;
}

/* clang-format off */
const command simulator_commands[] = {
    {"simOpen", NO_ID, OTHER, open_simulator, {OPTIONS, TEXT("host"), WHOLE("port", 0, 65535)}},
    {"simClose", ANY_SIMULATOR, NOTHING, close_one, {NONE}},
    {"simStep", SIMULATOR, NOTHING, step, {WITHIN("seconds", 0, LONGEST_STEP_S)}},
    {"simFaults", SIMULATOR, NOTHING, set_faults,
     {WITHIN("loss", 0, 1), WITHIN("duplicate", 0, 1), WITHIN("reorder", 0, 1),
      WITHIN("corrupt", 0, 1), WITHIN("delay_ms", 0, 60000), WITHIN("jitter_ms", 0, 60000)}},
    {"simState", SIMULATOR, STRUCT, read_state, {NONE}},
    {"simSet", SIMULATOR, NOTHING, set_or_get, {TEXT("control"), ANY_NUMBER("value")}},
    {"simGet", SIMULATOR, NUMBER, set_or_get, {TEXT("control")}},
    {"simPanel", SIMULATOR, OTHER, panel, {TEXT("line")}},
    LAST,
};
/* clang-format on */
