# SPDX-License-Identifier: MIT
"""Commands that are obeyed, and those that are rejected and counted."""

import time
from collections.abc import Callable
from typing import Any

import pytest
import roburoc4
import roburoc4_lcm
from rig import Bridge, Bus, Planner, Robot, until
from rig.bus import drive_command, now_us

StartBridge = Callable[..., Bridge]
Plan = Callable[..., Planner]
State = roburoc4_lcm.bridge_state_t

DRIVE = "ROBUROC4_DRIVE_CMD"
REPLACE = 1
"""The action of a relocalization on the wire."""


def speeds(robot: Robot) -> list[float]:
    return [command.linear_m_s for command in robot.tap.moves()]


def wait_for_count(bridge: Bridge, counter: str, least: int) -> None:
    until(
        lambda: getattr(bridge.statistics, counter) >= least,
        f"{counter} reaches {least}; the bridge said:\n{bridge.output}",
    )


def test_a_command_drives_the_robot(robot: Robot, armed: Bridge, plan: Plan) -> None:
    plan(linear=0.4, angular=-0.3)
    until(robot.tap.moves, "a speed reaches the robot")
    time.sleep(1.0)
    for command in robot.tap.moves():
        assert command[1:] == (0.4, -0.3)
    x_m, _, theta_rad = robot.true_pose()
    assert x_m > 0.1
    assert theta_rad < -0.05
    assert armed.state.driving
    assert armed.state.control_owner == "planner"
    assert 0 < armed.state.lease_left_us <= 300_000
    assert 0 <= armed.state.command_age_us < 300_000
    assert armed.statistics.accepted_drive > 10


def test_of_a_burst_of_100_commands_the_last_wins(robot: Robot, bus: Bus, armed: Bridge) -> None:
    for index in range(100):
        bus.publish(DRIVE, drive_command(-1.0 - index / 100, lease_us=300_000).encode())
    bus.publish(DRIVE, drive_command(0.5, lease_us=300_000).encode())
    until(lambda: 0.5 in speeds(robot), "it drives")
    until(lambda: not armed.state.driving, "the lease is over")
    counted = armed.statistics
    assert counted.accepted_drive + counted.superseded == 101
    driven = speeds(robot)
    assert set(driven[driven.index(0.5) :]) == {0.5}


@pytest.mark.parametrize(
    ("options", "asked_us", "lease_us"),
    [
        pytest.param([], 150_000, 150_000, id="its own"),
        pytest.param([], 0, 300_000, id="the default"),
        pytest.param([], -5, 300_000, id="negative: the default"),
        pytest.param([], 2_000_000_000, 300_000, id="longer than allowed"),
        pytest.param(["--lease-ms=120"], 0, 120_000, id="another default"),
        pytest.param(["--lease-ms=120"], 200_000, 120_000, id="another cap"),
    ],
)
def test_one_command_is_a_lease(
    robot: Robot,
    bus: Bus,
    start_bridge: StartBridge,
    options: list[str],
    asked_us: int,
    lease_us: int,
) -> None:
    start_bridge("--enable-drive", *options).arms()
    given_us = now_us()
    bus.publish(DRIVE, drive_command(0.3, lease_us=asked_us).encode())
    until(robot.tap.moves, "a speed reaches the robot")
    until(lambda: not robot.tap.commands()[-1].moves, "zero follows")
    time.sleep(0.5)
    commands = robot.tap.commands()
    first_zero_us = next(command.time_us for command in commands if not command.moves)
    assert lease_us - 5_000 <= first_zero_us - given_us <= lease_us + 150_000
    assert not [command for command in robot.tap.moves() if command.time_us > first_zero_us]
    # At least three zeros, or as many as the robot needs to confirm them.
    assert len(commands) - len(robot.tap.moves()) >= 3
    assert robot.speeds()[2:] == (0, 0)


@pytest.mark.parametrize("lease_us", [1, 20_000])
def test_the_shortest_lease_drives(robot: Robot, bus: Bus, armed: Bridge, lease_us: int) -> None:
    def moves() -> bool:
        bus.publish(DRIVE, drive_command(0.3, lease_us=lease_us).encode())
        time.sleep(0.05)
        return bool(robot.tap.moves())

    until(moves, f"a speed reaches the robot; the bridge said:\n{armed.output}")


def test_speeds_are_clamped_to_the_ceiling(robot: Robot, bus: Bus, armed: Bridge) -> None:
    bus.publish(DRIVE, drive_command(4.9, -9.9).encode())
    until(robot.tap.moves, "a speed reaches the robot")
    assert robot.tap.moves()[0][1:] == (1.0, -1.5)
    wait_for_count(armed, "clamped", 1)


