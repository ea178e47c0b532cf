/* SPDX-License-Identifier: MIT
 *
 * lcm_bus.h - what the tests need of the bridge and of the LCM network in virtual time.
 */
#ifndef ROBUROC4_TESTS_VIRTUAL_LCM_BUS_H
#define ROBUROC4_TESTS_VIRTUAL_LCM_BUS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/resource.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the tests answer in the place of the system, and of a bridge that was built with an old LCM.
 */
int bridge_gethostname(char *name, size_t size);
int bridge_getrlimit(int resource, struct rlimit *out);
int bridge_setrlimit(int resource, const struct rlimit *limit);
extern bool bridge_lcm_is_old;

/* The bridge's main(), and what makes it as if it had never run. */
int bridge_main(int count, char **arguments);
void bridge_forget(void);
/* As the system calls its handler. */
void bridge_signal(int number);

#ifdef __cplusplus
}
#endif

#endif
