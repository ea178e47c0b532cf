/* SPDX-License-Identifier: MIT
 *
 * vectors.h - one telegram of each kind as bytes, worked out by hand from the manual, read from
 * conformance/telegrams.json. The codec is tested on them in both directions
 * (codec_vectors_test.cpp), and docs/PROTOCOL.md shows some (protocol_doc_test.cpp).
 */
#ifndef ROBUROC4_TESTS_VECTORS_H
#define ROBUROC4_TESTS_VECTORS_H

#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "hex.h"

namespace roburoc4_tests {

struct Vector {
    std::string name, hex;
};

/** The string that belongs to a key, the next behind `at`, which is moved behind it. */
inline std::string next_string(const std::string &json, const std::string &key, std::size_t &at) {
    const std::string opening = "\"" + key + "\": \"";
    at = json.find(opening, at);
    if (at == json.npos)
        return "";
    const std::size_t begin = at + opening.size();
    at = json.find('"', begin);
    return json.substr(begin, at - begin);
}

inline std::vector<Vector> read_vectors() {
    std::ifstream file(ROBUROC4_SOURCE_DIR "/tests/conformance/telegrams.json");
    const std::string json{std::istreambuf_iterator<char>(file), {}};
    std::vector<Vector> read;
    std::size_t at = 0;
    for (std::string name; !(name = next_string(json, "name", at)).empty();)
        read.push_back({name, next_string(json, "bytes", at)});
    if (read.empty())
        throw std::runtime_error("telegrams.json cannot be read");
    return read;
}

inline const std::vector<Vector> vectors = read_vectors();

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
