# SPDX-License-Identifier: MIT
"""What an engine without a native pump keeps for its readers: statuses, events, texts.

The same promises as those of the pump: each reader sees everything, a slow one loses the oldest
statuses and is told how many.
"""

from collections import deque
from itertools import islice

from .constants import Service
from .records import Status

_EVENT_BITS = 28


class Log:
    """The latest statuses, and for each event the turn in which it came last."""

    def __init__(self, capacity: int) -> None:
        self._statuses: deque[tuple[int, Status]] = deque(maxlen=capacity)
        self._last = [0] * _EVENT_BITS
        self.next_sample = 0
        self.turn = 0
        self.texts: dict[tuple[int, int], bytes] = {}

    def note_events(self, events: int) -> None:
        """Remember that these events came."""
        self.turn += 1
        for bit in range(_EVENT_BITS):
            if events >> bit & 1:
                self._last[bit] = self.turn

    def note_status(self, service: Service, status: Status) -> None:
        """Keep a status, in the place of the oldest."""
        self._statuses.append((service, status))
        self.next_sample += 1

    def events_after(self, turn: int) -> int:
        """Return the events that came after this turn."""
        return sum(1 << bit for bit, last in enumerate(self._last) if last > turn)

    def statuses_from(self, number: int, mask: int) -> tuple[list[Status], int]:
        """Return those of the services in ``mask``, and how many of all were overwritten."""
        oldest = self.next_sample - len(self._statuses)
        lost = max(0, oldest - number)
        newer = islice(self._statuses, max(0, number - oldest), None)
        return [status for service, status in newer if mask >> service & 1], lost
