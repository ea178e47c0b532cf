# SPDX-License-Identifier: MIT
"""`roburoc4 monitor`: shows what the robot reports, live. It never commands."""

from __future__ import annotations

import argparse
import math
import time
from typing import TYPE_CHECKING, Any

from ...plain import plain
from .. import session
from ..errors import ExitCode
from ..names import names_of
from ..options import Options, add_robot, add_seconds
from ..output import console, is_terminal, note, print_json

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.console import RenderableType

    from roburoc4 import Robot, Status

    from .snapshot import Snapshot

_REFRESH_S = 0.1
_LINE_S = 1.0


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "monitor",
        help="show what the robot reports, live",
        description="Show values, rates, ages and losses of all statuses until Ctrl-C. "
        "With --json every status is an object on its own line.",
    )
    add_seconds(parser, "end after this time")
    add_robot(parser)
    parser.set_defaults(run=run)


def run(options: Options) -> int:
    """Show the statuses until the time is over."""
    with session.connected(options) as robot:
        watch = _Watch(robot, options.seconds or math.inf)
        if options.json:
            _print_statuses(watch)
        elif is_terminal():
            _show_table(watch)
        else:
            _print_lines(watch)
        session.refuse_loss(
            robot, robot.address, "check its power and cable, then run roburoc4 doctor"
        )
    return ExitCode.FINE


class _Watch:
    """How long to watch, and messages about a link that is lost and found again."""

    def __init__(self, robot: Robot, seconds: float) -> None:
        self.robot = robot
        self._begun_s = time.monotonic()
        self._seconds = seconds
        self._was_ready = True

    @property
    def elapsed_s(self) -> float:
        return time.monotonic() - self._begun_s

    @property
    def left_s(self) -> float:
        return self._seconds - self.elapsed_s

    def tell_breaks(self) -> None:
        ready = self.robot.state.name == "READY"
        if ready != self._was_ready:
            what = "is back" if ready else "fell silent; connecting again"
            note(f"{self.robot.address} {what}")
        self._was_ready = ready

    def snapshot(self) -> Snapshot:
        from .snapshot import take

        return take(self.robot, self.elapsed_s, names_of(self.robot))


def record_of(status: Status) -> dict[str, Any]:
    """Make the JSON object of a status."""
    from roburoc4 import BatteryStatus

    record = {"service": status.service, "utc_s": status.utc_s, **plain(status)}
    del record["host_us"]
    if isinstance(status, BatteryStatus):
        record["state_name"] = status.state_name
    return record


def _print_statuses(watch: _Watch) -> None:
    for status in _statuses(watch):
        print_json(record_of(status), line=True)


def _statuses(watch: _Watch) -> Iterator[Status]:
    statuses, lost = watch.robot.statuses(), 0
    while (left_s := watch.left_s) > 0.0:
        watch.tell_breaks()
        yield from statuses.take(min(_REFRESH_S, left_s))
        if statuses.lost > lost:
            note(
                f"{statuses.lost - lost} statuses were lost: the program that reads this output "
                "is too slow"
            )
            lost = statuses.lost


def _print_lines(watch: _Watch) -> None:
    from .view import line

    while watch.left_s > 0.0:
        time.sleep(min(_LINE_S, watch.left_s))
        watch.tell_breaks()
        print(line(watch.snapshot()), flush=True)


def _show_table(watch: _Watch) -> None:
    from rich.live import Live

    from .view import render

    screen = console()

    def picture() -> RenderableType:
        return render(watch.snapshot(), screen.width)

    with Live(picture(), console=screen, auto_refresh=False) as live:
        while watch.left_s > 0.0:
            time.sleep(min(_REFRESH_S, max(0.0, watch.left_s)))
            live.update(picture(), refresh=True)
