/* SPDX-License-Identifier: MIT
 *
 * roburoc4-lcm: RobuROC4 robots on an LCM network. This file has main() and the main loop, which
 * waits for LCM's descriptor and the robots' sockets. The cost of a status does not depend on the
 * number of robots.
 */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <fcntl.h>
#include <lcm/lcm.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "clock.h"
#include "filter.h"
#include "log.h"
#include "network.h"
#include "options.h"
#include "robot.h"
#include "text.h"
#include "watch.h"

enum { EXIT_DONE = 0, EXIT_ERROR = 1, EXIT_USAGE = 2, EXIT_NO_LCM = 3 };

/* The longest wait, so that a signal that arrives right before poll() is noticed. */
#define LONGEST_WAIT_US 200000u
/* The longest time from a signal to exit; the stop sequence begins at once. */
#define CLOSING_US 600000u
/* At most this many messages are read before the robots are served again. */
#define LCM_BURST 1000
#define LCM_RETRY_US 1000000u
/* LCM drops new messages when this many are unread. */
#define QUEUE_CAPACITY 10000
/* LCM's number for watch_set(); a robot's is its index + 1. */
#define WATCHED_LCM 0u
/* From this many robots on, LCM's socket gets this large a buffer, if the system allows it. */
#define MANY_ROBOTS 32u
#define RECEIVE_BYTES (4 << 20)
/* Descriptors in addition to those of the robots. */
#define OTHER_FILES 64u

static options settings;
static robot robots[OPTIONS_MAX_ROBOTS];
static uint32_t robot_count; /* robots that were started */
static uint64_t deadlines_us[OPTIONS_MAX_ROBOTS];
/* Robots that this iteration of the loop has served. */
static bool served[OPTIONS_MAX_ROBOTS];
static uint32_t serving[OPTIONS_MAX_ROBOTS];
static uint32_t serving_count;
/* Robots by address, to find those that another bridge serves. */
static channels_entry addresses[OPTIONS_MAX_ROBOTS];
static channels_directory by_address = {addresses, 0};
static robot_bridge this_bridge;
static roburoc4_recorder *recorder; /* records all robots, or NULL */
static gate_stall stall;            /* of this process */
static uint64_t lcm_rests_until_us; /* LCM is not read before this time; 0: no error so far */
static volatile sig_atomic_t stop_signal;
/* SIGHUP: the terminal was closed. */
static const int stop_signals[] = {SIGINT, SIGTERM, SIGHUP};
#define STOP_SIGNALS (sizeof stop_signals / sizeof stop_signals[0])

static void on_signal(int number) {
    stop_signal = number;
}

/* ------------------------------------------------------------------------------------- LCM --- */

/* The URL is a multicast URL: options_read() accepts no other. */
static void explain_no_lcm(void) {
    const char *source = NULL;
    const char *url = options_lcm_url(&settings, &source);
    log_line(LOG_ERROR, NULL, "no LCM network at %s", url[0] != '\0' ? url : "LCM's default");
    (void)fputs("LCM needs a multicast route. For programs on this machine only:\n"
                "    ip link set lo multicast on\n"
                "    ip route add 224.0.0.0/4 dev lo\n"
                "    roburoc4-lcm --lcm-url 'udpm://239.255.76.67:7667?ttl=0'\n"
                "For a network, through its interface and with packets that travel one hop:\n"
                "    ip route add 224.0.0.0/4 dev eth0\n"
                "    roburoc4-lcm --lcm-url 'udpm://239.255.76.67:7667?ttl=1'\n"
                "Other programs read the URL from the environment variable LCM_DEFAULT_URL.\n",
                stderr);
}

/* Only newer libraries have it, and the loaded library may be older than the one we were built
 * with. */
extern int lcm_subscription_get_queue_size(lcm_subscription_t *handler) __attribute__((weak));

static bool may_drive(void) {
    for (uint32_t at = 0; at < settings.robot_count; at++) {
        if (settings.robots[at].rules.enabled[GATE_DRIVE]) {
            return true;
        }
    }
    return false;
}

/* Before LCM 1.5, a fragment whose offset wraps around is written outside of the buffer: one packet
 * of 59 bytes ends the bridge. Where the system cannot drop such packets, such a bridge must not
 * drive. */
