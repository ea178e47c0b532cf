/* SPDX-License-Identifier: MIT
 *
 * The simulator's internal header: the state of a robot, and what its parts offer to each other.
 * The heading of each section names the file that holds it.
 */
#ifndef ROBUROC4_SIM_MODEL_H
#define ROBUROC4_SIM_MODEL_H

#include <float.h>
#include <math.h>
#include <stdbool.h>

#include "roburoc4_sim.h"

#define SIM_PI 3.14159265358979323846
#define CYCLE_S ((double)ROBUROC4_CYCLE_US * 1e-6)
#define SIM_BODY_LENGTH_M 1.310
#define SIM_BODY_WIDTH_M 0.750
#define SIM_WALL_THICKNESS_M 0.1
/* The share of a way that is lost where all of a turn would be. */
#define SIM_SLIP_AHEAD 0.1
#define SIM_MAX_SLIP 0.9f

#define SIM_PAD_BUTTONS (ROBUROC4_DI_PAD_RB - ROBUROC4_DI_PAD_A + 1)
#define SIM_PAD_AXES (ROBUROC4_AI_PAD_RT - ROBUROC4_AI_PAD_LJ_X + 1)
#define SIM_QUEUE_BYTES 32768
#define SIM_DEAD_TIME_CYCLES 16

/* Unused digital inputs of the manual's table that may get a text. */
#define SIM_SECOND_FRONT 2
#define SIM_LIKE_A 3

#define SIM_FRONT 0
#define SIM_REAR 1

typedef struct sim_pose {
    double x_m, y_m, theta_rad;
} sim_pose;

typedef struct sim_speed {
    double linear_m_s, angular_rad_s;
} sim_speed;

/* A subscription; period 0 if there is none. */
typedef struct sim_subscription {
    uint64_t phase_cycles;
    uint8_t period_cycles;
} sim_subscription;

typedef struct sim_peer {
    uint64_t key;
    uint64_t heard_us;
    uint64_t refused_us; /* first report of a closed port since its last datagram */
    uint32_t datagrams;  /* 0: the slot is free */
    bool refused;
    sim_subscription subscriptions[ROBUROC4_SERVICE_COUNT];
} sim_peer;

/* The robot's own queues; the last ones are numbered like their controls. */
typedef enum sim_delay {
    SIM_DELAY_UPLINK,
    SIM_DELAY_ANSWER,
    SIM_DELAY_TEXT,
    SIM_DELAY_IOCARD,
    SIM_DELAY_DIFFERENTIAL = SIM_DELAY_IOCARD + 4,
    SIM_DELAYS
} sim_delay;

/* Datagrams on their way, as records in a ring of bytes. */
typedef struct sim_queue {
    uint32_t head, used;
    uint8_t bytes[SIM_QUEUE_BYTES];
} sim_queue;

/* A second-order response sampled exactly at the cycle. The state is (speed - target, slope). */
typedef struct sim_response {
    double ee, es, se, ss;
} sim_response;

typedef struct sim_axis {
    double speed, slope;
    double max_speed, min_speed;
    double max_slope, min_slope;
    sim_response response;
    bool immediate;
} sim_axis;

typedef struct sim_box {
    double x_m, y_m;
    double half_x_m, half_y_m;
    double cos_theta, sin_theta;
    double radius_m;
} sim_box;

struct roburoc4_sim {
    roburoc4_sim_config config;
    uint64_t random;

    /* time */
    bool started;
    uint64_t now_us, next_us, cycles;
    int32_t clock_debt; /* what the clock gained and did not spend yet, in 10 ns */

    /* control panel and game pad */
    bool powered, motors, charger, brakes_released;
    bool estop[2], bumper_pressed[2]; /* local and remote; SIM_FRONT and SIM_REAR */
    bool buttons[SIM_PAD_BUTTONS];
    float axes[SIM_PAD_AXES];

    /* motion */
    sim_axis linear, angular;
    sim_speed target, body;
    sim_speed kept;                           /* the computer's target while [A] is held */
    sim_speed tripped;                        /* what statuses show after the watchdog tripped */
    sim_speed accepted[SIM_DEAD_TIME_CYCLES]; /* targets of the last cycles, by cycle */
    uint32_t accepted_at;
    sim_pose odometry, truth;
    double slip_noise, drift_noise;
    uint64_t cycles_since_command;
    bool fed;

    /* what its odometry measured last */
    sim_pose measured_pose;
    sim_speed measured_speed;
    uint64_t measured_cycles;

