/* SPDX-License-Identifier: MIT
 *
 * For Frama-C's Eva: what roburoc4_drive_poll() gives out during a zero train is zero, and so is
 * what it leaves where it gives nothing. Never run.
 */
#include "any.h"

void main_train_is_zero(void) {
    roburoc4_private_drive d;
    roburoc4_config config;
    float limits[13];
    float speeds[2];
    uint32_t events = any_u32();
    Frama_C_make_unknown((char *)&d, sizeof d);
    Frama_C_make_unknown((char *)&config, sizeof config);
    Frama_C_make_unknown((char *)limits, sizeof limits);
    d.train = (uint8_t)up_to(1);
    //@ dynamic_split d.train;
    const bool given = roburoc4_drive_poll(&d, &config, limits, any_u64(), speeds, &events);
    if (!given || d.train != 0) {
        /*@ assert zero: speeds[0] == 0.0 && speeds[1] == 0.0; */
    }
}
