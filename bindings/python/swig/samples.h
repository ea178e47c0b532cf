/* SPDX-License-Identifier: MIT
 *
 * samples.h - a pump's samples as typed records.
 */
#ifndef ROBUROC4_PY_SAMPLES_H
#define ROBUROC4_PY_SAMPLES_H

#include "records.h"

/* A list of the next samples of the services in `mask` (bit k: ROBUROC4_SERVICE_k), at most a
 * handful at a time; None when all were read; raises when none will come. */
PyObject *samples_read(roburoc4_pump *pump, roburoc4_pump_reader *reader, uint32_t mask);

#endif
