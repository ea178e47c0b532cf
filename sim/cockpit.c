/* SPDX-License-Identifier: MIT
 *
 * What a person operates: control panel, remote control (manual 5.1, 5.2) and game pad (4.1). The
 * rules of when there is motor power, and when the pad is in control.
 */
#include <string.h>

#include "model.h"

#define PAD_DEAD_ZONE 0.05

static bool motors_allowed(const roburoc4_sim *sim) {
    bool forbidden = sim->config.as_manual != 0 &&
                     (sim->charger || sim_battery_state(sim) == ROBUROC4_BATTERY_CRITICAL);
    return sim->powered && !sim->estop[0] && !sim->estop[1] && !sim->brakes_released && !forbidden;
}

void sim_cockpit_power_up(roburoc4_sim *sim) {
    sim->powered = true;
    sim->cycles = sim->config.uptime_cycles;
    sim->measured_cycles = sim->cycles;
    bool safe = sim->config.start_safe != 0 || sim->config.as_manual != 0;
    sim->motors = !safe && motors_allowed(sim);
    sim->odometry.x_m = sim->config.start_x_m;
    sim->odometry.y_m = sim->config.start_y_m;
    sim->odometry.theta_rad = sim_wrap(sim->config.start_theta_rad);
    sim_motion_forget(sim);
    memset(sim->analog_outputs, 0, sizeof sim->analog_outputs);
    memset(sim->digital_outputs, 0, sizeof sim->digital_outputs);
}

static void power_down(roburoc4_sim *sim) {
    sim->powered = false;
    sim->motors = false;
    sim_motion_forget(sim);
    sim_peers_clear(sim);
    sim_queue_clear(&sim->in);
    sim_queue_clear(&sim->queue);
    memset(sim->last_due_us, 0, sizeof sim->last_due_us);
}

void sim_cockpit_switch(roburoc4_sim *sim, bool on) {
    if (on && !sim->powered) {
        sim->counts.reboots++;
        sim_cockpit_power_up(sim);
    } else if (!on && sim->powered) {
        power_down(sim);
    }
}

void sim_cockpit_check_motors(roburoc4_sim *sim) {
    sim->motors = sim->motors && motors_allowed(sim);
}

bool sim_cockpit_press_motor_button(roburoc4_sim *sim) {
    sim->motors = sim->motors || motors_allowed(sim);
    return sim->motors;
}

/* -------------------------------------------------------------------------------- game pad --- */

static double axis_of(const roburoc4_sim *sim, uint32_t axis) {
    return (double)sim->axes[axis - ROBUROC4_AI_PAD_LJ_X];
}

static sim_speed pad_speed(const roburoc4_sim *sim) {
    double forward = (axis_of(sim, ROBUROC4_AI_PAD_RT) + 1.0) / 2.0;
    double backward = (axis_of(sim, ROBUROC4_AI_PAD_LT) + 1.0) / 2.0;
    double right = axis_of(sim, ROBUROC4_AI_PAD_LJ_X);
    double ahead = forward - backward;
    sim_speed speed = {0.0, 0.0};
    speed.linear_m_s = ahead > 0.0 ? ahead * sim->linear.max_speed : -ahead * sim->linear.min_speed;
    if (right > PAD_DEAD_ZONE) {
        speed.angular_rad_s = right * sim->angular.min_speed;
    } else if (right < -PAD_DEAD_ZONE) {
        speed.angular_rad_s = -right * sim->angular.max_speed;
    }
    return speed;
}

void sim_cockpit_cycle(roburoc4_sim *sim) {
    sim_cockpit_check_motors(sim);
    if (sim_pad_drives(sim)) {
        sim->target = pad_speed(sim);
    } else if (sim->config.commands_need_motors != 0 && !sim->motors) {
        sim_motion_forget(sim);
    }
}

void sim_cockpit_press(roburoc4_sim *sim, uint32_t button, bool down) {
    bool *state = &sim->buttons[button - ROBUROC4_DI_PAD_A];
    if (button == ROBUROC4_DI_PAD_A && *state != down) {
        if (sim->config.pad_keeps_target == ROBUROC4_SIM_OVERRIDE_DISCARDS) {
            /* Whoever takes over starts with target 0: the previous command is discarded. */
            sim_motion_forget(sim);
        } else if (down) {
            sim->kept = sim->target;
        } else {
            sim->target = sim->kept;
        }
    }
    *state = down;
}

void sim_cockpit_release_pad(roburoc4_sim *sim) {
    for (uint32_t button = ROBUROC4_DI_PAD_A; button <= ROBUROC4_DI_PAD_RB; button++) {
        sim_cockpit_press(sim, button, false);
    }
    memset(sim->axes, 0, sizeof sim->axes);
    sim->axes[ROBUROC4_AI_PAD_LT - ROBUROC4_AI_PAD_LJ_X] = -1.0f;
    sim->axes[ROBUROC4_AI_PAD_RT - ROBUROC4_AI_PAD_LJ_X] = -1.0f;
}
