/* SPDX-License-Identifier: MIT
 *
 * link_truth_test.cpp - the link's statistics against what the network really did: two faulty
 * channels connect a client and a robot, and the test counts every status itself.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>

#include "hex.h"
#include "network.h"
#include "roburoc4.h"
#include "roburoc4_sim.h"

using namespace roburoc4_tests;

namespace {

constexpr std::uint64_t ms = 1000;
constexpr std::uint64_t second = 1000000;
constexpr std::uint32_t service = ROBUROC4_SERVICE_DIFFERENTIAL;

roburoc4_sim_faults no_faults() {
    roburoc4_sim_faults faults{};
    faults.size = sizeof faults;
    return faults;
}

class Network {
  public:
    Network(const roburoc4_sim_faults &faults, unsigned period_ms, double drift = 0)
        : drift_(drift), sim_(roburoc4_sim_create(nullptr), roburoc4_sim_destroy),
          to_robot_(channel(faults, 11)), to_client_(channel(faults, 12)) {
        roburoc4_config config;
        roburoc4_config_init(&config, sizeof config);
        config.period_ms[service] = static_cast<std::uint16_t>(period_ms);
        config.subscriptions = 1U << service; /* the others would queue before it */
        EXPECT_EQ(ROBUROC4_OK, roburoc4_client_init(&client, sizeof client, &config));
        roburoc4_sim_clear_obstacles(sim_.get());
        roburoc4_sim_advance(sim_.get(), robot_us());
        EXPECT_EQ(ROBUROC4_OK, roburoc4_client_start(&client, now_us_));
    }

    /** In steps of 1 ms, finer where something arrives or is due. */
    void run(std::uint64_t span_us) {
        const std::uint64_t end_us = now_us_ + span_us;
        while (now_us_ < end_us) {
            now_us_ =
                std::min({now_us_ + ms, end_us, later(sim_network_next_deadline(to_robot_.get())),
                          later(sim_network_next_deadline(to_client_.get())),
                          later(roburoc4_client_next_deadline(&client))});
            step();
        }
    }
    void run_until_ready() {
        for (int i = 0; i < 3000 && roburoc4_client_state(&client) != ROBUROC4_STATE_READY; i++)
            run(10 * ms);
        ASSERT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), roburoc4_client_state(&client));
    }
    [[nodiscard]] std::uint64_t now_us() const {
        return now_us_;
    }
    [[nodiscard]] roburoc4_service_link figures() const {
        roburoc4_service_link link{};
        link.size = sizeof link;
        EXPECT_EQ(ROBUROC4_OK, roburoc4_client_service_link(&client, service, now_us_, &link));
        return link;
    }
    [[nodiscard]] roburoc4_link totals() const {
        roburoc4_link link{};
        link.size = sizeof link;
        EXPECT_EQ(ROBUROC4_OK, roburoc4_client_link(&client, now_us_, &link));
        return link;
    }
    /** Share of lost statuses, between the first and the last that arrived. */
    [[nodiscard]] double true_loss() const {
        const auto sent = static_cast<double>(
            std::distance(sent_.find(*arrived_.begin()), sent_.find(*arrived_.rbegin())) + 1);
        return 1 - static_cast<double>(arrived_.size()) / sent;
    }
    [[nodiscard]] std::uint64_t duplicates() const {
        return duplicates_;
    }
    /** When the robot's clock showed `cycles`, on the host's clock. */
    [[nodiscard]] double true_host_us(std::uint64_t cycles) const {
        return static_cast<double>(origin_us) +
               static_cast<double>(cycles * ROBUROC4_CYCLE_US) / (1 + drift_);
    }
    [[nodiscard]] std::uint64_t newest_cycles() const {
        return *arrived_.rbegin();
    }

    roburoc4_client client{};

  private:
    static constexpr std::uint64_t origin_us = 50 * second;
    using Sim = std::unique_ptr<roburoc4_sim, void (*)(roburoc4_sim *)>;
    using Channel = std::unique_ptr<sim_network, void (*)(sim_network *)>;

    static Channel channel(const roburoc4_sim_faults &faults, std::uint64_t seed) {
        return {sim_network_create(&faults, seed, 4096, ROBUROC4_SIM_MAX_TRANSMIT),
                sim_network_destroy};
    }
    [[nodiscard]] std::uint64_t later(std::uint64_t time_us) const {
        return std::max(time_us, now_us_ + 1);
    }
    /** The robot's own time, which may run faster or slower. */
    [[nodiscard]] std::uint64_t robot_us() const {
        const auto span = static_cast<double>(now_us_ - origin_us);
        return origin_us + static_cast<std::uint64_t>(span * (1 + drift_));
    }
    static bool is_status(const std::uint8_t *data, roburoc4_result size, std::uint64_t *cycles) {
        roburoc4_status_header head;
        if (roburoc4_decode_status_header(data, static_cast<std::size_t>(size), &head) < 0 ||
            head.service != service)
            return false;
        *cycles = head.robot_cycles;
        return true;
    }
    void step() {
        std::array<std::uint8_t, ROBUROC4_SIM_MAX_TRANSMIT> data{};
        std::uint64_t peer = 0;
        std::uint64_t cycles = 0;
        roburoc4_result size = 0;
        while ((size = sim_network_poll(to_robot_.get(), now_us_, &peer, data.data(),
                                        data.size())) > 0)
            roburoc4_sim_receive(sim_.get(), 1, data.data(), static_cast<std::size_t>(size));
        roburoc4_sim_advance(sim_.get(), robot_us());
        while ((size = roburoc4_sim_poll_transmit(sim_.get(), &peer, data.data(), data.size())) >
               0) {
            if (is_status(data.data(), size, &cycles))
                sent_.insert(cycles);
            sim_network_push(to_client_.get(), peer, data.data(), static_cast<std::size_t>(size),
                             now_us_);
        }
        while ((size = sim_network_poll(to_client_.get(), now_us_, &peer, data.data(),
                                        data.size())) > 0) {
            if (is_status(data.data(), size, &cycles))
                duplicates_ += arrived_.insert(cycles).second ? 0 : 1;
            roburoc4_client_receive(&client, data.data(), static_cast<std::size_t>(size), now_us_);
        }
        while ((size = roburoc4_client_poll_transmit(&client, data.data(), data.size(), now_us_)) >
               0)
            sim_network_push(to_robot_.get(), 1, data.data(), static_cast<std::size_t>(size),
                             now_us_);
    }

    const double drift_;
    std::uint64_t now_us_ = origin_us;
    Sim sim_;
    Channel to_robot_, to_client_;
    std::set<std::uint64_t> sent_, arrived_;
    std::uint64_t duplicates_ = 0;
};

