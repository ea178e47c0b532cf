# SPDX-License-Identifier: MIT
"""`roburoc4 drive V W --seconds N`: drive gently, and stop however it ends."""

from __future__ import annotations

import argparse
import math
import time
from typing import TYPE_CHECKING, Any

from . import session
from .errors import ExitCode, refused
from .options import add_robot, add_seconds, angular_rad_s, linear_m_s
from .output import note, print_json
from .progress import progress
from .ramp import GENTLE_ANGULAR_RAD_S2, GENTLE_LINEAR_M_S2, Ramp, gentle

if TYPE_CHECKING:
    from roburoc4 import LocalizationStatus, Robot

_STEP_S = 0.05
_LEASE_S = 0.25  # the client's default
_STOP_S = 5.0


class DriveOptions(session.DrivingOptions):
    """What `drive` is given."""

    linear: float
    angular: float
    seconds: float


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "drive",
        help="drive at V m/s and W rad/s for N seconds",
        description="Drive at V m/s (ahead is positive) and W rad/s (to the left is positive) "
        "for N seconds with gentle acceleration: the way up to speed is part of them, the way "
        "down follows. The robot stops however this ends.",
    )
    parser.add_argument("linear", metavar="V", type=linear_m_s, help="speed in m/s")
    parser.add_argument("angular", metavar="W", type=angular_rad_s, help="turn rate in rad/s")
    add_seconds(parser, "how long", required=True)
    session.add_driving(parser)
    add_robot(parser)
    parser.set_defaults(run=run)


def run(options: DriveOptions) -> int:
    """Drive, and report."""
    with session.driven(options) as robot:
        ramp = _soften(robot, Ramp(options.linear, options.angular, options.seconds))
        session.confirm(robot, options, _intention(ramp))
        session.refuse_override(robot)
        begun = _where(robot)
        with session.armed(robot):
            _follow(robot, ramp)
        if not session.wait_for_rest(robot, _STOP_S):
            raise refused(
                f"zeros were sent, but the wheels still turn after {_STOP_S:g} s: "
                "press an emergency stop"
            )
        report = _report(robot, ramp, begun)
    if options.json:
        print_json(report)
    else:
        print(_summary(report))
    return ExitCode.FINE


def _soften(robot: Robot, asked: Ramp) -> Ramp:
    """Accelerate no faster than the robot's own limits."""
    limits = robot.properties.differential
    if limits is None:
        raise refused("this robot has no differential service to drive with: see roburoc4 info")
    return Ramp(
        _clamp(asked.linear_m_s, limits.min_linear_m_s, limits.max_linear_m_s, "m/s"),
        _clamp(
            asked.angular_rad_s,
            limits.min_angular_rad_s,
            limits.max_angular_rad_s,
            "rad/s",
        ),
        asked.seconds,
        gentle(
            GENTLE_LINEAR_M_S2,
            limits.max_linear_m_s2,
            limits.min_linear_m_s2,
        ),
        gentle(
            GENTLE_ANGULAR_RAD_S2,
            limits.max_angular_rad_s2,
            limits.min_angular_rad_s2,
        ),
    )


def _clamp(value: float, low: float, high: float, unit: str) -> float:
    within = max(low, min(high, value)) if low <= 0.0 <= high else value
    if within != value:
        note(f"{value:g} {unit} is more than the robot allows: it is asked for {within:g} {unit}")
    return within


def _intention(ramp: Ramp) -> str:
    metres = ramp.linear_m_s * ramp.peak * (ramp.total_s - ramp.peak * ramp.rise_s)
    return (
        f"at {ramp.linear_m_s:g} m/s and {ramp.angular_rad_s:g} rad/s for {ramp.seconds:g} s, "
        f"about {abs(metres):.1f} m"
    )


def _follow(robot: Robot, ramp: Ramp) -> None:
    begun_s = time.monotonic()
    share = last_s = 0.0
    with progress("driving", ramp.total_s) as show:
        while (elapsed_s := time.monotonic() - begun_s) < ramp.total_s:
            if elapsed_s - last_s > _LEASE_S:  # this computer was busy: the robot was stopped
                share, last_s = 0.0, elapsed_s
            risen = (elapsed_s - last_s) / ramp.rise_s if ramp.rise_s > 0.0 else 1.0
            share, last_s = min(ramp.share(elapsed_s), share + risen), elapsed_s
            robot.drive(*ramp.speeds(share))
            if robot.facts.inhibited:
                raise refused(
                    "the robot stands still although it is asked to move: look at its emergency "
                    "stops, brakes selector and bumpers, then start again"
                )
            show(elapsed_s, _speed(robot))
            time.sleep(_STEP_S)


def _speed(robot: Robot) -> str:
    speeds = robot.latest("differential")
    if speeds is None:
        return "driving"
    return f"{speeds.current_linear_m_s:+.2f} m/s {speeds.current_angular_rad_s:+.2f} rad/s"


def _where(robot: Robot) -> LocalizationStatus | None:
    from roburoc4 import NotKnownError

    try:
        return robot.localization  # waits a little for the first
    except NotKnownError:
        return None


def _report(robot: Robot, ramp: Ramp, begun: LocalizationStatus | None) -> dict[str, Any]:
    ended = _where(robot)
    report: dict[str, Any] = {
        "robot": robot.address,
        "linear_m_s": ramp.linear_m_s * ramp.peak,
        "angular_rad_s": ramp.angular_rad_s * ramp.peak,
        "seconds": ramp.seconds,
        "total_s": ramp.total_s,
        "begin": _pose(begun),
        "end": _pose(ended),
        "distance_m": None,
    }
    if begun is not None and ended is not None:
        report["distance_m"] = math.hypot(ended.x_m - begun.x_m, ended.y_m - begun.y_m)
    return report


def _pose(status: LocalizationStatus | None) -> dict[str, float] | None:
    if status is None:
        return None
    return {"x_m": status.x_m, "y_m": status.y_m, "theta_rad": status.theta_rad}


def _summary(report: dict[str, Any]) -> str:
    end = report["end"]
    if end is None:
        return "done; the robot does not tell where it is"
    return (
        f"done: x {end['x_m']:.2f} m, y {end['y_m']:.2f} m, theta {end['theta_rad']:.2f} rad by "
        f"odometry, {report['distance_m']:.2f} m from where it began"
    )
