# SPDX-License-Identifier: MIT
"""Calibration of a robot whose wheels slip; that it drives true then, the core's tests show."""

import io
from collections.abc import Iterator

import pytest

from roburoc4 import ArgumentError, Simulator
from roburoc4_tools.cli.driving import calibrate
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
        self.questions = 0

    def readline(self) -> str:
        self.questions += 1
        if self.questions == 1:
            return f"{self.sim.true_pose.x_m - self.x_m:.3f}\n"
        # A tape measure and a mark: two turns, less what the wheels slipped.
        return f"{720 * (1 - SLIP):.1f}\n"


def test_the_scales_are_what_the_robot_counts_by_what_it_really_did(
    sim: Simulator, monkeypatch: pytest.MonkeyPatch
) -> None:
    with sim.connect() as robot:
        robot.arm()
        monkeypatch.setattr("sys.stdin", Observer(sim))
        scale_linear, scale_angular = calibrate.measure(robot, options())
    assert scale_linear == pytest.approx(1.0, abs=0.02)
    assert scale_angular == pytest.approx(1 / (1 - SLIP), abs=0.01)


def test_an_answer_that_is_no_measurement_writes_nothing(
    sim: Simulator, monkeypatch: pytest.MonkeyPatch
) -> None:
    for answer in ("", "two", "nan", "0", "0.1"):
        with sim.connect() as robot:
            robot.arm()
            monkeypatch.setattr("sys.stdin", io.StringIO(answer + "\n" + "720\n" * 2))
            with pytest.raises((CommandError, ArgumentError)):
                calibrate.measure(robot, options())
