/* SPDX-License-Identifier: MIT
 *
 * loopback: what the UDP adapter and the client add to a bare recv/send loop, on this machine's
 * loopback interface, interleaved: each datagram goes once each way, one right after the other, in
 * changing order. Prints one line for each, in nanoseconds: a plain socket and roburoc4; of
 * statuses in between a plain socket that is waited for with a limit of time, as who must also send
 * has to. bench/measure_loopback.py makes figures of it.
 *
 *   loopback status TIMES   status sent by the robot -> value in the application
 *   loopback drive TIMES    drive() -> datagram at the robot
 *   loopback rate ROUNDS    nanoseconds of processor time a status, of reading 64 that wait; bare
 * is recv(), a third column recvmmsg()
 */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "roburoc4_sim.h"
#include "roburoc4_udp.h"

#define BURST 64
#define LONGEST 256
#define PATIENCE_NS 1000000000U
#define SLEEPY_NS 60000      /* long enough for the other side to be asleep */
#define COMMAND_GAP_US 11000 /* the client sends commands at most each 10 ms */

typedef enum mode { SERVE, STATUS, DRIVE, STOP } mode;
/* Ways of a status; a command has no use for waiting. */
typedef enum way { BARE, WAITING, OWN, WAYS } way;

/* The robot's thread and the application's meet here only; all of it by __atomic functions. */
static int shared_mode = SERVE;
static uint64_t shared_sent_ns;    /* when the datagram that is on its way was sent */
static uint64_t shared_cycles;     /* the robot's time in it */
static uint64_t shared_arrived_ns; /* when a command arrived at the robot; 0: not yet */
static uint32_t shared_acknowledged;

static int robot_fd, bare_robot_fd, bare_fd;
static roburoc4_client client;
static roburoc4_udp udp;
/* Keeps what was read from being left out. */
static volatile double sink;

static void die(const char *what) {
    (void)fprintf(stderr, "loopback: %s: %s\n", what, strerror(errno));
    exit(1);
}

static uint64_t clock_ns(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (uint64_t)t.tv_sec * 1000000000U + (uint64_t)t.tv_nsec;
}

static uint64_t now_ns(void) {
    return clock_ns(CLOCK_MONOTONIC);
}

static void spin_ns(uint64_t ns) {
    const uint64_t begun = now_ns();
    while (now_ns() - begun < ns) {
    }
}

static uint64_t load(uint64_t *shared) {
    return __atomic_load_n(shared, __ATOMIC_ACQUIRE);
}

static void store(uint64_t *shared, uint64_t value) {
    __atomic_store_n(shared, value, __ATOMIC_RELEASE);
}

/* ---- sockets ---- */

static int loopback_socket(struct sockaddr_in *address) {
    socklen_t size = sizeof *address;
    const int fd = socket(AF_INET, SOCK_DGRAM, 0);
    memset(address, 0, sizeof *address);
    address->sin_family = AF_INET;
    address->sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (fd < 0 || bind(fd, (const struct sockaddr *)address, sizeof *address) != 0 ||
        getsockname(fd, (struct sockaddr *)address, &size) != 0) {
        die("cannot make a socket");
    }
    return fd;
}

static void join(int fd, const struct sockaddr_in *to) {
    if (connect(fd, (const struct sockaddr *)to, sizeof *to) != 0) {
        die("cannot connect");
    }
}

/** The robot's socket, the client's adapter, and a bare pair of sockets. */
static void open_sockets(void) {
    struct sockaddr_in robot, bare_robot, bare;
    struct sockaddr_in own;
    socklen_t size = sizeof own;
    char text[64];
    roburoc4_address address;
    robot_fd = loopback_socket(&robot);
    bare_robot_fd = loopback_socket(&bare_robot);
    bare_fd = loopback_socket(&bare);
    join(bare_fd, &bare_robot);
    join(bare_robot_fd, &bare);
    (void)snprintf(text, sizeof text, "127.0.0.1:%u", (unsigned)ntohs(robot.sin_port));
    if (roburoc4_udp_resolve(text, 0, &address) < 0 ||
        roburoc4_udp_open(&udp, sizeof udp, &address) < 0 ||
        getsockname((int)roburoc4_udp_fd(&udp), (struct sockaddr *)&own, &size) != 0) {
        die("cannot open the adapter");
    }
    join(robot_fd, &own);
}

/* ---- the robot's thread ---- */

static void wait_acknowledged(uint32_t before) {
    const uint64_t begun = now_ns();
    while (__atomic_load_n(&shared_acknowledged, __ATOMIC_ACQUIRE) == before) {
        if (now_ns() - begun > 10000000000U) {
            (void)fprintf(stderr, "loopback: a datagram did not arrive\n");
            exit(1);
        }
    }
}

