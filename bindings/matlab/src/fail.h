/* SPDX-License-Identifier: MIT
 *
 * fail.h - the error of a call, kept until everything is cleaned up.
 *
 * Raising an error does not return. So commands only note the error, and mexFunction() raises it as
 * its very last action.
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
/** 1; or 0 after noting the meaning of a negative result of the library, and the remedy, after
 * `what`. */
int done(const char *what, roburoc4_result result);
/** Raise the noted error, and do not return. */
void fail_raise(void);

#endif
