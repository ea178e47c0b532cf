/* SPDX-License-Identifier: MIT
 *
 * client_bench: what a status costs on its way through the client's state machine, and through
 * many clients in one process. Takes the options of Google Benchmark (--help).
 */
#include "roburoc4.h"
#include "roburoc4_sim.h"

#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace {

using datagram = std::vector<uint8_t>;

/** A client that is ready and has all texts, and what a robot sends it. */
struct ready_client {
    roburoc4_client client;
    uint64_t now_us = 0;
    datagram statuses[ROBUROC4_SERVICE_COUNT];
};

bool complete(const ready_client &r) {
    roburoc4_facts facts;
    facts.size = sizeof facts;
    roburoc4_client_facts(&r.client, r.now_us, &facts);
    for (uint32_t s = ROBUROC4_SERVICE_IOCARD; s < ROBUROC4_SERVICE_COUNT; s++) {
        if (r.statuses[s].empty()) {
            return false;
        }
    }
    return facts.descriptions_done != 0 && facts.state == ROBUROC4_STATE_READY;
}

/** Let client and robot meet in virtual time. */
ready_client made_ready() {
    ready_client r;
    roburoc4_sim *robot = roburoc4_sim_create(nullptr);
    roburoc4_client_init(&r.client, sizeof r.client, nullptr);
    roburoc4_client_start(&r.client, 0);
    while (!complete(r)) {
        uint8_t buffer[ROBUROC4_SIM_MAX_TRANSMIT];
        uint64_t peer;
        r.now_us += 1000;
        if (r.now_us > 20000000) {
            std::fputs("client_bench: the client did not get ready with the simulated robot\n",
                       stderr);
            std::exit(1);
        }
        roburoc4_sim_advance(robot, r.now_us);
        while (size_t size = roburoc4_sim_poll_transmit(robot, &peer, buffer, sizeof buffer)) {
            if (buffer[0] == ROBUROC4_HEADER_STATUS && buffer[1] < ROBUROC4_SERVICE_COUNT) {
                r.statuses[buffer[1]].assign(buffer, buffer + size);
            }
            roburoc4_client_receive(&r.client, buffer, size, r.now_us);
        }
        int32_t size;
        while ((size = roburoc4_client_poll_transmit(&r.client, buffer, sizeof buffer, r.now_us)) >
               0) {
            roburoc4_sim_receive(robot, 1, buffer, static_cast<size_t>(size));
        }
    }
    roburoc4_sim_destroy(robot);
    return r;
}

const ready_client &ready() {
    static const ready_client r = made_ready();
    return r;
}

void set_cycles(datagram &status, uint64_t cycles) {
    for (unsigned i = 0; i < 8; i++) {
        status[3 + i] = static_cast<uint8_t>(cycles >> (8 * i));
    }
}

uint64_t cycles_of(const datagram &status) {
    roburoc4_status_header header;
    roburoc4_decode_status_header(status.data(), status.size(), &header);
    return header.robot_cycles;
}

void must_be(bool so, const char *what) {
    if (!so) {
        std::fprintf(stderr, "client_bench: %s\n", what);
        std::exit(1);
    }
}

/** Receive, and ask whether there is anything to send. */
int32_t receive_and_poll(roburoc4_client &client, const datagram &d, uint64_t now_us) {
    uint8_t buffer[ROBUROC4_MAX_TRANSMIT];
    const int32_t result = roburoc4_client_receive(&client, d.data(), d.size(), now_us);
    benchmark::DoNotOptimize(roburoc4_client_poll_transmit(&client, buffer, sizeof buffer, now_us));
    return result;
}

/** A newer status each time. */
void status(benchmark::State &state, uint32_t service) {
    ready_client r = ready();
    datagram d = r.statuses[service];
    uint64_t cycles = cycles_of(d) + 1000;
    int32_t result = 0;
    for (auto _ : state) {
        set_cycles(d, ++cycles);
        result = receive_and_poll(r.client, d, ++r.now_us);
    }
    must_be(result == 0, "a status was not used");
}

