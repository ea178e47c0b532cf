/* SPDX-License-Identifier: MIT
 *
 * port.h - what each kind of target lends to the walk (port_*.c).
 */
#ifndef ROBUROC4_TESTS_PORTABLE_PORT_H
#define ROBUROC4_TESTS_PORTABLE_PORT_H

void port_begin(void);
void port_put(char character);
/** Ends the program with success (0) or failure; does not return. */
void port_end(int status);

#endif
