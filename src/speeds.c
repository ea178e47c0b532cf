/* SPDX-License-Identifier: MIT
 *
 * Floats that may have come from a wire: whether they are numbers, and what of them is within
 * bounds. NaN is recognised by its bits, so that it holds where compilers assume there is none.
 */
#include "bytes.h"
#include "machines.h"

bool roburoc4_all_finite(const float *values, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        if (!finite_f32_bits(bits_from_f32(values[i]))) {
            return false;
        }
    }
    return true;
}

float roburoc4_clamp(float value, float low, float high) {
    return value < low ? low : value > high ? high : value;
}

bool roburoc4_between(float value, float low, float high) {
    return value >= low && value <= high;
}
