# SPDX-License-Identifier: MIT
"""First contact on the ground, with a robot whose wheels slip and miscount; its robot file."""

import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from unittest.mock import Mock, patch

import pytest

from roburoc4 import Robot, Simulator, connect, robot_file
from roburoc4_tools.cli.connecting import first_contact
from roburoc4_tools.cli.errors import CommandError
from roburoc4_tools.first_contact import bundle, ground
from roburoc4_tools.first_contact.contact import Contact
from roburoc4_tools.first_contact.session import ReleasedError, UnsafeError
from roburoc4_tools.recordings.capture import Capture

SLIP = 0.12
SAFETY = Path(__file__).parents[2] / "docs" / "SAFETY.md"


class Person:
    """Measures what the robot really did since the last question."""

    def __init__(self, sim: Simulator, robot: Robot) -> None:
        self.sim, self.robot = sim, robot
        self.at = sim.true_pose
        self.asked: list[str] = []

    def __call__(self, text: str) -> str:
        self.asked.append(text)
        assert self.robot.facts.armed is False
        before, self.at = self.at, self.sim.true_pose
        if "metres" in text:
            return f"{math.hypot(self.at.x_m - before.x_m, self.at.y_m - before.y_m):.3f}"
        if "degrees" in text:
            return f"{math.degrees(self.at.theta_rad - before.theta_rad):.1f}"
        return "yes"


def on_the_ground(
    held: Callable[[Simulator, Robot], bool] = lambda _sim, _robot: True, **settings: float
) -> tuple[dict[str, float], Simulator]:
    with Simulator(slip=SLIP, **settings) as sim:
        sim.clear_obstacles()
        with sim.connect(scale_linear=1.0, scale_angular=1.0) as robot:
            robot.arm()
            found: dict[str, float] = {}
            try:
                ground.drive(robot, lambda: held(sim, robot), Person(sim, robot), found)
            except ReleasedError:
                robot.rest()
                assert sim.state.last_linear_m_s == 0.0
                assert robot.facts.armed is False
                raise
            return found, sim


@pytest.mark.parametrize("scale", [0.8, 1.3])
def test_the_scales_are_what_the_robot_counts_by_what_it_really_did(scale: float) -> None:
    found, _sim = on_the_ground(odometry_scale=scale)
    assert found["scale_linear"] == pytest.approx(scale, abs=0.02)
    assert found["scale_angular"] == pytest.approx(scale / (1 - SLIP), abs=0.03)


def test_a_robot_that_sees_nothing_is_driven_by_people_who_do() -> None:
    found, _sim = on_the_ground(telemeters=0)
    assert found["scale_linear"] == pytest.approx(1.0, abs=0.02)


def test_the_stops_of_the_measured_robot_are_those_of_the_safety_page() -> None:
    found, _sim = on_the_ground()
    page = SAFETY.read_text(encoding="utf-8")
    ways = {float(v): float(m) for v, m in re.findall(r"^\| (\S+) m/s \| (\S+) m \|", page, re.M)}
    for speed, way_m in ((v, ways[v]) for v in (0.3, 0.6)):
        assert found[f"stops from {speed:g} m/s within, m"] == pytest.approx(way_m, abs=0.05)


@pytest.mark.parametrize(
    ("late", "what"),
    [
        ("queue_iocard_ms", "statuses of the iocard 220 ms, answers 10 ms"),
        ("queue_answer_ms", "answers 220 ms"),
    ],
)
def test_a_robot_that_the_library_would_not_drive_for_long_stays_off_the_ground(
    late: str, what: str
) -> None:
    known = {"queue_answer_ms": 10.0, late: 220.0}
    with Simulator(**{late: 220}) as sim, sim.connect() as robot:
        with pytest.raises(UnsafeError, match=f"older than 300 ms. Late are {what}"):
            ground.stay_armed(robot, known)
        assert sim.state.nonzero_speed_commands == 0
    with Simulator() as sim, sim.connect() as robot:
        ground.stay_armed(robot, known)


