/* SPDX-License-Identifier: MIT
 *
 * sim_network_test.cpp - the bad network: each fault at the configured rate, in virtual time, the
 * same for the same seed.
 */
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "hex.h"
#include "network.h"

using namespace roburoc4_tests;

namespace {

struct Arrival {
    std::uint64_t at_us, peer;
    Bytes bytes;

    bool operator==(const Arrival &other) const {
        return at_us == other.at_us && peer == other.peer && bytes == other.bytes;
    }
};

class Channel {
  public:
    explicit Channel(const roburoc4_sim_faults &faults, std::uint64_t seed = 1,
                     std::uint32_t datagrams = 4096, std::uint32_t longest = 64)
        : channel_(sim_network_create(&faults, seed, datagrams, longest), sim_network_destroy) {
        EXPECT_NE(nullptr, channel_);
    }

    [[nodiscard]] sim_network *get() const {
        return channel_.get();
    }

    void push(std::uint64_t peer, const Bytes &bytes, std::uint64_t now_us) const {
        sim_network_push(get(), peer, bytes.data(), bytes.size(), now_us);
    }

    [[nodiscard]] std::vector<Arrival> poll(std::uint64_t now_us) const {
        std::vector<Arrival> all;
        Bytes buffer(64);
        std::uint64_t peer = 0;
        roburoc4_result size = 0;
        while ((size = sim_network_poll(get(), now_us, &peer, buffer.data(), buffer.size())) > 0)
            all.push_back({now_us, peer, Bytes(buffer.begin(), buffer.begin() + size)});
        EXPECT_EQ(0, size);
        return all;
    }

  private:
    std::unique_ptr<sim_network, void (*)(sim_network *)> channel_;
};

Bytes numbered(std::uint64_t number) {
    Bytes bytes(20, 0x55);
    for (std::size_t at = 0; at < 8; at++)
        bytes[at] = static_cast<std::uint8_t>(number >> 8 * at);
    return bytes;
}

std::uint64_t number_of(const Bytes &bytes) {
    std::uint64_t number = 0;
    for (std::size_t at = 0; at < 8; at++)
        number |= std::uint64_t(bytes.at(at)) << 8 * at;
    return number;
}

constexpr std::uint64_t many = 20000;
constexpr std::uint64_t beat_us = 10000;

/** Push `many` numbered datagrams, one each 10 ms, and poll at each deadline. */
std::vector<Arrival> pass_many(const Channel &channel) {
    std::vector<Arrival> all;
    const auto collect = [&](std::uint64_t until_us) {
        for (auto due = sim_network_next_deadline(channel.get()); due < until_us;
             due = sim_network_next_deadline(channel.get())) {
            const auto some = channel.poll(due);
            ASSERT_FALSE(some.empty()) << "a deadline without a datagram";
            all.insert(all.end(), some.begin(), some.end());
        }
    };
    for (std::uint64_t number = 0; number < many; number++) {
        collect(number * beat_us);
        channel.push(number % 7, numbered(number), number * beat_us);
    }
    collect(std::numeric_limits<std::uint64_t>::max());
    return all;
}

roburoc4_sim_faults no_faults() {
    return {sizeof(roburoc4_sim_faults), 0, 0, 0, 0.0, 0.0, 0.0, 0.0};
}

/** Whether a count matches a share of `many`, within five standard deviations. */
void expect_share(double share, std::uint64_t count) {
    const double expected = share * double(many);
    EXPECT_NEAR(expected, double(count), 5.0 * std::sqrt(expected * (1.0 - share)) + 1.0);
}

} // namespace

TEST(SimNetwork, WithoutFaultsDeliversEverythingAtOnceAndInOrder) {
    const Channel channel(no_faults());
    const auto all = pass_many(channel);
    ASSERT_EQ(many, all.size());
    for (std::uint64_t number = 0; number < many; number++)
        ASSERT_EQ((Arrival{number * beat_us, number % 7, numbered(number)}), all[number]);
}

TEST(SimNetwork, LosesTheConfiguredShare) {
    auto faults = no_faults();
    faults.loss = 0.2;
    const Channel channel(faults);
    const auto all = pass_many(channel);
    expect_share(0.2, many - all.size());
    faults.loss = 1.0;
    EXPECT_TRUE(pass_many(Channel(faults)).empty());
}

