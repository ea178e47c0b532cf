/* SPDX-License-Identifier: MIT
 *
 * drive_to: drive to a point in the odometry frame, through roburoc4-lcm.
 *
 *     drive_to X_M Y_M [CHANNEL_PREFIX]
 *
 * Runs a move of roburoc4_move.h on the statuses that the bridge publishes, and commands its speeds
 * on ROBUROC4_DRIVE_CMD. It waits until the bridge reports that the robot can be driven, and prints
 * the messages of ROBUROC4_BRIDGE_STATE. It ends when the robot is stopped, overridden or lost, or
 * when something is in the way; a person then decides whether to continue. It steers only by fresh
 * statuses, because those of a replayed log would send the real robot to a wrong place. The LCM
 * network is $LCM_DEFAULT_URL. Exit status: 0 arrived, 1 stopped, no statuses, or timed out, 2 bad
 * usage.
 */
#define _POSIX_C_SOURCE 200809L
#include <lcm/lcm.h>
#include <math.h>
#include <roburoc4_move.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

#include "roburoc4_lcm.h"

#define SILENCE_US 2000000
#define LOOK_MS 50
#define SPEEDS_US 250000  /* it commands only while the speeds are younger */
#define KNOWN_US 10000000 /* properties come once a second, when the robot has given them */
/* A status that is further from the current time is not fresh. */
#define FRESH_US 500000
/* The bridge tells who is in control 5 times a second. */
#define UNHEARD_US 900000

typedef struct trip {
    lcm_t *lcm;
    char command_channel[64], sender[64];
    int64_t heard_us;               /* when the last fresh speeds arrived */
    int64_t poses_us, distances_us; /* when the last fresh ones were measured */
    roburoc4_move move;
    roburoc4_move_view view;
    int64_t moved_us;           /* when the first speed was commanded; 0: not yet */
    int obeyed;                 /* the bridge has received a command of ours */
    int known;                  /* the robot's limits and scales are known */
    int ready, driven, stopped; /* it can be driven; it was driven; then it no longer could */
    char message[256];          /* the bridge's last message */
} trip;

static int64_t now_us(void) {
    struct timeval now;
    (void)gettimeofday(&now, NULL);
    return (int64_t)now.tv_sec * 1000000 + now.tv_usec;
}

static int fresh(int64_t utime) {
    return llabs(utime - now_us()) < FRESH_US;
}

static void drive(trip *trip, double linear_m_s, double angular_rad_s) {
    roburoc4_lcm_drive_command_t command = {
        .utime = now_us(),
        .sender = trip->sender,
        .linear_m_s = linear_m_s,
        .angular_rad_s = angular_rad_s,
        .lease_us = 200000, /* a hung program stops the robot after this time */
    };
    (void)roburoc4_lcm_drive_command_t_publish(trip->lcm, trip->command_channel, &command);
    trip->view.sent_linear_m_s = (float)linear_m_s;
    trip->view.sent_angular_rad_s = (float)angular_rad_s;
}

static void on_localization(const lcm_recv_buf_t *buffer, const char *channel,
                            const roburoc4_lcm_localization_status_t *pose, void *user) {
    roburoc4_move_view *view = &((trip *)user)->view;
    (void)buffer;
    (void)channel;
    if (fresh(pose->utime)) {
        const int usable =
            isfinite(pose->x_m) && isfinite(pose->y_m) && isfinite(pose->theta_rad) &&
            (pose->flags & (ROBUROC4_LOCALIZATION_INVALID | ROBUROC4_LOCALIZATION_ERROR)) == 0;
        ((trip *)user)->poses_us = pose->utime;
        view->pose_cycles = usable ? (uint64_t)pose->robot_cycles : 0;
        view->x_m = pose->x_m;
        view->y_m = pose->y_m;
        view->theta_rad = pose->theta_rad;
        view->pose_external = (pose->flags & ROBUROC4_LOCALIZATION_EXTEROCEPTIVE) != 0;
    }
}

/* The smaller size of a pair of limits. */
static float both_ways(float low, float high) {
    return fminf(fabsf(low), fabsf(high));
}

