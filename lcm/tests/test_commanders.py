# SPDX-License-Identifier: MIT
"""One commander at a time."""

import signal
import time
from collections.abc import Callable

from rig import Bridge, Planner, Robot, until
from rig.bus import now_us

Plan = Callable[..., Planner]


def test_of_two_commanders_the_first_keeps_the_seat(
    robot: Robot, armed: Bridge, plan: Plan
) -> None:
    first = plan(sender="first", linear=0.3)
    until(robot.tap.moves, "the first drives")
    plan(sender="second", linear=-0.3)
    until(lambda: armed.status.rejected_seat > 10, "the second is refused")
    assert min(command.linear_m_s for command in robot.tap.moves()) > 0
    assert armed.status.commander == "first"

    first.signal(signal.SIGKILL)
    killed_us = now_us()
    until(lambda: armed.status.commander == "second", "the seat is free")
    until(lambda: robot.tap.moves()[-1].linear_m_s < 0, "the second drives")
    # Not before the first one's lease was over, the last of which began 50 ms ago at most.
    changed = next(command for command in robot.tap.moves() if command.linear_m_s < 0)
    assert changed.time_us - killed_us > 200_000


def test_who_stops_leaves_the_seat_when_the_lease_is_over(
    robot: Robot, armed: Bridge, plan: Plan
) -> None:
    first = plan(sender="first", linear=0.3)
    until(robot.tap.moves, "the first drives")
    first.signal(signal.SIGSTOP)
    until(lambda: armed.status.commander == "", "nobody commands")
    plan(sender="second", linear=-0.3)
    until(lambda: armed.status.commander == "second", "the second commands")
    first.signal(signal.SIGCONT)
    time.sleep(0.5)
    assert armed.status.commander == "second"
    assert robot.tap.moves()[-1].linear_m_s < 0
