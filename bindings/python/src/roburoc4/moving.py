# SPDX-License-Identifier: MIT
"""The methods that make moves, of the blocking robot and of that for asyncio."""

from typing import Generic, TypeVar

from .connection import Connection
from .moves import Move, MoveOptions, Progress, arc_options

_R = TypeVar("_R", covariant=True)


class Moving(Generic[_R]):
    """A robot's moves. They return a MoveResult, or for asyncio a coroutine that does.

    Ctrl-C, an exception and a cancelled task stop the robot.
    """

    _connection: Connection

    def move(
        self,
        distance_m: float,
        *,
        speed: float | None = None,
        clearance: float | None = None,
        timeout: float | None = None,
        on_progress: Progress | None = None,
    ) -> _R:
        """Drive this far straight ahead (negative: backward), and wait until the robot is at rest.

        ``speed`` is in m/s (0.3), within the ceilings. The move ends if a telemeter (ultrasonic
        rangefinder) sees something nearer than the braking distance plus ``clearance`` in metres
        (0.5). It needs telemeters and bumpers that are known; 0 drives without them. Telemeters
        miss things. ``timeout`` is in seconds. ``on_progress`` is called at least every 50 ms, with
        a MoveResult. The robot must be armed. Returns a MoveResult (with asyncio, when awaited);
        raises MoveError if the goal was not reached.
        """
        options = MoveOptions(speed, None, clearance, timeout)
        return self._go(Move(self._connection, options).by(distance_m, 0.0), on_progress)

    def move_for(
        self,
        linear_m_s: float,
        angular_rad_s: float,
        seconds: float,
        *,
        clearance: float | None = None,
        timeout: float | None = None,
        on_progress: Progress | None = None,
    ) -> _R:
        """Drive at these speeds for this time, from the first speed to the last, however far.

        It speeds up and brakes gently inside that time. Otherwise as :meth:`move`.
        """
        options = MoveOptions(None, None, clearance, timeout)
        move = Move(self._connection, options).for_(linear_m_s, angular_rad_s, seconds)
        return self._go(move, on_progress)

    def turn(
        self,
        angle_rad: float,
        *,
        speed: float | None = None,
        clearance: float | None = None,
        timeout: float | None = None,
        allow_turns: bool = False,
        on_progress: Progress | None = None,
    ) -> _R:
        """Turn in place by this angle (negative: to the right), at ``speed`` rad/s (0.5).

        More than two turns must be meant, with ``allow_turns``: degrees look like that. Telemeters
        are ignored; with ``clearance`` 0, so are bumpers that are unknown. Otherwise as
        :meth:`move`.
        """
        options = MoveOptions(None, speed, clearance, timeout, allow_turns)
        return self._go(Move(self._connection, options).by(0.0, angle_rad), on_progress)

    def arc(
        self,
        distance_m: float,
        angle_rad: float,
        *,
        speed: float | None = None,
        clearance: float | None = None,
        timeout: float | None = None,
        allow_turns: bool = False,
        on_progress: Progress | None = None,
    ) -> _R:
        """Drive this far along an arc that turns by this angle; otherwise as :meth:`turn`.

        The turn rate follows from ``speed``, which is in m/s. Telemeters count.
        """
        options = arc_options(distance_m, angle_rad, speed, clearance, timeout, allow_turns)
        return self._go(Move(self._connection, options).by(distance_m, angle_rad), on_progress)

    def goto(
        self,
        x_m: float,
        y_m: float,
        theta_rad: float | None = None,
        *,
        speed: float | None = None,
        clearance: float | None = None,
        timeout: float | None = None,
        on_progress: Progress | None = None,
    ) -> _R:
        """Turn to a point, drive there, then turn to ``theta_rad`` if given.

        They are in the main (odometry) frame. Otherwise as :meth:`move`.
        """
        options = MoveOptions(speed, None, clearance, timeout)
        return self._go(Move(self._connection, options).to(x_m, y_m, theta_rad), on_progress)

    def rest(self, *, timeout: float | None = None) -> _R:
        """Stop, and wait until the robot is at rest, armed or not; at most 5 s."""
        options = MoveOptions(None, None, None, timeout)
        return self._finish(Move(self._connection, options).rest())

    def _go(self, move: Move, on_progress: Progress | None) -> _R:
        """Drive it to its end, as the only move."""
        raise NotImplementedError

    def _finish(self, move: Move, on_progress: Progress | None = None) -> _R:
        """Drive it to its end."""
        raise NotImplementedError
