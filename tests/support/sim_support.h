/* SPDX-License-Identifier: MIT
 *
 * sim_support.h - a simulated robot for tests: created from a configuration, advanced by cycles,
 * and queried in telegrams.
 */
#ifndef ROBUROC4_TESTS_SIM_SUPPORT_H
#define ROBUROC4_TESTS_SIM_SUPPORT_H

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <vector>

#include "hex.h"
#include "roburoc4_sim.h"

namespace roburoc4_tests {

struct Sent {
    std::uint64_t peer;
    Bytes bytes;
};

inline roburoc4_sim_config default_sim_config() {
    roburoc4_sim_config config;
    roburoc4_sim_config_init(&config, sizeof config);
    return config;
}

/** A robot with a perfect network, whose time advances on request. */
class SimRobot {
  public:
    static constexpr std::uint64_t origin_us = 5000000;

    explicit SimRobot(const roburoc4_sim_config &config = default_sim_config())
        : sim_(roburoc4_sim_create(&config), roburoc4_sim_destroy) {
        if (sim_ == nullptr)
            throw std::invalid_argument("bad simulator configuration");
        roburoc4_sim_advance(sim_.get(), now_us_);
    }

    [[nodiscard]] roburoc4_sim *get() const {
        return sim_.get();
    }
    [[nodiscard]] std::uint64_t now_us() const {
        return now_us_;
    }

    void send(const Bytes &bytes, std::uint64_t peer = 1) {
        ExactBlock block(bytes);
        roburoc4_sim_receive(sim_.get(), peer, block.data(), block.size());
    }

    /** Run cycles of 10 ms. */
    void run(std::uint64_t cycles) {
        for (std::uint64_t cycle = 0; cycle < cycles; cycle++) {
            now_us_ += ROBUROC4_CYCLE_US;
            roburoc4_sim_advance(sim_.get(), now_us_);
        }
    }

    /** Everything that it wants to send now. */
    std::vector<Sent> take() {
        std::vector<Sent> all;
        std::array<std::uint8_t, ROBUROC4_SIM_MAX_TRANSMIT> buffer{};
        std::uint64_t peer = 0;
        roburoc4_result size = 0;
        while ((size = roburoc4_sim_poll_transmit(sim_.get(), &peer, buffer.data(),
                                                  buffer.size())) > 0)
            all.push_back({peer, Bytes(buffer.begin(), buffer.begin() + size)});
        EXPECT_EQ(0, size);
        return all;
    }

    /** Send a request and take its one answer, which goes to the sender; empty if there is none. */
    Bytes ask(const Bytes &bytes, std::uint64_t peer = 1) {
        take();
        send(bytes, peer);
        const auto answers = take();
        EXPECT_LE(answers.size(), 1U);
        if (answers.empty())
            return {};
        EXPECT_EQ(peer, answers[0].peer);
        return answers[0].bytes;
    }

    void command(float linear_m_s, float angular_rad_s, std::uint64_t peer = 1) {
        std::array<std::uint8_t, 11> buffer{};
        EXPECT_EQ(11, roburoc4_encode_differential_command(buffer.data(), buffer.size(),
                                                           ROBUROC4_SERVICE_DIFFERENTIAL,
                                                           linear_m_s, angular_rad_s));
        send(Bytes(buffer.begin(), buffer.end()), peer);
    }

    /** Command a speed in every tenth cycle for this many cycles. */
    void drive(float linear_m_s, float angular_rad_s, std::uint64_t cycles) {
        for (std::uint64_t cycle = 0; cycle < cycles; cycle++) {
            if (cycle % 10 == 0)
                command(linear_m_s, angular_rad_s);
            run(1);
        }
    }

    [[nodiscard]] roburoc4_sim_state state() const {
        roburoc4_sim_state state{};
        state.size = sizeof state;
        EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_get_state(sim_.get(), &state));
        return state;
    }

    /** The value of a control, or the error. */
    [[nodiscard]] double value(std::uint32_t control) const {
        double value = 0.0;
        const auto result = roburoc4_sim_get(sim_.get(), control, &value);
        return result < 0 ? result : value;
    }

    /** The period at which a peer is sent the statuses of a service, as the robot reports it; 0:
     *  it did not subscribe. */
    std::uint32_t subscription(std::uint16_t service, std::uint64_t peer = 1) {
        const Bytes answer = ask({0x12, ROBUROC4_ACTION_GET, 0x01, 0x00}, peer);
        for (std::size_t at = 5; at + 3 <= answer.size(); at += 3)
            if (answer[at] == service)
                return answer[at + 2];
        return 0;
    }

    /** Subscribe; the error byte of the answer. */
    int insert(std::uint16_t service, std::uint8_t period, std::uint64_t peer = 1) {
        const auto answer = ask({0x11, ROBUROC4_ACTION_INSERT, 0x01, 0x00,
                                 static_cast<std::uint8_t>(service & 0xFF),
                                 static_cast<std::uint8_t>(service >> 8), period},
                                peer);
        return answer.size() == 5 ? answer[4] : -1;
    }

  private:
    std::uint64_t now_us_ = origin_us;
    std::unique_ptr<roburoc4_sim, void (*)(roburoc4_sim *)> sim_;
};

} // namespace roburoc4_tests

#endif