static bool bear_with_old_lcm(void) {
    const char *source = NULL;
    const uint16_t port = network_port(options_lcm_url(&settings, &source));
    if ((!ROBUROC4_LCM_IS_OLD && &lcm_subscription_get_queue_size != NULL) || port == 0 ||
        filter_fragments(port)) {
        return true;
    }
    log_line(may_drive() ? LOG_ERROR : LOG_NOTE, NULL,
             "this LCM is older than 1.5: one malformed packet on its network ends the bridge, %s. "
             "Build with LCM 1.5 (pip install lcm)",
             may_drive() ? "so it does not drive" : "and this system cannot drop such packets");
    return !may_drive();
}

/* Read what the robot sent, once per iteration; robot_finish() is called at its end. */
static void serve(uint32_t at) {
    if (!served[at]) {
        served[at] = true;
        serving[serving_count++] = at;
        robot_serve(&robots[at]);
    }
}

static void on_bridge_state(const lcm_recv_buf_t *message, const char *channel, void *user) {
    gate_time now = clock_now();
    bridge_identity other;
    (void)user;
    if (!bridge_identity_decode(message->data, message->data_size, &other) ||
        (strcmp(other.bridge, this_bridge.name) == 0 &&
         other.started_utime == this_bridge.started_utime)) {
        return;
    }
    const channels_entry *by_channel = channels_look_up(&settings.directory, channel);
    const channels_entry *by_robot = channels_look_up(&by_address, other.robot);
    if (by_channel != NULL && by_channel->which != OPTIONS_FLEET_STOP) {
        robot_hear_bridge(&robots[by_channel->which / CHANNELS], &other, channel, now);
    }
    if (by_robot != NULL) {
        robot_hear_bridge(&robots[by_robot->which], &other, channel, now);
    }
}

/* Called by LCM for each message on a command channel. The robot's statuses are read first, because
 * [A] on the game pad has priority. Stop commands have their own queue (user != NULL), which other
 * commands cannot fill. */
static void on_command(const lcm_recv_buf_t *message, const char *channel, void *user) {
    const channels_entry *found = channels_look_up(&settings.directory, channel);
    if (found == NULL) {
        return;
    }
    if (found->which == OPTIONS_FLEET_STOP) {
        for (uint32_t at = 0; user != NULL && at < robot_count; at++) {
            serve(at);
            robot_take_message(&robots[at], CHANNEL_STOP_CMD, message->data, message->data_size,
                               gate_arrival(&stall, message->recv_utime));
        }
        return;
    }
    enum channel which = (enum channel)(found->which % CHANNELS);
    uint32_t at = found->which / CHANNELS;
    if ((which == CHANNEL_STOP_CMD) == (user != NULL)) {
        serve(at);
        robot_take_message(&robots[at], which, message->data, message->data_size,
                           gate_arrival(&stall, message->recv_utime));
    }
}

static bool subscribe(lcm_t *lcm, const char *pattern, lcm_msg_handler_t handler, void *user) {
    lcm_subscription_t *subscription = lcm_subscribe(lcm, pattern, handler, user);
    return subscription != NULL &&
           lcm_subscription_set_queue_capacity(subscription, QUEUE_CAPACITY) == 0;
}

static bool ends_in(const char *name, const char *end) {
    size_t length = strlen(name);
    return length >= strlen(end) && strcmp(name + length - strlen(end), end) == 0;
}

/* Subscribe to a few patterns for all robots, because LCM compares each new channel with every
 * pattern. All commands end in _CMD; those for other bridges are ignored. */
