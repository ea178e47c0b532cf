/* SPDX-License-Identifier: MIT
 *
 * codec_count: under callgrind, how many instructions each message takes in each peer. Callgrind
 * writes one profile for each, named in its "Trigger" line; see bench/measure_codec.py.
 */
#include "messages.h"

#include <valgrind/callgrind.h>

#include <cstdio>
#include <string>

namespace {

constexpr int repetitions = 1000;

/** What the counting itself costs: a call that does nothing. */
message_codec nothing() {
    return {"nothing", "call", [](uint8_t *, size_t) -> size_t { return 0; },
            [](const uint8_t *, size_t) { return true; }, [] { return true; }};
}

void count(const message_codec &codec) {
    uint8_t wire[300];
    const std::string name = std::string("/") + codec.message + "/" + codec.peer;
    const std::string encode = "encode" + name;
    const std::string decode = "decode" + name;
    /* Once before, for what is done only the first time. */
    size_t size = codec.encode(wire, sizeof wire);
    codec.decode(wire, size);
    CALLGRIND_ZERO_STATS;
    for (int i = 0; i < repetitions; i++) {
        codec.encode(wire, sizeof wire);
    }
    CALLGRIND_DUMP_STATS_AT(encode.c_str());
    for (int i = 0; i < repetitions; i++) {
        codec.decode(wire, size);
    }
    CALLGRIND_DUMP_STATS_AT(decode.c_str());
}

} // namespace

int main() {
    if (RUNNING_ON_VALGRIND == 0) {
        std::fputs("codec_count: counts only under valgrind --tool=callgrind\n", stderr);
        return 2;
    }
    count(nothing());
    for (const message_codec &codec : all_codecs()) {
        count(codec);
    }
    return 0;
}
