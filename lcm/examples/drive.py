# SPDX-License-Identifier: MIT
"""Drive a gentle curve for three seconds through the bridge, or print why it rejects that.

The sender's name is different for each run: two programs with the same name would both drive.
"""

import sys
import time

import lcm
from roburoc4_lcm import bridge_state_t, drive_command_t

network, command, states = lcm.LCM(), drive_command_t(), []
command.sender, command.linear_m_s, command.angular_rad_s = f"drive.py {time.time_ns()}", 0.3, 0.2
network.subscribe(
    "ROBUROC4_BRIDGE_STATE", lambda _, data: states.append(bridge_state_t.decode(data))
)


def listen(seconds: float) -> None:
    end = time.monotonic() + seconds
    while (left_s := end - time.monotonic()) > 0:
        network.handle_timeout(int(left_s * 1000) + 1)


listen(1)  # a bridge that has just started drives only after a pause
if not states:
    sys.exit("drive.py: no bridge on this LCM network: start roburoc4-lcm with --enable-drive")
for attempt in range(60):
    command.utime = time.time_ns() // 1000  # old commands are rejected
    network.publish("ROBUROC4_DRIVE_CMD", command.encode())
    listen(0.05)  # each command's lease is 250 ms; after the last one the robot stops
    if states[-1].rejected_sender == command.sender:
        sys.exit(f"drive.py: the bridge rejects the command: {states[-1].rejected_message}")
    if attempt == 18 and all(state.control_owner != command.sender for state in states):
        sys.exit("drive.py: the bridge hears no command: does LCM_DEFAULT_URL have its ttl here?")
