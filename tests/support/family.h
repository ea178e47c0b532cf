/* SPDX-License-Identifier: MIT
 *
 * family.h - robots that the manual allows, and the judgement of a move on one of them.
 *
 * The robot is written on the codec alone and shares nothing with sim/ or src/move.c. It is driven
 * by a real client in virtual time, over a network that loses what it is told to lose. Its fields
 * are open: a test makes its odometry or its sensors wrong by setting them.
 */
#ifndef ROBUROC4_TESTS_FAMILY_H
#define ROBUROC4_TESTS_FAMILY_H

#include "roburoc4_move.h"

#ifdef __cplusplus
extern "C" {
#endif

/** One robot, and how it is asked to move. */
typedef struct family_member {
    double natural_rad_s; /* of its second-order response; 0: it follows at once */
    double damping, gain;
    uint32_t dead_ms;
    double noise_m_s;     /* standard deviation of reported speeds; twice as much in rad/s */
    uint32_t odometry_ms; /* how often the pose is computed; statuses repeat it in between */
    uint32_t status_ms;
    double speed; /* asked for, in m/s or rad/s */
    int turn;     /* a quarter turn instead of a metre */
    double loss;  /* share of datagrams lost, each way */
} family_member;

/** The values of the table, in the order of the fields; damping does not matter to a robot that
 *  follows at once. */
#define FAMILY_SIZE 7488
/** Member `index` of FAMILY_SIZE, without loss. */
family_member family_member_at(uint32_t index);
/** A robot between these values, with loss or without. */
family_member family_member_drawn(uint64_t *state);

#define FAMILY_TELEMETERS 4
#define FAMILY_DEAD_MS 512

typedef struct family_robot {
    /* the response */
    family_member is;
    double turning_rad_s; /* natural frequency of turns, if that is another one; or 0 */
    double command[FAMILY_DEAD_MS][2]; /* of the last milliseconds */
    double target[2], speed[2], slope[2];
    uint32_t commanded_ms; /* when the last command came */
    /* where the wheels have taken it, and what it reports: a pose of `odometry_ms`, scaled */
    double x_m, y_m, theta_rad, distance_m;
    double odometry_x_m, odometry_y_m, odometry_theta_rad;
    int speeds_stand; /* they are computed with the pose, not for each status */
    double pose[3], reported[2];
    int frozen;                                       /* the pose does not change */
    double scale_distance, scale_angle, scale_speeds; /* of the reported pose, and speeds */
    uint32_t flags;                                   /* of the localization */
    uint64_t silent;     /* services without statuses: bits 1 << service */
    uint64_t unanswered; /* services whose properties are never answered */
    /* its sensors */
    uint32_t telemeters, distances;
    float telemeter_rad[FAMILY_TELEMETERS];
    double wall_x_m; /* what the telemeters see, ahead and behind; 0: nothing */
    uint64_t inputs;
    const char *texts[22]; /* of the digital inputs; a NULL text is refused */
    /* the protocol */
    uint32_t now_ms, boot_ms;
    uint8_t period_cycles[8];
    uint64_t random;
} family_robot;

/** A robot, its client and the network between them. */
typedef struct family_rig {
    family_robot robot;
    roburoc4_client client;
    uint32_t now_ms;
    uint32_t pose_ms; /* between statuses of the pose; 0: as those of the speeds */
    double loss;
    /* what was commanded on the wire */
    uint32_t reversals, commands;
    double last_sign, last_sent[2], steepest[2];
    uint32_t sent_ms;
    uint32_t first_ms, last_ms; /* of commands other than zero */
} family_rig;

/** Connect; config may be NULL. What a test changes in the robot before family_connect() counts
 * from the beginning. */
void family_prepare(family_rig *rig, const family_member *member, uint64_t seed);
void family_connect(family_rig *rig, const roburoc4_config *config);
/** Connect and arm; 0 if it could not be armed. */
int family_open(family_rig *rig, const family_member *member, uint64_t seed);
int family_arm(family_rig *rig);
/** The robot starts again: its clock, its odometry, and nobody has subscribed. */
void family_reboot(family_rig *rig);
/** Let time pass. */
void family_pass(family_rig *rig, uint32_t span_ms);
uint64_t family_now_us(const family_rig *rig);
/** Step a move until it ends, or for this long; `meanwhile` may be NULL. */
int32_t family_go(family_rig *rig, roburoc4_move *move, uint32_t most_ms,
                  void (*meanwhile)(void *user), void *user);

/** How a move went. */
typedef struct family_verdict {
    int32_t result;
    double error, aside, overshoot; /* by the robot's odometry: m, or rad for a turn */
    double took_s, allowed_s, ideal_s;
    double steepest; /* change of the commanded speed per second, by that allowed */
    uint32_t reversals;
    const char *fault; /* what was wrong first; NULL: nothing */
} family_verdict;

/** Make the member's move, on a robot of its own, and judge it. A strict judge asks for what the
 *  nominal robot has to do. */
family_verdict family_judge(const family_member *member, uint64_t seed, int strict);

uint64_t family_random(uint64_t *state);
/** A line about a member. */
void family_print(const family_member *member, const family_verdict *verdict);

#ifdef __cplusplus
}
#endif

#endif