static void on_properties(const lcm_recv_buf_t *buffer, const char *channel,
                          const roburoc4_lcm_robot_properties_t *robot, void *user) {
    trip *trip = user;
    (void)buffer;
    (void)channel;
    if (fresh(robot->utime) && robot->differential_known) {
        roburoc4_move_view *view = &trip->view;
        view->scale_linear = robot->scale_linear;
        view->scale_angular = robot->scale_angular;
        view->max_linear_m_s = both_ways(robot->min_linear_m_s, robot->max_linear_m_s);
        view->max_angular_rad_s = both_ways(robot->min_angular_rad_s, robot->max_angular_rad_s);
        view->max_linear_m_s2 = both_ways(robot->min_linear_m_s2, robot->max_linear_m_s2);
        view->max_angular_rad_s2 = both_ways(robot->min_angular_rad_s2, robot->max_angular_rad_s2);
        trip->known = 1;
    }
}

static void on_differential(const lcm_recv_buf_t *buffer, const char *channel,
                            const roburoc4_lcm_differential_status_t *speeds, void *user) {
    trip *trip = user;
    (void)buffer;
    (void)channel;
    if (fresh(speeds->utime)) {
        trip->heard_us = now_us();
        trip->view.speed_cycles = (uint64_t)speeds->robot_cycles;
        trip->view.linear_m_s = speeds->current_linear_m_s;
        trip->view.angular_rad_s = speeds->current_angular_rad_s;
    }
}

static void on_telemeter(const lcm_recv_buf_t *buffer, const char *channel,
                         const roburoc4_lcm_telemeter_status_t *distances, void *user) {
    trip *trip = user;
    (void)buffer;
    (void)channel;
    if (fresh(distances->utime) && distances->telemeter_count > ROBUROC4_TELEMETER_REAR) {
        trip->distances_us = distances->utime;
        trip->view.front_m = distances->telemeters[ROBUROC4_TELEMETER_FRONT].distance_m;
        trip->view.rear_m = distances->telemeters[ROBUROC4_TELEMETER_REAR].distance_m;
    }
}

static void on_bridge_state(const lcm_recv_buf_t *buffer, const char *channel,
                            const roburoc4_lcm_bridge_state_t *state, void *user) {
    trip *trip = user;
    (void)buffer;
    (void)channel;
    trip->ready = trip->ready != 0 || state->can_drive != 0;
    trip->stopped = trip->driven != 0 && state->awaiting_pause != 0;
    trip->driven = trip->driven != 0 || state->driving != 0;
    trip->obeyed = trip->obeyed != 0 || strcmp(state->control_owner, trip->sender) == 0 ||
                   strcmp(state->rejected_sender, trip->sender) == 0;
    trip->view.armed = 1; /* the bridge arms for a command */
    trip->view.overridden = state->overridden != 0;
    trip->view.inhibited = (state->problems & ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_INHIBITED) != 0;
    trip->view.front_bumper_known = state->front_bumper_known != 0;
    trip->view.rear_bumper_known = state->rear_bumper_known != 0;
    trip->view.front_bumper =
        (state->problems & ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_FRONT_BUMPER) != 0;
    trip->view.rear_bumper =
        (state->problems & ROBUROC4_LCM_BRIDGE_STATE_T_PROBLEM_REAR_BUMPER) != 0;
    if (strcmp(state->message, trip->message) != 0) {
        (void)snprintf(trip->message, sizeof trip->message, "%s", state->message);
        (void)printf("bridge: %s\n", trip->message);
    }
}

/* Handle what has arrived, and command the resulting speeds; 0 at the end. */
static int step(trip *trip) {
    if (trip->ready == 0 || trip->known == 0) {
        return 1;
    }
    const int64_t age_us = now_us() - trip->distances_us;
    trip->view.distance_age_us = age_us > 0 ? (uint32_t)age_us : 0;
    trip->view.front_known = trip->view.rear_known = fresh(trip->distances_us) != 0;
    if (!fresh(trip->poses_us)) {
        trip->view.pose_cycles = 0;
    }
    const int going = roburoc4_move_step_view(&trip->move, &trip->view, (uint64_t)now_us()) ==
                      ROBUROC4_MOVE_RUNNING;
    const double linear_m_s = (double)trip->move.linear_m_s;
    const double angular_rad_s = (double)trip->move.angular_rad_s;
    if (trip->moved_us == 0 && fabs(linear_m_s) + fabs(angular_rad_s) > 0) {
        trip->moved_us = now_us();
    }
    if (trip->moved_us != 0 && now_us() - trip->heard_us < SPEEDS_US) {
        drive(trip, linear_m_s, angular_rad_s);
    }
    return going;
}

