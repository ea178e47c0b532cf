/* SPDX-License-Identifier: MIT
 *
 * The bridge's command line and its configuration file.
 */
#ifndef ROBUROC4_LCM_OPTIONS_H
#define ROBUROC4_LCM_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "channels.h"
#include "gate.h"
#include "log.h"
#include "roburoc4_udp.h"

#ifdef __cplusplus
extern "C" {
#endif

#define OPTIONS_MAX_ROBOTS 1000
#define OPTIONS_ERROR_SIZE 400
#define OPTIONS_MAX_TEXT 255
#define OPTIONS_FLEET_STOP UINT32_MAX
#define OPTIONS_SERVICES 5

/* A robot and its own settings. */
typedef struct options_robot {
    char name[46];                   /* "" if it was not given */
    const char *prefix;              /* of its channels, if it has no name */
    char host[OPTIONS_MAX_TEXT + 1]; /* as given */
    unsigned line;                   /* in the file; 0: from the command line */
    roburoc4_address address;        /* family 0: the name has no address */
    channel_names channels;
    gate_rules rules;
    char allowed[OPTIONS_MAX_TEXT + 1]; /* patterns of senders; "": all */
    roburoc4_config config;             /* with periods and subscriptions */
} options_robot;

typedef struct options {
    char lcm_url[OPTIONS_MAX_TEXT + 1]; /* "": LCM's own default */
    const char *file;                   /* NULL: no file was read */
    char record[OPTIONS_MAX_TEXT + 1];  /* "": nothing is recorded */
    options_robot robots[OPTIONS_MAX_ROBOTS];
    uint32_t robot_count;
    char fleet_stop[CHANNEL_MAX_NAME + 1]; /* the channel that stops all robots; "": none */
    channels_directory directory; /* `which` is robot * CHANNELS + channel, or OPTIONS_FLEET_STOP */
    channels_entry entries[OPTIONS_MAX_ROBOTS * CHANNELS + 1];
    enum log_level level;
    bool check; /* only print what would run */
} options;

enum options_result { OPTIONS_RUN, OPTIONS_HELP, OPTIONS_VERSION, OPTIONS_BAD, OPTIONS_NO_ADDRESS };

/* Read the command line and the file that it names. With OPTIONS_BAD, `error` says what is wrong,
 * in which line of the file, and what to do. `out` must be all 0 at first. */
enum options_result options_read(int count, char **arguments, options *out, char *error,
                                 size_t error_size);
/* The same for the text of a file, called `name` in errors, without a command line. */
enum options_result options_read_text(const char *name, const char *text, size_t length,
                                      options *out, char *error, size_t error_size);
/* The URL that LCM will use ("" for its own default), and its source: "lcm-url" or the name of the
 * variable. */
const char *options_lcm_url(const options *options, const char **source);
/* Resolve the robots' names. Returns OPTIONS_RUN, _BAD (an invalid port, or two robots with one
 * address), or _NO_ADDRESS (for any robot). Asks the name server if there are names. */
enum options_result options_resolve(options *out, char *error, size_t error_size);
/* Whether commands of this sender (length bytes) may be obeyed, by --allow-sender. */
bool options_allows(const options_robot *robot, const char *sender, size_t length);
void options_print(const options *options);
extern const char options_help[];
/* By their names in --period-ms, from ROBUROC4_SERVICE_IOCARD on. */
extern const char *const options_services[OPTIONS_SERVICES];

#ifdef __cplusplus
}
#endif

#endif
