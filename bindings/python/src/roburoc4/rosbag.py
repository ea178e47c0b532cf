# SPDX-License-Identifier: MIT
"""Recordings as MCAP files of ROS 2 messages, for Foxglove, PlotJuggler and `ros2 bag`.

No topic is one that a robot obeys: a recording that is played drives nothing.
"""

import math
import struct
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import IO, Any

from .capture import RecordingError
from .constants import BatteryState, Role
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
from .ros_messages import definition

Item = Status | Command | RecordedEvent

_TOPICS = {
    "/odom": "nav_msgs/Odometry",
    "/tf": "tf2_msgs/TFMessage",
    "/battery_state": "sensor_msgs/BatteryState",
    "/range/front": "sensor_msgs/Range",
    "/range/rear": "sensor_msgs/Range",
    "/joy": "sensor_msgs/Joy",
    "/cmd_vel_applied": "geometry_msgs/TwistStamped",
    "/cmd_vel_sent": "geometry_msgs/TwistStamped",
    "/diagnostics": "diagnostic_msgs/DiagnosticArray",
}
_RANGES = ("front", "rear")
_UNKNOWN = math.nan
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
_CHUNK = 256 * 1024
_NO_COVARIANCE = (0.0,) * 36
_HEAD = b"\0\1\0\0"
_CYCLES_IN_A_SECOND = 100


class Cdr:
    """A message in CDR, little-endian: each number at a multiple of its size."""

    def __init__(self) -> None:
        self.data = bytearray(_HEAD)

    def numbers(self, code: str, *values: float) -> "Cdr":
        """Append numbers of one type, by its letter in ``struct``."""
        size = _SIZES[code]
        data = self.data
        data += bytes((len(_HEAD) - len(data)) % size)
        data += struct.pack(f"<{len(values)}{code}", *values)
        return self

    def text(self, text: str) -> "Cdr":
        """Append a string."""
        data = text.encode() + b"\0"
        self.numbers("I", len(data)).data += data
        return self

    def sequence(self, code: str, values: Sequence[float]) -> "Cdr":
        """Append so many numbers and how many they are."""
        self.numbers("I", len(values))
        return self.numbers(code, *values) if values else self

    def header(self, made_s: float, frame: str) -> "Cdr":
        """Append a std_msgs/Header."""
        second, fraction_us = divmod(max(0, round(made_s * 1e6)), 1_000_000)
        self.numbers("I", min(second, (1 << 31) - 1), fraction_us * 1000)
        return self.text(frame)

    def transform(self, made_s: float, frames: tuple[str, str], pose: Sequence[float]) -> "Cdr":
        """Append a geometry_msgs/TransformStamped."""
        return self.header(made_s, frames[0]).text(frames[1]).numbers("d", *pose)


_SIZES = {code: struct.calcsize(code) for code in "BIifd"}


def _pose(x_m: float, y_m: float, theta_rad: float) -> tuple[float, ...]:
    """Return place and quaternion."""
    half = theta_rad / 2 if math.isfinite(theta_rad) else math.nan
    return x_m, y_m, 0.0, 0.0, 0.0, math.sin(half), math.cos(half)


def _twist(linear_m_s: float, angular_rad_s: float) -> tuple[float, ...]:
    return linear_m_s, 0.0, 0.0, 0.0, 0.0, angular_rad_s


