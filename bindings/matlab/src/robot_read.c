/* SPDX-License-Identifier: MIT
 *
 * Commands that read: the latest of everything, what the robot is, the link, and columns.
 */
#include "commands.h"
#include "fail.h"
#include "os.h"

/* --------------------------------------------------------------------------------- status --- */

#define FACT(member) FIELD(roburoc4_facts, member, FLAG)

/* clang-format off */
static const field facts_fields[] = {
    FACT(armed), FACT(driving), FACT(stopping), FACT(override_known), FACT(overridden),
    FACT(other_commander), FACT(inhibited), FACT(front_bumper), FACT(rear_bumper),
    FACT(battery_low), FIELD(roburoc4_facts, disarm_cause, INT),
};
/* clang-format on */

/* How old a status is; Inf before the first. */
static double age_s(const roburoc4_sample *latest, uint64_t now_us) {
    if (latest->host_us == 0) {
        return mxGetInf();
    }
    return now_us > latest->host_us ? (double)(now_us - latest->host_us) / 1e6 : 0.0;
}

/* status(id) */
static int read_status(call *in) {
    static const char *const ages[SERVICES] = {"iocard_age_s", "telemeter_age_s", "battery_age_s",
                                               "localization_age_s", "differential_age_s"};
    static const field cycles = FIELD(roburoc4_sample, robot_cycles, CYCLES);
    const roburoc4_facts facts = client_facts(in->client, in->now_us);
    roburoc4_sample latest, newest = {0};
    answer_number(&in->out, "time_s",
                  (double)(in->now_us - ((const robot *)in->object)->opened_us) / 1e6);
    answer_flag(&in->out, "ready", facts.state == ROBUROC4_STATE_READY);
    answer_fields(&in->out, facts_fields, COUNT_OF(facts_fields), &facts);
    for (uint32_t i = 0; i < SERVICES; i++) {
        (void)roburoc4_sample_latest(in->client, FIRST_SERVICE + i, &latest);
        if (FIRST_SERVICE + i != ROBUROC4_SERVICE_IOCARD) {
            samples_answer(&in->out, FIRST_SERVICE + i, &latest);
        }
        answer_number(&in->out, ages[i], age_s(&latest, in->now_us));
        newest = latest.robot_cycles > newest.robot_cycles ? latest : newest;
    }
    answer_fields(&in->out, &cycles, 1, &newest);
    return 1;
}

/* The latest status of a service, for loops that steer by it and need no more: a row costs a third
 * of a struct. All NaN where it is older than fresh_ms. */
static double *make_row(call *in, uint32_t service, size_t count, roburoc4_sample *latest) {
    double *row = make_doubles(&in->results[0], 1, count);
    (void)roburoc4_sample_latest(in->client, service, latest);
    if (age_s(latest, in->now_us) < ((const robot *)in->object)->fresh_us / 1e6) {
        return row;
    }
    for (size_t i = 0; i < count; i++) {
        row[i] = mxGetNaN();
    }
    return NULL;
}

/* pose(id): x_m, y_m, theta_rad, and when the robot made it, time_s */
static int read_pose(call *in) {
    roburoc4_sample latest;
    double *row = make_row(in, ROBUROC4_SERVICE_LOCALIZATION, 4, &latest);
    if (row != NULL) {
        row[0] = latest.value.localization.x_m;
        row[1] = latest.value.localization.y_m;
        row[2] = latest.value.localization.theta_rad;
        row[3] = seconds_since(latest.made_us, ((const robot *)in->object)->opened_us);
    }
    return 1;
}

/* speeds(id): current_linear_m_s, current_angular_rad_s */
static int read_speeds(call *in) {
    roburoc4_sample latest;
    double *row = make_row(in, ROBUROC4_SERVICE_DIFFERENTIAL, 2, &latest);
    if (row != NULL) {
        row[0] = (double)latest.value.differential.current_linear_m_s;
        row[1] = (double)latest.value.differential.current_angular_rad_s;
    }
    return 1;
}

/* ----------------------------------------------------------------------------------- info --- */

#define LIMIT(member) FIELD(roburoc4_differential_properties, member, FLOAT)

