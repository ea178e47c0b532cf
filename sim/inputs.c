/* SPDX-License-Identifier: MIT
 *
 * The inputs of the IO card: what each channel reads, by the manual's table 5.5.1, unless a test
 * has pinned it.
 */
#include <string.h>

#include "model.h"

float sim_analog_input(const roburoc4_sim *sim, uint32_t index) {
    if (sim->analog_pinned[index]) {
        return sim->analog_pins[index];
    }
    int32_t meaning = sim_channel_meaning(sim, ROBUROC4_IO_ANALOG_INPUT, index);
    if (meaning == ROBUROC4_AI_FRONT_TELEMETER_V || meaning == ROBUROC4_AI_REAR_TELEMETER_V) {
        return sim_telemeter_voltage(sim, (uint32_t)meaning);
    }
    if (meaning == ROBUROC4_AI_BATTERY_V) {
        return sim_battery_voltage(sim);
    }
    if (meaning >= ROBUROC4_AI_PAD_LJ_X && meaning <= ROBUROC4_AI_PAD_RT) {
        return sim->axes[meaning - ROBUROC4_AI_PAD_LJ_X];
    }
    return 0.0f;
}

bool sim_bumper(const roburoc4_sim *sim, uint32_t which) {
    return sim->bumper_pressed[which] || sim->contact[which];
}

bool sim_digital_input(const roburoc4_sim *sim, uint32_t index) {
    if (sim->digital_pins[index] >= 0) {
        return sim->digital_pins[index] != 0;
    }
    int32_t meaning = sim_channel_meaning(sim, ROBUROC4_IO_DIGITAL_INPUT, index);
    if (meaning == SIM_SECOND_FRONT && (sim->config.texts & ROBUROC4_SIM_TEXTS_TWO_FRONT) != 0) {
        return sim_bumper(sim, SIM_FRONT);
    }
    if (meaning == ROBUROC4_DI_FRONT_BUMPER || meaning == ROBUROC4_DI_REAR_BUMPER) {
        return sim_bumper(sim, (uint32_t)meaning);
    }
    if (meaning >= ROBUROC4_DI_PAD_A && meaning <= ROBUROC4_DI_PAD_RB) {
        return sim->buttons[meaning - ROBUROC4_DI_PAD_A];
    }
    return false;
}

void sim_inputs_unpin(roburoc4_sim *sim) {
    memset(sim->analog_pinned, 0, sizeof sim->analog_pinned);
    memset(sim->digital_pins, -1, sizeof sim->digital_pins);
}
