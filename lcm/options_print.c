/* SPDX-License-Identifier: MIT
 *
 * roburoc4-lcm --check.
 */
#include <stdio.h>
#include <string.h>

#include "options.h"

static void print_channels(const options_robot *robot) {
    channel_names usual;
    const char *prefix = robot->name[0] != '\0' ? robot->name : robot->prefix;
    (void)printf("    stop by %s", robot->channels.name[CHANNEL_STOP_CMD]);
    if (robot->rules.enabled[GATE_DRIVE]) {
        (void)printf(", drive by %s", robot->channels.name[CHANNEL_DRIVE_CMD]);
    }
    (void)printf(", state on %s\n", robot->channels.name[CHANNEL_BRIDGE_STATE]);
    for (uint32_t at = 0; channels_set_prefix(&usual, prefix) && at < CHANNELS; at++) {
        if (strcmp(usual.name[at], robot->channels.name[at]) != 0) {
            (void)printf("    channel %s%s%s\n", robot->channels.name[at],
                         usual.name[at][0] != '\0' ? " instead of " : "", usual.name[at]);
        }
    }
}

static void print_robot(const options_robot *robot) {
    static const char *const kinds[] = {"drive", "relocalize", "outputs"};
    char address[ROBUROC4_ADDRESS_TEXT_SIZE] = "NO ADDRESS";
    bool any = false;
    if (robot->address.family != 0) {
        (void)roburoc4_udp_address_text(&robot->address, address, sizeof address);
    }
    (void)printf("%s: %s (%s)\n    obeys stop", robot->name[0] != '\0' ? robot->name : "robot",
                 address, robot->host);
    for (uint32_t kind = 0; kind < GATE_STOP; kind++) {
        any = any || robot->rules.enabled[kind];
        (void)printf("%s%s", robot->rules.enabled[kind] ? ", " : "",
                     robot->rules.enabled[kind] ? kinds[kind] : "");
    }
    (void)printf(
        "%s; at most %g m/s and %g rad/s; lease at most %u ms, commands at most %u ms old%s\n"
        "    statuses:",
        any ? "" : " only", (double)robot->config.max_linear_m_s,
        (double)robot->config.max_angular_rad_s, (unsigned)robot->rules.lease_us / 1000u,
        (unsigned)robot->rules.max_age_us / 1000u,
        robot->rules.max_age_us == 0 ? " (ANY AGE)" : "");
    for (uint32_t at = 0; at < OPTIONS_SERVICES; at++) {
        uint32_t service = ROBUROC4_SERVICE_IOCARD + at;
        bool wanted = (robot->config.subscriptions >> service & 1u) != 0;
        (void)printf(wanted ? " %s %u ms" : " %s none", options_services[at],
                     (unsigned)robot->config.period_ms[service]);
    }
    (void)printf("\n");
    if (robot->allowed[0] != '\0') {
        (void)printf("    only from senders %s\n", robot->allowed);
    }
    print_channels(robot);
}

void options_print(const options *options) {
    const char *source = NULL;
    const char *url = options_lcm_url(options, &source);
    (void)printf("network: %s\n", url[0] != '\0' ? url : "LCM's default");
    if (options->fleet_stop[0] != '\0') {
        (void)printf("all robots are stopped by %s\n", options->fleet_stop);
    }
    for (uint32_t at = 0; at < options->robot_count; at++) {
        print_robot(&options->robots[at]);
    }
}
