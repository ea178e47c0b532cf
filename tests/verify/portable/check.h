/* SPDX-License-Identifier: MIT
 *
 * check.h - what the parts of the portable runner share: a check that needs neither printf nor a
 * heap, and what each kind of target has to lend (port_*.c).
 */
#ifndef ROBUROC4_TESTS_PORTABLE_CHECK_H
#define ROBUROC4_TESTS_PORTABLE_CHECK_H

#include <stdint.h>

/** Count a check; print its part and line where it fails. PART is defined by each file. */
#define CHECK(condition) check((condition) ? 1 : 0, PART, __LINE__)
void check(int passed, const char *part, long line);

/** Failed checks so far. */
uint32_t failures(void);

void say(const char *text);
void say_number(uint32_t number);
void say_hex(uint32_t number);

/* The parts. */
void test_layout(void);
void test_vectors(void);
/** Gives a digest of all datagrams that left the client and of their times. */
uint32_t test_walk(void);

/* What a target lends. */
void port_begin(void);
void port_put(char character);
/** Ends the program with success (0) or failure; does not return. */
void port_end(int status);

#endif
