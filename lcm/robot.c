/* SPDX-License-Identifier: MIT */
#include "robot.h"

#include <string.h>

#include "clock.h"
#include "explain.h"
#include "publish.h"

#define STATUS_PERIOD_US 200000u
#define STATUS_SOONEST_US 50000u
#define PROPERTIES_PERIOD_US 1000000u
#define ABSENT_US 1000000u
/* The wall clock was set when it moved by more than this against the other one. */
#define CLOCK_SET_US 100000
/* LCM drops what comes after so many messages that were not read, and keeps the old ones. */
#define QUEUE_CAPACITY 1000
/* So long after a stall LCM's thread may still hand on what came during it. */
#define STALL_ECHO_US 50000u

static gate_robot robot_for_gate(const robot *robot, uint64_t now_us) {
    roburoc4_facts facts = {.size = sizeof facts};
    (void)roburoc4_client_facts(&robot->client, now_us, &facts);
    gate_robot for_gate = {facts.state == ROBUROC4_STATE_READY, facts.armed != 0,
                           facts.arm_refusal};
    return for_gate;
}

/* -------------------------------------------------------------------------------- commands --- */

/* Tell of a rejection that was counted. */
static void tell_rejection(robot *robot, enum gate_verdict verdict, const explain_command *command,
                           gate_time now) {
    uint32_t bit = 1u << verdict;
    robot->status_due = robot->status_due || (robot->told & bit) == 0;
    explain_rejection(robot->name, verdict, command, &robot->gate.rules, now,
                      (robot->told & bit) == 0);
    robot->told |= bit;
}

static void tell_rejected_message(robot *robot, enum gate_verdict verdict, const command *command,
                                  gate_time now) {
    explain_command told = {.kind = command->kind,
                            .channel = robot->channels->name[CHANNEL_DRIVE_CMD + command->kind]};
    if (verdict != GATE_MALFORMED) {
        told.sender = command->sender;
        told.sender_length = command->sender_length;
        told.utime = command->utime;
    }
    tell_rejection(robot, verdict, &told, now);
}

static float to_float(double value) {
    const double far = 1e6; /* beyond any limit; the client clamps to the robot's own */
    return (float)(value > far ? far : value < -far ? -far : value);
}

/* All of the outputs, or none. */
static roburoc4_result set_outputs(robot *robot, const command *command, uint64_t now_us) {
    roburoc4_iocard_properties card;
    roburoc4_result result = roburoc4_client_iocard_properties(&robot->client, &card);
    if (result < 0) {
        return result;
    }
    for (uint32_t at = 0; at < command->analog_count; at++) {
        int32_t index = command->analog[at].index;
        if (index < 0 || index >= card.analog_outputs || index >= ROBUROC4_MAX_ANALOG_OUTPUTS) {
            return ROBUROC4_ERR_INDEX;
        }
    }
    if (command->digital_beyond) {
        return ROBUROC4_ERR_INDEX;
    }
    if (command->digital_mask != 0) {
        result = roburoc4_client_set_digital_outputs(&robot->client, command->digital_mask,
                                                     command->digital_values, now_us);
    }
    for (uint32_t at = 0; result >= 0 && at < command->analog_count; at++) {
        result = roburoc4_client_set_analog_output(
            &robot->client, (uint32_t)command->analog[at].index, command->analog[at].value, now_us);
    }
    return result;
}

/* Of relocalize and output commands each one counts; of drive commands, the newest of a wake. */
static void take(robot *robot, const command *command, uint32_t lease_us, gate_time now) {
    roburoc4_result result = 0;
    if (command->kind == GATE_DRIVE) {
        robot->superseded += robot->has_drive;
        robot->has_drive = true;
        robot->drive.linear_m_s = to_float(command->linear_m_s);
        robot->drive.angular_rad_s = to_float(command->angular_rad_s);
        robot->drive.lease_us = lease_us;
        return;
    }
    if (command->kind == GATE_RELOCALIZE) {
        result = roburoc4_client_relocalize(&robot->client, command->x_m, command->y_m,
                                            command->theta_rad, now.us);
    } else {
        result = set_outputs(robot, command, now.us);
    }
    if (result < 0) {
        gate_reject(&robot->gate, GATE_IMPOSSIBLE);
        tell_rejected_message(robot, GATE_IMPOSSIBLE, command, now);
        return;
    }
    robot->command_us = (int64_t)now.us;
    gate_count_taken(&robot->gate, command->kind);
}

