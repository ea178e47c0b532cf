/* SPDX-License-Identifier: MIT */
#include "system.h"

extern "C" {
#include "net.h"
#include "os.h"
}

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <map>
#include <mutex>

namespace virtual_system {

System sys;

int left() {
    return sys.locks + sys.signals + sys.wakes + sys.threads + sys.sockets + sys.files_open +
           sys.blocks;
}

/* ------------------------------------------------------------------------------- scheduler --- */

namespace {

/* Nobody looks at the clock, or waits, more often while no time passes. */
constexpr int kSpins = 200000;

struct Task {
    int64_t process = 1;
    bool runs = true;
    std::function<bool()> ready; /* while it does not run */
    uint64_t until_us = 0;
    int locks_held = 0;
    bool is_system = false; /* started by the code under test */
    std::condition_variable turn;
};

struct LockState {
    Task *owner = nullptr;
    int64_t process = 0; /* 0: a static lock */
};

std::mutex baton; /* whoever has it runs */
std::vector<Task *> tasks;
thread_local Task *self;
std::unique_ptr<Task> first_task;
std::multimap<uint64_t, std::function<void()>> events;
int64_t process = 1, last_process = 1;
int spins;
uint64_t spun_at_us;
std::map<const void *, LockState> locks;
struct SignalState {
    uint64_t wake_alls = 0;
    int waiters = 0;
};
std::map<const void *, SignalState> signals;
std::map<int64_t, int> raised; /* wakes, by handle */
std::map<uint16_t, Host *> hosts;
std::vector<void (*)(void)> exit_handlers;
std::map<void *, size_t> block_sizes;
int64_t last_handle;
uint64_t drawn;

struct Socket {
    roburoc4_address robot{}, own{};
    std::deque<Bytes> inbox;
    bool refused = false, is_bound = false;
    int connects = 0;
};
std::map<int64_t, Socket> sockets;

[[noreturn]] void give_up(const char *why) {
    (void)std::fprintf(stderr, "virtual time: %s at %llu us, %zu threads\n", why,
                       static_cast<unsigned long long>(sys.now_us), tasks.size());
    std::abort();
}

void advance_to(uint64_t until_us) {
    while (!events.empty() && events.begin()->first <= until_us) {
        const auto next = events.begin();
        sys.now_us = std::max(sys.now_us, next->first);
        const std::function<void()> action = std::move(next->second);
        events.erase(next);
        action();
    }
    sys.now_us = std::max(sys.now_us, until_us);
}

/* Each look at the clock, and each wait. */
void count_spin() {
    spins = sys.now_us == spun_at_us ? spins + 1 : 0;
    spun_at_us = sys.now_us;
    if (spins > kSpins) {
        give_up("a thread spins");
    }
}

size_t draw() {
    drawn = (drawn + sys.seed) * 6364136223846793005u + 1442695040888963407u;
    return static_cast<size_t>(drawn >> 40);
}

bool is_left_out(const Task *task) {
    return task->process != process || (sys.starves && task->is_system);
}

bool may_run(const Task *task) {
    return !is_left_out(task) && (task->until_us <= sys.now_us || task->ready());
}

/* The next that may run, in turn; time passes until there is one. */
Task *choose() {
    for (;;) {
        advance_to(sys.now_us);
        const auto mine = std::find(tasks.begin(), tasks.end(), self);
        const size_t start = sys.seed != 0         ? draw()
                             : mine == tasks.end() ? 0
                                                   : static_cast<size_t>(mine - tasks.begin()) + 1;
        for (size_t i = 0; i < tasks.size(); i++) {
            Task *task = tasks[(start + i) % tasks.size()];
            if (may_run(task)) {
                return task;
            }
        }
        uint64_t next_us = events.empty() ? UINT64_MAX : events.begin()->first;
        for (const Task *task : tasks) {
            if (!is_left_out(task)) {
                next_us = std::min(next_us, task->until_us);
            }
        }
        if (next_us == UINT64_MAX) {
            give_up("all threads wait forever");
        }
        advance_to(next_us);
    }
}

/* Runs others until `ready` holds or the time has come. */
void block(std::function<bool()> ready, uint64_t until_us) {
    count_spin();
    std::unique_lock<std::mutex> guard(baton, std::adopt_lock);
    self->ready = std::move(ready);
    self->until_us = until_us;
    self->runs = false;
    Task *next = choose();
    next->runs = true;
    next->turn.notify_one();
    self->turn.wait(guard, [] { return self->runs; });
    guard.release();
}

void maybe_yield() {
    if (sys.seed != 0 && draw() % 4 == 0) {
        block([] { return true; }, sys.now_us);
    }
}

void add_task(Task *task) {
    task->process = process;
    task->runs = false;
    task->ready = [] { return true; };
    tasks.push_back(task);
}

void begin_task(Task *task) {
    std::unique_lock<std::mutex> guard(baton);
    self = task;
    task->turn.wait(guard, [task] { return task->runs; });
    guard.release();
}

void end_task() {
    Task *task = self;
    task->process = -1;
    Task *next = choose();
    tasks.erase(std::find(tasks.begin(), tasks.end(), task));
    next->runs = true;
    next->turn.notify_one();
    self = nullptr;
    baton.unlock();
}

LockState &lock_at(const void *lock) {
    LockState &state = locks[lock];
    if (state.process != 0 && state.process != process) {
        sys.parents_locks_taken++;
    }
    return state;
}

} // namespace

void begin() {
    if (first_task != nullptr && tasks.size() != 1) {
        give_up("threads are left of the last test");
    }
    if (first_task == nullptr) {
        first_task = std::make_unique<Task>();
        self = first_task.get();
        tasks = {self};
        baton.lock();
    }
    sys = System();
    events.clear();
    raised.clear();
    sockets.clear();
    for (auto at = locks.begin(); at != locks.end();) {
        at = at->second.process != 0 ? locks.erase(at) : std::next(at);
    }
    signals.clear();
    hosts.clear();
    last_handle = 2;
    spins = 0;
    drawn = 0;
}

void sleep_us(uint64_t us) {
    block([] { return false; }, sys.now_us + us);
}

bool wait_until(uint64_t until_us, std::function<bool()> holds) {
    block(holds, until_us);
    return holds();
}

bool socket_is_readable(int64_t socket) {
    const auto found = sockets.find(socket);
    return found != sockets.end() && (!sys.receives.empty() || sys.receive_forever ||
                                      found->second.refused || !found->second.inbox.empty());
}

void stall_ms(uint64_t ms) {
    advance_to(sys.now_us + ms * kMs);
}

bool eventually(uint64_t limit_us, const std::function<bool()> &holds) {
    const uint64_t until_us = sys.now_us + limit_us;
    while (!holds()) {
        if (sys.now_us >= until_us) {
            return false;
        }
        sleep_ms(1);
    }
    return true;
}

void at(uint64_t at_us, std::function<void()> action) {
    events.emplace(at_us, std::move(action));
}

void in_child(const std::function<void()> &action) {
    const int64_t parent = process;
    process = ++last_process;
    self->process = process;
    action();
    process = parent;
    self->process = parent;
}

void run_exit_handlers() {
    for (size_t i = exit_handlers.size(); i > 0; i--) {
        exit_handlers[i - 1]();
    }
}

struct Thread::State {
    ::virtual_system::Task task;
    std::thread thread;
    bool over = false;
};

Thread::Thread(std::function<void()> function) : state_(std::make_unique<State>()) {
    State *state = state_.get();
    add_task(&state->task);
    state->thread = std::thread([state, function = std::move(function)] {
        begin_task(&state->task);
        function();
        state->over = true;
        end_task();
    });
}

Thread::~Thread() {
    join();
}

bool Thread::is_over() const {
    return state_->over;
}

void Thread::join() {
    if (state_->thread.joinable()) {
        State *state = state_.get();
        if (!state->over) {
            block([state] { return state->over; }, UINT64_MAX);
        }
        state->thread.join();
    }
}

/* --------------------------------------------------------------------------------- network --- */

namespace {

void deliver(int64_t handle, const Bytes &datagram) {
    const auto found = sockets.find(handle);
    if (found != sockets.end()) {
        found->second.inbox.push_back(datagram);
        if (sys.rewrites != nullptr) {
            sys.rewrites(found->second.inbox.back());
        }
    }
}

void arrive(int64_t handle, uint16_t port, const Bytes &datagram) {
    const auto host = hosts.find(port);
    if (host != hosts.end()) {
        host->second->receive(static_cast<uint64_t>(handle), datagram);
    } else if (sys.closed_ports_refuse && sockets.count(handle) != 0) {
        sockets[handle].refused = true;
    }
}

} // namespace

Host::Host(uint16_t port) : port_(port) {
    hosts[port] = this;
}

Host::~Host() {
    *alive_ = false;
    const auto found = hosts.find(port_);
    if (found != hosts.end() && found->second == this) {
        hosts.erase(found);
    }
}

void Host::send(uint64_t to, const Bytes &datagram) const {
    at(sys.now_us + sys.delay_us, [=] { deliver(static_cast<int64_t>(to), datagram); });
}

roburoc4_address Host::address() const {
    roburoc4_address address{};
    address.ip[0] = 10;
    address.ip[3] = 1;
    address.family = 4;
    address.port = port_;
    return address;
}

Robot::Robot(uint16_t port, const roburoc4_sim_config *config)
    : Host(port), sim_(roburoc4_sim_create(config)) {
    tick();
}

Robot::~Robot() {
    roburoc4_sim_destroy(sim_);
}

void Robot::turn() {
    roburoc4_sim_advance(sim_, sys.now_us);
    uint8_t buffer[ROBUROC4_SIM_MAX_TRANSMIT];
    uint64_t peer = 0;
    roburoc4_result size;
    while ((size = roburoc4_sim_poll_transmit(sim_, &peer, buffer, sizeof buffer)) > 0) {
        if (!silent) {
            send(peer, Bytes(buffer, buffer + size));
        }
    }
}

void Robot::tick() {
    turn();
    at(roburoc4_sim_next_deadline(sim_), [this, alive = alive_] {
        if (*alive) {
            tick();
        }
    });
}

void Robot::receive(uint64_t from, const Bytes &datagram) {
    roburoc4_differential_command command;
    if (roburoc4_decode_differential_command(datagram.data(), datagram.size(), &command) == 0 &&
        command.service == ROBUROC4_SERVICE_DIFFERENTIAL) {
        commands.push_back({sys.now_us, command.linear_m_s, command.angular_rad_s});
    }
    if (!silent) {
        roburoc4_sim_advance(sim_, sys.now_us);
        roburoc4_sim_receive(sim_, from, datagram.data(), datagram.size());
        turn();
    }
}

bool Robot::panel(const std::string &line) {
    char reply[ROBUROC4_SIM_REPLY_SIZE];
    return roburoc4_sim_panel(sim_, line.c_str(), reply, sizeof reply) == ROBUROC4_OK;
}

roburoc4_sim_state Robot::state() const {
    roburoc4_sim_state state{};
    state.size = sizeof state;
    roburoc4_sim_get_state(sim_, &state);
    return state;
}

double Robot::control(uint32_t number) const {
    double value = NAN;
    roburoc4_sim_get(sim_, number, &value);
    return value;
}

size_t Robot::zeros_at_the_end() const {
    size_t zeros = 0;
    while (zeros < commands.size() && commands[commands.size() - 1 - zeros].is_zero()) {
        zeros++;
    }
    return zeros;
}

size_t Robot::speeds() const {
    return static_cast<size_t>(std::count_if(
        commands.begin(), commands.end(), [](const auto &command) { return !command.is_zero(); }));
}

uint64_t Robot::last_speed_us() const {
    const size_t zeros = zeros_at_the_end();
    return zeros < commands.size() ? commands[commands.size() - 1 - zeros].at_us : 0;
}

uint64_t Robot::first_zero_us() const {
    const size_t zeros = zeros_at_the_end();
    return zeros > 0 ? commands[commands.size() - zeros].at_us : UINT64_MAX;
}

} // namespace virtual_system

