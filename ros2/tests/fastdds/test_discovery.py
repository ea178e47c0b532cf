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


def whole_graph(listener: Listener) -> list[Endpoint]:
    """All endpoints of the node, once no more come."""
    listener.hears("rt/odom")
    listener.hears(GRAPH)
    time.sleep(1)
    return listener.of_node()


def test_endpoints_carry_the_hash_of_their_type(start_node: StartNode, listener: Listener) -> None:
    start_node("--enable-drive")
    for each in whole_graph(listener):
        name = ros_type(each.type)
        expected = GRAPH_HASH if each.topic == GRAPH else STORE.hash_rihs01(name)
        assert each.user_data == f"typehash={expected};", each


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


def test_a_signal_leaves_no_entity_behind(start_node: StartNode, listener: Listener) -> None:
    node = start_node()
    whole_graph(listener)
    node.signal(signal.SIGTERM)
    until(
        lambda: not (listener.of_node() or listener.services() or listener.participants),
        "nothing is left",
        5.0,
    )


@pytest.mark.parametrize(
    ("options", "kind", "remedy"),
    [
        ([], "geometry_msgs/msg/Twist", "start this node with --enable-drive --twist"),
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


def test_two_nodes_for_one_robot_notice_each_other(start_node: StartNode) -> None:
    first, second = start_node(), start_node("--namespace", "/other")
    first.says("/other/roburoc4 is another node for the robot at 127.0.0.1", 20)
    second.says("/roburoc4 is another node for the robot at 127.0.0.1", 20)
    assert "publishes /odom, too" not in first.output
