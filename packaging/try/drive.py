# SPDX-License-Identifier: MIT
"""drive.py ADDRESS: drive half a metre forward, and fail unless the robot reports that it did."""

import sys

import roburoc4

with roburoc4.connect(sys.argv[1], fresh_ms=1000) as robot:
    robot.arm()
    robot.move(0.5)
    print(f"roburoc4 {roburoc4.__version__}, x {robot.localization.x_m:.2f} m")
    assert abs(robot.localization.x_m - 0.5) < 0.05
