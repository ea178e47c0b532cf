/* SPDX-License-Identifier: MIT
 *
 * Publishes messages on LCM, through one static buffer.
 */
#ifndef ROBUROC4_LCM_PUBLISH_H
#define ROBUROC4_LCM_PUBLISH_H

#include "robot.h"

/* Publish the latest status of each service that these ROBUROC4_EVENT_* bits name. */
void publish_statuses(robot *robot, uint32_t events, gate_time now);
void publish_properties(robot *robot, gate_time now);
void publish_move_status(robot *robot, gate_time now);
void publish_bridge_state(robot *robot, gate_time now);
void publish_bridge_statistics(robot *robot, gate_time now);

#endif
