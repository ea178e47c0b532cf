# SPDX-License-Identifier: MIT
"""A fleet from a configuration file: each robot has its own settings and faults."""

import itertools
import subprocess
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import pytest
from rig import Bridge, Bus, Planner, Programs, Robot, until

StartFleet = Callable[..., Bridge]
Plan = Callable[..., Planner]


@pytest.fixture
def start_fleet(
    programs: Programs, tmp_path: Path, ends: ExitStack, bus: Bus
) -> Callable[[str], Bridge]:
    def start(text: str) -> Bridge:
        file = tmp_path / "fleet.ini"
        file.write_text(text)
        bridge = Bridge(programs, tmp_path, bus, None, "--config", str(file))
        ends.callback(bridge.end)
        return bridge

    return start


def can_drive(bus: Bus, *names: str) -> None:
    def all_can() -> bool:
        states = [bus.last(f"{name}_BRIDGE_STATE") for name in names]
        return all(state and state.can_drive for state in states)

    until(all_can, f"{names} can be driven")


def test_each_robot_has_its_own_permissions(
    start_robot: Callable[..., Robot], start_fleet: StartFleet, bus: Bus, plan: Plan
) -> None:
    red, blue = start_robot("--robots", "2").taps
    start_fleet(
        f"[RED]\naddress = {red.address}\nenable-drive = yes\nlease-ms = 100\n"
        "channel.DRIVE_CMD = GO_RED_CMD\n"
        f"[BLUE]\naddress = {blue.address}\nperiod-ms.battery = 0\n"
    )
    can_drive(bus, "RED")
    plan(channel="GO_RED_CMD", linear=0.5)
    plan(channel="BLUE_DRIVE_CMD", linear=0.5, sender="other")
    until(red.moves, "RED drives")
    until(
        lambda: bus.last("BLUE_BRIDGE_STATISTICS").rejected_disabled > 5, "commands were rejected"
    )
    assert not blue.moves()
    assert bus.last("RED_BRIDGE_STATE").lease_us == 100_000
    assert bus.last("BLUE_BRIDGE_STATE").lease_us == 300_000
    assert bus.of("RED_BATTERY")
    assert not bus.of("BLUE_BATTERY")


def test_a_name_without_address_affects_one_robot(
    start_robot: Callable[..., Robot], start_fleet: StartFleet, bus: Bus
) -> None:
    robot = start_robot()
    bridge = start_fleet(
        "[LOST]\naddress = no-such-robot.invalid\n"
        f"[RED]\naddress = {robot.address}\nenable-drive = yes\n"
        "[OFF]\naddress = 127.0.0.1:9\n"
    )
    can_drive(bus, "RED")
    assert "LOST: the name no-such-robot.invalid has no address" in bridge.output
    bus.hears("LOST_BRIDGE_STATE")
    state = bus.last("LOST_BRIDGE_STATE")
    assert (state.robot, state.can_drive) == ("no-such-robot.invalid", False)
    bridge.says("OFF: no answer from 127.0.0.1:9")
    assert "LOST: no answer" not in bridge.output, "it is not tried again"


def test_a_flood_from_one_robot_does_not_affect_others(
    start_robot: Callable[..., Robot], start_fleet: StartFleet, bus: Bus, plan: Plan
) -> None:
    robots = start_robot("--robots", "2")
    red, blue = robots.taps
    bridge = start_fleet(
        "[DEFAULT]\nenable-drive = yes\n"
        f"[RED]\naddress = {red.address}\n[BLUE]\naddress = {blue.address}\n"
    )
    can_drive(bus, "RED", "BLUE")
    plan(channel="BLUE_DRIVE_CMD", linear=0.3)
    until(blue.moves, "BLUE drives")
    end = time.monotonic() + 3.0
    while time.monotonic() < end:
        red.inject(b"\xff\x05\x00nonsense")
    assert "BLUE: disarmed" not in bridge.output, bridge.output
    assert bus.last("BLUE_BRIDGE_STATE").driving
    cycles = [message.robot_cycles for message in bus.decoded("BLUE_DIFFERENTIAL")]
    assert {b - a for a, b in itertools.pairwise(cycles)} == {5}


def test_60_robots_in_one_bridge(
    start_robot: Callable[..., Robot], start_fleet: StartFleet, bus: Bus
) -> None:
    taps = start_robot("--robots", "60").taps
    start_fleet("".join(f"[R{at}]\naddress = {tap.address}\n" for at, tap in enumerate(taps)))
    for at in range(60):
        bus.hears(f"R{at}_LOCALIZATION", 20)


def test_check_shows_what_would_run(programs: Programs, tmp_path: Path) -> None:
    file = tmp_path / "fleet.ini"

    def check() -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [programs("roburoc4-lcm"), "--config", file, "--check"],
            capture_output=True,
            text=True,
            timeout=20,
            check=False,
        )

    file.write_text(
        "[RED]\naddress = 10.0.0.1\nenable-drive = yes\nmax-age-ms = 0\n"
        "channel.LOCALIZATION = ODOMETRY\n[BLUE]\naddress = 10.0.0.2\n"
    )
    done = check()
    assert done.returncode == 0, done
    red, blue = done.stdout.split("BLUE: ")
    assert "RED: 10.0.0.1:60000" in red
    for text in ("obeys stop, drive;", "ANY AGE", "ODOMETRY instead of RED_LOCALIZATION"):
        assert text in red
    assert "obeys stop only;" in blue

    file.write_text("[RED]\naddress = 10.0.0.1\nspeed = 3\n")
    done = check()
    assert done.returncode == 2
    assert f"{file}:3: speed = 3: no such setting" in done.stderr
