# SPDX-License-Identifier: MIT
"""What lets a robot move, and what stops it; all of it in virtual time."""

import math

import pytest

import roburoc4
from roburoc4 import Event, Result, Simulator, StopOutcome


def test_drive_while_disarmed_names_cause_and_remedy(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        with pytest.raises(roburoc4.NotArmedError, match=r"arm\(\)") as caught:
            robot.drive(0.5, 0.0)
        assert caught.value.code == Result.DISARMED
        robot.sleep(1.0)
    assert roburoc4_simulator.state.speed_commands == 0


def test_arm_waits_for_what_the_next_status_brings(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        assert robot.facts.arm_refusal == Result.STALE_DIFFERENTIAL
        robot.arm()
        assert robot.facts.armed


def test_stop_sends_zeros_and_disarms(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        robot.arm()
        robot.drive(0.5, 0.0)
        roburoc4_simulator.step(0.1)
        robot.stop()
        assert roburoc4_simulator.state.last_linear_m_s == 0
        assert not robot.facts.armed
        assert robot.facts.disarm_cause == Result.STOP_CALLED
        assert robot.facts.stop_outcome is StopOutcome.RUNNING
        robot.wait_for(Event.STOP_CONFIRMED)
        assert robot.facts.stop_outcome is StopOutcome.CONFIRMED
        with pytest.raises(roburoc4.NotArmedError, match=r"arm\(\)") as caught:
            robot.drive(0.2, 0.0)
        assert caught.value.code == Result.STOP_CALLED


def test_pause_sends_zeros_and_keeps_the_arming(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        robot.arm()
        robot.drive(0.5, 0.0)
        roburoc4_simulator.step(0.1)
        robot.pause()
        assert roburoc4_simulator.state.last_linear_m_s == 0
        robot.wait_for(lambda r: not r.facts.stopping)
        robot.sleep(5.0)
        robot.drive(0.2, 0.0)
        assert roburoc4_simulator.state.last_linear_m_s > 0


@pytest.mark.parametrize(("hang_s", "armed"), [(0.6, True), (8.0, False)])
def test_drive_for_ends_when_its_lease_lapsed(
    roburoc4_simulator: Simulator, hang_s: float, armed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    with roburoc4_simulator.connect() as robot:
        sleep = robot.sleep
        robot.arm()
        monkeypatch.setattr(robot, "sleep", lambda _: sleep(hang_s))
        with pytest.raises(roburoc4.RobotError) as caught:
            robot.drive_for(0.3, 0.0, seconds=60)
        assert caught.value.code == Result.LAPSED
        commands = roburoc4_simulator.state.nonzero_speed_commands
        assert robot.facts.armed == armed
        sleep(2)
        assert roburoc4_simulator.state.nonzero_speed_commands == commands


@pytest.mark.parametrize(
    ("speeds", "text"), [((300, 0), "linear_m_s: 300 .*not mm/s"), ((0, 45), "not degrees")]
)
def test_mistakes_of_units_are_refused(
    roburoc4_simulator: Simulator, speeds: tuple[float, float], text: str
) -> None:
    with roburoc4_simulator.connect() as robot:
        robot.arm()
        for drive in (robot.drive, lambda *s: robot.drive_for(*s, seconds=1)):
            with pytest.raises(roburoc4.ArgumentError, match=text) as caught:
                drive(*speeds)
            assert caught.value.code == Result.UNITS
        assert robot.facts.armed
        assert roburoc4_simulator.state.nonzero_speed_commands == 0
        with pytest.raises(roburoc4.ArgumentError, match=r"speed: 300 .* 5 m/s"):
            robot.move(1.0, speed=300)
        with pytest.raises(roburoc4.ArgumentError, match=r"speed: 45 .* 10 rad/s"):
            robot.turn(1.0, speed=45)


def test_settings_bound_and_scale_speeds(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect(max_linear_m_s=0.3, scale_angular=0.5) as robot:
        robot.arm()
        robot.drive(2.0, 1.0)
        assert math.isclose(roburoc4_simulator.state.last_linear_m_s, 0.3, rel_tol=1e-6)
        assert math.isclose(roburoc4_simulator.state.last_angular_rad_s, 0.5, rel_tol=1e-6)


def test_drive_for_ends_with_zero_on_any_exception(roburoc4_simulator: Simulator) -> None:
    class OddError(Exception):
        pass

    with roburoc4_simulator.connect() as robot:
        robot.arm()
        robot.sleep = lambda seconds: (_ for _ in ()).throw(OddError)  # type: ignore[method-assign, assignment]
        with pytest.raises(OddError):
            robot.drive_for(0.5, 0.0, seconds=1)
        assert roburoc4_simulator.state.last_linear_m_s == 0
