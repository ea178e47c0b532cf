# SPDX-License-Identifier: MIT
"""A client without socket and clock: its user hands it datagrams and the time.

What reads a recording uses it, and so can a test or a link that is not UDP.
"""

from collections.abc import Callable
from typing import Unpack

from . import _native
from .connection import ALL_EVENTS, STATUS_EVENTS, open_alone
from .constants import Event
from .manual import ManualConnection
from .records import Status
from .robot import Robot
from .settings import STATUS_MASK, Settings

__all__ = ["OfflineClient"]

_OTHER_EVENTS = ALL_EVENTS & ~STATUS_EVENTS
_IOCARD = int(Event.IOCARD)  # an Event is slow to compute with


class _OfflineConnection(ManualConnection):
    def __init__(self, settings: Settings, advance: Callable[[], object]) -> None:
        super().__init__(open_alone(settings), "a recording", settings)
        self._advance = advance

    def move(self, seconds: float, until: Callable[[], object]) -> None:
        self.check_open()
        end_s = self.now_s() + seconds
        while self.now_s() < end_s and not until():
            if self._advance() is None:
                _native.roburoc4_pump_close(self.handle)
                return

    def leave(self) -> None:
        pass


class OfflineClient:
    """A client and, as ``robot``, the :class:`~roburoc4.Robot` that shows what it knows."""

    def __init__(
        self, begin_us: int, advance: Callable[[], object], **settings: Unpack[Settings]
    ) -> None:
        """Begin at a time in microseconds, of which all later ones are counted on.

        Where the robot waits, it calls ``advance`` until the time has come: that feeds it, and
        returns None at the end.
        """
        connection = _OfflineConnection(settings, advance)
        self._handle = connection.handle
        _native.connection_begin(self._handle, begin_us)
        self._reader = _native.new_reader()
        self.robot = Robot(connection, settings)

    def feed(self, datagram: bytes, at_us: int) -> list[bytes]:
        """Hand it a datagram, or b"" for none, at a time; return what it sends."""
        return _native.connection_play(self._handle, datagram, at_us)

    @property
    def now_us(self) -> int:
        """The time of the last datagram."""
        return _native.connection_now_us(self._handle)

    @property
    def due_us(self) -> int:
        """When to feed it, with b"" if there is no datagram."""
        return _native.roburoc4_client_next_deadline(self._handle)

    def take(self) -> tuple[int, list[Status]]:
        """Return what happened, except that statuses came (IOCARD also then), and the statuses."""
        events = _native.roburoc4_pump_take_events(self._handle, self._reader)
        statuses: list[Status] = []
        if events & STATUS_EVENTS:
            statuses = _native.read_samples(self._handle, self._reader, STATUS_MASK) or []
        return events & (_OTHER_EVENTS | _IOCARD), statuses
