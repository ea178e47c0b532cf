# SPDX-License-Identifier: MIT
"""`roburoc4 record FILE.csv`: the robot's statuses as columns."""

from __future__ import annotations

import argparse
import csv
import io
import math
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from . import session
from .errors import ExitCode, refused, usage
from .options import Options, add_robot, add_seconds
from .output import note, print_json
from .progress import progress
from .rows import Rows, columns

if TYPE_CHECKING:
    from collections.abc import Iterable
    from io import FileIO
    from typing import Self

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
        with _Sheet(options.file, columns(robot.properties)) as sheet:
            recording.run(robot, sheet)
        recording.report(sheet.rows)
        session.refuse_loss(
            robot, options.robot, "the file ends there; look at the robot's power and cable"
        )
    return ExitCode.FINE


class _Sheet:
    """A CSV file that has whole rows only, on a full disk too."""

    def __init__(self, path: Path, header: list[str]) -> None:
        self._path = path
        self._line = io.StringIO()
        self._csv = csv.DictWriter(self._line, header, extrasaction="ignore")
        self._bytes = 0
        self.rows = 0
        try:
            self._file: FileIO = path.open("wb", buffering=0)
        except OSError as error:
            raise usage(f"{path} cannot be written ({error.strerror}): give another name") from None

    @property
    def full(self) -> bool:
        """Whether no more fits: what was last written is closed."""
        return self._file.closed

    def __enter__(self) -> Self:
        self._csv.writeheader()
        self._append()
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def write(self, rows: Iterable[dict[str, Cell]]) -> None:
        """Append rows."""
        for row in rows:
            self._csv.writerow(row)
            self._append()
            self.rows += 1

    def _append(self) -> None:
        left = self._line.getvalue().encode()
        self._line.seek(0)
        self._line.truncate()
        length = len(left)
        try:
            while left:
                left = left[self._file.write(left) :]
        except OSError as error:
            with suppress(OSError):  # a pipe
                self._file.truncate(self._bytes)
            self._file.close()
            raise refused(
                f"{self._path} cannot be written any more ({error.strerror}): the {self.rows} rows "
                "in it are whole; make room, then record again"
            ) from None
        self._bytes += length


class _Recording:
    """What was written so far."""

    def __init__(self, options: RecordOptions) -> None:
        self._options = options
        self._statuses = 0
        self._lost = 0

    def run(self, robot: Robot, sheet: _Sheet) -> None:
        """Write until the time is over; what is left is written however this ends."""
        rows = Rows()
        try:
            self._read(robot, rows, sheet)
        finally:
            if not sheet.full:
                sheet.write(rows.rest())

    def _read(self, robot: Robot, rows: Rows, sheet: _Sheet) -> None:
        from roburoc4 import SamplesLostError

        source = robot.reader()
        length_s = self._options.seconds or math.inf
        begun_s = time.monotonic()
        with progress("recording", self._options.seconds) as show:
            while (elapsed_s := time.monotonic() - begun_s) < length_s:
                source.wait(min(_WAIT_S, length_s - elapsed_s))
                try:
                    while (status := source.next()) is not None:
                        self._statuses += 1
                        sheet.write(rows.add(status))
                except SamplesLostError as error:
                    self._lost += error.lost
                show(elapsed_s, f"recording  {sheet.rows} rows")

    def report(self, rows: int) -> None:
        """Say what is in the file."""
        if self._options.json:
            print_json(
                {
                    "file": str(self._options.file),
                    "rows": rows,
                    "statuses": self._statuses,
                    "lost": self._lost,
                }
            )
        else:
            print(f"{self._options.file}: {rows} rows of {self._statuses} statuses")
        if self._lost:
            note(f"{self._lost} statuses came faster than they could be written")
