/* SPDX-License-Identifier: MIT
 *
 * samples.h - statuses: the latest of a service, and lists of them as columns for a plot.
 */
#ifndef ROBUROC4_MEX_SAMPLES_H
#define ROBUROC4_MEX_SAMPLES_H

#include "convert.h"
#include "roburoc4_pump.h"

/** The first service with statuses, and a loop over them all. */
#define FIRST_SERVICE ROBUROC4_SERVICE_IOCARD
#define SERVICES (ROBUROC4_SERVICE_COUNT - FIRST_SERVICE)
#define ALL_SERVICES (((1u << SERVICES) - 1) << FIRST_SERVICE)

/** The name of a service with statuses, in calls and in columns. */
const char *service_name(uint32_t service);
/** The service with statuses that a text names. 0 after noting that there is none. */
int take_service(const mxArray *value, uint32_t *out);

/** The latest status of a service. 0 where there is none yet: then sample->service is 0. */
int samples_latest(const roburoc4_client *client, uint32_t service, roburoc4_sample *out);
/** Its values, as scalars and rows; those that are not known are NaN, 255 or empty. */
void samples_answer(answer *out, uint32_t service, const roburoc4_sample *latest);

/** A list that grows. All bytes zero: empty. */
typedef struct sample_list {
    roburoc4_sample *samples;
    uint32_t count, capacity;
} sample_list;

/** Make room for `more` samples at the end; where the first of it is, or NULL. */
roburoc4_sample *samples_reserve(sample_list *list, uint32_t more);
void samples_free(sample_list *list);
/** A scalar struct with a struct of columns for each service whose bit is set in `mask`; times are
 *  counted from begin_us. */
mxArray *samples_columns(const sample_list *list, uint32_t mask, uint64_t begin_us, uint64_t lost);

#endif
