# SPDX-License-Identifier: MIT
"""Several robots in one bridge."""

import itertools
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

from rig import Bridge, Bus, Planner, Programs, Robot, until

Plan = Callable[..., Planner]

ENDS = ("DIFFERENTIAL", "LOCALIZATION", "BATTERY", "TELEMETER", "IOCARD", "BRIDGE_STATE")


def test_ten_robots_in_one_bridge(
    programs: Programs,
    start_robot: Callable[..., Robot],
    tmp_path: Path,
    ends: ExitStack,
    bus: Bus,
    plan: Plan,
) -> None:
    robots = start_robot("--robots", "10")
    names = [f"R{index}" for index in range(10)]
    more = [
        f"--robot={name}={tap.address}"
        for name, tap in zip(names[1:], robots.taps[1:], strict=True)
    ]
    bridge = Bridge(
        programs, tmp_path, bus, f"R0={robots.taps[0].address}", "--enable-drive", *more
    )
    ends.callback(bridge.end)
    for name in names:
        for end in ENDS:
            bus.hears(f"{name}_{end}", 20)
    until(
        lambda: all(bus.last(f"{name}_BRIDGE_STATE").can_drive for name in names),
        "all can be driven",
        20,
    )

    # Each has its own gate: R3 is driven, R7's game pad is held, the others stand.
    robots.tell("robot 8 pad a down")
    plan(channel="R3_DRIVE_CMD", linear=0.5)
    until(robots.taps[3].moves, "R3 drives")
    until(lambda: bus.last("R7_BRIDGE_STATE").overridden, "R7 is overridden")
    time.sleep(1.0)
    for index, tap in enumerate(robots.taps):
        assert bool(tap.moves()) == (index == 3), index
        assert bus.last(f"R{index}_BRIDGE_STATE").can_drive == (index != 7)

    # Nothing gets lost or mixed up: each robot's cycles go on in even steps.
    for name in names:
        times = [message.robot_cycles for message in bus.decoded(f"{name}_DIFFERENTIAL")]
        assert {b - a for a, b in itertools.pairwise(times)} == {5}, name

    robots.tell("robot 5 power off")
    until(
        lambda: bus.last("R4_BRIDGE_STATE").state != bus.last("R5_BRIDGE_STATE").state,
        "the loss of one is the loss of one",
    )
    assert bus.last("R3_BRIDGE_STATE").driving
