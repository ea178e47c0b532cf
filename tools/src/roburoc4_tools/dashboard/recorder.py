# SPDX-License-Identifier: MIT
"""The record button: it writes what `roburoc4 record` writes, kept until the next recording."""

from __future__ import annotations

import csv
import io
import tempfile
import time
from collections.abc import Callable
from typing import IO, Any, Protocol

from roburoc4.notices import texts_of
from roburoc4.records import Status
from roburoc4.robot import Robot
from roburoc4.samples import Events, Statuses

from ..recordings.recording import RecordedEvent
from ..recordings.rows import Rows, columns

MOST_BYTES = 500_000_000
_CHUNK = 16 * 1024
"""Size of chunks in an MCAP file: about a second."""


class RecordError(Exception):
    """Why it is not recorded, shown on the page."""


class _Format(Protocol):
    """A file that is being written."""

    def add(self, item: Status | RecordedEvent) -> None:
        """Add the next status."""

    def finish(self) -> None:
        """Complete the file."""


class _Table:
    """Statuses as columns (.csv): only whole rows at any time."""

    def __init__(self, file: IO[bytes], robot: Robot) -> None:
        self._file = file
        self._rows = Rows()
        self._line = io.StringIO()
        self._csv = csv.DictWriter(self._line, columns(robot.properties), extrasaction="ignore")
        self._csv.writeheader()
        self._append([])

    def add(self, item: Status | RecordedEvent) -> None:
        if not isinstance(item, RecordedEvent):
            self._append(list(self._rows.add(item)))

    def finish(self) -> None:
        self._append(list(self._rows.rest()))

    def _append(self, rows: list[Any]) -> None:
        self._csv.writerows(rows)
        self._file.write(self._line.getvalue().encode())
        self._line.seek(0)
        self._line.truncate()


def _bag(file: IO[bytes], robot: Robot) -> _Format | None:
    """Statuses and events as ROS 2 messages (.mcap), if the extra `record` is installed."""
    from ..ros.rosbag import RosBag

    try:
        return RosBag(file, robot, robot.address, time.time() - robot.now_s, chunk_size=_CHUNK)
    except ModuleNotFoundError:
        return None


_FORMS: dict[str, Callable[[IO[bytes], Robot], _Format | None]] = {"csv": _Table, "mcap": _bag}


class Recorder:
    """One recording of a robot, which continues while pages come and go."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._facts = robot.facts
        self._files: dict[str, IO[bytes]] = {}
        self._formats: list[_Format] = []
        self._statuses: Statuses[Status] | None = None
        self._events: Events | None = None
        self._begun_s = self._length_s = 0.0
        self._count = self._lost = 0
        self.why = ""
        """Why it ended by itself."""

    @property
    def on(self) -> bool:
        """Whether it records."""
        return self._statuses is not None

    @property
    def now(self) -> dict[str, Any] | None:
        """What a page shows of it; None if nothing was recorded."""
        if not self._files:
            return None
        length_s = time.monotonic() - self._begun_s if self.on else self._length_s
        return {
            "on": self.on,
            "statuses": self._count,
            "seconds": int(length_s),
            "lost": self._lost,
            "why": self.why,
            "forms": self.forms,
        }

    @property
    def forms(self) -> list[str]:
        """What can be downloaded: an MCAP file once it is complete."""
        return [form for form in self._files if form == "csv" or not self.on]

    def path(self, form: str) -> str | None:
        """Return the path of the recording in this form, if it can be downloaded."""
        if form not in self.forms:
            return None
        self._files[form].flush()
        return self._files[form].name

    def start(self) -> None:
        """Start over; the previous recording is deleted."""
        if self.on:
            return
        if self._robot.properties.differential is None:
            raise RecordError("there is nothing to record yet: the robot is not known")
        self.close()
        for form, begin in _FORMS.items():
            # It is closed by close(): recordings outlive this call.
            file = tempfile.NamedTemporaryFile(prefix="roburoc4-", suffix=f".{form}")  # noqa: SIM115
            if (begun := begin(file, self._robot)) is None:
                file.close()
                continue
            self._files[form] = file
            self._formats.append(begun)
        self._count = self._lost = 0
        self.why = ""
        self._begun_s = time.monotonic()
        self._facts = self._robot.facts
        self._events, self._statuses = self._robot.events(), self._robot.statuses()

    def stop(self) -> None:
        """Stop; what was recorded can still be downloaded."""
        if self.on:
            self.step()
            self._end("")

    def step(self) -> None:
        """Write what has arrived."""
        if self._statuses is None or self._events is None:
            return
        try:
            for status in self._statuses.take():
                self._take(status)
            before, self._facts = self._facts, self._robot.facts
            for level, text in texts_of(self._events.take(), before, self._facts):
                self._add(RecordedEvent(round(self._robot.now_s * 1e6), level, text))
        except OSError as error:
            self._end(f"it cannot be written any more ({error.strerror}): make room")
        else:
            self._lost = self._statuses.lost
            if sum(file.tell() for file in self._files.values()) > MOST_BYTES:
                self._end("it reached 500 MB")

    def _take(self, status: Status) -> None:
        self._count += 1
        self._add(status)

    def _add(self, item: Status | RecordedEvent) -> None:
        for written in self._formats:
            written.add(item)

    def _end(self, why: str) -> None:
        if self._statuses is None:
            return
        self._statuses = None
        self._length_s = time.monotonic() - self._begun_s
        self.why = why
        try:
            for written in self._formats:
                written.finish()
        except OSError as error:
            self.why = f"it cannot be completed ({error.strerror}): make room"

    def close(self) -> None:
        """Stop, and delete the recording."""
        self._statuses = None
        self._formats.clear()
        for file in self._files.values():
            file.close()
        self._files.clear()
