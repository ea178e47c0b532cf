/* SPDX-License-Identifier: MIT
 *
 * The vectors of ../../support/vector_rows.h on the target: decoded, field by field, and encoded again from
 * numbers, so that two mistakes of byte order cannot cancel each other.
 */
#include <string.h>

#include "check.h"
#include "../../support/telegrams.h"
#include "roburoc4.h"

#define PART "vectors.c"

static const struct {
    const char *name, *hex;
} rows[] = {
#define VECTOR(name, section, values, hex) {name, hex},
#include "../../support/vector_rows.h"
#undef VECTOR
};
#define ROWS (sizeof rows / sizeof rows[0])

static uint8_t wire[80], made[80];
static size_t wire_size;
static uint8_t row_used[ROWS];

static uint8_t digit(char c) {
    return (uint8_t)(c <= '9' ? c - '0' : c - 'A' + 10);
}

/** The bytes of the vector with this name, into `wire`. */
static void load(const char *name) {
    size_t row = 0;
    const char *hex;
    wire_size = 0;
    while (row < ROWS && strcmp(rows[row].name, name) != 0) {
        row++;
    }
    CHECK(row < ROWS);
    if (row == ROWS) {
        return;
    }
    row_used[row] = 1;
    for (hex = rows[row].hex; *hex != '\0' && wire_size < sizeof wire; hex++) {
        if (*hex != ' ') {
            wire[wire_size++] = (uint8_t)(digit(hex[0]) << 4 | digit(hex[1]));
            hex++;
        }
    }
}

/** Whether `size` bytes of `made` are the vector, and nothing is written where one byte is missing.
 */
static int same(roburoc4_result size) {
    return size == (roburoc4_result)wire_size && memcmp(wire, made, wire_size) == 0;
}

#define ENCODED(call) (memset(made, 0xEE, sizeof made), same(call))
#define MADE made, sizeof made
#define WIRE wire, wire_size

/* ------------------------------------------------------------------------------ requests --- */

static void test_query(const char *name, uint8_t id, uint8_t io_type, int32_t index) {
    roburoc4_request r;
    load(name);
    CHECK(roburoc4_decode_request(WIRE, &r) == 0);
    CHECK(r.id == id && r.action == ROBUROC4_ACTION_QUERY && r.service == 2);
    CHECK(r.io_type == io_type && r.index == index);
    CHECK(ENCODED(encode_query_iocard(MADE, id, 2, io_type, index)));
}

static void test_requests(void) {
    roburoc4_request r;
    load("get");
    CHECK(roburoc4_decode_request(WIRE, &r) == 0);
    CHECK(r.id == 1 && r.action == ROBUROC4_ACTION_GET && r.service == 6);
    CHECK(ENCODED(encode_get(MADE, 1, 6)));
    load("query-directory");
    CHECK(roburoc4_decode_request(WIRE, &r) == 0);
    CHECK(r.id == 42 && r.action == ROBUROC4_ACTION_QUERY && r.service == 0 && r.index == 3);
    CHECK(ENCODED(encode_query_directory(MADE, 42, 3)));
    test_query("query-analog-input", 43, ROBUROC4_IO_ANALOG_INPUT, 8);
    test_query("query-analog-output", 44, ROBUROC4_IO_ANALOG_OUTPUT, 1);
    test_query("query-digital-input", 45, ROBUROC4_IO_DIGITAL_INPUT, 8);
    test_query("query-digital-output", 46, ROBUROC4_IO_DIGITAL_OUTPUT, 7);
    load("insert");
    CHECK(roburoc4_decode_request(WIRE, &r) == 0);
    CHECK(r.id == 47 && r.action == ROBUROC4_ACTION_INSERT && r.service == 1);
    CHECK(r.subject == 6 && r.period_cycles == 5);
    CHECK(ENCODED(encode_insert(MADE, 47, 6, 5)));
    load("delete");
    CHECK(roburoc4_decode_request(WIRE, &r) == 0);
    CHECK(r.id == 48 && r.action == ROBUROC4_ACTION_DELETE && r.subject == 6);
    CHECK(ENCODED(encode_delete(MADE, 48, 6)));
    load("replace-localization");
    CHECK(roburoc4_decode_request(WIRE, &r) == 0);
    CHECK(r.id == 49 && r.action == ROBUROC4_ACTION_REPLACE && r.service == 5);
    CHECK(r.timestamp == 12345 && r.x_m == 10 && r.y_m == -4.5 && r.theta_rad == 1.5);
    CHECK(ENCODED(encode_replace_localization(MADE, 49, 5, 12345, 10, -4.5, 1.5)));
}

