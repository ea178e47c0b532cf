/* SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "options.h"

#include <getopt.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_LIST 64
/* Statuses that are older than this do not count for driving (roburoc4_config.fresh_ms). */
#define SLOWEST_DRIVING_MS 100u

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
    "                       and file are refused: they can block the bridge, or drive from a log\n"
    "  -p, --prefix PREFIX  of a robot's channels that has no NAME (default ROBUROC4)\n"
    "      --channel [NAME:]KEY=CHANNEL  another name for one channel; KEY is DIFFERENTIAL,\n"
    "                       LOCALIZATION, BATTERY, TELEMETER, IOCARD, PROPERTIES,\n"
    "                       BRIDGE_STATE, BRIDGE_STATISTICS, DRIVE_CMD, RELOCALIZE_CMD,\n"
    "                       OUTPUT_CMD or STOP_CMD; names of the _CMDs must end in _CMD\n"
    "      --pose-channel [NAME:]CHANNEL  also publish each localization as bot_core.pose_t\n"
    "      --period SERVICE=MS  time between statuses, 10 to 2550 in steps of 10, or 0 for none;\n"
    "                       SERVICE is iocard, telemeter, battery, localization or differential\n"
    "\n"
    "Commands; without these the bridge only watches, and obeys PREFIX_STOP_CMD:\n"
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
    "  -v, --verbose        log more: each rejected command\n"
    "  -q, --quiet          log errors only\n"
    "  -h, --help           print this and exit\n"
    "      --version        print the version and exit\n"
    "\n"
    "SIGINT, SIGTERM and SIGHUP stop the robot and end the bridge. Exit status: 0 ended on\n"
    "request, 1 error, 2 bad usage, 3 no LCM network.\n";

enum list { LIST_ROBOTS, LIST_CHANNELS, LIST_POSES, LISTS };

/* Values that are kept until all options were read, because they depend on one another. */
typedef struct reading {
    options *out;
    const char *prefix;
    const char *list[LISTS][MAX_LIST];
    uint32_t count[LISTS];
    char *error;
    size_t error_size;
} reading;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
/* Write what is wrong; always false. */
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
    size_t length = strspn(*text, "0123456789");
    if (length == 0 || length > 9) {
        return false;
    }
    *out = (uint32_t)strtoul(*text, NULL, 10);
    *text += length;
    return *out <= max;
}

static bool whole(const char *text, uint32_t min, uint32_t max, uint32_t *out) {
    return number(&text, max, out) && *text == '\0' && *out >= min;
}

/* An option of the command line; `set` gives `which` and the limits their meaning. */
typedef struct known_option {
    const char *name;
    char letter; /* 0: none */
    int has_value;
    bool (*set)(reading *reading, const struct known_option *option, const char *value);
    uint32_t which, min, max;
} known_option;

/* Append to list `which`, which holds `max`. */
static bool set_list(reading *reading, const known_option *option, const char *value) {
    uint32_t *count = &reading->count[option->which];
    if (*count == option->max) {
        return complain(reading, "--%s %s: at most %u of these; start another bridge", option->name,
                        value, (unsigned)option->max);
    }
    reading->list[option->which][(*count)++] = value;
    return true;
}

/* Enable commands of the kind `which`. */
static bool set_enabled(reading *reading, const known_option *option, const char *value) {
    (void)value;
    reading->out->rules.enabled[option->which] = true;
    return true;
}

static bool set_level(reading *reading, const known_option *option, const char *value) {
    (void)value;
    reading->out->level = (enum log_level)option->which;
    return true;
}

static bool set_url(reading *reading, const known_option *option, const char *value) {
    (void)option;
    reading->out->lcm_url = value;
    return true;
}

static bool set_prefix(reading *reading, const known_option *option, const char *value) {
    (void)option;
    reading->prefix = value;
    return true;
}

/* A time of `min` to `max` milliseconds: the longest lease, or (`which` 1) the greatest age. */
static bool set_time(reading *reading, const known_option *option, const char *value) {
    gate_rules *rules = &reading->out->rules;
    uint32_t ms = 0;
    if (!whole(value, option->min, option->max, &ms)) {
        return complain(reading, "--%s %s: give milliseconds, %u to %u", option->name, value,
                        (unsigned)option->min, (unsigned)option->max);
    }
    *(option->which == 1 ? &rules->max_age_us : &rules->command_timeout_us) = ms * 1000u;
    return true;
}

static bool set_period(reading *reading, const known_option *option, const char *value) {
    static const char *const services[] = {"iocard", "telemeter", "battery", "localization",
                                           "differential"};
    roburoc4_config *config = &reading->out->config;
    uint32_t period_ms = 0;
    uint32_t at = 0;
    size_t length = strcspn(value, "=");
    while (at < 5 && (strlen(services[at]) != length || memcmp(services[at], value, length) != 0)) {
        at++;
    }
    if (at == 5 || value[length] == '\0' || !whole(value + length + 1, 0, 2550, &period_ms) ||
        period_ms % 10 != 0) {
        return complain(reading,
                        "--%s %s: give SERVICE=MS; SERVICE is iocard, telemeter, battery, "
                        "localization or differential, MS is 0 or 10 to 2550 in steps of 10",
                        option->name, value);
    }
    uint32_t service = ROBUROC4_SERVICE_IOCARD + at;
    if (period_ms == 0) {
        config->subscriptions &= ~(1u << service);
    } else {
        config->subscriptions |= 1u << service;
        config->period_ms[service] = (uint16_t)period_ms;
    }
    return true;
}

