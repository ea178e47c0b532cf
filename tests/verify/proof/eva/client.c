/* SPDX-License-Identifier: MIT
 *
 * For Frama-C's Eva: the client under every sequence of calls, by induction. Each main_* below
 * takes any client that satisfies the invariant, makes one call with any arguments, and asserts
 * that the invariant holds again; main_client_init shows that every life begins with it. What the
 * invariant does not name is arbitrary: settings, times, speeds, counters. tests/verify/proof/run analyses
 * each main_*. Never run.
 */
#include "any.h"

/* C allows to copy nothing from the end of a datagram; Frama-C's memcpy asks for a byte even then.
 */
static void *copy_if_any(void *to, const void *from, size_t size) {
    return size > 0 ? memcpy(to, from, size) : to;
}
#define memcpy copy_if_any

#include "codec.c"
#include "link.c"

#undef memcpy

#include "../believed.h"

/* True of any number: Eva takes each case by itself. */
/*@ ensures cases: \result < 0 || out->count == 0 || out->count == 1 || out->count == 2 ||
        out->count == 3 || out->count == 4 || out->count == 5 || out->count == 6 ||
        out->count == 7 || out->count == 8 || out->count == 9 || out->count == 10 ||
        out->count == 11 || out->count == 12 || out->count == 13 || out->count == 14 ||
        out->count == 15 || out->count >= 16; */
roburoc4_result roburoc4_decode_telemeter_properties(const uint8_t *data, size_t size,
                                                     roburoc4_telemeter_list *out);

#define LONGEST 65507
/* Eva does not relate a view's end to the datagram's: WP does, in wp/cursor.c. */
#define SLACK 8

static roburoc4_client client;
static uint8_t memory[LONGEST + SLACK];

static float any_float(void) {
    float value;
    Frama_C_make_unknown((char *)&value, sizeof value);
    return value;
}

/* ---- the invariant, as states to begin with ---- */

static void any_client(void) {
    Frama_C_make_unknown((char *)&client, sizeof client);
    for (uint32_t i = 0; i < ROBUROC4_ROLE_COUNT; i++) {
        client.private_config.role_index[i] =
            Frama_C_short_interval(-1, (short)(roburoc4_role_capacity(i) - 1));
        client.private_discovery.role_texts[i] = Frama_C_short_interval(ROLE_TEXT_AMBIGUOUS, 63);
    }
    client.private_discovery.service_count = (uint8_t)up_to(ROBUROC4_MAX_SERVICES);
    client.private_discovery.listed = (uint8_t)(4 * up_to(31));
    client.private_discovery.described_kind = (uint8_t)up_to(LIST_DIRECTORY + 1);
    client.private_discovery.probe_kind = (uint8_t)up_to(ROBUROC4_SERVICE_COUNT - 1);
    client.private_values.telemeter_count = (uint8_t)up_to(ROBUROC4_MAX_TELEMETERS);
    client.private_values.distance_count = (uint8_t)up_to(ROBUROC4_MAX_TELEMETERS);
    for (uint32_t i = 0; i < 4; i++) {
        client.private_values.io_counts[i] = (int32_t)up_to(INT32_MAX);
    }
    client.private_state = up_to(ROBUROC4_STATE_CLOSING);
    client.private_outputs.repeats = 0;
}

static void any_running_client(void) {
    any_client();
    client.private_state = 1 + up_to(ROBUROC4_STATE_CLOSING - 1);
    for (uint32_t i = ROBUROC4_SERVICE_IOCARD; i < ROBUROC4_SERVICE_COUNT; i++) {
        client.private_config.period_ms[i] = (uint16_t)(10 + up_to(2540));
    }
    for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
        roburoc4_private_service *s = &client.private_link.services[i];
        s->asked_cycles = (uint8_t)(1 + up_to(254));
        s->period_cycles = (uint16_t)(1 + up_to(UINT16_MAX - 1));
        s->gap_min = (uint16_t)(1 + up_to(UINT16_MAX - 1));
    }
}

