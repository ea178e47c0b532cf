# SPDX-License-Identifier: MIT
"""Recordings as MCAP files of ROS 2 messages, for Foxglove, PlotJuggler and `ros2 bag`.

A robot obeys none of these topics: playing a recording drives nothing.
"""

import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import IO

from roburoc4 import __version__
from roburoc4.errors import RecordingError
from roburoc4.protocol import STATUS_SERVICES
from roburoc4.records import (
    BatteryStatus,
    DifferentialStatus,
    LocalizationStatus,
    Status,
    TelemeterStatus,
)
from roburoc4.robot import Robot

from .cdr import CdrReader
from .messages import definition, ros_name
from .published import DEFAULT, PUBLISHED
from .stream import Stream
from .topics import TOPICS, UNKNOWN, Item

_CHUNK = 256 * 1024
_CYCLES_IN_A_SECOND = 100
_COVARIANCE_SIZE = 36
# As rosbag2 wrote it until Iron, and reads it since: QoS with numbers.
_ROSBAG2_VERSION = 5


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
        self._stream = Stream(robot, address, offset_s)
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._robot = robot
        self._address = address
        self._time_ns = 0
        self._first_ns: int | None = None
        self._counts: Counter[str] = Counter()

    @property
    def messages(self) -> int:
        """How many messages were written."""
        return self._counts.total()

    def add(self, item: Item) -> None:
        """Write a status, a command or an event."""
        self._time_ns = self._stream.messages.seen_us(item) * 1000
        self._write(self._stream.of(item))

    def _write(self, messages: Iterable[tuple[str, bytes]]) -> None:
        for topic, message in messages:
            if topic not in self._channels:
                self._channels[topic] = self._channel(topic)
            self._writer.add_message(self._channels[topic], self._time_ns, message, self._time_ns)
            self._counts[topic] += 1
            if self._first_ns is None:
                self._first_ns = self._time_ns

    def finish(self) -> None:
        """Complete the file."""
        self._write(self._stream.messages.rest())
        self._writer.add_metadata("rosbag2", {"serialized_metadata": self._rosbag2()})
        self._writer.add_metadata("roburoc4", self._about())
        self._writer.finish()  # type: ignore[no-untyped-call]

    def _channel(self, topic: str) -> int:
        kind = TOPICS[topic]
        if kind not in self._schemas:
            self._schemas[kind] = self._writer.register_schema(
                ros_name(kind), "ros2msg", definition(kind).encode()
            )
        metadata = {"offered_qos_profiles": _qos(topic)}
        return self._writer.register_channel(f"/{topic}", "cdr", self._schemas[kind], metadata)

    def _rosbag2(self) -> str:
        """Return what rosbag2 stores of a file, as YAML (of which JSON is a part)."""
        topics = [
            {
                "topic_metadata": {
                    "name": f"/{topic}",
                    "type": ros_name(TOPICS[topic]),
                    "serialization_format": "cdr",
                    "offered_qos_profiles": _qos(topic),
                },
                "message_count": count,
            }
            for topic, count in self._counts.items()
        ]
        first_ns = self._first_ns or 0
        times = {
            "duration": {"nanoseconds": self._time_ns - first_ns if self._first_ns else 0},
            "starting_time": {"nanoseconds_since_epoch": first_ns},
            "message_count": self.messages,
        }
        metadata: dict[str, object] = {
            "version": _ROSBAG2_VERSION,
            "storage_identifier": "mcap",
            "relative_file_paths": [],
            **times,
            "topics_with_message_count": topics,
            "compression_format": "",
            "compression_mode": "",
            "files": [],
        }
        return json.dumps(metadata)

    def _about(self) -> dict[str, str]:
        """Return what is known of the robot, the library and the settings."""
        found = {"library": f"roburoc4 {__version__}", "address": self._address}
        if self._robot is None:
            return found
        properties = self._robot.properties
        services = [f"{each.name or each.service} ({each.id})" for each in properties.services]
        found["services"] = ", ".join(services)
        for name in ("differential", "battery", "localization"):
            found[name] = str(getattr(properties, name))
        periods = {name: self._robot.period_s(name) for name in STATUS_SERVICES}
        found["periods_s"] = json.dumps({name: round(each, 3) for name, each in periods.items()})
        return found


def _qos(topic: str) -> str:
    """Return the QoS with which `ros2 bag play` publishes a topic: the node's."""
    profile = PUBLISHED[topic].profile if topic in PUBLISHED else DEFAULT
    endless = "{sec: 9223372036, nsec: 854775807}"
    return (
        f"- history: 1\n  depth: {profile.depth}\n  reliability: 1\n"
        f"  durability: {1 if profile.latched else 2}\n"
        f"  deadline: {endless}\n  lifespan: {endless}\n  liveliness: 1\n"
        f"  liveliness_lease_duration: {endless}\n  avoid_ros_namespace_conventions: false\n"
    )


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
