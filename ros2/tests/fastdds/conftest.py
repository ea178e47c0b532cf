# SPDX-License-Identifier: MIT
"""Nodes, and programs of Fast DDS that meet them, in a domain of each worker's own."""

import json
import os
import subprocess
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from processes import Program, Robot
from ros import Listener, Node, Publisher, command, dds_program

pytest_plugins = ["processes.plugin", "strain"]
FolderFor = Callable[[str], Path]


@pytest.fixture
def domain() -> int:
    return 20 + int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))


@pytest.fixture
def start_node(
    folder_for: FolderFor, ends: ExitStack, domain: int, robot: Robot
) -> Callable[..., Node]:
    """Start a node for the robot, with more options."""

    def start(*options: str) -> Node:
        node = Node(folder_for("node"), domain, "--robot", robot.address, *options)
        ends.callback(node.end)
        return node

    return start


@pytest.fixture
def listen(folder_for: FolderFor, ends: ExitStack, domain: int) -> Callable[..., Listener]:
    def start() -> Listener:
        listener = Listener(folder_for("listen") / "log", domain)
        ends.callback(listener.end)
        return listener

    return start


@pytest.fixture
def listener(listen: Callable[..., Listener]) -> Listener:
    return listen()


@pytest.fixture
def driven(start_node: Callable[..., Node], listener: Listener) -> Node:
    """A node that obeys cmd_vel: it has been heard, and nobody has asked for a speed since."""
    node = start_node("--enable-drive")
    listener.hears("rt/odom")
    time.sleep(1)
    return node


@pytest.fixture
def publish(folder_for: FolderFor, ends: ExitStack, domain: int) -> Callable[..., Publisher]:
    """Start a publisher of a topic, and wait until somebody subscribes to it."""

    def start(topic: str, kind: str) -> Publisher:
        publisher = Publisher(folder_for("publish") / "log", domain, topic, kind)
        ends.callback(publisher.end)
        publisher.says("ready")
        return publisher

    return start


@pytest.fixture
def drive(run: Callable[..., Program], domain: int) -> Callable[..., Program]:
    """Start programs/drive.cpp, and wait until it sends commands."""

    def start(*arguments: object) -> Program:
        program = run(
            dds_program("drive"), *[str(each) for each in arguments], ROS_DOMAIN_ID=str(domain)
        )
        program.says("driving")
        return program

    return start


@pytest.fixture(scope="session")
def listed() -> list[dict[str, Any]]:
    """What ``roburoc4 ros2 --list`` says that it publishes and obeys."""
    said = subprocess.run(
        [command(), "ros2", "--enable-drive", "--list", "--json"],
        capture_output=True,
        text=True,
        check=True,
    )
    found = json.loads(said.stdout)
    assert isinstance(found, list)
    return found
