/* SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "robot.h"

#include <stdio.h>
#include <string.h>

#include "clock.h"
#include "gate_client.h"
#include "log.h"
#include "publish.h"
#include "reason.h"
#include "text.h"
#include "watch.h"

#define SOONEST_US 50000u /* after a change */
#define STATE_PERIOD_US 200000u
#define STATISTICS_PERIOD_US 1000000u
#define PROPERTIES_PERIOD_US 1000000u
#define MOVE_PERIOD_US 200000u
#define MOVE_OVER_US 1000000u /* for so long the end of a move is published */
#define ABSENT_US 1000000u
#define REOPEN_US 1000000u
#define YEAR_US (INT64_C(31536000) * 1000000)
/* Another bridge counts as gone after its state was not received for this long. Older states are
 * replays. */
#define OTHER_BRIDGE_US 2000000u

/* -------------------------------------------------------------------------------- commands --- */

/* Seconds, milliseconds or nanoseconds, or since something else. The gate has compared utime with
 * now, so it is positive, and the difference cannot overflow. */
static bool is_in_other_unit(const robot *robot, enum gate_verdict verdict, int64_t utime,
                             gate_time now) {
    return (verdict == GATE_TOO_OLD || verdict == GATE_IN_FUTURE) &&
           robot->gate.rules.max_age_us != 0 &&
           (now.utime - utime > YEAR_US || utime - now.utime > YEAR_US);
}

/* The cause and the remedy: what the robot says is more exact than the gate's verdict. */
static void write_reason(const robot *robot, enum gate_verdict verdict, const log_command *command,
                         gate_time now, char *room, size_t capacity) {
    const gate_rejection rejected = {verdict, command->kind, command->utime, "utime"};
    const int32_t refusal = gate_robot_of(&robot->client, now.us).arm_refusal;
    if (verdict == GATE_SENDER && command->sender != NULL &&
        !options_allows(robot->settings, command->sender, command->sender_length)) {
        (void)snprintf(room, capacity, "only senders %s are obeyed (--allow-sender)",
                       robot->settings->allowed);
    } else if (is_in_other_unit(robot, verdict, command->utime, now)) {
        (void)snprintf(room, capacity,
                       "its utime is not of this year: give microseconds since 1970");
    } else if (verdict == GATE_UNITS && command->is_move) {
        (void)snprintf(room, capacity,
                       "angles are in radians, beyond two turns only with allow_turns; speeds in "
                       "m/s and rad/s, at most 5 and 10");
    } else if (verdict == GATE_IMPOSSIBLE && command->is_move) {
        (void)snprintf(
            room, capacity,
            "there is no such move: its kind is BY, TO_POINT or TO_POSE, it is at most 10 "
            "km long and turns by at most 10000 rad, with speeds and accelerations above 0");
    } else if (verdict == GATE_DISARMED && refusal < 0) {
        (void)snprintf(room, capacity, "the robot cannot be armed: %s",
                       roburoc4_result_text(refusal));
    } else {
        gate_reason(room, capacity, &rejected, &robot->gate.rules, now);
    }
}

/* Store a rejection that was counted, and log it. */
static void log_rejected(robot *robot, enum gate_verdict verdict, const log_command *command,
                         gate_time now) {
    robot_rejection *rejection = &robot->rejections[verdict];
    text_copy(rejection->sender, sizeof rejection->sender, (const uint8_t *)command->sender,
              command->sender_length);
    bool first = gate_is_incident(&robot->gate, verdict, rejection->sender,
                                  strlen(rejection->sender), now.us);
    write_reason(robot, verdict, command, now, rejection->why, sizeof rejection->why);
    log_rejection(robot->name, command, rejection->why, first);
    rejection->utime = command->utime;
    robot->last_rejection = verdict;
    if (first) {
        robot->statistics.due = robot->state.due = true;
    }
}

