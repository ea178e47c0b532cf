# SPDX-License-Identifier: MIT
"""For pytest: robots and programs for each test, and an end for all of them after it."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from .process import Program
from .programs import Programs
from .robot import Robot


@pytest.fixture(scope="session")
def programs() -> Programs:
    return Programs()


@pytest.fixture
def ends() -> Iterator[ExitStack]:
    """What is to be ended when the test is over, the latest first."""
    with ExitStack() as stack:
        yield stack


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
