# SPDX-License-Identifier: MIT
"""`roburoc4 record FILE.csv`: the robot's statuses as columns."""

from __future__ import annotations

import argparse
import csv
import math
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from . import session
from .errors import ExitCode, refused, usage
from .options import Options, add_robot, add_seconds
from .output import note, print_json
from .progress import progress
from .rows import Rows, columns

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from roburoc4 import Robot

    from .rows import Cell

_WAIT_S = 0.2


class RecordOptions(Options):
    """What `record` is given."""

    file: Path
    seconds: float | None
    force: bool


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "record",
        help="write statuses to a CSV file",
        description="Write every status to FILE.csv until Ctrl-C: one row for each robot cycle in "
        "which there was one, empty cells for services that said nothing in it.",
    )
    parser.add_argument("file", metavar="FILE.csv", type=Path)
    add_seconds(parser, "end after so long")
    parser.add_argument("--force", action="store_true", help="replace a file that has contents")
    add_robot(parser)
    parser.set_defaults(run=run)


def run(options: RecordOptions) -> int:
    """Record until the time is over."""
    if not options.force and options.file.is_file() and options.file.stat().st_size > 0:
        raise usage(f"{options.file} exists: give another name, or --force to replace it")
    recording = _Recording(options)
    with session.connected(options) as robot:
        with _file(options.file) as file:
            recording.run(robot, file)
        lost = robot.state.name != "READY"
    recording.report()
    if lost:
        raise refused(
            f"{options.robot} fell silent and did not come back: the file ends there; look at the "
            "robot's power and cable"
        )
    return ExitCode.FINE


@contextmanager
def _file(path: Path) -> Iterator[TextIO]:
    from roburoc4 import RobotError

    try:
        with path.open("w", newline="", encoding="utf-8") as file:
            yield file
    except RobotError:
        raise  # some are an OSError, too
    except OSError as error:
        raise usage(f"{path} cannot be written ({error.strerror}): give another name") from None


class _Recording:
    """What was written so far."""

    def __init__(self, options: RecordOptions) -> None:
        self._options = options
        self._rows = 0
        self._statuses = 0
        self._lost = 0

    def run(self, robot: Robot, file: TextIO) -> None:
        """Write until the time is over; what is left is written however this ends."""
        header = columns(robot.properties)
        writer = csv.DictWriter(file, header, extrasaction="ignore")
        writer.writeheader()
        rows = Rows()
        try:
            self._read(robot, rows, writer)
        finally:
            self._write(writer, rows.rest())

    def _read(self, robot: Robot, rows: Rows, writer: csv.DictWriter[str]) -> None:
        from roburoc4 import SamplesLostError

        source = session.status_reader(robot)
        length_s = self._options.seconds or math.inf
        begun_s = time.monotonic()
        with progress("recording", self._options.seconds) as show:
            while (elapsed_s := time.monotonic() - begun_s) < length_s:
                source.wait(min(_WAIT_S, length_s - elapsed_s))
                try:
                    while (status := source.next()) is not None:
                        self._statuses += 1
                        self._write(writer, rows.add(status))
                except SamplesLostError as error:
                    self._lost += error.lost
                show(elapsed_s, f"recording  {self._rows} rows")

    def _write(self, writer: csv.DictWriter[str], rows: Iterable[dict[str, Cell]]) -> None:
        for row in rows:
            writer.writerow(row)
            self._rows += 1

    def report(self) -> None:
        """Say what is in the file."""
        if self._options.json:
            print_json(
                {
                    "file": str(self._options.file),
                    "rows": self._rows,
                    "statuses": self._statuses,
                    "lost": self._lost,
                }
            )
        else:
            print(f"{self._options.file}: {self._rows} rows of {self._statuses} statuses")
        if self._lost:
            note(f"{self._lost} statuses came faster than they could be written")
