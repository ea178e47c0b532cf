# SPDX-License-Identifier: MIT
"""Moves that the bridge drives: leased and gated as speeds are."""

import signal
import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any

import pytest
import roburoc4_lcm
from rig import Bridge, Bus, Robot, until
from rig.bus import drive_command, move_command, now_us, repeated, stop_command

StartBridge = Callable[..., Bridge]
Status = roburoc4_lcm.move_status_t
Command = roburoc4_lcm.move_command_t
MOVE = "ROBUROC4_MOVE_CMD"


def moving(bus: Bus, move_id: int, **fields: float | str) -> AbstractContextManager[None]:
    """Send this move ten times a second."""
    return repeated(lambda: bus.publish(MOVE, move_command(move_id, **fields).encode()), 0.1)


def status_of(bus: Bus, move_id: int) -> Any:
    return next(
        (s for s in reversed(bus.decoded("ROBUROC4_MOVE_STATUS")) if s.move_id == move_id), None
    )


def ends_as(bus: Bus, bridge: Bridge, move_id: int, result: int, seconds: float = 30) -> Any:
    def ended() -> bool:
        status = status_of(bus, move_id)
        return status is not None and status.outcome != Status.OUTCOME_RUNNING

    until(ended, f"move {move_id} ends; the bridge said:\n{bridge.output}", seconds)
    status = status_of(bus, move_id)
    assert status.outcome == result, status.message
    return status


@pytest.mark.parametrize(
    "fields",
    [
        {"kind": Command.KIND_BY, "distance_m": 0.6},
        {"kind": Command.KIND_TO_POINT, "x_m": 0.6, "y_m": 0.0},
        {"kind": Command.KIND_TO_POSE, "x_m": 0.6, "y_m": 0.0, "theta_rad": 0.0},
    ],
    ids=["by", "to point", "to pose"],
)
def test_a_move_reaches_its_goal_once(
    robot: Robot, bus: Bus, armed: Bridge, fields: dict[str, float]
) -> None:
    with moving(bus, 7, **fields):
        status = ends_as(bus, armed, 7, Status.OUTCOME_REACHED)
        time.sleep(0.5)
    assert status.sender == "planner"
    assert status.distance_m == pytest.approx(0.6, abs=0.1)
    pose = bus.last("ROBUROC4_LOCALIZATION")
    assert pose.x_m == pytest.approx(0.6, abs=0.1), "it is not driven a second time"
    assert max(command.linear_m_s for command in robot.tap.moves()) <= 0.3 + 1e-6
    until(robot.stands, "the robot stands")


def test_a_stop_ends_a_move_for_good(robot: Robot, bus: Bus, armed: Bridge) -> None:
    with moving(bus, 1, distance_m=3.0):
        until(robot.tap.moves, "it drives")
        stop_us = now_us()
        bus.publish("ROBUROC4_STOP_CMD", stop_command("operator").encode())
        status = ends_as(bus, armed, 1, Status.OUTCOME_CANCELLED)
        time.sleep(1.5)
    assert robot.tap.moves(stop_us + 150_000) == []
    assert status.remaining_m > 1
    time.sleep(0.6)
    bus.publish(MOVE, move_command(1, distance_m=3.0).encode())
    time.sleep(0.5)
    assert robot.tap.moves(stop_us + 150_000) == [], "a move that has ended does not begin again"
    with moving(bus, 2, distance_m=0.3):
        ends_as(bus, armed, 2, Status.OUTCOME_REACHED)


def test_a_speed_of_its_sender_ends_a_move(robot: Robot, bus: Bus, armed: Bridge) -> None:
    bus.publish(MOVE, move_command(1, distance_m=3.0).encode())
    until(robot.tap.moves, "it drives")
    bus.publish("ROBUROC4_DRIVE_CMD", drive_command(-0.25).encode())
    ends_as(bus, armed, 1, Status.OUTCOME_CANCELLED)
    until(lambda: robot.tap.moves()[-1].linear_m_s == -0.25, "the speed is driven")


@pytest.mark.parametrize(
    "fields",
    [
        {"angle_rad": 90.0},
        {"distance_m": 1.0, "linear_m_s": 30.0},
        {"angle_rad": 1.0, "angular_rad_s": 45.0},
    ],
    ids=["degrees", "speed", "degrees a second"],
)
def test_other_units_are_named(
    robot: Robot, bus: Bus, armed: Bridge, fields: dict[str, float]
) -> None:
    with moving(bus, 1, **fields):
        until(lambda: armed.state.rejected_cause == armed.state.REJECTED_UNITS, "it is rejected")
    assert "radians, at most two turns" in armed.state.rejected_message
    assert "move command of 'planner' rejected" in armed.output
    assert robot.tap.moves() == []


def test_texts_are_those_of_lcm(robot: Robot, bus: Bus, start_bridge: StartBridge) -> None:
    bridge = start_bridge("--enable-drive", "--max-linear", "0.4").arms()
    bus.publish(MOVE, move_command(1, distance_m=3.0).encode())
    assert "move_id" in ends_as(bus, bridge, 1, Status.OUTCOME_LAPSED).message
    with moving(bus, 2, distance_m=1.0, linear_m_s=0.5):
        assert "--max-linear" in ends_as(bus, bridge, 2, Status.OUTCOME_TOO_FAST).message
    with moving(bus, 3, distance_m=3.0):
        until(lambda: status_of(bus, 3), "it begins")
        bus.publish("ROBUROC4_STOP_CMD", stop_command("operator").encode())
        status = ends_as(bus, bridge, 3, Status.OUTCOME_CANCELLED)
    assert "BRIDGE_STATE" in status.message


def test_the_end_of_the_bridge_ends_a_move(robot: Robot, bus: Bus, armed: Bridge) -> None:
    with moving(bus, 1, distance_m=3.0):
        until(robot.tap.moves, "it drives")
        armed.signal(signal.SIGTERM)
        ends_as(bus, armed, 1, Status.OUTCOME_CANCELLED, 3)
