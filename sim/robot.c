/* SPDX-License-Identifier: MIT
 *
 * A simulated robot's life: creation, time, the way in and out for datagrams, and the snapshot.
 * Its one job is to join the parts; each cycle runs them in one fixed order.
 */
#include <stdlib.h>

#include "model.h"

static void begin(roburoc4_sim *sim, const roburoc4_sim_config *config) {
    sim->config = *config;
    sim->random = config->seed;
    sim->truth.x_m = config->start_x_m;
    sim->truth.y_m = config->start_y_m;
    sim->truth.theta_rad = sim_wrap(config->start_theta_rad);
    sim_motion_init(sim);
    sim_obstacles_init(sim);
    sim_battery_set(sim, config->battery_percent);
    roburoc4_sim_unpin_inputs(sim);
    roburoc4_sim_release_pad(sim);
    sim_cockpit_power_up(sim);
}

roburoc4_sim *roburoc4_sim_create(const roburoc4_sim_config *config) {
    roburoc4_sim_config defaults;
    roburoc4_sim_config_init(&defaults);
    config = config != NULL ? config : &defaults;
    if (roburoc4_sim_config_error(config) != NULL) {
        return NULL;
    }
    roburoc4_sim *sim = calloc(1, sizeof *sim);
    if (sim != NULL) {
        begin(sim, config);
    }
    return sim;
}

void roburoc4_sim_destroy(roburoc4_sim *sim) {
    free(sim);
}

roburoc4_result roburoc4_sim_reconfigure(roburoc4_sim *sim, const roburoc4_sim_config *config) {
    if (roburoc4_sim_config_error(config) != NULL) {
        return ROBUROC4_ERR_CONFIG;
    }
    float percent = sim_battery_percent(sim);
    bool was_powered = sim->powered;
    sim->config = *config;
    roburoc4_sim_set_power(sim, 0);
    sim_motion_init(sim);
    sim_battery_set(sim, percent);
    roburoc4_sim_unpin_inputs(sim);
    roburoc4_sim_set_power(sim, was_powered ? 1 : 0);
    return ROBUROC4_OK;
}

/* ------------------------------------------------------------------------ datagrams and time ---
 */

void roburoc4_sim_receive(roburoc4_sim *sim, uint64_t peer, const uint8_t *data, size_t size) {
    if (sim->powered) {
        sim_protocol_receive(sim, peer, data, size);
    }
}

static void run_cycle(roburoc4_sim *sim) {
    sim->cycles += sim->powered ? 1u : 0u;
    sim_cockpit_cycle(sim);
    sim_motion_cycle(sim);
    sim_battery_cycle(sim);
    if (sim->powered) {
        sim_services_notify(sim);
    }
}

void roburoc4_sim_advance(roburoc4_sim *sim, uint64_t now_us) {
    if (!sim->started) {
        sim->started = true;
        sim->now_us = now_us;
        sim->next_us = now_us + ROBUROC4_CYCLE_US;
        return;
    }
    while (sim->next_us <= now_us) {
        sim->now_us = sim->next_us;
        sim->next_us += ROBUROC4_CYCLE_US;
        run_cycle(sim);
    }
    if (now_us > sim->now_us) {
        sim->now_us = now_us;
    }
}

roburoc4_result roburoc4_sim_poll_transmit(roburoc4_sim *sim, uint64_t *peer, uint8_t *buffer,
                                           size_t capacity) {
    return sim_queue_pop(&sim->queue, peer, buffer, capacity);
}

uint64_t roburoc4_sim_next_deadline(const roburoc4_sim *sim) {
    return sim->started ? sim->next_us : 0;
}

void roburoc4_sim_peer_unreachable(roburoc4_sim *sim, uint64_t peer) {
    sim_peers_unreachable(sim, peer);
}

/* ----------------------------------------------------------------------------- observation --- */

static void fill_motion(const roburoc4_sim *sim, roburoc4_sim_state *state) {
    state->true_x_m = sim->truth.x_m;
    state->true_y_m = sim->truth.y_m;
    state->true_theta_rad = sim->truth.theta_rad;
    state->true_linear_m_s = sim->body.linear_m_s;
    state->true_angular_rad_s = sim->body.angular_rad_s;
    state->odometry_x_m = sim->odometry.x_m;
    state->odometry_y_m = sim->odometry.y_m;
    state->odometry_theta_rad = sim->odometry.theta_rad;
    state->wheel_linear_m_s = sim->linear.speed;
    state->wheel_angular_rad_s = sim->angular.speed;
    state->target_linear_m_s = sim->target.linear_m_s;
    state->target_angular_rad_s = sim->target.angular_rad_s;
    for (uint32_t which = 0; which < ROBUROC4_TELEMETER_COUNT; which++) {
        state->telemeters_m[which] = sim_telemeter_distance(sim, which);
    }
}

static void fill_panel(const roburoc4_sim *sim, roburoc4_sim_state *state) {
    state->battery_state = sim_battery_state(sim);
    state->battery_percent = sim_battery_percent(sim);
    state->battery_v = sim_battery_voltage(sim);
    state->powered = sim->powered;
    state->motors_enabled = sim->motors;
    state->estop_local = sim->estop[ROBUROC4_SIM_ESTOP_LOCAL];
    state->estop_remote = sim->estop[ROBUROC4_SIM_ESTOP_REMOTE];
    state->brakes_released = sim->brakes_released;
    state->charger = sim->charger;
    state->overridden = sim_pad_drives(sim);
    state->watchdog_tripped = !sim->fed;
    state->bumper_front = sim_bumper(sim, ROBUROC4_SIM_FRONT);
    state->bumper_rear = sim_bumper(sim, ROBUROC4_SIM_REAR);
}

static void fill_link(const roburoc4_sim *sim, roburoc4_sim_state *state) {
    state->peers = 0;
    state->subscriptions = 0;
    for (uint32_t slot = 0; slot < sim->peer_count; slot++) {
        uint32_t count = sim_peer_subscriptions(&sim->peers[slot]);
        state->subscriptions += count;
        state->peers += count != 0 ? 1u : 0u;
    }
}

roburoc4_result roburoc4_sim_snapshot(const roburoc4_sim *sim, roburoc4_sim_state *state) {
    if (state->size != sizeof *state) {
        return ROBUROC4_ERR_SIZE;
    }
    *state = sim->counts;
    state->size = sizeof *state;
    state->now_us = sim->now_us;
    state->cycles = sim->cycles;
    fill_motion(sim, state);
    fill_panel(sim, state);
    fill_link(sim, state);
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_sim_analog_output(const roburoc4_sim *sim, uint32_t index, float *value) {
    if (index >= (uint32_t)sim->config.analog_outputs) {
        return ROBUROC4_ERR_INDEX;
    }
    *value = sim->analog_outputs[index];
    return ROBUROC4_OK;
}

roburoc4_result roburoc4_sim_digital_output(const roburoc4_sim *sim, uint32_t index) {
    if (index >= (uint32_t)sim->config.digital_outputs) {
        return ROBUROC4_ERR_INDEX;
    }
    return index == ROBUROC4_DO_WATCHDOG ? sim->fed : sim->digital_outputs[index];
}

uint32_t roburoc4_sim_subscription(const roburoc4_sim *sim, uint64_t peer, uint32_t service) {
    int32_t slot = sim_peers_slot(sim, peer);
    return slot >= 0 && service < ROBUROC4_SERVICE_COUNT
               ? sim->peers[slot].subscriptions[service].period_cycles
               : 0;
}
