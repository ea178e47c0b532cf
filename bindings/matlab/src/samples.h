/* SPDX-License-Identifier: MIT
 *
 * samples.h - statuses: the latest of a service, and lists of them as columns for a plot.
 */
#ifndef ROBUROC4_MEX_SAMPLES_H
#define ROBUROC4_MEX_SAMPLES_H

#include "convert.h"
#include "roburoc4_pump.h"

/** The first service with statuses, and a loop over all of them. */
#define FIRST_SERVICE ROBUROC4_SERVICE_IOCARD
#define SERVICES (ROBUROC4_SERVICE_COUNT - FIRST_SERVICE)
#define ALL_SERVICES (((1u << SERVICES) - 1) << FIRST_SERVICE)

/** The name of a service with statuses, in calls and in columns. */
const char *service_name(uint32_t service);
/** The service that a text names. Returns 0 after noting that it has no statuses or does not
 * exist. */
int take_service(const mxArray *value, uint32_t *out);

/** Values of roburoc4_sample_latest(), as scalars and rows; unknown ones are NaN, 255 or empty. */
void samples_answer(answer *out, uint32_t service, const roburoc4_sample *latest);

/** A list that grows. All bytes zero: empty. */
typedef struct sample_list {
    roburoc4_sample *samples;
    uint32_t count, capacity;
} sample_list;

/** From one time to a later or an earlier one. */
double seconds_since(uint64_t time_us, uint64_t begin_us);

/** The zero points of sample times, all on the clock on which they arrived. */
typedef struct clocks {
    uint64_t begin_us; /* time_s is 0 */
    double utc_s;      /* UTC of a time of 0, in seconds since 1970 */
} clocks;

/** A scalar struct with a struct of columns for each service whose bit is set in `mask`. */
mxArray *samples_columns(const sample_list *list, uint32_t mask, const clocks *times,
                         uint64_t lost);
/** One sample: its times, and the values of samples_answer(). */
void samples_one(answer *out, const roburoc4_sample *sample, const clocks *times);

#endif
