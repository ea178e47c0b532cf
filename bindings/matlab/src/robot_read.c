/* SPDX-License-Identifier: MIT
 *
 * Commands that read: the latest of everything, what the robot is, the link, and columns.
 */
#include <string.h>

#include "commands.h"

/* --------------------------------------------------------------------------------- status --- */

#define FACT(member) FIELD(roburoc4_facts, member, FLAG)

/* clang-format off */
static const field facts_fields[] = {
    FACT(armed), FACT(driving), FACT(lapsed), FACT(stopping), FACT(other_commander),
    FACT(inhibited), FIELD(roburoc4_facts, disarm_cause, INT),
};
/* clang-format on */
static const field robot_cycles = FIELD(roburoc4_sample, robot_cycles, CYCLES);

/* 1 or 0, or NaN where it is not known: as a condition that is an error. */
static void add_switch(answer *out, const char *name, int known, int on) {
    answer_number(out, name, known ? on : mxGetNaN());
}

static void add_switches(answer *out, const roburoc4_facts *facts) {
    add_switch(out, "overridden", facts->override_known, facts->overridden);
    add_switch(out, "front_bumper", facts->front_bumper_known, facts->front_bumper);
    add_switch(out, "rear_bumper", facts->rear_bumper_known, facts->rear_bumper);
    add_switch(out, "battery_low", facts->battery_known, facts->battery_low);
}

static void add_texts(answer *out, const roburoc4_facts *facts) {
    static const char *const outcomes[] = {"none", "running", "confirmed", "timed_out",
                                           "overridden"};
    const char *why = facts->armed ? ""
                      : facts->disarm_cause == ROBUROC4_ERR_CLOSED
                          ? "its simulator was deleted"
                          : roburoc4_result_text(facts->disarm_cause);
    answer_add(out, "disarm_text", make_text(why));
    answer_add(out, "stop_outcome", make_text(outcomes[facts->stop_outcome]));
}

/* The names of the services that were to be subscribed to and send nothing, apart by spaces. */
static void add_missing(answer *out, uint32_t missing) {
    char text[64] = "";
    for (uint32_t i = 0; i < SERVICES; i++) {
        if ((missing >> (FIRST_SERVICE + i) & 1u) != 0) {
            (void)strcat(strcat(text, text[0] != '\0' ? " " : ""), service_name(FIRST_SERVICE + i));
        }
    }
    answer_add(out, "missing", make_text(text));
}

/* How old a status can be at most; Inf without one, or if it is from before the robot was found. */
static double age_s(const roburoc4_facts *facts, uint32_t service) {
    const uint32_t age_us = facts->age_us[service];
    return age_us == UINT32_MAX ? mxGetInf() : age_us / 1e6;
}

/* status(id) */
static int read_status(call *in) {
    static const char *const ages[SERVICES] = {"iocard_age_s", "telemeter_age_s", "battery_age_s",
                                               "localization_age_s", "differential_age_s"};
    const roburoc4_facts facts = robot_facts(in->object, in->client, in->now_us);
    roburoc4_sample latest, newest = {0};
    answer_number(&in->out, "time_s", answer_time(&in->out, in->now_us));
    answer_flag(&in->out, "ready", facts.state == ROBUROC4_STATE_READY);
    answer_fields(&in->out, facts_fields, COUNT_OF(facts_fields), &facts);
    add_texts(&in->out, &facts);
    add_switches(&in->out, &facts);
    add_missing(&in->out, facts.missing);
    for (uint32_t i = 0; i < SERVICES; i++) {
        (void)roburoc4_sample_latest(in->client, FIRST_SERVICE + i, &latest);
        if (FIRST_SERVICE + i != ROBUROC4_SERVICE_IOCARD) {
            sample_values(&in->out, &latest);
        }
        answer_number(&in->out, ages[i], age_s(&facts, FIRST_SERVICE + i));
        newest = latest.robot_cycles > newest.robot_cycles ? latest : newest;
    }
    answer_fields(&in->out, &robot_cycles, 1, &newest);
    return 1;
}

/* The latest status of a service, for loops that steer by it and need no more: a row costs a third
 * of a struct. All NaN where it is older than fresh_ms. */
