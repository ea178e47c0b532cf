/* SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "options.h"

#include <errno.h>
#include <getopt.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ini.h"
#include "network.h"
#include "roburoc4_robot_file.h"
#include "text.h"

#define MAX_FILE_BYTES (1 << 20)
/* Statuses older than this do not count for driving (roburoc4_config.fresh_ms). */
#define SLOWEST_DRIVING_MS 100u

const char options_help[] =
    "Usage: roburoc4-lcm [OPTION]...\n"
    "Put RobuROC4 robots on an LCM network: every status is published as it arrives, and commands\n"
    "are obeyed where that is enabled.\n"
    "\n"
    "  -r, --robot [NAME=]HOST[:PORT]  the robot (default 192.168.0.2:60000). With NAME its\n"
    "                       channels are NAME_DIFFERENTIAL and so on, and the option may be\n"
    "                       given up to 1000 times\n"
    "  -c, --config FILE    read robots and their settings from FILE; see roburoc4-lcm(1)\n"
    "      --check          print what would run, and exit\n"
    "  -l, --lcm-url URL    the LCM network (default: LCM's own, see LCM_DEFAULT_URL), such as\n"
    "                       'udpm://239.255.76.67:7667?ttl=0' for this machine only; LCM's tcpq\n"
    "                       and file are refused: they can block the bridge, or drive from a log\n"
    "  -p, --prefix PREFIX  prefix of the channels of a robot without NAME (default ROBUROC4)\n"
    "      --channel [NAME:]KEY=CHANNEL  another name for one channel; KEY is DIFFERENTIAL,\n"
    "                       LOCALIZATION, BATTERY, TELEMETER, IOCARD, PROPERTIES,\n"
    "                       BRIDGE_STATE, BRIDGE_STATISTICS, MOVE_STATUS, DRIVE_CMD,\n"
    "                       MOVE_CMD, RELOCALIZE_CMD, OUTPUT_CMD or STOP_CMD; command channels "
    "must end in _CMD\n"
    "      --pose-channel [NAME:]CHANNEL  also publish each localization as bot_core.pose_t\n"
    "      --fleet-stop CHANNEL  whatever arrives on it stops all robots of this bridge; it must\n"
    "                       end in _CMD\n"
    "      --record FILE    record every datagram of all robots in the pcapng file FILE, or in a\n"
    "                       new file in the folder FILE; existing files are not overwritten\n"
    "      --robot-file FILE  ids, inputs, watchdog and scales of the robot, as roburoc4\n"
    "                       first-contact measured them\n"
    "      --period-ms SERVICE=MS  time between statuses, 10 to 2550 in steps of 10, or 0 for\n"
    "                       none; SERVICE is iocard, telemeter, battery, localization or\n"
    "                       differential\n"
    "\n"
    "Commands; without these the bridge only watches, and obeys PREFIX_STOP_CMD:\n"
    "      --enable-drive       obey PREFIX_DRIVE_CMD and _MOVE_CMD: THE ROBOT CAN MOVE. Statuses\n"
    "                           of iocard and differential must come at least every 100 ms\n"
    "      --enable-outputs     obey PREFIX_OUTPUT_CMD\n"
    "      --enable-relocalize  obey PREFIX_RELOCALIZE_CMD\n"
    "      --allow-sender NAMES  obey only these senders: names, or beginnings such as planner*,\n"
    "                       with commas between them. No protection: anybody can send any name.\n"
    "                       Stops are obeyed from everybody\n"
    "      --lease-ms MS    longest lease of a command, and that of one without its own (20\n"
    "                       to 1000; default 250)\n"
    "      --max-age-ms MS  oldest command that is obeyed, by its utime (default 200; at most\n"
    "                       3600000). 0 obeys all ages, for clocks that cannot be set; then a\n"
    "                       replayed log can move the robot\n"
    "      --max-linear-m-s M_S, --max-angular-rad-s RAD_S  ceilings of the speeds (default 1\n"
    "                       and 1.5; at most 5 and 10): faster commands are reduced to them\n"
    "\n"
    "  -v, --verbose        log more: each rejected command\n"
    "  -q, --quiet          log errors only\n"
    "  -h, --help           print this and exit\n"
    "      --version        print the version and exit\n"
    "\n"
    "SIGINT, SIGTERM and SIGHUP stop the robot and end the bridge. Exit status: 0 ended on\n"
    "request, 1 error, 2 bad usage, 3 no LCM network.\n";

enum { PASS_SETTINGS, PASS_ROBOTS, PASS_CHANNELS, PASSES };

/* More than a section can have without giving one twice. */
#define MAX_SETTINGS 64

