# SPDX-License-Identifier: MIT
"""A fleet from a configuration file: each robot has its own settings and faults."""

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
    assert bus.last("BLUE_BRIDGE_STATE").lease_us == 250_000
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
