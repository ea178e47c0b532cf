# SPDX-License-Identifier: MIT
"""On the ground, by the library's own moves: a metre, a turn, two stops, and the scales."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from .session import ReleasedError, UnsafeError, number

if TYPE_CHECKING:
    from roburoc4 import MoveResult, Robot

_BRAKING_M = {0.3: 0.2, 0.6: 0.4}
"""SAFETY's table, "braking alone"; the response of a slower robot takes longer."""
_LEAST, _MOST = 0.5, 2.0


def drive(robot: Robot, held: Callable[[], bool], ask: Callable[[str], str]) -> dict[str, float]:
    """Drive, ask how far that really was, and return both scales and the ways of the stops."""

    def watch(_result: MoveResult) -> None:
        if not held():
            robot.stop()
            raise ReleasedError

    counted_m = robot.move(1.0, speed=0.2, on_progress=watch).distance_m
    real_m = number(ask, "How many metres did the robot move?")
    turned = robot.turn(math.pi / 2, speed=0.3, on_progress=watch).angle_rad
    degrees = number(ask, "By how many degrees did it turn, to the left?")
    found = {
        "scale_linear": counted_m / real_m if real_m else math.inf,
        "scale_angular": turned / math.radians(degrees) if degrees else math.inf,
    }
    if not all(_LEAST <= scale <= _MOST for scale in found.values()):
        raise UnsafeError(
            "scales", "What the wheels count is far from what was measured: measure again."
        )
    for speed, usual_m in _BRAKING_M.items():
        robot.move_for(speed, 0.0, 2.0, on_progress=watch)
        way_m = number(ask, f"How far did it roll when it was to stop from {speed:g} m/s, in m?")
        if way_m > 2 * usual_m:
            raise UnsafeError(
                "braking", f"It rolls {way_m:g} m from {speed:g} m/s: keep off the ground."
            )
        found[f"stops from {speed:g} m/s within, m"] = way_m
    return found
