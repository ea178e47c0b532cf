# SPDX-License-Identifier: MIT
"""`roburoc4 ros2`, seen by another participant of the same domain."""

import math
import re
import signal
import socket
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from cli_support import document, one_line, run, start
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from robot_support import until
from rosbags.typesys import Stores, get_typestore
from urdf_parser_py.urdf import URDF

import roburoc4
from roburoc4_ros2.announcement import (
    GID_SIZE,
    HUMBLE_GID_SIZE,
    AnnouncedNode,
    Announcement,
    decode,
)
from roburoc4_ros2.participant import Participant, Publisher, Raw
from roburoc4_ros2.types import struct_of
from roburoc4_tools.ros import messages as ros_messages
from roburoc4_tools.ros.published import PUBLISHED, Topic

STORE = get_typestore(Stores.ROS2_JAZZY)
DISCOVERY = "rmw_dds_common/ParticipantEntitiesInfo"
# Of the type that rmw_cyclonedds_cpp 4.1.4 makes of it: servoagents/rmw_cyclonedds_c.
DISCOVERY_TYPES = ("d5a2a4d65f7a49b37ab3e7628202", "2e82f50c0ec361f7a2abe38ff5cf")


@pytest.fixture(scope="session")
def domain() -> Iterator[int]:
    """A domain of this process, kept by a socket: tests that run beside it must not hear it."""
    for domain in range(1, 101):
        with socket.socket() as kept:
            try:
                kept.bind(("127.0.0.1", 7400 + 250 * domain))
            except OSError:  # another one's
                continue
            yield domain
            return
    pytest.fail("all domains are in use")


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

    until(enough)
    return found


# -------------------------------------------------------------------------------------- messages


@pytest.mark.parametrize("kind", sorted({one.kind for one in PUBLISHED.values()}))
def test_type_hashes_are_those_of_rosbags(kind: str) -> None:
    assert ros_messages.type_hash(kind) == STORE.hash_rihs01(ros_messages.ros_name(kind))


def test_the_type_of_discovery_is_the_published_one() -> None:
    info = struct_of(DISCOVERY).__idl__.get_type_info()
    minimal, complete = info.minimal.typeid_with_size, info.complete.typeid_with_size
    ids = tuple(bytes(one.type_id.value).hex() for one in (minimal, complete))
    assert ids == DISCOVERY_TYPES


# ------------------------------------------------------------------------------ what is published


def messages(listener: Participant, topics: dict[str, Topic], namespace: str = "/") -> Any:
    """Return what reads, with rosbags, until each topic has come: the latest of each."""
    node = listener.node(namespace, "test")
    readers = {
        key: node.reader(topic.name, topic.kind, topic.profile) for key, topic in topics.items()
    }
    for reader in readers.values():
        reader.topic.data_type = Raw

    found: dict[str, Any] = {}

    def read() -> dict[str, Any]:
        def all_came() -> bool:
            for key, reader in readers.items():
                kind = ros_messages.ros_name(topics[key].kind)
                for data in reader.take(100):
                    found[key] = STORE.deserialize_cdr(data, kind)
                    # byte for byte what ROS itself would have written, except for padding
                    assert data.startswith(bytes(STORE.serialize_cdr(found[key], kind)))
            return found.keys() == readers.keys()

        until(all_came)
        return found

    return read


@pytest.fixture
def published(listener: Participant) -> Any:
    return messages(listener, PUBLISHED)


def test_what_was_sent_is_what_rosbags_reads(
    published: Any, launch: Callable[..., Ros2], served: roburoc4.Simulator
) -> None:
    served.set("battery_percent", 42)
    served.set("pad_rt", 0.5)
    launch(robot=served.address)
    until(lambda: 20 < published()["battery_state"].voltage < 30)
    found = published()
    front, rear = found["range/front"], found["range/rear"]
    assert front.range == pytest.approx(served.state.distances_m[0])
    assert (front.min_range, front.max_range) == (0.25, 6.0)
    assert front.radiation_type == 0, "ultrasound"
    assert 0 < front.field_of_view < math.pi
    assert (front.header.frame_id, rear.header.frame_id) == ("range_front", "range_rear")
    places = {one.child_frame_id: one.transform for one in found["tf_static"].transforms}
    assert places["range_front"].translation.x == pytest.approx(0.655)
    assert abs(places["range_rear"].rotation.z) == pytest.approx(1.0)
    (moved,) = found["tf"].transforms
    assert (moved.header.frame_id, moved.child_frame_id) == ("odom", "base_link")
    assert found["battery_state"].percentage == pytest.approx(0.42, abs=0.02)
    assert found["battery_state"].present
    assert len(found["pad/joy"].axes) == 6
    assert any(abs(axis - 0.5) < 0.01 for axis in found["pad/joy"].axes)
    assert not found["inhibited"].data
    assert not found["bumpers/front"].data
    twist = found["cmd_vel_applied"].twist
    assert (twist.linear.x, twist.angular.z) == (0.0, 0.0)


