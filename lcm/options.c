/* SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "options.h"

#include <getopt.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_CHANNEL_OPTIONS 64
/* Statuses that are older than this do not count for driving (roburoc4_config.fresh_ms). */
#define SLOWEST_DRIVING_MS 250u
#define MAX_AGE_LIMIT_MS 3600000u

const char options_help[] =
    "Usage: roburoc4-lcm [OPTION]...\n"
    "Put RobuROC4 robots on an LCM network: every status is published as it arrives, and commands\n"
    "are obeyed where that is enabled.\n"
    "\n"
    "  -r, --robot [NAME=]HOST[:PORT]  the robot (default 192.168.0.2:60000). With NAME its\n"
    "                       channels are NAME_DIFFERENTIAL and so on, and the option may be\n"
    "                       given up to 32 times\n"
    "  -l, --lcm-url URL    the LCM network (default: LCM's own, see LCM_DEFAULT_URL), such as\n"
    "                       'udpm://239.255.76.67:7667?ttl=0' for this machine only; LCM's tcpq\n"
    "                       and file are refused: they can hang the bridge, or drive from a log\n"
    "  -p, --prefix PREFIX  of a robot's channels that has no NAME (default ROBUROC4)\n"
    "      --channel [NAME:]KEY=CHANNEL  another name for one channel; KEY is DIFFERENTIAL,\n"
    "                       LOCALIZATION, BATTERY, TELEMETER, IOCARD, PROPERTIES,\n"
    "                       BRIDGE_STATUS, DRIVE_CMD, RELOCALIZE_CMD or OUTPUT_CMD; the last\n"
    "                       three must go on ending in _CMD\n"
    "      --pose-channel [NAME:]CHANNEL  also publish each localization as bot_core.pose_t\n"
    "      --period SERVICE=MS  time between statuses, 10 to 2550 in steps of 10, or 0 for none;\n"
    "                       SERVICE is iocard, telemeter, battery, localization or differential\n"
    "\n"
    "Commands; without these the bridge only watches:\n"
    "      --enable-drive       obey PREFIX_DRIVE_CMD: THE ROBOT CAN MOVE. Statuses of iocard and\n"
    "                           differential must come at least every 250 ms\n"
    "      --enable-outputs     obey PREFIX_OUTPUT_CMD\n"
    "      --enable-relocalize  obey PREFIX_RELOCALIZE_CMD\n"
    "      --command-timeout MS longest lease of a command, and that of one without its own\n"
    "                       (20 to 1000; default 300)\n"
    "      --max-age MS     oldest command that is obeyed, by its utime (default 200; at most\n"
    "                       3600000). 0 obeys all ages, for clocks that cannot be set; then a\n"
    "                       replayed log can move the robot\n"
    "\n"
    "  -v, --verbose        tell more: each rejected command\n"
    "  -q, --quiet          tell errors only\n"
    "  -h, --help           print this and exit\n"
    "      --version        print the version and exit\n"
    "\n"
    "SIGINT, SIGTERM and SIGHUP stop the robot and end the bridge. Exit status: 0 ended on\n"
    "request, 1 error, 2 bad usage, 3 no LCM network.\n";

/* What was read and can only be judged once all is read. */
typedef struct reading {
    options *out;
    const char *prefix;
    const char *robots[OPTIONS_MAX_ROBOTS];
    const char *channels[MAX_CHANNEL_OPTIONS];
    const char *poses[OPTIONS_MAX_ROBOTS];
    uint32_t robot_count, channel_count, pose_count;
    char *error;
    size_t error_size;
} reading;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
/* Say what is wrong; always false. */
static bool
complain(reading *reading, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(reading->error, reading->error_size, format, arguments);
    va_end(arguments);
    return false;
}

/* --------------------------------------------------------------------------- option values --- */

/* A number of at most `max` at *text, which is moved behind it. */
static bool number(const char **text, uint32_t max, uint32_t *out) {
    uint32_t value = 0;
    size_t length = strspn(*text, "0123456789");
    if (length == 0 || length > 9) {
        return false;
    }
    for (size_t at = 0; at < length; at++) {
        value = value * 10 + (uint32_t)((*text)[at] - '0');
    }
    *text += length;
    *out = value;
    return value <= max;
}

