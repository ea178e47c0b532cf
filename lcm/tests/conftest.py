# SPDX-License-Identifier: MIT
"""Networks, bridges and planners for each test, and an end for all of them after it."""

import sys
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import pytest
from rig import Bridge, Bus, Planner, Programs, Robot

pytest_plugins = ["processes.plugin", "strain"]


@pytest.fixture
def bus(ends: ExitStack) -> Bus:
    bus = Bus()
    ends.callback(bus.close)
    return bus


@pytest.fixture
def start_bridge(
    programs: Programs,
    folder_for: Callable[[str], Path],
    ends: ExitStack,
    bus: Bus,
    robot: Robot,
) -> Callable[..., Bridge]:
    """Start a bridge to the robot, with more options."""

    def start(*options: str) -> Bridge:
        bridge = Bridge(programs, folder_for("bridge"), bus, robot.address, *options)
        ends.callback(bridge.end)
        return bridge

    return start


@pytest.fixture
def armed(start_bridge: Callable[..., Bridge]) -> Bridge:
    """A bridge that waits for drive commands."""
    return start_bridge("--enable-drive").arms()


@pytest.fixture
def plan(tmp_path: Path, ends: ExitStack, bus: Bus) -> Callable[..., Planner]:
    """Start a planner, and wait until its first command is on the bus."""

    def start(**options: object) -> Planner:
        planner = Planner(sys.executable, tmp_path, bus, **options)
        ends.callback(planner.end)
        planner.says("planning")
        return planner

    return start


@pytest.fixture
def willing(start_bridge: Callable[..., Bridge]) -> Bridge:
    """A bridge that takes all kinds of command."""
    return start_bridge("--enable-drive", "--enable-outputs", "--enable-relocalize").arms()