def test_diagnostics_tell_link_override_arming_and_versions(
    published: Any, launch: Callable[..., Ros2], served: roburoc4.Simulator
) -> None:
    launch(robot=served.address)
    found: dict[str, Any] = {}

    def connected() -> bool:
        message = published()["diagnostics"]
        found.update({one.name: one for one in message.status})
        return found["roburoc4: link"].message == "connected"

    until(connected)
    values = {name: {one.key: one.value for one in status.values} for name, status in found.items()}
    assert found["roburoc4: link"].hardware_id == served.address
    assert values["roburoc4: link"]["loss"] == "0.000"
    driving = values["roburoc4: driving"]
    assert (driving["armed"], driving["overridden"]) == ("no", "no")
    assert driving["disarm_cause"]
    assert values["roburoc4: versions"]["roburoc4"] == roburoc4.__version__
    assert values["roburoc4: versions"]["cyclonedds"]


def test_the_description_is_a_urdf_of_all_frames(
    published: Any, launch: Callable[..., Ros2], served: roburoc4.Simulator
) -> None:
    launch("--frame-prefix", "r4/", robot=served.address)
    robot = URDF.from_xml_string(published()["robot_description"].data.encode())
    assert robot.check_valid() is None
    assert set(robot.link_map) == {"r4/base_link", "r4/range_front", "r4/range_rear"}
    assert robot.get_root() == "r4/base_link"
    assert robot.joint_map["r4/base_link_to_r4/range_front"].origin.xyz[0] == pytest.approx(0.655)
    assert len(robot.link_map["r4/base_link"].visuals) == 5


# --------------------------------------------------------------------------------- tools and names


def test_two_robots_have_namespaces_frames_and_nodes(
    listener: Participant, launch: Callable[..., Ros2], served: roburoc4.Simulator
) -> None:
    topics = {"odom": PUBLISHED["odom"], "tf_static": PUBLISHED["tf_static"]}
    with roburoc4.Simulator(port=0) as other:
        red = messages(listener, topics, "/RED")
        blue = messages(listener, {"odom": topics["odom"]}, "/BLUE")
        launch("--robot", f"RED={served.address}", "--robot", f"BLUE={other.address}")
        assert red()["odom"].header.frame_id == "RED/odom"
        assert blue()["odom"].child_frame_id == "BLUE/base_link"
        expected = {"/RED/roburoc4", "/BLUE/roburoc4"}
        until(
            lambda: expected == {node.full_name for one in listener.others() for node in one.nodes}
        )


def test_a_file_sets_names_domain_and_frames(tmp_path: Path) -> None:
    path = tmp_path / "robots.yaml"
    path.write_text(
        "domain: 7\nodom_frame: odometry\nrobots:\n"
        "  RED: {address: 192.168.0.2, tf: false, remap: {odom: wheel_odom}}\n"
        "  BLUE: {address: 192.168.0.3, namespace: /sky}\n",
        encoding="utf-8",
    )
    listed = run("ros2", "--config", str(path), "--list")
    assert listed.returncode == 0, listed.stderr
    topics = {line.split()[0] for line in listed.stdout.splitlines()}
    assert {"/RED/wheel_odom", "/sky/odom", "/tf", "/diagnostics"} <= topics
    assert "/RED/odom" not in topics


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("domain: 300\n", "line 1: domain: 300 cannot be used: give 0 to 232"),
        ("robots:\n  RED:\n    adress: x\n", "line 3: there is no setting adress here"),
        ("robots:\n  R-D: {address: x}\n", "line 2: 'R-D' is not a valid name"),
        ("tf: true\ntf: false\n", "line 2: tf is given twice"),
        ("robots:\n  RED: {tf: true}\n", "the robot RED has no address"),
    ],
)
def test_a_bad_file_is_refused_with_line_value_and_remedy(
    tmp_path: Path, text: str, told: str
) -> None:
    path = tmp_path / "robots.yaml"
    path.write_text(text, encoding="utf-8")
    done = run("ros2", "--config", str(path), "--list")
    assert done.returncode == 2
    assert str(path) in one_line(done.stderr)
    assert told in done.stderr


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--domain", "233"), "--domain: '233' cannot be used: give 0 to 232"),
        (("--distro", "foxy"), "--distro: 'foxy' cannot be used: give humble,"),
        (("--remap", "nothing:=x"), "--remap"),
        (("--robot", "a", "--robot", "b"), "several robots need different names"),
        (("--config", "/nowhere.yaml"), "/nowhere.yaml cannot be read"),
    ],
)
def test_a_bad_option_is_refused_with_a_remedy(arguments: tuple[str, ...], told: str) -> None:
    done = run("ros2", *arguments, "--list")
    assert done.returncode == 2
    assert told in one_line(done.stderr)