static bool whole(const char *text, uint32_t min, uint32_t max, uint32_t *out) {
    return number(&text, max, out) && *text == '\0' && *out >= min;
}

static bool keep(reading *reading, const char **list, uint32_t *count, uint32_t capacity,
                 const char *option, const char *value) {
    if (*count == capacity) {
        return complain(reading, "%s %s: at most %u of these; start another bridge", option, value,
                        (unsigned)capacity);
    }
    list[(*count)++] = value;
    return true;
}

static bool set_period(reading *reading, const char *value) {
    static const char *const services[] = {"iocard", "telemeter", "battery", "localization",
                                           "differential"};
    uint32_t period_ms = 0;
    size_t length = strcspn(value, "=");
    for (uint32_t at = 0; at < sizeof services / sizeof services[0]; at++) {
        uint32_t service = ROBUROC4_SERVICE_IOCARD + at;
        if (strlen(services[at]) != length || strncmp(services[at], value, length) != 0) {
            continue;
        }
        if (value[length] == '\0' || !whole(value + length + 1, 0, 2550, &period_ms) ||
            period_ms % 10 != 0) {
            break;
        }
        if (period_ms == 0) {
            reading->out->config.subscriptions &= ~(1u << service);
        } else {
            reading->out->config.subscriptions |= 1u << service;
            reading->out->config.period_ms[service] = (uint16_t)period_ms;
        }
        return true;
    }
    return complain(reading,
                    "--period %s: give SERVICE=MS; SERVICE is iocard, telemeter, battery, "
                    "localization or differential, MS is 0 or 10 to 2550 in steps of 10",
                    value);
}

static bool set_command_timeout(reading *reading, const char *value) {
    uint32_t ms = 0;
    if (!whole(value, GATE_MIN_LEASE_US / 1000u, GATE_MAX_LEASE_US / 1000u, &ms)) {
        return complain(reading, "--command-timeout %s: give milliseconds, 20 to 1000", value);
    }
    reading->out->rules.command_timeout_us = ms * 1000u;
    return true;
}

static bool set_max_age(reading *reading, const char *value) {
    uint32_t ms = 0;
    if (!whole(value, 0, MAX_AGE_LIMIT_MS, &ms)) {
        return complain(reading, "--max-age %s: give milliseconds, 0 (off) to 3600000", value);
    }
    reading->out->rules.max_age_us = (uint32_t)(ms * 1000u);
    return true;
}

/* ----------------------------------------------------------------------------- the network --- */

const char *options_lcm_url(const options *options, const char **source) {
    const char *url = options->lcm_url;
    *source = "--lcm-url";
    if (url == NULL || url[0] == '\0') { /* as LCM does */
        *source = "LCM_DEFAULT_URL";
        url = getenv(*source);
    }
    return url != NULL ? url : "";
}

/* ADDRESS or ADDRESS:PORT of a multicast group, or nothing, up to the URL's end or '?'. */
static bool is_group(const char *text) {
    uint32_t part = 0;
    if (*text == '\0' || *text == '?') {
        return true;
    }
    for (int at = 0; at < 4; at++) {
        if ((at > 0 && *text++ != '.') || !number(&text, 255, &part) ||
            (at == 0 && (part < 224 || part > 239))) {
            return false;
        }
    }
    if (*text == ':') {
        text++;
        if (!number(&text, 65535, &part) || part == 0) {
            return false;
        }
    }
    return *text == '\0' || *text == '?';
}

/* LCM's other networks, tcpq and file, wait within LCM for others for as long as these like: no
 * zero would leave meanwhile, and no signal would be heard. And a file is a log, which must not
 * drive. */
static bool set_network(reading *reading) {
    static const char udpm[] = "udpm://";
    static const char memq[] = "memq://";
    const char *source = NULL;
    const char *url = options_lcm_url(reading->out, &source);
    if (url[0] == '\0' || strncmp(url, memq, strlen(memq)) == 0 ||
        (strncmp(url, udpm, strlen(udpm)) == 0 && is_group(url + strlen(udpm)))) {
        return true;
    }
    return complain(reading,
                    "%s %s: the bridge has no such LCM network; give udpm://ADDRESS:PORT?ttl=N, "
                    "such as 'udpm://239.255.76.67:7667?ttl=0'",
                    source, url);
}

/* ------------------------------------------------------------------------------ the robots --- */

