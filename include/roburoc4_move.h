/* SPDX-License-Identifier: MIT
 *
 * roburoc4_move.h - one metre forward, a quarter turn, go to a point, come to rest: moves of a
 * roburoc4_client, with ramps, odometry and an outcome.
 *
 * THE MODEL
 *
 * Declare a move, begin it with one of the functions below, and step it whenever the client has
 * news, at least every 50 ms; more often is harmless. Each step reads the client's values and
 * proposes the next drive() in the members linear_m_s and angular_rad_s. Your program drives:
 *
 *     roburoc4_move move;
 *     roburoc4_move_by(&move, 1.0f, 0.0f, NULL);
 *     while (roburoc4_move_step(&move, &client, now_us) == ROBUROC4_MOVE_RUNNING) {
 *         roburoc4_result result =
 *             roburoc4_client_drive(&client, move.linear_m_s, move.angular_rad_s, 0, now_us);
 *         (void)result; // if it was refused, the next step says why
 *         ... receive and send, as roburoc4_udp_wait() does; read the clock ...
 *     }
 *     puts(roburoc4_move_outcome_text(move.outcome));
 *
 * A move never arms and never renews a lease, so a program that hangs or abandons its move stops
 * the robot as after any drive().
 *
 * HOW IT MOVES
 *
 *   Speed         A profile: no proposal exceeds the requested speed, or the robot's own limit if
 *                 that is lower, and none changes faster than the requested acceleration, also when
 *                 braking. (The end of a move that is not reached is a stop sequence: at once.)
 *   The beginning A robot that still rolls is first brought to rest, at the requested acceleration.
 *                 The requested distance and angle count from there, the members distance_m and
 *                 angle_rad from the first step. Coming to rest takes none of the move's time.
 *   Braking       The move knows how much distance it has commanded and how much of it the robot
 *                 has covered. From both it learns how late and how far this robot follows, and
 *                 brakes the earlier the less it knows. If something stops the wheels, it comes to
 *                 rest and learns anew. It proposes no speed beyond its goal.
 *   Odometry      Distance is measured by the localization service if its pose is fresh when the
 *                 move begins, else by the reported speeds. A move ends where what was commanded,
 *                 the speeds and the pose disagree, beyond what a robot's lag explains, by more
 *                 than 0.15 m or 15 degrees plus a fifth of the distance. It also ends once it
 *                 commanded, along its line or arc, 1.25 times the distance plus 0.2 m or 20
 *                 degrees (what it commanded while something held the wheels does not count), so
 *                 that wheels that count too little take it no further, and where the robot is
 *                 relocalized. Wheels slip, above all in turns, and odometry does not notice:
 *                 relocalize between moves if you know the pose better (docs/moves.md has
 *                 figures). scale_linear and scale_angular of the client's configuration correct
 *                 what the wheels count.
 *   Obstacles     A bumper that is pressed in the direction of travel, or newly pressed anywhere,
 *                 ends a move. So does a telemeter (ultrasonic rangefinder) in the direction of
 *                 travel that reports less than the clearance, the distance that the robot still
 *                 rolls when it stops now, and what it covered since the distance was measured.
 *                 Turns in place of a robot that stands do not use telemeters. TELEMETERS MISS
 *                 THINGS: thin legs, soft or slanted surfaces, everything outside of their cones.
 *                 Backing away from an obstacle is possible. With a clearance, a move needs known
 *                 bumpers and a distance in its direction that is not older than a second.
 *   The end       Whatever the outcome, the last step calls roburoc4_client_pause(), which sends a
 *                 stop sequence; after ROBUROC4_MOVE_LAPSED it was sent already. After
 *                 ROBUROC4_MOVE_REACHED the robot is at rest, or about to be (slow ones roll out);
 *                 after the others it may still roll: roburoc4_move_rest() waits until it stands.
 *
 * CONVENTIONS
 *
 *   Those of roburoc4.h. Moves need no allocation, clock or math library. Use a move from one
 *   thread at a time, with its client. A move ends with an outcome and stays ended until it is
 *   begun again; nothing needs to be freed.
 */
