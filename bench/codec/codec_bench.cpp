/* SPDX-License-Identifier: MIT
 *
 * codec_bench: nanoseconds for encoding and decoding each message by each peer. Takes the options
 * of Google Benchmark (--help).
 */
#include "messages.h"

#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

constexpr size_t longest = 300;

void encode(benchmark::State &state, message_codec codec) {
    uint8_t buffer[longest];
    for (auto _ : state) {
        benchmark::DoNotOptimize(codec.encode(buffer, sizeof buffer));
        benchmark::ClobberMemory();
    }
}

void decode(benchmark::State &state, message_codec codec) {
    uint8_t wire[longest];
    const size_t size = codec.encode(wire, sizeof wire);
    for (auto _ : state) {
        benchmark::DoNotOptimize(codec.decode(wire, size));
        benchmark::ClobberMemory();
    }
    state.counters["bytes"] = static_cast<double>(size);
}

/** A codec that is fast and wrong shall not be measured. */
void must_be_right(const message_codec &codec) {
    uint8_t wire[longest];
    const size_t size = codec.encode(wire, sizeof wire);
    if (size == 0 || !codec.decode(wire, size) || !codec.intact()) {
        std::fprintf(stderr, "codec_bench: %s of %s does not come out as it went in\n",
                     codec.message, codec.peer);
        std::exit(1);
    }
}

} // namespace

int main(int argc, char **argv) {
    for (const message_codec &codec : all_codecs()) {
        const std::string name = std::string("/") + codec.message + "/" + codec.peer;
        must_be_right(codec);
        benchmark::RegisterBenchmark(("encode" + name).c_str(), encode, codec);
        benchmark::RegisterBenchmark(("decode" + name).c_str(), decode, codec);
    }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
        return 2;
    }
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
