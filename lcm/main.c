/* SPDX-License-Identifier: MIT
 *
 * roburoc4-lcm: RobuROC4 robots on an LCM network. This file has the program's life and its loop:
 * one poll() on LCM's descriptor and the robots' sockets.
 */
#define _POSIX_C_SOURCE 200809L
#include <fcntl.h>
#include <lcm/lcm.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clock.h"
#include "log.h"
#include "options.h"
#include "robot.h"
#include "text.h"

enum { EXIT_DONE = 0, EXIT_ERROR = 1, EXIT_USAGE = 2, EXIT_NO_LCM = 3 };

/* A signal that comes right before poll() is seen at its end. */
#define LONGEST_WAIT_US 200000u
/* From a signal to the end; the stop sequence begins at once. */
#define CLOSING_US 600000u
/* Messages that are read before the robots have their turn again. */
#define LCM_BURST 1000
#define LCM_RETRY_US 1000000u
/* Longer than this a command's lease may not begin late. */
#define STALL_US 20000u

static options settings;
static robot robots[OPTIONS_MAX_ROBOTS];
static uint32_t robot_count; /* those that were started */
static robot_bridge this_bridge;
static gate_time last_look;
static uint64_t lcm_rests_until_us; /* LCM is not read before this; 0: it could always be read */
static volatile sig_atomic_t stop_signal;
/* SIGHUP: the terminal was closed. */
static const int stop_signals[] = {SIGINT, SIGTERM, SIGHUP};
#define STOP_SIGNALS (sizeof stop_signals / sizeof stop_signals[0])

static void on_signal(int number) {
    stop_signal = number;
}

/* ------------------------------------------------------------------------------------- LCM --- */

/* The URL is one of multicast: options_read() takes no other. */
static void explain_no_lcm(void) {
    const char *source = NULL;
    const char *url = options_lcm_url(&settings, &source);
    log_line(LOG_ERROR, NULL, "no LCM network at %s", url[0] != '\0' ? url : "LCM's default");
    (void)fputs("LCM needs a route for multicast. For programs on this machine only:\n"
                "    ip link set lo multicast on\n"
                "    ip route add 224.0.0.0/4 dev lo\n"
                "    roburoc4-lcm --lcm-url 'udpm://239.255.76.67:7667?ttl=0'\n"
                "For a network, route it through its interface, and let packets travel one hop:\n"
                "    ip route add 224.0.0.0/4 dev eth0\n"
                "    roburoc4-lcm --lcm-url 'udpm://239.255.76.67:7667?ttl=1'\n"
                "The other programs take the same URL from the variable LCM_DEFAULT_URL.\n",
                stderr);
}

/* Only newer libraries have it: the one that is loaded need not be the one that was built with. */
extern int lcm_subscription_get_queue_size(lcm_subscription_t *handler) __attribute__((weak));

/* LCM before 1.5 has no check for a fragment whose offset wraps: it writes outside of its buffer.
 */