static bool set_robot(reading *reading, options_robot *robot, const char *value) {
    const char *equals = strchr(value, '=');
    const char *prefix = reading->prefix != NULL ? reading->prefix : "ROBUROC4";
    memset(robot, 0, sizeof *robot);
    robot->host = value;
    if (equals != NULL) {
        size_t length = (size_t)(equals - value);
        if (length >= sizeof robot->name) {
            return complain(reading, "--robot %s: the name is too long; give at most %u letters",
                            value, (unsigned)sizeof robot->name - 1);
        }
        memcpy(robot->name, value, length);
        robot->host = equals + 1;
        prefix = robot->name;
    } else if (reading->robot_count > 1) {
        return complain(reading,
                        "--robot %s: several robots need a name each, such as --robot A=%s", value,
                        value);
    }
    if (!channels_is_name(prefix) || !channels_set_prefix(&robot->channels, prefix)) {
        return complain(reading,
                        "'%s' cannot be the start of a channel's name; give at most 48 letters, "
                        "digits, _, - or /",
                        prefix);
    }
    return true;
}

static bool set_robots(reading *reading) {
    options *out = reading->out;
    if (reading->robot_count == 0) {
        reading->robots[reading->robot_count++] = ROBUROC4_DEFAULT_HOST;
    }
    for (uint32_t at = 0; at < reading->robot_count; at++) {
        if (!set_robot(reading, &out->robots[at], reading->robots[at])) {
            return false;
        }
        if (reading->prefix != NULL && out->robots[at].name[0] != '\0') {
            return complain(reading,
                            "--prefix %s: a robot with a name has that as its prefix; "
                            "leave out one of them",
                            reading->prefix);
        }
    }
    out->robot_count = reading->robot_count;
    return true;
}

/* ---------------------------------------------------------------------------- the channels --- */

/* The robot that `[NAME:]REST` is about, and REST; NULL (and said why) for none. */
static options_robot *robot_meant(reading *reading, const char *option, const char *value,
                                  const char **rest) {
    options *out = reading->out;
    const char *colon = strchr(value, ':');
    *rest = colon != NULL ? colon + 1 : value;
    if (colon == NULL && out->robot_count == 1) {
        return &out->robots[0];
    }
    for (uint32_t at = 0; colon != NULL && at < out->robot_count; at++) {
        const char *name = out->robots[at].name;
        if (strlen(name) == (size_t)(colon - value) && strncmp(name, value, strlen(name)) == 0) {
            return &out->robots[at];
        }
    }
    (void)complain(reading,
                   colon != NULL ? "%s %s: no --robot has the name before the colon"
                                 : "%s %s: which robot? put its name and a colon before it",
                   option, value);
    return NULL;
}

static bool set_channel(reading *reading, const char *value) {
    const char *rest = NULL;
    options_robot *robot = robot_meant(reading, "--channel", value, &rest);
    if (robot == NULL) {
        return false;
    }
    size_t length = strcspn(rest, "=");
    enum channel channel = channels_find(rest, length);
    if (channel == CHANNELS || rest[length] == '\0' || !channels_is_name(rest + length + 1)) {
        return complain(
            reading,
            "--channel %s: give KEY=CHANNEL, such as LOCALIZATION=ODOMETRY; CHANNEL has "
            "1 to 63 letters, digits, _, - or /",
            value);
    }
    const char *name = rest + length + 1;
    if (channels_ends_in_cmd(name) != channels_is_command(channel)) {
        return complain(reading,
                        "--channel %s: names of commands, and no others, end in _CMD, so that "
                        "they can be left out of logs that are replayed",
                        value);
    }
    memcpy(robot->channels.name[channel], name, strlen(name) + 1);
    return true;
}

static bool set_pose(reading *reading, const char *value) {
    const char *name = NULL;
    options_robot *robot = robot_meant(reading, "--pose-channel", value, &name);
    if (robot == NULL) {
        return false;
    }
    if (!channels_is_name(name) || channels_ends_in_cmd(name)) {
        return complain(reading,
                        "--pose-channel %s: give 1 to 63 letters, digits, _, - or /, not "
                        "ending in _CMD",
                        value);
    }
    memcpy(robot->channels.name[CHANNEL_POSE], name, strlen(name) + 1);
    return true;
}

