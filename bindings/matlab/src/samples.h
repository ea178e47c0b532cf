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

/** The service that a text names. Returns 0 after noting that it has no statuses or does not
 * exist. */
int take_service(const mxArray *value, uint32_t *out);

/** As take_service() reads it. */
const char *service_name(uint32_t service);

/** When a sample was received, when the robot made it, and the robot's clock. */
void sample_times(answer *out, const roburoc4_sample *sample);
/** The values of roburoc4_sample_latest(); if there are none yet, NaN, 255 or empty. */
void sample_values(answer *out, const roburoc4_sample *latest);

/** Statuses since a moment. All bytes zero: since the pump was made. */
typedef struct recording {
    roburoc4_pump_reader reader;
    struct sample_list {
        roburoc4_sample *samples;
        uint32_t count, capacity;
    } lists[SERVICES];
    uint32_t count;    /* of all lists */
    uint64_t begin_us; /* when time_s is 0 */
} recording;

/** Add the new statuses. Returns 0 after noting that there is no room. */
int recording_go_on(recording *rec, roburoc4_pump *pump);
/** Likewise, and give a struct of columns for each service whose bit is set in `wanted`, and what
 * they share. */
int recording_columns(answer *out, recording *rec, roburoc4_pump *pump, uint32_t wanted);
/** Drop what was recorded; the next sample will be the following one. */
void recording_end(recording *rec);

#endif
