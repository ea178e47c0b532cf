# SPDX-License-Identifier: MIT
"""What connections without a native thread share: they keep statuses, events and texts in Python.

Readers are promised what a pump promises them: each sees everything, a slow one loses the oldest
statuses and learns how many.
"""

import os
import threading
import weakref
from abc import abstractmethod
from collections import deque
from collections.abc import Callable
from itertools import islice

from . import _native
from .connection import READ_STATUS, Connection, EventReader
from .constants import Event, Result, State
from .errors import error_of
from .records import Status
from .settings import Settings, buffer_of

_EVENT_BITS = 28


class Log:
    """The latest statuses, and for each event the turn in which it came last."""

    def __init__(self, capacity: int) -> None:
        self._statuses: deque[tuple[int, Status]] = deque(maxlen=capacity)
        self._last = [0] * _EVENT_BITS
        self.next_sample = 0
        self.turn = 0
        self.texts: dict[tuple[int, int], bytes] = {}

    def add_events(self, events: int) -> None:
        """Remember that these events came."""
        self.turn += 1
        for bit in range(_EVENT_BITS):
            if events >> bit & 1:
                self._last[bit] = self.turn

    def add_status(self, service: int, status: Status) -> None:
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


class LogReader(EventReader):
    """A reader of a connection's log."""

    def __init__(self, connection: "ManualConnection") -> None:
        self._connection = connection
        self._turn = connection.log.turn
        self._next = connection.log.next_sample
        self._lost = 0

    @property
    def lost(self) -> int:
        return self._lost

    def take_events(self) -> int:
        with self._connection.lock:
            self._connection.collect()
            log = self._connection.log
            events = log.events_after(self._turn)
            self._turn = log.turn
        if not events:
            self._connection.check_open()
        return events

    def statuses(self, mask: int) -> list[Status] | None:
        with self._connection.lock:
            log = self._connection.log
            if self._next == log.next_sample:
                self._connection.check_open()
                return None
            found, lost = log.statuses_from(self._next, mask)
            self._next = log.next_sample
            self._lost += lost
        return found

    def wait(self, mask: int, seconds: float) -> bool:
        with self._connection.lock:
            self._connection.collect()
            if not self._waiting(mask):
                self._connection.check_open()
                self._connection.sleep_until(seconds, lambda: self._waiting(mask))
            return self._waiting(mask)

    def _waiting(self, mask: int) -> bool:
        return self._connection.log.events_after(self._turn) & mask != 0


class ManualConnection(Connection):
    """A client whose datagrams Python moves, with its log; the lock is for one mover at a time."""

    def __init__(self, handle: "_native.Connection", settings: Settings) -> None:
        self.handle = handle
        self.lock = threading.RLock()
        self.log = Log(buffer_of(settings))
        self._process = os.getpid()
        self._left = False
        _connections.add(self)

    @abstractmethod
    def sleep_until(self, seconds: float, until: Callable[[], object]) -> None:
        """Let time pass, at most until something is true."""

    def sleep(self, seconds: float) -> None:
        self.sleep_until(seconds, lambda: False)

    def now_s(self) -> float:
        return _native.connection_now_us(self.handle) / 1e6

    def check_open(self) -> None:
        """Raise unless this can be used: not after close(), not in a forked child."""
        if self.closed:
            raise error_of(Result.CLOSED)

    def collect(self, datagram: bytes = b"") -> None:
        """Take the client's events, and what they announce, into the log."""
        events = _native.roburoc4_client_take_events(self.handle)
        if not events:
            return
        if not self.closed:
            for service, read in READ_STATUS.items():
                if events >> (service + 4) & 1:
                    self.log.add_status(service, read(self.handle))
        if events & Event.DESCRIPTION and datagram:
            described = _native.connection_description(self.handle, datagram)
            if described is not None:
                io_type, index, text = described
                self.log.texts[io_type, index] = text
        self.log.add_events(events)

    def description(self, io_type: int, index: int) -> bytes | None:
        return self.log.texts.get((io_type, index))

    def reader(self) -> LogReader:
        with self.lock:
            return LogReader(self)

    def disarm_for_good(self) -> None:
        """Disarm and send the first zero where one is due; nothing where that was done before."""
        if not self.closed:
            _native.roburoc4_client_close(self.handle)
            self.flush()

    def close(self) -> None:
        if self._process != os.getpid():
            return
        with self.lock:
            self.disarm_for_good()
            if not self._left:  # also where Ctrl-C cut short a close() before
                self._leave()
                self._left = True

    def unlock_in_child(self) -> None:
        """Make the lock anew: the thread that held it may not be in the child of a fork."""
        self.lock = threading.RLock()

    def _is_idle(self) -> bool:
        return _native.roburoc4_client_state(self.handle) == State.IDLE

    @abstractmethod
    def flush(self) -> None:
        """Send what the client has to send now."""

    @abstractmethod
    def _leave(self) -> None:
        """Let the zero commands out, then let go of the network."""


_connections: weakref.WeakSet[ManualConnection] = weakref.WeakSet()


def _after_fork_in_child() -> None:
    _native.connections_forked()
    for connection in list(_connections):
        connection.unlock_in_child()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork_in_child)
