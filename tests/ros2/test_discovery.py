# SPDX-License-Identifier: MIT
"""Tools of ROS 2 see a node like any other: names, types, hashes, QoS, and the graph."""

import signal
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import pytest
from processes import until
from ros import STORE, TWIST_STAMPED, Endpoint, Listener, Node, Publisher, ros_type

StartNode = Callable[..., Node]

GRAPH = "ros_discovery_info"
GRAPH_HASH = "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e"
"""As zenoh-plugin-ros2dds has it (ros_discovery.rs); rosbags hashes bounded strings otherwise."""
LATCHED = {GRAPH, *(f"rt/{name}" for name in ("tf_static", "robot_description", "rosout"))}
"""What nodes that come late need; subscribers of ROS ask for it (tf2_ros/qos.hpp, RViz)."""
STATES = {f"rt/{name}" for name in ("bumpers/front", "bumpers/rear", "inhibited")}

# As public programs and documents have them, so that they do not rest on rosbags alone.
# String, Twist: rmw_zenoh_cpp's design document; the ROS 2 documentation of `ros2 topic info -v`.
# Range: sensor_msgs 5.3.8, msg/Range.json (with variance, since Iron).
KNOWN_HASHES = {
    "std_msgs/msg/String": "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    "geometry_msgs/msg/Twist": "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a",
    "nav_msgs/msg/Odometry": "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
    "sensor_msgs/msg/Range": "b42b62562e93cbfe9d42b82fe5994dfa3d63d7d5c90a317981703f7388adff3a",
    "sensor_msgs/msg/BatteryState": (
        "4bee5dfce981c98faa6828b868307a0a73f992ed0789f374ee96c8f840e69741"
    ),
    "diagnostic_msgs/msg/DiagnosticArray": (
        "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"
    ),
}


def whole_graph(listener: Listener) -> list[Endpoint]:
    """All endpoints of the node, once no more come."""
    listener.hears("rt/odom")
    listener.hears(GRAPH)
    time.sleep(1)
    return listener.of_node()


@pytest.mark.parametrize("name", KNOWN_HASHES)
def test_rosbags_computes_known_hashes(name: str) -> None:
    assert STORE.hash_rihs01(name) == f"RIHS01_{KNOWN_HASHES[name]}"


def test_endpoints_carry_the_hash_of_their_type(start_node: StartNode, listener: Listener) -> None:
    start_node("--enable-drive")
    for each in whole_graph(listener):
        name = ros_type(each.type)
        expected = GRAPH_HASH if each.topic == GRAPH else STORE.hash_rihs01(name)
        assert each.user_data == f"typehash={expected};", each


def test_the_participant_names_its_enclave(start_node: StartNode, listener: Listener) -> None:
    start_node()
    listener.hears("rt/odom")
    assert [each["user_data"].rstrip("?") for each in listener.participants.values()] == [
        "enclave=/;"
    ]


def test_qos_is_what_nodes_of_ros_expect(start_node: StartNode, listener: Listener) -> None:
    start_node("--enable-drive")
    endpoints = whole_graph(listener)
    commands = [each for each in endpoints if each.kind == "reader" and each.topic != GRAPH]
    for topic in ("rt/cmd_vel", "rt/stop"):
        plain = [each for each in commands if each.topic == topic and not each.latched]
        assert plain, "publishers of commands offer no more than rclcpp's default"
    for each in endpoints:
        assert each.topic.startswith("rt/") or each.topic == GRAPH, each
        if each in commands:
            assert each.topic == "rt/stop" or not each.latched, each
        elif each.topic not in STATES:
            assert each.latched == (each.topic in LATCHED), each
        assert each.deadline_s is None, "a subscriber without a deadline would not match"
        assert each.lease_s is None, each
        if each.kind == "writer":
            assert each.reliable, "a reliable subscriber, rclcpp's default, would not match"