def test_ceilings_are_obeyed_and_published(
    robot: Robot, bus: Bus, start_bridge: StartBridge
) -> None:
    bridge = start_bridge("--enable-drive", "--max-linear=0.25", "--max-angular=2").arms()
    bus.publish(DRIVE, drive_command(3.0, 1.75).encode())
    until(robot.tap.moves, "a speed reaches the robot")
    assert robot.tap.moves()[0][1:] == (0.25, 1.75)
    wait_for_count(bridge, "clamped", 1)
    properties = bus.last("ROBUROC4_PROPERTIES")
    assert (properties.ceiling_linear_m_s, properties.ceiling_angular_rad_s) == (0.25, 2.0)


@pytest.mark.parametrize(
    ("linear", "angular"), [(300.0, 0.0), (0.0, 45.0), (-1e6, 0.0), (-1e300, 0.0), (0.0, -1.7e308)]
)
def test_speeds_in_other_units_are_rejected(
    robot: Robot, bus: Bus, armed: Bridge, linear: float, angular: float
) -> None:
    bus.publish(DRIVE, drive_command(linear, angular).encode())
    wait_for_count(armed, "rejected_units", 1)
    assert robot.tap.moves() == []
    until(
        lambda: armed.state.rejected_cause == State.REJECTED_UNITS,
        f"the state names the cause; the bridge said:\n{armed.output}",
    )
    assert "give m/s and rad/s" in armed.state.rejected_message


def test_a_speed_at_the_ceiling_is_not_counted_as_clamped(bus: Bus, armed: Bridge) -> None:
    bus.publish(DRIVE, drive_command(1.0, -1.5).encode())
    wait_for_count(armed, "accepted_drive", 1)
    assert armed.statistics.clamped == 0


COMMANDS: dict[str, Callable[[], Any]] = {
    "DRIVE_CMD": lambda: drive_command(0.3),
    "RELOCALIZE_CMD": lambda: relocalize_command(10.0),
    "OUTPUT_CMD": lambda: output_command(3),
}


def relocalize_command(x_m: float) -> Any:
    command = roburoc4_lcm.relocalize_command_t()
    command.utime, command.sender = now_us(), "planner"
    command.x_m, command.y_m, command.theta_rad = x_m, 5.0, 0.5
    return command


def output_command(index: int) -> Any:
    command = roburoc4_lcm.output_command_t()
    command.utime, command.sender = now_us(), "planner"
    command.digital_count, command.digital_index, command.digital_on = 1, [index], [True]
    return command


def effects(robot: Robot) -> int:
    """How many telegrams commanded the robot."""
    commands = [data for _, data in list(robot.tap.to_robot) if data[:1] == b"\xff"]
    return len(commands) + len(relocalizations(robot))


def relocalizations(robot: Robot) -> list[bytes]:
    return [data for _, data in list(robot.tap.to_robot) if len(data) == 36 and data[0] != 0xFF]


@pytest.mark.parametrize("kind", COMMANDS)
@pytest.mark.parametrize(
    ("fault", "counter"),
    [
        ({"utime": 0}, "rejected_no_utime"),
        ({"utime": -5}, "rejected_no_utime"),
        ({"utime": -(2**63), "lease_us": -(2**31)}, "rejected_no_utime"),
        ({"ahead_us": -1_000_000}, "rejected_too_old"),
        ({"ahead_us": 1_000_000}, "rejected_in_future"),
        ({"sender": ""}, "rejected_sender"),
        ({"sender": "x" * 64}, "rejected_sender"),
    ],
    ids=str,
)
def test_a_command_is_rejected_and_counted_by_cause(
    robot: Robot, bus: Bus, willing: Bridge, kind: str, fault: dict[str, Any], counter: str
) -> None:
    command = COMMANDS[kind]()
    for name, value in fault.items():
        if name == "ahead_us":
            command.utime += value
        elif hasattr(command, name):
            setattr(command, name, value)
    before = effects(robot)
    bus.publish(f"ROBUROC4_{kind}", command.encode())
    wait_for_count(willing, counter, 1)
    time.sleep(0.1)
    assert effects(robot) == before
    assert getattr(willing.statistics, counter) == 1
    state = willing.state
    assert state.rejected_cause == getattr(State, counter.upper())
    assert (state.rejected_sender, state.rejected_utime) == (command.sender[:63], command.utime)
    assert state.rejected_message in willing.output
    assert ("--max-age-ms" in state.rejected_message) == ("ahead_us" in fault)