/* clang-format off */
static const field limits[] = {
    LIMIT(max_linear_m_s), LIMIT(min_linear_m_s), LIMIT(max_angular_rad_s),
    LIMIT(min_angular_rad_s), LIMIT(max_linear_m_s2), LIMIT(min_linear_m_s2),
    LIMIT(max_angular_rad_s2), LIMIT(min_angular_rad_s2), LIMIT(width_m),
};
static const field battery[] = {
    FIELD(roburoc4_battery_properties, nominal_voltage_v, FLOAT),
    FIELD(roburoc4_battery_properties, capacity_ah, FLOAT),
    FIELD(roburoc4_battery_properties, minimum_percent, BYTE),
};
static const field start[] = {
    FIELD_AS("power_on_x_m", roburoc4_localization_properties, x_m, FLOAT),
    FIELD_AS("power_on_y_m", roburoc4_localization_properties, y_m, FLOAT),
    FIELD_AS("power_on_theta_rad", roburoc4_localization_properties, theta_rad, FLOAT),
};
/* clang-format on */
#define CHANNELS(member) FIELD(roburoc4_iocard_properties, member, INT)

/* By ROBUROC4_IO_*. */
/* clang-format off */
static const field channels[CHANNEL_TYPES] = {
    CHANNELS(analog_inputs), CHANNELS(analog_outputs), CHANNELS(digital_inputs),
    CHANNELS(digital_outputs),
};
/* clang-format on */
#define TELEMETER(member) FIELD_AS("telemeter_" #member, roburoc4_telemeter, member, FLOAT)

/* clang-format off */
static const field telemeter[] = {
    TELEMETER(x_m), TELEMETER(y_m), TELEMETER(theta_rad), TELEMETER(field_of_view_rad),
    TELEMETER(min_distance_m), TELEMETER(max_distance_m),
};
static const field directory[] = {
    FIELD_AS("service_ids", roburoc4_directory_entry, id, UINT),
    FIELD_AS("service_types", roburoc4_directory_entry, type, UINT),
};
/* clang-format on */

/* info(id) */
static int read_info(call *in) {
    roburoc4_differential_properties drive;
    roburoc4_battery_properties energy;
    roburoc4_localization_properties pose;
    roburoc4_iocard_properties card = {0};
    roburoc4_telemeter telemeters[ROBUROC4_MAX_TELEMETERS] = {{0}};
    roburoc4_directory_entry entries[ROBUROC4_MAX_SERVICES] = {{0}};
    const int has_drive = roburoc4_client_differential_properties(in->client, &drive) >= 0;
    const int has_energy = roburoc4_client_battery_properties(in->client, &energy) >= 0;
    const int has_pose = roburoc4_client_localization_properties(in->client, &pose) >= 0;
    uint32_t telemeter_count = 0, entry_count = 0;
    while (telemeter_count < ROBUROC4_MAX_TELEMETERS &&
           roburoc4_client_telemeter(in->client, telemeter_count, &telemeters[telemeter_count]) >=
               0) {
        telemeter_count++;
    }
    while (entry_count < ROBUROC4_MAX_SERVICES &&
           roburoc4_client_service_at(in->client, entry_count, &entries[entry_count]) >= 0) {
        entry_count++;
    }
    (void)roburoc4_client_iocard_properties(in->client, &card);
    answer_fields(&in->out, limits, COUNT_OF(limits), has_drive ? &drive : NULL);
    answer_fields(&in->out, battery, COUNT_OF(battery), has_energy ? &energy : NULL);
    answer_fields(&in->out, start, COUNT_OF(start), has_pose ? &pose : NULL);
    answer_fields(&in->out, channels, COUNT_OF(channels), &card);
    answer_rows(&in->out, telemeter, COUNT_OF(telemeter), telemeters, sizeof *telemeters,
                telemeter_count);
    answer_rows(&in->out, directory, COUNT_OF(directory), entries, sizeof *entries, entry_count);
    return 1;
}

/* address(id) */
static int read_address(call *in) {
    char address[ROBUROC4_ADDRESS_TEXT_SIZE];
    (void)robot_socket(in->object, address);
    in->results[0] = make_text(address);
    return 1;
}

/* ----------------------------------------------------------------------------------- link --- */

