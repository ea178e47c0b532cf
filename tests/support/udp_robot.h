/* SPDX-License-Identifier: MIT
 *
 * udp_robot.h - the simulator's library behind a loopback socket, on a thread of the test: a robot
 * that the test can control, and that remembers every speed command and its arrival.
 */
#ifndef ROBUROC4_TESTS_UDP_ROBOT_H
#define ROBUROC4_TESTS_UDP_ROBOT_H

#include "roburoc4_sim.h"
#include "udp_support.h"

#include <atomic>
#include <mutex>
#include <string>
#include <thread>

namespace test {

struct SpeedCommand {
    uint64_t at_us;
    float linear_m_s, angular_rad_s;
    bool is_zero() const {
        return linear_m_s == 0.0f && angular_rad_s == 0.0f;
    }
};

class UdpRobot {
  public:
    explicit UdpRobot(uint16_t port = 0)
        : socket_(port), sim_(roburoc4_sim_create(nullptr)), thread_([this] { run(); }) {}
    UdpRobot(const UdpRobot &) = delete;
    UdpRobot &operator=(const UdpRobot &) = delete;
    ~UdpRobot() {
        running_ = false;
        thread_.join();
        roburoc4_sim_destroy(sim_);
    }

    roburoc4_address address() const {
        return socket_.address();
    }
    uint16_t port() const {
        return socket_.port();
    }
    /* Executes a line of the control panel; true if the robot could. */
    bool panel(const std::string &line) {
        std::lock_guard<std::mutex> guard(mutex_);
        char reply[ROBUROC4_SIM_REPLY_SIZE];
        return roburoc4_sim_panel(sim_, line.c_str(), reply, sizeof reply) == ROBUROC4_OK;
    }
    roburoc4_sim_state state() {
        std::lock_guard<std::mutex> guard(mutex_);
        roburoc4_sim_state state{};
        state.size = sizeof state;
        roburoc4_sim_get_state(sim_, &state);
        return state;
    }
    std::vector<SpeedCommand> commands() {
        std::lock_guard<std::mutex> guard(mutex_);
        return commands_;
    }

  private:
    void hear(const Received &got) {
        roburoc4_differential_command command;
        roburoc4_sim_receive(sim_, key_of(got.from), got.bytes.data(), got.bytes.size());
        if (roburoc4_decode_differential_command(got.bytes.data(), got.bytes.size(), &command) ==
                0 &&
            command.service == ROBUROC4_SERVICE_DIFFERENTIAL) {
            commands_.push_back({roburoc4_udp_now_us(), command.linear_m_s, command.angular_rad_s});
        }
    }
    void say() {
        uint8_t buffer[ROBUROC4_SIM_MAX_TRANSMIT];
        uint64_t peer = 0;
        roburoc4_result size;
        while ((size = roburoc4_sim_poll_transmit(sim_, &peer, buffer, sizeof buffer)) > 0) {
            sockaddr_in to = loopback(static_cast<uint16_t>(peer));
            to.sin_addr.s_addr = static_cast<in_addr_t>(peer >> 16);
            socket_.send(to, std::vector<uint8_t>(buffer, buffer + size));
        }
    }
    void run() {
        while (running_) {
            Received got = socket_.receive(2);
            std::lock_guard<std::mutex> guard(mutex_);
            roburoc4_sim_advance(sim_, roburoc4_udp_now_us());
            if (got.from.sin_port != 0) {
                hear(got);
            }
            say();
        }
    }
    static uint64_t key_of(const sockaddr_in &from) {
        return uint64_t{from.sin_addr.s_addr} << 16 | ntohs(from.sin_port);
    }

    Socket socket_;
    std::mutex mutex_; /* guards all below */
    roburoc4_sim *sim_;
    std::vector<SpeedCommand> commands_;
    std::atomic<bool> running_{true};
    std::thread thread_; /* last, so that it finds all else made */
};

} // namespace test

#endif
