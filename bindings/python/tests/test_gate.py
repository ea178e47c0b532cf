# SPDX-License-Identifier: MIT
"""Which commands of a network reach the robot, and which do not; all of it in virtual time."""

from collections.abc import Iterator

import pytest

from roburoc4 import Robot, Simulator
from roburoc4.gate import DriveCommand, Gate, Rejection, Verdict

EPOCH_S = 1_790_000_000
PERIOD_S = 0.05
PAUSE_S = 0.5


class Network:
    """A gate, and commands that reach it without delay."""

    def __init__(self, simulator: Simulator, robot: Robot) -> None:
        self.simulator = simulator
        self.robot = robot
        self.set_by_s = 0.0
        self.gate = Gate(robot, enabled=True, utc_us=lambda: round(self.utc_s * 1e6))

    @property
    def utc_s(self) -> float:
        return EPOCH_S + self.simulator.now_s + self.set_by_s

    def step(self, seconds: float) -> None:
        end_s = self.simulator.now_s + seconds
        while (left_s := end_s - self.simulator.now_s) > 1e-6:
            self.simulator.step(min(0.01, left_s))
            self.gate.look(0.01)

    def pause(self) -> None:
        self.step(PAUSE_S + 0.2)

    def send(self, age_s: float = 0.0) -> Rejection | None:
        stamp_us = round((self.utc_s - age_s) * 1e6)
        return self.gate.drive(DriveCommand("nav", stamp_us, 0.3, 0.0))

    def stream(self, seconds: float, age_s: float = 0.0) -> Rejection | None:
        """Send a command every 50 ms; return the gate's answer to the last one."""
        last = None
        for _ in range(round(seconds / PERIOD_S)):
            self.step(PERIOD_S)
            last = self.send(age_s)
        return last


def verdict(rejection: Rejection | None) -> Verdict:
    return Verdict.TAKEN if rejection is None else rejection.verdict


@pytest.fixture
def network(roburoc4_simulator: Simulator) -> Iterator[Network]:
    with roburoc4_simulator.connect() as robot:
        network = Network(roburoc4_simulator, robot)
        network.pause()
        yield network


@pytest.mark.parametrize("age_s", [0.25, -0.25])
def test_an_old_stamp_or_one_of_the_future_moves_nothing(network: Network, age_s: float) -> None:
    assert verdict(network.stream(1.0, age_s=age_s)) in {Verdict.TOO_OLD, Verdict.IN_FUTURE}
    assert network.simulator.state.speed_commands == 0


def test_a_hang_is_no_pause_and_what_came_meanwhile_is_old(network: Network) -> None:
    network.gate.stop("anyone")
    network.step(0.1)
    network.simulator.step(5.0)  # nobody looks
    assert network.gate.look(0.01) == 0
    assert network.gate.is_waiting
    network.pause()
    network.simulator.step(1.0)
    network.gate.look(0.01)
    assert verdict(network.send()) is Verdict.TOO_OLD
    network.step(0.3)
    assert network.send() is None


def test_a_clock_that_was_set_holds(network: Network) -> None:
    network.stream(0.5)
    network.set_by_s = 7200.0
    assert network.gate.look() == pytest.approx(7200.0)
    assert verdict(network.stream(2.0)) in {Verdict.STARTING, Verdict.DISARMED}
    network.pause()
    assert network.send() is None


def test_commands_are_counted(network: Network) -> None:
    network.send()
    network.gate.stop("anyone")
    network.step(PERIOD_S)
    network.send()
    network.gate.reject(Verdict.MALFORMED, "nav")
    counts = network.gate.counts
    assert counts[:2] == (1, 1)
    rejected = {verdict: count for verdict, count in counts.rejected.items() if count}
    assert rejected == {Verdict.DISARMED: 1, Verdict.MALFORMED: 1}


def test_a_closed_robot_is_not_commanded(network: Network) -> None:
    network.robot.close()
    assert verdict(network.send()) is Verdict.NOT_READY
