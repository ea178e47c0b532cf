# SPDX-License-Identifier: MIT
"""Robots, networks, bridges and planners for each test, and an end for all of them after it."""

import sys
from collections.abc import Callable, Generator, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from rig import Bridge, Bus, MachineTooBusyError, Planner, Program, Programs, Robot, Strain

strain = Strain()


def explained(item: pytest.Item) -> Generator[None, object, object]:
    """A step of a test, whose failure on a machine that was too busy is reported as that."""
    try:
        return (yield)
    except Exception as error:
        why = strain.found(getattr(item, "funcargs", {}).get("tmp_path"))
        if why:
            raise MachineTooBusyError(why) from error
        raise


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup(item: pytest.Item) -> Generator[None, object, object]:
    strain.begin()
    return (yield from explained(item))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, object, object]:
    return (yield from explained(item))


@pytest.fixture(scope="session")
def programs() -> Programs:
    return Programs()


@pytest.fixture
def ends() -> Iterator[ExitStack]:
    """What is to be ended when the test is over, the latest first."""
    with ExitStack() as stack:
        yield stack


@pytest.fixture
def bus(ends: ExitStack) -> Bus:
    bus = Bus()
    ends.callback(bus.close)
    return bus


@pytest.fixture
def start_robot(programs: Programs, tmp_path: Path, ends: ExitStack) -> Callable[..., Robot]:
    started: list[Robot] = []

    def start(*options: str) -> Robot:
        robot = Robot(programs, tmp_path / f"robot{len(started)}", *options)
        started.append(robot)
        ends.callback(robot.close)
        return robot

    return start


@pytest.fixture
def robot(start_robot: Callable[..., Robot]) -> Robot:
    return start_robot()


@pytest.fixture
def run(tmp_path: Path, ends: ExitStack) -> Callable[..., Program]:
    """Run any program; what still runs at the end is ended."""
    started: list[Program] = []

    def start(*command: str | Path, **environment: str) -> Program:
        program = Program(
            tmp_path / f"program{len(started)}.log", *command, environment=environment
        )
        started.append(program)
        ends.callback(program.end)
        return program

    return start


@pytest.fixture
def start_bridge(
    programs: Programs, tmp_path: Path, ends: ExitStack, bus: Bus, robot: Robot
) -> Callable[..., Bridge]:
    """Start a bridge to the robot, with more options."""
    count = 0

    def start(
        *options: str, address: str = robot.address, environment: dict[str, str] | None = None
    ) -> Bridge:
        nonlocal count
        count += 1
        folder = tmp_path / f"bridge{count}"
        folder.mkdir()
        bridge = Bridge(programs, folder, bus, address, *options, environment=environment)
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
