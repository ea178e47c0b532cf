# SPDX-License-Identifier: MIT
"""Whatever falls silent, the robot stands: measured on the robot's side of the wire."""

import contextlib
import os
import signal
import subprocess
import time
from collections.abc import Callable
from contextlib import ExitStack

from processes import drives, first_zero_us
from rig import Bridge, Bus, Planner, Programs, Robot, until

StartBridge = Callable[..., Bridge]
Plan = Callable[..., Planner]

DRIVE = "ROBUROC4_DRIVE_CMD"
STATE = "ROBUROC4_BRIDGE_STATE"
LEASE_US = 250_000
MARGIN_US = 150_000
"""For a loaded machine; the zero of a sleeping one comes within a millisecond."""


def test_a_killed_planner_stops_the_robot_within_the_lease(
    robot: Robot, bus: Bus, armed: Bridge, plan: Plan
) -> None:
    planner = plan(linear=0.5)
    drives(robot)
    planner.signal(signal.SIGKILL)
    planner.ends()
    time.sleep(0.05)
    last_us = bus.of(DRIVE)[-1].time_us
    assert first_zero_us(robot) - last_us < LEASE_US + MARGIN_US
    until(robot.stands, "the robot stands")
    assert not armed.state.driving
    assert armed.state.can_drive, "a new command would drive again"


def test_a_log_that_nobody_reads_does_not_delay_a_stop(
    programs: Programs, robot: Robot, bus: Bus, ends: ExitStack, plan: Plan
) -> None:
    reading, writing = os.pipe()
    ends.callback(os.close, reading)
    os.set_blocking(writing, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writing, b"x" * 4096)
    os.set_blocking(writing, True)
    options = ["-v", "--enable-drive", "--lcm-url", bus.url, "--robot", robot.address]
    with subprocess.Popen([programs("roburoc4-lcm"), *options], stderr=writing) as bridge:
        ends.callback(bridge.kill)
        os.close(writing)
        until(lambda: (state := bus.last(STATE)) and state.can_drive, "it can be driven")
        planner = plan(linear=0.5)
        drives(robot)
        planner.signal(signal.SIGKILL)
        time.sleep(0.05)
        last_us = bus.of(DRIVE)[-1].time_us
        assert first_zero_us(robot) - last_us < LEASE_US + MARGIN_US
        bridge.terminate()
        assert bridge.wait(5) == 0