/* clang-format off */
static const field link_fields[] = {
    FIELD_AS("round_trip_s", roburoc4_link, round_trip_us, SECONDS),
    FIELD_AS("round_trip_min_s", roburoc4_link, round_trip_min_us, SECONDS),
    FIELD_AS("silence_s", roburoc4_link, silence_us, SECONDS),
    FIELD(roburoc4_link, received, UINT), FIELD(roburoc4_link, lost, UINT),
    FIELD(roburoc4_link, loss, FLOAT),
};
static const field service_link_fields[] = {
    FIELD(roburoc4_service_link, subscribed, FLAG), FIELD(roburoc4_service_link, received, UINT),
    FIELD(roburoc4_service_link, lost, UINT), FIELD(roburoc4_service_link, late, UINT),
    FIELD(roburoc4_service_link, duplicates, UINT),
    FIELD_AS("period_s", roburoc4_service_link, period_us, SECONDS),
    FIELD_AS("jitter_s", roburoc4_service_link, jitter_us, SECONDS),
    FIELD(roburoc4_service_link, loss, FLOAT),
};
/* clang-format on */

/* link(id) */
static int read_link(call *in) {
    roburoc4_link link = {.size = sizeof link};
    (void)roburoc4_client_link(in->client, in->now_us, &link);
    answer_fields(&in->out, link_fields, COUNT_OF(link_fields), &link);
    return 1;
}

/* serviceLink(id, service) */
static int read_service_link(call *in) {
    roburoc4_service_link link = {.size = sizeof link};
    uint32_t service;
    if (!take_service(in->arguments[0], &service)) {
        return 0;
    }
    (void)roburoc4_client_service_link(in->client, service, in->now_us, &link);
    answer_fields(&in->out, service_link_fields, COUNT_OF(service_link_fields), &link);
    answer_number(&in->out, "age_s", link.age_us == UINT32_MAX ? mxGetInf() : link.age_us / 1e6);
    return 1;
}

/* ------------------------------------------------------------------------------ the IO card --- */

/* How many channels of a type can have a name here. */
static uint32_t named_channels(const call *in, uint32_t io_type) {
    const uint32_t all = channel_count(in->client, io_type);
    return all < CHANNELS_MAX ? all : CHANNELS_MAX;
}

static roburoc4_result find_channel(const call *in, uint32_t io_type, const char *name) {
    static channel_texts texts;
    const char *pointers[CHANNELS_MAX];
    const uint32_t count = named_channels(in, io_type);
    robot_texts(in->object, io_type, count, texts);
    for (uint32_t i = 0; i < count; i++) {
        pointers[i] = texts[i];
    }
    return roburoc4_client_channel_find(in->client, io_type, name, pointers, count);
}

/* A channel of some types (bits by ROBUROC4_IO_*). Returns 0 after noting why there is none. */
static int take_channel(const call *in, uint32_t types, uint32_t *io_type, uint32_t *index) {
    char name[TEXT_SIZE];
    uint32_t found = 0;
    if (!take_text(in->arguments[0], "channel", name)) {
        return 0;
    }
    for (uint32_t type = 0; type < CHANNEL_TYPES; type++) {
        const roburoc4_result at =
            (types >> type & 1u) != 0 ? find_channel(in, type, name) : ROBUROC4_ERR_INDEX;
        if (at >= 0) {
            *io_type = type;
            *index = (uint32_t)at;
            found++;
        }
        found += at == ROBUROC4_ERR_VALUE ? 2 : 0;
    }
    if (found > 1) {
        return fail(FAIL_ARGUMENT,
                    "'%s' is ambiguous: several channels have this name; use inputs() and an index",
                    name);
    }
    return found == 1 ||
           fail(FAIL_ARGUMENT, "the robot has no channel '%s'; inputs() lists the names", name);
}

/* output(id, name, digital): the index of an output; call digital() or analog() with it */
static int find_output(call *in) {
    uint32_t io_type, index;
    int digital;
    if (!take_flag(in->arguments[1], "digital", &digital) ||
        !take_channel(in, 1u << (digital ? ROBUROC4_IO_DIGITAL_OUTPUT : ROBUROC4_IO_ANALOG_OUTPUT),
                      &io_type, &index)) {
        return 0;
    }
    in->number = index;
    return 1;
}