/* The state of reading. Settings go to `robot`, which is `all` until the file names one. */
typedef struct reading {
    options *out;
    options_robot all; /* what applies to all robots */
    options_robot *robot;
    const char *prefix;
    const char *for_robots; /* a command line option that configures robots, or NULL */
    bool in_file, has_default;
    ini_text seen[MAX_SETTINGS]; /* the settings of this section so far, and their lines */
    unsigned seen_lines[MAX_SETTINGS];
    uint32_t seen_count;
    char subject[OPTIONS_MAX_TEXT + 65]; /* the option and value that an error is about */
    char *error;
    size_t error_size;
} reading;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
/* Write an error message; always returns false. */
static bool
complain(reading *reading, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(reading->error, reading->error_size, format, arguments);
    va_end(arguments);
    return false;
}

/* Write the remedy for the value that was read; always returns false. */
static bool refuse(reading *reading, const char *remedy) {
    return complain(reading, "%s: %s", reading->subject, remedy);
}

/* --------------------------------------------------------------------------- option values --- */

static bool whole(const char *text, uint32_t min, uint32_t max, uint32_t *out) {
    return text_number(&text, max, out) && *text == '\0' && *out >= min;
}

/* Where a setting is allowed: on the command line (by pass), and in the file. */
enum place { ONLY_COMMAND_LINE, FOR_ALL, FOR_EACH, FOR_ONE };
/* `which` of a time, and of a ceiling. */
enum { LEASE, MAX_AGE };
enum { LINEAR, ANGULAR };

/* `which` and the limits parametrize `set`. A setter gets NULL if the option has no value on the
 * command line, otherwise the file's value. */
typedef struct known_option {
    const char *name;
    char letter; /* or NO_LETTER */
    int has_value;
    int pass;
    enum place place;
    bool (*set)(reading *reading, const struct known_option *option, const char *value);
    uint32_t which, min, max;
} known_option;

/* Enable commands of the kind `which`. */
static bool set_enabled(reading *reading, const known_option *option, const char *value) {
    bool on = value == NULL || strcmp(value, "yes") == 0;
    if (!on && strcmp(value, "no") != 0) {
        return refuse(reading, "give yes or no");
    }
    reading->robot->rules.enabled[option->which] = on;
    return true;
}

static bool set_level(reading *reading, const known_option *option, const char *value) {
    (void)value;
    reading->out->level = (enum log_level)option->which;
    return true;
}

static bool set_check(reading *reading, const known_option *option, const char *value) {
    (void)option;
    (void)value;
    reading->out->check = true;
    return true;
}

static bool copy_text(reading *reading, char *room, const char *value) {
    size_t length = strlen(value);
    if (length > OPTIONS_MAX_TEXT) {
        return refuse(reading, "is too long; give at most 255 letters");
    }
    memcpy(room, value, length + 1);
    return true;
}

/* The command line takes precedence. */
static bool set_url(reading *reading, const known_option *option, const char *value) {
    const char *remedy = network_remedy(value);
    (void)option;
    if (reading->in_file && reading->out->lcm_url[0] != '\0') {
        return true;
    }
    return remedy == NULL ? copy_text(reading, reading->out->lcm_url, value)
                          : refuse(reading, remedy);
}

/* Whether a capture can be made at this path, or in this folder. */
static bool can_record(const char *path) {
    char folder[OPTIONS_MAX_TEXT + 1] = ".";
    struct stat found;
    if (stat(path, &found) == 0 && S_ISDIR(found.st_mode)) {
        return access(path, W_OK | X_OK) == 0;
    }
    const char *slash = strrchr(path, '/');
    const char *suffix = strrchr(path, '.');
    if (suffix == NULL || strcmp(suffix, ".pcapng") != 0) {
        return false;
    }
    if (slash != NULL) {
        size_t length = slash == path ? 1 : (size_t)(slash - path);
        memcpy(folder, path, length);
        folder[length] = '\0';
    }
    return stat(folder, &found) == 0 && S_ISDIR(found.st_mode) && access(folder, W_OK | X_OK) == 0;
}

static bool set_record(reading *reading, const known_option *option, const char *value) {
    (void)option;
    if (reading->in_file && reading->out->record[0] != '\0') {
        return true;
    }
    if (!copy_text(reading, reading->out->record, value)) {
        return false;
    }
    return can_record(value) ||
           refuse(reading, "no file can be made there; give a folder that exists and can be "
                           "written, or a file in one, with a name ending in .pcapng");
}

static bool set_fleet_stop(reading *reading, const known_option *option, const char *value) {
    (void)option;
    if (!channels_is_name(value) || !channels_ends_in_cmd(value)) {
        return refuse(reading, "give 1 to 63 letters, digits, _, - or /, ending in _CMD, such as "
                               "ALL_STOP_CMD");
    }
    if (!reading->in_file || reading->out->fleet_stop[0] == '\0') {
        memcpy(reading->out->fleet_stop, value, strlen(value) + 1);
    }
    return true;
}

/* The next pattern of a list at *text, its length, and *text behind it; NULL at the end. */
static const char *next_pattern(const char **text, size_t *length) {
    static const char between[] = ", ";
    const char *at = *text + strspn(*text, between);
    *length = strcspn(at, between);
    *text = at + *length;
    return *length > 0 ? at : NULL;
}

