# SPDX-License-Identifier: MIT
"""`roburoc4 stop`, `output`, `relocalize`: one request, one line of output."""

import math
import socket
import struct
import time

import pytest
from cli_support import document, one_line, run, start
from robot_support import until

import roburoc4


def test_stop_ends_the_drive_of_another_program() -> None:
    ahead = b"\xff\x06\x00" + struct.pack("<2f", 0.5, 0.0)  # of a program that believes nothing
    with roburoc4.Simulator(port=0) as sim, socket.socket(type=socket.SOCK_DGRAM) as another:
        another.connect(("127.0.0.1", int(sim.address.rpartition(":")[2])))
        another.send(ahead)
        until(lambda: sim.state.wheel_linear_m_s > 0.1)
        done = run("stop", robot=sim.address)
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout == f"{sim.address} has stopped\n"
        assert sim.state.target_linear_m_s == 0.0
        assert abs(sim.state.wheel_linear_m_s) < 0.05


@pytest.mark.parametrize("seconds", [3.0, 60.0])
def test_stop_reports_another_program_that_keeps_driving(seconds: float) -> None:
    ahead = b"\xff\x06\x00" + struct.pack("<2f", 0.5, 0.0)  # of a program that believes nothing
    with roburoc4.Simulator(port=0) as sim, socket.socket(type=socket.SOCK_DGRAM) as another:
        another.connect(("127.0.0.1", int(sim.address.rpartition(":")[2])))
        another.send(ahead)
        until(lambda: sim.state.wheel_linear_m_s > 0.1)
        process = start("stop", "--json", robot=sim.address)
        zeros: list[float] = []  # when the last command was one
        while process.poll() is None:
            state = sim.state
            if state.last_linear_m_s == 0.0:
                zeros.append(state.now_us / 1e6)
            if not zeros or state.now_us / 1e6 < zeros[0] + seconds:
                another.send(ahead)
            time.sleep(0.002)
        stdout, stderr = process.communicate(timeout=120)
    assert process.returncode == 1
    assert stdout == ""
    assert stderr.count("another program") == 2
    assert "hold [A]" in stderr
    assert zeros[-1] - zeros[0] > 2.0, "they do not end after the first ones"
    ended = "has stopped, but another program" if seconds < 10 else "still moves: another program"
    assert ended in stderr


def test_a_stop_under_override_is_not_believed() -> None:
    with roburoc4.Simulator(port=0) as sim:
        sim.set("pad_a", True)
        done = run("stop", "--json", robot=sim.address)
    assert done.returncode == 1
    assert done.stdout == ""
    assert "ignores zeros while somebody holds [A]" in one_line(done.stderr)


def test_stop_always_sends_a_zero() -> None:
    with roburoc4.Simulator(port=0) as sim:
        assert document(run("stop", "--json", robot=sim.address)) == {
            "robot": sim.address,
            "stopped": True,
            "outcome": "confirmed",
        }
        assert sim.state.speed_commands > 0
        assert sim.state.nonzero_speed_commands == 0


def test_stop_does_not_claim_what_it_cannot_see() -> None:
    with roburoc4.Simulator(port=0, refused_inserts=1 << 6) as sim:
        done = run("stop", "--json", robot=sim.address)
        assert document(done)["stopped"] is None
        assert sim.state.speed_commands > 0


def test_output_switches_and_reports() -> None:
    with roburoc4.Simulator(port=0) as sim:
        done = run("output", "3", "on", robot=sim.address)
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout == f"output 3 of {sim.address} is on\n"
        assert sim.get("digital_output_3")
        assert document(run("output", "3", "off", "--json", robot=sim.address))["on"] is False
        assert not sim.get("digital_output_3")


def test_an_output_that_the_robot_lacks_is_refused() -> None:
    with roburoc4.Simulator(port=0) as sim:
        done = run("output", "8", "on", robot=sim.address)
        assert sim.state.io_commands == 0
    assert done.returncode == 1
    assert "0 to 7" in one_line(done.stderr)


def test_relocalize_accepts_negative_numbers() -> None:
    with roburoc4.Simulator(port=0) as sim:
        done = run("relocalize", "1.5", "-2", "-0.5", "--json", robot=sim.address)
        assert document(done) == {
            "robot": sim.address,
            "x_m": 1.5,
            "y_m": -2.0,
            "theta_rad": -0.5,
        }
        state = sim.state
    assert (state.odometry_x_m, state.odometry_y_m) == (1.5, -2.0)
    assert state.odometry_theta_rad == pytest.approx(-0.5)


def test_relocalize_takes_degrees_and_refuses_what_looks_like_them() -> None:
    with roburoc4.Simulator(port=0) as sim:
        done = run("relocalize", "1", "2", "-90deg", "--json", robot=sim.address)
        assert document(done)["theta_rad"] == pytest.approx(-math.pi / 2)
        done = run("relocalize", "1", "2", "90", robot=sim.address)
        assert done.returncode == 2
        assert "did you mean 90deg?" in one_line(done.stderr)
        done = run("relocalize", "1", "2", "north", robot=sim.address)
        assert "did you mean" not in one_line(done.stderr)
