# SPDX-License-Identifier: MIT
"""Ticks: numbers of the frames sent to pages, and when each was sent."""

from collections import deque

_KEPT = 256


class Ticks:
    """Issues ticks. An input is as old as the tick that it names."""

    def __init__(self) -> None:
        self.last = 0
        self._issued_s: deque[float] = deque(maxlen=_KEPT)

    def issue(self, now_s: float) -> int:
        """Make the next number."""
        self.last += 1
        self._issued_s.append(now_s)
        return self.last

    def age_s(self, tick: int, now_s: float) -> float | None:
        """Return how long ago it was issued; None if it never was, or too long ago."""
        back = self.last - tick
        if not 0 <= back < len(self._issued_s):
            return None
        return now_s - self._issued_s[-1 - back]
