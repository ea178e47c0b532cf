# SPDX-License-Identifier: MIT
"""From another machine, that is from another network namespace, all is as on this one."""

import re
import subprocess
import time
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from pathlib import Path

import pytest
from processes import Program, Programs, until
from ros import Listener, Node, dds_program


def works(enter: tuple[str, ...]) -> bool:
    return b"state UP" in subprocess.check_output([*enter, "ip", "link", "show", "e0"])


@pytest.fixture
def machines(ends: ExitStack) -> list[tuple[str, ...]]:
    """What runs a program on each of two machines with a cable between them."""
    holders = []
    for _ in range(2):
        command = ["unshare", "-n", "sh", "-c", "echo; exec sleep infinity"]
        holder = subprocess.Popen(command, stdout=subprocess.PIPE)
        ends.callback(holder.wait)
        ends.callback(holder.kill)
        assert holder.stdout is not None
        holder.stdout.readline()  # it is in a namespace of its own
        holders.append(holder)
    inside: list[tuple[str, ...]] = [
        ("nsenter", "--net", "-t", str(holder.pid)) for holder in holders
    ]
    subprocess.run(
        f"ip link add e0 netns {holders[0].pid} type veth peer name e0 netns {holders[1].pid}",
        shell=True,
        check=True,
    )
    for number, enter in enumerate(inside, 1):
        script = f"ip link set lo up && ip addr add 10.0.0.{number}/24 dev e0 && ip link set e0 up"
        subprocess.run([*enter, "sh", "-c", script], check=True)
    for enter in inside:  # DDS uses the interfaces that are up when it starts
        until(partial(works, enter), "the cable works")
    return inside


@pytest.fixture
def address(
    machines: list[tuple[str, ...]], programs: Programs, run: Callable[..., Program]
) -> str:
    """Of a simulated robot on the first machine."""
    simulator = run(*machines[0], programs("roburoc4-sim"), "--port", "0")
    simulator.says("ready")
    return str(re.findall(r"127\.0\.0\.1:\d+", simulator.output)[0])


@pytest.fixture
def start(
    machines: list[tuple[str, ...]], address: str, tmp_path: Path, domain: int, ends: ExitStack
) -> Callable[..., Node]:
    """Start a node on the first machine, with a namespace, options, and settings of ROS 2."""

    def start_it(namespace: str, *options: str, **settings: str) -> Node:
        folder = tmp_path / namespace
        folder.mkdir()
        arguments = ("--robot", address, "--namespace", f"/{namespace}", *options)
        node = Node(folder, domain, *arguments, through=machines[0], **settings)
        ends.callback(node.end)
        return node

    return start_it


@pytest.fixture
def listeners(
    machines: list[tuple[str, ...]], tmp_path: Path, domain: int, ends: ExitStack
) -> list[Listener]:
    """One on each machine."""
    found = []
    for number, enter in enumerate(machines):
        found.append(Listener(tmp_path / f"listen{number}.log", domain, through=enter))
        ends.callback(found[-1].end)
    return found


def heard(listener: Listener) -> set[str]:
    """The namespaces of the nodes that are announced."""
    return {
        node.node_namespace
        for sample in listener.samples("ros_discovery_info")
        for node in sample.message.node_entities_info_seq
    }


@pytest.mark.parametrize(
    "setting",
    [{"ROS_LOCALHOST_ONLY": "1"}, {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}],
    ids=["ROS_LOCALHOST_ONLY", "LOCALHOST"],
)
def test_localhost_only_is_heard_here_but_not_there(
    listeners: list[Listener], start: Callable[..., Node], setting: dict[str, str]
) -> None:
    here, there = listeners
    start("local", **setting)
    until(lambda: "/local" in heard(here), "this machine hears it", 20)
    start("public")
    until(lambda: "/public" in heard(there), "the other machine hears one without it", 20)
    assert "/local" not in heard(there)


def test_a_static_peer_is_found_without_multicast(
    listeners: list[Listener], start: Callable[..., Node]
) -> None:
    start(
        "far",
        ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST",
        ROS_STATIC_PEERS="10.0.0.2",
    )
    until(lambda: "/far" in heard(listeners[1]), "the peer hears it", 20)


def test_enforced_security_is_refused_and_another_rmw_is_warned_about(
    start: Callable[..., Node],
) -> None:
    node = start("secure", ROS_SECURITY_ENABLE="true", ROS_SECURITY_STRATEGY="Enforce")
    assert node.ends(20) == 2
    assert "ROS_SECURITY_STRATEGY" in node.output
    start("zenoh", RMW_IMPLEMENTATION="rmw_zenoh_cpp").says("rmw_zenoh_cpp")


def test_another_machine_reads_odometry_and_drives(
    machines: list[tuple[str, ...]],
    listeners: list[Listener],
    start: Callable[..., Node],
    domain: int,
    run: Callable[..., Program],
) -> None:
    _, there = machines
    listener = listeners[1]
    start("red", "--namespace", "/", "--enable-drive")
    listener.hears("rt/odom")
    listener.hears("rt/robot_description")
    time.sleep(1)
    run(*there, dds_program("drive"), "speed", "0.3", "0", ROS_DOMAIN_ID=str(domain))
    listener.hears_that("rt/odom", lambda odometry: odometry.twist.twist.linear.x > 0.2)