/** A running client that has outputs to send. */
static void any_client_with_outputs(void) {
    any_running_client();
    client.private_state = ROBUROC4_STATE_READY;
    client.private_outputs.repeats = (uint8_t)(1 + up_to(2));
    client.private_values.io_counts[ROBUROC4_IO_ANALOG_OUTPUT] =
        (int32_t)up_to(ROBUROC4_MAX_ANALOG_OUTPUTS);
    client.private_values.io_counts[ROBUROC4_IO_DIGITAL_OUTPUT] =
        (int32_t)up_to(ROBUROC4_MAX_DIGITAL_OUTPUTS);
}

/* ---- the invariant, as what must hold afterwards ---- */

static void check_client(void) {
    const roburoc4_private_discovery *d = &client.private_discovery;
    const roburoc4_private_values *v = &client.private_values;
    for (uint32_t i = 0; i < ROBUROC4_ROLE_COUNT; i++) {
        /*@ assert role_index: -1 <= client.private_config.role_index[i] <= (i == 3 ? 31 : 63); */
        /*@ assert role_text: -2 <= d->role_texts[i] <= 63; */
    }
    /*@ assert services: d->service_count <= 32; */
    /*@ assert listed: d->listed % 4 == 0 && d->listed <= 0x7C; */
    /*@ assert described: d->described_kind <= 5; */
    /*@ assert probe: d->probe_kind <= 6; */
    /*@ assert telemeters: v->telemeter_count <= 16 && v->distance_count <= 16; */
    for (uint32_t i = 0; i < 4; i++) {
        /*@ assert io_count: v->io_counts[i] >= 0; */
    }
    /*@ assert state: client.private_state <= 6; */
    if (client.private_state != ROBUROC4_STATE_IDLE) {
        for (uint32_t i = 0; i < STATUS_SERVICES; i++) {
            /*@ assert asked: client.private_link.services[i].asked_cycles >= 1; */
            /*@ assert period: client.private_link.services[i].period_cycles >= 1; */
            /*@ assert gap: client.private_link.services[i].gap_min >= 1; */
        }
    }
    if (client.private_outputs.repeats != 0) {
        /*@ assert outputs_while_ready: client.private_state == 4; */
        /*@ assert outputs: client.private_outputs.repeats <= 3 && v->io_counts[1] <= 16 &&
            v->io_counts[3] <= 64; */
    }
}

/* ---- one call each ---- */

static void receive(void) {
    Frama_C_make_unknown((char *)memory, sizeof memory);
    roburoc4_client_receive(&client, memory, Frama_C_size_t_interval(0, LONGEST), any_u64());
    check_client();
}

void main_client_receive(void) {
    any_running_client();
    receive();
}

void main_client_receive_outputs(void) {
    any_client_with_outputs();
    //@ dynamic_split client.private_outputs.repeats;
    receive();
}

/* ---- who holds [A] drives: nobody is armed where the client knows of an override ---- */

/** A client that keeps this promise. */
static void any_client_that_yields(void) {
    roburoc4_private_values *v = &client.private_values;
    any_running_client();
    switch (up_to(2)) {
    case 0:
        client.private_drive.armed = 0;
        v->override_known = 1;
        v->overridden = 1;
        break;
    case 1:
        client.private_drive.armed = Frama_C_nondet(0, 1);
        v->override_known = 1;
        v->overridden = 0;
        break;
    default:
        client.private_drive.armed = Frama_C_nondet(0, 1);
        v->override_known = 0;
        v->overridden = Frama_C_nondet(0, 1);
        break;
    }
    //@ dynamic_split client.private_drive.armed;
    //@ dynamic_split client.private_values.override_known;
    //@ dynamic_split client.private_values.overridden;
}

static void check_yields(void) {
    const roburoc4_private_values *v = &client.private_values;
    if (v->override_known != 0 && v->overridden != 0) {
        /*@ assert yields: client.private_drive.armed == 0; */
    }
    /*@ assert yes_or_no: v->override_known <= 1 && v->overridden <= 1; */
}

