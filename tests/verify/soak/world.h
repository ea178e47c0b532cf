/* SPDX-License-Identifier: MIT
 *
 * world.h - virtual time: moves datagrams between a client and a robot through a bad network, wakes
 * the client at its deadlines as a good adapter does, and tells the oracle everything.
 */
#ifndef ROBUROC4_SOAK_WORLD_H
#define ROBUROC4_SOAK_WORLD_H

#include "client.h"
#include "network.h"
#include "oracle.h"
#include "robot.h"

#include <cstdint>
#include <vector>

namespace soak {

class World {
  public:
    World(const RobotPlan &plan, const roburoc4_config &config, Client &client,
          const Promises &excluded, std::uint64_t seed);

    Oracle &oracle() {
        return oracle_;
    }
    Robot &robot() {
        return robot_;
    }
    const Report &report() const {
        return report_;
    }
    std::uint64_t now_us() const {
        return now_us_;
    }
    /** What the client's clock shows. */
    std::uint64_t client_now() const {
        return now_us_ + offset_us_;
    }
    void trace(bool on) {
        trace_ = on;
    }

    /** Lets time pass, until the end or a violation. */
    void run_for(std::uint64_t us) {
        run_until(now_us_ + us);
    }
    void run_until(std::uint64_t end_us);
    /** Lets time pass while the client's machine is frozen. */
    void freeze(std::uint64_t us);
    /** The client's clock jumps. */
    void step_clock(std::int64_t us);

    /* the application's calls; each is followed by sending what is due */
    std::int32_t init_again(const roburoc4_config &config);
    std::int32_t start();
    std::int32_t close();
    std::int32_t arm();
    std::int32_t drive(Speeds speeds, std::uint32_t lease_us = 0);
    std::int32_t stop();
    std::int32_t pause();
    std::int32_t set_override_index(std::int32_t index);
    std::int32_t set_outputs(std::uint64_t mask, std::uint64_t values);
    std::int32_t relocalize();
    std::int32_t subscribe(std::uint32_t service, std::uint32_t period_ms);

    /* what happens to robot and network */
    void set_weather(const Weather &to_robot, const Weather &to_client);
    void hold_pad_a(bool held, Speeds speeds = {});
    void cut_motors(bool dead);
    void set_trouble(const Trouble &trouble);
    /** It is off, and starts again as this member (maybe another robot) with this count. */
    void reboot(const RobotPlan &plan, std::uint64_t off_us);
    void other_commander(Speeds speeds);
    void calm();

    std::uint32_t take_events();

  private:
    Truth truth() const;
    Moment moment() const {
        return {now_us_, client_now()};
    }
    std::uint64_t deadline_true() const;
    void run_robot();
    void deliver_to_client();
    void send_due();
    void poll();
    void report_all();
    std::int32_t called(const char *call, std::int32_t result);
    void say(const char *format, ...) const;
    void say_datagram(const char *what, const Datagram &datagram, std::int32_t result) const;

    Client &client_;
    roburoc4_config config_;
    Robot robot_;
    Oracle oracle_;
    Path to_robot_, to_client_;
    Report report_;
    std::vector<Datagram> from_robot_;
    std::uint64_t now_us_ = 1000000000;
    std::uint64_t offset_us_;
    std::uint64_t deadline_us_ = UINT64_MAX; /* by the client's clock */
    std::uint32_t events_ = 0;
    std::uint64_t others_until_us_ = 0;
    bool trace_ = false;
};

} // namespace soak

#endif
