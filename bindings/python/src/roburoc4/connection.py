# SPDX-License-Identifier: MIT
"""A client and who moves its datagrams: what robots are built on.

In ``pump.py`` a native thread moves them, in ``udp.py`` the user does, and in ``virtual.py`` a
simulator's virtual time. Everything above works with any of them.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable

from . import _native
from .constants import Service
from .errors import ArgumentError, NotKnownError
from .records import Status
from .settings import STATUS_MASK

ALL_EVENTS = 0x1FFFFFFF

READ_STATUS: dict[Service, Callable[["_native.Connection"], Status]] = {
    Service.IOCARD: _native.roburoc4_client_inputs,
    Service.TELEMETER: _native.roburoc4_client_distances,
    Service.BATTERY: _native.roburoc4_client_battery,
    Service.LOCALIZATION: _native.roburoc4_client_localization,
    Service.DIFFERENTIAL: _native.roburoc4_client_differential,
}
"""What returns the latest status of a service, or raises NotKnownError before the first."""


def events_of_services(mask: int) -> int:
    """Return the events that announce statuses of the services in ``mask``."""
    return (mask & STATUS_MASK) << 4


class EventReader(ABC):
    """How far somebody has read events and statuses; used by one thread at a time."""

    def __init__(self, handle: "_native.Connection") -> None:
        self._handle = handle
        self._reader = _native.new_reader()
        _native.roburoc4_pump_reader_init(handle, self._reader)

    @property
    def lost(self) -> int:
        """Statuses, of any service, that were overwritten before this reader read them."""
        return _native.reader_lost(self._reader)

    def take_events(self) -> int:
        """Take what happened since the last time; raises ClosedError after the end."""
        return _native.roburoc4_pump_take_events(self._handle, self._reader)

    def statuses(self, mask: int) -> list[Status] | None:
        """Take some more statuses of the services in ``mask``, without waiting.

        None when all were read; raises ClosedError when none will come either.
        """
        return _native.read_samples(self._handle, self._reader, mask)

    @abstractmethod
    def wait(self, mask: int, seconds: float) -> bool:
        """Wait for an event in ``mask`` that was not taken; False when the time is over.

        It may end early, so that Ctrl-C is noticed. Raises ClosedError after the end.
        """

    def _wait_us(self, mask: int, timeout_us: int) -> bool:
        """Wait without the interpreter."""
        return _native.roburoc4_pump_wait_events(self._handle, self._reader, mask, timeout_us) != 0


class Connection(ABC):
    """A client, to be called by its ``handle``: ``_native.roburoc4_client_facts(handle)``."""

    def __init__(self, handle: "_native.Connection") -> None:
        self.handle = handle
        self.address = _native.connection_address(handle) or "the simulator"
        """The robot's, for messages."""

    def now_s(self) -> float:
        """Return the time on the clock that leases and timeouts go by."""
        return _native.connection_now_us(self.handle) / 1e6

    def description(self, io_type: int, index: int) -> bytes | None:
        """Return the robot's text for a channel, or (io_type -1) for a directory entry."""
        try:
            return _native.roburoc4_pump_description(self.handle, io_type, index)
        except (NotKnownError, ArgumentError):
            return None

    @abstractmethod
    def reader(self) -> EventReader:
        """Make a reader that begins now."""

    @abstractmethod
    def sleep(self, seconds: float) -> None:
        """Let time pass while datagrams are moved. It may end early, so that Ctrl-C is noticed."""

    @abstractmethod
    def close(self) -> None:
        """Stop the robot where it was driven, and end; from any thread, several times."""

    @property
    def closed(self) -> bool:
        """Whether close() was called, or this is the child of a fork."""
        return not _native.roburoc4_pump_running(self.handle)