def test_the_graph_has_one_node_with_all_endpoints(
    start_node: StartNode, listener: Listener
) -> None:
    start_node("--enable-drive")
    endpoints = [*whole_graph(listener), *listener.services()]
    assert len(listener.services()) == 16  # eight services
    info = listener.samples(GRAPH)[-1].message
    (participant,) = listener.participants
    assert bytes(info.gid.data).hex() == participant
    (node,) = info.node_entities_info_seq
    assert node.node_name
    assert node.node_namespace.startswith("/")

    def listed(kind: str) -> set[str]:
        return {each.guid for each in endpoints if each.kind == kind and each.topic != GRAPH}

    assert {bytes(gid.data).hex() for gid in node.writer_gid_seq} == listed("writer")
    assert {bytes(gid.data).hex() for gid in node.reader_gid_seq} == listed("reader")


def test_list_prints_what_is_announced(
    start_node: StartNode, listener: Listener, listed: list[dict[str, str]]
) -> None:
    start_node("--enable-drive")
    announced = {
        (each.kind == "writer", each.topic.removeprefix("rt"), ros_type(each.type))
        for each in whole_graph(listener)
        if each.topic != GRAPH
    }
    assert announced == {
        (each["direction"] == "published", each["topic"], each["type"]) for each in listed
    }


def test_a_killed_node_disappears_with_its_lease(start_node: StartNode, listener: Listener) -> None:
    node = start_node()
    whole_graph(listener)
    (participant,) = listener.participants.values()
    node.signal(signal.SIGKILL)
    until(
        lambda: not (listener.of_node() or listener.services() or listener.participants),
        "nothing is left",
        participant["lease_s"] + 5,
    )


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_leaves_no_entity_behind(
    start_node: StartNode, listener: Listener, number: signal.Signals
) -> None:
    node = start_node()
    whole_graph(listener)
    node.signal(number)
    until(
        lambda: not (listener.of_node() or listener.services() or listener.participants),
        "nothing is left",
        5.0,
    )


@pytest.mark.parametrize(
    ("options", "kind", "remedy"),
    [
        (["--enable-drive"], "geometry_msgs/msg/Twist", "start this node with --twist"),
        ([], "geometry_msgs/msg/Twist", "start this node with --enable-drive --twist"),
        ([], TWIST_STAMPED, "start this node with --enable-drive"),
        (["--enable-drive", "--twist"], TWIST_STAMPED, "start this node without --twist"),
    ],
)
def test_a_publisher_of_cmd_vel_without_effect_is_told_which_option_takes_it(
    start_node: StartNode,
    listener: Listener,
    tmp_path: Path,
    domain: int,
    ends: ExitStack,
    options: list[str],
    kind: str,
    remedy: str,
) -> None:
    node = start_node(*options)
    publisher = Publisher(tmp_path / "publish.log", domain, "rt/cmd_vel", kind)
    ends.callback(publisher.end)
    told = f"publishes {kind} on /cmd_vel, which does not drive the robot: {remedy}"
    node.says(told, 20)
    until(
        lambda: [one for one in listener.samples("rt/rosout") if told in one.message.msg],
        "it is in /rosout",
    )
    found = listener.hears_that("rt/diagnostics", lambda array: told in str(array))
    (status,) = [each for each in found.status if each.name.endswith("other nodes")]
    assert status.level == 1
    assert told in status.message


def test_a_stop_of_another_type_is_told(
    start_node: StartNode, tmp_path: Path, domain: int, ends: ExitStack
) -> None:
    node = start_node()
    publisher = Publisher(tmp_path / "publish.log", domain, "rt/stop", "std_msgs/msg/Bool")
    ends.callback(publisher.end)
    node.says("which stops nothing: publish std_msgs/msg/Empty", 20)


def test_two_nodes_for_one_robot_notice_each_other(start_node: StartNode) -> None:
    first, second = start_node(), start_node("--namespace", "/other")
    first.says("/other/roburoc4 is another node for the robot at 127.0.0.1", 20)
    second.says("/roburoc4 is another node for the robot at 127.0.0.1", 20)
    assert "publishes /odom, too" not in first.output