using namespace virtual_system;

/* ------------------------------------------------------------------------------------ os.h --- */

namespace {

roburoc4_os_outcome outcome_of(uint32_t fault) {
    return {fault, fault == ROBUROC4_FAULT_NONE ? 0 : 1000 + static_cast<int32_t>(fault)};
}

} // namespace

extern "C" {

uint64_t roburoc4_udp_now_us(void) {
    count_spin();
    errno = EINVAL; /* without CLOCK_BOOTTIME */
    return sys.now_us;
}

roburoc4_result roburoc4_os_resolve(const char *host, uint16_t port, roburoc4_address *out) {
    const bool six = std::strcmp(host, "::1") == 0;
    const bool local = std::strcmp(host, "localhost") == 0;
    if (!six && !local && std::strcmp(host, "robot") != 0) {
        return ROBUROC4_ERR_RESOLVE;
    }
    *out = roburoc4_address{};
    out->ip[0] = six ? 0 : local ? 127 : 10;
    out->ip[six ? 15 : 3] = 1;
    out->family = six ? 6 : 4;
    out->port = port;
    return ROBUROC4_OK;
}

int roburoc4_os_ip_text(const roburoc4_address *address, char *buffer, size_t capacity) {
    const auto &ip = address->ip;
    const int length = address->family == 6 ? std::snprintf(buffer, capacity, "::%x", ip[15])
                                            : std::snprintf(buffer, capacity, "%u.%u.%u.%u", ip[0],
                                                            ip[1], ip[2], ip[3]);
    return length > 0 && static_cast<size_t>(length) < capacity;
}

int64_t roburoc4_os_socket(const roburoc4_address *, roburoc4_os_outcome *outcome) {
    *outcome = outcome_of(sys.socket_fault);
    if (sys.socket_fault != ROBUROC4_FAULT_NONE) {
        return ROBUROC4_OS_NO_SOCKET;
    }
    sockets[++last_handle] = Socket();
    sys.sockets++;
    return last_handle;
}

void roburoc4_os_close(int64_t socket) {
    if (sockets.erase(socket) == 0) {
        give_up("a socket is closed twice");
    }
    sys.sockets--;
}

roburoc4_os_outcome roburoc4_os_bind(int64_t socket, const roburoc4_address *local) {
    sockets.at(socket).own = *local;
    sockets.at(socket).is_bound = true;
    return outcome_of(sys.bind_fault);
}

roburoc4_os_outcome roburoc4_os_connect(int64_t socket, const roburoc4_address *address) {
    sys.connects_us.push_back(sys.now_us);
    Socket &connected = sockets.at(socket);
    connected.robot = *address;
    if (!connected.is_bound) { /* another one each time */
        connected.own.family = 4;
        connected.own.ip[0] = 10;
        connected.own.ip[3] = 2;
        connected.own.port = static_cast<uint16_t>(40000 + socket + 100 * connected.connects++);
    }
    return outcome_of(sys.connect_fault);
}

roburoc4_os_outcome roburoc4_os_send(int64_t socket, const uint8_t *datagram, size_t size) {
    Socket &sender = sockets.at(socket);
    uint32_t fault = sys.send_fault;
    sys.now_us += sys.send_takes_us;
    if (!sys.send_faults.empty()) {
        fault = sys.send_faults.front();
        sys.send_faults.pop_front();
    } else if (fault == ROBUROC4_FAULT_NONE && sender.refused) {
        sender.refused = false;
        fault = ROBUROC4_FAULT_REFUSED;
    }
    if (fault == ROBUROC4_FAULT_NONE) {
        const Bytes bytes(datagram, datagram + size);
        const uint16_t port = sender.robot.port;
        sys.sent.push_back(bytes);
        sys.sent_us.push_back(sys.now_us);
        at(sys.now_us + sys.delay_us, [=] { arrive(socket, port, bytes); });
    }
    return outcome_of(fault);
}

int roburoc4_os_own_address(int64_t socket, roburoc4_address *out) {
    *out = sockets.at(socket).own;
    return 1;
}

int roburoc4_os_receive(int64_t socket, uint8_t *buffer, size_t capacity, size_t *size,
                        roburoc4_os_outcome *outcome) {
    Socket &receiver = sockets.at(socket);
    int result = ROBUROC4_OS_EMPTY;
    sys.receive_calls++;
    sys.now_us += sys.receive_takes_us;
    buffer[0] = 0x01;
    *size = 1;
    if (!sys.receives.empty()) {
        result = sys.receives.front();
        sys.receives.pop_front();
    } else if (receiver.refused) {
        receiver.refused = false;
        result = ROBUROC4_OS_FAULT;
    } else if (!receiver.inbox.empty()) {
        const Bytes datagram = receiver.inbox.front();
        receiver.inbox.pop_front();
        sys.received.push_back(datagram);
        *size = std::min(datagram.size(), capacity);
        std::copy_n(datagram.begin(), *size, buffer);
        result = datagram.size() > capacity ? ROBUROC4_OS_OVERSIZED : ROBUROC4_OS_DATAGRAM;
    } else if (sys.receive_forever) {
        result = ROBUROC4_OS_DATAGRAM;
    }
    *outcome =
        outcome_of(result == ROBUROC4_OS_FAULT ? ROBUROC4_FAULT_REFUSED : ROBUROC4_FAULT_OTHER);
    return result;
}

roburoc4_result roburoc4_os_wait(int64_t socket, int64_t wake, uint64_t timeout_us) {
    sys.waits++;
    sys.waited_on = socket;
    sys.waited_us = timeout_us;
    if (sys.waits_fail && socket != ROBUROC4_OS_NO_SOCKET) {
        return ROBUROC4_ERR_SYSTEM;
    }
    if (timeout_us > 0 && self->is_system && self->locks_held > 0) {
        sys.waited_with_lock = true;
    }
    const auto readable = [=] {
        return (wake != ROBUROC4_OS_NO_SOCKET && raised[wake] > 0) || socket_is_readable(socket);
    };
    /* others run, also where there is something */
    block(readable, timeout_us < UINT64_MAX - sys.now_us ? sys.now_us + timeout_us : UINT64_MAX);
    return ROBUROC4_OK;
}

/* ----------------------------------------------------------------------------------- files --- */

uint64_t roburoc4_os_calendar_us(void) {
    return sys.calendar_us + sys.now_us;
}

void roburoc4_os_calendar_text(uint64_t calendar_us, char text[17]) {
    const std::time_t seconds = static_cast<std::time_t>(calendar_us / 1000000u);
    std::tm parts{};
    (void)gmtime_r(&seconds, &parts);
    (void)std::strftime(text, 17, "%Y%m%dT%H%M%SZ", &parts);
}

int roburoc4_os_path_kind(const char *path) {
    return sys.folders.count(path) != 0   ? ROBUROC4_OS_FOLDER
           : sys.streams.count(path) != 0 ? ROBUROC4_OS_STREAM
                                          : ROBUROC4_OS_FILE;
}

} // extern "C"

