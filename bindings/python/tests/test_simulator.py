# SPDX-License-Identifier: MIT
"""The simulator as users write tests with it."""

import math
import time

import pytest

import roburoc4
from roburoc4 import Simulator


def test_controls_are_set_and_read() -> None:
    with Simulator() as sim:
        sim.set("pad_a", True)
        sim.set("pad_rt", 1.0)
        sim.step(2.0)
        assert sim.true_pose.x_m > 1
        assert sim.state.overridden
        sim.set("pad", 0)
        sim.step(4.0)
        assert abs(sim.state.true_linear_m_s) < 0.05
        sim.set("estop_remote", True)
        assert sim.state.estop_remote
        with pytest.raises(roburoc4.RobotError):
            sim.set("motor_button", True)
        sim.set("estop_remote", False)
        assert not sim.state.motors_enabled
        sim.set("motor_button", True)
        assert sim.state.motors_enabled
        sim.set("brakes_released", True)
        assert sim.state.brakes_released
        sim.set("charger", True)
        sim.set("rear_bumper", True)
        assert (sim.state.charger, sim.state.rear_bumper) == (True, True)
        assert (sim.get("charger"), sim.get("front_bumper")) == (1, 0)


def test_obstacles_are_seen() -> None:
    with Simulator() as sim, sim.connect() as robot:
        sim.clear_obstacles()
        sim.add_wall(2.0, -5.0, 2.0, 5.0)
        sim.add_box(-3.0, 0.0, 1.0, 1.0)
        sim.step(1.0)
        front, rear = robot.telemeter.distances_m
        assert front == pytest.approx(2.0 - 0.655, abs=0.1)
        assert rear == pytest.approx(2.5 - 0.655, abs=0.1)
        sim.place(-1.0, 0.0, math.pi)
        assert sim.true_pose.x_m == -1.0
        with pytest.raises(roburoc4.RobotError):
            sim.place(2.0, 0.0)


def test_the_panel_executes_lines() -> None:
    with Simulator() as sim:
        assert sim.panel("pad a down") == "ok"
        assert sim.state.overridden
        for line in ("dance", "pad \ud800", "estop l\u00f6cal press"):
            with pytest.raises(roburoc4.ArgumentError):
                sim.panel(line)


def test_a_port_serves_in_real_time() -> None:
    with Simulator(port=0) as sim:
        before = sim.now_s
        time.sleep(0.2)
        assert sim.now_s - before >= 0.15
        with pytest.raises(roburoc4.RobotError, match="real time"):
            sim.step(1.0)
        with sim.connect() as robot:
            assert robot.address == sim.address
            sim.set_faults(loss=1.0)
            robot.wait_for(lambda r: r.state is roburoc4.State.LOST)
            sim.set_faults()
            robot.wait_for(lambda r: r.state is roburoc4.State.READY)


def test_a_port_that_is_taken_is_named_with_the_remedy() -> None:
    with Simulator(port=0) as sim:
        text = f"{sim.address} is in use: .* port=0"
        with pytest.raises(roburoc4.NetworkError, match=text) as caught:
            Simulator(port=int(sim.address.rpartition(":")[2]))
    assert isinstance(caught.value, OSError)


def test_a_host_that_cannot_be_served_is_named() -> None:
    with pytest.raises(roburoc4.NetworkError, match=r"foo:0 .* give an IPv4 address"):
        Simulator(port=0, host="foo")
    with pytest.raises(roburoc4.ArgumentError, match=r"host: '127.0.0.1\\x00x' .* IPv4 address"):
        Simulator(port=0, host="127.0.0.1\0x")


def test_after_close_its_state_remains_and_robots_are_closed() -> None:
    sim = Simulator()
    robot = sim.connect()
    robot.arm()
    sim.close()
    sim.close()
    assert sim.state.cycles > 0
    with pytest.raises(roburoc4.ClosedError):
        robot.drive(0.1, 0.0)
    robot.close()
    real = Simulator(port=0)
    real.close()
    real.close()
    assert real.state.powered


def test_a_member_of_the_family_is_drawn_by_its_number() -> None:
    with Simulator(family=4) as sim:
        assert math.isnan(sim.state.distances_m[0]), "this one has no telemeter"
        sim.set("family", 3)
        assert not math.isnan(sim.state.distances_m[0])
    with Simulator(family=4, telemeters=1) as sim:
        assert not math.isnan(sim.state.distances_m[0]), "settings change it"
    with pytest.raises(roburoc4.ArgumentError, match="family: -1"):
        Simulator(family=-1)


def test_errors_can_come_in_each_of_three_ways() -> None:
    for way in range(3):
        Simulator(error_header=way).close()
    with pytest.raises(roburoc4.ArgumentError, match="error_header"):
        Simulator(error_header=3)


def test_settings_out_of_range_are_refused_by_name() -> None:
    with pytest.raises(roburoc4.ArgumentError, match="slip"):
        Simulator(slip=2.0)
    with pytest.raises(roburoc4.ArgumentError, match=r"width_m: 'a' .* number"):
        Simulator(width_m="a")  # type: ignore[arg-type]
    with Simulator() as sim:
        with pytest.raises(roburoc4.ArgumentError, match="loss"):
            sim.set_faults(loss=1.5)
        with pytest.raises(roburoc4.ArgumentError, match="no control 'pad_q'"):
            sim.set("pad_q", True)
        with pytest.raises(roburoc4.ArgumentError, match="pin_digital_22"):
            sim.set("pin_digital_22", True)
        with pytest.raises(roburoc4.ArgumentError, match="seconds: -1"):
            sim.step(-1.0)


def test_the_fixture_is_part_of_the_package(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("PYTHONPATH")  # pytest wants to import its plugins first
    pytester.makepyfile(
        """
        def test_drive(roburoc4_simulator):
            with roburoc4_simulator.connect() as robot:
                robot.arm()
                robot.drive_for(0.5, 0.0, seconds=1)
            assert roburoc4_simulator.true_pose.x_m > 0.1
        """
    )
    pytester.runpytest_subprocess("-W", "error").assert_outcomes(passed=1)
