/* SPDX-License-Identifier: MIT
 *
 * The gate in front of a client: what a bridge does with a robot, by one rule for all bridges.
 */
#ifndef ROBUROC4_GATE_CLIENT_H
#define ROBUROC4_GATE_CLIENT_H

#include "gate.h"
#include "roburoc4.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the gate needs to know of the robot now. */
gate_robot gate_robot_of(const roburoc4_client *client, uint64_t now_us);

/* Reject commands until a pause if these events of the client (ROBUROC4_EVENT_*) ended driving. */
void gate_heed_events(gate *gate, const roburoc4_client *client, uint32_t events, uint64_t now_us);

/* Obey a drive command that gate_judge() let through: arm where that is needed, and drive. Zeros
 * arm nothing: a robot that is not armed is at rest, or is being stopped. Counted as taken, or as
 * rejected: with GATE_UNITS if no RobuROC4 is as fast, else with GATE_DISARMED, and then further
 * commands are rejected until a pause, too. */
enum gate_verdict gate_drive(gate *gate, roburoc4_client *client, float linear_m_s,
                             float angular_rad_s, uint32_t lease_us, uint64_t now_us);

/* Arm for a command that drives in another way, such as a move. Counted only where it is rejected.
 */
enum gate_verdict gate_arm(gate *gate, roburoc4_client *client, uint64_t now_us);

/* Obey a stop command of this sender (length bytes, which may be 0): stop and disarm. Drive
 * commands are rejected until a pause; the first speed after it arms again. */
void gate_stop_client(gate *gate, roburoc4_client *client, const char *sender, size_t length,
                      uint64_t now_us);

#ifdef __cplusplus
}
#endif

#endif
