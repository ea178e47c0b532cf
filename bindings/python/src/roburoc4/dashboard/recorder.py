# SPDX-License-Identifier: MIT
"""The record button: statuses as `roburoc4 record` writes them, kept until the next recording."""

from __future__ import annotations

import csv
import io
import tempfile
import time
from typing import IO, Any

from ..cli.rows import Rows, columns
from ..records import Status
from ..robot import Robot
from ..samples import Reader

MOST_BYTES = 500_000_000


class RecordError(Exception):
    """Why it is not recorded, to be shown on the page."""


class Recorder:
    """One recording of a robot, which goes on while pages come and go."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._file: IO[bytes] | None = None
        self._reader: Reader[Status] | None = None
        self._rows = Rows()
        self._line = io.StringIO()
        self._csv: csv.DictWriter[str] | None = None
        self._begun_s = self._length_s = 0.0
        self._count = self._bytes = self._lost = 0
        self.why = ""
        """Why it ended by itself."""

    @property
    def on(self) -> bool:
        """Whether it records."""
        return self._reader is not None

    @property
    def now(self) -> dict[str, Any] | None:
        """What a page shows of it; None where nothing was recorded."""
        if self._file is None:
            return None
        length_s = time.monotonic() - self._begun_s if self.on else self._length_s
        return {
            "on": self.on,
            "rows": self._count,
            "seconds": int(length_s),
            "lost": self._lost,
            "why": self.why,
        }

    @property
    def path(self) -> str | None:
        """Where it is, with whole rows only."""
        if self._file is None:
            return None
        self._file.flush()
        return self._file.name

    def start(self) -> None:
        """Begin anew; the recording before is deleted."""
        if self.on:
            return
        if self._robot.properties.differential is None:
            raise RecordError("there is nothing to record yet: the robot is not known")
        self.close()
        # It is closed by close(): recordings outlive this call.
        self._file = tempfile.NamedTemporaryFile(prefix="roburoc4-", suffix=".csv")  # noqa: SIM115
        self._rows = Rows()
        self._csv = csv.DictWriter(
            self._line, columns(self._robot.properties), extrasaction="ignore"
        )
        self._count = self._bytes = self._lost = 0
        self.why = ""
        self._begun_s = time.monotonic()
        self._csv.writeheader()
        self._append()
        self._reader = self._robot.reader()

    def stop(self) -> None:
        """End it; what was recorded remains to be downloaded."""
        if not self.on:
            return
        self.step()
        self._write(list(self._rows.rest()))
        self._reader = None
        self._length_s = time.monotonic() - self._begun_s

    def step(self) -> None:
        """Write what came in."""
        if self._reader is None:
            return
        try:
            self._reader.drain(lambda status: self._write(list(self._rows.add(status))))
        except OSError as error:
            self._end(f"it cannot be written any more ({error.strerror}): make room")
        else:
            self._lost = self._reader.lost
            if self._bytes > MOST_BYTES:
                self._end("it reached 500 MB")

    def _end(self, why: str) -> None:
        self._reader = None
        self._length_s = time.monotonic() - self._begun_s
        self.why = why

    def _write(self, rows: list[Any]) -> None:
        assert self._csv is not None
        self._csv.writerows(rows)
        self._count += len(rows)
        self._append()

    def _append(self) -> None:
        assert self._file is not None
        data = self._line.getvalue().encode()
        self._line.seek(0)
        self._line.truncate()
        self._file.write(data)
        self._bytes += len(data)

    def close(self) -> None:
        """End, and delete it."""
        self._reader = None
        if self._file is not None:
            self._file.close()
            self._file = None