/* When a message came, at the earliest: LCM's thread stamps it when it reads it, which is late
 * where this process was stopped or starved. */
static int64_t arrival(const robot *robot, int64_t recv_utime, gate_time now) {
    return now.us < robot->stalled_until_us && robot->stalled_utime < recv_utime
               ? robot->stalled_utime
               : recv_utime;
}

void robot_was_stalled(robot *robot, int64_t since_utime, gate_time now) {
    if (now.us >= robot->stalled_until_us) {
        robot->stalled_utime = since_utime;
    }
    robot->stalled_until_us = now.us + STALL_ECHO_US;
}

/* LCM calls this for each message on the channel of a command. */
static void on_message(const lcm_recv_buf_t *message, const char *channel, void *user) {
    const robot_input *input = user;
    robot *robot = input->robot;
    gate_time now = clock_now();
    uint32_t lease_us = 0;
    command command;
    (void)channel; /* it is that of the input */
    if (!command_decode(input->kind, message->data, message->data_size, &command)) {
        gate_reject(&robot->gate, GATE_MALFORMED);
        tell_rejected_message(robot, GATE_MALFORMED, &command, now);
        return;
    }
    gate_command for_gate = command_for_gate(&command, arrival(robot, message->recv_utime, now));
    gate_robot state = robot_for_gate(robot, now.us);
    enum gate_verdict verdict = gate_judge(&robot->gate, &for_gate, &state, now, &lease_us);
    if (verdict == GATE_TAKEN) {
        take(robot, &command, lease_us, now);
    } else {
        tell_rejected_message(robot, verdict, &command, now);
    }
}

/* ---------------------------------------------------------------------------------- motion --- */

/* By the robot's limits, or by the ceiling that always applies too. */
static bool is_beyond(float asked, float min, float max, float ceiling) {
    return asked > max || asked < min || asked > ceiling || asked < -ceiling;
}

static bool is_clamped(const robot *robot) {
    roburoc4_differential_properties limits;
    return roburoc4_client_differential_properties(&robot->client, &limits) >= 0 &&
           (is_beyond(robot->drive.linear_m_s, limits.min_linear_m_s, limits.max_linear_m_s,
                      robot->config->max_linear_m_s) ||
            is_beyond(robot->drive.angular_rad_s, limits.min_angular_rad_s,
                      limits.max_angular_rad_s, robot->config->max_angular_rad_s));
}

static bool arm(robot *robot, gate_time now) {
    if (roburoc4_client_arm(&robot->client, now.us) < 0) {
        return false;
    }
    gate_armed(&robot->gate);
    return true;
}

static void apply_drive(robot *robot, gate_time now) {
    const robot_drive *drive = &robot->drive;
    robot->has_drive = false;
    if (!arm(robot, now) ||
        roburoc4_client_drive(&robot->client, drive->linear_m_s, drive->angular_rad_s,
                              drive->lease_us, now.us) < 0) {
        explain_command told = {.kind = GATE_DRIVE,
                                .channel = robot->channels->name[CHANNEL_DRIVE_CMD]};
        told.sender = gate_commander(&robot->gate, now.us, &told.sender_length);
        gate_hold(&robot->gate, now.us);
        gate_reject(&robot->gate, GATE_DISARMED);
        tell_rejection(robot, GATE_DISARMED, &told, now);
        return;
    }
    robot->command_us = (int64_t)now.us;
    robot->clamped += is_clamped(robot);
    gate_count_taken(&robot->gate, GATE_DRIVE);
}

/* ------------------------------------------------------------------------------- the robot --- */

static void learn_telemeters(robot *robot) {
    uint32_t count = roburoc4_client_telemeter_count(&robot->client);
    robot->telemeter_count = 0;
    while (robot->telemeter_count < count &&
           roburoc4_client_telemeter(&robot->client, robot->telemeter_count,
                                     &robot->telemeters[robot->telemeter_count]) >= 0) {
        robot->telemeter_count++;
    }
}

static void learn_name(robot *robot, const uint8_t *datagram, size_t size) {
    roburoc4_description text;
    if (roburoc4_client_description(&robot->client, datagram, size, &text) >= 0) {
        mapping_names_set(&robot->names, text.io_type, text.index, text.text, text.length);
    }
}

