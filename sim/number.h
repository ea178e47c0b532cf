/* SPDX-License-Identifier: MIT
 *
 * Decimal numbers in text. The whole text must be the number: no locale, no surrounding blanks, no
 * trailing characters.
 */
#ifndef ROBUROC4_SIM_NUMBER_H
#define ROBUROC4_SIM_NUMBER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A whole number of 0 to `max`. */
static inline bool number_whole(const char *text, size_t length, uint64_t max, uint64_t *out) {
    uint64_t value = 0;
    if (length == 0) {
        return false;
    }
    for (size_t at = 0; at < length; at++) {
        if (text[at] < '0' || text[at] > '9') {
            return false;
        }
        uint64_t digit = (uint64_t)(text[at] - '0');
        if (value > (max - digit) / 10 || digit > max) {
            return false;
        }
        value = value * 10 + digit;
    }
    *out = value;
    return true;
}

/* A decimal number such as -1.25, of `min` to `max`. */
static inline bool number_decimal(const char *text, size_t length, double min, double max,
                                  double *out) {
    double value = 0.0;
    double scale = 1.0;
    bool fraction = false;
    size_t digits = 0;
    size_t at = length > 0 && (text[0] == '-' || text[0] == '+') ? 1 : 0;
    for (; at < length; at++) {
        if (text[at] == '.' && !fraction) {
            fraction = true;
        } else if (text[at] >= '0' && text[at] <= '9' && digits < 18) {
            value = value * 10.0 + (double)(text[at] - '0');
            scale *= fraction ? 10.0 : 1.0;
            digits++;
        } else {
            return false;
        }
    }
    if (digits == 0) {
        return false;
    }
    value = (text[0] == '-' ? -value : value) / scale;
    if (value < min || value > max) {
        return false;
    }
    *out = value;
    return true;
}

#endif