/* The latest inputs. Returns 0 after noting that there are none yet. */
static int read_sample(const call *in, roburoc4_sample *out) {
    return roburoc4_sample_latest(in->client, ROBUROC4_SERVICE_IOCARD, out) >= 0 ||
           fail(FAIL_PROTOCOL, "the robot has sent no IO card status yet; wait with sleep(0.1)");
}

/* input(id, name): double of an analog input, logical of a digital one */
static int read_input(call *in) {
    const uint32_t types = 1u << ROBUROC4_IO_ANALOG_INPUT | 1u << ROBUROC4_IO_DIGITAL_INPUT;
    roburoc4_sample sample;
    const roburoc4_inputs *inputs = &sample.value.inputs;
    uint32_t io_type, index;
    if (!take_channel(in, types, &io_type, &index) || !read_sample(in, &sample)) {
        return 0;
    }
    if (io_type == ROBUROC4_IO_DIGITAL_INPUT && index < inputs->digital_count) {
        in->results[0] = mxCreateLogicalScalar((inputs->digital >> index & 1u) != 0);
    } else if (io_type == ROBUROC4_IO_ANALOG_INPUT && index < inputs->analog_count) {
        in->results[0] = mxCreateDoubleScalar((double)inputs->analog[index]);
    } else {
        return fail(FAIL_LIMIT, "input %lu is beyond those that the client stores",
                    (unsigned long)index);
    }
    return 1;
}

/* The names of all channels of a type: the robot's own, else the manual's. */
static mxArray *make_names(const call *in, uint32_t io_type) {
    static channel_texts texts;
    const uint32_t count = named_channels(in, io_type);
    mxArray *names = mxCreateCellMatrix(1, count);
    robot_texts(in->object, io_type, count, texts);
    for (uint32_t i = 0; i < count; i++) {
        const char *manual = roburoc4_client_channel_name(in->client, io_type, i);
        mxSetCell(names, i, make_text(texts[i][0] != '\0' || manual == NULL ? texts[i] : manual));
    }
    return names;
}

/* inputs(id): all of them, with the names of all channels */
static int read_inputs(call *in) {
    static const char *const names[CHANNEL_TYPES] = {"analog_input_names", "analog_output_names",
                                                     "digital_input_names", "digital_output_names"};
    static const field cycles = FIELD(roburoc4_sample, robot_cycles, CYCLES);
    roburoc4_sample sample;
    if (!read_sample(in, &sample)) {
        return 0;
    }
    answer_fields(&in->out, &cycles, 1, &sample);
    samples_answer(&in->out, ROBUROC4_SERVICE_IOCARD, &sample);
    for (uint32_t i = 0; i < CHANNEL_TYPES; i++) {
        answer_add(&in->out, names[i], make_names(in, i));
    }
    return 1;
}

/* -------------------------------------------------------------------------------- columns --- */

/* The services that the arguments name; all if there are none. */
static int take_mask(const call *in, uint32_t *mask) {
    *mask = in->count > 0 ? 0 : ALL_SERVICES;
    for (int i = 0; i < in->count; i++) {
        uint32_t service;
        if (!take_service(in->arguments[i], &service)) {
            return 0;
        }
        *mask |= 1u << service;
    }
    return 1;
}

/* UTC is what this machine's clock shows now; in virtual time the simulator's time, so that runs
 * are reproducible. */
static clocks clocks_since(const robot *r, uint64_t begin_us) {
    const uint64_t offset_us = roburoc4_os_calendar_us() - roburoc4_udp_now_us();
    return (clocks){begin_us, r->simulated ? 0.0 : (double)(int64_t)offset_us / 1e6};
}

/* startUtc(id): UTC when the robot was made */
static int read_start(call *in) {
    const robot *r = in->object;
    in->number = clocks_since(r, 0).utc_s + (double)r->opened_us / 1e6;
    return 1;
}

/* receiveBegin(id): the next status is the first that arrives after this */
static int begin_receiving(call *in) {
    robot *r = in->object;
    (void)roburoc4_pump_reader_init(r->pump, &r->received);
    return 1;
}

/* The next sample of a service, if available. */
static int next_sample(robot *r, uint32_t service, roburoc4_sample *out) {
    while (roburoc4_pump_read_samples(r->pump, &r->received, out, 1) > 0) {
        if (out->service == service) {
            return 1;
        }
    }
    return 0;
}