/* readable: the message could be decoded. */
static log_command for_log(const robot *robot, const command *command, bool readable) {
    const int channel =
        command->is_move ? CHANNEL_MOVE_CMD : (int)CHANNEL_DRIVE_CMD + (int)command->kind;
    log_command for_log = {.kind = command->kind,
                           .is_move = command->is_move,
                           .channel = robot->channels->name[channel]};
    if (readable) {
        for_log.sender = command->sender;
        for_log.sender_length = command->sender_length;
        for_log.utime = command->utime;
    }
    return for_log;
}

static void log_rejected_message(robot *robot, enum gate_verdict verdict, const command *command,
                                 gate_time now) {
    log_command rejected = for_log(robot, command, verdict != GATE_MALFORMED);
    log_rejected(robot, verdict, &rejected, now);
}

/* Set all of the outputs, or none. */
static roburoc4_result set_outputs(robot *robot, const command *command, uint64_t now_us) {
    roburoc4_iocard_properties card;
    roburoc4_result result = roburoc4_client_iocard_properties(&robot->client, &card);
    if (result < 0) {
        return result;
    }
    for (uint32_t at = 0; at < command->analog_count; at++) {
        int32_t index = command->analog[at].index;
        if (index < 0 || index >= card.analog_outputs) {
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

static void set_if_positive(float *setting, double value) {
    if (value > 0) {
        *setting = command_speed(value);
    }
}

/* Begin a move in *move. */
static roburoc4_result begin_move(roburoc4_move *move, const command *command) {
    roburoc4_move_options how;
    (void)roburoc4_move_options_init(&how, sizeof how);
    set_if_positive(&how.max_linear_m_s, command->linear_m_s);
    set_if_positive(&how.max_angular_rad_s, command->angular_rad_s);
    set_if_positive(&how.max_linear_m_s2, command->max_linear_m_s2);
    set_if_positive(&how.max_angular_rad_s2, command->max_angular_rad_s2);
    set_if_positive(&how.clearance_m, command->clearance_m);
    how.clearance_m = command->clearance_m < 0 ? 0 : how.clearance_m;
    how.timeout_ms = command->timeout_ms > 0 ? (uint32_t)command->timeout_ms : 0;
    how.allow_turns = command->allow_turns;
    switch (command->move_kind) {
    case ROBUROC4_LCM_MOVE_COMMAND_T_KIND_BY:
        return roburoc4_move_by(move, command_speed(command->distance_m),
                                command_speed(command->angle_rad), &how);
    case ROBUROC4_LCM_MOVE_COMMAND_T_KIND_TO_POINT:
        return roburoc4_move_to_point(move, command->x_m, command->y_m, &how);
    case ROBUROC4_LCM_MOVE_COMMAND_T_KIND_TO_POSE:
        return roburoc4_move_to_pose(move, command->x_m, command->y_m, command->theta_rad, &how);
    default:
        return ROBUROC4_ERR_ARGUMENT;
    }
}

static void end_move(robot *robot, gate_time now) {
    robot->moving.active = false;
    robot->moving.ended_us = now.us;
    robot->move_status.due = true;
}

/* Something else drives or stops the robot from now on. */
static void cancel_move(robot *robot, gate_time now) {
    if (robot->moving.active) {
        robot->moving.move.outcome = ROBUROC4_MOVE_CANCELLED;
        end_move(robot, now);
    }
}

/* Begin a move, or renew its lease. One that has ended does not begin again. */
static void take_move(robot *robot, const command *command, uint32_t lease_us, gate_time now) {
    robot_move *moving = &robot->moving;
    robot_move wanted = {.known = true, .active = true, .id = command->move_id};
    enum gate_verdict verdict = GATE_TAKEN;
    text_copy(wanted.sender, sizeof wanted.sender, (const uint8_t *)command->sender,
              command->sender_length);
    if (!moving->known || moving->id != wanted.id || strcmp(moving->sender, wanted.sender) != 0) {
        const roburoc4_result begun = begin_move(&wanted.move, command);
        if (begun < 0) {
            verdict = begun == ROBUROC4_ERR_UNITS ? GATE_UNITS : GATE_IMPOSSIBLE;
            gate_reject(&robot->gate, verdict);
        } else {
            verdict = gate_arm(&robot->gate, &robot->client, now.us);
        }
        if (verdict != GATE_TAKEN) {
            log_rejected_message(robot, verdict, command, now);
            return;
        }
        *moving = wanted;
        robot->move_status.due = true;
    } else if (!moving->active || robot->has_drive) {
        return; /* it has ended, or the speed that was read before ends it; it counts nowhere */
    }
    robot->superseded += robot->has_drive;
    robot->has_drive = false;
    robot->command_us = (int64_t)now.us;
    robot->moves++;
    moving->until_us = now.us + lease_us;
}

/* Drive as the move proposes. The client's lease ends with the move's: then the client stops the
 * robot, and disarms it as after any command that was not renewed. */
static void step_move(robot *robot, gate_time now) {
    robot_move *moving = &robot->moving;
    if (now.us >= moving->until_us) {
        moving->move.outcome = ROBUROC4_MOVE_LAPSED;
    } else if (roburoc4_move_step(&moving->move, &robot->client, now.us) == ROBUROC4_MOVE_RUNNING) {
        const uint64_t left_us = moving->until_us - now.us;
        roburoc4_result ignored = roburoc4_client_drive(
            &robot->client, moving->move.linear_m_s, moving->move.angular_rad_s,
            left_us > ROBUROC4_MIN_LEASE_US ? (uint32_t)left_us : ROBUROC4_MIN_LEASE_US, now.us);
        (void)ignored;
    }
    if (moving->move.outcome != ROBUROC4_MOVE_RUNNING) {
        end_move(robot, now);
    }
}

/* Every relocalize and output command is carried out; of the drive commands in one iteration of the
 * loop, only the newest. */
static void take(robot *robot, const command *command, uint32_t lease_us, gate_time now) {
    roburoc4_result result = 0;
    if (command->is_move) {
        take_move(robot, command, lease_us, now);
        return;
    }
    if (command->kind == GATE_DRIVE) {
        robot->superseded += robot->has_drive;
        robot->has_drive = true;
        robot->drive.linear_m_s = command_speed(command->linear_m_s);
        robot->drive.angular_rad_s = command_speed(command->angular_rad_s);
        robot->drive.lease_us = lease_us;
        robot->drive.utime = command->utime;
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
        log_rejected_message(robot, GATE_IMPOSSIBLE, command, now);
        return;
    }
    robot->command_us = (int64_t)now.us;
    gate_count_taken(&robot->gate, command->kind);
}

/* Any message on the stop channel stops the robot, even one of another type. */
static void stop(robot *robot, const command *command, bool readable, gate_time now) {
    log_command stopping = for_log(robot, command, readable);
    log_stop(robot->name, &stopping, !robot->gate.stopped);
    robot->has_drive = false;
    cancel_move(robot, now);
    robot->state.due = robot->state.due || !robot->gate.stopped;
    gate_stop_client(&robot->gate, &robot->client, stopping.sender, stopping.sender_length, now.us);
}

void robot_take_message(robot *robot, enum channel channel, const void *data, size_t size,
                        int64_t arrived_utime) {
    const bool is_move = channel == CHANNEL_MOVE_CMD;
    const enum gate_kind kind =
        is_move ? GATE_DRIVE : (enum gate_kind)(channel - CHANNEL_DRIVE_CMD);
    gate_time now = clock_now();
    uint32_t lease_us = 0;
    command command;
    bool readable = is_move ? command_decode_move(data, size, &command)
                            : command_decode(kind, data, size, &command);
    if (kind == GATE_STOP) {
        stop(robot, &command, readable, now);
        return;
    }
    enum gate_verdict early =
        !readable                                                                 ? GATE_MALFORMED
        : !options_allows(robot->settings, command.sender, command.sender_length) ? GATE_SENDER
                                                                                  : GATE_TAKEN;
    if (early != GATE_TAKEN) {
        gate_reject(&robot->gate, early);
        log_rejected_message(robot, early, &command, now);
        return;
    }
    gate_command for_gate = command_for_gate(&command, arrived_utime);
    gate_robot state = gate_robot_of(&robot->client, now.us);
    enum gate_verdict verdict = gate_judge(&robot->gate, &for_gate, &state, now, &lease_us);
    if (verdict == GATE_TAKEN) {
        take(robot, &command, lease_us, now);
    } else {
        log_rejected_message(robot, verdict, &command, now);
    }
}

/* ---------------------------------------------------------------------------------- motion --- */

/* Whether the speed was reduced: to the robot's limits, or to the configured ceiling. */
static bool is_beyond(float asked, float scale, float min, float max, float ceiling) {
    const float sent = asked * scale, most = scale < 1 ? ceiling * scale : ceiling;
    return sent > max || sent < min || sent > most || sent < -most;
}

static bool is_clamped(const robot *robot) {
    const roburoc4_config *config = &robot->settings->config;
    roburoc4_differential_properties limits;
    return roburoc4_client_differential_properties(&robot->client, &limits) >= 0 &&
           (is_beyond(robot->drive.linear_m_s, config->scale_linear, limits.min_linear_m_s,
                      limits.max_linear_m_s, config->max_linear_m_s) ||
            is_beyond(robot->drive.angular_rad_s, config->scale_angular, limits.min_angular_rad_s,
                      limits.max_angular_rad_s, config->max_angular_rad_s));
}

static void apply_drive(robot *robot, gate_time now) {
    robot->has_drive = false;
    cancel_move(robot, now);
    const robot_drive *drive = &robot->drive;
    enum gate_verdict verdict = gate_drive(&robot->gate, &robot->client, drive->linear_m_s,
                                           drive->angular_rad_s, drive->lease_us, now.us);
    if (verdict != GATE_TAKEN) {
        log_command rejected = {.kind = GATE_DRIVE,
                                .channel = robot->channels->name[CHANNEL_DRIVE_CMD],
                                .utime = drive->utime};
        rejected.sender = gate_control_owner(&robot->gate, now.us, &rejected.sender_length);
        log_rejected(robot, verdict, &rejected, now);
        return;
    }
    robot->command_us = (int64_t)now.us;
    robot->clamped += is_clamped(robot);
}

/* ------------------------------------------------------------------------------- the robot --- */

static void learn_telemeters(robot *robot) {
    robot->telemeter_count = 0;
    while (robot->telemeter_count < ROBUROC4_MAX_TELEMETERS &&
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

static const uint32_t status_events = ROBUROC4_EVENT_IOCARD | ROBUROC4_EVENT_TELEMETER |
                                      ROBUROC4_EVENT_BATTERY | ROBUROC4_EVENT_LOCALIZATION |
                                      ROBUROC4_EVENT_DIFFERENTIAL;

/* The events that are not statuses. They are rare, so each has everything published again. */
static void handle_change(robot *robot, uint32_t events, gate_time now) {
    gate_heed_events(&robot->gate, &robot->client, events, now.us);
    if (events & ROBUROC4_EVENT_REBOOT) {
        memset(&robot->names, 0, sizeof robot->names);
    }
    if (events & ~(status_events | (uint32_t)ROBUROC4_EVENT_DESCRIPTION)) {
        learn_telemeters(robot);
        robot->properties.due = true;
        robot->state.due = true;
    }
    log_events(robot->name, robot->address, &robot->client, events, now.us);
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

/* ------------------------------------------------------------------------------- the socket --- */

static void open_socket(robot *robot, uint64_t now_us) {
    robot->open_us = robot->to.family != 0 ? now_us + REOPEN_US : UINT64_MAX;
    if (robot->to.family == 0) {
        log_line(LOG_ERROR, robot->name,
                 "the name %s has no address: this robot is left out; give a numeric address or "
                 "correct the name, then restart the bridge",
                 robot->address);
    } else if (roburoc4_udp_open(&robot->udp, sizeof robot->udp, &robot->to) >= 0) {
        watch_set(robot->number, (int)roburoc4_udp_fd(&robot->udp));
        (void)roburoc4_udp_record(&robot->udp, robot->recorder);
    } else if (!robot->logged_no_socket) {
        robot->logged_no_socket = true;
        log_line(LOG_ERROR, robot->name, "no socket for %s: %s; retrying every second",
                 robot->address, strerror(robot->udp.system_error));
    }
}

/* Replace an unusable socket. This is not called for errors of the network. Other robots are not
 * affected. */
static void lose_socket(robot *robot, roburoc4_result why, gate_time now) {
    if (!robot->logged_no_socket) {
        log_line(LOG_ERROR, robot->name,
                 "its socket broke (%s, error %d): stopped; trying a new one every second",
                 roburoc4_result_text(why), robot->udp.system_error);
    }
    robot->logged_no_socket = true;
    robot->has_drive = false;
    robot->state.due = true;
    robot->open_us = now.us + REOPEN_US;
    const roburoc4_result stopped = roburoc4_client_stop(&robot->client, now.us);
    (void)stopped; /* nothing moves if it is idle or closing */
    gate_hold(&robot->gate, now.us);
    (void)roburoc4_udp_transmit_all(&robot->udp, &robot->client); /* it may still be able to send */
    watch_set(robot->number, -1);
    (void)roburoc4_udp_close(&robot->udp);
}

/* Publishes a datagram before the next is read, so that no status is skipped; the client may send
 * in between. */
static void seen(void *context, const uint8_t *datagram, size_t size) {
    robot *robot = context;
    robot->heard = true;
    if (robot->logged_no_socket) {
        robot->logged_no_socket = false;
        log_line(LOG_NOTE, robot->name, "its socket works again");
    }
    handle_events(robot, datagram, size, clock_now());
    (void)roburoc4_udp_transmit_all(&robot->udp, &robot->client);
}

static void receive(robot *robot) {
    const roburoc4_result result = roburoc4_udp_receive(&robot->udp, &robot->client, seen, robot);
    if (result < 0) {
        lose_socket(robot, result, clock_now());
    }
}

/* Without a socket the client keeps running, so that it notices the silence; what it sends is
 * dropped. */
static void transmit(robot *robot, gate_time now) {
    uint8_t dropped[ROBUROC4_MAX_TRANSMIT];
    if (roburoc4_udp_transmit_all(&robot->udp, &robot->client) == ROBUROC4_ERR_CLOSED) {
        for (uint32_t count = 0; count < ROBUROC4_UDP_BURST; count++) {
            if (roburoc4_client_poll_transmit(&robot->client, dropped, sizeof dropped, now.us) <=
                0) {
                return;
            }
        }
    }
}

/* ---------------------------------------------------------------------------- other bridges --- */

/* Whether two names "HOST PROCESS" have the same host. */
static bool same_host(const char *one, const char *other) {
    size_t length = strcspn(one, " ");
    return strncmp(one, other, length) == 0 && other[length] == ' ';
}

static bool same_robot(const robot *robot, const bridge_identity *other) {
    bool local =
        strncmp(robot->address, "127.", 4) == 0 || strncmp(robot->address, "[::1]", 5) == 0;
    return strcmp(robot->address, other->robot) == 0 &&
           (!local || same_host(robot->bridge->name, other->bridge));
}

/* A replayed log must not look like another bridge. */
static bool is_recent(const gate_rules *rules, int64_t utime, gate_time now) {
    int64_t allowed_us = (int64_t)OTHER_BRIDGE_US + rules->max_age_us;
    return rules->max_age_us == 0 ||
           (utime > now.utime - allowed_us && utime < now.utime + allowed_us);
}

void robot_hear_bridge(robot *robot, const bridge_identity *other, const char *channel,
                       gate_time now) {
    bool shares_robot = same_robot(robot, other);
    if ((!shares_robot && strcmp(channel, robot->channels->name[CHANNEL_BRIDGE_STATE]) != 0) ||
        !is_recent(&robot->gate.rules, other->utime, now)) {
        return;
    }
    if (robot->other_until_us == 0) {
        char name[100];
        text_for_terminal(name, sizeof name, other->bridge, strlen(other->bridge));
        log_line(LOG_ERROR, robot->name, "another bridge (%s) also %s: end one of them", name,
                 shares_robot ? "serves this robot" : "publishes on these channels");
        robot->state.due = true;
    }
    robot->other_until_us = now.us + OTHER_BRIDGE_US;
}

static void look_for_other_bridge(robot *robot, gate_time now) {
    if (robot->other_until_us != 0 && now.us >= robot->other_until_us) {
        robot->other_until_us = 0;
        robot->state.due = true;
        log_line(LOG_NOTE, robot->name, "the other bridge is gone");
    }
}

/* ------------------------------------------------------------------------------------ turns --- */

static void look_for_absence(robot *robot, gate_time now) {
    if (!robot->logged_absent && !robot->heard && robot->to.family != 0 &&
        now.us - robot->started.us >= ABSENT_US) {
        robot->logged_absent = true;
        log_absence(robot->name, robot->address, robot->udp.fault);
    }
}

static void look_at_clock(robot *robot, gate_time now) {
    int64_t step_us = gate_look_at_clock(&robot->gate, now);
    if (step_us != 0) {
        log_line(LOG_NOTE, robot->name,
                 "this machine's clock was set by %.3f s: all senders must pause for %u ms",
                 (double)step_us / 1e6, GATE_PAUSE_US / 1000u);
    }
}

void robot_serve(robot *robot) {
    gate_time now = clock_now();
    if (roburoc4_udp_fd(&robot->udp) >= 0) {
        receive(robot);
    } else if (now.us >= robot->open_us) {
        open_socket(robot, now.us);
    }
    now = clock_now();
    look_for_absence(robot, now);
    look_for_other_bridge(robot, now);
    look_at_clock(robot, now);
}

static uint64_t deadline_of(const robot_publication *publication, uint32_t period_us) {
    return publication->last_us + (publication->due ? SOONEST_US : period_us);
}

/* Whether to publish now; if so, the publication is marked as done. */
static bool take_due(robot_publication *publication, uint32_t period_us, gate_time now) {
    bool due = now.us >= deadline_of(publication, period_us);
    if (due) {
        publication->last_us = now.us;
        publication->due = false;
    }
    return due;
}

static bool is_move_news(const robot *robot, gate_time now) {
    const robot_move *moving = &robot->moving;
    return moving->known && (moving->active || now.us - moving->ended_us < MOVE_OVER_US);
}

void robot_finish(robot *robot) {
    gate_time now = clock_now();
    if (robot->has_drive) {
        apply_drive(robot, now);
    }
    if (robot->moving.active) {
        step_move(robot, now);
    }
    transmit(robot, now);
    handle_events(robot, NULL, 0, now); /* events that the passing of time caused */
    if (take_due(&robot->state, STATE_PERIOD_US, now)) {
        publish_bridge_state(robot, now);
    }
    if (is_move_news(robot, now) && take_due(&robot->move_status, MOVE_PERIOD_US, now)) {
        publish_move_status(robot, now);
    }
    if (take_due(&robot->statistics, STATISTICS_PERIOD_US, now)) {
        publish_bridge_statistics(robot, now);
    }
    if (take_due(&robot->properties, PROPERTIES_PERIOD_US, now)) {
        publish_properties(robot, now);
    }
}

uint64_t robot_deadline(const robot *robot) {
    uint64_t first = roburoc4_client_next_deadline(&robot->client);
    uint64_t others[] = {deadline_of(&robot->state, STATE_PERIOD_US),
                         deadline_of(&robot->statistics, STATISTICS_PERIOD_US),
                         deadline_of(&robot->properties, PROPERTIES_PERIOD_US),
                         roburoc4_udp_fd(&robot->udp) < 0 ? robot->open_us : UINT64_MAX,
                         robot->moving.active ? robot->moving.until_us : UINT64_MAX,
                         robot->move_status.due ? deadline_of(&robot->move_status, MOVE_PERIOD_US)
                                                : UINT64_MAX};
    for (size_t at = 0; at < sizeof others / sizeof others[0]; at++) {
        first = others[at] < first ? others[at] : first;
    }
    return first;
}

/* ----------------------------------------------------------------------------- start and end ---
 */

/* A configuration rejects periods that are too long for driving, but the bridge may only watch. So
 * it subscribes to each service itself. */
static void start_client(robot *robot, const roburoc4_config *wanted, uint64_t now_us) {
    roburoc4_config config = *wanted;
    config.subscriptions = 0;
    (void)roburoc4_client_init(&robot->client, sizeof robot->client, &config);
    (void)roburoc4_client_start(&robot->client, now_us);
    for (uint32_t service = 0; service < ROBUROC4_SERVICE_COUNT; service++) {
        if ((wanted->subscriptions >> service & 1u) != 0) {
            (void)roburoc4_client_subscribe(&robot->client, service, wanted->period_ms[service],
                                            now_us);
        }
    }
}

/* Robots that start together publish at different times, so that LCM's buffers do not overflow. */
static void spread(robot_publication *publication, uint32_t period_us, const robot *robot,
                   uint64_t now_us) {
    uint64_t turn_us = (uint64_t)period_us * robot->number / OPTIONS_MAX_ROBOTS;
    publication->last_us = now_us + turn_us - period_us;
}

void robot_start(robot *robot, uint32_t number, const options_robot *settings, lcm_t *lcm,
                 const robot_bridge *bridge, roburoc4_recorder *recorder, gate_time now) {
    memset(robot, 0, sizeof *robot);
    robot->name = settings->name;
    robot->number = number;
    robot->channels = &settings->channels;
    robot->lcm = lcm;
    robot->recorder = recorder;
    robot->command_us = -1;
    text_copy(robot->address, sizeof robot->address, (const uint8_t *)settings->host,
              strlen(settings->host));
    robot->to = settings->address;
    if (robot->to.family != 0) {
        (void)roburoc4_udp_address_text(&robot->to, robot->address, sizeof robot->address);
    }
    robot->settings = settings;
    robot->bridge = bridge;
    robot->started = now;
    spread(&robot->state, STATE_PERIOD_US, robot, now.us);
    spread(&robot->statistics, STATISTICS_PERIOD_US, robot, now.us);
    spread(&robot->properties, PROPERTIES_PERIOD_US, robot, now.us);
    start_client(robot, &settings->config, now.us);
    /* Else its first event would have all states published at once. */
    (void)roburoc4_client_take_events(&robot->client);
    gate_init(&robot->gate, &settings->rules, now);
    open_socket(robot, now.us);
}

void robot_close(robot *robot, gate_time now) {
    robot->has_drive = false;
    cancel_move(robot, now);
    (void)roburoc4_client_close(&robot->client, now.us);
}

bool robot_is_closed(const robot *robot) {
    return roburoc4_client_state(&robot->client) == ROBUROC4_STATE_IDLE;
}

void robot_end(robot *robot) {
    gate_time now = clock_now();
    publish_bridge_statistics(robot, now);
    publish_bridge_state(robot, now);
    if (robot->move_status.due) {
        publish_move_status(robot, now);
    }
    watch_set(robot->number, -1);
    (void)roburoc4_udp_close(&robot->udp);
}