TEST(SimNetwork, DelaysAndJittersWithinBoundsAndKeepsTheOrder) {
    auto faults = no_faults();
    faults.delay_us = 30000;
    faults.jitter_us = 50000;
    const auto all = pass_many(Channel(faults));
    ASSERT_EQ(many, all.size());
    std::uint64_t shortest = std::numeric_limits<std::uint64_t>::max();
    std::uint64_t longest = 0;
    for (std::uint64_t number = 0; number < many; number++) {
        ASSERT_EQ(number, number_of(all[number].bytes)) << "jitter alone never reorders";
        const auto delay = all[number].at_us - number * beat_us;
        shortest = std::min(shortest, delay);
        longest = std::max(longest, delay);
    }
    EXPECT_GE(shortest, 30000U);
    EXPECT_LT(shortest, 35000U);
    EXPECT_LE(longest, 80000U);
    EXPECT_GT(longest, 75000U);
}

TEST(SimNetwork, DuplicatesTheConfiguredShare) {
    auto faults = no_faults();
    faults.duplicate = 0.1;
    faults.jitter_us = 3000;
    const Channel channel(faults);
    const auto all = pass_many(channel);
    expect_share(0.1, all.size() - many);
    for (const auto &arrival : all)
        ASSERT_EQ(numbered(number_of(arrival.bytes)), arrival.bytes);
}

TEST(SimNetwork, CorruptsTheConfiguredShareAndNothingElse) {
    auto faults = no_faults();
    faults.corrupt = 0.25;
    const Channel channel(faults);
    const auto all = pass_many(channel);
    ASSERT_EQ(many, all.size());
    std::uint64_t damaged = 0;
    std::uint64_t cut = 0;
    for (std::uint64_t number = 0; number < many; number++) {
        const Bytes &bytes = all[number].bytes;
        ASSERT_GE(bytes.size(), 1U);
        ASSERT_LE(bytes.size(), 20U);
        damaged += bytes != numbered(number) ? 1U : 0U;
        cut += bytes.size() < 20 ? 1U : 0U;
    }
    expect_share(0.25, damaged);
    EXPECT_NEAR(0.25, double(cut) / double(damaged), 0.05);
}

TEST(SimNetwork, IsTheSameForTheSameSeed) {
    const roburoc4_sim_faults faults = {sizeof faults, 5000, 20000, 0, 0.1, 0.1, 0.1, 0.1};
    const auto first = pass_many(Channel(faults, 9));
    EXPECT_TRUE(first == pass_many(Channel(faults, 9)));
    EXPECT_FALSE(first == pass_many(Channel(faults, 10)));
}

TEST(SimNetwork, DropsWhatItCannotHold) {
    auto faults = no_faults();
    faults.delay_us = 1000;
    const Channel channel(faults, 1, 3, 16);
    channel.push(1, {}, 0);
    channel.push(1, Bytes(17), 0);
    EXPECT_EQ(std::numeric_limits<std::uint64_t>::max(), sim_network_next_deadline(channel.get()));
    for (std::uint8_t number = 0; number < 5; number++)
        channel.push(1, {number}, 0);
    EXPECT_TRUE(channel.poll(999).empty());
    EXPECT_EQ(3U, channel.poll(1000).size());
    EXPECT_EQ(std::numeric_limits<std::uint64_t>::max(), sim_network_next_deadline(channel.get()));
}

TEST(SimNetwork, AcceptsOtherFaultsWhileItRuns) {
    auto faults = no_faults();
    faults.loss = 1.0;
    const Channel channel(faults);
    channel.push(1, {1}, 0);
    EXPECT_TRUE(channel.poll(0).empty());
    faults.loss = 0.0;
    EXPECT_EQ(ROBUROC4_OK, sim_network_set_faults(channel.get(), &faults));
    channel.push(1, {2}, 0);
    EXPECT_EQ(1U, channel.poll(0).size());
    faults.corrupt = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, sim_network_set_faults(channel.get(), &faults));
    faults.corrupt = 1.5;
    EXPECT_EQ(ROBUROC4_ERR_ARGUMENT, sim_network_set_faults(channel.get(), &faults));
    channel.push(1, {3}, 0);
    EXPECT_EQ((Bytes{3}), channel.poll(0).at(0).bytes);
}