#ifndef ROBUROC4_MOVE_H
#define ROBUROC4_MOVE_H

#include "roburoc4.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------- outcomes --- */

#define ROBUROC4_MOVE_RUNNING 0
#define ROBUROC4_MOVE_REACHED 1   /* at the goal, and at rest */
#define ROBUROC4_MOVE_OVERRIDE 2  /* [A] on the game pad is held, or its state is unknown */
#define ROBUROC4_MOVE_BUMPER 3    /* a bumper is pressed */
#define ROBUROC4_MOVE_OBSTACLE 4  /* a telemeter saw something too near */
#define ROBUROC4_MOVE_INHIBITED 5 /* the robot does not follow: emergency stop, brakes, motors */
#define ROBUROC4_MOVE_LOST 6      /* statuses that it needs, or commands, do not arrive */
#define ROBUROC4_MOVE_OTHER_COMMANDER 7 /* another client commands the robot */
#define ROBUROC4_MOVE_TIMEOUT 8         /* it took longer than timeout_ms */
/* by roburoc4_move_cancel(), client_pause() or client_stop(); not armed; or it could not begin */
#define ROBUROC4_MOVE_CANCELLED 9
#define ROBUROC4_MOVE_LAPSED 10      /* the program hung: a lease of the move expired */
#define ROBUROC4_MOVE_ODOMETRY 11    /* commands, speeds and pose disagree */
#define ROBUROC4_MOVE_RELOCALIZED 12 /* the pose was set, or jumped */
#define ROBUROC4_MOVE_OFF_COURSE 13  /* at rest, not at its goal; or far off its path */
#define ROBUROC4_MOVE_TOO_FAST 14    /* asked for a speed beyond the client's ceilings */
/* with a clearance, and this sensor is not known or has no fresh distance */
#define ROBUROC4_MOVE_NO_FRONT_BUMPER 15
#define ROBUROC4_MOVE_NO_REAR_BUMPER 16
#define ROBUROC4_MOVE_NO_FRONT_TELEMETER 17
#define ROBUROC4_MOVE_NO_REAR_TELEMETER 18

/** An outcome as one English sentence without a full stop: what happened and what to do. For a
 *  negative number, as from roburoc4_pump_move(), its roburoc4_result_text(). "unknown outcome" for
 *  an invalid one. Valid as long as the program runs. */
ROBUROC4_API const char *roburoc4_move_outcome_text(int32_t outcome);

/* -------------------------------------------------------------------------------- options --- */

/** How to move. Fill it with roburoc4_move_options_init(), then change what you need. */
typedef struct roburoc4_move_options {
    uint32_t size;        /* set by roburoc4_move_options_init() */
    uint32_t timeout_ms;  /* limit of the duration; 0 (default): twice that of the profile plus 3 s;
                             5 s to come to rest */
    float max_linear_m_s; /* forward or backward, greater than 0; default 0.3 */
    float max_angular_rad_s;  /* greater than 0; default 0.5 */
    float max_linear_m_s2;    /* greater than 0; default 0.5 */
    float max_angular_rad_s2; /* greater than 0; default 1. Lower limits of the robot apply, too */
    float clearance_m;        /* distance to keep from obstacles; default 0.5; 0: ignore telemeters,
                                 and bumpers that are not known */
    uint32_t allow_turns; /* 1: angles beyond two turns are meant; default 0: they are refused */
} roburoc4_move_options;

/** Set all defaults; `size` is sizeof(roburoc4_move_options). ROBUROC4_ERR_SIZE, with nothing
 *  written, for a size that the library does not know. */
ROBUROC4_API roburoc4_result roburoc4_move_options_init(roburoc4_move_options *options,
                                                        size_t size);

/* ---------------------------------------------------------------------------------- moves --- */

/** What a move knows of the robot's response. All of it is private. */
typedef struct roburoc4_private_fit {
    float gain, spare, shift, surprise, statuses;
    float numbers[5], spread[5][5], smooth[2][3];
} roburoc4_private_fit;

