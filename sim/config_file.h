/* SPDX-License-Identifier: MIT
 *
 * The settings of roburoc4-sim, from its command line and a file.
 */
#ifndef ROBUROC4_SIM_CONFIG_FILE_H
#define ROBUROC4_SIM_CONFIG_FILE_H

#include "settings.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Read the text of a `udpserver.cfg` (4.2.5.6): an INI file of which `Watchdog` of the section
 * `DifferentialService` is used (in cycles of 10 ms), and the section `Simulator`, which the
 * robot's own file does not have: lines `NAME=VALUE` for sim_config_set(). Everything
 * else is skipped. ROBUROC4_ERR_VALUE: `error` (capacity bytes, may be NULL with 0) names line and
 * remedy, and the configuration is unchanged. */
roburoc4_result sim_config_read(roburoc4_sim_config *config, const char *text, size_t length,
                                char *error, size_t capacity);

#ifdef __cplusplus
}
#endif

#endif
