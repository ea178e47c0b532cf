/* SPDX-License-Identifier: MIT
 *
 * drive_to: drive to a point of the robot's own frame, by its odometry, through roburoc4-lcm.
 *
 *     drive_to X_M Y_M [CHANNEL_PREFIX]
 *
 * It waits until the bridge reports that the robot can be driven, steers by each
 * ROBUROC4_LOCALIZATION that arrives, commands on ROBUROC4_DRIVE_CMD, and prints the messages of
 * ROBUROC4_BRIDGE_STATE. When the robot is stopped, overridden or lost, it ends: a person decides
 * whether to go on. It steers by fresh poses only: those of a log that somebody replays would send
 * the real robot to a wrong place. LCM's network is that of $LCM_DEFAULT_URL. Exit status: 0
 * arrived, 1 stopped, no poses, or not within 60 s, 2 bad usage.
 */
#define _POSIX_C_SOURCE 200809L
#include <lcm/lcm.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

#include "roburoc4_lcm.h"

#define NEAR_M 0.1
#define MAX_LINEAR_M_S 0.5
#define MAX_ANGULAR_RAD_S 0.8
#define PATIENCE_S 60
#define SILENCE_US 2000000
#define LOOK_MS 200
/* A pose that is further from now than this is not fresh. */
#define FRESH_US 500000

typedef struct trip {
    lcm_t *lcm;
    char command_channel[64];
    char sender[64];
    int64_t posed_us; /* when the last fresh pose came */
    double goal_x_m;
    double goal_y_m;
    int ready;  /* the robot can be driven */
    int driven; /* it was driven */
    int arrived;
    int stopped;
    char message[256]; /* the last one of the bridge */
} trip;

static int64_t now_us(void) {
    struct timeval now;
    (void)gettimeofday(&now, NULL);
    return (int64_t)now.tv_sec * 1000000 + now.tv_usec;
}

static double within(double value, double limit) {
    return fmax(-limit, fmin(limit, value));
}

static void drive(trip *trip, double linear_m_s, double angular_rad_s) {
    roburoc4_lcm_drive_command_t command = {
        .utime = now_us(),
        .sender = trip->sender,
        .linear_m_s = linear_m_s,
        .angular_rad_s = angular_rad_s,
        .lease_us = 200000, /* a hung program stops the robot that soon */
    };
    (void)roburoc4_lcm_drive_command_t_publish(trip->lcm, trip->command_channel, &command);
}

static void on_localization(const lcm_recv_buf_t *buffer, const char *channel,
                            const roburoc4_lcm_localization_status_t *pose, void *user) {
    trip *trip = user;
    (void)buffer;
    (void)channel;
    int64_t now = now_us();
    if (pose->utime < now - FRESH_US || pose->utime > now + FRESH_US) {
        return;
    }
    trip->posed_us = now;
    if (trip->ready == 0) {
        return;
    }
    double x_m = trip->goal_x_m - pose->x_m;
    double y_m = trip->goal_y_m - pose->y_m;
    double distance_m = hypot(x_m, y_m);
    /* How far to the left the goal lies, -pi to pi. */
    double bearing_rad = remainder(atan2(y_m, x_m) - pose->theta_rad, 2.0 * acos(-1.0));
    if (distance_m < NEAR_M) {
        trip->arrived = 1;
        drive(trip, 0.0, 0.0);
        (void)printf("arrived at %.2f %.2f\n", pose->x_m, pose->y_m);
        return;
    }
    /* Ahead only as far as it looks at the goal; gently at the end. */
    double ahead = fmax(0.0, cos(bearing_rad));
    drive(trip, within(0.6 * distance_m * ahead * ahead, MAX_LINEAR_M_S),
          within(1.2 * bearing_rad, MAX_ANGULAR_RAD_S));
}

static void on_bridge_state(const lcm_recv_buf_t *buffer, const char *channel,
                            const roburoc4_lcm_bridge_state_t *state, void *user) {
    trip *trip = user;
    (void)buffer;
    (void)channel;
    trip->ready = trip->ready != 0 || state->can_drive != 0;
    trip->stopped = trip->driven != 0 && state->waiting != 0;
    trip->driven = trip->driven != 0 || state->driving != 0;
    if (strcmp(state->message, trip->message) != 0) {
        (void)snprintf(trip->message, sizeof trip->message, "%s", state->message);
        (void)printf("bridge: %s\n", trip->message);
    }
}

static int travel(trip *trip) {
    int64_t begun_us = now_us();
    trip->posed_us = begun_us;
    while (trip->arrived == 0 && trip->stopped == 0) {
        if (lcm_handle_timeout(trip->lcm, LOOK_MS) < 0 || now_us() - trip->posed_us > SILENCE_US) {
            (void)fprintf(
                stderr,
                "drive_to: no fresh pose for %d s: is roburoc4-lcm running, with "
                "--enable-drive and on this LCM network? do both machines' clocks agree?\n",
                SILENCE_US / 1000000);
            return 1;
        }
        if (now_us() - begun_us > PATIENCE_S * 1000000LL) {
            (void)fprintf(stderr, "drive_to: not there after %d s\n", PATIENCE_S);
            return 1;
        }
    }
    return trip->arrived != 0 ? 0 : 1;
}

/* Different for each run: two programs with one name would share control, and both drive. */
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
    trip trip;
    memset(&trip, 0, sizeof trip);
    if (count < 3 || count > 4 || !read_number(arguments[1], &trip.goal_x_m) ||
        !read_number(arguments[2], &trip.goal_y_m)) {
        (void)fprintf(stderr, "usage: drive_to X_M Y_M [CHANNEL_PREFIX], such as drive_to 2 1\n");
        return 2;
    }
    set_sender(&trip);
    const char *prefix = count == 4 ? arguments[3] : "ROBUROC4";
    char channel[64];
    (void)setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    trip.lcm = lcm_create(NULL);
    if (trip.lcm == NULL) {
        (void)fprintf(stderr, "drive_to: no LCM network; see the manual page roburoc4-lcm(1)\n");
        return 1;
    }
    (void)snprintf(trip.command_channel, sizeof trip.command_channel, "%s_DRIVE_CMD", prefix);
    (void)snprintf(channel, sizeof channel, "%s_LOCALIZATION", prefix);
    roburoc4_lcm_localization_status_t_subscription_t *poses =
        roburoc4_lcm_localization_status_t_subscribe(trip.lcm, channel, on_localization, &trip);
    (void)snprintf(channel, sizeof channel, "%s_BRIDGE_STATE", prefix);
    roburoc4_lcm_bridge_state_t_subscription_t *states =
        roburoc4_lcm_bridge_state_t_subscribe(trip.lcm, channel, on_bridge_state, &trip);
    int status = travel(&trip);
    (void)roburoc4_lcm_localization_status_t_unsubscribe(trip.lcm, poses);
    (void)roburoc4_lcm_bridge_state_t_unsubscribe(trip.lcm, states);
    lcm_destroy(trip.lcm);
    return status;
}
