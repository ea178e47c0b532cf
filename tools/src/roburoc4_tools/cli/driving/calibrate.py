# SPDX-License-Identifier: MIT
"""`roburoc4 calibrate`: compare what the wheels count with what a person measures."""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from .. import session
from ..errors import ExitCode, refused, usage
from ..options import Options, add_robot, number
from . import moves

if TYPE_CHECKING:
    from roburoc4 import Robot

_METRES = number(0.5, 20.0, "m")
_LEAST, _MOST = 0.5, 2.0
_TURNS = number(1.0, 10.0, "turns")


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "calibrate",
        help="measure how far the robot really drives and turns, and write that to a file",
        description="Drive straight, turn to the left and turn to the right, and ask each time how "
        "far that really was: mark the floor at a wheel and read a tape measure. The wheels slip, "
        "above all in turns, and odometry does not notice. Give the file to --robot-file of the "
        "commands that drive, or to connect(robot_file=...).",
    )
    parser.add_argument(
        "file", metavar="FILE", help="the robot file: written at the end, and changed if it exists"
    )
    parser.add_argument(
        "--metres", type=_METRES, default=2.0, metavar="M", help="distance to drive (default 2)"
    )
    parser.add_argument(
        "--turns", type=_TURNS, default=2.0, metavar="N", help="turns each way (default 2)"
    )
    moves.add_looking(parser)
    session.add_driving(parser, with_file=False)
    add_robot(parser)
    parser.set_defaults(run=_run)


def _run(options: Options) -> int:
    from roburoc4 import robot_file

    known = _known(options.file)
    intention = f"{options.metres:g} m straight, then {options.turns:g} turns each way"
    options.robot_file = options.file if known else None
    with session.driven(options, scale_linear=1.0, scale_angular=1.0) as robot:
        session.confirm(robot, options, intention)
        session.refuse_override(robot)
        with session.armed(robot):
            scale_linear, scale_angular = measure(robot, options)
    known |= {"scale_linear": scale_linear, "scale_angular": scale_angular}
    try:
        robot_file.save(options.file, known)
    except OSError as error:
        raise refused(f"{options.file}: cannot be written: {error.strerror}") from None
    print(f"{options.file}: scale_linear {scale_linear:.4f}, scale_angular {scale_angular:.4f}")
    return ExitCode.FINE


def _known(file: str) -> dict[str, float]:
    """Return what the file has already, but for scales: they are measured without them."""
    from roburoc4 import ArgumentError, robot_file

    if not Path(file).exists():
        return {}
    try:
        return robot_file.load(file)
    except ArgumentError as error:
        raise usage(str(error)) from None


def checked(name: str, scale: float) -> float:
    """Refuse a scale that no robot has."""
    if not _LEAST <= scale <= _MOST:
        raise refused(f"{name}: {scale:g} is not {_LEAST:g} to {_MOST:g}: measure again")
    return scale


def measure(robot: Robot, options: Options) -> tuple[float, float]:
    """Drive and ask; return what the wheels count by what was measured, in m and in rad."""
    angle_rad = 2 * math.pi * options.turns
    way = robot.move(options.metres, clearance=options.clearance, timeout=options.timeout)
    robot.pause()
    metres = _ask(f"The wheels counted {way.distance_m:.3f} m. How many metres was it really? ")
    counted_rad = degrees = 0.0
    for side, sign in (("left", 1), ("right", -1)):
        turn = robot.turn(sign * angle_rad, allow_turns=True, timeout=options.timeout)
        robot.pause()
        counted_rad += abs(turn.angle_rad)
        counted = math.degrees(abs(turn.angle_rad))
        degrees += _ask(
            f"To the {side} the wheels counted {counted:.1f} degrees. How many was it really? "
        )
    return (
        checked("scale_linear", way.distance_m / metres),
        checked("scale_angular", counted_rad / math.radians(degrees)),
    )


def _ask(question: str) -> float:
    print(question, end="", file=sys.stderr, flush=True)
    answer = sys.stdin.readline().strip()
    try:
        value = abs(float(answer))
    except ValueError:
        value = 0.0
    if not (math.isfinite(value) and value > 0):
        raise usage(f"{answer or 'nothing'} is not a measured number: nothing was written")
    return value
