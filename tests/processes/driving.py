# SPDX-License-Identifier: MIT
"""Whether the robot is driven, and when it heard that it is no longer."""

import time

from .robot import Robot
from .waiting import until


def drives(robot: Robot) -> None:
    until(robot.tap.moves, "a speed reaches the robot")
    time.sleep(0.5)
    assert robot.speeds()[2] != 0, "the robot has a target"


def first_zero_us(robot: Robot) -> int:
    """When the robot heard the first zero after the last speed; no speed may follow."""
    until(lambda: not robot.tap.commands()[-1].moves, "zero reaches the robot")
    time.sleep(0.8)
    assert robot.speeds()[2:] == (0, 0)
    commands = robot.tap.commands()
    last = max(index for index, command in enumerate(commands) if command.moves)
    return commands[last + 1].time_us
