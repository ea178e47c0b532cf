/* SPDX-License-Identifier: MIT */
#include "log.h"

#include <stdarg.h>
#include <stdio.h>

static enum log_level highest = LOG_NOTE;

void log_set_level(enum log_level level) {
    highest = level;
}

void log_line(enum log_level level, const char *robot, const char *format, ...) {
    char text[600];
    if (level > highest) {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    /* One call for one line, so that lines of several programs do not mix. */
    if (robot != NULL && robot[0] != '\0') {
        (void)fprintf(stderr, "roburoc4-lcm: %s: %s\n", robot, text);
    } else {
        (void)fprintf(stderr, "roburoc4-lcm: %s\n", text);
    }
}
