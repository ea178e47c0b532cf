/* SPDX-License-Identifier: MIT
 *
 * lcm_consumer.c in C++: it writes the same drive command to its standard output.
 */
#include <cstdio>
#include <vector>

#include <lcm/lcm-cpp.hpp>
#include <roburoc4_lcm/bridge_state_t.hpp>
#include <roburoc4_lcm/drive_command_t.hpp>

int main() {
    roburoc4_lcm::drive_command_t command{};
    command.utime = 1;
    command.sender = "consumer";
    command.linear_m_s = 0.25;
    command.lease_us = -1;
    std::vector<char> bytes(static_cast<std::size_t>(command.getEncodedSize()));
    const int size = command.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    return size > 0 && std::fwrite(bytes.data(), 1, bytes.size(), stdout) == bytes.size() ? 0 : 1;
}
