# SPDX-License-Identifier: MIT
"""`roburoc4 move`, `turn`, `goto` and `square`: where they end, and what they report."""

import json
import math
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from cli_support import ALONE, document, one_line, run, start
from robot_support import until

import roburoc4


@pytest.fixture
def sim() -> Iterator[roburoc4.Simulator]:
    with roburoc4.Simulator(port=0, slip=0.0) as simulator:
        yield simulator


def test_move_and_turn_end_where_they_should(sim: roburoc4.Simulator) -> None:
    report = document(run("move", "0.5", "--json", robot=sim.address))
    assert report["outcome"] == "reached"
    assert report["distance_m"] == pytest.approx(0.5, abs=0.02)
    assert report["pose"]["x_m"] == pytest.approx(0.5, abs=0.02)
    report = document(run("turn", "-90deg", "--speed", "1", "--json", robot=sim.address))
    assert report["angle_rad"] == pytest.approx(-math.pi / 2, abs=0.03)
    assert sim.true_pose.theta_rad == pytest.approx(-math.pi / 2, abs=0.03)
    assert sim.state.last_linear_m_s == sim.state.last_angular_rad_s == 0.0


def test_goto_and_square_end_where_they_should(sim: roburoc4.Simulator) -> None:
    process = start("square", "0.2", robot=sim.address)  # half a minute
    stdout, stderr = process.communicate(timeout=120)
    assert (process.returncode, stderr) == (0, "")
    assert re.match(r"done: 0\.(7[6-9]|8[0-4]) m", stdout), stdout
    assert math.hypot(sim.true_pose.x_m, sim.true_pose.y_m) < 0.05
    report = document(run("goto", "-0.2", "0", "--json", robot=sim.address))
    assert report["pose"]["x_m"] == pytest.approx(-0.2, abs=0.02)


def test_an_obstacle_ends_it_with_its_document_and_code_1(sim: roburoc4.Simulator) -> None:
    sim.add_wall(2.0, -1.0, 2.0, 1.0)
    done = run("move", "3", "--json", robot=sim.address)
    assert done.returncode == 1
    assert "telemeter" in one_line(done.stderr)
    report = json.loads(done.stdout)
    assert report["outcome"] == "obstacle"
    assert 0.2 < report["distance_m"] < 1.0
    assert sim.state.last_linear_m_s == 0.0
    assert sim.true_pose.x_m < 2.0 - 0.7 - 0.4


def test_the_clearance_and_the_time_can_be_given(sim: roburoc4.Simulator) -> None:
    sim.add_wall(1.2, -1.0, 1.2, 1.0)
    done = run("move", "0.2", "--clearance", "0.1", robot=sim.address)
    assert done.returncode == 0, done.stderr
    done = run("move", "-5", "--timeout", "1", "--json", robot=sim.address)
    assert done.returncode == 1
    assert json.loads(done.stdout)["outcome"] == "timeout"


def test_a_speed_is_allowed_whatever_the_scale(sim: roburoc4.Simulator, tmp_path: Path) -> None:
    file = tmp_path / "robot.txt"
    file.write_text("scale_angular = 1.2\n")
    done = run("turn", "1", "--speed", "1.5", "--robot-file", str(file), robot=sim.address)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ("move",),
        ("move", "nan"),
        ("move", "1", "--clearance", "-1"),
        ("turn", "90degrees"),
        ("move", "10001"),
        ("square", "0"),
        ("turn", "90"),
        ("goto", "1e8", "0"),
        ("drive", "0", "10", "--seconds", "1001"),
    ],
)
def test_bad_usage_sends_nothing(arguments: tuple[str, ...]) -> None:
    with roburoc4.Simulator(port=0, host=ALONE) as sim:
        done = run(*arguments, robot=sim.address)
        assert done.returncode == 2
        one_line(done.stderr)
        assert sim.state.requests == 0


def test_a_reader_that_ends_stops_the_robot(sim: roburoc4.Simulator) -> None:
    process = start("move", "50", "--clearance", "0", "--json", robot=sim.address)
    assert process.stdout is not None
    assert process.stderr is not None
    until(lambda: sim.state.last_linear_m_s > 0)
    process.stdout.close()
    assert process.wait(timeout=120) == 1
    assert process.stderr.read() == ""
    process.stderr.close()
    assert sim.state.last_linear_m_s == 0.0
    assert sim.true_pose.x_m < 20.0
