/* SPDX-License-Identifier: MIT
 *
 * The inputs of the IO card: what each channel reads, by the manual's table 5.5.1, unless a test
 * has pinned it.
 */
#include <string.h>

#include "model.h"

int32_t sim_channel_meaning(const roburoc4_sim *sim, uint32_t io_type, uint32_t index) {
    bool analog = io_type == ROBUROC4_IO_ANALOG_INPUT;
    if ((!analog && io_type != ROBUROC4_IO_DIGITAL_INPUT) || index < 2) {
        return (int32_t)index;
    }
    /* The manual's tables skip number 02; on a card with one more channel it is an unused input. */
    bool literal = analog ? sim->config.analog_inputs == ROBUROC4_AI_COUNT + 1
                          : sim->config.digital_inputs == ROBUROC4_DI_COUNT + 1;
    uint32_t shift = sim->config.input_shift + (literal ? 1u : 0u);
    return index < 2 + shift ? -1 : (int32_t)(index - shift);
}

float sim_reported_voltage(const roburoc4_sim *sim) {
    for (uint32_t index = 0; index < (uint32_t)sim->config.analog_inputs; index++) {
        if (sim_channel_meaning(sim, ROBUROC4_IO_ANALOG_INPUT, index) == ROBUROC4_AI_BATTERY_V) {
            return sim_analog_input(sim, index);
        }
    }
    return sim_battery_voltage(sim);
}

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
