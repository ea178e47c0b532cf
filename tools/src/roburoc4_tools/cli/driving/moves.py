# SPDX-License-Identifier: MIT
"""`roburoc4 move`, `turn`, `goto` and `square`, and what `drive` shares with them."""

from __future__ import annotations

import argparse
import contextlib
import math
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from roburoc4 import DifferentialStatus, LocalizationStatus
from roburoc4.latest import latest

from .. import session
from ..errors import CommandError, ExitCode, refused, usage
from ..options import FARTHEST, Options, add_robot, angle, coordinate, number, seconds, way_m
from ..output import note, print_json, refuse_closed_pipe
from ..progress import progress

if TYPE_CHECKING:
    from roburoc4 import MoveResult, Robot

    # A step of a command: called with the robot and a function that reports progress.
    Step = Callable[[Robot, Callable[[MoveResult], object]], MoveResult]

_SIDE = number(0.1, FARTHEST, "m")
_SPEED = number(0.001, 5.0, "m/s")
_TURN_RATE = number(0.001, 10.0, "rad/s")
_CLEARANCE = number(0.0, 100.0, "m")


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the commands."""
    parser = _add(commands, "move", _run_move, "drive this many metres straight ahead, or back")
    parser.add_argument("metres", metavar="METRES", type=way_m, help="negative: backward")
    parser = _add(commands, "turn", _run_turn, "turn in place by an angle")
    parser.add_argument(
        "angle", metavar="ANGLE", type=angle, help="radians, or 90deg; negative: to the right"
    )
    parser = _add(commands, "goto", _run_goto, "turn to a point and drive there, by odometry")
    parser.add_argument("x", metavar="X", type=coordinate, help="metres, main (odometry) frame")
    parser.add_argument("y", metavar="Y", type=coordinate, help="metres, main (odometry) frame")
    parser = _add(commands, "square", _run_square, "drive a square to the left")
    parser.add_argument("metres", metavar="METRES", type=_SIDE, help="the length of a side")


def _add(
    commands: argparse._SubParsersAction[argparse.ArgumentParser],
    name: str,
    run: Callable[[Options], int],
    text: str,
) -> argparse.ArgumentParser:
    ends = (
        "A pressed bumper ends it; telemeters are not used."
        if name == "turn"
        else "A pressed bumper, or something near in the direction of travel, ends it; telemeters "
        "(ultrasonic rangefinders) miss things."
    )
    parser = commands.add_parser(
        name,
        help=text,
        description=f"{text[0].upper()}{text[1:]}, with gentle acceleration, and wait until the "
        f"robot is at rest. {ends}",
    )
    parser.add_argument(
        "--speed",
        metavar="SPEED",
        type=_TURN_RATE if name == "turn" else _SPEED,
        help="rad/s (default 0.5)" if name == "turn" else "m/s (default 0.3)",
    )
    add_looking(parser, turns=name == "turn")
    session.add_driving(parser)
    add_robot(parser)
    parser.set_defaults(run=run)
    return parser


def add_looking(parser: argparse.ArgumentParser, *, turns: bool = False) -> None:
    """Add `--clearance` and `--timeout`."""
    parser.add_argument(
        "--clearance",
        metavar="METRES",
        type=_CLEARANCE,
        help="0: turn although its bumpers are not known"
        if turns
        else "distance to keep from what telemeters see (default 0.5; 0: ignore them, and bumpers "
        "that are not known)",
    )
    parser.add_argument(
        "--timeout",
        metavar="SECONDS",
        type=seconds,
        help="the longest time that it may take (default: twice what its profile takes, plus 3)",
    )


def _run_move(options: Options) -> int:
    def step(robot: Robot, show: Callable[[MoveResult], object]) -> MoveResult:
        speed = within_limits(robot, options.speed, "m/s")
        return robot.move(options.metres, **_given(options, speed), on_progress=show)

    intention = f"{options.metres:g} m straight"
    return go(options, intention, abs(options.metres), "m", [step], linear=options.speed)


def _run_turn(options: Options) -> int:
    def step(robot: Robot, show: Callable[[MoveResult], object]) -> MoveResult:
        speed = within_limits(robot, options.speed, "rad/s")
        return robot.turn(
            options.angle, **_given(options, speed), allow_turns=True, on_progress=show
        )

    degrees = math.degrees(options.angle)
    intention = f"a turn of {degrees:.0f}°"
    return go(options, intention, abs(options.angle), "rad", [step], angular=options.speed)


def _run_goto(options: Options) -> int:
    def step(robot: Robot, show: Callable[[MoveResult], object]) -> MoveResult:
        speed = within_limits(robot, options.speed, "m/s")
        _check_reach(robot, options.x, options.y)
        return robot.goto(options.x, options.y, **_given(options, speed), on_progress=show)

    intention = f"to x {options.x:g} m, y {options.y:g} m"
    return go(options, intention, None, "m", [step], linear=options.speed)


def _check_reach(robot: Robot, x_m: float, y_m: float) -> None:
    pose = latest(robot, LocalizationStatus)
    if pose is not None and max(abs(x_m - pose.x_m), abs(y_m - pose.y_m)) > FARTHEST:
        raise usage(
            f"x {x_m:g} m, y {y_m:g} m is more than 10 km away: the robot is at x {pose.x_m:g} m, "
            f"y {pose.y_m:g} m; give a nearer point"
        )


def _run_square(options: Options) -> int:
    def side(robot: Robot, show: Callable[[MoveResult], object]) -> MoveResult:
        speed = within_limits(robot, options.speed, "m/s")
        return robot.move(options.metres, **_given(options, speed), on_progress=show)

    def corner(robot: Robot, show: Callable[[MoveResult], object]) -> MoveResult:
        return robot.turn(
            math.pi / 2, clearance=options.clearance, timeout=options.timeout, on_progress=show
        )

    intention = f"a square of {options.metres:g} m"
    return go(options, intention, 4 * options.metres, "m", [side, corner] * 4, linear=options.speed)


def _given(options: Options, speed: float | None) -> dict[str, float | None]:
    return {"speed": speed, "clearance": options.clearance, "timeout": options.timeout}


def within_limits(robot: Robot, speed: float | None, unit: str) -> float | None:
    """Lower a speed to what the robot allows, and report that."""
    limits = robot.properties.differential
    if speed is None or limits is None:
        return speed
    most = limits.max_linear_m_s if unit == "m/s" else limits.max_angular_rad_s
    if not 0.0 < most < abs(speed):
        return speed
    note(f"{speed:g} {unit} is more than the robot allows: using {most:g} {unit}")
    return math.copysign(most, speed)


def go(
    options: Options,
    intention: str,
    total: float | None,
    unit: str,
    steps: Iterable[Step],
    *,
    linear: float | None = None,
    angular: float | None = None,
) -> int:
    """Ask, arm, take the steps until one fails, come to rest, and report.

    Ceilings are raised to the speeds that were asked for.
    """
    with session.driven(options, (linear or 0.0, angular or 0.0)) as robot:
        session.confirm(robot, options, intention)
        session.refuse_override(robot)
        done: list[MoveResult] = []
        with session.armed(robot), progress("moving", total, unit) as show:
            failure = _take(robot, steps, done, lambda text: show(_come(done, unit), text))
        report = _report(robot, done)
    if options.json:
        print_json(report)
    elif failure is None:
        print(_summary(report))
    if failure is not None:
        raise failure
    return ExitCode.FINE


def _take(
    robot: Robot, steps: Iterable[Step], done: list[MoveResult], show: Callable[[str], None]
) -> CommandError | None:
    from roburoc4 import MoveError

    def progressed(result: MoveResult) -> None:
        refuse_closed_pipe()
        done[-1] = result
        show(_speed(robot))

    for step in steps:
        done.append(_nothing())
        try:
            done[-1] = step(robot, progressed)
        except MoveError as error:
            done[-1] = error.result
            with contextlib.suppress(MoveError):
                robot.rest()
            return refused(str(error))
    return None


def _nothing() -> MoveResult:
    from roburoc4 import MoveOutcome, MoveResult

    return MoveResult(MoveOutcome.RUNNING, 0.0, 0.0, 0.0, 0.0, None)


def _come(done: list[MoveResult], unit: str) -> float:
    if unit == "rad":
        return sum(abs(result.angle_rad) for result in done)
    return sum(abs(result.distance_m) for result in done)


def _speed(robot: Robot) -> str:
    speeds = latest(robot, DifferentialStatus)
    if speeds is None:
        return "moving"
    return f"{speeds.current_linear_m_s:+.2f} m/s {speeds.current_angular_rad_s:+.2f} rad/s"


def _report(robot: Robot, done: list[MoveResult]) -> dict[str, Any]:
    last = done[-1]
    return {
        "robot": robot.address,
        "outcome": last.outcome.name.lower(),
        "distance_m": sum(result.distance_m for result in done),
        "angle_rad": sum(result.angle_rad for result in done),
        "remaining_m": last.remaining_m,
        "remaining_rad": last.remaining_rad,
        "pose": _pose(latest(robot, LocalizationStatus)),
    }


def _pose(status: LocalizationStatus | None) -> dict[str, float] | None:
    if status is None:
        return None
    return {"x_m": status.x_m, "y_m": status.y_m, "theta_rad": status.theta_rad}


def _summary(report: dict[str, Any]) -> str:
    pose = report["pose"]
    degrees = round(math.degrees(report["angle_rad"]), 1) + 0.0  # no -0.0
    come = f"done: {report['distance_m']:.2f} m, turned {degrees:.1f}°"
    if pose is None:
        return f"{come}, by the speeds that the robot reported"
    return (
        f"{come}; x {pose['x_m']:.2f} m, y {pose['y_m']:.2f} m, theta {pose['theta_rad']:.2f} rad "
        "by odometry"
    )
