/* SPDX-License-Identifier: MIT
 *
 * Which error id a result is, and what to do about it.
 */
#include "fail.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char *noted_id = FAIL_PROTOCOL;
static char noted_text[2560];

static const struct {
    roburoc4_result result;
    const char *remedy;
} remedies[] = {
    {ROBUROC4_ERR_RESERVED, "use output 1 or above"},
    {ROBUROC4_ERR_NOT_FINITE, "give finite numbers"},
    {ROBUROC4_ERR_UNKNOWN, "wait with spin(0.1) and look again"},
    {ROBUROC4_ERR_RESOLVE, "check the spelling, or give the address in numbers"},
    {ROBUROC4_ERR_CLOSED, "make a new one"},
    {ROBUROC4_ERR_DISARMED, "call arm() before drive()"},
    {ROBUROC4_ERR_NOT_READY, "wait until the robot answers, then call arm() again"},
    {ROBUROC4_ERR_NO_DIFFERENTIAL, "this robot cannot be driven; look at info"},
    {ROBUROC4_ERR_LIMITS, "look at the limits in info"},
    {ROBUROC4_ERR_STALE_DIFFERENTIAL, "check link and the status period, then call arm() again"},
    {ROBUROC4_ERR_STALE_IOCARD, "check link and the status period, then call arm() again"},
    {ROBUROC4_ERR_OVERRIDE_UNKNOWN,
     "name the input with the option override_index, or give up this protection with "
     "allow_unknown_override"},
    {ROBUROC4_ERR_OVERRIDE, "release [A] on the game pad, then call arm() again"},
    {ROBUROC4_ERR_MOVING, "wait until the robot stands still, then call arm() again"},
    {ROBUROC4_ERR_OTHER_COMMANDER, "end the other program, then call arm() again"},
    {ROBUROC4_ERR_LOST, "check cable and power, wait until it is ready, then call arm() again"},
    {ROBUROC4_ERR_REBOOT, "look at the robot, then call arm() again"},
    {ROBUROC4_ERR_CLOCK, "find out what sets this machine's clock, then call arm() again"},
};

static const char *remedy_of(roburoc4_result result) {
    size_t i;
    for (i = 0; i < sizeof remedies / sizeof remedies[0]; i++) {
        if (remedies[i].result == result) {
            return remedies[i].remedy;
        }
    }
    return NULL;
}

static const char *id_of(roburoc4_result result) {
    switch (result) {
    case ROBUROC4_ERR_ARGUMENT:
    case ROBUROC4_ERR_CONFIG:
    case ROBUROC4_ERR_STATE:
    case ROBUROC4_ERR_INDEX:
    case ROBUROC4_ERR_RESERVED:
    case ROBUROC4_ERR_NOT_FINITE:
        return FAIL_ARGUMENT;
    case ROBUROC4_ERR_TIMEOUT:
        return FAIL_TIMEOUT;
    case ROBUROC4_ERR_SYSTEM:
    case ROBUROC4_ERR_RESOLVE:
        return FAIL_NETWORK;
    case ROBUROC4_ERR_CLOSED:
        return FAIL_CLOSED;
    case ROBUROC4_ERR_LIMITS:
        return FAIL_LIMIT;
    default:
        break;
    }
    return result <= ROBUROC4_ERR_DISARMED && result > ROBUROC4_ERR_SYSTEM ? FAIL_NOT_ARMED
                                                                           : FAIL_PROTOCOL;
}

int fail(const char *id, const char *format, ...) {
    va_list arguments;
    noted_id = id;
    va_start(arguments, format);
    (void)vsnprintf(noted_text, sizeof noted_text, format, arguments);
    va_end(arguments);
    return 0;
}

int fail_result(const char *what, roburoc4_result result) {
    const char *text = roburoc4_result_text(result);
    const char *remedy = remedy_of(result);
    /* Reasons against arming bring a short remedy of their own, after a colon. */
    size_t length = remedy != NULL ? strcspn(text, ":") : strlen(text);
    return fail(id_of(result), "%s: %.*s%s%s", what, (int)length, text, remedy != NULL ? "; " : "",
                remedy != NULL ? remedy : "");
}

const char *fail_id(void) {
    return noted_id;
}

const char *fail_text(void) {
    return noted_text;
}
