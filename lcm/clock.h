/* SPDX-License-Identifier: MIT
 *
 * This machine's two clocks, read together.
 */
#ifndef ROBUROC4_LCM_CLOCK_H
#define ROBUROC4_LCM_CLOCK_H

#include "gate.h"

gate_time clock_now(void);

#endif
