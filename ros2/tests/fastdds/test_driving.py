# SPDX-License-Identifier: MIT
"""A node of ROS 2 drives the robot; however it falls silent, the robot stands.

All is judged where the robot hears it, and by its wheels.
"""

import math
import re
import signal
import time
from collections.abc import Callable

import pytest
from processes import Program, Robot, drives, first_zero_us, until
from ros import Listener, Node, Publisher

StartNode = Callable[..., Node]
Drive = Callable[..., Program]
Publish = Callable[..., Publisher]

LEASE_US = 250_000
MARGIN_US = 150_000
"""For a loaded machine."""


def now_us() -> int:
    return time.time_ns() // 1000


def test_a_fast_dds_program_drives_a_square(robot: Robot, driven: Node, drive: Drive) -> None:
    program = drive("square", 1.0)
    program.says("done", 90)
    assert program.ends() == 0
    corners = [(float(x), float(y)) for x, y in re.findall(r"corner (\S+) (\S+)", program.output)]
    sides = [math.dist(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    assert sides == pytest.approx([1.0] * 4, abs=0.15), corners
    until(robot.stands, "the robot stands")


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_a_dead_publisher_stops_the_robot_within_lease(
    robot: Robot, driven: Node, listener: Listener, drive: Drive, number: signal.Signals
) -> None:
    program = drive("speed", 0.5, 0)
    drives(robot)
    listener.hears("rt/cmd_vel")
    program.signal(number)
    time.sleep(0.05)
    last_us = listener.samples("rt/cmd_vel")[-1].time_us
    assert first_zero_us(robot) - last_us < LEASE_US + MARGIN_US
    until(robot.stands, "the robot stands")


def test_a_signal_ends_the_node_with_zeros_at_once(
    robot: Robot, driven: Node, drive: Drive
) -> None:
    number = signal.SIGHUP
    drive("speed", 0.5, 0)
    drives(robot)
    signalled_us = now_us()
    driven.signal(number)
    assert driven.ends(5) == 128 + number
    assert "Traceback" not in driven.output
    assert first_zero_us(robot) - signalled_us < 2 * MARGIN_US
    assert len(robot.tap.commands(signalled_us)) >= 3
    until(robot.stands, "the robot stands")