static bool subscribe_to_all(lcm_t *lcm) {
    static const char stop[] = "_STOP_CMD";
    static const char state[] = "_BRIDGE_STATE";
    bool good = subscribe(lcm, ".*_CMD", on_command, NULL) &&
                subscribe(lcm, ".*_STOP_CMD", on_command, lcm) &&
                subscribe(lcm, ".*_BRIDGE_STATE", on_bridge_state, NULL);
    if (good && settings.fleet_stop[0] != '\0' && !ends_in(settings.fleet_stop, stop)) {
        good = subscribe(lcm, settings.fleet_stop, on_command, lcm);
    }
    for (uint32_t at = 0; good && at < settings.robot_count; at++) {
        const channel_names *own = &settings.robots[at].channels;
        if (!ends_in(own->name[CHANNEL_STOP_CMD], stop)) {
            good = subscribe(lcm, own->name[CHANNEL_STOP_CMD], on_command, lcm);
        }
        if (good && !ends_in(own->name[CHANNEL_BRIDGE_STATE], state)) {
            good = subscribe(lcm, own->name[CHANNEL_BRIDGE_STATE], on_bridge_state, NULL);
        }
    }
    return good;
}

/* The URL for lcm_create(). A bridge also receives everything that it publishes; with many robots
 * it needs a larger buffer so that no commands are lost. */
static const char *lcm_url(void) {
    static char room[OPTIONS_MAX_TEXT + 64];
    const char *source = NULL;
    const char *url = options_lcm_url(&settings, &source);
    url = url[0] != '\0' ? url : "udpm://";
    if (settings.robot_count < MANY_ROBOTS || strncmp(url, "udpm", 4) != 0 ||
        strstr(url, "recv_buf_size") != NULL) {
        return settings.lcm_url[0] != '\0' ? settings.lcm_url : NULL;
    }
    (void)snprintf(room, sizeof room, "%s%crecv_buf_size=%d", url, strchr(url, '?') ? '&' : '?',
                   RECEIVE_BYTES);
    return room;
}

/* LCM has its own thread, which must not receive our signals. */
static lcm_t *open_lcm(void) {
    sigset_t stops;
    sigset_t before;
    (void)sigemptyset(&stops);
    for (size_t at = 0; at < STOP_SIGNALS; at++) {
        (void)sigaddset(&stops, stop_signals[at]);
    }
    (void)sigprocmask(SIG_BLOCK, &stops, &before);
    lcm_t *lcm = lcm_create(lcm_url());
    if (lcm != NULL && !subscribe_to_all(lcm)) {
        lcm_destroy(lcm);
        lcm = NULL;
    }
    (void)sigprocmask(SIG_SETMASK, &before, NULL);
    return lcm;
}

static void look_for_stall(uint64_t asked_us) {
    uint64_t since_us = 0;
    gate_time now = clock_now();
    if (gate_look_for_stall(&stall, asked_us, now, &since_us)) {
        for (uint32_t at = 0; at < robot_count; at++) {
            gate_was_stalled(&robots[at].gate, since_us, now.us);
        }
    }
}

/* Read the messages that LCM has. After an error, retry after a second. */
static void read_commands(lcm_t *lcm) {
    int result = 1;
    for (int count = 0; result > 0 && count < LCM_BURST; count++) {
        look_for_stall(0);
        result = lcm_handle_timeout(lcm, 0);
    }
    if (result < 0) {
        if (lcm_rests_until_us == 0) {
            log_line(LOG_ERROR, NULL,
                     "cannot read from LCM: no commands arrive; retrying every second");
        }
        lcm_rests_until_us = clock_now().us + LCM_RETRY_US;
    }
}

/* ------------------------------------------------------------------------------------ loop --- */

static int wait_ms(uint64_t now_us) {
    uint64_t until_us = now_us + LONGEST_WAIT_US;
    for (uint32_t at = 0; at < robot_count; at++) {
        until_us = deadlines_us[at] < until_us ? deadlines_us[at] : until_us;
    }
    return until_us <= now_us ? 0 : (int)((until_us - now_us + 999u) / 1000u);
}

static uint32_t wait_for_work(lcm_t *lcm, uint32_t *ready) {
    look_for_stall(0);
    watch_set(WATCHED_LCM, stall.last_look.us < lcm_rests_until_us ? -1 : lcm_get_fileno(lcm));
    int wait = wait_ms(stall.last_look.us);
    uint32_t count = watch_wait(wait, ready);
    look_for_stall((uint64_t)wait * 1000u);
    return count;
}

