/* SPDX-License-Identifier: MIT */
#include "publish.h"

#include <string.h>

#include "log.h"
#include "roburoc4_pump.h"

/* LCM counts as working again after it has accepted all messages for this long. */
#define MENDED_US 1000000u

static uint8_t buffer[MAPPING_MAX_ENCODED];
static bool failing;
static uint64_t failed_us; /* time of the last failure; 0 while LCM works */

/* Log once when sending starts to fail, and once when it works again. */
static void look_at_result(bool good, uint64_t now_us) {
    if (!good) {
        if (!failing) {
            log_line(LOG_ERROR, NULL,
                     "LCM cannot send: is there still a multicast route? still retrying");
        }
        failing = true;
        failed_us = now_us;
    } else if (failing && now_us - failed_us >= MENDED_US) {
        failing = false;
        log_line(LOG_NOTE, NULL, "LCM can send again");
    }
}

/* size: the result of an encoder. */
static void send_bytes(robot *robot, enum channel channel, int size, uint64_t now_us) {
    bool encoded = size > 0;
    bool sent = encoded && lcm_publish(robot->lcm, robot->channels->name[channel], buffer,
                                       (unsigned)size) == 0;
    robot->published += sent;
    robot->publish_errors += !sent;
    if (encoded) {
        look_at_result(sent, now_us);
    }
}

