/* SPDX-License-Identifier: MIT */
#include "samples.h"

#include <stdlib.h>
#include <string.h>

#include "answers.h"

/* ----------------------------------------------------------------------------- list and ring ---
 */

roburoc4_sample *samples_reserve(sample_list *list, uint32_t more) {
    if (list->count + more > list->capacity) {
        uint32_t capacity = 2 * list->capacity + more;
        roburoc4_sample *bigger;
        if (capacity > SAMPLES_MAX) {
            capacity = SAMPLES_MAX;
        }
        if (list->count + more > capacity) {
            return NULL;
        }
        bigger = realloc(list->samples, capacity * sizeof *bigger);
        if (bigger == NULL) {
            return NULL;
        }
        list->samples = bigger;
        list->capacity = capacity;
    }
    return list->samples + list->count;
}

void samples_free(sample_list *list) {
    free(list->samples);
    memset(list, 0, sizeof *list);
}

static roburoc4_result read_value(const roburoc4_client *client, roburoc4_sample *to) {
    roburoc4_result result;
    switch (to->service) {
    case ROBUROC4_SERVICE_IOCARD:
        result = roburoc4_client_inputs(client, &to->value.inputs, &to->host_us);
        to->robot_cycles = to->value.inputs.robot_cycles;
        break;
    case ROBUROC4_SERVICE_TELEMETER:
        result = roburoc4_client_distances(client, &to->value.distances, &to->host_us);
        to->robot_cycles = to->value.distances.robot_cycles;
        break;
    case ROBUROC4_SERVICE_BATTERY:
        result = roburoc4_client_battery(client, &to->value.battery, &to->host_us);
        to->robot_cycles = to->value.battery.robot_cycles;
        break;
    case ROBUROC4_SERVICE_LOCALIZATION:
        result = roburoc4_client_localization(client, &to->value.localization, &to->host_us);
        to->robot_cycles = to->value.localization.robot_cycles;
        break;
    default:
        result = roburoc4_client_differential(client, &to->value.differential, &to->host_us);
        to->robot_cycles = to->value.differential.robot_cycles;
        break;
    }
    return result;
}

void samples_store(sample_ring *ring, const roburoc4_client *client, uint32_t service) {
    roburoc4_sample sample;
    memset(&sample, 0, sizeof sample);
    sample.sequence = ring->next;
    sample.service = service;
    if (read_value(client, &sample) >= 0) {
        ring->samples[ring->next % ring->capacity] = sample;
        ring->next++;
    }
}

roburoc4_result samples_read(const sample_ring *ring, roburoc4_pump_reader *reader,
                             roburoc4_sample *samples, uint32_t capacity) {
    uint64_t oldest = ring->next > ring->capacity ? ring->next - ring->capacity : 0;
    uint32_t copied = 0;
    if (reader->next_sample < oldest) {
        reader->lost += oldest - reader->next_sample;
        reader->next_sample = oldest;
    }
    while (copied < capacity && reader->next_sample < ring->next) {
        samples[copied++] = ring->samples[reader->next_sample++ % ring->capacity];
    }
    return (roburoc4_result)copied;
}

/* ---------------------------------------------------------------------------------- columns --- */

const char *samples_service(uint32_t service) {
    static const char *const names[] = {"iocard", "telemeter", "battery", "localization",
                                        "differential"};
    return names[service - ROBUROC4_SERVICE_IOCARD];
}

/* The samples of one service. */
typedef struct pick {
    const roburoc4_sample **at;
    uint32_t count;
    uint64_t begin_us;
} pick;

typedef double (*number_of)(const roburoc4_sample *sample);

static double linear_target(const roburoc4_sample *s) {
    return (double)s->value.differential.target_linear_m_s;
}
static double linear_current(const roburoc4_sample *s) {
    return (double)s->value.differential.current_linear_m_s;
}
static double angular_target(const roburoc4_sample *s) {
    return (double)s->value.differential.target_angular_rad_s;
}
static double angular_current(const roburoc4_sample *s) {
    return (double)s->value.differential.current_angular_rad_s;
}
static double x_of(const roburoc4_sample *s) {
    return s->value.localization.x_m;
}
static double y_of(const roburoc4_sample *s) {
    return s->value.localization.y_m;
}
static double theta_of(const roburoc4_sample *s) {
    return s->value.localization.theta_rad;
}
static double flags_of(const roburoc4_sample *s) {
    return s->value.localization.flags;
}
static double battery_state_of(const roburoc4_sample *s) {
    return s->value.battery.state;
}
static double percent_of(const roburoc4_sample *s) {
    return s->value.battery.remaining_percent;
}

