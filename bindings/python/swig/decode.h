/* SPDX-License-Identifier: MIT
 *
 * decode.h - one datagram to one typed record.
 */
#ifndef ROBUROC4_PY_DECODE_H
#define ROBUROC4_PY_DECODE_H

#include "records.h"

/* decode(data, layout, from_client): layout is None or the tuple of nine integers of Layout in
 * roburoc4/codec.py. For METH_FASTCALL. */
PyObject *decode_telegram(PyObject *self, PyObject *const *arguments, Py_ssize_t count);

/* One channel or distance of a view; the index is within its count. */
static inline float channels_analog(const roburoc4_channels *channels, uint32_t index) {
    roburoc4_channels single = *channels;
    float value = 0.0F;
    single.analog += (size_t)index * 4;
    single.analog_count = 1;
    (void)roburoc4_analog_values(&single, &value, 1);
    return value;
}

static inline int channels_digital(const roburoc4_channels *channels, uint32_t index) {
    return channels->digital[index / 8] >> (index % 8) & 1;
}

static inline float distances_at(const roburoc4_telemeter_status *status, uint32_t index) {
    roburoc4_telemeter_status single = *status;
    float value = 0.0F;
    single.distances += (size_t)index * 4;
    single.count = 1;
    (void)roburoc4_telemeter_distances(&single, &value, 1);
    return value;
}

#endif