/** What is not used: the cost of saying no. */
void refused(benchmark::State &state, const datagram &d, int32_t expected) {
    ready_client r = ready();
    int32_t result = 0;
    for (auto _ : state) {
        result = receive_and_poll(r.client, d, ++r.now_us);
    }
    must_be(result == expected, "a datagram was not refused as it should be");
}

void nothing_due(benchmark::State &state) {
    ready_client r = ready();
    uint8_t buffer[ROBUROC4_MAX_TRANSMIT];
    while (roburoc4_client_poll_transmit(&r.client, buffer, sizeof buffer, r.now_us) > 0) {
    }
    for (auto _ : state) {
        benchmark::DoNotOptimize(
            roburoc4_client_poll_transmit(&r.client, buffer, sizeof buffer, r.now_us));
    }
}

/** A differential status through each of many clients in turn. */
void many(benchmark::State &state) {
    std::vector<roburoc4_client> clients(static_cast<size_t>(state.range(0)), ready().client);
    datagram d = ready().statuses[ROBUROC4_SERVICE_DIFFERENTIAL];
    uint64_t cycles = cycles_of(d) + 1000;
    uint64_t now_us = ready().now_us;
    size_t next = clients.size();
    int32_t result = 0;
    for (auto _ : state) {
        if (next == clients.size()) {
            next = 0;
            cycles++;
            now_us++;
        }
        set_cycles(d, cycles);
        result = receive_and_poll(clients[next++], d, now_us);
    }
    must_be(result == 0, "a status was not used");
}

/** The IO card with more and more analog inputs: cost against the length of a payload. */
void payload(benchmark::State &state) {
    const auto inputs = static_cast<size_t>(state.range(0));
    std::vector<float> analog(inputs, 1.5F);
    const uint8_t digital[3] = {1, 2, 3};
    datagram d(11 + 4 * inputs + 3);
    const int32_t size = roburoc4_encode_iocard_status(d.data(), d.size(), ROBUROC4_SERVICE_IOCARD,
                                                       1, analog.data(), inputs, digital, 22);
    uint32_t copied = 0;
    must_be(static_cast<size_t>(size) == d.size(), "a status was not encoded");
    for (auto _ : state) {
        roburoc4_channels s;
        if (roburoc4_decode_iocard_status(d.data(), d.size(), static_cast<uint32_t>(inputs), 22,
                                          &s) == ROBUROC4_OK) {
            copied = roburoc4_floats(s.analog, s.analog_count, analog.data(), s.analog_count);
        }
        benchmark::DoNotOptimize(analog.data());
        benchmark::ClobberMemory();
    }
    must_be(copied == inputs, "a status was not decoded");
    state.counters["bytes"] = static_cast<double>(d.size());
}

} // namespace

int main(int argc, char **argv) {
    for (uint32_t s = ROBUROC4_SERVICE_IOCARD; s < ROBUROC4_SERVICE_COUNT; s++) {
        benchmark::RegisterBenchmark(
            (std::string("status/") + roburoc4_name(ROBUROC4_NAME_SERVICE, s)).c_str(), status, s);
    }
    datagram foreign = ready().statuses[ROBUROC4_SERVICE_DIFFERENTIAL];
    foreign[1] = 77; /* a service that this robot does not have */
    benchmark::RegisterBenchmark("refused/another robot's status", refused, foreign,
                                 ROBUROC4_ERR_UNSUBSCRIBED);
    benchmark::RegisterBenchmark("refused/answer to nothing", refused,
                                 datagram{9, 0, 6, 0, 0, 1, 2, 3, 4}, ROBUROC4_ERR_UNMATCHED);
    benchmark::RegisterBenchmark("refused/garbage", refused, datagram{0xFF, 6, 0, 0x5A, 0xA5},
                                 ROBUROC4_ERR_SHORT);
    benchmark::RegisterBenchmark("poll/nothing due", nothing_due);
    benchmark::RegisterBenchmark("clients", many)->Arg(1)->Arg(16)->Arg(256)->Arg(4096);
    benchmark::internal::Benchmark *const of_length =
        benchmark::RegisterBenchmark("payload", payload);
    for (const int64_t inputs : {1, 4, 16, 64, 256, 1024, 4096, 16000}) { /* to what UDP carries */
        of_length->Arg(inputs);
    }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
        return 2;
    }
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
