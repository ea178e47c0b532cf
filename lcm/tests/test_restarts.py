# SPDX-License-Identifier: MIT
"""A restarted bridge, a second bridge, and a broken socket."""

import signal
import time
from collections.abc import Callable

from rig import Bridge, Planner, Robot, until
from rig.bus import now_us

StartBridge = Callable[..., Bridge]
Plan = Callable[..., Planner]


def test_a_restarted_bridge_stays_still_until_commands_pause(
    robot: Robot, start_bridge: StartBridge, plan: Plan
) -> None:
    options = ("--enable-drive", "--max-age-ms=0")
    bridge = start_bridge(*options).connects()
    time.sleep(0.8)
    planner = plan(linear=0.5)
    until(robot.tap.moves, "a speed reaches the robot")
    bridge.signal(signal.SIGKILL)
    bridge.ends()
    until(robot.stands, "the robot stands")
    restarted_us = now_us()
    start_bridge(*options)
    until(lambda: robot.tap.statuses()[-1][0] > restarted_us, "the robot sends statuses")
    time.sleep(3.0)
    assert robot.tap.moves(restarted_us) == [], "commands stream, it stays still"
    planner.signal(signal.SIGSTOP)
    time.sleep(0.8)
    paused_us = now_us()
    planner.signal(signal.SIGCONT)
    until(lambda: robot.tap.moves(paused_us), "the next command drives")