static bool set_allowed(reading *reading, const known_option *option, const char *value) {
    const char *rest = value;
    size_t length = 0;
    uint32_t count = 0;
    (void)option;
    for (const char *at = NULL; (at = next_pattern(&rest, &length)) != NULL; count++) {
        const char *star = memchr(at, '*', length);
        if (length > GATE_MAX_SENDER || (star != NULL && star != at + length - 1)) {
            count = 0;
            break;
        }
    }
    if (count == 0) {
        return refuse(reading, "give names of at most 63 bytes with commas between them, or "
                               "beginnings of names with a * behind, such as planner*");
    }
    return copy_text(reading, reading->robot->allowed, value);
}

bool options_allows(const options_robot *robot, const char *sender, size_t length) {
    const char *rest = robot->allowed;
    size_t pattern_length = 0;
    const char *at = next_pattern(&rest, &pattern_length);
    if (at == NULL) {
        return true;
    }
    for (; at != NULL; at = next_pattern(&rest, &pattern_length)) {
        const bool begins = at[pattern_length - 1] == '*';
        const size_t compared = pattern_length - begins;
        if ((begins ? length >= compared : length == compared) &&
            (compared == 0 || memcmp(at, sender, compared) == 0)) {
            return true;
        }
    }
    return false;
}

static bool set_prefix(reading *reading, const known_option *option, const char *value) {
    (void)option;
    reading->prefix = value;
    return true;
}

static bool set_file(reading *reading, const known_option *option, const char *value) {
    (void)option;
    reading->out->file = value;
    return true;
}

/* A time of `min` to `max` milliseconds. */
static bool set_time(reading *reading, const known_option *option, const char *value) {
    gate_rules *rules = &reading->robot->rules;
    uint32_t ms = 0;
    if (!whole(value, option->min, option->max, &ms)) {
        return complain(reading, "%s: give milliseconds, %u to %u", reading->subject,
                        (unsigned)option->min, (unsigned)option->max);
    }
    *(option->which == MAX_AGE ? &rules->max_age_us : &rules->lease_us) = ms * 1000u;
    return true;
}

/* A ceiling of a speed; `min` and `max` are thousandths of its unit. */
static bool set_ceiling(reading *reading, const known_option *option, const char *value) {
    roburoc4_config *config = &reading->robot->config;
    char *end = NULL;
    const bool plain = value[0] != '\0' && strspn(value, "0123456789.") == strlen(value);
    const double ceiling = plain ? strtod(value, &end) : 0;
    if (!plain || *end != '\0' || ceiling * 1000 < option->min || ceiling * 1000 > option->max) {
        return complain(reading, "%s: give %s, 0.001 to %u", reading->subject,
                        option->which == LINEAR ? "m/s" : "rad/s", (unsigned)option->max / 1000);
    }
    *(option->which == LINEAR ? &config->max_linear_m_s : &config->max_angular_rad_s) =
        (float)ceiling;
    return true;
}

const char *const options_services[OPTIONS_SERVICES] = {"iocard", "telemeter", "battery",
                                                        "localization", "differential"};