def test_an_unknown_interface_is_refused(domain: int) -> None:
    done = run("ros2", "--robot", "127.0.0.1:9", "--domain", str(domain), "--interface", "none0")
    assert done.returncode == 2
    assert "interface none0" in done.stderr.splitlines()[-1]


# ---------------------------------------------------------------------------------- beginning, end


def test_a_robot_that_is_off_is_waited_for(
    listener: Participant, launch: Callable[..., Ros2]
) -> None:
    reader = messages(listener, {"odom": PUBLISHED["odom"]})
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
    program = launch(robot=f"127.0.0.1:{port}")
    log = program.process.stderr
    assert log is not None  # it may also say what it sees of another test's node
    assert any("still waiting" in line for line in log)
    with roburoc4.Simulator(port=port):
        reader()
    assert any("connected" in line for line in log)


def announce(listener: Participant, size: int) -> DataWriter[Any]:
    """Announce a node as another program would, with gids of this size."""
    node = AnnouncedNode("/", "talker", (), ())
    topic = listener.topic("ros_discovery_info", DISCOVERY)
    policies = Policy.Durability.TransientLocal, Policy.Reliability.Reliable(10**8)
    writer: DataWriter[Any] = DataWriter(listener.dds, topic, Qos(*policies))
    publisher = Publisher(writer)
    publisher.publish(Announcement(b"t" * 16, (node,)).encode(size))
    return writer


def heard_sizes(listener: Participant) -> Callable[[], set[int]]:
    """Return a reader of the gid sizes with which /roburoc4 was announced since the last call."""
    policies = Policy.Durability.TransientLocal, Policy.Reliability.Reliable(10**8)
    topic = listener.topic("ros_discovery_info", DISCOVERY)
    depth = Policy.History.KeepLast(100)
    reader: DataReader[Any] = DataReader(listener.dds, topic, Qos(*policies, depth))

    def sizes() -> set[int]:
        found = [decode(data) for data in reader.take(100) if isinstance(data, Raw)]
        return {
            size
            for announcement, size in found
            if "/roburoc4" in [node.full_name for node in announcement.nodes]
        }

    return sizes


def test_the_node_is_announced_in_the_form_of_others(
    listener: Participant, launch: Callable[..., Ros2], served: roburoc4.Simulator
) -> None:
    sizes = heard_sizes(listener)
    launch(robot=served.address)
    until(lambda: sizes() == {GID_SIZE})
    humble = announce(listener, HUMBLE_GID_SIZE)
    until(lambda: sizes() == {HUMBLE_GID_SIZE})
    later = announce(listener, GID_SIZE)
    until(lambda: sizes() == {GID_SIZE})
    assert humble.guid != later.guid


def test_two_of_our_programs_do_not_follow_each_other(
    listener: Participant, launch: Callable[..., Ros2], served: roburoc4.Simulator
) -> None:
    sizes = heard_sizes(listener)
    launch("--distro", "humble", "--namespace", "/other", robot=served.address)
    until(listener.others)
    launch(robot=served.address)
    until(lambda: sizes() == {GID_SIZE})
    time.sleep(1.0)  # it looks five times a second
    assert not sizes()


# -------------------------------------------------------------------------------------- the page

PAGE = Path(__file__).resolve().parents[2] / "docs" / "ros2.md"
HAS_PAGE = pytest.mark.skipif(not PAGE.exists(), reason="an sdist has no pages but python.md")


def fenced(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.M | re.S)


@HAS_PAGE
def test_the_file_of_the_page_is_accepted(tmp_path: Path) -> None:
    (text,) = fenced("yaml")
    path = tmp_path / "robots.yaml"
    path.write_text(text, encoding="utf-8")
    listed = run("ros2", "--config", str(path), "--list")
    assert listed.returncode == 0, listed.stderr
    assert "/red/sonar/front " in listed.stdout
    assert "/BLUE/odom " in listed.stdout


@HAS_PAGE
def test_the_commands_for_ros2_on_the_page_name_topics_of_the_node() -> None:
    found = re.findall(r"^ros2 topic \w+ .*?(/\w+)(?: (\w+/msg/\w+))?", "".join(fenced("sh")), re.M)
    topics = {
        row["topic"]: row["type"]
        for row in document(run("ros2", "--list", "--json", "--enable-drive"))
    }
    assert len(found) == 3
    for topic, kind in found:
        assert kind in ("", topics[topic])


@HAS_PAGE
def test_the_page_has_every_topic_and_option() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for row in document(run("ros2", "--list", "--json")):
        names = (f"`{row['topic']}`", f"`{row['topic'].removeprefix('/')}`")
        assert any(name in text for name in names), row["topic"]
        assert row["type"].replace("/msg/", "/") in text or row["topic"].startswith("/tf")
