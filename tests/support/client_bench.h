/* SPDX-License-Identifier: MIT
 *
 * client_bench.h - a client and a partner in virtual time. The bench polls exactly when the client
 * asks to be polled, keeps what was sent, and checks at every step what must always hold: a speed
 * leaves only under a living lease of an armed client, no deadline makes a loop spin, and nothing
 * is due before it.
 */
#ifndef ROBUROC4_TESTS_CLIENT_BENCH_H
#define ROBUROC4_TESTS_CLIENT_BENCH_H

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <stdexcept>

#include "client_support.h"
#include "roburoc4_sim.h"

namespace roburoc4_tests {

/** For a core without texts also where things are, as the program has to say there. */
inline roburoc4_config default_config() {
    roburoc4_config config;
    EXPECT_EQ(ROBUROC4_OK, roburoc4_config_init(&config, sizeof config));
    if (std::getenv("ROBUROC4_NO_TEXTS") != nullptr) {
        config.iocard_id = ROBUROC4_SERVICE_IOCARD;
        config.differential_id = ROBUROC4_SERVICE_DIFFERENTIAL;
        config.role_index[ROBUROC4_ROLE_OVERRIDE] = ROBUROC4_DI_PAD_A;
        config.role_index[ROBUROC4_ROLE_FRONT_BUMPER] = ROBUROC4_DI_FRONT_BUMPER;
        config.role_index[ROBUROC4_ROLE_REAR_BUMPER] = ROBUROC4_DI_REAR_BUMPER;
    }
    return config;
}

/** Ceilings that leave only the robot's own limits. */
inline roburoc4_config unlimited_config() {
    roburoc4_config config = default_config();
    config.max_linear_m_s = 2.6F;
    config.max_angular_rad_s = 6.5F;
    return config;
}

struct Command {
    std::uint64_t at_us;
    float linear, angular;
    [[nodiscard]] bool zero() const {
        return linear == 0 && angular == 0;
    }
};

class Bench {
  public:
    struct Datagram {
        std::uint64_t at_us;
        Bytes bytes;
    };

    explicit Bench(Partner &partner, const roburoc4_config &config = default_config(),
                   std::uint64_t now = 1000 * second)
        : now_us(now), partner_(partner) {
        EXPECT_EQ(ROBUROC4_OK, roburoc4_client_init(&client, sizeof client, &config));
        partner_.advance(now_us);
    }

    roburoc4_client client{};
    std::uint64_t now_us;
    std::int64_t skew_us = 0; /* the client's clock minus the true time */
    std::uint64_t polls = 0;
    std::vector<Datagram> sent;
    /** Faults of the network, if set: true drops a datagram; a delay in microseconds. */
    std::function<bool(const Bytes &)> drop_to_robot, drop_to_client;
    std::function<std::uint64_t()> delay_to_client;

    [[nodiscard]] std::uint64_t client_us() const {
        return now_us + static_cast<std::uint64_t>(skew_us);
    }

    /* ---- time ---- */
    void start() {
        ASSERT_EQ(ROBUROC4_OK, roburoc4_client_start(&client, client_us()));
        pump();
    }
    void run_to(std::uint64_t end_us) {
        pump();
        while (now_us < end_us) {
            sleep_to(std::min(next_us(), end_us));
            pump();
        }
    }
    void run(std::uint64_t span_us) {
        run_to(now_us + span_us);
    }
    /** Run until the condition holds; false if that takes longer than `limit_us`. */
    bool run_until(const std::function<bool()> &so, std::uint64_t limit_us = 30 * second) {
        const std::uint64_t end_us = now_us + limit_us;
        pump();
        while (!so()) {
            if (now_us >= end_us)
                return false;
            sleep_to(std::min(next_us(), end_us));
            pump();
        }
        return true;
    }
    bool run_until_state(std::uint32_t wanted, std::uint64_t limit_us = 30 * second) {
        return run_until([&] { return state() == wanted; }, limit_us);
    }
    /** Start, become ready with a status of every service, and forget the datagrams until then. */
    void ready() {
        start();
        ASSERT_TRUE(run_until_state(ROBUROC4_STATE_READY));
        run(1200 * ms);
        ASSERT_EQ(static_cast<std::uint32_t>(ROBUROC4_STATE_READY), state());
        take_events();
        sent.clear();
    }
    void armed() {
        ready();
        ASSERT_EQ(ROBUROC4_OK, arm());
        take_events();
    }
    /** Drive for this time, renewing the lease every 50 ms. */
    void driving(float linear, float angular, std::uint64_t span_us) {
        ASSERT_EQ(ROBUROC4_OK, drive_until_refused(linear, angular, span_us)) << "at " << now_us;
    }
    /** The same until the client refuses; returns the reason, or 0. */
    roburoc4_result drive_until_refused(float linear, float angular, std::uint64_t span_us) {
        const std::uint64_t end_us = now_us + span_us;
        roburoc4_result result = ROBUROC4_OK;
        while (now_us < end_us && (result = drive(linear, angular)) >= 0)
            run(50 * ms);
        return result;
    }