/** Late ones are not used, but they arrived. */
double share(const roburoc4_service_link &link) {
    return static_cast<double>(link.lost) /
           static_cast<double>(link.lost + link.received + link.late);
}

} // namespace

/* ---------------------------------------------------------------------------------- loss --- */

class LinkTruth : public testing::TestWithParam<double> {};

TEST_P(LinkTruth, LossIsWithinOnePointWhateverElseHappens) {
    for (const unsigned period_ms : {10U, 50U, 100U}) {
        for (int variant = 0; variant < 3; variant++) {
            SCOPED_TRACE(testing::Message() << period_ms << " ms, variant " << variant);
            roburoc4_sim_faults faults = no_faults();
            faults.loss = GetParam();
            faults.duplicate = variant > 0 ? 0.2 : 0;
            faults.reorder = variant > 1 ? 0.2 : 0;
            faults.delay_us = 3 * ms;
            faults.jitter_us = variant > 0 ? 8 * ms : 0;
            Network network(faults, period_ms);
            network.run_until_ready();
            double recent = 0;
            int samples = 0;
            for (std::uint64_t t = 0; t < 4000U * period_ms * ms; t += 100U * period_ms * ms) {
                network.run(100U * period_ms * ms);
                recent += t == 0 ? 0 : static_cast<double>(network.figures().loss);
                samples += t == 0 ? 0 : 1;
            }
            const roburoc4_service_link link = network.figures();
            EXPECT_NEAR(GetParam(), network.true_loss(), 0.03) << "the network itself";
            EXPECT_NEAR(network.true_loss(), share(link), 0.01);
            EXPECT_NEAR(network.true_loss(), recent / samples, 0.01);
            EXPECT_EQ(period_ms * ms, link.period_us);
            EXPECT_GT(link.received, 2000U);
            if (variant == 0) {
                EXPECT_EQ(0U, link.duplicates + link.late);
            } else {
                EXPECT_NEAR(static_cast<double>(network.duplicates()),
                            static_cast<double>(link.duplicates),
                            0.1 * static_cast<double>(network.duplicates()) + 5);
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Rates, LinkTruth, testing::Values(0.0, 0.01, 0.05, 0.1, 0.2, 0.3),
                         [](const testing::TestParamInfo<double> &rate) {
                             return "Percent" + std::to_string(std::lround(rate.param * 100));
                         });

/* --------------------------------------------------------------------------------- clock --- */

struct ClockCase {
    std::uint32_t delay_ms, jitter_ms;
    double drift;
    double loss;
};

class ClockTruth : public testing::TestWithParam<ClockCase> {};

TEST_P(ClockTruth, HostTimeIsWithinTenMillisecondsPlusTheJitter) {
    const ClockCase &c = GetParam();
    roburoc4_sim_faults faults = no_faults();
    faults.delay_us = c.delay_ms * 1000;
    faults.jitter_us = c.jitter_ms * 1000;
    faults.loss = c.loss;
    Network network(faults, 50, c.drift);
    network.run_until_ready();
    network.run(10 * second);
    double worst_us = 0;
    for (int i = 0; i < 6000; i++) { /* ten minutes: a drift of 100 ppm is 60 ms */
        network.run(100 * ms);
        for (const std::uint64_t back : {0U, 50U}) {
            const std::uint64_t cycles = network.newest_cycles() - back;
            std::uint64_t host_us = 0;
            ASSERT_EQ(ROBUROC4_OK, roburoc4_client_host_time(&network.client, cycles, &host_us));
            worst_us = std::max(
                worst_us, std::fabs(static_cast<double>(host_us) - network.true_host_us(cycles)));
        }
    }
    EXPECT_LE(worst_us, 10e3 + c.jitter_ms * 1e3);
}

INSTANTIATE_TEST_SUITE_P(Networks, ClockTruth,
                         testing::Values(ClockCase{0, 0, 0, 0}, ClockCase{5, 0, 0, 0},
                                         ClockCase{80, 0, 0, 0}, ClockCase{2, 10, 0, 0},
                                         ClockCase{20, 40, 0, 0.2}, ClockCase{1, 1, 1e-4, 0},
                                         ClockCase{1, 1, -1e-4, 0}, ClockCase{10, 20, 1e-4, 0.1},
                                         ClockCase{10, 20, -1e-4, 0.1}),
                         [](const testing::TestParamInfo<ClockCase> &c) {
                             return "Delay" + std::to_string(c.param.delay_ms) + "Jitter" +
                                    std::to_string(c.param.jitter_ms) + "Drift" +
                                    (c.param.drift < 0 ? "Minus" : "Plus") +
                                    std::to_string(std::lround(std::fabs(c.param.drift) * 1e6)) +
                                    "Loss" + std::to_string(std::lround(c.param.loss * 100));
                         });

/* -------------------------------------------------------------------- jitter, round trip --- */

TEST(FiguresTruth, JitterFollowsTheInjectedOne) {
    for (const std::uint32_t jitter_ms : {0U, 2U, 10U, 30U}) {
        SCOPED_TRACE(jitter_ms);
        roburoc4_sim_faults faults = no_faults();
        faults.delay_us = 5 * ms;
        faults.jitter_us = jitter_ms * 1000;
        Network network(faults, 50);
        network.run_until_ready();
        network.run(10 * second);
        double mean_us = 0;
        for (int i = 0; i < 600; i++) {
            network.run(100 * ms);
            mean_us += network.figures().jitter_us / 600.0;
        }
        /* two delays drawn evenly from 0 to j differ by j / 3 in the mean */
        const double expected_us = jitter_ms * 1e3 / 3;
        EXPECT_NEAR(expected_us, mean_us, 0.15 * expected_us + 50);
    }
}

TEST(FiguresTruth, RoundTripIsThatOfTheNetwork) {
    for (const std::uint32_t delay_ms : {0U, 1U, 10U, 40U}) {
        for (const std::uint32_t jitter_ms : {0U, 10U}) {
            SCOPED_TRACE(testing::Message() << delay_ms << " ms, jitter " << jitter_ms << " ms");
            roburoc4_sim_faults faults = no_faults();
            faults.delay_us = delay_ms * 1000;
            faults.jitter_us = jitter_ms * 1000;
            Network network(faults, 50);
            network.run_until_ready();
            network.run(60 * second);
            const roburoc4_link link = network.totals();
            const double least_us = 2e3 * delay_ms;
            const double most_us = least_us + 2e3 * jitter_ms;
            EXPECT_GE(link.round_trip_min_us, least_us);
            EXPECT_LE(link.round_trip_min_us, least_us + 0.5e3 * jitter_ms + 10);
            EXPECT_GE(link.round_trip_us + 10, least_us);
            EXPECT_LE(link.round_trip_us, most_us + 10);
        }
    }
}

TEST(FiguresTruth, TotalsAreThoseOfAllServices) {
    roburoc4_sim_faults faults = no_faults();
    faults.loss = 0.1;
    faults.delay_us = 2 * ms;
    Network network(faults, 50);
    network.run_until_ready();
    network.run(120 * second);
    const roburoc4_link link = network.totals();
    const double all = static_cast<double>(link.lost) / (link.lost + link.received);
    EXPECT_NEAR(0.1, all, 0.015);
    EXPECT_NEAR(0.1, static_cast<double>(link.loss), 0.04);
    EXPECT_LT(link.silence_us, 200000U);
}
