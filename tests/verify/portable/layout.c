/* SPDX-License-Identifier: MIT
 *
 * The structs that callers declare have one layout on every target, where they hold no pointer and
 * no double; and what functions say of sizes and versions is what the header says.
 */
#include <stddef.h>

#include "check.h"
#include "roburoc4.h"

#define PART "layout.c"

static void test_fixed_sizes(void) {
    CHECK(sizeof(roburoc4_client) == 1952);
    CHECK(sizeof(roburoc4_config) == 76);
    CHECK(sizeof(roburoc4_facts) == 44);
    CHECK(sizeof(roburoc4_inputs) == 152);
    CHECK(sizeof(roburoc4_distances) == 80);
    CHECK(sizeof(roburoc4_link) == 32);
    CHECK(sizeof(roburoc4_service_link) == 40);
    CHECK(sizeof(roburoc4_directory_entry) == 4);
    CHECK(sizeof(roburoc4_subscription) == 4);
    CHECK(sizeof(roburoc4_iocard_properties) == 20);
    CHECK(sizeof(roburoc4_telemeter) == 28);
    CHECK(sizeof(roburoc4_battery_properties) == 12);
    CHECK(sizeof(roburoc4_differential_properties) == 56);
    CHECK(sizeof(roburoc4_status_header) == 16);
    CHECK(sizeof(roburoc4_battery_status) == 16);
    CHECK(sizeof(roburoc4_differential_status) == 32);
    CHECK(sizeof(roburoc4_differential_command) == 12);
}

static void test_offsets(void) {
    CHECK(offsetof(roburoc4_client, private_config) == 24);
    CHECK(offsetof(roburoc4_client, private_drive) == 104);
    CHECK(offsetof(roburoc4_client, private_discovery) == 216);
    CHECK(offsetof(roburoc4_client, private_requests) == 472);
    CHECK(offsetof(roburoc4_client, private_counters) == 584);
    CHECK(offsetof(roburoc4_client, private_outputs) == 640);
    CHECK(offsetof(roburoc4_client, private_link) == 760);
    CHECK(offsetof(roburoc4_client, private_values) == 1176);
    CHECK(offsetof(roburoc4_config, period_ms) == 8);
    CHECK(offsetof(roburoc4_config, max_linear_m_s) == 48);
    CHECK(offsetof(roburoc4_config, role_index) == 68);
    CHECK(offsetof(roburoc4_facts, disarm_cause) == 20);
    CHECK(offsetof(roburoc4_facts, linear_m_s) == 36);
    CHECK(offsetof(roburoc4_inputs, analog) == 16);
    CHECK(offsetof(roburoc4_inputs, digital_count) == 148);
    CHECK(offsetof(roburoc4_battery_status, service) == 10);
    CHECK(offsetof(roburoc4_differential_status, service) == 24);
}

static void test_functions(void) {
    roburoc4_config config;
    CHECK(roburoc4_client_size() == sizeof(roburoc4_client));
    CHECK(roburoc4_version() == ROBUROC4_VERSION);
    CHECK(roburoc4_abi_version() == ROBUROC4_ABI_VERSION);
    CHECK(ROBUROC4_VERSION == ((uint32_t)ROBUROC4_VERSION_MAJOR << 16 |
                               (uint32_t)ROBUROC4_VERSION_MINOR << 8 | ROBUROC4_VERSION_PATCH));
    CHECK(sizeof(roburoc4_result) == 4 && (roburoc4_result)-1 < 0);
    CHECK(roburoc4_config_init(&config, sizeof config - 1) == ROBUROC4_ERR_SIZE);
    CHECK(roburoc4_config_init(&config, sizeof config) == ROBUROC4_OK);
    CHECK(config.size == sizeof config);
}

void test_layout(void) {
    test_fixed_sizes();
    test_offsets();
    test_functions();
}
