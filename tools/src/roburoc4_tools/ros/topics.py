# SPDX-License-Identifier: MIT
"""Statuses as ROS 2 messages, the same in recordings and on the wire."""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

from roburoc4.constants import BatteryState, Role
from roburoc4.errors import NotKnownError
from roburoc4.records import (
    BatteryStatus,
    DifferentialCommand,
    DifferentialStatus,
    IoCardStatus,
    LocalizationStatus,
    Properties,
    Status,
    TelemeterStatus,
)
from roburoc4.robot import Robot

from ..recordings.recording import Command, RecordedEvent
from .cdr import Cdr
from .odometry import Frames, Odometry, pose_of, twist_of

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
    "pad/joy": "sensor_msgs/Joy",
    "cmd_vel_applied": "geometry_msgs/TwistStamped",
    "cmd_vel_sent": "geometry_msgs/TwistStamped",
    "diagnostics": "diagnostic_msgs/DiagnosticArray",
    "bumpers/front": "std_msgs/Bool",
    "bumpers/rear": "std_msgs/Bool",
    "inhibited": "std_msgs/Bool",
    "robot_description": "std_msgs/String",
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


# --------------------------------------------------------------------------------------- messages


class Messages:
    """Converts one robot's items to messages, in the order in which a subscriber needs them."""

    def __init__(
        self,
        robot: Robot | None,
        address: str,
        offset_s: float = 0.0,
        frames: Frames | None = None,
        report: Callable[[str], object] = lambda text: None,
    ) -> None:
        """Begin; ``offset_s`` is what has to be added to the robot object's clock for Unix time.

        Without a robot, what statuses do not contain is left out: limits, and names of inputs.
        """
        self._robot = robot
        self._address = address
        self._offset_us = round(offset_s * 1e6)
        self._report = report
        self.frames = frames or Frames()
        self._base = self.frames.named(self.frames.base)
        self._properties = _NO_PROPERTIES
        self._placed = _NO_PROPERTIES.telemeter
        self._read_properties()
        self._odometry = Odometry(self.frames)
        self._inputs: IoCardStatus | None = None
        self._pad: tuple[list[int], list[int]] | None = None
        self._makers: dict[type, Callable[[Any], Iterator[Message]]] = {
            IoCardStatus: self._joy,
            TelemeterStatus: self._ranges,
            BatteryStatus: self._battery,
            LocalizationStatus: self._odometry.add_pose,
            DifferentialStatus: self._applied,
            Command: self._sent,
            RecordedEvent: self._event,
        }

    def of(self, item: Item) -> Iterator[Message]:
        """Make messages of a status, a command or an event."""
        yield from self._makers[type(item)](item)
        while self._odometry.notes:
            text = self._odometry.notes.pop(0)
            self._report(text)
            noted = Diagnosis(_LEVELS["weak"], "roburoc4: odometry", text, {})
            yield "diagnostics", diagnostics(self._odometry.made_s, self._address, [noted])

    def rest(self) -> Iterator[Message]:
        """Make what is left at the end."""
        return self._odometry.rest()

    def seen_us(self, item: Item) -> int:
        """When an item was received, in Unix time."""
        return max(0, item.host_us + self._offset_us)

    def _read_properties(self) -> None:
        if self._robot is not None:
            self._properties = self._robot.properties

    def _applied(self, status: DifferentialStatus) -> Iterator[Message]:
        twist = twist_of(status.target_linear_m_s, status.target_angular_rad_s)
        message = Cdr().header(status.utc_s, self._base).numbers("d", *twist)
        yield "cmd_vel_applied", bytes(message.data)
        yield from self._odometry.add_speeds(status)

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
                metres = _by_rep_117(metres, about.min_distance_m, about.max_distance_m)
            message = Cdr().header(status.utc_s, self.frames.named(f"range_{name}"))
            # the last one is the variance: not known
            message.numbers("B", _ULTRASOUND).numbers("f", *bounds, metres, 0.0)
            yield f"range/{name}", bytes(message.data)

    def _places(self, made_s: float) -> bytes:
        """Make the transforms to the telemeters."""
        places = list(zip(RANGES, self._placed, strict=False))
        message = Cdr().numbers("I", len(places))
        for name, one in places:
            pose = pose_of(one.x_m, one.y_m, one.theta_rad)
            message.transform(made_s, (self._base, self.frames.named(f"range_{name}")), pose)
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
        yield "pad/joy", bytes(message.data)

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
            message.numbers("d", *twist_of(*command.telegram))
            yield "cmd_vel_sent", bytes(message.data)

    def _event(self, event: RecordedEvent) -> Iterator[Message]:
        self._read_properties()
        found = Diagnosis(_LEVELS.get(event.level, 0), "roburoc4", event.text, {})
        yield "diagnostics", diagnostics(self.seen_us(event) / 1e6, self._address, [found])


def _by_rep_117(metres: float, nearest_m: float, farthest_m: float) -> float:
    """Return a distance, or an infinity: nothing within the range, or too near to be measured."""
    if metres >= farthest_m > 0:
        return math.inf
    return -math.inf if metres < nearest_m else metres


def _same_places(a: Sequence[Any], b: Sequence[Any]) -> bool:
    # distance_m is that of the latest status
    return [one[:6] for one in a] == [one[:6] for one in b]
