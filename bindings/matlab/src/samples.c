/* SPDX-License-Identifier: MIT */
#include "samples.h"

#include <string.h>

#include "fail.h"

/* ------------------------------------------------------------------------------- services --- */

static const field iocard[] = {
    FIELD_AS("analog_inputs", roburoc4_inputs, analog, FLOATS),
    FIELD_AS("digital_inputs", roburoc4_inputs, digital, BITS),
};
static const field telemeter[] = {
    FIELD(roburoc4_distances, distances_m, FLOATS),
};
static const field battery[] = {
    FIELD_AS("battery_state", roburoc4_battery_status, state, BYTE),
    FIELD(roburoc4_battery_status, remaining_percent, BYTE),
};
static const field localization[] = {
    FIELD(roburoc4_localization_status, x_m, FLOAT),
    FIELD(roburoc4_localization_status, y_m, FLOAT),
    FIELD(roburoc4_localization_status, theta_rad, FLOAT),
    FIELD_AS("localization_flags", roburoc4_localization_status, flags, BYTE),
};
static const field differential[] = {
    FIELD(roburoc4_differential_status, target_linear_m_s, FLOAT),
    FIELD(roburoc4_differential_status, current_linear_m_s, FLOAT),
    FIELD(roburoc4_differential_status, target_angular_rad_s, FLOAT),
    FIELD(roburoc4_differential_status, current_angular_rad_s, FLOAT),
};

/* By service, from FIRST_SERVICE on. */
static const struct {
    const char *name;
    const field *fields;
    size_t count;
} services[SERVICES] = {
    {"iocard", iocard, COUNT_OF(iocard)},
    {"telemeter", telemeter, COUNT_OF(telemeter)},
    {"battery", battery, COUNT_OF(battery)},
    {"localization", localization, COUNT_OF(localization)},
    {"differential", differential, COUNT_OF(differential)},
};

const char *service_name(uint32_t service) {
    return services[service - FIRST_SERVICE].name;
}

int take_service(const mxArray *value, uint32_t *out) {
    char text[TEXT_SIZE];
    uint32_t service;
    if (!take_text(value, "service", text)) {
        return 0;
    }
    for (service = FIRST_SERVICE; service < ROBUROC4_SERVICE_COUNT; service++) {
        if (strcmp(text, service_name(service)) == 0) {
            *out = service;
            return 1;
        }
    }
    return fail(FAIL_ARGUMENT,
                "there is no service '%s' with statuses; give iocard, telemeter, battery, "
                "localization or differential",
                text);
}

/* -------------------------------------------------------------------------------- columns --- */

/* The samples of one service. */
typedef struct rows {
    const roburoc4_sample **at;
    uint32_t count;
} rows;

/* How many numbers a member of a status has. */
static uint32_t width_of(const roburoc4_sample *sample, const field *member) {
    if (member->type == FIELD_BITS) {
        return sample->value.inputs.digital_count;
    }
    if (member->type != FIELD_FLOATS) {
        return 1;
    }
    return sample->service == ROBUROC4_SERVICE_IOCARD ? sample->value.inputs.analog_count
                                                      : sample->value.distances.count;
}

static uint32_t widest(const rows *from, const field *member) {
    uint32_t width = member->type == FIELD_FLOATS || member->type == FIELD_BITS ? 0 : 1, i;
    for (i = 0; i < from->count; i++) {
        const uint32_t here = width_of(from->at[i], member);
        width = here > width ? here : width;
    }
    return width;
}

/* One of a member's numbers; NaN beyond its last. */
static double number_at(const roburoc4_sample *sample, const field *member, uint32_t column) {
    const char *place = (const char *)&sample->value + member->offset;
    float number;
    if (member->type == FIELD_BITS) {
        return (double)(sample->value.inputs.digital >> column & 1u);
    }
    if (member->type != FIELD_FLOATS) {
        return field_value(member, &sample->value);
    }
    memcpy(&number, place + column * sizeof number, sizeof number);
    return column < width_of(sample, member) ? (double)number : mxGetNaN();
}

