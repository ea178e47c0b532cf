# SPDX-License-Identifier: MIT
"""After an interruption nothing resumes by itself: a stream is rejected until it pauses."""

import signal
import time
from collections.abc import Callable

import pytest
import roburoc4_lcm
from rig import Bridge, Bus, Planner, Robot, until
from rig.bus import now_us

StartBridge = Callable[..., Bridge]
Plan = Callable[..., Planner]
State = roburoc4_lcm.bridge_state_t


def take_over(robot: Robot) -> None:
    robot.tell("pad a down")
    time.sleep(0.7)
    robot.tell("pad a up")


def reboot(robot: Robot) -> None:
    robot.reboot()


def pull_the_cable(robot: Robot) -> None:
    robot.tap.cut = True
    time.sleep(2.5)
    robot.tap.cut = False


def cut_the_motors(robot: Robot) -> None:
    robot.tell("estop remote press")
    time.sleep(1.5)
    robot.tell("estop remote release")
    robot.tell("motor on")


BREAKS = {
    "override": take_over,
    "reboot": reboot,
    "cable": pull_the_cable,
    "emergency stop": cut_the_motors,
}


def break_off(robot: Robot, bridge: Bridge, kind: str) -> int:
    """Break off while commands stream; when the bridge was ready again."""
    until(robot.tap.moves, "a speed reaches the robot")
    time.sleep(0.3)
    BREAKS[kind](robot)
    until(
        lambda: (
            bridge.state.waiting
            and bridge.state.state == State.STATE_READY
            and not bridge.state.overridden
        ),
        "the bridge waits for a pause",
        15,
    )
    return now_us()


@pytest.mark.parametrize("kind", BREAKS)
def test_after_a_break_it_stays_still_until_commands_pause(
    robot: Robot, armed: Bridge, plan: Plan, kind: str
) -> None:
    planner = plan(linear=0.5, rate=20)
    ready_us = break_off(robot, armed, kind)
    refused = armed.statistics.rejected_disarmed
    time.sleep(2.0)
    assert robot.tap.moves(ready_us) == [], "commands stream, it stays still"
    until(robot.stands, "the robot stands")
    assert armed.statistics.rejected_disarmed > refused + 20
    assert not armed.state.armed

    planner.signal(signal.SIGSTOP)
    until(lambda: not armed.state.waiting, "the pause is over")
    assert robot.tap.moves(ready_us) == [], "a pause alone does not move it"
    planner.signal(signal.SIGCONT)
    until(lambda: robot.tap.moves(ready_us), "the next command drives")


def test_a_robot_that_is_absent_is_reported_and_found(
    robot: Robot, bus: Bus, start_bridge: StartBridge
) -> None:
    robot.tap.cut = True
    bridge = start_bridge("--enable-drive")
    until(
        lambda: bridge.state and bridge.state.faults & State.FAULT_SILENT,
        "the bridge says that the robot is silent",
    )
    assert bridge.state.state == State.STATE_CONNECTING
    assert robot.address in bridge.state.message or "robot" in bridge.state.message.lower()
    assert bridge.state.robot_age_us == -1
    assert not bus.of("ROBUROC4_DIFFERENTIAL")
    robot.tap.cut = False
    bridge.connects()
    until(lambda: bridge.state.can_drive, "it can be driven")
    assert bridge.state.faults == 0


def test_a_port_where_nobody_listens_is_reported(start_bridge: StartBridge) -> None:
    bridge = start_bridge(address="127.0.0.1:9")
    until(
        lambda: bridge.state and bridge.state.faults & State.FAULT_REFUSED,
        "the bridge says that the port is closed",
    )
    assert bridge.running