/** The same status on each way, one after the other, in changing order. */
static void deliver(const uint8_t *datagram, size_t size) {
    static uint32_t round;
    roburoc4_status_header header;
    if (roburoc4_decode_status_header(datagram, size, &header) < 0 ||
        header.service != ROBUROC4_SERVICE_DIFFERENTIAL) {
        return;
    }
    for (uint32_t i = 0; i < WAYS; i++) {
        const way to = (way)((round + i) % WAYS);
        const uint32_t before = __atomic_load_n(&shared_acknowledged, __ATOMIC_ACQUIRE);
        spin_ns(SLEEPY_NS);
        store(&shared_cycles, header.robot_cycles);
        store(&shared_sent_ns, now_ns());
        if (send(to == OWN ? robot_fd : bare_robot_fd, datagram, size, 0) < 0) {
            die("the robot cannot send");
        }
        wait_acknowledged(before);
    }
    round++;
}

static void take_commands(roburoc4_sim *robot) {
    uint8_t datagram[LONGEST];
    ssize_t size;
    while ((size = recv(robot_fd, datagram, sizeof datagram, MSG_DONTWAIT)) > 0) {
        if (datagram[0] == ROBUROC4_HEADER_STATUS) {
            store(&shared_arrived_ns, now_ns());
        }
        roburoc4_sim_receive(robot, 1, datagram, (size_t)size);
    }
    if (recv(bare_robot_fd, datagram, sizeof datagram, MSG_DONTWAIT) > 0) {
        store(&shared_arrived_ns, now_ns());
    }
}

static void *robot_main(void *unused) {
    roburoc4_sim *robot = roburoc4_sim_create(NULL);
    const uint64_t begun_ns = now_ns();
    uint64_t ahead_us = 0;
    uint8_t datagram[ROBUROC4_SIM_MAX_TRANSMIT];
    struct pollfd watched[2] = {{robot_fd, POLLIN, 0}, {bare_robot_fd, POLLIN, 0}};
    (void)unused;
    for (;;) {
        const int now = __atomic_load_n(&shared_mode, __ATOMIC_ACQUIRE);
        size_t size;
        uint64_t peer;
        if (now == STOP) {
            break;
        }
        /* Statuses are wanted faster than one in 10 ms: its time runs ahead. */
        ahead_us += now == STATUS ? 10000 : 0;
        (void)poll(watched, 2, now == STATUS ? 0 : 1);
        take_commands(robot);
        roburoc4_sim_advance(robot, (now_ns() - begun_ns) / 1000 + ahead_us);
        while ((size = (size_t)roburoc4_sim_poll_transmit(robot, &peer, datagram,
                                                          sizeof datagram)) > 0) {
            if (now == STATUS && datagram[0] == ROBUROC4_HEADER_STATUS) {
                deliver(datagram, size);
            } else {
                (void)send(robot_fd, datagram, size, 0);
            }
        }
    }
    roburoc4_sim_destroy(robot);
    return NULL;
}

/* ---- the application ---- */

static void get_ready(void) {
    roburoc4_facts facts;
    const uint64_t begun_us = roburoc4_udp_now_us();
    memset(&facts, 0, sizeof facts);
    facts.size = sizeof facts;
    roburoc4_client_init(&client, sizeof client, NULL);
    roburoc4_client_start(&client, begun_us);
    while (!facts.descriptions_done) {
        roburoc4_udp_wait(&udp, &client, 10000);
        roburoc4_client_facts(&client, roburoc4_udp_now_us(), &facts);
        if (roburoc4_udp_now_us() - begun_us > 30000000) {
            (void)fprintf(stderr, "loopback: the client did not get ready in 30 s\n");
            exit(1);
        }
    }
}

static uint64_t bare_status(void) {
    uint8_t datagram[LONGEST];
    float speeds[4];
    if (recv(bare_fd, datagram, sizeof datagram, 0) < 27) {
        die("the bare loop cannot receive");
    }
    memcpy(speeds, datagram + 11, sizeof speeds);
    sink = (double)speeds[0] + (double)speeds[1] + (double)speeds[2] + (double)speeds[3];
    return now_ns();
}

/** The same, waiting as long as a program that has something else to do may. */
static uint64_t waiting_status(void) {
    struct pollfd watched = {bare_fd, POLLIN, 0};
    const struct timespec limit = {0, 100000000};
    if (ppoll(&watched, 1, &limit, NULL) < 0) {
        die("the bare loop cannot wait");
    }
    return bare_status(); /* which waits where the limit has passed */
}

/** When the value was there; 0 where the client did not take it: on a machine that is too busy it
 * may have lost the robot meanwhile. */