static bool set_period(reading *reading, const known_option *option, const char *value) {
    roburoc4_config *config = &reading->robot->config;
    uint32_t period_ms = 0;
    uint32_t at = 0;
    size_t length = strcspn(value, "=");
    (void)option;
    while (at < OPTIONS_SERVICES && (strlen(options_services[at]) != length ||
                                     memcmp(options_services[at], value, length) != 0)) {
        at++;
    }
    if (at == OPTIONS_SERVICES || value[length] == '\0' ||
        !whole(value + length + 1, 0, 2550, &period_ms) || period_ms % 10 != 0) {
        return refuse(reading, "give SERVICE=MS; SERVICE is iocard, telemeter, battery, "
                               "localization or differential, MS is 0 or 10 to 2550 in steps of "
                               "10; in a file, period-ms.SERVICE = MS");
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

/* Read and close a file; false unless all of it fits into the room, with a byte to spare. */
static bool read_whole(FILE *file, char *text, size_t size, size_t *length) {
    *length = fread(text, 1, size, file);
    const bool good = ferror(file) == 0 && *length < size;
    (void)fclose(file);
    return good;
}

static bool set_robot_file(reading *reading, const known_option *option, const char *value) {
    char text[4 * ROBUROC4_ROBOT_FILE_SIZE]; /* with room for comments */
    roburoc4_robot_file file;
    const char *remedy = NULL;
    uint32_t line = 0;
    FILE *opened = fopen(value, "rb");
    (void)option;
    if (opened == NULL) {
        return refuse(reading, "cannot be opened; give a file of roburoc4 first-contact");
    }
    size_t length = 0;
    if (!read_whole(opened, text, sizeof text, &length)) {
        return refuse(reading, "cannot be read, or is longer than 24 kB");
    }
    if (roburoc4_robot_file_read(&file, text, length, &line, &remedy) < 0) {
        return complain(reading, "%s: line %u: %s", reading->subject, (unsigned)line, remedy);
    }
    roburoc4_robot_file_config(&file, &reading->robot->config);
    return true;
}

/* ------------------------------------------------------------------------------ the robots --- */

static options_robot *find_robot(options *out, const char *name, size_t length) {
    for (uint32_t at = 0; at < out->robot_count; at++) {
        const char *own = out->robots[at].name;
        if (length > 0 && strlen(own) == length && memcmp(own, name, length) == 0) {
            return &out->robots[at];
        }
    }
    return NULL;
}

/* Add a robot with the settings that apply to all; returns NULL after writing an error. name: "" if
 * it is the only one. */
static options_robot *add_robot(reading *reading, const char *name, size_t length,
                                const char *prefix) {
    options *out = reading->out;
    options_robot *robot = &out->robots[out->robot_count];
    if (out->robot_count == OPTIONS_MAX_ROBOTS) {
        (void)refuse(reading, "a bridge has at most 1000 robots; start another one");
        return NULL;
    }
    if (find_robot(out, name, length) != NULL) {
        (void)refuse(reading, "there already is a robot with this name; give each its own");
        return NULL;
    }
    *robot = reading->all;
    if (length >= sizeof robot->name) {
        (void)refuse(reading, "the name is too long; give at most 45 letters");
        return NULL;
    }
    memcpy(robot->name, name, length);
    robot->prefix = prefix;
    prefix = length > 0 ? robot->name : prefix;
    if (!channels_is_name(prefix) || !channels_set_prefix(&robot->channels, prefix)) {
        (void)complain(reading,
                       "'%s' cannot be the start of a channel's name; give at most 45 letters, "
                       "digits, _, - or /",
                       prefix);
        return NULL;
    }
    out->robot_count++;
    return robot;
}

/* [NAME=]HOST on the command line. */
static bool set_robot(reading *reading, const known_option *option, const char *value) {
    const char *equals = strchr(value, '=');
    size_t length = equals != NULL ? (size_t)(equals - value) : 0;
    const char *first = reading->out->robots[0].name;
    (void)option;
    if (equals != NULL && reading->prefix != NULL) {
        return complain(reading,
                        "--prefix %s: a named robot has its name as prefix; leave out one of "
                        "them",
                        reading->prefix);
    }
    if (reading->out->robot_count > 0 && (equals == NULL || first[0] == '\0')) {
        return complain(reading,
                        "--robot %s: with several robots, each needs a name, such as --robot A=%s",
                        value, value);
    }
    if (equals != NULL && length == 0) {
        return refuse(reading, "a name is missing before the =");
    }
    if (value[equals != NULL ? length + 1 : 0] == '\0') {
        return refuse(reading, "the address is missing; give HOST, HOST:PORT or NAME=HOST");
    }
    options_robot *robot =
        add_robot(reading, value, length, reading->prefix != NULL ? reading->prefix : "ROBUROC4");
    return robot != NULL && copy_text(reading, robot->host, equals != NULL ? equals + 1 : value);
}

/* In a robot's section of the file. */
static bool set_address(reading *reading, const known_option *option, const char *value) {
    (void)option;
    return value[0] != '\0' ? copy_text(reading, reading->robot->host, value)
                            : refuse(reading, "give HOST or HOST:PORT");
}

/* ---------------------------------------------------------------------------- the channels --- */

/* Split `[NAME:]REST` into the robot it is about and REST; returns NULL after writing an error. */
static options_robot *robot_meant(reading *reading, const char *value, const char **rest) {
    options *out = reading->out;
    const char *colon = strchr(value, ':');
    *rest = value;
    if (reading->in_file) {
        return reading->robot;
    }
    *rest = colon != NULL ? colon + 1 : value;
    if (colon == NULL && out->robot_count == 1) {
        return &out->robots[0];
    }
    options_robot *robot = colon != NULL ? find_robot(out, value, (size_t)(colon - value)) : NULL;
    if (robot == NULL) {
        (void)refuse(reading, colon != NULL ? "no --robot has the name before the colon"
                                            : "which robot? put its name and a colon before it");
    }
    return robot;
}

static bool set_channel(reading *reading, const known_option *option, const char *value) {
    const char *rest = NULL;
    options_robot *robot = robot_meant(reading, value, &rest);
    (void)option;
    if (robot == NULL) {
        return false;
    }
    size_t length = strcspn(rest, "=");
    enum channel channel = channels_find(rest, length);
    if (channel == CHANNELS || rest[length] == '\0' || !channels_is_name(rest + length + 1)) {
        return refuse(reading,
                      "give KEY=CHANNEL, such as LOCALIZATION=ODOMETRY; CHANNEL has 1 to 63 "
                      "letters, digits, _, - or /; in a file, channel.KEY = CHANNEL");
    }
    const char *name = rest + length + 1;
    if (channels_ends_in_cmd(name) != channels_is_command(channel)) {
        return refuse(reading, "names of commands, and no others, end in _CMD, so that they can be "
                               "left out of logs that are replayed");
    }
    memcpy(robot->channels.name[channel], name, strlen(name) + 1);
    return true;
}

static bool set_pose(reading *reading, const known_option *option, const char *value) {
    const char *name = NULL;
    options_robot *robot = robot_meant(reading, value, &name);
    (void)option;
    if (robot == NULL) {
        return false;
    }
    if (!channels_is_name(name) || channels_ends_in_cmd(name)) {
        return refuse(reading, "give 1 to 63 letters, digits, _, - or /, not ending in _CMD");
    }
    memcpy(robot->channels.name[CHANNEL_POSE], name, strlen(name) + 1);
    return true;
}

/* ------------------------------------------------------------------------------ all options --- */

#define MIN_LEASE_MS (ROBUROC4_MIN_LEASE_US / 1000u)
#define MAX_LEASE_MS (ROBUROC4_MAX_LEASE_US / 1000u)
/* drive() accepts no faster commands. */
#define MAX_LINEAR_MM_S ((uint32_t)(ROBUROC4_MAX_DRIVE_M_S * 1000))
#define MAX_ANGULAR_MRAD_S ((uint32_t)(ROBUROC4_MAX_DRIVE_RAD_S * 1000))

#define NO_LETTER '\0'
/* With a value, and without one: yes or no in the file. */
#define VALUE(name, letter, pass, place, set)                                                      \
    { name, letter, required_argument, pass, place, set, 0, 0, 0 }
#define NUMBER(name, set, which, min, max)                                                         \
    { name, NO_LETTER, required_argument, PASS_SETTINGS, FOR_EACH, set, which, min, max }
#define FLAG(name, letter, place, set, which)                                                      \
    { name, letter, no_argument, PASS_SETTINGS, place, set, which, 0, 0 }

/* Options without a setter end the reading. */
static const known_option known[] = {
    VALUE("robot", 'r', PASS_ROBOTS, ONLY_COMMAND_LINE, set_robot),
    VALUE("config", 'c', PASS_SETTINGS, ONLY_COMMAND_LINE, set_file),
    VALUE("lcm-url", 'l', PASS_SETTINGS, FOR_ALL, set_url),
    VALUE("record", NO_LETTER, PASS_SETTINGS, FOR_ALL, set_record),
    VALUE("prefix", 'p', PASS_SETTINGS, ONLY_COMMAND_LINE, set_prefix),
    VALUE("channel", NO_LETTER, PASS_CHANNELS, FOR_ONE, set_channel),
    VALUE("pose-channel", NO_LETTER, PASS_CHANNELS, FOR_ONE, set_pose),
    VALUE("period-ms", NO_LETTER, PASS_SETTINGS, FOR_EACH, set_period),
    VALUE("robot-file", NO_LETTER, PASS_SETTINGS, FOR_EACH, set_robot_file),
    VALUE("allow-sender", NO_LETTER, PASS_SETTINGS, FOR_EACH, set_allowed),
    VALUE("fleet-stop", NO_LETTER, PASS_SETTINGS, FOR_ALL, set_fleet_stop),
    NUMBER("lease-ms", set_time, LEASE, MIN_LEASE_MS, MAX_LEASE_MS),
    NUMBER("max-age-ms", set_time, MAX_AGE, 0, 3600000u),
    NUMBER("max-linear-m-s", set_ceiling, LINEAR, 1, MAX_LINEAR_MM_S),
    NUMBER("max-angular-rad-s", set_ceiling, ANGULAR, 1, MAX_ANGULAR_MRAD_S),
    FLAG("enable-drive", NO_LETTER, FOR_EACH, set_enabled, GATE_DRIVE),
    FLAG("enable-outputs", NO_LETTER, FOR_EACH, set_enabled, GATE_OUTPUT),
    FLAG("enable-relocalize", NO_LETTER, FOR_EACH, set_enabled, GATE_RELOCALIZE),
    FLAG("check", NO_LETTER, ONLY_COMMAND_LINE, set_check, 0),
    FLAG("verbose", 'v', ONLY_COMMAND_LINE, set_level, LOG_DETAIL),
    FLAG("quiet", 'q', ONLY_COMMAND_LINE, set_level, LOG_ERROR),
    FLAG("help", 'h', ONLY_COMMAND_LINE, NULL, OPTIONS_HELP),
    FLAG("version", NO_LETTER, ONLY_COMMAND_LINE, NULL, OPTIONS_VERSION),
};
#define KNOWN (sizeof known / sizeof known[0])
static const known_option address_of_robot =
    VALUE("address", NO_LETTER, PASS_SETTINGS, FOR_ONE, set_address);
static const char letters[] = ":r:c:l:p:vqh";
/* What getopt_long() returns for the long form of known[0]. */
#define FIRST_LONG 256

/* ------------------------------------------------------------------------------- the whole --- */

const char *options_lcm_url(const options *options, const char **source) {
    const char *url = options->lcm_url;
    *source = options->file != NULL ? "lcm-url" : "--lcm-url";
    if (url[0] == '\0') { /* as LCM does */
        *source = "LCM_DEFAULT_URL";
        url = getenv(*source);
    }
    return url != NULL ? url : "";
}

/* What LCM will use, also from the environment. */
static bool check_network(reading *reading) {
    const char *source = NULL;
    const char *url = options_lcm_url(reading->out, &source);
    const char *remedy = network_remedy(url);
    return remedy == NULL || complain(reading, "%s %s: %s", source, url, remedy);
}

static bool check_channels(reading *reading) {
    options *out = reading->out;
    size_t count = 0;
    for (uint32_t which = 0; which < out->robot_count * CHANNELS; which++) {
        const char *name = out->robots[which / CHANNELS].channels.name[which % CHANNELS];
        if (name[0] != '\0') {
            out->entries[count++] = (channels_entry){name, which};
        }
    }
    if (out->fleet_stop[0] != '\0') {
        out->entries[count++] = (channels_entry){out->fleet_stop, OPTIONS_FLEET_STOP};
    }
    out->directory = (channels_directory){out->entries, count};
    const char *doubled = channels_sort(&out->directory);
    return doubled == NULL ||
           complain(reading, "two channels are named %s: give each its own name", doubled);
}

/* To drive, the bridge must soon notice whether the robot moves and whether [A] is held. */
static bool check_robot(reading *reading, const options_robot *robot) {
    static const uint32_t needed[] = {ROBUROC4_SERVICE_IOCARD, ROBUROC4_SERVICE_DIFFERENTIAL};
    char where[OPTIONS_MAX_TEXT + 80] = "--";
    if (robot->line != 0) {
        (void)snprintf(where, sizeof where, "%s:%u: [%s]: ", reading->out->file, robot->line,
                       robot->name);
    }
    if (robot->host[0] == '\0') {
        return complain(reading, "%saddress is missing; give address = HOST or HOST:PORT", where);
    }
    for (uint32_t at = 0; robot->rules.enabled[GATE_DRIVE] && at < 2; at++) {
        if ((robot->config.subscriptions >> needed[at] & 1u) == 0 ||
            robot->config.period_ms[needed[at]] > SLOWEST_DRIVING_MS) {
            return complain(reading,
                            "%senable-drive needs statuses of iocard and differential at least "
                            "every %u ms: give a shorter period",
                            where, SLOWEST_DRIVING_MS);
        }
    }
    return true;
}

static bool check_robots(reading *reading) {
    const options *out = reading->out;
    for (uint32_t at = 0; at < out->robot_count; at++) {
        if (!check_robot(reading, &out->robots[at])) {
            return false;
        }
    }
    return out->robot_count > 0 ||
           complain(reading, "%s: no robot; give a section such as [RED] with address = HOST",
                    out->file);
}

static enum options_result check_all(reading *reading) {
    return check_network(reading) && check_robots(reading) && check_channels(reading) ? OPTIONS_RUN
                                                                                      : OPTIONS_BAD;
}

static void begin(reading *reading, options *out, char *error, size_t error_size) {
    memset(reading, 0, sizeof *reading);
    reading->out = out;
    reading->error = error;
    reading->error_size = error_size;
    reading->robot = &reading->all;
    reading->all.rules.lease_us = 250000;
    reading->all.rules.max_age_us = 200000;
    out->level = LOG_NOTE;
    (void)roburoc4_config_init(&reading->all.config, sizeof reading->all.config);
}

/* -------------------------------------------------------------------------------- the file --- */

/* [DEFAULT], or the name of a robot. */
static bool begin_section(reading *reading, const ini_line *line) {
    reading->seen_count = 0;
    if (ini_is(line->section, "DEFAULT", false)) {
        const bool again = reading->has_default;
        reading->has_default = true;
        return (reading->out->robot_count == 0 && !again) ||
               refuse(reading, "put [DEFAULT], which applies to all robots, first, and only once");
    }
    reading->robot = add_robot(reading, line->section.at, line->section.length, "");
    if (reading->robot != NULL) {
        reading->robot->line = line->number;
    }
    return reading->robot != NULL;
}

/* NAME of `NAME = VALUE` and `NAME.KEY = VALUE`. */
static const known_option *find_setting(ini_text name) {
    const char *dot = name.length > 0 ? memchr(name.at, '.', name.length) : NULL;
    name.length = dot != NULL ? (size_t)(dot - name.at) : name.length;
    for (size_t at = 0; at < KNOWN; at++) {
        if (known[at].place != ONLY_COMMAND_LINE && ini_is(name, known[at].name, false)) {
            return &known[at];
        }
    }
    return ini_is(name, address_of_robot.name, false) ? &address_of_robot : NULL;
}

/* Each setting once in a section: nobody would know which one holds. */
static bool is_first(reading *reading, const ini_line *line) {
    for (uint32_t at = 0; at < reading->seen_count; at++) {
        ini_text other = reading->seen[at];
        if (other.length == line->name.length &&
            memcmp(other.at, line->name.at, other.length) == 0) {
            return complain(reading, "%s: line %u has it already; remove one of them",
                            reading->subject, reading->seen_lines[at]);
        }
    }
    if (reading->seen_count < MAX_SETTINGS) {
        reading->seen[reading->seen_count] = line->name;
        reading->seen_lines[reading->seen_count++] = line->number;
    }
    return true;
}

static bool read_setting(reading *reading, const ini_line *line) {
    char value[2 * OPTIONS_MAX_TEXT];
    const known_option *found = find_setting(line->name);
    bool for_one = reading->robot != &reading->all;
    if (found == NULL || line->value.at == NULL) {
        return refuse(reading,
                      "no such setting; give address, lcm-url, record, fleet-stop, "
                      "enable-drive, enable-outputs, enable-relocalize, allow-sender, lease-ms, "
                      "max-age-ms, max-linear-m-s, max-angular-rad-s, robot-file, "
                      "period-ms.SERVICE, channel.KEY or pose-channel, = and a value");
    }
    if (found->place == (for_one ? FOR_ALL : FOR_ONE)) {
        return refuse(reading, for_one ? "put it into [DEFAULT]: it applies to all robots"
                                       : "put it into the section of a robot, such as [RED]");
    }
    if (!is_first(reading, line)) {
        return false;
    }
    size_t name_length = strlen(found->name);
    bool dotted = line->name.length > name_length;
    int key = dotted ? (int)(line->name.length - name_length - 1) : 0;
    int written =
        snprintf(value, sizeof value, "%.*s%s%.*s", key, line->name.at + name_length + dotted,
                 dotted ? "=" : "", (int)line->value.length, line->value.at);
    if (written < 0 || (size_t)written >= sizeof value) {
        return refuse(reading, "is too long");
    }
    return found->set(reading, found, value);
}

static bool read_line(void *user, const ini_line *line, char *error, size_t capacity) {
    reading *reading = user;
    reading->error = error;
    reading->error_size = capacity;
    if (line->section.length == 0) {
        return complain(reading, "a section such as [DEFAULT] or [RED] must come before it");
    }
    bool section = line->name.length == 0 && line->value.at == NULL;
    ini_text name = section ? line->section : line->name;
    int shown = (int)(name.length < 60 ? name.length : 60);
    if (section) {
        (void)snprintf(reading->subject, sizeof reading->subject, "[%.*s]", shown, name.at);
    } else {
        int value = (int)(line->value.length < 200 ? line->value.length : 200);
        (void)snprintf(reading->subject, sizeof reading->subject, "%.*s%s%.*s", shown, name.at,
                       line->value.at != NULL ? " = " : "", value,
                       line->value.at != NULL ? line->value.at : "");
    }
    return section ? begin_section(reading, line) : read_setting(reading, line);
}

static enum options_result read_file_text(reading *reading, const char *text, size_t length) {
    char *error = reading->error;
    size_t error_size = reading->error_size;
    char why[OPTIONS_ERROR_SIZE] = "";
    reading->in_file = true;
    unsigned line = ini_read(text, length, read_line, reading, why, sizeof why);
    reading->error = error;
    reading->error_size = error_size;
    if (line != 0) {
        (void)complain(reading, "%s:%u: %s", reading->out->file, line, why);
        return OPTIONS_BAD;
    }
    return check_all(reading);
}

enum options_result options_read_text(const char *name, const char *text, size_t length,
                                      options *out, char *error, size_t error_size) {
    reading reading;
    begin(&reading, out, error, error_size);
    out->file = name;
    return read_file_text(&reading, text, length);
}

static enum options_result read_file(reading *reading) {
    static char text[MAX_FILE_BYTES];
    const char *name = reading->out->file;
    FILE *file = fopen(name, "rb");
    if (file == NULL) {
        (void)complain(reading, "--config %s: %s", name, strerror(errno));
        return OPTIONS_BAD;
    }
    size_t length = 0;
    if (!read_whole(file, text, sizeof text, &length)) {
        (void)complain(reading, "--config %s: give a text file of less than 1 MiB", name);
        return OPTIONS_BAD;
    }
    return read_file_text(reading, text, length);
}

/* ---------------------------------------------------------------------------- command line --- */

/* option: '?' or ':', as getopt_long() returned it; last: the argument before the remaining
 * ones. */
static void complain_of_option(reading *reading, int option, const char *last) {
    bool is_short = optopt > 0 && optopt < 256 && strchr(letters, optopt) == NULL;
    if (is_short) { /* it may be in the middle of `-vx` */
        (void)complain(reading, "unknown option '-%c': see roburoc4-lcm --help", optopt);
    } else {
        (void)complain(reading, "%s '%s': see roburoc4-lcm --help",
                       option == ':' ? "a value is missing after"
                       : optopt == 0 ? "unknown option"
                                     : "no value is allowed for",
                       last);
    }
}

/* option: what getopt_long() returned, but not '?', ':' or -1. */
static const known_option *find_option(int option) {
    size_t at = 0;
    while (option != FIRST_LONG + (int)at && option != known[at].letter) {
        at++;
    }
    return &known[at];
}

static bool apply(reading *reading, const known_option *option, const char *value) {
    bool is_for_robots = option->place == FOR_EACH || option->place == FOR_ONE ||
                         option->set == set_robot || option->set == set_prefix;
    (void)snprintf(reading->subject, sizeof reading->subject, "--%s%s%.255s", option->name,
                   value != NULL ? " " : "", value != NULL ? value : "");
    reading->for_robots = is_for_robots ? option->name : reading->for_robots;
    return option->set(reading, option, value);
}

/* Read the options of one pass. There are passes because some values depend on others. */
static enum options_result read_pass(reading *reading, int pass, int count, char **arguments) {
    struct option long_options[KNOWN + 1] = {{NULL, 0, NULL, 0}};
    for (size_t at = 0; at < KNOWN; at++) {
        long_options[at] =
            (struct option){known[at].name, known[at].has_value, NULL, FIRST_LONG + (int)at};
    }
    optind = 1;
    opterr = 0;
    for (;;) {
        int option = getopt_long(count, arguments, letters, long_options, NULL);
        if (option == -1) {
            break;
        }
        if (option == '?' || option == ':') {
            complain_of_option(reading, option, arguments[optind - 1]);
            return OPTIONS_BAD;
        }
        const known_option *found = find_option(option);
        if (found->set == NULL) {
            return (enum options_result)found->which;
        }
        if (found->pass == pass && !apply(reading, found, optarg)) {
            return OPTIONS_BAD;
        }
    }
    if (optind < count) {
        (void)complain(reading, "cannot use '%s': see roburoc4-lcm --help", arguments[optind]);
        return OPTIONS_BAD;
    }
    return OPTIONS_RUN;
}

enum options_result options_read(int count, char **arguments, options *out, char *error,
                                 size_t error_size) {
    reading reading;
    begin(&reading, out, error, error_size);
    for (int pass = 0; pass < PASSES; pass++) {
        enum options_result result = read_pass(&reading, pass, count, arguments);
        if (result != OPTIONS_RUN) {
            return result;
        }
        if (pass == PASS_ROBOTS && out->robot_count == 0 && out->file == NULL &&
            !set_robot(&reading, NULL, ROBUROC4_DEFAULT_HOST)) {
            return OPTIONS_BAD;
        }
    }
    if (out->file != NULL && reading.for_robots != NULL) {
        (void)complain(&reading, "--%s: with --config, robots are set in the file only",
                       reading.for_robots);
        return OPTIONS_BAD;
    }
    return out->file != NULL ? read_file(&reading) : check_all(&reading);
}

/* ------------------------------------------------------------------------------- addresses --- */

/* An earlier robot with the same address, or NULL: two gates must not command one robot. */
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

/* Look up the address of one robot. A name without one affects only that robot. */
static enum options_result resolve(options *out, uint32_t at, char *error, size_t error_size) {
    options_robot *robot = &out->robots[at];
    roburoc4_result result = roburoc4_udp_resolve(robot->host, 0, &robot->address);
    if (result >= 0) {
        const options_robot *doubled = doubled_robot(out, at);
        if (doubled == NULL) {
            return OPTIONS_RUN;
        }
        (void)snprintf(error, error_size,
                       "robot %s=%s: %s already has this address; name each robot once",
                       robot->name, robot->host, doubled->name);
        return OPTIONS_BAD;
    }
    bool bad = result == ROBUROC4_ERR_ADDRESS;
    memset(&robot->address, 0, sizeof robot->address);
    (void)snprintf(error, error_size, "robot %s: %s", robot->host,
                   bad ? "give HOST or HOST:PORT, with a port of 1 to 65535"
                       : "the name has no address; give a numeric address, such as "
                         "192.168.0.2, or correct the name");
    return bad ? OPTIONS_BAD : OPTIONS_NO_ADDRESS;
}

enum options_result options_resolve(options *out, char *error, size_t error_size) {
    enum options_result all = OPTIONS_RUN;
    for (uint32_t at = 0; at < out->robot_count; at++) {
        enum options_result result = resolve(out, at, error, error_size);
        if (result == OPTIONS_BAD) {
            return result;
        }
        all = result == OPTIONS_RUN ? all : result;
    }
    return all;
}