/* Those without a setter end the reading. */
static const known_option known[] = {
    {"robot", 'r', 1, set_list, LIST_ROBOTS, 0, OPTIONS_MAX_ROBOTS},
    {"lcm-url", 'l', 1, set_url, 0, 0, 0},
    {"prefix", 'p', 1, set_prefix, 0, 0, 0},
    {"channel", 0, 1, set_list, LIST_CHANNELS, 0, MAX_LIST},
    {"pose-channel", 0, 1, set_list, LIST_POSES, 0, OPTIONS_MAX_ROBOTS},
    {"period", 0, 1, set_period, 0, 0, 0},
    {"enable-drive", 0, 0, set_enabled, GATE_DRIVE, 0, 0},
    {"enable-outputs", 0, 0, set_enabled, GATE_OUTPUT, 0, 0},
    {"enable-relocalize", 0, 0, set_enabled, GATE_RELOCALIZE, 0, 0},
    {"command-timeout", 0, 1, set_time, 0, GATE_MIN_LEASE_US / 1000u, GATE_MAX_LEASE_US / 1000u},
    {"max-age", 0, 1, set_time, 1, 0, 3600000u},
    {"verbose", 'v', 0, set_level, LOG_DETAIL, 0, 0},
    {"quiet", 'q', 0, set_level, LOG_ERROR, 0, 0},
    {"help", 'h', 0, NULL, OPTIONS_HELP, 0, 0},
    {"version", 0, 0, NULL, OPTIONS_VERSION, 0, 0},
};
#define KNOWN (sizeof known / sizeof known[0])
static const char letters[] = ":r:l:p:vqh";
/* What getopt_long() returns for the long form of known[0]. */
#define FIRST_LONG 256

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

/* LCM's other networks, tcpq and file, can block inside LCM: no stop would leave meanwhile, and no
 * signal would be noticed. And a file is a log, which must not drive. */
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

static bool add_robot(reading *reading, options_robot *robot, const char *value) {
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
    } else if (reading->count[LIST_ROBOTS] > 1) {
        return complain(reading,
                        "--robot %s: several robots need a name each, such as --robot A=%s", value,
                        value);
    }
    if (!channels_is_name(prefix) || !channels_set_prefix(&robot->channels, prefix)) {
        return complain(reading,
                        "'%s' cannot be the start of a channel's name; give at most 45 letters, "
                        "digits, _, - or /",
                        prefix);
    }
    return true;
}

static bool set_robots(reading *reading) {
    options *out = reading->out;
    uint32_t *count = &reading->count[LIST_ROBOTS];
    if (*count == 0) {
        reading->list[LIST_ROBOTS][(*count)++] = ROBUROC4_DEFAULT_HOST;
    }
    for (uint32_t at = 0; at < *count; at++) {
        if (!add_robot(reading, &out->robots[at], reading->list[LIST_ROBOTS][at])) {
            return false;
        }
        if (reading->prefix != NULL && out->robots[at].name[0] != '\0') {
            return complain(reading,
                            "--prefix %s: a robot with a name has that as its prefix; "
                            "leave out one of them",
                            reading->prefix);
        }
    }
    out->robot_count = *count;
    return true;
}

/* ---------------------------------------------------------------------------- the channels --- */

/* The robot that `[NAME:]REST` is about, and REST; NULL (and an error) for none. */
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

static bool name_channel(reading *reading, const char *value) {
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

static bool name_pose(reading *reading, const char *value) {
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
    for (uint32_t at = 0; at < reading->count[LIST_CHANNELS]; at++) {
        if (!name_channel(reading, reading->list[LIST_CHANNELS][at])) {
            return false;
        }
    }
    for (uint32_t at = 0; at < reading->count[LIST_POSES]; at++) {
        if (!name_pose(reading, reading->list[LIST_POSES][at])) {
            return false;
        }
    }
    const char *doubled = doubled_channel(reading->out);
    return doubled == NULL ||
           complain(reading, "two channels are named %s: give each its own name", doubled);
}

/* To drive, the bridge must soon notice whether the robot moves, and whether [A] is held. */
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

/* option: '?' or ':', as getopt_long() returned it; last: the argument before those to come. */
static void complain_of_option(reading *reading, int option, const char *last) {
    bool is_short = optopt > 0 && optopt < 256 && strchr(letters, optopt) == NULL;
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

/* option: what getopt_long() returned, but not '?', ':' or -1. */
static const known_option *find_option(int option) {
    size_t at = 0;
    while (at + 1 < KNOWN && option != FIRST_LONG + (int)at && option != known[at].letter) {
        at++;
    }
    return &known[at];
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
    struct option long_options[KNOWN + 1] = {{NULL, 0, NULL, 0}};
    set_defaults(out);
    optind = 1;
    opterr = 0;
    for (size_t at = 0; at < KNOWN; at++) {
        long_options[at] =
            (struct option){known[at].name, known[at].has_value, NULL, FIRST_LONG + (int)at};
    }
    for (;;) {
        int option = getopt_long(count, arguments, letters, long_options, NULL);
        if (option == -1) {
            break;
        }
        if (option == '?' || option == ':') {
            complain_of_option(&reading, option, arguments[optind - 1]);
            return OPTIONS_BAD;
        }
        const known_option *found = find_option(option);
        if (found->set == NULL) {
            return (enum options_result)found->which;
        }
        if (!found->set(&reading, found, optarg)) {
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

/* An earlier robot with the same address, or NULL: two gates would command one robot. */
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
