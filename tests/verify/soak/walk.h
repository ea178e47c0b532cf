/* SPDX-License-Identifier: MIT
 *
 * walk.h - one life of a client and a robot in virtual time, with faults and a user that behaves
 * badly, all drawn from a seed. A referee stands beside the client, another watches the robot.
 */
#ifndef ROBUROC4_TESTS_WALK_H
#define ROBUROC4_TESTS_WALK_H

#include <cstdint>
#include <string>

#include "referee.h"

namespace roburoc4_tests {

/** After the faults end the client is ready again within this, ... */
constexpr std::uint64_t ready_bound_us = 15000000;
/** ... a user who asks for it has armed and moves the robot within this, ... */
constexpr std::uint64_t moving_bound_us = 25000000;
/** ... and after close() it is idle within its zero train, one watchdog time. */
constexpr std::uint64_t idle_slack_us = 100000;

struct LifeReport {
    std::string complaint; /* empty: every promise was held */
    RefereeTotals totals;
    bool monitor = false;
    bool damaged = false;  /* its network damaged datagrams */
    bool deceived = false; /* ... so that the referee could not judge all promises to the end */
    std::uint64_t virtual_us = 0;
    std::uint64_t ready_after_us = 0, armed_after_us = 0, moving_after_us = 0; /* of the faults */
    std::uint64_t forged = 0;             /* datagrams of somebody with the robot's address */
    std::uint64_t robot_moved_cycles = 0; /* cycles in which the robot had a target */
};

/** `trace`: print what happens to standard output. */
LifeReport live(std::uint64_t seed, bool trace = false);

} // namespace roburoc4_tests

#endif