/** A status of another service than the IO card. Of the card's own Eva does not see that the client
 *  is disarmed before the call ends; that is tested and walked. */
void main_client_receive_others(void) {
    static uint8_t datagram[64];
    any_client_that_yields();
    client.private_discovery.service_ids[ROBUROC4_SERVICE_IOCARD] = 0;
    Frama_C_make_unknown((char *)datagram, sizeof datagram);
    datagram[0] = ROBUROC4_HEADER_STATUS;
    datagram[1] = 2;
    datagram[2] = 0;
    roburoc4_client_receive(&client, datagram, sizeof datagram, any_u64());
    check_yields();
}

void main_client_transmit_override(void) {
    uint8_t buffer[ROBUROC4_MAX_TRANSMIT];
    any_client_that_yields();
    roburoc4_client_poll_transmit(&client, buffer, sizeof buffer, any_u64());
    check_yields();
}

/** Whether bytes are there is checked before they are looked at, also outside of the codec: the
 * byte after these datagrams is no object's. */
static void receive_short(size_t size) {
    Frama_C_make_unknown((char *)memory, sizeof memory);
    //@ split size;
    roburoc4_client_receive(&client, memory + (sizeof memory - size), size, any_u64());
    check_client();
}

void main_client_receive_short(void) {
    any_running_client();
    receive_short(up_to(10));
}

/** Statuses of up to two bytes after the head; Eva takes each count of channels that decides how
 *  many bytes there must be by itself. */
void main_client_receive_status(void) {
    int32_t *counts = client.private_values.io_counts;
    const uint32_t blocks = up_to(3);
    any_running_client();
    counts[ROBUROC4_IO_ANALOG_INPUT] =
        Frama_C_nondet(0, 1) ? 0 : (int32_t)(1 + up_to(INT32_MAX - 1));
    //@ split blocks;
    counts[ROBUROC4_IO_DIGITAL_INPUT] = blocks == 0   ? 0
                                        : blocks == 3 ? (int32_t)(17 + up_to(INT32_MAX - 17))
                                                      : (int32_t)(8 * blocks - up_to(7));
    receive_short(11 + up_to(2));
}

static void transmit(void) {
    uint8_t buffer[ROBUROC4_MAX_TRANSMIT];
    roburoc4_client_poll_transmit(&client, buffer, sizeof buffer, any_u64());
    check_client();
}

void main_client_transmit(void) {
    any_running_client();
    transmit();
}

void main_client_transmit_outputs(void) {
    any_client_with_outputs();
    //@ dynamic_split client.private_state;
    //@ dynamic_split client.private_outputs.repeats;
    transmit();
}

/* ---- what a user asks for: in any state, also before start() ---- */

static void ask(void) {
    const uint64_t now_us = any_u64();
    switch (up_to(11)) {
    case 0:
        roburoc4_client_arm(&client, now_us);
        break;
    case 1:
        roburoc4_client_disarm(&client, now_us);
        break;
    case 2:
        roburoc4_client_drive(&client, any_float(), any_float(), any_u32(), now_us);
        break;
    case 3:
        roburoc4_client_stop(&client, now_us);
        break;
    case 4:
        roburoc4_client_set_role_index(&client, any_u32(), (int32_t)any_u32(), now_us);
        break;
    case 5:
        roburoc4_client_relocalize(&client, any_float(), any_float(), any_float(), now_us);
        break;
    case 6:
        roburoc4_client_subscribe(&client, any_u32(), any_u32(), now_us);
        break;
    case 7:
        roburoc4_client_unsubscribe(&client, any_u32(), now_us);
        break;
    case 8:
        roburoc4_client_take_events(&client);
        break;
    default:
        roburoc4_client_close(&client, now_us);
        break;
    }
    check_client();
}

void main_client_ask_idle(void) {
    any_client();
    client.private_state = ROBUROC4_STATE_IDLE;
    ask();
}

void main_client_ask(void) {
    any_running_client();
    ask();
}

void main_client_ask_outputs(void) {
    any_client_with_outputs();
    //@ dynamic_split client.private_outputs.repeats;
    ask();
}

