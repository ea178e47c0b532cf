/* SPDX-License-Identifier: MIT */
#include "text.h"

#include <stdlib.h>
#include <string.h>

static bool is_continuation(uint8_t byte) {
    return (byte & 0xC0u) == 0x80u;
}

/* Bytes of the UTF-8 character at the start of a text, or 0 if there is none. */
static size_t character(const uint8_t *text, size_t length) {
    uint8_t lead = text[0];
    size_t size = lead < 0x80 ? 1 : lead < 0xC2 ? 0 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
    if (lead == 0 || lead > 0xF4 || size == 0 || size > length) {
        return 0;
    }
    for (size_t at = 1; at < size; at++) {
        if (!is_continuation(text[at])) {
            return 0;
        }
    }
    /* Overlong forms, surrogates, and code points beyond Unicode. */
    bool bad = (lead == 0xE0 && text[1] < 0xA0) || (lead == 0xED && text[1] > 0x9F) ||
               (lead == 0xF0 && text[1] < 0x90) || (lead == 0xF4 && text[1] > 0x8F);
    return bad ? 0 : size;
}

bool text_is_utf8(const uint8_t *text, size_t length) {
    for (size_t at = 0; at < length;) {
        size_t size = character(text + at, length - at);
        if (size == 0) {
            return false;
        }
        at += size;
    }
    return true;
}

static size_t until_nul(const uint8_t *text, size_t length) {
    const uint8_t *end = length > 0 ? memchr(text, 0, length) : NULL;
    return end != NULL ? (size_t)(end - text) : length;
}

void text_copy(char *room, size_t capacity, const uint8_t *text, size_t length) {
    size_t written = 0;
    length = until_nul(text, length);
    bool utf8 = text_is_utf8(text, length);
    for (size_t at = 0; at < length;) {
        uint8_t two[2] = {(uint8_t)(0xC0u | text[at] >> 6), (uint8_t)(0x80u | (text[at] & 0x3Fu))};
        bool latin = !utf8 && text[at] >= 0x80;
        size_t size = utf8 ? character(text + at, length - at) : 1;
        size_t needed = latin ? 2 : size;
        if (written + needed >= capacity) {
            break;
        }
        memcpy(room + written, latin ? two : text + at, needed);
        written += needed;
        at += size;
    }
    room[written] = '\0';
}

void text_for_terminal(char *room, size_t capacity, const char *text, size_t length) {
    size_t at = 0;
    bool after_c2 = false; /* U+0080 to U+009F are control characters, too */
    for (; at < length && at + 1 < capacity && text[at] != '\0'; at++) {
        uint8_t byte = (uint8_t)text[at];
        bool control = byte < 0x20 || byte == 0x7F || (after_c2 && byte < 0xA0);
        room[at] = control ? '?' : text[at];
        if (control && after_c2) {
            room[at - 1] = '?';
        }
        after_c2 = byte == 0xC2;
    }
    room[at] = '\0';
}

bool text_number(const char **text, uint32_t max, uint32_t *out) {
    size_t length = strspn(*text, "0123456789");
    if (length == 0 || length > 9) {
        return false;
    }
    *out = (uint32_t)strtoul(*text, NULL, 10);
    *text += length;
    return *out <= max;
}
