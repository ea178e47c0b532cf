/* SPDX-License-Identifier: MIT
 *
 * roburoc4-sim, a simulated RobuROC4 on a UDP port: the command line.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "config_file.h"
#include "net.h"
#include "number.h"
#include "server.h"

#define USAGE_ERROR 2
#define MAX_CONFIG_BYTES 1048576
#define MAX_ROBOTS 10000
#define MAX_TIME_MS 60000.0
#define MAX_SETTING 40
#define MAX_FAMILY_SEED 9007199254740992u

static const char help[] =
    "Usage: roburoc4-sim [OPTION]...\n"
    "A simulated RobuROC4 robot that answers over UDP as the real one does.\n"
    "\n"
    "  --bind ADDR      IPv4 address to listen on (default 127.0.0.1; 0.0.0.0 for all)\n"
    "  --port N         UDP port (default 60000; 0 picks a free one)\n"
    "  --robots N       N robots on consecutive ports (default 1); with --port 0 each\n"
    "                   picks a free one\n"
    "  --config FILE    read the watchdog from a udpserver.cfg\n"
    "                   ([DifferentialService] Watchdog=100, in cycles of 10 ms), and any\n"
    "                   of the settings below ([Simulator] slip=0.2)\n"
    "  --robot-file FILE   be the robot of this file, which roburoc4 first-contact writes\n"
    "  --panel          obey lines from standard input, such as 'pad a down' or\n"
    "                   'estop local press'; 'help' lists them, 'quit' ends\n"
    "  --seed N         seed of slip and faults (default 1)\n"
    "  --family SEED    a robot of the family that the manual allows (docs/PROTOCOL.md),\n"
    "                   drawn from the seed and printed as settings; later options win\n"
    "\n"
    "Settings of the robot:\n"
    "  --as-manual      the manual to the letter, where the defaults make a first drive\n"
    "                   easy: motors are off until the motor button (panel: 'motor on'),\n"
    "                   while the charger is plugged in and below the minimum charge;\n"
    "                   every answer has the id 0x01; the charge comes from the voltage\n"
    "  --start-safe     of these only: motors are off until the motor button\n"
    "  --battery-percent P   the charge at the start (default 100)\n"
    "  --localization-flags N   the flags that it reports (default 18; 82 with Error)\n"
    "  and each other number of roburoc4_sim_config in roburoc4_sim.h by its name, such as\n"
    "  --slip 0.2 or --digital-inputs 23, and --iocard-id to --differential-id; one\n"
    "  without a value is set to 1. docs/PROTOCOL.md, \"The family\", explains many\n"
    "\n"
    "Faults of the network, each way; SHARE is 0 to 1 of all datagrams:\n"
    "  --loss SHARE     lost\n"
    "  --duplicate SHARE   arrive twice\n"
    "  --reorder SHARE  held back so that later ones overtake them\n"
    "  --corrupt SHARE  damaged\n"
    "  --delay-ms MS    delay of each datagram (0 to 60000)\n"
    "  --jitter-ms MS   up to this much more\n"
    "\n"
    "  --help           print this and exit\n"
    "  --version        print the version and exit\n"
    "\n"
    "When it is ready it prints one line, 'roburoc4-sim: ready on ADDRESS:PORT...', with\n"
    "one address for each robot. SIGINT and SIGTERM end it.\n"
    "Exit status: 0 ended on request, 1 cannot listen, 2 bad usage.\n";

/* Prints to stderr what is wrong with an option's value; always false. */
static bool complain(const char *option, const char *value, const char *remedy) {
    (void)fprintf(stderr, "roburoc4-sim: %s %s: %s\n", option, value, remedy);
    return false;
}

/* ----------------------------------------------------------------------------- option values ---
 */

static bool set_bind(server_options *options, const char *option, const char *value) {
    if (!net_is_address(value)) {
        return complain(option, value, "give an IPv4 address in numbers, such as 127.0.0.1");
    }
    options->address = value;
    return true;
}

static bool whole(const char *value, uint64_t min, uint64_t max, uint64_t *out) {
    return number_whole(value, strlen(value), max, out) && *out >= min;
}

static bool set_port(server_options *options, const char *option, const char *value) {
    uint64_t port = 0;
    if (!whole(value, 0, 65535, &port)) {
        return complain(option, value, "give a port number of 0 to 65535");
    }
    options->port = (uint16_t)port;
    return true;
}

