/* SPDX-License-Identifier: MIT
 *
 * Fuzzing the client: the input is a life of its own. Each byte is a step of time, a datagram of a
 * simulated robot that comes, is lost, doubled or changed, a datagram out of the input, or a call.
 * The referee of the walk judges all that the client says and sends.
 */
#include <algorithm>
#include <deque>
#include <memory>

#include "../soak/referee.h"
#include "fuzz.h"
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

class World {
  public:
    explicit World(Input &in)
        : in_(in), config_(config_from(in)), client_(config_, RobotTruth(), false),
          sim_(roburoc4_sim_create(nullptr), roburoc4_sim_destroy) {
        roburoc4_sim_clear_world(sim_.get());
        roburoc4_sim_advance(sim_.get(), now_us_);
    }

    void run() {
        client_.start(client_us());
        if ((in_.byte() & 1) != 0)
            connect();
        for (std::size_t i = 0; i < most_steps && !in_.over(); i++) {
            act(in_.byte());
            look();
        }
    }

  private:
    [[nodiscard]] std::uint64_t client_us() const {
        return now_us_ + skew_us_;
    }
    void look() const {
        if (!client_.complaint().empty())
            broken(client_.complaint());
    }
    /** Without a fault until it is ready. */
    void connect() {
        for (int i = 0; i < 200 && client_.state() != ROBUROC4_STATE_READY; i++) {
            step(10 * ms);
            while (deliver(false))
                look();
        }
        step(60 * ms);
        while (deliver(false))
            look();
    }
    void step(std::uint64_t span_us) {
        now_us_ += span_us;
        roburoc4_sim_advance(sim_.get(), now_us_);
        send();
        hear();
    }
    void send() {
        for (Bytes sent; !(sent = client_.poll(client_us())).empty();) {
            look();
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
        receive(bytes, change);
        return true;
    }
    void receive(const Bytes &bytes, bool damaged) {
        client_.receive(bytes, damaged, client_us());
        look();
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
    Referee client_;
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
    client_.other(now, [&](roburoc4_client *client) -> roburoc4_result {
        switch (what % 6) {
        case 0:
            return roburoc4_client_subscribe(client, service, 10U * in_.byte(), now);
        case 1:
            return roburoc4_client_unsubscribe(client, service, now);
        case 2:
            return roburoc4_client_relocalize(client, in_.number<double>(), 1, 2, now);
        case 3:
            return roburoc4_client_set_digital_outputs(client, in_.number<std::uint64_t>(), service,
                                                       now);
        case 4:
            return roburoc4_client_set_analog_output(client, service, in_.number<float>(), now);
        default:
            return roburoc4_client_set_role_index(client, service, ROBUROC4_INDEX_AUTO, now);
        }
    });
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
        return receive(in_.bytes(what < 180 ? in_.byte() : in_.number<std::uint16_t>()), true);
    case 10:
        client_.arm(client_us());
        break;
    case 11:
    case 12:
        drive();
        break;
    case 13:
        client_.stop(client_us());
        break;
    case 14:
        client_.disarm(client_us());
        break;
    case 15:
        ask();
        break;
    case 16:
        if (client_.state() == ROBUROC4_STATE_IDLE)
            client_.start(client_us());
        else
            client_.close(client_us());
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
        roburoc4_sim_set_pad_button(sim_.get(), ROBUROC4_DI_PAD_A, in_.byte() & 1);
        return;
    }
    look();
    send();
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    Input in(data, size);
    World(in).run();
    return 0;
}