    /* faults */
    uint32_t frozen, nan; /* masks of services */
    uint32_t blocked_linear, blocked_angular;
    sim_speed creep;

    /* obstacles */
    sim_box boxes[ROBUROC4_SIM_MAX_BOXES];
    uint32_t box_count;
    bool contact[2];

    double battery_ah;
    uint32_t localization_flags;

    /* IO card */
    float analog_pins[ROBUROC4_SIM_MAX_ANALOG];
    bool analog_pinned[ROBUROC4_SIM_MAX_ANALOG];
    int8_t digital_pins[ROBUROC4_SIM_MAX_DIGITAL]; /* -1: the model's value */
    float analog_outputs[ROBUROC4_SIM_MAX_ANALOG];
    uint8_t digital_outputs[ROBUROC4_SIM_MAX_DIGITAL]; /* 0 or 1 each */

    /* link */
    sim_peer peers[ROBUROC4_SIM_MAX_PEERS];
    uint32_t peer_count; /* slots in use are below it */
    sim_queue in, queue; /* received, and to send */
    uint64_t last_due_us[SIM_DELAYS];
    /* of a frozen service */
    uint8_t last_status[ROBUROC4_SERVICE_COUNT][ROBUROC4_SIM_MAX_TRANSMIT];
    roburoc4_result last_status_length[ROBUROC4_SERVICE_COUNT];

    /* the last command and the counters, as the public snapshot has them */
    roburoc4_sim_state counts;
};

/* Not <math.h>'s isfinite(), which narrows a double on some compilers. */
static inline bool sim_is_finite(double value) {
    return value >= -DBL_MAX && value <= DBL_MAX;
}

/* Sizes that a struct of another version may have; the size says which members there are. */
static inline bool sim_size_is_valid(size_t size, size_t own) {
    return size >= 8 && size <= own && size % 4 == 0;
}

/* Wraps to -pi..pi. */
static inline double sim_wrap(double angle_rad) {
    return angle_rad > SIM_PI || angle_rad < -SIM_PI ? remainder(angle_rad, 2.0 * SIM_PI)
                                                     : angle_rad;
}

/* config.c: a configuration of this or an older size, with defaults for the missing members. */
bool sim_config_take(roburoc4_sim_config *out, const roburoc4_sim_config *config);

/* random.c: a small generator, seeded per robot and per channel. */
uint64_t sim_random(uint64_t *state);
double sim_random_unit(uint64_t *state);   /* 0 to 1, without 1 */
double sim_random_signed(uint64_t *state); /* -1 to 1 */

/* queue.c */
void sim_queue_clear(sim_queue *queue);
bool sim_queue_push(sim_queue *queue, uint64_t peer, const uint8_t *data, size_t size,
                    uint64_t due_us);
/* The first that is due. */
roburoc4_result sim_queue_pop(sim_queue *queue, uint64_t now_us, uint64_t *peer, uint8_t *buffer,
                              size_t capacity);
/* When a datagram leaves the robot's queue that it enters now. */
uint64_t sim_queue_due_us(roburoc4_sim *sim, sim_delay delay);
/* The configuration's delay. */
uint32_t *sim_queue_delay_ms(roburoc4_sim_config *config, sim_delay delay);

/* peers.c: who subscribed to what. */
int32_t sim_peers_slot(const roburoc4_sim *sim, uint64_t key); /* -1: not there */
sim_peer *sim_peers_find(roburoc4_sim *sim, uint64_t key);     /* NULL: not there */
/* The peer's slot, a new one if need be; NULL when there is no room. Only a subscriber may take
 * another subscriber's place. */
sim_peer *sim_peers_heard(roburoc4_sim *sim, uint64_t key, bool subscribes);
void sim_peers_clear(roburoc4_sim *sim);
void sim_peers_unreachable(roburoc4_sim *sim, uint64_t key);
/* Enter a subscription, as the configuration says whose it is; the error byte of its answer. */
uint8_t sim_peers_subscribe(roburoc4_sim *sim, uint64_t key, uint32_t service,
                            uint8_t period_cycles);
bool sim_peers_unsubscribe(roburoc4_sim *sim, uint64_t key, uint32_t service);
/* The period that a peer sees in the list; 0: none. */
uint8_t sim_peers_period(const roburoc4_sim *sim, const sim_peer *asker, uint32_t service);
uint32_t sim_peer_subscriptions(const sim_peer *peer);

