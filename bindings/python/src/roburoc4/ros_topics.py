# SPDX-License-Identifier: MIT
"""Statuses as ROS 2 messages, the same in recordings and on the wire."""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

from .cdr import Cdr
from .constants import BatteryState, LocalizationFlag, Role
from .errors import NotKnownError
from .recording import Command, RecordedEvent
from .records import (
    BatteryStatus,
    DifferentialCommand,
    DifferentialStatus,
    IoCardStatus,
    LocalizationStatus,
    Properties,
    Status,
    TelemeterStatus,
)
from .robot import Robot

Item = Status | Command | RecordedEvent
Message = tuple[str, bytes]
"""A topic, and the message in CDR."""

TOPICS = {
    "odom": "nav_msgs/Odometry",
    "tf": "tf2_msgs/TFMessage",
    "tf_static": "tf2_msgs/TFMessage",
    "battery_state": "sensor_msgs/BatteryState",
    "range/front": "sensor_msgs/Range",
    "range/rear": "sensor_msgs/Range",
    "joy": "sensor_msgs/Joy",
    "cmd_vel_applied": "geometry_msgs/TwistStamped",
    "cmd_vel_sent": "geometry_msgs/TwistStamped",
    "diagnostics": "diagnostic_msgs/DiagnosticArray",
}
RANGES = ("front", "rear")
UNKNOWN = math.nan

_NO_PROPERTIES = Properties((), None, (), None, None, None)
_CHARGING, _DISCHARGING, _FULL = 1, 2, 4
_SUPPLY = {
    BatteryState.CHARGING: _CHARGING,
    BatteryState.CHARGED: _FULL,
    BatteryState.OK: _DISCHARGING,
    BatteryState.CRITICAL: _DISCHARGING,
}
_LEVELS = {"bad": 2, "weak": 1}
_ULTRASOUND = 0
_UNRELIABLE = LocalizationFlag.INVALID | LocalizationFlag.ERROR


class Frames(NamedTuple):
    """The frames that messages name."""

    odom: str = "odom"
    base: str = "base_link"
    prefix: str = ""
    """The prefix of all of them."""

    def named(self, name: str) -> str:
        """Return the full name of a frame."""
        return self.prefix + name


class Diagnosis(NamedTuple):
    """A diagnostic_msgs/DiagnosticStatus."""

    level: int
    """0 fine, 1 a warning, 2 an error, 3 nothing is known."""
    name: str
    message: str
    values: dict[str, str]


def yes_or_no(fact: bool) -> str:
    """Return a fact as the value of a diagnosis."""
    return "yes" if fact else "no"


def diagnostics(made_s: float, hardware: str, found: Sequence[Diagnosis]) -> bytes:
    """Make a diagnostic_msgs/DiagnosticArray."""
    message = Cdr().header(made_s, "").numbers("I", len(found))
    for one in found:
        message.numbers("B", one.level)
        message.text(one.name).text(one.message).text(hardware).numbers("I", len(one.values))
        for key, value in one.values.items():
            message.text(key).text(value)
    return bytes(message.data)


def _pose(x_m: float, y_m: float, theta_rad: float) -> tuple[float, ...]:
    """Return place and quaternion."""
    half = theta_rad / 2 if math.isfinite(theta_rad) else math.nan
    return x_m, y_m, 0.0, 0.0, 0.0, math.sin(half), math.cos(half)


