/* SPDX-License-Identifier: MIT
 *
 * INI files: `[Section]` and `name = value` lines, comments after ; or #. The robot's own file,
 * udpserver.cfg, is one, and so are those of roburoc4-sim and roburoc4-lcm.
 */
#ifndef ROBUROC4_INI_H
#define ROBUROC4_INI_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A part of the file's text, without a NUL. */
typedef struct ini_text {
    const char *at;
    size_t length;
} ini_text;

/* One line that is neither empty nor a comment. */
typedef struct ini_line {
    unsigned number;  /* from 1 on */
    ini_text section; /* "" before the first one */
    ini_text name;    /* "" where the line begins the section */
    ini_text value;   /* at is NULL where the line has no = */
} ini_line;

/* Takes a line. False ends the reading; `error` is what is wrong with the line. */
typedef bool (*ini_handler)(void *user, const ini_line *line, char *error, size_t capacity);

/* Hand on each line. Returns 0, or the number of the first line that is wrong; then `error`
 * (capacity bytes, may be NULL with 0) says why. */
unsigned ini_read(const char *text, size_t length, ini_handler handle, void *user, char *error,
                  size_t capacity);

/* Whether a part reads like this; with `any_case`, in capitals or not. */
bool ini_is(ini_text text, const char *wanted, bool any_case);

#ifdef __cplusplus
}
#endif

#endif
