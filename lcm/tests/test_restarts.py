# SPDX-License-Identifier: MIT
"""A restarted bridge, a second bridge, and a broken socket."""

import signal
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import pytest
from rig import Bridge, Bus, Planner, Programs, Robot, until
from rig.bus import drive_command, now_us

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


def test_a_broken_socket_affects_one_robot(
    programs: Programs,
    start_robot: Callable[..., Robot],
    tmp_path: Path,
    ends: ExitStack,
    bus: Bus,
    plan: Plan,
) -> None:
    robots = [start_robot() for _ in range(3)]
    broken = tmp_path / "broken"
    bridge = Bridge(
        programs,
        tmp_path,
        bus,
        f"A={robots[0].address}",
        f"--robot=B={robots[1].address}",
        f"--robot=C={robots[2].address}",
        "--enable-drive",
        environment={
            "LD_PRELOAD": str(programs("break_socket.so")),
            "BREAK_PORT": robots[1].address.rsplit(":", 1)[1],
            "BREAK_FILE": str(broken),
        },
    )
    ends.callback(bridge.end)
    for name in "ABC":
        bus.hears(f"{name}_DIFFERENTIAL")
    time.sleep(0.8)
    planners = [plan(channel=f"{name}_DRIVE_CMD", sender=name, linear=0.3) for name in "AB"]
    until(lambda: robots[0].tap.moves() and robots[1].tap.moves(), "two of them drive")
    broken.touch()
    broken_us = now_us()
    bridge.says("socket")
    time.sleep(2.5)
    assert bridge.running, bridge.output
    assert bus.of("A_DIFFERENTIAL")[-1].time_us > now_us() - 500_000
    assert bus.of("C_DIFFERENTIAL")[-1].time_us > now_us() - 500_000
    assert robots[0].tap.commands()[-1].moves, "A drives on"
    assert robots[1].tap.moves(broken_us + 450_000) == []
    assert robots[1].stands()
    assert bridge.output.count("socket broke") == 1, "logged once"
    # It comes back, and stays still until B's planner has paused.
    broken.unlink()
    mended_us = now_us()
    until(lambda: bus.of("B_DIFFERENTIAL")[-1].time_us > mended_us, "B's statuses come again")
    time.sleep(1.5)
    assert robots[1].tap.moves(mended_us) == []
    planners[1].signal(signal.SIGKILL)
    time.sleep(0.8)
    bus.publish("B_DRIVE_CMD", drive_command(0.3, sender="new").encode())
    until(lambda: robots[1].tap.moves(mended_us), "B can be driven")
