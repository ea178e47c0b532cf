/* SPDX-License-Identifier: MIT
 *
 * lcm_bus.h - what the tests need of the bridge and of the LCM network in virtual time.
 */
#ifndef ROBUROC4_TESTS_VIRTUAL_LCM_BUS_H
#define ROBUROC4_TESTS_VIRTUAL_LCM_BUS_H

#ifdef __cplusplus
extern "C" {
#endif

/* The bridge's main(), and what makes it as if it had never run. */
int bridge_main(int count, char **arguments);
void bridge_forget(void);
/* As the system calls its handler. */
void bridge_signal(int number);

#ifdef __cplusplus
}
#endif

#endif
