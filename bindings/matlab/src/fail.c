/* SPDX-License-Identifier: MIT
 *
 * The error ids of results.
 */
#include "fail.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "mex.h"

static const char *noted_id = FAIL_PROTOCOL;
static char noted_text[2560];

static const struct {
    roburoc4_result result;
    const char *id;
} ids[] = {
    {ROBUROC4_ERR_ARGUMENT, FAIL_ARGUMENT}, {ROBUROC4_ERR_CONFIG, FAIL_ARGUMENT},
    {ROBUROC4_ERR_STATE, FAIL_ARGUMENT},    {ROBUROC4_ERR_INDEX, FAIL_ARGUMENT},
    {ROBUROC4_ERR_RESERVED, FAIL_ARGUMENT}, {ROBUROC4_ERR_NOT_FINITE, FAIL_ARGUMENT},
    {ROBUROC4_ERR_TIMEOUT, FAIL_TIMEOUT},   {ROBUROC4_ERR_SYSTEM, FAIL_NETWORK},
    {ROBUROC4_ERR_RESOLVE, FAIL_NETWORK},   {ROBUROC4_ERR_CLOSED, FAIL_CLOSED},
    {ROBUROC4_ERR_LIMITS, FAIL_LIMIT},
};

static const char *id_of(roburoc4_result result) {
    for (size_t i = 0; i < sizeof ids / sizeof *ids; i++) {
        if (ids[i].result == result) {
            return ids[i].id;
        }
    }
    return result <= ROBUROC4_ERR_DISARMED && result >= ROBUROC4_ERR_INHIBITED ? FAIL_NOT_ARMED
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

int done(const char *what, roburoc4_result result) {
    const char *text = roburoc4_result_text(result);
    const size_t cause = strcspn(text, ":"); /* a remedy follows */
    return result >= 0 ||
           fail(id_of(result), "%s: %.*s%s%s", what, (int)cause, text,
                text[cause] != '\0' ? ";" : "", text[cause] != '\0' ? text + cause + 1 : "");
}

/* In Octave, mexErrMsgIdAndTxt() would put the name of this file before the message. */
void fail_raise(void) {
    mxArray *arguments[] = {mxCreateString(noted_id), mxCreateString("%s"),
                            mxCreateString(noted_text)};
    (void)mexCallMATLAB(0, NULL, 3, arguments, "error");
}
