# SPDX-License-Identifier: MIT
"""`roburoc4 drive V W --seconds N`: drives gently, and stops however it ends."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING

from .. import session
from ..errors import usage
from ..options import FARTHEST, Options, add_robot, add_seconds, angular_rad_s, linear_m_s
from .moves import add_looking, go, within_limits

if TYPE_CHECKING:
    from roburoc4 import MoveResult, Robot


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "drive",
        help="drive at these speeds for a time, with gentle acceleration",
        description="Drive at these speeds for N seconds, from the first speed to the last, with "
        "gentle acceleration and braking inside that time. Positive is ahead and to the left. The "
        "robot stops however this ends.",
    )
    parser.add_argument("linear", metavar="V", type=linear_m_s, help="speed in m/s")
    parser.add_argument("angular", metavar="W", type=angular_rad_s, help="turn rate in rad/s")
    add_seconds(parser, "from the first speed to the last one, in s", required=True)
    add_looking(parser)
    session.add_driving(parser)
    add_robot(parser)
    parser.set_defaults(run=run)


def run(options: Options) -> int:
    """Drive, and report."""

    def step(robot: Robot, show: Callable[[MoveResult], object]) -> MoveResult:
        linear = within_limits(robot, options.linear, "m/s") or 0.0
        angular = within_limits(robot, options.angular, "rad/s") or 0.0
        return robot.move_for(
            linear,
            angular,
            options.seconds,
            clearance=options.clearance,
            timeout=options.timeout,
            on_progress=show,
        )

    way_m, turn_rad = abs(options.linear) * options.seconds, abs(options.angular) * options.seconds
    if max(way_m, turn_rad) > FARTHEST:
        raise usage(
            f"{options.seconds:g} s at these speeds are {way_m:g} m and {turn_rad:g} rad: give "
            "less time, for at most 10 km and 10000 rad"
        )
    intention = (
        f"at {options.linear:g} m/s and {options.angular:g} rad/s for {options.seconds:g} s, "
        f"at most {way_m:.1f} m"
    )
    total, unit = (turn_rad, "rad") if options.linear == 0.0 else (way_m, "m")
    speeds = {"linear": options.linear, "angular": options.angular}
    return go(options, intention, total, unit, [step], **speeds)
