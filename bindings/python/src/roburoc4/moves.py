# SPDX-License-Identifier: MIT
"""A move of roburoc4_move.h: one metre forward, a quarter turn, to a point, or to a stop."""

import contextlib
import math
from collections.abc import Callable
from typing import NamedTuple, TypeAlias

from . import _native
from .connection import Connection
from .constants import MAX_DRIVE_M_S, MAX_DRIVE_RAD_S, MoveOutcome, Result, Service
from .errors import (
    ArgumentError,
    ClosedError,
    NotKnownError,
    RobotError,
    check_heading,
    check_speeds,
    error_of,
    finite,
    is_within,
    switch,
    unusable,
)
from .records import LocalizationStatus
from .settings import set_member

__all__ = ["MoveError", "MoveResult"]

STEP_S = 0.05
"""A move is stepped with every status, and at least this often."""
_LONGEST_S = 4e6
_UNITS = "radians (not degrees), or allow_turns=True for more than two turns"


class MoveResult(NamedTuple):
    """How a move ended, or its progress."""

    outcome: MoveOutcome
    distance_m: float
    """Distance driven, by odometry; backward is negative."""
    angle_rad: float
    """Angle turned, by odometry; to the right is negative."""
    remaining_m: float
    """Distance left."""
    remaining_rad: float
    """Angle left."""
    pose: LocalizationStatus | None
    """The robot's last reported pose."""


Progress: TypeAlias = Callable[[MoveResult], object]


class MoveError(RobotError):
    """A move did not reach its goal; ``result`` has the reason, and how far the robot got.

    The stop sequence was sent, but the robot may still be rolling: ``rest`` waits until it has
    stopped.
    """

    def __init__(self, result: MoveResult, code: int = Result.STATE, detail: str = "") -> None:
        what, colon, remedy = result.outcome.text.partition(":")
        text = what + detail + colon + remedy
        if result.outcome in (MoveOutcome.LOST, MoveOutcome.CANCELLED) and code != Result.STATE:
            cause = Result(code).text.partition(":")[0]
            text = f"{cause}: {text}"
        super().__init__(text, code)
        self.result = result
        self._detail = detail

    @property
    def outcome(self) -> MoveOutcome:
        """Why it ended."""
        return self.result.outcome

    # Made from a result; the other errors are made from a text.
    def __reduce__(self) -> tuple[type["MoveError"], tuple[MoveResult, Result, str]]:  # type: ignore[override]
        return type(self), (self.result, self.code, self._detail)


class MoveOptions(NamedTuple):
    """Options of a move; None is the C library's default."""

    max_linear_m_s: float | None = None
    max_angular_rad_s: float | None = None
    clearance_m: float | None = None
    timeout_s: float | None = None
    allow_turns: bool = False

    def native(self) -> "_native.MoveOptions":
        """Make the C struct; ArgumentError names invalid values."""
        options = _native.new_move_options()
        timeout_s = self.timeout_s
        if timeout_s is not None and not is_within(0.001, timeout_s, _LONGEST_S):
            raise unusable("timeout", timeout_s, f"0.001 to {_LONGEST_S:g} s")
        if timeout_s is not None:
            set_member("move_options", options, "timeout_ms", round(timeout_s * 1000))
        for name, most, unit in (
            ("max_linear_m_s", MAX_DRIVE_M_S, "m/s"),
            ("max_angular_rad_s", MAX_DRIVE_RAD_S, "rad/s"),
        ):
            value = getattr(self, name)
            if value is not None and not (is_within(0.0, value, most) and value > 0.0):
                raise unusable("speed", value, f"more than 0, up to {most:g} {unit}")
            if value is not None:
                set_member("move_options", options, name, value)
        if self.clearance_m is not None:
            if not is_within(0.0, self.clearance_m, 100.0):
                raise unusable("clearance", self.clearance_m, "0 (ignore telemeters) to 100 m")
            set_member("move_options", options, "clearance_m", self.clearance_m)
        allow_turns = int(switch("allow_turns", self.allow_turns))
        set_member("move_options", options, "allow_turns", allow_turns)
        return options


def arc_options(
    distance_m: float,
    angle_rad: float,
    speed: float | None,
    clearance: float | None,
    timeout: float | None,
    allow_turns: bool,
) -> MoveOptions:
    """Choose the turn rate that results from the speed."""
    finite(distance_m=distance_m, angle_rad=angle_rad)
    turn_rate = None
    if speed is not None and is_within(0.0, speed, MAX_DRIVE_M_S) and distance_m != 0.0:
        turn_rate = min(speed * abs(angle_rad / distance_m), MAX_DRIVE_RAD_S) or None
    return MoveOptions(speed, turn_rate, clearance, timeout, allow_turns)


