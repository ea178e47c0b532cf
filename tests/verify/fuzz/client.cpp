/* SPDX-License-Identifier: MIT
 *
 * Fuzzing the client: the input is a life of its own. Each byte is a step of time, a datagram of a
 * simulated robot that comes, is lost, doubled or changed, a datagram out of the input, or a call.
 * Whatever happens, no speed may leave while disarmed, after its lease, or beyond the ceilings.
 */
#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>

#include "fuzz.h"
#include "roburoc4.h"
#include "roburoc4_sim.h"

using namespace roburoc4_tests;

namespace {

constexpr std::uint64_t ms = 1000;
constexpr std::size_t most_waiting = 64, most_steps = 400;

roburoc4_config config_from(Input &in) {
    roburoc4_config config;
    roburoc4_config_init(&config, sizeof config);
    const std::uint8_t choice = in.byte();
    config.options = choice & 7;
    if ((choice & 0x40) != 0) {
        config.lease_ms = 20 + in.byte() % 200U;
        config.drive_period_ms = 10;
        config.lost_ms = 200 + 10U * in.byte();
        config.fresh_ms = 200 + in.byte();
    }
    return config;
}

/** The client under watch. */
class Watched {
  public:
    explicit Watched(const roburoc4_config &config) : config_(config) {
        expect(roburoc4_client_init(&client, sizeof client, &config) == ROBUROC4_OK, "a client");
    }

    roburoc4_client client{};

    void drive(float linear, float angular, std::uint32_t lease_ms, std::uint64_t now) {
        if (roburoc4_client_drive(&client, linear, angular, lease_ms, now) < 0)
            return;
        expect(facts(now).armed != 0, "only who is armed drives");
        lease_us_ = (lease_ms != 0 ? lease_ms : config_.lease_ms) * ms;
        granted_us_ = now;
    }
    Bytes poll(std::uint64_t now) {
        const bool armed = facts(now).armed != 0;
        Bytes bytes(ROBUROC4_MAX_TRANSMIT);
        const roburoc4_result size =
            roburoc4_client_poll_transmit(&client, bytes.data(), bytes.size(), now);
        expect(size >= 0, "it can always be polled");
        bytes.resize(static_cast<std::size_t>(size));
        judge(bytes, armed, now);
        return bytes;
    }
    void receive(const Bytes &bytes, std::uint64_t now) {
        ExactBlock block(bytes);
        const roburoc4_result result =
            roburoc4_client_receive(&client, block.data(), bytes.size(), now);
        expect(std::strcmp(roburoc4_result_text(result), "unknown error") != 0, "a known error");
    }
    roburoc4_facts facts(std::uint64_t now) {
        roburoc4_facts facts{};
        facts.size = sizeof facts;
        expect(roburoc4_client_facts(&client, now, &facts) == ROBUROC4_OK, "facts");
        return facts;
    }

  private:
    void judge(const Bytes &bytes, bool armed, std::uint64_t now) const {
        roburoc4_differential_command c;
        if (bytes.empty() ||
            roburoc4_decode_differential_command(bytes.data(), bytes.size(), &c) < 0 ||
            (c.linear_m_s == 0 && c.angular_rad_s == 0))
            return;
        expect(armed, "a speed leaves only while armed");
        expect(now - granted_us_ < lease_us_, "a speed leaves only within its lease");
        expect(std::fabs(c.linear_m_s) <= config_.max_linear_m_s &&
                   std::fabs(c.angular_rad_s) <= config_.max_angular_rad_s,
               "a speed is within the ceilings");
    }

    roburoc4_config config_;
    std::uint64_t granted_us_ = 0, lease_us_ = 0;
};

class World {
  public:
    explicit World(Input &in)
        : in_(in), config_(config_from(in)), client_(config_),
          sim_(roburoc4_sim_create(nullptr), roburoc4_sim_destroy) {
        roburoc4_sim_clear_obstacles(sim_.get());
        roburoc4_sim_advance(sim_.get(), now_us_);
    }

    void run() {
        (void)roburoc4_client_start(&client_.client, client_us());
        if ((in_.byte() & 1) != 0)
            connect();
        for (std::size_t i = 0; i < most_steps && !in_.over(); i++) {
            act(in_.byte());
        }
    }