    /* ---- calls at this time ---- */
    roburoc4_result arm() {
        return roburoc4_client_arm(&client, client_us());
    }
    roburoc4_result stop() {
        return roburoc4_client_stop(&client, client_us());
    }
    roburoc4_result pause() {
        return roburoc4_client_pause(&client, client_us());
    }
    roburoc4_result close() {
        return roburoc4_client_close(&client, client_us());
    }
    roburoc4_result drive(float linear, float angular, std::uint32_t lease_us = 0) {
        return roburoc4_client_drive(&client, linear, angular, lease_us, client_us());
    }
    roburoc4_result receive(const Bytes &bytes) {
        ExactBlock block(bytes);
        return roburoc4_client_receive(&client, block.data(), block.size(), client_us());
    }
    /** Pass one datagram of the client to the partner; false if nothing was due. */
    bool poll() {
        ExactBlock buffer(ROBUROC4_MAX_TRANSMIT);
        polls++;
        const roburoc4_result size =
            roburoc4_client_poll_transmit(&client, buffer.data(), buffer.size(), client_us());
        EXPECT_GE(size, 0);
        if (size <= 0)
            return false;
        const Bytes bytes(buffer.data(), buffer.data() + size);
        sent.push_back({now_us, bytes});
        Command command{};
        if (as_command(sent.back(), &command) && !command.zero()) {
            EXPECT_EQ(1, facts().armed) << "a speed of a disarmed client at " << now_us;
            EXPECT_EQ(1, facts().driving) << "a speed without a lease at " << now_us;
        }
        if (!drop_to_robot || !drop_to_robot(bytes))
            partner_.deliver(bytes);
        return true;
    }
    /** Do everything that is due at this time. */
    void pump() {
        partner_.advance(now_us);
        bool moved = true;
        while (moved) {
            moved = false;
            for (const Bytes &bytes : partner_.take())
                if (!drop_to_client || !drop_to_client(bytes))
                    flight_.emplace(now_us + (delay_to_client ? delay_to_client() : 0), bytes);
            while (!flight_.empty() && flight_.begin()->first <= now_us) {
                receive(flight_.begin()->second);
                flight_.erase(flight_.begin());
                moved = true;
            }
            while (poll())
                moved = true;
        }
    }

    /* ---- what is known ---- */
    [[nodiscard]] std::uint32_t state() const {
        return roburoc4_client_state(&client);
    }
    std::uint32_t take_events() {
        return roburoc4_client_take_events(&client);
    }
    [[nodiscard]] std::uint32_t count(std::uint32_t counter) const {
        return roburoc4_client_count(&client, counter);
    }
    [[nodiscard]] roburoc4_facts facts() const {
        roburoc4_facts facts{};
        facts.size = sizeof facts;
        EXPECT_EQ(ROBUROC4_OK, roburoc4_client_facts(&client, client_us(), &facts));
        return facts;
    }
    [[nodiscard]] roburoc4_link link() const {
        roburoc4_link link{};
        link.size = sizeof link;
        EXPECT_EQ(ROBUROC4_OK, roburoc4_client_link(&client, client_us(), &link));
        return link;
    }
    [[nodiscard]] roburoc4_service_link service_link(std::uint32_t service) const {
        roburoc4_service_link link{};
        link.size = sizeof link;
        EXPECT_EQ(ROBUROC4_OK, roburoc4_client_service_link(&client, service, client_us(), &link));
        return link;
    }
    /** Speed commands sent since then. */
    [[nodiscard]] std::vector<Command> commands(std::uint64_t since_us = 0) const {
        std::vector<Command> all;
        Command command{};
        for (const Datagram &d : sent)
            if (d.at_us >= since_us && as_command(d, &command))
                all.push_back(command);
        return all;
    }
    [[nodiscard]] std::size_t speeds(std::uint64_t since_us = 0) const {
        const auto all = commands(since_us);
        return static_cast<std::size_t>(std::count_if(
            all.begin(), all.end(), [](const Command &command) { return !command.zero(); }));
    }
    /** When the loop around the client has to continue. */
    [[nodiscard]] std::uint64_t next_us() const {
        const std::uint64_t deadline = roburoc4_client_next_deadline(&client);
        std::uint64_t next = partner_.next_us();
        if (!flight_.empty())
            next = std::min(next, flight_.begin()->first);
        if (deadline != UINT64_MAX) {
            EXPECT_GT(deadline, client_us()) << "a loop would spin in state " << state();
            next = std::min(next, deadline - static_cast<std::uint64_t>(skew_us));
        }
        return std::max(next, now_us + 1);
    }
    static bool as_command(const Datagram &d, Command *out) {
        roburoc4_differential_command c{};
        if (d.bytes.size() != 11 || d.bytes[0] != ROBUROC4_HEADER_STATUS ||
            roburoc4_decode_differential_command(d.bytes.data(), d.bytes.size(), &c) != 0)
            return false;
        *out = {d.at_us, c.linear_m_s, c.angular_rad_s};
        return true;
    }