/* Two of all channels with the same name, or NULL. */
static const char *doubled_channel(const options *out) {
    uint32_t all = out->robot_count * CHANNELS;
    for (uint32_t one = 0; one < all; one++) {
        const char *name = out->robots[one / CHANNELS].channels.name[one % CHANNELS];
        for (uint32_t other = 0; other < one; other++) {
            if (name[0] != '\0' &&
                strcmp(name, out->robots[other / CHANNELS].channels.name[other % CHANNELS]) == 0) {
                return name;
            }
        }
    }
    return NULL;
}

static bool set_channels(reading *reading) {
    for (uint32_t at = 0; at < reading->channel_count; at++) {
        if (!set_channel(reading, reading->channels[at])) {
            return false;
        }
    }
    for (uint32_t at = 0; at < reading->pose_count; at++) {
        if (!set_pose(reading, reading->poses[at])) {
            return false;
        }
    }
    const char *doubled = doubled_channel(reading->out);
    return doubled == NULL ||
           complain(reading, "two channels are named %s: give each its own name", doubled);
}

/* Who drives must know soon whether the robot moves, and whether [A] is held. */
static bool can_drive(reading *reading) {
    const options *out = reading->out;
    static const uint32_t needed[] = {ROBUROC4_SERVICE_IOCARD, ROBUROC4_SERVICE_DIFFERENTIAL};
    for (uint32_t at = 0; out->rules.enabled[GATE_DRIVE] && at < 2; at++) {
        if ((out->config.subscriptions >> needed[at] & 1u) == 0 ||
            out->config.period_ms[needed[at]] > SLOWEST_DRIVING_MS) {
            return complain(reading,
                            "--enable-drive needs statuses of iocard and differential at least "
                            "every %u ms: give a shorter --period",
                            SLOWEST_DRIVING_MS);
        }
    }
    return true;
}

/* ---------------------------------------------------------------------------- command line --- */

enum long_option {
    OPTION_CHANNEL = 256,
    OPTION_POSE,
    OPTION_PERIOD,
    OPTION_DRIVE,
    OPTION_OUTPUTS,
    OPTION_RELOCALIZE,
    OPTION_TIMEOUT,
    OPTION_MAX_AGE,
    OPTION_VERSION
};

static const struct option known[] = {
    {"robot", required_argument, NULL, 'r'},
    {"lcm-url", required_argument, NULL, 'l'},
    {"prefix", required_argument, NULL, 'p'},
    {"channel", required_argument, NULL, OPTION_CHANNEL},
    {"pose-channel", required_argument, NULL, OPTION_POSE},
    {"period", required_argument, NULL, OPTION_PERIOD},
    {"enable-drive", no_argument, NULL, OPTION_DRIVE},
    {"enable-outputs", no_argument, NULL, OPTION_OUTPUTS},
    {"enable-relocalize", no_argument, NULL, OPTION_RELOCALIZE},
    {"command-timeout", required_argument, NULL, OPTION_TIMEOUT},
    {"max-age", required_argument, NULL, OPTION_MAX_AGE},
    {"verbose", no_argument, NULL, 'v'},
    {"quiet", no_argument, NULL, 'q'},
    {"help", no_argument, NULL, 'h'},
    {"version", no_argument, NULL, OPTION_VERSION},
    {NULL, 0, NULL, 0},
};

static const char short_options[] = ":r:l:p:vqh";

/* option: '?' or ':', as getopt_long() returned it; last: the argument before those to come. */
static void complain_of_option(reading *reading, int option, const char *last) {
    bool is_short = optopt > 0 && optopt < 256 && strchr(short_options, optopt) == NULL;
    if (is_short) { /* it may stand within `-vx`, whose end is still to come */
        (void)complain(reading, "unknown option '-%c': see roburoc4-lcm --help", optopt);
    } else {
        (void)complain(reading, "%s '%s': see roburoc4-lcm --help",
                       option == ':' ? "a value is missing after"
                       : optopt == 0 ? "unknown option"
                                     : "no value belongs to",
                       last);
    }
}

