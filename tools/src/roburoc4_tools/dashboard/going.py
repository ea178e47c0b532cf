# SPDX-License-Identifier: MIT
"""A move to a place on the map, for as long as the driver's page keeps showing it."""

from __future__ import annotations

import threading
from typing import NamedTuple

from roburoc4.errors import RobotError
from roburoc4.moves import MoveResult
from roburoc4.robot import Robot

ENDED = "the move was ended"
_LATE = "the driver's page was late"
_STEP_S = 0.05  # goto() calls on_progress at least this often


class _EndedError(Exception):
    """Nobody watches any more, or the driver took over."""


class Goal(NamedTuple):
    """Where to go, and how."""

    x_m: float
    y_m: float
    scale: float
    """Share of full speed."""
    clearance_m: float | None = None
    """None: what moves keep by default."""


class Going:
    """The robot's move, in a thread; it continues only while ``renew`` is called."""

    def __init__(
        self,
        robot: Robot,
        goal: Goal,
        speed: float,
        end_s: float,
        before: Going | None = None,
    ) -> None:
        """Begin when ``before``, which was ended, has stopped."""
        self.place = (goal.x_m, goal.y_m)
        self.speed = speed
        self._clearance_m = goal.clearance_m
        self.why = ""
        """Why it did not arrive."""
        self._robot = robot
        self._ended = False
        self.renew(end_s)
        self._thread = threading.Thread(target=self._go, args=(before,), daemon=True)
        self._thread.start()

    @property
    def on(self) -> bool:
        """Whether it is moving."""
        return self._thread.is_alive()

    def renew(self, end_s: float) -> None:
        """Continue until this time; it is checked once per step, so one step is subtracted."""
        self._end_s = end_s - _STEP_S

    def end(self) -> None:
        """Stop at the next step."""
        self._ended = True

    def _go(self, before: Going | None) -> None:
        if before is not None:
            before._thread.join()  # it stops the robot as its last act
        try:
            self._robot.goto(
                *self.place,
                speed=self.speed,
                clearance=self._clearance_m,
                on_progress=self._look,
            )
        except _EndedError:
            self.why = ENDED if self._ended else _LATE
        except RobotError as error:
            self.why = str(error)

    def _look(self, _: MoveResult) -> None:
        if self._ended or self._robot.now_s >= self._end_s:
            raise _EndedError