@pytest.mark.parametrize(
    ("late_ms", "answer", "lifted"), [(0, "", True), (1500, "no", False), (1500, "yes", True)]
)
def test_before_anybody_lifts_the_robot_it_says_whether_the_library_stays_armed(
    tmp_path: Path, late_ms: int, answer: str, lifted: bool
) -> None:
    contact, world = Contact(Mock(now_s=0.0)), Mock()
    contact.session.world.wait.return_value = []
    contact.session.known["queue_iocard_ms"] = late_ms
    world.ask.return_value = answer
    robot_file.save(tmp_path / "robot.txt", {"override_index": 8})
    with Simulator(port=0, queue_iocard_ms=late_ms) as sim, patch.object(ground, "_TRIES", 1):
        options = Mock(folder=tmp_path, robot=sim.address)
        assert first_contact._is_worth_lifting(contact, options, world) is lifted
        assert sim.state.nonzero_speed_commands == 0
    assert (contact.refused is None) is lifted
    asked = [call.args[1] for call in world.ask.call_args_list]
    assert len(asked) == (late_ms > 0)
    assert all("Late are statuses of the iocard 1500 ms. Where" in text for text in asked)
    assert "Do not lift the robot yet." in world.say.call_args_list[0].args[0]


def test_what_the_ground_showed_is_said_and_an_interruption_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    contact, world = Contact(Mock(now_s=0.0)), Mock()
    robot_file.save(tmp_path / "robot.txt", {"override_index": 8})

    def drive(_robot: Robot, _world: Mock, _ask: Mock, found: dict[str, float]) -> None:
        found |= {"scale_linear": 1.3, "stops from 0.3 m/s within, m": 0.2}
        raise KeyboardInterrupt

    with Simulator(port=0) as sim, patch.object(first_contact, "drive_on_the_ground", drive):
        options = Mock(folder=tmp_path, robot=sim.address)
        with pytest.raises(KeyboardInterrupt):
            first_contact._ground(contact, options, world, "drive.pcapng")
    said = [call.args[0] for call in world.say.call_args_list[1:]]
    assert said[0].startswith("  scale_linear = 1.3: way")
    assert said[1] == "  stops from 0.3 m/s within, m: 0.2"
    assert "the same command goes on" in capsys.readouterr().err


def test_before_it_is_lifted_down_people_mend_what_they_can_and_then_it_is_disarmed(
    tmp_path: Path,
) -> None:
    asked: list[str] = []
    with Simulator(port=0) as sim, sim.connect() as robot:
        sim.set("pad_a", 1)
        robot.sleep(0.5)
        world = Mock()

        def mend(key: str, text: str) -> None:
            asked.append(text)
            assert robot.facts.armed is False
            sim.set("pad_a", 0)
            robot.sleep(1.0)

        world.please.side_effect = mend
        first_contact.stand_armed(robot, world, {}, "Wait.")
        assert robot.facts.armed is False
    assert len(asked) == 1
    assert "not armed" in asked[0]


def test_it_does_not_drive_while_the_way_is_not_free() -> None:
    answers = ["no", "yes", "yes"]

    class Careful(Person):
        def __call__(self, text: str) -> str:
            answer = super().__call__(text)
            return answers.pop(0) if "way free" in text else answer

    with Simulator(slip=SLIP) as sim:
        sim.clear_obstacles()
        with sim.connect(scale_linear=1.0, scale_angular=1.0) as robot:
            robot.arm()
            person = Careful(sim, robot)
            ground.drive(robot, lambda: True, person, {})
    assert [text for text in person.asked if "0.3 m/s" in text] == [person.asked[2]] * 2
    assert answers == []


def test_a_robot_that_rolls_twice_as_far_stays_off_the_ground() -> None:
    with pytest.raises(UnsafeError) as caught:
        on_the_ground(linear_omega_rad_s=1.5, linear_damping=1.5)
    assert caught.value.reason == "braking"


