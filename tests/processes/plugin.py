# SPDX-License-Identifier: MIT
"""For pytest: robots and programs for each test, and an end for all of them after it."""

import tempfile
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
def folder_for(tmp_path: Path) -> Callable[[str], Path]:
    """A new folder for each program of a name."""
    return lambda name: Path(tempfile.mkdtemp(prefix=name, dir=tmp_path))


@pytest.fixture
def start_robot(
    programs: Programs, folder_for: Callable[[str], Path], ends: ExitStack
) -> Callable[..., Robot]:
    def start(*options: str) -> Robot:
        robot = Robot(programs, folder_for("robot"), *options)
        ends.callback(robot.close)
        return robot

    return start


@pytest.fixture
def robot(start_robot: Callable[..., Robot]) -> Robot:
    return start_robot()


@pytest.fixture
def run(folder_for: Callable[[str], Path], ends: ExitStack) -> Callable[..., Program]:
    """Run any program; what still runs at the end is ended."""

    def start(*command: str | Path, **environment: str) -> Program:
        program = Program(folder_for("program") / "log", *command, environment=environment)
        ends.callback(program.end)
        return program

    return start
