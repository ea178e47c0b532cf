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


def test_another_machine_reads_odometry_and_drives(
    machines: list[tuple[str, ...]],
    programs: Programs,
    tmp_path: Path,
    domain: int,
    ends: ExitStack,
    run: Callable[..., Program],
) -> None:
    here, there = machines
    simulator = run(*here, programs("roburoc4-sim"), "--port", "0")
    simulator.says("ready")
    address = re.findall(r"127\.0\.0\.1:\d+", simulator.output)[0]
    node = Node(tmp_path, domain, "--robot", address, "--enable-drive", through=here)
    ends.callback(node.end)
    listener = Listener(tmp_path / "listen.log", domain, through=there)
    ends.callback(listener.end)
    listener.hears("rt/odom")
    listener.hears("rt/robot_description")
    time.sleep(1)
    run(*there, dds_program("drive"), "speed", "0.3", "0", ROS_DOMAIN_ID=str(domain))
    listener.hears_that("rt/odom", lambda odometry: odometry.twist.twist.linear.x > 0.2)
