# SPDX-License-Identifier: MIT
"""Anyone can stop the robot at any time, and zeros do not keep others from driving."""

import time
from collections.abc import Callable

import pytest
from rig import Bridge, Bus, Planner, Robot, until
from rig.bus import drive_command, now_us

StartBridge = Callable[..., Bridge]
Plan = Callable[..., Planner]

DRIVE = "ROBUROC4_DRIVE_CMD"
STOP = "ROBUROC4_STOP_CMD"
MARGIN_US = 150_000


def drives(robot: Robot) -> None:
    until(robot.tap.moves, "a speed reaches the robot")
    until(lambda: robot.speeds()[0] > 0.1, "the robot moves")


def stops_for_good(robot: Robot, since_us: int) -> None:
    """Zeros reach the robot at once, no speed does, and it stands."""
    until(lambda: robot.tap.commands(since_us), "a command reaches the robot")
    time.sleep(1.5)
    zeros = [command for command in robot.tap.commands(since_us) if not command.moves]
    assert len(zeros) >= 3, "a stop sequence"
    assert zeros[0].time_us - since_us < MARGIN_US
    assert robot.tap.moves(since_us + MARGIN_US) == []
    until(robot.stands, "the robot stands")


@pytest.mark.parametrize(
    "message",
    [b"", drive_command(0.5).encode()],
    ids=["empty", "drive"],
)
def test_a_stop_works_whatever_its_message_is(
    robot: Robot, bus: Bus, armed: Bridge, plan: Plan, message: bytes
) -> None:
    plan(linear=0.5)
    drives(robot)
    stop_us = now_us()
    bus.publish(STOP, message)
    stops_for_good(robot, stop_us)
    assert armed.statistics.accepted_stop == 1
    assert armed.statistics.rejected_malformed == 0, "it was obeyed, not rejected"
    assert "stop command of" not in armed.output
    assert "stop command on" not in armed.output
