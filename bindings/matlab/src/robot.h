/* SPDX-License-Identifier: MIT
 *
 * robot.h - one robot, in real time on a pump (whose thread calls nothing of MATLAB) or in the
 * virtual time of a simulator: the same calls for both.
 *
 * Functions without a comment do what their namesakes of roburoc4.h do.
 */
#ifndef ROBUROC4_MEX_ROBOT_H
#define ROBUROC4_MEX_ROBOT_H

#include "samples.h"
#include "settings.h"
#include "world.h"

typedef struct robot {
    roburoc4_pump *pump;  /* in real time, or NULL */
    world_client *client; /* in virtual time, or NULL */
    uint64_t opened_us;
    uint64_t furthest_us; /* when it came to the state below */
    uint32_t furthest;    /* the last state on the way to ready that it came to */
    uint32_t lease_us;
    uint32_t fresh_us; /* age to which a status counts */
    int busy;          /* a method that waits is running: when it ends early, the robot stops */
    roburoc4_pump_reader log;     /* of log(): what was written ends here */
    roburoc4_pump_reader log_end; /* where it will end, once the file is there */
    roburoc4_pump_reader reader;  /* of record() */
    sample_list recording;
    uint64_t recording_us;
    uint32_t recording_mask; /* of services */
} robot;

/** Open a link in real time. NULL after noting why (fail.h); an absent robot is no error. */
robot *robot_open(const char *address, const robot_settings *settings);
/** Join a world. NULL after noting why. */
robot *robot_join(world *home, const robot_settings *settings);
/** End the link. Waits for a zero train that is on its way, in real time only: see
 *  robot_is_stopping(). */
void robot_close(robot *one);

/** 0 when commands get ROBUROC4_ERR_CLOSED. */
int robot_is_open(robot *one);
/** The clock that the robot's times go by. */
uint64_t robot_now_us(const robot *one);
/** Its client, for any roburoc4_client_*() call at robot_now_us(), until robot_unlock(): then what
 * it has to send is sent. Nothing between the two may wait, or raise an error of MATLAB. */
roburoc4_client *robot_lock(robot *one);
void robot_unlock(robot *one);
/** Let so much of the robot's time pass. */
void robot_wait(robot *one, uint32_t duration_us);
/** Whether zeros are on their way. */
int robot_is_stopping(robot *one);
/** Whether this object drives, or zeros of its drive are on their way. */
int robot_is_driving(robot *one);

roburoc4_result robot_arm(robot *one);
roburoc4_result robot_disarm(robot *one);
roburoc4_result robot_drive(robot *one, float linear_m_s, float angular_rad_s);
roburoc4_result robot_stop(robot *one);
roburoc4_result robot_set_digital_output(robot *one, uint32_t index, int32_t on);
roburoc4_result robot_set_analog_output(robot *one, uint32_t index, float value);
roburoc4_result robot_relocalize(robot *one, double x_m, double y_m, double theta_rad);
/** period_ms 0 ends a subscription. */
roburoc4_result robot_subscribe(robot *one, uint32_t service, uint32_t period_ms);

uint32_t robot_state(robot *one);
uint32_t robot_count(robot *one, uint32_t counter);
/** ROBUROC4_FAULT_*; in virtual time there is none. */
uint32_t robot_fault(robot *one);
/** Where the robot is, or "the simulator". */
void robot_address_text(robot *one, char *text, size_t capacity);
roburoc4_result robot_facts(robot *one, roburoc4_facts *out);
roburoc4_result robot_link(robot *one, roburoc4_link *out);
roburoc4_result robot_service_link(robot *one, uint32_t service, roburoc4_service_link *out);

uint32_t robot_service_count(robot *one);
roburoc4_result robot_service_at(robot *one, uint32_t index, roburoc4_directory_entry *out);
roburoc4_result robot_iocard_properties(robot *one, roburoc4_iocard_properties *out);
roburoc4_result robot_battery_properties(robot *one, roburoc4_battery_properties *out);
roburoc4_result robot_localization_properties(robot *one, roburoc4_localization_properties *out);
roburoc4_result robot_differential_properties(robot *one, roburoc4_differential_properties *out);
uint32_t robot_telemeter_count(robot *one);
roburoc4_result robot_telemeter(robot *one, uint32_t index, roburoc4_telemeter *out);
roburoc4_result robot_role_index(robot *one, uint32_t role);
/** In virtual time the robot's texts are not kept: ROBUROC4_ERR_UNKNOWN. */
roburoc4_result robot_description(robot *one, int32_t io_type, uint32_t index, char *buffer,
                                  size_t capacity);

/* host_us may be NULL. */
roburoc4_result robot_battery(robot *one, roburoc4_battery_status *out, uint64_t *host_us);
roburoc4_result robot_localization(robot *one, roburoc4_localization_status *out,
                                   uint64_t *host_us);
roburoc4_result robot_differential(robot *one, roburoc4_differential_status *out,
                                   uint64_t *host_us);
roburoc4_result robot_inputs(robot *one, roburoc4_inputs *out, uint64_t *host_us);
roburoc4_result robot_distances(robot *one, roburoc4_distances *out, uint64_t *host_us);

/** Let a reader begin with the next status. */
void robot_begin_reading(robot *one, roburoc4_pump_reader *reader);
/** Append what a reader has not read to a list. 0 after noting that there is no room. */
int robot_drain(robot *one, roburoc4_pump_reader *reader, sample_list *list);

#endif
