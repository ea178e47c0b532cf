# SPDX-License-Identifier: MIT
"""Misuse: whatever a program passes, the error is a RobotError that names the argument."""

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import roburoc4
from roburoc4 import ArgumentError, RobotError, Role, Simulator, protocol

np = pytest.importorskip("numpy")

VALUES: list[Any] = [
    *(None, "a", "", b"x", "\0", float("nan"), -1, 1e300, 10**30, object(), [], {}, (1, 2)),
    *(np.array([0.1]), np.array([0.1, 0.2]), 1j, Path("x"), lambda *_: 1, False, 1.5),
]
BATTERY = bytes.fromhex("ff0400 6400000000000000 02 5a")
ROBOT: dict[str, tuple[dict[str, Any], tuple[str, ...]]] = {
    "drive": ({"linear_m_s": 0.1, "angular_rad_s": 0.1}, ("lease_s",)),
    "drive_for": ({"linear_m_s": 0.1, "angular_rad_s": 0.1, "seconds": 0.1}, ()),
    "move": ({"distance_m": 0.1}, ("speed", "clearance", "timeout", "on_progress")),
    "move_for": ({"linear_m_s": 0.1, "angular_rad_s": 0.1, "seconds": 0.3}, ("clearance",)),
    "turn": ({"angle_rad": 0.1}, ("speed", "timeout", "allow_turns", "on_progress")),
    "arc": (
        {"distance_m": 0.1, "angle_rad": 0.1},
        ("speed", "clearance", "timeout", "allow_turns"),
    ),
    "goto": ({"x_m": 0.1, "y_m": 0.1, "theta_rad": 0.1}, ("speed", "clearance", "timeout")),
    "rest": ({}, ("timeout",)),
    "subscribe": ({"service": "battery", "period_ms": 100}, ()),
    "unsubscribe": ({"service": "battery"}, ()),
    "age_s": ({"service": "battery"}, ()),
    "period_s": ({"service": "battery"}, ()),
    "service_link": ({"service": "battery"}, ()),
    "host_time_s": ({"robot_cycles": 100}, ()),
    "role_index": ({"role": Role.OVERRIDE}, ()),
    "wait_for": ({"condition": "telemeter"}, ("timeout",)),
    "wait_ready": ({}, ("timeout",)),
    "arm": ({}, ("timeout",)),
    "sleep": ({"seconds": 0.1}, ()),
    "relocalize": ({"x_m": 0.0, "y_m": 0.0, "theta_rad": 0.0}, ()),
    "record": ({"seconds": 0.1}, ()),
}
SIMULATOR: dict[str, dict[str, Any]] = {
    "set": {"control": "pad_a", "value": True},
    "get": {"control": "pad_a"},
    "step": {"seconds": 0.1},
    "add_box": {"x_m": 1.0, "y_m": 1.0, "size_x_m": 0.1, "size_y_m": 0.1, "theta_rad": 0.0},
    "add_wall": {"x1_m": 0.0, "y1_m": 0.0, "x2_m": 1.0, "y2_m": 1.0},
    "place": {"x_m": 0.0, "y_m": 0.0, "theta_rad": 0.0},
    "panel": {"line": "help"},
    "set_faults": {"loss": 0.0, "duplicate": 0.0, "delay_ms": 0.0, "jitter_ms": 0.0},
}
NOT_BY_NAME = {"control", "value", "line", "condition", "host"}
"""Their errors quote what was given, or have another name for it."""


def _try(name: str, value: object, call: Callable[[], object], *, is_named: bool = True) -> None:
    """Call it: it may succeed, or raise an error of the family; one of arguments has its name."""
    caught: Exception | None = None
    try:
        call()
    except Exception as error:
        caught = error
    assert caught is None or isinstance(caught, RobotError), f"{name}={value!r}: {caught!r}"
    if isinstance(caught, ArgumentError) and is_named:
        assert name in str(caught), f"{value!r}: {caught}"


def _misuse(call: Callable[..., Any], arguments: dict[str, Any], *more: str) -> None:
    """Call it with each value in place of each argument."""
    assert {*arguments, *more} <= set(inspect.signature(call).parameters)
    for name in (*arguments, *more):
        for value in VALUES:
            given = {**arguments, name: value}
            _try(name, value, lambda given=given: call(**given), is_named=name not in NOT_BY_NAME)


@pytest.mark.parametrize("method", ROBOT)
def test_methods_of_a_robot(method: str, roburoc4_simulator: Simulator) -> None:
    arguments, more = ROBOT[method]

    def call(**given: Any) -> object:
        with roburoc4_simulator.connect() as robot:
            robot.arm()
            return getattr(robot, method)(**given)

    call.__signature__ = inspect.signature(getattr(roburoc4.Robot, method))  # type: ignore[attr-defined]
    _misuse(call, arguments, *more)


@pytest.mark.parametrize("method", SIMULATOR)
def test_methods_of_a_simulator(method: str, roburoc4_simulator: Simulator) -> None:
    _misuse(getattr(roburoc4_simulator, method), SIMULATOR[method])


def test_inputs_outputs_and_streams(roburoc4_simulator: Simulator) -> None:
    with roburoc4_simulator.connect() as robot:
        calls: dict[str, Callable[[Any], object]] = {
            "digital": robot.inputs.digital,
            "analog": robot.inputs.analog,
            "inputs": lambda value: robot.inputs[value],
            "output": lambda value: robot.digital_outputs[value],
            "digital_outputs": lambda value: robot.digital_outputs.set({3: value}),
            "values": robot.digital_outputs.set,
            "analog_outputs": lambda value: robot.analog_outputs[value],
            "service": robot.statuses,
            "timeout": lambda value: next(robot.statuses("battery", timeout=value)),
            "timeout of events": lambda value: value is None or next(robot.events(timeout=value)),
        }
        for name, call in calls.items():
            for value in VALUES:
                _try(name, value, lambda call=call, value=value: call(value), is_named=False)


@pytest.mark.parametrize("setting", [*roburoc4.Settings.__annotations__, "timeout"])
def test_settings(setting: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    wait = setting == "timeout"
    for value in VALUES:
        given: dict[str, Any] = {"wait": wait, setting: value}
        _try(setting, value, lambda given=given: roburoc4.connect("127.0.0.1:9", **given).close())


@pytest.mark.parametrize(
    "setting", [*roburoc4.SimSettings.__annotations__, "seed", "family", "port", "host"]
)
def test_settings_of_a_simulator(setting: str) -> None:
    with_port = {"port": 0} if setting == "host" else {}
    for value in VALUES:
        given: dict[str, Any] = {**with_port, setting: value}
        _try(setting, value, lambda given=given: Simulator(**given).close())


def test_functions() -> None:
    _misuse(protocol.decode, {"data": BATTERY, "layout": None, "sender": "client"})
    _misuse(
        protocol.decode_batch,
        {"service": "battery", "data": [BATTERY], "layout": None, "telemeters": 2},
    )
    _misuse(roburoc4.protocol.resolve, {"host": "127.0.0.1"})


@pytest.mark.parametrize("connect", [roburoc4.connect, Simulator().connect, Simulator])
def test_an_unknown_setting_is_named(connect: Callable[..., object]) -> None:
    with pytest.raises(ArgumentError, match="no setting 'max_speed': there are"):
        connect(max_speed=1.0)
