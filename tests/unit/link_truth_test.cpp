/* SPDX-License-Identifier: MIT
 *
 * link_truth_test.cpp - the link's loss against what the network really lost: two faulty
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

class Network {
  public:
    Network(const roburoc4_sim_faults &faults, unsigned period_ms)
        : sim_(roburoc4_sim_create(nullptr), roburoc4_sim_destroy), to_robot_(channel(faults, 11)),
          to_client_(channel(faults, 12)) {
        roburoc4_config config;
        roburoc4_config_init(&config, sizeof config);
        config.period_ms[service] = static_cast<std::uint16_t>(period_ms);
        config.subscriptions = 1U << service; /* the others would queue before it */
        EXPECT_EQ(ROBUROC4_OK, roburoc4_client_init(&client, sizeof client, &config));
        roburoc4_sim_clear_obstacles(sim_.get());
        roburoc4_sim_advance(sim_.get(), now_us_);
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
    [[nodiscard]] roburoc4_service_link figures() const {
        roburoc4_service_link link{};
        link.size = sizeof link;
        EXPECT_EQ(ROBUROC4_OK, roburoc4_client_service_link(&client, service, now_us_, &link));
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
    roburoc4_client client{};

  private:
    using Sim = std::unique_ptr<roburoc4_sim, void (*)(roburoc4_sim *)>;
    using Channel = std::unique_ptr<sim_network, void (*)(sim_network *)>;

    static Channel channel(const roburoc4_sim_faults &faults, std::uint64_t seed) {
        return {sim_network_create(&faults, seed, 4096, ROBUROC4_SIM_MAX_TRANSMIT),
                sim_network_destroy};
    }
    [[nodiscard]] std::uint64_t later(std::uint64_t time_us) const {
        return std::max(time_us, now_us_ + 1);
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
        roburoc4_sim_advance(sim_.get(), now_us_);
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

    std::uint64_t now_us_ = 50 * second;
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

class LinkTruth : public testing::TestWithParam<double> {};

TEST_P(LinkTruth, LossIsWithinOnePointWhateverElseHappens) {
    for (const unsigned period_ms : {10U, 50U, 100U}) {
        for (int variant = 0; variant < 3; variant++) {
            SCOPED_TRACE(testing::Message() << period_ms << " ms, variant " << variant);
            roburoc4_sim_faults faults{};
            faults.size = sizeof faults;
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
