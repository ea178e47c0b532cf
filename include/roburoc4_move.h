/* SPDX-License-Identifier: MIT
 *
 * roburoc4_move.h - one metre forward, a quarter turn, go to a point, come to rest: moves of a
 * roburoc4_client, with ramps, odometry and a result.
 *
 * THE MODEL
 *
 * Declare a move, begin it with one of the functions below, and step it whenever the client has
 * news, at least every 50 ms. Each step reads the client's values and proposes the next drive() in
 * the members linear_m_s and angular_rad_s. Your program drives:
 *
 *     roburoc4_move move;
 *     roburoc4_move_by(&move, 1.0f, 0.0f, NULL);
 *     while (roburoc4_move_step(&move, &client, now_us) == ROBUROC4_MOVE_RUNNING) {
 *         roburoc4_client_drive(&client, move.linear_m_s, move.angular_rad_s, 0, now_us);
 *         ... receive and send, as roburoc4_udp_wait() does; read the clock ...
 *     }
 *     puts(roburoc4_move_result_text(move.result));
 *
 * The result of drive() need not be checked: the next step reports a refusal. A move never arms and
 * never renews a lease, so a program that hangs or abandons its move stops the robot as after any
 * drive().
 *
 * HOW IT MOVES
 *
 *   Speed         Up to the requested speed, with gentle acceleration, or the robot's own limit if
 *                 that is lower. No proposal exceeds the requested speed; the client's limits and
 *                 ceilings apply, too.
 *   Braking       By the robot's measured response: a robot whose target becomes 0 at 1 m/s still
 *                 rolls 0.64 m. At each step the move knows how much distance it still has to
 *                 command, and slows down accordingly.
 *   Odometry      Distance is measured by the localization service; by the reported speeds and
 *                 their time stamps if there is none, while it is silent or invalid, and when a
 *                 pose jumps because the robot was relocalized. A relocalization affects only later
 *                 moves: the current one continues to its original goal. Wheels slip, above all in
 *                 turns, and odometry does not notice: relocalize between moves if you know the
 *                 pose better (docs/moves.md has figures).
 *   Obstacles     A bumper that is pressed in the direction of travel, or newly pressed anywhere,
 *                 ends a move. So does a telemeter (ultrasonic rangefinder) in the direction
 *                 of travel that reports less than the clearance and the braking distance at the
 *                 present speed. Turns in place do not use telemeters. TELEMETERS MISS THINGS: thin
 *                 legs, soft or slanted surfaces, everything outside of their cones. Backing away
 *                 from an obstacle is possible.
 *   The end       Whatever the result, the last step calls roburoc4_client_pause(), which sends a
 *                 stop sequence. After ROBUROC4_MOVE_REACHED the robot is at rest; after the others
 *                 it may still roll: roburoc4_move_rest() waits for that.
 *
 * CONVENTIONS
 *
 *   Those of roburoc4.h. Moves need no allocation, clock or math library. Use a move from one
 *   thread at a time, with its client. A move ends with a result and stays ended until it is begun
 *   again; nothing needs to be freed.
 */
#ifndef ROBUROC4_MOVE_H
#define ROBUROC4_MOVE_H

#include "roburoc4.h"

