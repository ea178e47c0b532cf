/* SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "log.h"

#include <poll.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static enum log_level highest = LOG_NOTE;

void log_set_level(enum log_level level) {
    highest = level;
}

/* A pager that nobody scrolls, or a terminal that was stopped, must not hold up a robot's zeros:
 * what cannot be written at once is dropped. */
static void write_line(const char *line) {
    struct pollfd end = {.fd = STDERR_FILENO, .events = POLLOUT};
    if (poll(&end, 1, 0) == 1 && (end.revents & POLLOUT) != 0) {
        /* One call, so that lines of several programs do not mix. A failed one is a lost one. */
        ssize_t written = write(STDERR_FILENO, line, strlen(line));
        (void)written;
    }
}

void log_line(enum log_level level, const char *robot, const char *format, ...) {
    char text[600];
    char line[700];
    if (level > highest) {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    bool named = robot != NULL && robot[0] != '\0';
    (void)snprintf(line, sizeof line, "roburoc4-lcm: %s%s%s\n", named ? robot : "",
                   named ? ": " : "", text);
    write_line(line);
}