/* protocol.c: datagrams in, answers out. */
void sim_protocol_receive(roburoc4_sim *sim, uint64_t peer, const uint8_t *data, size_t size);
/* services.c: telegrams of the services; lengths as the codec's encoders return them. */
bool sim_service_exists(const roburoc4_sim *sim, uint32_t service);
int32_t sim_service_of_id(const roburoc4_sim *sim, uint16_t id);
roburoc4_result sim_service_properties(const roburoc4_sim *sim, const sim_peer *asker,
                                       uint32_t service, uint8_t id, uint8_t *buffer,
                                       size_t capacity);
roburoc4_result sim_directory_text(const roburoc4_sim *sim, uint32_t index, uint8_t id,
                                   uint8_t *buffer, size_t capacity);
roburoc4_result sim_iocard_text(const roburoc4_sim *sim, uint32_t io_type, int32_t index,
                                uint8_t id, uint8_t *buffer, size_t capacity);
void sim_services_notify(roburoc4_sim *sim);
void sim_services_freeze(roburoc4_sim *sim, uint32_t services); /* a mask; 0: none */

/* robot.c: another robot takes this one's place. */
void sim_robot_replace(roburoc4_sim *sim, const roburoc4_sim_config *config);

/* config.c: which channel of the manual's tables one of this card is; or -1. */
int32_t sim_channel_meaning(const roburoc4_sim *sim, uint32_t io_type, uint32_t index);

/* inputs.c: what the IO card reads. */
float sim_analog_input(const roburoc4_sim *sim, uint32_t index);
bool sim_digital_input(const roburoc4_sim *sim, uint32_t index);
bool sim_bumper(const roburoc4_sim *sim, uint32_t which);

void sim_inputs_unpin(roburoc4_sim *sim);

/* cockpit.c: power, motors, game pad. */
void sim_cockpit_power_up(roburoc4_sim *sim);
void sim_cockpit_switch(roburoc4_sim *sim, bool on);
bool sim_cockpit_press_motor_button(roburoc4_sim *sim); /* false if motor power is not possible */
void sim_cockpit_check_motors(roburoc4_sim *sim);       /* after a change that may forbid them */
void sim_cockpit_press(roburoc4_sim *sim, uint32_t button, bool down); /* ROBUROC4_DI_PAD_* */
void sim_cockpit_release_pad(roburoc4_sim *sim);
void sim_cockpit_cycle(roburoc4_sim *sim); /* the pad sets the target while it is in control */

/* motion.c */
void sim_motion_init(roburoc4_sim *sim); /* take the limits of the configuration */
void sim_motion_cycle(roburoc4_sim *sim);
void sim_motion_command(roburoc4_sim *sim, double linear_m_s, double angular_rad_s);
void sim_motion_feed(roburoc4_sim *sim); /* its watchdog */
bool sim_pad_drives(const roburoc4_sim *sim);
void sim_motion_forget(roburoc4_sim *sim); /* target 0 until the next command */
bool sim_motion_is_beyond(const roburoc4_sim *sim, double linear_m_s, double angular_rad_s);
sim_speed sim_motion_shown_target(const roburoc4_sim *sim);

/* obstacles.c */
void sim_obstacles_init(roburoc4_sim *sim);
/* Move box `number`. ROBUROC4_ERR_INDEX, or the results of roburoc4_sim_add_box(). */
roburoc4_result sim_obstacles_move_box(roburoc4_sim *sim, uint32_t number, double x_m, double y_m,
                                       double theta_rad);
/* Move the body from its true pose as far towards `goal` as obstacles allow, and find which
 * bumpers touch. */
void sim_obstacles_move(roburoc4_sim *sim, const sim_pose *goal);

/* telemeter.c */
void sim_telemeter_describe(const roburoc4_sim *sim, uint32_t which, roburoc4_telemeter *out);
float sim_telemeter_distance(const roburoc4_sim *sim, uint32_t which);
float sim_telemeter_voltage(const roburoc4_sim *sim, uint32_t which);

/* battery.c */
void sim_battery_set(roburoc4_sim *sim, float percent);
void sim_battery_cycle(roburoc4_sim *sim);
float sim_battery_percent(const roburoc4_sim *sim);
uint8_t sim_battery_remaining(const roburoc4_sim *sim); /* the percentage as it is reported */
float sim_battery_voltage(const roburoc4_sim *sim);
uint8_t sim_battery_state(const roburoc4_sim *sim);

#endif
