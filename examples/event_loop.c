/* SPDX-License-Identifier: MIT
 *
 * event_loop [ROBOT]: a daemon with one epoll loop (Linux). Lines on its input are commands: "arm",
 * "stop", or a speed such as "0.3", which drives for 250 ms unless the next one comes before: who
 * commands has to keep at it. SIGTERM and SIGINT stop the robot and end the program.
 */
#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <roburoc4_udp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/signalfd.h>
#include <unistd.h>

static roburoc4_client client;
static roburoc4_udp udp;

/* Level-triggered, since roburoc4_udp_wait() may leave datagrams for the next time. */
static int watch(int loop, int descriptor) {
    struct epoll_event event = {.events = EPOLLIN, .data.fd = descriptor};
    return epoll_ctl(loop, EPOLL_CTL_ADD, descriptor, &event);
}

/* How long nothing is due to be sent. A call such as drive() makes something due at once. */
static int patience_ms(void) {
    const uint64_t due_us = roburoc4_client_next_deadline(&client);
    const uint64_t now_us = roburoc4_udp_now_us();
    if (due_us <= now_us) {
        return 0;
    }
    return due_us - now_us > 1000000 ? 1000 : (int)((due_us - now_us + 999) / 1000);
}

static roburoc4_result command(const char *line) {
    const uint64_t now_us = roburoc4_udp_now_us();
    char *end;
    const float linear_m_s = strtof(line, &end);
    if (strcmp(line, "arm") == 0) {
        return roburoc4_client_arm(&client, now_us);
    }
    if (strcmp(line, "stop") == 0) {
        return roburoc4_client_stop(&client, now_us);
    }
    if (end == line || *end != '\0') {
        return ROBUROC4_ERR_ARGUMENT;
    }
    return roburoc4_client_drive(&client, linear_m_s, 0.0f, 0, now_us);
}

/* A line comes whole from a terminal or a pipe; a stream of bytes would need a buffer. */
static int on_input(int loop) {
    char line[64];
    const ssize_t size = read(STDIN_FILENO, line, sizeof line - 1);
    if (size <= 0) { /* nobody is there any more: the lease ends */
        return epoll_ctl(loop, EPOLL_CTL_DEL, STDIN_FILENO, NULL);
    }
    line[size] = '\0';
    line[strcspn(line, "\n")] = '\0';
    printf("%s: %s\n", line, roburoc4_result_text(command(line)));
    return fflush(stdout);
}

static int on_signal(int signals) {
    struct signalfd_siginfo info;
    roburoc4_client_close(&client, roburoc4_udp_now_us()); /* the loop goes on until it stopped */
    return read(signals, &info, sizeof info) == sizeof info ? 0 : -1;
}

static int run(int loop, int signals) {
    int error = 0;
    while (error == 0 && roburoc4_client_state(&client) != ROBUROC4_STATE_IDLE) {
        struct epoll_event event;
        const int ready = epoll_wait(loop, &event, 1, patience_ms());
        if (ready > 0 && event.data.fd == signals) {
            error = on_signal(signals);
        } else if (ready > 0 && event.data.fd == STDIN_FILENO) {
            error = on_input(loop);
        }
        if (roburoc4_udp_wait(&udp, &client, 0) < 0) { /* receives, and sends what is due */
            error = -1;
        }
        if (roburoc4_client_take_events(&client) & ROBUROC4_EVENT_ARMABLE) {
            puts("ready to arm");
            error |= fflush(stdout);
        }
    }
    return error;
}

int main(int argc, char **argv) {
    const int loop = epoll_create1(EPOLL_CLOEXEC);
    roburoc4_address robot;
    roburoc4_result result;
    sigset_t ending;
    int signals;
    int error;
    result = roburoc4_udp_resolve(argc > 1 ? argv[1] : "127.0.0.1", 0, &robot);
    if (result >= 0) {
        result = roburoc4_udp_open(&udp, sizeof udp, &robot);
    }
    if (result < 0) {
        fprintf(stderr, "%s: %s\n", argc > 1 ? argv[1] : "", roburoc4_result_text(result));
        return 1;
    }
    sigemptyset(&ending);
    sigaddset(&ending, SIGTERM);
    sigaddset(&ending, SIGINT);
    sigprocmask(SIG_BLOCK, &ending, NULL);
    signals = signalfd(-1, &ending, SFD_CLOEXEC);
    if (watch(loop, (int)roburoc4_udp_fd(&udp)) < 0 || watch(loop, signals) < 0 ||
        (watch(loop, STDIN_FILENO) < 0 && errno != EPERM)) { /* a file, or /dev/null */
        perror("event_loop");
        return 1;
    }
    roburoc4_client_init(&client, sizeof client, NULL);
    roburoc4_client_start(&client, roburoc4_udp_now_us());
    error = run(loop, signals);
    roburoc4_udp_close(&udp);
    return error != 0;
}