def _twist(linear_m_s: float, angular_rad_s: float) -> tuple[float, ...]:
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
    other = _NOT_MEASURED
    diagonal = (x * x, y * y, other, other, other, yaw * yaw)
    return tuple(diagonal[at // 7] if at % 7 == 0 else 0.0 for at in range(36))


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


# --------------------------------------------------------------------------------------- messages


class Messages:
    """Converts one robot's items to messages, in the order in which a subscriber needs them."""

    def __init__(
        self,
        robot: Robot | None,
        address: str,
        offset_s: float = 0.0,
        frames: Frames | None = None,
    ) -> None:
        """Begin; ``offset_s`` is what has to be added to the robot object's clock for Unix time.

        Without a robot, what statuses do not contain is left out: limits, and names of inputs.
        """
        self._robot = robot
        self._address = address
        self._offset_us = round(offset_s * 1e6)
        self._frames = frames or Frames()
        self._base = self._frames.named(self._frames.base)
        self._properties = _NO_PROPERTIES
        self._placed = _NO_PROPERTIES.telemeter
        self._read_properties()
        self._drift = _Drift()
        self._speeds: DifferentialStatus | None = None
        self._inputs: IoCardStatus | None = None
        self._pad: tuple[list[int], list[int]] | None = None
        self._makers: dict[type, Callable[[Any], Iterator[Message]]] = {
            IoCardStatus: self._joy,
            TelemeterStatus: self._ranges,
            BatteryStatus: self._battery,
            LocalizationStatus: self._odometry,
            DifferentialStatus: self._applied,
            Command: self._sent,
            RecordedEvent: self._event,
        }

    def of(self, item: Item) -> Iterator[Message]:
        """Make messages of a status, a command or an event."""
        return self._makers[type(item)](item)

    def seen_us(self, item: Item) -> int:
        """When an item was received, in Unix time."""
        return max(0, item.host_us + self._offset_us)

    def _read_properties(self) -> None:
        if self._robot is not None:
            self._properties = self._robot.properties

    def _odometry(self, status: LocalizationStatus) -> Iterator[Message]:
        made_s, frames, speeds = status.utc_s, self._frames, self._speeds
        pose = _pose(status.x_m, status.y_m, status.theta_rad)
        twist: Sequence[float] = (0.0,) * 6
        if speeds is not None:
            twist = _twist(speeds.current_linear_m_s, speeds.current_angular_rad_s)
        odom = frames.named(frames.odom)
        message = Cdr().header(made_s, odom).text(self._base)
        message.numbers("d", *pose, *self._drift.covariance(status))
        message.numbers("d", *twist, *_twist_covariance(speeds))
        yield "odom", bytes(message.data)
        message = Cdr().numbers("I", 1).transform(made_s, (odom, self._base), pose)
        yield "tf", bytes(message.data)

    def _applied(self, status: DifferentialStatus) -> Iterator[Message]:
        self._speeds = status
        twist = _twist(status.target_linear_m_s, status.target_angular_rad_s)
        message = Cdr().header(status.utc_s, self._base).numbers("d", *twist)
        yield "cmd_vel_applied", bytes(message.data)

    def _ranges(self, status: TelemeterStatus) -> Iterator[Message]:
        if not self._properties.telemeter:
            self._read_properties()
        known = self._properties.telemeter
        if known and not _same_places(known, self._placed):
            self._placed = known
            yield "tf_static", self._places(status.utc_s)
        for index, (name, metres) in enumerate(zip(RANGES, status.distances_m, strict=False)):
            bounds = (0.0, 0.0, 0.0)
            if index < len(known):
                about = known[index]
                bounds = (about.field_of_view_rad, about.min_distance_m, about.max_distance_m)
            message = Cdr().header(status.utc_s, self._frames.named(f"range_{name}"))
            # the last one is the variance: not known
            message.numbers("B", _ULTRASOUND).numbers("f", *bounds, metres, 0.0)
            yield f"range/{name}", bytes(message.data)

    def _places(self, made_s: float) -> bytes:
        """Make the transforms to the telemeters."""
        places = list(zip(RANGES, self._placed, strict=False))
        message = Cdr().numbers("I", len(places))
        for name, one in places:
            pose = _pose(one.x_m, one.y_m, one.theta_rad)
            message.transform(made_s, (self._base, self._frames.named(f"range_{name}")), pose)
        return bytes(message.data)

    def _battery(self, status: BatteryStatus) -> Iterator[Message]:
        self._read_properties()
        about = self._properties.battery
        capacity = about.capacity_ah if about else UNKNOWN
        state = status.state if isinstance(status.state, BatteryState) else None
        supply = _SUPPLY[state] if state is not None else 0
        message = Cdr().header(status.utc_s, self._base)
        # voltage, temperature, current, charge, capacity, design capacity, percentage
        message.numbers("f", self._volts(), *(UNKNOWN,) * 4, capacity)
        message.numbers("f", status.remaining_percent / 100)
        # supply, health and technology (not known), present
        message.numbers("B", supply, 0, 0, 1)
        # voltages and temperatures of cells, where it is, its serial number
        message.sequence("f", ()).sequence("f", ()).text("").text("")
        yield "battery_state", bytes(message.data)

    def _volts(self) -> float:
        index = self._robot.role_index(Role.BATTERY_V) if self._robot else None
        if self._inputs is None or index is None or index >= len(self._inputs.analog_inputs):
            return UNKNOWN
        return self._inputs.analog_inputs[index]

    def _joy(self, status: IoCardStatus) -> Iterator[Message]:
        self._inputs = status
        axes, buttons = self._pad or self._find_pad()
        analog, digital = status.analog_inputs, status.digital_inputs
        message = Cdr().header(status.utc_s, self._base)
        message.sequence("f", [analog[at] for at in axes if at < len(analog)])
        message.sequence("i", [digital[at] for at in buttons if at < len(digital)])
        yield "joy", bytes(message.data)

    def _find_pad(self) -> tuple[list[int], list[int]]:
        """Return the inputs of the game pad, by their names, in the order of their indices."""
        if self._robot is None:
            return [], []
        try:
            channels = self._robot.channels
        except NotKnownError:
            return [], []
        pad = (
            [at for at, name in enumerate(names) if "pad" in name.lower()]
            for names in (channels.analog_inputs, channels.digital_inputs)
        )
        found = (next(pad), next(pad))
        if self._robot.facts.descriptions_done:
            self._pad = found
        return found

    def _sent(self, command: Command) -> Iterator[Message]:
        if isinstance(command.telegram, DifferentialCommand):
            message = Cdr().header(self.seen_us(command) / 1e6, self._base)
            message.numbers("d", *_twist(*command.telegram))
            yield "cmd_vel_sent", bytes(message.data)

    def _event(self, event: RecordedEvent) -> Iterator[Message]:
        self._read_properties()
        found = Diagnosis(_LEVELS.get(event.level, 0), "roburoc4", event.text, {})
        yield "diagnostics", diagnostics(self.seen_us(event) / 1e6, self._address, [found])


def _same_places(a: Sequence[Any], b: Sequence[Any]) -> bool:
    # distance_m is that of the latest status
    return [one[:6] for one in a] == [one[:6] for one in b]
