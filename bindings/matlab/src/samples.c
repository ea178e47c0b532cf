/* SPDX-License-Identifier: MIT */
#include "samples.h"

#include <stdlib.h>
#include <string.h>

/* The most that is recorded of a service: 128 bytes each. A power of two. */
#define SAMPLES_MAX 2097152u
#define SAMPLES_FIRST 256u

/* ------------------------------------------------------------------------------- services --- */

#define VALUE(name, member, type) FIELD_AS(name, roburoc4_sample, value.member, type)
#define FLOATS(name, member, count)                                                                \
    FIELD_ROW(name, roburoc4_sample, value.member, value.member[0], FLOAT, value.count)

static const field times[] = {
    FIELD_AS("time_s", roburoc4_sample, host_us, TIME),
    FIELD_AS("utc_s", roburoc4_sample, made_us, UTC),
    FIELD(roburoc4_sample, robot_cycles, CYCLES),
};

/* By service, from FIRST_SERVICE on. */
static const struct {
    const char *name;
    size_t count;
    field values[4];
} services[SERVICES] = {
    {"iocard",
     2,
     {FLOATS("analog_inputs", inputs.analog, inputs.analog_count),
      {"digital_inputs", offsetof(roburoc4_sample, value.inputs.digital), sizeof(uint64_t),
       FIELD_BITS, 0, offsetof(roburoc4_sample, value.inputs.digital_count)}}},
    {"telemeter", 1, {FLOATS("distances_m", distances.distances_m, distances.count)}},
    {"battery",
     2,
     {VALUE("battery_state", battery.state, BYTE),
      VALUE("remaining_percent", battery.remaining_percent, BYTE)}},
    {"localization",
     4,
     {VALUE("x_m", localization.x_m, FLOAT), VALUE("y_m", localization.y_m, FLOAT),
      VALUE("theta_rad", localization.theta_rad, FLOAT),
      VALUE("localization_flags", localization.flags, UINT)}},
    {"differential",
     4,
     {VALUE("target_linear_m_s", differential.target_linear_m_s, FLOAT),
      VALUE("current_linear_m_s", differential.current_linear_m_s, FLOAT),
      VALUE("target_angular_rad_s", differential.target_angular_rad_s, FLOAT),
      VALUE("current_angular_rad_s", differential.current_angular_rad_s, FLOAT)}},
};

int take_service(const mxArray *value, uint32_t *out) {
    char text[TEXT_SIZE];
    if (!take_text(value, "service", text)) {
        return 0;
    }
    for (uint32_t i = 0; i < SERVICES; i++) {
        if (strcmp(text, services[i].name) == 0) {
            *out = FIRST_SERVICE + i;
            return 1;
        }
    }
    return fail(FAIL_ARGUMENT,
                "there is no service '%s' with statuses; give iocard, telemeter, battery, "
                "localization or differential",
                text);
}

const char *service_name(uint32_t service) {
    return services[service - FIRST_SERVICE].name;
}

void sample_times(answer *out, const roburoc4_sample *sample) {
    answer_fields(out, times, COUNT_OF(times), sample);
}

void sample_values(answer *out, const roburoc4_sample *latest) {
    const uint32_t i = latest->service - FIRST_SERVICE;
    roburoc4_sample known = *latest;
    if (latest->host_us == 0 && services[i].values[0].count == 0) {
        memset(&known.value, 0xFF, sizeof known.value); /* NaN of floats, 255 of bytes */
    }
    answer_fields(out, services[i].values, services[i].count, &known);
}

/* ----------------------------------------------------------------------------- recordings --- */

static int append(struct sample_list *to, const roburoc4_sample *sample) {
    if (to->count == to->capacity) {
        const uint32_t capacity = to->capacity != 0 ? 2 * to->capacity : SAMPLES_FIRST;
        void *bigger =
            capacity <= SAMPLES_MAX ? realloc(to->samples, capacity * sizeof *sample) : NULL;
        if (bigger == NULL) {
            return fail(FAIL_LIMIT, "there is no room for more than %lu statuses; record less long",
                        (unsigned long)to->count);
        }
        to->samples = bigger;
        to->capacity = capacity;
    }
    to->samples[to->count++] = *sample;
    return 1;
}

int recording_go_on(recording *rec, roburoc4_pump *pump) {
    roburoc4_sample some[64];
    roburoc4_result got;
    while ((got = roburoc4_pump_read_samples(pump, &rec->reader, some, COUNT_OF(some))) > 0) {
        for (roburoc4_result i = 0; i < got; i++) {
            if (!append(&rec->lists[some[i].service - FIRST_SERVICE], &some[i])) {
                rec->reader.lost += (uint32_t)(got - i);
                return 0;
            }
            rec->count++;
        }
    }
    return 1;
}

void recording_end(recording *rec) {
    for (uint32_t i = 0; i < SERVICES; i++) {
        free(rec->lists[i].samples);
    }
    memset(rec->lists, 0, sizeof rec->lists);
    rec->reader.lost = rec->count = 0;
}

static mxArray *columns_of(answer out, const struct sample_list *list, uint32_t i) {
    answer_columns(&out, times, COUNT_OF(times), list->samples, sizeof *list->samples, list->count);
    answer_columns(&out, services[i].values, services[i].count, list->samples,
                   sizeof *list->samples, list->count);
    return answer_finish(&out);
}

int recording_columns(answer *out, recording *rec, roburoc4_pump *pump, uint32_t wanted) {
    const answer empty = {.begin_us = rec->begin_us, .utc_us = out->utc_us};
    if (!recording_go_on(rec, pump)) {
        return 0;
    }
    for (uint32_t i = 0; i < SERVICES; i++) {
        if ((wanted >> (FIRST_SERVICE + i) & 1u) != 0) {
            answer_add(out, services[i].name, columns_of(empty, &rec->lists[i], i));
        }
    }
    answer_number(out, "start_utc_s", (double)(int64_t)(out->utc_us + rec->begin_us) / 1e6);
    answer_number(out, "lost", (double)rec->reader.lost);
    return 1;
}