/* receive(id, service, seconds): the next status of a service, or [] if none arrived in time */
static int receive(call *in) {
    robot *r = in->object;
    const clocks times = clocks_since(r, r->opened_us);
    uint64_t end_us;
    roburoc4_sample sample;
    uint32_t service;
    double seconds;
    int found;
    if (!take_service(in->arguments[0], &service) ||
        !take_range(in->arguments[1], "seconds", 0.0, LONGEST_WAIT_S, &seconds)) {
        return 0;
    }
    end_us = robot_now_us(r) + (uint64_t)(seconds * 1e6 + 0.5);
    while (!(found = next_sample(r, service, &sample)) && robot_now_us(r) < end_us) {
        robot_wait_sample(r, &r->received, end_us);
    }
    if (found) {
        samples_one(&in->out, &sample, &times);
        in->results[0] = answer_finish(&in->out);
    } else {
        (void)make_doubles(&in->results[0], 0, 0);
    }
    return 1;
}

/* record(id, service, ...): record from now on; the services are only checked */
static int begin_recording(call *in) {
    robot *r = in->object;
    uint32_t mask;
    if (!take_mask(in, &mask)) {
        return 0;
    }
    recording_end(&r->recorded);
    (void)roburoc4_pump_reader_init(r->pump, &r->recorded.reader);
    r->recorded_us = in->now_us;
    return 1;
}

/* recorded(id): add what has arrived since */
static int go_on_recording(call *in) {
    robot *r = in->object;
    return recording_go_on(&r->recorded, r->pump);
}

/* All of a recording, of the services that the arguments name, as columns. */
static int give_columns(call *in, recording *rec, uint64_t begin_us) {
    const robot *r = in->object;
    const clocks times = clocks_since(r, begin_us);
    uint32_t mask;
    if (!take_mask(in, &mask) || !recording_go_on(rec, r->pump)) {
        return 0;
    }
    in->results[0] = samples_columns(&rec->list, mask, &times, rec->reader.lost);
    return 1;
}

/* recording(id, service, ...): everything recorded */
static int end_recording(call *in) {
    robot *r = in->object;
    if (!give_columns(in, &r->recorded, r->recorded_us)) {
        return 0;
    }
    if (r->recorded.list.count == 0 && roburoc4_client_state(in->client) != ROBUROC4_STATE_READY) {
        return fail(FAIL_TIMEOUT, "nothing was recorded: the robot does not answer; look at link");
    }
    recording_end(&r->recorded);
    return 1;
}

/* log(id, service, ...): everything since the robot was made, or since the last logged() */
static int read_log(call *in) {
    robot *r = in->object;
    return give_columns(in, &r->logged, r->opened_us);
}

/* logged(id): the next log starts here; drops what log() returned, if it was called */
static int end_log(call *in) {
    recording_end(&((robot *)in->object)->logged);
    return 1;
}

const command robot_read_commands[] = {
    {"status", READ_ROBOT, 0, STRUCT, read_status},
    {"pose", READ_ROBOT, 0, OTHER, read_pose},
    {"speeds", READ_ROBOT, 0, OTHER, read_speeds},
    {"info", READ_ROBOT, 0, STRUCT, read_info},
    {"address", READ_ROBOT, 0, OTHER, read_address},
    {"link", READ_ROBOT, 0, STRUCT, read_link},
    {"serviceLink", READ_ROBOT, 1, STRUCT, read_service_link},
    {"output", READ_ROBOT, 2, NUMBER, find_output},
    {"input", READ_ROBOT, 1, OTHER, read_input},
    {"inputs", READ_ROBOT, 0, STRUCT, read_inputs},
    {"record", READ_ROBOT, -1, NOTHING, begin_recording},
    {"recorded", READ_ROBOT, 0, NOTHING, go_on_recording},
    {"startUtc", READ_ROBOT, 0, NUMBER, read_start},
    {"receiveBegin", READ_ROBOT, 0, NOTHING, begin_receiving},
    {"receive", WAIT_ROBOT, 2, OTHER, receive},
    {"recording", READ_ROBOT, -1, OTHER, end_recording},
    {"log", READ_ROBOT, -1, OTHER, read_log},
    {"logged", READ_ROBOT, 0, NOTHING, end_log},
    {NULL, NO_ID, 0, NOTHING, NULL},
};