static int read_row(call *in, uint32_t service, const field *fields, size_t count) {
    double *row = make_row(&in->results[0], count);
    const roburoc4_facts facts = robot_facts(in->object, in->client, in->now_us);
    const int fresh = facts.age_us[service] < ((const robot *)in->object)->fresh_us;
    roburoc4_sample latest;
    (void)roburoc4_sample_latest(in->client, service, &latest);
    for (size_t i = 0; i < count; i++) {
        row[i] = fresh ? field_number(&in->out, &fields[i], &latest, 0) : mxGetNaN();
    }
    return 1;
}

#define VALUE(member) FIELD(roburoc4_sample, value.member, FLOAT)

/* pose(id): x_m, y_m, theta_rad, and when the robot made it, made_s */
static int read_pose(call *in) {
    static const field row[] = {VALUE(localization.x_m), VALUE(localization.y_m),
                                VALUE(localization.theta_rad),
                                FIELD(roburoc4_sample, made_us, TIME)};
    return read_row(in, ROBUROC4_SERVICE_LOCALIZATION, row, COUNT_OF(row));
}

/* speeds(id): current_linear_m_s, current_angular_rad_s */
static int read_speeds(call *in) {
    static const field row[] = {VALUE(differential.current_linear_m_s),
                                VALUE(differential.current_angular_rad_s)};
    return read_row(in, ROBUROC4_SERVICE_DIFFERENTIAL, row, COUNT_OF(row));
}

/* ----------------------------------------------------------------------------------- info --- */

/* What a robot has. */
typedef struct properties {
    roburoc4_differential_properties drive;
    roburoc4_battery_properties battery;
    roburoc4_localization_properties start;
    roburoc4_iocard_properties card;
    roburoc4_telemeter telemeters[ROBUROC4_MAX_TELEMETERS];
    roburoc4_directory_entry entries[ROBUROC4_MAX_SERVICES];
    uint32_t telemeter_count, entry_count;
} properties;

#define LIMIT(member) FIELD_AS(#member, properties, drive.member, FLOAT)
#define BATTERY(member, type) FIELD_AS(#member, properties, battery.member, type)
#define START(member) FIELD_AS("power_on_" #member, properties, start.member, FLOAT)
#define CHANNELS(member) FIELD_AS(#member, properties, card.member, INT)
#define TELEMETER(member)                                                                          \
    FIELD_ROW("telemeter_" #member, properties, telemeters, telemeters[0].member, FLOAT,           \
              telemeter_count)
#define ENTRY(name, member)                                                                        \
    FIELD_ROW(name, properties, entries, entries[0].member, UINT, entry_count)

/* clang-format off */
static const field info_fields[] = {
    LIMIT(max_linear_m_s), LIMIT(min_linear_m_s), LIMIT(max_angular_rad_s),
    LIMIT(min_angular_rad_s), LIMIT(max_linear_m_s2), LIMIT(min_linear_m_s2),
    LIMIT(max_angular_rad_s2), LIMIT(min_angular_rad_s2), LIMIT(width_m),
    BATTERY(nominal_voltage_v, FLOAT), BATTERY(capacity_ah, FLOAT), BATTERY(minimum_percent, BYTE),
    START(x_m), START(y_m), START(theta_rad),
    CHANNELS(analog_inputs), CHANNELS(analog_outputs), CHANNELS(digital_inputs),
    CHANNELS(digital_outputs),
    TELEMETER(x_m), TELEMETER(y_m), TELEMETER(theta_rad), TELEMETER(field_of_view_rad),
    TELEMETER(min_distance_m), TELEMETER(max_distance_m),
    ENTRY("service_ids", id), ENTRY("service_types", type),
};
/* clang-format on */

