# SPDX-License-Identifier: MIT
"""A value over time, in memory that does not grow with it."""

import math

_BUCKETS = 1200


class Series:
    """A value over time: the lowest and highest of each interval; intervals grow with time."""

    def __init__(self, begun_s: float, width_s: float = 0.05) -> None:
        self._begun_s = begun_s
        self._width_s = width_s
        self._last = -1
        self.points: list[list[float]] = []
        """Seconds from the beginning, lowest and highest."""
        self.low = math.inf
        self.high = -math.inf
        self.first = self.latest = math.nan

    def add(self, time_s: float, value: float) -> None:
        """Add a value; NaN is ignored."""
        if not math.isfinite(value):
            return
        self.latest = value
        if value < self.low:
            self.low = value
        if value > self.high:
            self.high = value
        bucket = int((time_s - self._begun_s) / self._width_s)
        if bucket == self._last:
            point = self.points[-1]
            if value < point[1]:
                point[1] = value
            if value > point[2]:
                point[2] = value
            return
        if not self.points:
            self.first = value
        self._last = bucket
        self.points.append([time_s - self._begun_s, value, value])
        if len(self.points) > 2 * _BUCKETS:
            self._halve()

    def _halve(self) -> None:
        while len(self.points) > _BUCKETS:
            self._width_s *= 2
            merged: list[list[float]] = []
            last = -1
            for point in self.points:
                bucket = int(point[0] / self._width_s)
                if bucket == last:
                    merged[-1][1] = min(merged[-1][1], point[1])
                    merged[-1][2] = max(merged[-1][2], point[2])
                else:
                    merged.append(point)
                    last = bucket
            self.points = merged
            self._last = last

    @property
    def gap_s(self) -> float:
        """A line is broken where values are missing for this long."""
        return max(3.0, 4 * self._width_s)
