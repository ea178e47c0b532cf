# SPDX-License-Identifier: MIT
"""`roburoc4 ros2`, seen by another participant of the same domain."""

import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import pytest
from cli_support import eventually, start
from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
from rosbags.typesys import Stores, get_typestore

import roburoc4
from roburoc4 import ros_messages
from roburoc4.ros2.participant import Participant
from roburoc4.ros2.topics import PUBLISHED, Profile

MANY = Profile(100)
STORE = get_typestore(Stores.ROS2_JAZZY)
DISCOVERY = "rmw_dds_common/ParticipantEntitiesInfo"
# As public sources have it: eclipse-zenoh/zenoh-plugin-ros2dds, src/ros_discovery.rs.
DISCOVERY_HASH = "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e"


@pytest.fixture
def domain(worker_id: str) -> int:
    """A domain of this process: tests that run beside it must not hear each other."""
    return 100 + int(worker_id.removeprefix("gw") or 0) if worker_id != "master" else 99


@pytest.fixture
def listener(domain: int) -> Iterator[Participant]:
    participant = Participant(domain, interface="lo")
    yield participant
    participant.close()


class Ros2:
    """The command, as a process."""

    def __init__(self, domain: int, *arguments: str, robot: str | None = None) -> None:
        options = ("--domain", str(domain), "--interface", "lo")
        self.process = start("ros2", *options, *arguments, robot=robot)
        assert self.process.stdout is not None
        self.line = self.process.stdout.readline()

    def end(self, number: signal.Signals = signal.SIGINT) -> tuple[int, str]:
        self.process.send_signal(number)
        _, text = self.process.communicate(timeout=30)
        return self.process.returncode, text


@pytest.fixture
def launch(domain: int) -> Iterator[Callable[..., Ros2]]:
    started: list[Ros2] = []

    def start_it(*arguments: str, robot: str | None = None) -> Ros2:
        started.append(Ros2(domain, *arguments, robot=robot))
        return started[-1]

    yield start_it
    for one in started:
        if one.process.poll() is None:
            one.process.kill()
        one.process.communicate()


def take(reader: Any, count: int) -> list[Any]:
    """Read so many messages."""
    found: list[Any] = []

    def enough() -> bool:
        found.extend(reader.take(100))
        return len(found) >= count

    eventually(enough)
    return found


def writers(listener: Participant) -> dict[str, Any]:
    """What is published by others, by the topic's name on the wire."""
    source = BuiltinDataReader(listener.dds, BuiltinTopicDcpsPublication)
    ours = listener.dds.guid
    return {one.topic_name: one for one in source.take(100) if one.participant_key != ours}


# -------------------------------------------------------------------------------------- messages


@pytest.mark.parametrize("kind", sorted({one.kind for one in PUBLISHED.values()}))
def test_type_hashes_are_those_of_rosbags(kind: str) -> None:
    assert ros_messages.type_hash(kind) == STORE.hash_rihs01(ros_messages.ros_name(kind))


def test_the_hash_of_discovery_is_the_published_one() -> None:
    assert ros_messages.type_hash(DISCOVERY) == DISCOVERY_HASH


def test_importing_roburoc4_does_not_import_cyclonedds() -> None:
    code = "import sys, roburoc4, roburoc4.cli.app; print('cyclonedds' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"


# ------------------------------------------------------------------------------------------ live


def test_odometry_comes_at_every_status(
    listener: Participant, launch: Callable[..., Ros2], served: roburoc4.Simulator
) -> None:
    reader = listener.node("/", "test").reader("odom", "nav_msgs/Odometry", MANY)
    assert launch(robot=served.address).line.startswith("roburoc4: node /roburoc4 in domain ")
    found = take(reader, 20)
    stamps = [one.header.stamp.sec + one.header.stamp.nanosec / 1e9 for one in found]
    assert abs(stamps[-1] - time.time()) < 5.0
    for before, after in pairwise(stamps):
        assert after - before == pytest.approx(0.05, abs=0.02)
    assert found[0].header.frame_id == "odom"
    assert found[0].child_frame_id == "base_link"


def test_the_node_is_announced_with_its_topics(
    listener: Participant, launch: Callable[..., Ros2], served: roburoc4.Simulator
) -> None:
    reader = listener.discovery_reader()
    launch(robot=served.address)
    ours = bytes(listener.dds.guid.bytes)
    found: list[Any] = []

    def announced() -> list[Any]:
        found.extend(one for one in reader.take(100) if bytes(one.gid.data) != ours)
        return found

    eventually(announced)
    (node,) = found[-1].node_entities_info_seq
    assert (node.node_namespace, node.node_name) == ("/", "roburoc4")
    known: dict[str, Any] = {}

    def seen() -> bool:
        known.update(writers(listener))
        return len(known) == len(PUBLISHED) + 1

    eventually(seen)
    gids = {bytes(one.key.bytes) for name, one in known.items() if name.startswith("rt/")}
    assert {bytes(gid.data) for gid in node.writer_gid_seq} == gids