/* info(id) */
static int read_info(call *in) {
    properties all;
    memset(&all, 0xFF, sizeof all); /* what is not reported yet: NaN of floats, 255 of bytes */
    memset(&all.card, 0, sizeof all.card);
    (void)roburoc4_client_differential_properties(in->client, &all.drive);
    (void)roburoc4_client_battery_properties(in->client, &all.battery);
    (void)roburoc4_client_localization_properties(in->client, &all.start);
    (void)roburoc4_client_iocard_properties(in->client, &all.card);
    all.telemeter_count = all.entry_count = 0;
    while (roburoc4_client_telemeter(in->client, all.telemeter_count,
                                     &all.telemeters[all.telemeter_count]) >= 0) {
        all.telemeter_count++;
    }
    while (roburoc4_client_service_at(in->client, all.entry_count, &all.entries[all.entry_count]) >=
           0) {
        all.entry_count++;
    }
    answer_fields(&in->out, info_fields, COUNT_OF(info_fields), &all);
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
    (void)roburoc4_client_service_link(in->client, (uint32_t)in->numbers[0], in->now_us, &link);
    answer_fields(&in->out, service_link_fields, COUNT_OF(service_link_fields), &link);
    answer_number(&in->out, "age_s", link.age_us == UINT32_MAX ? mxGetInf() : link.age_us / 1e6);
    return 1;
}

/* ------------------------------------------------------------------------------ the IO card --- */

/* At most this many channels of a type have names. */
#define CHANNELS_MAX ROBUROC4_MAX_DIGITAL_INPUTS
#define CHANNEL_TYPES (ROBUROC4_IO_DIGITAL_OUTPUT + 1)

/* The robot's own texts for the channels of one type, "" where it has none; how many there are. */
static uint32_t read_texts(const call *in, uint32_t io_type, const char *texts[CHANNELS_MAX]) {
    static char memory[CHANNELS_MAX][ROBUROC4_PUMP_DESCRIPTION_SIZE];
    roburoc4_iocard_properties card = {0};
    int32_t count;
    uint32_t i;
    (void)roburoc4_client_iocard_properties(in->client, &card);
    count = io_type == ROBUROC4_IO_ANALOG_INPUT    ? card.analog_inputs
            : io_type == ROBUROC4_IO_ANALOG_OUTPUT ? card.analog_outputs
            : io_type == ROBUROC4_IO_DIGITAL_INPUT ? card.digital_inputs
                                                   : card.digital_outputs;
    for (i = 0; i < CHANNELS_MAX && (int32_t)i < count; i++) {
        texts[i] = memory[i];
        if (roburoc4_pump_description(((robot *)in->object)->pump, (int32_t)io_type, i, memory[i],
                                      sizeof memory[i]) < 0) {
            memory[i][0] = '\0';
        }
    }
    return i;
}

/* channel(id, name, types): [type index] of the channel with this name, among those of types whose
 * bits (by ROBUROC4_IO_*) are set */
static int find_channel(call *in) {
    const char *name = in->texts[0], *texts[CHANNELS_MAX];
    double *row = make_row(&in->results[0], 2);
    int found = 0;
    for (uint32_t type = 0; type < CHANNEL_TYPES; type++) {
        if (((uint32_t)in->numbers[1] >> type & 1u) != 0) {
            const uint32_t count = read_texts(in, type, texts);
            const roburoc4_result index =
                roburoc4_client_channel_find(in->client, type, name, texts, count);
            if (index >= 0) {
                row[0] = type;
                row[1] = index;
            }
            found += index >= 0 ? 1 : index == ROBUROC4_ERR_VALUE ? 2 : 0;
        }
    }
    if (found == 0) {
        return fail(FAIL_ARGUMENT, "the robot has no channel '%s'; inputs() lists the names", name);
    }
    return found == 1 ||
           fail(FAIL_ARGUMENT,
                "'%s' is ambiguous: several channels have this name; use inputs() and an index",
                name);
}

/* inputs(id): the latest values */
static int read_inputs(call *in) {
    const roburoc4_facts facts = robot_facts(in->object, in->client, in->now_us);
    roburoc4_sample sample;
    if (roburoc4_sample_latest(in->client, ROBUROC4_SERVICE_IOCARD, &sample) < 0) {
        return fail(FAIL_PROTOCOL,
                    "the robot has sent no IO card status yet; wait with sleep(0.1)");
    }
    answer_fields(&in->out, &robot_cycles, 1, &sample);
    sample_values(&in->out, &sample);
    answer_number(&in->out, "age_s", age_s(&facts, ROBUROC4_SERVICE_IOCARD));
    return 1;
}

