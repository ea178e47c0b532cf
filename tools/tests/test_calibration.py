# SPDX-License-Identifier: MIT
"""A robot whose wheels slip really drives what moves promise, once it is calibrated."""

import io
import math
from collections.abc import Iterator
from pathlib import Path

import pytest

from roburoc4 import ArgumentError, Simulator, robot_file
from roburoc4_tools.cli import calibrate
from roburoc4_tools.cli.errors import CommandError
from roburoc4_tools.cli.options import Options

SLIP = 0.12


@pytest.fixture
def sim() -> Iterator[Simulator]:
    with Simulator(slip=SLIP) as simulator:
        simulator.clear_obstacles()
        yield simulator


def options() -> Options:
    return Options(metres=2.0, turns=2.0, clearance=None, timeout=None)


class Observer:
    """A person who measures what the robot really did since the last question."""

    def __init__(self, sim: Simulator) -> None:
        self.sim = sim
        self.x_m = sim.true_pose.x_m
        self.turned_rad = 0.0
        self.questions = 0

    def readline(self) -> str:
        self.questions += 1
        if self.questions == 1:
            return f"{self.sim.true_pose.x_m - self.x_m:.3f}\n"
        # A tape measure and a mark: two turns, less what the wheels slipped.
        return f"{720 * (1 - SLIP):.1f}\n"


def test_the_square_of_a_calibrated_robot_really_closes(
    sim: Simulator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "robot.txt"
    with sim.connect() as robot:
        robot.arm()
        monkeypatch.setattr("sys.stdin", Observer(sim))
        scale_linear, scale_angular = calibrate.measure(robot, options())
    assert scale_linear == pytest.approx(1.0, abs=0.02)
    assert scale_angular == pytest.approx(1 / (1 - SLIP), abs=0.01)
    robot_file.save(file, {"scale_linear": scale_linear, "scale_angular": scale_angular})

    with sim.connect(robot_file=file) as robot:
        robot.arm()
        begin = sim.true_pose
        for _side in range(4):
            robot.move(2.0)
            robot.turn(math.pi / 2)
        end = sim.true_pose
    assert math.hypot(end.x_m - begin.x_m, end.y_m - begin.y_m) < 0.15


def test_an_answer_that_is_no_measurement_writes_nothing(
    sim: Simulator, monkeypatch: pytest.MonkeyPatch
) -> None:
    for answer in ("", "two", "nan", "0", "0.1"):
        with sim.connect() as robot:
            robot.arm()
            monkeypatch.setattr("sys.stdin", io.StringIO(answer + "\n" + "720\n" * 2))
            with pytest.raises((CommandError, ArgumentError)):
                calibrate.measure(robot, options())