/** A move (frozen: its size never changes). Read the first fields after each step; the others are
 *  private. */
typedef struct roburoc4_move {
    int32_t outcome;                  /* ROBUROC4_MOVE_* */
    roburoc4_result cause;            /* why the client disarmed, if that ended the move; else 0 */
    float linear_m_s, angular_rad_s;  /* speeds to drive now; 0 after the end */
    float distance_m, angle_rad;      /* covered and turned so far, by odometry; backward and to the
                                         right are negative */
    float remaining_m, remaining_rad; /* what is left of the distance and of the current turn */

    float private_goal[2], private_covered[2], private_commanded[2], private_speed[2];
    float private_limit[2], private_slope[2], private_by_speeds[2], private_lagging[2];
    float private_per_pose[2], private_aside_m, private_share;
    uint32_t private_timeout_ms, private_duration_ms, private_relocalized;
    roburoc4_private_fit private_fit;
    roburoc4_move_options private_options;
    uint64_t private_begun_us, private_first_us; /* first: when it asked for a speed, or a stop */
    uint64_t private_step_us, private_heard_us, private_pose_us;
    uint64_t private_speed_cycles, private_pose_cycles;
    int64_t private_place[3], private_pose[3]; /* the goal; the last pose */
    uint8_t private_kind, private_leg, private_ready, private_rolls;
    uint8_t private_still, private_bumpers, private_posed, private_begun;
    uint8_t private_driven, private_turned, private_rested, private_quiet_cycles, private_fallen,
        private_unmeasured, private_stood_cycles;
    int8_t private_side, private_rolled;
    uint8_t private_pose_same, private_stopping, private_suspect, private_pose_gap;
    float private_peak,
        private_told;            /* the highest speed, measured and proposed, until it brakes */
    float private_patience_s;    /* left to wait until the robot does not swing any more */
    uint32_t private_granted_us; /* when the client's last lease began, before this move's first */
    uint32_t private_stop_us;    /* when the stop sequence began that the last step saw */
    float private_mark;          /* where it was when it last moved, */
    uint32_t private_stood_us;   /* and how long ago that was */
    float private_asked[2];      /* commanded in this leg while the wheels moved */
    uint32_t private_spare[5];
} roburoc4_move;

/* Begin a move in any memory. Nothing is sent: the first step plans the move.
 * options may be NULL for all defaults. ROBUROC4_ERR_NOT_FINITE: NaN or infinity.
 * ROBUROC4_ERR_ARGUMENT: more than 10 km (for a point this is found at the first step) or 10000
 * rad, or an option that is NaN or out of its range. ROBUROC4_ERR_UNITS: an angle beyond two turns
 * without the option for it (degrees?), or a speed beyond ROBUROC4_MAX_DRIVE_M_S or _RAD_S. After
 * an error the move is ended, as ROBUROC4_MOVE_CANCELLED. A speed beyond the client's ceilings,
 * before or after its scale, ends the move at its first step, as ROBUROC4_MOVE_TOO_FAST; the
 * default speeds are lowered to them instead. */

/** Drive this distance (negative: backward) while turning by this angle (negative: to the right; it
 * may exceed a full turn). With angle 0 the robot drives straight, with distance 0 it turns in
 * place, else it drives an arc of radius distance_m / angle_rad. */
ROBUROC4_API roburoc4_result roburoc4_move_by(roburoc4_move *move, float distance_m,
                                              float angle_rad,
                                              const roburoc4_move_options *options);
/** Turn to a point in the main frame, as the robot reports it (not scaled), then drive straight to
 * it. Needs the localization service. */
ROBUROC4_API roburoc4_result roburoc4_move_to_point(roburoc4_move *move, double x_m, double y_m,
                                                    const roburoc4_move_options *options);
/** The same, then turn to this heading. */
ROBUROC4_API roburoc4_result roburoc4_move_to_pose(roburoc4_move *move, double x_m, double y_m,
                                                   double theta_rad,
                                                   const roburoc4_move_options *options);
