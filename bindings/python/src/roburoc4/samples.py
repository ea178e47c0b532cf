# SPDX-License-Identifier: MIT
"""Statuses one by one, and columns of them."""

import contextlib
import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, Generic, TypeVar, cast

from .connection import ALL_EVENTS, STATUS_EVENTS, EventReader, events_of_services
from .constants import Event, Result, Service
from .errors import ClosedError, RobotTimeoutError, SamplesLostError, duration_s, timeout_s
from .records import Gap, Status
from .settings import STATUS_SERVICES, service_of

if TYPE_CHECKING:
    import pandas

__all__ = ["Events", "Gaps", "Reader", "Recording", "Statuses", "flatten"]

_S = TypeVar("_S", bound=Status)
Column = list[Any]
_PATIENCE_S = 1.0


def mask_of(services: tuple[str | Service, ...]) -> int:
    """Return bit k for service k; without arguments all services that send statuses."""
    return sum(1 << service for service in {service_of(s) for s in services}) or sum(
        1 << service for service in STATUS_SERVICES.values()
    )


class Reader(Generic[_S]):
    """Statuses, one by one, from the moment it was created; used by one thread at a time."""

    def __init__(self, reader: EventReader, mask: int) -> None:
        self._reader = reader
        self._mask = mask
        self._reported = 0
        self._waiting: list[_S] = []

    @property
    def lost(self) -> int:
        """Statuses, of any service, that were overwritten before they were read."""
        return self._reader.lost

    def next(self) -> _S | None:
        """Take the next available status; raises ClosedError at the end."""
        while not self._waiting:
            with contextlib.suppress(ClosedError):  # statuses() raises it once all are read
                self._reader.take_events()
            found = self._reader.statuses(self._mask)
            if found is None:
                return None
            self._waiting = cast(list[_S], found[::-1])
            if self._reader.lost > self._reported:
                lost = self._reader.lost - self._reported
                self._reported = self._reader.lost
                raise SamplesLostError(lost)
        return self._waiting.pop()

    def drain(self, use: Callable[[_S], None]) -> None:
        """Pass on all available statuses; lost ones are only counted."""
        while True:
            try:
                status = self.next()
            except SamplesLostError:
                continue
            if status is None:
                return
            use(status)

    def now_s(self) -> float:
        """Return the time on the robot object's clock."""
        return self._reader.now_s()

    def wait(self, seconds: float) -> None:
        """Wait for a status; it may return early."""
        self._reader.wait(events_of_services(self._mask), seconds)


class Patience:
    """How long to wait for the next item; None: forever."""

    def __init__(self, now_s: Callable[[], float], timeout: float | None, missing: str) -> None:
        self._now_s = now_s
        self._timeout = timeout
        self._missing = missing
        self._end_s = math.inf
        if timeout is not None:
            self._end_s = now_s() + timeout_s(timeout)

    def left_s(self) -> float:
        """Return how long to wait now; raises RobotTimeoutError when the time is over."""
        left_s = self._end_s - self._now_s()
        if left_s <= 0.0:
            raise RobotTimeoutError(f"{self._missing} within {self._timeout:g} s", Result.TIMEOUT)
        return min(left_s, _PATIENCE_S)


def name_of_statuses(services: tuple[str | Service, ...]) -> str:
    """Describe what did not arrive."""
    names = " or ".join(service_of(service).name.lower() for service in services)
    return "no " + f"{names} status".strip()


class EventQueue:
    """Events, one by one, except those that only announce statuses."""

    def __init__(self, reader: EventReader, timeout: float | None) -> None:
        self.reader = reader
        self._timeout = timeout
        self._waiting: list[Event] = []

    def take(self) -> Event:
        """Take all available events; raises ClosedError at the end."""
        events, self._waiting = self._waiting, []
        return Event(sum(events) | self.reader.take_events() & ~STATUS_EVENTS)

    def next(self) -> Event | None:
        """Take the next available event; raises ClosedError at the end."""
        if not self._waiting:
            self._waiting = list(Event(self.reader.take_events() & ~STATUS_EVENTS))
        return self._waiting.pop(0) if self._waiting else None

    def patience(self) -> Patience:
        """Start to wait for the next one."""
        return Patience(self.reader.now_s, self._timeout, "no event")


class Events(Iterator[Event]):
    """Every event since it was created; see :meth:`roburoc4.Robot.events`."""

    def __init__(self, queue: EventQueue) -> None:
        self._queue = queue

    def take(self) -> Event:
        """Take all that happened since the last call, without waiting; ClosedError after the end.

        Several of a kind are one.
        """
        return self._queue.take()

    def __iter__(self) -> "Events":
        return self

    def __next__(self) -> Event:
        patience = self._queue.patience()
        try:
            while (event := self._queue.next()) is None:
                self._queue.reader.wait(ALL_EVENTS & ~STATUS_EVENTS, patience.left_s())
        except ClosedError:
            raise StopIteration from None
        return event


