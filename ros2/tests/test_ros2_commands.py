# SPDX-License-Identifier: MIT
"""What messages of ROS 2 make the robot do; in virtual time, without DDS."""

import math
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from roburoc4 import Robot, Simulator
from roburoc4_ros2.commands import Commands, DriveConfig, Sender
from roburoc4_tools.ros.state import diagnoses

EPOCH_S = 1_790_000_000
NAV = Sender("aa", "/nav/controller")
JOY = Sender("bb", "/teleop")


class Topics:
    """Messages that come to a robot at once."""

    def __init__(self, simulator: Simulator, robot: Robot, **config: Any) -> None:
        self.simulator = simulator
        self.notes: list[str] = []
        settings = DriveConfig(**({"enabled": True} | config))
        self.commands = Commands(robot, settings, self.notes.append, self.utc_us)

    def utc_us(self) -> int:
        return round((EPOCH_S + self.simulator.now_s) * 1e6)

    def step(self, seconds: float) -> None:
        for _ in range(round(seconds / 0.01)):
            self.simulator.step(0.01)
            self.commands.look(0.01)

    def stamped(
        self, linear: float, angular: float = 0.0, age_s: float = 0.0, **axes: float
    ) -> Any:
        sec, us = divmod(self.utc_us() - round(age_s * 1e6), 1_000_000)
        stamp = SimpleNamespace(sec=sec, nanosec=us * 1000)
        return SimpleNamespace(
            header=SimpleNamespace(stamp=stamp, frame_id=""), twist=twist(linear, angular, **axes)
        )

    def send(self, message: Any, sender: Sender = NAV) -> None:
        self.commands.drive(sender, message, self.utc_us())

    @property
    def speeds(self) -> tuple[float, float]:
        """That were sent to the robot last."""
        state = self.simulator.state
        return round(state.last_linear_m_s, 3), round(state.last_angular_rad_s, 3)


def twist(linear: float, angular: float = 0.0, **axes: float) -> Any:
    values = {"linear_x": linear, "angular_z": angular} | axes
    parts = (
        SimpleNamespace(**{axis: values.get(f"{part}_{axis}", 0.0) for axis in "xyz"})
        for part in ("linear", "angular")
    )
    return SimpleNamespace(linear=next(parts), angular=next(parts))


@pytest.fixture
def robot(roburoc4_simulator: Simulator) -> Iterator[Robot]:
    with roburoc4_simulator.connect() as robot:
        yield robot


@pytest.fixture
def topics(roburoc4_simulator: Simulator, robot: Robot) -> Topics:
    topics = Topics(roburoc4_simulator, robot)
    topics.step(0.8)
    return topics


def test_a_twist_stamped_drives_for_the_lease(topics: Topics) -> None:
    topics.send(topics.stamped(0.3, -0.2))
    topics.step(0.2)
    assert topics.speeds == (0.3, -0.2)
    topics.step(0.1)
    assert topics.speeds == (0.0, 0.0)


def test_an_old_stamp_moves_nothing_and_is_told_once(topics: Topics) -> None:
    for _ in range(40):
        topics.step(0.05)
        topics.send(topics.stamped(0.3, age_s=0.3))
    assert topics.simulator.state.speed_commands == 0
    assert len(topics.notes) == 1
    assert topics.notes[0].startswith("cmd_vel of /nav/controller rejected: by its stamp it is 0.3")
    assert topics.notes[0].count("--max-age-ms") == 2


def test_a_stamp_that_comes_again_is_obeyed_until_it_is_too_old(topics: Topics) -> None:
    message = topics.stamped(0.3)
    for _ in range(4):
        topics.send(message)
        topics.step(0.05)
    assert topics.speeds == (0.3, 0.0)
    assert topics.notes == []
    for _ in range(10):
        topics.send(message)
        topics.step(0.05)
    assert topics.speeds == (0.0, 0.0)


def test_a_twist_without_a_stamp_is_as_old_as_dds_says(
    roburoc4_simulator: Simulator, robot: Robot
) -> None:
    topics = Topics(roburoc4_simulator, robot, stamped=False)
    topics.step(0.8)
    topics.commands.drive(NAV, twist(0.3), topics.utc_us() - 1_000_000)
    assert "1.000 s old" in topics.notes[-1]
    topics.step(0.05)
    topics.send(twist(0.3))
    topics.step(0.05)
    assert topics.speeds == (0.3, 0.0)


@pytest.mark.parametrize(("axis", "value"), [("linear_y", math.nan), ("angular_z", math.inf)])
def test_nan_anywhere_in_a_message_is_refused(topics: Topics, axis: str, value: float) -> None:
    topics.send(topics.stamped(0.3, **{axis: value}))
    topics.step(0.05)
    assert topics.simulator.state.speed_commands == 0
    assert "NaN or infinity" in topics.notes[-1]


def test_speeds_that_the_robot_cannot_have_are_ignored(topics: Topics) -> None:
    topics.send(topics.stamped(0.3, linear_y=0.5, linear_z=0.1, angular_x=1.0, angular_y=1.0))
    topics.step(0.05)
    assert topics.speeds == (0.3, 0.0)
    topics.send(topics.stamped(0.0, linear_y=0.5))
    topics.step(0.05)
    assert topics.speeds == (0.0, 0.0)


def test_a_speed_beyond_a_ceiling_is_reduced_to_it(
    roburoc4_simulator: Simulator, robot: Robot
) -> None:
    topics = Topics(roburoc4_simulator, robot, max_linear_m_s=0.2, max_angular_rad_s=0.3)
    topics.step(0.8)
    for sign in (1.0, -1.0):
        topics.send(topics.stamped(sign * 0.4, sign * 0.9))
        topics.step(0.05)
        assert topics.speeds == (sign * 0.2, sign * 0.3)


