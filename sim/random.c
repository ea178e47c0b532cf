/* SPDX-License-Identifier: MIT
 *
 * Seeded noise: a 64-bit counter and a mixing function, so that every seed is good, 0 included, and
 * the state is a single number.
 */
#include "model.h"

uint64_t sim_random(uint64_t *state) {
    *state += 0x9E3779B97F4A7C15u;
    uint64_t mixed = *state;
    mixed = (mixed ^ (mixed >> 30)) * 0xBF58476D1CE4E5B9u;
    mixed = (mixed ^ (mixed >> 27)) * 0x94D049BB133111EBu;
    return mixed ^ (mixed >> 31);
}

double sim_random_unit(uint64_t *state) {
    return (double)(sim_random(state) >> 11) * (1.0 / 9007199254740992.0);
}

double sim_random_signed(uint64_t *state) {
    return 2.0 * sim_random_unit(state) - 1.0;
}