/* ------------------------------------------------------------------------------- answers --- */

/** For numbers that binary floats only come near to: some targets compute with more than a float
 *  has, but a parameter is one. */
static int is_float(float got, float wanted) {
    return memcmp(&got, &wanted, sizeof got) == 0;
}

static void test_lists(void) {
    static const roburoc4_directory_entry entries[] = {
        {0, 0}, {0, 1}, {0x4001, 2}, {0x4008, 3}, {0, 4}, {0x8002, 5}, {0x4005, 6}};
    static const roburoc4_subscription subscriptions[] = {{6, 5, 0}, {2, 10, 0}, {4, 100, 0}};
    roburoc4_directory directory;
    roburoc4_notification notification;
    uint32_t i;
    load("directory");
    CHECK(roburoc4_decode_directory(WIRE, &directory) == 0);
    CHECK(directory.service == 0 && directory.count == 7);
    for (i = 0; i < 7; i++) {
        roburoc4_directory_entry entry;
        CHECK(roburoc4_directory_at(&directory, i, &entry) == 0);
        CHECK(entry.type == entries[i].type && entry.id == entries[i].id);
    }
    CHECK(ENCODED(roburoc4_encode_directory(MADE, 1, 0, entries, 7)));
    load("notification");
    CHECK(roburoc4_decode_notification(WIRE, &notification) == 0);
    CHECK(notification.service == 1 && notification.count == 3);
    for (i = 0; i < 3; i++) {
        roburoc4_subscription entry;
        CHECK(roburoc4_notification_at(&notification, i, &entry) == 0);
        CHECK(entry.service == subscriptions[i].service);
        CHECK(entry.period_cycles == subscriptions[i].period_cycles);
    }
    CHECK(ENCODED(roburoc4_encode_notification(MADE, 1, 1, subscriptions, 3)));
}

static void test_telemeter_properties(void) {
    static const roburoc4_telemeter telemeters[] = {
        {0.625f, 0, 0, 0.5f, 0.25f, 4, 1.5f},
        {-0.625f, 0.125f, 3.14159265f, 0.75f, 0.1875f, 3.5f, 2.25f}};
    roburoc4_telemeter_list list;
    uint32_t i;
    load("telemeter-properties");
    CHECK(roburoc4_decode_telemeter_properties(WIRE, &list) == 0);
    CHECK(list.service == 3 && list.count == 2);
    for (i = 0; i < 2; i++) {
        roburoc4_telemeter got;
        CHECK(roburoc4_telemeter_at(&list, i, &got) == 0);
        CHECK(memcmp(&got, &telemeters[i], sizeof got) == 0); /* floats only, no padding */
    }
    CHECK(ENCODED(roburoc4_encode_telemeter_properties(MADE, 1, 3, telemeters, 2)));
}

static void test_small_properties(void) {
    roburoc4_iocard_properties iocard;
    roburoc4_battery_properties battery;
    roburoc4_localization_properties localization;
    load("iocard-properties");
    CHECK(roburoc4_decode_iocard_properties(WIRE, &iocard) == 0);
    CHECK(iocard.service == 2 && iocard.analog_inputs == 9 && iocard.analog_outputs == 0);
    CHECK(iocard.digital_inputs == 22 && iocard.digital_outputs == 8);
    CHECK(ENCODED(roburoc4_encode_iocard_properties(MADE, 1, &iocard)));
    load("battery-properties");
    CHECK(roburoc4_decode_battery_properties(WIRE, &battery) == 0);
    CHECK(battery.service == 4 && battery.nominal_voltage_v == 24 && battery.capacity_ah == 40);
    CHECK(battery.minimum_percent == 20);
    CHECK(ENCODED(roburoc4_encode_battery_properties(MADE, 1, &battery)));
    load("localization-properties");
    CHECK(roburoc4_decode_localization_properties(WIRE, &localization) == 0);
    CHECK(localization.service == 5 && localization.flags == 0x12);
    CHECK(localization.x_m == 1.5 && localization.y_m == -2.25 && localization.theta_rad == 0.5);
    CHECK(ENCODED(roburoc4_encode_localization_properties(MADE, 1, &localization)));
}