  private:
    /** Polling just before would have returned nothing and changed nothing, also without the stored
     *  deadline, until which a poll returns at once. */
    void sleep_to(std::uint64_t later_us) {
        roburoc4_client poller = client;
        poller.private_idle_until_us = 0;
        ExactBlock buffer(ROBUROC4_MAX_TRANSMIT);
        now_us = later_us - 1;
        EXPECT_EQ(0,
                  roburoc4_client_poll_transmit(&poller, buffer.data(), buffer.size(), client_us()))
            << "due before the deadline, at " << now_us << " in state " << state();
        EXPECT_EQ(state(), roburoc4_client_state(&poller)) << "before the deadline, at " << now_us;
        EXPECT_EQ(client.private_events, poller.private_events)
            << "before the deadline, at " << now_us;
        now_us = later_us;
    }

    Partner &partner_;
    std::multimap<std::uint64_t, Bytes> flight_;
};

struct OwnRobot {
    std::unique_ptr<ScriptedRobot> own_robot; /* before the bench that uses it */
};

/** A bench with a scripted robot: its own, or one that was prepared before. */
class RobotBench : private OwnRobot, public Bench {
  public:
    explicit RobotBench(const roburoc4_config &config = default_config())
        : OwnRobot{std::make_unique<ScriptedRobot>()}, Bench(*own_robot, config),
          robot(*own_robot) {}
    explicit RobotBench(ScriptedRobot &prepared, const roburoc4_config &config = default_config())
        : Bench(prepared, config), robot(prepared) {}

    ScriptedRobot &robot;
};

/** The same after its start(), ready() or armed(). */
template <void (Bench::*begin)()> class BegunBench : public RobotBench {
  public:
    explicit BegunBench(const roburoc4_config &config = default_config()) : RobotBench(config) {
        must_begin();
    }
    explicit BegunBench(ScriptedRobot &prepared, const roburoc4_config &config = default_config())
        : RobotBench(prepared, config) {
        must_begin();
    }

  private:
    void must_begin() {
        (this->*begin)();
        if (testing::Test::HasFatalFailure())
            throw std::runtime_error("the bench did not begin");
    }
};
using Started = BegunBench<&Bench::start>;
using Ready = BegunBench<&Bench::ready>;
using Armed = BegunBench<&Bench::armed>;

/** The simulator's library as a partner. */
class SimPartner : public Partner {
  public:
    explicit SimPartner(const roburoc4_sim_config *config = nullptr)
        : sim_(roburoc4_sim_create(config), roburoc4_sim_destroy) {
        if (sim_ == nullptr)
            throw std::invalid_argument("bad simulator configuration");
    }
    [[nodiscard]] roburoc4_sim *get() const {
        return sim_.get();
    }
    [[nodiscard]] roburoc4_sim_state state() const {
        roburoc4_sim_state state{};
        state.size = sizeof state;
        EXPECT_EQ(ROBUROC4_OK, roburoc4_sim_get_state(sim_.get(), &state));
        return state;
    }
    void advance(std::uint64_t now_us) override {
        roburoc4_sim_advance(sim_.get(), now_us);
    }
    void deliver(const Bytes &datagram) override {
        roburoc4_sim_receive(sim_.get(), 1, datagram.data(), datagram.size());
    }
    std::vector<Bytes> take() override {
        std::vector<Bytes> all;
        std::array<std::uint8_t, ROBUROC4_SIM_MAX_TRANSMIT> buffer{};
        std::uint64_t peer = 0;
        roburoc4_result size = 0;
        while ((size = roburoc4_sim_poll_transmit(sim_.get(), &peer, buffer.data(),
                                                  buffer.size())) > 0)
            all.emplace_back(buffer.begin(), buffer.begin() + size);
        return all;
    }
    [[nodiscard]] std::uint64_t next_us() const override {
        return roburoc4_sim_next_deadline(sim_.get());
    }

  private:
    std::unique_ptr<roburoc4_sim, void (*)(roburoc4_sim *)> sim_;
};

} // namespace roburoc4_tests

#endif