class RosBag:
    """An MCAP file that is being written."""

    def __init__(
        self,
        file: IO[bytes],
        robot: Robot | None,
        address: str,
        offset_s: float = 0.0,
        chunk_size: int = _CHUNK,
    ) -> None:
        """Begin; ``offset_s`` is from the robot object's clock to Unix time.

        Without a robot, what statuses do not hold is left out: limits, and the names of inputs.
        """
        from mcap.writer import Writer

        self._writer = Writer(file, chunk_size=chunk_size)
        self._writer.start(profile="ros2", library="roburoc4")
        self._robot = robot
        self._properties = _NO_PROPERTIES
        self._read_properties()
        self._address = address
        self._offset_us = round(offset_s * 1e6)
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self.messages = 0
        self._speeds: DifferentialStatus | None = None
        self._inputs: IoCardStatus | None = None
        self._pad: tuple[list[int], list[int]] | None = None
        self._handlers: dict[type, Callable[[Any], None]] = {
            IoCardStatus: self._joy,
            TelemeterStatus: self._ranges,
            BatteryStatus: self._battery,
            LocalizationStatus: self._odometry,
            DifferentialStatus: self._applied,
            Command: self._sent,
            RecordedEvent: self._event,
        }

    def add(self, item: Item) -> None:
        """Write a status, a command or an event."""
        self._handlers[type(item)](item)

    def finish(self) -> None:
        """Complete the file."""
        self._writer.finish()  # type: ignore[no-untyped-call]

    def _read_properties(self) -> None:
        if self._robot is not None:
            self._properties = self._robot.properties

    def _channel(self, topic: str) -> int:
        kind = _TOPICS[topic]
        if kind not in self._schemas:
            self._schemas[kind] = self._writer.register_schema(
                kind.replace("/", "/msg/"), "ros2msg", definition(kind).encode()
            )
        return self._writer.register_channel(topic, "cdr", self._schemas[kind])

    def _write(self, topic: str, item: Item, message: Cdr) -> None:
        if topic not in self._channels:
            self._channels[topic] = self._channel(topic)
        time_ns = max(0, (item.host_us + self._offset_us) * 1000)
        self._writer.add_message(self._channels[topic], time_ns, bytes(message.data), time_ns)
        self.messages += 1

    def _seen_s(self, item: Item) -> float:
        return (item.host_us + self._offset_us) / 1e6

    # ---- statuses ----

    def _odometry(self, status: LocalizationStatus) -> None:
        made_s = status.utc_s
        pose = _pose(status.x_m, status.y_m, status.theta_rad)
        speeds = self._speeds
        twist = (
            _twist(speeds.current_linear_m_s, speeds.current_angular_rad_s)
            if speeds
            else (0.0,) * 6
        )
        odometry = Cdr().header(made_s, "odom").text("base_link")
        self._write(
            "/odom", status, odometry.numbers("d", *pose, *_NO_COVARIANCE, *twist, *_NO_COVARIANCE)
        )
        transforms = [("odom", "base_link", pose)]
        if status.robot_cycles % 100 == 0:  # where the telemeters are, once a second
            transforms += [
                ("base_link", f"range_{name}", _pose(one.x_m, one.y_m, one.theta_rad))
                for name, one in zip(_RANGES, self._properties.telemeter, strict=False)
            ]
        message = Cdr().numbers("I", len(transforms))
        for frame, child, where in transforms:
            message.transform(made_s, (frame, child), where)
        self._write("/tf", status, message)

    def _applied(self, status: DifferentialStatus) -> None:
        self._speeds = status
        twist = _twist(status.target_linear_m_s, status.target_angular_rad_s)
        message = Cdr().header(status.utc_s, "base_link").numbers("d", *twist)
        self._write("/cmd_vel_applied", status, message)

    def _ranges(self, status: TelemeterStatus) -> None:
        known = self._properties.telemeter
        for index, (name, metres) in enumerate(zip(_RANGES, status.distances_m, strict=False)):
            bounds = (0.0, 0.0, 0.0)
            if index < len(known):
                about = known[index]
                bounds = (about.field_of_view_rad, about.min_distance_m, about.max_distance_m)
            message = Cdr().header(status.utc_s, f"range_{name}").numbers("B", _ULTRASOUND)
            self._write(f"/range/{name}", status, message.numbers("f", *bounds, metres))

    def _battery(self, status: BatteryStatus) -> None:
        self._read_properties()
        about = self._properties.battery
        capacity = about.capacity_ah if about else _UNKNOWN
        state = status.state if isinstance(status.state, BatteryState) else None
        supply = _SUPPLY[state] if state is not None else 0
        message = Cdr().header(status.utc_s, "base_link")
        # voltage, temperature, current, charge, capacity, design capacity, percentage
        message.numbers("f", self._volts(), *(_UNKNOWN,) * 4, capacity)
        message.numbers("f", status.remaining_percent / 100)
        # supply, health and technology (not known), present
        message.numbers("B", supply, 0, 0, 1)
        # voltages and temperatures of cells, where it is, its serial number
        message.sequence("f", ()).sequence("f", ()).text("").text("")
        self._write("/battery_state", status, message)

    def _volts(self) -> float:
        index = self._robot.role_index(Role.BATTERY_V) if self._robot else None
        if self._inputs is None or index is None or index >= len(self._inputs.analog_inputs):
            return _UNKNOWN
        return self._inputs.analog_inputs[index]

    def _joy(self, status: IoCardStatus) -> None:
        self._inputs = status
        axes, buttons = self._pad or self._find_pad()
        analog, digital = status.analog_inputs, status.digital_inputs
        message = Cdr().header(status.utc_s, "base_link")
        message.sequence("f", [analog[at] for at in axes if at < len(analog)])
        message.sequence("i", [digital[at] for at in buttons if at < len(digital)])
        self._write("/joy", status, message)

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

    # ---- commands and events ----

    def _sent(self, command: Command) -> None:
        if isinstance(command.telegram, DifferentialCommand):
            message = Cdr().header(self._seen_s(command), "base_link")
            message.numbers("d", *_twist(*command.telegram))
            self._write("/cmd_vel_sent", command, message)

    def _event(self, event: RecordedEvent) -> None:
        self._read_properties()
        message = Cdr().header(self._seen_s(event), "base_link").numbers("I", 1)
        message.numbers("B", _LEVELS.get(event.level, 0))
        message.text("roburoc4").text(event.text).text(self._address).numbers("I", 0)
        self._write("/diagnostics", event, message)


# ------------------------------------------------------------------------------------ reading