static void serve_due_robots(lcm_t *lcm) {
    static uint32_t ready[WATCH_MAX];
    uint32_t count = wait_for_work(lcm, ready);
    bool reads_lcm = false;
    /* First what the robots report, then commands. */
    for (uint32_t at = 0; at < count; at++) {
        if (ready[at] == WATCHED_LCM) {
            reads_lcm = true;
        } else {
            serve(ready[at] - 1);
        }
    }
    for (uint32_t at = 0; at < robot_count; at++) {
        if (deadlines_us[at] <= stall.last_look.us) {
            serve(at);
        }
    }
    if (reads_lcm) {
        read_commands(lcm);
    }
    for (uint32_t at = 0; at < serving_count; at++) {
        robot_finish(&robots[serving[at]]);
        deadlines_us[serving[at]] = robot_deadline(&robots[serving[at]]);
        served[serving[at]] = false;
    }
    serving_count = 0;
}

static bool all_closed(void) {
    for (uint32_t at = 0; at < robot_count; at++) {
        if (!robot_is_closed(&robots[at])) {
            return false;
        }
    }
    return true;
}

/* Send stop sequences until the robots confirm them or the time is over. Commands are no longer
 * read. */
static void close_robots(lcm_t *lcm) {
    gate_time now = clock_now();
    lcm_rests_until_us = UINT64_MAX;
    for (uint32_t at = 0; at < robot_count; at++) {
        robot_close(&robots[at], now);
        robot_finish(&robots[at]);
        deadlines_us[at] = robot_deadline(&robots[at]);
    }
    while (!all_closed() && clock_now().us - now.us < CLOSING_US) {
        serve_due_robots(lcm);
    }
    for (uint32_t at = 0; at < robot_count; at++) {
        robot_end(&robots[at]);
    }
}

static void introduce_bridge(gate_time now) {
    char host[64] = "";
    (void)gethostname(host, sizeof host - 1);
    host[strcspn(host, " ")] = '\0';
    if (!text_is_utf8((const uint8_t *)host, strlen(host))) {
        host[0] = '\0';
    }
    (void)snprintf(this_bridge.name, sizeof this_bridge.name, "%s %ld", host, (long)getpid());
    this_bridge.started_utime = now.utime;
}

static void start_robots(lcm_t *lcm, gate_time now) {
    uint32_t can_drive = 0;
    for (; robot_count < settings.robot_count; robot_count++) {
        uint32_t at = robot_count;
        const options_robot *robot = &settings.robots[at];
        robot_start(&robots[at], at + 1, robot, lcm, &this_bridge, recorder, now);
        addresses[at] = (channels_entry){robots[at].address, at};
        can_drive += robot->rules.enabled[GATE_DRIVE];
    }
    by_address.count = robot_count;
    (void)channels_sort(&by_address);
    log_line(LOG_NOTE, NULL, "bridging %u robot%s; driving is %s%s", (unsigned)robot_count,
             robot_count == 1 ? "" : "s",
             can_drive == 0             ? "off"
             : can_drive == robot_count ? "ON"
                                        : "ON for some",
             can_drive == 0 ? " (--enable-drive)" : "");
}

/* ------------------------------------------------------------------------------- recording --- */

/* If recording was requested but cannot start, the bridge does not start either. */
static bool begin_recording(void) {
    roburoc4_recorder_options how = {.size = sizeof how, .robot = "roburoc4-lcm"};
    if (settings.record[0] == '\0') {
        return true;
    }
    recorder = roburoc4_recorder_open(settings.record, &how, NULL);
    if (recorder == NULL) {
        log_line(LOG_ERROR, NULL, "--record %s: %s", settings.record, strerror(errno));
        return false;
    }
    roburoc4_recorder_state state;
    roburoc4_recorder_get_state(recorder, &state);
    log_line(LOG_NOTE, NULL, "recording to %s", state.path);
    return true;
}

static void end_recording(void) {
    roburoc4_recorder_state last = {0};
    (void)roburoc4_recorder_close(recorder, &last);
    if (last.dropped > 0) {
        log_line(LOG_ERROR, NULL,
                 "%s: %llu datagrams are missing because the disk was full or slow: %s", last.path,
                 (unsigned long long)last.dropped, strerror(last.system_error));
    }
}

/* --------------------------------------------------------------------------------- process --- */

