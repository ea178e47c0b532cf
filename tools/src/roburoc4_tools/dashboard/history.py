# SPDX-License-Identifier: MIT
"""What a page that opens later still shows. All of it has a fixed size."""

from __future__ import annotations

import itertools
import math
from array import array
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

SPEED_EVERY_S = 0.2
SPEED_ROWS = 3000
BATTERY_EVERY_S = 10.0
BATTERY_ROWS = 4320
PATH_STEP_M = 0.03
PATH_STEP_RAD = 0.1
PATH_EVERY_S = 0.1
PATH_ROWS = 6000
"""Ten minutes of driving."""
EVENT_ROWS = 200
_TREND_ROWS = 60
_TREND_LEAST_ROWS = 6
_DIGITS = 3


class Ring:
    """The latest rows of a table of numbers; its memory is allocated once."""

    def __init__(self, columns: int, rows: int) -> None:
        self._columns = columns
        self._rows = rows
        self._data = array("d", bytes(8 * columns * rows))
        self._written = 0

    def __len__(self) -> int:
        return min(self._written, self._rows)

    def append(self, row: Sequence[float]) -> None:
        """Add a row, replacing the oldest."""
        place = self._written % self._rows * self._columns
        self._data[place : place + self._columns] = array("d", row)
        self._written += 1

    def clear(self) -> None:
        """Forget all rows."""
        self._written = 0

    def row(self, back: int) -> tuple[float, ...]:
        """Return the ``back``-th row before the latest."""
        place = (self._written - 1 - back) % self._rows * self._columns
        return tuple(self._data[place : place + self._columns])

    def columns(self) -> list[list[float | None]]:
        """Return all columns, oldest first, ready for JSON."""
        rows = [self.row(back) for back in reversed(range(len(self)))]
        return [[number(value) for value in column] for column in zip(*rows, strict=True)] or [
            [] for _ in range(self._columns)
        ]


def number(value: float, digits: int = _DIGITS) -> float | None:
    """Round for JSON, which has no NaN and no infinity."""
    return round(value, digits) if math.isfinite(value) else None


class Notice(NamedTuple):
    """Something that happened."""

    number: int
    time_s: float
    """Unix time."""
    level: str
    """bad, weak, good or plain."""
    text: str


class History:
    """Recent speeds, battery values, path and events."""

    def __init__(self) -> None:
        self.speeds = Ring(5, SPEED_ROWS)
        self.battery = Ring(3, BATTERY_ROWS)
        self.path = Ring(4, PATH_ROWS)
        self.events: deque[Notice] = deque(maxlen=EVENT_ROWS)
        self._latest_s = -math.inf
        self._speed_due_s = -math.inf
        self._battery_due_s = -math.inf
        self._battery_gap = False
        self._place = (math.inf, math.inf, math.inf)
        self._place_s = -math.inf

    @property
    def last_event(self) -> int:
        """The newest event's number; 0 if nothing has happened yet."""
        return self.events[-1].number if self.events else 0

    def note(self, time_s: float, level: str, text: str) -> None:
        """Add to the list of events."""
        self.events.append(Notice(self.last_event + 1, time_s, level, text))

    def add_speeds(self, time_s: float, speeds: Sequence[float]) -> None:
        """Store target and current speeds periodically."""
        self._look_at_clock(time_s)
        if time_s >= self._speed_due_s:
            self._speed_due_s = time_s + SPEED_EVERY_S
            self.speeds.append((time_s, *speeds))

    def add_battery(self, time_s: float, percent: float, volts: float) -> None:
        """Store the battery's values periodically; a percentage of NaN is one row, a gap."""
        self._look_at_clock(time_s)
        before, self._battery_gap = self._battery_gap, math.isnan(percent)
        due = time_s >= self._battery_due_s and not self._battery_gap
        if due or before != self._battery_gap:
            self._battery_due_s = time_s + BATTERY_EVERY_S
            self.battery.append((time_s, percent, volts))

    def _look_at_clock(self, time_s: float) -> None:
        """Start over if the system's clock was set back: plots need times that rise."""
        if time_s < self._latest_s:
            self.speeds.clear()
            self.battery.clear()
            self._speed_due_s = self._battery_due_s = -math.inf
        self._latest_s = time_s

    def add_place(self, time_s: float, x_m: float, y_m: float, theta_rad: float) -> None:
        """Store a pose if it differs from the last; not too often, whatever the speed."""
        if abs(time_s - self._place_s) < PATH_EVERY_S:
            return
        moved_m = math.hypot(x_m - self._place[0], y_m - self._place[1])
        turned_rad = abs(theta_rad - self._place[2])
        if moved_m >= PATH_STEP_M or turned_rad >= PATH_STEP_RAD:  # False for NaN.
            self._place, self._place_s = (x_m, y_m, theta_rad), time_s
            self.path.append((x_m, y_m, time_s, theta_rad))

    def trend_percent_h(self) -> float | None:
        """Return the battery's trend in percent per hour; None while it is unknown.

        After a gap it begins anew: the battery may be another one.
        """
        latest = (self.battery.row(back) for back in range(min(len(self.battery), _TREND_ROWS)))
        known = itertools.dropwhile(lambda row: math.isnan(row[1]), latest)
        rows = list(itertools.takewhile(lambda row: math.isfinite(row[1]), known))
        count = len(rows)
        if count < _TREND_LEAST_ROWS:
            return None
        mean_s = sum(row[0] for row in rows) / count
        mean = sum(row[1] for row in rows) / count
        spread = sum((row[0] - mean_s) ** 2 for row in rows)
        slope = sum((row[0] - mean_s) * (row[1] - mean) for row in rows) / spread
        return number(slope * 3600.0, 1)