/** Drive at these speeds for a time, however far that is: from the first speed to the last one,
 * with the same gentle ramps inside of it. The options' speeds do not count. */
ROBUROC4_API roburoc4_result roburoc4_move_for(roburoc4_move *move, float linear_m_s,
                                               float angular_rad_s, uint32_t duration_ms,
                                               const roburoc4_move_options *options);
/** Stop, and wait until the robot is at rest; armed or not. Other moves of the client end. While
 * [A] is not known, nothing confirms a stop, and this move times out. */
ROBUROC4_API roburoc4_result roburoc4_move_rest(roburoc4_move *move,
                                                const roburoc4_move_options *options);

/** Read the client's latest values and propose the next speeds. Call it after each receive(), and
 *  before the drive() that it proposes. The first steps propose 0 until the statuses that the move
 *  needs have arrived, at most 1 s. The last one calls roburoc4_client_pause(). A lease that ends
 *  without the move ends the move: as ROBUROC4_MOVE_CANCELLED after roburoc4_client_stop() or
 *  _pause() elsewhere in the program, as ROBUROC4_MOVE_LAPSED if it expired: then the client
 *  disarms, as after any lapse. Returns move->outcome; an ended move does nothing. */
ROBUROC4_API int32_t roburoc4_move_step(roburoc4_move *move, roburoc4_client *client,
                                        uint64_t now_us);
/** The input of a move. roburoc4_move_step() takes it from a client. If another process has the
 *  client, such as the LCM bridge, fill it with what that reports, and 0 for the rest. Speeds,
 *  limits and pose are those that the robot reports: the step divides them by the scales, and the
 *  pose unless it is external. `sent_*` are the arguments of drive(), before scaling: neither the
 *  reported targets nor the facts' `sent_*`. */
typedef struct roburoc4_move_view {
    uint32_t size;         /* set by ROBUROC4_SIZED() */
    uint32_t relocalized;  /* changes with each relocalization */
    uint64_t speed_cycles; /* robot time of the speeds; 0: none yet */
    uint64_t pose_cycles;  /* robot time of the pose; 0: none yet, not fresh, or not usable */
    double x_m, y_m, theta_rad;
    float linear_m_s, angular_rad_s;           /* measured */
    float sent_linear_m_s, sent_angular_rad_s; /* 0 after a stop */
    float max_linear_m_s, max_angular_rad_s;   /* the robot's own, the smaller of both directions;
                                                  0: not known */
    float max_linear_m_s2, max_angular_rad_s2; /* likewise */
    float front_m, rear_m;                     /* distances ahead and behind */
    uint32_t distance_age_us;                  /* how old they may be */
    int32_t disarm_cause;                      /* ROBUROC4_ERR_*, if it is not armed */
    uint8_t armed, overridden, inhibited;
    uint8_t front_bumper, rear_bumper; /* pressed */
    uint8_t front_bumper_known, rear_bumper_known;
    uint8_t front_known, rear_known; /* a telemeter looks there, and reports */
    uint8_t pose_external;           /* a localizer contributes: the pose is not scaled */
    uint8_t reserved[6];
    float scale_linear, scale_angular; /* those of roburoc4_config; 0 means 1. Others than 0.01 to
                                          10 end the move, with ROBUROC4_ERR_ARGUMENT */
} roburoc4_move_view;

/** roburoc4_move_step() with your own view. When the move ends, your program must stop the robot;
 *  for a move to rest, stop it before. A view of a size that the library does not know ends the
 *  move as ROBUROC4_MOVE_CANCELLED, with ROBUROC4_ERR_SIZE as its cause. Returns move->outcome. */
ROBUROC4_API int32_t roburoc4_move_step_view(roburoc4_move *move, const roburoc4_move_view *view,
                                             uint64_t now_us);
/** End a move that runs, and stop. */
ROBUROC4_API void roburoc4_move_cancel(roburoc4_move *move, roburoc4_client *client,
                                       uint64_t now_us);

#ifdef __cplusplus
}
#endif

#endif
