# SPDX-License-Identifier: MIT
"""Odometry as ROS 2 has it (REP-105): pose and speeds of one moment, in a continuous frame."""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from roburoc4.constants import CYCLE_S, LocalizationFlag
from roburoc4.records import DifferentialStatus, LocalizationStatus

from .cdr import Cdr

_UNRELIABLE = LocalizationFlag.INVALID | LocalizationFlag.ERROR


class Frames(NamedTuple):
    """The frames that messages name."""

    odom: str = "odom"
    base: str = "base_link"
    prefix: str = ""
    """The prefix of all of them."""
    map: str = ""
    """With it, the transform from this frame to odom is published, too; it has no prefix."""

    def named(self, name: str) -> str:
        """Return the full name of a frame."""
        return self.prefix + name


def pose_of(x_m: float, y_m: float, theta_rad: float) -> tuple[float, ...]:
    """Return the numbers of a geometry_msgs/Pose: place and quaternion."""
    half = theta_rad / 2 if math.isfinite(theta_rad) else math.nan
    return x_m, y_m, 0.0, 0.0, 0.0, math.sin(half), math.cos(half)


def twist_of(linear_m_s: float, angular_rad_s: float) -> tuple[float, ...]:
    """Return the numbers of a geometry_msgs/Twist."""
    return linear_m_s, 0.0, 0.0, 0.0, 0.0, angular_rad_s


# ---------------------------------------------------------------------------------- covariances

_NOT_MEASURED = 1e6
"""The variance of height, roll and pitch, and of everything that is not known."""
_DISTANCE_ERROR = 0.05
_TURN_ERROR = 0.12
"""The fraction of a turn that was lost to slip on a real robot (moves.md)."""
_HEADING_ERROR_RAD_M = 0.01
_LEAST_M, _LEAST_RAD = 0.01, 0.01
_LEAST_M_S, _LEAST_RAD_S = 0.02, 0.02
_SIDEWAYS_M = 0.1
"""Sideways speed for each rad/s of a turn: the wheels skid."""


def _covariance(x: float, y: float, yaw: float) -> tuple[float, ...]:
    """Return a matrix of 6 x 6 of standard deviations, which are independent."""
    matrix = [0.0] * 36
    matrix[::7] = x * x, y * y, *(_NOT_MEASURED,) * 3, yaw * yaw
    return tuple(matrix)


_ALL_UNKNOWN = _covariance(*(math.sqrt(_NOT_MEASURED),) * 3)


class _Drift:
    """Standard deviations of odometry, which grow with the path and never shrink."""

    def __init__(self) -> None:
        self._last: LocalizationStatus | None = None
        self._place_m = _LEAST_M
        self._heading_rad = _LEAST_RAD

    def covariance(self, status: LocalizationStatus) -> tuple[float, ...]:
        last, self._last = self._last, status
        if last is not None:
            self._add(
                math.hypot(status.x_m - last.x_m, status.y_m - last.y_m),
                abs(math.remainder(status.theta_rad - last.theta_rad, math.tau)),
            )
        if int(status.flags) & _UNRELIABLE:
            return _ALL_UNKNOWN
        return _covariance(self._place_m, self._place_m, self._heading_rad)

    def skip(self) -> None:
        """Do not count the way to the next pose."""
        self._last = None

    def _add(self, way_m: float, turn_rad: float) -> None:
        if math.isfinite(way_m + turn_rad):
            self._place_m += way_m * (_DISTANCE_ERROR + min(self._heading_rad, 1.0))
            heading_rad = _TURN_ERROR * turn_rad + _HEADING_ERROR_RAD_M * way_m
            self._heading_rad = min(self._heading_rad + heading_rad, math.pi)


def _twist_covariance(speeds: DifferentialStatus | None) -> tuple[float, ...]:
    if speeds is None:
        return _ALL_UNKNOWN
    linear, angular = abs(speeds.current_linear_m_s), abs(speeds.current_angular_rad_s)
    return _covariance(
        _LEAST_M_S + _DISTANCE_ERROR * linear,
        _LEAST_M_S + _SIDEWAYS_M * angular,
        _LEAST_RAD_S + _TURN_ERROR * angular,
    )


# ------------------------------------------------------------------------------------- the frame

# A pose jumps if it moves by more than any speed explains.
_JUMP_M, _JUMP_RAD = 0.15, 0.26
_JUMP_SHARE = 1.5
# After a gap the robot may have been driven by others, as fast as it can.
_GAP_S = 0.2
_FASTEST_M_S, _FASTEST_RAD_S = 2.0, 3.0


class _Place(NamedTuple):
    """A pose in the plane, or the transform that moves the origin there."""

    x_m: float = 0.0
    y_m: float = 0.0
    theta_rad: float = 0.0

    def __matmul__(self, other: "_Place") -> "_Place":
        cosine, sine = math.cos(self.theta_rad), math.sin(self.theta_rad)
        return _Place(
            self.x_m + cosine * other.x_m - sine * other.y_m,
            self.y_m + sine * other.x_m + cosine * other.y_m,
            math.remainder(self.theta_rad + other.theta_rad, math.tau),
        )

    def inverse(self) -> "_Place":
        cosine, sine = math.cos(self.theta_rad), math.sin(self.theta_rad)
        return _Place(
            -cosine * self.x_m - sine * self.y_m,
            sine * self.x_m - cosine * self.y_m,
            -self.theta_rad,
        )


