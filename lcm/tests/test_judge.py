# SPDX-License-Identifier: MIT
"""The judge of lcm/tests/fleet finds all violations and nothing else."""

from collections.abc import Callable

import pytest
from rig.judge import Ask, Host, Judge, Robot, Speed

T = 10_000_000_000_000
MS = 1000


def ask(ms: int, sender: str = "planner", speed: float = 0.5, age_ms: int = 1) -> Ask:
    return Ask(T + ms * MS, T + (ms - age_ms) * MS, sender, speed, 0.0, 0)


def complaints(robot: Robot, **host: list[tuple[int, int]]) -> list[str]:
    return list(Judge({"R": robot}, {0: Host([T], **host)}).complaints())


def driven(until_ms: int = 3000) -> Robot:
    """Streamed from 1 s on, with a speed for each command."""
    robot = Robot(may_drive=frozenset({0}))
    for ms in range(1000, until_ms, 50):
        robot.asks[0].append(ask(ms))
        robot.speeds.append(Speed(T + (ms + 2) * MS, 0, 0.5, 0.0))
    return robot


def test_a_planner_after_a_pause_may_drive() -> None:
    assert complaints(driven()) == []


def speed_at(ms: int, linear: float = 0.5) -> Callable[[Robot], None]:
    return lambda robot: robot.speeds.append(Speed(T + ms * MS, 0, linear, 0.0))


def watched(robot: Robot) -> None:
    robot.may_drive = frozenset({1})


def streaming_since_the_start(robot: Robot) -> None:
    robot.asks[0][:0] = [ask(ms) for ms in range(0, 1000, 100)]


def stopped(robot: Robot) -> None:
    robot.stops[0].append(T + 2000 * MS)


def overridden(robot: Robot) -> None:
    robot.overrides.append((T + 1500 * MS, T + 9000 * MS))


def silent(robot: Robot) -> None:
    robot.blackouts.append((T + 1200 * MS, T + 1900 * MS))


def replayed(robot: Robot) -> None:
    robot.asks[0].append(ask(6000, age_ms=3000))
    speed_at(6010)(robot)


def second_sender(robot: Robot) -> None:
    robot.asks[0].insert(20, ask(1960, "rival", 0.7))
    robot.speeds.insert(20, Speed(T + 1965 * MS, 0, 0.7, 0.0))


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        (speed_at(3600), "no command that holds"),
        (speed_at(3010, 0.6), "no command that holds"),
        (watched, "only watches"),
        (streaming_since_the_start, "no pause since the start"),
        (stopped, "no pause since a stop"),
        (overridden, "somebody holds [A]"),
        (silent, "no pause since its silence"),
        (replayed, "no command that holds"),
        (second_sender, "planner is in control"),
    ],
)
def test_violations_are_found(fault: Callable[[Robot], None], said: str) -> None:
    robot = driven()
    fault(robot)
    found = complaints(robot)
    assert found
    assert said in found[0]


def test_commands_during_a_hang_are_old() -> None:
    robot = driven(2000)
    robot.asks[0].append(ask(3900))
    robot.speeds.append(Speed(T + 4010 * MS, 0, 0.5, 0.0))
    assert complaints(robot) == []
    assert complaints(robot, hangs=[(T + 2500 * MS, T + 4000 * MS)])


def test_another_may_drive_after_the_lease() -> None:
    robot = driven(2000)
    robot.asks[0].append(ask(2400, "rival", 0.7))
    robot.speeds.append(Speed(T + 2405 * MS, 0, 0.7, 0.0))
    assert complaints(robot) == []
