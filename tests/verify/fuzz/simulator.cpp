/* SPDX-License-Identifier: MIT
 *
 * Fuzzing the simulator: datagrams of any content from several peers, lines for its panel, steps of
 * time, and another configuration. It must answer in telegrams, and keep its state believable.
 */
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "fuzz.h"
#include "roburoc4.h"
#include "roburoc4_sim.h"

using namespace roburoc4_tests;

namespace {

constexpr std::size_t most_steps = 200;

void take(roburoc4_sim *sim) {
    ExactBlock block(ROBUROC4_SIM_MAX_TRANSMIT);
    std::uint64_t peer = 0;
    roburoc4_result size = 0;
    while ((size = roburoc4_sim_poll_transmit(sim, &peer, block.data(), block.size())) > 0) {
        const auto length = static_cast<std::size_t>(size);
        roburoc4_answer answer;
        roburoc4_status_header status;
        expect(roburoc4_decode_answer(block.data(), length, &answer) >= 0 ||
                   roburoc4_decode_status_header(block.data(), length, &status) >= 0,
               "the robot sends telegrams");
        expect(peer < 4, "the robot answers only known peers");
    }
    expect(size == 0, "the largest buffer is large enough");
}

void look(const roburoc4_sim *sim) {
    roburoc4_sim_state s{};
    s.size = sizeof s;
    expect(roburoc4_sim_get_state(sim, &s) == ROBUROC4_OK, "its state can be read");
    expect(std::isfinite(s.true_x_m) && std::isfinite(s.true_y_m) &&
               std::isfinite(s.true_linear_m_s) && std::isfinite(s.true_angular_rad_s) &&
               std::isfinite(s.target_linear_m_s) && std::isfinite(s.target_angular_rad_s),
           "the robot is somewhere and moves somehow");
    expect(s.battery_percent >= 0 && s.battery_percent <= 100, "the battery is 0 to 100 % full");
    expect(s.overridden != 0 || s.watchdog_tripped == 0 ||
               (s.target_linear_m_s == 0 && s.target_angular_rad_s == 0),
           "the watchdog sets the target to 0");
}

void command_line(roburoc4_sim *sim, const Bytes &text) {
    const std::string line(text.begin(), text.end());
    char reply[ROBUROC4_SIM_REPLY_SIZE];
    const roburoc4_result result = roburoc4_sim_panel(sim, line.c_str(), reply, sizeof reply);
    expect(result == ROBUROC4_OK || result == ROBUROC4_ERR_ARGUMENT || result == ROBUROC4_ERR_STATE,
           "the panel reports the result");
    expect(std::memchr(reply, 0, sizeof reply) != nullptr, "the reply ends with a NUL");
}

using Robot = std::unique_ptr<roburoc4_sim, void (*)(roburoc4_sim *)>;

/** Replaces a robot by one of any configuration; keeps it if that is not valid. */
void replace(Robot &sim, Input &in) {
    roburoc4_sim_config config;
    roburoc4_sim_config_init(&config, sizeof config);
    const Bytes raw = in.bytes(sizeof config - sizeof config.size);
    /* all but its size, which says which struct it is */
    std::copy(raw.begin(), raw.end(),
              reinterpret_cast<std::uint8_t *>(&config) + sizeof config.size);
    Robot other(roburoc4_sim_create(&config), roburoc4_sim_destroy);
    const bool bad = roburoc4_sim_config_error(&config) != nullptr;
    expect((other == nullptr) == bad, "a bad configuration is refused");
    if (other != nullptr)
        sim = std::move(other);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    Input in(data, size);
    Robot sim(roburoc4_sim_create(nullptr), roburoc4_sim_destroy);
    std::uint64_t now_us = 1000000;
    roburoc4_sim_advance(sim.get(), now_us);
    for (std::size_t i = 0; i < most_steps && !in.over(); i++) {
        const std::uint8_t what = in.byte();
        switch (what & 7) {
        case 0:
        case 1:
            now_us += std::uint64_t{in.byte()} * 1000;
            roburoc4_sim_advance(sim.get(), now_us);
            break;
        case 2:
            command_line(sim.get(), in.bytes(in.byte() & 63));
            break;
        case 3:
            if ((what & 8) != 0) {
                replace(sim, in);
                roburoc4_sim_advance(sim.get(), now_us);
            } else {
                roburoc4_sim_receive(sim.get(), what >> 4 & 3, nullptr, 0);
            }
            break;
        default: {
            ExactBlock block(in.bytes(in.byte() & 127));
            roburoc4_sim_receive(sim.get(), what >> 4 & 3, block.data(), block.size());
            break;
        }
        }
        take(sim.get());
        look(sim.get());
    }
    return 0;
}
