# SPDX-License-Identifier: MIT
"""Arguments: numbers of any type, and errors that name the value and its range."""

import asyncio
import math
import struct
from collections.abc import Callable

import pytest

import roburoc4
from roburoc4 import ArgumentError, Result, Robot, Simulator


def test_numbers_of_numpy_and_whole_floats_are_numbers(roburoc4_simulator: Simulator) -> None:
    np = pytest.importorskip("numpy")
    settings: roburoc4.Settings = {
        "lease_ms": 250.0,  # type: ignore[typeddict-item]
        "period_ms": {"battery": np.int64(500)},
        "max_linear_m_s": np.float32(0.5),
        "keep_curvature": np.bool_(True),
        "allow_unknown_override": 0,  # type: ignore[typeddict-item]
    }
    with roburoc4_simulator.connect(**settings) as robot:
        robot.arm()
        robot.drive(np.float32(0.1), 0, lease_s=1)
        robot.drive(np.int32(0), np.float64(0.1), lease_s=np.float32(0.2))
        robot.drive_for(np.float32(0.1), 0, np.float64(0.2))
        robot.pause()
        robot.subscribe("battery", 100.0)  # type: ignore[arg-type]
        robot.relocalize(np.float32(1), np.int32(0), 0)
        robot.digital_outputs[np.int64(2)] = np.bool_(True)
        robot.digital_outputs[3] = 0
        assert robot.digital_outputs[2.0] is True  # type: ignore[index]
        assert robot.move(np.float32(0.1), speed=np.float32(0.3)).outcome
        roburoc4_simulator.set("battery_percent", np.float32(50))


Call = Callable[[Robot], object]


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda r: r.drive(1e308, 0), r"linear_m_s: 1e\+308 .* -3.4e\+38 to 3.4e\+38"),
        (lambda r: r.drive(0, 0, lease_s=250), "lease_s: 250 .* 0.02 to 1 s"),
        (lambda r: r.subscribe("battery", 15), "period_ms: 15 .* multiple of 10, 10 to 2550"),
        (lambda r: r.role_index(9), "role: 9 .* Role.FRONT_BUMPER"),
        (lambda r: r.host_time_s(-1), "robot_cycles: -1 .* 0 to"),
        (lambda r: r.age_s("sonar"), "'sonar' .* iocard, telemeter"),
        (lambda r: r.drive_for(0, 0, -1), "seconds: -1 .* 0 to"),
        (lambda r: next(r.events(timeout=-1)), "timeout: -1 .* 0 to"),
        (lambda r: r.relocalize(0, float("inf"), 0), "y_m: inf .* a finite number"),
        (lambda r: r.move(1, speed=0), "speed: 0 .* more than 0, up to 5 m/s"),
        (lambda r: r.move(1, timeout="a"), "timeout: 'a' .* 0.001 to"),
        (lambda r: r.digital_outputs[99], "no digital output 99: its 8 are 0 to 7"),
        (lambda r: r.digital_outputs.set({3: "off"}), r"outputs\[3\]: 'off' .* True or False"),
        (lambda r: r.inputs[8], r"inputs.digital\(8\) or inputs.analog\(8\)"),
    ],
)
def test_an_argument_error_names_value_and_range(
    call: Call, text: str, roburoc4_simulator: Simulator
) -> None:
    with roburoc4_simulator.connect() as robot, pytest.raises(ArgumentError, match=text) as caught:
        robot.arm()
        call(robot)
    assert isinstance(caught.value.code, Result)


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        ({"lease_ms": 5}, "lease_ms: 5 .* give 20 to 1000"),
        ({"max_linear_m_s": math.nan}, "max_linear_m_s: nan .* give 0.001 to 5"),
        ({"fresh_ms": 100}, "fresh_ms: 100 .* at most a third of fresh_ms"),
        ({"period_ms": 50}, 'period_ms: 50 .* {"battery": 500}'),
        ({"ignore_other_commander": "off"}, "ignore_other_commander: 'off' .* True or False"),
        ({"period_ms": {"battery": 15}}, "period_ms: {'battery': 15} .* multiples of 10"),
        ({"buffer": 3}, "buffer: 3 .* 16 to 1000000"),
        (
            {"period_ms": {"battery": 500}, "drive_period_ms": 5},
            "^drive_period_ms: 5 .* give 10 to 500",
        ),
    ],
)
def test_a_setting_that_cannot_be_used_names_its_range(
    settings: roburoc4.Settings, text: str, roburoc4_simulator: Simulator
) -> None:
    with pytest.raises(ArgumentError, match=text) as caught:
        roburoc4_simulator.connect(**settings)
    assert caught.value.code is Result.CONFIG


def test_no_end_no_switch_and_no_time_left_are_accepted(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect(timeout=math.inf, keep_curvature=None) as robot:
        robot.arm(timeout=math.inf)
        robot.sleep(-1e-9)


def test_floats_are_printed_as_a_person_would_write_them() -> None:
    with Simulator(max_linear_m_s=2.6, width_m=0.68) as sim, sim.connect() as robot:
        limits = robot.properties.differential
        assert limits is not None
        assert (str(limits.max_linear_m_s), str(limits.width_m)) == ("2.6", "0.68")
        assert len(str(robot.iocard.analog_inputs[2])) <= 9
    for text in ("0.1", "-0.3", "12345.67", "0.0", "99999.99", "1e-05", "0.68", "-6.5", "1.0"):
        data = struct.pack("<BHff", 0xFF, 6, float(text), 0.0)
        command = roburoc4.protocol.decode(data, sender="client")
        assert isinstance(command, roburoc4.protocol.DifferentialCommand)
        assert str(command.linear_m_s) == text


def test_a_setting_cannot_be_assigned_later(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        with pytest.raises(AttributeError, match=r"give it to connect\(max_linear_m_s=0.1\)"):
            robot.max_linear_m_s = 0.1  # type: ignore[attr-defined]
        robot.my_own = 1  # type: ignore[attr-defined]


class _Later:
    async def __call__(self, _: object) -> bool:
        return True


def test_functions_that_must_be_awaited_are_refused(roburoc4_simulator: Simulator) -> None:
    async def later(_: object) -> bool:
        return True

    loop = asyncio.new_event_loop()
    with roburoc4_simulator.connect() as robot:
        robot.arm()
        with pytest.raises(ArgumentError, match=r"condition: .* not async"):
            robot.wait_for(later)
        with pytest.raises(ArgumentError, match=r"on_progress: .* not async"):
            robot.move(0.1, on_progress=later)
        with pytest.raises(ArgumentError, match=r"on_progress: .* not async"):
            robot.move(0.1, on_progress=_Later())
        assert roburoc4_simulator.state.nonzero_speed_commands == 0
        with pytest.raises(ArgumentError, match=r"on_progress: .* not async"):
            robot.move(0.1, on_progress=lambda _: asyncio.Future(loop=loop))
        assert not robot.facts.driving
    loop.close()


def test_take_returns_what_has_arrived(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        statuses, events = robot.statuses("localization"), robot.events()
        assert statuses.take() == []
        robot.sleep(1.0)
        assert len(statuses.take()) == 20
        assert len(statuses.take(timeout=1.0)) == 1
        robot.arm()
        assert events.take() & roburoc4.Event.ARMED
        assert not events.take()