  private:
    [[nodiscard]] std::uint64_t client_us() const {
        return now_us_ + skew_us_;
    }
    /** Runs without faults until the client is ready. */
    void connect() {
        for (int i = 0; i < 200 && roburoc4_client_state(&client_.client) != ROBUROC4_STATE_READY;
             i++) {
            step(10 * ms);
            while (deliver(false)) {
            }
        }
        step(60 * ms);
        while (deliver(false)) {
        }
    }
    void step(std::uint64_t span_us) {
        now_us_ += span_us;
        roburoc4_sim_advance(sim_.get(), now_us_);
        send();
        hear();
    }
    void send() {
        for (Bytes sent; !(sent = client_.poll(client_us())).empty();) {
            if (!deaf_)
                roburoc4_sim_receive(sim_.get(), 1, sent.data(), sent.size());
        }
    }
    void hear() {
        Bytes bytes(ROBUROC4_SIM_MAX_TRANSMIT);
        std::uint64_t peer = 0;
        roburoc4_result size = 0;
        while ((size = roburoc4_sim_poll_transmit(sim_.get(), &peer, bytes.data(), bytes.size())) >
               0)
            if (peer == 1 && waiting_.size() < most_waiting)
                waiting_.emplace_back(bytes.begin(), bytes.begin() + size);
    }
    bool deliver(bool change) {
        if (waiting_.empty())
            return false;
        Bytes bytes = waiting_.front();
        waiting_.pop_front();
        if (change)
            bytes[in_.byte() % bytes.size()] ^= in_.byte();
        receive(bytes);
        return true;
    }
    void receive(const Bytes &bytes) {
        client_.receive(bytes, client_us());
        send();
    }
    void act(std::uint8_t what);
    void drive() {
        const std::uint8_t how = in_.byte();
        const auto linear = (how & 1) != 0 ? in_.number<float>() : 0.01F * in_.byte();
        const auto angular = (how & 2) != 0 ? in_.number<float>() : 0.02F * in_.byte();
        client_.drive(linear, angular, (how & 4) != 0 ? in_.number<std::uint32_t>() : 0,
                      client_us());
    }
    void ask();

    Input &in_;
    const roburoc4_config config_;
    Watched client_;
    std::unique_ptr<roburoc4_sim, void (*)(roburoc4_sim *)> sim_;
    std::deque<Bytes> waiting_;
    std::uint64_t now_us_ = 50000000, skew_us_ = 0;
    bool deaf_ = false;
};

/** The other calls. */
void World::ask() {
    const std::uint64_t now = client_us();
    const std::uint8_t what = in_.byte();
    const std::uint32_t service = in_.byte();
    roburoc4_client *client = &client_.client;
    switch (what % 6) {
    case 0:
        (void)roburoc4_client_subscribe(client, service, 10U * in_.byte(), now);
        return;
    case 1:
        (void)roburoc4_client_subscribe(client, service, 0, now);
        return;
    case 2:
        (void)roburoc4_client_relocalize(client, in_.number<double>(), 1, 2, now);
        return;
    case 3:
        (void)roburoc4_client_set_digital_outputs(client, in_.number<std::uint64_t>(), service,
                                                  now);
        return;
    case 4:
        (void)roburoc4_client_set_analog_output(client, service, in_.number<float>(), now);
        return;
    default:
        (void)roburoc4_client_set_role_index(client, service, ROBUROC4_INDEX_AUTO, now);
        return;
    }
}

void World::act(std::uint8_t what) {
    switch (what % 20) {
    case 0:
        return step(in_.byte());
    case 1:
        return step(in_.byte() * ms);
    case 2:
        return step(in_.byte() * 20 * ms);
    case 3:
    case 4:
        deliver(false);
        return;
    case 5:
        while (deliver(false)) {
        }
        return;
    case 6:
        deliver(true);
        return;
    case 7:
        if (!waiting_.empty())
            waiting_.push_back(waiting_.front()); /* later, once more */
        return;
    case 8:
        if (!waiting_.empty())
            waiting_.pop_front();
        return;
    case 9:
        /* of up to 255 bytes, or now and then of any length */
        return receive(in_.bytes(what < 180 ? in_.byte() : in_.number<std::uint16_t>()));
    case 10:
        (void)roburoc4_client_arm(&client_.client, client_us());
        break;
    case 11:
    case 12:
        drive();
        break;
    case 13:
        (void)roburoc4_client_stop(&client_.client, client_us());
        break;
    case 14:
        (void)roburoc4_client_stop(&client_.client, client_us());
        break;
    case 15:
        ask();
        break;
    case 16:
        if (roburoc4_client_state(&client_.client) == ROBUROC4_STATE_IDLE)
            (void)roburoc4_client_start(&client_.client, client_us());
        else
            (void)roburoc4_client_close(&client_.client, client_us());
        break;
    case 17:
        deaf_ = !deaf_;
        return;
    case 18: { /* the clock steps, mostly back */
        const std::uint64_t size = in_.number<std::uint32_t>();
        skew_us_ += (in_.byte() & 1) != 0 ? size : 0 - std::min(size, client_us());
        break;
    }
    default:
        roburoc4_sim_set(sim_.get(), ROBUROC4_SIM_PAD_BUTTON + ROBUROC4_DI_PAD_A, in_.byte() & 1);
        return;
    }
    send();
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    Input in(data, size);
    World(in).run();
    return 0;
}
