# SPDX-License-Identifier: MIT
"""`roburoc4 drive`: a gentle start, the time asked for, and a zero however it ends."""

import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from cli_support import Terminal, document, last_command_is_zero, one_line, run, start
from robot_support import until

import roburoc4
from roburoc4_tools.recordings import open_recording


@pytest.fixture
def sim() -> Iterator[roburoc4.Simulator]:
    with roburoc4.Simulator(port=0) as simulator:
        yield simulator


def test_it_drives_for_the_time_and_reports(sim: roburoc4.Simulator) -> None:
    report = document(run("drive", "0.5", "0", "--seconds", "2", "--json", robot=sim.address))
    # gently: a second up to 0.5 m/s, and a second down
    assert report["distance_m"] == pytest.approx(0.5, abs=0.05)
    assert sim.true_pose.x_m == pytest.approx(0.5, abs=0.05)
    assert report["outcome"] == "reached"
    assert set(report) == {
        "robot",
        "outcome",
        "distance_m",
        "angle_rad",
        "remaining_m",
        "remaining_rad",
        "pose",
    }
    assert set(report["pose"]) == {"x_m", "y_m", "theta_rad"}
    assert last_command_is_zero(sim)


def test_a_speed_above_the_limits_is_lowered_and_reported() -> None:
    with roburoc4.Simulator(port=0, max_linear_m_s=0.2) as sim:
        done = run("drive", "1", "0", "--seconds", "0.5", "--json", robot=sim.address)
    assert done.returncode == 0
    assert "more than the robot allows: using 0.2 m/s" in one_line(done.stderr)


def test_a_signal_stops_the_robot(sim: roburoc4.Simulator) -> None:
    process = start("drive", "0.5", "0.2", "--seconds", "100", robot=sim.address)
    until(lambda: sim.state.target_linear_m_s > 0.1)
    process.send_signal(signal.SIGHUP)
    _, stderr = process.communicate(timeout=120)
    assert process.returncode == 129
    assert "the robot has stopped" in one_line(stderr)
    assert last_command_is_zero(sim)
    state = sim.state
    assert (state.target_linear_m_s, state.target_angular_rad_s) == (0.0, 0.0)


def test_a_second_ctrl_c_does_not_delay_the_zero(sim: roburoc4.Simulator) -> None:
    process = start("drive", "0.5", "0", "--seconds", "100", robot=sim.address)
    until(lambda: sim.state.target_linear_m_s > 0.1)
    for _ in range(3):
        process.send_signal(signal.SIGINT)
        time.sleep(0.005)
    _, stderr = process.communicate(timeout=120)
    assert process.returncode == 130
    assert "interrupted" in one_line(stderr)
    assert last_command_is_zero(sim)


def test_without_inputs_it_refuses_until_told_to_ignore_them() -> None:
    with roburoc4.Simulator(port=0, refused_inserts=1 << 2) as sim:
        refused = run("drive", "0.5", "0", "--seconds", "0.5", robot=sim.address)
        assert refused.returncode == 1
        assert "--allow-unknown-override" in one_line(refused.stderr)
        assert sim.state.speed_commands == 0
        ignoring = ("drive", "0.5", "0", "--seconds", "1", "--allow-unknown-override")
        refused = run(*ignoring, robot=sim.address)
        assert refused.returncode == 1
        assert "bumper" in refused.stderr.splitlines()[-1]
        assert "clearance of 0" in refused.stderr
        assert sim.state.nonzero_speed_commands == 0
        done = run(*ignoring, "--clearance", "0", robot=sim.address)
        assert done.returncode == 0, done.stderr
        assert sim.true_pose.x_m > 0.02


def test_a_person_is_asked_once_with_name_and_address(sim: roburoc4.Simulator) -> None:
    terminal = Terminal("drive", "0.3", "0", "--seconds", "1", robot=sim.address)
    terminal.wait_for(rf"robot at {sim.address}.*\[y/N\]")
    assert sim.state.speed_commands == 0
    terminal.type("y\n")
    assert terminal.wait() == 0, terminal.text
    assert "done: " in terminal.text
    assert sim.true_pose.x_m > 0.02


def test_ctrl_z_does_not_suspend_a_drive(sim: roburoc4.Simulator) -> None:
    terminal = Terminal("drive", "0.3", "0", "--seconds", "2", "--yes", robot=sim.address)
    terminal.wait_for(r"\+0\.\d+ m/s .*of 0\.6 m")
    terminal.type("\x1a")
    assert terminal.wait() == 0, terminal.text
    assert last_command_is_zero(sim)


def test_a_drive_is_recorded_where_the_variable_says(
    served: roburoc4.Simulator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "robot" / "recordings"
    monkeypatch.setenv("ROBUROC4_RECORD", str(folder))
    done = run("drive", "0.2", "0", "--seconds", "0.5", robot=served.address)
    assert done.returncode == 0, done.stderr
    (file,) = folder.iterdir()
    assert f"recording to {file}" in done.stderr
    assert len(list(open_recording(file))) > 10
