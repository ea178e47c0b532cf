# SPDX-License-Identifier: MIT
"""What moves a client's datagrams and tells it the time: the contract of the three engines.

``engine_pump`` has a native thread, ``engine_udp`` is spun by its user, and ``world`` lives in a
simulator's time. Everything above works with any of them.
"""

from abc import ABC, abstractmethod
from typing import Any

from .records import Status

ALL_EVENTS = 0x0FFFFFFF
STATUS_MASK = 0x7C
"""Bit k set: service k sends statuses."""


def events_of_services(mask: int) -> int:
    """Return the events that tell of new statuses of the services in ``mask``."""
    return (mask & STATUS_MASK) << 4


class Reader(ABC):
    """How far somebody has read events and statuses; used by one thread at a time."""

    @property
    @abstractmethod
    def lost(self) -> int:
        """Statuses that this reader came too late for, so far."""

    @abstractmethod
    def take_events(self) -> int:
        """Take what happened since the last time; raises ClosedError after the end."""

    @abstractmethod
    def statuses(self, mask: int) -> list[Status] | None:
        """Take some more statuses of the services in ``mask``, without waiting.

        None when all were read; raises ClosedError when none will come either.
        """

    @abstractmethod
    def wait(self, mask: int, seconds: float) -> bool:
        """Wait for an event in ``mask`` that was not taken; False when the time is over.

        It may end early, so that Ctrl-C is heard. Raises ClosedError after the end.
        """


class Engine(ABC):
    """A client with somebody who keeps its link alive."""

    address: str
    """The robot's, for messages."""

    @abstractmethod
    def now_s(self) -> float:
        """Return the time on the clock that leases and timeouts go by."""

    @abstractmethod
    def call(self, name: str, *arguments: Any) -> Any:
        """Call the client's function of this name; a command is sent at once."""

    @abstractmethod
    def count(self, counter: int) -> int:
        """Return one of :class:`~roburoc4.Count`."""

    @abstractmethod
    def description(self, io_type: int, index: int) -> bytes | None:
        """Return the robot's text for a channel, or (io_type -1) for a directory entry."""

    @abstractmethod
    def reader(self) -> Reader:
        """Make a reader that begins now."""

    @abstractmethod
    def sleep(self, seconds: float) -> None:
        """Let time pass, with the link alive. It may end early, so that Ctrl-C is heard."""

    @abstractmethod
    def close(self) -> None:
        """End the link; from any thread, several times."""

    @property
    @abstractmethod
    def closed(self) -> bool:
        """Whether close() was called."""

    @property
    def fault(self) -> int:
        """One of :class:`~roburoc4.Fault`."""
        return 0