namespace {
std::map<int64_t, std::string> open_files;
}

extern "C" {

int64_t roburoc4_os_file_create(const char *path) {
    sys.creates++;
    errno = sys.create_error;
    if (sys.create_error == 0 && sys.files.count(path) != 0 && sys.streams.count(path) == 0) {
        errno = EEXIST;
    }
    if (errno != 0) {
        return ROBUROC4_OS_NO_FILE;
    }
    sys.files[path];
    sys.files_open++;
    open_files[++last_handle] = path;
    return last_handle;
}

size_t roburoc4_os_file_write(int64_t file, const uint8_t *bytes, size_t size) {
    sys.writes++;
    if (sys.disk_takes_us > 0) {
        sleep_us(sys.disk_takes_us);
    }
    if (sys.disk_hangs) {
        block([] { return !sys.disk_hangs; }, UINT64_MAX);
    }
    size = std::min(size, sys.largest_write);
    size = static_cast<size_t>(std::min<uint64_t>(size, sys.disk_room));
    if (size == 0) {
        errno = ENOSPC;
        return 0;
    }
    sys.disk_room -= sys.disk_room == UINT64_MAX ? 0 : size;
    Bytes &content = sys.files[open_files.at(file)];
    content.insert(content.end(), bytes, bytes + size);
    sys.written_us.push_back(sys.now_us);
    return size;
}

void roburoc4_os_file_truncate(int64_t file, uint64_t size) {
    sys.files[open_files.at(file)].resize(static_cast<size_t>(size));
}

void roburoc4_os_file_close(int64_t file) {
    if (open_files.erase(file) == 0) {
        give_up("a file is closed twice");
    }
    sys.files_open--;
}

/* --------------------------------------------------------------------------------- threads --- */

int64_t roburoc4_process_id(void) {
    return process;
}

int roburoc4_atomic_exchange(roburoc4_atomic *atomic, int number) {
    maybe_yield();
    const int before = atomic->number;
    atomic->number = number;
    return before;
}

int roburoc4_atomic_read(roburoc4_atomic *atomic) {
    return atomic->number;
}

int roburoc4_lock_create(roburoc4_lock *lock) {
    if (sys.lock_fails) {
        return 0;
    }
    locks[lock] = LockState{nullptr, process};
    sys.locks++;
    return 1;
}

void roburoc4_lock_destroy(roburoc4_lock *lock) {
    const auto found = locks.find(lock);
    if (found == locks.end() || found->second.owner != nullptr) {
        give_up("a lock is destroyed that is held, or none");
    }
    locks.erase(found);
    sys.locks--;
}

void roburoc4_lock_take(roburoc4_lock *lock) {
    maybe_yield();
    LockState *state = &lock_at(lock);
    if (state->owner == self) {
        give_up("a thread takes a lock that it has");
    }
    if (state->owner != nullptr) {
        block([state] { return state->owner == nullptr; }, UINT64_MAX);
    }
    state->owner = self;
    self->locks_held++;
}

void roburoc4_lock_give(roburoc4_lock *lock) {
    LockState &state = lock_at(lock);
    if (state.owner != self) {
        give_up("a thread releases a lock that it does not have");
    }
    state.owner = nullptr;
    self->locks_held--;
    maybe_yield();
}

int roburoc4_signal_create(roburoc4_signal *signal) {
    if (sys.signal_fails) {
        return 0;
    }
    signals[signal] = SignalState();
    sys.signals++;
    return 1;
}

void roburoc4_signal_destroy(roburoc4_signal *signal) {
    if (signals.at(signal).waiters > 0) {
        give_up("a signal is destroyed that a thread waits for");
    }
    signals.erase(signal);
    sys.signals--;
}

void roburoc4_signal_wake_all(roburoc4_signal *signal) {
    signals.at(signal).wake_alls++;
}

void roburoc4_signal_wait(roburoc4_signal *signal, roburoc4_lock *lock, uint64_t timeout_us) {
    SignalState &state = signals.at(signal);
    const uint64_t before = state.wake_alls;
    const uint64_t until_us =
        timeout_us < UINT64_MAX - sys.now_us ? sys.now_us + timeout_us : UINT64_MAX;
    roburoc4_lock_give(lock);
    state.waiters++;
    block([&] { return state.wake_alls != before; }, until_us);
    state.waiters--;
    roburoc4_lock_take(lock);
}

} // extern "C"