def statuses(path: Path, file: IO[bytes]) -> Iterator[Status]:
    """Read the statuses of a file that RosBag wrote, without those of the IO card.

    What the file does not hold is 0: ``flags`` and the battery's ``state``. ``robot_cycles`` count
    from the first status. Speeds that were reached are NaN where no odometry came after them.
    """
    from mcap.records import Channel, Message, Schema
    from mcap.stream_reader import StreamReader

    schemas: dict[int, str] = {}
    topics: dict[int, str] = {}
    reader, found = _StatusReader(), False
    try:
        for record in StreamReader(file, validate_crcs=True).records:
            if isinstance(record, Schema):
                schemas[record.id] = record.name.replace("/msg/", "/")
            elif isinstance(record, Channel):
                if _TOPICS.get(record.topic) == schemas.get(record.schema_id, ""):
                    topics[record.id] = record.topic
            elif isinstance(record, Message) and record.channel_id in topics:
                for status in reader.read(topics[record.channel_id], record.log_time, record.data):
                    found = True
                    yield status
        yield from reader.rest()
    except OSError:
        raise
    except Exception:  # what a damaged file makes of the reader: several kinds
        raise RecordingError(
            f"{path} is cut or damaged: save what is whole with roburoc4 recover {path}"
        ) from None
    if not found:
        raise RecordingError(f"{path} holds no statuses of a RobuROC4: give another file")


class _CdrReader:
    """What Cdr wrote, in the same order."""

    def __init__(self, data: bytes) -> None:
        if data[: len(_HEAD)] != _HEAD:
            raise ValueError("a message is not little-endian CDR")
        self._data = data
        self._at = len(_HEAD)

    def numbers(self, code: str, count: int) -> tuple[float, ...]:
        self._at += (len(_HEAD) - self._at) % _SIZES[code]
        values = struct.unpack_from(f"<{count}{code}", self._data, self._at)
        self._at += count * _SIZES[code]
        return values

    def skip_text(self) -> None:
        (size,) = self.numbers("I", 1)
        self._at += int(size)

    def header(self) -> float:
        second, nanosecond = self.numbers("I", 2)
        self.skip_text()
        return round(second + nanosecond / 1e9, 6)


class _StatusReader:
    """Messages in, statuses out: what one message lacks of a status, the next one may hold."""

    def __init__(self) -> None:
        self._cycles = 0
        self._made_s: float | None = None
        self._speeds: DifferentialStatus | None = None
        self._front: TelemeterStatus | None = None
        self._handlers = {
            "/odom": self._odometry,
            "/cmd_vel_applied": self._applied,
            "/range/front": self._range_front,
            "/range/rear": self._range_rear,
            "/battery_state": self._battery,
        }

    def read(self, topic: str, time_ns: int, data: bytes) -> Iterator[Status]:
        if topic in self._handlers:
            message = _CdrReader(data)
            made_s = message.header()
            if self._made_s is not None:  # step by step: the robot's clock drifts
                self._cycles += round((made_s - self._made_s) * _CYCLES_IN_A_SECOND)
            self._made_s = made_s
            yield from self._handlers[topic](message, (time_ns // 1000, made_s))

    def rest(self) -> Iterator[Status]:
        """Give what waited for another message."""
        if self._speeds is not None:
            yield self._speeds
        if self._front is not None:
            yield self._front
        self._speeds = self._front = None

    def _odometry(self, message: _CdrReader, times: tuple[int, float]) -> Iterator[Status]:
        message.skip_text()
        x_m, y_m, _, _, _, z, w = message.numbers("d", 7)
        message.numbers("d", len(_NO_COVARIANCE))
        linear_m_s, _, _, _, _, angular_rad_s = message.numbers("d", 6)
        if self._speeds is not None:
            yield self._speeds._replace(
                current_linear_m_s=linear_m_s, current_angular_rad_s=angular_rad_s
            )
            self._speeds = None
        yield LocalizationStatus(self._cycles, x_m, y_m, 2 * math.atan2(z, w), 0, *times)

    def _applied(self, message: _CdrReader, times: tuple[int, float]) -> Iterator[Status]:
        if self._speeds is not None:
            yield self._speeds
        linear_m_s, _, _, _, _, angular_rad_s = message.numbers("d", 6)
        self._speeds = DifferentialStatus(
            self._cycles, linear_m_s, _UNKNOWN, angular_rad_s, _UNKNOWN, *times
        )

    def _range_front(self, message: _CdrReader, times: tuple[int, float]) -> Iterator[Status]:
        if self._front is not None:
            yield self._front
        self._front = TelemeterStatus(self._cycles, (self._distance_m(message),), *times)

    def _range_rear(self, message: _CdrReader, _times: tuple[int, float]) -> Iterator[Status]:
        if self._front is not None:
            front_m = self._front.distances_m[0]
            yield self._front._replace(distances_m=(front_m, self._distance_m(message)))
            self._front = None

    def _distance_m(self, message: _CdrReader) -> float:
        message.numbers("B", 1)
        return message.numbers("f", 4)[3]

    def _battery(self, message: _CdrReader, times: tuple[int, float]) -> Iterator[Status]:
        share = message.numbers("f", 7)[6]
        yield BatteryStatus(self._cycles, 0, round(100 * share), *times)
