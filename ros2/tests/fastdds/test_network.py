# SPDX-License-Identifier: MIT
"""From another machine, that is from another network namespace, all is as on this one."""

import re
import subprocess
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from pathlib import Path

import pytest
from processes import Program, Programs, until
from ros import Listener, Node


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


def test_localhost_only_is_heard_here_but_not_there(
    listeners: list[Listener], start: Callable[..., Node]
) -> None:
    here, there = listeners
    start("local", ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST")
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
