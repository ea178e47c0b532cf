# SPDX-License-Identifier: MIT
"""Commands that are obeyed."""

import time
from collections.abc import Callable

from rig import Bridge, Planner, Robot, until


def test_a_command_drives_the_robot(
    robot: Robot, armed: Bridge, plan: Callable[..., Planner]
) -> None:
    plan(linear=0.4, angular=-0.3)
    until(robot.tap.moves, "a speed reaches the robot")
    time.sleep(1.0)
    for command in robot.tap.moves():
        assert command[1:] == (0.4, -0.3)
    x_m, _, theta_rad = robot.true_pose()
    assert x_m > 0.1
    assert theta_rad < -0.05
    assert armed.state.driving
    assert armed.state.control_owner == "planner"
    assert 0 < armed.state.lease_left_us <= 250_000
    assert 0 <= armed.state.command_age_us < 250_000
    assert armed.statistics.accepted_drive > 10