static void add_column(answer *out, const char *name, const pick *from, number_of number) {
    mxArray *made;
    double *to = make_doubles(&made, from->count, 1);
    uint32_t i;
    for (i = 0; i < from->count; i++) {
        to[i] = number(from->at[i]);
    }
    answer_add(out, name, made);
}

static void add_clock(answer *out, const pick *from) {
    mxArray *time, *cycles;
    double *time_s = make_doubles(&time, from->count, 1);
    uint64_t *robot_cycles = make_cycles(&cycles, from->count);
    uint32_t i;
    for (i = 0; i < from->count; i++) {
        time_s[i] = ((double)from->at[i]->host_us - (double)from->begin_us) / 1e6;
        robot_cycles[i] = from->at[i]->robot_cycles;
    }
    answer_add(out, "time_s", time);
    answer_add(out, "robot_cycles", cycles);
}

static void add_distances(answer *out, const pick *from) {
    mxArray *made;
    uint32_t columns = 0, i, k;
    double *to;
    for (i = 0; i < from->count; i++) {
        const uint32_t count = from->at[i]->value.distances.count;
        columns = count > columns ? count : columns;
    }
    to = make_doubles(&made, from->count, columns);
    for (i = 0; i < from->count; i++) {
        const roburoc4_distances *row = &from->at[i]->value.distances;
        for (k = 0; k < columns; k++) {
            to[(size_t)k * from->count + i] =
                k < row->count ? (double)row->distance_m[k] : mxGetNaN();
        }
    }
    answer_add(out, "distances_m", made);
}

static void add_inputs(answer *out, const pick *from) {
    mxArray *analog, *digital;
    uint32_t analogs = 0, digitals = 0, i, k;
    double *volts;
    mxLogical *on;
    for (i = 0; i < from->count; i++) {
        const roburoc4_inputs *row = &from->at[i]->value.inputs;
        analogs = row->analog_count > analogs ? row->analog_count : analogs;
        digitals = row->digital_count > digitals ? row->digital_count : digitals;
    }
    volts = make_doubles(&analog, from->count, analogs);
    on = make_logicals(&digital, from->count, digitals);
    for (i = 0; i < from->count; i++) {
        const roburoc4_inputs *row = &from->at[i]->value.inputs;
        for (k = 0; k < analogs; k++) {
            volts[(size_t)k * from->count + i] =
                k < row->analog_count ? (double)row->analog[k] : mxGetNaN();
        }
        for (k = 0; k < digitals; k++) {
            on[(size_t)k * from->count + i] = (row->digital >> k & 1u) != 0;
        }
    }
    answer_add(out, "analog_inputs", analog);
    answer_add(out, "digital_inputs", digital);
}

static mxArray *columns_of(const pick *from, uint32_t service) {
    answer out;
    answer_begin(&out);
    add_clock(&out, from);
    switch (service) {
    case ROBUROC4_SERVICE_IOCARD:
        add_inputs(&out, from);
        break;
    case ROBUROC4_SERVICE_TELEMETER:
        add_distances(&out, from);
        break;
    case ROBUROC4_SERVICE_BATTERY:
        add_column(&out, "battery_state", from, battery_state_of);
        add_column(&out, "remaining_percent", from, percent_of);
        break;
    case ROBUROC4_SERVICE_LOCALIZATION:
        add_column(&out, "x_m", from, x_of);
        add_column(&out, "y_m", from, y_of);
        add_column(&out, "theta_rad", from, theta_of);
        add_column(&out, "localization_flags", from, flags_of);
        break;
    default:
        add_column(&out, "target_linear_m_s", from, linear_target);
        add_column(&out, "linear_m_s", from, linear_current);
        add_column(&out, "target_angular_rad_s", from, angular_target);
        add_column(&out, "angular_rad_s", from, angular_current);
        break;
    }
    return answer_finish(&out);
}

mxArray *samples_columns(const sample_list *list, uint32_t mask, uint64_t begin_us, uint64_t lost) {
    /* mxMalloc: given back by MATLAB, should it run out of memory on the way. */
    pick from = {mxMalloc((list->count + (size_t)1) * sizeof(const roburoc4_sample *)), 0,
                 begin_us};
    answer out;
    uint32_t service, i;
    answer_begin(&out);
    for (service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++) {
        if ((mask >> service & 1u) != 0) {
            from.count = 0;
            for (i = 0; i < list->count; i++) {
                if (list->samples[i].service == service) {
                    from.at[from.count++] = &list->samples[i];
                }
            }
            answer_add(&out, samples_service(service), columns_of(&from, service));
        }
    }
    answer_number(&out, "lost", (double)lost);
    mxFree(from.at);
    return answer_finish(&out);
}
