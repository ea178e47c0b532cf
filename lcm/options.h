/* SPDX-License-Identifier: MIT
 *
 * The bridge's command line.
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

#define OPTIONS_MAX_ROBOTS 32
#define OPTIONS_ERROR_SIZE 320

typedef struct options_robot {
    char name[32];    /* "" where it was not given */
    const char *host; /* as given */
    roburoc4_address address;
    channel_names channels;
} options_robot;

typedef struct options {
    const char *lcm_url; /* NULL: LCM's own default */
    options_robot robots[OPTIONS_MAX_ROBOTS];
    uint32_t robot_count;
    gate_rules rules;
    roburoc4_config config; /* with periods and subscriptions */
    enum log_level level;
} options;

enum options_result { OPTIONS_RUN, OPTIONS_HELP, OPTIONS_VERSION, OPTIONS_BAD, OPTIONS_NO_ADDRESS };

/* Read the command line. With OPTIONS_BAD `error` is what is wrong and what to do. */
enum options_result options_read(int count, char **arguments, options *out, char *error,
                                 size_t error_size);
/* The URL that LCM is going to use, "" for its own default, and where it is from: "--lcm-url" or
 * the variable's name. */
const char *options_lcm_url(const options *options, const char **source);
/* Turn the robots' names into addresses: OPTIONS_RUN, _BAD (a port that is none, or two robots with
 * one address), or _NO_ADDRESS. Asks the name server where there are names. */
enum options_result options_resolve(options *out, char *error, size_t error_size);
/* What --help prints. */
extern const char options_help[];

#ifdef __cplusplus
}
#endif

#endif
