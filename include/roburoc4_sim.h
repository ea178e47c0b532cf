/* SPDX-License-Identifier: MIT
 *
 * roburoc4_sim.h - a simulated RobuROC4: the robot's side of the UDP protocol, its motion, its
 * sensors and its control panel, to test clients without a robot.
 *
 * THE MODEL
 *
 * Like the client it is a state machine without socket, clock or thread. You pass datagrams and the
 * time, and act as the person beside the robot:
 *
 *     roburoc4_sim_advance()        first: run the 10 ms low level cycles up to now
 *     roburoc4_sim_receive()        hand over a datagram from a peer
 *     roburoc4_sim_poll_transmit()  the next datagram to send and to whom, until 0
 *     roburoc4_sim_next_deadline()  when to call advance() next
 *     roburoc4_sim_set()            power, game pad, emergency stops, bumpers ...
 *     roburoc4_sim_get_state()      everything about the robot, including its true pose
 *
 * The same configuration, seed and calls give the same bytes. roburoc4-sim is this model behind
 * a UDP socket.
 *
 * CONVENTIONS
 *
 *   Units, frame and results as in roburoc4.h. A `peer` is any 64-bit number by which you know a
 *   sender (an address and port, or just 1); answers and statuses go to the peer that asked.
 *   Memory is allocated by the create functions only and freed by the destroy functions.
 *   One simulator is used by one thread at a time; different ones by any threads.
 *   Functions that fail return an error and change nothing.
 */
#ifndef ROBUROC4_SIM_H
#define ROBUROC4_SIM_H

#include "roburoc4.h"
#include "roburoc4_robot_file.h"

