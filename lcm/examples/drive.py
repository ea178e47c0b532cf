# SPDX-License-Identifier: MIT
"""Drive a gentle curve for three seconds: the whole of it, through the bridge."""

import time

import lcm
from roburoc4_lcm import drive_command_t

network, command = lcm.LCM(), drive_command_t()
command.sender = f"drive.py {time.time_ns()}"  # its own: two programs with one name both drive
command.linear_m_s, command.angular_rad_s = 0.3, 0.2
for _ in range(60):
    command.utime = time.time_ns() // 1000  # the bridge refuses what is old
    network.publish("ROBUROC4_DRIVE_CMD", command.encode())
    time.sleep(0.05)  # each command lives for 300 ms; after the last one the robot stops
