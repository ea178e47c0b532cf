/* SPDX-License-Identifier: MIT
 *
 * client.h - the client as the soak test sees it: the calls of the public API and nothing else. A
 * faulty client (faulty.h) wraps the real one to see that the oracle notices.
 */
#ifndef ROBUROC4_SOAK_CLIENT_H
#define ROBUROC4_SOAK_CLIENT_H

#include "wire.h"

#include <roburoc4.h>

#include <cstdint>

namespace soak {

/** What the client reports of itself. */
struct Report {
    std::uint32_t state = ROBUROC4_STATE_IDLE;
    std::uint32_t events = 0;
    bool armed = false;
    bool driving = false;
    bool stopping = false;
    bool override_known = false;
    bool fixed_id = false;
    bool other_commander = false;
    bool differential_known = false; /* and its properties */
    std::int32_t override_index = -1;
    std::int32_t disarm_cause = 0;
    std::uint32_t stop_outcome = 0;
    std::uint32_t age_us[5] = {}; /* in the order of RobotPlan::ids */
};

class Client {
  public:
    Client() = default;
    Client(const Client &) = delete;
    Client &operator=(const Client &) = delete;
    virtual ~Client() = default;

    virtual std::int32_t init(const roburoc4_config &config) = 0;
    virtual std::int32_t start(std::uint64_t now) = 0;
    virtual std::int32_t close(std::uint64_t now) = 0;
    virtual std::int32_t arm(std::uint64_t now) = 0;
    virtual std::int32_t drive(Speeds speeds, std::uint32_t lease_us, std::uint64_t now) = 0;
    virtual std::int32_t stop(std::uint64_t now) = 0;
    virtual std::int32_t pause(std::uint64_t now) = 0;
    virtual std::int32_t set_override_index(std::int32_t index, std::uint64_t now) = 0;
    virtual std::int32_t set_outputs(std::uint64_t mask, std::uint64_t values,
                                     std::uint64_t now) = 0;
    virtual std::int32_t relocalize(std::uint64_t now) = 0;
    virtual std::int32_t subscribe(std::uint32_t service, std::uint32_t period_ms,
                                   std::uint64_t now) = 0;
    virtual std::int32_t receive(const Datagram &datagram, std::uint64_t now) = 0;
    virtual std::int32_t poll_transmit(Datagram &out, std::uint64_t now) = 0;
    virtual std::uint64_t next_deadline() = 0;
    virtual Report report(std::uint64_t now) = 0;
};

class RealClient : public Client {
  public:
    std::int32_t init(const roburoc4_config &config) override;
    std::int32_t start(std::uint64_t now) override;
    std::int32_t close(std::uint64_t now) override;
    std::int32_t arm(std::uint64_t now) override;
    std::int32_t drive(Speeds speeds, std::uint32_t lease_us, std::uint64_t now) override;
    std::int32_t stop(std::uint64_t now) override;
    std::int32_t pause(std::uint64_t now) override;
    std::int32_t set_override_index(std::int32_t index, std::uint64_t now) override;
    std::int32_t set_outputs(std::uint64_t mask, std::uint64_t values, std::uint64_t now) override;
    std::int32_t relocalize(std::uint64_t now) override;
    std::int32_t subscribe(std::uint32_t service, std::uint32_t period_ms,
                           std::uint64_t now) override;
    std::int32_t receive(const Datagram &datagram, std::uint64_t now) override;
    std::int32_t poll_transmit(Datagram &out, std::uint64_t now) override;
    std::uint64_t next_deadline() override;
    Report report(std::uint64_t now) override;

  private:
    roburoc4_client client_{};
};

} // namespace soak

#endif
