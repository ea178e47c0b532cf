/* SPDX-License-Identifier: MIT
 *
 * The battery: it drains with use, charges, and reports its state (manual 4.2.4.6).
 */
#include <math.h>

#include "model.h"

/* Power drawn by the electronics, and by the motors against slow or skidding wheels. */
#define IDLE_W 45.0
#define ROLLING_W_PER_M_S 90.0
#define TURNING_W_PER_RAD_S 70.0
#define ROBOT_MASS_KG 140.0

/* The voltage at rest as a fraction of the nominal one, for lead-acid cells: when empty, and the
 * rise from empty to full. */
#define EMPTY_SHARE 0.945
#define CHARGE_SHARE 0.115

#define CHARGER_A 15.0
#define RESISTANCE_OHM 0.02
#define CYCLE_H (CYCLE_S / 3600.0)

static double load_a(const roburoc4_sim *sim) {
    double power_w = 0.0;
    if (sim->powered) {
        power_w += IDLE_W;
    }
    if (sim->motors) {
        double speeding_w = ROBOT_MASS_KG * sim->linear.slope * sim->linear.speed;
        power_w += ROLLING_W_PER_M_S * fabs(sim->linear.speed) +
                   TURNING_W_PER_RAD_S * fabs(sim->angular.speed) + fmax(speeding_w, 0.0);
    }
    return power_w / (double)sim->config.nominal_voltage_v;
}

void sim_battery_set(roburoc4_sim *sim, float percent) {
    sim->battery_ah = (double)percent * 0.01 * (double)sim->config.capacity_ah;
}

void sim_battery_cycle(roburoc4_sim *sim) {
    double flow_a = (sim->charger ? CHARGER_A : 0.0) - load_a(sim);
    double charge_ah = sim->battery_ah + flow_a * CYCLE_H;
    sim->battery_ah = fmin(fmax(charge_ah, 0.0), (double)sim->config.capacity_ah);
}

float sim_battery_percent(const roburoc4_sim *sim) {
    return (float)(100.0 * sim->battery_ah / (double)sim->config.capacity_ah);
}

float sim_battery_voltage(const roburoc4_sim *sim) {
    double full = 0.01 * (double)sim_battery_percent(sim);
    double flow_a = (sim->charger ? CHARGER_A : 0.0) - load_a(sim);
    return (float)((double)sim->config.nominal_voltage_v * (EMPTY_SHARE + CHARGE_SHARE * full) +
                   flow_a * RESISTANCE_OHM);
}

/* As the IO card reports it. */
static float reported_voltage(const roburoc4_sim *sim) {
    for (uint32_t index = 0; index < (uint32_t)sim->config.analog_inputs; index++) {
        if (sim_channel_meaning(sim, ROBUROC4_IO_ANALOG_INPUT, index) == ROBUROC4_AI_BATTERY_V) {
            return sim->analog_pinned[index] ? sim->analog_pins[index] : sim_battery_voltage(sim);
        }
    }
    return sim_battery_voltage(sim);
}

uint8_t sim_battery_remaining(const roburoc4_sim *sim) {
    double percent = (double)sim_battery_percent(sim);
    if (sim->config.as_manual != 0) {
        /* The service knows only the voltage (5.5.3). */
        double share = (double)reported_voltage(sim) / (double)sim->config.nominal_voltage_v;
        percent = 100.0 * (share - EMPTY_SHARE) / CHARGE_SHARE;
    }
    return (uint8_t)(fmin(fmax(percent, 0.0), 100.0) + 0.5);
}

uint8_t sim_battery_state(const roburoc4_sim *sim) {
    if (sim->charger) {
        return sim_battery_percent(sim) >= 100.0f ? ROBUROC4_BATTERY_CHARGED
                                                  : ROBUROC4_BATTERY_CHARGING;
    }
    return sim_battery_remaining(sim) < sim->config.minimum_percent ? ROBUROC4_BATTERY_CRITICAL
                                                                    : ROBUROC4_BATTERY_OK;
}