class Move:
    """A move in progress: step it, and cancel it in a ``finally``."""

    def __init__(self, connection: Connection, options: MoveOptions) -> None:
        self._connection = connection
        self._options = options.native()
        linear_m_s, angular_rad_s, *_ = options
        self._asked = f"speed: {linear_m_s} m/s" if linear_m_s else f"speed: {angular_rad_s} rad/s"
        if linear_m_s and angular_rad_s:
            rate = (
                f"{angular_rad_s:.3g}"
                if angular_rad_s < MAX_DRIVE_RAD_S
                else f"over {MAX_DRIVE_RAD_S:g}"
            )
            self._asked += f", at which this arc turns with {rate} rad/s"
        self._ahead = True
        self._move = _native.new_move()

    def by(self, distance_m: float, angle_rad: float) -> "Move":
        """Drive straight, turn in place or along an arc."""
        finite(distance_m=distance_m, angle_rad=angle_rad)
        self._ahead = distance_m >= 0.0
        self._refuse_disarmed()
        try:
            _native.roburoc4_move_by(self._move, distance_m, angle_rad, self._options)
        except ArgumentError as error:
            if error.code is Result.UNITS:
                raise unusable("angle_rad", angle_rad, _UNITS, error.code) from None
            raise ArgumentError(
                f"distance_m, angle_rad: {distance_m} m and {angle_rad} rad is too far: give m "
                "within 10 km, and rad within 10000",
                Result.ARGUMENT,
            ) from None
        return self

    def to(self, x_m: float, y_m: float, theta_rad: float | None) -> "Move":
        """Go to a point, or to a pose."""
        finite(x_m=x_m, y_m=y_m, theta_rad=0.0 if theta_rad is None else theta_rad)
        self._refuse_disarmed()
        if theta_rad is None:
            _native.roburoc4_move_to_point(self._move, x_m, y_m, self._options)
        else:
            check_heading(theta_rad)
            _native.roburoc4_move_to_pose(self._move, x_m, y_m, theta_rad, self._options)
        return self

    def for_(self, linear_m_s: float, angular_rad_s: float, seconds: float) -> "Move":
        """Drive at these speeds for a time, with ramps inside of it."""
        check_speeds(linear_m_s, angular_rad_s)
        self._asked = f"linear_m_s, angular_rad_s: {linear_m_s:g} and {angular_rad_s:g}"
        self._ahead = linear_m_s >= 0.0
        if not is_within(0.0, seconds, _LONGEST_S):
            raise unusable("seconds", seconds, f"0 to {_LONGEST_S:g} s")
        self._refuse_disarmed()
        _native.roburoc4_move_for(
            self._move, linear_m_s, angular_rad_s, round(seconds * 1000), self._options
        )
        return self

    def rest(self) -> "Move":
        """Stop, and wait until the robot is at rest."""
        _native.roburoc4_move_rest(self._move, self._options)
        return self

    def _refuse_disarmed(self) -> None:
        if self._connection.closed:
            raise error_of(Result.CLOSED)
        facts = _native.roburoc4_client_facts(self._connection.handle)
        if not facts.armed:
            raise error_of(facts.disarm_cause)

    def step(self) -> bool:
        """Continue the move; False when it has ended."""
        return _native.move_step(self._connection.handle, self._move) == MoveOutcome.RUNNING

    def cancel(self) -> None:
        """Stop, unless the move has ended."""
        with contextlib.suppress(ClosedError):
            _native.roburoc4_move_cancel(self._move, self._connection.handle)

    def now(self) -> MoveResult:
        """Return the progress."""
        try:
            pose = _native.latest_status(self._connection.handle, Service.LOCALIZATION)
        except NotKnownError:
            pose = None
        move = self._move
        return MoveResult(
            MoveOutcome(_native.roburoc4_move_outcome_get(move)),
            _native.roburoc4_move_distance_m_get(move),
            _native.roburoc4_move_angle_rad_get(move),
            _native.roburoc4_move_remaining_m_get(move),
            _native.roburoc4_move_remaining_rad_get(move),
            pose,
        )

    def end(self) -> MoveResult:
        """Return the result; raise MoveError unless the goal was reached."""
        result = self.now()
        cause = _native.roburoc4_move_cause_get(self._move)
        if result.outcome is MoveOutcome.TOO_FAST:  # nothing moved
            raise ArgumentError(f"{self._asked}: {result.outcome.text}", Result.ARGUMENT)
        if cause == Result.ARGUMENT:
            raise ArgumentError("x_m, y_m: the goal is more than 10 km away", Result.ARGUMENT)
        if result.outcome is not MoveOutcome.REACHED:
            detail = self._obstacle() if result.outcome is MoveOutcome.OBSTACLE else ""
            raise MoveError(result, cause or Result.STATE, detail)
        return result

    def _obstacle(self) -> str:
        """Say where the obstacle is, and how far from the telemeter if that still sees it."""
        where = "ahead" if self._ahead else "behind"
        try:
            status = _native.latest_status(self._connection.handle, Service.TELEMETER)
        except NotKnownError:
            return f", {where}"
        front_m, rear_m = (*status.distances_m, math.nan, math.nan)[:2]
        distance_m = front_m if self._ahead else rear_m
        return f", {distance_m:.2f} m {where}" if math.isfinite(distance_m) else f", {where}"