static uint64_t own_status(void) {
    static uint64_t last_cycles;
    const uint64_t begun = now_ns();
    roburoc4_differential_status status;
    do {
        roburoc4_udp_wait(&udp, &client, 100000);
        if (now_ns() - begun > PATIENCE_NS) {
            return 0;
        }
    } while (roburoc4_client_differential(&client, &status, NULL) < 0 ||
             status.robot_cycles == last_cycles || status.robot_cycles != load(&shared_cycles));
    last_cycles = status.robot_cycles;
    sink = (double)status.target_linear_m_s + (double)status.current_linear_m_s +
           (double)status.target_angular_rad_s + (double)status.current_angular_rad_s;
    return now_ns();
}

/** A line, where all ways came to an end. */
static void print_times(const uint64_t *ns, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        if (ns[i] == 0) {
            return;
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        printf("%llu%c", (unsigned long long)ns[i], i + 1 == count ? '\n' : ' ');
    }
}

static void measure_status(uint32_t rounds) {
    static uint64_t (*const receivers[WAYS])(void) = {bare_status, waiting_status, own_status};
    uint64_t ns[WAYS];
    for (uint32_t s = ROBUROC4_SERVICE_IOCARD; s < ROBUROC4_SERVICE_DIFFERENTIAL; s++) {
        roburoc4_client_subscribe(&client, s, 0, roburoc4_udp_now_us());
    }
    roburoc4_client_subscribe(&client, ROBUROC4_SERVICE_DIFFERENTIAL, 10, roburoc4_udp_now_us());
    for (uint32_t i = 0; i < 50; i++) { /* until nothing else is on its way */
        roburoc4_udp_wait(&udp, &client, 10000);
    }
    __atomic_store_n(&shared_mode, STATUS, __ATOMIC_RELEASE);
    for (uint32_t round = 0; round < rounds; round++) {
        for (uint32_t i = 0; i < WAYS; i++) {
            const way from = (way)((round + i) % WAYS);
            const uint64_t arrived = receivers[from]();
            ns[from] = arrived == 0 ? 0 : arrived - load(&shared_sent_ns);
            if (round + 1 == rounds && i + 1 == WAYS) { /* no further round is begun */
                __atomic_store_n(&shared_mode, SERVE, __ATOMIC_RELEASE);
            }
            __atomic_add_fetch(&shared_acknowledged, 1, __ATOMIC_RELEASE);
        }
        print_times(ns, WAYS);
    }
}

static void bare_drive(float linear_m_s) {
    uint8_t datagram[11] = {ROBUROC4_HEADER_STATUS, ROBUROC4_SERVICE_DIFFERENTIAL, 0};
    const float angular_rad_s = 0;
    memcpy(datagram + 3, &linear_m_s, 4);
    memcpy(datagram + 7, &angular_rad_s, 4);
    if (send(bare_fd, datagram, sizeof datagram, 0) < 0) {
        die("the bare loop cannot send");
    }
}

/** False where it was refused, or nothing was sent: on a machine that is too busy. */
static bool own_drive(float linear_m_s) {
    const roburoc4_result result =
        roburoc4_client_drive(&client, linear_m_s, 0, 1000000, roburoc4_udp_now_us());
    return result >= 0 && roburoc4_udp_transmit_all(&udp, &client) > 0;
}

/** Nanoseconds from the call to the datagram at the robot; 0 where none was sent. */
static uint64_t command_ns(bool own, float linear_m_s) {
    uint64_t sent, arrived;
    store(&shared_arrived_ns, 0);
    sent = now_ns();
    if (!own) {
        bare_drive(linear_m_s);
    } else if (!own_drive(linear_m_s)) {
        return 0;
    }
    while ((arrived = load(&shared_arrived_ns)) == 0) {
        if (now_ns() - sent > 10000000000U) {
            (void)fprintf(stderr, "loopback: a command did not arrive\n");
            exit(1);
        }
    }
    return arrived - sent;
}

/** Receive until nothing was sent for so long: then a new command leaves at once. */
static void rest(uint64_t us) {
    uint64_t begun = roburoc4_udp_now_us();
    uint32_t sent = udp.counters[ROBUROC4_UDP_COUNT_SENT];
    while (roburoc4_udp_now_us() - begun < us) {
        roburoc4_udp_wait(&udp, &client, 1000);
        if (udp.counters[ROBUROC4_UDP_COUNT_SENT] != sent) {
            sent = udp.counters[ROBUROC4_UDP_COUNT_SENT];
            begun = roburoc4_udp_now_us();
        }
    }
}

