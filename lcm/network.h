/* SPDX-License-Identifier: MIT
 *
 * Which LCM networks the bridge can use, by their URLs.
 */
#ifndef ROBUROC4_LCM_NETWORK_H
#define ROBUROC4_LCM_NETWORK_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What to give instead of this URL; NULL: the bridge can use it. "" is LCM's default. LCM's
 * networks tcpq and file can block inside LCM: then no stop would be sent, and signals would not be
 * noticed. A file is a log, which must not drive. */
const char *network_remedy(const char *url);
/* The port of this network; 0 if it has none. */
uint16_t network_port(const char *url);

#ifdef __cplusplus
}
#endif

#endif