def test_diagnostics_show_an_override_that_nobody_knows_as_unknown(
    roburoc4_simulator: Simulator,
) -> None:
    with roburoc4_simulator.connect(override_index=63) as robot:
        robot.sleep(0.5)
        found = {one.name: one.values for one in diagnoses(robot, "red")}
    assert found["red: driving"]["overridden"] == "unknown"


def test_a_second_publisher_is_refused_and_both_are_named(topics: Topics) -> None:
    topics.send(topics.stamped(0.3))
    topics.step(0.05)
    topics.send(topics.stamped(-0.3), JOY)
    topics.step(0.05)
    assert topics.speeds == (0.3, 0.0)
    assert topics.notes[-1].startswith("cmd_vel of /teleop rejected: another sender is in control")
    assert topics.notes[-1].endswith("in control: /nav/controller")
    assert topics.commands.state.in_control == "/nav/controller"


def test_a_name_does_not_command_the_terminal(topics: Topics) -> None:
    topics.send(topics.stamped(math.nan), Sender("cc", "/evil\x1b[2J\nstopped"))
    assert topics.notes[-1].startswith("cmd_vel of /evil?[2J?stopped rejected")


def test_without_enable_drive_a_stop_is_obeyed_and_nothing_else(
    roburoc4_simulator: Simulator, robot: Robot
) -> None:
    topics = Topics(roburoc4_simulator, robot, enabled=False)
    topics.step(0.8)
    topics.send(topics.stamped(0.3))
    topics.step(0.1)
    assert topics.simulator.state.speed_commands == 0
    robot.arm()
    robot.drive(0.3, 0.0, lease_s=1.0)
    topics.step(0.05)
    topics.commands.stop(JOY)
    topics.step(0.05)
    assert topics.speeds == (0.0, 0.0)


def test_diagnostics_name_who_drives_and_what_was_rejected(topics: Topics) -> None:
    assert topics.commands.state.diagnosis("red").message == "commands drive the robot"
    topics.send(topics.stamped(0.3))
    topics.send(topics.stamped(0.3), JOY)
    topics.step(0.05)
    found = topics.commands.state.diagnosis("red")
    assert (found.level, found.name) == (1, "red: commands")
    assert found.message.startswith("rejected: /teleop: another sender is in control")
    assert found.values["in_control"] == "/nav/controller"
    assert (found.values["obeyed"], found.values["rejected"]) == ("1", "1")
    topics.step(6.0)
    assert topics.commands.state.diagnosis("red").level == 0


def test_a_slope_limits_growing_but_not_slowing_down(
    roburoc4_simulator: Simulator, robot: Robot
) -> None:
    topics = Topics(roburoc4_simulator, robot, max_linear_m_s2=0.5)
    topics.step(0.8)
    found = []
    for _ in range(10):
        topics.send(topics.stamped(1.0))
        topics.step(0.05)
        found.append(topics.speeds[0])
    assert found == pytest.approx([0.025 * n for n in range(1, 11)], abs=0.002)
    topics.send(topics.stamped(-1.0))
    topics.step(0.05)
    assert topics.speeds[0] == pytest.approx(-0.025, abs=0.002)
    topics.send(topics.stamped(0.0))
    topics.step(0.05)
    assert topics.speeds == (0.0, 0.0)


@pytest.mark.parametrize("scale", [0.8, 1.2])
def test_a_slope_is_that_of_a_calibrated_robot(roburoc4_simulator: Simulator, scale: float) -> None:
    with roburoc4_simulator.connect(scale_linear=scale, scale_angular=scale) as robot:
        slope = {"max_linear_m_s2": 0.5, "max_angular_rad_s2": 0.5}
        topics = Topics(roburoc4_simulator, robot, **slope, scale_linear=scale, scale_angular=scale)
        topics.step(0.8)
        for n in range(1, 11):
            topics.send(topics.stamped(0.8, 0.8))
            topics.step(0.05)
            assert topics.speeds == pytest.approx((scale * 0.025 * n,) * 2, abs=0.002)


def test_a_publisher_slower_than_the_lease_is_told(topics: Topics) -> None:
    for _ in range(5):
        topics.send(topics.stamped(0.3))
        topics.step(0.5)
    (note,) = topics.notes
    assert note.startswith("cmd_vel of /nav/controller comes every 500 ms, but holds for 250 ms")
    assert topics.commands.state.diagnosis("red").message == note


def test_a_refusal_names_its_cause(topics: Topics, robot: Robot) -> None:
    topics.simulator.panel("pad a down")
    topics.step(0.3)
    topics.send(topics.stamped(0.3))
    assert "release [A]" in topics.notes[-1]
    topics.simulator.panel("pad a up")
    topics.step(1.0)
    topics.simulator.set("estop_local", 1)
    for _ in range(60):
        topics.send(topics.stamped(0.3))
        topics.step(0.05)
    assert "check emergency stops, brakes selector and bumpers" in topics.notes[-1]
    assert topics.commands.state.diagnosis("red").level == 1


@pytest.mark.parametrize("later_s", [0.0, 0.03])
def test_a_stop_that_loses_against_another_commander_says_so_once(
    topics: Topics, later_s: float
) -> None:
    with topics.simulator.connect() as other:
        other.arm()
        for at in range(300):
            other.drive(0.3, 0.0)
            topics.step(later_s)
            if at % 10 == 0 and 60 <= at < 260:
                topics.commands.stop(JOY)
            topics.step(0.05 - later_s)
    (note,) = [note for note in topics.notes if "another commander" in note]
    assert note.startswith("stopped by /teleop, but")
    (note,) = [note for note in topics.notes if note.startswith("stopped by /teleop: ")]