static void test_differential_properties(void) {
    roburoc4_differential_properties d;
    load("differential-properties");
    CHECK(roburoc4_decode_differential_properties(WIRE, &d) == 0);
    CHECK(d.service == 6 && d.target_linear_m_s == 0.5f && d.target_angular_rad_s == -0.25f);
    CHECK(d.current_linear_m_s == 0.4375f && d.current_angular_rad_s == -0.125f);
    CHECK(is_float(d.max_linear_m_s, 2.6f) && is_float(d.min_linear_m_s, -1.3f));
    CHECK(d.max_angular_rad_s == 6.5f && d.min_angular_rad_s == -3.25f);
    CHECK(d.max_linear_m_s2 == 2 && d.min_linear_m_s2 == -3);
    CHECK(d.max_angular_rad_s2 == 8 && d.min_angular_rad_s2 == -10 && is_float(d.width_m, 0.68f));
    CHECK(ENCODED(roburoc4_encode_differential_properties(MADE, 1, &d)));
}

static void test_text(const char *name, uint8_t id, uint16_t service, const char *text) {
    roburoc4_text t;
    const size_t length = strlen(text);
    load(name);
    CHECK(roburoc4_decode_text(WIRE, &t) == 0);
    CHECK(t.service == service && t.length == length && memcmp(t.text, text, length) == 0);
    CHECK(ENCODED(roburoc4_encode_text(MADE, id, service, text, length)));
}

static void test_answer(const char *name, uint8_t id, uint8_t action, uint16_t service,
                        uint8_t error) {
    roburoc4_answer a;
    load(name);
    CHECK(roburoc4_decode_answer(WIRE, &a) == 0);
    CHECK(a.id == id && a.action == action && a.service == service && a.error == error);
    CHECK(a.payload_size == 0);
    CHECK(ENCODED(roburoc4_encode_answer(MADE, id, action, service, error)));
}

static void test_other_answers(void) {
    test_text("text-directory", 42, 0, "Differential");
    test_text("text-iocard", 45, 2, "Game pad \"A\" button");
    test_answer("insert-answer", 47, ROBUROC4_ACTION_INSERT, 1, 0);
    test_answer("delete-answer", 48, ROBUROC4_ACTION_DELETE, 1, 0);
    test_answer("replace-answer", 49, ROBUROC4_ACTION_REPLACE, 5, 0);
    test_answer("error-answer", 50, ROBUROC4_ACTION_INSERT, 1, ROBUROC4_ERROR_UNSUPPORTED);
    test_answer("error-telegram", 0, ROBUROC4_ACTION_GET, 9, ROBUROC4_ERROR_TARGET);
}

/* -------------------------------------------------------------------- statuses, commands --- */

static void test_iocard_status(void) {
    static const float analog[9] = {0.75f, 1.25f, 25.5f, -1, -0.5f, 0, 0.5f, 1, -0.25f};
    static const uint8_t digital[3] = {0x01, 0x01, 0x20};
    roburoc4_channels s;
    uint32_t i;
    load("iocard-status");
    CHECK(roburoc4_decode_iocard_status(WIRE, 9, 22, &s) == 0);
    CHECK(s.service == 2 && s.robot_cycles == 360000);
    for (i = 0; i < 9; i++) {
        float value = 99;
        CHECK(analog_at(&s, i, &value) == 0 && value == analog[i]);
    }
    for (i = 0; i < 22; i++) {
        CHECK(digital_at(&s, i) == (i == 0 || i == 8 || i == 21));
    }
    CHECK(ENCODED(roburoc4_encode_iocard_status(MADE, 2, 360000, analog, 9, digital, 22)));
}

