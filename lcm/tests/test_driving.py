# SPDX-License-Identifier: MIT
"""Commands that are obeyed, and those that are rejected and counted."""

import time
from collections.abc import Callable
from typing import Any

import pytest
import roburoc4_lcm
from rig import Bridge, Bus, Planner, Robot, until
from rig.bus import drive_command, move_command, now_us, repeated

StartBridge = Callable[..., Bridge]
Plan = Callable[..., Planner]
State = roburoc4_lcm.bridge_state_t

DRIVE = "ROBUROC4_DRIVE_CMD"


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


@pytest.mark.parametrize(
    ("kind", "fault", "counter"),
    [
        ("OUTPUT_CMD", {"utime": 0}, "rejected_no_utime"),
        ("DRIVE_CMD", {"ahead_us": -1_000_000}, "rejected_too_old"),
        ("DRIVE_CMD", {"utime": 1_700_000_000_000_000_000}, "rejected_in_future"),
        ("RELOCALIZE_CMD", {"sender": ""}, "rejected_sender"),
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
    assert ("microseconds since 1970" in state.rejected_message) == (fault.get("utime", 0) > 0)


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


def test_a_move_reaches_its_goal_once(robot: Robot, bus: Bus, armed: Bridge) -> None:
    move = move_command(7, kind=2, x_m=0.6, y_m=0.0, theta_rad=0.0)  # KIND_TO_POSE

    def send() -> None:
        move.utime = now_us()
        bus.publish("ROBUROC4_MOVE_CMD", move.encode())

    with repeated(send, 0.1):
        until(
            lambda: (last := bus.last("ROBUROC4_MOVE_STATUS")) and last.outcome != 0,
            f"it ends; the bridge said:\n{armed.output}",
            30,
        )
        time.sleep(0.5)
    status = bus.last("ROBUROC4_MOVE_STATUS")
    assert (status.move_id, status.outcome, status.sender) == (7, 1, "planner"), status.message
    assert status.distance_m == pytest.approx(0.6, abs=0.1)
    pose = bus.last("ROBUROC4_LOCALIZATION")
    assert pose.x_m == pytest.approx(0.6, abs=0.1), "it is not driven a second time"
    until(robot.stands, "the robot stands")