class Odometry:
    """Makes nav_msgs/Odometry and its transforms of two services' statuses.

    The robot reports its pose and its speeds in two statuses, the pose often first. A pose waits
    for the speeds of its cycle where they are due.

    After a restart or a relocalization the robot's pose begins elsewhere. `odom` goes on from the
    last pose then; a relocalization moves `map` instead, a restart neither.
    """

    def __init__(self, frames: Frames) -> None:
        self.frames = frames
        self.notes: list[str] = []
        """What the user should know, since the caller last emptied it."""
        self._drift = _Drift()
        self._waiting: LocalizationStatus | None = None
        self._last: LocalizationStatus | None = None
        self._speeds: DifferentialStatus | None = None
        self._period_cycles: int | None = None
        self._has_speeds = True
        self._odom_from_robot = _Place()
        self._map_from_odom = _Place()

    def add_speeds(self, status: DifferentialStatus) -> Iterator[tuple[str, bytes]]:
        """Take speeds; return the messages of a pose that waited for them."""
        if self._speeds is not None:
            self._period_cycles = status.robot_cycles - self._speeds.robot_cycles
        self._speeds = status
        self._has_speeds = True
        yield from self.rest()

    def add_pose(self, status: LocalizationStatus) -> Iterator[tuple[str, bytes]]:
        """Take a pose; return its messages, unless it waits for speeds."""
        if self._waiting is not None:
            self._has_speeds = False
            yield from self.rest()
        self._waiting = status
        if not self._is_speed_due(status):
            yield from self.rest()

    def _is_speed_due(self, status: LocalizationStatus) -> bool:
        speeds = self._speeds
        if speeds is None or self._period_cycles is None:
            return self._has_speeds and (
                speeds is None or speeds.robot_cycles != status.robot_cycles
            )
        return speeds.robot_cycles + self._period_cycles == status.robot_cycles

    @property
    def made_s(self) -> float:
        """When the last pose was measured."""
        return self._last.utc_s if self._last is not None else 0.0

    def rest(self) -> Iterator[tuple[str, bytes]]:
        """Return the messages of a pose that waits."""
        if self._waiting is not None:
            status, self._waiting = self._waiting, None
            yield from self._messages(status)

    def _messages(self, status: LocalizationStatus) -> Iterator[tuple[str, bytes]]:
        here = _Place(status.x_m, status.y_m, status.theta_rad)
        if all(map(math.isfinite, here)):
            self._follow(here, status)
            place = self._odom_from_robot @ here
        else:
            place = here
        frames, speeds = self.frames, self._speeds
        odom, base = frames.named(frames.odom), frames.named(frames.base)
        twist: Sequence[float] = (0.0,) * 6
        if speeds is not None:
            twist = twist_of(speeds.current_linear_m_s, speeds.current_angular_rad_s)
        message = Cdr().header(status.utc_s, odom).text(base)
        message.numbers("d", *pose_of(*place), *self._drift.covariance(status))
        message.numbers("d", *twist, *_twist_covariance(speeds))
        yield "odom", bytes(message.data)
        transforms = [((odom, base), place)]
        if frames.map:
            transforms.insert(0, ((frames.map, odom), self._map_from_odom))
        message = Cdr().numbers("I", len(transforms))
        for pair, transform in transforms:
            message.transform(status.utc_s, pair, pose_of(*transform))
        yield "tf", bytes(message.data)

    def _follow(self, here: _Place, status: LocalizationStatus) -> None:
        """Keep odom where it was if the robot's pose was set, or the robot restarted."""
        last, self._last = self._last, status
        if last is None:
            return
        has_restarted = status.robot_cycles < last.robot_cycles
        if not has_restarted and not self._jumped(last, status):
            return
        kept = self._odom_from_robot @ _Place(last.x_m, last.y_m, last.theta_rad)
        self._odom_from_robot = kept @ here.inverse()
        self._drift.skip()
        if has_restarted:
            self.notes.append("the robot restarted: odom goes on from its last pose")
        else:
            self._map_from_odom = here @ kept.inverse()
            self.notes.append(
                f"the robot was relocalized to {here.x_m:.2f} m, {here.y_m:.2f} m, "
                f"{here.theta_rad:.2f} rad: odom goes on from its last pose, map moves"
            )

    def _jumped(self, last: LocalizationStatus, status: LocalizationStatus) -> bool:
        passed_s = (status.robot_cycles - last.robot_cycles) * CYCLE_S
        m_s, rad_s = _FASTEST_M_S, _FASTEST_RAD_S
        if self._speeds is not None and passed_s <= _GAP_S:
            m_s = abs(self._speeds.current_linear_m_s)
            rad_s = abs(self._speeds.current_angular_rad_s)
        moved_m = math.hypot(status.x_m - last.x_m, status.y_m - last.y_m)
        turned_rad = abs(math.remainder(status.theta_rad - last.theta_rad, math.tau))
        return (
            moved_m > _JUMP_M + _JUMP_SHARE * passed_s * m_s
            or turned_rad > _JUMP_RAD + _JUMP_SHARE * passed_s * rad_s
        )