/* Events after which nothing may go on by itself. */
static bool ends_driving(const robot *robot, uint32_t events, gate_time now) {
    roburoc4_facts facts = {.size = sizeof facts};
    (void)roburoc4_client_facts(&robot->client, now.us, &facts);
    return (events & (ROBUROC4_EVENT_DISARMED | ROBUROC4_EVENT_LOST | ROBUROC4_EVENT_REBOOT |
                      ROBUROC4_EVENT_CLOCK)) != 0 ||
           ((events & ROBUROC4_EVENT_OVERRIDE) != 0 && facts.overridden);
}

static const uint32_t status_events = ROBUROC4_EVENT_IOCARD | ROBUROC4_EVENT_TELEMETER |
                                      ROBUROC4_EVENT_BATTERY | ROBUROC4_EVENT_LOCALIZATION |
                                      ROBUROC4_EVENT_DIFFERENTIAL;

/* All that is no status: seldom. */
static void handle_change(robot *robot, uint32_t events, gate_time now) {
    if (ends_driving(robot, events, now)) {
        gate_hold(&robot->gate, now.us);
    }
    if (events & ROBUROC4_EVENT_REBOOT) {
        mapping_names_init(&robot->names);
    }
    if (events & ROBUROC4_EVENT_PROPERTIES) {
        learn_telemeters(robot);
    }
    robot->properties_due =
        robot->properties_due ||
        (events & (ROBUROC4_EVENT_PROPERTIES | ROBUROC4_EVENT_DESCRIPTIONS_DONE)) != 0;
    robot->status_due = robot->status_due ||
                        (events & ~(status_events | (uint32_t)ROBUROC4_EVENT_DESCRIPTION)) != 0;
    explain_events(robot->name, robot->address, &robot->client, events, now.us);
}

static void handle_events(robot *robot, const uint8_t *datagram, size_t size, gate_time now) {
    uint32_t events = roburoc4_client_take_events(&robot->client);
    publish_statuses(robot, events, now);
    if (events & ROBUROC4_EVENT_DESCRIPTION && size > 0) {
        learn_name(robot, datagram, size);
    }
    if (events & ~status_events) {
        handle_change(robot, events, now);
    }
}

/* Each datagram is published before the next is read, so that no status is missed. What the client
 * has to send goes out in between. */
static bool receive(robot *robot) {
    for (uint32_t count = 0; count < ROBUROC4_UDP_BURST; count++) {
        const uint8_t *datagram = NULL;
        size_t size = 0;
        roburoc4_result result =
            roburoc4_udp_receive_one(&robot->udp, &robot->client, &datagram, &size);
        if (result < 0) {
            log_line(LOG_ERROR, robot->name, "its socket cannot be used any more (%s, error %d)",
                     roburoc4_result_text(result), (int)roburoc4_udp_system_error(&robot->udp));
            return false;
        }
        if (result == ROBUROC4_UDP_NOTHING) {
            return true;
        }
        if (result == ROBUROC4_UDP_USED) {
            gate_time now = clock_now();
            handle_events(robot, datagram, size, now);
            if (roburoc4_client_next_deadline(&robot->client) <= now.us) {
                (void)roburoc4_udp_transmit_all(&robot->udp, &robot->client);
            }
        }
    }
    return true;
}

/* A robot that is absent at the start counts as lost: who streams commands then must pause. */
static void look_for_absence(robot *robot, gate_time now) {
    if (!robot->told_absent && now.us - robot->started.us >= ABSENT_US &&
        roburoc4_udp_count(&robot->udp, ROBUROC4_UDP_COUNT_RECEIVED) == 0) {
        robot->told_absent = true;
        gate_hold(&robot->gate, now.us);
        explain_absence(robot->name, robot->address, roburoc4_udp_fault(&robot->udp));
    }
}

static void look_at_clock(robot *robot, gate_time now) {
    int64_t offset_us = now.utime - (int64_t)now.us;
    int64_t step_us = offset_us - robot->clock_offset_us;
    robot->clock_offset_us = offset_us;
    if (step_us > CLOCK_SET_US || step_us < -CLOCK_SET_US) {
        gate_clock_was_set(&robot->gate, now);
        log_line(LOG_NOTE, robot->name,
                 "this machine's clock was set by %.3f s: all senders must pause for %u ms",
                 (double)step_us / 1e6, GATE_PAUSE_US / 1000u);
    }
}