static void run(lcm_t *lcm) {
    gate_time now = clock_now();
    stall.last_look = now;
    introduce_bridge(now);
    start_robots(lcm, now);
    while (stop_signal == 0) {
        serve_due_robots(lcm);
    }
    close_robots(lcm);
    log_line(LOG_NOTE, NULL, "ended by SIG%s; the robots were told to stop",
             stop_signal == SIGINT    ? "INT"
             : stop_signal == SIGTERM ? "TERM"
                                      : "HUP");
}

/* Each robot needs a socket. */
static void allow_sockets(void) {
    struct rlimit files;
    rlim_t needed = (rlim_t)settings.robot_count + OTHER_FILES;
    if (getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur < needed) {
        files.rlim_cur = needed < files.rlim_max ? needed : files.rlim_max;
        (void)setrlimit(RLIMIT_NOFILE, &files);
    }
}

static void catch_signals(void) {
    struct sigaction action = {.sa_handler = on_signal};
    struct sigaction before;
    (void)sigemptyset(&action.sa_mask);
    for (size_t at = 0; at < STOP_SIGNALS; at++) {
        (void)sigaction(stop_signals[at], &action, &before);
        if (stop_signals[at] == SIGHUP && before.sa_handler == SIG_IGN) { /* nohup */
            (void)sigaction(SIGHUP, &before, NULL);
        }
    }
    /* A closed log pipe must not end the bridge before the stop sequence. */
    action.sa_handler = SIG_IGN;
    (void)sigaction(SIGPIPE, &action, NULL);
}

/* Reopen descriptors 0 to 2 if the parent closed them, so that no socket becomes stderr. */
static void fill_standard_files(void) {
    int file = 0;
    while (file >= 0 && file <= STDERR_FILENO) {
        file = open("/dev/null", O_RDWR);
    }
    if (file > STDERR_FILENO) {
        (void)close(file);
    }
}

/* Exit without running a bridge: help, version, or an error. */
static int end_early(enum options_result result, const char *error) {
    switch (result) {
    case OPTIONS_HELP:
        (void)fputs(options_help, stdout);
        return fflush(stdout) == 0 ? EXIT_DONE : EXIT_ERROR;
    case OPTIONS_VERSION:
        (void)printf("roburoc4-lcm %d.%d.%d (built with LCM %s)\n", ROBUROC4_VERSION_MAJOR,
                     ROBUROC4_VERSION_MINOR, ROBUROC4_VERSION_PATCH, ROBUROC4_LCM_VERSION);
        return fflush(stdout) == 0 ? EXIT_DONE : EXIT_ERROR;
    default:
        log_line(LOG_ERROR, NULL, "%s", error);
        return result == OPTIONS_BAD ? EXIT_USAGE : EXIT_ERROR;
    }
}

int main(int count, char **arguments) {
    char error[OPTIONS_ERROR_SIZE];
    fill_standard_files();
    enum options_result result = options_read(count, arguments, &settings, error, sizeof error);
    if (result == OPTIONS_RUN) {
        result = options_resolve(&settings, error, sizeof error);
    }
    /* In a fleet, a robot whose name has no address does not keep the others from running. */
    bool is_alone = settings.robot_count == 1;
    if (settings.check && (result == OPTIONS_RUN || result == OPTIONS_NO_ADDRESS)) {
        options_print(&settings);
    }
    if (settings.check && result == OPTIONS_RUN) {
        return fflush(stdout) == 0 ? EXIT_DONE : EXIT_ERROR;
    }
    if (result != OPTIONS_RUN && (settings.check || is_alone || result != OPTIONS_NO_ADDRESS)) {
        return end_early(result, error);
    }
    log_set_level(settings.level);
    allow_sockets();
    if (!watch_begin()) {
        log_line(LOG_ERROR, NULL, "cannot wait for sockets: %s", strerror(errno));
        return EXIT_ERROR;
    }
    lcm_t *lcm = open_lcm();
    if (lcm == NULL) {
        explain_no_lcm();
        return EXIT_NO_LCM;
    }
    if (!bear_with_old_lcm() || !begin_recording()) {
        lcm_destroy(lcm);
        return EXIT_ERROR;
    }
    catch_signals();
    run(lcm);
    end_recording();
    lcm_destroy(lcm);
    return EXIT_DONE;
}
