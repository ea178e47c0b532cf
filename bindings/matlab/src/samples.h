/* SPDX-License-Identifier: MIT
 *
 * samples.h - statuses as they came, in a list that grows or in a ring, and as columns for a plot.
 */
#ifndef ROBUROC4_MEX_SAMPLES_H
#define ROBUROC4_MEX_SAMPLES_H

#include "mex.h"
#include "roburoc4_pump.h"

/** A list that grows. All bytes zero: empty. */
typedef struct sample_list {
    roburoc4_sample *samples;
    uint32_t count, capacity;
} sample_list;

/** The most that a list holds: 192 bytes each. */
#define SAMPLES_MAX 4000000u

/** Make room for `more` samples at the end; where the first of it is, or NULL. */
roburoc4_sample *samples_reserve(sample_list *list, uint32_t more);
void samples_free(sample_list *list);

/** The name of a service with statuses, in calls and in columns. */
const char *samples_service(uint32_t service);

/** A ring as the pump has one, for a client in virtual time. */
typedef struct sample_ring {
    roburoc4_sample *samples;
    uint64_t next;
    uint32_t capacity;
} sample_ring;

/** Store the newest status of a service, where there is one. */
void samples_store(sample_ring *ring, const roburoc4_client *client, uint32_t service);
/** What roburoc4_pump_read_samples() does. */
roburoc4_result samples_read(const sample_ring *ring, roburoc4_pump_reader *reader,
                             roburoc4_sample *samples, uint32_t capacity);

/** A scalar struct with a struct of columns for each service whose bit is set in `mask`; times are
 *  counted from begin_us. */
mxArray *samples_columns(const sample_list *list, uint32_t mask, uint64_t begin_us, uint64_t lost);

#endif