bool robot_serve(robot *robot) {
    bool good = receive(robot);
    gate_time now = clock_now();
    look_for_absence(robot, now);
    look_at_clock(robot, now);
    if (robot->gate.arms_alone) {
        gate_robot state = robot_for_gate(robot, now.us);
        gate_tick(&robot->gate, &state, now.us);
        if (gate_wants_arming(&robot->gate, &state, now.us)) {
            (void)arm(robot, now);
        }
    }
    return good;
}

/* Soon after a change, else in their period. */
static uint64_t status_deadline(const robot *robot) {
    return robot->status_us + (robot->status_due ? STATUS_SOONEST_US : STATUS_PERIOD_US);
}

static uint64_t properties_deadline(const robot *robot) {
    return robot->properties_us +
           (robot->properties_due ? STATUS_SOONEST_US : PROPERTIES_PERIOD_US);
}

void robot_finish(robot *robot) {
    gate_time now = clock_now();
    if (robot->has_drive) {
        apply_drive(robot, now);
    }
    (void)roburoc4_udp_transmit_all(&robot->udp, &robot->client);
    handle_events(robot, NULL, 0, now); /* what time alone changed */
    if (now.us >= status_deadline(robot)) {
        robot->status_us = now.us;
        robot->status_due = false;
        publish_bridge_status(robot, now);
    }
    if (now.us >= properties_deadline(robot)) {
        robot->properties_us = now.us;
        robot->properties_due = false;
        publish_properties(robot, now);
    }
}

uint64_t robot_deadline(const robot *robot) {
    uint64_t first = roburoc4_client_next_deadline(&robot->client);
    uint64_t others[] = {status_deadline(robot), properties_deadline(robot)};
    for (size_t at = 0; at < sizeof others / sizeof others[0]; at++) {
        first = others[at] < first ? others[at] : first;
    }
    return first;
}

/* ------------------------------------------------------------------------------------ life --- */

bool robot_subscribe(robot *robot, lcm_t *lcm, const options_robot *settings) {
    memset(robot, 0, sizeof *robot);
    robot->name = settings->name;
    robot->channels = &settings->channels;
    robot->lcm = lcm;
    robot->command_us = -1;
    mapping_names_init(&robot->names);
    for (uint32_t kind = 0; kind < GATE_KINDS; kind++) {
        robot_input *input = &robot->inputs[kind];
        input->robot = robot;
        input->kind = (enum gate_kind)kind;
        lcm_subscription_t *subscription =
            lcm_subscribe(lcm, robot->channels->name[CHANNEL_DRIVE_CMD + kind], on_message, input);
        if (subscription == NULL) {
            return false;
        }
        (void)lcm_subscription_set_queue_capacity(subscription, QUEUE_CAPACITY);
    }
    return true;
}

bool robot_start(robot *robot, const options *options, const options_robot *settings,
                 gate_time now) {
    (void)roburoc4_udp_address_text(&settings->address, robot->address, sizeof robot->address);
    if (roburoc4_udp_open(&robot->udp, sizeof robot->udp, &settings->address) < 0) {
        log_line(LOG_ERROR, robot->name, "no socket for %s: %s", robot->address,
                 strerror((int)roburoc4_udp_system_error(&robot->udp)));
        return false;
    }
    (void)roburoc4_client_init(&robot->client, sizeof robot->client, &options->config);
    (void)roburoc4_client_start(&robot->client, now.us);
    gate_init(&robot->gate, &options->rules, now);
    robot->config = &options->config;
    robot->started = now;
    robot->clock_offset_us = now.utime - (int64_t)now.us;
    return true;
}

void robot_close(robot *robot, gate_time now) {
    robot->has_drive = false;
    (void)roburoc4_client_close(&robot->client, now.us);
}

bool robot_is_closed(const robot *robot) {
    return roburoc4_client_state(&robot->client) == ROBUROC4_STATE_IDLE;
}

void robot_end(robot *robot) {
    publish_bridge_status(robot, clock_now());
    (void)roburoc4_udp_close(&robot->udp);
}