/** Setting outputs is what makes `repeats`; it looks at the counts of the card by itself. */
void main_client_outputs(void) {
    any_running_client();
    client.private_state = up_to(ROBUROC4_STATE_CLOSING);
    //@ dynamic_split client.private_outputs.repeats;
    //@ dynamic_split client.private_state;
    switch (up_to(2)) {
    case 0:
        roburoc4_client_set_digital_output(&client, any_u32(), (int32_t)any_u32(), any_u64());
        break;
    case 1:
        roburoc4_client_set_digital_outputs(&client, any_u64(), any_u64(), any_u64());
        break;
    default:
        roburoc4_client_set_analog_output(&client, any_u32(), any_float(), any_u64());
        break;
    }
    check_client();
}

/* ---- beginning ---- */

/** From any memory and any configuration that init() does not refuse. */
void main_client_start(void) {
    roburoc4_config config;
    Frama_C_make_unknown((char *)&client, sizeof client);
    Frama_C_make_unknown((char *)&config, sizeof config);
    if (roburoc4_client_init(&client, sizeof client, Frama_C_nondet(0, 1) ? NULL : &config) < 0) {
        /*@ assert idle: client.private_state == 0; */
        return;
    }
    check_client();
    roburoc4_client_start(&client, any_u64());
    check_client();
}

/** Started again after close(). */
void main_client_start_again(void) {
    any_running_client();
    client.private_state = ROBUROC4_STATE_IDLE;
    roburoc4_client_start(&client, any_u64());
    check_client();
}

/* ---- what a user reads: in any state ---- */

static volatile uint64_t sink;

void main_client_report(void) {
    union {
        roburoc4_directory_entry entry;
        roburoc4_iocard_properties iocard;
        roburoc4_battery_properties battery;
        roburoc4_localization_properties localization;
        roburoc4_differential_properties differential;
        roburoc4_telemeter telemeter;
        roburoc4_battery_status battery_status;
        roburoc4_localization_status localization_status;
        roburoc4_differential_status differential_status;
        roburoc4_inputs inputs;
        roburoc4_distances distances;
        roburoc4_facts facts;
        roburoc4_link link;
        roburoc4_service_link service_link;
        roburoc4_description description;
    } out;
    uint64_t host_us;
    uint64_t *when = Frama_C_nondet(0, 1) ? NULL : &host_us;
    any_client();
    Frama_C_make_unknown((char *)&out, sizeof out);
    Frama_C_make_unknown((char *)memory, sizeof memory);
    sink = roburoc4_client_service_count(&client) + roburoc4_client_state(&client) +
           roburoc4_client_telemeter_count(&client);
    sink = roburoc4_client_next_deadline(&client);
    sink = roburoc4_client_count(&client, any_u32());
    roburoc4_client_service_at(&client, any_u32(), &out.entry);
    roburoc4_client_service_id(&client, any_u32());
    roburoc4_client_role_index(&client, any_u32());
    roburoc4_client_iocard_properties(&client, &out.iocard);
    roburoc4_client_battery_properties(&client, &out.battery);
    roburoc4_client_localization_properties(&client, &out.localization);
    roburoc4_client_differential_properties(&client, &out.differential);
    roburoc4_client_telemeter(&client, any_u32(), &out.telemeter);
    roburoc4_client_battery(&client, &out.battery_status, when);
    roburoc4_client_localization(&client, &out.localization_status, when);
    roburoc4_client_differential(&client, &out.differential_status, when);
    roburoc4_client_inputs(&client, &out.inputs, when);
    roburoc4_client_distances(&client, &out.distances, when);
    roburoc4_client_facts(&client, any_u64(), &out.facts);
    roburoc4_client_link(&client, any_u64(), &out.link);
    roburoc4_client_service_link(&client, any_u32(), any_u64(), &out.service_link);
    roburoc4_client_host_time(&client, any_u64(), &host_us);
    roburoc4_client_description(&client, memory, Frama_C_size_t_interval(0, LONGEST),
                                &out.description);
}