#define SEND(type, channel, message)                                                               \
    send_bytes(robot, channel, type##_encode(buffer, 0, (int)sizeof buffer, &(message)), now.us)

/* When the robot made a status, on this machine's wall clock. */
static int64_t wall_time(const roburoc4_sample *status, gate_time now) {
    return now.utime - (int64_t)(now.us - status->made_us);
}

static void publish_differential(robot *robot, const roburoc4_sample *status, gate_time now) {
    roburoc4_lcm_differential_status_t out;
    robot->speeds = status->value.differential;
    mapping_differential(&robot->speeds, wall_time(status, now), &out);
    SEND(roburoc4_lcm_differential_status_t, CHANNEL_DIFFERENTIAL, out);
}

static void publish_localization(robot *robot, const roburoc4_sample *status, gate_time now) {
    const roburoc4_localization_status *in = &status->value.localization;
    const int64_t utime = wall_time(status, now);
    roburoc4_lcm_localization_status_t out;
    mapping_localization(in, utime, &out);
    SEND(roburoc4_lcm_localization_status_t, CHANNEL_LOCALIZATION, out);
    if (robot->channels->name[CHANNEL_POSE][0] != '\0') {
        bot_core_pose_t pose;
        mapping_pose(in, &robot->speeds, utime, &pose);
        SEND(bot_core_pose_t, CHANNEL_POSE, pose);
    }
}

static void publish_battery(robot *robot, const roburoc4_sample *status, gate_time now) {
    roburoc4_lcm_battery_status_t out;
    mapping_battery(&status->value.battery, wall_time(status, now), &out);
    SEND(roburoc4_lcm_battery_status_t, CHANNEL_BATTERY, out);
}

static void publish_telemeter(robot *robot, const roburoc4_sample *status, gate_time now) {
    roburoc4_lcm_telemeter_t storage[ROBUROC4_MAX_TELEMETERS];
    roburoc4_lcm_telemeter_status_t out;
    mapping_telemeter(&status->value.distances, robot->telemeters, robot->telemeter_count,
                      wall_time(status, now), storage, &out);
    SEND(roburoc4_lcm_telemeter_status_t, CHANNEL_TELEMETER, out);
}

static void publish_iocard(robot *robot, const roburoc4_sample *status, gate_time now) {
    int8_t storage[ROBUROC4_MAX_DIGITAL_INPUTS];
    roburoc4_lcm_iocard_status_t out;
    mapping_iocard(&status->value.inputs, &robot->client, &robot->names, wall_time(status, now),
                   storage, &out);
    SEND(roburoc4_lcm_iocard_status_t, CHANNEL_IOCARD, out);
}

void publish_statuses(robot *robot, uint32_t events, gate_time now) {
    static const struct {
        uint32_t event, service;
        void (*publish)(struct robot *robot, const roburoc4_sample *status, gate_time now);
    } services[] = {
        /* the speeds come before the pose, which includes them */
        {ROBUROC4_EVENT_DIFFERENTIAL, ROBUROC4_SERVICE_DIFFERENTIAL, publish_differential},
        {ROBUROC4_EVENT_LOCALIZATION, ROBUROC4_SERVICE_LOCALIZATION, publish_localization},
        {ROBUROC4_EVENT_BATTERY, ROBUROC4_SERVICE_BATTERY, publish_battery},
        {ROBUROC4_EVENT_TELEMETER, ROBUROC4_SERVICE_TELEMETER, publish_telemeter},
        {ROBUROC4_EVENT_IOCARD, ROBUROC4_SERVICE_IOCARD, publish_iocard},
    };
    roburoc4_sample status;
    for (size_t at = 0; at < sizeof services / sizeof services[0]; at++) {
        if ((events & services[at].event) != 0 &&
            roburoc4_sample_latest(&robot->client, services[at].service, &status) >= 0) {
            services[at].publish(robot, &status, now);
        }
    }
}

void publish_properties(robot *robot, gate_time now) {
    mapping_services storage;
    roburoc4_lcm_robot_properties_t out;
    mapping_properties(&robot->client, &robot->settings->config, &robot->names, robot->address,
                       now.utime, &storage, &out);
    SEND(roburoc4_lcm_robot_properties_t, CHANNEL_PROPERTIES, out);
}

/* Where the library's text is for its callers, that for senders of messages. */
static const char *move_text(int32_t outcome) {
    switch (outcome) {
    case ROBUROC4_MOVE_CANCELLED:
        return "ended by a command, or the robot was disarmed: see BRIDGE_STATE";
    case ROBUROC4_MOVE_LAPSED:
        return "it was not sent again before its lease ended: find what blocked the sender, then "
               "begin again with another move_id";
    case ROBUROC4_MOVE_TOO_FAST:
        return "a speed beyond the ceilings: ask for less, or start the bridge with a higher "
               "--max-linear-m-s or --max-angular-rad-s";
    case ROBUROC4_MOVE_NO_FRONT_BUMPER:
        return "the front bumper is not known: set it in --robot-file, or send a negative "
               "clearance_m";
    case ROBUROC4_MOVE_NO_REAR_BUMPER:
        return "the rear bumper is not known: set it in --robot-file, or send a negative "
               "clearance_m";
    case ROBUROC4_MOVE_NO_FRONT_TELEMETER:
        return "no fresh distance ahead: check the front telemeter, or send a negative clearance_m";
    case ROBUROC4_MOVE_NO_REAR_TELEMETER:
        return "no fresh distance behind: check the rear telemeter, or send a negative clearance_m";
    default:
        return roburoc4_move_outcome_text(outcome);
    }
}

void publish_move_status(robot *robot, gate_time now) {
    const robot_move *moving = &robot->moving;
    roburoc4_lcm_move_status_t out = {
        .utime = now.utime,
        .sender = (char *)moving->sender, /* LCM's encoders only read */
        .move_id = moving->id,
        .outcome = moving->move.outcome,
        .cause = moving->move.cause,
        .message = (char *)move_text(moving->move.outcome),
        .distance_m = (double)moving->move.distance_m,
        .angle_rad = (double)moving->move.angle_rad,
        .remaining_m = (double)moving->move.remaining_m,
        .remaining_rad = (double)moving->move.remaining_rad,
    };
    SEND(roburoc4_lcm_move_status_t, CHANNEL_MOVE_STATUS, out);
}

/* Publish the state or the statistics: both come from the same facts. */
static void publish_bridge(robot *robot, bool statistics, gate_time now) {
    roburoc4_facts facts = {.size = sizeof facts};
    roburoc4_link link = {.size = sizeof link};
    (void)roburoc4_client_facts(&robot->client, now.us, &facts);
    (void)roburoc4_client_link(&robot->client, now.us, &link);
    const robot_rejection *rejection = &robot->rejections[robot->last_rejection];
    mapping_view view = {
        .now = now,
        .robot = robot->address,
        .bridge = robot->bridge->name,
        .started_utime = robot->bridge->started_utime,
        .facts = &facts,
        .link = &link,
        .gate = &robot->gate,
        .for_gate = {facts.state == ROBUROC4_STATE_READY, facts.armed != 0, facts.arm_refusal},
        .fault = robot->udp.fault,
        .heard = robot->heard,
        .no_socket = roburoc4_udp_fd(&robot->udp) < 0,
        .no_address = robot->to.family == 0,
        .other_bridge = robot->other_until_us != 0,
        .times_lost = roburoc4_client_count(&robot->client, ROBUROC4_COUNT_LOST),
        .reboots = roburoc4_client_count(&robot->client, ROBUROC4_COUNT_REBOOTS),
        .command_us = robot->command_us,
        .moves = robot->moves,
        .superseded = robot->superseded,
        .clamped = robot->clamped,
        .published = robot->published,
        .publish_errors = robot->publish_errors,
        .rejected = robot->last_rejection,
        .rejected_sender = rejection->sender,
        .rejected_why = rejection->why,
        .rejected_utime = rejection->utime,
    };
    if (statistics) {
        roburoc4_lcm_bridge_statistics_t out;
        mapping_bridge_statistics(&view, &out);
        SEND(roburoc4_lcm_bridge_statistics_t, CHANNEL_BRIDGE_STATISTICS, out);
    } else {
        mapping_texts storage;
        roburoc4_lcm_bridge_state_t out;
        mapping_bridge_state(&view, &storage, &out);
        SEND(roburoc4_lcm_bridge_state_t, CHANNEL_BRIDGE_STATE, out);
    }
}

void publish_bridge_state(robot *robot, gate_time now) {
    publish_bridge(robot, false, now);
}

void publish_bridge_statistics(robot *robot, gate_time now) {
    publish_bridge(robot, true, now);
}
