# SPDX-License-Identifier: MIT
"""`roburoc4 record FILE`: every datagram (.pcapng), ROS 2 messages (.mcap), or columns (.csv)."""

from __future__ import annotations

import argparse
import csv
import io
import math
import sys
import time
from contextlib import nullcontext, redirect_stdout, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from ...recordings.rows import Rows, columns
from .. import session
from ..errors import ExitCode, refused, unwritable
from ..options import Options, add_robot, add_seconds
from ..output import note, print_json
from ..progress import progress
from . import record_mcap, record_raw
from .recover import check_new

if TYPE_CHECKING:
    from collections.abc import Iterable
    from io import FileIO
    from typing import Self

    from roburoc4 import Robot, Status

    from ...recordings.rows import Cell

STDOUT = Path("-")
_WAIT_S = 0.2


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "record",
        help="record to a file",
        description="Record until Ctrl-C. FILE.pcapng: every datagram in both directions, for "
        "report, replay, convert and Wireshark. FILE.mcap: statuses and events as ROS 2 messages. "
        "FILE.csv: every status, one row for each robot cycle in which there was one, empty cells "
        "for services that were silent in it.",
    )
    parser.add_argument(
        "file",
        metavar="FILE",
        type=Path,
        help="its suffix chooses the format; -: standard output, CSV",
    )
    add_seconds(parser, "end after this time")
    parser.add_argument("--force", action="store_true", help="replace a file that has contents")
    add_robot(parser, json="print a document at the end (docs/cli.md has its keys)")
    parser.set_defaults(run=run)


def run(options: Options) -> int:
    """Record until the time is over."""
    check_new(options.file, options.force)
    if options.file.suffix.lower() == ".pcapng":
        return record_raw.run(options)
    if options.file.suffix.lower() == ".mcap":
        return record_mcap.run(options)
    with session.connected(options) as robot:
        with Sheet(options.file, columns(robot.properties)) as sheet:
            recording = _Recording(options, robot)
            try:
                recording.run(sheet)
            finally:
                if not sheet.full:
                    recording.report(sheet.rows)
        session.refuse_loss(
            robot, options.robot, "the file ends there; check the robot's power and cable"
        )
    return ExitCode.FINE


class Sheet:
    """A CSV file that contains only whole rows, even when the disk is full."""

    def __init__(self, path: Path, header: list[str]) -> None:
        self._path = path
        self._line = io.StringIO()
        self._csv = csv.DictWriter(self._line, header, extrasaction="ignore")
        self._bytes = 0
        self.rows = 0
        try:
            self._file: FileIO = (
                open(1, "wb", buffering=0, closefd=False)  # noqa: SIM115
                if path == STDOUT
                else path.open("wb", buffering=0)
            )
        except OSError as error:
            raise unwritable(path, error) from None

    @property
    def full(self) -> bool:
        """Whether nothing more fits: the last row written is complete."""
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
        except BrokenPipeError:
            self._file.close()
            raise
        except OSError as error:
            if self._path != STDOUT:  # which may be a file with contents
                with suppress(OSError):  # a pipe
                    self._file.truncate(self._bytes)
            self._file.close()
            raise refused(
                f"{self._path} cannot be written any more ({error.strerror}): the {self.rows} rows "
                "in it are complete; free some space, then record again"
            ) from None
        self._bytes += length


class _Recording:
    """What has been written so far."""

    def __init__(self, options: Options, robot: Robot) -> None:
        from roburoc4.samples import Gaps

        self._options = options
        self._robot = robot
        self._statuses = 0
        self._gaps = Gaps(robot.period_s)

    def run(self, sheet: Sheet) -> None:
        """Write until the time is over; what is left is written however this ends."""
        rows = Rows()
        try:
            self._read(rows, sheet)
        finally:
            self._gaps.end(self._robot.now_s)
            if not sheet.full:
                sheet.write(rows.rest())

    def _read(self, rows: Rows, sheet: Sheet) -> None:
        def take(status: Status) -> None:
            self._statuses += 1
            self._gaps.add(status)
            sheet.write(rows.add(status))

        statuses = self._robot.statuses()
        length_s = self._options.seconds or math.inf
        begun_s = time.monotonic()
        with progress("recording", self._options.seconds) as show:
            while (elapsed_s := time.monotonic() - begun_s) < length_s:
                for status in statuses.take(min(_WAIT_S, length_s - elapsed_s)):
                    take(status)
                show(elapsed_s, f"recording  {sheet.rows} rows")

    def report(self, rows: int) -> None:
        """Report what is in the file and what is missing; on stderr if the file is stdout."""
        file, gaps = self._options.file, self._gaps
        with redirect_stdout(sys.stderr) if file == STDOUT else nullcontext():
            if self._options.json:
                print_json(
                    {
                        "file": str(file),
                        "rows": rows,
                        "statuses": self._statuses,
                        "lost": gaps.lost,
                        "gaps": gaps.found,
                    }
                )
            else:
                print(
                    f"{file}: {rows} rows of {self._statuses} statuses; {gaps.lost} statuses lost"
                )
        if gaps.found:
            times = [gap.seconds for gap in gaps.found]
            note(
                f"the recording has {len(times)} gaps, {sum(times):.1f} s in all, the longest "
                f"{max(times):.1f} s: the robot was silent; check its power and cable"
            )