/* names(id): those of all channels, the robot's own, else the manual's */
static int read_names(call *in) {
    static const char *const names[CHANNEL_TYPES] = {"analog_input_names", "analog_output_names",
                                                     "digital_input_names", "digital_output_names"};
    const char *texts[CHANNELS_MAX];
    for (uint32_t type = 0; type < CHANNEL_TYPES; type++) {
        const uint32_t count = read_texts(in, type, texts);
        mxArray *cell = mxCreateCellMatrix(1, count);
        for (uint32_t i = 0; i < count; i++) {
            const char *manual = roburoc4_client_channel_name(in->client, type, i);
            mxSetCell(cell, i,
                      make_text(texts[i][0] != '\0' || manual == NULL ? texts[i] : manual));
        }
        answer_add(&in->out, names[type], cell);
    }
    return 1;
}

/* -------------------------------------------------------------------------------- columns --- */

/* startUtc(id): UTC when the robot was made */
static int read_start(call *in) {
    in->number = (double)(in->out.utc_us + in->out.begin_us) / 1e6;
    return 1;
}

/* record(id, service, ...): record from now on; the services are only checked */
static int begin_recording(call *in) {
    robot *r = in->object;
    recording_end(&r->recorded);
    (void)roburoc4_pump_reader_init(r->pump, &r->recorded.reader);
    r->recorded.begin_us = in->now_us;
    return 1;
}

/* listen(id): from now on, for receive() */
static int begin_listening(call *in) {
    robot *r = in->object;
    (void)roburoc4_pump_reader_init(r->pump, &r->heard);
    return 1;
}

/* The next status of a service. */
static int next_sample(robot *r, uint32_t service, roburoc4_sample *out) {
    while (roburoc4_pump_read_samples(r->pump, &r->heard, out, 1) > 0) {
        if (out->service == service) {
            return 1;
        }
    }
    return 0;
}

/* receive(id, service, seconds): the next status of a service since listen(), or [] if none arrived
 * in time */
static int receive(call *in) {
    robot *r = in->object;
    uint64_t now_us = robot_now_us(r);
    const uint64_t end_us = now_us + (uint64_t)(in->numbers[1] * 1e6 + 0.5);
    roburoc4_sample sample;
    while (!next_sample(r, (uint32_t)in->numbers[0], &sample)) {
        if (now_us >= end_us) {
            (void)make_row(&in->results[0], 0);
            return 1;
        }
        robot_wait(r, r->world != NULL ? ROBUROC4_CYCLE_US : (uint32_t)(end_us - now_us),
                   &r->heard);
        now_us = robot_now_us(r);
    }
    sample_times(&in->out, &sample);
    sample_values(&in->out, &sample);
    in->results[0] = answer_finish(&in->out);
    return 1;
}

/* In the order of their bits. Those that announce a status or a text are not among them. */
static const struct {
    uint32_t bit;
    const char *name;
} events[] = {
    {ROBUROC4_EVENT_READY, "ready"},
    {ROBUROC4_EVENT_LOST, "lost"},
    {ROBUROC4_EVENT_REBOOT, "reboot"},
    {ROBUROC4_EVENT_ARMED, "armed"},
    {ROBUROC4_EVENT_DISARMED, "disarmed"},
    {ROBUROC4_EVENT_LAPSED, "lapsed"},
    {ROBUROC4_EVENT_STOP_CONFIRMED, "stop_confirmed"},
    {ROBUROC4_EVENT_OVERRIDE, "override"},
    {ROBUROC4_EVENT_OTHER_COMMANDER, "other_commander"},
    {ROBUROC4_EVENT_INHIBITED, "inhibited"},
    {ROBUROC4_EVENT_BATTERY_LOW, "battery_low"},
    {ROBUROC4_EVENT_BATTERY_CRITICAL, "battery_critical"},
    {ROBUROC4_EVENT_ARMABLE, "armable"},
    {ROBUROC4_EVENT_STOP_UNCONFIRMED, "stop_unconfirmed"},
};

/* hear(id): from now on, for news() */
static int begin_hearing(call *in) {
    robot *r = in->object;
    (void)roburoc4_pump_reader_init(r->pump, &r->told);
    r->events = 0;
    return 1;
}

