/* SPDX-License-Identifier: MIT
 *
 * A simulated robot: creation, time, datagrams in and out, and the snapshot. Each cycle runs the
 * parts in one fixed order.
 */
#include <stdlib.h>
#include <string.h>

#include "model.h"

static void begin(roburoc4_sim *sim) {
    const roburoc4_sim_config *config = &sim->config;
    sim->random = config->seed;
    sim->truth.x_m = config->start_x_m;
    sim->truth.y_m = config->start_y_m;
    sim->truth.theta_rad = sim_wrap(config->start_theta_rad);
    sim->localization_flags = config->localization_flags;
    sim_motion_init(sim);
    sim_obstacles_init(sim);
    sim_battery_set(sim, config->battery_percent);
    sim_inputs_unpin(sim);
    sim_cockpit_release_pad(sim);
    sim_cockpit_power_up(sim);
}

void sim_robot_replace(roburoc4_sim *sim, const roburoc4_sim_config *config) {
    const bool started = sim->started;
    const uint64_t now_us = sim->now_us;
    const uint64_t next_us = sim->next_us;
    memset(sim, 0, sizeof *sim);
    sim->config = *config;
    sim->started = started;
    sim->now_us = now_us;
    sim->next_us = next_us;
    begin(sim);
}

roburoc4_sim *roburoc4_sim_create(const roburoc4_sim_config *config) {
    roburoc4_sim_config defaults;
    (void)roburoc4_sim_config_init(&defaults, sizeof defaults);
    config = config != NULL ? config : &defaults;
    if (roburoc4_sim_config_error(config) != NULL) {
        return NULL;
    }
    roburoc4_sim *sim = calloc(1, sizeof *sim);
    if (sim != NULL) {
        (void)sim_config_take(&sim->config, config);
        begin(sim);
    }
    return sim;
}

void roburoc4_sim_destroy(roburoc4_sim *sim) {
    free(sim);
}

/* ------------------------------------------------------------------------ datagrams and time ---
 */

void roburoc4_sim_receive(roburoc4_sim *sim, uint64_t peer, const uint8_t *data, size_t size) {
    if (data == NULL) {
        sim_peers_unreachable(sim, peer);
    } else if (sim->powered && (sim->config.queue_uplink_ms > 0 || sim->in.used > 0)) {
        uint64_t due_us = sim_queue_due_us(sim, SIM_DELAY_UPLINK);
        sim->counts.dropped += sim_queue_push(&sim->in, peer, data, size, due_us) ? 0u : 1u;
    } else if (sim->powered) {
        sim_protocol_receive(sim, peer, data, size);
    }
}

/* What waited in its own queue. */
static void take_in(roburoc4_sim *sim) {
    uint8_t buffer[ROBUROC4_SIM_MAX_TRANSMIT];
    uint64_t peer = 0;
    roburoc4_result size;
    while ((size = sim_queue_pop(&sim->in, sim->now_us, &peer, buffer, sizeof buffer)) > 0) {
        sim_protocol_receive(sim, peer, buffer, (size_t)size);
    }
}

/* A fast clock's cycles are shorter: by 10 ns for each ppm. */
static uint64_t cycle_us(roburoc4_sim *sim) {
    sim->clock_debt += sim->config.clock_ppm;
    int32_t gained_us = sim->clock_debt / 100;
    sim->clock_debt -= 100 * gained_us;
    return (uint64_t)(ROBUROC4_CYCLE_US - gained_us);
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
        sim->next_us += cycle_us(sim);
        take_in(sim);
        run_cycle(sim);
    }
    if (now_us > sim->now_us) {
        sim->now_us = now_us;
    }
    take_in(sim);
}

roburoc4_result roburoc4_sim_poll_transmit(roburoc4_sim *sim, uint64_t *peer, uint8_t *buffer,
                                           size_t capacity) {
    return sim_queue_pop(&sim->queue, sim->now_us, peer, buffer, capacity);
}

uint64_t roburoc4_sim_next_deadline(const roburoc4_sim *sim) {
    return sim->started ? sim->next_us : 0;
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
        state->distances_m[which] = sim_telemeter_distance(sim, which);
    }
}

static void fill_panel(const roburoc4_sim *sim, roburoc4_sim_state *state) {
    state->battery_state = sim_battery_state(sim);
    state->battery_percent = sim_battery_percent(sim);
    state->battery_v = sim_battery_voltage(sim);
    state->powered = sim->powered;
    state->motors_enabled = sim->motors;
    state->estop_local = sim->estop[0];
    state->estop_remote = sim->estop[1];
    state->brakes_released = sim->brakes_released;
    state->charger = sim->charger;
    state->overridden = sim_pad_drives(sim);
    state->watchdog_tripped = !sim->fed;
    state->front_bumper = sim_bumper(sim, SIM_FRONT);
    state->rear_bumper = sim_bumper(sim, SIM_REAR);
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

roburoc4_result roburoc4_sim_get_state(const roburoc4_sim *sim, roburoc4_sim_state *out) {
    const uint32_t size = out->size;
    if (!sim_size_is_valid(size, sizeof *out)) {
        return ROBUROC4_ERR_SIZE;
    }
    roburoc4_sim_state all = sim->counts;
    all.size = size;
    all.now_us = sim->now_us;
    all.cycles = sim->cycles;
    fill_motion(sim, &all);
    fill_panel(sim, &all);
    fill_link(sim, &all);
    memcpy(out, &all, size);
    return ROBUROC4_OK;
}