namespace {
std::map<roburoc4_thread *, std::pair<Task *, std::thread>> system_threads;
}

extern "C" {

int roburoc4_thread_start(roburoc4_thread *thread, void (*function)(void *), void *argument) {
    if (sys.thread_fails) {
        errno = EAGAIN;
        return 0;
    }
    Task *task = new Task;
    thread->function = function;
    thread->argument = argument;
    thread->over.number = 0;
    task->is_system = true;
    add_task(task);
    sys.threads++;
    system_threads[thread] = {task, std::thread([=] {
                                  begin_task(task);
                                  thread->function(thread->argument);
                                  thread->over.number = 1;
                                  end_task();
                              })};
    return 1;
}

int roburoc4_thread_is_over(roburoc4_thread *thread) {
    return thread->function == nullptr || thread->over.number != 0;
}

void roburoc4_thread_join(roburoc4_thread *thread) {
    auto found = system_threads.find(thread);
    if (found == system_threads.end()) {
        give_up("a thread is joined twice");
    }
    if (thread->over.number == 0) {
        block([=] { return thread->over.number != 0; }, UINT64_MAX);
    }
    found->second.second.join();
    delete found->second.first;
    system_threads.erase(found);
    sys.threads--;
}

int roburoc4_wake_create(roburoc4_wake *wake) {
    if (sys.wake_fails) {
        return 0;
    }
    wake->wait_on = wake->write_to = ++last_handle;
    raised[last_handle] = 0;
    sys.wakes++;
    return 1;
}

void roburoc4_wake_destroy(roburoc4_wake *wake) {
    if (raised.erase(wake->wait_on) == 0) {
        give_up("a wake is destroyed twice");
    }
    sys.wakes--;
}

void roburoc4_wake_raise(const roburoc4_wake *wake) {
    raised.at(wake->write_to)++;
    maybe_yield();
}

void roburoc4_wake_clear(const roburoc4_wake *wake) {
    raised.at(wake->wait_on) = 0;
}

/* src/ and sim/ are compiled with these names of functions of the C library. */
/* Behind each block; whatever writes there is found when the block is freed. */
static const char guard[] = "nothing is written here";

void *virtual_calloc(size_t count, size_t size);
void *virtual_calloc(size_t count, size_t size) {
    if (sys.allocations-- <= 0) {
        errno = ENOMEM;
        return nullptr;
    }
    auto *block = static_cast<char *>(std::calloc(1, count * size + sizeof guard));
    memcpy(block + count * size, guard, sizeof guard);
    block_sizes[block] = count * size;
    sys.blocks++;
    return block;
}

void *virtual_malloc(size_t size);
void *virtual_malloc(size_t size) {
    return virtual_calloc(1, size);
}

void virtual_free(void *pointer);
void virtual_free(void *pointer) {
    const auto block = block_sizes.find(pointer);
    if (block != block_sizes.end()) {
        if (memcmp(static_cast<char *>(pointer) + block->second, guard, sizeof guard) != 0) {
            std::abort();
        }
        block_sizes.erase(block);
        sys.blocks--;
    }
    std::free(pointer);
    errno = EIO; /* as old C libraries may */
}

int virtual_atexit(void (*handler)(void));
int virtual_atexit(void (*handler)(void)) {
    exit_handlers.push_back(handler);
    return 0;
}

} // extern "C"