static bool set_robots(server_options *options, const char *option, const char *value) {
    uint64_t robots = 0;
    if (!whole(value, 1, MAX_ROBOTS, &robots)) {
        return complain(option, value, "give a whole number of 1 to 10000");
    }
    options->robots = (uint32_t)robots;
    return true;
}

static bool set_seed(server_options *options, const char *option, const char *value) {
    if (!whole(value, 0, UINT64_MAX, &options->config.seed)) {
        return complain(option, value, "give a whole number of 0 to 18446744073709551615");
    }
    return true;
}

static bool set_family(server_options *options, const char *option, const char *value) {
    uint64_t seed = 0;
    if (!whole(value, 0, MAX_FAMILY_SEED, &seed)) {
        return complain(option, value, "give a whole number of 0 to 9007199254740992");
    }
    (void)roburoc4_sim_config_family(&options->config, sizeof options->config, seed);
    options->family = value;
    return true;
}

/* As options, to repeat it without its seed. */
static void print_family(const server_options *options) {
    const sim_setting *setting;
    roburoc4_sim_config usual;
    (void)roburoc4_sim_config_init(&usual, sizeof usual);
    (void)printf("roburoc4-sim: family %s:", options->family);
    for (uint32_t index = 0; (setting = sim_setting_at(index)) != NULL; index++) {
        double drawn = sim_setting_get(&options->config, setting);
        double usually = sim_setting_get(&usual, setting);
        if (drawn < usually || drawn > usually) {
            (void)printf(setting->kind == SIM_FLOAT ? " --%s %.7g" : " --%s %.16g", setting->name,
                         drawn);
        }
    }
    (void)printf("\n");
}

static bool set_share(server_options *options, const char *option, const char *value) {
    roburoc4_sim_faults *faults = &options->faults;
    double *share = strcmp(option, "--loss") == 0        ? &faults->loss
                    : strcmp(option, "--duplicate") == 0 ? &faults->duplicate
                    : strcmp(option, "--reorder") == 0   ? &faults->reorder
                                                         : &faults->corrupt;
    if (!number_decimal(value, strlen(value), 0.0, 1.0, share)) {
        return complain(option, value, "give a share of 0 to 1, such as 0.05");
    }
    return true;
}

static bool set_time(server_options *options, const char *option, const char *value) {
    double ms = 0.0;
    if (!number_decimal(value, strlen(value), 0.0, MAX_TIME_MS, &ms)) {
        return complain(option, value, "give milliseconds, 0 to 60000");
    }
    uint32_t us = (uint32_t)(ms * 1000.0 + 0.5);
    if (strcmp(option, "--delay-ms") == 0) {
        options->faults.delay_us = us;
    } else {
        options->faults.jitter_us = us;
    }
    return true;
}

static bool take_text(server_options *options, const char *option, const char *path,
                      const char *text, size_t length) {
    char error[160];
    if (strcmp(option, "--config") == 0) {
        return sim_config_read(&options->config, text, length, error, sizeof error) >= 0 ||
               complain(option, path, error);
    }
    roburoc4_robot_file file;
    const char *remedy = NULL;
    uint32_t line = 0;
    if (roburoc4_robot_file_read(&file, text, length, &line, &remedy) < 0) {
        (void)snprintf(error, sizeof error, "line %u: %s", (unsigned)line, remedy);
        return complain(option, path, error);
    }
    roburoc4_sim_config_robot_file(&options->config, &file);
    return true;
}

static bool read_text(server_options *options, const char *option, const char *path, FILE *file) {
    char *text = malloc(MAX_CONFIG_BYTES);
    if (text == NULL) {
        return complain(option, path, "out of memory");
    }
    size_t length = fread(text, 1, MAX_CONFIG_BYTES, file);
    bool good = false;
    if (ferror(file) != 0) {
        (void)complain(option, path, "cannot be read; give a text file");
    } else if (length == MAX_CONFIG_BYTES) {
        (void)complain(option, path, "is larger than 1 MiB; give such a file");
    } else {
        good = take_text(options, option, path, text, length);
    }
    free(text);
    return good;
}

static bool set_file(server_options *options, const char *option, const char *value) {
    FILE *file = fopen(value, "rb");
    if (file == NULL) {
        return complain(option, value, "cannot be opened; give the path of a readable file");
    }
    bool good = read_text(options, option, value, file);
    (void)fclose(file);
    return good;
}

