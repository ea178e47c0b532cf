/* SPDX-License-Identifier: MIT
 *
 * fail.h - why a call failed, kept until nothing is left to be given back.
 *
 * Raising an error does not return. So commands only note what went wrong, and
 * mexFunction() raises it as the very last thing that it does.
 */
#ifndef ROBUROC4_MEX_FAIL_H
#define ROBUROC4_MEX_FAIL_H

#include "roburoc4.h"

#define FAIL_ARGUMENT "roburoc4:badArgument"
#define FAIL_CLOSED "roburoc4:closed"
#define FAIL_LIMIT "roburoc4:limit"
#define FAIL_NETWORK "roburoc4:network"
#define FAIL_NOT_ARMED "roburoc4:notArmed"
#define FAIL_PROTOCOL "roburoc4:protocol"
#define FAIL_TIMEOUT "roburoc4:timeout"

/** Note an error with its id. Returns 0, for `return fail(...)` in a command. */
#ifdef __GNUC__
__attribute__((format(printf, 2, 3)))
#endif
int fail(const char *id, const char *format, ...);
/** Note what a negative result of the library means, and the remedy. `what` is put before it. 0. */
int fail_result(const char *what, roburoc4_result result);
/** The id and the text of what was noted. */
const char *fail_id(void);
const char *fail_text(void);

#endif