class Statuses(Iterator[_S]):
    """Every status since it was created; see :meth:`roburoc4.Robot.statuses`."""

    def __init__(self, source: "Reader[_S]", timeout: float | None, what: str) -> None:
        self._source = source
        self._timeout = timeout
        self._what = what

    @property
    def lost(self) -> int:
        """Statuses, of any service, that were overwritten before they were read."""
        return self._source.lost

    def take(self, timeout: float = 0.0) -> list[_S]:
        """Take all that have arrived; if there are none, wait for one at most this long.

        May return none earlier. Those that were overwritten are only counted, in ``lost``. Raises
        ClosedError after the end.
        """
        duration_s("timeout", timeout)
        found: list[_S] = []
        self._source.drain(found.append)
        if not found and timeout > 0.0:
            self._source.wait(timeout)
            self._source.drain(found.append)
        return found

    def __iter__(self) -> "Statuses[_S]":
        return self

    def __next__(self) -> _S:
        patience = Patience(self._source.now_s, self._timeout, self._what)
        try:
            while (status := self._source.next()) is None:
                self._source.wait(patience.left_s())
        except ClosedError:
            raise StopIteration from None
        return status


_LISTS = {
    "analog_inputs": "analog_input_{}",
    "digital_inputs": "digital_input_{}",
    "distances_m": "distance_{}_m",
}


def flatten(status: Status) -> dict[str, Any]:
    """Return a status as a table row: a list becomes ``distance_0_m``, ``distance_1_m`` ..."""
    row: dict[str, Any] = {}
    for name, value in status._asdict().items():
        if name in _LISTS:
            row |= {_LISTS[name].format(index): item for index, item in enumerate(value)}
        else:
            row[name] = value
    return row


_GAP_S = 0.5
_GAP_PERIODS = 3


class Gaps:
    """Counts missing statuses. Each service is asked for its own period."""

    def __init__(self, period_s: Callable[[str], float]) -> None:
        self._period_s = period_s
        self._last: dict[str, Status] = {}
        self.lost = 0
        """Statuses that should have arrived but are missing, for whatever reason."""
        self.found: list[Gap] = []
        """Gaps of at least half a second; simultaneous gaps of several services are one."""

    def add(self, status: Status) -> None:
        """Take the next status."""
        last = self._last.get(status.service)
        self._last[status.service] = status
        if last is not None:
            # Not by robot_cycles, which start over when the robot restarts.
            self._look(last, status.utc_s - last.utc_s)

    def end(self, now_s: float) -> None:
        """Look for services that were silent at the end; ``now_s`` is the robot object's time."""
        for last in self._last.values():
            self._look(last, now_s - last.host_us / 1e6)
        self._last.clear()

    def _look(self, last: Status, length_s: float) -> None:
        period_s = self._period_s(last.service)
        self.lost += max(0, round(length_s / period_s) - 1) if period_s > 0.0 else 0
        if length_s <= max(_GAP_S, _GAP_PERIODS * period_s):
            return
        begin_s, services = last.utc_s, {last.service}
        end_s = begin_s + length_s
        while self.found and begin_s < self.found[-1].utc_s + self.found[-1].seconds:
            before = self.found.pop()
            begin_s, services = min(begin_s, before.utc_s), services | set(before.services)
            end_s = max(end_s, before.utc_s + before.seconds)
        self.found.append(Gap(begin_s, end_s - begin_s, tuple(sorted(services))))


class Recording(dict[str, dict[str, Column]]):
    """Columns of statuses: ``recording["localization"]["x_m"]`` is a list.

    Lists become columns of their own: ``distance_0_m``, ``analog_input_3``, ``digital_input_8``.
    All columns of a service have the same length. A service without statuses has no columns.
    """

    def __init__(self, mask: int, period_s: Callable[[str], float]) -> None:
        super().__init__(
            (name, {}) for name, service in STATUS_SERVICES.items() if mask >> service & 1
        )
        self._gaps = Gaps(period_s)

    @property
    def lost(self) -> int:
        """Statuses that are missing: lost by the network, or overwritten before they were read."""
        return self._gaps.lost

    @property
    def gaps(self) -> list[Gap]:
        """When services were silent for half a second or more."""
        return self._gaps.found

    def end(self, now_s: float) -> None:
        """Look for a gap at the end."""
        self._gaps.end(now_s)

    def to_pandas(self) -> "dict[str, pandas.DataFrame]":
        """Return a table for each service, with the time of its statuses (UTC) as index."""
        try:
            import pandas
        except ModuleNotFoundError:
            raise ModuleNotFoundError(
                "to_pandas needs pandas: pip install pandas, or apt install python3-pandas",
                name="pandas",
            ) from None
        return {
            service: pandas.DataFrame(
                columns,
                index=pandas.to_datetime(columns.get("utc_s", []), unit="s", utc=True).rename(
                    "utc"
                ),
            )
            for service, columns in self.items()
        }

    def add(self, status: Status) -> None:
        """Append a status to the columns of its service."""
        self._gaps.add(status)
        columns = self[status.service]
        length = len(columns.get("robot_cycles", ()))
        for name, value in flatten(status).items():
            # After a reboot, the robot may have more channels.
            columns.setdefault(name, [None] * length).append(value)
        for column in columns.values():
            if len(column) == length:
                column.append(None)