/* Whether an option, such as --start-safe, is a member of the configuration: start_safe. */
static bool is_setting(const char *option, size_t length, char name[MAX_SETTING]) {
    roburoc4_sim_config unused;
    (void)roburoc4_sim_config_init(&unused, sizeof unused);
    if (length < 2 || length - 2 >= MAX_SETTING || strncmp(option, "--", 2) != 0) {
        return false;
    }
    for (size_t at = 2; at < length; at++) {
        name[at - 2] = option[at] == '-' ? '_' : option[at];
    }
    name[length - 2] = '\0';
    return sim_config_set(&unused, name, 0.0) != ROBUROC4_ERR_INDEX;
}

static bool set_setting(server_options *options, const char *name, const char *value) {
    double number = 0.0;
    if (!number_decimal(value, strlen(value), -1e18, 1e18, &number) ||
        sim_config_set(&options->config, name, number) < 0) {
        return complain(name, value, "give a number that fits it");
    }
    return true;
}

/* -------------------------------------------------------------------------------- command line ---
 */

typedef struct option {
    const char *name;
    bool (*set)(server_options *options, const char *option, const char *value);
} option;

static const option with_value[] = {
    {"--bind", set_bind},       {"--port", set_port},      {"--robots", set_robots},
    {"--config", set_file},     {"--seed", set_seed},      {"--loss", set_share},
    {"--duplicate", set_share}, {"--reorder", set_share},  {"--corrupt", set_share},
    {"--delay-ms", set_time},   {"--jitter-ms", set_time}, {"--family", set_family},
    {"--robot-file", set_file},
};

static const option *find_option(const char *argument, size_t length) {
    for (size_t index = 0; index < sizeof with_value / sizeof with_value[0]; index++) {
        if (strlen(with_value[index].name) == length &&
            strncmp(argument, with_value[index].name, length) == 0) {
            return &with_value[index];
        }
    }
    return NULL;
}

/* Read one option, `--name value` or `--name=value`, and step over it. */
static bool read_option(server_options *options, char **arguments, int *at) {
    char setting[MAX_SETTING];
    const char *argument = arguments[*at];
    const char *next = arguments[*at + 1];
    size_t length = strcspn(argument, "=");
    if (strcmp(argument, "--panel") == 0) {
        options->panel = true;
        return true;
    }
    const option *found = find_option(argument, length);
    if (found == NULL && !is_setting(argument, length, setting)) {
        (void)fprintf(stderr, "roburoc4-sim: unknown option '%s': try --help\n", argument);
        return false;
    }
    const char *value = argument[length] == '=' ? argument + length + 1 : NULL;
    if (value == NULL && next != NULL && (found != NULL || strncmp(next, "--", 2) != 0)) {
        value = next;
        ++*at;
    }
    if (found == NULL) {
        return set_setting(options, setting, value != NULL ? value : "1");
    }
    if (value == NULL) {
        (void)fprintf(stderr, "roburoc4-sim: %s needs a value: try --help\n", found->name);
        return false;
    }
    return found->set(options, found->name, value);
}

static bool is_consistent(const server_options *options) {
    const char *error = roburoc4_sim_config_error(&options->config);
    if (error != NULL) {
        (void)fprintf(stderr, "roburoc4-sim: %s\n", error);
        return false;
    }
    if (options->port != 0 && options->port + options->robots - 1 > 65535) {
        (void)fprintf(
            stderr,
            "roburoc4-sim: %u robots from port %u on need ports above 65535: give a lower "
            "--port or fewer --robots\n",
            options->robots, options->port);
        return false;
    }
    return true;
}

int main(int count, char **arguments) {
    server_options options;
    memset(&options, 0, sizeof options);
    options.address = "127.0.0.1";
    options.port = ROBUROC4_DEFAULT_PORT;
    options.robots = 1;
    options.faults.size = sizeof options.faults;
    (void)roburoc4_sim_config_init(&options.config, sizeof options.config);
    for (int at = 1; at < count; at++) {
        if (strcmp(arguments[at], "--help") == 0 || strcmp(arguments[at], "-h") == 0) {
            (void)fputs(help, stdout);
            return 0;
        }
        if (strcmp(arguments[at], "--version") == 0) {
            (void)printf("roburoc4-sim %d.%d.%d\n", ROBUROC4_VERSION_MAJOR, ROBUROC4_VERSION_MINOR,
                         ROBUROC4_VERSION_PATCH);
            return 0;
        }
        if (!read_option(&options, arguments, &at)) {
            return USAGE_ERROR;
        }
    }
    if (!is_consistent(&options)) {
        return USAGE_ERROR;
    }
    if (options.family != NULL) {
        print_family(&options);
    }
    return server_run(&options);
}
