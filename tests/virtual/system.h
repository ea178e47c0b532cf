/* SPDX-License-Identifier: MIT
 *
 * system.h - an operating system for tests, in virtual time: src/os.h and sim/net.h with a clock
 * that advances only while every thread waits, threads of which one at a time runs until it waits,
 * a network without sockets, and a disk in memory. What takes a second takes no time, and the same
 * test does the same in every run. A test that would wait forever, or spin, aborts.
 */
#ifndef ROBUROC4_TESTS_VIRTUAL_SYSTEM_H
#define ROBUROC4_TESTS_VIRTUAL_SYSTEM_H

#include "roburoc4_record.h"
#include "roburoc4_sim.h"

#include <climits>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace virtual_system {

using Bytes = std::vector<uint8_t>;

constexpr uint64_t kMs = 1000, kSecond = 1000000;

/* What tests set, and what they look at. begin() makes it new. */
struct System {
    /* the clock */
    uint64_t now_us = 1000000;
    uint64_t calendar_us = 1767323045000000; /* when now_us is 0: 2026-01-02T03:04:05Z */

    /* sockets of the client */
    bool closed_ports_refuse = true;
    uint64_t delay_us = 200; /* of every datagram */
    uint32_t socket_fault = ROBUROC4_FAULT_NONE;
    uint32_t bind_fault = ROBUROC4_FAULT_NONE;
    uint32_t connect_fault = ROBUROC4_FAULT_NONE;
    uint32_t send_fault = ROBUROC4_FAULT_NONE; /* of every send */
    std::deque<uint32_t> send_faults;          /* of the next sends, before that */
    std::deque<int> receives;                  /* results of the next receives, before what came */
    bool receive_forever = false;              /* a datagram is always there */
    uint64_t receive_takes_us = 0, send_takes_us = 0;
    bool waits_fail = false; /* the socket cannot be waited for */
    std::vector<Bytes> sent, received;
    std::function<void(Bytes &)> rewrites; /* what the robot sends */
    std::vector<uint64_t> sent_us, connects_us;
    int receive_calls = 0, waits = 0;
    int64_t waited_on = 0;
    uint64_t waited_us = 0;
    bool waited_with_lock = false; /* for a time, and with a lock that the test did not take */

    /* threads */
    bool lock_fails = false, signal_fails = false, wake_fails = false, thread_fails = false;
    int allocations = INT_MAX; /* that succeed from now on */
    int blocks = 0;            /* of memory, existing */
    int locks = 0, signals = 0, wakes = 0, threads = 0, sockets = 0, files_open = 0; /* existing */
    int parents_locks_taken = 0; /* by a forked child */
    bool starves = false; /* no thread that the code under test started runs; those of tests do */
    uint64_t seed = 0; /* other than 0: threads change at more places and in any order, as drawn */

    /* the disk */
    std::map<std::string, Bytes> files;
    std::set<std::string> folders, streams;
    int create_error = 0, creates = 0; /* calls */
    uint64_t disk_room = UINT64_MAX;   /* further writes fail with ENOSPC */
    uint64_t disk_takes_us = 0;        /* for each write */
    bool disk_hangs = false;           /* writes return once it does no more */
    size_t largest_write = SIZE_MAX;   /* of one call */
    int writes = 0;                    /* calls */
    std::vector<uint64_t> written_us;  /* when bytes reached the disk */

    /* the simulator's server */
    struct Input {
        uint64_t at_us;
        std::string text; /* empty: the end */
    };
    std::deque<Input> input; /* of its panel */
    uint64_t stop_at_us = UINT64_MAX;
};
extern System sys;

/* Locks, threads, sockets, blocks of memory and the like that were not given back. */
int left();

/* A new system; the calling thread is its first. The old one must have no threads. */
void begin();

/* Lets time pass for this thread while others run. */
void sleep_us(uint64_t us);
inline void sleep_ms(uint64_t ms) {
    sleep_us(ms * kMs);
}
/* Waits until `holds`, at most until this time: false then. */
bool wait_until(uint64_t until_us, std::function<bool()> holds);
/* Whether a client's socket, by its descriptor, has something to receive. */
bool socket_is_readable(int64_t socket);
/* No thread of this process runs for so long; robots do. */
void stall_ms(uint64_t ms);
/* Calls `holds` each millisecond until it returns true; false after limit_us. */
bool eventually(uint64_t limit_us, const std::function<bool()> &holds);
/* Calls `action` at this time, between what threads do. */
void at(uint64_t at_us, std::function<void()> action);
/* Calls `action` as a forked child would, in which no thread of the parent runs. */
void in_child(const std::function<void()> &action);
/* What exit() does: calls all that atexit() was given. */
void run_exit_handlers();

/* A thread of the test. */
class Thread {
  public:
    explicit Thread(std::function<void()> function);
    Thread(const Thread &) = delete;
    Thread &operator=(const Thread &) = delete;
    ~Thread();
    bool is_over() const;
    void join();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

struct SpeedCommand {
    uint64_t at_us;
    float linear_m_s, angular_rad_s;
    bool is_zero() const {
        return linear_m_s == 0.0f && angular_rad_s == 0.0f;
    }
};

/* Somebody at an address of the network. */
class Host {
  public:
    explicit Host(uint16_t port);
    Host(const Host &) = delete;
    Host &operator=(const Host &) = delete;
    virtual ~Host();
    virtual void receive(uint64_t from, const Bytes &datagram) = 0;
    /* To a client's socket. */
    void send(uint64_t to, const Bytes &datagram) const;
    roburoc4_address address() const;
    uint16_t port() const {
        return port_;
    }

  protected:
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);

  private:
    uint16_t port_;
};

/* A simulated robot that remembers each speed command and its arrival. */
class Robot : public Host {
  public:
    explicit Robot(uint16_t port = 60000, const roburoc4_sim_config *config = nullptr);
    ~Robot() override;
    void receive(uint64_t from, const Bytes &datagram) override;
    bool panel(const std::string &line);
    roburoc4_sim_state state() const;
    /* NaN if there is none. */
    double control(uint32_t number) const;
    std::vector<SpeedCommand> commands; /* also while it is silent */
    /* From now on it neither hears nor sends. */
    bool silent = false;

    /* How many zeros came last, after the last speed. */
    size_t zeros_at_the_end() const;
    size_t speeds() const;
    /* When the last speed came; 0: none has. */
    uint64_t last_speed_us() const;
    /* When the first zero after the last speed came; UINT64_MAX: none has. */
    uint64_t first_zero_us() const;

  private:
    void turn();
    void tick();
    roburoc4_sim *sim_;
};

} // namespace virtual_system

#endif
