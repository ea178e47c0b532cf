/* SPDX-License-Identifier: MIT
 *
 * vectors.h - the table of vector_rows.h for GoogleTest. The codec is tested on it in both
 * directions (codec_vectors_test.cpp) and docs/PROTOCOL.md shows exactly these
 * (protocol_doc_test.cpp).
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
#define VECTOR(name, section, values, hex) {name, section, values, hex},
#include "vector_rows.h"
#undef VECTOR
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
