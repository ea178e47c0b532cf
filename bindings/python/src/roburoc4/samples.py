# SPDX-License-Identifier: MIT
"""Statuses one after the other, and columns of them."""

import contextlib
from collections.abc import Callable, Iterator
from typing import Any

from .connection import EventReader, events_of_services
from .constants import Event, Service
from .errors import ClosedError, SamplesLostError
from .records import Status
from .settings import STATUS_SERVICES, service_of

__all__ = ["Reader", "Recording", "Statuses", "flatten"]

Column = list[Any]
_PATIENCE_S = 1.0


def mask_of(services: tuple[str | Service, ...]) -> int:
    """Return bit k for service k; without arguments all services that send statuses."""
    return sum(1 << service for service in {service_of(s) for s in services}) or sum(
        1 << service for service in STATUS_SERVICES.values()
    )


class Reader:
    """Events and statuses, one after the other, from the moment that this was made.

    Used by one thread at a time; see :meth:`roburoc4.Robot.reader`.
    """

    def __init__(self, reader: EventReader, mask: int) -> None:
        self._reader = reader
        self._mask = mask
        self._reported = 0
        self._waiting: list[Status] = []
        self._taken = Event(0)

    @property
    def lost(self) -> int:
        """Statuses, of any service, that were overwritten before they were read."""
        return self._reader.lost

    def next(self) -> Status | None:
        """Take the next status that is there; raises ClosedError at the end."""
        while not self._waiting:
            with contextlib.suppress(ClosedError):  # statuses() raises it, when all are read
                self._taken |= Event(self._reader.take_events())
            found = self._reader.statuses(self._mask)
            if found is None:
                return None
            self._waiting = found[::-1]
            if self._reader.lost > self._reported:
                lost = self._reader.lost - self._reported
                self._reported = self._reader.lost
                raise SamplesLostError(lost)
        return self._waiting.pop()

    def take_events(self) -> Event:
        """Take what happened since the last time; raises ClosedError after the end."""
        events, self._taken = self._taken, Event(0)
        return events or Event(self._reader.take_events())

    def drain(self, use: Callable[[Status], None]) -> None:
        """Pass on all that are there; lost ones are only counted."""
        while True:
            try:
                status = self.next()
            except SamplesLostError:
                continue
            if status is None:
                return
            use(status)

    def wait(self, seconds: float) -> None:
        """Wait for a status; it may end early."""
        self._reader.wait(events_of_services(self._mask), seconds)


class Statuses(Iterator[Status]):
    """Every status from the moment that this was made; see :meth:`roburoc4.Robot.statuses`."""

    def __init__(self, source: Reader) -> None:
        self._source = source

    @property
    def lost(self) -> int:
        """Statuses, of any service, that were overwritten before they were read."""
        return self._source.lost

    def __iter__(self) -> "Statuses":
        return self

    def __next__(self) -> Status:
        try:
            while (status := self._source.next()) is None:
                self._source.wait(_PATIENCE_S)
        except ClosedError:
            raise StopIteration from None
        return status


_LISTS = {
    "analog_inputs": "analog_input_{}",
    "digital_inputs": "digital_input_{}",
    "distances_m": "distance_{}_m",
}


def flatten(status: Status) -> dict[str, Any]:
    """Return a status as a row of a table: a list becomes ``distance_0_m``, ``distance_1_m`` ..."""
    row: dict[str, Any] = {}
    for name, value in status._asdict().items():
        if name in _LISTS:
            row |= {_LISTS[name].format(index): item for index, item in enumerate(value)}
        else:
            row[name] = value
    return row


class Recording(dict[str, dict[str, Column]]):
    """Columns of statuses: ``recording["localization"]["x_m"]`` is a list.

    Lists become columns of their own: ``distance_0_m``, ``analog_input_3``, ``digital_input_8``.
    All columns of a service have the same length. A service without statuses has no columns.
    """

    def __init__(self, mask: int) -> None:
        super().__init__(
            (name, {}) for name, service in STATUS_SERVICES.items() if mask >> service & 1
        )
        self.lost = 0
        """Statuses that came too fast to be recorded."""

    def add(self, status: Status) -> None:
        """Append a status to the columns of its service."""
        columns = self[status.kind]
        length = len(columns.get("robot_cycles", ()))
        for name, value in flatten(status).items():
            # Another robot after a reboot may have more channels.
            columns.setdefault(name, [None] * length).append(value)
        for column in columns.values():
            if len(column) == length:
                column.append(None)
