# SPDX-License-Identifier: MIT
"""Drive a gentle curve for three seconds, through the bridge.

The sender's name is different for each run: two programs with one name would both drive.
"""

import time

import lcm
from roburoc4_lcm import drive_command_t

network, command = lcm.LCM(), drive_command_t()
command.sender, command.linear_m_s, command.angular_rad_s = f"drive.py {time.time_ns()}", 0.3, 0.2
time.sleep(1)  # a bridge that has just started drives only after a pause
for _ in range(60):
    command.utime = time.time_ns() // 1000  # the bridge refuses what is old
    network.publish("ROBUROC4_DRIVE_CMD", command.encode())
    time.sleep(0.05)  # each command's lease is 300 ms; after the last one the robot stops
