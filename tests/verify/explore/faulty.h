/* SPDX-License-Identifier: MIT
 *
 * faulty.h - the client's functions, through which a canary can break one promise at a time.
 */
#ifndef ROBUROC4_EXPLORE_FAULTY_H
#define ROBUROC4_EXPLORE_FAULTY_H

#include "judge.h"

namespace explore {

/** A client with one fault; none in `no_fault`. */
struct Fault {
    const char *what;
    Promise breaks;
};
extern const Fault faults[];
extern const std::uint32_t fault_count;
constexpr std::uint32_t no_fault = 0;
/** Which one all clients have from now on. */
void set_fault(std::uint32_t index);

/** The client; its functions are those of roburoc4.h unless there is a fault. */
struct Port {
    roburoc4_client client;

    void begin(const roburoc4_config &config, std::uint64_t now_us);
    roburoc4_result arm(std::uint64_t now_us);
    roburoc4_result drive(Speeds speeds, std::uint64_t now_us);
    roburoc4_result pause(std::uint64_t now_us);
    roburoc4_result stop(std::uint64_t now_us);
    roburoc4_result receive(std::uint8_t *datagram, std::size_t size, std::uint64_t now_us);
    roburoc4_result poll(std::uint8_t *buffer, std::uint64_t now_us);
    std::uint64_t deadline() const;
    std::uint32_t take_events();
    roburoc4_facts facts(std::uint64_t now_us) const;

    /* memory of the faults */
    Speeds speeds;
    std::uint64_t latest_us;
    std::uint32_t zeros, polls;
    std::uint8_t doubled[11], reserved[5];
};

} // namespace explore

#endif
