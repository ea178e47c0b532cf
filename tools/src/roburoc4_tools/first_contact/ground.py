# SPDX-License-Identifier: MIT
"""On the ground, by the library: a metre, a turn, the scales, and two stops."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from .session import ReleasedError, UnsafeError, number

if TYPE_CHECKING:
    from roburoc4 import MoveResult, Robot

_BRAKING_S = 0.65
"""SAFETY's table, "braking alone", for 1 m/s; the way grows as the speed does."""
_FASTER_S = 2.5
_RENEW_S = 0.05
_LEAST, _MOST = 0.5, 2.0
STANDING_S = 5.0


def stay_armed(robot: Robot) -> None:
    """Refuse a robot that the library would not drive for long, while it stands; then disarm."""
    from roburoc4 import NotArmedError, Result

    try:
        robot.arm()
        end_s = robot.now_s + STANDING_S
        while robot.now_s < end_s:
            robot.drive(0.0, 0.0)
            robot.sleep(_RENEW_S)
    except NotArmedError as error:
        if error.code not in (Result.STALE_DIFFERENTIAL, Result.STALE_IOCARD):
            raise  # what people can mend
        raise UnsafeError(
            "stays_not_armed",
            f"The library does not stay armed although the robot stands: {error}. How late its "
            "statuses and answers are, is in robot.txt (queue_...).",
        ) from None
    finally:
        robot.stop()


def drive(robot: Robot, held: Callable[[], bool], ask: Callable[[str], str]) -> dict[str, float]:
    """Drive, ask how far that really was, and return both scales and the ways of the stops.

    The robot is connected with scales of 1.
    """

    def check() -> None:
        if not held():
            robot.stop()
            raise ReleasedError

    def watch(_result: MoveResult) -> None:
        check()

    def asked(text: str) -> str:
        robot.stop()  # people are near it
        answer = ask(text)
        robot.arm()
        return answer

    looking = None if _sees(robot) else 0.0  # somebody does, with an emergency stop in hand
    counted_m = robot.move(1.0, speed=0.2, clearance=looking, on_progress=watch).distance_m
    real_m = number(asked, "How many metres did the robot move?")
    turned = robot.turn(math.pi / 2, speed=0.3, clearance=looking, on_progress=watch).angle_rad
    degrees = number(asked, "By how many degrees did it turn, to the left?")
    found = {
        "scale_linear": counted_m / real_m if real_m else math.inf,
        "scale_angular": turned / math.radians(degrees) if degrees else math.inf,
    }
    if not all(_LEAST <= scale <= _MOST for scale in found.values()):
        raise UnsafeError(
            "scales", "What the wheels count is far from what was measured: measure again."
        )
    for speed in (0.3, 0.6):
        text = f"It will drive 2 m and stop from {speed:g} m/s: is the way free? yes or no"
        while asked(text).strip().lower() not in ("yes", "y"):
            pass
        way_m = _stop_from(robot, speed, check) / found["scale_linear"]
        found[f"stops from {speed:g} m/s within, m"] = round(way_m, 2)
        if way_m > 2 * _BRAKING_S * speed:
            raise UnsafeError(
                "braking", f"It rolls {way_m:.2f} m from {speed:g} m/s: keep off the ground."
            )
    return found


def _sees(robot: Robot) -> bool:
    """Whether moves can look out for obstacles: they need all distances and both bumpers."""
    from roburoc4 import NotKnownError, Role

    bumpers = (Role.FRONT_BUMPER, Role.REAR_BUMPER)
    telemeters = len(robot.properties.telemeter)
    try:
        reported = len(robot.telemeter.distances_m)
    except NotKnownError:
        return False
    known = all(robot.role_index(role) is not None for role in bumpers)
    return known and 0 < telemeters <= reported


def _stop_from(robot: Robot, speed: float, check: Callable[[], None]) -> float:
    """Drive at this speed, stop, and return how far it rolled, as its pose has it."""
    end_s = robot.now_s + _FASTER_S
    while robot.now_s < end_s:
        check()
        robot.drive(speed, 0.0)
        robot.sleep(_RENEW_S)
    begin = robot.wait_for("localization")
    robot.pause()
    robot.rest()
    end = robot.wait_for("localization")
    return math.hypot(end.x_m - begin.x_m, end.y_m - begin.y_m)