#ifdef __cplusplus
extern "C" {
#endif

/* -------------------------------------------------------------------------------- results --- */

#define ROBUROC4_MOVE_RUNNING 0
#define ROBUROC4_MOVE_REACHED 1         /* at the goal, and at rest */
#define ROBUROC4_MOVE_OVERRIDE 2        /* [A] on the game pad is held, or its state is unknown */
#define ROBUROC4_MOVE_BUMPER 3          /* a bumper is pressed */
#define ROBUROC4_MOVE_OBSTACLE 4        /* a telemeter saw something too near */
#define ROBUROC4_MOVE_INHIBITED 5       /* it does not move: emergency stop, brakes, no power */
#define ROBUROC4_MOVE_LOST 6            /* no fresh statuses of what the move needs */
#define ROBUROC4_MOVE_OTHER_COMMANDER 7 /* another client commands the robot */
#define ROBUROC4_MOVE_TIMEOUT 8
#define ROBUROC4_MOVE_CANCELLED 9 /* by roburoc4_move_cancel(), client_pause() or client_stop() */
#define ROBUROC4_MOVE_LAPSED 10   /* the program hung: a lease of the move expired */

/** A result as one English sentence without a full stop: what happened and what to do. "unknown
 *  result" for an invalid number. Valid as long as the program runs. */
ROBUROC4_API const char *roburoc4_move_result_text(int32_t result);

/* -------------------------------------------------------------------------------- options --- */

/** How to move. Fill it with roburoc4_move_options_init(), then change what you need. */
typedef struct roburoc4_move_options {
    uint32_t size;        /* set by roburoc4_move_options_init() */
    uint32_t timeout_ms;  /* limit of the duration; 0 (default): four times the expected duration
                             plus 10 s; 5 s to come to rest */
    float linear_m_s;     /* maximum forward or backward speed, greater than 0; default 0.3 */
    float angular_rad_s;  /* maximum turn rate, greater than 0; default 0.5 */
    float linear_m_s2;    /* acceleration, greater than 0; default 0.5 */
    float angular_rad_s2; /* likewise; default 1. Lower limits of the robot apply to both */
    float clearance_m;    /* distance to keep from obstacles; 0: ignore telemeters; default 0.5 */
} roburoc4_move_options;

/** Set all defaults; `size` is sizeof(roburoc4_move_options). ROBUROC4_ERR_SIZE, with nothing
 *  written, for a size that the library does not know. */
ROBUROC4_API roburoc4_result roburoc4_move_options_init(roburoc4_move_options *options,
                                                        size_t size);

/* ---------------------------------------------------------------------------------- moves --- */

/** A move (frozen: its size never changes). Read the first fields after each step; the others are
 *  private. */
typedef struct roburoc4_move {
    int32_t result;                   /* ROBUROC4_MOVE_* */
    roburoc4_result cause;            /* why the client disarmed, if that ended the move; else 0 */
    float linear_m_s, angular_rad_s;  /* speeds to drive now; 0 after the end */
    float distance_m, angle_rad;      /* covered and turned so far, by odometry; backward and to the
                                         right are negative */
    float remaining_m, remaining_rad; /* what is left of the distance and of the current turn */

    roburoc4_move_options private_options;
    uint32_t private_timeout_ms;
    uint64_t private_begun_us, private_step_us, private_heard_us;
    uint64_t private_speed_cycles, private_pose_cycles;
    double private_x_m, private_y_m, private_theta_rad;    /* the goal */
    double private_x0_m, private_y0_m, private_theta0_rad; /* the last pose */
    float private_limit[2], private_slope[2];
    float private_goal[2], private_covered[2], private_to_command[2];
    float private_speed[2], private_since_pose[2];
    float private_line_m, private_last_turn_rad, private_aside_m;
    uint8_t private_kind, private_leg, private_ready, private_planned;
    uint8_t private_still, private_bumpers, private_posed, private_begun;
    uint8_t private_reserved[2];
    uint8_t private_driven, private_padding;
    uint32_t private_spare[8];
} roburoc4_move;

/* Begin a move in any memory. Nothing is sent: the first step plans the move.
 * options may be NULL for all defaults. ROBUROC4_ERR_NOT_FINITE: NaN or infinity.
 * ROBUROC4_ERR_ARGUMENT: more than 10 km or 10000 rad, or an option out of its range. After an
 * error the move is ended, as ROBUROC4_MOVE_CANCELLED. */

/** Drive this distance (negative: backward) while turning by this angle (negative: to the right; it
 * may exceed a full turn). With angle 0 the robot drives straight, with distance 0 it turns in
 * place, else it drives an arc of radius distance_m / angle_rad. */
ROBUROC4_API roburoc4_result roburoc4_move_by(roburoc4_move *move, float distance_m,
                                              float angle_rad,
                                              const roburoc4_move_options *options);
/** Turn to a point in the main frame, then drive straight to it. Needs the localization service. */
ROBUROC4_API roburoc4_result roburoc4_move_to_point(roburoc4_move *move, double x_m, double y_m,
                                                    const roburoc4_move_options *options);
/** The same, then turn to this heading. */
ROBUROC4_API roburoc4_result roburoc4_move_to_pose(roburoc4_move *move, double x_m, double y_m,
                                                   double theta_rad,
                                                   const roburoc4_move_options *options);
/** Stop, and wait until the robot is at rest; armed or not. Other moves of the client end. */
ROBUROC4_API roburoc4_result roburoc4_move_rest(roburoc4_move *move,
                                                const roburoc4_move_options *options);

/** Read the client's latest values and propose the next speeds. Call it after each receive(), and
 *  before the drive() that it proposes. The first steps propose 0 until the statuses that the move
 *  needs have arrived, at most 1 s. The last one calls roburoc4_client_pause(). A lease that ends
 *  without the move ends the move: as ROBUROC4_MOVE_CANCELLED after roburoc4_client_stop() or
 *  _pause() elsewhere in the program, as ROBUROC4_MOVE_LAPSED if it expired. Returns move->result;
 *  an ended move does nothing. */
ROBUROC4_API int32_t roburoc4_move_step(roburoc4_move *move, roburoc4_client *client,
                                        uint64_t now_us);
/** The input of a move. roburoc4_move_step() takes it from a client. If another process has the
 *  client, such as the LCM bridge, fill it with what that reports, and 0 for the rest. */
typedef struct roburoc4_move_view {
    uint32_t size;         /* set by ROBUROC4_SIZED() */
    uint32_t age_us;       /* age of the speeds now; they do not show what was sent since */
    uint64_t speed_cycles; /* robot time of the speeds; 0: none yet */
    uint64_t pose_cycles;  /* robot time of the pose; 0: none yet, or not usable */
    double x_m, y_m, theta_rad;
    float linear_m_s, angular_rad_s;           /* measured */
    float sent_linear_m_s, sent_angular_rad_s; /* the last speeds sent; 0 after a stop */
    float max_linear_m_s2, max_angular_rad_s2; /* the robot's own; 0: not known */
    float front_m, rear_m; /* distances ahead and behind; a large value without telemeter */
    int32_t disarm_cause;  /* ROBUROC4_ERR_*, if it is not armed */
    uint8_t armed, overridden, inhibited;
    uint8_t front_bumper, rear_bumper; /* pressed */
    uint8_t blind;                     /* there are telemeters, but no fresh distances */
    uint8_t reserved[6];
} roburoc4_move_view;

/** roburoc4_move_step() with your own view. When the move ends, your program must stop the robot;
 *  for a move to rest, stop it before. A view of a size that the library does not know ends the
 *  move as ROBUROC4_MOVE_CANCELLED, with ROBUROC4_ERR_SIZE as its cause. Returns move->result. */
ROBUROC4_API int32_t roburoc4_move_step_view(roburoc4_move *move, const roburoc4_move_view *view,
                                             uint64_t now_us);
/** End a move that runs, and stop. */
ROBUROC4_API void roburoc4_move_cancel(roburoc4_move *move, roburoc4_client *client,
                                       uint64_t now_us);

#ifdef __cplusplus
}
#endif

#endif