/* Whether it was one of the events that have a name. */
static int next_event(call *in, robot *r) {
    const roburoc4_result taken = roburoc4_pump_take_events(r->pump, &r->told);
    r->events |= taken > 0 ? (uint32_t)taken : 0;
    for (size_t i = 0; i < COUNT_OF(events); i++) {
        if ((r->events & events[i].bit) != 0) {
            r->events &= ~events[i].bit;
            answer_add(&in->out, "kind", make_text("event"));
            answer_add(&in->out, "name", make_text(events[i].name));
            answer_add(&in->out, "text",
                       make_text(roburoc4_name(ROBUROC4_NAME_EVENT, events[i].bit)));
            return 1;
        }
    }
    return 0;
}

/* news(id): the next status or event since hear(), with its kind, or [] if there is none */
static int read_news(call *in) {
    robot *r = in->object;
    roburoc4_sample sample;
    if (next_event(in, r)) {
        answer_number(&in->out, "time_s", answer_time(&in->out, in->now_us));
    } else if (roburoc4_pump_read_samples(r->pump, &r->told, &sample, 1) > 0) {
        answer_add(&in->out, "kind", make_text(service_name(sample.service)));
        sample_times(&in->out, &sample);
        sample_values(&in->out, &sample);
    } else {
        (void)make_row(&in->results[0], 0);
        return 1;
    }
    in->results[0] = answer_finish(&in->out);
    return 1;
}

/* recorded(id): add what has arrived since */
static int go_on_recording(call *in) {
    robot *r = in->object;
    return recording_go_on(&r->recorded, r->pump);
}

/* recording(id, service, ...): everything recorded, as columns */
static int end_recording(call *in) {
    robot *r = in->object;
    if (!recording_columns(&in->out, &r->recorded, r->pump, in->services)) {
        return 0;
    }
    if (r->recorded.count == 0 && roburoc4_client_state(in->client) != ROBUROC4_STATE_READY) {
        return fail(FAIL_TIMEOUT, "nothing was recorded: the robot does not answer; check link");
    }
    recording_end(&r->recorded);
    return 1;
}

/* log(id, service, ...): everything since the robot was made, or since the last logged() */
static int read_log(call *in) {
    robot *r = in->object;
    return recording_columns(&in->out, &r->logged, r->pump, in->services);
}

/* logged(id): the next log starts here; drops what log() returned, if it was called */
static int end_log(call *in) {
    recording_end(&((robot *)in->object)->logged);
    return 1;
}

/* clang-format off */
const command robot_read_commands[] = {
    {"status", READ_ROBOT, STRUCT, read_status, {NONE}},
    {"pose", READ_ROBOT, OTHER, read_pose, {NONE}},
    {"speeds", READ_ROBOT, OTHER, read_speeds, {NONE}},
    {"info", READ_ROBOT, STRUCT, read_info, {NONE}},
    {"link", READ_ROBOT, STRUCT, read_link, {NONE}},
    {"serviceLink", READ_ROBOT, STRUCT, read_service_link, {SERVICE}},
    {"channel", READ_ROBOT, OTHER, find_channel, {TEXT("channel"), WHOLE("types", 0, 15)}},
    {"inputs", READ_ROBOT, STRUCT, read_inputs, {NONE}},
    {"names", READ_ROBOT, STRUCT, read_names, {NONE}},
    {"startUtc", READ_ROBOT, NUMBER, read_start, {NONE}},
    {"listen", READ_ROBOT, NOTHING, begin_listening, {NONE}},
    {"receive", WAIT_ROBOT, OTHER, receive, {SERVICE, WITHIN("seconds", 0, LONGEST_WAIT_S)}},
    {"hear", READ_ROBOT, NOTHING, begin_hearing, {NONE}},
    {"news", READ_ROBOT, OTHER, read_news, {NONE}},
    {"record", READ_ROBOT, NOTHING, begin_recording, {SERVICES_IF_ANY}},
    {"recorded", READ_ROBOT, NOTHING, go_on_recording, {NONE}},
    {"recording", READ_ROBOT, STRUCT, end_recording, {SERVICES_IF_ANY}},
    {"log", READ_ROBOT, STRUCT, read_log, {SERVICES_IF_ANY}},
    {"logged", READ_ROBOT, NOTHING, end_log, {NONE}},
    LAST,
};
/* clang-format on */
