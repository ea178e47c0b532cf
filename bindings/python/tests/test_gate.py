# SPDX-License-Identifier: MIT
"""Which commands of a network reach the robot, and which do not; all of it in virtual time."""

import math
from collections.abc import Callable, Iterator

import pytest

from roburoc4 import Robot, Simulator
from roburoc4._gate import DriveCommand, Gate, Rejection, Verdict

EPOCH_S = 1_790_000_000
PERIOD_S = 0.05
PAUSE_S = 0.5


class Network:
    """A gate, and commands that reach it without delay."""

    def __init__(self, simulator: Simulator, robot: Robot, *, enabled: bool = True) -> None:
        self.simulator = simulator
        self.robot = robot
        self.set_by_s = 0.0
        self.gate = Gate(robot, enabled=enabled, utc_us=lambda: round(self.utc_s * 1e6))

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

    def send(
        self, linear: float = 0.3, angular: float = 0.0, *, sender: str = "nav", age_s: float = 0.0
    ) -> Rejection | None:
        stamp_us = round((self.utc_s - age_s) * 1e6)
        return self.gate.drive(DriveCommand(sender, stamp_us, linear, angular))

    def stream(self, seconds: float, **command: float) -> Rejection | None:
        """Send a command every 50 ms; return what the gate said to the last one."""
        last = None
        for _ in range(round(seconds / PERIOD_S)):
            self.step(PERIOD_S)
            last = self.send(**command)  # type: ignore[arg-type]
        return last

    @property
    def speed_m_s(self) -> float:
        """The linear speed that was sent to the robot last."""
        return self.simulator.state.last_linear_m_s


def verdict(rejection: Rejection | None) -> Verdict:
    return Verdict.TAKEN if rejection is None else rejection.verdict


@pytest.fixture
def network(roburoc4_simulator: Simulator) -> Iterator[Network]:
    with roburoc4_simulator.connect() as robot:
        network = Network(roburoc4_simulator, robot)
        network.pause()
        yield network


def test_a_command_drives_for_its_lease(network: Network) -> None:
    assert network.send() is None
    network.step(0.24)
    assert network.speed_m_s == pytest.approx(0.3)
    network.step(0.02)
    assert network.speed_m_s == 0


def test_a_gate_that_is_not_enabled_lets_only_stops_through(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        network = Network(roburoc4_simulator, robot, enabled=False)
        network.pause()
        rejection = network.stream(1.0)
        assert rejection is not None
        assert "--enable-drive" in rejection.why
        robot.arm()
        robot.drive(0.3, 0.0, lease_ms=1000)
        network.step(0.1)
        assert network.speed_m_s == pytest.approx(0.3)
        network.gate.stop("anyone")
        network.step(0.1)
        assert network.speed_m_s == 0


@pytest.mark.parametrize("age_s", [0.25, 3600.0, -0.25, -1e9])
def test_an_old_stamp_or_one_of_the_future_moves_nothing(network: Network, age_s: float) -> None:
    assert verdict(network.stream(1.0, age_s=age_s)) in {Verdict.TOO_OLD, Verdict.IN_FUTURE}
    assert network.simulator.state.speed_commands == 0


def test_a_replayed_bag_moves_nothing(network: Network) -> None:
    bag = []
    for _ in range(20):
        network.step(PERIOD_S)
        assert network.send() is None
        bag.append(round(network.utc_s * 1e6))
    network.pause()
    network.step(5.0)
    before = network.simulator.state.speed_commands
    for stamp_us in bag:
        network.step(PERIOD_S)
        replayed = DriveCommand("player", stamp_us, 0.3, 0.0)
        assert verdict(network.gate.drive(replayed)) is Verdict.TOO_OLD
    assert network.simulator.state.speed_commands == before


def test_a_stamp_that_is_missing_is_refused(network: Network) -> None:
    rejection = network.gate.drive(DriveCommand("nav", 0, 0.3, 0.0))
    assert rejection is not None
    assert rejection.why == "its stamp is 0 or less; set it to the time at which it is sent"


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_refused(network: Network, bad: float) -> None:
    network.step(PERIOD_S)
    assert verdict(network.send(bad)) is Verdict.NOT_FINITE
    assert verdict(network.send(0.3, bad)) is Verdict.NOT_FINITE
    broken = DriveCommand("nav", round(network.utc_s * 1e6), 0.3, 0.0, finite=False)
    assert verdict(network.gate.drive(broken)) is Verdict.NOT_FINITE
    assert network.simulator.state.speed_commands == 0


def test_speeds_beyond_all_limits_are_clamped(network: Network) -> None:
    assert network.send(1e300) is None
    network.step(0.1)
    assert network.speed_m_s == pytest.approx(2.6)


def test_one_sender_has_control_until_its_lease_ends(network: Network) -> None:
    assert network.send() is None
    assert network.gate.owner == "nav"
    network.step(PERIOD_S)
    rejection = network.send(-0.3, sender="joy")
    assert rejection is not None
    assert rejection.verdict is Verdict.CONTROL
    assert rejection.sender == "joy"
    network.step(0.1)
    assert network.speed_m_s == pytest.approx(0.3)
    network.step(0.15)
    assert network.gate.owner == ""
    assert network.send(-0.3, sender="joy") is None


def test_a_stop_is_obeyed_from_anyone_and_holds(network: Network) -> None:
    network.stream(0.5)
    network.gate.stop("anyone")
    network.step(PERIOD_S)
    assert network.speed_m_s == 0
    rejection = network.stream(2.0)
    assert rejection is not None
    assert rejection.verdict is Verdict.DISARMED
    assert "pause" in rejection.why
    assert network.speed_m_s == 0
    network.pause()
    assert network.send() is None


def _override(network: Network) -> None:
    with network.simulator.held("pad_a"):
        network.stream(0.5)


def _emergency_stop(network: Network) -> None:
    with network.simulator.held("estop_local"):
        network.stream(2.0)


def _loss(network: Network) -> None:
    network.simulator.set_faults(loss=1.0)
    network.stream(3.0)
    network.simulator.set_faults()


def _reboot(network: Network) -> None:
    network.simulator.reboot()
    network.stream(5.0)


@pytest.mark.parametrize("happening", [_override, _emergency_stop, _loss, _reboot])
def test_after_it_a_stream_is_held_until_it_paused(
    network: Network, happening: Callable[[Network], None]
) -> None:
    network.stream(0.5)
    happening(network)
    network.step(0.3)
    before = network.simulator.state.speed_commands
    assert network.stream(5.0) is not None
    assert network.simulator.state.speed_commands == before
    network.step(3.0)
    assert network.send() is None
    network.step(0.1)
    assert network.speed_m_s == pytest.approx(0.3)


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


def test_rejections_of_one_cause_are_one_incident(network: Network) -> None:
    incidents = 0
    for _ in range(100):
        network.step(PERIOD_S)
        rejection = network.send(age_s=1.0)
        incidents += rejection is not None and rejection.is_incident
    assert incidents == 1
    network.step(6.0)
    rejection = network.send(age_s=1.0)
    assert rejection is not None
    assert rejection.is_incident


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