/* A row for each sample, with as many columns as the widest has numbers. */
static void add_matrix(answer *out, const rows *from, const field *member) {
    const int digital = member->type == FIELD_BITS;
    const uint32_t width = widest(from, member);
    mxArray *made = digital ? mxCreateLogicalMatrix(from->count, width)
                            : mxCreateDoubleMatrix(from->count, width, mxREAL);
    mxLogical *bits = digital ? mxGetLogicals(made) : NULL;
    double *numbers = digital ? NULL : mxGetData(made);
    for (uint32_t k = 0; k < width; k++) {
        for (uint32_t i = 0; i < from->count; i++) {
            const double number = number_at(from->at[i], member, k);
            if (digital) {
                *bits++ = number != 0.0;
            } else {
                *numbers++ = number;
            }
        }
    }
    answer_add(out, member->name, made);
}

double seconds_since(uint64_t time_us, uint64_t begin_us) {
    return (double)(int64_t)(time_us - begin_us) / 1e6;
}

static void add_times(answer *out, const rows *from, const clocks *times) {
    mxArray *time, *utc, *cycles;
    double *time_s = make_doubles(&time, from->count, 1);
    double *utc_s = make_doubles(&utc, from->count, 1);
    uint64_t *robot_cycles = make_cycles(&cycles, from->count);
    for (uint32_t i = 0; i < from->count; i++) {
        time_s[i] = seconds_since(from->at[i]->host_us, times->begin_us);
        utc_s[i] = times->utc_s + (double)from->at[i]->made_us / 1e6;
        robot_cycles[i] = from->at[i]->robot_cycles;
    }
    answer_add(out, "time_s", time);
    answer_add(out, "utc_s", utc);
    answer_add(out, "robot_cycles", cycles);
}

void samples_answer(answer *out, uint32_t service, const roburoc4_sample *latest) {
    const rows one_row = {&latest, 1};
    const field *at = services[service - FIRST_SERVICE].fields;
    const field *end = at + services[service - FIRST_SERVICE].count;
    for (; at < end; at++) {
        if (at->type == FIELD_FLOATS || at->type == FIELD_BITS) {
            add_matrix(out, &one_row, at);
        } else {
            answer_fields(out, at, 1, latest->host_us != 0 ? &latest->value : NULL);
        }
    }
}

void samples_one(answer *out, const roburoc4_sample *sample, const clocks *times) {
    static const field cycles = FIELD(roburoc4_sample, robot_cycles, CYCLES);
    answer_number(out, "time_s", seconds_since(sample->host_us, times->begin_us));
    answer_number(out, "utc_s", times->utc_s + (double)sample->made_us / 1e6);
    answer_fields(out, &cycles, 1, sample);
    samples_answer(out, sample->service, sample);
}

static mxArray *columns_of(const rows *from, uint32_t service, const clocks *times) {
    answer out = {0};
    add_times(&out, from, times);
    for (size_t i = 0; i < services[service - FIRST_SERVICE].count; i++) {
        add_matrix(&out, from, &services[service - FIRST_SERVICE].fields[i]);
    }
    return answer_finish(&out);
}

mxArray *samples_columns(const sample_list *list, uint32_t mask, const clocks *times,
                         uint64_t lost) {
    /* mxMalloc: freed by MATLAB if it runs out of memory meanwhile. */
    rows from = {mxMalloc((list->count + (size_t)1) * sizeof(const roburoc4_sample *)), 0};
    answer out = {0};
    for (uint32_t service = FIRST_SERVICE; service < ROBUROC4_SERVICE_COUNT; service++) {
        if ((mask >> service & 1u) != 0) {
            from.count = 0;
            for (uint32_t i = 0; i < list->count; i++) {
                if (list->samples[i].service == service) {
                    from.at[from.count++] = &list->samples[i];
                }
            }
            answer_add(&out, service_name(service), columns_of(&from, service, times));
        }
    }
    answer_number(&out, "start_utc_s", times->utc_s + (double)times->begin_us / 1e6);
    answer_number(&out, "lost", (double)lost);
    mxFree(from.at);
    return answer_finish(&out);
}