def test_each_incident_of_rejections_is_logged(bus: Bus, willing: Bridge) -> None:
    def rejections(sender: str) -> int:
        for _ in range(5):
            bus.publish("ROBUROC4_DRIVE_CMD", drive_command(0.1, sender=sender, utime=0).encode())
            time.sleep(0.05)
        until(lambda: willing.state.rejected_sender == sender, "the state names the sender")
        return willing.output.count("rejected:")

    assert rejections("one") == 1
    time.sleep(1.0)
    assert rejections("another") == 2
    time.sleep(5.5)
    assert rejections("another") == 3


def test_outputs_are_set(robot: Robot, bus: Bus, willing: Bridge) -> None:
    bus.publish("ROBUROC4_OUTPUT_CMD", output_command(3).encode())
    wait_for_count(willing, "accepted_output", 1)

    def last() -> object:
        said = [
            roburoc4.protocol.decode(data, sender="client")
            for _, data in list(robot.tap.to_robot)
            if data[:1] == b"\xff"
        ]
        return said[-1] if said else None

    until(lambda: isinstance(last(), roburoc4.protocol.IoCardCommand), "outputs reach the robot")
    found = last()
    assert isinstance(found, roburoc4.protocol.IoCardCommand)
    assert [index for index, on in enumerate(found.digital_outputs) if on] == [3]


@pytest.mark.parametrize("index", [0, 8, -1, 2**31 - 1])
def test_outputs_that_do_not_exist_are_rejected(
    robot: Robot, bus: Bus, willing: Bridge, index: int
) -> None:
    bus.publish("ROBUROC4_OUTPUT_CMD", output_command(index).encode())
    wait_for_count(willing, "rejected_impossible", 1)
    assert effects(robot) == 0


def test_a_relocalization_reaches_the_robot(robot: Robot, bus: Bus, willing: Bridge) -> None:
    bus.publish("ROBUROC4_RELOCALIZE_CMD", relocalize_command(10.0).encode())
    until(
        lambda: bus.last("ROBUROC4_LOCALIZATION").x_m == pytest.approx(10.0, abs=0.01),
        "the new pose",
    )
    assert bus.last("ROBUROC4_LOCALIZATION").y_m == pytest.approx(5.0, abs=0.01)
    assert bus.last("ROBUROC4_LOCALIZATION").theta_rad == pytest.approx(0.5, abs=0.01)
    wait_for_count(willing, "accepted_relocalize", 1)


def test_without_enable_it_only_watches(
    robot: Robot, bus: Bus, start_bridge: StartBridge, plan: Plan
) -> None:
    bridge = start_bridge().connects()
    plan()
    for _ in range(20):
        for kind in ("RELOCALIZE_CMD", "OUTPUT_CMD"):
            bus.publish(f"ROBUROC4_{kind}", COMMANDS[kind]().encode())
        time.sleep(0.05)
    wait_for_count(bridge, "rejected_disabled", 50)
    assert effects(robot) == 0
    bridge.end()
    assert effects(robot) == 0, "not even a zero at the end"


@pytest.mark.parametrize("enabled", ["drive", "outputs", "relocalize"])
def test_each_kind_is_enabled_by_itself(
    robot: Robot, bus: Bus, start_bridge: StartBridge, enabled: str
) -> None:
    bridge = start_bridge(f"--enable-{enabled}")
    if enabled == "drive":
        bridge.arms()
    else:
        bridge.connects()
        until(
            lambda: (
                (state := bridge.state) and state.state == State.STATE_READY and not state.waiting
            ),
            "it is ready",
        )
    for kind, make in COMMANDS.items():
        bus.publish(f"ROBUROC4_{kind}", make().encode())
    wait_for_count(bridge, "rejected_disabled", 2)
    until(lambda: effects(robot), "the third is obeyed")

    counted = bridge.statistics
    assert counted.accepted_drive == (enabled == "drive")
    assert counted.accepted_output == (enabled == "outputs")
    assert counted.accepted_relocalize == (enabled == "relocalize")


def test_commands_right_after_the_start_are_rejected(
    robot: Robot, start_bridge: StartBridge, plan: Plan
) -> None:
    plan(rate=100)
    bridge = start_bridge("--enable-drive").connects()
    wait_for_count(bridge, "rejected_disarmed", 50)
    assert bridge.statistics.rejected_starting > 0
    assert robot.tap.moves() == []


def test_max_age_0_accepts_any_clock(robot: Robot, start_bridge: StartBridge, plan: Plan) -> None:
    start_bridge("--enable-drive", "--max-age-ms=0").arms()
    planner = plan(sender="slow", ahead_s=-3600)
    until(robot.tap.moves, "it drives")
    planner.end()
    time.sleep(0.6)
    before = len(robot.tap.moves())
    plan(sender="fast", ahead_s=3600)
    until(lambda: len(robot.tap.moves()) > before, "it drives again")
