# SPDX-License-Identifier: MIT
"""The node under test, and Fast DDS programs that meet it as nodes of ROS 2 would.

Payloads are read and written by rosbags, which shares no code with the node or with Fast DDS.
"""

import json
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from processes import Program, until
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_JAZZY)
TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"


def dds_type(name: str) -> str:
    """The name of a ROS type on the wire."""
    return "::".join(name.split("/")[:-1]) + "::dds_::" + name.split("/")[-1] + "_"


def ros_type(name: str) -> str:
    package, kind, _, type_name = name.split("::")
    return f"{package}/{kind}/{type_name.removesuffix('_')}"


def command() -> Path:
    return Path(sys.executable).with_name("roburoc4")


def dds_program(name: str) -> Path:
    return Path(os.environ["ROS2_BIN"]) / name


class Sample(NamedTuple):
    time_us: int
    """When Fast DDS had it, in epoch microseconds."""
    message: Any
    cdr: bytes
    same: bool
    """Fast DDS decoded it, and what it encoded then had the same bytes."""


class Endpoint(NamedTuple):
    kind: str
    """"writer" or "reader"."""
    guid: str
    topic: str
    type: str
    reliable: bool
    latched: bool
    user_data: str
    deadline_s: float | None
    lease_s: float | None


class Node(Program):
    """``roburoc4 ros2`` as a process."""

    def __init__(
        self,
        folder: Path,
        domain: int,
        *options: str,
        through: tuple[str, ...] = (),
        **settings: str,
    ) -> None:
        environment = {"ROS_DOMAIN_ID": str(domain), **settings}
        super().__init__(
            folder / "bridge.log", *through, command(), "ros2", *options, environment=environment
        )


class Listener(Program):
    """programs/listen.cpp, and what it found."""

    def __init__(self, log: Path, domain: int, through: tuple[str, ...] = ()) -> None:
        self._read = 0
        self.participants: dict[str, dict[str, Any]] = {}
        self.endpoints: dict[str, Endpoint] = {}
        self.incompatible: list[str] = []
        self._samples: dict[str, list[Sample]] = {}
        super().__init__(
            log,
            *through,
            dds_program("listen"),
            environment={"ROS_DOMAIN_ID": str(domain)},
        )

    def look(self) -> None:
        """Take in what it printed meanwhile."""
        with self.log.open("rb") as file:
            file.seek(self._read)
            text = file.read()
        whole = text[: text.rfind(b"\n") + 1]
        self._read += len(whole)
        for line in whole.decode().splitlines():
            if line.startswith("{"):
                self._take(json.loads(line))

    def _take(self, said: dict[str, Any]) -> None:
        if "participant" in said:
            if said["event"] in ("ended", "lost"):
                self.participants.pop(said["participant"], None)
            else:
                self.participants[said["participant"]] = said
        elif "endpoint" in said:
            if said["gone"]:
                self.endpoints.pop(said["guid"], None)
            else:
                self.endpoints[said["guid"]] = Endpoint(
                    said["endpoint"],
                    said["guid"],
                    said["topic"],
                    said["type"],
                    said["reliable"],
                    said["durability"] == 1,
                    said["user_data"],
                    said["deadline_s"],
                    said["lease_s"],
                )
        elif "incompatible" in said:
            self.incompatible.append(said["incompatible"])
        else:
            cdr = bytes.fromhex(said["cdr"])
            kind = next(e.type for e in self.endpoints.values() if e.topic == said["sample"])
            message = STORE.deserialize_cdr(cdr, ros_type(kind))
            self._samples.setdefault(said["sample"], []).append(
                Sample(said["time_ns"] // 1000, message, cdr, said["same"])
            )

    def samples(self, topic: str) -> list[Sample]:
        self.look()
        return self._samples.get(topic, [])

    def hears(self, topic: str, seconds: float = 15.0) -> Sample:
        """Wait for the first sample of a topic."""
        until(lambda: self.samples(topic), f"a sample of {topic}", seconds)
        return self.samples(topic)[0]

    def hears_that(
        self, topic: str, condition: Callable[[Any], object], seconds: float = 10.0
    ) -> Any:
        """Wait for a new sample of a topic that fulfils the condition."""
        before = len(self.samples(topic))

        def fits() -> bool:
            return any(condition(sample.message) for sample in self.samples(topic)[before:])

        until(fits, f"such a sample of {topic}; the last: {self.samples(topic)[-1:]}", seconds)
        return next(s.message for s in self.samples(topic)[before:] if condition(s.message))

    def _of_others(self) -> list[Endpoint]:
        self.look()
        prefixes = {guid[:24] for guid in self.participants}
        return [each for each in self.endpoints.values() if each.guid[:24] in prefixes]

    def of_node(self) -> list[Endpoint]:
        """Endpoints of other processes, except for those of services."""
        return [each for each in self._of_others() if each.topic[:3] not in ("rq/", "rr/")]

    def services(self) -> list[Endpoint]:
        """Endpoints of other processes' services."""
        return [each for each in self._of_others() if each.topic[:3] in ("rq/", "rr/")]


class Publisher(Program):
    """programs/publish.cpp: publishes payloads, whatever they hold, as soon as somebody listens."""

    def __init__(self, log: Path, domain: int, topic: str, kind: str) -> None:
        environment = {"ROS_DOMAIN_ID": str(domain)}
        super().__init__(
            log, dds_program("publish"), topic, dds_type(kind), environment=environment
        )
        self.kind = kind

    def send(self, cdr: bytes) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(cdr.hex().encode() + b"\n")
        self.process.stdin.flush()

    def send_until(self, condition: Callable[[], object], cdr: bytes) -> None:
        """Send it 20 times a second until it has its effect: the first may be sent before the node
        knows this publisher."""
        end = time.monotonic() + 60
        while not condition():
            assert time.monotonic() < end, "it has no effect"
            self.send(cdr)
            time.sleep(0.05)