static void warn_of_old_lcm(void) {
    if (ROBUROC4_LCM_IS_OLD || &lcm_subscription_get_queue_size == NULL) {
        log_line(LOG_NOTE, NULL,
                 "this LCM is older than 1.5: one malformed packet of 59 bytes on its network ends "
                 "the bridge, and a moving robot then stops by its own watchdog only. Build with "
                 "LCM 1.5 (pip install lcm)");
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
    for (uint32_t at = 0; at < robot_count; at++) {
        robot_hear_bridge(&robots[at], &other, channel, now);
    }
}

/* Other bridges' states, under their usual names and under ours. */
static bool subscribe_to_bridges(lcm_t *lcm) {
    static const char usual[] = ".*_BRIDGE_STATE";
    bool good = lcm_subscribe(lcm, usual, on_bridge_state, NULL) != NULL;
    for (uint32_t at = 0; good && at < settings.robot_count; at++) {
        const char *name = settings.robots[at].channels.name[CHANNEL_BRIDGE_STATE];
        const char *end = strstr(name, usual + 2);
        if (end == NULL || end[strlen(usual + 2)] != '\0') {
            good = lcm_subscribe(lcm, name, on_bridge_state, NULL) != NULL;
        }
    }
    return good;
}

/* LCM works in a thread of its own, which must not take our signals. */
static lcm_t *open_lcm(void) {
    sigset_t stops;
    sigset_t before;
    (void)sigemptyset(&stops);
    for (size_t at = 0; at < STOP_SIGNALS; at++) {
        (void)sigaddset(&stops, stop_signals[at]);
    }
    (void)sigprocmask(SIG_BLOCK, &stops, &before);
    lcm_t *lcm = lcm_create(settings.lcm_url);
    bool good = lcm != NULL && subscribe_to_bridges(lcm);
    for (uint32_t at = 0; good && at < settings.robot_count; at++) {
        good = robot_subscribe(&robots[at], lcm, &settings.robots[at]);
    }
    if (lcm != NULL && !good) {
        lcm_destroy(lcm);
        lcm = NULL;
    }
    (void)sigprocmask(SIG_SETMASK, &before, NULL);
    return lcm;
}

/* Where more time went by since the last look than was asked for, this process was stopped, or
 * starved: what it reads from now on may have come long ago. */
static void look_for_stall(uint64_t asked_us) {
    gate_time now = clock_now();
    if (now.us - last_look.us >= asked_us + STALL_US) {
        for (uint32_t at = 0; at < robot_count; at++) {
            robot_was_stalled(&robots[at], last_look.utime, now);
        }
    }
    last_look = now;
}

/* Read what LCM has. Where that fails, it is tried again after a second. */
static void read_commands(lcm_t *lcm) {
    int result = 1;
    for (int count = 0; result > 0 && count < LCM_BURST; count++) {
        look_for_stall(0);
        result = lcm_handle_timeout(lcm, 0);
    }
    if (result < 0) {
        if (lcm_rests_until_us == 0) {
            log_line(LOG_ERROR, NULL, "LCM cannot be read: no commands; trying again each second");
        }
        lcm_rests_until_us = clock_now().us + LCM_RETRY_US;
    }
}

/* ------------------------------------------------------------------------------------ loop --- */

static int wait_ms(uint64_t now_us) {
    uint64_t until_us = now_us + LONGEST_WAIT_US;
    for (uint32_t at = 0; at < robot_count; at++) {
        uint64_t deadline_us = robot_deadline(&robots[at]);
        until_us = deadline_us < until_us ? deadline_us : until_us;
    }
    return until_us <= now_us ? 0 : (int)((until_us - now_us + 999u) / 1000u);
}

/* Wait until somebody has something, or something is due. The last of `watched` is LCM. */
static void wait_for_work(lcm_t *lcm, struct pollfd *watched) {
    for (uint32_t at = 0; at < robot_count; at++) {
        watched[at].fd = (int)roburoc4_udp_fd(&robots[at].udp);
    }
    look_for_stall(0);
    watched[robot_count].fd = last_look.us < lcm_rests_until_us ? -1 : lcm_get_fileno(lcm);
    for (uint32_t at = 0; at <= robot_count; at++) {
        watched[at].events = POLLIN;
        watched[at].revents = 0;
    }
    int wait = wait_ms(last_look.us);
    (void)poll(watched, robot_count + 1, wait);
    look_for_stall((uint64_t)wait * 1000u);
}

/* Wait, then serve whoever has something. */
static void turn(lcm_t *lcm) {
    struct pollfd watched[OPTIONS_MAX_ROBOTS + 1];
    bool due[OPTIONS_MAX_ROBOTS] = {false};
    wait_for_work(lcm, watched);
    bool reads_lcm = watched[robot_count].revents != 0;
    /* First what the robots report, [A] on the game pad above all, then commands. */
    for (uint32_t at = 0; at < robot_count; at++) {
        due[at] =
            reads_lcm || watched[at].revents != 0 || robot_deadline(&robots[at]) <= last_look.us;
        if (due[at]) {
            robot_serve(&robots[at]);
        }
    }
    if (reads_lcm) {
        read_commands(lcm);
    }
    for (uint32_t at = 0; at < robot_count; at++) {
        if (due[at]) {
            robot_finish(&robots[at]);
        }
    }
}

static bool all_closed(void) {
    for (uint32_t at = 0; at < robot_count; at++) {
        if (!robot_is_closed(&robots[at])) {
            return false;
        }
    }
    return true;
}

/* Stop sequences, until the robots confirm them or the time has passed. No command is read. */
static void close_robots(lcm_t *lcm) {
    gate_time now = clock_now();
    lcm_rests_until_us = UINT64_MAX;
    for (uint32_t at = 0; at < robot_count; at++) {
        robot_close(&robots[at], now);
        robot_finish(&robots[at]);
    }
    while (!all_closed() && clock_now().us - now.us < CLOSING_US) {
        turn(lcm);
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

static void run(lcm_t *lcm) {
    gate_time now = clock_now();
    last_look = now;
    introduce_bridge(now);
    for (; robot_count < settings.robot_count; robot_count++) {
        robot_start(&robots[robot_count], &settings, &settings.robots[robot_count], &this_bridge,
                    now);
    }
    log_line(LOG_NOTE, NULL, "bridging %u robot%s; driving is %s", (unsigned)robot_count,
             robot_count == 1 ? "" : "s",
             settings.rules.enabled[GATE_DRIVE] ? "ON" : "off (--enable-drive)");
    while (stop_signal == 0) {
        turn(lcm);
    }
    close_robots(lcm);
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
    /* A log that nobody reads any more is no reason to leave a robot without a stop sequence. */
    action.sa_handler = SIG_IGN;
    (void)sigaction(SIGPIPE, &action, NULL);
}

/* Descriptors 0 to 2 that whoever started us closed, so that no socket becomes our stderr. */
static void fill_standard_files(void) {
    int file = 0;
    while (file >= 0 && file <= STDERR_FILENO) {
        file = open("/dev/null", O_RDWR);
    }
    if (file > STDERR_FILENO) {
        (void)close(file);
    }
}

/* Where the command line asks for no bridge, or for none that can be. */
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
    if (result != OPTIONS_RUN) {
        return end_early(result, error);
    }
    log_set_level(settings.level);
    lcm_t *lcm = open_lcm();
    if (lcm == NULL) {
        explain_no_lcm();
        return EXIT_NO_LCM;
    }
    catch_signals();
    warn_of_old_lcm();
    run(lcm);
    lcm_destroy(lcm);
    return EXIT_DONE;
}
