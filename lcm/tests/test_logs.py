# SPDX-License-Identifier: MIT
"""lcm-logger records the robot, logs read back, and a replayed log moves nothing."""

import signal
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import lcm
import pytest
from rig import Bridge, Bus, Planner, Program, Programs, Robot, until
from rig.bus import OUTPUTS, now_us

Run = Callable[..., Program]
StartBridge = Callable[..., Bridge]
Plan = Callable[..., Planner]

DRIVE = "ROBUROC4_DRIVE_CMD"


@pytest.fixture
def record(run: Run, bus: Bus, tmp_path: Path) -> Callable[[], tuple[Program, Path]]:
    """Start lcm-logger, and wait until it has begun."""

    def start() -> tuple[Program, Path]:
        log = tmp_path / "lcmlog"
        # Debian's lcm-logger knows the long option only.
        logger = run(Programs.of_lcm("lcm-logger"), f"--lcm-url={bus.url}", log)
        until(lambda: log.exists() and log.stat().st_size > 0, "lcm-logger writes")
        return logger, log

    return start


def finish(logger: Program) -> None:
    logger.signal(signal.SIGINT)
    logger.ends()


def replay(run: Run, bus: Bus, log: Path) -> None:
    """Play all of a log to the bus, and wait for its end."""
    player = run(Programs.of_lcm("lcm-logplayer"), f"--lcm-url={bus.url}", log)
    assert player.ends(60) == 0, player.output


def test_lcm_logger_records_and_the_log_reads_back(
    robot: Robot, bus: Bus, armed: Bridge, plan: Plan, record: Callable[[], tuple[Program, Path]]
) -> None:
    logger, log = record()
    begun_us = now_us()
    plan()
    time.sleep(2.0)
    ended_us = now_us()
    time.sleep(0.5)
    finish(logger)
    heard = [message for message in bus.messages if begun_us < message.time_us < ended_us]
    events = list(lcm.EventLog(str(log), "r"))
    recorded = Counter((event.channel, event.data) for event in events)
    for message in heard:
        assert recorded[message.channel, message.data] == 1, message.channel
    always = set(OUTPUTS) - {"MOVE_STATUS"}
    assert {f"ROBUROC4_{end}" for end in always} | {DRIVE} <= {event.channel for event in events}
    for event in events:
        for end, kind in OUTPUTS.items():
            if event.channel == f"ROBUROC4_{end}":
                kind.decode(event.data)


def rejected(bridge: Bridge) -> int:
    counted = bridge.statistics
    return int(
        counted.rejected_too_old
        + counted.rejected_repeated
        + counted.rejected_in_future
        + counted.rejected_starting
        + counted.rejected_disarmed
    )


def test_a_replayed_log_does_not_move_the_robot(
    robot: Robot,
    bus: Bus,
    armed: Bridge,
    plan: Plan,
    run: Run,
    record: Callable[[], tuple[Program, Path]],
) -> None:
    logger, log = record()
    planner = plan()
    until(robot.tap.moves, "live commands drive")
    time.sleep(0.5)
    planner.signal(signal.SIGKILL)
    until(lambda: not armed.state.driving, "the lease is over")
    finish(logger)
    time.sleep(0.3)
    replayed_us = now_us()
    before, heard = rejected(armed), len(bus.of(DRIVE))
    replay(run, bus, log)
    time.sleep(0.5)
    commands = len(bus.of(DRIVE)) - heard
    assert commands > 5, "the log has commands"
    assert robot.tap.moves(replayed_us) == []
    assert rejected(armed) - before == commands
