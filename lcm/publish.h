/* SPDX-License-Identifier: MIT
 *
 * From messages to LCM's network, through one buffer that is there from the start.
 */
#ifndef ROBUROC4_LCM_PUBLISH_H
#define ROBUROC4_LCM_PUBLISH_H

#include "robot.h"

/* Everything that came with these ROBUROC4_EVENT_* bits: the latest status of each service. */
void publish_statuses(robot *robot, uint32_t events, gate_time now);
void publish_properties(robot *robot, gate_time now);
void publish_bridge_state(robot *robot, gate_time now);
void publish_bridge_statistics(robot *robot, gate_time now);

#endif