@pytest.mark.parametrize("seconds", [0.5, 9.0])
def test_letting_the_key_go_stops_the_robot(seconds: float) -> None:
    begun: list[float] = []

    def held(sim: Simulator, robot: Robot) -> bool:
        begun.append(robot.now_s)
        return robot.now_s < begun[0] + seconds

    with pytest.raises(ReleasedError):
        on_the_ground(held)


@pytest.mark.parametrize("stopped_by", ["the key", "a bumper"])
def test_after_a_stop_it_drives_once_more_from_the_begin(stopped_by: str) -> None:
    with Simulator(slip=SLIP) as sim:
        sim.clear_obstacles()
        with sim.connect(scale_linear=1.0, scale_angular=1.0) as robot:
            person, world, checks = Person(sim, robot), Mock(), iter(range(10**6))

            def held() -> bool:
                is_stopped = next(checks) == 50
                if is_stopped and stopped_by != "the key":
                    sim.set("front_bumper", 1)
                return not is_stopped or stopped_by != "the key"

            def please(key: str, text: str) -> None:
                assert key == "again", text
                assert stopped_by.split()[1] in text
                assert sim.state.target_linear_m_s == 0.0
                sim.set("front_bumper", 0)
                robot.sleep(3.0)
                person.at = sim.true_pose

            world.held.side_effect, world.please.side_effect = held, please
            found: dict[str, float] = {}
            first_contact.drive_on_the_ground(robot, world, person, found)
    assert world.please.call_count == 1
    assert found["scale_linear"] == pytest.approx(1.0, abs=0.02)


def test_with_its_robot_file_the_robot_and_the_simulator_of_that_file_turn_as_far_as_asked(
    tmp_path: Path,
) -> None:
    odometry_scale = 1.302
    file = tmp_path / "robot.txt"
    found, _sim = on_the_ground(odometry_scale=odometry_scale)
    scales = {name: found[name] for name in ("scale_linear", "scale_angular")}
    robot_file.save(file, {"odometry_scale": odometry_scale, **scales})
    for settings in ({"slip": SLIP, "odometry_scale": odometry_scale}, {"robot_file": file}):
        with Simulator(**settings) as sim:
            sim.clear_obstacles()
            with sim.connect(robot_file=file) as robot:
                robot.arm()
                robot.move(1.0)
                assert sim.true_pose.x_m == pytest.approx(1.0, abs=0.03)
                robot.turn(math.pi / 2)
                assert sim.true_pose.theta_rad == pytest.approx(math.pi / 2, abs=0.05)


def test_what_no_robot_file_can_hold_is_left_out_of_it(tmp_path: Path) -> None:
    first_contact.save(tmp_path / "robot.txt", {"override_index": 8, "width_m": 0.01})
    assert robot_file.load(tmp_path / "robot.txt") == {"override_index": 8}


def test_the_recording_has_the_drive_on_the_ground_but_not_its_addresses(tmp_path: Path) -> None:
    log: list[tuple[float, int, bool, bytes]] = []
    session = Mock(log=log, world=Mock(now_s=1000.0))
    path = tmp_path / "drive.pcapng"
    with Simulator(port=0) as sim, connect(sim.address, record=path):
        pass
    bundle.add_drive(session, Capture(path))
    assert {sent for _at_s, _port, sent, _data in log} == {False, True}
    assert all(990.0 < at_s <= 1000.0 for at_s, _port, _sent, _data in log)
    assert bytes([127, 0, 0, 1]) not in bundle.recording(log)


def test_only_a_step_that_was_done_is_done_again(tmp_path: Path) -> None:
    options = Mock(folder=tmp_path, again="pad")
    contact = Contact(Mock(now_s=0.0))
    state = contact.state() | {"done": ["directory", "network"]}
    (tmp_path / "contact.json").write_text(json.dumps(state))
    with pytest.raises(CommandError, match="'pad' is no step that was done: directory, network"):
        first_contact._resume(contact, options, contact.session.world)
