# SPDX-License-Identifier: MIT
"""A robot file configures clients and simulators, and a bad one names line and remedy."""

from pathlib import Path

import pytest

from roburoc4 import ArgumentError, Simulator, robot_file

KNOWN = {"override_index": 10.0, "robot_watchdog_ms": 500.0, "linear_gain": 0.95, "iocard_id": 9.0}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "robot.txt"
    robot_file.save(path, KNOWN)
    return path


def test_what_is_read_is_what_was_written(file: Path) -> None:
    assert robot_file.load(file) == KNOWN


def test_the_next_program_drives_the_robot_of_its_file(file: Path) -> None:
    with Simulator(robot_file=file) as sim, sim.connect(robot_file=file) as robot:
        robot.arm()
        robot.drive_for(0.2, 0.0, seconds=3)
        assert robot.properties.services[2].id == 9
        sim.set("pad_a", 1)
        robot.sleep(0.5)
        assert robot.facts.overridden


def test_an_argument_takes_precedence(file: Path) -> None:
    with (
        Simulator(robot_file=file, iocard_id=12) as sim,
        sim.connect(iocard_id=12, robot_file=file) as robot,
    ):
        assert robot.properties.services[2].id == 12
        robot.arm()


@pytest.mark.parametrize(
    ("text", "remedy"),
    [
        ("", "line 1: nothing is known"),
        ("override_index = 8\nwatchdog = 1\n", "line 2: no such name"),
        ("override_index = 64\n", "line 1: override_index: give a whole number, 0 to 63"),
    ],
)
def test_a_bad_file_names_line_and_remedy(file: Path, text: str, remedy: str) -> None:
    file.write_text(text)
    with pytest.raises(ArgumentError, match=remedy):
        robot_file.load(file)
    with Simulator() as sim, pytest.raises(ArgumentError, match=f"robot_file: .*{remedy}"):
        sim.connect(robot_file=file)


def test_what_cannot_be_in_a_file_is_refused(tmp_path: Path) -> None:
    for values in ({"nonsense": 1.0}, {"override_index": 0.5}):
        with pytest.raises(ArgumentError):
            robot_file.save(tmp_path / "robot.txt", values)
        assert not any(robot_file.can_hold(*each) for each in values.items())
    assert all(robot_file.can_hold(*each) for each in KNOWN.items())
