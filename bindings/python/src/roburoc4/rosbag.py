# SPDX-License-Identifier: MIT
"""Recordings as MCAP files of ROS 2 messages, for Foxglove, PlotJuggler and `ros2 bag`.

A robot obeys none of these topics: playing a recording drives nothing.
"""

import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import IO

from .cdr import CdrReader
from .errors import RecordingError
from .records import BatteryStatus, DifferentialStatus, LocalizationStatus, Status, TelemeterStatus
from .robot import Robot
from .ros_messages import definition, ros_name
from .ros_topics import TOPICS, UNKNOWN, Item, Messages

_CHUNK = 256 * 1024
_CYCLES_IN_A_SECOND = 100
_COVARIANCE_SIZE = 36
# The QoS with which ros2 bag play publishes it: late listeners need it, too. As numbers, which
# Humble also reads: keep last, reliable, transient local; durations are infinite.
_LATCHED = """\
- history: 1
  depth: 1
  reliability: 1
  durability: 1
  deadline: {sec: 9223372036, nsec: 854775807}
  lifespan: {sec: 9223372036, nsec: 854775807}
  liveliness: 1
  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}
  avoid_ros_namespace_conventions: false
"""


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
        """Start; ``offset_s`` is added to the robot object's time to get Unix time."""
        from mcap.writer import Writer

        self._writer = Writer(file, chunk_size=chunk_size)
        self._writer.start(profile="ros2", library="roburoc4")
        self._messages = Messages(robot, address, offset_s)
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._time_ns = 0
        self.messages = 0

    def add(self, item: Item) -> None:
        """Write a status, a command or an event."""
        self._time_ns = self._messages.seen_us(item) * 1000
        self._write(self._messages.of(item))

    def _write(self, messages: Iterable[tuple[str, bytes]]) -> None:
        for topic, message in messages:
            if topic not in self._channels:
                self._channels[topic] = self._channel(topic)
            self._writer.add_message(self._channels[topic], self._time_ns, message, self._time_ns)
            self.messages += 1

    def finish(self) -> None:
        """Complete the file."""
        self._write(self._messages.rest())
        self._writer.finish()  # type: ignore[no-untyped-call]

    def _channel(self, topic: str) -> int:
        kind = TOPICS[topic]
        if kind not in self._schemas:
            self._schemas[kind] = self._writer.register_schema(
                ros_name(kind), "ros2msg", definition(kind).encode()
            )
        metadata = {"offered_qos_profiles": _LATCHED} if topic == "tf_static" else {}
        return self._writer.register_channel(f"/{topic}", "cdr", self._schemas[kind], metadata)


# ------------------------------------------------------------------------------------ reading


def statuses(path: Path, file: IO[bytes]) -> Iterator[Status]:
    """Read the statuses from a file by RosBag, without those of the IO card.

    Missing values are 0: ``flags`` and the battery's ``state``. ``robot_cycles`` count from the
    first status. Measured speeds are NaN if no odometry followed them.
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
                if TOPICS.get(record.topic[1:]) == schemas.get(record.schema_id, ""):
                    topics[record.id] = record.topic
            elif isinstance(record, Message) and record.channel_id in topics:
                for status in reader.read(topics[record.channel_id], record.log_time, record.data):
                    found = True
                    yield status
        yield from reader.rest()
    except OSError:
        raise
    except Exception:  # the reader raises several kinds of error on a damaged file
        raise RecordingError(
            f"{path} is truncated or damaged: save what is complete with roburoc4 recover {path}"
        ) from None
    if not found:
        raise RecordingError(f"{path} holds no statuses of a RobuROC4: give another file")


class _StatusReader:
    """Converts messages to statuses: what one message lacks, the next one may have."""

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
            message = CdrReader(data)
            made_s = message.header()
            if self._made_s is not None:  # step by step, because the robot's clock drifts
                self._cycles += round((made_s - self._made_s) * _CYCLES_IN_A_SECOND)
            self._made_s = made_s
            yield from self._handlers[topic](message, (time_ns // 1000, made_s))

    def rest(self) -> Iterator[Status]:
        """Return what waited for another message."""
        if self._speeds is not None:
            yield self._speeds
        if self._front is not None:
            yield self._front
        self._speeds = self._front = None

    def _odometry(self, message: CdrReader, times: tuple[int, float]) -> Iterator[Status]:
        message.text()
        x_m, y_m, _, _, _, z, w = message.numbers("d", 7)
        message.numbers("d", _COVARIANCE_SIZE)
        linear_m_s, _, _, _, _, angular_rad_s = message.numbers("d", 6)
        if self._speeds is not None:
            yield self._speeds._replace(
                current_linear_m_s=linear_m_s, current_angular_rad_s=angular_rad_s
            )
            self._speeds = None
        yield LocalizationStatus(self._cycles, x_m, y_m, 2 * math.atan2(z, w), 0, *times)

    def _applied(self, message: CdrReader, times: tuple[int, float]) -> Iterator[Status]:
        if self._speeds is not None:
            yield self._speeds
        linear_m_s, _, _, _, _, angular_rad_s = message.numbers("d", 6)
        self._speeds = DifferentialStatus(
            self._cycles, linear_m_s, UNKNOWN, angular_rad_s, UNKNOWN, *times
        )

    def _range_front(self, message: CdrReader, times: tuple[int, float]) -> Iterator[Status]:
        if self._front is not None:
            yield self._front
        self._front = TelemeterStatus(self._cycles, (self._distance_m(message),), *times)

    def _range_rear(self, message: CdrReader, _times: tuple[int, float]) -> Iterator[Status]:
        if self._front is not None:
            front_m = self._front.distances_m[0]
            yield self._front._replace(distances_m=(front_m, self._distance_m(message)))
            self._front = None

    def _distance_m(self, message: CdrReader) -> float:
        message.numbers("B", 1)
        _, nearest_m, farthest_m, metres = message.numbers("f", 4)
        return min(max(metres, nearest_m), farthest_m) if math.isinf(metres) else metres

    def _battery(self, message: CdrReader, times: tuple[int, float]) -> Iterator[Status]:
        share = message.numbers("f", 7)[6]
        yield BatteryStatus(self._cycles, 0, round(100 * share), *times)