static void test_small_statuses(void) {
    static const float distances[] = {1.5f, 2.25f};
    roburoc4_telemeter_status telemeter;
    roburoc4_battery_status battery;
    roburoc4_status_header header;
    uint32_t i;
    load("telemeter-status");
    CHECK(roburoc4_decode_telemeter_status(WIRE, &telemeter) == 0);
    CHECK(telemeter.service == 3 && telemeter.robot_cycles == 360000 && telemeter.count == 2);
    for (i = 0; i < 2; i++) {
        float value = 99;
        CHECK(distance_at(&telemeter, i, &value) == 0 && value == distances[i]);
    }
    CHECK(ENCODED(roburoc4_encode_telemeter_status(MADE, 3, 360000, distances, 2)));
    load("battery-status");
    CHECK(roburoc4_decode_status_header(WIRE, &header) == 2);
    CHECK(header.service == 4 && header.robot_cycles == 360000);
    CHECK(roburoc4_decode_battery_status(WIRE, &battery) == 0);
    CHECK(battery.service == 4 && battery.robot_cycles == 360000);
    CHECK(battery.state == ROBUROC4_BATTERY_OK && battery.remaining_percent == 87);
    CHECK(ENCODED(roburoc4_encode_battery_status(MADE, &battery)));
}

static void test_pose_and_speed_statuses(void) {
    roburoc4_localization_status pose;
    roburoc4_differential_status speed;
    load("localization-status");
    CHECK(roburoc4_decode_localization_status(WIRE, &pose) == 0);
    CHECK(pose.service == 5 && pose.robot_cycles == 360000 && pose.flags == 0x14);
    CHECK(pose.x_m == -3.5 && pose.y_m == 0.125 && pose.theta_rad == -1.75);
    CHECK(ENCODED(roburoc4_encode_localization_status(MADE, &pose)));
    load("differential-status");
    CHECK(roburoc4_decode_differential_status(WIRE, &speed) == 0);
    CHECK(speed.service == 6 && speed.robot_cycles == 360000);
    CHECK(speed.target_linear_m_s == 0.5f && speed.current_linear_m_s == 0.4375f);
    CHECK(speed.target_angular_rad_s == -0.25f && speed.current_angular_rad_s == -0.125f);
    CHECK(ENCODED(roburoc4_encode_differential_status(MADE, &speed)));
}

static void test_commands(void) {
    static const uint8_t outputs[] = {0x82};
    roburoc4_differential_command command;
    roburoc4_channels io;
    uint32_t i;
    load("differential-command");
    CHECK(roburoc4_decode_differential_command(WIRE, &command) == 0);
    CHECK(command.service == 6 && command.linear_m_s == 0.5f && command.angular_rad_s == -0.25f);
    CHECK(ENCODED(roburoc4_encode_differential_command(MADE, 6, 0.5f, -0.25f)));
    load("iocard-command");
    CHECK(roburoc4_decode_iocard_command(WIRE, 0, 8, &io) == 0);
    CHECK(io.service == 2 && io.analog_count == 0 && io.digital_count == 8);
    for (i = 0; i < 8; i++) {
        CHECK(digital_at(&io, i) == (i == 1 || i == 7));
    }
    CHECK(ENCODED(roburoc4_encode_iocard_command(MADE, 2, NULL, 0, outputs, 8)));
}

/* ------------------------------------------------------------------------------- lengths --- */

/** Every vector, cut short anywhere and followed by anything, leaves the client alive and idle. */
static void test_every_length_is_survived(void) {
    static roburoc4_client client;
    size_t row, size;
    CHECK(roburoc4_client_init(&client, sizeof client, NULL) == 0);
    CHECK(roburoc4_client_start(&client, 1) == 0);
    for (row = 0; row < ROWS; row++) {
        load(rows[row].name);
        for (size = 0; size <= wire_size; size++) {
            CHECK(roburoc4_client_receive(&client, wire, size, 2) < 0);
        }
    }
    CHECK(roburoc4_client_state(&client) == ROBUROC4_STATE_CONNECTING);
}

void test_vectors(void) {
    size_t row;
    test_requests();
    test_lists();
    test_telemeter_properties();
    test_small_properties();
    test_differential_properties();
    test_other_answers();
    test_iocard_status();
    test_small_statuses();
    test_pose_and_speed_statuses();
    test_commands();
    for (row = 0; row < ROWS; row++) {
        CHECK(row_used[row] == 1); /* no vector is forgotten */
    }
    test_every_length_is_survived();
}
