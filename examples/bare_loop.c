/* SPDX-License-Identifier: MIT
 *
 * bare_loop: the core alone, as in the main loop of a microcontroller. No socket, no thread, no
 * clock: the robot is the simulator, time is a number, and datagrams are handed over by hand.
 *
 * On your board, robot_sends() and robot_gets() are your network, now_us is your timer.
 */
#include <stdio.h>

#include "roburoc4.h"
#include "roburoc4_sim.h"

#define PEER 1 /* how the simulator knows us */

static roburoc4_client client; /* all the memory that a client takes */
static roburoc4_sim *robot;

static size_t robot_sends(uint8_t *datagram, size_t capacity) {
    uint64_t peer;
    return (size_t)roburoc4_sim_poll_transmit(robot, &peer, datagram, capacity);
}

static void robot_gets(const uint8_t *datagram, size_t size) {
    roburoc4_sim_receive(robot, PEER, datagram, size);
}

/* What the application does when something changed: drive 1 m forward. Returns 1 at its end. */
static int application(uint32_t events, uint64_t now_us) {
    static enum { WAITING, DRIVING, STOPPING } phase = WAITING;
    double now_s = (double)now_us * 1e-6;
    roburoc4_localization_status pose;

    if (events & ROBUROC4_EVENT_READY) {
        printf("%5.2f s  ready\n", now_s);
    }
    switch (phase) {
    case WAITING:
        if (roburoc4_client_arm(&client, now_us) == 0) {
            printf("%5.2f s  armed\n", now_s);
            phase = DRIVING;
        }
        break;
    case DRIVING:
        if (events & ROBUROC4_EVENT_LOCALIZATION &&
            roburoc4_client_localization(&client, &pose, NULL) == 0) {
            const int there = pose.x_m >= 1.0;
            roburoc4_result result = there ? roburoc4_client_stop(&client, now_us)
                                           : roburoc4_client_drive(&client, 0.5f, 0.0f, 0, now_us);
            if (result < 0) {
                printf("%5.2f s  refused: %s\n", now_s, roburoc4_result_text(result));
                return 1;
            }
            if (there) {
                printf("%5.2f s  stopping at x %.2f m\n", now_s, pose.x_m);
                phase = STOPPING;
            }
        }
        break;
    case STOPPING:
        if (events & ROBUROC4_EVENT_STOP_CONFIRMED) {
            printf("%5.2f s  the robot obeys: its target is 0\n", now_s);
        }
        return (events & ROBUROC4_EVENT_STOP_CONFIRMED) != 0;
    }
    return 0;
}

int main(void) {
    uint8_t datagram[ROBUROC4_SIM_MAX_TRANSMIT];
    size_t size;
    int done = 0;

    robot = roburoc4_sim_create(NULL);
    if (robot == NULL || roburoc4_client_init(&client, sizeof client, NULL) < 0) {
        return 1;
    }
    roburoc4_client_start(&client, 0);

    for (uint64_t now_us = 0; !done && now_us < 20000000; now_us += 1000) {
        roburoc4_sim_advance(robot, now_us);

        while ((size = robot_sends(datagram, sizeof datagram)) > 0) {
            roburoc4_client_receive(&client, datagram, size, now_us);
        }

        done = application(roburoc4_client_take_events(&client), now_us);

        while ((size = (size_t)roburoc4_client_poll_transmit(&client, datagram, sizeof datagram,
                                                             now_us)) > 0) {
            robot_gets(datagram, size);
        }
    }
    roburoc4_sim_destroy(robot);
    return done ? 0 : 1;
}