/* ----------------------------------------------------------------------------------- net.h --- */

namespace {

/* A socket of the simulator's server. */
class Endpoint : public Host {
  public:
    explicit Endpoint(uint16_t port) : Host(port) {}
    void receive(uint64_t from, const Bytes &datagram) override {
        inbox.emplace_back(from, datagram);
    }
    bool has_news() const {
        return !inbox.empty() || !refused.empty();
    }
    std::deque<std::pair<uint64_t, Bytes>> inbox;
    std::deque<uint64_t> refused;
    bool ready = false;
};

} // namespace

struct net_sockets {
    std::vector<std::unique_ptr<Endpoint>> endpoints;
};

extern "C" {

net_sockets *net_create(size_t sockets_wanted) {
    auto *net = new net_sockets;
    net->endpoints.resize(sockets_wanted);
    return net;
}

void net_destroy(net_sockets *net) {
    delete net;
}

int net_bind(net_sockets *net, size_t index, const char *, uint16_t port, uint16_t *bound) {
    *bound = port != 0 ? port : static_cast<uint16_t>(50000 + ++last_handle);
    if (hosts.count(*bound) != 0) {
        return EADDRINUSE;
    }
    net->endpoints[index] = std::make_unique<Endpoint>(*bound);
    return 0;
}

void net_error_text(int error, char *text, size_t capacity) {
    (void)std::snprintf(text, capacity, "%s", std::strerror(error));
}

bool net_is_address(const char *) {
    return true;
}

void net_wait(net_sockets *net, bool input, uint64_t timeout_us) {
    sys.waits++;
    const auto has_news = [=] {
        return std::any_of(net->endpoints.begin(), net->endpoints.end(), [](const auto &endpoint) {
            return endpoint != nullptr && endpoint->has_news();
        });
    };
    uint64_t until_us = sys.now_us + std::min<uint64_t>(timeout_us, kSecond);
    if (input && !sys.input.empty()) {
        until_us = std::min(until_us, sys.input.front().at_us);
    }
    if (timeout_us > 0 && !has_news()) {
        block(has_news, std::max(sys.now_us, std::min(until_us, sys.stop_at_us)));
    }
    for (const auto &endpoint : net->endpoints) {
        if (endpoint != nullptr) {
            endpoint->ready = endpoint->has_news();
        }
    }
}

bool net_is_ready(const net_sockets *net, size_t index) {
    return net->endpoints[index]->ready;
}

ptrdiff_t net_receive(net_sockets *net, size_t index, uint64_t *peer, uint8_t *buffer,
                      size_t capacity) {
    auto &inbox = net->endpoints[index]->inbox;
    if (inbox.empty()) {
        return -1;
    }
    const auto [from, datagram] = inbox.front();
    inbox.pop_front();
    *peer = from;
    const size_t size = std::min(capacity, datagram.size());
    std::copy_n(datagram.begin(), size, buffer);
    return static_cast<ptrdiff_t>(size);
}

void net_send(net_sockets *net, size_t index, uint64_t peer, const uint8_t *data, size_t size) {
    Endpoint *endpoint = net->endpoints[index].get();
    if (sockets.count(static_cast<int64_t>(peer)) == 0) {
        endpoint->refused.push_back(peer);
    } else {
        endpoint->send(peer, Bytes(data, data + size));
    }
}

bool net_refused(net_sockets *net, size_t index, uint64_t *peer) {
    auto &refused = net->endpoints[index]->refused;
    if (refused.empty()) {
        return false;
    }
    *peer = refused.front();
    refused.pop_front();
    return true;
}

ptrdiff_t net_read_input(net_sockets *, char *buffer, size_t capacity) {
    if (sys.input.empty() || sys.input.front().at_us > sys.now_us) {
        return 0;
    }
    std::string &text = sys.input.front().text;
    if (text.empty()) {
        return -1;
    }
    const size_t size = std::min(capacity, text.size());
    std::copy_n(text.begin(), size, buffer);
    text.erase(0, size);
    if (text.empty()) {
        sys.input.pop_front();
    }
    return static_cast<ptrdiff_t>(size);
}

uint64_t net_now_us(void) {
    return roburoc4_udp_now_us();
}

void net_listen_for_stop(void) {}

bool net_stop_wanted(void) {
    return sys.now_us >= sys.stop_at_us;
}

} // extern "C"