static bool set_value(reading *reading, int option, const char *value) {
    switch (option) {
    case 'r':
        return keep(reading, reading->robots, &reading->robot_count, OPTIONS_MAX_ROBOTS, "--robot",
                    value);
    case 'l':
        reading->out->lcm_url = value;
        return true;
    case 'p':
        reading->prefix = value;
        return true;
    case OPTION_CHANNEL:
        return keep(reading, reading->channels, &reading->channel_count, MAX_CHANNEL_OPTIONS,
                    "--channel", value);
    case OPTION_POSE:
        return keep(reading, reading->poses, &reading->pose_count, OPTIONS_MAX_ROBOTS,
                    "--pose-channel", value);
    case OPTION_PERIOD:
        return set_period(reading, value);
    case OPTION_TIMEOUT:
        return set_command_timeout(reading, value);
    default:
        return set_max_age(reading, value);
    }
}

/* Options without a value; false for others. */
static bool set_flag(options *out, int option) {
    switch (option) {
    case OPTION_DRIVE:
        out->rules.enabled[GATE_DRIVE] = true;
        return true;
    case OPTION_OUTPUTS:
        out->rules.enabled[GATE_OUTPUT] = true;
        return true;
    case OPTION_RELOCALIZE:
        out->rules.enabled[GATE_RELOCALIZE] = true;
        return true;
    case 'v':
        out->level = LOG_DETAIL;
        return true;
    case 'q':
        out->level = LOG_ERROR;
        return true;
    default:
        return false;
    }
}

static void set_defaults(options *out) {
    memset(out, 0, sizeof *out);
    out->rules.command_timeout_us = 300000;
    out->rules.max_age_us = 200000;
    out->level = LOG_NOTE;
    (void)roburoc4_config_init(&out->config, sizeof out->config);
}

enum options_result options_read(int count, char **arguments, options *out, char *error,
                                 size_t error_size) {
    reading reading = {.out = out, .error = error, .error_size = error_size};
    set_defaults(out);
    optind = 1;
    opterr = 0;
    for (int option = 0; option != -1;) {
        option = getopt_long(count, arguments, short_options, known, NULL);
        if (option == 'h') {
            return OPTIONS_HELP;
        }
        if (option == OPTION_VERSION) {
            return OPTIONS_VERSION;
        }
        if (option == '?' || option == ':') {
            complain_of_option(&reading, option, arguments[optind - 1]);
            return OPTIONS_BAD;
        }
        if (option != -1 && !set_flag(out, option) && !set_value(&reading, option, optarg)) {
            return OPTIONS_BAD;
        }
    }
    if (optind < count) {
        (void)complain(&reading, "cannot use '%s': see roburoc4-lcm --help", arguments[optind]);
        return OPTIONS_BAD;
    }
    return set_network(&reading) && set_robots(&reading) && set_channels(&reading) &&
                   can_drive(&reading)
               ? OPTIONS_RUN
               : OPTIONS_BAD;
}

/* Another robot before this one that has its address, or NULL: two gates would command one robot,
 * each unaware of the other. */
static const options_robot *doubled_robot(const options *out, uint32_t at) {
    const roburoc4_address *address = &out->robots[at].address;
    for (uint32_t other = 0; other < at; other++) {
        const roburoc4_address *same = &out->robots[other].address;
        if (same->family == address->family && same->port == address->port &&
            same->scope == address->scope && memcmp(same->ip, address->ip, sizeof same->ip) == 0) {
            return &out->robots[other];
        }
    }
    return NULL;
}

enum options_result options_resolve(options *out, char *error, size_t error_size) {
    for (uint32_t at = 0; at < out->robot_count; at++) {
        options_robot *robot = &out->robots[at];
        roburoc4_result result = roburoc4_udp_resolve(robot->host, 0, &robot->address);
        if (result < 0) {
            bool bad = result == ROBUROC4_ERR_ARGUMENT;
            (void)snprintf(error, error_size, "--robot %s: %s", robot->host,
                           bad ? "give HOST or HOST:PORT, with a port of 1 to 65535"
                               : "the name has no address; give the address in numbers, such as "
                                 "192.168.0.2, or mend the name");
            return bad ? OPTIONS_BAD : OPTIONS_NO_ADDRESS;
        }
        const options_robot *doubled = doubled_robot(out, at);
        if (doubled != NULL) {
            (void)snprintf(error, error_size,
                           "--robot %s=%s: %s has this address already; name each robot once",
                           robot->name, robot->host, doubled->name);
            return OPTIONS_BAD;
        }
    }
    return OPTIONS_RUN;
}