/* With a ttl of 0 here and 1 at the bridge, statuses arrive here, and commands never there. */
static int is_unheard(const trip *trip) {
    return trip->obeyed == 0 && trip->moved_us != 0 && now_us() - trip->moved_us > UNHEARD_US;
}

static int travel(trip *trip) {
    const int64_t begun_us = trip->heard_us = now_us();
    while (trip->stopped == 0 && !is_unheard(trip) && step(trip)) {
        if (lcm_handle_timeout(trip->lcm, LOOK_MS) < 0 || now_us() - trip->heard_us > SILENCE_US) {
            (void)fprintf(
                stderr,
                "drive_to: no fresh status for %d s: is roburoc4-lcm running, with "
                "--enable-drive and on this LCM network? do both machines' clocks agree?\n",
                SILENCE_US / 1000000);
            return 1;
        }
        if (trip->known == 0 && now_us() - begun_us > KNOWN_US) {
            (void)fprintf(stderr, "drive_to: the bridge does not tell what robot it has: is the "
                                  "robot connected, and PROPERTIES on its usual channel?\n");
            return 1;
        }
    }
    if (is_unheard(trip)) {
        (void)fprintf(stderr, "drive_to: statuses arrive, but the bridge hears no command: does "
                              "LCM_DEFAULT_URL have the bridge's ttl here?\n");
        return 1;
    }
    if (trip->move.outcome == ROBUROC4_MOVE_REACHED) {
        (void)printf("arrived at %.2f %.2f\n", trip->view.x_m, trip->view.y_m);
        return 0;
    }
    if (trip->stopped == 0) {
        (void)fprintf(stderr, "drive_to: %s\n", roburoc4_move_outcome_text(trip->move.outcome));
    }
    return 1;
}

/* Different for each run: two programs with the same name would share control and both drive. */
static void set_sender(trip *trip) {
    char host[33] = "";
    (void)gethostname(host, sizeof host - 1);
    (void)snprintf(trip->sender, sizeof trip->sender, "drive_to %ld on %s", (long)getpid(), host);
}

static int read_number(const char *text, double *value) {
    char *end = NULL;
    *value = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*value);
}

int main(int count, char **arguments) {
    static trip trip;
    double x_m, y_m;
    if (count < 3 || count > 4 || !read_number(arguments[1], &x_m) ||
        !read_number(arguments[2], &y_m)) {
        (void)fprintf(stderr, "usage: drive_to X_M Y_M [CHANNEL_PREFIX], such as drive_to 2 1\n");
        return 2;
    }
    set_sender(&trip);
    (void)ROBUROC4_SIZED(&trip.view);
    (void)roburoc4_move_to_point(&trip.move, x_m, y_m, NULL);
    (void)setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    trip.lcm = lcm_create(NULL);
    if (trip.lcm == NULL) {
        (void)fprintf(stderr, "drive_to: no LCM network; see the manual page roburoc4-lcm(1)\n");
        return 1;
    }
    const char *prefix = count == 4 ? arguments[3] : "ROBUROC4";
    char channel[64];
    (void)snprintf(trip.command_channel, sizeof trip.command_channel, "%s_DRIVE_CMD", prefix);
    (void)snprintf(channel, sizeof channel, "%s_LOCALIZATION", prefix);
    (void)roburoc4_lcm_localization_status_t_subscribe(trip.lcm, channel, on_localization, &trip);
    (void)snprintf(channel, sizeof channel, "%s_PROPERTIES", prefix);
    (void)roburoc4_lcm_robot_properties_t_subscribe(trip.lcm, channel, on_properties, &trip);
    (void)snprintf(channel, sizeof channel, "%s_DIFFERENTIAL", prefix);
    (void)roburoc4_lcm_differential_status_t_subscribe(trip.lcm, channel, on_differential, &trip);
    (void)snprintf(channel, sizeof channel, "%s_TELEMETER", prefix);
    (void)roburoc4_lcm_telemeter_status_t_subscribe(trip.lcm, channel, on_telemeter, &trip);
    (void)snprintf(channel, sizeof channel, "%s_BRIDGE_STATE", prefix);
    (void)roburoc4_lcm_bridge_state_t_subscribe(trip.lcm, channel, on_bridge_state, &trip);
    int status = travel(&trip);
    lcm_destroy(trip.lcm);
    return status;
}
