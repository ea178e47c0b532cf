/* SPDX-License-Identifier: MIT */
#include "ini.h"

#include <stdio.h>
#include <string.h>

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r';
}

static ini_text trim(const char *at, size_t length) {
    while (length > 0 && is_blank(at[0])) {
        at++;
        length--;
    }
    while (length > 0 && is_blank(at[length - 1])) {
        length--;
    }
    return (ini_text){at, length};
}

static size_t find(ini_text text, char wanted) {
    size_t at = 0;
    while (at < text.length && text.at[at] != wanted) {
        at++;
    }
    return at;
}

static ini_text without_comment(ini_text text) {
    size_t semicolon = find(text, ';');
    size_t hash = find(text, '#');
    return trim(text.at, semicolon < hash ? semicolon : hash);
}

static char lower(char c) {
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

bool ini_is(ini_text text, const char *wanted, bool any_case) {
    for (size_t at = 0; at < text.length; at++) {
        char mine = any_case ? lower(text.at[at]) : text.at[at];
        if (wanted[at] == '\0' || mine != (any_case ? lower(wanted[at]) : wanted[at])) {
            return false;
        }
    }
    return wanted[text.length] == '\0';
}

/* Take a line apart; `line->section` carries over from line to line. */
static bool split(ini_text text, ini_line *line, char *error, size_t capacity) {
    line->name = (ini_text){text.at, 0};
    line->value = (ini_text){NULL, 0};
    if (text.at[0] == '[') {
        size_t end = find(text, ']');
        if (end == text.length) {
            (void)snprintf(error, capacity, "a section's name ends with ]");
            return false;
        }
        line->section = trim(text.at + 1, end - 1);
        return true;
    }
    size_t equals = find(text, '=');
    line->name = trim(text.at, equals);
    if (equals < text.length) {
        line->value = without_comment((ini_text){text.at + equals + 1, text.length - equals - 1});
    }
    return true;
}

unsigned ini_read(const char *text, size_t length, ini_handler handle, void *user, char *error,
                  size_t capacity) {
    static const char byte_order_mark[] = "\xEF\xBB\xBF";
    ini_line line = {.section = {text, 0}};
    size_t at = length >= 3 && memcmp(text, byte_order_mark, 3) == 0 ? 3 : 0;
    while (at < length) {
        ini_text rest = {text + at, length - at};
        size_t end = find(rest, '\n');
        ini_text trimmed = trim(rest.at, end);
        bool empty = trimmed.length == 0 || trimmed.at[0] == ';' || trimmed.at[0] == '#';
        line.number++;
        if (!empty &&
            (!split(trimmed, &line, error, capacity) || !handle(user, &line, error, capacity))) {
            return line.number;
        }
        at += end + 1;
    }
    return 0;
}
