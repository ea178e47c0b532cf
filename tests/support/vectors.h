/* SPDX-License-Identifier: MIT
 *
 * vectors.h - one telegram of each kind as bytes, worked out by hand from the manual. The codec is
 * tested on them in both directions (codec_vectors_test.cpp), and docs/PROTOCOL.md shows exactly
 * these (protocol_doc_test.cpp).
 */
#ifndef ROBUROC4_TESTS_VECTORS_H
#define ROBUROC4_TESTS_VECTORS_H

#include <stdexcept>
#include <string>

#include "hex.h"

namespace roburoc4_tests {

struct Vector {
    const char *name;
    const char *section; /* of the manual; "" where it is known from other robots only */
    const char *values;
    const char *hex;
};

inline constexpr Vector vectors[] = {
    /* clang-format off */
/* ------------------------------------------------------------------------- requests --- */
{"get", "4.2.2.1", "id 1, service 6", "01 00 06 00"},
{"query-directory", "4.2.3.1", "id 42, element 3", "2A 01 00 00  03 00"},
{"query-analog-input", "4.2.3.3", "id 43, service 2, channel 8",
    "2B 01 02 00  00  08 00 00 00"},
{"query-analog-output", "4.2.3.3", "id 44, service 2, channel 1",
    "2C 01 02 00  01  01 00 00 00"},
{"query-digital-input", "4.2.3.3", "id 45, service 2, channel 8",
    "2D 01 02 00  02  08 00 00 00"},
{"query-digital-output", "4.2.3.3", "id 46, service 2, channel 7",
    "2E 01 02 00  03  07 00 00 00"},
{"insert", "4.2.4.1", "id 47, service 6 every 5 cycles", "2F 04 01 00  06 00  05"},
{"delete", "", "id 48, service 6", "30 05 01 00  06 00"},
{"replace-localization", "4.2.6.5", "id 49, service 5, cycle 12345, x 10, y -4.5, theta 1.5",
    "31 02 05 00  39 30 00 00 00 00 00 00"
    "00 00 00 00 00 00 24 40  00 00 00 00 00 00 12 C0  00 00 00 00 00 00 F8 3F"},
/* ------------------------------------------------------------------ property answers --- */
{"directory", "4.2.2.2", "id 1, seven services, ids 0 to 6 (type codes are examples)",
    "01 00 00 00 00"
    "00 00 00 00  00 00 01 00  01 40 02 00  08 40 03 00  00 00 04 00  02 80 05 00  05 40 06 00"},
{"notification", "4.2.2.3", "id 1, service 6 every 5 cycles, 2 every 10, 4 every 100",
    "01 00 01 00 00  06 00 05  02 00 0A  04 00 64"},
{"iocard-properties", "4.2.2.4", "id 1, 9 AI, 0 AO, 22 DI, 8 DO",
    "01 00 02 00 00  09 00 00 00  00 00 00 00  16 00 00 00  08 00 00 00"},
{"telemeter-properties", "4.2.2.5",
    "id 1; front: x 0.625, y 0, theta 0, field 0.5, 0.25 to 4 m, sees 1.5 m;"
    " rear: x -0.625, y 0.125, theta pi, field 0.75, 0.1875 to 3.5 m, sees 2.25 m",
    "01 00 03 00 00  02 00 00 00"
    "00 00 20 3F  00 00 00 00  00 00 00 00  00 00 00 3F  00 00 80 3E  00 00 80 40  00 00 C0 3F"
    "00 00 20 BF  00 00 00 3E  DB 0F 49 40  00 00 40 3F  00 00 40 3E  00 00 60 40  00 00 10 40"},
{"battery-properties", "4.2.2.6", "id 1, 24 V, 40 Ah, minimum 20 %",
    "01 00 04 00 00  00 00 C0 41  00 00 20 42  14"},
{"localization-properties", "4.2.2.7", "id 1, x 1.5, y -2.25, theta 0.5, flags 0x12",
    "01 00 05 00 00"
    "00 00 00 00 00 00 F8 3F  00 00 00 00 00 00 02 C0  00 00 00 00 00 00 E0 3F  12 00 00 00"},
{"differential-properties", "4.2.2.8",
    "id 1, target 0.5 and -0.25, current 0.4375 and -0.125, speed -1.3 to 2.6, turn rate -3.25 to"
    " 6.5, acceleration -3 to 2, angular -10 to 8, width 0.68",
    "01 00 06 00 00  00 00 00 3F  00 00 80 BE  00 00 E0 3E  00 00 00 BE"
    "66 66 26 40  66 66 A6 BF  00 00 D0 40  00 00 50 C0"
    "00 00 00 40  00 00 40 C0  00 00 00 41  00 00 20 C1  7B 14 2E 3F"},
/* --------------------------------------------------------------------- other answers --- */
{"text-directory", "4.2.3.1", "id 42, \"Differential\"",
    "2A 01 00 00 00  44 69 66 66 65 72 65 6E 74 69 61 6C"},
{"text-iocard", "4.2.3.3", "id 45, service 2, \"Game pad \"A\" button\"",
    "2D 01 02 00 00  47 61 6D 65 20 70 61 64 20 22 41 22 20 62 75 74 74 6F 6E"},
{"insert-answer", "4.2.4.1", "id 47, no error", "2F 04 01 00 00"},
{"delete-answer", "", "id 48, no error", "30 05 01 00 00"},
{"replace-answer", "", "id 49, service 5, no error", "31 02 05 00 00"},
{"error-answer", "4.2.4.2", "id 50, INSERT, error 5", "32 04 01 00 05"},
{"error-telegram", "", "GET of service 9, error 1", "00 00 09 00 01"},
/* -------------------------------------------------------------------------- statuses --- */
{"iocard-status", "4.2.4.4",
    "cycle 360000; analog 0.75, 1.25, 25.5, -1, -0.5, 0, 0.5, 1, -0.25; digital 0, 8, 21 set",
    "FF 02 00  40 7E 05 00 00 00 00 00"
    "00 00 40 3F  00 00 A0 3F  00 00 CC 41  00 00 80 BF  00 00 00 BF"
    "00 00 00 00  00 00 00 3F  00 00 80 3F  00 00 80 BE  01 01 20"},
{"telemeter-status", "4.2.4.5", "cycle 360000, 1.5 and 2.25 m",
    "FF 03 00  40 7E 05 00 00 00 00 00  00 00 C0 3F  00 00 10 40"},
{"battery-status", "4.2.4.6", "cycle 360000, Ok, 87 %",
    "FF 04 00  40 7E 05 00 00 00 00 00  02 57"},
{"localization-status", "4.2.4.7", "cycle 360000, x -3.5, y 0.125, theta -1.75, flags 0x14",
    "FF 05 00  40 7E 05 00 00 00 00 00"
    "00 00 00 00 00 00 0C C0  00 00 00 00 00 00 C0 3F  00 00 00 00 00 00 FC BF  14 00 00 00"},
{"differential-status", "4.2.4.8", "cycle 360000, linear 0.5 and 0.4375, turn -0.25 and -0.125",
    "FF 06 00  40 7E 05 00 00 00 00 00  00 00 00 3F  00 00 E0 3E  00 00 80 BE  00 00 00 BE"},
/* -------------------------------------------------------------------------- commands --- */
{"differential-command", "4.2.5.6", "0.5 m/s, -0.25 rad/s",
    "FF 06 00  00 00 00 3F  00 00 80 BE"},
{"iocard-command", "4.2.5.2", "no analog output, digital 1 and 7 set of 8", "FF 02 00  82"},
    /* clang-format on */
};

/** The bytes of the vector with this name. */
inline Bytes vector_bytes(const std::string &name) {
    for (const Vector &vector : vectors) {
        if (name == vector.name)
            return from_hex(vector.hex);
    }
    throw std::invalid_argument("no vector is named " + name);
}

} // namespace roburoc4_tests

#endif
