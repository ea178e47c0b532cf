# SPDX-License-Identifier: MIT
"""A restarted bridge, a second bridge, and a broken socket."""

import signal
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import pytest
from rig import Bridge, Bus, Planner, Programs, Robot, until
from rig.bus import now_us

StartBridge = Callable[..., Bridge]
Plan = Callable[..., Planner]


@pytest.mark.parametrize("options", [[], ["--max-age-ms=0"]], ids=["max age", "any age"])
@pytest.mark.parametrize("ending", [signal.SIGKILL, signal.SIGTERM])
def test_a_restarted_bridge_stays_still_until_commands_pause(
    robot: Robot,
    start_bridge: StartBridge,
    plan: Plan,
    ending: signal.Signals,
    options: list[str],
) -> None:
    bridge = start_bridge("--enable-drive", *options).connects()
    time.sleep(0.8)
    planner = plan(linear=0.5)
    until(robot.tap.moves, "a speed reaches the robot")
    bridge.signal(ending)
    bridge.ends()
    until(robot.stands, "the robot stands")
    restarted_us = now_us()
    start_bridge("--enable-drive", *options)
    until(lambda: robot.tap.statuses()[-1][0] > restarted_us, "the robot sends statuses")
    time.sleep(3.0)
    assert robot.tap.moves(restarted_us) == [], "commands stream, it stays still"
    planner.signal(signal.SIGSTOP)
    time.sleep(0.8)
    paused_us = now_us()
    planner.signal(signal.SIGCONT)
    until(lambda: robot.tap.moves(paused_us), "the next command drives")


def test_two_bridges_for_one_robot_notice_each_other(
    robot: Robot, start_bridge: StartBridge
) -> None:
    first = start_bridge().connects()
    assert "another bridge" not in first.output
    second = start_bridge("--prefix=OTHER")
    first.says("another bridge")
    second.says("another bridge")
    assert str(first.process.pid) in second.output
    assert str(second.process.pid) in first.output
    second.end()
    first.says("the other bridge is gone")


def test_two_bridges_on_the_same_channels_notice_each_other(
    start_robot: Callable[..., Robot], start_bridge: StartBridge
) -> None:
    first = start_bridge().connects()
    second = start_bridge(address=start_robot().address)
    first.says("another bridge")
    second.says("another bridge")


def test_bridges_for_different_robots_report_no_conflict(
    start_robot: Callable[..., Robot], start_bridge: StartBridge
) -> None:
    first = start_bridge().connects()
    second = start_bridge("--prefix=OTHER", address=start_robot().address)
    time.sleep(1.5)
    assert "another bridge" not in first.output + second.output


def test_a_robot_without_a_socket_is_retried(
    programs: Programs, robot: Robot, tmp_path: Path, ends: ExitStack, bus: Bus
) -> None:
    """No socket can be connected to the broadcast address."""
    bridge = Bridge(
        programs, tmp_path, bus, f"A={robot.address}", "--robot=B=255.255.255.255", "--quiet"
    )
    ends.callback(bridge.end)
    bridge.says("no socket for 255.255.255.255:60000")
    bus.hears("A_DIFFERENTIAL")
    until(
        lambda: "no socket" in bus.last("B_BRIDGE_STATE").message,
        "the state says so",
    )
    time.sleep(2.5)
    assert bridge.running
    assert bridge.output.count("no socket") == 1, "logged once"
