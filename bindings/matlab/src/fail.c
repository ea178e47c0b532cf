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
    const char *id, *remedy;
} known[] = {
    {ROBUROC4_ERR_ARGUMENT, FAIL_ARGUMENT, NULL},
    {ROBUROC4_ERR_CONFIG, FAIL_ARGUMENT, NULL},
    {ROBUROC4_ERR_STATE, FAIL_ARGUMENT, NULL},
    {ROBUROC4_ERR_INDEX, FAIL_ARGUMENT, NULL},
    {ROBUROC4_ERR_RESERVED, FAIL_ARGUMENT, "use output 1 or above"},
    {ROBUROC4_ERR_NOT_FINITE, FAIL_ARGUMENT, "give finite numbers"},
    {ROBUROC4_ERR_UNKNOWN, FAIL_PROTOCOL, "wait with spin(0.1) and look again"},
    {ROBUROC4_ERR_TIMEOUT, FAIL_TIMEOUT, "look at link, and try again"},
    {ROBUROC4_ERR_SYSTEM, FAIL_NETWORK, NULL},
    {ROBUROC4_ERR_RESOLVE, FAIL_NETWORK, "check the spelling, or give the address in numbers"},
    {ROBUROC4_ERR_CLOSED, FAIL_CLOSED, "make a new one"},
    {ROBUROC4_ERR_DISARMED, FAIL_NOT_ARMED, "call arm() before drive()"},
    {ROBUROC4_ERR_NOT_READY, FAIL_NOT_ARMED, "wait until the robot answers, then call arm() again"},
    {ROBUROC4_ERR_NO_DIFFERENTIAL, FAIL_NOT_ARMED, "this robot cannot be driven; look at info"},
    {ROBUROC4_ERR_LIMITS, FAIL_LIMIT, "look at the limits in info"},
    {ROBUROC4_ERR_STALE_DIFFERENTIAL, FAIL_NOT_ARMED,
     "check link and the status period, then call arm() again"},
    {ROBUROC4_ERR_STALE_IOCARD, FAIL_NOT_ARMED,
     "check link and the status period, then call arm() again"},
    {ROBUROC4_ERR_OVERRIDE_UNKNOWN, FAIL_NOT_ARMED,
     "name the input with the option override_index, or give up this protection with "
     "allow_unknown_override"},
    {ROBUROC4_ERR_OVERRIDE, FAIL_NOT_ARMED, "release [A] on the game pad, then call arm() again"},
    {ROBUROC4_ERR_MOVING, FAIL_NOT_ARMED,
     "wait until the robot stands still, then call arm() again"},
    {ROBUROC4_ERR_OTHER_COMMANDER, FAIL_NOT_ARMED, "end the other program, then call arm() again"},
    {ROBUROC4_ERR_LOST, FAIL_NOT_ARMED,
     "check cable and power, wait until it is ready, then call arm() again"},
    {ROBUROC4_ERR_REBOOT, FAIL_NOT_ARMED, "look at the robot, then call arm() again"},
    {ROBUROC4_ERR_CLOCK, FAIL_NOT_ARMED,
     "find out what sets this machine's clock, then call arm() again"},
    {ROBUROC4_ERR_INHIBITED, FAIL_NOT_ARMED,
     "look at emergency stops, brakes selector and bumpers, then call arm() again"},
};

int fail(const char *id, const char *format, ...) {
    va_list arguments;
    noted_id = id;
    va_start(arguments, format);
    (void)vsnprintf(noted_text, sizeof noted_text, format, arguments);
    va_end(arguments);
    return 0;
}

int fail_result(const char *what, roburoc4_result result) {
    const char *text = roburoc4_result_text(result), *id = FAIL_PROTOCOL, *remedy = NULL;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (known[i].result == result) {
            id = known[i].id;
            remedy = known[i].remedy;
        }
    }
    /* Reasons against arming bring a short remedy of their own, after a colon. */
    return remedy == NULL ? fail(id, "%s: %s", what, text)
                          : fail(id, "%s: %.*s; %s", what, (int)strcspn(text, ":"), text, remedy);
}

const char *fail_id(void) {
    return noted_id;
}

const char *fail_text(void) {
    return noted_text;
}