static void measure_drive(uint32_t rounds) {
    uint64_t ns[2]; /* bare, own */
    for (uint32_t round = 0; round < rounds; round++) {
        /* Another speed each time: a change leaves at once. */
        const float linear_m_s = 0.1f + 0.1f * (float)(round & 1);
        for (uint32_t half = 0; half < 2; half++) {
            const uint32_t own = (round + half) & 1;
            do {
                rest(COMMAND_GAP_US);
            } while (roburoc4_client_arm(&client, roburoc4_udp_now_us()) < 0);
            spin_ns(SLEEPY_NS);
            ns[own] = command_ns(own != 0, linear_m_s);
        }
        print_times(ns, 2);
    }
    roburoc4_client_close(&client, roburoc4_udp_now_us());
    while (roburoc4_client_state(&client) != ROBUROC4_STATE_IDLE) {
        roburoc4_udp_wait(&udp, &client, 10000);
    }
}

/* ---- how many a second ---- */

static uint64_t processor_ns(void) {
    return clock_ns(CLOCK_THREAD_CPUTIME_ID);
}

/** Let so many statuses wait in a socket. */
static void queue_statuses(int fd, uint64_t *robot_cycles) {
    for (uint32_t i = 0; i < BURST; i++) {
        const roburoc4_differential_status status = {
            ++*robot_cycles, 1, 2, 3, 4, ROBUROC4_SERVICE_DIFFERENTIAL, {0, 0, 0}};
        uint8_t datagram[LONGEST];
        const roburoc4_result size =
            roburoc4_encode_differential_status(datagram, sizeof datagram, &status);
        if (send(fd, datagram, (size_t)size, 0) < 0) {
            die("the robot cannot send");
        }
    }
}

static void read_by_recv(void) {
    for (uint32_t got = 0; got < BURST; got++) {
        (void)bare_status();
    }
}

static void read_by_recvmmsg(void) {
    static uint8_t datagrams[BURST][LONGEST];
    struct iovec parts[BURST];
    struct mmsghdr messages[BURST];
    memset(messages, 0, sizeof messages);
    for (uint32_t i = 0; i < BURST; i++) {
        parts[i].iov_base = datagrams[i];
        parts[i].iov_len = LONGEST;
        messages[i].msg_hdr.msg_iov = &parts[i];
        messages[i].msg_hdr.msg_iovlen = 1;
    }
    if (recvmmsg(bare_fd, messages, BURST, 0, NULL) != BURST) {
        die("recvmmsg");
    }
    for (uint32_t i = 0; i < BURST; i++) {
        float speeds[4];
        memcpy(speeds, datagrams[i] + 11, sizeof speeds);
        sink = (double)speeds[0] + (double)speeds[1] + (double)speeds[2] + (double)speeds[3];
    }
}

static void read_by_adapter(void) {
    roburoc4_result used = 0;
    while (used < BURST) {
        const roburoc4_result more = roburoc4_udp_wait(&udp, &client, 0);
        if (more < 0) {
            die("the adapter cannot receive");
        }
        used += more;
    }
}

static void measure_rate(uint32_t rounds) {
    static void (*const readers[3])(void) = {read_by_recv, read_by_adapter, read_by_recvmmsg};
    roburoc4_differential_status last;
    uint64_t cycles;
    rest(30000);
    __atomic_store_n(&shared_mode, STOP, __ATOMIC_RELEASE); /* from here on nobody else sends */
    rest(20000);
    roburoc4_client_differential(&client, &last, NULL);
    cycles = last.robot_cycles;
    for (uint32_t round = 0; round < rounds; round++) {
        double ns[3];
        for (uint32_t i = 0; i < 3; i++) {
            const uint32_t reader = (round + i) % 3;
            queue_statuses(reader == 1 ? robot_fd : bare_robot_fd, &cycles);
            const uint64_t begun = processor_ns();
            readers[reader]();
            ns[reader] = (double)(processor_ns() - begun) / BURST;
        }
        printf("%.1f %.1f %.1f\n", ns[0], ns[1], ns[2]);
    }
}

int main(int argc, char **argv) {
    static const char *const names[3] = {"status", "drive", "rate"};
    static void (*const measurements[3])(uint32_t) = {measure_status, measure_drive, measure_rate};
    const long times = argc == 3 ? strtol(argv[2], NULL, 10) : 0;
    uint32_t which = 0;
    pthread_t robot;
    while (which < 3 && argc > 1 && strcmp(argv[1], names[which]) != 0) {
        which++;
    }
    if (argc != 3 || which == 3 || times < 1 || times > 10000000) {
        (void)fprintf(stderr, "Usage: loopback status|drive|rate TIMES (1 to 10000000)\n");
        return 2;
    }
    open_sockets();
    if (pthread_create(&robot, NULL, robot_main, NULL) != 0) {
        die("cannot start a thread");
    }
    get_ready();
    measurements[which]((uint32_t)times);
    __atomic_store_n(&shared_mode, STOP, __ATOMIC_RELEASE);
    pthread_join(robot, NULL);
    roburoc4_udp_close(&udp);
    (void)close(robot_fd);
    (void)close(bare_robot_fd);
    (void)close(bare_fd);
    return 0;
}
