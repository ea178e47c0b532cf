# SPDX-License-Identifier: MIT
"""On the ground, by the library: a metre, a turn, the scales, and two stops."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from .session import ReleasedError, UnsafeError, number

if TYPE_CHECKING:
    from roburoc4 import MoveResult, Robot

_BRAKING_S = 0.66
"""What SAFETY's table rounds up, "braking alone" for 1 m/s; the way grows as the speed does."""
_FASTER_S = 2.5
_RENEW_S = 0.05
_LEAST, _MOST = 0.5, 2.0
_TRIES = 3
_LATE = {
    "queue_answer_ms": "answers",
    "queue_iocard_ms": "statuses of the iocard",
    "queue_differential_ms": "statuses of the differential",
}
STANDING_S = 5.0


def stay_armed(robot: Robot, known: Mapping[str, float]) -> None:
    """Refuse a robot that the library would not drive for long, while it stands; then disarm.

    A computer that stutters once is not a robot that is late: the last of some tries counts.
    """
    from roburoc4 import NotArmedError, Result

    for tries_left in reversed(range(_TRIES)):
        try:
            _stand_armed(robot)
        except NotArmedError as error:
            if error.code not in (Result.STALE_DIFFERENTIAL, Result.STALE_IOCARD):
                raise  # what people can mend
            if not tries_left:
                raise UnsafeError("stays_not_armed", late(known)) from None
        else:
            return
        finally:
            robot.stop()


def _stand_armed(robot: Robot) -> None:
    robot.arm()
    end_s = robot.now_s + STANDING_S
    while robot.now_s < end_s:
        robot.drive(0.0, 0.0)
        robot.sleep(_RENEW_S)


def late(known: Mapping[str, float]) -> str:
    """Say what is late, the latest first."""
    delays = sorted(
        ((known[name], what) for name, what in _LATE.items() if name in known), reverse=True
    )
    latest = ", ".join(f"{what} {ms:.0f} ms" for ms, what in delays)
    return (
        "The library does not stay armed although the robot stands: what it hears may be older "
        f"than 300 ms. Late are {latest or 'others than were measured'}. Where none is later than "
        "100 ms, the network or this computer stutters."
    )


def drive(
    robot: Robot,
    held: Callable[[], bool],
    ask: Callable[[str], str],
    found: dict[str, float],
) -> None:
    """Drive, ask how far that really was, and keep both scales and the ways of the stops.

    The robot is connected with scales of 1. What was found is not measured again.
    """

    def check() -> None:
        if not held():
            robot.stop()
            raise ReleasedError

    def watch(_result: MoveResult) -> None:
        check()

    def asked(text: str) -> str:
        robot.stop()  # people are near it
        return ask(text)

    looking = None if _sees(robot) else 0.0  # somebody does, with an emergency stop in hand
    if "scale_linear" not in found:
        counted_m = robot.move(1.0, speed=0.2, clearance=looking, on_progress=watch).distance_m
        text = "How many metres did the robot move?"
        found["scale_linear"] = _scale(asked, text, counted_m, "m")
        robot.arm()
    if "scale_angular" not in found:
        turned = robot.turn(math.pi / 2, speed=0.3, clearance=looking, on_progress=watch).angle_rad
        text = "By how many degrees did it turn, to the left?"
        found["scale_angular"] = _scale(asked, text, math.degrees(turned), "degrees")
        robot.arm()
    for speed in (0.3, 0.6):
        name = f"stops from {speed:g} m/s within, m"
        if name in found:
            continue
        about_m = speed * (_FASTER_S + _BRAKING_S)
        text = (
            f"It will drive about {about_m:.0f} m, and stop from {speed:g} m/s: is the way free? "
            "yes or no"
        )
        while asked(text).strip().lower() not in ("yes", "y"):
            pass
        robot.arm()
        way_m = _stop_from(robot, speed, check) / found["scale_linear"]
        found[name] = round(way_m, 2)
        if way_m > 2 * _BRAKING_S * speed:
            raise UnsafeError(
                "braking", f"It rolls {way_m:.2f} m from {speed:g} m/s: keep off the ground."
            )


def _scale(ask: Callable[[str], str], text: str, counted: float, unit: str) -> float:
    """Return what the wheels count by what is measured; asks again if these are far apart."""
    again = f"The wheels counted {counted:.2f} {unit}, far from that: measure again. {text}"
    for question in (text, again):
        real = number(ask, question)
        if real and _LEAST <= counted / real <= _MOST:
            return counted / real
    raise UnsafeError("scales", f"The wheels counted {counted:.2f} {unit}, far from the {real:g}.")


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
    """Drive at this speed, stop, and return how far it rolled, as its pose has it.

    Poses may come late, so those that were made then count, not those that have arrived.
    """
    poses = robot.statuses("localization")
    end_s = robot.now_s + _FASTER_S
    while robot.now_s < end_s:
        check()
        robot.drive(speed, 0.0)
        robot.sleep(_RENEW_S)
    began = robot.wait_for("differential").robot_cycles
    robot.pause()
    robot.rest(timeout=10.0)  # slow robots need more than 5 s
    rested = robot.wait_for("differential").robot_cycles
    begin = end = next(poses)
    while end.robot_cycles < rested:
        end = next(poses)
        if end.robot_cycles <= began:
            begin = end
    return math.hypot(end.x_m - begin.x_m, end.y_m - begin.y_m)