#ifdef __cplusplus
extern "C" {
#endif

#ifndef ROBUROC4_SIM_API
#define ROBUROC4_SIM_API
#endif

/* -------------------------------------------------------------------------- configuration --- */

/** The longest datagram that the simulator sends. */
#define ROBUROC4_SIM_MAX_TRANSMIT 512
/** Peers at a time; each can subscribe to every service. */
#define ROBUROC4_SIM_MAX_PEERS 64
/** Boxes on the floor. */
#define ROBUROC4_SIM_MAX_BOXES 64
/** The most channels of each type. */
#define ROBUROC4_SIM_MAX_ANALOG 64
#define ROBUROC4_SIM_MAX_DIGITAL 256

/** The most telemeters. */
#define ROBUROC4_SIM_MAX_TELEMETERS 6

/** What a QUERY (4.2.3) gets. */
#define ROBUROC4_SIM_QUERY_ANSWERED 0
#define ROBUROC4_SIM_QUERY_SILENT 1    /* no answer at all */
#define ROBUROC4_SIM_QUERY_REFUSED 2   /* error 2: action not supported */
#define ROBUROC4_SIM_QUERY_A_SILENT 3  /* no answer to that for game pad [A], others as usual */
#define ROBUROC4_SIM_QUERY_A_REFUSED 4 /* that one gets error 5: wrong value */
#define ROBUROC4_SIM_QUERY_EMPTY 5     /* empty texts */

/** What is unusual about the texts; a sum. */
#define ROBUROC4_SIM_TEXTS_REORDERED 1 /* the last word comes first */
#define ROBUROC4_SIM_TEXTS_LATIN_1 2   /* quotes as in French, AB and BB in Latin-1 */
#define ROBUROC4_SIM_TEXTS_TWO_FRONT 4 /* two inputs for the front bumper */
#define ROBUROC4_SIM_TEXTS_LIKE_A 8    /* an unused input named "Game pad A LED" */
#define ROBUROC4_SIM_TEXTS_DOUBLED 16  /* each text and each refusal arrives twice */

/** What remains of a command that arrives while [A] is held, and of the target from before. */
#define ROBUROC4_SIM_OVERRIDE_DISCARDS 0 /* nothing: the target is 0 until the next command */
#define ROBUROC4_SIM_OVERRIDE_STORES 1   /* after the release, the last command is obeyed */
#define ROBUROC4_SIM_OVERRIDE_RESUMES 2  /* after the release, the target from before comes back */

/** Whose a subscription is. */
#define ROBUROC4_SIM_LIST_BY_SENDER 0
#define ROBUROC4_SIM_LIST_SHARED 1 /* the robot's: one period for all, statuses go to all */
#define ROBUROC4_SIM_LIST_LAST 2   /* the robot's: statuses go to the last who subscribed */

/** What an INSERT gets when the list is full. */
#define ROBUROC4_SIM_FULL_REFUSES 0 /* error 16 */
#define ROBUROC4_SIM_FULL_IGNORES 1 /* an acknowledgement, and nothing is sent */
#define ROBUROC4_SIM_FULL_FORGETS 2 /* it replaces the oldest subscription */

/** What a REPLACE of the localization gets. */
#define ROBUROC4_SIM_REPLACE_OBEYED 0
#define ROBUROC4_SIM_REPLACE_REFUSED 1 /* error 2: action not supported */
#define ROBUROC4_SIM_REPLACE_IGNORED 2 /* an acknowledgement without effect */

/** Configuration of a simulated robot. Fill it with roburoc4_sim_config_init(), then change what
 *  you need. Arrays by service use ROBUROC4_SERVICE_* as index, masks `1u << ROBUROC4_SERVICE_*`.
 *  A value after the last semicolon of a comment is the default. */
typedef struct roburoc4_sim_config {
    uint32_t size;             /* sizeof(roburoc4_sim_config), set by roburoc4_sim_config_init() */
    uint32_t watchdog_cycles;  /* cycles without speed command until it stops: 1 to 1000000; 100 */
    uint64_t seed;             /* of all its noise; 1 */
    uint16_t service_ids[8];   /* wire ids: the first two stay 0 and 1, all differ; 0 to 6 */
    uint16_t service_types[8]; /* type codes in the directory */
    uint32_t plain_types;      /* 1: all type codes are unknown ones; 0 */
    uint32_t hidden_services;  /* mask of services that the robot lacks (not the first two); 0 */
    uint32_t refused_inserts;  /* mask of services that cannot be subscribed to; 0 */
    uint32_t query_mode;       /* ROBUROC4_SIM_QUERY_*; _ANSWERED */
    uint32_t answer_id_fixed;  /* 1: every answer carries id 0x01, as the manual prints it; 0 */
    uint32_t only_id_fixed;    /* 1: requests whose id is not 0x01 are ignored; 0 */
    /* 1: an error answer carries header 0x00, not the request's id; 2: it is only that byte; 0 */
    uint32_t error_header;
    uint32_t start_safe; /* 1: power on leaves the motors off until the motor button; 0 */
    /* 1: the manual to the letter, where the defaults make a first drive easy. start_safe and
     * answer_id_fixed; no motor power while the charger is plugged in (5.1) or the charge is below
     * minimum_percent (4.2.2.6); the battery service takes the charge from the battery voltage of
     * the IO card (5.5.3); unused channels answer "-- exists but not used --" (5.5.1); 0 */
    uint32_t as_manual;
    uint32_t localization_flags; /* ROBUROC4_LOCALIZATION_*; METRIC and PROPRIOCEPTIVE */
    /* IO card. With 10 analog or 23 digital inputs the manual's numbers (5.5.1) are literal: all
     * from 03 on are one index higher than on a robot with the usual 9 and 22. */
    int32_t analog_inputs, analog_outputs;   /* up to ROBUROC4_SIM_MAX_ANALOG; 9 and 0 */
    int32_t digital_inputs, digital_outputs; /* up to ROBUROC4_SIM_MAX_DIGITAL; 22 and 8 */
    /* Speed limits, accelerations and width that its properties report (4.2.2.8). The robot obeys
     * them where they are finite with min <= 0 <= max, else the defaults: +-2.6 m/s, +-6.5 rad/s,
     * +-3 m/s2, +-8 rad/s2, 0.68 m. The accelerations leave a step from rest to full speed
     * untouched and flatten larger ones, such as from full ahead to full astern. */
    float max_linear_m_s, min_linear_m_s;
    float max_angular_rad_s, min_angular_rad_s;
    float max_linear_m_s2, min_linear_m_s2;
    float max_angular_rad_s2, min_angular_rad_s2;
    float width_m;
    float slip; /* fraction of a turn lost to skidding, 0 (no slip, no noise) to 0.9; 0.12 */
    /* Battery (4.2.2.6): 24 V, 60 Ah, cannot operate below 20 %; starts with 100 %. */
    float nominal_voltage_v; /* 1 to 1000 */
    float capacity_ah;       /* 0.001 to 100000 */
    float battery_percent;   /* 0 to 100 */
    uint32_t minimum_percent;
    double start_x_m, start_y_m, start_theta_rad; /* true pose and odometry at creation; 0, 0, 0 */
    /* The members below are answers to questions that the manual leaves open. docs/PROTOCOL.md,
     * "The family", has the questions and what each answer means. */
    uint64_t uptime_cycles;         /* robot time after each power on, up to 2^53; 0 */
    int32_t clock_ppm;              /* its clock is this much too fast, -1000 to 1000; 0 */
    uint32_t stamp_measured;        /* 1: a status is dated when its values were measured; 0 */
    uint32_t error_code;            /* the error of every refusal; 0: by cause; 0 */
    uint32_t surplus_bytes;         /* zeros at the end of each status, 0 to 8; 0 */
    uint32_t delete_refused;        /* 1: DELETE is refused; 0 */
    uint32_t replace_mode;          /* ROBUROC4_SIM_REPLACE_*; _OBEYED */
    uint32_t input_shift;           /* inputs from index 2 on are this much higher, 0 to 8; 0 */
    uint32_t texts;                 /* a sum of ROBUROC4_SIM_TEXTS_*; 0 */
    uint32_t telemeters;            /* 0 to ROBUROC4_SIM_MAX_TELEMETERS; 2 */
    uint32_t reported_distances;    /* at most so many in a status; 6 */
    float telemeter_turn_rad;       /* telemeter k points (k + 1) times this off its place; 0 */
    uint32_t other_status_port;     /* 1: roburoc4-sim sends statuses from another port; 0 */
    uint32_t subscription_lists;    /* ROBUROC4_SIM_LIST_*; _BY_SENDER */
    uint32_t min_period_cycles;     /* of a subscription, 1 to 20; 1 */
    uint32_t max_subscriptions;     /* of all peers, 1 to 448; 448 */
    uint32_t full_list;             /* ROBUROC4_SIM_FULL_*; _REFUSES */
    uint32_t keep_subscriptions;    /* 1: those of a closed port stay; 0 */
    uint32_t pad_keeps_target;      /* ROBUROC4_SIM_OVERRIDE_*; _DISCARDS */
    uint32_t ignored_commands_feed; /* 1: commands under [A] feed the watchdog; 0 */
    uint32_t pad_target_hidden;     /* 1: under [A], statuses have the computer's target; 0 */
    uint32_t tripped_target_shown;  /* 1: after the watchdog, statuses keep the target; 0 */
    uint32_t commands_need_motors;  /* 1: commands without motor power are ignored; 0 */
    uint32_t over_limit_refused;    /* 1: commands beyond a limit are ignored; 0: clamped; 0 */
    /* Response of the speeds: natural frequency (1.5 to 1000, from 1000 on immediate), damping
     * (0.6 to 1.5), final speed by target (0.85 to 1.15), dead time (0 to 15). */
    float linear_omega_rad_s, angular_omega_rad_s; /* 2.46 and 2.42 */
    float linear_damping, angular_damping;         /* 0.79 and 0.77 */
    float linear_gain, angular_gain;               /* 1 and 1 */
    uint32_t dead_time_cycles;                     /* 0 */
    uint32_t late_targets;           /* 1: statuses have the target after the dead time; 0 */
    float speed_noise;               /* on reported speeds, m/s and rad/s, 0 to 0.02; 0 */
    uint32_t odometry_period_cycles; /* between measurements of speeds and pose, 1 to 20; 1 */
    float odometry_scale;            /* of distance and angle, -2 to 2; 1 */
    uint32_t odometry_mirrored;      /* 1: turns count clockwise; 0 */
    /* Delays inside of the robot, 0 to ROBUROC4_SIM_MAX_QUEUE_MS, in queues of their own: what it
     * receives, answers, texts, and the statuses of each service; 0. */
    uint32_t queue_uplink_ms, queue_answer_ms, queue_text_ms;
    uint32_t queue_iocard_ms, queue_telemeter_ms, queue_battery_ms;
    uint32_t queue_localization_ms, queue_differential_ms;
} roburoc4_sim_config;

/** The longest delay in a queue of the robot. */
#define ROBUROC4_SIM_MAX_QUEUE_MS 5000

/** Fill with the defaults; `size` is sizeof(roburoc4_sim_config). ROBUROC4_ERR_SIZE (nothing
 *  written) for a size that the library does not know. */
ROBUROC4_SIM_API roburoc4_result roburoc4_sim_config_init(roburoc4_sim_config *config, size_t size);
/** Fill with a member of the family of robots that the manual allows (docs/PROTOCOL.md): the same
 *  one for the same seed. Results as of roburoc4_sim_config_init(). */
ROBUROC4_SIM_API roburoc4_result roburoc4_sim_config_family(roburoc4_sim_config *config,
                                                            size_t size, uint64_t seed);
/** Change what a robot file knows, so that the simulator is that robot. Nothing else changes. */
ROBUROC4_SIM_API void roburoc4_sim_config_robot_file(roburoc4_sim_config *config,
                                                     const roburoc4_robot_file *file);
/** What is wrong with a configuration and how to correct it, as one English sentence; NULL if
 * nothing is. Lives as long as the program. */
ROBUROC4_SIM_API const char *roburoc4_sim_config_error(const roburoc4_sim_config *config);

/* ------------------------------------------------------------------------------- the robot --- */

typedef struct roburoc4_sim roburoc4_sim;

/** A powered robot at its start pose in its default room, with a few boxes, all at least 5 m
 *  away. Every control is released, the brakes are AUTOMATIC, the motors are on (unless
 *  start_safe). config may be NULL for the defaults. NULL: a bad configuration (see
 *  roburoc4_sim_config_error()), or no memory. */
ROBUROC4_SIM_API roburoc4_sim *roburoc4_sim_create(const roburoc4_sim_config *config);
/** Free it; NULL is ignored. */
ROBUROC4_SIM_API void roburoc4_sim_destroy(roburoc4_sim *sim);

/** Process a datagram of any content and length from `peer`, at the time of the last advance().
 *  NULL instead of a datagram: the peer's port is closed (ICMP port unreachable). Two such reports
 *  at least 2 s apart, from a peer that sent nothing for 5 s, end its subscriptions. */
ROBUROC4_SIM_API void roburoc4_sim_receive(roburoc4_sim *sim, uint64_t peer, const uint8_t *data,
                                           size_t size);
/** Run all cycles that are due at now_us. The first call sets when cycle 0 was and runs none. A
 *  time before the last is ignored. After a long step, datagrams that find the transmit queue full
 *  (32 KiB) are dropped and counted: step by next_deadline() to have them all. */
ROBUROC4_SIM_API void roburoc4_sim_advance(roburoc4_sim *sim, uint64_t now_us);
/** Take the next datagram to send: its length, or 0 when there is none. ROBUROC4_ERR_BUFFER leaves
 *  it where it is; ROBUROC4_SIM_MAX_TRANSMIT bytes are always enough. */
ROBUROC4_SIM_API roburoc4_result roburoc4_sim_poll_transmit(roburoc4_sim *sim, uint64_t *peer,
                                                            uint8_t *buffer, size_t capacity);
/** When the next cycle is due: 0 before the first advance(). */
ROBUROC4_SIM_API uint64_t roburoc4_sim_next_deadline(const roburoc4_sim *sim);

/* ------------------------------------------------------------------------------- controls --- */

/** What a person beside the robot can do (5.1, 5.2, 4.1, 5.4), and some things that are possible
 *  only in simulation. The value is 1 or 0 unless the comment says otherwise. The name of a
 *  control, in the panel's lines and in other languages, is that of its constant: "estop_local". */
/* main power switch. Off: silent, motors off, all subscriptions gone. On after off is a reboot:
 * cycles from 0, odometry at the start pose, targets 0. The robot stays where it is. */
#define ROBUROC4_SIM_POWER 0
/* 1 presses the button. ROBUROC4_ERR_STATE, and still no power, unless the main power is on, both
 * emergency stops are released and the brakes are AUTOMATIC. Reads: whether the motors have power
 */
#define ROBUROC4_SIM_MOTOR_BUTTON 1
/* emergency stops: pressed, they cut the motors' power and the robot brakes. Releasing alone brings
 * no power back */
#define ROBUROC4_SIM_ESTOP_LOCAL 2
#define ROBUROC4_SIM_ESTOP_REMOTE 3
/* brakes selector: AUTOMATIC (0), or RELEASED, which cuts the motors' power: the robot coasts
 * to a stop */
#define ROBUROC4_SIM_BRAKES_RELEASED 4
#define ROBUROC4_SIM_CHARGER 5 /* plugged in */
/* remaining energy, 0 to 100. With an empty battery the robot keeps running, so that a test decides
 * when the power fails */
#define ROBUROC4_SIM_BATTERY_PERCENT 6
/* bumpers, pressed by hand; contact with an obstacle presses them as well. A pressed bumper stops
 * motion towards it; the other direction is free */
#define ROBUROC4_SIM_FRONT_BUMPER 7
#define ROBUROC4_SIM_REAR_BUMPER 8
#define ROBUROC4_SIM_LOCALIZATION_FLAGS 9 /* a sum of ROBUROC4_LOCALIZATION_* */
#define ROBUROC4_SIM_PAD 10               /* 0 releases all buttons and axes of the game pad */
#define ROBUROC4_SIM_PIN 11               /* 0 unpins all inputs */
/* robot time at the next power on */
#define ROBUROC4_SIM_UPTIME_CYCLES 12
/* another robot takes this one's place at the address: roburoc4_sim_config_family() of this seed,
 * as at creation. Subscriptions and what was on its way are gone; write-only */
#define ROBUROC4_SIM_FAMILY 13
/* faults: services whose providers stand still, or report NaN: sums of 1 << ROBUROC4_SERVICE_*, of
 * those with statuses */
#define ROBUROC4_SIM_FROZEN 14
#define ROBUROC4_SIM_NAN 15
/* the axis follows no target */
#define ROBUROC4_SIM_BLOCKED_LINEAR 16
#define ROBUROC4_SIM_BLOCKED_ANGULAR 17
/* added to the target of an axis while there is motor power: the robot creeps, or with a blocked
 * axis runs away */
#define ROBUROC4_SIM_CREEP_M_S 18
#define ROBUROC4_SIM_CREEP_RAD_S 19
/* odometry: its scale, and its pose, as when another program corrects it */
#define ROBUROC4_SIM_ODOMETRY_SCALE 20
#define ROBUROC4_SIM_ODOMETRY_X_M 21
#define ROBUROC4_SIM_ODOMETRY_Y_M 22
#define ROBUROC4_SIM_ODOMETRY_THETA_RAD 23
/* delays, as in the configuration: "queue_uplink_ms" to "queue_differential_ms" */
#define ROBUROC4_SIM_QUEUE_UPLINK_MS 24
#define ROBUROC4_SIM_QUEUE_ANSWER_MS 25
#define ROBUROC4_SIM_QUEUE_TEXT_MS 26
#define ROBUROC4_SIM_QUEUE_IOCARD_MS 27
#define ROBUROC4_SIM_QUEUE_TELEMETER_MS 28
#define ROBUROC4_SIM_QUEUE_BATTERY_MS 29
#define ROBUROC4_SIM_QUEUE_LOCALIZATION_MS 30
#define ROBUROC4_SIM_QUEUE_DIFFERENTIAL_MS 31
/* a button of the game pad, on any robot: add ROBUROC4_DI_PAD_A to _RB; "pad_a" to "pad_rb". While
 * [A] is held the pad's axes drive and speed commands are ignored; after it the target is 0 until
 * the next command (another pad_keeps_target: otherwise) */
#define ROBUROC4_SIM_PAD_BUTTON 100
/* an axis, -1 to 1: add ROBUROC4_AI_PAD_LJ_X to _RT; "pad_lj_x" to "pad_rt". Sticks rest at 0 and
 * go to 1 at right and up; the triggers LT and RT rest at -1 and reach 1 fully pressed. RT drives
 * forward, LT backward, LJ_X turns (right is clockwise); full means the robot's limit */
#define ROBUROC4_SIM_PAD_AXIS 200
/* pin the value that an input reports, whatever the model's own value, which stays in effect: add
 * its index on the wire; "pin_analog_2". Any float, NaN too. Reads: what the input reports */
#define ROBUROC4_SIM_PIN_ANALOG 1000
#define ROBUROC4_SIM_PIN_DIGITAL 2000
/* read-only: the last commanded value of an output, 0 before the first command and after a
 * reboot; "digital_output_3". Digital output 0 is the robot's own: 1 while speed commands keep its
 * watchdog from tripping */
#define ROBUROC4_SIM_ANALOG_OUTPUT 3000
#define ROBUROC4_SIM_DIGITAL_OUTPUT 4000

/** Set a control. ROBUROC4_ERR_INDEX: there is no control with this number; ROBUROC4_ERR_ARGUMENT:
 *  invalid value; ROBUROC4_ERR_STATE: not possible now. */
ROBUROC4_SIM_API roburoc4_result roburoc4_sim_set(roburoc4_sim *sim, uint32_t control,
                                                  double value);
/** Read a control. ROBUROC4_ERR_INDEX: there is no control with this number, or it cannot be
 * read. */
ROBUROC4_SIM_API roburoc4_result roburoc4_sim_get(const roburoc4_sim *sim, uint32_t control,
                                                  double *out);
/** The number of the control with this name, or ROBUROC4_ERR_INDEX. Underscores are ignored, and
 *  the parts after one can be omitted if the rest is unique: "battery", "brakes". */
ROBUROC4_SIM_API roburoc4_result roburoc4_sim_control_find(const char *name);

/* ------------------------------------------------------------------------------ obstacles --- */
/*
 * Boxes on the floor, seen by the telemeters and hit by the bumpers. The robot's body, 1.310 m
 * long and 0.750 m wide around its pose, is never inside of one.
 */

/** Add a box by its centre, its sizes (0.01 to 10000 m) along its own axes, and its orientation.
 *  Its number (0 or more), ROBUROC4_ERR_ARGUMENT (a value), ROBUROC4_ERR_STATE (the robot is
 *  there), ROBUROC4_ERR_BUFFER (there are ROBUROC4_SIM_MAX_BOXES). A wall is a thin box. */
ROBUROC4_SIM_API roburoc4_result roburoc4_sim_add_box(roburoc4_sim *sim, double x_m, double y_m,
                                                      double size_x_m, double size_y_m,
                                                      double theta_rad);
/** Remove all boxes. */
ROBUROC4_SIM_API void roburoc4_sim_clear_obstacles(roburoc4_sim *sim);
/** Lift the robot to another true pose, at rest; its odometry notices nothing.
 *  ROBUROC4_ERR_ARGUMENT (not finite), ROBUROC4_ERR_STATE (an obstacle is there). */
ROBUROC4_SIM_API roburoc4_result roburoc4_sim_place(roburoc4_sim *sim, double x_m, double y_m,
                                                    double theta_rad);

/* --------------------------------------------------------------------------- observation --- */

/** Everything about the robot: roburoc4_sim_get_state(sim, ROBUROC4_SIZED(&state)). */
typedef struct roburoc4_sim_state {
    uint32_t size;          /* set by ROBUROC4_SIZED() */
    uint32_t battery_state; /* ROBUROC4_BATTERY_* */
    uint64_t now_us;        /* time of the last advance() */
    uint64_t cycles;        /* low level cycles since power on */
    /* its true pose and motion */
    double true_x_m, true_y_m, true_theta_rad;
    double true_linear_m_s, true_angular_rad_s;
    /* as its wheels measure: the localization and differential services */
    double odometry_x_m, odometry_y_m, odometry_theta_rad;
    double wheel_linear_m_s, wheel_angular_rad_s;
    double target_linear_m_s, target_angular_rad_s;
    /* the last differential command that had the right length, accepted or not, as it was sent */
    double last_linear_m_s, last_angular_rad_s;
    uint64_t last_command_us;
    float distances_m[2]; /* of the first two telemeters, ROBUROC4_TELEMETER_*; NaN without */
    float battery_percent, battery_v;
    /* 1 or 0 */
    int32_t powered, motors_enabled;
    int32_t estop_local, estop_remote, brakes_released, charger;
    int32_t overridden;       /* [A] is held */
    int32_t watchdog_tripped; /* no speed command for too long, or none since power on */
    int32_t front_bumper, rear_bumper;
    /* since creation, reboots included */
    uint32_t reboots;                /* power on after power off */
    uint32_t requests, errors;       /* requests received; answered with an error */
    uint32_t speed_commands;         /* differential commands of the right length */
    uint32_t nonzero_speed_commands; /* of these: not both speeds 0 */
    uint32_t
        refused_speed_commands; /* of these: not finite, [A] was held, or ignored as configured */
    uint32_t io_commands;       /* IO card commands of the right length */
    uint32_t ignored;           /* invalid datagrams */
    uint32_t dropped;           /* datagrams that it could not queue */
    /* now */
    uint32_t peers;         /* with at least one subscription */
    uint32_t subscriptions; /* of all peers */
    uint32_t reserved;
} roburoc4_sim_state;

/** Read the state. ROBUROC4_ERR_SIZE for a size that the library does not know. */
ROBUROC4_SIM_API roburoc4_result roburoc4_sim_get_state(const roburoc4_sim *sim,
                                                        roburoc4_sim_state *out);
/** Carry out one line of text, such as `pad a down`, `pad rt 0.5`, `estop local press`, `power
 *  off`; `help` lists them all. `reply` (capacity bytes, at least 1) gets "ok", the requested text,
 *  or an error message; ROBUROC4_SIM_REPLY_SIZE bytes hold the longest. An empty line, or one that
 *  begins with `#`, does nothing. ROBUROC4_ERR_ARGUMENT: invalid line; nothing was changed.
 *  ROBUROC4_ERR_STATE: not possible now. */
#define ROBUROC4_SIM_REPLY_SIZE 2048
ROBUROC4_SIM_API roburoc4_result roburoc4_sim_panel(roburoc4_sim *sim, const char *line,
                                                    char *reply, size_t capacity);

/* ---------------------------------------------------------------------------- virtual time --- */
/*
 * A robot, its clients, and a network for each of them. Time advances only in
 * roburoc4_world_step(): no sockets, no waiting, and the same calls give the same bytes.
 *
 *     roburoc4_world *world = roburoc4_world_create(NULL);
 *     roburoc4_client_init(&client, sizeof client, NULL);
 *     roburoc4_world_join(world, &client);
 *     while (roburoc4_world_step(world, 5000000, NULL, NULL) != 0) {
 *         events |= roburoc4_client_take_events(&client);
 *     }
 *     roburoc4_client_arm(&client, roburoc4_world_now_us(world));
 */

typedef struct roburoc4_world roburoc4_world;

/** Faults of a network, in each direction. The probabilities are 0 to 1, independent for each
 *  datagram; all 0 for a perfect network. */
typedef struct roburoc4_sim_faults {
    uint32_t size;      /* set by ROBUROC4_SIZED() */
    uint32_t delay_us;  /* of every datagram */
    uint32_t jitter_us; /* up to this much more; jitter alone does not reorder */
    uint32_t reserved;
    double loss;      /* never arrives */
    double duplicate; /* arrives twice */
    double reorder;   /* delayed by 1 to 40 ms, so that later ones overtake it */
    double corrupt;   /* one to four bits are flipped, or (one in four) its end is cut off */
} roburoc4_sim_faults;

/** The most clients in a world. */
#define ROBUROC4_WORLD_MAX_CLIENTS 16

/** A world with one robot, which is on, and without clients; its time begins at 1 s. config is that
 *  of roburoc4_sim_create(). NULL: a bad configuration, or no memory. */
ROBUROC4_SIM_API roburoc4_world *roburoc4_world_create(const roburoc4_sim_config *config);
/** Free it, and its robot; the clients are yours. NULL is ignored. */
ROBUROC4_SIM_API void roburoc4_world_destroy(roburoc4_world *world);
/** The robot, to act as the person beside it. The world handles its datagrams and its time. */
ROBUROC4_SIM_API roburoc4_sim *roburoc4_world_robot(roburoc4_world *world);
/** The time to pass to every client call. */
ROBUROC4_SIM_API uint64_t roburoc4_world_now_us(const roburoc4_world *world);
/** Start a client (after roburoc4_client_init()) and carry its datagrams from now on. It must not
 *  move in memory until roburoc4_world_leave(). Returns its number, 1 or more, which no other
 *  client of this world gets; ROBUROC4_ERR_BUFFER (the world is full), ROBUROC4_ERR_SYSTEM (no
 *  memory), or what roburoc4_client_start() returns. */
ROBUROC4_SIM_API roburoc4_result roburoc4_world_join(roburoc4_world *world,
                                                     roburoc4_client *client);
/** Stop carrying datagrams of this client; what is in flight is lost. To let it stop the robot,
 *  first call roburoc4_client_close() and let time pass. */
ROBUROC4_SIM_API void roburoc4_world_leave(roburoc4_world *world, const roburoc4_client *client);
/** Set the faults of all networks; datagrams in flight keep theirs. ROBUROC4_ERR_SIZE, or
 *  ROBUROC4_ERR_ARGUMENT for a probability outside of 0 to 1: nothing was changed. */
ROBUROC4_SIM_API roburoc4_result roburoc4_world_set_faults(roburoc4_world *world,
                                                           const roburoc4_sim_faults *faults);
/** Advance to the next time at which a client has news (it received a datagram, or it was due), but
 *  not beyond until_us. Returns the client's number; take its events and read its values before the
 *  next step. Returns 0 once until_us is reached and nothing is left to do. A time that is not
 *  ahead only sends what clients have to send, as after roburoc4_client_drive(). datagram and size
 *  (each may be NULL) are set to the datagram that the client received, which is valid until the
 *  next step; size is 0 if there was none. */
ROBUROC4_SIM_API uint32_t roburoc4_world_step(roburoc4_world *world, uint64_t until_us,
                                              const uint8_t **datagram, size_t *size);

#ifdef __cplusplus
}
#endif

#endif
